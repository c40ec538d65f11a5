"""The page in a browser: whole, silent, alone, usable by keyboard, its atlas saying what the library does."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn_ends import RULES_DRAWN
from page_reading import same, stiffnesses

import beammodes as bm
from beammodes.problem.motions import unit_beam
from studies.page import atlas_data, build, rods_data

playwright = pytest.importorskip("playwright.sync_api")
FIGURES = Path(__file__).parent.parent / "figures"
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
CONTROLS = ("Left end", "Right end", "Rule", "Beside it (dashed)", "Segments N", "Modes", "Tolerance")
WORDS = ("clamped", "pinned", "guided", "free")


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("page") / "report.html"
    path.write_text(build.page(FIGURES), encoding="utf-8")
    return path.as_uri()


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    found = next(filter(None, map(shutil.which, BROWSERS)), None)
    if found is None:
        pytest.skip(f"no browser is installed: none of {', '.join(BROWSERS)}")
    # Chromium has no sandbox for root.
    alone = ["--no-sandbox"] if hasattr(os, "geteuid") and os.geteuid() == 0 else []
    with playwright.sync_playwright() as driver:
        running = driver.chromium.launch(executable_path=found, args=alone)
        yield running
        running.close()


@pytest.fixture
def page(browser: Any, address: str) -> Iterator[Any]:
    """A page of desktop size that must stay silent and ask for nothing but itself."""
    opened, heard = browser.new_page(viewport={"width": 1280, "height": 900}), []
    # Only so that a page that hangs ends the test: a loaded machine is slow, not wrong.
    opened.set_default_timeout(600_000)
    opened.on("console", lambda message: heard.append(message.text))
    opened.on("pageerror", lambda error: heard.append(str(error)))
    opened.on(
        "request", lambda request: heard.append(request.url) if _outside(request.url, address) else None
    )
    opened.goto(address)
    yield opened
    opened.close()
    assert heard == []


def _outside(url: str, address: str) -> bool:
    return not (url.startswith("data:") or url.partition("#")[0] == address)


def _state(page: Any) -> dict[str, Any]:
    """What the atlas shows."""
    cells = page.locator("#atlas-errors tbody tr").all()
    return {
        "springs": page.locator("#atlas-springs").inner_text(),
        "step": page.locator("#atlas-step").inner_text(),
        "needed": page.locator("#atlas-wanted").inner_text(),
        "errors": [row.locator("td").first.inner_text() for row in cells],
        "laws": [row.locator("td").nth(1).inner_text() for row in cells],
    }


def _wait_for(page: Any, pair: str, rule: str, n: int) -> None:
    """Wait until the atlas shows a chain: the page hears of a new address a moment later."""
    title = f"{pair}, rule {rule}, N = {n}"
    page.wait_for_function("due => document.querySelector('#atlas-state').innerText === due", arg=title)


def _check(page: Any, left: str, right: str, rule: str, n: int, modes: int, tolerance: float) -> None:
    pair = f"{left}-{right}"
    _wait_for(page, pair, rule, n)
    shown = _state(page)
    chain = bm.Chain(bm.Beam.unit(), pair, n, rule)
    if shown["springs"].startswith("none"):
        assert len(chain.joint_stiffness) == 0
    else:
        assert stiffnesses(shown["springs"]) == pytest.approx((chain.joint_stiffness / n).tolist(), rel=1e-12)
    if chain.elastic_modes:
        same(shown["step"].split()[0], bm.stable_time_step(chain))
    else:
        assert shown["step"].startswith("any")
    needed = bm.segments_needed(pair, tolerance, modes, rule)
    most = atlas_data.LONGEST
    assert shown["needed"] == (str(needed) if needed <= most else f"more than {most}")
    assert len(shown["errors"]) == modes
    for mode, (error, law) in enumerate(zip(shown["errors"], shown["laws"], strict=True), start=1):
        exact = 100 * bm.frequency_error(pair, segments=n, mode=mode, rule=rule)
        same("–" if error == "no such mode" else error, exact)
        first = bm.law_holds_from(pair, mode, rule, within=0.2)
        if np.isnan(exact) or first is None:
            assert law == "–"
        elif n < first:
            assert law == f"from N = {first}"
        else:
            same(law, 100 * float(bm.error_law(pair, mode, rule).at(np.array(n))))


@pytest.mark.parametrize("widths", [(320,), pytest.param((1280, 768, 375), marks=pytest.mark.slow)])
def test_every_picture_loads_and_nothing_is_wider_than_the_screen(page: Any, widths: tuple[int, ...]) -> None:
    pictures = page.evaluate("[...document.images].map((i) => i.complete && i.naturalWidth)")
    assert len(pictures) > 15 and all(width and width > 100 for width in pictures)
    # Asked of the page in one go: it draws the plot again when its width changes.
    boxes = page.evaluate(
        "[...document.querySelectorAll('svg')].map((drawn) => drawn.getBoundingClientRect().toJSON())"
    )
    assert len(boxes) == 3
    assert all(box["width"] > 200 and box["height"] > 150 for box in boxes)
    for width in widths:
        page.set_viewport_size({"width": width, "height": 800})
        # The plot is drawn again a moment after its width has changed.
        page.wait_for_function("width => document.documentElement.scrollWidth <= width", arg=width)
    plot = "document.querySelector('#atlas-plot svg').getBoundingClientRect().width"
    page.wait_for_function(f"{plot} <= {widths[-1]}")


def test_the_atlas_shows_what_the_library_returns(page: Any, address: str) -> None:
    random = np.random.default_rng(5)
    tolerances = dict(zip(map(str, atlas_data.TOLERANCES), atlas_data.TOLERANCES, strict=True))
    _check(page, "clamped", "free", "mitiguy", 10, 3, 0.01)
    for k in range(24):
        left, right = (str(word) for word in random.choice(WORDS, 2))
        rule, tolerance = str(random.choice(RULES_DRAWN)), str(random.choice(list(tolerances)))
        n, modes = int(random.integers(2, atlas_data.SEGMENTS + 1)), int(random.integers(1, 6))
        if k % 2:
            chosen = f"left={left}&right={right}&rule={rule}&segments={n}&modes={modes}&tolerance={tolerance}"
            page.goto(f"{address}#atlas?{chosen}")
        else:
            for label, value in zip(CONTROLS[:3], (left, right, rule), strict=True):
                page.get_by_label(label, exact=True).select_option(value)
            page.get_by_label("Segments N", exact=True).fill(str(n))
            page.get_by_label("Modes", exact=True).select_option(str(modes))
            page.get_by_label("Tolerance", exact=True).select_option(tolerance)
            # Asked of the page: the driver hears of a new address later.
            at = page.evaluate("location.href")
            assert f"left={left}&right={right}&rule={rule}" in at and f"segments={n}" in at
        _check(page, left, right, rule, n, modes, tolerances[tolerance])


def test_all_rules_are_listed_for_the_tolerance(page: Any) -> None:
    rows = page.locator("#atlas-rules tbody tr").all()
    assert [row.locator("th").inner_text() for row in rows] == list(bm.RULES)
    for row, rule in zip(rows, bm.RULES, strict=True):
        needed = bm.segments_needed("clamped-free", 0.01, 3, rule)
        assert row.locator("td").first.inner_text() == str(needed)
        if needed <= atlas_data.SEGMENTS:
            springs = bm.Chain(bm.Beam.unit(), "clamped-free", needed, rule).joint_stiffness / needed
            assert stiffnesses(row.locator("td").nth(1).inner_text()) == pytest.approx(springs.tolist())
        else:
            assert row.locator("td").nth(1).inner_text() == f"not kept over N = {atlas_data.SEGMENTS}"


def test_twist_in_the_atlas(page: Any, address: str) -> None:
    page.get_by_label("Motion", exact=True).select_option("twist")
    # sin x/x - 1, x = β/2N, between exact mirrors.
    errors = [100 * (np.sinc(mode * 0.5 / 20) - 1) for mode in (1, 3, 5)]
    assert page.locator("#atlas-state").inner_text() == "fixed-free in twist, rule mitiguy, N = 10"
    for shown, error in zip(_state(page)["errors"], errors, strict=True):
        same(shown, error)
    assert _state(page)["needed"] == "17" and "GJ/ℓ" in page.locator("#atlas-springs-label").inner_text()
    assert "motion=twist&left=fixed&right=free" in page.evaluate("location.href")
    page.goto(f"{address}#atlas?motion=twist&left=free&right=fixed&rule=simpson&segments=4")
    page.wait_for_function("document.querySelector('#atlas-state').innerText.startsWith('free-fixed')")
    assert stiffnesses(_state(page)["springs"]) == [0.75, 1.5, 0.75, 3.0]
    page.get_by_label("Motion", exact=True).select_option("bending")
    _wait_for(page, "free-clamped", "simpson", 4)


#: Ends with bodies as the page's address has them, and as the library does: rule, N, modes.
BODIES = (
    ("left=clamped&right=free&massRight=0.5", "clamped-free(mass=0.5)", "gregory", 12, 5),
    (
        "left=clamped&right=free&massRight=2&inertiaRight=0.01",
        "clamped-free(mass=2, rotary_inertia=0.01)",
        "mitiguy",
        10,
        3,
    ),
    (
        "left=free&right=pinned&massLeft=1e-3&inertiaLeft=1e-5",
        "free(mass=0.001, rotary_inertia=0.00001)-pinned",
        "rigid_stub_corrected",
        21,
        4,
    ),
    (
        "left=free&right=free&massLeft=30&inertiaLeft=.2&massRight=0.1",
        "free(mass=30, rotary_inertia=0.2)-free(mass=0.1)",
        "half_stub_corrected",
        40,
        5,
    ),
    ("left=free&right=guided&inertiaLeft=4", "free(rotary_inertia=4)-guided", "simpson", 8, 5),
    ("left=clamped&right=free&massRight=0.2", "clamped-free(mass=0.2)", "hencky", 2, 3),
)


def _shown(page: Any, address: str, chosen: str) -> dict[str, Any]:
    page.goto(f"{address}#atlas?{chosen}")
    page.wait_for_function("due => document.querySelector('#atlas-form').elements.rule.value === due"
                           " && document.querySelector('#atlas-state').innerText.includes(`rule ${due}`)",
                           arg=chosen.split("rule=")[1].split("&")[0])  # fmt: skip
    return _state(page)


@pytest.mark.parametrize(("ends", "pair", "rule", "n", "modes"), BODIES)
def test_bodies_at_the_ends_are_computed_as_the_library_does(
    page: Any, address: str, ends: str, pair: str, rule: str, n: int, modes: int
) -> None:
    shown = _shown(page, address, f"{ends}&rule={rule}&segments={n}&modes={modes}&tolerance=0.02")
    chain = bm.Chain(bm.Beam.unit(), pair, n, rule)
    assert stiffnesses(shown["springs"]) == pytest.approx((chain.joint_stiffness / n).tolist(), rel=1e-12)
    same(shown["step"].split()[0], bm.stable_time_step(chain))
    exact = bm.euler_bernoulli(bm.Beam.unit(), pair, modes).angular_frequency
    errors = bm.chain_errors(chain, modes)
    cells = [row.locator("td").all_inner_texts() for row in page.locator("#atlas-errors tbody tr").all()]
    assert len(cells) == modes
    for (error, law, beam, solved), value, omega in zip(cells, errors, exact, strict=True):
        same("–" if error == "no such mode" else error, 100 * value)
        same(beam, omega)
        same(solved, omega * (1 + value))
        assert law == "–"
    needed = bm.segments_needed(pair, 0.02, modes, rule)
    assert shown["needed"] == (str(needed) if needed <= atlas_data.SEGMENTS else "more than 60")
    assert "in this browser" in page.locator("#atlas-where").inner_text()
    # The other rules follow one by one.
    page.wait_for_function("!document.querySelector('#atlas-rules tbody').innerText.includes('…')")
    other = page.locator("#atlas-rules tbody tr", has_text="gregory2").locator("td").first.inner_text()
    needed = bm.segments_needed(pair, 0.02, modes, "gregory2")
    assert other == (str(needed) if needed <= atlas_data.SEGMENTS else "over 60")


@pytest.mark.slow
def test_bodies_of_any_size_are_computed_as_the_library_does(page: Any) -> None:
    random, words = np.random.default_rng(27), ("clamped", "pinned", "guided", "free")
    ask = """([state, n]) => {
        const chains = atlasChains(JSON.parse(document.getElementById("atlas-data").textContent));
        const found = chains.record(state, state.rule);
        return [found.error[n - 1], found.rounding[n - 1], chains.exact(state)];
    }"""
    for k in range(60):
        ends, rule = [str(random.choice(words)), "free"][:: 1 - 2 * (k % 2)], str(random.choice(RULES_DRAWN))
        n = int(random.integers(2, atlas_data.SEGMENTS + 1))
        state, names = {"motion": "bending", "left": ends[0], "right": ends[1], "rule": rule}, []
        for word, side in zip(ends, ("Left", "Right"), strict=True):
            sizes = 10.0 ** random.uniform(-6, 4, 2) * random.integers(0, 2, 2) * (word == "free")
            state |= {f"mass{side}": repr(float(sizes[0])), f"inertia{side}": repr(float(sizes[1]))}
            numbers = f"(mass={float(sizes[0])!r}, rotary_inertia={float(sizes[1])!r})"
            names.append(word + numbers * (word == "free"))
        if not any(float(state[name]) for name in state if name.startswith(("mass", "inertia"))):
            continue
        errors, rounding, exact = page.evaluate(ask, [state, n])
        pair = "-".join(names)
        chain = bm.Chain(bm.Beam.unit(), pair, n, rule)
        count = len(rounding)
        known = bm.euler_bernoulli(bm.Beam.unit(), pair, len(exact)).angular_frequency
        assert exact == pytest.approx(known.tolist(), rel=1e-12), pair
        solved = bm.chain_errors(chain, len(exact))
        assert [error is not None for error in errors] == (~np.isnan(solved)).tolist()
        for error, value, moved in zip(errors[:count], solved[:count], rounding, strict=True):
            assert abs(error - value) <= (1 + value) * (moved + 1e-12), (pair, rule, n)


def test_discs_in_twist_are_computed_as_the_library_does(page: Any, address: str) -> None:
    ends = "motion=twist&left=free&right=free&inertiaLeft=0.3&inertiaRight=5&rule=gregory&segments=9&modes=4"
    shown = _shown(page, address, ends)
    pair = "free(inertia=0.3)-free(inertia=5)"
    chain = bm.AxialChain(unit_beam(), pair, 9, "gregory", motion="twist")
    assert stiffnesses(shown["springs"]) == pytest.approx((chain.joint_stiffness / 9).tolist(), rel=1e-12)
    same(shown["step"].split()[0], bm.stable_time_step(chain))
    for error, value in zip(shown["errors"], bm.chain_errors(chain, 4), strict=True):
        same(error, 100 * value)


def test_answers_in_si_units(page: Any, address: str) -> None:
    numbers = "length=2&EI=1400&rhoA=0.5"
    beam = bm.Beam(2.0, 1400.0, 0.5)
    for body, pair in (("", "clamped-free"), ("&massRight=0.25&inertiaRight=0.003",
                                              "clamped-free(mass=0.25, rotary_inertia=0.003)")):  # fmt: skip
        shown = _shown(page, address, f"{numbers}{body}&rule=gregory&segments=6&modes=2")
        chain = bm.Chain(beam, pair, 6, "gregory")
        assert stiffnesses(shown["springs"]) == pytest.approx(chain.joint_stiffness.tolist(), rel=1e-5)
        assert "N m/rad" in page.locator("#atlas-springs-label").inner_text()
        value, unit, *_ = shown["step"].split()
        same(value, bm.stable_time_step(chain))
        assert unit == "s" and page.locator("#atlas-beam-head").inner_text() == "beam, Hz"
        exact = bm.euler_bernoulli(beam, pair, 2).frequency
        solved = bm.solve_modes(bm.linearize(chain), 2).frequency
        for row, *frequencies in zip(
            page.locator("#atlas-errors tbody tr").all(), exact, solved, strict=True
        ):
            for cell, frequency in zip(row.locator("td").all_inner_texts()[2:], frequencies, strict=True):
                same(cell, frequency)
    page.goto(f"{address}#atlas?motion=twist&left=fixed&length=2&GJ=80&rhoIp=8e-6&rule=naive&segments=4")
    page.wait_for_function("document.querySelector('#atlas-state').innerText.includes('twist')")
    shaft = bm.Beam(2.0, 1.0, 1.0, torsional_stiffness=80.0, polar_inertia_per_length=8e-6)
    chain = bm.AxialChain(shaft, "fixed-free", 4, "naive")
    assert stiffnesses(_state(page)["springs"]) == pytest.approx(chain.joint_stiffness.tolist(), rel=1e-5)
    same(_state(page)["step"].split()[0], bm.stable_time_step(chain))


def test_numbers_that_cannot_be_are_named(page: Any) -> None:
    problem = page.locator("#atlas-problem")
    assert problem.inner_text() == ""
    cases = (
        ("Segments N", "61", "10", "Segments N must be a whole number from 1 to 60, got 61."),
        ("EI, N m²", "-2", "", "EI in N m² must be a number greater than 0, got -2."),
        ("Mass, right end, ρAL", "x", "", "mass at the right end must be a number from 0 on, got x."),
        ("Rotary inertia, right end, ρAL³", "1e9", "", "must be 0, or from 10⁻⁹ to 10⁶ times"),
    )
    for label, bad, good, said in cases:
        field = page.get_by_label(label, exact=True)
        field.fill(bad)
        assert said in problem.inner_text() and field.get_attribute("aria-invalid") == "true"
        _check(page, "clamped", "free", "mitiguy", 10, 3, 0.01)
        field.fill(good)
        assert problem.inner_text() == "" and field.get_attribute("aria-invalid") == "false"
    page.get_by_label("L, m", exact=True).fill("2")
    assert "give EI in N m² and ρA in kg/m too" in page.locator("#atlas-units").inner_text()
    assert "length=2" in page.evaluate("location.href") and "EI=" not in page.evaluate("location.href")


def test_on_a_phone_pictures_open_large_and_wide_tables_say_so(page: Any) -> None:
    page.set_viewport_size({"width": 390, "height": 844})
    # A moment later: the page hears of its new width.
    page.wait_for_function("document.querySelector('#errors .scroll').classList.contains('wide')")
    wide = (
        "[...document.querySelectorAll('.scroll')]"
        ".map((box) => [box.scrollWidth > box.clientWidth + 1, box.classList.contains('wide')])"
    )
    page.wait_for_function(f"{wide}.every(([is, says]) => is === says)")
    assert {is_wide for is_wide, _ in page.evaluate(wide)} == {True, False}
    picture = page.locator("#picture-figure_6 .enlarge")
    small = picture.locator("img").bounding_box()["width"]
    picture.click()
    assert page.locator("#large img").bounding_box()["width"] > 2 * small
    page.keyboard.press("Escape")
    assert not page.locator("#large").is_visible()


def test_rods_in_space_are_drawn_and_turned(page: Any, address: str) -> None:
    def points() -> str:
        return page.locator("#rods-plot polyline").last.get_attribute("points")

    first = points()
    assert len(first.split()) == 21 and page.locator("#rods-plot circle").count() == 20
    page.locator("#rods-turn").fill("10")
    turned = points()
    box = page.locator("#rods-plot").bounding_box()
    page.mouse.move(box["x"] + 100, box["y"] + 100)
    page.mouse.down()
    page.mouse.move(box["x"] + 160, box["y"] + 120)
    page.mouse.up()
    assert len({first, turned, points()}) == 3 and "turn=-20" in page.evaluate("location.href")
    blade = "pretwisted by 90°, EI ratio 16"
    page.get_by_label("Rod at rest", exact=True).select_option(blade)
    chain = bm.SpatialChain(rods_data.RODS[blade], "clamped-free", 20, "half_stub")
    page.locator("#rods-rule").select_option("half_stub")
    rows = page.locator("#rods-errors tbody tr").all()
    for row, error in zip(rows, bm.rod_errors(chain, rods_data.MODES), strict=True):
        same(row.locator("td").nth(1 + rods_data.RULES.index("half_stub")).inner_text(), 100 * error)
    page.goto(f"{address}#rods?rod=<b>&mode=99&segments=5&rule=naive")
    title = "helix of one turn, round, rule naive, N = 5, mode 1"
    page.wait_for_function("due => document.querySelector('#rods-state').innerText === due", arg=title)


def test_the_atlas_by_keyboard(page: Any) -> None:
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    page.get_by_label("Left end", exact=True).focus()
    for label in CONTROLS:
        assert page.evaluate("document.activeElement.labels[0].innerText.trim().split('\\n')[0]") == label
        page.keyboard.press("Tab")
    page.get_by_label("Segments N", exact=True).focus()
    page.keyboard.press("ArrowUp")
    page.get_by_label("Rule", exact=True).focus()
    page.keyboard.press("ArrowDown")
    page.get_by_label("Modes", exact=True).focus()
    page.keyboard.press("ArrowUp")
    _check(page, "clamped", "free", list(bm.RULES)[1], 11, 2, 0.01)
    drawn = page.locator("#atlas-plot svg")
    assert "first 2 frequencies" in drawn.get_attribute("aria-label")
    assert drawn.locator("polyline").count() == 4  # two modes, two rules


def test_what_cannot_be_chosen_changes_nothing(page: Any, address: str) -> None:
    number = page.get_by_label("Segments N", exact=True)
    for bad in ("", "0", "61", "-3", "2.5"):
        number.fill(bad)
        assert number.get_attribute("aria-invalid") == "true"
        _check(page, "clamped", "free", "mitiguy", 10, 3, 0.01)
    number.fill("12")
    assert number.get_attribute("aria-invalid") == "false"
    page.goto(f"{address}#atlas?left=<b>&right=free&rule=none&segments=1e9&modes=0&tolerance=x&more=1")
    _check(page, "clamped", "free", "mitiguy", 10, 3, 0.01)
    page.goto(f"{address}#atlas?left=free&right=free&segments=1&modes=1")
    _wait_for(page, "free-free", "mitiguy", 1)
    assert _state(page)["springs"].startswith("none") and _state(page)["errors"] == ["no such mode"]


def test_on_paper(page: Any) -> None:
    page.emulate_media(media="print")
    assert not page.locator("#atlas-form").is_visible() and not page.locator("#rods-form").is_visible()
    assert page.locator("#atlas-plot svg").is_visible() and page.locator("#atlas-state").is_visible()


@pytest.mark.slow
def test_printed(page: Any) -> None:
    printed = page.pdf(prefer_css_page_size=True)
    assert printed.startswith(b"%PDF") and 15 <= printed.count(b"/Type /Page\n") <= 40
