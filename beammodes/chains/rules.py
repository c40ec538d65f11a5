"""The registry: every discretization rule by name, with its source and its users.

A new rule is one record here: a name and its weights. The order of its error follows from them, and every
figure, table, page and command that shows every rule shows it.

What a rule is, and why its springs are quadrature weights, stands in `beammodes.chains.rule_records`.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from beammodes.chains.rule_records import Layout, Rule, RuleMaker, Weight
from beammodes.checks import choice, shown

__all__ = ["RULES", "AnyRule", "Layout", "Rule", "RuleLike", "RuleMaker", "Weight", "layout_of", "rule_named"]

RuleLike = str | Rule
AnyRule = str | Layout


def layout_of(rule: AnyRule) -> Layout:
    """Return `rule` if it can lay out a chain, else the rule of that name.

    Raises
    ------
    TypeError, ValueError
        If it is neither; the message lists the names and offers the nearest, or says what a record lacks.

    Examples
    --------
    >>> layout_of("naive").name
    'naive'
    """
    if isinstance(rule, str):
        return rule_named(rule)
    if isinstance(rule, Layout) and not isinstance(rule, type):
        return rule
    needed = ("name", "rotary_inertia", "piece_lengths", "hinge_weights")
    missing = [word for word in needed if isinstance(rule, type) or not hasattr(rule, word)]
    raise TypeError(
        f"rule must be one of {', '.join(RULES)}, or a record that is a Layout, got {shown(rule)}"
        + (f", without {', '.join(missing)}" if len(missing) < len(needed) else "")
    )


def rule_named(rule: RuleLike) -> Rule:
    """Return the rule of that name from `RULES`; a `Rule` is returned as it is.

    Raises
    ------
    TypeError, ValueError
        If it is neither; the message lists the names and offers the nearest.

    Examples
    --------
    >>> rule_named("double_wall").clamped
    (Weight(constant=Fraction(1, 2), per_segment=Fraction(0, 1)),)
    """
    if isinstance(rule, Layout) and not isinstance(rule, type | Rule):
        raise TypeError(
            f"rule must be a Rule or a name here, whose end weights have a closed form, got {shown(rule)}: "
            "frequency_error and Chain take any Layout"
        )
    return rule if isinstance(rule, Rule) else RULES[choice("rule", rule, RULES)]


_RECORDS = (
    Rule(
        name="mitiguy",
        summary="Hinge at the wall with 6N/(3N-1) EI/ell, EI/ell inside: every hinge of a "
        "tip-loaded cantilever deflects exactly as the beam.",
        used_by="the Working Model report",
        source="P. Mitiguy, Flexible beams in Working Model (Knowledge Revolution), "
        "'Assigning Spring Constants', its two labels exchanged",
        clamped=(Weight("1/2", "-1/6"),),
    ),
    Rule(
        name="double_wall",
        summary="Hinge at the wall with 2 EI/ell, EI/ell inside: exact under an end moment.",
        used_by="chains with the central-difference clamp",
        source="trapezoidal weights of the flexibility integral",
        clamped=("1/2",),
    ),
    Rule(
        name="naive",
        summary="Hinge at the wall with EI/ell, as everywhere: the wall is twice too soft.",
        used_by="a common first try",
        source="equal springs at all hinges",
        clamped=("1",),
        guided=("1",),
    ),
    Rule(
        name="gregory",
        summary="Hinge at the wall with 8/3 EI/ell, then 6/7 and 24/23 EI/ell, EI/ell inside: "
        "third-order end weights, the clamp's error gone up to 1/N⁴.",
        used_by="nobody yet",
        source="Gregory's third-order end correction of the trapezoidal rule, as flexibilities",
        clamped=(
            "3/8",
            "7/6",
            "23/24",
        ),
    ),
    Rule(
        name="gregory2",
        summary="Hinge at the wall with 12/5 EI/ell, then 12/13 EI/ell, EI/ell inside: two changed "
        "springs, order 3.",
        used_by="nobody yet",
        source="Gregory's second-order end correction of the trapezoidal rule, as flexibilities",
        clamped=(
            "5/12",
            "13/12",
        ),
    ),
    Rule(
        name="hencky",
        summary="Massless bars with point masses at the hinges (half at the ends), 2 EI/ell at the wall, "
        "EI/ell inside.",
        used_by="Hencky bar-chain papers",
        source="H. Hencky, Über die angenäherte Lösung von Stabilitätsproblemen im Raum mittels der "
        "elastischen Gelenkkette, Der Eisenbau 11 (1920), with masses",
        clamped=("1/2",),
        rotary_inertia="1/4",
    ),
    Rule(
        name="half_stub",
        summary="Every hinge at the middle of its segment with EI/ell, so that half a segment is rigid "
        "with the wall and half a segment ends the chain.",
        used_by="Simscape lumped flexible beams, rigid finite element method, Modelica",
        source="midpoint weights of the flexibility integral",
        clamped=(),
        guided=(),
        stub="1/2",
    ),
    Rule(
        name="half_stub_corrected",
        summary="The half_stub layout with its first three springs 12/13, 8/7, 24/25 EI/ell: the clamp's "
        "error gone up to 1/N⁴.",
        used_by="nobody yet: a fix for half_stub that moves nothing",
        source="third-order end correction of the midpoint rule",
        clamped=(
            "13/12",
            "7/8",
            "25/24",
        ),
        guided=(),
        stub="1/2",
    ),
    Rule(
        name="rigid_stub",
        summary="The whole first segment rigid with the wall, no spring there, EI/ell at the other hinges.",
        used_by='MuJoCo 3 cables (initial="none"); Adams links attached "rigid" come near it',
        source="N segments, N - 1 hinges",
        clamped=(),
        guided=(),
        stub=1,
    ),
    Rule(
        name="rigid_stub_corrected",
        summary="The rigid_stub layout with its first two springs 12/23 and 12/7 EI/ell, order 3 (5/3 "
        "and 5/6 as flexibilities at a guided end, order 4).",
        used_by="nobody yet: a fix for rigid_stub that moves nothing",
        source="second-order open end correction of the trapezoidal rule",
        clamped=(
            "23/12",
            "7/12",
        ),
        guided=(
            "5/3",
            "5/6",
        ),
        stub=1,
    ),
)

#: Every rule by name, read-only.
RULES: Mapping[str, Rule] = MappingProxyType({rule.name: rule for rule in _RECORDS})
