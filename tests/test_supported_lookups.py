"""Chains with springs, bodies and axial force in floats, over arrays and alone, against long decimals.

`supported_chain`, in 50 digits and more, is itself held against matrices in 60, in tests of its own.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from drawn_ends import RULES_DRAWN

from beammodes.chains.rules import RULES
from beammodes.closed_form.supported_chain import supported_chain_frequencies, supported_chain_frequency
from beammodes.closed_form.supported_lookups import (
    ENOUGH,
    found_in_floats,
    one_supported_frequency,
    supported_frequencies,
)
from beammodes.closed_form.supported_tables import ChainColumns, end_weights
from beammodes.numerics.arrays import Floats
from beammodes.problem.end_columns import BoundaryColumns, EndColumns
from beammodes.problem.ends import ENDS, Boundary, End

# Relative error of ω that is allowed: half of an error's 1e-14, the other half being the beam's.
MOST = 5e-15


def drawn(seed: int, size: int) -> tuple[ChainColumns, Floats]:
    """Ends within three decades both ways of one, every rule, N to 10⁹, modes to 30 and some to 1000."""
    random = np.random.default_rng(seed)

    def chosen(share: float, values: Floats, other: float) -> Floats:
        return np.where(random.random(size) < share, values, other)

    def decades(most: float) -> Floats:
        return np.asarray(10 ** random.uniform(-most, most, size))

    def end() -> EndColumns:
        turning = chosen(0.25, np.full(size, np.inf), 0.0) + chosen(0.6, decades(3), 0.0)
        return EndColumns.moving(
            chosen(0.25, np.full(size, np.inf), 0.0) + chosen(0.6, decades(3), 0.0),
            turning,
            chosen(0.5, decades(3), 0.0),
            chosen(0.4, 0.01 * decades(3), 0.0),
            chosen(0.5, random.uniform(-0.3, 0.3, size), 0.0),
            (random.random(size) < 0.2) & ~np.isinf(turning),
        )

    ends = BoundaryColumns(end(), end())
    segments = np.floor(10 ** random.uniform(0.0, chosen(0.5, np.full(size, 9.0), 2.0)))
    few = np.where(random.random(size) < 0.7, 6.0, np.where(random.random(size) < 0.9, 31.0, 1001.0))
    mode = np.floor(random.uniform(1.0, few))
    tension = np.where(random.random(size) < 0.6, 0.0, decades(1.5))
    # A beam that turning springs hold at both ends, or one that nothing bends, bears this.
    tension = np.where(random.random(size) < 0.1, -1e-3, tension)
    section = chosen(0.2, np.full(size, 1e-3), 0.0)
    weights = end_weights(tuple(RULES[name] for name in RULES_DRAWN))
    chains = ChainColumns(
        ends, segments, random.integers(0, len(RULES_DRAWN), size), tension, section, weights
    )
    exist = (mode <= chains.modes - chains.rigid_modes) & chains.have_springs()
    left, right = ends.left, ends.right
    stiff = (left.translational_stiffness > 0.1) & (right.translational_stiffness > 0.1)
    at = np.flatnonzero(exist & (stiff | (tension >= 0)))
    return chains.take(at), mode[at]


def largest_error(seed: int, size: int) -> tuple[float, float, int]:
    """The largest error of ω, that of ω told with bounds of `ENOUGH`, and how many had to be in decimals."""
    chains, mode = drawn(seed, size)
    bare, doubt = found_in_floats(chains, mode)
    found = supported_frequencies(chains, mode, bare * (1 + np.minimum(1e-2, (mode / chains.segments) ** 2)))
    expected = np.array(
        [
            supported_chain_frequency(*chains.one(i), int(mode[i]), near=float(found[i]))
            for i in range(len(mode))
        ]
    )
    sure, known = doubt <= ENOUGH, ~np.isnan(expected)
    assert sum(known) > 0.6 * size
    np.testing.assert_array_equal(np.isnan(found), ~known)
    errors, told = np.abs(found / expected - 1)[known], np.abs(bare / expected - 1)[sure & known]
    return float(errors.max()), float(told.max()), int((~sure).sum())


def test_random_ends_against_50_digits() -> None:
    largest, told, hard = largest_error(seed=1, size=600)
    # 1.3e-15 was measured; in extended precision (long doubles) a few of a thousand are left to decimals.
    assert largest < MOST and told < ENOUGH
    assert hard < (10 if np.finfo(np.longdouble).eps < 1e-18 else 100)


def test_one_chain_is_as_one_of_many() -> None:
    chains, mode = drawn(seed=3, size=100)
    with np.errstate(all="ignore"):
        many = supported_frequencies(chains, mode)
        alone = [
            one_supported_frequency(pair, size, int(mode[i]), rule, force, section)
            for i, (pair, size, rule, force, section) in enumerate(map(chains.one, range(len(mode))))
        ]
    np.testing.assert_allclose(alone, many, rtol=2 * ENOUGH)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100, 120))
def test_20000_random_ends_against_50_digits(seed: int) -> None:
    # A thousand and more of each draw have the mode that is asked for.
    largest, told, _ = largest_error(seed, size=1400)
    assert largest < MOST and told < ENOUGH


def test_one_rod_whose_rotation_both_ends_hold_moves_across() -> None:
    pair = Boundary(End(3.0, math.inf, mass=0.5), ENDS["guided"])
    found = supported_chain_frequencies(pair, 1, 2, "rigid_stub")
    np.testing.assert_allclose(found, [math.sqrt(3.0 / 1.5), math.nan], rtol=1e-15)  # √(k/(ρA L + m))
    assert one_supported_frequency(pair, 1, 1, RULES["rigid_stub"]) == found[0]
