"""Combinations that take turns: some of them in the plain suite, all with the slow tests."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from typing import Any

import pytest


def in_turns(*axes: Iterable[Any], every: int) -> list[Any]:
    """Return all combinations of the axes' values for `parametrize`; all but each so-manieth are marked slow.

    The plain ones are those whose places along the axes add up to a multiple of `every`. With an axis of at
    least so many values beside them, every two values of two other axes meet.
    """
    chosen = []
    for combination in itertools.product(*(enumerate(axis) for axis in axes)):
        places, values = zip(*combination, strict=True)
        chosen.append(pytest.param(*values, marks=[pytest.mark.slow] if sum(places) % every else []))
    return chosen
