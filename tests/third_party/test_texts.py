"""Texts as parameters of third-party FMUs: they arrive as they are, before the initialisation."""

from pathlib import Path

import numpy as np
import pytest

from orchestrator.scenario.files import load
from orchestrator.scenario.ssp.reader import read_package
from orchestrator.scenario.ssp.writer import export

from .c_fmus import fmu
from .runs import never, ran, scenario

ODD = "µ/a \"b\" 'c' \\ #.csv"


@pytest.mark.parametrize(
    ("version", "process", "text"), [(3, "shared", ""), (2, "shared", "8 mm"), (3, "own", ODD)]
)
def test_a_text_arrives_in_utf_8(version: int, process: str, text: str, tmp_path: Path) -> None:
    """Also one that would be a value with a unit elsewhere, and by the run's own scenario file."""
    path, raw = fmu("reading", version, tmp_path), text.encode()
    table = {"participant": path, "process": process, "parameters": {"table file": text, "scale": 2.0}}
    summary, found = ran(scenario({"one": table}, stop_time=0.02), tmp_path / "out")
    assert summary.complete, summary.message
    assert set(found["one.length"]) == {2.0 * len(raw)}
    first, second = (raw + b"\0\0")[:2]
    assert (found["one.first"][0], found["one.second"][0]) == (first, second)
    _, again = ran(load(tmp_path / "out" / "scenario.toml"), tmp_path / "again")
    np.testing.assert_array_equal(again["one.length"], found["one.length"])


def test_texts_go_through_packages(tmp_path: Path) -> None:
    """SSP's ssv:String."""
    table = {"participant": fmu("reading", 3, tmp_path), "parameters": {"table file": ODD, "scale": 2.0}}
    package = tmp_path / "one.ssp"
    export(scenario({"one": table}), package, never)
    assert read_package(package)["components"]["one"]["parameters"] == table["parameters"]
