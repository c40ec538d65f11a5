"""The uniform beam with springs, bodies, axial force and rotary inertia, against independent solutions."""

from __future__ import annotations

import decimal
import math
import random
from fractions import Fraction
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from beammodes.exact.exact_beam import plain_modes
from beammodes.exact.supported_beam import SupportedBeamModes, critical_compression, supported_modes
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BOUNDARIES, ENDS, Boundary, End
from beammodes.problem.loading import Load

BEAM = Beam(length=1.7, bending_stiffness=83.0, mass_per_length=0.45)
UNIT = Beam.unit()
BOTH_ORDERS = [f"{a}-{b}" for a in ENDS for b in ENDS]

Floats = NDArray[np.float64]

# Clamped beam with a body of μ = m/(ρA L) and j = J/(ρA L³) at its tip. Source: roots of
# 1 + c C + μ λ (c S - s C) - j λ³ (C s + S c) + μ j λ⁴ (1 - c C) = 0, the characteristic equation; μ = 1 also
# in Bir (2010), table 5 (1.557, 16.25).
TIP_BODIES = {
    (0.1, 0.0): (2.9678383467759746, 19.35580100987733, 55.518245548786524, 110.70795445059461),
    (0.5, 0.0): (2.0162989818067807, 16.90141772097364, 51.700920891783305, 106.05797853895407),
    (1.0, 0.0): (1.557297861198921, 16.2500851582386, 50.89584283121596, 105.19827584975472),
    (10.0, 0.0): (0.5413750329007182, 15.511513119691896, 50.06434697340694, 104.34717455640384),
    (0.5, 0.01): (1.9875255750879084, 13.403441938004592, 32.345056897142506, 67.97422747092449),
    (1.0, 0.01): (1.5436768034058521, 13.239588559535301, 32.06958081008119, 66.82867622909328),
}

# Elastic supports in units of EI/L³ and EI/L. Source: the defining equation in 40 to 60 digits, apart from
# this package; the root springs 2 and 10 agree with the tip masses 0.5 and 0.1 above.
SPRINGS = {
    "pinned(rotational_stiffness=0.01)-free": (0.17300129256576255, 15.427650505074128, 49.974878537577055),
    "pinned(rotational_stiffness=0.5)-free": (1.1581971073829629, 15.860889992394663, 50.44763966539512),
    "pinned(rotational_stiffness=2)-free": (2.0162989818067807, 16.90141772097364, 51.700920891783305),
    "pinned(rotational_stiffness=10)-free": (2.9678383467759746, 19.35580100987733, 55.518245548786524),
    "pinned(rotational_stiffness=1000)-free": (3.5090034041582365, 21.990697774795617, 61.574964424021445),
    "pinned(rotational_stiffness=1)-pinned(rotational_stiffness=1)": (
        *(11.551836919272969, 41.30965919552005, 90.71518892743624, 159.8308690348377, 248.6742594592057),
    ),
    "pinned(rotational_stiffness=100)-pinned(rotational_stiffness=100)": (
        *(21.541841710002778, 59.44856463665635, 116.6671087355787, 193.05374389474406),
    ),
    "free(translational_stiffness=10)-free(translational_stiffness=10)": (
        *(4.1304113880023525, 7.654125945443744, 24.14132978485006, 62.32611768297501, 121.23558389023002),
    ),
    "free(translational_stiffness=1000)-free(translational_stiffness=1000)": (
        *(9.678715907394967, 36.44613019589153, 73.36940840932587, 112.59158001207199, 158.18090874271655),
    ),
    "clamped-free(translational_stiffness=10)": (6.963923552724074, 22.980238966698682, 62.025909275084146),
    "clamped-free(translational_stiffness=1000)": (15.19285111681764, 47.28330306645866, 91.25078401378613),
    "clamped-free(rotational_stiffness=1)": (4.218713434314991, 23.70327995814874, 63.451933307470036),
    "clamped-free(rotational_stiffness=100)": (5.5528105938233265, 29.930390490222777, 73.92914041658612),
    "free(translational_stiffness=1000, rotational_stiffness=10)"
    "-free(translational_stiffness=50, mass=0.5, rotary_inertia=0.02)": (
        *(7.912963954444647, 10.420399386976957, 25.38475166977933, 54.32973125476974, 94.70770549896098),
    ),
}

# Compression in units of each pair's own buckling load. Source: as above; the pinned pair's numbers are
# nπ √(n²π² - P) in closed form.
COMPRESSED = {
    ("pinned-pinned", -1.0): (13.957728399277759, 44.138212703733814, 93.63128853679319),
    ("pinned-pinned", 0.5): (6.978864199638879, 36.9286782118726, 86.32378272585827),
    ("pinned-pinned", 0.9): (3.1210429512264395, 34.754463437400815, 84.26815968311386),
    ("clamped-clamped", -1.0): (31.248581700577226, 74.8826146946405, 136.07040786875575),
    ("clamped-clamped", 0.5): (15.951287605328371, 53.76264290743951, 112.53422334126039),
    ("clamped-clamped", 0.9): (7.191358547582692, 46.404165530111165, 105.35511285338225),
    ("clamped-free", -1.0): (4.8147715702463065, 23.770134422971577, 63.22356549190704),
    ("clamped-free", 0.5): (2.534560216070987, 21.105172354558672, 60.91944304511804),
    ("clamped-free", 0.9): (1.1532760801535964, 20.32851003842023, 60.29002963259432),
    ("clamped-pinned", -1.0): (21.60557587893725, 57.976666087798584, 112.98504906924386),
    ("clamped-pinned", 0.5): (10.970422211028536, 45.422902823697456, 99.5898745280488),
    ("clamped-pinned", 0.9): (4.936838036728841, 41.43196924341798, 95.70023186548842),
}


def unit_frequencies(boundary: Any, modes: int, tension: float = 0.0, rotary_inertia: float = 0.0) -> Floats:
    return supported_modes(UNIT, boundary, modes, Load(tension), rotary_inertia).angular_frequency


# --- Printed numbers -------------------------------------------------------------------------------------


@pytest.mark.parametrize(("body", "expected"), TIP_BODIES.items())
def test_tip_bodies(body: tuple[float, float], expected: tuple[float, ...]) -> None:
    end = End(mass=body[0], rotary_inertia=body[1])
    np.testing.assert_allclose(unit_frequencies(("clamped", end), 4), expected, rtol=1e-14)


@pytest.mark.parametrize(("boundary", "expected"), SPRINGS.items())
def test_elastic_supports(boundary: str, expected: tuple[float, ...]) -> None:
    np.testing.assert_allclose(unit_frequencies(boundary, len(expected)), expected, rtol=1e-14)


@pytest.mark.parametrize(("case", "expected"), COMPRESSED.items())
def test_axial_force(case: tuple[str, float], expected: tuple[float, ...]) -> None:
    compression = case[1] * critical_compression(UNIT, case[0])
    # The compression's own rounding counts ten times at nine tenths of the buckling load.
    np.testing.assert_allclose(unit_frequencies(case[0], 3, -compression), expected, rtol=1e-13)


@pytest.mark.parametrize(("boundary", "first"), [("pinned-pinned", 1), ("guided-guided", 1)])
@pytest.mark.parametrize("rotary", [0.0, 1e-6, 1e-3, 0.1, 1e6])
@pytest.mark.parametrize("tension", [-9.0, 0.0, 7.0, 1e5, 1e14])
def test_sine_modes_in_closed_form(boundary: str, first: int, rotary: float, tension: float) -> None:
    """Source: φ = sin or cos nπξ put into the equation: ω² (1 + r² n²π²) = n⁴π⁴ + τ n²π²."""
    wave = math.pi * np.arange(first, 31)
    expected = wave * np.sqrt((wave**2 + tension) / (1.0 + rotary * wave**2))
    np.testing.assert_allclose(unit_frequencies(boundary, 30, tension, rotary), expected, rtol=2e-15)


def test_a_tight_light_beam_is_a_string() -> None:
    """Source: a string with a bead, z tan z = 1/μ with z = ω/√τ, whose first root for μ = 3 is 0.547160..."""
    z = unit_frequencies("pinned-free(mass=3)", 1, 1e14)[0] / 1e7
    assert z * math.tan(z) == pytest.approx(1.0 / 3.0, rel=1e-6)


# --- Other exact solutions -------------------------------------------------------------------------------


@pytest.mark.parametrize("boundary", BOTH_ORDERS)
def test_plain_pairs_agree_with_their_own_equation(boundary: str) -> None:
    ours, theirs = supported_modes(BEAM, boundary, 50), plain_modes(BEAM, boundary, 50)
    np.testing.assert_allclose(ours.angular_frequency, theirs.angular_frequency, rtol=1e-14)
    assert ours.rigid_body_modes == theirs.rigid_body_modes
    x = np.linspace(0.0, BEAM.length, 37)
    for order in range(4):
        # Mode n keeps 1e-15 n inside, in either solution.
        scale = (theirs.wavenumber[:, None] / BEAM.length) ** order * np.arange(1, 51)[:, None]
        assert np.abs((ours.shape(x, order) - theirs.shape(x, order)) / scale).max() < 1e-14


@pytest.mark.parametrize("ratio", 10.0 ** np.arange(-6, 7))
def test_a_tip_mass_is_dual_to_a_root_spring(ratio: float) -> None:
    """Source: φ'' of a clamped beam with tip mass μ solves the free beam on a hinge of stiffness 1/μ."""
    loaded = unit_frequencies(("clamped", End(mass=ratio)), 25)
    hinged = unit_frequencies((End(math.inf, 1.0 / ratio), "free"), 25)
    np.testing.assert_allclose(loaded, hinged, rtol=1e-14)


def state_basis(p: Any, q: Any, x: int) -> list[list[Any]]:
    """Return y, y', y'', y''' of cosh px, sinh px, cos qx, sin qx at x = 0 or 1, in mpmath numbers."""
    pairs = [(mp.cosh(p * x), mp.sinh(p * x)), (mp.sinh(p * x), mp.cosh(p * x))]
    return [
        [
            *(p**k * value for value in pairs[k % 2]),
            *(q**k * wave(q * x + k * mp.pi / 2) for wave in (mp.cos, mp.sin)),
        ]
        for k in range(4)
    ]


def end_rows(end: End, side: int, states: list[list[Any]], tension: Any, square: Any) -> list[list[Any]]:
    """Return the balance of force and of moment at an end (`side` -1 left, 1 right), or what it holds."""
    mass, inertia, offset = (mp.mpf(float(number)) for number in end.moving_body)
    rows = []
    for held, spring, place in (
        (end.holds_deflection, end.translational_stiffness, 0),
        (end.holds_rotation, end.rotational_stiffness, 1),
    ):
        row = []
        for y, slope, curvature, rate in zip(*states, strict=True):
            inner = -square * mass * (y + side * offset * slope)
            force = side * (tension * slope - rate), side * curvature - square * inertia * slope
            body = inner if place == 0 else side * offset * inner
            row.append(
                (y, slope)[place] if held else force[place] + body + mp.mpf(float(spring)) * (y, slope)[place]
            )
        rows.append(row)
    return rows


def determinant(boundary: Boundary, tension: float, rotary: float, frequency: Any) -> Any:
    square = frequency**2
    pull = mp.mpf(tension) - mp.mpf(rotary) * square
    middle = mp.sqrt(pull**2 / 4 + square)
    p, q = mp.sqrt(middle + pull / 2), mp.sqrt(middle - pull / 2)
    rows = end_rows(boundary.left, -1, state_basis(p, q, 0), pull, square)
    rows += end_rows(boundary.right, 1, state_basis(p, q, 1), pull, square)
    return mp.det(mp.matrix(rows))


def relative_error(boundary: Boundary, tension: float, rotary: float, frequency: float) -> float:
    """Return how far a frequency is from the determinant's root, which must lie within 1e-12 of it."""
    at = [mp.mpf(frequency) * (1 + sign * mp.mpf("1e-12")) for sign in (-1, 1)]
    low, high = (determinant(boundary, tension, rotary, place) for place in at)
    assert low * high < 0, (boundary, tension, rotary, frequency)
    # A straight line over 2e-12 of the frequency: its own error is below 1e-20.
    root = at[0] - low * (at[1] - at[0]) / (high - low)
    return float(abs(root / mp.mpf(frequency) - 1))


def random_end(chance: random.Random, decades: float) -> End:
    def number(*special: float) -> float:
        return chance.choice([*special, *[10.0 ** chance.uniform(-decades, decades)] * 3])

    offset = chance.choice([0.0, chance.uniform(-0.5, 0.5)])
    return End(number(0.0, math.inf), number(0.0, math.inf), number(0.0), number(0.0), offset)


@pytest.mark.parametrize("seed", range(24))
def test_random_ends_against_the_determinant_in_long_arithmetic(seed: int) -> None:
    """Source: the determinant of cosh, sinh, cos and sin in the four end conditions, in 150 digits."""
    chance = random.Random(seed)
    decades = 9.0 if seed % 3 == 0 else 4.0
    boundary = Boundary(random_end(chance, decades), random_end(chance, decades))
    tension = chance.choice([0.0, 10.0 ** chance.uniform(-3.0, 3.0), -0.9])
    if tension < 0.0:
        turns = boundary.rigid_body_modes > int(guided(boundary))
        tension = 0.0 if turns else tension * critical_compression(UNIT, boundary)
    rotary = chance.choice([0.0, 10.0 ** chance.uniform(-6.0, -1.0)])
    with mp.workdps(150):
        for frequency in unit_frequencies(boundary, 6, tension, rotary):
            assert relative_error(boundary, tension, rotary, frequency) < 1e-15


def guided(boundary: Boundary) -> bool:
    """Whether nothing holds the translation, though something holds the rotation."""
    return boundary.rigid_body_modes == 1 and not any(
        end.translational_stiffness for end in (boundary.left, boundary.right)
    )


@pytest.mark.parametrize("seed", range(6))
def test_high_modes_against_the_determinant(seed: int) -> None:
    """The first dozen modes and the ones above are two solutions: here they meet. Source as above."""
    chance = random.Random(100 + seed)
    boundary = Boundary(random_end(chance, 4.0), random_end(chance, 4.0))
    tension, rotary = 10.0 ** chance.uniform(-1.0, 4.0), chance.choice([0.0, 1e-5, 1e-4])
    frequencies = unit_frequencies(boundary, 120, tension, rotary)
    with mp.workdps(500):
        for frequency in frequencies[[*range(9, 18), 119]]:
            assert relative_error(boundary, tension, rotary, frequency) < 2e-15


def test_ten_thousand_modes_agree_with_the_plain_equation() -> None:
    for pair in BOUNDARIES:
        ours = supported_modes(BEAM, pair, 10_000).angular_frequency
        np.testing.assert_allclose(ours, plain_modes(BEAM, pair, 10_000).angular_frequency, rtol=2e-15)


# --- None missed, none twice -----------------------------------------------------------------------------


def ritz_count(boundary: Boundary, tension: float, rotary: float, square: float, terms: int = 18) -> int:
    """Count squared frequencies below `square` by Ritz's method with powers of x, in long arithmetic.

    The Gauss elimination of K - ω² M, bordered by the held quantities, has one negative pivot for each
    frequency below and one for each border.
    """
    power, one, none = range(terms), decimal.Decimal(1), decimal.Decimal(0)
    t, r, w = (decimal.Decimal(number) for number in (tension, rotary, square))
    matrix = [
        [
            (i * (i - 1) * j * (j - 1) * one / (i + j - 3) if min(i, j) > 1 else none)
            + ((t - w * r) * i * j / (i + j - 1) if min(i, j) > 0 else none)
            - w / (i + j + 1)
            for j in power
        ]
        for i in power
    ]
    borders = []
    for end, side, values, slopes in (
        (boundary.left, -1, [int(i == 0) for i in power], [int(i == 1) for i in power]),
        (boundary.right, 1, [1 for _ in power], list(power)),
    ):
        mass, inertia, offset = (decimal.Decimal(float(number)) for number in end.moving_body)
        centre = [y + side * offset * slope for y, slope in zip(values, slopes, strict=True)]
        terms_of_end = [(-w * mass, centre), (-w * inertia, slopes)]
        for held, spring, vector in (
            (end.holds_deflection, end.translational_stiffness, values),
            (end.holds_rotation, end.rotational_stiffness, slopes),
        ):
            if held:
                borders.append(vector)
            else:
                terms_of_end.append((decimal.Decimal(float(spring)), vector))
        for factor, vector in terms_of_end:
            for i in power:
                for j in power:
                    matrix[i][j] += factor * vector[i] * vector[j]
    for vector in borders:
        border = [*(entry * one for entry in vector), *[none] * (len(matrix) - terms)]
        for row, entry in zip(matrix, border, strict=True):
            row.append(entry)
        matrix.append([*border, none])
    return negative_pivots(matrix) - len(borders)


def negative_pivots(matrix: list[list[Any]]) -> int:
    negative = 0
    for step, top in enumerate(matrix):
        negative += top[step] < 0
        for i in range(step + 1, len(matrix)):
            factor = top[i] / top[step]
            for j in range(i, len(matrix)):
                matrix[i][j] -= factor * top[j]
    return negative


decades = st.floats(-6.0, 6.0).map(lambda power: 10.0**power)
ends = st.builds(
    End,
    translational_stiffness=st.one_of(st.just(0.0), st.just(math.inf), decades),
    rotational_stiffness=st.one_of(st.just(0.0), st.just(math.inf), decades),
    mass=st.one_of(st.just(0.0), st.floats(-3.0, 3.0).map(lambda power: 10.0**power)),
    rotary_inertia=st.one_of(st.just(0.0), st.floats(-3.0, 3.0).map(lambda power: 10.0**power)),
    offset=st.floats(-0.5, 0.5),
)


@given(ends, ends, st.one_of(st.just(0.0), st.floats(-0.9, 0.0), st.floats(0.0, 100.0)), st.floats(0.0, 0.01))
@settings(max_examples=30, deadline=None)
def test_every_mode_is_found_once(left: End, right: End, tension: float, rotary: float) -> None:
    boundary = Boundary(left, right)
    if tension < 0.0:
        try:
            tension *= critical_compression(UNIT, boundary)
        except ValueError:
            tension = -tension
    modes = supported_modes(UNIT, boundary, 16, Load(tension), rotary)
    squares = modes.angular_frequency**2
    assert np.all(np.diff(squares) > 0.0) and squares[0] > 0.0
    assert np.all(np.isfinite([modes.shape([0.0, 0.3, 1.0], order) for order in range(4)]))
    with decimal.localcontext(prec=100):
        counts = [
            ritz_count(boundary, tension, rotary, math.sqrt(squares[n]) * math.sqrt(squares[n + 1]))
            for n in range(3)
            if squares[n + 1] > squares[n] * (1.0 + 1e-5)
        ]
    found = [n + 1 for n in range(3) if squares[n + 1] > squares[n] * (1.0 + 1e-5)]
    assert counts == [modes.rigid_body_modes + n for n in found]


@pytest.mark.parametrize(
    ("end", "modes", "gap"),
    [
        (End(1e-9, 0.0, 1e9), 2, 1e-9),
        (End(1e9, 0.0, 1e9), 2, 1e-9),
        (End(1e13, 0.0, 1e8), 18, 1e-8),
        (End(1e16, 0.0, 1e8), 34, 1e-9),  # Above the dozen modes solved in decimals.
        (End(3e8, 1e8, 2.0, 1e3, 0.2), 8, 1e-2),
    ],
)
def test_close_pairs_are_two_modes(end: End, modes: int, gap: float) -> None:
    frequencies = unit_frequencies((end, end), modes)
    nearness = np.diff(frequencies) / frequencies[1:]
    assert 0.0 < nearness.min() < gap
    with mp.workdps(150):
        for frequency in frequencies:
            places = [mp.mpf(frequency) * (1 + sign * mp.mpf("1e-15")) for sign in (-1, 1)]
            low, high = (determinant(Boundary(end, end), 0.0, 0.0, place) for place in places)
            assert low * high < 0


@pytest.mark.parametrize("scale", [1e-9, 1e-30, 1e9])
def test_soft_springs_and_heavy_bodies_keep_every_digit(scale: float) -> None:
    """Source: first-order energies of a straight beam, ω² = 2k/(1 + 2m) and (k/2)/(m/2 + 1/12)."""
    mass = 1.0 / scale if scale < 1.0 else scale
    end = End(min(scale, 1.0 / scale), 0.0, mass)
    frequencies = unit_frequencies((end, end), 2)
    expected = [math.sqrt(end.translational_stiffness / n) for n in (mass + 0.5, mass + 1.0 / 6.0)]
    np.testing.assert_allclose(frequencies, expected, rtol=4e-16)


# --- Rigid-body modes and buckling -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("boundary", "without", "pulled"),
    [("free-free", 2, 1), ("pinned-free", 1, 0), ("guided-guided", 1, 1), ("guided-free", 1, 1)],
)
def test_tension_resists_rotation_and_not_translation(boundary: str, without: int, pulled: int) -> None:
    assert supported_modes(UNIT, boundary, 1).rigid_body_modes == without
    modes = supported_modes(UNIT, boundary, 1, Load(1e-6))
    assert modes.rigid_body_modes == pulled
    if without > pulled:
        # Source: energy of a straight beam, τ θ² over θ²/3 (pinned) or θ²/12 (free).
        rigid = math.sqrt(1e-6 * (3.0 if boundary == "pinned-free" else 12.0))
        assert modes.angular_frequency[0] == pytest.approx(rigid, rel=1e-6)


@pytest.mark.parametrize("boundary", [pair.name for pair in BOUNDARIES])
def test_compression_beyond_buckling_is_refused(boundary: str) -> None:
    try:
        critical = critical_compression(BEAM, boundary)
    except ValueError:
        critical = 0.0
    for force in (-critical * (1 + 1e-12) - 1e-300, -critical - 1.0, -1e6):
        with pytest.raises(ValueError, match=r"^axial_force must.*straight beam buckles, got -"):
            supported_modes(BEAM, boundary, 1, Load(force))
    if critical:
        first = supported_modes(BEAM, boundary, 1, Load(-critical * (1 - 1e-12))).angular_frequency[0]
        # ω² falls in proportion to what is left of the load.
        assert 0.0 < first < 2e-6 * supported_modes(BEAM, boundary, 1).angular_frequency[0]


# --- Mode shapes -----------------------------------------------------------------------------------------

GENERAL = [
    ("clamped-free(mass=0.5, rotary_inertia=0.02, offset=0.1)", 0.0, 0.0),
    ("free(mass=2, offset=-0.3)-free(translational_stiffness=7)", 0.0, 0.0),
    (
        "free(translational_stiffness=400, rotational_stiffness=2, mass=0.1, rotary_inertia=0.1)-pinned",
        50.0,
        0.0,
    ),
    ("pinned(rotational_stiffness=30)-guided(mass=0.7)", -4.0, 0.002),
    ("free-free", 100.0, 0.01),
    ("free(translational_stiffness=1e-5)-free(translational_stiffness=2e-5, mass=30, offset=0.4)", 0.0, 1e-5),
    ("pinned(mass=3, offset=0.2)-clamped", -200.0, 0.0),
    ("clamped-clamped", -180.0, 0.0),
]


def gauss_legendre(length: float, panels: int) -> tuple[Floats, Floats]:
    node, weight = np.polynomial.legendre.leggauss(16)
    half = length / panels / 2.0
    centre = half * (2.0 * np.arange(panels) + 1.0)
    return (centre[:, None] + half * node).ravel(), np.tile(half * weight, panels)


def solved(case: tuple[str, float, float], modes: int) -> SupportedBeamModes:
    return supported_modes(BEAM, case[0], modes, Load(case[1]), case[2])


def energies(modes: SupportedBeamModes, panels: int) -> tuple[Floats, Floats]:
    """Return the matrices of modal mass and stiffness, by quadrature over the beam and sums over the ends."""
    x, weight = gauss_legendre(BEAM.length, panels)
    y, slope, curvature = (modes.shape(x, order) for order in range(3))
    mass = 0.45 * (y * weight) @ y.T + modes.rotary_inertia_per_length * (slope * weight) @ slope.T
    stiffness = 83.0 * (curvature * weight) @ curvature.T
    stiffness += float(modes.load.axial_force) * (slope * weight) @ slope.T
    for end, place, side in ((modes.boundary.left, 0.0, -1), (modes.boundary.right, BEAM.length, 1)):
        body, inertia, offset = (float(number) for number in end.moving_body)
        y, slope = modes.shape(place), modes.slope(place)
        centre = y + side * offset * slope
        mass += body * np.outer(centre, centre) + inertia * np.outer(slope, slope)
        for spring, motion in ((end.translational_stiffness, y), (end.rotational_stiffness, slope)):
            stiffness += (float(spring) if spring < math.inf else 0.0) * np.outer(motion, motion)
    return mass, stiffness


@pytest.mark.parametrize("case", GENERAL)
def test_unit_modal_mass_and_orthogonality(case: tuple[str, float, float]) -> None:
    modes = solved(case, 30)
    mass, stiffness = energies(modes, 60)
    assert np.abs(mass - np.eye(30)).max() < 1e-12
    omega = modes.angular_frequency
    assert np.abs(stiffness / np.outer(omega, omega) - np.eye(30)).max() < 1e-10
    assert np.abs(np.diag(stiffness) / omega**2 - 1.0).max() < 1e-12


@pytest.mark.parametrize("case", GENERAL)
def test_end_conditions(case: tuple[str, float, float]) -> None:
    """Force and moment on an end balance its springs and its body, or the held motion is zero."""
    modes = solved(case, 30)
    square, wave = modes.angular_frequency**2, (modes.waves.p + modes.waves.q) / BEAM.length
    pull = case[1] - case[2] * square
    for end, place, side in ((modes.boundary.left, 0.0, -1), (modes.boundary.right, BEAM.length, 1)):
        y, slope, curvature, rate = (modes.shape(place, order) for order in range(4))
        kt, kr = float(end.translational_stiffness), float(end.rotational_stiffness)
        body, inertia, offset = (float(number) for number in end.moving_body)
        inner = square * body * (y + side * offset * slope)
        force, moment = side * (pull * slope - 83.0 * rate) - inner, side * 83.0 * curvature
        moment -= square * inertia * slope + side * offset * inner
        # What rounding of an amplitude near one makes of each, a heavy body being the worst.
        noise = 83.0 * wave**3 + square * body * (1.0 + abs(offset) * wave)
        turning = 83.0 * wave**2 + square * (inertia * wave + body * abs(offset) * (1.0 + abs(offset) * wave))
        left_over = y if end.holds_deflection else (force + kt * y) / (noise + kt)
        assert np.abs(left_over).max() < 5e-15
        left_over = slope / wave if end.holds_rotation else (moment + kr * slope) / (turning + kr * wave)
        assert np.abs(left_over).max() < 5e-15


@pytest.mark.parametrize("case", GENERAL)
def test_derivatives_are_those_of_the_deflection(case: tuple[str, float, float]) -> None:
    modes = solved(case, 6)
    x, step = np.linspace(0.1, 1.6, 9), 1e-4
    for order in range(3):
        difference = (modes.shape(x + step, order) - modes.shape(x - step, order)) / (2 * step)
        exact = modes.shape(x, order + 1)
        wave = np.maximum(modes.waves.q, modes.waves.p)[:, None] / BEAM.length
        assert np.abs((difference - exact) / (wave**order * (1 + wave**3))).max() < 1e-6
    assert np.array_equal(modes.slope(x), modes.shape(x, 1))


@pytest.mark.parametrize("case", GENERAL)
def test_the_mirror_image(case: tuple[str, float, float]) -> None:
    modes = solved(case, 20)
    mirrored = supported_modes(BEAM, modes.boundary.turned, 20, modes.load, case[2])
    x = np.linspace(0.0, BEAM.length, 11)
    np.testing.assert_allclose(mirrored.angular_frequency, modes.angular_frequency, rtol=1e-15)
    turned = mirrored.shape(BEAM.length - x)
    sign = np.sign(np.sum(turned * modes.shape(x), axis=1))[:, None]
    assert np.abs(sign * turned - modes.shape(x)).max() < 1e-12


@pytest.mark.parametrize("case", GENERAL)
def test_first_motion_at_the_left_end_is_positive(case: tuple[str, float, float]) -> None:
    modes = solved(case, 25)
    order = {"clamped": 2, "pinned": 1}.get(case[0].split("-")[0].split("(")[0], 0)
    assert np.all(modes.shape(0.0, order) > 0.0)


def test_shapes_of_both_solutions_of_high_modes_meet() -> None:
    modes = supported_modes(UNIT, "clamped-free(mass=0.3, rotary_inertia=0.01, offset=0.1)", 60, Load(20.0))
    x, weight = gauss_legendre(1.0, 60)
    y, tip, slope = modes.shape(x), modes.shape(1.0), modes.slope(1.0)
    mass = (y * weight) @ y.T + 0.3 * np.outer(tip + 0.1 * slope, tip + 0.1 * slope)
    assert np.abs(mass + 0.01 * np.outer(slope, slope) - np.eye(60)).max() < 1e-12


# --- Units, types and bad input --------------------------------------------------------------------------


def test_frequencies_carry_units() -> None:
    length, stiffness, mass = 1.7, 83.0, 0.45
    end = End(20.0 * stiffness / length**3, 3.0 * stiffness / length, 0.4 * mass * length, 0.0, 0.1 * length)
    found = supported_modes(
        BEAM, ("clamped", end), 5, Load(2.0 * stiffness / length**2), 1e-3 * mass * length**2
    )
    expected = unit_frequencies(("clamped", End(20.0, 3.0, 0.4, 0.0, 0.1)), 5, 2.0, 1e-3)
    np.testing.assert_allclose(found.angular_frequency, expected * BEAM.frequency_unit, rtol=4e-15)
    np.testing.assert_allclose(found.frequency, found.angular_frequency / 6.283185307179586, rtol=1e-15)
    shapes = supported_modes(UNIT, ("clamped", End(20.0, 3.0, 0.4, 0.0, 0.1)), 5, Load(2.0), 1e-3).shape(1.0)
    np.testing.assert_allclose(found.shape(length) * math.sqrt(mass * length), shapes, rtol=1e-12)


def test_the_beams_own_rotary_inertia_counts() -> None:
    beam = Beam(1.0, 1.0, 1.0, 0.01)
    own = supported_modes(beam, "clamped-free", 3)
    assert own.rotary_inertia_per_length == 0.01
    assert np.array_equal(own.angular_frequency, unit_frequencies("clamped-free", 3, 0.0, 0.01))
    assert np.array_equal(
        supported_modes(beam, "clamped-free", 3, None, 0.0).angular_frequency,
        unit_frequencies("clamped-free", 3),
    )


def test_fractions_and_shapes_of_arrays() -> None:
    exact = Boundary(End(Fraction(1, 3)), End(Fraction(0), Fraction(2, 7), Fraction(1, 9)))
    rounded = Boundary(End(1 / 3), End(0.0, 2 / 7, 1 / 9))
    modes = supported_modes(UNIT, exact, 3, Load(Fraction(1, 7)))
    np.testing.assert_allclose(modes.angular_frequency, unit_frequencies(rounded, 3, 1 / 7), rtol=1e-15)
    assert modes.shape(0.5).shape == (3,)
    assert modes.shape(np.full((2, 4), 0.5)).shape == (3, 2, 4)
    assert modes.shape([]).shape == (3, 0)


def test_the_callers_decimal_context_does_not_matter() -> None:
    expected = unit_frequencies("clamped-free(mass=1)", 3)
    with decimal.localcontext() as context:
        context.prec, context.Emax = 3, 5
        context.traps[decimal.Inexact] = True
        assert np.array_equal(unit_frequencies("clamped-free(mass=1)", 3), expected)
        assert critical_compression(UNIT, "clamped-free") == pytest.approx(math.pi**2 / 4)


def test_numbers_at_the_edges_of_floating_point() -> None:
    edges = Boundary(End(1e200, 1e250, 1e100, 1e-100), End(1e-200, 1e-90, 1e-80))
    # Source: so stiff and so soft are clamped and free.
    plain = plain_modes(UNIT, "clamped-free", 6).angular_frequency
    np.testing.assert_allclose(unit_frequencies(edges, 6), plain, rtol=1e-14)


def test_result_is_frozen() -> None:
    modes = supported_modes(UNIT, "clamped-free", 2)
    with pytest.raises(AttributeError):
        modes.beam = BEAM  # type: ignore[misc]
    with pytest.raises(ValueError, match="read-only"):
        modes.relative_frequency[0] = 1.0


@pytest.mark.parametrize("bad", [None, "beam", 1.0, Beam])
def test_a_beam_must_be_a_beam(bad: Any) -> None:
    with pytest.raises(TypeError, match=r"^beam must be a Beam"):
        supported_modes(bad, "clamped-free", 1)


def test_bad_arguments_are_named() -> None:
    with pytest.raises(ValueError, match=r"^beam must be uniform"):
        supported_modes(Beam(1.0, [1.0, 2.0], 1.0), "clamped-free", 1)
    with pytest.raises(ValueError, match=r"^boundary must"):
        supported_modes(UNIT, "clamped-fre", 1)
    with pytest.raises(TypeError, match=r"^load must"):
        supported_modes(UNIT, "clamped-free", 1, -1.0)  # type: ignore[arg-type]
    for bad in (0, -3, 10**6 + 1):
        with pytest.raises(ValueError, match=r"^modes must"):
            supported_modes(UNIT, "clamped-free", bad)
    with pytest.raises(ValueError, match=r"^rotary_inertia_per_length must not be negative, got -1"):
        supported_modes(UNIT, "clamped-free", 1, None, -1.0)
    with pytest.raises(TypeError, match=r"^rotary_inertia_per_length must"):
        supported_modes(UNIT, "clamped-free", 1, None, "1")  # type: ignore[arg-type]
    modes = supported_modes(UNIT, "clamped-free", 1)
    for x in (1.1, [0.5, -1e-9], math.nan):
        with pytest.raises(ValueError, match=r"^x must be finite and inside"):
            modes.shape(x)
    with pytest.raises(ValueError, match=r"^derivative must"):
        modes.shape(0.0, 4)
