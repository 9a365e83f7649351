"""Derivatives of inputs and outputs by the standard's calls are those by the variables, to the last bit."""

from ctypes import c_double, c_int, c_size_t, c_uint

import pytest

from ..instance import Instance
from ..reference import Reference, joined, wave
from .names import EVERY

STEP, STEPS, ORDERS = 1e-5, 20, (1, 2, 3)


def by_calls(slave: Instance, values: dict[str, float], names: list[str]) -> None:
    slave.set({name: values[name] for name in names})
    for name in names:
        reference = slave.variables[name].valueReference
        of_name = (c_double * 3)(*(values[joined(name, order)] for order in ORDERS))
        # In one call for all orders, as the standard has it.
        status = slave.fmu.fmi2SetRealInputDerivatives(
            slave.fmu.component, (c_uint * 3)(*[reference] * 3), c_size_t(3), (c_int * 3)(*ORDERS), of_name
        )
        assert status == 0


@pytest.mark.parametrize("name", EVERY)
def test_inputs_by_calls_and_by_variables_give_the_same_motion(name, native_files):
    component = Reference(name).component
    one, other = (Instance(native_files[name]).initialize() for _ in range(2))
    names = [n for n in component.inputs.names if one.variables[n].type == "Real"]
    for i in range(STEPS):
        values = wave(component, i * STEP)
        by_calls(one, values, names)
        other.set({joined(n, order): values[joined(n, order)] for n in names for order in (0, *ORDERS)})
        for slave in (one, other):
            slave.step(i * STEP, STEP)
        assert one.outputs() == other.outputs()
    for slave in (one, other):
        slave.free()


@pytest.mark.parametrize("name", EVERY)
def test_derivatives_of_outputs_are_their_rates(name, native_files):
    component = Reference(name).component
    slave = Instance(native_files[name]).initialize()
    slave.set(wave(component, 0.0))
    slave.step(0.0, STEP)
    rated = [f.name for f in component.outputs.fields if not f.quantity.discrete]
    count, values = len(rated), (c_double * len(rated))()
    references = (c_uint * count)(*(slave.variables[n].valueReference for n in rated))
    status = slave.fmu.fmi2GetRealOutputDerivatives(
        slave.fmu.component, references, c_size_t(count), (c_int * count)(*[1] * count), values
    )
    assert status == 0
    assert list(values) == slave.get([f"der({n})" for n in rated])
    slave.free()
