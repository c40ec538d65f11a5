"""A chain beside the beam that it stands for, and beside what Euler-Bernoulli theory itself leaves out."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

from beammodes.chains.chain import Chain
from beammodes.checks import positive_real, shown, whole_number
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BoundaryLike
from beammodes.problem.loading import Load
from beammodes.problem.profiles import value_at
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

__all__ = ["SHEAR_RATIO", "SlendernessWarning", "chain_errors", "theory_errors"]

#: E/(κG) of a rectangular section, κ = 5/6 and Poisson's ratio 0.3: 2.6/0.8333. An I-beam's is larger.
SHEAR_RATIO = 2 * (1 + 0.3) / (5 / 6)

Array = NDArray[np.float64]


class SlendernessWarning(UserWarning):
    """The beam is so stout that Euler-Bernoulli theory errs more on it than the chain errs on the theory."""


def chain_errors(chain: Chain, modes: int = 3, *, load: Load | None = None) -> Array:
    """Return the relative frequency errors of a chain against its own exact beam.

        e = ω_chain / ω_beam - 1

    For any beam, ends and axial force; both frequencies are solved for, so e is good to 1e-10 absolute, or
    1e-12 on a uniform beam. `frequency_error` is quicker and keeps more digits where it applies.

    Parameters
    ----------
    chain : Chain
        One with a beam, not from pieces.
    modes : int
        How many, from the first.
    load : Load, optional
        An axial force.

    Returns
    -------
    ndarray, shape (modes,) [-]
        NaN beyond the chain's last mode.

    Warns
    -----
    SlendernessWarning
        If the beam has a rotary inertia, and so a known radius of gyration, and `theory_errors` are larger
        than these errors.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, the chain has no beam, or the axial force buckles it.

    Examples
    --------
    >>> taper = Beam(1.0, bending_stiffness=lambda x: (1 - x / 2) ** 3, mass_per_length=lambda x: 1 - x / 2)
    >>> chain_errors(Chain(taper, "clamped-free", segments=20, rule="gregory"), modes=2).round(6)
    array([0.0e+00, 2.5e-05])
    """
    if not isinstance(chain, Chain):
        raise TypeError(f"chain must be a Chain, got {shown(chain)}")
    if chain.beam is None:
        raise ValueError("chain must have a beam to be compared with; one from pieces has none")
    count = whole_number("modes", modes)
    found = solve_modes(linearize(chain, load=load), count).angular_frequency
    errors = np.full(count, np.nan)
    if len(found):
        exact = euler_bernoulli(chain.beam, chain.boundary, len(found), load=load).angular_frequency
        errors[: len(found)] = found / exact - 1
        _warn_if_stout(chain, errors[: len(found)], load)
    return errors


def theory_errors(
    beam: Beam,
    boundary: BoundaryLike,
    modes: int = 3,
    *,
    radius_of_gyration: float | None = None,
    shear_ratio: float = SHEAR_RATIO,
    load: Load | None = None,
) -> Array:
    """Estimate how much lower a real beam's frequencies are than this beam's, which neglects shear.

        δω/ω ≈ -½ ∫ V²/(κGA) dx / ω²  - ½ ∫ ρI φ'² dx,   V = (EI φ'')',  1/(κGA) = (E/κG) r²/EI

    First order in the slenderness, with φ of unit modal mass; the second term, the section's rotary inertia,
    is left out where the beam has it already. A rough size, not a correction: beyond some 10 % take
    Timoshenko's beam, which this project does not have.

    Parameters
    ----------
    beam : Beam
    boundary : str, pair or Boundary
    modes : int
        How many, from the first.
    radius_of_gyration : float [m], optional
        r = √(I/A) of the section; √(ρI/ρA) of the beam by default.
    shear_ratio : float
        E/(κG), 3.12 for a rectangular steel section.
    load : Load, optional
        An axial force.

    Returns
    -------
    ndarray, shape (modes,) [-]

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or no radius of gyration is known.

    Examples
    --------
    >>> theory_errors(Beam.unit(), "pinned-pinned", 2, radius_of_gyration=0.02).round(4)    # -½ r² π² n² 4.12
    array([-0.0081, -0.0325])
    """
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    ratio = positive_real("shear_ratio", shear_ratio)
    exact = euler_bernoulli(beam, boundary, modes, load=load)
    nodes, weights = np.polynomial.legendre.leggauss(200)
    x, weights = beam.length * (nodes + 1) / 2, beam.length * weights / 2
    stiffness, mass = value_at(beam.bending_stiffness, x), value_at(beam.mass_per_length, x)
    own = value_at(beam.rotary_inertia_per_length, x)
    square = own / mass
    if radius_of_gyration is not None:
        square = np.full_like(x, positive_real("radius_of_gyration", radius_of_gyration) ** 2)
    if not np.any(square):
        raise ValueError("radius_of_gyration must be given for a beam without rotary inertia, got None")
    shear = np.gradient(stiffness * exact.shape(x, derivative=2), x, axis=1)
    shearing = (shear**2 * ratio * square / stiffness) @ weights / exact.angular_frequency**2
    turning = (exact.shape(x, derivative=1) ** 2 * np.where(own > 0, 0.0, mass * square)) @ weights
    return np.asarray(-(shearing + turning) / 2)


def _warn_if_stout(chain: Chain, errors: Array, load: Load | None) -> None:
    beam = chain.beam
    assert beam is not None
    if not np.any(value_at(beam.rotary_inertia_per_length, np.array([0.0, beam.length / 2, beam.length]))):
        return
    theory = theory_errors(beam, chain.boundary, len(errors), load=load)
    worse = np.flatnonzero(np.abs(theory) > np.abs(errors))
    if len(worse):
        n = int(worse[0])
        warnings.warn(
            f"shear, which Euler-Bernoulli theory leaves out, lowers frequency {n + 1} of this beam by about "
            f"{-100 * theory[n]:.2g} %, more than the chain's {100 * abs(errors[n]):.2g} %: more segments do "
            "not bring it closer to the real beam",
            SlendernessWarning,
            stacklevel=3,
        )
