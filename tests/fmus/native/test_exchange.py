"""Model exchange of native FMUs; derivatives by calls are those by variables, to the last bit."""

from ctypes import POINTER, c_double, c_int, c_size_t, c_uint
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest

from ..instance import Instance, Instance3
from ..kinds import EVERY_NATIVE, FAST
from ..names import mark_long
from ..reference import Reference, joined, wave

# What the host's integrator is asked for; errors of many steps add up.
TOLERANCE = 1e-9

MOTIONS = {
    "camshaft": ({"flexible": True, "drive_speed": 100.0, "contact_load": 300.0}, 0.02),
    "valve_spring": ({"position_start": 0.003, "load": 500.0}, 0.01),
    "flywheel": ({"drive_torque": 1.0}, 0.2),
    "coupled_mass": ({"position_start": 1.0}, 1.0),
    # Chatter ends by sliding before its flights are shorter than a host's steps.
    "slider_crank": ({"crank_speed": 100.0, "psi_start": 5e-4, "sliding_threshold": 5e-3}, 0.2),
}


def pointer_to(values: np.ndarray) -> Any:
    return values.ctypes.data_as(POINTER(c_double))


def simulated(fmu: Path, kind: str, start: dict, stop: float, names: list[str]) -> np.ndarray:
    """The outputs by the host's own steps, or by the FMU's."""
    return fmpy.simulate_fmu(
        str(fmu),
        fmi_type=kind,
        start_values=start,
        stop_time=stop,
        output_interval=stop / 100.0,
        relative_tolerance=TOLERANCE,
        output=names,
        record_events=False,
    )


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("name", mark_long(MOTIONS, FAST))
def test_the_hosts_integrator_finds_the_same_motion(name, fmi, native_files, fmi3_files):
    """Outputs at the end, and everywhere but about impacts, whose instants differ."""
    start, stop = MOTIONS[name]
    file = (native_files if fmi == 2 else fmi3_files)[name]
    described = fmpy.read_model_description(str(file))
    names = [u.variable.name for u in described.outputs if not u.variable.name.startswith("der(")]
    host, own = (simulated(file, kind, start, stop, names) for kind in ("ModelExchange", "CoSimulation"))
    for output in names:
        differences = np.abs(host[output].astype(float) - own[output].astype(float))
        size = np.abs(own[output].astype(float)).max() + 1e-12
        assert np.median(differences) <= 1e4 * TOLERANCE * size, output
        assert differences[-1].max() <= 1e5 * TOLERANCE * size, output


@pytest.mark.parametrize("name", EVERY_NATIVE)
def test_states_and_their_derivatives_are_shown(name, native_files):
    """To the last bit those of the component after a step."""
    reference = Reference(name)
    component, slave = reference.component, Instance(native_files[name]).initialize()
    reference.step(1e-4)
    slave.step(0.0, 1e-4)
    rates = np.zeros(component.state.size)
    component.flat_derivative(reference.t, reference.x, reference.u, reference.p, rates)
    shown = [f.name for f in component.state.fields if not (f.quantity.discrete or f.quantity.internal)]
    found = (
        slave.get([f"state.{name}" for name in shown]),
        slave.get([f"der(state.{name})" for name in shown]),
    )
    places = [component.state.index(name) for name in shown]
    assert found == (reference.x[places].tolist(), rates[places].tolist())
    slave.free()


def test_states_may_be_set_one_by_one(fmi3_files):
    """FMI 3.0.2, 3.2.1: in continuous-time mode only. The same bits as by all states together."""
    slave = Instance3(fmi3_files["coupled_mass"])
    position = [slave.variables["state.position"].valueReference]
    order = [u.variable.derivative.name for u in slave.description.derivatives]
    rates = []
    for alone in (True, False):
        with slave.exchanging() as fmu:
            with pytest.raises(fmpy.fmi1.FMICallException):
                fmu.setFloat64(position, [0.25])
            fmu.enterContinuousTimeMode()
            state, rate = np.zeros(len(order)), np.zeros(len(order))
            pointers = [pointer_to(vector) for vector in (state, rate)]
            fmu.getContinuousStates(pointers[0], len(order))
            if alone:
                fmu.setFloat64(position, [0.25])
            else:
                state[order.index("state.position")] = 0.25
                fmu.setContinuousStates(pointers[0], len(order))
            fmu.getContinuousStateDerivatives(pointers[1], len(order))
            rates.append(rate.tolist())
    slave.free()
    assert rates[0] == rates[1]
    assert any(rates[0])


@pytest.mark.parametrize("fmi", [2, 3])
def test_beyond_its_range_a_film_grows_as_at_the_limit(fmi, native_files, fmi3_files):
    """At any thickness that is not positive, which solvers try, by one finite rate; faster than within."""
    make, files = {2: (Instance, native_files), 3: (Instance3, fmi3_files)}[fmi]
    slave = make(files["ehl_contact"])
    rate, rates = np.zeros(1), []
    with slave.exchanging(load_is_given=True, applied_load=500.0, entraining_velocity=1.0) as fmu:
        fmu.enterContinuousTimeMode()
        for film in (1e-7, 0.0, -1e-7, -1.0):
            fmu.setContinuousStates((c_double * 1)(film), 1)
            (fmu.getDerivatives if fmi == 2 else fmu.getContinuousStateDerivatives)(pointer_to(rate), 1)
            rates.append(float(rate[0]))
    slave.free()
    assert not slave.messages
    assert np.isfinite(rates).all()
    assert rates[0] < rates[1] == rates[2] == rates[3]


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


@pytest.mark.parametrize("name", EVERY_NATIVE)
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


@pytest.mark.parametrize("name", EVERY_NATIVE)
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
