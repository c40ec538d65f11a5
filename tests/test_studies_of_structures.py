"""Studies whose points are structures, functions of numbers that are axes: stored and resumed as others."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import beammodes as bm

BAR = bm.Beam.unit()


def portal(span: float, payload: float = 0.0) -> bm.Structure:
    """Two columns of length one and a beam between them, with a mass in its middle."""
    joints = {
        "a": bm.Joint(0, 0, "clamped"),
        "b": bm.Joint(0, 1),
        "c": bm.Joint(span, 1),
        "d": bm.Joint(span, 0, "pinned"),
    }
    top = bm.Member(bm.Beam(span, 1.0, 1.0), "b", "c", stations=[bm.Station(span / 2, mass=payload)])
    return bm.Structure(joints, [bm.Member(BAR, "a", "b"), top, bm.Member(BAR, "c", "d")])


def cracked(span: float, payload: float, crack: float = 3.0) -> bm.Structure:
    stations = [bm.Station(span / 3, hinge=crack), bm.Station(span / 2, mass=payload)]
    return bm.Structure.of_beam(bm.Beam(span, 1.0, 1.0), "clamped-pinned", stations)


def heaviest(case: bm.Case) -> float:
    """The mass of the heaviest station."""
    stations = [station for member in case.structure.members for station in member.stations]
    return max((station.mass for station in stations), default=0.0)


GRID: dict[str, Any] = {
    "structure": [portal, cracked],
    "span": [1.0, 1.5],
    "payload": 0.4,
    "segments": [6, 8],
    "rule": "gregory",
    "mode": [1, 2, 10],
    "compute": [
        "relative_error",
        "angular_frequency",
        "exact_angular_frequency",
        "stable_time_step",
        heaviest,
    ],
}


def test_every_point_is_its_chain_against_its_structure(tmp_path: Path) -> None:
    study = bm.Study.grid(**GRID, chunk=3)
    table = study.run(store=tmp_path / "store")
    assert table.relative_error.dims == ("structure", "span", "segments", "mode")
    assert table.structure.values.tolist() == ["portal", "cracked"]
    for made in (portal, cracked):
        for span in (1.0, 1.5):
            given = made(span, 0.4)
            exact = bm.structure_modes(given, 2).angular_frequency
            for segments in (6, 8):
                at = table.sel(structure=made.__name__, span=span, segments=segments)
                chain = bm.StructureChain(given, segments, "gregory")
                found = bm.structure_chain_modes(chain).angular_frequency
                np.testing.assert_allclose(at.relative_error[:2], found[:2] / exact - 1, atol=1e-12)
                np.testing.assert_allclose(at.angular_frequency[:2], found[:2], rtol=1e-12)
                np.testing.assert_allclose(at.exact_angular_frequency[:2], exact, rtol=1e-12)
                # No chain of so few segments has a tenth mode.
                assert np.isnan(at.relative_error[2])
                assert at.stable_time_step == bm.stable_time_step(chain) and at.heaviest == 0.4
    assert table.angular_frequency.units == "rad / s"
    assert table.span.units_in_words == "as the structure takes it"
    # What is stored is read, goes on where it was, and is not taken for another study.
    again = bm.Study.grid(**GRID, chunk=3)
    assert again.digest == study.digest and bm.open_study(tmp_path / "store").identical(table)
    (tmp_path / "store").glob("chunk-*.nc").__iter__().__next__().unlink()
    assert bm.open_study(tmp_path / "store").complete == 0
    assert again.run(store=tmp_path / "store").identical(table)
    other = bm.Study.grid(**{**GRID, "payload": 0.5}, chunk=3)
    with pytest.raises(ValueError, match="store must be of this study"):
        other.run(store=tmp_path / "store")


def test_samples_points_and_single_structures() -> None:
    sampled: dict[str, Any] = {
        "structure": portal,
        "segments": 9,
        "mode": 1,
        "compute": "exact_angular_frequency",
    }
    drawn = bm.Study.sampled(3, seed=1, **sampled, span=bm.Normal(1.0, 0.1)).run()
    spans = drawn.span.values
    assert len(set(spans)) == 3
    expected = [bm.structure_modes(portal(span), 1).angular_frequency[0] for span in spans]
    np.testing.assert_allclose(drawn.exact_angular_frequency, expected, rtol=1e-12)
    points = bm.Study.points({"span": spans.tolist()}, **sampled).run()
    np.testing.assert_array_equal(points.exact_angular_frequency, drawn.exact_angular_frequency)
    alone = bm.Study.grid(**{**sampled, "structure": portal(1.0), "rule": ["gregory", "half_stub"]})
    exact = bm.structure_modes(portal(1.0), 1).angular_frequency[0]
    np.testing.assert_allclose(alone.run().exact_angular_frequency, [exact] * 2, rtol=1e-12)
    # A structure is known by what it is; looking at it does not change that.
    seen, heavier = portal(1.0), portal(1.0, 0.1)
    assert seen.parts and len(heavier.members) == 3
    digests = [
        bm.Study.grid(**{**sampled, "structure": each, "rule": ["gregory", "half_stub"]}).digest
        for each in (seen, heavier)
    ]
    assert digests[0] == alone.digest != digests[1]


def test_buckling_loads_are_those_of_structures_of_one_member() -> None:
    compute = ["buckling_load", "exact_buckling_load", "buckling_error"]
    axes: dict[str, Any] = {"span": 2.0, "payload": 0.0, "segments": 8, "rule": "gregory", "compute": compute}
    found = bm.Study.grid(structure=cracked, **axes).run()
    given = cracked(2.0, 0.0)
    exact, ours = bm.buckling_load(given), bm.buckling_load(bm.StructureChain(given, 8, "gregory"))
    values = [found[name].item() for name in compute]
    np.testing.assert_allclose(values, [ours, exact, ours / exact - 1], rtol=1e-12)
    # Which members of a portal are compressed no load tells.
    with pytest.raises(TypeError, match="load must be given for a structure of several members"):
        bm.Study.grid(structure=portal, **axes).run()


def test_a_point_without_a_structure_has_no_answer() -> None:
    study = bm.Study.grid(structure=portal, span=[1.0, -1.0], segments=9, mode=1, compute="relative_error")
    found = study.run()
    assert np.isfinite(found.relative_error[0]) and np.isnan(found.relative_error[1])
    assert "length must be greater than 0" in str(found.reason[1].item())


@pytest.mark.slow
def test_workers_find_the_same_bits() -> None:
    study = bm.Study.grid(**GRID, chunk=2)
    assert study.run(engine="processes", workers=2).identical(study.run())


def no_structure(span: float) -> float:
    return span


def bad_name(mode: float) -> bm.Structure:
    return portal(mode)


@pytest.mark.parametrize(
    ("axes", "error", "message"),
    [
        ({"structure": "portal"}, TypeError, "structure must be a Structure, or a function of numbers"),
        ({"structure": lambda span: portal(span)}, TypeError, "no lambda or method"),
        ({"structure": bad_name}, ValueError, "numbers of other names than mode"),
        ({"structure": [portal, portal], "span": 1.0}, ValueError, "different names, got portal twice"),
        ({"structure": portal}, ValueError, "axes must include span, a number of portal"),
        ({"structure": portal, "spam": 1.0}, ValueError, 'number of portal must be one of span.*"span"'),
        ({"structure": portal, "span": 1.0, "boundary": "free-free"}, ValueError, "got 'boundary'"),
        ({"structure": portal, "span": "wide"}, TypeError, "span must be a real number"),
        (
            {"structure": portal, "span": 1.0, "compute": "tip_rotation_error"},
            ValueError,
            "leave out structure",
        ),
        (
            {"structure": no_structure, "span": 1.0},
            TypeError,
            "must return a Structure, got 1.0",
        ),
        ({"boundary": "free-free", "span": 1.0}, ValueError, "axis must be one of"),
    ],
)
def test_refusals(axes: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        bm.Study.grid(**{"segments": 9, "mode": 1, "compute": "relative_error", **axes}).run()
