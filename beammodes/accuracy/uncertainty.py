"""The spread of a real beam's frequencies with its tolerances, and the segments that are enough for it.

Materials and dimensions have tolerances. Shear, damping and the give of real supports are other reasons why a
beam's frequencies differ from computed ones; they are not counted here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from beammodes.accuracy.beam_units import in_beam_units
from beammodes.accuracy.errors import frequency_error
from beammodes.accuracy.segments import segments_needed
from beammodes.chains.rules import AnyRule, layout_of
from beammodes.checks import Shown, bounded, choice, positive_real, real, shown, whole_number
from beammodes.deferred import Deferred
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.numerics.arrays import Floats
from beammodes.numerics.distributions import MAX_SEED, Distribution, Normal, Uniform, draw
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.sections import Section, Tube
from beammodes.progress import Progress, progress_of
from beammodes.version import SOURCE

if TYPE_CHECKING:
    import xarray
else:
    xarray = Deferred("xarray")

__all__ = ["EnoughSegments", "Tolerance", "frequency_spread", "segments_within_spread"]

#: Wider ones would make beams of no thickness, or of a negative one.
_WIDEST = {"uniform": 1.0, "normal": 0.1}

#: More would be a mistake: the third digit of a band takes a hundredth of these samples.
_MAX_SAMPLES, _MAX_MODES, _MAX_QUANTILES = 1_000_000, 100, 10_000

#: Relative step of the differences that give the sensitivities.
_STEP = 1e-4

_BAND = (0.025, 0.975)
_MATERIAL = ("elastic_modulus", "density", "length")


@dataclass(frozen=True, slots=True, repr=False)
class Tolerance(Shown):
    """Tolerance of a number, as a fraction of its nominal value.

    Parameters
    ----------
    size : float
        Half the width of a uniform distribution, less than 1, or the standard deviation of a normal one, at
        most 0.1.
    distribution : str
        "uniform" or "normal".

    Raises
    ------
    TypeError, ValueError
        If `size` is no real number greater than 0 and within its limit, or the distribution is unknown.

    Examples
    --------
    >>> import beammodes as bm
    >>> bm.Tolerance(0.03).around(200e9)
    Uniform(low=194000000000.0, high=206000000000.0)
    """

    size: float
    distribution: str = "uniform"

    def __post_init__(self) -> None:
        choice("distribution", self.distribution, _WIDEST)
        size, widest = positive_real("size", self.size), _WIDEST[self.distribution]
        if size > widest or size == 1.0:
            raise ValueError(
                f"size must be {'less than 1' if widest == 1.0 else f'at most {widest}'} "
                f"for a {self.distribution} distribution, got {shown(self.size)}"
            )
        object.__setattr__(self, "size", size)

    @property
    def standard_deviation(self) -> float:
        """σ over the nominal value."""
        return self.size / math.sqrt(3) if self.distribution == "uniform" else self.size

    def around(self, value: float) -> Distribution:
        """Return the distribution of a number with this nominal value, greater than 0."""
        half = self.size * value
        return Uniform(value - half, value + half) if self.distribution == "uniform" else Normal(value, half)

    def __str__(self) -> str:
        sign = "±" if self.distribution == "uniform" else "σ = "
        return f"{self.distribution} {sign}{100 * self.size:.3g} %"


def frequency_spread(
    section: Section,
    boundary: BoundaryLike,
    tolerances: Mapping[str, float | Tolerance],
    modes: int = 3,
    *,
    elastic_modulus: float,
    density: float,
    length: float,
    samples: int = 10_000,
    seed: int = 0,
    quantiles: Iterable[float] = (0.025, 0.5, 0.975),
    progress: Progress | bool | None = False,
) -> xarray.Dataset:
    """Return the spread of a uniform beam's exact frequencies with its material and dimensions.

        ω = K √(EI/ρA) / L²,    (σ_ω/ω)² ≈ Σ (∂ln ω/∂ln p)² (σ_p/p)²

    by Monte Carlo, each quantity drawn by itself, as `Study.sampled` draws it, and by this first-order law.
    For a rectangle of height h and plain ends (σ_ω/ω)² ≈ ¼ σ_E² + ¼ σ_ρ² + σ_h² + 4 σ_L²; its width does not
    matter.

    Parameters
    ----------
    section : Section
        One of `sections`, or anything with an `area` [m²] and a `second_moment` [m⁴].
    boundary : str, pair or Boundary
        Springs and bodies have the numbers given, in SI units, and no tolerance of their own.
    tolerances : mapping from str to float or Tolerance
        Of elastic_modulus, density, length and the section's dimensions (outer and wall of a tube) as
        fractions of them; a number is uniform, within ± that. What is not named is exact.
    modes : int
        How many, from the first; at most 100.
    elastic_modulus, density, length : float [Pa], [kg/m³], [m]
        Nominal values.
    samples : int
        How many beams are drawn, 100 to a million: 0.1 ms each with plain ends, else some 10 ms.
    seed : int
        The same seed gives the same numbers; from 0 to 2⁶⁴ - 1.
    quantiles : iterable of float
        Between 0 and 1.
    progress : callable, bool or None
        Called with how many beams are done, and of how many; True shows a line, None only on a terminal.

    Returns
    -------
    xarray.Dataset
        Over mode, quantile and parameter: frequency [Hz] of the nominal beam, frequency_quantile [Hz], and
        as fractions of the nominal frequency standard_deviation, standard_deviation_error (its own standard
        error), first_order (σ by the law above) and half_width of the band that holds 95 %; sensitivity is
        ∂ln ω/∂ln p.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or out of range, or a tolerance makes no section.

    Examples
    --------
    >>> import beammodes as bm
    >>> bar = bm.Rectangle(width=0.06, height=0.02)
    >>> spread = bm.frequency_spread(bar, "clamped-free", {"height": 0.025}, modes=1,
    ...                              elastic_modulus=207e9, density=7850.0, length=1.0)
    >>> spread.first_order.values.round(4), spread.half_width.values.round(3)     # 2.5 %/√3, 0.95 x 2.5 %
    (array([0.0144]), array([0.024]))
    """
    nominal = zip(_MATERIAL, (elastic_modulus, density, length), strict=True)
    values = {name: positive_real(name, value) for name, value in nominal} | _dimensions(section)
    given = _tolerances(tolerances, values)
    ends, count = Boundary.of(boundary), whole_number("samples", samples, least=100, most=_MAX_SAMPLES)
    levels, wanted = _levels(quantiles), whole_number("modes", modes, most=_MAX_MODES)
    key = whole_number("seed", seed, least=0, most=MAX_SEED)
    told = progress_of(progress, "spread", "beams")

    def frequencies(changed: dict[str, float]) -> Floats:
        return euler_bernoulli(_beam(section, values | changed), ends, wanted).frequency

    centre = frequencies({})
    parameters = {name: draw(part.around(values[name]), key, name, 0, count) for name, part in given.items()}
    drawn = np.empty((count, len(centre)))
    for i in range(count):
        drawn[i] = frequencies({name: float(column[i]) for name, column in parameters.items()})
        if (i + 1) % 100 == 0 or i + 1 == count:
            told(i + 1, count)
    steep = np.array([_sensitivity(frequencies, name, values[name]) for name in given])
    attributes = {
        "source": SOURCE,
        "boundary": in_beam_units(ends, _beam(section, values)).name,
        "samples": count,
        "seed": key,
        "tolerances": "; ".join(f"{name} {part}" for name, part in given.items()),
    }
    return _estimates(centre, drawn, steep, levels, given, attributes)


def _dimensions(section: Section) -> dict[str, float]:
    """Return a section's dimensions by name, as its class takes them; none of one from elsewhere."""
    for name in ("area", "second_moment"):
        if not hasattr(section, name):
            raise TypeError(f"section must have its {name}, got {shown(section)}")
    if not hasattr(section, "__dataclass_fields__"):
        return {}
    kept: Any = section
    # A tube takes two of its three numbers; its wall keeps the digits of a thin one.
    names = [f.name for f in fields(kept) if not (isinstance(section, Tube) and f.name == "inner")]
    # A handbook's section may lack its torsion constant.
    return {name: float(getattr(kept, name)) for name in names if getattr(kept, name) is not None}


def _tolerances(given: Any, values: Mapping[str, float]) -> dict[str, Tolerance]:
    if not isinstance(given, Mapping):
        raise TypeError(f"tolerances must map names to numbers, got {shown(given)}")
    if not given:
        raise ValueError(f"tolerances must name at least one of {', '.join(values)}, got none")
    found = {}
    for name, part in given.items():
        choice("name of a tolerance", name, values)
        try:
            found[name] = part if isinstance(part, Tolerance) else Tolerance(part)
        except (TypeError, ValueError) as error:
            raise type(error)(f"tolerance of {name}: {error}") from None
    return found


def _beam(section: Section, values: Mapping[str, float]) -> Beam:
    sizes = {name: value for name, value in values.items() if name not in _MATERIAL}
    kind: Any = type(section)
    modulus, density, length = (values[name] for name in _MATERIAL)
    return Beam.from_section(
        kind(**sizes) if sizes else section, elastic_modulus=modulus, density=density, length=length
    )


def _levels(quantiles: Any) -> list[float]:
    if isinstance(quantiles, str) or not isinstance(quantiles, Iterable):
        raise TypeError(f"quantiles must be numbers between 0 and 1, got {shown(quantiles)}")
    levels = [real("quantiles", level) for level in bounded("quantiles", quantiles, most=_MAX_QUANTILES)]
    if not levels or not all(0.0 <= level <= 1.0 for level in levels):
        raise ValueError(f"quantiles must be numbers between 0 and 1, got {shown(levels)}")
    return levels


def _sensitivity(frequencies: Callable[[dict[str, float]], Floats], name: str, value: float) -> Floats:
    low, high = (np.log(frequencies({name: value * factor})) for factor in (1 - _STEP, 1 + _STEP))
    return np.asarray((high - low) / np.log((1 + _STEP) / (1 - _STEP)))


def _estimates(
    centre: Floats,
    drawn: Floats,
    steep: Floats,
    levels: list[float],
    given: Mapping[str, Tolerance],
    attributes: dict[str, Any],
) -> xarray.Dataset:
    import xarray

    away = drawn / centre - 1
    sigma = away.std(axis=0, ddof=1)
    fourth = ((away - away.mean(axis=0)) ** 4).mean(axis=0)
    deviations = np.array([part.standard_deviation for part in given.values()])
    low, high = np.quantile(away, _BAND, axis=0)
    variables = {
        "frequency": ("mode", centre, "Hz"),
        "standard_deviation": ("mode", sigma, "1"),
        # Of a sample's standard deviation s: √((μ₄ - s⁴)/(4 n s²)).
        "standard_deviation_error": ("mode", np.sqrt((fourth - sigma**4) / (4 * len(away))) / sigma, "1"),
        "first_order": ("mode", np.sqrt((steep**2 * deviations[:, None] ** 2).sum(axis=0)), "1"),
        "half_width": ("mode", (high - low) / 2, "1"),
        "frequency_quantile": (("quantile", "mode"), np.quantile(drawn, levels, axis=0), "Hz"),
        "sensitivity": (("parameter", "mode"), steep, "1"),
    }
    return xarray.Dataset(
        {name: (dims, array, {"units": unit}) for name, (dims, array, unit) in variables.items()},
        coords={"mode": np.arange(1, len(centre) + 1), "quantile": levels, "parameter": list(given)},
        attrs=attributes,
    )


@dataclass(frozen=True, repr=False)
class EnoughSegments(Shown):
    """Number of segments that keeps a chain's error inside the spread of its beam; `str` says it.

    Attributes
    ----------
    rule : str
    segments : int
    modes : int
    largest_error : float
        Largest |e| of those modes with that many segments.
    half_width : float
        Of the beam's own 95 % band, in the mode in which it is narrowest.
    fraction : float
        What part of that the error may be.
    """

    rule: str
    segments: int
    modes: int
    largest_error: float
    half_width: float
    fraction: float

    def _line(self) -> str:
        return (
            f"EnoughSegments({self.segments} by rule {self.rule}: error {100 * self.largest_error:.2g} % at "
            f"most, the beam's own spread ±{100 * self.half_width:.2g} %)"
        )

    def __str__(self) -> str:
        which = "mode 1" if self.modes == 1 else f"modes 1 to {self.modes}"
        return (
            f"{self.segments} segments by rule {self.rule} are enough: their error in {which}, at most "
            f"{100 * self.largest_error:.2g} %, stays below {100 * self.fraction:.0f} % of what the beam "
            f"itself leaves open, ±{100 * self.half_width:.2g} % (95 %)"
        )


def segments_within_spread(
    spread: xarray.Dataset, rule: AnyRule = "mitiguy", *, fraction: float = 1 / 3
) -> EnoughSegments:
    """Return the fewest segments whose error stays below a fraction of the beam's own spread.

        N = min { n : |e_k(n')| ≤ fraction · U for all n' ≥ n and every mode k }

    U is half the width of the 95 % band, of the narrowest mode. At a third of it the error, added as an
    independent one, widens the band by 5 %: √(1 + 1/9).

    Parameters
    ----------
    spread : xarray.Dataset
        From `frequency_spread`, whose modes and ends count.
    rule : str or Rule
    fraction : float
        Greater than 0 and at most 1.

    Returns
    -------
    EnoughSegments
        N, the width of the band, and the mode that decides.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or no chain of up to 10⁹ segments is that good.

    Examples
    --------
    >>> import beammodes as bm
    >>> bar = bm.Rectangle(width=0.06, height=0.02)
    >>> spread = bm.frequency_spread(bar, "clamped-free", {"height": 0.025}, samples=1000,
    ...                              elastic_modulus=207e9, density=7850.0, length=1.0)
    >>> print(bm.segments_within_spread(spread, "gregory"))
    9 segments by rule gregory are enough: their error in modes 1 to 3, at most 0.41 %, stays below 33 % of
    what the beam itself leaves open, ±2.3 % (95 %)
    """
    import xarray

    if not isinstance(spread, xarray.Dataset) or "half_width" not in spread or "boundary" not in spread.attrs:
        raise TypeError(
            f"spread must be a Dataset from frequency_spread(), got {shown(type(spread).__name__)}"
        )
    part = positive_real("fraction", fraction)
    if not 1e-12 <= part <= 1.0:
        raise ValueError(f"fraction must be at least 1e-12 and at most 1, got {shown(fraction)}")
    width, modes = float(spread.half_width.min()), spread.sizes["mode"]
    boundary: str = spread.attrs["boundary"]
    count = segments_needed(boundary, part * width, modes, rule)
    error = frequency_error(boundary, segments=count, mode=np.arange(1, modes + 1), rule=rule)
    return EnoughSegments(layout_of(rule).name, count, modes, float(np.abs(error).max()), width, part)
