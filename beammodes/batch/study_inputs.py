"""What a study is given, checked as a whole."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from beammodes.accuracy.end_numbers import NUMBERS
from beammodes.batch.cases import MATERIAL, UNIFORM_BEAM
from beammodes.batch.distributions import Normal, Uniform
from beammodes.batch.quantities import Quantity
from beammodes.batch.study_axes import AXES, SECTIONS, Axis, axis_values, dimensions_of
from beammodes.checks import choice, shown

__all__ = ["all_plain", "canonical", "check_complete", "grid_axes", "random_axis"]


def grid_axes(axes: Mapping[str, Any]) -> tuple[Axis, ...]:
    """Return axes of one value each, or of several along a dimension of the axis's own name.

    Examples
    --------
    >>> [axis.dimension for axis in grid_axes({"segments": [1, 2], "mode": 1})]
    ['segments', None]
    """
    found = []
    for name, value in axes.items():
        values, several = axis_values(name, value)
        found.append(Axis(name, name if several else None, values))
    return tuple(found)


def random_axis(name: str, distribution: Normal | Uniform, seed: int, count: int) -> Axis:
    """Return an axis of samples; raises as its values would, at the ends of the distribution."""
    if not AXES[choice("axis", name, AXES)].is_number:
        raise TypeError(f"{name} must be values, not a distribution, got {shown(distribution)}")
    for bound in distribution.bounds:
        AXES[name].read(bound)
    return Axis(name, "sample", (), distribution, seed, count)


def canonical(axes: tuple[Axis, ...]) -> tuple[Axis, ...]:
    """Return the axes with the firmer end first, where nothing else tells the left end from the right."""
    if any(axis.name in (*NUMBERS, "plane") for axis in axes):
        return axes
    return tuple(
        replace(axis, values=tuple(pair.canonical for pair in axis.values))
        if axis.name == "boundary"
        else axis
        for axis in axes
    )


def all_plain(named: Mapping[str, Axis]) -> bool:
    """Return whether no point has springs, bodies or loads."""
    return not set(named) & {*NUMBERS, "plane"} and all(pair.is_plain for pair in named["boundary"].values)


def check_complete(named: Mapping[str, Axis], quantities: tuple[Quantity, ...]) -> None:
    """Raise ValueError if an axis that another or a quantity needs is missing, or one is not counted."""
    for quantity in quantities:
        for name in quantity.uncounted:
            if name in named:
                raise ValueError(
                    f"axes must leave out {name} with {quantity.name}, which does not count it, "
                    f"got {', '.join(named)}"
                )
    needed = {"boundary", "segments"} | ({"mode"} if any(q.per_mode for q in quantities) else set())
    beam = {*UNIFORM_BEAM, *MATERIAL, *_all_dimensions()} & set(named)
    used, always = set(UNIFORM_BEAM), set(UNIFORM_BEAM) if beam else set()
    if "section" in named:
        sections = named["section"].values
        used = {*MATERIAL, *(size for kind in sections for size in dimensions_of(kind))}
        always = {*MATERIAL, *(size for kind in sections for size in dimensions_of(kind, optional=False))}
        for kind in sections:
            _check_one_of_two(kind, set(named))
    if beam - used:
        raise ValueError(
            f"axes must leave out {min(beam - used)} without a section that has it, got {', '.join(named)}"
        )
    missing = [name for name in AXES if name in (needed | always) - set(named)]
    if missing:
        raise ValueError(f"axes must include {missing[0]} here, got {', '.join(named)}")


def _check_one_of_two(section: str, given: set[str]) -> None:
    """Raise ValueError unless just one of a section's dimensions that stand for each other is given."""
    needed = dimensions_of(section, optional=False)
    either = [size for size in dimensions_of(section) if size not in needed]
    if either and len(given.intersection(either)) != 1:
        got = ", ".join(sorted(given.intersection(either))) or "none"
        raise ValueError(f"axes must include one of {' and '.join(either)} for a {section}, got {got}")


def _all_dimensions() -> set[str]:
    return {size for name in SECTIONS for size in dimensions_of(name)}
