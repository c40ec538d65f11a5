"""How well a real beam's frequencies are known.

Materials and dimensions have tolerances. Shear, damping and the give of real supports are other reasons why a
beam's frequencies differ from computed ones; they are not counted here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from beammodes.accuracy.end_numbers import in_beam_units
from beammodes.accuracy.tolerances import Tolerance, dimensions_of, given_tolerances
from beammodes.checks import bounded, positive_real, real, shown, whole_number
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.section_shape import Section

if TYPE_CHECKING:
    import xarray

__all__ = ["MAX_MODES", "MAX_SAMPLES", "frequency_spread"]

#: More samples than this would be a mistake: the third digit of a band takes a hundredth of them.
MAX_SAMPLES = 1_000_000
MAX_MODES = 100
MAX_QUANTILES = 10_000
#: Relative step of the differences that give the sensitivities.
_STEP = 1e-4
_BAND = (0.025, 0.975)
_MATERIAL = ("elastic_modulus", "density", "length")

Array = NDArray[np.float64]


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
    progress: Callable[[int, int], None] | None = None,
) -> xarray.Dataset:
    """Return how widely the exact frequencies of a uniform beam spread with its material and dimensions.

        ω = K √(EI/ρA) / L²,    (σ_ω/ω)² ≈ Σ (∂ln ω/∂ln p)² (σ_p/p)²

    by Monte Carlo, each quantity drawn by itself, and beside it by this first-order law. For a rectangle of
    height h and plain ends (σ_ω/ω)² ≈ ¼ σ_E² + ¼ σ_ρ² + σ_h² + 4 σ_L²; its width does not matter.

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
        The same seed gives the same numbers.
    quantiles : iterable of float
        Between 0 and 1.
    progress : callable, optional
        Called with how many beams are done, and of how many.

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
    >>> from beammodes.problem.sections import Rectangle
    >>> bar = Rectangle(width=0.06, height=0.02)
    >>> spread = frequency_spread(bar, "clamped-free", {"height": 0.025}, modes=1,
    ...                           elastic_modulus=207e9, density=7850.0, length=1.0)
    >>> spread.first_order.values.round(4), spread.half_width.values.round(3)     # 2.5 %/√3, 0.95 x 2.5 %
    (array([0.0144]), array([0.024]))
    """
    nominal = zip(_MATERIAL, (elastic_modulus, density, length), strict=True)
    values = {name: positive_real(name, value) for name, value in nominal} | dimensions_of(section)
    given = given_tolerances(tolerances, values)
    ends, count = Boundary.of(boundary), whole_number("samples", samples, least=100, most=MAX_SAMPLES)
    if progress is not None and not callable(progress):
        raise TypeError(f"progress must be a function of two numbers or None, got {shown(progress)}")
    levels, wanted = _levels(quantiles), whole_number("modes", modes, most=MAX_MODES)
    generator = np.random.default_rng(whole_number("seed", seed, least=0))
    if progress is not None and not callable(progress):
        raise TypeError(f"progress must be a function or None, got {shown(progress)}")
    factors = {name: part.factors(generator, count) for name, part in given.items()}

    def frequencies(changed: dict[str, float]) -> Array:
        return euler_bernoulli(_beam(section, values | changed), ends, wanted).frequency

    centre = frequencies({})
    drawn = np.empty((count, len(centre)))
    for i in range(count):
        drawn[i] = frequencies({name: values[name] * factor[i] for name, factor in factors.items()})
        if progress is not None and ((i + 1) % 100 == 0 or i + 1 == count):
            progress(i + 1, count)
    steep = np.array([_sensitivity(frequencies, name, values[name]) for name in given])
    attributes = {
        "boundary": in_beam_units(ends, _beam(section, values)).name,
        "samples": count,
        "seed": seed,
        "tolerances": "; ".join(f"{name} {part}" for name, part in given.items()),
    }
    return _labelled(centre, drawn, steep, levels, given, attributes)


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
    levels = [real("quantiles", level) for level in bounded("quantiles", quantiles, most=MAX_QUANTILES)]
    if not levels or not all(0.0 <= level <= 1.0 for level in levels):
        raise ValueError(f"quantiles must be numbers between 0 and 1, got {shown(levels)}")
    return levels


def _sensitivity(frequencies: Callable[[dict[str, float]], Array], name: str, value: float) -> Array:
    low, high = (np.log(frequencies({name: value * factor})) for factor in (1 - _STEP, 1 + _STEP))
    return np.asarray((high - low) / np.log((1 + _STEP) / (1 - _STEP)))


def _labelled(
    centre: Array,
    drawn: Array,
    steep: Array,
    levels: list[float],
    given: Mapping[str, Tolerance],
    attributes: dict[str, Any],
) -> xarray.Dataset:
    import xarray

    from beammodes import __version__

    away = drawn / centre - 1
    sigma = away.std(axis=0, ddof=1)
    fourth = ((away - away.mean(axis=0)) ** 4).mean(axis=0)
    deviations = np.array([part.standard_deviation for part in given.values()])
    low, high = np.quantile(away, _BAND, axis=0)
    per_mode = {
        "frequency": (centre, "Hz"),
        "standard_deviation": (sigma, "1"),
        # Of a sample's standard deviation s: √((μ₄ - s⁴)/(4 n s²)).
        "standard_deviation_error": (np.sqrt((fourth - sigma**4) / (4 * len(away))) / sigma, "1"),
        "first_order": (np.sqrt((steep**2 * deviations[:, None] ** 2).sum(axis=0)), "1"),
        "half_width": ((high - low) / 2, "1"),
    }
    return xarray.Dataset(
        {name: ("mode", array, {"units": unit}) for name, (array, unit) in per_mode.items()}
        | {
            "frequency_quantile": (
                ("quantile", "mode"),
                np.quantile(drawn, levels, axis=0),
                {"units": "Hz"},
            ),
            "sensitivity": (("parameter", "mode"), steep, {"units": "1"}),
        },
        coords={
            "mode": np.arange(1, len(centre) + 1),
            "quantile": levels,
            "parameter": list(given),
        },
        attrs={"source": f"beammodes {__version__}", **attributes},
    )
