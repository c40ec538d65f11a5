"""Running a study: what is missing in its store is computed, saved as it comes, and read back."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Container, Iterator
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

from beammodes.batch.evaluated import Evaluated
from beammodes.batch.executors import computed, executor_of
from beammodes.batch.store import BadChunk, Store, locked, made_ready
from beammodes.batch.study_dataset import study_dataset
from beammodes.checks import shown
from beammodes.progress import ProgressLine, progress_of

if TYPE_CHECKING:
    import xarray

    from beammodes.batch.study import Study

__all__ = ["open_study", "run_study"]

Report = Callable[[int, int], None]


def run_study(
    study: Study, store: str | Path | None, *, engine: Any, workers: int | None, progress: Any
) -> xarray.Dataset:
    """Compute what is not in the store, and return everything; see `Study.run`."""
    report = progress_of(progress, "study", "chunks")
    if store is None:
        found: dict[int, Evaluated] = {}
        _compute(study, found, engine, workers, report, found.__setitem__)
        return _closed(study_dataset(study.definition, sorted(found.items())), report)
    folder = _folder("store", store)
    made_ready(folder)
    with locked(folder) as alone:
        kept = Store.of(folder, study.definition)
        if alone:
            kept.clean()
        whole = kept.sound()
        try:
            _compute(study, whole, engine, workers, report, kept.save)
        except BaseException as error:
            count = f"{len({number for number, _ in kept.finished()})} of {study.chunks} chunks"
            error.add_note(f"{count} are stored in {folder}; the same call goes on from there")
            if study.chunk > 1:
                error.add_note(
                    f"a chunk is {study.chunk} points: give a study of slow points a smaller chunk="
                )
            raise
        return _closed(study_dataset(kept.definition, _sound(kept)), report)


def _closed(found: xarray.Dataset, report: Report) -> xarray.Dataset:
    """Say on the line of progress, if there is one, how many cases have no answer, and return the dataset."""
    if isinstance(report, ProgressLine) and found.failed_cases:
        report.say(f"{found.failed_cases} of {found.cases} cases have no answer: {found.reasons}")
    return found


def open_study(path: str | Path) -> xarray.Dataset:
    """Return what is finished of a stored study, also while it is being computed.

    Parameters
    ----------
    path : str or Path
        The folder that `Study.run` was given as its store.

    Returns
    -------
    xarray.Dataset
        As `Study.run` returns, with NaN for what is not there yet; attributes `finished_cases` of `cases`
        and `complete` say how much there is. All of it is read into memory; of a study too large for that,
        each chunk-*.nc is a netCDF file by itself, of consecutive points.

    Raises
    ------
    FileNotFoundError
        If no study is stored there.
    TypeError, ValueError
        If `path` is no path, or the definition there cannot be read or does not have its digest.

    Warns
    -----
    UserWarning
        If a chunk's file is damaged, or of another study or chunk: it is left out.

    Examples
    --------
    >>> import tempfile
    >>> from beammodes import Study
    >>> study = Study.grid(boundary="clamped-free", segments=[5, 10], mode=1, compute="relative_error")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = study.run(store=folder)
    ...     found = open_study(folder)
    >>> found.relative_error.values.round(6), found.finished_cases, found.cases
    (array([-0.005085, -0.001259]), 2, 2)
    """
    store = Store.read(_folder("path", path))
    return study_dataset(store.definition, _sound(store))


def _folder(name: str, path: object) -> Path:
    if not isinstance(path, str | Path):
        raise TypeError(f"{name} must be a folder's name or Path, got {shown(path)}")
    if path == "" or "\0" in str(path):
        raise ValueError(f"{name} must be a folder's name or Path, got {shown(path)}")
    return Path(path).expanduser()


def _compute(
    study: Study,
    done: Container[int],
    engine: Any,
    workers: int | None,
    report: Report,
    save: Callable[[int, Evaluated], object],
) -> None:
    """Compute the chunks that are not among `done`, and save each as it comes."""
    missing = [number for number in range(study.chunks) if number not in done]
    count = study.chunks - len(missing)
    report(count, study.chunks)
    if not missing:
        return
    tasks = ((number, study.cases(number)) for number in missing)
    with (
        executor_of(engine, workers) as executor,
        closing(computed(tasks, study.quantities, executor)) as results,
    ):
        for number, chunk in results:
            save(number, chunk)
            count += 1
            report(count, study.chunks)


def _sound(store: Store) -> Iterator[tuple[int, Evaluated]]:
    """Yield the finished chunks, each once; what is under a chunk's name and is not it, is warned of."""
    seen = set()
    for number, path in store.finished():
        try:
            chunk = store.load(number, path)
        except FileNotFoundError:
            continue  # set aside by a run that is at work
        except BadChunk as fault:
            warnings.warn(f"{path.name} {fault}", stacklevel=4)
            continue
        if number not in seen:
            seen.add(number)
            yield number, chunk
