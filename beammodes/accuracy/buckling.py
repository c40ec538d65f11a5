"""The compression at which a straight beam or chain buckles under a pair of dead loads."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, overload

import numpy as np

from beammodes.accuracy.error_table import ChainGrid, labelled
from beammodes.chains.chain import Chain
from beammodes.chains.pieces import MAX_PIECES
from beammodes.chains.rules import AnyRule
from beammodes.chains.structure_chain import StructureChain
from beammodes.checks import instead, shown
from beammodes.deferred import Deferred
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.structure import Structure
from beammodes.vibration.modes import MAX_DENSE
from beammodes.vibration.spectrum import FlexibilityForm, flexibility_form

if TYPE_CHECKING:
    import xarray

    from beammodes.accuracy import loaded_structures
else:
    xarray = Deferred("xarray")
    loaded_structures = Deferred("beammodes.accuracy.loaded_structures")

__all__ = ["buckling_dataset", "buckling_load"]


@overload
def buckling_load(structure: Chain) -> float: ...
@overload
def buckling_load(structure: Beam, boundary: BoundaryLike) -> float: ...
@overload
def buckling_load(
    structure: Structure | StructureChain, *, load: loaded_structures.Loads | None = None
) -> float: ...
def buckling_load(
    structure: Beam | Chain | Structure | StructureChain,
    boundary: BoundaryLike | None = None,
    *,
    load: loaded_structures.Loads | None = None,
) -> float:
    """Return the smallest compression at which a straight beam or chain buckles, or the factor of a load.

        stored energy = P · ½ ∫ y'² dx (beam),  = P · ½ Σ l_i θ_i² (chain)  for one shape, and no smaller P

    The loads are dead: they keep their direction and pull on the beam's two ends. End bodies do not matter,
    supports do. A chain's load is within 1e-13 of its exact value.

    A structure, or a chain of one, buckles under f times its load, f -∫ N y'² in place of P ∫ y'² with the
    axial forces N of its statics. What the load bends before is left out. Right to 1e-10.

    Parameters
    ----------
    structure : Beam, Chain, Structure or StructureChain
    boundary : str, pair or Boundary
        The ends of a beam; chains and structures have their own.
    load : PointLoad, LineLoad, a sequence of these, or Load, optional
        On a structure; of a `Load` the gravity only. If left out, unit forces that compress its only member.

    Returns
    -------
    float [N], or f
        Inf for a chain without an elastic mode, and where a load compresses nothing.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind; if the ends let a rigid rotation store nothing (pinned-free,
        free-free), so that any compression turns it over; or if members that do not stretch leave axial
        forces open, as between two fixed supports.

    Examples
    --------
    >>> import beammodes as bm
    >>> bm.buckling_load(bm.Beam.unit(), "pinned-pinned") - np.pi**2
    0.0
    >>> chain = bm.Chain(bm.Beam.unit(), "pinned-pinned", segments=4, rule="double_wall")
    >>> bool(abs(bm.buckling_load(chain) / (64 * np.sin(np.pi / 8) ** 2) - 1) < 1e-14)      # Hencky's own
    True

    A mast under its own weight, ρA g L³ = 7.837 EI:

    >>> mast = bm.Structure({"foot": bm.Joint(0, 0, "clamped"), "top": bm.Joint(0, 1)},
    ...     [bm.Member(bm.Beam.unit(), "foot", "top")])
    >>> round(bm.buckling_load(mast, load=bm.Load(gravity=1.0)), 6)
    7.837347
    """
    if isinstance(structure, Structure | StructureChain):
        if boundary is not None:
            raise TypeError(
                f"boundary must be left out for a structure, which has its own, got {shown(boundary)}"
            )
        from beammodes.accuracy.stressed_structures import structure_buckling_load

        return structure_buckling_load(structure, load)
    if load is not None:
        raise TypeError(
            "load must be left out for a beam or chain, whose two ends are compressed, got "
            f"{shown(load)}; a Structure takes loads"
        )
    if isinstance(structure, Chain):
        if boundary is not None:
            raise TypeError(
                f"boundary must be left out for a chain, which has its own, got {shown(boundary)}"
            )
        return _chain_load(structure)
    if not isinstance(structure, Beam):
        space = "critical_factor takes a SpatialChain and a SpatialLoad"
        raise TypeError(
            f"structure must be a Beam, Chain, Structure or StructureChain, got {shown(structure)}"
            f"{instead(structure, SpatialChain=space, Rod=space)}"
        )
    if boundary is None:
        raise TypeError("boundary must be given for a beam, got None")
    pair = Boundary.of(boundary)
    if structure.is_uniform:
        from beammodes.exact.supported_beam import critical_compression

        return critical_compression(structure, pair)
    from beammodes.exact.spectral_beam import spectral_buckling

    return spectral_buckling(structure, pair)


def buckling_dataset(
    *,
    boundary: BoundaryLike | Iterable[BoundaryLike],
    segments: int | Iterable[int],
    rule: AnyRule | Iterable[AnyRule] = "mitiguy",
    beam: Beam | None = None,
) -> xarray.Dataset:
    """Return buckling loads of chains beside the beam's as one labelled table.

    Parameters
    ----------
    boundary : boundary, or iterable of boundaries
    segments : int, or iterable of int
    rule : rule, or iterable of rules
    beam : Beam, optional
        In whose units numbers of the ends are; without one they are multiples of ρA L, ρA L³, L, EI/L³ and
        EI/L.

    Returns
    -------
    xarray.Dataset
        Dimensions rule, boundary, segments; variables buckling_load, exact_buckling_load (both in N with a
        `beam`, else multiples of EI/L²) and relative_error; NaN where a chain has no elastic mode or no
        positive springs.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or outside its range, or a pair does not buckle.

    Examples
    --------
    >>> import beammodes as bm
    >>> rules = ["double_wall", "gregory"]
    >>> table = bm.buckling_dataset(boundary="clamped-free", segments=[10, 20], rule=rules)
    >>> table.relative_error.squeeze().values.round(6)
    array([[-0.002054, -0.000514],
           [-0.00212 , -0.000524]])
    """
    grid = ChainGrid.of(boundary, segments, rule, MAX_PIECES, beam).canonical
    exact = np.array([buckling_load(grid.beam, pair) for pair in grid.boundaries])
    load = np.full(grid.shape, np.nan)
    for index, chain in grid.chains():
        load[index] = buckling_load(chain) if chain.elastic_modes else np.nan
    units = "EI / L^2" if grid.beam == Beam.unit() else "N"
    exact_load = np.where(np.isnan(load), np.nan, exact[None, :, None])
    return labelled(
        ("rule", "boundary", "segments"),
        {
            "buckling_load": (load, "buckling load of the chain", units),
            "exact_buckling_load": (exact_load, "buckling load of the beam", units),
            "relative_error": (load / exact_load - 1, "relative error of the buckling load", "1"),
        },
        grid.coordinates(),
        "flexibility form",
    )


def _chain_load(chain: Chain) -> float:
    form = flexibility_form(chain)
    # A unit axial force pulls on each piece with its length.
    form = replace(form, pull=form.length)
    if form.rigid_angle.any():
        raise ValueError(
            "boundary must resist a rigid rotation of the chain to have a buckling load, "
            f"got {chain.boundary.name}"
        )
    if not chain.elastic_modes:
        return np.inf
    dense = form.hinges <= MAX_DENSE
    steepest = _dense_steepest(form) if dense else _iterated_steepest(form)
    # Where only an end without length turns, no compression does any work.
    return float(chain.units.stiffness / chain.units.length / steepest) if steepest else np.inf


def _dense_steepest(form: FlexibilityForm) -> float:
    """Return the largest Σ l θ² of unit stored energy."""
    coordinates, excluded = form.forbidden.shape
    complete = np.linalg.qr(form.forbidden, mode="complete")[0] if excluded else np.eye(coordinates)
    slope = np.sqrt(form.length)[:, None] * form.angles(form.allowed(complete[:, excluded:]))
    return float(np.linalg.norm(slope, 2) ** 2)


def _iterated_steepest(form: FlexibilityForm) -> float:
    from scipy.sparse.linalg import LinearOperator, eigsh

    size = len(form.flexibility_root)

    def steepness(w: Floats) -> Floats:
        return form.allowed(form.geometric(form.allowed(w.reshape(size, -1))))

    operator = LinearOperator((size, size), matvec=steepness, matmat=steepness, dtype=np.float64)
    start = form.allowed(np.random.default_rng(0).standard_normal((size, 1)))[:, 0]
    return float(eigsh(operator, k=1, which="LA", v0=start, tol=1e-14, return_eigenvectors=False)[0])
