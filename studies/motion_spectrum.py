"""Modes meet motion: a knocked chain rings at its eigenfrequencies, and a strongly bent one does not."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

import beammodes as bm
from beammodes.dynamics.simulation import mode_start
from beammodes.views.symbols import COLOURS, GREY
from studies.common import moved
from studies.plots import label_along, plain_ticks
from studies.study import Kind, Progress, Sheet, Study, repeatable

BEAM, BOUNDARY, RULE = bm.Beam.unit(), "clamped-free", "gregory"
#: A small knock: the last rod's first angular velocity; the chain is followed for some 22 periods.
SEGMENTS, KNOCK, DURATION, EVERY = 10, 1e-4, 40.0, 2e-3
#: Largest first angle of a rod, by mode, released from rest in the shape of the mode.
AMPLITUDES = np.array([0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0])
#: Where a mode's own shape still tells its motion: beyond it others take part, and no one frequency is left.
MOST = {1: 1.0, 2: 0.4}
BENT = (4, 10)
NAMES = {1: "rises", 2: "falls"}
PERIODS = 20


def spectrum(
    time: NDArray[np.float64], signal: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return angular frequencies and amplitudes of a signal under a Blackman window, eightfold in density."""
    length = 8 * len(signal)
    amplitude = np.abs(np.fft.rfft(signal * np.blackman(len(signal)), length))
    return 2 * np.pi * np.fft.rfftfreq(length, time[1] - time[0]), amplitude


def peak(omega: NDArray[np.float64], amplitude: NDArray[np.float64], low: float, high: float) -> float:
    """Return the frequency of the largest amplitude between two, by a parabola through three logarithms."""
    inside = np.flatnonzero((omega > low) & (omega < high))
    k = int(inside[amplitude[inside].argmax()])
    left, middle, right = np.log(amplitude[k - 1 : k + 2])
    return float(omega[k] + (omega[1] - omega[0]) * (left - right) / (2 * (left - 2 * middle + right)))


def data(progress: Progress) -> xarray.Dataset:
    """Return the tip's spectrum after a knock beside the eigenfrequencies, and shifts by amplitude."""
    total = 1 + len(MOST) * len(BENT)
    chain = bm.Chain(BEAM, BOUNDARY, SEGMENTS, RULE)
    knock = np.zeros(SEGMENTS)
    knock[-1] = KNOCK
    motion = moved(chain, DURATION, EVERY, steps=12, initial=(np.zeros(SEGMENTS), knock))
    omega, amplitude = spectrum(motion.time.values, motion.angular_velocity.values[:, -1])
    known = bm.solve_modes(bm.linearize(chain)).angular_frequency
    between = [0.5 * known[0], *np.sqrt(known[1:] * known[:-1]), 1.5 * known[-1]]
    found = np.array([peak(omega, amplitude, *edges) for edges in pairwise(between)])
    progress(1, total)
    shift = np.full((len(MOST), len(BENT), len(AMPLITUDES)), np.nan)
    for i, (mode, most) in enumerate(MOST.items()):
        sizes = np.array([size for size in AMPLITUDES if size <= most])
        for j, n in enumerate(BENT):
            shift[i, j, : len(sizes)] = shifts(n, mode, sizes)
            progress(1 + i * len(BENT) + j + 1, total)
    keep = omega < 1.3 * known[-1]
    return xarray.Dataset(
        {
            "amplitude_of": ("omega", repeatable(amplitude[keep] / amplitude[keep].max(), 7)),
            "eigenfrequency": ("peak", known),
            "angular_frequency": ("peak", found),
            "difference": ("peak", found / known - 1),
            "frequency_shift": (("mode", "segments", "amplitude"), shift),
        },
        coords={
            "omega": omega[keep],
            "peak": range(1, len(known) + 1),
            "mode": list(MOST),
            "segments": list(BENT),
            "amplitude": AMPLITUDES,
        },
    )


def shifts(segments: int, mode: int, sizes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how far the frequency of a mode lies from the small motion's, by amplitude, relatively."""
    chain = bm.Chain(BEAM, BOUNDARY, segments, RULE)
    small = float(bm.solve_modes(bm.linearize(chain), mode).angular_frequency[-1])
    period = 2 * math.pi / small
    measured = []
    for size in sizes:
        motion = moved(chain, PERIODS * period, period / 64, initial=mode_start(chain, mode, size))
        omega, amplitude = spectrum(motion.time.values, motion.angle.values[:, -1])
        measured.append(peak(omega, amplitude, 0.7 * small, 1.4 * small) / small - 1)
    return np.array(measured)


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw the spectrum with lines where peaks belong, and the frequencies of the bent chain beside it."""
    left, right = figure.subplots(1, 2, width_ratios=[1.5, 1])
    _spectrum(table, left)
    _shift(table, right)


def _spectrum(table: xarray.Dataset, ax: Axes) -> None:
    ax.set(xscale="log", yscale="log", xlim=(2, 900), ylim=(3e-6, 15))
    for mode, omega in zip(table.peak.values, table.eigenfrequency.values, strict=True):
        ax.axvline(omega, ymax=0.93, color=COLOURS[1], linewidth=1.0, zorder=1)
        near = 6 < mode < SEGMENTS
        ax.text(
            omega, 5.0, "" if near else f"{mode}", color=COLOURS[1], ha="center", va="bottom", fontsize=10
        )
    shown = table.isel(omega=slice(1, None))
    ax.plot(shown.omega, shown.amplitude_of, color=COLOURS[0], linewidth=1.0)
    plain_ticks(ax, [3, 10, 30, 100, 300], [10.0**-k for k in range(6)])
    ax.set_xlabel("angular frequency  ω √(ρAL⁴/EI)")
    ax.set_ylabel("spectrum of the last rod's rate")
    apart = f"{100 * float(np.abs(table.difference).max()):.3f}"
    ax.set_title(
        f"a small knock on {SEGMENTS} rods: peaks at the eigen-\nfrequencies (lines), within {apart} %",
    )


def _shift(table: xarray.Dataset, ax: Axes) -> None:
    ax.set(xscale="log", yscale="log", xlim=(0.017, 1.2), ylim=(2e-4, 20))
    labels = []
    for (mode, name), colour in zip(NAMES.items(), (COLOURS[2], COLOURS[3]), strict=True):
        for n, look in zip(BENT, ({"linestyle": (0, (1, 1.2))}, {"marker": "o"}), strict=True):
            shift = 100 * np.abs(table.frequency_shift.sel(mode=mode, segments=n))
            (line,) = ax.plot(table.amplitude, shift, color=colour, **look)
        last = table.frequency_shift.sel(mode=mode, segments=BENT[-1]).dropna("amplitude")[-1]
        text = f"mode {mode} {name}: {100 * float(last):+.1f} % at {float(last.amplitude):g} rad".replace(
            "-", "−"
        )
        labels.append((line, text, 0.11, "below"))
    plain_ticks(ax, [0.02, 0.05, 0.1, 0.2, 0.5, 1], [10.0**k for k in range(-3, 2)], unit=" %")
    ax.set_xlabel("a rod's largest first angle  [rad]")
    ax.set_title("bent far: |shift of the frequency|,\nas the amplitude squared")
    ax.text(
        0.97,
        0.03,
        f"dotted: {BENT[0]} rods,  dots: {BENT[1]}",
        transform=ax.transAxes,
        ha="right",
        color=GREY,
    )
    label_along(ax, labels, size=10)


STUDY = Study(
    name="motion_spectrum",
    title="Modes meet motion: what a chain plays, softly and loudly",
    caption="Spectrum of a chain after a small knock, and the shift of its frequencies in large motion.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(
            ("peak", "eigenfrequency", "angular_frequency", "difference"),
            {"angular_frequency": Kind(decimals=5), "difference": Kind(decimals=7)},
        ),
        "_large.csv": Sheet(
            ("mode", "segments", "amplitude", "frequency_shift"), {"frequency_shift": Kind(decimals=7)}
        ),
    },
    size=(9.0, 5.0),
    seconds=15.0,
)
