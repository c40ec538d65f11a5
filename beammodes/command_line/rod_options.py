"""A rod in space as the options of the command line describe it: its numbers, shape at rest and ends."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from beammodes.checks import shown
from beammodes.command_line.text_tables import DECLARED, UNITS, declared
from beammodes.command_line.typed_calls import typed_call
from beammodes.files import ordinary_text
from beammodes.problem.rod import Rod
from beammodes.problem.rod_ends import RodEnds

__all__ = ["RodCase", "rod_of"]

#: Of a file of points, and of one of its lines.
_MOST_BYTES, _LONGEST_LINE = 1 << 20, 200

_NEEDED = {
    "bending_stiffness": "--ei",
    "torsional_stiffness": "--gj",
    "mass_per_length": "--rho-a",
}
_OPTIONAL = {"second_bending_stiffness": "--ei-across", "polar_inertia_per_length": "--rho-ip"}


def _straight(**properties: Any) -> Rod:
    return Rod(**properties)


def _curved(x: float = 0.0, y: float = 0.0, z: float = 0.0, **properties: Any) -> Rod:
    return Rod(curvature=(x, y, z), **properties)


#: Shapes at rest by their words; those that take a length need --length.
_SHAPES: Mapping[str, Callable[..., Rod]] = MappingProxyType(
    {
        "straight": _straight,
        "pretwisted": Rod.pretwisted,
        "arc": Rod.arc,
        "helix": Rod.helix,
        "hook": Rod.hook,
        "curved": _curved,
    }
)
_LONG = ("helix", "hook")


@dataclass(frozen=True)
class RodCase:
    """What the options describe: a rod with its ends, and the units of its numbers."""

    options: argparse.Namespace
    rod: Rod
    ends: RodEnds
    system: str
    units: Mapping[str, Any]

    @classmethod
    def of(cls, options: argparse.Namespace) -> RodCase:
        """Return the case; raises TypeError and ValueError where an option is missing or none of a rod."""
        for flag in ("ea", "axial_force"):
            if getattr(options, flag, None):
                raise ValueError(f"--{flag.replace('_', '-')} must be left out for motion space")
        system = "as given" if options.units is None else declared(options.units)
        # An audit takes the file's ends where none are given.
        ends = RodEnds.of("clamped-free" if options.boundary is None else options.boundary)
        return cls(options, rod_of(options), ends, system, UNITS[system])

    @property
    def chain(self) -> Any:
        """The chain of the options' segments and rule."""
        from beammodes.chains.spatial_chain import SpatialChain

        return SpatialChain(self.rod, self.ends, self.options.segments, self.options.rule)

    @property
    def holds_for(self) -> str:
        """What is assumed."""
        return "for small vibration of the rod about its shape at rest, which neither stretches nor shears"

    def assumed(self) -> list[str]:
        """Return what is assumed of numbers that were not given."""
        notes = []
        if self.options.ei_across is None:
            notes.append("assumed: EI across as --ei (--ei-across)")
        if self.options.rho_ip is None:
            notes.append("assumed: no inertia about the line, so no modes of twist alone (--rho-ip)")
        return notes

    def notes(self) -> list[str]:
        """Return what is assumed, of units too."""
        if self.options.units is not None:
            return self.assumed()
        return [*self.assumed(), f"in the units of your input; --units {', '.join(DECLARED)} names them"]

    def said(self, *names: str, **others: str) -> dict[str, Any]:
        """Return the units for scripts, and what is assumed."""
        told = {name: self.units[name] for name in names} | others
        return {"units": {"system": self.system} | told, "holds_for": self.holds_for}


def rod_of(options: argparse.Namespace) -> Rod:
    """Return the rod that options describe; no text of them is evaluated.

    Raises
    ------
    TypeError, ValueError, OSError
        If a number is missing or none, the shape is unknown, or the file of points cannot be read.
    """
    given = {name: _value(options, flag) for name, flag in {**_NEEDED, **_OPTIONAL}.items()}
    missing = [flag for name, flag in _NEEDED.items() if given[name] is None]
    if missing:
        raise ValueError(f"{' and '.join(missing)} must be given for motion space")
    properties = {name: value for name, value in given.items() if value is not None}
    if options.points is not None:
        for flag in ("shape", "length"):
            if getattr(options, flag) is not None:
                raise ValueError(f"--{flag} must be left out with --points, which has its own")
        return Rod.through(_points(options.points), **properties)
    typed = "straight" if options.shape is None else options.shape
    word, numbers = typed_call("--shape", typed, _SHAPES, without=("length",))
    if word in _LONG and options.length is not None:
        raise ValueError(f"--length must be left out for a {word}, which has its own, got {options.length}")
    if word not in _LONG:
        if options.length is None:
            raise ValueError(f"--length must be given for motion space and shape {word}")
        numbers["length"] = options.length
    return _SHAPES[word](**numbers, **properties)


def _value(options: argparse.Namespace, flag: str) -> Any:
    return getattr(options, flag[2:].replace("-", "_"), None)


def _points(path: str) -> list[list[float]]:
    """Return the points of a file: a line each of x, y and z, after a heading or none; # begins a remark."""
    place = Path(path)
    text = ordinary_text(place, _MOST_BYTES)
    rows: list[list[float]] = []
    for number, line in enumerate(text.splitlines(), start=1):
        words = [word for word in re.split(r"[,;\s]+", line[:_LONGEST_LINE].partition("#")[0]) if word]
        if not words:
            continue
        try:
            row = [float(word) for word in words]
        except ValueError:
            if not rows and number == 1:
                continue
            row = []
        if len(row) != 3:
            raise ValueError(f"{place}, line {number} must have three numbers x, y, z, got {shown(line)}")
        rows.append(row)
    return rows
