"""Who computes a study does not matter: the same bits, on processes, threads or a cluster."""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

import beammodes as bm
from beammodes.batch.cases import Cases
from beammodes.batch.executors import ENGINES, evaluate_elsewhere


def pieces(case: bm.Case) -> float:
    """How many pieces there are."""
    return case.chain.pieces


def study(**changes: Any) -> bm.Study:
    """Closed form, roots, dense matrices, samples and a function of our own."""
    given: dict[str, Any] = {
        "boundary": ["clamped-free", "clamped-guided"],
        "rule": ["mitiguy", "hencky"],
        "segments": [3, 40],
        "mode": [1, 2, 3],
        "right_mass": bm.Uniform(0.0, 1.0),
        "spin_rate": [0.0, 1.5],
        "compute": ["relative_error", "angular_frequency", "stable_time_step", pieces],
        "chunk": 9,
    }
    return bm.Study.sampled(3, seed=1, **given | changes)


@pytest.fixture(scope="module")
def serial(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, xarray.Dataset]:
    folder = tmp_path_factory.mktemp("serial")
    return folder, study().run(store=folder)


def same(folder: Path, found: xarray.Dataset, serial: tuple[Path, xarray.Dataset]) -> None:
    assert found.attrs == serial[1].attrs
    for name, array in serial[1].variables.items():
        assert array.values.tobytes() == found[name].values.tobytes(), name
    kept = [{path.name: path.read_bytes() for path in where.glob("*.*")} for where in (folder, serial[0])]
    for files in kept:
        files.pop("study.lock", None)
    assert kept[0] == kept[1] and len(kept[0]) == 1 + study().chunks


def test_threads_give_the_same_bits(tmp_path: Path, serial: tuple[Path, xarray.Dataset]) -> None:
    with ThreadPoolExecutor(3) as pool:
        same(tmp_path, study().run(store=tmp_path, engine=pool), serial)


def test_processes_give_the_same_bits(tmp_path: Path, serial: tuple[Path, xarray.Dataset]) -> None:
    same(tmp_path, study().run(store=tmp_path, engine="processes", workers=2), serial)


@pytest.mark.filterwarnings("default")  # of Dask, not ours
@pytest.mark.parametrize("processes", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_a_dask_cluster_gives_the_same_bits(
    processes: bool, tmp_path: Path, serial: tuple[Path, xarray.Dataset]
) -> None:
    distributed = pytest.importorskip("distributed")
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with (
        distributed.LocalCluster(**options, processes=processes) as cluster,
        distributed.Client(cluster) as client,
    ):
        same(tmp_path, study().run(store=tmp_path, engine=client), serial)
        # Interrupted, it goes on elsewhere, and its client is still ours to use.
        half = tmp_path / "half"
        with pytest.raises(KeyboardInterrupt):
            study().run(store=half, engine=client, progress=_interrupt_at(3))
        assert 0 < bm.open_study(half).finished_cases < study().size
        same(half, study().run(store=half), serial)
        assert client.submit(sum, [1, 2]).result() == 3


@pytest.mark.filterwarnings("default")  # of Dask, not ours
def test_an_asynchronous_client_is_refused() -> None:
    distributed = pytest.importorskip("distributed")

    async def run() -> None:
        options = {"n_workers": 1, "processes": False, "dashboard_address": ":0"}
        async with distributed.Client(**options, asynchronous=True) as client:
            with pytest.raises(ValueError, match="Client without asynchronous=True"):
                study().run(engine=client)

    asyncio.run(run())


def _interrupt_at(count: int) -> Callable[[int, int], None]:
    def progress(done: int, _total: int) -> None:
        if done >= count:
            raise KeyboardInterrupt

    return progress


def test_order_of_completion_does_not_matter(tmp_path: Path, serial: tuple[Path, xarray.Dataset]) -> None:
    class Backwards(ThreadPoolExecutor):
        """Finishes the last chunk first."""

        waiting: list[tuple[Future[Any], Any]] = []  # noqa: RUF012

        def submit(self, function: Any, /, *given: Any, **named: Any) -> Future[Any]:
            future: Future[Any] = Future()
            self.waiting.append((future, lambda: function(*given, **named)))
            if len(self.waiting) == study().chunks:
                for other, call in reversed(self.waiting):
                    other.set_result(call())
            return future

    seen: list[int] = []
    found = study().run(store=tmp_path, engine=Backwards(), progress=lambda done, _: seen.append(done))
    same(tmp_path, found, serial)
    assert seen == list(range(study().chunks + 1))


def test_what_is_finished_beside_a_failure_is_kept(tmp_path: Path) -> None:
    class AllAtOnce(ThreadPoolExecutor):
        """Returns futures that are done: every other one failed."""

        count = 0

        def submit(self, function: Any, /, *given: Any, **named: Any) -> Future[Any]:
            future: Future[Any] = Future()
            if AllAtOnce.count % 2:
                future.set_exception(MemoryError("one"))
            else:
                future.set_result(function(*given, **named))
            AllAtOnce.count += 1
            return future

    with pytest.raises(MemoryError, match="one"):
        study(chunk=1, compute=pieces).run(store=tmp_path, engine=AllAtOnce())
    assert _chunks(tmp_path) == AllAtOnce.count / 2 == 24


def crash(case: bm.Case) -> float:
    if case.segments == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return 1.0


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL there")
def test_a_worker_that_dies_loses_no_finished_chunk(tmp_path: Path) -> None:
    from concurrent.futures.process import BrokenProcessPool

    fatal = bm.Study.grid(boundary="free-free", segments=[5, 6, 7, 8, 9, 3], compute=crash, chunk=1)
    with pytest.raises(BrokenProcessPool) as caught:
        fatal.run(store=tmp_path, engine="processes", workers=1)
    assert "SIGKILL" in str(caught.value)  # the cause
    assert any("a worker ended" in note for note in caught.value.__notes__)
    assert any("chunks are stored in" in note for note in caught.value.__notes__)
    assert bm.open_study(tmp_path).finished_cases >= 1


NOTEBOOK = """
import beammodes as bm

SCALE = 2.5

class Law:
    def value(self, case):
        return SCALE * case.segments

def helper(case, law=Law()):
    return law.value(case)

def own(case):
    return helper(case) / (case.segments - 4)

def make(power):
    def closed(case):
        return case.segments**power
    return closed

study = bm.Study.grid(boundary="free-free", segments=range(2, 9), compute=[own, make(2)], chunk=2)
many = study.run(engine="processes", workers=2)
assert many.identical(study.run())
print(many.own.values.tolist(), many.closed.values.tolist(), many.reasons)
"""


@pytest.mark.parametrize(
    "typed", [pytest.param(True, id="notebook"), pytest.param(False, id="script", marks=pytest.mark.slow)]
)
def test_functions_of_a_notebook_or_script_reach_the_workers(tmp_path: Path, typed: bool) -> None:
    # Typed: a program that no file holds. In neither case is there a guard of the main module.
    (tmp_path / "script.py").write_text(NOTEBOOK)
    command = [sys.executable, *(["-"] if typed else [str(tmp_path / "script.py")])]
    run = subprocess.run(
        command, input=NOTEBOOK if typed else "", capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    segments = np.arange(2.0, 9.0)
    with np.errstate(divide="ignore"):
        expected = np.where(segments == 4, np.nan, 2.5 * segments / (segments - 4))
    assert run.stdout.startswith(f"{expected.tolist()} {(segments**2).tolist()}"), run.stdout
    assert run.stdout.rstrip().endswith("ZeroDivisionError: float division by zero")


LIMIT = 1.0


def limited(case: bm.Case) -> float:
    return LIMIT * case.segments


def test_a_worker_does_not_run_other_code_than_the_study_was_made_of(monkeypatch: pytest.MonkeyPatch) -> None:
    # A worker would load the module from its file, in which LIMIT is 1.
    grid = {"boundary": "free-free", "segments": [2, 3], "compute": limited}
    assert bm.Study.grid(**grid).run(engine="processes", workers=1).limited.values.tolist() == [2.0, 3.0]
    monkeypatch.setattr(sys.modules[__name__], "LIMIT", 2.0)
    study = bm.Study.grid(**grid)
    assert study.run().limited.values.tolist() == [4.0, 6.0]
    with pytest.raises(ValueError, match=r"workers must have .*LIMIT as it was when the study was made"):
        study.run(engine="processes", workers=1)


def test_what_cannot_be_sent_is_told(tmp_path: Path) -> None:
    with (tmp_path / "open.txt").open("w") as file:

        def writes(case: bm.Case) -> float:
            return float(file.write(str(case.segments)))

        writes.__module__ = "__main__"
        study = bm.Study.grid(boundary="free-free", segments=[2, 3], compute=writes)
        with pytest.raises(Exception, match="task to send it to the workers") as caught:
            study.run(engine="processes", workers=1)
        assert any('engine="serial" takes any' in note for note in caught.value.__notes__)
        assert study.run().writes.values.tolist() == [1.0, 1.0]


PROGRAM = """
import sys, beammodes as bm
bm.Study.grid(
    boundary="clamped-free(mass=0.1)", segments=range(2, 2000), mode=[1, 2, 3],
    compute="relative_error", chunk=20,
).run(store=sys.argv[1], engine="processes", workers=2)
"""


def _chunks(folder: Path) -> int:
    return len(list(folder.glob("chunk-*.nc")))


def test_an_interrupt_waits_until_a_chunk_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Within a library's own clean-up an interrupt would be printed and forgotten, or lose the chunk.
    import h5netcdf

    plain = h5netcdf.File.__init__

    def interrupted(self: object, *arguments: object) -> None:
        signal.raise_signal(signal.SIGINT)
        plain(self, *arguments)

    study = bm.Study.grid(
        boundary="clamped-free", segments=range(2, 12), mode=[1], compute="relative_error", chunk=5
    )
    with monkeypatch.context() as patch:
        patch.setattr(h5netcdf.File, "__init__", interrupted)
        with pytest.raises(KeyboardInterrupt) as caught:
            study.run(store=tmp_path / "store")
    assert any("1 of 2 chunks are stored" in note for note in caught.value.__notes__)
    assert _chunks(tmp_path / "store") == 1
    np.testing.assert_array_equal(
        study.run(store=tmp_path / "store").relative_error, study.run().relative_error
    )


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="reads /proc")
@pytest.mark.parametrize("number", [pytest.param(signal.SIGKILL, marks=pytest.mark.slow), signal.SIGINT])
def test_workers_end_with_their_parent(tmp_path: Path, number: signal.Signals) -> None:
    program = tmp_path / "program.py"
    program.write_text(textwrap.dedent(PROGRAM))
    command = [sys.executable, str(program), str(tmp_path / "store")]
    # A session of its own, as a terminal's Ctrl-C reaches every process of the group.
    process = subprocess.Popen(command, stderr=subprocess.PIPE, start_new_session=True)
    while _chunks(tmp_path / "store") < 2 and process.poll() is None:
        time.sleep(0.01)
    if number == signal.SIGINT:
        os.killpg(process.pid, number)
    else:
        process.send_signal(number)
    assert process.wait(600) != 0
    assert process.stderr is not None
    said = process.stderr.read().decode()
    process.stderr.close()
    assert said.count("Traceback") == (number == signal.SIGINT), said  # the parent's own, none of workers
    assert ("the same call goes on from there" in said) == (number == signal.SIGINT)
    deadline = time.monotonic() + 600  # only so that the test ends
    while _alive(process.pid) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert _alive(process.pid) == []


def _alive(session: int) -> list[str]:
    """Processes of a session that still run."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, _, its_session = path.read_text().rsplit(")", 1)[1].split()[:4]
        except OSError:
            continue
        if int(its_session) == session and state != "Z":
            found.append(path.parent.name)
    return found


def test_cancelled_chunks_are_not_computed(tmp_path: Path) -> None:
    with ThreadPoolExecutor(1) as pool, pytest.raises(KeyboardInterrupt):
        study(compute=["relative_error", counted]).run(store=tmp_path, engine=pool, progress=_interrupt_at(1))
    # One was saved, one may have been under way.
    assert len(COUNTED) <= 3 * 9 < study().size


COUNTED: list[int] = []


def counted(case: bm.Case) -> float:
    COUNTED.append(case.segments)
    return 0.0


def test_a_worker_of_another_version_is_refused() -> None:
    cases: Cases = study().cases(0)
    with pytest.raises(ValueError, match=f"workers must have beammodes 99.0, got {bm.__version__}"):
        evaluate_elsewhere(cases, study().quantities, "99.0")


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"engine": "dusk"}, "engine must be one of serial, processes"),
        ({"engine": "proceses"}, 'did you mean "processes"'),
        ({"engine": 3}, "engine must be one of"),
        ({"engine": None}, "engine must be one of"),
        ({"workers": 2}, 'workers must be left out unless engine is "processes"'),
        ({"engine": "processes", "workers": 0}, "workers must be"),
        ({"engine": "processes", "workers": 1.5}, "workers must be"),
        ({"progress": 3}, "progress must be a function"),
        ({"store": 3}, "store must be a folder"),
    ],
)
def test_bad_runs_are_refused(given: dict[str, Any], message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        bm.Study.grid(boundary="free-free", segments=3, mode=1, compute="relative_error").run(**given)
    assert ENGINES == ("serial", "processes")


def test_values_are_those_without_a_store(serial: tuple[Path, xarray.Dataset]) -> None:
    found = study().run()
    for name in serial[1].data_vars:
        np.testing.assert_array_equal(found[name], serial[1][name])
