"""Time this project beside other people's tools:  python -m studies.benchmarks [--write].

Print Markdown tables measured in one run; --write puts them into their page. Needs the extra `benchmark`.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import textwrap
from collections.abc import Callable, Sequence
from functools import partial
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

import beammodes as bm
from beammodes.chains.rules import RULES
from beammodes.files import write_atomically
from studies.accuracy import beam_frequency, chain_frequency
from studies.batch_speed import batch_table
from studies.motion_rivals import moving
from studies.rivals import MEMORY, METHODS, duration, kane_equations, kane_units, nodal_matrices, timed
from studies.spin_up_rivals import growing, spinning
from studies.tables import markdown_table

__all__ = [
    "batches",
    "cell",
    "deriving",
    "environment",
    "lookups",
    "main",
    "replaced",
    "same_equations",
    "solving",
    "unequal",
]

ROOT = Path(__file__).resolve().parent.parent
BEGIN, END = "<!-- benchmarks: begin -->", "<!-- benchmarks: end -->"
PACKAGES = ("numpy", "scipy", "sympy", "casadi", "scikit-fem", "mujoco", "pin", "exudyn", "distributed")
SEGMENTS = (16, 128, 1024, 8192, 1_000_000)
UNEQUAL = (8, 32, 128, 1024, 10**5, 10**6, 10**7)
_LARGEST_DENSE = 1024
PATIENCE = 60.0
MODES = 3


def environment() -> str:
    """Return what the numbers depend on, as one sentence."""
    found = {d.metadata["Name"].lower(): d.version for d in metadata.distributions() if d.metadata["Name"]}
    versions = ", ".join(f"{name} {found[name]}" for name in PACKAGES if name in found)
    return (
        f"Measured in one run of `python -m studies.benchmarks`: one BLAS thread, {os.cpu_count()} CPUs "
        f"({platform.machine()}), {platform.system()}, Python {platform.python_version()}, {versions}. "
        "Times are medians of repeated calls after a first one, unless a table says otherwise."
    )


def same_equations(segments: int = 3) -> float:
    """Return the largest difference of this project's and Kane's M and forcing at random states."""
    import sympy

    kane, q, u = kane_equations(segments)
    ours = bm.equations_of_motion(bm.Chain(bm.Beam.unit(), "clamped-free", segments))
    static = -(ours.velocity_terms + ours.static_forces)
    plain = [sympy.Symbol(f"z{i}") for i in range(2 * segments)]
    rename = dict(zip((*q, *u), plain, strict=True))
    rename_ours = dict(zip((*ours.coordinates, *ours.speeds), plain, strict=True)) | kane_units()
    pairs = ((ours.mass_matrix, kane.mass_matrix), (static, kane.forcing))
    worst = 0.0
    for state in np.random.default_rng(0).uniform(-2, 2, (5, 2 * segments)):
        for mine, theirs in pairs:
            numbers = [
                sympy.lambdify(plain, matrix.xreplace(names))(*state)
                for matrix, names in ((mine, rename_ours), (theirs.subs(rename), {}))
            ]
            worst = max(worst, float(np.abs(numbers[0] - numbers[1]).max()))
    return worst


def deriving(ours: Sequence[int] = (12, 32), theirs: Sequence[int] = (12,)) -> str:
    """Return the times of deriving and linearizing, here and by sympy.physics.mechanics."""
    from sympy.core.cache import clear_cache

    difference = same_equations()
    if not difference < 1e-10:
        raise ArithmeticError(f"this project's equations and Kane's differ by {difference:.1e}")
    rows = []
    for segments in ours:
        _say(f"deriving, N = {segments}")
        # SymPy remembers what it has computed: a repeated call would be flattered.
        mine = timed(partial(_derive, segments), budget=3.0, before=clear_cache)[0]
        row = [f"{segments}", duration(mine), "not timed", "–"]
        if segments in theirs:
            kane = timed(partial(_derive_by_kane, segments), budget=0.0, before=clear_cache)[0]
            row[2:] = [duration(kane), f"{kane / mine:.0f}"]
        rows.append(row)
    columns = ["N", "this project", "`KanesMethod` and its `linearize`", "ratio"]
    return (
        "**Deriving and linearizing** a clamped-free chain with the report's springs. Both give the same "
        f"mass matrix and forcing at random states (checked in this run to {difference:.0e}). SymPy's cache "
        "is emptied before each call; `KanesMethod` is called once.\n\n" + markdown_table(columns, rows)
    )


def _derive(segments: int) -> None:
    bm.equations_of_motion(bm.Chain(bm.Beam.unit(), "clamped-free", segments)).linearize()


def _derive_by_kane(segments: int) -> None:
    kane, q, u = kane_equations(segments)
    kane.linearize(A_and_B=False, op_point=dict.fromkeys((*q, *u), 0))


def solving(counts: Sequence[int] = SEGMENTS, names: Sequence[str] = tuple(METHODS)) -> str:
    """Return time and largest relative error of three frequencies, by every method at every N."""
    rows = []
    for name in names:
        row, last = [name], None
        for segments in counts:
            _say(f"solving, {name}, N = {segments}")
            result = _refused(name, segments, last) or _measured(name, segments)
            last = (segments, result["seconds"]) if "seconds" in result else None
            row.append(cell(name, segments, result))
        rows.append(row)
    return (
        "**First three frequencies of one clamped-free chain** with the report's springs, building included: "
        "time and largest relative error. Errors are against the chain's own frequencies in 50-digit "
        "arithmetic; those of Hermite elements, which have no rigid segments, against the beam's. Each "
        f"measurement has a process of its own, {PATIENCE:.0f} s and {MEMORY / 1e9:.0f} GB.\n\n"
        + markdown_table(["method", *(f"N = {n:,}" for n in counts)], rows)
    )


def _refused(name: str, segments: int, last: tuple[int, float] | None) -> dict[str, Any] | None:
    """Say why not to try: the package, the memory, or the time foretold by the previous N."""
    method = METHODS[name]
    if find_spec(method.package) is None:
        return {"refused": "not installed"}
    if method.needs(segments) > MEMORY:
        return {"refused": f"not feasible: {method.needs(segments) / 1e9:,.0f} GB"}
    if last is not None:
        estimate = last[1] * (segments / last[0]) ** method.power
        if estimate > PATIENCE:
            return {"refused": f"not feasible: {duration(estimate)} by N{'⁰¹²³'[int(method.power)]}"}
    return None


def _measured(name: str, segments: int) -> dict[str, Any]:
    command = [sys.executable, "-m", "studies.rivals", name, str(segments)]
    try:
        done = subprocess.run(
            command, cwd=ROOT, capture_output=True, text=True, timeout=PATIENCE, check=False
        )
    except subprocess.TimeoutExpired:
        return {"refused": f"not feasible: over {PATIENCE:.0f} s"}
    if done.returncode:
        return {"raised": (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]}
    return dict(json.loads(done.stdout.splitlines()[-1]))


def cell(name: str, segments: int, result: dict[str, Any]) -> str:
    """Return a measurement as text: time and error, or what went wrong."""
    if "refused" in result:
        return str(result["refused"])
    if result.get("memory"):
        return f"not feasible: over {MEMORY / 1e9:.0f} GB"
    if "raised" in result:
        return "fails: " + textwrap.shorten(result["raised"].replace("|", "/"), 60, placeholder=" …")
    reference = beam_frequency if METHODS[name].of_beam else lambda mode: chain_frequency(segments, mode)
    true = [float(reference(mode)) for mode in range(1, MODES + 1)]
    errors = [float(abs(reference(k + 1) - w) / true[k]) for k, w in enumerate(result["frequencies"])]
    time = duration(result["seconds"])
    worst = int(np.argmax(errors))
    if not errors[worst] < 0.1:
        returned, symbol = result["frequencies"][worst], f"ω{'₁₂₃'[worst]}"
        if np.isnan(returned):
            return f"fails: {time}, {symbol} not real"
        return f"fails: {time}, {symbol} = {returned:.3g} for {true[worst]:.3g}"
    return f"{time}, {errors[worst]:.0e}"


def unequal(counts: Sequence[int] = UNEQUAL) -> str:
    """Return what a chain of springs that all differ costs: building it, and three modes of it."""
    rows = []
    for segments in counts:
        _say(f"unequal springs, N = {segments:,}")
        # The longest takes most of the memory: one chain at a time, and one call of each.
        budget = 1.0 if segments <= 10**5 else 0.0
        built, chain = timed(partial(_of_unequal_springs, segments), budget=budget)
        model = bm.linearize(chain)
        solved = timed(partial(bm.solve_modes, model, MODES), budget=budget)[0]
        each = f"{1e6 * (built + solved) / segments:.2g} µs"
        dense = _dense_time(model) if segments <= _LARGEST_DENSE else "not tried"
        rows.append([f"{segments:,}", duration(built), duration(solved), each, dense])
    columns = ["N", "building", "three modes", "both, for each spring", "`eigh(K, M)`, lowest three"]
    return (
        "**Springs that all differ**, random within a factor of 3, pinned at both ends, given piece by "
        "piece: how the cost of three modes and their shapes grows with N. Dense matrices, here for ω alone "
        "and already assembled, lose digits as N⁴.\n\n" + markdown_table(columns, rows)
    )


def _of_unequal_springs(segments: int) -> bm.Chain:
    ones = np.ones(segments)
    springs = np.random.default_rng(0).uniform(0.5, 1.5, segments - 1)
    return bm.Chain.from_pieces(
        length=ones, mass=ones, rotary_inertia=ones / 12, joint_stiffness=springs, boundary="pinned-pinned"
    )


def _dense_time(model: Any) -> str:
    stiffness, mass = model.stiffness_matrix, model.mass_matrix
    only = [0, MODES - 1]
    solve = partial(scipy.linalg.eigh, stiffness, mass, eigvals_only=True, subset_by_index=only)
    return duration(timed(solve)[0])


def lookups(count: int = 1_000_000) -> str:
    """Return the cost of one error, in bulk, alone, and by matrices."""
    _say("lookups")
    generator = np.random.default_rng(0)
    even = generator.integers(1, 10**6, size=count, endpoint=True)
    alone = min(count, 1000)
    by_size = np.rint(10 ** generator.uniform(0, 6, size=count)).astype(np.int64)
    ways = {
        "one, the same again": (lambda: bm.frequency_error("clamped-free", segments=100, mode=1), 1),
        f"one after another, {alone:,} that differ": (_one_after_another(generator, by_size[:alone]), alone),
        f"{count:,} in one call, N evenly from 1 to 10⁶": (_mixed(generator, even), count),
        f"{count:,} in one call, log N evenly": (_mixed(generator, by_size), count),
        f"{alone:,} with bodies and springs, one after another": (
            _loaded_alone(generator, by_size[:alone]),
            alone,
        ),
        f"{count:,} with bodies and springs, log N evenly": (_loaded(generator, by_size), count),
        "instead of one: K, M and `scipy.linalg.eigh`, N = 100": (_one_by_matrices, 1),
    }
    rows = []
    for label, (call, size) in ways.items():
        first, repeated = timed(call, budget=0.0)[0], timed(call, budget=3.0)[0]
        rows.append([label, duration(first / size), duration(repeated / size)])
    return (
        "**Lookups** of `frequency_error`; in the mixed ones boundary, rule and mode up to 5 are random. "
        "The first call imports, and fills what later ones find ready.\n\n"
        + markdown_table(["lookups", "time per error, first call", "repeated"], rows)
    )


def _one_after_another(generator: np.random.Generator, segments: NDArray[np.int64]) -> Callable[[], Any]:
    """Return as many single calls as there are N, each with a boundary, mode and rule of its own."""
    ends, rules, mode = _drawn(generator, len(segments))
    cases = list(zip(ends.tolist(), segments.tolist(), mode.tolist(), rules.tolist(), strict=True))
    return lambda: [bm.frequency_error(pair, segments=n, mode=m, rule=rule) for pair, n, m, rule in cases]


def _mixed(generator: np.random.Generator, segments: NDArray[np.int64]) -> Callable[[], Any]:
    """Return one call that looks up a random boundary, mode and rule of equal springs for each N."""
    ends, rules, mode = _drawn(generator, len(segments))
    return lambda: bm.frequency_error(ends, segments=segments, mode=mode, rule=rules)


def _loaded(generator: np.random.Generator, segments: NDArray[np.int64]) -> Callable[[], Any]:
    """Return one call that looks up random ends, within a decade and a half of one, for each N."""
    _, rules, mode = _drawn(generator, len(segments))
    pair = (_random_ends(generator, len(segments)), _random_ends(generator, len(segments)))
    return lambda: bm.frequency_error(pair, segments=segments, mode=mode, rule=rules)


def _loaded_alone(generator: np.random.Generator, segments: NDArray[np.int64]) -> Callable[[], Any]:
    """Return as many single calls as there are N, each with a body of its own on the tip."""
    _, rules, mode = _drawn(generator, len(segments))
    tips = [bm.End(mass=float(mass)) for mass in generator.uniform(0.0, 2.0, len(segments))]
    cases = list(zip(tips, segments.tolist(), mode.tolist(), rules.tolist(), strict=True))
    return lambda: [
        bm.frequency_error(("clamped", tip), segments=n, mode=m, rule=rule) for tip, n, m, rule in cases
    ]


def _random_ends(generator: np.random.Generator, count: int) -> bm.Ends:
    """Return ends of which a quarter hold, and of the others most have a spring, half a body."""

    def sizes(share: float) -> NDArray[np.float64]:
        there = generator.random(count) < share
        return np.where(there, 10 ** generator.uniform(-1.5, 1.5, count), 0.0)

    def springs() -> NDArray[np.float64]:
        return np.where(generator.random(count) < 0.25, np.inf, sizes(0.6))

    offset = generator.uniform(-0.3, 0.3, count)
    return bm.Ends(springs(), springs(), sizes(0.5), 0.01 * sizes(0.4), offset)


def _drawn(
    generator: np.random.Generator, count: int
) -> tuple[NDArray[Any], NDArray[Any], NDArray[np.int64]]:
    ends = np.array([pair.name for pair in bm.BOUNDARIES])[generator.integers(len(bm.BOUNDARIES), size=count)]
    # Those with a closed form: a pattern inside is solved chain by chain.
    names = np.array([name for name, rule in RULES.items() if rule.has_equal_springs])
    rules = names[generator.integers(len(names), size=count)]
    return ends, rules, generator.integers(1, 5, size=count, endpoint=True)


def _one_by_matrices() -> float:
    segments = 100
    stiffness, mass = (matrix.toarray() for matrix in nodal_matrices(segments))
    square = scipy.linalg.eigh(stiffness, mass, eigvals_only=True, subset_by_index=[0, 0])[0]
    exact = bm.euler_bernoulli(bm.Beam.unit(), "clamped-free", modes=1).angular_frequency[0]
    return float(np.sqrt(square) * segments**2 / exact - 1)


def batches() -> str:
    """Return the cost of a study by engine, and what 10⁹ points need."""
    _say("batches")
    if find_spec("distributed") is None:
        return "**Studies** were not timed: Dask is not installed."
    return batch_table()


def replaced(text: str, tables: str) -> str:
    """Return `text` with `tables` between the two marks."""
    if text.count(BEGIN) != 1 or text.count(END) != 1 or text.index(BEGIN) > text.index(END):
        raise ValueError(f"the file must have {BEGIN} once, and {END} once after it")
    return f"{text[: text.index(BEGIN)]}{BEGIN}\n{tables.strip()}\n{text[text.index(END) :]}"


def _say(text: str) -> None:
    sys.stderr.write(text + "\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, and write if asked to; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m studies.benchmarks", description=__doc__)
    parser.add_argument("--write", action="store_true", help="put the tables into the page, too")
    options = parser.parse_args(arguments)
    try:
        from threadpoolctl import threadpool_limits
    except ImportError:
        parser.error("threadpoolctl is needed: pip install -e '.[benchmark]'")
    page = ROOT / "beammodes" / "pages" / "benchmarks.md"
    # A page that cannot take the tables is found out before, not after, the minutes of measuring.
    replaced(page.read_text("utf-8"), "")
    tables = ""
    with threadpool_limits(1):
        for part in (environment, deriving, solving, unequal, moving, spinning, growing, lookups, batches):
            text = part().strip() + "\n"
            print(text, flush=True)
            tables += text + "\n"
    if options.write:
        # Read again: it may have been edited while this ran.
        whole = replaced(page.read_text("utf-8"), tables).encode()
        write_atomically(page, lambda file: file.write(whole))
    return 0


if __name__ == "__main__":
    sys.exit(main())
