"""The axes of a study: names, units, and reading and writing of their values."""

from __future__ import annotations

import hashlib
import inspect
import math
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, is_dataclass
from functools import cached_property, partial
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.accuracy.axial_errors import axial_with_numbers
from beammodes.accuracy.beam_units import NUMBERS, with_numbers
from beammodes.accuracy.error_table import listed, stands_alone
from beammodes.accuracy.lookups import lookup_of
from beammodes.accuracy.statics import LOADS
from beammodes.batch.given_structures import StructureOf, structure_of
from beammodes.chains.axial_chain import AnyAxialRule, AxialLayout
from beammodes.chains.rules import RULES, Layout, layout_of
from beammodes.checks import choice, kind_given, positive_real, real, shown, unwrapped, whole_number
from beammodes.closed_form.uniform_chains import MAX_MODE, MAX_SEGMENTS
from beammodes.numerics.distributions import Distribution, Normal, Uniform, draw
from beammodes.problem.axial_ends import AxialBoundary
from beammodes.problem.dimensions import unit_of
from beammodes.problem.ends import Boundary
from beammodes.problem.loading import PLANES, Load
from beammodes.problem.motions import MOTIONS
from beammodes.problem.sections import SECTIONS
from beammodes.problem.structure import Structure
from beammodes.vibration.integrators import INTEGRATORS

__all__ = [
    "AXES",
    "END_NUMBERS",
    "SIDED",
    "Axis",
    "AxisKind",
    "axis_values",
    "dimensions_of",
    "ends_in_motion",
    "kind_of",
    "number_units",
]

_ANY_ENDS = Boundary.of("free-free")

# Values of axes that go by their names.
_RECORDS = (Boundary, AxialBoundary, Layout, AxialLayout, StructureOf)


@dataclass(frozen=True)
class AxisKind:
    """A kind of axis: the reading of its values, their name and units.

    Attributes
    ----------
    read : callable
        Value as given to value as kept; raises TypeError or ValueError.
    long_name : str
    units, own_units : str
        Of a study whose beam has dimensions (in any consistent units, here named as SI), and for
        L = EI = ρA = 1.
    single : tuple of types
        Whose instances stand for one value, though they can be iterated over.
    """

    read: Callable[[Any], Any]
    long_name: str
    units: str = ""
    own_units: str = ""
    single: tuple[type, ...] = (str,)

    @property
    def is_number(self) -> bool:
        """True if values are real numbers, which may have a distribution."""
        return bool(self.units)


def dimensions_of(section: str, *, optional: bool = True) -> tuple[str, ...]:
    """Return the names of a section's dimensions, with or without those of which only one is given.

    Examples
    --------
    >>> dimensions_of("box")
    ('width', 'height', 'wall')
    >>> dimensions_of("tube", optional=False)
    ('outer',)
    """
    found = inspect.signature(SECTIONS[section]).parameters.values()
    return tuple(part.name for part in found if optional or part.default is part.empty)


#: Numbers of ends and loads that each motion takes, with their units without a beam and in SI.
END_NUMBERS: Mapping[str, Mapping[str, tuple[str, str]]] = MappingProxyType(
    {name: lookup_of(name).numbers() for name in MOTIONS}
)
_NUMBERS = {name: None for numbers in END_NUMBERS.values() for name in numbers}
#: Axes that tell the left end from the right.
SIDED = frozenset((*_NUMBERS, "plane"))


def number_units(name: str, own: bool, motions: Iterable[str]) -> str:
    """Return the units of a number of ends or loads in these motions, of its `own` without a beam.

    Examples
    --------
    >>> number_units("right_stiffness", False, ["twist", "stretch"])
    'N m/rad of twist, N/m of stretch'
    """
    found = {motion: END_NUMBERS[motion][name] for motion in motions if name in END_NUMBERS[motion]}
    units = {motion: both[0 if own else 1].replace("rho ", "rho") for motion, both in found.items()}
    alike = len(set(units.values())) == 1
    return ", ".join(
        dict.fromkeys(unit if alike else f"{unit} of {motion}" for motion, unit in units.items())
    )


def _end_number(name: str, value: Any) -> float:
    """Return a number of an end or a load, which its own class has checked."""
    value = unwrapped(name, value, _unit_of_number(name))
    try:
        if name in NUMBERS:
            with_numbers(_ANY_ENDS, Load(), {name: value})
        else:
            axial_with_numbers(AxialBoundary.of("free-free"), {name: value})
    except (TypeError, ValueError) as error:
        raise type(error)(f"{name}: {error}") from None
    return float(value)


def _unit_of_number(name: str) -> str | None:
    """Return the unit of a number of an end, None of a load, whose name says it."""
    side, _, field = name.partition("_")
    if side not in ("left", "right"):
        return None
    return {"stiffness": "N m or N/m", "inertia": "kg m2"}.get(field) or unit_of(field)


def _ends(value: Any) -> Boundary | AxialBoundary:
    """Return a pair of ends: of bending, unless its numbers are those of twist or stretch."""
    if isinstance(value, AxialBoundary):
        return value
    try:
        return Boundary.of(value)
    except ValueError:
        for motion in (name for name, each in MOTIONS.items() if each.along):
            try:
                return AxialBoundary.of(value, motion)
            except (TypeError, ValueError):
                continue
        raise


def ends_in_motion(pair: Boundary | AxialBoundary, motion: str) -> Any:
    """Return a pair of ends as a motion has it, also one that was read before the motion was known.

    Examples
    --------
    >>> print(ends_in_motion(Boundary.of("clamped-free(mass=2)"), "stretch"))
    fixed-free(mass=2.0)
    """
    if motion != "bending" and isinstance(pair, Boundary):
        return AxialBoundary.of(pair.name, motion)
    return lookup_of(motion).boundary(pair)


def _rule(value: AnyAxialRule) -> Layout | AxialLayout:
    return value if isinstance(value, AxialLayout) else layout_of(value)


def _word(name: str, words: Iterable[str]) -> AxisKind:
    return AxisKind(partial(choice, name, allowed=tuple(words)), name.replace("_", " "))


def _whole(name: str, long_name: str, most: int) -> AxisKind:
    return AxisKind(partial(whole_number, name, most=most), long_name)


_BEAM = {
    "length": "m",
    "bending_stiffness": "N m^2",
    "mass_per_length": "kg / m",
    "torsional_stiffness": "N m^2",
    "polar_inertia_per_length": "kg m",
    "axial_stiffness": "N",
    "elastic_modulus": "Pa",
    "density": "kg / m^3",
    **{name: "m" for section in SECTIONS for name in dimensions_of(section)},
}

#: Everything that may be an axis.
AXES: Mapping[str, AxisKind] = MappingProxyType(
    {
        "boundary": AxisKind(_ends, "ends of the beam", single=(str, tuple, Boundary, AxialBoundary)),
        "rule": AxisKind(_rule, "discretization rule", single=(str, Layout, AxialLayout)),
        "motion": _word("motion", MOTIONS),
        "segments": _whole("segments", "number of rigid segments", MAX_SEGMENTS),
        "mode": _whole("mode", "elastic mode", MAX_MODE),
        **{
            name: AxisKind(
                partial(_end_number, name),
                name.replace("_", " "),
                number_units(name, False, MOTIONS),
                number_units(name, True, MOTIONS),
            )
            for name in _NUMBERS
        },
        "plane": _word("plane", PLANES),
        "section": _word("section", SECTIONS),
        **{
            name: AxisKind(partial(positive_real, name), name.replace("_", " "), units, units)
            for name, units in _BEAM.items()
        },
        "static_load": _word("static_load", LOADS),
        "integrator": _word(
            "integrator", [name for name, each in INTEGRATORS.items() if not each.variable_step]
        ),
        "structure": AxisKind(structure_of, "structure", single=(str, Structure, StructureOf)),
    }
)


def kind_of(name: str, own: bool) -> AxisKind:
    """Return the kind of an axis: `own` of a number of the study's structures, which may have any name."""
    if own:
        unknown = "as the structure takes it"
        return AxisKind(partial(real, name), name.replace("_", " "), unknown, unknown)
    return AXES[choice("axis", name, AXES)]


@dataclass(frozen=True)
class Axis:
    """One axis of a study: its values, and the dimension along which they run.

    Attributes
    ----------
    name : str
        One of `AXES`.
    dimension : str or None
        None for a value that all points share.
    values : tuple
        As many as the dimension is long; of a distribution none.
    distribution : Normal, Uniform or None
    seed, count : int
        Of the samples.
    own : bool
        Whether it is a number of the study's structures.
    """

    name: str
    dimension: str | None
    values: tuple[Any, ...] = ()
    distribution: Distribution | None = None
    seed: int = 0
    count: int = 0
    own: bool = False

    @property
    def kind(self) -> AxisKind:
        """What its values are."""
        return kind_of(self.name, self.own)

    @property
    def size(self) -> int:
        """The number of values."""
        return self.count if self.distribution else len(self.values)

    def at(self, index: NDArray[np.intp]) -> NDArray[Any]:
        """Return the values at these places, an array of objects for ends and rules."""
        if self.distribution is None:
            return np.asarray(self._array[index if self.dimension else np.zeros_like(index)])
        first, last = int(index.min()), int(index.max()) + 1
        return draw(self.distribution, self.seed, self.name, first, last)[index - first]

    def labels(self) -> list[Any]:
        """Return the values as a dataset's coordinates have them."""
        if self.distribution:
            return [float(value) for value in self.at(np.arange(self.count))]
        return [value.name if isinstance(value, _RECORDS) else value for value in self.values]

    def definition(self) -> dict[str, Any]:
        """Return the definition of the axis in plain values for a file."""
        shared: dict[str, Any] = {"dimension": self.dimension} | ({"own": True} if self.own else {})
        if self.distribution:
            kind, numbers = type(self.distribution).__name__, vars(self.distribution)
            return shared | {"distribution": kind, **numbers, "seed": self.seed, "count": self.count}
        # Strict JSON knows no infinity.
        plain = ["inf" if value == math.inf else value for value in self.labels()]
        own = [_written(value) for value in self.values if isinstance(value, Layout | AxialLayout)]
        made = [dict(value.source) for value in self.values if isinstance(value, StructureOf)]
        records: dict[str, Any] = {"records": own or made} if any(own) or made else {}
        return shared | {"values": plain, **records}

    @classmethod
    def from_definition(cls, name: str, written: Mapping[str, Any]) -> Axis:
        """Return the axis that `definition` wrote, except that ends and rules are names in it."""
        own = bool(written.get("own"))
        if "distribution" in written:
            rest = {key: value for key, value in written.items() if key != "own"}
            dimension, seed, count = (rest.pop(key) for key in ("dimension", "seed", "count"))
            kind = {"Normal": Normal, "Uniform": Uniform}[rest.pop("distribution")]
            return cls(name, dimension, (), kind(**rest), seed, count, own)
        values = (float(value) if kind_of(name, own).is_number else value for value in written["values"])
        return cls(name, written["dimension"], tuple(values), own=own)

    @cached_property
    def _array(self) -> NDArray[Any]:
        if isinstance(self.values[0], _RECORDS):
            array = np.empty(len(self.values), dtype=object)
            array[:] = self.values
            return array
        return np.array(self.values)


def axis_values(name: str, value: Any, *, own: bool = False) -> tuple[tuple[Any, ...], bool]:
    """Return the checked values of an axis, `own` of a structure, and whether they were given as several.

    Examples
    --------
    >>> axis_values("segments", range(1, 4)), axis_values("plane", "lag")
    (((1, 2, 3), True), (('lag',), False))
    """
    kind = kind_of(name, own)
    if kind_given(value) is not None:
        value = unwrapped(name, value, _unit_of_number(name) if name in _NUMBERS else None)
    if isinstance(value, Normal | Uniform):
        raise TypeError(
            f"{name} must not be a distribution here: Study.sampled takes them, got {shown(value)}"
        )
    several = not stands_alone(value, kind.single)
    plain = value.tolist() if isinstance(value, np.ndarray | np.generic) else value
    return tuple(map(kind.read, listed(name, plain, kind.single))), several


def _in_full(value: object) -> str:
    """Return a record with all its numbers, where its line at a prompt leaves out what is usual.

    Examples
    --------
    >>> from beammodes.chains.rules import Weight
    >>> _in_full(Weight("1/3")), Weight("1/3")
    ('Weight(constant=Fraction(1, 3), per_segment=Fraction(0, 1))', Weight('1/3'))
    """
    if is_dataclass(value) and not isinstance(value, type):
        told = ", ".join(f"{f.name}={_in_full(getattr(value, f.name))}" for f in fields(value) if f.repr)
        return f"{type(value).__qualname__}({told})"
    if type(value) is tuple:
        return f"({', '.join(map(_in_full, value))}{',' * (len(value) == 1)})"
    return repr(value)


def _written(rule: Layout | AxialLayout) -> str:
    """Return a digest of a rule of the user's own, "" for a registered one."""
    if RULES.get(rule.name) == rule:
        return ""
    # Arrays with all their numbers and digits: by default long ones are cut short.
    with np.printoptions(threshold=sys.maxsize, floatmode="unique"):
        text = _in_full(rule)
    if " at 0x" in text:
        raise TypeError(f"rule must be a record that can be written down, got {shown(rule)}")
    return hashlib.sha256(text.encode()).hexdigest()
