"""What URDF and SDFormat files hold that a chain must not have: stops at rest, friction, rotors."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from beammodes.auditing.bounded_xml import XmlElement
from beammodes.checks import shown

__all__ = ["by_name", "check_added", "why_driven", "why_not_free"]

#: Drake's own elements that hold bodies together outside the tree of joints.
_ADDED = ("drake:linear_bushing_rpy", "drake:ball_constraint", "drake:joint")
_DRIVEN = {"drake:rotor_inertia": "inertia", "drake:controller_gains": "a servo"}


def by_name(elements: Iterable[XmlElement]) -> dict[str, XmlElement]:
    """Return elements by name.

    Raises
    ------
    BadModel
        If one has no name, or that of another.
    """
    found: dict[str, XmlElement] = {}
    for element in elements:
        name = element.attributes.get("name") or element.refuse("must have a name")
        if name in found:
            element.refuse(f"must have a name of its own, got {shown(name)} for a second time")
        found[name] = element
    return found


def check_added(model: XmlElement) -> None:
    """Raise BadModel if xacro has left something to do, or bushings hold a model's bodies."""
    for element in model.children:
        if element.tag.startswith("xacro:"):
            element.refuse("must have been expanded by xacro")
        if element.tag in _ADDED:
            element.refuse("must be left out: only joints of a tree are read")


def why_not_free(joint: XmlElement, limits: tuple[float, float] | None, friction: float) -> str:
    """Return why a joint does not swing freely about 0, empty if it does."""
    if friction:
        return f"{joint.where} must have no friction: dry friction holds a hinge still"
    if limits is not None and not limits[0] < 0 < limits[1]:
        return f"{joint.where} must be at rest within its limits, not at a stop or beyond"
    return ""


def why_driven(parent: XmlElement, joint: XmlElement) -> str:
    """Return why a joint is no plain hinge by Drake's elements below `parent`, empty if it is."""
    for element in _below(parent):
        given = [element.text, element.attributes.get("value", ""), element.attributes.get("p", "")]
        if element.tag in _DRIVEN and any(text.strip().strip("0.") for text in given):
            what = _DRIVEN[element.tag]
            return f"{joint.where} must have no <{element.tag}>, which is {what} that no beam has"
    return ""


def _below(element: XmlElement) -> Iterator[XmlElement]:
    for child in element.children:
        yield child
        yield from child.children
