"""Native FMUs of FMI 3.0: the component to the last bit, with arrays, and what those of FMI 2.0 can do."""

import re
from collections.abc import Callable
from typing import Any

import fmpy
import numpy as np
import pytest
from fmpy import fmi3
from fmpy.fmi1 import FMICallException
from fmpy.model_description import ModelDescription, ScalarVariable

from fmus.fmi.validate import validate
from tests.third_party.runs import ran, scenario

from ..instance import Instance, Instance3
from ..kinds import EVERY_NATIVE


@pytest.mark.parametrize("name", EVERY_NATIVE)
def test_variables_are_those_of_fmi_2(name, native_files, fmi3_files):
    """And besides them time and what indicates events, which FMI 3.0 has as variables. Vectors are arrays.
    Validators find no fault with either."""
    assert validate(native_files[name]) == validate(fmi3_files[name]) == []
    before, after = (fmpy.read_model_description(str(files[name])) for files in (native_files, fmi3_files))
    kinds = {"Real": "Float64", "Integer": "Int32"}
    told = [
        [
            (element, reference, kinds.get(v.type, v.type), v.causality, v.unit, v.min, v.max, start)
            for v in described.modelVariables
            if v.name != "time" and not v.name.startswith("event_indicator")
            for element, reference, start in elements(v)
        ]
        for described in (before, after)
    ]
    assert told[0] == told[1]
    wholes = {whole_of(after)(element) for element, *_ in told[1]}
    assert len(after.modelVariables) == len(wholes) + 1 + before.numberOfEventIndicators
    assert after.numberOfEventIndicators == before.numberOfEventIndicators
    for unknowns in ("outputs", "derivatives", "initialUnknowns"):
        assert dependencies(before, unknowns, whole_of(after)) == dependencies(after, unknowns, str)


def elements(variable: ScalarVariable) -> list[tuple[str, int, str | None]]:
    """Name, reference as in FMI 2.0, and start value of each."""
    if not variable.dimensions:
        return [(variable.name, variable.valueReference, variable.start)]
    ((count,),) = [variable.shape]
    starts = [None] * count if variable.start is None else variable.start.split()
    stem, bracket, end = variable.name.partition(")")
    return [
        (f"{stem}[{i + 1}]{bracket}{end}", variable.valueReference + i, start)
        for i, start in enumerate(starts)
    ]


def whole_of(described: ModelDescription) -> Callable[[str], str]:
    """From the name of an element to that of the array, where it is one."""
    arrays = {v.name for v in described.modelVariables if v.dimensions}

    def whole(name: str) -> str:
        stem = re.sub(r"\[\d+\]", "", name)
        return stem if stem in arrays else name

    return whole


def dependencies(described: ModelDescription, unknowns: str, named: Callable[[str], str]) -> dict:
    """What each unknown depends on, with all that its elements depend on."""
    found: dict[str, set[str] | None] = {}
    for u in getattr(described, unknowns):
        name = named(u.variable.name)
        if u.dependencies is None:
            found[name] = None
        else:
            found[name] = (found.get(name) or set()) | {named(v.name) for v in u.dependencies}
    return found


WARNING = 1
COILS = ["coil_position", "coil_velocity"]
STARTS = {"coil_position_start": [1e-4, -2e-4], "coil_velocity_start": [0.3, 0.1]}


def by_element(values: dict[str, list[float]]) -> dict[str, float]:
    return {f"{name}[{i}]": v for name, whole in values.items() for i, v in enumerate(whole, 1)}


def reference(slave: Instance, name: str) -> int:
    return int(slave.variables[name].valueReference)


def refused(slave: Instance3, call: Any) -> str:
    with pytest.raises(FMICallException):
        call()
    return slave.messages[-1][2]


@pytest.fixture
def spring(fmi3_files):
    slave = Instance3(fmi3_files["valve_spring"])
    yield slave
    slave.free()


def test_what_is_declared(fmi3_files):
    """Parameters, start values, states and their derivatives, with fixed dimensions; what may be connected is
    scalar."""
    spring, shaft = (
        {v.name: v for v in fmpy.read_model_description(str(fmi3_files[name])).modelVariables}
        for name in ("valve_spring", "flywheel")
    )
    arrays = {name for name, v in spring.items() if v.dimensions}
    states = {f"state.{name}" for name in COILS}
    assert arrays == {*STARTS, *states, *(f"der({name})" for name in states)}
    assert {spring[name].shape for name in arrays} == {(2,)}
    assert spring["coil_position_start"].start == "0.0 0.0"
    for name in states:
        assert spring[f"der({name})"].derivative is spring[name]
    assert {name for name, v in shaft.items() if v.dimensions} == {"throw"}
    assert {"coil_position[2]", "der(coil_position[2])"} <= {*spring}
    assert {"load_torque[1]", "throw_angle[1]"} <= {*shaft}


def test_elements_are_those_of_fmi_2(spring, native_files):
    """Of states and their derivatives, in motion; several in one call are one after the other."""
    other = Instance(native_files["valve_spring"]).initialize(load=500.0, **by_element(STARTS))
    spring.initialize(load=500.0, **STARTS)
    names = ["position", "state.coil_position", "der(state.coil_velocity)"]
    elements = ["position", "state.coil_position[1]", "state.coil_position[2]"]
    elements += ["der(state.coil_velocity[1])", "der(state.coil_velocity[2])"]
    for i in range(5):
        assert spring.get(names) == other.get(elements)
        for slave in (spring, other):
            slave.step(1e-4 * i, 1e-4)
    references = [reference(spring, name) for name in names]
    assert spring.fmu.getFloat64(references, 5) == other.get(elements)
    other.free()


def test_derivatives_by_variables_are_those_of_fmi_2(spring, native_files):
    """By start values, in the initialisation: of arrays and by arrays, forwards and backwards."""
    other = Instance(native_files["valve_spring"])
    other.fmu.setupExperiment()
    for slave, given in ((spring, STARTS), (other, by_element(STARTS))):
        slave.set(given)
        slave.fmu.enterInitializationMode()
    outputs, starts = ["acceleration", "der(state.coil_velocity)", "state.coil_position"], list(STARTS)
    outputs_2 = ["acceleration", "der(state.coil_velocity[1])", "der(state.coil_velocity[2])"]
    outputs_2 += ["state.coil_position[1]", "state.coil_position[2]"]
    of, by = ([reference(spring, name) for name in names] for names in (outputs, starts))
    of_2, by_2 = ([reference(other, name) for name in names] for names in (outputs_2, by_element(STARTS)))
    seed = [1.0, -2.0, 0.5, 3.0]
    found = spring.fmu.getDirectionalDerivative(of, by, seed, len(of_2))
    assert found == other.fmu.getDirectionalDerivative(of_2, by_2, seed)
    matrix = np.array([other.fmu.getDirectionalDerivative(of_2, [known], [1.0]) for known in by_2])
    weights = [1.0, 2.0, -1.0, 0.25, 4.0]
    adjoint = spring.fmu.getAdjointDerivative(of, by, weights, len(by_2))
    # Sums of five terms, in another order.
    assert (np.abs(adjoint - matrix @ weights) <= 5e-15 * (np.abs(matrix) @ np.abs(weights))).all()
    rates = ["position", "acceleration"]
    by_call = spring.fmu.getOutputDerivatives([reference(spring, name) for name in rates], [1, 1])
    assert by_call == spring.get([f"der({name})" for name in rates])
    other.free()


def test_states_follow_each_other_as_declared(fmi3_files):
    """In model exchange: those of arrays element by element, and their derivatives."""
    slave = Instance3(fmi3_files["valve_spring"])
    about = slave.description
    rates = [u.variable for u in about.derivatives]
    count = about.numberOfContinuousStates
    places = [(name, len(slave.variables[name].shape or ())) for name in (v.derivative.name for v in rates)]
    assert [name for name, array in places if array] == [f"state.{name}" for name in COILS]
    assert count == 6
    with slave.exchanging(**STARTS) as model:
        for variables, call in (
            ([v.derivative for v in rates], model.fmi3GetContinuousStates),
            (rates, model.fmi3GetContinuousStateDerivatives),
        ):
            vector = np.zeros(count)
            call(model.component, vector.ctypes.data_as(fmi3.POINTER(fmi3.fmi3Float64)), count)
            assert model.getFloat64([v.valueReference for v in variables], count) == vector.tolist()
    slave.free()


def test_wrong_numbers_of_values(spring):
    spring.initialize(**STARTS)
    fmu, coils, load = spring.fmu, reference(spring, "state.coil_position"), [reference(spring, "load")]
    before = spring.saved_bytes()
    said = "1 values for 1 variables, which have 2 elements"
    assert "3 values for 2 variables, which have 4 elements" in refused(
        spring, lambda: fmu.getFloat64([coils, coils], 3)
    )
    assert f"there is no value reference {coils + 1}" in refused(spring, lambda: fmu.getFloat64([coils + 1]))
    for call in (fmu.getDirectionalDerivative, fmu.getAdjointDerivative):
        assert said in refused(spring, lambda call=call: call([coils], load, [1.0], 1))
    assert spring.saved_bytes() == before
    fmu.terminate()
    fmu.reset()
    starts = reference(spring, "coil_position_start")
    assert said in refused(spring, lambda: fmu.setFloat64([starts], [1.0]))
    assert spring.get(["coil_position_start"]) == [0.0, 0.0]


def test_a_host_that_knows_no_arrays_reads_first_elements(fmi3_files):
    """As many values as variables: a warning tells it, and the scalars are right."""
    slave = Instance3(fmi3_files["valve_spring"], logging=True)
    slave.initialize(load=500.0, **STARTS)
    names = ["acceleration", "coil_position_start", "spring_force"]
    found = slave.fmu.getFloat64([reference(slave, name) for name in names], 3)
    status, _, said = slave.messages[-1]
    assert said.endswith("of arrays the first elements, without 1 others")
    assert status == WARNING
    assert found == slave.get(["acceleration", "coil_position_start[1]", "spring_force"])
    slave.free()


def test_faults_name_the_element(spring):
    said = refused(spring, lambda: spring.set({"coil_position_start": [0.0, float("nan")]}))
    assert said == "coil_position_start[2] = nan: must be finite"
    assert spring.get(["coil_position_start"]) == [0.0, 0.0]


def test_scenarios_name_elements_in_both_versions(native_files, fmi3_files, tmp_path):
    """The same lines, the same results to the last bit, of the coils and of what they do."""
    runs = []
    for fmi, files in ((2, native_files), (3, fmi3_files)):
        table = {
            "participant": files["valve_spring"],
            "parameters": {"coil_position_start[2]": 1e-4, "coil_velocity_start[1]": 0.3},
            "inputs": {"load": 500.0},
        }
        folder = tmp_path / str(fmi)
        runs.append(ran(scenario({"spring": table}, stop_time=1e-3, macro_step=1e-5), folder)[1])
    assert "spring.coil_position[2]" in runs[0]
    assert runs[0]["spring.coil_position[2]"][0] == 1e-4
    for name in ("time", "spring.position", "spring.coil_position[1]", "spring.coil_position[2]"):
        np.testing.assert_array_equal(runs[0][name], runs[1][name])
