"""Mass, inertia and reach of an MJCF body: from its inertial, or from the solids that it is made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from beammodes.auditing.body_tree import ModelBody, Solid
from beammodes.auditing.bounded_xml import XmlElement
from beammodes.auditing.mjcf_settings import Settings
from beammodes.auditing.spatial import Inertial, Pose, ends_of, from_z_to, joined, solid

__all__ = ["compiled_masses", "matter_of"]

Array = NDArray[np.float64]

_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3}
_MASSLESS = ("plane", "hfield")


def matter_of(
    settings: Settings, element: XmlElement, class_name: str
) -> tuple[Inertial, list[Array], list[Solid], str]:
    """Return a body's mass and inertia, the ends of its geometry, its solids, and why they cannot be told."""
    extent: list[Array] = []
    solids: list[Solid] = []
    why = ""
    for child, place, inherited, _ in settings.inside(element, class_name, "geom"):
        own = settings.with_defaults(child, "geom", inherited)
        kind = "mesh" if "mesh" in own.attributes else own.attributes.get("type", "sphere")
        if kind in _MASSLESS or (kind not in _SIZES and not _has_mass(settings, own)):
            continue
        if kind not in _SIZES or own.attributes.get("shellinertia") == "true":
            why = f"{own.where} must be a {', '.join(_SIZES)}, filled, or have its body's mass in <inertial>"
            continue
        part, ends = _geometry(settings, own, kind)
        ends = [place.point(end) for end in ends]
        extent += ends
        if settings.counts(own):
            solids.append(Solid(part.seen_from(place), tuple(ends)))
    given = element.first("inertial")
    if given is not None and settings.inertia_from_geometry != "true":
        return _given(settings, given), extent, [], ""
    if settings.inertia_from_geometry == "false":
        return joined([]), extent, [], ""
    return joined(each.inertial for each in solids), extent, solids, why


def compiled_masses(settings: Settings, bodies: Sequence[ModelBody]) -> list[ModelBody]:
    """Return bodies as the compiler's settings change them: all masses scaled to a total.

    Raises
    ------
    BadModel
        If a least mass or inertia, or the balance of inertias, would change a single body.
    """
    said = settings.compiler
    for name, sizes in (("boundmass", _own_mass), ("boundinertia", _own_inertia)):
        (least,) = said.numbers(name, 1, "0")
        light = next((body for body in bodies if least > 0 and sizes(body) < least), None)
        if light is not None:
            said.refuse(
                f"must have a {name} that no body is below, got {least:g}: body {light.name} has less"
            )
    if said.attributes.get("balanceinertia") == "true":
        odd = next((body for body in bodies if not _is_balanced(body)), None)
        if odd is not None:
            said.refuse(f"must have no balanceinertia, which changes the inertia of body {odd.name}")
    (total,) = said.numbers("settotalmass", 1, "-1")
    mass = sum(body.inertial.mass for body in bodies)
    if total <= 0 or not mass:
        return list(bodies)
    odd = next((body for body in bodies if body.refusal), None)
    if odd is not None:
        said.refuse(f"must have no settotalmass, for which every mass must be known: {odd.refusal}")
    share = total / mass
    return [
        replace(
            body,
            inertial=_scaled(body.inertial, share),
            solids=tuple(replace(each, inertial=_scaled(each.inertial, share)) for each in body.solids),
        )
        for body in bodies
    ]


def _scaled(own: Inertial, share: float) -> Inertial:
    return Inertial(own.mass * share, own.centre, own.inertia * share)


def _own_mass(body: ModelBody) -> float:
    return body.inertial.mass


def _own_inertia(body: ModelBody) -> float:
    return float(np.linalg.eigvalsh(body.inertial.inertia)[0])


def _is_balanced(body: ModelBody) -> bool:
    least, middle, most = np.linalg.eigvalsh(body.inertial.inertia)
    return bool(least + middle >= most * (1 - 1e-9))


def _has_mass(settings: Settings, geom: XmlElement) -> bool:
    said = "mass" if "mass" in geom.attributes else "density"
    return settings.counts(geom) and geom.numbers(said, 1, "1000")[0] > 0


def _given(settings: Settings, element: XmlElement) -> Inertial:
    pose = settings.pose(element)
    (mass,) = element.numbers("mass", 1)
    if mass < 0:
        element.refuse(f"must have a mass of at least 0, got {mass:g}")
    if "fullinertia" in element.attributes:
        xx, yy, zz, xy, xz, yz = element.numbers("fullinertia", 6)
        matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    else:
        matrix = np.diag(element.numbers("diaginertia", 3))
    return Inertial(mass, np.zeros(3), matrix).seen_from(pose)


def _geometry(settings: Settings, geom: XmlElement, kind: str) -> tuple[Inertial, list[Array]]:
    """Return a solid in its body's frame, and the two ends of its long axis without round caps."""
    count = _SIZES[kind]
    pose = settings.pose(geom)
    ends = "fromto" in geom.attributes
    if ends and kind == "sphere":
        geom.refuse("must have no fromto")
    text = geom.attributes.get("size", "")
    size = geom.read("size", text, (1, 2, 3))
    if ends:
        points = np.array(geom.numbers("fromto", 6)).reshape(2, 3)
        length = float(np.linalg.norm(points[1] - points[0]))
        if not length:
            geom.refuse("must have two different points in fromto")
        pose = Pose(from_z_to((points[1] - points[0]) / length), points.mean(axis=0))
        size = [size[0]] * (count - 1) + [length / 2]
    if len(size) < count or min(size[:count]) <= 0:
        geom.refuse(f"must have {count} sizes above 0 as a {kind}, got {text[:40]!r}")
    mass = geom.numbers("mass", 1)[0] if "mass" in geom.attributes else None
    (density,) = geom.numbers("density", 1, "1000")
    if density < 0 or (mass or 0.0) < 0:
        geom.refuse("must have a mass and a density of at least 0")
    reach = [pose.point(point) for point in ends_of(kind, size)]
    return solid(kind, size[:count], mass, density).seen_from(pose), reach
