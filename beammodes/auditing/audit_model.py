"""Audits of model files: the chain in an MJCF, URDF, SDFormat or CSV file, beside its beam."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from beammodes.auditing.audit import Audit, StepVerdict, audit_chain, listed_errors
from beammodes.auditing.body_tree import FileStep, Model
from beammodes.auditing.bounded_xml import BadModel, read_xml
from beammodes.auditing.judged_pieces import UNKNOWN, longest_step
from beammodes.auditing.model_ends import (
    JudgedChain,
    Piece,
    PlanarChain,
    Spring,
    judged_chains,
    with_wall_hinges,
)
from beammodes.auditing.planar_chain import far_end, planar_chain
from beammodes.auditing.read_mjcf import read_mjcf
from beammodes.auditing.read_sdf import read_sdf
from beammodes.auditing.read_urdf import read_springs, read_urdf
from beammodes.auditing.serial_chains import (
    Frame,
    HingePath,
    RootSupport,
    about_one_axis,
    bending_carrier,
    chosen_path,
    floats,
    frame_of,
    hinge_paths,
    root_support,
    shared_hub,
    shown_axes,
    with_inner_motors_held,
)
from beammodes.chains.chain import Chain
from beammodes.checks import choice, shown, small_fraction
from beammodes.exporters.chain_csv import read_chain_csv
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.loading import Load

__all__ = ["audit_file"]


_LISTED = 5
#: Longer chains take minutes.
_MOST_PIECES = 10_000
_OUT_OF_RANGE = (ArithmeticError, np.linalg.LinAlgError)


@dataclass(frozen=True)
class _Read:
    """Readings of one chain in its plane, the likeliest first, and what to say of how it was read."""

    chains: tuple[PlanarChain, ...]
    given: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    step: FileStep | None = None
    gravity: tuple[float, float] = (0.0, 0.0)
    plane: tuple[str, float] = ("", 0.0)


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

    Where the beam ends is told by matter: an outer piece that is made as its neighbour is a segment, and what
    more it has is a body. The beam's length does not decide that, nor does where in the world the chain is.

    Parameters
    ----------
    path : str or Path
    beam : Beam
        The uniform beam that the chain stands for.
    boundary : str, pair or Boundary, optional
        Its ends. By default those of the file: held where the ground carries the chain, pinned on a hinge
        without a spring, free at the tip unless fixed tendons support it, with a body where an outer piece is
        heavier than its neighbours. Your word counts for what a file cannot say: that a motor holds its
        joint, such as an elbow between two flexible links, or that a body which moves is held.
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
    small_fraction("tolerance", tolerance)
    given = None if boundary is None else Boundary.of(boundary)
    place = Path(path)
    try:
        read = _read(place, beam, given, chain, plane, None if springs is None else Path(springs))
        if given is None:
            return _as_the_file_says(beam, read, modes, tolerance)
        audits = [_audited(beam, read, each, modes, tolerance) for each in _readings(read, given)]
    except BadModel as error:
        raise BadModel(f"{place}: {error}") from None
    except _OUT_OF_RANGE as error:
        raise BadModel(f"{place}: numbers are too large, too small or too far apart: {error}") from None
    # What was taken out of the wrong end leaves a spring of no rule there, or a piece of another mass.
    return min(audits, key=lambda pair: (pair[0].layout == UNKNOWN, pair[1]))[0]


def _as_the_file_says(beam: Beam, read: _Read, modes: int, tolerance: float) -> Audit:
    """Return the audit of the likeliest reading, with what others come to."""
    found, others = None, []
    for chain in read.chains:
        (judged,) = judged_chains(chain, None)
        try:
            audit, _ = _audited(beam, read, judged, modes, tolerance)
        except BadModel:
            if found is None:
                raise
            continue
        if found is None:
            found = audit
        else:
            others.append(_other(audit, chain))
    assert found is not None
    return replace(found, other_readings=tuple(others))


def _readings(read: _Read, given: Boundary) -> list[JudgedChain]:
    """Return the chain's first reading that `given` fits, with these ends."""
    refusals = []
    for chain in read.chains:
        try:
            return judged_chains(chain, given)
        except ValueError as error:
            refusals.append(error)
    raise refusals[0]


def _audited(
    beam: Beam, read: _Read, judged: JudgedChain, modes: int, tolerance: float
) -> tuple[Audit, float]:
    """Return the audit of one reading, and how uneven its pieces are."""
    columns = _columns(judged.pieces)
    springs = {
        "joint_stiffness": [spring.stiffness for spring in judged.springs],
        "armature": [spring.armature for spring in judged.springs],
        "damping": [spring.damping for spring in judged.springs],
    }
    left_out = list(read.left_out)
    try:
        # Numbers that are too far apart for each other end here, not in results that are none.
        with np.errstate(divide="raise", invalid="raise"):
            if any(springs["damping"]) and _in_series(columns, springs["joint_stiffness"], judged.boundary):
                left_out.append("damping is left out here: a hinge is in series with a support's spring")
                springs["damping"] = [0.0] * len(judged.springs)
            found = audit_chain(beam, judged.boundary, **columns, **springs, modes=modes, tolerance=tolerance)
            step = _step(read, judged, columns, springs)
    except (ValueError, *_OUT_OF_RANGE) as error:
        first, last = judged.springs[0].name, judged.springs[-1].name
        raise BadModel(f"chain from hinge {first} to hinge {last} cannot be judged: {error}") from None
    ends = () if judged.said else (f"ends {judged.boundary.name}, as far as the file tells",)
    return replace(
        found,
        hinge_names=tuple(spring.name for spring in judged.springs),
        given=(*read.given, *((f"ends {judged.boundary.name}",) if judged.said else ())),
        assumed=(*judged.assumed, *ends, *left_out),
        step=step,
    ), judged.unevenness


def _in_series(columns: dict[str, list[float]], springs: list[float], boundary: Boundary) -> bool:
    """Whether the chain has put one of these springs in series with that of a support."""
    return Chain.from_pieces(**columns, joint_stiffness=springs, boundary=boundary).pieces != len(springs) + 1


def _other(found: Audit, chain: PlanarChain) -> str:
    hertz = ", ".join(f"{value / (2 * math.pi):.5g}" for value in found.angular_frequency if value == value)
    return (
        f"another reading: {chain.assumed[0]}: {found.boundary.name}, {hertz} Hz, "
        f"{listed_errors(found.errors)}; "
        f'say boundary "{found.boundary.name}" to have it judged so'
    )


def _step(
    read: _Read, judged: JudgedChain, columns: dict[str, list[float]], springs: dict[str, list[float]]
) -> StepVerdict | None:
    if read.step is None:
        return None
    chain = Chain.from_pieces(**columns, joint_stiffness=springs["joint_stiffness"], boundary=judged.boundary)
    load = Load(gravity=read.gravity)
    armature, damping = (np.array(springs[name]) for name in ("armature", "damping"))
    limit = longest_step(chain, armature, damping, read.step, load)
    return StepVerdict(read.step.timestep, limit, read.step.integrator, any(read.gravity))


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
    held, motors = with_inner_motors_held(model) if given is not None else (model, [])
    if not motors:
        return _in_any_plane(model, beam, given, name, plane)
    reads: list[_Read] = []
    why = f"{' and '.join(motors)} held, because you say so"
    for each, said in ((model, ()), (held, (why,))):
        try:
            found = _in_any_plane(each, beam, given, name, plane)
            reads.append(replace(found, left_out=(*said, *found.left_out)))
        except ValueError as error:
            refusal = error
    if not reads:
        raise refusal
    # What carries an elbow may be a part of the beam or what holds it: the length says which is meant.
    off = [abs(sum(p.length for p in read.chains[0].pieces) / beam.length - 1) for read in reads]
    return reads[0] if len(reads) == 1 or off[0] <= off[1] + 1e-6 else reads[1]


def _in_any_plane(
    model: Model, beam: Beam, given: Boundary | None, name: str | None, plane: str | None
) -> _Read:
    try:
        return _of_model(model, beam, given, name, plane)
    except ValueError as error:
        apart = _axis_by_axis(model, beam, given, name, plane)
        if apart is None:
            raise error from None
        return apart


def _axis_by_axis(
    model: Model, beam: Beam, given: Boundary | None, name: str | None, plane: str | None
) -> _Read | None:
    """Return the chain about one axis alone, hinges at right angles to it at rest; None if there is none.

    Bending about one axis does not move what hinges about others turn, if all matter is on the line and lies
    along the axes: so it is with hinges by turns about two axes, and with cross-pieces of universal joints.
    """
    found: dict[str, tuple[float, _Read]] = {}
    for axis, reduced in about_one_axis(model):
        try:
            read = _of_model(reduced, beam, given, name, None)
        except ValueError:
            continue
        label, distance = read.plane
        if label in found:
            return None
        names = ", ".join(shown_axes(model, axis))
        why = f"hinges about other axes ({names}) are taken as at rest, as bending about one leaves them"
        found[label] = (distance, replace(read, left_out=(why, *read.left_out)))
    if plane is not None:
        return found[plane][1] if plane in found else None
    return min(found.values(), key=lambda each: each[0])[1] if found else None


def _of_model(model: Model, beam: Beam, given: Boundary | None, name: str | None, plane: str | None) -> _Read:
    paths = hinge_paths(model)
    path = chosen_path(paths, name)
    try:
        return _of_path(model, paths, path, beam, given, plane)
    except BadModel as error:
        others = _others(paths, path)
        if not others or name is not None:
            raise
        raise BadModel(f"{error}; {others[0]}: say by chain which one is the beam") from None


def _of_path(
    model: Model,
    paths: Sequence[HingePath],
    path: HingePath,
    beam: Beam,
    given: Boundary | None,
    plane: str | None,
) -> _Read:
    planes = _labelled([frame_of(path, axis) for axis in path.planes()])
    if not planes:
        raise BadModel(f"hinges of the chain at {path.name} must be parallel")
    if plane is not None:
        frame = planes[choice("plane", plane, planes)]
    else:
        frame = min(planes.values(), key=lambda each: _distance(each, beam))
    held = [why for body, why in model.held if path.has_body(body) or body in _joint_names(frame)]
    if given is None and held:
        raise BadModel(f"{held[0]} holds the chain: say by boundary what its ends are")
    if given is None and floats(path.root):
        raise BadModel(
            f"body {path.root.name}, which carries the chain at body {path.name}, is free in space and "
            "moves with "
            "all that it carries: say by boundary what the chain's ends are, such as clamped-free if the "
            "body is "
            "held"
        )
    carrier = bending_carrier(path, frame) if given is None else None
    if carrier is not None:
        elbow, spring = (joint.name for joint in carrier)
        raise BadModel(
            f"{elbow}, which carries the chain at body {path.name}, has no spring and is carried by hinge "
            f"{spring} with a spring: say by boundary what the chain's ends are; a motor between hinges with "
            "springs is then held, and all bend as one chain"
        )
    moves = shared_hub(path, frame) if given is None else None
    if moves is not None:
        raise BadModel(
            f"body {path.root.name}, which carries the chain at body {path.name}, moves on joint "
            f"{moves.name} with other springs that it carries: say by boundary what the chain's ends are, "
            "such as clamped-free if the body is held"
        )
    words = _words(path, frame, given)
    far = far_end(model.ties, *_coordinates(frame, root_support(path, frame) if "" in words else None))
    chains = [
        with_wall_hinges(planar_chain(path, frame, far, beam.length, word), far.spring, beam.length)
        for word in words
    ]
    along = float(model.gravity @ frame.along)
    across = float(np.linalg.norm(model.gravity - along * frame.along))
    return _Read(
        tuple(chains),
        (*_given(path, planes, frame), *_others(paths, path)),
        (*model.notes, *_undamped(model, frame), *held),
        model.step,
        (along, across if across > 1e-9 * abs(along) else 0.0),
        (next(label for label, each in planes.items() if each is frame), _distance(frame, beam)),
    )


def _undamped(model: Model, frame: Frame) -> list[str]:
    names = _joint_names(frame)
    damped = [tie for tie in model.ties if tie.damping and names & dict(tie.terms).keys()]
    return [f"the damping of tendon {tie.name} is left out" for tie in damped]


def _words(path: HingePath, frame: Frame, given: Boundary | None) -> list[str]:
    """Return why what carries the chain is held, for each reading; "" where it moves as its joints let it.

    A file does not say whether a motor holds its joint: the user does.
    """
    try:
        support = root_support(path, frame)
    except BadModel:
        # What carries the chain on joints that are not read is no matter if it is held.
        if given is None or not any(
            end.holds_deflection and end.holds_rotation for end in (given.left, given.right)
        ):
            raise
        names = " and ".join(joint.name for joint in path.root.joints)
        return [f"{names} held, because you say so"]
    if support is None:
        carrier = path.root
        moves = carrier.parent is not None
        return [f"body {carrier.name}, which carries the chain and moves, is taken as held" if moves else ""]
    loose = [
        joint.name
        for joint in path.root.joints
        if not joint.stiffness and (joint in (support.hinge, support.slide) or joint.kind == "free")
    ]
    if not loose:
        return [""]
    if given is not None:
        return ["", f"{' and '.join(loose)} held, because you say so"]
    return ["", f"{loose[0]} held, as by a motor"] if support.hinge and len(loose) == 1 else [""]


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
    return read_mjcf(root, place.parent)


def _labelled(frames: Sequence[Frame]) -> dict[str, Frame]:
    """Return frames by the axis along which they deflect; of two alike, each has a letter of its own."""
    found: dict[str, Frame] = {}
    for frame in frames:
        order = np.argsort(-np.abs(frame.across).round(6), kind="stable")
        found[next(letter for letter in ("xyz"[i] for i in order) if letter not in found)] = frame
    return found


def _distance(frame: Frame, beam: Beam) -> float:
    """Return how far a plane's springs are from EI/ell, as a logarithm."""
    stiffness = float(np.median([hinge.stiffness for hinge in frame.hinges]))
    return abs(math.log(stiffness * (frame.spacing or beam.length) / beam.mean_bending_stiffness))


def _joint_names(frame: Frame) -> set[str]:
    return {hinge.name for hinge in frame.hinges}


def _coordinates(
    frame: Frame, support: RootSupport | None
) -> tuple[dict[str, tuple[float, float]], dict[str, float]]:
    """Return place and sense of every joint that turns the chain, and the sense of those that shift it."""
    joints = [*frame.hinges]
    if support is not None and support.hinge is not None:
        joints.insert(0, support.hinge)
    hinges = {
        joint.name: (frame.place(joint.position), 1.0 if joint.axis @ frame.axis > 0 else -1.0)
        for joint in joints
    }
    slides = [support.slide] if support is not None and support.slide is not None else []
    return hinges, {joint.name: 1.0 if joint.axis @ frame.across > 0 else -1.0 for joint in slides}


def _given(path: HingePath, planes: dict[str, Frame], frame: Frame) -> tuple[str, ...]:
    count = len(path.groups)
    found = [f"chain at body {path.name}: {count} hinge{'s' * (count > 1)} with springs"]
    if len(planes) > 1:
        label = next(letter for letter, each in planes.items() if each is frame)
        found.append(f"deflection along {label}; there are hinges for {', '.join(planes)}")
    return tuple(found)


def _others(paths: Sequence[HingePath], path: HingePath) -> list[str]:
    others = [each.name for each in paths if each is not path]
    more = ", ..." if len(others) > _LISTED else ""
    return [f"other chains in the file: {', '.join(others[:_LISTED])}{more}"] if others else []


def _from_csv(place: Path, length: float) -> _Read:
    try:
        chain = read_chain_csv(place)
    except ValueError as error:
        raise BadModel(str(error).removeprefix(str(place)).lstrip(":, ")) from None
    if chain.pieces > _MOST_PIECES:
        raise BadModel(f"must have at most {_MOST_PIECES} pieces to be judged, got {chain.pieces}")
    columns = (chain.length, chain.mass, chain.centre, chain.rotary_inertia)
    pieces = tuple(Piece(*row) for row in zip(*(column.tolist() for column in columns), strict=True))
    springs = tuple(Spring(f"hinge {i}", value) for i, value in enumerate(chain.joint_stiffness.tolist()))
    near, far = (tuple(map(float, end)) for end in chain.support_stiffness)
    planar = PlanarChain(pieces, springs, (near[0], near[1]), (far[0], far[1]), Spring("left end", near[1]))
    return _Read((with_wall_hinges(planar, "right end", length),))
