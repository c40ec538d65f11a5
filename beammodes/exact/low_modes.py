"""Modes of the supported beam in long decimals: every root, however far the numbers are spread."""

from __future__ import annotations

from decimal import Decimal, localcontext

import numpy as np

from beammodes.exact.beam_waves import BeamWaves, beam_mass
from beammodes.exact.count_roots import ordered_roots
from beammodes.exact.long_decimals import cosine_and_sine
from beammodes.exact.unit_beam import UnitBeam, UnitEnd

__all__ = ["low_squares", "low_waves"]

Row = list[Decimal]

# Beyond the clamped beam's buckling load, 4 π² = 39.478...
_NO_BEAM_BEARS = Decimal("-39.5")


def low_squares(beam: UnitBeam, rigid: int, count: int, wave: Decimal) -> list[Decimal] | None:
    """Return the first `count` positive w = ω², fewer if q = `wave` comes first; None if the beam buckles.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> from beammodes.problem.ends import Boundary
    >>> beam = UnitBeam.of(Beam.unit(), Boundary.of("pinned-pinned"))
    >>> [round(float(square), 4) for square in low_squares(beam, 0, 2, Decimal(10))]
    [97.4091, 1558.5455]
    """
    if beam.tension < _NO_BEAM_BEARS:
        return None
    # The clamped beam has at most two roots less below a place than the pinned one, whose roots are n π.
    high = beam.sample(beam.square_at(min(wave, Decimal("3.15") * (rigid + count + 3))))
    low, decades = high, 1
    while low.below > rigid:
        if decades > 64 + 4 * beam.spread:
            return None
        low = beam.sample(high.place.scaleb(-decades))
        decades *= 2
    return ordered_roots(beam.sample, low, high, count)


def low_waves(beam: UnitBeam, squares: list[Decimal]) -> BeamWaves:
    """Return the shapes of unit modal mass at squared frequencies that are roots."""
    columns = zip(*(_mode(beam, square) for square in squares), strict=True)
    return BeamWaves(*(np.array(column) for column in columns))


def _mode(beam: UnitBeam, square: Decimal) -> tuple[object, ...]:
    """Return p, q, the waves at both ends and the states at both ends, as doubles."""
    with localcontext() as context:
        context.prec = beam.digits(square)
        tension, p, q = beam.wavenumbers(square)
        across, (cosine, sine) = (-p).exp(), cosine_and_sine(q)
        states = _states(p, q, across)
        # cos qx and sin qx in terms of the distance from the right end.
        turned = [[*_turned(row[0], row[1], cosine, sine), row[3], row[2]] for row in states]
        rows = _conditions(beam.left, states, tension, square)
        rows += _conditions(beam.right, turned, tension, square)
        vector = _null_vector(rows)
        left, right = vector[:3], [*_turned(vector[0], vector[1], cosine, sine), vector[3]]
        ends = [[_dot(row, vector) for row in table] for table in (states, turned)]
        mass = beam_mass(p, q, beam.gyration, left, right, across)
        mass += sum(end.energy(*state[:2]) for end, state in zip((beam.left, beam.right), ends, strict=True))
        unit = mass.sqrt()
        return float(p), float(q), *([float(n / unit) for n in part] for part in (left, right, *ends))


def _turned(a: Decimal, b: Decimal, cosine: Decimal, sine: Decimal) -> tuple[Decimal, Decimal]:
    """Return what a cos qx + b sin qx is in z = 1 - x, and, the map being its own inverse, back."""
    return a * cosine + b * sine, a * sine - b * cosine


def _states(p: Decimal, q: Decimal, across: Decimal) -> list[Row]:
    """Return y, y', y'', y''' at z = 0 of cos qz, sin qz, e^(-pz), e^(-p(1-z))."""
    one, none = Decimal(1), Decimal(0)
    return [
        [one, none, one, across],
        [none, q, -p, p * across],
        [-q * q, none, p * p, p * p * across],
        [none, -(q**3), -(p**3), p**3 * across],
    ]


def _conditions(end: UnitEnd, states: list[Row], tension: Decimal, square: Decimal) -> list[Row]:
    """Return the rows of both conditions of an end on the four waves."""
    deflection, coupled, turning = end.impedance(square)
    waves = [list(column) for column in zip(*states, strict=True)]
    force = [d3 - tension * d1 + deflection * d0 + coupled * d1 for d0, d1, _, d3 in waves]
    moment = [coupled * d0 + turning * d1 - d2 for d0, d1, d2, _ in waves]
    return [
        states[0] if end.holds[0] else force,
        states[1] if end.holds[1] else moment,
    ]


def _null_vector(rows: list[Row]) -> Row:
    """Return the vector that four rows of rank three annihilate, by elimination with complete pivoting."""
    rows = [[value / max(map(abs, row)) for value in row] for row in rows]
    order = list(range(4))
    for step in range(3):
        i, j = max(
            ((i, j) for i in range(step, 4) for j in range(step, 4)), key=lambda at: abs(rows[at[0]][at[1]])
        )
        rows[step], rows[i] = rows[i], rows[step]
        order[step], order[j] = order[j], order[step]
        for row in rows:
            row[step], row[j] = row[j], row[step]
        for row in rows[step + 1 :]:
            factor = row[step] / rows[step][step]
            row[step:] = [
                value - factor * top for value, top in zip(row[step:], rows[step][step:], strict=True)
            ]
    solution = [Decimal(1)]
    for step in (2, 1, 0):
        known = _dot(rows[step][step + 1 :], solution)
        solution.insert(0, -known / rows[step][step])
    return [solution[order.index(column)] for column in range(4)]


def _dot(row: Row, vector: Row) -> Decimal:
    return sum((a * b for a, b in zip(row, vector, strict=True)), Decimal(0))
