"""One calling convention over all public functions: names, their order, options by name, what comes back."""

from __future__ import annotations

import ast
import graphlib
import inspect
import itertools
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

import beammodes as bm

#: What is asked about, first in every call.
SUBJECTS = (
    "structure", "section", "rod", "beam", "chain", "system", "model", "spread", "statics",
    "response", "result", "deflection", "frequency", "of",
)  # fmt: skip
#: Then what is asked, in this order: all that may be given without its name.
ASKED = (
    "boundary", "segments", "tolerance", "tolerances", "load", "loads", "damping", "compression", "ratio",
    "ratios", "integrator", "modes", "mode", "amplitude", "rule", "stations", "x", "motion", "ax",
)  # fmt: skip
#: Options: never without their names where they have a default.
BY_NAME = {
    "at", "base", "beam", "criterion", "damping_ratio", "fraction", "initial", "joints", "loss_factor",
    "over", "progress", "radius_of_gyration", "rules", "seed", "shear_ratio", "span", "step",
    "tolerance", "within",
}  # fmt: skip
#: A correction of a rule, whose subject is the rule.
OTHERWISE = {"axially_corrected"}
#: What these words have to be, in every signature.
KINDS = {
    "boundary": r"Bound",
    "load": r"Load",
    "beam": r"Beam",
    "rod": r"Rod",
    "chain": r"Chain|str \| None",
    "mode": r"int|ArrayLike",
    "modes": r"int",
    "segments": r"int|ArrayLike",
    "tolerance": r"^float$",
    "rule": r"Rule|Any",
    "motion": r"^str",
    "progress": r"^Progress \| bool \| None$",
    "force": r"^bool$",
    "path": r"str \|",
}
#: Other words for the same.
STRANGE = {
    "n",
    "n_modes",
    "num_modes",
    "number",
    "pair",
    "bc",
    "tol",
    "rtol",
    "freq",
    "omega",
    "zeta",
    "dt",
}


def signatures() -> Iterator[tuple[str, inspect.Signature]]:
    """Every public function, what makes a chain, and every other way to make a public value."""
    for name in bm.__all__:
        value = getattr(bm, name)
        if inspect.isfunction(value) or (name.endswith("Chain") and name != "DerivedChain"):
            yield name, inspect.signature(value)
        elif inspect.isclass(value) and not issubclass(value, BaseException):
            for key, member in vars(value).items():
                if isinstance(member, classmethod) and key[0] != "_":
                    yield f"{name}.{key}", inspect.signature(getattr(value, key))


SIGNATURES = dict(signatures())


def by_place(signature: inspect.Signature) -> list[inspect.Parameter]:
    return [each for each in signature.parameters.values() if each.kind == each.POSITIONAL_OR_KEYWORD]


def test_what_may_be_given_by_its_place_comes_in_one_order() -> None:
    order = {name: place for place, name in enumerate((*SUBJECTS, *ASKED))}
    before: dict[str, set[str]] = {}
    for name, signature in SIGNATURES.items():
        placed = [each.name for each in by_place(signature)]
        for first, second in itertools.pairwise(placed):
            if name not in OTHERWISE:
                before.setdefault(second, set()).add(first)
        known = [order[each] for each in placed if each in order]
        assert name in OTHERWISE or known == sorted(known), (name, placed)
    # Words of a few functions only must not contradict each other, either.
    assert [*graphlib.TopologicalSorter(before).static_order()]


def test_one_word_is_one_thing_and_options_have_their_names() -> None:
    for name, signature in SIGNATURES.items():
        for each in signature.parameters.values():
            assert each.name not in STRANGE, (name, each.name)
            if each.name in KINDS and each.annotation != "Any":
                assert re.search(KINDS[each.name], str(each.annotation)), (name, str(each))
            if each.name in BY_NAME and each.default is not each.empty and name not in OTHERWISE:
                assert each.kind == each.KEYWORD_ONLY, (name, str(each))
        defaults = {str(each.default) for key, each in signature.parameters.items() if key == "rule"}
        usual = "gregory" if name == "StructureChain" else "mitiguy"
        assert defaults <= {usual, str(inspect.Parameter.empty)}, name


#: Returned, and of no use but by what returns them.
INNER = {"BeamWaves", "Cases", "ExactLinearModel", "Film", "LinearizedChain", "Motion", "Parts"}


def test_what_is_returned_and_raised_is_public() -> None:
    trees = [ast.parse(path.read_text(encoding="utf-8")) for path in Path(bm.__file__).parent.rglob("*.py")]
    classes = [node for tree in trees for node in tree.body if isinstance(node, ast.ClassDef)]
    own = {node.name for node in classes if node.name[0] != "_"}
    for name in bm.__all__:
        value = getattr(bm, name)
        members = vars(value).values() if inspect.isclass(value) else [value]
        for member in members:
            function = getattr(member, "__func__", getattr(member, "fget", member))
            if not inspect.isfunction(function) or function.__name__[0] == "_":
                continue
            words = set(re.findall(r"\w+", str(inspect.signature(function).return_annotation)))
            assert words & own <= {*bm.__all__, *INNER}, (name, function.__name__)
    # Errors that users may catch by name; what is left is of the command line, a store and a search.
    bases = {node.name: {ast.unparse(base) for base in node.bases} for node in classes}
    errors = {
        name for name in own if bases[name] & {"ValueError", "ArithmeticError", "UserWarning", "OSError"}
    }
    assert errors - set(bm.__all__) == {"NotFollowed"}


def test_dataarrays_come_back_as_dataarrays() -> None:
    segments = xarray.DataArray([3, 5, 9], dims="n", coords={"n": [3, 5, 9]})
    mode = xarray.DataArray([1, 2], dims="mode", coords={"mode": [1, 2]})
    ratio = xarray.DataArray(0.01)
    calls: list[tuple[Callable[[Any, Any], Any], tuple[str, ...]]] = [
        (lambda n, k: bm.frequency_error("clamped-free", segments=n, mode=k), ("n", "mode")),
        (lambda n, k: bm.chain_frequency("clamped-free", n, k, "gregory"), ("n", "mode")),
        (lambda _, k: bm.wavenumber("clamped-free", k), ("mode",)),
        (
            lambda n, k: bm.response_error("clamped-free", segments=n, mode=k, damping_ratio=ratio),
            ("n", "mode"),
        ),
    ]
    for call, dims in calls:
        found = call(segments, mode)
        assert found.dims == dims and {*found.coords} == {*dims}
        assert np.array_equal(found, np.asarray(call([[3], [5], [9]], [1, 2])))
    rules = xarray.DataArray(["gregory", "mitiguy"], dims="rule")
    assert bm.frequency_error("clamped-free", segments=segments, mode=1, rule=rules).dims == ("n", "rule")
    with pytest.raises(ValueError, match="arrays beside a DataArray must be DataArrays too"):
        bm.frequency_error("clamped-free", segments=segments, mode=[[1], [2]])


def test_chains_asked_for_more_modes_than_they_have_give_all_of_them() -> None:
    beam = bm.Beam(1.0, 1.0, 1.0, torsional_stiffness=1.0, polar_inertia_per_length=0.1)
    rod = bm.Rod(1.0, 1.0, 1.0, 1.0, 0.1)
    framed = bm.StructureChain(bm.Structure.of_beam(beam, "clamped-free"), 4)
    asked: list[Callable[[int | None], Any]] = [
        lambda n: bm.solve_modes(bm.linearize(bm.Chain(beam, "clamped-free", 4)), n),
        lambda n: bm.solve_modes(bm.AxialChain(beam, "fixed-free", 4), n),
        lambda n: bm.solve_modes(framed, n),
        lambda n: bm.structure_chain_modes(framed, n),
        lambda n: bm.spatial_modes(bm.SpatialChain(rod, "clamped-free", 4), 40 if n is None else n),
    ]
    for ask in asked:
        assert np.array_equal(ask(99).angular_frequency, ask(None).angular_frequency)
