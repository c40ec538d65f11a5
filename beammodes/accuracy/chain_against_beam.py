"""Errors of a chain against its own beam, and errors of Euler-Bernoulli theory against a real beam."""

from __future__ import annotations

import warnings
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from beammodes.accuracy.axial_errors import no_load
from beammodes.accuracy.errors import MAX_MODES
from beammodes.chains.axial_chain import AxialChain
from beammodes.chains.chain import Chain
from beammodes.chains.structure_chain import StructureChain
from beammodes.checks import shown, whole_number
from beammodes.deferred import Deferred
from beammodes.exact.axial_theory import axial_modes
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.exact.timoshenko_beam import MOST_MODES, theory_error_of
from beammodes.numerics.arrays import Floats, ratios_less_one
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.loading import Load, checked_load
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

if TYPE_CHECKING:
    from beammodes.accuracy import loaded_structures
else:
    loaded_structures = Deferred("beammodes.accuracy.loaded_structures")

__all__ = ["SlendernessWarning", "chain_errors", "stout_remark", "theory_errors"]

#: Errors of the theory below this are not told: no beam's stiffness and mass are known so well.
_LEAST_TOLD = 1e-3


class SlendernessWarning(UserWarning):
    """Warning of a stout beam: Euler-Bernoulli theory errs more on it than the chain on the theory."""


def chain_errors(
    chain: Chain | AxialChain | StructureChain, modes: int = 3, *, load: loaded_structures.Loads | None = None
) -> Floats:
    """Return the relative frequency errors of a chain against its own exact beam or structure.

        e = ω_chain / ω_beam - 1

    For any beam, ends and axial force; both frequencies are solved for, so e is good to 1e-10 absolute, or
    1e-12 on a uniform beam. `frequency_error` is quicker and keeps more digits where it applies.

    Parameters
    ----------
    chain : Chain, AxialChain or StructureChain
        One with a beam, not from pieces.
    modes : int
        How many, from the first; 1 to 100 of a structure.
    load : Load, optional
        An axial force. On a structure any load, as of `structure_modes_under`.

    Returns
    -------
    ndarray, shape (modes,) [-]
        NaN beyond the chain's last mode.

    Warns
    -----
    SlendernessWarning
        If the beam's section is known, from `Beam.from_section` or by its rotary inertia, and `theory_errors`
        are larger than these errors and than 0.1 %.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, the chain has no beam, or the axial force buckles it.

    Examples
    --------
    >>> import beammodes as bm
    >>> taper = bm.Beam(1.0, lambda x: (1 - x / 2) ** 3, lambda x: 1 - x / 2)
    >>> bm.chain_errors(bm.Chain(taper, "clamped-free", segments=20, rule="gregory"), modes=2).round(6)
    array([0.0e+00, 2.5e-05])
    """
    if isinstance(chain, StructureChain):
        from beammodes.accuracy.structure_errors import errors_of_structure

        return errors_of_structure(chain, modes, load)
    if load is not None and not isinstance(load, Load):
        raise TypeError(f"load must be a Load for a chain of one beam, got {shown(load)}")
    if isinstance(chain, AxialChain):
        no_load(load, chain.motion)
        return _errors_along(chain, whole_number("modes", modes, most=MAX_MODES))
    if not isinstance(chain, Chain):
        raise TypeError(
            f"chain must be a Chain, AxialChain or StructureChain, got {shown(chain)}; rod_errors takes a "
            "SpatialChain"
        )
    if chain.beam is None:
        raise ValueError("chain must have a beam to be compared with; one from pieces has none")
    count = whole_number("modes", modes, most=MAX_MODES)
    found = solve_modes(linearize(chain, load=load), count).angular_frequency
    if not len(found):
        return np.full(count, np.nan)
    exact = euler_bernoulli(chain.beam, chain.boundary, len(found), load=load)
    errors = ratios_less_one(found, exact.angular_frequency, count)
    # A load that the stiffer theory bears may buckle the softer one, which then has nothing to compare.
    with suppress(ValueError, ArithmeticError):
        if remark := _stout(errors[: len(found)], exact.theory_error, exact.theory_assumed):
            warnings.warn(remark, SlendernessWarning, stacklevel=2)
    return errors


def _errors_along(chain: AxialChain, count: int) -> Floats:
    found = solve_modes(chain, count).angular_frequency
    if not len(found):
        return np.full(count, np.nan)
    exact = axial_modes(chain.beam, chain.boundary, len(found), motion=chain.motion)
    return ratios_less_one(found, exact.angular_frequency, count)


def theory_errors(
    beam: Beam,
    boundary: BoundaryLike,
    modes: int = 3,
    *,
    radius_of_gyration: float | None = None,
    shear_ratio: float | None = None,
    load: Load | None = None,
) -> Floats:
    """Return how much lower a real beam's frequencies are than this beam's, which neglects shear.

        ω_Timoshenko / ω_beam - 1

    of the n-th modes, both solved for. What a chain of this beam has beside its own error e: against the real
    beam it errs by (1 + e)/(1 + this) - 1, which more segments bring no lower than this.

    Parameters
    ----------
    beam : Beam
        Its own rotary inertia, where it has one, is in both frequencies.
    boundary : str, pair or Boundary
    modes : int
        How many, from the first, 1 to 100.
    radius_of_gyration : float [m], optional
        r = √(I/A) of the section; the beam's own, or √(ρI/ρA), by default.
    shear_ratio : float, optional
        E/(κG), for κGA = EI/(r² E/(κG)). The beam's own shear stiffness by default, and where it has none
        3.12, a rectangle's with Poisson's ratio 0.3.
    load : Load, optional
        One that leaves the beam straight.

    Returns
    -------
    ndarray, shape (modes,) [-]
        NaN for modes beyond Timoshenko's cut-off frequency √(κGA/ρI): from there on modes of shear lie among
        those of bending, and n-th modes are not of one kind.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or no radius of gyration is known.

    Examples
    --------
    >>> import beammodes as bm
    >>> bm.theory_errors(bm.Beam.unit(), "pinned-pinned", 2, radius_of_gyration=0.02).round(4)
    array([-0.008 , -0.0307])
    """
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    count, pull = whole_number("modes", modes, most=MOST_MODES), checked_load(load)
    omega = euler_bernoulli(beam, boundary, count, load=load).angular_frequency
    errors = theory_error_of(beam, Boundary.of(boundary), pull, omega, radius_of_gyration, shear_ratio)
    if errors is None:
        raise ValueError(
            "radius_of_gyration must be given for a beam that has neither one nor a rotary inertia, "
            "got None; Beam.from_section knows it"
        )
    return errors


def _stout(errors: Floats, theory: Floats, assumed: tuple[str, ...]) -> str:
    worse = np.flatnonzero(np.abs(theory) > np.maximum(np.abs(errors), _LEAST_TOLD))
    if not len(worse):
        return ""
    n = int(worse[0])
    taken = f" (assumed: {', '.join(assumed)})" if assumed else ""
    return (
        f"shear and what else Euler-Bernoulli theory leaves out lower frequency {n + 1} of this beam by "
        f"{-100 * theory[n]:.3g} %{taken}, more than the chain's {100 * abs(errors[n]):.2g} %: more "
        "segments do not bring it closer to the real beam"
    )


def stout_remark(beam: Beam, boundary: BoundaryLike, errors: Floats) -> str:
    """Return the words of `SlendernessWarning` for a chain's errors, "" where they are the larger ones.

    Also "" where nothing tells the beam's section, or a mode is missing.

    Examples
    --------
    >>> stout = Beam(1.0, 1.0, 1.0, radius_of_gyration=0.1)
    >>> stout_remark(stout, "clamped-free", np.array([1e-3]))[:49]
    'shear and what else Euler-Bernoulli theory leaves'
    >>> stout_remark(Beam.unit(), "clamped-free", np.array([1e-3]))
    ''
    """
    known = beam.shear_stiffness is not None or beam.radius_of_gyration is not None or beam.has_rotary_inertia
    count = len(errors) - int(np.isnan(errors).sum())
    if not known or not count:
        return ""
    with suppress(ValueError, ArithmeticError):
        exact = euler_bernoulli(beam, boundary, count)
        return _stout(errors[:count], exact.theory_error, exact.theory_assumed)
    return ""
