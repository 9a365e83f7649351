"""`tribocosim analyse SCENARIO`: what it prints and writes, and mistakes."""

import csv

import numpy as np
import pytest
import xarray
from typer.testing import CliRunner

from models.core.difference import difference
from models.monolithic.trajectory import compute_trajectory
from orchestrator.analyses.stability.survey import round_down
from orchestrator.engine.signals import DEGREES
from orchestrator.masters import MASTERS
from orchestrator.scenario import MasterTable
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system
from tribocosim.command_line import app

from .coupled import run_coupled
from .linearised import write_masses


@pytest.fixture
def masses(tmp_path):
    return write_masses(tmp_path)


@pytest.mark.long
def test_the_command_prints_and_writes_tables_and_a_figure_and_its_advice_keeps_the_tolerance(
    masses, tmp_path
):
    """What is written reads back. Observed: a run as advised is within the scenario's tolerance."""
    out = tmp_path / "out"
    arguments = ["analyse", masses, "--out", str(out), "--at", "0.5 s", "--set", "macro_step=0.02"]
    shown = CliRunner().invoke(app, arguments)
    assert shown.exit_code == 0, shown.output
    assert "Advised: macro_step" in shown.output
    assert "Worth iterating: first, second" in shown.output
    with xarray.open_dataset(out / "stability.nc", engine="h5netcdf") as table:
        # All masters with all signals in the best order, and the scenario's, in another.
        assert table.sizes["method"] == len(MASTERS) * len(DEGREES) + 1
        assert table.of_scenario.sum() == 1
        assert 0.5 in table.point_time
        rows = list(csv.DictReader((out / "stability.csv").read_text().splitlines()))
        limits = [float(row["largest_stable_step [s]"]) for row in rows]
        assert limits == list(table.largest_stable_step.values)
        best = table.isel(method=int(np.argmax(table.advised.values)))
        options = {"name": best.master.item(), "extrapolation": best.extrapolation.item()}
        step, order = best.advised_step.item(), best.order.item().split()
    assert (out / "stability.png").read_bytes().startswith(b"\x89PNG")
    assert "already holds a result" in CliRunner().invoke(app, arguments).output
    scenario = load(masses)
    system = build_system(scenario)
    master = MasterTable(**options, **({"order": order} if order else {})).build()
    found = run_coupled(system, master, step, scenario.stop_time)
    truth = compute_trajectory(system, found.times, 1e-10).outputs[
        :, system.outputs.names.index("first.force")
    ]
    assert difference(found["first.force"], truth).relative_rms <= scenario.tolerance["first.force"]
    assert step > 0.01


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["valve-train", "--parameters"], "--set changes any of its keys"),
        (["trace", "--at", "1"], "belongs to a scenario"),
        (["valve-train", "--at", "1 mm"], "unit"),
        (["valve-train", "--at", "1 s"], "between 0 and stop_time"),
        (["valve-train", "--set", "macro_stp=1"], "unknown key"),
        (["nothing.toml"], "no such scenario file"),
    ],
)
def test_mistakes_are_named_and_nothing_is_written(arguments, said, tmp_path):
    shown = CliRunner().invoke(app, ["analyse", *arguments, "--out", str(tmp_path / "out")])
    assert shown.exit_code == 2
    assert said in shown.output
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("step", "written"), [(1.99e-5, 1.5e-5), (2e-5, 2e-5), (9.9e-4, 8e-4), (0.0, 0.0)])
def test_advised_steps_are_round(step, written):
    assert round_down(step) == written
