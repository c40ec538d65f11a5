"""The physics of the chain by three routes: SymPy, CasADi and the banded nodal form agree."""

from __future__ import annotations

import itertools
from fractions import Fraction

import numpy as np
import pytest
import sympy
from drawn_ends import EVERY_N
from sympy.physics import mechanics as sympy_mechanics

from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES
from beammodes.equations.mechanics import coordinate_names
from beammodes.equations.numeric import compile_equations
from beammodes.equations.symbolic import EquationsOfMotion, equations_of_motion, symbolic_energies
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BOUNDARIES, ENDS, Boundary
from beammodes.vibration.linear import nodal_deflections, nodal_matrices

BOTH_ORDERS = [f"{left}-{right}" for left, right in itertools.product(ENDS, ENDS)]


def rational(rows: list[list[Fraction]], columns: int) -> sympy.Matrix:
    entries = [sympy.Rational(v.numerator, v.denominator) for row in rows for v in row]
    return sympy.Matrix(len(rows), columns, entries)


def deflections_to_coordinates(chain: Chain) -> sympy.Matrix:
    """The linear change of coordinates: y_0 and θ_i = (y_{i+1} - y_i)/l_i from independent deflections."""
    index = nodal_deflections(chain)
    size = len({i for i in index if i is not None})

    def node(k: int) -> list[Fraction]:
        return [Fraction(index[k] == i) for i in range(size)]

    rows = [node(0)] if "y_0" in coordinate_names(chain) else []
    for i, held in enumerate(chain.held_angles):
        if not held:
            length = Fraction(chain.scaled.length[i])
            rows.append([(b - a) / length for a, b in zip(node(i), node(i + 1), strict=True)])
    return rational(rows, size)


def assert_routes_agree(chain: Chain) -> None:
    exact = equations_of_motion(chain).linearize().in_unit_segments()
    turn = deflections_to_coordinates(chain)
    rotations, mass, stiffness = nodal_matrices(chain, Fraction)
    size = turn.cols
    assert turn.T * exact.mass_matrix * turn == rational(mass, size)
    assert turn.T * exact.stiffness_matrix * turn == rational(stiffness, size)
    joints = sympy.diag(*(sympy.Rational(k.numerator, k.denominator) for k in chain.scaled.joint_stiffness))
    factor = rational(rotations, size)
    assert factor.T * joints * factor == rational(stiffness, size)
    compiled = compile_equations(chain).linearize()
    units = chain.units
    assert compiled.coordinates == tuple(map(str, exact.coordinates))
    to_si = np.array([1.0 if name == "y_0" else units.length for name in compiled.coordinates])
    scale = {"mass_matrix": units.mass, "stiffness_matrix": units.stiffness / units.length**2}
    for name, unit in scale.items():
        expected = np.array(getattr(exact, name).tolist(), dtype=float).reshape(len(to_si), len(to_si))
        expected *= unit * np.outer(to_si, to_si)
        np.testing.assert_allclose(getattr(compiled, name), expected, rtol=1e-12, atol=1e-12 * unit)
    assert compiled.reduced()[0].shape[0] == exact.reduced()[0].rows == size
    assert size == chain.elastic_modes + chain.boundary.rigid_body_modes


@pytest.mark.parametrize("boundary", BOTH_ORDERS)
def test_routes_agree_exactly_for_every_pair_in_either_order(boundary: str) -> None:
    for segments in (1, 2, 3, 4):
        assert_routes_agree(Chain(Beam(1.3, 2.0, 0.7), boundary, segments))


@pytest.mark.slow
@pytest.mark.parametrize("boundary", [pair.name for pair in BOUNDARIES])
@pytest.mark.parametrize("rule", EVERY_N)
def test_routes_agree_exactly_up_to_twelve_segments(boundary: str, rule: str) -> None:
    for segments in range(1, 13):
        weights = RULES[rule].hinge_weights(Boundary.of(boundary), segments)
        if all(weight > 0 for weight in weights):
            assert_routes_agree(Chain(Beam.unit(), boundary, segments, rule))


@pytest.mark.parametrize(
    "boundary", ["clamped-free", "free-free", "guided-clamped", "free-pinned", "clamped-clamped"]
)
@pytest.mark.parametrize("segments", [1, 2, 3])
def test_motion_terms_are_the_derivatives_of_the_energies(boundary: str, segments: int) -> None:
    chain = Chain(Beam.unit(), boundary, segments)
    equations, parts = equations_of_motion(chain), symbolic_energies(chain)
    q, u, a = equations.coordinates, equations.speeds, equations.accelerations
    lagrange = []
    for coordinate, speed in zip(q, u, strict=True):
        momentum = parts.kinetic.diff(speed)
        rate = sum(momentum.diff(x) * v for x, v in zip((*q, *u), (*u, *a), strict=True))
        lagrange.append(rate - parts.kinetic.diff(coordinate) + parts.potential.diff(coordinate))
    built = equations.mass_matrix * sympy.Matrix(a) + equations.velocity_terms + equations.static_forces
    values = dict(zip((*q, *u, *a), np.random.default_rng(1).uniform(-1, 1, 3 * len(q)), strict=True))
    values |= {
        sympy.Symbol(name, positive=True): value for name, value in (("m", 0.7), ("ell", 1.3), ("EI", 2))
    }
    values = {symbol: sympy.Float(value) for symbol, value in values.items()}
    np.testing.assert_allclose(
        [float(entry.xreplace(values)) for entry in lagrange],
        [float(entry.xreplace(values)) for entry in built],
        rtol=1e-12,
        atol=1e-13,
    )
    assert [sympy.simplify(x - y) for x, y in zip(equations.constraints, parts.closures, strict=True)] == [
        0 for _ in parts.closures
    ]


@pytest.mark.parametrize("boundary", ["clamped-free", "free-clamped", "pinned-pinned", "guided-free"])
def test_compiled_equations_equal_the_symbolic_ones_at_large_angles(boundary: str) -> None:
    beam = Beam(1.3, 2.0, 0.7)
    chain = Chain(beam, boundary, segments=4)
    equations, compiled = equations_of_motion(chain, symbols=False), compile_equations(chain)
    size = len(compiled.coordinates)
    q, u, a = np.random.default_rng(2).uniform(-2, 2, (3, size))
    values = dict(zip((*equations.coordinates, *equations.speeds), (*q, *u), strict=True))

    def numbers(matrix: sympy.Matrix) -> np.ndarray:
        return np.array(matrix.subs(values).evalf().tolist(), dtype=float).reshape(matrix.shape)

    balance = numbers(equations.mass_matrix) @ a
    balance += numbers(equations.velocity_terms)[:, 0] + numbers(equations.static_forces)[:, 0]
    np.testing.assert_allclose(compiled.residual(q, u, a), balance, rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(
        compiled.constraint_jacobian(q).full(), numbers(equations.constraint_jacobian), rtol=1e-12, atol=1e-13
    )


def kane_equations(segments: int) -> tuple[sympy.Matrix, sympy.Matrix, list[sympy.Symbol], dict]:
    """The clamped-free chain with unit m, ell, EI and the report's springs by sympy.physics.mechanics."""
    q = sympy_mechanics.dynamicsymbols(f"q1:{segments + 1}")
    u = sympy_mechanics.dynamicsymbols(f"u1:{segments + 1}")
    ground, origin = sympy_mechanics.ReferenceFrame("G"), sympy_mechanics.Point("O")
    origin.set_vel(ground, 0)
    wall = sympy.Rational(6 * segments, 3 * segments - 1)
    bodies, loads, hinge = [], [], origin
    for i in range(segments):
        frame = ground.orientnew(f"B{i}", "Axis", (q[i], ground.z))
        frame.set_ang_vel(ground, u[i] * ground.z)
        middle = hinge.locatenew(f"C{i}", frame.x / 2)
        middle.v2pt_theory(hinge, ground, frame)
        inertia = sympy_mechanics.inertia(frame, 0, 0, sympy.Rational(1, 12))
        bodies.append(sympy_mechanics.RigidBody(f"R{i}", middle, frame, 1, (inertia, middle)))
        left = wall * q[0] if i == 0 else q[i] - q[i - 1]
        right = q[i + 1] - q[i] if i + 1 < segments else 0
        loads.append((frame, (right - left) * ground.z))
        following = hinge.locatenew(f"P{i}", frame.x)
        following.v2pt_theory(hinge, ground, frame)
        hinge = following
    kane = sympy_mechanics.KanesMethod(ground, q, u, [v - c.diff() for c, v in zip(q, u, strict=True)])
    kane.kanes_equations(bodies, loads)
    plain = {c: sympy.Symbol(f"q{i}") for i, c in enumerate(q)} | {
        v: sympy.Symbol(f"u{i}") for i, v in enumerate(u)
    }
    return kane.mass_matrix.subs(plain), kane.forcing.subs(plain), list(plain.values()), plain


def test_equations_equal_kanes_method_at_random_states() -> None:
    segments = 4
    mass, forcing, symbols, _ = kane_equations(segments)
    ours: EquationsOfMotion = equations_of_motion(Chain(Beam.unit(), "clamped-free", segments))
    units = {sympy.Symbol(name, positive=True): 1 for name in ("m", "ell", "EI")}
    generator = np.random.default_rng(3)
    for _ in range(5):
        state = generator.uniform(-2, 2, 2 * segments)
        theirs = dict(zip(symbols, state, strict=True))
        same = dict(zip((*ours.coordinates, *ours.speeds), state, strict=True)) | units
        np.testing.assert_allclose(
            np.array(ours.mass_matrix.subs(same).tolist(), float),
            np.array(mass.subs(theirs).tolist(), float),
            rtol=1e-12,
            atol=1e-13,
        )
        # Kane's forcing stands on the other side of the equation.
        static = -(ours.velocity_terms + ours.static_forces).subs(same)
        np.testing.assert_allclose(
            np.array(static.tolist(), float),
            np.array(forcing.subs(theirs).tolist(), float),
            rtol=1e-12,
            atol=1e-12,
        )


def test_clamped_free_coefficients_are_those_of_the_theory() -> None:
    # theory.md section 2: a_ij = m ell² (N - max(i, j) + 1/2) off the diagonal, (N - i + 1/3) on it.
    segments = 7
    mass = equations_of_motion(Chain(Beam.unit(), "clamped-free", segments)).linearize().in_unit_segments()
    for i, j in itertools.product(range(1, segments + 1), repeat=2):
        offset = sympy.Rational(1, 3) if i == j else sympy.Rational(1, 2)
        assert mass.mass_matrix[i - 1, j - 1] == segments - max(i, j) + offset


def test_equations_print_as_latex() -> None:
    residual = equations_of_motion(Chain(Beam.unit(), "clamped-clamped", 2)).residual
    text = sympy.latex(residual)
    for part in (
        r"\cos{\left(\theta_{1} - \theta_{2} \right)}",
        r"\dot{\theta}_{2}^{2}",
        r"\lambda_{1}",
        "EI",
    ):
        assert part in text


def test_symbols_are_refused_for_a_chain_without_a_beam() -> None:
    chain = Chain.from_pieces(
        length=[1.0, 1.0],
        mass=[1.0, 1.0],
        rotary_inertia=[0.1, 0.1],
        joint_stiffness=[2.0],
        boundary="pinned-free",
    )
    with pytest.raises(ValueError, match="symbols"):
        equations_of_motion(chain, symbols=True)
    assert equations_of_motion(chain).mass_matrix.free_symbols == set(equations_of_motion(chain).coordinates)
    with pytest.raises(TypeError, match="chain"):
        equations_of_motion("clamped-free")  # type: ignore[arg-type]
