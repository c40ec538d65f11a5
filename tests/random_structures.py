"""Random planar structures: trees and closed frames with supports, bodies, hinges and stations."""

from __future__ import annotations

import math

import numpy as np

import beammodes as bm

INF = math.inf


def stations(rng: np.random.Generator, length: float) -> list[bm.Station]:
    """At most two, at places that no others of a seed have."""
    found = []
    for place in rng.choice([0.31, 0.47, 0.66, 0.83], size=rng.integers(0, 3), replace=False):
        kind, size = rng.integers(0, 5), 10.0 ** rng.uniform(-1.0, 1.0)
        more = {
            0: {"translational_stiffness": INF},
            1: {"translational_stiffness": 20.0 * size, "rotational_stiffness": size},
            2: {"mass": size},
            3: {"mass": size, "rotary_inertia": 0.03 * size, "offset": rng.uniform(-0.1, 0.1)},
            4: {"hinge": rng.choice([0.0, size])},
        }[int(kind)]
        found.append(bm.Station(place * length, **more))
    return found


def structure(seed: int) -> bm.Structure:
    """A structure of one to five members; every third one has a closed loop."""
    rng = np.random.default_rng([16, seed])
    places, pairs = [(0.0, 0.0)], list[tuple[int, int]]()
    for joint in range(1, int(rng.integers(2, 6))):
        start, turn, reach = int(rng.integers(0, joint)), rng.uniform(0.0, 2 * math.pi), rng.uniform(0.5, 1.5)
        places.append((places[start][0] + reach * math.cos(turn), places[start][1] + reach * math.sin(turn)))
        pairs.append((start, joint))
    if seed % 3 == 0 and len(places) > 2:
        pairs += [pair for pair in [(0, len(places) - 1)] if pair not in pairs]
    joints = {}
    for i, (x, y) in enumerate(places):
        size = 10.0 ** rng.uniform(-1.0, 1.0)
        support = [
            "free",
            "free",
            "pinned",
            "clamped",
            (0.0, INF, 0.0),
            (20.0 * size, 0.0, size),
            (INF, INF, 3.0 * size),
        ][int(rng.integers(0, 7))]
        body = [{}, {"mass": size}, {"mass": size, "rotary_inertia": 0.05 * size, "offset": (0.1, -0.2)}]
        joints[f"j{i}"] = bm.Joint(x, y, support, **body[int(rng.integers(0, 3))])
    members = []
    for a, b in pairs:
        length = math.dist(places[a], places[b])
        stiffness, mass = (float(10.0 ** rng.uniform(-1.0, 1.0)) for _ in range(2))
        hinges = [float(rng.choice([INF, INF, INF, 0.0, 2.0])) for _ in range(2)]
        beam = bm.Beam(length, stiffness, mass)
        members.append(bm.Member(beam, f"j{a}", f"j{b}", *hinges, tuple(stations(rng, length))))
    return bm.Structure(joints, members)


#: Joints and members of a two-span beam, a portal, a T and a branched tree; joints on the ground are held.
FRAMES: tuple[tuple[dict[str, tuple[float, float]], tuple[str, ...]], ...] = (
    ({"a": (0, 0), "b": (1, 0)}, ("ab",)),
    ({"a": (0, 0), "b": (0, 1), "c": (1, 1), "d": (1, 0)}, ("ab", "bc", "cd")),
    ({"a": (0, 0), "b": (0, 1), "c": (-1, 1), "d": (1, 1)}, ("ab", "bc", "bd")),
    (
        {"a": (0, 0), "b": (0, 1), "c": (-0.6, 1.8), "d": (0.7, 1.5), "e": (1.6, 1.4), "f": (0.8, 2.5)},
        ("ab", "bc", "bd", "de", "df"),
    ),
)


def frame(seed: int) -> bm.Structure:
    """One of `FRAMES` in turn, of random proportions, beams, supports and bodies."""
    rng = np.random.default_rng([17, seed])
    at, pairs = FRAMES[seed % len(FRAMES)]
    wide, high = rng.uniform(0.5, 2.0, 2)
    places = {name: (wide * x, high * y) for name, (x, y) in at.items()}
    joints = {}
    for name, place in places.items():
        held = place[1] == 0.0
        support = ["clamped", "pinned"][int(rng.integers(0, 2))] if held and len(pairs) != 3 else "clamped"
        body = {"mass": 10.0 ** rng.uniform(-1.0, 1.0), "rotary_inertia": 0.01} if rng.integers(0, 2) else {}
        joints[name] = bm.Joint(*place, support if held else "free", **body)
    members = []
    for a, b in pairs:
        length = math.dist(places[a], places[b])
        stiffness, mass = (float(10.0 ** rng.uniform(-1.0, 1.0)) for _ in range(2))
        inside = [bm.Station(length * rng.uniform(0.3, 0.7), INF)] if len(pairs) == 1 else []
        members.append(bm.Member(bm.Beam(length, stiffness, mass), a, b, stations=tuple(inside)))
    return bm.Structure(joints, members)
