"""Polynomials in pieces, in whatever numbers they are made of: exact in fractions."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from beammodes.numerics.arrays import Floats

__all__ = ["Piecewise", "followed", "shifted"]

#: Polynomials that follow a function: their degree, how closely, in how many pieces at most.
_DEGREE, _CLOSE, _MOST_PIECES = 6, 1e-11, 400


class Piecewise(NamedTuple):
    """A function on edges[0] ... edges[-1], a polynomial between any two successive ones.

    Attributes
    ----------
    edges : tuple of numbers
        Ascending; all numbers are of one kind, fractions or floats.
    pieces : tuple of tuple of numbers
        Coefficients of each polynomial in the distance from its first edge, in ascending powers.

    Examples
    --------
    >>> from fractions import Fraction
    >>> none, half, one = Fraction(0), Fraction(1, 2), Fraction(1)
    >>> step = Piecewise((none, half, one), ((none,), (2 * one,)))
    >>> [str(value) for value in (step.integrated()(one), step(half, side=-1), step(half, side=1))]
    ['1', '0', '2']
    """

    edges: tuple[Any, ...]
    pieces: tuple[tuple[Any, ...], ...]

    @classmethod
    def one(cls, start: Any, stop: Any, *coefficients: Any) -> Piecewise:
        """Return one polynomial in x - start."""
        return cls((start, stop), (coefficients or (0,),))

    def __call__(self, x: Any, side: int = -1) -> Any:
        """Return the value at x; at an edge its limit from the left (side -1) or the right (1)."""
        i = (bisect_left if side < 0 else bisect_right)(self.edges, x) - 1
        i = min(max(i, 0), len(self.pieces) - 1)
        t, value = x - self.edges[i], 0 * x
        for c in reversed(self.pieces[i]):
            value = value * t + c
        return value

    def integrated(self) -> Piecewise:
        """Return the integral from the first edge on."""
        total, pieces = 0 * self.edges[0], []
        for start, stop, piece in zip(self.edges, self.edges[1:], self.pieces, strict=False):
            pieces.append((total, *(c / (k + 1) for k, c in enumerate(piece))))
            total = Piecewise((start, stop), (pieces[-1],))(stop)
        return Piecewise(self.edges, tuple(pieces))

    def integral(self, start: Any, stop: Any) -> Any:
        """Return the integral between two places."""
        whole = self.integrated()
        return whole(stop) - whole(start)

    def cut(self, places: Sequence[Any]) -> Piecewise:
        """Return the same function with more edges."""
        first, last = self.edges[0], self.edges[-1]
        edges = tuple(sorted({*self.edges, *(x for x in places if first < x < last)}))
        pieces = []
        for start in edges[:-1]:
            i = bisect_right(self.edges, start) - 1
            pieces.append(shifted(self.pieces[i], start - self.edges[i]))
        return Piecewise(edges, tuple(pieces))

    def plus(self, other: Piecewise) -> Piecewise:
        """Return the sum of two functions on the same interval."""
        a, b = self.cut(other.edges), other.cut(self.edges)
        return Piecewise(a.edges, tuple(_sum(p, q) for p, q in zip(a.pieces, b.pieces, strict=True)))

    def times(self, other: Piecewise) -> Piecewise:
        """Return the product of two functions on the same interval."""
        a, b = self.cut(other.edges), other.cut(self.edges)
        return Piecewise(a.edges, tuple(_product(p, q) for p, q in zip(a.pieces, b.pieces, strict=True)))


def _sum(p: tuple[Any, ...], q: tuple[Any, ...]) -> tuple[Any, ...]:
    longer, shorter = (p, q) if len(p) >= len(q) else (q, p)
    return tuple(c + (shorter[k] if k < len(shorter) else 0) for k, c in enumerate(longer))


def _product(p: tuple[Any, ...], q: tuple[Any, ...]) -> tuple[Any, ...]:
    found = [0 * (p[0] + q[0])] * (len(p) + len(q) - 1)
    for i, a in enumerate(p):
        for j, b in enumerate(q):
            found[i + j] = found[i + j] + a * b
    return tuple(found)


def shifted(piece: tuple[Any, ...], by: Any) -> tuple[Any, ...]:
    """Return the coefficients of p(t + by).

    Examples
    --------
    >>> shifted((0.0, 0.0, 1.0), 2.0)
    (4.0, 4.0, 1.0)
    """
    found: tuple[Any, ...] = (0 * by,)
    for c in reversed(piece):
        found = _sum(_product(found, (by, 1)), (c,))
    return found[: max(1, len(piece))]


def followed(function: Callable[[Floats], Floats], edges: Sequence[float], name: str) -> Piecewise:
    """Return polynomials that follow a function between edges to 1e-11 of its largest value.

    Pieces are halved until they do.

    Examples
    --------
    >>> found = followed(np.exp, (0.0, 1.0), "growth")
    >>> len(found.pieces), bool(abs(found(0.3) - np.exp(0.3)) < 1e-11)
    (4, True)
    """
    inner = 0.5 * (1.0 - np.cos(np.pi * (np.arange(_DEGREE + 1) + 0.5) / (_DEGREE + 1)))
    between = 0.5 * (1.0 - np.cos(np.pi * np.arange(_DEGREE + 2) / (_DEGREE + 1)))
    between[[0, -1]] = 1e-6, 1.0 - 1e-6
    solve = np.linalg.inv(np.vander(inner, increasing=True))
    check = np.vander(between, _DEGREE + 1, increasing=True)
    pending, done, largest = list(pairwise(edges))[::-1], [], 0.0
    while pending:
        start, stop = pending.pop()
        size = stop - start
        scaled = solve @ function(start + size * inner)
        values = function(start + size * between)
        largest = max(largest, float(np.abs(values).max()))
        if np.abs(check @ scaled - values).max() <= _CLOSE * largest:
            done.append((start, tuple((scaled / size ** np.arange(_DEGREE + 1)).tolist())))
        elif len(done) + len(pending) >= _MOST_PIECES:
            raise ValueError(
                f"{name} must be a function that polynomials follow in {_MOST_PIECES} pieces, got one that "
                f"they do not, near x = {start:g}"
            )
        else:
            middle = 0.5 * (start + stop)
            pending += [(middle, stop), (start, middle)]
    return Piecewise((*(start for start, _ in done), edges[-1]), tuple(piece for _, piece in done))
