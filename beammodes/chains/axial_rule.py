"""Springs corrected for an axial force: the order that it takes from a rule, given back.

Inside a chain under tension T, with t = T ell²/EI,

    ω² (2 + cos q)/3 = 4 k (1 - cos q)² + 2 t (1 - cos q)        (per segment, springs k EI/ell)

The bending term's and the mass's errors cancel to fourth order, the axial term's does not: its lowest is
t q⁴/12 in ω², as a spring t/12 too stiff would make. So  k = 1 - t/12  takes it away: a hinge spring of
EI/ell - T ell/12, or EI/ell + P ell/12 under compression P, and every weight is divided by 1 - t/12. Ends
that bend the beam keep an error of T/N³.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from beammodes.chains.rules import AnyRule, Layout, Rule, layout_of
from beammodes.checks import real, shown
from beammodes.problem.beam import Beam
from beammodes.problem.ends import Boundary
from beammodes.problem.loading import Load, load_of

__all__ = ["AxiallyCorrected", "axially_corrected"]


@dataclass(frozen=True)
class AxiallyCorrected:
    """A rule with its springs corrected for one axial force; `axially_corrected` makes it.

    Attributes
    ----------
    rule : Layout
        What is corrected.
    axial_force : Fraction
        T L²/EI, tension positive.
    """

    rule: Layout
    axial_force: Fraction

    @property
    def name(self) -> str:
        """Of the rule, with the force."""
        return f"{self.rule.name} corrected for T = {float(self.axial_force):.6g} EI/L²"

    @property
    def rotary_inertia(self) -> Fraction:
        """Central rotary inertia of a piece over its mass times length²."""
        return self.rule.rotary_inertia

    def piece_lengths(self, boundary: Boundary, segments: int) -> list[Fraction]:
        """Return the pieces' lengths in segments, left to right."""
        return self.rule.piece_lengths(boundary, segments)

    def spring_factor(self, segments: int) -> Fraction:
        """Return  1 - T ell²/(12 EI),  by which every spring of the rule is multiplied."""
        return 1 - self.axial_force / Fraction(segments) ** 2 / 12

    def hinge_weights(self, boundary: Boundary, segments: int) -> Sequence[Fraction | float]:
        """Return the flexibility weights of the chain's hinges; none positive where T ell² ≥ 12 EI."""
        spring = self.spring_factor(segments)
        if not spring:
            return [Fraction(0)] * len(self.rule.hinge_weights(boundary, segments))
        return [weight / spring for weight in self.rule.hinge_weights(boundary, segments)]

    def declared_order(self, boundary: Boundary) -> int:
        """Return p in e ~ 1/N**p of the frequencies under this axial force."""
        if not isinstance(self.rule, Rule):
            raise TypeError(f"rule must be a Rule to have a declared order, got {shown(self.rule)}")
        ends = {boundary.left.statics, boundary.right.statics}
        return min(self.rule.declared_order(boundary), 3 if "clamped" in ends else 4)


def axially_corrected(rule: AnyRule, load: Load, beam: Beam | None = None) -> AxiallyCorrected:
    """Return a rule with springs that keep its order under an axial force.

        k_j = (EI/ell - T ell/12) / w_j

    Every rule loses its order to an axial force T: at best 2 is left. These springs bring back 4 between
    pinned, guided and free ends, and with `gregory` 3 at clamped ones, where 20 segments of a cantilever at
    half its buckling load are 80 times closer. They suit that one force only.

    Parameters
    ----------
    rule : str, Rule or any Layout
    load : Load
        Its axial force [N].
    beam : Beam
        Uniform, in whose units the force is; `Beam.unit()` if it is a multiple of EI/L².

    Returns
    -------
    AxiallyCorrected
        To pass as `rule`. A chain too short for the force (T ell² ≥ 12 EI) has no positive springs.

    Raises
    ------
    TypeError, ValueError
        If an argument is not of its kind, the beam is not uniform, or a load comes without one.

    Source
    ------
    The dispersion relation of a chain under tension; derived here (module's note).

    Examples
    --------
    >>> rule = axially_corrected("gregory", Load(axial_force=-0.5 * 9.8696), Beam.unit())
    >>> [rule.hinge_weights(Boundary.of("pinned-pinned"), 2)[0] < 1]
    [True]
    """
    record, force = layout_of(rule), load_of(load, beam).axial_force
    structure = Beam.unit() if beam is None else beam
    if not isinstance(structure, Beam):
        raise TypeError(f"beam must be a Beam, got {shown(beam)}")
    if not structure.is_uniform:
        raise ValueError(f"beam must be uniform for springs corrected for an axial force, got {shown(beam)}")
    stiffness = Fraction(real("bending_stiffness", structure.mean_bending_stiffness))
    return AxiallyCorrected(record, Fraction(force) * Fraction(structure.length) ** 2 / stiffness)
