"""The commands of the command line, in the order of a user's work, each one record beside its function.

A new command is one function under `@_command`: parser, help and the tests of every command follow from it.
Functions import what they need, so that a lookup starts fast.
"""

from __future__ import annotations

import argparse
import math
import shlex
from collections.abc import Callable, Mapping
from typing import Any

from beammodes.checks import choice, percent, positive_real
from beammodes.command_line.options import (
    AXIAL_FORCE,
    BEAM,
    BOUNDARY,
    DAMPING,
    DEFAULT_RULE,
    INTEGRATOR,
    JOINTS,
    LOAD,
    MODE,
    RULE,
    SECTION,
    SEGMENTS,
    TOLERANCE,
    UNITS,
    Answer,
    Command,
    Option,
    as_fraction,
    as_fractions,
    as_number,
    as_vector,
    damping_of,
    elsewhere,
    exported,
    modes,
    motions,
    option,
)
from beammodes.command_line.text_tables import (
    DECLARED,
    GIVEN,
    OWN,
    SHOWN_HINGES,
    declared,
    frequency_rows,
    frequency_table,
    hinge_table,
    more_hinges,
    number,
    percents,
    ratio_said,
    text_table,
    typed_in,
)

__all__ = ["COMMANDS"]

_Answering = Callable[[argparse.Namespace], Answer]

_BEFORE, _DURING, _AFTER = "before you build a chain", "while you build it", "when you have one"
_ABOUT = "to read on"
_EXAMPLE = "--length 1.2 --ei 85 --rho-a 0.62"
_EXAMPLE_SI = f"{_EXAMPLE} --units SI"
_ARC = '--gj 65 --shape "arc(angle=1.57)"'

_BEAM = (*BEAM, *SECTION, UNITS)
_CHAIN = (BOUNDARY, SEGMENTS, *_BEAM, RULE)

#: What is assumed of every frequency, step and spring that is found here.
_CASE = {
    "holds_for": "for small vibration about the straight Euler-Bernoulli beam, in vacuum and without gravity"
}

#: The one option of another motion that bending takes, too: hinges about both axes.
_ACROSS = ("export", "--ei-across")

_FOUND: list[Command] = []


def _command(
    stage: str,
    name: str,
    question: str,
    example: str,
    *options: Option,
    moving: tuple[str, ...] = (),
    in_space: tuple[Option, ...] = (),
    as_rod: str = _ARC,
) -> Callable[[_Answering], _Answering]:
    """Register a function as the answer of a command in bending.

    `moving` are the motions besides, whose answers stand in files of their own; `in_space` the options that
    this command has for rods in space only, `as_rod` what describes the rod of its example there.
    """

    def register(answer: _Answering) -> _Answering:
        whole, listed, call, rod = answer, options, f"beammodes {name} {example}".rstrip(), ""
        if "space" in moving:
            beam = "" if _EXAMPLE in example else f" {_EXAMPLE}"
            rod = f"{call}{beam} --motion space {as_rod}".replace("beam.xml", "rod.xml")
        if moving:
            foreign = [*elsewhere(moving), *((flag, "space") for flag, _ in in_space)]
            whole = _in_any_motion(
                name, answer, moving, [pair for pair in foreign if (name, pair[0]) != _ACROSS]
            )
            listed = (*options, *motions(*moving), *in_space)
        _FOUND.append(Command(stage, name, question, call, listed, whole, rod))
        return answer

    return register


def _in_any_motion(
    name: str, bending: _Answering, moving: tuple[str, ...], foreign: list[tuple[str, str]]
) -> _Answering:
    """Return the answer of a command that is for other motions too, whose flags bending does not take."""

    def answer(options: argparse.Namespace) -> Answer:
        chosen = choice("--motion", options.motion, ("bending", *moving))
        if chosen == "bending":
            for flag, where in foreign:
                if getattr(options, flag[2:].replace("-", "_")) is not None:
                    raise ValueError(f"{flag} must come with --motion {where}")
            return bending(options)
        if chosen == "space":
            from beammodes.command_line.rod_answers import ANSWERS_IN_SPACE
            from beammodes.command_line.rod_options import RodCase

            return ANSWERS_IN_SPACE[name](RodCase.of(options))
        from beammodes.command_line.axial_answers import ANSWERS, AxialCase

        return ANSWERS[name](AxialCase.of(options, _system(options), _units(options)))

    return answer


@_command(
    _BEFORE,
    "recommend",
    "which rule, how many segments and which step meet my tolerance?",
    "clamped-free --tolerance 1% --modes 3",
    BOUNDARY,
    TOLERANCE,
    modes(1, each=True),
    *_BEAM,
    AXIAL_FORCE,
    INTEGRATOR,
    option("--rule", "only these rules (default: all)", metavar="RULE,..."),
    moving=("twist", "stretch", "space"),
    as_rod=f"{_ARC} --rule gregory,mitiguy",
)
def _recommend(options: argparse.Namespace) -> Answer:
    from beammodes.command_line.advice_table import advised

    ways, answer, told, units = advised(
        options, _units(options), options.boundary, _beam(options), load=_load(options)
    )
    lines = [
        *told,
        _CASE["holds_for"],
        f"next: beammodes springs {_typed(options)} --segments {ways[0].segments} --rule {ways[0].rule}",
        *_units_note(options),
    ]
    return answer | _said_units(options, **units) | _CASE, "\n".join(lines)


@_command(
    _BEFORE,
    "segments",
    "how many segments does one rule need?",
    "clamped-clamped --tolerance 1% --modes 3 --rule gregory",
    BOUNDARY,
    TOLERANCE,
    modes(1, each=True),
    *_BEAM,
    AXIAL_FORCE,
    RULE,
    moving=("twist", "stretch", "space"),
)
def _segments(options: argparse.Namespace) -> Answer:
    from beammodes.accuracy.segments import segments_needed

    count = segments_needed(
        options.boundary,
        options.tolerance,
        options.modes,
        options.rule,
        load=_load(options),
        beam=_beam(options),
    )
    which = "the first mode" if options.modes == 1 else f"the first {options.modes} modes"
    said = f"rule {_rule(options)}, {which}, {_CASE['holds_for']}"
    return {"segments": count} | _CASE, f"{count}{_numbers_note(options)}\n{said}"


@_command(
    _BEFORE,
    "error",
    "how wrong is one frequency of a chain of N segments?",
    '"clamped-free(mass=0.5)" --segments 6 --mode 1',
    *_CHAIN,
    MODE,
    AXIAL_FORCE,
    moving=("twist", "stretch", "space"),
)
def _error(options: argparse.Namespace) -> Answer:
    from beammodes.accuracy.errors import frequency_error
    from beammodes.accuracy.remarks import error_remarks

    asked = {name: getattr(options, name) for name in ("boundary", "rule", "segments", "mode")}
    case = asked | {"load": _load(options), "beam": _beam(options)}
    error: float = frequency_error(**case)
    if math.isnan(error):
        raise ValueError(
            f"mode {options.mode} does not exist: {options.boundary} with {options.segments} segments "
            f"and rule {options.rule} has fewer elastic modes"
        )
    answer = {**asked, "relative_error": error, "units": {"relative_error": "1"}}
    if options.axial_force:
        answer["axial_force"] = options.axial_force
        answer["units"]["axial_force"] = _units(options)["force"]
    remarks = error_remarks(**case)
    if remarks:
        answer["remarks"] = list(remarks)
    lines = [f"{percent(error, 6)}{_numbers_note(options)}", *(f"  {remark}" for remark in remarks)]
    return answer | _CASE, "\n".join([*lines, f"rule {_rule(options)}, {_CASE['holds_for']}"])


@_command(
    _DURING,
    "springs",
    "which joint stiffnesses do I type into my multibody tool?",
    f"clamped-free --segments 4 {_EXAMPLE_SI}",
    *_CHAIN,
    moving=("twist", "stretch", "space"),
)
def _springs(options: argparse.Namespace) -> Answer:
    chain, units = _chain(options), _units(options)
    pairs = [*zip(chain.hinge_position.tolist(), chain.joint_stiffness.tolist(), strict=True)]
    answer: dict[str, Any] = {
        "hinges": [{"hinge": j, "position": x, "stiffness": k} for j, (x, k) in enumerate(pairs, start=1)]
    }
    answer |= _said_units(
        options,
        "translational_stiffness",
        position=units["length"],
        stiffness=units["joint_stiffness"],
        rotational_stiffness=units["joint_stiffness"],
    )
    lines = [hinge_table(pairs, units)]
    for side, support in zip(("left", "right"), chain.support_stiffness.tolist(), strict=True):
        for kind, stiffness in zip(("translational", "rotational"), support, strict=True):
            if 0 < stiffness < math.inf:
                answer[f"{side}_{kind}_support"] = stiffness
                unit = answer["units"][f"{kind}_stiffness"]
                lines.append(f"{kind} support of the {side} end: {typed_in(stiffness)} {unit}")
    ask = f"--segments {options.segments} --rule {options.rule}"
    compared, said = _rules_compared(options)
    answer |= compared
    lines += [
        *_units_note(options),
        *said,
        f"rule {_rule(options)}; how wrong it is: beammodes error {_typed(options)} {ask}",
        f"a better one: beammodes recommend {_typed(options)} --tolerance 1%",
    ]
    return answer, "\n".join(lines)


@_command(
    _DURING,
    "frequencies",
    "at which frequencies do the chain and the beam ring?",
    f"clamped-free --segments 6 --modes 3 {_EXAMPLE_SI}",
    *_CHAIN,
    modes(3),
    AXIAL_FORCE,
    moving=("twist", "stretch", "space"),
)
def _frequencies(options: argparse.Namespace) -> Answer:
    import numpy as np

    from beammodes.accuracy.errors import frequency_error
    from beammodes.exact.beam_theory import euler_bernoulli
    from beammodes.vibration.linear import linearize
    from beammodes.vibration.modes import solve_modes

    chain, load = _chain(options), _load(options)
    model = linearize(chain, load=load)
    found = solve_modes(model, options.modes)
    count = len(found.frequency)
    exact = euler_bernoulli(_beam(options), options.boundary, max(count, 1), load=load).frequency[:count]
    each = np.arange(1, count + 1)
    errors = found.frequency / exact - 1
    if count and chain.boundary.is_plain and not options.axial_force:
        # The closed form has digits that a difference of frequencies does not have.
        errors = np.asarray(
            frequency_error(options.boundary, segments=options.segments, mode=each, rule=options.rule)
        )
    rows = frequency_rows(found.frequency, exact, errors)
    kinds = f"{found.rigid_body_modes} rigid-body and {model.elastic_modes} elastic modes"
    title = f"{chain.boundary.name}, {options.segments} segments, {options.rule}: {kinds}"
    units = _units(options)
    # In multiples of the beam's own the books give ω, 3.516 of a cantilever, not the cycles.
    key = "angular_frequency" if units is OWN else "frequency"
    table = frequency_table(rows, key, units[key])
    answer = {"rigid_body_modes": found.rigid_body_modes, "modes": rows}
    said = _said_units(options, "frequency", "angular_frequency", relative_error="1")
    return answer | said, "\n".join([title, table, *_units_note(options)])


@_command(
    _DURING,
    "damping",
    "which dampers have the damping that I measured, and what do all modes get?",
    f"clamped-free --segments 10 {_EXAMPLE} --damping-ratio 0.8%,1.1%",
    *_CHAIN,
    DAMPING[0],
    option(
        "--peaks",
        "peaks of the first mode's decay, one period apart, in place of its ratio: 10,9.1,8.3,7.6",
        type=as_vector,
        metavar="A,...",
    ),
)
def _damping(options: argparse.Namespace) -> Answer:
    from beammodes.vibration.damping import damped_modes
    from beammodes.vibration.measured_damping import ratio_from_decay, rayleigh_damping

    if (options.damping_ratio is None) == (options.peaks is None):
        raise ValueError("--damping-ratio or --peaks must be given, one of them")
    chain, units, ratios = _chain(options), _units(options), options.damping_ratio
    answer: dict[str, Any] = {}
    lines: list[str] = []
    if options.peaks is not None:
        heights = options.peaks if isinstance(options.peaks, tuple) else (options.peaks,)
        found = ratio_from_decay([positive_real("--peaks", height) for height in heights])
        ratios, error = found.ratio, found.standard_error
        answer |= {"ratio": found.ratio, "fitted_ratio": found.fitted_ratio}
        answer["standard_error"] = error
        lines += [f"damping ratio {found}"]
    asked = {"damping_ratio": ratios, "stiffness_damping": 0.0}
    fits = {"joints": damping_of(argparse.Namespace(**asked), chain)}
    if isinstance(ratios, tuple):
        fits["rayleigh"] = both = rayleigh_damping(chain, ratios)
        answer |= {"mass": both.mass, "stiffness": both.stiffness}
        rate, time = units["angular_frequency"].replace("rad", "1"), units["time"]
        lines += [f"Rayleigh: mass {number(both.mass)} {rate}, stiffness {number(both.stiffness)} {time}"]
    tables = {name: damped_modes(chain, fit) for name, fit in fits.items()}
    first = tables["joints"]
    turns = 1.0 if units is OWN else 2 * math.pi
    answer["modes"] = [
        {"mode": n, "frequency": omega / turns}
        | {f"ratio_{name}": float(table.damping_ratio.values[n - 1]) for name, table in tables.items()}
        for n, omega in enumerate(first.undamped_angular_frequency.values.tolist(), start=1)
    ]
    answer |= {f"overdamped_{name}": table.overdamped_modes for name, table in tables.items()}
    dampers = fits["joints"].joint_damping(chain).tolist()
    places = [*zip(chain.hinge_position.tolist(), dampers, strict=True)]
    answer["hinges"] = [{"hinge": j, "position": x, "damping": d} for j, (x, d) in enumerate(places, start=1)]
    unit = _damper_unit(units)
    key = "angular_frequency" if units is OWN else "frequency"
    answer |= _said_units(options, frequency=units[key], damping=unit, position=units["length"])
    heads = ["mode", f"frequency [{units[key]}]", *(f"ratio, {name}" for name in tables)]
    rows = [
        [str(row["mode"]), number(row["frequency"]), *(ratio_said(row[f"ratio_{name}"]) for name in tables)]
        for row in answer["modes"][:SHOWN_HINGES]
    ]
    lines += [text_table(heads, rows)]
    if len(answer["modes"]) > len(rows):
        lines += [f"{len(answer['modes']) - len(rows)} more modes: see --json"]
    rows = [[str(j), number(x), typed_in(d)] for j, (x, d) in enumerate(places[:SHOWN_HINGES], start=1)]
    lines += ["", text_table(["hinge", f"position [{units['length']}]", f"damper [{unit}]"], rows)]
    lines += [*more_hinges(len(places) - len(rows)), *_units_note(options)]
    return answer, "\n".join(lines)


def _damper_unit(units: Mapping[str, Any]) -> str:
    """Return the unit of a rotational damper: a stiffness times a time."""
    stiffness, time = units["joint_stiffness"], units["time"]
    return stiffness.replace("/rad", f" {time}/rad") if stiffness.endswith("/rad") else f"{stiffness} {time}"


@_command(
    _DURING,
    "time-step",
    "which fixed time step is stable?",
    f"clamped-free --segments 10 {_EXAMPLE_SI}",
    *_CHAIN,
    *LOAD,
    *DAMPING,
    INTEGRATOR,
    moving=("twist", "stretch", "space"),
)
def _time_step(options: argparse.Namespace) -> Answer:
    from beammodes.problem.loading import Load
    from beammodes.vibration.damping import modes_with_ratios
    from beammodes.vibration.integrators import accurate_step, fixed_step_integrator
    from beammodes.vibration.linear import linearize
    from beammodes.vibration.stability import (
        GRAVITY,
        highest_angular_frequency,
        stable_time_step,
        taut_load,
    )

    chain, load = _chain(options), _load(options)
    damping = damping_of(options, chain)
    record = fixed_step_integrator(options.integrator)
    step = stable_time_step(chain, record.name, load=load, damping=damping)
    taut = taut_load(chain, load)
    highest = highest_angular_frequency(chain, load=taut)
    first = modes_with_ratios(chain, damping, linearize(chain, load=taut), 1)
    if not first:
        raise ValueError(
            f"segments must be larger: {chain.boundary.name} with {options.segments} has no elastic mode "
            "and so no stability limit"
        )
    units = _units(options)
    time = units["time"]
    kept = accurate_step(record.name, *first[0])
    answer: dict[str, Any] = {
        "time_step": step,
        "accurate_time_step": kept,
        "highest_angular_frequency": highest,
    }
    answer |= _said_units(
        options,
        time_step=time,
        accurate_time_step=time,
        highest_angular_frequency=units["angular_frequency"],
        time_step_under_gravity=time,
    )
    case = "without load" if load == Load() else f"under {load}"
    if record.springs == "implicit":
        text = f"any step is stable  ({options.integrator}, {case})"
        if math.isfinite(kept):
            text += f"\n{number(kept)} {time}  keeps the first mode: "
            text += "frequency within 0.1 %, amplitude within 1 % over 100 periods"
        return answer, "\n".join([text, *_units_note(options)])
    fastest = f"highest angular frequency {number(highest)} {units['angular_frequency']}"
    if damping is not None:
        free = stable_time_step(chain, record.name, load=load)
        case += f", with dampers; without them {number(free)} {time}"
    text = f"{number(step)} {time}  ({options.integrator}, {fastest}, {case})"
    # In a beam's own units there is no such number as 9.81.
    if load == Load() and units is not OWN:
        gravity = GRAVITY / units["metres"]
        hung = stable_time_step(chain, record.name, load=Load(gravity=gravity), damping=damping)
        answer["time_step_under_gravity"] = hung
        if hung < 0.99 * step:
            weight = f"gravity {gravity:.4g} {units['acceleration']}"
            text += f"\n{number(hung)} {time}  with {weight} in any direction, hanging too: --gravity"
    return answer, "\n".join([text, *_units_note(options)])


@_command(
    _DURING,
    "response",
    "how do beam and chain answer to a harmonic force?",
    f"clamped-free --segments 9 --frequency 4 --damping-ratio 1% {_EXAMPLE}",
    *_CHAIN,
    option(
        "--frequency", "of the force, one or several: 2,4.5,28.5", type=as_vector, required=True, metavar="f"
    ),
    option("--force-at", "where the force acts (default: the right end)", type=as_number, metavar="X"),
    option(
        "--deflection-at", "where the deflection is read (default: at the force)", type=as_number, metavar="X"
    ),
    option(
        "--damping-ratio",
        "of modes: 0.01 or 1%% of critical; of several modes 0.8%%,1.1%%, the last one of all above",
        type=as_fractions,
        required=True,
        metavar="z",
    ),
    AXIAL_FORCE,
)
def _response(options: argparse.Namespace) -> Answer:
    from beammodes.accuracy.responses import frequency_response

    chain, units = _chain(options), _units(options)
    force = chain.beam.length if options.force_at is None else options.force_at
    read = force if options.deflection_at is None else options.deflection_at
    case = {"frequency": options.frequency, "force_at": force, "deflection_at": read}
    case |= {"damping_ratio": options.damping_ratio, "load": _load(options)}
    both = [
        frequency_response(*system, **case).receptance.values.ravel().tolist()
        for system in ((chain,), (chain.beam, chain.boundary))
    ]
    frequencies = options.frequency if isinstance(options.frequency, tuple) else (options.frequency,)
    rows = [
        {
            "frequency": f,
            "receptance": abs(found),
            "phase": math.degrees(math.atan2(found.imag, found.real)),
            "exact_receptance": abs(exact),
            "exact_phase": math.degrees(math.atan2(exact.imag, exact.real)),
            "relative_error": abs(found) / abs(exact) - 1 if exact else math.nan,
        }
        for f, found, exact in zip(frequencies, *both, strict=True)
    ]
    force_unit = units["force"] if units["force"].isalpha() else f"({units['force']})"
    unit = f"{units['length']}/{force_unit}"
    answer = {"force_at": force, "deflection_at": read, "responses": rows}
    answer |= _said_units(
        options, "frequency", "length", receptance=unit, exact_receptance=unit, phase="°", exact_phase="°"
    )
    heads = [
        f"frequency [{units['frequency']}]",
        f"chain [{unit}]",
        "phase [°]",
        f"exact [{unit}]",
        "phase [°]",
    ]
    shown = [
        [number(value) for value in list(row.values())[:-1]] + [percents(row["relative_error"])]
        for row in rows
    ]
    lines = [
        text_table([*heads, "error [%]"], shown),
        f"deflection at {number(read)} over the force at {number(force)}, rule {_rule(options)}, "
        f"{_CASE['holds_for']}",
        *_units_note(options),
    ]
    return answer | _CASE, "\n".join(lines)


@_command(
    _DURING,
    "buckling",
    "under which compression do the chain and the beam buckle?",
    f"clamped-free --segments 10 {_EXAMPLE_SI}",
    *_CHAIN,
    moving=("space",),
    in_space=(
        option(
            "--tip-force",
            "space: x,y,z of a dead force at s = L, in the axes at s = 0; a multiple of it buckles the rod",
            type=as_vector,
            metavar="F",
        ),
        JOINTS,
    ),
    as_rod="--ei-across 2 --gj 4 --tip-force=0,-1,0",
)
def _buckling(options: argparse.Namespace) -> Answer:
    from beammodes.accuracy.buckling import buckling_load

    chain = _chain(options)
    load, exact = buckling_load(chain), buckling_load(_beam(options), options.boundary)
    if math.isinf(load):
        raise ValueError(
            f"segments must be larger: {chain.boundary.name} with {options.segments} cannot bend"
        )
    answer = {"buckling_load": load, "exact_buckling_load": exact, "relative_error": load / exact - 1}
    unit, error = _units(options)["force"], percents(answer["relative_error"])
    said = _said_units(options, buckling_load=unit, exact_buckling_load=unit, relative_error="1")
    text = f"{number(load)} {unit}  (beam {number(exact)} {unit}, error {error} %)"
    return answer | said, "\n".join([text, *_units_note(options)])


def _formats() -> dict[str, list[str]]:
    """Return the names of the formats by their suffixes."""
    from beammodes.exporters.formats import FORMATS

    found: dict[str, list[str]] = {}
    for name, kind in FORMATS.items():
        found.setdefault(kind.suffix, []).append(name)
    return found


def _format_names() -> str:
    return ", ".join(name for names in _formats().values() for name in names)


def _mujoco() -> str:
    from beammodes.exporters.export import MUJOCO_INTEGRATORS

    return ", ".join(MUJOCO_INTEGRATORS)


@_command(
    _DURING,
    "export",
    "can I have the chain as a file for MuJoCo, Gazebo, Drake, PyBullet or Exudyn?",
    f"clamped-free --segments 10 --rule gregory {_EXAMPLE} --output beam.xml",
    *_CHAIN,
    option(
        "--output",
        lambda: ", ".join(f"{suffix} ({' or '.join(names)})" for suffix, names in _formats().items()),
        required=True,
        metavar="FILE",
    ),
    option("--format", lambda: f"{_format_names()} (default: by the file's ending)"),
    option("--name", "prefix of all names in the file (default: chain)", default="chain"),
    option("--fragment", "bodies only, to include in a model (MJCF, SDF)", action="store_true"),
    option(
        "--timestep",
        "time step [s] (default: half the stable one, under the loads given, or without gravity and with "
        "9.81 m/s² in any direction; less where the first frequency would shift by over 0.1 %%)",
        type=as_number,
        metavar="h",
    ),
    option("--integrator", lambda: f"MuJoCo's: {_mujoco()} (default: RK4)", default="RK4"),
    *LOAD,
    *DAMPING,
    option("--force", "overwrite existing files", action="store_true"),
    moving=("space",),
    in_space=(JOINTS,),
)
def _export(options: argparse.Namespace) -> Answer:
    from beammodes.problem.loading import Load

    _beam(options)
    if options.length is options.ei is options.rho_a is None:
        raise ValueError(
            "--length, --ei and --rho-a must be given, or --length, --section and --material: a model file "
            "has units"
        )
    chain, load = _chain(options), _load(options)
    second = None
    if options.ei_across is not None:
        stiffness = positive_real("--ei-across", options.ei_across)
        second = _chain(argparse.Namespace(**vars(options) | {"ei": stiffness}))
    given = None if load == Load() and options.gravity is None else load
    names = exported(options, chain, given, _system(options), second=second)
    return {"files": names}, "\n".join(names)


@_command(
    _AFTER,
    "audit",
    "how wrong is the chain in my model file, and what mends it?",
    f"beam.xml {_EXAMPLE_SI} --tolerance 1%",
    option("file", "MJCF, URDF, SDFormat, or CSV as export writes it", metavar="FILE"),
    *BEAM,
    *SECTION,
    option(
        "--boundary",
        f"the beam's ends (default: the file's): {BOUNDARY[1]['help']}",
        metavar="ENDS",
    ),
    UNITS,
    option(
        "--tolerance",
        "largest error that meets, 1%% or 0.01 (default: 1%%)",
        type=as_fraction,
        default=0.01,
        metavar="e",
    ),
    modes(3),
    option("--chain", "a body of the chain to judge (default: the longest)", metavar="NAME"),
    option(
        "--plane",
        "x, y or z, along which it deflects (default: by the springs); in space, along which --ei lets it",
    ),
    option("--springs", "springs of a URDF file (default: .springs.yaml beside it)", metavar="FILE"),
    option("--write", "write the file (of URDF: its springs) with better springs", metavar="FILE"),
    option(
        "--suggestion",
        "whose springs to write (default: the first for the same hinges that meets, or the first)",
        metavar="NAME",
    ),
    option("--force", "overwrite an existing file", action="store_true"),
    moving=("twist", "stretch", "space"),
)
def _audit(options: argparse.Namespace) -> Answer:
    from beammodes.command_line.audit_answers import audited_in_bending

    beam = _beam(options)
    if options.length is None:
        raise ValueError("--length, --ei and --rho-a must be given, or --length, --section and --material")
    return audited_in_bending(options, beam, _system(options), _units(options))


@_command(_ABOUT, "rules", "which rules are there, and what are their springs?", "")
def _rules(_options: argparse.Namespace) -> Answer:
    from beammodes.command_line.guides import listed_rules

    return listed_rules()


@_command(
    _ABOUT,
    "guide",
    "what do the pages say, such as those on MuJoCo, units and damping?",
    "mujoco",
    option("page", "one of the pages (default: a list of them)", nargs="?", metavar="PAGE"),
)
def _guide(options: argparse.Namespace) -> Answer:
    from beammodes.command_line.guides import guide

    return guide(options.page)


@_command(
    _ABOUT,
    "completion",
    "how does my shell complete commands and options?",
    "bash",
    option("shell", "bash or zsh, which reads the script that is printed", metavar="SHELL"),
)
def _completion(options: argparse.Namespace) -> Answer:
    from beammodes.command_line.guides import completion

    return completion(options.shell, COMMANDS)


# What the options of several commands describe.


def _beam(options: argparse.Namespace) -> Any:
    """Return the beam; without any of its numbers, `Beam.unit()`."""
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


def _chain(options: argparse.Namespace) -> Any:
    from beammodes.chains.chain import Chain

    return Chain(_beam(options), options.boundary, segments=options.segments, rule=options.rule)


def _load(options: argparse.Namespace) -> Any:
    from beammodes.problem.loading import Load

    given = {name: getattr(options, name, None) for name in ("axial_force", "gravity", "tip_force")}
    for name in ("gravity", "tip_force"):
        if options.length is None and given[name] is not None:
            raise ValueError(
                f"{name} must come with --length, --ei and --rho-a: it is no multiple of the beam's own units"
            )
    return Load(**{name: value for name, value in given.items() if value is not None})


def _system(options: argparse.Namespace) -> str:
    """Return the name of the units that the user's numbers are in."""
    if options.units is not None:
        if options.length is None:
            raise ValueError("--units must come with --length, --ei and --rho-a, whose units they are")
        return declared(options.units)
    return "as given" if options.length is not None else "multiples of the beam's own"


def _units(options: argparse.Namespace) -> Mapping[str, Any]:
    """Return the names of the answer's units."""
    if options.units is not None:
        return DECLARED[_system(options)]
    return GIVEN if options.length is not None else OWN


def _said_units(options: argparse.Namespace, *names: str, **others: str) -> dict[str, Any]:
    units = _units(options)
    return {"units": {"system": _system(options)} | {name: units[name] for name in names} | others}


def _units_note(options: argparse.Namespace) -> list[str]:
    units = _units(options)
    if units is GIVEN:
        return [f"in the units of your input; --units {', '.join(DECLARED)} names them"]
    if units is OWN:
        return ["in multiples of the beam's own, since --length, --ei and --rho-a are not given"]
    return []


def _numbers_note(options: argparse.Namespace) -> str:
    """Return a note on the units of numbers of ends and of the axial force that are given without a beam."""
    from beammodes.problem.ends import Boundary

    numbered = not Boundary.of(options.boundary).is_plain or bool(getattr(options, "axial_force", None))
    if not numbered or options.length is not None:
        return ""
    return (
        "\nnumbers of ends and force are taken as multiples of ρA L, ρA L³, L, EI/L³, EI/L and EI/L²: give "
        "--length, --ei and --rho-a if they are not"
    )


def _rules_compared(options: argparse.Namespace) -> tuple[dict[str, Any], list[str]]:
    """Return the first mode's error with the rule that was typed, and with the one whose error is least."""
    from beammodes.accuracy.errors import frequency_error
    from beammodes.chains.rules import RULES

    errors: dict[str, float] = {}
    for name in dict.fromkeys((options.rule, *RULES)):
        case = {"segments": options.segments, "mode": 1, "rule": name, "beam": _beam(options)}
        try:
            found: float = frequency_error(options.boundary, **case)
        except ValueError:
            # A rule that takes no such N, or a hub that it does not know.
            continue
        if math.isfinite(found):
            errors[name] = found
    if options.rule not in errors:
        return {}, []
    own = errors[options.rule]
    # Between pinned ends several are the same but for rounding.
    best = min(errors, key=lambda name: abs(errors[name]))
    if abs(errors[best]) > (1 - 1e-9) * abs(own):
        best = options.rule
    said = "the default, as in Mitiguy's report" if options.rule == DEFAULT_RULE else options.rule
    rest = "no rule has less" if best == options.rule else f"{percent(errors[best])} with --rule {best}"
    text = f"first mode: {percent(own)} with {said}; {rest}"
    return {"first_mode_error": own, "best_rule": best, "best_first_mode_error": errors[best]}, [text]


def _rule(options: argparse.Namespace) -> str:
    return f"{options.rule}{' (the default)' if options.rule == DEFAULT_RULE else ''}"


def _typed(options: argparse.Namespace) -> str:
    """Return the ends and the beam as the user may type them again."""
    words = [options.boundary]
    if options.length is not None:
        words += ["--length", f"{options.length:.12g}", "--ei", f"{options.ei:.12g}"]
        words += ["--rho-a", f"{options.rho_a:.12g}", *(["--units", options.units] if options.units else [])]
    return shlex.join(words)


COMMANDS: tuple[Command, ...] = tuple(_FOUND)
