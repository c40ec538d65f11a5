"""The lookup, the labelled table and the number of segments."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import xarray
from drawn_ends import EVERY_N, RULES_DRAWN
from hypothesis import given
from hypothesis import strategies as st
from turns import in_turns

import beammodes as bm
from beammodes.chains.rules import RULES
from beammodes.problem.ends import BOUNDARIES

PAIRS = [pair.name for pair in BOUNDARIES]


def test_lookup_scalar_and_broadcasting() -> None:
    # theory.md section 3: C/F, mitiguy, N = 6, mode 1.
    error = bm.frequency_error("clamped-free", segments=6, mode=1)
    assert isinstance(error, float)
    assert error == pytest.approx(-0.0035175, abs=5e-8)
    table = bm.frequency_error(["clamped-free", "free-clamped"], segments=[[6], [12], [24]], mode=1)
    assert isinstance(table, np.ndarray)
    assert table.shape == (3, 2)
    assert table[0, 0] == table[0, 1] == error
    mixed = bm.frequency_error("clamped-free", segments=6, mode=1, rule=["mitiguy", bm.RULES["naive"]])
    assert mixed[0] == error
    # theory.md section 4: naive is -1/N to first order.
    assert mixed[1] == pytest.approx(-1 / 6, abs=0.03)


def test_single_lookups_are_those_of_arrays_however_names_are_given() -> None:
    # A single lookup runs on Python floats, an array's on NumPy's; both by the same formulas.
    generator = np.random.default_rng(3)
    count = 400
    pairs = [BOUNDARIES[k] for k in generator.integers(len(BOUNDARIES), size=count)]
    rules = [RULES[name] for name in generator.choice(["mitiguy", "gregory", "half_stub"], size=count)]
    segments = np.rint(10 ** generator.uniform(0.5, 9.0, size=count)).astype(int)
    modes = np.where(generator.random(count) < 0.5, generator.integers(1, 13, size=count), segments // 7 + 1)
    together = bm.frequency_error(pairs, segments=segments, mode=modes, rule=rules)
    names, texts = [pair.name for pair in pairs], [rule.name for rule in rules]
    for boundaries, records in ((names, texts), (np.array(names), np.array(texts)), (tuple(names), rules)):
        other = bm.frequency_error(boundaries, segments=segments, mode=modes, rule=records)
        np.testing.assert_array_equal(other, together)
    singles = [
        bm.frequency_error(name, segments=int(n), mode=int(m), rule=rule)
        for name, n, m, rule in zip(names, segments, modes, texts, strict=True)
    ]
    np.testing.assert_allclose(singles, together, rtol=1e-12, atol=2e-16)
    assert np.isfinite(singles).sum() > 0.9 * count


@pytest.mark.parametrize(("boundary", "rule"), in_turns(PAIRS, EVERY_N, every=2))
def test_lookup_equals_the_eigen_solve(boundary: str, rule: str) -> None:
    for segments in (1, 2, 3, 7, 30):
        weights = RULES[rule].hinge_weights(bm.Boundary.of(boundary), segments)
        found = bm.frequency_error(boundary, segments=segments, mode=np.arange(1, segments + 2), rule=rule)
        if min(weights, default=1) <= 0:
            assert np.isnan(found).all()
            continue
        chain = bm.Chain(bm.Beam.unit(), boundary, segments, rule)
        omega = bm.solve_modes(bm.linearize(chain)).angular_frequency
        expected = np.full(segments + 1, np.nan)
        exact = np.asarray(bm.wavenumber(boundary, np.arange(1, segments + 2))) ** 2
        expected[: len(omega)] = omega / exact[: len(omega)] - 1
        np.testing.assert_allclose(found, expected, rtol=1e-11, atol=3e-14)


def test_dataset_round_trips_through_a_file(tmp_path: object) -> None:
    table = bm.error_dataset(
        boundary=["free-clamped", "clamped-clamped"],
        segments=range(1, 6),
        modes=3,
        rule=["mitiguy", "gregory"],
    )
    assert table.relative_error.dims == ("rule", "boundary", "segments", "mode")
    assert table.boundary.values.tolist() == ["clamped-free", "clamped-clamped"]
    assert table.segments.dtype == np.int64
    point = table.sel(rule="mitiguy", boundary="clamped-free", segments=4, mode=2)
    assert float(point.relative_error) == bm.frequency_error("clamped-free", segments=4, mode=2)
    assert float(point.angular_frequency / point.exact_angular_frequency - 1) == pytest.approx(
        float(point.relative_error), abs=1e-15
    )
    assert math.isnan(
        table.sel(rule="mitiguy", boundary="clamped-clamped", segments=1, mode=1).relative_error
    )
    for variable in table.data_vars.values():
        assert {"units", "long_name"} <= set(variable.attrs)
    assert bm.__version__ in table.attrs["source"]
    path = f"{tmp_path}/errors.nc"
    table.to_netcdf(path, engine="h5netcdf")
    with xarray.open_dataset(path, engine="h5netcdf") as read:
        xarray.testing.assert_identical(read.load(), table)
        assert read.segments.dtype == np.int64


def stays_within(boundary: str, rule: str, modes: int, tolerance: float, around: int) -> int:
    """The smallest N by scanning: every N up to twice the answer, and a coarse sample beyond."""
    scan = np.arange(1, min(2 * around + 50, 30_000))
    tail = np.unique(np.geomspace(scan[-1], 10**9, 300).astype(np.int64))
    every = np.concatenate([scan, tail[1:]])
    errors = bm.frequency_error(boundary, segments=every[:, None], mode=np.arange(1, modes + 1), rule=rule)
    bad = np.flatnonzero(~(np.abs(errors) <= tolerance).all(axis=1))
    return int(every[bad[-1] + 1]) if len(bad) else 1


@pytest.mark.parametrize(("boundary", "rule"), in_turns(PAIRS, EVERY_N, every=2))
def test_segments_needed_by_scanning(boundary: str, rule: str) -> None:
    for tolerance in (1e-2, 1e-3, 1e-4):
        answer = bm.segments_needed(boundary, tolerance, modes=3, rule=rule)
        if answer < 14_000:
            assert answer == stays_within(boundary, rule, 3, tolerance, answer)


@pytest.mark.parametrize(("boundary", "rule"), in_turns(PAIRS, EVERY_N, every=2))
def test_segments_needed_around_the_answer(boundary: str, rule: str) -> None:
    for exponent in (2, 5, 8):
        tolerance = 10.0**-exponent
        answer = bm.segments_needed(boundary, tolerance, modes=2, rule=rule)
        # Every N next to it, and some up to a hundred times as many.
        beyond = np.unique(np.geomspace(answer + 200, min(100 * answer + 200, 10**9), 100).astype(int))
        near = np.concatenate([[max(1, answer - 1)], np.arange(answer, answer + 200), beyond])
        errors = bm.frequency_error(boundary, segments=near[:, None], mode=[1, 2], rule=rule)
        within = (np.abs(errors) <= tolerance).all(axis=1)
        assert within[1:].all()
        assert answer == 1 or not within[0]


def test_segments_needed_as_published() -> None:
    # theory.md section 3: the requirement for one percent in three modes: 16 and 8, 26 and 12.
    for boundary, rule, expected in (
        ("clamped-free", "mitiguy", 16),
        ("clamped-free", "gregory", 8),
        ("clamped-clamped", "mitiguy", 26),
        ("clamped-clamped", "gregory", 12),
    ):
        assert bm.segments_needed(boundary, tolerance=0.01, modes=3, rule=rule) == expected


def test_an_error_that_changes_sign_is_not_mistaken_for_a_small_one() -> None:
    # gregory passes through zero near N = 113 and comes back: theory.md section 4.
    errors = np.abs(bm.frequency_error("clamped-free", segments=np.arange(60, 400), mode=1, rule="gregory"))
    low = int(errors.argmin())
    peak = float(errors[low:].max())
    tolerance = (errors[low] + peak) / 2
    answer = bm.segments_needed("clamped-free", tolerance, modes=1, rule="gregory")
    assert errors[low] <= tolerance < peak
    assert answer > 60 + low + 1


def test_more_than_possible_is_refused() -> None:
    with pytest.raises(ValueError, match="tolerance must be larger"):
        bm.segments_needed("clamped-free", tolerance=1e-12, modes=1, rule="naive")


def test_shapes_that_do_not_match_are_named_on_every_route() -> None:
    for ends, motion, rule in (
        ("clamped-free", "bending", "mitiguy"),
        ("clamped-free(mass=1)", "bending", "mitiguy"),
        ("clamped-free", "bending", bm.mode_tuned(1)),
        ("clamped-free", "bending", ["simpson", "naive", "mitiguy"]),
        ("fixed-free", "twist", "mitiguy"),
    ):
        with pytest.raises(ValueError, match=r"segments.*broadcast together, got shapes \(3,\), \(2,\)"):
            bm.frequency_error([ends] * 3, segments=[4, 5], mode=1, rule=rule, motion=motion)


BAD_COUNTS = [0, -3, 2.5, "six", 10**400, None, True, float("nan"), float("inf")]


@pytest.mark.parametrize("bad", BAD_COUNTS, ids=str)
@pytest.mark.parametrize("name", ["segments", "mode"])
def test_bad_counts_are_named(name: str, bad: object) -> None:
    arguments: dict[str, object] = {"segments": 6, "mode": 1, name: bad}
    with pytest.raises((TypeError, ValueError), match=name):
        bm.frequency_error("clamped-free", **arguments)  # type: ignore[arg-type]


@pytest.mark.parametrize("bad", [0, -1e-3, float("nan"), float("inf"), "1 %", None, True], ids=str)
def test_bad_tolerance_is_named(bad: object) -> None:
    with pytest.raises((TypeError, ValueError), match="tolerance"):
        bm.segments_needed("clamped-free", bad)  # type: ignore[arg-type]


def test_near_matches_are_offered() -> None:
    with pytest.raises(ValueError, match=r'did you mean "clamped-free"'):
        bm.frequency_error("clamped-freee", segments=6, mode=1)
    with pytest.raises(ValueError, match=r'did you mean "gregory"'):
        bm.error_dataset(boundary="clamped-free", segments=3, modes=1, rule="gregry")
    for empty in ([], ()):
        with pytest.raises(ValueError, match="at least one"):
            bm.error_dataset(boundary="clamped-free", segments=empty, modes=1)


@given(
    boundary=st.sampled_from(PAIRS),
    rule=st.sampled_from(RULES_DRAWN),
    segments=st.integers(1, 10**9),
    mode=st.integers(1, 10**9),
)
def test_every_lookup_gives_a_number_or_nan(boundary: str, rule: str, segments: int, mode: int) -> None:
    error = bm.frequency_error(boundary, segments=segments, mode=mode, rule=rule)
    assert math.isnan(error) or error > -1
    if segments < 2000 and min(RULES[rule].hinge_weights(bm.Boundary.of(boundary), segments), default=1) > 0:
        there = bm.Chain(bm.Beam.unit(), boundary, segments, rule).elastic_modes >= mode
        assert math.isnan(error) != there


def test_modes_are_in_order() -> None:
    for boundary, rule in itertools.product(PAIRS, EVERY_N):
        frequency = bm.chain_frequency(boundary, np.array([[40], [1000]]), np.arange(1, 38), rule)
        assert (np.diff(frequency, axis=1) > 0).all()


def test_a_tuple_of_pairs_is_several_boundaries() -> None:
    table = bm.error_dataset(boundary=BOUNDARIES, segments=5, modes=1)
    assert table.boundary.values.tolist() == PAIRS
    one = bm.error_dataset(boundary=("clamped", "free"), segments=5, modes=1)
    xarray.testing.assert_identical(one, table.sel(boundary=["clamped-free"]))


@pytest.mark.parametrize(
    "pair",
    [
        pytest.param("clamped-free", marks=pytest.mark.slow),
        "clamped-pinned",
        "clamped-free(mass=1, rotational_stiffness=2)",
    ],
)
def test_axially_corrected_springs_by_the_rules_closed_form(pair: str) -> None:
    """All springs s times a rule's: checked against the solved chain, and sought like any rule."""
    load, unit = bm.Load(axial_force=-1.2), bm.Beam.unit()
    for rule, n in itertools.product(("gregory", "half_stub", "naive"), (4, 12)):
        record = bm.axially_corrected(rule, load, unit)
        chain = bm.Chain(bm.Beam.unit(), pair, n, record)
        omega = bm.solve_modes(bm.linearize(chain, load=load), 3).angular_frequency
        exact = bm.euler_bernoulli(bm.Beam.unit(), pair, 3, load=load).angular_frequency
        found = bm.frequency_error(pair, segments=n, mode=[1, 2, 3], rule=record, load=load, beam=unit)
        np.testing.assert_allclose(found, omega / exact - 1, atol=3e-13)
    record = bm.axially_corrected("gregory", load, unit)
    corrected, plain = (
        bm.segments_needed(pair, 1e-4, 1, rule, load=load, beam=unit) for rule in (record, "gregory")
    )
    assert corrected <= plain
    for n, within in ((corrected - 1, False), (corrected, True)):
        error = bm.frequency_error(pair, segments=n, mode=1, rule=record, load=load, beam=unit)
        assert (abs(error) <= 1e-4) == within


class _OwnLayout:
    """The springs of `gregory2`, as a record of one's own."""

    name, rotary_inertia = "own", Fraction(1, 12)

    def piece_lengths(self, boundary: bm.Boundary, segments: int) -> list[Fraction]:
        return RULES["gregory2"].piece_lengths(boundary, segments)

    def hinge_weights(self, boundary: bm.Boundary, segments: int) -> list[Fraction]:
        return RULES["gregory2"].hinge_weights(boundary, segments)


@pytest.mark.parametrize(
    "load", [pytest.param(None, marks=pytest.mark.slow), bm.Load(axial_force=1.0)], ids=["free", "pulled"]
)
def test_segments_needed_by_a_layout_of_ones_own(load: bm.Load | None) -> None:
    own, rule = (
        bm.segments_needed("clamped-free", 0.05, 2, rule, load=load, beam=bm.Beam.unit())
        for rule in (_OwnLayout(), "gregory2")
    )
    assert own == rule


def test_segments_needed_with_matched_springs_says_why_not() -> None:
    with pytest.raises(ValueError, match=r"^rule must be one whose errors fall as N grows, got matched\(3\)"):
        bm.segments_needed("clamped-free", 0.01, 3, bm.matched(3))


# --- Remarks ----------------------------------------------------------------------------------------------


def _named(remarks: tuple[str, ...]) -> tuple[str, float] | None:
    """The rule that a remark names as better, and its error."""
    for remark in remarks:
        name, told, rest = remark.partition(", of lower order and with the same pieces, errs less here: ")
        if told:
            return name, float(rest.split()[0]) / 100
    return None


@pytest.mark.parametrize("rule", EVERY_N)
def test_a_rule_that_turns_worse_than_simpler_ones_says_so(rule: str) -> None:
    """Over all plain ends, short chains and longer ones: told exactly where it is so, and with what."""
    turned = 0
    for pair, n, mode in itertools.product(BOUNDARIES, (1, 2, 3, 5, 9, 14, 25, 29), (1, 2, 6)):
        own = bm.frequency_error(pair, segments=n, mode=mode, rule=rule)
        remarks = bm.error_remarks(pair, segments=n, mode=mode, rule=rule)
        if math.isnan(own):
            assert remarks == ("the chain has no such mode",)
            continue
        order = RULES[rule].declared_order(pair)
        lower = {
            name: bm.frequency_error(pair, segments=n, mode=mode, rule=name)
            for name, other in RULES.items()
            if other.declared_order(pair) < order
            and (other.stub, other.rotary_inertia) == (RULES[rule].stub, RULES[rule].rotary_inertia)
        }
        best = min((abs(e) for e in lower.values() if not math.isnan(e)), default=math.inf)
        assert any(r.startswith("coarse:") for r in remarks) == (abs(own) > 0.1)
        found = _named(remarks)
        if n > 4 * mode + 4:
            # None is looked up here: none of the rules that this was measured for is better.
            frozen = [abs(e) for name, e in lower.items() if name in RULES_DRAWN and not math.isnan(e)]
            assert found is None and (rule not in RULES_DRAWN or min(frozen, default=1.0) >= abs(own) / 1.02)
        else:
            assert (found is not None) == (best < abs(own) / 1.02)
        if found:
            turned += 1
            assert found[1] == pytest.approx(lower[found[0]], rel=1e-3)
            assert abs(found[1]) == pytest.approx(best, rel=1e-3)
        corrected = [len(RULES[rule].end_weights(end)) for end in (pair.left, pair.right)]
        hinges = len(RULES[rule].piece_lengths(pair, n)) - 1
        assert any("cut short" in r or "overlap" in r for r in remarks) == (sum(corrected) > hinges)
    assert turned or rule not in ("gregory", "gregory2", "half_stub_corrected", "rigid_stub_corrected")


def test_remarks_under_load() -> None:
    # A cantilever at half its buckling load, N = 20, mode 1: mitiguy -1.4e-5, gregory -2.6e-4.
    load = bm.Load(axial_force=-(math.pi**2) / 8)
    given: dict[str, Any] = {"segments": 20, "mode": 1, "load": load, "beam": bm.Beam.unit()}
    assert bm.frequency_error("clamped-free", rule="mitiguy", **given) == pytest.approx(-1.4e-5, rel=0.1)
    remarks = bm.error_remarks("clamped-free", rule="gregory", **given)
    assert _named(remarks) == ("mitiguy", pytest.approx(-1.4e-5, rel=0.1))
    corrected = bm.axially_corrected("gregory", load, bm.Beam.unit())
    error = 100 * bm.frequency_error("clamped-free", rule=corrected, **given)
    assert f"under load gregory has order 2, not 4; springs of axially_corrected: {error:+.4g} %" in remarks
    given |= {"load": bm.Load(spin_rate=3.0), "segments": 6}
    found = bm.error_remarks("clamped-free", rule="gregory", **given)
    assert found == ("under load gregory has order 2, not 4",)


def test_remarks_on_springs_that_are_not_positive() -> None:
    # mode_tuned(4): sigma beta = 11 at the wall of a cantilever's fourth mode, so N > 11/3.
    rule = bm.mode_tuned(4)
    (remark,) = bm.error_remarks("clamped-free", segments=3, mode=1, rule=rule)
    expected = f"{rule.name} has no positive springs for clamped-free with 3 segments; it has from N = 4 on"
    assert remark == expected
    assert not math.isnan(bm.frequency_error("clamped-free", segments=4, mode=1, rule=rule))


@pytest.mark.parametrize("on_segment", [False, True])
def test_remarks_on_a_body(on_segment: bool) -> None:
    ends = [bm.End(mass=1, rotary_inertia=1e-3, on_segment=flag) for flag in (on_segment, not on_segment)]
    own, other = (bm.Boundary.of(("clamped", end)) for end in ends)
    (remark,) = bm.error_remarks(own, segments=12, mode=1, rule="gregory")
    error = 100 * bm.frequency_error(other, segments=12, mode=1, rule="gregory")
    place = "on the last" if on_segment else "behind a hinge"
    assert remark.startswith(f"the body at the right end is {place}")
    assert remark.endswith(f": {error:+.4g} %")
    # Half a stub has one layout for both.
    assert bm.error_remarks(own, segments=12, mode=1, rule="half_stub") == ()


def test_many_modes_are_sought_in_bounded_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    # Every N up to 40 times the highest mode is looked at, in all modes: 144,000 errors here.
    import tracemalloc

    from beammodes.accuracy import segments

    def sought(block: int) -> tuple[int, int]:
        monkeypatch.setattr(segments, "_BLOCK", block)
        tracemalloc.start()
        needed = segments.segments_needed("clamped-free", 0.01, 60)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return needed, peak

    whole, all_at_once = sought(200_000)
    needed, peak = sought(6000)
    # What is held falls with the block, by up to 24 times; a part of it does not depend on the block.
    assert needed == whole and peak < all_at_once / 4
    # The definition, one N at a time.
    modes = np.arange(1, 61)
    worst = [
        np.abs(bm.frequency_error("clamped-free", segments=n, mode=modes)).max()
        for n in range(needed - 1, 400)
    ]
    assert worst[0] > 0.01 or np.isnan(worst[0])
    assert max(worst[1:]) <= 0.01
    with pytest.raises(
        ValueError, match="modes must be a whole number of at least 1 and at most 1000, got 1001"
    ):
        segments.segments_needed("clamped-free", 0.01, 1001)


@pytest.mark.parametrize("mode", [1, 5, 10**6])
@pytest.mark.parametrize("rule", ["mitiguy", "gregory", "half_stub_corrected"])
def test_remarks_of_the_longest_chains_lay_none_out(rule: str, mode: int) -> None:
    assert bm.error_remarks("clamped-free", segments=10**9, mode=mode, rule=rule) == ()
    assert bm.error_remarks("clamped-free", segments=10**9, mode=10**9 + 1, rule=rule) == (
        "the chain has no such mode",
    )
