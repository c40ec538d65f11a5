"""Drawings of chains: any chain, in any place, whole and inside the picture, with its springs as labels."""

from __future__ import annotations

import math
import warnings
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import xarray
from computed_studies import computed
from drawn_ends import RULES_DRAWN
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon
from matplotlib.text import Text
from random_structures import structure
from shared_cases import WIRE

import beammodes as bm
from beammodes.views.schematic import pose_of, spring_texts, support_texts
from beammodes.views.schematic_of_structures import hinge_texts, pose_of_structure
from beammodes.views.symbols import GROUND_SPRING, SPRING, body_of
from studies import schematics

UNIT = bm.Beam.unit()
BLOCK = bm.End(mass=1.0, rotary_inertia=0.2**2 / 6, offset=0.1)


def drawn(chain: bm.Chain, **arguments: Any) -> Axes:
    figure = Figure()
    ax = figure.subplots()
    bm.draw_chain(chain, ax, **arguments)
    figure.draw_without_rendering()
    return ax


def artists(ax: Axes) -> list[Artist]:
    return [*ax.lines, *ax.patches, *ax.collections, *ax.texts]


def points_of(artist: Artist) -> np.ndarray:
    """The data that an artist draws, whatever kind it is."""
    if isinstance(artist, Line2D):
        return artist.get_xydata()
    if isinstance(artist, LineCollection):
        return np.concatenate(artist.get_segments())
    if isinstance(artist, Text):
        return np.array([artist.get_position()])
    assert isinstance(artist, Circle | Polygon)
    return artist.get_patch_transform().transform_path(artist.get_path()).vertices


def check_whole(ax: Axes) -> None:
    frame = ax.get_window_extent()
    assert ax.get_aspect() == 1.0 and not ax.axison
    for artist in artists(ax):
        points = points_of(artist)
        assert np.isfinite(points).all()
        written = isinstance(artist, Text)
        box = artist.get_window_extent().get_points() if written else ax.transData.transform(points)
        (left, low), (right, high) = box.min(axis=0), box.max(axis=0)
        # Half a pixel of rounding.
        assert frame.x0 - 0.5 < left <= right < frame.x1 + 0.5, artist
        assert frame.y0 - 0.5 < low <= high < frame.y1 + 0.5, artist


def hinges(ax: Axes) -> list[Circle]:
    return [patch for patch in ax.patches if patch.get_gid() == "hinge"]


def words(ax: Axes, colour: str = SPRING) -> list[str]:
    return [text.get_text() for text in ax.texts if text.get_color() == colour]


stiffness = st.sampled_from([0.0, math.inf]) | st.floats(0.01, 1e4)
ends = st.builds(
    bm.End,
    stiffness,
    stiffness,
    st.sampled_from([0.0, 0.3, 40.0]),
    st.sampled_from([0.0, 0.002, 3.0]),
    st.sampled_from([0.0, 0.15, -0.1, 5.0]),
)


def made(left: bm.End, right: bm.End, rule: str, segments: int, length: float = 1.0) -> bm.Chain | None:
    try:
        return bm.Chain(bm.Beam(length, 1.0, 1.0), (left, right), segments, rule)
    except ValueError:
        # Gregory's springs next to another end's, or a body that no rod can turn with.
        return None


@settings(max_examples=25, suppress_health_check=list(HealthCheck))
@given(ends, ends, st.sampled_from(RULES_DRAWN), st.integers(1, 12), st.sampled_from([1e-3, 1.0, 40.0]))
def test_any_chain_is_drawn_whole(
    left: bm.End, right: bm.End, rule: str, segments: int, length: float
) -> None:
    chain = made(left, right, rule, segments, length)
    if chain is None:
        return
    ax = drawn(chain)
    check_whole(ax)
    assert len(hinges(ax)) == len(chain.joint_stiffness)
    centres = np.array([circle.center for circle in hinges(ax)]).reshape(-1, 2)
    np.testing.assert_allclose(centres[:, 0], chain.hinge_position, atol=1e-12 * length)
    for text, spring in zip(words(ax)[: len(hinges(ax))], chain.joint_stiffness, strict=False):
        if len(chain.joint_stiffness) <= 12:
            assert float(Fraction(text)) * segments / length == pytest.approx(spring, rel=5e-4)
    elastic = [k for k in chain.support_stiffness.ravel() if 0 < k < math.inf]
    assert len(words(ax, GROUND_SPRING)) == len(elastic)


@settings(max_examples=20, suppress_health_check=list(HealthCheck))
@given(ends, ends, st.sampled_from(RULES_DRAWN), st.integers(1, 12), st.integers(1, 12))
def test_any_mode_is_drawn_whole(left: bm.End, right: bm.End, rule: str, segments: int, mode: int) -> None:
    chain = made(left, right, rule, segments)
    if chain is None:
        return
    modes = bm.solve_modes(bm.linearize(chain))
    if not len(modes.frequency):
        return
    mode = min(mode, len(modes.frequency))
    ax = drawn(chain, shape=modes, mode=mode, labels=None)
    check_whole(ax)
    assert not ax.texts and len(hinges(ax)) == len(chain.joint_stiffness)
    # The drawn nodes are the mode's, but for one factor, and no higher than the amplitude.
    pose = pose_of(chain, modes, mode=mode)
    assert np.abs(pose.y).max() <= 0.15 + 1e-12
    drawn_y = np.array([circle.center[1] for circle in hinges(ax)])
    np.testing.assert_array_equal(drawn_y, pose.y[1:-1])
    largest = np.abs(modes.deflection[mode - 1]).argmax()
    np.testing.assert_allclose(
        pose.y * modes.deflection[mode - 1][largest], pose.y[largest] * modes.deflection[mode - 1], atol=1e-9
    )


def test_labels_are_the_reports() -> None:
    # Worked examples of the report, "Cantilever/Free" and "Cantilever/Cantilever" with N = 4.
    assert words(drawn(bm.Chain(UNIT, (BLOCK, "free"), 4))) == ["24/11", "1", "1", "1"]
    assert words(drawn(bm.Chain(UNIT, (BLOCK, BLOCK), 4))) == ["24/11", "1", "1", "1", "24/11"]


def test_labels_in_physical_units_and_none() -> None:
    chain = bm.Chain(bm.Beam(1.2, 85.0, 0.62), "clamped-free", 4)
    # README's example: 618.2, 283.3, 283.3, 283.3 N m/rad.
    assert words(drawn(chain, labels="N m/rad")) == ["618.2", "283.3", "283.3", "283.3"]
    assert not drawn(chain, labels=None).texts


def test_of_many_hinges_equal_neighbours_share_a_label() -> None:
    ax = drawn(bm.Chain(UNIT, "clamped-free", 30, "gregory"))
    assert words(ax) == ["8/3", "6/7", "24/23", "27 × 1"]
    assert len(hinges(ax)) == 30
    check_whole(ax)
    taper = bm.Beam(1.0, lambda x: 1 - x / 2, 1.0)
    assert words(drawn(bm.Chain(taper, "clamped-free", 80))) == []  # too many to be read


def test_supports_springs_are_in_units_of_the_beam() -> None:
    pair = (bm.End(math.inf, 8.0), bm.End(2.0, 0.0))
    chain = bm.Chain(UNIT, pair, 4, "double_wall")
    # 2 EI/ell = 8 EI/L in series with 8 EI/L.
    assert support_texts(chain) == [("", "4 EI/L"), ("2 EI/L³", "")]
    assert words(drawn(chain), GROUND_SPRING) == ["4 EI/L", "2 EI/L³"]
    steel = bm.Chain(bm.Beam(2.0, 16.0, 1.0), (bm.End(math.inf, 64.0), bm.End(4.0, 0.0)), 4, "double_wall")
    assert support_texts(steel) == [("", "4 EI/L"), ("2 EI/L³", "")]  # the same beam, in metres and newtons
    assert support_texts(steel, "N m/rad") == [("", "32 N m/rad"), ("4 N/m", "")]


def test_a_chain_from_pieces_has_the_numbers_given() -> None:
    chain = bm.Chain.from_pieces(
        length=[0.0, 1.0, 1e-6, 2.0],
        mass=[0.0, 1.0, 1.0, 3.0],
        rotary_inertia=[0.0, 0.1, 0.1, 0.3],
        joint_stiffness=[Fraction(5, 3), 2.5, 7.0],
        boundary=("clamped", bm.End(3.0, 0.0)),
    )
    ax = drawn(chain)
    check_whole(ax)
    assert words(ax) == ["5/3", "2.5", "7"]
    assert words(ax, GROUND_SPRING) == ["3"]
    assert len({circle.radius for circle in hinges(ax)}) == 1 and hinges(ax)[0].radius > 0


def test_what_is_welded_to_the_ground_is_dark() -> None:
    def rods(rule: str) -> list[tuple[float, str]]:
        found = [
            line for line in drawn(bm.Chain(UNIT, "clamped-free", 4, rule)).lines if line.get_zorder() == 3
        ]
        return [(float(np.ptp(line.get_xdata())), str(line.get_color())) for line in found]

    (whole,) = rods("mitiguy")
    assert whole[0] == 1.0
    for rule, stub in (("half_stub", 0.125), ("rigid_stub", 0.25)):
        welded, moving = rods(rule)
        assert welded[0] == pytest.approx(stub) and moving[0] == pytest.approx(1 - stub)
        assert welded[1] != moving[1] == whole[1]


def test_ends_may_be_left_out() -> None:
    chain = bm.Chain(UNIT, (BLOCK, "clamped(mass=1)"), 4)
    ax = drawn(chain, ends=False)
    assert (
        [type(patch) for patch in ax.patches]
        == [Circle] * len(chain.joint_stiffness)
        == [Circle] * len(words(ax))
    )
    assert not ax.collections


def test_point_masses_are_dots_where_a_rule_gathers_them() -> None:
    def dots(rule: str) -> int:
        patches = drawn(bm.Chain(UNIT, "pinned-pinned", 4, rule), labels=None).patches
        return sum(isinstance(patch, Circle) and patch.get_zorder() == 2 for patch in patches)

    assert dots("hencky") == 5 and dots("mitiguy") == 0


def test_a_body_is_a_block_of_its_size() -> None:
    # A square of side s and mass m has J = m s²/6.
    assert body_of(BLOCK, 1.0).half == pytest.approx(0.1)
    (block,) = [p for p in drawn(bm.Chain(UNIT, (BLOCK, "free"), 4)).patches if isinstance(p, Polygon)]
    corners = block.get_xy()
    np.testing.assert_allclose(corners.min(axis=0), [-0.2, -0.1], atol=1e-12)
    np.testing.assert_allclose(corners.max(axis=0), [0.0, 0.1], atol=1e-12)
    assert (
        body_of(bm.ENDS["clamped"], 1.0).kind == body_of(bm.End(math.inf, math.inf, 1.0), 1.0).kind == "none"
    )
    assert body_of(bm.End(mass=1.0), 1.0).kind == "dot"
    assert body_of(bm.End(rotary_inertia=1.0), 1.0).kind == "wheel"


def test_large_rotations_are_drawn_where_they_are() -> None:
    chain = bm.Chain(UNIT, "clamped-free", 20)
    rolled = bm.find_equilibrium(chain, bm.Load(tip_moment=2 * math.pi))
    ax = drawn(chain, shape=rolled, labels=None)
    check_whole(ax)
    np.testing.assert_allclose([c.center for c in hinges(ax)], rolled.position, atol=1e-12)
    motion = bm.simulate(
        chain, duration=0.1, step=1e-3, output_step=0.05, initial=bm.mode_start(chain, 1, 0.5)
    )
    moment = motion.isel(time=-1)
    ax = drawn(chain, shape=moment, labels=None)
    np.testing.assert_array_equal([c.center[1] for c in hinges(ax)], moment.y.values[1:-1])
    # A rod is as long as it is: nothing is stretched.
    np.testing.assert_allclose(np.hypot(np.diff(moment.x), np.diff(moment.y)), chain.length, atol=1e-12)


def test_limits_grow_with_a_second_drawing_and_stay_once_set() -> None:
    chain = bm.Chain(UNIT, "clamped-free", 4)
    ax = drawn(chain)
    before = ax.get_ylim()
    up = chain.node_position**2
    bm.draw_chain(chain, ax, shape=(up, np.zeros(chain.pieces)))
    assert ax.get_ylim()[1] > 1.0 > before[1]
    ax.set_ylim(-3, 3)
    bm.draw_chain(chain, ax)
    assert ax.get_ylim() == (-3, 3)


CHAIN = bm.Chain(UNIT, "clamped-free", 4)
MOTION = bm.simulate(CHAIN, duration=0.01, initial=bm.mode_start(CHAIN, 1, 0.01))


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"labels": "Nm/rad"}, ValueError, r'labels must be one of .*did you mean "N m/rad"'),
        ({"labels": 3}, TypeError, "labels must be one of"),
        ({"size": 0}, ValueError, "size must be greater than 0"),
        ({"shape": 3.0}, TypeError, "shape must be None, Modes"),
        ({"shape": (np.zeros(6), np.zeros(4))}, ValueError, "rotation of shape must hold 5 finite"),
        ({"shape": (np.zeros(5), np.zeros(5))}, ValueError, "deflection of shape must hold 6 finite"),
        ({"shape": (np.full(6, np.nan), np.zeros(5))}, ValueError, "deflection of shape must be finite"),
        (
            {"shape": (["a"] * 6, np.zeros(5))},
            TypeError,
            "deflection of shape must be an array",
        ),
        ({"shape": bm.solve_modes(bm.linearize(CHAIN)), "mode": 5}, ValueError, "mode must be .* at most 4"),
        ({"shape": bm.solve_modes(bm.linearize(CHAIN)), "mode": True}, TypeError, "mode must be"),
        ({"shape": bm.solve_modes(bm.linearize(CHAIN)), "amplitude": 0.0}, ValueError, "amplitude must be"),
        (
            {"shape": bm.solve_modes(bm.linearize(bm.Chain(UNIT, "clamped-free", 5)))},
            ValueError,
            "deflection of shape must hold 6 finite numbers for this chain",
        ),
        (
            {"shape": bm.error_dataset(boundary="clamped-free", segments=3, modes=1)},
            ValueError,
            "shape must hold x, y and angle",
        ),
        ({"shape": MOTION}, ValueError, "shape must be one moment of a motion"),
    ],
)
def test_bad_input(arguments: dict[str, Any], error: type[Exception], message: str) -> None:
    ax = Figure().subplots()
    with pytest.raises(error, match=message):
        bm.draw_chain(CHAIN, ax, **arguments)
    assert not artists(ax)


def test_what_is_no_chain_or_too_long_is_refused() -> None:
    ax = Figure().subplots()
    with pytest.raises(TypeError, match="a StructureChain or a SpatialChain, got 'clamped-free'"):
        bm.draw_chain("clamped-free", ax)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="chain must have at most 500 pieces to be drawn, got 501"):
        bm.draw_chain(bm.Chain(UNIT, "clamped-free", 500), ax)
    with pytest.raises(ValueError, match="unit must be one of"):
        spring_texts(CHAIN, "Nm")


def test_a_chain_in_space_stands_where_it_is_to_one_scale() -> None:
    helix = bm.Rod.helix(radius=0.1, pitch=0.05, turns=1, **WIRE)
    chain = bm.SpatialChain(helix, ("clamped", bm.RodEnd(mass=1.0)), 8, "gregory")
    bent = bm.spatial_equilibrium(chain, bm.SpatialLoad(force=(0.0, 1.0, 1.0)))
    modes = bm.spatial_modes(chain, 2)
    largest = np.linalg.norm(modes.displacement[1], axis=1).max()
    moved = chain.nodes + 0.1 * helix.length / largest * modes.displacement[1]
    # The first piece has no length: it is behind the hinge at the wall.
    for shape, nodes in ((None, chain.nodes), (bent, bent.nodes[1:]), (modes, moved)):
        ax: Any = bm.draw_chain(chain, shape=shape, mode=2, amplitude=0.1)
        ax.get_figure().draw_without_rendering()
        (hinges_drawn,) = [line for line in ax.lines if line.get_gid() == "hinge"]
        np.testing.assert_allclose(np.transpose(hinges_drawn.get_data_3d()), nodes[:-1], atol=1e-12)
        spans = [np.ptp(limits) for limits in (ax.get_xlim(), ax.get_ylim(), ax.get_zlim())]
        np.testing.assert_allclose(spans / ax._box_aspect, spans[0] / ax._box_aspect[0])
        assert [text.get_text() for text in ax.texts] == ["s = 0, clamped", "s = L, free + body"]
    other = bm.spatial_modes(bm.SpatialChain(helix, "clamped-free", 9), 1)
    for wrong, error in ((other, ValueError), (UNIT, TypeError)):
        with pytest.raises(error, match="shape must be"):
            bm.draw_chain(chain, shape=wrong)
    with pytest.raises(ValueError, match='ax must have the projection "3d" for a chain in space'):
        bm.draw_chain(chain, Figure().subplots())


def test_marks_across_a_blade_follow_its_twist() -> None:
    blade = bm.Rod.pretwisted(
        math.pi / 2,
        length=1.0,
        bending_stiffness=16.0,
        second_bending_stiffness=1.0,
        torsional_stiffness=1.0,
        mass_per_length=1.0,
    )
    ax: Any = bm.draw_chain(bm.SpatialChain(blade, "clamped-free", 6, "double_wall"), ends=False)
    marks = [np.diff(line.get_data_3d())[:, 0] for line in ax.lines if len(line.get_data_3d()[0]) == 2]
    angles = [math.atan2(z, y) for _, y, z in marks]
    np.testing.assert_allclose(angles, np.arange(6) * math.pi / 12, atol=1e-12)


@pytest.mark.parametrize("seed", range(6))
def test_any_structure_is_drawn_whole(seed: int) -> None:
    given = structure(seed)
    chain = bm.StructureChain(given, [3] * len(given.parts.stretches), ["gregory", "half_stub"][seed % 2])
    modes = bm.structure_chain_modes(chain, 2)
    for shape in (None, modes):
        ax = bm.draw_chain(chain, shape=shape, mode=2)
        ax.get_figure().draw_without_rendering()
        check_whole(ax)
        spirals = [line for line in ax.lines if line.get_color() == SPRING and len(line.get_xdata()) > 100]
        # Every spring once; those of supports are green.
        sprung = sum(0.0 < node.rotational_stiffness < math.inf for node in given.parts.nodes)
        assert len(chain.hinges) - sprung <= len(spirals) <= len(chain.hinges)
    # All stretches that meet at a node still meet there, and nothing is higher than the amplitude.
    pose, rest = pose_of_structure(chain, modes, mode=2), pose_of_structure(chain)
    for stretch, line in zip(given.parts.stretches, pose.stretches, strict=True):
        np.testing.assert_allclose(line[[0, -1]], pose.nodes[list(stretch.nodes)], atol=1e-9)
    moved = np.concatenate([a - b for a, b in zip(pose.stretches, rest.stretches, strict=True)])
    assert 0.0 < np.abs(moved).max() <= 0.15 * np.ptp(rest.nodes, axis=0).max() * (1 + 1e-12)


def test_the_springs_of_a_frame_and_its_sag() -> None:
    joints = {"foot": bm.Joint(0, 0, "clamped"), "corner": bm.Joint(0, 1), "tip": bm.Joint(1, 1, mass=0.2)}
    ell = bm.Structure(joints, [bm.Member(UNIT, "foot", "corner"), bm.Member(UNIT, "corner", "tip")])
    chain = bm.StructureChain(ell, [4, 4])
    # Twice 3/8 at the corner (theory.md, section 11), in order along the frame.
    texts = ["8/3", "6/7", "12/11", "6/7", "4/3", "6/7", "24/23", "1"]
    assert list(hinge_texts(chain).values()) == texts
    assert sorted(words(bm.draw_chain(chain))) == sorted(texts)
    assert float(next(iter(hinge_texts(chain, "N m/rad").values()))) == pytest.approx(4 * 8 / 3, rel=1e-3)
    pushed = bm.structure_chain_statics(chain, bm.PointLoad(joint="tip", force=(0, -0.1)))
    nodes = pose_of_structure(chain, pushed, amplitude=0.2).nodes
    # Largest at the tip: F (1/3 + 1) down by statics, F/2 along x at the corner and the tip.
    np.testing.assert_allclose(nodes, [[0, 0], [0.075, 1], [1.075, 0.8]], atol=1e-12)
    other = bm.StructureChain(ell, [4, 4])
    for wrong, error in ((bm.structure_chain_modes(other, 1), ValueError), (UNIT, TypeError)):
        with pytest.raises(error, match="shape must be"):
            bm.draw_chain(chain, shape=wrong)


@pytest.fixture(scope="module")
def gallery() -> xarray.Dataset:
    return computed("schematics")


def test_the_gallery_shows_its_chains(gallery: xarray.Dataset) -> None:
    panels = [panel for section in schematics.sections().values() for panel in section]
    rules = [panel.chain.rule.name for panel in panels[: len(bm.RULES)] if panel.chain.rule]
    assert rules == list(bm.RULES)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        figure = schematics.STUDY.picture(gallery)
        figure.draw_without_rendering()
    axes = [ax for ax in figure.axes if hinges(ax)]
    assert len(axes) == len(panels) == gallery.sizes["panel"]
    for ax, panel in zip(axes, panels, strict=True):
        check_whole(ax)
        assert len(hinges(ax)) == len(panel.chain.joint_stiffness)
    # README states each rule's order.
    for ax, rule in zip(axes, bm.RULES, strict=False):
        assert ax.get_title("left") == rule
        assert ax.get_title("right") == f"order {bm.error_law('clamped-free', 1, rule).order}"
