"""The time step that an engine needs for an exported chain in space, from the matrices of what the file has.

Long chains are bounded instead. Let the pieces go, each to turn about its centre with its springs: the
highest frequency only rises. Of two neighbours the spring between stores at most  k (θ² + θ'²),  so

    ω² ≤ max over pieces of  λ_max( I⁻¹ 2 (K_before + K_behind) ),

which is 48 EI/(ρA ℓ⁴) of a straight chain in bending and 4 GJ/(ρI_p ℓ²) in twist: what long chains have.
"""

from __future__ import annotations

import math

import numpy as np

from beammodes.exporters.engine_step import chosen_step, held_step, load_cases
from beammodes.exporters.export_facts import one_line
from beammodes.exporters.model_tree import Tree
from beammodes.exporters.tree_matrices import TreeMatrices, tree_matrices
from beammodes.numerics.arrays import Floats
from beammodes.problem.load_in_space import SpatialLoad
from beammodes.vibration.damping import Damping
from beammodes.vibration.highest_in_space import resisted_across
from beammodes.vibration.integrators import find_integrator, stability_limit

__all__ = ["bounded_frequency", "engine_step_in_space", "highest_frequency"]

#: Coordinates of a tree whose matrices are solved; and of a held one, at every trial step.
_DENSE, _MOST_HELD = 600, 120
_EXPLICIT = "semi_implicit_euler"


def engine_step_in_space(
    first: float,
    engine: str,
    tree: Tree,
    damping: Damping | None = None,
    timestep: float | None = None,
    load: SpatialLoad | None = None,
    units: str | None = None,
) -> tuple[float, list[str]]:
    """Return the time step of a file [s], and lines that say which cases it holds for; as `engine_step`.

    Under weight and a force on the tip the steps are those of a chain that hangs: no shape at rest is pulled
    harder.

    Parameters
    ----------
    first : float [rad/s]
        The lowest elastic mode's frequency, 0 without one.
    engine, tree, damping, timestep, load, units
        As of `engine_step`.
    """
    cases = {case: (gravity, 0.0) for case, gravity in load_cases(units).items()}
    if load is not None:
        said = "without load" if load == SpatialLoad() else f"under {load}"
        cases = {said: (math.hypot(*load.gravity), math.hypot(*load.force))}
    beta = damping.stiffness if damping is not None else 0.0
    limits = {case: _stable_step(tree, engine, beta, _pull(tree, *each)) for case, each in cases.items()}
    modes = [(first, beta * first / 2)] if first else []
    size, lines = chosen_step(engine, limits, modes, timestep)
    if load is not None and (any(load.force) or any(load.moment) or load.torque):
        lines.append("this file holds gravity only: the other loads are yours to apply")
    return size, [*map(one_line, lines)]


def _pull(tree: Tree, gravity: float, force: float) -> Floats | None:
    """Return what loads add to ∂²V/∂θ² of each body's rotation where they pull along it [N m]."""
    if not gravity and not force:
        return None
    mass = np.array([body.mass for body in tree.bodies])
    beyond = np.cumsum(mass[::-1])[::-1] - mass
    if tree.ties:
        beyond = np.full_like(mass, mass.sum())
    tip, centre = (np.array([getattr(body, at) for body in tree.bodies]) for at in ("tip", "centre"))
    return resisted_across(tip, gravity * beyond + force) + resisted_across(centre, gravity * mass)


def _stable_step(tree: Tree, engine: str, beta: float, pull: Floats | None) -> float:
    record = find_integrator(engine)
    count = sum({"ball": 3, "free": 6}.get(j.kind, 1) for body in tree.bodies for j in body.joints)
    found = tree_matrices(tree, pull) if tree.ties or count <= _DENSE else None
    omega = bounded_frequency(tree, pull) if found is None else highest_frequency(found)
    if not omega:
        return math.inf

    def limit(name: str) -> float:
        # Runge-Kutta's limit differs between damping ratios: so does that of modes near the highest.
        near = np.linspace(0.6, 1.0, 9) * omega if record.stages and beta else [omega]
        return float(min(stability_limit(name, beta * one / 2) / one for one in near))

    dampers = any(tie.damping for tie in tree.ties) and record.tendon_damping
    step = limit(_EXPLICIT if dampers else engine)
    if found is None or not len(found.held) or not beta or record.damping == "explicit":
        return step
    if count > _MOST_HELD:
        return min(step, limit(_EXPLICIT))
    return held_step(found, step, tendons=not record.tendon_damping)


def highest_frequency(found: TreeMatrices) -> float:
    """Return the highest angular frequency of a tree [rad/s], 0 without coordinates.

    Examples
    --------
    >>> import beammodes as bm
    >>> from beammodes.exporters.planar_tree import planar_tree
    >>> chain = bm.Chain(bm.Beam.unit(), "clamped-free", 8)
    >>> highest = highest_frequency(tree_matrices(planar_tree(chain)))
    >>> round(highest * bm.stable_time_step(chain, "leapfrog"), 7)
    2.0
    """
    inertia, stiffness = found.inertia, found.stiffness
    if len(found.held):
        _, size, basis = np.linalg.svd(found.held)
        free = basis[int((size > 1e-12 * size.max(initial=0.0)).sum()) :].T
        inertia, stiffness = free.T @ inertia @ free, free.T @ stiffness @ free
    if not len(inertia):
        return 0.0
    root = np.linalg.cholesky(inertia)
    half = np.linalg.solve(root, stiffness)
    squares = np.linalg.eigvalsh(np.linalg.solve(root, half.T))
    return math.sqrt(max(0.0, float(squares[-1])))


def bounded_frequency(tree: Tree, pull: Floats | None = None) -> float:
    """Return a bound of the highest frequency of a tree without ties."""
    springs = np.zeros((len(tree.bodies) + 1, 3, 3))
    extra = 0.0
    for i, body in enumerate(tree.bodies):
        for joint in body.joints:
            if joint.kind == "hinge":
                springs[i] += joint.stiffness * np.outer(joint.axis, joint.axis)
            elif joint.kind == "ball":
                springs[i] += joint.stiffness * np.eye(3)
            elif joint.stiffness:
                # A sprung slide of the root, of its centre's motion and of its rotation.
                least = float(np.linalg.eigvalsh(np.array(body.inertia))[0])
                extra += 2 * joint.stiffness * (1 / body.mass + math.hypot(*body.centre) ** 2 / least)
    squares = [0.0]
    for i, body in enumerate(tree.bodies):
        own = springs[i] * (2.0 if i else 1.0)
        if i + 1 < len(tree.bodies):
            frame = np.array(tree.bodies[i + 1].rotation)
            own = own + 2.0 * frame @ springs[i + 1] @ frame.T
        if pull is not None:
            own = own + pull[i]
        squares.append(float(np.linalg.eigvals(np.linalg.solve(np.array(body.inertia), own)).real.max()))
    return math.sqrt(max(squares) + extra)
