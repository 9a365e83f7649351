"""Public packages of other tools run, or are refused with the reason before anything is written."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.files import load
from tests.third_party.public import public
from tests.third_party.runs import never, recorded


@pytest.mark.parametrize("name", ["algebraic_loop_1", "algebraic_loop_3", "demo"])
def test_a_public_package_runs(name: str, tmp_path: Path) -> None:
    """Its first hundred macro steps."""
    path = str(public(f"ssp/{name}.ssp"))
    step = load(path).macro_step
    one = load(path, [f"stop_time={100 * step!r}"])
    summary = run(one, tmp_path / "out", never, Reporter(), figures=False)
    assert summary.complete, summary.message
    found = recorded(tmp_path / "out")
    assert len(found["time"]) == 101
    assert all(np.all(np.isfinite(column)) for column in found.values())


def test_a_public_package_for_another_system_is_refused(tmp_path: Path) -> None:
    one = load(str(public("ssp/quarter-truck.ssp")))
    with pytest.raises(ScenarioError, match=r"chassis.*has no binary for .* \(it has win32, win64\)"):
        run(one, tmp_path / "out", never, Reporter(), figures=False)
    assert not (tmp_path / "out").exists()


def test_a_public_package_runs_or_names_the_library_that_lacks(tmp_path: Path) -> None:
    """Its FMUs need a C++ library that not every system has."""
    path = str(public("ssp/scenario_parameter.ssp"))
    one = load(path, [f"stop_time={10 * load(path).macro_step!r}"])
    try:
        said = run(one, tmp_path / "out", never, Reporter(), figures=False).message
    except ScenarioError as error:
        said = str(error)
        assert not any((tmp_path / "out").iterdir())
    assert not said or re.search(r"scenario: instantiate: .*GLIBC", said)
