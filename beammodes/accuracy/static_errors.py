"""Static errors of chains as one labelled table."""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from beammodes.accuracy.grids import ChainGrid
from beammodes.accuracy.loads import LENGTHS, LOADS, without_rigid_motion
from beammodes.accuracy.statics import beam_statics, chain_statics
from beammodes.chains.chain import MAX_PIECES, Chain
from beammodes.chains.rules import AnyRule
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BoundaryLike

if TYPE_CHECKING:
    import xarray

__all__ = ["STATIC_QUANTITIES", "chain_static_errors", "static_dataset"]

#: What bends under a static load, as datasets name its relative error with "_error" after it.
STATIC_QUANTITIES = ("tip_deflection", "tip_rotation", "midspan_deflection")


def static_dataset(
    *,
    boundary: BoundaryLike | Iterable[BoundaryLike],
    segments: int | Iterable[int],
    rule: AnyRule | Iterable[AnyRule] = "mitiguy",
) -> xarray.Dataset:
    """Return static errors of chains as one labelled table; they need no beam, its numbers scale out.

    e = y_chain / y_beam - 1

    Parameters
    ----------
    boundary : boundary, or iterable of boundaries
        Without rigid-body motion.
    segments : int, or iterable of int
    rule : rule, or iterable of rules

    Returns
    -------
    xarray.Dataset
        Dimensions rule, boundary, segments, static_load; variables tip_deflection_error, tip_rotation_error
        and midspan_deflection_error, signed and relative; NaN where the tip is held, where the load moves
        no beam, and where a rule gives no positive springs.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or outside its range.

    Examples
    --------
    >>> table = static_dataset(boundary="clamped-free", segments=[4, 10], rule=["mitiguy", "naive"])
    >>> table.tip_deflection_error.sel(static_load="tip_force").squeeze().values
    array([[0.     , 0.     ],
           [0.40625, 0.155  ]])
    """
    import xarray

    from beammodes import __version__

    grid = ChainGrid.of(boundary, segments, rule, MAX_PIECES)
    for pair in grid.boundaries:
        without_rigid_motion(pair)
    errors = np.full((3, *grid.shape, len(LOADS)), np.nan)
    for index, chain in grid.chains():
        errors[:, *index, :] = np.transpose([chain_static_errors(chain, load) for load in LOADS])
    dims = ("rule", "boundary", "segments", "static_load")
    labels = {
        name: f"relative error of the chain's static {name.replace('_', ' ')}" for name in STATIC_QUANTITIES
    }
    return xarray.Dataset(
        {
            f"{name}_error": (dims, error, {"long_name": label, "units": "1"})
            for (name, label), error in zip(labels.items(), errors, strict=True)
        },
        coords={**grid.coordinates(), "static_load": list(LOADS)},
        attrs={"source": f"beammodes {__version__}", "route": "equilibrium in exact fractions"},
    )


def chain_static_errors(chain: Chain, load: str) -> list[float]:
    """Return the error of each of `STATIC_QUANTITIES` of a rule's chain, rounded once from its exact value.

    Examples
    --------
    >>> chain_static_errors(Chain(Beam.unit(), "clamped-free", 4, "naive"), "tip_force")[0]
    0.40625
    """
    assert chain.segments is not None  # A rule made it.
    scale = Fraction(chain.segments) ** (LENGTHS[load] + 1)
    exact = beam_statics(Beam.unit(), chain.boundary, load).own
    factors = (scale * chain.segments, scale, scale * chain.segments)
    return [
        float(ours / (theirs * factor) - 1) if theirs else math.nan
        for ours, theirs, factor in zip(chain_statics(chain, load).own, exact, factors, strict=True)
    ]
