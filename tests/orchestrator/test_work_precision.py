"""Work and precision: what is counted, what is compared, and other tools at the same times as ours."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from fmus.build import build
from orchestrator.errors import MistakeError
from orchestrator.work_precision import methods, peers
from orchestrator.work_precision.problem import PROBLEMS, problem_named
from orchestrator.work_precision.run import errors_of, fmu_files
from orchestrator.work_precision.table import cheapest, digest, failures

ROOT = Path(__file__).parents[2]
DURATION = 0.256  # of the quarter car: the wheel's first two swings


@pytest.fixture(scope="module")
def quarter_car():
    return problem_named("quarter-car", DURATION)


@pytest.fixture(scope="module")
def files(quarter_car):
    return fmu_files(quarter_car, lambda name, structure: build(name, structure=structure))


@pytest.fixture(scope="module")
def truth(quarter_car):
    return quarter_car.truth(quarter_car.times)[0]


def test_errors_are_relative_to_the_spread_of_the_true_output():
    """A sine of amplitude 1 (RMS 1/sqrt 2) that is 0.1 too large everywhere, and an output without error."""
    t = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
    true = np.column_stack([np.sin(t), np.cos(t)])
    found = errors_of(("a", "b"), true + np.array([0.1, 0.0]), true)
    assert found["error"] == pytest.approx(0.1 * np.sqrt(2.0))
    assert found["max_error"] == pytest.approx(0.1 * np.sqrt(2.0))
    assert found["errors"] == {"a": pytest.approx(0.1 * np.sqrt(2.0)), "b": 0.0}


@pytest.mark.parametrize("name", PROBLEMS)
def test_samples_fall_on_every_macro_step(name):
    """libcosim counts nanoseconds, so the steps are whole numbers of them as well."""
    problem = problem_named(name)
    for step in (*problem.ladder, *problem.held_ladder):
        assert problem.spacing / step == pytest.approx(round(problem.spacing / step), abs=1e-9)
        assert step * 1e9 == pytest.approx(round(step * 1e9), abs=1e-6)
    assert problem.times[-1] == pytest.approx(problem.duration)


@pytest.mark.parametrize(("extrapolation", "order"), [("hold", 1), ("linear", 2), ("quadratic", 3)])
def test_the_slope_of_a_line_is_the_order_of_its_signals(quarter_car, files, truth, extrapolation, order):
    """Within 0.15 between 1 and 0.5 ms, where the next term of the error is a few per cent."""
    name = f"gauss_seidel, {extrapolation}"
    coarse, fine = (methods.measured(quarter_car, files, truth, name, h) for h in (1e-3, 5e-4))
    assert np.log2(coarse.error / fine.error) == pytest.approx(order, abs=0.15)


def test_calls_are_steps_of_all_instances_repeated_ones_too(quarter_car, files, truth):
    step = 1e-3
    steps = round(DURATION / step)
    held = methods.measured(quarter_car, files, truth, "jacobi, hold", step)
    assert (held.macro_steps, held.iterations, held.calls) == (steps, steps, 2 * steps)
    repeated = methods.measured(quarter_car, files, truth, "iterated, linear", step)
    assert repeated.macro_steps == steps
    assert repeated.calls >= 2 * repeated.iterations > 4 * steps


def test_an_unstable_coupling_is_a_row_without_error_that_says_so(quarter_car, files, truth):
    row = methods.measured(quarter_car, files, truth, "jacobi, quadratic", 16e-3)
    assert np.isnan(row.error)
    assert "unstable coupling" in failures([row])[0]
    assert cheapest([row], row.method, 1.0) is None
    assert digest([row]).row_count == 1


@pytest.mark.parametrize("peer", peers.PEERS)
def test_peers_give_the_numbers_of_our_held_jacobi_at_the_same_times(quarter_car, files, truth, peer):
    """All four outputs are states, so that nobody's way of showing feedthrough matters: errors agree to 1e-9
    of themselves (the tools' times differ in rounding), where one step of shift would double them."""
    rows = list(peers.measured(quarter_car, files, truth, peer))
    if "not installed" in rows[0].note:
        pytest.skip(rows[0].note)
    assert [row.setting for row in rows] == list(quarter_car.held_ladder)
    for row in rows[:3]:
        ours = methods.measured(quarter_car, files, truth, "jacobi, hold", row.setting)
        assert row.errors == pytest.approx(ours.errors, rel=1e-9)
        assert row.calls == ours.calls
        assert row.wall_time_s > 0.0


def test_a_peer_that_is_not_installed_says_so_and_nothing_else(
    quarter_car, files, truth, tmp_path, monkeypatch
):
    (tmp_path / "ecospy.py").write_text("raise ImportError('no ecos here')\n")
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}{os.pathsep}{ROOT}")
    rows = list(peers.measured(quarter_car, files, truth, "ecos"))
    assert failures(rows) == ["ecos: not installed: no ecos here"]


def test_unknown_problems_and_odd_durations_are_refused():
    with pytest.raises(MistakeError, match=r"no problem 'quarter_car'; did you mean quarter-car\?"):
        problem_named("quarter_car")
    with pytest.raises(MistakeError, match=r"--duration 0\.5: must be a multiple of 0\.016 s"):
        problem_named("quarter-car", 0.5)


def test_the_command_leaves_a_table_and_a_figure(tmp_path):
    out = tmp_path / "out"
    code = "from orchestrator.command_line import main; main()"
    arguments = [
        "benchmark",
        "coupling",
        "--problem",
        "quarter-car",
        "--duration",
        "0.032",
        "--out",
        str(out),
    ]

    def run() -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-c", code, *arguments],
            capture_output=True, text=True, cwd=ROOT, timeout=280,
            env=os.environ | {"PYTHONPATH": str(ROOT)},
        )  # fmt: skip

    done = run()
    assert done.returncode == 0, done.stderr
    assert "gauss_seidel, quadratic" in done.stdout
    assert sorted(file.name for file in out.iterdir()) == ["coupling.csv", "coupling.nc", "coupling.png"]
    again = run()
    assert again.returncode == 2
    assert "already holds a result (coupling.nc)" in again.stderr
