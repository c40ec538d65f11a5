"""A study's store: nothing finished is lost or computed twice, whatever happens in between."""

from __future__ import annotations

import errno
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import beammodes as bm
import beammodes.files
from beammodes.batch.executors import evaluate
from beammodes.batch.store import Evaluated, difference, locked

GRID: dict[str, Any] = {
    "boundary": ["clamped-free", "clamped-clamped"],
    "segments": range(1, 21),
    "mode": [1, 2],
    "compute": ["relative_error", "angular_frequency"],
    "chunk": 4,
}


def study(**changes: Any) -> bm.Study:
    return bm.Study.grid(**GRID | changes)


def names(folder: Path) -> list[str]:
    """Names of the chunks' files, each of which has the digest of its bytes in it."""
    return sorted(path.name for path in folder.glob("chunk-*.nc"))


class Stop:
    """Progress that raises an error once a number of chunks is done, and counts the calls."""

    def __init__(self, after: float = float("inf"), error: type[BaseException] = KeyboardInterrupt) -> None:
        self.after, self.error, self.seen = after, error, []

    def __call__(self, done: int, total: int) -> None:
        self.seen.append((done, total))
        if done >= self.after:
            raise self.error


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Any, ...]]:
    """Filled with the chunks that are computed: their first boundary and N."""
    seen: list[tuple[Any, ...]] = []

    def counted(cases: Any, quantities: Any) -> Evaluated:
        seen.append((cases.columns["boundary"][0].name, int(cases.columns["segments"][0])))
        return evaluate(cases, quantities)

    monkeypatch.setattr("beammodes.batch.executors.evaluate", counted)
    return seen


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Any]:
    """A store of the whole study, and its dataset: made once, not to be changed."""
    folder = tmp_path_factory.mktemp("kept")
    return folder, study().run(store=folder)


@pytest.fixture
def whole(kept: tuple[Path, Any], tmp_path: Path) -> Any:
    """The study's dataset, a copy of whose store is the test's own folder."""
    shutil.copytree(kept[0], tmp_path, dirs_exist_ok=True)
    return kept[1]


@pytest.mark.parametrize(
    "error", [KeyboardInterrupt, MemoryError, pytest.param(SystemExit, marks=pytest.mark.slow)]
)
def test_an_interrupted_study_goes_on(
    kept: tuple[Path, Any], tmp_path: Path, calls: list[Any], error: type[BaseException]
) -> None:
    whole = kept[1]
    stop = Stop(3, error)
    with pytest.raises(error) as caught:
        study().run(store=tmp_path, progress=stop)
    assert caught.value.__notes__ == [
        f"3 of 10 chunks are stored in {tmp_path}; the same call goes on from there",
        "a chunk is 4 points: give a study of slow points a smaller chunk=",
    ]
    half = bm.open_study(tmp_path)
    assert (half.finished_cases, half.cases, half.complete) == (12, 40, 0)
    there = half.angular_frequency.notnull().any("mode").values.ravel()
    assert there[1:12].all() and not there[12:].any()  # one segment between two clamps has no mode
    again = Stop()
    assert study().run(store=tmp_path, progress=again).identical(whole)
    assert again.seen[0] == (3, 10) and again.seen[-1] == (10, 10)
    assert len(calls) == len(set(calls)) == 10
    study().run(store=tmp_path)
    assert len(calls) == 10
    assert bm.open_study(tmp_path).identical(whole) and whole.complete == 1


def test_a_full_disk_loses_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    opened, left = os.fdopen, [4]

    def full(descriptor: int, mode: str) -> Any:
        file = opened(descriptor, mode)
        left[0] -= 1
        if left[0] < 0:

            def write(data: bytes) -> int:
                type(file).write(file, data[: len(data) // 2])
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

            class Full:
                def __enter__(self) -> Any:
                    self.write = write
                    return self

                def __exit__(self, *_: object) -> None:
                    file.close()

            return Full()
        return file

    monkeypatch.setattr(beammodes.files.os, "fdopen", full)
    with pytest.raises(OSError, match="No space left") as caught:
        study().run(store=tmp_path)
    assert caught.value.errno == errno.ENOSPC and "3 of 10 chunks" in caught.value.__notes__[0]
    assert len(names(tmp_path)) == 3  # and study.json
    assert not [path for path in tmp_path.iterdir() if path.name.startswith(".")]
    monkeypatch.undo()
    study().run(store=tmp_path)
    assert bm.open_study(tmp_path).complete == 1


def test_what_was_half_written_is_ignored_and_removed(kept: tuple[Path, Any], tmp_path: Path) -> None:
    folder = tmp_path / "store"
    folder.mkdir()
    # As a kill leaves them: of the definition, and of a chunk.
    (folder / ".study.json.x1").write_text('{"digest": ')
    study().run(store=folder)
    (folder / ".chunk-000000002-0123456789abcdef.nc.x2").write_bytes(b"\x89HDF")
    assert bm.open_study(folder).complete == 1
    study().run(store=folder)
    assert not list(folder.glob(".*"))
    assert names(folder) == names(kept[0])


@pytest.mark.parametrize("damage", ["cut", "flipped", "emptied", "removed"])
def test_a_damaged_chunk_is_computed_again(whole: Any, tmp_path: Path, calls: list[Any], damage: str) -> None:
    before = names(tmp_path)
    path = tmp_path / before[6]
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    left = {"cut": data[:100], "flipped": data, "emptied": b""}
    if damage == "removed":
        path.unlink()
        found = bm.open_study(tmp_path)
    else:
        path.write_bytes(left[damage])
        with pytest.warns(UserWarning, match="chunk-000000006.* is damaged$"):
            found = bm.open_study(tmp_path)
    assert found.finished_cases == 36
    calls.clear()
    if damage == "removed":
        again = study().run(store=tmp_path)
    else:
        with pytest.warns(UserWarning, match="damaged, and computed again"):
            again = study().run(store=tmp_path)
    assert again.identical(whole) and names(tmp_path) == before
    assert len(calls) == 1


def slow(case: bm.Case) -> float:
    return float(case.segments)


def test_a_changed_definition_is_refused(whole: Any, tmp_path: Path) -> None:
    changed: list[tuple[dict[str, Any], str]] = [
        (
            {"segments": range(1, 22)},
            r"axes, segments, values is .* \(20 of them\) there, .* \(21 of them\) here",
        ),
        ({"segments": [*range(1, 20), 99]}, "axes, segments, values number 20 is 20 there, 99 here"),
        ({"mode": [1, 3]}, "axes, mode, values number 2 is 2 there, 3 here"),
        ({"mode": 1}, "axes, mode, dimension is 'mode' there, None here"),
        ({"rule": "gregory"}, r"axes, rule, values is \['mitiguy'\]"),
        ({"right_mass": 0.1}, "axes, right_mass is here, not there"),
        ({"chunk": 5}, "chunk is 4 there, 5 here"),
        ({"compute": "relative_error"}, "compute, angular_frequency is there, not here"),
        ({"compute": [*GRID["compute"], slow]}, "compute, slow is here, not there"),
    ]
    for changes, message in changed:
        with pytest.raises(ValueError, match=f"store must be of this study, .* whose {message}"):
            study(**changes).run(store=tmp_path)
    assert study().run(store=tmp_path).identical(whole)


def test_another_order_or_version_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    study().run(store=tmp_path)
    turned = bm.Study.grid(**dict(reversed(GRID.items())))
    with pytest.raises(ValueError, match=r"axes, order is boundary, segments, mode, rule there"):
        turned.run(store=tmp_path)
    monkeypatch.setattr("beammodes.batch.study.__version__", "99.0")
    with pytest.raises(ValueError, match=r"beammodes is '.*' there, '99.0' here"):
        study().run(store=tmp_path)


def other(folder: Path, **changes: Any) -> list[Path]:
    """The chunks' files of another study's store, in order."""
    study(**changes).run(store=folder)
    return sorted(folder.glob("chunk-*.nc"))


@pytest.mark.parametrize(
    "changes",
    [
        {"rule": "gregory"},
        {"chunk": 5},
        pytest.param({"segments": range(2, 22)}, marks=pytest.mark.slow),
        pytest.param({"mode": [2, 3]}, marks=pytest.mark.slow),
    ],
    ids=str,
)
def test_a_chunk_of_another_study_is_not_read(
    kept: tuple[Path, Any], tmp_path: Path, calls: list[Any], changes: Any
) -> None:
    folder, whole = tmp_path / "store", kept[1]
    shutil.copytree(kept[0], folder)
    before = names(folder)
    foreign = other(tmp_path / "other", **changes)[6]
    (folder / before[6]).unlink()
    (folder / foreign.name).write_bytes(foreign.read_bytes())
    with pytest.warns(UserWarning, match=r"chunk-000000006.* is a chunk of another study$"):
        found = bm.open_study(folder)
    assert found.finished_cases == 36
    calls.clear()
    with pytest.warns(
        UserWarning, match=r"another study, and computed again; the file is now .*\.nc\.aside$"
    ):
        again = study().run(store=folder)
    assert again.identical(whole) and names(folder) == before and len(calls) == 1
    assert (folder / f"{foreign.name}.aside").read_bytes() == foreign.read_bytes()
    assert study().run(store=folder).identical(whole)  # without a warning


def test_two_chunks_that_were_swapped_are_not_read(whole: Any, tmp_path: Path) -> None:
    before = names(tmp_path)
    old = [tmp_path / before[k] for k in (2, 5)]
    data = [path.read_bytes() for path in old]
    new = [old[k].with_name(old[k].name[:16] + old[1 - k].name[16:]) for k in (0, 1)]
    for k in (0, 1):
        old[k].unlink()
        new[k].write_bytes(data[1 - k])
    with pytest.warns(UserWarning, match="another's name") as caught:
        assert bm.open_study(tmp_path).finished_cases == 32
    said = {str(warning.message) for warning in caught}
    assert said == {
        f"{new[0].name} is chunk 5 under another's name",
        f"{new[1].name} is chunk 2 under another's name",
    }
    with pytest.warns(UserWarning, match="computed again"):
        assert study().run(store=tmp_path).identical(whole)
    assert names(tmp_path) == before


@pytest.mark.usefixtures("whole")
def test_a_changed_definition_file_is_found_out(tmp_path: Path) -> None:
    path = tmp_path / "study.json"
    text = path.read_text()
    for old, new in (("mitiguy", "gregory"), ('"chunk": 4', '"chunk": 5'), ("clamped-free", "free-free")):
        assert old in text
        path.write_text(text.replace(old, new))
        for use in (bm.open_study, lambda folder: study().run(store=folder)):
            with pytest.raises(
                ValueError, match=r"readable study\.json.* its digest is not that of its defin"
            ):
                use(tmp_path)
    path.write_text(text)
    assert bm.open_study(tmp_path).complete == 1


LIMIT = 2.0
TABLE = {"a": [1.0, 2.0], "b": np.arange(3.0)}


class Law:
    """A class that a function names."""

    factor = 2.0

    def value(self, case: bm.Case) -> float:
        return self.factor * case.segments


def helper(case: bm.Case, factor: float = 1.0) -> float:
    return factor * case.segments + LIMIT + TABLE["a"][0]


def own(case: bm.Case) -> float:
    return helper(case) + Law().value(case)


TEXT = """
LIMIT, SIZES = 2.0, [1.0, 2.0]

def make(factor):
    def own(case, power=1):
        if case.segments in {3, 4}:
            return helper(case) ** power
        return factor * case.segments + max(row * LIMIT for row in SIZES)
    return own

def helper(case):
    return case.segments + 1.0

own = make(2.0)
"""


def typed(text: str) -> Any:
    """The function `own` of a program that no file holds, as in a notebook."""
    names: dict[str, Any] = {"__name__": "__main__"}
    exec(text, names)
    return names["own"]


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("LIMIT, SIZES = 2.0", "LIMIT, SIZES = 2.5", "__main__.LIMIT"),
        ("[1.0, 2.0]", "[1.0, 3.0]", "__main__.SIZES"),
        ("make(2.0)", "make(3.0)", "__main__.make.<locals>.own"),  # a closure
        ("power=1", "power=2", "__main__.make.<locals>.own"),  # a default
        ("{3, 4}", "{3, 5}", "__main__.make.<locals>.own"),  # a constant
        ("factor * case", "factor - case", "__main__.make.<locals>.own"),  # bytecode
        ("row * LIMIT", "row - LIMIT", "__main__.make.<locals>.own"),  # of a generator within
        ("case.segments + 1.0", "case.segments + 1.5", "__main__.helper"),
        ("max(", "min(", "__main__.make.<locals>.own"),
    ],
)
def test_a_changed_function_is_refused(tmp_path: Path, old: str, new: str, what: str) -> None:
    grid = {"boundary": "free-free", "segments": [3, 7]}
    first = bm.Study.grid(**grid, compute=typed(TEXT)).run(store=tmp_path)
    # The same text again, and with what does not run, is the same study.
    for same in (TEXT, TEXT.replace("def helper", "\n# how stiff\n\ndef helper")):
        assert bm.Study.grid(**grid, compute=typed(same)).run(store=tmp_path).identical(first)
    assert TEXT.count(old) == 1
    changed = bm.Study.grid(**grid, compute=typed(TEXT.replace(old, new)))
    with pytest.raises(ValueError, match=f"whose compute, own, source, {what} is "):
        changed.run(store=tmp_path)


def test_what_runs_counts_not_the_file(monkeypatch: pytest.MonkeyPatch) -> None:
    def digest() -> str:
        return bm.Study.grid(boundary="free-free", segments=[3], compute=own).digest

    first = digest()
    monkeypatch.setattr("inspect.getsource", lambda _: "def own(case): return 2.0")
    assert digest() == first
    changes = [
        lambda patch: patch.setattr(helper, "__defaults__", (2.0,)),
        lambda patch: patch.setattr(helper, "__code__", (lambda _case, factor=1.0: factor).__code__),
        lambda patch: patch.setattr(Law, "factor", 3.0),
        lambda patch: patch.setattr(Law, "value", lambda _self, case: 2.0 * case.segments + 1.0),
        lambda patch: patch.setitem(globals(), "LIMIT", np.float64(2.0000001)),
        lambda patch: patch.setitem(TABLE, "a", [1.0, 2.0, 3.0]),
        lambda patch: patch.setitem(TABLE, "b", np.arange(3.0) + 1e-12),
    ]
    seen = {first}
    for change in changes:
        with monkeypatch.context() as patch:
            change(patch)
            seen.add(digest())
        assert digest() == first
    assert len(seen) == len(changes) + 1


def test_a_functions_digest_is_that_of_another_process() -> None:
    # Hash seeds change the order of sets, and addresses are no part of it.
    program = f"""
import beammodes as bm
TEXT = {TEXT!r}
names = {{"__name__": "__main__"}}
exec(TEXT, names)
print(bm.Study.grid(boundary="free-free", segments=[3, 7], compute=names["own"]).digest)
"""
    ours = bm.Study.grid(boundary="free-free", segments=[3, 7], compute=typed(TEXT)).digest
    for seed in ("1", "2"):
        command = [sys.executable, "-c", program]
        run = subprocess.run(
            command, env=os.environ | {"PYTHONHASHSEED": seed}, capture_output=True, check=True
        )
        assert run.stdout.decode().strip() == ours


def test_a_folder_with_other_things_is_not_a_store(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("mine")
    with pytest.raises(ValueError, match=r"in which there is 'thesis.txt' but no study.json"):
        study().run(store=tmp_path)
    assert (tmp_path / "thesis.txt").read_text() == "mine"
    with pytest.raises(FileNotFoundError, match=r"no study is stored here"):
        bm.open_study(tmp_path)
    with pytest.raises(TypeError, match="path must be a folder"):
        bm.open_study(3)  # type: ignore[arg-type]
    with pytest.raises(NotADirectoryError, match="store must be a folder, this is a file"):
        study().run(store=tmp_path / "thesis.txt")
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]  # and no lock was left


def test_a_tilde_is_the_home_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("USERPROFILE", str(tmp_path))
    study().run(store="~/kept")
    assert bm.open_study("~/kept").complete == 1
    assert (tmp_path / "kept").is_dir()


@pytest.mark.parametrize("name", ["", "a\0b"])
def test_what_names_no_folder_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match="path must be a folder's name"):
        bm.open_study(name)
    with pytest.raises(ValueError, match="store must be a folder's name"):
        study().run(store=name)


@pytest.mark.parametrize(
    "text",
    ["{", "[]", "{}", '{"definition": {}}', '{"definition": {"axes": [1], "compute": {}, "chunk": 1}}'],
)
def test_an_unreadable_definition_is_named(tmp_path: Path, text: str) -> None:
    (tmp_path / "study.json").write_text(text)
    for use in (bm.open_study, lambda folder: study().run(store=folder)):
        with pytest.raises(ValueError, match=r"store must have a readable study\.json"):
            use(tmp_path)


def test_two_runs_do_not_share_a_store(tmp_path: Path) -> None:
    with locked(tmp_path) as alone:
        assert alone
        with pytest.raises(BlockingIOError, match="another run is computing"):
            study().run(store=tmp_path)
    study().run(store=tmp_path)  # the lock is given back


def test_two_runs_without_locks_do_no_harm(
    kept: tuple[Path, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Each finds the other's chunks appear while it is at work, and writes them again.
    def no_locks(*_: object, **__: object) -> None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr("filelock.FileLock.acquire", no_locks)

    def meanwhile(done: int, _total: int) -> None:
        if done == 2:
            study().run(store=tmp_path)

    both = study().run(store=tmp_path, progress=meanwhile)
    assert both.identical(kept[1]) and len(names(tmp_path)) == 10


def test_a_sampled_study_is_read_back(tmp_path: Path) -> None:
    sampled = bm.Study.sampled(
        30, seed=2, boundary="clamped-free", segments=[3], mode=1, chunk=7,
        right_mass=bm.Uniform(0.0, 1.0), left_rotational_stiffness=[float("inf")], compute="relative_error",
    )  # fmt: skip
    found = sampled.run(store=tmp_path)
    assert found.identical(sampled.run()) and found.identical(bm.open_study(tmp_path))
    kept = json.loads((tmp_path / "study.json").read_text())
    assert kept["digest"] == sampled.digest and kept["definition"] == sampled.definition


def test_chunks_are_netcdf_files(tmp_path: Path) -> None:
    import xarray

    whole = study().run(store=tmp_path)
    with xarray.open_dataset(tmp_path / names(tmp_path)[1], engine="h5netcdf") as chunk:
        assert dict(chunk.sizes) == {"case": 4, "mode": 2}
        expected = whole.relative_error.values.reshape(-1, 2)[4:8]
        np.testing.assert_array_equal(chunk.relative_error, expected)


def test_differences_in_words() -> None:
    assert difference({"a": {"b": 1}}, {"a": {"b": 1}}) == ""
    assert difference({"a": 1, "b": 2}, {"b": 2, "a": 1}) == "order is a, b there, b, a here"


PROGRAM = """
import sys, beammodes as bm
RULES = "mitiguy double_wall naive gregory gregory2 hencky half_stub half_stub_corrected".split()
RULES += ["rigid_stub", "rigid_stub_corrected"]

def lockstep(done, of):
    # Says that a chunk is there, and waits to be told to go on.
    print(done, flush=True)
    sys.stdin.readline()

bm.Study.grid(
    boundary=list(bm.BOUNDARIES), rule=RULES, segments=range(1, 1 + 5 * int(sys.argv[2])), mode=range(1, 6),
    compute="relative_error", chunk=500,
).run(store=sys.argv[1], progress=lockstep if sys.argv[3:] else False)
"""


def start(folder: Path, chunks: int) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-c", PROGRAM, str(folder), str(chunks), "in lockstep"]
    return subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)


@pytest.mark.parametrize(("times", "chunks"), [(1, 20), pytest.param(10, 200, marks=pytest.mark.slow)])
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL there")
def test_killed_many_times_the_store_is_the_same(
    times: int, chunks: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Killed at random moments of a chunk's computing and writing, once it has written others.
    def run_here(folder: Path) -> None:
        monkeypatch.setattr(sys, "argv", ["", str(folder), str(chunks)])
        exec(PROGRAM, {})

    run_here(tmp_path / "whole")
    folder, moments = tmp_path / "killed", random.Random(8)
    counts = []
    for _ in range(times):
        with start(folder, chunks) as process:
            assert process.stdin is not None and process.stdout is not None
            for _ in range(moments.randint(2, 12)):
                assert process.stdout.readline()
                process.stdin.write(b"\n")
                process.stdin.flush()
            time.sleep(moments.uniform(0.0, 0.05))  # It may be killed within a chunk, or after it.
            process.send_signal(signal.SIGKILL)
        assert process.returncode == -signal.SIGKILL
        counts.append(len(names(folder)))
    assert counts == sorted(set(counts)) and counts[-1] < chunks  # each had done more, none all
    run_here(folder)
    assert names(folder) == names(tmp_path / "whole") and len(names(folder)) == chunks
    files = [(path.name, path.read_bytes()) for path in sorted((tmp_path / "whole").iterdir())]
    assert files == [(path.name, path.read_bytes()) for path in sorted(folder.iterdir())]
    assert bm.open_study(folder).identical(bm.open_study(tmp_path / "whole"))
