"""Frequencies of beams with springs and bodies over arrays of cases, against the long decimals one by one."""

from __future__ import annotations

import math
from decimal import Decimal, localcontext
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from beammodes.exact import supported_roots
from beammodes.exact.end_waves import ARRAYS, EndNumbers, read
from beammodes.exact.supported_root import ROOT_OF_SHAPE, cutoff, supported_root
from beammodes.exact.supported_roots import supported_frequencies
from beammodes.exact.uniform_beam import UnitBeam
from beammodes.numerics.long_decimals import LONG
from beammodes.problem.beam import Beam
from beammodes.problem.end_columns import BoundaryColumns, EndColumns
from beammodes.problem.ends import Boundary, End

NEAR_TWINS = End(3e8, 1e8, 2.0, 1e3, 0.2)

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def random_ends(chance: np.random.Generator, count: int, decades: float) -> EndColumns:
    def numbers(*special: float) -> Floats:
        drawn = 10.0 ** chance.uniform(-decades, decades, count)
        for value in special:
            drawn = np.where(chance.random(count) < 0.2, value, drawn)
        return drawn

    offset = np.where(chance.random(count) < 0.5, 0.0, chance.uniform(-0.5, 0.5, count))
    springs = numbers(0.0, math.inf), numbers(0.0, math.inf)
    return EndColumns.moving(*springs, numbers(0.0), numbers(0.0), offset, np.zeros(count, dtype=bool))


def random_cases(seed: int, count: int, decades: float = 3.0) -> tuple[BoundaryColumns, Floats, Ints]:
    """Ends of all kinds, every tenth pair alike; forces from -40, where all beams buckle, to 10⁴; modes."""
    chance = np.random.default_rng(seed)
    left, right = (random_ends(chance, count, decades) for _ in range(2))
    alike = chance.random(count) < 0.1
    columns = EndColumns.__dataclass_fields__
    right = EndColumns(*(np.where(alike, getattr(left, name), getattr(right, name)) for name in columns))
    pull, push = 10.0 ** chance.uniform(-3.0, 4.0, count), -(10.0 ** chance.uniform(-3.0, 1.6, count))
    tension = chance.choice(3, count, p=[0.4, 0.45, 0.15])
    mode = np.where(chance.random(count) < 0.5, chance.integers(1, 6, count), chance.integers(1, 31, count))
    mode = np.where(chance.random(count) < 0.1, chance.integers(1, 1001, count), mode)
    return BoundaryColumns(left, right), np.choose(tension, [np.zeros(count), pull, push]), mode


def boundary(ends: BoundaryColumns, i: int) -> Boundary:
    columns = [name for name in EndColumns.__dataclass_fields__ if name != "on_segment"]
    return Boundary(
        *(End(*(float(getattr(side, name)[i]) for name in columns)) for side in (ends.left, ends.right))
    )


def unit_beam(ends: BoundaryColumns, tension: Floats, i: int, gyration: float = 0.0) -> UnitBeam:
    return UnitBeam.of(Beam.unit(), boundary(ends, i), float(tension[i]), gyration)


def check(ends: BoundaryColumns, tension: Floats, mode: Ints, gyration: float = 0.0) -> None:
    """Source: the count of roots in long decimals, k - 1 and k at 3/4 of a unit in the last place around.

    A beam buckles if under its compression, without any motion, a root is below zero.
    """
    found = supported_frequencies(ends, tension, mode, gyration)
    for i, omega in enumerate(found.tolist()):
        pair = boundary(ends, i)
        with localcontext(LONG):
            beam = unit_beam(ends, tension, i, gyration)
            if math.isnan(omega):
                assert beam.static_sample(-beam.tension).below > 0
                continue
            assert beam.tension >= 0 or not beam.static_sample(-beam.tension).below
            rigid = int(beam.translation_is_free) if beam.tension else pair.rigid_body_modes
            middle, half = Decimal(omega), Decimal(math.ulp(omega)) * Decimal("0.75")
            counts = [beam.sample((middle + side * half) ** 2).below - rigid for side in (-1, 1)]
        assert counts[0] < mode[i] <= counts[1], (pair.name, float(tension[i]), int(mode[i]), omega, counts)


@pytest.mark.parametrize(("seed", "gyration"), [(0, 0.0), (1, 0.01)])
def test_random_cases_to_the_last_digit(seed: int, gyration: float) -> None:
    check(*random_cases(seed, 250), gyration)


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "count", "decades"), [(2, 20_000, 3.0), (3, 2_000, 9.0), (4, 500, 25.0)])
def test_many_random_cases_to_the_last_digit(seed: int, count: int, decades: float) -> None:
    check(*random_cases(seed, count, decades))


@pytest.mark.parametrize(
    ("end", "modes"),
    [
        (End(1e3, 0.0, 50.0, 1.0), 6),
        (NEAR_TWINS, 8),
        (End(mass=1e6), 4),
        (End(1e9, 1e9, 1e9, 1e9), 12),
        (End(1e-12, 0.0, 1e12), 3),
    ],
)
def test_near_double_and_nearly_zero_roots(end: End, modes: int) -> None:
    check(BoundaryColumns.of([Boundary(end, end)] * modes), np.zeros(modes), np.arange(1, modes + 1))


@pytest.mark.parametrize("distance", [1e-3, 1e-9])
def test_next_to_buckling(distance: float) -> None:
    """Source: the pinned beam buckles at π²."""
    ends = BoundaryColumns.of([Boundary.of("pinned-pinned")] * 2)
    tension = -(math.pi**2) * np.array([1.0 - distance, 1.0 + distance])
    found = supported_frequencies(ends, tension, np.array([1, 1]))
    assert np.isnan(found).tolist() == [False, True]
    check(ends, tension, np.array([1, 1]))


def test_few_cases_are_solved_one_by_one_with_the_same_result() -> None:
    ends, tension, mode = random_cases(8, 200)
    together = supported_frequencies(ends, tension, mode)
    for i in range(0, 200, 10):
        part = slice(i, i + 10)
        alone = supported_frequencies(ends.take(part), tension[part], mode[part])
        np.testing.assert_allclose(alone, together[part], rtol=2.3e-16)


def test_few_cases_need_long_decimals(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is not sure in doubles and their pairs: beams that buckle, and at most one other in a thousand."""
    asked: list[Decimal | None] = []
    slow = UnitBeam.root

    def counted(*case: Any) -> Decimal | None:
        asked.append(slow(*case))
        return asked[-1]

    monkeypatch.setattr(UnitBeam, "root", counted)
    supported_frequencies(*random_cases(5, 4000))
    assert sum(root is not None for root in asked) <= 4
    # Two of these are within a millionth of each other.
    asked.clear()
    twins = BoundaryColumns.of([Boundary(NEAR_TWINS, NEAR_TWINS)] * 8)
    supported_frequencies(twins, np.zeros(8), np.arange(1, 9))
    assert len(asked) == 2


def test_a_root_costs_a_dozen_readings_in_doubles_and_one_in_pairs(monkeypatch: pytest.MonkeyPatch) -> None:
    costs = {"read": 0, "residual": 0}

    def tallied(name: str, function: Any) -> Any:
        def same(*numbers: Any) -> Any:
            costs[name] += len(numbers[1].spring)
            return function(*numbers)

        return same

    for name in costs:
        monkeypatch.setattr(supported_roots, name, tallied(name, getattr(supported_roots, name)))
    ends, tension, mode = random_cases(11, 4000)
    supported_frequencies(ends, np.abs(tension), mode)
    assert 4000 < costs["read"] < 12 * 4000
    assert 4000 <= costs["residual"] < 1.05 * 4000


def test_counts_in_doubles() -> None:
    """Source: the count in long decimals, by the stiffness of the clamped beam and its inertia."""
    ends, tension, _ = random_cases(6, 500)
    omega = 10.0 ** np.random.default_rng(7).uniform(-3.0, 4.0, 500)
    sides = [
        EndNumbers.of(*(getattr(side, name) for name in list(EndColumns.__dataclass_fields__)[:5]))
        for side in (ends.left, ends.right)
    ]
    reading = read(ARRAYS, *sides, omega, tension, 0.0)
    for i in range(500):
        with localcontext(LONG):
            assert reading.below[i] == unit_beam(ends, tension, i).sample(Decimal(omega[i]) ** 2).below


def test_shear_below_the_cut_off() -> None:
    """Source: roots by counts in long decimals, of the stiffness of Timoshenko's clamped beam."""
    ends, _, _ = random_cases(9, 40)
    chance = np.random.default_rng(10)
    compared = 0
    for i in range(40):
        gyration, ratio = 10.0 ** chance.uniform(-5.0, -1.0), chance.uniform(0.5, 10.0)
        pair = boundary(ends, i)
        with localcontext(LONG):
            beam = UnitBeam.of(Beam.unit(), pair, 0.0, gyration, 1.0 / (ratio * gyration))
            rigid = pair.rigid_body_modes
            if beam.sample(Decimal(cutoff(beam)) ** 2).below < rigid + 3:
                continue
            for number, square in enumerate(beam.lowest(rigid, 3) or [], rigid + 1):
                root = supported_root(beam, number, ROOT_OF_SHAPE)
                assert root is not None
                assert abs(root * root / square - 1) < Decimal("1e-22")
                compared += 1
    assert compared > 90
