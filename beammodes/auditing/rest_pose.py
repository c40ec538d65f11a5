"""A model's bodies in the pose in which the springs of its joints are relaxed, as frequencies want it.

A file's own pose may be another: MJCF has springref beside ref, SDFormat spring_reference. Each joint turns
or shifts all beyond it by its `rest`; the joints of one body act in their order, each carried by those
before. Joints without a spring stay where they are. Where other constraints close a loop, springs need not be
relaxed anywhere: such joints are refused.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from beammodes.auditing.body_tree import Frame, Model, ModelBody, ModelJoint, ModelTie, about

__all__ = ["in_rest_pose"]

#: Of the sum of a tendon's terms that is rounding.
_ROUNDING = 1e-9
_LISTED = 5


def in_rest_pose(model: Model) -> Model:
    """Return a model turned to where its springs are relaxed, with a sentence on it; as it is if it is there.

    Examples
    --------
    >>> import numpy as np
    >>> from beammodes.auditing.body_tree import Inertial
    >>> hinge = ModelJoint("j", "hinge", np.array([0.0, 0, 1]), np.zeros(3), 10.0, rest=math.pi / 2)
    >>> arm = ModelBody("arm", -1, Inertial(1.0, np.array([1.0, 0, 0]), np.eye(3)), joints=(hinge,))
    >>> in_rest_pose(Model((arm,))).bodies[0].inertial.centre.round(12).tolist()
    [0.0, 1.0, 0.0]
    """
    if not any(joint.rest for body in model.bodies for joint in body.joints):
        return model
    looped = _in_loops(model)
    frames: list[Frame] = []
    bodies: list[ModelBody] = []
    moved: dict[str, ModelJoint] = {}
    for i, body in enumerate(model.bodies):
        frame = frames[body.parent] if body.parent >= 0 else Frame()
        joints: list[ModelJoint] = []
        for joint in body.joints:
            if joint.rest and i in looped:
                why = (
                    f"joint {joint.name} must have its spring relaxed in the file's pose: {looped[i]} closes "
                    "a loop, which may keep it from the angle at which it is"
                )
                joint = replace(joint, rest=0.0, refusal=joint.refusal or why)
            joints.append(_seen_from(joint, frame))
            if joint.rest:
                moved[joint.name] = joint
                frame = frame @ _step(joint)
        frames.append(frame)
        # Contacts and matter go with the body; its joints have been placed one by one.
        bodies.append(replace(body.placed(frame), joints=tuple(joints)))
    ties = tuple(_still_slack(tie, moved) for tie in model.ties)
    given = (*model.given, *([_told(list(moved.values()))] if moved else []))
    return replace(model, bodies=tuple(bodies), ties=ties, given=given)


def _step(joint: ModelJoint) -> Frame:
    """Return where a joint's spring, when relaxed, puts what the joint carries."""
    if joint.kind == "slide":
        return Frame(position=joint.rest * joint.axis)
    turn = about(joint.axis, joint.rest)
    return Frame(turn, joint.position - turn @ joint.position)


def _seen_from(joint: ModelJoint, frame: Frame) -> ModelJoint:
    turn, springs = frame.rotation, joint.springs
    turned = None if springs is None else turn @ springs @ turn.T
    return replace(joint, axis=turn @ joint.axis, position=frame.point(joint.position), springs=turned)


def _in_loops(model: Model) -> dict[int, str]:
    """Return the bodies between a held one and the ground, each with the constraint that holds it."""
    names = dict(model.held)
    found: dict[int, str] = {}
    for i in reversed(range(len(model.bodies))):
        body = model.bodies[i]
        own = next((names[each] for each in (body.name, *(j.name for j in body.joints)) if each in names), "")
        why = found.get(i, own)
        if why:
            found[i] = why
            if body.parent >= 0:
                found.setdefault(body.parent, why)
    return found


def _still_slack(tie: ModelTie, moved: dict[str, ModelJoint]) -> ModelTie:
    """Return a tendon, refused if its length is another where springs are relaxed."""
    parts = [factor * moved[name].rest for name, factor in tie.terms if name in moved]
    if tie.refusal or abs(sum(parts)) <= _ROUNDING * sum(map(abs, parts)):
        return tie
    return replace(
        tie, refusal=f"tendon {tie.name} must be as long in the file's pose as where the springs are relaxed"
    )


def _told(joints: Sequence[ModelJoint]) -> str:
    sizes = [
        f"{joint.name} {joint.rest:.4g} m"
        if joint.kind == "slide"
        else f"{joint.name} {math.degrees(joint.rest):.4g} deg"
        for joint in joints[:_LISTED]
    ]
    more = ", ..." if len(joints) > _LISTED else ""
    return (
        f"springs are relaxed away from the file's pose ({', '.join(sizes)}{more}): the chain is judged "
        "about the shape in which all are relaxed, without gravity"
    )
