"""What springs, supports and loads do to a chain's pieces, for any algebra: their work and their forces."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from beammodes.chains.chain import Chain, Number
from beammodes.equations.axial_pull import hub_load
from beammodes.equations.coordinates import moving_pieces, tip_names, unpack
from beammodes.problem.loading import Load, checked_load

__all__ = ["Algebra", "LoadField", "static_forces", "support_units"]


@dataclass(frozen=True)
class Algebra:
    """What the physics needs of a number system: constants, sine and cosine, and the chain's three units."""

    number: Callable[[Number], Any]
    sin: Callable[[Any], Any]
    cos: Callable[[Any], Any]
    length: Any
    mass: Any
    stiffness: Any


@dataclass(frozen=True)
class LoadField:
    """A load in the units of an algebra.

    Attributes
    ----------
    axial, moment : value
        The axial force and the moment on the right tip.
    tip, weight : pair of values
        Force on the right tip, acceleration of gravity.
    square_rate, hub, lag
        Ω², the hub's radius, and whether the chain moves in the plane of rotation.
    idle : bool
        Whether there is no load at all.
    """

    axial: Any
    moment: Any
    tip: tuple[Any, Any]
    weight: tuple[Any, Any]
    square_rate: Any
    hub: Any
    lag: bool
    idle: bool

    @classmethod
    def of(cls, chain: Chain, load: Load | None, algebra: Algebra) -> LoadField:
        """Return the load of a chain; raises ValueError if nothing holds the chain's left end against it."""
        given = checked_load(load)
        units, number = chain.exact_units, algebra.number
        force = algebra.stiffness / algebra.length
        acceleration = force / algebra.mass
        return cls(
            number(units.force(given.axial_force)) * force,
            number(units.moment(given.tip_moment)) * algebra.stiffness,
            (number(units.force(given.tip[0])) * force, number(units.force(given.tip[1])) * force),
            (
                number(units.acceleration(given.weight[0])) * acceleration,
                number(units.acceleration(given.weight[1])) * acceleration,
            ),
            number(units.square_rate(given.spin_rate)) * acceleration / algebra.length,
            number(units.body(0, 0, given.hub_radius)[2]) * algebra.length,
            given.plane == "lag",
            not (given.axial_force or given.needs_hub),
        )

    def work(self, mass: Any, inertia: Any, x: Any, y: Any, cosine: Any) -> Any:
        """Return the work of gravity and centrifugal force on a piece with its centre of mass at (x, y)."""
        if self.idle:
            return 0
        spread = mass * y**2 if self.lag else inertia * cosine**2
        turning = self.square_rate / 2 * (mass * (self.hub + x) ** 2 + spread)
        return mass * (self.weight[0] * x + self.weight[1] * y) + turning

    def forces(self, mass: Any, x: Any, y: Any) -> tuple[Any, Any]:
        """Return the force of gravity and spin on a piece with its centre of mass at (x, y)."""
        outward = y if self.lag else 0
        return (
            mass * (self.weight[0] + self.square_rate * (self.hub + x)),
            mass * (self.weight[1] + self.square_rate * outward),
        )


def static_forces(
    chain: Chain, q: Sequence[Any], algebra: Algebra, load: Load | None
) -> tuple[Any, Any, list[Any]]:
    """Return the right tip's position, and  ∂V/∂q  of hinge springs, supports and loads.

    With F_i on the centre of mass of piece i, P_i the sum of all forces beyond it and n_i its normal, loads
    do  n_i · (c_i F_i + l_i P_i)  to its angle.
    """
    hub_load(chain, checked_load(load))
    number, tips, angles = algebra.number, *unpack(chain, q)
    zero, field, units = number(0), LoadField.of(chain, load, algebra), support_units(chain, algebra)
    moments = _spring_moments(chain, angles, algebra)
    (left, left_turning), (right, right_turning) = units
    moments[0] += left_turning * angles[0]
    moments[-1] += right_turning * angles[-1] - field.moment
    (x, y), centres = tips, []
    for length, centre, angle in zip(chain.piece_length, chain.piece_centre, angles, strict=True):
        cosine, sine = algebra.cos(angle), algebra.sin(angle)
        arm, reach = number(centre) * algebra.length, number(length) * algebra.length
        centres.append((x + arm * cosine, y + arm * sine, cosine, sine, arm, reach))
        x, y = x + reach * cosine, y + reach * sine
    across, along = field.axial + field.tip[0], field.tip[1] - right * y
    if not field.idle or 0 < chain.supports[1][0] < math.inf:
        for i in range(chain.pieces - 1, -1, -1):
            cx, cy, cosine, sine, arm, reach = centres[i]
            mass = number(chain.piece_mass[i]) * algebra.mass
            fx, fy = field.forces(mass, cx, cy)
            moments[i] += sine * (arm * fx + reach * across) - cosine * (arm * fy + reach * along)
            if not field.lag:
                inertia = number(chain.piece_rotary_inertia[i]) * algebra.mass * algebra.length**2
                moments[i] += field.square_rate * inertia * sine * cosine
            across, along = across + fx, along + fy
    forces = {"x_0": zero, "y_0": left * tips[1] - along}
    return x, y, [*(forces[name] for name in tip_names(chain)), *(moments[i] for i in moving_pieces(chain))]


def _spring_moments(chain: Chain, angles: Sequence[Any], algebra: Algebra) -> list[Any]:
    moments: list[Any] = [algebra.number(0)] * chain.pieces
    for j, stiffness in enumerate(chain.hinge_stiffness):
        moment = algebra.number(stiffness) * algebra.stiffness * (angles[j + 1] - angles[j])
        moments[j] -= moment
        moments[j + 1] += moment
    return moments


def support_units(chain: Chain, algebra: Algebra) -> list[tuple[Any, Any]]:
    """Return K_t and K_r of both ends, zero where an end holds and no motion feels its stiffness."""
    translation = algebra.stiffness / algebra.length**2
    return [
        (
            algebra.number(0 if end[0] == math.inf else end[0]) * translation,
            algebra.number(0 if end[1] == math.inf else end[1]) * algebra.stiffness,
        )
        for end in chain.supports
    ]
