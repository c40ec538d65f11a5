"""The options of each command of the command line."""

from __future__ import annotations

import argparse

from beammodes.command_line.text_tables import DECLARED

__all__ = [
    "BOUNDARY",
    "advice_options",
    "audit_options",
    "count_options",
    "error_options",
    "export_options",
    "frequency_options",
    "in_flags",
    "spring_options",
    "step_options",
    "tolerance_options",
]

_BEAM = (
    ("length", "L, length of the beam, such as 1.2 m"),
    ("ei", "EI, bending stiffness, such as 85 N m²"),
    ("rho_a", "ρA, mass per length, such as 0.62 kg/m"),
)
BOUNDARY = (
    "two ends of clamped, pinned, guided, free, such as clamped-free; numbers may follow: "
    '"clamped-free(mass=0.5, rotary_inertia=0.01, offset=0.1, translational_stiffness=3)", in the units of '
    "the beam; without --length, --ei and --rho-a they are multiples of ρA L, ρA L³, L, EI/L³ and EI/L"
)
Options = argparse.ArgumentParser


def in_flags(message: str) -> str:
    """Return a message of the library in the words that the user typed."""
    flags = {
        "bending_stiffness must": "--ei must",
        "mass_per_length must": "--rho-a must",
        "axial_force must": "--axial-force must",
        "tolerance must": "--tolerance must",
        "say by boundary": "say by --boundary",
        "force=True": "--force",
        "second must": "--ei-across must",
        "gravity": "--gravity",
        "tip_force": "--tip-force",
        "load must be left out": "--gravity, --axial-force and --tip-force must be left out",
    }
    for name, flag in flags.items():
        message = message.replace(name, flag)
    return message


def _beam_options(sub: Options) -> None:
    for name, text in _BEAM:
        flag = "--" + name.replace("_", "-")
        sub.add_argument(flag, type=_number, metavar="X", help=text)
    _units_option(sub)


def _units_option(sub: Options) -> None:
    sub.add_argument(
        "--units", metavar="NAME", help=f"what your numbers are in, for headings: {', '.join(DECLARED)}"
    )


def _segments_option(sub: Options) -> None:
    sub.add_argument("--segments", type=_integer, required=True, metavar="N", help="number of rigid segments")


def _modes_option(sub: Options, default: int) -> None:
    text = f"how many modes (default: {default})"
    sub.add_argument("--modes", type=_integer, default=default, metavar="n", help=text)


def error_options(sub: Options) -> None:
    """Add what an error depends on."""
    _segments_option(sub)
    sub.add_argument("--mode", type=_integer, default=1, metavar="n", help="elastic mode (default: 1)")
    _beam_options(sub)
    _axial_option(sub)


def frequency_options(sub: Options) -> None:
    """Add what frequencies depend on."""
    _segments_option(sub)
    _modes_option(sub, 3)
    _beam_options(sub)
    _axial_option(sub)


def spring_options(sub: Options) -> None:
    """Add what joint stiffnesses depend on."""
    _segments_option(sub)
    _beam_options(sub)


def tolerance_options(sub: Options) -> None:
    """Add what must be met."""
    sub.add_argument("--tolerance", type=_fraction, required=True, metavar="e", help="1%% or 0.01")
    _modes_option(sub, 1)
    _beam_options(sub)


def count_options(sub: Options) -> None:
    """Add what a number of segments depends on."""
    tolerance_options(sub)
    _axial_option(sub)


def _axial_option(sub: Options) -> None:
    text = "axial force, tension positive; in EI/L² without a beam (default: 0)"
    sub.add_argument("--axial-force", type=_number, default=0.0, metavar="T", help=text)


def step_options(sub: Options) -> None:
    """Add what a time step depends on."""
    spring_options(sub)
    _load_options(sub)
    _damping_options(sub)
    _integrator_option(sub, 'also an engine\'s, such as "MuJoCo implicitfast" or "Drake discrete"')


def _load_options(sub: Options) -> None:
    text = "gravity [m/s²], as one number across the beam or as two, along,across: --gravity=9.81,0 hangs it"
    sub.add_argument("--gravity", type=_vector, metavar="g", help=text)
    _axial_option(sub)
    text = "force on the right tip [N], across the beam or along,across"
    sub.add_argument("--tip-force", type=_vector, metavar="F", help=text)


def _damping_options(sub: Options) -> None:
    text = "dampers that give the first mode, without load, this ratio: 0.01 is one percent of critical"
    sub.add_argument("--damping-ratio", type=_number, metavar="z", help=text)
    sub.add_argument("--stiffness-damping", type=_number, default=0.0, metavar="b", help="dampers b k [s]")


def advice_options(sub: Options) -> None:
    """Add what advice depends on."""
    tolerance_options(sub)
    _integrator_option(sub)


def _integrator_option(sub: Options, more: str = "") -> None:
    text = "of fixed step, such as leapfrog or 'MuJoCo implicitfast' (an unknown name lists all)"
    text += f"; {more}" if more else ""
    sub.add_argument("--integrator", default="rk4", metavar="NAME", help=f"{text} (default: rk4)")


def export_options(sub: Options) -> None:
    """Add how a chain is written."""
    spring_options(sub)
    sub.add_argument("--output", required=True, metavar="FILE", help=".xml (MJCF), .sdf, .urdf or .csv")
    sub.add_argument("--format", help="mjcf, sdf, urdf or csv (default: by the file's ending)")
    sub.add_argument("--name", default="chain", help="prefix of all names in the file (default: chain)")
    sub.add_argument("--fragment", action="store_true", help="bodies only, to include in a model (MJCF, SDF)")
    sub.add_argument("--timestep", type=_number, metavar="h", help=_TIMESTEP)
    text = "MuJoCo's RK4, Euler, implicit or implicitfast (default: RK4)"
    sub.add_argument("--integrator", default="RK4", help=text)
    text = "EI of bending along y [N m²]: hinges about both axes (not CSV)"
    sub.add_argument("--ei-across", type=_number, metavar="X", help=text)
    _load_options(sub)
    _damping_options(sub)
    sub.add_argument("--force", action="store_true", help="overwrite existing files")


def audit_options(sub: Options) -> None:
    """Add what a chain in a file is judged by."""
    for name, text in _BEAM:
        flag = "--" + name.replace("_", "-")
        sub.add_argument(flag, type=_number, required=True, metavar="X", help=text)
    sub.add_argument("--boundary", metavar="ENDS", help=f"the beam's ends (default: the file's): {BOUNDARY}")
    _units_option(sub)
    text = "largest error that meets, 1%% or 0.01 (default: 1%%)"
    sub.add_argument("--tolerance", type=_fraction, default=0.01, metavar="e", help=text)
    _modes_option(sub, 3)
    sub.add_argument("--chain", metavar="NAME", help="a body of the chain to judge (default: the longest)")
    sub.add_argument("--plane", help="x, y or z, along which it deflects (default: by the springs)")
    text = "springs of a URDF file (default: .springs.yaml beside it)"
    sub.add_argument("--springs", metavar="FILE", help=text)


#: In the words of `export_chain`.
_TIMESTEP = (
    "time step [s] (default: half the stable one, under the loads given, or without gravity and with 9.81 "
    "m/s² in any direction; less where the first frequency would shift by over 0.1 %%)"
)


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


def _fraction(text: str) -> float | str:
    number = _number(text.strip().removesuffix("%"))
    return number / 100 if text.strip().endswith("%") and isinstance(number, float) else number


def _vector(text: str) -> float | str | tuple[float | str, ...]:
    parts = text.split(",")
    return _number(text) if len(parts) == 1 else tuple(map(_number, parts))
