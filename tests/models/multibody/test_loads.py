"""Force elements against sympy: their power is the loss of a potential, less what a damper takes."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
import sympy as sp

from models.core.quantities import Vector
from models.multibody.bodies import Body, make_axes
from models.multibody.forces import (
    ALONG_SHAFT,
    ElasticField,
    SpringDamper,
    beam_stiffness,
    modal_damping,
    rod_rate,
)
from models.multibody.mechanism import Mechanism

from .test_constraints import AT_I, AT_J, COEFFICIENTS, R_I, R_J, TIME, D, along, draw

STIFFNESS, DAMPING, LENGTH = 3e4, 20.0, 0.4
REST = (0.1, 0.05, -0.02)
AXES_I, AXES_J = make_axes((0.3, 0.2, 0.9)).T, make_axes((0.4, 0.1, 0.8)).T
STEEL = {"youngs_modulus": 207e9, "poissons_ratio": 0.3}


def symmetric(seed: int) -> Vector:
    """A positive definite matrix of order 6."""
    root = np.random.default_rng(seed).normal(size=(6, 6))
    return root @ root.T


FIELD, FIELD_DAMPING = symmetric(1), symmetric(2)


def elongation() -> list[sp.Expr]:
    return [sp.sqrt(D.dot(D)) - LENGTH]


def field_coordinates() -> list[sp.Expr]:
    """Displacement and turn of j's frame in i's."""
    e_i, e_j = sp.Matrix(AXES_I), sp.Matrix(AXES_J)
    shift = e_i.T * R_I.T * D - sp.Matrix(REST)
    a = e_i.T * R_I.T * R_J * e_j
    return [*shift, (a[2, 1] - a[1, 2]) / 2, -a[2, 0], a[1, 0]]


ELEMENTS = {
    "spring and damper": (
        SpringDamper("first", "second", STIFFNESS, LENGTH, DAMPING, AT_I, AT_J),
        elongation,
        np.array([[STIFFNESS]]),
        np.array([[DAMPING]]),
    ),
    "elastic field": (
        ElasticField("first", "second", FIELD, FIELD_DAMPING, REST, AT_I, AT_J, AXES_I, AXES_J),
        field_coordinates,
        FIELD,
        FIELD_DAMPING,
    ),
}


@cache
def deformations(name: str) -> Callable[..., list[float]]:
    """The element's deformations and their rates."""
    found = ELEMENTS[name][1]()
    rates = [sp.diff(e, TIME) for e in found]
    return sp.lambdify((TIME, *COEFFICIENTS), [found, rates], modules="numpy", cse=True)


def load_between(name: str) -> Mechanism:
    """Two bodies whose gyroscopic moments vanish."""
    bodies = [Body(body, 1.0, (0.1, 0.1, 0.1)) for body in ("first", "second")]
    return Mechanism(bodies, [], [ELEMENTS[name][0]])


@pytest.mark.parametrize("name", ["spring and damper", pytest.param("elastic field", marks=pytest.mark.long)])
def test_power_of_an_element_is_that_of_its_potential_and_damper(name: str) -> None:
    """f v' for an arbitrary v' is -(K e + C e') de/dv v'; the deformations e are linear in v."""
    coefficients, t = draw(0), 0.01
    *_, stiffness, damping = ELEMENTS[name]
    q, v, _ = along(coefficients, t)
    force = load_between(name).evaluate(t, q, v).force.copy()
    e, rate = deformations(name)(t, *coefficients)
    load = stiffness @ np.asarray(e, float) + damping @ np.asarray(rate, float)
    for other in range(10, 14):
        trial = coefficients.copy()
        # Other rates with the place at t kept.
        trial[12:24] = draw(other)[12:24]
        trial[:12] += (coefficients[12:24] - trial[12:24]) * t
        _, moved, _ = along(trial, t)
        _, trial_rate = deformations(name)(t, *trial)
        expected = -load @ np.asarray(trial_rate, float)
        assert force @ moved == pytest.approx(expected, rel=1e-11, abs=1e-11)


@pytest.mark.parametrize("name", ELEMENTS)
def test_an_element_gives_a_system_neither_momentum_nor_angular_momentum(name: str) -> None:
    q, v, _ = along(draw(5), 0.0)
    f = load_between(name).evaluate(0.0, q, v).force.reshape(2, 2, 3)
    np.testing.assert_allclose(f[0, 0] + f[1, 0], 0.0, atol=1e-12 * np.max(np.abs(f)))
    about_ground = sum(f[b, 1] + np.cross(q[6 * b : 6 * b + 3], f[b, 0]) for b in (0, 1))
    np.testing.assert_allclose(about_ground, 0.0, atol=1e-12 * np.max(np.abs(f)))


def test_a_round_shaft_bends_alike_however_its_end_is_turned() -> None:
    """Without stiffness in torsion, turning the end about its own axis changes no force."""
    k = beam_stiffness(0.1, 0.02, **STEEL)
    k[3, 3] = 0.0
    bodies = [Body(body, 1.0, (0.1, 0.1, 0.1)) for body in ("first", "second")]
    shaft = ElasticField("first", "second", k, 0.0 * k, REST, axes_i=ALONG_SHAFT, axes_j=ALONG_SHAFT)
    mechanism, still = Mechanism(bodies, [], [shaft]), np.zeros(12)
    q, turned = draw(7)[:12], draw(7)[:12]
    # The last of the Cardan angles 1-2-3 turns a body about its own third axis.
    turned[11] += 0.7
    force = mechanism.evaluate(0.0, q, still).force.copy()
    expected = mechanism.evaluate(0.0, turned, still).force
    np.testing.assert_allclose(force, expected, atol=1e-12 * np.max(np.abs(force)))


def test_flexibility_of_the_beam_at_its_tip(record: Callable[..., None]) -> None:
    """L^3/(3 E I) + A_y L/(G A) of a clamped steel beam of 100 mm and d = 20 mm, A_y = 10/9."""
    k = beam_stiffness(0.1, 0.02, shear_factor=10.0 / 9.0, **STEEL)
    flexibility = np.linalg.inv(k)
    quantity = "tip flexibility of a beam (m/N)"
    record("Multibody", quantity, flexibility[1, 1], 2.09473e-7, "closed form", relative=3e-6)
    assert flexibility[2, 2] == pytest.approx(flexibility[1, 1], rel=1e-12)
    assert rod_rate(207e9, 50e-6, 0.05) == pytest.approx(207e9 * 50e-6 / 0.05)


def test_damping_gives_every_mode_its_ratio() -> None:
    """x'' = -M^-1 (K x + C x'): eigenvalues -zeta w +- i w sqrt(1 - zeta^2)."""
    k, masses = beam_stiffness(0.1, 0.02, **STEEL), np.array([0.4, 0.4, 0.4, 3e-4, 1.4e-4, 1.4e-4])
    c = modal_damping(k, masses, 0.02)
    system = np.block([[np.zeros((6, 6)), np.eye(6)], [-k / masses[:, None], -c / masses[:, None]]])
    values = np.linalg.eigvals(system)
    np.testing.assert_allclose(-values.real / np.abs(values), 0.02, rtol=1e-9)
