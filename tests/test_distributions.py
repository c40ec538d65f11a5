"""Distributions of a study: the samples have them, and depend on seed, axis and number alone."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.stats

import beammodes as bm
from beammodes.numerics.distributions import draw

COUNT = 20_000
UNIT = bm.Uniform(0.0, 1.0)


@pytest.mark.parametrize(
    ("distribution", "law"),
    [
        (bm.Normal(3.0, 0.5), scipy.stats.truncnorm(-6.0, 6.0, 3.0, 0.5)),
        (bm.Normal(-1.0, 2.0, within=1.5), scipy.stats.truncnorm(-1.5, 1.5, -1.0, 2.0)),
        (bm.Uniform(-2.0, 5.0), scipy.stats.uniform(-2.0, 7.0)),
    ],
)
def test_samples_follow_their_law(distribution: bm.Normal | bm.Uniform, law: object) -> None:
    # The second route is SciPy's; 0.015 is where Kolmogorov's statistic of 20,000 samples is one of 4000.
    values = draw(distribution, 3, "height", 0, COUNT)
    assert scipy.stats.kstest(values, law.cdf).statistic < 0.015  # type: ignore[attr-defined]
    low, high = distribution.bounds
    assert low <= values.min() and values.max() <= high
    probability = np.linspace(1e-6, 1 - 1e-6, 101)
    found = distribution.quantile(probability)
    np.testing.assert_allclose(found, law.ppf(probability), rtol=1e-6, atol=1e-6)  # type: ignore[attr-defined]


def test_streams_are_independent_and_repeat() -> None:
    one, two, other = (draw(UNIT, s, n, 0, COUNT) for s, n in ((3, "a"), (3, "b"), (4, "a")))
    assert (one == draw(UNIT, 3, "a", 0, COUNT)).all()
    # Of independent samples the correlation has a standard deviation of 1/sqrt(COUNT) = 0.007.
    assert max(abs(np.corrcoef(pair)[0, 1]) for pair in ((one, two), (one, other))) < 0.035
    assert abs(np.corrcoef(one[:-1], one[1:])[0, 1]) < 0.035
    for start, stop in ((0, 1), (4, 5), (17, 400), (COUNT - 3, COUNT)):
        assert (draw(UNIT, 3, "a", start, stop) == one[start:stop]).all()
    assert len(np.unique(one)) == COUNT
    assert one.min() > 0.0 and one.max() < 1.0
    assert (draw(UNIT, 2**64 - 1, "a", 2**40, 2**40 + 2) > 0).all()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: bm.Normal(math.nan, 1.0), "mean must be finite"),
        (lambda: bm.Normal(0.0, 0.0), "standard_deviation must be greater than 0"),
        (lambda: bm.Normal(0.0, 1.0, within=-1.0), "within must be greater than 0"),
        (lambda: bm.Normal("a", 1.0), "mean must be a real number"),
        (lambda: bm.Uniform(1.0, 1.0), "high must be greater than low"),
        (lambda: bm.Uniform(0.0, math.inf), "high must be finite"),
    ],
)
def test_bad_distributions_are_refused(make: object, message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        make()  # type: ignore[operator]
