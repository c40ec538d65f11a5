"""Accelerations of a chain by the linear recursion, against dense equations and independent derivations."""

from __future__ import annotations

import itertools
import math

import casadi
import numpy as np
import pytest
import sympy
from turns import in_turns

from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES
from beammodes.dynamics.base_motion import BaseMotion, base_vector, harmonic
from beammodes.dynamics.forward_dynamics import forward_dynamics
from beammodes.equations.mechanics import Algebra, coordinate_names, energies, moving_pieces, tip_names
from beammodes.equations.numeric import compile_equations
from beammodes.problem.beam import Beam
from beammodes.problem.ends import ENDS
from beammodes.problem.loading import Load
from beammodes.vibration.damping import Damping
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

Array = np.ndarray

BEAM = Beam(1.3, 2.0, 0.7)
TIED = ("clamped", "pinned", "guided")
PLAIN = [f"{left}-{right}" for left, right in itertools.product(TIED, ENDS)]
SPRUNG = [
    "pinned(rotational_stiffness=3)-free",
    "free(translational_stiffness=5)-free",
    "free(translational_stiffness=5, rotational_stiffness=2)-free(translational_stiffness=7)",
    "guided(translational_stiffness=4)-clamped",
    "clamped-free(mass=0.5, rotary_inertia=0.01, offset=0.2)",
    "free(rotational_stiffness=2, mass=0.3, offset=-0.1)-pinned(rotational_stiffness=1, rotary_inertia=0.2)",
    "pinned(mass=0.4, offset=0.15, rotary_inertia=0.05)-guided(mass=2)",
    "clamped-guided(translational_stiffness=3, mass=1)",
]
LOAD = Load(axial_force=-1.7, gravity=(0.6, -9.81), tip_force=(2.3, -1.1), tip_moment=0.9)
STILL = base_vector(BaseMotion(), 0.0)


def pieces_with_centres(boundary: str) -> Chain:
    return Chain.from_pieces(
        length=[0.3, 1.1, 0.7, 0.9],
        mass=[0.5, 1.3, 0.4, 0.8],
        rotary_inertia=[0.02, 0.3, 0.05, 0.11],
        joint_stiffness=[4.0, 2.5, 3.0],
        centre=[0.1, 0.9, -0.2, 0.5],
        boundary=boundary,
    )


def random_state(chain: Chain, seed: int) -> tuple[Array, Array]:
    generator, size = np.random.default_rng(seed), len(coordinate_names(chain))
    return generator.uniform(-2.5, 2.5, size), generator.uniform(-4, 4, size)


def dense_accelerations(chain: Chain, q: Array, u: Array, load: Load | None, force: Array | float) -> Array:
    """q'' of  M q'' + h + s - Jᵀ λ = force,  with the closure's second derivative zero, by a full solve."""
    compiled = compile_equations(chain, load=load)
    mass, slope = compiled.mass_matrix(q).full(), compiled.constraint_jacobian(q).full()
    rest = force - (compiled.velocity_terms(q, u) + compiled.static_forces(q)).full()[:, 0]
    tips, moving = len(tip_names(chain)), moving_pieces(chain)
    # c = y_0 + Σ l sin θ, so that what its second derivative holds besides J q'' is  -Σ l sin θ θ'².
    bent = chain.length[moving] @ (np.sin(q[tips:]) * u[tips:] ** 2)
    held = len(slope)
    system = np.block([[mass, -slope.T], [slope, np.zeros((held, held))]])
    return np.linalg.solve(system, np.concatenate([rest, np.full(held, bent)]))[: len(q)]


def accelerations(
    chain: Chain,
    q: Array,
    u: Array,
    *,
    load: Load | None = None,
    base: Array = STILL,
    damping: Damping | None = None,
) -> Array:
    function = forward_dynamics(chain, load=load, damping=damping)
    return np.array(function(q, u, base).full()[:, 0])


def assert_recursion_is_dense(chain: Chain, load: Load | None, seed: int = 0) -> None:
    function = forward_dynamics(chain, load=load)
    for k in range(3):
        q, u = random_state(chain, 10 * seed + k)
        expected = dense_accelerations(chain, q, u, load, 0.0)
        found = function(q, u, STILL).full()[:, 0]
        np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("boundary", PLAIN + SPRUNG)
def test_recursion_equals_the_dense_equations(boundary: str) -> None:
    for segments, load in ((1, None), (2, LOAD), (5, LOAD)):
        chain = Chain(BEAM, boundary, segments)
        if chain.elastic_modes + chain.boundary.rigid_body_modes:
            assert_recursion_is_dense(chain, load, segments)


@pytest.mark.parametrize(
    ("boundary", "rule"), in_turns(["clamped-free", "guided-clamped", "pinned-guided"], RULES, every=3)
)
def test_recursion_equals_the_dense_equations_for_every_layout(boundary: str, rule: str) -> None:
    # Rules differ in their stubs at the walls: none, of no length, of half a segment or of a whole one.
    assert_recursion_is_dense(Chain(BEAM, boundary, 4, rule), LOAD)


@pytest.mark.parametrize("boundary", PLAIN)
def test_recursion_equals_the_dense_equations_for_given_pieces(boundary: str) -> None:
    assert_recursion_is_dense(pieces_with_centres(boundary), LOAD)


@pytest.mark.parametrize("segments", [1, 2, 6])
def test_recursion_equals_the_dense_equations_in_free_flight(segments: int) -> None:
    assert_recursion_is_dense(Chain(BEAM, "free-free", segments), None)
    # A pair of forces leaves the chain as it is, as a whole.
    assert_recursion_is_dense(Chain(BEAM, "free-free", segments), Load(axial_force=3.0))
    assert_recursion_is_dense(pieces_with_centres("free-free"), Load(axial_force=-2.0))


def test_loads_in_free_flight_do_their_work_by_virtual_displacements() -> None:
    # Generalized forces of a tip force F and moment: F on x_0 and y_0, l n·F and the moment on the angles;
    # gravity, by the equivalence principle, falls on x_0 and y_0 alone.
    chain, force, moment, weight = pieces_with_centres("free-free"), (2.3, -1.1), 0.9, (0.6, -9.81)
    q, u = random_state(chain, 5)
    virtual = np.concatenate(
        [force, chain.length * (np.cos(q[2:]) * force[1] - np.sin(q[2:]) * force[0])]
    ) + np.array([0, 0, 0, 0, 0, moment])
    expected = dense_accelerations(chain, q, u, None, virtual)
    expected[:2] += weight
    load = Load(gravity=weight, tip_force=force, tip_moment=moment)
    np.testing.assert_allclose(accelerations(chain, q, u, load=load), expected, rtol=1e-10, atol=1e-10)


def test_recursion_equals_the_dense_equations_for_an_uneven_beam() -> None:
    chain = Chain(Beam(2.0, lambda x: 3 - x, lambda x: 1 + x**2), "clamped-free", 40)
    assert_recursion_is_dense(chain, Load(gravity=9.81))


# A base that moves.


def lagrange(
    chain: Chain, damping: Damping, load: Load, springs: tuple[float, float]
) -> tuple[sympy.Matrix, list[sympy.Symbol], list[sympy.Symbol]]:
    """Lagrange's equations of a chain on a base (x, y, φ)(t), in inertial coordinates: residual, q'', state.

    `springs` are (K_t, K_r) of the left end; a piece that it holds has the base's angle.
    """
    t = sympy.Symbol("t")
    x, y, phi = (sympy.Function(n)(t) for n in ("x", "y", "phi"))
    free = [sympy.Function(n)(t) for n in coordinate_names(chain)]
    named = dict(zip(coordinate_names(chain), free, strict=True))
    angle, moving = [], iter(free[len(tip_names(chain)) :])
    for held in chain.held_angles:
        angle.append(phi if held else next(moving))
    place = sympy.Matrix([named.get("x_0", x), named.get("y_0", y)])
    origin, kinetic, potential, lost = sympy.Matrix([x, y]), 0, 0, 0
    stiff, alpha, beta = chain.joint_stiffness, damping.mass, damping.stiffness
    for i, theta in enumerate(angle):
        along = sympy.Matrix([sympy.cos(theta), sympy.sin(theta)])
        centre = place + chain.centre[i] * along
        speed, arm = centre.diff(t), centre - origin
        carried = origin.diff(t) + phi.diff(t) * sympy.Matrix([-arm[1], arm[0]])
        mass, inertia = chain.mass[i], chain.rotary_inertia[i]
        kinetic += (mass * speed.dot(speed) + inertia * theta.diff(t) ** 2) / 2
        relative = speed - carried
        lost += alpha / 2 * (mass * relative.dot(relative) + inertia * (theta - phi).diff(t) ** 2)
        potential -= mass * sympy.Matrix(load.weight).dot(centre)
        place = place + chain.length[i] * along
    for j, k in enumerate(stiff):
        bend = angle[j + 1] - angle[j]
        potential += k / 2 * bend**2
        lost += damping.joint_damping(chain)[j] / 2 * bend.diff(t) ** 2
    shift, turn = named.get("y_0", y) - y, angle[0] - phi
    for k, bend in zip(springs, (shift, turn), strict=True):
        potential += k / 2 * bend**2
        lost += beta * k / 2 * bend.diff(t) ** 2
    potential -= sympy.Matrix(load.tip).dot(place) + load.tip_moment * angle[-1]
    equations = []
    for c in free:
        v = c.diff(t)
        equations.append(kinetic.diff(v).diff(t) - kinetic.diff(c) + potential.diff(c) + lost.diff(v))
    order = [d for c in (*free, x, y, phi) for d in (c.diff(t, 2), c.diff(t), c)]
    plain = [sympy.Symbol(f"s{k}") for k in range(len(order))]
    residual = sympy.Matrix(equations).xreplace(dict(zip(order, plain, strict=True)))
    return residual, plain[: 3 * len(free) : 3], plain


@pytest.mark.parametrize(
    ("boundary", "springs", "turns", "damped"),
    [
        pytest.param("clamped-free", (0.0, 0.0), True, False, marks=pytest.mark.slow),
        ("clamped-free", (0.0, 0.0), True, True),
        ("pinned(rotational_stiffness=3)-free", (0.0, 3.0), True, True),
        pytest.param(
            "guided(translational_stiffness=4)-free", (4.0, 0.0), False, True, marks=pytest.mark.slow
        ),
        ("free(translational_stiffness=4, rotational_stiffness=2)-free", (4.0, 2.0), False, True),
        pytest.param("free-free", (0.0, 0.0), False, True, marks=pytest.mark.slow),
    ],
)
def test_moving_base_equals_lagranges_equations(
    boundary: str, springs: tuple[float, float], turns: bool, damped: bool
) -> None:
    chain = Chain.from_pieces(
        length=[0.4, 1.1, 0.7],
        mass=[0.5, 1.3, 0.4],
        rotary_inertia=[0.05, 0.3, 0.05],
        centre=[0.3, 0.4, 0.5],
        joint_stiffness=[4.0, 2.5],
        boundary=boundary,
    )
    damping = Damping(mass=0.3, stiffness=0.2, joint=(0.1, 0.4)) if damped else Damping()
    load = Load(gravity=(0.4, -2.0), tip_force=(1.0, 0.7), tip_moment=0.3)
    residual, unknown, plain = lagrange(chain, damping, load, springs)
    q, u = random_state(chain, 3)
    base = np.random.default_rng(4).uniform(-2, 2, (3, 3))
    if not turns:
        base[2] = 0.0
    known = {}
    states = [*zip(q, u, strict=True), *((b[0], b[1]) for b in base)]
    for k, (value, rate) in enumerate(states):
        known |= {plain[3 * k + 2]: value, plain[3 * k + 1]: rate}
    known |= {plain[3 * (len(q) + k)]: b[2] for k, b in enumerate(base)}
    numbers = residual.xreplace({symbol: sympy.Float(value) for symbol, value in known.items()})
    matrix = np.array(numbers.jacobian(unknown).evalf().tolist(), dtype=float)
    rest = np.array(numbers.subs(dict.fromkeys(unknown, 0)).evalf().tolist(), dtype=float)[:, 0]
    found = accelerations(chain, q, u, load=load, base=base.ravel(), damping=damping)
    expected = np.linalg.solve(matrix, -rest)
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("boundary", PLAIN)
def test_accelerated_base_acts_as_gravity(boundary: str) -> None:
    # Equivalence principle: seen from a base with acceleration a, everything weighs -a.
    chain, (ax, ay) = Chain(BEAM, boundary, 4), (1.7, -3.1)
    q, u = random_state(chain, 6)
    expected = accelerations(chain, q, u, load=Load(gravity=(-ax, -ay)))
    moved, speed = q.copy(), u.copy()
    shift = np.array([name == "y_0" for name in coordinate_names(chain)])
    moved[shift] += 0.7
    speed[shift] += -0.4
    base = np.array([0.3, 0.9, ax, 0.7, -0.4, ay, 0.0, 0.0, 0.0])
    found = accelerations(chain, moved, speed, base=base) - ay * shift
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-10 * np.abs(expected).max())


# Damping.


def energy_rate(chain: Chain, load: Load | None, damping: Damping, q: Array, u: Array) -> float:
    """dE/dt by the chain rule on the stated energies."""
    units, size = chain.units, len(q)
    algebra = Algebra(float, casadi.sin, casadi.cos, units.length, units.mass, units.stiffness)
    at, speed = casadi.SX.sym("q", size), casadi.SX.sym("u", size)
    parts = energies(chain, casadi.vertsplit(at), casadi.vertsplit(speed), algebra, load)
    whole = parts.kinetic + parts.potential
    slopes = casadi.Function(
        "slopes", [at, speed], [casadi.gradient(whole, at), casadi.gradient(whole, speed)]
    )
    by_place, by_speed = (slope.full()[:, 0] for slope in slopes(q, u))
    return float(by_place @ u + by_speed @ accelerations(chain, q, u, load=load, damping=damping))


def on_closure(chain: Chain, q: Array, u: Array) -> tuple[Array, Array]:
    """A state near the given one whose right tip, where it is held, neither deflects nor moves."""
    compiled = compile_equations(chain)
    for _ in range(30 if compiled.constraints.size1_out(0) else 0):
        slope = compiled.constraint_jacobian(q).full()
        q = q - np.linalg.pinv(slope) @ compiled.constraints(q).full()[:, 0]
    slope = compiled.constraint_jacobian(q).full()
    return q, u - np.linalg.pinv(slope) @ (slope @ u) if len(slope) else u


@pytest.mark.parametrize("boundary", in_turns(PLAIN + SPRUNG, every=2))
def test_damping_takes_the_power_of_rayleighs_function(boundary: str) -> None:
    # dE/dt = -q'ᵀ C q' with q'ᵀ M q' = 2 T and q'ᵀ K q' = 2 V of springs and supports at the rates q'.
    chain = Chain(BEAM, boundary, 4)
    alpha, beta, own = 0.7, 0.05, np.linspace(0.1, 0.5, len(chain.joint_stiffness))
    q, u = on_closure(chain, *random_state(chain, 7))
    numbers = Algebra(float, math.sin, math.cos, chain.units.length, chain.units.mass, chain.units.stiffness)
    twice_kinetic = 2 * energies(chain, q.tolist(), u.tolist(), numbers).kinetic
    rates, moving = np.zeros(chain.pieces), iter(u[len(tip_names(chain)) :])
    for i, held in enumerate(chain.held_angles):
        rates[i] = 0.0 if held else next(moving)
    turning = np.diff(rates) ** 2
    tips = dict(zip(coordinate_names(chain), u, strict=True))
    angles, moving = np.zeros(chain.pieces), iter(q[len(tip_names(chain)) :])
    for i, held in enumerate(chain.held_angles):
        angles[i] = 0.0 if held else next(moving)
    left = tips.get("y_0", 0.0)
    right = left + chain.length @ (np.cos(angles) * rates)
    supports = np.where(np.isfinite(chain.support_stiffness), chain.support_stiffness, 0.0)
    ends = np.sum(supports * np.array([[left, rates[0]], [right, rates[-1]]]) ** 2)
    expected = alpha * twice_kinetic + (beta * chain.joint_stiffness + own) @ turning + beta * ends
    damping = Damping(mass=alpha, stiffness=beta, joint=own)
    assert expected > 0
    assert energy_rate(chain, LOAD, damping, q, u) == pytest.approx(-expected, rel=1e-9)
    assert energy_rate(chain, LOAD, Damping(), q, u) == pytest.approx(0.0, abs=1e-9 * expected)


@pytest.mark.parametrize("boundary", PLAIN + SPRUNG)
def test_damping_ratios_of_the_linear_modes(boundary: str) -> None:
    # Textbook (Clough and Penzien, Dynamics of Structures, Rayleigh damping): ζ_n = α/(2 ω_n) + β ω_n/2.
    chain, alpha, beta = Chain(BEAM, boundary, 3), 0.4, 2e-3
    acceleration = forward_dynamics(chain, damping=Damping(mass=alpha, stiffness=beta))
    size = acceleration.size1_in(0)
    q, u = casadi.SX.sym("q", size), casadi.SX.sym("u", size)
    force = acceleration(q, u, STILL)
    slopes = casadi.Function("slopes", [q, u], [casadi.jacobian(force, q), casadi.jacobian(force, u)])
    stiff, damped = (part.full() for part in slopes(np.zeros(size), np.zeros(size)))
    roots = np.linalg.eigvals(np.block([[np.zeros((size, size)), np.eye(size)], [stiff, damped]]))
    omega = solve_modes(linearize(chain)).angular_frequency
    assert len(omega)
    for expected in omega:
        pair = -expected * (ratio := alpha / (2 * expected) + beta * expected / 2)
        pair = pair + 1j * expected * np.emath.sqrt(1 - ratio**2)
        assert np.abs(roots - pair).min() < 1e-7 * expected


def test_rigid_motion_with_the_base_is_not_damped() -> None:
    chain, rate = pieces_with_centres("clamped-free"), 1.7
    base = np.array([0.4, 0.9, -0.3, -0.2, 1.1, 0.8, 0.6, rate, 2.2])
    q, u = np.full(3, 0.6), np.full(3, rate)
    damping = Damping(mass=50.0, stiffness=3.0, joint=7.0)
    with_it = accelerations(chain, q, u, base=base, damping=damping)
    without = accelerations(chain, q, u, base=base)
    np.testing.assert_allclose(with_it, without, rtol=1e-11, atol=1e-11 * np.abs(without).max())
    # It does damp what is not rigid.
    assert np.abs(accelerations(chain, q, 2 * u, base=base, damping=damping) - without).max() > 1.0


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        ({"mass": -1.0}, "mass"),
        ({"mass": math.nan}, "mass"),
        ({"stiffness": "a"}, "stiffness"),
        ({"stiffness": -1e-300}, "stiffness"),
        ({"joint": -1.0}, "joint"),
        ({"joint": (1.0, math.inf)}, r"joint\[1\]"),
        ({"joint": (1.0, None)}, r"joint\[1\]"),
        ({"joint": "ab"}, "joint"),
        ({"joint": None}, "joint"),
    ],
)
def test_bad_damping_is_refused_by_name(numbers: dict[str, object], message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        Damping(**numbers)  # type: ignore[arg-type]


def test_dampers_for_other_hinges_are_refused() -> None:
    with pytest.raises(ValueError, match="joint must have 4 entries, one a hinge, got 3"):
        forward_dynamics(Chain(BEAM, "clamped-free", 4), damping=Damping(joint=(1.0, 2.0, 3.0)))


def test_a_damper_from_an_array_without_axes() -> None:
    assert Damping(joint=np.array(0.5)) == Damping(joint=0.5)  # type: ignore[arg-type]


# Cost, and what is refused.


def instructions(boundary: str, segments: int) -> int:
    chain = Chain(BEAM, boundary, segments)
    return int(forward_dynamics(chain, load=Load(axial_force=1.0)).n_instructions())


def test_cost_grows_linearly_with_length() -> None:
    # 20 times as long: 20 times the work by the recursion, 400 times by a full mass matrix.
    short, long = (instructions("clamped-free", n) for n in (25, 500))
    assert 18 * short < long < 25 * short


@pytest.mark.parametrize("boundary", ["clamped-clamped", "free-free", "guided-pinned"])
def test_every_further_segment_costs_the_same(boundary: str) -> None:
    counts = [instructions(boundary, n) for n in (10, 20, 30)]
    assert counts[2] - counts[1] == counts[1] - counts[0] > 0


TURNING = BaseMotion(angle=harmonic(0.1, 1.0))


@pytest.mark.parametrize(
    ("boundary", "options", "message"),
    [
        ("free-clamped", {}, "boundary must tie down the left end"),
        ("free-free(translational_stiffness=1)", {}, "boundary must tie down the left end"),
        ("clamped-free", {"load": Load(spin_rate=1.0)}, "spin_rate"),
        ("clamped-free", {"load": 9.81}, "load must be a Load"),
        ("clamped-free", {"damping": 0.1}, "damping must be a Damping"),
        ("clamped-free", {"base": TURNING.angle}, "base must be a BaseMotion"),
        ("clamped-pinned", {"base": TURNING}, "base must not turn"),
        ("clamped-guided", {"base": TURNING}, "base must not turn"),
        ("clamped-free(translational_stiffness=1)", {"base": TURNING}, "base must not turn"),
        ("guided-free", {"base": TURNING}, "base must not turn"),
        ("free-free", {"base": TURNING}, "base must not turn"),
    ],
)
def test_what_forward_dynamics_refuses(boundary: str, options: dict[str, object], message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        forward_dynamics(Chain(BEAM, boundary, 2), **options)  # type: ignore[arg-type]


def test_no_chain_is_refused() -> None:
    with pytest.raises(TypeError, match="chain must be a Chain"):
        forward_dynamics("clamped-free")  # type: ignore[arg-type]
