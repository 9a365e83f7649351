"""Public packages of other tools run, or are refused with the reason before anything is written."""

import re

import numpy as np
import pytest

from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.files import load
from tests.fmus.names import mark_long
from tests.third_party.public import public
from tests.third_party.runs import find_texts, never, recorded

from .packages import binding, component, connection, package


@pytest.mark.parametrize("name", mark_long(["algebraic_loop_1", "algebraic_loop_3", "demo"], ["demo"]))
def test_a_public_package_runs(name, tmp_path):
    """Its first hundred macro steps."""
    path = str(public(f"ssp/{name}.ssp"))
    step = load(path).macro_step
    one = load(path, [f"stop_time={100 * step!r}"])
    summary = run(one, tmp_path / "out", never, Reporter(), figures=False)
    assert summary.complete, summary.message
    found = recorded(tmp_path / "out")
    assert len(found["time"]) == 101
    assert all(np.all(np.isfinite(column)) for column in found.values())


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
        assert not any((tmp_path / "out").iterdir())
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
