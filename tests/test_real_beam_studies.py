"""Figures 2, 3 and 5: chains between rigid bodies against the exact beam and against rigid-body mechanics."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import xarray
from computed_studies import computed

import beammodes as bm
from studies import every_study, figures_3_and_5, truck, truck_frame

#: A beam on free bodies, and between walls instead.
BLOCKS = {
    "figure_3": (figures_3_and_5.ONE_BODY, "clamped-free"),
    "figure_5": (figures_3_and_5.TWO_BODIES, "clamped-clamped"),
}
#: Order of each rule; theory.md section 4 has them for free vibration with end bodies too.
ORDERS = {"mitiguy": 2, "gregory": 4}


@pytest.fixture(scope="module")
def tables() -> dict[str, xarray.Dataset]:
    return {name: computed(name) for name in (*BLOCKS, "truck")}


def test_blocks_are_square_and_as_heavy_as_the_beam() -> None:
    body, side = figures_3_and_5.BODY, figures_3_and_5.SIDE
    assert (body.mass, body.offset) == (1.0, side / 2)
    assert body.rotary_inertia == pytest.approx(body.mass * (side**2 + side**2) / 12)


@pytest.mark.parametrize("name", BLOCKS)
def test_blocks(tables: dict[str, xarray.Dataset], name: str) -> None:
    table, (bodies, walls) = tables[name], BLOCKS[name]
    sizes = {"held_by": 2, "rule": 2, "segments": 20, "mode": 3, "x": 201}
    assert sizes.items() <= dict(table.sizes).items()
    for held_by, pair in (("free body", bodies), ("fixed wall", walls)):
        exact = bm.euler_bernoulli(bm.Beam.unit(), pair, 3)
        here = table.sel(held_by=held_by)
        shown = here.exact_angular_frequency.sel(segments=20, rule="mitiguy")
        np.testing.assert_allclose(shown, exact.angular_frequency, rtol=1e-12)
        for rule in ORDERS:
            chain = bm.Chain(bm.Beam.unit(), pair, 4, rule)
            solved = bm.solve_modes(bm.linearize(chain), 3).angular_frequency
            np.testing.assert_allclose(
                here.relative_error.sel(rule=rule, segments=4)[: len(solved)],
                solved / exact.angular_frequency[: len(solved)] - 1,
                atol=1e-11,
            )
    # The drawn chain errs as the table says, and no drawn node is far from the exact beam in mode 1.
    drawn = (table.frequency / table.exact_frequency - 1).values
    tabled = table.relative_error.sel(held_by="free body", rule="mitiguy", segments=4)
    np.testing.assert_allclose(drawn, tabled, atol=1e-11)
    apart = np.abs(table.deflection - table.exact_deflection).max("node").values
    assert apart[0] < 0.06
    assert np.abs(table.curve).max("x").values == pytest.approx(np.ones(3))


def test_springs_are_the_reports(tables: dict[str, xarray.Dataset]) -> None:
    # Worked examples of the report, "Cantilever/Free" and "Cantilever/Cantilever" with N = 4.
    inside = ["1"] * 3
    for name, springs in (("figure_3", ["24/11", *inside]), ("figure_5", ["24/11", *inside, "24/11"])):
        system = every_study()[name].picture(tables[name]).axes[0]
        assert [text.get_text() for text in system.texts][: len(springs)] == springs


@pytest.mark.parametrize("name", BLOCKS)
def test_errors_of_the_reports_springs_follow_from_the_moment_at_the_blocks(name: str) -> None:
    """Its sum misses ∫M² by -h² (M² + M M')/6 at each block, M' inwards; ∫M² = ω² and e = -½ of the ratio."""
    pair = BLOCKS[name][0]
    exact = bm.euler_bernoulli(bm.Beam.unit(), pair, 3)
    coefficient = np.zeros(3)
    for x, inward in ((0.0, 1), (1.0, -1)):
        moment, change = (exact.shape([x], derivative=k)[:, 0] for k in (2, 3))
        coefficient += (moment**2 + inward * moment * change) / (12 * exact.angular_frequency**2)
    # A free tip has no moment and adds nothing.
    mode = np.arange(1, 4)
    count = np.array([[200], [400]])
    short, long = count**2 * np.asarray(bm.frequency_error(pair, segments=count, mode=mode))
    np.testing.assert_allclose(long + (long - short) / 3, coefficient, rtol=1e-3, atol=1e-4)
    # Modes 1 and 2 are too stiff with these blocks, where walls make every mode too soft.
    assert (coefficient[:2] > 0).all()
    assert np.all(bm.frequency_error(BLOCKS[name][1], segments=200, mode=mode) < 0)


@pytest.mark.parametrize("name", BLOCKS)
@pytest.mark.parametrize(("rule", "order"), ORDERS.items())
def test_errors_fall_at_the_rules_order(name: str, rule: str, order: int) -> None:
    """Then e N^order is a smooth function of 1/N, so three chains foretell a longer one."""
    count = np.array([40, 80, 160, 320])[:, None]
    error = np.asarray(bm.frequency_error(BLOCKS[name][0], segments=count, mode=[1, 2, 3], rule=rule))
    scaled = error * count.astype(float) ** order
    parabola = np.polyfit(1 / count[:3, 0], scaled[:3], 2)
    foretold = parabola.T @ (1 / 320.0) ** np.arange(2, -1, -1)
    assert (np.abs(foretold - scaled[3]) < 0.01 * np.abs(scaled).max(axis=0)).all()
    assert (np.abs(error[3]) < 1e-4 / 2 ** (5 * (order - 2))).all()


def rigid_truck() -> tuple[float, float]:
    """Frequencies [Hz] of one rigid body on two springs, from parallel axes and the 2 by 2 determinant."""
    bed, bed_mass = truck.BED, truck.BED.mean_mass_per_length * truck.BED.length
    parts = [  # mass, place, inertia about its own centre
        (truck.CAB_MASS, -truck.FRONT.offset, truck.FRONT.rotary_inertia),
        (truck.LOAD_MASS, bed.length + truck.REAR.offset, truck.REAR.rotary_inertia),
        (bed_mass, bed.length / 2, bed_mass * bed.length**2 / 12),
    ]
    mass = sum(m for m, _, _ in parts)
    centre = sum(m * x for m, x, _ in parts) / mass
    inertia = sum(j + m * (x - centre) ** 2 for m, x, j in parts)
    springs = [(truck.FRONT.translational_stiffness, 0.0), (truck.REAR.translational_stiffness, bed.length)]
    # ½ Σ k (y + (x - centre) θ)²: the entries of K for y and θ, each over its mass or inertia.
    direct = sum(k for k, _ in springs) / mass
    turning = sum(k * (x - centre) ** 2 for k, x in springs) / inertia
    coupling = sum(k * (x - centre) for k, x in springs) ** 2 / (mass * inertia)
    half, root = (direct + turning) / 2, math.hypot((direct - turning) / 2, math.sqrt(coupling))
    return math.sqrt(half - root) / (2 * math.pi), math.sqrt(half + root) / (2 * math.pi)


def test_truck_with_a_rigid_bed_is_a_rigid_body_on_two_springs(tables: dict[str, xarray.Dataset]) -> None:
    rigid = tables["truck"].sel(bed="rigid")
    # The bed's give lowers them by some (pitch / bending)² = (1.9 / 830)².
    for found in (rigid.frequency, rigid.exact_frequency):
        assert found[:2].values == pytest.approx(rigid_truck(), rel=1e-5)
    assert (rigid.frequency[2:] > 500).all()


def test_truck(tables: dict[str, xarray.Dataset]) -> None:
    table = tables["truck"]
    assert {"bed": 2, "mode": 4, "node": truck.SEGMENTS + 3, "piece": truck.SEGMENTS + 2}.items() <= dict(
        table.sizes
    ).items()
    flexible = table.sel(bed="flexible")
    exact = bm.euler_bernoulli(truck.BED, (truck.FRONT, truck.REAR), 4).frequency
    np.testing.assert_allclose(flexible.exact_frequency, exact, rtol=1e-12)
    chain = bm.Chain(truck.BED, (truck.FRONT, truck.REAR), truck.SEGMENTS, "mitiguy")
    solved = bm.solve_modes(bm.linearize(chain)).frequency[:4]
    np.testing.assert_allclose(flexible.relative_error, solved / exact - 1, atol=1e-11)
    assert (np.abs(flexible.relative_error) < [1e-3, 1e-3, 0.01, 0.03]).all()
    # A bed that gives lowers every frequency, and bends well above what the springs do.
    assert (flexible.exact_frequency[:2].values < rigid_truck()).all()
    assert 6 < exact[2] < 12 < exact[3]
    assert exact[2] > 4 * exact[1]
    # In heave both ends go the same way, in pitch opposite ways.
    ends = flexible.curve.isel(x=[0, -1]).prod("x")
    assert (np.sign(ends[:2]) == [1, -1]).all()
    # I of a channel 200 x 70 x 6 mm from its rectangles.
    second_moment = 0.006 * 0.188**3 / 12 + 2 * (0.07 * 0.006**3 / 12 + 0.07 * 0.006 * 0.097**2)
    assert truck.BED.bending_stiffness == pytest.approx(2 * 210e9 * second_moment, rel=5e-3)


def test_truck_with_axles_inside_and_a_rigid_bed_is_a_rigid_body_on_two_springs() -> None:
    table = computed("truck_frame")
    bare, load = truck.BED.mean_mass_per_length * truck_frame.LENGTH, truck_frame.SAND
    parts = [(bare, 0.0, truck_frame.LENGTH), (truck.CAB_MASS, truck_frame.CAB, truck_frame.CAB)]
    parts.append((load * (truck_frame.LENGTH - truck_frame.LOADED), truck_frame.LOADED, truck_frame.LENGTH))
    mass = np.zeros((2, 2))
    mass[1, 1] = truck.FRONT.rotary_inertia
    for m, start, stop in parts:
        middle = (start + stop) / 2
        mass += m * np.array([[1.0, middle], [middle, middle**2 + (stop - start) ** 2 / 12]])
    springs = zip(truck_frame.AXLES, truck_frame.SPRINGS, strict=True)
    stiffness = sum(k * np.array([[1.0, x], [x, x**2]]) for x, k in springs)
    omega = np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real))
    np.testing.assert_allclose(table.rigid_bed_frequency[:2], omega / (2 * math.pi), rtol=1e-5)
    assert (table.exact_frequency[:2] < table.rigid_bed_frequency[:2]).all()
    # With the rule at every node the bending modes err least.
    error = np.abs(table.relative_error.sel(mode=[3, 4]))
    best = error.sel(rule="gregory", applied_at="every node")
    assert (best * 3 < error.sel(rule="gregory", applied_at="ends only")).all()
    assert (best * 3 < error.sel(rule="mitiguy", applied_at="every node")).all()
    apart = np.abs(table.deflection - table.curve.interp(x=table.position)).max("node")
    # What theory.md, section 11, says of one segment on a short stretch.
    given = truck_frame.truck(truck.BED.mean_bending_stiffness)
    spoilt = bm.chain_errors(bm.StructureChain(given, [3, 1, 4, 8, 4], "gregory"), 4)[3]
    page = (Path(bm.__file__).parent / "pages" / "theory.md").read_text("utf-8")
    assert f"a truck's fourth mode by {-100 * spoilt:.1f} % with {3 + 1 + 4 + 8 + 4} segments" in page
    assert (apart[:2] < 1e-3).all() and apart.max() < 0.07
