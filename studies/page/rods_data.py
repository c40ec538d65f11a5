"""Data of the page's view of rods in space: chains at rest and in their modes, and their errors."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

import beammodes as bm
from studies.page.evidence import Parts, agree, worst_of

__all__ = ["MODES", "RODS", "RULES", "SEGMENTS", "parts", "rods"]

_EI = 1.3
_WIRE = MappingProxyType({"bending_stiffness": _EI, "torsional_stiffness": 1.0, "mass_per_length": 1.0})
_TURNING = MappingProxyType({"polar_inertia_per_length": 2e-3})

#: Of unit length, clamped at s = 0; the words are the page's. Round ones have GJ = EI/1.3.
RODS: Mapping[str, bm.Rod] = MappingProxyType(
    {
        "straight, EI ratio 4": bm.Rod(1.0, second_bending_stiffness=4 * _EI, **_WIRE, **_TURNING),
        "pretwisted by 90°, EI ratio 16": bm.Rod.pretwisted(
            math.pi / 2, length=1.0, second_bending_stiffness=16 * _EI, **_WIRE, **_TURNING
        ),
        "arc of 90°, round": bm.Rod.arc(math.pi / 2, length=1.0, **_WIRE),
        "helix of one turn, round": bm.Rod(1.0, curvature=(1.0, 0.0, 2 * math.pi), **_WIRE),
    }
)
RULES = ("naive", "rigid_stub", "half_stub", "gregory")
SEGMENTS, MODES = (5, 10, 20), 5
#: Of places and directions; a picture shows no more.
_DECIMALS = 3
_DIGITS = 6


@lru_cache(maxsize=1)
def rods() -> dict[str, Any]:
    """Return everything, as JSON has it.

    Of each rod ω of the exact one in √(EI/(ρA L⁴)), and by rule and N: errors; nodes at rest; which of them
    are hinges; of each mode the nodes' displacements, the largest 1, or turns of 1 where no node moves much;
    and, where EI differs across, the section's stiff direction at each hinge and how the modes turn it.
    """
    return {
        "rules": list(RULES),
        "segments": list(SEGMENTS),
        "rods": [{"name": name, **_rod(rod)} for name, rod in RODS.items()],
    }


def _rod(rod: bm.Rod) -> dict[str, Any]:
    exact = bm.rod_modes(rod, "clamped-free", MODES).angular_frequency
    chains = [
        [_chain(bm.SpatialChain(rod, "clamped-free", count, rule), exact) for count in SEGMENTS]
        for rule in RULES
    ]
    return {"omega": [_short(value) for value in (exact / math.sqrt(_EI)).tolist()], "chains": chains}


def _chain(chain: bm.SpatialChain, exact: NDArray[np.float64]) -> dict[str, Any]:
    modes = bm.spatial_modes(chain, MODES)
    hinges = np.searchsorted(chain.node_position, chain.hinge_position)
    moved, turned = modes.displacement, modes.rotation[:, 1:]
    # A mode of twist moves no node: then the largest turn, in radians, counts as a tenth of a length.
    sizes = [np.linalg.norm(values, axis=2).max(axis=1) for values in (moved, 0.1 * turned)]
    size = np.maximum(*sizes)
    found = {
        "errors": [_short(value) for value in (modes.angular_frequency / exact - 1).tolist()],
        "nodes": _rounded(chain.nodes),
        "hinges": hinges.tolist(),
        "shapes": _rounded(moved / size[:, None, None]),
    }
    about_y, about_z = chain.joint_stiffness[:, 1], chain.joint_stiffness[:, 2]
    if not np.allclose(about_y, about_z, rtol=1e-9):
        # Stiff about y is wide along z.
        wide = chain.rod.frames(chain.hinge_position)[0][:, :, 2]
        found |= {
            "wide": _rounded(wide),
            "turns": _rounded(np.cross(turned / size[:, None, None], wide)),
        }
    return found


def _rounded(values: NDArray[np.float64]) -> Any:
    return (np.round(values, _DECIMALS) + 0.0).tolist()


def _short(value: float) -> float | None:
    return None if math.isnan(value) else float(f"{value:.{_DIGITS}g}")


def parts() -> Parts:
    """Return the parts of this section: its source, by planar errors of the straight rod in either plane."""
    straight, pairs = RODS["straight, EI ratio 4"], []
    table = bm.rod_error_dataset(straight, "clamped-free", segments=SEGMENTS, modes=1, rule=RULES)
    for rule in RULES:
        for count in SEGMENTS:
            found = float(table.relative_error.sel(rule=rule, segments=count, mode=1))
            planar = bm.frequency_error("clamped-free", segments=count, mode=1, rule=rule)
            pairs.append((found, planar))
    return {"rods_modes": str(MODES)}, {
        "rods": f"mode 1 of the straight rod and of a planar chain: {agree(worst_of(pairs), 1e-5)}"
    }
