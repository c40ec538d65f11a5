"""The rod: a beam in space that bends in two planes, twists, and need not be straight at rest."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from beammodes.checks import Shown, bounded, part_shown, positive_real, real, real_numbers, shown
from beammodes.deferred import Deferred
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam, PropertyLike, each_place_once, kept_breaks, kept_property
from beammodes.problem.profiles import SAME_PLACE, SAMPLES, Profile, mean_over, profile_breaks
from beammodes.problem.rest_shape import (
    Curvature,
    CurvatureLike,
    CurvatureSteps,
    LineThroughPoints,
    check_turns,
    curvature_at,
    even_parts,
    kept_curvature,
    shape_breaks,
    shape_frames,
)
from beammodes.problem.rod_ends import RodEnds

if TYPE_CHECKING:
    from beammodes.problem import sections
else:
    sections = Deferred("beammodes.problem.sections")

__all__ = ["Rod"]

#: What a rod must have, and what it may leave out, of properties along it; zero or None by default.
_NEEDED = ("bending_stiffness", "torsional_stiffness", "mass_per_length")
_INERTIAS = ("polar_inertia_per_length", "rotary_inertia_per_length", "second_rotary_inertia_per_length")
_OPTIONAL = ("axial_stiffness", "shear_stiffness", "second_shear_stiffness")
#: Turn of a measured line within a 64th of the way between two points [rad]: of more it has a corner there,
#: of which the exact rod's frequencies would not settle.
_SHARPEST = math.radians(15.0)
_ALONG = (*_NEEDED, "second_bending_stiffness", *_INERTIAS, *_OPTIONAL)


@dataclass(frozen=True, slots=True)
class _Constant:
    value: float

    def __call__(self, x: Any) -> Any:
        return np.full_like(x, self.value, dtype=np.float64)


@dataclass(frozen=True, slots=True, init=False, repr=False)
class Rod(Shown):
    """An elastic rod in space, in any consistent set of units: Kirchhoff's, which bends and twists.

    Its section has axes x along the centre line, y and z across. Each property along it is a number, a
    sequence (constant on equal parts), a `Table` or a function, as of `Beam`.

    Parameters
    ----------
    length : float [m]
        L, along the centre line.
    bending_stiffness : property [N m²]
        EI about the section's z axis, in the plane of x and y, as of a planar `Beam`.
    torsional_stiffness : property [N m²]
        GJ about the centre line.
    mass_per_length : property [kg/m]
        ρA; the section's centre of mass is on the centre line.
    polar_inertia_per_length : property [kg m]
        ρI_p, the section's inertia about the centre line; 0 lets twist store energy without inertia.
    second_bending_stiffness : property [N m²], optional
        EI about the y axis, in the plane of x and z; by default as about z.
    rotary_inertia_per_length, second_rotary_inertia_per_length : property [kg m]
        ρI of the section about z and about y, as of Rayleigh's beam; zero by default.
    axial_stiffness, shear_stiffness, second_shear_stiffness : property [N], optional
        EA, and κGA along y and along z. Only the exact rod (`rod_modes`) knows these: a chain neither
        stretches nor shears.
    curvature : three floats [1/m], rows of three, or function of s
        κ = (κ_x, κ_y, κ_z) at rest in the section's axes: pretwist about x, bending about y and z. Zero is a
        straight rod. Several rows are constant on equal parts; a function returns three values.
    breaks : sequence of float [m]
        Positions where a function has a step or a kink, as of `Beam`.

    Raises
    ------
    TypeError, ValueError
        As `Beam`; or if `curvature` is not as above.

    Examples
    --------
    >>> blade = {"bending_stiffness": 1.0, "torsional_stiffness": 2.0, "mass_per_length": 1.0}
    >>> twisted = Rod.pretwisted(math.pi / 2, length=1.0, second_bending_stiffness=16.0, **blade)
    >>> twisted.curvature[0] == math.pi / 2, twisted.is_uniform
    (True, True)
    """

    length: float
    bending_stiffness: Profile
    torsional_stiffness: Profile
    mass_per_length: Profile
    polar_inertia_per_length: Profile
    second_bending_stiffness: Profile
    rotary_inertia_per_length: Profile
    second_rotary_inertia_per_length: Profile
    axial_stiffness: Profile | None
    shear_stiffness: Profile | None
    second_shear_stiffness: Profile | None
    curvature: Curvature

    def __init__(
        self,
        length: float,
        bending_stiffness: PropertyLike,
        torsional_stiffness: PropertyLike,
        mass_per_length: PropertyLike,
        polar_inertia_per_length: PropertyLike = 0.0,
        *,
        second_bending_stiffness: PropertyLike | None = None,
        rotary_inertia_per_length: PropertyLike = 0.0,
        second_rotary_inertia_per_length: PropertyLike = 0.0,
        axial_stiffness: PropertyLike | None = None,
        shear_stiffness: PropertyLike | None = None,
        second_shear_stiffness: PropertyLike | None = None,
        curvature: CurvatureLike = (0.0, 0.0, 0.0),
        breaks: Sequence[float] | NDArray[Any] = (),
    ) -> None:
        whole = positive_real("length", length)
        places = kept_breaks(breaks, whole)
        given = locals()
        object.__setattr__(self, "length", whole)
        for name in (*_NEEDED, *_INERTIAS):
            none = name in _INERTIAS and isinstance(given[name], int | float) and given[name] == 0
            kept = 0.0 if none else kept_property(name, given[name], whole, places)
            object.__setattr__(self, name, kept)
        second = self.bending_stiffness
        if second_bending_stiffness is not None:
            second = kept_property("second_bending_stiffness", second_bending_stiffness, whole, places)
        object.__setattr__(self, "second_bending_stiffness", second)
        for name in _OPTIONAL:
            own = None if given[name] is None else kept_property(name, given[name], whole, places)
            object.__setattr__(self, name, own)
        object.__setattr__(self, "curvature", kept_curvature(curvature, whole, places))
        for axis in (1, 2):
            self.planar(axis)  # refuses numbers whose frequencies leave the range of floats

    @classmethod
    def pretwisted(cls, angle: float, *, length: float, **properties: Any) -> Rod:
        """Return the straight rod whose section turns by `angle` [rad] from end to end, evenly.

        Examples
        --------
        >>> wire = {"bending_stiffness": 1, "torsional_stiffness": 1, "mass_per_length": 1}
        >>> Rod.pretwisted(1.0, length=2.0, **wire).curvature
        (0.5, 0.0, 0.0)
        """
        turn = real("angle", angle)
        check_turns("angle", turn, turn)
        rate = turn / positive_real("length", length)
        return cls(length, curvature=(rate, 0.0, 0.0), **properties)

    @classmethod
    def arc(cls, angle: float, *, length: float, **properties: Any) -> Rod:
        """Return the rod of an arc of a circle of `angle` [rad], in the section's plane of x and y.

        Examples
        --------
        >>> wire = {"bending_stiffness": 1, "torsional_stiffness": 1, "mass_per_length": 1}
        >>> ring = Rod.arc(2 * math.pi, length=1, **wire)
        >>> bool(abs(ring.frames([1.0])[1]).max() < 1e-15)                           # it closes
        True
        """
        turn = real("angle", angle)
        check_turns("angle", turn, turn)
        rate = turn / positive_real("length", length)
        return cls(length, curvature=(0.0, 0.0, rate), **properties)

    @classmethod
    def helix(cls, *, radius: float, pitch: float, turns: float, **properties: Any) -> Rod:
        """Return the rod of a helix: of `radius` [m], `pitch` [m] along its axis per turn, and `turns`.

        The section's y axis points at the helix's axis; a negative pitch is a left-handed helix.

        Examples
        --------
        >>> spring = Rod.helix(radius=0.1, pitch=0.02, turns=3, bending_stiffness=1, torsional_stiffness=1,
        ...                    mass_per_length=1)
        >>> round(spring.length, 6)
        1.88591
        """
        wide, number = positive_real("radius", radius), positive_real("turns", turns)
        check_turns("turns", number, 2.0 * math.pi * number)
        rise = real("pitch", pitch) / (2.0 * math.pi)
        slant = math.hypot(wide, rise)
        turning = (rise / slant / slant, 0.0, wide / slant / slant)
        return cls(2.0 * math.pi * number * slant, curvature=turning, **properties)

    @classmethod
    def hook(cls, *, straight: float, radius: float, angle: float, **properties: Any) -> Rod:
        """Return the rod that is straight for `straight` [m], then an arc of `radius` [m] and `angle` [rad].

        Examples
        --------
        >>> wire = {"bending_stiffness": 1, "torsional_stiffness": 1, "mass_per_length": 1}
        >>> cane = Rod.hook(straight=1.0, radius=0.1, angle=math.pi, **wire)
        >>> cane.frames([cane.length])[1].round(6).tolist()
        [[1.0, 0.2, 0.0]]
        """
        first, wide = positive_real("straight", straight), positive_real("radius", radius)
        turn = real("angle", angle)
        check_turns("angle", turn, turn)
        length, bend = first + wide * abs(turn), math.copysign(1.0 / wide, turn)
        if not SAME_PLACE * length < first < (1.0 - SAME_PLACE) * length:
            raise ValueError(
                "straight must not vanish beside the arc, radius times angle, nor it beside that, got "
                f"{shown(straight)} with radius {shown(radius)} and angle {shown(angle)}"
            )
        steps = CurvatureSteps((first, length), ((0.0, 0.0, 0.0), (0.0, 0.0, bend)))
        return cls(length, curvature=steps, **properties)

    @classmethod
    def through(
        cls,
        points: Sequence[Sequence[float]] | NDArray[Any],
        *,
        up: Sequence[float] = (0.0, 0.0, 1.0),
        twist: float = 0.0,
        **properties: Any,
    ) -> Rod:
        """Return the rod along a smooth line through measured points, from the first to the last.

        Parameters
        ----------
        points : sequence of (x, y, z), at least four [m]
            Each away from the one before. Give them denser where the line bends more: a line through them
            that has all but a corner is refused.
        up : (x, y, z)
            Where the section's y axis points at the first point, as far as it is across the line. From there
            the section is carried along without turning about the line.
        twist : float [rad/m]
            Rate at which it turns about the line all the same.
        **properties
            As of `Rod`; functions and tables run over the line's length.

        Examples
        --------
        >>> angle = np.linspace(0.0, math.pi / 2, 9)
        >>> measured = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
        >>> rod = Rod.through(measured, bending_stiffness=1, torsional_stiffness=1, mass_per_length=1)
        >>> bool(abs(rod.length - math.pi / 2) < 1e-6)
        True
        """
        rows = real_numbers("points", bounded("points", points, most=10_000))
        if rows.ndim != 2 or rows.shape[1] != 3 or len(rows) < 4:
            raise ValueError(f"points must be four rows of x, y and z or more, got {shown(points)}")
        if not np.diff(rows, axis=0).any(axis=1).all():
            raise ValueError("points must each lie away from the one before, got one twice in a row")
        axis = real_numbers("up", bounded("up", up, most=3))
        first = rows[1] - rows[0]
        least = 1e-9 * np.linalg.norm(axis) * np.linalg.norm(first)
        if axis.shape != (3,) or np.linalg.norm(np.cross(axis, first)) < least:
            raise ValueError(f"up must be three numbers, and not along the line's start, got {shown(up)}")
        line = LineThroughPoints(
            tuple((float(x), float(y), float(z)) for x, y, z in rows),
            (float(axis[0]), float(axis[1]), float(axis[2])),
            real("twist", twist),
        )
        turn, place = line.sharpest
        if turn > _SHARPEST:
            raise ValueError(
                "points must be closer together where the line bends: the smooth line through them turns by "
                f"{math.degrees(turn):.0f} degrees within a 64th of the way from point {place} to point "
                f"{place + 1}, counted from 0; {math.degrees(_SHARPEST):.0f} degrees are allowed"
            )
        return cls(line.length, curvature=line, **properties)

    @classmethod
    def from_beam(
        cls,
        beam: Beam,
        *,
        torsional_stiffness: PropertyLike | None = None,
        polar_inertia_per_length: PropertyLike | None = None,
        second_bending_stiffness: PropertyLike | None = None,
        curvature: CurvatureLike = (0.0, 0.0, 0.0),
    ) -> Rod:
        """Return the rod with a planar beam's numbers, bending about z, and those that it does not know.

        The beam's shear and axial stiffness are left out, as a chain leaves them out.

        Parameters
        ----------
        beam : Beam
            Such as `Beam.from_section` gives, which knows GJ and ρI_p of most sections.
        torsional_stiffness : property [N m²], optional
            GJ; the beam's own by default.
        polar_inertia_per_length : property [kg m], optional
            ρI_p; the beam's own by default, and zero where it has none.
        second_bending_stiffness : property [N m²], optional
            EI about y; as about z by default, as of a round or square section.
        curvature : three floats [1/m], rows of three, or function of s

        Examples
        --------
        >>> from beammodes.problem.sections import Circle
        >>> wire = Beam.from_section(Circle(0.002), length=1.0, elastic_modulus=200e9, density=7800.0)
        >>> round(Rod.from_beam(wire).torsional_stiffness, 4)
        0.1208
        """
        if not isinstance(beam, Beam):
            raise TypeError(f"beam must be a Beam, got {shown(beam)}")
        twisting = beam.torsional_stiffness if torsional_stiffness is None else torsional_stiffness
        if twisting is None:
            raise ValueError(
                "torsional_stiffness must be given for a beam that does not know its own, got None"
            )
        polar = (
            beam.polar_inertia_per_length if polar_inertia_per_length is None else polar_inertia_per_length
        )
        return cls(
            beam.length,
            beam.bending_stiffness,
            twisting,
            beam.mass_per_length,
            0.0 if polar is None else polar,
            second_bending_stiffness=second_bending_stiffness,
            rotary_inertia_per_length=beam.rotary_inertia_per_length,
            curvature=curvature,
        )

    @staticmethod
    def of_section(
        section: sections.Section,
        *,
        density: float,
        elastic_modulus: float,
        poisson_ratio: float,
        rotary_inertia: bool = False,
    ) -> dict[str, float]:
        """Return what a cross-section and a material give of a rod's properties, to be passed on.

        Parameters
        ----------
        section : Section
            One of `sections`, its height along y and its width along z; or anything with an `area` [m²], a
            `second_moment`, a `weak_second_moment` and a `torsion_constant` [m⁴].
        density : float [kg/m³]
        elastic_modulus : float [Pa]
        poisson_ratio : float
            ν of G = E/(2 (1 + ν)), above -1 and at most 0.5.
        rotary_inertia : bool
            Whether the section's inertias about y and z count.

        Examples
        --------
        >>> from beammodes.problem.sections import Rectangle
        >>> steel = {"density": 7800.0, "elastic_modulus": 200e9, "poisson_ratio": 0.3}
        >>> ring = Rod.arc(3.0, length=1.0, **Rod.of_section(Rectangle(width=0.002, height=0.02), **steel))
        >>> round(ring.bending_stiffness / ring.second_bending_stiffness)
        100
        """
        given = {"density": density, "elastic_modulus": elastic_modulus, "poisson_ratio": poisson_ratio}
        beam = Beam.from_section(section, length=1.0, rotary_inertia=rotary_inertia, **given)
        for name in ("torsion_constant", "weak_second_moment"):
            if getattr(section, name, None) is None:
                raise TypeError(f"section must have its {name} for a rod, got {shown(section)}")
        whole: Any = section
        weak = whole.weak_second_moment / section.second_moment
        found = {name: getattr(beam, name) for name in (*_NEEDED, *_INERTIAS[:2])}
        found["second_bending_stiffness"] = weak * found["bending_stiffness"]
        found["second_rotary_inertia_per_length"] = weak * found["rotary_inertia_per_length"]
        return found

    def planar(self, axis: int) -> Beam:
        """Return the straight beam whose bending stiffness is that of turning about x, y or z (0 to 2).

        Its GJ or EI, and ρA; the rules' quadratures are those of such a beam. A step of the curvature is a
        break to them, as one of the stiffness is.
        """
        stiffness = (self.torsional_stiffness, self.second_bending_stiffness, self.bending_stiffness)[axis]
        marks = shape_breaks(self.curvature)
        if marks and isinstance(stiffness, float):
            return Beam(self.length, _Constant(stiffness), self.mass_per_length, breaks=marks)
        return Beam(self.length, stiffness, self.mass_per_length, breaks=marks)

    @property
    def unstretched(self) -> Rod:
        """The same rod without shear and stretch, as a chain stands for it."""
        if all(getattr(self, name) is None for name in _OPTIONAL):
            return self
        names = (*_NEEDED, "second_bending_stiffness", *_INERTIAS, "curvature")
        return Rod(self.length, **{name: getattr(self, name) for name in names})

    @property
    def is_straight(self) -> bool:
        """True if the centre line is a straight line; its section may turn about it, evenly."""
        return isinstance(self.curvature, tuple) and not any(self.curvature[1:])

    def determined(self, ends: RodEnds) -> RodEnds:
        """Return ends that act alike on the modes, without what the rod's theory leaves undetermined.

        A straight rod that does not stretch moves along its line as one: where both ends hold it along, its
        axial force is whatever one likes, and one of them is let go. Where nothing holds its twist, and
        neither section nor body has inertia about the line, it may turn as it likes, and is held.
        """
        samples = self.curvature_at((np.arange(SAMPLES) + 0.5) / SAMPLES * self.length)
        if samples[:, 1:].any():
            return ends
        left, right = ends.left, ends.right
        along = (left.translational_stiffness[0], right.translational_stiffness[0])
        if self.axial_stiffness is None and math.inf in along:
            first = math.isinf(along[0])
            loose, firm = (right, left) if first else (left, right)
            loose = loose.with_supports((0.0, *loose.translational_stiffness[1:]), loose.rotational_stiffness)
            left, right = (firm, loose) if first else (loose, firm)
        turning = any(end.rotational_stiffness[0] or end.mass_matrix[3].any() for end in (left, right))
        if not turning and self.polar_inertia_per_length == 0.0:
            left = left.with_supports(
                left.translational_stiffness, (math.inf, *left.rotational_stiffness[1:])
            )
        return RodEnds(left, right)

    @property
    def is_uniform(self) -> bool:
        """True if no property, nor the curvature in the section's axes, varies along the rod."""
        values = [getattr(self, name) for name in _ALONG]
        return isinstance(self.curvature, tuple) and all(
            value is None or isinstance(value, float) for value in values
        )

    @property
    def breaks(self) -> tuple[float, ...]:
        """Positions inside the rod between which it is smooth, and a measured line even, ascending [m]."""
        return each_place_once(sorted([*self.steps, *even_parts(self.curvature)]), self.length)

    @property
    def steps(self) -> tuple[float, ...]:
        """Positions at which a property or the curvature has a step or a kink, ascending [m]."""
        profiles = [getattr(self, name) for name in _ALONG]
        places = [s for profile in profiles if profile is not None for s in profile_breaks(profile)]
        return each_place_once(sorted([*places, *shape_breaks(self.curvature)]), self.length)

    @property
    def units(self) -> tuple[float, float, float]:
        """L, the larger mean EI over L, and mean ρA times L: of length, stiffness and mass."""
        stiffness = max(self.planar(1).mean_bending_stiffness, self.planar(2).mean_bending_stiffness)
        return (
            self.length,
            stiffness / self.length,
            mean_over(self.mass_per_length, self.length) * self.length,
        )

    def curvature_at(self, s: Floats) -> Floats:
        """Return κ at an array of positions, shape (n, 3) [1/m]."""
        return curvature_at(self.curvature, s)

    def frames(self, s: Any) -> tuple[Floats, Floats]:
        """Return the section's axes and the centre line's points at positions from 0 to L, in any order.

        Returns
        -------
        ndarray, ndarray
            R, its columns the axes x, y and z, shape (n, 3, 3), and r [m], shape (n, 3), in the axes of the
            section at s = 0.

        Examples
        --------
        >>> wire = {"bending_stiffness": 1, "torsional_stiffness": 1, "mass_per_length": 1}
        >>> half = Rod.arc(math.pi, length=math.pi, **wire)
        >>> half.frames([math.pi])[1].round(12).tolist()
        [[-0.0, 2.0, 0.0]]
        """
        places = np.atleast_1d(real_numbers("s", s))
        wrong = ~((places >= 0.0) & (places <= self.length * (1 + 1e-12)))
        if wrong.any():
            raise ValueError(f"s must be inside [0, {self.length}], got {places[wrong][0]}")
        stations = np.unique(np.concatenate([places, np.array(self.breaks)]))
        # Long stretches are cut, so that Magnus's series is short.
        stations = np.unique(np.concatenate([stations, np.linspace(0.0, self.length, 33)[1:-1]]))
        axes, points = shape_frames(self.curvature, stations)
        at = np.searchsorted(stations, places)
        return axes[at], points[at]

    def _line(self) -> str:
        usual: dict[str, Any] = dict.fromkeys(_INERTIAS, 0.0) | dict.fromkeys(_OPTIONAL)
        usual |= {"second_bending_stiffness": self.bending_stiffness, "curvature": (0.0, 0.0, 0.0)}
        given = [(name, getattr(self, name)) for name in ("length", *_ALONG, "curvature")]
        told = [
            f"{name}={part_shown(value)}"
            for name, value in given
            if name not in usual or value != usual[name]
        ]
        return f"Rod({', '.join(told)})"
