"""What native FMUs of FMI 3.0 refuse: an error with its cause, the instance as it was, never a crash."""

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import fmpy
import pytest
from fmpy import fmi3
from fmpy.fmi1 import FMICallException

from ..instance import Instance3
from .test_fmi3_events import BALL

Files = dict[str, Path]


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


def test_wrong_types(spring: Instance3) -> None:
    spring.initialize()
    (position,) = (spring.variables[name].valueReference for name in ("position",))
    fmu = spring.fmu
    assert "position is not of type Int32 but Float64" in refused(spring, lambda: fmu.getInt32([position]))
    assert "position is not of type Boolean" in refused(spring, lambda: fmu.getBoolean([position]))
    for kind in ("Float32", "Int8", "UInt8", "Int16", "UInt16", "UInt32", "UInt64", "String", "Binary"):
        said = refused(spring, lambda kind=kind: getattr(fmu, f"get{kind}")([position]))
        assert said == f"fmi3Get{kind}: this FMU has no variables of type {kind}"
    assert "no clocks" in refused(spring, lambda: fmu.getClock([position]))


def test_counts_and_choices_are_no_other_integers(fmi3_files: Files) -> None:
    for name, variable, kind, said in (
        ("flywheel", "motion", "Int32", "motion is not of type Int32 but Enumeration"),
        (BALL, "bounces", "Int64", "bounces is not of type Enumeration but Int32"),
    ):
        slave = Instance3(fmi3_files[name]).initialize()
        reference = [slave.variables[variable].valueReference]
        assert said in refused(slave, lambda: getattr(slave.fmu, f"get{kind}")(reference))  # noqa: B023
        slave.free()


def test_unknown_references_and_numbers_of_values(spring: Instance3) -> None:
    spring.initialize()
    fmu = spring.fmu
    assert "no value reference 123456" in refused(spring, lambda: fmu.getFloat64([123456]))
    assert "2 values for 1 variables" in refused(spring, lambda: fmu.getFloat64([0], 2))
    assert "0 values for 1 variables" in refused(spring, lambda: fmu.setFloat64([0], []))
    assert "no place" in refused(spring, lambda: fmu.fmi3GetFloat64(fmu.component, None, 1, None, 1))


def test_values_that_cannot_be(spring: Instance3) -> None:
    spring.initialize(load=400.0)
    assert refused(spring, lambda: spring.set({"load": math.nan})) == "load = nan: must be finite"
    assert spring.get(["load"]) == [400.0]
    assert "position is calculated" in refused(spring, lambda: spring.set({"position": 1.0}))
    assert "is fixed" in refused(spring, lambda: spring.set({"position_start": 1.0}))
    assert "time is calculated" in refused(spring, lambda: spring.set({"time": 1.0}))


def test_parameters_out_of_range(spring: Instance3) -> None:
    said = refused(spring, lambda: spring.initialize(spring_rate=-3.5e4))
    assert "spring_rate = -35000 N/m (static rate k0 of the spring): must be > 0" in said
    spring.fmu.reset()
    spring.initialize()


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


def test_calls_in_the_wrong_state(spring: Instance3) -> None:
    fmu = spring.fmu
    assert "fmi3DoStep: not allowed after instantiation" in refused(spring, lambda: spring.step(0.0, 1e-5))
    assert "fmi3Terminate" in refused(spring, fmu.terminate)
    assert "fmi3ExitInitializationMode" in refused(spring, fmu.exitInitializationMode)
    fmu.enterInitializationMode()
    assert "during initialisation" in refused(spring, fmu.enterInitializationMode)
    fmu.exitInitializationMode()
    assert "event mode is not used" in refused(spring, fmu.enterEventMode)
    assert "during stepping" in refused(spring, fmu.updateDiscreteStates)
    assert "no structural parameters" in refused(spring, fmu.enterConfigurationMode)
    get_states = fmu.fmi3GetContinuousStates
    assert "in co-simulation" in refused(spring, lambda: get_states(fmu.component, None, 0))
    fmu.terminate()
    assert "after termination" in refused(spring, lambda: spring.step(0.0, 1e-5))
    assert "after termination" in refused(spring, lambda: spring.set({"load": 1.0}))


def test_damaged_states(spring: Instance3, fmi3_files: Files) -> None:
    spring.initialize()
    data = bytearray(spring.saved_bytes())
    data[len(data) // 2] ^= 1
    assert "its sum does not match" in refused(spring, lambda: spring.restore_bytes(bytes(data)))
    assert "must be" in refused(spring, lambda: spring.restore_bytes(bytes(data[:-1])))
    other = Instance3(fmi3_files["flywheel"]).initialize()
    foreign = other.saved_bytes()
    assert "not of this FMU" in refused(spring, lambda: spring.restore_bytes(foreign))
    other.free()
