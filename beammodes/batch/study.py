"""Studies: which chains, what of them, and the chunks, which do not depend on who computes them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from beammodes.batch.cases import Cases
from beammodes.batch.distributions import Normal, Uniform
from beammodes.batch.quantities import Quantity, quantities_of
from beammodes.batch.store import definition_digest
from beammodes.batch.study_axes import Axis, axis_values
from beammodes.batch.study_inputs import all_plain, canonical, check_complete, grid_axes, random_axis
from beammodes.checks import shown, whole_number

if TYPE_CHECKING:
    import xarray

__all__ = ["Study"]

#: Points of one chunk, and numbers: enough for the closed form to run at its speed, or few where each takes
#: milliseconds.
CLOSED_FORM_CHUNK, SOLVED_CHUNK = (5000, 25_000), (100, 500)

#: More points are surely a mistake: at a microsecond each they would take a month.
MAX_CASES = 10**12


@dataclass(frozen=True)
class Study:
    """A set of chains and what to compute of them: as a grid, a list of points, or samples.

    `Study.grid`, `Study.points` and `Study.sampled` make one; `run` computes it. Axes are "boundary",
    "rule", "segments", "mode"; numbers of ends and loads as in `error_dataset`, such as "right_mass" (a tip
    mass), "left_rotational_stiffness", "axial_force", "spin_rate", "hub_radius", and "plane"; "integrator"
    and "static_load"; "section" with its dimensions, "elastic_modulus", "density" and "length", or "length",
    "bending_stiffness" and "mass_per_length". All numbers are in the units of the beam, which without the
    last two sets is the one with L = EI = ρA = 1. One value of an axis is shared by all points; several make
    a dimension. Ends are named with the firmer first, unless numbers of the left or right end, or loads, are
    axes.

    Attributes
    ----------
    axes : tuple of Axis
        In the order of their dimensions.
    quantities : tuple of Quantity
    chunk : int
        Points (not counting modes) that are computed and kept together.

    Examples
    --------
    >>> study = Study.grid(
    ...     boundary=["clamped-free", "pinned-pinned"], segments=range(1, 4), mode=[1, 2],
    ...     compute=["relative_error", "stable_time_step"],
    ... )
    >>> study
    <Study of relative_error, stable_time_step over boundary: 2, segments: 3, mode: 2, in chunks of 100>
    >>> table = study.run()
    >>> table.relative_error.sel(boundary="clamped-free", mode=1).values.round(5)
    array([-0.14676, -0.03366, -0.01443])
    """

    axes: tuple[Axis, ...]
    quantities: tuple[Quantity, ...]
    chunk: int

    def __repr__(self) -> str:
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
        >>> Study.grid(boundary="clamped-free", segment=[1, 2], compute="stable_time_step")
        ... # doctest: +ELLIPSIS
        Traceback (most recent call last):
        ...
        ValueError: axis must be one of boundary, rule, ..., got 'segment' (did you mean "segments"?)
        """
        return _made(grid_axes(axes), compute, chunk)

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
        >>> pairs = {"boundary": ["clamped-free", "free-free"], "segments": [10, 20]}
        >>> Study.points(pairs, mode=1, compute="relative_error").run().relative_error.values.round(6)
        array([-1.259e-03, -2.000e-06])
        """
        if not isinstance(points, Mapping) or not points:
            raise TypeError(f"points must map names of axes to sequences, got {shown(points)}")
        along = tuple(Axis(name, "point", axis_values(name, values)[0]) for name, values in points.items())
        lengths = {axis.name: axis.size for axis in along}
        if len(set(lengths.values())) > 1:
            raise ValueError(f"points must have axes of one length, got {shown(lengths)}")
        return _made(along + grid_axes(axes), compute, chunk)

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
        >>> study = Study.sampled(
        ...     1000, seed=1, boundary="clamped-free", segments=10, mode=1, section="rectangle",
        ...     width=0.02, height=Normal(0.002, 2e-5), length=1.0, elastic_modulus=200e9, density=7800.0,
        ...     compute=["angular_frequency", "relative_error"],
        ... )
        >>> omega = study.run().angular_frequency
        >>> round(float(omega.std() / omega.mean()), 3), omega.units            # ω is proportional to height
        (0.01, 'rad / s')
        """
        size, key = (
            whole_number("count", count, most=MAX_CASES),
            whole_number("seed", seed, least=0, most=2**64 - 1),
        )
        random = {name: value for name, value in axes.items() if isinstance(value, Normal | Uniform)}
        if not random:
            raise ValueError("sampled must have an axis with a distribution, Normal or Uniform, got none")
        along = tuple(random_axis(name, value, key, size) for name, value in random.items())
        rest = {name: value for name, value in axes.items() if name not in random}
        return _made(along + grid_axes(rest), compute, chunk)

    @property
    def shape(self) -> dict[str, int]:
        """The dimensions and their sizes, modes last."""
        sizes = {axis.dimension: axis.size for axis in self.axes if axis.dimension}
        return {name: size for name, size in sizes.items() if name != "mode"} | (
            {"mode": sizes["mode"]} if "mode" in sizes else {}
        )

    @property
    def size(self) -> int:
        """How many cases there are, not counting modes."""
        return math.prod(size for name, size in self.shape.items() if name != "mode")

    @property
    def chunks(self) -> int:
        """How many chunks there are."""
        return -(-self.size // self.chunk)

    @property
    def definition(self) -> dict[str, Any]:
        """What defines the study and its numbers, in plain values, the package's version among them."""
        from beammodes import __version__

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
        progress: Callable[[int, int], None] | bool | None = None,
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
            Called with (chunks done, all of them); by default, a line on a terminal and nothing elsewhere.

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
        >>> study = Study.grid(boundary="free-free", segments=[5, 6], mode=1, compute="relative_error")
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     first = study.run(store=folder)
        ...     study.run(store=folder).identical(first)                   # reads what is there
        True
        """
        from beammodes.batch.study_run import run_study

        return run_study(self, store, engine=engine, workers=workers, progress=progress)


def _made(axes: tuple[Axis, ...], compute: Any, chunk: int | None) -> Study:
    quantities = quantities_of(compute)
    names = [axis.name for axis in axes]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"each axis must be given once, got {name} twice")
    if "rule" not in names:
        axes += (Axis("rule", None, axis_values("rule", "mitiguy")[0]),)
    axes = canonical(axes)
    named = {axis.name: axis for axis in axes}
    check_complete(named, quantities)
    size = (
        _default_chunk(named, quantities) if chunk is None else whole_number("chunk", chunk, most=MAX_CASES)
    )
    study = Study(axes, quantities, size)
    if study.size > MAX_CASES:
        raise ValueError(f"axes must make at most {MAX_CASES:.0e} cases, got {study.size:.3g}")
    return study


def _default_chunk(named: Mapping[str, Axis], quantities: tuple[Quantity, ...]) -> int:
    cheap = all_plain(named) and all(quantity.closed_form for quantity in quantities)
    points, numbers = CLOSED_FORM_CHUNK if cheap else SOLVED_CHUNK
    mode = named.get("mode")
    modes = mode.size if mode is not None and mode.dimension == "mode" else 1
    return max(1, min(points, numbers // modes))
