"""What FMUs cannot do is refused; what they say that they can is tried before the run depends on it."""

import re
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
import pytest

import tribocosim
from fmus.fmi.validate import validate
from orchestrator.errors import RecoverableError
from orchestrator.participants import proven
from orchestrator.participants.description import DescriptionError, read_description
from orchestrator.participants.third_party import read_component
from orchestrator.scenario import Scenario, ScenarioError, build_scenario
from orchestrator.scenario.files import list_shipped, read_contents, to_full_toml
from orchestrator.scenario.system import build_system
from orchestrator.scenario.warnings import list_warnings
from orchestrator.texts import parse_toml

from ..archives import rename_files, replace_text
from .c_fmus import describe2, describe3, fmu, real2
from .runs import completed, ran, scenario

VERSIONS = (2, 3)

REFUSED: dict[str, tuple[str, dict[str, Any], str]] = {
    "fraction": ("feedthrough", {"own": {"parameters": {"count": 1.5}}}, r"count = 1\.5 .*must be"),
    "reference": (
        "dahlquist",
        {"reference": {"method": "monolithic"}, "tolerance": {"one.x": 1e-3}},
        "set reference.method = 'refinement'",
    ),
    "equilibrium": ("dahlquist", {"start": "equilibrium"}, r"set start = 'given'"),
    "unit": ("shaft", {"connections": ["one.speed -> one.height"]}, r"r/min does not fit mm; .*\* 1 ->"),
    "kind": ("feedthrough", {"connections": ["one.real out -> one.whole_in"]}, "takes whole numbers"),
    "not restorable": ("rigid", {"master": {"name": "iterated"}}, r"canGetAndSetFMUstate = false.*jacobi"),
    "control": ("rigid", {"step_control": {}}, r"\[step_control\].*set step_control.estimator"),
    "located": ("rigid", {"event_tolerance": 1e-6}, "event_tolerance.*leave it out"),
    "retried": ("rigid", {"own": {"retries": 2}}, "one length only.*retries varies"),
    "last step": ("rigid", {"macro_step": 0.3}, "no whole multiple of macro_step = 0.3 s"),
    "arrow": ("dahlquist", {"connections": ["one.x * 2 -> k"]}, r"or with numbers"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_an_fmu_cannot_do_is_refused_before_the_run(case, tmp_path):
    name, changes, said = REFUSED[case]
    tables = {"one": {"participant": fmu(name, 2, tmp_path), **changes.get("own", {})}}
    more = {key: value for key, value in changes.items() if key != "own"}
    with pytest.raises(ValueError, match=said):
        ran(scenario(tables, **more), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_no_equilibrium_is_sought_where_connections_change_values():
    """One without the factor would be of another system."""
    content = read_contents(list_shipped()["two-masses"]) | {"start": "equilibrium"}
    content["connections"] = ["first.force * 2 -> second.force"]
    with pytest.raises(ScenarioError, match="changes values; set start = 'given'"):
        build_system(build_scenario(content))


@pytest.mark.parametrize("version", VERSIONS)
def test_a_file_for_another_platform_is_refused(version, tmp_path):
    path = fmu("dahlquist", version, tmp_path)
    (folder,) = (name.split("/")[1] for name in ZipFile(path).namelist() if name.startswith("binaries/"))
    other = rename_files(path, tmp_path / "other.fmu", folder, "vax")
    with pytest.raises(ScenarioError, match=r"has no binary for \S+ \(it has vax\)"):
        build_system(scenario({"one": {"participant": other}}))


def test_variables_of_one_name_are_refused(tmp_path):
    path = replace_text(fmu("dahlquist", 3, tmp_path), tmp_path / "twice.fmu", 'name="k"', 'name="x"')
    with pytest.raises(ScenarioError, match=rf"{path}: has two variables of the name 'x' .*of its own"):
        scenario({"one": {"participant": path}})
    assert any("'x'" in fault or '"x"' in fault for fault in validate(path))


def test_variables_of_one_reference_are_one(tmp_path):
    """Aliases of FMI 2.0."""
    path = fmu("named", 2, tmp_path)
    alias = replace_text(path, tmp_path / "alias.fmu", 'valueReference="1"', 'valueReference="0"')
    _, found = ran(scenario({"one": {"participant": alias}}), tmp_path / "out")
    first, second = (values for name, values in found.items() if name != "time")
    np.testing.assert_array_equal(first, second)


def test_two_of_an_fmu_that_fills_its_process_take_processes_of_their_own(tmp_path):
    path = fmu("single", 2, tmp_path)
    twice = {"one": {"participant": path}, "other": {"participant": path}}
    with pytest.raises(ScenarioError, match=r"one instance.*set components\.\w+\.process = 'own'"):
        ran(scenario(twice), tmp_path / "out")
    twice["other"] = {"participant": path, "process": "own"}
    found = completed(scenario(twice), tmp_path / "out")
    np.testing.assert_array_equal(found["one.x"], found["other.x"])


Y = real2("y", 0, "output")


def with_unknown(attributes: str) -> dict[str, str]:
    return {"variables": Y, "structure": f"<Outputs><Unknown {attributes}/></Outputs>"}


def with_real(attributes: str) -> dict[str, str]:
    return {"variables": real2("y", 0, "output", attributes)}


# What is described, or the text that replaces another one in the description; and what is said.
FAULTS: dict[str, tuple[dict[str, str] | tuple[str, str], str]] = {
    "index": (with_unknown('index="9"'), "Unknown has index = '9', which must be from 1 to 1"),
    "no number": (with_unknown('index="one"'), "index = 'one', which must be a whole number"),
    "no index": (with_unknown(""), "the element Unknown lacks the attribute index"),
    "dependencies": (with_unknown('index="1" dependencies="7"'), "= '7', which must be from 1 to 1"),
    "index 0": (with_unknown('index="0"'), "index = '0', which must be from 1"),
    "start": (with_real('start="0,5"'), "'y' has start = '0,5', which must be a"),
    "not a number": (with_real('nominal="NaN"'), "nominal = 'NaN', which must be a"),
    "type": (with_real('declaredType="length"'), "'y' has declaredType = 'length', which Type"),
    "derivative": (with_real('derivative="4"'), "'y' has derivative = '4', which must be from"),
    "time": (
        {"variables": Y, "head": '<DefaultExperiment stepSize="fast"/>'},
        "stepSize = 'fast', which must be a number",
    ),
    "guid": (('guid="g"', ""), "fmiModelDescription lacks the attribute guid"),
    "reference": (('valueReference="0"', ""), "ScalarVariable 'y' lacks the attribute valueReference"),
    "name": (('ScalarVariable name="y"', "ScalarVariable"), "the element ScalarVariable lacks the attribute"),
    "version": (('fmiVersion="2.0"', ""), "fmiModelDescription lacks the attribute fmiVersion"),
    "ability": (('FMUstate="true"', 'FMUstate="yes"'), "= 'yes', which must be true or false"),
}


@pytest.mark.parametrize(("changes", "said"), FAULTS.values(), ids=FAULTS)
def test_the_attribute_is_named(changes, said, tmp_path):
    if isinstance(changes, dict):
        path = describe2(tmp_path / "one.fmu", **changes)
    else:
        path = replace_text(describe2(tmp_path / "one.fmu", Y), tmp_path / "other.fmu", *changes)
    with pytest.raises(DescriptionError, match=f"{said}.*, in its modelDescription.xml"):
        read_description(path)


def test_a_start_that_is_not_a_number_is_none(tmp_path):
    """As tools state that a value is unknown."""
    path = describe2(tmp_path / "one.fmu", real2("y", 0, "output", 'start="NaN" initial="approx"'))
    assert read_component(path).outputs.field("y").start == 0.0


def test_the_attribute_of_fmi_3_is_named(tmp_path):
    variable = '<Float64 name="y" valueReference="0" causality="output" derivative="7"/>'
    with pytest.raises(DescriptionError, match="'y' has derivative = '7', which is the valueReference of no"):
        read_description(describe3(tmp_path / "one.fmu", variable))


HOLD = {"master": {"name": "jacobi", "extrapolation": "hold"}}


def forgetful(version: int, folder: Path, process: str = "shared", **changes: Any) -> Scenario:
    """With an FMU that counts the time, and restores all but its count."""
    tables = {
        "decay": {"participant": fmu("dahlquist", version, folder)},
        "one": {
            "participant": fmu("forgetful", version, folder),
            "process": process,
            **changes.pop("one", {}),
        },
    }
    return scenario(tables, connections=["decay.x -> one.u"], stop_time=0.2, **changes)


@pytest.mark.parametrize(
    ("version", "process", "changes"),
    [
        (2, "own", {}),
        (3, "shared", {"master": {"name": "jacobi", "extrapolation": "quadratic"}}),
        (2, "shared", HOLD | {"checkpoint_every": 30}),
    ],
)
def test_an_fmu_that_saves_a_part_of_its_state_is_not_taken_back(version, process, changes, tmp_path):
    summary, found = ran(forgetful(version, tmp_path, process, **changes), tmp_path / "out")
    np.testing.assert_allclose(found["one.passed"], found["time"], rtol=1e-13)
    (told,) = [str(line) for line in summary.tell() if "come back" in str(line)]
    assert told.startswith("one: the FMU does not come back to the state that it saved, though it says so")
    assert "passed is 0.02 after a step of 0.01 s that was 0.01 the first time" in told


@pytest.mark.parametrize(
    ("changes", "remedy"),
    [
        ({"master": {"name": "iterated"}}, "the master iterated repeats steps; take the master jacobi or"),
        ({"step_control": {"estimator": "step_doubling"}}, r"\[step_control\] repeats steps; leave it out"),
    ],
)
def test_it_is_refused_where_steps_have_to_be_taken_back(changes, remedy, tmp_path):
    with pytest.raises(ScenarioError, match=rf"passed is 0\.02 .* but {remedy}"):
        ran(forgetful(2, tmp_path, **changes), tmp_path / "out")


def test_what_is_kept_of_inputs_that_begin_with_zero_is_found(tmp_path):
    """A sum of the input's values over the steps, that the FMU does not save."""
    tables = {name: {"participant": fmu(model, 2, tmp_path)} for name, model in
              {"decay": "dahlquist", "one": "collecting"}.items()}  # fmt: skip
    one = scenario(tables, connections=["decay.x * 1 - 1 -> one.u"], stop_time=0.2, step_control={})
    with pytest.raises(
        ScenarioError, match=r"passed is 0\.02 .* was 0\.01 the first time; but \[step_control"
    ):
        ran(one, tmp_path / "out")


def test_the_trial_leaves_no_trace(tmp_path):
    """An FMU that has been tried, for its checkpoints, runs as one that has not, to the last bit."""
    tables = {"decay": {"participant": fmu("dahlquist", 3, tmp_path)}}
    found = []
    for every in (30, 0):
        one = scenario(tables, checkpoint_every=every, **HOLD)
        summary, columns = ran(one, tmp_path / str(every))
        assert not [line for line in summary.tell() if "come back" in str(line)]
        found.append(columns["decay.x"])
    np.testing.assert_array_equal(*found)


def test_a_false_claim_to_take_derivatives_is_named_with_what_helps(tmp_path):
    tables = {
        "decay": {"participant": fmu("dahlquist", 2, tmp_path)},
        "integral": {"participant": fmu("claiming", 2, tmp_path)},
    }
    connected = {"connections": ["decay.x -> integral.u"]}
    summary, _ = ran(scenario(tables, **connected), tmp_path / "out")
    assert "integral: setting the derivatives of the inputs returned Error" in str(summary.message)
    assert "(canInterpolateInputs); set master.extrapolation = 'hold'" in str(summary.message)
    assert ran(scenario(tables, **connected, **HOLD), tmp_path / "hold")[0].complete


def test_third_party_fmus_alone_begin_as_given_unless_they_are_told_otherwise(tmp_path):
    tables = {"one": {"participant": fmu("dahlquist", 2, tmp_path)}}
    content = scenario(tables).model_dump(exclude_defaults=True)
    del content["start"]
    made = build_scenario(content)
    assert made.start == "given"
    assert [line for line in list_warnings(made) if "start" in line] == made.notes != []
    assert build_scenario(parse_toml(to_full_toml(made))).notes == []
    with pytest.raises(ScenarioError, match="set start = 'given'"):
        build_system(build_scenario(content | {"start": "equilibrium"}))


# What of an FMU fails that is tried: in which version of FMI, and what is said.
FAILING = {
    "unready": (2, "co-simulation: initialise: .*not ready"),
    "blind": (3, "co-simulation: its process ended by SIGSEGV in the reading of outputs$"),
    "unreadable": (2, "co-simulation: reading the outputs returned -1"),
    "unstepped": (
        2,
        "co-simulation: step from t = 0 s by 0.01 s returned 7, which is no status of FMI: no message$",
    ),
}


@pytest.mark.parametrize("name", FAILING)
def test_what_fails_of_an_fmu_by_itself_is_found_before_a_run(name, tmp_path):
    """A file in order says nothing of that; the call is named."""
    version, said = FAILING[name]
    found = tribocosim.validate_fmu(fmu(name, version, tmp_path))
    assert found.remarks == []
    (fault,) = found.faults
    assert re.match(said, fault), fault


def test_an_fmu_with_steps_of_one_length_is_tried_by_no_other(tmp_path):
    """Nor the rest of its default experiment, which is no whole number of them."""
    path = replace_text(fmu("rigid", 2, tmp_path), tmp_path / "odd.fmu", 'stopTime="1"', 'stopTime="0.025"')
    assert tribocosim.validate_fmu(path).faults == []


def test_an_output_that_follows_an_input_undeclared_is_found(tmp_path):
    """Masters and references take its dependencies at their word."""
    path = fmu("feedthrough", 2, tmp_path)
    right = tribocosim.validate_fmu(path)
    given = tmp_path / "wrong.fmu", '"2" dependencies="1"', '"2" dependencies=""'
    found = tribocosim.validate_fmu(replace_text(path, *given))
    assert right.faults == found.faults == []
    (remark,) = set(found.remarks) - set(right.remarks)
    assert remark.startswith("real out depends on real in at the same instant, but its dependencies in Model")


@pytest.mark.parametrize("process", ["shared", "own"])
def test_it_is_found_at_the_start_of_a_run_too(process, tmp_path):
    """Which goes on as if it had not been tried."""
    path, values = fmu("feedthrough", 2, tmp_path), []
    wrong = replace_text(path, tmp_path / "wrong.fmu", '"2" dependencies="1"', '"2" dependencies=""')
    for file, count in ((path, 0), (wrong, 1)):
        tables = {
            "decay": {"participant": fmu("dahlquist", 2, tmp_path)},
            "through": {"participant": file, "process": process},
        }
        lines = ["decay.x -> through.real in"]
        summary, columns = ran(scenario(tables, connections=lines), tmp_path / f"out{count}")
        told = [str(line).partition(" at the")[0] for line in summary.tell() if "ModelStr" in str(line)]
        assert told == ["through: real out depends on real in"] * count
        values.append(columns["through.real out"])
    np.testing.assert_allclose(*values, rtol=1e-12)


def test_an_input_that_an_fmu_refuses_in_the_trial_ends_no_run(tmp_path, monkeypatch):
    """The run never gives it: the FMU is opened afresh."""

    def refuse(unit, component, inputs):
        unit.set_inputs(dict.fromkeys(inputs, 7.0))
        raise RecoverableError("through: real in is out of range")

    tables = {
        "decay": {"participant": fmu("dahlquist", 2, tmp_path)},
        "through": {"participant": fmu("feedthrough", 2, tmp_path)},
    }
    one, values = scenario(tables, connections=["decay.x -> through.real in"]), []
    for place in ("tried", "refused"):
        summary, columns = ran(one, tmp_path / place)
        assert summary.complete
        values.append(columns["through.real out"])
        monkeypatch.setattr(proven, "describe_undeclared", refuse)
    np.testing.assert_array_equal(*values)


def test_warnings_in_the_trial_of_dependencies_are_none_of_the_run(tmp_path, monkeypatch):
    """Of an FMU that warns whenever it is read."""
    tables, counts = {"one": {"participant": fmu("uneasy", 2, tmp_path)}}, []
    for times in (0, 3):

        def read(unit, component, inputs, times=times):
            for _ in range(times):
                unit.read_all(np.zeros(component.outputs.size))
            return []

        monkeypatch.setattr(proven, "describe_undeclared", read)
        summary, _ = ran(scenario(tables, checkpoint_every=30), tmp_path / str(times))
        counts.append(summary.content()["warnings"]["one"]["count"])
    assert counts[0] == counts[1] > 0
