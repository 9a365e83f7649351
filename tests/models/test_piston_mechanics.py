"""Mechanics of crank, rod and tilting piston: against Lagrange's equations derived by sympy."""

import math
from collections import namedtuple
from dataclasses import fields
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from models.slider_crank.piston import contact as co
from models.slider_crank.piston import mechanics as me
from models.slider_crank.piston.records import DrivenParameters

from .slider_cranks import DRIVEN, energies

# Sums of some ten terms of products of sines.
ROUNDING = 1e-13
CASES = range(12)
Numbers = namedtuple("Numbers", [field.name for field in fields(DrivenParameters)])


@cache
def derive() -> SimpleNamespace:
    """Functions of (theta, eta, chi, their rates, pressure, *parameters) from the bodies' places alone."""
    q = sp.Matrix(sp.symbols("theta eta chi"))
    v = sp.Matrix(sp.symbols("theta1 eta1 chi1"))
    pressure = sp.Symbol("pressure")
    m = Numbers(*sp.symbols(Numbers._fields))
    theta, eta, chi = q

    def on_rod(distance: Any) -> Any:
        crank = m.crank_radius * sp.Matrix([sp.cos(theta), sp.sin(theta)])
        return crank + distance * sp.Matrix([sp.cos(eta), -sp.sin(eta)])

    def on_piston(along: Any, across: Any) -> Any:
        turned = sp.Matrix([[sp.cos(chi), -sp.sin(chi)], [sp.sin(chi), sp.cos(chi)]])
        return on_rod(m.rod_length) + turned * sp.Matrix([along - m.pin_height, across - m.pin_offset])

    def translation(place: Any, mass: Any) -> Any:
        velocity = place.jacobian(q) * v
        return mass * velocity.dot(velocity) / 2

    rod, piston = on_rod(m.rod_centre), on_piston(m.mass_height, m.mass_offset)
    kinetic = (
        (m.crank_inertia + m.crank_mass * m.crank_centre**2) * v[0] ** 2 / 2
        + translation(rod, m.rod_mass)
        + m.rod_inertia * v[1] ** 2 / 2
        + translation(piston, m.piston_mass)
        + m.piston_inertia * v[2] ** 2 / 2
    )
    gravity = sp.Matrix([m.gravity_along, m.gravity_across])
    crank = m.crank_mass * m.crank_centre * sp.Matrix([sp.cos(theta), sp.sin(theta)])
    potential = -gravity.dot(crank + m.rod_mass * rod + m.piston_mass * piston)
    loss = m.crank_pin_friction * (v[0] + v[1]) ** 2 + m.piston_pin_friction * (v[1] + v[2]) ** 2
    middle = on_piston(0, 0)
    gas = -pressure * m.bore_area * middle[0]
    momentum = sp.Matrix([kinetic]).jacobian(v)
    turning = (momentum.jacobian(q) * v).T - sp.Matrix([kinetic]).jacobian(q)
    applied = sp.Matrix([gas - potential]).jacobian(q) - sp.Matrix([loss]).jacobian(v) / 2
    a, b = sp.symbols("a b")
    point = on_piston(a, b)
    velocity = point.jacobian(q) * v
    arguments = [*q, *v, pressure, *m]

    def function(expression: Any, *more: Any) -> Any:
        return sp.lambdify([*arguments, *more], expression)

    return SimpleNamespace(
        mass=function(momentum.jacobian(v)),
        turning=function(turning),
        applied=function(applied),
        kinetic=function(kinetic),
        potential=function(potential),
        loss=function(loss),
        gas=function((sp.Matrix([gas]).jacobian(q) * v)[0]),
        point=function((point, point.jacobian(q), velocity.jacobian(q) * v), a, b),
    )


def random_case(seed: int) -> tuple[me.Coordinates, me.Coordinates, float, Numbers, list[float]]:
    random = np.random.default_rng(seed)
    q, v = random.uniform(-3.0, 3.0, 3), random.uniform(-5.0, 5.0, 3)
    m = random.uniform(0.1, 2.0, len(Numbers._fields))
    pressure = float(random.uniform(-3.0, 3.0))
    return (
        me.Coordinates(*q), me.Coordinates(*v), pressure, Numbers(*m), [*q, *v, pressure, *m]
    )  # fmt: skip


def matrix(s: me.Symmetric) -> np.ndarray:
    return np.array(
        [
            [s.theta_theta, s.theta_eta, s.theta_chi],
            [s.theta_eta, s.eta_eta, s.eta_chi],
            [s.theta_chi, s.eta_chi, s.chi_chi],
        ]
    )


@pytest.mark.parametrize("seed", CASES)
def test_equation_of_motion_energies_and_powers_are_lagranges(seed: int) -> None:
    q, v, pressure, m, numbers = random_case(seed)
    d = derive()
    assert matrix(me.mass_matrix(q, m)) == pytest.approx(d.mass(*numbers), rel=ROUNDING, abs=ROUNDING)
    size = 100.0  # of the largest terms that may cancel
    assert me.turning_forces(q, v, m) == pytest.approx(np.ravel(d.turning(*numbers)), abs=size * ROUNDING)
    assert me.applied_forces(q, v, pressure, m) == pytest.approx(
        np.ravel(d.applied(*numbers)), abs=size * ROUNDING
    )
    found = (
        me.kinetic_energy(q, v, m), me.potential_energy(q, m), me.joint_loss(v, m),
        me.gas_power(q, v, pressure, m),
    )  # fmt: skip
    expected = [f(*numbers) for f in (d.kinetic, d.potential, d.loss, d.gas)]
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("seed", CASES)
def test_places_rows_and_turning_of_a_piston_point(seed: int) -> None:
    q, v, _, m, numbers = random_case(seed)
    at = (0.7, -0.3)
    place, rows, turning = derive().point(*numbers, *at)
    assert me.position_along(*at, q, m) == pytest.approx(place[0, 0], abs=ROUNDING)
    assert me.position_across(*at, q, m) == pytest.approx(place[1, 0], abs=ROUNDING)
    assert me.along_row(*at, q, m) == pytest.approx(rows[0], abs=ROUNDING)
    assert me.across_row(*at, q, m) == pytest.approx(rows[1], abs=ROUNDING)
    assert me.along_turning(*at, q, v, m) == pytest.approx(turning[0, 0], abs=100.0 * ROUNDING)
    assert me.across_turning(*at, q, v, m) == pytest.approx(turning[1, 0], abs=100.0 * ROUNDING)


@pytest.mark.parametrize("seed", CASES)
def test_inverses_of_the_mass_matrix(seed: int) -> None:
    q, _, _, m, _ = random_case(seed)
    s = me.mass_matrix(q, m)
    worst = np.linalg.cond(matrix(s)) * ROUNDING
    assert matrix(me.free_inverse(s)) @ matrix(s) == pytest.approx(np.eye(3), abs=worst)
    driven = matrix(me.prescribed_inverse(s))
    assert not driven[0].any()
    assert driven[1:, 1:] @ matrix(s)[1:, 1:] == pytest.approx(np.eye(2), abs=worst)


MASS, INERTIA, LENGTH, HEIGHT = 0.4, 3e-4, 0.03, 0.04
# With a massless rod along the axis, only the piston's own inertia resists its motion across.
BLOCK = {
    "rod_mass": 0.0, "rod_inertia": 0.0, "piston_mass": MASS, "piston_inertia": INERTIA,
    "half_length": LENGTH, "half_height": HEIGHT, "pin_height": 0.0, "mass_height": 0.0,
}  # fmt: skip


def motion(values: dict[str, float], q: me.Coordinates, v: me.Coordinates) -> tuple[co.Motion, Any]:
    m = DRIVEN.parameters.view(DRIVEN.parameters.vector(values))
    return co.Motion(q, v, me.prescribed_inverse(me.mass_matrix(q, m)), me.Coordinates(0.0, 0.0, 0.0)), m


def rising_block(velocity: float) -> tuple[co.Motion, Any]:
    """A block that moves to the upper wall, untilted, with a crank at dead centre and at rest."""
    return motion(BLOCK, me.Coordinates(0.0, 0.0, 0.0), me.Coordinates(0.0, -velocity / 0.143, 0.0))


def test_impact_of_a_free_block():
    """Impulse (1 + e) v / (1/M + L^2/J) of one corner; flat, each of two gives (1 + e) M v / 2."""
    s, m = rising_block(2.0)
    jump = 1.3 * 2.0
    none = co.Pair(0.0, 0.0)
    found = co.solve_push(co.Touching(0, -1), none, co.Pair(-jump, 1.0), s, m).forces
    assert found == pytest.approx([jump / (1.0 / MASS + LENGTH**2 / INERTIA), 0.0], rel=1e-13, abs=0.0)
    found = co.solve_push(co.Touching(0, 1), none, co.Pair(-jump, -jump), s, m).forces
    assert found == pytest.approx([0.5 * MASS * jump] * 2, rel=1e-12)


@pytest.mark.parametrize("friction", [0.8, 1.0, 5.0])
def test_corner_of_a_free_block_sticks_where_friction_suffices(friction):
    """The impulse through the block's centre stops the corner: Lambda_T / Lambda_N = L / H. Also where more
    friction would jam it (mu D_NT > D_NN)."""
    s, m = rising_block(2.0)
    touching, w = co.Touching(0, -1), co.Pair(-2.0, 1.0)
    push = co.solve_impulses(touching, w, friction, s, m)
    assert abs(push.ratios.first) == pytest.approx(LENGTH / HEIGHT, rel=1e-12)
    v = co.add_reaction(touching, push, s.v, s, m)
    assert co.sliding_velocity(0, s.q, v, m) == pytest.approx(0.0, abs=1e-12)
    assert abs(co.solve_impulses(touching, w, 0.1, s, m).ratios.first) == 0.1


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.lists(st.floats(-2.0, 2.0), min_size=6, max_size=6))
def test_complementarity(numbers):
    """z >= 0, A z + w >= 0, z (A z + w) = 0 for positive definite A."""
    a, b, c, d, first, second = numbers
    B = np.array([[a, b], [c, d]])
    A, w = B @ B.T + 0.1 * np.eye(2), np.array([first, second])
    z = np.array(co.solve_complementarity(co.Pair(*A[0]), co.Pair(*A[1]), co.Pair(*w)))
    gaps = A @ z + w
    size = 1.0 + np.abs(A).max() * np.abs(z).max()
    assert z.min() >= 0.0
    assert gaps.min() >= -1e-12 * size
    assert np.abs(z * gaps).max() <= 1e-12 * size**2


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    theta=st.floats(-3.0, 3.0),
    tilt=st.floats(-2e-3, 2e-3),
    speed=st.floats(-300.0, 300.0),
    eta_rate=st.floats(-5.0, 5.0),
    tilt_rate=st.floats(-20.0, 20.0),
    restitution=st.floats(0.0, 1.0),
    friction=st.floats(0.0, 0.3),
    pair=st.sampled_from([(0, -1), (3, -1), (0, 1), (2, 3), (0, 3), (1, 2)]),
)
def test_law_of_impact(
    theta, tilt, speed, eta_rate, tilt_rate, restitution,
    friction, pair):  # fmt: skip
    """Moreau's conditions hold after an impact of any touching corners in any motion."""
    q = me.Coordinates(theta, math.asin(0.043 * math.sin(theta) / 0.143), tilt)
    rod = 0.043 * math.cos(theta) * speed / (0.143 * math.cos(q.eta))
    s, m = motion({}, q, me.Coordinates(speed, rod + eta_rate, tilt_rate))
    touching = co.Touching(*pair)
    corners = [i for i in pair if i >= 0]
    before = [me.dot(co.normal(i, q, m), s.v) for i in corners]
    assume(min(before) < -1e-6)
    w = [rate + restitution * min(rate, 0.0) for rate in before] + [1.0]
    push = co.solve_impulses(touching, co.Pair(w[0], w[1]), friction, s, m)
    found, ratios = push
    v = co.add_reaction(touching, push, s.v, s, m)
    size = 1e-11 * (1.0 + abs(speed))
    for i, corner in enumerate(corners):
        xi = me.dot(co.normal(corner, q, m), v) + restitution * min(before[i], 0.0)
        assert found[i] >= 0.0
        assert xi >= -size
        assert found[i] * xi <= size
        assert abs(ratios[i]) <= friction
    if max(abs(r) for r in ratios[: len(corners)]) < friction:  # stopped
        assert abs(co.slip_power(touching, push, s, m)) <= size
    else:
        assert co.slips(touching, push, s, m)


@pytest.mark.plain
@settings(max_examples=30, deadline=None, derandomize=True)
@given(
    corner=st.sampled_from([0, 1, 2, 3]),
    partner=st.sampled_from([None, "side", "diagonal"]),
    theta=st.floats(-3.0, 3.0),
    rate=st.floats(0.01, 1.0),
    restitution=st.sampled_from([0.0, 0.6, 1.0]),
    friction=st.sampled_from([0.0, 0.1]),
)
def test_energy_of_an_impact_is_work_of_the_crank_less_its_loss(
    corner, partner, theta, rate, restitution, friction
):
    """Stored energy with losses and the crank's work does not jump; the crank's impulse does the work. An
    elastic impact without friction loses nothing."""
    p = DRIVEN.parameters.vector({"restitution": restitution, "pin_offset": 1e-3, "wall_friction": friction})
    x, u = DRIVEN.state.vector(), DRIVEN.inputs.vector({"crank_angle": theta, "crank_speed": 200.0})
    m = DRIVEN.parameters.view(p)
    side, along = co.side(corner), co.corner_along(corner, m)
    if partner is None:
        x[:4] = side * m.clearance, side * rate, 0.0, 0.0
        x[2] = 1e-4 * side * math.copysign(1.0, along)
        x[0] += side * 2.0 * m.half_height * math.sin(0.5 * x[2]) ** 2 - along * math.sin(x[2])
    else:
        other = corner ^ 1 if partner == "side" else 3 - corner
        x[4 + other] = 1.0
        tilt = 0.0
        if partner == "diagonal":
            tilt = side * math.copysign(1.0, along) * m.clearance / m.half_length
        x[2], x[3] = tilt, side * math.copysign(rate, along) / m.half_length
    before = energies(DRIVEN, x, u, p)[0]
    DRIVEN.flat_transition(corner, 0.1, x, u, p)
    stored = energies(DRIVEN, x, u, p)[0]
    named = DRIVEN.state.named(x)
    # The corner is also put on its wall, by 1e-7 m in the diagonal start made here.
    allowed = 1e-12 if partner != "diagonal" else 1e-3
    assert stored - named["impact_work"] + named["impact_loss"] == pytest.approx(before, rel=allowed)
    if restitution == 1.0 and friction == 0.0:
        assert named["impact_loss"] == pytest.approx(0.0, abs=allowed * before)
    assert named[f"impact_count[{corner + 1}]"] == 1.0
    assert named["last_impact_time"] == 0.1
    assert named["impact_work"] == pytest.approx(200.0 * named["crank_impact_impulse"], rel=1e-12, abs=1e-12)
