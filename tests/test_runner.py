"""Studies at once: the same files as one after another, what is finished kept, nothing left half written."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import SimpleQueue

import pytest

from studies.__main__ import main
from studies.runner import run_all

ROOT = Path(__file__).parent.parent
QUICK = ["c_table", "quadrature"]


@pytest.mark.slow
def test_at_once_as_one_after_another(tmp_path: Path) -> None:
    heard: list[str] = []
    for jobs in (1, 2):
        (tmp_path / str(jobs)).mkdir()
        run_all(QUICK, tmp_path / str(jobs), jobs, heard.append)
    one, two = ({p.name: p.read_bytes() for p in (tmp_path / str(j)).iterdir()} for j in (1, 2))
    assert one == two and len(one) >= 7
    for name in QUICK:
        assert sum(text.startswith(f"\r{name}: {name}.csv") for text in heard) == 2


@pytest.mark.parametrize("threads", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_a_failure_reaches_the_caller(threads: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if threads:
        # Instead of processes, which take a second each to begin.
        monkeypatch.setattr("studies.runner.ProcessPoolExecutor", lambda count, *_: ThreadPoolExecutor(count))
        monkeypatch.setattr("studies.runner._channel", [SimpleQueue()])
    (tmp_path / "c_table.svg").mkdir()  # no file can take its place
    with pytest.raises(ValueError, match=r"path must be an ordinary file.*c_table\.svg"):
        run_all(QUICK, tmp_path, 2, lambda _: None)
    assert not [path.name for path in tmp_path.iterdir() if path.name.startswith(".")]


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
def test_interrupted_studies_keep_what_is_finished(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "studies", "accuracy", "c_table", "--jobs", "2", "--into", str(tmp_path)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    running = subprocess.Popen(command, cwd=ROOT, env=environment, stderr=subprocess.PIPE, text=True)
    assert running.stderr is not None
    heard = ""
    while "c_table.svg" not in heard:
        line = running.stderr.readline()
        assert line, heard  # it ended
        heard += line
    time.sleep(0.5)
    running.send_signal(signal.SIGINT)
    _, rest = running.communicate(timeout=600)
    assert running.returncode == 130
    assert "interrupted" in rest and "Traceback" not in rest
    written = {path.name for path in tmp_path.iterdir()}
    assert {"c_table.csv", "c_table.svg", "c_table.png"} <= written
    assert not [name for name in written if name.startswith((".", "accuracy"))]


@pytest.mark.parametrize("jobs", ["0", "-1", "two", "1.5"])
def test_bad_numbers_of_jobs(jobs: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main(["--jobs", jobs, "c_table"])
    assert stop.value.code == 2
    assert "jobs" in capsys.readouterr().err
