"""Damping from measurements: a ratio from a decay, and Rayleigh's two coefficients from ratios of modes."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from beammodes.chains.axial_chain import AxialChain
from beammodes.chains.chain import Chain
from beammodes.chains.spatial_chain import SpatialChain
from beammodes.chains.structure_chain import StructureChain
from beammodes.checks import Shown, bounded, is_text, positive_real, real_numbers, shown, whole_number
from beammodes.numerics.arrays import Floats
from beammodes.vibration.axial_spectrum import solve_axial_modes
from beammodes.vibration.damping import Damping, DampingFitWarning, given_for_asked, ratios_of_modes
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes
from beammodes.vibration.modes_in_space import spatial_modes
from beammodes.vibration.structure_vibration import structure_chain_modes

__all__ = ["DecayRatio", "ratio_from_decay", "rayleigh_damping"]


@dataclass(frozen=True, repr=False)
class DecayRatio(Shown):
    """A damping ratio from the peaks of a decay; `ratio_from_decay` makes it.

    Attributes
    ----------
    ratio : float
        ζ by the logarithmic decrement of the first and the last peak; `float()` gives it too.
    fitted_ratio : float
        ζ by the least squares of all peaks' logarithms. Where each peak is off by as much of itself, it
        scatters less than `ratio`: by 5 % with four peaks, by 30 % with ten.
    standard_error : float
        Of `fitted_ratio`, from the scatter of the peaks about the fitted decay: 0 of an exact one, NaN of two
        peaks, which have no scatter.
    peaks : int
        How many there were.
    """

    ratio: float
    fitted_ratio: float
    standard_error: float
    peaks: int

    def __float__(self) -> float:
        return self.ratio

    def _line(self) -> str:
        return f"DecayRatio({self})"

    def __str__(self) -> str:
        error = f" ± {self.standard_error:.1g}" if math.isfinite(self.standard_error) else ""
        all_of_them = f"{self.fitted_ratio:.4g}{error} by all"
        return f"{self.ratio:.4g} by the first and last of {self.peaks} peaks, {all_of_them}"


def ratio_from_decay(peaks: ArrayLike, *, periods: ArrayLike | None = None) -> DecayRatio:
    """Return the damping ratio of one mode's free decay, from its peaks.

        δ = ln(A_0/A_n)/n,   ζ = δ/√(4π² + δ²)

    The second formula is exact for any ratio below 1: all peaks have one phase.

    Parameters
    ----------
    peaks : sequence of float
        At least two, measured from rest, in time's order and of any unit. Of a signal that swings about
        another value take the differences of peaks and troughs.
    periods : sequence of float, optional
        When each came, in periods; by default they are one period apart, 0, 1, 2, ... Of peaks on both sides,
        all with the sign plus, it is 0, 0.5, 1, ...

    Returns
    -------
    DecayRatio
        With its accuracy.

    Raises
    ------
    TypeError, ValueError
        If peaks are fewer than two or not positive, the last is not smaller than the first, or `periods` do
        not ascend.

    References
    ----------
    L. Meirovitch, Elements of Vibration Analysis (1986), § 1.7.

    Examples
    --------
    >>> import beammodes as bm
    >>> found = bm.ratio_from_decay([10.0, 9.1, 8.3, 7.6])                      # mm
    >>> print(found)
    0.01456 by the first and last of 4 peaks, 0.01457 ± 0.0002 by all
    >>> round(found.ratio, 9)
    0.014557784
    """
    heights = _row("peaks", peaks)
    if len(heights) < 2 or heights.min() <= 0.0:
        raise ValueError(f"peaks must be two at least, all positive, got {shown(peaks)}")
    if heights[-1] >= heights[0]:
        raise ValueError(f"peaks must decay, the last smaller than the first, got {shown(peaks)}")
    times = np.arange(float(len(heights))) if periods is None else _row("periods", periods)
    if len(times) != len(heights) or (np.diff(times) <= 0.0).any():
        raise ValueError(f"periods must ascend, one for each of {len(heights)} peaks, got {shown(periods)}")
    logs = np.log(heights)
    decrement = float((logs[0] - logs[-1]) / (times[-1] - times[0]))
    apart = times - times.mean()
    spread = float(apart @ apart)
    slope = -float(apart @ logs) / spread
    left = logs - logs.mean() + slope * apart
    freedom = len(heights) - 2
    error = math.sqrt(float(left @ left) / freedom / spread) if freedom else math.nan
    # dζ/dδ = 4π²/(4π² + δ²)^(3/2)
    turn = 2 * math.pi
    rate = turn**2 / math.hypot(turn, slope) ** 3
    return DecayRatio(_ratio(decrement), _ratio(slope), error * rate, len(heights))


def _ratio(decrement: float) -> float:
    return decrement / math.hypot(2 * math.pi, decrement)


def _row(name: str, values: Any) -> Floats:
    row = real_numbers(name, values)
    if row.ndim != 1:
        raise TypeError(f"{name} must be numbers in a row, got {shown(values)}")
    return row


def rayleigh_damping(of: Any, ratios: Mapping[int, float] | ArrayLike) -> Damping:
    """Return damping in proportion to mass and stiffness from the damping ratios of two modes or more.

        ζ_n = α/(2 ω_n) + β ω_n/2

    Two ratios are met; of more the least squares of ζ. Between the modes of two ratios all modes have less
    damping, and above them ever more: ζ ≈ β ω/2. `damped_modes` says what all modes of a chain get. Files
    for engines have no α: `joint_dampers` fits several ratios without it.

    Parameters
    ----------
    of : chain of any kind, modes, or frequencies [Hz]
        Whose frequencies the modes have: a chain's, a beam's from `euler_bernoulli` or other modes, or
        measured ones, as a mapping of modes to Hz or a row of those of modes 1, 2, ... Ratios hold for these:
        what simulates a chain takes the chain.
    ratios : mapping of modes to ratios, or row of ratios of modes 1, 2, ...
        Such as {1: 0.008, 2: 0.011}; 1 is critical damping.

    Returns
    -------
    Damping
        α [1/s] and β [s].

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, fewer than two ratios are given, or a mode has no frequency there.

    Warns
    -----
    DampingFitWarning
        If α or β would be negative, so that some modes would gain energy: it says which, and what the fit
        without it gives, which is returned.

    References
    ----------
    Rayleigh, The Theory of Sound, vol. 1 (1877), on dissipation functions.

    Examples
    --------
    >>> import beammodes as bm
    >>> beam = bm.Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)
    >>> damping = bm.rayleigh_damping(bm.euler_bernoulli(beam, "clamped-free", 2), {1: 0.008, 2: 0.011})
    >>> round(damping.mass, 6), round(damping.stiffness, 9)                         # 1/s, s
    (0.366394, 0.000111378)
    >>> round(bm.rayleigh_damping({1: 4.55, 3: 79.8}, {1: 0.008, 3: 0.02}).mass, 6)         # of measured Hz
    0.393493
    >>> chain = bm.Chain(beam, "clamped-free", segments=8, rule="gregory")
    >>> damping = bm.rayleigh_damping(chain, {1: 0.008, 2: 0.011})
    >>> bm.damped_modes(chain, damping).damping_ratio.values.round(3)
    array([0.008, 0.011, 0.028, 0.053, 0.084, 0.122, 0.16 , 0.19 ])
    """
    wanted = ratios_of_modes("ratios", ratios)
    if len(wanted) < 2:
        raise ValueError(
            f"ratios must be of two modes at least, got {shown(ratios)}: joint_dampers takes a single one"
        )
    omega, values = _frequencies(of, [*wanted]), np.array([*wanted.values()])
    if len(np.unique(omega)) < 2:
        raise ValueError(
            f"of must have two different frequencies among modes {[*wanted]}, got {omega[0]:.6g} rad/s"
        )
    # In multiples of a frequency in the middle both columns are of one size.
    middle = float(np.sqrt(omega.min() * omega.max()))
    rows = np.column_stack([middle / (2 * omega), omega / (2 * middle)])
    found = np.linalg.lstsq(rows, values, rcond=None)[0]
    unit = np.array([middle, 1 / middle])
    if found.min() < 0.0:
        found = _without_the_negative(found, unit, rows, wanted)
    mass, stiffness = (found * unit).tolist()
    return Damping(mass=mass, stiffness=stiffness)


def _without_the_negative(both: Floats, unit: Floats, rows: Floats, wanted: Mapping[int, float]) -> Floats:
    """Return the fit of the other coefficient alone, and warn."""
    lost = int(both.argmin())
    name, measure, where = (("mass", "1/s", "below"), ("stiffness", "s", "above"))[lost]
    values, alone, kept = np.array([*wanted.values()]), np.zeros(2), rows[:, 1 - lost]
    alone[1 - lost] = kept @ values / (kept @ kept)
    # Where α/ω + β ω is zero.
    turns = math.sqrt(unit[0] / unit[1] * -both[0] / both[1])
    warnings.warn(
        f"these ratios ask for {name} = {both[lost] * unit[lost]:.4g} {measure}, by which modes {where} "
        f"{turns:.4g} rad/s would gain energy; without it {given_for_asked(wanted, rows @ alone)}",
        DampingFitWarning,
        stacklevel=3,
    )
    return alone


_CHAINS = (Chain, AxialChain, SpatialChain, StructureChain)


def _of_chain(chain: Chain | AxialChain | SpatialChain | StructureChain, count: int) -> Floats:
    """Return the angular frequencies of so many elastic modes, or of all [rad/s]."""
    if isinstance(chain, Chain):
        model = linearize(chain)
        return solve_modes(model, min(count, model.elastic_modes)).angular_frequency
    if isinstance(chain, AxialChain):
        return solve_axial_modes(chain, count).angular_frequency
    if isinstance(chain, SpatialChain):
        return spatial_modes(chain, count).angular_frequency
    return structure_chain_modes(chain).angular_frequency


def _frequencies(of: Any, modes: list[int]) -> Floats:
    """Return the angular frequencies of modes [rad/s]."""
    last = max(modes)
    if isinstance(of, _CHAINS):
        omega = _of_chain(of, last)
        if last > len(omega):
            raise ValueError(f"ratios must be of modes up to {len(omega)}, got one of mode {last}")
    elif isinstance(getattr(of, "angular_frequency", None), np.ndarray):
        omega = np.asarray(of.angular_frequency, dtype=np.float64)
    elif isinstance(of, Mapping):
        known = {
            whole_number("mode in of", mode): positive_real(f"of[{mode}]", hertz)
            for mode, hertz in bounded("of", of.items(), most=10**4)
        }
        if missing := [mode for mode in modes if mode not in known]:
            raise ValueError(f"of must have the frequencies of modes {modes}, got none of {missing}")
        return 2 * math.pi * np.array([known[mode] for mode in modes])
    elif is_text(of) or not np.iterable(of):
        raise TypeError(f"of must be a Chain, modes, or frequencies in Hz, got {shown(of)}")
    else:
        omega = 2 * math.pi * _row("of", of)
    if last > len(omega) or not (omega > 0.0).all():
        raise ValueError(f"of must have positive frequencies of {last} modes, got {shown(of)}")
    return np.asarray(omega[np.array(modes) - 1])
