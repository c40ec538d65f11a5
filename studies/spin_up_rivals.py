"""The time in which chains and engines reach 1e-4 of a spun-up beam's tip deflection; cost against N.

The beam is that of Simo and Vu-Quoc, for its first eight seconds. A method takes N and a step and returns the
tip's deflection at the times of `TIME`. Each is tried at some N and steps; the table has the one that reached
the accuracy in the least time. MuJoCo has the same chain, on a hub so heavy that the beam cannot hold it up;
Exudyn its own finite elements.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import pairwise
from typing import Any

import numpy as np

import beammodes as bm
from beammodes.dynamics.base_motion import BaseMotion
from beammodes.dynamics.implicit import ImplicitStepper
from beammodes.dynamics.runs import runge_kutta
from beammodes.numerics.arrays import Floats
from beammodes.vibration.integrators import accuracy_limit
from studies.exact_spin_up import tip_deflection
from studies.figure_1 import BEAM, BOUNDARY, MOTIONS
from studies.rivals import duration, timed
from studies.tables import markdown_table

__all__ = ["ACCURACY", "METHODS", "TIME", "exact_tip", "growing", "spinning"]

ACCURACY = 1e-4
_EVERY, _OUTPUTS = 0.04, 200
TIME = np.arange(_OUTPUTS + 1) * _EVERY
_BASE, RULE = MOTIONS["rotational"][0], "gregory"
#: Degrees of the exact beam's polynomials: the second is the reference, the first says how good it is.
_DEGREES = (6, 7)
#: The hub's inertia beside the beam's, about its centre.
_HEAVY = 1e8
#: EA of Simo and Vu-Quoc [N], which elements need and rigid rods do not.
_STRETCH = 2.8e7

Tip = Callable[[int, float], Floats]


@dataclass(frozen=True)
class Method:
    """A way to the tip's deflection, the package that it needs, and N and steps [s] to try.

    A step of None is the longest stable one.
    """

    tip: Tip
    package: str
    tried: tuple[tuple[int, float | None], ...]


def _chain(segments: int) -> bm.Chain:
    return bm.Chain(BEAM, BOUNDARY, segments, RULE)


def _by_chain(integrator: str) -> Tip:
    def tip(segments: int, step: float) -> Floats:
        motion = bm.simulate(
            _chain(segments),
            duration=TIME[-1],
            integrator=integrator,
            step=step,
            output_step=_EVERY,
            base=_BASE,
        )
        return np.asarray(motion.tip_deflection.values)

    return tip


def _mujoco_model(chain: bm.Chain, step: float, hub: float | None = None) -> tuple[Any, Any]:
    """Return a clamped-free chain in MuJoCo, on the world or on a hub of some inertia that turns about z."""
    import mujoco

    spec = mujoco.MjSpec()
    spec.option.timestep, spec.option.gravity = step, [0.0, 0.0, 0.0]
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    body, axis, place = spec.worldbody, [0.0, 0.0, 1.0], 0.0
    if hub is not None:
        body = body.add_body(mass=1.0, inertia=[hub] * 3, explicitinertial=True)
        body.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, axis=axis)
    # The first piece is the wall's.
    pieces = zip(chain.length, chain.centre, chain.mass, chain.rotary_inertia, strict=True)
    for spring, (length, centre, mass, inertia) in zip(chain.joint_stiffness, list(pieces)[1:], strict=True):
        # No inertia may be zero; that about the rod's own axis never moves.
        body = body.add_body(
            pos=[place, 0.0, 0.0],
            mass=mass,
            ipos=[centre, 0.0, 0.0],
            inertia=[1e-3 * inertia, inertia, inertia],
            explicitinertial=True,
        )
        body.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, axis=axis, stiffness=spring)
        place = length
    model = spec.compile()
    return model, mujoco.MjData(model)


def _by_mujoco(segments: int, step: float) -> Floats:
    import mujoco

    chain = _chain(segments)
    hub = _HEAVY * float(BEAM.mass_per_length) * float(BEAM.length) ** 3 / 3
    model, data = _mujoco_model(chain, step, hub)
    every, length = round(_EVERY / step), chain.length[1:]
    # The moment of a step is that of its middle; place and rate are set right before each.
    begin = np.arange(_OUTPUTS * every) * step
    (angle, rate, _), moment = _BASE.angle(begin), hub * _BASE.angle(begin + step / 2)[2]
    tips = np.zeros(_OUTPUTS + 1)
    for k, (place, turning, push) in enumerate(
        zip(angle.tolist(), rate.tolist(), moment.tolist(), strict=True)
    ):
        data.qpos[0], data.qvel[0], data.qfrc_applied[0] = place, turning, push
        mujoco.mj_step(model, data)
        if (k + 1) % every == 0:
            tips[(k + 1) // every] = length @ np.sin(np.cumsum(data.qpos[1:]))
    return tips


def _by_exudyn(elements: int, step: float) -> Floats:
    import exudyn
    from exudyn import itemInterface as item

    system = exudyn.SystemContainer().AddSystem()
    size, turning = float(BEAM.length) / elements, _BASE.angle
    nodes = [
        system.AddNode(item.NodePoint2DSlope1(referenceCoordinates=[k * size, 0, 1, 0]))
        for k in range(elements + 1)
    ]
    for left, right in pairwise(nodes):
        cable = item.Cable2D(
            nodeNumbers=[left, right],
            length=size,
            massPerLength=float(BEAM.mass_per_length),
            bendingStiffness=float(BEAM.bending_stiffness),
            axialStiffness=_STRETCH,
            useReducedOrderIntegration=1,
        )
        system.AddObject(cable)
    ground = system.AddMarker(
        item.MarkerNodeCoordinate(nodeNumber=system.AddNode(item.NodePointGround()), coordinate=0)
    )

    # Looked up at the end of each step, where constraints are asked for.
    count = round(TIME[-1] / step)
    phi = turning(np.arange(count + 1) * step)[0]
    slopes = (np.cos(phi) - 1).tolist(), np.sin(phi).tolist()

    def slope(part: int) -> Callable[[Any, float, int, float], float]:
        return lambda _system, t, _number, _offset: slopes[part][round(t / step)]

    for k in range(4):
        marker = system.AddMarker(item.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=k))
        follow = {"offsetUserFunction": slope(k - 2)} if k > 1 else {}
        system.AddObject(item.CoordinateConstraint(markerNumbers=[ground, marker], **follow))
    seen = system.AddSensor(
        item.SensorNode(
            nodeNumber=nodes[-1],
            storeInternal=True,
            outputVariableType=exudyn.OutputVariableType.Position,
        )
    )
    system.Assemble()
    settings = exudyn.SimulationSettings()
    course, newton = settings.timeIntegration, settings.timeIntegration.newton
    course.numberOfSteps, course.endTime = count, float(TIME[-1])
    course.adaptiveStep, course.verboseMode = False, 0
    newton.useModifiedNewton, newton.relativeTolerance, newton.absoluteTolerance = False, 1e-6, 1e-6
    settings.solution.file.write, settings.solution.sensors.writePeriod = False, _EVERY
    system.SolveDynamic(settings)
    found = system.GetSensorStoredData(seen)
    np.testing.assert_allclose(found[:, 0], TIME, atol=1e-9)
    phi = turning(TIME)[0]
    return np.asarray(np.cos(phi) * found[:, 2] - np.sin(phi) * found[:, 1])


#: Every method by its name in the table.
METHODS: dict[str, Method] = {
    "beammodes, `midpoint`": Method(
        _by_chain("midpoint"),
        "casadi",
        ((56, _EVERY / 6), (60, _EVERY / 7), (64, _EVERY / 8), (80, _EVERY / 6)),
    ),
    "beammodes, `sdirk2`": Method(
        _by_chain("sdirk2"),
        "casadi",
        ((56, _EVERY / 3), (64, _EVERY / 3), (60, _EVERY / 4), (72, _EVERY / 4)),
    ),
    "beammodes, `midpoint`, 200 rods": Method(
        _by_chain("midpoint"), "casadi", ((200, _EVERY / 6), (200, _EVERY / 7))
    ),
    "beammodes, `rk4`": Method(_by_chain("rk4"), "casadi", ((56, None), (60, None))),
    "MuJoCo `implicitfast`": Method(_by_mujoco, "mujoco", ((56, None), (60, None))),
    "Exudyn, cable elements, generalized alpha": Method(
        _by_exudyn,
        "exudyn",
        ((7, _EVERY / 16), (8, _EVERY / 14), (8, _EVERY / 16), (8, _EVERY / 20), (12, _EVERY / 20)),
    ),
}
_STABLE = {"mujoco": "MuJoCo implicitfast"}


def exact_tip() -> tuple[Floats, float]:
    """Return the exact tip's deflection at `TIME`, and how far two degrees of polynomials are apart [m]."""
    rough, fine = (tip_deflection(BEAM, _BASE.angle, TIME, degree=degree) for degree in _DEGREES)
    return fine, float(np.abs(fine - rough).max())


def _stable_step(package: str, segments: int) -> float:
    """Return the longest step that divides the output's and is stable, under the pull of the motion too."""
    limit = 0.98 * bm.stable_time_step(_chain(segments), _STABLE.get(package, "rk4"))
    return _EVERY / math.ceil(_EVERY / limit)


def spinning(names: Sequence[str] = tuple(METHODS)) -> str:
    """Return the least time in which each method reaches the accuracy."""
    exact, apart = exact_tip()
    largest = float(np.abs(exact).max())
    rows, first = [], math.nan
    for name in names:
        method = METHODS[name]
        if find_spec(method.package) is None:
            rows.append([name, "not run: not installed", "–", "–", "–", "–"])
            continue
        found = []
        for segments, given in method.tried:
            step = given or _stable_step(method.package, segments)
            start = time.process_time()
            tip = method.tip(segments, step)
            seconds = time.process_time() - start
            found.append((seconds, segments, step, float(np.abs(tip - exact).max()) / largest))
        reached = [each for each in found if each[3] <= ACCURACY]
        # What misses is shown with the best that it reached.
        seconds, segments, step, error = min(reached) if reached else min(found, key=lambda each: each[3])
        first = seconds if math.isnan(first) else first
        mark = "" if reached else ", not reached"
        rows.append(
            [
                name,
                f"{segments}",
                f"{step:.2g} s",
                f"{error:.1e}{mark}",
                duration(seconds),
                f"{seconds / first:.2g}",
            ]
        )
    columns = ["method", "N", "step", "error", "processor time", "ratio"]
    return (
        f"**Spin-up of Simo and Vu-Quoc's beam**, its first {TIME[-1]:g} s: the least processor time, "
        f"building included, in which the tip's deflection, looked at every {_EVERY:g} s, comes within "
        f"{ACCURACY:g} of the largest one, by the N and steps that were tried (explicit methods at their "
        "longest stable step). "
        f"Chains have rule `{RULE}`, MuJoCo the same one; Exudyn has its own elements, of ANCF. Exact is the "
        f"inextensible beam of large rotations by polynomials of degree {_DEGREES[1]}: {-largest:.7f} m, "
        f"{apart / largest:.0e} from degree {_DEGREES[0]}.\n\n" + markdown_table(columns, rows)
    )


def growing(counts: Sequence[int] = (50, 200, 1000, 10_000)) -> str:
    """Return what one period of a cantilever's first mode costs at each N, by implicit and explicit steps."""
    names = (
        "beammodes, `midpoint`",
        "beammodes, `sdirk2`",
        "beammodes, `rk4`, foretold",
        "MuJoCo `implicitfast`, foretold",
    )
    columns = [[_period(name, segments) for name in names] for segments in counts]
    rows = [[name, *(column[k] for column in columns)] for k, name in enumerate(names)]
    return (
        "**One period of a cantilever's first mode**, building not included: implicit methods at the step "
        "that keeps its frequency to 0.1 %, whatever N is; explicit ones at their longest stable step, "
        "foretold from a few of them.\n\n" + markdown_table(["method", *(f"N = {n:,}" for n in counts)], rows)
    )


def _period(name: str, segments: int) -> str:
    chain = bm.Chain(bm.Beam.unit(), BOUNDARY, segments)
    omega = float(bm.solve_modes(bm.linearize(chain), 1).angular_frequency[0])
    q, u = bm.mode_start(chain, 1, 0.1)
    kind = name.split("`")[1]
    if kind in ("midpoint", "sdirk2"):
        stepper = ImplicitStepper(chain, integrator=kind)
        state = np.concatenate([q, stepper.momenta(q, u, np.zeros(9))])
        count = math.ceil(2 * math.pi / accuracy_limit(kind))
        seconds = timed(lambda: stepper.steps(state, 2 * math.pi / omega / count, 0.0, count, BaseMotion()))[
            0
        ]
        return f"{duration(seconds)}, {count} steps"
    if kind == "rk4":
        limit, few = bm.stable_time_step(chain), 10
        explicit, state = runge_kutta(chain), np.concatenate([q, u])
        explicit.steps(state, limit, 0.0, few, BaseMotion())
        seconds = timed(lambda: explicit.steps(state, limit, 0.0, few, BaseMotion()))[0] / few
    elif find_spec("mujoco") is None:
        return "not run: not installed"
    elif segments > 200:
        return "not tried"
    else:
        import mujoco

        limit = bm.stable_time_step(chain, "MuJoCo implicitfast")
        model, data = _mujoco_model(chain, limit)
        data.qpos[:] = np.diff(q, prepend=0.0)
        seconds = timed(lambda: mujoco.mj_step(model, data))[0]
    count = math.ceil(2 * math.pi / omega / limit)
    return f"{duration(seconds * count)}, {count:,} steps"
