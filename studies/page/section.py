"""Figure 4 of the report: an I-section, its integral worked in two ways, and its drawing."""

from __future__ import annotations

import numpy as np

import beammodes as bm
from studies.page.markup import Cell, bound, table

__all__ = ["SECTION", "agreement", "drawing", "integral_over_strips", "table_section", "web_share"]

#: IPE 200 without its fillets [m]; the scan of Figure 4 has no dimensions.
SECTION = bm.ISection(width=0.1, height=0.2, flange=0.0085, web=0.0056)
_MILLIMETRES, _CM2, _CM4 = 1e3, 1e4, 1e8


def integral_over_strips(section: bm.ISection) -> tuple[float, float]:
    """Return A and ∫ d² dA as sums over level strips of the section's width at each height [m², m⁴].

    Gauss's two points are exact for d² on each part of constant width.

    >>> area, second = integral_over_strips(bm.ISection(0.1, 0.2, 0.0085, 0.0056))
    >>> round(area * 1e4, 4), round(second * 1e8, 2)
    (27.248, 1845.59)
    """
    half, inner = section.height / 2, section.height / 2 - section.flange
    edges = [-half, -inner, inner, half]
    points, weights = np.polynomial.legendre.leggauss(2)
    area = second = 0.0
    for low, high, width in zip(edges, edges[1:], (section.width, section.web, section.width), strict=False):
        d = (low + high) / 2 + (high - low) / 2 * points
        strip = width * (high - low) / 2 * weights
        area, second = area + float(strip.sum()), second + float((strip * d**2).sum())
    return area, second


def agreement() -> str:
    """Say how far the formula and the sum over strips agree."""
    area, second = integral_over_strips(SECTION)
    worst = max(abs(area / SECTION.area - 1), abs(second / SECTION.second_moment - 1))
    if worst > 1e-12:
        raise ArithmeticError(f"two integrals of {SECTION} differ by {worst}")
    return f"agree to {bound(worst)}"


def web_share() -> float:
    """Return the part of I that the web has."""
    web = bm.Rectangle(width=SECTION.web, height=SECTION.height - 2 * SECTION.flange)
    return web.second_moment / SECTION.second_moment


def table_section(note: str) -> str:
    """Return the integral by its parts, by the formula of the whole, and by strips."""
    web = bm.Rectangle(width=SECTION.web, height=SECTION.height - 2 * SECTION.flange)
    area, second = integral_over_strips(SECTION)
    rows: list[list[Cell]] = [
        ["web", web.area * _CM2, web.second_moment * _CM4],
        [
            "both flanges",
            (SECTION.area - web.area) * _CM2,
            (SECTION.second_moment - web.second_moment) * _CM4,
        ],
        ["the whole, by formula", SECTION.area * _CM2, SECTION.second_moment * _CM4],
        ["the whole, ∫ d² dA over strips", area * _CM2, second * _CM4],
        ["on its side, by formula", SECTION.area * _CM2, SECTION.weak_second_moment * _CM4],
    ]
    return table(["part", "A, cm²", "I, cm⁴"], rows, f"The integral, worked.{note}")


def drawing() -> str:
    """Return the section with its dimensions and the axis through its centroid, as SVG."""
    b, h, f, s = (
        _MILLIMETRES * size for size in (SECTION.width, SECTION.height, SECTION.flange, SECTION.web)
    )
    left, top, scale = 150.0, 30.0, 1.1

    def x(across: float) -> str:
        return f"{left + scale * across:.1f}"

    def y(down: float) -> str:
        return f"{top + scale * down:.1f}"

    outline = [(0, 0), (b, 0), (b, f), ((b + s) / 2, f), ((b + s) / 2, h - f), (b, h - f)]
    outline += [(b, h), (0, h), (0, h - f), ((b - s) / 2, h - f), ((b - s) / 2, f), (0, f)]
    path = " ".join(f"{x(across)},{y(down)}" for across, down in outline)
    strip = 0.22 * h
    texts = [
        (x(b / 2), y(h + 24), "middle", f"width {b:g} mm"),
        (x(-32), y(h / 2 - 6), "end", f"height {h:g} mm"),
        (x(b + 12), y(f + 3), "start", f"flange {f:g} mm"),
        (x(b / 2 + 12), y(0.72 * h), "start", f"web {s:g} mm"),
        (x(b + 58), y(h / 2 - 6), "start", "x, through the centroid"),
        (x(b / 2 + 24), y(strip - 5), "start", "dA"),
        (x(b / 2 + 40), y((strip + h / 2) / 2 + 6), "start", "d"),
    ]
    words = "\n".join(
        f'<text x="{across}" y="{down}" text-anchor="{anchor}">{text}</text>'
        for across, down, anchor, text in texts
    )
    return f"""<svg viewBox="0 0 520 290" role="img" aria-label="An I-section with its dimensions"
 font-family="DejaVu Sans, Verdana, sans-serif" font-size="13" fill="#1a1a1a">
<polygon points="{path}" fill="#c9d8e6" stroke="#44515c"/>
<path d="M{x(-25)},{y(h / 2)} H{x(b + 170)}" stroke="#0072b2" stroke-dasharray="9 4 2 4"/>
<rect x="{x((b - s) / 2)}" y="{y(strip)}" width="{scale * s:.1f}" height="4" fill="#d55e00"/>
<path d="M{x(b / 2 + 32)},{y(strip)} V{y(h / 2)} m-4,-7 l4,7 l4,-7 M{x(b / 2 + 28)},{y(strip)} h9"
 fill="none" stroke="#d55e00"/>
<path d="M{x(-14)},{y(0)} V{y(h)} m-5,0 h10 M{x(-14)},{y(0)} m-5,0 h10" fill="none" stroke="#44515c"/>
<path d="M{x(0)},{y(h + 9)} H{x(b)}" stroke="#44515c"/>
{words}
</svg>"""
