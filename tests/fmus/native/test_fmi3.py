"""Native FMUs of FMI 3.0: the component to the last bit, and what those of FMI 2.0 can do."""

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import fmpy
import pytest
from fmpy.model_description import ModelDescription, ScalarVariable

from fmus.fmi.validate import validate

from ..conftest import Isolated
from ..instance import Instance3
from ..names import mark_long
from ..reference import Reference, schedule, wave
from ..test_agreement import STEP, STEPS, expected_of, replay
from .names import EVERY

Files = dict[str, Path]


@pytest.mark.parametrize("name", EVERY)
def test_it_equals_the_component(name: str, fmi3_files: Files, isolated: Isolated, tmp_path: Path) -> None:
    """Outputs, their rates and energies; also between steps, and with steps of changing size."""
    reference = Reference(name)
    plan = schedule(reference.component, STEPS, STEP)
    assert replay(isolated, fmi3_files[name], plan, tmp_path, "Instance3") == expected_of(reference, plan)


@pytest.mark.long
@pytest.mark.parametrize("name", mark_long(["flywheel", "slider_crank"], ["flywheel"]))
def test_fmutool_finds_no_fault(name: str, fmi3_files: Files) -> None:
    pytest.importorskip("fmu_manipulation_toolbox", reason="fmu-manipulation-toolbox is not installed")
    tool = Path(sys.executable).with_name("fmutool")
    command = [str(tool), "-input", str(fmi3_files[name]), "-check"]
    finished = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    said = finished.stdout + finished.stderr
    assert "seems to be compliant with FMI-3.0" in said
    assert "No semantic error" in said


@pytest.mark.parametrize("name", EVERY)
def test_variables_are_those_of_fmi_2(name: str, native_files: Files, fmi3_files: Files) -> None:
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


@pytest.mark.parametrize("name", mark_long(["valve_spring", "slider_crank", "ehl_contact"], ["valve_spring"]))
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
