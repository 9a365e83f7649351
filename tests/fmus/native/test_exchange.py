"""Model exchange: a host that integrates native FMUs finds their own motion; their steps their references."""

from pathlib import Path

import fmpy
import numpy as np
import pytest

from fmus.reference_results.compare import compare

from ..instance import Instance
from ..names import mark_long
from ..reference import Reference
from .names import EVERY, FAST

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


@pytest.mark.parametrize("name", EVERY)
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


@pytest.mark.parametrize("fmi", [2, pytest.param(3, marks=pytest.mark.long)])
@pytest.mark.parametrize("name", EVERY)
def test_steps_reproduce_the_reference_results(
    name, fmi, referenced_native_files, referenced_fmi3_files, record
):
    found = compare((referenced_native_files if fmi == 2 else referenced_fmi3_files)[name])
    assert found.agrees, str(found)
    quantity, worst = f"deviation of native FMUs, FMI {fmi}", found.worst.relative
    record("FMUs", quantity, worst, 0.0, "reference results in the FMU", tolerance=found.tolerance)
