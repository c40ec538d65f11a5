"""The time step that an engine needs for an exported chain: stable, and accurate for its first mode.

Where a constraint holds the far end, MuJoCo finds its force with the plain inertia M, and then divides all
forces by M + h D: hard dampers weaken the constraint. With the rows J of the held deflection,

    M a = -K q - D_all v + Jᵀ λ,   J a = -J v/h - J q/(4 h²),   v' = v + h (M + h D)⁻¹ M a,   q' = q + h v'.

The chain's own matrices hold that end by construction, so `stable_time_step` does not see this.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.checks import positive_real, shown
from beammodes.equations.mechanics import axial_pull
from beammodes.exporters.export_facts import one_line
from beammodes.exporters.model_tree import Tree
from beammodes.exporters.planar_tree import AXES
from beammodes.exporters.tree_matrices import TreeMatrices, tree_matrices
from beammodes.exporters.unit_systems import UNIT_SYSTEMS
from beammodes.problem.loading import Load
from beammodes.vibration.damping import Damping, modes_with_ratios
from beammodes.vibration.integrators import accurate_step, find_integrator
from beammodes.vibration.linear import linearize
from beammodes.vibration.stability import GRAVITY, stable_time_step, taut_load

__all__ = ["chosen_step", "engine_step", "held_step", "load_cases"]

_EXPLICIT, _IMPLICIT = "MuJoCo RK4", "MuJoCo implicitfast"
_STEP_WITHOUT_MODES = 0.002
#: Held trees of more joints are not solved: each of some forty trial steps takes the eigenvalues of 2 N rows.
_MAX_HELD = 40
# Of the step that is stable as a chain, the least that is tried; and how many.
_SHORTEST, _TRIALS = 1e-3, 24


def engine_step(
    chains: Sequence[Chain],
    engine: str,
    tree: Tree,
    damping: Damping | None = None,
    timestep: float | None = None,
    load: Load | None = None,
    units: str | None = None,
    pull: float | None = None,
) -> tuple[float, list[str]]:
    """Return the time step of a file [s], and lines that say which cases it holds for.

    It is `timestep`, or half the stable step, less where that would shift the first frequency by over 0.1 %
    or its amplitude by over 1 % in 100 periods, or by a tenth of the damping ratio where that is more.

    Parameters
    ----------
    chains : sequence of Chain
        The one that bends along z, and the one along y.
    engine : str
        Name of an integrator in an engine, such as "MuJoCo RK4".
    tree : Tree
        The bodies and ties that the file has.
    damping, timestep, units
        As `export_chain` takes them.
    load : Load, optional
        By default the step holds without gravity and with 9.81 m/s² in any direction, along a chain that
        hangs too.
    pull : float [N], optional
        The largest one along a chain whose ends are held apart, instead of a load.

    Raises
    ------
    TypeError, ValueError
        If the integrator is unknown, or `timestep` is no number or beyond the limit of stability.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.exporters.planar_tree import planar_tree
    >>> chain = Chain(Beam.unit(), "clamped-free", 10)
    >>> engine_step([chain], "MuJoCo RK4", planar_tree(chain))[0]
    0.0021
    """
    record = find_integrator(engine)
    # Across the beam, so that no direction is preferred: see `taut_load`.
    cases = {case: Load(gravity=gravity) for case, gravity in load_cases(units).items()}
    if load is not None:
        cases = {"without load" if load == Load() else f"under {load}": load}
    if pull is not None:
        cases = {
            f"about its shape at rest, with {pull:.4g} along a segment": Load(axial_force=max(0.0, pull))
        }
    if tree.turned:
        # The file holds the right end along the beam, not the left one: let loads pull either way.
        cases = {case: _across(each) for case, each in cases.items()}

    def least_of(integrator: str, loads: Iterable[Load]) -> float:
        return min(
            _stable_step(chain, letter, integrator, damping, each, tree)
            for each in loads
            for chain, letter in zip(chains, AXES, strict=False)
        )

    limits = {case: least_of(engine, [each]) for case, each in cases.items()}
    least = min(limits.values())
    modes = [
        mode
        for chain in chains
        for each in cases.values()
        for mode in modes_with_ratios(chain, damping, linearize(chain, load=taut_load(chain, each)), 1)
    ]
    size, lines = chosen_step(engine, limits, modes, timestep)
    if not lines:
        return size, []
    if damping not in (None, Damping()) and record.damping == "implicit":
        explicit = min(
            stable_time_step(chain, "semi_implicit_euler", load=each, damping=damping)
            for chain in chains
            for each in cases.values()
        )
        flag = ", with the flag eulerdamp that is on by default" if engine.endswith(" Euler") else ""
        lines.append(f"dampers of joints are taken implicitly{flag}; taken explicitly: {explicit:.4g} s")
    if damping not in (None, Damping()) and engine == _EXPLICIT:
        limit = least_of(_IMPLICIT, cases.values())
        if limit > 2 * least:
            lines.append(
                f"dampers shorten it: {_IMPLICIT}, which takes them implicitly, is stable to {limit:.4g} s"
            )
    if load is not None and (any(load.tip) or load.tip_moment or load.axial_force or load.spin_rate):
        lines.append("this file holds gravity only: the other loads are yours to apply")
    return size, [*map(one_line, lines)]


def load_cases(units: str | None) -> dict[str, float]:
    """Return gravities that a step is held against where no load is given, by their words."""
    system = UNIT_SYSTEMS[units or "SI"]
    gravity = GRAVITY / system.metres
    return {
        "with gravity off": 0.0,
        f"with gravity {gravity:.4g} {system.length}/s2 in any direction": gravity,
    }


def chosen_step(
    engine: str,
    limits: Mapping[str, float],
    modes: Iterable[tuple[float, float]],
    timestep: float | None = None,
) -> tuple[float, list[str]]:
    """Return the step of a file and lines on it, or none where nothing limits it.

    Parameters
    ----------
    engine : str
    limits : mapping
        The stable step of each case [s], the one without gravity first.
    modes : pairs of angular frequency [rad/s] and damping ratio
        Those which the step is to keep.
    timestep : float, optional
        The one that is asked for.
    """
    given = None if timestep is None else positive_real("timestep", timestep)
    name = engine.partition(" ")[2] or engine
    least, first = min(limits.values()), next(iter(limits.values()))
    if given is not None and given >= first:
        raise ValueError(
            f"timestep must be less than {first:.3g}, where {name} becomes unstable, got {shown(timestep)}"
        )
    best = min([least / 2, *(accurate_step(engine, omega, ratio) for omega, ratio in modes)])
    size = given or (_rounded_down(best) if math.isfinite(best) else _STEP_WITHOUT_MODES)
    if not math.isfinite(first):
        return size, []
    said = ", ".join(f"{limit:.4g} s {case}" for case, limit in limits.items())
    lines = [f"largest stable timestep in {engine}: {said}"]
    if size >= least:
        lines.append(f"WARNING: the timestep given, {size!r}, is stable with gravity off only")
    return size, lines


def _across(load: Load) -> Load:
    weight, force = (math.hypot(*map(float, pair)) for pair in (load.weight, load.tip))
    return replace(load, gravity=weight, tip_force=force)


def _rounded_down(step: float) -> float:
    unit = math.floor(math.log10(step)) - 2
    return float(f"{math.floor(step / 10.0**unit)}e{unit}")


def _stable_step(
    chain: Chain, letter: str, engine: str, damping: Damping | None, load: Load, tree: Tree
) -> float:
    """Return the stable step of a chain that deflects along z or y, with its far end as the file holds it."""
    record, step = find_integrator(engine), stable_time_step(chain, engine, load=load, damping=damping)
    held = tree.anchor is not None or any(tie.stiffness == math.inf for tie in tree.ties)
    if not held or damping in (None, Damping()) or record.damping == "explicit":
        return step
    if len(tree.bodies) > _MAX_HELD or tree.anchor is not None:
        return min(step, stable_time_step(chain, "semi_implicit_euler", load=load, damping=damping))
    pull = np.array(axial_pull(chain, taut_load(chain, load)), dtype=np.float64) * chain.units.stiffness
    pull = pull[::-1] if tree.turned else pull
    if chain.held_angles[0 if tree.turned else -1]:
        pull = pull[:-1]
    own = pull[len(pull) - len(tree.bodies) :]
    found = tree_matrices(tree, own[:, None, None] * np.eye(3), plane=AXES[letter])
    return held_step(found, step, tendons=not record.tendon_damping)


def held_step(found: TreeMatrices, longest: float, *, tendons: bool) -> float:
    """Return the largest step up to `longest` [s] below which the motion of a held tree does not grow.

    `tendons` tells that dampers of ties are taken implicitly, as those of joints are.
    """
    if not len(found.held) or not math.isfinite(longest):
        return longest
    held, inertia, stiffness = found.held, found.inertia, found.stiffness
    joints, ties = found.joint_damping, found.tie_damping
    implicit = joints + ties if tendons else joints
    lift, size = np.linalg.solve(inertia, held.T), len(inertia)
    # Rows may depend on each other.
    pushed = lift @ np.linalg.pinv(held @ lift)
    # Accelerations of (q, v) without the constraint.
    free = -np.linalg.solve(inertia, np.hstack([stiffness, joints + ties]))

    def grows(step: float) -> bool:
        wanted = -np.hstack([held / (4 * step**2), held / step])
        bound = free + pushed @ (wanted - held @ free)
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
