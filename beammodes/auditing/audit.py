"""Audits of chains that somebody else made: their errors, the layout they follow, springs that are better."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from beammodes.auditing.better_springs import Suggestion, listed_errors, suggestions_for
from beammodes.auditing.judged_pieces import UNKNOWN, Columns, JudgedPieces
from beammodes.checks import positive_real
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike

__all__ = ["UNKNOWN", "Audit", "Suggestion", "audit_chain"]

Array = NDArray[np.float64]

#: A smaller relative difference of lengths or masses is not reported.
_SAME = 1e-6


@dataclass(frozen=True, eq=False)
class Audit:
    """What `audit_chain` or `audit_file` found.

    Attributes
    ----------
    boundary : Boundary
    angular_frequency : ndarray, shape (modes,) [rad/s]
        Of the chain; NaN beyond its last mode, as in `errors`.
    errors : ndarray, shape (modes,) [-]
        Relative, against the exact beam.
    length_mismatch, mass_mismatch : float [-]
        How much longer and heavier the chain is than the beam, relatively.
    segments : int or None
        N, where the hinges are those of a rule.
    layout : str
        Name of the rule with these hinges and springs, or "no known layout".
    order : int or None
        Of that rule for these ends and this rotary inertia: e ~ 1/N**order if the pieces are uniform.
    remark : str
        The layout in one sentence.
    suggestions : tuple of Suggestion
    tolerance : float
    joint_stiffness : ndarray, shape (hinges,) [N m/rad]
        Of the chain as it is.
    hinge_names : tuple of str
        As the file has them; "hinge 1" and so on for arrays.
    notes : tuple of str
        What was read from the file, what was assumed, and what is left out.
    """

    boundary: Boundary
    angular_frequency: Array
    errors: Array
    length_mismatch: float
    mass_mismatch: float
    segments: int | None
    layout: str
    order: int | None
    remark: str
    suggestions: tuple[Suggestion, ...]
    tolerance: float
    joint_stiffness: Array
    hinge_names: tuple[str, ...]
    notes: tuple[str, ...] = ()

    @property
    def meets(self) -> bool:
        """Whether all modes exist and their errors are within the tolerance."""
        return bool((np.abs(self.errors) <= self.tolerance).all())

    @property
    def mismatches(self) -> tuple[str, ...]:
        """What is said of a length or a mass that is not the beam's."""
        off = {"length": self.length_mismatch, "mass": self.mass_mismatch}
        return tuple(
            f"{name} is {100 * part:+.3g} % off the beam's: more segments do not remove that error"
            for name, part in off.items()
            if abs(part) > _SAME
        )

    @property
    def text(self) -> str:
        """A short report."""
        verdict = "meets" if self.meets else "does not meet"
        lines = [
            f"{self.boundary.name} chain {verdict} {100 * self.tolerance:.3g} %: {listed_errors(self.errors)}"
        ]
        lines.append(self.remark)
        lines += self.mismatches
        lines += self.notes
        return "\n".join(lines + [f"  {suggestion}" for suggestion in self.suggestions])


def audit_chain(
    beam: Beam,
    boundary: BoundaryLike,
    *,
    length: Columns,
    mass: Columns,
    rotary_inertia: Columns,
    joint_stiffness: Columns,
    centre: Columns | None = None,
    modes: int = 3,
    tolerance: float = 0.01,
) -> Audit:
    """Judge a chain that is given as arrays, name the rule that it follows, and suggest better springs.

        e = ω_chain / ω_beam - 1

    Parameters
    ----------
    beam : Beam
        The uniform beam that the chain stands for.
    boundary : str, pair or Boundary
    length, mass, rotary_inertia, joint_stiffness, centre : sequence
        Of pieces and hinges, as `Chain.from_pieces` takes them. A segment welded to a wall is a first piece,
        which the clamped end holds; a hinge at the wall follows a first piece of length zero. Bodies and
        springs of the ends belong to `boundary`, not here.
    modes : int
        How many, 1 to 100.
    tolerance : float
        Largest |e| allowed: 0.01 is one percent.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, the beam is not uniform, or the pieces make no chain that vibrates.

    Examples
    --------
    >>> ell = 0.1                                     # a cable whose first of ten segments is welded
    >>> found = audit_chain(Beam.unit(), "clamped-free", length=[ell] * 10, mass=[ell] * 10, modes=2,
    ...                     rotary_inertia=[ell**3 / 12] * 10, joint_stiffness=[1 / ell] * 9)
    >>> print(found.text)
    clamped-free chain does not meet 1 %: errors +11.1 %, +11.8 %
    first segment is rigid with its parent: rigid_stub, +11 % at N = 10, falls only as 1/N
      rigid_stub_corrected: springs 5.2174, 17.143, 10, 10, ...: errors +0.29 %, +3.42 %
      first_spring_tuned: springs 6.0949, 10, 10, 10, ...: errors +0 %, +5.23 %
      gregory: hinges moved to 0, 0.1, ...:
        springs 26.667, 8.5714, 10.435, 10, ...: errors +0.000515 %, -0.00976 %
    """
    given = {"length": length, "mass": mass, "rotary_inertia": rotary_inertia}
    given |= {} if centre is None else {"centre": centre}
    limit = positive_real("tolerance", tolerance)
    judged = JudgedPieces.of(beam, Boundary.of(boundary), given, joint_stiffness, modes)
    layouts = judged.layouts()
    rules = judged.followed(layouts)
    errors = judged.errors(judged.springs)
    return Audit(
        boundary=judged.boundary,
        angular_frequency=judged.exact * (1 + errors),
        errors=errors,
        length_mismatch=float(judged.length.sum() / beam.length - 1),
        mass_mismatch=float(judged.mass.sum() / (beam.mean_mass_per_length * beam.length) - 1),
        segments=(rules or layouts)[0][1] if layouts else None,
        layout=rules[0][0].name if rules else UNKNOWN,
        order=judged.order(rules[0][0]) if rules else None,
        remark=judged.remark(layouts, rules, errors[0]),
        suggestions=suggestions_for(judged, rules or layouts),
        tolerance=limit,
        joint_stiffness=judged.springs,
        hinge_names=tuple(f"hinge {i + 1}" for i in range(len(judged.springs))),
    )
