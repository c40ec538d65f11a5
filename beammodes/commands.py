"""What each command of the command line answers: data for scripts, and the same as text for people."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from beammodes.accuracy.advice import Recommendation

__all__ = [
    "Answer",
    "answer_buckling",
    "answer_error",
    "answer_export",
    "answer_frequencies",
    "answer_recommend",
    "answer_segments",
    "answer_springs",
    "answer_time_step",
]

#: What a command found: the answer for scripts, and the same as text for people.
Answer = tuple[dict[str, Any], str]


def answer_error(options: argparse.Namespace) -> Answer:
    """Answer the relative frequency error of one mode of a uniform chain."""
    from beammodes.accuracy.errors import frequency_error

    error: float = frequency_error(
        options.boundary,
        segments=options.segments,
        mode=options.mode,
        rule=options.rule,
        load=_load(options),
    )
    if math.isnan(error):
        raise ValueError(
            f"mode {options.mode} does not exist: {options.boundary} with {options.segments} segments "
            f"and rule {options.rule} has fewer elastic modes"
        )
    answer = {
        "boundary": options.boundary,
        "rule": options.rule,
        "segments": options.segments,
        "mode": options.mode,
        "relative_error": error,
    }
    if options.axial_force:
        answer["axial_force"] = options.axial_force
    note = (
        "  (coarse: a mode this near the chain's last is wrong under every rule)" if abs(error) > 0.1 else ""
    )
    return answer, f"{100 * error:+.6g} %{note}"


def answer_frequencies(options: argparse.Namespace) -> Answer:
    """Answer a chain's natural frequencies beside the exact beam's."""
    import numpy as np

    from beammodes.accuracy.errors import frequency_error
    from beammodes.exact.beam_theory import euler_bernoulli
    from beammodes.vibration.linear import linearize
    from beammodes.vibration.modes import solve_modes

    chain, load = _chain(options), _load(options)
    model = linearize(chain, load=load)
    modes = solve_modes(model, options.modes)
    count = len(modes.frequency)
    exact = euler_bernoulli(_beam(options), options.boundary, max(count, 1), load=load).frequency[:count]
    each = np.arange(1, count + 1)
    errors = modes.frequency / exact - 1
    if count and chain.boundary.is_plain and not options.axial_force:
        # Closed form: digits that a difference of frequencies does not have.
        errors = np.asarray(
            frequency_error(options.boundary, segments=options.segments, mode=each, rule=options.rule)
        )
    rows = [
        {"mode": int(n), "frequency_hz": float(f), "exact_frequency_hz": float(g), "relative_error": float(e)}
        for n, f, g, e in zip(each, modes.frequency, exact, errors, strict=True)
    ]
    kinds = f"{modes.rigid_body_modes} rigid-body and {model.elastic_modes} elastic modes"
    title = f"{chain.boundary.name}, {options.segments} segments, {options.rule}: {kinds}"
    return {"rigid_body_modes": modes.rigid_body_modes, "modes": rows}, _frequency_table(title, rows)


def _frequency_table(title: str, rows: list[dict[str, Any]]) -> str:
    lines = [
        f"{row['mode']:4d}  {row['frequency_hz']:14.6g}  {row['exact_frequency_hz']:14.6g}  "
        f"{100 * row['relative_error']:+10.4g}"
        for row in rows
    ]
    return "\n".join([title, "mode       chain [Hz]       exact [Hz]   error [%]", *lines])


def answer_springs(options: argparse.Namespace) -> Answer:
    """Answer the joint stiffnesses to type into a multibody tool."""
    chain = _chain(options)
    rows = [
        {"hinge": j + 1, "position_m": float(x), "stiffness_n_m_per_rad": float(k)}
        for j, (x, k) in enumerate(zip(chain.hinge_position, chain.joint_stiffness, strict=True))
    ]
    lines = [
        f"{row['hinge']:5d}  {row['position_m']:12.6g}  {row['stiffness_n_m_per_rad']:20.10g}" for row in rows
    ]
    answer: dict[str, Any] = {"hinges": rows}
    for side, (translation, rotation) in zip(("left", "right"), chain.support_stiffness, strict=True):
        for kind, stiffness, unit in (
            ("translational", translation, "N/m"),
            ("rotational", rotation, "N m/rad"),
        ):
            if 0 < stiffness < math.inf:
                answer[f"{side}_{kind}_support"] = float(stiffness)
                lines.append(f"{kind} support of the {side} end: {stiffness:.10g} {unit}")
    return answer, "\n".join(["hinge  position [m]  stiffness [N m/rad]", *lines])


def answer_buckling(options: argparse.Namespace) -> Answer:
    """Answer the compression at which a chain buckles, beside the beam's."""
    from beammodes.accuracy.buckling import buckling_load

    chain = _chain(options)
    load, exact = buckling_load(chain), buckling_load(_beam(options), options.boundary)
    if math.isinf(load):
        raise ValueError(
            f"segments must be larger: {chain.boundary.name} with {options.segments} cannot bend"
        )
    answer = {"buckling_load_n": load, "exact_buckling_load_n": exact, "relative_error": load / exact - 1}
    return answer, f"{load:.6g} N  (beam {exact:.6g} N, error {100 * answer['relative_error']:+.4g} %)"


def answer_export(options: argparse.Namespace) -> Answer:
    """Write a chain to a file for a simulator, and answer which files were written."""
    from beammodes.dynamics.damping import Damping
    from beammodes.exporters.export import export_chain

    damping = Damping(stiffness=options.stiffness_damping) if options.stiffness_damping else None
    written = export_chain(
        _chain(options),
        options.output,
        format=options.format,
        name=options.name,
        fragment=options.fragment,
        damping=damping,
        timestep=options.timestep,
        integrator=options.integrator,
        force=options.force,
    )
    names = [str(path) for path in written]
    return {"files": names}, "\n".join(names)


def answer_segments(options: argparse.Namespace) -> Answer:
    """Answer how many segments a tolerance needs."""
    from beammodes.accuracy.errors import segments_needed

    count = segments_needed(options.boundary, options.tolerance, options.modes, options.rule)
    return {"segments": count}, str(count)


def answer_time_step(options: argparse.Namespace) -> Answer:
    """Answer the largest stable fixed time step of a chain."""
    from beammodes.vibration.stability import highest_angular_frequency, stable_time_step

    chain = _chain(options)
    load = _load(options)
    step = stable_time_step(chain, options.integrator, load=load)
    highest = highest_angular_frequency(chain, load=load)
    if math.isinf(step):
        raise ValueError(
            f"segments must be larger: {chain.boundary.name} with {options.segments} has no elastic mode "
            "and so no stability limit"
        )
    answer = {"time_step_s": step, "highest_angular_frequency_rad_per_s": highest}
    return answer, f"{step:.6g} s  ({options.integrator}, highest angular frequency {highest:.6g} rad/s)"


def _beam(options: argparse.Namespace) -> Any:
    from beammodes.problem.beam import Beam

    return Beam(length=options.length, bending_stiffness=options.ei, mass_per_length=options.rho_a)


def _load(options: argparse.Namespace) -> Any:
    from beammodes.problem.loading import Load

    return Load(axial_force=options.axial_force)


def _chain(options: argparse.Namespace) -> Any:
    from beammodes.chains.chain import Chain

    return Chain(_beam(options), options.boundary, segments=options.segments, rule=options.rule)


def answer_recommend(options: argparse.Namespace) -> Answer:
    """Answer the rules that meet a tolerance, cheapest first."""
    from beammodes.accuracy.advice import recommend

    ways = recommend(
        options.boundary,
        options.tolerance,
        options.modes,
        beam=_beam(options),
        rules=options.rule.split(",") if options.rule else None,
        integrator=options.integrator,
    )
    rows = [
        {
            "rule": way.rule,
            "segments": way.segments,
            "largest_error": way.largest_error,
            "static_error": way.static_error,
            "highest_angular_frequency_rad_per_s": way.highest_angular_frequency,
            "stable_time_step_s": way.stable_time_step,
            "cost": way.cost,
            "joint_stiffness_n_m_per_rad": way.joint_stiffness.tolist(),
        }
        for way in ways
    ]
    return {"recommendations": rows}, _advice_table(ways, options.integrator)


def _advice_table(ways: list[Recommendation], integrator: str) -> str:
    lines = ["rule                     N   error [%]   static error [%]      step [s]      cost"]
    for way in ways:
        static = max(way.static_error.values(), key=abs, default=math.nan)
        lines.append(
            f"{way.rule:22}{way.segments:5d}  {100 * way.largest_error:10.3g}  {100 * static:17.3g}  "
            f"{way.stable_time_step:12.4g}  {way.cost:8.3g}"
        )
    lines.append(
        "static: worst of tip force, tip moment and uniform load; nan where the beam can move rigidly"
    )
    lines.append(f"cost: segments times {integrator} steps in one period of the first mode")
    return "\n".join(lines)
