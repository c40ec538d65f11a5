"""The eigen-solve: accuracy against 50-digit arithmetic, shapes, rigid-body modes, long chains."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import mpmath
import numpy as np
import pytest
from drawn_ends import EVERY_N

from beammodes.chains.chain import Chain
from beammodes.chains.rules import RULES
from beammodes.exact.beam_theory import euler_bernoulli
from beammodes.problem.beam import Beam
from beammodes.problem.ends import BOUNDARIES, ENDS, Boundary
from beammodes.vibration import modes as modes_module
from beammodes.vibration.linear import MAX_ASSEMBLED, linearize
from beammodes.vibration.modes import solve_modes

Exact = Callable[[Chain], list[mpmath.mpf]]


def relative_errors(found: np.ndarray, exact: list[mpmath.mpf], unit: float) -> np.ndarray:
    return np.array([abs(float(mpmath.mpf(f) / (unit * e) - 1)) for f, e in zip(found, exact, strict=False)])


@pytest.mark.parametrize("boundary", [pair.name for pair in BOUNDARIES])
def test_every_frequency_of_a_short_chain_keeps_its_digits(
    boundary: str, frequencies_in_50_digits: Exact
) -> None:
    for segments, rule in itertools.product((1, 2, 5, 12), EVERY_N):
        if min(RULES[rule].hinge_weights(Boundary.of(boundary), segments), default=1) <= 0:
            continue
        chain = Chain(Beam(1.3, 2.0, 0.7), boundary, segments, rule)
        found = solve_modes(linearize(chain))
        exact = frequencies_in_50_digits(chain)
        rigid = chain.boundary.rigid_body_modes
        assert found.rigid_body_modes == rigid
        assert len(found.angular_frequency) == len(exact) - rigid == chain.elastic_modes
        errors = relative_errors(found.angular_frequency, exact[rigid:], chain.units.angular_frequency)
        assert errors.max(initial=0.0) < 1e-13


def uneven(pieces: int, boundary: str, seed: int) -> Chain:
    generator = np.random.default_rng(seed)
    length, mass = generator.uniform(0.5, 1.5, (2, pieces))
    inertia = mass * length**2 * generator.uniform(0.05, 0.25, pieces)
    return Chain.from_pieces(
        length=length,
        mass=mass,
        rotary_inertia=inertia,
        joint_stiffness=np.exp(generator.normal(0, 1, pieces - 1)),
        boundary=boundary,
    )


@pytest.mark.parametrize("boundary", [f"{a}-{b}" for a, b in itertools.product(ENDS, ENDS)])
def test_uneven_chains_by_both_solvers(
    boundary: str, frequencies_in_50_digits: Exact, monkeypatch: pytest.MonkeyPatch
) -> None:
    chain = uneven(24, boundary, seed=len(boundary))
    rigid = chain.boundary.rigid_body_modes
    exact = frequencies_in_50_digits(chain)[rigid:]
    dense = solve_modes(linearize(chain))
    assert relative_errors(dense.angular_frequency, exact, 1.0).max() < 1e-12
    monkeypatch.setattr(modes_module, "_FEW_HINGES", 10)
    lanczos = solve_modes(linearize(chain), 2)
    assert relative_errors(lanczos.angular_frequency, exact, 1.0).max() < 1e-13
    np.testing.assert_allclose(lanczos.deflection, dense.deflection[:2], rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("boundary", [f"{a}-{b}" for a, b in itertools.product(ENDS, ENDS)])
def test_shapes_diagonalize_the_assembled_matrices(boundary: str) -> None:
    model = linearize(Chain(Beam(1.3, 2.0, 0.7), boundary, segments=5))
    modes = solve_modes(model)
    nodes = [int(name.removeprefix("y_")) for name in model.coordinates]
    shapes, size = modes.deflection[:, nodes], len(modes.angular_frequency)
    squares = modes.angular_frequency**2
    np.testing.assert_allclose(shapes @ model.mass_matrix @ shapes.T, np.eye(size), atol=1e-11)
    np.testing.assert_allclose(
        shapes @ model.stiffness_matrix @ shapes.T, np.diag(squares), atol=1e-9 * squares.max()
    )
    slopes = np.diff(modes.deflection, axis=1)
    moving = model.chain.length > 0
    np.testing.assert_allclose(
        modes.rotation[:, moving], slopes[:, moving] / model.chain.length[moving], atol=1e-8
    )
    assert (modes.deflection.max(axis=1) >= -modes.deflection.min(axis=1) * (1 - 1e-9)).all()


def pinned_pinned(segments: int, modes: int) -> np.ndarray:
    """theory.md section 4: q = n π/N exactly in  ω² = 12 (1 - cos q)²/(2 + cos q),  in half angles."""
    sine = np.sin(np.arange(1, modes + 1) * np.pi / (2 * segments)) ** 2
    return segments**2 * np.sqrt(12 * (2 * sine) ** 2 / (3 - 2 * sine))


@pytest.mark.parametrize("segments", [501, 5000, 100_000])
def test_long_chain_has_the_closed_form_frequencies(segments: int) -> None:
    found = solve_modes(linearize(Chain(Beam.unit(), "pinned-pinned", segments)), 10).angular_frequency
    np.testing.assert_allclose(found, pinned_pinned(segments, 10), rtol=1e-12)


def test_long_uneven_chain_against_extended_precision() -> None:
    """Subspace iteration on the flexibility operator, in 64-bit-mantissa arithmetic: no line in common."""
    pieces = 3000
    chain = uneven(pieces, "clamped-free", seed=5)
    length, mass, inertia = (
        np.array(values, dtype=np.longdouble)[:, None]
        for values in (chain.length, chain.mass, chain.rotary_inertia)
    )
    if np.finfo(np.longdouble).nmant < 60:
        pytest.skip("this machine has no extended precision")
    flexibility = 1 / np.array(chain.joint_stiffness, dtype=np.longdouble)[:, None]

    def after(values: np.ndarray) -> np.ndarray:
        return np.cumsum(values[::-1], axis=0)[::-1]

    # The first piece is held: angles are the sums of the joints' rotations, deflections those of the angles.
    basis = np.random.default_rng(0).standard_normal((pieces - 1, 8)).astype(np.longdouble)
    for _ in range(12):
        angle = np.vstack([np.zeros((1, 8), np.longdouble), np.cumsum(basis, axis=0)])
        tip = np.cumsum(length * angle, axis=0)
        force = mass * (tip - length * angle / 2)
        moment = after(inertia * angle + length * (after(force) - force / 2))[1:]
        image = flexibility * moment
        gram = basis.T @ moment
        energy = basis.T @ (basis / flexibility)
        values, turn = np.linalg.eig(np.linalg.solve(energy.astype(float), gram.astype(float)))
        basis = image @ turn.real.astype(np.longdouble)
        basis /= np.abs(basis).max(axis=0)
    order = np.argsort(-values.real)[:3]
    pick = basis[:, order]
    angle = np.vstack([np.zeros((1, 3), np.longdouble), np.cumsum(pick, axis=0)])
    middle = np.cumsum(length * angle, axis=0) - length * angle / 2
    kinetic = (mass * middle**2 + inertia * angle**2).sum(axis=0)
    reference = np.sqrt((pick**2 / flexibility).sum(axis=0) / kinetic).astype(float)
    found = solve_modes(linearize(chain), 3).angular_frequency
    np.testing.assert_allclose(found, np.sort(reference), rtol=1e-12)


def test_a_million_springs() -> None:
    segments = 1_000_000
    found = solve_modes(linearize(Chain(Beam.unit(), "pinned-pinned", segments)), 3).angular_frequency
    np.testing.assert_allclose(found, pinned_pinned(segments, 3), rtol=1e-12)


def test_too_much_is_refused_with_a_reason() -> None:
    model = linearize(Chain(Beam.unit(), "clamped-free", 3000))
    with pytest.raises(ValueError, match="modes must be at most 300"):
        solve_modes(model, 301)
    assert model.chain.pieces > MAX_ASSEMBLED
    with pytest.raises(ValueError, match="not assembled"):
        model.stiffness_matrix  # noqa: B018
    for modes in (0, -1):
        with pytest.raises(ValueError, match="modes"):
            solve_modes(model, modes)
    with pytest.raises(TypeError, match="model"):
        solve_modes(model.chain)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="chain"):
        linearize("clamped-free")  # type: ignore[arg-type]


def test_a_chain_that_cannot_move_has_empty_matrices() -> None:
    model = linearize(Chain(Beam.unit(), "clamped-clamped", 1))
    assert model.mass_matrix.shape == model.stiffness_matrix.shape == (0, 0)
    assert model.joint_rotations.shape == (2, 0)
    assert solve_modes(model).deflection.shape == (0, 4)


@pytest.mark.parametrize("segments", [49, 100, 400])
def test_nodes_end_where_the_beam_does(segments: int) -> None:
    beam = Beam(1.3, 2.0, 0.7)
    modes = solve_modes(linearize(Chain(beam, "clamped-free", segments)), 1)
    assert modes.position[0] == 0.0
    assert modes.position[-1] == beam.length
    # So the exact shape can be taken at them.
    assert euler_bernoulli(beam, "clamped-free", 1).shape(modes.position).shape == modes.deflection.shape


@pytest.mark.parametrize("boundary", ["clamped-clamped", "pinned-pinned", "free-free", "guided-guided"])
@pytest.mark.parametrize("segments", [3, 4, 5, 8, 15, 39])
def test_antisymmetric_modes_are_positive_on_the_left(boundary: str, segments: int) -> None:
    # Rounding would choose between the two ends of such a mode, and differently on other machines.
    shapes = solve_modes(linearize(Chain(Beam.unit(), boundary, segments))).deflection
    odd = [shape for shape in shapes if np.allclose(shape, -shape[::-1], atol=1e-9 * np.abs(shape).max())]
    assert odd
    for shape in odd:
        largest = np.flatnonzero(np.abs(shape) > (1 - 1e-6) * np.abs(shape).max())
        assert shape[largest[0]] > 0 > shape[largest[-1]]
