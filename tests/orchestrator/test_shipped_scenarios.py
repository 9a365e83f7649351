"""Shipped scenarios, run as a user runs them, are within their tolerances of the monolithic reference."""

import json
from pathlib import Path

import pytest

from orchestrator.scenario.files import list_shipped

from .commands import called

# Those with solved films or sixteen valves and pistons take many minutes.
LENGTHY = {"engine-ehl", "valve-train-ehl", "valve-train-ehl-sweep", "engine-16v"}


@pytest.mark.long
@pytest.mark.parametrize("name", sorted(set(list_shipped()) - LENGTHY))
def test_a_run_is_within_its_tolerance_of_the_reference(name: str, tmp_path: Path, record) -> None:
    done = called("run", name, "--no-figures", "--out", str(tmp_path / name))
    assert done.returncode == 0, done.stderr
    summary = json.loads((tmp_path / name / "summary.json").read_text("utf-8"))
    for variable, allowed in summary["tolerance"].items():
        quantity = f"scenario {name}: relative RMS error of {variable}"
        error = summary["errors"][variable]["relative_rms"]
        record("Coupling", quantity, error, 0.0, "monolithic solution", tolerance=allowed)
