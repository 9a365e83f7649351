"""Two names of one variable have one value: what is said of both must agree."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestrator.scenario import ScenarioError
from orchestrator.scenario.system import assemble

from .c_fmus import fmu
from .described import describe2, describe3, real2
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
def test_values_that_disagree_are_refused(
    version: int, values: dict[str, Any], lines: list[str], tmp_path: Path
) -> None:
    path = tmp_path / "two.fmu"
    file = describe2(path, TWO) if version == 2 else describe3(path, TWO3)
    one = scenario({"s": {"participant": file}, "t": {"participant": file} | values}, connections=lines)
    with pytest.raises(ScenarioError, match=r"are two names of one variable of t .*; leave one out"):
        assemble(one)


def test_values_that_agree_are_taken(tmp_path: Path) -> None:
    file = describe2(tmp_path / "two.fmu", TWO)
    assemble(scenario({"t": {"participant": file, "parameters": {"p": 1.0, "q": 1.0}}}))


def test_elements_of_an_array_are_set_by_any_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
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
