"""Damping ratios of a chain: dampers that give a mode the one wanted, and what they do to all other modes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.checks import positive_real, shown, whole_number
from beammodes.vibration.damping import Damping, check_damped, damped_eigenvalues, damping_of_modes
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

if TYPE_CHECKING:
    import xarray

__all__ = ["damped_modes", "damped_pairs", "joint_dampers"]

Array = NDArray[np.float64]


def joint_dampers(chain: Chain, ratio: float, *, mode: int = 1) -> Damping:
    """Return the joint dampers, proportional to the springs, that give a mode a damping ratio.

        d_j = β k_j,   β = 2 ζ/ω_mode

    Every other mode gets ζ ω/ω_mode: the higher, the more. Springs of elastic supports are damped likewise.

    Parameters
    ----------
    chain : Chain
    ratio : float
        ζ, 1 for critical damping.
    mode : int
        From 1; rigid-body modes are not counted.

    Raises
    ------
    TypeError, ValueError
        If `chain` is no Chain or has no such mode, or `ratio` is not a finite real number greater than 0.

    Source
    ------
    Rayleigh, The Theory of Sound, vol. 1 (1877), on dissipation functions.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> chain = Chain(Beam.unit(), "clamped-free", segments=4)
    >>> damping = joint_dampers(chain, 0.01)
    >>> damped_modes(chain, damping).damping_ratio.values.round(4)
    array([0.01  , 0.0585, 0.1536, 0.2662])
    """
    check_damped(chain, Damping())
    wanted, model = positive_real("ratio", ratio), linearize(chain)
    if not model.elastic_modes:
        raise ValueError(f"chain must have an elastic mode to damp, got {shown(chain)}")
    number = whole_number("mode", mode, most=model.elastic_modes)
    omega = float(solve_modes(model, number).angular_frequency[-1])
    return Damping(stiffness=2.0 * wanted / omega)


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

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, `joint` does not suit the chain, or the chain is too long.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> chain = Chain(Beam.unit(), "clamped-free", segments=4)
    >>> tip = damped_modes(chain, Damping(joint=(0.0, 0.0, 0.0, 0.1)))             # one damper, at one hinge
    >>> tip.damping_ratio.values.round(4)
    array([4.000e-04, 3.000e-02, 1.039e-01, 7.022e-01])
    """
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
    return _labelled(columns, chain.boundary.rigid_body_modes)


def damped_pairs(values: NDArray[np.complex128]) -> tuple[Array, Array]:
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


def _labelled(columns: dict[str, tuple[Array, str, str]], rigid_body_modes: int) -> xarray.Dataset:
    """Return columns of (values, description, unit) over the modes."""
    import xarray

    from beammodes import __version__

    mode = np.arange(1, len(columns["damping_ratio"][0]) + 1)
    return xarray.Dataset(
        {
            name: ("mode", values, {"long_name": text, "units": unit})
            for name, (values, text, unit) in columns.items()
        },
        coords={"mode": ("mode", mode, {"long_name": "elastic mode", "units": "1"})},
        attrs={"source": f"beammodes {__version__}", "rigid_body_modes": rigid_body_modes},
    )
