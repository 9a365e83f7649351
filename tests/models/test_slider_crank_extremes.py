"""Motions at the ends of the parameters' ranges: closed forms, an independent integration, finite work."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from models.slider_crank.equations import inertia
from models.slider_crank.flight.flow import UnresolvedError
from models.slider_crank.motions.histories import ONSET
from models.slider_crank.motions.machine import FASTEST, FORMS, Machine, Motion, exponents_of
from models.slider_crank.nonlinear import free_moment, offset

TURN = 2.0 * math.pi


def test_impact_at_the_end_of_a_cell_is_followed_by_the_rest_of_the_revolution() -> None:
    """Without forces the slider crosses at constant speed: an eighth of a turn to the wall, then, at half the
    speed, half a turn to the other one. An eighth of a turn is eight cells."""
    machine = Machine(damping=0.0, gap=0.0625, restitution=0.5, xi=0.0)
    found = Motion(machine, psi_rate=0.0625 / (TURN / 8.0)).events(2)
    at = TURN * found.cycle + found.theta
    np.testing.assert_allclose(at, [TURN / 8.0, TURN * 5.0 / 8.0, TURN * 13.0 / 8.0], rtol=1e-14)
    np.testing.assert_array_equal(found.side, [1.0, -1.0, 1.0])


@pytest.mark.parametrize("rate", [5.0, 1e5])
def test_fast_rod_reaches_the_wall_when_its_free_flight_does(rate: float) -> None:
    """Nonlinear form, wide gap: the rod swings by a third of a radian within a small part of a cell."""
    machine = Machine(form="nonlinear", gap=0.3, restitution=1.0)
    m = machine.mechanism

    def flight(theta: float, state: np.ndarray) -> list[float]:
        return [state[1], free_moment(theta, 1.0, 0.0, state[0], state[1], m) / inertia(m)]

    def reach(theta: float, state: np.ndarray) -> float:
        return offset(theta, state[0], m.xi) - machine.gap

    reach.terminal = True  # type: ignore[attr-defined]
    path = solve_ivp(flight, (0.0, 1.0), [0.0, rate], "DOP853", events=reach, rtol=1e-12, atol=1e-14)
    first = Motion(machine, psi_rate=rate).events(1).where(0)
    assert first.theta == pytest.approx(path.t_events[0][0], rel=1e-11)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("damping", [8.0, 30.0, 200.0])
def test_strong_damping_is_resolved(form: str, damping: float) -> None:
    """A push without a wall in reach: the rate falls as exp(-lambda theta / a) towards that of the joint."""
    machine = Machine(damping=damping, gap=0.05, xi=0.0, form=form)
    rate, scale = -0.01 * damping, damping / inertia(machine.mechanism)
    _, states = Motion(machine, psi_rate=rate).trace(1, 800)
    theta = TURN / 800.0 * np.arange(5)
    expected = theta + (rate - 1.0) * -np.expm1(-scale * theta) / scale
    np.testing.assert_allclose(states[:5, 0], expected, atol=1e-12)


@pytest.mark.parametrize(("xi", "damping"), [(0.01, 0.0), (0.01, 1e-6), (0.1, 30.0), (1e-4, 0.0)])
def test_small_coefficients_are_not_taken_for_unresolved_ones(xi: float, damping: float) -> None:
    """Their rounding is that of the larger ones, and stays what it is with any number of cells."""
    for form in FORMS:
        assert Machine(xi=xi, damping=damping, form=form).flow.pressing.shape[0] <= 512


@pytest.mark.long
def test_damping_that_no_cell_resolves_is_refused() -> None:
    for damping in (1e4, 1e300):
        with pytest.raises(UnresolvedError, match=r"damping = .*less damping"):
            Motion(Machine(damping=damping)).skip(1)


@pytest.mark.parametrize(
    ("psi", "rate", "name"), [*((0.0, v, "psi_rate") for v in (math.nan, -2.0 * FASTEST)), (0.02, 0.0, "psi")]
)
def test_start_out_of_range_is_refused(psi: float, rate: float, name: str) -> None:
    with pytest.raises(ValueError, match=rf"^{name} = "):
        Motion(Machine(gap=0.01), psi, rate)


def test_elastic_bounces_below_rounding_are_sliding() -> None:
    """e = 1: bounces that never get lower would have no end, and friction would make them ever shorter."""
    first = Motion(Machine(restitution=1.0), psi=0.01, psi_rate=1e-18).events(1).where(0)
    assert first.kind == ONSET
    pressed = Motion(Machine(damping=5.0, gap=0.001, restitution=1.0, alpha=0.0, beta=0.0))
    assert pressed.skip(10).strobe(1)[0, 2] == 1.0


def test_plastic_impacts_leave_the_largest_exponent() -> None:
    """e = 0 ends one direction, not both."""
    growths = np.column_stack([np.full(4, 0.5), np.full(4, -math.inf)])
    found = exponents_of(Machine(restitution=0.0), growths, 8, 1)
    assert found.largest == pytest.approx(0.5 / TURN)
    assert found.second == found.exact_sum == -math.inf
