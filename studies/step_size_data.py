"""What integrators need and do: constants by theory, and the nonlinear chain integrated at given steps."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import xarray

import beammodes as bm
from beammodes.dynamics.runs import Stepper, runge_kutta
from beammodes.dynamics.simulation import mode_start
from beammodes.vibration.integrators import accuracy_limit
from beammodes.vibration.stability import published_constants
from studies import Progress
from studies.c_table import SAFE_CONSTANT, step_constants
from studies.step_trials import equal_start, largest_angles, modal_motion, variable_step_cost

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


def data(progress: Progress | None = None) -> xarray.Dataset:
    """Constants by theory; growth, the recipe's cost and a few courses by integrating the nonlinear chain."""
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
        if progress is not None:
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
