"""The command line:  beammodes error | frequencies | springs | segments | recommend | time-step."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Callable, Sequence
from typing import Any, NoReturn

from beammodes import __version__

__all__ = ["main"]

#: What a command found: the answer for scripts, and the same as text for people.
Answer = tuple[dict[str, Any], str]

_BEAM = (
    ("length", "L, length of the beam [m]"),
    ("ei", "EI, bending stiffness [N m²]"),
    ("rho_a", "ρA, mass per length [kg/m]"),
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code: 0, or 2 for bad usage or a mode that does not exist."""
    options = _parser().parse_args(arguments)
    command: Callable[[argparse.Namespace], Answer] = options.command
    try:
        answer, text = command(options)
        output = json.dumps(answer, allow_nan=False) if options.json else text
    except (TypeError, ValueError) as error:
        sys.stderr.write(f"beammodes: {_in_flags(str(error))}\n")
        return 2
    try:
        print(output, flush=True)
    except BrokenPipeError:
        # The reader, such as `head`, has seen enough; Python would complain again when it closes stdout.
        sys.stdout = None
    return 0


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message} (see {self.prog} --help)\n")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="beammodes",
        description="Chains of rigid segments and rotational springs that stand for flexible beams.",
        epilog="examples:\n"
        "  beammodes error clamped-free --segments 6 --mode 1\n"
        "  beammodes springs clamped-free --segments 4 --length 1.2 --ei 85 --rho-a 0.62\n"
        "  beammodes frequencies clamped-free --segments 6 --modes 3\n"
        "  beammodes segments clamped-clamped --tolerance 0.01 --modes 3\n"
        "  beammodes recommend clamped-free --tolerance 0.01 --modes 3\n"
        "  beammodes time-step clamped-free --segments 10 --length 1.2 --ei 85 --rho-a 0.62",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"beammodes {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for name, function, summary, build in _COMMANDS:
        sub = commands.add_parser(name, help=summary, description=summary.capitalize() + ".")
        sub.add_argument("boundary", help="two ends of clamped, pinned, guided, free, such as clamped-free")
        build(sub)
        if function is _recommend:
            sub.add_argument("--rule", metavar="RULE,...", help="only these rules (default: all)")
        else:
            sub.add_argument("--rule", default="mitiguy", help="discretization rule (default: mitiguy)")
        sub.add_argument("--json", action="store_true", help="print one JSON object")
        sub.set_defaults(command=function)
    return parser


def _beam_options(sub: argparse.ArgumentParser) -> None:
    for name, text in _BEAM:
        flag = "--" + name.replace("_", "-")
        sub.add_argument(flag, type=_number, default=1.0, metavar="X", help=f"{text} (default: 1)")


def _segments_option(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--segments", type=_integer, required=True, metavar="N", help="number of rigid segments")


def _error_options(sub: argparse.ArgumentParser) -> None:
    _segments_option(sub)
    sub.add_argument("--mode", type=_integer, default=1, metavar="n", help="elastic mode (default: 1)")


def _frequency_options(sub: argparse.ArgumentParser) -> None:
    _segments_option(sub)
    sub.add_argument("--modes", type=_integer, default=3, metavar="n", help="how many modes (default: 3)")
    _beam_options(sub)


def _spring_options(sub: argparse.ArgumentParser) -> None:
    _segments_option(sub)
    _beam_options(sub)


def _tolerance_options(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--tolerance", type=_number, required=True, metavar="e", help="0.01 is one percent")
    sub.add_argument("--modes", type=_integer, default=1, metavar="n", help="how many modes (default: 1)")


def _step_options(sub: argparse.ArgumentParser) -> None:
    _spring_options(sub)
    _integrator_option(sub)


def _advice_options(sub: argparse.ArgumentParser) -> None:
    _tolerance_options(sub)
    _beam_options(sub)
    _integrator_option(sub)


def _integrator_option(sub: argparse.ArgumentParser) -> None:
    text = "rk4, leapfrog or semi_implicit_euler (default: rk4)"
    sub.add_argument("--integrator", default="rk4", help=text)


def _integer(text: str) -> int | str:
    # What is no integer is passed on, so that the library's own message names the argument. Python itself
    # refuses to read integers of more than 4300 digits.
    try:
        return int(text)
    except ValueError:
        return text


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def _error(options: argparse.Namespace) -> Answer:
    from beammodes.errors import frequency_error

    error: float = frequency_error(
        options.boundary, segments=options.segments, mode=options.mode, rule=options.rule
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
    note = (
        "  (coarse: a mode this near the chain's last is wrong under every rule)" if abs(error) > 0.1 else ""
    )
    return answer, f"{100 * error:+.6g} %{note}"


def _frequencies(options: argparse.Namespace) -> Answer:
    import numpy as np

    from beammodes.errors import frequency_error
    from beammodes.exact_beam import euler_bernoulli
    from beammodes.linear import linearize
    from beammodes.modes import solve_modes

    chain = _chain(options)
    modes = solve_modes(linearize(chain), options.modes)
    count = len(modes.frequency)
    exact = euler_bernoulli(_beam(options), options.boundary, max(count, 1)).frequency[:count]
    each = np.arange(1, count + 1)
    errors = np.zeros(0)
    if count:
        errors = np.asarray(
            frequency_error(options.boundary, segments=options.segments, mode=each, rule=options.rule)
        )
    rows = [
        {
            "mode": int(n),
            "frequency_hz": float(f),
            "exact_frequency_hz": float(g),
            "relative_error": float(e),
        }
        for n, f, g, e in zip(each, modes.frequency, exact, errors, strict=True)
    ]
    head = f"{chain.boundary.name}, {options.segments} segments, {options.rule}: "
    lines = [
        f"{row['mode']:4d}  {row['frequency_hz']:14.6g}  {row['exact_frequency_hz']:14.6g}  "
        f"{100 * row['relative_error']:+10.4g}"
        for row in rows
    ]
    title = f"{head}{modes.rigid_body_modes} rigid-body and {chain.elastic_modes} elastic modes"
    columns = "mode       chain [Hz]       exact [Hz]   error [%]"
    return {"rigid_body_modes": modes.rigid_body_modes, "modes": rows}, "\n".join([title, columns, *lines])


def _springs(options: argparse.Namespace) -> Answer:
    chain = _chain(options)
    rows = [
        {"hinge": j + 1, "position_m": float(x), "stiffness_n_m_per_rad": float(k)}
        for j, (x, k) in enumerate(zip(chain.hinge_position, chain.joint_stiffness, strict=True))
    ]
    lines = [
        f"{row['hinge']:5d}  {row['position_m']:12.6g}  {row['stiffness_n_m_per_rad']:20.10g}" for row in rows
    ]
    return {"hinges": rows}, "\n".join(["hinge  position [m]  stiffness [N m/rad]", *lines])


def _segments(options: argparse.Namespace) -> Answer:
    from beammodes.errors import segments_needed

    count = segments_needed(options.boundary, options.tolerance, options.modes, options.rule)
    return {"segments": count}, str(count)


def _time_step(options: argparse.Namespace) -> Answer:
    from beammodes.stability import highest_angular_frequency, stable_time_step

    chain = _chain(options)
    step, highest = stable_time_step(chain, options.integrator), highest_angular_frequency(chain)
    if math.isinf(step):
        raise ValueError(
            f"segments must be larger: {chain.boundary.name} with {options.segments} has no elastic mode "
            "and so no stability limit"
        )
    answer = {"time_step_s": step, "highest_angular_frequency_rad_per_s": highest}
    return answer, f"{step:.6g} s  ({options.integrator}, highest angular frequency {highest:.6g} rad/s)"


def _in_flags(message: str) -> str:
    """Return a message of the library in the words that the user typed."""
    for name, flag in (("bending_stiffness must", "--ei must"), ("mass_per_length must", "--rho-a must")):
        message = message.replace(name, flag)
    return message


def _beam(options: argparse.Namespace) -> Any:
    from beammodes.beam import Beam

    return Beam(length=options.length, bending_stiffness=options.ei, mass_per_length=options.rho_a)


def _chain(options: argparse.Namespace) -> Any:
    from beammodes.chain import Chain

    return Chain(_beam(options), options.boundary, segments=options.segments, rule=options.rule)


def _recommend(options: argparse.Namespace) -> Answer:
    from beammodes.advice import recommend

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
    lines.append(f"cost: segments times {options.integrator} steps in one period of the first mode")
    return {"recommendations": rows}, "\n".join(lines)


_COMMANDS = (
    ("error", _error, "relative frequency error of a uniform chain", _error_options),
    (
        "frequencies",
        _frequencies,
        "natural frequencies of a chain beside the exact beam's",
        _frequency_options,
    ),
    ("springs", _springs, "joint stiffnesses to type into a multibody tool", _spring_options),
    ("segments", _segments, "how many segments a tolerance needs", _tolerance_options),
    ("recommend", _recommend, "rules that meet a tolerance, cheapest first", _advice_options),
    ("time-step", _time_step, "largest stable fixed time step of a chain", _step_options),
)


if __name__ == "__main__":
    sys.exit(main())
