"""Timoshenko's beam: counted roots against elements, a determinant in 50 digits, closed forms and tables."""

from __future__ import annotations

import math
import pickle
from decimal import Decimal, localcontext
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import scipy.linalg
from turns import in_turns

import beammodes as bm
from beammodes.exact.timoshenko_beam import theory_error_of, timoshenko
from beammodes.exact.uniform_beam import UnitBeam
from beammodes.numerics.long_decimals import LONG
from beammodes.problem.ends import BOUNDARIES, Boundary
from beammodes.problem.loading import Load

STEEL = {"density": 7800.0, "elastic_modulus": 2.1e11, "poisson_ratio": 0.3}
STOUT = bm.Beam.from_section(bm.Rectangle(width=1.0, height=2.0), length=10.0, **STEEL)


def unit(shear: float, gyration: float) -> bm.Beam:
    """L = EI = ρA = 1, s = EI/(κGA L²), r² = ρI/(ρA L²)."""
    return bm.Beam(1.0, 1.0, 1.0, gyration, shear_stiffness=1.0 / shear)


# --- Elements ---------------------------------------------------------------------------------------------


def elements(beam: bm.Beam, boundary: str, count: int, n: int = 200) -> np.ndarray:
    """ω by two-node elements, exact in statics, with consistent mass (Przemieniecki, Theory of Matrix
    Structural Analysis, 1968), springs and bodies added at the ends."""
    le = beam.length / n
    stiffness, shear = beam.bending_stiffness, beam.shear_stiffness
    p = 12 * stiffness / (shear * le**2)  # type: ignore[operator]
    block = np.array(
        [
            [12, 6 * le, -12, 6 * le],
            [6 * le, (4 + p) * le**2, -6 * le, (2 - p) * le**2],
            [-12, -6 * le, 12, -6 * le],
            [6 * le, (2 - p) * le**2, -6 * le, (4 + p) * le**2],
        ]
    )
    block = stiffness / ((1 + p) * le**3) * block  # type: ignore[operator]
    mass = np.zeros((4, 4))
    for x, w in zip(*np.polynomial.legendre.leggauss(5), strict=True):
        x, w = (x + 1) / 2, w / 2
        lift = np.array(
            [
                1 + p - p * x - 3 * x**2 + 2 * x**3,
                le * ((1 + p / 2) * x - (2 + p / 2) * x**2 + x**3),
                p * x + 3 * x**2 - 2 * x**3,
                le * (-p / 2 * x + (p / 2 - 1) * x**2 + x**3),
            ]
        ) / (1 + p)
        turn = np.array(
            [
                6 / le * (x * x - x),
                1 + p - (4 + p) * x + 3 * x**2,
                6 / le * (x - x * x),
                (p - 2) * x + 3 * x**2,
            ]
        ) / (1 + p)
        mass += w * le * beam.mass_per_length * np.outer(lift, lift)  # type: ignore[operator]
        mass += w * le * beam.rotary_inertia_per_length * np.outer(turn, turn)  # type: ignore[operator]
    size = 2 * n + 2
    whole_k, whole_m, kept = np.zeros((size, size)), np.zeros((size, size)), np.ones(size, dtype=bool)
    for e in range(n):
        part = slice(2 * e, 2 * e + 4)
        whole_k[part, part] += block
        whole_m[part, part] += mass
    pair = Boundary.of(boundary)
    for end, i, side in ((pair.left, 0, -1), (pair.right, size - 2, 1)):
        for j, spring in ((i, end.translational_stiffness), (i + 1, end.rotational_stiffness)):
            kept[j] = spring != math.inf
            whole_k[j, j] += spring if kept[j] else 0.0
        body = np.array([1.0, side * float(end.offset)])
        whole_m[i : i + 2, i : i + 2] += float(end.mass) * np.outer(body, body)
        whole_m[i + 1, i + 1] += float(end.rotary_inertia)
    keep = np.flatnonzero(kept)
    top = count + pair.rigid_body_modes - 1
    square = scipy.linalg.eigh(
        whole_k[np.ix_(keep, keep)],
        whole_m[np.ix_(keep, keep)],
        eigvals_only=True,
        subset_by_index=[0, top],
    )
    return np.sqrt(square[pair.rigid_body_modes :])


def extrapolated(beam: bm.Beam, boundary: str, count: int) -> np.ndarray:
    """Of 100 and 200 elements, whose errors fall as 1/n²."""
    coarse, fine = (elements(beam, boundary, count, n) for n in (100, 200))
    return fine + (fine - coarse) / 3


def test_the_stout_cantilever() -> None:
    # Source: 200 elements as above; 10 m by 2 m by 1 m of steel, κ = 5/6, ν = 0.3.
    found = bm.timoshenko(STOUT, "clamped-free", modes=3)
    assert found.angular_frequency == pytest.approx(extrapolated(found.beam, "clamped-free", 3), rel=1e-7)
    assert found.frequency == pytest.approx([16.25731, 87.5555, 208.402], rel=1e-4)
    answer = bm.euler_bernoulli(STOUT, "clamped-free", 3)
    assert answer.frequency == pytest.approx([16.764, 105.06, 294.16], rel=1e-4)
    assert answer.theory_error == pytest.approx(found.frequency / answer.frequency - 1, rel=1e-12)
    assert answer.theory_error == pytest.approx([-0.0302, -0.1666, -0.2915], abs=1e-4)
    assert bm.theory_errors(STOUT, "clamped-free") == pytest.approx(answer.theory_error, rel=1e-12)
    assert answer.theory_assumed == ()


ENDS = [
    *(pair.name for pair in BOUNDARIES),
    "clamped-free(mass=0.3, rotary_inertia=0.02, offset=0.1)",
    "free(mass=0.5, offset=-0.2)-free(mass=0.1)",
    "free(translational_stiffness=30, rotational_stiffness=2)-free(translational_stiffness=5)",
    "pinned(rotational_stiffness=4)-guided(translational_stiffness=7, mass=2)",
    "pinned(mass=0.5, offset=0.2)-clamped",
]


@pytest.mark.parametrize("boundary", ENDS)
def test_every_end_against_elements(boundary: str) -> None:
    # Fourteen modes, of which those beyond ω = 1/√(s r²) = 91 are of both branches: none missed, none twice.
    beam = unit(0.03, 0.004)
    found = timoshenko(beam, boundary, 14).angular_frequency
    assert found[-1] > 1.1 * timoshenko(beam, boundary, 1).cutoff_angular_frequency
    assert found == pytest.approx(extrapolated(beam, boundary, 14), rel=3e-4)


# --- A determinant in 50 digits ---------------------------------------------------------------------------


def determinant(shear: Any, gyration: Any, pair: Boundary, omega: Any) -> Any:
    """Of the far end's conditions on what leaves the near end, by the series in x of y, θ, M, V's system."""
    w = omega**2
    (a, b), (c, d) = (
        [sum(map(Decimal.__mul__, map(Decimal, row), far)) for row in _conditions(pair.right, w)]
        for far in (_across(shear, gyration, w, near) for near in _leaving(pair.left, w))
    )
    return a * d - b * c


def _across(shear: Any, gyration: Any, w: Any, near: list[Any]) -> list[Any]:
    """y, θ, M, V at x = 1:  y' = θ + s V,  θ' = M,  M' = -r² w θ - V,  V' = -w y."""
    term = total = [Decimal(value) for value in near]
    for n in range(1, 400):
        y, theta, moment, force = (value / n for value in term)
        term = [theta + shear * force, moment, -gyration * w * theta - force, -w * y]
        total = [a + b for a, b in zip(total, term, strict=True)]
    assert max(map(abs, term)) < Decimal("1e-70") * max(map(abs, total))
    return total


def _impedance(end: bm.End, w: Any) -> tuple[Any, Any, Any]:
    mass, inertia, offset = (Decimal(float(n)) for n in end.moving_body)
    kt = 0 if end.holds_deflection else Decimal(float(end.translational_stiffness))
    kr = 0 if end.holds_rotation else Decimal(float(end.rotational_stiffness))
    return kt - w * mass, w * mass * offset, kr - w * (inertia + mass * offset**2)


def _leaving(end: bm.End, w: Any) -> Any:
    """Columns y, θ, M, V at x = 0 that the left end allows: its impedance gives V and M."""
    yy, yt, tt = _impedance(end, w)
    free_y = [1, 0, yt, yy] if not end.holds_deflection else [0, 0, 0, 1]
    free_t = [0, 1, tt, yt] if not end.holds_rotation else [0, 0, 1, 0]
    return [free_y, free_t]


def _conditions(end: bm.End, w: Any) -> Any:
    """Rows on y, θ, M, V at x = 1, where rotations inward are -θ and forces change their sign."""
    yy, yt, tt = _impedance(end, w)
    first = [1, 0, 0, 0] if end.holds_deflection else [yy, -yt, 0, 1]
    second = [0, 1, 0, 0] if end.holds_rotation else [-yt, tt, 1, 0]
    return [first, second]


CASES = [(0.03, 0.004), (1e-9, 1e-10), (1e-4, 2e-5), (2.0, 0.5), (0.5, 1e-6), (1e-7, 0.02)]


@pytest.mark.parametrize(("boundary", "case"), in_turns(ENDS, CASES, every=2))
def test_roots_in_fifty_digits(boundary: str, case: tuple[float, float]) -> None:
    """Each frequency is right to 4e-16: the determinant changes its sign within that of it."""
    shear, gyration = case
    pair = Boundary.of(boundary)
    beam = unit(shear, gyration)
    assert isinstance(beam.shear_stiffness, float)
    with localcontext(prec=90):
        s = 1 / Decimal(beam.shear_stiffness)
        for omega in timoshenko(beam, boundary, 3).angular_frequency:
            near = [
                determinant(s, Decimal(gyration), pair, Decimal(float(omega)) * (1 + side * Decimal("4e-16")))
                for side in (-1, 1)
            ]
            assert near[0] * near[1] < 0


# --- Closed forms -----------------------------------------------------------------------------------------


def branches(shear: float, gyration: float, first: int) -> np.ndarray:
    """Roots √w of  s r² w² - (1 + (s + r²) k²) w + k⁴ = 0,  k = n π, on the first branch from n = `first`."""
    squares = []
    for n in range(60):
        k = n * math.pi
        b = 1 + (shear + gyration) * k * k
        root = math.sqrt(b * b - 4 * shear * gyration * k**4)
        squares.append((b + root) / (2 * shear * gyration))
        if n >= first:
            squares.append(2 * k**4 / (b + root))
    return np.sqrt(np.sort(squares))


@pytest.mark.parametrize(("shear", "gyration"), CASES)
def test_pinned_beams_have_both_branches(shear: float, gyration: float) -> None:
    found = timoshenko(unit(shear, gyration), "pinned-pinned", 30).angular_frequency
    assert found == pytest.approx(branches(1 / (1 / shear), gyration, 1)[:30], rel=1e-9)


@pytest.mark.parametrize(("shear", "gyration"), CASES)
def test_guided_beams_lack_the_mode_of_shear_alone(shear: float, gyration: float) -> None:
    # y = cos kx, θ = sin kx: n = 0 is the rigid translation, on the first branch, and nothing on the second.
    cutoff = 1 / math.sqrt(shear * gyration)
    expected = branches(shear, gyration, 1)
    expected = np.delete(expected, np.argmin(np.abs(expected - cutoff)))[:20]
    found = timoshenko(unit(shear, gyration), "guided-guided", 20).angular_frequency
    assert found == pytest.approx(expected, rel=1e-9)


def test_a_double_root_is_found_twice_and_its_shapes_are_orthogonal() -> None:
    # First branch, n = 2, and the mode of shear alone, w = 1/(s r²), meet where k² = 1/s + 1/r².
    gyration = 0.05
    shear = 1 / (4 * math.pi**2 - 1 / gyration)
    modes = timoshenko(unit(shear, gyration), "pinned-pinned", 6)
    omega = modes.angular_frequency
    twin = int(np.argmin(np.diff(omega)))
    assert omega[twin + 1] == pytest.approx(omega[twin], rel=1e-12)
    assert gram(modes) == pytest.approx(np.eye(6), abs=1e-7)


def gram(modes: Any) -> np.ndarray:
    """Modal masses by Gauss's rule."""
    beam, pair = modes.beam, modes.boundary
    node, weight = np.polynomial.legendre.leggauss(80)
    x, weight = beam.length * (node + 1) / 2, beam.length * weight / 2
    y, theta = modes.shape(x), modes.rotation(x)
    total = (y * weight * beam.mass_per_length) @ y.T + (
        theta * weight * beam.rotary_inertia_per_length
    ) @ theta.T
    for end, at, side in ((pair.left, 0.0, -1), (pair.right, beam.length, 1)):
        mass, inertia, offset = (float(n) for n in end.moving_body)
        centre, turn = modes.shape(at) + side * offset * modes.rotation(at), modes.rotation(at)
        total += mass * np.outer(centre, centre) + inertia * np.outer(turn, turn)
    return np.asarray(total)


@pytest.mark.parametrize("boundary", in_turns(ENDS, every=2))
def test_shapes_are_orthonormal_and_satisfy_both_equations(boundary: str) -> None:
    beam = bm.Beam(2.0, 3.0, 0.7, 0.02, shear_stiffness=60.0)
    modes = timoshenko(beam, boundary, 8)
    assert gram(modes) == pytest.approx(np.eye(8), abs=1e-11)
    # κGA (φ' - ψ)' = -ω² ρA φ and EI ψ'' + κGA (φ' - ψ) = -ω² ρI ψ, by differences along the beam.
    x, h = np.linspace(0.2, 1.8, 9), 1e-5
    omega = modes.angular_frequency[:, None] ** 2
    force = (modes.slope(x + h) - modes.rotation(x + h) - modes.slope(x - h) + modes.rotation(x - h)) / (
        2 * h
    )
    assert 60.0 * force == pytest.approx(-omega * 0.7 * modes.shape(x), rel=1e-5, abs=1e-4 * omega.max())
    moment = 3.0 * (modes.rotation(x + h, 1) - modes.rotation(x - h, 1)) / (2 * h)
    moment += 60.0 * (modes.slope(x) - modes.rotation(x))
    assert moment == pytest.approx(-omega * 0.02 * modes.rotation(x), rel=1e-5, abs=1e-4 * omega.max())


def test_shapes_of_slender_beams_are_those_of_euler_and_bernoulli() -> None:
    x = np.linspace(0.0, 1.0, 7)
    for boundary in ENDS:
        stout, slender = (
            timoshenko(unit(1e-12, 1e-12), boundary, 4),
            bm.euler_bernoulli(bm.Beam.unit(), boundary, 4),
        )
        assert stout.shape(x) == pytest.approx(slender.shape(x), abs=1e-7)
        assert stout.slope(x) == pytest.approx(slender.slope(x), abs=1e-6)


# --- Limits -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("boundary", ENDS)
def test_without_shear_it_is_rayleighs_beam(boundary: str) -> None:
    rayleigh = bm.euler_bernoulli(bm.Beam(1.0, 1.0, 1.0, 0.003), boundary, 6).angular_frequency
    found = timoshenko(bm.Beam.unit(), boundary, 6, shear_stiffness=math.inf, rotary_inertia_per_length=0.003)
    assert found.angular_frequency == pytest.approx(rayleigh, rel=1e-14)
    plain = timoshenko(bm.Beam.unit(), boundary, 6, shear_stiffness=math.inf, rotary_inertia_per_length=0.0)
    euler = bm.euler_bernoulli(bm.Beam.unit(), boundary, 6).angular_frequency
    assert plain.angular_frequency == pytest.approx(euler, rel=1e-14)
    assert plain.cutoff_angular_frequency == math.inf


def test_shear_alone() -> None:
    # w = k⁴/(1 + s k²) between pinned ends; no second branch, there being no inertia against rotation.
    k = np.arange(1, 21) * math.pi
    found = timoshenko(
        bm.Beam.unit(), "pinned-pinned", 20, shear_stiffness=50.0, rotary_inertia_per_length=0.0
    )
    assert found.angular_frequency == pytest.approx(k**2 / np.sqrt(1 + 0.02 * k**2), rel=1e-14)


@pytest.mark.parametrize(
    ("boundary", "case"), in_turns(ENDS, [(0.0, 0.004), (0.03, 0.0), (0.03, 0.004)], every=3)
)
def test_polynomials_agree_with_the_characteristic_equation(boundary: str, case: tuple[float, float]) -> None:
    shear, gyration = case
    stiffness = 1 / shear if shear else math.inf
    exact = timoshenko(
        bm.Beam.unit(), boundary, 8, shear_stiffness=stiffness, rotary_inertia_per_length=gyration
    )
    # A taper of next to nothing takes the other route.
    bent = bm.Beam(1.0, lambda x: 1.0 + 0.0 * x, 1.0)
    found = timoshenko(bent, boundary, 8, shear_stiffness=stiffness, rotary_inertia_per_length=gyration)
    assert found.angular_frequency == pytest.approx(exact.angular_frequency, rel=1e-11)
    x = np.linspace(0.0, 1.0, 5)
    scale = np.abs(exact.rotation(x)).max()
    assert found.shape(x) == pytest.approx(exact.shape(x), abs=1e-8)
    assert found.rotation(x) == pytest.approx(exact.rotation(x), abs=1e-8 * scale)
    assert found.rotation(x, 1) == pytest.approx(exact.rotation(x, 1), abs=1e-7 * scale**2)


def test_a_beam_of_two_parts_against_elements() -> None:
    steps = bm.Beam(1.0, [2.0, 1.0], [1.5, 1.0], [0.01, 0.004], shear_stiffness=[50.0, 30.0])
    found = timoshenko(steps, "clamped-free", 4).angular_frequency
    finer = [stepped_elements(n) for n in (100, 200)]
    assert found == pytest.approx(finer[1] + (finer[1] - finer[0]) / 3, rel=1e-6)


def stepped_elements(n: int) -> np.ndarray:
    """ω of that beam by linear elements of y and θ with one point of integration, of order 2."""
    size, le = 2 * n + 2, 1.0 / n
    stiff, mass = np.zeros((size, size)), np.zeros((size, size))
    for e in range(n):
        bending, per, rotary, shear = (2.0, 1.5, 0.01, 50.0) if e < n // 2 else (1.0, 1.0, 0.004, 30.0)
        part = slice(2 * e, 2 * e + 4)
        turn, strain = np.array([0, -1, 0, 1]) / le, np.array([-1 / le, -0.5, 1 / le, -0.5])
        stiff[part, part] += le * (bending * np.outer(turn, turn) + shear * np.outer(strain, strain))
        pattern = le / 6 * np.kron(np.array([[2, 1], [1, 2]]), np.diag([per, rotary]))
        mass[part, part] += pattern
    square = scipy.linalg.eigh(stiff[2:, 2:], mass[2:, 2:], eigvals_only=True, subset_by_index=[0, 3])
    return np.sqrt(square)


def test_axial_force_works_on_the_slope() -> None:
    # Pinned: (k² EI' + T) with 1/(1/k⁴ + s/k²) = stiffness of bending and shear in series; ρI = 0.
    shear, force, k = 0.02, 3.0, np.arange(1, 5) * math.pi
    found = timoshenko(
        bm.Beam.unit(),
        "pinned-pinned",
        4,
        load=Load(axial_force=force),
        shear_stiffness=1 / shear,
        rotary_inertia_per_length=0.0,
    )
    expected = np.sqrt(1 / (1 / k**4 + shear / k**2) + force * k**2)
    assert found.angular_frequency == pytest.approx(expected, rel=1e-11)


# --- Tables -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("boundary", "height", "table"),
    [
        ("pinned-pinned", 0.01, [3.14133, 6.28106, 9.41761]),
        ("pinned-pinned", 0.1, [3.11568, 6.09066, 8.84052]),
        ("pinned-pinned", 0.2, [3.04533, 5.67155, 7.83952]),
        ("clamped-clamped", 0.1, [4.57955, 7.33122, 9.85611]),
        ("clamped-clamped", 0.2, [4.24201, 6.41794, 8.28532]),
    ],
)
def test_published_frequencies(boundary: str, height: float, table: list[float]) -> None:
    # J. Lee and W. W. Schultz, Journal of Sound and Vibration 269 (2004), 609-621: √ω for κ = 5/6, ν = 0.3.
    beam = bm.Beam.from_section(bm.Rectangle(1.0, height), length=1.0, **STEEL)
    found = np.sqrt(timoshenko(beam, boundary, 3).angular_frequency / beam.frequency_unit)
    assert found == pytest.approx(table, abs=6e-6)


# --- What a beam knows of its section ----------------------------------------------------------------------


def thin_walled(width: float, height: float, flange: float, web: float, webs: int) -> float:
    """I²/(A ∫ (S/t)² dA): κ by the work of shear flow, which is Cowper's at ν = 0."""
    second = width * flange * height**2 / 2 + webs * web * height**3 / 12
    area = 2 * width * flange + webs * web * height
    node, weight = np.polynomial.legendre.leggauss(8)
    s, y = width / 4 * (node + 1), height / 2 * node
    plates = 4 * float(weight @ (height / 2 * s) ** 2) * flange * width / 4
    static = width * flange * height / 2 / webs + web * (height**2 / 4 - y**2) / 2
    return second**2 / (area * (plates + webs * float(weight @ (static / web) ** 2) * web * height / 2))


def test_shear_coefficients_of_thin_walls_by_the_work_of_shear_flow() -> None:
    width, height, t = 0.1, 0.2, 1e-3
    box, i = bm.Box(width + t, height + t, t), bm.ISection(width, height + t, t, 0.7 * t)
    assert box.shear_coefficient(0.0) == pytest.approx(thin_walled(width, height, t, t, 2), rel=1e-12)
    assert i.shear_coefficient(0.0) == pytest.approx(thin_walled(width, height, t, 0.7 * t, 1), rel=1e-12)
    # τ = V sin φ/(π R t) around a thin ring: κ = 1/2; and a bar is a tube without a hole.
    assert bm.Tube(1.0, wall=1e-6).shear_coefficient(0.0) == pytest.approx(0.5, rel=1e-5)
    assert bm.Tube(1.0, inner=1e-6).shear_coefficient(0.3) == pytest.approx(
        bm.Circle(1.0).shear_coefficient(0.3), rel=1e-9
    )
    # Cowper's paper, table of values at ν = 0.3: circle 0.886, thin-walled round tube 0.531.
    assert bm.Circle(1.0).shear_coefficient(0.3) == pytest.approx(0.886, abs=5e-4)
    assert bm.Tube(1.0, wall=1e-6).shear_coefficient(0.3) == pytest.approx(0.531, abs=5e-4)
    for section in (bm.Rectangle(1.0, 2.0), bm.Circle(1.0), box, i):
        for bad, kind in ((0.6, ValueError), (-1.0, ValueError), ("0.3", TypeError)):
            with pytest.raises(kind, match=r"^poisson_ratio must be"):
                section.shear_coefficient(bad)  # type: ignore[arg-type]


def test_what_is_assumed_of_a_section_is_said() -> None:
    given = {"density": 7800.0, "elastic_modulus": 2.1e11, "length": 10.0}
    flat = bm.Rectangle(1.0, 2.0)
    hole = bm.GivenSection(2.0, 8 / 12, 2 / 12, flat.torsion_constant)
    told = bm.Beam.from_section(flat, **given, poisson_ratio=0.3)
    part = bm.Beam.from_section(flat, **given)
    none = bm.Beam.from_section(hole, **given)
    own = bm.Beam.from_section(hole, **given, poisson_ratio=0.3, shear_coefficient=5 / 6)
    assert told.assumed == own.assumed == ()
    assert part.assumed == ("Poisson's ratio 0.3",)
    assert none.assumed == ("Poisson's ratio 0.3", "shear coefficient 5/6")
    assert told == part == none == own
    answer = bm.euler_bernoulli(none, "clamped-free", 2)
    assert "assumed: Poisson's ratio 0.3, shear coefficient 5/6" in answer.theory_words
    heavy = bm.euler_bernoulli(bm.Beam(10.0, 1.4e11, 15600.0, 5200.0), "clamped-free", 2)
    assert heavy.theory_assumed == ("E/(kappa G) = 3.12 as of a rectangle",)
    assert heavy.theory_error == pytest.approx(
        timoshenko(STOUT, "clamped-free", 2).angular_frequency / heavy.angular_frequency - 1, rel=1e-12
    )
    unknown = bm.euler_bernoulli(bm.Beam.unit(), "clamped-free", 2)
    assert np.isnan(unknown.theory_error).all()
    assert "theory error not known without a section" in repr(unknown)


@pytest.mark.parametrize("pair", BOUNDARIES)
def test_the_rule_of_thumb_for_unknown_sections_is_safe(pair: Boundary) -> None:
    """A solid rectangle no higher than L/(6 √(ω/unit)) keeps the theory within 1 %, and not ten times so."""
    for mode in (1, 2, 5, 12):
        plain = bm.euler_bernoulli(bm.Beam.unit(), pair, mode)
        height = 1 / (6 * math.sqrt(plain.angular_frequency[-1]))
        beam = bm.Beam.from_section(bm.Rectangle(1.0, height), length=1.0, **STEEL)
        worst = np.abs(bm.theory_errors(beam, pair, mode)).max()
        assert 0.001 < worst < 0.01
        assert f"no higher than L/{float(f'{1 / height:.2g}'):g}" in plain.theory_words


@pytest.mark.parametrize(
    "beam",
    [
        STOUT,
        bm.Beam.from_section(bm.Circle(0.3), length=2.0, **STEEL, rotary_inertia=True),
        bm.Beam(1.0, lambda x: (1 - x / 2) ** 3, lambda x: 1 - x / 2, lambda x: (1 - x / 2) ** 3 / 100),
        bm.Beam(1.0, [2.0, 1.0], 1.0, radius_of_gyration=0.05),
    ],
)
@pytest.mark.parametrize(
    "boundary", ["clamped-free", "pinned-guided", "clamped(mass=2)-free(mass=0.4, offset=0.1)"]
)
def test_every_kind_of_answer_tells_its_theorys_error(beam: bm.Beam, boundary: str) -> None:
    answer = bm.euler_bernoulli(beam, boundary, 3)
    assert (answer.theory_error < 0).all()
    assert answer.theory_error == pytest.approx(bm.theory_errors(beam, boundary, 3), rel=1e-12)
    assert f"theory error {100 * answer.theory_error[0]:+.3g}" in repr(answer)
    # Under a small load it is the same but for little; on a turning hub nothing tells.
    loaded = bm.euler_bernoulli(beam, boundary, 3, load=Load(axial_force=1e-3 * beam.mean_bending_stiffness))
    assert loaded.theory_error == pytest.approx(answer.theory_error, rel=0.05)
    if not beam.has_rotary_inertia and "clamped" in boundary:
        spun = bm.euler_bernoulli(beam, boundary, 3, load=Load(spin_rate=0.01))
        assert np.isnan(spun.theory_error).all()


def test_beyond_the_cutoff_no_theory_error_is_told() -> None:
    errors = bm.theory_errors(STOUT, "clamped-free", 9)
    found = timoshenko(STOUT, "clamped-free", 9)
    assert np.array_equal(np.isnan(errors), found.angular_frequency >= found.cutoff_angular_frequency)
    assert 0 < np.isnan(errors).sum() < 9


def test_answers_can_be_pickled() -> None:
    answer = bm.euler_bernoulli(STOUT, "clamped-free", 2)
    assert pickle.loads(pickle.dumps(answer)).theory_error == pytest.approx(answer.theory_error, rel=1e-15)
    stout = timoshenko(STOUT, "clamped-free", 2)
    assert pickle.loads(pickle.dumps(stout)).shape(10.0) == pytest.approx(stout.shape(10.0), rel=1e-15)
    assert repr(stout) == "TimoshenkoModes(clamped-free: 16.26, 87.56 Hz)"


def test_counts_are_right_between_all_roots() -> None:
    with localcontext(LONG):
        beam = UnitBeam.of(bm.Beam.unit(), Boundary.of("clamped-free"), 0.0, 0.01, 20.0)
        roots = beam.lowest(0, 25) or []
        middles = [(a * b).sqrt() for a, b in pairwise(roots)]
        assert [beam.sample(w).below for w in middles] == list(range(1, 25))


@pytest.mark.parametrize(
    ("call", "kind", "message"),
    [
        (lambda: timoshenko(1.0, "clamped-free", 3), TypeError, "^beam must be a Beam"),  # type: ignore[arg-type]
        (lambda: timoshenko(bm.Beam.unit(), "clamped-free", 3), ValueError, "^shear_stiffness must be given"),
        (
            lambda: timoshenko(bm.Beam.unit(), "clamped-free", 3, shear_stiffness=9.0),
            ValueError,
            "^rotary_inertia_per_length must be given",
        ),
        (lambda: timoshenko(STOUT, "clamped-free", 101), ValueError, r"^modes must be .* at most 100"),
        (lambda: timoshenko(STOUT, "clamped-fre", 3), ValueError, "^boundary must name"),
        (lambda: timoshenko(STOUT, "clamped-free", 3, shear_stiffness=-1.0), ValueError, "^shear_stiffness"),
        (
            lambda: timoshenko(STOUT, "clamped-free", 3, rotary_inertia_per_length=-1.0),
            ValueError,
            "^rotary_inertia_per_length must not be negative",
        ),
        (lambda: timoshenko(STOUT, "clamped-free", 3, load=2.0), TypeError, "^load"),  # type: ignore[arg-type]
        (
            lambda: timoshenko(STOUT, "clamped-free", 3).shape(11.0),
            ValueError,
            "^x must be finite and inside",
        ),
        (lambda: timoshenko(STOUT, "clamped-free", 3).shape(1.0, 2), ValueError, "^derivative"),
        (
            lambda: bm.Beam(1, 1, 1, shear_stiffness=0.0),
            ValueError,
            "^shear_stiffness must be greater than 0",
        ),
        (lambda: bm.Beam(1, 1, 1, radius_of_gyration="1"), TypeError, "^radius_of_gyration"),  # type: ignore[arg-type]
        (lambda: bm.theory_errors(bm.Beam.unit(), "clamped-free", 101), ValueError, "^modes"),
    ],
)
def test_bad_arguments(call: Any, kind: type[Exception], message: str) -> None:
    with pytest.raises(kind, match=message):
        call()


def test_what_no_section_tells_is_none() -> None:
    assert theory_error_of(bm.Beam.unit(), Boundary.of("clamped-free"), Load(), np.ones(1)) is None
