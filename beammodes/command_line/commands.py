"""What each command of the command line answers: data for scripts, and the same as text for people."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING, Any

from beammodes.checks import positive_real
from beammodes.command_line.text_tables import frequency_table, number, percents, text_table, typed_in

if TYPE_CHECKING:
    from beammodes.accuracy.advice import Recommendation

__all__ = [
    "Answer",
    "answer_buckling",
    "answer_error",
    "answer_frequencies",
    "answer_recommend",
    "answer_segments",
    "answer_springs",
    "answer_time_step",
    "beam_of",
    "chain_of",
    "damping_of",
    "load_of",
]

#: What a command found: the answer for scripts, and the same as text for people.
Answer = tuple[dict[str, Any], str]


def answer_error(options: argparse.Namespace) -> Answer:
    """Answer the relative frequency error of one mode of a uniform chain."""
    from beammodes.accuracy.errors import frequency_error
    from beammodes.accuracy.remarks import error_remarks
    from beammodes.problem.beam import Beam

    error: float = frequency_error(
        options.boundary,
        segments=options.segments,
        mode=options.mode,
        rule=options.rule,
        load=load_of(options),
        beam=Beam.unit(),
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
    remarks = error_remarks(
        options.boundary,
        segments=options.segments,
        mode=options.mode,
        rule=options.rule,
        load=load_of(options),
        beam=Beam.unit(),
    )
    if remarks:
        answer["remarks"] = list(remarks)
    return answer, "\n".join([f"{100 * error:+.6g} %", *(f"  {remark}" for remark in remarks)])


def answer_frequencies(options: argparse.Namespace) -> Answer:
    """Answer a chain's natural frequencies beside the exact beam's."""
    import numpy as np

    from beammodes.accuracy.errors import frequency_error
    from beammodes.exact.beam_theory import euler_bernoulli
    from beammodes.vibration.linear import linearize
    from beammodes.vibration.modes import solve_modes

    chain, load = chain_of(options), load_of(options)
    model = linearize(chain, load=load)
    modes = solve_modes(model, options.modes)
    count = len(modes.frequency)
    exact = euler_bernoulli(beam_of(options), options.boundary, max(count, 1), load=load).frequency[:count]
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
    return {"rigid_body_modes": modes.rigid_body_modes, "modes": rows}, f"{title}\n{frequency_table(rows)}"


def answer_springs(options: argparse.Namespace) -> Answer:
    """Answer the joint stiffnesses to type into a multibody tool."""
    chain = chain_of(options)
    rows = [
        {"hinge": j + 1, "position_m": float(x), "stiffness_n_m_per_rad": float(k)}
        for j, (x, k) in enumerate(zip(chain.hinge_position, chain.joint_stiffness, strict=True))
    ]
    lines = [
        text_table(
            ["hinge", "position [m]", "stiffness [N m/rad]"],
            [
                [str(row["hinge"]), number(row["position_m"]), typed_in(row["stiffness_n_m_per_rad"])]
                for row in rows
            ],
        )
    ]
    answer: dict[str, Any] = {"hinges": rows}
    for side, (translation, rotation) in zip(("left", "right"), chain.support_stiffness, strict=True):
        for kind, stiffness, unit in (
            ("translational", translation, "N/m"),
            ("rotational", rotation, "N m/rad"),
        ):
            if 0 < stiffness < math.inf:
                answer[f"{side}_{kind}_support"] = float(stiffness)
                lines.append(f"{kind} support of the {side} end: {typed_in(stiffness)} {unit}")
    return answer, "\n".join(lines)


def answer_buckling(options: argparse.Namespace) -> Answer:
    """Answer the compression at which a chain buckles, beside the beam's."""
    from beammodes.accuracy.buckling import buckling_load

    chain = chain_of(options)
    load, exact = buckling_load(chain), buckling_load(beam_of(options), options.boundary)
    if math.isinf(load):
        raise ValueError(
            f"segments must be larger: {chain.boundary.name} with {options.segments} cannot bend"
        )
    answer = {"buckling_load_n": load, "exact_buckling_load_n": exact, "relative_error": load / exact - 1}
    error = percents(answer["relative_error"])
    return answer, f"{number(load)} N  (beam {number(exact)} N, error {error} %)"


def answer_segments(options: argparse.Namespace) -> Answer:
    """Answer how many segments a tolerance needs."""
    from beammodes.accuracy.errors import segments_needed

    count = segments_needed(options.boundary, options.tolerance, options.modes, options.rule)
    return {"segments": count}, str(count)


def answer_time_step(options: argparse.Namespace) -> Answer:
    """Answer the largest stable fixed time step of a chain, and the case that it holds for."""
    from beammodes.problem.beam import Beam
    from beammodes.problem.loading import Load
    from beammodes.vibration.integrators import fixed_step_integrator
    from beammodes.vibration.stability import (
        GRAVITY,
        highest_angular_frequency,
        stable_time_step,
        taut_load,
    )

    chain, load = chain_of(options), load_of(options)
    damping = damping_of(options, chain)
    record = fixed_step_integrator(options.integrator)
    if record.springs == "implicit":
        raise ValueError(
            f'integrator must take springs explicitly: "{record.name}" does not and is stable at any step'
        )
    step = stable_time_step(chain, record.name, load=load, damping=damping)
    highest = highest_angular_frequency(chain, load=taut_load(chain, load))
    if math.isinf(step):
        raise ValueError(
            f"segments must be larger: {chain.boundary.name} with {options.segments} has no elastic mode "
            "and so no stability limit"
        )
    answer = {"time_step_s": step, "highest_angular_frequency_rad_per_s": highest}
    fastest = f"highest angular frequency {number(highest)} rad/s"
    case = "without load" if load == Load() else f"under {load}"
    text = f"{number(step)} s  ({options.integrator}, {fastest}, {case})"
    # In a beam's own units there is no such number as 9.81.
    if load == Load() and chain.beam != Beam.unit():
        hung = stable_time_step(chain, record.name, load=Load(gravity=GRAVITY), damping=damping)
        answer["time_step_under_gravity_s"] = hung
        if hung < 0.99 * step:
            text += (
                f"\n{number(hung)} s  with gravity {GRAVITY} m/s² in any direction, hanging too: --gravity"
            )
    return answer, text


def beam_of(options: argparse.Namespace) -> Any:
    """Return the beam that the options describe."""
    from beammodes.problem.beam import Beam

    return Beam(length=options.length, bending_stiffness=options.ei, mass_per_length=options.rho_a)


def load_of(options: argparse.Namespace) -> Any:
    """Return the load that the options describe."""
    from beammodes.problem.loading import Load

    names = ("axial_force", "gravity", "tip_force")
    given = {name: getattr(options, name, None) for name in names}
    return Load(**{name: value for name, value in given.items() if value is not None})


def damping_of(options: argparse.Namespace, chain: Any) -> Any:
    """Return the damping that the options describe, or None."""
    from beammodes.vibration.damping import Damping

    if options.damping_ratio is not None:
        from beammodes.dynamics.damping_ratio import joint_dampers

        if options.stiffness_damping:
            raise ValueError("--damping-ratio must be given without --stiffness-damping, which it sets")
        return joint_dampers(chain, positive_real("--damping-ratio", options.damping_ratio))
    return Damping(stiffness=options.stiffness_damping) if options.stiffness_damping else None


def chain_of(options: argparse.Namespace) -> Any:
    """Return the chain that the options describe."""
    from beammodes.chains.chain import Chain

    return Chain(beam_of(options), options.boundary, segments=options.segments, rule=options.rule)


def answer_recommend(options: argparse.Namespace) -> Answer:
    """Answer the rules that meet a tolerance, cheapest first."""
    from beammodes.accuracy.advice import recommend

    ways = recommend(
        options.boundary,
        options.tolerance,
        options.modes,
        beam=beam_of(options),
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
            "remarks": list(way.remarks),
        }
        for way in ways
    ]
    return {"recommendations": rows}, _advice_table(ways, options.integrator)


def _advice_table(ways: list[Recommendation], integrator: str) -> str:
    rows = []
    for way in ways:
        static = max(way.static_error.values(), key=abs, default=math.nan)
        rows.append(
            [
                way.rule,
                str(way.segments),
                percents(way.largest_error).lstrip("+"),
                percents(static),
                number(way.stable_time_step),
                f"{way.cost:.3g}",
            ]
        )
    heads = ["rule", "N", "error [%]", "static error [%]", "step [s]", "cost [-]"]
    return "\n".join(
        [
            text_table(heads, rows, names=1),
            "error: largest of the modes asked for, without its sign",
            "static: worst of tip force, tip moment and uniform load; nan where the beam can move rigidly",
            f"cost: segments times {integrator} steps in one period of the first mode",
        ]
    )
