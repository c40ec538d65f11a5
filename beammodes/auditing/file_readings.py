"""The chains in a model file, in one plane, in every way that the file may be read.

A file does not say whether a motor holds its joint, nor, of hinges about two axes, which plane is meant.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

import numpy as np

from beammodes.auditing.body_tree import FileStep, Model, ModelRod
from beammodes.auditing.bounded_xml import BadModel, UnexpandedModel, XmlElement, read_xml
from beammodes.auditing.expand_with_mujoco import expanded_by_mujoco, needs_mujoco, with_places_of_no_file
from beammodes.auditing.model_ends import ended_chains
from beammodes.auditing.mujoco_flex import rod_in_plane, told_of_points
from beammodes.auditing.planar_chain import (
    Piece,
    PlanarChain,
    Spring,
    behind_sprung_hub,
    far_end,
    hub_of,
    planar_chain,
    with_wall_hinges,
)
from beammodes.auditing.read_mjcf import include_files, read_mjcf
from beammodes.auditing.read_sdf import read_sdf
from beammodes.auditing.read_urdf import read_springs, read_urdf
from beammodes.auditing.rest_pose import in_rest_pose
from beammodes.auditing.serial_chains import (
    HingeLine,
    HingePath,
    about_one_axis,
    check_carrier,
    chosen_path,
    hinge_line,
    hinge_paths,
    letters_of,
    root_support,
    with_motors_held,
    without_stretch,
)
from beammodes.auditing.touching import touching_remark
from beammodes.checks import choice, shown
from beammodes.exporters.chain_csv import read_chain_csv
from beammodes.numerics.arrays import Floats
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary

__all__ = ["Readings", "Request", "answer_of_file", "readings_of", "readings_of_file", "rod_meant"]

_T = TypeVar("_T")
_LISTED = 5
#: A straight chain deflects in two planes.
_ALL_PLANES = 2
_OTHER_PLANES = "say by plane which is meant; motion space judges all together"
#: Longer chains take minutes.
_MOST_PIECES = 10_000


@dataclass(frozen=True)
class Request:
    """The chain that the user asks for."""

    beam: Beam
    boundary: Boundary | None
    chain: str | None
    plane: str | None


@dataclass(frozen=True)
class Readings:
    """Readings of one chain in its plane, the likeliest first, and what to say of how it was read."""

    chains: tuple[PlanarChain, ...]
    given: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    step: FileStep | None = None
    gravity: tuple[float, float] = (0.0, 0.0)
    plane: str = ""
    #: Difference of the plane's springs from EI/ell, as a logarithm.
    distance: float = 0.0
    #: Of the part across the chain, what bends it in its plane [m/s²].
    sagging: float = 0.0
    #: The share of the chain's mass that is in round caps of capsules.
    caps: float = 0.0
    #: The direction of the deflection.
    across: Floats | None = None


def readings_of_file(place: Path, asked: Request, springs: Path | None) -> Readings:
    """Return the readings of the chain that is asked for; `springs` is the file with those of a URDF file."""
    if place.suffix.lower() == ".csv":
        return _from_csv(place, asked.beam.length)
    return answer_of_file(place, springs, lambda model: _without_stretch(model, asked))


def _without_stretch(model: Model, asked: Request) -> Readings:
    model, slides = without_stretch(model)
    if not slides:
        return _of_file(model, asked)
    why = (
        f"slides along the chain ({_few(slides)}) are taken as at rest: stretch and bending do not move each "
        "other"
    )
    read = _of_file(model, asked)
    return replace(read, left_out=(why, *read.left_out))


def _few(names: Sequence[str]) -> str:
    return ", ".join([*names[:_LISTED], *(["..."] if len(names) > _LISTED else [])])


def _of_file(model: Model, asked: Request) -> Readings:
    held, motors = with_motors_held(model)
    if not motors:
        return _in_any_plane(model, asked)
    if asked.boundary is None:
        try:
            return _in_any_plane(model, asked)
        except BadModel as error:
            raise BadModel(f"{error}{_if_held(held, motors, asked)}") from None
    reads: list[Readings] = []
    why = f"{' and '.join(motors)} held, because you say so"
    for each, said in ((model, ()), (held, (why,))):
        try:
            found = _in_any_plane(each, asked)
            reads.append(replace(found, left_out=(*said, *found.left_out)))
        except ValueError as error:
            refusal = error
    if not reads:
        raise refusal
    # What carries an elbow may be a part of the beam or what holds it: the length says which is meant.
    off = [abs(sum(p.length for p in read.chains[0].pieces) / asked.beam.length - 1) for read in reads]
    return reads[0] if len(reads) == 1 or off[0] <= off[1] + 1e-6 else reads[1]


def _if_held(model: Model, motors: Sequence[str], asked: Request) -> str:
    """Return what the boundary is if motors hold these joints, empty if that makes no chain either."""
    try:
        name = ended_chains(_in_any_plane(model, asked).chains[0], None)[0].boundary.name
    except ValueError:
        return ""
    return f'; with {" and ".join(motors)} held it is "{name}"'


def _from_csv(place: Path, length: float) -> Readings:
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
    turns = near[0] == math.inf > near[1] and len(pieces) > 2 and pieces[0].length > 0
    planar = PlanarChain(
        pieces,
        springs,
        (near[0], near[1]),
        (far[0], far[1]),
        Spring("left end", near[1]),
        hub=hub_of(pieces[0], pieces[1], length - sum(p.length for p in pieces[1:])) if turns else 0.0,
    )
    return Readings((with_wall_hinges(planar, Spring("right end", 0.0), length),))


def answer_of_file(place: Path, springs: Path | None, answer: Callable[[Model], _T]) -> _T:
    """Return the answer to a model file, or to what MuJoCo makes of one that is refused without it."""
    root = read_xml(place)
    try:
        return answer(in_rest_pose(_model(root, place, springs)))
    except BadModel as error:
        if root.tag not in ("mujoco", "mujocoinclude"):
            raise
        element = needs_mujoco(root) or ("its replicates" if isinstance(error, UnexpandedModel) else "")
        if not element:
            raise
        # A traceback holds the tree, which a large file should not be in memory with twice.
        refusal = error.with_traceback(None)
    # The tree that was read has its cables expanded.
    del root
    root = read_xml(place)
    include_files(root, place.parent)
    try:
        expanded, version = expanded_by_mujoco(root, place, include_files)
    except BadModel as why:
        raise BadModel(f"{refusal}; {why}") from None
    read = read_mjcf(expanded, place.parent)
    return answer(in_rest_pose(with_places_of_no_file(read, version, element)))


def _model(root: XmlElement, place: Path, springs: Path | None) -> Model:
    if root.tag == "robot":
        beside = place.with_name(f"{place.name.removesuffix('.urdf')}.springs.yaml")
        file = springs or (beside if beside.is_file() else None)
        return read_urdf(root, read_springs(file) if file else {})
    if springs is not None:
        raise ValueError(
            f"springs must be left out: only URDF has them in a file apart, got {shown(str(springs))}"
        )
    return read_sdf(root) if root.tag == "sdf" else read_mjcf(root, place.parent)


def _in_any_plane(model: Model, asked: Request) -> Readings:
    try:
        return readings_of(model, asked)
    except ValueError as error:
        apart = _axis_by_axis(model, asked)
        if apart is None:
            raise error from None
        return apart


def _axis_by_axis(model: Model, asked: Request) -> Readings | None:
    """Return the chain about one axis alone, hinges at right angles to it at rest; None if there is none.

    Bending about one axis does not move what hinges about others turn, if all matter is on the line and lies
    along the axes: so it is with hinges by turns about two axes, and with cross-pieces of universal joints.
    """
    reads: list[Readings] = []
    for names, reduced in about_one_axis(model):
        try:
            read = readings_of(reduced, replace(asked, plane=None))
        except ValueError:
            continue
        why = (
            f"hinges about other axes ({names}) are taken as at rest, as bending about one leaves them; what "
            "they turn, such as twist, may need a shorter step"
        )
        reads.append(replace(read, left_out=(why, *read.left_out)))
    if not reads or len(reads) > _ALL_PLANES:
        return None
    directions = [read.across for read in reads if read.across is not None]
    found = dict(zip(letters_of(directions), reads, strict=True))
    if asked.plane is not None:
        return found[choice("plane", asked.plane, found)]
    likeliest = min(found, key=lambda plane: found[plane].distance)
    if len(found) == 1:
        return found[likeliest]
    planes = ", ".join(sorted(found))
    said = f"deflection along {likeliest}; there are hinges for {planes}: {_OTHER_PLANES}"
    return replace(found[likeliest], given=(*found[likeliest].given, said))


def readings_of(model: Model, asked: Request) -> Readings:
    """Return the readings of the chain that is asked for, its slides and motors as the model has them."""
    rod = rod_meant(model, asked.chain)
    if rod is not None:
        return _of_rod(model, rod, asked)
    paths = hinge_paths(model)
    path = chosen_path(paths, asked.chain)
    names = [each.name for each in paths if each is not path]
    more = ", ..." if len(names) > _LISTED else ""
    others = f"other chains in the file: {', '.join(names[:_LISTED])}{more}" if names else ""
    same = all(each.root is path.root and len(each.groups) == 1 for each in paths)
    if same and len(paths) > 2:
        others += (
            "; these bodies are not nested: each is a link of its own on the same parent, so "
            "none carries the next (a chain has each body inside the one before it)"
        )
    try:
        read = _of_path(model, path, asked)
    except BadModel as error:
        if not others or asked.chain is not None:
            raise
        raise BadModel(f"{error}; {others}: say by chain which one is the beam") from None
    return replace(read, given=(*read.given, others)) if others else read


def rod_meant(model: Model, name: str | None) -> ModelRod | None:
    """Return the rod of points that is meant: the one of that name, or the longest if nothing has springs."""
    for rod in model.rods:
        if name is not None and rod.has(name):
            return rod
    if not model.rods or any(joint.is_sprung for body in model.bodies for joint in body.joints):
        return None
    if name is not None:
        choice("chain", name, [rod.name for rod in model.rods])
    return max(model.rods, key=lambda rod: len(rod.points))


def _of_rod(model: Model, rod: ModelRod, asked: Request) -> Readings:
    if rod.refusal:
        raise BadModel(rod.refusal)
    planes = dict(zip(letters_of(rod.across), (0, 1), strict=True))
    off = [abs(math.log(rigidity / asked.beam.mean_bending_stiffness)) for rigidity in rod.rigidity]
    label = min(planes, key=lambda each: off[planes[each]])
    if asked.plane is not None:
        label = choice("plane", asked.plane, planes)
    held = [why for name, why in model.held if rod.has(name)]
    if held and asked.boundary is None:
        raise BadModel(f"{held[0]} holds the rod: say by boundary what its ends are")
    others = [each.name for each in model.rods if each is not rod][:_LISTED]
    points = told_of_points(rod, asked.beam.mean_mass_per_length)
    said = [*rod.given, *points, f"deflection along {label}; there are springs for {', '.join(planes)}"]
    said += [f"other rods in the file: {', '.join(others)}"] if others else []
    pull = np.cross(*rod.across) @ model.gravity
    across = float(np.linalg.norm([each @ model.gravity for each in rod.across]))
    return Readings(
        (rod_in_plane(rod, planes[label]),),
        tuple(said),
        (*model.left_out, *rod.notes, *held),
        _rod_step(model.step, rod),
        (float(pull), across),
        label,
        off[planes[label]],
        sagging=abs(float(rod.across[planes[label]] @ model.gravity)),
    )


def _rod_step(step: FileStep | None, rod: ModelRod) -> FileStep | None:
    """Return the file's step with a record that takes a flex's damping as MuJoCo does, explicitly.

    MuJoCo 4 does not move flexes by its implicit integrators.
    """
    if step is None or step.integrator.startswith("implicit"):
        return None
    if not rod.damping or step.integrator != "Euler":
        return step
    return replace(step, record="semi_implicit_euler")


def _of_path(model: Model, path: HingePath, asked: Request) -> Readings:
    beam, given = asked.beam, asked.boundary
    planes = _labelled([hinge_line(path, axis) for axis in path.axes()])
    if not planes:
        raise BadModel(f"hinges of the chain at {path.name} must be parallel")
    if asked.plane is not None:
        label = choice("plane", asked.plane, planes)
    else:
        label = min(planes, key=lambda each: _distance(planes[each], beam))
    line = planes[label]
    hub = behind_sprung_hub(path, line.axis, beam.length) if given is None or given.left.hub_radius else None
    if hub is not None:
        path, line = hub, hinge_line(hub, line.axis)
    names = {hinge.name for hinge in line.hinges}
    root = path.root
    tied = {joint.name for joint in root.joints} | {body.name for body in root.bodies if root.joints}
    held = [why for name, why in model.held if path.has_body(name) or name in names | tied]
    if given is None:
        if held:
            raise BadModel(f"{held[0]} holds the chain: say by boundary what its ends are")
        check_carrier(path, line)
    words = _words(path, line, given)
    far = far_end(model.ties, line, root_support(path, line) if "" in words else None)
    chains = [planar_chain(path, line, far, beam.length, word) for word in words]
    count = len(path.groups)
    said = [*model.given, f"chain at body {path.name}: {count} hinge{'s' * (count > 1)} with springs"]
    if len(planes) > 1:
        said.append(f"deflection along {label}; there are hinges for {', '.join(planes)}: {_OTHER_PLANES}")
    loose = [
        joint.name
        for group in path.groups
        for joint in group.joints
        if joint.kind == "hinge" and not joint.is_sprung and joint.name not in names
    ]
    floppy = [
        f"hinges without a spring about other axes ({_few(loose)}) are taken as at rest: nothing holds them"
    ]
    balls = [group.name for group in path.groups if any(joint.kind == "ball" for joint in group.joints)]
    twist = [
        "balls let the chain twist too, which bending does not move: twist may need a shorter step; "
        'motion="space" judges all that the chain does'
    ]
    damped = [tie.name for tie in model.ties if tie.damping and names & dict(tie.terms).keys()]
    touching = touching_remark(model, path, line)
    undamped = [f"the damping of tendon {name} is left out" for name in damped]
    # Poses of files turn gravity by their rounding.
    pull = model.gravity
    none = 1e-9 * float(np.linalg.norm(pull))
    along, sagging = (part if abs(part) > none else 0.0 for part in (pull @ line.along, pull @ line.across))
    across = float(np.linalg.norm(pull - along * line.along))
    return Readings(
        tuple(chains),
        tuple(said),
        (
            *model.left_out,
            *undamped,
            *(twist if balls else []),
            *(floppy if loose else []),
            *(f"{why} is taken as what holds the ends that you say" for why in dict.fromkeys(held)),
            *([touching] if touching else []),
        ),
        model.step,
        (float(along), across if across > none else 0.0),
        label,
        _distance(line, beam),
        abs(float(sagging)),
        _caps(path),
        line.across,
    )


def _words(path: HingePath, line: HingeLine, given: Boundary | None) -> list[str]:
    """Return why what carries the chain is held, for each reading; "" where it moves as its joints let it.

    A file does not say whether a motor holds its joint: the user does.
    """
    root = path.root
    try:
        support = root_support(path, line)
    except BadModel:
        # What carries the chain on joints that are not read does not matter if it is held.
        ends = () if given is None else (given.left, given.right)
        if not any(end.holds_deflection and end.holds_rotation for end in ends):
            raise
        sprung = [joint for joint in root.joints if joint.is_sprung]
        if sprung and any(joint.kind == "slide" and not joint.is_sprung for joint in root.joints):
            # A motor that shifts the first link holds the slide, not the springs on which that link turns.
            raise
        return [f"{' and '.join(joint.name for joint in root.joints)} held, because you say so"]
    if support is None:
        moves = root.parent is not None
        return [f"body {root.name}, which carries the chain and moves, is taken as held" if moves else ""]
    own = {joint.name for joint in (support.hinge, support.slide) if joint}
    loose = [
        joint.name
        for joint in root.joints
        if not joint.stiffness and (joint.name in own or joint.kind == "free")
    ]
    if not loose:
        return [""]
    if given is not None:
        return ["", f"{' and '.join(loose)} held, because you say so"]
    return ["", f"{loose[0]} held, as by a motor"] if support.hinge and len(loose) == 1 else [""]


def _labelled(lines: Sequence[HingeLine]) -> dict[str, HingeLine]:
    """Return lines by the axis along which they deflect; of two alike, each has a letter of its own."""
    return dict(zip(letters_of([line.across for line in lines]), lines, strict=True))


def _distance(line: HingeLine, beam: Beam) -> float:
    """Return the difference of a plane's springs from EI/ell, as a logarithm."""
    stiffness = float(np.median([hinge.stiffness for hinge in line.hinges]))
    return abs(math.log(stiffness * (line.spacing or beam.length) / beam.mean_bending_stiffness))


def _caps(path: HingePath) -> float:
    bodies = [body for group in path.groups for body in group.bodies]
    mass = sum(body.inertial.mass for body in bodies)
    return sum(body.caps for body in bodies) / mass if mass else 0.0
