"""Responses to harmonic and random forces, moments and bases, of the exact beam and of chains."""

from __future__ import annotations

import json
import math
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import solve_continuous_lyapunov
from scipy.optimize import brentq

import beammodes as bm
from beammodes.accuracy.response_law import frequency_error_allowed

BEAM = bm.Beam(1.2, 85.0, 0.62)
UNIT = bm.Beam.unit()
TIP = bm.End(40.0, 9.0, 0.3, 0.004, 0.1)
FOOT = bm.End(900.0, 0.0, 0.1, 0.002, -0.05)
AT_TIP = {"force_at": 1.2, "deflection_at": 1.2}


def test_tip_of_a_cantilever_with_one_percent_in_every_mode() -> None:
    # Receptances per newton from a sum over 40 modes, cos b cosh b = -1, |phi(L)|² = 4/(rho A L).
    frequency = np.array([2.0, 4.5, 10.0, 28.5])
    roots = [
        brentq(lambda b: math.cos(b) + 1 / math.cosh(b), max((k - 0.5) * math.pi - 0.5, 1), k * math.pi)
        for k in range(1, 41)
    ]
    natural, omega = (np.array(roots) / 1.2) ** 2 * math.sqrt(85 / 0.62), 2 * math.pi * frequency[:, None]
    summed = (4 / (0.62 * 1.2) / (natural**2 - omega**2 + 0.02j * natural * omega)).sum(axis=1)
    exact = bm.frequency_response(BEAM, "clamped-free", frequency=frequency, damping_ratio=0.01, **AT_TIP)
    assert exact.receptance.values == pytest.approx(summed, rel=1e-5)
    # The values that the question states.
    expected = [0.008352014800404255, 0.22302371667129872, 0.0014948652230288631, 0.00836172545245154]
    assert np.abs(exact.receptance.values) == pytest.approx(expected, rel=1e-5)
    degrees = np.degrees(np.angle(exact.receptance.values))
    assert degrees == pytest.approx([-0.611, -42.046, -179.184, -87.918], abs=5e-4)
    assert exact.accelerance.values == pytest.approx(
        -((2 * np.pi * frequency) ** 2) * exact.receptance.values
    )
    assert exact.mobility.attrs["units"] == "m / N / s" and exact.change < 1e-10
    # A chain's is the sum over its own modes.
    chain = bm.Chain(BEAM, "clamped-free", 10)
    modes = bm.solve_modes(bm.linearize(chain))
    for ratios in ([0.01], [0.01, 0.03, 0.02]):
        own = np.append(ratios, np.full(10 - len(ratios), ratios[-1]))
        each = modes.angular_frequency**2 - omega**2 + 2j * own * modes.angular_frequency * omega
        found = bm.frequency_response(chain, frequency=frequency, damping_ratio=ratios, **AT_TIP)
        assert found.receptance.values == pytest.approx(
            (modes.deflection[:, -1] ** 2 / each).sum(axis=1), rel=1e-11
        )
        assert found.modes == 10 and found.change == 0.0


def closed_forms(beta: Any) -> dict[tuple[str, str, str, float], Any]:
    """Receptances for L = EI = 1 by Bishop and Johnson, The Mechanics of Vibration (1960), table 7.1.

    By ends, what is read and what drives, both at x.
    """
    c, s, ch, sh = mp.cos(beta), mp.sin(beta), mp.cosh(beta), mp.sinh(beta)
    half = beta / 2
    return {
        ("clamped-free", "deflection", "force", 1): (s * ch - c * sh) / (beta**3 * (1 + c * ch)),
        ("clamped-free", "rotation", "force", 1): s * sh / (beta**2 * (1 + c * ch)),
        ("clamped-free", "deflection", "moment", 1): s * sh / (beta**2 * (1 + c * ch)),
        ("clamped-free", "rotation", "moment", 1): (c * sh + s * ch) / (beta * (1 + c * ch)),
        ("free-free", "deflection", "force", 1): (s * ch - c * sh) / (beta**3 * (c * ch - 1)),
        ("pinned-pinned", "rotation", "moment", 0): (c * sh - s * ch) / (-2 * beta * s * sh),
        ("pinned-pinned", "deflection", "force", 0.5): (mp.tan(half) - mp.tanh(half)) / (4 * beta**3),
    }


def test_beam_against_closed_forms_with_complex_wave_numbers() -> None:
    frequency = np.array([1e-3, 0.3, 2.0, 11.0, 60.0, 900.0, 3e4])
    damping, lost = bm.Damping(mass=0.4, stiffness=1e-5), 0.02
    omega = 2 * math.pi * frequency
    with mp.workdps(60):
        g = [mp.mpc(1, lost + w * 1e-5) for w in omega]
        square = [mp.mpc(w**2, -w * 0.4) for w in omega]
        forms = [
            closed_forms((s / a * 0.62 / mp.mpf(85)) ** 0.25 * 1.2) for s, a in zip(square, g, strict=True)
        ]
        for ends, read, drive, x in forms[0]:
            powers = 1 + (read == "deflection") + (drive == "force")
            expected = [
                complex(form[ends, read, drive, x] * mp.mpf(1.2) ** powers / 85 / a)
                for form, a in zip(forms, g, strict=True)
            ]
            at = {f"{drive}_at": 1.2 * x, f"{read}_at": 1.2 * x}
            given = {"frequency": frequency, "damping": damping, "loss_factor": lost}
            found = bm.frequency_response(BEAM, ends, **given, **at)
            # Forces on a free beam below 1 mHz have a response of 1e6 over which rotations need digits.
            assert found.receptance.values == pytest.approx(np.array(expected), rel=1e-11)


def test_moving_bases_against_closed_forms() -> None:
    frequency, lost = np.array([0.0, 1.0, 4.6, 29.0, 200.0]), 0.01
    beta = ((2 * np.pi * frequency) ** 2 / (1 + 1j * lost) * 0.62 / 85) ** 0.25 * 1.2
    c, s, ch, sh = np.cos(beta), np.sin(beta), np.cosh(beta), np.sinh(beta)
    given = {"frequency": frequency, "loss_factor": lost, "deflection_at": 1.2}
    shifted = bm.frequency_response(BEAM, "clamped-free", base="shift", **given)
    # The tip of a beam whose root is given y = 1, y' = 0, and y = 0, y' = 1: the same book, section 7.4.
    assert shifted.transmissibility.values == pytest.approx((c + ch) / (1 + c * ch), rel=1e-12)
    assert shifted.relative_motion.values[1:] == pytest.approx(((c + ch) / (1 + c * ch) - 1)[1:], rel=1e-10)
    turned = bm.frequency_response(BEAM, "clamped-free", base="turn", **given)
    tip = np.divide((s + sh) * 1.2, beta * (1 + c * ch), out=np.full_like(beta, 1.2), where=beta != 0)
    assert turned.transmissibility.values == pytest.approx(tip, rel=1e-12)
    assert turned.transmissibility.attrs["units"] == "m / rad"


@pytest.mark.parametrize(
    ("ends", "pull"),
    [(("clamped", TIP), 20.0), ((FOOT, TIP), -5.0), (("guided", "pinned"), 30.0), (("pinned", TIP), 0)],
)
def test_beams_with_bodies_springs_and_tension_are_what_chains_converge_to(ends: Any, pull: float) -> None:
    """Neither knows the other; errors of h² are extrapolated away, on nodes that both chains have."""
    frequency = np.array([0.5, 4.6, 30.0, 90.0])
    given = {"load": bm.Load(axial_force=pull), "damping": bm.Damping(0.5, 1e-4), "loss_factor": 0.01}
    drives = [{"force_at": [0.3, 1.2]}, {"base": "shift"}, *([] if pull else [{"base": "turn"}])]
    for drive in drives:
        case = {"frequency": frequency, "deflection_at": [0.0, 0.3, 1.2], **given, **drive}
        exact = next(iter(bm.frequency_response(BEAM, ends, **case).data_vars.values())).values
        coarse, fine = (
            next(
                iter(bm.frequency_response(bm.Chain(BEAM, ends, n, "gregory"), **case).data_vars.values())
            ).values
            for n in (80, 160)
        )
        scale = np.abs(exact).max()
        assert np.abs((4 * fine - coarse) / 3 - exact).max() < 5e-6 * scale
        assert np.abs(coarse - exact).max() < 2e-3 * scale


def test_beams_that_vary_by_collocation() -> None:
    """A uniform beam that is given as functions; and a stepped taper, to which its chains converge."""
    frequency = np.array([0.01, 2.0, 4.5, 30.0, 300.0])
    given = {"frequency": frequency, "loss_factor": 0.01, "damping": bm.Damping(0.3, 1e-5)}
    plain = bm.Beam(1.2, 85.0, 0.62, 2e-4)
    told = bm.Beam(1.2, *(lambda x, value=value: value + 0.0 * x for value in (85.0, 0.62, 2e-4)))
    assert not told.is_uniform
    for drive in ({"force_at": [0.3, 1.2]}, {"moment_at": 0.5}, {"base": "shift"}, {"base": "turn"}):
        for reading in ({"deflection_at": [0.7, 1.2]}, {"rotation_at": [0.0, 0.7]}):
            both = [
                bm.frequency_response(b, ("pinned", TIP), **given, **drive, **reading) for b in (plain, told)
            ]
            for name in both[0].data_vars:
                assert both[1][name].values == pytest.approx(both[0][name].values, rel=1e-10, abs=1e-300)
    horn = bm.Beam(
        1.2, lambda x: 85.0 * np.where(x < 0.6, 1.0, 1.6 - x) ** 3, lambda x: 0.62 * (2 - x), breaks=[0.6]
    )
    case = {"deflection_at": [0.6, 1.2], "force_at": 1.2, **given} | {"frequency": frequency[:4]}
    exact = bm.frequency_response(horn, ("clamped", TIP), **case).receptance.values
    coarse, fine = (
        bm.frequency_response(bm.Chain(horn, ("clamped", TIP), n, "gregory"), **case).receptance.values
        for n in (80, 160)
    )
    assert np.abs((4 * fine - coarse) / 3 - exact).max() < 1e-6 * np.abs(exact).max()
    # Modes, and integrals over them, where the even part is known as a whole.
    for drive in ({"force_at": 1.2}, {"base": "turn"}):
        case = {"frequency": frequency[1:4], "deflection_at": 1.2, "damping_ratio": 0.02, **drive}
        both = [bm.frequency_response(b, "clamped-free", **case) for b in (plain, told)]
        for name in both[0].data_vars:
            assert both[1][name].values == pytest.approx(both[0][name].values, rel=1e-7)
        assert both[1].modes <= 40 and both[1].change < 1e-7


def test_modal_damping_of_a_beam_with_bodies_is_the_sum_of_its_modes() -> None:
    """Static correction and closed form of the even part against plain sums of many modes."""
    frequency, shaft = np.array([3.0, 20.0]), bm.Beam(1.2, 85.0, 0.62, rotary_inertia_per_length=2e-4)
    omega = 2 * np.pi * frequency[:, None]
    modes = bm.euler_bernoulli(shaft, ("clamped", TIP), 300, load=bm.Load(axial_force=20.0))
    natural = modes.angular_frequency
    ratio = np.full(300, 0.03) - 0.02 * (np.arange(300) < 2)
    terms = 1 / (natural**2 - omega**2 + 2j * ratio * natural * omega)
    given = {"frequency": frequency, "damping_ratio": [0.01, 0.01, 0.03], "load": bm.Load(axial_force=20.0)}
    found = bm.frequency_response(shaft, ("clamped", TIP), force_at=0.5, rotation_at=1.2, **given)
    summed = terms @ (modes.shape([0.5])[:, 0] * modes.slope([1.2])[:, 0])
    assert found.receptance.values == pytest.approx(summed, rel=3e-6)
    assert found.receptance.values.imag == pytest.approx(summed.imag, rel=1e-8)
    # A base: by Gauss's rule, not by what supports do.
    node, weight = np.polynomial.legendre.leggauss(2000)
    x, weight = 0.6 * (node + 1), 0.6 * weight
    body = modes.shape([1.2])[:, 0] + 0.1 * modes.slope([1.2])[:, 0]
    momentum = 0.62 * modes.shape(x) @ weight + 0.3 * body
    shaken = bm.frequency_response(shaft, ("clamped", TIP), base="shift", deflection_at=1.2, **given)
    summed = omega[:, 0] ** 2 * (terms @ (momentum * modes.shape([1.2])[:, 0]))
    assert shaken.relative_motion.values == pytest.approx(summed, rel=1e-6)
    assert shaken.relative_motion.values.imag == pytest.approx(summed.imag, rel=1e-8)


def dense(chain: bm.Chain, damping: bm.Damping) -> tuple[NDArray[Any], ...]:
    """Assembled M, C, K of a clamped-free chain, whose coordinates are its nodes' deflections."""
    model = bm.linearize(chain)
    bend = model.joint_rotations
    own = np.broadcast_to(damping.joint, len(bend))
    mass, stiffness = model.mass_matrix, model.stiffness_matrix
    return (
        mass,
        damping.mass * mass + damping.stiffness * stiffness + bend.T @ (own[:, None] * bend),
        stiffness,
    )


def test_chain_against_assembled_matrices_and_integration_in_time() -> None:
    chain = bm.Chain(BEAM, "clamped-free", 6)
    damping = bm.Damping(0.3, 2e-5, (0.0, 0.02, 0.0, 0.01, 0.0, 0.03))
    mass, drag, stiffness = dense(chain, damping)
    frequency = np.array([2.0, 4.5, 12.0, 27.0, 60.0])
    given = {"frequency": frequency, "damping": damping}
    found = bm.frequency_response(chain, force_at=[0.4, 1.2], deflection_at=[0.4, 0.7, 1.2], **given)
    shaken = bm.frequency_response(chain, base="turn", deflection_at=[0.4, 0.7, 1.2], **given)
    arms = np.zeros((3, 6))
    arms[0, 1] = arms[1, 2] = arms[1, 3] = arms[2, 5] = 1.0
    arms[1] /= 2
    nodes = 0.2 * np.arange(1, 7)
    for k, f in enumerate(frequency):
        omega = 2 * np.pi * f
        matrix = -(omega**2) * mass + 1j * omega * drag + stiffness
        answer = np.linalg.solve(matrix, arms[[0, 2]].T)
        assert found.receptance.values[k] == pytest.approx(arms @ answer, rel=1e-10)
        relative = np.linalg.solve(matrix, omega**2 * mass @ nodes)
        assert shaken.relative_motion.values[k] == pytest.approx(arms @ relative, rel=1e-10)
        # In time, from the state that it claims to return to: three periods on, under cos ωt at the tip.
        start = answer[:, 1]

        def rate(t: float, state: NDArray[Any], w: float = omega) -> NDArray[Any]:
            pull = arms[2] * math.cos(w * t) - drag @ state[6:] - stiffness @ state[:6]
            return np.concatenate([state[6:], np.linalg.solve(mass, pull)])

        state = np.concatenate([start.real, (1j * omega * start).real])
        end = solve_ivp(rate, (0, 3.25 / f), state, method="DOP853", rtol=1e-9, atol=1e-12).y[:6, -1]
        assert np.abs(end - (1j * start).real).max() < 1e-6 * np.abs(start).max()


@pytest.mark.slow
@pytest.mark.parametrize("driven", ["base", "force"])
@pytest.mark.parametrize("frequency", [2.0, 4.5, 9.0, 25.0, 60.0])
def test_nonlinear_motion_of_small_size_is_the_response(driven: str, frequency: float) -> None:
    """`simulate`, which knows large rotations, with a base by micrometres or a force by micronewtons."""
    chain, damping, size = bm.Chain(BEAM, "clamped-free", 3, "gregory"), bm.Damping(2.0, 1e-4), 1e-6
    omega = 2 * np.pi * frequency
    drive: dict[str, Any] = {"base": "shift"} if driven == "base" else {"force_at": 1.2}
    answer = bm.frequency_response(
        chain, frequency=frequency, rotation_at=[0.2, 0.6, 1.0], damping=damping, **drive
    )
    angle = -1j * size * next(iter(answer.data_vars.values())).values  # of sin ωt
    given: dict[str, Any] = {"base": bm.BaseMotion(y=bm.harmonic(size, omega))}
    if driven == "force":
        given = {"load": bm.TimedLoad(bm.Load(tip_force=size), bm.Sine(frequency=frequency))}
    start = angle.real, (1j * omega * angle).real
    motion = bm.simulate(
        chain,
        duration=2.25 / frequency,
        integrator="dop853",
        initial=start,
        damping=damping,
        tolerance=1e-11,
        **given,
    )
    expected = (angle * np.exp(1j * omega * motion.time.values[:, None])).real
    assert np.abs(motion.q.values - expected).max() < 1e-6 * np.abs(expected).max()


def test_long_chains_lose_no_digits_and_rotations_are_reciprocal() -> None:
    """A pinned chain's modes are sines, q = nπ/N per segment; assembled matrices would lose 1e-3 here."""
    count, lost = 2000, 0.01
    q = np.pi * np.arange(1, count, 2) / count
    ell = 1.0 / count
    # Modal mass of a sine at the nodes, m/6 [1 4 1], and squared frequency with 1 - cos q = 2 sin²(q/2).
    mass = ell * (2 + np.cos(q)) / 3 * count / 2
    square = 48 * np.sin(q / 2) ** 4 / (2 + np.cos(q)) / ell**4
    frequency = np.array([0.5, 1.6, 14.0, 200.0])
    omega = 2 * np.pi * frequency[:, None]
    summed = (1 / mass / (square * (1 + 1j * lost) - omega**2)).sum(axis=1)
    chain = bm.Chain(UNIT, "pinned-pinned", count)
    given = {"frequency": frequency, "loss_factor": lost}
    found = bm.frequency_response(chain, force_at=0.5, deflection_at=0.5, **given)
    assert found.receptance.values == pytest.approx(summed, rel=1e-10)
    short = bm.Chain(UNIT, "pinned-pinned", 7)
    for system, ends in ((short, None), (UNIT, "pinned-pinned")):
        one = bm.frequency_response(system, ends, force_at=0.3, rotation_at=3 / 7, **given)
        other = bm.frequency_response(system, ends, moment_at=3 / 7, deflection_at=0.3, **given)
        assert one.receptance.values == pytest.approx(other.receptance.values, rel=1e-12)


@pytest.mark.parametrize("rule", ["mitiguy", "gregory"])
def test_the_law_of_the_error_at_a_resonance(rule: str) -> None:
    """Over damping of 0.1 to 5 %, at the first two resonances; beyond the law come terms of e and ζ."""
    for mode in (1, 2):
        omega = bm.euler_bernoulli(BEAM, "clamped-free", mode).frequency[-1]
        chain = bm.Chain(BEAM, "clamped-free", 10, rule)
        error = bm.frequency_error("clamped-free", segments=10, mode=mode, rule=rule)
        for ratio in (0.001, 0.002, 0.005, 0.01, 0.02, 0.05):
            given = {"frequency": omega, "damping_ratio": ratio, **AT_TIP}
            both = bm.frequency_response(chain, **given), bm.frequency_response(BEAM, "clamped-free", **given)
            measured = both[0].receptance.item() / both[1].receptance.item() - 1
            law = bm.response_error("clamped-free", segments=10, mode=mode, rule=rule, damping_ratio=ratio)
            assert abs(1 + law) == pytest.approx(1 / math.sqrt(1 + (error / ratio) ** 2), rel=1e-12)
            assert np.angle(1 + law) == pytest.approx(math.atan(error / ratio), rel=1e-12)
            # The shape at the tip and the other modes: 3 |e| and some parts of the driven mode's ζ.
            assert abs(measured - law) < 3 * abs(error) + 0.01 * abs(law) + 2e-3
    if rule == "mitiguy":
        lost = 1 - abs(1 + bm.response_error("clamped-free", segments=10, mode=1, damping_ratio=0.001))
        assert lost == pytest.approx(0.38, abs=0.005)  # the value that is quoted for N = 10 and 0.1 %


def test_segments_needed_for_a_response() -> None:
    for ratio, rule in ((0.01, "mitiguy"), (0.001, "gregory"), (0.05, "naive")):
        needed = bm.segments_needed("clamped-free", 0.02, 3, rule, damping_ratio=ratio)
        counts = np.arange(2, 3 * needed)
        off = bm.response_error(
            "clamped-free", segments=counts[:, None], mode=[1, 2, 3], rule=rule, damping_ratio=ratio
        )
        failing = counts[~(np.abs(1 + np.asarray(off)) >= 0.98).all(axis=1)]
        assert needed == failing.max() + 1
    # Twist has the same law: the error of its ten half stubs is sin x/x - 1.
    twist = {"segments": 10, "mode": 1, "rule": "half_stub", "motion": "twist"}
    error = math.sin(math.pi / 40) / (math.pi / 40) - 1
    found = bm.response_error("fixed-free", **twist, damping_ratio=0.001)
    assert 1 + found == pytest.approx(1 / (1 - 1j * error / 0.001), rel=1e-9)
    # A fifth of the damping ratio keeps 2 % and 11 degrees.
    assert frequency_error_allowed(0.02, 0.01) == pytest.approx(0.002, rel=0.02)


def test_rms_under_white_noise_is_lyapunovs() -> None:
    """A X + X Aᵀ = -b S bᵀ/2 gives all the power; beyond the band, (f/f_n)³ of it is left out."""
    chain, damping, level = bm.Chain(BEAM, "clamped-free", 2), bm.Damping(1.0, 2e-4), 0.3
    mass, drag, stiffness = dense(chain, damping)
    inverse = np.linalg.inv(mass)
    state = np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ stiffness, -inverse @ drag]])
    push = np.concatenate([np.zeros(2), inverse[:, 1]])
    power = solve_continuous_lyapunov(state, -level / 2 * np.outer(push, push))
    given = {"density": level, "band": (0.0, 4e4), "damping": damping}
    found = bm.random_response(chain, force_at=1.2, deflection_at=[0.6, 1.2], **given)
    assert found.rms.values == pytest.approx(np.sqrt(power.diagonal()[:2]), rel=1e-8)
    assert found.rms_velocity.values == pytest.approx(np.sqrt(power.diagonal()[2:]), rel=1e-2)
    assert found.accuracy < 1e-6
    # A base that turns: the inertia of the chain is what drives it.
    shaken = bm.random_response(chain, base="turn", deflection_at=1.2, **given)
    push = np.concatenate([np.zeros(2), inverse @ mass @ [0.6, 1.2]])
    power = solve_continuous_lyapunov(state, -level / 2 * np.outer(push, push))
    assert float(shaken.rms) == pytest.approx(math.sqrt(power[1, 1]), rel=1e-8)
    # A function of frequency that is a number is that number.
    again = bm.random_response(
        chain, base="turn", deflection_at=1.2, **given | {"density": lambda f: level + 0.0 * f}
    )
    assert float(again.rms) == float(shaken.rms)


def test_what_is_refused_says_what_is_allowed() -> None:
    chain = bm.Chain(BEAM, "clamped-free", 4)
    good: dict[str, Any] = {"frequency": 1.0, **AT_TIP}
    for words, call in (
        ("boundary must be the ends", lambda: bm.frequency_response(BEAM, **good)),
        (
            "must be above 0",
            lambda: bm.frequency_response(BEAM, "pinned-free", **good | {"frequency": [0.0, 1.0]}),
        ),
        ("boundary must be left out", lambda: bm.frequency_response(chain, "clamped-free", **good)),
        (
            "force_at and moment_at and base",
            lambda: bm.frequency_response(chain, frequency=1.0, rotation_at=0.1),
        ),
        (
            "deflection_at must be inside",
            lambda: bm.frequency_response(chain, **good | {"deflection_at": 1.3}),
        ),
        (
            "and of every mode above 0",
            lambda: bm.random_response(
                chain, density=1.0, band=(1, 9), force_at=1.2, deflection_at=1.2, damping_ratio=[0.0, 0.1]
            ),
        ),
        (
            "damping_ratio must be given alone",
            lambda: bm.frequency_response(chain, **good, damping_ratio=0.01, loss_factor=0.1),
        ),
        (
            "without joint dampers",
            lambda: bm.frequency_response(BEAM, "clamped-free", **good, damping=bm.Damping(joint=0.1)),
        ),
        (
            "tie an end to the base",
            lambda: bm.frequency_response(BEAM, "free-free", frequency=1.0, base="shift", deflection_at=0.5),
        ),
        ("buckl", lambda: bm.frequency_response(chain, **good, load=bm.Load(axial_force=-1e4))),
        (
            "buckl",
            lambda: bm.frequency_response(BEAM, "clamped-free", **good, load=bm.Load(axial_force=-1e4)),
        ),
        (
            "frequency, band or axial_force of load must be lower",
            lambda: bm.frequency_response(BEAM, "clamped-free", **good | {"frequency": 1e12}),
        ),
        (
            "one of damping|damping_ratio, damping or",
            lambda: bm.random_response(chain, density=1.0, band=(0, 9), **AT_TIP),
        ),
        (
            "damping_ratio must be at most 0.2",
            lambda: bm.segments_needed("clamped-free", 0.02, damping_ratio=1),
        ),
    ):
        with pytest.raises((TypeError, ValueError), match=words):
            call()


def test_a_plot_has_magnitude_and_phase() -> None:
    from matplotlib.figure import Figure

    given = {"frequency": np.linspace(1, 40, 50), "force_at": 1.2, "damping_ratio": 0.02}
    exact = bm.frequency_response(BEAM, "clamped-free", deflection_at=[0.6, 1.2], **given)
    top, below = bm.plot_response(exact)
    assert [line.get_label() for line in top.lines] == ["deflection at 0.6 m", "deflection at 1.2 m"]
    shown = np.asarray(below.lines[1].get_ydata())
    assert shown == pytest.approx(np.degrees(np.unwrap(np.angle(exact.receptance.values[:, 1]))))
    assert (below.get_xlabel(), top.get_yscale()) == ("frequency  [Hz]", "log")
    ax = Figure().subplots()
    assert bm.plot_response(exact.sel(deflection_at=1.2), ax, quantity="accelerance", label="beam") == (ax,)
    assert ax.get_ylabel() == "acceleration of deflection over force  [m / N / s²]"


def test_the_command_shows_beam_and_chain_side_by_side(capsys: pytest.CaptureFixture[str]) -> None:
    from beammodes.__main__ import main

    words = "response clamped-free --segments 10 --damping-ratio 1% --length 1.2 --ei 85 --rho-a 0.62 --json"
    assert main([*words.split(), "--frequency", "2,4.5"]) == 0
    found = json.loads(capsys.readouterr().out)
    given = {"frequency": [2.0, 4.5], "damping_ratio": 0.01, **AT_TIP}
    for name, system in (("", (bm.Chain(BEAM, "clamped-free", 10),)), ("exact_", (BEAM, "clamped-free"))):
        values = bm.frequency_response(*system, **given).receptance.values
        assert [row[f"{name}receptance"] for row in found["responses"]] == pytest.approx(abs(values))
        assert [row[f"{name}phase"] for row in found["responses"]] == pytest.approx(
            np.degrees(np.angle(values))
        )
