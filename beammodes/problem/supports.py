"""One end of a beam: what holds it, and the rigid body fixed to it."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from types import MappingProxyType
from typing import Any

from beammodes.checks import choice, real, shown

__all__ = ["ENDS", "NUMBERS_OF_END", "End", "end_from_text"]

#: The numbers of an `End`, in its order.
NUMBERS_OF_END = ("translational_stiffness", "rotational_stiffness", "mass", "rotary_inertia", "offset")
_SUPPORTS = NUMBERS_OF_END[:2]


@dataclass(frozen=True)
class End:
    """One end of a beam: supports of its deflection and rotation, and a rigid body fixed to it.

    With y and θ the end's deflection and rotation and a the offset, it stores and carries

        ½ K_t y² + ½ K_r θ²,        ½ m (y' ± a θ')² + ½ J θ'²    (+ at the right end).

    `ENDS` holds the four special ones: clamped, pinned, guided and free. Numbers given as `Fraction`
    stay exact in the chain.

    Parameters
    ----------
    translational_stiffness : float [N/m]
        K_t of a spring between the end and the ground, across the beam: `math.inf` holds the deflection,
        0 leaves it free.
    rotational_stiffness : float [N m/rad]
        K_r likewise, of the rotation.
    mass : float [kg]
        m of a rigid body fixed to the end. Where the end holds the beam across and the body has no offset,
        its mass is left out, along the beam too: spin and weight do not pull on it, nor does a motion.
    rotary_inertia : float [kg m²]
        J of that body about its centre of mass.
    offset : float [m]
        a, how far beyond the end, along the beam and outward, the body's centre of mass lies.
    on_segment : bool
        Where a chain puts the body and the rotational spring of an end that may turn; the beam is the same.
        False: behind a hinge of the end's own, with the springs of a clamped end. True: on the outermost
        segment itself, without a hinge, as a gripper is welded to a robot's last link. See `statics`.

    Raises
    ------
    TypeError, ValueError
        If a number is not real, is negative (`offset` may be), or is not finite (stiffnesses may be), if
        `on_segment` is not a bool, or is True where the end holds the rotation.

    Examples
    --------
    >>> End(translational_stiffness=math.inf) == ENDS["pinned"]
    True
    >>> print(End(mass=0.5, offset=0.1))
    free(mass=0.5, offset=0.1)
    >>> End(mass=0.5, offset=0.1).statics, End(mass=0.5, offset=0.1, on_segment=True).statics
    ('clamped', 'carried')
    """

    translational_stiffness: float | Fraction = 0.0
    rotational_stiffness: float | Fraction = 0.0
    mass: float | Fraction = 0.0
    rotary_inertia: float | Fraction = 0.0
    offset: float | Fraction = 0.0
    on_segment: bool = field(default=False, kw_only=True)

    def __post_init__(self) -> None:
        for name in NUMBERS_OF_END:
            value = getattr(self, name)
            held = name.endswith("stiffness") and isinstance(value, float) and value == math.inf
            number = math.inf if held else real(name, value)
            if value and not number:
                raise ValueError(f"{name} must be within the range of floats, got {shown(value)}")
            if number < 0.0 and name != "offset":
                raise ValueError(f"{name} must not be negative, got {shown(value)}")
            # A minus sign on zero would make two names of one end.
            kept = value if isinstance(value, Fraction) else number + 0.0
            object.__setattr__(self, name, kept)
        if not isinstance(self.on_segment, bool):
            raise TypeError(f"on_segment must be True or False, got {shown(self.on_segment)}")
        if self.on_segment and self.holds_rotation:
            raise ValueError(
                "on_segment must be False where the end holds the rotation, got True: the rule rigid_stub "
                "holds the outermost segment itself"
            )

    @property
    def holds_deflection(self) -> bool:
        """Whether the end's deflection is zero."""
        return self.translational_stiffness == math.inf

    @property
    def holds_rotation(self) -> bool:
        """Whether the end's rotation is zero."""
        return self.rotational_stiffness == math.inf

    @property
    def is_elastic(self) -> bool:
        """Whether a spring neither holds the end nor leaves it free."""
        return any(0 < k < math.inf for k in (self.translational_stiffness, self.rotational_stiffness))

    @property
    def is_grounded(self) -> bool:
        """Whether anything ties the end to the ground, so that it also holds the beam along its axis."""
        return self.translational_stiffness > 0 or self.rotational_stiffness > 0

    @property
    def moving_body(self) -> tuple[float | Fraction, float | Fraction, float | Fraction]:
        """Mass, rotary inertia and offset as far as the supports let them move, else zeros."""
        mass, inertia, offset = self.mass, self.rotary_inertia, self.offset
        if self.holds_rotation:
            return (0.0, 0.0, 0.0) if self.holds_deflection else (mass, 0.0, 0.0)
        if self.holds_deflection and not offset:
            return 0.0, inertia, 0.0
        return mass, inertia, offset if mass else 0.0

    @property
    def word(self) -> str | None:
        """Clamped, pinned, guided or free if the end is no more than that, else None."""
        return None if self.is_elastic or any(self.moving_body) else self._held

    @property
    def statics(self) -> str:
        """The word whose rule applies here: by what the beam can feel at this end.

        ========  =======================================  ==========================================
        word      what the beam feels                      what a chain has there
        ========  =======================================  ==========================================
        pinned    no moment, the deflection held           no hinge at the end
        free      no moment, the deflection not held       no hinge at the end
        guided    the rotation held, no shear force        the rule's guided weights
        clamped   everything else                          a hinge at the end, the rule's clamped weights
        carried   as clamped, but `on_segment`             no hinge at the end, the rule's carried weights
        ========  =======================================  ==========================================

        So a rotational stiffness or a rotary inertia that goes to zero, behind a hinge of its own, leaves a
        jump. The wall's spring, in series with what vanishes, follows continuously; the other
        springs that a rule changes near an end do not, so `gregory` jumps by about its own error (2.5e-5 in
        the first frequency of ten segments) and other corrected rules by theirs. And as an inertia vanishes
        on its wall spring, the chain's highest frequency grows beyond bounds and its stable time step falls
        to zero.
        With `on_segment` there is no jump, no additional hinge and no additional frequency: as the inertia
        and the offset vanish, the chain becomes that of a point mass. Its price is the moment that the body
        puts on the end: no hinge stands for the last half segment there. A body whose moment acts like its
        inertia force at less than about one segment beyond the end (a box that is smaller than a segment)
        is served well; for a flywheel the error is of order 1, and a hinge of its own is better. At N = 12,
        over clamped, pinned and free other ends and masses of 0.001 to 10 ρA L, the largest error of
        `gregory` in three modes is 0.07 % on the segment and 0.5 % behind a hinge for an inertia of 1e-6
        ρA L³, but 13 and 0.2 % for 1e-2: so a hinge of its own is the default.
        As the translational spring of a guided end vanishes the wall's spring jumps to the guided one: up
        to there the error has the rule's order at clamped ends.
        """
        mass, inertia, offset = self.moving_body
        if not self.rotational_stiffness and not inertia and not (mass and offset):
            return "pinned" if self.holds_deflection else "free"
        if self.on_segment:
            return "carried"
        shearless = self.holds_rotation and not self.translational_stiffness and not mass
        return "guided" if shearless else "clamped"

    @property
    def _held(self) -> str:
        return _WORDS[self.holds_deflection, self.holds_rotation]

    def __str__(self) -> str:
        numbers = [f"{name}={float(getattr(self, name))!r}" for name in NUMBERS_OF_END if self._tells(name)]
        numbers += ["on_segment=true"] if self.on_segment else []
        return f"{self._held}({', '.join(numbers)})" if numbers else self._held

    def _tells(self, name: str) -> bool:
        value: float | Fraction = getattr(self, name)
        return value != 0 and value != math.inf


_WORDS = {(True, True): "clamped", (True, False): "pinned", (False, True): "guided", (False, False): "free"}

#: The four ends, the firmer first: this order makes the canonical names of pairs.
ENDS: Mapping[str, End] = MappingProxyType(
    {
        word: End(math.inf if deflection else 0.0, math.inf if rotation else 0.0)
        for (deflection, rotation), word in _WORDS.items()
    }
)
_ALIASES = {"cantilever": "clamped", "fixed": "clamped", "hinged": "pinned", "sliding": "guided"}


def end_from_text(text: str) -> End | None:
    """Return the end that a word stands for, with numbers in parentheses; None if the word is unknown.

    Raises
    ------
    ValueError
        If what stands in the parentheses is no number of an `End`.

    Examples
    --------
    >>> end_from_text("free(mass=0.5)") == End(mass=0.5)
    True
    """
    match = re.fullmatch(r"\s*([a-z]+)\s*(?:\(([^()]*)\))?\s*", text.lower())
    word = _ALIASES.get(match[1], match[1]) if match else ""
    if match is None or word not in ENDS:
        return None
    held = ENDS[word]
    numbers: dict[str, Any] = {name: getattr(held, name) for name in _SUPPORTS}
    seen: set[str] = set()
    for part in (match[2] or "").split(",") if match[2] else []:
        name, _, value = (piece.strip() for piece in part.partition("="))
        choice("number of an end", name, (*NUMBERS_OF_END, "on_segment"))
        if name in seen:
            raise ValueError(f"{name} of an end must be given once, got {shown(text)}")
        seen.add(name)
        if name in _SUPPORTS and numbers[name]:
            raise ValueError(f"{name} of a {word} end must be left out, got {shown(part.strip())}")
        if name == "on_segment":
            numbers[name] = choice("on_segment", value, ("true", "false")) == "true"
            continue
        try:
            numbers[name] = float(value)
        except ValueError:
            raise ValueError(f"{name} must be a number, got {shown(value)}") from None
    return End(**numbers)
