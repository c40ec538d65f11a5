"""Static deflections of the beam and of the chain, and their errors.

Both are seen with the firmer end at x = 0 and the *tip*, the less firm end, at x = L; deflections, forces and
distributed load point up, rotations and moments are counter-clockwise. _Loads are of unit size.

A uniform beam is a polynomial of degree four. The chain never sees it: equilibrium gives the moment M_j at
hinge j from the load and the end's reactions R (force) and S (moment), and its spring of flexibility f_j
yields,

    y(x) = θ₀ x + Σ f_j M_j (x - x_j)  over the hinges left of x,     M_j = M_load(x_j) + R (L - x_j) + S,

with θ₀, R and S, each known to be zero or else found from an end's condition. Where reactions are not
determined by equilibrium these conditions make the stored energy Σ f_j M_j² / 2 least (Menabrea).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import accumulate
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple, overload

import numpy as np

from beammodes.accuracy.error_table import ChainGrid, labelled
from beammodes.chains.chain import Chain
from beammodes.chains.pieces import MAX_PIECES, Number
from beammodes.chains.rules import AnyRule
from beammodes.chains.structure_chain import StructureChain
from beammodes.chains.units import Units
from beammodes.checks import Shown, choice, instead, shown
from beammodes.deferred import Deferred
from beammodes.numerics.arrays import Floats
from beammodes.problem.applied_loads import LineLoad, PointLoad
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BOUNDARIES, Boundary, BoundaryLike, check_no_hub
from beammodes.problem.loading import Load
from beammodes.problem.profiles import profile_parts, value_at

if TYPE_CHECKING:
    import xarray

    from beammodes.accuracy import loaded_structures
else:
    xarray = Deferred("xarray")
    loaded_structures = Deferred("beammodes.accuracy.loaded_structures")

__all__ = [
    "LOADS",
    "STATIC_QUANTITIES",
    "Response",
    "Statics",
    "beam_statics",
    "chain_static_errors",
    "chain_statics",
    "static_dataset",
]

# The power of a length in the rotation that a load causes; deflections have one more.
_LENGTHS = MappingProxyType({"tip_force": 1, "tip_moment": 0, "uniform_load": 2})

#: The loads: a force or a moment at the tip, or a load spread evenly over the whole length.
LOADS: tuple[str, ...] = tuple(_LENGTHS)

#: Names of deflections and rotations, as datasets name their relative errors with "_error" after them.
STATIC_QUANTITIES = ("tip_deflection", "tip_rotation", "midspan_deflection")

# Tip force, tip moment and load per length.
_Loads = tuple[Any, Any, Any]


class Response(NamedTuple):
    """Deflection and rotation at the tip, NaN where the tip is held, and deflection at midspan."""

    deflection: Number
    rotation: Number
    midspan_deflection: Number


@dataclass(frozen=True, slots=True, repr=False)
class Statics(Shown):
    """Response to a load of unit size, 1 N, 1 N m or 1 N/m; `beam_statics` and `chain_statics` make it.

    Parameters
    ----------
    load : str
        One of `LOADS`.
    units : Units
        What one stands for in `own`: L and EI/L of a beam, the chain's own units of a chain.
    own : Response
        The response in these units, in which a beam and a chain made by a rule are exact fractions.

    Examples
    --------
    >>> import beammodes as bm
    >>> beam = bm.Beam(length=2.0, bending_stiffness=80.0, mass_per_length=1.0)
    >>> sag = bm.beam_statics(beam, "clamped-free", "tip_force")
    >>> sag.own.deflection, sag.deflection                          # F L³ / (3 EI)
    (Fraction(1, 3), 0.03333333333333333)
    >>> print(sag)
    Statics(tip_force of 1 N: deflection 0.0333333 m, rotation 0.025 rad, midspan deflection 0.0104167 m)
    """

    load: str
    units: Units
    own: Response

    @property
    def deflection(self) -> float:
        """Deflection of the tip [m]; NaN where the tip's deflection is held."""
        return self._physical(self.own.deflection, 1)

    @property
    def rotation(self) -> float:
        """Rotation of the tip [rad]; NaN where the tip's rotation is held."""
        return self._physical(self.own.rotation, 0)

    @property
    def midspan_deflection(self) -> float:
        """Deflection half way between the ends [m]."""
        return self._physical(self.own.midspan_deflection, 1)

    def _line(self) -> str:
        one = {"tip_force": "1 N", "tip_moment": "1 N m", "uniform_load": "1 N/m"}[self.load]
        values = (
            ("deflection", self.deflection, "m"),
            ("rotation", self.rotation, "rad"),
            ("midspan deflection", self.midspan_deflection, "m"),
        )
        told = (f"{name} {value:.6g} {unit}" for name, value, unit in values if not math.isnan(value))
        return f"Statics({self.load} of {one}: {', '.join(told)})"

    def _physical(self, value: Number, lengths: int) -> float:
        # A product leaves the range of doubles as inf, where a power would raise an unhelpful error.
        scale = math.prod([self.units.length] * (_LENGTHS[self.load] + lengths))
        return float(value) * scale / self.units.stiffness


@overload
def beam_statics(beam: Beam, boundary: BoundaryLike, load: str) -> Statics: ...


@overload
def beam_statics(
    beam: Beam, boundary: BoundaryLike, load: loaded_structures.Loads
) -> loaded_structures.StructureStatics: ...


def beam_statics(
    beam: Beam, boundary: BoundaryLike, load: str | loaded_structures.Loads
) -> Statics | loaded_structures.StructureStatics:
    """Return the response of an Euler-Bernoulli beam to loads, or to a load of unit size.

    (EI y'')'' = q,  two conditions at each end: y or -(EI y'')', and y' or EI y''

    A uniform beam's response is exact, in fractions. One that varies is integrated, M/EI over each smooth
    part with ever more Gauss points, to 1e-12.

    Parameters
    ----------
    beam : Beam
    boundary : str, pair or Boundary
        Without rigid-body motion.
    load : PointLoad, LineLoad, a sequence of these, Load or str
        Loads with their sizes, at places from the end named first: the answer has deflection, rotation,
        bending moment and shear force at any x, and the reactions. Of a `Load` gravity, and the force and the
        moment on the right tip. Or one of the words "tip_force", "tip_moment" and "uniform_load" for a load
        of size one, whose tip is the less firm end; one that a held tip takes up moves nothing.

    Returns
    -------
    StructureStatics, or Statics for a word

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or the ends let the beam move rigidly.
    ArithmeticError
        If the integrals of 1/EI do not converge, EI not being smooth between the beam's breaks.

    References
    ----------
    S. P. Timoshenko, Strength of Materials, part I (1930), chapters V and X.

    Examples
    --------
    >>> import beammodes as bm
    >>> bm.beam_statics(bm.Beam.unit(), "pinned-pinned", "uniform_load").own.midspan_deflection
    Fraction(5, 384)
    >>> pushed = bm.beam_statics(bm.Beam.unit(), "clamped-pinned", bm.PointLoad(0.5, force=-16.0))
    >>> pushed.deflection(Fraction(1, 2)), pushed.reactions["right"]
    (Fraction(-7, 48), Reaction(force_x=0.0, force_y=5.0, moment=0.0))
    >>> taper = bm.Beam(4.0, [1.5, 1.0], 1.0)
    >>> round(bm.beam_statics(taper, "clamped-free", "tip_force").deflection, 6)        # of 1 N
    15.111111
    """
    if not isinstance(beam, Beam):
        hint = instead(beam, Structure="structure_statics takes a Structure")
        raise TypeError(f"beam must be a Beam, got {shown(beam)}{hint}")
    _check_load(load)
    if not isinstance(load, str):
        from beammodes.accuracy.loaded_structures import beam_under

        return beam_under(beam, boundary, load)
    pair, name = _without_rigid_motion(Boundary.of(boundary)), choice("load", load, LOADS)
    mass, stiffness = beam.mean_mass_per_length, beam.mean_bending_stiffness
    units = Units(beam.length, mass * beam.length, stiffness / beam.length)
    if isinstance(beam.bending_stiffness, float):
        return Statics(name, units, _beam_response(pair.canonical, name))
    return Statics(name, units, _integrated_response(beam, pair, name))


@overload
def chain_statics(chain: Chain, load: str) -> Statics: ...


@overload
def chain_statics(
    chain: Chain | StructureChain, load: loaded_structures.Loads
) -> loaded_structures.StructureStatics: ...


def chain_statics(
    chain: Chain | StructureChain, load: str | loaded_structures.Loads
) -> Statics | loaded_structures.StructureStatics:
    """Return the response of a chain to small loads, or to one of unit size.

    y(x) = θ₀ x + Σ M_j (x - x_j) / k_j  over the hinges left of x

    Parameters
    ----------
    chain : Chain or StructureChain
        Of ends without rigid-body motion. `own` is exact if its lengths and springs are fractions, as a
        rule makes them. The cost is proportional to the number of hinges. Of a structure this is
        `structure_chain_statics`.
    load : PointLoad, LineLoad, a sequence of these, Load or str
        As of `beam_statics`. Words are for any chain, and "uniform_load" is spread over the pieces by their
        length; other loads are for a chain that a rule made.

    Returns
    -------
    StructureStatics, or Statics for a word

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or the ends let the chain move rigidly.

    References
    ----------
    Equilibrium, and least work where it leaves reactions open: Timoshenko, Strength of Materials, part I
    (1930), chapter X.

    Examples
    --------
    >>> import beammodes as bm
    >>> chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments=4, rule="mitiguy")
    >>> bm.chain_statics(chain, "tip_force").own.deflection                # the beam's 4³/3 ell³/EI
    Fraction(64, 3)
    """
    if not isinstance(chain, Chain | StructureChain):
        raise TypeError(f"chain must be a Chain or a StructureChain, got {shown(chain)}")
    _check_load(load)
    if not isinstance(load, str):
        from beammodes.accuracy.loaded_structures import chain_under, structure_chain_statics

        return chain_under(chain, load) if isinstance(chain, Chain) else structure_chain_statics(chain, load)
    if isinstance(chain, StructureChain):
        raise TypeError(
            f"load must be loads with their sizes (PointLoad, LineLoad, Load) on a structure, "
            f"got {shown(load)}"
        )
    _without_rigid_motion(chain.boundary)
    name = choice("load", load, LOADS)
    return Statics(name, chain.units, _chain_response(chain, name))


def static_dataset(
    *,
    boundary: BoundaryLike | Iterable[BoundaryLike],
    segments: int | Iterable[int],
    rule: AnyRule | Iterable[AnyRule] = "mitiguy",
) -> xarray.Dataset:
    """Return static errors of chains as one labelled table; they need no beam, its numbers scale out.

    e = y_chain / y_beam - 1

    Parameters
    ----------
    boundary : boundary, or iterable of boundaries
        Without rigid-body motion.
    segments : int, or iterable of int
    rule : rule, or iterable of rules

    Returns
    -------
    xarray.Dataset
        Dimensions rule, boundary, segments, static_load; variables tip_deflection_error, tip_rotation_error
        and midspan_deflection_error, signed and relative; NaN where the tip is held, where the load moves
        no beam, and where a rule gives no positive springs.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or outside its range.

    Examples
    --------
    >>> import beammodes as bm
    >>> table = bm.static_dataset(boundary="clamped-free", segments=[4, 10], rule=["mitiguy", "naive"])
    >>> table.tip_deflection_error.sel(static_load="tip_force").squeeze().values
    array([[0.     , 0.     ],
           [0.40625, 0.155  ]])
    """
    grid = ChainGrid.of(boundary, segments, rule, MAX_PIECES).canonical
    for pair in grid.boundaries:
        _without_rigid_motion(pair)
    errors = np.full((3, *grid.shape, len(LOADS)), np.nan)
    for index, chain in grid.chains():
        errors[:, *index, :] = np.transpose([chain_static_errors(chain, load) for load in LOADS])
    return labelled(
        ("rule", "boundary", "segments", "static_load"),
        {
            f"{name}_error": (error, f"relative error of the chain's static {name.replace('_', ' ')}", "1")
            for name, error in zip(STATIC_QUANTITIES, errors, strict=True)
        },
        grid.coordinates() | {"static_load": list(LOADS)},
        "equilibrium in exact fractions",
    )


def chain_static_errors(chain: Chain, load: str) -> list[float]:
    """Return the errors of `STATIC_QUANTITIES` of a rule's chain, each rounded once from its exact value.

    Examples
    --------
    >>> chain_static_errors(Chain(Beam.unit(), "clamped-free", 4, "naive"), "tip_force")[0]
    0.40625
    """
    assert chain.segments is not None  # A rule made it.
    scale = Fraction(chain.segments) ** (_LENGTHS[load] + 1)
    exact = beam_statics(Beam.unit(), chain.boundary, load).own
    factors = (scale * chain.segments, scale, scale * chain.segments)
    return [
        float(ours / (theirs * factor) - 1) if theirs else math.nan
        for ours, theirs, factor in zip(chain_statics(chain, load).own, exact, factors, strict=True)
    ]


def _check_load(load: object) -> None:
    if not isinstance(load, str | Load | PointLoad | LineLoad | Iterable):
        raise TypeError(
            f"load must be one of {', '.join(LOADS)}, or loads with their sizes (PointLoad, LineLoad, Load), "
            f"got {shown(load)}"
        )


def _without_rigid_motion(boundary: Boundary) -> Boundary:
    """Return `boundary`, or raise ValueError if it has elastic supports or lets the beam move."""
    check_no_hub(boundary.left, boundary.right)
    if boundary.left.is_elastic or boundary.right.is_elastic:
        raise ValueError(f"boundary must hold its ends or leave them free, not on springs, got {boundary}")
    if boundary.rigid_body_modes:
        firm = ", ".join(pair.name for pair in BOUNDARIES if not pair.rigid_body_modes)
        raise ValueError(f"boundary must hold the beam still ({firm}), got {shown(boundary.name)}")
    return boundary


def _unit_loads(load: str) -> _Loads:
    force, moment, spread = (Fraction(name == load) for name in LOADS)
    return force, moment, spread


def _at_tip(boundary: Boundary, deflection: Number, rotation: Number, midspan: Number) -> Response:
    """Return the response of a beam or chain, leaving out what its tip holds."""
    tip = boundary.right
    return Response(
        math.nan if tip.holds_deflection else deflection,
        math.nan if tip.holds_rotation else rotation,
        midspan,
    )


def _beam_response(boundary: Boundary, load: str) -> Response:
    """Return the response for L = EI = 1, the firmer end at 0."""
    force, moment, spread = _unit_loads(load)
    curve = [Fraction(0)] * 4 + [spread / 24]
    rows, rest = [], []
    for x, end, shear, couple in ((0, boundary.left, 0, 0), (1, boundary.right, -force, moment)):
        deflection = (0, 0) if end.holds_deflection else (3, shear)
        rotation = (1, 0) if end.holds_rotation else (2, couple)
        for order, value in (deflection, rotation):
            rows.append([_power(p, order, Fraction(x)) for p in range(4)])
            rest.append(value - _polynomial(curve, order, Fraction(x)))
    curve[:4] = _solved(rows, rest)
    values = (_polynomial(curve, order, Fraction(x, 2)) for order, x in ((0, 2), (1, 2), (0, 1)))
    return _at_tip(boundary, *values)


def _integrated_response(beam: Beam, pair: Boundary, load: str) -> Response:
    """Return the response for L = mean EI = 1, the firmer end at 0, of a beam whose EI varies.

    Gauss's rule for ∫ (x - s) M/EI ds is a chain of hinges: at its points, of flexibility weight/EI.
    """
    previous, mirrored = Response(math.inf, math.inf, math.inf), pair != pair.canonical
    parts = profile_parts(beam.bending_stiffness, beam.length)
    edges = np.unique([0.0, *(x / beam.length for x in parts), 0.5, 1.0])
    # Thousands of parts, between the kinks of a fine table, need few points each.
    fewest = max(2, min(12, 1000 // len(edges)))
    for doubled in range(5):
        position, weight = _gauss_points(edges, fewest * 2**doubled)
        flexibility = weight / value_at(beam.bending_stiffness, position * beam.length)
        flexibility *= beam.mean_bending_stiffness
        if mirrored:
            position, flexibility = 1.0 - position[::-1], flexibility[::-1]
        found = _hinged_response(pair.canonical, 1.0, position.tolist(), flexibility.tolist(), load)
        now, before = np.array(found, dtype=np.float64), np.array(previous, dtype=np.float64)
        size, change = np.nanmax(np.abs(now)), np.nanmax(np.abs(now - before))
        if change <= 1e-12 * size:
            return Response(*found)
        previous = found
    raise ArithmeticError(
        "integrals of 1/EI do not agree to 1e-12: has bending_stiffness steps, kinks or narrow features "
        "between the beam's breaks, and too many of them?"
    )


def _gauss_points(edges: Floats, points: int) -> tuple[Floats, Floats]:
    """Return positions and weights on 0 to 1, so many between any two edges."""
    node, plain = np.polynomial.legendre.leggauss(points)
    half = 0.5 * np.diff(edges)
    return (edges[:-1, None] + half[:, None] * (1 + node)).ravel(), (half[:, None] * plain).ravel()


def _power(exponent: int, order: int, x: Fraction) -> Fraction:
    """Return the derivative of some order of x**exponent."""
    return math.perm(exponent, order) * x ** max(exponent - order, 0)


def _polynomial(coefficients: Sequence[Number], order: int, x: Fraction) -> Any:
    return sum((c * _power(p, order, x) for p, c in enumerate(coefficients)), Fraction(0))


def _chain_response(chain: Chain, load: str) -> Response:
    """Return the response in the chain's own units, its firmer end at 0."""
    pair = chain.boundary.canonical
    if not chain.elastic_modes:  # Held rigidly: nothing moves, and reactions may have no definite value.
        return _at_tip(pair, Fraction(0), Fraction(0), Fraction(0))
    step = 1 if pair == chain.boundary else -1
    position = list(accumulate(chain.scaled.length[::step], initial=Fraction(0)))
    flexibility = [1 / stiffness for stiffness in chain.scaled.joint_stiffness[::step]]
    return _hinged_response(pair, position[-1], position[1:-1], flexibility, load)


def _hinged_response(
    pair: Boundary, length: Number, hinges: Sequence[Number], flexibility: Sequence[Number], load: str
) -> Response:
    """Return the response of hinges with springs, the firmer end at 0."""
    arms = [length - x for x in hinges]
    # Fractions beside floats would cost most of the time.
    point, couple, spread = map(type(length), _unit_loads(load))
    loads = (point, couple, spread)
    root_angle, force, moment = _reactions(pair, length, arms, flexibility, loads)
    moments = [_moment(loads, arm) + force * arm + moment for arm in arms]
    turns = [f * m for f, m in zip(flexibility, moments, strict=True)]

    def deflection(x: Number) -> Any:
        return root_angle * x + sum(
            (turn * (x - at) for turn, at in zip(turns, hinges, strict=True) if at < x), Fraction(0)
        )

    return _at_tip(pair, deflection(length), root_angle + sum(turns, Fraction(0)), deflection(length / 2))


def _moment(loads: _Loads, arm: Number) -> Any:
    """Return the moment of the load beyond a hinge about it, `arm` from the tip.

    A rigid piece feels a spread load as half of its share at either end; about any hinge that is arm²/2.
    """
    force, moment, spread = loads
    return force * arm + moment + spread * arm * arm / 2


def _reactions(
    pair: Boundary, length: Number, arms: Sequence[Number], flexibility: Sequence[Number], loads: _Loads
) -> list[Any]:
    """Return θ₀ and the tip's reactions R and S from one condition each."""

    zero, one = type(length)(0), type(length)(1)

    def total(values: Iterable[Any]) -> Any:
        return sum((f * value for f, value in zip(flexibility, values, strict=True)), zero)

    bent = [_moment(loads, arm) for arm in arms]
    rows: list[list[Any]] = [[one, zero, zero], [zero, one, zero], [zero, zero, one]]
    rest: list[Any] = [zero, zero, zero]
    if not pair.left.holds_rotation:  # No moment at the root.
        rows[0], rest[0] = [zero, length, one], -_moment(loads, length)
    if pair.right.holds_deflection:
        rows[1] = [length, total(arm * arm for arm in arms), total(arms)]
        rest[1] = -total(arm * m for arm, m in zip(arms, bent, strict=True))
    if pair.right.holds_rotation:
        rows[2], rest[2] = [one, total(arms), total(one for _ in arms)], -total(bent)
    return _solved(rows, rest)


def _solved(rows: Sequence[Sequence[Any]], rest: Sequence[Any]) -> list[Any]:
    """Solve a small regular linear system in whatever numbers it is made of."""
    table = [[*row, value] for row, value in zip(rows, rest, strict=True)]
    for k in range(len(table)):
        best = max(range(k, len(table)), key=lambda i: abs(table[i][k]))
        table[k], table[best] = table[best], table[k]
        table[k] = [value / table[k][k] for value in table[k]]
        for i, row in enumerate(table):
            if i != k:
                table[i] = [value - row[k] * pivot for value, pivot in zip(row, table[k], strict=True)]
    return [row[-1] for row in table]
