"""The study of simulators' layouts: its errors against the rules, other routes and MuJoCo itself."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import scipy.linalg
import xarray
from computed_studies import computed

import beammodes as bm

pytest.importorskip("skfem")

from studies import simulators
from studies.tool_layouts import adams_link_errors, flex_errors, tools

# theory.md section 5: percent in mode 1 at N = 10, and the order.
KNOWN = {
    "MuJoCo 3 cable": (11.1, 1),
    "URDF or SDF by hand": (-9.11, 1),
    "Hencky bar chain": (-0.84, 2),
    "Simscape, Modelica": (0.230, 2),
    "Working Model": (-0.126, 2),
}


def ruled() -> dict[str, Any]:
    return {tool.name: tool.springs for tool in tools() if tool.springs}


@pytest.fixture(scope="module")
def table() -> xarray.Dataset:
    return computed("simulators")


def test_as_it_is_against_physics(table: xarray.Dataset) -> None:
    assert set(ruled()) == set(KNOWN)
    for tool in (tool for tool in tools() if tool.name in KNOWN):
        error = 100 * float(table.relative_error.sel(tool=tool.name, version="as is", segments=10))
        percent, order = KNOWN[tool.name]
        assert error == pytest.approx(percent, rel=5e-3)
        assert tool.orders[0] == order
    worst = abs(table.relative_error.sel(version="as is", segments=10)).values
    assert (np.diff(worst) < 0).all()


def test_errors_of_rules_are_those_of_the_library(table: xarray.Dataset) -> None:
    count = table.segments.values
    for name, rules in ruled().items():
        for version, rule in zip(simulators.VERSIONS, rules, strict=True):
            library = bm.frequency_error("clamped-free", segments=count, mode=1, rule=rule)
            drawn = table.relative_error.sel(tool=name, version=version)
            np.testing.assert_array_equal(drawn, library)


def test_springs_mend_without_moving_hinges(table: xarray.Dataset) -> None:
    for name, rules in ruled().items():
        was, better = (bm.Chain(bm.Beam.unit(), "clamped-free", 10, rule) for rule in rules)
        np.testing.assert_allclose(was.hinge_position, better.hinge_position, rtol=0, atol=1e-15)
        for version, chain in zip(simulators.VERSIONS, (was, better), strict=True):
            shown = [float(_fraction(text)) for text in table.spring.sel(tool=name, version=version).values]
            # EI/ell is 10 for the unit beam and N = 10.
            assert shown == pytest.approx(chain.joint_stiffness[:4] / 10, rel=1e-12)


def _fraction(text: str) -> float:
    top, _, bottom = str(text).partition("/")
    return int(top) / int(bottom or 1)


@pytest.mark.parametrize("name", ["Adams flexible link", "MuJoCo 4 flex"])
def test_declared_orders_of_the_others(name: str) -> None:
    others = {tool.name: tool for tool in tools() if not tool.springs}
    tool = others[name]
    assert len(others) == 2
    for errors, order in zip((tool.as_is, tool.mended), tool.orders, strict=True):
        coarse, fine = errors([40, 80])
        assert math.log2(coarse / fine) == pytest.approx(order, abs=0.03)


def cantilever_flexibility(position: np.ndarray) -> np.ndarray:
    """Deflections and rotations at points of a cantilever under unit forces and moments there, EI = 1.

    By the unit-load integral of M_i M_j, each a polynomial up to the nearer of two points.
    """
    count = len(position)
    flexibility = np.empty((2 * count, 2 * count))
    for i, a in enumerate(position):
        for j, b in enumerate(position):
            c = min(a, b)
            flexibility[i, j] = a * b * c - (a + b) * c**2 / 2 + c**3 / 3
            flexibility[i, count + j] = a * c - c**2 / 2
            flexibility[count + i, j] = b * c - c**2 / 2
            flexibility[count + i, count + j] = c
    return flexibility


@pytest.mark.parametrize(("attachment", "wall"), [("flexible", 0.0), ("rigid", 0.5)])
@pytest.mark.parametrize("count", [3, 10, 25])
def test_adams_link_by_flexibilities(attachment: str, wall: float, count: int) -> None:
    # A rod held rigid is a beam that begins at its middle.
    middles = (np.arange(count) + 0.5 - wall) / count
    middles = middles[middles > 0]
    mass = np.repeat([1 / count, 1 / count**3 / 12], len(middles))
    shared = np.sqrt(mass)[:, None] * cantilever_flexibility(middles) * np.sqrt(mass)
    omega = 1 / math.sqrt(scipy.linalg.eigvalsh(shared)[-1])
    exact = bm.euler_bernoulli(bm.Beam.unit(), "clamped-free", 1).angular_frequency[0]
    found = adams_link_errors([count], attachment=attachment)[0]
    assert found == pytest.approx(omega / exact - 1, abs=2e-9)


LENGTH, RADIUS, YOUNG, DENSITY = 1.2, 0.005, 70e9, 2700.0
AREA, INERTIA = math.pi * RADIUS**2, math.pi * RADIUS**4 / 4


def flex_model(edges: int, shifted: bool) -> Any:
    """MuJoCo 4's own rod, clamped by its first edge."""
    mujoco = pytest.importorskip("mujoco")
    if int(mujoco.__version__.split(".")[0]) < 4:
        pytest.skip("rods of MuJoCo 3 do not bend like beams")
    step = LENGTH / edges
    middle, mass = LENGTH / 2, DENSITY * AREA * LENGTH
    if shifted:
        middle, mass = middle - step / 2, mass * (edges + 1) / edges
    rod = (
        f'<flexcomp name="rod" dim="1" type="grid" count="{edges + 1} 1 1" spacing="{step} 1 1" '
        f'pos="{middle} 0 0" radius="{RADIUS}" mass="{mass}"><edge equality="true"/>'
        f'<elasticity young="{YOUNG}" poisson="0.3"/><pin id="0 1"/><contact selfcollide="none"/></flexcomp>'
    )
    option = '<option timestep="1e-4" gravity="0 0 0" integrator="RK4"/>'
    return mujoco, mujoco.MjModel.from_xml_string(f"<mujoco>{option}<worldbody>{rod}</worldbody></mujoco>")


@pytest.mark.parametrize("shifted", [False, True])
def test_mujocos_flex_rings_as_computed(shifted: bool) -> None:
    mujoco, model = flex_model(10, shifted)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    up = [j for j in range(model.njnt) if model.jnt_type[j] == 2 and model.jnt_axis[j][2] == 1]
    assert len(up) == 9
    address, place = model.jnt_qposadr[up], data.xpos[model.jnt_bodyid[up], 0]
    assert place[-1] == pytest.approx(LENGTH - shifted * LENGTH / 20)
    beam = bm.euler_bernoulli(bm.Beam(LENGTH, YOUNG * INERTIA, DENSITY * AREA), "clamped-free", 1)
    shape = beam.shape(place)[0]
    data.qpos[address] = 1e-4 * shape / shape[-1]
    omega, step = beam.angular_frequency[0], model.opt.timestep
    motion = np.empty(int(4.5 * 2 * np.pi / omega / step))
    for k in range(len(motion)):
        motion[k] = shape @ data.qpos[address]
        mujoco.mj_step(model, data)
    falls = np.flatnonzero((motion[:-1] > 0) & (motion[1:] <= 0))
    times = step * (falls + motion[falls] / (motion[falls] - motion[falls + 1]))
    ringing = 2 * np.pi * (len(times) - 1) / (times[-1] - times[0])
    # The start is the beam's mode, so higher modes of the rod shake the crossings a little.
    assert ringing / omega - 1 == pytest.approx(flex_errors([10], shifted=shifted)[0], abs=3e-4)


def test_drawing_shows_the_data(table: xarray.Dataset) -> None:
    figure = simulators.STUDY.picture(table)
    for row, tool in enumerate(tools()):
        left, right = figure.axes[2 * row], figure.axes[2 * row + 1]
        one = 100 * table.relative_error.sel(tool=tool.name)
        np.testing.assert_array_equal(right.get_lines()[0].get_ydata(), abs(one.sel(version="as is")))
        written = {text.get_text() for text in right.texts}
        assert {f"{float(one.sel(version=v, segments=10)):+.3g} %" for v in simulators.VERSIONS} <= written
        shown = {text.get_text() for text in left.texts}
        assert tool.name in shown
        assert set(table.spring.sel(tool=tool.name).values.ravel()) - {""} <= shown
