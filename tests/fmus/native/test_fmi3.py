"""Native FMUs of FMI 3.0: the component to the last bit, and what those of FMI 2.0 can do."""

from __future__ import annotations

import re
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.model_description import ModelDescription, ScalarVariable

from fmus.fmi.validate import validate
from fmus.native.machine_code import this_platform

from ..conftest import Isolated
from ..instance import Instance, Instance3
from ..names import mark_long
from ..reference import Reference, held, schedule, wave
from ..test_agreement import STEP, STEPS, expected_of, replay
from .names import EVERY, FAST
from .test_exchange import MOTIONS, TOLERANCE, simulated

Files = dict[str, Path]


@pytest.mark.parametrize("name", EVERY)
def test_it_equals_the_component(name: str, fmi3_files: Files, isolated: Isolated, tmp_path: Path) -> None:
    """Outputs, their rates and energies; also between steps, and with steps of changing size."""
    reference = Reference(name)
    plan = schedule(reference.component, STEPS, STEP)
    assert replay(isolated, fmi3_files[name], plan, tmp_path, "Instance3") == expected_of(reference, plan)


@pytest.mark.parametrize("name", EVERY)
def test_validators_find_nothing(name: str, fmi3_files: Files) -> None:
    assert validate(fmi3_files[name]) == []


@pytest.mark.parametrize("name", mark_long(["flywheel", "slider_crank"], FAST))
def test_fmutool_finds_no_fault(name: str, fmi3_files: Files) -> None:
    pytest.importorskip("fmu_manipulation_toolbox", reason="fmu-manipulation-toolbox is not installed")
    tool = Path(sys.executable).with_name("fmutool")
    command = [str(tool), "-input", str(fmi3_files[name]), "-check"]
    finished = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    said = finished.stdout + finished.stderr
    assert "seems to be compliant with FMI-3.0" in said
    assert "No semantic error" in said


@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
@pytest.mark.parametrize("name", EVERY)
def test_a_host_runs_it(name: str, kind: str, fmi3_files: Files) -> None:
    """As it is, in both of its kinds; all that it tells are numbers."""
    result = fmpy.simulate_fmu(str(fmi3_files[name]), fmi_type=kind, stop_time=1e-3, output_interval=1e-4)
    assert result["time"][-1] == pytest.approx(1e-3)
    assert all(np.isfinite(result[output]).all() for output in result.dtype.names)


@pytest.mark.parametrize("name", EVERY)
def test_variables_are_those_of_fmi_2(name: str, native_files: Files, fmi3_files: Files) -> None:
    """And besides them time and what indicates events, which FMI 3.0 has as variables. Vectors are arrays."""
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


@pytest.mark.parametrize("name", mark_long(["camshaft", "ehl_contact", "slider_crank"], ["ehl_contact"]))
def test_derivatives_by_variables(name: str, native_files: Files, fmi3_files: Files) -> None:
    """Directional ones are those of FMI 2.0; the adjoint ones are the same matrix, transposed."""
    slaves = [Instance(native_files[name]), Instance3(fmi3_files[name])]
    component = Reference(name).component
    values = held(wave(component, 1e-3))
    for slave in slaves:
        slave.initialize(1e-3, **values)
    outputs, inputs = (
        [v.valueReference for n in names if (v := slaves[0].variables[n]).type == "Real"]
        for names in ([*slaves[0].names("output"), "stored_energy"], component.inputs.names)
    )
    old, new = (
        np.array([slave.fmu.getDirectionalDerivative(outputs, [u], [1.0]) for u in inputs])
        for slave in slaves
    )
    np.testing.assert_array_equal(old, new)
    seed = [float(i % 3) - 1.0 for i in range(len(outputs))]
    adjoint = slaves[1].fmu.getAdjointDerivative(outputs, inputs, seed, len(inputs))
    # Sums of as many terms as there are outputs, in another order.
    allowed = 1e-15 * len(outputs) * (np.abs(new) @ np.abs(seed))
    assert (np.abs(new @ seed - adjoint) <= allowed).all()
    rates = [f"der({f.name})" for f in component.outputs.fields if not f.quantity.discrete]
    references = [slaves[1].variables[rate[4:-1]].valueReference for rate in rates]
    assert slaves[1].fmu.getOutputDerivatives(references, [1] * len(rates)) == slaves[1].get(rates)
    for slave in slaves:
        slave.free()


@pytest.mark.long
def test_event_indicators_have_derivatives(fmi3_files: Files) -> None:
    """Between the walls they are the distances to the upper and the lower one."""
    slave = Instance3(fmi3_files["slider_crank"])
    slave.fmu.enterInitializationMode()
    names = ["event_indicator[1]", "event_indicator[2]", "event_indicator[3]", "stored_energy"]
    unknown = [slave.variables[name].valueReference for name in names]
    known = [slave.variables["psi_start"].valueReference]
    assert slave.fmu.getDirectionalDerivative(unknown, known, [2.0])[:3] == [-2.0, 2.0, 0.0]
    slave.free()


@pytest.mark.parametrize("name", mark_long(["valve_spring", "slider_crank", "ehl_contact"], FAST))
def test_a_saved_state_brings_the_same_motion(name: str, fmi3_files: Files) -> None:
    """In the same instance, and from bytes in another."""
    component = Reference(name).component
    slave, other = Instance3(fmi3_files[name]).initialize(), Instance3(fmi3_files[name]).initialize()

    def go_on(one: Instance3) -> list[float]:
        for i in range(10, 20):
            one.set(wave(component, i * STEP))
            one.step(i * STEP, STEP)
        return one.outputs()

    for i in range(10):
        slave.set(wave(component, i * STEP))
        slave.step(i * STEP, STEP)
    state, data = slave.save(), slave.saved_bytes()
    first = go_on(slave)
    slave.restore(state)
    assert go_on(slave) == first
    other.restore_bytes(data)
    assert go_on(other) == first
    slave.fmu.freeFMUState(state)
    for one in (slave, other):
        one.free()


@pytest.mark.parametrize("name", mark_long(MOTIONS, FAST))
def test_the_hosts_integrator_finds_the_same_motion(name: str, fmi3_files: Files) -> None:
    """As with FMI 2.0: at the end, and everywhere but about impacts, whose instants differ."""
    start, stop = MOTIONS[name]
    described = fmpy.read_model_description(str(fmi3_files[name]))
    names = [u.variable.name for u in described.outputs if not u.variable.name.startswith("der(")]
    host, own = (
        simulated(fmi3_files[name], kind, start, stop, names) for kind in ("ModelExchange", "CoSimulation")
    )
    for output in names:
        differences = np.abs(host[output].astype(float) - own[output].astype(float))
        size = np.abs(own[output].astype(float)).max() + 1e-12
        assert np.median(differences) <= 1e4 * TOLERANCE * size, output
        assert differences[-1].max() <= 1e5 * TOLERANCE * size, output


def test_choices_counts_and_truths_have_types_of_their_own(fmi3_files: Files) -> None:
    described = fmpy.read_model_description(str(fmi3_files["slider_crank"]))
    kinds = {v.name: v.type for v in described.modelVariables}
    assert (kinds["form"], kinds["event_count"]) == ("Enumeration", "Int32")
    slave = Instance3(fmi3_files["slider_crank"])
    slave.set({"form": 1.0})
    assert slave.get(["form", "event_count", "time"]) == [1.0, 0.0, 0.0]
    slave.free()


def test_it_has_a_library_for_this_machine(fmi3_files: Files) -> None:
    with zipfile.ZipFile(fmi3_files["flywheel"]) as archive:
        folders = {name.split("/")[1] for name in archive.namelist() if name.startswith("binaries/")}
    assert folders == {this_platform()}
