"""Springs as words beside their symbols: fractions of EI/ell where they are exact, or N m/rad."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from beammodes.chains.chain import Chain, Number
from beammodes.checks import choice
from beammodes.views.end_symbols import EndPlace
from beammodes.views.pose import Pose
from beammodes.views.symbols import GROUND_SPRING, SPRING

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["LABELS", "draw_spring_labels", "draw_support_labels", "spring_texts", "support_texts"]

#: Units in which springs may be written.
LABELS = ("EI/ell", "N m/rad")
#: Up to so many hinges every spring has its label; of more, equal neighbours share one.
_CROWD = 12
#: More labels than this cannot be read.
_MOST = 60
#: Larger fractions are written as decimals.
_LARGEST = 99
#: Room for a label above and beside its place, in lengths of the chain.
_ABOVE, _BESIDE = 0.11, 0.09


def spring_texts(chain: Chain, unit: str = "EI/ell") -> list[str]:
    """Return the springs at a chain's hinges, left to right, as labels of a drawing.

    Parameters
    ----------
    chain : Chain
    unit : str
        "EI/ell", of the mean EI (the numbers as given for a chain from pieces), or "N m/rad".

    Raises
    ------
    TypeError, ValueError
        If `unit` is another.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> spring_texts(Chain(Beam.unit(), "clamped-free", segments=4, rule="gregory"))
    ['8/3', '6/7', '24/23', '1']
    """
    own = choice("unit", unit, LABELS) == "EI/ell"
    return [_text(k) for k in (chain.hinge_stiffness if own else chain.joint_stiffness.tolist())]


def support_texts(chain: Chain, unit: str = "EI/ell") -> list[tuple[str, str]]:
    """Return K_t and K_r of both ends' elastic supports as labels; "" where an end holds or leaves free.

    Parameters
    ----------
    chain : Chain
    unit : str
        "EI/ell" gives them in EI/L³ and EI/L, "N m/rad" in N/m and N m/rad.

    Raises
    ------
    TypeError, ValueError
        If `unit` is another.

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> ends = "pinned(rotational_stiffness=8)-free(translational_stiffness=2)"
    >>> support_texts(Chain(Beam.unit(), ends, 4, "double_wall"))   # 2 EI/ell in series with 8 EI/L
    [('', '4 EI/L'), ('2 EI/L³', '')]
    """
    own = choice("unit", unit, LABELS) == "EI/ell"
    if not own:
        names: Sequence[str] = (" N/m", " N m/rad")
        pairs = chain.support_stiffness.tolist()
    else:
        size = chain.segments or 1
        names = (" EI/L³", " EI/L") if chain.segments else ("", "")
        pairs = [(k_t * size**3, k_r * size) for k_t, k_r in chain.supports]
    return [
        (_elastic(translation, names[0]), _elastic(rotation, names[1])) for translation, rotation in pairs
    ]


def draw_spring_labels(ax: Axes, chain: Chain, pose: Pose, unit: str, *, lift: float, size: float) -> None:
    """Write each hinge's spring `lift` [m] beside it, on the upper side of the straight chain."""
    texts, whole = spring_texts(chain, unit), float(chain.node_position[-1])
    runs = _runs(texts) if len(texts) > _CROWD else [(j, text) for j, text in enumerate(texts)]
    if len(runs) > _MOST:
        return
    for hinge, text in runs:
        turned = complex(np.exp(1j * pose.angle[hinge]) + np.exp(1j * pose.angle[hinge + 1]))
        normal = 1j * turned / abs(turned) if abs(turned) > 1e-9 else 1j
        foot = complex(pose.x[hinge + 1], pose.y[hinge + 1]) + lift * normal
        away = 0.85 * size * normal
        ax.annotate(
            text,
            (foot.real, foot.imag),
            (away.real, away.imag),
            textcoords="offset points",
            ha="center",
            va="center",
            color=SPRING,
            fontsize=size,
            zorder=6,
        )
        top = foot + _ABOVE * whole * normal
        ax.update_datalim([(top.real - _BESIDE * whole, top.imag), (top.real + _BESIDE * whole, top.imag)])


def draw_support_labels(
    ax: Axes, chain: Chain, places: Sequence[EndPlace], unit: str, *, size: float
) -> None:
    """Write the springs of elastic supports below the ends, on the side of the beam."""
    for place, (translation, rotation) in zip(places, support_texts(chain, unit), strict=False):
        lower = place.body.half / place.length
        for text, below in ((rotation, 0.075), (translation, 0.19 if rotation else 0.15)):
            if text:
                _draw_beside(ax, place, text, max(below, lower + 0.65 * below), size)


def _draw_beside(ax: Axes, place: EndPlace, text: str, below: float, size: float) -> None:
    x, y = place.at[0] - place.side * 0.11 * place.length, place.at[1] - below * place.length
    align = "left" if place.side < 0 else "right"
    ax.text(x, y, text, ha=align, va="center", color=GROUND_SPRING, fontsize=size, zorder=6)
    ax.update_datalim([(x, y - 0.04 * place.length)])


def _text(value: Number) -> str:
    if isinstance(value, Fraction) and max(value.numerator, value.denominator) <= _LARGEST:
        return str(value)
    return f"{float(value):.4g}"


def _elastic(value: Number, unit: str) -> str:
    return _text(value) + unit if 0 < value < math.inf else ""


def _runs(texts: list[str]) -> list[tuple[int, str]]:
    """Return each run of equal neighbours as the hinge in its middle and how often it says what."""
    runs, first = [], 0
    for text, same in itertools.groupby(texts):
        count = len(list(same))
        runs.append((first + (count - 1) // 2, text if count == 1 else f"{count} × {text}"))
        first += count
    return runs
