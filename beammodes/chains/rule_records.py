"""Discretization rules: where a chain's hinges sit and how stiff they are, in exact numbers.

A rule cuts a beam of N equal segments of length ell at hinges and gives each hinge a rotational spring
`EI / (w ell)`. The *flexibility weight* w is 1 inside; near an end whose rotation is held a rule corrects
it. The weights are the weights of a quadrature: the beam's flexibility is the integral of M²/EI along it,
the chain's is the sum of w ell M²/EI over its hinges, so a rule is as good as its quadrature at the ends.

Corrections to the weight 1 are *added* from both ends, so a short chain, on which they overlap, needs no
special case: the third-order end weights of Gregory become Simpson's rules on two and three segments.
"""

from __future__ import annotations

import math
import numbers
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache
from types import MappingProxyType
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.pieces import MAX_PIECES
from beammodes.chains.quadrature import HIGHEST_ORDER, end_defects, end_order
from beammodes.checks import shown, whole_number
from beammodes.problem.ends import Boundary, End
from beammodes.problem.loading import Load, checked_load

__all__ = ["MAX_END_WEIGHTS", "Layout", "Rule", "RuleMaker", "Weight"]


#: Errors of rules that change more springs at an end would lose digits: their series run out of terms.
MAX_END_WEIGHTS = 8

#: Weights beyond these are mistakes: their springs would hold like a wall or give way like a hole.
_SMALLEST, _LARGEST = 1e-9, 1e9

#: Floats stand for the simplest fraction that rounds to them, up to this denominator: 1/12 stays 1/12.
_DENOMINATOR = 10**6

_ROD = Fraction(1, 12)
_HALF = Fraction(1, 2)


@dataclass(frozen=True, slots=True)
class Weight:
    """A flexibility weight  w = constant + per_segment / N  (dimensionless, exact).

    Parameters
    ----------
    constant, per_segment : str, int, float or Fraction
        Text such as "3/8" or "0.375"; a float stands for the simplest fraction that rounds to it.

    Raises
    ------
    TypeError, ValueError
        If a number is not of these, or is not finite.

    Examples
    --------
    >>> Weight("1/2", "-1/6").at(Fraction(4))      # the report's wall, N = 4
    Fraction(11, 24)
    """

    constant: Fraction
    per_segment: Fraction = Fraction(0)

    def __init__(self, constant: Exact, per_segment: Exact = 0) -> None:
        object.__setattr__(self, "constant", _exact("constant", constant))
        object.__setattr__(self, "per_segment", _exact("per_segment", per_segment))

    def at(self, segments: Any) -> Any:
        """Return the weight for N segments, in whatever algebra N belongs to; floats for an array."""
        if hasattr(segments, "dtype"):
            return float(self.constant) + float(self.per_segment) / segments
        return self.constant + self.per_segment / segments


#: What stands for an exact number.
Exact = str | float | Fraction

#: What stands for the weights of the hinges nearest an end.
Weights = Sequence[Exact | Weight] | NDArray[np.floating[Any]]


@dataclass(frozen=True, init=False)
class Rule:
    """A way to turn a beam into a chain of rigid segments and springs: a name and what distinguishes it.

    Every hinge has a spring `EI / (w ell)`, with the flexibility weight w = 1 but near an end. Weights are
    given from the end's own hinge inward, as text, numbers, fractions or `Weight`. The order of the error
    follows from them and is not given: see `order`.

    Parameters
    ----------
    name : str
        The word that users type.
    clamped : sequence of weights
        Of the hinges nearest a clamped end, and every end that feels a moment and a shear force
        (`End.statics` says which word applies to an end with springs or a body). At most 8.
    guided : sequence of weights, optional
        Likewise of a guided end. By default those that keep order 4 there with the fewest changes: 1/2 with a
        hinge at the wall, none with half a stub, 5/3 and 5/6 with a welded segment.
    carried : sequence of weights, optional
        Likewise of an end whose body is part of the last segment (`End(on_segment=True)`). None by default:
        then light bodies leave no jump. 23/12 and 7/12 suit a body with much rotary inertia, at order 3.
    stub : number, optional
        Length, in segments, of the rigid piece fixed to an end whose rotation is held: 0 puts a hinge
        at the wall, 1/2 puts every hinge at a segment's middle, 1 welds the whole first segment.
    rotary_inertia : number, optional
        Central rotary inertia of a piece over its mass times length²: 1/12 for a rod, 1/4 for point
        masses at its two ends.
    summary, used_by, source : str, optional
        What it does in one sentence; who uses it; where it comes from.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or outside its range.

    Examples
    --------
    >>> own = Rule("own", ["5/12", "13/12"])           # two changed springs, 12/5 and 12/13 EI/ell
    >>> own.order["clamped"], own.order["guided"]
    (3, 4)
    >>> [str(w) for w in own.hinge_weights(Boundary.of("clamped-guided"), 4)]
    ['5/12', '13/12', '1', '1', '1/2']
    """

    name: str
    clamped: tuple[Weight, ...]
    guided: tuple[Weight, ...]
    carried: tuple[Weight, ...]
    stub: Fraction
    rotary_inertia: Fraction
    summary: str = field(compare=False)
    used_by: str = field(compare=False)
    source: str = field(compare=False)

    def __init__(
        self,
        name: str,
        clamped: Weights,
        guided: Weights | None = None,
        carried: Weights = (),
        stub: Exact = 0,
        rotary_inertia: Exact = _ROD,
        summary: str = "",
        used_by: str = "",
        source: str = "",
    ) -> None:
        texts = {"name": name, "summary": summary, "used_by": used_by, "source": source}
        for argument, text in texts.items():
            if not isinstance(text, str):
                raise TypeError(f"{argument} must be a text, got {shown(text)}")
        if not name.isprintable() or not name.strip():
            raise ValueError(f"name must be a word of printable characters, got {shown(name)}")
        length, inertia = _exact("stub", stub), _exact("rotary_inertia", rotary_inertia)
        if length not in (0, _HALF, 1):
            raise ValueError(f"stub must be 0, 1/2 or 1 segment, got {shown(stub)}")
        if not _SMALLEST <= inertia <= _LARGEST:
            raise ValueError(
                "rotary_inertia must be greater than 0, 1/12 for a rod and 1/4 for point masses, "
                f"got {shown(rotary_inertia)}"
            )
        values = {
            **texts,
            "clamped": _weights("clamped", clamped),
            "guided": _mirror(length) if guided is None else _weights("guided", guided),
            "carried": _weights("carried", carried),
            "stub": length,
            "rotary_inertia": inertia,
        }
        for argument, value in values.items():
            object.__setattr__(self, argument, value)

    @property
    def order(self) -> Mapping[str, int]:
        """p in e ~ 1/N**p that each kind of end leaves, and "inside"; read-only, derived from the weights."""
        return _orders(self)

    def declared_order(self, boundary: Boundary, load: Load | None = None) -> int:
        """Return p in e ~ 1/N**p: the smallest of inside and both ends, and at best 2 under load.

        Elastic supports and end bodies are included. Loads along the beam, spin, buckling loads and large
        deflections have order 2, and so has a section's rotary inertia.
        """
        ends = (boundary.left.statics, boundary.right.statics)
        order = min(self.order["inside"], *(self.order[end] for end in ends))
        return order if checked_load(load) == Load() else min(order, 2)

    def end_defects(self, kind: str) -> list[tuple[Fraction, Fraction]]:
        """Return  d_k = constant + per_segment/N,  k = 0..3, of the quadrature at a kind of end.

        Where the bending moment is zero (pinned, free) the hinge that would sit there has no effect, and d_k
        is that of the bare trapezoidal or midpoint sum. See `beammodes.chains.quadrature`.

        Examples
        --------
        >>> [str(constant) for constant, _ in Rule("own", ["3/8", "7/6", "23/24"]).end_defects("clamped")]
        ['0', '0', '0', '-19/720']
        """
        return end_defects(*self._quadrature(kind))

    def _quadrature(self, kind: str) -> tuple[Fraction, list[tuple[Fraction, Fraction]]]:
        """Return where the first hinge is, in segments from the end, and the weights from there."""
        weights = self._weights_at(kind)
        first = self.stub
        if kind not in ("clamped", "guided") and self.stub != _HALF:
            # No hinge at the end: the next is a segment away, unless f = 0 there; then the trapezoid's is.
            first = Fraction(kind == "carried")
            weights = weights if kind == "carried" else (Weight(_HALF),)
        return first, [(weight.constant, weight.per_segment) for weight in weights]

    def _weights_at(self, kind: str) -> tuple[Weight, ...]:
        return {"clamped": self.clamped, "guided": self.guided, "carried": self.carried}.get(kind, ())

    def end_weights(self, end: End) -> tuple[Weight, ...]:
        """Return the weights that this rule prescribes at `end`, the end's own hinge first."""
        return self._weights_at(end.statics)

    def piece_lengths(self, boundary: Boundary, segments: int) -> list[Fraction]:
        """Return the pieces' lengths in segments, left to right.

        An end that can bend the beam acts on a piece of its own: of length zero where the hinge is at
        the wall. An end without moment (pinned, free, a point mass) acts on the outermost rod.
        """
        one, pair, count = Fraction(1), Boundary.of(boundary), _segments(segments)
        if self.stub == _HALF:
            return [_HALF, *[one] * (count - 1), _HALF]
        at_wall = [] if self.stub else [Fraction(0)]
        left = at_wall if pair.left.statics in ("clamped", "guided") else []
        right = at_wall if pair.right.statics in ("clamped", "guided") else []
        return [*left, *[one] * count, *right]

    def hinge_weights(self, boundary: Boundary, segments: int, *, size: int | None = None) -> list[Fraction]:
        """Return the flexibility weights of the chain's hinges, left to right.

        With `size`, end weights that depend on N are those of a chain of so many segments.
        """
        pair, count = Boundary.of(boundary), len(self.piece_lengths(boundary, segments)) - 1
        weights = [Fraction(1)] * count
        # A NumPy integer in a fraction would overflow.
        whole = Fraction(int(segments) if size is None else whole_number("size", size))
        for end, indices in ((pair.left, range(count)), (pair.right, range(count - 1, -1, -1))):
            for j, weight in zip(indices, self.end_weights(end), strict=False):
                weights[j] += weight.at(whole) - 1
        return weights


def _segments(segments: object) -> int:
    return whole_number("segments", segments, most=MAX_PIECES)


def _exact(name: str, value: Exact) -> Fraction:
    """Return a number exactly; text is read without `eval` and bounded, so that none takes long."""
    if isinstance(value, str):
        if not re.fullmatch(r"\s*[+-]?(\d{1,30}(\.\d{0,30})?|\.\d{1,30})(/\d{1,30})?\s*", value):
            raise ValueError(f'{name} must be a number such as 0.375 or "3/8", got {shown(value)}')
        above, _, below = value.partition("/")
        if below and not int(below):
            raise ValueError(f"{name} must be finite, got {shown(value)}")
        return Fraction(above.strip()) / Fraction(below.strip() or 1)
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise TypeError(f'{name} must be a number such as 0.375 or "3/8", got {shown(value)}')
    if isinstance(value, numbers.Rational):
        return Fraction(int(value.numerator), int(value.denominator))
    if not math.isfinite(value):
        raise ValueError(f"{name} must be finite, got {shown(value)}")
    simplest = Fraction(float(value)).limit_denominator(_DENOMINATOR)
    return simplest if float(simplest) == float(value) else Fraction(float(value))


def _weights(name: str, values: Weights) -> tuple[Weight, ...]:
    flat = values.tolist() if isinstance(values, np.ndarray) and values.ndim == 1 else values
    if isinstance(flat, str | bytes) or not isinstance(flat, Sequence):
        raise TypeError(f'{name} must be a sequence of weights, such as ["3/8", "7/6"], got {shown(values)}')
    if len(flat) > MAX_END_WEIGHTS:
        raise ValueError(f"{name} must have at most {MAX_END_WEIGHTS} weights, got {len(flat)}")
    return tuple(_weight(f"{name}[{i}]", value) for i, value in enumerate(flat))


def _weight(name: str, value: Exact | Weight) -> Weight:
    weight = value if isinstance(value, Weight) else Weight(_exact(name, value))
    if not _SMALLEST <= weight.constant <= _LARGEST or abs(weight.per_segment) > _LARGEST:
        raise ValueError(
            f"{name} must be greater than 0 in long chains, and no more than {_LARGEST:g}, got {shown(value)}"
        )
    return weight


def _mirror(stub: Fraction) -> tuple[Weight, ...]:
    """Return a guided end's fewest weights of order 4: d₀ = d₂ = 0, as odd derivatives vanish there."""
    return tuple(map(Weight, {Fraction(0): ("1/2",), _HALF: (), Fraction(1): ("5/3", "5/6")}[stub]))


@lru_cache(maxsize=1024)
def _orders(rule: Rule) -> Mapping[str, int]:
    # Point masses, and any other inertia than a rod's, err in the kinetic energy as q².
    orders = {"inside": HIGHEST_ORDER if rule.rotary_inertia == _ROD else 2}
    for kind in ("clamped", "pinned", "guided", "free", "carried"):
        orders[kind] = end_order(kind, *rule._quadrature(kind))
    return MappingProxyType(orders)


@runtime_checkable
class Layout(Protocol):
    """What a chain needs of a rule, and all it needs: any record that has these four can be passed as `rule`.

    A `Rule` is one. So are the records of `matched` and `axially_corrected`, and a class of your own, where
    springs do not follow a pattern that `Rule` knows. `Chain`, `frequency_error`, `segments_needed`,
    `error_dataset`, `recommend`, `chain_errors` and all that takes a chain take any; its frequencies are
    solved one chain at a time. `chain_frequency` and `error_law` have closed forms, which need the weights of
    a `Rule` (or of `mode_tuned`); so does `derivation`, which needs them as exact numbers.

    Examples
    --------
    Simpson's rule: weights 1/3, 4/3, 2/3, 4/3, ..., 1/3 for an even number of segments.

    >>> class Simpson:
    ...     name, rotary_inertia = "simpson", Fraction(1, 12)
    ...     def piece_lengths(self, boundary, segments):
    ...         return Rule("any", ["1/2"]).piece_lengths(boundary, segments)
    ...     def hinge_weights(self, boundary, segments):
    ...         return [Fraction(2 + 2 * (j % 2), 3 + 3 * (j == 0)) for j in range(segments)]
    >>> from beammodes.accuracy.errors import frequency_error
    >>> errors = [frequency_error("clamped-free", segments=10, mode=n, rule=Simpson()) for n in (1, 2, 3)]
    >>> [f"{100 * e:.4f} %" for e in errors]
    ['-0.0002 %', '-0.0005 %', '0.0285 %']
    """

    @property
    def name(self) -> str:
        """How errors and tables name it."""

    @property
    def rotary_inertia(self) -> Fraction:
        """Central rotary inertia of a piece over its mass times length²."""

    def piece_lengths(self, boundary: Boundary, segments: int) -> list[Fraction]:
        """Return the pieces' lengths in segments, left to right."""

    def hinge_weights(self, boundary: Boundary, segments: int) -> Sequence[Fraction | float]:
        """Return the flexibility weights of the chain's hinges, left to right."""


@runtime_checkable
class RuleMaker(Protocol):
    """A record that makes a different rule for each boundary, such as `mode_tuned` gives."""

    def rule_for(self, boundary: Boundary) -> Rule:
        """Return the rule for a boundary."""
