"""What an end of a chain admits, and how it is carried inward over rods and hinges: floats or arrays.

Lengths are counted in segments, and the segment's mass and EI/ell are 1. Behind an end everything answers to
a deflection y and a rotation θ (counted inward from either end) with a force and a moment, by a symmetric
stiffness Z. Where a support holds, Z is infinite; so it is kept as five numbers of which only ratios count,

    d : Z_yy : Z_yθ : Z_θθ : det Z,

the independent minors of the two states that the end admits. All are polynomials in w = ω². A hinge and a
rod only add to them: numbers of one sign where springs and masses are alone, and what cancels where both are
is what the end's own resonance cancels. So the sums of absolute values, which bound the rounding errors, are
the same polynomials at -w.
"""

from __future__ import annotations

from typing import Any, NamedTuple

__all__ = ["EndNumbers", "Plane", "over_hinge", "over_rod", "plane_at_end"]


class Plane(NamedTuple):
    """An end's stiffness at a section: d : Z_yy : Z_yθ : Z_θθ : det Z."""

    d: Any
    yy: Any
    yt: Any
    tt: Any
    det: Any


class EndNumbers(NamedTuple):
    """Supports and the body of an end in a segment's units; a stiffness is a ratio, 1 : 0 where it holds."""

    force: Any
    give: Any  # K_t = force/give
    moment: Any
    turn: Any  # K_r = moment/turn
    mass: Any
    rotary_inertia: Any
    offset: Any


def plane_at_end(end: EndNumbers, square: Any) -> Plane:
    """Return an end's stiffness at w = `square`.

    Examples
    --------
    >>> plane_at_end(EndNumbers(3.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0), 2.0)     # a spring of 3 less a mass of 1
    Plane(d=1.0, yy=1.0, yt=0.0, tt=0.0, det=0.0)
    """
    force, give, moment, turn, mass, inertia, offset = end
    pull = square * mass
    couple = pull * offset
    twist = square * inertia
    both = give * turn
    return Plane(
        both,
        (force - give * pull) * turn,
        both * couple,
        (moment - turn * (twist + couple * offset)) * give,
        force * moment
        - force * turn * (twist + couple * offset)
        - moment * give * pull
        + both * (pull * twist),
    )


def over_hinge(plane: Plane, flexibility: Any) -> Plane:
    """Carry a plane over a hinge.

    Examples
    --------
    >>> over_hinge(Plane(0.0, 0.0, 0.0, 1.0, 2.0), 0.5)
    Plane(d=0.5, yy=1.0, yt=0.0, tt=1.0, det=2.0)
    """
    d, yy, yt, tt, det = plane
    return Plane(d + flexibility * tt, yy + flexibility * det, yt, tt, det)


def over_rod(plane: Plane, length: Any, pull: Any, twist: Any) -> Plane:
    """Carry a plane over a rod: half of it, its inertia and tension at the middle, the other half.

    `pull` is w m, and `twist` w J - t l of a rod under tension t.

    Examples
    --------
    >>> over_rod(Plane(1.0, 0.0, 0.0, 0.0, 0.0), 2.0, 1.0, 0.25)          # -w (m, m l/2, m l²/4 + J)
    Plane(d=1.0, yy=-1.0, yt=1.0, tt=-1.25, det=0.25)
    """
    d, yy, yt, tt, det = plane
    half = 0.5 * length
    arm = half * yy
    tt = tt - half * (yt + yt - arm)
    yt = yt - arm
    det = det - yy * twist - tt * pull + d * (pull * twist)
    tt = tt - d * twist
    yy = yy - d * pull
    arm = half * yy
    return Plane(d, yy, yt - arm, tt - half * (yt + yt - arm), det)
