"""Hostile arguments to every public name: an answer, or an error that names the argument, and nothing else.

A frozen table holds valid arguments of every public name. One or two of them at a time are replaced by values
that no caller means. What may follow: an answer; a TypeError that names an argument that was replaced; a
ValueError that names an argument of the call; an exception that the docstring promises. What may not: any
other exception, a warning of another library, a call that does not end.

The calls run in a process of their own, which tells each call before it makes it: one that does not come back
is known by its name, and stopped.
"""

from __future__ import annotations

import contextlib
import functools
import inspect
import itertools
import json
import math
import os
import queue
import random
import re
import resource
import signal
import subprocess
import sys
import tempfile
import threading
import warnings
from collections.abc import Callable, Iterator
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from shared_cases import WIRE

import beammodes as bm
from beammodes import checks

# --- Valid arguments of every public name -----------------------------------------------------------------

Arguments = Callable[[], dict[str, Any]]
SHAFT = {"density": 7800.0, "elastic_modulus": 2.1e11, "length": 1.0}


@functools.cache
def beam() -> bm.Beam:
    return bm.Beam(1.2, 85.0, 0.62)


@functools.cache
def shaft() -> bm.Beam:
    return bm.Beam(1.2, 85.0, 0.62, torsional_stiffness=60.0, polar_inertia_per_length=1e-4)


@functools.cache
def rod() -> bm.Rod:
    return bm.Rod(1.0, 1.0, 0.8, 1.0, 0.01, curvature=(0.5, 0.0, 1.0))


@functools.cache
def chain() -> bm.Chain:
    return bm.Chain(beam(), "clamped-free", 4)


@functools.cache
def structure() -> bm.Structure:
    return bm.Structure.of_beam(beam(), "clamped-free", [bm.Station(0.5, math.inf)])


@functools.cache
def equations() -> Any:
    return bm.linearize(chain())


@functools.cache
def answer() -> Any:
    return bm.frequency_response(chain(), frequency=[1.0, 4.0], force_at=1.2, deflection_at=[0.5, 1.2])


@functools.cache
def motion() -> Any:
    return bm.simulate(chain(), duration=0.01, step=1e-3, initial=bm.mode_start(chain(), 1, 0.01))


@functools.cache
def spread() -> Any:
    return bm.frequency_spread(
        bm.Rectangle(0.06, 0.02), "clamped-free", {"height": 0.02}, modes=1, samples=100, **SHAFT
    )


@functools.cache
def csv() -> str:
    path = Path(tempfile.mkdtemp()) / "chain.csv"
    bm.export_chain(chain(), path)
    return str(path)


@functools.cache
def boom() -> str:
    path = Path(tempfile.mkdtemp()) / "boom.xml"
    bm.export_chain(bm.Chain(beam(), "clamped-free", 3, "naive"), path)
    return str(path)


@functools.cache
def study() -> str:
    folder = tempfile.mkdtemp()
    bm.Study.grid(boundary="clamped-free", segments=4, mode=1, compute="relative_error").run(store=folder)
    return folder


def axes() -> Any:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.close("all")
    return plt.figure().add_subplot()


def out(name: str) -> str:
    return os.path.join(tempfile.mkdtemp(), name)


def of(**given: Any) -> Arguments:
    return lambda: dict(given)


PIECES: dict[str, Any] = {
    "length": [0.0, 0.5, 0.5],
    "mass": [0.0, 0.5, 0.5],
    "rotary_inertia": [0.0, 0.01, 0.01],
    "joint_stiffness": [3.0, 2.0],
}

#: What is called, with what: every public name that is a function or makes what a caller makes.
CALLS: dict[str, Arguments] = {
    "AxialBoundary": lambda: {"left": bm.AxialEnd(), "right": bm.AxialEnd(2.0), "motion": "stretch"},
    "AxialBoundary.of": of(boundary="fixed-free", motion="twist"),
    "AxialChain": lambda: {
        "beam": shaft(),
        "boundary": "fixed-free",
        "segments": 4,
        "rule": "gregory",
        "motion": "twist",
    },
    "AxialChain.displacement": lambda: {
        "self": bm.AxialChain(shaft(), "fixed-free", 4),
        "loads": {0.5: 1.0},
    },
    "AxialEnd": of(stiffness=1.0, inertia=0.5),
    "BaseMotion": lambda: {"x": bm.harmonic(0.1, 2.0), "y": bm.spin_up(1.0, 2.0), "hub_radius": 0.1},
    "Beam": of(
        length=1.2,
        bending_stiffness=85.0,
        mass_per_length=0.62,
        rotary_inertia_per_length=0.01,
        shear_stiffness=1e4,
        radius_of_gyration=0.1,
        torsional_stiffness=60.0,
        polar_inertia_per_length=0.02,
        axial_stiffness=1e6,
    ),
    "Beam.from_section": lambda: {
        "section": bm.Rectangle(0.1, 0.2),
        **SHAFT,
        "rotary_inertia": True,
        "poisson_ratio": 0.3,
        "shear_coefficient": 0.8,
    },
    "Beam.from_sections": lambda: {
        "x": [0.0, 0.5],
        "sections": [bm.Circle(0.1), bm.Circle(0.2)],
        "density": 7800.0,
        "elastic_modulus": 2e11,
        "rotary_inertia": True,
        "poisson_ratio": 0.3,
        "shear_coefficient": 0.8,
        "breaks": (0.2,),
    },
    "Boundary": lambda: {"left": bm.End(mass=1.0), "right": bm.ENDS["free"]},
    "Boundary.of": of(boundary="clamped-free"),
    "Box": of(width=0.04, height=0.06, wall=0.003),
    "Chain": lambda: {"beam": beam(), "boundary": "clamped-free", "segments": 4, "rule": "gregory"},
    "Chain.from_pieces": lambda: {**PIECES, "boundary": "clamped-free"},
    "Channel": of(width=0.1, height=0.2, flange=0.0085, web=0.0056),
    "Chirp": of(first=1.0, last=5.0, duration=2.0, start=0.1),
    "Circle": of(diameter=0.1),
    "Damping.joint_damping": lambda: {"self": bm.Damping(joint=0.1), "chain": chain()},
    "Damping": of(mass=0.1, stiffness=0.01, joint=0.1),
    "End": of(
        translational_stiffness=1.0,
        rotational_stiffness=2.0,
        mass=0.5,
        rotary_inertia=0.1,
        offset=0.1,
        on_segment=False,
    ),
    "End.hub": of(hub_radius=0.5, rotary_inertia=2.0, rotational_stiffness=3.0),
    "Ends": of(
        translational_stiffness=1.0,
        rotational_stiffness=2.0,
        mass=[0.5, 1.0],
        rotary_inertia=0.1,
        offset=0.1,
        on_segment=False,
    ),
    "GivenSection": of(area=1.0, second_moment=2.0, weak_second_moment=1.0, torsion_constant=0.5),
    "ISection": of(width=0.1, height=0.2, flange=0.0085, web=0.0056),
    "Joint": of(x=0.0, y=1.0, support="pinned", mass=1.0, rotary_inertia=0.1, offset=(0.1, 0.0), angle=0.3),
    "LineLoad": of(per_length=(1.0, 2.0), start=0.1, stop=0.9, member=None),
    "Load": of(
        axial_force=1.0,
        spin_rate=0.0,
        hub_radius=0.0,
        plane="flap",
        gravity=(0.0, 0.0),
        tip_force=(1.0, 0.0),
        tip_moment=0.0,
    ),
    "Member": lambda: {
        "beam": beam(),
        "start": "a",
        "end": "b",
        "start_hinge": math.inf,
        "end_hinge": 2.0,
        "stations": [bm.Station(0.5, mass=1.0)],
    },
    "Normal": of(mean=1.0, standard_deviation=0.1, within=4.0),
    "PointLoad": of(x=0.5, force=(1.0, 2.0), moment=0.1, member=None),
    "Pulse": of(duration=0.1, start=0.2, shape="triangle"),
    "Rectangle": of(width=0.1, height=0.2),
    "Sine": of(frequency=2.0, phase=0.1, start=0.1),
    "Step": of(start=0.1, rise=0.2),
    "TimedLoad": lambda: {
        "load": bm.Load(tip_force=1.0),
        "course": bm.Sine(2.0),
        "follower": False,
        "breaks": [0.1, 0.2],
    },
    "Rod": of(
        length=1.0,
        bending_stiffness=1.0,
        torsional_stiffness=0.8,
        mass_per_length=1.0,
        polar_inertia_per_length=0.01,
        second_bending_stiffness=2.0,
        axial_stiffness=1e4,
        shear_stiffness=1e3,
        curvature=(0.5, 0.0, 1.0),
        breaks=(),
    ),
    "Rod.from_beam": lambda: {
        "beam": beam(),
        "torsional_stiffness": 60.0,
        "polar_inertia_per_length": 0.01,
        "second_bending_stiffness": 90.0,
        "curvature": (0.0, 0.0, 1.0),
    },
    "Rod.of_section": lambda: {
        "section": bm.Rectangle(0.1, 0.2),
        "density": 7800.0,
        "elastic_modulus": 2.1e11,
        "poisson_ratio": 0.3,
        "rotary_inertia": True,
    },
    "Rod.helix": lambda: {"radius": 0.1, "pitch": 0.05, "turns": 2.0, **WIRE},
    "Rod.hook": lambda: {"straight": 0.5, "radius": 0.1, "angle": 2.0, **WIRE},
    "Rod.through": lambda: {
        "points": [[0, 0, 0], [1, 0, 0], [2, 1, 0], [3, 1, 1]],
        "up": (0.0, 0.0, 1.0),
        "twist": 0.1,
        **WIRE,
    },
    "RodEnd": of(
        translational_stiffness=(1.0, math.inf, 0.0),
        rotational_stiffness=2.0,
        mass=0.5,
        rotary_inertia=(0.1, 0.2, 0.2),
        offset=(0.1, 0.0, 0.0),
        on_segment=False,
    ),
    "RodEnds": lambda: {"left": bm.RodEnd(), "right": bm.RodEnd(mass=1.0)},
    "RodEnds.of": of(boundary="clamped-free"),
    "Rule": lambda: {
        "name": "mine",
        "clamped": (bm.Weight(Fraction(1, 2)),),
        "guided": (bm.Weight(Fraction(1, 2)),),
        "carried": (),
        "stub": Fraction(0),
        "rotary_inertia": Fraction(1, 12),
        "summary": "words",
    },
    "Station": of(x=0.5, translational_stiffness=3.0, mass=0.1, hinge=2.0),
    "Structure": lambda: {
        "joints": {"a": bm.Joint(0, 0, "clamped"), "b": bm.Joint(1.2, 0)},
        "members": [bm.Member(beam(), "a", "b")],
    },
    "Structure.of_bars": lambda: {
        "joints": {"a": bm.Joint(0, 0, "clamped"), "b": bm.Joint(1.2, 0)},
        "pairs": [("a", "b")],
        "bending_stiffness": 85.0,
        "mass_per_length": 0.62,
    },
    "Structure.of_beam": lambda: {
        "beam": beam(),
        "boundary": "clamped-free",
        "stations": [bm.Station(0.5, mass=1.0)],
    },
    "StructureChain": lambda: {
        "structure": structure(),
        "segments": 4,
        "rule": "gregory",
        "corrected": True,
    },
    "JointLaw": of(name="mine", orders=("xyz", "zyx")),
    "SpatialLoad": of(force=(0.0, 0.0, 1.0), moment=(0.0, 0.0, 0.0), torque=0.1, gravity=(0.0, 0.0, -9.81)),
    "critical_factor": lambda: {
        "chain": bm.SpatialChain(rod(), "clamped-free", 4),
        "load": bm.SpatialLoad(force=(-1.0, 0.0, 0.0)),
        "joints": "ball",
        "most": 100.0,
        "start": 2.0,
    },
    "frequency_response": lambda: {
        "system": chain(),
        "boundary": None,
        "frequency": [1.0, 4.0],
        "force_at": 1.2,
        "moment_at": None,
        "base": None,
        "deflection_at": [0.5, 1.2],
        "rotation_at": None,
        "damping_ratio": None,
        "damping": bm.Damping(joint=0.01),
        "loss_factor": 0.01,
        "load": bm.Load(axial_force=0.1),
    },
    "plot_response": lambda: {"response": answer(), "ax": axes(), "quantity": "mobility", "label": "beam"},
    "random_response": lambda: {
        "system": beam(),
        "boundary": "clamped-free",
        "density": 0.1,
        "band": (1.0, 5.0),
        "force_at": None,
        "moment_at": None,
        "base": "shift",
        "deflection_at": 1.2,
        "rotation_at": None,
        "damping_ratio": 0.05,
        "damping": None,
        "loss_factor": 0.0,
        "load": None,
        "tolerance": 1e-3,
    },
    "response_error": lambda: {
        "boundary": "clamped-free",
        "segments": [3, 4],
        "mode": 1,
        "damping_ratio": 0.01,
        "rule": "gregory",
        "load": None,
        "beam": beam(),
    },
    "spatial_equilibrium": lambda: {
        "chain": bm.SpatialChain(rod(), "clamped-free", 4),
        "load": bm.SpatialLoad(force=(0.0, 0.0, 1.0)),
        "joints": "yzx",
        "guess": None,
        "end_place": None,
        "end_frame": None,
    },
    "SpatialChain": lambda: {
        "rod": rod(),
        "boundary": "clamped-free",
        "segments": 4,
        "rule": "gregory",
    },
    "Study.grid": of(boundary="clamped-free", segments=[2, 3], mode=1, compute="relative_error"),
    "Table": of(x=[0.0, 0.5, 1.0], value=[1.0, 2.0, 3.0]),
    "Tolerance": of(size=0.1, distribution="uniform"),
    "Tube": of(outer=0.5, inner=0.25),
    "Uniform": of(low=1.0, high=2.0),
    "Weight": of(constant=Fraction(1, 2), per_segment=Fraction(1, 3)),
    "animate": lambda: {"result": motion(), "path": None, "fps": 25, "duration": 0.1, "trace": 0.1},
    "axial_displacement": lambda: {
        "beam": shaft(),
        "boundary": "fixed-free",
        "loads": {0.5: 1.0},
        "x": [0.5],
        "motion": "twist",
    },
    "axial_modes": lambda: {"beam": shaft(), "boundary": "fixed-free", "modes": 2, "motion": "twist"},
    "audit_chain": lambda: {
        "beam": beam(),
        "boundary": "clamped-free",
        **PIECES,
        "modes": 1,
        "tolerance": 0.01,
    },
    "audit_file": lambda: {"path": csv(), "beam": beam(), "boundary": "clamped-free", "modes": 1},
    "mend_file": lambda: {
        "path": boom(),
        "written": str(Path(boom()).with_name("mended.xml")),
        "beam": beam(),
        "boundary": "clamped-free",
        "modes": 1,
        "suggestion": None,
        "force": True,
    },
    "axially_corrected": lambda: {"rule": "gregory", "load": bm.Load(axial_force=0.5), "beam": beam()},
    "beam_statics": lambda: {"beam": beam(), "boundary": "clamped-free", "load": "tip_force"},
    "buckling_dataset": lambda: {
        "boundary": "clamped-free",
        "segments": [2, 3],
        "rule": "gregory",
        "beam": beam(),
    },
    "buckling_load": lambda: {"structure": beam(), "boundary": "clamped-free"},
    "chain_errors": lambda: {"chain": chain(), "modes": 2, "load": bm.Load(axial_force=1.0)},
    "chain_frequency": of(boundary="clamped-free", segments=5, mode=1, rule="gregory"),
    "chain_statics": lambda: {"chain": chain(), "load": "tip_force"},
    "compile_equations": lambda: {"chain": chain(), "load": bm.Load(axial_force=1.0)},
    "damped_modes": lambda: {"chain": chain(), "damping": bm.Damping(joint=0.1)},
    "derive_chain": lambda: {"chain": small()},
    "derived_error_dataset": lambda: {
        "boundary": "clamped-free",
        "segments": [2],
        "modes": 1,
        "rule": "gregory",
        "progress": None,
    },
    "draw_chain": lambda: {
        "chain": chain(),
        "ax": axes(),
        "shape": bm.solve_modes(equations(), 1),
        "mode": 1,
        "amplitude": 0.1,
        "labels": "EI/ell",
        "ends": True,
        "size": 10.0,
    },
    "draw_statics": lambda: {
        "statics": bm.structure_statics(structure(), [bm.LineLoad(2.0)]),
        "ax": axes(),
        "quantity": "shear",
        "amplitude": 0.1,
        "size": 10.0,
    },
    "elastic_modulus": of(material="wood", unit="Pa", at=0.5),
    "equations_of_motion": lambda: {"chain": small(), "load": bm.Load(), "symbols": None},
    "error_dataset": lambda: {
        "boundary": "clamped-free",
        "segments": [3],
        "modes": 1,
        "rule": "gregory",
        "load": bm.Load(axial_force=0.1),
        "over": {"right_mass": [0.1]},
        "beam": bm.Beam.unit(),
        "motion": "bending",
    },
    "error_remarks": lambda: {
        "boundary": "clamped-free(mass=0.1)",
        "segments": 4,
        "mode": 1,
        "rule": "gregory",
        "load": bm.Load(axial_force=0.1),
        "beam": beam(),
    },
    "error_law": of(boundary="clamped-free", mode=1, rule="gregory", motion="twist"),
    "BeamModes.shape": lambda: {
        "self": bm.euler_bernoulli(beam(), "clamped-free", 2),
        "x": [0.0, 1.0],
        "derivative": 1,
    },
    "StructureModes.shape": lambda: {
        "self": bm.structure_modes(structure(), 2),
        "x": [0.0, 1.0],
        "member": "left-right",
    },
    "StructureChainModes.shape": lambda: {
        "self": bm.structure_chain_modes(bm.StructureChain(structure(), 4), 2),
        "x": [0.0, 1.0],
        "member": "left-right",
    },
    "StructureStatics.shear": lambda: {
        "self": bm.structure_statics(structure(), [bm.LineLoad(2.0)]),
        "x": [0.0, 1.0],
        "member": "left-right",
        "side": 1,
    },
    "TimoshenkoModes.rotation": lambda: {
        "self": bm.timoshenko(bm.Beam(1, 1, 1, 0.01, shear_stiffness=30), "clamped-free", 2),
        "x": [0.0, 1.0],
        "derivative": 1,
    },
    "euler_bernoulli": lambda: {
        "beam": beam(),
        "boundary": "clamped-free",
        "modes": 2,
        "load": bm.Load(axial_force=1.0),
    },
    "export_chain": lambda: {
        "chain": chain(),
        "path": out("chain.xml"),
        "format": "mjcf",
        "name": "rope",
        "fragment": False,
        "damping": bm.Damping(joint=0.1),
        "timestep": 1e-4,
        "integrator": "RK4",
        "load": bm.Load(),
        "at": None,
        "joints": "xyz",
        "force": False,
    },
    "find_equilibrium": lambda: {
        "chain": bm.Chain(beam(), "pinned-pinned", 4),
        "load": bm.Load(gravity=9.81),
        "span": (1.0, 0.2),
        "branch": "sag",
        "guess": None,
        "tolerance": 1e-10,
    },
    "flutter_load": lambda: {"chain": chain(), "damping": bm.Damping(stiffness=0.01)},
    "follower_modes": lambda: {
        "chain": chain(),
        "compression": 1.0,
        "damping": bm.Damping(stiffness=0.01),
    },
    "frequency_error": lambda: {
        "boundary": "clamped-free(mass=0.1)",
        "segments": 4,
        "mode": 1,
        "rule": "gregory",
        "load": bm.Load(axial_force=0.1),
        "beam": beam(),
        "motion": "bending",
    },
    "frequency_spread": lambda: {
        "section": bm.Rectangle(0.06, 0.02),
        "boundary": "clamped-free",
        "tolerances": {"height": 0.02},
        "modes": 1,
        **SHAFT,
        "samples": 100,
        "seed": 1,
        "quantiles": (0.1, 0.9),
        "progress": None,
    },
    "from_sectionproperties": lambda: {
        "section": SimpleNamespace(get_area=lambda: 75.0, get_ic=lambda: (156.25, 1406.25, 0.0)),
        "length_unit": 1e-3,
    },
    "harmonic": of(amplitude=0.1, angular_frequency=2.0),
    "joint_dampers": lambda: {"chain": chain(), "ratio": 0.05, "mode": 1},
    "law_holds_from": of(boundary="clamped-free", mode=1, rule="gregory", within=0.3, motion="bending"),
    "linearize": lambda: {"chain": chain(), "load": bm.Load(axial_force=0.1), "at": None},
    "match_springs": lambda: {
        "boundary": "clamped-free",
        "segments": 2,
        "modes": 1,
        "criterion": "gregory",
        "hold_tip_stiffness": False,
        "highest_frequency": None,
        "symmetric": None,
        "beam": beam(),
        "motion": "bending",
    },
    "matched": of(modes=2, motion="twist"),
    "modal_assurance": lambda: {"a": np.eye(3), "b": np.eye(3), "mass": np.ones(3)},
    # Slow to swing, so that hundreds of seconds, which an array of small integers asks for, are few periods.
    "modal_response": lambda: {
        "damping_ratio": 0.02,
        "damping": None,
        "beam": bm.Beam(1.0, 1e-4, 1.0),
        "boundary": "clamped-free",
        "modes": 2,
        "time": [0.0, 0.01],
        "base": bm.BaseMotion(y=bm.harmonic(0.01, 2.0)),
        "initial": [0.1, 0.0],
        "stiffening": True,
        "tolerance": 1e-8,
    },
    "mode_start": lambda: {"chain": chain(), "mode": 1, "amplitude": 0.1, "load": None, "at": None},
    "mode_tuned": of(mode=1, motion="stretch"),
    "open_study": lambda: {"path": study()},
    "published_time_step": lambda: {"beam": beam(), "modes": 3},
    "read_chain_csv": lambda: {"path": csv()},
    "ratio_from_decay": of(peaks=[10.0, 9.1, 8.3], periods=[0, 1, 2]),
    "rayleigh_damping": lambda: {"of": chain(), "ratios": {1: 0.01, 2: 0.02}},
    "recommend": lambda: {
        "boundary": "clamped-free",
        "tolerance": 0.05,
        "modes": 1,
        "beam": beam(),
        "rules": ["gregory"],
        "integrator": "rk4",
    },
    "rod_error_dataset": lambda: {
        "rod": rod(),
        "boundary": "clamped-free",
        "segments": [3],
        "modes": 1,
        "rule": "gregory",
    },
    "rod_errors": lambda: {"chain": bm.SpatialChain(rod(), "clamped-free", 4), "modes": 2},
    "rod_modes": lambda: {"rod": rod(), "boundary": "clamped-free", "modes": 2},
    "spatial_modes": lambda: {"chain": bm.SpatialChain(rod(), "clamped-free", 4), "modes": 2},
    "segments_needed": lambda: {
        "boundary": "clamped-free",
        "tolerance": 0.05,
        "modes": 1,
        "rule": "gregory",
        "load": None,
        "beam": None,
        "motion": "stretch",
        "damping_ratio": 0.01,
    },
    "segments_within_spread": lambda: {"spread": spread(), "rule": "gregory", "fraction": 0.3},
    "shape_dataset": lambda: {
        "boundary": "clamped-free",
        "segments": [3],
        "modes": 1,
        "rule": "gregory",
        "beam": beam(),
    },
    "simulate": lambda: {
        "chain": chain(),
        "duration": 0.004,
        "integrator": "rk4",
        "step": 1e-3,
        "output_step": 1e-3,
        "initial": bm.mode_start(chain(), 1, 0.01),
        "span": None,
        "load": [bm.Load(), bm.TimedLoad(bm.PointLoad(0.6, force=1.0), bm.Step(1e-3))],
        "base": None,
        "damping": bm.Damping(joint=0.01),
        "tolerance": 1e-6,
        "modes": 1,
        "halve_step": False,
        "progress": False,
        "path": None,
    },
    "solve_modes": lambda: {"model": equations(), "modes": 2},
    "bang_bang": of(distance=1.0, duration=2.0, start=0.5),
    "point_to_point": of(distance=1.0, duration=2.0, start=0.5),
    "spin_up": of(rate=2.0, duration=1.0),
    "stable_time_step": lambda: {
        "chain": chain(),
        "integrator": "rk4",
        "load": bm.Load(),
        "damping": bm.Damping(joint=0.01),
    },
    "static_dataset": of(boundary="clamped-free", segments=[3], rule="gregory"),
    "stiffness_from_deflection": of(deflection=0.01, boundary="clamped-free", length=1.0, tip_force=2.0),
    "stiffness_from_frequency": of(
        frequency=10.0,
        boundary="clamped-free",
        length=1.0,
        mass_per_length=0.5,
        mode=1,
        rotary_inertia_per_length=1e-4,
    ),
    "structure_chain_statics": lambda: {
        "chain": bm.StructureChain(structure(), 4),
        "load": bm.PointLoad(0.6, force=1.0),
    },
    "structure_statics": lambda: {"structure": structure(), "load": [bm.LineLoad(2.0)]},
    "structure_chain_modes": lambda: {"chain": bm.StructureChain(structure(), 4), "modes": 2},
    "structure_modes": lambda: {"structure": structure(), "modes": 2},
    "structure_modes_under": lambda: {
        "structure": structure(),
        "load": bm.PointLoad(0.4, force=(0.1, 0.2)),
        "modes": 2,
    },
    "symbolic_energies": lambda: {"chain": small(), "load": bm.Load(), "symbols": None},
    "theory_errors": lambda: {
        "beam": beam(),
        "boundary": "clamped-free",
        "modes": 2,
        "radius_of_gyration": 0.01,
        "shear_ratio": 3.0,
        "load": bm.Load(axial_force=1.0),
    },
    "timoshenko": lambda: {
        "beam": beam(),
        "boundary": "clamped-free",
        "modes": 2,
        "load": None,
        "shear_stiffness": 1e5,
        "rotary_inertia_per_length": 1e-3,
    },
    "wall_spring_weight": of(),
    "wavenumber": of(boundary="clamped-free", mode=2),
}

#: Made by the library and not by callers; their contents are tested where they are made.
ANSWERS = {
    "Audit",
    "AxialAudit",
    "AxialChainModes",
    "AxialMatched",
    "AxialMatchedSprings",
    "AxialModes",
    "AxialTuned",
    "AxiallyCorrected",
    "BeamModes",
    "BentModel",
    "Case",
    "CompiledEquations",
    "DecayRatio",
    "DerivedChain",
    "Energies",
    "EnoughSegments",
    "EquationsOfMotion",
    "Equilibrium",
    "ErrorLaw",
    "FlutterLoad",
    "Integrator",
    "Layout",
    "LinearModel",
    "Matched",
    "MatchedSprings",
    "MendedFile",
    "ModeTuned",
    "Modes",
    "Recommendation",
    "Recommendations",
    "RodModes",
    "SpatialAudit",
    "SpatialEquilibrium",
    "SpatialModes",
    "SpectralBeamModes",
    "Statics",
    "StepVerdict",
    "StructureChainModes",
    "StructureModes",
    "StructureStatics",
    "Study",
    "Suggestion",
    "SupportedBeamModes",
    "TimoshenkoModes",
}
#: Neither called nor made.
CONSTANTS = {"BOUNDARIES", "ENDS", "INTEGRATORS", "JOINT_LAWS", "MODULI", "RULES", "WAVEFORMS", "__version__"}
EXCEPTIONS = {
    "BadModel",
    "Buckled",
    "DampingFitWarning",
    "DivergedWarning",
    "EquilibriumNotFound",
    "MissedFeatureWarning",
    "NoEquilibriumInSpace",
    "NothingMovesWarning",
    "NoPositiveAxialSprings",
    "NoPositiveSprings",
    "NotClosed",
    "NotPlain",
    "SlendernessWarning",
    "ToleranceOutOfReach",
    "UnsavedMotion",
    "UnstableStepWarning",
}


@functools.cache
def small() -> bm.Chain:
    return bm.Chain(beam(), "clamped-free", 2)


# --- Hostile values ---------------------------------------------------------------------------------------


class NoEquals:
    """Refuses to be compared."""

    def __eq__(self, other: object) -> bool:
        raise RuntimeError("compared")

    __hash__ = None  # type: ignore[assignment]


class NoWords:
    """Refuses to be printed."""

    def __repr__(self) -> str:
        raise RuntimeError("printed")


class Word(str):
    __slots__ = ()


#: Made anew for each call: a generator can be read once.
HOSTILE: dict[str, Callable[[], Any]] = {
    "None": lambda: None,
    "nan": lambda: math.nan,
    "inf": lambda: math.inf,
    "-inf": lambda: -math.inf,
    "huge": lambda: 1e300,
    "tiny": lambda: 5e-324,
    "negative": lambda: -1.5,
    "zero": lambda: 0,
    "-0.0": lambda: -0.0,
    "minus one": lambda: -1,
    "10**400": lambda: 10**400,
    "10**12": lambda: 10**12,
    "True": lambda: True,
    "np.True_": lambda: np.True_,
    "bytes": lambda: b"clamped-free",
    "bytearray": lambda: bytearray(b"1"),
    "empty str": lambda: "",
    "str": lambda: "no such thing",
    "number in words": lambda: "1.0",
    "newlines": lambda: "a\nb\x00",
    "long str": lambda: "x" * 100_000,
    "str subclass": lambda: Word("clamped-free"),
    "empty list": list,
    "list": lambda: [1, 2],
    "list of None": lambda: [None],
    "nested": lambda: [[1], [2, 3]],
    "tuple": lambda: ("clamped", 3),
    "dict": lambda: {"a": 1},
    "set": lambda: {1, 2},
    "empty array": lambda: np.zeros(0),
    "matrix": lambda: np.ones((2, 2)),
    "0-d array": lambda: np.array(2.0),
    "0-d nan": lambda: np.array(math.nan),
    "array of nan": lambda: np.array([math.nan, 1.0]),
    "array of words": lambda: np.array(["a", "b"]),
    "array of objects": lambda: np.array([None, {}], dtype=object),
    "complex array": lambda: np.array([1 + 2j, 2.0]),
    "masked array": lambda: np.ma.masked_array([1.0, 2.0], mask=[True, False]),
    "uint8": lambda: np.uint8(3),
    "uint8 array": lambda: np.array([3, 255], dtype=np.uint8),
    "float16": lambda: np.float16(0.1),
    "longdouble": lambda: np.longdouble("1e4000"),
    "datetime64": lambda: np.datetime64("2020-01-01"),
    "complex": lambda: 1 + 2j,
    "Decimal": lambda: Decimal("0.1"),
    "huge Decimal": lambda: Decimal("1e5000"),
    "Decimal nan": lambda: Decimal("sNaN"),
    "Fraction": lambda: Fraction(1, 3),
    "huge Fraction": lambda: Fraction(10**400, 3),
    "Path to nowhere": lambda: Path("/nowhere/at/all.xml"),
    "generator": lambda: (n for n in (1, 2)),
    "endless": itertools.count,
    "endless range": lambda: range(10**12),
    "lambda": lambda: lambda: None,
    "lambda x": lambda: lambda x: x,
    "class": lambda: int,
    "module": lambda: math,
    "Ellipsis": lambda: ...,
    "object": object,
    "no equals": NoEquals,
    "no words": NoWords,
    "exception": lambda: ValueError("boundary"),
    "Beam": bm.Beam.unit,
    "Load": bm.Load,
    "pull": lambda: bm.Load(axial_force=-1e300),
    "Boundary": lambda: bm.BOUNDARIES[0],
}

#: What docstrings promise beside TypeError and ValueError; OSError of what reads or writes files.
FILES = ("animate", "audit_file", "export_chain", "mend_file", "open_study", "read_chain_csv", "simulate")
PROMISED: dict[str, tuple[type[BaseException], ...]] = dict.fromkeys(FILES, (OSError,))
ARITHMETIC = (
    "critical_factor",
    "spatial_equilibrium",
    "beam_statics",
    "buckling_load",
    "chain_errors",
    "euler_bernoulli",
    "frequency_response",
    "match_springs",
    "modal_response",
    "random_response",
    "recommend",
    "rod_error_dataset",
    "rod_errors",
    "rod_modes",
    "theory_errors",
    "timoshenko",
)
#: A caller's own function may raise what it will, and that is handed on.
OWN_FUNCTIONS = {"lambda", "lambda x", "class"}
WARNINGS = (
    bm.DampingFitWarning,
    bm.DivergedWarning,
    bm.MissedFeatureWarning,
    bm.NothingMovesWarning,
    bm.SlendernessWarning,
    bm.UnstableStepWarning,
)


def target(name: str) -> Any:
    return functools.reduce(getattr, name.split("."), bm)


def combinations(name: str, pairs: int) -> Iterator[dict[str, str]]:
    """Every argument by every value, then so many draws of two arguments by two values.

    Without draws it is every eighth value, in turns: the next argument has the next ones.
    """
    arguments = [argument for argument in CALLS[name]() if argument != "self"]
    for (i, argument), (k, value) in itertools.product(enumerate(arguments), enumerate(HOSTILE)):
        if (pairs or (i + k) % 8 == 0) and not (argument == "progress" and value in OWN_FUNCTIONS):
            yield {argument: value}
    draw = random.Random(name)
    for _ in range(pairs if len(arguments) > 1 else 0):
        drawn = {argument: draw.choice(list(HOSTILE)) for argument in draw.sample(arguments, 2)}
        if drawn.get("progress") not in OWN_FUNCTIONS:
            yield drawn


def verdict(name: str, replaced: dict[str, str]) -> str | None:
    """Make one call and return what is wrong with what follows, or None."""
    arguments = CALLS[name]() | {argument: HOSTILE[value]() for argument, value in replaced.items()}
    promised = PROMISED.get(name, ()) + ((ArithmeticError,) if name in ARITHMETIC else ())
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            answer = target(name)(**arguments)
            if hasattr(answer, "_draw_was_started"):
                # Matplotlib warns of films that nobody looked at.
                answer._draw_was_started = True
            with contextlib.suppress(AttributeError):
                answer.close()
        except (TypeError, ValueError) as error:
            told = str(error)
            named = set(replaced) if isinstance(error, TypeError) else set(arguments)
            if not any(re.search(rf"\b{re.escape(argument)}\b", told) for argument in named):
                return f"{type(error).__name__} names none of {sorted(named)}: {told[:300]}"
        except promised:
            pass
        except BaseException as error:
            return f"{type(error).__name__}: {str(error)[:300]}"
    for warning in caught:
        # What old libraries say of each other's future is not ours.
        theirs = (
            issubclass(warning.category, DeprecationWarning)
            and "site-packages" in Path(warning.filename).parts
        )
        if not theirs and not issubclass(warning.category, WARNINGS):
            where = f"{warning.filename}:{warning.lineno}"
            return f"{warning.category.__name__}: {str(warning.message)[:300]} at {where}"
    return None


# --- The process that makes the calls ---------------------------------------------------------------------

#: Seconds without a word after which a call is taken to hang. Only for that: none is measured.
PATIENCE = 60


class Slow(BaseException):
    """A call was still running when the process had enough of it."""


def tell_all(names: list[str], pairs: int) -> None:
    """Make all calls of some names; write each one before it is made, and what is wrong after it."""

    def enough(*_: object) -> None:
        raise Slow(f"still running after {PATIENCE // 3} s")

    signal.signal(signal.SIGALRM, enough)
    limit = 6 * 2**30
    resource.setrlimit(resource.RLIMIT_AS, (limit, resource.getrlimit(resource.RLIMIT_AS)[1]))
    os.chdir(tempfile.mkdtemp())
    if not pairs:
        # An endless list is found out after fewer numbers; with draws, by the true bound.
        checks.MAX_ITEMS = 10**5
    channel = os.fdopen(os.dup(1), "w")
    for name in names:
        CALLS[name]()
        for replaced in combinations(name, pairs):
            print(json.dumps([name, replaced]), file=channel, flush=True)
            signal.alarm(PATIENCE // 3)
            wrong = verdict(name, replaced)
            signal.alarm(0)
            if wrong:
                print(json.dumps(wrong), file=channel, flush=True)


def outcomes(names: list[str], pairs: int) -> tuple[int, list[str]]:
    """Return how many calls were made and what was wrong with which of them."""
    process = subprocess.Popen(
        [sys.executable, "-W", "ignore", __file__, str(pairs), *names],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert process.stdout is not None
    lines: queue.SimpleQueue[str] = queue.SimpleQueue()

    def read() -> None:
        for line in process.stdout or ():
            lines.put(line)
        lines.put("")

    reader = threading.Thread(target=read, daemon=True)
    calls, wrong, last = 0, [], ""
    reader.start()
    try:
        while True:
            try:
                line = lines.get(timeout=PATIENCE)
            except queue.Empty:
                wrong.append(f"{last}: does not end")
                break
            if not line:
                break
            told = json.loads(line)
            if isinstance(told, list):
                calls, last = calls + 1, f"{told[0]}({', '.join(f'{k}=<{v}>' for k, v in told[1].items())})"
            else:
                wrong.append(f"{last}: {told}")
    finally:
        process.kill()
        process.wait()
        reader.join()
        process.stdout.close()
    if not wrong and process.returncode not in (0, -signal.SIGKILL):
        wrong.append(f"{last}: the process ended with {process.returncode}")
    return calls, wrong


# --- Tests ------------------------------------------------------------------------------------------------


def test_every_public_name_is_in_the_table() -> None:
    called = {name.split(".")[0] for name in CALLS}
    assert set(bm.__all__) == called | ANSWERS | CONSTANTS | EXCEPTIONS


def test_the_table_holds_valid_arguments_that_cover_the_signature() -> None:
    for name in CALLS:
        assert verdict(name, {}) is None, name
        signature = inspect.signature(target(name))
        signature.bind(**CALLS[name]())
        needed = {
            key
            for key, parameter in signature.parameters.items()
            if parameter.default is inspect.Parameter.empty
            and parameter.kind != inspect.Parameter.VAR_KEYWORD
        }
        assert needed <= set(CALLS[name]()), name


def test_there_are_twenty_thousand_combinations() -> None:
    assert sum(sum(1 for _ in combinations(name, PAIRS)) for name in CALLS) >= 20_000


#: Draws of two replaced arguments for each name.
PAIRS = 120


@pytest.mark.parametrize("group", range(2))
def test_hostile_arguments_are_answered_or_refused_by_name(group: int) -> None:
    calls, wrong = outcomes(sorted(CALLS)[group::2], 0)
    assert calls > 1000
    assert not wrong, f"{len(wrong)} of {calls} calls:\n" + "\n".join(wrong[:40])


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(CALLS))
def test_all_hostile_arguments_are_answered_or_refused_by_name(name: str) -> None:
    calls, wrong = outcomes([name], PAIRS)
    assert not wrong, f"{len(wrong)} of {calls} calls:\n" + "\n".join(wrong[:40])


if __name__ == "__main__":
    tell_all(sys.argv[2:], int(sys.argv[1]))
