"""Numbers of ends and loads as dimensions of the error table, and in a beam's own units."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from beammodes.accuracy.end_numbers import NUMBERS, in_beam_units
from beammodes.accuracy.error_table import error_dataset
from beammodes.accuracy.errors import frequency_error, segments_needed
from beammodes.chains.chain import Chain
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary
from beammodes.problem.loading import Load
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes


def test_numbers_are_dimensions_between_boundary_and_segments() -> None:
    over = {
        "right_mass": [0.0, 0.5],
        "left_rotational_stiffness": [10.0, math.inf],
        "axial_force": [-1.0, 0.0, 2.0],
    }
    table = error_dataset(
        boundary="pinned-free", segments=[4, 9], modes=2, rule=["mitiguy", "gregory"], over=over
    )
    assert table.relative_error.dims == ("rule", "boundary", *over, "segments", "mode")
    assert [table[name].attrs["units"] for name in over] == [NUMBERS[name] for name in over]
    one = table.relative_error.sel(
        rule="gregory", right_mass=0.5, left_rotational_stiffness=10.0, axial_force=2.0, segments=9
    )
    pair = "pinned(rotational_stiffness=10)-free(mass=0.5)"
    expected = frequency_error(pair, segments=9, mode=[1, 2], rule="gregory", load=Load(axial_force=2.0))
    np.testing.assert_allclose(one.squeeze().values, expected, rtol=1e-12)
    # The plain corner is the plain pair's.
    plain = table.relative_error.sel(
        rule="mitiguy", right_mass=0.0, left_rotational_stiffness=math.inf, axial_force=0.0, segments=4
    )
    np.testing.assert_allclose(
        plain.squeeze().values, frequency_error("clamped-free", segments=4, mode=[1, 2]), rtol=1e-9
    )


def test_the_two_ends_stay_in_the_order_given() -> None:
    table = error_dataset(boundary="free-clamped", segments=5, modes=1, over={"left_mass": [1.0]})
    assert table.boundary.values.tolist() == ["free-clamped"]
    other = error_dataset(boundary="clamped-free", segments=5, modes=1, over={"right_mass": [1.0]})
    np.testing.assert_allclose(table.relative_error.values, other.relative_error.values, rtol=1e-12)


@pytest.mark.parametrize(
    ("over", "words"),
    [
        ({"right_mas": [1.0]}, 'did you mean "right_mass"'),
        ({"right_mass": []}, "right_mass must name at least one value"),
        ({"right_mass": [-1.0]}, "mass must not be negative"),
        ({"axial_force": [math.nan]}, "axial_force must be finite"),
        ({"left_rotational_stiffness": ["stiff"]}, "rotational_stiffness must be a real number"),
    ],
)
def test_bad_dimensions_are_named(over: Any, words: str) -> None:
    with pytest.raises((TypeError, ValueError), match=words):
        error_dataset(boundary="clamped-free", segments=4, modes=1, over=over)


def test_over_must_be_a_mapping() -> None:
    with pytest.raises(TypeError, match="over must map"):
        error_dataset(boundary="clamped-free", segments=4, modes=1, over=[1.0])  # type: ignore[arg-type]


def test_lookups_broadcast_over_ends() -> None:
    pairs = ["clamped-free", "clamped-free(mass=1)", "pinned(rotational_stiffness=3)-free"]
    found = frequency_error(np.array(pairs)[:, None], segments=[5, 20], mode=1, rule="gregory")
    for i, pair in enumerate(pairs):
        for j, count in enumerate((5, 20)):
            one = frequency_error(pair, segments=count, mode=1, rule="gregory")
            assert found[i, j] == pytest.approx(one, rel=1e-9)  # type: ignore[index]
    assert math.isnan(frequency_error("clamped-free(mass=1)", segments=2, mode=3))


def test_ends_in_a_beam_s_own_units_have_the_same_errors() -> None:
    beam = Beam(1.7, 23.0, 0.4)
    physical = Boundary.of(
        "free(translational_stiffness=90, mass=0.2, rotary_inertia=0.01, offset=0.1)-pinned"
    )
    scaled = in_beam_units(physical, beam)
    ours = solve_modes(linearize(Chain(beam, physical, 12, "gregory")), 3).angular_frequency
    exact = euler_bernoulli(beam, physical, 3).angular_frequency
    error = frequency_error(scaled, segments=12, mode=[1, 2, 3], rule="gregory")
    np.testing.assert_allclose(ours / exact - 1, error, atol=1e-12)


def test_segments_needed_with_a_body_is_where_the_error_falls_below() -> None:
    for rule in ("mitiguy", "gregory"):
        count = segments_needed("clamped-free(mass=1)", 0.01, 3, rule)
        error = np.asarray(
            frequency_error(
                "clamped-free(mass=1)", segments=[[count - 1], [count]], mode=[1, 2, 3], rule=rule
            )
        )
        assert np.abs(error[0]).max() > 0.01 >= np.abs(error[1]).max()
