"""Frequency errors of many chains as one labelled table."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from beammodes.accuracy.end_numbers import EndNumbers, looked_up
from beammodes.accuracy.errors import MAX_MODES, errors_in_multiples
from beammodes.accuracy.grids import listed
from beammodes.accuracy.supported_errors import beam_frequencies
from beammodes.chains.rules import AnyRule, Layout, layout_of
from beammodes.checks import whole_number
from beammodes.closed_form.lookup import MAX_SEGMENTS
from beammodes.exact.exact_beam import wavenumber
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.loading import Load, checked_load

if TYPE_CHECKING:
    import xarray

__all__ = ["error_dataset", "exact_frequencies", "labelled_errors"]

Array = NDArray[np.float64]


def error_dataset(
    *,
    boundary: BoundaryLike | Iterable[BoundaryLike],
    segments: int | Iterable[int],
    modes: int,
    rule: AnyRule | Iterable[AnyRule] = "mitiguy",
    load: Load | None = None,
    over: Mapping[str, Iterable[float]] | None = None,
    beam: Beam | None = None,
) -> xarray.Dataset:
    """Return frequencies and errors of chains as one labelled table.

    Parameters
    ----------
    boundary : boundary, or iterable of boundaries
        Numbers of an `End` are in the units of `beam`; without one they are multiples of ρA L, ρA L³, L,
        EI/L³ and EI/L, and so are those of `over`.
    segments : int, or iterable of int
    modes : int
        How many, from the first.
    rule : rule, or iterable of rules
    load : Load, optional
        Loads along the beam or of a turning hub, in the units of `beam`, which must then be given.
    over : mapping from names to numbers, optional
        Further dimensions: numbers of the ends, such as "right_mass" or "left_rotational_stiffness", and
        "axial_force", "spin_rate" or "hub_radius". They replace those of every boundary, whose two ends
        then stay in the order given.
    beam : Beam, optional
        Uniform; sets the units of all numbers and frequencies. `Beam.unit()` makes them multiples.

    Returns
    -------
    xarray.Dataset
        Dimensions rule, boundary, those of `over`, segments, mode; variables angular_frequency,
        exact_angular_frequency (both in rad/s with a `beam`, else multiples of √(EI/(ρA L⁴))) and
        relative_error; NaN where a chain has no such mode.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or outside its range.

    Examples
    --------
    >>> table = error_dataset(boundary="clamped-free", segments=range(1, 4), modes=2)
    >>> table.relative_error.sel(mode=1).squeeze().values.round(5)
    array([-0.14676, -0.03366, -0.01443])
    >>> masses = {"right_mass": [0.0, 0.5, 1.0]}
    >>> dict(error_dataset(boundary="clamped-free", segments=8, modes=1, over=masses).sizes)
    {'rule': 1, 'boundary': 1, 'right_mass': 3, 'segments': 1, 'mode': 1}
    """
    pairs = [Boundary.of(pair) for pair in listed("boundary", boundary, (str, Boundary, tuple))]
    numbers, pull = EndNumbers(over), checked_load(load)
    looked_up("clamped-free", pull, beam)
    pairs = pairs if numbers.values else [pair.canonical for pair in pairs]
    records = [layout_of(name) for name in listed("rule", rule, (str, Layout))]
    counts = [whole_number("segments", n, most=MAX_SEGMENTS) for n in listed("segments", segments, (str,))]
    mode = np.arange(1, whole_number("modes", modes, most=MAX_MODES) + 1)
    exact = np.empty((len(pairs), *numbers.shape, len(mode)))
    error = np.empty((len(records), len(pairs), *numbers.shape, len(counts), len(mode)))
    for p, pair in enumerate(pairs):
        for index, given, given_force in numbers.cases(pair, pull):
            # Those of `over` are multiples without a beam, as numbers of ends are.
            ends, force = looked_up(given, given_force, beam) if beam is not None else (given, given_force)
            exact[(p, *index)] = exact_frequencies(ends, mode, force)
            for r, record in enumerate(records):
                error[(r, p, *index)] = errors_in_multiples(
                    ends, np.array(counts)[:, None], mode, record, force
                )
    exact *= 1.0 if beam is None else beam.frequency_unit
    return labelled_errors(
        [record.name for record in records],
        [pair.name for pair in pairs],
        counts,
        angular_frequency=exact[None, ..., None, :] * (1 + error),
        exact=exact,
        error=error,
        route="closed form",
        over=numbers,
        beam=None if beam == Beam.unit() else beam,
    )


def exact_frequencies(boundary: Boundary, mode: NDArray[np.intp], load: Load) -> Array:
    """Return the beam's angular frequencies of these modes, for L = EI = ρA = 1.

    Examples
    --------
    >>> exact_frequencies(Boundary.of("pinned-pinned"), np.array([2]), Load()) == (2 * np.pi) ** 2
    array([ True])
    """
    if boundary.is_plain and load == Load():
        return np.asarray(wavenumber(boundary, mode)) ** 2
    return beam_frequencies(boundary, int(mode.max()), load)[mode - 1]


def labelled_errors(
    rules: list[str],
    boundaries: list[str],
    segments: list[int],
    *,
    angular_frequency: Array,
    exact: Array,
    error: Array,
    route: str,
    over: EndNumbers | None = None,
    beam: Beam | None = None,
) -> xarray.Dataset:
    """Return frequencies and errors as the Dataset that `error_dataset` describes.

    Parameters
    ----------
    rules, boundaries, segments : list
        Coordinates of the first three dimensions; modes count from 1.
    angular_frequency, error : ndarray, shape (rules, boundaries, ..., segments, modes)
        Of the chains.
    exact : ndarray, shape (boundaries, ..., modes)
        Of the beam.
    route : str
        How the frequencies were computed; kept as an attribute.
    over : EndNumbers, optional
        What the dimensions in between are.
    beam : Beam, optional
        In whose units frequencies and numbers are; multiples of its own without one.
    """
    import xarray

    from beammodes import __version__

    between = over or EndNumbers(None)
    dims = ("rule", "boundary", *between.values, "segments", "mode")
    exact = np.broadcast_to(exact[None, ..., None, :], error.shape)
    frequency = {"units": "sqrt(EI / (rhoA L^4))" if beam is None else "rad / s"}
    return xarray.Dataset(
        {
            "angular_frequency": (
                dims,
                angular_frequency,
                {"long_name": "angular frequency of the chain", **frequency},
            ),
            "exact_angular_frequency": (
                dims,
                np.where(np.isnan(error), np.nan, exact),
                {"long_name": "angular frequency of the Euler-Bernoulli beam", **frequency},
            ),
            "relative_error": (
                dims,
                error,
                {"long_name": "relative frequency error of the chain", "units": "1"},
            ),
        },
        coords={
            "rule": rules,
            "boundary": boundaries,
            **between.coordinates(beam),
            "segments": ("segments", segments, {"long_name": "number of rigid segments", "units": "1"}),
            "mode": ("mode", np.arange(1, error.shape[-1] + 1), {"long_name": "elastic mode", "units": "1"}),
        },
        attrs={"source": f"beammodes {__version__}", "route": route},
    )
