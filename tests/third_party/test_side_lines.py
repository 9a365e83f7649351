"""Connections of strings and binary values, and of whole numbers, enumerations and truth values by type."""

import csv
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from orchestrator.engine.step import Step
from orchestrator.participants.protocol import Abilities
from orchestrator.run.record import FORMULA, TextRecorder
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.system import build_system

from .clocked_fmus import sampler
from .runs import CASES, find_texts, public, ran, scenario


@pytest.mark.parametrize(("version", "process"), CASES)
def test_texts_pass_along_a_chain(version, process, tmp_path):
    """Of FMUs whose outputs are their inputs, in any order of lines."""
    table = {"participant": public(f"reference-fmus-{version}/Feedthrough.fmu"), "process": process}
    pairs = ["String"] if version == 2 else ["String", "Binary"]
    given = {"String": "grün, 3 > 2", "Binary": "00ff10"}
    inputs = {f"{kind}_input": given[kind] for kind in pairs}
    one = scenario(
        {"a": table | {"inputs": inputs}, "b": table, "c": table},
        connections=[f"{x}.{k}_output -> {y}.{k}_input" for x, y in ("bc", "ab") for k in pairs],
        stop_time=0.2,
        macro_step=0.1,
    )
    assert find_texts(one, "c", [f"{kind}_output" for kind in pairs]) == [given[kind] for kind in pairs]


def test_texts_are_recorded(tmp_path):
    """As they are at the start; a text holds until the next line."""
    table = {"participant": public("reference-fmus-3/Feedthrough.fmu")}
    inputs = {"String_input": 'grün, "3" > 2', "Binary_input": "00ff10"}
    one = scenario({"a": table | {"inputs": inputs}}, stop_time=0.2, macro_step=0.1)
    ran(one, tmp_path / "out")
    with (tmp_path / "out" / "texts.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    assert rows[0] == ["time", "variable", "text"]
    said = [["0.0", "a.String_output", 'grün, "3" > 2'], ["0.0", "a.Binary_output", "00ff10"]]
    assert sorted(rows[1:]) == sorted(said)


class Speaker:
    """A recorder of a text that changes, by what it does."""

    def __init__(self, folder: Path) -> None:
        self.text, self.file = "", folder / "texts.csv"
        unit = SimpleNamespace(abilities=Abilities(side=self))  # type: ignore[arg-type]
        coupling = SimpleNamespace(wiring=SimpleNamespace(names=("one",)), participants=[unit])
        self.recorder = TextRecorder(self.file, {"one": ["state"]})
        self.recorder.watch(coupling)  # type: ignore[arg-type]

    def get_texts(self, names: list[str]) -> list[str]:
        return [self.text] * len(names)

    def say(self, time: float, text: str) -> None:
        self.text = text
        self.recorder.observe(time, np.zeros, Step(time, 0.1, 1))


def test_texts_are_recorded_where_they_change_also_by_a_resumed_run(tmp_path):
    first = Speaker(tmp_path)
    first.recorder.begin([])
    for time, text in ((0.0, "flight"), (0.1, "flight"), (0.2, "contact")):
        first.say(time, text)
    state = first.recorder.state()
    first.say(0.3, "lost with the process")
    first.recorder.end(False, "")
    second = Speaker(tmp_path)
    second.recorder.resume([], state)
    for time, text in ((0.3, "contact"), (0.4, "flight")):
        second.say(time, text)
    second.recorder.end(True, "")
    rows = second.file.read_text("utf-8").splitlines()
    assert rows[1:] == ["0.0,one.state,flight", "0.2,one.state,contact", "0.4,one.state,flight"]


@pytest.mark.parametrize("text", ["=1+1", "+1", "-cmd|' /C calc'!A0", "@SUM(1)", "\t=1", "plain"])
def test_no_text_of_an_fmu_is_a_formula_of_a_spreadsheet(text, tmp_path):
    speaker = Speaker(tmp_path)
    speaker.recorder.begin([])
    speaker.say(0.0, text)
    speaker.recorder.end(True, "")
    cell = speaker.file.read_text("utf-8").splitlines()[1].split(",", 2)[2].strip('"')
    assert not cell.startswith(FORMULA)
    assert text in cell


@pytest.mark.parametrize("process", ["shared", pytest.param("own", marks=pytest.mark.long)])
def test_numbers_of_each_type_pass(process, tmp_path):
    """Those of FMI 3.0, between FMUs whose outputs are their inputs, at the ends of their ranges."""
    table = {"participant": public("reference-fmus-3/Feedthrough.fmu"), "process": process}
    values = {"Int8": -128, "UInt8": 255, "Int16": -32768, "UInt16": 65535, "Int32": -(2**31)}
    values |= {"UInt32": 2**32 - 1, "Int64": -(2**53), "UInt64": 2**53, "Boolean": 1, "Enumeration": 2}
    given = {f"{kind}_input": bool(v) if kind == "Boolean" else v for kind, v in values.items()}
    one = scenario(
        {"a": table | {"inputs": given}, "b": table},
        connections=[f"a.{kind}_output -> b.{kind}_input" for kind in values],
        stop_time=0.2,
        macro_step=0.1,
    )
    _, found = ran(one, tmp_path / "out")
    for kind, value in values.items():
        np.testing.assert_array_equal(found[f"b.{kind}_output"], value, err_msg=kind)


REFUSED = [
    ("Int32_output -> b.Int8_input", r"does not fit an input of type Int8; with a factor its number goes"),
    ("Float64_continuous_output -> b.Int32_input", "a real number does not fit"),
    ("String_output -> b.Binary_input", "a value of type String does not fit a value of type Binary"),
    ("String_output * 2 -> b.String_input", "has no factor"),
    ("String_input -> b.String_input", "a.String_input is no output"),
    ("fired -> b.tick", "a clock of intervalVariability constant ticks by time"),
    ("fired -> b.gain", "a value of type Clock does not fit a value of type Float64"),
    ("fired * 2 -> b.poke", "has no factor"),
    ("poke -> b.poke", "a.poke is no output"),
    ("fierd -> b.poke", "no variable 'fierd'; did you mean fired"),
]


@pytest.mark.parametrize(("line", "said"), REFUSED)
def test_what_does_not_fit_is_refused_by_name(line, said, tmp_path):
    """Between FMUs whose outputs are their inputs, and between those with clocks."""
    passing = line.partition(" ")[0].endswith("put")
    path = public("reference-fmus-3/Feedthrough.fmu") if passing else sampler(tmp_path)
    one = scenario({"a": {"participant": path}, "b": {"participant": path}}, connections=[f"a.{line}"])
    with pytest.raises(ScenarioError, match=said):
        build_system(one)
