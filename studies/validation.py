"""Published values beside ours: what books, papers and other programs print, and what is computed here."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

import beammodes as bm
from beammodes.vibration.integrators import stability_limit
from studies.study import Kind, Progress, Sheet, Study
from studies.tables import markdown_table

__all__ = ["PUBLISHED", "STUDY", "Published"]

INF = math.inf
UNIT = bm.Beam.unit()


@dataclass(frozen=True)
class Published:
    """A value that somebody printed.

    Parameters
    ----------
    source : str
        Author, title, year, and where in it.
    quantity : str
        What it is, with its units; L = EI = ρA = 1 where none are said.
    printed : str
        As it stands there: its digits say how closely it is known.
    ours : callable
        Returns our value.
    test : str
        The file in `tests/` that holds it, and its second route.
    within : float
        How far it may be off, relative, where more than rounding sets them apart; `why` says what.
    """

    source: str
    quantity: str
    printed: str
    ours: Callable[[], float]
    test: str
    within: float = 0.0
    why: str = ""

    @property
    def tolerance(self) -> float:
        """How far ours may be from what is printed: half a unit of its last digit, or `within`."""
        decimals = len(self.printed.partition(".")[2])
        return max(0.5 * 10.0**-decimals, self.within * abs(float(self.printed)))


def _first(boundary: Any, mode: int = 1, *, beam: bm.Beam = UNIT, load: bm.Load | None = None) -> float:
    """Return a mode's exact frequency, the first one's by default [rad/s]."""
    return float(bm.euler_bernoulli(beam, boundary, mode, load=load).angular_frequency[mode - 1])


def _elastica(force: float) -> tuple[float, float]:
    """Return how far a cantilever's tip sinks, and how far it is drawn in, extrapolated from two chains."""
    tips = [
        bm.find_equilibrium(
            bm.Chain(UNIT, "clamped-free", count, "gregory"), bm.Load(tip_force=-force)
        ).nodes[-1]
        for count in (100, 200)
    ]
    tip = tips[1] + (tips[1] - tips[0]) / 3
    return -float(tip[1]), 1 - float(tip[0])


def _extrapolated(of_chain: Callable[[bm.Chain], float], count: int) -> float:
    """Return what chains with errors of 1/N² tend to."""
    coarse, fine = (of_chain(bm.Chain(UNIT, "clamped-free", n)) for n in (count, 2 * count))
    return fine + (fine - coarse) / 3


def _lateral() -> float:
    """Return the force that buckles a narrow strip sideways, extrapolated from two chains."""
    narrow = bm.Rod(1.0, 1e6, 1.0, 1.0, second_bending_stiffness=1.0)
    load = bm.SpatialLoad(force=(0, -1, 0))
    coarse, fine = (
        bm.critical_factor(bm.SpatialChain(narrow, "clamped-free", n, "double_wall"), load, start=4.0)
        for n in (20, 40)
    )
    return fine + (fine - coarse) / 3


def _bend(axis: int) -> float:
    """Return a place of the tip of Bathe and Bolourchi's bend under 600, in their axes."""
    given = {"bending_stiffness": 1e7 / 12, "torsional_stiffness": 1e7 / 12, "mass_per_length": 1.0}
    bend = bm.Rod.arc(math.pi / 4, length=25 * math.pi, **given)
    coarse, fine = (
        bm.spatial_equilibrium(
            bm.SpatialChain(bend, "clamped-free", n, "double_wall"), bm.SpatialLoad(force=(0, 0, 600))
        ).tip
        for n in (20, 40)
    )
    return float((fine + (fine - coarse) / 3)[axis])


def _symmetric_string() -> float:
    """Return x in  ω = 2 x √(H/m)/L  of a nearly level string's first symmetric mode."""
    found = []
    for count in (40, 80):
        string = bm.Chain(bm.Beam(1.0, 1e-9, 1.0), "pinned-pinned", count)
        hung = bm.find_equilibrium(string, bm.Load(gravity=1.0), span=1.0 - 1e-3)
        omega = bm.solve_modes(bm.linearize(string, at=hung), 2).angular_frequency
        found.append(float(omega[1]) / math.sqrt(hung.multipliers[0]) / 2)
    return (4 * found[1] - found[0]) / 3


def _two_bars() -> float:
    joints = {"a": bm.Joint(0, 0, "pinned"), "b": bm.Joint(0, 1), "c": bm.Joint(1, 1, "pinned")}
    frame = bm.Structure(joints, [bm.Member(UNIT, "a", "b"), bm.Member(UNIT, "b", "c")])
    return float(bm.buckling_load(frame, load=[bm.PointLoad(joint="b", force=(0.0, -1.0))]))


def _own_weight() -> float:
    joints = {"foot": bm.Joint(0, 0, "clamped"), "top": bm.Joint(0, 1)}
    column = bm.Structure(joints, [bm.Member(UNIT, "foot", "top")])
    return float(bm.buckling_load(column, load=bm.Load(gravity=1.0)))


def _wedge(mode: int) -> float:
    sharp = 1 - 1e-5
    beam = bm.Beam(1.0, lambda x: (1.0 - sharp * x) ** 3, lambda x: 1.0 - sharp * x)
    return _first("clamped-free", mode, beam=beam)


def _simscape(judged: str) -> float:
    """Return the first frequency of MathWorks' example [Hz]: of its beam, or of its chain."""
    second, area = 0.015 * 0.005**3 / 12, 0.015 * 0.005
    turning = 2800.0 * second if judged == "chain" else 0.0
    beam = bm.Beam(0.3, 70e9 * second, 2800.0 * area, rotary_inertia_per_length=turning)
    if judged == "chain":
        return float(
            bm.solve_modes(bm.linearize(bm.Chain(beam, "clamped-free", 20, "half_stub")), 1).frequency[0]
        )
    return float(bm.euler_bernoulli(beam, "clamped-free", 1).frequency[0])


BLEVINS = "R. D. Blevins, Formulas for Natural Frequency and Mode Shape, 1979, table 8-1"
ROARK = "W. C. Young and R. J. Roark, Formulas for Stress and Strain, p. 576"
REPORT = "P. Mitiguy, Flexible beams in Working Model"
WRIGHT = "A. D. Wright, C. E. Smith, R. W. Thresher, J. L. C. Wang, J. Appl. Mech. 49 (1982) 197"
BIR = "G. S. Bir, 2010, table 5"
ELASTICA = "K. Mattiasson, Int. J. Num. Meth. Eng. 17 (1981) 145"
GERE = "S. P. Timoshenko and J. M. Gere, Theory of Elastic Stability, 1961"
BATHE = "K.-J. Bathe and S. Bolourchi, Int. J. Num. Meth. Eng. 14 (1979) 961"
ELEMENTS = "theirs are eight finite elements, ours the limit of chains"
SPIN = bm.Load(spin_rate=12.0, plane="flap")

PUBLISHED = (
    Published(
        BLEVINS,
        "β₁L, clamped-free",
        "1.87510407",
        lambda: float(bm.wavenumber("clamped-free", 1)),
        "test_exact_beam.py",
    ),
    Published(
        BLEVINS,
        "β₃L, clamped-clamped",
        "10.9956078",
        lambda: float(bm.wavenumber("clamped-clamped", 3)),
        "test_exact_beam.py",
    ),
    Published(
        BLEVINS,
        "β₁L, clamped-pinned",
        "3.92660231",
        lambda: float(bm.wavenumber("clamped-pinned", 1)),
        "test_exact_beam.py",
    ),
    Published(ROARK, "K₁, clamped-clamped", "22.4", lambda: _first("clamped-clamped"), "test_exact_beam.py"),
    Published(
        ROARK, "K₂, clamped-clamped", "61.7", lambda: _first("clamped-clamped", 2), "test_exact_beam.py"
    ),
    Published(
        REPORT,
        "spring at the wall, N = 4, in EI/ℓ (24/11)",
        "2.1818",
        lambda: float(bm.Chain(UNIT, "clamped-free", 4).joint_stiffness[0] / 4),
        "test_rules.py",
    ),
    Published(
        REPORT,
        "C for one mode (8/K)",
        "0.357",
        lambda: float(8 / bm.wavenumber("clamped-clamped", 1) ** 2),
        "test_step_size.py",
        2e-3,
        "theirs has K = 22.4, ours 22.373",
    ),
    Published(
        BIR,
        "ω₁, a tip mass as heavy as the beam",
        "1.557",
        lambda: _first(("clamped", bm.End(mass=1.0))),
        "test_real_ends.py",
    ),
    Published(
        BIR, "ω₂, the same", "16.25", lambda: _first(("clamped", bm.End(mass=1.0)), 2), "test_real_ends.py"
    ),
    Published(
        WRIGHT,
        "ω₁ out of the plane of rotation, Ω = 12",
        "13.170",
        lambda: _first("clamped-free", load=SPIN),
        "test_spinning_beam.py",
    ),
    Published(
        WRIGHT,
        "ω₂, the same",
        "37.603",
        lambda: _first("clamped-free", 2, load=SPIN),
        "test_spinning_beam.py",
    ),
    Published(
        ELASTICA,
        "sinking of the tip, P L²/EI = 1",
        "0.30172",
        lambda: _elastica(1.0)[0],
        "test_equilibria.py",
    ),
    Published(
        ELASTICA, "shortening, P L²/EI = 10", "0.55500", lambda: _elastica(10.0)[1], "test_equilibria.py"
    ),
    Published(
        "A. G. Greenhill, Proc. Camb. Phil. Soc. 4 (1881) 65",
        "ρA g L³/EI at which a mast falls",
        "7.837",
        _own_weight,
        "test_structure_buckling.py",
    ),
    Published(
        GERE,
        "buckling load, clamped-pinned",
        "20.19",
        lambda: float(bm.buckling_load(UNIT, "clamped-pinned")),
        "test_euler_buckling.py",
    ),
    Published(
        GERE + ", 6.3",
        "sideways buckling of a strip, F L²/√(EI GJ)",
        "4.013",
        _lateral,
        "test_equilibria_in_space.py",
    ),
    Published(
        "W. T. Koiter, Post-buckling analysis of a simple two-bar frame, 1967",
        "buckling load of two bars at a right angle",
        "13.89",
        _two_bars,
        "test_structure_buckling.py",
    ),
    Published(
        "M. Beck, ZAMP 3 (1952) 225",
        "flutter load of a follower force",
        "20.05",
        lambda: _extrapolated(lambda chain: float(bm.flutter_load(chain).compression), 40),
        "test_follower.py",
    ),
    Published(
        "V. V. Bolotin, Nonconservative Problems of the Theory of Elastic Stability, 1963",
        "the same as internal damping vanishes",
        "10.94",
        lambda: _extrapolated(
            lambda chain: float(bm.flutter_load(chain, damping=bm.Damping(stiffness=1e-6)).compression), 40
        ),
        "test_follower.py",
    ),
    Published(
        "G. Kirchhoff, 1879",
        "ω₁ of a wedge that ends in an edge",
        "5.315",
        lambda: _wedge(1),
        "test_spectral_beam.py",
    ),
    Published("G. Kirchhoff, 1879", "ω₂, the same", "15.207", lambda: _wedge(2), "test_spectral_beam.py"),
    Published(
        "H. M. Irvine, Cable Structures, 1981",
        "x in ω = 2x√(H/m)/L, first symmetric mode",
        "4.493",
        _symmetric_string,
        "test_held_apart.py",
        2e-3,
        "ours has a slack of 0.1 %",
    ),
    Published(
        "G. R. Cowper, J. Appl. Mech. 33 (1966) 335",
        "shear coefficient, circle, ν = 0.3",
        "0.886",
        lambda: bm.Circle(1.0).shear_coefficient(0.3),
        "test_timoshenko.py",
    ),
    Published(
        "G. R. Cowper, J. Appl. Mech. 33 (1966) 335",
        "the same, thin round tube",
        "0.531",
        lambda: bm.Tube(1.0, wall=1e-6).shear_coefficient(0.3),
        "test_timoshenko.py",
    ),
    Published(
        "MathWorks, Simscape-Multibody-Flex-Beam, R2025b",
        "first frequency by theory [Hz]",
        "44.92",
        lambda: _simscape("beam"),
        "validation/test_mathworks_lumped_beam.py",
        3e-3,
        "theirs has ω₁ = 3.52, ours 3.516",
    ),
    Published(
        "MathWorks, Simscape-Multibody-Flex-Beam, R2025b",
        "first frequency of 20 lumped elements [Hz]",
        "44.8705",
        lambda: _simscape("chain"),
        "validation/test_mathworks_lumped_beam.py",
        1e-3,
        "read off a figure of their page",
    ),
    Published(
        "J. E. Shigley, Mechanical Engineering Design, table A-9, case 7",
        "sag of a simple beam, q L⁴/EI (5/384)",
        "0.0130208",
        lambda: float(bm.beam_statics(UNIT, "pinned-pinned", "uniform_load").own.midspan_deflection),
        "test_statics.py",
    ),
    Published(
        BATHE,
        "tip of a bend under 600: across [in]",
        "53.4",
        lambda: _bend(2),
        "test_equilibria_in_space.py",
        2e-3,
        ELEMENTS,
    ),
    Published(
        BATHE,
        "the same: along the tangent at the wall [in]",
        "47.2",
        lambda: _bend(0),
        "test_equilibria_in_space.py",
        2e-3,
        ELEMENTS,
    ),
    Published(
        "C. W. Gear, Numerical Initial Value Problems, 1971, p. 41",
        "ω h to which classical Runge-Kutta is stable (2√2)",
        "2.8284",
        lambda: float(stability_limit("rk4")),
        "test_simulation.py",
    ),
)


def data(progress: Progress) -> xarray.Dataset:
    """Return what is printed, what is computed, and how far apart they are."""
    ours = []
    for done, one in enumerate(PUBLISHED, 1):
        ours.append(one.ours())
        progress(done, len(PUBLISHED))
    printed = np.array([float(one.printed) for one in PUBLISHED])
    tolerance = np.array([one.tolerance for one in PUBLISHED])
    values = np.array(ours)
    number = np.arange(1, len(PUBLISHED) + 1)
    return xarray.Dataset(
        {
            "source": ("number", [one.source for one in PUBLISHED]),
            "quantity": ("number", [one.quantity for one in PUBLISHED]),
            "printed": ("number", printed),
            "ours": ("number", values),
            "difference": ("number", values - printed),
            "tolerance": ("number", tolerance),
        },
        coords={"number": number},
    )


def _markdown(table: xarray.Dataset) -> dict[str, str]:
    rows = []
    for one, ours in zip(PUBLISHED, table.ours.values.tolist(), strict=True):
        decimals = len(one.printed.partition(".")[2])
        apart = ours - float(one.printed)
        note = f"{one.quantity}; {one.why}" if one.why else one.quantity
        rows.append(
            [
                one.source,
                note,
                one.printed,
                f"{ours:.{decimals + 2}f}",
                f"{apart:+.1e}",
                f"`tests/{one.test}`",
            ]
        )
    return {".md": markdown_table(("source", "quantity", "printed", "ours", "difference", "test"), rows)}


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw differences over what the printed digits allow: a dot on the left of 1 agrees."""
    ax = figure.subplots()
    ratio = np.abs(table.difference.values) / table.tolerance.values
    place = np.arange(len(ratio))[::-1]
    wide = np.array([bool(one.within) for one in PUBLISHED])
    ax.axvline(1.0, color="0.3", lw=1)
    ax.plot(ratio[~wide], place[~wide], "o", ms=6, color="#0072B2")
    ax.plot(ratio[wide], place[wide], "s", ms=6, color="#D55E00", mfc="white")
    names = [f"{one.source.split(',')[0].split(' (')[0]}: {one.quantity}" for one in PUBLISHED]
    ax.set_yticks(place, names, fontsize=9)
    ax.set(xlim=(-0.02, 1.3), ylim=(-1, len(ratio) + 0.5))
    ax.set_xlabel("difference / half a unit of the last printed digit")
    ax.grid(alpha=0.3)
    ax.annotate("agree", (0.98, len(ratio) - 0.4), ha="right", fontsize=10)
    ax.annotate("differ", (1.02, len(ratio) - 0.4), fontsize=10)
    ax.annotate("hollow: over what\nan approximation\nallows", (1.02, 1.5), fontsize=9, color="#D55E00")


STUDY = Study(
    name="validation",
    title="Published values beside ours",
    caption="Published values and ours: differences over what the printed digits allow.",
    data=data,
    draw=draw,
    sheets={
        ".csv": Sheet(
            ("number", "source", "quantity", "printed", "ours", "difference", "tolerance"),
            {"ours": Kind(decimals=8), "difference": Kind(decimals=8)},
        )
    },
    size=(11.0, 8.0),
    more=_markdown,
)
