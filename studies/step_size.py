"""The step size: the report's step, its recipe, and the steps that are stable and accurate.

Constants are by theory; growth beyond the limit and the cost of the recipe are measured on the nonlinear
chain, integrated at given steps. A page in Markdown says what the report's step was, and what to use instead.
"""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

import beammodes as bm
from beammodes.dynamics.runs import Stepper, runge_kutta
from beammodes.dynamics.simulation import mode_start
from beammodes.vibration.integrators import accuracy_limit
from beammodes.vibration.stability import published_constants
from beammodes.views.symbols import COLOURS, GREY
from studies.c_table import SAFE_CONSTANT, step_constants
from studies.plots import plain_ticks
from studies.step_trials import equal_start, largest_angles, modal_motion, variable_step_cost
from studies.study import Kind, Progress, Sheet, Study
from studies.tables import markdown_table

BOUNDARIES = ("clamped-free", "clamped-clamped")
#: One of each kind.
ANALYSED = ("rk4", "midpoint", "leapfrog")
SEGMENTS = range(1, 13)
MODES = 5
#: Of the first mode, by joint dampers d_j = β k_j; mode n then has 0.01 ω_n/ω_1.
DAMPING_RATIOS = (0.0, 0.01)
#: Largest angle at the start: all modes in equal amounts, or the first mode with that added [rad].
SMALL = 1e-6
STARTS = (SMALL, 0.5, 1.0)
STEPS = 2000
#: Enough where a step is far too long.
FEW_STEPS = 400
#: Fixed steps of Runge-Kutta: the safe bound, multiples of 2√2/ω_max, and the report's for 1 and 3 modes.
FIXED = ("safe", "0.99", "1.01", "1.5", "published 1", "published 3")
SHOWN = ("clamped-free", 4)
#: The recipe: the published step for so many modes, at these tolerances, over so many steps, from 0.1 rad.
RECIPE_MODES = (1, 3)
TOLERANCES = (1e-3, 1e-6)
OUTPUTS = 3


def data(progress: Progress) -> xarray.Dataset:
    """Return constants by theory, and growth, cost and courses of the nonlinear chain integrated."""
    chains = [
        (place, bm.Chain(bm.Beam.unit(), boundary, segments=count))
        for place, (boundary, count) in _places().items()
    ]
    table = _empty()
    for done, (place, chain) in enumerate(chains, start=1):
        if chain.elastic_modes:
            _constants(table, place, chain)
            _growth(table, place, chain)
            _recipe(table, place, chain)
        progress(done, len(chains))
    table["C"] = np.minimum(table.C_stable, table.C_accurate)
    return table


def _places() -> dict[tuple[int, int], tuple[str, int]]:
    pairs = product(enumerate(BOUNDARIES), enumerate(SEGMENTS))
    return {(i, j): (boundary, count) for (i, boundary), (j, count) in pairs}


def _empty() -> xarray.Dataset:
    coords = {
        "boundary": list(BOUNDARIES),
        "segments": list(SEGMENTS),
        "integrator": list(ANALYSED),
        "damping_ratio": list(DAMPING_RATIOS),
        "modes": list(range(1, MODES + 1)),
        "start": list(STARTS),
        "fixed_step": list(FIXED),
        "recipe_modes": list(RECIPE_MODES),
        "rtol": list(TOLERANCES),
        # Denser at the start, where divergence is decided.
        "number": np.unique(np.geomspace(1, STEPS, 120).round().astype(int)),
    }
    chain, recipe = ("boundary", "segments"), ("boundary", "segments", "recipe_modes")
    dims = {
        "C_stable": (*chain, "integrator", "damping_ratio"),
        "C_accurate": (*chain, "integrator", "damping_ratio", "modes"),
        "growth_at_1_01": chain,
        "step_over_limit": (*chain, "fixed_step"),
        **dict.fromkeys(("largest", "tenfold", "overflow"), (*chain, "start", "fixed_step")),
        "step_over_limit_asked": recipe,
        **dict.fromkeys(("steps", "evaluations"), (*recipe, "rtol")),
        "angle": ("start", "fixed_step", "number"),
    }
    sizes = {name: len(values) for name, values in coords.items()}
    table = xarray.Dataset(
        {name: (over, np.full([sizes[d] for d in over], np.nan)) for name, over in dims.items()}, coords
    )
    table["C_published"] = ("modes", published_constants())
    table["C_safe"] = ("segments", SAFE_CONSTANT / np.array(SEGMENTS) ** 2.0)
    frequency = [bm.euler_bernoulli(bm.Beam.unit(), b, MODES).angular_frequency for b in BOUNDARIES]
    table["K"] = (("boundary", "modes"), np.array(frequency))
    limits = xarray.DataArray([accuracy_limit(name) for name in ANALYSED], dims="integrator")
    table["C_beam"] = (limits / table.K).transpose("boundary", "integrator", "modes")
    return table


def _constants(table: xarray.Dataset, place: tuple[int, int], chain: bm.Chain) -> None:
    for (k, name), (m, ratio) in product(enumerate(ANALYSED), enumerate(DAMPING_RATIOS)):
        if name == "leapfrog" and ratio:
            continue
        stable, accurate = step_constants(chain, MODES, name, damping_ratio=ratio)
        table.C_stable[(*place, k, m)] = stable
        table.C_accurate[(*place, k, m)] = accurate


def fixed_steps(chain: bm.Chain) -> dict[str, float]:
    """Return the fixed steps that a chain is integrated with, NaN for modes that it does not have."""
    limit = bm.stable_time_step(chain)
    steps = {name: float(name) * limit for name in ("0.99", "1.01", "1.5")}
    steps["safe"] = SAFE_CONSTANT / chain.segments**2
    for modes in RECIPE_MODES:
        known = modes <= chain.elastic_modes
        steps[f"published {modes}"] = bm.published_time_step(bm.Beam.unit(), modes) if known else math.nan
    return {name: steps[name] for name in FIXED}


def course(stepper: Stepper, chain: bm.Chain, start: float, step: float) -> np.ndarray:
    """Return the largest angle after each of up to 2,000 steps, from one of `STARTS`."""
    state = equal_start(chain, SMALL)
    if start != SMALL:
        state = state + np.concatenate(mode_start(chain, 1, start))
    count = STEPS if step < 1.1 * bm.stable_time_step(chain) else FEW_STEPS
    return largest_angles(stepper, state, step, count)


def _growth(table: xarray.Dataset, place: tuple[int, int], chain: bm.Chain) -> None:
    stepper, limit = runge_kutta(chain), bm.stable_time_step(chain)
    motion = modal_motion(chain, chain.elastic_modes, 1.01 * limit, 100, amplitude=1e-9)
    table.growth_at_1_01[place] = abs(motion[-1]) ** 0.01
    for f, (name, step) in enumerate(fixed_steps(chain).items()):
        table.step_over_limit[(*place, f)] = step / limit
        if math.isnan(step):
            continue
        for s, start in enumerate(STARTS):
            angle, where = course(stepper, chain, start, step), (*place, s, f)
            table.largest[where] = angle.max() / start
            for name, event in (("tenfold", angle > 10 * start), ("overflow", np.isinf(angle))):
                table[name][where] = np.argmax(event) + 1 if event.any() else math.nan
            if (chain.boundary.name, chain.segments) == SHOWN:
                numbers = table.number.values[table.number.values <= len(angle)]
                table.angle[s, f, : len(numbers)] = angle[numbers - 1]


def _recipe(table: xarray.Dataset, place: tuple[int, int], chain: bm.Chain) -> None:
    for k, modes in enumerate(RECIPE_MODES):
        if modes > chain.elastic_modes:
            continue
        step = bm.published_time_step(bm.Beam.unit(), modes)
        table.step_over_limit_asked[(*place, k)] = step / bm.stable_time_step(chain)
        for m, tolerance in enumerate(TOLERANCES):
            cost = variable_step_cost(chain, step, OUTPUTS, tolerance=tolerance)
            table.steps[(*place, k, m)], table.evaluations[(*place, k, m)] = cost.steps, cost.evaluations


def draw(table: xarray.Dataset, figure: Figure) -> None:
    """Draw C against N, the divergence of the chain, and the work of the variable step."""
    panels = figure.subplot_mosaic([["constants", "growth"], ["constants", "recipe"]], width_ratios=(1.08, 1))
    _draw_constants(table, panels["constants"])
    _draw_growth(table, panels["growth"])
    _draw_recipe(table, panels["recipe"])


def _write(ax: Axes, x: float, y: float, text: str, colour: str, **how: object) -> None:
    halo = [withStroke(linewidth=2.5, foreground="white")]
    ax.text(x, y, text, color=colour, path_effects=halo, **{"fontsize": 9.5, "va": "center", **how})


def _draw_constants(table: xarray.Dataset, ax: Axes) -> None:
    free = table.sel(boundary=SHOWN[0])
    undamped, damped = free.isel(damping_ratio=0), free.isel(damping_ratio=1)
    for modes in (1, 3, 5):
        line = free.C_published.sel(modes=modes)
        ax.plot([modes, 12], [line, line], color=COLOURS[1])
        _write(ax, 12.6, float(line), f"published,\n{modes} mode{'s' if modes > 1 else ''}", COLOURS[1])
    stable = undamped.C_stable.sel(integrator="rk4")
    ax.plot(table.segments, stable, color=COLOURS[0], marker="o")
    ax.plot(table.segments, free.C_safe, color=GREY, linestyle=(0, (4, 2)))
    late = slice(5, None)
    ax.plot(
        table.segments[late],
        damped.C_stable.sel(integrator="rk4")[late],
        color=COLOURS[4],
        marker="v",
    )
    accurate = undamped.C.sel(integrator="rk4", modes=3)
    ax.plot(table.segments, accurate, color=COLOURS[2], marker="s", markersize=3.5)
    for modes in (1, 3):
        line = undamped.C.sel(integrator="midpoint", modes=modes)
        ax.plot(table.segments, line, color=COLOURS[3], linestyle=(0, (1, 1)), linewidth=2)
    _write(ax, 1.15, 0.95, "Runge-Kutta, stable: 2√2/ω_max", COLOURS[0])
    _write(ax, 0.95, 0.068, "safe bound\n0.408/N²", GREY)
    _write(ax, 0.95, 0.0245, "midpoint,\n1 mode accurate", COLOURS[3])
    _write(ax, 2.85, 2.3e-3, "midpoint,\n3 modes accurate", COLOURS[3], ha="right")
    _write(ax, 0.95, 6.6e-3, "Runge-Kutta,\n3 modes accurate\n(and stable)", COLOURS[2])
    _write(ax, 7.4, 8e-4, "Runge-Kutta, stable\nwith joint damping:\n1 % in mode 1", COLOURS[4], ha="right")
    ax.set(xscale="log", yscale="log", xlim=(0.9, 26), ylim=(3e-4, 1.3))
    plain_ticks(ax, [1, 2, 3, 4, 6, 8, 12])
    ax.set_xlabel("number of segments N")
    ax.set_ylabel("C in  h = C L² √(ρA/EI)")
    ax.set_title("Clamped-free: the constant C")


def _draw_growth(table: xarray.Dataset, ax: Axes) -> None:
    looks = {"0.99": COLOURS[2], "1.01": COLOURS[4], "1.5": COLOURS[1], "published 1": COLOURS[6]}
    top = 2e5
    for start, dashes in ((SMALL, "-"), (STARTS[1], (0, (3, 1.5)))):
        for name, colour in looks.items():
            course = table.angle.sel(start=start, fixed_step=name).dropna("number")
            numbers = np.concatenate([[0.7], course.number])
            angle = np.concatenate([[start], course])
            angle = np.where(np.isinf(angle), np.nan, angle)
            ax.plot(numbers, angle, color=colour, linestyle=dashes, linewidth=1.4)
    _write(ax, 9, 2e4, "← published (1 mode): 11.7 × limit", COLOURS[6])
    _write(ax, 9, 1e3, "← 1.5 × limit", COLOURS[1])
    _write(ax, 120, 3e-5, "1.01 × limit:\ngrows 7.3 % a\nstep, saturates", COLOURS[4])
    _write(ax, 20, 2.5e-8, "0.99 × limit: bounded", COLOURS[2])
    _write(ax, 9, 8, "dashed: from 0.5 rad", GREY)
    ax.set(xscale="log", yscale="log", xlim=(0.7, STEPS), ylim=(8e-9, top))
    ax.set_xticks([1, 10, 100, 1000], ["1", "10", "100", "1000"])
    ax.set_yticks([1e-8, 1e-6, 1e-4, 1e-2, 1, 100, 1e4])
    ax.minorticks_off()
    ax.set_xlabel("steps of fixed-step Runge-Kutta")
    ax.set_ylabel("largest angle  [rad]")
    ax.set_title(f"What a fixed step does ({SHOWN[0]}, N = {SHOWN[1]})")


def _draw_recipe(table: xarray.Dataset, ax: Axes) -> None:
    free = table.sel(boundary=SHOWN[0], rtol=TOLERANCES[0])
    for colour, modes in zip((COLOURS[1], COLOURS[0]), RECIPE_MODES, strict=True):
        line = free.sel(recipe_modes=modes)
        ax.plot(table.segments, line.evaluations, color=colour, marker="o")
        fixed = 4 * line.step_over_limit_asked
        ax.plot(table.segments, fixed.where(fixed >= 4), color=colour, linestyle=(0, (4, 2)))
    ax.axhline(4, color=COLOURS[6], linewidth=1.2)
    _write(ax, 1.0, 2.3, "as published, at fixed step: 4; diverges from N = 2", COLOURS[6])
    last = free.isel(segments=-1)
    for colour, modes in zip((COLOURS[1], COLOURS[0]), RECIPE_MODES, strict=True):
        end = last.sel(recipe_modes=modes)
        name = f"h for {modes} mode{'s' if modes > 1 else ''}:"
        _write(ax, 13, float(end.evaluations), f"{name}\nvariable step", colour)
        _write(ax, 13, 4 * float(end.step_over_limit_asked), "fixed, at limit", colour)
    ax.set(xscale="log", yscale="log", xlim=(0.9, 34), ylim=(1, 5000))
    plain_ticks(ax, [1, 2, 3, 4, 6, 8, 12], [1, 4, 10, 100, 1000])
    ax.set_xlabel("number of segments N")
    ax.set_ylabel("evaluations per published step")
    ax.set_title("What the variable step (tolerance 0.001) does")


PAGE = """# The step size, settled

The largest step is h = C L² √(ρA/EI), L being the beam's length. Chains have the report's springs.

**Why the published C is too long.** It is 8/K_n. Fixed-step Runge-Kutta does not know which modes are wanted:
it is stable while h ω ≤ √8 for the *highest* mode that the chain has, which lies just below √48 N². So C must
fall as 1/N², and the 8 has lost its square root. The published step is stable only where it happens to lie
below that limit: {stable_published}. From a millionth of
a radian, every other one of those for 1 and 3 modes overflows within {slowest} steps.

**What the report's recipe really did.** To a variable-step integrator the published step is the distance of
two frames. Between them it takes as many steps as its error estimate asks for, since an unstable step shows
as an error and is taken again: at a tolerance of 0.001 and N = 12, clamped-free, {steps_1:.0f} steps for each
published one for 1 mode and {steps_3:.0f} for 3 modes, with {cost_1:,.0f} and {cost_3:.0f} evaluations of the
accelerations instead of 4. So the recipe gives right motions, but not thanks to its step; and fixed-step
Runge-Kutta at its limit would do with {share_1:.0f} and {share_3:.0f} % of that work.

**What to use instead.** With K_n of the beam between its own ends, no joint damping, small motions:

- Runge-Kutta, fixed step: C = min({rk4:.4f}/K_n, 0.408/N²). The first keeps the frequency of modes 1 to n
  within 0.1 % and their amplitude within 1 % over 100 periods (the amplitude binds); the second keeps the
  chain stable and needs no eigen-solve.
- Implicit midpoint rule: C = {midpoint:.4f}/K_n for any N. This is a rule of the report's kind, where only
  the modes wanted count. The amplitude is exact, the frequency binds. A step costs an implicit solve.
- Leapfrog, semi-implicit Euler: C = min({leapfrog:.4f}/K_n, 0.288/N²).

With joint dampers or a load these numbers do not hold. Dampers shorten the step of Runge-Kutta (column
`damped`), and of others that take them explicitly. They lengthen it where they are taken implicitly, as by
MuJoCo's Euler, implicit and implicitfast and by Drake's discrete plants. Tension, such as the weight of a
chain that hangs, shortens it. `stable_time_step(chain, integrator, load=, damping=)` has the limit of each.

## C for n modes, beside the published one

Accuracy only, from K_n of the beam (a chain's own frequencies are lower, so these are safe for it).

{by_mode}
## C by number of segments

Columns n = 1 to 5: Runge-Kutta, accurate for the first n modes and stable. `limit` is 2√2/ω_max alone, `safe`
the bound 0.408/N²; `midpoint 1` and `midpoint 3` are accurate for 1 and 3 modes.

`damped` is the Runge-Kutta limit with joint dampers d_j = β k_j that give the first mode a damping ratio of
1 %. Mode n then has 0.01 ω_n/ω_1. In the last modes of a long clamped-free chain that is more than 1: their
fast decay asks for a shorter step than their oscillation did. **`limit` and `safe` hold for undamped chains
only.**
{by_segments}
## Large motions

`limit` and `safe` come from small motions. From 0.5 rad in the first mode all these chains stay bounded for
2,000 steps at 0.99 of the limit. From 1 rad clamped-free chains still do, but clamped-clamped ones of
{unbounded} segments diverge there, and those of {unsafe} even at the safe bound: about their
folded shapes they swing at up to three times ω_max.

Just beyond the limit nothing need be seen. At 1.01 of it the highest mode grows by {growth:.1f} % a step from
a millionth of a radian, but leaves the range where the chain is linear and saturates at {least:.2g} to
{most:.2g} rad (N = 1 alone is linear for good and grows without end). In a motion of 0.5 rad that is lost.
"""


def page(table: xarray.Dataset) -> str:
    """Return the page in Markdown."""
    free = table.sel(boundary=SHOWN[0], segments=SEGMENTS[-1], rtol=TOLERANCES[0])
    steps, cost = free.steps.values, free.evaluations.values
    published = table.C_published <= table.C_stable.sel(integrator="rk4", damping_ratio=0.0)
    has = ~np.isnan(table.C_accurate.sel(integrator="rk4", damping_ratio=0.0))
    short = [
        f"{boundary} N = {n} ({m} mode{'s' if m > 1 else ''})"
        for boundary, n, m in product(BOUNDARIES, SEGMENTS, range(1, MODES + 1))
        if bool((published & has).sel(boundary=boundary, segments=n, modes=m))
    ]
    asked = table.step_over_limit.sel(fixed_step=["published 1", "published 3"])
    small = table.sel(start=SMALL, fixed_step=asked.fixed_step).where(asked > 1)
    large = np.isinf(table.largest.sel(boundary="clamped-clamped", start=STARTS[2]))
    beyond = SMALL * table.largest.sel(start=SMALL, fixed_step="1.01", segments=slice(2, None))
    shares = 4 * free.step_over_limit_asked.values / cost
    return PAGE.format(
        stable_published=" and ".join(short),
        slowest=int(small.overflow.max()),
        steps_1=steps[0],
        steps_3=steps[1],
        cost_1=cost[0],
        cost_3=cost[1],
        **{name: accuracy_limit(name) for name in ANALYSED},
        by_mode=_by_mode(table),
        by_segments=_by_segments(table),
        unbounded=_listed(table.segments.values[large.sel(fixed_step="0.99")]),
        unsafe=_listed(table.segments.values[large.sel(fixed_step="safe")]),
        growth=100 * (float(table.growth_at_1_01.max()) - 1),
        least=float(beyond.min()),
        most=float(beyond.max()),
        share_1=100 * shares[0],
        share_3=100 * shares[1],
    )


def _listed(numbers: np.ndarray) -> str:
    return " and ".join(", ".join(map(str, numbers.tolist())).rsplit(", ", 1))


def _by_mode(table: xarray.Dataset) -> str:
    columns = ["n", "published", *(f"{name}, {boundary}" for boundary in BOUNDARIES for name in ANALYSED)]
    constants = [
        table.C_beam.sel(boundary=boundary, integrator=name).values
        for boundary in BOUNDARIES
        for name in ANALYSED
    ]
    rows = [
        [n, float(table.C_published[n - 1]), *(float(c[n - 1]) for c in constants)]
        for n in range(1, MODES + 1)
    ]
    return markdown_table(columns, rows, digits=3)


def _by_segments(table: xarray.Dataset) -> str:
    wanted = range(1, MODES + 1)
    columns = ["N", *(f"n = {n}" for n in wanted), "limit", "safe", "midpoint 1", "midpoint 3", "damped"]
    text = ""
    for boundary in BOUNDARIES:
        one = table.sel(boundary=boundary)
        plain = one.sel(damping_ratio=0.0)
        rows: list[list[object]] = [["published", *one.C_published.values.tolist(), *[math.nan] * 5]]
        for n in SEGMENTS:
            here, still = one.sel(segments=n), plain.sel(segments=n)
            numbers = [
                *still.C.sel(integrator="rk4").values,
                still.C_stable.sel(integrator="rk4"),
                here.C_safe,
                *still.C.sel(integrator="midpoint", modes=[1, 3]).values,
                here.C_stable.sel(integrator="rk4", damping_ratio=DAMPING_RATIOS[1]),
            ]
            if not math.isnan(numbers[0]):
                rows.append([n, *map(float, numbers)])
        text += f"\n### {boundary.capitalize()}\n\n{markdown_table(columns, rows, digits=3)}"
    return text


_GROWN = Kind(factor=1e3)  # Above the limit a motion grows from rounding, by up to 1e120 where it is seen.
STUDY = Study(
    name="step_size",
    title="The published step is too long; the variable-step integrator hid it",
    caption="The published step against those that are stable and accurate, and what its recipe really does.",
    data=data,
    draw=draw,
    # A row stands for a chain that has the mode and a method that was measured.
    sheets={
        ".csv": Sheet(
            (
                "boundary",
                "segments",
                "integrator",
                "damping_ratio",
                "modes",
                "C_published",
                "C_safe",
                "C_stable",
                "C_accurate",
                "C",
            ),
            needs="C",
        ),
        "_modes.csv": Sheet(
            ("boundary", "integrator", "modes", "K", "C_published", "C_beam"), needs="C_beam"
        ),
        "_growth.csv": Sheet(
            (
                "boundary",
                "segments",
                "start",
                "fixed_step",
                "step_over_limit",
                "growth_at_1_01",
                "largest",
                "tenfold",
                "overflow",
            ),
            {"largest": _GROWN, "tenfold": Kind(factor=2.0), "overflow": Kind(factor=2.0)},
            needs="largest",
        ),
        "_recipe.csv": Sheet(
            ("boundary", "segments", "recipe_modes", "rtol", "step_over_limit_asked", "steps", "evaluations"),
            needs="steps",
        ),
        "_courses.csv": Sheet(("start", "fixed_step", "number", "angle"), {"angle": _GROWN}, needs="angle"),
    },
    size=(9.0, 8.0),
    more=lambda table: {".md": page(table)},
    seconds=150.0,
)
