"""Pieces of the HTML that notebooks show: titles, sentences, tables of values, small curves."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from html import escape
from typing import Any

import numpy as np

from beammodes.checks import percent

__all__ = [
    "Html",
    "counted",
    "curve_of",
    "lines_of",
    "number_of",
    "numbered_table",
    "pairs_table",
    "percent_of",
    "table_of",
    "text_of",
    "title_of",
]

#: Of more rows the first and the last are shown.
_MOST_ROWS, _LAST = 12, 2
#: Numbers of a field that are shown, and letters of a text.
_MOST_NUMBERS, _MOST_LETTERS = 6, 300
#: Size of the picture of a mode's shape [px].
_WIDE, _HIGH = 96, 22


class Html(str):
    """Text that is HTML already."""

    __slots__ = ()


def counted(count: int, what: str) -> str:
    """Return a number of things in words.

    Examples
    --------
    >>> counted(2, "mode")
    '2 modes'
    """
    return f"{count} {what}{'s' * (count != 1)}"


def text_of(value: Any) -> str:
    """Return a value as it stands in a table, escaped.

    Examples
    --------
    >>> text_of((1.5, True, None)), text_of("<b>")
    ('1.5, yes, –', '&lt;b&gt;')
    """
    if isinstance(value, Html):
        return value
    if isinstance(value, bool | np.bool_):
        return "yes" if value else "no"
    if isinstance(value, int | np.integer):
        return str(int(value))
    if isinstance(value, float | np.floating):
        return number_of(float(value))
    if isinstance(value, Fraction):
        return str(value)
    if value is None:
        return "–"
    if isinstance(value, np.ndarray | tuple | list):
        flat = value.ravel() if isinstance(value, np.ndarray) else value
        more = f", … ({len(flat)} in all)" if len(flat) > _MOST_NUMBERS else ""
        between = "; " if len(flat) and isinstance(flat[0], tuple | list) else ", "
        return between.join(map(text_of, flat[:_MOST_NUMBERS])) + more if len(flat) else "none"
    if isinstance(value, Mapping):
        return escape(", ".join(f"{key}: {each}" for key, each in value.items()))
    own = getattr(value, "__name__", None) if callable(value) else None
    told = own if isinstance(own, str) else str(value)
    return escape(told if len(told) <= _MOST_LETTERS else f"{told[:_MOST_LETTERS]}…")


def number_of(value: float) -> str:
    """Return a number as text, a dash for NaN.

    Examples
    --------
    >>> number_of(-0.5), number_of(math.inf)
    ('−0.5', '∞')
    """
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    return f"{value:.6g}".replace("-", "−")


def percent_of(value: float) -> str:
    """Return a fraction in per cent, without the sign %; a dash for NaN.

    Examples
    --------
    >>> percent_of(0.05)
    '+5'
    """
    return "–" if math.isnan(value) else percent(value, rounding=1e-12, unit="").replace("-", "−")


def title_of(what: str, *said: str) -> str:
    """Return the line at the head: what it is in bold, then what is said of it.

    Examples
    --------
    >>> title_of("Chain", "", "5 segments")
    '<div><b>Chain</b> 5 segments</div>'
    """
    told = ", ".join(escape(part) for part in said if part)
    return f"<div><b>{escape(what)}</b>{' ' + told if told else ''}</div>"


def lines_of(said: Iterable[str]) -> str:
    """Return sentences, each on its line.

    Examples
    --------
    >>> lines_of(["a < b"])
    '<div>a &lt; b</div>'
    """
    return "".join(f"<div>{escape(line)}</div>" for line in said)


def table_of(
    head: Sequence[str],
    rows: Iterable[Sequence[Any]],
    words: Iterable[int] = (0,),
    *,
    most: int = _MOST_ROWS,
    count: int | None = None,
) -> str:
    """Return a table; the columns `words` are text and stand to the left, numbers to the right.

    `count` is how many rows there are, where some are left out already.

    Examples
    --------
    >>> table_of(("mode", "f [Hz]"), [(1, 2.5)]).count("<td")
    2
    """
    listed, left = list(rows), set(words)
    count = count or len(listed)
    cut = count > most
    shown = [*listed[: most - _LAST], None, *listed[-_LAST:]] if cut else listed

    def cell(kind: str, column: int, content: str) -> str:
        side = "left" if column in left else "right"
        return f'<{kind} style="text-align: {side}; padding: 0.1em 0.7em">{content}</{kind}>'

    def row(values: Sequence[Any] | None) -> str:
        if values is None:
            return f'<tr><td colspan="{len(head)}" style="text-align: center">… {count} in all</td></tr>'
        return f"<tr>{''.join(cell('td', i, text_of(value)) for i, value in enumerate(values))}</tr>"

    top = "".join(cell("th", i, escape(name)) for i, name in enumerate(head))
    head_row = f"<thead><tr>{top}</tr></thead>" if any(head) else ""
    return (
        '<table style="border-collapse: collapse; margin: 0.3em 0; font-variant-numeric: tabular-nums">'
        f"{head_row}<tbody>{''.join(map(row, shown))}</tbody></table>"
    )


def numbered_table(head: Sequence[str], *columns: Any) -> str:
    """Return a table of arrays, side by side, of which only the rows that are shown are read.

    Examples
    --------
    >>> numbered_table(("", "k"), np.arange(100.0)).count("<tr>")
    14
    """
    count = len(columns[0])
    places = (
        [*range(_MOST_ROWS - _LAST), *range(count - _LAST, count)] if count > _MOST_ROWS else range(count)
    )
    rows = [(k + 1, *(column[k] for column in columns)) for k in places]
    return table_of(head, rows, words=(), count=count)


def pairs_table(rows: Iterable[tuple[str, Any, str]]) -> str:
    """Return a table of names, values and units.

    Examples
    --------
    >>> "1.2 m" in pairs_table([("length", 1.2, "m")])
    True
    """
    told = [(name, text_of(value), escape(unit)) for name, value, unit in rows]
    listed = [(name, Html(f"{text} {unit}" if unit and text != "–" else text)) for name, text, unit in told]
    return table_of(("", ""), listed, words=(0, 1)) if listed else ""


def curve_of(values: Any) -> Html:
    """Return a mode's shape as a picture in a row of a table.

    Examples
    --------
    >>> curve_of([0.0, 1.0]).count("polyline"), curve_of([0.0, 0.0])
    (1, '')
    """
    y = np.asarray(values, dtype=np.float64)
    largest = float(np.abs(y).max())
    if not (largest > 0 and math.isfinite(largest)):
        return Html("")
    middle, half = _HIGH / 2, _HIGH / 2 - 2
    x = np.linspace(1, _WIDE - 1, len(y)) if y.ndim == 1 else y[0]
    points = " ".join(
        f"{a:.1f},{b:.1f}" for a, b in zip(x.tolist(), (middle - half * y / largest).tolist(), strict=True)
    )
    return Html(
        f'<svg width="{_WIDE}" height="{_HIGH}" viewBox="0 0 {_WIDE} {_HIGH}" style="vertical-align: middle">'
        f'<path d="M1 {middle}H{_WIDE - 1}" stroke="currentColor" stroke-opacity="0.3"/>'
        f'<polyline points="{points}" fill="none" stroke="currentColor" stroke-width="1.5"/></svg>'
    )
