"""Mechanics of crank, rod and tilting piston: against Lagrange's equations derived by sympy."""

from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import sympy as sp

from models.slider_crank.piston import mechanics as me

# Sums of some ten terms of products of sines.
ROUNDING = 1e-13
CASES = range(12)


@cache
def derive() -> SimpleNamespace:
    """Functions of (theta, eta, chi, their rates, pressure, *machine) from the bodies' places alone."""
    q = sp.Matrix(sp.symbols("theta eta chi"))
    v = sp.Matrix(sp.symbols("theta1 eta1 chi1"))
    pressure = sp.Symbol("pressure")
    m = me.Machine(*sp.symbols(me.Machine._fields))
    theta, eta, chi = q

    def on_rod(distance: Any) -> Any:
        crank = m.crank_radius * sp.Matrix([sp.cos(theta), sp.sin(theta)])
        return crank + distance * sp.Matrix([sp.cos(eta), -sp.sin(eta)])

    def on_piston(along: Any, across: Any) -> Any:
        turned = sp.Matrix([[sp.cos(chi), -sp.sin(chi)], [sp.sin(chi), sp.cos(chi)]])
        return on_rod(m.rod_length) + turned * sp.Matrix([along - m.pin_along, across - m.pin_across])

    def translation(place: Any, mass: Any) -> Any:
        velocity = place.jacobian(q) * v
        return mass * velocity.dot(velocity) / 2

    rod, piston = on_rod(m.rod_centre), on_piston(m.mass_along, m.mass_across)
    kinetic = (
        m.crank_inertia * v[0] ** 2 / 2
        + translation(rod, m.rod_mass)
        + m.rod_inertia * v[1] ** 2 / 2
        + translation(piston, m.piston_mass)
        + m.piston_inertia * v[2] ** 2 / 2
    )
    gravity = sp.Matrix([m.gravity_along, m.gravity_across])
    crank = m.crank_imbalance * sp.Matrix([sp.cos(theta), sp.sin(theta)])
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


def random_case(seed: int) -> tuple[me.Coordinates, me.Coordinates, float, me.Machine, list[float]]:
    random = np.random.default_rng(seed)
    q, v = random.uniform(-3.0, 3.0, 3), random.uniform(-5.0, 5.0, 3)
    m = random.uniform(0.1, 2.0, len(me.Machine._fields))
    pressure = float(random.uniform(-3.0, 3.0))
    return (
        me.Coordinates(*q), me.Coordinates(*v), pressure, me.Machine(*m), [*q, *v, pressure, *m]
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
