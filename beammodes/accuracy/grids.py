"""Grids of chains for labelled tables: one value or several of every rule, pair of ends and segment count."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.rules import Layout, layout_of
from beammodes.chains.units import ExactUnits
from beammodes.checks import bounded, choice, shown, whole_number
from beammodes.closed_form.uniform import MAX_SEGMENTS
from beammodes.problem.beam import Beam
from beammodes.problem.ends import NUMBERS_OF_END, Boundary, is_pair, with_pairs_read
from beammodes.problem.loading import Load, load_of

if TYPE_CHECKING:
    from beammodes.chains.chain import Chain
    from beammodes.problem.beam import Beam

__all__ = [
    "BEAM_NUMBERS",
    "MAX_VALUES",
    "NUMBERS",
    "ChainGrid",
    "EndNumbers",
    "in_beam_units",
    "last_failing",
    "listed",
    "load_in_beam_units",
    "looked_up",
    "segment_grid",
    "stands_alone",
    "with_numbers",
]


#: Values of one axis of a table: each is looked at by itself.
MAX_VALUES = 10**6


def stands_alone(value: Any, single: tuple[type, ...]) -> bool:
    """Whether `value` is one value and not several: no iterable, or an instance of `single`.

    Where `single` names tuples, for boundaries, a pair of ends is one value, as a tuple or as a list.

    Examples
    --------
    >>> from beammodes.problem.ends import BOUNDARIES
    >>> pairs = (("clamped", "free"), ["clamped", "free"], ("clamped-free", "free-free"), BOUNDARIES)
    >>> [stands_alone(pair, (str, tuple)) for pair in pairs]
    [True, True, False, False]
    """
    if tuple in single and isinstance(value, tuple | list):
        return is_pair(value)
    return isinstance(value, single) or not isinstance(value, Iterable)


def listed(name: str, value: Any, single: tuple[type, ...]) -> list[Any]:
    """Return `value` as a list; one that is an instance of `single` stands alone.

    Raises
    ------
    ValueError
        If it is empty, or has more than `MAX_VALUES`.

    Examples
    --------
    >>> listed("rule", "naive", (str,)), listed("segments", range(3), (str,))
    (['naive'], [0, 1, 2])
    """
    items = [value] if stands_alone(value, single) else bounded(name, value, most=MAX_VALUES)
    if not items:
        raise ValueError(f"{name} must name at least one value, got none")
    return items


class ChainGrid(NamedTuple):
    """Rules, pairs of ends and segment counts, the first three dimensions of a dataset, and their beam."""

    rules: list[Layout]
    boundaries: list[Boundary]
    segments: list[int]
    beam: Beam

    @classmethod
    def of(cls, boundary: Any, segments: Any, rule: Any, most: int, beam: Beam | None = None) -> ChainGrid:
        """Return the grid of one or an iterable of each; raises TypeError or ValueError naming it.

        Parameters
        ----------
        boundary, segments, rule : one of its kind, or an iterable of them
        most : int
            Largest number of segments allowed.
        beam : Beam, optional
            In whose units the numbers of ends are; by default they are multiples of ρA L, EI/L and so on.
        """
        from beammodes.problem.beam import Beam

        if beam is not None and not isinstance(beam, Beam):
            raise TypeError(f"beam must be a Beam or None, got {shown(beam)}")
        return cls(
            [layout_of(name) for name in listed("rule", rule, (str, Layout))],
            [Boundary.of(pair).canonical for pair in listed("boundary", boundary, (str, Boundary, tuple))],
            [whole_number("segments", n, most=most) for n in listed("segments", segments, (str,))],
            Beam.unit() if beam is None else beam,
        )

    @property
    def shape(self) -> tuple[int, int, int]:
        """How many of each."""
        return len(self.rules), len(self.boundaries), len(self.segments)

    def coordinates(self) -> dict[str, Any]:
        """Return the three coordinates as xarray takes them."""
        return {
            "rule": [record.name for record in self.rules],
            "boundary": [pair.name for pair in self.boundaries],
            "segments": ("segments", self.segments, {"long_name": "number of rigid segments", "units": "1"}),
        }

    def chains(self) -> Iterator[tuple[tuple[int, int, int], Chain]]:
        """Yield indices and chains of the beam, leaving out those whose springs are not positive."""
        from beammodes.chains.chain import Chain

        for i, j, k in np.ndindex(self.shape):
            try:
                chain = Chain(self.beam, self.boundaries[j], self.segments[k], self.rules[i])
            except ValueError:
                # No positive springs for this boundary and N.
                continue
            yield (i, j, k), chain


def segment_grid(modes: int) -> NDArray[np.int64]:
    """Return every N where errors are irregular, then N in steps of one percent up to the largest.

    Up to 40 times the highest mode and 400 an error may rise and fall. Above, it is a sum of a few powers
    of 1/N with at most one change of sign and one extremum, each wider than a step.

    Examples
    --------
    >>> segment_grid(1)[[0, 399, 400, -1]].tolist()
    [1, 400, 404, 1000000000]
    """
    dense = min(max(400, 40 * modes), MAX_SEGMENTS)
    steps = np.arange(1, 1 + int(np.log(MAX_SEGMENTS / dense) / np.log(1.01)))
    coarse = (dense * 1.01**steps).astype(np.int64)
    return np.unique(np.concatenate([np.arange(1, dense + 1), coarse, [MAX_SEGMENTS]]))


def last_failing(fails: Callable[[NDArray[np.int64]], NDArray[np.bool_]], low: int, high: int) -> int:
    """Return the last N of low..high that fails, given that `low` does and `high` does not.

    Examples
    --------
    >>> last_failing(lambda counts: counts < 700, 400, 1000)
    699
    """
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if fails(np.array([middle]))[0] else (low, middle)
    return low


# Numbers of ends and loads as dimensions of a table: "right_mass", "axial_force" and others.

# In multiples of a beam's own, and in the units of the beam.
_UNITS = {
    "translational_stiffness": ("EI / L^3", "N / m"),
    "rotational_stiffness": ("EI / L", "N m / rad"),
    "mass": ("rhoA L", "kg"),
    "rotary_inertia": ("rhoA L^3", "kg m^2"),
    "offset": ("L", "m"),
}


_ALL_UNITS = {
    **{f"{side}_{name}": _UNITS[name] for side in ("left", "right") for name in NUMBERS_OF_END},
    "axial_force": ("EI / L^2", "N"),
    "spin_rate": ("sqrt(EI / (rhoA L^4))", "rad / s"),
    "hub_radius": ("L", "m"),
}


#: What may be a dimension, and its unit in a table for L = EI = ρA = 1.
NUMBERS: Mapping[str, str] = MappingProxyType({name: own for name, (own, _) in _ALL_UNITS.items()})


#: The same in a table for a beam in any consistent units, here named as SI.
BEAM_NUMBERS: Mapping[str, str] = MappingProxyType({name: units for name, (_, units) in _ALL_UNITS.items()})


class EndNumbers:
    """Names and values that a table runs over, beside rules, boundaries, segments and modes.

    Examples
    --------
    >>> over = EndNumbers({"right_mass": [0.0, 0.5]})
    >>> [str(pair) for _, pair, _ in over.cases(Boundary.of("clamped-free"), Load())]
    ['clamped-free', 'clamped-free(mass=0.5)']
    """

    def __init__(self, over: Mapping[str, Iterable[float]] | None) -> None:
        if over is not None and not isinstance(over, Mapping):
            raise TypeError(f"over must map names to numbers, got {shown(over)}")
        self.values: dict[str, list[float]] = {
            choice("over", name, NUMBERS): listed(name, values, (str,))
            for name, values in (over or {}).items()
        }

    @property
    def shape(self) -> tuple[int, ...]:
        """How many of each."""
        return tuple(len(values) for values in self.values.values())

    def coordinates(self, beam: Beam | None = None) -> dict[str, tuple[str, list[float], dict[str, str]]]:
        """Return the coordinates as xarray takes them, in the units of the beam if there is one."""
        units = NUMBERS if beam is None else BEAM_NUMBERS
        return {
            name: (name, values, {"long_name": name.replace("_", " "), "units": units[name]})
            for name, values in self.values.items()
        }

    def cases(self, boundary: Boundary, load: Load) -> Iterator[tuple[tuple[int, ...], Boundary, Load]]:
        """Yield indices, and the boundary and the load with these numbers in the place of their own."""
        for index in np.ndindex(self.shape):
            chosen = {name: values[i] for (name, values), i in zip(self.values.items(), index, strict=True)}
            yield index, *with_numbers(boundary, load, chosen)


def with_numbers(boundary: Boundary, load: Load, numbers: Mapping[str, Any]) -> tuple[Boundary, Load]:
    """Return a boundary and a load with numbers, named as in `NUMBERS`, in the place of their own.

    Examples
    --------
    >>> print(*with_numbers(Boundary.of("clamped-free"), Load(), {"right_mass": 0.5})[:1])
    clamped-free(mass=0.5)
    """
    ends = {"left": boundary.left, "right": boundary.right}
    for name, value in numbers.items():
        side, _, field = name.partition("_")
        if side in ends:
            held = math.inf if value == math.inf else value
            number: dict[str, Any] = {field: held}
            ends[side] = replace(ends[side], **number)
        else:
            load = replace(load, **{name: value})
    return Boundary(**ends), load


def in_beam_units(boundary: Boundary, beam: Beam) -> Boundary:
    """Return ends whose numbers count for L = EI = ρA = 1 as these do for a uniform `beam`.

    Raises
    ------
    TypeError, ValueError
        If `beam` is not a uniform Beam without rotary inertia of its sections.

    Examples
    --------
    >>> print(in_beam_units(Boundary.of("clamped-free(mass=3)"), Beam(2.0, 1.0, 3.0)))
    clamped-free(mass=0.5)
    """
    units = ExactUnits.of(_plain_beam(beam), 1)
    ends = []
    for end in (boundary.left, boundary.right):
        mass, inertia, offset = units.body(end.mass, end.rotary_inertia, end.offset)
        numbers = {
            "translational_stiffness": units.support(end.translational_stiffness, 2),
            "rotational_stiffness": units.support(end.rotational_stiffness, 0),
            "mass": mass,
            "rotary_inertia": inertia,
            "offset": offset,
        }
        scaled: dict[str, Any] = {name: _float(name, value) for name, value in numbers.items()}
        ends.append(replace(end, **scaled))
    return Boundary(*ends)


def load_in_beam_units(load: Load, beam: Beam) -> Load:
    """Return a load whose numbers count for L = EI = ρA = 1 as these do for a uniform `beam`.

    Raises
    ------
    TypeError, ValueError
        If `beam` is not a uniform Beam without rotary inertia of its sections.

    Examples
    --------
    >>> load_in_beam_units(Load(axial_force=3.0), Beam(2.0, 1.0, 1.0)).axial_force
    12.0
    """
    units = ExactUnits.of(_plain_beam(beam), 1)
    return Load(
        axial_force=_float("axial_force", units.force(load.axial_force)),
        spin_rate=float(load.spin_rate) / beam.frequency_unit,
        hub_radius=float(load.hub_radius) / beam.length,
        plane=load.plane,
        gravity=_floats("gravity", map(units.acceleration, load.weight)),
        tip_force=_floats("tip_force", map(units.force, load.tip)),
        tip_moment=_float("tip_moment", units.moment(load.tip_moment)),
    )


def looked_up(boundary: Any, load: Load | None, beam: Beam | None) -> tuple[Any, Load]:
    """Return ends and load in multiples of ρA L, EI/L and so on, as closed forms take them.

    The one place that says what the numbers of a question without a chain mean: with a `beam` they are in its
    units; without one those of ends are such multiples already, and a load is refused.

    Parameters
    ----------
    boundary : boundary, or array or list of boundaries
    load : Load or None
    beam : Beam or None

    Raises
    ------
    TypeError, ValueError
        If there is a load without a beam, or an argument is not of its kind.

    Examples
    --------
    >>> print(*looked_up("clamped-free(mass=3)", Load(axial_force=3.0), Beam(2.0, 1.0, 3.0)))
    clamped-free(mass=0.5) Load(axial_force=12.0)
    """
    pull = load_of(load, beam)
    if beam is None:
        return boundary, pull
    return _in_units_of(_plain_beam(beam), boundary), load_in_beam_units(pull, beam)


def _in_units_of(beam: Beam, boundary: Any) -> Any:
    boundary = with_pairs_read(boundary)
    if isinstance(boundary, str | Boundary) or not isinstance(boundary, Iterable):
        return in_beam_units(Boundary.of(boundary), beam)
    listed = boundary if isinstance(boundary, np.ndarray) else bounded("boundary", boundary)
    items = np.asarray(listed, dtype=object)
    found: dict[Any, Boundary] = {}
    for item in items.ravel():
        if not isinstance(item, str | Boundary):
            raise TypeError(f"boundary must be names, pairs of ends or Boundaries, got {shown(item)}")
        if item not in found:
            found[item] = in_beam_units(Boundary.of(item), beam)
    scaled = np.empty(items.shape, dtype=object)
    scaled.ravel()[:] = [found[item] for item in items.ravel()]
    return scaled


def _plain_beam(beam: Beam) -> Beam:
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    if beam.is_uniform and not beam.has_rotary_inertia:
        return beam
    kind = "without rotary inertia of its sections" if beam.is_uniform else "uniform"
    raise ValueError(
        f"beam must be {kind} here, got {shown(beam)}: for any beam call chain_errors(Chain(beam, ...))"
    )


def _float(name: str, value: Fraction | float) -> float:
    """Return a number in multiples of the beam's own units, unless that leaves the range of floats."""
    try:
        number = float(value)
    except OverflowError:
        number = math.nan
    if math.isnan(number) or (value and not number):
        raise ValueError(f"{name} must suit the beam: in its own units it leaves the range of floats")
    return number


def _floats(name: str, values: Iterable[Fraction]) -> tuple[float, float]:
    along, across = (_float(name, value) for value in values)
    return along, across
