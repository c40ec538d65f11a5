"""What an exported file says about itself, and the time step that an engine needs for it."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from beammodes.accuracy.chain_against_beam import SlendernessWarning, chain_errors, stout_remark
from beammodes.chains.chain import Chain
from beammodes.checks import percent, positive_real, shown
from beammodes.equations.equilibria import EquilibriumNotFound, find_equilibrium
from beammodes.equations.mechanics import axial_pull
from beammodes.exporters.planar_tree import Tree
from beammodes.numerics.arrays import Floats
from beammodes.problem.loading import Load
from beammodes.version import SOURCE
from beammodes.vibration.damping import Damping
from beammodes.vibration.integrators import accuracy_limit, find_integrator
from beammodes.vibration.linear import BentModel, LinearModel, linearize
from beammodes.vibration.modes import solve_modes
from beammodes.vibration.stability import GRAVITY, stable_time_step, taut_load

__all__ = [
    "MAX_HELD",
    "SYSTEMS",
    "EngineStep",
    "Facts",
    "digits",
    "engine_step",
    "facts_about",
    "held_step",
    "one_line",
]


# The stable step of a tree whose far end a constraint holds, in engines that take dampers implicitly.
#
# MuJoCo finds the force of a constraint with the plain inertia M, and then divides all forces by M + h D:
# hard
# dampers weaken what the constraint does. With the row J of the held deflection,
#
#     M a = -K q - D_all v + Jᵀ λ,   J a = -J v/h - J q/(4 h²),   v' = v + h (M + h D)⁻¹ M a,   q' = q + h v'.
#
# The chain's own matrices, in which the end is held by construction, do not know that.


#: Trees of more joints are not solved: each of some forty trial steps takes the eigenvalues of 2 N rows.
MAX_HELD = 40


# Of the step that is stable as a chain, the least that is tried; and how many.
_SHORTEST, _TRIALS = 1e-3, 24


def held_step(tree: Tree, letter: str, longest: float, pull: Sequence[float], *, tendons: bool) -> float:
    """Return the largest step up to `longest` below which a tree's motion in one plane does not grow [s].

    Parameters
    ----------
    tree : Tree
        With a tie of infinite stiffness.
    letter : str
        "z" or "y", the direction of deflection.
    longest : float [s]
        Where it is unstable as a chain.
    pull : sequence of float, one a body [N m]
        What a load adds to ∂²V/∂θ² of the bodies' angles.
    tendons : bool
        Whether dampers of ties are taken implicitly, as those of joints are.
    """
    inertia, stiffness, joints, ties, held = _matrices(tree, letter, pull)
    if held is None or not math.isfinite(longest):
        return longest
    implicit = joints + ties if tendons else joints
    lift, size = np.linalg.solve(inertia, held), len(inertia)
    # Accelerations of (q, v) without the constraint.
    free = -np.linalg.solve(inertia, np.hstack([stiffness, joints + ties]))

    def grows(step: float) -> bool:
        wanted = -np.concatenate([held / (4 * step**2), held / step])
        bound = free + np.outer(lift, (wanted - held @ free)) / (held @ lift)
        kick = step * np.linalg.solve(inertia + step * implicit, inertia @ bound)
        speed = kick + np.hstack([np.zeros((size, size)), np.eye(size)])
        place = step * speed + np.hstack([np.eye(size), np.zeros((size, size))])
        return bool(np.abs(np.linalg.eigvals(np.vstack([place, speed]))).max() > 1 + 1e-7)

    steps = (longest * np.geomspace(_SHORTEST, 1 - 1e-9, _TRIALS)).tolist()
    first = next((k for k, step in enumerate(steps) if grows(step)), None)
    if first is None:
        return longest
    below, above = (steps[first - 1] if first else 0.0), steps[first]
    for _ in range(6):
        middle = (below + above) / 2
        below, above = (below, middle) if grows(middle) else (middle, above)
    return below


def _matrices(
    tree: Tree, letter: str, pull: Sequence[float]
) -> tuple[Floats, Floats, Floats, Floats, Floats | None]:
    """Return M, K, D of the joints, D of the ties, and the row of what is held, in one plane's joints."""
    slide, hinge = {"z": ((0, 0, 1), (0, -1, 0)), "y": ((0, 1, 0), (0, 0, 1))}[letter]
    names: list[str] = []
    # Of every body so far: where the joints are, and what turns it and shifts it.
    places: list[float] = []
    kinds: list[bool] = []
    rows: list[tuple[Floats, Floats, float, float, float]] = []
    springs: list[tuple[float, float]] = []
    start = 0.0
    about = 1 if letter == "z" else 2
    for body, own in zip(tree.bodies, pull, strict=True):
        start += body.position
        for joint in body.joints:
            if joint.axis in (slide, hinge):
                names.append(joint.name)
                places.append(start)
                kinds.append(joint.axis == hinge)
                springs.append((joint.stiffness, joint.damping))
        turn = np.array(kinds, dtype=float)
        arm = np.where(kinds, start + body.centre - np.array(places), 1.0)
        rows.append((arm, turn, body.mass, body.inertia[about], own))
    size = len(names)
    inertia, stiffness = np.zeros((size, size)), np.diag([k for k, _ in springs])
    for arm, turn, mass, moment, own in rows:
        across, turned = (np.pad(row, (0, size - len(row))) for row in (arm, turn))
        inertia += mass * np.outer(across, across) + moment * np.outer(turned, turned)
        stiffness += own * np.outer(turned, turned)
    joints, ties, held = np.diag([d for _, d in springs]), np.zeros((size, size)), None
    for tie in tree.ties:
        arms = dict(tie.terms)
        if not set(arms) <= set(names):
            continue
        row = np.array([arms.get(name, 0.0) for name in names])
        if tie.stiffness == math.inf:
            held = row
        else:
            stiffness += tie.stiffness * np.outer(row, row)
            ties += tie.damping * np.outer(row, row)
    return inertia, stiffness, joints, ties, held


#: Relative error that the default step may add to the first frequency, or this share of its damping ratio if
#: that is more: what a tenth of the half width of a resonance is.
STEP_ERROR, DAMPED_ERROR = 1e-3, 0.1


_REPORTED = 3


_EXPLICIT, _IMPLICIT = "MuJoCo RK4", "MuJoCo implicitfast"


# Longer chains take more than some seconds to find their shape at rest.
_MAX_RESTING = 150


_STEP_WITHOUT_MODES = 0.002


@dataclass(frozen=True)
class _System:
    """What a file calls the units of its numbers, and gravity [length/s²] in them."""

    length: str
    stiffness: str
    mass_per_length: str
    all: str
    gravity: float


#: Systems of units that a file may be written in: those that the command line knows.
SYSTEMS = MappingProxyType(
    {
        "SI": _System("m", "N m2", "kg/m", "m, kg, s, N and rad", GRAVITY),
        "mm-N-t": _System("mm", "N mm2", "t/mm", "mm, t, s, N and rad", 1e3 * GRAVITY),
        "in-lbf-s": _System("in", "lbf in2", "lbf s2/in2", "in, lbf s2/in, s, lbf and rad", GRAVITY / 0.0254),
    }
)


@dataclass(frozen=True)
class Facts:
    """First frequencies of a chain [rad/s], their errors where it has a beam, and what dampers and loads do.

    `ratios` are damping ratios of the first modes; `loaded` is what a line says of the modes under the load.
    """

    chain: Chain
    first: tuple[float, ...]
    errors: tuple[float, ...]
    ratios: tuple[float, ...] = ()
    loaded: tuple[str, ...] = ()
    units: str | None = None

    def lines(self, turned: bool = False) -> list[str]:
        """Return what a reader of the file should know of the chain, one fact a line."""
        chain, kept = self.chain, []
        if chain.beam is not None:
            beam = chain.beam
            system = SYSTEMS[self.units or "SI"]
            means = f"EI {beam.mean_bending_stiffness:.6g} {system.stiffness}, "
            means += f"{beam.mean_mass_per_length:.6g} {system.mass_per_length}"
            uniform = "" if beam.is_uniform else " on average"
            supposed = "" if self.units else ", if it was given in SI units"
            kept.append(f"beam: length {beam.length:.6g} {system.length}, {means}{uniform}{supposed}")
        kept.append(f"ends: {chain.boundary.name}" + (", seen from the right one" if turned else ""))
        if chain.rule is not None:
            kept.append(f"rule: {chain.rule.name}, {chain.segments} segments")
        else:
            kept.append(f"pieces: {chain.pieces}, given one by one")
        shown_first = ", ".join(f"{omega / (2 * math.pi):.8g}" for omega in self.first)
        kept.append(f"natural frequencies of the chain: {shown_first or 'none'} Hz, undamped, without load")
        if self.errors:
            errors = (percent(error, 5, rounding=1e-10) for error in self.errors)
            kept.append(f"their errors against the exact beam: {', '.join(errors)}")
        if chain.beam is not None:
            kept += filter(None, [stout_remark(chain.beam, chain.boundary, np.array(self.errors))])
        if self.ratios:
            kept.append(f"damping ratios of these modes, without load: {_few(self.ratios, '.4g')}")
        kept += self.loaded
        usual = "m, kg, s and rad, if the beam was given in them; else the consistent set it was in"
        kept.append(f"units: {SYSTEMS[self.units].all if self.units else usual}")
        return [f"written by {SOURCE}", *map(one_line, kept)]


def facts_about(
    chain: Chain, damping: Damping | None = None, load: Load | None = None, units: str | None = None
) -> Facts:
    """Solve for the frequencies that a chain's file announces, also about its shape at rest under a load.

    Dampers keep their forces under a load, not their ratio: a chain that hangs is stiffer, and less damped.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> print(facts_about(Chain(Beam.unit(), "clamped-free", 6)).lines()[-2])
    their errors against the exact beam: -0.35175 %, -3.4226 %, -6.1362 %
    """
    first = solve_modes(linearize(chain), _REPORTED).angular_frequency.tolist()
    errors: list[float] = []
    if chain.beam is not None and first:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SlendernessWarning)
            errors = chain_errors(chain, len(first)).tolist()
    ratios: tuple[float, ...] = ()
    if damping not in (None, Damping()):
        ratios = tuple(ratio for _, ratio in _damped_modes(chain, damping, linearize(chain)))
    loaded = () if load in (None, Load()) else _under(chain, damping, load)
    return Facts(chain, tuple(first), tuple(errors), ratios, loaded, units)


def _under(chain: Chain, damping: Damping | None, load: Load | None) -> tuple[str, ...]:
    """Return what a file says of the first modes about the shape that a load gives the chain."""
    unknown = f"natural frequencies under {load}: others than these, and not known here: "
    if chain.pieces > _MAX_RESTING:
        return (f"{unknown}the chain has more than {_MAX_RESTING} pieces",)
    try:
        modes = _damped_modes(chain, damping, linearize(chain, at=find_equilibrium(chain, load)))
    except (EquilibriumNotFound, ArithmeticError, ValueError) as error:
        return (f"{unknown}{error}",)
    if not modes:
        return ()
    hertz = _few([omega / (2 * math.pi) for omega, _ in modes], ".6g")
    said = f"natural frequencies under {load}, about its shape at rest: {hertz} Hz, undamped"
    if damping in (None, Damping()):
        return (said,)
    return said, f"damping ratios there: {_few([ratio for _, ratio in modes], '.4g')}"


def _few(values: Sequence[float], form: str) -> str:
    return ", ".join(format(value, form) for value in values)


@dataclass(frozen=True)
class EngineStep:
    """The time step of a file [s], and lines that say which cases it holds for."""

    size: float
    lines: tuple[str, ...]


def engine_step(
    chains: Sequence[Chain],
    engine: str,
    damping: Damping | None = None,
    timestep: float | None = None,
    load: Load | None = None,
    tree: Tree | None = None,
    units: str | None = None,
) -> EngineStep:
    """Return `timestep`, or half the stable step, less if it would shift the first frequency by over 0.1 %.

    Or its amplitude by over 1 % in 100 periods. A tenth of the damping ratio is allowed instead of 0.1 and of
    1 % where that is more.

    Parameters
    ----------
    chains : sequence of Chain
        That bend along z, and along y.
    engine : str
        Name of an integrator in an engine, such as "MuJoCo RK4".
    damping, timestep
        As `export_chain` takes them.
    tree : Tree, optional
        The bodies and ties that the file has: where a constraint holds its far end in MuJoCo, hard dampers
        shorten the step (see `held_step`).
    load : Load, optional
        What the step holds for. By default it holds without gravity and with 9.81 m/s² in any direction,
        along a chain that hangs too.
    units : str, optional
        Of `SYSTEMS`: what the chain's numbers are in, for that gravity.

    Raises
    ------
    TypeError, ValueError
        If the integrator is unknown, or `timestep` is no number or beyond the limit of stability.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> chain = Chain(Beam.unit(), "clamped-free", 10)
    >>> engine_step([chain], "MuJoCo RK4").size, engine_step([chain], "MuJoCo RK4", load=Load()).size
    (0.0021, 0.00211)
    """
    record = find_integrator(engine)
    given = None if timestep is None else positive_real("timestep", timestep)
    system = SYSTEMS[units or "SI"]
    weighed = f"with gravity {system.gravity:.4g} {system.length}/s2 in any direction"
    # Across the beam, so that no direction is preferred: see `taut_load`.
    cases = {"with gravity off": Load(), weighed: Load(gravity=system.gravity)}
    if load is not None:
        cases = {"without load" if load == Load() else f"under {load}": load}
    if tree is not None and tree.turned:
        # The file holds the right end along the beam, not the left one: let loads pull either way.
        cases = {case: _across(each) for case, each in cases.items()}
    limits = {
        case: min(
            _stable_step(chain, letter, engine, damping, each, tree)
            for chain, letter in zip(chains, "zy", strict=False)
        )
        for case, each in cases.items()
    }
    name = engine.partition(" ")[2]
    least, first = min(limits.values()), next(iter(limits.values()))
    if given is not None and given >= first:
        raise ValueError(
            f"timestep must be less than {first:.3g}, where {name} becomes unstable, got {shown(timestep)}"
        )
    modes = [
        mode for chain in chains for each in cases.values() for mode in _first_mode(chain, damping, each)
    ]
    accurate = min((_accurate_step(engine, *mode) for mode in modes), default=math.inf)
    best = min(least / 2, accurate)
    size = given or (_rounded_down(best) if math.isfinite(best) else _STEP_WITHOUT_MODES)
    if not math.isfinite(first):
        return EngineStep(size, ())
    said = ", ".join(f"{limit:.4g} s {case}" for case, limit in limits.items())
    lines = [f"largest stable timestep in {engine}: {said}"]
    if size >= least:
        lines.append(f"WARNING: the timestep given, {size!r}, is stable with gravity off only")
    if damping not in (None, Damping()) and record.damping == "implicit":
        explicit = min(
            stable_time_step(chain, "semi_implicit_euler", load=each, damping=damping)
            for chain in chains
            for each in cases.values()
        )
        flag = ", with the flag eulerdamp that is on by default" if name == "Euler" else ""
        lines.append(f"dampers of joints are taken implicitly{flag}; taken explicitly: {explicit:.4g} s")
    if damping not in (None, Damping()) and engine == _EXPLICIT:
        limit = min(
            _stable_step(chain, letter, _IMPLICIT, damping, each, tree)
            for chain, letter in zip(chains, "zy", strict=False)
            for each in cases.values()
        )
        if limit > 2 * least:
            lines.append(
                f"dampers shorten it: {_IMPLICIT}, which takes them implicitly, is stable to {limit:.4g} s"
            )
    if load is not None and (any(load.tip) or load.tip_moment or load.axial_force or load.spin_rate):
        lines.append("this file holds gravity only: the other loads are yours to apply")
    return EngineStep(size, tuple(map(one_line, lines)))


def _across(load: Load) -> Load:
    weight, force = (math.hypot(*map(float, pair)) for pair in (load.weight, load.tip))
    return replace(load, gravity=weight, tip_force=force)


def _stable_step(
    chain: Chain, letter: str, engine: str, damping: Damping | None, load: Load, tree: Tree | None
) -> float:
    record, step = find_integrator(engine), stable_time_step(chain, engine, load=load, damping=damping)
    held = tree is not None and any(tie.stiffness == math.inf for tie in tree.ties)
    if tree is None or not held or damping in (None, Damping()) or record.damping == "explicit":
        return step
    if len(tree.bodies) > MAX_HELD:
        return min(step, stable_time_step(chain, "semi_implicit_euler", load=load, damping=damping))
    pull = np.array(axial_pull(chain, taut_load(chain, load)), dtype=np.float64) * chain.units.stiffness
    pull = pull[::-1] if tree.turned else pull
    if chain.held_angles[0 if tree.turned else -1]:
        pull = pull[:-1]
    own = pull[len(pull) - len(tree.bodies) :].tolist()
    return held_step(tree, letter, step, own, tendons=not record.tendon_damping)


def _first_mode(chain: Chain, damping: Damping | None, load: Load) -> list[tuple[float, float]]:
    """Return frequency and damping ratio of a chain's first mode under a load, or nothing without modes."""
    return _damped_modes(chain, damping, linearize(chain, load=taut_load(chain, load)), 1)


def _damped_modes(
    chain: Chain, damping: Damping | None, model: LinearModel | BentModel, count: int = _REPORTED
) -> list[tuple[float, float]]:
    """Return frequency [rad/s] and damping ratio of the first modes, φᵀ C φ/(2 ω), with φᵀ M φ = 1.

    C is that of the joints and of elastic supports: what a file carries.
    """
    given, modes = damping or Damping(), solve_modes(model, count)
    rate = np.diff(modes.rotation, axis=1) ** 2 @ given.joint_damping(chain)
    for end, (translation, rotation) in enumerate(chain.support_stiffness.tolist()):
        for stiffness, shape in ((translation, modes.deflection), (rotation, modes.rotation)):
            if 0.0 < stiffness < math.inf:
                rate = rate + given.stiffness * stiffness * shape[:, -end] ** 2
    omega = modes.angular_frequency
    return list(zip(omega.tolist(), (rate / (2 * omega)).tolist(), strict=True))


def _accurate_step(engine: str, omega: float, ratio: float) -> float:
    if ratio >= 1.0:
        return math.inf
    share = DAMPED_ERROR * ratio
    limit = accuracy_limit(
        engine, ratio, frequency=max(STEP_ERROR, share), amplitude=max(10 * STEP_ERROR, share)
    )
    return limit / omega


def _rounded_down(step: float) -> float:
    unit = math.floor(math.log10(step)) - 2
    return float(f"{math.floor(step / 10.0**unit)}e{unit}")


def digits(value: float) -> str:
    """Return a number in the 17 significant digits that keep it.

    Examples
    --------
    >>> digits(1 / 3), digits(2.0)
    ('0.33333333333333331', '2')
    """
    return f"{value:.17g}"


def one_line(text: str) -> str:
    """Return `text` as every format's comments can carry it: printable, on one line.

    Examples
    --------
    >>> one_line("a rule\\nof two --> lines")
    'a rule of two - -> lines'
    """
    plain = "".join(c if c.isprintable() else " " for c in text)
    while "--" in plain:
        plain = plain.replace("--", "- -")
    return plain
