"""Motions between walls: impacts, power series and the tabulated flow."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from models.slider_crank.flight.bouncing import (
    CELL,
    CHATTER_LEFT,
    END,
    FRACTION,
    LOWER,
    RATE_OF_Y,
    RELEASE,
    SIDE,
    UPPER,
    UPPER_IMPACT,
    Walls,
    Y,
    pass_event,
    phase,
)
from models.slider_crank.flight.linear import carry, kick
from models.slider_crank.flight.samples import offset_acceleration
from models.slider_crank.flight.series import NEVER, TERMS, bounds_of_bend, divide_by_u, first_fall, next_fall
from models.slider_crank.motions import histories as h
from models.slider_crank.motions.histories import apply_saltation
from models.slider_crank.motions.machine import FORMS, Machine, Motion
from models.slider_crank.motions.regions import wall_forces

from .oscillators import flow_of, impact_oscillator, impact_oscillator_orbit, position_at, scratch

TURN = 2.0 * math.pi


def next_impact(flow, walls, position) -> None:
    """Fly to the next impact, across the end of a revolution."""
    last = flow.cells.shape[0] - 1
    while h.LINEAR.next_event(flow, walls, position, last, 1.0, scratch()) == END:
        h.begin_cycle(position)


@pytest.mark.parametrize(
    ("omega", "r", "sigma", "sign"),
    [(2.8, 0.8, 0.0, -1.0), (2.8, 0.8, 0.05, -1.0), (3.3, 0.5, 0.02, -1.0), (1.7, 0.7, 0.0, 1.0)],
)
def test_impact_oscillator_returns_to_its_orbit(omega, r, sigma, sign, record):
    orbit = impact_oscillator_orbit(omega, r, sigma, sign)
    assert orbit.velocity > 0.0
    flow, walls = impact_oscillator(omega, r, sigma)
    position = position_at(flow, orbit.phase, sigma, -r * orbit.velocity / omega)
    next_impact(flow, walls, position)
    for name, value, exact in (
        ("phase (rad)", phase(flow, position), orbit.phase),
        ("velocity", omega * position[RATE_OF_Y], orbit.velocity),
    ):
        quantity = f"impact oscillator: {name} of the one-impact orbit"
        record("Slider-crank", quantity, value, exact, "closed form", tolerance=1e-11)


def test_multipliers_of_the_impact_oscillator(record):
    """Trace and determinant r^2 of the tangent map over one orbit, impact included."""
    omega, r = 2.8, 0.8
    orbit = impact_oscillator_orbit(omega, r, 0.0, -1.0)
    flow, walls = impact_oscillator(omega, r, 0.0)
    start = position_at(flow, orbit.phase, 0.0, -r * orbit.velocity / omega)
    v, position = np.eye(2), start.copy()
    last = flow.cells.shape[0] - 1
    assert h.LINEAR.next_event(flow, walls, position, last, 1.0, scratch()) == END
    carry(flow, start, position, v, scratch())
    h.begin_cycle(position)
    start = position.copy()
    assert h.LINEAR.next_event(flow, walls, position, last, 1.0, scratch()) == UPPER_IMPACT
    carry(flow, start, position, v, scratch())
    apply_saltation(r, kick(flow, walls, position, UPPER), position[RATE_OF_Y], v)
    for name, value, exact, tolerance in (
        ("trace", np.trace(v), orbit.trace, 1e-10),
        ("determinant", np.linalg.det(v), r**2, 1e-12),
    ):
        quantity = f"impact oscillator: {name} of the tangent map"
        record("Slider-crank", quantity, value, exact, "closed form", tolerance=tolerance)


@pytest.mark.parametrize("e", [0.3, 0.9, 0.99])
def test_bouncing_ball_comes_to_rest_after_its_geometric_series(e, record):
    """Bounce n lasts 2 v e^n / g; the sum to infinity is 2 v e / (g (1 - e))."""
    g, v = 0.7, 0.5 * (1.0 - e)
    flow, walls = flow_of(lambda x: np.full_like(x, g)), Walls(0.0, 10.0, e, 0.0)
    position, last = position_at(flow, 0.1, 0.0, -v), flow.cells.shape[0] - 1
    start, n = 0.1, 0
    while position[SIDE] == 0.0:
        code = h.LINEAR.next_event(flow, walls, position, last, 1.0, scratch())
        assert code == UPPER_IMPACT
        assert position[RATE_OF_Y] == pytest.approx(v * e**n, rel=1e-11)
        # Angles of size 2 are known to 4e-16; so are their differences.
        assert phase(flow, position) - start == pytest.approx(2.0 * v * e**n / g, abs=2e-15)
        start = phase(flow, position)
        pass_event(flow, walls, position, code)
        n += 1
    left = 2.0 * v * e**n / (g * (1.0 - e))
    assert left <= CHATTER_LEFT
    exact = 0.1 + 2.0 * v / (g * (1.0 - e))
    quantity = "bouncing ball: end of chatter (rad)"
    record("Slider-crank", quantity, start + left, exact, "series", tolerance=1e-13)


def release_from_rest(machine: Machine, side: float, theta: float) -> tuple[float, float]:
    """(sliding side just after, crank angle of the release or nan) of a slider put to rest on a wall."""
    flow, walls = machine.flow, machine.walls
    cells = flow.pressing.shape[0]
    place = theta * cells / TURN
    position = np.array([int(place), place - int(place), side * machine.gap, 0.0, 0.0])
    next_event = machine.histories.next_event
    k = int(position[CELL])
    while (code := next_event(flow, walls, position, k, position[FRACTION] + 1e-9, scratch())) != END:
        pass_event(flow, walls, position, code)
    slides = position[SIDE]
    if slides != side:
        return slides, math.nan
    code = next_event(flow, walls, position, cells - 1, 1.0, scratch())
    return slides, phase(flow, position) if code == RELEASE else math.nan


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(("damping", "gap"), [(0.1, 0.01), (0.267, 0.02), (0.0, 0.02)])
def test_slider_rests_where_the_constraint_force_presses(form, damping, gap):
    """In all four kinds of region (upper only, lower only, both, neither) it slides where the force of F
    2.6 says, and is released at that force's next zero."""
    machine = Machine(damping, gap, form=form)
    angles = np.linspace(0.003, 6.27, 400)
    forces = {side: wall_forces(machine, side, angles) for side in (UPPER, LOWER)}
    kinds = set()
    for theta, *both in zip(angles, forces[UPPER] > 0.0, forces[LOWER] > 0.0, strict=True):
        kinds.add(tuple(both))
        for side, holds in zip((UPPER, LOWER), both, strict=True):
            slides, released = release_from_rest(machine, side, theta)
            assert slides == (side if holds else 0.0)
            if math.isfinite(released):
                between = wall_forces(machine, side, np.linspace(theta, released, 50)[1:])
                assert abs(between[-1]) < 1e-11
                assert between[:-1].min() > 0.0
    if (form, damping, gap) == ("as_published", 0.267, 0.02):
        assert kinds == {(True, False), (True, True)}
    if damping == 0.1:
        assert (True, False) in kinds
        assert (False, True) in kinds


@pytest.mark.parametrize("form", FORMS)
def test_cutting_a_flight_changes_no_impact(form, record):
    """Events over two chaotic revolutions, run in one piece and in 500: 1e-12 grows by e^(0.4 * 12)."""
    machine = Machine(0.05, 0.01, form=form)
    whole = Motion(machine).events(2)
    position, found = np.zeros(5), []
    flow, walls = machine.flow, machine.walls
    cells = flow.pressing.shape[0]
    cuts = np.sort(np.random.default_rng(4).uniform(0.0, cells, 250))
    for cycle in range(2):
        for place in [*cuts, float(cells)]:
            k = min(int(place), cells - 1)
            code = 1
            while code != END:
                code = machine.histories.next_event(flow, walls, position, k, place - k, scratch())
                if code != END:
                    found.append(TURN * cycle + phase(flow, position))
                    pass_event(flow, walls, position, code)
        h.begin_cycle(position)
    quantity = "impacts of two chaotic revolutions cut into 500 pieces (rad)"
    angles = TURN * whole.cycle + whole.theta
    record("Slider-crank", quantity, found, angles, "uncut motion", tolerance=1e-11)


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("start", [0.0, 0.01])
def test_tangent_vectors_are_the_derivative_of_the_motion(form, start):
    """Central differences of the state after a revolution with impacts, to their own error."""
    machine = Machine(0.05, 0.012, form=form)
    growth, v, position = np.zeros(7), np.eye(2), np.zeros(5)
    position[RATE_OF_Y] = start
    impacts = machine.histories.follow_tangents(
        machine.flow, machine.walls, position, v, 1, growth, scratch()
    )
    assert impacts > 2
    d = 1e-8
    ends = np.zeros((2, 2, 2))
    for column in range(2):
        for side, sign in enumerate((-1.0, 1.0)):
            at = np.zeros(5)
            at[RATE_OF_Y] = start
            at[Y + column] += sign * d
            states = np.zeros((1, h.STATE_SIZE))
            machine.histories.strobe(machine.flow, machine.walls, at, states, scratch())
            ends[column, side] = states[0, :2]
    map_ = (ends[:, 1] - ends[:, 0]) / (2.0 * d)
    # The growth of the first vector and of the area: what Gram and Schmidt leave.
    assert growth[0] == pytest.approx(math.log(np.linalg.norm(map_[0])), abs=1e-5)
    area = math.log(abs(np.linalg.det(map_)))
    # The difference's error of some 1e-6 counts in the area by the condition of the map.
    assert growth[0] + growth[1] == pytest.approx(area, abs=1e-6 * np.linalg.cond(map_))


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ({"restitution": 1.1}, "at most 1"),
        ({"gap": -0.01}, "not negative"),
        ({"damping": -1.0}, "not negative"),
        ({"xi": 1.0}, "less than 1"),
        ({"gap": 0.2}, "0.1 rad"),
        ({"gap": 0.8, "form": "nonlinear"}, "turns over"),
        ({"form": "linear"}, "as_published, corrected, nonlinear"),
        ({"damping": math.nan}, "finite"),
    ],
)
def test_machine_out_of_range_is_refused(values, text):
    with pytest.raises(ValueError, match=text):
        Machine(**values)


COEFFICIENT = st.integers(-50, 50).map(lambda n: n / 50.0)


def series_of(*coefficients: float) -> np.ndarray:
    c = np.zeros(TERMS)
    c[: len(coefficients)] = coefficients
    return c


def fall(c: np.ndarray, length: float = 1.0) -> float:
    return first_fall(c, -1.0, 0.0, bounds_of_bend(c, length)[0], length)


@settings(max_examples=300, deadline=None, derandomize=True)
@given(st.lists(COEFFICIENT, min_size=3, max_size=7), st.floats(0.05, 1.0))
def test_first_root_is_the_smallest_root_of_the_polynomial(rest: list[float], length: float) -> None:
    c = series_of(0.3, *rest)
    roots = np.roots(c[::-1][np.argmax(c[::-1] != 0.0) :])
    # A double root is only found by numpy to the square root of rounding: leave close pairs to the next test.
    real = np.sort(roots[(np.abs(roots.imag) < 1e-6)].real)
    assume(all(abs(a - b) > 1e-3 for a, b in zip(roots, np.roll(roots, 1), strict=True) if len(roots) > 1))
    inside = real[(real >= 0.0) & (real <= length)]
    assume(not len(real) or np.abs(real - length).min() > 1e-6)
    found = fall(c, length)
    if len(inside):
        assert found == pytest.approx(inside[0], abs=1e-9)
    else:
        assert found == NEVER


@pytest.mark.parametrize("place", [0.123, 0.5, 0.987])
def test_double_root_is_seen_to_rounding(place: float) -> None:
    """(u - place)^2 + depth: a miss by 1e-13 is a miss, a dip of 1e-13 is found at its near side."""
    for depth in (1e-3, 1e-8, 1e-13):
        touching = series_of(place**2, -2.0 * place, 1.0)
        touching[0] += depth
        assert fall(touching) == NEVER
        touching[0] -= 2.0 * depth
        assert fall(touching) == pytest.approx(place - math.sqrt(depth), abs=2e-16 / math.sqrt(depth) + 1e-15)


@pytest.mark.parametrize("height", [1e-3, 1e-9, 1e-30])
def test_bounce_of_any_height_has_its_duration_to_relative_accuracy(height: float) -> None:
    """y = height u - u^2 / 2 returns after 2 height."""
    quotient = np.zeros(TERMS)
    divide_by_u(series_of(0.7, -height, 0.5), 1.0, quotient)
    assert next_fall(quotient, 1.0) == pytest.approx(2.0 * height, rel=1e-14)


@pytest.mark.parametrize("form", ["as_published", "corrected"])
@pytest.mark.parametrize("xi", [0.0, 0.303, 0.8])
def test_determinant_over_a_revolution_is_that_of_the_damping(form: str, xi: float, record) -> None:
    """Liouville: exp(-2 pi lambda / a), to rounding accumulated over the cells."""
    machine = Machine(0.3, form=form, xi=xi)
    flow, v = machine.flow, np.eye(2)
    end = position_at(flow, 0.0, 0.0, 0.0)
    end[0] = flow.cells.shape[0]
    carry(flow, position_at(flow, 0.0, 0.0, 0.0), end, v, scratch())
    inertia = machine.alpha / 4.0 + 1.0 + machine.beta
    exact, source = math.exp(-2.0 * math.pi * 0.3 / inertia), "exp(-2πλ/a) (Liouville)"
    quantity = "determinant of the flow over a revolution"
    record("Slider-crank", quantity, np.linalg.det(v), exact, source, relative=5e-13)


@pytest.mark.parametrize("xi", [0.303, 0.9])
def test_flow_is_that_of_the_equation_of_motion(xi: float, record) -> None:
    """Against DOP853 at its tightest, over one revolution."""
    machine = Machine(0.1, xi=xi)
    m, flow = machine.mechanism, machine.flow
    solved = solve_ivp(
        lambda theta, x: [x[1], offset_acceleration(theta, x[0], x[1], m)],
        (0.0, 2.0 * math.pi), [0.01, -0.02], method="DOP853", rtol=1e-13, atol=1e-16,
    )  # fmt: skip
    state = np.array([0.01, -0.02])
    for ends in flow.ends:
        state = ends[0] + state[0] * ends[1] + state[1] * ends[2]
    # DOP853's own error: 1e-13 a step, some hundred steps.
    difference = (state - solved.y[:, -1]) / np.abs(solved.y).max()
    quantity = "error of the free flight over a revolution, relative"
    record("Slider-crank", quantity, difference, 0.0, "DOP853 at 1e-13", tolerance=2e-11)
