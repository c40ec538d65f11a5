"""Beams that a turning hub, gravity or a tip force pulls on: published roots, power series, and chains."""

from __future__ import annotations

import math
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from beammodes import euler_bernoulli
from beammodes.chains.chain import Chain
from beammodes.exact.spectral_beam import SpectralBeamModes, spectral_modes
from beammodes.problem.beam import Beam
from beammodes.problem.ends import ENDS, Boundary, End
from beammodes.problem.loading import Load
from beammodes.problem.profiles import Table
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

UNIT = Beam.unit()
CANTILEVER = Boundary.of("clamped-free")
HELD = math.inf


# --- Published roots -------------------------------------------------------------------------------------

# L = EI = ρA = 1, keys (Ω, hub radius), flap then lag: recomputed with 60 digits from Frobenius series; three
# decimals of flap were printed by Wright, Smith, Thresher and Wang, J. Appl. Mech. 49 (1982) 197.
ROTATING = {
    (0.0, 0.0): (
        [3.5160152685001513, 22.03449156466677, 61.697214413549105, 120.90191605230572, 199.85953011680346],
        [3.5160152685001513, 22.03449156466677, 61.697214413549105, 120.90191605230572, 199.85953011680346],
    ),
    (2.0, 0.0): (
        [4.137319573025358, 22.61492195650405, 62.27318410567162, 121.49669471422149, 200.46692320563815],
        [3.621796964124125, 22.52631117379783, 62.24105926684468, 121.48023224574744, 200.45694624915154],
    ),
    (4.0, 0.0): (
        [5.585001420884815, 24.273349394448704, 63.966760493114904, 123.26148489822317, 202.2767120605049],
        [3.897722523639337, 23.941501432136274, 63.841573038134996, 123.19656512790809, 202.23715841063535],
    ),
    (6.0, 0.0): (
        [7.360373019310019, 26.809081678497932, 66.68391438150489, 126.14045258896961, 205.25281358618298],
        [4.263225420193833, 26.129042470867038, 66.4134356680926, 125.99767370610495, 205.1650981162351],
    ),
    (10.0, 0.0): (
        [11.202327762221334, 33.64036585421344, 74.6492945969782, 134.8841014029151, 214.4609535418217],
        [5.048974875381618, 32.11968578310394, 73.9764637153361, 134.5129020253146, 214.22768400481627],
    ),
    (12.0, 0.0): (
        [13.170150487506177, 37.603112331191866, 79.61447848945721, 140.5343544746813, 220.53632200150096],
        [5.427049277789837, 35.6369759799037, 78.70492478332118, 140.0210869391299, 220.20960315560654],
    ),
    (2.0, 1.0): (
        [4.833688871530717, 23.36604204568533, 63.06754812332674, 122.3395460553488, 201.34007220880903],
        [4.400516799963374, 23.2802903951118, 63.03582811614466, 122.32319701932587, 201.33013852140576],
    ),
    (6.0, 1.0): (
        [10.443865869459815, 32.02724398264489, 72.98633548539627, 133.18747577477956, 212.74979400300745],
        [8.548352724312892, 31.460202750838455, 72.73929589696903, 133.052259294074, 212.66517074575728],
    ),
    (12.0, 1.0): (
        [19.72154193525476, 51.07013401427134, 98.52679716103012, 163.7236813217351, 246.7158512616864],
        [15.650534058108434, 49.640291983787066, 97.7933011959959, 163.283323782746, 246.42384475488277],
    ),
}


@pytest.mark.parametrize(("spin", "radius"), ROTATING)
def test_rotating_cantilever(spin: float, radius: float) -> None:
    """Reached: 4e-15 out of the plane of rotation, 1.6e-14 in it."""
    # A beam of other numbers than 1, in its own units.
    beam = Beam(1.7, 83.0, 0.45)
    for plane, exact in zip(("flap", "lag"), ROTATING[spin, radius], strict=True):
        load = Load(spin_rate=spin * beam.frequency_unit, hub_radius=1.7 * radius, plane=plane)
        found = euler_bernoulli(beam, CANTILEVER, 5, load=load).angular_frequency / beam.frequency_unit
        assert np.abs(found / exact - 1.0).max() < 5e-14


# Greenhill (1881): the Airy functions' root of self-weight buckling, ρA g L³ / EI.
GREENHILL = 7.837347438943484


def test_a_column_under_its_own_weight() -> None:
    still = float(spectral_modes(UNIT, CANTILEVER, 1).angular_frequency[0])
    for missing in (1e-3, 1e-6, 1e-10):
        load = Load(gravity=(-GREENHILL * (1.0 - missing), 0.0))
        near = float(spectral_modes(UNIT, CANTILEVER, 1, load).angular_frequency[0])
        # ω² is nearly a straight line in g down to zero.
        assert (near / still) ** 2 / missing == pytest.approx(1.005, rel=0.01)
    beyond = Load(gravity=(-GREENHILL * (1.0 + 1e-10), 0.0))
    with pytest.raises(ValueError, match=r"^load must not buckle the straight beam, got Load\(.*gravity"):
        spectral_modes(UNIT, CANTILEVER, 1, beyond)


# --- The reference: power series in many digits ----------------------------------------------------------


def state_at_the_tip(start: Any, tension: Any, square: Any) -> Any:
    """Return w, w', w'', w''' at 1 of  w'''' - (T w')' - ω² w = 0  from those at 0, T given by its series."""
    a = [start[0], start[1], start[2] / 2, start[3] / 6]
    smallest = mp.mpf(10) ** (-mp.mp.dps - 5)
    for n in range(30 * mp.mp.dps):
        pulled = sum(c * (n + 2 - k) * a[n + 2 - k] for k, c in enumerate(tension) if n + 2 > k)
        a.append((square * a[n] + (n + 1) * pulled) / ((n + 4) * (n + 3) * (n + 2) * (n + 1)))
        if n > 30 and max(abs(value) for value in a[-4:]) < smallest:
            return mp.polyval(a[::-1], 1, derivative=True) + _second_and_third(a)
    raise AssertionError("the series does not converge")


def _second_and_third(a: Any) -> Any:
    return tuple(
        mp.fsum(math.perm(n, order) * value for n, value in enumerate(a) if n >= order) for order in (2, 3)
    )


def determinant(omega: Any, load: Load, pair: Boundary) -> Any:
    """Return what vanishes at a flap frequency of the unit beam, ends' springs and bodies and all.

    Left: w'' = (K_r + c) w' - ω² turning,  w''' - T w' = -K_t w + ω² lifting;  right with the signs changed.
    """
    square, spin2 = omega**2, mp.mpf(load.spin_rate) ** 2
    hub, gravity = mp.mpf(load.hub_radius), mp.mpf(load.weight[0])

    def body(end: End, at: int, outward: int) -> tuple[Any, Any, Any, Any]:
        mass, inertia, offset = (mp.mpf(float(number)) for number in end.moving_body)
        arm = outward * offset
        pull = mass * (gravity + spin2 * (hub + at + arm))
        return mass, arm, pull, arm * pull + (spin2 - square) * inertia

    tip = load.axial_force + load.tip[0] + body(pair.right, 1, 1)[2]
    tension = [tip + gravity + spin2 * (hub + 0.5), -gravity - spin2 * hub, -spin2 / 2]
    mass, arm, _, turning = body(pair.left, 0, -1)

    def left(w: Any, slope: Any) -> Any:
        end = pair.left
        shear = (
            0
            if end.holds_deflection
            else -end.translational_stiffness * w + square * mass * (w + arm * slope)
        )
        couple = 0 if end.holds_rotation else (end.rotational_stiffness + turning) * slope
        couple -= square * mass * arm * (w + arm * slope)
        return [w, slope, couple, shear + tension[0] * slope]

    end, rows = pair.left, []
    one = [0, 0, 0, 1] if end.holds_deflection else left(1, 0)
    other = [0, 0, 1, 0] if end.holds_rotation else left(0, 1)
    mass, arm, _, turning = body(pair.right, 1, 1)
    for start in (one, other):
        w, slope, second, third = state_at_the_tip([mp.mpf(value) for value in start], tension, square)
        centre, end = square * mass * (w + arm * slope), pair.right
        couple = (
            second + (end.rotational_stiffness + turning) * slope - arm * centre
            if not end.holds_rotation
            else slope
        )
        shear = third - tip * slope - end.translational_stiffness * w + centre
        rows.append((w if end.holds_deflection else shear, couple))
    (a, b), (c, d) = rows
    return a * d - b * c


def error(omega: float, load: Load, pair: Boundary, digits: int = 40) -> float:
    """Return the relative distance of a flap frequency from the nearest root: the step of Newton's."""
    with mp.workdps(digits):
        place, small = mp.mpf(omega), mp.mpf(10) ** -16
        here = determinant(place, load, pair)
        return abs(float(small * here / (determinant(place * (1 + small), load, pair) - here)))


def largest_error(load: Load, pair: Boundary, modes: int = 5) -> float:
    omega = spectral_modes(UNIT, pair, modes, load).angular_frequency
    assert np.all(np.diff(omega) > 0.0)
    return max(error(one, load, pair) for one in omega.tolist())


def test_the_reference_knows_the_published_roots() -> None:
    for spin, radius in ((2.0, 0.0), (12.0, 1.0)):
        load = Load(spin_rate=spin, hub_radius=radius)
        assert max(error(one, load, CANTILEVER) for one in ROTATING[spin, radius][0]) < 1e-15


@pytest.mark.parametrize("mass", [0.1, 1.0, 50.0])
def test_rotating_cantilever_with_a_tip_mass(mass: float) -> None:
    """w''' - Ω² μ (1 + δ) w' + μ ω² w = 0 at the tip, μ its mass and δ the hub's radius."""
    pair = Boundary(ENDS["clamped"], End(mass=mass))
    assert largest_error(Load(spin_rate=6.0, hub_radius=0.5), pair) < 5e-14


@pytest.mark.parametrize("gravity", [-7.8, -1.0, 3.0, 1e3])
def test_hanging_and_standing_beams(gravity: float) -> None:
    for boundary in ("clamped-free", "clamped-pinned"):
        margin = 1.0 + gravity / GREENHILL if boundary == "clamped-free" else 1.0
        assert largest_error(Load(gravity=(gravity, 0.0)), Boundary.of(boundary)) < 5e-14 / min(margin, 1.0)


SPRUNG = Boundary(End(40.0, 30.0, 0.3, 0.02, 0.2), End(0.0, 0.0, 0.5, 0.03, 0.15))
INWARD = Boundary(End(4000.0, 30.0, 0.3, 0.02, -0.2), End(5.0, 1.0, 0.5, 0.03, -0.15))
PENDULUM = Boundary(End(HELD, 0.0, 2.0, 0.1, 0.1), End(0.0, 0.0, 0.7, 0.01, 0.3))
SPIN = Load(spin_rate=7.0, hub_radius=0.4)
ALL = Load(-3.0, 5.0, 0.3, gravity=(4.0, 0.0), tip_force=(-1.5, 0.0))


@pytest.mark.parametrize("pair", [SPRUNG, INWARD, PENDULUM], ids=["outward", "inward", "pendulum"])
@pytest.mark.parametrize("load", [SPIN, ALL, Load(gravity=(9.81, 0.0))], ids=["spin", "all", "gravity"])
def test_ends_with_springs_and_bodies(pair: Boundary, load: Load) -> None:
    assert largest_error(load, pair, 4) < 5e-14


@pytest.mark.parametrize("boundary", ["guided-free", "clamped-clamped", "pinned-guided"])
def test_plain_ends(boundary: str) -> None:
    pair = Boundary.of(boundary)
    assert largest_error(Load(2.0, 9.0, 0.2, gravity=(-3.0, 0.0)), pair, 4) < 5e-14


def test_a_tip_force_along_the_beam_is_an_axial_force() -> None:
    for force in (5.0, -1.2):
        one = spectral_modes(UNIT, CANTILEVER, 4, Load(tip_force=(force, 0.0))).angular_frequency
        other = euler_bernoulli(UNIT, CANTILEVER, 4, load=Load(force)).angular_frequency
        assert np.abs(one / other - 1.0).max() < 1e-13


@pytest.mark.slow
def test_a_fast_rotor() -> None:
    """At Ω = 1000 √(EI/ρAL⁴) bending matters in a layer of a thousandth of the length only.

    Reached: 6e-15, and 3e-12 for the first frequency of lag, whose square is 2e-3 of flap's.
    """
    load = Load(spin_rate=1000.0)
    flap = spectral_modes(UNIT, CANTILEVER, 10, load).angular_frequency
    assert max(error(flap[n], load, CANTILEVER, 900) for n in (0, 9)) < 1e-13
    lag = spectral_modes(UNIT, CANTILEVER, 10, Load(spin_rate=1000.0, plane="lag")).angular_frequency
    # From flap's root by the series above with 900 digits, less Ω².
    assert lag[0] == pytest.approx(46.0887517489525294, rel=2e-11)
    assert np.abs(lag[1:] ** 2 / (flap[1:] ** 2 - 1e6) - 1.0).max() < 1e-13
    # A string without stiffness, ω² = Ω² n (2n - 1), and the root's layer.
    n = np.arange(1, 4)
    assert np.allclose(flap[:3] / 1000.0, np.sqrt(n * (2 * n - 1)), rtol=2e-3)


# --- Identities ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("spin", [1e-3, 1.0, 30.0, 1e3])
def test_a_hinge_on_the_axis_lets_the_beam_flap_as_fast_as_it_turns(spin: float) -> None:
    tapered = Beam(1.4, lambda x: (1.0 - x / 2) ** 3, lambda x: 1.0 - x / 2)
    for beam, tip in (
        (UNIT, ENDS["free"]),
        (tapered, ENDS["free"]),
        (tapered, End(0.0, 0.0, 0.4, 0.02, 0.3)),
    ):
        ends = Boundary(ENDS["pinned"], tip)
        found = spectral_modes(beam, ends, 2, Load(spin_rate=spin))
        assert found.angular_frequency[0] == pytest.approx(spin, rel=1e-13)
        assert found.rigid_body_modes == 0


def test_a_hinge_away_from_the_axis_lets_the_beam_lag() -> None:
    """A rigid blade: ω² = Ω² e S / I, S and I its moments about the hinge; here Ω² 3 e / 2 L."""
    lag = spectral_modes(UNIT, "pinned-free", 1, Load(spin_rate=1e-3, hub_radius=0.2, plane="lag"))
    assert lag.angular_frequency[0] == pytest.approx(1e-3 * math.sqrt(0.3), rel=1e-6)


@pytest.mark.parametrize("pair", [CANTILEVER, SPRUNG, INWARD], ids=["clamped-free", "outward", "inward"])
def test_lag_and_flap_differ_by_the_spin(pair: Boundary) -> None:
    flap, lag = (
        spectral_modes(UNIT, pair, 6, Load(spin_rate=3.0, hub_radius=0.1, plane=plane))
        for plane in ("flap", "lag")
    )
    assert np.allclose(flap.angular_frequency**2 - lag.angular_frequency**2, 9.0, rtol=0.0, atol=1e-8)
    x = np.linspace(0.0, 1.0, 7)
    assert np.array_equal(flap.shape(x), lag.shape(x))


def test_a_rigid_pendulum() -> None:
    """ω² = g S / I of a stiff bob on a stiff rod: S = 1/2 + m (1 + a), I = 1/3 + m (1 + a)² + J."""
    bob = End(0.0, 0.0, 0.7, 0.01, 0.3)
    found = spectral_modes(UNIT, ("pinned", bob), 1, Load(gravity=(1e-7, 0.0))).angular_frequency[0]
    exact = 1e-7 * (0.5 + 0.7 * 1.3) / (1.0 / 3.0 + 0.7 * 1.69 + 0.01)
    assert found**2 == pytest.approx(exact, rel=1e-6)


# --- Chains ----------------------------------------------------------------------------------------------

STEPS = Beam(1.3, Table((0.0, 0.65, 0.65, 1.3), (9.0, 9.0, 5.0, 5.0)), 0.6)
LAG = Load(spin_rate=5.0, hub_radius=0.4, plane="lag")
CHAINS = {
    "flap": (UNIT, CANTILEVER, SPIN, "mitiguy"),
    "lag": (UNIT, Boundary.of("pinned-free"), LAG, "gregory"),
    "outward bodies": (STEPS, SPRUNG, SPIN, "mitiguy"),
    "inward bodies": (STEPS, INWARD, LAG, "hencky"),
    "hanging": (UNIT, INWARD, Load(gravity=(30.0, 0.0)), "gregory"),
    "standing": (UNIT, Boundary.of("clamped-pinned"), Load(gravity=(-2.5, 0.0)), "hencky"),
    "all": (STEPS, Boundary(ENDS["clamped"], End(0.0, 0.0, 0.4, 0.03, -0.35)), ALL, "mitiguy"),
    "guided": (UNIT, Boundary.of("guided-free"), SPIN, "hencky"),
}


@pytest.mark.parametrize("case", CHAINS)
def test_chains_come_to_the_beam_as_their_order_says(case: str) -> None:
    beam, pair, load, rule = CHAINS[case]
    exact = spectral_modes(beam, pair, 3, load).angular_frequency
    wrong = np.array(
        [
            solve_modes(linearize(Chain(beam, pair, n, rule), load=load), 3).angular_frequency / exact - 1.0
            for n in (40, 80, 160)
        ]
    )
    assert np.abs((4.0 * wrong[2] - wrong[1]) / 3.0).max() < 1e-6
    assert np.abs(np.log2(wrong[1] / wrong[2]) - 2.0).max() < 0.05


# --- What is refused -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("boundary", "load", "message"),
    [
        ("clamped-free", Load(gravity=9.81), "load must leave the straight beam in equilibrium"),
        ("clamped-free", Load(tip_force=1.0), "load must leave the straight beam in equilibrium"),
        ("clamped-free", Load(tip_moment=1.0), "load must leave the straight beam in equilibrium"),
        ("free-clamped", Load(spin_rate=1.0), "boundary must tie the left end to the ground or hub"),
        ("free-free", Load(gravity=(1.0, 0.0)), "boundary must tie the left end to the ground or hub"),
        ("pinned-free", Load(gravity=(-1e-9, 0.0)), "load must not buckle the straight beam"),
        ("clamped-free", Load(tip_force=(-2.5, 0.0)), "load must not buckle the straight beam"),
        ("pinned-free", Load(spin_rate=1.0, plane="lag"), "spin_rate must be lower for pinned-free"),
        ("guided-free", Load(spin_rate=1.0, hub_radius=2.0, plane="lag"), "spin_rate must be lower"),
        ((End(4.0, HELD), "free"), Load(spin_rate=9.0, plane="lag"), "spin_rate must be lower"),
        ("clamped-free", Load(spin_rate=1e200), "load must not leave the range of floating-point numbers"),
        ("clamped-free", Load(spin_rate=1.0, hub_radius=1e308, gravity=(1e308, 0.0)), "load must not leave"),
    ],
)
def test_loads_that_no_straight_beam_bears(boundary: Any, load: Load, message: str) -> None:
    for call in (spectral_modes, lambda *given: euler_bernoulli(*given[:3], load=given[3])):
        with pytest.raises(ValueError, match=f"^{message}"):
            call(UNIT, boundary, 1, load)


def test_rotary_inertia_hangs_but_does_not_spin() -> None:
    beam = Beam(1.0, 1.0, 1.0, 0.01)
    slow = spectral_modes(beam, CANTILEVER, 3, Load(gravity=(2.0, 0.0))).angular_frequency
    assert np.all(slow < spectral_modes(UNIT, CANTILEVER, 3, Load(gravity=(2.0, 0.0))).angular_frequency)
    with pytest.raises(ValueError, match=r"^beam must have no rotary_inertia_per_length on a turning hub"):
        spectral_modes(beam, CANTILEVER, 1, Load(spin_rate=1.0))


def test_the_one_door_opens_to_this_beam() -> None:
    for load, own in ((SPIN, True), (Load(gravity=(1.0, 0.0)), True), (Load(2.0), False), (None, False)):
        found = euler_bernoulli(UNIT, CANTILEVER, 2, load=load)
        assert isinstance(found, SpectralBeamModes) is own
