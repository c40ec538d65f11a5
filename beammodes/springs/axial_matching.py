"""Springs that make a chain's first frequencies, or all of them, those of the beam in twist or stretch.

The same inverse eigenvalue problem as in bending (`inverse_eigenvalue`), with pieces of equal inertia. Here
positive springs were found for all frequencies at once, of every chain tried between fixed and free ends.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.axial_chain import AxialChain
from beammodes.checks import Shown, flag, row_shown, shown, whole_number
from beammodes.exact.axial_beam import axial_wavenumber, uniform_numbers
from beammodes.numerics.arrays import Floats, frozen
from beammodes.problem.axial_ends import AxialBoundary, AxialBoundaryLike
from beammodes.problem.beam import Beam
from beammodes.problem.motions import MOTIONS, Motion, unit_beam
from beammodes.springs.inverse_eigenvalue import (
    MAX_MATCHED,
    Conditions,
    ExactModes,
    State,
    closest,
    symmetric_basis,
)
from beammodes.vibration.axial_spectrum import solve_axial_modes
from beammodes.vibration.stability import stable_time_step

__all__ = ["AxialMatched", "AxialMatchedSprings", "NoPositiveAxialSprings", "match_axial_springs"]


@dataclass(frozen=True, eq=False, repr=False)
class AxialMatchedSprings(Shown):
    """Springs of one chain in twist or stretch whose first frequencies are the beam's.

    Attributes
    ----------
    boundary : AxialBoundary
    segments, modes : int
    chain : AxialChain
    stiffness_ratio : ndarray, shape (hinges,) [-]
        Joint stiffness over GJ/ell (EA/ell), left to right.
    frequency_errors : ndarray, shape (modes,) [-]
        ω_chain/ω_beam - 1, what rounding leaves.
    stable_time_step : float [s]
        Of fixed-step RK4.
    symmetric : bool
        Whether the springs are their own mirror image.
    """

    boundary: AxialBoundary
    segments: int
    modes: int
    chain: AxialChain
    stiffness_ratio: Floats
    frequency_errors: Floats
    stable_time_step: float
    symmetric: bool

    def _line(self) -> str:
        symbol = MOTIONS[self.boundary.motion].stiffness_symbol
        springs = row_shown(self.stiffness_ratio, "{:.6g}", f"{symbol}/ell")
        met = f"{self.segments} segments, {self.modes} modes of the beam met"
        return f"AxialMatchedSprings({self.boundary}, {met}: {springs})"


class NoPositiveAxialSprings(ValueError):
    """No positive springs were found that make the frequencies those of the beam."""


@dataclass(frozen=True, eq=False)
class _Springs:
    """A chain's inertias and the springs between them, those that are sought marked."""

    inertia: Floats
    springs: Floats
    sought: NDArray[np.bool_]
    rigid: int

    @classmethod
    def of(cls, pair: AxialBoundary, segments: int) -> _Springs:
        """Return those of unit numbers, with 1/2 at the walls."""
        chain = AxialChain(unit_beam(), pair, segments, "double_wall", motion=pair.motion)
        _, inertia, springs = chain.moving
        sought = np.ones(len(springs), dtype=bool)
        for end, at in ((pair.left, 0), (pair.right, -1)):
            # A free end has no spring, and that of a disc is its own; a spring alone is in series with a
            # hinge.
            sought[at] = end.is_fixed or (end.stiffness > 0.0 and not end.inertia)
        return cls(inertia, springs, sought, pair.rigid_body_modes)

    def state(self, log_springs: Floats) -> State:
        """Return the elastic modes of the chain with these springs where they are sought."""
        springs = self.springs.copy()
        springs[self.sought] = np.exp(log_springs)
        size, root = len(self.inertia), np.sqrt(self.inertia)
        two, at = np.zeros((size + 1, size)), np.arange(size)
        two[at, at], two[at + 1, at] = np.sqrt(springs[:-1]) / root, -np.sqrt(springs[1:]) / root
        energy, omega, _ = np.linalg.svd(two, full_matrices=False)
        order = np.argsort(omega)[self.rigid :]
        return State(
            2 * np.log(omega[order]), energy.T[order][:, self.sought], np.zeros(int(self.sought.sum()))
        )


def match_axial_springs(
    boundary: AxialBoundaryLike,
    segments: int,
    modes: int,
    *,
    symmetric: bool | None = None,
    beam: Beam | None = None,
    motion: str | Motion = "twist",
) -> AxialMatchedSprings:
    """Return positive springs that make a chain's first frequencies the beam's in twist or stretch.

        minimize Σ ln²(k_j/k_j⁰)   subject to   ω_n(k) = ω_n of the beam,  n = 1 ... modes

    k⁰ is GJ/ell inside, and 2 GJ/ell at the ends. `match_springs(motion="twist")` is the door to it.

    Parameters
    ----------
    boundary : str, pair of words or AxialEnd, or AxialBoundary
    segments : int
        N, 1 to 200.
    modes : int
        How many, from the first; at most all elastic ones.
    symmetric : bool, optional
        Whether springs mirror each other; by default they do where both ends are alike and there are enough.
    beam : Beam, optional
        Uniform; sets the units of chain and ends. Without one numbers are multiples.
    motion : str

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or out of range; `NoPositiveAxialSprings`, a ValueError, if none are
        found.

    Examples
    --------
    >>> springs = match_axial_springs("fixed-free", segments=3, modes=3)
    >>> springs.stiffness_ratio.round(3), bool(abs(springs.frequency_errors).max() < 1e-12)
    (array([6.021, 0.725, 1.062]), True)
    """
    pair = AxialBoundary.of(boundary, motion)
    count, wanted = whole_number("segments", segments, most=MAX_MATCHED), whole_number("modes", modes)
    mirrored = None if symmetric is None else flag("symmetric", symmetric, or_none=True)
    beam = unit_beam() if beam is None else beam
    stiffness, inertia = uniform_numbers(beam, MOTIONS[pair.motion])
    scaled = pair.scaled(stiffness / beam.length, inertia * beam.length)
    weights = _weights(scaled, count, wanted, mirrored)
    chain = AxialChain(beam, pair, count, _Given(weights), motion=pair.motion)
    exact = _first_wavenumbers(scaled, wanted)
    omega = solve_axial_modes(chain, wanted).angular_frequency
    ratio = 1.0 / np.array(weights)
    return AxialMatchedSprings(
        pair,
        count,
        wanted,
        chain,
        frozen(ratio),
        frozen(omega / (exact * MOTIONS[pair.motion].frequency_unit(beam)) - 1.0),
        stable_time_step(chain),
        bool(np.allclose(ratio, ratio[::-1], rtol=1e-9, atol=0)),
    )


@dataclass(frozen=True)
class _Given:
    """Weights that were found, as a layout."""

    weights: tuple[float, ...]
    name: str = "matched"

    def axial_weights(self, _boundary: AxialBoundary, _segments: int) -> tuple[float, ...]:
        return self.weights


def _first_wavenumbers(pair: AxialBoundary, modes: int) -> Floats:
    return axial_wavenumber([pair], np.asarray(0), np.arange(1, modes + 1))


@lru_cache(maxsize=1024)
def _weights(
    pair: AxialBoundary, segments: int, modes: int, symmetric: bool | None = None
) -> tuple[float, ...]:
    """Return the flexibility weights of matched springs, left to right, of ends in multiples."""
    chain = _Springs.of(pair, segments)
    elastic = len(chain.inertia) - chain.rigid
    if modes > elastic:
        raise ValueError(
            f"modes must be at most {elastic}, all the elastic modes of a {pair.name} chain of {segments} "
            f"segments, got {modes}"
        )
    hinges, alike = int(chain.sought.sum()), pair.left == pair.right
    mirrored = alike and (hinges + 1) // 2 >= modes
    if symmetric is not None:
        if symmetric and not mirrored:
            raise ValueError(
                f"symmetric must not be True where the ends differ or modes exceed {(hinges + 1) // 2}, half "
                f"the springs, got {pair.name} with {modes} modes"
            )
        mirrored = symmetric
    basis = symmetric_basis(hinges, mirrored)
    target = 2 * np.log(_first_wavenumbers(pair, modes))
    conditions = Conditions(chain.state, basis, tuple(range(modes)), target)
    wanted = basis.T @ np.log(chain.springs[chain.sought])
    solution = closest(conditions, wanted, [wanted])
    # Springs of pieces over N, the unit in which a weight is 1.
    found = np.exp(basis @ solution.z) / segments
    for end, at in ((pair.left, 0), (pair.right, -1)):
        if not end.is_fixed and end.stiffness and not end.inertia:
            found[at] = 1.0 / (1.0 / found[at] - segments / end.stiffness)
    if not solution.met or not (found > 0.0).all():
        raise NoPositiveAxialSprings(
            f"no positive springs were found that meet {modes} modes of a {pair.name} chain of {segments} "
            f"segments in {pair.motion}, got as near as {shown(found.round(3).tolist())} times those of rods"
        )
    return tuple((1.0 / found).tolist())


class AxialMatched(ExactModes):
    """Chains in twist or stretch with exact first frequencies; `matched(modes, motion="twist")` makes it.

    Parameters
    ----------
    modes : int
        How many frequencies, from the first.

    Examples
    --------
    >>> [round(weight, 4) for weight in AxialMatched(1).axial_weights(AxialBoundary.of("free-free"), 3)]
    [0.9119, 0.9119]
    """

    def axial_weights(self, boundary: AxialBoundary, segments: int) -> tuple[float, ...]:
        """Return the flexibility weights of the hinges, left to right; NaN where no springs are found."""
        try:
            return _weights(boundary, segments, self.modes)
        except ValueError:
            return (math.nan,) * (segments + 1)
