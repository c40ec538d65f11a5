"""Python scripts that make a chain in an engine: a kinematic tree of Exudyn, springs for a URDF in PyBullet.

Every script runs as it is and prints the frequencies that the engine itself finds, and its functions can be
imported. Text from outside stands in comments on one line each, and in literals.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from beammodes.exporters.model_tree import Body, Joint, Tree, Vector, links

__all__ = ["exudyn_script", "pybullet_script"]

_LETTERS = ("X", "Y", "Z")
_KINDS = {"hinge": "Revolute", "slide": "Prismatic"}

_EXUDYN = '''\
"""{name}: a flexible beam for Exudyn (pip install exudyn numpy), as a kinematic tree.

Run it to see the natural frequencies that Exudyn finds, or use its functions in a script of yours:

    container = exudyn.SystemContainer()
    system = container.AddSystem()
    add_chain(system)
    system.Assemble()
    system.SolveDynamic(settings(duration=1.0), solverType=exudyn.DynamicSolverType.RK44)
"""

{comments}
import exudyn
import numpy
from exudyn.itemInterface import NodeGenericODE2, ObjectKinematicTree

STEP = {step!r}  # [s], for exudyn.DynamicSolverType.RK44
GRAVITY = {gravity!r}
# Of every link: its joint's name, kind, stiffness and damper; where its frame is on the link before, and
# how it is turned; its mass, centre of mass, and inertia about that.
LINKS = [
{rows}]


def add_chain(system):
    """Add the chain to a MainSystem; return the numbers of its node and of its tree."""
    count = len(LINKS)
    names, kinds, springs, dampers, places, turns, masses, centres, inertias = zip(*LINKS)
    node = system.AddNode(
        NodeGenericODE2(
            referenceCoordinates=[0.0] * count,
            initialCoordinates=[0.0] * count,
            initialCoordinates_t=[0.0] * count,
            numberOfODE2Coordinates=count,
        )
    )
    tree = ObjectKinematicTree(
        name={name!r},
        nodeNumber=node,
        jointTypes=[getattr(exudyn.JointType, kind) for kind in kinds],
        linkParents=numpy.arange(count) - 1,
        jointTransformations=exudyn.Matrix3DList([numpy.array(turn) for turn in turns]),
        jointOffsets=exudyn.Vector3DList([numpy.array(place) for place in places]),
        linkInertiasCOM=exudyn.Matrix3DList([numpy.array(inertia) for inertia in inertias]),
        linkCOMs=exudyn.Vector3DList([numpy.array(centre) for centre in centres]),
        linkMasses=list(masses),
        jointPControlVector=list(springs),
        jointDControlVector=list(dampers),
        jointPositionOffsetVector=[0.0] * count,
        jointVelocityOffsetVector=[0.0] * count,
        gravity=GRAVITY,
    )
    return node, system.AddObject(tree)


def settings(duration):
    """Return settings of a run of so many seconds in the file's step."""
    found = exudyn.SimulationSettings()
    found.timeIntegration.endTime = duration
    found.timeIntegration.numberOfSteps = max(1, round(duration / STEP))
    return found


if __name__ == "__main__":
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    add_chain(system)
    system.Assemble()
    squares = numpy.sort(system.ComputeODE2Eigenvalues()[0])
    # Every spring adds a mode; without them the chain moves as a rigid body does.
    elastic = sum(spring > 0 for _, _, spring, *_ in LINKS)
    found = numpy.sqrt(squares[len(squares) - elastic :]) / (2 * numpy.pi)
    print("natural frequencies [Hz]:", *(f"{{each:.8g}}" for each in found[:3]))
'''

_PYBULLET = '''\
"""{name}: a flexible beam for PyBullet (pip install pybullet numpy), whose URDF knows no springs.

Run it to see the natural frequencies that PyBullet finds, or use its functions in a script of yours:

    pybullet.connect(pybullet.GUI)
    body, springs = load()
    while True:
        pull(body, springs)
        pybullet.stepSimulation()
"""

{comments}
from pathlib import Path

import pybullet

URDF = Path(__file__).with_name({urdf})
STEP = {step!r}  # [s]
GRAVITY = {gravity!r}
FIXED = {fixed!r}
# Stiffness of every joint that has a spring, at rest at 0. Dampers are in the URDF.
SPRINGS = {{
{rows}}}


def load(client=0):
    """Load the chain, set gravity and step; return the body, and joints' stiffness by their numbers."""
    here = {{"physicsClientId": client}}
    # PyBullet keeps a file that it has read once, also when it has been written again.
    pybullet.setPhysicsEngineParameter(enableFileCaching=0, fixedTimeStep=STEP, **here)
    pybullet.setGravity(*GRAVITY, **here)
    # Without the flag it makes inertias of its own, from shapes for collision.
    flag = pybullet.URDF_USE_INERTIA_FROM_FILE
    body = pybullet.loadURDF(str(URDF), useFixedBase=FIXED, flags=flag, **here)
    joints = range(pybullet.getNumJoints(body, **here))
    for link in (-1, *joints):
        # Damping in air is 0.04 by default, the largest speed of a joint 100 rad/s.
        pybullet.changeDynamics(body, link, linearDamping=0, angularDamping=0, maxJointVelocity=1e9, **here)
    springs = {{}}
    for joint in joints:
        name, kind = pybullet.getJointInfo(body, joint, **here)[1:3]
        if kind != pybullet.JOINT_FIXED:
            # The motor that every joint has by default would hold it.
            pybullet.setJointMotorControl2(body, joint, pybullet.VELOCITY_CONTROL, force=0, **here)
            springs[joint] = SPRINGS.get(name.decode(), 0.0)
    return body, springs


def pull(body, springs, client=0):
    """Set the springs' torques: before every step, since PyBullet forgets them with it."""
    here = {{"physicsClientId": client}}
    joints = list(springs)
    angles = (state[0] for state in pybullet.getJointStates(body, joints, **here))
    torques = [-springs[joint] * angle for joint, angle in zip(joints, angles)]
    pybullet.setJointMotorControlArray(body, joints, pybullet.TORQUE_CONTROL, forces=torques, **here)


if __name__ == "__main__":
    import numpy

    client = pybullet.connect(pybullet.DIRECT)
    body, springs = load(client)
    inertia = numpy.array(pybullet.calculateMassMatrix(body, [0.0] * len(springs)))
    roots = numpy.zeros(len(inertia))
    roots[len(inertia) - len(springs) :] = numpy.sqrt(list(springs.values()))
    # M = L Lᵀ; the singular values of L⁻¹ √K are the angular frequencies.
    found = numpy.linalg.svd(numpy.linalg.solve(numpy.linalg.cholesky(inertia), numpy.diag(roots)))[1]
    # Every spring adds a mode; without them the chain moves as a rigid body does.
    found = found[: numpy.count_nonzero(roots)][::-1] / (2 * numpy.pi)
    print("natural frequencies [Hz]:", *(f"{{each:.8g}}" for each in found[:3]))
    pybullet.disconnect(client)
'''


def _comments(facts: Iterable[str]) -> str:
    return "".join(f"# {fact}\n" for fact in facts)


def exudyn_script(
    name: str, facts: Iterable[str], tree: Tree, timestep: float, gravity: Sequence[float]
) -> str:
    """Return a script that adds a tree to a system of Exudyn.

    Parameters
    ----------
    name : str
        A word.
    facts : iterable of str
        Lines for the head, each printable.
    tree : Tree
        Without ties and balls.
    timestep : float [s]
    gravity : triple [m/s²]

    Examples
    --------
    >>> import beammodes as bm
    >>> from beammodes.exporters.planar_tree import planar_tree
    >>> tree = planar_tree(bm.Chain(bm.Beam.unit(), "clamped-free", 2))
    >>> exudyn_script("beam", [], tree, 0.1, (0, 0, 0)).count("Revolute")
    2
    """
    rows, place, frame = [], np.zeros(3), np.eye(3)
    for link in links(replace(tree, bodies=tuple(map(_loose, tree.bodies)))):
        place, frame = place + frame @ link.position, frame @ np.array(link.rotation)
        body, joint = link.body, link.joint
        if joint is None:
            # Welded to the ground, where it moves nothing; the next one stands on it.
            continue
        letter = _LETTERS[next(k for k in range(3) if joint.axis[k])]
        row = (
            *(joint.name, f"{_KINDS[joint.kind]}{letter}", joint.stiffness, joint.damping),
            *(place.tolist(), frame.tolist(), body.mass, list(body.centre), [*map(list, body.inertia)]),
        )
        rows.append(f"    {row!r},\n")
        place, frame = np.zeros(3), np.eye(3)
    notes = [*facts, *tree.notes]
    if any(min(joint.axis) < 0 for body in tree.bodies for joint in body.joints):
        notes.append("positive angles about y lower the far tip: Exudyn's joints turn about positive axes")
    notes.append("Exudyn's implicit solvers take any step; they shift the first frequency with its square")
    return _EXUDYN.format(
        name=name,
        comments=_comments(notes),
        step=float(timestep),
        gravity=[*map(float, gravity)],
        rows="".join(rows),
    )


def _loose(body: Body) -> Body:
    """Return a body with slides and hinges for a joint that leaves it free."""
    if not any(joint.kind == "free" for joint in body.joints):
        return body
    found = []
    axes: tuple[tuple[int, int, int], ...] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    for joint in body.joints:
        for kind in ("slide", "hinge"):
            found += [
                Joint(f"{joint.name}_{kind}_{a}", kind, axis) for a, axis in zip("xyz", axes, strict=True)
            ]
    return replace(body, joints=tuple(found))


def pybullet_script(
    name: str,
    facts: Iterable[str],
    tree: Tree,
    timestep: float,
    gravity: Vector,
    urdf: str,
) -> str:
    """Return a script that loads a URDF file beside it and gives its joints their springs.

    Parameters
    ----------
    name, facts, tree, timestep, gravity
        As of `exudyn_script`.
    urdf : str
        The file's name.

    Examples
    --------
    >>> import beammodes as bm
    >>> from beammodes.exporters.planar_tree import planar_tree
    >>> tree = planar_tree(bm.Chain(bm.Beam.unit(), "clamped-free", 2, "naive"), "beam")
    >>> "'beam_hinge_1': 2.0," in pybullet_script("beam", [], tree, 0.1, (0, 0, 0), "beam.urdf")
    True
    """
    joints = [joint for body in tree.bodies for joint in body.joints]
    rows = (f"    {joint.name!r}: {float(joint.stiffness)!r},\n" for joint in joints if joint.stiffness)
    return _PYBULLET.format(
        name=name,
        comments=_comments([*facts, *tree.notes]),
        urdf=ascii(urdf),
        step=float(timestep),
        gravity=tuple(map(float, gravity)),
        fixed=not any(joint.kind == "free" for joint in joints),
        rows="".join(rows),
    )
