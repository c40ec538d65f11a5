"""Matched springs as a record: the chain they make, and what they do to statics, shapes and time steps.

Exactness in frequency is no exactness elsewhere, so what a matched chain does to static deflections, mode
shapes and time steps is stated beside its springs.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES
from beammodes.checks import row_shown
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary

__all__ = ["MatchedSprings", "NoPositiveSprings", "frozen", "shape_agreement", "uniform_rods"]


@dataclass(frozen=True, eq=False, repr=False)
class MatchedSprings:
    """Springs of one chain whose first frequencies are the beam's; `match_springs` makes it.

    Attributes
    ----------
    boundary : Boundary
    segments, modes : int
    chain : Chain
        Uniform rods of the given beam, hinges at the nodes and walls.
    stiffness_ratio : ndarray, shape (hinges,) [-]
        Joint stiffness over EI/ell, left to right.
    frequency_errors : ndarray, shape (modes,) [-]
        ω_chain/ω_beam - 1, what rounding leaves.
    static_tip_deflection_error : float [-]
        Relative, under a force on the tip that can deflect; NaN where no such tip finds a finite answer.
    mode_shape_agreement : ndarray, shape (modes,) [-]
        Mass-weighted modal assurance criterion, 1 at best, with the exact shapes sampled at the nodes.
    stable_time_step : float [s]
        Of fixed-step RK4.
    criterion : str
        Which springs it is close to.
    criterion_value : float [-]
        Σ ln² of the springs over those.
    symmetric : bool
        Whether the springs are their own mirror image.

    Examples
    --------
    >>> from beammodes.springs.inverse import match_springs
    >>> match_springs("pinned-pinned", segments=2, modes=1).stiffness_ratio         # π⁴/96
    array([1.01467803])
    """

    boundary: Boundary
    segments: int
    modes: int
    chain: Chain
    stiffness_ratio: Floats
    frequency_errors: Floats
    static_tip_deflection_error: float
    mode_shape_agreement: Floats
    stable_time_step: float
    criterion: str
    criterion_value: float
    symmetric: bool

    def __repr__(self) -> str:
        springs = row_shown(self.stiffness_ratio, "{:.6g}", "EI/ell")
        met = f"{self.segments} segments, {self.modes} modes of the beam met"
        return f"MatchedSprings({self.boundary}, {met}: {springs})"


class NoPositiveSprings(ValueError):
    """No positive springs were found that meet the conditions.

    Attributes
    ----------
    nearest : MatchedSprings
        Those of least-squares deviation.

    Examples
    --------
    >>> from beammodes.springs.inverse import match_springs
    >>> try:
    ...     match_springs("clamped-free", segments=2, modes=2, hold_tip_stiffness=True)
    ... except NoPositiveSprings as error:
    ...     print(error.nearest.frequency_errors.round(3))
    [-0.042 -0.007]
    """

    def __init__(self, message: str, nearest: MatchedSprings) -> None:
        super().__init__(message, nearest)
        self.nearest = nearest

    def __str__(self) -> str:
        return str(self.args[0])


def uniform_rods(beam: Beam, boundary: Boundary, segments: int, ratio: Floats) -> Chain:
    """Return a chain of uniform rods with the springs `ratio` times EI/ell; lengths and masses are exact."""
    ell = Fraction(beam.length) / segments
    lengths = [piece * ell for piece in RULES["gregory"].piece_lengths(boundary, segments)]
    masses = [Fraction(beam.mean_mass_per_length) * length for length in lengths]
    return Chain.from_pieces(
        length=lengths,
        mass=masses,
        rotary_inertia=[mass * length**2 / 12 for mass, length in zip(masses, lengths, strict=True)],
        joint_stiffness=(ratio * (beam.mean_bending_stiffness / float(ell))).tolist(),
        boundary=boundary,
    )


def shape_agreement(chain: Chain, first: Floats, second: Floats) -> Floats:
    """Return the modal assurance criterion of shapes at the nodes, weighted with the pieces' inertia."""
    rods = chain.length > 0

    def momenta(shapes: Floats) -> Floats:
        left, right = shapes[:, :-1][:, rods], shapes[:, 1:][:, rods]
        slope = (right - left) / chain.length[rods]
        return np.hstack(
            [np.sqrt(chain.mass[rods]) * (left + right) / 2, np.sqrt(chain.rotary_inertia[rods]) * slope]
        )

    a, b = momenta(first), momenta(second)
    return np.asarray((a * b).sum(axis=1) ** 2 / (a**2).sum(axis=1) / (b**2).sum(axis=1))


def frozen(values: Floats) -> Floats:
    """Return a read-only copy."""
    copy = values.copy()
    copy.flags.writeable = False
    return copy
