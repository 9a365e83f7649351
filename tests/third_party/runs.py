"""Runs of scenarios with third-party FMUs, public ones too, which are not in the repository; two masses."""

import csv
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.oscillators.two_masses import CoupledMassParameters, SprungMassParameters
from orchestrator.participants.protocol import Participant
from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.run.plan import Plan, make_plan, open_participants
from orchestrator.run.simulation import simulate
from orchestrator.run.summary import Summary
from orchestrator.scenario import Scenario, build_scenario
from orchestrator.scenario.system import resolve
from tests.models.exact_oscillators import two_masses

from .c_fmus import fmu


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


def completed(one: Scenario, out: Path) -> dict[str, np.ndarray]:
    """The recorded columns of a run that must come to its end."""
    summary, found = ran(one, out)
    assert summary.complete, summary.message
    return found


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


VARIABLE = "TRIBOCOSIM_THIRD_PARTY"
BESIDE = Path(__file__).parents[2].parent / "shared" / "third_party"


def public(name: str) -> Path:
    """The file of that name in the folder that the environment variable names, or beside the repository; the
    test is skipped where there is none."""
    for folder in (os.environ.get(VARIABLE), BESIDE):
        if folder and (path := Path(folder, name)).is_file():
            return path
    pytest.skip(f"needs {name}: set {VARIABLE} to a folder that has it")


LINES = [
    "first.force -> second.force",
    "second.position -> first.other_position",
    "second.velocity -> first.other_velocity",
]


def masses(second: str, folder: Path, component: str | None = None, **changes: Any) -> Scenario:
    """The second one is that FMU, in the place of our `component` if one is given; the first one starts at
    1 m."""
    tables = {
        "first": {"component": "coupled_mass", "participant": "in-process", "start": {"position": 1.0}},
        "second": {"participant": fmu(second, 2, folder), "component": component},
    }
    return scenario(tables, **{"connections": LINES} | changes)


def exact_position(times: np.ndarray) -> np.ndarray:
    """That of the first one by the matrix exponential."""
    coupled, sprung = CoupledMassParameters(), SprungMassParameters(mass=1.0, stiffness=10.0, damping=0.5)
    return two_masses(times, coupled, sprung, np.array([1.0, 0.0, 0.0, 0.0]))[:, 0]
