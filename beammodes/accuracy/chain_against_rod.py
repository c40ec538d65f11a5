"""Errors of chains in space against their own rods."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from beammodes.accuracy.error_table import labelled, listed, numbered
from beammodes.chains.rules import AnyRule, Layout, layout_of
from beammodes.chains.spatial_chain import SpatialChain
from beammodes.checks import instead, shown, whole_number
from beammodes.deferred import Deferred
from beammodes.exact.exact_rod import MOST_ROD_MODES, rod_modes
from beammodes.numerics.arrays import Floats, ratios_less_one
from beammodes.problem.rod import Rod
from beammodes.problem.rod_ends import RodBoundaryLike, RodEnds
from beammodes.vibration.modes_in_space import spatial_modes

if TYPE_CHECKING:
    import xarray
else:
    xarray = Deferred("xarray")

__all__ = ["rod_error_dataset", "rod_errors"]

#: Segments of a chain in a table.
_MOST_SEGMENTS = 10**6


def rod_errors(chain: SpatialChain, modes: int = 3) -> Floats:
    """Return the relative frequency errors of a chain in space against its own exact rod.

        e = ω_chain / ω_rod - 1

    Bending in two planes and twist are numbered together, by frequency: where two are close, a coarse chain
    may have them the other way round. Both frequencies are solved for, so e is good to 1e-11 absolute.

    Parameters
    ----------
    chain : SpatialChain
        The rod that it is compared with neither shears nor stretches.
    modes : int
        How many, from the first, 1 to 100.

    Returns
    -------
    ndarray, shape (modes,) [-]
        NaN beyond the chain's last mode.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind.

    Examples
    --------
    >>> import beammodes as bm
    >>> helix = bm.Rod.helix(radius=0.1, pitch=0.05, turns=1, bending_stiffness=1.3, torsional_stiffness=1.0,
    ...                      mass_per_length=1.0)
    >>> bm.rod_errors(bm.SpatialChain(helix, "clamped-free", segments=20, rule="gregory"), modes=2).round(7)
    array([-2.04e-05, -5.45e-05])
    """
    if not isinstance(chain, SpatialChain):
        planar = "chain_errors takes a chain in a plane, in twist or in stretch"
        hint = instead(chain, Chain=planar, AxialChain=planar, StructureChain=planar)
        raise TypeError(f"chain must be a SpatialChain, got {shown(chain)}{hint}")
    count = whole_number("modes", modes, most=MOST_ROD_MODES)
    found = spatial_modes(chain, count).angular_frequency
    return ratios_less_one(found, _exact(chain.rod, chain.ends, max(len(found), 1)), count)


def _exact(rod: Rod, ends: RodEnds, count: int) -> Floats:
    return rod_modes(rod.unstretched, ends, count).angular_frequency


def rod_error_dataset(
    rod: Rod,
    boundary: RodBoundaryLike,
    *,
    segments: int | Iterable[int],
    modes: int = 3,
    rule: AnyRule | Iterable[AnyRule] = "mitiguy",
) -> xarray.Dataset:
    """Return frequencies and errors of a rod's chains as one labelled table.

    Parameters
    ----------
    rod : Rod
    boundary : str, pair or RodEnds
    segments : int, or iterable of int
    modes : int
        How many, from the first.
    rule : rule, or iterable of rules

    Returns
    -------
    xarray.Dataset
        Dimensions rule, segments, mode; variables relative_error, and angular_frequency [rad/s] of the chain
        and of the rod. NaN where a chain has no such mode or a rule gives no positive springs.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or outside its range.

    Examples
    --------
    >>> import beammodes as bm
    >>> wire = {"bending_stiffness": 1.3, "torsional_stiffness": 1.0, "mass_per_length": 1.0}
    >>> table = bm.rod_error_dataset(bm.Rod.arc(1.5, length=1.0, **wire), "clamped-free", segments=[10, 20],
    ...                              modes=1, rule=["naive", "gregory"])
    >>> (100 * table.relative_error.squeeze()).values.round(4)                  # %
    array([[-8.9295e+00, -4.6713e+00],
           [ 2.0000e-03,  1.0000e-04]])
    """
    if not isinstance(rod, Rod):
        raise TypeError(f"rod must be a Rod, got {shown(rod)}")
    ends, count = RodEnds.of(boundary), whole_number("modes", modes, most=MOST_ROD_MODES)
    rules = [layout_of(name) for name in listed("rule", rule, (str, Layout))]
    counts = [whole_number("segments", n, most=_MOST_SEGMENTS) for n in listed("segments", segments, (str,))]
    exact = _exact(rod, ends, count)
    found = np.full((len(rules), len(counts), count), np.nan)
    for i, j in np.ndindex(len(rules), len(counts)):
        try:
            chain = SpatialChain(rod, ends, counts[j], rules[i])
        except ValueError:
            # No positive springs for these ends and N, or a pattern that does not fit N.
            continue
        omega = spatial_modes(chain, count).angular_frequency
        found[i, j, : len(omega)] = omega
    judge = np.broadcast_to(exact, found.shape)
    return labelled(
        ("rule", "segments", "mode"),
        {
            "relative_error": (found / judge - 1, "frequency of the chain over the rod's, less 1", "1"),
            "angular_frequency": (found, "angular frequency of the chain", "rad / s"),
            "exact_angular_frequency": (judge.copy(), "angular frequency of the rod", "rad / s"),
        },
        {"rule": [record.name for record in rules]} | numbered(counts, count),
        "modes of chains in space and of the exact rod",
    )
