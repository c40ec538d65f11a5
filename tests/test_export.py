"""Exported files: what they say, when they are written, what is refused; CSV that comes back to the bit."""

from __future__ import annotations

import ast
import json
import math
import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from beammodes import __version__
from beammodes.auditing.read_urdf import read_springs
from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES
from beammodes.exporters.chain_csv import csv_lines, read_chain_csv
from beammodes.exporters.export import export_chain
from beammodes.exporters.formats import FORMATS
from beammodes.exporters.model_tree import links
from beammodes.exporters.planar_tree import planar_tree
from beammodes.problem.beam import Beam
from beammodes.problem.ends import End
from beammodes.problem.loading import Load
from beammodes.vibration.damping import Damping
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes
from beammodes.vibration.stability import stable_time_step

BEAM = Beam(1.2, 85.0, 0.62)
CHAIN = Chain(BEAM, "clamped-free", segments=4, rule="gregory")
_ENDINGS = [kind.suffix for kind in FORMATS.values()]
#: By the ending that says the format, or for formats that share theirs by one with their name.
KINDS = {
    kind.suffix if _ENDINGS.count(kind.suffix) == 1 else f".{name}{kind.suffix}": kind
    for name, kind in FORMATS.items()
}
SUFFIXES = pytest.mark.parametrize("suffix", KINDS)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


@SUFFIXES
def test_the_suffix_says_the_format(suffix: str, tmp_path: Path) -> None:
    kind = KINDS[suffix]
    if suffix != kind.suffix:
        with pytest.raises(ValueError, match=rf"format must be given for .py files, one of .*{kind.name}"):
            export_chain(CHAIN, tmp_path / f"beam{suffix}")
    told = {} if suffix == kind.suffix else {"format": kind.name}
    written = export_chain(CHAIN, str(tmp_path / f"beam{suffix}"), **told)
    assert written[0] == tmp_path / f"beam{suffix}"
    assert sorted(path.name for path in written) == names(tmp_path)
    same = export_chain(CHAIN, tmp_path / "other.text", format=kind.name)
    assert same[0].name == "other.text"
    text, other = written[0].read_text(encoding="utf-8"), same[0].read_text(encoding="utf-8")
    stem = written[0].name.removesuffix(kind.suffix)
    assert text == other.replace("other.text", stem)


@SUFFIXES
def test_the_head_says_what_it_is(suffix: str, tmp_path: Path) -> None:
    for path in export_chain(CHAIN, tmp_path / f"beam{suffix}", format=KINDS[suffix].name):
        text = path.read_text(encoding="utf-8")
        hertz = solve_modes(linearize(CHAIN), 1).frequency[0]
        for word in (__version__, "gregory, 4 segments", "clamped-free", f"{hertz:.8g}", "length 1.2 m"):
            assert word in text
        assert re.search(r"errors against the exact beam: [-+]\d", text)
        assert not re.search(r"\b20\d\d-\d\d\b", text)  # no date: equal chains make equal files


@pytest.mark.parametrize("suffix", [".xml", ".sdf", ".urdf", ".usda"])
def test_twist_is_said_to_be_left_out(suffix: str, tmp_path: Path) -> None:
    assert "twist" in export_chain(CHAIN, tmp_path / f"beam{suffix}")[0].read_text(encoding="utf-8")


@SUFFIXES
def test_a_chain_from_pieces_has_no_errors_to_tell(suffix: str, tmp_path: Path) -> None:
    numbers = {"length": [0, 1, 1], "mass": [0, 1, 2], "rotary_inertia": [0, 0.1, 0.2]}
    chain = Chain.from_pieces(**numbers, joint_stiffness=[2.0, 1.0], boundary="clamped-free")
    text = export_chain(chain, tmp_path / f"beam{suffix}", format=KINDS[suffix].name)[0].read_text(
        encoding="utf-8"
    )
    assert "pieces: 3, given one by one" in text
    assert "errors" not in text


@pytest.mark.parametrize("name", ["a --> b", "<!-- ---", "ends in -", "]]>&<", 'coding: utf-7 """ {rows} \\'])
@SUFFIXES
def test_hostile_rule_names_stay_in_the_comment(suffix: str, name: str, tmp_path: Path) -> None:
    chain = Chain(BEAM, "clamped-free", 3, rule=replace(RULES["mitiguy"], name=name))
    plain = Chain(BEAM, "clamped-free", 3, rule="mitiguy")
    (tmp_path / "plain").mkdir()
    kind = KINDS[suffix].name
    written = export_chain(chain, tmp_path / f"a{suffix}", format=kind)
    texts = [path.read_text(encoding="utf-8") for path in written]
    for text, other in zip(
        texts, export_chain(plain, tmp_path / "plain" / f"a{suffix}", format=kind), strict=True
    ):
        if suffix == ".csv":
            assert read_chain_csv(written[0]).length.tolist() == chain.length.tolist()
        elif text.startswith("<"):
            expected = ElementTree.tostring(ElementTree.parse(other).getroot())
            assert ElementTree.tostring(ElementTree.fromstring(text)) == expected
        elif text.startswith('"'):
            assert ast.dump(ast.parse(text)) == ast.dump(ast.parse(other.read_text(encoding="utf-8")))
    for path in written:
        lines = path.read_text(encoding="utf-8").splitlines()
        assert sum("rule:" in line for line in lines) == 1


@SUFFIXES
def test_an_existing_file_is_kept(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"beam{suffix}"
    path.write_text("mine")
    with pytest.raises(FileExistsError, match=rf"unless force=True, got .*beam\{suffix}"):
        export_chain(CHAIN, path, format=KINDS[suffix].name)
    assert path.read_text() == "mine" and names(tmp_path) == [path.name]
    export_chain(CHAIN, path, format=KINDS[suffix].name, force=True)
    assert path.read_text() != "mine"


def test_existing_springs_are_kept_too(tmp_path: Path) -> None:
    (tmp_path / "beam.springs.yaml").write_text("mine")
    with pytest.raises(FileExistsError, match=r"beam\.springs\.yaml"):
        export_chain(CHAIN, tmp_path / "beam.urdf")
    assert names(tmp_path) == ["beam.springs.yaml"]


def test_a_missing_folder_and_a_folder_in_the_way(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="absent"):
        export_chain(CHAIN, tmp_path / "absent" / "beam.xml")
    (tmp_path / "beam.xml").mkdir()
    with pytest.raises(ValueError, match=r"path must be an ordinary file, got the folder .*beam\.xml"):
        export_chain(CHAIN, tmp_path / "beam.xml", force=True)


@SUFFIXES
def test_nothing_is_written_half(suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: Any) -> None:
        raise OSError("disk full")

    monkeypatch.setattr("beammodes.files.os.link", fail)
    monkeypatch.setattr("beammodes.files.os.replace", fail)
    with pytest.raises(OSError, match="disk full"):
        export_chain(CHAIN, tmp_path / f"beam{suffix}", format=KINDS[suffix].name)
    assert names(tmp_path) == []


@given(st.text(max_size=12), st.none() | st.text(max_size=5) | st.sampled_from(list(FORMATS)))
@settings(max_examples=60)
def test_any_path_is_written_or_refused(
    tmp_path_factory: pytest.TempPathFactory, text: str, format: str | None
) -> None:
    folder = tmp_path_factory.mktemp("any")
    path = folder / text.replace("/", "").replace("..", "")
    known = format in FORMATS if format is not None else path.suffix.lower() in KINDS
    try:
        written = export_chain(CHAIN, path, format=format)
    except (ValueError, OSError):
        assert not known or not re.fullmatch(r"[\w. -]{1,9}", text)
        assert names(folder) == []
    else:
        assert known
        assert sorted(each.name for each in written) == names(folder)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"path": "beam.xlm"}, r'suffix of path.*\.xml, \.sdf.*did you mean "\.xml"'),
        ({"path": "beam"}, "suffix of path"),
        ({"format": "mjfc"}, 'did you mean "mjcf"'),
        ({"name": "two words"}, "name must be a word"),
        ({"name": '"/><x'}, "name must be a word"),
        ({"name": ""}, "name must be a word"),
        # Of SDFormat; Drake's parser refuses them, too.
        ({"path": "beam.sdf", "name": "world"}, "name must be no word that sdf files reserve"),
        ({"path": "beam.sdf", "name": "__arm__"}, "name must be no word that sdf files reserve"),
        ({"integrator": "implicitfas"}, 'did you mean "implicitfast"'),
        ({"timestep": 0.0}, "timestep must be greater than 0"),
        ({"timestep": 1.0}, "timestep must be less than .* RK4"),
        ({"damping": Damping(mass=1.0)}, "mass=0"),
        ({"damping": Damping(joint=(1.0,))}, "joint must have 4 entries"),
        ({"path": "beam.urdf", "fragment": True}, "fragment must be left out for urdf"),
        ({"path": "beam.urdf", "timestep": 0.001}, "timestep must be left out for urdf"),
        ({"path": "beam.sdf", "integrator": "Euler"}, "integrator must be left out for sdf"),
        ({"path": "beam.csv", "second": CHAIN}, "second must be left out for csv"),
        ({"path": "beam.urdf", "load": Load(gravity=9.81)}, "load must be left out for urdf"),
        ({"path": "beam.csv", "damping": Damping()}, "damping must be left out for csv"),
        ({"second": Chain(BEAM, "clamped-free", 5)}, "second must have the length of chain"),
        ({"second": Chain(Beam(1.2, 1.0, 1.0), "clamped-free", 4)}, "second must have the mass of chain"),
        ({"second": Chain(BEAM, "clamped-pinned", 4)}, "second must be held as chain"),
        ({"path": "beam.sdf", "chain": Chain(BEAM, "clamped-pinned", 4)}, "one end only for sdf"),
        ({"path": "beam.urdf", "chain": Chain(BEAM, "guided-guided", 4)}, "one end only for urdf"),
        ({"path": "beam.sdf", "chain": Chain(BEAM, "clamped-free", 5002)}, "at most 5000 pieces for sdf"),
    ],
)
def test_what_is_refused(options: dict[str, Any], message: str, tmp_path: Path) -> None:
    given = {"chain": CHAIN, "path": "beam.xml"} | options
    chain, path = given.pop("chain"), tmp_path / given.pop("path")
    with pytest.raises(ValueError, match=message):
        export_chain(chain, path, **given)
    assert names(tmp_path) == []


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"chain": "chain"}, "chain must be a Chain"),
        ({"path": 3}, "path must be a string or a Path"),
        ({"format": 3}, "format must be one of"),
        ({"second": 3}, "second must be a Chain or None"),
        ({"damping": 0.1}, r"damping must be a Damping or None, got 0.1; joint_dampers\(chain, 0.01\)"),
        ({"load": 9.81}, "load must be a Load or None"),
        ({"timestep": "1"}, "timestep must be a real number"),
    ],
)
def test_what_is_no_argument(options: dict[str, Any], message: str, tmp_path: Path) -> None:
    given = {"chain": CHAIN, "path": tmp_path / "beam.xml"} | options
    with pytest.raises(TypeError, match=message):
        export_chain(given.pop("chain"), given.pop("path"), **given)
    assert names(tmp_path) == []


def time_step(folder: Path, chain: Chain, **options: Any) -> float:
    (path,) = export_chain(chain, folder / "beam.xml", force=True, **options)
    option = ElementTree.parse(path).getroot().find("option")
    assert option is not None
    return float(option.attrib["timestep"])


def test_the_step_is_half_the_stable_one_or_shorter(tmp_path: Path) -> None:
    chain = Chain(BEAM, "clamped-free", 10)
    for integrator in ("RK4", "Euler", "implicit", "implicitfast"):
        for load in (None, Load(), Load(gravity=(300.0, 0.0))):
            held = Load(gravity=9.81) if load is None else load
            half = stable_time_step(chain, f"MuJoCo {integrator}", load=held) / 2
            assert 0.99 * half < time_step(tmp_path, chain, integrator=integrator, load=load) <= half
    few = Chain(BEAM, "clamped-free", 1)
    omega = solve_modes(linearize(few)).angular_frequency[0]
    # The amplitude may shift by 1 % in 100 periods, by z⁶/144 a step; the frequency by 0.1 %, by z²/24.
    limits = (0.01 * 144 / (200 * math.pi)) ** (1 / 5), math.sqrt(24e-3)
    for integrator, limit in zip(("RK4", "Euler"), limits, strict=True):
        step = time_step(tmp_path, few, integrator=integrator, load=Load())
        assert omega * step == pytest.approx(limit, rel=0.02)
    assert time_step(tmp_path, chain, timestep=1e-4) == 1e-4
    # Strong dampers shorten the step where they are taken explicitly only.
    assert time_step(tmp_path, chain, damping=Damping(stiffness=1.0)) < 1e-3 * half
    assert time_step(tmp_path, chain, damping=Damping(stiffness=1e-4), integrator="Euler") > half


def test_without_elastic_modes_any_step_will_do(tmp_path: Path) -> None:
    loose = Chain(BEAM, "free-free", 1)
    assert time_step(tmp_path, loose) == 0.002
    assert time_step(tmp_path, loose, timestep=0.5) == 0.5


ENDS = st.builds(
    End,
    st.sampled_from([0.0, math.inf]) | st.floats(1e-3, 1e3),
    st.sampled_from([0.0, math.inf]) | st.floats(1e-3, 1e3),
    st.just(0.0) | st.floats(0.01, 3.0),
    st.just(0.0) | st.floats(0.01, 3.0),
    st.sampled_from([-0.7, 0.0, 0.01, 1.0]),
)


@given(ENDS, ENDS, st.integers(1, 6), st.sampled_from(["mitiguy", "half_stub", "hencky", "rigid_stub"]))
@settings(max_examples=80)
def test_csv_comes_back_to_the_bit(
    tmp_path_factory: pytest.TempPathFactory, left: End, right: End, segments: int, rule: str
) -> None:
    try:
        chain = Chain(Beam(1.3, 0.7, 0.9), (left, right), segments, rule)
    except ValueError:  # a rule with no springs for so short a chain
        return
    path = tmp_path_factory.mktemp("csv") / "beam.csv"
    path.write_text("".join(csv_lines(chain, [])), encoding="utf-8")
    again = read_chain_csv(path)
    for name in ("length", "mass", "centre", "rotary_inertia", "joint_stiffness", "support_stiffness"):
        assert np.array_equal(getattr(again, name), getattr(chain, name))
    found, known = (solve_modes(linearize(each)).angular_frequency for each in (again, chain))
    assert found == pytest.approx(known, rel=1e-9)


@given(ENDS, ENDS, st.integers(1, 4), st.sampled_from(["mitiguy", "half_stub", "rigid_stub"]))
@settings(max_examples=80)
def test_any_chain_makes_valid_bodies(left: End, right: End, segments: int, rule: str) -> None:
    try:
        chain = Chain(Beam.unit(), (left, right), segments, rule)
    except ValueError:
        return
    tree = planar_tree(chain)
    passed = list(links(tree))
    joints = [joint for body in tree.bodies for joint in body.joints]
    assert [link.joint for link in passed if link.joint] == joints
    assert len({joint.name for joint in joints}) == len(joints)
    assert len({link.body.name for link in passed}) == len(passed)
    for link in passed:
        x, y, z = (link.body.inertia[k][k] for k in range(3))
        assert link.body.mass > 0 and min(x, y, z) > 0
        assert x <= y + z and y <= x + z and z <= x + y
    known = {joint.name for joint in joints}
    assert all(name in known and math.isfinite(arm) for tie in tree.ties for name, arm in tie.terms)


def test_fractions_are_written_as_numbers(tmp_path: Path) -> None:
    third = Fraction(1, 3)
    numbers = {"length": [third] * 2, "mass": [third] * 2, "rotary_inertia": [third] * 2}
    chain = Chain.from_pieces(**numbers, joint_stiffness=[third], boundary="pinned-free")
    again = read_chain_csv(export_chain(chain, tmp_path / "beam.csv")[0])
    assert again.length.tolist() == [1 / 3, 1 / 3]


def changed(path: Path, old: str, new: str) -> Path:
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("# supports: clamped-free", "#", 'one line "# supports: ..."'),
        ("clamped-free\npiece", "clamped-fre\npiece", "boundary must name two of the ends"),
        ("mass_kg", "weight", "column mass_kg"),
        ("\n1,", "\n1,1,", "line 13: must have 6 cells, got 7"),
        ("\n1,0.3", "\n1,long", r"line 13: length_m must be a finite number, got 'long'"),
        ("\n1,0.3", "\n1,inf", "line 13: length_m must be a finite number"),
        ("\n1,0.3", "\n1,-0.3", "length must not be negative"),
        ("\n1,0.3", '\n1,"0.3\n', "line 13"),
    ],
)
def test_a_spoilt_csv_is_refused(old: str, new: str, message: str, tmp_path: Path) -> None:
    (path,) = export_chain(CHAIN, tmp_path / "beam.csv")
    with pytest.raises(ValueError, match=message) as caught:
        read_chain_csv(changed(path, old, new))
    assert str(path) in str(caught.value)


@pytest.mark.parametrize("content", [b"", b"\xff\xfe", b"# supports: clamped-free\n", b"a,b\n1,2\n"])
def test_what_is_no_chain_is_refused(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "beam.csv").write_bytes(content)
    with pytest.raises(ValueError, match=r"beam\.csv"):
        read_chain_csv(tmp_path / "beam.csv")


def test_spreadsheets_may_change_line_ends_and_columns(tmp_path: Path) -> None:
    (path,) = export_chain(CHAIN, tmp_path / "beam.csv")
    text = path.read_text(encoding="utf-8")
    path.write_text("\ufeff" + re.sub(r"(?m)^([^#\n]+)$", r"\1,x", text), encoding="utf-8", newline="\r\n")
    assert read_chain_csv(path).joint_stiffness.tolist() == CHAIN.joint_stiffness.tolist()


@pytest.mark.parametrize("value", [1e-5, 1e22, 3.0, 1.5e-300])
def test_yaml_numbers_have_a_point(value: float, tmp_path: Path) -> None:
    numbers = {"length": [1, 1], "mass": [1, 1], "rotary_inertia": [0.1, 0.1]}
    chain = Chain.from_pieces(**numbers, joint_stiffness=[value], boundary="pinned-free")
    springs = export_chain(chain, tmp_path / "beam.urdf")[1].read_text(encoding="utf-8")
    (found,) = re.findall(r"stiffness: ([^,]+),", springs)
    assert "." in found
    assert float(found) == value


def test_the_springs_name_their_model_where_yaml_takes_the_word_for_none(tmp_path: Path) -> None:
    for name in ("no", "null", "on"):
        springs = export_chain(CHAIN, tmp_path / f"{name}.urdf", name=name)[1]
        assert yaml.safe_load(springs.read_text(encoding="utf-8"))["model"] == name


def rewritten(text: str, how: str) -> str:
    """The same data, as tools that read and write YAML leave it."""
    data = yaml.safe_load(text)
    if how == "JSON":
        return json.dumps(data, indent=2)
    if how == "document":
        return f"%YAML 1.1\n---\n{text}...\n"
    if how == "windows":
        return "\ufeff" + text.replace("\n", "\r\n")
    if how == "no blanks":
        return re.sub(r"(?m)^  - ", "- ", text).replace("rest: 0.0", "rest: 0")
    options = {"blocks": False, "braces": True, "mixed": None}
    return yaml.safe_dump(data, default_flow_style=options[how], sort_keys=how != "mixed", width=30)


def stiffness_of(path: Path) -> dict[str, float]:
    return {joint: spring.stiffness for joint, spring in read_springs(path).items()}


@pytest.mark.parametrize("how", ["blocks", "braces", "mixed", "JSON", "document", "windows", "no blanks"])
@pytest.mark.parametrize("ends", ["clamped-free", "free-free", "pinned-free", "clamped-free(mass=0.1)"])
def test_a_springs_file_may_be_rewritten_by_a_yaml_tool(ends: str, how: str, tmp_path: Path) -> None:
    chain = Chain(Beam(1.2, 85.0, 0.62), ends, 6, "gregory")
    _, springs = export_chain(chain, tmp_path / "beam.urdf")
    before = stiffness_of(springs)
    assert sorted(before.values()) == sorted(chain.joint_stiffness)
    text = springs.read_text(encoding="utf-8")
    springs.write_text(rewritten(text, how), encoding="utf-8", newline="")
    assert stiffness_of(springs) == before


def test_a_hostile_file_name_stays_in_the_comment(tmp_path: Path) -> None:
    urdf, springs = export_chain(CHAIN, tmp_path / "a--b.urdf")
    assert springs.name == "a--b.springs.yaml"
    assert ElementTree.parse(urdf).getroot().tag == "robot"


@pytest.mark.parametrize("ratio", [0.0, 1e-5, 0.02, 0.1])
def test_a_step_that_dampers_shorten_names_a_longer_way(ratio: float, tmp_path: Path) -> None:
    omega = solve_modes(linearize(CHAIN), 1).angular_frequency[0]
    damping = Damping(stiffness=2 * ratio / omega)
    (place,) = export_chain(CHAIN, tmp_path / "beam.xml", damping=damping, load=Load())
    text = place.read_text(encoding="utf-8")
    said = re.search(r"implicitfast, which takes them implicitly, is stable to (\S+) s", text)
    # Of the fastest mode, 2 (z + sqrt(1 + z^2))/omega; offered where it is twice that of Runge-Kutta.
    top = solve_modes(linearize(CHAIN)).angular_frequency[-1]
    z = damping.stiffness * top / 2
    limit = 2 * (z + math.sqrt(1 + z * z)) / top
    offered = ratio > 0 and limit > 2 * stable_time_step(CHAIN, "rk4", damping=damping)
    assert (said is not None) == offered and offered >= (ratio == 0.1)
    if said is not None:
        assert float(said[1]) == pytest.approx(limit, rel=1e-3)
