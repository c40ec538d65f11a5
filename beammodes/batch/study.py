"""Studies: many chains declared at once, computed in chunks, kept in a store and put together again.

The chunks do not depend on who computes them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Iterable, Mapping
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from beammodes.batch.cases import MATERIAL, MOVING_ALONG, UNIFORM_BEAM, Cases
from beammodes.batch.executors import computed, executor_of
from beammodes.batch.given_structures import own_numbers
from beammodes.batch.quantities import QUANTITIES, REASON, Quantity, quantities_of
from beammodes.batch.store import Evaluated, Store, definition_digest, locked, made_ready
from beammodes.batch.study_axes import (
    AXES,
    END_NUMBERS,
    SIDED,
    Axis,
    axis_values,
    dimensions_of,
    ends_in_motion,
    kind_of,
    number_units,
)
from beammodes.chains.rules import is_closed
from beammodes.checks import Shown, kind_given, shown, whole_number
from beammodes.deferred import Deferred
from beammodes.numerics.distributions import MAX_SEED, Normal, Uniform
from beammodes.problem.axial_ends import AxialBoundary
from beammodes.problem.dimensions import unit_attributes
from beammodes.problem.ends import check_multiples
from beammodes.problem.sections import SECTIONS
from beammodes.progress import Progress, ProgressLine, progress_of
from beammodes.version import __version__

if TYPE_CHECKING:
    import xarray
else:
    xarray = Deferred("xarray")

__all__ = ["Study", "open_study"]

#: Points of one chunk, and numbers: enough for closed forms to run at their speed, and for roots over arrays,
#: or few where each takes milliseconds.
_CLOSED_FORM_CHUNK, _ROOTS_CHUNK, _SOLVED_CHUNK = (5000, 25_000), (1000, 5000), (100, 500)

#: Axes of loads under which each chain is solved as a whole.
_LOADS_SOLVED = {"spin_rate", "hub_radius", "plane"}

#: More points are surely a mistake: at a microsecond each they would take a month.
_MAX_CASES = 10**12

#: Different messages that the attribute has; the variable has that of every case.
_MAX_REASONS = 3


@dataclass(frozen=True, repr=False)
class Study(Shown):
    """A set of chains and what to compute of them: as a grid, a list of points, or samples.

    `Study.grid`, `Study.points` and `Study.sampled` make one; `run` computes it. Axes are "boundary",
    "rule", "segments", "mode"; numbers of ends and loads as in `error_dataset`, such as "right_mass" (a tip
    mass), "left_rotational_stiffness", "axial_force", "spin_rate", "hub_radius", and "plane"; "integrator"
    and "static_load"; "motion", of "bending", "twist" and "stretch", with "right_stiffness", "right_inertia"
    (of twist) or "right_mass" (of stretch), and so on left; "section" with its dimensions,
    "elastic_modulus", "density" and "length", or "length", "bending_stiffness" and "mass_per_length", and
    "torsional_stiffness", "polar_inertia_per_length" and "axial_stiffness" for the other two motions. All
    numbers are in the units of the beam, which without the last two sets is the one with L = EI = ρA = 1.
    Or "structure": a `Structure`, or a function made by def that returns one, whose numbers are axes under
    their names in it, beside "rule", "segments" (in all), "mode" and "integrator". One
    value of an axis is shared by all points; several make a dimension. Ends are named with the firmer first,
    unless numbers of the left or right end, or loads, are axes.

    Attributes
    ----------
    axes : tuple of Axis
        In the order of their dimensions.
    quantities : tuple of Quantity
    chunk : int
        Points (not counting modes) that are computed and kept together.

    Examples
    --------
    >>> import beammodes as bm
    >>> study = bm.Study.grid(
    ...     boundary=["clamped-free", "pinned-pinned"], segments=range(1, 4), mode=[1, 2],
    ...     compute=["relative_error", "stable_time_step"],
    ... )
    >>> study
    <Study of relative_error, stable_time_step over boundary: 2, segments: 3, mode: 2, in chunks of 100>
    >>> table = study.run()
    >>> table.relative_error.sel(boundary="clamped-free", mode=1).values.round(5)
    array([-0.14676, -0.03366, -0.01443])

    A beam on two knife edges, one of which moves:

    >>> def shelf(edge):
    ...     return bm.Structure.of_beam(bm.Beam.unit(), "pinned-free", [bm.Station(edge, math.inf)])
    >>> moved = {"structure": shelf, "edge": [0.7, 0.8], "segments": 10, "rule": "gregory", "mode": 1}
    >>> table = bm.Study.grid(**moved, compute=["exact_angular_frequency", "relative_error"]).run()
    >>> table.exact_angular_frequency.values.round(3), table.relative_error.values.round(5)
    (array([15.096, 14.619]), array([-0.00051, -0.00048]))
    """

    axes: tuple[Axis, ...]
    quantities: tuple[Quantity, ...]
    chunk: int

    def _line(self) -> str:
        # An axis may have a million values.
        sizes = ", ".join(f"{name}: {size}" for name, size in self.shape.items())
        names = ", ".join(quantity.name for quantity in self.quantities)
        return f"<Study of {names} over {sizes or 'one point'}, in chunks of {self.chunk}>"

    @classmethod
    def grid(cls, *, compute: Any, chunk: int | None = None, **axes: Any) -> Study:
        """Return the study of every combination of the axes' values.

        Parameters
        ----------
        compute : str, function, or sequence of them
            Names of quantities: relative_error, angular_frequency, exact_angular_frequency,
            highest_angular_frequency, stable_time_step; buckling_load, exact_buckling_load, buckling_error,
            of beams at rest; tip_deflection_error, tip_rotation_error, midspan_deflection_error, without
            other loads. A function made by def gets a `Case` and returns one number; a ValueError,
            ArithmeticError, LookupError or RuntimeError counts as none. The code that runs belongs to the
            study's definition, with that of the user's functions that it calls and the globals that they
            read; what stands in no name, such as a file that it opens, does not.
        chunk : int, optional
            Points, not counting modes, computed and kept together: 5000 where the closed form of plain ends
            serves all, else 100, or fewer of many modes. It belongs to the study's definition.
        **axes : value, or iterable of values
            `segments`, `boundary` and, for most quantities, `mode` must be there.

        Raises
        ------
        TypeError, ValueError
            If an axis or quantity is unknown, or has a value that it cannot have, or one is missing.

        Examples
        --------
        >>> import beammodes as bm
        >>> bm.Study.grid(boundary="clamped-free", segment=[1, 2], compute="stable_time_step")
        ... # doctest: +ELLIPSIS
        Traceback (most recent call last):
        ...
        ValueError: axis must be one of boundary, rule, ..., got 'segment' (did you mean "segments"?)
        """
        return _made(_grid_axes(axes, _own_numbers(axes)), compute, chunk)

    @classmethod
    def points(
        cls, points: Mapping[str, Any], *, compute: Any, chunk: int | None = None, **axes: Any
    ) -> Study:
        """Return the study of listed points: axes of one length that run together along "point".

        Parameters
        ----------
        points : mapping from axis names to sequences of one length
        compute, chunk, **axes
            As for `grid`: these axes are combined with every point.

        Raises
        ------
        TypeError, ValueError
            As `grid`, or if the lengths differ.

        Examples
        --------
        >>> import beammodes as bm
        >>> pairs = {"boundary": ["clamped-free", "free-free"], "segments": [10, 20]}
        >>> bm.Study.points(pairs, mode=1, compute="relative_error").run().relative_error.values.round(6)
        array([-1.259e-03, -2.000e-06])
        """
        if not isinstance(points, Mapping) or not points:
            raise TypeError(f"points must map names of axes to sequences, got {shown(points)}")
        own = _own_numbers({**points, **axes})
        along = tuple(
            Axis(name, "point", axis_values(name, values, own=name in own)[0], own=name in own)
            for name, values in points.items()
        )
        lengths = {axis.name: axis.size for axis in along}
        if len(set(lengths.values())) > 1:
            raise ValueError(f"points must have axes of one length, got {shown(lengths)}")
        return _made(along + _grid_axes(axes, own), compute, chunk)

    @classmethod
    def sampled(cls, count: int, *, seed: int, compute: Any, chunk: int | None = None, **axes: Any) -> Study:
        """Return the study of random samples: axes with a distribution vary together along "sample".

        Parameters
        ----------
        count : int
            How many samples; those of a smaller count are the first of a larger.
        seed : int
            From 0 to 2⁶⁴ - 1.
        compute, chunk
            As for `grid`.
        **axes : `Normal`, `Uniform`, value, or iterable of values
            The last kind is combined with every sample.

        Raises
        ------
        TypeError, ValueError
            As `grid`, also if a distribution reaches values that its axis cannot have.

        Examples
        --------
        >>> import beammodes as bm
        >>> study = bm.Study.sampled(
        ...     1000, seed=1, boundary="clamped-free", segments=10, mode=1, section="rectangle",
        ...     width=0.02, height=bm.Normal(0.002, 2e-5), length=1.0, elastic_modulus=200e9, density=7800.0,
        ...     compute=["angular_frequency", "relative_error"],
        ... )
        >>> omega = study.run().angular_frequency
        >>> round(float(omega.std() / omega.mean()), 3), omega.units            # ω is proportional to height
        (0.01, 'rad / s')
        """
        size = whole_number("count", count, most=_MAX_CASES)
        key = whole_number("seed", seed, least=0, most=MAX_SEED)
        random = {name: value for name, value in axes.items() if isinstance(value, Normal | Uniform)}
        if not random:
            raise ValueError("sampled must have an axis with a distribution, Normal or Uniform, got none")
        own = _own_numbers(axes)
        along = tuple(_random_axis(name, value, key, size, name in own) for name, value in random.items())
        rest = {name: value for name, value in axes.items() if name not in random}
        return _made(along + _grid_axes(rest, own), compute, chunk)

    @property
    def shape(self) -> dict[str, int]:
        """The dimensions and their sizes, modes last."""
        sizes = {axis.dimension: axis.size for axis in self.axes if axis.dimension}
        modes = sizes.pop("mode", None)
        return sizes if modes is None else sizes | {"mode": modes}

    @property
    def size(self) -> int:
        """The number of cases, not counting modes."""
        return math.prod(size for name, size in self.shape.items() if name != "mode")

    @property
    def chunks(self) -> int:
        """The number of chunks."""
        return -(-self.size // self.chunk)

    @property
    def definition(self) -> dict[str, Any]:
        """The definition of the study in plain values, the package's version among them."""
        return {
            "beammodes": __version__,
            "axes": {axis.name: axis.definition() for axis in self.axes},
            "compute": {quantity.name: quantity.definition() for quantity in self.quantities},
            "chunk": self.chunk,
        }

    @property
    def digest(self) -> str:
        """A fingerprint of `definition`, in hexadecimal."""
        return definition_digest(self.definition)

    def cases(self, number: int) -> Cases:
        """Return the points of a chunk, the first being number 0."""
        start = whole_number("number", number, least=0, most=self.chunks - 1) * self.chunk
        flat = np.arange(start, min(start + self.chunk, self.size))
        sizes = {name: size for name, size in self.shape.items() if name != "mode"}
        index = dict(zip(sizes, np.unravel_index(flat, tuple(sizes.values())), strict=True)) if sizes else {}
        columns = {
            axis.name: axis.at(index.get(axis.dimension or "", np.zeros_like(flat)))
            for axis in self.axes
            if axis.dimension != "mode"
        }
        mode = columns.pop("mode", None)
        listed = [axis for axis in self.axes if axis.dimension == "mode"]
        grid = listed[0].at(np.arange(listed[0].size))[None, :] if listed else np.ones((1, 1), dtype=np.intp)
        return Cases(columns, grid if mode is None else mode[:, None])

    def run(
        self,
        store: str | Path | None = None,
        *,
        engine: Any = "serial",
        workers: int | None = None,
        progress: Progress | bool | None = None,
    ) -> xarray.Dataset:
        """Compute what is not in the store yet, and return everything.

        Parameters
        ----------
        store : str or Path, optional
            A folder: new, or that of this study, which then goes on where it was. "~" is the home folder.
            Each chunk is a netCDF file, moved into place whole, its digest in its name, the study's and its
            number inside; one that is damaged, or of another study or place, is set aside with a warning and
            computed again.
            Without a store the results are kept in memory alone.
        engine : "serial", "processes", a dask.distributed Client, or a concurrent.futures Executor
            All give the same bits, on processors and libraries of one kind. "processes" takes functions of a
            notebook or script as well as a module's; a module's must stand in its file as they run here.
        workers : int, optional
            Of "processes", by default one for each processor.
        progress : callable or bool, optional
            Called with (chunks done, all of them); by default, a line on a terminal or in a notebook and
            nothing elsewhere.

        Returns
        -------
        xarray.Dataset
            NaN where a chain has no such mode, or a case has no answer: a ValueError, ArithmeticError,
            LookupError or RuntimeError. If there are such cases, variable `reason` says of each what it was;
            attribute `failed_cases` counts them and `reasons` has the first few. All of it is held in memory,
            8 bytes for each number; of a study too large for that the chunks' files are the result.

        Raises
        ------
        TypeError, ValueError
            If an argument is not of its kind, or the store is of another study: the message says what
            differs.
        OSError
            If writing fails, such as on a full disk, or another run uses the store. What was finished stays.

        Examples
        --------
        >>> import tempfile
        >>> import beammodes as bm
        >>> study = bm.Study.grid(boundary="free-free", segments=[5, 6], mode=1, compute="relative_error")
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     first = study.run(store=folder)
        ...     study.run(store=folder).identical(first)                   # reads what is there
        True
        """
        report = progress_of(progress, "study", "chunks")
        if store is None:
            chunks: dict[int, Evaluated] = {}
            _compute(self, chunks, engine, workers, report, chunks.__setitem__)
            found = _study_dataset(self.definition, sorted(chunks.items()))
        else:
            found = _run_stored(self, _folder("store", store), engine, workers, report)
        if isinstance(report, ProgressLine) and found.failed_cases:
            report.say(f"{found.failed_cases} of {found.cases} cases have no answer: {found.reasons}")
        return found


def open_study(path: str | Path) -> xarray.Dataset:
    """Return the finished part of a stored study, also while it is being computed.

    Parameters
    ----------
    path : str or Path
        The folder that `Study.run` was given as its store.

    Returns
    -------
    xarray.Dataset
        As `Study.run` returns, with NaN for what is not there yet; attributes `finished_cases` of `cases`
        and `complete` say how much there is. All of it is read into memory; of a study too large for that,
        each chunk-*.nc is a netCDF file by itself, of consecutive points.

    Raises
    ------
    FileNotFoundError
        If no study is stored there.
    TypeError, ValueError
        If `path` is no path, or the definition there cannot be read or does not have its digest.

    Warns
    -----
    UserWarning
        If a chunk's file is damaged, or of another study or chunk: it is left out.

    Examples
    --------
    >>> import tempfile
    >>> import beammodes as bm
    >>> study = bm.Study.grid(boundary="clamped-free", segments=[5, 10], mode=1, compute="relative_error")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = study.run(store=folder)
    ...     found = bm.open_study(folder)
    >>> found.relative_error.values.round(6), found.finished_cases, found.cases
    (array([-0.005085, -0.001259]), 2, 2)
    """
    store = Store.read(_folder("path", path))
    return _study_dataset(store.definition, store.chunks())


def _made(axes: tuple[Axis, ...], compute: Any, chunk: int | None) -> Study:
    quantities = quantities_of(compute)
    names = [axis.name for axis in axes]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"each axis must be given once, got {name} twice")
    if "rule" not in names:
        axes += (Axis("rule", None, axis_values("rule", "mitiguy")[0]),)
    axes = _canonical(_ends_of_motions(axes))
    named = {axis.name: axis for axis in axes}
    _check_complete(named, quantities)
    size = (
        _default_chunk(named, quantities) if chunk is None else whole_number("chunk", chunk, most=_MAX_CASES)
    )
    study = Study(axes, quantities, size)
    if study.size > _MAX_CASES:
        raise ValueError(f"axes must make at most {_MAX_CASES:.0e} cases, got {study.size:.3g}")
    return study


def _default_chunk(named: Mapping[str, Axis], quantities: tuple[Quantity, ...]) -> int:
    points, numbers = _SOLVED_CHUNK
    if "structure" not in named and all(quantity.closed_form for quantity in quantities):
        if _all_plain(named):
            points, numbers = _CLOSED_FORM_CHUNK
        elif not set(named) & _LOADS_SOLVED and all(map(is_closed, named["rule"].values)):
            points, numbers = _ROOTS_CHUNK
    mode = named.get("mode")
    modes = mode.size if mode is not None and mode.dimension == "mode" else 1
    return max(1, min(points, numbers // modes))


def _own_numbers(axes: Mapping[str, Any]) -> set[str]:
    """Return which axes are numbers of the structures that another axis names.

    Numbers of ends and loads that came with units need a beam beside them.
    """
    if "length" not in axes and "structure" not in axes:
        if "boundary" in axes:
            check_multiples(axes["boundary"])
        if named := [name for name, value in axes.items() if name in SIDED and kind_given(value) is not None]:
            raise ValueError(
                f"{named[0]} must be a multiple of the beam's own numbers without a beam, got "
                f"{shown(axes[named[0]])}: give length, bending_stiffness and mass_per_length too"
            )
    return own_numbers(axes, lambda value: axis_values("structure", value)[0])


def _grid_axes(axes: Mapping[str, Any], own: Container[str]) -> tuple[Axis, ...]:
    """Return axes of one value each, or of several along a dimension of the axis's own name."""
    read = {name: axis_values(name, value, own=name in own) for name, value in axes.items()}
    return tuple(
        Axis(name, name if several else None, values, own=name in own)
        for name, (values, several) in read.items()
    )


def _random_axis(name: str, distribution: Normal | Uniform, seed: int, count: int, own: bool) -> Axis:
    """Return an axis of samples; raises as its values would, at the ends of the distribution."""
    kind = kind_of(name, own)
    if not kind.is_number:
        raise TypeError(f"{name} must be values, not a distribution, got {shown(distribution)}")
    for bound in distribution.bounds:
        kind.read(bound)
    return Axis(name, "sample", (), distribution, seed, count, own)


def _ends_of_motions(axes: tuple[Axis, ...]) -> tuple[Axis, ...]:
    """Return the axes with ends named as twist and stretch have them, where no point bends."""
    motions = sorted({motion for axis in axes if axis.name == "motion" for motion in axis.values})
    if not motions or "bending" in motions:
        return axes

    def read(pair: Any) -> Any:
        for motion in motions[:-1]:
            try:
                return ends_in_motion(pair, motion)
            except (TypeError, ValueError):
                continue
        return ends_in_motion(pair, motions[-1])

    return tuple(
        replace(axis, values=tuple(map(read, axis.values))) if axis.name == "boundary" else axis
        for axis in axes
    )


def _canonical(axes: tuple[Axis, ...]) -> tuple[Axis, ...]:
    """Return the axes with the firmer end first, where nothing else tells the left end from the right."""
    if any(axis.name in SIDED for axis in axes):
        return axes
    return tuple(
        replace(axis, values=tuple(pair.canonical for pair in axis.values))
        if axis.name == "boundary"
        else axis
        for axis in axes
    )


def _all_plain(named: Mapping[str, Axis]) -> bool:
    """Return whether no point has springs, bodies or loads."""
    if set(named) & SIDED:
        return False
    return all(isinstance(pair, AxialBoundary) or pair.is_plain for pair in named["boundary"].values)


def _check_complete(named: Mapping[str, Axis], quantities: tuple[Quantity, ...]) -> None:
    """Raise ValueError if an axis that another or a quantity needs is missing, or one is not counted."""
    for quantity in quantities:
        for name in quantity.uncounted:
            if name in named:
                raise ValueError(
                    f"axes must leave out {name} with {quantity.name}, which does not count it, "
                    f"got {', '.join(named)}"
                )
    if "structure" in named:
        missing = [name for name in ("segments", "mode") if name not in named]
        missing = [name for name in missing if name == "segments" or any(q.per_mode for q in quantities)]
        if missing:
            raise ValueError(f"axes must include {missing[0]} here, got {', '.join(named)}")
        return
    motions = named["motion"].values if "motion" in named else ("bending",)
    for name in sorted(set(named) & (SIDED - {"plane"})):
        if not any(name in END_NUMBERS[motion] for motion in motions):
            raise ValueError(
                f"axes must leave out {name} for motion {' and '.join(motions)}, got {', '.join(named)}"
            )
    needed = {"boundary", "segments"} | ({"mode"} if any(q.per_mode for q in quantities) else set())
    beam = {*UNIFORM_BEAM, *MOVING_ALONG, *MATERIAL, *_all_dimensions()} & set(named)
    used, always = {*UNIFORM_BEAM, *MOVING_ALONG}, set(UNIFORM_BEAM) if beam else set()
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


def _run_stored(
    study: Study, folder: Path, engine: Any, workers: int | None, report: Progress
) -> xarray.Dataset:
    made_ready(folder)
    with locked(folder) as alone:
        kept = Store.of(folder, study.definition)
        if alone:
            kept.clean()
        whole = {number for number, _ in kept.chunks(mend=True)}
        try:
            _compute(study, whole, engine, workers, report, kept.save)
        except BaseException as error:
            count = f"{len({number for number, _ in kept.finished()})} of {study.chunks} chunks"
            error.add_note(f"{count} are stored in {folder}; the same call goes on from there")
            if study.chunk > 1:
                error.add_note(
                    f"a chunk is {study.chunk} points: give a study of slow points a smaller chunk="
                )
            raise
        return _study_dataset(kept.definition, kept.chunks())


def _folder(name: str, path: object) -> Path:
    if not isinstance(path, str | Path):
        raise TypeError(f"{name} must be a folder's name or Path, got {shown(path)}")
    if path == "" or "\0" in str(path):
        raise ValueError(f"{name} must be a folder's name or Path, got {shown(path)}")
    return Path(path).expanduser()


def _compute(
    study: Study,
    done: Container[int],
    engine: Any,
    workers: int | None,
    report: Progress,
    save: Callable[[int, Evaluated], object],
) -> None:
    """Compute the chunks that are not among `done`, and save each as it comes."""
    missing = [number for number in range(study.chunks) if number not in done]
    count = study.chunks - len(missing)
    report(count, study.chunks)
    if not missing:
        return
    tasks = ((number, study.cases(number)) for number in missing)
    with (
        executor_of(engine, workers) as executor,
        closing(computed(tasks, study.quantities, executor)) as results,
    ):
        for number, chunk in results:
            save(number, chunk)
            count += 1
            report(count, study.chunks)


def _study_dataset(definition: Mapping[str, Any], chunks: Iterable[tuple[int, Evaluated]]) -> xarray.Dataset:
    """Return the finished chunks of a study as one table, NaN for what is not there."""
    import xarray

    axes = [Axis.from_definition(name, written) for name, written in definition["axes"].items()]
    sizes = {axis.dimension: axis.size for axis in axes if axis.dimension}
    modes = sizes.pop("mode", 0)
    total, step = math.prod(sizes.values()), definition["chunk"]
    arrays = {
        name: np.full((total, modes or 1) if kind["per_mode"] else (total,), np.nan)
        for name, kind in definition["compute"].items()
    }
    done, reasons = 0, {}
    for number, chunk in chunks:
        start = number * step
        for name, array in arrays.items():
            array[start : start + step] = chunk.values[name]
        done += min(step, total - start)
        reasons.update({start + place: reason for place, reason in chunk.reasons.items()})
    own = not any(axis.name in ("length", "structure") for axis in axes)
    motions = next((axis.values for axis in axes if axis.name == "motion"), ("bending",))
    variables = {}
    for name, array in arrays.items():
        spread = sizes | ({"mode": modes} if modes and array.ndim == 2 else {})
        variables[name] = (
            tuple(spread),
            array.reshape(tuple(spread.values())),
            _attributes(name, own, motions != ("bending",)),
        )
    if reasons:
        said = np.full(total, "", dtype=object)
        said[list(reasons)] = list(reasons.values())
        long_name = {"long_name": "why numbers are NaN"}
        variables[REASON] = (tuple(sizes), said.reshape(tuple(sizes.values())), long_name)
    return xarray.Dataset(
        variables,
        coords={axis.name: _coordinate(axis, own, motions) for axis in axes},
        attrs={
            "source": f"beammodes {definition['beammodes']}",
            "route": "study in chunks",
            "cases": total,
            "finished_cases": done,
            "complete": int(done == total),
            "failed_cases": len(reasons),
            "reasons": "; ".join(list(dict.fromkeys(reasons.values()))[:_MAX_REASONS]),
        },
    )


def _attributes(name: str, own: bool, moving: bool) -> dict[str, str]:
    if name not in QUANTITIES:
        return {"long_name": name.replace("_", " ")}
    quantity = QUANTITIES[name]
    units = quantity.units[own]
    if own and moving and units != "1":
        # Those of twist and stretch have √(k/(m L²)) in the place of √(EI/(ρA L⁴)).
        units += " of bending, with sqrt(GJ / (rhoIp L^2)) of twist, sqrt(EA / (rhoA L^2)) of stretch"
    return {"long_name": quantity.long_name, **unit_attributes(units)}


def _coordinate(axis: Axis, own: bool, motions: tuple[str, ...]) -> tuple[Any, ...]:
    kind, labels = axis.kind, axis.labels()
    attributes = {"long_name": kind.long_name}
    if kind.is_number and axis.name in SIDED and not axis.own:
        attributes |= unit_attributes(number_units(axis.name, own, motions))
    elif kind.is_number:
        attributes |= unit_attributes(kind.own_units if own else kind.units)
    elif not isinstance(labels[0], str):
        attributes["units"] = "1"
    return (axis.dimension, labels, attributes) if axis.dimension else ((), labels[0], attributes)
