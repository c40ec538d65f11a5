"""Stability of a chain under a force that follows its tip: no load is less like a dead one.

A compression P along the last segment turns with it. In undamped modes q = Φ p of unit modal mass, with θ the
pieces' angles and y the tip's deflection in them,

    p'' + G p' + (Ω² - P B) p = 0,      B = Σ_i l_i θ_i θ_iᵀ - y θ_nᵀ.

The first part of B is what a dead force does. The second is not symmetric: the force takes energy from no
potential, frequencies of two modes may meet and leave the axis as a pair of complex ones, and the chain
flutters. All modes of the chain are kept, so that this is the linear chain itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.checks import Shown, real, shown
from beammodes.deferred import Deferred
from beammodes.numerics.arrays import Floats
from beammodes.version import SOURCE
from beammodes.vibration.damping import Damping, checked_damping, damping_of_modes
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import MAX_DENSE, solve_modes

if TYPE_CHECKING:
    import xarray
else:
    xarray = Deferred("xarray")

__all__ = ["FlutterLoad", "flutter_load", "follower_modes"]

Complex = NDArray[np.complex128]

#: Steps of the force, in the least one that can make a chain unstable, or as shares of it, until it does.
_STEP, _GROWN, _MOST_STEPS = 0.25, 0.02, 500
#: Of what a dead force does, the share that rounding leaves where the whole of it is taken back at the tip.
_NOTHING = 1e-12
#: Growth that rounding makes of none, in |λ|: without dampers two roots meet and lose half of the digits.
_GROWTH, _DAMPED_GROWTH = 1e-6, 1e-10


@dataclass(frozen=True, repr=False)
class FlutterLoad(Shown):
    """Where a follower force first makes a chain unstable.

    Attributes
    ----------
    compression : float [N]
    angular_frequency : float [rad/s]
        Of the motion that begins to grow; 0 if the chain falls over without swinging.
    """

    compression: float
    angular_frequency: float

    @property
    def is_flutter(self) -> bool:
        """True if the motion that begins to grow swings."""
        return self.angular_frequency > 0

    @property
    def frequency(self) -> float:
        """ω/(2π) [Hz]."""
        return self.angular_frequency / (2.0 * math.pi)

    def _line(self) -> str:
        how = f"{self.frequency:.4g} Hz" if self.is_flutter else "falls over without swinging"
        return f"FlutterLoad({how}, at a compression of {self.compression:.6g} N)"


@dataclass(frozen=True)
class _Followed:
    """A chain in all its modes: Ω, B and G."""

    omega: Floats
    push: Floats
    drag: Floats

    def eigenvalues(self, compression: float) -> Complex:
        """Return λ with a positive imaginary part, or real ones, ascending by size."""
        # Largest roots of the inverse are the lowest modes, with their digits.
        scaled = np.eye(len(self.omega)) - compression * self.push / np.outer(self.omega, self.omega)
        try:
            soft = np.linalg.inv(scaled) / np.outer(self.omega, self.omega)
        except np.linalg.LinAlgError:
            # On the verge of falling over: rounding beside it.
            beside = scaled + np.finfo(float).eps * np.eye(len(scaled))
            soft = np.linalg.inv(beside) / np.outer(self.omega, self.omega)
        if not self.drag.any():
            square = np.linalg.eigvals(soft).astype(complex)
            found = np.sqrt(-1 / square)
            found = np.concatenate([found, -found])
        else:
            size = len(soft)
            whole = np.block([[-soft @ self.drag, -soft], [np.eye(size), np.zeros_like(soft)]])
            found = 1 / np.linalg.eigvals(whole).astype(complex)
        found = found[found.imag >= 0]
        return np.asarray(found[np.argsort(np.abs(found), kind="stable")])

    def grows(self, compression: float) -> Complex:
        """Return those λ whose motions grow."""
        found = self.eigenvalues(compression)
        least = _DAMPED_GROWTH if self.drag.any() else _GROWTH
        return np.asarray(found[found.real > least * np.abs(found)])


def follower_modes(chain: Chain, compression: float, *, damping: Damping | None = None) -> xarray.Dataset:
    """Return the complex eigenvalues of a chain under a compression that follows its right tip.

        det(λ² + λ G + Ω² - P B) = 0,      q ~ exp(λ t)

    The force stays along the last segment, as the thrust of a jet there does; a dead one is an
    `axial_force` of a `Load`, and in time a `TimedLoad(..., follower=True)` is this one. The chain's error
    under it is of second order in 1/N.

    Parameters
    ----------
    chain : Chain
        Of at most 500 hinges, held so that it does not move as a rigid body. Name the free end last.
    compression : float [N]
        P; a negative one pulls.
    damping : Damping, optional
        It may destabilize: a little damping of the joints lowers the load at which a column flutters.

    Returns
    -------
    xarray.Dataset
        Over `mode`, of each pair of conjugate λ the one above the axis, ascending by |λ|: growth_rate Re λ
        [1/s], angular_frequency Im λ [rad/s]. Attribute `stable` is 1 if nothing grows. A motion that does
        not swing has two real λ, two entries.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, the chain is too long or not held.

    Examples
    --------
    >>> import beammodes as bm
    >>> column = bm.Chain(bm.Beam.unit(), "clamped-free", segments=20)
    >>> bm.follower_modes(column, 19.0).angular_frequency.values[:2].round(2)      # about to meet
    array([ 8.98, 13.14])
    >>> bm.follower_modes(column, 21.0).growth_rate.values[:2].round(2)
    array([ 2.27, -2.27])
    """
    import xarray

    followed, push = _followed(chain, damping), real("compression", compression)
    found, stable = followed.eigenvalues(push), not followed.grows(push).size
    columns = {
        "growth_rate": (found.real, "rate at which the motion grows", "1/s"),
        "angular_frequency": (found.imag, "angular frequency", "rad/s"),
    }
    return xarray.Dataset(
        {
            name: ("mode", values, {"long_name": text, "units": unit})
            for name, (values, text, unit) in columns.items()
        },
        coords={"mode": ("mode", np.arange(1, len(found) + 1), {"long_name": "motion", "units": "1"})},
        attrs={"source": SOURCE, "stable": int(stable), "compression": push},
    )


def flutter_load(chain: Chain, *, damping: Damping | None = None) -> FlutterLoad:
    """Return the least compression along the right tip, which it follows, that makes a chain unstable.

    For a clamped-free column that is Beck's: 20.0510 EI/L², eight times what buckles it where the force is
    dead. The chain's is wrong by second order in 1/N. Some eighty times all eigenvalues are found: 100 pieces
    take a second or two, 200 ten times that.

    Parameters
    ----------
    chain, damping
        As of `follower_modes`.

    Returns
    -------
    FlutterLoad
        The compression [N], and the frequency at which the chain then flutters; zero where it buckles.

    Raises
    ------
    TypeError, ValueError
        As `follower_modes`; or if no compression makes the chain unstable.

    References
    ----------
    M. Beck, Die Knicklast des einseitig eingespannten, tangential gedrückten Stabes, ZAMP 3 (1952), 225-228.

    Examples
    --------
    >>> import beammodes as bm
    >>> found = bm.flutter_load(bm.Chain(bm.Beam.unit(), "clamped-free", segments=40))
    >>> round(found.compression, 2), round(found.angular_frequency, 2), found.is_flutter
    (20.02, 11.01, True)
    """
    followed = _followed(chain, damping)
    # No smaller force can make up for what the springs store.
    most = float(np.linalg.norm(followed.push / np.outer(followed.omega, followed.omega), 2))
    scale = 1 / most if most else 0.0
    low, high = 0.0, _STEP * scale
    for _ in range(_MOST_STEPS if scale else 0):
        if followed.grows(high).size:
            break
        low, high = high, high + max(_STEP * scale, _GROWN * high)
    else:
        raise ValueError(f"chain must lose its stability under some compression, got {chain!r}")
    while high - low > 1e-13 * high:
        middle = (low + high) / 2
        if middle in (low, high):
            break
        low, high = (low, middle) if followed.grows(middle).size else (middle, high)
    growing = followed.grows(high)
    return FlutterLoad(high, abs(float(growing[0].imag)))


def _followed(chain: Chain, damping: Damping | None) -> _Followed:
    if not isinstance(chain, Chain):
        raise TypeError(f"chain must be a Chain, got {shown(chain)}")
    checked_damping(damping)
    if len(chain.scaled.joint_stiffness) > MAX_DENSE:
        raise ValueError(
            f"chain must have at most {MAX_DENSE} hinges here, where all its modes are needed, "
            f"got {len(chain.scaled.joint_stiffness)}"
        )
    model, ends = linearize(chain), chain.boundary
    if model.rigid_body_modes or not model.elastic_modes:
        raise ValueError(
            f"boundary must hold the chain and let it vibrate under a follower force, got {ends.name}"
        )
    if not ends.left.is_grounded:
        raise ValueError(
            f"boundary must name the free end last, as the force follows the right tip, got {ends.name}"
        )
    modes = solve_modes(model)
    turned, tip = modes.rotation, modes.deflection[:, -1]
    dead = (turned * chain.length) @ turned.T
    push = dead - np.outer(tip, turned[:, -1])
    if np.abs(push).max() <= _NOTHING * np.abs(dead).max():
        push = np.zeros_like(push)
    drag = np.zeros_like(push) if damping is None else damping_of_modes(chain, damping).coupling
    return _Followed(modes.angular_frequency, push, drag)
