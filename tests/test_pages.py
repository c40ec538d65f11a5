"""The pages: their code runs, their numbers are computed, their links exist."""

from __future__ import annotations

import doctest
import importlib.util
import math
import re
import shlex
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import beammodes as bm
from beammodes.__main__ import main

pytest.importorskip("skfem")

from beammodes.vibration.integrators import find_integrator
from studies.common import element_errors
from studies.tool_layouts import adams_link_errors, flex_errors, held_element_errors

ROOT = Path(__file__).parent.parent
EVERY = sorted((ROOT / "beammodes" / "pages").glob("*.md"))
#: Pages for users of a simulator; the others are about the project itself.
PAGES = [page for page in EVERY if page.stem in ("adams_working_model", "drake_gazebo", "mujoco", "simscape")]
README = (ROOT / "README.md").read_text(encoding="utf-8")
EVERY_PAGE = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
ENGINES = {"mujoco", "pydrake", "pint", "pybullet", "exudyn", "dartpy", "elastica", "newton", "sapien"}
#: What an engine reads files with, and does not install.
READERS = {"newton": "newton_usd_schemas"}
BEAM = bm.Beam(length=1.2, bending_stiffness=85.0, mass_per_length=0.62)
Errors = Callable[[Sequence[int]], NDArray[np.float64]]


def text(page: Path) -> str:
    return page.read_text(encoding="utf-8")


def named(stem: str) -> str:
    return text(ROOT / "beammodes" / "pages" / f"{stem}.md")


def blocks(source: str, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", source, flags=re.DOTALL)


#: Pages that tell one story from the first block to the last.
STORIES = ("audit", "cables", "tutorial", "units")
PYTHON = [
    (page.stem, block) for page in EVERY for block in blocks(text(page), "python") if page.stem not in STORIES
]
PYTHON += [(stem, "\n".join(blocks(named(stem), "python"))) for stem in STORIES]
SHELL = [
    (page.stem, line)
    for page in PAGES
    for block in blocks(text(page), "sh")
    for line in block.splitlines()
    if line
]


#: Where a page says so, its blocks start from this import.
STARTS = "starts from `import beammodes as bm`"


def test_there_are_four_pages_for_simulators_with_code_to_run() -> None:
    assert len(PAGES) == 4
    assert {stem for stem, _ in SHELL} == {page.stem for page in PAGES} <= {stem for stem, _ in PYTHON}


@pytest.mark.filterwarnings("ignore:.*SWIG|.*pydrake|.*numpy:DeprecationWarning")
@pytest.mark.parametrize(("stem", "block"), PYTHON, ids=[f"{s}-{i}" for i, (s, _) in enumerate(PYTHON)])
def test_python_blocks_run(stem: str, block: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    imported = " ".join(re.findall(r"(?:import|from) .*", block))
    for engine in sorted(ENGINES & set(re.findall(r"\w+", imported))):
        for each in {engine, READERS.get(engine, engine)}:
            if importlib.util.find_spec(each) is None:
                pytest.skip(f"{each} is not installed")
    monkeypatch.chdir(tmp_path)
    # Where exported scripts are imported from.
    monkeypatch.syspath_prepend(tmp_path)
    given = {"bm": bm} if STARTS in named(stem) else {}
    test = doctest.DocTestParser().get_doctest(block, given, stem, stem, 0)
    assert test.examples
    assert doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(test).failed == 0


@pytest.mark.parametrize(
    "line", [line for _, line in SHELL], ids=[f"{s}-{i}" for i, (s, _) in enumerate(SHELL)]
)
def test_shell_lines_run_and_answer_what_stands_beside_them(
    line: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    program, *arguments = shlex.split(line, comments=True)
    assert program == "beammodes"
    assert main(arguments) == 0
    answer = capsys.readouterr().out
    said = line.partition("#")[2].strip()
    assert answer.startswith(said) if said else answer.strip()
    if "--output" in arguments:
        assert (tmp_path / arguments[arguments.index("--output") + 1]).stat().st_size > 200
    else:
        assert said or "springs" in arguments


BLOCKS = [
    (page.stem, block)
    for page in EVERY
    if page not in PAGES
    for block in blocks(text(page), "sh")
    if block.startswith("beammodes ")
]


@pytest.mark.parametrize("block", [block for _, block in BLOCKS], ids=[stem for stem, _ in BLOCKS])
def test_shell_blocks_of_other_pages_run(
    block: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for line in block.splitlines():
        program, *arguments = shlex.split(line, comments=True)
        assert program == "beammodes"
        assert main(arguments) == 0
        assert capsys.readouterr().out.strip()


#: Pages with a table of layouts, of MuJoCo's kinds, rules and others.
TABLED = [
    *PAGES,
    *(page for page in EVERY if page.stem in ("dart", "exudyn", "newton_isaac", "pybullet", "sapien")),
]

#: By words of the row, where the layout is no rule.
OTHERS: dict[str, Errors] = {
    '`pin id="0 1"`': flex_errors,
    "the flex, moved half an edge": partial(flex_errors, shifted=True),
    "the cable, begun half a segment": partial(held_element_errors, points=False, inside=0.5),
    "`OneEndFixedBC` at the rod's end": partial(held_element_errors, points=True),
    "the rod begun half an element": partial(held_element_errors, points=True, inside=0.5),
    "`bend_matrix` of the first two": partial(held_element_errors, points=True, first=(12 / 23, 12 / 7)),
    'attachment "rigid"': partial(adams_link_errors, attachment="rigid"),
    'attachment "flexible"': partial(adams_link_errors, attachment="flexible"),
}


def errors_of(layout: str) -> tuple[Errors, int]:
    """Errors against N of a table's row, and their order."""
    rules = set(re.findall(r"`(\w+)`", layout)) & set(bm.RULES)
    if rules:
        (rule,) = rules
        errors = partial(_rule_errors, rule)
        return errors, bm.error_law("clamped-free", 1, rule).order
    (words,) = (words for words in OTHERS if words in layout)
    coarse, fine = OTHERS[words]([40, 80])
    return OTHERS[words], round(math.log2(coarse / fine))


def _rule_errors(rule: str, segments: Sequence[int]) -> NDArray[np.float64]:
    return np.asarray(bm.frequency_error("clamped-free", segments=segments, mode=1, rule=rule))


def percent(error: float) -> str:
    plain = np.format_float_positional(
        100 * error, precision=3, unique=False, fractional=False, sign=True, trim="-"
    )
    return f"{plain} %"


POWERS = {1: "1/N", 2: "1/N²", 3: "1/N³", 4: "1/N⁴"}


@pytest.mark.parametrize("page", [page for page in EVERY if "| layout | N = 5 |" in text(page)], ids=str)
def test_the_table_says_what_the_code_computes(page: Path) -> None:
    rows = re.findall(r"^\| ([^|]*) \| (.*?) \| (1/N.?) \|$", text(page), flags=re.MULTILINE)
    assert len(rows) >= 2
    assert "| layout | N = 5 | N = 10 | N = 20 | falls as |" in text(page)
    for layout, numbers, falls in rows:
        errors, order = errors_of(layout)
        assert numbers.split(" | ") == [percent(error) for error in errors([5, 10, 20])], layout
        assert falls == POWERS[order], layout


@pytest.mark.parametrize("page", EVERY, ids=lambda page: page.stem)
def test_links_and_pictures_exist(page: Path) -> None:
    targets = re.findall(r"\]\(([^)#]+)\)", text(page))
    assert page not in PAGES or "../../figures/simulators.svg" in targets
    for target in targets:
        assert target.startswith("https://") or (page.parent / target).is_file(), target
    assert f"(beammodes/pages/{page.name})" in README


@pytest.mark.parametrize("stem", ["theory", "extending"])
def test_links_within_a_page_lead_to_its_headings(stem: str) -> None:
    headings = re.findall(r"^## (.*)$", named(stem), flags=re.MULTILINE)
    anchors = [re.sub(r"[^\w -]", "", heading).lower().replace(" ", "-") for heading in headings]
    assert re.findall(r"\]\(#([^)]+)\)", named(stem)) == anchors


def test_the_design_lists_the_rooms_in_their_order() -> None:
    rooms = re.findall(r"^\| `(\w+)/` \|", named("design"), flags=re.MULTILINE)
    assert rooms == re.findall(r"^([a-z_]+)/ +\S", bm.__doc__ or "", flags=re.MULTILINE)
    package = ROOT / "beammodes"
    assert set(rooms) == {path.parent.name for path in package.glob("*/__init__.py")}
    assert {path.name for path in package.glob("*.py")} <= set(re.findall(r"`(\w+\.py)`", named("design")))


def test_the_map_names_every_module() -> None:
    rows = re.findall(r"^\| `(\w+)/` \|.*\| ([^|]*) \|$", named("design"), flags=re.MULTILINE)
    mapped = {folder: sorted(re.findall(r"`(\w+)`", files)) for folder, files in rows}
    assert mapped == {
        folder.parent.name: sorted({path.stem for path in folder.parent.glob("*.py")} - {"__init__"})
        for folder in (ROOT / "beammodes").glob("*/__init__.py")
    }


def test_files_that_the_page_on_extending_names_are_there() -> None:
    named_files = re.findall(r"`((?:beammodes|studies|tests|figures)/[\w/.]*)`", named("extending"))
    assert len(named_files) > 20
    assert [name for name in named_files if not (ROOT / name).exists()] == []


def test_links_for_contributors_exist() -> None:
    path = ROOT / ".github" / "CONTRIBUTING.md"
    targets = re.findall(r"\]\(([^)#]+)\)", path.read_text(encoding="utf-8"))
    assert targets and all((path.parent / target).is_file() for target in targets)


def test_the_errors_of_the_report_on_the_theory_page_are_computed_ones() -> None:
    rows = re.findall(r"^\| (\d+) \|((?: *[-.\d]* \|){6})$", named("theory"), flags=re.MULTILINE)
    assert len(rows) == 5
    for segments, cells in rows:
        for index, cell in enumerate(cells.split("|")[:6]):
            boundary = "clamped-free" if index < 3 else "clamped-clamped"
            error = bm.frequency_error(boundary, segments=int(segments), mode=index % 3 + 1)
            assert cell.strip() == ("" if math.isnan(error) else f"{100 * error:.3f}")


def test_the_layouts_on_the_theory_page_are_the_rules() -> None:
    rows = re.findall(r"^\| `(\w+)` \|.* \| (\S+) % \| (\d) \|$", named("theory"), flags=re.MULTILINE)
    assert len(rows) == 7
    for name, error, order in rows:
        assert f"{error} %" == percent(_rule_errors(name, [10])[0])
        assert int(order) == bm.error_law("clamped-free", 1, name).order


def test_other_numbers_on_the_theory_page_are_computed_ones() -> None:
    page = " ".join(named("theory").split())
    pairs = ("clamped-free", "clamped-clamped")
    ours, best = (
        [bm.segments_needed(pair, tolerance=0.01, modes=3, rule=rule) for pair in pairs]
        for rule in ("mitiguy", "gregory")
    )
    assert (
        f"N = {ours[0]} (C/F) and {ours[1]} (C/C); with the springs of `gregory`, N = {best[0]} and {best[1]}"
        in page
    )
    steps = [bm.stable_time_step(bm.Chain(bm.Beam.unit(), pair, n)) for pair in pairs for n in (4, 10)]
    free, freer, held, firmer = (f"{step:.3g}" for step in steps)
    assert f"C/F {free} (N = 4) and {freer} (N = 10), C/C {held} and {firmer}" in page
    half = bm.Load(axial_force=-bm.buckling_load(bm.Beam.unit(), "clamped-free") / 2)
    given = {"segments": 20, "mode": 1, "load": half, "beam": bm.Beam.unit()}
    plain = bm.frequency_error("clamped-free", **given, rule="gregory")
    corrected = bm.frequency_error(
        "clamped-free", **given, rule=bm.axially_corrected("gregory", half, bm.Beam.unit())
    )
    assert f"`gregory` is off by {plain:.1e}".replace("e-04", "e-4") in page
    assert "cut that about 80-fold" in page and 70 < plain / corrected < 90


def test_what_is_left_at_a_wall_on_the_theory_page_is_what_the_law_has() -> None:
    left = {
        name: [tuple(pair) for pair in bm.RULES[name].end_defects("clamped")]
        for name in ("naive", "double_wall", "mitiguy", "gregory2", "gregory")
    }
    nothing = (0, 0)
    assert left["naive"][0] == (Fraction(1, 2), 0)
    assert left["double_wall"][:2] == [nothing, (Fraction(-1, 12), 0)]
    assert left["mitiguy"][:2] == [(0, Fraction(-1, 6)), (Fraction(-1, 12), 0)]
    assert left["gregory2"][:3] == [nothing, nothing, (Fraction(1, 24), 0)]
    assert left["gregory"] == [nothing, nothing, nothing, (Fraction(-19, 720), 0)]
    table = named("theory").partition("what is left")[2]
    for words in ("½ h f", "-h² f'/12 |", "-h² (f'/12 + f/6)", "h³ f''/24", "-19 h⁴ f'''/720"):
        assert words in table


def test_steps_of_engines_on_the_page_about_damping() -> None:
    """Every name of an engine stands in the table once, beside its own numbers."""
    rows = re.findall(
        r"^\| ([A-Z].*?) \| (\w+, \w+) \| (.*?) \| (\S+) \| (\S+) \| (\S+) \|$", named("damping"), re.M
    )
    chain = bm.Chain(BEAM, "clamped-free", 10, "gregory")
    named_there = []
    for names, kinds, _, *steps in rows:
        for name in names.split(", "):
            named_there.append(name)
            record = find_integrator(name)
            # Stages make the classical method's dampers explicit.
            assert kinds == f"{record.springs}, {record.damping}", name
            for said, ratio in zip(steps, (0.0, 0.01, 0.1), strict=True):
                damping = bm.joint_dampers(chain, ratio) if ratio else None
                step = bm.stable_time_step(chain, name, damping=damping)
                assert said == (f"{1e3 * step:.3g}" if math.isfinite(step) else "any"), name
    assert sorted(named_there) == sorted(
        name for record in bm.INTEGRATORS.values() for name in record.engines
    )


@EVERY_PAGE
def test_it_is_short_and_speaks_of_the_audit(page: Path) -> None:
    assert len(text(page).splitlines()) < 130
    assert len(re.findall(r"`beammodes audit ", text(page))) == 1
    assert all("audit" not in block for block in blocks(text(page), "sh"))


def test_numbers_in_the_text_about_mujoco() -> None:
    page = named("mujoco")
    # Capsules of r = 5 mm and 120 mm between the centres of their caps, as MuJoCo has them; with the density
    # that makes ρA = 1, caps and all. MuJoCo 3.17 itself rings at +8.09 %.
    radius, ell, count = 0.005, 0.12, 10
    rod, caps = 1 * ell, 4 / 3 * radius
    inertia = rod * (ell**2 / 12 + radius**2 / 4)
    inertia += caps * (2 / 5 * radius**2 + ell**2 / 4 + 3 / 8 * ell * radius)
    assert f"too heavy: with r = 5 mm and ℓ = 120 mm by {100 * caps / rod:.1f} %" in page
    chain = bm.Chain.from_pieces(
        length=[ell] * count,
        mass=[rod + caps] * count,
        rotary_inertia=[inertia] * count,
        joint_stiffness=[1 / ell] * (count - 1),
        boundary="clamped-free",
    )
    exact = bm.euler_bernoulli(bm.Beam(count * ell, 1.0, 1.0), "clamped-free", 1).angular_frequency[0]
    error = bm.solve_modes(bm.linearize(chain), 1).angular_frequency[0] / exact - 1
    assert f"(there remain {percent(error)})" in page
    assert f"radius {100 * (2**0.25 - 1):.0f} % larger doubles" in page
    chain = bm.Chain(BEAM, "clamped-free", 10, "gregory")
    limit = bm.stable_time_step(chain, "semi_implicit_euler")
    assert f"{0.002 / limit:.1f} times beyond" in page
    assert f"goes {bm.stable_time_step(chain, 'rk4') / limit:.2f} times further without dampers" in page
    damping = bm.joint_dampers(chain, 0.01)
    implicit, explicit = (
        bm.stable_time_step(chain, f"MuJoCo {name}", damping=damping) for name in ("implicit", "RK4")
    )
    assert f"{implicit / explicit:.1f} times less far with 1 % in mode 1" in page
    rope = bm.Chain(bm.Beam(4.0, 1e-3, 0.026), "pinned-free(mass=0.75)", 20)
    still, hung = (bm.stable_time_step(rope, load=bm.Load(gravity=(g, 0.0))) for g in (0.0, 9.81))
    assert round(still / hung) == 9 and "may shrink nine times" in page
    omega = bm.solve_modes(bm.linearize(chain), 1).angular_frequency[0]
    assert f"{100 * 0.002 * omega / 2:.1f} % in mode 1 at 2 ms" in page


def test_the_flex_on_the_page_is_the_beam_moved_by_half_an_edge() -> None:
    (block,) = blocks(named("mujoco"), "xml")
    flex = ElementTree.fromstring(block)
    points = int(flex.attrib["count"].split()[0])
    spacing = float(flex.attrib["spacing"].split()[0])
    mass, radius = float(flex.attrib["mass"]), float(flex.attrib["radius"])
    assert (points - 1) * spacing == pytest.approx(BEAM.length)
    assert float(flex.attrib["pos"].split()[0]) == pytest.approx(BEAM.length / 2 - spacing / 2)
    assert mass == pytest.approx(BEAM.mean_mass_per_length * BEAM.length * points / (points - 1))
    elastic = flex.find("elasticity")
    assert elastic is not None
    second_moment = math.pi * radius**4 / 4
    assert float(elastic.attrib["young"]) * second_moment == pytest.approx(85.0, rel=1e-4)
    mujoco = pytest.importorskip("mujoco")
    if int(mujoco.__version__.split(".")[0]) >= 4:
        model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{block}</worldbody></mujoco>")
        assert model.flex_vertnum.tolist() == [points]
        assert model.body_mass.max() == pytest.approx(BEAM.mean_mass_per_length * spacing)


def test_numbers_in_the_text_about_simscape() -> None:
    page = named("simscape")
    assert f"{180 / math.pi:.1f}\n  times too stiff" in page
    assert f"frequency {math.sqrt(180 / math.pi):.2f} times too high" in page
    elements = 100 * np.abs(element_errors("clamped-free", 4)).max()
    assert f"first three frequencies are within {elements:.2g} %" in page
    thin, thick = (
        bm.euler_bernoulli(
            bm.Beam.from_section(
                bm.Rectangle(width=0.015, height=0.005),
                density=2800.0,
                elastic_modulus=70e9,
                length=0.3,
                rotary_inertia=counts,
            ),
            "clamped-free",
            3,
        ).angular_frequency[2]
        for counts in (False, True)
    )
    assert f"that is {100 * (thick / thin - 1):.2g} % of mode 3" in page
    bar = bm.Beam.from_section(
        bm.Rectangle(width=0.015, height=0.005), density=2800.0, elastic_modulus=70e9, length=0.3
    )
    _, second_theory, third_theory = -100 * bm.theory_errors(bar, "clamped-free", 3)
    assert f"off by {second_theory:.2f} % in mode 2 and {third_theory:.2f} % in mode 3" in page
    mended = bm.Chain(bar, "clamped-free", segments=20, rule="half_stub_corrected")
    assert f'simscape.Value({mended.joint_stiffness[-1]:.2f}, "N*m/rad")' in page
    with pytest.warns(bm.SlendernessWarning, match="frequency 2"):
        bm.chain_errors(mended, modes=3)


def test_numbers_in_the_text_about_drake_and_gazebo() -> None:
    page = named("drake_gazebo")
    chain = bm.Chain(BEAM, "clamped-free", 10, "gregory")
    assert page.count(f"{chain.joint_stiffness[0]:.1f}<") == 2
    omega = bm.solve_modes(bm.linearize(chain), 1).angular_frequency[0]
    assert f"here {100 * 0.001 * omega / 2:.1f} % in mode 1" in page


def test_numbers_in_the_text_about_pyelastica() -> None:
    page = named("pyelastica")
    plain, moved, softer = (
        100 * held_element_errors([10], points=True, both=True, **how)[0]
        for how in ({}, {"inside": 0.5}, {"first": (12 / 23, 12 / 7)})
    )
    assert f"{plain:.1f} % too high" in page
    assert f"leaves {moved:+.2f} %; the\nchanged springs leave {softer:+.2f} %" in page


def test_numbers_in_the_text_about_adams() -> None:
    page = named("adams_working_model")
    second, third = (100 * adams_link_errors([10], attachment="flexible", mode=mode)[0] for mode in (2, 3))
    assert f"errs by {second:.3g} % and {third:.3g} % in modes 2 and 3" in page
    assert f"{180 / math.pi:.1f} times smaller" in page
    # The 8 under whose root the published step should stand: theory.md section 1.
    assert f"{math.sqrt(8):.2f} times too long" in page


# The first screen of README.


def test_the_first_screen_says_what_the_code_computes() -> None:
    screen = "\n".join(README.splitlines()[:20])
    rows = re.findall(
        r"^\| ([^|]*) \| ([^|]*) \| ([^|]*) % \| ([^|]*): ([^|]*) % \| \[page\]\(([^)]*)\) \|$",
        screen,
        flags=re.MULTILINE,
    )
    assert 4 <= len(rows) <= 6
    for tool, layout, error, _, mended, page in rows:
        before, after = SCREEN[tool]
        assert f"{error} %" == percent(before([10])[0]), tool
        assert f"{mended} %" == percent(after([10])[0]), tool
        assert (ROOT / page).is_file()
        rules = set(re.findall(r"`(\w+)`", layout)) & set(bm.RULES)
        assert all(f"{error} %" == percent(_rule_errors(rule, [10])[0]) for rule in rules)
    assert {row[5] for row in rows} == {f"beammodes/pages/{page.name}" for page in PAGES}
    assert set(SCREEN) == {row[0] for row in rows}


#: Errors as it is and mended, by the tool's name in README's table.
SCREEN: dict[str, tuple[Errors, Errors]] = {
    "MuJoCo 3 `cable`, Newton `add_rod`": (
        partial(_rule_errors, "rigid_stub"),
        partial(_rule_errors, "rigid_stub_corrected"),
    ),
    "MuJoCo 4 `flexcomp`": (flex_errors, partial(flex_errors, shifted=True)),
    "Adams flexible link": (
        partial(adams_link_errors, attachment="rigid"),
        partial(adams_link_errors, attachment="flexible"),
    ),
    "Drake, Gazebo by hand": (partial(_rule_errors, "naive"), partial(_rule_errors, "gregory")),
    "Simscape, Modelica": (
        partial(_rule_errors, "half_stub"),
        partial(_rule_errors, "half_stub_corrected"),
    ),
    "Working Model": (partial(_rule_errors, "mitiguy"), partial(_rule_errors, "gregory")),
}
SPRINGS = re.compile(r"\d+/\d+")


def test_the_springs_of_the_first_screen_are_the_rules() -> None:
    for tool, rule in {
        "MuJoCo 3 `cable`, Newton `add_rod`": "rigid_stub_corrected",
        "Drake, Gazebo by hand": "gregory",
        "Simscape, Modelica": "half_stub_corrected",
        "Working Model": "gregory",
    }.items():
        row = next(line for line in README.splitlines() if line.startswith(f"| {tool} |"))
        written = [quotient(part) for part in SPRINGS.findall(row.split(" | ")[3])]
        springs = bm.Chain(bm.Beam.unit(), "clamped-free", 10, rule).joint_stiffness / 10
        changed = springs[np.abs(springs - 1) > 1e-9]
        assert written == pytest.approx(changed, rel=1e-12)


def quotient(part: str) -> float:
    top, bottom = part.split("/")
    return int(top) / int(bottom)
