"""Motion of a chain in time: fixed-step, variable-step and symplectic integration."""

from __future__ import annotations

import io
import math
import warnings
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.checks import bounded, choice, flag, positive_real, real, real_numbers, shown, whole_number
from beammodes.deferred import Deferred
from beammodes.dynamics.base_motion import BaseMotion, base_vector
from beammodes.dynamics.forward_dynamics import checked_system
from beammodes.dynamics.runs import Run, projection, runner
from beammodes.dynamics.step_choice import OUTPUTS, Chosen, Motion, chosen, untold_jumps
from beammodes.dynamics.time_inputs import TimeInputs
from beammodes.dynamics.timed_loads import AnyLoad, read_loads
from beammodes.equations.equilibria import Equilibrium
from beammodes.equations.held_apart import checked_span, string_tension
from beammodes.equations.mechanics import Algebra, Span, coordinate_names, piece_energies, tip_names
from beammodes.files import file_target, write_atomically
from beammodes.numerics.arrays import Floats
from beammodes.problem.dimensions import unit_attributes
from beammodes.problem.loading import Load
from beammodes.progress import Progress, held, progress_of
from beammodes.version import SOURCE
from beammodes.vibration.damping import Damping
from beammodes.vibration.integrators import INTEGRATORS
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes
from beammodes.vibration.stability import stable_time_step

if TYPE_CHECKING:
    import xarray
else:
    xarray = Deferred("xarray")

__all__ = [
    "MOTION_INTEGRATORS",
    "DivergedWarning",
    "NothingMovesWarning",
    "UnsavedMotion",
    "UnstableStepWarning",
    "mode_start",
    "simulate",
]

#: Of variable-step ones the step is the largest one and the one of output: the report's recipe.
MOTION_INTEGRATORS: tuple[str, ...] = tuple(name for name, record in INTEGRATORS.items() if record.run)
#: A motion that takes more memory is refused [bytes].
MAX_MEMORY = 4 * 2**30
# Numbers of 8 bytes that are held for each output time: for each piece, and for all of them. A
# motion of 60 segments was measured to take 19 for each segment while its dataset is made.
_FOR_SEGMENT, _FOR_TIME = 20, 40

#: What a motion holds: the dimension beside time, description, unit.
_HELD = {
    "angle": ("segment", "angle of each rigid segment", "rad"),
    "angular_velocity": ("segment", "rate of each segment's angle", "rad/s"),
    "x": ("node", "position of each node along the beam at rest", "m"),
    "y": ("node", "position of each node across it", "m"),
    "q": ("coordinate", "generalized coordinates", "m, rad"),
    "u": ("coordinate", "generalized speeds", "m/s, rad/s"),
    "tip_deflection": (None, "right tip's distance from the line of the base or hub", "m"),
    "kinetic_energy": (None, "kinetic energy", "J"),
    "potential_energy": (None, "energy of springs, supports and a constant Load", "J"),
    "energy": (None, "kinetic and potential energy", "J"),
    "load_work": (None, "work that all other loads have done", "J"),
    "momentum_x": (None, "momentum along x", "N s"),
    "momentum_y": (None, "momentum along y", "N s"),
    "angular_momentum": (None, "angular momentum about the origin", "N m s"),
}

Start = tuple[Floats, Floats]


class _HeldStart(Start):
    """Coordinates and speeds of a chain whose right end stays held at the end of a `span`."""

    span: Span | None = None


def mode_start(
    chain: Chain, mode: int, amplitude: float, *, load: Load | None = None, at: Equilibrium | None = None
) -> Start:
    """Return coordinates and speeds of a chain at rest in the shape of a mode.

    Parameters
    ----------
    chain : Chain
    mode : int
        1-based index of an elastic mode.
    amplitude : float [rad]
        Largest angle of a segment.
    load : Load, optional
        Under which the modes are taken.
    at : Equilibrium, optional
        The shape that it vibrates about, straight by default.

    Returns
    -------
    Start
        To be given to `simulate` as `start=`.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or the chain has no such mode.

    Examples
    --------
    >>> import beammodes as bm
    >>> bm.mode_start(bm.Chain(bm.Beam.unit(), "clamped-free", segments=2), 1, 0.1)[0].round(4)
    array([0.0558, 0.1   ])
    """
    model = linearize(chain, load=load, at=at) if at is not None else linearize(chain, load=load)
    number = whole_number("mode", mode, most=model.elastic_modes)
    amplitude = real("amplitude", amplitude, "rad")
    modes = solve_modes(model, number)
    rotation, deflection = modes.rotation[number - 1], modes.deflection[number - 1]
    scale = amplitude / np.abs(rotation).max()
    tips = {"x_0": 0.0, "y_0": deflection[0]}
    q = [*(tips[name] for name in tip_names(chain)), *rotation[~np.array(chain.held_angles)]]
    rest = np.zeros(len(q)) if at is None else at.coordinates
    start = rest + scale * np.array(q), np.zeros(len(q))
    if not chain.boundary.right.holds_deflection:
        return start
    held = _HeldStart(_onto(chain, start, BaseMotion(), None if at is None else at.span))
    held.span = None if at is None else at.span
    return held


def _held_apart(chain: Chain, initial: Any, span: Any) -> Span | None:
    """Return where the right end is held, as `span` or the shape that the motion starts from says."""
    known = initial.span if isinstance(initial, Equilibrium | _HeldStart) else None
    if span is None:
        return known
    given = checked_span(chain, span)
    if known is not None and known != given:
        raise ValueError(f"span must be left out or be that of initial, {known}, got {shown(span)}")
    if initial is None:
        raise ValueError("initial must be given with span: no straight chain has its ends there")
    return given


def _initial_state(chain: Chain, initial: Any, base: BaseMotion, span: Span | None) -> Start:
    """Return the first state, on the closure of a chain whose right end is held."""
    course, names = base.at(0.0), coordinate_names(chain)
    rest = [{"x_0": course[0, k], "y_0": course[1, k]} for k in (0, 1)]
    q, u = (np.array([rest[k].get(n, course[2, k]) for n in names]) for k in (0, 1))
    if initial is not None and hasattr(initial, "coordinates"):
        q = np.asarray(initial.coordinates, dtype=np.float64)
    elif initial is not None:
        try:
            q, u = bounded("initial", initial, most=2)
        except (TypeError, ValueError):
            raise TypeError(f"initial must be coordinates and speeds, got {shown(initial)}") from None
        q, u = real_numbers("initial", q, "rad"), real_numbers("initial", u, "rad/s")
    for part in (q, u):
        if part.shape != (len(names),) or not np.isfinite(part).all():
            raise ValueError(f"initial must be finite numbers for {', '.join(names)}, got {shown(part)}")
    if not chain.boundary.right.holds_deflection:
        return q, u
    state = _onto(chain, (q, u), base, span)
    if np.abs(state[0] - q).max() > 1e-3:
        raise ValueError("initial must leave the right end where its support holds it")
    return state


def _onto(chain: Chain, start: Start, base: BaseMotion, span: Span | None) -> Start:
    """Return the nearest state on the closure."""
    onto = projection(chain, span)
    state = np.concatenate(start)
    for _ in range(4):
        state = np.array(onto(state, base_vector(base, 0.0)))[:, 0]
    return state[: len(start[0])], state[len(start[0]) :]


def _motion_dataset(
    chain: Chain,
    found: Sequence[Floats],
    load: Load,
    base: BaseMotion,
    attributes: dict[str, Any],
) -> xarray.Dataset:
    """Return a motion as `simulate` describes it, found as times, coordinates, speeds and loads' work."""
    import xarray

    time, q, u, work = found
    course, length, centre = base.at(time), chain.length, chain.centre
    angle, spin = (_of_pieces(chain, values, course[2, k]) for k, values in enumerate((q, u)))
    tip, tip_speed = (_of_tip(chain, values, course[:2, k]) for k, values in enumerate((q, u)))
    cosine, sine = np.cos(angle), np.sin(angle)
    x, y = (_summed(start, length * part) for start, part in zip(tip, (cosine, sine), strict=True))
    # A hub that turns carries the line with it.
    phi = angle[:, 0] if chain.boundary.left.hub_radius else course[2, 0]
    dx, dy = x[:, -1] - course[0, 0], y[:, -1] - course[1, 0]
    # A diverging run may end in numbers whose squares are too large.
    with np.errstate(over="ignore", invalid="ignore"):
        kinetic, potential, _ = piece_energies(
            chain,
            tip,
            tip_speed,
            list(angle.T),
            list(spin.T),
            Algebra.physical(chain, np.sin, np.cos),
            load,
            (course[1, 0], course[2, 0]),
        )
        swing = (-sine * spin, cosine * spin)
        px, py = (
            chain.mass * (_summed(start, length * part)[:, :-1] + centre * part)
            for start, part in zip(tip_speed, swing, strict=True)
        )
        turning = (x[:, :-1] + centre * cosine) * py - (y[:, :-1] + centre * sine) * px
        values = {
            "angle": angle,
            "angular_velocity": spin,
            "x": x,
            "y": y,
            "q": q,
            "u": u,
            "tip_deflection": dy * np.cos(phi) - dx * np.sin(phi),
            "kinetic_energy": kinetic,
            "potential_energy": potential,
            "energy": kinetic + potential,
            "load_work": work,
            "momentum_x": px.sum(axis=1),
            "momentum_y": py.sum(axis=1),
            "angular_momentum": (turning + chain.rotary_inertia * spin).sum(axis=1),
        }
    numbers = np.arange(chain.pieces + 1)
    return xarray.Dataset(
        {
            name: (
                ("time", each) if each else ("time",),
                values[name],
                {"long_name": text, **unit_attributes(unit)},
            )
            for name, (each, text, unit) in _HELD.items()
        },
        coords={
            "time": ("time", time, {"long_name": "time", "units": "s"}),
            "segment": ("segment", numbers[1:], {"long_name": "rigid segment", "units": "1"}),
            "node": ("node", numbers, {"long_name": "tip or hinge", "units": "1"}),
            "coordinate": coordinate_names(chain),
        },
        attrs={"source": SOURCE, **attributes},
    )


def _summed(start: Floats, steps: Floats) -> Floats:
    """Return the start and every sum of it and the first steps, shape (times, steps + 1)."""
    return np.concatenate([start[:, None], start[:, None] + np.cumsum(steps, axis=1)], axis=1)


def _of_pieces(chain: Chain, values: Floats, held: Floats) -> Floats:
    """Return angles or rates of all pieces, those included that the base prescribes."""
    full = np.repeat(held[:, None], chain.pieces, axis=1)
    full[:, ~np.array(chain.held_angles)] = values[:, len(tip_names(chain)) :]
    return full


def _of_tip(chain: Chain, values: Floats, given: Floats) -> tuple[Floats, Floats]:
    """Return position or velocity of the left tip."""
    names = tip_names(chain)
    x, y = (values[:, names.index(n)] if n in names else given[k] for k, n in enumerate(("x_0", "y_0")))
    return x, y


class DivergedWarning(UserWarning):
    """A motion left the finite numbers: the step was too long, or the chain unstable."""


class NothingMovesWarning(UserWarning):
    """A motion without a start, a load that bends or a base that moves."""


class UnsavedMotion(OSError):
    """A motion was computed, but could not be written to its file.

    Attributes
    ----------
    motion : xarray.Dataset
        The result of `simulate`.
    """

    motion: xarray.Dataset


class UnstableStepWarning(UserWarning):
    """A fixed step is longer than the longest at which the chain's small motions stay bounded."""


def simulate(
    chain: Chain,
    *,
    duration: float,
    integrator: str | None = None,
    step: float | None = None,
    modes: int | None = None,
    output_step: float | None = None,
    initial: Any = None,
    span: float | Span | None = None,
    load: AnyLoad | Sequence[AnyLoad] | None = None,
    base: BaseMotion | None = None,
    damping: Damping | None = None,
    tolerance: float = 1e-9,
    halve_step: bool = False,
    progress: Progress | bool | None = False,
    path: str | Path | None = None,
) -> xarray.Dataset:
    """Return the motion of a chain, large rotations included.

        M(q) q'' + h(q, q') + s(q) + C q' = (∂c/∂q)ᵀ λ + f(q, t)

    Parameters
    ----------
    chain : Chain
        Its left end tied to the base, or neither end held.
    duration : float [s]
        A fixed step ends the motion with the first step that reaches it.
    integrator : str, optional
        One of `INTEGRATORS` that has a run, such as "rk4", "midpoint", or with a variable step "dop853". With
        a step and no integrator it is "rk4". With neither it is "rk4" where its stable steps are cheap or
        cost no more than implicit ones, else "midpoint" if nothing damps the motion, which keeps its
        energy, and "sdirk2" if something does, which damps the modes that a step does not resolve.
    step : float [s], optional
        At most `duration`. Of fixed steps by default half the longest stable one of an explicit method, with
        the damping and with the pull of loads and base, or less where a load varies faster. That of an
        implicit method is bounded by accuracy alone: the last of `modes`, the base, the loads and the start's
        turning keep their frequency to 0.1 % (and the mode its amplitude to 1 %) over 100 periods. The
        longest one of variable steps, by default that of output.
    modes : int, optional
        How many of the lowest elastic modes an implicit step must resolve. By default those that hold 99.9 %
        of what the start stores, at most 20, and no fewer than three under a load or on a moving base.
    output_step : float [s], optional
        Between output times, rounded to whole steps; a thousandth of the duration by default. The motion is
        held in memory, and refused if it takes more than 4 GiB.
    initial : pair of arrays, or Equilibrium, optional
        Coordinates and speeds (in the order of `coordinate_names`), or a shape to start from at rest;
        straight and at rest with the base by default. `mode_start` gives a mode. An Equilibrium does not
        bring its load: give that too.
    span : float or pair [m], optional
        Where the right end is held, from the left one, as `find_equilibrium` takes it; by default where an
        Equilibrium to start from, or a mode about one, holds it. On a base that moves both ends shift with
        it.
    load : Load, PointLoad, LineLoad, TimedLoad, or list of them, optional
        At most one `Load` that is constant (its forces are dead, and have a potential; no spin rate); any
        number of forces and moments at points, of loads along the beam, and of loads that vary in time or
        follow the segment they act on (`TimedLoad`). Steps of every method end where one of these jumps or
        kinks, and so where a course of the base does.
    base : BaseMotion, optional
    damping : Damping, optional
    tolerance : float
        Relative, of variable-step integrators; absolute is a thousandth of it.
    halve_step : bool
        Run again with half the (fixed) step, at twice the cost, and give attributes `tip_error` [m] and
        `angle_error` [rad]: the largest errors of tip_deflection and of a segment's angle that the steps
        make at the output times, by Richardson's extrapolation. It holds where steps are short enough for
        errors to fall with the method's order.
    progress : bool, callable or None
        True shows on standard error, or in a notebook below the cell, how far a run is, None only on a
        terminal or in a notebook; a function is called with (steps or output times done, all of them).
    path : str or Path, optional
        netCDF file for the result, also for what an interrupted run has. It is asked for before the motion
        whether it can be written, and replaced in one step.

    Returns
    -------
    xarray.Dataset
        Over time: angle and angular_velocity of each segment, x and y of each node, tip_deflection, energies,
        load_work and momenta, q and u. On a hub node 0 is its axis and segment 1 the hub. Attributes
        `integrator` and `step` [s] are those of the run, `reason` says why these, and `step_error` what an
        implicit step does to the modes that it was chosen for, as of a small motion; `remark` says so if
        nothing moves, or a load seems to jump and does not tell where. Attribute `complete` is 0 if the run
        was interrupted from the keyboard or left the finite numbers; `stopped` then says why. What came
        before is kept. Without damping, on a base at rest, `energy` less `load_work` changes by the error of
        the steps only: it tells whether they were short enough.
        Ctrl-C, however often, ends the motion with the step that it came in, and what there is of it is put
        together and written before this function returns. While equations are built there is nothing to
        keep: it is then a KeyboardInterrupt.

    Warns
    -----
    NothingMovesWarning
        Before the run, if there is nothing that could move the chain.
    DivergedWarning
        If the state is no longer finite.
    UnstableStepWarning
        Before a run whose fixed `step` is longer than `stable_time_step` of the chain with its damping and
        axial pull: its energy grows, also where no number overflows.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, or the base cannot move this chain.
    FileNotFoundError, PermissionError
        If the folder of `path` is missing or may not be written to.
    UnsavedMotion
        If the file could not be written after all, as on a full disk; the motion is its attribute `motion`.

    Examples
    --------
    >>> import beammodes as bm
    >>> chain = bm.Chain(bm.Beam.unit(), "clamped-free", segments=4)
    >>> motion = bm.simulate(chain, duration=1.0, initial=bm.mode_start(chain, 1, 0.01))
    >>> bool(abs(motion.energy / motion.energy[0] - 1).max() < 1e-6)
    True
    """
    given, timed = read_loads(load)
    checked_system(chain, given, damping, base)
    drive = TimeInputs(base or BaseMotion(), timed)
    ground = drive.base
    apart, lasting = _held_apart(chain, initial, span), positive_real("duration", duration)
    kind = None if integrator is None else choice("integrator", integrator, MOTION_INTEGRATORS)
    most = max(1, chain.elastic_modes + chain.boundary.rigid_body_modes)
    wanted = None if modes is None else whole_number("modes", modes, most=most)
    halving = flag("halve_step", halve_step)
    if halving and kind is not None and INTEGRATORS[kind].variable_step:
        raise ValueError(f"halve_step must be False for {kind}, which chooses its steps itself")
    shown_step = lasting / OUTPUTS if output_step is None else positive_real("output_step", output_step)
    told = progress_of(progress, "simulation", "steps")
    if path is not None:
        file_target(path)
    tolerance = positive_real("tolerance", tolerance)
    if tolerance < 1e-13:
        raise ValueError(f"tolerance must be at least 1e-13, got {shown(tolerance)}")
    step = None if step is None else positive_real("step", step)
    if step is not None and step > lasting:
        raise ValueError(f"step must not be longer than duration, {lasting}, got {shown(step)}")
    start = _initial_state(chain, initial, ground, apart)
    motion = Motion(chain, lasting, given, drive, damping, start, wanted, apart)
    took = _taken(motion, kind, step, min(shown_step, lasting))
    if lasting / took.step > 1e9:
        raise ValueError(
            f"duration must be shorter, or step longer: {lasting / took.step:.2g} steps of {took.step:.3g} s"
        )
    every = max(1, round(min(shown_step, lasting) / took.step))
    _check_memory(chain, lasting, took.step * every)
    remark = _remark(motion)
    if remark == _NOTHING:
        warnings.warn(remark, NothingMovesWarning, stacklevel=2)
    if step is not None and not INTEGRATORS[took.integrator].variable_step:
        hung = 0.0 if apart is None else string_tension(chain, given, apart)
        taut = Load(axial_force=max(hung, float(given.axial_force)))
        limit = stable_time_step(chain, took.integrator, load=taut, damping=damping)
        if step > limit * (1 + 1e-9):
            message = (
                f"step must be at most {limit:.6g} s for {took.integrator} to be stable on this chain, got "
                f"{step:.6g} s"
            )
            warnings.warn(f"{message}: the energy will grow", UnstableStepWarning, stacklevel=2)
    steps = math.ceil(lasting / took.step - 1e-9)
    run = Run(
        chain,
        given,
        drive,
        damping or Damping(),
        lasting,
        took.step,
        every,
        steps,
        float(tolerance),
        took.integrator,
        apart,
    )
    with held():
        *found, why = runner(run.integrator)(run, start, told)
        attributes = {**asdict(took), "complete": int(not why), "stopped": why, "remark": remark}
        result = _motion_dataset(chain, found, given, ground, attributes)
        if halving:
            result = result.assign_attrs(_errors(run, start, told, result))
        if path is not None:
            _save(result, path)
    if why.startswith("non-finite"):
        warnings.warn(f"{why}: the step is too long or the motion unstable", DivergedWarning, stacklevel=2)
    return result


def _taken(motion: Motion, kind: str | None, step: float | None, longest: float) -> Chosen:
    """Return method and step, of which those that are given stay; no step is longer than `longest`."""
    if kind is not None and INTEGRATORS[kind].variable_step:
        return Chosen(kind, step or longest, "the method chooses its steps; this is the longest")
    if step is not None:
        return Chosen(kind or "rk4", step, "step as given")
    return chosen(motion, kind, longest)


_NOTHING = "nothing moves: give a start (mode_start makes one), a load that bends or a base that moves"


def _remark(motion: Motion) -> str:
    """Say so if nothing will move, or a load seems to jump unannounced."""
    if motion.rests and not np.any(motion.start):
        return _NOTHING
    return untold_jumps(motion)


def _errors(run: Run, start: Start, told: Progress, result: xarray.Dataset) -> dict[str, float]:
    """Return the largest errors at the output times, by the motion at half the step."""
    half = replace(run, step=run.step / 2, every=2 * run.every, steps=2 * run.steps)
    *found, why = runner(run.integrator)(half, start, told)
    fine = _motion_dataset(run.chain, found, run.load, run.drive.base, {})
    whole = not why and result.complete
    share = 2.0 ** INTEGRATORS[run.integrator].order
    values = {"tip_error": "tip_deflection", "angle_error": "angle"}
    return {
        name: float(np.abs(fine[each].values - result[each].values).max()) * share / (share - 1)
        if whole
        else math.nan
        for name, each in values.items()
    }


def _check_memory(chain: Chain, span: float, output: float) -> None:
    """Raise ValueError if a motion with so many output times does not fit."""
    size, count = 8 * (_FOR_SEGMENT * chain.pieces + _FOR_TIME), span / output
    if count * size > MAX_MEMORY:
        raise ValueError(
            f"output_step must be at least {span * size / MAX_MEMORY:.3g} s: {count:.3g} output times of "
            f"{chain.pieces} pieces would take {count * size / 2**30:.3g} GiB of memory; a longer motion can "
            "be simulated in parts, each with the end of the last one as its initial"
        )


def _save(result: xarray.Dataset, path: str | Path) -> None:
    import h5netcdf
    from xarray.backends import H5NetCDFStore

    try:
        # In memory first: HDF5 that meets a full disk may end the whole process when it closes the file.
        whole = io.BytesIO()
        with h5netcdf.File(whole, "w") as file:
            result.dump_to_store(H5NetCDFStore(file))
        write_atomically(path, lambda file: file.write(whole.getbuffer()))
    except Exception as error:
        unsaved = UnsavedMotion(
            f"path could not be written, but the motion is this error's attribute `motion`: {error}"
        )
        unsaved.motion = result
        raise unsaved from error
