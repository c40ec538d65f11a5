"""Time steps: the report's, and the longest at which a chain is stable.

The report's step is  h = C L² √(ρA/EI),  C = 8/K_n, where K_n is the n-th dimensionless frequency of a beam
clamped at both ends, in Roark's rounded figures. At fixed step it is not stable: classical Runge-Kutta asks
for  h ω ≤ √8  of the chain's highest mode, near 6.9 N² √(EI/(ρA L⁴)). The page "theory" has where the 8 comes
from.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from beammodes.chains.axial_chain import AxialChain
from beammodes.chains.chain import Chain
from beammodes.chains.spatial_chain import SpatialChain
from beammodes.chains.structure_chain import StructureChain
from beammodes.checks import shown, whole_number
from beammodes.equations.mechanics import axial_pull
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.load_in_space import SpatialLoad
from beammodes.problem.loading import Load, checked_load
from beammodes.problem.rod import Rod
from beammodes.vibration.axial_spectrum import highest_axial_frequency
from beammodes.vibration.damping import (
    Damping,
    ModalDamping,
    checked_damping,
    damped_eigenvalues,
    damping_along,
    damping_of_modes,
)
from beammodes.vibration.highest_in_space import MOST_SOLVED, damping_in_space, highest_in_space
from beammodes.vibration.integrators import (
    Integrator,
    find_integrator,
    fixed_step_integrator,
    stability_limit,
)
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import MAX_DENSE, solve_modes
from beammodes.vibration.spectrum import is_turned
from beammodes.vibration.structure_vibration import structure_chain_modes

__all__ = [
    "GRAVITY",
    "ROARK_CLAMPED_CLAMPED",
    "highest_angular_frequency",
    "modal_time_step",
    "published_constants",
    "published_time_step",
    "stable_time_step",
    "taut_load",
]

#: Gravity that a step is held against where none is given [m/s²], in any direction.
GRAVITY = 9.81
#: K_1 to K_5 as printed by Roark and Young, Formulas for Stress and Strain, p. 576, both ends fixed.
ROARK_CLAMPED_CLAMPED = (22.4, 61.7, 121.0, 200.0, 299.0)


def published_constants() -> Floats:
    """Return the report's C for 1 to 5 modes, C = 8/K_n to its three printed decimals, shape (5,).

    Source: the report's table, headed "Constant K"; its step 2 calls the same number C.

    Examples
    --------
    >>> published_constants()
    array([0.357, 0.13 , 0.066, 0.04 , 0.027])
    """
    return np.round(8 / np.array(ROARK_CLAMPED_CLAMPED), 3)


def published_time_step(beam: Beam | Rod, modes: int) -> float:
    """Return the report's largest step  h = C L² √(ρA/EI)  [s]; at fixed step it is not stable.

    Parameters
    ----------
    beam : Beam or Rod
        L, EI and ρA; of a rod in space the larger EI, straight or not: the report knows no twist.
    modes : int
        Number of modes to be followed, 1 to 5, in the plane.

    Returns
    -------
    float
        The step [s].

    Raises
    ------
    TypeError, ValueError
        If `beam` is no Beam or `modes` lies outside the table.

    Examples
    --------
    >>> import beammodes as bm
    >>> bm.published_time_step(bm.Beam.unit(), modes=3)
    0.066
    """
    if not isinstance(beam, Beam | Rod):
        raise TypeError(f"beam must be a Beam or a Rod, got {shown(beam)}")
    constants = published_constants()
    planes = [beam.planar(axis) for axis in (1, 2)] if isinstance(beam, Rod) else [beam]
    unit = max(plane.frequency_unit for plane in planes)
    return float(constants[whole_number("modes", modes, most=len(constants)) - 1] / unit)


def stable_time_step(
    chain: Chain | AxialChain | SpatialChain | StructureChain,
    integrator: str = "rk4",
    *,
    load: Load | SpatialLoad | None = None,
    damping: Damping | None = None,
) -> float:
    """Return the largest fixed step at which a chain's small motion is stable [s].

        rk4                                  |R(h λ)| = 1 for the first eigenvalue λ of the damped chain
        springs and dampers explicit         h² Ω² + 2 h G = 4    (leapfrog, semi_implicit_euler)
        springs explicit, dampers implicit   h² Ω² - 2 h G = 4    (MuJoCo's Euler, implicit and implicitfast,
                                                                   Drake's discrete plants)

    where "= 4" is for the largest eigenvalue, and G is the damping matrix of the undamped modes. For one mode
    of frequency ω and damping ratio ζ the last two are  h = 2 (√(1 + ζ²) ∓ ζ)/ω:  damping shortens the step
    of engines that take it explicitly and lengthens that of those that take it implicitly. Without damping
    h = 2√2/ω_max or 2/ω_max.

    Parameters
    ----------
    chain : Chain, AxialChain, SpatialChain or StructureChain
        A structure is taken without a load and with damping in proportion to mass and stiffness (MuJoCo's
        Euler as if its tendons damped like joints), a chain in twist or stretch without a load. Of a
        uniform one between fixed or free ends ω_max ≤ (2N/L) √(GJ/ρIp), by `simpson` with 2.12 N for 2N; a
        light disc behind a hinge of its own, or a stiff spring on a stub, takes it beyond any bound.
        Its own highest frequency decides, not the modes that one wants to see. Of more than 500 hinges, and
        in space of more than 200, the answer is a lower bound: within a few percent without damping or
        without a load (in space a fifth to a half, by stubs and curvature), else less close. In space
        MuJoCo's Euler is taken as if it damped explicitly where the end at s = L is tied to the ground.
    integrator : str
        A name in `INTEGRATORS` of fixed step, or an engine's, such as "MuJoCo implicitfast".
    load : Load or, in space, SpatialLoad, optional
        No load by default: a chain that hangs is stiffened by its weight and by what hangs on it, and needs a
        shorter step. Loads along the chain that pull are taken as they are. Of one that bends or pushes the
        chain the answer is a lower bound, by the pull that it could have: that of a chain which hangs.
    damping : Damping, optional

    Returns
    -------
    float
        Infinite for a chain without elastic modes, and for an integrator that takes springs implicitly.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, the integrator is unknown or chooses its steps itself, `joint` of
        the damping does not suit the chain, or an axial force buckles it.

    References
    ----------
    E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, § IV.2. The second and third
    condition: the step's matrix has the eigenvalue -1. All its eigenvalues obey quadratic equations of real
    coefficients, since Ω² and G are symmetric, and leave the unit circle nowhere else.

    Examples
    --------
    >>> import beammodes as bm
    >>> chain = bm.Chain(bm.Beam(4.0, 1e-3, 0.026), "pinned-free(mass=0.75)", segments=20)
    >>> round(bm.stable_time_step(chain, "MuJoCo Euler"), 4)
    0.0596
    >>> round(bm.stable_time_step(chain, "MuJoCo Euler", load=bm.Load(gravity=(9.81, 0.0))), 4)   # it hangs
    0.0066
    """
    record = fixed_step_integrator(integrator)
    if not isinstance(chain, Chain | AxialChain | SpatialChain | StructureChain):
        raise TypeError(
            f"chain must be a Chain, AxialChain, SpatialChain or StructureChain, got {shown(chain)}"
        )
    checked_damping(damping)
    if isinstance(chain, SpatialChain):
        return _step_in_space(record, chain, load, damping)
    if isinstance(load, SpatialLoad):
        raise TypeError(f"load must be a Load, or None, for a chain in a plane, got {shown(load)}")
    if isinstance(chain, AxialChain):
        return _axial_step(record, chain, load, damping)
    if isinstance(chain, StructureChain):
        if load is not None:
            raise ValueError(f"load must be left out for a chain of a structure, got {shown(load)}")
        return _step_of_structure(record, chain, damping or Damping())
    straight = taut_load(chain, checked_load(load))
    if record.springs == "implicit":
        return math.inf
    if damping is None or damping == Damping():
        highest = highest_angular_frequency(chain, load=straight)
        return stability_limit(record.name) / highest if highest else math.inf
    if len(chain.scaled.joint_stiffness) > MAX_DENSE:
        return _bounded_step(record, chain, straight, damping)
    return modal_time_step(record, damping_of_modes(chain, damping, straight))


def _step_of_structure(record: Integrator, chain: StructureChain, damping: Damping) -> float:
    if np.any(np.asarray(damping.joint)):
        raise ValueError(
            f"damping must be without dampers of joints for a chain of a structure, got {damping}"
        )
    if record.springs == "implicit":
        return math.inf
    modes = structure_chain_modes(chain)
    omega = modes.angular_frequency
    if damping == Damping():
        return stability_limit(record.name) / float(omega.max()) if len(omega) else math.inf
    joints = np.diag(damping.mass + damping.stiffness * omega**2)
    drag = damping.mass if modes.rigid_body_modes else 0.0
    return modal_time_step(record, ModalDamping(omega, joints, np.zeros_like(joints), drag))


def _axial_step(record: Integrator, chain: AxialChain, load: Load | None, damping: Damping | None) -> float:
    if load is not None and load != Load():
        raise ValueError(f"load must be left out for a chain in {chain.motion.name}, got {shown(load)}")
    rates = (damping or Damping()).own_of_joints(chain)
    if record.springs == "implicit":
        return math.inf
    highest = highest_axial_frequency(chain)
    if damping is None or damping == Damping():
        return stability_limit(record.name) / highest if highest else math.inf
    if len(rates) > MAX_DENSE:
        springs = (chain.boundary.left.stiffness, chain.boundary.right.stiffness)
        return _step_by_rates(record, highest, damping, _rates(rates, chain.joint_stiffness, springs))
    return modal_time_step(record, damping_along(chain, damping))


def _step_in_space(record: Integrator, chain: SpatialChain, load: object, damping: Damping | None) -> float:
    if load is not None and not isinstance(load, SpatialLoad):
        raise TypeError(f"load must be a SpatialLoad or None for a chain in space, got {shown(load)}")
    if load is not None and (any(load.moment) or load.torque):
        raise ValueError(f"load must be forces and gravity for a stable step, got {shown(load)}")
    rates = (damping or Damping()).own_of_joints(chain)
    if record.springs == "implicit":
        return math.inf
    highest = highest_in_space(chain, load).angular_frequency
    if damping is None or damping == Damping():
        return stability_limit(record.name) / highest if highest else math.inf
    if record.tendon_damping and chain.ends.right.stiffness.any():
        # What ties the far end to the ground is damped explicitly: no step is shorter than that of all so.
        record = find_integrator("semi_implicit_euler")
    if rates.size > MOST_SOLVED:
        springs = (*chain.ends.left.stiffness, *chain.ends.right.stiffness)
        return _step_by_rates(record, highest, damping, _rates(rates, chain.joint_stiffness, springs))
    return modal_time_step(record, damping_in_space(chain, damping, load))


def _rates(own: Floats, stiffness: Floats, supports: Sequence[float]) -> Floats:
    """Return d/k of joints that turn, and of supports' springs, which have no dampers of their own."""
    turning = np.isfinite(stiffness)
    sprung = any(0.0 < spring < math.inf for spring in supports)
    return np.append(own[turning] / stiffness[turning], np.zeros(int(sprung)))


def _step_by_rates(record: Integrator, highest: float, damping: Damping, rates: Floats) -> float:
    """Return a step below the stable one of a long chain, joints of which have d_j/k_j = `rates`.

    Between the least and the largest rate lies what joints damp: G ≤ α + (β + max d/k) Ω², and likewise from
    below.
    """
    if record.stages:
        ratio = (damping.mass / highest + (damping.stiffness + float(rates.max())) * highest) / 2
        return _radius_step(record, highest, ratio)
    if record.damping == "explicit":
        effect = damping.mass + (damping.stiffness + float(rates.max())) * highest**2
    else:
        effect = -(damping.mass + (damping.stiffness + float(rates.min())) * highest**2)
    return _kick_step(np.array([highest]), np.array([[effect]]), 0.0)


def _radius_step(record: Integrator, highest: float, ratio: float) -> float:
    """Return a step of a Runge-Kutta method for modes up to this frequency and damping ratio."""
    # Every eigenvalue lies within this radius, and the least limit of all rays holds.
    least = min(stability_limit(record.name, z) for z in np.linspace(0.0, 1.0, 101).tolist())
    return least / (highest * (ratio + math.hypot(1.0, ratio)))


def modal_time_step(record: Integrator, modal: ModalDamping) -> float:
    """Return the largest stable step of an integrator that takes springs explicitly, for damped modes [s]."""
    omega = modal.angular_frequency
    if record.stages:
        values = map(complex, [*damped_eigenvalues(omega, modal.coupling), -modal.drag])
        # Rounding may put a mode that no damper reaches beyond the imaginary axis.
        steps = [
            stability_limit(record.name, min(max(0.0, -z.real / abs(z)), 1.0)) / abs(z) for z in values if z
        ]
        return min(steps, default=math.inf)
    sign = {"explicit": 1.0, "implicit": -1.0}
    effect = sign[record.damping] * modal.joints
    effect = effect + sign[record.tendon_damping or record.damping] * modal.far_support
    return _kick_step(omega, effect, max(0.0, sign[record.damping] * modal.drag))


def _kick_step(omega: Floats, effect: Floats, drag: float) -> float:
    """Return the h where the largest eigenvalue of  h² Ω² + 2 h `effect`  is 4."""
    diagonal = effect.diagonal()
    if not np.any(effect - np.diag(diagonal)):
        # λ² - g λ - ω² = 0 for each mode, without the difference of two near numbers.
        half = np.hypot(diagonal / 2, omega) + abs(diagonal) / 2
        roots = np.where(diagonal >= 0, half, omega**2 / half)
    else:
        # λ² - λ G - Ω² has real roots, and h = 2/λ of the largest one.
        size = np.diag(omega)
        roots = np.linalg.eigvalsh(np.block([[effect, size], [size, np.zeros_like(size)]]))
    highest = float(max([drag, *roots]))
    return 2.0 / highest if highest > 0 else math.inf


def _bounded_step(record: Integrator, chain: Chain, load: Load, damping: Damping) -> float:
    """Return a step below the stable one of a long chain: joints damp no mode more than by their worst."""
    highest = highest_angular_frequency(chain, load=load)
    rates = damping.joint_damping(chain) / chain.joint_stiffness
    if not highest:
        return 2.0 / damping.mass if damping.mass and record.damping == "explicit" else math.inf
    if not record.stages:
        stiffness, rate = _joint_matrices(chain, load, damping)
        # As for the modes of a whole chain, joint by joint.
        signs = np.full(len(rate), 1.0 if record.damping == "explicit" else -1.0)
        last = 0 if is_turned(chain) else -1
        if record.tendon_damping and (chain.held_angles[last] or np.any(chain.support_stiffness[last] > 0)):
            signs[last] = 1.0
        values, vectors = np.linalg.eigh(stiffness)
        root = (vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]) @ np.swapaxes(vectors, 1, 2)
        zero = np.zeros_like(root)
        both = np.block([[signs[:, None, None] * rate, root], [root, zero]])
        return 2.0 / float(np.linalg.eigvalsh(both)[:, -1].max())
    ratio = (damping.mass / highest + max(damping.stiffness, float(rates.max())) * highest) / 2
    return _radius_step(record, highest, ratio)


def taut_load(chain: Chain, load: Load) -> Load:
    """Return a load that leaves a chain straight and makes it at least as stiff as `load` does.

    That is `load` itself where it pulls along the chain. Otherwise the chain hangs: weight and the tip's
    force turn along it, so that every piece is pulled with all of them that lies beyond it. No shape at rest
    pulls harder on a piece, since the forces on what lies beyond are in balance. Where the right end is held
    too, or alone, every piece is pulled with the whole of them; and likewise where a body that lies on the
    other side of its hinge would fall over as the chain hangs. A chain that nothing holds falls freely.

    Examples
    --------
    >>> chain = Chain(Beam.unit(), "clamped-free", segments=4)
    >>> print(taut_load(chain, Load(gravity=9.81)))
    Load(gravity=(9.81, 0.0))
    """
    pushes = load.weight[0] < 0 or load.tip[0] < 0
    held = chain.boundary.left.is_grounded or chain.boundary.right.is_grounded
    if not (any(load.weight) or any(load.tip) or load.tip_moment):
        return load
    if not (load.bends or pushes) and chain.boundary.left.is_grounded:
        return load
    pull, force, weight = (
        max(0.0, float(load.axial_force)),
        *(math.hypot(*map(float, pair)) for pair in (load.tip, load.weight)),
    )
    if chain.boundary.left.is_grounded and not chain.boundary.right.is_grounded:
        hung = replace(load, axial_force=pull, gravity=(weight, 0.0), tip_force=(force, 0.0), tip_moment=0.0)
        if not _topples(chain, hung):
            return hung
    pull += force + (float(chain.mass.sum()) * weight if held else 0.0)
    # A body that reaches farther back than its piece is long pulls that much harder on it.
    pieces = zip(chain.scaled.centre, chain.scaled.length, strict=True)
    pull *= max(1.0, *(-float(centre / length) for centre, length in pieces if length))
    return replace(load, axial_force=pull, gravity=(0.0, 0.0), tip_force=(0.0, 0.0), tip_moment=0.0)


def _topples(chain: Chain, load: Load) -> bool:
    """Return whether a body on the other side of its hinge makes the straight chain unstable as it hangs."""
    # Long chains are bounded joint by joint, where no push counts.
    if min(chain.scaled.centre) >= 0 or len(chain.scaled.joint_stiffness) > MAX_DENSE:
        return False
    try:
        solve_modes(linearize(chain, load=load), 1)
    except ValueError:
        return True
    return False


def highest_angular_frequency(chain: Chain, *, load: Load | None = None) -> float:
    """Return the chain's highest natural frequency, or a bound just above it for a long chain [rad/s].

    A chain of at most 500 hinges is solved. For a longer one the answer is the largest of its joints' own
    frequencies,  ω² ≤ max_j  λ_max(M_j⁻¹ K_j),  where M_j is the inertia of the two pieces at joint j and
    K_j its spring, supports and tension, each shared equally among its joints: kinetic and stored energy are
    sums over joints, so no mode can exceed the largest ratio. On uniform rods it is the band edge √48 N²,
    which the mode itself approaches.

    Examples
    --------
    >>> round(highest_angular_frequency(Chain(Beam.unit(), "guided-guided", segments=1)) ** 2, 9)
    48.0
    """
    if not isinstance(chain, Chain):
        raise TypeError(f"chain must be a Chain, got {shown(chain)}")
    model = linearize(chain, load=load)
    if model.elastic_modes == 0:
        return 0.0
    if len(chain.scaled.joint_stiffness) <= MAX_DENSE:
        return float(solve_modes(model).angular_frequency[-1])
    return _joint_bound(chain, model.load)


def _joint_bound(chain: Chain, load: Load) -> float:
    """Return the largest joint frequency, each joint's two pieces taken as free at their far tips."""
    stiffness, _ = _joint_matrices(chain, load, Damping())
    return float(np.sqrt(np.linalg.eigvalsh(stiffness)[:, -1].max()))


def _joint_matrices(chain: Chain, load: Load, damping: Damping) -> tuple[Floats, Floats]:
    """Return stiffness and damping of each joint in coordinates of unit inertia, shape (hinges, 3, 3).

    In (deflection of the hinge, angle of the left piece, angle of the right piece) a piece with its centre of
    mass a beyond the hinge has mass m, first moment m a and inertia J + m a². A held piece keeps its angle.
    Supports and an axial force are shared among the joints as the inertia of their pieces is.
    """
    length, mass, centre = chain.length, chain.mass, chain.centre
    joints = np.full(chain.pieces, 2.0)
    joints[[0, -1]] = 1.0
    held = np.array(chain.held_angles)
    inertia, stiffness, rate = np.zeros((3, chain.pieces - 1, 3, 3))
    unit = chain.units.stiffness
    pull = np.where(held, 0.0, np.maximum(0.0, np.array(axial_pull(chain, load), dtype=np.float64)) * unit)
    dampers = damping.joint_damping(chain)
    for side, pieces, arm in ((1, slice(None, -1), centre - length), (2, slice(1, None), centre)):
        share, free = 1 / joints[pieces], ~held[pieces]
        moment = (mass * arm)[pieces] * free
        turning = (chain.rotary_inertia + mass * arm**2)[pieces]
        inertia[:, 0, 0] += mass[pieces] * share
        inertia[:, 0, side] = inertia[:, side, 0] = moment * share
        inertia[:, side, side] = np.where(free, turning * share, 1.0)
        stiffness[:, side, side] = (chain.joint_stiffness + pull[pieces] * share) * free
        rate[:, side, side] = dampers * free
    free = ~held[:-1] * ~held[1:]
    stiffness[:, 1, 2] = stiffness[:, 2, 1] = -chain.joint_stiffness * free
    rate[:, 1, 2] = rate[:, 2, 1] = -dampers * free
    for joint, side, reach, (translation, rotation) in (
        (0, 1, -length[0], chain.support_stiffness[0]),
        (-1, 2, length[-1], chain.support_stiffness[1]),
    ):
        tip, turn = np.array([1.0, 0.0, 0.0]), np.zeros(3)
        tip[side] = 0.0 if held[[0, -1][side - 1]] else reach
        turn[side] = 1.0
        for spring, row in ((translation, tip), (rotation, turn)):
            if np.isfinite(spring):
                stiffness[joint] += spring * np.outer(row, row)
                rate[joint] += damping.stiffness * spring * np.outer(row, row)
    rate += damping.mass * inertia
    lower = np.linalg.inv(np.linalg.cholesky(inertia))
    local, lost = (lower @ each @ np.swapaxes(lower, 1, 2) for each in (stiffness, rate))
    return local, lost
