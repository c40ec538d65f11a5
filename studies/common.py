"""Functions that several studies share: largest errors, finite elements, mode shapes, motions, axes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import scipy.linalg
import xarray
from matplotlib.axes import Axes
from numpy.typing import NDArray

import beammodes as bm
from beammodes.chains.rules import AnyRule, is_closed, layout_of
from beammodes.numerics.arrays import Floats
from studies.study import Kind, repeatable

__all__ = [
    "LARGEST_ERROR",
    "MATCHED",
    "MODES",
    "ROUNDING",
    "element_errors",
    "largest_error",
    "mode_shapes",
    "moved",
    "picture",
]

MODES = 3
MATCHED = bm.matched(MODES)
#: Below this an error is rounding: matched springs have none, and its digits differ between machines.
ROUNDING = 1e-12
#: Errors of a rule without a closed form are of solved frequencies, good to 1e-14 (`frequency_error`): a
#: tenth of this last place, below which no digit is claimed.
SOLVED_DECIMALS = 13
LARGEST_ERROR = Kind(decimals=SOLVED_DECIMALS, some=True)


def largest_error(boundary: str, rule: AnyRule, segments: NDArray[np.int64]) -> Floats:
    """Return the largest |e| of the first three modes at each N, NaN where a chain has fewer."""
    mode = np.arange(1, MODES + 1)
    error = np.abs(bm.frequency_error(boundary, segments=segments[:, None], mode=mode, rule=rule)).max(axis=1)
    error = np.where(error < ROUNDING, 0.0, error)
    return error if is_closed(layout_of(rule)) else repeatable(error, SOLVED_DECIMALS)


def element_errors(boundary: str, elements: int) -> Floats:
    """Return the errors of the first three frequencies of equal Hermite elements, by scikit-fem.

    Rounded to the digits that a dense solve leaves, so that they are the same on every machine.
    """
    from skfem import Basis, BilinearForm, ElementLineHermite, MeshLine
    from skfem.helpers import dd, ddot

    basis = Basis(MeshLine(np.arange(elements + 1.0)), ElementLineHermite())
    stiffness = BilinearForm(lambda u, v, _: ddot(dd(u), dd(v))).assemble(basis).toarray()
    mass = BilinearForm(lambda u, v, _: u * v).assemble(basis).toarray()
    ends = bm.Boundary.of(boundary)
    clamped = [x for x, end in ((0, ends.left), (elements, ends.right)) if end.holds_rotation]
    free = basis.complement_dofs(basis.get_dofs(lambda x: np.isin(x[0], clamped)))
    # The lowest modes as the largest eigenvalues: the other way round N⁴ more digits are lost.
    inverse = scipy.linalg.eigh(mass[np.ix_(free, free)], stiffness[np.ix_(free, free)], eigvals_only=True)
    exact = bm.euler_bernoulli(bm.Beam.unit(), boundary, MODES).angular_frequency
    return np.round(elements**2 / np.sqrt(inverse[::-1][:MODES]) / exact - 1, 9)


def mode_shapes(chain: bm.Chain, modes: int) -> xarray.Dataset:
    """Return a chain's modes beside its exact beam's, both over the beam's largest deflection.

    Dimensions mode, node (left tip, hinges, right tip), piece (the outer two carry the ends' bodies), x.
    """
    assert chain.beam is not None
    found = bm.solve_modes(bm.linearize(chain), modes)
    exact = bm.euler_bernoulli(chain.beam, chain.boundary, modes)
    x = np.linspace(0.0, chain.beam.length, 201)
    curve, at_nodes = exact.shape(x), exact.shape(found.position)
    scale = 1 / np.abs(curve).max(axis=1, keepdims=True)
    # Either sign is a mode: take the beam's.
    sign = np.sign((found.deflection * at_nodes).sum(axis=1, keepdims=True))
    return xarray.Dataset(
        {
            "frequency": ("mode", found.frequency),
            "exact_frequency": ("mode", exact.frequency),
            "deflection": (("mode", "node"), found.deflection * sign * scale),
            "exact_deflection": (("mode", "node"), at_nodes * scale),
            "rotation": (("mode", "piece"), found.rotation * sign * scale),
            "curve": (("mode", "x"), curve * scale),
        },
        coords={"mode": range(1, modes + 1), "position": ("node", found.position), "x": x},
    )


def moved(
    chain: bm.Chain, duration: float, every: float, *, steps: float = 4.0, **arguments: Any
) -> xarray.Dataset:
    """Return a chain's motion by Runge-Kutta, at 0, every, 2 every, ... to the duration.

    Its steps are the longest ones that divide `every` and that `steps` of fit in the longest stable one.
    """
    longest = bm.stable_time_step(chain, "rk4") / steps
    step = every / math.ceil(every / longest)
    motion = bm.simulate(chain, duration=duration, step=step, output_step=every, **arguments)
    # The same times for every chain, to the last digit.
    return motion.assign_coords(time=np.arange(motion.sizes["time"]) * every)


def picture(ax: Axes, width: tuple[float, float], height: tuple[float, float]) -> None:
    """Make axes a picture: true proportions, no frame, no ticks."""
    ax.set(xlim=width, ylim=height, aspect="equal")
    ax.axis("off")
