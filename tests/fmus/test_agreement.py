"""A packaged FMU gives the numbers of the component to the last bit."""

from pathlib import Path

import pytest
from fmpy import read_model_description

from fmus.build import NAMES, build

from .conftest import Isolated
from .kinds import FAST, FILES, HOSTS, every_fmu
from .names import LAYER, mark_long
from .reference import Reference, held, schedule, split, wave

STEPS, STEP = 300, 1e-5

REPLAY = """
import json, sys
plan = json.load(open({plan!r}))
slave = {host}({fmu!r}).initialize(plan[0]["t"])
results = [slave.outputs()]
for step in plan:
    slave.set(step["inputs"])
    results.append(slave.outputs())
    slave.step(step["t"], step["h"])
    results.append(slave.outputs())
roots = {{name.partition(".")[0] for name in sys.modules}}
ours = sorted(roots & {{"models", "fmus", "orchestrator", "pythonfmu"}})
slave.free()
report([results, ours])
"""


def replay(
    isolated: Isolated, fmu: Path, plan: list, folder: Path, host: str = "Instance"
) -> list[list[float]]:
    import json

    file = folder / "plan.json"
    file.write_text(json.dumps(plan))
    results, ours = isolated(REPLAY.format(plan=str(file), fmu=str(fmu), host=host))
    assert ours == []
    return results


def expected_of(reference: Reference, plan: list) -> list[list[float]]:
    """What the replay reports of an FMU that moves as the component in this process."""
    reference.set_inputs({})
    expected = [reference.outputs()]
    for step in plan:
        reference.set_inputs(step["inputs"])
        expected.append(reference.outputs())
        reference.t = step["t"]
        reference.step(step["h"])
        expected.append(reference.outputs())
    return expected


@pytest.mark.parametrize(
    ("kind", "name"),
    every_fmu(
        [*NAMES, LAYER],
        python=("valve_spring", "flywheel", LAYER),
        native=FAST,
        native3=FAST,
    ),
)
def test_an_fmu_equals_its_component(kind, name, isolated, tmp_path, record):
    """Outputs, their rates and energies, also between steps, where outputs follow inputs at once, and with
    steps of changing size."""
    reference = Reference(name)
    plan = schedule(reference.component, STEPS, STEP)
    found = replay(isolated, FILES[kind][name], plan, tmp_path, HOSTS[kind].__name__)
    expected = expected_of(reference, plan)
    record(
        "FMUs", "outputs, rates and energies of FMUs", found, expected, "component in process", tolerance=0
    )


def test_structure_is_fixed_at_build(isolated, tmp_path):
    fmu = build("valve_spring", tmp_path / "five.fmu", {"coil_masses": 5})
    code = f"""
    slave = Instance({str(fmu)!r}).initialize(load=1e3)
    slave.step(0.0, 1e-5)
    report([slave.names("output"), slave.get(["coil_position[5]", "position"])])
    """
    names, (last_coil, follower) = isolated(code, "numba")
    expected = Reference("valve_spring", coil_masses=5).component.outputs.names
    assert names == [*expected, *(f"der({name})" for name in expected)]
    assert 0.0 < last_coil < follower


def test_start_time(isolated, fmu_files, tmp_path):
    """A flywheel on its ramp shows what time the FMU takes it to be."""
    code = f"""
    slave = Instance({str(fmu_files["flywheel"])!r})
    slave.initialize(0.25, final_speed=204.0, initial_speed=4.0)
    first = slave.get(["speed"])
    slave.step(0.25, 0.25)
    report([first, slave.get(["speed"])])
    """
    assert isolated(code) == [[54.0], [104.0]]


@pytest.mark.parametrize("name", mark_long(NAMES))
def test_outputs_depend_on_declared_inputs_only(name):
    """What the FMU declares comes from `feedthrough`; an undeclared input changes no bit of the output."""
    reference = Reference(name)
    component = reference.component
    for t in (0.0, 3e-4, 7e-4):
        values = held(wave(component, t))
        reference.set_inputs(values)
        before = component.outputs.named(reference.y)
        for changed in component.inputs.names:
            reference.set_inputs(values | {changed: values[changed] * 1.01 + 1e-3})
            after = component.outputs.named(reference.y)
            moved = {output for output in before if before[output] != after[output]}
            declared = {output for output in before if changed in component.feedthrough.get(output, ())}
            assert moved <= declared, f"{changed} changes {moved - declared}"


@pytest.mark.parametrize("name", mark_long(NAMES))
def test_rates_depend_on_declared_inputs_only(name, fmu_files):
    """As the outputs: an undeclared input or slope changes no bit of the rate."""
    reference = Reference(name)
    described = read_model_description(str(fmu_files[name]))
    declared = {u.variable.name: {v.name for v in u.dependencies} for u in described.outputs}
    rates = [
        f"der({field.name})" for field in reference.component.outputs.fields if not field.quantity.discrete
    ]
    values = wave(reference.component, 3e-4)
    reference.set_inputs(values)
    before = dict(zip(rates, reference.rates(), strict=True))
    for changed in values:
        reference.set_inputs(values | {changed: values[changed] * 1.01 + 1e-3})
        after = dict(zip(rates, reference.rates(), strict=True))
        # How a rate is rounded depends on the pace of all that moves.
        moved = {r for r in rates if abs(after[r] - before[r]) > 1e-6 * (1.0 + abs(before[r]))}
        assert moved <= {r for r in rates if changed in declared[r]}, f"{changed} changes {moved}"


def test_derivatives_of_indexed_inputs_have_structured_names():
    assert split("load_torque_der2[1]") == ("load_torque[1]", 2)
