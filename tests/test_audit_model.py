"""Audits of files: every exported chain is known again, in every format."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import turns
from drawn_ends import ENDS
from hypothesis import example, given, settings
from hypothesis import strategies as st
from test_engines import ALL, OPEN

from beammodes.accuracy.chain_against_beam import chain_errors
from beammodes.auditing.audit_model import audit_file
from beammodes.chains.chain import Chain
from beammodes.exporters.export import export_chain
from beammodes.problem.beam import Beam
from beammodes.problem.ends import End

BEAM = Beam(1.2, 85.0, 0.62)
RULES = ["mitiguy", "half_stub", "rigid_stub", "hencky", "gregory", "naive"]
PLAIN = [name for name, ends in ALL.items() if isinstance(ends, str)]
SUFFIXES = [".xml", ".xml", ".urdf", ".sdf", ".csv"]
#: Each of the ends with two rules in turn, every rule with the first ends; other pairs are drawn below.
PAIRS = list(
    dict.fromkeys(
        [(case, RULES[(i + 3 * k) % 6]) for i, case in enumerate(OPEN) for k in range(2) if case != "hub"]
        + [(next(iter(OPEN)), rule) for rule in RULES]
    )
)


def known_again(chain: Chain, found: Any) -> None:
    """Assert that an audit of its file tells a chain's errors, rule and N."""
    due = chain_errors(chain, 3) if chain.elastic_modes >= 3 else chain_errors(chain, chain.elastic_modes)
    np.testing.assert_allclose(found.errors[: len(due)], due, rtol=1e-7, atol=2e-8)
    assert found.segments == chain.segments
    assert chain.rule is not None
    assert chain.rule.name in found.remark
    assert found.length_mismatch == pytest.approx(0, abs=1e-9)


def in_turns(cases: Iterable[str], rules: int) -> list[tuple[str, str]]:
    """Return every case with so many of the rules, the next case with the next of them."""
    return [(case, RULES[(i + 6 // rules * k) % 6]) for i, case in enumerate(cases) for k in range(rules)]


@pytest.mark.parametrize(("case", "rule"), in_turns([case for case in ALL if case != "hub"], 2))
def test_exported_mjcf_is_known_again(case: str, rule: str, tmp_path: Path) -> None:
    """By the user's word on its ends, and where the ends are plain, by the file alone."""
    chain = Chain(BEAM, ALL[case], segments=6, rule=rule)
    (path,) = export_chain(chain, tmp_path / "chain.xml")
    known_again(chain, audit_file(path, BEAM, chain.boundary))
    if case in PLAIN:
        found = audit_file(path, BEAM)
        known_again(chain, found)
        assert found.boundary in (chain.boundary, chain.boundary.turned)


@pytest.mark.parametrize(
    ("rule", "suffix", "spring"),
    list(zip(RULES, [".xml", ".urdf", ".sdf", ".csv"] * 2, [0.0, 12.0, 0.0] * 2, strict=False)),
)
def test_a_hub_is_known_again(rule: str, suffix: str, spring: float, tmp_path: Path) -> None:
    """What turns on the first hinge without being made as a segment is a hub, said by the user or not."""
    hub = End.hub(0.3, 0.05, spring)
    chain = Chain(BEAM, (hub, "free"), segments=6, rule=rule)
    path = export_chain(chain, tmp_path / f"chain{suffix}")[0]
    for word in (None, chain.boundary):
        found = audit_file(path, BEAM, word)
        known_again(chain, found)
        end = found.boundary.left
        read = [float(end.hub_radius), float(end.rotary_inertia), float(end.rotational_stiffness)]
        assert read == pytest.approx([0.3, 0.05, spring], rel=1e-6)
    assert "is a hub, and the beam begins 0.3 m beside" in audit_file(path, BEAM).text
    with pytest.raises(ValueError, match=r"the file's hub_radius of 0\.3, got 0\.2"):
        audit_file(path, BEAM, (End.hub(0.2, 0.05, spring), "free"))


@pytest.mark.parametrize(("pair", "suffix"), turns.in_turns(PAIRS, [".urdf", ".sdf", ".csv"], every=2))
def test_other_formats_are_known_again(pair: tuple[str, str], suffix: str, tmp_path: Path) -> None:
    case, rule = pair
    chain = Chain(BEAM, OPEN[case], segments=6, rule=rule)
    path = export_chain(chain, tmp_path / f"chain{suffix}")[0]
    known_again(chain, audit_file(path, BEAM, chain.boundary))


@given(ENDS, ENDS, st.integers(4, 6), st.sampled_from(RULES), st.sampled_from(SUFFIXES))
@example(End(math.inf, 0.0, 1.0, 0.0, -0.1), End(1.0, math.inf), 4, "half_stub", ".xml")
@example(End(0.0, math.inf), End(math.inf, 1.0), 4, "half_stub", ".xml")
@example(End(0.0, math.inf), End(0.0, 1.0, 1.0, 0.0, -0.1), 4, "mitiguy", ".xml")
@example(End(), End(math.inf, 1.0, 0.0, 0.0625, -0.1), 4, "mitiguy", ".xml")
@example(End(0.0, 284.0), End(0.0, math.inf), 4, "half_stub", ".xml")
@example(End(0.0, 6800.0, 0.0, 0.0625), End(0.0, math.inf), 4, "mitiguy", ".xml")
@example(End(1.0, math.inf), End(1.0, math.inf, 0.125), 4, "mitiguy", ".xml")
@settings(max_examples=30)
def test_any_exported_ends_are_known_again(
    tmp_path_factory: pytest.TempPathFactory, left: End, right: End, segments: int, rule: str, suffix: str
) -> None:
    try:
        chain = Chain(BEAM, (left, right), segments, rule)
    except ValueError:  # a rule without positive springs for so short a chain
        return
    folder = tmp_path_factory.mktemp("any")
    try:
        path = export_chain(chain, folder / f"chain{suffix}")[0]
    except ValueError:  # ends that this format cannot say
        path = export_chain(chain, folder / "chain.xml")[0]
    found = audit_file(path, BEAM, chain.boundary)
    due = chain_errors(chain, min(3, chain.elastic_modes))
    np.testing.assert_allclose(found.errors[: len(due)], due, rtol=1e-6, atol=1e-7)
