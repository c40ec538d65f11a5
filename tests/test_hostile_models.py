"""Model files made to harm: one short refusal each, in bounded time and memory."""

from __future__ import annotations

import math
import os
import re
import subprocess
import sys
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beammodes.__main__ import main
from beammodes.auditing.audit_model import audit_file
from beammodes.auditing.bounded_xml import MAX_BYTES, MAX_DEPTH, MAX_ELEMENTS, read_xml
from beammodes.auditing.read_urdf import read_springs
from beammodes.chains.chain import Chain
from beammodes.exporters.export import export_chain
from beammodes.problem.beam import Beam
from beammodes.vibration.damping import Damping

BEAM = Beam(1.0, 20.0, 0.5)
HINGE = (
    '<joint axis="0 1 0" stiffness="200"/><geom type="capsule" fromto="0 0 0 .1 0 0" size=".01" mass="1"/>'
)
CHAIN = f'<body>{HINGE}<body pos=".1 0 0">{HINGE}</body></body>'
GOOD = f"<mujoco><worldbody>{CHAIN}</worldbody></mujoco>"

TENFOLD = "".join(f'<!ENTITY l{i + 1} "{f"&l{i};" * 10}">' for i in range(9))
LAUGHS = f'<!ENTITY l0 "ha">{TENFOLD}'
LINK = '<link name="{0}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>'
JOINT = '<joint name="{0}{1}" type="revolute"><parent link="{0}"/><child link="{1}"/></joint>'


def robot(*joints: tuple[str, str], links: str = "abc") -> str:
    return (
        "<robot>" + "".join(map(LINK.format, links)) + "".join(JOINT.format(*j) for j in joints) + "</robot>"
    )


# Name: content, what the message must say, and the file's ending.
FILES: dict[str, tuple[str | bytes | Callable[[], str | bytes], str, str]] = {
    "empty": ("", "no element found", ".xml"),
    "truncated": (GOOD[:200], "no well-formed XML", ".xml"),
    "truncated in a tag": (GOOD[:-30], "no well-formed XML", ".xml"),
    "two roots": (GOOD + GOOD, "junk after document element", ".xml"),
    "unknown entity": ("<mujoco>&x;</mujoco>", "undefined entity", ".xml"),
    "billion laughs": (
        f"<!DOCTYPE l [{LAUGHS}]><mujoco>&l9;</mujoco>",
        "no document type declaration",
        ".xml",
    ),
    "quadratic blowup": (
        lambda: f'<!DOCTYPE l [<!ENTITY a "{"a" * 10**5}">]><mujoco a="{"&a;" * 10**5}"/>',
        "no document type declaration",
        ".xml",
    ),
    "external entity": (
        '<!DOCTYPE m [<!ENTITY x SYSTEM "file:///etc/passwd">]><mujoco model="&x;"/>',
        "no document type declaration",
        ".xml",
    ),
    "external declaration": (
        '<!DOCTYPE m SYSTEM "http://example.org/m.dtd"><mujoco/>',
        "document type",
        ".xml",
    ),
    "a million bodies": (
        lambda: f"<mujoco><worldbody>{'<body/>' * 10**6}</worldbody></mujoco>",
        "200000 elements",
        ".xml",
    ),
    "sixty thousand bodies with springs": (
        lambda: f"<mujoco><worldbody>{f'<body>{HINGE}</body>' * 60_000}</worldbody></mujoco>",
        "at most 5000 bodies",
        ".xml",
    ),
    "a million nested bodies": (
        lambda: "<mujoco><worldbody>" + "<body>" * 10**6,
        "nested at most 600",
        ".xml",
    ),
    "a huge attribute": (
        lambda: f'<mujoco><worldbody><body name="{"x" * 8_000_000}"/></worldbody></mujoco>',
        "printable name of at most 200",
        ".xml",
    ),
    "a huge number": (lambda: GOOD.replace("200", "9" * 1_000_000), "at most 1e+30", ".xml"),
    "a million numbers": (lambda: GOOD.replace("200", "1 " * 10**6), "1 or 2 or 3 numbers", ".xml"),
    "a name of two lines": (GOOD.replace("<body>", '<body name="a&#10;b">'), "printable name", ".xml"),
    "a name that writes to terminals": (
        GOOD.replace("<body>", '<body name="&#x9b;31m">'),
        "printable",
        ".xml",
    ),
    "a huge class": (
        lambda: GOOD.replace("<body>", f'<body childclass="{"x" * 8_000_000}">'),
        "class",
        ".xml",
    ),
    "a huge text": (
        lambda: f"<sdf><model><link name='l'><pose>{'1 ' * 10**6}</pose></link></model></sdf>",
        "6 numbers",
        ".sdf",
    ),
    "a huge tag": (lambda: f"<{'x' * 8_000_000}/>", "must be <mujoco>", ".xml"),
    "a huge comment": (lambda: f"<mujoco><!--{'x' * 8_000_000}--></mujoco>", "must have a hinge", ".xml"),
    "many attributes": (
        lambda: "<mujoco " + " ".join(f'a{i}=""' for i in range(500_000)) + "/>",
        "must have a hinge",
        ".xml",
    ),
    "a huge file": (lambda: b" " * (MAX_BYTES + 1), "must have at most 16 MiB", ".xml"),
    "zeros": (lambda: b"\0" * 10**6, "no well-formed XML", ".xml"),
    "junk": (bytes(range(256)) * 40, "no well-formed XML", ".xml"),
    "half of UTF-16": (GOOD.encode("utf-16")[:-7], "no well-formed XML", ".xml"),
    "not the encoding it says": (
        '<?xml version="1.0" encoding="utf-8"?><a b="\xff"/>'.encode("latin-1"),
        "well-formed",
        ".xml",
    ),
    "unknown encoding": (
        '<?xml version="1.0" encoding="klingon"?><mujoco/>',
        "XML in UTF-8|no well-formed",
        ".xml",
    ),
    "an encoding of many bytes": (
        '<?xml version="1.0" encoding="utf-7"?><mujoco/>',
        "XML in UTF-8|no well-formed",
        ".xml",
    ),
    "not a codec of text": (
        '<?xml version="1.0" encoding="zlib_codec"?><mujoco/>',
        "XML in UTF-8|no well-formed",
        ".xml",
    ),
    "includes itself": (
        '<mujoco><include file="model.xml"/></mujoco>',
        "<include> must not include a file twice",
        ".xml",
    ),
    "negative stiffness": (GOOD.replace("200", "-200"), "stiffness of at least 0, got -200", ".xml"),
    "NaN": (GOOD.replace("200", "nan"), "finite number, got 'nan'", ".xml"),
    "infinite": (GOOD.replace('mass="1"', 'mass="inf"'), "finite number, got 'inf'", ".xml"),
    "overflow": (GOOD.replace("200", "1e999"), "finite number, got '1e999'", ".xml"),
    "absurd mass": (GOOD.replace('mass="1"', 'mass="1e200"'), "at most 1e+30", ".xml"),
    "negative mass": (GOOD.replace('mass="1"', 'mass="-1"'), "at least 0", ".xml"),
    "negative size": (GOOD.replace('size=".01"', 'size="-.01"'), "above 0", ".xml"),
    "a digit from elsewhere": (GOOD.replace("200", "२००x"), "finite number", ".xml"),
    "a loop of joints": (robot(("a", "b"), ("b", "c"), ("c", "a")), "tree", ".urdf"),
    "two parents": (robot(("a", "c"), ("b", "c")), "second parent", ".urdf"),
    "its own parent": (robot(("a", "a")), "second parent or itself", ".urdf"),
    "a loop apart from the root": (
        robot(("b", "c"), ("c", "b"), links="abcd"),
        "second parent|tree",
        ".urdf",
    ),
    "no such link": (robot(("a", "z")), "join links that exist, got 'z'", ".urdf"),
    "no links": ("<robot/>", "tree", ".urdf"),
    "a million links": (lambda: f"<robot>{'<link/>' * 10**6}</robot>", "200000 elements", ".urdf"),
    "no model": ("<sdf/>", "must have a <model>", ".sdf"),
    "nested models": (
        lambda: f"<sdf>{'<model>' * 500}{'</model>' * 500}</sdf>",
        "nested in at most 20 models",
        ".sdf",
    ),
    "a csv of junk": (bytes(range(256)), "UTF-8", ".csv"),
    "an endless csv": (lambda: b"1," * (MAX_BYTES // 2 + 1), "must have at most 16 MiB", ".csv"),
}


def model(folder: Path, case: str) -> tuple[Path, str]:
    content, message, suffix = FILES[case]
    made = content() if callable(content) else content
    path = folder / f"model{suffix}"
    path.write_bytes(made if isinstance(made, bytes) else made.encode())
    return path, message


#: Of two files that end at the same bound one is in the plain suite; the other's is peak memory below, too.
AGAIN = {
    "sixty thousand bodies with springs",
    "a million links",
    "many attributes",
    "a huge class",
    "a huge comment",
}


@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=[pytest.mark.slow] if case in AGAIN else []) for case in FILES]
)
def test_refused_in_one_line_and_in_bounds(case: str, tmp_path: Path) -> None:
    path, message = model(tmp_path, case)
    large = callable(FILES[case][0])
    if large:
        tracemalloc.start()
    try:
        with pytest.raises((ValueError, OSError), match=message.replace("+", r"\+")) as caught:
            audit_file(path, BEAM)
        if large:
            assert tracemalloc.get_traced_memory()[1] < 150e6  # measured: at most 115 MB
    finally:
        tracemalloc.stop()
    text = str(caught.value)
    assert "\n" not in text
    assert len(text) < 400
    assert text.startswith(str(path))


@pytest.mark.parametrize(
    "case", ["truncated", "billion laughs", "a million nested bodies", "a loop of joints", "junk"]
)
def test_the_command_refuses_in_one_line(
    case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, _ = model(tmp_path, case)
    assert main(["audit", str(path), "--length", "1", "--ei", "20", "--rho-a", "0.5"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert err.startswith("beammodes: ")


def test_what_is_no_file(tmp_path: Path) -> None:
    with pytest.raises(IsADirectoryError, match="is a folder"):
        audit_file(tmp_path, BEAM)
    with pytest.raises(FileNotFoundError):
        audit_file(tmp_path / "absent.xml", BEAM)
    with pytest.raises(ValueError, match="null"):
        audit_file(f"{tmp_path}/a\0b.xml", BEAM)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes here")
def test_a_pipe_that_never_speaks_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.xml")
    with pytest.raises(ValueError, match="ordinary file"):
        audit_file(tmp_path / "pipe.xml", BEAM)


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no such device here")
def test_an_endless_device_is_not_read() -> None:
    with pytest.raises(ValueError, match="ordinary file"):
        audit_file("/dev/zero", BEAM)


def test_the_bounds_are_where_they_are_said_to_be(tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    for depth in (MAX_DEPTH, MAX_DEPTH + 1):
        path.write_text("<a>" * depth + "</a>" * depth)
        if depth > MAX_DEPTH:
            with pytest.raises(ValueError, match="nested"):
                read_xml(path)
        else:
            assert read_xml(path).tag == "a"
    path.write_text(f"<a>{'<b/>' * (MAX_ELEMENTS - 1)}</a>")
    assert len(read_xml(path).children) == MAX_ELEMENTS - 1


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "latin-1"])
def test_the_usual_encodings_are_read(encoding: str, tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    head = f'<?xml version="1.0" encoding="{encoding}"?>'
    path.write_bytes((head + GOOD.replace("<body>", '<body name="träger">', 1)).encode(encoding))
    assert "chain at body träger" in audit_file(path, Beam(0.2, 20.0, 10.0)).notes[0]


# By case: the file, and a part of the message.
SPRINGS = {
    "stiff": ("springs:\n  - {joint: ab, stiffness: -3}", "must"),
    "nan": ("springs:\n  - {joint: ab, stiffness: .nan}", "line 2: stiffness must be a finite number"),
    "no number": ("springs:\n  - {joint: ab, stiffness: stiff}", "line 2: stiffness must be a finite number"),
    "text": ("springs:\n  - {joint: ab, stiffness: '3'}", "line 2: stiffness must be a number, got text"),
    "list": ("springs:\n  - {joint: ab, stiffness: [3]}", "line 2: stiffness must be a number, got none"),
    "twice": (
        "springs:\n  - {joint: ab, stiffness: 3}\n  - {joint: ab, stiffness: 3}",
        "line 3: must not give joint 'ab' a second spring",
    ),
    "key twice": (
        "springs:\n- joint: ab\n  stiffness: 3\n  stiffness: 4",
        "line 4: must not have the key 'stiffness' twice",
    ),
    "springs twice": ("springs: []\nsprings: []", "line 2: must not have the key 'springs' twice"),
    "no such joint": ("springs:\n  - {joint: zz, stiffness: 3}", "must"),
    "no stiffness": ("springs:\n  - {joint: zz}", "with the keys joint and stiffness"),
    "no spring": ("springs:\n  - ab", "with the keys joint and stiffness"),
    "rest": ("springs:\n  - {joint: ab, stiffness: 3, rest: .nan}", "line 2: rest must be a finite number"),
    "key": (
        "springs:\n  - {joint: ab, stifness: 3}",
        r'line 2: key must be one of joint, type, stiffness, rest, got .*did you mean "stiffness"',
    ),
    "damping": ("springs:\n  - {joint: ab, stiffness: 3, damping: 1}", "line 2: key must be one of joint"),
    "type": ("springs:\n  - {joint: ab, type: hinges, stiffness: 3}", 'did you mean "hinge"'),
    "top": ("spring: []", r'line 1: key must be one of model, springs.*did you mean "springs"'),
    "null": ("springs:", "line 1: springs must be a list of springs"),
    "no springs": ("model: a", "must have the key springs"),
    "list alone": ("- {joint: ab, stiffness: 3}", "must have the key springs"),
    "empty": ("", "one document that is not empty"),
    "two documents": ("springs: []\n---\nsprings: []", "line 2: must be one document"),
    "merge": ("springs: []\n<<: {model: b}", "key must be one of model, springs"),
    "code": ("springs: !!python/object/apply:os.system ['true']\n  - !!python/name:x", "must"),
    "tag": ("springs: !!python/object/apply:os.system ['true']", "no anchors, aliases or tags"),
    "anchors": ("a: &a [x,x]\nb: &b [*a,*a]", "no anchors, aliases or tags"),
    "alias": ("springs: &a [*a]", "no anchors, aliases or tags"),
    "tab": ("springs:\n\t- {joint: ab}", "line 2: must be YAML"),
    "not closed": ("springs: [{joint: ab", "must be YAML"),
    "deep": ("springs: " + "[" * 100, "nested more than 6 deep"),
    "many": ("springs: [" + "{}," * 100_000 + "]", "at most 120000 pieces"),
    "large": ("springs: []\n#" + " " * 2**22, "at most 4 MiB"),
    "deeper": ("springs: " + "[" * 100_000, "must"),
    "control": ("springs: []\n# \x01", "must be YAML"),
}


@pytest.mark.parametrize("case", SPRINGS)
def test_springs_beside_a_urdf_file_are_read_as_numbers_only(case: str, tmp_path: Path) -> None:
    text, message = SPRINGS[case]
    (tmp_path / "model.urdf").write_text(robot(("a", "b"), ("b", "c")))
    (tmp_path / "model.springs.yaml").write_text(text)
    with pytest.raises(ValueError, match=message) as caught:
        audit_file(tmp_path / "model.urdf", BEAM)
    assert "\n" not in str(caught.value)


@given(st.text(max_size=60), st.integers(0, 40))
@settings(max_examples=150)
def test_any_springs_file_is_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, put: str, place: int
) -> None:
    path = tmp_path_factory.mktemp("any") / "model.springs.yaml"
    text = "springs:\n- {joint: ab, stiffness: 3.0}\n"
    path.write_text(text[:place] + put + text[place:], encoding="utf-8", errors="replace", newline="")
    refusal = ""
    try:
        found = read_springs(path)
    except ValueError as error:
        refusal = str(error)
    else:
        assert all(math.isfinite(spring.stiffness) for spring in found.values())
    assert "\n" not in refusal


def judged_or_refused(path: Path) -> None:
    """Assert that an audit comes to an end, with one line if it refuses."""
    refusal = ""
    try:
        found = audit_file(path, BEAM, modes=1)
    except (ValueError, OSError) as error:
        refusal = str(error)
    else:
        assert found.errors.shape == (1,)
    assert "\n" not in refusal


NUMBERS = st.floats(allow_nan=True, allow_infinity=True).map(repr) | st.sampled_from(
    ["", "0", "-1", "1e308", "x"]
)


@given(NUMBERS, NUMBERS, NUMBERS, NUMBERS)
@settings(max_examples=150)
def test_any_numbers_are_judged_or_refused(
    tmp_path_factory: pytest.TempPathFactory, stiffness: str, place: str, mass: str, size: str
) -> None:
    path = tmp_path_factory.mktemp("any") / "model.xml"
    text = (
        GOOD.replace("200", stiffness, 1).replace('"1"', f'"{mass}"', 1).replace(".1 0 0", f"{place} 0 0", 1)
    )
    path.write_text(text.replace(".01", size, 1))
    judged_or_refused(path)


NUMBER = re.compile(r"(?<![A-Za-z_0-9.])-?\d+\.?\d*(?:e[-+]?\d+)?(?![A-Za-z_0-9.])")
EXTREMES = st.sampled_from(
    ["0", "-1", "1e30", "-1e30", "1e-100", "1e-30", "1e15", "1e-15", "5e-324", "1e308", "nan"]
)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("suffix", [".xml", ".urdf", ".sdf", ".csv"])
@given(st.lists(st.tuples(st.floats(0, 1, exclude_max=True), EXTREMES), min_size=1, max_size=3))
@settings(max_examples=20)
def test_extreme_numbers_end_in_an_answer_or_one_line(
    tmp_path_factory: pytest.TempPathFactory, suffix: str, changes: list[tuple[float, str]]
) -> None:
    """In every format: no division by zero, no overflow, no warning in place of a refusal."""
    folder = tmp_path_factory.mktemp("extreme")
    chain = Chain(BEAM, "clamped-free", 3)
    path = export_chain(
        chain, folder / f"chain{suffix}", damping=Damping(stiffness=1e-3) if suffix != ".csv" else None
    )[0]
    text = path.read_text(encoding="utf-8")
    for where, number in changes:
        spots = list(NUMBER.finditer(text))
        spot = spots[int(where * len(spots))]
        text = text[: spot.start()] + number + text[spot.end() :]
    path.write_text(text, encoding="utf-8")
    judged_or_refused(path)


@given(st.integers(0, len(GOOD)), st.integers(0, len(GOOD)), st.text(max_size=5))
@settings(max_examples=150)
def test_any_damage_is_judged_or_refused(
    tmp_path_factory: pytest.TempPathFactory, start: int, end: int, put: str
) -> None:
    path = tmp_path_factory.mktemp("any") / "model.xml"
    path.write_bytes((GOOD[: min(start, end)] + put + GOOD[max(start, end) :]).encode("utf-8", "replace"))
    judged_or_refused(path)


def test_peak_memory_of_a_process_is_bounded(tmp_path: Path) -> None:
    resource = pytest.importorskip("resource")
    path, _ = model(tmp_path, "many attributes")
    program = (
        "import resource, sys\n"
        "from beammodes.auditing.audit_model import audit_file\n"
        "from beammodes.problem.beam import Beam\n"
        "before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "try: audit_file(sys.argv[1], Beam.unit())\n"
        "except ValueError: print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)\n"
    )
    ran = subprocess.run(
        [sys.executable, "-c", program, str(path)], capture_output=True, text=True, check=False
    )
    assert ran.stderr == ""
    per_kilobyte = 1 if sys.platform == "darwin" else 1024
    assert int(ran.stdout) * per_kilobyte < 400e6  # expat's own memory too
    assert resource.RUSAGE_SELF == 0
