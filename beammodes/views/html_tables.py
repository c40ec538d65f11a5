"""Objects as HTML for notebooks: what it is, a small drawing, tables; no scripts, nothing from elsewhere.

Colours of text and lines are the page's own, so that it reads in light and in dark; drawings stand on white.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from fractions import Fraction
from html import escape
from inspect import cleandoc
from types import MappingProxyType
from typing import Any

import numpy as np

from beammodes.checks import told_fields
from beammodes.views.html_pieces import (
    counted,
    curve_of,
    lines_of,
    number_of,
    numbered_table,
    pairs_table,
    percent_of,
    table_of,
    text_of,
    title_of,
)

__all__ = ["html_of", "units_of"]

#: Of longer lists to choose from the first and the last rows are shown.
_MOST_LISTED = 50
#: Points of a mode's shape.
_POINTS = 49
#: Points of a rod's centre line.
_LINE_POINTS = 161
#: Sizes of drawings [in].
_BEAM, _FRAME, _SPACE, _BEAM_DIAGRAM = (5.0, 1.3), (3.4, 2.6), (4.6, 3.6), (5.0, 2.4)


def html_of(value: Any) -> str:
    """Return what a notebook shows of an object of this package.

    Examples
    --------
    >>> import beammodes as bm
    >>> text = html_of(bm.Rule("<mine>", ["1/2"]))
    >>> "&lt;mine&gt;" in text, "<mine>" in text
    (True, False)
    """
    build = next(
        (_BUILDERS[kind.__name__] for kind in type(value).__mro__ if kind.__name__ in _BUILDERS), _record
    )
    parts = "".join(build(value))
    return f'<div class="beammodes" style="line-height: 1.35; overflow-x: auto">{parts}</div>'


def _drawing(chain: Any, shape: Any = None) -> str:
    """Return the drawing of a chain, none of one too long to be seen."""
    from beammodes.views.inline_svg import inline_svg
    from beammodes.views.schematic import draw_chain

    try:
        ax = draw_chain(chain, shape=shape, labels=None, size=8.0)
    except ValueError:
        return ""
    size = {"SpatialChain": _SPACE, "StructureChain": _FRAME}.get(type(chain).__name__, _BEAM)
    pieces = len(np.atleast_1d(chain.joint_stiffness))
    return f'<div style="margin: 0.3em 0">{inline_svg(ax, width=size[0], height=size[1], parts=pieces)}</div>'


def units_of(kind: type) -> Mapping[str, str]:
    """Return the units of a class's fields, as its docstring gives them.

    Examples
    --------
    >>> import beammodes as bm
    >>> units_of(bm.PointLoad)["force"], units_of(bm.Damping)["joint"], units_of(bm.AxialEnd)["stiffness"]
    ('N', 'N m s/rad', 'N m/rad or N/m')
    """
    found: dict[str, str] = {}
    for each in reversed(kind.__mro__):
        for names, said in re.findall(r"(?m)^(\w+(?:, \w+)*) : (.*)$", cleandoc(each.__doc__ or "")):
            listed, units = names.split(", "), re.findall(r"\[([^\]]+)\]", said)
            split = units if len(units) == len(listed) > 1 else [" or ".join(units)] * len(listed)
            found |= {name: "" if unit == "-" else unit for name, unit in zip(listed, split, strict=True)}
    return MappingProxyType(found)


def _record(value: Any) -> list[str]:
    """A record's fields that are not at their defaults, with units."""
    if not is_dataclass(value):
        return [title_of(repr(value))]
    units, told = units_of(type(value)), told_fields(value)
    name = getattr(value, "_called", None) or type(value).__name__
    rows = [(field.replace("_", " "), each, _unit(each, units.get(field, ""))) for field, each in told]
    return [title_of(name, "" if rows else "with nothing but defaults"), pairs_table(rows)]


def _unit(value: Any, unit: str) -> str:
    """Return the unit of numbers; functions and records have their own."""
    first = value[0] if isinstance(value, tuple) and value else value
    return unit if isinstance(first, int | float | Fraction | np.ndarray | np.number) else ""


def _beam(value: Any) -> list[str]:
    # Its line leaves out what is not given.
    units = units_of(type(value))
    given = [(each.name, getattr(value, each.name)) for each in fields(value) if each.repr]
    usual: dict[str, Any] = {"second_bending_stiffness": getattr(value, "bending_stiffness", None)}
    rows = [
        (name.replace("_", " "), each, _unit(each, units.get(name, "")))
        for name, each in given
        if each is not None and each != 0.0 and each != (0.0, 0.0, 0.0) and each != usual.get(name)
    ]
    assumed = getattr(value, "assumed", ())
    line = _centre_line(value) if hasattr(value, "frames") else ""
    return [
        title_of(type(value).__name__),
        line,
        pairs_table(rows),
        lines_of(f"assumed: {each}" for each in assumed),
    ]


def _centre_line(rod: Any) -> str:
    """Return the rod's centre line as it is seen in a drawing of its chain; nothing of a straight one."""
    from beammodes.views.schematic_in_space import SEEN

    points = rod.frames(np.linspace(0.0, rod.length, _LINE_POINTS))[1] @ SEEN.T
    bent = np.abs(points - np.linspace(points[0], points[-1], len(points))).max()
    if bent < 1e-6 * rod.length:
        return ""
    low, size = points.min(axis=0), np.ptp(points, axis=0).max()
    at = (points - low) * (200 / size) + 8
    wide, high = at.max(axis=0) + 8
    listed = " ".join(f"{x:.1f},{high - y:.1f}" for x, y in at.tolist())
    x, y = at[0].tolist()
    return (
        f'<svg width="{wide:.0f}" height="{high:.0f}" viewBox="0 0 {wide:.0f} {high:.0f}">'
        f'<polyline points="{listed}" fill="none" stroke="currentColor" stroke-width="2"/>'
        f'<circle cx="{x:.1f}" cy="{high - y:.1f}" r="4" fill="currentColor"/></svg>'
    )


def _ends(value: Any) -> list[str]:
    units, motion = units_of(type(value.left)), getattr(value, "motion", "")
    names = [each.name for each in fields(value.left)]
    pairs = {name: (getattr(value.left, name), getattr(value.right, name)) for name in names}
    zero = [(0.0, 0.0), (False, False), ((0.0, 0.0, 0.0),) * 2, (((0.0,) * 3,) * 3,) * 2]
    rows = [
        (name.replace("_", " "), *pair, units.get(name, ""))
        for name, pair in pairs.items()
        if pair not in zero
    ]
    title = title_of(type(value).__name__, str(value), f"in {motion}" if motion else "")
    return [title, table_of(("", "left", "right", "unit"), rows, words=(0, 3))]


def _many_ends(value: Any) -> list[str]:
    from beammodes.problem.ends import End

    columns, units = value.columns, units_of(End)
    rows = []
    for name in (each.name for each in fields(columns)):
        numbers = np.asarray(getattr(columns, name))
        if numbers.any():
            unit = units.get(name, "")
            rows.append((name.replace("_", " "), *map(float, (numbers.min(), numbers.max())), unit))
    return [
        title_of("Ends", f"shape {value.shape}"),
        table_of(("", "from", "to", "unit"), rows, words=(0, 3)),
    ]


def _modes(value: Any) -> list[str]:
    frequency, omega = np.asarray(value.frequency), np.asarray(value.angular_frequency)
    head, columns = ["mode", "f [Hz]", "ω [rad/s]"], [range(1, len(omega) + 1), frequency, omega]
    theory = np.asarray(getattr(value, "theory_error", np.nan))
    if np.isfinite(theory).any():
        head.append("theory error [%]")
        columns.append([percent_of(each) for each in theory.tolist()])
    stored = getattr(value, "stored", None)
    if stored is not None:
        head += ["twist [%]", "about y [%]", "about z [%]"]
        columns += [[f"{100 * part:.1f}" for part in column] for column in stored.T.tolist()]
    shapes = _shapes(value)
    if shapes is not None:
        head.append("shape")
        columns.append([curve_of(shape) for shape in shapes])
    of = [getattr(value, name) for name in ("boundary", "ends", "structure", "chain") if hasattr(value, name)]
    rigid = int(getattr(value, "rigid_body_modes", 0))
    title = title_of(
        type(value).__name__,
        *(f"{each}{f' in {each.motion}' if hasattr(each, 'motion') else ''}" for each in of[:1]),
        f"{counted(rigid, 'rigid-body mode')} before them" if rigid else "",
    )
    said = [getattr(value, "theory_words", "")]
    if "theory error [%]" in head:
        said = [f"theory error: Timoshenko's beam, assumed {each}" for each in value.theory_assumed]
    drawn = _drawing(value.chain, value) if hasattr(value, "chain") else ""
    return [title, table_of(head, zip(*columns, strict=True), words=()), drawn, lines_of(filter(None, said))]


def _shapes(value: Any) -> Any:
    """Return deflections along the beam, evenly spaced, of modes of a single beam; else None."""
    if hasattr(value, "beam") and hasattr(value, "shape"):
        return value.shape(np.linspace(0.0, value.beam.length, _POINTS))
    position, deflection = getattr(value, "position", None), getattr(value, "deflection", None)
    if position is None or deflection is None or np.ndim(position) != 1:
        return None
    even = np.linspace(position[0], position[-1], _POINTS)
    return [np.interp(even, position, row) for row in deflection]


def _chain(value: Any) -> list[str]:
    by = [counted(value.segments, "segment"), f"rule {value.rule.name}"] if value.rule else []
    many = [counted(value.pieces, "piece"), counted(value.elastic_modes, "elastic mode")]
    springs, own = value.joint_stiffness, 1.0 / float(value.units.stiffness)
    ratio = {"k / (EI/ℓ)": springs * own} if value.rule else {}
    columns = {"x [m]": value.hinge_position, "k [N m/rad]": springs, **ratio}
    return [
        title_of("Chain", value.boundary.name, *by, *many),
        _drawing(value),
        numbered_table(("hinge", *columns), *columns.values()) if len(springs) else "",
    ]


def _axial_chain(value: Any) -> list[str]:
    unit = "N m/rad" if value.boundary.motion == "twist" else "N/m"
    where = f"{value.boundary.name} in {value.boundary.motion}"
    return [
        title_of("AxialChain", where, counted(value.segments, "segment"), f"rule {value.rule.name}"),
        numbered_table(
            ("hinge", "x [m]", f"k [{unit}]"),
            np.cumsum(value.length)[: len(value.joint_stiffness)],
            value.joint_stiffness,
        )
        if len(value.joint_stiffness)
        else "",
    ]


def _spatial_chain(value: Any) -> list[str]:
    head = ("hinge", "s [m]", "k twist [N m/rad]", "k about y", "k about z")
    return [
        title_of(
            "SpatialChain", str(value.ends), counted(value.segments, "segment"), f"rule {value.rule.name}"
        ),
        _drawing(value),
        numbered_table(head, value.hinge_position, *value.joint_stiffness.T)
        if len(value.hinge_position)
        else "",
    ]


def _structure_chain(value: Any) -> list[str]:
    counts = " + ".join(map(str, value.segments))
    return [
        title_of(
            "StructureChain", f"{counts} segments", f"rule {value.rule.name}", f"of {value.structure!r}"
        ),
        _drawing(value),
        table_of(("hinge", "k [N m/rad]"), [(hinge.name, hinge.stiffness) for hinge in value.hinges]),
    ]


def _structure(value: Any) -> list[str]:
    from beammodes.problem.structure import Station

    joints = [(name, at.x, at.y, _held(at.support), at.mass) for name, at in value.joints.items()]
    beams = [(member.name, member.beam) for member in value.members]
    members = [(name, b.length, b.mean_bending_stiffness, b.mean_mass_per_length) for name, b in beams]
    units = units_of(Station)
    stations = [
        (member.name, station.x, ", ".join(_told(name, each, units[name]) for name, each in rest))
        for member in value.members
        for station in member.stations
        for rest in [told_fields(station)[1:]]
    ]
    return [
        title_of("Structure", counted(len(joints), "joint"), counted(len(members), "member")),
        _plan(value),
        table_of(("joint", "x [m]", "y [m]", "support", "mass [kg]"), joints, words=(0, 3)),
        table_of(("member", "length [m]", "EI [N m²]", "ρA [kg/m]"), members),
        table_of(("station on", "x [m]", ""), stations, words=(0, 2)) if stations else "",
    ]


def _told(name: str, value: Any, unit: str) -> str:
    return f"{name.replace('_', ' ')} {text_of(value)} {unit}"


def _held(support: Any) -> str:
    """Return a support in words: what is held along x, along y and in rotation."""
    if not isinstance(support, tuple):
        return str(support)
    names = zip(("x", "y", "rotation"), support, strict=False)
    return ", ".join(name if math.isinf(k) else f"{name} by {k:.4g}" for name, k in names if k) or "free"


def _plan(structure: Any) -> str:
    """Return a structure from above: members are lines, joints dots, held ones squares, stations circles."""
    places = {name: (float(joint.x), -float(joint.y)) for name, joint in structure.joints.items()}
    x, y = np.array(list(places.values())).T
    size = float(max(np.ptp(x), np.ptp(y)))
    scale, edge = 200 / size, 34
    wide, high = np.ptp(x) * scale + 2 * edge, np.ptp(y) * scale + 2 * edge
    at = {
        name: ((a - x.min()) * scale + edge, (b - y.min()) * scale + edge) for name, (a, b) in places.items()
    }
    drawn = [
        f'<path d="M{at[m.start][0]:.1f} {at[m.start][1]:.1f}L{at[m.end][0]:.1f} {at[m.end][1]:.1f}" '
        'stroke="currentColor" stroke-width="3" stroke-linecap="round"/>'
        for m in structure.members
    ]
    for member in structure.members:
        (x0, y0), (x1, y1) = at[member.start], at[member.end]
        for station in member.stations:
            part = station.x / member.beam.length
            x, y = x0 + part * (x1 - x0), y0 + part * (y1 - y0)
            drawn.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="none" stroke="currentColor"/>')
    for name, joint in structure.joints.items():
        a, b = at[name]
        radius = 6 if _held(joint.support) != "free" else 3.5
        drawn.append(
            f'<rect x="{a - radius:.1f}" y="{b - radius:.1f}" width="{2 * radius}" height="{2 * radius}" '
            f'rx="{0 if radius > 4 else radius}" fill="currentColor"/>'
            f'<text x="{a + 8:.1f}" y="{b - 8:.1f}" font-size="12" fill="currentColor">{escape(name)}</text>'
        )
    return (
        f'<svg width="{wide:.0f}" height="{high:.0f}" viewBox="0 0 {wide:.0f} {high:.0f}" '
        f'style="max-width: 100%; overflow: visible">{"".join(drawn)}</svg>'
    )


def _statics(value: Any) -> list[str]:
    units = {"deflection": "m", "rotation": "rad", "midspan_deflection": "m"}
    of = {"tip_force": "1 N at the tip", "tip_moment": "1 N m at the tip", "uniform_load": "1 N/m all along"}
    rows = [(name.replace("_", " "), getattr(value, name), unit) for name, unit in units.items()]
    return [title_of("Statics", f"under {of.get(value.load, value.load)}"), pairs_table(rows)]


def _structure_statics(value: Any) -> list[str]:
    from beammodes.views.diagrams import draw_statics
    from beammodes.views.inline_svg import inline_svg

    rows = _without_rounding([(name, *force) for name, force in value.reactions.items()])
    width, height = _BEAM_DIAGRAM if len(value.structure.members) == 1 else _FRAME
    svg = inline_svg(draw_statics(value, size=8.0), width=width, height=height)
    moved = _without_rounding([(name, *where) for name, where in value.displacements.items()])
    return [
        title_of("StructureStatics", repr(value.structure)),
        f'<div style="margin: 0.3em 0">{svg}</div>',
        table_of(("reaction at", "F_x [N]", "F_y [N]", "M [N m]"), rows),
        table_of(("displacement of", "x [m]", "y [m]", "rotation [rad]"), moved),
    ]


def _without_rounding(rows: list[tuple[Any, ...]]) -> list[tuple[Any, ...]]:
    """Return rows of a name and numbers, with zeros where a number is rounding beside the largest."""
    largest = max((abs(each) for _, *numbers in rows for each in numbers if math.isfinite(each)), default=0.0)
    return [(name, *(0.0 if abs(n) < 1e-12 * largest else n for n in numbers)) for name, *numbers in rows]


def _equilibrium(value: Any) -> list[str]:
    x, y = value.nodes[-1].tolist()
    rows: list[tuple[str, Any, str]] = [
        ("stable", value.is_stable, ""),
        ("right tip at x, y", (x, y), "m"),
        ("stored energy", value.stored_energy, "J"),
        ("largest tension", float(value.tension.max()), "N"),
        ("load", value.load, ""),
    ]
    return [title_of("Equilibrium", str(value.chain)), _drawing(value.chain, value), pairs_table(rows)]


def _spatial_equilibrium(value: Any) -> list[str]:
    rows: list[tuple[str, Any, str]] = [
        ("stable", value.is_stable, ""),
        ("tip", value.tip, "m"),
        ("softest stiffness", float(value.stiffnesses[0]), "EI/L"),
        ("load", value.load, ""),
        ("joints", value.law.name, ""),
    ]
    return [title_of("SpatialEquilibrium", str(value.chain)), _drawing(value.chain, value), pairs_table(rows)]


def _verdict(audit: Any) -> str:
    """Return whether the errors are small enough, on green or on red."""
    from beammodes.auditing.told_audit import meets_or_not

    return (
        f'<span style="background: {"#1a7f37" if audit.meets else "#b3261e"}; color: #ffffff; '
        f'padding: 0.1em 0.5em; border-radius: 0.3em">{meets_or_not(audit)}</span>'
    )


def _audit(value: Any) -> list[str]:
    errors = list(map(percent_of, value.errors.tolist()))
    columns = {"mode": range(1, len(errors) + 1), "f [Hz]": value.angular_frequency / (2.0 * math.pi)}
    columns |= {"error [%]": errors}
    ratios = np.asarray(getattr(value, "damping_ratio", 0.0))
    if ratios.any():
        columns["damping ratio"] = ratios
    if hasattr(value, "mode_motion"):
        columns["motion"] = value.mode_motion
    motions = getattr(value, "motions", {"": value})
    better = [(motion, *_suggested(each)) for motion, one in motions.items() for each in one.suggestions]
    head = ("motion", "better springs", "hinges", "k", "errors [%]")
    first = 0 if any(motion for motion, *_ in better) else 1
    springs = table_of(head[first:], [row[first:] for row in better], words=range(3)) if better else ""
    said = [("given", line) for line in value.given] + [("assumed", line) for line in value.assumed]
    given = table_of(("", ""), said, words=(0, 1), most=_MOST_LISTED) if said else ""
    chain = f"{value.boundary} chain" if hasattr(value, "boundary") else "chain in space"
    chain += f" in {value.motion}" if hasattr(value, "motion") else ""
    return [
        f"<div><b>{escape(type(value).__name__)}</b> of a {escape(chain)}: {_verdict(value)}</div>",
        table_of(tuple(columns), zip(*columns.values(), strict=True), words=()),
        lines_of(value.found[1:]),
        springs,
        f"<details><summary>what was given and what is assumed</summary>{given}</details>" if said else "",
    ]


def _suggested(way: Any) -> tuple[Any, ...]:
    errors = ", ".join(map(percent_of, way.errors.tolist()))
    return (way.name, "moved" if way.moves_hinges else "as they are", way.joint_stiffness, errors)


def _mended(value: Any) -> list[str]:
    rows = zip(value.hinge_names, value.old_number, value.new_number, strict=True)
    return [
        f"<div><b>MendedFile</b> {escape(value.path.name)}: {_verdict(value.audit)}</div>",
        lines_of([value.promise, *filter(None, [value.not_mended]), *value.notes]),
        table_of(("hinge", "was", "is"), rows),
    ]


def _recommendations(value: Sequence[Any]) -> list[str]:
    rows: list[dict[str, Any]] = [
        {
            "rule": way.rule,
            "segments": " + ".join(map(str, way.stretches)) or way.segments,
            "frequency error [%]": f"{100 * way.largest_error:.3g}",
            "in mode": way.mode,
            "static error [%]": percent_of(max(way.static_error.values(), key=abs, default=math.nan)),
            "theory error [%]": percent_of(way.theory_error),
            "stable step [s]": f"{way.stable_time_step:.4g}",
            "cost": f"{float(f'{way.cost:.3g}'):,.0f}",
        }
        for way in value
    ]
    # What is known of none has no column.
    head = [name for name in rows[0] if any(row[name] != "–" for row in rows)] if rows else []
    title = (
        title_of("Recommendation") if len(rows) == 1 else title_of("Recommendations", "the cheapest first")
    )
    remarks = dict.fromkeys(remark for way in value for remark in way.remarks)
    return [
        title,
        table_of(head, [[row[name] for name in head] for row in rows], most=_MOST_LISTED),
        lines_of(remarks),
    ]


def _recommendation(value: Any) -> list[str]:
    springs = (
        ("joint stiffness", value.joint_stiffness, "N m/rad") if value.joint_stiffness.ndim == 1 else None
    )
    return [*_recommendations([value]), pairs_table([springs] if springs else [])]


def _study(value: Any) -> list[str]:
    rows = []
    for axis in value.axes:
        listed = axis.distribution or tuple(getattr(one, "name", one) for one in axis.values)
        rows.append((axis.name, axis.size, listed, axis.dimension or "shared by all"))
    computed = ", ".join(quantity.name for quantity in value.quantities)
    return [
        title_of("Study", f"of {computed}: {value.size} points, {value.chunk} in a chunk"),
        table_of(("axis", "values", "", "dimension"), rows, words=(0, 2, 3)),
    ]


def _case(value: Any) -> list[str]:
    return [
        title_of("Case"),
        pairs_table((name, getattr(each, "name", each), "") for name, each in value.values.items()),
    ]


def _law(value: Any) -> list[str]:
    if math.isnan(value.coefficient):
        return [title_of("ErrorLaw"), lines_of(["the leading terms cancel for this mode: no law holds"])]
    rows = [(n, percent_of(float(value.at(n)))) for n in (5, 10, 20, 50, 100)]
    law = f"e ~ {number_of(value.coefficient)} / N^{value.order}"
    return [title_of("ErrorLaw", law), table_of(("N", "e [%] by the law"), rows, words=())]


def _per_segment(number: Fraction) -> str:
    return f" {'-+'[number > 0]} {abs(number)}/N".replace("-", "−") if number else ""


def _rule(value: Any) -> list[str]:
    def springs(weights: Iterable[Any]) -> str:
        return ", ".join(f"{w.constant}{_per_segment(w.per_segment)}" for w in weights) or "none"

    stub = {0: "at the walls", 1: "the first one a segment from the wall"}
    rows: list[tuple[str, Any, str]] = [
        ("weights at a clamped end", springs(value.clamped), ""),
        ("weights at a guided end", springs(value.guided), ""),
        ("hinges", stub.get(value.stub, "at the segments' middles"), ""),
        ("rotary inertia", value.rotary_inertia, "m ℓ²"),
        ("order of the error", value.order, ""),
        ("used by", value.used_by or None, ""),
        ("source", value.source or None, ""),
    ]
    return [
        title_of("Rule", value.name),
        lines_of([value.summary] if value.summary else []),
        pairs_table(rows),
    ]


def _integrator(value: Any) -> list[str]:
    rows: list[tuple[str, Any, str]] = [
        ("order", value.order, ""),
        ("springs", value.springs, ""),
        ("dampers", value.damping, ""),
        ("variable step", value.variable_step, ""),
        ("in engines", ", ".join(value.engines) or None, ""),
        ("source", value.source, ""),
    ]
    return [title_of("Integrator", value.name), pairs_table(rows)]


def _model(value: Any) -> list[str]:
    rows: list[tuple[str, Any, str]] = [
        ("coordinates", value.coordinates, ""),
        ("elastic modes", value.elastic_modes, ""),
        ("rigid-body modes", value.rigid_body_modes, ""),
        ("load", value.load, ""),
    ]
    shape = getattr(value, "equilibrium", None)
    return [title_of(type(value).__name__, str(value.chain)), _drawing(value.chain, shape), pairs_table(rows)]


def _derived(value: Any) -> list[str]:
    omega = value.angular_frequency
    rows = zip(range(1, len(omega) + 1), omega / (2.0 * math.pi), omega, strict=True)
    return [
        title_of("DerivedChain", str(value.chain), "from its equations of motion in symbols"),
        table_of(("mode", "f [Hz]", "ω [rad/s]"), rows, words=()),
    ]


def _matched_springs(value: Any) -> list[str]:
    ratio, springs = value.stiffness_ratio.tolist(), value.chain.joint_stiffness.tolist()
    rows = [(k, *row) for k, row in enumerate(zip(ratio, springs, strict=True), start=1)]
    motion = getattr(value.boundary, "motion", "bending")
    met = f"{counted(value.modes, 'mode')} of the beam met"
    unit = "N/m" if motion == "stretch" else "N m/rad"
    return [
        title_of(type(value).__name__, str(value.boundary), counted(value.segments, "segment"), met),
        _drawing(value.chain) if motion == "bending" else "",
        table_of(("hinge", "k over the beam's own", f"k [{unit}]"), rows, words=()),
        pairs_table([("stable step, rk4", value.stable_time_step, "s")]),
    ]


def _flutter(value: Any) -> list[str]:
    rows: list[tuple[str, Any, str]] = [
        ("frequency", value.frequency, "Hz"),
        ("compression", value.compression, "N"),
        ("swings", value.is_flutter, ""),
    ]
    return [title_of("FlutterLoad"), pairs_table(rows)]


def _catalogue(value: Any) -> list[str]:
    columns = _COLUMNS.get(value.what, ())
    rows = []
    for name, record in value.items():
        told = [getattr(record, column) for column in columns] if columns else [_one_line(name, record)]
        rows.append([name, *(", ".join(each) if isinstance(each, tuple) else each for each in told)])
    head = ["name", *(column.replace("_", " ") for column in columns or ("",))]
    return [title_of(f"{len(rows)} {value.what}"), table_of(head, rows, range(len(head)), most=_MOST_LISTED)]


def _one_line(name: str, record: Any) -> str:
    if isinstance(record, type):
        return (record.__doc__ or "").partition("\n")[0]
    return str(record).removeprefix(f"{name}, ")


#: Of catalogues, what is told beside the name.
_COLUMNS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "rules": ("summary", "used_by"),
        "integrators": ("order", "springs", "damping", "engines"),
        "joint laws": ("orders",),
    }
)

_BUILDERS: Mapping[str, Callable[[Any], list[str]]] = MappingProxyType(
    {
        "Audit": _audit,
        "AxialAudit": _audit,
        "MendedFile": _mended,
        "SpatialAudit": _audit,
        "AxialBoundary": _ends,
        "AxialChain": _axial_chain,
        "AxialChainModes": _modes,
        "AxialMatchedSprings": _matched_springs,
        "AxialModes": _modes,
        "Beam": _beam,
        "BentModel": _model,
        "Boundary": _ends,
        "Case": _case,
        "Catalogue": _catalogue,
        "Chain": _chain,
        "DerivedChain": _derived,
        "Ends": _many_ends,
        "Equilibrium": _equilibrium,
        "ErrorLaw": _law,
        "EulerBernoulliModes": _modes,
        "FlutterLoad": _flutter,
        "Integrator": _integrator,
        "LinearModel": _model,
        "MatchedSprings": _matched_springs,
        "Modes": _modes,
        "Recommendation": _recommendation,
        "Recommendations": _recommendations,
        "Rod": _beam,
        "RodEnds": _ends,
        "RodModes": _modes,
        "Rule": _rule,
        "SpatialChain": _spatial_chain,
        "SpatialEquilibrium": _spatial_equilibrium,
        "SpatialModes": _modes,
        "Statics": _statics,
        "Structure": _structure,
        "StructureChain": _structure_chain,
        "StructureChainModes": _modes,
        "StructureModes": _modes,
        "StructureStatics": _structure_statics,
        "Study": _study,
        "TimoshenkoModes": _modes,
    }
)
