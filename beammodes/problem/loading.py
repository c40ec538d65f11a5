"""Loads on a beam while it vibrates, bends or moves."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from beammodes.checks import Shown, choice, real, shown, unwrapped

__all__ = [
    "NO_LOAD",
    "PLANES",
    "Load",
    "Number",
    "Vector",
    "check_unloaded",
    "checked_load",
    "kept_number",
    "load_of",
]

Number = float | Fraction

#: A force or an acceleration: along the beam at rest, and across it.
Vector = tuple[Number, Number]

#: The plane of vibration of a turning beam: that of the rotation, or the one through its axis.
PLANES = ("lag", "flap")


@dataclass(frozen=True, repr=False)
class Load(Shown):
    """Loads on a beam or a chain; numbers given as `Fraction` stay exact.

    Forces are dead: they keep their direction. The axes are those of the beam at rest, x along it and y up. A
    body on an end that holds it across the beam is not felt along it either. Its numbers are in the units of
    the beam it is on; functions that take no chain need that `beam` beside it.

    Parameters
    ----------
    axial_force : float [N]
        T, tension positive: a pair of forces that pull the beam's two ends apart (and not the bodies' centres
        of mass).
    spin_rate : float [rad/s]
        Ω, at which a hub turns with the beam's left end.
    hub_radius : float [m]
        From the axis of rotation to the beam's left end.
    plane : str
        "lag" if the beam moves in the plane of rotation, "flap" out of it, along the axis.
    gravity : float or pair [m/s²]
        Downward, so that 9.81 pulls along -y; or its components (g_x, g_y).
    tip_force : float or pair [N]
        On the right tip, along y; or its components (F_x, F_y).
    tip_moment : float [N m]
        On the right tip, counter-clockwise.

    Raises
    ------
    TypeError, ValueError
        If a number is not real or not finite, a rate or radius is negative, or the plane is unknown.

    Examples
    --------
    >>> Load(gravity=9.81).gravity
    (0.0, -9.81)
    >>> print(Load(spin_rate=6.0, plane="lag"))
    Load(spin_rate=6.0, plane='lag')
    """

    axial_force: Number = 0.0
    spin_rate: Number = 0.0
    hub_radius: Number = 0.0
    plane: str = "flap"
    gravity: Number | Vector = (0.0, 0.0)
    tip_force: Number | Vector = (0.0, 0.0)
    tip_moment: Number = 0.0

    def __post_init__(self) -> None:
        for name in ("axial_force", "spin_rate", "hub_radius", "tip_moment"):
            object.__setattr__(self, name, kept_number(name, getattr(self, name)))
        for name in ("spin_rate", "hub_radius"):
            if getattr(self, name) < 0:
                raise ValueError(f"{name} must not be negative, got {shown(getattr(self, name))}")
        choice("plane", self.plane, PLANES)
        object.__setattr__(self, "gravity", _vector("gravity", self.gravity, -1))
        object.__setattr__(self, "tip_force", _vector("tip_force", self.tip_force, 1))

    @property
    def weight(self) -> Vector:
        """`gravity` as a pair."""
        return self.gravity if isinstance(self.gravity, tuple) else (0.0, self.gravity)

    @property
    def tip(self) -> Vector:
        """`tip_force` as a pair."""
        return self.tip_force if isinstance(self.tip_force, tuple) else (0.0, self.tip_force)

    @property
    def bends(self) -> bool:
        """True if a straight beam is not in equilibrium under it."""
        return bool(self.weight[1] or self.tip[1] or self.tip_moment)

    @property
    def needs_hub(self) -> bool:
        """True if something must hold the beam's left end along its axis."""
        return bool(self.spin_rate or any(self.weight) or any(self.tip) or self.tip_moment)

    @property
    def is_axial(self) -> bool:
        """True if there is no more to it than the axial force."""
        return not self.needs_hub


def checked_load(load: Load | None) -> Load:
    """Return `load`, or no load for None; raise TypeError for anything else."""
    if load is not None and not isinstance(load, Load):
        raise TypeError(f"load must be a Load or None, got {shown(load)}")
    return NO_LOAD if load is None else load


def check_unloaded(load: Load | None) -> None:
    """Raise ValueError if there is a load, for what knows none.

    Examples
    --------
    >>> check_unloaded(Load())
    """
    if checked_load(load) != NO_LOAD:
        raise ValueError(f"load must be left out with a structure, got {shown(str(load))}")


def load_of(load: Load | None, beam: object | None) -> Load:
    """Return `load`, or no load for None; a load needs a beam, in whose units its numbers are.

    Raises
    ------
    TypeError, ValueError
        If there is a load and `beam` is None; the message says both ways to give one.

    Examples
    --------
    >>> load_of(None, None) == Load()
    True
    """
    given = checked_load(load)
    if beam is None and given is not NO_LOAD and given != NO_LOAD:
        raise ValueError(
            f"load must come with a beam, in whose units it is, got {shown(str(given))} alone: add "
            "beam=Beam(L, EI, rhoA), or beam=Beam.unit() if its numbers are multiples of EI/L^2"
        )
    return given


def kept_number(name: str, value: object) -> Number:
    """Return a real number of a load as a float, a `Fraction` as it is; raises as `real` does.

    Examples
    --------
    >>> kept_number("force", Fraction(1, 3)), kept_number("force", -0)
    (Fraction(1, 3), 0.0)
    """
    if callable(value):
        raise TypeError(
            f"{name} must be a number, got {shown(value)}: a TimedLoad is a load times a function of time"
        )
    value = unwrapped(name, value)
    number = real(name, value)
    # A minus sign on zero would make two loads of one.
    return value if isinstance(value, Fraction) else number + 0.0


def _vector(name: str, value: object, sign: int) -> Vector:
    value = unwrapped(name, value)
    value = value.tolist() if isinstance(value, np.ndarray) and value.ndim == 1 else value
    if isinstance(value, tuple | list):
        if len(value) != 2:
            raise ValueError(f"{name} must have two components, got {shown(value)}")
        return kept_number(f"{name}[0]", value[0]), kept_number(f"{name}[1]", value[1])
    return 0.0, kept_number(name, sign * kept_number(name, value))


#: What stands for no load.
NO_LOAD = Load()
