"""What gravity, which an audit leaves out of its frequencies, does to a chain and to its beam."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from typing import Any

from beammodes.accuracy.statics import beam_statics, chain_statics
from beammodes.chains.chain import Chain
from beammodes.checks import percent
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary
from beammodes.problem.loading import Load
from beammodes.vibration.linear import linearize
from beammodes.vibration.modes import solve_modes

__all__ = ["weight_remarks"]

#: A smaller share of gravity along or across the chain is the rounding of poses.
_NONE = 1e-9
#: Statics of small deflections, in lengths of the beam, go so far.
_SMALL = 0.1


def weight_remarks(
    beam: Beam, boundary: Boundary, chain: Chain, gravity: tuple[float, float]
) -> Iterator[str]:
    """Yield what gravity along and across does, each to the chain and to the beam; nothing if there is none.

    Along it, by how much mode 1 changes; across it, how far the beam sags by small-deflection statics.
    """
    along, across = gravity
    size = max(abs(along), abs(across))
    if not size:
        return
    if boundary.rigid_body_modes:
        yield "gravity makes what nothing holds swing or fall, and bends it on the way"
        return
    if abs(along) > _NONE * size:
        yield _along(beam, boundary, chain, along)
    if across > _NONE * size:
        yield _across(beam, boundary, chain, across)


def _along(beam: Beam, boundary: Boundary, chain: Chain, along: float) -> str:
    load = Load(gravity=(along, 0.0))
    way = "tip" if along > 0 else "root"
    what = f"gravity of {abs(along):.4g} m/s² along it, towards its {way},"
    try:
        loaded = solve_modes(linearize(chain, load=load), 1).angular_frequency[0]
        beside = euler_bernoulli(beam, boundary, 1, load=load).angular_frequency[0]
    except ValueError:
        return f"{what} buckles the chain or the beam: they do not stay straight"
    own = loaded / solve_modes(linearize(chain), 1).angular_frequency[0] - 1
    due = beside / euler_bernoulli(beam, boundary, 1).angular_frequency[0] - 1
    return f"{what} changes mode 1 by {_percent(own)} in the chain and by {_percent(due)} in the beam"


def _percent(part: Any) -> str:
    return percent(float(part), rounding=1e-6)


def _across(beam: Beam, boundary: Boundary, chain: Chain, across: float) -> str:
    bodies = sum(float(end.moving_body[0]) for end in (boundary.left, boundary.right))
    spread = (float(chain.mass.sum()) - bodies) / float(chain.length.sum())
    tip = across * float(boundary.right.mass)
    sags = []
    for weight, statics in (
        (across * spread, partial(chain_statics, chain)),
        (across * beam.mean_mass_per_length, partial(beam_statics, beam, boundary)),
    ):
        own, end = statics("uniform_load"), statics("tip_force") if tip else None
        where = "middle" if math.isnan(own.deflection) else "tip"
        name = "midspan_deflection" if where == "middle" else "deflection"
        sags.append(abs(weight * getattr(own, name) + (tip * getattr(end, name) if end else 0.0)))
    named = zip(("the chain", "the beam"), sags, strict=True)
    beyond = " and ".join(name for name, sag in named if sag > beam.length)
    if beyond:
        return (
            f"gravity of {across:.4g} m/s² across it bends {beyond} far beyond small deflections: these "
            "frequencies are of the straight shape without weight; find_equilibrium tells how it hangs"
        )
    far = "; by small deflections, which these are not" if max(sags) > _SMALL * beam.length else ""
    return (
        f"gravity of {across:.4g} m/s² across it lets its {where} sag by {sags[0]:.4g} m in the chain and by "
        f"{sags[1]:.4g} m in the beam{far}"
    )
