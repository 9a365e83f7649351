"""Motions and equations that Farahanchi (F) prints: exponents, the component's run, portraits."""

import math
from functools import cache

import numpy as np
import pytest

from models.core.quantities import Vector
from models.slider_crank import equations as eq
from models.slider_crank.equations import Crank
from models.slider_crank.forms import wall_rate
from models.slider_crank.motions.classification import CHAOTIC, TRANSIENT_CHAOS, classify
from models.slider_crank.motions.machine import FORMS, Machine, Motion
from models.slider_crank.motions.portrait import Portrait, trace_portrait
from models.slider_crank.motions.transients import Transients, draw_starts, measure_transients

from .slider_cranks import CRANK, STATE, TURN, thesis_parameters, turn

COUNTS = [STATE.index(f"{wall}_impact_count") for wall in ("upper", "lower")]


def published(damping: float, gap: float, threshold: float = 0.0) -> Machine:
    return Machine(damping=damping, gap=gap, form="as_published", sliding_threshold=threshold)


def cycles(p: Vector, count: int) -> Vector:
    """The component's states at crank angle zero over `count` revolutions."""
    x, states = STATE.vector(), []
    for _ in range(count):
        # Every revolution at time zero: the motion is periodic, and time keeps its resolution.
        turn(CRANK, x, p, 0.0, TURN)
        states.append(x.copy())
    return np.array(states)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(
    ("damping", "count", "tolerance"), [(0.05, 4, 1e-10), (0.25, 60, 1e-12)], ids=["chaos", "slides"]
)
def test_component_moves_as_the_machine(form: str, damping: float, count: int, tolerance: float) -> None:
    """Rounding of 1e-16 grows by e^(0.42 * 25) = 4e4 in four revolutions of chaos; a slide forgets it."""
    gap = 0.01 if damping == 0.05 else 0.015
    states = cycles(thesis_parameters(damping, gap, form=float(FORMS.index(form))), count)
    expected = Motion(Machine(damping, gap, form=form)).strobe(count)
    np.testing.assert_allclose(states[:, :3], expected, atol=tolerance)


EXPONENTS = [(0.05, 0.01, 0.414), (0.025, 0.02, 0.387), (0.05, 0.015, -0.147), (0.075, 0.02, 0.333)]


@pytest.mark.parametrize(("damping", "gap", "reference"), EXPONENTS)
def test_lyapunov_exponents(damping: float, gap: float, reference: float, record) -> None:
    """The largest within the references' 2 % and four standard errors; their sum exactly."""
    found = Motion(published(damping, gap)).skip(200).exponents(5000)
    quantity, total = "sum of both Lyapunov exponents (1/rad)", found.largest + found.second
    record("Slider-crank", quantity, total, found.exact_sum, "-λ/a + 2 N ln e/(2π)", tolerance=1e-11)
    assert found.largest == pytest.approx(reference, abs=0.02 * abs(reference) + 4.0 * found.uncertainty)


def test_periodic_orbit_has_half_the_sum() -> None:
    """(0.05, 0.015): its multipliers are complex, so both exponents are half of the exact sum."""
    found = Motion(published(0.05, 0.015)).skip(200).exponents(1000)
    assert found.impacts_per_cycle == 8.0
    assert found.largest == pytest.approx(0.5 * found.exact_sum, rel=0.01)


@pytest.mark.parametrize(("form", "cycles_before"), [("as_published", 0), ("corrected", 10)])
def test_sliding_motion_has_no_exponents(form: str, cycles_before: int) -> None:
    """Every deviation ends at a release from rest at a fixed crank angle, and on a wall that holds for good
    (corrected; F 2.6, region III)."""
    found = Motion(Machine(0.25, 0.015, form=form)).skip(cycles_before).exponents(40)
    assert (found.largest, found.second) == (-math.inf, -math.inf)
    assert (found.impacts_per_cycle == 0.0) == (form == "corrected")


def test_impacts_per_revolution_of_the_periodic_orbit(record) -> None:
    """(0.05, 0.015): three on the upper wall and five on the lower."""
    states = cycles(thesis_parameters(0.05, 0.015), 400)
    np.testing.assert_allclose(states[-50:, :2], states[-51:-1, :2], atol=1e-8)
    last = states[-1] - states[-2]
    for wall, count, stated in zip(("upper", "lower"), last[COUNTS], (3, 5), strict=True):
        quantity = f"impacts on the {wall} wall per revolution, λ = 0.05, ρ = 0.015"
        record("Slider-crank", quantity, count, stated, "independent integration", tolerance=0)


def find_transients(machine: Machine, cycles: int) -> Transients:
    """Transients from 24 random starts."""
    return measure_transients(machine, draw_starts(machine, 24, seed=1), cycles)


def test_chaos_that_ends() -> None:
    # Mean escape 115 cycles: 5000 are passed by none.
    found = find_transients(published(0.025, 0.015), 5000)
    assert found.settled.all()
    assert 3 in found.periods
    assert found.lengths.max() > 60


def test_the_threshold_of_the_thesis_ends_chaos_that_goes_on() -> None:
    """F's rule, sliding below a rebound of 0.005, leads to orbits that the exact motion does not have."""
    # 24 starts, each of which slides, released from one of two states, within some 100 cycles.
    assert find_transients(published(0.05, 0.02, 0.005), 20_000).settled.all()
    assert classify(published(0.05, 0.02, 0.005), 20_000).kind == TRANSIENT_CHAOS
    assert classify(published(0.05, 0.02), 5000).kind == CHAOTIC


CYCLES, POINTS = 3, 200
# psi, psi' and the walls' come from the same formulas; rounding of angles of 10 cycles.
ROUNDING = 1e-13


@cache
def draw_portrait(form: str) -> tuple[Machine, Portrait]:
    machine = Machine(0.05, 0.015, form=form)
    return machine, trace_portrait(Motion(machine).skip(10), CYCLES, POINTS)


def find_impacts(found: Portrait) -> np.ndarray:
    """Places of the second of both points of an impact."""
    return np.flatnonzero(np.diff(found.theta) == 0.0) + 1


@pytest.mark.parametrize("form", FORMS)
def test_portrait_is_the_trace_with_impacts(form: str) -> None:
    """Without the points of impacts it is `Motion.trace`, to the last bit, and ends where that ends."""
    machine, found = draw_portrait(form)
    motion, twin = Motion(machine).skip(10), Motion(machine).skip(10)
    theta, states = motion.trace(CYCLES, POINTS)
    trace_portrait(twin, CYCLES, POINTS)
    kept = np.ones(found.theta.size, dtype=bool)
    for second in find_impacts(found):
        kept[second - 1 : second + 1] = False
    np.testing.assert_array_equal(found.theta[kept], theta)
    np.testing.assert_array_equal(found.psi[kept], states[:, 0])
    np.testing.assert_array_equal(found.psi_rate[kept], states[:, 1])
    np.testing.assert_array_equal(twin.strobe(1), motion.strobe(1))


@pytest.mark.parametrize("form", FORMS)
def test_impacts_are_at_the_walls_and_reverse_the_relative_rate(form: str) -> None:
    """F (2.16), (2.17): psi' - psi'_wall is multiplied by -e; where sliding begins it ends."""
    machine, found = draw_portrait(form)
    assert np.all(np.diff(found.theta) >= 0.0)
    assert np.all(found.psi <= found.upper + ROUNDING)
    assert np.all(found.psi >= found.lower - ROUNDING)
    index, m = float(FORMS.index(form)), machine.mechanism
    impacts = find_impacts(found)
    assert impacts.size > 5
    for i in impacts:
        wall = found.upper[i] if found.psi[i] > 0.0 else found.lower[i]
        assert found.psi[i] == found.psi[i - 1] == pytest.approx(wall, abs=ROUNDING)
        rate = wall_rate(index, found.theta[i], 1.0, found.psi[i], m)
        before, after = found.psi_rate[i - 1] - rate, found.psi_rate[i] - rate
        assert before * np.sign(wall) > 0.0
        left = 0.0 if found.side[i] != 0.0 else machine.restitution
        assert after == pytest.approx(-left * before, abs=ROUNDING)


XI, ALPHA, BETA = eq.THESIS_XI, eq.THESIS_ALPHA, eq.THESIS_BETA
LAMBDA = 0.07


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_constant_speed_form_is_f_2_13(sign: float, record) -> None:
    """a, c and f as F prints them (with -beta), and with +beta."""
    m = eq.thesis_mechanism(LAMBDA, corrected=sign > 0.0)
    tau, psi, rate = 1.234, 0.01, -0.02
    big = math.sqrt(1.0 - XI**2 * math.sin(tau) ** 2)
    c = (1 + ALPHA / 2) * XI * big * math.cos(tau) - (1 + ALPHA / 2) * XI**2 * math.sin(tau) ** 2
    f = (
        (ALPHA / 4 + 1 + sign * BETA) * (XI**3 - XI) * math.sin(tau) / big**3
        + (XI * big + ALPHA / 2 * XI * big) * math.sin(tau)
        + (XI**2 / 2 + XI**2 * ALPHA / 4) * math.sin(2 * tau)
        + LAMBDA
        + LAMBDA * XI * math.cos(tau) / big
    )
    a = ALPHA / 4 + 1 + BETA
    expected = (f - c * psi - LAMBDA * rate) / a
    found = eq.flight_acceleration(Crank(tau, 1.0, 0.0), psi, rate, m)
    quantity = "acceleration of the rod at constant speed"
    record("Slider-crank", quantity, found, expected, "Farahanchi (1991), (2.13)", relative=1e-14)
