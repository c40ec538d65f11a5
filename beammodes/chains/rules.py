"""The registry: every discretization rule by name, with its source and its users.

A new rule is one record here: a name and its weights. The order of its error follows from them, and every
figure, table, page and command that shows every rule shows it.

What a rule is, and why its springs are quadrature weights, stands in `beammodes.chains.rules`.
"""

from __future__ import annotations

import math
import numbers
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache
from types import MappingProxyType
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.pieces import MAX_PIECES
from beammodes.checks import Catalogue, Shown, choice, is_text, real, shown, told_fields, whole_number
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike, End
from beammodes.problem.loading import Load, checked_load, load_of

__all__ = [
    "CANCELLED",
    "HIGHEST_ORDER",
    "MAX_END_WEIGHTS",
    "RULES",
    "AnyRule",
    "AxiallyCorrected",
    "Layout",
    "NotClosed",
    "Rule",
    "RuleLike",
    "RuleMaker",
    "Weight",
    "axially_corrected",
    "closed_rule",
    "end_defects",
    "end_order",
    "fits_of",
    "hinges_at_nodes",
    "is_closed",
    "layout_of",
    "rule_named",
]


# The quadrature at a chain's end: what its weights integrate wrongly, and the order that they leave.
#
# A chain's flexibility is the sum of w_j ell f(x_j) over its hinges, a beam's the integral of f = M²/EI.
# Euler and Maclaurin say what is wrong with the sum: nothing inside, and at each end, with h = 1/N, the first
# hinge at x₀ h and the corrections c_j = w_j - 1 of the weights,
#
#     Σ w_j h f(x_j) - ∫ f = Σ_k h^(k+1) d_k f⁽ᵏ⁾(0),
#     d_k = Σ_j c_j x_j^k / k! - B_{k+1}(x₀) / (k+1)!        (B the Bernoulli polynomials).
#
# Weights p_0 ... p_{m-1} that repeat behind the end, of mean 1, are m sums with steps of m h,
#
#     d_k = Σ_j c_j x_j^k / k! - Σ_r p_r m^k B_{k+1}((x₀ + r)/m) / (k+1)!,        c_j = w_j - p_j,
#
# and again nothing is wrong inside: all hinges of one period together have the flexibility of the beam. What
# unequal springs do to the waves between them, which bend in zigzag by h² of their deflection, has order 4.
#
# The first d_k that is not zero, and meets a derivative of f that is not zero at that end, decides the order.

#: Rods and hinges err alike up to this order inside a chain; no end can do better.
HIGHEST_ORDER = 4


#: Terms this small beside their natural size are rounding, or have cancelled.
CANCELLED = 1e-9


#: Derivatives of M² that need not vanish: M is zero at pinned and free ends, M' at guided ones.
_FELT: Mapping[str, tuple[int, ...]] = {
    "clamped": (0, 1, 2, 3),
    "carried": (0, 1, 2, 3),
    "guided": (0, 2),
    "pinned": (2, 3),
    "free": (2, 3),
}


def end_defects(
    first: Fraction,
    weights: Sequence[tuple[Fraction, Fraction]],
    inside: Sequence[Fraction] = (Fraction(1),),
) -> list[tuple[Fraction, Fraction]]:
    """Return  d_k = constant + per_segment/N,  k = 0..3, of a quadrature.

    Parameters
    ----------
    first : Fraction
        x₀, where the first hinge is, in segments from the end.
    weights : sequence of (constant, per_segment)
        Of the hinges nearest the end.
    inside : sequence of Fraction
        The weights that repeat from x₀ on without an end, of which `weights` take the place.

    Examples
    --------
    >>> gregory = [(Fraction(w), Fraction(0)) for w in ("3/8", "7/6", "23/24")]
    >>> [str(constant) for constant, _ in end_defects(Fraction(0), gregory)]
    ['0', '0', '0', '-19/720']
    """
    defects, period = [], len(inside)
    changes = [(w - inside[j % period], slip) for j, (w, slip) in enumerate(weights)]
    for k in range(HIGHEST_ORDER):
        # Each weight that repeats is a sum of its own, with steps of a period.
        constant = -sum(
            (
                w * Fraction(period) ** k * _bernoulli(k + 1, (first + r) / period)
                for r, w in enumerate(inside)
            ),
            Fraction(0),
        ) / math.factorial(k + 1)
        slipped = Fraction(0)
        for j, (change, slip) in enumerate(changes):
            moment = Fraction((first + j) ** k, math.factorial(k))
            constant, slipped = constant + moment * change, slipped + moment * slip
        defects.append((constant, slipped))
    return defects


def end_order(kind: str, defects: Sequence[tuple[Fraction, Fraction]]) -> int:
    """Return the order of the error that an end of that kind leaves with these defects: 1 to 4.

    Examples
    --------
    >>> end_order("clamped", end_defects(Fraction(0), [(Fraction(1, 2), Fraction(0))]))    # f' remains
    2
    """
    powers = [HIGHEST_ORDER]
    for k in _FELT[kind]:
        constant, slipped = defects[k]
        powers += [k + 1] if abs(constant) > CANCELLED else []
        powers += [k + 2] if abs(slipped) > CANCELLED else []
    return min(powers)


def _bernoulli(k: int, x: Fraction) -> Fraction:
    coefficients = _bernoulli_polynomials()[k]
    return sum((c * x**power for power, c in enumerate(coefficients)), Fraction(0))


@lru_cache(maxsize=1)
def _bernoulli_polynomials() -> list[list[Fraction]]:
    """Return the coefficients of B_0 .. B_4, from B_k' = k B_{k-1} and ∫₀¹ B_k = 0."""
    found = [[Fraction(1)]]
    for k in range(1, HIGHEST_ORDER + 1):
        rising = [k * c / (power + 1) for power, c in enumerate(found[-1])]
        mean = sum((c / (power + 2) for power, c in enumerate(rising)), Fraction(0))
        found.append([-mean, *rising])
    return found


# Discretization rules: where a chain's hinges sit and how stiff they are, in exact numbers.
#
# A rule cuts a beam of N equal segments of length ell at hinges and gives each hinge a rotational spring
# `EI / (w ell)`. The *flexibility weight* w is 1 inside; near an end whose rotation is held a rule corrects
# it. The weights are the weights of a quadrature: the beam's flexibility is the integral of M²/EI along it,
# the chain's is the sum of w ell M²/EI over its hinges, so a rule is as good as its quadrature at the ends.
#
# Corrections to the weight 1 are *added* from both ends, so a short chain, on which they overlap, needs no
# special case: the third-order end weights of Gregory become Simpson's rules on two and three segments.

#: Errors of rules that change more springs at an end would lose digits: their series run out of terms.
MAX_END_WEIGHTS = 8


#: Weights beyond these are mistakes: their springs would hold like a wall or give way like a hole.
_SMALLEST, _LARGEST = 1e-9, 1e9


#: Floats stand for the simplest fraction that rounds to them, up to this denominator: 1/12 stays 1/12.
_DENOMINATOR = 10**6


_ROD = Fraction(1, 12)


_HALF = Fraction(1, 2)


@dataclass(frozen=True, slots=True, repr=False)
class Weight(Shown):
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

    def _line(self) -> str:
        return f"Weight({', '.join(repr(str(value)) for _, value in told_fields(self))})"

    def at(self, segments: Any) -> Any:
        """Return the weight for N segments, in whatever algebra N belongs to; floats for an array."""
        if hasattr(segments, "dtype"):
            return float(self.constant) + float(self.per_segment) / segments
        return self.constant + self.per_segment / segments


#: What stands for an exact number.
Exact = str | float | Fraction


#: What stands for the weights of the hinges nearest an end.
Weights = Sequence[Exact | Weight] | NDArray[np.floating[Any]]


def _weight_typed(weight: Weight) -> str:
    return repr(weight) if weight.per_segment else repr(str(weight.constant))


@dataclass(frozen=True, init=False, repr=False)
class Rule(Shown):
    """A way to turn a beam into a chain of rigid segments and springs: a name and what distinguishes it.

    Every hinge has a spring `EI / (w ell)`, with the flexibility weight w = 1 but near an end, or the weights
    `inside`, repeated. Weights are given from the end's own hinge inward, as text, numbers, fractions or
    `Weight`. The order of the error follows from them and is not given: see `order`.

    Parameters
    ----------
    name : str
        The word that users type.
    clamped : sequence of weights
        Of the hinges nearest a clamped end, and every end that feels a moment and a shear force
        (`End.statics` says which word applies to an end with springs or a body). At most 8.
    guided : sequence of weights, optional
        Likewise of a guided end. By default those that keep order 4 there with the fewest changes: 1/2 with a
        hinge at the wall, none with half a stub, 5/3 and 5/6 with a welded segment; of a pattern its own.
    carried : sequence of weights, optional
        Likewise of an end whose body is part of the last segment (`End(on_segment=True)`). None by default:
        then light bodies leave no jump. 23/12 and 7/12 suit a body with much rotary inertia, at order 3.
    stub : number, optional
        Length, in segments, of the rigid piece fixed to an end whose rotation is held: 0 puts a hinge
        at the wall, 1/2 puts every hinge at a segment's middle, 1 welds the whole first segment.
    rotary_inertia : number, optional
        Central rotary inertia of a piece over its mass times length²: 1/12 for a rod, 1/4 for point
        masses at its two ends.
    inside : sequence of numbers, optional
        Weights that repeat inside, of mean 1, from the hinge at x = ell on (ell/2 with half a stub). They
        must read the same from both ends, which N decides: `fits` tells for which it holds. Errors of such
        chains are solved, one chain at a time; closed forms need equal springs inside.
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
    >>> simpson = Rule("own", ["1/3"], inside=["4/3", "2/3"])
    >>> [str(w) for w in simpson.hinge_weights(Boundary.of("clamped-free"), 4)], simpson.fits(5)
    (['1/3', '4/3', '2/3', '4/3'], False)
    """

    name: str
    clamped: tuple[Weight, ...]
    guided: tuple[Weight, ...]
    carried: tuple[Weight, ...]
    stub: Fraction
    rotary_inertia: Fraction
    inside: tuple[Fraction, ...]
    summary: str = field(compare=False)
    used_by: str = field(compare=False)
    source: str = field(compare=False)

    def _line(self) -> str:
        given = {"clamped": self.clamped, "guided": self.guided}
        given |= {"carried": self.carried} if self.carried else {}
        told = [f"{word}=[{', '.join(map(_weight_typed, weights))}]" for word, weights in given.items()]
        told += [f"stub='{self.stub}'"] if self.stub else []
        told += [f"rotary_inertia='{self.rotary_inertia}'"] if self.rotary_inertia != _ROD else []
        told += [f"inside=[{', '.join(repr(str(w)) for w in self.inside)}]"] if len(self.inside) > 1 else []
        return f"Rule({self.name!r}, {', '.join(told)})"

    def __init__(
        self,
        name: str,
        clamped: Weights,
        guided: Weights | None = None,
        carried: Weights = (),
        stub: Exact = 0,
        rotary_inertia: Exact = _ROD,
        inside: Sequence[Exact] | NDArray[np.floating[Any]] = (1,),
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
        pattern = _pattern(inside)
        values = {
            **texts,
            "clamped": _weights("clamped", clamped),
            "guided": _mirror(length, pattern) if guided is None else _weights("guided", guided),
            "carried": _weights("carried", carried),
            "stub": length,
            "rotary_inertia": inertia,
            "inside": pattern,
        }
        for argument, value in values.items():
            object.__setattr__(self, argument, value)
        if not any(map(self.fits, range(1, len(pattern) + 1))):
            raise ValueError(f"inside must read the same from both ends for some N, got {shown(inside)}")

    def __hash__(self) -> int:
        # Fractions are slow to hash, and rules are keys of caches: names and numerators tell most apart.
        return hash((self.name, *(w.constant.numerator for w in self.clamped)))

    @property
    def has_equal_springs(self) -> bool:
        """True if all springs inside are equal, which closed forms need."""
        return len(self.inside) == 1

    def fits(self, segments: int) -> bool:
        """Say whether the weights inside read the same from both ends of a chain of N segments.

        Examples
        --------
        >>> [n for n in range(1, 9) if RULES["simpson"].fits(n)]
        [2, 4, 6, 8]
        """
        period, far = len(self.inside), int(segments) - (self.stub != _HALF)
        return all(self.inside[j] == self.inside[(far - 1 - j) % period] for j in range(period))

    def repeated(self, first: Fraction, count: int) -> list[Fraction]:
        """Return the weights that `count` hinges would have without an end, the first at x = first.

        Examples
        --------
        >>> [str(weight) for weight in RULES["simpson"].repeated(Fraction(0), 3)]
        ['2/3', '4/3', '2/3']
        """
        start, period = (math.ceil(first) - 1) % len(self.inside), len(self.inside)
        return (list(self.inside) * (count // period + 2))[start : start + count]

    @property
    def _fitting(self) -> str:
        period = len(self.inside)
        over = [n % period for n in range(1, period + 1) if self.fits(n)]
        more = f", or that plus {' or '.join(map(str, over[:-1]))}" if over[1:] else ""
        return f"a multiple of {period}{more}" if 0 in over else f"{over} over a multiple of {period}"

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
        is that of the bare trapezoidal or midpoint sum. See `beammodes.chains.rules`.

        Examples
        --------
        >>> [str(constant) for constant, _ in Rule("own", ["3/8", "7/6", "23/24"]).end_defects("clamped")]
        ['0', '0', '0', '-19/720']
        """
        first, weights = self.stub, self._weights_at(kind)
        if kind not in ("clamped", "guided") and self.stub != _HALF:
            # No hinge at the end: the next is a segment away, unless f = 0 there; then the trapezoid's is.
            first = Fraction(kind == "carried")
            weights = weights if kind == "carried" else (Weight(self.inside[-1] / 2),)
        pairs = [(weight.constant, weight.per_segment) for weight in weights]
        return end_defects(first, pairs, self.repeated(first, len(self.inside)))

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
        one, count = Fraction(1), _segments(segments)
        if self.stub == _HALF:
            return [_HALF, *[one] * (count - 1), _HALF]
        return [one] * count if self.stub else hinges_at_nodes(boundary, count)

    def hinge_weights(self, boundary: Boundary, segments: int, *, size: int | None = None) -> list[Fraction]:
        """Return the flexibility weights of the chain's hinges, left to right.

        With `size`, end weights that depend on N are those of a chain of so many segments.

        Raises
        ------
        ValueError
            If the pattern inside does not fit N.
        """
        lengths, pair = self.piece_lengths(boundary, segments), Boundary.of(boundary)
        if not self.fits(segments):
            raise ValueError(
                f"segments must be {self._fitting} with rule {self.name}, whose springs inside repeat, "
                f"got {segments}"
            )
        count = len(lengths) - 1
        bare = self.repeated(lengths[0], count)
        weights = bare.copy()
        # A NumPy integer in a fraction would overflow.
        whole = Fraction(int(segments) if size is None else whole_number("size", size))
        for end, indices in ((pair.left, range(count)), (pair.right, range(count - 1, -1, -1))):
            for j, weight in zip(indices, self.end_weights(end), strict=False):
                weights[j] += weight.at(whole) - bare[j]
        return weights


def hinges_at_nodes(boundary: BoundaryLike, segments: int) -> list[Fraction]:
    """Return the pieces' lengths in segments of a chain with hinges between segments and at held ends.

    Examples
    --------
    >>> [str(length) for length in hinges_at_nodes("clamped-free", 2)]
    ['0', '1', '1']
    """
    pair = Boundary.of(boundary)
    left, right = ([Fraction(0)] * (end.statics in ("clamped", "guided")) for end in (pair.left, pair.right))
    return [*left, *[Fraction(1)] * _segments(segments), *right]


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
    if is_text(flat) or not isinstance(flat, Sequence):
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


def _pattern(values: Sequence[Exact] | NDArray[np.floating[Any]]) -> tuple[Fraction, ...]:
    weights = _weights("inside", values)
    if any(weight.per_segment for weight in weights):
        raise ValueError(f"inside must be numbers that do not depend on N, got {shown(values)}")
    pattern = tuple(weight.constant for weight in weights)
    if not pattern or sum(pattern) != len(pattern):
        raise ValueError(f"inside must have one or more weights of mean 1, got {shown(values)}")
    return pattern


def _mirror(stub: Fraction, inside: tuple[Fraction, ...]) -> tuple[Weight, ...]:
    """Return a guided end's fewest weights with d₀ = d₂ = 0: odd derivatives vanish there."""
    if stub == _HALF:
        return ()
    if not stub:
        return (Weight(inside[-1] / 2),)
    (d0, _), _, (d2, _), _ = end_defects(stub, (), inside)
    second = (d0 - 2 * d2) / 3
    repeated = (inside * 2)[:2]
    return Weight(repeated[0] - d0 - second), Weight(repeated[1] + second)


@lru_cache(maxsize=1024)
def _orders(rule: Rule) -> Mapping[str, int]:
    # Point masses, and any other inertia than a rod's, err in the kinetic energy as q².
    orders = {"inside": HIGHEST_ORDER if rule.rotary_inertia == _ROD else 2}
    for kind in ("clamped", "pinned", "guided", "free", "carried"):
        orders[kind] = end_order(kind, rule.end_defects(kind))
    return MappingProxyType(orders)


@runtime_checkable
class Layout(Protocol):
    """All that a chain needs of a rule: any record that has these four can be passed as `rule`.

    A `Rule` is one. So are the records of `matched` and `axially_corrected`, and a class of your own, where
    springs do not follow a pattern that `Rule` knows. `Chain`, `frequency_error`, `segments_needed`,
    `error_dataset`, `recommend`, `chain_errors` and all that takes a chain take any; its frequencies are
    solved one chain at a time. `chain_frequency`, `error_law` and `law_holds_from` have closed forms, which
    need the weights of a `Rule` (or of `mode_tuned`).

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
        """Name in errors and tables."""

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


class NotClosed(ValueError):
    """A rule whose springs inside repeat a pattern, where a closed form needs equal ones."""


def closed_rule(rule: RuleLike) -> Rule:
    """Return `rule_named(rule)` for a closed form, which needs equal springs inside.

    Raises
    ------
    TypeError, ValueError
        As `rule_named`, or if the rule's springs inside repeat a pattern.

    Examples
    --------
    >>> closed_rule("naive").name
    'naive'
    """
    record = rule_named(rule)
    if not record.has_equal_springs:
        raise NotClosed(
            f"rule must have equal springs inside for a closed form, got {record.name}: frequency_error and "
            "Chain take any Layout"
        )
    return record


def fits_of(layout: Layout) -> Callable[[int], bool] | None:
    """Return which N a layout's pattern inside fits; None if it has no pattern, so that each does."""
    rule = layout.rule if isinstance(layout, AxiallyCorrected) else layout
    return rule.fits if isinstance(rule, Rule) and not rule.has_equal_springs else None


def is_closed(layout: Layout) -> bool:
    """Say whether a layout's chains have closed forms: those of a `Rule` with equal springs inside."""
    return layout.has_equal_springs if isinstance(layout, Rule) else isinstance(layout, RuleMaker)


def has_roots(layout: Layout) -> bool:
    """Say whether each frequency of its chains is one root to find, under an axial force too.

    So it is of a rule with closed forms, and where its springs are `axially_corrected`.

    Examples
    --------
    >>> [has_roots(RULES[name]) for name in ("gregory", "simpson")]
    [True, False]
    """
    return is_closed(layout.rule if isinstance(layout, AxiallyCorrected) else layout)


RuleLike = str | Rule


AnyRule = str | Layout


def layout_of(rule: AnyRule) -> Layout:
    """Return `rule` if it can lay out a chain, else the rule of that name.

    Raises
    ------
    TypeError, ValueError
        If it is neither; the message lists the names and offers the nearest, or says what a record lacks.

    Examples
    --------
    >>> layout_of("naive").name
    'naive'
    """
    if isinstance(rule, str):
        return rule_named(rule)
    if isinstance(rule, Layout) and not isinstance(rule, type):
        return rule
    needed = ("name", "rotary_inertia", "piece_lengths", "hinge_weights")
    missing = [word for word in needed if isinstance(rule, type) or not hasattr(rule, word)]
    raise TypeError(
        f"rule must be one of {', '.join(RULES)}, or a record that is a Layout, got {shown(rule)}"
        + (f", without {', '.join(missing)}" if len(missing) < len(needed) else "")
    )


def rule_named(rule: RuleLike) -> Rule:
    """Return the rule of that name from `RULES`; a `Rule` is returned as it is.

    Raises
    ------
    TypeError, ValueError
        If it is neither; the message lists the names and offers the nearest.

    Examples
    --------
    >>> rule_named("double_wall").clamped
    (Weight('1/2'),)
    """
    if isinstance(rule, (str, Rule)):
        return rule if isinstance(rule, Rule) else RULES[choice("rule", rule, RULES)]
    if isinstance(rule, Layout) and not isinstance(rule, type):
        raise TypeError(
            f"rule must be a Rule or a name here, whose end weights have a closed form, got {shown(rule)}: "
            "frequency_error and Chain take any Layout"
        )
    return RULES[choice("rule", rule, RULES)]


_RECORDS = (
    Rule(
        name="mitiguy",
        summary="Hinge at the wall with 6N/(3N-1) EI/ell, EI/ell inside: every hinge of a "
        "tip-loaded cantilever deflects exactly as the beam.",
        used_by="the Working Model report",
        source="P. Mitiguy, Flexible beams in Working Model (Knowledge Revolution), "
        "'Assigning Spring Constants', its two labels exchanged",
        clamped=(Weight("1/2", "-1/6"),),
    ),
    Rule(
        name="double_wall",
        summary="Hinge at the wall with 2 EI/ell, EI/ell inside: exact under an end moment.",
        used_by="chains with the central-difference clamp",
        source="trapezoidal weights of the flexibility integral",
        clamped=("1/2",),
    ),
    Rule(
        name="naive",
        summary="Hinge at the wall with EI/ell, as everywhere: the wall is twice too soft.",
        used_by="a common first try",
        source="equal springs at all hinges",
        clamped=("1",),
        guided=("1",),
    ),
    Rule(
        name="gregory",
        summary="Hinge at the wall with 8/3 EI/ell, then 6/7 and 24/23 EI/ell, EI/ell inside: "
        "third-order end weights, the clamp's error gone up to 1/N⁴.",
        used_by="nobody yet",
        source="Gregory's third-order end correction of the trapezoidal rule, as flexibilities",
        clamped=(
            "3/8",
            "7/6",
            "23/24",
        ),
    ),
    Rule(
        name="gregory2",
        summary="Hinge at the wall with 12/5 EI/ell, then 12/13 EI/ell, EI/ell inside: two changed "
        "springs, order 3.",
        used_by="nobody yet",
        source="Gregory's second-order end correction of the trapezoidal rule, as flexibilities",
        clamped=(
            "5/12",
            "13/12",
        ),
    ),
    Rule(
        name="simpson",
        summary="Hinge at the wall with 3 EI/ell, then 3/4 and 3/2 EI/ell in turn, for even N: order 4.",
        used_by="nobody yet",
        source="Simpson's rule for the flexibility integral",
        clamped=("1/3",),
        inside=("4/3", "2/3"),
    ),
    Rule(
        name="hencky",
        summary="Massless bars with point masses at the hinges (half at the ends), 2 EI/ell at the wall, "
        "EI/ell inside.",
        used_by="Hencky bar-chain papers",
        source="H. Hencky, Über die angenäherte Lösung von Stabilitätsproblemen im Raum mittels der "
        "elastischen Gelenkkette, Der Eisenbau 11 (1920), with masses",
        clamped=("1/2",),
        rotary_inertia="1/4",
    ),
    Rule(
        name="half_stub",
        summary="Every hinge at the middle of its segment with EI/ell, so that half a segment is rigid "
        "with the wall and half a segment ends the chain.",
        used_by="Simscape lumped flexible beams, rigid finite element method, Modelica",
        source="midpoint weights of the flexibility integral",
        clamped=(),
        guided=(),
        stub="1/2",
    ),
    Rule(
        name="half_stub_corrected",
        summary="The half_stub layout with its first three springs 12/13, 8/7, 24/25 EI/ell: the clamp's "
        "error gone up to 1/N⁴.",
        used_by="nobody yet: a fix for half_stub that moves nothing",
        source="third-order end correction of the midpoint rule",
        clamped=(
            "13/12",
            "7/8",
            "25/24",
        ),
        guided=(),
        stub="1/2",
    ),
    Rule(
        name="rigid_stub",
        summary="The whole first segment rigid with the wall, no spring there, EI/ell at the other hinges.",
        used_by='MuJoCo 3 cables (initial="none"); Adams links attached "rigid" come near it',
        source="N segments, N - 1 hinges",
        clamped=(),
        guided=(),
        stub=1,
    ),
    Rule(
        name="rigid_stub_corrected",
        summary="The rigid_stub layout with its first two springs 12/23 and 12/7 EI/ell, order 3 (5/3 "
        "and 5/6 as flexibilities at a guided end, order 4).",
        used_by="nobody yet: a fix for rigid_stub that moves nothing",
        source="second-order open end correction of the trapezoidal rule",
        clamped=(
            "23/12",
            "7/12",
        ),
        guided=(
            "5/3",
            "5/6",
        ),
        stub=1,
    ),
)


#: Every rule by name, read-only.
RULES: Catalogue[Rule] = Catalogue("rules", {rule.name: rule for rule in _RECORDS})


# Springs corrected for an axial force: the order that it takes from a rule, given back.
#
# Inside a chain under tension T, with t = T ell²/EI,
#
#     ω² (2 + cos q)/3 = 4 k (1 - cos q)² + 2 t (1 - cos q)        (per segment, springs k EI/ell)
#
# The bending term's and the mass's errors cancel to fourth order, the axial term's does not: its lowest is
# t q⁴/12 in ω², as a spring t/12 too stiff would make. So  k = 1 - t/12  takes it away: a hinge spring of
# EI/ell - T ell/12, or EI/ell + P ell/12 under compression P, and every weight is divided by 1 - t/12. Ends
# that bend the beam keep an error of T/N³.


@dataclass(frozen=True, repr=False)
class AxiallyCorrected(Shown):
    """A rule with its springs corrected for one axial force; `axially_corrected` makes it.

    Attributes
    ----------
    rule : Layout
        What is corrected.
    axial_force : Fraction
        T L²/EI, tension positive.
    """

    rule: Layout
    axial_force: Fraction

    def _line(self) -> str:
        return f"<AxiallyCorrected {self.name}>"

    @property
    def name(self) -> str:
        """Of the rule, with the force."""
        return f"{self.rule.name} corrected for T = {float(self.axial_force):.6g} EI/L²"

    @property
    def rotary_inertia(self) -> Fraction:
        """Central rotary inertia of a piece over its mass times length²."""
        return self.rule.rotary_inertia

    def piece_lengths(self, boundary: Boundary, segments: int) -> list[Fraction]:
        """Return the pieces' lengths in segments, left to right."""
        return self.rule.piece_lengths(boundary, segments)

    def spring_factor(self, segments: int) -> Fraction:
        """Return  1 - T ell²/(12 EI),  by which every spring of the rule is multiplied."""
        return 1 - self.axial_force / Fraction(segments) ** 2 / 12

    def hinge_weights(self, boundary: Boundary, segments: int) -> Sequence[Fraction | float]:
        """Return the flexibility weights of the chain's hinges; none positive where T ell² ≥ 12 EI."""
        spring = self.spring_factor(segments)
        if not spring:
            return [Fraction(0)] * len(self.rule.hinge_weights(boundary, segments))
        return [weight / spring for weight in self.rule.hinge_weights(boundary, segments)]

    def declared_order(self, boundary: Boundary) -> int:
        """Return p in e ~ 1/N**p of the frequencies under this axial force."""
        if not isinstance(self.rule, Rule):
            raise TypeError(f"rule must be a Rule to have a declared order, got {shown(self.rule)}")
        ends = {boundary.left.statics, boundary.right.statics}
        return min(self.rule.declared_order(boundary), 3 if "clamped" in ends else 4)


def axially_corrected(rule: AnyRule, load: Load, beam: Beam | None = None) -> AxiallyCorrected:
    """Return a rule with springs that keep its order under an axial force.

        k_j = (EI/ell - T ell/12) / w_j

    Every rule loses its order to an axial force T: at best 2 is left. These springs bring back 4 between
    pinned, guided and free ends, and with `gregory` 3 at clamped ones, where 20 segments of a cantilever at
    half its buckling load are 80 times closer. They suit that one force only.

    Parameters
    ----------
    rule : str, Rule or any Layout
    load : Load
        Its axial force [N].
    beam : Beam
        Uniform, in whose units the force is; `Beam.unit()` if it is a multiple of EI/L².

    Returns
    -------
    AxiallyCorrected
        To pass as `rule`. A chain too short for the force (T ell² ≥ 12 EI) has no positive springs.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, the beam is not uniform, or a load comes without one.

    References
    ----------
    The dispersion relation of a chain under tension; derived here (module's note).

    Examples
    --------
    >>> rule = axially_corrected("gregory", Load(axial_force=-0.5 * 9.8696), Beam.unit())
    >>> [rule.hinge_weights(Boundary.of("pinned-pinned"), 2)[0] < 1]
    [True]
    """
    record, force = layout_of(rule), load_of(load, beam).axial_force
    structure = Beam.unit() if beam is None else beam
    if not isinstance(structure, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    if not structure.is_uniform:
        raise ValueError(f"beam must be uniform for springs corrected for an axial force, got {shown(beam)}")
    stiffness = Fraction(real("bending_stiffness", structure.mean_bending_stiffness))
    return AxiallyCorrected(record, Fraction(force) * Fraction(structure.length) ** 2 / stiffness)
