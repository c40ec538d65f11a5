"""The command line: exit codes, one-line errors, text and JSON that agree, and what the lookup imports."""

from __future__ import annotations

import json
import math
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from beammodes.__main__ import main
from beammodes.accuracy.chain_against_beam import chain_errors
from beammodes.chains.chain import Chain
from beammodes.command_line.commands import COMMANDS
from beammodes.command_line.options import BEAM as BEAM_OPTIONS
from beammodes.command_line.options import Command
from beammodes.exporters.export import export_chain
from beammodes.exporters.formats import FORMATS
from beammodes.problem.beam import Beam
from beammodes.problem.loading import Load
from beammodes.vibration.damping import damped_modes, joint_dampers
from beammodes.vibration.measured_damping import rayleigh_damping
from beammodes.vibration.stability import stable_time_step

BEAM = ["--length", "1.2", "--ei", "85", "--rho-a", "0.62", "--units", "SI"]
# One valid call of every command.
CALLS = {
    "error": ["error", "clamped-free", "--segments", "6", "--mode", "1"],
    "frequencies": ["frequencies", "clamped-free", "--segments", "6", *BEAM],
    "springs": ["springs", "clamped-free", "--segments", "4", *BEAM],
    "segments": ["segments", "clamped-clamped", "--tolerance", "0.01", "--modes", "3"],
    "time-step": ["time-step", "clamped-free", "--segments", "10", *BEAM],
}
COUNTED = ["error", "frequencies", "springs", "time-step"]  # commands that take --segments
SCALED = ["frequencies", "springs", "time-step"]  # commands that take a beam
HEAVY = ["sympy", "casadi", "matplotlib", "xarray", "scipy"]


class Ran:
    """What one run of the command line left: exit code, stdout, stderr."""

    def __init__(self, arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
        capsys.readouterr()
        try:
            self.code: Any = main(arguments)
        except SystemExit as stop:  # argparse leaves this way
            self.code = stop.code
        self.out, self.err = capsys.readouterr()

    @property
    def json(self) -> Any:
        assert self.code == 0, self.err
        assert self.err == ""
        return json.loads(self.out, parse_constant=lambda word: pytest.fail(f"{word} is no JSON"))

    @property
    def lines(self) -> list[str]:
        assert self.code == 0, self.err
        assert self.err == ""
        return self.out.splitlines()

    def refused(self, *words: str) -> None:
        """Assert exit code 2 and one short line on stderr that has these words in it."""
        assert self.code == 2
        assert self.out == ""
        assert self.err.startswith("beammodes")
        assert self.err.count("\n") == 1
        assert self.err.endswith("\n")
        assert len(self.err) < 400  # a file's whole path is part of some
        assert "Traceback" not in self.err
        for word in words:
            assert word in self.err


def changed(command: str, option: str, value: str) -> list[str]:
    """A valid call with one option set to something else; = keeps a leading minus from being an option."""
    call = list(CALLS[command])
    if option in call:
        del call[call.index(option) : call.index(option) + 2]
    return [*call, f"{option}={value}"]


def test_error(capsys: pytest.CaptureFixture[str]) -> None:
    # theory.md section 3: -0.352 %; more digits by the closed form, which tests/test_errors.py proves.
    answer = Ran([*CALLS["error"], "--json"], capsys).json
    assert answer["relative_error"] == pytest.approx(-0.0035175, abs=5e-8)
    assert {key: answer[key] for key in ("boundary", "rule", "segments", "mode")} == {
        "boundary": "clamped-free",
        "rule": "mitiguy",
        "segments": 6,
        "mode": 1,
    }
    line, case = Ran(CALLS["error"], capsys).lines
    assert line == f"{100 * answer['relative_error']:+.6g} %"
    assert case == f"rule mitiguy (the default), {answer['holds_for']}"
    assert "small vibration" in case and "without gravity" in case


@pytest.mark.parametrize(
    ("boundary", "segments", "mode", "percent"),
    # theory.md section 3.
    [
        ("clamped-free", 1, 1, -14.676),
        ("cantilever/free", 4, 2, -7.446),
        ("free-clamped", 10, 3, -2.264),
        ("clamped-clamped", 2, 1, -35.044),
        ("clamped-clamped", 20, 3, -1.6422),
    ],
)
def test_error_of_the_reports_figures(
    boundary: str, segments: int, mode: int, percent: float, capsys: pytest.CaptureFixture[str]
) -> None:
    call = ["error", boundary, f"--segments={segments}", f"--mode={mode}"]
    answer = Ran([*call, "--json"], capsys).json
    assert 100 * answer["relative_error"] == pytest.approx(percent, abs=6e-4)
    line, *remarks, case = Ran(call, capsys).lines
    assert case.endswith(answer["holds_for"])
    assert [remark.strip() for remark in remarks] == answer.get("remarks", [])
    assert bool(remarks) >= (abs(percent) > 10)
    assert float(line.split(" %")[0]) == pytest.approx(100 * answer["relative_error"], rel=1e-5)
    # theory.md section 7: at N close to the mode number every rule fails: said beside the number.
    assert any("coarse" in remark for remark in remarks) == (abs(percent) > 10)


def test_error_takes_another_rule(capsys: pytest.CaptureFixture[str]) -> None:
    call = ["error", "clamped-free", "--segments", "10", "--json", "--rule"]
    # theory.md section 5: C/F mode 1 at N = 10.
    for rule, percent, digits in (("mitiguy", -0.126, 3), ("naive", -9.11, 2), ("double_wall", -0.457, 3)):
        answer = Ran([*call, rule], capsys).json
        assert round(100 * answer["relative_error"], digits) == percent
        assert answer["rule"] == rule


@pytest.mark.parametrize(
    ("boundary", "segments", "mode"), [("clamped-clamped", 1, 1), ("clamped-free", 6, 7), ("free-free", 3, 3)]
)
@pytest.mark.parametrize("flags", [[], ["--json"]])
def test_error_of_a_missing_mode(
    boundary: str, segments: int, mode: int, flags: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    # theory.md section 2: N modes, N - 1 for clamped-clamped and free-free.
    call = ["error", boundary, f"--segments={segments}", f"--mode={mode}", *flags]
    Ran(call, capsys).refused(f"mode {mode} does not exist", boundary, str(segments))


def test_frequencies(capsys: pytest.CaptureFixture[str]) -> None:
    answer = Ran([*CALLS["frequencies"], "--json"], capsys).json
    assert answer["rigid_body_modes"] == 0
    # theory.md section 3, N = 6.
    percent = [100 * row["relative_error"] for row in answer["modes"]]
    assert percent == pytest.approx([-0.352, -3.423, -6.136], abs=6e-4)
    # The first root of cos x cosh x = -1 is 1.87510407.
    hertz = 1.87510407**2 / (2 * math.pi) * math.sqrt(85 / 0.62) / 1.2**2
    assert answer["modes"][0]["exact_frequency"] == pytest.approx(hertz, rel=1e-8)
    title, columns, *rows = Ran(CALLS["frequencies"], capsys).lines
    assert title == "clamped-free, 6 segments, mitiguy: 0 rigid-body and 6 elastic modes"
    assert columns.split() == ["mode", "chain", "[Hz]", "exact", "[Hz]", "error", "[%]"]
    for text, row in zip(rows, answer["modes"], strict=True):
        mode, chain, exact, error = map(float, text.split())
        assert mode == row["mode"]
        assert chain == pytest.approx(row["frequency"], rel=1e-5)
        assert exact == pytest.approx(row["exact_frequency"], rel=1e-5)
        assert error == pytest.approx(100 * row["relative_error"], rel=1e-3)
        assert row["relative_error"] == pytest.approx(
            row["frequency"] / row["exact_frequency"] - 1, abs=1e-14
        )


@pytest.mark.parametrize(
    ("boundary", "segments", "rigid", "elastic"),
    # theory.md section 2.
    [
        ("free-free", 3, 2, 2),
        ("clamped-clamped", 1, 0, 0),
        ("pinned-free", 2, 1, 1),
        ("guided-free", 2, 1, 2),
    ],
)
def test_frequencies_of_the_modes_there_are(
    boundary: str, segments: int, rigid: int, elastic: int, capsys: pytest.CaptureFixture[str]
) -> None:
    call = ["frequencies", boundary, f"--segments={segments}", "--modes=9"]
    answer = Ran([*call, "--json"], capsys).json
    assert answer["rigid_body_modes"] == rigid
    assert [row["mode"] for row in answer["modes"]] == list(range(1, elastic + 1))
    assert len(Ran(call, capsys).lines) == 3 + elastic


def test_springs(capsys: pytest.CaptureFixture[str]) -> None:
    answer = Ran([*CALLS["springs"], "--json"], capsys).json["hinges"]
    # report, N = 4: 24/11 EI/ell at the wall, EI/ell elsewhere; EI/ell = 85/0.3.
    expected = [85 / 0.3 * 24 / 11, 85 / 0.3, 85 / 0.3, 85 / 0.3]
    assert [row["stiffness"] for row in answer] == pytest.approx(expected, rel=1e-14)
    assert [row["position"] for row in answer] == pytest.approx([0, 0.3, 0.6, 0.9], rel=1e-14)
    head, *rows = Ran(CALLS["springs"], capsys).lines
    assert re.split(r"  +", head) == ["hinge", "position [m]", "stiffness [N m/rad]"]
    for text, row in zip(rows[:4], answer, strict=True):
        hinge, position, stiffness = map(float, text.split())
        assert hinge == row["hinge"]
        assert position == pytest.approx(row["position"], rel=1e-5)
        assert stiffness == pytest.approx(row["stiffness"], rel=1e-9)


def test_springs_of_a_chain_without_hinges(capsys: pytest.CaptureFixture[str]) -> None:
    call = ["springs", "pinned-pinned", "--segments", "1"]
    assert Ran([*call, "--json"], capsys).json["hinges"] == []
    assert Ran(call, capsys).lines[1].startswith("in multiples of the beam's own")


def test_segments(capsys: pytest.CaptureFixture[str]) -> None:
    # theory.md section 3: 26.
    answer = Ran([*CALLS["segments"], "--json"], capsys).json
    assert answer["segments"] == 26 and "small vibration" in answer["holds_for"]
    count, case = Ran(CALLS["segments"], capsys).lines
    assert count == "26" and case == f"rule mitiguy (the default), the first 3 modes, {answer['holds_for']}"
    assert (
        Ran([*CALLS["segments"], "--rule=gregory"], capsys).lines[1].startswith("rule gregory, the first 3")
    )


def test_segments_under_a_pull(capsys: pytest.CaptureFixture[str]) -> None:
    # An axial force takes every rule down to order 2: see docs of `axially_corrected`.
    call = ["segments", "clamped-free", "--tolerance=0.1%", "--rule=gregory", "--axial-force=50"]
    for beam, flags in ((Beam.unit(), []), (Beam(1.2, 85.0, 0.62), BEAM)):
        count = Ran([*call, *flags, "--json"], capsys).json["segments"]
        load = Load(axial_force=50.0)
        errors = [
            abs(chain_errors(Chain(beam, "clamped-free", n, "gregory"), 1, load=load)[0])
            for n in (count, count - 1)
        ]
        assert errors[0] <= 1e-3 < errors[1]


@pytest.mark.parametrize("option", ["--gravity=9.81", "--gravity=9.81,0", "--tip-force=2"])
def test_forces_in_units_need_a_beam_in_units(option: str, capsys: pytest.CaptureFixture[str]) -> None:
    call = ["time-step", "clamped-free", "--segments=10", option]
    Ran(call, capsys).refused(option.partition("=")[0], "must come with --length, --ei and --rho-a")
    assert Ran([*call, *BEAM], capsys).code == 0


def test_time_step(capsys: pytest.CaptureFixture[str]) -> None:
    call = ["time-step", "clamped-free", "--segments", "10"]
    answer = Ran([*call, "--json"], capsys).json
    # theory.md section 6: C/F N = 10: 0.00424 for rk4, 2√2/ω_max; leapfrog and semi-implicit Euler 2/ω_max.
    assert round(answer["time_step"], 5) == 0.00424
    step, highest = answer["time_step"], answer["highest_angular_frequency"]
    assert step * highest == pytest.approx(2 * math.sqrt(2), rel=1e-14)
    for integrator in ("leapfrog", "semi_implicit_euler"):
        other = Ran([*call, "--json", f"--integrator={integrator}"], capsys).json
        assert other["time_step"] == pytest.approx(step / math.sqrt(2), rel=1e-14)
    line, units = Ran(call, capsys).lines
    omega = f"highest angular frequency {highest:.6g} √(EI/(ρA L⁴))"
    assert line == f"{step:.6g} √(ρA L⁴/EI)  (rk4, {omega}, without load)"
    assert units.startswith("in multiples of the beam's own")


ROPE = ["pinned-free(mass=0.75)", "--segments=20", "--length=4", "--ei=0.001", "--rho-a=0.026", "--units=SI"]


def test_time_steps_say_the_case_that_they_hold_for(capsys: pytest.CaptureFixture[str]) -> None:
    rope = Chain(Beam(4.0, 0.001, 0.026), "pinned-free(mass=0.75)", 20)
    call, engine = ["time-step", *ROPE, "--integrator", "MuJoCo Euler"], "MuJoCo Euler"
    plain, hung = Ran(call, capsys).lines
    assert plain.endswith("without load)") and "with gravity 9.81 m/s² in any direction" in hung
    assert float(hung.split()[0]) == pytest.approx(
        stable_time_step(rope, engine, load=Load(gravity=9.81)), rel=1e-5
    )
    # Measured in MuJoCo: stable at 0.0066286 s once it hangs.
    (line,) = Ran([*call, "--gravity=9.81,0"], capsys).lines
    assert line.startswith("0.00662857 s") and "under Load(gravity=(9.81, 0.0))" in line
    # One that takes springs implicitly has none, only a step that keeps the first mode.
    free, kept = Ran([*call, "--integrator", "Gazebo DART"], capsys).lines
    assert free == "any step is stable  (Gazebo DART, without load)"
    told = Ran([*call, "--integrator", "Gazebo DART", "--json"], capsys).json
    assert told["time_step"] is None and kept.startswith(
        f"{told['accurate_time_step']:.6g} s  keeps the first"
    )
    pulled = Ran([*call, "--tip-force=7,0", "--damping-ratio", "0.01", "--json"], capsys).json["time_step"]
    expected = stable_time_step(
        rope, engine, load=Load(tip_force=(7.0, 0.0)), damping=joint_dampers(rope, 0.01)
    )
    assert pulled == pytest.approx(expected, rel=1e-12)
    two = Ran([*call, "--damping-ratio", "1%,3%", "--json"], capsys).json["time_step"]
    assert two == pytest.approx(
        stable_time_step(rope, engine, damping=joint_dampers(rope, {1: 0.01, 2: 0.03})), rel=1e-12
    )
    for options, words in (
        (["--gravity", "1,2,3"], ["--gravity must have two components"]),
        (["--gravity", "x"], ["--gravity must be a real number", "'x'"]),
        (["--tip-force", "1,"], ["--tip-force[1] must be a real number"]),
        (["--integrator", "dop853"], ["chooses its steps itself"]),
        (["--damping-ratio", "1%,x"], ["--damping-ratio must be a real number", "'x'"]),
    ):
        Ran([*call, *options], capsys).refused(*words)


def test_damping_says_what_all_modes_get(capsys: pytest.CaptureFixture[str]) -> None:
    call = [
        "damping",
        "clamped-free",
        "--segments=10",
        "--length=1.2",
        "--ei=85",
        "--rho-a=0.62",
        "--units=SI",
    ]
    chain = Chain(Beam(1.2, 85.0, 0.62), "clamped-free", 10)
    found = Ran([*call, "--damping-ratio", "0.8%,1.1%", "--json"], capsys).json
    fits = {
        "joints": joint_dampers(chain, {1: 0.008, 2: 0.011}),
        "rayleigh": rayleigh_damping(chain, [0.008, 0.011]),
    }
    both, dampers = fits["rayleigh"], fits["joints"].joint_damping(chain)
    assert (found["mass"], found["stiffness"]) == pytest.approx((both.mass, both.stiffness), rel=1e-12)
    assert [row["damping"] for row in found["hinges"]] == pytest.approx(dampers.tolist(), rel=1e-9)
    for name, fit in fits.items():
        ratios = damped_modes(chain, fit).damping_ratio.values
        assert [row[f"ratio_{name}"] for row in found["modes"]] == pytest.approx(ratios.tolist(), rel=1e-9)
        assert found[f"overdamped_{name}"] == (ratios >= 1).sum()
    assert found["units"]["damping"] == "N m s/rad"
    lines = Ran([*call, "--damping-ratio", "60%"], capsys).lines
    assert sum(line.endswith("does not swing") for line in lines) == 9
    peaks = Ran([*call, "--peaks", "10,9.1,8.3,7.6", "--json"], capsys).json
    # By the logarithmic decrement, as worked out by others.
    assert peaks["ratio"] == pytest.approx(0.014557783999243307, rel=1e-12)
    assert peaks["modes"][0]["ratio_joints"] == pytest.approx(peaks["ratio"], rel=1e-12)
    for options, words in (
        ([], ["--damping-ratio or --peaks must be given"]),
        (["--peaks", "9,10"], ["peaks must decay"]),
        (["--damping-ratio", "1%,x"], ["--damping-ratio must be a real number", "'x'"]),
    ):
        Ran([*call, *options], capsys).refused(*words)


def test_exports_take_gravity_and_loads(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    rope = Chain(Beam(4.0, 0.001, 0.026), "pinned-free(mass=0.75)", 20)
    for number, (options, load) in enumerate(
        {
            "--gravity=9.81,0": Load(gravity=(9.81, 0.0)),
            "--gravity=0": Load(),
            "--gravity=9.81 --tip-force=1,2": Load(gravity=9.81, tip_force=(1.0, 2.0)),
            "--axial-force=3": Load(axial_force=3.0),
            "": None,
        }.items()
    ):
        ours, same = tmp_path / f"{number}.xml", tmp_path / f"{number}_same.xml"
        assert Ran(["export", *ROPE, "--output", str(ours), *options.split()], capsys).code == 0
        export_chain(rope, same, load=load, units="SI")
        assert ours.read_bytes() == same.read_bytes()
    call = ["export", *ROPE, "--output", str(tmp_path / "rope.urdf"), "--gravity=9.81"]
    Ran(call, capsys).refused("--gravity", "must be left out for urdf files")


def test_time_steps_with_dampers_say_what_dampers_cost(capsys: pytest.CaptureFixture[str]) -> None:
    call = ["time-step", "clamped-free", "--segments=10", *BEAM]
    plain = Ran([*call, "--json"], capsys).json["time_step"]
    for option in ("--damping-ratio=0.05", "--stiffness-damping=0.001"):
        line = Ran([*call, option], capsys).lines[0]
        damped = Ran([*call, option, "--json"], capsys).json["time_step"]
        assert damped < plain and line.startswith(f"{damped:.6g} s")
        assert f"with dampers; without them {plain:.6g} s" in line
    assert "dampers" not in Ran(call, capsys).out


def test_time_step_of_a_chain_without_elastic_mode(capsys: pytest.CaptureFixture[str]) -> None:
    for flags in ([], ["--json"]):
        Ran(["time-step", "clamped-clamped", "--segments", "1", *flags], capsys).refused(
            "segments", "no elastic mode"
        )


def test_beam_scales_out_of_time_steps_and_frequencies(capsys: pytest.CaptureFixture[str]) -> None:
    # design.md: EI, ρA and L scale out. The unit of frequency is √(EI/(ρA L⁴)) = √(85/0.62)/1.44.
    unit = math.sqrt(85 / 0.62) / 1.44
    call = ["clamped-free", "--segments", "10", "--json"]
    steps = [Ran(["time-step", *call, *beam], capsys).json["time_step"] for beam in ([], BEAM)]
    assert steps[1] == pytest.approx(steps[0] / unit, rel=1e-12)
    plain, scaled = (Ran(["frequencies", *call, *beam], capsys).json["modes"] for beam in ([], BEAM))
    for row, other in zip(plain, scaled, strict=True):
        assert other["frequency"] == pytest.approx(unit * row["frequency"], rel=1e-12)


@pytest.mark.parametrize("command", COUNTED)
@pytest.mark.parametrize(
    "value",
    ["0", "-3", "2.5", "six", "nan", "True", "", "9" * 400, "9" * 5000],
    ids=lambda value: value[:4] + f"[{len(value)}]",
)
def test_bad_segments(command: str, value: str, capsys: pytest.CaptureFixture[str]) -> None:
    wanted = {"9" * 400: "10**400", "9" * 5000: "999"}.get(value, value)
    Ran(changed(command, "--segments", value), capsys).refused("segments must be a whole number", wanted)


@pytest.mark.parametrize(
    ("command", "option"), [("error", "--mode"), ("frequencies", "--modes"), ("segments", "--modes")]
)
@pytest.mark.parametrize("value", ["0", "-1", "2.5", "one", "9" * 5000], ids=lambda value: value[:4])
def test_bad_modes(command: str, option: str, value: str, capsys: pytest.CaptureFixture[str]) -> None:
    Ran(changed(command, option, value), capsys).refused(f"{option[2:]} must be a whole number", value[:3])


@pytest.mark.parametrize("command", SCALED)
@pytest.mark.parametrize(
    ("option", "argument"),
    [("--length", "length"), ("--ei", "--ei"), ("--rho-a", "--rho-a")],
)
@pytest.mark.parametrize("value", ["nan", "inf", "-1", "0", "long", "1e999"])
def test_bad_beams(
    command: str, option: str, argument: str, value: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Ran(changed(command, option, value), capsys).refused(f"{argument} must be ")


@pytest.mark.parametrize("value", ["0", "-0.01", "nan", "inf", "one"])
def test_bad_tolerances(value: str, capsys: pytest.CaptureFixture[str]) -> None:
    Ran(changed("segments", "--tolerance", value), capsys).refused("tolerance must be ", value)


@pytest.mark.parametrize("command", CALLS)
def test_bad_boundaries(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    call = CALLS[command]
    Ran([command, "clamped-freee", *call[2:]], capsys).refused(
        'did you mean "clamped-free"?', "clamped-freee"
    )
    Ran([command, "", *call[2:]], capsys).refused("boundary must name two of the ends")


@pytest.mark.parametrize("command", CALLS)
def test_bad_rules(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    Ran([*CALLS[command], "--rule", "mitigui"], capsys).refused('did you mean "mitiguy"?')


def test_bad_integrator(capsys: pytest.CaptureFixture[str]) -> None:
    Ran([*CALLS["time-step"], "--integrator", "rk5"], capsys).refused('did you mean "rk45"?')


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["errors", "clamped-free"],
        ["error"],
        ["error", "clamped-free"],
        ["error", "clamped-free", "--segments"],
        ["error", "clamped-free", "--segments", "6", "--modde", "1"],
        ["springs", "clamped-free", "--segments", "6", "surplus"],
        ["segments", "clamped-free"],
    ],
)
def test_bad_usage(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    Ran(arguments, capsys).refused("--help")


def test_help_lists_commands_and_examples(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # one of the examples writes a file
    ran = Ran(["--help"], capsys)
    examples = [shlex.split(line)[1:] for line in ran.lines if line.startswith("  beammodes ")]
    assert len(examples) >= 4
    for arguments in examples:  # and they work
        assert Ran(arguments, capsys).lines
    for command in CALLS:
        assert re.search(rf"^    {command}\b", ran.out, re.MULTILINE)


@pytest.mark.parametrize("command", CALLS)
def test_help_of_each_command(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    text = Ran([command, "--help"], capsys).out
    for option in (word for word in CALLS[command] if word.startswith("--")):
        assert option in text
    for option in ("--rule", "--json"):
        assert option in text


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    import beammodes

    assert Ran(["--version"], capsys).lines == [f"beammodes {beammodes.__version__}"]


def run(*arguments: str, **options: Any) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONIOENCODING": "utf-8", "PYTHONWARNINGS": "error"}
    return subprocess.run(
        [sys.executable, *arguments],
        capture_output=True,
        text=True,
        encoding="utf-8",
        env=environment,
        timeout=600,
        check=False,
        **options,
    )


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (CALLS["springs"], 0),
        (["springs", "clamped-free", "--segments", "0"], 2),
        (["springs"], 2),
        (["--help"], 0),
    ],
)
def test_as_a_process(arguments: list[str], code: int, tmp_path: Path) -> None:
    ran = run("-m", "beammodes", *arguments, cwd=tmp_path)
    assert ran.returncode == code
    assert "Traceback" not in ran.stderr
    assert (ran.stdout == "", ran.stderr == "") == (code == 2, code == 0)
    assert list(tmp_path.iterdir()) == []


def test_a_reader_that_has_seen_enough(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "beammodes", "springs", "clamped-free", "--segments", "20000"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        cwd=tmp_path,
    )
    assert process.stdout is not None
    assert process.stderr is not None
    with process, process.stdout, process.stderr:
        assert process.stdout.readline().startswith(b"hinge")
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait(600) == 0


@pytest.mark.parametrize("command", ["error", "segments"])
def test_lookups_import_numpy_only(command: str, tmp_path: Path) -> None:
    # design.md, "What holds the house together": the lookup path needs NumPy only.
    program = (
        "import sys\n"
        "from beammodes.__main__ import main\n"
        f"assert main({CALLS[command]!r}) == 0\n"
        f"print(sorted(set({HEAVY!r}) & set(sys.modules)), 'numpy' in sys.modules)\n"
    )
    ran = run("-c", program, cwd=tmp_path)
    assert ran.stderr == ""
    assert ran.stdout.splitlines()[-1] == "[] True"


def test_plain_import_takes_nothing_along(tmp_path: Path) -> None:
    program = f"import sys, beammodes\nprint(sorted({{*{HEAVY!r}, 'numpy'}} & set(sys.modules)))\n"
    ran = run("-c", program, cwd=tmp_path)
    assert (ran.stderr, ran.stdout) == ("", "[]\n")


def test_ends_with_numbers_and_an_axial_force(capsys: pytest.CaptureFixture[str]) -> None:
    from beammodes.accuracy.errors import frequency_error
    from beammodes.problem.loading import Load

    pair = "clamped-free(mass=0.5, rotary_inertia=0.01)"
    found = Ran(["error", pair, "--segments", "6", "--axial-force", "2", "--json"], capsys).json
    expected = frequency_error(pair, segments=6, mode=1, load=Load(axial_force=2.0), beam=Beam.unit())
    assert found["relative_error"] == expected and found["axial_force"] == 2.0
    Ran(["error", "clamped-free(mas=1)", "--segments", "6"], capsys).refused('did you mean "mass"?')
    Ran(["error", "clamped-free", "--segments", "6", "--axial-force=-9"], capsys).refused(
        "--axial-force must be above the compression at which"
    )
    call = ["springs", "pinned(rotational_stiffness=3)-free", "--segments", "3", "--json"]
    spring = Ran(call, capsys).json
    # 3 N m/rad in series with mitiguy's wall spring 6N/(3N-1) EI/ell = 6.75: 1/(1/3 + 1/6.75).
    assert spring["left_rotational_support"] == pytest.approx(3 * 6.75 / 9.75)


def test_buckling(capsys: pytest.CaptureFixture[str]) -> None:
    call = ["buckling", "pinned-pinned", "--segments", "4", "--rule", "double_wall"]
    found = Ran([*call, "--json"], capsys).json
    # Hencky's 4 N² sin²(π/2N), and Euler's π², in EI/L².
    assert found["buckling_load"] == pytest.approx(64 * math.sin(math.pi / 8) ** 2, rel=1e-13)
    assert found["exact_buckling_load"] == pytest.approx(math.pi**2, rel=1e-14)
    assert "error -5.036 %" in Ran(call, capsys).out
    Ran(["buckling", "pinned-free", "--segments", "4"], capsys).refused("rigid rotation")
    Ran(["buckling", "clamped-clamped", "--segments", "1"], capsys).refused("segments must be larger")


def test_export(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "beam.csv"
    call = ["export", "clamped-free", "--segments", "4", *BEAM, "--output", str(path)]
    assert Ran([*call, "--json"], capsys).json == {"schema_version": 1, "files": [str(path)]}
    before = path.read_bytes()
    Ran(call, capsys).refused("--force")
    assert path.read_bytes() == before
    assert Ran([*call, "--force"], capsys).lines == [str(path)]
    Ran([*call[:-1], str(tmp_path / "no" / "beam.csv")], capsys).refused("in a folder that exists")


AUDITED = ["--length", "1.2", "--ei", "85", "--rho-a", "0.62"]


def test_export_about_both_axes_with_a_damping_ratio(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    call = ["export", "clamped-free", "--segments", "4", *BEAM, "--output"]
    more = ["--ei-across", "340", "--damping-ratio", "0.02"]
    assert Ran([*call, str(tmp_path / "both.xml"), *more], capsys).code == 0
    chain, across = (Chain(Beam(1.2, stiffness, 0.62), "clamped-free", 4) for stiffness in (85.0, 340.0))
    export_chain(chain, tmp_path / "same.xml", second=across, damping=joint_dampers(chain, 0.02), units="SI")
    assert (tmp_path / "both.xml").read_bytes() == (tmp_path / "same.xml").read_bytes()
    for options, message in (
        (["both.csv", "--ei-across", "340"], "--ei-across must be left out for csv files"),
        (["x.xml", "--ei-across", "-3"], "--ei-across must be greater than 0, got -3"),
        (["x.xml", "--damping-ratio", "0"], "--damping-ratio must be greater than 0, got 0"),
        (["x.xml", "--damping-ratio", "1", "--stiffness-damping", "1"], "without --stiffness-damping"),
    ):
        ran = Ran([*call, str(tmp_path / options[0]), *options[1:]], capsys)
        assert ran.code == 2 and message in ran.err and ran.err.count("\n") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["both.xml", "same.xml"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_a_full_disk_is_told_in_one_line() -> None:
    with open("/dev/full", "w") as full:
        ran = subprocess.run(
            [sys.executable, "-m", "beammodes", *CALLS["springs"]],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert ran.returncode == 2
    assert ran.stderr == "beammodes: the answer cannot be written: No space left on device\n"


def exported(rule: str, folder: Path, capsys: pytest.CaptureFixture[str], *more: str) -> str:
    path = str(folder / f"{rule}.xml")
    call = ["export", "clamped-free", "--segments", "10", "--rule", rule, *BEAM, "--output", path, *more]
    assert Ran(call, capsys).code == 0
    return path


def test_audit_says_by_its_exit_code_whether_the_chain_meets(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    good, bad = (exported(rule, tmp_path, capsys) for rule in ("gregory", "rigid_stub"))
    assert Ran(["audit", good, *AUDITED], capsys).code == 0
    assert Ran(["audit", good, *AUDITED, "--tolerance", "1e-6"], capsys).code == 1
    for flags in ([], ["--json"]):
        ran = Ran(["audit", bad, *AUDITED, *flags], capsys)
        assert (ran.code, ran.err) == (1, "")
    assert Ran(["audit", bad, *AUDITED, "--tolerance", "0.15"], capsys).code == 0
    # A mode that the chain lacks does not meet, and JSON has null for it.
    many = Ran(["audit", good, *AUDITED, "--modes", "12", "--tolerance", "0.49", "--json"], capsys)
    assert many.code == 1
    assert json.loads(many.out)["modes"][-1]["relative_error"] is None
    assert "no such mode" in Ran(["audit", good, *AUDITED, "--modes", "12"], capsys).out


def test_audit_tells_layout_errors_and_what_to_change(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = exported("rigid_stub", tmp_path, capsys)
    answer = json.loads(Ran(["audit", path, *AUDITED, "--json"], capsys).out)
    assert (answer["layout"], answer["segments"], answer["order"]) == ("rigid_stub", 10, 1)
    assert answer["boundary"] == "clamped-free" and answer["meets"] is False
    names = [item["name"] for item in answer["suggestions"]]
    assert names == ["rigid_stub_corrected", "first_spring_tuned", "gregory"]
    text = Ran(["audit", path, *AUDITED], capsys).out
    assert "rigid_stub, +11 % at N = 10, falls only as 1/N" in text
    for item in answer["suggestions"]:
        errors = item["relative_errors"]
        (line,) = (line for line in text.splitlines() if re.match(rf"{item['name']} +(same|hinges)", line))
        shown = [float(word) for word in line.split()[-3:]]
        assert shown == pytest.approx([100 * error for error in errors], rel=1e-3, abs=1e-9)
        first = item["hinges"][0]
        assert f"{first['stiffness_n_m_per_rad']:.10g}" in text
    assert answer["suggestions"][2]["hinges"][0]["position_m"] == 0
    for row in answer["hinges"]:
        assert row["hinge"] in text


def test_audit_of_a_long_chain_shows_the_springs_that_change(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = str(tmp_path / "long.csv")
    Ran(
        ["export", "clamped-free", "--segments", "400", "--rule", "rigid_stub", *BEAM, "--output", path],
        capsys,
    )
    ran = Ran(["audit", path, *AUDITED, "--modes", "1", "--tolerance", "1e-3"], capsys)
    assert ran.code == 1 and len(ran.out.splitlines()) < 45
    assert "397 more hinges: see --json" in ran.out


def test_audit_takes_springs_chain_plane_and_boundary(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    urdf = str(tmp_path / "beam.urdf")
    assert Ran(["export", "clamped-free", "--segments", "5", *BEAM, "--output", urdf], capsys).code == 0
    moved = tmp_path / "elsewhere.yaml"
    (tmp_path / "beam.springs.yaml").rename(moved)
    call = ["audit", urdf, *AUDITED, "--modes", "1"]
    Ran(call, capsys).refused("must have a hinge with a spring")
    assert Ran([*call, "--springs", str(moved), "--chain", "chain_piece_3", "--plane", "z"], capsys).code == 0
    Ran([*call, "--springs", str(moved), "--boundary", "free-free"], capsys).refused("must fit the file")
    Ran([*call, "--springs", str(moved), "--boundary", "clampd-free"], capsys).refused("did you mean")
    Ran([*call, "--springs", str(moved), "--chain", "piece"], capsys).refused("chain must be one of")


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("--length", "-1", "length must be greater than 0"),
        ("--ei", "nan", "--ei must"),
        ("--rho-a", "none", "--rho-a must"),
        ("--tolerance", "0", "tolerance must be greater than 0"),
        ("--modes", "0", "modes must be a whole number"),
    ],
)
def test_bad_audits(
    option: str, value: str, message: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = exported("mitiguy", tmp_path, capsys)
    Ran(["audit", path, *AUDITED, f"{option}={value}"], capsys).refused(message)


def test_files_that_are_not_there_are_named_in_plain_words(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    Ran(["audit", str(tmp_path / "no.xml"), *AUDITED], capsys).refused(
        "no such file or directory: ", "no.xml"
    )
    Ran(["audit", str(tmp_path), *AUDITED], capsys).refused("is a folder")


@pytest.mark.parametrize(
    ("arguments", "near"),
    [
        (["errors", "clamped-free"], "error"),
        (["audti", "beam.xml"], "audit"),
        (["timestep", "clamped-free"], "time-step"),
        (["error", "clamped-free", "--segmnts", "6"], "--segments"),
        (["springs", "clamped-free", "--segments=6", "--lenght=2"], "--length"),
        (["audit", "beam.xml", "--tolerence", "1"], "--tolerance"),
    ],
)
def test_mistyped_words_get_the_nearest(
    arguments: list[str], near: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Ran(arguments, capsys).refused(f'did you mean "{near}"?', "--help)")


def test_help_groups_commands_by_the_work_and_gives_an_example_of_each(
    capsys: pytest.CaptureFixture[str],
) -> None:
    text = Ran(["--help"], capsys).out
    stages = ["before you build a chain:", "while you build it:", "when you have one:", "examples:"]
    places = [text.index(stage) for stage in stages]
    assert places == sorted(places)
    listed = re.findall(r"^    ([a-z-]+)  +(.+)$", text, re.MULTILINE)
    assert [name for name, _ in listed] == [command.name for command in COMMANDS]
    assert all(question.endswith("?") for _, question in listed)
    examples = re.findall(r"^  beammodes ([a-z-]+)", text, re.MULTILINE)
    assert examples == [command.name for command in COMMANDS]
    assert max(map(len, text.splitlines())) <= 113
    for command in COMMANDS:
        own = Ran([command.name, "--help"], capsys).out
        assert own.startswith(f"usage: beammodes {command.name} ")
        assert command.question[1:] in own
        assert command.example in own
        assert "--json" in own


def test_the_help_of_export_names_every_format_and_integrator(capsys: pytest.CaptureFixture[str]) -> None:
    words = re.split(r"[\s,():]+", Ran(["export", "--help"], capsys).out)
    assert {*FORMATS, *(kind.suffix for kind in FORMATS.values())} <= set(words)
    assert {"RK4", "Euler", "implicit", "implicitfast"} <= set(words) and "discrete" not in words


def test_every_example_in_the_help_runs_in_order(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for command in COMMANDS:
        arguments = shlex.split(command.example)
        assert arguments[0] == "beammodes"
        assert Ran(arguments[1:], capsys).lines
        force = ["--force"] if command.name == "export" else []
        assert isinstance(Ran([*arguments[1:], "--json", *force], capsys).json, dict)
        if command.in_space:
            assert command.in_space in Ran([command.name, "--help"], capsys).out
            found = Ran([*shlex.split(command.in_space)[1:], "--json", *force], capsys).json
            assert found["motion"] == "space"


def test_tables_have_units_in_their_heads_and_signs_on_their_errors(
    capsys: pytest.CaptureFixture[str],
) -> None:
    head, *rows = Ran(["frequencies", "clamped-free", "--segments", "6", *BEAM], capsys).lines[1:]
    assert re.split(r"  +", head) == ["mode", "chain [Hz]", "exact [Hz]", "error [%]"]
    assert all(len(row) == len(head) and re.search(r" [-+][\d.]+$", row) for row in rows)
    call = ["recommend", "clamped-free", "--tolerance", "0.01", "--rule", "mitiguy,gregory", *BEAM]
    head, first, *_ = Ran(call, capsys).lines
    heads = ["rule", "N", "error [%]", "static error [%]", "step [s]", "cost [-]"]
    assert re.split(r"  +", head) == heads
    assert len(first) == len(head) and len(first.split()) == len(heads)


IN_UNITS = {
    # One bar: L = 1.2 m, EI = 85 N m², ρA = 0.62 kg/m; an inch is 0.0254 m, a pound-force 4.4482216152605 N.
    "SI": (1.2, 85.0, 0.62, 1.0, 1.0),
    "mm-N-t": (1200.0, 85e6, 0.62e-6, 1e-3, 1.0),
    "in-lbf-s": (
        1.2 / 0.0254,
        85 / 4.4482216152605 / 0.0254**2,
        0.62 / 4.4482216152605 * 0.0254**2,
        0.0254,
        4.4482216152605,
    ),
}


@pytest.mark.parametrize("units", IN_UNITS)
def test_heads_are_in_the_units_that_are_declared(units: str, capsys: pytest.CaptureFixture[str]) -> None:
    length, stiffness, mass, meter, newton = IN_UNITS[units]
    beam = [f"--length={length!r}", f"--ei={stiffness!r}", f"--rho-a={mass!r}", "--units", units.upper()]
    words = {
        "SI": ("[m]", "[N m/rad]", "N "),
        "mm-N-t": ("[mm]", "[N mm/rad]", "N "),
        "in-lbf-s": ("[in]", "[lbf in/rad]", "lbf "),
    }[units]
    springs = Ran(["springs", "clamped-free", "--segments=4", *beam], capsys).lines
    assert words[0] in springs[0] and words[1] in springs[0]
    # The report's spring at the wall, 24/11 EI/ell, turned into N m.
    wall = float(springs[1].split()[-1])
    assert wall * newton * meter == pytest.approx(24 / 11 * 85 / 0.3, rel=1e-9)
    (load,) = Ran(["buckling", "clamped-free", "--segments=4", *beam], capsys).lines
    assert f" {words[2]}" in load
    # Seconds are seconds in all three: frequencies and steps do not depend on the system.
    answers = [
        Ran([*call, *beam, "--json"], capsys).json
        for call in (
            ["frequencies", "clamped-free", "--segments=4"],
            ["time-step", "clamped-free", "--segments=4"],
        )
    ]
    assert answers[0]["modes"][0]["exact_frequency"] == pytest.approx(
        4.5501146, rel=1e-6
    )  # 1.8751041²/2π ...
    assert answers[0]["units"]["frequency"] == "Hz" and answers[0]["units"]["system"] == units
    plain = Ran(["time-step", "clamped-free", "--segments=4", *BEAM, "--json"], capsys).json
    for name in ("time_step", "time_step_under_gravity"):
        assert answers[1][name] == pytest.approx(plain[name], rel=1e-9)


@pytest.mark.parametrize("units", IN_UNITS)
@pytest.mark.parametrize("format", FORMATS)
def test_files_say_the_units_that_are_declared(
    units: str, format: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    length, stiffness, mass, meter, _ = IN_UNITS[units]
    beam = [f"--length={length!r}", f"--ei={stiffness!r}", f"--rho-a={mass!r}", "--units", units]
    place = tmp_path / f"beam{FORMATS[format].suffix}"
    call = ["export", "clamped-free", "--segments=4", *beam, "--output", str(place), "--format", format]
    assert Ran(call, capsys).code == 0
    text = place.read_text(encoding="utf-8")
    name, bending = {"SI": ("m", "N m2"), "mm-N-t": ("mm", "N mm2"), "in-lbf-s": ("in", "lbf in2")}[units]
    assert f"length {length:.6g} {name}, EI {stiffness:.6g} {bending}" in text
    assert "if " not in text.partition("ends:")[0] and f"units: {name}, " in text
    if "timestep" in FORMATS[format].takes:
        # Standard gravity is one acceleration: 9.81 m/s², whatever a length is counted in.
        said = re.search(r"with gravity (\S+) (\S+)/s2 in any direction", text)
        assert said is not None and said[2] == name
        assert float(said[1]) * meter == pytest.approx(9.81, rel=1e-3)


def example_without_beam(command: Command) -> list[str]:
    words = shlex.split(command.example)[1:]
    for flag in ("--length", "--ei", "--rho-a", "--units"):
        if flag in words:
            del words[words.index(flag) : words.index(flag) + 2]
    return words


@pytest.mark.parametrize(
    "command", [each for each in COMMANDS if BEAM_OPTIONS[0] in each.options], ids=lambda each: each.name
)
def test_a_beam_is_given_whole_or_not_at_all(
    command: Command, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    call = example_without_beam(command)
    numbers = {"--length": "1.2", "--ei": "85", "--rho-a": "0.62"}
    for flags in (["--length"], ["--ei", "--rho-a"], ["--rho-a", "--length"]):
        missing = [flag for flag in numbers if flag not in flags]
        given = [word for flag in flags for word in (flag, numbers[flag])]
        Ran([*call, *given], capsys).refused(*missing, "must be given")
    Ran([*call, "--units", "SI"], capsys).refused("--units must come with --length")
    beam = [word for pair in numbers.items() for word in pair]
    Ran([*call, *beam, "--units", "inches"], capsys).refused("--units must be one of SI, mm-N-t, in-lbf-s")
    if command.name in ("export", "audit"):
        Ran(call, capsys).refused("--length, --ei and --rho-a must be given")
        return
    # Without a beam nothing is printed in SI; without declared units nothing is, either.
    for flags in ([], beam):
        text = Ran([*call, *flags], capsys).out
        assert not re.search(r"\b(Hz|rad/s|N|m|s|N m/rad)\]|\d (N|s|Hz)\b", text), text
        units = Ran([*call, *flags, "--json"], capsys).json.get("units", {})
        assert not {"Hz", "rad/s", "N", "m", "s", "N m/rad"} & set(units.values())


def test_numbers_of_ends_are_multiples_or_in_the_units_of_the_beam(
    capsys: pytest.CaptureFixture[str],
) -> None:
    beam, pair = Beam(1.2, 85.0, 0.62), "clamped-free(mass=0.3)"
    call = ["error", pair, "--segments=6", "--axial-force=20"]
    for units, flags in ((Beam.unit(), []), (beam, BEAM)):
        expected = chain_errors(Chain(units, pair, 6), 1, load=Load(axial_force=20.0))[0]
        answer = Ran([*call, *flags, "--json"], capsys).json
        assert answer["relative_error"] == pytest.approx(expected, rel=1e-7)
        assert answer["units"]["axial_force"] == ("N" if flags else "EI/L²")
        assert ("are taken as multiples of ρA L" in Ran([*call, *flags], capsys).out) == (not flags)
    heavy = ["segments", "clamped-free(mass=20)", "--tolerance=0.1%", "--modes=2"]
    counts = [Ran([*heavy, *flags, "--json"], capsys).json["segments"] for flags in ([], BEAM)]
    for units, count in zip((Beam.unit(), beam), counts, strict=True):
        errors = [abs(chain_errors(Chain(units, heavy[1], n), 2)).max() for n in (count, count - 1)]
        assert errors[0] <= 1e-3 < errors[1]


@pytest.mark.parametrize(
    "call",
    [
        ["segments", "clamped-free"],
        ["recommend", "clamped-free", "--rule=gregory"],
        ["audit", "nothing.xml", *BEAM],
    ],
)
def test_tolerances_are_fractions_or_percent(call: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    if call[0] != "audit":
        same = [Ran([*call, "--tolerance", value], capsys).lines for value in ("0.01", "1%", " 1 %", "1e0%")]
        assert all(lines == same[0] for lines in same)
    for value, near in (("1", "for 1 % give 0.01"), ("5", "for 5 % give 0.05"), ("50%", ""), ("0.5", "")):
        Ran([*call, "--tolerance", value], capsys).refused(
            "--tolerance must be a fraction less than 0.5", near
        )
    for value in ("%", "1%%", "one%", "-1%", "nan%", "0%"):
        Ran([*call, f"--tolerance={value}"], capsys).refused("tolerance must be ")


def test_answers_name_the_next_command_and_it_runs(capsys: pytest.CaptureFixture[str]) -> None:
    advised = False
    for call, settings in (
        (["springs", "clamped-free(mass=0.1)", "--segments=4"], (BEAM, [])),
        (["recommend", "clamped-free", "--tolerance=1%"], (BEAM,)),
    ):
        for flags in settings:
            lines = Ran([*call, *flags], capsys).lines
            asked = [line.split("beammodes ", 1)[1] for line in lines if "beammodes " in line]
            assert asked
            for words in asked:
                # All rules at a time are the slowest of all answers: with a beam only.
                if not (advised and words.startswith("recommend")):
                    assert Ran(shlex.split(words), capsys).code == 0
                advised |= words.startswith("recommend")


TWIST = ["--motion", "twist", "--length", "0.5", "--gj", "80", "--rho-ip", "8e-6", "--units", "SI"]


def test_commands_in_twist_and_stretch(capsys: pytest.CaptureFixture[str]) -> None:
    # sin x/x - 1 with x = π/40; GJ/ell = 640, twice that at the wall; (2n - 1)/(4L) √(GJ/ρIp) = 1581.1 Hz.
    error = Ran(
        ["error", "fixed-free", "--segments", "10", "--rule", "half_stub", *TWIST, "--json"], capsys
    ).json
    x = math.pi / 40
    assert error["relative_error"] == pytest.approx(math.sin(x) / x - 1, rel=1e-12)
    springs = Ran(["springs", "clamped-free", "--segments", "4", *TWIST], capsys).lines
    assert springs[0] == "hinge  position [m]  stiffness [N m/rad]" and springs[1].split()[-1] == "1280"
    ring = Ran(
        ["frequencies", "fixed-free", "--segments", "6", "--modes", "1", *TWIST, "--json"], capsys
    ).json
    assert ring["modes"][0]["exact_frequency"] == pytest.approx(math.sqrt(80 / 8e-6) / 2, rel=1e-12)
    assert ring["units"]["angular_frequency"] == "rad/s"
    step = ["time-step", "fixed-fixed", "--segments", "10", "--motion", "stretch"]
    line, own = Ran([*step, "--integrator", "leapfrog"], capsys).lines
    assert line.startswith("0.1 √(ρA L²/EA)") and "--ea and --rho-a are not given" in own
    assert (
        Ran(["segments", "fixed-free", "--tolerance", "1%", "--modes", "3", *TWIST], capsys).lines[0] == "17"
    )
    # From 2.04 β, β = 5π/2, on.
    advice = ["recommend", "fixed-free", "--tolerance", "1%", "--modes", "3", *TWIST]
    first = Ran([*advice, "--rule", "half_stub", "--json"], capsys).json["recommendations"][0]
    assert (first["segments"], first["step_set_by"]) == (17, "twist")
    assert first["stable_time_step"] * first["highest_angular_frequency"] == pytest.approx(2 * math.sqrt(2))
    assert Ran(advice, capsys).lines[0].split() == ["rule", "N", "error", "[%]", "step", "[s]", "cost", "[-]"]
    damped = Ran([*step, "--damping-ratio=0.1", "--integrator=leapfrog"], capsys).lines[0]
    assert "with dampers; without them 0.1 √(ρA L²/EA)" in damped and float(damped.split()[0]) < 0.1
    for call, words in (
        (["error", "fixed-free", "--segments", "3", "--gj", "3"], ("--gj must come with --motion",)),
        (["error", "pinned-free", "--segments", "3", "--motion", "twist"], ("fixed-free", "not twist")),
        (["error", "fixed-free", "--segments", "3", "--motion", "torsion"], ("bending, twist, stretch",)),
        (["error", "fixed-free", "--segments", "3", *TWIST, "--ei", "1"], ("--ei must be left out",)),
        (["error", "fixed-free", "--segments", "3", *TWIST, "--shape", "arc"], ("--shape must be left out",)),
        (
            ["buckling", "clamped-free", "--segments", "3", *TWIST],
            ("--motion must be one of bending, space",),
        ),
        (["springs", "fixed-free", "--segments", "3", *TWIST[:4]], ("--gj and --rho-ip must be given with",)),
    ):
        Ran(call, capsys).refused(*words)


WIRE = {"bending_stiffness": 1.3, "torsional_stiffness": 1.0, "mass_per_length": 2.0}
SPACE = ["--motion", "space", "--ei", "1.3", "--gj", "1", "--rho-a", "2"]


def test_commands_in_space_say_what_the_library_does(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    import beammodes as bm

    polar, across = {"polar_inertia_per_length": 1e-4}, {"second_bending_stiffness": 9.0}
    points = [[math.cos(t / 6), math.sin(t / 6), 0.1 * t] for t in range(9)]
    (tmp_path / "line.csv").write_text("x, y, z\n" + "\n".join(f"{x!r}, {y!r}, {z!r}" for x, y, z in points))
    rods = {
        ("--length=1", "--shape=straight"): bm.Rod(1.0, **WIRE),
        ("--length=1", "--shape=pretwisted(angle=1.5)"): bm.Rod.pretwisted(1.5, length=1.0, **WIRE),
        ("--length=2", "--shape=arc(angle=1.2)"): bm.Rod.arc(1.2, length=2.0, **WIRE),
        ("--shape=helix(radius=0.1, pitch=0.05, turns=1)",): bm.Rod.helix(
            radius=0.1, pitch=0.05, turns=1, **WIRE
        ),
        ("--shape=hook(straight=1, radius=.2, angle=-3)",): bm.Rod.hook(
            straight=1.0, radius=0.2, angle=-3.0, **WIRE
        ),
        ("--length=1", "--shape=curved(y=1, x=2)"): bm.Rod(1.0, curvature=(2.0, 1.0, 0.0), **WIRE),
        (f"--points={tmp_path / 'line.csv'}",): bm.Rod.through(points, **WIRE),
        ("--length=1", "--ei-across=9", "--rho-ip=1e-4"): bm.Rod(1.0, **WIRE, **across, **polar),
    }
    case = ["clamped-free(mass=0.5)", "--segments=6", "--rule=gregory", *SPACE]
    for flags, rod in rods.items():
        chain = bm.SpatialChain(rod, "clamped-free(mass=0.5)", 6, "gregory")
        found = Ran(["springs", *case, *flags, "--json"], capsys).json["hinges"]
        turns = [[row[turn] for turn in ("twist", "about_y", "about_z")] for row in found]
        assert turns == chain.joint_stiffness.tolist()
        assert [row["position"] for row in found] == chain.hinge_position.tolist()
    rows = Ran(["frequencies", *case, *flags, "--modes=5", "--json"], capsys).json["modes"]
    errors = bm.rod_errors(chain, 5)
    assert [row["relative_error"] for row in rows] == pytest.approx(errors.tolist(), abs=1e-12)
    assert [row["frequency"] for row in rows] == bm.spatial_modes(chain, 5).frequency.tolist()
    error = Ran(["error", *case, *flags, "--mode=2", "--json"], capsys).json
    assert error["relative_error"] == pytest.approx(errors[1], abs=1e-12) and error["motion"] == "space"
    for asked, counts in (("--modes=3", 3), ("--modes=bending=2,twist=1", {"bending": 2, "twist": 1})):
        needed = ["segments", case[0], *case[2:], *flags, asked, "--tolerance=1%"]
        expected = bm.segments_needed(case[0], 0.01, counts, "gregory", beam=rod)
        assert Ran([*needed, "--json"], capsys).json["segments"] == expected
        assert Ran(needed, capsys).lines[0] == str(expected)
    advice = ["recommend", case[0], *SPACE, *flags, "--tolerance=1%", "--rule=gregory,half_stub"]
    ways = bm.recommend(case[0], 0.01, beam=rod, rules=["gregory", "half_stub"])
    rows = Ran([*advice, "--json"], capsys).json["recommendations"]
    assert [(row["rule"], row["segments"], row["step_set_by"]) for row in rows] == [
        (way.rule, way.segments, way.step_set_by) for way in ways
    ]
    assert rows[0]["joint_stiffness"] == ways[0].joint_stiffness.tolist()
    assert "N set by  step set by" in Ran(advice, capsys).lines[0]
    # A light section's twist is fastest: about 2 N/L √(GJ/ρIp).
    call = ["time-step", *case, *flags, "--integrator=leapfrog"]
    step = Ran([*call, "--json"], capsys).json
    assert step["time_step"] == bm.stable_time_step(chain, "leapfrog")
    assert step["highest_angular_frequency"] == pytest.approx(12 * math.sqrt(1 / 1e-4), rel=0.03)
    assert step["stored_in"]["twist"] > 0.99 and "set by twist: " in Ran(call, capsys).lines[1]
    hung = Ran([*call, "--gravity=0,0,-9.81", "--json"], capsys).json["time_step"]
    assert hung == bm.stable_time_step(chain, "leapfrog", load=bm.SpatialLoad(gravity=(0, 0, -9.81)))
    ours, same = tmp_path / "ours.xml", tmp_path / "same.xml"
    more = ["--gravity=0,0,-9.81", "--damping-ratio=0.02", "--joints=yzx", f"--output={ours}"]
    assert Ran(["export", *case, *flags, *more], capsys).code == 0
    down, dampers = bm.SpatialLoad(gravity=(0, 0, -9.81)), bm.joint_dampers(chain, 0.02)
    bm.export_chain(chain, same, load=down, damping=dampers, joints="yzx")
    assert ours.read_bytes() == same.read_bytes()
    # Of a cantilever pushed along itself, hinges with half a weight at the wall: 4 N² sin²(π/4N) EI/L².
    found = Ran(
        ["buckling", "clamped-free", "--segments=8", "--rule=double_wall", *SPACE, "--length=3",
         "--tip-force=-7,0,0", "--json"], capsys,
    ).json  # fmt: skip
    assert found["critical_factor"] == pytest.approx(
        4 * 64 * math.sin(math.pi / 32) ** 2 * 1.3 / 9 / 7, rel=1e-9
    )


def test_bad_rods_are_told_in_one_line(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    call, line = ["springs", "clamped-free", "--segments=3", *SPACE], tmp_path / "line.csv"
    line.write_text("0,0,0\n1,0,0\n2,0\n3,0,0\n")
    for options, words in (
        ([], ("--length must be given for motion space",)),
        (["--length=1", "--shape=hlix"], ("--shape must be one of straight", 'did you mean "helix"?')),
        (["--shape=helix(radius=1)"], ("without pitch and turns",)),
        (["--length=1", "--shape=helix(radius=1, pitch=1, turns=1)"], ("--length must be left out",)),
        (["--length=1", "--shape=arc(angle=__import__)"], ("angle of --shape must be a number",)),
        (["--length=1", "--shape=arc(angle=1, angle=2)"], ("angle of --shape must be given once",)),
        (["--length=1", "--shape=arc(angel=1)"], ('did you mean "angle"?',)),
        (["--length=1", "--shape=arc(1)"], ("--shape must be arc(angle=...)",)),
        (["--length=1", "--shape=arc(angle=1e308)"], ("angle must turn a rod by at most 1e+09 radians",)),
        (["--points", str(tmp_path / "no.csv")], ("no such file",)),
        (["--points", str(line)], ("line 3 must have three numbers",)),
        (["--points", str(line), "--length=2"], ("--length must be left out with --points",)),
        (["--length=1", "--ei-across=-3"], ("--ei-across must be greater than 0",)),
        (["--length=1", "--gj=0"], ("--gj must be greater than 0",)),
        (["--length=1", "--ea=3"], ("--ea must be left out for motion space",)),
        (["--length=1", "--units=inch"], ("--units must be one of SI",)),
    ):
        Ran([*call, *options], capsys).refused(*words)
    Ran(["springs", "clamped-free", "--segments=3", "--motion=space", "--length=1"], capsys).refused(
        "--ei and --gj and --rho-a must be given for motion space"
    )
    Ran(["error", "clamped-free", "--segments=3", "--shape=arc(angle=1)"], capsys).refused(
        "--shape must come with --motion space"
    )
    Ran(
        ["buckling", "pinned-pinned", "--segments=3", *SPACE, "--length=1", "--tip-force=-1,0,0"], capsys
    ).refused("chain must be held so that it cannot move rigidly")
