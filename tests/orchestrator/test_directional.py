"""FMUs linearised by their directional derivatives: those of the components in whose place they are."""

import numpy as np
import pytest
from typer.testing import CliRunner

from fmus.native.fmu import build
from fmus.native.machine_code import this_platform
from models.core.system import Instance
from orchestrator.analyses.stability.linearisation import Directional, Equations
from orchestrator.analyses.stability.trajectory import list_connected_inputs, list_continuous_outputs
from orchestrator.participants import Limits, open_fmu, read_component
from tribocosim.command_line import app

from ..third_party.c_fmus import fmu as c_fmu
from .linearised import (
    SPACING,
    list_outputs,
    load_flexible,
    masses_with_fmu,
    quarter_car,
    solve_trajectory,
    write_masses,
)
from .two_masses import two_masses


def linearise_twice(system, name, where, row, path):
    """An FMU by its directional derivatives, and the component by its equations."""
    unit = open_fmu(name, path, system.instances[name])
    try:
        exchanged = [*list_connected_inputs(name, system), *list_continuous_outputs(name, system)]
        assert unit.find_states(exchanged) is not None
        found = Directional(name, unit, system).about(where, row, list_outputs(system, name))
    finally:
        unit.close()
    return found, Equations(system, name).about(where, row, list_outputs(system, name))


def assert_alike(found, expected, system, name, tolerance):
    """Each matrix, in nominal units, to `tolerance` of its largest element: for the component's states
    without modes, as the FMU has them, and the inputs that are driven."""
    component = system.instances[name].component
    smooth = [i for i, field in enumerate(component.state.fields) if not field.quantity.discrete]
    driven = [component.inputs.index(variable) for variable in list_connected_inputs(name, system)]
    x, u, y = expected.scale[smooth], component.inputs.nominal[driven], component.outputs.nominal[:, None]
    np.testing.assert_array_equal(found.scale, x)
    pairs = [
        (found.A * x / x[:, None], expected.A[np.ix_(smooth, smooth)] * x / x[:, None]),
        (found.B[:, driven] * u / x[:, None], expected.B[np.ix_(smooth, driven)] * u / x[:, None]),
        (found.C * x / y, expected.C[:, smooth] * x / y),
        (found.D[:, driven] * u / y, expected.D[:, driven] * u / y),
    ]
    for one, other in pairs:
        np.testing.assert_allclose(one, other, rtol=0.0, atol=tolerance * np.abs(other).max(initial=0.0))


def build_native(component, fmi):
    return build(component.name, structure=component.structure, platforms=[this_platform()], fmi=fmi)


@pytest.mark.long
@pytest.mark.parametrize(
    ("system", "fmi"), [(quarter_car(), 2), (two_masses(damping=2.0), 3)], ids=["quarter car", "two masses"]
)
def test_native_fmus_have_the_matrices_of_their_equations(system, fmi):
    """Equations are differenced, to 1e-9 of what is linear."""
    where = solve_trajectory(system, 0.2, SPACING)
    for name, instance in system.instances.items():
        found, expected = linearise_twice(system, name, where, 40, build_native(instance.component, fmi))
        assert_alike(found, expected, system, name, 1e-8)
        fed_to = instance.component.inputs.index(list_connected_inputs(name, system)[0])
        np.testing.assert_array_equal(found.followed[:, fed_to], 1.0)


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "fmi", "tolerance"), [("camshaft", 2, 1e-8), ("valve_spring", 3, 1e-8), ("contact", 2, 1e-6)]
)
def test_native_fmus_of_a_loaded_valve_train_do(name, fmi, tolerance):
    """To differences of the equations: over 1e-8 m of approach, a thousandth of the contact's deflection, of
    which the load is a power, 1e-6 is left."""
    system, where = load_flexible()
    path = build_native(system.instances[name].component, fmi)
    found, expected = linearise_twice(system, name, where, 3000, path)
    assert_alike(found, expected, system, name, tolerance)


@pytest.mark.parametrize("version", [2, 3])
def test_a_third_party_fmu_has_the_matrices_of_its_law(version, tmp_path):
    """m a = f - k x - d v: to the rounding of its own differences, of values below 10. It holds its input."""
    system = masses_with_fmu()
    where = solve_trajectory(system, 0.2, SPACING)
    found, _ = linearise_twice(system, "second", where, 40, c_fmu("sprung", version, tmp_path))
    np.testing.assert_allclose(found.A, [[0.0, 1.0], [-10.0, -0.5]], atol=1e-13)
    np.testing.assert_allclose(found.B, [[0.0], [1.0]], atol=1e-13)
    np.testing.assert_allclose(found.C, np.eye(2), atol=1e-13)
    np.testing.assert_array_equal(found.D, 0.0)
    np.testing.assert_array_equal(found.followed[:4, 0], [1.0, 0.0, 0.0, 0.0])


def test_an_fmu_in_its_own_process_has_the_same_matrices(tmp_path):
    system, path = masses_with_fmu(), c_fmu("sprung", 3, tmp_path)
    where = solve_trajectory(system, 0.2, SPACING)
    found = []
    for limits in (None, Limits()):
        unit = open_fmu("second", path, system.instances["second"], limits=limits)
        found.append(Directional("second", unit, system).about(where, 40, list_outputs(system, "second")))
        unit.close()
    for here, there in zip(*((one.A, one.B, one.C, one.D, one.followed) for one in found), strict=True):
        np.testing.assert_array_equal(here, there)


@pytest.mark.long
def test_the_command_takes_derivatives_where_an_fmu_gives_them(tmp_path):
    scenario = write_masses(tmp_path, c_fmu("sprung", 3, tmp_path).as_posix())
    said = CliRunner().invoke(app, ["analyse", scenario, "--out", str(tmp_path / "out")])
    assert said.exit_code == 0, said.output
    output = " ".join(said.output.split())
    assert "By their equations: first" in output
    assert "By their directional derivatives: second." in output
    assert "second holds its inputs force over a step" in output


@pytest.mark.parametrize("name", ["vanderpol", "feedthrough"])
def test_an_fmu_that_gives_no_derivatives_is_not_linearised_by_them(name, tmp_path):
    path = c_fmu(name, 2, tmp_path)
    unit = open_fmu(name, path, Instance(read_component(path)))
    assert unit.find_states([]) is None
    unit.close()
