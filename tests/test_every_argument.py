"""Every argument of every public function, by its signature: what is not of its kind is refused by name."""

from __future__ import annotations

import inspect
import itertools
import math
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import beammodes as bm

BEAM = bm.Beam(1.0, 20.0, 0.5)
SHAFT = bm.Beam(1.0, 20.0, 0.5, torsional_stiffness=8.0, polar_inertia_per_length=1e-4)
ROD = bm.Rod(1.0, 20.0, 15.0, 0.5, 1e-3, curvature=(0.5, 0.0, 1.0))
#: A straight shaft between bearings, which a torque buckles.
GREENHILLS = bm.SpatialChain(
    bm.Rod(1.0, 1.0, 1e9, 1.0),
    (bm.RodEnd(math.inf, (math.inf, 0, 0)), bm.RodEnd((0, math.inf, math.inf))),
    segments=4,
    rule="double_wall",
)
SPATIAL = bm.SpatialChain(ROD, "clamped-free", 3)
BAR = bm.Rectangle(width=0.06, height=0.02)
CHAIN = bm.Chain(BEAM, "clamped-free", 4)
PIECES = {
    "length": [0.5, 0.5],
    "mass": [0.25, 0.25],
    "rotary_inertia": [1e-3, 1e-3],
    "joint_stiffness": [40.0],
}
CLAMPED_PIECES = PIECES | {
    "length": [0.0, 0.5, 0.5],
    "mass": [0.0, 0.25, 0.25],
    "rotary_inertia": [0.0, 1e-3, 1e-3],
}
MATERIAL = {"elastic_modulus": 207e9, "density": 7850.0, "length": 1.0}
STUDY = {"boundary": "clamped-free", "segments": [2, 3], "mode": [1, 2], "compute": "relative_error"}
SPREAD = bm.frequency_spread(BAR, "clamped-free", {"height": 0.02}, 2, **MATERIAL, samples=100)

FRAME = bm.Structure.of_beam(BEAM, "clamped-free", [bm.Station(0.4, mass=0.1)])

#: By name: a call that works. Each of its arguments is then replaced.
GOOD: dict[str, dict[str, Any]] = {
    "AxialChain": {"beam": SHAFT, "boundary": "fixed-free", "segments": 3, "rule": "mitiguy"},
    "AxialEnd": {"stiffness": 1.0, "inertia": 0.5},
    "BaseMotion": {"x": bm.harmonic(0.1, 2.0), "hub_radius": 0.1},
    "BaseMotion.at": {"self": bm.BaseMotion(), "time": [0.0, 0.5]},
    "Beam": {
        "length": 1.0,
        "bending_stiffness": 2.0,
        "mass_per_length": 0.5,
        "rotary_inertia_per_length": 0.0,
    },
    "Beam.from_section": {"section": BAR, **MATERIAL, "rotary_inertia": True},
    "BeamModes.shape": {
        "self": bm.euler_bernoulli(BEAM, "clamped-free", 2),
        "x": [0.0, 0.5],
        "derivative": 1,
    },
    "BeamModes.slope": {"self": bm.euler_bernoulli(BEAM, "clamped-free", 2), "x": [0.0, 0.5]},
    "Box": {"width": 0.02, "height": 0.03, "wall": 0.002},
    "Chain": {"beam": BEAM, "boundary": "clamped-free", "segments": 3, "rule": "mitiguy"},
    "Chain.from_pieces": {**PIECES, "boundary": "pinned-free", "centre": [0.25, 0.25]},
    "Chirp": {"first": 1.0, "last": 2.0, "duration": 1.0, "start": 0.5},
    "Circle": {"diameter": 0.02},
    "Damping": {"mass": 0.1, "stiffness": 1e-3, "joint": 0.01},
    "End": {
        "translational_stiffness": 1.0,
        "rotational_stiffness": 2.0,
        "mass": 0.1,
        "rotary_inertia": 0.1,
        "offset": 0.1,
    },
    "End.hub": {"hub_radius": 0.5, "rotary_inertia": 2.0, "rotational_stiffness": 3.0},
    "Ends": {
        "translational_stiffness": [1.0, 2.0],
        "rotational_stiffness": 2.0,
        "mass": 0.1,
        "rotary_inertia": 0.1,
        "offset": 0.1,
    },
    "GivenSection": {"area": 1e-3, "second_moment": 1e-8, "weak_second_moment": 1e-9},
    "ISection": {"width": 0.05, "height": 0.1, "flange": 0.01, "web": 0.005},
    "Joint": {"x": 0.0, "y": 1.0, "support": "pinned", "mass": 0.1, "rotary_inertia": 0.1},
    "LineLoad": {"per_length": 2.0, "start": 0.1, "stop": 0.5},
    "Load": {"axial_force": 1.0, "gravity": (0.0, -9.81), "tip_force": (0.0, 1.0), "tip_moment": 1.0},
    "Normal": {"mean": 1.0, "standard_deviation": 0.1, "within": 6.0},
    "PointLoad": {"x": 0.5, "force": 1.0, "moment": 0.1},
    "Pulse": {"duration": 1.0, "start": 0.5, "shape": "triangle"},
    "Sine": {"frequency": 1.0, "phase": 0.1, "start": 0.5},
    "Step": {"start": 0.5, "rise": 0.1},
    "TimedLoad": {"load": bm.Load(tip_force=1.0), "course": bm.Step(), "follower": False, "breaks": [0.1]},
    "Rectangle": {"width": 0.02, "height": 0.01},
    "Rule.hinge_weights": {
        "self": bm.RULES["mitiguy"],
        "boundary": bm.Boundary.of("clamped-free"),
        "segments": 3,
    },
    "Rule.piece_lengths": {
        "self": bm.RULES["mitiguy"],
        "boundary": bm.Boundary.of("clamped-free"),
        "segments": 3,
    },
    "Study.grid": {**STUDY, "chunk": 2},
    "Study.points": {
        "points": {"segments": [2, 3], "mode": [1, 2]},
        "boundary": "clamped-free",
        "compute": "relative_error",
        "chunk": 2,
    },
    "Study.sampled": {**STUDY, "count": 5, "seed": 1, "right_mass": bm.Uniform(0.0, 1.0), "chunk": 5},
    "Station": {"x": 0.5, "mass": 0.1, "hinge": 2.0},
    "Structure.of_beam": {"beam": BEAM, "boundary": "clamped-free", "stations": [bm.Station(0.5)]},
    "StructureChain": {"structure": FRAME, "segments": 4, "rule": "gregory", "corrected": True},
    "Table": {"x": [0.0, 0.5, 1.0], "value": [1.0, 1.5, 2.0]},
    "Tolerance": {"size": 0.01, "distribution": "uniform"},
    "Tube": {"outer": 0.02, "wall": 0.002},
    "Uniform": {"low": 0.0, "high": 1.0},
    "audit_chain": {"beam": BEAM, "boundary": "pinned-free", **PIECES, "modes": 1, "tolerance": 0.01},
    "axial_displacement": {"beam": SHAFT, "boundary": "fixed-free", "loads": {0.5: 1.0}, "x": [0.5]},
    "axial_modes": {"beam": SHAFT, "boundary": "fixed-free", "modes": 2},
    "axially_corrected": {"rule": "mitiguy", "load": bm.Load(axial_force=1.0), "beam": BEAM},
    "beam_statics": {"beam": BEAM, "boundary": "clamped-free", "load": "tip_force"},
    "buckling_dataset": {"boundary": ["clamped-free"], "segments": [2, 3], "rule": ["mitiguy"]},
    "buckling_load": {"structure": BEAM, "boundary": "clamped-free"},
    "chain_errors": {"chain": CHAIN, "modes": 2},
    "chain_frequency": {"boundary": "clamped-free", "segments": [3], "mode": [1], "rule": "mitiguy"},
    "chain_statics": {"chain": CHAIN, "load": "tip_force"},
    "damped_modes": {"chain": CHAIN, "damping": bm.Damping(joint=0.01)},
    "elastic_modulus": {"material": "steel", "unit": "Pa"},
    "error_dataset": {
        "boundary": ["clamped-free"],
        "segments": [2, 3],
        "modes": 2,
        "rule": ["mitiguy"],
        "over": {"right_mass": [0.0, 0.5]},
    },
    "error_remarks": {"boundary": "clamped-free", "segments": 3, "mode": 1, "rule": "mitiguy"},
    "law_holds_from": {"boundary": "clamped-free", "mode": 1, "rule": "mitiguy"},
    "error_law": {"boundary": "clamped-free", "mode": 1, "rule": "mitiguy"},
    "euler_bernoulli": {"beam": BEAM, "boundary": "clamped-free", "modes": 2},
    "find_equilibrium": {
        "chain": CHAIN,
        "load": bm.Load(tip_force=(0.0, 1.0)),
        "guess": [0.0] * 4,
        "tolerance": 1e-9,
    },
    "flutter_load": {"chain": CHAIN},
    "follower_modes": {"chain": CHAIN, "compression": 1.0},
    "frequency_error": {"boundary": "clamped-free", "segments": [3], "mode": [1], "rule": "mitiguy"},
    "frequency_spread": {
        "section": BAR,
        "boundary": "clamped-free",
        "tolerances": {"height": 0.02},
        "modes": 2,
        **MATERIAL,
        "samples": 100,
        "seed": 1,
        "quantiles": [0.1, 0.9],
    },
    "harmonic": {"amplitude": 0.1, "angular_frequency": 2.0},
    "joint_dampers": {"chain": CHAIN, "ratio": 0.02, "mode": 1},
    "linearize": {"chain": CHAIN},
    "match_springs": {"boundary": "clamped-free", "segments": 3, "modes": 2, "hold_tip_stiffness": True},
    "matched": {"modes": 2},
    "modal_assurance": {"a": [[1.0, 0.0]], "b": [[0.0, 1.0]], "mass": [1.0, 2.0]},
    "modal_response": {
        "beam": BEAM,
        "boundary": "clamped-free",
        "modes": 2,
        "time": [0.0, 0.1],
        "base": bm.BaseMotion(y=bm.harmonic(0.1, 2.0)),
        "initial": [0.0, 0.1],
        "damping_ratio": 0.02,
        "stiffening": True,
        "tolerance": 1e-8,
    },
    "mode_start": {"chain": CHAIN, "mode": 1, "amplitude": 0.1},
    "mode_tuned": {"mode": 1},
    "published_time_step": {"beam": BEAM, "modes": 2},
    "ratio_from_decay": {"peaks": [10.0, 9.1, 8.3], "periods": [0.0, 1.0, 2.0]},
    "rayleigh_damping": {"of": CHAIN, "ratios": {1: 0.01, 2: 0.02}},
    "recommend": {"boundary": "clamped-free", "tolerance": 0.01, "modes": 1, "rules": ["mitiguy", "gregory"]},
    "critical_factor": {
        "chain": GREENHILLS,
        "load": bm.SpatialLoad(torque=1.0),
        "most": 100.0,
        "start": 6.0,
    },
    "rod_error_dataset": {
        "rod": ROD,
        "boundary": "clamped-free",
        "segments": [2, 3],
        "modes": 1,
        "rule": "naive",
    },
    "frequency_response": {
        "system": CHAIN,
        "frequency": [1.0, 2.0],
        "force_at": 1.0,
        "rotation_at": [0.3],
        "damping_ratio": [0.01, 0.02],
        "load": bm.Load(axial_force=1.0),
    },
    "random_response": {
        "system": CHAIN,
        "density": 2.0,
        "band": (0.5, 2.0),
        "base": "turn",
        "deflection_at": 1.0,
        "loss_factor": 0.1,
        "tolerance": 1e-3,
    },
    "response_error": {"boundary": "clamped-free", "segments": [2, 3], "mode": 1, "damping_ratio": 0.01},
    "rod_errors": {"chain": SPATIAL, "modes": 2},
    "rod_modes": {"rod": ROD, "boundary": "clamped-free", "modes": 2},
    "spatial_equilibrium": {"chain": SPATIAL, "load": bm.SpatialLoad(torque=1.0), "joints": "xyz"},
    "spatial_modes": {"chain": SPATIAL, "modes": 2},
    "Rod": {
        "length": 1.0,
        "bending_stiffness": 20.0,
        "torsional_stiffness": 15.0,
        "mass_per_length": 0.5,
        "polar_inertia_per_length": 0.01,
    },
    "RodEnd": {"translational_stiffness": 1.0, "mass": 0.5, "rotary_inertia": 0.1, "offset": (0.1, 0.0, 0.0)},
    "SpatialChain": {"rod": ROD, "boundary": "clamped-free", "segments": 3, "rule": "mitiguy"},
    "SpatialLoad": {"force": (0.0, 0.0, 1.0), "torque": 0.1, "gravity": (0.0, 0.0, -9.81)},
    "segments_needed": {"boundary": "clamped-free", "tolerance": 0.01, "modes": 1, "rule": "mitiguy"},
    "segments_within_spread": {"spread": SPREAD, "rule": "mitiguy", "fraction": 0.3},
    "shape_dataset": {"boundary": ["clamped-free"], "segments": [2, 3], "modes": 2, "rule": ["mitiguy"]},
    "simulate": {
        "chain": CHAIN,
        "duration": 0.01,
        "step": 1e-3,
        "output_step": 1e-3,
        "initial": ([0.01] * 4, [0.0] * 4),
        "tolerance": 1e-6,
        "modes": 1,
        "halve_step": False,
        "progress": False,
    },
    "solve_modes": {"model": bm.linearize(CHAIN), "modes": 2},
    "bang_bang": {"distance": 2.0, "duration": 1.0, "start": 0.5},
    "point_to_point": {"distance": 2.0, "duration": 1.0, "start": 0.5},
    "spin_up": {"rate": 2.0, "duration": 1.0},
    "stable_time_step": {"chain": CHAIN, "integrator": "rk4"},
    "static_dataset": {"boundary": ["clamped-free"], "segments": [2, 3], "rule": ["mitiguy"]},
    "stiffness_from_deflection": {
        "deflection": 0.01,
        "boundary": "clamped-free",
        "length": 1.0,
        "tip_force": 1.0,
    },
    "stiffness_from_frequency": {
        "frequency": 3.0,
        "boundary": "clamped-free",
        "length": 1.0,
        "mass_per_length": 0.5,
        "mode": 1,
    },
    "structure_chain_modes": {"chain": bm.StructureChain(FRAME, 4), "modes": 2},
    "structure_chain_statics": {"chain": bm.StructureChain(FRAME, 4), "load": bm.PointLoad(0.5, force=1.0)},
    "structure_modes": {"structure": FRAME, "modes": 2},
    "structure_modes_under": {
        "structure": FRAME,
        "load": bm.PointLoad(joint="right", force=(1, 2)),
        "modes": 2,
    },
    "structure_statics": {"structure": FRAME, "load": bm.PointLoad(0.5, force=1.0)},
    "symbolic_energies": {"chain": bm.Chain(BEAM, "clamped-free", 1), "symbols": False},
    "equations_of_motion": {"chain": bm.Chain(BEAM, "clamped-free", 1), "symbols": False},
    "theory_errors": {
        "beam": BEAM,
        "boundary": "clamped-free",
        "modes": 2,
        "radius_of_gyration": 0.01,
        "shear_ratio": 3.0,
    },
    "timoshenko": {"beam": bm.Beam.from_section(BAR, **MATERIAL), "boundary": "clamped-free", "modes": 2},
    "derive_chain": {"chain": bm.Chain(BEAM, "clamped-free", 1)},
    "derived_error_dataset": {"boundary": "clamped-free", "segments": [1], "modes": 1},
    "wall_spring_weight": {},
    "wavenumber": {"boundary": "clamped-free", "mode": [1]},
}


def function(name: str) -> Callable[..., Any]:
    found: Any = bm
    for part in name.split("."):
        found = getattr(found, part)
    return found  # type: ignore[no-any-return]


def call(name: str, changes: dict[str, Any]) -> Any:
    given = GOOD[name] | changes
    if "self" in given:
        given = dict(given)
        return getattr(given.pop("self"), name.split(".")[1])(**given)
    return function(name)(**given)


def kinds(name: str) -> Iterator[tuple[str, str]]:
    """Names and annotations of a function's arguments."""
    for argument in inspect.signature(function(name)).parameters.values():
        if argument.name not in ("self", "cls") and argument.kind.name != "VAR_KEYWORD":
            yield argument.name, str(argument.annotation)


def arguments(*words: str) -> list[tuple[str, str]]:
    pattern = re.compile("|".join(rf"\b{word}\b" for word in words))
    return [(name, each) for name in GOOD for each, kind in kinds(name) if pattern.search(kind)]


NO_BOOLS = ["no", "", 0, 1, 1.0, b"", [], np.array([True, False])]


@pytest.mark.parametrize(("name", "argument"), arguments("bool"))
def test_only_true_and_false_are_switches(name: str, argument: str) -> None:
    for value in NO_BOOLS:
        with pytest.raises(TypeError, match=argument):
            call(name, {argument: value})


#: What NumPy or Python would take for a number, or for several.
NO_NUMBERS = {
    "bytes": b"3",
    "pair of bytes": b"33",
    "bytearray": bytearray(b"333"),
    "view of bytes": memoryview(b"33"),
    "text": "3",
    "True": True,
    "NumPy's True": np.bool_(True),
    "masked": np.ma.masked,
    "masked array": np.ma.array([1, 2], mask=[True, False]),
    "complex": 3 + 0j,
    "list of bytes": [b"3", b"4"],
    "list of text": ["3", "4"],
    "list of bools": [True, True],
    "array of bools": np.array([True, True]),
    "list with masked": [np.ma.masked, 1.0],
    "ragged": [1.0, [2.0]],
    "NaN": math.nan,
    "object": object(),
}
NUMBERS = arguments("int", "float", "ArrayLike", "Number", "Columns", "Sequence", "PropertyLike", "Vector")


@pytest.mark.parametrize("name", sorted({name for name, _ in NUMBERS}))
def test_what_is_no_number_is_refused_by_name(name: str) -> None:
    # A function or a bool is what `progress` may be.
    for argument in (argument for of, argument in NUMBERS if of == name and argument != "progress"):
        for kind, value in NO_NUMBERS.items():
            said = "nothing"
            try:
                call(name, {argument: value})
            except (TypeError, ValueError) as error:
                said = str(error)
            # The names of Study's axes and of the numbers in a mapping stand in words of their own.
            named = argument in said or argument in ("tolerances", "over", "points")
            assert said != "nothing" and named, (argument, kind, said)


WHOLE = [(name, argument) for name, argument in arguments("int") if type(GOOD[name].get(argument)) is int]


@pytest.mark.parametrize(("name", "argument"), WHOLE)
def test_whole_numbers_of_numpy_are_whole_numbers(name: str, argument: str) -> None:
    expected = repr(call(name, {})).replace(" ", "")
    for kind in (np.uint8, np.int8, np.int64, np.uint64):
        found = call(name, {argument: kind(GOOD[name][argument])})
        assert repr(found).replace(" ", "") == expected, kind


def test_small_integers_of_numpy_do_not_overflow() -> None:
    # 200 segments in eight bits: 3 N, N - 1 and N² of a rule's weights do not fit.
    pair = bm.Boundary.of("clamped-free")
    for rule in bm.RULES.values():
        for kind in (np.uint8, np.int16):
            segments = kind(200) if kind is np.uint8 else kind(20_000)
            assert rule.hinge_weights(pair, segments)[:3] == rule.hinge_weights(pair, int(segments))[:3]
            small = kind(200)
            assert bm.frequency_error(pair, segments=small, mode=1, rule=rule) == bm.frequency_error(
                pair, segments=200, mode=1, rule=rule
            )
        chain = bm.Chain(BEAM, pair, np.uint8(200), rule)
        np.testing.assert_array_equal(chain.joint_stiffness, bm.Chain(BEAM, pair, 200, rule).joint_stiffness)


def endless() -> dict[str, Any]:
    """Iterables without an end, or as good as without one."""
    return {
        "count": itertools.cycle([1, 2, 3]),
        "words": itertools.repeat("naive"),
        "ends": itertools.repeat("clamped-free"),
        "names": itertools.repeat("relative_error"),
        "numbers": itertools.repeat(0.5),
        "range": range(10**9),
        "longer range": range(1, 10**30),
    }


SEVERAL = arguments(
    *(
        "Iterable",
        "ArrayLike",
        "Columns",
        "Sequence",
        "Any",
        "RuleLike",
        "Mapping",
        "NDArray",
        "BoundaryLike",
    ),
    *("Boundaries", "Rules", "tuple"),
)


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let lists be short, so that finding one out is, too; test_checks has the true bound."""
    monkeypatch.setattr("beammodes.checks.MAX_ITEMS", 10**4)


@pytest.mark.usefixtures("few")
@pytest.mark.parametrize(("name", "argument"), SEVERAL)
def test_what_never_ends_is_refused_by_name(name: str, argument: str) -> None:
    # Ends and names of quantities are read as such by these only; to all others they are words.
    own = {"ends": "boundary", "names": "compute"}
    for kind, value in endless().items():
        if own.get(kind, argument) == argument:
            with pytest.raises((TypeError, ValueError), match=argument):
                call(name, {argument: value})


@pytest.mark.usefixtures("few")
@pytest.mark.parametrize("value", endless(), ids=str)
@pytest.mark.parametrize(
    ("name", "mapping", "key"),
    [
        ("error_dataset", "over", "right_mass"),
        ("Study.points", "points", "segments"),
        ("Study.grid", "", "right_mass"),
        ("Study.grid", "", "segments"),
        ("Study.sampled", "", "rule"),
    ],
)
def test_numbers_within_a_mapping_are_bounded_too(name: str, mapping: str, key: str, value: str) -> None:
    given = {key: endless()[value]}
    with pytest.raises((TypeError, ValueError), match=f"{key}|rule|mass|segments"):
        call(name, {mapping: given} if mapping else given)


@pytest.mark.parametrize(("name", "argument"), [pair for pair in arguments("int") if pair[1] == "modes"])
@pytest.mark.parametrize("modes", [10**9, 2**63, 10**30])
def test_numbers_of_modes_are_bounded(name: str, argument: str, modes: int) -> None:
    if name in ("solve_modes", "structure_chain_modes"):  # these give all that the chain has
        found = call(name, {argument: modes})
        has = CHAIN.elastic_modes if name == "solve_modes" else found.elastic_modes
        assert len(found.angular_frequency) == has
        return
    with pytest.raises(ValueError, match=r"modes must be (a whole number of at least 1 and )?at most"):
        call(name, {argument: modes})


def test_tables_of_names_are_read_only() -> None:
    import importlib
    import pkgutil

    found = []
    for module in pkgutil.walk_packages(bm.__path__, "beammodes."):
        if module.name.endswith("__main__"):
            continue
        values = vars(importlib.import_module(module.name))
        found += [
            f"{module.name}.{name}"
            for name in values
            if name.isupper() and not name.startswith("_") and isinstance(values[name], dict | list | set)
        ]
    assert found == []
    for table in (bm.RULES, bm.ENDS, bm.MODULI, bm.INTEGRATORS):
        with pytest.raises(TypeError, match="does not support item assignment"):
            table["own"] = None  # type: ignore[index]


@pytest.mark.parametrize("tolerance", [1.0, 0.1, 1.1e-3, 0.0, -1.0, 1e-14])
def test_an_equilibrium_is_not_found_to_a_tolerance_that_is_none(tolerance: float) -> None:
    with pytest.raises(ValueError, match=r"tolerance must be 1e-13 to 0\.001"):
        call("find_equilibrium", {"tolerance": tolerance})


@pytest.mark.parametrize("value", [1.1e30, 1e100, 1e300])
@pytest.mark.parametrize(
    "number", ["translational_stiffness", "rotational_stiffness", "mass", "rotary_inertia", "offset"]
)
def test_numbers_of_ends_beyond_all_digits_are_refused_by_name(number: str, value: float) -> None:
    given = {number: value} | ({"mass": 1.0} if number == "offset" else {})
    ends = bm.Boundary.of(("pinned", bm.End(**given)))
    unit = bm.Beam.unit()
    asked: list[Callable[[], Any]] = [
        lambda: bm.euler_bernoulli(unit, ends, 2),
        lambda: bm.frequency_error(ends, segments=5, mode=1),
        lambda: bm.segments_needed(ends, 0.01),
        lambda: bm.recommend(ends, 0.01),
    ]
    for ask in asked:
        with pytest.raises(ValueError, match=f"{number} must be"):
            ask()


@pytest.mark.parametrize("value", [1.1e30, 1e100, 1e300])
def test_an_axial_force_beyond_all_digits_is_refused_by_name(value: float) -> None:
    load, unit = bm.Load(axial_force=value), bm.Beam.unit()
    asked: list[Callable[[], Any]] = [
        lambda: bm.euler_bernoulli(unit, "clamped-free", 2, load=load),
        lambda: bm.frequency_error("clamped-free", segments=5, mode=1, load=load, beam=unit),
        lambda: bm.segments_needed("clamped-free", 0.01, load=load, beam=unit),
    ]
    for ask in asked:
        with pytest.raises(ValueError, match="axial_force must be"):
            ask()


def test_every_public_function_is_in_the_table() -> None:
    # Those that are left out read a file or draw; their own tests try their arguments.
    elsewhere = {
        "animate",
        "audit_file",
        "compile_equations",
        "draw_chain",
        "draw_statics",
        "export_chain",
        "from_sectionproperties",
        "mend_file",
        "open_study",
        "plot_response",
        "read_chain_csv",
    }
    functions = {name for name in bm.__all__ if inspect.isfunction(getattr(bm, name))}
    assert functions - set(GOOD) == elsewhere
    for name in GOOD:
        call(name, {})


@pytest.mark.parametrize("switch", ["force", "fragment"])
def test_switches_of_the_export_are_true_or_false(switch: str, tmp_path: Path) -> None:
    path = tmp_path / "chain.xml"
    path.write_text("mine")
    for value in NO_BOOLS:
        with pytest.raises(TypeError, match=f"{switch} must be True or False"):
            bm.export_chain(CHAIN, path, **{switch: value})
    assert path.read_text() == "mine"
