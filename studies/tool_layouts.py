"""Simulators' default layouts of a cantilever, their errors, and the springs that correct them.

Chains of hinges are those of the package. Two tools do otherwise and are modelled here: MuJoCo 4 puts
point masses at the vertices of a discrete elastic rod, Adams joins rigid segments by massless beams.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, partial
from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

import beammodes as bm

__all__ = ["BOUNDARY", "Tool", "adams_link_errors", "flex_errors", "springs_at_the_wall", "tools"]

BOUNDARY = "clamped-free"
Errors = Callable[[Sequence[int]], NDArray[np.float64]]


@dataclass(frozen=True)
class Tool:
    """A simulator's way of building a cantilever.

    `stub` and `masses` are for drawing: the length held by the wall in segments, and "rods", "points" or
    "beams" (rigid rods joined by massless beams). `wall` says what is there. All pairs are "as it is" and
    "mended": `orders`, of errors ~ 1/N**order; `springs`, the rules with them; `ways`, words where it is
    not by springs.
    """

    name: str
    wall: str
    ways: tuple[str, str]
    stub: float
    masses: str
    as_is: Errors
    mended: Errors
    orders: tuple[int, int]
    springs: tuple[str, str] | None = None


def _of_rule(name: str) -> Errors:
    def errors(segments: Sequence[int]) -> NDArray[np.float64]:
        return np.asarray(bm.frequency_error(BOUNDARY, segments=segments, mode=1, rule=name))

    return errors


def flex_errors(segments: Sequence[int], *, shifted: bool = False) -> NDArray[np.float64]:
    """Return the errors of mode 1 of a MuJoCo 4 flex of N edges whose first edge is pinned.

    N + 1 vertices share the mass equally; bending is EI/ell at the vertices between edges. `shifted` is
    the same rod half a segment nearer to the wall, each vertex with the mass of one segment: then the
    vertices that move are the middles of segments.
    """
    exact = bm.euler_bernoulli(bm.Beam.unit(), BOUNDARY, 1).angular_frequency[0]
    rule = replace(bm.RULES["rigid_stub"], name="point masses", rotary_inertia=Fraction(1, 4))
    found = []
    for count in map(int, segments):
        vertex = 1 / count if shifted else 1 / (count + 1)
        # Rods of two point masses leave the tip's vertex half its mass.
        beam = bm.Beam(1.0, 1.0, mass_per_length=count * vertex)
        chain = bm.Chain(beam, ("clamped", bm.End(mass=vertex / 2)), count, rule)
        found.append(bm.solve_modes(bm.linearize(chain), modes=1).angular_frequency[0] / exact - 1)
    return np.round(found, 9)


def held_element_errors(
    segments: Sequence[int],
    *,
    points: bool,
    inside: float = 0.0,
    first: Sequence[float] = (),
    both: bool = False,
) -> NDArray[np.float64]:
    """Return the errors of mode 1 of N equal elements, the first of which is held: cables, Cosserat rods.

    They bend at the nodes between them. `points` is for mass in points at the nodes, as PyElastica has it, of
    slender rods; `inside` is the part of the first element that is inside the wall; `first` are factors of
    the springs nearest the wall. `both` ends may be held so.
    """
    boundary = "clamped-clamped" if both else BOUNDARY
    exact = bm.euler_bernoulli(bm.Beam.unit(), boundary, 1).angular_frequency[0]
    found = []
    for count in map(int, segments):
        ell = 1 / (count - inside * (1 + both))
        springs = np.full(count - 1, 1 / ell)
        springs[: len(first)] *= first
        if both:
            springs[count - 1 - len(first) :] *= first[::-1]
        held = [ell * (1 - inside)]
        chain = bm.Chain.from_pieces(
            length=[*held, *[ell] * (count - 2), *(held if both else [ell])],
            mass=[ell] * count,
            rotary_inertia=[ell**3 / (4 if points else 12)] * count,
            joint_stiffness=springs,
            boundary=boundary,
        )
        found.append(bm.solve_modes(bm.linearize(chain), modes=1).angular_frequency[0] / exact - 1)
    return np.round(found, 9)


def adams_link_errors(segments: Sequence[int], *, attachment: str, mode: int = 1) -> NDArray[np.float64]:
    """Return the errors of one mode of an Adams discrete flexible link, attached "rigid" or "flexible".

    N rigid rods; massless Euler-Bernoulli beams of length ell join their middles. "rigid" fixes the first
    rod to the wall; "flexible" joins its middle to the wall by a beam of ell/2. Shear is left out.
    """
    from skfem import Basis, BilinearForm, ElementLineHermite, MeshLine
    from skfem.helpers import dd, ddot

    exact = bm.euler_bernoulli(bm.Beam.unit(), BOUNDARY, mode).angular_frequency[-1]
    found = []
    for count in map(int, segments):
        middles = (np.arange(count) + 0.5) / count
        nodes = middles if attachment == "rigid" else np.append(0.0, middles)
        basis = Basis(MeshLine(nodes), ElementLineHermite())
        stiffness = BilinearForm(lambda u, v, _: ddot(dd(u), dd(v))).assemble(basis).toarray()
        mass = np.zeros(len(stiffness))
        mass[basis.nodal_dofs[0]], mass[basis.nodal_dofs[1]] = 1 / count, 1 / count**3 / 12
        free = basis.complement_dofs(basis.get_dofs(lambda x, start=nodes[0]: np.isclose(x[0], start)))
        inverse = scipy.linalg.eigh(np.diag(mass[free]), stiffness[np.ix_(free, free)], eigvals_only=True)
        found.append(1 / np.sqrt(inverse[-mode]) / exact - 1)
    return np.round(found, 9)


def springs_at_the_wall(rule: str, segments: int, count: int) -> list[Fraction]:
    """Return the springs of the hinges nearest the wall in EI/ell, exactly."""
    weights: list[Any] = bm.RULES[rule].hinge_weights(bm.Boundary.of(BOUNDARY), segments)
    return [1 / weight for weight in weights[:count]]


def _by_springs(name: str, wall: str, rules: tuple[str, str]) -> Tool:
    was, better = (bm.RULES[rule] for rule in rules)
    masses = "rods" if was.rotary_inertia == better.rotary_inertia else "points"
    orders = (bm.error_law(BOUNDARY, 1, was).order, bm.error_law(BOUNDARY, 1, better).order)
    errors = (_of_rule(was.name), _of_rule(better.name))
    return Tool(name, wall, ("", ""), float(was.stub), masses, *errors, orders=orders, springs=rules)


@cache
def tools() -> tuple[Tool, ...]:
    """Return the simulators' layouts, the worst first."""
    return (
        _by_springs("MuJoCo 3 cable", "first segment held rigid", ("rigid_stub", "rigid_stub_corrected")),
        Tool(
            "Adams flexible link",
            "rigid rods, massless beams between",
            ('attachment "rigid"', 'attachment "flexible"'),
            1.0,
            "beams",
            partial(adams_link_errors, attachment="rigid"),
            partial(adams_link_errors, attachment="flexible"),
            orders=(1, 2),
        ),
        _by_springs("URDF or SDF by hand", "hinge at the wall", ("naive", "gregory")),
        Tool(
            "MuJoCo 4 flex",
            "first edge held rigid, masses at points",
            ('pin id="0 1"', "moved half an edge into the wall, mass × (N + 1)/N"),
            1.0,
            "points",
            flex_errors,
            partial(flex_errors, shifted=True),
            orders=(1, 2),
        ),
        _by_springs("Hencky bar chain", "mended: rods instead of point masses", ("hencky", "gregory")),
        _by_springs("Simscape, Modelica", "half a segment held rigid", ("half_stub", "half_stub_corrected")),
        _by_springs("Working Model", "hinge at the wall", ("mitiguy", "gregory")),
    )
