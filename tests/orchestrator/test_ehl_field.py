"""The contact with a pressure field in the valve train: rolled back, continued, packaged, and refused."""

from pathlib import Path

import numpy as np
import pytest

from fmus.build import build
from models.core.difference import difference
from models.core.system import System
from models.monolithic import solve
from orchestrator.masters import GaussSeidel, Iterated
from orchestrator.participants import open_fmu
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, resolve_start
from orchestrator.store.json_codec import from_text

from .coupled import run_coupled
from .test_checkpoint import Kept

STEP, STOP = 1e-5, 2e-4
ITERATED = Iterated("hermite", 1e-9)


@pytest.fixture(scope="module")
def valve_train() -> System:
    scenario = load("valve-train-ehl")
    return resolve_start(scenario, build_system(scenario))


@pytest.mark.long
def test_a_coupled_run_comes_to_the_monolithic_one() -> None:
    """Whose own uncertainty is far smaller; halved steps leave about a quarter of the error (measured 0.25:
    explicit signals, and a field whose own steps are of order 2)."""
    scenario = load("valve-train-ehl", ["components.contact.structure.nodes=51"])
    system = resolve_start(scenario, build_system(scenario))
    records = np.linspace(0.0, 4e-4, 21)
    truth = solve(system, records)
    runs = {step: run_coupled(system, GaussSeidel("quadratic"), step, 4e-4) for step in (1e-5, 5e-6)}
    for name in ("contact.load", "contact.minimum_film_thickness"):
        coarse, fine = (
            difference(run[name][:: round(2e-5 / step)], truth[name]).rms for step, run in runs.items()
        )
        assert truth.uncertainty[name].rms < fine / 3.0
        assert fine < coarse / 3.0


@pytest.mark.long
def test_a_run_with_the_field_goes_on_from_a_checkpoint_to_the_last_bit(valve_train: System) -> None:
    """Under a master that rolls it back several times in each step."""
    kept = run_coupled(valve_train, ITERATED, STEP, STOP, recorder=Kept())
    middle = len(kept.states) // 2
    rest = run_coupled(valve_train, ITERATED, STEP, STOP, resumed=from_text(kept.states[middle]))
    np.testing.assert_array_equal(rest.rows, kept.rows[middle + 1 :])
    assert sum(kept.iterations) > 2 * len(kept.steps)


@pytest.mark.long
@pytest.mark.parametrize("master", [GaussSeidel("linear"), ITERATED], ids=repr)
def test_the_fmu_of_the_field_runs_as_the_component_to_the_last_bit(
    master, valve_train: System, tmp_path: Path
) -> None:
    instance = valve_train.instances["contact"]
    file = build("ehl_line_contact", tmp_path, instance.component.structure)
    found = run_coupled(valve_train, master, STEP, STOP, contact=open_fmu("contact", file, instance))
    np.testing.assert_array_equal(found.rows, run_coupled(valve_train, master, STEP, STOP).rows)
