"""Shapes of a chain between two points nearer to each other than the chain is long: strings, arches, strips.

Two limits are found directly. Without load the chain is a buckled strip: at a chord just short of its length
it has the shape of a buckling mode, n half waves on pinned ends, and the chord is then shortened step by
step. Without springs it is a string under its weight: with a force F on the right tip, G_i the moment arms
times the weights of piece i and of all beyond it, and l_i its length, every piece lies along

    R_i = l_i F + G_i,      Σ l_i R_i/|R_i| = span,

which is where the convex function  Σ |R_i| - F·span  is least: so there is one such shape that is pulled, and
one, mirrored, that is pushed. Springs are then added by Newton's method, to a heavy chain all at once; to a
strip the load is added step by step.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from numbers import Real
from types import MappingProxyType

import numpy as np

from beammodes.chains.chain import Chain
from beammodes.checks import real, real_numbers, shown
from beammodes.equations.mechanics import Span, unpack
from beammodes.equations.newton_statics import ChainStatics, StaticState, followed
from beammodes.numerics.arrays import Floats
from beammodes.problem.loading import NO_LOAD, Load

__all__ = ["BRANCHES", "checked_span", "shape_between", "string_tension"]

#: Words for the first branch to either side of the chord.
BRANCHES = MappingProxyType({"arch": 1, "sag": -1})
#: Shortening of the chord at which a strip is taken to have the shape of its buckling mode.
_SHORTENED = 1e-3
#: What the chord is shorter by while it is turned, if it would else be too taut.
_SLACK = 0.2
#: Smallest step of the chord and of the load.
_FINE = 1e-5
#: What rounding leaves of the compliance of a chain that cannot buckle any further.
_NOTHING = 1e-12
#: From this weight on, over EI/L², a string is nearer than a strip.
_HEAVY = 100.0


def checked_span(chain: Chain, span: object) -> Span:
    """Return where the right end is held, or raise what is wrong with that."""
    given = span if isinstance(span, tuple | list | Real) else real_numbers("span", span).tolist()
    pair = given if isinstance(given, tuple | list) else (given, 0.0)
    if len(pair) != 2:
        raise ValueError(f"span must be a number or a pair (x, y), got {shown(span)}")
    x, y = (real(f"span[{k}]" if pair is given else "span", value) for k, value in enumerate(pair))
    # Pieces that ends hold lie along x.
    stubs = float(chain.length[np.array(chain.held_angles)].sum())
    longest = float(chain.length.sum()) - stubs
    if np.count_nonzero(~np.array(chain.held_angles)) < 2:
        raise ValueError(f"span must be left out of a chain that has no hinge to bend at, got {shown(span)}")
    distance = math.hypot(x - stubs, y)
    if not distance < longest * (1.0 - 1e-12):
        reach = f"shorter than the chain, {longest:.9g} m"
        if stubs:
            reach = (
                f"less than {longest:.6g} m from ({stubs:.6g}, 0): clamps hold so much of the chain along x"
            )
        far = f", {distance:.9g} m" if y and not stubs else ""
        raise ValueError(f"span must be {reach}, got {shown(span)}{far}")
    if not (chain.boundary.left.holds_deflection and chain.boundary.right.holds_deflection):
        raise ValueError(
            "boundary must hold both ends (clamped, pinned or on a rotational spring) with span, got "
            f"{chain.boundary.name}"
        )
    return x, y


def shape_between(
    chain: Chain, statics: ChainStatics, load: Load, branches: Sequence[int], tolerance: float
) -> StaticState | None:
    """Return the state on the first of some branches that is reached under the whole load, or None.

    Of several any stable state will do, where none is on the side of its branch: an almost taut strip that is
    clamped across its chord has one shape only.
    """
    several, spare = len(branches) > 1, None
    for branch in branches:
        for found in _ways(chain, statics, load, branch, tolerance):
            if found is None:
                continue
            # A string that falls through to the other side is another branch.
            on_side = abs(branch) > 1 or branch * _area(chain, found) > 0
            if on_side and (not several or found.is_stable):
                return found
            if several and (spare is None or (found.is_stable and not spare.is_stable)):
                spare = found
    return spare


def _ways(
    chain: Chain, statics: ChainStatics, load: Load, branch: int, tolerance: float
) -> Iterator[StaticState | None]:
    """Yield what each way to a branch leads to, the likeliest first."""
    weight = float(chain.length.sum() ** 2 * chain.mass.sum()) * math.hypot(*map(float, load.weight))
    # A chain's unit of stiffness is EI/ell.
    heavy = weight > _HEAVY * chain.units.stiffness * chain.units.length
    if heavy and abs(branch) == 1:
        yield _from_string(chain, statics, load, branch, tolerance)
    strip = _strip(chain, statics, branch, tolerance)
    if strip is not None:

        def loaded(state: StaticState, share: float) -> StaticState | None:
            return statics.solve((state.coordinates, state.multipliers), share=share, tolerance=tolerance)

        reached, last = followed(statics, strip, loaded, _FINE, stable=False)
        yield last if reached else None
    if load != NO_LOAD:
        yield _strip(chain, statics, branch, tolerance, loaded=True)
    # Clamped and turned a taut strip is stretched: it is turned while it is slack, and then pulled.
    yield _strip(chain, statics, branch, tolerance, loaded=True, slack=_SLACK)
    if weight and not heavy and abs(branch) == 1:
        yield _from_string(chain, statics, load, branch, tolerance)


def _strip(
    chain: Chain,
    statics: ChainStatics,
    branch: int,
    tolerance: float,
    *,
    loaded: bool = False,
    slack: float = 0.0,
) -> StaticState | None:
    """Return the state from a buckling mode, by a shorter and turned chord.

    Meanwhile it is loaded, and the chord is shorter by some `slack`, if so asked.
    """
    whole = float(sum(chain.scaled.length))
    load, shape = _buckling_mode(chain, statics, whole, branch)
    chord, slope = math.hypot(*statics.span), math.atan2(*statics.span[::-1])
    most = 1.0 - chord / whole
    least = min(_SHORTENED, most)

    def between(done: float) -> ChainStatics:
        # An amplitude grows with the root of what the chord is shortened by.
        reach = whole * (1.0 - least - (most - least) * done**2 - slack * math.sin(math.pi * done) ** 2)
        if done == 1.0:
            return statics
        return statics.spanning((reach * math.cos(slope * done), reach * math.sin(slope * done)))

    def moved(state: StaticState, done: float) -> StaticState | None:
        start, share = (state.coordinates, state.multipliers), done if loaded else 0.0
        return between(done).solve(start, share=share, tolerance=tolerance)

    pushed = np.zeros(statics.closed)
    pushed[0] = -load
    first = math.sqrt(2.0 * least * whole) * shape
    ready = between(0.0).solve((first, pushed), share=0.0, tolerance=tolerance)
    reached, last = followed(statics, ready, moved, _FINE, stable=False) if ready else (False, None)
    return last if reached else None


def _buckling_mode(chain: Chain, statics: ChainStatics, whole: float, branch: int) -> tuple[float, Floats]:
    """Return the n-th load that buckles the straight chain between its supports, and the shape φ.

    It shortens the chord by half its square's size; its first half wave is upwards for positive branches.
    """
    from scipy.linalg import eigh

    straight = statics.spanning((whole, 0.0))
    rest, pull = np.zeros(len(statics.scale)), np.zeros(statics.closed)
    pull[0] = 1.0
    still = straight.state(rest, 0.0 * pull, 0.0)
    taut = straight.state(rest, pull, 0.0)
    root = np.sqrt((taut.tangent - still.tangent).diagonal())
    # The closure along the chord has no gradient on the straight chain.
    border = still.rows[1:]
    size = len(rest)
    matrix = np.block([[still.tangent, border.T], [border, np.zeros((len(border), len(border)))]])
    right = np.vstack([np.diag(root), np.zeros((len(border), size))])
    soft = root[:, None] * np.linalg.solve(matrix, right)[:size]
    values, vectors = eigh((soft + soft.T) / 2, subset_by_index=[size - min(size, abs(branch)), size - 1])
    if abs(branch) > size or values[0] < _NOTHING * values[-1]:
        raise ValueError(f"branch must be the number of a buckling mode of {chain!r}, got {branch}")
    shape = (np.linalg.solve(matrix, np.append(root * vectors[:, 0], np.zeros(len(border)))))[:size]
    shape /= np.linalg.norm(root * shape)
    lift = _lifts(chain, shape)
    first = lift[np.abs(lift) > 0.3 * np.abs(lift).max()][0]
    return 1.0 / float(values[0]), shape * np.sign(first) * np.sign(branch)


def _lifts(chain: Chain, motion: Floats) -> Floats:
    """Return the deflection of every node of the straight chain in a small motion."""
    tip, turns = unpack(chain, motion.tolist())
    lengths = np.array(chain.scaled.length, dtype=np.float64)
    return np.cumsum([float(tip[1]), *(lengths * np.array(turns, dtype=np.float64))])


def _area(chain: Chain, state: StaticState) -> float:
    """Return the area between chain and chord, positive where the chain is above it."""
    tip, angle = unpack(chain, state.coordinates.tolist())
    turns, lengths = (np.array(each, dtype=np.float64) for each in (angle, chain.scaled.length))
    steps = lengths * np.stack([np.cos(turns), np.sin(turns)])
    x, y = np.cumsum(np.column_stack([np.array(tip, dtype=np.float64), steps]), axis=1)
    return float(np.roll(x, -1) @ y - np.roll(y, -1) @ x) / 2


def _from_string(
    chain: Chain, statics: ChainStatics, load: Load, branch: int, tolerance: float
) -> StaticState | None:
    """Return the state that Newton's method finds from a chain without springs."""
    (x, y), (along, across) = statics.span, map(float, load.weight)
    side = x * across - y * along
    if not side:
        return None
    unit = chain.units.length
    pull, angle, _ = _string(chain, load, (x * unit, y * unit), pulled=branch * side > 0)
    force = chain.units.stiffness / chain.units.length
    moving = ~np.array(chain.held_angles)
    start = angle[moving], pull / force
    return statics.solve(start, share=1.0, tolerance=tolerance, steps=50, longest=0.2)


def string_tension(chain: Chain, load: Load, span: Span) -> float:
    """Return the largest pull along a piece, at its centre, of a string that hangs between two points [N].

    Examples
    --------
    >>> from beammodes.problem.beam import Beam
    >>> string = Chain(Beam(1.0, 1.0, 1.0), "pinned-pinned", 2)
    >>> round(string_tension(string, Load(gravity=1.0), (0.5, 0.0)), 6)       # at 60 degrees: 0.25/sin 60°
    0.288675
    """
    return _string(chain, load, span)[2] if any(load.weight) else 0.0


def _string(chain: Chain, load: Load, span: Span, *, pulled: bool = True) -> tuple[Floats, Floats, float]:
    """Return the force on a string's right tip [N], its pieces' angles [rad], the largest pull in them [N].

    `pulled` says whether the string hangs or stands. By Newton's method,
    with steps no longer than they lower the convex function of the module's note.
    """
    length, held = chain.length, np.array(chain.held_angles)
    weight = chain.mass[:, None] * np.array(load.weight, dtype=np.float64)
    beyond = np.cumsum(weight[::-1], axis=0)[::-1] - weight
    own = length[:, None] * beyond + chain.centre[:, None] * weight
    sign = 1.0 if pulled else -1.0
    whole = float(length.sum())
    target = sign * (np.array(span) - [float(length[held].sum()), 0.0])
    length, own, total = length[~held], own[~held], weight.sum(axis=0)
    reach = math.hypot(*target)
    # A shallow string of weight W is pulled with  W/√(24 (1 - chord/length)).
    slack = max(1.0 - reach / float(length.sum()), 1e-12)
    force = math.hypot(*total) / math.sqrt(24 * slack) * target / (reach or 1.0) - total / 2

    def energy(force: Floats) -> float:
        return float(np.linalg.norm(length[:, None] * force + own, axis=1).sum() - force @ target)

    for _ in range(100):
        lever = length[:, None] * force + own
        size = np.linalg.norm(lever, axis=1)[:, None]
        unit = lever / np.where(size, size, 1.0)
        slope = length @ unit - target
        turned = length[:, None] * np.stack([-unit[:, 1], unit[:, 0]], axis=1)
        bend = (turned / np.where(size, size, np.inf)).T @ turned
        # A string that hangs straight down is bent by no force along it.
        step = -np.linalg.solve(bend + 1e-9 * (np.trace(bend) or 1.0) * np.eye(2), slope)
        share, before = 1.0, energy(force)
        while share > 1e-12 and energy(force + share * step) > before + 1e-4 * share * float(slope @ step):
            share /= 2
        force = force + share * step
        if np.abs(slope).max() < 1e-12 * whole:
            break
    angle = np.zeros(chain.pieces)
    unit = sign * unit
    angle[~held] = np.unwrap(np.arctan2(unit[:, 1], unit[:, 0]))
    arms = np.where(length, length, np.inf)
    return force, angle, float((size[:, 0] / arms).max(initial=0.0))
