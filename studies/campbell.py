"""Campbell diagram of a cantilever on a turning hub: the beam's frequencies, and the chain's."""

from __future__ import annotations

from typing import Literal

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

import beammodes as bm
from beammodes.problem.loading import PLANES
from beammodes.views.symbols import COLOURS, GREY
from studies.plots import label_along, label_line, method_style, plain_ticks
from studies.study import Kind, Progress, Sheet, Study

Side = Literal["above", "below"]
Label = tuple[Line2D, str, float, Side]

BEAM, BOUNDARY, MODES = bm.Beam.unit(), "clamped-free", 2
SPIN = np.linspace(0.0, 12.0, 49)
#: Spin rates at which chains are drawn, as points, every fourth of them.
RULE, SEGMENTS, EVERY = "mitiguy", (4, 10), 4
#: One spin rate, at which the error of mode 1 is followed over N; and none, for comparison.
RATES, COUNTS, RULES = (
    (0.0, 6.0),
    np.unique(np.geomspace(4, 100, 21).round().astype(int)),
    ("mitiguy", "gregory"),
)
REVOLUTIONS = range(1, 7)
PLANE = "flap"
#: What is drawn of the errors, and where it is named.
PLACES: tuple[tuple[float, str, float, Side], ...] = (
    (6.0, "mitiguy", 22, "above"),
    (6.0, "gregory", 28, "below"),
    (0.0, "gregory", 13, "above"),
)
LOOK = {"flap": COLOURS[0], "lag": COLOURS[1]}


def data(progress: Progress) -> xarray.Dataset:
    """Return frequencies over √(EI/ρAL⁴) by plane and spin rate, of the beam and of chains; errors over N."""
    exact = np.empty((len(PLANES), MODES, len(SPIN)))
    chain = np.full((len(PLANES), MODES, len(SPIN), len(SEGMENTS)), np.nan)
    for i, plane in enumerate(PLANES):
        for j, rate in enumerate(SPIN):
            load = bm.Load(spin_rate=rate, plane=plane)
            exact[i, :, j] = bm.euler_bernoulli(BEAM, BOUNDARY, MODES, load=load).angular_frequency
            if j % EVERY == 0:
                chain[i, :, j] = np.transpose([_of_chain(RULE, n, load) for n in SEGMENTS])
        progress(i + 1, len(PLANES) + len(RATES))
    error = np.empty((len(RATES), len(RULES), len(COUNTS)))
    for i, rate in enumerate(RATES):
        load = bm.Load(spin_rate=rate, plane=PLANE)
        first = bm.euler_bernoulli(BEAM, BOUNDARY, 1, load=load).angular_frequency[0]
        error[i] = [[_of_chain(rule, int(n), load)[0] / first - 1 for n in COUNTS] for rule in RULES]
        progress(len(PLANES) + i + 1, len(PLANES) + len(RATES))
    return xarray.Dataset(
        {
            "exact": (("plane", "mode", "spin_rate"), exact),
            "chain": (("plane", "mode", "spin_rate", "segments"), chain),
            "relative_error": (("spin", "rule", "count"), error),
        },
        coords={
            "plane": list(PLANES),
            "mode": range(1, MODES + 1),
            "spin_rate": SPIN,
            "segments": list(SEGMENTS),
            "spin": list(RATES),
            "rule": list(RULES),
            "count": COUNTS,
        },
    )


def _of_chain(rule: str, segments: int, load: bm.Load) -> NDArray[np.float64]:
    model = bm.linearize(bm.Chain(BEAM, BOUNDARY, segments, rule), load=load)
    return bm.solve_modes(model, MODES).angular_frequency


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw the diagram, and beside it the error of the first flap mode against N."""
    left, right = figure.subplots(1, 2, width_ratios=[1.3, 1])
    revolutions, errors = _diagram(table, left), _errors(table, right)
    label_along(left, revolutions)
    label_along(right, errors, size=10)


def _diagram(table: xarray.Dataset, ax: Axes) -> list[Label]:
    ax.set(xlim=(0, SPIN[-1]), ylim=(0, 40))
    labels: list[Label] = []
    for k in REVOLUTIONS:
        (line,) = ax.plot(SPIN, k * SPIN, color=GREY, linewidth=0.8, linestyle=(0, (5, 3)), zorder=1)
        labels.append((line, f"{k}P", min(9.6, 37.5 / k), "below"))
    for plane in PLANES:
        for mode in table.mode.values:
            one = table.sel(plane=plane, mode=mode)
            (line,) = ax.plot(one.spin_rate, one.exact, color=LOOK[plane], linewidth=1.8)
            label_line(ax, line, f"{plane} {mode}", offset=(6, 0))
            points = one.chain.dropna("spin_rate")
            for n, marker, size in zip(SEGMENTS, ("s", "o"), (4.5, 3.5), strict=True):
                face = "white" if n == SEGMENTS[0] else LOOK[plane]
                ax.plot(
                    points.spin_rate,
                    points.sel(segments=n),
                    marker,
                    color=LOOK[plane],
                    ms=size,
                    mfc=face,
                    clip_on=False,
                )
    ax.set_xlabel("spin rate  Ω √(ρAL⁴/EI)")
    ax.set_ylabel("frequency  ω √(ρAL⁴/EI)")
    ax.set_title(f"lines: the beam;  {RULE} chains: □ {SEGMENTS[0]}, ● {SEGMENTS[1]} rods")
    return labels


def _errors(table: xarray.Dataset, ax: Axes) -> list[Label]:
    ax.set(xscale="log", yscale="log", ylim=(1e-6, 3))
    labels: list[Label] = []
    for spin, rule, at, side in PLACES:
        error = 100 * np.abs(table.relative_error.sel(spin=spin, rule=rule))
        look = method_style(rule) | ({} if spin else {"linestyle": (0, (1, 1.2))})
        (line,) = ax.plot(table["count"], error, **look)
        labels.append((line, f"{rule}, Ω = {spin:g}" if spin else f"{rule}, at rest", at, side))
    plain_ticks(ax, [4, 10, 20, 50, 100], [10.0**k for k in range(-6, 1)], unit=" %")
    ax.set_xlabel("number of segments N")
    ax.set_title("|error| of flap 1: turning, as 1/N²")
    return labels


STUDY = Study(
    name="campbell",
    title="A cantilever on a turning hub: its frequencies, and how well chains meet them",
    caption="Campbell diagram of a cantilever on a turning hub: frequencies of the beam and of chains.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(
            ("plane", "mode", "spin_rate", "exact", "segments", "chain"),
            part=lambda table: table.sel(spin_rate=SPIN[::EVERY]),
        ),
        # Rounded to the digits that both solutions leave.
        "_errors.csv": Sheet(
            ("spin", "rule", "count", "relative_error"), {"relative_error": Kind(decimals=11)}
        ),
    },
    size=(9.0, 5.6),
)
