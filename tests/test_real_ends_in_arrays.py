"""Lookups with springs and bodies over arrays: of records, of `Ends`, alone; and the search for segments."""

from __future__ import annotations

import math

import numpy as np
import pytest

import beammodes as bm


def random_end(random: np.random.Generator) -> bm.End:
    springs = [(0.0, math.inf, 10 ** random.uniform(-1, 4))[random.integers(3)] for _ in range(2)]
    body = (10 ** random.uniform(-2, 1), 10 ** random.uniform(-4, -1), random.uniform(-0.1, 0.1))
    return bm.End(*springs, *(number * random.integers(2) for number in body))


def test_ends_are_as_their_records_in_the_units_of_a_beam() -> None:
    random = np.random.default_rng(5)
    beam, load = bm.Beam(2.0, 30.0, 0.5), bm.Load(axial_force=2.0)
    records = [random_end(random) for _ in range(40)]
    # Arrays of ends know no hubs.
    names = bm.End.__dataclass_fields__.keys() - {"on_segment", "hub_radius", "in_si"}
    many = bm.Ends(**{name: [float(getattr(end, name)) for end in records] for name in names})
    segments, mode = random.integers(4, 60, 40), random.integers(1, 4, 40)
    pairs = [bm.Boundary(bm.ENDS["clamped"], end) for end in records]
    rules = np.array(list(bm.RULES))[random.integers(0, 5, 40)]
    asked = {"segments": segments, "mode": mode, "beam": beam, "load": load, "rule": rules}
    found = bm.frequency_error(("clamped", many), **asked)
    np.testing.assert_allclose(found, bm.frequency_error(pairs, **asked), rtol=0, atol=1e-14)
    alone = [
        bm.frequency_error(pair, segments=n, mode=m, rule=str(rule), beam=beam, load=load)
        for pair, n, m, rule in zip(pairs, segments.tolist(), mode.tolist(), rules, strict=True)
    ]
    np.testing.assert_allclose(found, alone, rtol=0, atol=1e-14)


def test_ends_broadcast_and_refuse_what_end_refuses() -> None:
    tips = bm.Ends(mass=[[0.5], [1.0]], offset=[0.0, 0.1, 0.2])
    assert tips.shape == (2, 3)
    found = np.asarray(bm.frequency_error((tips, "clamped"), segments=12, mode=2))
    assert found.shape == (2, 3)
    assert found[1, 2] == pytest.approx(
        bm.frequency_error(("clamped", bm.End(mass=1.0, offset=0.2)), segments=12, mode=2), rel=0, abs=1e-14
    )
    with pytest.raises(ValueError, match="mass must not be negative, got -1"):
        bm.Ends(mass=[1.0, -1.0])
    with pytest.raises(ValueError, match=r"broadcast together, got shapes \(2,\), \(3,\)"):
        bm.frequency_error((bm.Ends(mass=[1.0, 2.0]), bm.Ends(mass=[1.0, 2.0, 3.0])), segments=9, mode=1)


def against_brute_force(seed: int, cases: int, rules: list[str]) -> None:
    """Held against every N up to 400 alone; where errors rise and fall, most of them at few segments."""
    random = np.random.default_rng(seed)
    counts, not_monotone = np.arange(1, 401), 0
    for _ in range(cases):
        pair, rule = bm.Boundary(random_end(random), random_end(random)), rules[random.integers(len(rules))]
        modes, tolerance = int(random.integers(1, 4)), float(10 ** random.uniform(-3.2, -0.7))
        errors = np.abs(
            bm.frequency_error(pair, segments=counts[:, None], mode=np.arange(1, modes + 1), rule=rule)
        )
        fails = ~(errors <= tolerance).all(axis=1)
        not_monotone += int((np.diff(errors[modes + 5 :], axis=0) > 0).any())
        if fails[-5:].any():
            continue
        expected = int(counts[fails][-1]) + 1 if fails.any() else 1
        assert bm.segments_needed(pair, tolerance, modes, rule) == expected, (pair, rule, modes, tolerance)
    assert not_monotone > cases / 20


def test_segments_needed_against_every_n() -> None:
    against_brute_force(seed=1, cases=20, rules=["mitiguy", "gregory", "gregory2", "rigid_stub_corrected"])


@pytest.mark.slow
def test_segments_needed_against_every_n_by_every_rule() -> None:
    against_brute_force(2, 400, [name for name, rule in bm.RULES.items() if rule.has_equal_springs])
