"""Audits of model files: the chain in an MJCF, URDF, SDFormat or CSV file, beside its beam."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from beammodes.auditing.audit import UNKNOWN, Audit, audit_chain
from beammodes.auditing.body_tree import Model
from beammodes.auditing.bounded_xml import BadModel, bounded_bytes, read_xml
from beammodes.auditing.far_ties import far_end
from beammodes.auditing.hinge_line import Frame, frame_of, moves_alone, root_support
from beammodes.auditing.model_ends import JudgedChain, judged_chains
from beammodes.auditing.planar_chain import planar_chain
from beammodes.auditing.read_mjcf import read_mjcf
from beammodes.auditing.read_sdf import read_sdf
from beammodes.auditing.read_urdf import read_urdf
from beammodes.auditing.rigid_pieces import Piece, PlanarChain, with_wall_hinges
from beammodes.auditing.serial_chains import HingePath, chosen_path, hinge_paths
from beammodes.auditing.urdf_springs import read_springs
from beammodes.checks import choice, positive_real, shown
from beammodes.exporters.chain_csv import read_chain_csv
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike

__all__ = ["audit_file"]

Array = NDArray[np.float64]

_LISTED = 5


@dataclass(frozen=True)
class _Read:
    """A chain in its plane, and what to say of how it was read."""

    chain: PlanarChain
    notes: tuple[str, ...]


def audit_file(
    path: str | os.PathLike[str],
    beam: Beam,
    boundary: BoundaryLike | None = None,
    *,
    modes: int = 3,
    tolerance: float = 0.01,
    chain: str | None = None,
    plane: str | None = None,
    springs: str | os.PathLike[str] | None = None,
) -> Audit:
    """Judge the chain in a model file: MJCF, URDF, SDFormat, or CSV as `export_chain` writes it.

    A chain is a row of bodies on one straight line, each on a hinge with a spring, all hinges parallel (or
    pairs of hinges about two axes). Files are read without any simulator; what cannot be honoured is refused
    by name. Hostile files are refused within 1.6 s and 120 MB, as measured in the tests.

    Parameters
    ----------
    path : str or Path
    beam : Beam
        The uniform beam that the chain stands for.
    boundary : str, pair or Boundary, optional
        Its ends. By default those of the file: held where the ground carries the chain, free at the tip
        unless fixed tendons support it, with a body where an outer piece is heavier than its neighbours.
    modes, tolerance
        As `audit_chain` takes them.
    chain : str, optional
        Name of a body of the chain to judge; the longest one by default.
    plane : str, optional
        Where hinges bend the chain about two axes, the axis along which it deflects at rest, "x", "y" or "z";
        by default the one whose springs are nearer to the beam's.
    springs : str or Path, optional
        The file with the springs of a URDF file; by default `.springs.yaml` beside it.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or the file holds no chain that can be judged; the message names
        the line or the element.
    OSError
        If it cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> from beammodes.chains.chain import Chain
    >>> from beammodes.exporters.export import export_chain
    >>> beam = Beam(1.2, 85.0, 0.62)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     written = export_chain(Chain(beam, "clamped-free", 10, "rigid_stub"), f"{folder}/cable.xml")
    ...     found = audit_file(f"{folder}/cable.xml", beam)
    >>> print(found.remark)
    first segment is rigid with its parent: rigid_stub, +11 % at N = 10, falls only as 1/N
    """
    if not isinstance(path, str | os.PathLike):
        raise TypeError(f"path must be a string or a Path, got {shown(path)}")
    if not isinstance(beam, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    positive_real("tolerance", tolerance)
    given = None if boundary is None else Boundary.of(boundary)
    place = Path(path)
    try:
        read = _read(place, beam, given, chain, plane, None if springs is None else Path(springs))
        found, judged = _best(beam, judged_chains(read.chain, given), modes, tolerance)
    except BadModel as error:
        raise BadModel(f"{place}: {error}") from None
    ends = f"ends {judged.boundary.name}" + ("" if given else ", as far as the file tells")
    notes = (*read.notes, ends, *filter(None, [judged.assumed]))
    return replace(found, hinge_names=tuple(name for name, _ in judged.springs), notes=notes)


def _best(
    beam: Beam, readings: Sequence[JudgedChain], modes: int, tolerance: float
) -> tuple[Audit, JudgedChain]:
    """Return the reading whose springs follow a rule and whose pieces are even.

    What was taken out of the wrong end leaves a spring of no rule there, or a piece of another mass.
    """
    audits = [
        audit_chain(
            beam,
            judged.boundary,
            **_columns(judged.pieces),
            joint_stiffness=[value for _, value in judged.springs],
            modes=modes,
            tolerance=tolerance,
        )
        for judged in readings
    ]
    pairs = zip(audits, readings, strict=True)
    return min(pairs, key=lambda pair: (pair[0].layout == UNKNOWN, pair[1].unevenness))


def _columns(pieces: Sequence[Piece]) -> dict[str, list[float]]:
    return {
        "length": [piece.length for piece in pieces],
        "mass": [piece.mass for piece in pieces],
        "centre": [piece.centre for piece in pieces],
        "rotary_inertia": [piece.inertia for piece in pieces],
    }


def _read(
    place: Path, beam: Beam, given: Boundary | None, name: str | None, plane: str | None, springs: Path | None
) -> _Read:
    if place.suffix.lower() == ".csv":
        return _from_csv(place, beam.length)
    model = _model(place, springs)
    paths = hinge_paths(model)
    path = chosen_path(paths, name)
    planes = {_label(frame): frame for frame in (frame_of(path, axis) for axis in path.planes())}
    if not planes:
        raise BadModel(f"hinges of the chain at {path.name} must be parallel")
    if plane is not None:
        frame = planes[choice("plane", plane, planes)]
    else:
        frame = min(planes.values(), key=lambda each: _distance(each, beam))
    held = [why for body, why in model.held if path.has_body(body) or body in _joint_names(frame)]
    if held and given is None:
        raise BadModel(f"{held[0]} holds the chain: say by boundary what its ends are")
    far = far_end(model.ties, *_coordinates(path, frame))
    chain = planar_chain(path, frame, far, beam.length)
    support = root_support(path.root, frame)
    near = support.hinge.name if support and support.hinge else "near end"
    full = with_wall_hinges(chain, near, far.spring, beam.length)
    return _Read(full, (*_notes(paths, path, planes, frame), *model.notes, *held))


def _model(place: Path, springs: Path | None) -> Model:
    root = read_xml(place)
    if root.tag == "robot":
        beside = place.with_name(f"{place.name.removesuffix('.urdf')}.springs.yaml")
        file = springs or (beside if beside.is_file() else None)
        return read_urdf(root, read_springs(file) if file else {})
    if springs is not None:
        raise ValueError(
            f"springs must be left out: only URDF has them in a file apart, got {shown(str(springs))}"
        )
    if root.tag == "sdf":
        return read_sdf(root)
    return read_mjcf(root)


def _label(frame: Frame) -> str:
    return "xyz"[int(np.argmax(np.abs(frame.across)))]


def _distance(frame: Frame, beam: Beam) -> float:
    """Return how far a plane's springs are from EI/ell, as a logarithm."""
    stiffness = float(np.median([hinge.stiffness for hinge in frame.hinges]))
    return abs(math.log(stiffness * (frame.spacing or beam.length) / beam.mean_bending_stiffness))


def _joint_names(frame: Frame) -> set[str]:
    return {hinge.name for hinge in frame.hinges}


def _coordinates(path: HingePath, frame: Frame) -> tuple[dict[str, tuple[float, float]], dict[str, float]]:
    """Return place and sense of every joint that turns the chain, and the sense of those that shift it."""
    support = root_support(path.root, frame)
    joints = [*frame.hinges]
    if support is not None and support.hinge is not None:
        joints.insert(0, support.hinge)
    hinges = {
        joint.name: (frame.place(joint.position), 1.0 if joint.axis @ frame.axis > 0 else -1.0)
        for joint in joints
    }
    slides = [support.slide] if support is not None and support.slide is not None else []
    return hinges, {joint.name: 1.0 if joint.axis @ frame.across > 0 else -1.0 for joint in slides}


def _notes(
    paths: Sequence[HingePath], path: HingePath, planes: dict[str, Frame], frame: Frame
) -> tuple[str, ...]:
    count = len(path.groups)
    notes = [f"chain at body {path.name}: {count} hinge{'s' * (count > 1)} with springs"]
    others = [each.name for each in paths if each is not path]
    if others:
        more = ", ..." if len(others) > _LISTED else ""
        notes.append(f"other chains in the file: {', '.join(others[:_LISTED])}{more}")
    if len(planes) > 1:
        notes.append(f"deflection along {_label(frame)}; there are hinges for {', '.join(planes)}")
    if path.root.parent is not None and not moves_alone(path.root):
        notes.append(f"body {path.root.name}, which carries the chain and moves, is taken as held")
    return tuple(notes)


def _from_csv(place: Path, length: float) -> _Read:
    bounded_bytes(place)
    try:
        chain = read_chain_csv(place)
    except ValueError as error:
        raise BadModel(str(error).removeprefix(str(place)).lstrip(":, ")) from None
    columns = (chain.length, chain.mass, chain.centre, chain.rotary_inertia)
    pieces = tuple(Piece(*row) for row in zip(*(column.tolist() for column in columns), strict=True))
    springs = tuple((f"hinge {i}", value) for i, value in enumerate(chain.joint_stiffness.tolist()))
    near, far = (tuple(map(float, end)) for end in chain.support_stiffness)
    planar = PlanarChain(pieces, springs, (near[0], near[1]), (far[0], far[1]))
    return _Read(with_wall_hinges(planar, "left end", "right end", length), ())
