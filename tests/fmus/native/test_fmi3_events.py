"""Steps of FMI 3.0 that end early, event mode, and what hosts do in the course of a step."""

import math
from pathlib import Path

import fmpy
import pytest

from ..instance import Instance3
from .bouncing_ball import list_bounces

Files = dict[str, Path]

BALL = "tests.fmus.native.bouncing_ball:bouncing_ball"
# Between the third bounce and the fourth.
STOP, BOUNCES = 1.2, list_bounces(3)
# Instants are located to the integrator's tolerance.
INSTANT = 1e-9


@pytest.mark.parametrize("step", [1e-2, STOP])
def test_steps_end_at_events(step: float, fmi3_files: Files) -> None:
    """Also at the first of many in a step. The event is due at the return, and happens in event mode."""
    slave = Instance3(fmi3_files[BALL], eventModeUsed=True, earlyReturnAllowed=True).initialize()
    t, found = 0.0, []
    while t < STOP - 1e-9:
        before = slave.get(["bounces"])
        event, ended, early, reached = slave.step(t, min(step, STOP - t))
        assert not ended
        assert event == early
        assert slave.get(["time"]) == [reached]
        t = reached
        if event:
            assert slave.get(["bounces"]) == before
            (velocity,) = slave.get(["velocity"])
            found.append(t)
            slave.fmu.enterEventMode()
            slave.handle_events()
            assert slave.get(["bounces"])[0] == before[0] + 1.0
            assert slave.get(["velocity"])[0] == -0.5 * velocity
    assert found == pytest.approx(BOUNCES, rel=0.0, abs=INSTANT)
    slave.free()


def test_without_event_mode_steps_end_after_events(fmi3_files: Files) -> None:
    slave = Instance3(fmi3_files[BALL], earlyReturnAllowed=True).initialize()
    t, found = 0.0, []
    while t < STOP - 1e-9:
        event, _, early, t = slave.step(t, STOP - t)
        assert not event
        assert slave.get(["bounces"])[0] == len(found) + early
        found += [t] * early
    assert found == pytest.approx(BOUNCES, rel=0.0, abs=INSTANT)
    slave.free()


def test_steps_do_not_end_early_where_the_host_does_not_allow_it(fmi3_files: Files) -> None:
    slave = Instance3(fmi3_files[BALL], eventModeUsed=True).initialize()
    assert slave.step(0.0, STOP) == (False, False, False, STOP)
    assert slave.get(["bounces"]) == [len(BOUNCES)]
    slave.free()


def test_chatter_ends(fmi3_files: Files) -> None:
    """Bounces ever faster, until the ball rests: time goes on over each of them. The motion is the same."""
    slave = Instance3(fmi3_files[BALL], eventModeUsed=True, earlyReturnAllowed=True).initialize()
    plain = Instance3(fmi3_files[BALL]).initialize()
    plain.step(0.0, 2.0)
    t, calls = 0.0, 0
    while t < 2.0 - 1e-9:
        event, _, _, t = slave.step(t, 2.0 - t)
        calls += 1
        if event:
            slave.fmu.enterEventMode()
            slave.handle_events()
    names = ["height", "velocity", "bounces", "resting", "last_bounce"]
    assert slave.get(names) == pytest.approx(plain.get(names), rel=1e-9, abs=1e-12)
    # The first bounce below the threshold: 2^-n v < 1e-6.
    (count, resting) = slave.get(["bounces", "resting"])
    assert (count, resting) == (math.ceil(math.log2(math.sqrt(20.0) / 1e-6)), 1.0)
    assert calls == count + 1.0
    for one in (slave, plain):
        one.free()


def test_known_events_are_told(fmi3_files: Files) -> None:
    slave = Instance3(fmi3_files["flywheel"], eventModeUsed=True)
    slave.set({"ramp_duration": 0.5, "initial_speed": 4.0, "motion": 1.0})
    slave.fmu.enterInitializationMode()
    slave.fmu.exitInitializationMode()
    *_, defined, time = slave.fmu.updateDiscreteStates()
    assert (defined, time) == (True, slave.get(["next_event"])[0])
    slave.free()


def test_a_host_runs_it_with_and_without_events(fmi3_files: Files) -> None:
    """fmpy's motion with event mode and early return is that without."""
    events = {"use_event_mode": True, "early_return_allowed": True}
    ends = [
        fmpy.simulate_fmu(
            str(fmi3_files[BALL]), fmi_type="CoSimulation", stop_time=STOP, output_interval=0.1,
            output=["height", "velocity"], **chosen,
        )[-1].tolist()
        for chosen in ({}, events)
    ]  # fmt: skip
    assert ends[1] == pytest.approx(ends[0], rel=1e-8)


def cubic(t: float) -> float:
    return 3.0 + 40.0 * t - 5e3 * t**2 + 6e5 * t**3


def test_inputs_given_within_steps_are_cubic(fmi3_files: Files) -> None:
    """The host gives them at three points in a step: the same as with its derivatives at the beginning."""
    reference = [0]

    def give(time: float, setting: bool, finished: bool, possible: bool) -> None:
        seen.append((time, setting, finished))
        if setting:
            slave.fmu.setFloat64(reference, [cubic(time)])

    seen: list[tuple[float, bool, bool]] = []
    described = fmpy.read_model_description(str(fmi3_files[BALL]))
    (reference[0],) = (v.valueReference for v in described.modelVariables if v.name == "push")
    slave = Instance3(fmi3_files[BALL], update=give, requiredIntermediateVariables=reference)
    other = Instance3(fmi3_files[BALL])
    h = 1e-2
    for one in (slave, other):
        one.initialize(push=cubic(0.0))
    for i in range(10):
        t = i * h
        slopes = {"push_der1": 40.0 - 1e4 * t + 18e5 * t**2, "push_der2": -1e4 + 36e5 * t, "push_der3": 36e5}
        other.set({"push": cubic(t)} | slopes)
        for one in (slave, other):
            one.step(t, h)
    # Differences of the third order, from values with an error of rounding.
    assert slave.outputs() == pytest.approx(other.outputs(), rel=1e-12, abs=1e-9)
    assert slave.get(["push"]) == pytest.approx([cubic(10 * h)], rel=1e-14)
    assert [round(t / h, 3) for t, _, _ in seen[:5]] == [0.0, 0.333, 0.667, 1.0, 1.0]
    assert [setting for _, setting, _ in seen[:5]] == [False, True, True, True, False]
    for one in (slave, other):
        one.free()


def test_a_host_ends_a_step_from_within(fmi3_files: Files) -> None:
    """The step is the one that ends there, to the last bit."""
    wanted = 3.7e-4

    def ask(time: float, setting: bool, finished: bool, possible: bool) -> float | None:
        return wanted if possible else None

    one = Instance3(fmi3_files["valve_spring"], update=ask, earlyReturnAllowed=True).initialize(load=500.0)
    two = Instance3(fmi3_files["valve_spring"]).initialize(load=500.0)
    assert one.step(0.0, 1e-3) == (False, False, True, wanted)
    two.step(0.0, wanted)
    assert one.outputs() == two.outputs()
    for slave in (one, two):
        slave.free()


def test_outputs_are_read_within_steps(fmi3_files: Files) -> None:
    """At the beginning and at the end of a step; other calls are refused there."""
    read = []

    def look(time: float, setting: bool, finished: bool, possible: bool) -> None:
        read.append((time, slave.get(["position"])[0]))
        for call in (slave.fmu.terminate, slave.fmu.reset, lambda: slave.step(time, 1e-5)):
            with pytest.raises(fmpy.fmi1.FMICallException):
                call()

    slave = Instance3(fmi3_files["valve_spring"], update=look).initialize(load=500.0)
    slave.step(0.0, 1e-3)
    (end,) = slave.get(["position"])
    assert read == [(0.0, 0.0), (1e-3, end)]
    assert not math.isclose(end, 0.0)
    assert "during an intermediate update" in slave.messages[-1][2]
    slave.free()
