"""Drawings as SVG to stand inside HTML: small, alike each time, without scripts or links."""

from __future__ import annotations

import hashlib
import io
import re
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["MOST_LINES", "inline_svg"]

#: A drawing of more parts than this becomes dots: as lines it would be larger than the notebook around it.
MOST_LINES = 20

#: What Matplotlib writes for files that stand alone. Its style would be that of the whole page.
_ALONE = re.compile(r"<\?xml.*?\?>|<!DOCTYPE.*?>|<!--.*?-->|<metadata>.*?</metadata>|<style.*?</style>", re.S)
_STYLE = "stroke-linejoin: round; stroke-linecap: butt; max-width: 100%; height: auto; background: #ffffff"


def inline_svg(ax: Axes, *, width: float, height: float, parts: int = 0) -> str:
    """Return the figure of a drawing as an SVG element, on white so that it reads on a dark page too.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
        Of a figure that nobody else uses: it gets another size.
    width, height : float [in]
        Of the figure; what is empty around the drawing is cut away.
    parts : int
        Of how many the drawing is; of more than `MOST_LINES` it becomes dots.

    Examples
    --------
    >>> import beammodes as bm
    >>> ax = bm.draw_chain(bm.Chain(bm.Beam.unit(), "clamped-free", segments=4), labels=None)
    >>> text = inline_svg(ax, width=4.0, height=1.0)
    >>> text[:5], "<style" in text, "<script" in text, "matplotlib" in text
    ('<svg ', False, False, False)
    """
    from matplotlib.figure import Figure

    from beammodes.views.own_axes import drawn_box

    figure, file = ax.figure, io.BytesIO()
    assert isinstance(figure, Figure)
    figure.set_size_inches(width, height)
    if parts > MOST_LINES:
        ax.set_rasterization_zorder(float("inf"))
    box: Any = drawn_box(figure).padded(0.05)
    figure.savefig(file, format="svg", bbox_inches=box, dpi=150, facecolor="white")
    text = _ALONE.sub("", file.getvalue().decode("utf-8"))
    text = re.sub(r"\s*\n\s*", " ", text.replace("<defs>\n </defs>", "")).strip()
    return _own_names(text.replace("<svg ", f'<svg style="{_STYLE}" ', 1))


def _own_names(text: str) -> str:
    """Return an SVG whose names no other drawing on the page has."""
    used = dict.fromkeys(re.findall(r'url\(#([^)]+)\)|href="#([^"]+)"', text))
    names = {name: f"{k}" for k, name in enumerate(dict.fromkeys("".join(pair) for pair in used))}
    plain = re.sub(
        r' id="([^"]+)"', lambda found: f' id="@{names[found[1]]}"' if found[1] in names else "", text
    )
    plain = re.sub(r"url\(#([^)]+)\)", lambda found: f"url(#@{names[found[1]]})", plain)
    plain = re.sub(r'href="#([^"]+)"', lambda found: f'href="#@{names[found[1]]}"', plain)
    own = hashlib.sha256(plain.encode()).hexdigest()[:8]
    return plain.replace('id="@', f'id="b{own}-').replace("#@", f"#b{own}-")
