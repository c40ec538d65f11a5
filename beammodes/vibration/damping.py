"""Damping of a chain, in proportion to mass and stiffness (Rayleigh's) and at its joints; and of its modes.

In undamped modes of unit modal mass, q = Φ p, a damped chain is

    p'' + G p' + Ω² p = 0,      G = α + β Φᵀ K Φ + Σ_j d_j (joint rotation of the modes)ᵀ (joint rotation).

Without dampers d of its own and without a load G is diagonal: every mode keeps its shape and has the ratio
ζ = α/(2ω) + βω/2. Otherwise dampers couple the modes; the eigenvalues λ of the whole then say what remains.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.chains.axial_chain import AxialChain
from beammodes.chains.chain import Chain
from beammodes.chains.pieces import MAX_PIECES
from beammodes.chains.spatial_chain import SpatialChain
from beammodes.checks import (
    Shown,
    bounded,
    instead,
    is_text,
    not_negative,
    positive_real,
    real_numbers,
    shown,
    unwrapped,
    whole_number,
)
from beammodes.deferred import Deferred
from beammodes.numerics.arrays import Floats
from beammodes.numerics.nonnegative import nearest_nonnegative
from beammodes.problem.loading import Load
from beammodes.version import SOURCE
from beammodes.vibration.axial_spectrum import solve_axial_modes
from beammodes.vibration.linear import BentModel, LinearModel, linearize
from beammodes.vibration.modes import MAX_DENSE, Modes, solve_modes
from beammodes.vibration.modes_in_space import spatial_modes
from beammodes.vibration.spectrum import is_turned

if TYPE_CHECKING:
    import xarray
else:
    xarray = Deferred("xarray")

__all__ = [
    "Damping",
    "DampingFitWarning",
    "ModalDamping",
    "checked_damping",
    "damped_eigenvalues",
    "damped_modes",
    "damped_pairs",
    "damping_along",
    "damping_of_modes",
    "damping_ratios",
    "given_for_asked",
    "joint_dampers",
    "modes_with_ratios",
    "ratios_of_modes",
]


def checked_damping(value: object, *, or_none: bool = True) -> None:
    """Raise TypeError unless `value` is a `Damping`, or None where that may be; a ratio is told its maker.

    Examples
    --------
    >>> checked_damping(None)
    >>> checked_damping(0.01)
    Traceback (most recent call last):
        ...
    TypeError: damping must be a Damping or None, got 0.01; joint_dampers(chain, 0.01) makes one of 1 %
    """
    if isinstance(value, Damping) or (or_none and value is None):
        return
    makes = "joint_dampers(chain, 0.01) makes one of 1 %"
    hint = instead(value, float=makes, int=makes, str=makes, list=makes, Quantity=makes)
    raise TypeError(f"damping must be a Damping{' or None' if or_none else ''}, got {shown(value)}{hint}")


class DampingFitWarning(UserWarning):
    """Only a negative damper gives the damping ratios that were asked for; others are returned."""


@dataclass(frozen=True, repr=False)
class Damping(Shown):
    """Damping of a chain's motion relative to its base.

        C = α M + β K + Σ_j d_j (joint rotation)ᵀ (joint rotation)

    α acts on each piece's own motion, β on the springs of joints and supports (not on what loads add).

    Parameters
    ----------
    mass : float [1/s]
        α: mode n gets the damping ratio α/(2 ω_n).
    stiffness : float [s]
        β: mode n gets the damping ratio β ω_n/2.
    joint : float or sequence, one a hinge [N m s/rad]
        d_j.

    Raises
    ------
    TypeError, ValueError
        If a number is not real, or negative.

    Examples
    --------
    >>> import beammodes as bm
    >>> bm.Damping(stiffness=0.01).joint_damping(bm.Chain(bm.Beam.unit(), "clamped-free", segments=1))
    array([0.03])
    """

    mass: float = 0.0
    stiffness: float = 0.0
    joint: float | tuple[float, ...] = 0.0

    def __post_init__(self) -> None:
        for name, unit in (("mass", "1/s"), ("stiffness", "s")):
            object.__setattr__(self, name, not_negative(name, getattr(self, name), unit))
        given: Any = unwrapped("joint", self.joint)
        if isinstance(given, Sequence | np.ndarray) and not is_text(given):
            kept: float | tuple[float, ...] = tuple(
                not_negative(f"joint[{i}]", d) for i, d in enumerate(bounded("joint", given, most=MAX_PIECES))
            )
        else:
            kept = not_negative("joint", given)
        object.__setattr__(self, "joint", kept)

    def joint_damping(self, chain: Chain | AxialChain | SpatialChain) -> Floats:
        """Return the damping of every hinge, β k_j + d_j, shape of `joint_stiffness` [N m s/rad].

        In stretch [N s/m]. In space d_j is about each of the three axes; one that is rigid has none.

        Raises
        ------
        TypeError, ValueError
            If `chain` is no chain, or `joint` has another number of entries than the chain has hinges.
        """
        own = self.own_of_joints(chain)
        return own + self.stiffness * np.where(np.isfinite(chain.joint_stiffness), chain.joint_stiffness, 0.0)

    def own_of_joints(self, chain: Chain | AxialChain | SpatialChain) -> Floats:
        """Return d_j of every hinge, shape of `joint_stiffness`; see `joint_damping`."""
        if not isinstance(chain, Chain | AxialChain | SpatialChain):
            raise TypeError(f"chain must be a Chain, AxialChain or SpatialChain, got {shown(chain)}")
        stiffness, own = chain.joint_stiffness, np.asarray(self.joint)
        if own.ndim and len(own) != len(stiffness):
            raise ValueError(f"joint must have {len(stiffness)} entries, one a hinge, got {len(own)}")
        across = own.reshape(-1, *[1] * (stiffness.ndim - 1)) if own.ndim else own
        return np.where(np.isfinite(stiffness), across, 0.0)


@dataclass(frozen=True, eq=False)
class ModalDamping:
    """A damped chain in its undamped elastic modes.

    Attributes
    ----------
    angular_frequency : ndarray, shape (modes,) [rad/s]
    joints, far_support : ndarray, shape (modes, modes) [1/s]
        Parts of G. The second is of dampers that hold the less firm end against the ground, which trees
        cannot have as joints: of its support's springs, and of the last hinge where the end's angle is held.
    drag : float [1/s]
        Of rigid motion, which only α damps.
    """

    angular_frequency: Floats
    joints: Floats
    far_support: Floats
    drag: float

    @property
    def coupling(self) -> Floats:
        """G, shape (modes, modes) [1/s]."""
        return self.joints + self.far_support


def damping_of_modes(chain: Chain, damping: Damping, load: Load | None = None) -> ModalDamping:
    """Return the undamped modes' frequencies and G, under a load that leaves the chain straight."""
    if not isinstance(chain, Chain):
        ratio = "Damping(stiffness=b) alone gives each of its modes the ratio b ω/2"
        hint = instead(chain, SpatialChain=ratio, AxialChain=ratio)
        raise TypeError(f"chain must be a Chain, got {shown(chain)}{hint}")
    checked_damping(damping, or_none=False)
    if len(chain.scaled.joint_stiffness) > MAX_DENSE:
        raise ValueError(
            f"chain must have at most {MAX_DENSE} hinges here, where all its modes are needed, "
            f"got {len(chain.scaled.joint_stiffness)}"
        )
    own, model = damping.joint_damping(chain), linearize(chain, load=load)
    modes = solve_modes(model)
    omega, bend = modes.angular_frequency, np.diff(modes.rotation, axis=1)
    ends = [np.zeros((len(omega), len(omega))) for _ in range(2)]
    for end, (translation, rotation) in enumerate(chain.support_stiffness.tolist()):
        for stiffness, shape in (
            (translation, modes.deflection[:, -end]),
            (rotation, modes.rotation[:, -end]),
        ):
            if 0.0 < stiffness < np.inf:
                ends[end] += damping.stiffness * stiffness * np.outer(shape, shape)
    last = 0 if is_turned(chain) else -1
    far = ends[last]
    if chain.held_angles[last] and len(own) > 1:
        # The hinge at an end that is held there turns against the ground, as a support does.
        far = far + own[last] * np.outer(bend[:, last], bend[:, last])
    if model.load == Load():
        # Springs alone: β Ω², without the rounding of its sum.
        own = own - damping.stiffness * chain.joint_stiffness
        joints = (bend * own) @ bend.T + np.diag(damping.stiffness * omega**2) - far
    else:
        joints = (bend * own) @ bend.T + sum(ends) - far
    drag = damping.mass if model.rigid_body_modes else 0.0
    return ModalDamping(omega, joints + damping.mass * np.eye(len(omega)), far, drag)


def damping_along(chain: AxialChain, damping: Damping) -> ModalDamping:
    """Return the undamped modes' frequencies and G of a chain in twist or stretch, as `damping_of_modes`.

    Examples
    --------
    >>> from beammodes.problem.motions import unit_beam
    >>> modal = damping_along(AxialChain(unit_beam(), "fixed-fixed", 3), Damping(stiffness=0.1))
    >>> bool(np.allclose(modal.coupling, 0.1 * np.diag(modal.angular_frequency**2)))
    True
    """
    own, modes = damping.own_of_joints(chain), solve_axial_modes(chain)
    omega, moved = modes.angular_frequency, modes.displacement
    turned = np.diff(moved, axis=1)
    far = np.zeros((len(omega), len(omega)))
    right = chain.boundary.right
    if 0.0 < right.stiffness < np.inf:
        far += damping.stiffness * right.stiffness * np.outer(moved[:, -1], moved[:, -1])
    if right.is_fixed and len(own) > 1:
        last = own[-1] + damping.stiffness * chain.joint_stiffness[-1]
        far += last * np.outer(turned[:, -1], turned[:, -1])
    joints = (turned * own) @ turned.T + np.diag(damping.stiffness * omega**2) - far
    drag = damping.mass if modes.rigid_body_modes else 0.0
    return ModalDamping(omega, joints + damping.mass * np.eye(len(omega)), far, drag)


def damped_eigenvalues(omega: Floats, coupling: Floats) -> NDArray[np.complex128]:
    """Return all λ, two a mode; those of modes that do not couple without loss to a dense solver."""
    if not np.any(coupling - np.diag(coupling.diagonal())):
        half = (coupling.diagonal() / 2).astype(complex)
        root = np.sqrt(half**2 - omega**2)
        return np.concatenate([-half - root, -(omega**2) / (half + root)])
    size = np.diag(omega)
    # In (p', Ω p), where both blocks off the diagonal are alike.
    return np.linalg.eigvals(np.block([[-coupling, -size], [size, np.zeros_like(size)]])).astype(complex)


def joint_dampers(
    chain: Chain | AxialChain | SpatialChain, ratio: Mapping[int, float] | ArrayLike, *, mode: int = 1
) -> Damping:
    """Return joint dampers that give a mode a damping ratio, or several modes a ratio each.

        d_j = β k_j,   β = 2 ζ/ω_mode

    Every other mode gets ζ ω/ω_mode: the higher, the more. Springs of elastic supports are damped likewise.

    Several ratios make dampers that differ from hinge to hinge: of all that give these ratios, and none of
    which is negative, those nearest to β k_j, in multiples of the springs,

        d_j = k_j max(0, β + Σ_n λ_n w_nj),   w_nj = k_j (joint rotation)²/(2 ω_n),   Σ_j w_nj d_j/k_j = ζ_n

    with modes of unit modal mass; supports are not damped then. Engines have dampers of joints only, not α:
    so a file can have two measured ratios. What all modes get, `damped_modes` says: unequal dampers couple
    them, which shifts a ratio by less than ζ of itself.

    Parameters
    ----------
    chain : Chain, AxialChain or SpatialChain
    ratio : float, mapping of modes to ratios, or row of ratios of modes 1, 2, ...
        ζ, 1 for critical damping, such as {1: 0.008, 2: 0.011}; one number in twist, stretch and space.
    mode : int
        Of a single ratio, from 1; rigid-body modes are not counted, bending and twist in space together.

    Returns
    -------
    Damping
        One stiffness-proportional coefficient [s], or a damper for each joint [N m s/rad].

    Raises
    ------
    TypeError, ValueError
        If `chain` is no chain or has no such mode, or a ratio is not a finite real number greater than 0.

    Warns
    -----
    DampingFitWarning
        If no dampers but negative ones give these ratios: it says what those nearest to them give.

    References
    ----------
    Rayleigh, The Theory of Sound, vol. 1 (1877), on dissipation functions.

    Examples
    --------
    >>> import beammodes as bm
    >>> chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments=4)
    >>> damping = bm.joint_dampers(chain, 0.01)
    >>> bm.damped_modes(chain, damping).damping_ratio.values.round(4)
    array([0.01  , 0.0585, 0.1536, 0.2662])
    >>> both = bm.joint_dampers(chain, {1: 0.008, 2: 0.011})
    >>> bm.damped_modes(chain, both).damping_ratio.values.round(4)
    array([0.008 , 0.0109, 0.0939, 0.0704])
    """
    several = isinstance(ratio, Mapping | list | tuple) or getattr(ratio, "ndim", 0) > 0
    if several and not isinstance(chain, AxialChain | SpatialChain):
        if whole_number("mode", mode) != 1:
            raise ValueError(f"mode must be left out with ratios of several modes, got {shown(mode)}")
        return _fitted_joints(chain, ratios_of_modes("ratio", ratio))
    wanted = positive_real("ratio", ratio)
    if isinstance(chain, AxialChain | SpatialChain):
        number = whole_number("mode", mode, most=3 * max(1, chain.joint_stiffness.size))
        if isinstance(chain, SpatialChain):
            found = spatial_modes(chain, number).angular_frequency
        else:
            found = solve_axial_modes(chain, number).angular_frequency
        if len(found) < number:
            raise ValueError(f"mode must be one that the chain has, at most {len(found)}, got {number}")
        return Damping(stiffness=2.0 * wanted / float(found[-1]))
    omega = float(_elastic(chain, mode).angular_frequency[-1])
    return Damping(stiffness=2.0 * wanted / omega)


def _elastic(chain: Chain, mode: int) -> Modes:
    """Return the elastic modes up to one."""
    model = linearize(chain)
    if not model.elastic_modes:
        raise ValueError(f"chain must have an elastic mode to damp, got {shown(chain)}")
    return solve_modes(model, whole_number("mode", mode, most=model.elastic_modes))


def _fitted_joints(chain: Chain, ratios: dict[int, float]) -> Damping:
    modes = _elastic(chain, max(ratios))
    chosen, wanted = np.array([*ratios]) - 1, np.array([*ratios.values()])
    bend, stiffness = np.diff(modes.rotation, axis=1)[chosen], chain.joint_stiffness
    shares = stiffness * bend**2 / (2 * modes.angular_frequency[chosen])[:, None]
    whole = shares.sum(axis=1)
    # β of the least squares; then all in its multiples, and each ratio in its own.
    beta = float(whole @ wanted / (whole @ whole))
    rows = beta * shares / wanted[:, None]
    found = nearest_nonnegative(rows, np.ones(len(wanted)), np.ones(len(stiffness)))
    if found is None:
        from scipy.optimize import nnls

        found, _ = nnls(rows, np.ones(len(wanted)), maxiter=100 * len(stiffness))
        said = given_for_asked(ratios, wanted * (rows @ found))
        warnings.warn(f"only negative dampers give these ratios: {said}", DampingFitWarning, stacklevel=3)
    return Damping(joint=tuple((beta * found * stiffness).tolist()))


def ratios_of_modes(name: str, given: object) -> dict[int, float]:
    """Return damping ratios by their modes, of a mapping, or of a row of those of modes 1, 2, ...

    Examples
    --------
    >>> ratios_of_modes("ratios", [0.01, 0.02])
    {1: 0.01, 2: 0.02}
    """
    if isinstance(given, Mapping):
        items = bounded(name, given.items(), most=MAX_DENSE)
    elif isinstance(given, Sequence | np.ndarray) and not is_text(given):
        items = [*enumerate(bounded(name, given, most=MAX_DENSE), 1)]
    elif getattr(given, "ndim", 0) == 1:
        items = [*enumerate(bounded(name, real_numbers(name, given).tolist(), most=MAX_DENSE), 1)]
    else:
        raise TypeError(f"{name} must be ratios by mode, such as {{1: 0.01, 2: 0.02}}, got {shown(given)}")
    if not items:
        raise ValueError(f"{name} must have one ratio at least, got {shown(given)}")
    found = {
        whole_number(f"mode in {name}", mode): positive_real(f"{name}[{mode}]", value)
        for mode, value in items
    }
    if wrong := {mode: ratio for mode, ratio in found.items() if ratio >= 1.0}:
        raise ValueError(f"{name} must be less than 1 (0.01 is 1 % of critical), got {shown(wrong)}")
    return found


def damping_ratios(given: ArrayLike) -> Floats:
    """Return the damping ratios of modes in a row, one at least.

    Examples
    --------
    >>> damping_ratios(0.01)
    array([0.01])
    """
    ratios = np.atleast_1d(real_numbers("damping_ratio", given))
    wrong = ratios[(ratios < 0.0) | (ratios >= 1.0)]
    if ratios.ndim != 1 or not len(ratios) or len(wrong):
        raise ValueError(
            "damping_ratio must be one number or a row of them, one a mode, from 0 and less than 1 (0.01 is "
            f"1 % of critical), got {shown(given if not len(wrong) else float(wrong[0]))}"
        )
    return ratios


def given_for_asked(wanted: Mapping[int, float], found: Floats) -> str:
    """Return in words which ratios a fit gives for those that were asked for.

    Examples
    --------
    >>> given_for_asked({1: 0.01, 3: 0.02}, np.array([0.01, 0.015]))
    'modes 1, 3 get 0.01, 0.015 for 0.01, 0.02'
    """
    rows = (map(str, wanted), *((f"{ratio:.4g}" for ratio in each) for each in (found, wanted.values())))
    modes, given, asked = (", ".join(row) for row in rows)
    return f"modes {modes} get {given} for {asked}"


def modes_with_ratios(
    chain: Chain, damping: Damping | None, model: LinearModel | BentModel, count: int
) -> list[tuple[float, float]]:
    """Return frequency [rad/s] and damping ratio of the first modes, φᵀ C φ/(2 ω), with φᵀ M φ = 1.

    Of straight chains and of bent ones; dampers couple modes, which is left out.
    """
    given, modes = damping or Damping(), solve_modes(model, count)
    rate = given.mass + np.diff(modes.rotation, axis=1) ** 2 @ given.joint_damping(chain)
    for end, (translation, rotation) in enumerate(chain.support_stiffness.tolist()):
        for stiffness, shape in ((translation, modes.deflection), (rotation, modes.rotation)):
            if 0.0 < stiffness < np.inf:
                rate = rate + given.stiffness * stiffness * shape[:, -end] ** 2
    omega = modes.angular_frequency
    return list(zip(omega.tolist(), (rate / (2 * omega)).tolist(), strict=True))


def damped_modes(chain: Chain, damping: Damping) -> xarray.Dataset:
    """Return what damping does to every elastic mode of the linear chain.

        λ = -ζ ω ± i ω √(1 - ζ²),   det(λ² + λ G + Ω²) = 0

    Parameters
    ----------
    chain : Chain
        Of at most 500 hinges.
    damping : Damping

    Returns
    -------
    xarray.Dataset
        Over `mode`: undamped_angular_frequency; natural_angular_frequency |λ| and damping_ratio -Re λ/|λ| of
        the damped pair; damped_angular_frequency |Im λ|; and decay_rate, that of its slower part. Without
        dampers d a row is one mode throughout; with them the last four are in order of |λ|. A pair of real λ
        has a ratio of at least 1 and its geometric mean as |λ|; where dampers d make several such pairs, the
        fastest λ is paired with the slowest, which is a convention. Rigid-body modes are left out.
        The attribute `overdamped_modes` counts those that creep back and do not swing.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, `joint` does not suit the chain, or the chain is too long.

    Examples
    --------
    >>> import beammodes as bm
    >>> chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments=4)
    >>> tip = bm.damped_modes(chain, bm.Damping(joint=(0.0, 0.0, 0.0, 0.1)))       # at one hinge
    >>> tip.damping_ratio.values.round(4)
    array([4.000e-04, 3.000e-02, 1.039e-01, 7.022e-01])
    """
    import xarray

    modal = damping_of_modes(chain, damping)
    omega, coupling = modal.angular_frequency, modal.coupling
    if np.any(np.asarray(damping.joint)):
        natural, ratio = damped_pairs(damped_eigenvalues(omega, coupling))
    else:
        natural, ratio = omega, coupling.diagonal() / (2 * omega)
    under, over = (np.sqrt(np.maximum(sign * (1 - ratio**2), 0.0)) for sign in (1, -1))
    # ω/(ζ + √(ζ² - 1)) is the slower one of two real λ without the difference of two near numbers.
    slow = np.where(ratio > 1, natural / (ratio + over), ratio * natural)
    columns = {
        "undamped_angular_frequency": (omega, "angular frequency without damping", "rad/s"),
        "natural_angular_frequency": (natural, "modulus of the pair of eigenvalues", "rad/s"),
        "damping_ratio": (ratio, "damping ratio", "1"),
        "damped_angular_frequency": (natural * under, "angular frequency of the damped motion", "rad/s"),
        "decay_rate": (slow, "rate at which the envelope decays", "1/s"),
    }
    return xarray.Dataset(
        {
            name: ("mode", values, {"long_name": text, "units": unit})
            for name, (values, text, unit) in columns.items()
        },
        coords={"mode": ("mode", np.arange(1, len(omega) + 1), {"long_name": "elastic mode", "units": "1"})},
        attrs={
            "source": SOURCE,
            "rigid_body_modes": chain.boundary.rigid_body_modes,
            "overdamped_modes": int((ratio >= 1.0).sum()),
        },
    )


def damped_pairs(values: NDArray[np.complex128]) -> tuple[Floats, Floats]:
    """Return |λ| and ζ of each pair of eigenvalues, ascending by |λ|, paired as in `damped_modes`."""
    # A tiny imaginary part is a double root's rounding.
    upper = values[values.imag > 0]
    lone = np.sort(-values[values.imag == 0].real)
    slow, fast = lone[: len(lone) // 2], lone[::-1][: len(lone) // 2]
    means = np.sqrt(slow * fast)
    natural = np.concatenate([np.abs(upper), means])
    ratio = np.concatenate([-upper.real / np.abs(upper), (slow + fast) / (2 * means)])
    order = np.argsort(natural)
    return natural[order], ratio[order]
