"""Rods and structures that several test modules take, each written once."""

from __future__ import annotations

import math
from typing import Any

import beammodes as bm

INF = math.inf
UNIT = bm.Beam.unit()

#: Of a thin wire, in units of its own; and of a solid round section of steel, EI/GJ = 1 + ν.
WIRE: dict[str, Any] = {"bending_stiffness": 1.0, "torsional_stiffness": 0.8, "mass_per_length": 1.0}
ROUND: dict[str, Any] = {**WIRE, "torsional_stiffness": 1 / 1.3}

#: Bathe and Bolourchi 1979: a bend of 45 degrees, R = 100, section 1 x 1, E = 1e7, G = E/2.
BEND = bm.Rod.arc(
    math.pi / 4,
    length=25 * math.pi,
    bending_stiffness=1e7 / 12,
    torsional_stiffness=1e7 / 12,
    mass_per_length=1.0,
    polar_inertia_per_length=1 / 6,
    rotary_inertia_per_length=1 / 12,
    second_rotary_inertia_per_length=1 / 12,
)


def ell() -> bm.Structure:
    """Two equal bars at a right angle, one of them clamped."""
    joints = {"foot": bm.Joint(0, 0, "clamped"), "corner": bm.Joint(0, 1), "tip": bm.Joint(1, 1)}
    return bm.Structure(joints, [bm.Member(UNIT, "foot", "corner"), bm.Member(UNIT, "corner", "tip")])


def portal() -> bm.Structure:
    """Fixed feet, three equal bars."""
    joints = {
        "a": bm.Joint(0, 0, "clamped"),
        "b": bm.Joint(0, 1),
        "c": bm.Joint(1, 1),
        "d": bm.Joint(1, 0, "clamped"),
    }
    return bm.Structure(joints, [bm.Member(UNIT, *pair) for pair in ("ab", "bc", "cd")])
