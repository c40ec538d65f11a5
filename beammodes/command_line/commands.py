"""What each command of the command line answers: data for scripts, and the same as text for people."""

from __future__ import annotations

import argparse
import math
import shlex
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from beammodes.checks import choice, percent, positive_real, shown
from beammodes.command_line.text_tables import (
    DECLARED,
    GIVEN,
    OWN,
    UNITS,
    frequency_table,
    number,
    percents,
    text_table,
    typed_in,
)

if TYPE_CHECKING:
    from beammodes.accuracy.advice import Recommendation

__all__ = [
    "DEFAULT_RULE",
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
    "system_of",
    "units_of",
]

DEFAULT_RULE = "mitiguy"

#: What a command found: the answer for scripts, and the same as text for people.
Answer = tuple[dict[str, Any], str]


def answer_error(options: argparse.Namespace) -> Answer:
    """Answer the relative frequency error of one mode of a uniform chain."""
    from beammodes.accuracy.errors import frequency_error
    from beammodes.accuracy.remarks import error_remarks

    error: float = frequency_error(
        options.boundary,
        segments=options.segments,
        mode=options.mode,
        rule=options.rule,
        load=load_of(options),
        beam=beam_of(options),
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
    answer["units"] = {"relative_error": "1"}
    if options.axial_force:
        answer["axial_force"] = options.axial_force
        answer["units"]["axial_force"] = units_of(options)["force"]
    remarks = error_remarks(
        options.boundary,
        segments=options.segments,
        mode=options.mode,
        rule=options.rule,
        load=load_of(options),
        beam=beam_of(options),
    )
    if remarks:
        answer["remarks"] = list(remarks)
    said = [f"{percent(error, 6)}{_numbers_note(options)}", *(f"  {remark}" for remark in remarks)]
    return answer | _CASE, "\n".join([*said, f"rule {_rule_said(options)}, {_CASE['holds_for']}"])


#: What is assumed of every frequency, step and spring that is found here.
_CASE = {
    "holds_for": "for small vibration about the straight Euler-Bernoulli beam, in vacuum and without gravity"
}


def _numbers_note(options: argparse.Namespace) -> str:
    """Say in what the numbers of ends and axial force count, if there are any without a beam."""
    from beammodes.problem.ends import Boundary

    numbered = not Boundary.of(options.boundary).is_plain or bool(getattr(options, "axial_force", None))
    if not numbered or options.length is not None:
        return ""
    return (
        "\nnumbers of ends and force are taken as multiples of ρA L, ρA L³, L, EI/L³, EI/L and EI/L²: give "
        "--length, --ei and --rho-a if they are not"
    )


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
    turn = 2 * math.pi
    rows = [
        {
            "mode": int(n),
            "frequency": float(f),
            "exact_frequency": float(g),
            "angular_frequency": float(f) * turn,
            "exact_angular_frequency": float(g) * turn,
            "relative_error": float(e),
        }
        for n, f, g, e in zip(each, modes.frequency, exact, errors, strict=True)
    ]
    kinds = f"{modes.rigid_body_modes} rigid-body and {model.elastic_modes} elastic modes"
    title = f"{chain.boundary.name}, {options.segments} segments, {options.rule}: {kinds}"
    units = units_of(options)
    # In multiples of the beam's own the books give ω, 3.516 of a cantilever, not the cycles.
    key = "angular_frequency" if units is OWN else "frequency"
    table = frequency_table(rows, key, units[key])
    answer = {"rigid_body_modes": modes.rigid_body_modes, "modes": rows}
    said = _said_units(options, "frequency", "angular_frequency", relative_error="1")
    return answer | said, "\n".join([title, table, *_units_note(options)])


def answer_springs(options: argparse.Namespace) -> Answer:
    """Answer the joint stiffnesses to type into a multibody tool."""
    chain = chain_of(options)
    rows = [
        {"hinge": j + 1, "position": float(x), "stiffness": float(k)}
        for j, (x, k) in enumerate(zip(chain.hinge_position, chain.joint_stiffness, strict=True))
    ]
    units = units_of(options)
    lines = [
        text_table(
            ["hinge", f"position [{units['length']}]", f"stiffness [{units['joint_stiffness']}]"],
            [[str(row["hinge"]), number(row["position"]), typed_in(row["stiffness"])] for row in rows],
        )
    ]
    answer: dict[str, Any] = {"hinges": rows}
    answer |= _said_units(
        options,
        "translational_stiffness",
        position=units["length"],
        stiffness=units["joint_stiffness"],
        rotational_stiffness=units["joint_stiffness"],
    )
    for side, (translation, rotation) in zip(("left", "right"), chain.support_stiffness, strict=True):
        for kind, stiffness, unit in (
            ("translational", translation, units["translational_stiffness"]),
            ("rotational", rotation, units["joint_stiffness"]),
        ):
            if 0 < stiffness < math.inf:
                answer[f"{side}_{kind}_support"] = float(stiffness)
                lines.append(f"{kind} support of the {side} end: {typed_in(stiffness)} {unit}")
    return answer, "\n".join([*lines, *_units_note(options), *_next_of_springs(options)])


def _next_of_springs(options: argparse.Namespace) -> list[str]:
    """Return what a user of these springs should ask next."""
    ask = f"--segments {options.segments} --rule {options.rule}"
    return [
        f"rule {_rule_said(options)}; how wrong it is: beammodes error {_typed(options)} {ask}",
        f"a better one: beammodes recommend {_typed(options)} --tolerance 1%",
    ]


def _typed(options: argparse.Namespace) -> str:
    """Return the ends and the beam as the user may type them again."""
    words = [options.boundary]
    if options.length is not None:
        words += ["--length", f"{options.length:.12g}", "--ei", f"{options.ei:.12g}"]
        words += ["--rho-a", f"{options.rho_a:.12g}", *(["--units", options.units] if options.units else [])]
    return shlex.join(words)


def answer_buckling(options: argparse.Namespace) -> Answer:
    """Answer the compression at which a chain buckles, beside the beam's."""
    from beammodes.accuracy.buckling import buckling_load

    chain = chain_of(options)
    load, exact = buckling_load(chain), buckling_load(beam_of(options), options.boundary)
    if math.isinf(load):
        raise ValueError(
            f"segments must be larger: {chain.boundary.name} with {options.segments} cannot bend"
        )
    answer = {"buckling_load": load, "exact_buckling_load": exact, "relative_error": load / exact - 1}
    unit, error = units_of(options)["force"], percents(answer["relative_error"])
    said = _said_units(options, buckling_load=unit, exact_buckling_load=unit, relative_error="1")
    text = f"{number(load)} {unit}  (beam {number(exact)} {unit}, error {error} %)"
    return answer | said, "\n".join([text, *_units_note(options)])


def answer_segments(options: argparse.Namespace) -> Answer:
    """Answer how many segments a tolerance needs."""
    from beammodes.accuracy.errors import segments_needed

    count = segments_needed(
        options.boundary,
        options.tolerance,
        options.modes,
        options.rule,
        load=load_of(options),
        beam=beam_of(options),
    )
    modes = "the first mode" if options.modes == 1 else f"the first {options.modes} modes"
    said = f"rule {_rule_said(options)}, {modes}, {_CASE['holds_for']}"
    return {"segments": count} | _CASE, f"{count}{_numbers_note(options)}\n{said}"


def _rule_said(options: argparse.Namespace) -> str:
    return f"{options.rule}{' (the default)' if options.rule == DEFAULT_RULE else ''}"


def answer_time_step(options: argparse.Namespace) -> Answer:
    """Answer the largest stable fixed time step of a chain, and the case that it holds for."""
    from beammodes.problem.loading import Load
    from beammodes.vibration.integrators import fixed_step_integrator
    from beammodes.vibration.stability import highest_angular_frequency, stable_time_step, taut_load

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
    units = units_of(options)
    time = units["time"]
    answer = {"time_step": step, "highest_angular_frequency": highest}
    answer |= _said_units(
        options,
        time_step=time,
        highest_angular_frequency=units["angular_frequency"],
        time_step_under_gravity=time,
    )
    fastest = f"highest angular frequency {number(highest)} {units['angular_frequency']}"
    case = "without load" if load == Load() else f"under {load}"
    if damping is not None:
        free = stable_time_step(chain, record.name, load=load)
        case += f", with dampers; without them {number(free)} {time}"
    text = f"{number(step)} {time}  ({options.integrator}, {fastest}, {case})"
    # In a beam's own units there is no such number as 9.81.
    if load == Load() and units["gravity"] is not None:
        weight, gravity = units["gravity"]
        hung = stable_time_step(chain, record.name, load=Load(gravity=gravity), damping=damping)
        answer["time_step_under_gravity"] = hung
        if hung < 0.99 * step:
            text += f"\n{number(hung)} {time}  with gravity {weight} in any direction, hanging too: --gravity"
    return answer, "\n".join([text, *_units_note(options)])


def beam_of(options: argparse.Namespace) -> Any:
    """Return the beam that the options describe; without any of its numbers, `Beam.unit()`."""
    from beammodes.problem.beam import Beam

    numbers = {"--length": options.length, "--ei": options.ei, "--rho-a": options.rho_a}
    missing = [flag for flag, value in numbers.items() if value is None]
    _system(options)
    if len(missing) == 3:
        return Beam.unit()
    if missing:
        given = [flag for flag in numbers if flag not in missing]
        raise ValueError(
            f"{' and '.join(missing)} must be given with {' and '.join(given)}, or none of the three for an "
            "answer in multiples of the beam's own units"
        )
    return Beam(length=options.length, bending_stiffness=options.ei, mass_per_length=options.rho_a)


def units_of(options: argparse.Namespace) -> Mapping[str, Any]:
    """Return what the answer's units are called: as declared, by their kind, or as multiples."""
    return UNITS[_system(options)]


def system_of(options: argparse.Namespace) -> str | None:
    """Return the system of units that the user declared, or None."""
    return _system(options) if options.units is not None else None


def _system(options: argparse.Namespace) -> str:
    if options.units is not None:
        words = {name.lower(): name for name in DECLARED}
        name = words.get(options.units.lower())
        if options.length is None:
            raise ValueError("--units must come with --length, --ei and --rho-a, whose units they are")
        return name or choice("--units", options.units, DECLARED)
    return "as given" if options.length is not None else "multiples of the beam's own"


def _said_units(options: argparse.Namespace, *names: str, **others: str) -> dict[str, Any]:
    units = units_of(options)
    return {"units": {"system": _system(options)} | {name: units[name] for name in names} | others}


def _units_note(options: argparse.Namespace) -> list[str]:
    system = units_of(options)
    if system is GIVEN:
        return [f"in the units of your input; --units {', '.join(DECLARED)} names them"]
    if system is OWN:
        return ["in multiples of the beam's own, since --length, --ei and --rho-a are not given"]
    return []


def load_of(options: argparse.Namespace) -> Any:
    """Return the load that the options describe."""
    from beammodes.problem.loading import Load

    names = ("axial_force", "gravity", "tip_force")
    given = {name: getattr(options, name, None) for name in names}
    if options.length is None:
        for name in ("gravity", "tip_force"):
            if given[name] is not None:
                raise ValueError(
                    f"{name} must come with --length, --ei and --rho-a: it is no multiple "
                    "of the beam's own units"
                )
    return Load(**{name: value for name, value in given.items() if value is not None})


def damping_of(options: argparse.Namespace, chain: Any) -> Any:
    """Return the damping that the options describe, or None."""
    from beammodes.vibration.damping import Damping

    if options.damping_ratio is not None:
        from beammodes.vibration.damping import joint_dampers

        if options.stiffness_damping:
            raise ValueError("--damping-ratio must be given without --stiffness-damping, which it sets")
        return joint_dampers(chain, _within("--damping-ratio", options.damping_ratio))
    if not options.stiffness_damping:
        return None
    return Damping(stiffness=_within("--stiffness-damping", options.stiffness_damping))


def _within(flag: str, value: Any) -> float:
    """Return a positive number that is no slip: beyond these, squares leave the range of floats."""
    number = positive_real(flag, value)
    if not 1e-100 <= number <= 1e100:
        raise ValueError(f"{flag} must be from 1e-100 to 1e100, got {shown(value)}")
    return number


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
            "highest_angular_frequency": way.highest_angular_frequency,
            "stable_time_step": way.stable_time_step,
            "cost": way.cost,
            "joint_stiffness": way.joint_stiffness.tolist(),
            "remarks": list(way.remarks),
        }
        for way in ways
    ]
    units = units_of(options)
    said = _said_units(
        options,
        "joint_stiffness",
        highest_angular_frequency=units["angular_frequency"],
        stable_time_step=units["time"],
    )
    best = f"{_typed(options)} --segments {ways[0].segments} --rule {ways[0].rule}"
    lines = [
        _advice_table(ways, options.integrator, units["time"]),
        _CASE["holds_for"],
        f"next: beammodes springs {best}",
        *_units_note(options),
    ]
    return {"recommendations": rows} | said | _CASE, "\n".join(lines)


def _advice_table(ways: list[Recommendation], integrator: str, time: str) -> str:
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
    heads = ["rule", "N", "error [%]", "static error [%]", f"step [{time}]", "cost [-]"]
    return "\n".join(
        [
            text_table(heads, rows, names=1),
            "error: largest of the modes asked for, without its sign",
            "static: worst of tip force, tip moment and uniform load; nan where the beam can move rigidly",
            f"cost: segments times {integrator} steps in one period of the first mode",
        ]
    )
