"""Names of variables: two of one variable have one value; an output's name wins over the grammar."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestrator.scenario import Line, ScenarioError
from orchestrator.scenario.connection import parse_line
from orchestrator.scenario.system import assemble

from .c_fmus import describe2, describe3, fmu, real2
from .models import MODELS, V
from .runs import ran, scenario

START = 'start="0"'
INPUTS = real2("u", 0, "input", START) + real2("v", 0, "input", START)
PARAMETERS = real2("p", 1, "parameter", START, "fixed") + real2("q", 1, "parameter", START, "fixed")
TWO = INPUTS + PARAMETERS + real2("a", 2, "output") + real2("b", 3, "output")
TWO3 = (
    '<Float64 name="u" valueReference="0" causality="input" start="0"><Alias name="v"/></Float64>'
    '<Float64 name="p" valueReference="1" causality="parameter" start="0"><Alias name="q"/></Float64>'
    '<Float64 name="a" valueReference="2" causality="output"/>'
    '<Float64 name="b" valueReference="3" causality="output"/>'
)
DISAGREEING: dict[str, tuple[dict[str, Any], list[str]]] = {
    "parameters": ({"parameters": {"p": 1.0, "q": 2.0}}, []),
    "inputs": ({"inputs": {"u": 1.0, "v": 2.0}}, []),
    "connections": ({}, ["s.a -> t.u", "s.b -> t.v"]),
    "a value and a connection": ({"inputs": {"u": 1.0}}, ["s.b -> t.v"]),
}


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize(("values", "lines"), DISAGREEING.values(), ids=DISAGREEING)
def test_values_that_disagree_are_refused(version, values, lines, tmp_path):
    path = tmp_path / "two.fmu"
    file = describe2(path, TWO) if version == 2 else describe3(path, TWO3)
    one = scenario({"s": {"participant": file}, "t": {"participant": file} | values}, connections=lines)
    with pytest.raises(ScenarioError, match=r"are two names of one variable of t .*; leave one out"):
        assemble(one)


def test_values_that_agree_are_taken(tmp_path):
    file = describe2(tmp_path / "two.fmu", TWO)
    assemble(scenario({"t": {"participant": file, "parameters": {"p": 1.0, "q": 1.0}}}))


def test_elements_of_an_array_are_set_by_any_name(tmp_path, monkeypatch):
    """One element by each of the array's names."""
    alias = V("A", "parameter", [1.0, 0.0, 0.0, 1.0], size=4, inside='<Alias name="B"/>')
    model = MODELS["vector"]
    variables = tuple(alias if v.name == "A" else v for v in model.variables)
    monkeypatch.setitem(MODELS, "renamed", type(model)(**{**vars(model), "variables": variables}))
    values = {"A[1,1]": 2.0, "B[2,2]": 3.0, "x0": [1.0, 1.0]}
    table = {"participant": fmu("renamed", 3, tmp_path), "parameters": values}
    _, found = ran(scenario({"one": table}, stop_time=0.02), tmp_path / "out")
    np.testing.assert_array_equal(found["one.y[1]"], 2.0)
    np.testing.assert_array_equal(found["one.y[2]"], 3.0)


NAMES = ("Sensor", "Sensor - 1", "Sensor * 2", "a -&gt; b", "plain", "end ")
READ = {
    "s.Sensor - 1 -> e.u": Line("s.Sensor - 1", "e.u"),
    "s.Sensor - 2 -> e.u": Line("s.Sensor", "e.u", None, -2.0),
    "s.Sensor - 1 - 1 -> e.u": Line("s.Sensor - 1", "e.u", None, -1.0),
    "'s.Sensor' - 1 -> e.u": Line("s.Sensor", "e.u", None, -1.0),
    "s.Sensor * 2 -> e.u": Line("s.Sensor * 2", "e.u"),
    "'s.Sensor' * 2 - 1 -> e.u": Line("s.Sensor", "e.u", 2.0, -1.0),
    "'s.Sensor * 2' - 1 -> e.u": Line("s.Sensor * 2", "e.u", None, -1.0),
    "s.a -> b * 3 -> e.u": Line("s.a -> b", "e.u", 3.0),
    "s.plain->e.x -> y": Line("s.plain", "e.x -> y"),
    "'s.end ' -> e.u": Line("s.end ", "e.u"),
}


def lines_of(text: str, folder: Path) -> list[Line]:
    outputs = "".join(real2(name, i, "output") for i, name in enumerate(NAMES))
    inputs = "".join(real2(name, i, "input", 'start="0"') for i, name in enumerate(("u", "x -&gt; y")))
    tables = {
        "s": {"participant": describe2(folder / "s.fmu", outputs)},
        "e": {"participant": describe2(folder / "e.fmu", inputs)},
    }
    return [parse_line(line) for line in scenario(tables, connections=[text]).connections]


@pytest.mark.parametrize(("text", "line"), READ.items(), ids=READ)
def test_names_win(text, line, tmp_path):
    """And what is written of a connection reads as the same."""
    assert lines_of(text, tmp_path) == [line]
    assert parse_line(str(line)) == line


def test_what_may_be_two_outputs_is_refused(tmp_path):
    with pytest.raises(
        ScenarioError, match=r"write 's\.Sensor \* 2' - 1 or 's\.Sensor' \* 2 - 1, with the q"
    ):
        lines_of("s.Sensor * 2 - 1 -> e.u", tmp_path)
