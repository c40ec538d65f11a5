"""Chains whose ends have springs and bodies: three routes, exact frequencies, limits and published beams."""

from __future__ import annotations

import dataclasses
import math
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
import scipy.linalg
import sympy
from drawn_ends import EVERY_N
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from turns import in_turns

from beammodes.accuracy.buckling import buckling_load
from beammodes.accuracy.errors import frequency_error
from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES
from beammodes.equations.mechanics import coordinate_names
from beammodes.equations.numeric import compile_equations
from beammodes.equations.symbolic import equations_of_motion, symbolic_energies
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.beam import Beam
from beammodes.problem.ends import ENDS, Boundary, End
from beammodes.problem.loading import Load
from beammodes.vibration import modes as modes_module
from beammodes.vibration.linear import linearize, nodal_deflections, nodal_matrices
from beammodes.vibration.modes import Modes, solve_modes
from beammodes.vibration.stability import highest_angular_frequency

INF, F = math.inf, Fraction
BEAM = Beam(1.3, 2.0, 0.7)
BODY = End(mass=F(1, 3), rotary_inertia=F(1, 7), offset=F(1, 5))
SPRINGS = End(F(7, 2), F(5, 3))
ALL = End(F(3, 2), F(1, 4), F(2, 5), F(1, 9), F(-1, 3))
PAIRS: list[tuple[End | str, End | str]] = [
    ("clamped", BODY),
    (BODY, BODY),
    (SPRINGS, ALL),
    (End(INF, 0, 1, 2, F(1, 2)), End(F(2), INF, F(1, 2))),
    (End(F(1, 2), 0, 1), End(INF, F(1, 3))),
    (End(0, INF, 1), End(INF, 0, rotary_inertia=1)),
    ("pinned", End(0, F(9))),
]
EITHER_ORDER = [*PAIRS, *((right, left) for left, right in PAIRS)]
amounts = st.one_of(st.just(F(0)), st.fractions(F(1, 50), 50, max_denominator=60))
stiffnesses = st.one_of(amounts, st.just(INF))
ends = st.builds(End, stiffnesses, stiffnesses, amounts, amounts, st.fractions(-2, 2, max_denominator=9))


def own_pieces(pair: Any, **changes: Any) -> Chain:
    """Three unlike rods, and a zero-length piece with a body at either end, centres off their middles."""
    numbers: dict[str, Any] = {
        "length": [F(0), F(1), F(3, 2), F(2, 3), F(0)],
        "mass": [F(1, 4), F(1), F(2), F(1, 2), F(0)],
        "centre": [F(-1, 6), F(1, 3), F(2), F(1, 2), F(0)],
        "rotary_inertia": [F(1, 8), F(1, 10), F(1, 5), F(1, 30), F(1, 9)],
        "joint_stiffness": [F(3), F(1), F(5, 2), F(2)],
    }
    return Chain.from_pieces(boundary=pair, **{**numbers, **changes})


def rational(rows: list[list[Fraction]], columns: int) -> sympy.Matrix:
    return sympy.Matrix(
        len(rows), columns, [sympy.Rational(v.numerator, v.denominator) for r in rows for v in r]
    )


def nodal_to_coordinates(chain: Chain) -> sympy.Matrix:
    """y_0, and θ_i = (y_{i+1} - y_i)/l_i or, of a piece without length, the nodal form's own angle."""
    index, names = nodal_deflections(chain), linearize(chain).coordinates
    size = len(names)

    def unit(k: int | None) -> list[Fraction]:
        return [F(k == i) for i in range(size)]

    rows = [unit(index[0])] if "y_0" in coordinate_names(chain) else []
    for i, held in enumerate(chain.held_angles):
        length = F(chain.scaled.length[i])
        if not held and not length:
            rows.append(unit(names.index(f"theta_{i}")))
        elif not held:
            difference = zip(unit(index[i]), unit(index[i + 1]), strict=True)
            rows.append([(b - a) / length for a, b in difference])
    return rational(rows, size)


def assert_routes_agree(chain: Chain, load: Load | None = None) -> None:
    exact = equations_of_motion(chain, load=load).linearize().in_unit_segments()
    turn = nodal_to_coordinates(chain)
    _, mass, stiffness = nodal_matrices(chain, F, load)
    assert turn.T * exact.mass_matrix * turn == rational(mass, turn.cols)
    assert turn.T * exact.stiffness_matrix * turn == rational(stiffness, turn.cols)
    assert exact.reduced()[0].rows == turn.cols
    model, k = linearize(chain, load=load), rational(stiffness, turn.cols)
    assert (model.elastic_modes, model.rigid_body_modes) == (k.rank(), k.cols - k.rank())
    compiled, units = compile_equations(chain, load=load).linearize(), chain.units
    assert compiled.coordinates == tuple(map(str, exact.coordinates))
    to_si = np.array([1.0 if name == "y_0" else units.length for name in compiled.coordinates])
    scales = {"mass_matrix": units.mass, "stiffness_matrix": units.stiffness / units.length**2}
    for name, unit in scales.items():
        expected = np.array(getattr(exact, name).tolist(), dtype=float) * unit * np.outer(to_si, to_si)
        size = np.abs(expected).max()
        np.testing.assert_allclose(getattr(compiled, name), expected, rtol=1e-12, atol=1e-12 * size)


@pytest.mark.parametrize(
    ("pair", "load"), in_turns(EITHER_ORDER, [None, Load(F(3, 7)), Load(F(-1, 50))], every=3), ids=str
)
def test_three_routes_agree_exactly(pair: Any, load: Load | None) -> None:
    for rule, segments in (("gregory", 3), ("mitiguy", 1), ("half_stub_corrected", 2), ("rigid_stub", 2)):
        assert_routes_agree(Chain(BEAM, pair, segments, rule), load)
    assert_routes_agree(own_pieces(pair), load)


@pytest.mark.parametrize(
    "pair",
    [
        PAIRS[2],
        *(pytest.param(pair, marks=pytest.mark.slow) for pair in (PAIRS[1], PAIRS[3], ("free", SPRINGS))),
        (End(F(2)), BODY),
    ],
    ids=str,
)
def test_motion_terms_are_the_derivatives_of_the_energies(pair: Any) -> None:
    load = Load(F(-4, 5))
    for chain in (Chain(Beam.unit(), pair, 2), own_pieces(pair)):
        equations, parts = equations_of_motion(chain, load=load), symbolic_energies(chain, load=load)
        q, u, a = equations.coordinates, equations.speeds, equations.accelerations
        built = equations.mass_matrix * sympy.Matrix(a) + equations.velocity_terms + equations.static_forces
        values = dict(zip((*q, *u, *a), np.random.default_rng(1).uniform(-1, 1, 3 * len(q)), strict=True))
        values |= {sympy.Symbol(n, positive=True): v for n, v in (("m", 0.7), ("ell", 1.3), ("EI", 2))}
        values = {symbol: sympy.Float(value) for symbol, value in values.items()}
        for i, (coordinate, speed) in enumerate(zip(q, u, strict=True)):
            momentum = parts.kinetic.diff(speed)
            rate = sum(momentum.diff(x) * v for x, v in zip((*q, *u), (*u, *a), strict=True))
            lagrange = rate - parts.kinetic.diff(coordinate) + parts.potential.diff(coordinate)
            assert float(lagrange.xreplace(values)) == pytest.approx(
                float(built[i].xreplace(values)), rel=1e-12, abs=1e-12
            )


def squares(rows: list[tuple[Any, list[Any]]]) -> mpmath.matrix:
    """Σ factor rowᵀ row."""
    size = len(rows[0][1])
    terms = [[sum(f * r[i] * r[j] for f, r in rows) for j in range(size)] for i in range(size)]
    return mpmath.matrix([[mpmath.mpf(v.numerator) / v.denominator for v in row] for row in terms])


def reference_frequencies(pair: Boundary, segments: int, rule: str, load: Load) -> list[mpmath.mpf]:
    """All ω of the chain of L = EI = ρA = 1 in 50 digits, written again from the definition of an `End`.

    Coordinates: the left tip's deflection and every piece's angle; what an end holds has a row of zeros.
    """
    record, ell = RULES[rule], F(1, segments)
    length = [part * ell for part in record.piece_lengths(pair, segments)]
    size = len(length) + 1
    unit = [[F(i == j) for j in range(size)] for i in range(size)]
    node = [unit[0]]
    for i, part in enumerate(length):
        node.append([a + part * b for a, b in zip(node[-1], unit[i + 1], strict=True)])
    kinetic, stored = [], []
    for i, part in enumerate(length):
        kinetic.append((part, [(a + b) / 2 for a, b in zip(node[i], node[i + 1], strict=True)]))
        kinetic.append((record.rotary_inertia * part**3, unit[i + 1]))
        stored.append((F(load.axial_force) * part, unit[i + 1]))
    for j, weight in enumerate(record.hinge_weights(pair, segments)):
        joint = [b - a for a, b in zip(unit[j + 1], unit[j + 2], strict=True)]
        stored.append((1 / (weight * ell), joint))
    held = []
    for end, tip, turn, sign in ((pair.left, node[0], unit[1], -1), (pair.right, node[-1], unit[-1], 1)):
        outward = [y + sign * F(end.offset) * θ for y, θ in zip(tip, turn, strict=True)]
        kinetic += [(F(end.mass), outward), (F(end.rotary_inertia), turn)]
        for k, row in ((end.translational_stiffness, tip), (end.rotational_stiffness, turn)):
            held.append(row) if k == INF else stored.append((F(k), row))
    rows = [[sympy.Rational(v.numerator, v.denominator) for v in row] for row in held]
    allowed = sympy.Matrix(rows).nullspace() if rows else sympy.eye(size).columnspace()
    with mpmath.workdps(50):
        basis = mpmath.matrix([[mpmath.mpf(v[i].p) / v[i].q for v in allowed] for i in range(size)])
        mass, stiffness = (basis.T * squares(part) * basis for part in (kinetic, stored))
        # Massless motions (a stub's turning, with nothing on it) follow statically: leave them out.
        values, vectors = mpmath.eigsy(mass)
        keep = [i for i in range(len(values)) if values[i] > mpmath.mpf(10) ** -40]
        slack = [i for i in range(len(values)) if i not in keep]
        k = vectors.T * stiffness * vectors

        def block(a: list[int], b: list[int]) -> mpmath.matrix:
            return mpmath.matrix([[k[i, j] for j in b] for i in a])

        inner = block(keep, keep)
        if slack:
            inner -= block(keep, slack) * mpmath.inverse(block(slack, slack)) * block(slack, keep)
        root = mpmath.diag([1 / mpmath.sqrt(values[i]) for i in keep])
        return [mpmath.sqrt(max(v, 0)) for v in mpmath.eigsy(root * inner * root, eigvals_only=True)]


def modal_mass_and_stiffness(chain: Chain, modes: Modes, load: Load) -> tuple[np.ndarray, np.ndarray]:
    """Of all pairs of modes, from the pieces' motion."""
    centre = modes.deflection[:, :-1] + modes.rotation * chain.centre
    slope, tips, outer = modes.rotation, modes.deflection[:, [0, -1]], modes.rotation[:, [0, -1]]
    bend = np.diff(slope, axis=1)
    mass = (centre * chain.mass) @ centre.T + (slope * chain.rotary_inertia) @ slope.T
    stiffness = (bend * chain.joint_stiffness) @ bend.T
    stiffness += float(load.axial_force) * (slope * chain.length) @ slope.T
    own = np.array([[0.0 if k == INF else float(k) for k in end] for end in chain.scaled.supports])
    stiffness += (tips * own[:, 0] * chain.units.stiffness / chain.units.length**2) @ tips.T
    return mass, stiffness + (outer * own[:, 1] * chain.units.stiffness) @ outer.T


@given(ends, ends, st.integers(2, 5), st.sampled_from(["gregory", "half_stub", "hencky"]), amounts)
@settings(max_examples=30)
def test_every_frequency_keeps_its_digits(
    left: End, right: End, segments: int, rule: str, force: Any
) -> None:
    pair, load = Boundary(left, right), Load(force)
    weights = RULES[rule].hinge_weights(pair, segments)
    assume(min(weights) > 0)
    chain = Chain(Beam.unit(), pair, segments, rule)
    assume(chain.elastic_modes or pair.rigid_body_modes)  # two stubs between walls leave nothing to compare
    found, exact = solve_modes(linearize(chain, load=load)), reference_frequencies(pair, segments, rule, load)
    rigid = found.rigid_body_modes
    assert len(exact) == rigid + len(found.angular_frequency)
    assert all(value < 1e-15 for value in exact[:rigid])
    for ours, true in zip(found.angular_frequency, exact[rigid:], strict=True):
        assert abs(float(ours / true - 1)) < 1e-13 * max(1.0, float(true / exact[rigid]))
    mass, stiffness = modal_mass_and_stiffness(chain, found, load)
    square = found.angular_frequency**2
    assert np.abs(mass - np.eye(len(mass))).max(initial=0.0) < 1e-10
    assert np.abs(stiffness - np.diag(square)).max(initial=0.0) < 1e-9 * square.max(initial=1.0)


# --- What an end is equal to ------------------------------------------------------------------------------


def lowest(pair: Any, segments: int = 10, rule: str = "gregory", count: int = 3) -> np.ndarray:
    """First frequencies for L = EI = ρA = 1."""
    return solve_modes(linearize(Chain(Beam.unit(), pair, segments, rule)), count).angular_frequency


def same_pieces(one: Chain, other: Chain) -> None:
    assert one.scaled == other.scaled


def test_a_massless_spring_at_the_end_is_in_series_with_the_walls_hinge() -> None:
    # By hand: springs k = 2 N (double_wall) and K_r one after the other, k K_r/(k + K_r).
    chain = Chain(Beam.unit(), (End(INF, F(3)), End(0, F(1, 2))), 4, "double_wall")
    assert chain.pieces == 4
    series = [F(8) * k / (8 + k) / 4 for k in (F(3), F(1, 2))]
    assert chain.scaled.supports == ((INF, series[0]), (0, series[1]))
    assert chain.scaled.joint_stiffness == (1, 1, 1)


@pytest.mark.parametrize("end", [End(mass=F(1, 3)), End(F(5), mass=F(1, 3)), End(F(5), F(2), F(1, 3))])
def test_a_point_mass_on_an_outer_piece_without_length_is_an_end_mass(end: End) -> None:
    bare = End(end.translational_stiffness, end.rotational_stiffness)
    rods = {
        "length": [0, 1, 1, 0],
        "rotary_inertia": [0, F(1, 12), F(1, 12), 0],
        "joint_stiffness": [2, 1, 2],
    }
    with_mass = Chain.from_pieces(**rods, mass=[F(1, 3), 1, 1, F(1, 3)], boundary=(bare, bare))
    same_pieces(with_mass, Chain.from_pieces(**rods, mass=[0, 1, 1, 0], boundary=(end, end)))
    assert with_mass.pieces == 2


@pytest.mark.parametrize(("bare", "loaded"), [("clamped", BODY), ("pinned", End(mass=7))])
def test_what_cannot_move_changes_nothing(bare: str, loaded: End) -> None:
    held, body = ENDS[bare], (loaded.mass, loaded.rotary_inertia, loaded.offset)
    end = End(held.translational_stiffness, held.rotational_stiffness, *body)
    for rule in ("gregory", "half_stub"):
        same_pieces(Chain(BEAM, (end, "free"), 4, rule), Chain(BEAM, (bare, "free"), 4, rule))


def test_an_offset_points_outward_at_either_end() -> None:
    # From the definition of an `End`: the centre of mass stands beyond the tip, on both sides.
    chain = Chain(Beam.unit(), (End(mass=2, offset=F(1, 4)), End(mass=2, offset=F(1, 4))), 2, "double_wall")
    np.testing.assert_allclose(chain.centre, [-0.25, 0.25, 0.25, 0.25], rtol=1e-15)
    inside = Chain(Beam.unit(), ("clamped", End(mass=1, rotary_inertia=1, offset=F(-1, 2))), 1, "rigid_stub")
    # Rod and body share one centre at 1/2, so nothing adds to 1/12 + 1 about it; but both are welded.
    assert (inside.scaled.centre, inside.scaled.mass) == ((F(1, 2),), (2,))
    assert inside.scaled.rotary_inertia == (F(13, 12),)


@pytest.mark.parametrize("pair", PAIRS, ids=str)
def test_mirrored_chains_have_the_same_frequencies(pair: Any) -> None:
    turned = own_pieces("free-free").scaled.turned()
    names = ("length", "mass", "centre", "rotary_inertia", "joint_stiffness")
    mirrored = own_pieces(pair[::-1], **{name: getattr(turned, name) for name in names})
    one, other = (solve_modes(linearize(chain)) for chain in (own_pieces(pair), mirrored))
    np.testing.assert_allclose(one.angular_frequency, other.angular_frequency, rtol=1e-12)


def test_vanishing_springs_and_inertias_leave_the_frequencies_without_them() -> None:
    # `End.statics`: the wall's spring is in series with what vanishes (rules that correct only that spring).
    for rule in ("mitiguy", "half_stub", "hencky"):
        plain = lowest("clamped-free", rule=rule)
        np.testing.assert_allclose(lowest(("clamped", End(0, 1e-12)), rule=rule), plain, rtol=1e-11)
        np.testing.assert_allclose(
            lowest(("clamped", End(rotary_inertia=1e-12)), rule=rule), plain, rtol=1e-9
        )
        np.testing.assert_allclose(lowest(("clamped", End(1e-12)), rule=rule), plain, rtol=1e-11)


def test_rules_with_several_springs_jump_within_their_order_as_a_spring_vanishes() -> None:
    # Their inner springs stay corrected while the wall's own vanishes: the errors differ by the rule's order.
    jumps = [lowest(("clamped", End(0, 1e-12)), n)[0] / lowest("clamped-free", n)[0] - 1 for n in (10, 20)]
    assert 1e-6 < jumps[0] < 1e-4
    assert math.log2(jumps[0] / jumps[1]) > RULES["gregory"].declared_order(Boundary.of("clamped-free")) - 0.3


@pytest.mark.parametrize(
    ("rule", "held"),
    # A rotational spring without shear takes a rule's clamped weights, and a guided end its guided ones: only
    # a stub layout without weights has one limit there.
    [("gregory", ["clamped", "pinned"]), ("half_stub", ["clamped", "pinned", "guided"])],
)
def test_stiff_springs_hold(rule: str, held: list[str]) -> None:
    # A support K gives way by 1/K, an EI/(K L) of 1e-15 here, times 10³ for the third mode.
    for word in held:
        stiff = End(
            *(min(k, 1e15) for k in (ENDS[word].translational_stiffness, ENDS[word].rotational_stiffness))
        )
        for other in ("free", "pinned"):
            expected = lowest((word, other), 8, rule)
            np.testing.assert_allclose(lowest((stiff, other), 8, rule), expected, rtol=1e-11)


# --- Long chains ------------------------------------------------------------------------------------------

LONG = [("clamped", BODY), (SPRINGS, ALL), (End(INF, 2.0, 0, 1.0), End(3.0, INF, 1.0)), (BODY, BODY)]


@pytest.mark.parametrize("pair", LONG, ids=str)
@pytest.mark.parametrize("force", [0.0, 40.0, -0.05])
def test_lanczos_agrees_with_the_dense_solver(
    pair: Any, force: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    if pair == (BODY, BODY):
        # A free rigid rotation turns over under any compression.
        force = abs(force)
    model = linearize(Chain(Beam.unit(), pair, 70), load=Load(force))
    # All modes are of the dense solver.
    dense = solve_modes(model)
    shapes = dense.deflection[:4]
    monkeypatch.setattr(modes_module, "MAX_DENSE", 10)
    lanczos = solve_modes(model, 4)
    np.testing.assert_allclose(lanczos.angular_frequency, dense.angular_frequency[:4], rtol=1e-12)
    # An antisymmetric shape has two largest entries, and either may be the positive one.
    sign = np.sign((lanczos.deflection * shapes).sum(axis=1, keepdims=True))
    np.testing.assert_allclose(sign * lanczos.deflection, shapes, rtol=0, atol=1e-8 * np.abs(shapes).max())


def test_more_than_five_hundred_hinges_with_springs_and_bodies_under_tension(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    model = linearize(Chain(Beam.unit(), (SPRINGS, ALL), 510), load=Load(3.0))
    lanczos = solve_modes(model, 3).angular_frequency
    monkeypatch.setattr(modes_module, "MAX_DENSE", 1000)
    np.testing.assert_allclose(lanczos, solve_modes(model, 3).angular_frequency, rtol=1e-12)


@pytest.mark.parametrize(
    "pair",
    [
        (BODY, "free"),
        (SPRINGS, SPRINGS),
        ("clamped", End(mass=1.0)),
    ],
    ids=str,
)
def test_chains_about_as_long_as_the_dense_solver_takes(pair: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("modes", "stability"):
        monkeypatch.setattr(f"beammodes.vibration.{module}.MAX_DENSE", 30)
    for segments in (27, 28, 29, 30, 31):
        chain = Chain(Beam.unit(), pair, segments, "half_stub")
        assert highest_angular_frequency(chain) >= top_frequency(chain) * (1 - 1e-9)


def top_frequency(chain: Chain, load: Load | None = None) -> float:
    """The highest ω, by SciPy from the assembled matrices: high modes lose nothing there."""
    model = linearize(chain, load=load)
    last = [len(model.coordinates) - 1] * 2
    squares = scipy.linalg.eigh(
        model.stiffness_matrix, model.mass_matrix, eigvals_only=True, subset_by_index=last
    )
    return float(np.sqrt(squares[0]))


@pytest.mark.parametrize("force", [0.0, 300.0, -1.0])
def test_the_bound_on_the_highest_frequency_holds_with_springs_bodies_and_centres(
    force: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("beammodes.vibration.stability.MAX_DENSE", 0)
    generator = np.random.default_rng(7)
    for _ in range(60):
        pieces = int(generator.integers(2, 9))
        length = generator.uniform(0.1, 1, pieces)
        pair = tuple(
            End(*np.exp(generator.normal(0, 4, 2)), *np.exp(generator.normal(0, 2, 2)), generator.normal())
            for _ in range(2)
        )
        chain = Chain.from_pieces(
            length=length,
            mass=np.exp(generator.normal(0, 1, pieces)),
            centre=generator.uniform(-0.5, 1.5, pieces) * length,
            rotary_inertia=generator.uniform(0.001, 0.1, pieces),
            joint_stiffness=np.exp(generator.normal(0, 2, pieces - 1)),
            boundary=pair,
        )
        load = Load(force)
        if force >= 0 or buckling_load(chain) > -force:
            assert highest_angular_frequency(chain, load=load) >= top_frequency(chain, load) * (1 - 1e-9)


@pytest.mark.parametrize("pair", [(End(1e8, 1e8), End(1e8, 1e8)), ("clamped", BODY)], ids=str)
@pytest.mark.parametrize("rule", ["mitiguy", "half_stub", "hencky"])
def test_the_bound_is_close_on_long_chains(pair: Any, rule: str) -> None:
    chain = Chain(Beam.unit(), pair, 600, rule)
    ratio = highest_angular_frequency(chain) / top_frequency(chain)
    assert 1 - 1e-9 <= ratio < 1.2


# --- Published beams --------------------------------------------------------------------------------------

# L = EI = ρA = 1. Source: recomputed from each beam's characteristic equation with 40 digits; the tip mass 1
# is also printed by Bir (2010), table 5.
PUBLISHED = {
    "tip mass 1": (("clamped", End(mass=1.0)), [1.557297861198921, 16.2500851582386, 50.89584283121596]),
    "tip mass 1/2, inertia 1/100": (
        ("clamped", End(mass=0.5, rotary_inertia=0.01)),
        [1.9875255750879084, 13.403441938004592, 32.345056897142506],
    ),
    "root spring 2": ((End(INF, 2.0), "free"), [2.0162989818067807, 16.90141772097364, 51.700920891783305]),
    "both ends' rotational springs 100": (
        (End(INF, 100.0), End(INF, 100.0)),
        [21.541841710002778, 59.44856463665635, 116.6671087355787],
    ),
    "both ends' springs 1000": (
        (End(1000.0), End(1000.0)),
        [9.678715907394967, 36.44613019589153, 73.36940840932587],
    ),
    "tip rotational spring 100": (
        ("clamped", End(0.0, 100.0)),
        [5.5528105938233265, 29.930390490222777, 73.92914041658612],
    ),
    "everything": (
        (End(1000.0, 10.0), End(50.0, 0.0, 0.5, 0.02)),
        [7.912963954444647, 10.420399386976957, 25.38475166977933],
    ),
}


@pytest.mark.parametrize("rule", ["gregory", "mitiguy", "half_stub_corrected"])
@pytest.mark.parametrize("name", PUBLISHED)
def test_chains_reach_the_beam_at_the_declared_order(name: str, rule: str) -> None:
    pair, exact = PUBLISHED[name]
    order = RULES[rule].declared_order(Boundary.of(pair))
    sizes = np.array([[20], [40], [80], [160]])
    errors = np.abs([lowest(pair, int(n), rule) / exact - 1 for n in sizes[:, 0]])
    # theory.md section 4: at order 4, β⁴/1440 inside and 113/N times that an end; the report's wall
    # (1 + β)/(3 N²) an end. Section 5: half_stub_corrected has 2.4 times gregory's error; 4 leaves room for
    # bodies. Wavenumbers are below those between two walls.
    beta = np.array([4.7300407, 7.8532046, 10.9956078])
    bound = beta**4 / 1440 * (1 + 226 / sizes) if order == 4 else 2 * (1 + beta) / 3
    assert (errors < 4 * bound / sizes**order).all()
    # The terms inside and at the ends differ in sign, so an error may pass through zero and fall faster on
    # the way: at the declared order, |e| N^p grows no more from there.
    scaled = errors * sizes**order
    assert errors[2:].max() > 1e-11
    assert (scaled[3] < 2**0.5 * scaled[:3].max(axis=0)).all()


# --- A body on the last segment ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rule", "body", "word"),
    in_turns(
        EVERY_N, [{"rotary_inertia": 1e-9}, {"offset": 1e-9}, {}], ["clamped", "free", "pinned"], every=2
    ),
    ids=str,
)
def test_a_body_on_the_last_segment_leaves_no_jump(rule: str, body: dict[str, float], word: str) -> None:
    """As inertia and offset vanish the chain is that of a point mass: as many hinges, and no other error."""
    own = {"mass": 0.5, **body}
    point, carried = (word, End(mass=0.5)), (word, End(**own, on_segment=True))
    for segments in (3, 12):
        one, other = (Chain(Beam.unit(), pair, segments, rule) for pair in (point, carried))
        assert one.joint_stiffness.tolist() == other.joint_stiffness.tolist()
        was, now = (
            frequency_error(Boundary.of(pair), segments=segments, mode=np.arange(1, 4), rule=rule)
            for pair in (point, carried)
        )
        # J = 1e-9 has J θ²/m y² of the body's energy; the slopes θ of three modes stay below 1e2 y.
        np.testing.assert_allclose(now, was, atol=1e-4)


@pytest.mark.parametrize("rule", EVERY_N)
def test_both_layouts_of_a_body_have_the_same_limit(rule: str) -> None:
    """With or without a hinge of its own, and for both solvers, errors fall with N to the one beam's."""
    own = {"mass": 0.4, "rotary_inertia": 0.02, "offset": 0.03}
    for on_segment in (False, True):
        pair = Boundary.of(("clamped", End(**own, on_segment=on_segment)))
        errors = np.array([frequency_error(pair, segments=n, mode=1, rule=rule) for n in (100, 10**4, 10**5)])
        exact = euler_bernoulli(Beam.unit(), pair, 1).angular_frequency
        omega = solve_modes(linearize(Chain(Beam.unit(), pair, 100, rule)), 1).angular_frequency
        np.testing.assert_allclose(omega / exact - 1, errors[0], atol=1e-11)
        order = RULES[rule].declared_order(pair)
        assert abs(errors[2]) < 1e-13 or abs(math.log10(abs(errors[1] / errors[2])) - order) < 0.1


@pytest.mark.parametrize(
    "rule",
    [
        rule if i % 2 == EVERY_N.index("gregory") % 2 else pytest.param(rule, marks=pytest.mark.slow)
        for i, rule in enumerate(EVERY_N)
    ],
)
def test_a_hinge_of_its_own_suits_every_inertia_and_the_last_segment_light_bodies(rule: str) -> None:
    """Why a hinge of its own is the default: with it no inertia makes a rule much worse than a point mass."""

    def worst(inertia: float, on_segment: bool) -> float:
        ends = [End(mass=m, rotary_inertia=inertia, on_segment=on_segment) for m in (1e-3, 0.1, 1.0, 10.0)]
        pairs = [Boundary.of((word, end)) for word in ("clamped", "pinned", "free") for end in ends]
        return max(
            float(np.nanmax(np.abs(frequency_error(pair, segments=12, mode=[1, 2, 3], rule=rule))))
            for pair in pairs
        )

    light, heavy = ([worst(inertia, flag) for flag in (False, True)] for inertia in (1e-6, 1e-2))
    assert light[1] <= light[0] * (1 + 1e-4)
    if RULES[rule].stub == 0 and rule != "naive":
        assert heavy[0] < heavy[1]
    if rule == "gregory":
        # As the docstring of `End.statics` has it.
        assert light == pytest.approx([5e-3, 7e-4], rel=0.1) and heavy == pytest.approx([2e-3, 0.13], rel=0.1)


@pytest.mark.parametrize(
    ("carried", "order"),
    [((), 1), (("3/2",), 2), (("23/12", "7/12"), 3), (("479/240", "173/240", "39/80", "311/240"), 4)],
)
@pytest.mark.parametrize("stub", ["0", "1"])
def test_open_end_weights_mend_the_last_segment(carried: tuple[str, ...], order: int, stub: str) -> None:
    # The weights of an open end, first hinge one segment in: Adams and Bashforth's; the last by least change.
    plain = RULES["gregory" if stub == "0" else "rigid_stub_corrected"]
    rule = dataclasses.replace(plain, name="welded", carried=carried)
    assert rule.order["carried"] == order
    pair = Boundary.of(("pinned", End(mass=0.3, rotary_inertia=0.05, on_segment=True)))
    counts = (200, 400) if order > 2 else (2000, 4000)
    errors = [abs(frequency_error(pair, segments=n, mode=1, rule=rule)) for n in counts]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.25)
