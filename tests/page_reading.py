"""Reading what the page shows: tables, numbers with the digits that they have, rows of springs."""

from __future__ import annotations

import re
from collections.abc import Sequence
from fractions import Fraction
from html.parser import HTMLParser

import numpy as np
import pytest


class Tables(HTMLParser):
    """The cells of every table, by the first words of its caption."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: dict[str, list[list[str]]] = {}
        self.caption, self.into = "", ""
        # Pictures are long, and no table is in them.
        self.feed(re.sub(r'src="[^"]*"', "", text))

    def handle_starttag(self, tag: str, attrs: Sequence[tuple[str, str | None]]) -> None:
        del attrs
        if tag == "caption":
            self.caption = ""
        if tag == "tr":
            self.found.setdefault(self.caption.strip(), []).append([])
        if tag in ("td", "th"):
            self.found[self.caption.strip()][-1].append("")
        self.into = {"caption": "caption", "td": "cell", "th": "cell", "sup": ""}.get(tag, self.into)

    def handle_endtag(self, tag: str) -> None:
        if tag in ("caption", "td", "th"):
            self.into = ""

    def handle_data(self, data: str) -> None:
        if self.into == "caption":
            self.caption += data
        elif self.into == "cell":
            self.found[self.caption.strip()][-1][-1] += data


def rows(tables: dict[str, list[list[str]]], words: str) -> list[list[str]]:
    """The rows below the head of the one table whose caption begins so."""
    (found,) = (cells for caption, cells in tables.items() if caption.startswith(words))
    return found[1:]


def same(shown: str, value: float) -> None:
    """Assert that what is shown is a value, as far as its digits go."""
    if shown == "–":
        assert np.isnan(value)
        return
    text = shown.translate(str.maketrans("−⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "--0123456789")).replace(" × 10", "e")
    mantissa = re.sub(r"e.*", "", text).lstrip("+-")
    power = int(text.partition("e")[2] or 0) - len(mantissa.partition(".")[2])
    assert float(text) == pytest.approx(value, rel=1e-9, abs=0.500001 * 10.0**power)


def stiffnesses(text: str) -> list[float]:
    """A row of springs as it is shown: "8/3, 6/7, 2 × 1"."""
    found: list[float] = []
    for part in filter(None, text.split(", ")):
        count, times, spring = part.partition("\u00a0×\u00a0")
        found += [float(Fraction(spring if times else count))] * (int(count) if times else 1)
    return found
