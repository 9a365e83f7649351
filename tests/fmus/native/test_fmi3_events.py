"""FMI 3.0: steps that end early, event mode, what hosts do in a step; what is refused, with its cause."""

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import fmpy
import pytest
from fmpy import fmi3
from fmpy.fmi1 import FMICallException

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


@pytest.mark.parametrize(
    ("name", "start", "expected"),
    [
        (BALL, "height_start", [2.0]),
        # Between the walls they are the distances to the upper and the lower one.
        pytest.param("slider_crank", "psi_start", [-2.0, 2.0, 0.0], marks=pytest.mark.long),
    ],
)
def test_event_indicators_have_derivatives(name: str, start: str, expected: list, fmi3_files: Files) -> None:
    """Also where another variable is asked for with them."""
    slave = Instance3(fmi3_files[name])
    slave.fmu.enterInitializationMode()
    names = [*(f"event_indicator[{i + 1}]" for i in range(len(expected))), "stored_energy"]
    unknown = [slave.variables[one].valueReference for one in names]
    known = [slave.variables[start].valueReference]
    assert slave.fmu.getDirectionalDerivative(unknown, known, [2.0])[:-1] == expected
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


@pytest.fixture
def spring(fmi3_files: Files) -> Iterator[Instance3]:
    slave = Instance3(fmi3_files["valve_spring"])
    yield slave
    slave.free()


def refused(slave: Instance3, call: Callable[[], Any], status: str = "error") -> str:
    """The message of a refused call."""
    slave.messages.clear()
    with pytest.raises(FMICallException, match=status):
        call()
    (message,) = slave.messages
    assert message[0] == {"discard": 2, "error": 3}[status]
    return message[2]


def test_a_wrong_token(fmi3_files: Files) -> None:
    said: list[bytes] = []
    folder = fmpy.extract(str(fmi3_files["valve_spring"]))
    for kind in (fmi3.FMU3Slave, fmi3.FMU3Model):
        slave = kind(guid="{0}", unzipDirectory=folder, modelIdentifier="valve_spring", instanceName="one")
        with pytest.raises(Exception, match="instantiate"):
            slave.instantiate(logMessage=lambda *message: said.append(message[3]))
    assert b"the instantiationToken must be {" in said[0]
    assert len(said) == 2


def test_scheduled_execution(fmi3_files: Files) -> None:
    said: list[bytes] = []
    slave = fmi3.FMU3ScheduledExecution(
        guid="",
        unzipDirectory=fmpy.extract(str(fmi3_files["valve_spring"])),
        modelIdentifier="valve_spring",
        instanceName="one",
    )
    with pytest.raises(Exception, match="instantiate"):
        slave.instantiate(logMessage=lambda *message: said.append(message[3]))
    assert said == [
        b"scheduled execution: this FMU has no clocks; it is for co-simulation and model exchange"
    ]


ABSENT = ("Float32", "Int8", "UInt8", "Int16", "UInt16", "UInt32", "UInt64", "String", "Binary")
# The phase, the message, and the function of fmpy's that gets it, with its arguments; a name stands for the
# reference of that variable.
REFUSED: list[tuple[Any, ...]] = [
    ("new", "fmi3DoStep: not allowed after instantiation", "doStep", 0.0, 1e-5),
    ("new", "fmi3Terminate", "terminate"),
    ("new", "fmi3ExitInitializationMode", "exitInitializationMode"),
    ("initialising", "during initialisation", "enterInitializationMode"),
    ("stepping", "position is not of type Int32 but Float64", "getInt32", "position"),
    ("stepping", "position is not of type Boolean", "getBoolean", "position"),
    ("stepping", "no clocks", "getClock", "position"),
    *(("stepping", f"this FMU has no variables of type {k}", f"get{k}", "position") for k in ABSENT),
    ("stepping", "no value reference 123456", "getFloat64", [123456]),
    ("stepping", "2 values for 1 variables", "getFloat64", [0], 2),
    ("stepping", "0 values for 1 variables", "setFloat64", [0], []),
    ("stepping", "load = nan: must be finite", "setFloat64", "load", [math.nan]),
    ("stepping", "position is calculated", "setFloat64", "position", [1.0]),
    ("stepping", "is fixed", "setFloat64", "position_start", [1.0]),
    ("stepping", "time is calculated", "setFloat64", "time", [1.0]),
    ("stepping", "event mode is not used", "enterEventMode"),
    ("stepping", "during stepping", "updateDiscreteStates"),
    ("stepping", "no structural parameters", "enterConfigurationMode"),
    ("ended", "fmi3DoStep: not allowed after termination", "doStep", 0.0, 1e-5),
    ("ended", "after termination", "setFloat64", "load", [1.0]),
]


@pytest.mark.parametrize("row", REFUSED, ids=lambda row: row[1])
def test_what_is_refused_has_its_reason_and_changes_nothing(spring: Instance3, row: tuple[Any, ...]) -> None:
    check_refusal(spring, row)


def check_refusal(spring: Instance3, row: tuple[Any, ...]) -> None:
    phase, said, function, *given = row
    if phase == "initialising":
        spring.fmu.enterInitializationMode()
    elif phase != "new":
        spring.initialize(load=400.0)
    before = spring.saved_bytes() if phase == "stepping" else b""
    if phase == "ended":
        spring.fmu.terminate()
    arguments = [[spring.variables[one].valueReference] if isinstance(one, str) else one for one in given]
    assert said in refused(spring, lambda: getattr(spring.fmu, function)(*arguments))
    assert not before or spring.saved_bytes() == before
    spring.fmu.reset()
    spring.initialize()


def test_pointers_to_nothing_and_calls_of_the_other_interface(spring: Instance3) -> None:
    spring.initialize()
    fmu = spring.fmu
    assert "no place" in refused(spring, lambda: fmu.fmi3GetFloat64(fmu.component, None, 1, None, 1))
    states = fmu.fmi3GetContinuousStates
    assert "in co-simulation" in refused(spring, lambda: states(fmu.component, None, 0))


def test_parameters_out_of_range(spring: Instance3) -> None:
    said = refused(spring, lambda: spring.initialize(spring_rate=-3.5e4))
    assert "spring_rate = -35000 N/m (static rate k0 of the spring): must be > 0" in said


def test_counts_and_choices_are_no_other_integers(fmi3_files: Files) -> None:
    for name, variable, kind, said in (
        ("flywheel", "motion", "Int32", "motion is not of type Int32 but Enumeration"),
        (BALL, "bounces", "Int64", "bounces is not of type Enumeration but Int32"),
    ):
        slave = Instance3(fmi3_files[name]).initialize()
        reference = [slave.variables[variable].valueReference]
        assert said in refused(slave, lambda: getattr(slave.fmu, f"get{kind}")(reference))  # noqa: B023
        slave.free()


@pytest.mark.parametrize(
    ("t", "h", "said"),
    [(0.0, -1e-5, "negative"), (0.0, math.nan, "negative"), (1.0, 1e-5, "must begin at 0 s")],
)
def test_steps_that_cannot_be_made(spring: Instance3, t: float, h: float, said: str) -> None:
    spring.initialize(load=400.0)
    before = spring.saved_bytes()
    assert said in refused(spring, lambda: spring.step(t, h), "discard")
    assert spring.saved_bytes() == before
    spring.step(0.0, 1e-5)


def test_no_step_goes_beyond_the_stop_time(spring: Instance3) -> None:
    spring.fmu.enterInitializationMode(startTime=0.0, stopTime=1e-3)
    spring.fmu.exitInitializationMode()
    assert "beyond the stop time" in refused(spring, lambda: spring.step(0.0, 1.1e-3))
    spring.step(0.0, 1e-3)
