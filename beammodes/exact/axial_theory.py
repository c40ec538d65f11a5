"""The exact beam in twist and stretch, whether uniform or not: the judge of their chains."""

from __future__ import annotations

from beammodes.checks import whole_number
from beammodes.exact.axial_beam import AxialModes, uniform_axial_modes
from beammodes.exact.varying_axial_beam import varying_axial_modes
from beammodes.problem.axial_ends import AxialBoundary, AxialBoundaryLike
from beammodes.problem.beam import Beam
from beammodes.problem.motions import MOTIONS, Motion

__all__ = ["axial_modes"]

_MOST_MODES = 100_000


def axial_modes(
    beam: Beam, boundary: AxialBoundaryLike, modes: int, *, motion: str | Motion = "twist"
) -> AxialModes:
    """Return the exact first elastic modes of a beam in twist or stretch.

        ω_n = (β_n/L) √(GJ/ρIp),  or √(EA/ρA) in stretch:  β = (2n - 1) π/2 fixed-free, nπ fixed-fixed and
        free-free,  tan β = -β J... with discs and springs (see the file's head)

    Twist is Saint-Venant's: warping that an end holds stiffens open sections, which is left out; so is the
    lateral inertia of a stretched rod, which lowers ω by ½ (ν β r/L)², r the polar radius of gyration.

    Parameters
    ----------
    beam : Beam
        With its torsional_stiffness and polar_inertia_per_length in twist, axial_stiffness in stretch; where
        they vary along it, at most 100 modes are found, to 1e-10.
    boundary : str, pair of words or AxialEnd, or AxialBoundary
        "fixed-free", "fixed-free(inertia=0.5)" [kg m²], "free(stiffness=2)-free" [N m/rad]; in stretch
        "free(mass=0.5)" [kg] and stiffness in N/m.
    modes : int
        How many, from the first.
    motion : str
        "twist" or "stretch".

    Returns
    -------
    AxialModes
        Frequencies, shapes and the boundary; modes in the order of their frequencies.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or the beam lacks a number, which is named.
    ArithmeticError
        If a body or spring of an end is some 30 decades beyond the beam's own.

    Examples
    --------
    >>> import beammodes as bm
    >>> rod = bm.Beam.from_section(bm.Circle(0.010), length=0.5, elastic_modulus=206e9, density=7850.0,
    ...                            poisson_ratio=0.3)                                     # m, Pa, kg/m³
    >>> bm.axial_modes(rod, "fixed-free", 3).frequency.round(1)                           # Hz, (2n-1) c/4L
    array([1588.5, 4765.4, 7942.4])
    >>> bm.axial_modes(rod, "fixed-free", 1, motion="stretch")
    AxialModes(fixed-free in stretch: 2561 Hz)
    >>> stepped = bm.Beam(1.0, 1.0, 1.0, torsional_stiffness=[2.0, 1.0], polar_inertia_per_length=1.0)
    >>> bm.axial_modes(stepped, "fixed-free", 2).angular_frequency.round(6)       # rad/s
    array([2.033339, 5.37875 ])
    """
    pair = AxialBoundary.of(boundary, motion)
    count = whole_number("modes", modes, most=_MOST_MODES)
    if MOTIONS[pair.motion].is_uniform(beam):
        return uniform_axial_modes(beam, pair, count)
    return varying_axial_modes(beam, pair, count)
