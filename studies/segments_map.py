"""Segments needed for 1 % in the first three modes, for every pair of ends and every rule."""

from __future__ import annotations

import xarray
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

import beammodes as bm
from beammodes.views.symbols import GREY
from studies.common import MATCHED, MODES
from studies.plots import NUMBER_MAP, plot_number_map
from studies.study import Progress, Sheet, Study

TOLERANCE = 0.01
# Rules that lay out the same chain on some boundary stand side by side.
_BESIDE = (
    "hencky",
    "naive",
    "double_wall",
    "mitiguy",
    "gregory2",
    "gregory",
    "rigid_stub_corrected",
    "rigid_stub",
    "half_stub",
    "half_stub_corrected",
)


def _pieces(name: str) -> tuple[object, ...]:
    rule = bm.RULES[name]
    return rule.stub, rule.rotary_inertia, rule.inside


def _place(name: str) -> float:
    """Return where a rule stands: one without a place of its own behind the last with the same pieces."""
    if name in _BESIDE:
        return _BESIDE.index(name)
    alike = [i for i, other in enumerate(_BESIDE) if _pieces(other) == _pieces(name)]
    return max(alike, default=len(_BESIDE)) + 0.5


#: Every rule.
ORDER = tuple(sorted(bm.RULES, key=_place))
LIMITS = (3, 200)


def data(progress: Progress) -> xarray.Dataset:
    """Return segments by boundary and rule, and the first rule in the row that lays out the same chains."""
    needed, same = [], []
    for i, pair in enumerate(bm.BOUNDARIES):
        chains = [_chain(pair, rule) for rule in ORDER]
        first = [ORDER[chains.index(chain)] for chain in chains]
        counts = {rule: bm.segments_needed(pair, TOLERANCE, MODES, rule) for rule in dict.fromkeys(first)}
        needed.append([*(counts[rule] for rule in first), _shortest_matched(pair)])
        same.append([*first, MATCHED.name])
        progress(i + 1, len(bm.BOUNDARIES))
    dims = ("boundary", "rule")
    return xarray.Dataset(
        {"segments_needed": (dims, needed), "same_chain_as": (dims, same)},
        coords={"boundary": [pair.name for pair in bm.BOUNDARIES], "rule": [*ORDER, MATCHED.name]},
    )


def _chain(pair: bm.Boundary, name: str) -> tuple[object, ...]:
    rule, enough = bm.RULES[name], 12
    return (
        rule.rotary_inertia,
        rule.piece_lengths(pair, enough),
        # No weight differs at other N without differing here: all hold N in one term, or not at all.
        rule.hinge_weights(pair, enough),
    )


def _shortest_matched(pair: bm.Boundary) -> int:
    for count in range(MODES, 2 * MODES + 1):
        if abs(bm.frequency_error(pair, segments=count, mode=MODES, rule=MATCHED)) <= TOLERANCE:
            return count
    raise ArithmeticError(f"no short chain of {pair.name} has {MATCHED.name} springs")


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw the map, its scale beside it."""
    ax = figure.subplots()
    plot_number_map(table.segments_needed, table.same_chain_as, ax, limits=LIMITS)
    names = [str(name).replace("_", "_\n").replace("(", "\n(") for name in table.rule.values]
    ax.set_xticks(ax.get_xticks(), names, fontsize=9)
    bar = figure.colorbar(
        ScalarMappable(LogNorm(*LIMITS), NUMBER_MAP), ax=ax, aspect=40, pad=0.01, label="segments N"
    )
    bar.set_ticks([3, 10, 30, 100, 200], labels=["3", "10", "30", "100", "200"])
    bar.minorticks_off()
    figure.supxlabel(
        "One cell across several rules: they lay out the same chain. matched(3): its shortest, exact.",
        fontsize=10,
        color=GREY,
    )


STUDY = Study(
    name="segments_map",
    title="Segments needed for 1 % in the first three natural frequencies",
    caption="Segments needed for 1 % in the first three modes, for every pair of ends and every rule.",
    data=data,
    draw=draw,
    sheets={".csv": Sheet(("boundary", "rule", "segments_needed", "same_chain_as"))},
    size=(9.0, 5.6),
)
