"""What components tell masters: when the next event comes, that one has happened, where a mode changes."""

import math
from dataclasses import replace

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.core.component import NO_EVENT
from models.monolithic import equilibrium, solve
from models.slider_crank.motions.histories import LIFT
from models.slider_crank.motions.machine import Machine, Motion
from models.valve_train.cams.law import law_lift
from models.valve_train.cams.profile import REACHED

from .slider_cranks import CRANK, DRIVEN, STATE, advance, thesis_parameters, turn
from .systems import column, outputs_of, valve_train

CAMSHAFT, FLYWHEEL = CATALOGUE["camshaft"](), CATALOGUE["flywheel"]()
PROFILE = CAMSHAFT.parameters.view(CAMSHAFT.parameters.start)
NARROW, WIDE = PROFILE.dwell_half_width, PROFILE.dwell_half_width + PROFILE.rise_angle
BREAKS = [math.pi - WIDE, math.pi - NARROW, math.pi + NARROW, math.pi + WIDE]
TURN = 2.0 * math.pi


def next_event(angle, speed, acceleration=0.0, t=0.0, **parameters):
    drive = {"drive_angle": angle, "drive_speed": speed, "drive_acceleration": acceleration}
    return outputs_of(CAMSHAFT, parameters, inputs=drive, t=t)["next_event"]


def test_events_are_told_by_outputs():
    with pytest.raises(ValueError, match="flywheel: output 'absent', for events or a role, must be one of"):
        replace(FLYWHEEL, event_indicators=("absent",))


def jump_of_third_derivative(angle):
    """s'''(angle+) - s'''(angle-), by differences of s'', over its largest value S w^2 / B."""
    h = 1e-4

    def bend(a):
        return law_lift(a, PROFILE).dds

    after, before = (bend(angle + h) - bend(angle)) / h, (bend(angle) - bend(angle - h)) / h
    return (after - before) / (PROFILE.lift / PROFILE.rise_angle * (TURN / PROFILE.rise_angle) ** 2)


def test_the_cam_tells_the_angles_where_its_jerk_jumps_and_no_others():
    told = [next_event(angle - 1e-6, 1.0) + angle - 1e-6 for angle in BREAKS]
    np.testing.assert_allclose(told, BREAKS, atol=1e-14)
    for angle in BREAKS:
        assert abs(jump_of_third_derivative(angle)) == pytest.approx(1.0, abs=1e-3)
    # Elsewhere s'''' h, w^2 h... of a smooth function: 4 h = 4e-4.
    others = [a for a in np.linspace(0.0, TURN, 1000) if min(abs(a - b) for b in BREAKS) > 2e-4]
    assert max(abs(jump_of_third_derivative(a)) for a in others) < 1e-3


def test_cam_at_constant_speed_reaches_its_breaks_at_angle_over_speed():
    """Walking from event to event gives each break of each turn once, in the order of time."""
    speed, ratio, phase, t, told = 104.7, 0.5, 0.3, 0.0, []
    while len(told) < 400:
        t = next_event(speed * t, speed, t=t, drive_ratio=ratio, phase=phase)
        told.append(t)
    first = [a - phase for a in BREAKS]
    expected = [(a + TURN * n) / (ratio * speed) for n in range(100) for a in first]
    # Rounding of an angle of a hundred turns.
    np.testing.assert_allclose(told, expected, rtol=1e-13)


@pytest.mark.parametrize("angle", BREAKS)
def test_a_break_just_reached_is_not_told_again(angle):
    """Also where rounding, or a master's step, ends a little before it."""
    following = next(b for b in [*BREAKS, BREAKS[0] + TURN] if b > angle)
    for short in (0.0, 1e-15, -1e-15, 0.9 * REACHED):
        assert next_event(angle - short, 50.0) * 50.0 == pytest.approx(following - angle, abs=2.0 * REACHED)
    assert next_event(angle - 2.0 * REACHED, 50.0) * 50.0 == pytest.approx(2.0 * REACHED, rel=1e-6)


def test_accelerating_cam():
    """w t + a t^2/2 = angle: forwards, and turning back before the break."""
    angle = BREAKS[0] - 0.1
    forwards = (-20.0 + math.sqrt(20.0**2 + 2.0 * 3e3 * 0.1)) / 3e3
    assert next_event(angle, 20.0, 3e3, t=2.0) == pytest.approx(2.0 + forwards, rel=1e-13)
    # Forwards it gets to 20^2/(2 a) = 0.02 rad; back to the last break of the fall before.
    back = angle - (BREAKS[3] - TURN)
    backwards = (20.0 + math.sqrt(20.0**2 + 2.0 * 1e4 * back)) / 1e4
    assert next_event(angle, 20.0, -1e4) == pytest.approx(backwards, rel=1e-13)
    assert next_event(angle, -20.0) == pytest.approx(back / 20.0, rel=1e-13)
    assert next_event(1.0, 0.0) == NO_EVENT
    from_rest = math.sqrt(2.0 * 0.1 / 3e3)
    assert next_event(angle, 0.0, 3e3) == pytest.approx(from_rest, rel=1e-13)


def test_cam_without_dwell_has_one_break_at_its_nose():
    nose = next_event(3.0, 1.0, dwell_half_width=0.0)
    assert nose == pytest.approx(math.pi - 3.0, rel=1e-14)
    after = next_event(math.pi, 1.0, dwell_half_width=0.0)
    assert after == pytest.approx(PROFILE.rise_angle, rel=1e-14)


@pytest.mark.parametrize("i", [1, 3], ids=["end of rise", "end of fall"])
def test_flexible_cam_tells_its_event_with_the_twist(i):
    """Within a radian of torsion the error is less than that of a harmonic twist's third derivative.

    The times at which the cam is at the break are those of the monolithic solution.
    """
    omega = 3000.0 * math.pi / 30.0
    torsion = math.sqrt(207e9 / 2.6 * math.pi * 0.02**4 / 32.0 / 0.1 / 3.0e-4)
    system = valve_train(3000.0, camshaft={"flexible": 1.0})
    times = np.concatenate([[0.0], np.linspace(-4e-4, 4e-4, 801) + BREAKS[i] / omega])
    found = solve(system, times, x0=equilibrium(system))
    twist = found.state[1:, system.state.names.index("camshaft.twist")]
    angle, told = (column(system, found.outputs, f"camshaft.{n}")[1:] for n in ("cam_angle", "next_event"))
    crossing = np.interp(BREAKS[i], angle, times[1:])
    largest = np.max(np.abs(twist)) / omega
    for lead in (1.5e-4, 8e-5, 4e-5):
        error = abs(told[np.searchsorted(times[1:], crossing - lead)] - crossing)
        assert error < (torsion * lead) ** 3 / 6.0 * largest
    # The wind-up makes the cam early; without it the error would be larger by far.
    if i == 1:
        assert abs(BREAKS[i] / omega - crossing) > 100.0 * error


def test_flywheel_tells_both_ends_of_its_ramp():
    ramp = {"final_speed": 7.0, "ramp_start": 0.3, "ramp_duration": 0.2}

    def at(t, **more):
        return outputs_of(FLYWHEEL, {**ramp, **more}, t=t)["next_event"]

    assert [at(0.0), at(0.2999), at(0.3), at(0.3 - 1e-12), at(0.4)] == [0.3, 0.3, 0.5, 0.5, 0.5]
    assert [at(0.5), at(0.5 - 1e-12), at(3.0)] == [NO_EVENT] * 3
    assert at(0.0, motion=0.0) == NO_EVENT
    assert at(0.0, initial_speed=7.0) == NO_EVENT


def test_contact_is_loaded_exactly_where_both_indicators_are_positive():
    contact, random = CATALOGUE["ehl_contact"](), np.random.default_rng(5)
    assert contact.event_indicators == ("deflection", "damping_margin")
    seen = set()
    for overlap, rate in random.uniform(-1.0, 1.0, (400, 2)) * (4e-6, 1.5):
        y = outputs_of(
            contact, inputs={"approach": overlap, "approach_rate": rate, "entraining_velocity": 1.0}
        )
        signs = tuple(y[name] > 0.0 for name in contact.event_indicators)
        assert (y["load"] > 0.0) == all(signs)
        seen.add(signs)
    assert seen == {(a, b) for a in (False, True) for b in (False, True)}


# F's engine where the slider lands on its walls, slides and is released.
SLIDING = {"damping": 0.05, "gap": 0.015, "restitution": 0.1}


@pytest.mark.parametrize("exactly", [True, False], ids=["exact flight", "integrated"])
def test_slider_crank_counts_impacts_and_releases_with_their_times(exactly):
    """Those of the dimensionless machine's list of events, which is kept by other code."""
    events = Motion(Machine(form="nonlinear", **SLIDING)).events(3)
    when = TURN * events.cycle + events.theta
    p = thesis_parameters(SLIDING["damping"], SLIDING["gap"], restitution=0.1, form=2.0)
    # An acceleration that is not zero sends the step to the integrator, and moves nothing.
    constant = {} if exactly else {"crank_acceleration": 1e-300}
    x, t, h, releases = STATE.vector(), 0.0, 0.07, []
    while t < 3.0 * TURN - h:
        y = turn(CRANK, x, p, t, h, **constant)
        t += h
        # How many bounces end a chatter depends on rounding; releases do not.
        releases.append(y["event_count"] - y["impact_count"])
        assert releases[-1] == np.count_nonzero((events.kind == LIFT) & (when <= t))
        if y["event_count"]:
            # What is left of a chatter takes some 1e-7 rad.
            assert y["last_event_time"] == pytest.approx(when[when <= t][-1], abs=1e-6)
    assert releases[-1] >= 3
    assert y["impact_count"] >= 20


def test_a_pistons_release_is_an_event_and_no_impact():
    """Pressed to the lower wall by gravity, then pulled off: one release, at the time of the pull."""
    lower = [DRIVEN.state.index(f"closed[{i}]") for i in (3, 4)]
    clearance = 40e-6
    p = DRIVEN.parameters.vector({"clearance": clearance, "gravity_across": -9.81})
    x = DRIVEN.state.vector({"offset": -clearance})
    x[lower] = 1.0
    y = advance(DRIVEN, x, p, 0.0, 1e-3)
    assert y["event_count"] == 0.0
    q = DRIVEN.parameters.vector({"clearance": clearance, "gravity_across": +9.81})
    y = advance(DRIVEN, x, q, 1e-3, 1e-4)
    assert y["event_count"] >= 1.0
    assert y["impact_count"] == 0.0
    assert y["last_event_time"] == 1e-3
    assert not x[lower].any()
