"""The wanted modes of a beam or a rod, motion by motion: how wrong chains are in each, and how fast.

A straight beam bends, twists or stretches; none of these moves another. Nor do the two bendings and the twist
of a rod that is straight, not pretwisted and of even GJ, if its ends do not couple them: each is then judged
as a beam's motion of its own, n-th mode against n-th, however their frequencies lie among each other. All
other rods are judged as a whole, their modes numbered together.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from beammodes.accuracy.errors import frequency_error
from beammodes.chains.axial_chain import AxialChain
from beammodes.chains.chain import Chain
from beammodes.chains.rules import Layout
from beammodes.chains.spatial_chain import SpatialChain
from beammodes.checks import choice, shown, whole_number
from beammodes.exact.axial_theory import axial_modes
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.exact.exact_rod import MOST_ROD_MODES, rod_modes
from beammodes.numerics.arrays import Floats, ratios_less_one
from beammodes.problem.axial_ends import AxialBoundary, AxialEnd
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, End
from beammodes.problem.loading import NO_LOAD, Load
from beammodes.problem.motions import MOTIONS
from beammodes.problem.rod import Rod
from beammodes.problem.rod_ends import RodEnd, RodEnds
from beammodes.vibration.axial_spectrum import highest_axial_frequency, solve_axial_modes
from beammodes.vibration.highest_in_space import highest_in_space
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes
from beammodes.vibration.modes_in_space import spatial_modes
from beammodes.vibration.stability import highest_angular_frequency

__all__ = ["ROD_MOTIONS", "JudgedMotion", "StraightRod", "judged_beam", "judged_rod"]

#: A rod's motions, by the axis about which its section turns: x, y, z.
ROD_MOTIONS = ("twist", "second_bending", "bending")


class JudgedMotion(ABC):
    """Wanted modes that chains are judged by.

    Attributes
    ----------
    exact : ndarray, shape (modes,) [rad/s]
    theory_error : float
        Of the worst of these modes, which no number of segments lowers; NaN where it is not known.
    """

    exact: Floats
    theory_error: float

    @property
    def modes(self) -> int:
        """The number of modes wanted."""
        return len(self.exact)

    @property
    @abstractmethod
    def name(self) -> str:
        """What it is, in a sentence or a table."""

    @property
    def lookup(self) -> dict[str, Any] | None:
        """Arguments of lookups where errors have a closed form, else None."""
        return None

    @property
    def is_smooth(self) -> bool:
        """True if errors change evenly from long chain to longer chain."""
        return True

    @abstractmethod
    def chain(self, record: Layout, segments: int) -> Chain | AxialChain | SpatialChain:
        """Return the chain; raises ValueError where the rule has no positive springs."""

    @abstractmethod
    def frequencies(self, record: Layout, segments: int) -> Floats:
        """Return the chain's frequencies of these modes, fewer if it has fewer; raises as `chain`."""

    @abstractmethod
    def name_of(self, record: Layout, segments: int, mode: int, /) -> str:
        """Return which motion a mode of a chain, counted from 0, is, or is mostly."""

    @abstractmethod
    def highest(self, record: Layout, segments: int) -> tuple[float, str]:
        """Return the chain's highest frequency [rad/s], of wanted motions or not, and which motion it is."""

    def errors(self, record: Layout, segments: int) -> Floats:
        """Return ω_chain/ω - 1, NaN where the chain has no such mode or the rule no springs."""
        try:
            return ratios_less_one(self.frequencies(record, segments), self.exact, self.modes)
        except ValueError:
            # No positive springs for these ends and N, or a pattern that does not fit N.
            return np.full(self.modes, np.nan)


@dataclass(frozen=True, eq=False)
class _OfBeam(JudgedMotion):
    """The first modes of a straight beam in one motion, under the name that it has in a rod."""

    beam: Beam
    boundary: Boundary | AxialBoundary
    exact: Floats
    theory_error: float
    called: str
    rod: StraightRod | None = None
    load: Load = NO_LOAD

    @property
    def name(self) -> str:
        return self.called

    @property
    def motion(self) -> str:
        return self.boundary.motion if isinstance(self.boundary, AxialBoundary) else "bending"

    @cached_property
    def lookup(self) -> dict[str, Any] | None:
        if self.motion != "bending":
            closed = MOTIONS[self.motion].is_uniform(self.beam)
        else:
            closed = self.beam.is_uniform and not self.beam.has_rotary_inertia
        if not closed:
            return None
        loaded = {} if self.load == NO_LOAD else {"load": self.load}
        return {"boundary": self.boundary, "beam": self.beam, "motion": self.motion, **loaded}

    def chain(self, record: Layout, segments: int) -> Chain | AxialChain:
        return _chain(self.beam, self.boundary, record, segments)

    def frequencies(self, record: Layout, segments: int) -> Floats:
        chain = self.chain(record, segments)
        if isinstance(chain, AxialChain):
            return solve_axial_modes(chain, self.modes).angular_frequency
        return solve_modes(linearize(chain, load=self.load), self.modes).angular_frequency

    def errors(self, record: Layout, segments: int) -> Floats:
        if self.lookup is None:
            return super().errors(record, segments)
        mode = np.arange(1, self.modes + 1)
        return np.asarray(frequency_error(segments=segments, mode=mode, rule=record, **self.lookup))

    def name_of(self, _record: Layout, _segments: int, _mode: int, /) -> str:
        return self.name

    def highest(self, record: Layout, segments: int) -> tuple[float, str]:
        if self.rod is None:
            return _highest(self.chain(record, segments), self.load), self.name
        # Bending first, which a round rod has twice.
        every = [
            (_highest(_chain(self.rod.beam(name), boundary, record, segments), NO_LOAD), name)
            for name, boundary in reversed(self.rod.boundaries.items())
        ]
        return max(every, key=lambda found: found[0])


def _chain(
    beam: Beam, boundary: Boundary | AxialBoundary, record: Layout, segments: int
) -> Chain | AxialChain:
    if isinstance(boundary, AxialBoundary):
        return AxialChain(beam, boundary, segments, record, motion=boundary.motion)
    return Chain(beam, boundary, segments, record)


def _highest(chain: Chain | AxialChain, load: Load) -> float:
    if isinstance(chain, AxialChain):
        return highest_axial_frequency(chain)
    return highest_angular_frequency(chain, load=load)


@dataclass(frozen=True, eq=False)
class _OfRod(JudgedMotion):
    """The first modes of a rod in space, bending and twist together."""

    rod: Rod
    ends: RodEnds
    exact: Floats
    theory_error: float

    @property
    def name(self) -> str:
        return "this rod"

    @property
    def is_smooth(self) -> bool:
        return not self.rod.steps

    def chain(self, record: Layout, segments: int) -> SpatialChain:
        return SpatialChain(self.rod, self.ends, segments, record)

    def frequencies(self, record: Layout, segments: int) -> Floats:
        return spatial_modes(self.chain(record, segments), self.modes).angular_frequency

    def name_of(self, record: Layout, segments: int, mode: int, /) -> str:
        chain = self.chain(record, segments)
        turned = np.diff(spatial_modes(chain, self.modes).rotation[mode], axis=0)
        turns = np.einsum("jik,ji->jk", chain.tree.joint_frame[1:], turned)
        springs = np.where(np.isfinite(chain.joint_stiffness), chain.joint_stiffness, 0.0)
        return ROD_MOTIONS[int(np.argmax((springs * turns**2).sum(axis=0)))]

    def highest(self, record: Layout, segments: int) -> tuple[float, str]:
        found = highest_in_space(self.chain(record, segments))
        return found.angular_frequency, ROD_MOTIONS[int(np.argmax(found.shares))]


def judged_beam(
    beam: Beam, boundary: Boundary | AxialBoundary, modes: int, load: Load = NO_LOAD
) -> JudgedMotion:
    """Return the judge of the first modes of a straight beam, of which the boundary tells the motion.

    A load, of bending only, is one that leaves it straight.

    Examples
    --------
    >>> shaft = Beam(1.0, 1.0, 1.0, torsional_stiffness=1.0, polar_inertia_per_length=1.0)
    >>> judge = judged_beam(shaft, AxialBoundary.of("fixed-free"), 2)
    >>> from beammodes.chains.rules import RULES
    >>> judge.errors(RULES["naive"], 10).round(4).tolist()
    [-0.0485, -0.0556]
    """
    return _of_beam(beam, boundary, modes, load=load)


def _of_beam(
    beam: Beam,
    boundary: Boundary | AxialBoundary,
    modes: int,
    called: str = "",
    load: Load = NO_LOAD,
) -> _OfBeam:
    if isinstance(boundary, AxialBoundary):
        exact = axial_modes(beam, boundary, modes, motion=boundary.motion).angular_frequency
        return _OfBeam(beam, boundary, exact, math.nan, called or boundary.motion)
    found = euler_bernoulli(beam, boundary, modes, load=load)
    theory = found.theory_error[~np.isnan(found.theory_error)]
    worst = float(theory[np.argmax(np.abs(theory))]) if len(theory) else math.nan
    return _OfBeam(beam, boundary, found.angular_frequency, worst, called or "bending", load=load)


def judged_rod(rod: Rod, ends: RodEnds, modes: int | Mapping[str, int]) -> list[JudgedMotion]:
    """Return the judges of a rod's wanted modes: its first so many together, or so many of each motion.

    Raises
    ------
    TypeError, ValueError
        If `modes` is neither a number nor numbers by the names of motions, or these are not apart.

    Examples
    --------
    >>> rod = Rod(1.0, 1.0, 1.0, 1.0, 0.01, second_bending_stiffness=4.0)
    >>> [judge.exact.round(3).tolist() for judge in judged_rod(rod, RodEnds.of("clamped-free"), 4)]
    [[15.708], [7.032], [3.516, 22.034]]
    """
    if not isinstance(rod, Rod):
        raise TypeError(f"beam must be a Beam or a Rod, got {shown(rod)}")
    straight = StraightRod(rod, ends)
    if isinstance(modes, Mapping):
        wanted = {
            choice("motion in modes", name, ROD_MOTIONS): whole_number(
                f"modes[{name!r}]", count, most=MOST_ROD_MODES
            )
            for name, count in modes.items()
        }
        if not wanted:
            raise ValueError("modes must name at least one motion, got none")
        if not straight.is_apart:
            raise ValueError(
                "modes must be one number for a rod whose bending and twist are not apart, being curved or "
                "pretwisted or coupled by its ends, or whose torsional stiffness or polar inertia varies, "
                f"got {shown(modes)}"
            )
        missing = [name for name in wanted if name not in straight.boundaries]
        if missing:
            raise ValueError(f"modes must be of motions with inertia, got twist of {rod!r}")
    else:
        count = whole_number("modes", modes, most=MOST_ROD_MODES)
        if not straight.is_apart:
            return [_whole(rod, ends, count)]
        every = {name: straight.judge(name, count).exact for name in straight.boundaries}
        last = np.sort(np.concatenate([*every.values()]))[count - 1]
        wanted = {name: int((exact <= last).sum()) for name, exact in every.items()}
    return [straight.judge(name, wanted[name]) for name in ROD_MOTIONS if wanted.get(name)]


def _whole(rod: Rod, ends: RodEnds, count: int) -> JudgedMotion:
    plain = rod.unstretched
    exact, theory = rod_modes(plain, ends, count).angular_frequency, math.nan
    if plain is not rod:
        errors = rod_modes(rod, ends, count).angular_frequency / exact - 1.0
        theory = float(errors[np.argmax(np.abs(errors))])
    return _OfRod(rod, ends, exact, theory)


@dataclass(frozen=True, eq=False)
class StraightRod:
    """A rod as three beams, each of one motion, where it is so."""

    rod: Rod
    ends: RodEnds

    @cached_property
    def boundaries(self) -> dict[str, Boundary | AxialBoundary]:
        """Ends of each motion that has inertia."""
        pair = (self.ends.left, self.ends.right)
        found: dict[str, Boundary | AxialBoundary] = {}
        if self.rod.polar_inertia_per_length != 0.0:
            left, right = (AxialEnd(end.rotational_stiffness[0], end.rotary_inertia[0][0]) for end in pair)
            found["twist"] = AxialBoundary(left, right)
        for name, axis in (("second_bending", 1), ("bending", 2)):
            found[name] = Boundary(_planar(pair[0], axis, -1), _planar(pair[1], axis, 1))
        return found

    @property
    def is_apart(self) -> bool:
        """True if no motion moves another, and each is a beam's.

        Where GJ varies, a rule's springs in twist are in space as in bending, and not those of a shaft.
        """
        pair, twisting = (
            (self.ends.left, self.ends.right),
            (self.rod.torsional_stiffness, self.rod.polar_inertia_per_length),
        )
        massless = self.rod.polar_inertia_per_length == 0.0
        if self.rod.curvature != (0.0, 0.0, 0.0) or not all(isinstance(value, float) for value in twisting):
            return False
        return not any(
            0.0 < end.translational_stiffness[0] < math.inf
            or end.on_segment
            or any(end.offset[1:])
            or (np.array(end.rotary_inertia) - np.diag(np.diagonal(end.rotary_inertia))).any()
            or (massless and end.rotary_inertia[0][0] > 0.0)
            for end in pair
        )

    def judge(self, name: str, modes: int) -> _OfBeam:
        """Return the judge of the first modes of one motion."""
        return replace(_of_beam(self.beam(name), self.boundaries[name], modes, name), rod=self)

    def beam(self, name: str) -> Beam:
        """Return the beam that has the numbers of one motion."""
        rod = self.rod
        if name == "twist":
            return Beam(
                rod.length,
                rod.bending_stiffness,
                rod.mass_per_length,
                torsional_stiffness=rod.torsional_stiffness,
                polar_inertia_per_length=rod.polar_inertia_per_length,
            )
        second = "second_" * (name != "bending")
        return Beam(
            rod.length,
            getattr(rod, second + "bending_stiffness"),
            rod.mass_per_length,
            getattr(rod, second + "rotary_inertia_per_length"),
            shear_stiffness=getattr(rod, second + "shear_stiffness"),
        )


def _planar(end: RodEnd, axis: int, side: int) -> End:
    return End(
        translational_stiffness=end.translational_stiffness[3 - axis],
        rotational_stiffness=end.rotational_stiffness[axis],
        mass=end.mass,
        rotary_inertia=end.rotary_inertia[axis][axis],
        offset=side * end.offset[0],
    )
