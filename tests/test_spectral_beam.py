"""Modes of beams that vary against power series in 30 digits, closed forms and published roots."""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal, localcontext
from itertools import pairwise
from typing import Any, NamedTuple

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from turns import in_turns

from beammodes import euler_bernoulli
from beammodes.exact.spectral_beam import SpectralBeamModes, spectral_buckling, spectral_modes
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BOUNDARIES, ENDS, Boundary, End
from beammodes.problem.loading import Load
from beammodes.problem.profiles import SAMPLES, Table

UNIT = Beam.unit()
BEAM = Beam(length=1.7, bending_stiffness=83.0, mass_per_length=0.45)
HELD = math.inf


# --- The reference: each section's state carried on by a power series in 40 digits ------------------------


class Section(NamedTuple):
    """A stretch of beam whose properties are polynomials in x from its left end, constant first."""

    length: float
    stiffness: Sequence[float]
    mass: Sequence[float]
    rotary: Sequence[float] = (0.0,)


def carried(state: Any, section: Section, square: Any, tension: Any, terms: int = 260) -> Any:
    """Return y, y', M = EI y'' and Q at the right end of a section from those at its left end.

    Term by term (EI y'')'' - T y'' + ω² (ρI y')' - ω² ρA y = 0, with Q = (T - ω² ρI) y' - M'.
    """
    stiff, mass, rotary = ([Decimal(c) for c in row] for row in section[1:])
    h, (y, slope, moment, shear) = Decimal(section.length), state
    bend = [moment, (tension - square * rotary[0]) * slope - shear]
    a = [y, slope, moment / stiff[0] / 2]
    a.append((bend[1] - sum(2 * c * a[2] for c in stiff[1:2])) / stiff[0] / 6)
    for n in range(terms):
        inertia = sum(c * a[n - k] for k, c in enumerate(mass) if n >= k)
        turning = (n + 1) * sum(c * (n + 2 - k) * a[n + 2 - k] for k, c in enumerate(rotary) if n + 2 > k)
        total = square * (inertia - turning) + tension * (n + 2) * (n + 1) * a[n + 2]
        bend.append(total / ((n + 2) * (n + 1)))
        known = sum(
            c * (n + 4 - k) * (n + 3 - k) * a[n + 4 - k] for k, c in enumerate(stiff) if 0 < k <= n + 2
        )
        a.append((bend[n + 2] - known) / (stiff[0] * (n + 4) * (n + 3)))
        late = n % 10 == 9 and max(abs(c * h**k) for k, c in enumerate(a[-6:], n - 1))
        if n % 10 == 9 and late < Decimal("1e-40") * abs(a[2]):
            break
    (y, slope), (moment, rate), (turning, _) = (polynomial(row, h) for row in (a, bend, rotary))
    assert abs(a[-1] * h ** len(a)) < Decimal("1e-32") * max(abs(c * h**k) for k, c in enumerate(a))
    return y, slope, moment, (tension - square * turning) * slope - rate


def polynomial(coefficients: Sequence[Decimal], x: Decimal) -> tuple[Decimal, Decimal]:
    """Return its value and its derivative; constant first."""
    value = rate = Decimal(0)
    for c in reversed(coefficients):
        rate = rate * x + value
        value = value * x + c
    return value, rate


def determinant(omega: Any, sections: Sequence[Section], pair: Boundary, tension: float) -> Any:
    """Return what vanishes at a natural frequency, from the conditions that springs and bodies set."""
    square = omega**2

    def resisting(end: End) -> tuple[Any, Any, Any]:
        mass, inertia, offset = (Decimal(float(number)) for number in end.moving_body)
        across, turning = (Decimal(float(k)) for k in (end.translational_stiffness, end.rotational_stiffness))
        return across - square * mass, turning - square * (inertia + mass * offset**2), square * mass * offset

    left, right = pair.left, pair.right
    across, turning, both = resisting(left)
    one = (0, 0, 0, 1) if left.holds_deflection else (1, 0, both, across)
    other = (0, 0, 1, 0) if left.holds_rotation else (0, 1, turning, both)
    across, turning, both = resisting(right)
    conditions = []
    for state in (one, other):
        for section in sections:
            state = carried([Decimal(value) for value in state], section, square, Decimal(tension))
        y, slope, moment, shear = state
        force = y if right.holds_deflection else shear + across * y - both * slope
        couple = slope if right.holds_rotation else moment + turning * slope - both * y
        conditions.append((force, couple))
    (a, b), (c, d) = conditions
    return a * d - b * c


def error(omega: float, sections: Sequence[Section], pair: Boundary, tension: float = 0.0) -> float:
    """Return the relative distance to the nearest root: the step of Newton's from `omega`."""
    with localcontext(prec=40):
        place, small = Decimal(omega), Decimal("1e-16")
        here = determinant(place, sections, pair, tension)
        rise = determinant(place * (1 + small), sections, pair, tension) - here
        return abs(float(small * here / rise)) if here else 0.0


def nearer_than(bound: float, omega: float, sections: Sequence[Section], pair: Boundary) -> bool:
    """Return whether the determinant changes sign within a relative distance of `omega`."""
    with localcontext(prec=40):
        below, above = (
            determinant(Decimal(omega) * (1 + d), sections, pair, 0.0)
            for d in (-Decimal(bound), Decimal(bound))
        )
        return bool(below * above < 0)


def sign_changes(highest: float, sections: Sequence[Section], pair: Boundary) -> int:
    """Return how many roots lie between a tenth of the unit and `highest`, on a grid of 24 in √ω."""
    with localcontext(prec=40):
        grid = np.linspace(0.4, math.sqrt(highest), 24)
        signs = [determinant(Decimal(b) ** 2, sections, pair, 0.0) > 0 for b in grid.tolist()]
    return sum(a != b for a, b in pairwise(signs))


# --- Uniform beams ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("boundary", [*BOUNDARIES, Boundary.of("free-clamped"), Boundary.of("free-pinned")])
def test_uniform_beams_agree_with_the_closed_forms(boundary: Boundary) -> None:
    found, exact = spectral_modes(BEAM, boundary, 10), euler_bernoulli(BEAM, boundary, 10)
    assert np.abs(found.angular_frequency / exact.angular_frequency - 1.0).max() < 1e-13
    assert np.array_equal(found.frequency, found.angular_frequency / (2 * math.pi))
    assert found.rigid_body_modes == exact.rigid_body_modes and found.agreement < 1e-11
    x = np.linspace(0.0, 1.7, 40).reshape(2, 20)
    for order in range(3):
        shapes = exact.shape(x, order)
        assert np.abs(found.shape(x, order) - shapes).max() < 5e-12 * np.abs(shapes).max()
    assert np.array_equal(found.slope(x), found.shape(x, 1))


@pytest.mark.parametrize("modes", [1, 40, 100])
def test_many_modes(modes: int) -> None:
    exact = euler_bernoulli(UNIT, "clamped-free", modes).angular_frequency
    found = spectral_modes(UNIT, "clamped-free", modes).angular_frequency
    assert np.abs(found / exact - 1.0).max() < 1e-12


# Roots of 1 + cC + μl(cS - sC) - jl³(Cs + Sc) + μjl⁴(1 - cC) = 0 (c = cos l, ..., S = sinh l; ω = l²), solved
# with 40 digits; μ = 1 also in Bir, G. (2010), Table 5 (1.557, 16.25).
TIP_BODY = {
    (0.1, 0.0): [2.9678383467759746, 19.35580100987733, 55.518245548786524, 110.70795445059461],
    (1.0, 0.0): [1.557297861198921, 16.2500851582386, 50.89584283121596, 105.19827584975472],
    (10.0, 0.0): [0.5413750329007182, 15.511513119691896, 50.06434697340694, 104.34717455640384],
    (0.5, 0.01): [1.9875255750879084, 13.403441938004592, 32.345056897142506, 67.97422747092449],
    (1.0, 0.01): [1.5436768034058521, 13.239588559535301, 32.06958081008119, 66.82866629123814],
}
# Roots of the determinants of the same kind for elastic supports, solved with 40 to 60 digits.
ELASTIC: dict[str, tuple[End, End, list[float]]] = {
    "root hinge 0.01": (
        End(HELD, 0.01),
        End(),
        [0.17300129256576255, 15.427650505074128, 49.974878537577055],
    ),
    "root hinge 1000": (End(HELD, 1e3), End(), [3.5090034041582365, 21.990697774795617, 61.574964424021445]),
    "two hinges 1": (
        End(HELD, 1.0),
        End(HELD, 1.0),
        [11.551836919272969, 41.30965919552005, 90.71518892743624],
    ),
    "two springs 10": (End(10.0), End(10.0), [4.1304113880023525, 7.654125945443744, 24.14132978485006]),
    "tip spring 1000": (ENDS["clamped"], End(1e3), [15.19285111681764, 47.28330306645866, 91.25078401378613]),
    "tip hinge 100": (
        ENDS["clamped"],
        End(0.0, 100.0),
        [5.5528105938233265, 29.930390490222777, 73.92914041658612],
    ),
    "both and a body": (
        End(1000.0, 10.0),
        End(50.0, 0.0, 0.5, 0.02),
        [7.912963954444647, 10.420399386976957, 25.38475166977933, 54.32973125476974, 94.70770549896098],
    ),
}


@pytest.mark.parametrize(("mass", "inertia"), [key for key in TIP_BODY if key != (1.0, 0.01)])
def test_tip_bodies(mass: float, inertia: float) -> None:
    exact = TIP_BODY[mass, inertia]
    pair = Boundary(ENDS["clamped"], End(mass=mass, rotary_inertia=inertia))
    for ends in (pair, pair.turned):
        found = spectral_modes(UNIT, ends, len(exact)).angular_frequency
        assert np.abs(found / exact - 1.0).max() < 1e-13


@pytest.mark.parametrize("name", ELASTIC)
def test_elastic_supports(name: str) -> None:
    left, right, exact = ELASTIC[name]
    for ends in (Boundary(left, right), Boundary(right, left)):
        found = spectral_modes(UNIT, ends, len(exact))
        assert np.abs(found.angular_frequency / exact - 1.0).max() < 1e-13
        assert found.rigid_body_modes == 0


# π² times 1, 4, 1/4, (z/π)² with tan z = z, 1, 1/4, 1, 1/4: Timoshenko and Gere, Theory of Elastic Stability.
BUCKLING = {
    "pinned-pinned": 9.869604401089358,
    "clamped-clamped": 39.47841760435743,
    "clamped-free": 2.4674011002723395,
    "clamped-pinned": 20.19072855642663,
    "clamped-guided": 9.869604401089358,
    "pinned-guided": 2.4674011002723395,
    "guided-guided": 9.869604401089358,
    "guided-free": 2.4674011002723395,
}
# Compression in units of the buckling load; roots of the 4 x 4 determinant with 40 digits.
COMPRESSED = {
    ("pinned-pinned", -1.0): [13.957728399277759, 44.138212703733814, 93.63128853679319],
    ("pinned-pinned", 0.9): [3.1210429512264395, 34.754463437400815, 84.26815968311386],
    ("clamped-clamped", -1.0): [31.248581700577226, 74.8826146946405, 136.07040786875575],
    ("clamped-clamped", 0.9): [7.191358547582692, 46.404165530111165, 105.35511285338225],
    ("clamped-free", -1.0): [4.8147715702463065, 23.770134422971577, 63.22356549190704],
    ("clamped-free", 0.5): [2.534560216070987, 21.105172354558672, 60.91944304511804],
    ("clamped-free", 0.9): [1.1532760801535964, 20.32851003842023, 60.29002963259432],
    ("clamped-pinned", 0.9): [4.936838036728841, 41.43196924341798, 95.70023186548842],
}


@pytest.mark.parametrize(("boundary", "load"), BUCKLING.items())
def test_buckling_of_uniform_beams(boundary: str, load: float) -> None:
    found = spectral_buckling(BEAM, boundary) * 1.7**2 / 83.0
    assert found == pytest.approx(load, rel=1e-13)


@pytest.mark.parametrize(("boundary", "part"), COMPRESSED)
def test_axial_force(boundary: str, part: float) -> None:
    exact = COMPRESSED[boundary, part]
    found = spectral_modes(UNIT, boundary, 3, Load(-part * BUCKLING[boundary])).angular_frequency
    assert np.abs(found / exact - 1.0).max() < 1e-13


@pytest.mark.parametrize("tension", [1.0, 1e4, 1e6])
def test_a_tight_pinned_beam_is_a_string(tension: float) -> None:
    """ω² = (nπ)⁴ + T (nπ)²: Rayleigh, The Theory of Sound, vol. 1, section 188."""
    wave = np.arange(1, 11) * math.pi
    found = spectral_modes(UNIT, "pinned-pinned", 10, Load(tension)).angular_frequency
    assert np.abs(found / np.sqrt(wave**4 + tension * wave**2) - 1.0).max() < 1e-12


def test_under_tension_a_rigid_rotation_has_a_frequency() -> None:
    """As a rigid rod under tension: ω² = T L / J with J = ρAL³/12 about the middle, ρAL³/3 about an end."""
    for boundary, square, rigid in (("free-free", 12.0, 1), ("pinned-free", 3.0, 0)):
        found = spectral_modes(UNIT, boundary, 2, Load(1e-6))
        assert found.angular_frequency[0] ** 2 == pytest.approx(square * 1e-6, rel=1e-6)
        assert found.rigid_body_modes == rigid


@pytest.mark.parametrize("radius", [0.0, 0.02, 0.3])
def test_rotary_inertia_of_a_pinned_beam(radius: float) -> None:
    """ω² = (nπ)⁴ / (1 + r² (nπ)²): Rayleigh, The Theory of Sound, vol. 1, section 186."""
    wave = np.arange(1, 11) * math.pi
    found = spectral_modes(Beam(1.0, 1.0, 1.0, radius**2), "pinned-pinned", 10).angular_frequency
    assert np.abs(found / np.sqrt(wave**4 / (1.0 + radius**2 * wave**2)) - 1.0).max() < 1e-13


# --- Beams that vary -------------------------------------------------------------------------------------

WEDGE = Beam(1.0, lambda x: (1.0 - 0.5 * x) ** 3, lambda x: 1.0 - 0.5 * x)
WEDGE_SERIES = [Section(1.0, (1.0, -1.5, 0.75, -0.125), (1.0, -0.5))]
CONE = Beam(
    1.0, lambda x: (1.0 - 0.4 * x) ** 4, lambda x: (1.0 - 0.4 * x) ** 2, lambda x: 0.01 * (1.0 - 0.4 * x) ** 4
)
CONE_SERIES = [
    Section(
        1.0,
        (1.0, -1.6, 0.96, -0.256, 0.0256),
        (1.0, -0.8, 0.16),
        (0.01, -0.016, 0.0096, -0.00256, 0.000256),
    )
]
STEPS = Beam(1.0, [4.0, 1.0], [2.0, 3.0])
STEPS_SERIES = [Section(0.5, (4.0,), (2.0,)), Section(0.5, (1.0,), (3.0,))]
TABLE = Beam(
    1.0, Table((0.0, 0.25, 0.25, 1.0), (1.5, 2.0, 4.0, 2.5)), Table((0.0, 0.625, 1.0), (3.0, 1.0, 2.0))
)
TABLE_SERIES = [
    Section(0.25, (1.5, 2.0), (3.0, -3.2)),
    Section(0.375, (4.0, -2.0), (2.2, -3.2)),
    Section(0.375, (3.25, -2.0), (1.0, 8.0 / 3.0)),
]
ELASTIC_BODY = Boundary(End(40.0, 0.5, 0.3, 0.01, 0.1), End(0.0, 3.0, 0.7, 0.02, -0.2))
VARIED = {"wedge": (WEDGE, WEDGE_SERIES), "cone": (CONE, CONE_SERIES), "steps": (STEPS, STEPS_SERIES),
          "table": (TABLE, TABLE_SERIES)}  # fmt: skip


@pytest.mark.parametrize(
    "pair", [Boundary.of("clamped-free"), Boundary.of("free-pinned"), ELASTIC_BODY], ids=str
)
@pytest.mark.parametrize("name", VARIED)
def test_ten_modes_against_power_series(name: str, pair: Boundary) -> None:
    beam, sections = VARIED[name]
    omega = spectral_modes(beam, pair, 10).angular_frequency
    assert np.all(np.diff(omega) > 0.0)
    assert max(error(one, sections, pair) for one in omega[[0, 4, 9]].tolist()) < 1e-12


@pytest.mark.parametrize("name", VARIED)
def test_no_mode_is_left_out(name: str) -> None:
    beam, sections = VARIED[name]
    pair = Boundary.of("clamped-free")
    omega = spectral_modes(beam, pair, 6).angular_frequency
    assert sign_changes(0.5 * float(omega[4] + omega[5]), sections, pair) == 5


@pytest.mark.parametrize("tension", [30.0, -1.5])
@pytest.mark.parametrize("name", VARIED)
def test_axial_force_on_beams_that_vary(name: str, tension: float) -> None:
    beam, sections = VARIED[name]
    pair = Boundary(End(HELD, 2.0, 5.0, 0.1, 0.3), End(30.0, 0.0, 0.5))
    omega = spectral_modes(beam, pair, 4, Load(tension)).angular_frequency
    assert max(error(one, sections, pair, tension) for one in omega.tolist()) < 1e-12


SPRINGS = (1e-12, 1e-4, 1e12)


@pytest.mark.parametrize(
    ("left", "right"),
    in_turns(
        [End(a, b) for a in SPRINGS for b in SPRINGS],
        [End(1e-12, 1e-8), End(1e12, 1e-12, 1e3, 1.0, 0.5), End(1e-6, 1e12)],
        every=3,
    ),
    ids=str,
)
def test_stiffnesses_of_twenty_four_decades(left: End, right: End) -> None:
    pair = Boundary(left, right)
    omega = spectral_modes(STEPS, pair, 4).angular_frequency
    assert max(error(one, STEPS_SERIES, pair) for one in omega[[0, 1, 3]].tolist()) < 1e-11


def test_a_sharp_wedge_approaches_kirchhoffs() -> None:
    """A wedge to a point: 5.315, 15.207, 30.020 (Kirchhoff 1879, from Bessel functions), 0.2 % at 0.999."""
    beam = Beam(1.0, lambda x: (1.0 - 0.999 * x) ** 3, lambda x: 1.0 - 0.999 * x)
    omega = spectral_modes(beam, "clamped-free", 3).angular_frequency
    assert omega == pytest.approx([5.315, 15.207, 30.020], rel=2.5e-3)


def test_buckling_of_beams_that_vary() -> None:
    """EI = (1 + x)², pinned: y = √(1+x) sin(μ ln(1+x)), μ ln 2 = π, P = μ² + 1/4 (Euler's equation).

    Two parts, clamped-free: tan(k₁l₁) tan(k₂l₂) = k₁/k₂, part 1 the free one (Timoshenko and Gere, 2.14).
    """
    euler = spectral_buckling(Beam(1.0, lambda x: (1.0 + x) ** 2, 1.0), "pinned-pinned")
    assert euler == pytest.approx((math.pi / math.log(2.0)) ** 2 + 0.25, rel=1e-13)
    root = mp.findroot(lambda p: mp.tan(mp.sqrt(p) / 2) * mp.tan(mp.sqrt(p) / 4) - 2, 5.0)
    assert spectral_buckling(STEPS, "clamped-free") == pytest.approx(float(root), rel=1e-13)


def test_compression_at_the_buckling_load_and_beyond() -> None:
    load = spectral_buckling(TABLE, "clamped-pinned")
    still = spectral_modes(TABLE, "clamped-pinned", 1).angular_frequency[0]
    for missing in (1e-4, 1e-6, 1e-9):
        near = spectral_modes(TABLE, "clamped-pinned", 1, Load(-(1.0 - missing) * load)).angular_frequency[0]
        # ω² is nearly a straight line in P down to zero at the buckling load (Galef 1968).
        assert 0.95 < (near / still) ** 2 / missing < 1.1
    for boundary, force in (("clamped-pinned", -1.001 * load), ("pinned-free", -1e-9), ("free-free", -1e-9)):
        with pytest.raises(ValueError, match=r"^axial_force must not compress the beam beyond its buckling"):
            spectral_modes(TABLE, boundary, 1, Load(force))
    for boundary in ("pinned-free", "free-free"):
        with pytest.raises(ValueError, match=r"^boundary must resist a rigid rotation"):
            spectral_buckling(TABLE, boundary)


# --- Narrow features of functions -------------------------------------------------------------------------


def notch(width: float, centre: float, depth: float = 0.9) -> Any:
    return lambda x: 1.0 - depth * np.exp(-(((x - centre) / width) ** 2))


@pytest.mark.parametrize(
    ("width", "centre", "first"),
    [
        # Source: the exact beam of another hand, its points crowded into the notch; ten digits.
        (0.002, 0.1, 3.4437119565),
        (0.002, 0.37, 3.4912660266),
        (0.003, 0.5, 3.4987857913),
        (0.001, 0.2, 3.4899237336),
        (0.0005, 0.05, 3.4944763431),
    ],
)
def test_a_narrow_notch_is_seen(width: float, centre: float, first: float) -> None:
    beam = Beam(1.0, notch(width, centre), 1.0)
    found = spectral_modes(beam, "clamped-free", 2)
    assert found.angular_frequency[0] == pytest.approx(first, rel=2e-11)
    # The second route: a table that is fine within the notch, whose chords err by (1e-3)²/12 of its share.
    x = np.unique([0.0, 1.0, *np.clip(centre + width * np.linspace(-8.0, 8.0, 16_001), 0.0, 1.0)])
    table = Beam(1.0, Table(x, notch(width, centre)(x)), 1.0)
    assert spectral_modes(table, "clamped-free", 2).angular_frequency == pytest.approx(
        found.angular_frequency, rel=1e-7
    )


@pytest.mark.parametrize("name", ["mass_per_length", "rotary_inertia_per_length"])
def test_a_narrow_lump_of_mass_or_inertia_is_seen(name: str) -> None:
    # The same lump as a table, fine within it.
    width, centre = 1e-3, 0.6180339
    x = np.unique([0.0, 1.0, *np.clip(centre + width * np.linspace(-8.0, 8.0, 16_001), 0.0, 1.0)])
    lump = lambda z: 1.0 + 500.0 * np.exp(-(((z - centre) / width) ** 2))  # noqa: E731
    given = {"bending_stiffness": 1.0, "mass_per_length": 1.0}
    found = [
        spectral_modes(Beam(1.0, **{**given, name: profile}), "clamped-free", 3).angular_frequency
        for profile in (lump, Table(x, lump(x)))
    ]
    assert found[0] == pytest.approx(found[1], rel=1e-6)


@pytest.mark.parametrize("seed", range(8))
def test_no_feature_as_wide_as_the_distance_of_samples_is_missed(seed: int) -> None:
    # A rectangle, which no sample hints at before one falls into it: EI a tenth on L/4096.
    start = float(np.random.default_rng(seed).uniform(0.01, 0.98))
    end = start + 1.001 / SAMPLES
    beam = Beam(1.0, lambda x: np.where((x > start) & (x < end), 0.1, 1.0), 1.0)
    table = Beam(1.0, Table((0.0, start, start, end, end, 1.0), (1.0, 1.0, 0.1, 0.1, 1.0, 1.0)), 1.0)
    found = [spectral_modes(one, "clamped-clamped", 2).angular_frequency for one in (beam, table)]
    assert np.allclose(found[0], found[1], rtol=1e-10, atol=0.0)


def test_a_feature_between_all_samples_is_seen_with_breaks_beside_it() -> None:
    # It cannot be seen otherwise, as is said; one break on each side shows it.
    places = (np.arange(SAMPLES) + 0.382) / SAMPLES
    start, end = float(places[1000]) + 2e-5, float(places[1001]) - 2e-5
    narrow = lambda x: np.where((np.asarray(x) > start) & (np.asarray(x) < end), 0.01, 1.0)  # noqa: E731
    table = Beam(1.0, Table((0.0, start, start, end, end, 1.0), (1.0, 1.0, 0.01, 0.01, 1.0, 1.0)), 1.0)
    exact = spectral_modes(table, "clamped-free", 1).angular_frequency
    told = spectral_modes(Beam(1.0, narrow, 1.0, breaks=[start, end]), "clamped-free", 1).angular_frequency
    assert told == pytest.approx(exact, rel=1e-12)


# --- Random steps and kinks -------------------------------------------------------------------------------


def drawn_end(rng: np.random.Generator) -> End:
    def stiffness() -> float:
        return float(rng.choice([0.0, HELD, 10 ** rng.uniform(-3, 4)]))

    body = (
        float(rng.choice([0.0, 10 ** rng.uniform(-2, 1)])),
        float(rng.choice([0.0, 10 ** rng.uniform(-3, 0)])),
    )
    kind = int(rng.integers(0, 3))
    if kind == 0:
        return [ENDS[name] for name in ("clamped", "pinned", "guided", "free")][int(rng.integers(0, 4))]
    return End(stiffness(), stiffness(), *body, float(rng.uniform(-0.3, 0.3)))


def drawn_beam(seed: int, *, sloped: bool) -> tuple[Beam, list[Section], Boundary]:
    """Parts down to a thousandth of the length, next to each other too, EI and ρA from 0.1 to 10 on each."""
    rng = np.random.default_rng(seed)
    number = int(rng.integers(1, 10))
    close = rng.random() < 0.4
    inner = rng.uniform(0, 0.7) + np.cumsum(rng.uniform(1e-3, 0.02, number))
    inner = inner if close else np.sort(rng.uniform(0.002, 0.998, number))
    inner = inner[np.diff(inner, prepend=0.0) > 1e-3]
    edges = np.array([0.0, *inner, 1.0])
    ends = np.repeat(edges, 2)[1:-1]
    rows = [10 ** rng.uniform(-1, 1, len(ends)) for _ in range(2)]
    if not sloped:
        rows = [np.repeat(row[::2], 2) for row in rows]
    sections = []
    for i, width in enumerate(np.diff(edges).tolist()):
        (a, b), (c, d) = (row[2 * i : 2 * i + 2].tolist() for row in rows)
        # The series converges where EI less than doubles, so a steep part is several.
        share = [0.0]
        while share[-1] < 1.0:
            value = a + (b - a) * share[-1]
            share.append(min(1.0, share[-1] + 0.5 * value / abs(b - a)) if b != a else 1.0)
        for p, q in pairwise(share):
            stiff, heavy = (a + (b - a) * p, (b - a) / width), (c + (d - c) * p, (d - c) / width)
            sections.append(Section((q - p) * width, stiff, heavy))
    beam = Beam(1.0, *(Table(ends, row) for row in rows))
    return beam, sections, Boundary(drawn_end(rng), drawn_end(rng))


def check_drawn_beam(seed: int, *, sloped: bool) -> None:
    beam, sections, pair = drawn_beam(seed, sloped=sloped)
    found = spectral_modes(beam, pair, 3)
    assert found.agreement <= 1e-11
    for omega in found.angular_frequency.tolist():
        assert nearer_than(2e-11, omega, sections, pair), f"seed {seed}"


@pytest.mark.parametrize(("sloped", "seeds"), [(True, range(1)), (False, range(4)), (False, range(4, 8))])
def test_close_steps_of_a_hundred_to_one(sloped: bool, seeds: range) -> None:
    for seed in seeds:
        check_drawn_beam(seed, sloped=sloped)


@pytest.mark.slow
@pytest.mark.parametrize("block", range(20))
def test_five_hundred_drawn_tables(block: int) -> None:
    for seed in range(100 + 25 * block, 125 + 25 * block):
        # The series of a steep part is many.
        check_drawn_beam(seed, sloped=seed % 5 == 0)


# --- Shapes ----------------------------------------------------------------------------------------------


def gauss(edges: Sequence[float]) -> tuple[Any, Any]:
    node, weight = np.polynomial.legendre.leggauss(40)
    parts = [((b - a) / 2, (a + b) / 2) for a, b in pairwise(edges)]
    return np.concatenate([m + h * node for h, m in parts]), np.concatenate([h * weight for h, _ in parts])


def test_shapes_have_unit_modal_mass_and_stiffness_omega_squared() -> None:
    length = 1.3
    beam = Beam(length, [4.0, 1.0], lambda x: 2.0 - x, 0.03)
    found = spectral_modes(beam, ELASTIC_BODY, 5, Load(2.0))
    x, weight = gauss([0.0, length / 2, length])
    y, slope, curvature = (found.shape(x, order) for order in range(3))
    mass = (weight * (2.0 - x) * y) @ y.T + (weight * 0.03 * slope) @ slope.T
    stiffness = (weight * np.where(x < length / 2, 4.0, 1.0) * curvature) @ curvature.T
    stiffness += 2.0 * (weight * slope) @ slope.T
    for end, at, outward in ((ELASTIC_BODY.left, 0.0, -1.0), (ELASTIC_BODY.right, length, 1.0)):
        here, turn = found.shape(at), found.slope(at)
        centre = here + outward * float(end.offset) * turn
        mass += float(end.mass) * np.outer(centre, centre) + float(end.rotary_inertia) * np.outer(turn, turn)
        stiffness += float(end.translational_stiffness) * np.outer(here, here)
        stiffness += float(end.rotational_stiffness) * np.outer(turn, turn)
    omega = found.angular_frequency
    assert np.abs(mass - np.eye(5)).max() < 1e-12
    assert np.abs(stiffness / np.outer(omega, omega) - np.eye(5)).max() < 1e-11


@pytest.mark.parametrize("boundary", ["clamped-free", "pinned-clamped", "guided-pinned", "free-free"])
def test_first_motion_at_the_left_end_is_positive(boundary: str) -> None:
    order = {"clamped": 2, "pinned": 1, "guided": 0, "free": 0}[boundary.split("-")[0]]
    assert np.all(spectral_modes(TABLE, boundary, 8).shape(0.0, order) > 0.0)


def test_shapes_follow_the_derivative_of_the_shape_across_a_step() -> None:
    found = spectral_modes(STEPS, "pinned-free", 4)
    x, step = np.array([0.1, 0.45, 0.55, 0.9]), 1e-6
    difference = (found.shape(x + step) - found.shape(x - step)) / (2 * step)
    assert np.abs(difference - found.slope(x)).max() < 1e-7
    # The bending moment does not jump where EI falls from 4 to 1, so curvature does.
    jump = found.shape(0.5 + 1e-9, 2) / found.shape(0.5 - 1e-9, 2)
    assert np.allclose(jump, 4.0, rtol=1e-6)
    with pytest.raises(ValueError, match=r"^derivative must be .* at most 2, got 3"):
        found.shape(0.5, 3)


# --- Input -----------------------------------------------------------------------------------------------


def test_functions_of_one_number_and_of_arrays_are_the_same() -> None:
    scalar = Beam(1.0, lambda x: math.exp(-x), lambda x: max(1.0 + x, 0.0))
    array = Beam(1.0, lambda x: np.exp(-x), lambda x: 1.0 + x)
    one, other = (spectral_modes(beam, "clamped-free", 3).angular_frequency for beam in (scalar, array))
    assert np.allclose(one, other, rtol=1e-14, atol=0.0)


@pytest.mark.parametrize(("place", "names"), [(0.3, ["mass_per_length"]), (1 / 3, ["bending_stiffness"])])
def test_a_step_that_a_function_does_not_tell_is_found(place: float, names: list[str]) -> None:
    # Source: the same beam as a table. Halving stops at 1e-12 of the length.
    for name in names:
        table = Table((0.0, place, place, 1.0), (1.0, 1.0, 2.0, 2.0))
        rough = {
            "bending_stiffness": 1.0,
            "mass_per_length": 1.0,
            name: lambda x: 1.0 + (np.asarray(x) > place),
        }
        told = {**rough, name: table}
        found = [
            spectral_modes(Beam(1.0, **one), "clamped-free", 2).angular_frequency for one in (rough, told)
        ]
        assert np.allclose(found[0], found[1], rtol=1e-10, atol=0.0)


def test_a_function_that_is_nowhere_smooth_is_refused() -> None:
    rough = Beam(1.0, lambda x: 1.5 + 0.3 * np.sign(np.sin(9000.0 * np.asarray(x))), 1.0)
    with pytest.raises(ArithmeticError, match=r"^bending_stiffness must be smooth between the beam's breaks"):
        spectral_modes(rough, "clamped-free", 2)


@pytest.mark.parametrize("parts", [20, 49, 201, 400])
def test_many_steps(parts: int) -> None:
    fine = spectral_modes(Beam(1.0, [1.0, 1.0 + 1e-9] * parts, 1.0), "clamped-free", 3).angular_frequency
    assert np.allclose(fine, euler_bernoulli(UNIT, "clamped-free", 3).angular_frequency, rtol=1e-8)


def test_a_function_that_vanishes_between_the_points_of_construction() -> None:
    with pytest.raises(
        ValueError, match=r"^bending_stiffness must be greater than 0, got -0\.\d+ at x = 0\.43"
    ):
        Beam(1.0, lambda x: 1.0 - 1.5 * np.exp(-(((x - 0.4387) / 0.0005) ** 2)), 1.0)


def test_result_is_frozen() -> None:
    found = spectral_modes(UNIT, "clamped-free", 2)
    assert isinstance(found, SpectralBeamModes) and (found.beam, found.load) == (UNIT, Load())
    with pytest.raises(AttributeError):
        found.beam = BEAM  # type: ignore[misc]
    with pytest.raises(ValueError, match="read-only"):
        found.angular_frequency[0] = 1.0


anything = st.one_of(st.none(), st.floats(), st.text(), st.binary(), st.booleans(), st.complex_numbers())


@settings(max_examples=40)
@given(bad=anything)
def test_wrong_arguments_are_named(bad: Any) -> None:
    found = spectral_modes(UNIT, "clamped-free", 1)
    for name, call in (
        ("beam", lambda: spectral_modes(bad, "clamped-free", 1)),
        ("beam", lambda: spectral_buckling(bad, "clamped-free")),
        ("modes", lambda: spectral_modes(UNIT, "clamped-free", bad)),
        ("derivative", lambda: found.shape(0.0, bad)),
        ("(boundary|end)", lambda: spectral_modes(UNIT, bad, 1)),
        ("load", lambda: spectral_modes(UNIT, "clamped-free", 1, 2.0 if bad is None else bad)),
    ):
        with pytest.raises((TypeError, ValueError), match=f"^{name} must"):
            call()


@settings(max_examples=40)
@given(bad=st.one_of(st.floats(max_value=-1e-300), st.floats(min_value=1.001), st.just(math.nan), st.text()))
def test_positions_off_the_beam(bad: Any) -> None:
    with pytest.raises((TypeError, ValueError), match=r"^x must be"):
        spectral_modes(UNIT, "clamped-free", 1).shape([0.5, bad])


@pytest.mark.parametrize("bad", [0, 101, -3])
def test_numbers_of_modes_out_of_range(bad: int) -> None:
    with pytest.raises(ValueError, match=r"^modes must"):
        spectral_modes(UNIT, "clamped-free", bad)
