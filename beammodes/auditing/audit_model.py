"""Audits of model files: the chain in an MJCF, URDF, SDFormat or CSV file, beside its beam.

::

    file --read_mjcf, read_urdf, read_sdf--> Model (a tree of bodies)
         --serial_chains--> HingePath on a HingeLine --planar_chain--> PlanarChain (pieces and springs)
         --model_ends--> EndedChain (pieces without the bodies at the ends) --audit--> Audit

A file may be read in more than one way: hinges that only a motor can hold, a chain that bends in two planes.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal, TypeVar, overload

import numpy as np

from beammodes.auditing.audit import Audit, StepVerdict, audit_chain
from beammodes.auditing.axial_audit import AxialAudit
from beammodes.auditing.body_tree import FileStep, Model, ModelRod
from beammodes.auditing.bounded_xml import BadModel, UnexpandedModel, XmlElement, read_xml
from beammodes.auditing.expand_with_mujoco import expanded_by_mujoco, needs_mujoco, with_places_of_no_file
from beammodes.auditing.judged_pieces import UNKNOWN, longest_step
from beammodes.auditing.model_ends import EndedChain, ended_chains
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
from beammodes.auditing.space_audit import SpatialAudit, audit_along, audit_in_space
from beammodes.auditing.told_audit import listed_errors
from beammodes.auditing.touching import touching_remark
from beammodes.auditing.weight_effect import weight_remarks
from beammodes.chains.chain import Chain
from beammodes.checks import choice, instead, percent, shown, small_fraction
from beammodes.exporters.chain_csv import read_chain_csv
from beammodes.numerics.arrays import Floats
from beammodes.problem.axial_ends import AxialBoundary, AxialBoundaryLike
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.loading import Load
from beammodes.problem.motions import MOTIONS
from beammodes.problem.rod import Rod
from beammodes.problem.rod_ends import RodBoundaryLike, RodEnds

__all__ = ["audit_file"]

_T = TypeVar("_T")
_LISTED = 5
#: A straight chain deflects in two planes.
_ALL_PLANES = 2
_OTHER_PLANES = "say by plane which is meant; motion space judges all together"
#: Longer chains take minutes.
_MOST_PIECES = 10_000
_OUT_OF_RANGE = (ArithmeticError, np.linalg.LinAlgError)


@dataclass(frozen=True)
class _Request:
    """The chain that the user asks for."""

    beam: Beam
    boundary: Boundary | None
    chain: str | None
    plane: str | None


@dataclass(frozen=True)
class _Read:
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


@overload
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
    motion: Literal["bending"] = "bending",
) -> Audit: ...


@overload
def audit_file(
    path: str | os.PathLike[str],
    beam: Beam,
    boundary: AxialBoundaryLike | None = None,
    *,
    modes: int = 3,
    tolerance: float = 0.01,
    chain: str | None = None,
    plane: None = None,
    springs: str | os.PathLike[str] | None = None,
    motion: Literal["twist", "stretch"],
) -> AxialAudit: ...


@overload
def audit_file(
    path: str | os.PathLike[str],
    beam: Rod | Beam,
    boundary: RodBoundaryLike | None = None,
    *,
    modes: int = 3,
    tolerance: float = 0.01,
    chain: str | None = None,
    plane: str | None = None,
    springs: str | os.PathLike[str] | None = None,
    motion: Literal["space"],
) -> SpatialAudit: ...


def audit_file(
    path: str | os.PathLike[str],
    beam: Beam | Rod,
    boundary: BoundaryLike | AxialBoundaryLike | RodBoundaryLike | None = None,
    *,
    modes: int = 3,
    tolerance: float = 0.01,
    chain: str | None = None,
    plane: str | None = None,
    springs: str | os.PathLike[str] | None = None,
    motion: str = "bending",
) -> Audit | AxialAudit | SpatialAudit:
    """Judge the chain in a model file: MJCF, URDF, SDFormat, or CSV as `export_chain` writes it.

    A chain is a row of bodies on one straight line, each on a hinge with a spring, all hinges parallel (or
    pairs of hinges about two axes). Files are read without any simulator; what cannot be honoured is refused
    by name. Hostile files are refused within 5 s and 150 MB, as measured in the tests. What only MuJoCo can
    expand (attached models, meshes without inertia, ties between copies) it expands where it is installed, in
    a process that is stopped after 10 s of processor time, or 30 s in all, or at 1 GiB.

    The matter of an outer piece tells where the beam ends: one that is made as its neighbour is a segment,
    and what more it has is a body. The beam's length does not decide that, nor does where in the world the
    chain is.

    Parameters
    ----------
    path : str or Path
    beam : Beam or Rod
        The uniform beam that the chain stands for. For motion "space" a `Rod`, or a `Beam` with its
        torsional_stiffness, and with polar_inertia_per_length where twist is to be judged.
    boundary : str, pair or Boundary, optional
        Its ends; of twist and stretch such as "fixed-free", in space also `RodEnds`. By default those of the
        file: held where the ground carries the chain, pinned on a hinge without a spring, free at the tip
        unless fixed tendons support it, with a body where an outer piece is heavier than its neighbours. Your
        word counts for what a file cannot say: that a motor holds its joint, such as an elbow between two
        flexible links or a hand at the tip, or that a body which moves is held.
    modes, tolerance
        As `audit_chain` takes them.
    chain : str, optional
        Name of a body of the chain to judge; the longest one by default.
    plane : str, optional
        Where hinges bend the chain about two axes, the axis along which it deflects at rest, "x", "y" or "z";
        by default the one whose springs are nearer to the beam's. In space, the axis along which the rod's
        `bending_stiffness` lets it deflect.
    springs : str or Path, optional
        The file with the springs of a URDF file; by default `.springs.yaml` beside it.
    motion : str
        "bending", in one plane; "twist", of hinges or balls about the chain's line; "stretch", of slides
        along it; "space", all that the chain does, each motion told apart.

    Returns
    -------
    Audit, AxialAudit in twist and stretch, or SpatialAudit in space

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
    >>> import beammodes as bm
    >>> beam = bm.Beam(1.2, 85.0, 0.62)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     written = bm.export_chain(bm.Chain(beam, "clamped-free", 10, "rigid_stub"), f"{folder}/cable.xml")
    ...     found = bm.audit_file(f"{folder}/cable.xml", beam)
    >>> print(found.remark)
    first segment is rigid with its parent: rigid_stub, +11 % at N = 10, falls only as 1/N
    """
    if not isinstance(path, str | os.PathLike):
        raise TypeError(f"path must be a string or a Path, got {shown(path)}")
    kind = choice("motion", motion, (*MOTIONS, "space"))
    if not isinstance(beam, Beam) and not (kind == "space" and isinstance(beam, Rod)):
        hint = instead(beam, Rod='a Rod is judged with motion="space"') if kind != "space" else ""
        raise TypeError(f"beam must be a {'Rod or a ' * (kind == 'space')}Beam, got {shown(beam)}{hint}")
    small_fraction("tolerance", tolerance)
    place, file = Path(path), None if springs is None else Path(springs)
    if kind != "bending":
        return _in_motion(place, beam, boundary, kind, chain, plane, file, modes, tolerance)
    assert isinstance(beam, Beam)
    pair = None if boundary is None else Boundary.of(boundary)  # type: ignore[arg-type]
    asked = _Request(beam, pair, chain, plane)
    with _told_of(place):
        return _judged(asked, _read(place, asked, file), modes, tolerance)


@contextmanager
def _told_of(place: Path) -> Iterator[None]:
    """Say of which file a refusal is, and that numbers beyond floats are refused."""
    try:
        yield
    except BadModel as error:
        raise BadModel(f"{place}: {error}") from None
    except _OUT_OF_RANGE as error:
        raise BadModel(f"{place}: numbers are too large, too small or too far apart: {error}") from None


def _in_motion(
    place: Path,
    beam: Beam | Rod,
    boundary: object,
    motion: str,
    chain: str | None,
    plane: str | None,
    springs: Path | None,
    modes: int,
    tolerance: float,
) -> AxialAudit | SpatialAudit:
    """Judge a file in twist, stretch or space."""
    if place.suffix.lower() == ".csv":
        raise ValueError(
            f"motion must be bending for a CSV file, which has a chain of one plane, got {motion}"
        )
    along: AxialBoundary | None = None
    ends: RodEnds | None = None
    judge = beam
    if motion == "space":
        judge = beam if isinstance(beam, Rod) else Rod.from_beam(beam)
        ends = None if boundary is None else RodEnds.of(boundary)  # type: ignore[arg-type]
    else:
        if plane is not None:
            raise ValueError(f"plane must be left out for motion {motion}, got {shown(plane)}")
        MOTIONS[motion].numbers(beam)  # type: ignore[arg-type]
        along = None if boundary is None else AxialBoundary.of(boundary, motion)  # type: ignore[arg-type]

    def in_plane(model: Model, beam: Beam, boundary: Boundary | None, chain: str) -> Audit:
        asked = _Request(beam, boundary, chain, None)
        return _judged(asked, _of_model(model, asked), modes, tolerance)

    def answer(model: Model) -> AxialAudit | SpatialAudit:
        rod = _rod(model, chain)
        if rod is not None:
            raise BadModel(f"flex {rod.name} is judged in bending only: its twist and stretch are left out")
        if isinstance(judge, Beam):
            return audit_along(model, judge, along, motion, chain=chain, modes=modes, tolerance=tolerance)
        return audit_in_space(
            model,
            judge,
            ends,
            chain=chain,
            plane=plane,
            modes=modes,
            tolerance=tolerance,
            in_plane=in_plane,
        )

    with _told_of(place), np.errstate(divide="raise", invalid="raise"):
        return _of_model_file(place, springs, answer)


# From readings to audits.


def _judged(asked: _Request, read: _Read, modes: int, tolerance: float) -> Audit:
    """Return the audit of a chain in one plane as it was read."""
    beam = asked.beam
    if asked.boundary is None:
        return _as_the_file_says(beam, read, modes, tolerance)
    chains = _fitting(read.chains, asked.boundary)
    audits = [(_audited(beam, read, each, modes, tolerance), each.unevenness) for each in chains]
    # What was taken out of the wrong end leaves a spring of no rule there, or a piece of another mass.
    return min(audits, key=lambda pair: (pair[0].layout == UNKNOWN, pair[1]))[0]


def _as_the_file_says(beam: Beam, read: _Read, modes: int, tolerance: float) -> Audit:
    """Return the audit of the likeliest reading, with what others come to."""
    found, *others = [ended_chains(chain, None)[0] for chain in read.chains]
    audit, remarks = _audited(beam, read, found, modes, tolerance), []
    for each in others:
        try:
            other = _audited(beam, read, each, modes, tolerance)
        except BadModel:
            continue
        hertz = [value / (2 * math.pi) for value in other.angular_frequency if not math.isnan(value)]
        remarks.append(
            f"another reading: {each.assumed[0]}: {other.boundary.name}, "
            f"{', '.join(f'{value:.5g}' for value in hertz)} Hz, {listed_errors(other.errors)}; "
            f'say boundary "{other.boundary.name}" to have it judged so'
        )
    return replace(audit, other_readings=tuple(remarks))


def _fitting(chains: Sequence[PlanarChain], given: Boundary) -> list[EndedChain]:
    """Return the chain's first reading that `given` fits, with these ends.

    Readings in which the file itself has such ends come before one whose far end only the word holds: of a
    free root, "clamped-free" means that the root is held.
    """
    refusals = []
    for by_word in (False, True):
        for chain in chains:
            try:
                return ended_chains(chain, given, far_by_word=by_word)
            except ValueError as error:
                refusals.append(error)
    raise refusals[0]


def _audited(beam: Beam, read: _Read, found: EndedChain, modes: int, tolerance: float) -> Audit:
    columns = {
        "length": [piece.length for piece in found.pieces],
        "mass": [piece.mass for piece in found.pieces],
        "centre": [piece.centre for piece in found.pieces],
        "rotary_inertia": [piece.inertia for piece in found.pieces],
        "joint_stiffness": [spring.stiffness for spring in found.springs],
    }
    armature = np.array([spring.armature for spring in found.springs])
    damping = np.array([spring.damping for spring in found.springs])
    ends = f"ends {found.boundary.name}"
    assumed = [*found.assumed, *([] if found.said else [f"{ends}, as far as the file tells"]), *read.left_out]
    try:
        # Numbers that are too far apart for each other end here, not in results that are none.
        with np.errstate(divide="raise", invalid="raise"):
            chain = Chain.from_pieces(**columns, boundary=found.boundary)
            if any(damping) and chain.pieces != len(found.pieces):
                assumed.append("damping is left out here: a hinge is in series with a support's spring")
                damping = np.zeros_like(damping)
            audit = audit_chain(
                beam,
                found.boundary,
                **columns,
                armature=armature,
                damping=damping,
                modes=modes,
                tolerance=tolerance,
            )
            step = _step(read, chain, armature, damping)
            weight = tuple(weight_remarks(beam, found.boundary, chain, (read.gravity[0], read.sagging)))
    except (ValueError, *_OUT_OF_RANGE) as error:
        first, last = found.springs[0].name, found.springs[-1].name
        raise BadModel(f"chain from hinge {first} to hinge {last} cannot be judged: {error}") from None
    return replace(
        audit,
        hinge_names=tuple(spring.name for spring in found.springs),
        spring_places=tuple(spring.place for spring in found.springs),
        given=(*read.given, *([ends] if found.said else [])),
        assumed=tuple(assumed),
        step=step,
        weight=weight,
        matter=(*_of_caps(read.caps, audit), *audit.matter),
    )


def _caps(path: HingePath) -> float:
    bodies = [body for group in path.groups for body in group.bodies]
    mass = sum(body.inertial.mass for body in bodies)
    return sum(body.caps for body in bodies) / mass if mass else 0.0


def _of_caps(share: float, audit: Audit) -> list[str]:
    """Return what capsules do that reach past their segments: with a density they make a chain heavier."""
    if share <= 1e-6:
        return []
    heavier = share / (1 - share)
    said = f"round caps of capsules, which reach past segments, hold {100 * share:.3g} % of the chain's mass"
    if abs(audit.mass_mismatch - heavier) < 1e-2 * heavier:
        said += f": by them it is {percent(heavier)} off the beam's"
    return [said]


def _step(read: _Read, chain: Chain, armature: Floats, damping: Floats) -> StepVerdict | None:
    if read.step is None:
        return None
    limit = longest_step(chain, armature, damping, read.step, Load(gravity=read.gravity))
    return StepVerdict(read.step.timestep, limit, read.step.integrator, any(read.gravity))


# From a file to readings.


def _read(place: Path, asked: _Request, springs: Path | None) -> _Read:
    if place.suffix.lower() == ".csv":
        return _from_csv(place, asked.beam.length)
    return _of_model_file(place, springs, lambda model: _without_stretch(model, asked))


def _without_stretch(model: Model, asked: _Request) -> _Read:
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


def _of_file(model: Model, asked: _Request) -> _Read:
    held, motors = with_motors_held(model)
    if not motors:
        return _in_any_plane(model, asked)
    if asked.boundary is None:
        try:
            return _in_any_plane(model, asked)
        except BadModel as error:
            raise BadModel(f"{error}{_if_held(held, motors, asked)}") from None
    reads: list[_Read] = []
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


def _if_held(model: Model, motors: Sequence[str], asked: _Request) -> str:
    """Return what the boundary is if motors hold these joints, empty if that makes no chain either."""
    try:
        name = ended_chains(_in_any_plane(model, asked).chains[0], None)[0].boundary.name
    except ValueError:
        return ""
    return f'; with {" and ".join(motors)} held it is "{name}"'


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
    turns = near[0] == math.inf > near[1] and len(pieces) > 2 and pieces[0].length > 0
    planar = PlanarChain(
        pieces,
        springs,
        (near[0], near[1]),
        (far[0], far[1]),
        Spring("left end", near[1]),
        hub=hub_of(pieces[0], pieces[1], length - sum(p.length for p in pieces[1:])) if turns else 0.0,
    )
    return _Read((with_wall_hinges(planar, Spring("right end", 0.0), length),))


def _of_model_file(place: Path, springs: Path | None, answer: Callable[[Model], _T]) -> _T:
    """Return the answer to a model file, or to what MuJoCo makes of one that is refused without it."""
    root = read_xml(place)
    try:
        return answer(_model(root, place, springs))
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
    return answer(with_places_of_no_file(read_mjcf(expanded, place.parent), version, element))


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


def _in_any_plane(model: Model, asked: _Request) -> _Read:
    try:
        return _of_model(model, asked)
    except ValueError as error:
        apart = _axis_by_axis(model, asked)
        if apart is None:
            raise error from None
        return apart


def _axis_by_axis(model: Model, asked: _Request) -> _Read | None:
    """Return the chain about one axis alone, hinges at right angles to it at rest; None if there is none.

    Bending about one axis does not move what hinges about others turn, if all matter is on the line and lies
    along the axes: so it is with hinges by turns about two axes, and with cross-pieces of universal joints.
    """
    reads: list[_Read] = []
    for names, reduced in about_one_axis(model):
        try:
            read = _of_model(reduced, replace(asked, plane=None))
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


def _of_model(model: Model, asked: _Request) -> _Read:
    rod = _rod(model, asked.chain)
    if rod is not None:
        return _of_rod(model, rod, asked)
    paths = hinge_paths(model)
    path = chosen_path(paths, asked.chain)
    names = [each.name for each in paths if each is not path]
    more = ", ..." if len(names) > _LISTED else ""
    others = f"other chains in the file: {', '.join(names[:_LISTED])}{more}" if names else ""
    try:
        read = _of_path(model, path, asked)
    except BadModel as error:
        if not others or asked.chain is not None:
            raise
        raise BadModel(f"{error}; {others}: say by chain which one is the beam") from None
    return replace(read, given=(*read.given, others)) if others else read


def _rod(model: Model, name: str | None) -> ModelRod | None:
    """Return the rod of points that is meant: the one of that name, or the longest if nothing has springs."""
    for rod in model.rods:
        if name is not None and rod.has(name):
            return rod
    if not model.rods or any(joint.is_sprung for body in model.bodies for joint in body.joints):
        return None
    if name is not None:
        choice("chain", name, [rod.name for rod in model.rods])
    return max(model.rods, key=lambda rod: len(rod.points))


def _of_rod(model: Model, rod: ModelRod, asked: _Request) -> _Read:
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
    return _Read(
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


def _of_path(model: Model, path: HingePath, asked: _Request) -> _Read:
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
    return _Read(
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
