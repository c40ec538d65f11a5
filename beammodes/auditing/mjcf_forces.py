"""What acts on the joints of an MJCF model beside their own springs: servos, tendons, constraints."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from beammodes.auditing.body_tree import ModelTie
from beammodes.auditing.bounded_xml import XmlElement
from beammodes.auditing.mjcf_settings import Settings

__all__ = [
    "acted_sites",
    "held_ends",
    "linear_damping",
    "linear_stiffness",
    "servo_dampers",
    "servos",
    "ties",
]

_PLAIN_ACTUATORS = ("motor", "damper", "plugin", "adhesion")
#: Shortcuts that make a servo of every <general> of their class.
_SERVO_DEFAULTS = ("position", "velocity", "intvelocity", "muscle", "cylinder", "dcmotor")


def linear_stiffness(element: XmlElement) -> float:
    """Return the stiffness of a joint or tendon; in MuJoCo 4 it may be a polynomial of one term."""
    value, *more = element.numbers("stiffness", (1, 2, 3), "0")
    if any(more):
        element.refuse("must have a linear spring, got a stiffness with more than one number")
    if value < 0:
        element.refuse(f"must have a stiffness of at least 0, got {value:g}")
    return value


def linear_damping(element: XmlElement) -> float:
    """Return the damping of a joint or tendon; in MuJoCo 4 it may be a polynomial of one term."""
    value, *more = element.numbers("damping", (1, 2, 3), "0")
    if any(more):
        element.refuse("must have a linear damper, got a damping with more than one number")
    if value < 0:
        element.refuse(f"must have a damping of at least 0, got {value:g}")
    return value


def servo_dampers(root: XmlElement, settings: Settings) -> Iterator[tuple[str, float]]:
    """Yield the joints on which servos of velocity act, and their damping: kv gear²."""
    for actuators in root.all("actuator"):
        for element in actuators.children:
            if _is_damper(element, settings):
                own = settings.with_defaults(element, element.tag, "main")
                gain = _velocity_gain(own)
                (gear, *_) = own.numbers("gear", (1, 2, 3, 4, 5, 6), "1")
                yield own.attributes["joint"], gain * gear**2


def _velocity_gain(own: XmlElement) -> float:
    if own.tag == "velocity":
        return own.numbers("kv", 1, "1")[0]
    terms = own.numbers("biasprm", tuple(range(1, 11)), "0")
    return -terms[2] if len(terms) > 2 else 0.0


def _is_damper(element: XmlElement, settings: Settings) -> bool:
    """Whether a servo of one joint has a force of its velocity only, so that it is 0 at rest."""
    if element.tag not in ("velocity", "general"):
        return False
    own = settings.with_defaults(element, element.tag, "main")
    if "joint" not in own.attributes or _velocity_gain(own) < 0:
        return False
    if element.tag == "velocity":
        return True
    terms = own.numbers("biasprm", tuple(range(1, 11)), "0")
    return own.attributes.get("biastype") == "affine" and not any(terms[:2]) and not any(terms[3:])


def servos(root: XmlElement, settings: Settings) -> Iterator[tuple[str, str]]:
    """Yield the joints on which servos act, by themselves or through fixed tendons, and what to say of it."""
    joints = {
        tendon.attributes.get("name", ""): [part.attributes.get("joint", "") for part in tendon.all("joint")]
        for tendons in root.all("tendon")
        for tendon in tendons.all("fixed")
    }
    for element in _servo_elements(root, settings):
        names = [element.attributes.get(key, "") for key in ("joint", "jointinparent")]
        for name in filter(None, [*names, *joints.get(element.attributes.get("tendon", ""), [])]):
            yield name, f"{element.where} must not act on a hinge of the chain, like a spring"


def _servo_elements(root: XmlElement, settings: Settings) -> Iterator[XmlElement]:
    for actuators in root.all("actuator"):
        for element in actuators.children:
            if element.tag == "general":
                own = settings.with_defaults(element, "general", "main")
                tags = settings.classes[element.attributes.get("class", "main")].keys()
                inherited = "affine" if tags & set(_SERVO_DEFAULTS) else "none"
                if own.attributes.get("biastype", inherited) == "none":
                    continue
            if element.tag not in _PLAIN_ACTUATORS and not _is_damper(element, settings):
                yield element


def acted_sites(root: XmlElement, settings: Settings) -> Iterator[tuple[str, str]]:
    """Yield the sites that servos or spatial tendons with springs pull at, and what to say of it."""
    pulling = {element.attributes.get("tendon", ""): element for element in _servo_elements(root, settings)}
    for element in _servo_elements(root, settings):
        for key in ("site", "refsite", "cranksite", "slidersite"):
            if key in element.attributes:
                yield element.attributes[key], f"{element.where} must not act on a body of the chain"
    tied = _equality_tendons(root)
    for tendons in root.all("tendon"):
        for tendon in tendons.all("spatial"):
            own = settings.with_defaults(tendon, "tendon", "main")
            name = own.attributes.get("name", "")
            why = [key for key in ("stiffness", "armature", "frictionloss") if any(_terms(own, key))]
            why += ["an actuator"] if name and name in pulling else []
            why += ["an equality constraint"] if name and name in tied else []
            if why:
                for site in tendon.all("site"):
                    yield (
                        site.attributes.get("site", ""),
                        f"{tendon.where} must not act on the chain, as it does by {' and '.join(why)}",
                    )


def ties(root: XmlElement, settings: Settings) -> Iterator[ModelTie]:
    """Yield the fixed tendons of a model, of infinite stiffness where an equality constraint holds them."""
    holding = _equality_tendons(root)
    for tendons in root.all("tendon"):
        for i, element in enumerate(tendons.all("fixed")):
            tendon = settings.with_defaults(element, "tendon", "main")
            name = tendon.attributes.get("name", f"tendon {i + 1}")
            terms = tuple(
                (part.attributes.get("joint", ""), part.numbers("coef", 1)[0]) for part in tendon.all("joint")
            )
            stiffness = math.inf if name in holding else linear_stiffness(tendon)
            why = holding.get(name, "") or _why_not(tendon, stiffness)
            yield ModelTie(name, terms, stiffness, why, linear_damping(tendon))


def _why_not(tendon: XmlElement, stiffness: float) -> str:
    if _inertia_or_friction(tendon):
        return f"{tendon.where} must have no armature and no frictionloss, which no beam has"
    rest = tendon.numbers("springlength", (1, 2), "-1")
    if 0 < stiffness < math.inf and any(rest) and rest != [-1.0]:
        return f"{tendon.where} must be slack at rest: springlength 0"
    return ""


def _terms(tendon: XmlElement, name: str) -> list[float]:
    return [linear_stiffness(tendon)] if name == "stiffness" else tendon.numbers(name, 1, "0")


def _inertia_or_friction(tendon: XmlElement) -> bool:
    return any(tendon.numbers(name, 1, "0")[0] for name in ("armature", "frictionloss"))


def _equality_tendons(root: XmlElement) -> dict[str, str]:
    """Return the tendons that equality constraints act on, each with why it cannot be honoured, if so."""
    found: dict[str, str] = {}
    for constraints in root.all("equality"):
        for element in constraints.all("tendon"):
            if element.attributes.get("active") == "false":
                continue
            names = [element.attributes[key] for key in ("tendon1", "tendon2") if key in element.attributes]
            offset = element.numbers("polycoef", (1, 2, 3, 4, 5), "0")[0]
            why = f"{element.where} must hold one tendon, at its length at rest"
            found |= dict.fromkeys(names, why if offset or len(names) > 1 else "")
    return found


def held_ends(root: XmlElement, homes: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Yield the bodies and joints that other constraints act on, and what to say of these.

    Parameters
    ----------
    root : XmlElement
    homes : mapping
        The body of each site.
    """
    for constraints in root.all("equality"):
        for element in constraints.all("connect", "weld", "joint"):
            if element.attributes.get("active") == "false":
                continue
            for end in ("body1", "body2", "joint1", "joint2"):
                if end in element.attributes:
                    yield element.attributes[end], element.where
            for end in ("site1", "site2"):
                if element.attributes.get(end) in homes:
                    yield homes[element.attributes[end]], element.where
