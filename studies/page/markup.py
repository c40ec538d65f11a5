"""Numbers, tables and pictures as HTML. Nothing is computed here."""

from __future__ import annotations

import base64
import html
import math
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from urllib.parse import quote

from studies import every_study

__all__ = ["Cell", "bound", "escaped", "figure", "percent", "picture", "significant", "table"]

Cell = str | int | float


def escaped(text: str) -> str:
    """Return text as it may stand in HTML, in attributes too."""
    return html.escape(text, quote=True)


def significant(value: float, digits: int = 4, *, sign: bool = False) -> str:
    """Return a number to some significant digits, with a real minus sign; a dash where it is missing.

    >>> significant(-0.8), significant(1 / 3, 2, sign=True), significant(2.5e-7, 2), significant(1846.4)
    ('−0.8000', '+0.33', '2.5 × 10⁻⁷', '1846')
    """
    if math.isnan(value):
        return "–"
    text = f"{value:{'+' if sign else ''}#.{digits}g}"
    number, _, power = text.partition("e")
    number = number.removesuffix(".")
    if power:
        raised = str(int(power)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
        number = f"{number} × 10{raised}"
    return number.replace("-", "−")


def percent(value: float, digits: int = 4) -> str:
    """Return a signed fraction in percent, without the sign %.

    >>> percent(-0.0080003693)
    '−0.8000'
    """
    return significant(100 * value, digits, sign=True)


def bound(difference: float) -> str:
    """Return a power of ten that a rounding difference does not exceed: the same on every machine.

    >>> bound(3e-13), bound(0.0)
    ('10⁻¹²', '10⁻¹⁵')
    """
    power = max(-15, math.ceil(math.log10(difference))) if difference else -15
    return "10" + str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def table(
    heads: Sequence[str],
    rows: Iterable[Sequence[Cell]],
    caption: str,
    *,
    words: Sequence[int] = (0,),
    quoted: Sequence[int] = (),
) -> str:
    """Return a table; heads and caption are HTML, cells are text.

    Columns `words` are no numbers; columns `quoted` are what the report prints.
    """
    styles = [" ".join(_styles(i, words, quoted)) for i in range(len(heads))]
    head = "".join(_cell("th", name, styles[i], "col") for i, name in enumerate(heads))
    body = "\n".join(
        "<tr>" + "".join(_row_cell(cell, i, styles[i]) for i, cell in enumerate(row)) + "</tr>"
        for row in rows
    )
    return (
        f'<div class="scroll" tabindex="0" role="group" aria-label="{caption.split("<")[0]}"><table>\n'
        f"<caption>{caption}</caption>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n</tbody></table></div>"
    )


def _styles(column: int, words: Sequence[int], quoted: Sequence[int]) -> list[str]:
    return ["word"] * (column in words) + ["theirs"] * (column in quoted)


def _row_cell(cell: Cell, column: int, style: str) -> str:
    text = escaped(significant(cell) if isinstance(cell, float) else str(cell))
    return _cell("td", text, style) if column else _cell("th", text, style, "row")


def _cell(tag: str, content: str, style: str, scope: str = "") -> str:
    named = f' class="{style}"' if style else ""
    scoped = f' scope="{scope}"' if scope else ""
    return f"<{tag}{named}{scoped}>{content}</{tag}>"


def picture(folder: Path, name: str) -> str:
    """Return a study's picture as an image that is part of the page."""
    source = _vector((folder / f"{name}.svg").read_text(encoding="utf-8"))
    alt = escaped(every_study()[name].caption)
    return f'<button type="button" class="enlarge"><img src="{source}" alt="{alt}"></button>'


def _vector(svg: str) -> str:
    body = svg[svg.index("<svg") :]
    # Nothing that is seen: what the drawing program notes, and places beyond a hundredth of a point.
    body = re.sub(r"<!--.*?-->|<metadata>.*?</metadata>", "", body, flags=re.DOTALL)
    body = re.sub(r'(?<=[ "])-?\d+\.\d{3,}(?=[\s"])', lambda found: f"{float(found[0]):.2f}", body)
    body = re.sub(r"\s*\n\s*", " ", body)
    if "'" in body:
        return f"data:image/svg+xml;base64,{base64.b64encode(body.encode()).decode()}"
    # Quotation marks of the other kind need no escape in the attribute, and most of the rest none at all.
    return "data:image/svg+xml," + quote(body.replace('"', "'"), safe=" !$'()*+,/:;=?@[]|{}^`~")


def figure(content: str, caption: str, name: str) -> str:
    """Return content, HTML, with a caption, HTML, under an anchor."""
    return f'<figure id="picture-{name}">\n{content}\n<figcaption>{caption}</figcaption>\n</figure>'
