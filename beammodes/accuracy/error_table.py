"""Frequency errors of many chains as one labelled table."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from beammodes.accuracy.errors import MAX_MODES, beam_frequencies, errors_in_multiples
from beammodes.accuracy.grids import EndNumbers, listed, looked_up
from beammodes.chains.chain import Chain
from beammodes.chains.rules import AnyRule, Layout, layout_of
from beammodes.checks import shown, whole_number
from beammodes.closed_form.uniform import MAX_SEGMENTS
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.exact.exact_beam import wavenumber
from beammodes.exact.timoshenko_beam import MOST_MODES, theory_error_of
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.loading import Load, checked_load
from beammodes.version import SOURCE
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

if TYPE_CHECKING:
    import xarray

__all__ = [
    "SlendernessWarning",
    "chain_errors",
    "derived_error_dataset",
    "error_dataset",
    "exact_frequencies",
    "labelled_errors",
    "stout_remark",
    "theory_errors",
]


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


def exact_frequencies(boundary: Boundary, mode: NDArray[np.intp], load: Load) -> Floats:
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
    angular_frequency: Floats,
    exact: Floats,
    error: Floats,
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
        attrs={"source": SOURCE, "route": route},
    )


#: Relative disagreement of two routes that cannot be rounding.
ROUTES_AGREE = 1e-10
#: Segments of a chain that is derived in symbols; more would take hours.
MAX_DERIVED = 100


def derived_error_dataset(
    boundary: BoundaryLike,
    *,
    segments: Iterable[int],
    modes: int,
    rule: AnyRule = "mitiguy",
    progress: Callable[[int, int], None] | None = None,
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
    pair, record = Boundary.of(boundary).canonical, layout_of(rule)
    counts = [whole_number("segments", n, most=MAX_DERIVED) for n in listed("segments", segments, (str,))]
    exact = np.asarray(wavenumber(pair, np.arange(1, whole_number("modes", modes, most=MAX_MODES) + 1))) ** 2
    omega, worst = np.full((len(counts), modes), np.nan), 0.0
    for i, count in enumerate(counts):
        found, disagreement = _by_three_routes(Chain(Beam.unit(), pair, count, record))
        worst = max(worst, disagreement)
        omega[i, : min(modes, len(found))] = found[:modes]
        if progress is not None:
            progress(i + 1, len(counts))
    table = labelled_errors(
        [record.name],
        [pair.name],
        counts,
        angular_frequency=omega[None, None],
        exact=exact[None],
        error=(omega / exact - 1)[None, None],
        route="SymPy: nonlinear equations of motion, linearized",
    )
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


# A chain beside the beam that it stands for, and beside what Euler-Bernoulli theory itself leaves out.

#: More modes than any chain has whose frequencies are all solved for.
MOST_ERRORS = 100_000


class SlendernessWarning(UserWarning):
    """The beam is so stout that Euler-Bernoulli theory errs more on it than the chain errs on the theory."""


#: Errors of the theory below this are not told: no beam's stiffness and mass are known so well.
LEAST_TOLD = 1e-3


def chain_errors(chain: Chain, modes: int = 3, *, load: Load | None = None) -> Floats:
    """Return the relative frequency errors of a chain against its own exact beam.

        e = ω_chain / ω_beam - 1

    For any beam, ends and axial force; both frequencies are solved for, so e is good to 1e-10 absolute, or
    1e-12 on a uniform beam. `frequency_error` is quicker and keeps more digits where it applies.

    Parameters
    ----------
    chain : Chain
        One with a beam, not from pieces.
    modes : int
        How many, from the first.
    load : Load, optional
        An axial force.

    Returns
    -------
    ndarray, shape (modes,) [-]
        NaN beyond the chain's last mode.

    Warns
    -----
    SlendernessWarning
        If the beam's section is known, from `Beam.from_section` or by its rotary inertia, and `theory_errors`
        are larger than these errors and than 0.1 %.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, the chain has no beam, or the axial force buckles it.

    Examples
    --------
    >>> taper = Beam(1.0, bending_stiffness=lambda x: (1 - x / 2) ** 3, mass_per_length=lambda x: 1 - x / 2)
    >>> chain_errors(Chain(taper, "clamped-free", segments=20, rule="gregory"), modes=2).round(6)
    array([0.0e+00, 2.5e-05])
    """
    if not isinstance(chain, Chain):
        raise TypeError(f"chain must be a Chain, got {shown(chain)}")
    if chain.beam is None:
        raise ValueError("chain must have a beam to be compared with; one from pieces has none")
    count = whole_number("modes", modes, most=MAX_MODES)
    found = solve_modes(linearize(chain, load=load), count).angular_frequency
    errors = np.full(count, np.nan)
    if len(found):
        exact = euler_bernoulli(chain.beam, chain.boundary, len(found), load=load)
        errors[: len(found)] = found / exact.angular_frequency - 1
        # A load that the stiffer theory bears may buckle the softer one, which then has nothing to compare.
        with suppress(ValueError, ArithmeticError):
            _warn_if_stout(errors[: len(found)], exact.theory_error, exact.theory_assumed)
    return errors


def theory_errors(
    beam: Beam,
    boundary: BoundaryLike,
    modes: int = 3,
    *,
    radius_of_gyration: float | None = None,
    shear_ratio: float | None = None,
    load: Load | None = None,
) -> Floats:
    """Return how much lower a real beam's frequencies are than this beam's, which neglects shear.

        ω_Timoshenko / ω_beam - 1

    of the n-th modes, both solved for. What a chain of this beam has beside its own error e: against the real
    beam it errs by (1 + e)/(1 + this) - 1, which more segments bring no lower than this.

    Parameters
    ----------
    beam : Beam
        Its own rotary inertia, where it has one, is in both frequencies.
    boundary : str, pair or Boundary
    modes : int
        How many, from the first, 1 to 100.
    radius_of_gyration : float [m], optional
        r = √(I/A) of the section; the beam's own, or √(ρI/ρA), by default.
    shear_ratio : float, optional
        E/(κG), for κGA = EI/(r² E/(κG)). The beam's own shear stiffness by default, and where it has none
        3.12, a rectangle's with Poisson's ratio 0.3.
    load : Load, optional
        One that leaves the beam straight.

    Returns
    -------
    ndarray, shape (modes,) [-]
        NaN for modes beyond Timoshenko's cut-off frequency √(κGA/ρI): from there on modes of shear lie among
        those of bending, and n-th modes are not of one kind.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or no radius of gyration is known.

    Examples
    --------
    >>> theory_errors(Beam.unit(), "pinned-pinned", 2, radius_of_gyration=0.02).round(4)
    array([-0.008 , -0.0307])
    """
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    count, pull = whole_number("modes", modes, most=MOST_MODES), checked_load(load)
    omega = euler_bernoulli(beam, boundary, count, load=load).angular_frequency
    errors = theory_error_of(beam, Boundary.of(boundary), pull, omega, radius_of_gyration, shear_ratio)
    if errors is None:
        raise ValueError(
            "radius_of_gyration must be given for a beam that has neither one nor a rotary inertia, "
            "got None; Beam.from_section knows it"
        )
    return errors


def _warn_if_stout(errors: Floats, theory: Floats, assumed: tuple[str, ...]) -> None:
    if remark := _stout(errors, theory, assumed):
        warnings.warn(remark, SlendernessWarning, stacklevel=3)


def _stout(errors: Floats, theory: Floats, assumed: tuple[str, ...]) -> str:
    worse = np.flatnonzero(np.abs(theory) > np.maximum(np.abs(errors), LEAST_TOLD))
    if not len(worse):
        return ""
    n = int(worse[0])
    taken = f" (assumed: {', '.join(assumed)})" if assumed else ""
    return (
        f"shear and what else Euler-Bernoulli theory leaves out lower frequency {n + 1} of this beam by "
        f"{-100 * theory[n]:.3g} %{taken}, more than the chain's {100 * abs(errors[n]):.2g} %: more "
        "segments do not bring it closer to the real beam"
    )


def stout_remark(beam: Beam, boundary: BoundaryLike, errors: Floats) -> str:
    """Return the words of `SlendernessWarning` for a chain's errors, "" where they are the larger ones.

    Also "" where nothing tells the beam's section, or a mode is missing.

    Examples
    --------
    >>> stout = Beam(1.0, 1.0, 1.0, radius_of_gyration=0.1)
    >>> stout_remark(stout, "clamped-free", np.array([1e-3]))[:49]
    'shear and what else Euler-Bernoulli theory leaves'
    >>> stout_remark(Beam.unit(), "clamped-free", np.array([1e-3]))
    ''
    """
    known = beam.shear_stiffness is not None or beam.radius_of_gyration is not None or beam.has_rotary_inertia
    count = len(errors) - int(np.isnan(errors).sum())
    if not known or not count:
        return ""
    with suppress(ValueError, ArithmeticError):
        exact = euler_bernoulli(beam, boundary, count)
        return _stout(errors[:count], exact.theory_error, exact.theory_assumed)
    return ""
