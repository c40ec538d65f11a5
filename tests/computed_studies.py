"""Datasets of studies, each computed once for all the tests of a process."""

from __future__ import annotations

from functools import cache

import xarray

from studies import every_study


@cache
def computed(name: str) -> xarray.Dataset:
    """Return a study's dataset; tests must not change it."""
    return every_study()[name].compute()
