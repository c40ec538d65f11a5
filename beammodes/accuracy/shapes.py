"""Mode shapes of the chain against the beam's: their modal assurance and largest deviation.

A chain may have a frequency right and its shape wrong. Shapes are compared at the chain's nodes, where both
are defined, each node weighed with its share of the mass: half of each piece that it ends. Nodes that a piece
of length zero doubles count once.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from beammodes.accuracy.error_table import ChainGrid, labelled
from beammodes.chains.chain import Chain
from beammodes.chains.pieces import MAX_PIECES
from beammodes.chains.rules import AnyRule
from beammodes.checks import real_numbers, shown, whole_number
from beammodes.deferred import Deferred
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BoundaryLike
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

if TYPE_CHECKING:
    import xarray
else:
    xarray = Deferred("xarray")

__all__ = ["modal_assurance", "shape_dataset"]

#: A table of more modes than this would be a mistake.
MAX_MODES = 10_000


def modal_assurance(a: ArrayLike, b: ArrayLike, mass: ArrayLike | None = None) -> Floats:
    """Return the modal assurance criterion of every pair of two sets of mode shapes.

    MAC = |aᵀ M b|² / ((aᵀ M a) (bᵀ M b))

    Parameters
    ----------
    a, b : array, shapes (modes_a, nodes) and (modes_b, nodes)
        Real shapes, of any scale and sign.
    mass : array, shape (nodes,) or (nodes, nodes), optional
        M, or its diagonal; every node alike by default, as in the source.

    Returns
    -------
    ndarray, shape (modes_a, modes_b) [-]
        1 where shapes are proportional, 0 where they are orthogonal.

    Raises
    ------
    TypeError, ValueError
        If an array is not of finite real numbers or of its shape, `mass` is not symmetric, or a shape
        has no positive modal mass.

    References
    ----------
    R. J. Allemang and D. L. Brown, A correlation coefficient for modal vector analysis, Proceedings of the
    1st International Modal Analysis Conference (1982), 110-116; M weighs its products.

    Examples
    --------
    >>> import beammodes as bm
    >>> bm.modal_assurance([[1, 2, 3]], [[-2, -4, -6], [3, 0, -1], [1, 1, 1]]).round(4)
    array([[1.    , 0.    , 0.8571]])
    """
    first, second = _array("a", a, 2), _array("b", b, 2)
    if first.shape[1] != second.shape[1]:
        raise ValueError(f"b must have {first.shape[1]} nodes as a has, got {second.shape[1]}")
    weight = _mass(mass, first.shape[1])
    # Unit modal masses come first, so that neither products nor the ratio leave the range of doubles.
    images = _of_unit_modal_mass("a", first, weight) @ _weighed(
        _of_unit_modal_mass("b", second, weight), weight
    )
    return np.minimum(images**2, 1.0)


def shape_dataset(
    *,
    boundary: BoundaryLike | Iterable[BoundaryLike],
    segments: int | Iterable[int],
    modes: int,
    rule: AnyRule | Iterable[AnyRule] = "mitiguy",
    beam: Beam | None = None,
) -> xarray.Dataset:
    """Return deviations of chains' mode shapes u from the beam's φ as one labelled table.

    1 - MAC = |u - φ (φᵀMu) / (φᵀMφ)|² / |u|²,  |v|² = vᵀMv;    max |c u - φ| / max |φ|,  c = (uᵀMφ) / (uᵀMu)

    Parameters
    ----------
    boundary : boundary, or iterable of boundaries
    segments : int, or iterable of int
    modes : int
        How many elastic modes, from the first. Of a chain longer than 500 segments, at most a tenth of its
        own.
    rule : rule, or iterable of rules
    beam : Beam, optional
        In whose units numbers of the ends are; without one they are multiples of ρA L, ρA L³, L, EI/L³ and
        EI/L.

    Returns
    -------
    xarray.Dataset
        Dimensions rule, boundary, segments, mode; variables assurance_deficit (1 - MAC, accurate however
        small) and largest_deviation (over the nodes, once the chain's mode is scaled to fit best); NaN where
        a chain has no such mode or a rule gives no positive springs.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or outside its range.

    Examples
    --------
    >>> import beammodes as bm
    >>> table = bm.shape_dataset(boundary="clamped-free", segments=[5, 10], modes=1)
    >>> table.largest_deviation.squeeze().values.round(5)
    array([0.00272, 0.00073])
    """
    grid = ChainGrid.of(boundary, segments, rule, MAX_PIECES, beam).canonical
    count = whole_number("modes", modes, most=MAX_MODES)
    deficit, largest = np.full((2, *grid.shape, count), np.nan)
    for index, chain in grid.chains():
        found = _deviations(chain, count)
        deficit[index][: found.shape[1]], largest[index][: found.shape[1]] = found
    text = "largest deviation of the chain's mode over the beam's largest deflection"
    return labelled(
        ("rule", "boundary", "segments", "mode"),
        {
            "assurance_deficit": (
                deficit,
                "1 less the modal assurance of the chain's and the beam's mode",
                "1",
            ),
            "largest_deviation": (largest, text, "1"),
        },
        grid.coordinates(count),
        "modes of the linear chain at its nodes",
    )


def _deviations(chain: Chain, modes: int) -> Floats:
    """Return assurance deficit and largest deviation of the modes that the chain has, shape (2, modes)."""
    found = solve_modes(linearize(chain), modes)
    has_length = chain.length > 0
    node = np.concatenate([[True], has_length])
    share = np.concatenate([[0.0], chain.mass[has_length], [0.0]]) / 2
    ours, weight = found.deflection[:, node], share[:-1] + share[1:]
    assert chain.beam is not None  # A rule made it.
    if not len(ours):
        return np.zeros((2, 0))
    # On the beam: the axis of a hub lies beyond it.
    at = np.clip(found.position[node], 0.0, chain.beam.length)
    on_beam = at == found.position[node]
    at, ours, weight = at[on_beam], ours[:, on_beam], weight[on_beam]
    theirs = euler_bernoulli(chain.beam, chain.boundary, len(ours)).shape(at)
    product, norm = (ours * theirs) @ weight, ours**2 @ weight
    apart = ours - theirs * (product / (theirs**2 @ weight))[:, None]
    fitted = ours * (product / norm)[:, None]
    largest = np.abs(fitted - theirs).max(axis=1) / np.abs(theirs).max(axis=1)
    return np.array([apart**2 @ weight / norm, largest])


def _array(name: str, value: ArrayLike, *dimensions: int) -> Floats:
    array = real_numbers(name, value)
    if array.ndim not in dimensions or not array.size:
        allowed = " or ".join(map(str, dimensions))
        raise ValueError(
            f"{name} must have {allowed} dimensions and entries in them, got shape {array.shape}"
        )
    return array


def _mass(mass: ArrayLike | None, nodes: int) -> Floats:
    weight = np.ones(nodes) if mass is None else _array("mass", mass, 1, 2)
    if set(weight.shape) != {nodes}:
        raise ValueError(f"mass must have shape ({nodes},) or ({nodes}, {nodes}), got {weight.shape}")
    if weight.ndim == 2 and not np.allclose(weight, weight.T, rtol=1e-9, atol=1e-12 * np.abs(weight).max()):
        raise ValueError(f"mass must be symmetric, got {shown(weight)}")
    largest = np.abs(weight).max()
    return weight / largest if largest else weight


def _weighed(shapes: Floats, weight: Floats) -> Floats:
    """Return M aᵀ, shape (nodes, modes)."""
    return np.asarray(weight @ shapes.T if weight.ndim == 2 else weight[:, None] * shapes.T)


def _of_unit_modal_mass(name: str, shapes: Floats, weight: Floats) -> Floats:
    largest = np.abs(shapes).max(axis=1, keepdims=True)
    scaled = shapes / np.where(largest, largest, 1.0)
    modal_mass = np.einsum("ij,ji->i", scaled, _weighed(scaled, weight))
    if not (modal_mass > 0).all():
        row = int(np.argmin(modal_mass))
        raise ValueError(f"{name} must have positive modal masses, got {modal_mass[row]:.3g} in row {row}")
    return np.asarray(scaled / np.sqrt(modal_mass)[:, None])
