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
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Literal, overload

import numpy as np

from beammodes.auditing.audit import Audit, StepVerdict, audit_chain
from beammodes.auditing.axial_audit import AxialAudit
from beammodes.auditing.body_tree import Model
from beammodes.auditing.bounded_xml import BadModel
from beammodes.auditing.file_readings import (
    Readings,
    Request,
    answer_of_file,
    readings_of,
    readings_of_file,
    rod_meant,
)
from beammodes.auditing.judged_pieces import UNKNOWN, longest_step
from beammodes.auditing.model_ends import EndedChain, ended_chains
from beammodes.auditing.planar_chain import PlanarChain
from beammodes.auditing.space_audit import SpatialAudit, audit_along, audit_in_space
from beammodes.auditing.told_audit import listed_errors
from beammodes.auditing.weight_effect import weight_remarks
from beammodes.chains.chain import Chain
from beammodes.checks import choice, instead, percent, shown, small_fraction
from beammodes.numerics.arrays import Floats
from beammodes.problem.axial_ends import AxialBoundary, AxialBoundaryLike
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary, BoundaryLike
from beammodes.problem.loading import Load
from beammodes.problem.motions import MOTIONS
from beammodes.problem.rod import Rod
from beammodes.problem.rod_ends import RodBoundaryLike, RodEnds

__all__ = ["audit_file"]

_OUT_OF_RANGE = (ArithmeticError, np.linalg.LinAlgError)


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
    pairs of hinges about two axes), where all springs are relaxed. Files are read without any simulator; what
    cannot be honoured is refused by name. Hostile files are refused within 5 s and 150 MB, as measured in the
    tests. What only MuJoCo can expand (attached models, meshes without inertia, ties between copies) it
    expands where it is installed, in a process that is stopped after 10 s of processor time, or 30 s in all,
    or at 1 GiB.

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
    # Ends are of the kind of the motion: `of` refuses those of another.
    pair = None if boundary is None else Boundary.of(boundary)  # type: ignore[arg-type]
    asked = Request(beam, pair, chain, plane)
    with _told_of(place):
        return _judged(asked, readings_of_file(place, asked, file), modes, tolerance)


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
        # As in bending: `of` refuses ends of another motion.
        ends = None if boundary is None else RodEnds.of(boundary)  # type: ignore[arg-type]
    else:
        if plane is not None:
            raise ValueError(f"plane must be left out for motion {motion}, got {shown(plane)}")
        # A Rod has gone to motion "space"; `of` refuses ends of another motion.
        MOTIONS[motion].numbers(beam)  # type: ignore[arg-type]
        along = None if boundary is None else AxialBoundary.of(boundary, motion)  # type: ignore[arg-type]

    def in_plane(model: Model, beam: Beam, boundary: Boundary | None, chain: str) -> Audit:
        asked = Request(beam, boundary, chain, None)
        return _judged(asked, readings_of(model, asked), modes, tolerance)

    def answer(model: Model) -> AxialAudit | SpatialAudit:
        rod = rod_meant(model, chain)
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
        return answer_of_file(place, springs, answer)


def _judged(asked: Request, read: Readings, modes: int, tolerance: float) -> Audit:
    """Return the audit of a chain in one plane as it was read."""
    beam = asked.beam
    if asked.boundary is None:
        return _as_the_file_says(beam, read, modes, tolerance)
    chains = _fitting(read.chains, asked.boundary)
    audits = [(_audited(beam, read, each, modes, tolerance), each.unevenness) for each in chains]
    # What was taken out of the wrong end leaves a spring of no rule there, or a piece of another mass.
    return min(audits, key=lambda pair: (pair[0].layout == UNKNOWN, pair[1]))[0]


def _as_the_file_says(beam: Beam, read: Readings, modes: int, tolerance: float) -> Audit:
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


def _audited(beam: Beam, read: Readings, found: EndedChain, modes: int, tolerance: float) -> Audit:
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


def _of_caps(share: float, audit: Audit) -> list[str]:
    """Return what capsules do that reach past their segments: with a density they make a chain heavier."""
    if share <= 1e-6:
        return []
    heavier = share / (1 - share)
    said = f"round caps of capsules, which reach past segments, hold {100 * share:.3g} % of the chain's mass"
    if abs(audit.mass_mismatch - heavier) < 1e-2 * heavier:
        said += f": by them it is {percent(heavier)} off the beam's"
    return [said]


def _step(read: Readings, chain: Chain, armature: Floats, damping: Floats) -> StepVerdict | None:
    if read.step is None:
        return None
    limit = longest_step(chain, armature, damping, read.step, Load(gravity=read.gravity))
    return StepVerdict(read.step.timestep, limit, read.step.integrator, any(read.gravity))
