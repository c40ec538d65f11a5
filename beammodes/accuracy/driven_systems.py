"""A beam or a chain that is driven at one frequency: its arguments as users give them, and its response."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from beammodes.chains.chain import Chain
from beammodes.checks import choice, not_negative, real_numbers, shown
from beammodes.exact.driven_beam import DrivenBeam
from beammodes.numerics.arrays import Floats
from beammodes.numerics.marched_states import Complex
from beammodes.numerics.modal_sums import ModalSum, damped_sum
from beammodes.problem.beam import Beam
from beammodes.problem.driving import BASES, Drive, Reading, ends_let_move
from beammodes.problem.ends import Boundary, BoundaryLike, check_no_hub
from beammodes.problem.loading import Load, checked_load
from beammodes.version import SOURCE
from beammodes.vibration.damping import Damping, damping_ratios
from beammodes.vibration.driven_chain import DrivenChain

__all__ = ["HIGHEST", "UNITS", "Driven", "Place"]

#: Of what is read and of what drives.
UNITS: Mapping[str, str] = MappingProxyType(
    {"deflection": "m", "rotation": "rad", "force": "N", "moment": "N m", "shift": "m", "turn": "rad"}
)

#: A position along the beam, or several [m].
Place = float | Sequence[float] | Floats

#: Its square and the numbers of beams still multiply.
HIGHEST = 1e50
_MOST_PLACES, _LARGEST_LOSS = 10_000, 100.0


@dataclass(frozen=True, eq=False)
class Driven:
    """A beam or chain with its drive, its reading and its damping.

    Attributes
    ----------
    system : DrivenBeam or DrivenChain
    damping : Damping
    loss_factor : float
        η.
    ratios : ndarray or None
        Of modes, the last one of all above; None where damping is not modal.
    scalar : (bool, bool)
        Whether one position was given, and not a row, of reading and drive.
    """

    system: DrivenBeam | DrivenChain
    damping: Damping
    loss_factor: float
    ratios: Floats | None
    scalar: tuple[bool, bool]

    @classmethod
    def of(
        cls,
        system: Beam | Chain,
        boundary: BoundaryLike | None,
        *,
        force_at: Place | None,
        moment_at: Place | None,
        base: str | None,
        deflection_at: Place | None,
        rotation_at: Place | None,
        damping_ratio: ArrayLike | None,
        damping: Damping | None,
        loss_factor: float,
        load: Load | None,
    ) -> Driven:
        """Return what the arguments of `frequency_response` say."""
        if not isinstance(system, Beam | Chain):
            raise TypeError(f"system must be a Beam or a Chain, got {shown(system)}")
        pair, length = _boundary(system, boundary), _length(system)
        if base is None:
            drive, one_drive = _points(length, {"force": force_at, "moment": moment_at}, or_base=True)
        else:
            _only_base(base, pair, force_at, moment_at)
            drive, one_drive = (base, np.zeros(0)), True
        reading, one_read = _points(length, {"deflection": deflection_at, "rotation": rotation_at})
        pull, dampers = checked_load(load), damping
        if dampers is not None and not isinstance(dampers, Damping):
            raise TypeError(f"damping must be a Damping or None, got {shown(damping)}")
        dampers = Damping() if dampers is None else dampers
        lost = not_negative("loss_factor", loss_factor)
        if lost > _LARGEST_LOSS:
            raise ValueError(f"loss_factor must be at most {_LARGEST_LOSS:g}, got {shown(loss_factor)}")
        ratios = None if damping_ratio is None else damping_ratios(damping_ratio)
        if ratios is not None and (dampers != Damping() or lost):
            raise ValueError("damping_ratio must be given alone, without damping and loss_factor")
        if base == "turn" and pull != Load():
            raise ValueError(f"load must be left out with a base that turns, got {pull}")
        made: DrivenBeam | DrivenChain
        if isinstance(system, Beam):
            if np.any(np.asarray(dampers.joint)):
                raise ValueError(
                    "damping of a beam must be without joint dampers, since it has no hinges; stiffness= is "
                    f"what dampers in proportion to springs become, got {shown(dampers)}"
                )
            made = DrivenBeam(system, pair, pull, Drive(*drive), Reading(*reading))
        else:
            own = np.broadcast_to(np.asarray(dampers.joint), system.joint_stiffness.shape)
            if np.ndim(dampers.joint):
                dampers.joint_damping(system)
            made = DrivenChain(system, pull, Drive(*drive), Reading(*reading), own)
        return cls(made, dampers, lost, ratios, (one_read, one_drive))

    @cached_property
    def _products(self) -> Callable[[int], tuple[Floats, Floats]]:
        def products(modes: int) -> tuple[Floats, Floats]:
            natural, shares = self.system.products(modes)
            return natural, np.where(self._moves, shares, 0.0)

        return lru_cache(maxsize=16)(products)

    def at(self, frequency: Floats, tolerance: float = 1e-10) -> ModalSum:
        """Return responses at frequencies [Hz], shape (frequencies, readings, drives); sums to a tolerance.

        Of a base: the motion relative to it, over its acceleration with the other sign.
        """
        if (frequency > HIGHEST).any():
            raise ValueError(f"frequency or band must be at most {HIGHEST:g} Hz, got {frequency.max():.6g}")
        self.check_lowest(float(frequency.min()))
        omega = 2.0 * math.pi * frequency
        if self.ratios is None:
            square = omega * (omega - 1j * self.damping.mass)
            stiffness = 1.0 + 1j * (self.loss_factor + omega * self.damping.stiffness)
            return ModalSum(self._receptance(square, stiffness, omega), 0, 0.0)
        nothing, system = 0.0 * omega, self.system

        def undamped(square: Complex) -> Complex:
            return self._receptance(square, nothing + 1.0 + 0j, nothing)

        return damped_sum(omega, self.ratios, undamped, self._products, system.most_modes, tolerance)

    def natural_frequencies(self, highest: float) -> Floats:
        """Return the natural frequencies below one [Hz], of those that can be told."""
        count, told = 16, np.zeros(0)
        while True:
            found = self._products(min(count, self.system.most_modes))[0] / (2.0 * math.pi)
            if len(found) == len(told) or (len(found) and found[-1] > highest):
                return found[found < highest]
            count, told = 2 * count, found

    def check_lowest(self, frequency: float) -> None:
        """Raise ValueError at no frequency at all of a system that would drift away."""
        if not frequency and self.system.drifts:
            raise ValueError(
                "frequency or band must be above 0 where the ends leave a motion that stores nothing, got 0"
            )

    def _receptance(self, square: Complex, stiffness: Complex, omega: Floats) -> Complex:
        if isinstance(self.system, DrivenBeam):
            found = self.system.receptance(square, stiffness)
        else:
            found = self.system.receptance(square, stiffness, omega)
        # What an end holds would be rounding.
        return np.where(self._moves, found, 0.0)

    @cached_property
    def _moves(self) -> NDArray[np.bool_]:
        of = self.system
        if isinstance(of, DrivenBeam):
            return ends_let_move(of.boundary, of.beam.length, of.reading, of.drive)
        return ends_let_move(of.chain.boundary, of.chain.node_position[-1], of.reading, of.drive)

    @property
    def is_damped(self) -> bool:
        """Whether something damps every mode."""
        given = self.damping != Damping() or self.loss_factor > 0.0
        return given if self.ratios is None else bool((self.ratios > 0.0).all())

    @property
    def coordinates(self) -> dict[str, Any]:
        """The positions that are read and driven, as coordinates of a Dataset."""
        return {name: (dims, x, attributes) for name, dims, x, attributes in self._positions()}

    def variable(
        self, values: NDArray[Any], long_name: str, units: str, before: tuple[str, ...] = ()
    ) -> tuple[tuple[str, ...], NDArray[Any], dict[str, str]]:
        """Return values over (*before, readings, drives) as a variable; one position is no dimension."""
        dims = tuple(name for name, given, _, _ in self._positions() if given)
        single = (*self.scalar,) if not self.system.drive.is_base else (self.scalar[0], True)
        kept = (..., *(0 if one else slice(None) for one in single))
        return (*before, *dims), values[kept], {"long_name": long_name, "units": units}

    def _positions(self) -> list[tuple[str, tuple[str, ...], Any, dict[str, str]]]:
        parts: list[tuple[Reading | Drive, bool]] = [(self.system.reading, self.scalar[0])]
        if not self.system.drive.is_base:
            parts.append((self.system.drive, self.scalar[1]))
        rows: list[tuple[str, tuple[str, ...], Any, dict[str, str]]] = []
        for part, one in parts:
            name = f"{part.kind}_at"
            attributes = {"long_name": f"position of the {part.kind}", "units": "m"}
            rows.append((name, () if one else (name,), part.x[0] if one else part.x, attributes))
        return rows

    @property
    def words(self) -> dict[str, Any]:
        """What answers and what damps it, as attributes of a Dataset."""
        if self.ratios is not None:
            damped: dict[str, Any] = {"damping_ratio": self.ratios}
        else:
            damped = {"damping": str(self.damping), "loss_factor": self.loss_factor}
        of = self.system
        what = "the beam, exact" if isinstance(of, DrivenBeam) else repr(of.chain)
        ends = of.boundary if isinstance(of, DrivenBeam) else of.chain.boundary
        return {"source": SOURCE, "of": what, "boundary": ends.name, "load": str(of.load), **damped}


def _boundary(system: Beam | Chain, boundary: BoundaryLike | None) -> Boundary:
    if isinstance(system, Beam):
        if boundary is None:
            raise ValueError('boundary must be the ends of the beam, such as "clamped-free", got None')
        pair = Boundary.of(boundary)
        check_no_hub(pair.left, pair.right)
        return pair
    if boundary is not None:
        raise ValueError(f"boundary must be left out with a chain, which has its own, got {shown(boundary)}")
    return system.boundary


def _length(system: Beam | Chain) -> float:
    return system.length if isinstance(system, Beam) else float(system.node_position[-1])


def _points(
    length: float, given: dict[str, Place | None], *, or_base: bool = False
) -> tuple[tuple[str, Floats], bool]:
    """Return which of two kinds is given, where, and whether as one number."""
    kinds = [kind for kind, place in given.items() if place is not None]
    if len(kinds) != 1:
        names = " and ".join(f"{kind}_at" for kind in given) + (" and base" if or_base else "")
        raise ValueError(f"one of {names} must be given, got {' and '.join(kinds) or 'none'}")
    name = f"{kinds[0]}_at"
    x = real_numbers(name, given[kinds[0]])
    if x.ndim > 1 or not x.size or x.size > _MOST_PLACES:
        raise ValueError(
            f"{name} must be a position or at most {_MOST_PLACES} of them in a row, "
            f"got {shown(given[kinds[0]])}"
        )
    if outside := [at for at in x.ravel().tolist() if not 0.0 <= at <= length]:
        raise ValueError(f"{name} must be inside [0, {length}], got {outside[0]}")
    return (kinds[0], np.atleast_1d(x)), not x.ndim


def _only_base(base: object, pair: Boundary, force_at: object, moment_at: object) -> None:
    """Raise an error unless a base moves, and nothing else drives."""
    choice("base", base, BASES)
    if force_at is not None or moment_at is not None:
        raise ValueError("base must be given without force_at and moment_at, which are for a base at rest")
    if not (pair.left.is_grounded or pair.right.is_grounded):
        raise ValueError(f"boundary must tie an end to the base that moves, got {pair.name}")
