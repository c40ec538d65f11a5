"""A chain as a file for other programs: MJCF, SDFormat, URDF, USD, CSV, or a script."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO

from beammodes.chains.chain import Chain
from beammodes.chains.spatial_chain import SpatialChain
from beammodes.chains.structure_chain import StructureChain
from beammodes.checks import choice, flag, instead, shown
from beammodes.equations.equilibria import Equilibrium
from beammodes.equations.joint_laws import JointLaw, joint_law
from beammodes.exporters.engine_step import engine_step
from beammodes.exporters.engine_step_in_space import engine_step_in_space
from beammodes.exporters.export_facts import facts_about, facts_about_rod
from beammodes.exporters.formats import FORMATS, Format, Model
from beammodes.exporters.model_tree import Tree, Vector
from beammodes.exporters.planar_tree import planar_tree
from beammodes.exporters.spatial_tree import spatial_tree
from beammodes.exporters.structure_files import STRUCTURE_FORMATS, structure_texts
from beammodes.exporters.unit_systems import UNIT_SYSTEMS
from beammodes.files import file_target, write_atomically
from beammodes.numerics.blas import one_thread
from beammodes.problem.load_in_space import SpatialLoad
from beammodes.problem.loading import Load
from beammodes.vibration.damping import Damping, checked_damping
from beammodes.vibration.integrators import INTEGRATORS
from beammodes.vibration.modes_in_space import spatial_modes

__all__ = ["MUJOCO_INTEGRATORS", "export_chain"]

#: Integrators that a file may ask MuJoCo for: not the one that takes springs implicitly, which adds damping.
MUJOCO_INTEGRATORS = tuple(
    alias.removeprefix("MuJoCo ")
    for record in INTEGRATORS.values()
    for alias in record.engines
    if alias.startswith("MuJoCo ") and alias.count(" ") == 1 and record.springs == "explicit"
)


#: Formats of bodies and joints, which hold a chain in space.
SPATIAL_FORMATS = tuple(name for name, kind in FORMATS.items() if kind.most_bodies is not None)


def export_chain(
    chain: Chain | StructureChain | SpatialChain,
    path: str | os.PathLike[str],
    *,
    format: str | None = None,
    name: str = "chain",
    fragment: bool = False,
    second: Chain | None = None,
    damping: Damping | None = None,
    timestep: float | None = None,
    integrator: str = "RK4",
    load: Load | SpatialLoad | None = None,
    at: Equilibrium | None = None,
    units: str | None = None,
    joints: str | JointLaw = "yzx_alternating",
    force: bool = False,
) -> tuple[Path, ...]:
    """Write a chain as a model for a multibody program, with the frequencies to expect in its head.

    A beam runs along x from its firmer end and deflects along z. A rod in space keeps the axes of its section
    at s = 0; each node has three hinges, or a ball joint, and each piece its whole inertia and its place at
    rest, where all angles are zero. A supported far end needs "mjcf", there for small deflections.
    Tests read files back with MuJoCo (MJCF), Drake (SDFormat, URDF), DART (SDFormat), Pinocchio (URDF),
    PyBullet and Exudyn, and find the chain's frequencies to 1e-8; with OpenUSD to 1e-6, whose numbers are of
    single precision. Springs come along in all but URDF and what Drake reads of MJCF.

    Parameters
    ----------
    chain : Chain, StructureChain or SpatialChain
        A structure's x and y are x and z in the file; of the options from `fragment` to `units` it takes
        `damping` (in proportion to stiffness), `timestep`, `integrator` and a `load` that is gravity only,
        which its step and the frequencies told do not know. "mjcf" holds any: closed frames and further
        supports by constraints and tendons. For "sdf" its supports must hold joints along x and y, and loops
        are closed by joints, which not every physics engine takes (Drake does not). For "urdf" it must be a
        tree, supported at one joint.
        A chain in space is for all but "csv".
    path : str or Path
    format : str, optional
        "mjcf" for MuJoCo 3 and 4, "sdf" for Gazebo, DART and Drake, "urdf" (with the springs in a YAML file
        beside it, `.springs.yaml`), "usd" for Newton and Isaac Lab (an articulation in the UsdPhysics schema,
        each spring a drive of its joint), "pybullet" (a script, which loads a URDF file beside it and sets
        its springs), "exudyn" (a script) or "csv" (see `read_chain_csv`); by default that of the suffix,
        .xml, .sdf, .urdf, .usda or .csv: for scripts, .py, say which.
    name : str
        Of the model; names of its bodies and joints begin with it.
    fragment : bool
        For "mjcf" and "sdf": a part to include in other models, without gravity and time step.
    second : Chain, optional
        Not for "csv": the same pieces with the springs of bending along y, for hinges about both axes. They
        come in turns, about y first at every other node and about z first between them: in one fixed order a
        chain that bends out of both planes would twist by an angle of first order in 1/N, so by second order
        only. In all but "mjcf" a nearly massless link stands between the two. Twist is not modelled: a
        `SpatialChain` has it, and needs no second one.
    damping : Damping, optional
        Of joints and supports; not for "csv". In space in proportion to stiffness only.
    timestep : float [s], optional
        Not for "urdf", "usd" and "csv". By default half the largest stable one (`stable_time_step`, with the
        engine's way of taking dampers), less where the integrator would shift the first frequency by more
        than 0.1 % and by more than a tenth of its damping ratio. The file says the limit, and for which case
        it holds; a "urdf" file, which has no step, says those of PyBullet, Drake, Newton and PhysX, a "usd"
        file Newton's.
    integrator : str
        For "mjcf": "RK4", "Euler", "implicit" or "implicitfast". An "sdf" file's step is that of Drake's
        discrete plants.
    load : Load, optional
        Not for "urdf" and "csv": the file carries its gravity, x along the beam and y up, and the step holds
        under it and its forces (which the file cannot carry: apply them yourself). Without one the file has
        no gravity, and its step holds without gravity and with 9.81 m/s² in any direction, also for a chain
        that then hangs, which its weight and body stiffen. With one, the head also has the frequencies, and
        with `damping` the ratios, about the shape at rest under it. For a chain in space a `SpatialLoad`,
        along the axes at s = 0; the limit that the file then says is that of a chain which hangs.
    at : Equilibrium, optional
        For "mjcf": a shape at rest to start from, as the keyframe "rest", under its load. Ends that it holds
        apart the file holds too, by a constraint between two sites, which does not fail in large motion.
    units : str, optional
        What the beam's numbers are in, "SI", "mm-N-t" or "in-lbf-s": for words in the head, and for the
        gravity that the step holds for. The file's numbers stay as they are.
    joints : str or JointLaw
        Of a chain in space: in which order a node's three hinges turn, from s = 0 on, or "ball" where GJ and
        both EI are equal, for "mjcf" (see `equations.joint_laws`). In one order at all nodes a rod that bends
        and twists is wrong at first order in 1/N. In all but "mjcf" nearly massless links stand between
        hinges; the file says how light.
    force : bool
        Overwrite files that exist. Without it, one of two exports to the same path at the same time succeeds.
        Only ordinary files are overwritten; a symbolic link to one stands for it.

    Returns
    -------
    tuple of Path
        Of the files written.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind or not for that format, or the format cannot hold the chain.
    FileExistsError, FileNotFoundError, PermissionError
        If a file exists and `force` is not set, or the folder is missing or may not be written to.

    Examples
    --------
    >>> import tempfile
    >>> import beammodes as bm
    >>> chain = bm.Chain(bm.Beam(1.2, 85.0, 0.62), "clamped-free", segments=8, rule="gregory")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     [path.name for path in bm.export_chain(chain, f"{folder}/beam.urdf")]
    ['beam.urdf', 'beam.springs.yaml']
    """
    if not isinstance(chain, Chain | StructureChain | SpatialChain):
        hint = instead(chain, AxialChain="a file twists as SpatialChain(Rod.from_beam(beam), ...)")
        raise TypeError(
            f"chain must be a Chain, a StructureChain or a SpatialChain, got {shown(chain)}{hint}"
        )
    law = joint_law(joints)
    place, kind = _place_and_format(path, format)
    flag("fragment", fragment), flag("force", force)
    if not isinstance(integrator, str):
        raise TypeError(f"integrator must be one of {', '.join(MUJOCO_INTEGRATORS)}, got {shown(integrator)}")
    system = UNIT_SYSTEMS["SI" if units is None else choice("units", units, UNIT_SYSTEMS)]
    given: dict[str, object] = {"fragment": fragment or None, "second": second, "damping": damping}
    given |= {
        "timestep": timestep,
        "load": load,
        "at": at,
        "integrator": None if integrator == "RK4" else integrator,
    }
    for what, value in given.items():
        if value is not None and what not in kind.takes:
            takers = ", ".join(each.name for each in FORMATS.values() if what in each.takes)
            raise ValueError(f"{what} must be left out for {kind.name} files: it is for {takers}")
    loads = SpatialLoad if isinstance(chain, SpatialChain) else Load
    checked_damping(damping)
    for what, known in (("second", Chain), ("load", loads), ("at", Equilibrium)):
        if not isinstance(given[what], known | None):
            article = "an" if known is Equilibrium else "a"
            raise TypeError(f"{what} must be {article} {known.__name__} or None, got {shown(given[what])}")
    if not isinstance(name, str) or not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]{0,59}", name):
        raise ValueError(f'name must be a word of letters, digits and _ such as "beam", got {shown(name)}')
    if re.fullmatch(kind.reserved, name):
        raise ValueError(f"name must be no word that {kind.name} files reserve, got {shown(name)}")
    paths = kind.paths(place)
    for each in paths:
        file_target(each, new=not force)
    if isinstance(chain, StructureChain):
        return _write(paths, force, *_structure(chain, kind, name, {**given, "units": units}))
    engine = kind.engine
    if engine and "integrator" in kind.takes:
        engine += f" {choice('integrator', integrator, MUJOCO_INTEGRATORS)}"
    step = 0.0
    if isinstance(chain, SpatialChain):
        dead = load if isinstance(load, SpatialLoad) else None
        choice("format of a chain in space", kind.name, SPATIAL_FORMATS)
        if second is not None:
            raise ValueError("second must be left out for a chain in space, which bends in both planes")
        if at is not None:
            raise ValueError("at must be left out for a chain in space, whose shape at rest is in its frames")
        if not law.orders and not kind.balls:
            able = ", ".join(each.name for each in FORMATS.values() if each.balls)
            raise ValueError(
                f"joints must be hinges, such as yzx_alternating, in {kind.name} files, got {law.name}, "
                f"which is for {able}"
            )
        build = partial(spatial_tree, chain, name, law, damping, balls=kind.balls)
        tree = _tree(kind, chain.tree.pieces, chain.ends, build)
        facts = facts_about_rod(chain, damping, units)
        if engine:
            first = float(spatial_modes(chain, 1).angular_frequency.max(initial=0.0))
            step, lines = engine_step_in_space(first, engine, tree, damping, timestep, dead, units)
            facts += lines
        for other in kind.said:
            facts += _limits(engine_step_in_space(0.0, other, tree, damping, None, dead, units)[1], facts)
        gravity = dead.gravity if dead is not None else (0.0, 0.0, 0.0)
    else:
        plain = load if isinstance(load, Load) else None
        pull = None
        if at is not None:
            plain = _checked_start(chain, at, plain, fragment=fragment, second=second)
            pull = None if at.span is None else float(at.tension.max())
        build = partial(planar_tree, chain, name, second=second, damping=damping, at=at)
        tree = _tree(kind, chain.pieces, chain.boundary.name, build)
        facts = facts_about(chain, damping, plain, units, turned=tree.turned, at=at)
        if second is not None:
            # Not about a shape bent in the other plane, which is not a motion in one plane.
            straight = plain if plain is not None and not plain.bends else None
            facts += [f"along y: {line}" for line in facts_about(second, damping, straight, units)[1:-1]]
        chains = [chain] if second is None else [chain, second]
        if engine:
            step, lines = engine_step(chains, engine, tree, damping, timestep, plain, units, pull)
            facts += lines
        for other in kind.said:
            facts += _limits(engine_step(chains, other, tree, damping, None, plain, units)[1], facts)
        gravity = _gravity(plain, tree.turned)
    model = Model(chain, tree, tuple(facts), name, paths, fragment, step, integrator, gravity, system)
    return _write(paths, force, *kind.write(model))


def _limits(lines: list[str], said: list[str]) -> list[str]:
    """Return what a file without a step of its own says of steps and loads, and has not said yet."""
    wanted = ("largest stable", "this file holds gravity only")
    return [line for line in lines if line.startswith(wanted) and line not in said]


def _structure(chain: StructureChain, kind: Format, name: str, given: dict[str, Any]) -> list[tuple[str]]:
    """Return the text of each file of a structure."""
    taken = {word: given.pop(word) for word in ("integrator", "timestep", "load", "damping")}
    _alone("structures", given)
    choice("format of a structure", kind.name, STRUCTURE_FORMATS)
    taken["integrator"] = choice("integrator", taken["integrator"] or "RK4", MUJOCO_INTEGRATORS)
    # Several threads of BLAS spend their time waiting for each other.
    with one_thread():
        return [(text,) for text in structure_texts(chain, kind.name, name, **taken)]


def _alone(what: str, given: dict[str, object]) -> None:
    """Raise ValueError if an option is given that files of these chains do not take."""
    for option, value in given.items():
        if value is not None:
            raise ValueError(f"{option} must be left out of files of {what}, got {shown(value)}")


def _checked_start(
    chain: Chain, at: Equilibrium, load: Load | None, *, fragment: bool, second: Chain | None
) -> Load:
    """Return the load of the shape to start from."""
    if at.chain is not chain and at.chain != chain:
        raise ValueError(f"at must be of the same chain, {shown(chain)}, got one of {shown(at.chain)}")
    if load is not None and load != at.load:
        raise ValueError(f"load must be left out or be that of at, {at.load}, got {load}")
    for name, value in (("fragment", fragment), ("second", second)):
        if value:
            raise ValueError(f"{name} must be left out with at, got {shown(value)}")
    return at.load


def _gravity(load: Load | None, turned: bool) -> Vector:
    """Return gravity along a file's x, y and z; its x runs from the right end if the tree is `turned`."""
    along, across = map(float, load.weight if load is not None else (0.0, 0.0))
    return (-along if turned else along) + 0.0, 0.0, across


def _place_and_format(path: object, format: str | None) -> tuple[Path, Format]:
    if not isinstance(path, str | os.PathLike):
        raise TypeError(f"path must be a string or a Path, got {shown(path)}")
    place = Path(path)
    if format is not None:
        return place, FORMATS[choice("format", format, FORMATS)]
    suffixes = dict.fromkeys(kind.suffix for kind in FORMATS.values())
    suffix = choice("suffix of path, without format,", place.suffix.lower(), suffixes)
    kinds = [kind for kind in FORMATS.values() if kind.suffix == suffix]
    if len(kinds) > 1:
        names = ", ".join(kind.name for kind in kinds)
        raise ValueError(f"format must be given for {suffix} files, one of {names}, got {place.name}")
    return place, kinds[0]


def _tree(kind: Format, pieces: int, ends: object, build: Callable[[], Tree]) -> Tree:
    """Return the bodies and joints of a chain, as far as a format has them and can hold them."""
    most = kind.most_bodies
    if most is None:
        return Tree()
    # An outer piece without mass becomes no body.
    too_long = pieces - 2 > most
    tree = Tree() if too_long else build()
    if too_long or len(tree.bodies) > most:
        raise ValueError(
            f"chain must have at most {most} pieces for {kind.name} files, got {pieces}{kind.because}"
        )
    if tree.ties and not kind.ties:
        able = ", ".join(each.name for each in FORMATS.values() if each.ties)
        raise ValueError(
            f"chain must be supported at one end only for {kind.name} files, which are trees, got "
            f"{ends}; {able} files can support both"
        )
    return tree


def _write(places: tuple[Path, ...], force: bool, *texts: Iterable[str]) -> tuple[Path, ...]:
    written: list[Path] = []
    try:
        # The last first: a URDF file never stands there without its springs.
        for place, parts in reversed([*zip(places, texts, strict=True)]):
            write_atomically(place, partial(_fill, parts), new=not force)
            written.append(place)
    except BaseException:
        # Nor do springs stand there without it, unless they have taken the place of others.
        for place in written if not force else ():
            place.unlink(missing_ok=True)
        raise
    return places


def _fill(parts: Iterable[str], file: BinaryIO) -> None:
    for part in parts:
        file.write(part.encode())
