"""Euler-Bernoulli roots and mode shapes against equations solved at 50 digits, and against the physics."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.exact.exact_beam import BeamModes, wavenumber, wavenumber_of_code
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BOUNDARIES, ENDS, Boundary

BEAM = Beam(length=1.7, bending_stiffness=83.0, mass_per_length=0.45)
PAIRS = [pair.name for pair in BOUNDARIES]
BOTH_ORDERS = [f"{a}-{b}" for a in ENDS for b in ENDS]

# Characteristic equations as Rayleigh (Theory of Sound, vol. 1, ch. VIII) and Blevins (1979, table 8-1)
# print them, divided by cosh so that mpmath can bracket a root of any size by its sign.
EQUATIONS: dict[str, Callable[[Any], Any]] = {
    "clamped-clamped": lambda z: mp.cos(z) - mp.sech(z),
    "free-free": lambda z: mp.cos(z) - mp.sech(z),
    "clamped-free": lambda z: mp.cos(z) + mp.sech(z),
    "clamped-pinned": lambda z: mp.sin(z) - mp.cos(z) * mp.tanh(z),
    "pinned-free": lambda z: mp.sin(z) - mp.cos(z) * mp.tanh(z),
    "clamped-guided": lambda z: mp.sin(z) + mp.cos(z) * mp.tanh(z),
    "guided-free": lambda z: mp.sin(z) + mp.cos(z) * mp.tanh(z),
    "pinned-pinned": mp.sin,
    "guided-guided": mp.sin,
    "pinned-guided": mp.cos,
}

# Roots of the equations above, solved to 25 digits.  Source: recomputed from those equations.
PUBLISHED = {
    "clamped-free": [
        "1.875104068711961166445308",
        "4.694091132974174576436392",
        "7.854757438237612564861009",
    ],
    "clamped-clamped": ["4.730040744862704026024048", "7.853204624095837556477067"],
    "free-free": ["4.730040744862704026024048", "7.853204624095837556477067"],
    "clamped-pinned": ["3.926602312047918778238533", "7.068582745628732088552959"],
    "pinned-free": ["3.926602312047918778238533", "7.068582745628732088552959"],
    "clamped-guided": ["2.365020372431352013012024", "5.497803919000835453334516"],
    "guided-free": ["2.365020372431352013012024", "5.497803919000835453334516"],
    "pinned-pinned": ["3.141592653589793238462643"],
    "guided-guided": ["3.141592653589793238462643"],
    "pinned-guided": ["1.570796326794896619231322", "4.712388980384689857693965"],
}

# Which derivatives vanish at an end: the definition of its name.
VANISHING = {"clamped": (0, 1), "pinned": (0, 2), "guided": (1, 3), "free": (2, 3)}


def bisected(equation: Callable[[Any], Any], low: Any, high: Any) -> Any:
    """Return the one root of `equation` between `low` and `high` at the working precision."""
    assert equation(low) * equation(high) < 0
    return mp.findroot(equation, (low, high), solver="anderson", tol=mp.mpf(10) ** (-80))


def reference_roots(pair: str, count: int) -> list[Any]:
    """Return the first roots above zero, found by scanning for signs: no asymptote is assumed."""
    with mp.workdps(50):
        grid = [mp.mpf("0.55") + mp.mpf("0.3") * i for i in range(12 * (count + 1))]
        signs = [mp.sign(EQUATIONS[pair](z)) for z in grid]
        changes = [i for i in range(len(grid) - 1) if signs[i] != signs[i + 1]]
        return [bisected(EQUATIONS[pair], grid[i], grid[i + 1]) for i in changes[:count]]


def ulps(value: float, exact: Any) -> float:
    with mp.workdps(60):
        return float(abs(mp.mpf(value) - exact) / mp.mpf(float(np.spacing(value))))


def solved(boundary: str, modes: int, beam: Beam = BEAM) -> BeamModes:
    return euler_bernoulli(beam, boundary, modes)


def gauss_legendre(length: float, panels: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    node, weight = np.polynomial.legendre.leggauss(16)
    half = length / panels / 2.0
    centre = half * (2.0 * np.arange(panels) + 1.0)
    return (centre[:, None] + half * node).ravel(), np.tile(half * weight, panels)


# --- Roots -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("pair", PAIRS)
def test_first_ten_roots_are_the_first_ten_of_the_equation(pair: str) -> None:
    for mode, exact in enumerate(reference_roots(pair, 10), start=1):
        assert ulps(wavenumber(pair, mode), exact) < 0.6, mode


@pytest.mark.parametrize("mode", [23, 24, 25, 100, 10_000, 10**7, 10**12])
@pytest.mark.parametrize("pair", PAIRS)
def test_high_roots_solve_the_equation(pair: str, mode: int) -> None:
    root = wavenumber(pair, mode)
    with mp.workdps(80):
        exact = bisected(EQUATIONS[pair], mp.mpf(root) - mp.mpf("0.2"), mp.mpf(root) + mp.mpf("0.2"))
        # The tenth root is identified by counting; the roots are π apart from there on.
        index = 10 + (exact - mp.mpf(wavenumber(pair, 10))) / mp.pi
        assert abs(index - mode) < 1e-9
    assert ulps(root, exact) < 0.6


@pytest.mark.parametrize(("pair", "digits"), PUBLISHED.items())
def test_published_digits(pair: str, digits: list[str]) -> None:
    with mp.workdps(30):
        assert all(ulps(wavenumber(pair, n), mp.mpf(text)) < 0.6 for n, text in enumerate(digits, start=1))


@given(st.sampled_from(PAIRS), st.integers(1, 10**12))
@settings(max_examples=100, deadline=None)
def test_any_mode_satisfies_its_equation(pair: str, mode: int) -> None:
    root = wavenumber(pair, mode)
    with mp.workdps(60):
        ulp = mp.mpf(float(np.spacing(root)))
        assert EQUATIONS[pair](root - ulp) * EQUATIONS[pair](root + ulp) < 0


def test_nothing_overflows_at_any_mode() -> None:
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        roots = wavenumber_of_code(np.arange(10)[:, None], 10 ** np.arange(13))
        shapes = solved("free-clamped", 10_000, Beam.unit()).shape([0.0, 0.3, 1.0])
    assert np.all(np.diff(roots, axis=1) > 0)
    assert np.abs(shapes).max() <= 2.0 + 1e-9


# --- Broadcasting and types ------------------------------------------------------------------------------


def test_scalars_give_a_float() -> None:
    for mode in (2, np.int64(2), np.array(2), np.uint8(2)):
        assert type(wavenumber("clamped-free", mode)) is float
    assert type(wavenumber_of_code(np.int8(3), 2)) is float
    assert type(wavenumber(Boundary.of("free/cantilever"), 2)) is float


def test_arrays_broadcast_and_agree_with_scalars() -> None:
    names = np.array(BOTH_ORDERS)[:, None]
    modes = np.array([1, 2, 24, 25, 1000], dtype=np.uint16)
    table = wavenumber(names, modes)
    assert isinstance(table, np.ndarray)
    assert table.shape == (16, 5)
    assert table.dtype == np.float64
    assert table.tolist() == [[wavenumber(name, int(n)) for n in modes] for name in BOTH_ORDERS]
    assert np.array_equal(wavenumber(PAIRS, 3), wavenumber_of_code(np.arange(10), 3))
    assert np.shape(wavenumber("clamped-free", np.ones((2, 3), dtype=np.int8))) == (2, 3)
    assert np.shape(wavenumber(PAIRS, np.ones((4, 1), dtype=int))) == (4, 10)
    assert np.shape(wavenumber("clamped-free", np.array([], dtype=int))) == (0,)


def test_mismatched_shapes_are_named() -> None:
    with pytest.raises(ValueError, match=r"boundary and mode must broadcast.*\(3,\).*\(2,\)"):
        wavenumber(["free-free"] * 3, [1, 2])


# --- Mode shapes -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("modes", [12, 10_000])
@pytest.mark.parametrize("boundary", BOTH_ORDERS)
def test_end_conditions(boundary: str, modes: int) -> None:
    result = solved(boundary, modes)
    mass = BEAM.mass_per_length * BEAM.length
    for name, x in zip(boundary.split("-"), (0.0, BEAM.length), strict=True):
        for order in range(4):
            scale = (result.wavenumber / BEAM.length) ** order / np.sqrt(mass)
            value = np.abs(result.shape(x, order)) / scale
            if order in VANISHING[name]:
                assert value.max() < 1e-14
            else:
                assert value.min() > 0.9


def hyperbolic(beta: Any, z: Any, order: int) -> list[Any]:
    """Return the derivatives of cos, sin, cosh and sinh of β z, divided by β to the order."""
    pair = [mp.cosh(beta * z), mp.sinh(beta * z)]
    return [*trigonometric(beta, z, order), *(pair if order % 2 == 0 else pair[::-1])]


def decaying(beta: Any, z: Any, order: int) -> list[Any]:
    """Return the same of cos, sin and the two exponentials that decay from either end: for any β."""
    return [*trigonometric(beta, z, order), (-1) ** order * mp.exp(-beta * z), mp.exp(-beta * (1 - z))]


def trigonometric(beta: Any, z: Any, order: int) -> list[Any]:
    return [mp.cos(beta * z + mp.pi / 2 * order), mp.sin(beta * z + mp.pi / 2 * order)]


def reference_shape(boundary: str, beta: Any, basis: Any, places: list[float]) -> NDArray[np.float64]:
    """Return the null vector's shape and three derivatives, (4, places), its free factor unset."""
    ends = zip(boundary.split("-"), (0, 1), strict=True)
    vector = null_vector([basis(beta, z, order) for name, z in ends for order in VANISHING[name]])
    rows = [[mp.fdot(vector, basis(beta, mp.mpf(z), order)) for z in places] for order in range(4)]
    largest = max(abs(value) for value in rows[0])
    return np.array([[float(value / largest) for value in row] for row in rows])


def worst_difference(
    result: BeamModes, mode: int, expected: NDArray[np.float64], places: list[float]
) -> float:
    """Return how far all four derivatives are from `expected` times one factor."""
    beta = float(result.wavenumber[mode - 1])
    found = np.array([result.shape(places, order)[mode - 1] / beta**order for order in range(4)])
    pivot = int(np.argmax(np.abs(expected[0])))
    return float(np.abs(found - expected * found[0, pivot] / expected[0, pivot]).max())


@pytest.mark.parametrize("boundary", BOTH_ORDERS)
def test_shapes_match_the_determinant_solved_in_fifty_digits(boundary: str) -> None:
    """Source: the null vector of the 4 by 4 end conditions; its factor is tested by quadrature below."""
    result, places = solved(boundary, 6, Beam.unit()), [0.0, 0.17, 0.5, 0.83, 1.0]
    with mp.workdps(50):
        for mode, beta in enumerate(reference_roots(Boundary.of(boundary).canonical.name, 6), start=1):
            expected = reference_shape(boundary, beta, hyperbolic, places)
            assert worst_difference(result, mode, expected, places) < 4e-14


@pytest.mark.parametrize("boundary", BOTH_ORDERS)
def test_shape_of_mode_ten_thousand(boundary: str) -> None:
    result, places = solved(boundary, 10_000, Beam.unit()), [0.0, 1e-4, 0.30003, 0.77001, 0.9999, 1.0]
    equation, root = EQUATIONS[Boundary.of(boundary).canonical.name], mp.mpf(result.wavenumber[-1])
    with mp.workdps(80):
        beta = bisected(equation, root - 1, root + 1)
        expected = reference_shape(boundary, beta, decaying, places)
    assert worst_difference(result, 10_000, expected, places) < 2e-11


def null_vector(rows: list[list[Any]]) -> list[Any]:
    """Return the vector that four rows of rank three annihilate: the largest row of the cofactors."""
    scaled = [[value / max(map(abs, row)) for value in row] for row in rows]
    candidates = [
        [
            (-1) ** j * mp.det(mp.matrix([[row[k] for k in range(4) if k != j] for row in kept]))
            for j in range(4)
        ]
        for kept in ([row for m, row in enumerate(scaled) if m != left_out] for left_out in range(4))
    ]
    return max(candidates, key=lambda vector: max(map(abs, vector)))


@pytest.mark.parametrize("boundary", BOTH_ORDERS)
def test_modal_mass_and_stiffness_by_quadrature(boundary: str) -> None:
    result = solved(boundary, 20)
    x, weight = gauss_legendre(BEAM.length, 40)
    deflection, curvature = result.shape(x), result.shape(x, 2)
    mass = BEAM.mass_per_length * (deflection * weight) @ deflection.T
    stiffness = BEAM.bending_stiffness * (curvature * weight) @ curvature.T
    omega = result.angular_frequency
    assert np.abs(mass - np.eye(20)).max() < 1e-12
    assert np.abs(stiffness / np.outer(omega, omega) - np.eye(20)).max() < 1e-12


@pytest.mark.parametrize("boundary", ["clamped-free", "pinned-clamped", "guided-pinned"])
def test_unit_modal_mass_of_high_modes(boundary: str) -> None:
    x, weight = gauss_legendre(BEAM.length, 300)
    high = solved(boundary, 300).shape(x)[250:]
    mass = BEAM.mass_per_length * (high * weight) @ high.T
    assert np.abs(mass - np.eye(50)).max() < 1e-10


@pytest.mark.parametrize("boundary", BOTH_ORDERS)
def test_amplitude_at_the_ends_is_that_of_unit_modal_mass(boundary: str) -> None:
    """A free end deflects, and a clamped one curves, by exactly 2; Source: Rayleigh, ∫ φ² of a free bar."""
    result = solved(boundary, 10_000)
    for name, x in zip(boundary.split("-"), (0.0, BEAM.length), strict=True):
        order = {"clamped": 2, "free": 0}.get(name)
        if order is not None:
            scale = (result.wavenumber / BEAM.length) ** order / np.sqrt(0.45 * 1.7)
            assert np.abs(np.abs(result.shape(x, order)) / scale - 2.0).max() < 1e-14


@pytest.mark.parametrize(
    ("boundary", "power"),
    [("free-free", 0), ("free-free", 1), ("guided-guided", 0), ("guided-free", 0), ("free-pinned", None)],
)
def test_elastic_modes_carry_no_rigid_motion(boundary: str, power: int | None) -> None:
    x, weight = gauss_legendre(BEAM.length, 40)
    rigid = (BEAM.length - x) if power is None else x**power
    assert np.abs(solved(boundary, 20).shape(x) @ (weight * rigid)).max() < 1e-13


@pytest.mark.parametrize("boundary", BOTH_ORDERS)
def test_derivatives_are_those_of_the_deflection(boundary: str) -> None:
    result = solved(boundary, 6)
    x, step = np.linspace(0.1, 1.6, 9), 1e-4
    for order in range(3):
        difference = (result.shape(x + step, order) - result.shape(x - step, order)) / (2 * step)
        exact = result.shape(x, order + 1)
        assert np.abs(difference - exact).max() < 1e-6 * np.abs(exact).max()
    assert np.array_equal(result.slope(x), result.shape(x, 1))


@pytest.mark.parametrize("boundary", BOTH_ORDERS)
def test_number_of_nodes(boundary: str) -> None:
    """Mode n crosses zero n - 1 times inside, and once more for each rigid-body mode below it."""
    result = solved(boundary, 12)
    # An odd count of points that no symmetric node falls on, and no end.
    inside = BEAM.length * (np.arange(1, 2000) - 0.37) / 2000
    crossings = np.count_nonzero(np.diff(np.sign(result.shape(inside)), axis=1), axis=1)
    assert crossings.tolist() == list(range(result.rigid_body_modes, result.rigid_body_modes + 12))


@pytest.mark.parametrize("boundary", BOTH_ORDERS)
def test_first_motion_at_the_left_end_is_positive(boundary: str) -> None:
    result = solved(boundary, 25)
    order = {"clamped": 2, "pinned": 1, "guided": 0, "free": 0}[boundary.split("-")[0]]
    assert np.all(result.shape(0.0, order) > 0)
    assert np.all(result.shape(1e-3 * BEAM.length) > 0)


@pytest.mark.parametrize("pair", PAIRS)
def test_the_other_order_is_the_mirror_image(pair: str) -> None:
    left, right = pair.split("-")
    forward, backward = solved(pair, 9), solved(f"{right}-{left}", 9)
    assert np.array_equal(forward.wavenumber, backward.wavenumber)
    assert backward.boundary.name == f"{right}-{left}"
    x = np.linspace(0.0, BEAM.length, 41)
    one, other = forward.shape(x), backward.shape(BEAM.length - x)
    sign = np.sign(np.sum(one * other, axis=1, keepdims=True))
    assert np.abs(one - sign * other).max() < 2e-13


def test_shape_has_the_shape_of_x() -> None:
    result = solved("clamped-free", 3)
    assert result.shape(0.5).shape == (3,)
    assert result.shape([0.5]).shape == (3, 1)
    assert result.shape(np.full((2, 4), 0.5)).shape == (3, 2, 4)
    assert result.shape([]).shape == (3, 0)
    assert np.array_equal(result.shape([0, 1]), result.shape([0.0, 1.0]))


def test_frequencies_carry_units() -> None:
    """Source: ω = β² √(EI / (ρA L⁴)), the first cantilever root squared being 3.516015..."""
    result = solved("clamped-free", 1)
    omega = 3.5160152685 * np.sqrt(83.0 / (0.45 * 1.7**4))
    assert result.angular_frequency[0] == pytest.approx(omega, rel=1e-10)
    assert result.frequency[0] == pytest.approx(omega / 6.283185307179586, rel=1e-10)
    assert (result.rigid_body_modes, solved("free-free", 1).rigid_body_modes) == (0, 2)


def test_result_is_frozen() -> None:
    result = solved("clamped-free", 2)
    with pytest.raises(AttributeError):
        result.beam = Beam.unit()  # type: ignore[misc]
    with pytest.raises(ValueError, match="read-only"):
        result.wavenumber[0] = 1.0


# --- Bad input -------------------------------------------------------------------------------------------

NOT_WHOLE = st.one_of(st.floats(), st.text(), st.none(), st.booleans(), st.complex_numbers(), st.binary())
BELOW_ONE = st.integers(max_value=0)
TOO_MANY = st.one_of(st.integers(min_value=10**12 + 1), st.sampled_from([2**63, 2**64, 10**5000]))
QUICK = settings(max_examples=60, deadline=None)


@QUICK
@given(NOT_WHOLE)
def test_what_is_not_a_whole_number_is_a_type_error(bad: Any) -> None:
    for name, call in (
        ("mode", lambda: wavenumber("clamped-free", bad)),
        ("mode", lambda: wavenumber("clamped-free", [bad, bad])),
        ("codes", lambda: wavenumber_of_code(bad, 1)),
        ("modes", lambda: euler_bernoulli(BEAM, "clamped-free", bad)),
        ("derivative", lambda: solved("clamped-free", 1).shape(0.0, bad)),
    ):
        with pytest.raises(TypeError, match=rf"^{name} must"):
            call()


@QUICK
@given(st.one_of(BELOW_ONE, TOO_MANY))
def test_whole_numbers_out_of_range_are_value_errors(bad: int) -> None:
    for name, call in (
        ("mode", lambda: wavenumber("clamped-free", bad)),
        ("mode", lambda: wavenumber("clamped-free", [1, bad])),
        ("codes", lambda: wavenumber_of_code(bad or -1, 1)),
        ("codes", lambda: wavenumber_of_code([bad or -1, 0], 1)),
        ("modes", lambda: euler_bernoulli(BEAM, "clamped-free", bad)),
        ("derivative", lambda: solved("clamped-free", 1).shape(0.0, bad or 4)),
    ):
        with pytest.raises(ValueError, match=rf"^{name} must"):
            call()


def test_limits_of_the_ranges() -> None:
    assert len(solved("clamped-free", 10**6).wavenumber) == 10**6
    with pytest.raises(ValueError, match=r"^modes must"):
        solved("clamped-free", 10**6 + 1)
    with pytest.raises(ValueError, match=r"^codes must"):
        wavenumber_of_code(10, 1)
    with pytest.raises(TypeError, match=r"^mode must"):
        wavenumber("clamped-free", [[1, 2], [3]])


@QUICK
@given(
    st.one_of(
        st.floats(max_value=0.0, exclude_max=True),
        st.floats(min_value=1.7, exclude_min=True),
        st.just(float("nan")),
    )
)
def test_positions_off_the_beam_are_value_errors(bad: float) -> None:
    for x in (bad, [0.5, bad], np.array([[bad], [0.1]])):
        with pytest.raises(ValueError, match=r"^x must be finite and inside \[0, 1\.7\]"):
            solved("clamped-free", 2).shape(x)


@QUICK
@given(st.one_of(st.text(), st.none(), st.booleans(), st.complex_numbers(), st.just([[1], [1, 2]])))
def test_positions_that_are_no_numbers_are_type_errors(bad: Any) -> None:
    for method in (solved("free-free", 2).shape, solved("free-free", 2).slope):
        with pytest.raises(TypeError, match=r"^x must be (an|one regular) array of real numbers"):
            method(bad)


@QUICK
@given(st.one_of(st.text(), st.none(), st.floats(), st.integers(), st.tuples(st.text(), st.text())))
def test_bad_boundaries_are_refused_by_name(bad: Any) -> None:
    for call in (lambda: wavenumber(bad, 1), lambda: euler_bernoulli(BEAM, bad, 1)):
        with pytest.raises((TypeError, ValueError), match=r"^(boundary|end) must"):
            call()


@pytest.mark.parametrize("bad", [None, "beam", 1.0, (1.0, 1.0, 1.0), Beam])
def test_a_beam_must_be_a_beam(bad: Any) -> None:
    with pytest.raises(TypeError, match=r"^beam must be a Beam"):
        euler_bernoulli(bad, "clamped-free", 1)
