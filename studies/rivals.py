"""The first three frequencies of a clamped-free chain with the report's springs, by other people's tools.

A method takes N and returns three ω for L = EI = ρA = 1. Matrices are built in the chain's own units (a
segment's length, its mass, EI over its length): nearly all their entries are then whole numbers, which is
kinder to a rival's rounding than metres and kilograms are.

`python -m studies.rivals METHOD N` times one method in a process of its own and prints JSON.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise
from statistics import median
from typing import Any

import numpy as np
import scipy.linalg
import scipy.sparse
from numpy.typing import NDArray
from scipy.sparse.linalg import eigsh

__all__ = [
    "MEMORY",
    "METHODS",
    "Method",
    "duration",
    "joint_stiffness",
    "kane_equations",
    "kane_units",
    "measure",
    "nodal_matrices",
    "timed",
]

Array = NDArray[np.float64]

#: What a method may take, in bytes.
MEMORY = 8 * 10**9
_FIRST = 3


def kane_units() -> dict[Any, Any]:
    """Return what this project's symbols are in units of a segment."""
    import sympy

    return {sympy.Symbol(name, positive=True): sympy.Integer(1) for name in ("m", "ell", "EI")}


@dataclass(frozen=True)
class Method:
    """A way to three frequencies.

    Attributes
    ----------
    frequencies : callable
        From N to ω, shape (3,).
    package : str
        What has to be importable.
    power : float
        Its time grows as N**power.
    dense : int
        How many N by N matrices it holds at once.
    of_beam : bool
        Whether it discretizes the beam itself instead of solving the chain.
    """

    frequencies: Callable[[int], Array]
    package: str = "scipy"
    power: float = 1.0
    dense: int = 0
    of_beam: bool = False

    def needs(self, segments: int) -> int:
        """Return the bytes of its dense matrices."""
        return 8 * self.dense * segments**2


def joint_stiffness(segments: int) -> Array:
    """Return the report's springs, the wall's first [EI/ell]."""
    springs = np.ones(segments)
    springs[0] = 6 * segments / (3 * segments - 1)
    return springs


def nodal_matrices(segments: int) -> tuple[Any, Any]:
    """Return sparse K and M in the deflections of nodes 1..N; K = Bᵀ D B has five diagonals, M three."""
    ones = np.ones(segments)
    shape = (segments, segments)
    rotations = scipy.sparse.diags([ones, -2 * ones, ones], [0, -1, -2], shape=shape)
    stiffness = rotations.T @ scipy.sparse.diags(joint_stiffness(segments)) @ rotations
    diagonal = 2 * ones / 3
    diagonal[-1] = 1 / 3
    mass = scipy.sparse.diags([ones / 6, diagonal, ones / 6], [-1, 0, 1], shape=shape)
    return stiffness.tocsc(), mass.tocsc()


def kane_equations(segments: int) -> tuple[Any, list[Any], list[Any]]:
    """Return the clamped-free chain of unit rods by sympy.physics.mechanics: the method, q and u."""
    import sympy
    from sympy.physics import mechanics

    q = mechanics.dynamicsymbols(f"q1:{segments + 1}")
    u = mechanics.dynamicsymbols(f"u1:{segments + 1}")
    ground, hinge = mechanics.ReferenceFrame("G"), mechanics.Point("O")
    hinge.set_vel(ground, 0)
    wall = sympy.Rational(6 * segments, 3 * segments - 1)
    moments = [wall * q[0], *(after - before for before, after in pairwise(q)), 0]
    bodies, loads = [], []
    for i, (angle, speed) in enumerate(zip(q, u, strict=True)):
        frame = ground.orientnew(f"B{i}", "Axis", (angle, ground.z))
        frame.set_ang_vel(ground, speed * ground.z)
        middle, tip = (hinge.locatenew(f"{name}{i}", frame.x / d) for name, d in (("C", 2), ("P", 1)))
        for point in (middle, tip):
            point.v2pt_theory(hinge, ground, frame)
        inertia = (mechanics.inertia(frame, 0, 0, sympy.Rational(1, 12)), middle)
        bodies.append(mechanics.RigidBody(f"R{i}", middle, frame, 1, inertia))
        loads.append((frame, (moments[i + 1] - moments[i]) * ground.z))
        hinge = tip
    kane = mechanics.KanesMethod(ground, q, u, [s - c.diff() for c, s in zip(q, u, strict=True)])
    kane.kanes_equations(bodies, loads)
    return kane, q, u


def _from_squares(squares: Array, segments: int) -> Array:
    # A negative square has no frequency: it becomes NaN, which is reported as a failure.
    with np.errstate(invalid="ignore"):
        return np.asarray(np.sqrt(np.sort(squares)[:_FIRST]) * segments**2)


def _closed_form(segments: int) -> Array:
    from beammodes.closed_form.chain_frequencies import chain_frequency

    return np.asarray(chain_frequency("clamped-free", segments, np.arange(1, _FIRST + 1)))


def _flexibility_form(segments: int) -> Array:
    from beammodes import Beam, Chain, linearize, solve_modes

    model = linearize(Chain(Beam.unit(), "clamped-free", segments))
    return solve_modes(model, modes=_FIRST).angular_frequency


def _dense(segments: int, only: list[int] | None = None) -> Array:
    stiffness, mass = (matrix.toarray() for matrix in nodal_matrices(segments))
    squares = scipy.linalg.eigh(stiffness, mass, eigvals_only=True, subset_by_index=only)
    return _from_squares(squares, segments)


def _sparse(segments: int) -> Array:
    stiffness, mass = nodal_matrices(segments)
    return _from_squares(_shift_invert(stiffness, mass), segments)


def _shift_invert(stiffness: Any, mass: Any) -> Array:
    # A fixed start makes the result reproducible; SciPy's own is random.
    start = np.ones(stiffness.shape[0])
    return np.asarray(eigsh(stiffness, _FIRST, mass, sigma=0, v0=start, return_eigenvectors=False))


def _scikit_fem(segments: int) -> Array:
    from skfem import Basis, BilinearForm, ElementLineHermite, MeshLine
    from skfem.helpers import dd, ddot

    # Elements of unit length, for the same reason as the chain's own units.
    mesh = MeshLine(np.arange(segments + 1.0))
    basis = Basis(mesh, ElementLineHermite())
    stiffness = BilinearForm(lambda u, v, _: ddot(dd(u), dd(v))).assemble(basis)
    mass = BilinearForm(lambda u, v, _: u * v).assemble(basis)
    free = basis.complement_dofs(basis.get_dofs(lambda x: x[0] == 0.0))
    squares = _shift_invert(stiffness[free][:, free].tocsc(), mass[free][:, free].tocsc())
    return _from_squares(squares, segments)


def _mujoco_mass(segments: int) -> Array:
    import mujoco

    # Built body by body: MuJoCo's XML reader gives up on trees 500 deep.
    spec = mujoco.MjSpec()
    body = spec.worldbody
    for i, spring in enumerate(joint_stiffness(segments)):
        place = [float(i > 0), 0.0, 0.0]
        # No inertia may be zero; this one, about the rod's own axis, never moves.
        inertia = {"mass": 1.0, "ipos": [0.5, 0.0, 0.0], "inertia": [1e-3, 1 / 12, 1 / 12]}
        body = body.add_body(pos=place, explicitinertial=True, **inertia)
        body.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0.0, 0.0, 1.0], stiffness=spring)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mass = np.zeros((segments, segments))
    mujoco.mj_fullM(model, data, mass)
    return mass


def _pinocchio_mass(segments: int) -> Array:
    import pinocchio

    model, parent = pinocchio.Model(), 0
    rod = pinocchio.Inertia(1.0, np.array([0.5, 0.0, 0.0]), np.diag([0.0, 1 / 12, 1 / 12]))
    for i in range(segments):
        place = pinocchio.SE3(np.eye(3), np.array([float(i > 0), 0.0, 0.0]))
        parent = model.addJoint(parent, pinocchio.JointModelRZ(), place, f"hinge {i}")
        model.appendBodyToJoint(parent, rod, pinocchio.SE3.Identity())
    mass = np.triu(pinocchio.crba(model, model.createData(), np.zeros(segments)))
    return np.asarray(mass + np.triu(mass, 1).T)


def _stiffness_first(mass: Array) -> Array:
    """Solve (K, M) in joint angles for ω², as one would write it first."""
    stiffness = np.diag(joint_stiffness(len(mass)))
    squares = scipy.linalg.eigh(stiffness, mass, eigvals_only=True, subset_by_index=[0, _FIRST - 1])
    return _from_squares(squares, len(mass))


def _mass_first(mass: Array) -> Array:
    """Solve (M, K) in joint angles for 1/ω², which keeps the lowest modes' digits."""
    stiffness, highest = np.diag(joint_stiffness(len(mass))), [len(mass) - _FIRST, len(mass) - 1]
    inverse = scipy.linalg.eigh(mass, stiffness, eigvals_only=True, subset_by_index=highest)
    return _from_squares(1 / inverse, len(mass))


def _cubic(frequencies: Callable[[int], Array], package: str = "scipy") -> Method:
    return Method(frequencies, package, power=3, dense=4)


_SUBSET = [0, _FIRST - 1]

#: Every method by the name it has in the table.
METHODS: dict[str, Method] = {
    "beammodes, closed form": Method(_closed_form, power=0),
    "beammodes, any chain": Method(_flexibility_form),
    "SciPy `eigh(K, M)`": _cubic(_dense),
    "SciPy `eigh(K, M)`, lowest three": _cubic(lambda n: _dense(n, _SUBSET)),
    "SciPy sparse `eigsh`, shift-invert": Method(_sparse),
    "scikit-fem Hermite elements": Method(_scikit_fem, "skfem", of_beam=True),
    "MuJoCo's M, `eigh(K, M)`": _cubic(lambda n: _stiffness_first(_mujoco_mass(n)), "mujoco"),
    "MuJoCo's M, `eigh(M, K)`": _cubic(lambda n: _mass_first(_mujoco_mass(n)), "mujoco"),
    "Pinocchio's M, `eigh(K, M)`": _cubic(lambda n: _stiffness_first(_pinocchio_mass(n)), "pinocchio"),
    "Pinocchio's M, `eigh(M, K)`": _cubic(lambda n: _mass_first(_pinocchio_mass(n)), "pinocchio"),
}


def duration(seconds: float) -> str:
    """Return a time in words, such as "1.5 ms"."""
    for unit, size in (("h", 3600.0), ("min", 60.0), ("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size * (2 if unit in ("h", "min") else 1):
            break
    value = seconds / size
    return f"{value:.2g} {unit}" if value < 100 else f"{value:.0f} {unit}"


def timed(
    function: Callable[[], Any], budget: float = 1.0, before: Callable[[], object] = lambda: None
) -> tuple[float, Any]:
    """Return the median time [s] of as many calls as `budget` seconds allow, and the last result.

    `before` is called ahead of each, outside the time.
    """
    times: list[float] = []
    while not times or (sum(times) < budget and len(times) < 1000):
        before()
        start = time.perf_counter()
        result = function()
        times.append(time.perf_counter() - start)
    return median(times), result


def measure(name: str, segments: int) -> dict[str, Any]:
    """Time one method; a failure of its is a result like any other."""
    method = METHODS[name].frequencies
    try:
        # What is imported or compiled once is not what is compared.
        method(8)
        seconds, frequencies = timed(lambda: method(segments))
    except MemoryError:
        return {"memory": True}
    except Exception as error:
        return {"raised": f"{type(error).__name__}: {error}"}
    return {"seconds": seconds, "frequencies": frequencies.tolist()}


def main(arguments: list[str]) -> None:
    """Run one measurement on one BLAS thread and within the memory allowed."""
    from threadpoolctl import threadpool_limits

    with suppress(ImportError):  # Windows has no such limit.
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    with threadpool_limits(1):
        print(json.dumps(measure(arguments[0], int(arguments[1]))))


if __name__ == "__main__":
    main(sys.argv[1:])
