"""Sums of modes against chains and closed forms, and the studies of motion against the package."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import beammodes as bm
from beammodes.dynamics.base_motion import BaseMotion, harmonic, spin_up
from beammodes.dynamics.superposition import _integrals, modal_response
from beammodes.exact.exact_beam import plain_modes
from studies import motion_spectrum
from studies.appendix import pinned_shape, plucked
from studies.common import moved
from studies.compare import rows_of
from studies.study import repeatable

FIGURES = Path(__file__).parent.parent / "figures"
UNIT = bm.Beam.unit()


def read(name: str) -> list[dict[str, str]]:
    return rows_of(FIGURES / name)


# --- Sums of modes ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "base",
    [
        # The last one shakes across, too.
        pytest.param(BaseMotion(y=harmonic(1e-4, 2.0)), id="shift", marks=pytest.mark.slow),
        pytest.param(
            BaseMotion(angle=harmonic(1e-4, 2.0), hub_radius=0.5), id="turn", marks=pytest.mark.slow
        ),
        # Pushed and pulled along: T = -a m (L - x).
        pytest.param(BaseMotion(x=harmonic(1.0, 2.0), y=harmonic(1e-4, 2.0)), id="shaken_along"),
    ],
)
def test_a_sum_of_modes_is_the_chain_in_small_motion(base: BaseMotion) -> None:
    """Reached: 3e-5, 5e-5, 2e-4 of the largest deflection; a chain of 28 rods is the measure of it."""
    beam = bm.Beam(1.3, 2.0, 0.7)
    motion = moved(bm.Chain(beam, "clamped-free", 28, "gregory"), 2.0, 0.05, base=base)
    summed = modal_response(beam, "clamped-free", 8, time=motion.time, base=base, stiffening=True)
    largest = float(np.abs(motion.tip_deflection).max())
    assert largest > 3e-5
    assert np.abs(summed.tip_deflection.values - motion.tip_deflection.values).max() < 5e-4 * largest


#: A taper, a spring and a body before the left end, a body beyond the right one.
TAPER = bm.Beam(1.3, lambda x: 2.0 * (1 - 0.4 * x / 1.3) ** 3, lambda x: 0.7 * (1 - 0.4 * x / 1.3))
HUNG = bm.End(math.inf, 25.0, mass=0.2, rotary_inertia=0.02, offset=0.15)
TIP = bm.End(mass=0.3, rotary_inertia=0.03, offset=0.1)


def test_a_damped_sum_with_bodies_and_springs_on_a_turning_hub_is_the_chain() -> None:
    """Reached: 9e-4 of the largest; each of the five integrals without its bodies is 5e-2 off or more.

    The chain's own error is of second order, as of every chain under axial force, and is extrapolated.
    """
    rate, slow, damping = 3.0, 2e-4, bm.Damping(mass=0.3, stiffness=0.01)
    base = BaseMotion(
        y=harmonic(1e-4, 5.0),
        angle=lambda t: (rate * t + slow * t**3, rate + 3 * slow * t**2, 6 * slow * t),
        hub_radius=1.0,
    )
    five, ten = (
        bm.simulate(
            bm.Chain(TAPER, (HUNG, TIP), segments, "gregory"), duration=2.0, base=base, damping=damping,
            integrator="rk45", output_step=0.1, tolerance=1e-6,
        ).tip_deflection.values
        for segments in (5, 10)
    )  # fmt: skip
    given: dict[str, Any] = {"base": base, "damping": damping, "stiffening": True, "tolerance": 1e-8}
    summed = modal_response(TAPER, (HUNG, TIP), 5, time=np.arange(21) * 0.1, **given).tip_deflection.values
    largest = np.abs(summed).max()
    assert largest > 4e-4
    assert np.abs((4 * ten - five) / 3 - summed).max() < 2e-3 * largest


def test_modes_on_springs_share_all_mass_and_inertia() -> None:
    """Where no end is held, modes sum to shift and turn: Σ B² = M, Σ B C = Σ x m, Σ C² = Σ x² m + J."""
    ends = (bm.End(40.0, 3.0, mass=0.2, rotary_inertia=0.02, offset=0.15), bm.End(60.0, 2.0, 0.3, 0.03, 0.1))
    found = _integrals(bm.euler_bernoulli(TAPER, ends, 40))
    x, weight = np.polynomial.legendre.leggauss(8)
    x, weight = 0.65 * (x + 1), 0.65 * weight * 0.7 * (1 - 0.2 * (x + 1))
    mass = weight.sum() + 0.2 + 0.3
    first = weight @ x - 0.2 * 0.15 + 0.3 * 1.4
    second = weight @ x**2 + 0.2 * 0.15**2 + 0.3 * 1.4**2 + 0.02 + 0.03
    assert found.push @ found.push == pytest.approx(mass, rel=1e-5)
    assert found.push @ found.swing == pytest.approx(first, rel=1e-5)
    assert found.swing @ found.swing == pytest.approx(second, rel=1e-5)


def test_free_decay_in_closed_form_is_the_integrated_one() -> None:
    """Without damping, with little, with the critical one of mode 1, and beyond."""
    time, start = np.linspace(0.0, 3.0, 7), [1.0, -0.5, 0.2]
    omega = float(plain_modes(UNIT, "clamped-free", 1).angular_frequency[0])
    for damped in (
        {"damping_ratio": [0.0, 0.05]},
        {"damping": bm.Damping(mass=2 * omega)},
        {"damping": bm.Damping(mass=10.0, stiffness=0.03)},
    ):
        given: dict[str, Any] = {"time": time, "initial": start, **damped}
        free = modal_response(UNIT, "clamped-free", 3, **given).q.values
        run = modal_response(UNIT, "clamped-free", 3, base=BaseMotion(), tolerance=1e-11, **given).q.values
        np.testing.assert_allclose(free, run, atol=1e-8)
    # Rayleigh's damping by its ratios; and peaks of mode 1 give the ratio back.
    damping = bm.Damping(mass=0.1, stiffness=0.002)
    ratio = 0.1 / (2 * omega) + 0.002 * omega / 2
    periods = 2 * math.pi * np.arange(5) / (omega * math.sqrt(1 - ratio**2))
    peaks = modal_response(UNIT, "clamped-free", 1, time=periods, initial=[1.0], damping=damping).q.values[
        :, 0
    ]
    assert bm.ratio_from_decay(peaks).ratio == pytest.approx(ratio, rel=1e-12)


def test_stiffening_is_what_the_exact_beam_on_a_turning_hub_has() -> None:
    """Reached: 7.7e-4 with 4 modes, 1.6e-4 with 6. Few modes are too stiff, as in any Rayleigh-Ritz sum."""
    rate, time = 6.0, np.linspace(0.0, 12.0, 1201)
    turn = BaseMotion(angle=lambda t: (rate * t, rate + 0.0 * t, 0.0 * t), hub_radius=1.0)
    start = np.eye(4)[0] * 1e-3
    found = modal_response(
        UNIT, "clamped-free", 4, time=time, base=turn, initial=start, stiffening=True, tolerance=1e-8
    )
    omega, amplitude = motion_spectrum.spectrum(time, found.tip_deflection.values)
    load = bm.Load(spin_rate=rate, hub_radius=1.0, plane="lag")
    exact = float(bm.euler_bernoulli(UNIT, "clamped-free", 1, load=load).angular_frequency[0])
    assert 0.0 < motion_spectrum.peak(omega, amplitude, 5.0, 12.0) / exact - 1 < 1e-3


def test_without_stiffening_a_beam_that_turns_faster_than_its_frequency_moves_away() -> None:
    # q'' + (ω² - Ω²) q = 0 from q = 1: cos below ω, cosh above it.
    first = float(plain_modes(UNIT, "clamped-free", 1).angular_frequency[0])
    time = np.linspace(0.0, 1.0, 11)
    for rate in (3.0, 5.0):
        base = BaseMotion(angle=lambda t, rate=rate: (rate * t, rate + 0.0 * t, 0.0 * t))
        q = modal_response(UNIT, "clamped-free", 1, time=time, base=base, initial=[1.0]).q.values[:, 0]
        square = first**2 - rate**2
        exact = np.cos(np.sqrt(square) * time) if square > 0 else np.cosh(np.sqrt(-square) * time)
        np.testing.assert_allclose(q, exact, rtol=1e-8)


def test_a_plucked_beam_is_the_sum_of_its_modes() -> None:
    beam, force, at = bm.Beam(2.0, 3.0, 0.5), 4.0, 0.7
    shapes, x = plain_modes(beam, "pinned-pinned", 400), np.linspace(0.0, 2.0, 21)
    q = plucked(shapes, force, at)
    # q_n = F φ_n(a)/ω_n², φ_n = √(2/ρAL) sin(nπx/L): the classical series.
    n = np.arange(1, 401)
    series = math.sqrt(2.0 / (0.5 * 2.0)) * np.sin(n * math.pi * at / 2.0) * force
    series /= 3.0 / 0.5 * (n * math.pi / 2.0) ** 4
    np.testing.assert_allclose(q, series, rtol=1e-9, atol=1e-14 * series[0])
    exact = pinned_shape(beam, force, at, x)
    # What the sum leaves out falls as 1/n³; so 1e-8 at 400 modes.
    assert np.abs(q @ shapes.shape(x) - exact).max() < 1e-7 * exact.max()
    # Under the load F a² b² / (3 EI L) (Roark's Formulas, simply supported beam, intermediate load).
    assert pinned_shape(beam, force, at, at) == pytest.approx(
        force * at**2 * 1.3**2 / (3 * 3.0 * 2.0), rel=1e-14
    )
    slope = pinned_shape(beam, force, at, x, derivative=1)
    assert np.abs(q @ shapes.slope(x) - slope).max() < 1e-4 * np.abs(slope).max()
    # Let go, it is back after a period of mode 1, with signs of its modes on the way.
    period = 2 * math.pi / shapes.angular_frequency[0]
    swung = modal_response(beam, "pinned-pinned", 20, time=[0.0, period / 2, period], initial=q[:20]).q.values
    np.testing.assert_allclose(swung[2], q[:20], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(swung[1], q[:20] * np.where(n[:20] % 2, -1, 1), rtol=1e-9, atol=1e-12)


def test_orders_of_truncation() -> None:
    found = {(r["quantity"], int(r["modes"])): float(r["relative_error"]) for r in read("appendix.csv")}
    for quantity, order in (("deflection", 3), ("moment", 1)):
        fall = math.log(found[quantity, 10] / found[quantity, 40]) / math.log(4)
        assert fall == pytest.approx(order, abs=0.25)


@pytest.mark.parametrize(
    ("changed", "error", "message"),
    [
        ({"beam": 1}, TypeError, "^beam must be a Beam"),
        ({"damping_ratio": -0.1}, ValueError, "^damping_ratio must be one number or a row of them"),
        (
            {"damping_ratio": 0.1, "damping": bm.Damping(1.0)},
            ValueError,
            "^damping_ratio must be given alone",
        ),
        ({"damping": 0.1}, TypeError, "^damping must be a Damping or None, got 0.1"),
        ({"damping": bm.Damping(joint=0.1)}, ValueError, "^damping of a beam must be without joint dampers"),
        ({"boundary": "free-free"}, ValueError, "^boundary must leave no rigid-body motion"),
        ({"boundary": (bm.End.hub(0.1, 1.0, 1.0), "free")}, ValueError, "^boundary must have no hub_radius"),
        ({"boundary": "free-clamped"}, ValueError, "^boundary must tie down the left end"),
        ({"modes": 0}, ValueError, "^modes must be a whole number"),
        ({"time": [1.0, 0.5]}, ValueError, "^time must ascend"),
        ({"time": [-1.0, 0.5]}, ValueError, "^time must ascend"),
        ({"time": "now"}, TypeError, "^time must be an array of real numbers"),
        ({"base": 3}, TypeError, "^base must be a BaseMotion or None"),
        ({"initial": [1.0]}, ValueError, "^initial must be 2 finite numbers"),
        ({"stiffening": 1}, TypeError, "^stiffening must be True or False"),
        ({"base": BaseMotion(), "tolerance": 0.0}, ValueError, "^tolerance must be greater than 0"),
    ],
)
def test_refusals(changed: dict[str, Any], error: type[Exception], message: str) -> None:
    arguments = {"beam": UNIT, "boundary": "clamped-free", "modes": 2, "time": [0.0, 1.0]} | changed
    with pytest.raises(error, match=message):
        modal_response(**arguments)


# --- The studies -----------------------------------------------------------------------------------------


def test_digits_that_repeat() -> None:
    assert repeatable([123.456789123, -1e-9], 8).tolist() == [123.45678912, 0.0]
    assert str(repeatable([-1e-9], 3)[0]) == "0.0"


def test_figure_1() -> None:
    rows = read("figure_1.csv")

    def line(motion: str, model: str) -> dict[float, float]:
        chosen = [r for r in rows if (r["motion"], r["model"]) == (motion, model) and r["tip_deflection"]]
        return {float(r["time"]): float(r["tip_deflection"]) for r in chosen}

    modes, chain = line("linear", "modes"), line("linear", "gregory")
    assert max(abs(modes[t] - chain[t]) for t in modes) < 3e-4 * max(map(abs, modes.values()))
    # Chains of growing N, extrapolated: -0.57375 m at 6.76 s. Conventional modes pass -1 m at 6.78 s.
    for model in ("mitiguy", "gregory", "modes_stiffened"):
        assert min(line("rotational", model).values()) == pytest.approx(-0.57375, rel=0.005)
        assert abs(line("rotational", model)[20.0]) < 0.01
    linear = line("rotational", "modes")
    assert min(t for t, value in linear.items() if value < -1.0) == pytest.approx(6.78, abs=0.05)


def test_campbell() -> None:
    for row in read("campbell.csv"):
        load = bm.Load(spin_rate=float(row["spin_rate"]), plane=row["plane"])
        mode = int(row["mode"])
        exact = bm.euler_bernoulli(UNIT, "clamped-free", mode, load=load).angular_frequency[-1]
        assert float(row["exact"]) == pytest.approx(exact, rel=1e-9)
        assert float(row["chain"]) == pytest.approx(exact, rel={"4": 0.2, "10": 0.05}[row["segments"]])
    # Wright, Smith, Thresher and Wang, J. Appl. Mech. 49 (1982) 197: Ω = 12.
    flap = [row for row in read("campbell.csv") if (row["plane"], row["mode"]) == ("flap", "1")]
    assert float(flap[-1]["exact"]) == pytest.approx(13.1702, abs=1e-4)


def test_turning_every_rule_is_of_order_two() -> None:
    rows = read("campbell_errors.csv")
    error = {(float(r["spin"]), r["rule"], int(r["count"])): float(r["relative_error"]) for r in rows}
    few, many = sorted({count for *_, count in error})[-3::2]
    for rule in ("mitiguy", "gregory"):
        fall = math.log(error[6.0, rule, few] / error[6.0, rule, many]) / math.log(many / few)
        assert fall == pytest.approx(2.0, abs=0.1)
    assert abs(error[0.0, "gregory", few]) < 1e-3 * abs(error[6.0, "gregory", few])


def test_peaks_and_shifts() -> None:
    rows = read("motion_spectrum.csv")
    chain = bm.Chain(UNIT, "clamped-free", len(rows), "gregory")
    known = bm.solve_modes(bm.linearize(chain)).angular_frequency
    found = np.array([float(row["angular_frequency"]) for row in rows])
    np.testing.assert_allclose(found[:6], known[:6], rtol=2e-6)
    np.testing.assert_allclose(found, known, rtol=5e-5)
    large = {(r["mode"], r["segments"], r["amplitude"]): r for r in read("motion_spectrum_large.csv")}
    for mode, rises in (("1", True), ("2", False)):
        little, more = (float(large[mode, "10", size]["frequency_shift"]) for size in ("0.05", "0.2"))
        assert (more > 0) is rises
        assert more / little == pytest.approx(16.0, rel=0.03)


def test_spin_up_film() -> None:
    path = FIGURES / "spin_up.gif"
    assert path.stat().st_size < 1_000_000
    with Image.open(path) as image:
        assert image.n_frames == 100
        assert image.size[0] == 480
    rows = read("spin_up.csv")
    for n, most in (("4", 0.005), ("10", 0.003), ("20", 0.001)):
        lowest = min(float(row["tip_deflection"]) for row in rows if row["segments"] == n)
        assert lowest == pytest.approx(-0.57375, rel=most)


def test_spin_up_of_the_beam_itself() -> None:
    """Chains of 10 and 20 rods, extrapolated by 1/N²."""
    beam, base = bm.Beam(10.0, 14000.0, 1.2), BaseMotion(angle=spin_up(6.0, 15.0))
    lowest = [
        float(moved(bm.Chain(beam, "clamped-free", n, "mitiguy"), 7.5, 0.02, base=base).tip_deflection.min())
        for n in (10, 20)
    ]
    assert (4 * lowest[1] - lowest[0]) / 3 == pytest.approx(-0.57375, abs=2e-5)
