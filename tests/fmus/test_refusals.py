"""What an FMU refuses, and that the host hears of it although it did not ask for logging."""

import math

import pytest
from fmpy.fmi1 import FMICallException

from .instance import Instance

ERROR, CATEGORY = 3, "logStatusError"


@pytest.fixture(scope="module")
def shared(unpacked):
    slave = Instance(unpacked["valve_spring"])
    yield slave
    slave.free()


@pytest.fixture
def spring(shared):
    """A fresh valve_spring."""
    shared.fmu.reset()
    shared.messages.clear()
    return shared


def errors(slave: Instance) -> list[str]:
    return [text for status, category, text in slave.messages if (status, category) == (ERROR, CATEGORY)]


def test_parameter_out_of_range(spring):
    with pytest.raises(FMICallException, match=r"fmi2ExitInitializationMode.*fatal"):
        spring.initialize(spring_rate=-3.5e4, preload=-1.0)
    (message,) = errors(spring)
    assert "spring_rate = -35000 N/m (static rate k0 of the spring): must be > 0" in message
    assert "preload = -1 N" in message


def test_instance_works_again_after_a_refusal(spring):
    for _ in range(5):
        with pytest.raises(FMICallException):
            spring.initialize(valve_mass=0.0)
        spring.fmu.reset()
    spring.initialize(load=500.0)
    spring.step(0.0, 1e-5)
    assert spring.get(["velocity"])[0] > 0.0


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_input_that_is_no_number_discards_the_step(spring, value):
    spring.initialize(load=400.0)
    spring.step(0.0, 1e-5)
    before = spring.outputs()
    spring.set({"load_der2": value})
    with pytest.raises(FMICallException, match="discard"):
        spring.step(1e-5, 1e-5)
    assert errors(spring) == [f"load_der2 = {value}: must be finite"]
    spring.set({"load_der2": 0.0})
    assert spring.outputs() == before
    spring.step(1e-5, 1e-5)


def test_step_that_fails_leaves_the_state(spring):
    """A load that lets the state overflow within the step."""
    spring.initialize()
    data = spring.saved_bytes()
    spring.set({"load": 1e308})
    with pytest.raises(FMICallException, match="discard"):
        spring.step(0.0, 1.0)
    (message,) = errors(spring)
    assert message.startswith("step from t = 0 s by 1 s: ")

    def next_step():
        spring.set({"load": 500.0})
        spring.step(0.0, 1e-4)
        return spring.outputs()

    after_failure = next_step()
    spring.restore_bytes(data)
    assert next_step() == after_failure


@pytest.mark.parametrize(
    ("t", "h", "message"),
    [
        (1.0, 1e-5, "must begin at 0 s"),
        (0.0, -1e-5, "must not be negative"),
        (0.0, math.nan, "must not be negative"),
    ],
)
def test_step_in_the_wrong_place_is_discarded(spring, t, h, message):
    spring.initialize()
    with pytest.raises(FMICallException, match="discard"):
        spring.step(t, h)
    assert message in errors(spring)[0]


@pytest.mark.parametrize(("name", "message"), [("position", "is an output"), ("position_start", "is fixed")])
def test_outputs_and_fixed_parameters_cannot_be_set(spring, name, message):
    """One of them for an instance: after fmi2Fatal the standard allows no other call."""
    spring.initialize()
    with pytest.raises(FMICallException, match="fatal"):
        spring.set({name: 1.0})
    assert message in errors(spring)[-1]


@pytest.mark.parametrize("access", ["get", "set"])
@pytest.mark.parametrize("reference", [123456, 2**32 - 1])
def test_unknown_value_reference(access, reference, spring):
    """The C layer makes -1 of the highest one, which is the place of the state's last number."""
    call = spring.fmu.getReal if access == "get" else lambda references: spring.fmu.setReal(references, [1.0])
    with pytest.raises(FMICallException, match="fatal"):
        call([reference])
    assert f"there is no value reference {reference}" in errors(spring)[0]
