"""Flights, impacts, chatter and sliding of the slider-crank's core."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from models.slider_crank.flight import histories as h
from models.slider_crank.flight.bouncing import (
    CHATTER_LEFT,
    FREE,
    RATE_OF_Y,
    SIDE,
    UPPER_IMPACT,
    Walls,
    phase,
)
from models.slider_crank.flight.bouncing import pass_event as make_transition
from models.slider_crank.flight.linear import carry
from models.slider_crank.machine import Machine
from models.slider_crank.motions.classification import classify
from tests.models.oscillators import flow_of, position_at, scratch

from .table import Row, largest

FLOW = "models/test_flow.py::"
BOUNCING = "models/test_bouncing.py::"
CRANK = "models/test_slider_crank.py::"


def rows() -> Iterator[Row]:
    yield _table()
    yield Row(
        "impacts as bracketed roots; no event is missed at any spacing (grazing and double roots included)",
        "random polynomials: the first root of all; a dip of 1e-13 is found, a miss by 1e-13 is one",
        (
            FLOW + "test_first_root_is_the_smallest_root_of_the_polynomial",
            FLOW + "test_double_root_is_seen_to_rounding",
            BOUNCING + "test_slider_stays_between_the_walls_and_impacts_take_energy",
        ),
    )
    yield _chatter()
    yield Row(
        "sliding starts and releases where the constraint force says, all four sliding regions of F 2.6",
        "400 crank angles, both walls, five (lambda, rho), three forms: slides if and only if pressed, "
        "released at the force's next zero",
        (
            BOUNCING + "test_slider_rests_where_the_constraint_force_presses",
            BOUNCING + "test_sliding_ends_where_the_pressing_acceleration_falls_to_zero",
            BOUNCING + "test_wall_that_is_pressed_all_the_time_is_never_left",
        ),
    )
    exact, coarse = (classify(_thesis(0.05, 0.02, threshold), 20_000) for threshold in (0.0, 0.005))
    yield Row(
        "the thesis's own rule (0.005) stays available to show its effect",
        f"(.05, .02): without it {exact.kind}; with it in the end a period of {coarse.period} turns that is "
        "not there in its limit",
        (BOUNCING + "test_threshold_of_the_thesis_ends_bounces_early",),
    )


def _thesis(damping: float, gap: float, threshold: float = 0.0) -> Machine:
    return Machine(damping, gap, form="as_published", sliding_threshold=threshold)


def _table() -> Row:
    errors = []
    for xi in (0.0, 0.303, 0.8):
        machine = Machine(0.3, xi=xi)
        flow, v = machine.flow, np.eye(2)
        end = position_at(flow, 0.0, 0.0, 0.0)
        end[0] = flow.cells.shape[0]
        carry(flow, position_at(flow, 0.0, 0.0, 0.0), end, v, scratch())
        inertia = machine.alpha / 4.0 + 1.0 + machine.beta
        errors.append(np.linalg.det(v) / math.exp(-2.0 * math.pi * 0.3 / inertia) - 1.0)
    return Row(
        "free flight by its exact periodic linear flow, tabulated per parameter set to machine precision",
        f"determinant over a revolution against exp(-2 pi lambda/a), xi = 0, .303, .8: {largest(errors)} "
        "relative; against DOP853 to that method's error",
        (
            FLOW + "test_determinant_over_a_revolution_is_that_of_the_damping",
            FLOW + "test_flow_is_that_of_the_equation_of_motion",
            FLOW + "test_constant_coefficients_give_elementary_functions",
        ),
    )


def _chatter() -> Row:
    g, v, e, start = 0.7, 0.05, 0.9, 0.1
    flow, walls = flow_of(lambda x: np.full_like(x, g)), Walls(0.0, 10.0, e, 0.0)
    position, bounces = position_at(flow, start, 0.0, -v), 0
    while position[SIDE] == FREE:
        h.LINEAR.next_event(flow, walls, position, flow.cells.shape[0] - 1, 1.0, scratch())
        rate = position[RATE_OF_Y]
        make_transition(flow, walls, position, UPPER_IMPACT)
        bounces += 1
    limit = phase(flow, position) + 2.0 * e * rate / (g * (1.0 - e))
    error = limit - (start + 2.0 * v / (g * (1.0 - e)))
    return Row(
        "chattering is carried to its limit point in finite work",
        f"bouncing ball, e = .9: limit point to {abs(error):.0e} rad after {bounces} bounces, the rest being "
        f"shorter than {CHATTER_LEFT:g} rad",
        (
            BOUNCING + "test_bouncing_ball_comes_to_rest_after_its_geometric_series",
            FLOW + "test_bounce_of_any_height_has_its_duration_to_relative_accuracy",
        ),
    )
