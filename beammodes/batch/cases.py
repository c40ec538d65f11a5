"""A block of a study's points as beams, ends, loads and chains, and results that several quantities share."""

from __future__ import annotations

import numbers
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from beammodes.accuracy.lookups import Lookup, lookup_of
from beammodes.batch.given_structures import StructureOf
from beammodes.batch.study_axes import END_NUMBERS, SIDED, dimensions_of, ends_in_motion
from beammodes.chains.axial_chain import AnyAxialRule, AxialChain
from beammodes.chains.chain import Chain
from beammodes.chains.rules import Rule
from beammodes.chains.structure_chain import StructureChain
from beammodes.checks import Shown, shown
from beammodes.exact.structure_judge import structure_modes
from beammodes.numerics.arrays import Floats, ratios_less_one
from beammodes.problem.axial_ends import AxialBoundary
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary
from beammodes.problem.loading import Load
from beammodes.problem.motions import unit_beam
from beammodes.problem.sections import SECTIONS
from beammodes.problem.structure import Structure
from beammodes.vibration.structure_vibration import structure_chain_modes

__all__ = ["MATERIAL", "MOVING_ALONG", "UNIFORM_BEAM", "Case", "Cases"]

#: What counts as the answer that a point has none. A TypeError, a NameError and their like are faults of a
#: function's text, not of a point, and stop the study.
NO_ANSWER = (ValueError, ArithmeticError, LookupError, RuntimeError)

#: Characters kept of each message.
_REASON = 300

#: What makes a beam without a section, and what a section needs to make one.
UNIFORM_BEAM = ("length", "bending_stiffness", "mass_per_length")
MATERIAL = ("elastic_modulus", "density", "length")

#: What a beam without a section may have besides, for twist and stretch.
MOVING_ALONG = ("torsional_stiffness", "polar_inertia_per_length", "axial_stiffness")


@dataclass(frozen=True, repr=False)
class Case(Shown):
    """One point of a study, as a user's own function sees it.

    Attributes
    ----------
    values : mapping
        The value of every axis but the modes, by name.

    Examples
    --------
    >>> from beammodes.chains.rules import RULES
    >>> held = {"boundary": Boundary.of("clamped-free"), "segments": 2, "rule": RULES["naive"]}
    >>> case = Case(held | {"right_mass": 0.5})
    >>> print(case.boundary, case.chain.joint_stiffness)
    clamped-free(mass=0.5) [2. 2.]
    """

    values: Mapping[str, Any]

    def __hash__(self) -> int:
        # The values may be of any kind; equal cases have the same axes.
        return hash(frozenset(self.values))

    def _line(self) -> str:
        return f"Case({self})"

    def __str__(self) -> str:
        named = {name: getattr(value, "name", value) for name, value in self.values.items()}
        return ", ".join(f"{name} {value}" for name, value in named.items())

    @property
    def segments(self) -> int:
        """N."""
        return int(self.values["segments"])

    @property
    def rule(self) -> AnyAxialRule:
        """The rule's record."""
        rule: AnyAxialRule = self.values["rule"]
        return rule

    @property
    def is_structure(self) -> bool:
        """Whether it is a structure, and not a beam between two ends."""
        return "structure" in self.values

    @cached_property
    def structure(self) -> Structure:
        """The structure of these numbers."""
        if not self.is_structure:
            raise TypeError("structure must be an axis of the study, got one of beams")
        made: StructureOf = self.values["structure"]
        return made.made(self.values)

    @property
    def motion(self) -> str:
        """The motion: bending, twist or stretch."""
        return str(self.values.get("motion", "bending"))

    @cached_property
    def beam(self) -> Beam:
        """The uniform beam: of the section and material, of the numbers given, or L = EI = ρA = 1."""
        given = self.values
        self._check_beam("beam")
        if "section" in given:
            kind = str(given["section"])
            sizes = {size: float(given[size]) for size in dimensions_of(kind) if size in given}
            modulus, density, length = (float(given[name]) for name in MATERIAL)
            section = SECTIONS[kind](**sizes)
            return Beam.from_section(section, density=density, elastic_modulus=modulus, length=length)
        if "length" in given:
            along: dict[str, Any] = {name: float(given[name]) for name in MOVING_ALONG if name in given}
            return Beam(*(float(given[name]) for name in UNIFORM_BEAM), **along)
        return Beam.unit() if self.motion == "bending" else unit_beam()

    def _check_beam(self, what: str) -> None:
        if self.is_structure:
            raise TypeError(
                f"{what} must be asked of a point with one beam, got a structure: see its members"
            )

    @cached_property
    def _held(self) -> tuple[Any, Load]:
        self._check_beam("boundary and load")
        numbers = {name: float(value) for name, value in self.values.items() if name in SIDED - {"plane"}}
        lookup = lookup_of(self.motion)
        for name in numbers:
            if name not in END_NUMBERS[self.motion]:
                raise ValueError(f"{name} must be left out for motion {self.motion}")
        load = Load()
        if self.motion == "bending":
            load = Load(plane=str(self.values.get("plane", load.plane)))
        return lookup.with_numbers(ends_in_motion(self.values["boundary"], self.motion), load, numbers)

    @property
    def boundary(self) -> Any:
        """The two ends, in the beam's units: a `Boundary`, or an `AxialBoundary` in twist and stretch."""
        return self._held[0]

    @property
    def load(self) -> Load:
        """The load, in the beam's units."""
        return self._held[1]

    @property
    def chain(self) -> Any:
        """The chain: a `Chain`, an `AxialChain` or a `StructureChain`.

        Raises ValueError where it has no positive springs.
        """
        if self.is_structure:
            return StructureChain(self.structure, self.segments, self.values["rule"])
        if self.motion != "bending":
            return AxialChain(self.beam, self.boundary, self.segments, self.rule, motion=self.motion)
        return Chain(self.beam, self.boundary, self.segments, self.values["rule"])


@dataclass(frozen=True, eq=False)
class Cases:
    """Points of a study, beside each other.

    Attributes
    ----------
    columns : mapping from axis names to arrays, shape (cases,)
    mode : ndarray of int, shape (1 or cases, modes)
    reasons : dict from int to str
        Why some cases' numbers are NaN: by the case's place, the message of the first error that it met.
    """

    columns: Mapping[str, NDArray[Any]]
    mode: NDArray[np.intp]
    reasons: dict[int, str] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.columns["segments"])

    def __iter__(self) -> Iterator[Case]:
        lists = [column.tolist() for column in self.columns.values()]
        for values in zip(*lists, strict=True):
            yield Case(dict(zip(self.columns, values, strict=True)))

    @property
    def shape(self) -> tuple[int, int]:
        """The numbers of cases and modes."""
        return len(self), self.mode.shape[1]

    def each(self, function: Callable[[Case], float]) -> Floats:
        """Return a number of every case, shape (cases,), NaN where one of `NO_ANSWER` is raised."""
        found = np.full(len(self), np.nan)
        for i, case in enumerate(self):
            with self._answering([i], case):
                answer = function(case)
                if isinstance(answer, bool) or not isinstance(answer, numbers.Real):
                    name = getattr(function, "__name__", "compute")
                    raise TypeError(f"{name} must return a real number, got {shown(answer)}")
                found[i] = answer
        return found

    @property
    def structures(self) -> list[StructureOf]:
        """The different structures, or functions that make them."""
        return list(dict.fromkeys(self.columns.get("structure", ())))

    @cached_property
    def frequency_unit(self) -> Floats:
        """√(EI / (ρA L⁴)), shape (cases, 1); 1 rad/s for structures."""
        if self.structures or not self._has_beams:
            return np.ones((len(self), 1))
        return self.each(lambda case: lookup_of(case.motion).frequency_unit(case.beam))[:, None]

    @cached_property
    def relative_error(self) -> Floats:
        """ω_chain / ω_beam - 1, shape (cases, modes)."""
        if self.structures:
            return self._of_structures[0]
        error = np.full(self.shape, np.nan)
        for load, pairs, rules, at in self._alike:
            error[at] = self._errors(at, pairs, rules, load)
        # Errors of plain ends need no beam, but of one that cannot exist there are none.
        return np.where(np.isnan(self.frequency_unit), np.nan, error)

    @cached_property
    def exact(self) -> Floats:
        """Exact angular frequencies for L = EI = ρA = 1, of structures in their units, as errors."""
        if self.structures:
            return self._of_structures[1]
        modes = np.broadcast_to(self.mode, self.shape)
        exact = np.full(self.shape, np.nan)
        for (pair, _, load), at in self._groups:
            wanted, place = np.unique(modes[at], return_inverse=True)
            with self._answering(at):
                exact[at] = _lookup(pair).exact(pair, wanted, load)[place].reshape(len(at), -1)
        return exact

    @cached_property
    def _of_structures(self) -> tuple[Floats, Floats]:
        """Errors and exact frequencies of structures; points with equal structures share these."""
        modes = np.broadcast_to(self.mode, self.shape)
        error, exact = np.full((2, *self.shape), np.nan)
        known: dict[Structure, Floats] = {}
        for i, case in enumerate(self):
            with self._answering([i], case):
                structure, count = case.structure, int(modes.max())
                if structure not in known:
                    known[structure] = structure_modes(structure, count).angular_frequency
                exact[i] = known[structure][modes[i] - 1]
                chain = structure_chain_modes(case.chain).angular_frequency
                error[i] = ratios_less_one(chain, known[structure], count)[modes[i] - 1]
        return error, exact

    @property
    def _alike(self) -> Iterator[tuple[Load, Any, Any, NDArray[np.intp]]]:
        """Yield a load, ends and rules, one for all or one each, and places: cases that one call answers."""
        found: dict[Any, list[tuple[Any, Any, NDArray[np.intp]]]] = {}
        for (pair, rule, load), at in self._groups:
            many = isinstance(pair, Boundary) and isinstance(rule, Rule)
            key = (load, pair.is_plain) if many else (load, pair, rule)
            found.setdefault(key, []).append((pair, rule, at))
        for (load, *_), members in found.items():
            pairs, rules, places = zip(*members, strict=True)
            if len(members) == 1:
                yield load, pairs[0], rules[0], places[0]
                continue
            sizes = [len(at) for at in places]
            columns = [np.empty(len(members), dtype=object) for _ in range(2)]
            columns[0][:], columns[1][:] = pairs, rules
            ends, each = (np.repeat(column, sizes)[:, None] for column in columns)
            yield load, ends, each, np.concatenate(places)

    def _errors(self, at: NDArray[np.intp], pair: Any, rule: Any, load: Load) -> Floats:
        """Return the errors of cases: one call of the closed form."""
        segments = self.columns["segments"][at, None]
        mode = self.mode if len(self.mode) == 1 else self.mode[at]
        error = np.full((len(at), self.mode.shape[1]), np.nan)
        try:
            error[:] = _lookup(pair).errors(pair, segments, mode, rule, load)
        except NO_ANSWER:
            if len(at) > 1:
                # One case without an answer must not take it from those beside it.
                parts = (slice(None, len(at) // 2), slice(len(at) // 2, None))
                each = isinstance(pair, np.ndarray)
                return np.concatenate(
                    [
                        self._errors(
                            at[part], pair[part] if each else pair, rule[part] if each else rule, load
                        )
                        for part in parts
                    ]
                )
            with self._answering(at):
                raise
        return error

    @contextmanager
    def _answering(self, places: Iterable[int], case: Case | None = None) -> Iterator[None]:
        """Turn an error that counts as no answer into a reason why these cases have none."""
        try:
            yield
        except NO_ANSWER as error:
            said = str(error) if type(error) is ValueError else f"{type(error).__name__}: {error}"
            kept = "".join(letter for letter in " ".join(said.split())[:_REASON] if letter.isprintable())
            for place in places:
                self.reasons.setdefault(int(place), kept)
        except Exception as error:
            error.add_note("met in a study" + ("" if case is None else f", at {case}"))
            raise

    @property
    def _has_beams(self) -> bool:
        return "length" in self.columns

    @cached_property
    def _groups(self) -> list[tuple[tuple[Any, Any, Load], NDArray[np.intp]]]:
        """Ends for L = EI = ρA = 1, rule and load likewise, and the places of the cases that share them."""
        pairs, rules = self.columns["boundary"], self.columns["rule"]
        numbered = any(name in self.columns for name in (*SIDED, "motion"))
        if numbered or (self._has_beams and not all(pair.is_plain for pair in pairs)):
            return self._groups_by_number()
        # Objects are told apart by identity: the hash of a rule costs more than its error.
        identity = np.array([list(map(id, column.tolist())) for column in (pairs, rules)])
        _, first, which = np.unique(identity, axis=1, return_index=True, return_inverse=True)
        return [
            ((pairs[at], rules[at], Load()), np.flatnonzero(which.ravel() == k)) for k, at in enumerate(first)
        ]

    def _groups_by_number(self) -> list[tuple[tuple[Any, Any, Load], NDArray[np.intp]]]:
        found: dict[tuple[Any, Any, Load], list[int]] = {}
        for i, case in enumerate(self):
            with self._answering([i], case):
                pair, load = case.boundary, case.load
                if self._has_beams:
                    pair, load = lookup_of(case.motion).in_multiples(pair, load, case.beam)
                found.setdefault((pair, case.rule, load), []).append(i)
        return [(key, np.array(places)) for key, places in found.items()]


def _lookup(pair: Any) -> Lookup:
    return lookup_of(pair.motion if isinstance(pair, AxialBoundary) else "bending")
