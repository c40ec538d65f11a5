"""Advice applied: an audited file written again with the springs of a suggestion, nothing else changed."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from beammodes.auditing.audit import Audit, Suggestion
from beammodes.auditing.audit_model import audit_file
from beammodes.auditing.body_tree import SpringPlace
from beammodes.auditing.bounded_xml import BadModel, XmlElement, bounded_bytes, read_xml
from beammodes.auditing.changed_springs import NewNumber, with_numbers
from beammodes.auditing.read_mjcf import include_files
from beammodes.auditing.told_audit import audit_line, listed_errors, off_the_beam
from beammodes.checks import Shown, choice, flag, row_shown, shown
from beammodes.files import file_target, named_path, write_atomically
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BoundaryLike

__all__ = ["MendedFile", "mend_file"]

#: A smaller relative difference of springs, or of what is read back from what is promised, is rounding.
_ROUNDING = 1e-8


@dataclass(frozen=True, eq=False, repr=False)
class MendedFile(Shown):
    """The result of `mend_file`: what was written, and what it promises.

    Attributes
    ----------
    path : Path
        The file that was written.
    model, original : Path
        The model file, and the file whose place the written one can take: the model itself, a URDF file's
        springs, or a file that the model includes.
    suggestion : Suggestion
        Whose springs are written.
    before, audit : Audit
        Of the model as it is, and as it is read back with the written file.
    hinge_names : tuple of str
        The hinges whose number was changed.
    old_number, new_number : ndarray, shape (hinges changed,)
        What the file has and what the written one has for them. It is the stiffness [N m/rad] of the hinge,
        but for a tendon or where the end's own spring is in series with it.
    notes : tuple of str
        What else these changes do.
    """

    path: Path
    model: Path
    original: Path
    suggestion: Suggestion
    before: Audit
    audit: Audit
    hinge_names: tuple[str, ...]
    old_number: Floats
    new_number: Floats
    notes: tuple[str, ...] = ()

    @property
    def promise(self) -> str:
        """One sentence on what the written file does, as it was computed from what was read back."""
        omega = self.audit.angular_frequency
        hertz = row_shown(omega[np.isfinite(omega)] / (2 * np.pi), "{:.6g}", "Hz")
        verdict = "meets" if self.audit.meets else "still does not meet"
        return (
            f"with the springs of {self.suggestion.name} the modes are at {hertz}: "
            f"{listed_errors(self.audit.errors)}; that {verdict} {100 * self.audit.tolerance:.3g} %"
        )

    @property
    def not_mended(self) -> str:
        """One sentence on what the written file leaves as it was, empty if there is nothing to say."""
        return "; ".join(self._left())

    def _left(self) -> Iterator[str]:
        found = self.audit
        listed = [
            *off_the_beam({"length": found.length_mismatch, "mass": found.mass_mismatch}),
            *found.matter,
        ]
        if listed:
            yield "springs do not mend matter: " + ", ".join(listed)
        if (found.errors < found.errors_without_armature).any():
            yield f"nor armature: without it {listed_errors(found.errors_without_armature)}"
        moved = next((item for item in self.before.suggestions if item.moves_hinges), None)
        if moved is not None:
            gain = listed_errors(moved.errors)
            yield f"hinges stay where they are: moved as by {moved.name} they give {gain}"
        if found.step is not None and not found.step.is_stable:
            yield str(found.step)

    @property
    def text(self) -> str:
        """A short report."""
        count = len(self.hinge_names)
        where = ""
        if self.original != self.model:
            where = f", to take the place of {self.original.name} beside {self.model.name}"
        lines = [
            f"{self.path}{where}: {count} spring{'s' * (count != 1)} changed, nothing else",
            self.promise,
        ]
        lines += [f"not mended: {self.not_mended}"] if self.not_mended else []
        return "\n".join([*lines, *self.notes])

    def _line(self) -> str:
        of = f"{self.path.name}, {self.suggestion.name}: chain against beam"
        return audit_line(self.audit, of, "MendedFile")


def mend_file(
    path: str | os.PathLike[str],
    written: str | os.PathLike[str],
    beam: Beam,
    boundary: BoundaryLike | None = None,
    *,
    suggestion: str | None = None,
    modes: int = 3,
    tolerance: float = 0.01,
    chain: str | None = None,
    plane: str | None = None,
    springs: str | os.PathLike[str] | None = None,
    force: bool = False,
) -> MendedFile:
    """Audit the chain in a model file, and write the file again with better springs for the same hinges.

    Every byte but those of the changed numbers stays: comments, order, blanks, line ends, encoding. A hinge
    of MJCF that has its stiffness from a default class gets an attribute of its own. What is written is the
    file that has the springs: of URDF the one beside the model, unless `<gazebo>` elements have them; of MJCF
    the one that the model includes, if they stand there.

    Before it takes its place, the written file is read back: its audit must give the springs and frequencies
    that are promised, else nothing is written.

    Parameters
    ----------
    path : str or Path
        The model: MJCF, URDF or SDFormat.
    written : str or Path
        The new file; never `path`, nor any file that it is read with.
    beam, boundary, modes, tolerance, chain, plane, springs
        As `audit_file` takes them.
    suggestion : str, optional
        The name of one of the audit's suggestions for the same hinges; by default the first that meets the
        tolerance, else the first.
    force : bool
        Whether a file that is at `written` may be replaced.

    Returns
    -------
    MendedFile

    Raises
    ------
    TypeError, ValueError
        As `audit_file`; or if there are no better springs for the same hinges, or they do not stand in one
        file, each as a number of its own.
    OSError
        If a file cannot be read or written, or `written` exists and `force` is not set.

    Examples
    --------
    >>> import tempfile
    >>> import beammodes as bm
    >>> beam = bm.Beam(1.2, 85.0, 0.62)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     written = bm.export_chain(bm.Chain(beam, "clamped-free", 10, "naive"), f"{folder}/boom.xml")
    ...     mended = bm.mend_file(f"{folder}/boom.xml", f"{folder}/mended.xml", beam)
    >>> print(mended.promise)
    with the springs of gregory the modes are at 4.55013, 28.5123, 79.6691 Hz:
      errors +0.000515 %, -0.00976 %, -0.218 %; that meets 1 %
    """
    flag("force", force)
    if not isinstance(suggestion, str | None):
        raise TypeError(f"suggestion must be the name of one, or None, got {shown(suggestion)}")
    place = _target(written, path, springs, force=force)
    asked: dict[str, Any] = {"modes": modes, "tolerance": tolerance, "chain": chain, "plane": plane}
    found = audit_file(path, beam, boundary, springs=springs, **asked)
    model = Path(path)
    try:
        chosen = _chosen(found, suggestion)
        numbers = _numbers(found, chosen)
        holder = _holder(model, numbers)
        _check_target(place, model, holder)
        data = with_numbers(bounded_bytes(holder), numbers)
    except BadModel as error:
        raise BadModel(f"{model}: {error}") from None
    read_back: list[Audit] = []

    def check(temporary: Path) -> None:
        with TemporaryDirectory() as folder:
            files = _read_with(temporary, model, holder, springs, Path(folder))
            read_back.append(audit_file(files[0], beam, boundary, springs=files[1], **asked))
        _check_promise(model, found, chosen, read_back[0])

    write_atomically(place, lambda file: file.write(data), new=not force, check=check)
    return MendedFile(
        place,
        model,
        holder,
        chosen,
        found,
        read_back[0],
        tuple(each.hinge for each in numbers.values()),
        np.array([each.old for each in numbers.values()]),
        np.array([each.new for each in numbers.values()]),
        tuple(dict.fromkeys(f"note: {place.note}" for place in numbers if place.note)),
    )


def _target(written: object, path: object, springs: object, *, force: bool) -> Path:
    """Return where to write; refuse a place that is read, before the advice to force it."""
    try:
        there = named_path(written)
        for read in (path, springs):
            if isinstance(read, str | os.PathLike) and Path(read).exists():
                _check_apart(there, Path(read))
        return file_target(there, new=not force)
    except (TypeError, ValueError, OSError) as error:
        raise type(error)(str(error).replace("path must", "written must", 1)) from None


def _check_apart(there: Path, read: Path) -> None:
    if there.exists() and there.samefile(read):
        raise ValueError(
            f"written must be another file than those that are read, got {shown(str(there))}: what you have "
            "is never overwritten"
        )


def _chosen(found: Audit, name: str | None) -> Suggestion:
    """Return the suggestion of that name, or the one to take, of those for the same hinges."""
    kept = {each.name: each for each in found.suggestions if not each.moves_hinges}
    moved = {each.name for each in found.suggestions} - kept.keys()
    if name in moved:
        others = f"; of springs for the same hinges there are {', '.join(kept)}" if kept else ""
        raise ValueError(f"suggestion must keep the hinges, got {shown(name)}, which moves them{others}")
    if name is not None and kept:
        return kept[choice("suggestion", name, kept)]
    if kept:
        meeting = (each for each in kept.values() if (np.abs(each.errors) <= found.tolerance).all())
        return next(meeting, next(iter(kept.values())))
    more = f"; {', '.join(sorted(moved))} would need other hinges" if moved else ""
    raise BadModel(
        "suggestion must be one for the same hinges, and there is none: no springs of a rule are better than "
        f"these: {found.remark}{more}"
    )


def _numbers(found: Audit, chosen: Suggestion) -> dict[SpringPlace, NewNumber]:
    """Return the numbers that differ, by their places; refuse springs that have no place of their own."""
    numbers: dict[SpringPlace, NewNumber] = {}
    columns = (found.hinge_names, found.joint_stiffness.tolist(), chosen.joint_stiffness.tolist())
    places = found.spring_places or [None] * len(found.hinge_names)
    for place, name, old, new in zip(places, *columns, strict=True):
        if place is None or place.refusal:
            if abs(new - old) <= _ROUNDING * abs(old):
                continue
            why = place.refusal if place else "no number in the file is that spring"
            raise BadModel(f"the spring of {name} cannot be written: {why}")
        number = NewNumber(name, place.number(old), place.number(new))
        before = numbers.setdefault(place, number)
        if abs(before.new - number.new) > _ROUNDING * abs(number.new):
            raise BadModel(
                f"the springs of {before.hinge} and {name} cannot be written: they are one number in the "
                f"file, and would be {before.new:.6g} and {number.new:.6g}"
            )
    return {place: number for place, number in numbers.items() if number.differs}


def _holder(model: Path, numbers: Iterable[SpringPlace]) -> Path:
    """Return the file that has the numbers; refuse several."""
    files = {place.file for place in numbers}
    if len(files) > 1:
        listed = " and ".join(sorted(shown(name or model.name) for name in files))
        raise BadModel(f"the springs cannot be written: they stand in {listed}, and one file is written")
    (name,) = files
    return model.parent / name if name else model


def _read_with(
    new: Path, model: Path, holder: Path, springs: str | os.PathLike[str] | None, folder: Path
) -> tuple[Path, str | os.PathLike[str] | None]:
    """Return the model and its springs as they are to be read with a new file in the holder's place.

    Of files that the model includes copies are put into a folder of their own.
    """
    if holder == model:
        return new, springs
    root = read_xml(model)
    if root.tag == "robot":
        return model, new
    for name in ("", *include_files(root, model.parent)):
        if Path(name).is_absolute() or ".." in Path(name).parts:
            raise BadModel(f"the springs cannot be written: {shown(name)} must be included by its plain name")
        old = model.parent / name if name else model
        copy = folder / (name or model.name)
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_bytes(bounded_bytes(new if old == holder else old))
    return folder / model.name, springs


def _check_target(place: Path, model: Path, holder: Path) -> None:
    root = read_xml(model)
    named = _named_files(root)
    included = [] if root.tag in ("robot", "sdf") else include_files(root, model.parent)
    for read in (holder, *(model.parent / name for name in included)):
        _check_apart(place, read)
    if holder != model:
        if holder.suffix.lower() != model.suffix.lower() == place.suffix.lower():
            raise ValueError(
                f"written must be a YAML file, got {shown(str(place))}: {model.name} has no springs, those "
                f"in {holder.name} are written"
            )
        return
    if named and place.parent.resolve() != model.parent.resolve():
        raise ValueError(
            f"written must be in the folder of {model.name}, which names files beside it ({named}), got "
            f"{shown(str(place))}"
        )


def _named_files(root: XmlElement) -> str:
    """Return where a model first names a file by a path from its own folder, empty if it does nowhere."""
    waiting = [root]
    while waiting:
        element = waiting.pop()
        said = [element.attributes.get(key, "") for key in ("file", "filename")]
        said += [element.text.strip()] if element.tag == "uri" else []
        if any(name and "://" not in name and not os.path.isabs(name) for name in said):
            return element.where
        waiting += element.children[::-1]
    return ""


def _check_promise(model: Path, found: Audit, chosen: Suggestion, read_back: Audit) -> None:
    """Refuse a file whose audit does not give what the suggestion promises."""
    due = found.angular_frequency / (1 + found.errors) * (1 + chosen.errors)
    same = (
        read_back.boundary == found.boundary
        and np.allclose(read_back.joint_stiffness, chosen.joint_stiffness, rtol=_ROUNDING, atol=0)
        and np.allclose(read_back.angular_frequency, due, rtol=_ROUNDING, atol=0, equal_nan=True)
    )
    if not same:
        raise BadModel(
            f"{model}: springs of {chosen.name} cannot be written: read back, the file does not give their "
            f"frequencies but {read_back.remark}"
        )
