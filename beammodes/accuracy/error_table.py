"""Labelled tables of chains: their axes, and the tables of frequency errors."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from beammodes.accuracy.errors import MAX_MODES, exact_frequencies
from beammodes.accuracy.lookups import Lookup, lookup_of
from beammodes.chains.axial_chain import AnyAxialRule
from beammodes.chains.chain import Chain
from beammodes.chains.rules import AnyRule, layout_of
from beammodes.checks import bounded, choice, shown, whole_number
from beammodes.closed_form.uniform_chains import MAX_SEGMENTS
from beammodes.deferred import Deferred
from beammodes.numerics.arrays import Floats
from beammodes.problem.axial_ends import AxialBoundaryLike, AxialEnd
from beammodes.problem.beam import Beam
from beammodes.problem.dimensions import unit_attributes
from beammodes.problem.ends import Boundary, BoundaryLike, End, check_multiples, is_pair
from beammodes.problem.loading import Load, checked_load
from beammodes.problem.motions import Motion
from beammodes.progress import Progress, progress_of
from beammodes.version import SOURCE
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

if TYPE_CHECKING:
    import xarray
else:
    xarray = Deferred("xarray")

__all__ = [
    "MAX_VALUES",
    "ROUTES_AGREE",
    "ChainGrid",
    "derived_error_dataset",
    "error_dataset",
    "labelled",
    "listed",
    "numbered",
    "stands_alone",
]

#: Values of one axis of a table: each is looked at by itself.
MAX_VALUES = 10**6

#: Relative disagreement of two routes that cannot be rounding.
ROUTES_AGREE = 1e-10

#: Segments of a chain that is derived in symbols; more would take hours.
MAX_DERIVED = 100


def stands_alone(value: Any, single: tuple[type, ...]) -> bool:
    """Return whether `value` is one value and not several: no iterable, or an instance of `single`.

    Where `single` names tuples, for boundaries, a pair of ends is one value, as a tuple or as a list.

    Examples
    --------
    >>> from beammodes.problem.ends import BOUNDARIES
    >>> pairs = (("clamped", "free"), ["clamped", "free"], ("clamped-free", "free-free"), BOUNDARIES)
    >>> [stands_alone(pair, (str, tuple)) for pair in pairs]
    [True, True, False, False]
    """
    if tuple in single and isinstance(value, tuple | list):
        return is_pair(value, (End, AxialEnd))
    return isinstance(value, single) or not isinstance(value, Iterable)


def listed(name: str, value: Any, single: tuple[type, ...]) -> list[Any]:
    """Return `value` as a list of at most `MAX_VALUES`; an instance of `single` stands alone.

    Examples
    --------
    >>> listed("rule", "naive", (str,)), listed("segments", range(3), (str,))
    (['naive'], [0, 1, 2])
    """
    items = [value] if stands_alone(value, single) else bounded(name, value, most=MAX_VALUES)
    if not items:
        raise ValueError(f"{name} must name at least one value, got none")
    return items


def numbered(segments: list[int], modes: int = 0) -> dict[str, Any]:
    """Return the coordinate of segment counts as xarray takes it, and that of the first modes.

    Examples
    --------
    >>> [(name, [*map(int, values)]) for name, (_, values, _) in numbered([4, 8], modes=2).items()]
    [('segments', [4, 8]), ('mode', [1, 2])]
    """
    mode = {"mode": ("mode", np.arange(1, modes + 1), {"long_name": "elastic mode", "units": "1"})}
    count = {"segments": ("segments", segments, {"long_name": "number of rigid segments", "units": "1"})}
    return count | (mode if modes else {})


class ChainGrid(NamedTuple):
    """Rules, pairs of ends and segment counts, the first dimensions of a table, and their beam."""

    rules: list[Any]
    boundaries: list[Any]
    segments: list[int]
    beam: Beam

    @classmethod
    def of(
        cls,
        boundary: Any,
        segments: Any,
        rule: Any,
        most: int,
        beam: Beam | None = None,
        how: Lookup | None = None,
    ) -> ChainGrid:
        """Return the grid of one or an iterable of each, of at most so many segments; of bending by default.

        Numbers of ends are in the units of `beam`; without one they are multiples of ρA L, EI/L and so on.
        """
        if beam is not None and not isinstance(beam, Beam):
            raise TypeError(f"beam must be a Beam or None, got {shown(beam)}")
        how = lookup_of("bending") if how is None else how
        if beam is None:
            check_multiples(boundary)
        return cls(
            [how.layout(name) for name in listed("rule", rule, how.single_rule)],
            [how.boundary(pair) for pair in listed("boundary", boundary, how.single_boundary)],
            [whole_number("segments", n, most=most) for n in listed("segments", segments, (str,))],
            Beam.unit() if beam is None else beam,
        )

    @property
    def canonical(self) -> ChainGrid:
        """The grid with the firmer end of each pair first."""
        return self._replace(boundaries=[pair.canonical for pair in self.boundaries])

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of each."""
        return len(self.rules), len(self.boundaries), len(self.segments)

    def coordinates(self, modes: int = 0) -> dict[str, Any]:
        """Return the coordinates as xarray takes them, and that of the first modes."""
        names = {
            "rule": [record.name for record in self.rules],
            "boundary": [pair.name for pair in self.boundaries],
        }
        return names | numbered(self.segments, modes)

    def chains(self) -> Iterator[tuple[tuple[int, int, int], Chain]]:
        """Yield indices and chains of the beam, leaving out those whose springs are not positive."""
        for i, j, k in np.ndindex(self.shape):
            try:
                chain = Chain(self.beam, self.boundaries[j], self.segments[k], self.rules[i])
            except ValueError:
                # No positive springs for this boundary and N.
                continue
            yield (i, j, k), chain


def labelled(
    dims: tuple[str, ...],
    variables: Mapping[str, tuple[Floats, str, str]],
    coordinates: Mapping[str, Any],
    route: str,
) -> xarray.Dataset:
    """Return variables, each with its values, long name and unit, as a Dataset that names its source."""
    import xarray

    return xarray.Dataset(
        {
            name: (dims, values, {"long_name": long_name, **unit_attributes(units)})
            for name, (values, long_name, units) in variables.items()
        },
        coords=coordinates,
        attrs={"source": SOURCE, "route": route},
    )


def error_dataset(
    *,
    boundary: AxialBoundaryLike | Iterable[AxialBoundaryLike],
    segments: int | Iterable[int],
    modes: int,
    rule: AnyAxialRule | Iterable[AnyAxialRule] = "mitiguy",
    load: Load | None = None,
    over: Mapping[str, Iterable[float]] | None = None,
    beam: Beam | None = None,
    motion: str | Motion = "bending",
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
    motion : str
        "bending", "twist" or "stretch"; see `frequency_error`. Names of `over` are then "right_stiffness"
        and "right_inertia", in stretch "right_mass", and those of the left end.

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
    >>> import beammodes as bm
    >>> table = bm.error_dataset(boundary="clamped-free", segments=range(1, 4), modes=2)
    >>> table.relative_error.sel(mode=1).squeeze().values.round(5)
    array([-0.14676, -0.03366, -0.01443])
    >>> masses = {"right_mass": [0.0, 0.5, 1.0]}
    >>> dict(bm.error_dataset(boundary="clamped-free", segments=8, modes=1, over=masses).sizes)
    {'rule': 1, 'boundary': 1, 'right_mass': 3, 'segments': 1, 'mode': 1}
    """
    how = lookup_of(motion)
    between, pull = _numbers_over(over, how), checked_load(load)
    how.in_multiples("clamped-free", pull, beam)
    grid = ChainGrid.of(boundary, segments, rule, MAX_SEGMENTS, beam, how)
    grid = grid if between else grid.canonical
    mode, counts = np.arange(1, whole_number("modes", modes, most=MAX_MODES) + 1), np.array(grid.segments)
    sizes = tuple(map(len, between.values()))
    exact = np.empty((len(grid.boundaries), *sizes, len(mode)))
    error = np.empty((len(grid.rules), len(grid.boundaries), *sizes, len(counts), len(mode)))
    alike: dict[tuple[Load, bool], list[tuple[Any, tuple[int, ...]]]] = {}
    for p, *index in np.ndindex(exact.shape[:-1]):
        chosen = {name: values[i] for (name, values), i in zip(between.items(), index, strict=True)}
        ends, force = how.with_numbers(grid.boundaries[p], pull, chosen)
        if beam is not None:
            ends, force = how.in_multiples(ends, force, beam)
        exact[p, *index] = how.exact(ends, mode, force)
        alike.setdefault((force, how.is_plain(ends)), []).append((ends, (p, *index)))
    for (force, _), members in alike.items():
        # One call answers all ends under one load.
        pairs = np.empty((len(members), 1, 1), dtype=object)
        pairs[:, 0, 0] = [ends for ends, _ in members]
        for r, record in enumerate(grid.rules):
            found = how.errors(pairs, counts[:, None], mode, record, force)
            for (_, place), each in zip(members, found, strict=True):
                error[(r, *place)] = each
    own = grid.beam == Beam.unit()
    exact *= 1.0 if own else how.frequency_unit(grid.beam)
    omega = exact[None, ..., None, :] * (1 + error)
    return _errors_labelled(grid, omega, exact, error, route="closed form", own=own, between=between, how=how)


def _numbers_over(over: Mapping[str, Iterable[float]] | None, how: Lookup) -> dict[str, list[float]]:
    if over is not None and not isinstance(over, Mapping):
        raise TypeError(f"over must map names to numbers, got {shown(over)}")
    return {
        choice("over", name, how.numbers()): listed(name, values, (str,))
        for name, values in (over or {}).items()
    }


def _errors_labelled(
    grid: ChainGrid,
    omega: Floats,
    exact: Floats,
    error: Floats,
    *,
    route: str,
    own: bool = True,
    between: Mapping[str, list[float]] = MappingProxyType({}),
    how: Lookup | None = None,
) -> xarray.Dataset:
    """Return the Dataset that `error_dataset` describes.

    Shapes are (rules, boundaries, ..., segments, modes) of the chains, (boundaries, ..., modes) of the beam.
    """
    how = lookup_of("bending") if how is None else how
    unit = how.unit if own else "rad / s"
    exact = np.broadcast_to(exact[None, ..., None, :], error.shape)
    numbers = how.numbers()
    over = {
        name: (name, values, {"long_name": name.replace("_", " ")} | unit_attributes(numbers[name][not own]))
        for name, values in between.items()
    }
    return labelled(
        ("rule", "boundary", *between, "segments", "mode"),
        {
            "angular_frequency": (omega, "angular frequency of the chain", unit),
            "exact_angular_frequency": (
                np.where(np.isnan(error), np.nan, exact),
                f"angular frequency of the {how.judge}",
                unit,
            ),
            "relative_error": (error, "relative frequency error of the chain", "1"),
        },
        grid.coordinates(error.shape[-1]) | over,
        route,
    )


def derived_error_dataset(
    boundary: BoundaryLike,
    *,
    segments: Iterable[int],
    modes: int,
    rule: AnyRule = "mitiguy",
    progress: Progress | bool | None = False,
) -> xarray.Dataset:
    """Return the errors of a rule by the report's route, `derive_chain`, as in its Figures 6 and 7.

    The compiled equations of motion and the chain in its factors check every frequency.

    Parameters
    ----------
    boundary : boundary
    segments : iterable of int
        At most 100: the derivation grows as N², its eigenvalues as N³ in 30-digit arithmetic.
    modes : int
    rule : rule
    progress : callable, optional
        Called with (points done, points in all).

    Returns
    -------
    xarray.Dataset
        As `error_dataset`; the attribute `disagreement` is the largest relative difference of the routes.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind.
    ArithmeticError
        If the routes disagree by more than 1e-10.

    Examples
    --------
    >>> import beammodes as bm
    >>> table = bm.derived_error_dataset("clamped-free", segments=[1, 2], modes=2)
    >>> table.relative_error.sel(mode=1).squeeze().values.round(5)
    array([-0.14676, -0.03366])
    """
    grid = ChainGrid.of(Boundary.of(boundary), segments, layout_of(rule), MAX_DERIVED).canonical
    mode = np.arange(1, whole_number("modes", modes, most=MAX_MODES) + 1)
    told = progress_of(progress, "derivation", "chains")
    exact = exact_frequencies(grid.boundaries[0], mode, Load())
    omega, worst = np.full((*grid.shape, len(mode)), np.nan), 0.0
    for i, count in enumerate(grid.segments):
        found, disagreement = _by_three_routes(Chain(grid.beam, grid.boundaries[0], count, grid.rules[0]))
        worst = max(worst, disagreement)
        omega[0, 0, i, : min(len(mode), len(found))] = found[: len(mode)]
        told(i + 1, len(grid.segments))
    route = "SymPy: nonlinear equations of motion, linearized"
    table = _errors_labelled(grid, omega, exact[None], omega / exact - 1, route=route)
    return table.assign_attrs(disagreement=worst)


def _by_three_routes(chain: Chain) -> tuple[Floats, float]:
    """Return the chain's derived frequencies, and how far two other routes are from them."""
    from scipy.linalg import eigvalsh

    from beammodes.equations.derivation import derive_chain
    from beammodes.equations.numeric import compile_equations

    derived = derive_chain(chain).angular_frequency
    mass, stiffness = compile_equations(chain).linearize().reduced()
    compiled = np.sqrt(eigvalsh(stiffness, mass)[chain.boundary.rigid_body_modes :]) if len(mass) else []
    others = [np.asarray(compiled), solve_modes(linearize(chain)).angular_frequency]
    alike = all(len(other) == len(derived) for other in others)
    apart = max(float(np.abs(other / derived - 1).max(initial=0.0)) for other in others) if alike else np.inf
    if not apart < ROUTES_AGREE:
        raise ArithmeticError(f"routes disagree for {chain!r}: {derived}, {others}")
    return derived, apart
