"""Structures as an axis of a study: a structure, or a function of numbers, which are axes then, too."""

from __future__ import annotations

import inspect
import types
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from beammodes.batch.running_code import check_running_code, running_code
from beammodes.checks import choice, shown
from beammodes.problem.structure import Structure

__all__ = ["NOT_OF_STRUCTURES", "StructureOf", "own_numbers", "structure_of"]

#: Axes of a study of structures that are none of their numbers.
NOT_OF_STRUCTURES = ("structure", "rule", "segments", "mode", "integrator")


@dataclass(frozen=True)
class StructureOf:
    """A structure as a function of numbers.

    Attributes
    ----------
    name : str
        Of the function; or the names of a structure's members.
    made_by : function or Structure
    source : mapping from str to str
        As `running_code`, what tells one function of this name from another.
    """

    name: str
    made_by: Callable[..., Structure] | Structure
    source: Mapping[str, str] = field(default_factory=dict, hash=False)

    @property
    def numbers(self) -> dict[str, bool]:
        """The names of its numbers, and whether each must be given."""
        if isinstance(self.made_by, Structure):
            return {}
        given = inspect.signature(self.made_by).parameters.values()
        return {one.name: one.default is one.empty for one in given}

    def made(self, values: Mapping[str, Any]) -> Structure:
        """Return the structure of these numbers; others are left out."""
        if isinstance(self.made_by, Structure):
            return self.made_by
        found = self.made_by(**{name: float(values[name]) for name in self.numbers if name in values})
        if not isinstance(found, Structure):
            raise TypeError(f"{self.name} must return a Structure, got {shown(found)}")
        return found

    def check_code(self) -> None:
        """Raise ValueError if the function is not, in this process, the one that the study was made of."""
        if not isinstance(self.made_by, Structure):
            assert isinstance(self.made_by, types.FunctionType)
            check_running_code(self.made_by, self.source)


def structure_of(value: object) -> StructureOf:
    """Return a value of the axis "structure" as it is kept.

    Examples
    --------
    >>> import beammodes as bm
    >>> def shelf(overhang, load=0.0):
    ...     bar = bm.Beam(1.0 + overhang, 1.0, 1.0)
    ...     return bm.Structure.of_beam(bar, "pinned-free", [bm.Station(1.0, 1e9, mass=load)])
    >>> structure_of(shelf).numbers
    {'overhang': True, 'load': False}
    """
    if isinstance(value, StructureOf):
        return value
    if isinstance(value, Structure):
        return StructureOf(", ".join(member.name for member in value.members), value, _contents(value))
    name = getattr(value, "__name__", "")
    if not isinstance(value, types.FunctionType) or not name.isidentifier():
        raise TypeError(
            "structure must be a Structure, or a function of numbers that def makes (no lambda or method), "
            f"got {shown(value)}"
        )
    made = StructureOf(name, value, running_code(value))
    kinds = {one.kind for one in inspect.signature(value).parameters.values()}
    if kinds - {inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY}:
        raise TypeError(f"structure must be a function of numbers with names, got {shown(value)}")
    for number in made.numbers:
        if number in NOT_OF_STRUCTURES:
            raise ValueError(f"structure must have numbers of other names than {number}, got {shown(value)}")
    return made


def _contents(structure: Structure) -> dict[str, str]:
    joints, members = dict(structure.joints), structure.members

    def made() -> Structure:
        return Structure(joints, members)

    assert isinstance(made, types.FunctionType)
    return running_code(made)


def own_numbers(axes: Mapping[str, Any], read: Callable[[Any], Iterable[StructureOf]]) -> set[str]:
    """Return which of the axes are numbers of the structures among them, none where there are none."""
    if "structure" not in axes:
        return set()
    structures = list(read(axes["structure"]))
    names = [one.name for one in structures]
    twice = {name for name in names if names.count(name) > 1}
    if twice:
        raise ValueError(f"structure must have functions of different names, got {min(twice)} twice")
    given = set(axes) - set(NOT_OF_STRUCTURES)
    for one in structures:
        for name in sorted(given):
            choice(f"number of {one.name}", name, (*one.numbers, *NOT_OF_STRUCTURES))
        missing = [name for name, needed in one.numbers.items() if needed and name not in given]
        if missing:
            raise ValueError(f"axes must include {missing[0]}, a number of {one.name}, got {', '.join(axes)}")
    return given
