"""Chains under loads along them and on turning hubs: the linear model from the nonlinear energies."""

from __future__ import annotations

import itertools
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy

from beammodes.accuracy.errors import frequency_error
from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES
from beammodes.equations.mechanics import coordinate_names
from beammodes.equations.numeric import compile_equations
from beammodes.equations.symbolic import equations_of_motion, symbolic_energies
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, End
from beammodes.problem.loading import Load
from beammodes.vibration.linear import linearize, nodal_deflections, nodal_matrices
from beammodes.vibration.modes import solve_modes

UNIT = Beam.unit()
HUB = ("clamped", End(mass=Fraction(1, 2), rotary_inertia=Fraction(1, 50), offset=Fraction(1, 10)))
PAIRS: list[Any] = ["clamped-free", "pinned-free", "clamped-pinned", "clamped-guided", HUB]
LOADS = {
    "flap": Load(spin_rate=Fraction(3), hub_radius=Fraction(1, 4), plane="flap"),
    "lag": Load(spin_rate=Fraction(3), hub_radius=Fraction(1, 4), plane="lag"),
    "weight": Load(gravity=(Fraction(2), 0.0), axial_force=Fraction(-1, 3)),
    "tip": Load(tip_force=(Fraction(5, 4), 0.0)),
}


def rational(rows: list[list[Fraction]], columns: int) -> sympy.Matrix:
    entries = [sympy.Rational(v.numerator, v.denominator) for row in rows for v in row]
    return sympy.Matrix(len(rows), columns, entries)


def to_coordinates(chain: Chain) -> sympy.Matrix:
    """y_0 and θ_i of the moving pieces in nodal coordinates."""
    index = nodal_deflections(chain)
    size = len(nodal_matrices(chain, Fraction)[1])
    angles = iter(range(len({i for i in index if i is not None}), size))

    def node(k: int) -> list[Fraction]:
        return [Fraction(index[k] == i) for i in range(size)]

    rows = [node(0)] if "y_0" in coordinate_names(chain) else []
    for i, held in enumerate(chain.held_angles):
        if held:
            continue
        length = Fraction(chain.scaled.length[i])
        if not length:
            own = next(angles)
            rows.append([Fraction(own == j) for j in range(size)])
        else:
            rows.append([(b - a) / length for a, b in zip(node(i), node(i + 1), strict=True)])
    return rational(rows, size)


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("pair", PAIRS, ids=str)
def test_three_routes_agree_under_every_load(pair: Any, load: str) -> None:
    # The potential's second derivative (SymPy, CasADi) against the pulls that the nodal form adds.
    for segments, rule in itertools.product((1, 3), ("gregory", "half_stub")):
        chain = Chain(UNIT, pair, segments, rule)
        exact = equations_of_motion(chain, load=LOADS[load]).linearize().in_unit_segments()
        turn = to_coordinates(chain)
        _, mass, stiffness = nodal_matrices(chain, Fraction, LOADS[load])
        assert turn.T * exact.mass_matrix * turn == rational(mass, turn.cols)
        assert sympy.simplify(
            turn.T * exact.stiffness_matrix * turn - rational(stiffness, turn.cols)
        ).is_zero_matrix
        compiled = compile_equations(chain, load=LOADS[load]).linearize()
        ours = np.array(exact.stiffness_matrix.tolist(), dtype=float).reshape(compiled.stiffness_matrix.shape)
        scale = np.array([1.0 if n == "y_0" else chain.units.length for n in compiled.coordinates])
        ours = ours * np.outer(scale, scale) * chain.units.stiffness / chain.units.length**2
        np.testing.assert_allclose(compiled.stiffness_matrix, ours, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("pair", PAIRS, ids=str)
def test_lag_is_flap_less_the_hub_s_turning(pair: Any) -> None:
    # K_lag = K_flap - Ω² M: here from the two potentials' own derivatives, in exact numbers.
    chain = Chain(UNIT, pair, 3)
    flap, lag = (
        equations_of_motion(chain, load=LOADS[p]).linearize().in_unit_segments() for p in ("flap", "lag")
    )
    square = chain.exact_units.square_rate(3)
    rate = sympy.Rational(square.numerator, square.denominator)
    basis = flap.basis
    gap = basis.T * (flap.stiffness_matrix - lag.stiffness_matrix - rate * flap.mass_matrix) * basis
    assert sympy.simplify(gap).is_zero_matrix
    for n in (1, 2):
        first, second = (
            solve_modes(linearize(chain, load=LOADS[p])).angular_frequency[:n] for p in ("flap", "lag")
        )
        np.testing.assert_allclose(second**2, first**2 - 9, rtol=1e-13)


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("pair", ["clamped-free", "clamped-pinned", HUB], ids=str)
def test_static_forces_are_the_derivatives_of_the_potential(pair: Any, load: str) -> None:
    full = Load(
        **{
            **LOADS[load].__dict__,
            "gravity": (LOADS[load].weight[0], Fraction(-3)),
            "tip_moment": Fraction(1, 7),
        }
    )
    chain = Chain(UNIT, pair, 2)
    equations = equations_of_motion(chain, load=full)
    potential = symbolic_energies(chain, load=full).potential
    values = dict(
        zip(
            equations.coordinates,
            np.random.default_rng(3).uniform(-1, 1, len(equations.coordinates)),
            strict=True,
        )
    )
    values |= {sympy.Symbol(n, positive=True): v for n, v in (("m", 0.7), ("ell", 1.3), ("EI", 2.0))}
    for coordinate, force in zip(equations.coordinates, equations.static_forces, strict=True):
        assert float(potential.diff(coordinate).subs(values)) == pytest.approx(
            float(force.subs(values)), abs=1e-12
        )


@pytest.mark.parametrize("rule", RULES)
def test_every_rule_has_its_declared_order_under_spin(rule: str) -> None:
    # Measured on the first two modes from N = 80, 160, 320; the exact beam is the spectral one.
    load = Load(spin_rate=4.0, hub_radius=0.5, plane="flap")
    error = np.array(
        [
            frequency_error("clamped-free", segments=n, mode=[1, 2], rule=rule, load=load, beam=UNIT)
            for n in (80, 160, 320)
        ]
    )
    order = np.log2(np.abs(error[:-1] / error[1:]))[-1]
    declared = RULES[rule].declared_order(Boundary.of("clamped-free"), load)
    assert declared <= 2
    assert np.all(order > declared - 0.2)


def test_a_long_chain_spins_like_a_short_one_of_the_same_law(monkeypatch: pytest.MonkeyPatch) -> None:
    # Lanczos against the dense solution of the same chain.
    model = linearize(Chain(UNIT, "clamped-free", 520), load=LOADS["flap"])
    iterated = solve_modes(model, 3).angular_frequency
    monkeypatch.setattr("beammodes.vibration.modes.MAX_DENSE", 1000)
    np.testing.assert_allclose(iterated, solve_modes(model, 3).angular_frequency, rtol=1e-12)


def test_a_standing_chain_buckles_under_its_own_weight() -> None:
    # Greenhill's column: g ρA L³/EI = 7.837347438943484 (root of J_{-1/3}).
    for factor, stands in ((0.995, True), (1.005, False)):
        load = Load(gravity=(-7.837347438943484 * factor, 0.0))
        model = linearize(Chain(UNIT, "clamped-free", 100, "gregory"), load=load)
        if stands:
            assert solve_modes(model, 1).angular_frequency[0] < 0.3
        else:
            with pytest.raises(ValueError, match=r"^load must not buckle"):
                solve_modes(model, 1)


def test_loads_that_bend_or_have_no_hub_are_refused() -> None:
    chain = Chain(UNIT, "clamped-free", 4)
    for load in (Load(gravity=9.81), Load(tip_force=1.0), Load(tip_moment=1.0)):
        with pytest.raises(
            ValueError, match=r"^load must leave the straight chain in equilibrium.*find_equilibrium"
        ):
            linearize(chain, load=load)
    for pair in ("free-free", "free-clamped"):
        with pytest.raises(ValueError, match=r"^boundary must tie the left end"):
            linearize(Chain(UNIT, pair, 4), load=Load(spin_rate=1.0))
    with pytest.raises(ValueError, match=r"^beam must have no rotary_inertia"):
        linearize(Chain(Beam(1.0, 1.0, 1.0, 0.01), "clamped-free", 4), load=Load(spin_rate=1.0))
    with pytest.raises(ValueError, match=r"^spin_rate must be lower"):
        solve_modes(linearize(Chain(UNIT, "pinned-free", 7), load=Load(spin_rate=2.0, plane="lag")))


def test_error_lookups_take_spin() -> None:
    load = Load(spin_rate=6.0, plane="lag")
    chain = Chain(UNIT, "clamped-free", 30, "gregory")
    ours = solve_modes(linearize(chain, load=load), 2).angular_frequency
    exact = euler_bernoulli(UNIT, "clamped-free", 2, load=load).angular_frequency
    error = frequency_error("clamped-free", segments=30, mode=[1, 2], rule="gregory", load=load, beam=UNIT)
    np.testing.assert_allclose(error, ours / exact - 1, atol=1e-12)
