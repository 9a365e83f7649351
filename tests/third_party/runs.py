"""Runs of scenarios with third-party FMUs."""

import csv
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from orchestrator.participants.protocol import Participant
from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.run.plan import Plan, make_plan, open_participants
from orchestrator.run.simulation import simulate
from orchestrator.run.summary import Summary
from orchestrator.scenario import Scenario, build_scenario
from orchestrator.scenario.system import resolve


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
    with opened(one) as (plan, units):
        steps, lines = plan.make_steps(), plan.side_lines
        simulate(plan.system, units, plan.master, steps, plan.stop_time, lines=lines)
        side = units[name].abilities.side
        assert side
        return side.get_texts(variables)


@contextmanager
def opened(one: Scenario) -> Iterator[tuple[Plan, dict[str, Participant]]]:
    """Its plan and its participants, for the block."""
    plan = make_plan(resolve(one), never, Reporter(), figures=False)
    with open_participants(plan.system, plan.participants) as units:
        yield plan, units
