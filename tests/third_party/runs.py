"""Runs of scenarios with third-party FMUs."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from orchestrator.participants.side_channel import get_side_channel
from orchestrator.reporter import Reporter
from orchestrator.run.participants import build_participants
from orchestrator.run.pipeline import run
from orchestrator.run.plan import resolve_fmus
from orchestrator.run.simulation import simulate
from orchestrator.run.summary import Summary
from orchestrator.scenario import Scenario, build_scenario
from orchestrator.scenario.system import build_side_lines, build_system


def scenario(components: Mapping[str, Mapping[str, Any]], **changes: Any) -> Scenario:
    """A second of these FMUs, in steps of 10 ms; in the run's process unless they say else."""
    tables = {
        "name": "foreign",
        "stop_time": 1.0,
        "macro_step": 0.01,
        "checkpoint_every": 0,
        "start": "given",
        "reference": {"enabled": False},
        "components": {
            name: {"process": "shared", **table, "participant": str(table["participant"])}
            for name, table in components.items()
        },
    }
    return build_scenario(tables | changes)


# Each version of FMI and each place of an FMU's process once.
CASES = ((2, "shared"), (3, "own"))


def never(name: str, structure: object, kind: str) -> Path:
    raise AssertionError(f"{name} has to be given")


def ran(one: Scenario, out: Path) -> tuple[Summary, dict[str, np.ndarray]]:
    """Its summary, and the recorded columns by name."""
    summary = run(one, out, never, Reporter(), figures=False)
    assert (out / "coupled.csv").exists(), summary.message
    return summary, recorded(out)


def recorded(out: Path) -> dict[str, np.ndarray]:
    """The columns of a run's coupled.csv."""
    with (out / "coupled.csv").open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    return dict(zip(header, np.array(rows, dtype=float).T, strict=True))


def find_texts(one: Scenario, name: str, variables: list[str]) -> list[str]:
    """These texts of a component at the end of a run."""
    system = build_system(one)
    units = build_participants(one, system, resolve_fmus(one, never), lambda name, make: make())
    try:
        steps, lines = one.build_steps(), build_side_lines(one)
        simulate(system, units, one.build_master(), steps, one.stop_time, lines=lines)
        side = get_side_channel(units[name])
        assert side
        return side.get_texts(variables)
    finally:
        for unit in units.values():
            unit.close()
