"""What every public value shares: it can be pickled, and compared by one meaning of ==.

Values that are what they were made from (beams, ends, rules, chains, loads, motions of a base) are equal if
they were made from equal parts. Results, which hold arrays, are equal to themselves only: == is a bool, the
hash agrees, and numbers are compared by NumPy, with a tolerance that the reader chooses.
"""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from shared_cases import WIRE

import beammodes as bm

UNIT = bm.Beam.unit()
BAR = bm.Beam(1.0, 1.0, 1.0, axial_stiffness=2.0)
TAPERED = bm.Beam(1.0, bm.Table([0.0, 0.5, 1.0], [1.0, 0.8, 0.7]), 1.0)
CHAIN = bm.Chain(UNIT, "clamped-free", 3)
SPAN = bm.Structure.of_beam(UNIT, "clamped-pinned")
BODY = bm.Boundary.of(("clamped", bm.End(mass=0.5)))

SPREAD = bm.frequency_spread(
    bm.Rectangle(0.06, 0.02),
    "clamped-free",
    {"height": 0.02},
    1,
    samples=100,
    elastic_modulus=207e9,
    density=7850.0,
    length=1.0,
)
#: Columns of a chain whose springs are half as stiff.
SOFT: dict[str, Any] = {name: getattr(CHAIN, name) for name in ("length", "mass", "rotary_inertia")}
SOFT["joint_stiffness"] = 0.5 * CHAIN.joint_stiffness


def written(chain: Any) -> Path:
    """A model file of a chain."""
    path = Path(tempfile.mkdtemp()) / "chain.xml"
    bm.export_chain(chain, path)
    return path


FLAT = bm.Rod(1.0, 1.0, 0.8, 1.0, 0.01, second_bending_stiffness=2.0)
FLAT_FILE = written(bm.SpatialChain(FLAT, "clamped-free", 4))
FILE = written(bm.Chain(UNIT, "clamped-free", 3, "naive"))
SHAFT = bm.Beam(1.0, 1.0, 1.0, torsional_stiffness=0.8, polar_inertia_per_length=0.01)

#: Made from equal parts by each call.
MADE: dict[str, Callable[[], Any]] = {
    "AxialBoundary": lambda: bm.AxialBoundary.of("fixed-free(mass=0.5)", "stretch"),
    "AxialChain": lambda: bm.AxialChain(
        bm.Beam(1.0, 1.0, 1.0, axial_stiffness=2.0), "fixed-free", 3, motion="stretch"
    ),
    "AxialEnd": lambda: bm.AxialEnd(stiffness=0.5),
    "BaseMotion": lambda: bm.BaseMotion(bm.harmonic(0.1, 2.0), angle=bm.spin_up(6.0, 15.0), hub_radius=0.5),
    "BaseMotion at rest": bm.BaseMotion,
    "harmonic": lambda: bm.harmonic(0.1, 2.0),
    "spin_up": lambda: bm.spin_up(6.0, 15.0),
    "bang_bang": lambda: bm.bang_bang(1.0, 2.0),
    "point_to_point": lambda: bm.point_to_point(1.0, 2.0),
    "Chirp": lambda: bm.Chirp(1.0, 5.0, 2.0),
    "Pulse": lambda: bm.Pulse(0.1, 0.2, "triangle"),
    "Sine": lambda: bm.Sine(3.0),
    "Step": lambda: bm.Step(0.1, 0.2),
    "TimedLoad": lambda: bm.TimedLoad(bm.Load(tip_force=0.5), bm.Table([0.0, 1.0], [0.0, 2.0]), breaks=[0.3]),
    "End of a hub": lambda: bm.End.hub(0.5, 2.0),
    "Beam": bm.Beam.unit,
    "Beam of a table": lambda: bm.Beam(1.0, bm.Table([0.0, 0.5, 1.0], [1.0, 0.8, 0.7]), 1.0),
    "Boundary": lambda: bm.Boundary.of(("clamped", bm.End(mass=0.5))),
    "Box": lambda: bm.Box(0.1, 0.2, 0.01),
    "Case": lambda: bm.Case({"segments": 3}),
    "Channel": lambda: bm.Channel(0.2, 0.1, 0.01, 0.005),
    "Chain": lambda: bm.Chain(bm.Beam.unit(), "clamped-free", 3),
    "Circle": lambda: bm.Circle(0.1),
    "Damping": lambda: bm.Damping(stiffness=0.1),
    "DecayRatio": lambda: bm.ratio_from_decay([1.0, 0.9, 0.82]),
    "End": lambda: bm.End(mass=0.5),
    "FlutterLoad": lambda: bm.flutter_load(CHAIN),
    "GivenSection": lambda: bm.GivenSection(0.01, 1e-6, 1e-7),
    "ISection": lambda: bm.ISection(0.2, 0.1, 0.01, 0.005),
    "Integrator": lambda: bm.INTEGRATORS["rk4"],
    "LinearModel": lambda: bm.linearize(bm.Chain(bm.Beam.unit(), "clamped-free", 3)),
    "Load": lambda: bm.Load(axial_force=0.1, gravity=(0.0, -9.81)),
    "Normal": lambda: bm.Normal(1.0, 0.1),
    "Rectangle": lambda: bm.Rectangle(0.1, 0.2),
    "Rod": lambda: bm.Rod.arc(1.0, length=1.0, **WIRE),
    "Rod through points": lambda: bm.Rod.through([(0, 0, 0), (1, 0, 0), (2, 1, 0), (3, 1, 1)], **WIRE),
    "JointLaw": lambda: bm.JOINT_LAWS["yzx"],
    "SpatialLoad": lambda: bm.SpatialLoad(force=(0.0, 0.0, 1.0)),
    "RodEnd": lambda: bm.RodEnd(mass=0.5, rotary_inertia=(0.1, 0.2, 0.3)),
    "RodEnds": lambda: bm.RodEnds.of("clamped-pinned"),
    "Joint": lambda: bm.Joint(0, 1, "pinned", mass=0.5),
    "LineLoad": lambda: bm.LineLoad(2.0),
    "Member": lambda: bm.Member(bm.Beam.unit(), "foot", "tip"),
    "PointLoad": lambda: bm.PointLoad(0.5, -2.0),
    "Station": lambda: bm.Station(0.5, mass=0.1),
    "Structure": lambda: bm.Structure.of_beam(bm.Beam.unit(), "clamped-free", [bm.Station(0.5, mass=0.1)]),
    "Rule": lambda: bm.RULES["gregory"],
    "AxiallyCorrected": lambda: bm.axially_corrected("mitiguy", bm.Load(axial_force=0.1), UNIT),
    "ModeTuned": lambda: bm.mode_tuned(1),
    "AxialTuned": lambda: bm.mode_tuned(1, motion="twist"),
    "Matched": lambda: bm.matched(2),
    "AxialMatched": lambda: bm.matched(2, motion="twist"),
    "EnoughSegments": lambda: bm.segments_within_spread(SPREAD),
    "ErrorLaw": lambda: bm.error_law("clamped-free", 1),
    "Study": lambda: bm.Study.grid(boundary="free-free", segments=[3, 4], mode=1, compute="relative_error"),
    "Statics": lambda: bm.beam_statics(UNIT, "clamped-free", "tip_force"),
    "Table": lambda: bm.Table([0.0, 0.5, 1.0], [1.0, 0.8, 0.7]),
    "Tolerance": lambda: bm.Tolerance(0.1),
    "Tube": lambda: bm.Tube(0.1, wall=0.01),
    "Uniform": lambda: bm.Uniform(1.0, 2.0),
    "Weight": lambda: bm.Weight(1, 2),
}
#: Results: equal to themselves only.
FOUND: dict[str, Callable[[], Any]] = {
    "Audit": lambda: bm.audit_chain(
        UNIT,
        "clamped-free",
        length=CHAIN.length,
        mass=CHAIN.mass,
        rotary_inertia=CHAIN.rotary_inertia,
        joint_stiffness=CHAIN.joint_stiffness,
    ),
    "AxialAudit": lambda: bm.audit_file(FLAT_FILE, SHAFT, "fixed-free", modes=1, motion="twist"),
    "SpatialAudit": lambda: bm.audit_file(FLAT_FILE, FLAT, "clamped-free", modes=2, motion="space"),
    "MendedFile": lambda: bm.mend_file(
        FILE, FILE.with_name("mended.xml"), UNIT, "clamped-free", modes=1, force=True
    ),
    "AxialModes": lambda: bm.axial_modes(
        bm.Beam(1, 1, 1, axial_stiffness=2), "free-free", 2, motion="stretch"
    ),
    "BeamModes": lambda: bm.euler_bernoulli(UNIT, "clamped-free", 2),
    "SupportedBeamModes": lambda: bm.euler_bernoulli(UNIT, BODY, 2),
    "SpectralBeamModes": lambda: bm.euler_bernoulli(TAPERED, "clamped-free", 2),
    "TimoshenkoModes": lambda: bm.timoshenko(
        UNIT, "clamped-free", 2, shear_stiffness=100.0, rotary_inertia_per_length=0.01
    ),
    "BentModel": lambda: bm.BentModel(bm.find_equilibrium(CHAIN, bm.Load(tip_moment=0.1))),
    "DerivedChain": lambda: bm.derive_chain(bm.Chain(UNIT, "clamped-free", 2)),
    "Equilibrium": lambda: bm.find_equilibrium(CHAIN, bm.Load(tip_moment=0.1)),
    "Modes": lambda: bm.solve_modes(bm.linearize(CHAIN)),
    "RodModes": lambda: bm.rod_modes(bm.Rod(1.0, **WIRE), "clamped-free", 2),
    "SpatialChain": lambda: bm.SpatialChain(bm.Rod(1.0, **WIRE), "clamped-free", 3),
    "SpatialEquilibrium": lambda: bm.spatial_equilibrium(
        bm.SpatialChain(bm.Rod(1.0, **WIRE), "clamped-free", 3)
    ),
    "SpatialModes": lambda: bm.spatial_modes(bm.SpatialChain(bm.Rod(1.0, **WIRE), "clamped-free", 3)),
    "StructureChain": lambda: bm.StructureChain(SPAN, 4),
    "StructureChainModes": lambda: bm.structure_chain_modes(bm.StructureChain(SPAN, 4), 2),
    "StructureModes": lambda: bm.structure_modes(SPAN, 2),
    "StructureStatics": lambda: bm.structure_statics(SPAN, [bm.PointLoad(0.5, -2.0)]),
    "AxialChainModes": lambda: bm.solve_modes(bm.AxialChain(BAR, "fixed-free", 3, motion="stretch")),
    "AxialMatchedSprings": lambda: bm.match_springs("fixed-free", 4, 2, motion="twist"),
    "CompiledEquations": lambda: bm.compile_equations(CHAIN),
    "Energies": lambda: bm.symbolic_energies(bm.Chain(UNIT, "clamped-free", 2)),
    "EquationsOfMotion": lambda: bm.equations_of_motion(bm.Chain(UNIT, "clamped-free", 2)),
    "StepVerdict": lambda: bm.StepVerdict(0.001, 0.002, "rk4", False),
    "Suggestion": lambda: bm.audit_chain(UNIT, "clamped-free", **SOFT).suggestions[0],
    "MatchedSprings": lambda: bm.match_springs("clamped-free", 3, 2),
    "Recommendation": lambda: bm.recommend("clamped-free", 0.01, 2)[0],
}


def test_every_public_value_is_here() -> None:
    classes = {
        name
        for name in bm.__all__
        if inspect.isclass(getattr(bm, name)) and dataclasses.is_dataclass(getattr(bm, name))
    }
    assert classes <= MADE.keys() | FOUND.keys()
    for name in classes:
        made = {**MADE, **FOUND}[name]()
        assert type(made) is getattr(bm, name) and getattr(bm, name).__dataclass_params__.frozen


def twins(value: Any) -> list[Any]:
    copies = [
        pickle.loads(pickle.dumps(value, protocol)) for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1)
    ]
    return [*copies, copy.copy(value), copy.deepcopy(value)]


@pytest.mark.parametrize("name", MADE)
def test_values_made_from_equal_parts_are_equal_and_survive_pickling(name: str) -> None:
    value = MADE[name]()
    for other in (value, MADE[name](), *twins(value)):
        assert (value == other) is True and (value != other) is False and hash(value) == hash(other)
    assert (value == object()) is False and value not in (None, 1, "x")
    assert len({value, MADE[name]()}) == 1


def alike(a: Any, b: Any) -> bool:
    """Whether two values are built alike, whatever their == says."""
    if isinstance(a, np.ndarray):
        return isinstance(b, np.ndarray) and np.array_equal(a, b, equal_nan=a.dtype.kind in "fc")
    if dataclasses.is_dataclass(a) and type(a) is type(b):
        return all(alike(getattr(a, f.name), getattr(b, f.name)) for f in dataclasses.fields(a))
    if isinstance(a, tuple | list):
        return len(a) == len(b) and all(map(alike, a, b))
    if isinstance(a, dict):
        return isinstance(b, dict) and list(a) == list(b) and all(alike(a[key], b[key]) for key in a)
    return type(a) is type(b) and (a == b or a is b or repr(a) == repr(b))


@pytest.mark.parametrize("name", FOUND)
def test_results_are_equal_to_themselves_only_and_survive_pickling(name: str) -> None:
    value = FOUND[name]()
    assert (value == value) is True and hash(value) == hash(value)
    for other in (FOUND[name](), *twins(value)):
        assert (value == other) is False and (value != other) is True
        assert isinstance(hash(other), int) and len({value, other}) == 2
        assert alike(value, other)


def test_a_course_is_what_it_was_made_from() -> None:
    course = bm.harmonic(0.1, 2.0)
    assert course != bm.harmonic(0.1, 3.0) and course != bm.spin_up(0.1, 2.0)
    time = np.linspace(0.0, 20.0, 7)
    for made in (course, bm.spin_up(6.0, 15.0)):
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(made))(time), made(time))
    # What is at rest stays so, and does not turn.
    assert not pickle.loads(pickle.dumps(bm.BaseMotion(x=course))).turns
