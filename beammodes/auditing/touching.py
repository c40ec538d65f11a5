"""Solids of a chain that touch each other, or the ground's, where nothing switches their contact off.

MuJoCo makes no contact between a body and the one that it is jointed to, unless that is the ground. All
other pairs touch if their solids overlap, such as both sides of a small link that only joins two hinges, or
capsules whose round caps reach past a short segment. What touches holds a chain as it holds no beam.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from beammodes.auditing.body_tree import Model, ModelBody, Shape
from beammodes.auditing.serial_chains import HingeLine, HingePath
from beammodes.numerics.arrays import Floats

__all__ = ["touching_remark"]

#: Solids that share less than this part of the chain's mean spacing only meet at a face.
_MEET = 1e-6
_LISTED = 3
#: So many pairs that touch, and comparisons, are enough.
_MOST_PAIRS, _MOST_COMPARED = 100, 100_000


def touching_remark(model: Model, path: HingePath, line: HingeLine) -> str:
    """Return which bodies of a chain touch at rest, by the boxes around their solids; empty if none do."""
    names: dict[frozenset[str], str] = {}
    for one, other in _touching(model, path, line):
        names.setdefault(frozenset((one, other)), f"{one} and {other}")
        if len(names) > _MOST_PAIRS:
            break
    if not names:
        return ""
    listed = list(names.values())[:_LISTED]
    more = f" and {len(names) - _LISTED} more pairs" if len(names) > _LISTED else ""
    more = " and many more pairs" if len(names) > _MOST_PAIRS else more
    return (
        f"contact is left out here: {', '.join(listed)}{more} overlap at rest and nothing excludes it "
        "(contype, <exclude>), so that it may hold the chain as it holds no beam"
    )


@dataclass(frozen=True, eq=False)
class _Placed:
    """A shape's ranges along the chain, across it and along its axis of bending; whose it is."""

    low: Floats
    high: Floats
    shape: Shape
    body: ModelBody | None
    of_chain: bool

    @property
    def name(self) -> str:
        return "the ground" if self.body is None else self.body.name


def _touching(model: Model, path: HingePath, line: HingeLine) -> Iterator[tuple[str, str]]:
    chain = [body for group in path.groups for body in group.bodies]
    ids = {id(body) for body in chain}
    directions = np.array([line.along, line.across, line.axis])

    def placed(shape: Shape, body: ModelBody | None) -> _Placed:
        middle = directions @ (shape.middle - line.origin)
        reach = np.abs(directions @ shape.half).sum(axis=1)
        return _Placed(middle - reach, middle + reach, shape, body, id(body) in ids)

    solids = [placed(shape, body) for body in model.bodies for shape in body.shapes]
    planes = [(shape, shape.normal) for shape in model.ground if shape.normal is not None]
    solids += [placed(shape, None) for shape in model.ground if shape.normal is None]
    least = _MEET * (line.spacing or float(np.linalg.norm(solids[0].high - solids[0].low) if solids else 1.0))
    for each in solids:
        for plane, normal in planes if each.of_chain else ():
            height = normal @ (each.shape.middle - plane.middle) - np.abs(normal @ each.shape.half).sum()
            if height < -least and _meet(each.shape, plane):
                yield each.name, "the ground"
    if not solids:
        return
    solids.sort(key=lambda solid: float(solid.low[0]))
    low, high = (np.array([getattr(solid, name) for solid in solids]) for name in ("low", "high"))
    left = _MOST_COMPARED
    for i, each in enumerate(solids):
        if not each.of_chain:
            continue
        before = np.searchsorted(low[:, 0], each.high[0] - least)
        beside = np.flatnonzero(high[:before, 0] > each.low[0] + least)
        shared = np.minimum(high[beside], each.high) - np.maximum(low[beside], each.low)
        for k in beside[(shared > least).all(axis=1)].tolist():
            left -= 1
            # Of two of the chain, the later one finds the earlier.
            if left > 0 and (k < i or not solids[k].of_chain) and _may_touch(model, each, solids[k]):
                yield solids[k].name, each.name


def _may_touch(model: Model, one: _Placed, other: _Placed) -> bool:
    """Return True unless a rule of MuJoCo or the file excludes contact of two shapes."""
    if not _meet(one.shape, other.shape) or frozenset((one.name, other.name)) in model.apart:
        return False
    (own, below), (its, beneath) = (
        (-1, -1) if each.body is None else (each.body.moves_with, each.body.moves_on) for each in (one, other)
    )
    if own == its:
        return False
    jointed = below == its >= 0 or beneath == own >= 0
    return model.neighbours_touch or not jointed


def _meet(one: Shape, other: Shape) -> bool:
    return bool(one.kinds & other.partners or other.kinds & one.partners)
