"""Torsion constants of sections: published tables, series in 40 digits, finite elements; beams with them."""

from __future__ import annotations

import math
from types import SimpleNamespace

import mpmath
import pytest

from beammodes.problem.beam import Beam
from beammodes.problem.motions import MOTIONS
from beammodes.problem.sections import (
    Box,
    Channel,
    Circle,
    GivenSection,
    ISection,
    Rectangle,
    Tube,
    from_sectionproperties,
)


def test_a_rectangle_by_its_series_in_many_digits_and_by_the_table() -> None:
    def by_the_other_series(ratio: float) -> mpmath.mpf:
        # Saint-Venant's series as it stands, along the first side whichever is longer: another one for b > a.
        a, b = mpmath.mpf(1), mpmath.mpf(ratio)
        terms = mpmath.nsum(
            lambda k: mpmath.tanh((2 * k + 1) * mpmath.pi * a / (2 * b)) / (2 * k + 1) ** 5, [0, mpmath.inf]
        )
        return a * b**3 / 3 - 64 * b**4 / mpmath.pi**5 * terms

    with mpmath.workdps(40):
        for ratio in (0.001, 0.1, 0.37, 1.0, 1.6, 5.0):
            exact = float(by_the_other_series(ratio))
            assert Rectangle(ratio, 1.0).torsion_constant == pytest.approx(exact, rel=2e-15)
            assert Rectangle(1.0, ratio).torsion_constant == Rectangle(ratio, 1.0).torsion_constant
    # Timoshenko and Goodier, Theory of Elasticity, 3rd ed., section 109, table of k₁: J = k₁ (2a)³ (2b).
    table = {
        1.0: 0.1406,
        1.2: 0.166,
        1.5: 0.196,
        2.0: 0.229,
        2.5: 0.249,
        3: 0.263,
        4: 0.281,
        5: 0.291,
        10: 0.312,
    }
    for ratio, factor in table.items():
        assert Rectangle(1.0, ratio).torsion_constant / ratio == pytest.approx(factor, abs=6e-4)


def test_round_sections_have_their_polar_moment() -> None:
    # π (D⁴ - d⁴)/32, any handbook.
    assert Circle(0.01).torsion_constant == pytest.approx(math.pi * 0.01**4 / 32, rel=1e-15)
    assert Tube(2.0, inner=1.0).torsion_constant == pytest.approx(math.pi * 15 / 32, rel=1e-15)


def test_plates_in_the_limit_of_thin_walls() -> None:
    # Σ b t³/3 of open sections and Bredt's 4 A²/∮ds/t of closed ones, as t → 0.
    t = 1e-6
    assert Box(1.0, 2.0, t).torsion_constant == pytest.approx(4 * 4 / (6 / t), rel=1e-5)
    for open_section in (ISection(1.0, 2.0, t, t), Channel(1.0, 2.0, t, t)):
        assert open_section.torsion_constant == pytest.approx(4 * t**3 / 3, rel=1e-5)


# What the package sectionproperties 3 finds with quadratic triangles, a dozen or more over the square of the
# thinnest plate [mm⁴].
FINITE_ELEMENTS = [
    (ISection(100, 200, 8.5, 5.6), 50717, 0.011),
    (ISection(100, 200, 10, 3), 64490, 0.011),
    (ISection(100, 200, 5, 10), 72799, 0.011),
    (ISection(100, 200, 20, 10), 5.3999e5, 0.011),
    (ISection(100, 200, 20, 20), 9.9209e5, 0.017),
    (ISection(100, 200, 25, 25), 1.8995e6, 0.021),
    (Channel(100, 200, 8.5, 5.6), 50052, 0.011),
    (Channel(100, 200, 10, 3), 64182, 0.011),
    (Channel(100, 200, 20, 20), 9.5259e5, 0.015),
    (Channel(50, 100, 15, 10), 1.2049e5, 0.011),
    (Box(100, 100, 5), 4.3977e6, 0.002),
    (Box(60, 100, 4), 1.5610e6, 0.002),
    (Box(100, 100, 30), 1.35707e7, 0.002),
    (Box(30, 100, 10), 6.8795e5, 0.002),
]


@pytest.mark.parametrize(("section", "constant", "within"), FINITE_ELEMENTS, ids=repr)
def test_walls_are_as_good_as_they_say(section: Box, constant: float, within: float) -> None:
    assert section.torsion_constant == pytest.approx(constant, rel=within)


def test_sectionproperties_gives_its_own() -> None:
    library = pytest.importorskip("sectionproperties.pre.library")
    analysis = pytest.importorskip("sectionproperties.analysis")
    geometry = library.channel_section(d=200, b=100, t_f=10, t_w=6, r=0, n_r=1)
    geometry.create_mesh(mesh_sizes=[10])
    section = analysis.Section(geometry)
    section.calculate_geometric_properties()
    assert from_sectionproperties(section).torsion_constant is None
    section.calculate_warping_properties()
    found, formula = from_sectionproperties(section, length_unit=1e-3), Channel(0.1, 0.2, 0.01, 0.006)
    assert found.torsion_constant == pytest.approx(formula.torsion_constant, rel=0.02)
    ours = (formula.area, formula.second_moment, formula.weak_second_moment)
    assert (found.area, found.second_moment, found.weak_second_moment) == pytest.approx(ours, rel=1e-9)


def test_beams_know_what_twists_and_stretches() -> None:
    # A steel rod of 10 mm: G = E/2.6; J = Ip = π d⁴/32, A = π d²/4.
    rod = Beam.from_section(
        Circle(0.010), length=0.5, elastic_modulus=206.18e9, density=7850.0, poisson_ratio=0.3
    )
    polar = math.pi * 0.010**4 / 32
    assert MOTIONS["twist"].numbers(rod) == pytest.approx((79.3e9 * polar, 7850.0 * polar), rel=1e-14)
    assert MOTIONS["stretch"].mean_numbers(rod)[0] == pytest.approx(206.18e9 * math.pi * 0.005**2, rel=1e-14)
    assert MOTIONS["twist"].frequency_unit(rod) == pytest.approx(math.sqrt(79.3e9 / 7850.0) / 0.5, rel=1e-14)
    stepped = Beam(1.0, 1.0, 1.0, torsional_stiffness=[2.0, 1.0], polar_inertia_per_length=lambda x: 1.0 + x)
    assert stepped.breaks == (0.5,) and not MOTIONS["twist"].is_uniform(stepped)
    assert MOTIONS["twist"].mean_numbers(stepped) == pytest.approx((1.5, 1.5), rel=1e-12)


def test_what_is_missing_is_named() -> None:
    with pytest.raises(ValueError, match=r"its torsional_stiffness for motion twist, .*: give Beam\(.*GJ"):
        MOTIONS["twist"].numbers(Beam.unit())
    with pytest.raises(ValueError, match=r"its axial_stiffness .*axial_stiffness=EA\) \[N\], or take Beam"):
        MOTIONS["stretch"].numbers(Beam.unit())
    given = GivenSection(28.5e-4, 1943e-8, 142e-8)
    beam = Beam.from_section(given, length=1.0, elastic_modulus=2e11, density=7800.0)
    assert beam.torsional_stiffness is None and beam.polar_inertia_per_length is not None
    bare = SimpleNamespace(area=1.0, second_moment=1.0)
    assert (
        Beam.from_section(bare, length=1.0, elastic_modulus=1.0, density=1.0).polar_inertia_per_length is None
    )
    with pytest.raises(ValueError, match="torsion_constant must be greater than 0"):
        GivenSection(1.0, 1.0, 1.0, -1.0)
