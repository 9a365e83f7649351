"""Other tools run our packages, and come to what our own simplest master comes to."""

import hashlib
import re
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from pyssp_standard.srmd import SRMD

from interop.processes import explain_missing
from models.oscillators.two_masses import CoupledMassParameters, SprungMassParameters
from orchestrator.masters import Jacobi
from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.run.plan import make_plan, open_participants
from orchestrator.run.simulation import simulate
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.files import load
from orchestrator.scenario.ssp import export
from orchestrator.scenario.system import resolve
from tests.fmus.conftest import isolated
from tests.fmus.names import mark_long
from tests.models.exact_oscillators import two_masses
from tests.orchestrator.commands import called
from tests.orchestrator.coupled import Recorder
from tests.third_party.runs import find_texts, never, public, recorded
from tribocosim.cached_fmus import build_fmu

from .packages import binding, component, connection, package, task_schema

__all__ = ["isolated"]

STEPS, STEP = 100, 2e-3
# As in the scenario.
FIRST = CoupledMassParameters(mass=5.0, stiffness=0.0, damping=0.0, coupling_damping=0.0)
SECOND = SprungMassParameters(mass=1.0, stiffness=0.0, damping=0.0)
START = np.array([1.0, 0.0, 0.0, 0.0])
NAMES = ["position", "velocity"]

LIBCOSIM = """
import zipfile
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver

zipfile.ZipFile({path!r}).extractall("package")
execution = CosimExecution.from_ssp_file("package")  # with the step of the package
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
assert execution.step(step_count={steps})
found = []
for name in ("first", "second"):
    index = execution.slave_index_from_instance_name(name)
    references = {{v.name.decode(): v.reference for v in execution.slave_variables(index)}}
    found += observer.last_real_values(index, [references[name] for name in {names}])
report(found)
"""

# ecos applies the parameter sets of a name that it is given.
ECOS = """
from ecospy import EcosSimulation

with EcosSimulation(step_size={step}, ssp_path={path!r}) as simulation:
    assert simulation.init(parameter_set="values")
    simulation.step({steps})
    report([simulation.get_real(part + "::" + name) for part in ("first", "second") for name in {names}])
"""

# fmpy's loop sets parameters only where it is given them, records a step too early, and begins with inputs
# that are zero.
FMPY = """
import zipfile
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import ParameterSet, Parameter, read_ssv

values = ParameterSet()
for part in ("first", "second"):
    with zipfile.ZipFile({path!r}) as archive:
        archive.extract("resources/" + part + ".ssv")
    for one in read_ssv("resources/" + part + ".ssv").parameters:
        values.parameters.append(Parameter(name=part + "." + one.name, type=one.type, value=one.value))
rows = []
for step in ({step}, {step} / 2, {step} / 4):
    found = simulate_ssp({path!r}, stop_time={stop} + step / 2, step_size=step, parameter_set=values)
    assert abs(found["time"][-1] - {stop}) < step / 2
    rows.append([float(found[part + "." + name][-1]) for part in ("first", "second") for name in {names}])
report(rows)
"""


@pytest.fixture(scope="module")
def scenario():
    return load("two-masses", [f"macro_step={STEP}", f"stop_time={STEPS * STEP}"])


@pytest.fixture(scope="module")
def exported(scenario, tmp_path_factory):
    path = tmp_path_factory.mktemp("package") / "two-masses.ssp"
    export(scenario, path, build_fmu)
    return path


@pytest.fixture(scope="module")
def expected(scenario):
    """After these steps of Jacobi's master with held inputs, over our own FMUs."""
    plan, recorder = make_plan(resolve(scenario), build_fmu, Reporter()), Recorder()
    with open_participants(plan.system, plan.participants) as units:
        simulate(plan.system, units, Jacobi("hold"), STEP, STEPS * STEP, [recorder])
    return [recorder[f"{part}.{name}"][-1] for part in ("first", "second") for name in NAMES]


@pytest.mark.parametrize(("tool", "code"), [("libcosim", LIBCOSIM), ("ecos", ECOS)], ids=["libcosim", "ecos"])
def test_another_tool_comes_to_the_same(tool, code, exported, expected, isolated, record):
    """To the times of steps, which some count in nanoseconds or add up: 1e-9 of a value that moves by itself
    in a second."""
    if why := explain_missing(tool, Path(sys.executable)):
        pytest.skip(why)
    found = isolated(code.format(path=str(exported), steps=STEPS, step=STEP, names=NAMES))
    quantity = f"two masses as an SSP package in {tool}"
    record("Tools", quantity, found, expected, "run by tribocosim", relative=1e-9)


def test_fmpys_loop_converges_to_the_same(exported, isolated, record):
    """With the first order of held inputs: halving its step halves what is missing of the exact motion."""
    stop = STEPS * STEP
    rows = isolated(FMPY.format(path=str(exported), step=STEP, stop=stop, names=NAMES))
    truth = two_masses(np.array([stop]), FIRST, SECOND, START)[0]
    missed = [np.abs(np.array(row) - truth).max() for row in rows]
    orders = np.log2(np.array(missed[:-1]) / missed[1:])
    quantity = "two masses as an SSP package in fmpy: order"
    record("Tools", quantity, orders, 1.0, "order of held inputs", tolerance=0.1)


@pytest.mark.parametrize("name", mark_long(["algebraic_loop_1", "algebraic_loop_3", "demo"], ["demo"]))
def test_a_public_package_runs(name, tmp_path):
    """Its first hundred macro steps. The metadata of the run beside its package are SSP Traceability's."""
    path = str(public(f"ssp/{name}.ssp"))
    step = load(path).macro_step
    one = load(path, [f"stop_time={100 * step!r}"])
    assert one.name != "ssp"  # as its tool calls all
    summary = run(one, tmp_path / "out", never, Reporter(), figures=False)
    assert summary.complete, summary.message
    found = recorded(tmp_path / "out")
    assert len(found["time"]) == 101
    assert all(np.all(np.isfinite(column)) for column in found.values())
    changed = called("ssp", "export", str(tmp_path / "out"), "--set=stop_time=1")
    assert changed.returncode == 2
    assert "--set: the run in" in changed.stderr
    made = tmp_path / "made.ssp"
    shown = called("ssp", "export", str(tmp_path / "out"), "--out", str(made))
    task = made.with_suffix(".stmd")
    assert shown.stdout.split() == [str(made), str(made.with_suffix(".srmd")), str(task)], shown.stderr
    metadata = SRMD(made.with_suffix(".srmd"))
    metadata.__check_compliance__()
    told = {one.classification_type: one.classification_entries for one in metadata.classifications}
    ended = {one.keyword: one.text for one in told["tribocosim.run"]}
    assert ended["verdict"] == str(summary.verdict)
    assert ended["exit_status"] == str(summary.exit_status)
    assert ended["macro_step"] == f"{step!r} s"
    assert "largest_error" not in ended  # there is no reference
    assert {one.keyword: one.text for one in told["tribocosim.fmu-sha256"]} == summary.fmus
    files = [(one.link, one.text) for one in told["tribocosim.file-sha3-256"]]
    assert {"out/result.nc", "out/scenario.toml", "out/summary.json"} <= {link for link, _ in files}
    for link, digest in [*files, (metadata.data, metadata.checksum)]:
        assert hashlib.sha3_256((tmp_path / link).read_bytes()).hexdigest() == digest, link
    task_schema().validate(str(task))
    named = [one.get("source") for one in ElementTree.parse(task).iter() if one.get("source")]
    assert sorted(named) == sorted(["made.ssp", "made.srmd", *(link for link, _ in files)])


def test_a_public_package_for_another_system_is_refused(tmp_path):
    one = load(str(public("ssp/quarter-truck.ssp")))
    with pytest.raises(ScenarioError, match=r"chassis.*has no binary for .* \(it has win32, win64\)"):
        run(one, tmp_path / "out", never, Reporter(), figures=False)
    assert not (tmp_path / "out").exists()


def test_a_public_package_runs_or_names_the_library_that_lacks(tmp_path):
    """Its FMUs need a C++ library that not every system has."""
    path = str(public("ssp/scenario_parameter.ssp"))
    one = load(path, [f"stop_time={10 * load(path).macro_step!r}"])
    try:
        said = run(one, tmp_path / "out", never, Reporter(), figures=False).message
    except ScenarioError as error:
        said = str(error)
        assert not (tmp_path / "out").exists()
    assert not said or re.search(r"scenario: instantiate: .*GLIBC", said)


def test_integers_and_enumerations_of_a_package_pass_as_numbers(tmp_path, caplog):
    """With a notice: other tools connect them. In a scenario a factor says so."""
    ports = {"Int32_output": "output", "Enumeration_input": "input", "Int32_input": "input"}
    values = binding({"Int32_input": 'Integer value="2"'})
    path = package(
        tmp_path / "a.ssp",
        component("one", "through", ports, values) + component("two", "through", ports),
        connection("one.Int32_output", "two.Enumeration_input"),
        files={"resources/through.fmu": public("reference-fmus-3/Feedthrough.fmu").read_bytes()},
    )
    with caplog.at_level("WARNING"):
        one = load(str(path), ["stop_time=0.2", "macro_step=0.1"])
    assert one.connections == ["one.Int32_output * 1.0 -> two.Enumeration_input"]
    assert "the number goes as it is, from Int32 to Enumeration" in caplog.text
    assert run(one, tmp_path / "out", never, Reporter(), figures=False).complete
    assert recorded(tmp_path / "out")["two.Enumeration_output"][-1] == 2.0


def test_texts_of_a_package_pass_and_have_values(tmp_path):
    """Strings and binary values, given in a set and connected."""
    kinds = {f"{kind}_{end}put": f"{end}put {kind}" for kind in ("String", "Binary") for end in ("in", "out")}
    values = binding({"String_input": 'String value="so"', "Binary_input": 'Binary value="00ff"'})
    path = package(
        tmp_path / "a.ssp",
        component("one", "through", kinds, values) + component("two", "through", kinds),
        "".join(connection(f"one.{kind}_output", f"two.{kind}_input") for kind in ("String", "Binary")),
        files={"resources/through.fmu": public("reference-fmus-3/Feedthrough.fmu").read_bytes()},
    )
    one = load(str(path), ["stop_time=0.1", "macro_step=0.1"])
    assert one.connections == [
        "one.String_output -> two.String_input",
        "one.Binary_output -> two.Binary_input",
    ]
    assert find_texts(one, "two", ["String_output", "Binary_output"]) == ["so", "00ff"]


def test_the_lines_of_the_guide_run_a_package_in_fmpy(exported, isolated):
    """To the first order of held inputs."""
    guide = Path("docs/how-to/exchange-ssp.md").read_text("utf-8")
    code = re.findall(r"```python\n(.+?)```", guide, re.DOTALL)[0].replace("two-masses.ssp", str(exported))
    found = isolated(
        f'{code}\nreport([float(found[f"{{part}}.position"][-1]) for part in ("first", "second")])'
    )
    truth = two_masses(np.array([STEPS * STEP]), FIRST, SECOND, START)[0]
    assert found == pytest.approx(truth[[0, 2]], abs=0.02)
