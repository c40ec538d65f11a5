"""Mode shapes: the criterion's properties, and what rules that suit frequencies do to shapes."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
from drawn_ends import EVERY_N

from beammodes.accuracy.shapes import modal_assurance, shape_dataset
from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BOUNDARIES
from beammodes.springs.matched_springs import matched
from beammodes.springs.tuning import mode_tuned
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

UNIT = Beam.unit()
EVERY_RULE = pytest.mark.parametrize("rule", RULES)
PAIRS = [pair.name for pair in BOUNDARIES]
#: Unequal springs inside bend a wave in zigzag: no shape of theirs is exact.
AT_WALL = [name for name in EVERY_N if RULES[name].stub == 0]


def random_shapes(seed: int, modes: int = 4, nodes: int = 7) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal((modes, nodes))


def test_two_vectors_by_hand() -> None:
    # (1 + 0 + 2)² / ((1 + 1 + 4)(1 + 0 + 1)) = 9/12; with masses 1, 2, 3: (1 + 6)²/((1 + 2 + 12)(1 + 3)).
    assert modal_assurance([[1, 1, 2]], [[1, 0, 1]])[0, 0] == pytest.approx(9 / 12, rel=1e-15)
    assert modal_assurance([[1, 1, 2]], [[1, 0, 1]], [1, 2, 3])[0, 0] == pytest.approx(49 / 60, rel=1e-15)


def test_values_lie_between_nought_and_one() -> None:
    a, b = random_shapes(1, 60), random_shapes(2, 50)
    found = modal_assurance(a, b)
    assert found.shape == (60, 50) and found.min() >= 0 and found.max() <= 1
    own = modal_assurance(a, a)
    assert own.max() <= 1
    np.testing.assert_allclose(np.diag(own), 1, rtol=1e-15)


@pytest.mark.parametrize("scale", [-1.0, 3e200, 1e-200])
def test_scale_and_sign_of_shapes_and_masses_do_not_matter(scale: float) -> None:
    a, b, mass = random_shapes(1), random_shapes(2), np.arange(1.0, 8.0)
    expected = modal_assurance(a, b, mass)
    np.testing.assert_allclose(modal_assurance(scale * a, b / scale, mass), expected, rtol=1e-12, atol=1e-16)
    found = modal_assurance(a, b, abs(scale) * mass)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-16)


def test_masses_on_the_diagonal_are_a_matrix() -> None:
    a, b, mass = random_shapes(1), random_shapes(2), np.arange(1.0, 8.0)
    found = modal_assurance(a, b, np.diag(mass))
    np.testing.assert_allclose(found, modal_assurance(a, b, mass), rtol=1e-13)
    np.testing.assert_allclose(modal_assurance(a, b), modal_assurance(a, b, np.eye(7)), rtol=1e-13)


@EVERY_RULE
def test_modes_of_a_chain_are_orthogonal_in_its_own_mass_matrix(rule: str) -> None:
    model = linearize(Chain(UNIT, "pinned-pinned", 6, rule))
    shapes = solve_modes(model).deflection[:, 1:-1]
    found = modal_assurance(shapes, shapes, model.mass_matrix)
    np.testing.assert_allclose(found, np.eye(len(shapes)), atol=1e-13)


@pytest.mark.parametrize(("boundary", "rule"), [*itertools.product(PAIRS, ["mitiguy", "half_stub"])])
def test_dataset_against_its_definition(boundary: str, rule: str) -> None:
    segments, modes = 9, 3
    table = shape_dataset(boundary=boundary, segments=segments, modes=modes, rule=rule).squeeze()
    # Written from the layout: N + 1 nodes evenly spaced, or the two tips and the segments' middles.
    if rule == "mitiguy":
        x, mass = np.arange(10) / 9, np.array([0.5, *[1] * 8, 0.5])
    else:
        x, mass = np.array([0, *(np.arange(9) + 0.5) / 9, 1]), np.array([0.25, 0.75, *[1] * 7, 0.75, 0.25])
    found = solve_modes(linearize(Chain(UNIT, boundary, segments, rule)), modes)
    u = np.array([np.interp(x, found.position, shape) for shape in found.deflection])
    phi = euler_bernoulli(UNIT, boundary, modes).shape(x)
    for n in range(modes):
        assurance = modal_assurance(u[[n]], phi[[n]], mass)[0, 0]
        assert table.assurance_deficit.values[n] == pytest.approx(1 - assurance, abs=1e-14)
        root = np.sqrt(mass)
        scale = np.linalg.lstsq((root * u[n])[:, None], root * phi[n], rcond=None)[0][0]
        deviation = np.abs(scale * u[n] - phi[n]).max() / np.abs(phi[n]).max()
        assert table.largest_deviation.values[n] == pytest.approx(deviation, rel=1e-9, abs=1e-13)


# theory.md section 4: pinned-pinned is exactly q = n π/N, a sine at the nodes; a guided end with weight 1/2
# is a mirror. `naive` has another weight there.
@pytest.mark.parametrize(
    ("boundary", "rule"),
    [
        *(("pinned-pinned", rule) for rule in AT_WALL),
        *itertools.product(["guided-guided", "pinned-guided"], [rule for rule in AT_WALL if rule != "naive"]),
    ],
)
def test_shapes_that_are_exact_show_no_cancellation(boundary: str, rule: str) -> None:
    table = shape_dataset(boundary=boundary, segments=[2, 3, 8, 40], modes=3, rule=rule)
    # 1 - MAC formed by a difference would leave 1e-16 here.
    assert np.nanmax(table.assurance_deficit) < 1e-25
    assert np.nanmax(table.largest_deviation) < 1e-13


def test_a_small_deficit_keeps_its_digits() -> None:
    # A deficit is the square of a deviation of order 2: N⁴ times it settles, down to 1e-14 and below.
    count = np.array([100, 200, 400])
    deficit = shape_dataset(boundary="clamped-free", segments=count, modes=1).assurance_deficit.values.ravel()
    assert deficit[-1] < 3e-13
    settled = deficit * count.astype(float) ** 4
    assert settled[2] / settled[1] == pytest.approx(1, abs=0.005)


@EVERY_RULE
def test_shapes_are_of_order_two_at_best(rule: str) -> None:
    # Near a clamp a better frequency does not make a better shape: the first rods' slopes stay those of a
    # polygon whose corners carry the corrected weights.
    table = shape_dataset(boundary="clamped-free", segments=[100, 200], modes=1, rule=rule)
    deviation = table.largest_deviation.values.ravel()
    assert math.log2(deviation[0] / deviation[1]) == pytest.approx(
        min(2, RULES[rule].order["clamped"]), abs=0.1
    )


def test_gregory_trades_shape_for_frequency() -> None:
    table = shape_dataset(boundary="clamped-free", segments=10, modes=1, rule=["mitiguy", "gregory"])
    mitiguy, gregory = table.largest_deviation.values.ravel()
    # theory.md section 5, N = 10: its frequency is 250 times better. Its shape is worse, though below 0.4 %.
    assert 4 < gregory / mitiguy < 6 and gregory < 0.004


@EVERY_RULE
def test_missing_where_the_chain_has_no_such_mode(rule: str) -> None:
    table = shape_dataset(boundary=PAIRS, segments=range(1, 6), modes=6, rule=rule)
    for boundary, segments in itertools.product(PAIRS, range(1, 6)):
        # A pattern that does not fit N leaves no chain.
        has = Chain(UNIT, boundary, segments, rule).elastic_modes if RULES[rule].fits(segments) else 0
        for array in table.sel(boundary=boundary, segments=segments).data_vars.values():
            assert np.isfinite(array.values.ravel()).tolist() == [n < has for n in range(6)]
    assert np.nanmin(table.assurance_deficit) >= 0 and np.nanmax(table.assurance_deficit) <= 1


def test_every_length_ends_inside_the_beam() -> None:
    # Sums of 1/N pass 1 by a rounding for some N.
    table = shape_dataset(boundary="clamped-free", segments=range(1, 80), modes=1, rule="double_wall")
    assert np.isfinite(table.largest_deviation.values).all()


def test_dataset_takes_tuned_and_matched_records() -> None:
    rules = [mode_tuned(1), matched(2)]
    table = shape_dataset(boundary="clamped-free", segments=[1, 6], modes=2, rule=rules)
    assert table.rule.values.tolist() == ["mode_tuned(1)", "matched(2)"]
    deficit = table.assurance_deficit.squeeze()
    assert np.isnan(deficit.sel(rule="matched(2)", segments=1)).all()  # one mode only
    assert 0 < deficit.sel(segments=6).max() < 0.01


def test_dataset_is_labelled() -> None:
    table = shape_dataset(boundary="free-clamped", segments=[3, 4], modes=2, rule=["naive", RULES["gregory"]])
    assert dict(table.sizes) == {"rule": 2, "boundary": 1, "segments": 2, "mode": 2}
    assert table.boundary.values.tolist() == ["clamped-free"]
    assert table.mode.values.tolist() == [1, 2]
    assert table.attrs["source"].startswith("beammodes ")
    assert list(table.data_vars) == ["assurance_deficit", "largest_deviation"]
    assert all(array.attrs["units"] == "1" and array.long_name for array in table.data_vars.values())


@pytest.mark.parametrize(
    ("call", "kind", "message"),
    [
        (lambda: modal_assurance("ab", [[1.0]]), TypeError, "a must be an array of real numbers, got 'ab'"),
        (lambda: modal_assurance([[1], [1, 2]], [[1.0]]), TypeError, "a must be one regular array"),
        (lambda: modal_assurance([[1j]], [[1.0]]), TypeError, "a must be an array of real numbers"),
        (lambda: modal_assurance([1.0], [[1.0]]), ValueError, r"a must have 2 dimensions .* shape \(1,\)"),
        (lambda: modal_assurance(np.ones((0, 2)), [[1, 2]]), ValueError, r"a must .* shape \(0, 2\)"),
        (lambda: modal_assurance([[1.0]], [[math.nan]]), ValueError, "b must be finite, got nan"),
        (lambda: modal_assurance([[1, 2]], [[1, 2, 3]]), ValueError, "b must have 2 nodes as a has, got 3"),
        (lambda: modal_assurance([[1, 2]], [[1, 2], [0, 0]]), ValueError, "b must .* got 0 in row 1"),
        (lambda: modal_assurance([[1, 2]], [[1, 2]], [1, 0, 0]), ValueError, r"mass must have shape \(2,\)"),
        (
            lambda: modal_assurance([[1, 2]], [[1, 2]], [0, 0]),
            ValueError,
            "a must have positive modal masses",
        ),
        (lambda: modal_assurance([[1, 2]], [[1, 2]], [[1, 2], [0, 1]]), ValueError, "mass must be symmetric"),
        (lambda: modal_assurance([[1, 2]], [[1, 2]], 3.0), ValueError, "mass must have 1 or 2 dimensions"),
        (lambda: shape_dataset(boundary="free", segments=3, modes=1), ValueError, "boundary must name two"),
        (
            lambda: shape_dataset(boundary="free-free", segments=3, modes=0),
            ValueError,
            "modes must be a whole",
        ),
        (lambda: shape_dataset(boundary="free-free", segments=3, modes=True), TypeError, "modes .* got True"),
        (
            lambda: shape_dataset(boundary="free-free", segments=600, modes=70),
            ValueError,
            "modes .* at most 59",
        ),
        (
            lambda: shape_dataset(boundary="free-free", segments=3, modes=1, rule="naiv"),
            ValueError,
            'mean "naive"',
        ),
    ],
)
def test_bad_input(call: Any, kind: type[Exception], message: str) -> None:
    with pytest.raises(kind, match=message):
        call()
