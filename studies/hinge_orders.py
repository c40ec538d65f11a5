"""What the order of hinges costs: lateral buckling and spurious twist, by ball joints and hinges in a row.

Springs by `half_stub`, whose own error has one sign, so that the orders are plain to see.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

import beammodes as bm
from beammodes.views.symbols import COLOURS
from studies.plots import label_along, plain_ticks
from studies.study import Kind, Progress, Sheet, Study

#: A cantilever ten thousand times as stiff in the plane of its load as across it, and a round one that
#: hardly twists.
NARROW = bm.Rod(1.0, 1e8, 1.0, 1.0, second_bending_stiffness=1.0)
ROUND = bm.Rod(1.0, 1.0, 1e6, 1.0)
#: Its dead force at the tip [EI/L²], midway between the axes of its hinges.
FORCE = 4.0
#: Factor of the narrow one's buckling load: twice the first root of J_{-1/4} (Timoshenko and Gere 6.3).
EXACT_ORDER, BRACKET = -0.25, (1.5, 2.5)
SEGMENTS = (5, 6, 8, 10, 14, 20, 28, 40)
LAWS, RULE = ("ball", "yzx", "xyz", "yzx_alternating"), "half_stub"

_COLOURS: Mapping[str, str] = MappingProxyType(
    {"ball": COLOURS[0], "yzx": COLOURS[1], "xyz": COLOURS[4], "yzx_alternating": COLOURS[2]}
)
_LABELS: Mapping[str, tuple[str, float, Literal["above", "below"]]] = MappingProxyType(
    {
        "ball": ("ball joints: order 2", 14, "below"),
        "yzx": ("y, z, x at every joint: order 1", 17, "above"),
        "xyz": ("x, y, z: order 1, other sign", 17, "below"),
        "yzx_alternating": ("reversed at every other: order 2", 17, "above"),
    }
)


def data(progress: Progress) -> xarray.Dataset:
    """Return by joints and N the error of the buckling load, and the tip's twist, which should be 0."""
    from scipy.optimize import brentq
    from scipy.special import jv

    exact = 2.0 * float(brentq(lambda z: jv(EXACT_ORDER, z), *BRACKET, xtol=1e-15, rtol=1e-14))
    error, twist = np.empty((2, len(LAWS), len(SEGMENTS)))
    for j, count in enumerate(SEGMENTS):
        narrow, rod = (bm.SpatialChain(one, "clamped-free", count, RULE) for one in (NARROW, ROUND))
        for i, law in enumerate(LAWS):
            found = bm.critical_factor(narrow, bm.SpatialLoad(force=(0.0, -1.0, 0.0)), joints=law, start=4.0)
            error[i, j] = found / exact - 1
            twist[i, j] = tip_twist(rod, law)
        progress(j + 1, len(SEGMENTS))
    return xarray.Dataset(
        {"buckling_error": (("joints", "segments"), error), "tip_twist": (("joints", "segments"), twist)},
        coords={"joints": list(LAWS), "segments": list(SEGMENTS)},
    )


def tip_twist(chain: bm.SpatialChain, joints: str) -> float:
    """Return by how much the tip turns about its own axis [degrees] under a force midway between y and z."""
    across = FORCE / math.sqrt(2)
    found = bm.spatial_equilibrium(chain, bm.SpatialLoad(force=(0.0, across, across)), joints=joints)
    # The rod bends in a plane, whose normal the tip's section should keep.
    last, normal = found.rotation[-1], np.array([0.0, -1.0, 1.0]) / math.sqrt(2)
    out = np.cross(last[:, 0], normal)
    return math.degrees(math.asin((last @ normal) @ out / np.linalg.norm(out)))


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw sizes of both effects on logarithmic axes, each line with its joints."""
    buckling, twist = figure.subplots(1, 2, sharex=True)
    lines = [_lines(100 * abs(table.buckling_error), buckling)]
    buckling.set(title="lateral buckling of a narrow cantilever", ylabel="|error of the buckling load|")
    plain_ticks(buckling, [5, 10, 20, 40], [0.01, 0.1, 1, 10], unit=" %")
    # Ball joints leave rounding only; the other order differs by its sign.
    lines.append(_lines(abs(table.tip_twist.sel(joints=["yzx", "yzx_alternating"])), twist))
    twist.set(
        title="round cantilever, F L²/EI = 4 between its axes", ylabel="|twist of the tip|, exactly none"
    )
    plain_ticks(twist, [5, 10, 20, 40], [0.01, 0.1, 1, 10], unit="°")
    for ax in (buckling, twist):
        ax.set(xlabel="number of segments N", ylim=(0.01, 40))
    twist.text(6, 0.014, "ball joints: none", color=_COLOURS["ball"], fontsize=10)
    for ax, found in zip((buckling, twist), lines, strict=True):
        label_along(ax, [(line, *_LABELS[law]) for law, line in found.items()], size=10.0)


def _lines(sizes: xarray.DataArray, ax: Axes) -> dict[str, Line2D]:
    found = {}
    for law in sizes.joints.values.tolist():
        one = sizes.sel(joints=law)
        (found[law],) = ax.loglog(one.segments, one, marker="o", color=_COLOURS[law], linewidth=2.0)
    return found


STUDY = Study(
    name="hinge_orders",
    title="Three hinges in one order at every joint are first order, whatever their springs",
    caption="Error of the lateral buckling load, and spurious twist, against N: ball joints, hinges in one "
    "order, and in an order that is reversed at every other joint; springs by half_stub.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(
            ("joints", "segments", "buckling_error", "tip_twist"),
            {"buckling_error": Kind(decimals=6), "tip_twist": Kind(decimals=5)},
        )
    },
    size=(9.0, 4.6),
)
