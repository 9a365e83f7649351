"""Work and precision: what is counted, what is compared, and other tools at the same times as ours."""

from __future__ import annotations

import csv
import io
import os
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray
from rich.console import Console

from fmus.build import build
from orchestrator.errors import MistakeError
from orchestrator.reporter import Reporter
from orchestrator.study.work_precision import methods, peers
from orchestrator.study.work_precision.benchmark import benchmark
from orchestrator.study.work_precision.methods import Method, measure_method
from orchestrator.study.work_precision.problem import PROBLEMS, build_problem
from orchestrator.study.work_precision.row import Row, build_fmus, compute_errors
from orchestrator.study.work_precision.table import find_cheapest, list_failures
from tribocosim.command_line import app

ROOT = Path(__file__).parents[2]
DURATION = 0.128  # of the quarter car: the wheel's first swing


def build_fmu(name, structure, kind):
    return build(name, structure=structure)


@pytest.fixture(scope="module")
def quarter_car():
    return replace(build_problem("quarter-car", DURATION), held_halvings=(2, 3, 4))


@pytest.fixture(scope="module")
def files(quarter_car):
    return build_fmus(quarter_car, build_fmu)


def test_errors_at_the_samples_ask_for_the_truth_beside_them_only(quarter_car):
    """An error that is linear in time is met exactly, whatever the run's own times, which are many."""
    asked = []

    def truth(times):
        asked.append(len(times))
        return np.column_stack([np.sin(times), np.ones_like(times)])

    samples = np.linspace(0.0, 2.0 * np.pi, 65)[1:]
    problem = replace(quarter_car, times=samples, outputs=("a", "b"), truth=truth)
    times = 2.0 * np.pi * np.linspace(0.0, 1.0, 5001)[1:] ** 2
    values = truth(times) + 0.1 * times[:, None]
    asked.clear()
    found = compute_errors(problem, times, values)
    assert sum(asked) <= 3 * len(samples)
    spread = np.sqrt(0.5)
    assert found["errors"]["a"] == pytest.approx(0.1 * np.sqrt(np.mean(samples**2)) / spread, rel=1e-9)


def test_errors_are_relative_to_the_spread_of_the_true_output(quarter_car):
    """A sine of amplitude 1 (RMS 1/sqrt 2) that is 0.1 too large everywhere, and an output without error."""
    t = np.linspace(0.0, 2.0 * np.pi, 65)[1:]

    def truth(at):
        return np.column_stack([np.sin(at), np.cos(at)])

    problem = replace(quarter_car, times=t, outputs=("a", "b"), truth=truth)
    found = compute_errors(problem, t, truth(t) + np.array([0.1, 0.0]))
    assert found["error"] == pytest.approx(0.1 * np.sqrt(2.0))
    assert found["max_error"] == pytest.approx(0.1 * np.sqrt(2.0))
    assert found["errors"] == {"a": pytest.approx(0.1 * np.sqrt(2.0)), "b": 0.0}


@pytest.mark.parametrize("name", PROBLEMS)
def test_samples_fall_on_every_macro_step(name):
    """libcosim counts nanoseconds, so the steps are whole numbers of them as well."""
    problem = build_problem(name, 2.0 * PROBLEMS[name].spacing)
    for step in (*problem.ladder, *problem.held_ladder):
        assert problem.spacing / step == pytest.approx(round(problem.spacing / step), abs=1e-9)
        assert step * 1e9 == pytest.approx(round(step * 1e9), abs=1e-6)
    assert problem.times[-1] == pytest.approx(problem.duration)


@pytest.mark.long
@pytest.mark.parametrize(("extrapolation", "order"), [("hold", 1), ("linear", 2), ("quadratic", 3)])
def test_the_slope_of_a_line_is_the_order_of_its_signals(quarter_car, files, extrapolation, order):
    """Within 0.15 between 1 and 0.5 ms, where the next term of the error is a few per cent."""
    method = Method("gauss_seidel", extrapolation)
    coarse, fine = (measure_method(quarter_car, files, method, h) for h in (1e-3, 5e-4))
    assert np.log2(coarse.error / fine.error) == pytest.approx(order, abs=0.15)


def test_calls_are_steps_of_all_instances_repeated_ones_too(quarter_car, files):
    step = 1e-3
    steps = round(DURATION / step)
    held = measure_method(quarter_car, files, Method("jacobi", "hold"), step)
    assert (held.macro_steps, held.iterations, held.calls) == (steps, steps, 2 * steps)
    repeated = measure_method(quarter_car, files, Method("iterated", "linear"), step)
    assert repeated.macro_steps == steps
    assert repeated.calls >= 2 * repeated.iterations > 4 * steps


def test_a_run_with_step_control_counts_what_it_took_back(quarter_car, files):
    """A smaller tolerance costs more steps and leaves a smaller error."""
    method = Method("jacobi", "quadratic", "schierz")
    coarse, fine = (measure_method(quarter_car, files, method, tolerance) for tolerance in (1e-3, 1e-5))
    assert fine.error < 0.2 * coarse.error
    assert coarse.macro_steps < fine.macro_steps
    # Two halves and one of them again, for both instances.
    assert fine.calls >= 2 * 3 * (fine.macro_steps - 1)


def test_an_unstable_coupling_is_a_row_without_error_that_says_so(files):
    row = measure_method(build_problem("quarter-car", 4.8), files, Method("jacobi", "hermite"), 60e-3)
    assert np.isnan(row.error)
    assert "unstable coupling" in list_failures([row])[0]
    assert find_cheapest([row], row.method, 1.0) is None


@pytest.mark.parametrize(
    "peer",
    ["fmpy script", *(pytest.param(p, marks=pytest.mark.long) for p in peers.PEERS if p != "fmpy script")],
)
@pytest.mark.long
def test_peers_give_the_numbers_of_our_held_jacobi_at_the_same_times(quarter_car, files, peer, record):
    """All four outputs are states, so that nobody's way of showing feedthrough matters: errors agree to 1e-9
    of themselves (the tools' times differ in rounding), where one step of shift would double them."""
    before = time.monotonic()
    rows = list(peers.measure_peer(quarter_car, files, peer))
    elapsed = time.monotonic() - before
    if "not installed" in rows[0].note:
        pytest.skip(rows[0].note)
    assert [row.setting for row in rows] == list(quarter_car.held_ladder)
    for row in rows:
        ours = measure_method(quarter_car, files, Method("jacobi", "hold"), row.setting)
        assert row.errors.keys() == ours.errors.keys()
        found, expected = ([*errors.values()] for errors in (row.errors, ours.errors))
        quantity, source = f"errors of the quarter car by {peer}", "Jacobi with held inputs by tribocosim"
        record("Tools", quantity, found, expected, source, relative=1e-9)
        assert row.calls == ours.calls
        assert 0.0 < row.wall_time_s < elapsed


def test_a_peer_that_is_not_installed_says_so_and_nothing_else(quarter_car, files, tmp_path, monkeypatch):
    (tmp_path / "ecospy.py").write_text("raise ImportError('no ecos here')\n")
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}{os.pathsep}{ROOT}")
    rows = list(peers.measure_peer(quarter_car, files, "ecos"))
    assert list_failures(rows) == ["ecos: not installed: no ecos here"]
    monkeypatch.setenv("OMSIMULATOR", str(tmp_path / "none.so"))
    (said,) = list_failures(list(peers.measure_peer(quarter_car, files, "OMSimulator")))
    assert said.startswith("OMSimulator: not installed: ")


def test_durations_are_multiples_of_the_samples_spacing():
    with pytest.raises(MistakeError, match="--duration"):
        build_problem("quarter-car", 0.5)


def test_the_benchmark_leaves_a_table_and_a_figure(tmp_path, monkeypatch):
    chosen = Method("jacobi", "linear"), Method("jacobi", "linear", "schierz")
    monkeypatch.setattr(methods, "METHODS", chosen)
    monkeypatch.setattr(peers, "PEERS", {"fmpy script": "fmpy_script"})
    out = tmp_path / "out"
    rows = benchmark("quarter-car", build_fmu, out, duration=0.032)
    assert sorted(file.name for file in out.iterdir()) == ["coupling.csv", "coupling.nc", "coupling.png"]
    with xarray.open_dataset(out / "coupling.nc", engine="h5netcdf") as table:
        np.testing.assert_array_equal(table["calls"], [row.calls for row in rows])
        assert table.sizes == {"run": len(rows), "output": 4}
    with pytest.raises(MistakeError, match=r"coupling\.nc"):
        benchmark("quarter-car", build_fmu, out, duration=0.032)


@pytest.mark.long
def test_a_benchmark_that_is_killed_leaves_the_methods_that_it_has_measured(
    quarter_car, tmp_path, monkeypatch
):
    first, second = Method("jacobi", "linear"), Method("jacobi", "hermite")
    monkeypatch.setattr(methods, "METHODS", (first, second))

    def measured_once(problem, files, method, setting):
        if method == second:
            raise KeyboardInterrupt
        return measure_method(problem, files, method, setting)

    monkeypatch.setattr(methods, "measure_method", measured_once)
    said = io.StringIO()
    with pytest.raises(KeyboardInterrupt):
        benchmark("quarter-car", build_fmu, tmp_path, 0.032, reporter=Reporter(Console(file=said, width=80)))
    rows = list(csv.DictReader((tmp_path / "coupling-unfinished.csv").read_text().splitlines()))
    assert {row["method"] for row in rows} == {"jacobi, linear"}
    assert len(rows) == len(first.settings(quarter_car))
    assert "jacobi, linear: " in said.getvalue()


def test_the_digest_is_not_cut_in_a_narrow_window(tmp_path, monkeypatch):
    """All its numbers are there at 40 columns, where lines fold."""
    method = "gauss_seidel, quadratic, step_doubling"
    row = Row(method, "tribocosim", 1e-3, calls=123456, wall_time_s=0.111, error=3.2e-6)
    measure = "orchestrator.study.work_precision.benchmark.measure"
    monkeypatch.setattr(measure, lambda *_: iter([(1.0, [row])]))
    said = io.StringIO()
    benchmark("quarter-car", None, tmp_path, 0.032, reporter=Reporter(Console(file=said, width=40)))
    assert said.getvalue().count("123456 (111 ms)") == 4
    assert "3.2e-06" in said.getvalue()
    assert "…" not in said.getvalue()


def test_the_command_names_a_mistake(capsys):
    with pytest.raises(SystemExit) as end:
        app(["benchmark", "coupling", "--problem", "valve_train"])
    assert end.value.code == 2
    assert "did you mean valve-train?" in capsys.readouterr().err


def test_published_pairs_of_masses_have_their_modes() -> None:
    """Closed forms: half the sum of the even and the odd mode."""
    times = np.linspace(0.016, 0.96, 60)
    precice = build_problem("precice-oscillator").truth(times)
    modes = 0.5 * np.cos(2.0 * np.pi * times), 0.5 * np.cos(6.0 * np.pi * times)
    np.testing.assert_allclose(precice[:, 0], modes[0] + modes[1], atol=1e-11)
    np.testing.assert_allclose(precice[:, 2], modes[0] - modes[1], atol=1e-11)
    damped = build_problem("mass-spring-damper").truth(times)

    def decay(rate: float) -> np.ndarray:
        """x'' + rate (x' + x) = 0 from 1/2 at rest."""
        turn = np.sqrt(rate - 0.25 * rate**2)
        swing = np.cos(turn * times) + 0.5 * rate / turn * np.sin(turn * times)
        return np.asarray(0.5 * np.exp(-0.5 * rate * times) * swing)

    np.testing.assert_allclose(damped[:, 0], decay(1.0) + decay(3.0), atol=1e-11)
    np.testing.assert_allclose(damped[:, 2], decay(1.0) - decay(3.0), atol=1e-11)
