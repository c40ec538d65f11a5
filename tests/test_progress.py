"""The progress line: rate and time left on a terminal, nothing elsewhere."""

from __future__ import annotations

import io
import sys

import pytest

import beammodes as bm
from beammodes.progress import ProgressLine, progress_of


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_line_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    study = bm.Study.grid(boundary="free-free", segments=[3, 4], mode=1, compute="relative_error", chunk=1)
    study.run()
    lines = stream.getvalue().split("\r")
    assert lines[1].startswith("study: [                    ] 0 of 2 chunks")
    assert lines[-1].startswith("study: [####################] 2 of 2 chunks") and lines[-1].endswith("\n")
    assert "/s" in lines[-1] and "left" not in lines[-1]


def test_quiet_elsewhere(capsys: pytest.CaptureFixture[str]) -> None:
    study = bm.Study.grid(boundary="free-free", segments=[3], mode=1, compute="relative_error")
    study.run()
    study.run(progress=False)
    assert capsys.readouterr() == ("", "")
    study.run(progress=True)
    assert "1 of 1 chunks" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("seconds", "said"), [(0.4, "0 s"), (119.0, "119 s"), (125.0, "2 min 05 s"), (7260.0, "2 h 01 min")]
)
def test_time_left(seconds: float, said: str) -> None:
    # Half done, from 10 to 55 of 100: what is left takes as long as what was done.
    line = ProgressLine("x", "points", print, iter([0.0, seconds]).__next__)
    line.text(10, 100)
    assert line.text(55, 100).endswith(f", {said} left")


def test_a_resumed_study_counts_from_where_it_was() -> None:
    line = ProgressLine("x", "points", print, iter([0.0, 1.0]).__next__)
    line.text(90, 100)
    assert line.text(92, 100).endswith("92 of 100 points, 2/s, 4 s left")


def test_not_every_step_is_shown() -> None:
    stream = io.StringIO()
    line = ProgressLine("x", "points", stream.write)
    for k in range(1001):
        line(k, 1000)
    assert stream.getvalue().count("\r") < 100 and "1000 of 1000" in stream.getvalue()


def test_bad_progress_is_refused() -> None:
    seen: list[tuple[int, int]] = []
    progress_of(lambda *given: seen.append(given), "x", "points")(1, 2)
    assert seen == [(1, 2)]
    with pytest.raises(TypeError, match="progress must be a function, True, False or None, got 'yes'"):
        progress_of("yes", "x", "points")
