"""The page of the step size: what the report's was, what to use instead, and the tables."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import xarray

from beammodes.vibration.integrators import accuracy_limit
from studies.step_size_data import (
    ANALYSED,
    BOUNDARIES,
    DAMPING_RATIOS,
    MODES,
    SEGMENTS,
    SHOWN,
    SMALL,
    STARTS,
    TOLERANCES,
)
from studies.tables import markdown_table

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
