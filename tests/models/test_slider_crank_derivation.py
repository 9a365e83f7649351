"""The equations of the slider-crank derived symbolically from its bodies' kinetic energy.

Two coordinates: theta (crank) and psi; lengths over l, masses over M. The rod's angle below the axis is
phi - psi, so that it turns at phi' - psi'. F (2.13) follows from phi' + psi' instead: F's sign error.
"""

import functools
from collections.abc import Callable, Iterator

import numpy as np
import pytest
import sympy as sp

from models.slider_crank import energetics, nonlinear
from models.slider_crank import equations as eq
from models.slider_crank.equations import Crank, Mechanism

THETA, PSI, SPEED, RATE, ACCELERATION, CHANGE = sp.symbols("theta psi theta' psi' theta'' psi''")
XI, ALPHA, BETA, DAMPING = sp.symbols("xi alpha beta lambda", positive=True)
COORDINATES, RATES, CHANGES = (THETA, PSI), (SPEED, RATE), (ACCELERATION, CHANGE)
SYMBOLS = (*COORDINATES, *RATES, *CHANGES, XI, ALPHA, BETA, DAMPING)
PHI = sp.asin(XI * sp.sin(THETA))
# Terms of the size of a few units cancel; some tens of roundings.
ROUNDING = 2e-14

Values = tuple[float, ...]


def time_derivative(expression: sp.Expr) -> sp.Expr:
    """d/dt along the motion."""
    along = zip((*COORDINATES, *RATES), (*RATES, *CHANGES), strict=True)
    return sum(sp.diff(expression, q) * v for q, v in along)


ETA = PHI - PSI
ROD_MIDDLE = (XI * sp.cos(THETA) + sp.cos(ETA) / 2, XI * sp.sin(THETA) - sp.sin(ETA) / 2)
PISTON = (XI * sp.cos(THETA) + sp.cos(ETA), XI * sp.sin(THETA) - sp.sin(ETA))
OFFSET = PISTON[1]


def kinetic_energy(turning: sp.Expr) -> sp.Expr:
    """Of rod and piston, the rod turning at that rate."""

    def square(place: tuple[sp.Expr, sp.Expr]) -> sp.Expr:
        return sum(time_derivative(coordinate) ** 2 for coordinate in place)

    return (ALPHA * square(ROD_MIDDLE) + square(PISTON) + BETA * turning**2) / 2


@functools.cache
def left_side(energy: sp.Expr, i: int) -> sp.Expr:
    """d/dt dT/dq' - dT/dq and the crank pin's friction, dD/dq' of D = lambda (theta' + eta')^2/2."""
    friction = DAMPING * (SPEED + time_derivative(ETA)) * sp.diff(SPEED + time_derivative(ETA), RATES[i])
    return time_derivative(sp.diff(energy, RATES[i])) - sp.diff(energy, COORDINATES[i]) + friction


TRUE_TURNING = time_derivative(PHI) - RATE
PUBLISHED_TURNING = time_derivative(PHI) + RATE
ENERGY = kinetic_energy(TRUE_TURNING)
LEFT = {turning: left_side(kinetic_energy(turning), 1) for turning in (TRUE_TURNING, PUBLISHED_TURNING)}


@functools.cache
def compile_expression(expression: sp.Expr) -> Callable[..., float]:
    function: Callable[..., float] = sp.lambdify(SYMBOLS, expression, "math", cse=True)
    return function


def evaluate(expression: sp.Expr, values: Values, m: Mechanism) -> float:
    """At (theta, psi, theta', psi', theta'', psi'')."""
    return float(compile_expression(expression)(*values, m.xi, m.alpha, m.beta, m.damping))


def mechanisms(sign: float = 1.0) -> Iterator[tuple[np.random.Generator, Mechanism]]:
    random = np.random.default_rng(11)
    for _ in range(50):
        xi, alpha, beta, damping = random.uniform(0.05, [0.6, 3.0, 1.0, 0.5])
        yield random, Mechanism(xi, alpha, beta, sign * beta, damping)


@pytest.mark.parametrize(
    ("turning", "sign"),
    [
        pytest.param(TRUE_TURNING, 1.0, id="phi' - psi' gives +beta (corrected)"),
        pytest.param(
            PUBLISHED_TURNING, -1.0, id="phi' + psi' gives -beta (as published)", marks=pytest.mark.long
        ),
    ],
)
def test_linearised_equation_has_the_kernels_coefficients(turning, sign):
    """a, lambda, c, f of F (2.13), and the two that a varying speed adds, at psi = psi' = 0."""
    left = LEFT[turning]
    resting = [(RATE, 0), (CHANGE, 0)]
    for random, m in mechanisms(sign):
        theta = random.uniform(0.0, 2.0 * np.pi)
        steady, starting = (theta, 0.0, 1.0, 0.0, 0.0, 0.0), (theta, 0.0, 0.0, 0.0, 1.0, 0.0)
        forcing = eq.forcing(theta, m) + m.damping * eq.joint_rate(theta, 1.0, 0.0, m)
        for expression, where, kernel in (
            (sp.diff(left, CHANGE), steady, eq.inertia(m)),
            (sp.diff(left, RATE), steady, m.damping),
            (sp.diff(left.subs(resting), PSI), steady, eq.stiffness(theta, m)),
            (-left, steady, forcing),
            (sp.diff(left.subs(resting), PSI), starting, eq.speed_up_stiffness(theta, m)),
            (-left, starting, eq.speed_up_forcing(theta, m)),
        ):
            assert evaluate(expression, where, m) == pytest.approx(kernel, abs=ROUNDING)


STATES = [(0.3, 1.0, 0.0), (2.1, 1.0, 0.0), (4.4, 0.7, -0.6), (5.9, -1.3, 0.8)]


def residuals(corrected: bool, turning: sp.Expr, size: float, state: Values) -> np.ndarray:
    """What is left of Lagrange's equations of theta and psi with the linear model's psi'' and torque."""
    theta, speed, acceleration = state
    m = eq.thesis_mechanism(0.07, corrected)
    psi, rate = 0.8 * size, -0.6 * size
    change = eq.flight_acceleration(Crank(theta, speed, acceleration), psi, rate, m)
    torque = energetics.crank_torque(Crank(theta, speed, acceleration), psi, rate, change, 0.0, m)
    values = theta, psi, speed, rate, acceleration, change
    left = [evaluate(left_side(kinetic_energy(turning), i), values, m) for i in range(2)]
    return np.array(left) - np.array([torque, 0.0])


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize(("corrected", "turning"), [(True, TRUE_TURNING), (False, PUBLISHED_TURNING)])
def test_motion_and_torque_agree_with_lagrange_to_first_order(corrected, turning, state, record):
    """Exact at psi = 0; the residual falls with psi^2. F's form needs its phi' + psi' for that."""
    at_zero = residuals(corrected, turning, 0.0, state)
    quantity = f"what Lagrange's equations leave at psi = 0, {'corrected' if corrected else 'as published'}"
    record("Slider-crank", quantity, at_zero, 0.0, "energies of the bodies", tolerance=2e-14)
    large, small = (residuals(corrected, turning, size, state) for size in (0.02, 0.01))
    assert np.abs(large).max() > 1e-6
    assert np.abs(large - 4.0 * small).max() < 0.05 * np.abs(large).max()


@pytest.mark.parametrize("state", STATES)
def test_published_form_is_not_the_mechanism(state):
    """With the rod's true rotation phi' - psi' F's equation leaves 2 beta phi''."""
    theta, speed, acceleration = state
    xi = eq.THESIS_XI
    bend = eq.rod_curvature(theta, xi) * speed**2 + eq.rod_slope(theta, xi) * acceleration
    left = residuals(False, TRUE_TURNING, 0.0, state)[1]
    assert left == pytest.approx(-2.0 * eq.THESIS_BETA * bend, abs=10.0 * ROUNDING)
    assert abs(left) > 0.05


def states(random: np.random.Generator) -> Values:
    low, high = [0.0, -0.3, -2.0, -2.0, -2.0, -2.0], [2.0 * np.pi, 0.3, 2.0, 2.0, 2.0, 2.0]
    return tuple(float(v) for v in random.uniform(low, high))


def test_nonlinear_motion_and_energy_are_the_exact_ones_at_any_speed():
    """a psi'' - (free moment) = dT/dpsi's Lagrange equation; a wall's force F has the moment -F dy/dpsi."""
    for random, m in mechanisms():
        values = theta, psi, speed, rate, acceleration, change = states(random)
        moment = nonlinear.free_moment(Crank(theta, speed, acceleration), psi, rate, m)
        left = evaluate(LEFT[TRUE_TURNING], values, m)
        assert eq.inertia(m) * change - moment == pytest.approx(left, abs=10.0 * ROUNDING)
        slope = nonlinear.offset_slope(theta, psi, m.xi)
        assert slope == pytest.approx(evaluate(sp.diff(OFFSET, PSI), values, m), abs=ROUNDING)
        found = nonlinear.kinetic_energy(theta, speed, psi, rate, m)
        assert found == pytest.approx(evaluate(ENERGY, values, m), abs=10.0 * ROUNDING)


def test_nonlinear_torque_is_the_exact_generalised_force():
    """Of theta, with psi'' of a motion on which a wall's force F acts."""
    crank = left_side(ENERGY, 0)
    for random, m in mechanisms():
        theta, psi, speed, rate, acceleration, _ = states(random)
        force = random.uniform(-3.0, 3.0)
        moment = nonlinear.free_moment(Crank(theta, speed, acceleration), psi, rate, m)
        change = (moment - force * nonlinear.offset_slope(theta, psi, m.xi)) / eq.inertia(m)
        values = theta, psi, speed, rate, acceleration, change
        exact = evaluate(crank, values, m) + force * evaluate(sp.diff(OFFSET, THETA), values, m)
        torque = nonlinear.crank_torque(Crank(theta, speed, acceleration), psi, rate, change, force, m)
        assert torque == pytest.approx(exact, abs=20.0 * ROUNDING)


def test_nonlinear_impulse_on_the_crank_is_the_exact_one():
    """A wall's impulse J: dT/dpsi' jumps by J dy/dpsi, dT/dtheta' by J dy/dtheta and the crank's impulse."""
    psi_momentum, crank_momentum = sp.diff(ENERGY, RATE), sp.diff(ENERGY, SPEED)
    for random, m in mechanisms():
        before = states(random)
        jump = random.uniform(-1.0, 1.0)
        after = (*before[:3], before[3] + jump, *before[4:])
        psi_jump = evaluate(psi_momentum, after, m) - evaluate(psi_momentum, before, m)
        crank_jump = evaluate(crank_momentum, after, m) - evaluate(crank_momentum, before, m)
        wall = psi_jump / evaluate(sp.diff(OFFSET, PSI), before, m)
        exact = crank_jump - wall * evaluate(sp.diff(OFFSET, THETA), before, m)
        assert nonlinear.crank_impulse(before[0], before[1], jump, m) == pytest.approx(
            exact, abs=10.0 * ROUNDING
        )


def test_nonlinear_walls_are_lines_along_the_cylinder():
    """y at the wall's psi is the gap; y' = 0 and y'' = 0 with the wall's psi' and psi''."""
    lateral = time_derivative(OFFSET)
    lateral_acceleration = time_derivative(lateral)
    slope = sp.diff(-sp.diff(OFFSET, THETA) * SPEED / sp.diff(OFFSET, PSI), PSI)
    for random, m in mechanisms():
        theta, _, speed, _, acceleration, _ = states(random)
        gap = random.uniform(-0.35, 0.35)
        psi = nonlinear.wall_angle(theta, gap, m.xi)
        rate = nonlinear.wall_rate(theta, speed, psi, m.xi)
        change = nonlinear.wall_acceleration(Crank(theta, speed, acceleration), psi, m.xi)
        values = theta, psi, speed, rate, acceleration, change
        assert evaluate(OFFSET, values, m) == pytest.approx(gap, abs=ROUNDING)
        assert nonlinear.offset(theta, psi, m.xi) == pytest.approx(gap, rel=ROUNDING)
        assert evaluate(lateral, values, m) == pytest.approx(0.0, abs=ROUNDING)
        # Divided by cos eta, which comes down to 0.3 here, more than once.
        assert evaluate(lateral_acceleration, values, m) == pytest.approx(0.0, abs=100.0 * ROUNDING)
        found = nonlinear.wall_rate_slope(theta, speed, psi, m.xi)
        assert found == pytest.approx(evaluate(slope, values, m), rel=1e-12, abs=100.0 * ROUNDING)
