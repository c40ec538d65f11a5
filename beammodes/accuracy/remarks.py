"""Remarks on one error: where a rule does worse than its order promises, and which does better."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from beammodes.accuracy.errors import frequency_error
from beammodes.chains.rules import RULES, AnyRule, Layout, Rule, RuleMaker, axially_corrected, layout_of
from beammodes.checks import percent, whole_number
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike, End
from beammodes.problem.loading import Load, checked_load

__all__ = ["error_remarks"]

#: Errors above this are said to be coarse.
COARSE = 0.1

# In chains longer than so many times the mode, plus this, a rule of higher order for the same pieces wins:
# measured, and tested up to mode 6; the look-up of all rules costs a fifth of a second.
_PER_MODE, _MORE = 4, 4

# How far the shortest chain with positive springs is sought.
_FAR = 1000


def error_remarks(
    boundary: BoundaryLike,
    *,
    segments: int,
    mode: int,
    rule: AnyRule = "mitiguy",
    load: Load | None = None,
    beam: Beam | None = None,
) -> tuple[str, ...]:
    """Return remarks on one `frequency_error`, one sentence each.

    A rule can turn from best to worst: where its end corrections do not fit into a short chain, near the
    chain's last modes, under load, which leaves every rule order 2 at best, and where springs would not be
    positive. And a body at an end sits behind a hinge of its own or on the last segment, which are two
    chains. Each is looked up, not guessed: other rules are named with their errors.

    Parameters
    ----------
    boundary, segments, mode, rule, load, beam
        As for `frequency_error`, one of each.

    Returns
    -------
    tuple of str
        Empty where there is nothing to say.

    Raises
    ------
    TypeError, ValueError
        As `frequency_error`.

    Examples
    --------
    >>> import beammodes as bm
    >>> bm.error_remarks("clamped-free", segments=10, mode=1, rule="gregory")
    ()
    >>> for remark in bm.error_remarks("clamped-free", segments=2, mode=2, rule="gregory"):
    ...     print(remark)
    coarse: the mode is too near the chain's last, where every rule is wrong
    the end corrections of gregory need at least 3 hinges: with 2 they are cut short
    mitiguy, of lower order and with the same pieces, errs less here: -24.92 %
    """
    pair, count, number = (
        Boundary.of(boundary),
        whole_number("segments", segments),
        whole_number("mode", mode),
    )
    layout, pull = layout_of(rule), checked_load(load)
    record = layout.rule_for(pair) if isinstance(layout, RuleMaker) else layout
    case = _Case(pair, count, number, pull, beam)
    error = case.error(layout)
    if math.isnan(error):
        return tuple(_missing(record, case))
    return (
        *_coarse(record, case, error),
        *_short(record, case, error),
        *_loaded(record, case, error),
        *_bodies(record, case),
    )


class _Case:
    """One mode of one chain under one load."""

    def __init__(self, pair: Boundary, segments: int, mode: int, load: Load, beam: Beam | None) -> None:
        self.pair, self.segments, self.mode, self.load, self.beam = pair, segments, mode, load, beam

    def error(self, rule: AnyRule, pair: Boundary | None = None) -> float:
        """Return e of a rule, and of other ends if given."""
        return float(
            frequency_error(
                pair or self.pair,
                segments=self.segments,
                mode=self.mode,
                rule=rule,
                load=self.load,
                beam=self.beam,
            )
        )


def _missing(record: Layout, case: _Case) -> Iterator[str]:
    def positive(segments: int) -> bool:
        # Weights of long chains are positive: `Rule` asks that of their constant parts.
        return segments > _FAR or min(record.hinge_weights(case.pair, segments), default=1) > 0

    try:
        if positive(case.segments):
            yield "the chain has no such mode"
            return
        first = next((n for n in range(case.segments + 1, _FAR) if positive(n)), None)
    except ValueError as error:
        yield str(error)
        return
    until = f"; it has from N = {first} on" if first else ""
    yield f"{record.name} has no positive springs for {case.pair.name} with {case.segments} segments{until}"


def _coarse(record: Layout, case: _Case, error: float) -> Iterator[str]:
    if abs(error) <= COARSE:
        return
    if case.segments <= 3 * case.mode:
        yield "coarse: the mode is too near the chain's last, where every rule is wrong"
    elif isinstance(record, Rule):
        yield f"coarse: {record.name} has order {record.declared_order(case.pair)} between these ends"


def _short(record: Layout, case: _Case, error: float) -> Iterator[str]:
    """Say that end corrections are cut short or overlap, and which simpler rule is better then."""
    if not isinstance(record, Rule):
        return
    both = [len(record.end_weights(end)) for end in (case.pair.left, case.pair.right)]
    # Every correction fits into a chain this long: no longer one need be laid out.
    hinges = len(record.piece_lengths(case.pair, min(case.segments, _FAR))) - 1
    if max(both) > hinges:
        yield (
            f"the end corrections of {record.name} need at least {max(both)} hinges: "
            f"with {hinges} they are cut short"
        )
    elif sum(both) > hinges:
        yield f"the corrections of both ends overlap: {sum(both)} of {record.name} on {hinges} hinges"
    # Others are looked up where their errors have a closed form and may be smaller.
    short = case.segments <= _PER_MODE * case.mode + _MORE
    if not case.load.is_axial or not (short or case.load != Load()):
        return
    order = record.declared_order(case.pair)
    simpler = [
        rule
        for rule in RULES.values()
        if (rule.stub, rule.rotary_inertia) == (record.stub, record.rotary_inertia)
        and rule.declared_order(case.pair) < order
    ]
    errors = {rule.name: case.error(rule) for rule in simpler}
    known = {name: found for name, found in errors.items() if not math.isnan(found)}
    best = min(known, key=lambda name: abs(known[name]), default="")
    if best and abs(known[best]) < abs(error) / 1.02:
        yield f"{best}, of lower order and with the same pieces, errs less here: {percent(known[best], 4)}"


def _loaded(record: Layout, case: _Case, error: float) -> Iterator[str]:
    """Say what a load leaves of a rule's order, and what springs made for an axial force give back."""
    if case.load == Load() or not isinstance(record, Rule):
        return
    order = record.declared_order(case.pair)
    if order <= 2:
        return
    better = ""
    if case.load.is_axial:
        corrected = case.error(axially_corrected(record, case.load, case.beam))
        if abs(corrected) < abs(error):
            better = f"; springs of axially_corrected: {percent(corrected, 4)}"
    yield f"under load {record.name} has order 2, not {order}{better}"


def _bodies(record: Layout, case: _Case) -> Iterator[str]:
    """Say which of the two chains it is where a body at an end puts a moment on the beam."""
    if getattr(record, "stub", 0):
        return
    for side in ("left", "right"):
        end: End = getattr(case.pair, side)
        if not any(end.moving_body[1:]) or end.holds_rotation:
            continue
        other = replace(case.pair, **{side: replace(end, on_segment=not end.on_segment)})
        found = case.error(record, other) if case.load.is_axial else math.nan
        here, there = "behind a hinge of its own", "on the last segment (on_segment=true)"
        if end.on_segment:
            here, there = "on the last segment", "behind a hinge of its own (on_segment=false)"
        error = "" if math.isnan(found) else f": {percent(found, 4)}"
        yield f"the body at the {side} end is {here}; {there}{error}"
