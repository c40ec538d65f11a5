"""Rounding errors of a chain's first frequency in several formulations, against 50-digit arithmetic.

The figure shows rounding, which differs between machines and versions of BLAS: only its trend is meant to be
reproduced, and it is not compared with figures drawn elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import mpmath
import numpy as np
import scipy.sparse
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.sparse.linalg import eigsh

from beammodes.views.symbols import COLOURS
from studies.plots import label_line
from studies.rivals import METHODS
from studies.study import Kind, Progress, Sheet, Study

SEGMENTS = (
    *(4, 6, 10, 16, 25, 40, 63, 100, 160, 250, 400, 630, 1000, 1600, 2500, 4000, 6300),
    *(10_000, 16_000, 25_000, 40_000, 63_000, 100_000, 250_000, 1_000_000),
)

#: By method: the largest N drawn, as far as seconds and memory allow, and which colour.
LINES = {
    "closed form": (1_000_000, 0),
    "flexibility form": (100_000, 2),
    "dense": (1000, 1),
    "sparse": (100_000, 3),
    "hermite": (10_000, 4),
    "discretization": (1_000_000, 6),
}
# Enough for determinants whose terms cancel to 1/N⁸ at N = 10⁶, with 50 digits left.
_DIGITS = 110


def chain_frequency(segments: int, mode: int) -> mpmath.mpf:
    """Return ω of the clamped-free chain with the report's springs for L = EI = ρA = 1, to 50 digits.

    Between the ends  M_{j-1} - 2 M_j + M_{j+1} = λ (y_{j-1} + 4 y_j + y_{j+1})/6  with the bending moment
    M_j = y_{j-1} - 2 y_j + y_{j+1}  and λ = ω²/N⁴ is solved by cos qj, sin qj, e^(-χj) and e^(-χ(N-j)):

        λ = 12 (1 - cos q)² / (2 + cos q),   cosh χ = 2 + λ/12 - cos q

    The ends are met where the four conditions' determinant vanishes. Mode n has (n-1)π < qN < nπ, N ≥ 4.
    """
    with mpmath.workdps(_DIGITS):
        start = mpmath.sqrt(beam_frequency(mode))
        total = mpmath.findroot(
            lambda x: _determinant(x / segments, segments), (start, start * (1 - 1e-3)), tol=1e-160
        )
        if not (mode - 1) * mpmath.pi < total < mode * mpmath.pi:
            raise ArithmeticError(f"mode {mode} of {segments} segments led to another")
        return mpmath.sqrt(_square(total / segments)) * segments**2


def _square(q: mpmath.mpf) -> mpmath.mpf:
    c = mpmath.cos(q)
    return 12 * (1 - c) ** 2 / (2 + c)


def _determinant(q: mpmath.mpf, segments: int) -> mpmath.mpf:
    square, n = _square(q), segments
    chi = mpmath.acosh(2 + square / 12 - mpmath.cos(q))
    wall = mpmath.mpf(6 * n) / (3 * n - 1)
    waves: list[Callable[[int], mpmath.mpf]] = [
        lambda j: mpmath.cos(q * j),
        lambda j: mpmath.sin(q * j),
        lambda j: mpmath.exp(-chi * j),
        lambda j: mpmath.exp(-chi * (n - j)),
    ]
    rows = [
        # At the wall no deflection, and the spring's moment continued to a node beyond it.
        [y(0) for y in waves],
        [y(1) - 2 * y(0) + y(-1) - wall * (y(1) - y(0)) for y in waves],
        # At the tip no moment, and the last half rod's balance of forces.
        [y(n + 1) - 2 * y(n) + y(n - 1) for y in waves],
        [y(n) - 2 * y(n - 1) + y(n - 2) - square * (y(n - 1) + 2 * y(n)) / 6 for y in waves],
    ]
    return mpmath.det(mpmath.matrix(rows))


@cache
def beam_frequency(mode: int) -> mpmath.mpf:
    """Return ω of the clamped-free Euler-Bernoulli beam for L = EI = ρA = 1, to 50 digits."""
    with mpmath.workdps(_DIGITS):
        start = (mode - mpmath.mpf(1) / 2) * mpmath.pi
        return mpmath.findroot(lambda x: mpmath.cos(x) + mpmath.sech(x), start) ** 2


def hermite_frequency(segments: int) -> float:
    """Return the first ω of N cubic beam elements, clamped-free, by sparse shift-invert.

    Element matrices in deflection and slope at both ends, for unit length (any finite-element textbook).
    """
    bending = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]], float)
    inertia = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]], float)
    freedom = 2 * np.arange(segments)[:, None] + np.arange(4)
    rows, columns = np.repeat(freedom, 4, axis=1).ravel(), np.tile(freedom, (1, 4)).ravel()
    stiffness, mass = (
        scipy.sparse.coo_matrix((np.tile(element.ravel(), segments), (rows, columns))).tocsc()[2:, 2:]
        for element in (bending, inertia / 420)
    )
    start = np.ones(2 * segments)
    square = eigsh(stiffness, 3, mass, sigma=0, v0=start, return_eigenvectors=False).min()
    return float(np.sqrt(square)) * segments**2


def _first(method: str) -> Callable[[int], float]:
    frequencies = METHODS[method].frequencies
    return lambda segments: float(frequencies(segments)[0])


def _contestants() -> dict[str, Callable[[int], float]]:
    return {
        "closed form": _first("beammodes, closed form"),
        "flexibility form": _first("beammodes, any chain"),
        "dense": _first("SciPy `eigh(K, M)`, lowest three"),
        "sparse": _first("SciPy sparse `eigsh`, shift-invert"),
        "hermite": hermite_frequency,
    }


def _errors(segments: int, listed: int) -> dict[str, float]:
    """Return the errors at `segments` of the methods whose lines reach `listed`."""
    chain, beam = chain_frequency(segments, 1), beam_frequency(1)
    true = dict.fromkeys(LINES, chain) | {"hermite": beam, "discretization": beam}
    found = {m: f(segments) for m, f in _contestants().items() if listed <= LINES[m][0]}
    with mpmath.workdps(50):
        against = {m: mpmath.mpf(value) / true[m] for m, value in (found | {"discretization": chain}).items()}
        return {method: float(abs(ratio - 1)) for method, ratio in against.items()}


def data(progress: Progress) -> xarray.Dataset:
    """Return relative errors of the first frequency, the largest at N, N + 1 and N + 2, over method and N.

    The chain's formulations are held against the chain's true frequency. Hermite elements, and the chain
    itself ("discretization"), are held against the beam's.
    """
    table = np.full((len(LINES), len(SEGMENTS)), np.nan)
    for j, segments in enumerate(SEGMENTS):
        errors = [_errors(n, segments) for n in range(segments, segments + 3)]
        for i, method in enumerate(LINES):
            table[i, j] = max(found.get(method, np.nan) for found in errors)
        progress(j + 1, len(SEGMENTS))
    return xarray.Dataset(
        {"relative_error": (("method", "segments"), table)},
        coords={"method": list(LINES), "segments": list(SEGMENTS)},
    )


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw every formulation's error against N, on logarithmic axes."""
    ax = figure.subplots()
    ax.set(xscale="log", yscale="log", xlim=(3, 2e7), ylim=(3e-17, 3))
    ax.set(xlabel="number of segments N", ylabel="relative error of the first frequency")
    ax.set_xticks([10.0**k for k in range(1, 7)])
    ax.set_yticks([10.0**k for k in range(-16, 1, 2)])
    ax.minorticks_off()
    for method, (_, colour) in LINES.items():
        line = table.relative_error.sel({"method": method}).dropna("segments")
        faint = {"alpha": 0.3, "linewidth": 4.0} if method == "discretization" else {"marker": "o"}
        ax.plot(line.segments, line, color=COLOURS[colour], **faint)
    _label(ax)


def _label(ax: Axes) -> None:
    lines = dict(zip(LINES, ax.get_lines(), strict=True))
    epsilon, grey = float(np.finfo(np.float64).eps), "#555555"
    ax.axhline(epsilon, color=grey, linewidth=0.9, linestyle=(0, (4, 3)))
    ax.text(1.4e6, epsilon, f"epsilon, {epsilon:.1e}", color=grey, va="bottom")
    label_line(ax, lines["closed form"], "closed form", offset=(8, -4))
    label_line(ax, lines["flexibility form"], "any chain (flexibility form)", offset=(8, 6))
    label_line(ax, lines["sparse"], "sparse shift-invert\nof (K, M)", offset=(9, -6))
    label_line(ax, lines["hermite"], "Hermite\nelements,\nvs the beam", point=2, offset=(9, 12))
    label_line(ax, lines["dense"], "dense eigh(K, M)", offset=(-6, 8), ha="right", va="bottom")
    measured = "the chain's own error:\nwhat is to be measured"
    label_line(ax, lines["discretization"], measured, offset=(8, 6))


STUDY = Study(
    name="accuracy",
    title="Rounding in the first frequency of a clamped-free chain",
    caption="Rounding error of a chain's first frequency in six formulations, against 50-digit arithmetic.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(
            ("method", "segments", "relative_error"),
            # Two to three orders of magnitude between processors, and frequencies without a digit.
            {"relative_error": Kind(factor=1e3, noise=1e-14, lost=1e-3)},
        )
    },
    size=(9.0, 5.2),
    seconds=20.0,
    reproducible=False,
)
