"""The documentation site: every page and every public name has its place, and equations are no markup."""

from __future__ import annotations

import doctest
import inspect
from pathlib import Path

import beammodes as bm
from studies.site import build, docstrings

PAGES = Path(__file__).parent.parent / "beammodes" / "pages"


def test_every_page_stands_in_one_chapter() -> None:
    listed = [name for names in build.chapters().values() for name in names]
    assert sorted(listed) == sorted({*(path.stem for path in PAGES.glob("*.md")), "contributing"})


def test_every_public_name_stands_in_one_topic_of_the_reference() -> None:
    listed = [name for _, names in build.topics().values() for name in names]
    assert sorted(listed) == sorted(set(bm.__all__) - build.UNLISTED)


def test_equations_of_docstrings_are_no_markup() -> None:
    assert doctest.testmod(docstrings, optionflags=doctest.NORMALIZE_WHITESPACE) == (0, 1)


def test_every_public_function_says_what_it_takes_and_returns_and_has_an_example() -> None:
    for name in bm.__all__:
        value = getattr(bm, name)
        if inspect.isfunction(value):
            said = inspect.getdoc(value) or ""
            wanted = ["Returns", "Examples"] + ["Parameters"] * bool(inspect.signature(value).parameters)
            assert [part for part in wanted if f"{part}\n---" not in said] == [], name
