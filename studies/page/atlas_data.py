"""Data of the page's atlas: errors, springs, steps and lengths of chains."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray

import beammodes as bm
from beammodes.closed_form.chain_frequencies import chain_frequency
from beammodes.problem.motions import unit_beam
from beammodes.vibration.axial_spectrum import highest_axial_frequency
from beammodes.vibration.integrators import stability_limit
from beammodes.vibration.stability import highest_angular_frequency

__all__ = ["LONGEST", "MODES", "SEGMENTS", "TOLERANCES", "atlas", "segments_for"]

#: Largest N drawn, modes, and the largest N that is recommended.
SEGMENTS, MODES, LONGEST = 60, 5, 400
TOLERANCES = (0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0005, 0.0001)
#: The law is shown from the N on from which it is so near to the error, as a fraction of it.
LAW_WITHIN = 0.2
#: N beyond those recommended where the errors are looked at too: smooth there, so some stand for all.
_FAR = np.unique(np.geomspace(LONGEST, 10**6, 120).astype(np.int64))
_DIGITS = 6
#: Instead of the springs of a chain that a rule does not have.
NO_SPRINGS = "none: the rule's pattern does not fit this N"

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Kind:
    """What the atlas shows of one motion: its pairs of ends, what they are in bending, its largest ω.

    Attributes
    ----------
    motion : str
    words : tuple of str
        Of one end, the firmest first.
    pairs : tuple of pairs
    stand_in : callable
        The pair in bending at which a rule lays out hinges as it does for a pair.
    highest : callable
        A chain's largest ω by pair, N and rule.
    """

    motion: str
    words: tuple[str, ...]
    pairs: tuple[Any, ...]
    stand_in: Callable[[Any], bm.Boundary]
    highest: Callable[[Any, int, bm.Rule], float]


@lru_cache(maxsize=1)
def atlas() -> dict[str, Any]:
    """Return everything, as JSON has it; what two rules share on a pair of ends is listed once.

    `motions[motion].chains[pair][rule]` is the number of a chain's record in `records`: errors by N and mode,
    largest ω by N, springs by N (numbers in `springs`), N needed by modes and tolerance (0 beyond `longest`),
    order, coefficients of the law by mode, and from which N on it is within `LAW_WITHIN` of the error.
    """
    records: dict[str, int] = {}
    springs: dict[str, int] = {}
    kept: list[dict[str, Any]] = []
    motions: dict[str, Any] = {}
    for kind in KINDS:
        chains: list[list[int]] = []
        for pair in kind.pairs:
            chains.append([])
            alike: dict[Any, dict[str, Any]] = {}
            for rule in bm.RULES.values():
                # Rules that differ at other ends only make the same chains here.
                texts = _texts(kind, pair, rule)
                layout = (texts, rule.stub, rule.rotary_inertia)
                if layout not in alike:
                    alike[layout] = _record(
                        kind, pair, rule, [springs.setdefault(t, len(springs)) for t in texts]
                    )
                order = (
                    rule.declared_order(pair) if kind.motion == "bending" else alike[layout]["lawOrder"][0]
                )
                record = alike[layout] | {"order": order}
                key = repr(record)
                if key not in records:
                    records[key] = len(kept)
                    kept.append(record)
                chains[-1].append(records[key])
        motions[kind.motion] = {
            "ends": list(kind.words),
            "pairs": [pair.name for pair in kind.pairs],
            "chains": chains,
        }
    return {
        "motions": motions,
        "rules": [
            {
                "name": rule.name,
                "summary": rule.summary,
                "usedBy": rule.used_by,
                "stub": float(rule.stub),
                "rotaryInertia": float(rule.rotary_inertia),
            }
            for rule in bm.RULES.values()
        ],
        "segments": SEGMENTS,
        "modes": MODES,
        "longest": LONGEST,
        "tolerances": list(TOLERANCES),
        "limit": stability_limit("rk4"),
        "springs": list(springs),
        "records": kept,
    }


def _texts(kind: Kind, pair: Any, rule: bm.Rule) -> tuple[str, ...]:
    """Return the springs of every N as the page shows them."""
    whole = kind.stand_in(pair)
    return tuple(
        _springs(rule.hinge_weights(whole, n)) if rule.fits(n) else NO_SPRINGS for n in range(1, SEGMENTS + 1)
    )


def _record(kind: Kind, pair: Any, rule: bm.Rule, springs: list[int]) -> dict[str, Any]:
    segments, mode = np.arange(1, SEGMENTS + 1), np.arange(1, MODES + 1)
    error = bm.frequency_error(pair, segments=segments[:, None], mode=mode, rule=rule, motion=kind.motion)
    if kind.motion == "bending" and rule.has_equal_springs:
        every = chain_frequency(pair, segments[:, None], np.arange(1, SEGMENTS + 2), rule)
        highest = np.nan_to_num(every, nan=0.0).max(axis=1)
    else:
        highest = np.array([kind.highest(pair, int(n), rule) if rule.fits(int(n)) else 0.0 for n in segments])
    laws = [bm.error_law(pair, n, rule, motion=kind.motion) for n in range(1, MODES + 1)]
    return {
        "error": _listed(error),
        "omega": _listed(highest),
        "springs": springs,
        "needed": segments_for(pair, rule, kind.motion).tolist(),
        "lawOrder": [law.order for law in laws],
        "lawFrom": [
            bm.law_holds_from(pair, n, rule, within=LAW_WITHIN, motion=kind.motion)
            for n in range(1, MODES + 1)
        ],
        "law": _listed(np.array([law.coefficient for law in laws])),
    }


def _highest(pair: bm.Boundary, segments: int, rule: bm.Rule) -> float:
    return highest_angular_frequency(bm.Chain(bm.Beam.unit(), pair, segments, rule))


def _highest_twist(pair: bm.AxialBoundary, segments: int, rule: bm.Rule) -> float:
    return highest_axial_frequency(bm.AxialChain(unit_beam(), pair, segments, rule, motion=pair.motion))


#: Stretch is twist again: in multiples of their own both have the same numbers.
KINDS = (
    Kind("bending", tuple(bm.ENDS), tuple(bm.BOUNDARIES), lambda pair: pair, _highest),
    Kind(
        "twist",
        ("fixed", "free"),
        tuple(bm.AxialBoundary.of(name) for name in ("fixed-fixed", "fixed-free", "free-free")),
        lambda pair: pair.stand_in,
        _highest_twist,
    ),
)


def _listed(values: Any) -> Any:
    """Return an array as nested lists of numbers to six digits, None where it has none."""
    if np.ndim(values):
        return [_listed(part) for part in values]
    return None if math.isnan(values) else float(f"{values:.{_DIGITS}g}")


def _springs(weights: Sequence[Fraction]) -> str:
    """Return a row of springs, each 1/w times EI/ell, neighbours that are alike written once."""
    groups = [(1 / weight, len(list(alike))) for weight, alike in groupby(weights)]
    return ", ".join(
        f"{spring}" if count == 1 else f"{count}\u00a0×\u00a0{spring}" for spring, count in groups
    )


def segments_for(pair: Any, rule: bm.Rule, motion: str = "bending") -> NDArray[np.int64]:
    """Return the N from which the first modes stay within a tolerance, 0 beyond 400.

    What `bm.segments_needed` answers one by one, for all at once; shape (modes, tolerances).
    """
    counts = np.concatenate([np.arange(1, LONGEST + 1), _FAR])
    if not rule.has_equal_springs:
        # Each chain is solved: fewer of them, among those that there are.
        counts = np.array([n for n in counts if n <= 2 * SEGMENTS and rule.fits(n)])
    error = np.abs(
        bm.frequency_error(
            pair, segments=counts[:, None], mode=np.arange(1, MODES + 1), rule=rule, motion=motion
        )
    )
    worst = np.maximum.accumulate(np.where(np.isnan(error), np.inf, error), axis=1)
    found = np.zeros((MODES, len(TOLERANCES)), dtype=np.int64)
    for j, tolerance in enumerate(TOLERANCES):
        for i in range(MODES):
            failing = np.flatnonzero(worst[:, i] > tolerance)
            first = failing[-1] + 1 if len(failing) else 0
            enough = counts[first] if first < len(counts) else 0
            found[i, j] = enough if enough <= LONGEST else 0
    return found
