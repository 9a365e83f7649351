"""What a third-party FMU tells: messages, warnings, and statuses that are none."""

import re

import pytest

from orchestrator.errors import MistakeError
from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run

from ..fmus.names import mark_long
from .c_fmus import fmu
from .runs import CASES, never, ran, scenario


@pytest.mark.parametrize("process", mark_long(["own", "shared"], ["shared"]))
def test_arguments_of_messages_are_put_in(process, tmp_path):
    """As printf would, for each instance its own."""
    path = fmu("formatting", 2, tmp_path)
    tables = {name: {"participant": path, "process": process} for name in ("one", "other")}
    summary, _ = ran(scenario(tables, master={"name": "jacobi"}), tmp_path / "out")
    said = "one: step from t = 0.5 s by 0.01 s returned Error: the boiler of one burst at 0.5 s, 100 %; look"
    assert said in summary.message


@pytest.mark.parametrize(("version", "process"), CASES)
def test_warnings_of_every_call_are_counted_and_told_once(process, version, tmp_path, capsys):
    """Of fifty steps of a hundred with and without words, of reading once in each step at least, and of the
    end of initialisation; by Python and by compiled code."""
    tables = {
        name: {"participant": fmu(name, version, tmp_path), "process": process}
        for name in ("warning", "muttering", "uneasy", "starting", "vanderpol")
    }
    summary, _ = ran(scenario(tables, connections=["uneasy.x -> vanderpol.force"]), tmp_path / "out")
    assert summary.complete
    found = summary.content()["warnings"]
    assert found.pop("uneasy")["count"] >= 100
    assert found == {
        "warning": {"count": 50, "first": "getting hot"},
        "muttering": {"count": 50, "first": ""},
        "starting": {"count": 1, "first": ""},
    }
    shown = capsys.readouterr().out
    assert shown.count("warning: the FMU gave 50 warnings, the first: getting hot") == 1
    assert shown.count("muttering: the FMU gave 50 warnings; it does not say of what") == 1


UNKNOWN = {
    "unreadable": r"one: reading the outputs returned -1, which is no status of FMI",
    "unstepped": r"one: step from t = 0 s by 0.01 s returned 7, which is no status of FMI",
    "unready": r"fmi[23]ExitInitializationMode returned -1, which is no status of FMI: not ready",
}


@pytest.mark.parametrize("vice", UNKNOWN)
@pytest.mark.parametrize(("version", "process"), CASES)
def test_what_is_no_status_is_an_error(vice, process, version, tmp_path):
    """Of a call of Python and of compiled code."""
    tables = {
        "one": {"participant": fmu(vice, version, tmp_path), "process": process},
        "other": {"participant": fmu("vanderpol", version, tmp_path), "process": process},
    }
    for lines in ([], ["one.x -> other.force"]):
        one = scenario(tables, connections=lines, master={"name": "jacobi"})
        try:
            said = run(one, tmp_path / f"out{len(lines)}", never, Reporter(), figures=False).message
        except MistakeError as error:  # of initialisation
            said = str(error)
        assert re.search(UNKNOWN[vice], said)
