"""What is shown of every public object: a line at a prompt, HTML and pictures in a notebook."""

from __future__ import annotations

import base64
import dataclasses
import functools
import inspect
import io
import re
import subprocess
import sys
from collections.abc import Callable
from html.parser import HTMLParser
from types import SimpleNamespace
from typing import Any

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest
from test_hostile_calls import CALLS, EXCEPTIONS, answer, beam, chain, motion, out, structure, target
from test_values import FOUND, MADE

import beammodes as bm
from beammodes.checks import Shown
from beammodes.progress import progress_of
from beammodes.views.film import Film
from beammodes.views.html_tables import html_of, units_of

#: Calls whose answers are of no class that is public, or that a file makes.
CALLED = ["recommend", "harmonic", "spin_up", "bang_bang", "point_to_point", "mend_file", "Ends"]
SAME = {"boundary": "clamped-free", "segments": 4, "mode": 1, "compute": "relative_error"}
#: What no call of that table makes.
MORE: dict[str, Callable[[], Any]] = {
    "AxialAudit": lambda: audited().motions["twist"],
    "SpatialAudit": lambda: audited(),
    "BeamModes": lambda: bm.euler_bernoulli(beam(), "clamped-free", 3),
    "BentModel": lambda: bm.linearize(chain(), at=bm.find_equilibrium(chain(), bm.Load(tip_force=1.0))),
    "Integrator": lambda: bm.INTEGRATORS["rk4"],
    "Case": lambda: next(iter(bm.Study.grid(**SAME).cases(0))),
    "SpectralBeamModes": lambda: bm.euler_bernoulli(bm.Beam(1.0, [2.0, 1.0], 1.0), "clamped-free", 2),
    "a long chain": lambda: bm.Chain(beam(), "clamped-free", 300),
    "a chain too long to draw": lambda: bm.Chain(beam(), "clamped-free", 3000),
    "a free chain in space": lambda: bm.spatial_modes(bm.SpatialChain(ROD, "free-free", 4), 2),
    "Study, sampled": lambda: bm.Study.sampled(5, seed=1, right_mass=bm.Uniform(0.0, 1.0), **SAME),
    "matched springs in twist": lambda: bm.match_springs("fixed-free", 3, 1, motion="twist"),
}
ROD = bm.Rod(1.0, 1.0, 0.8, 1.0, 0.01)


@functools.cache
def audited() -> bm.SpatialAudit:
    path = out("rod.xml")
    bm.export_chain(bm.SpatialChain(ROD, "clamped-free", 3), path, joints="yzx")
    found = bm.audit_file(path, ROD, "clamped-free", motion="space", modes=1)
    assert isinstance(found, bm.SpatialAudit)
    return found


@functools.cache
def shown() -> dict[str, Any]:
    """Objects of every class that a public call gives, and the catalogues."""
    made = {name: getattr(bm, name) for name in bm.__all__ if isinstance(getattr(bm, name), Shown)}
    made |= {name: target(name)(**CALLS[name]()) for name in CALLED}
    return made | {name: make() for name, make in (MADE | FOUND | MORE).items()}


@dataclasses.dataclass
class Checked(HTMLParser):
    """Counts open elements, and keeps what a page must not have."""

    def __post_init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.bad: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag in ("script", "style", "iframe", "object", "link", "meta"):
            self.bad.append(tag)
        for name, value in attrs:
            outside = name in ("src", "href", "xlink:href") and not re.match("#|data:image/", value or "")
            if name.startswith("on") or outside:
                self.bad.append(f"{name}={value}")
        if tag not in ("img", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if not self.open or self.open.pop() != tag:
            self.bad.append(f"</{tag}>")


def faults(html: str) -> list[str]:
    page = Checked()
    page.feed(html)
    page.close()
    return page.bad + page.open


def test_every_public_object_has_a_line_and_a_page() -> None:
    seen = {kind.__name__ for value in shown().values() for kind in type(value).__mro__}
    classes = {name for name in bm.__all__ if inspect.isclass(getattr(bm, name))} - EXCEPTIONS
    assert classes - seen == {"Layout"}  # a protocol
    before = dict(matplotlib.rcParams)
    opened = plt.get_fignums()  # by other tests
    for name, value in shown().items():
        if not isinstance(value, Shown):
            assert not type(value).__module__.startswith("beammodes"), name
            continue
        line = repr(value)
        assert "\n" not in line and len(line) <= 120 and " at 0x" not in line, line
        html = value._repr_html_()
        assert faults(html) == [], name
        words = re.sub(r"<svg.*?</svg>", "", html)
        assert not re.search(r"\bNone\b| at 0x|\bnan\b|\binf\b", words), (name, words)
        assert len(html) < 150_000, (name, len(html))
        if name == "SpatialChain":
            assert html == value._repr_html_()  # a notebook that is run twice stays the same file
        if hasattr(value, "frequency") and np.size(value.frequency) and "Sine" not in name:
            assert re.match(r"\S+\(.*?[\d.]+ Hz", line), line
            assert "Hz" in html, name
    assert (dict(matplotlib.rcParams), plt.get_fignums()) == (before, opened)


def test_numbers_have_their_units() -> None:
    """By the docstrings; all that have none are whole numbers, texts and records."""
    assert units_of(bm.Beam)["bending_stiffness"] == "N m²" and units_of(bm.Station)["hinge"] == "N m/rad"
    assert ">85 N m²<" in html_of(beam()) and "0, 2 N<" in html_of(bm.Load(tip_force=2.0))
    public = [getattr(bm, name) for name in bm.__all__]
    given = [each for each in public if dataclasses.is_dataclass(each) and ".problem." in each.__module__]
    assert len(given) > 15
    for kind in given:
        types = {each.name: str(each.type) for each in dataclasses.fields(kind) if each.repr}
        numbers = {
            name for name, said in types.items() if re.search("float|Fraction|Number|Vector|Three", said)
        }
        bare = numbers - {name for name, unit in units_of(kind).items() if unit}
        assert bare == ({"value"} if kind is bm.Table else set()), kind


def test_what_users_type_is_text_and_not_html() -> None:
    nasty = "<script>alert(1)</script>\"'&"
    joints = {nasty: bm.Joint(0, 0, "clamped"), "b": bm.Joint(1, 0)}
    frame = bm.Structure.of_bars(joints, [(nasty, "b")], bending_stiffness=1.0, mass_per_length=1.0)
    rule = bm.Rule(nasty, ["1/2"], summary=nasty, used_by=nasty, source=nasty)
    load = bm.PointLoad(joint="b", force=(0.0, 1.0))
    for value in (
        frame,
        rule,
        bm.StructureChain(frame, 2),
        bm.structure_statics(frame, load),
        bm.structure_modes(frame, 1),
        bm.Chain(beam(), "clamped-free", 2, rule),
        bm.JointLaw(nasty, ("xyz",)),
        bm.PointLoad(0.5, member=nasty),
    ):
        html = html_of(value)
        assert faults(html) == [] and "<script" not in html, value
        assert "&lt;script" in html or type(value) is bm.JointLaw, value
    lines = {"a\nb\u2028": bm.Joint(0, 0, "clamped"), "c": bm.Joint(1, 0)}
    frame = bm.Structure.of_bars(lines, [("a\nb\u2028", "c")], bending_stiffness=1.0, mass_per_length=1.0)
    for value in (frame, bm.StructureChain(frame, 2)):
        assert repr(value).isprintable()


def test_the_line_is_what_a_user_types() -> None:
    names = {name: getattr(bm, name) for name in ("Beam", "Load", "End", "Station", "Rule")}
    given = (
        beam(),
        bm.Load(tip_force=2.0),
        bm.End(mass=0.5),
        bm.Station(0.5, hinge=2.0),
        bm.RULES["gregory"],
    )
    for value in given:
        assert eval(repr(value), names) == value


def test_a_study_tells_rules_apart_whose_lines_are_cut_alike() -> None:
    rules = [bm.Rule("own" * 20, [*["11/10"] * 7, last]) for last in ("1.01", "1.02")]
    assert repr(rules[0]) == repr(rules[1])
    made = [bm.Study.grid(**SAME | {"segments": 20, "rule": rule}) for rule in rules]
    assert made[0].digest != made[1].digest


def test_nothing_of_it_is_loaded_before_somebody_looks() -> None:
    program = (
        "import sys, beammodes as bm; repr(bm.Chain(bm.Beam.unit(), 'clamped-free', 4));"
        "print([n for n in sys.modules if 'matplotlib' in n or 'beammodes.views' in n or n == 'html'])"
    )
    ran = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert ran.stdout == "[]\n"


def test_plots_without_axes_make_their_own_and_show_them() -> None:
    opened = plt.get_fignums()  # by other tests
    for drawn in (
        bm.draw_chain(chain()),
        bm.draw_chain(bm.SpatialChain(ROD, "clamped-free", 3)),
        bm.draw_statics(bm.structure_statics(structure(), [bm.LineLoad(2.0)])),
        bm.plot_response(answer()),
    ):
        axes = drawn if isinstance(drawn, tuple) else (drawn,)
        assert all(isinstance(ax, matplotlib.axes.Axes) for ax in axes)
        picture: Any = drawn
        assert picture._repr_png_().startswith(b"\x89PNG")
    assert plt.get_fignums() == opened


def test_a_film_plays_in_the_page_and_stays_small() -> None:
    from PIL import Image

    film = bm.animate(motion(), fps=100, duration=2.6, width=3.0, dpi=40)
    assert isinstance(film, Film)
    found = re.fullmatch(r'<img alt="[^"]+" src="data:image/gif;base64,([^"]+)"[^>]*>', film._repr_html_())
    assert found
    picture: Any = Image.open(io.BytesIO(base64.b64decode(found[1])))
    # Every second of 260 frames; what is alike stands longer in one.
    lasts = [picture.seek(k) or picture.info["duration"] for k in range(picture.n_frames)]
    assert sum(lasts) == 2600 and set(lasts) != {10}


def test_a_line_of_progress_in_a_notebook(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[str] = []
    handle = SimpleNamespace(update=lambda data, **_: told.append(data["text/plain"]))

    def display(data: dict[str, str], display_id: bool = False, **_: Any) -> Any:
        told.append(f"new: {data['text/plain']}")
        return handle if display_id else None

    shell = SimpleNamespace(kernel="any")
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    monkeypatch.setitem(sys.modules, "IPython.display", SimpleNamespace(display=display))
    monkeypatch.setattr("beammodes.progress._QUICK", -1.0)
    line = progress_of(None, "study", "chunks")
    line(1, 2)
    line(2, 2)
    assert told[0].startswith("new: study: [##########          ] 1 of 2 chunks")
    assert told[1].startswith("study: [####################] 2 of 2 chunks") and len(told) == 2


#: Cells of a notebook, and the kind of what each shows.
CELLS = {
    "import beammodes as bm, warnings": "",
    "chain = bm.Chain(bm.Beam(1.2, 85.0, 0.62), 'clamped-free', 4); chain": "text/html",
    "bm.solve_modes(bm.linearize(chain), 3)": "text/html",
    "bm.recommend('clamped-free', 0.05, rules=['gregory', 'mitiguy'])": "text/html",
    "bm.draw_chain(chain)": "image/png",
    "motion = bm.simulate(chain, duration=0.05, initial=bm.mode_start(chain, 1, 0.01))": "",
    "bm.animate(motion, width=2.0)": "text/html",
}


def test_a_notebook_runs_and_shows_all() -> None:
    nbclient = pytest.importorskip("nbclient")
    nbformat = pytest.importorskip("nbformat")
    pytest.importorskip("ipykernel")
    cells = [nbformat.v4.new_code_cell(source) for source in CELLS]
    notebook = nbformat.v4.new_notebook(cells=cells)
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
    for cell, kind in zip(notebook.cells, CELLS.values(), strict=True):
        kinds = [key for output in cell.outputs for key in output.get("data", {})]
        assert kind in kinds if kind else kinds == [], cell.source
        for output in cell.outputs:
            assert faults(output.get("data", {}).get("text/html", "")) == [], cell.source
