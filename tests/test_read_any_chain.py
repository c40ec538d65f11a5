"""Chains of MJCF as people may write them, drawn at random: what is read has MuJoCo's own frequencies."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_read_mjcf import mujoco_frequencies, world, write

from beammodes.auditing.audit_model import audit_file
from beammodes.problem.beam import Beam

SOLIDS = (
    '<geom type="capsule" fromto="{near} 0 0 {far} 0 0" size="0.005" density="3000"/>',
    '<geom type="box" size="{half} 0.01 0.004" pos="{middle} 0 0"/>',
    '<geom type="cylinder" fromto="{near} 0 0 {far} 0 0" size="0.006" mass="0.05"/>',
    '<inertial pos="{middle} 0 0" mass="0.04" diaginertia="1e-6 4e-5 4e-5"/><geom size="0.1"/>',
    '<geom size="0.01" pos="{far} 0 0"/><body pos="{middle} 0 0" euler="0 90 0">'
    '<geom type="cylinder" size="0.005 {half}"/></body>',
)
# What carries the first hinge: nothing that moves, or a hub on these joints.
ROOTS = (
    "",
    "<freejoint/>",
    '<joint axis="0 1 0"/>',
    '<joint axis="0 1 0" stiffness="30"/>',
    '<joint type="slide" axis="0 0 1"/>',
    '<joint type="slide" axis="0 0 1" stiffness="40"/><joint axis="0 1 0"/>',
    '<joint type="slide" axis="0 0 -1" stiffness="40"/><joint axis="0 -1 0" stiffness="12"/>',
)
HUBS = (
    '<geom size="0.02" mass="0.1"/>',
    '<geom type="box" size="0.05 0.01 0.01" pos="0.05 0 0"/>',
    '<inertial pos="0.03 0 0" mass="0.1" diaginertia="1e-4 1e-4 1e-4"/>',
)
TURNS = ("", 'euler="0 0 40"', 'euler="90 0 0"', 'euler="10 20 30" pos="1 2 3"')
#: Length, how far the body's frame is past its hinge, spring, solid.
PIECES = st.tuples(
    st.sampled_from([0.1, 0.1, 0.07, 0.13]),
    st.sampled_from([0.0, 0.0, 0.02, -0.03]),
    st.floats(50.0, 400.0),
    st.sampled_from(SOLIDS),
)


def chain(pieces: list[tuple[float, float, float, str]], start: float) -> str:
    """Bodies inside each other, the first hinge at `start`."""
    text = ""
    for i in reversed(range(len(pieces))):
        length, past, stiffness, solid = pieces[i]
        before = pieces[i - 1][0] - pieces[i - 1][1] if i else start
        ends = {"near": -past, "far": length - past, "middle": length / 2 - past, "half": length / 2}
        hinge = f'<joint axis="0 1 0" pos="{-past} 0 0" stiffness="{stiffness}"/>'
        text = f'<body pos="{before + past} 0 0">{hinge}{solid.format(**ends)}{text}</body>'
    return text


@given(
    st.lists(PIECES, min_size=2, max_size=6),
    st.sampled_from([0.05, 0.1]),
    *map(st.sampled_from, (ROOTS, HUBS, TURNS)),
    st.sampled_from([0.37, 0.5, 0.8]),
)
@settings(max_examples=80)
def test_any_chain_has_the_frequencies_of_mujoco(
    tmp_path_factory: pytest.TempPathFactory,
    pieces: list[tuple[float, float, float, str]],
    start: float,
    root: str,
    hub: str,
    turn: str,
    length: float,
) -> None:
    text = world(f"<body {turn}>{root}{hub}{chain(pieces, start)}</body>")
    known = mujoco_frequencies(text)
    # The beam's length suggests where outer pieces end, but must not move a frequency.
    found = audit_file(write(tmp_path_factory.mktemp("any"), text), Beam(length, 20.0, 0.5), modes=12)
    read = found.angular_frequency[np.isfinite(found.angular_frequency)]
    np.testing.assert_allclose(read, known, rtol=1e-6)
