"""The command `analyse`: what it writes reads back, and what it refuses."""

import csv
import math
import shlex
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest
import xarray
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

from models.slider_crank.motions.machine import FORMS
from orchestrator.analyses import _evaluate, list_analyses, load
from orchestrator.analyses._evaluate import analyse, parse_setting
from orchestrator.analyses.poincare import draw_poincare, magnify
from orchestrator.analyses.stability.behaviour import StepBehaviour
from orchestrator.analyses.stability.report import format_row
from orchestrator.analyses.stability.survey import AssessedMethod
from orchestrator.errors import MistakeError
from orchestrator.masters import Iterated
from orchestrator.plots.motion import format_angle, shift_to_first_turn
from orchestrator.plots.style import create_subplots
from tests.fmus.names import mark_long
from tribocosim.command_line import app

from .commands import called

# Enough to run every line; each analysis takes those that it has.
SHORT = {"cycles": 40, "transient": 20, "points": 50, "x_count": 3, "y_count": 2, "starts": 4, "count": 3}


# The analyses of the slider-crank; others have tests of their own.
SLIDER_CRANK = [name for name in list_analyses() if "form" in load(name).parameters]


@pytest.mark.parametrize("form", mark_long(FORMS, ["corrected"]))
@pytest.mark.parametrize("name", SLIDER_CRANK)
def test_results_are_those_declared_and_drawn_for_every_form(name, form, tmp_path):
    """Numbers or texts; the table holds the same ones. Also of a machine that slides for good, without any
    impact."""
    analysis = load(name)
    short = [f"{key}={SHORT[key]}" for key in SHORT if key in analysis.parameters]
    for damping in ("0.05", "0.4"):
        folder = tmp_path / damping
        found = analyse(name, [*short, f"form={form}", f"damping={damping}"], folder)
        assert set(found) == set(analysis.results)
        for key, result in analysis.results.items():
            assert isinstance(found[key], str) == result.text
            assert result.text or not np.isnan(found[key]) or damping == "0.4"
        with xarray.open_dataset(folder / f"{name}.nc", engine="h5netcdf") as table:
            held = {key: table[key].item() for key in found}
        np.testing.assert_equal(held, found)
        assert (folder / f"{name}.png").read_bytes().startswith(b"\x89PNG")


def test_sums_per_impact_and_per_cycle_are_of_the_same_impacts():
    analysis = load("profile")
    impact, cycle = (
        analysis.evaluate(analysis.complete({"cycles": 40, "transient": 20, "per": per}))
        for per in ("impact", "cycle")
    )
    assert impact["upper_sum"] * impact["impacts_per_cycle"] == pytest.approx(cycle["upper_sum"], rel=1e-12)


def test_windows_of_exponents_add_up_to_the_result():
    """The tangents go on from window to window: both exponents are the windows' means, to rounding."""
    analysis = load("exponents")
    table = analysis.table(analysis.complete({"form": "as_published", "cycles": 2000}))
    assert table.sizes["window"] == 200
    assert table["largest_in_window"].values.mean() == pytest.approx(table["largest"].item(), rel=1e-9)
    assert table["second_in_window"].values.mean() == pytest.approx(table["second"].item(), rel=1e-9)


def test_files_read_back(tmp_path):
    """netCDF with units, parameters and versions; CSV with as many rows; PNG."""
    results = analyse("trace", ["cycles=2", "points=40", "form=as_published"], tmp_path)
    with xarray.open_dataset(tmp_path / "trace.nc", engine="h5netcdf") as table:
        assert {name: table[name].item() for name in results} == results
        assert (table.attrs["form"], table.attrs["cycles"], table.psi.units) == ("as_published", 2, "rad")
        assert "numpy" in table.attrs["versions"]
        rows = list(csv.reader((tmp_path / "trace.csv").read_text().splitlines()))
        assert len(rows) == 1 + table.sizes["point"]
        for name in ("psi", "theta"):
            column = rows[0].index(f"{name} [rad]")
            np.testing.assert_array_equal([float(row[column]) for row in rows[1:]], table[name])
    assert (tmp_path / "trace.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "key"),
    [
        (["trce"], "trace"),
        (["trace", "--set", "dampng=1"], "damping"),
        (["trace", "--set", "damping=-1"], "damping"),
        (["trace", "--set", "restitution=1.1"], "restitution"),
        (["trace", "--set", "form=fast"], "form"),
        (["trace", "--set", "cycles=2.5"], "cycles"),
        (["trace", "--set", "damping"], "damping"),
        (["trace", "--set", "damping=5 mm"], "5 mm"),
        (["trace", "--set", "psi=0.02"], "psi"),
        (["trace", "--set", "gap=0.5"], "nonlinear"),
        (["exponent_map", "--set", "x=dampng"], "dampng"),
        (["exponent_map", "--set", "x=gap"], "two"),
        (["exponent_map", "--set", "y_from=-0.01"], "gap"),
        (["bifurcation", "--set", "x=restitution", "--set", "x_to=2"], "restitution"),
        (["trace", "--set", "xi=1"], "crank"),
        (["trace", "--at", "1"], "belongs to a scenario"),
        (["valve-train", "--parameters"], "--set changes any of its keys"),
        (["valve-train", "--at", "1 mm"], "unit"),
        (["valve-train", "--at", "1 s"], "between 0 and stop_time"),
        (["valve-train", "--set", "macro_stp=1"], "unknown key"),
        (["nothing.toml"], "no such scenario file"),
        (["two-masses", "--set", "tolerance={}", "--set", "reference.enabled=false"], "tolerance: missing"),
    ],
)
def test_refusals(arguments, key, tmp_path):
    """Exit status 2, one line, and no file."""
    done = CliRunner().invoke(app, ["analyse", *arguments, "--out", str(tmp_path / "out")])
    assert done.exit_code == 2
    assert key in done.stderr
    assert done.stderr.count("\n") == 1
    assert not list(tmp_path.rglob("*.*"))


def test_a_limit_beyond_the_longest_step_tried_is_no_step():
    samples = [StepBehaviour(step, 0.9, contraction) for step, contraction in ((1e-3, 0.5), (4e-3, 0.8))]
    errors = {1e-3: {"a.x": 1e-5}, 2e-3: {"a.x": 1e-4}}
    found = Mock(scenario=Mock(macro_step=1e-3), methods=[])
    for limit, accurate, cells in (
        (math.inf, 2e-3, ("≥ 4 ms", "≥ 4 ms", "≥ 2 ms")),
        (3e-3, 1.5e-3, ("3 ms", "≥ 4 ms", "1.5 ms")),
    ):
        method = AssessedMethod(Iterated(), samples, limit, errors=errors, accurate_step=accurate)
        _, stable, contracts, _, within, *_ = format_row(found, method)
        assert (stable, contracts, within) == cells


@pytest.mark.parametrize(
    ("name", "values", "message"),
    [
        ("cam", {"follower": "roller", "offset": 0.1}, "offset"),
        ("cam", {"follower": "finger_pad", "valve_arm": 5e-3}, "cannot lift the valve"),
        ("cam", {"follower": "finger_pad", "cam_arm": 0.0}, "must not be zero"),
        ("cam", {"lift_table": "absent.csv"}, "cannot be read"),
        ("clearance", {"rod_length": 0.04}, "crank_radius = 0.043 m: must be less than rod_length = 0.04 m"),
        ("clearance", {"pin_offset": 0.12}, "pin_offset = 0.12 m: .* rod_length - crank_radius = 0.1 m"),
        ("clearance", {"advance": -0.2}, "advance = -11.4592 deg: must be at least -retard, 0 deg"),
        ("spring", {"travel": 0.011}, "lift 11 mm: must be less than 10 mm, where all coils touch"),
        ("spring", {"low": 400.0}, "low = 3819.72 r/min: must be less than high"),
        ("spring", {"mean_diameter": "26"}, "= 26000 mm: must be 2 to 50 times the wire's 4 mm"),
        ("spring", {"pitch": "8 mm, six"}, r"wire.pitch\[2\]"),
        ("spring", {"pitch": "8 mm", "free_length": 0.05}, "free_length: follows from the pitch"),
    ],
)
def test_what_an_analysis_cannot_take_is_named(name, values, message):
    analysis = load(name)
    with pytest.raises(MistakeError, match=message):
        analysis.evaluate(analysis.complete(values))


def test_a_result_is_not_overwritten_unasked(tmp_path):
    (tmp_path / "exponents.nc").write_text("mine")
    with pytest.raises(MistakeError, match="overwrite=True"):
        analyse("exponents", ["cycles=20"], tmp_path)
    assert (tmp_path / "exponents.nc").read_text() == "mine"
    analyse("exponents", ["cycles=20"], tmp_path, overwrite=True)
    assert (tmp_path / "exponents.nc").read_bytes() != b"mine"


def test_a_setting_is_read_as_toml_where_it_is_toml():
    said = {"a=1": 1, "a = 0.5": 0.5, "a=true": True, 'a="x"': "x", "a=8 mm": "8 mm", "a=x": "x"}
    assert {text: parse_setting(text) for text in said} == {text: ("a", one) for text, one in said.items()}


def test_poincare_map_ends_early_with_enough_impacts():
    """Counted to the end of a batch of cycles; what is per cycle does not change."""
    values = {"form": "as_published", "damping": 0.25, "gap": 0.015, "transient": 50}
    analysis = load("poincare")
    short, all_ = (
        analysis.evaluate(analysis.complete({**values, "cycles": cycles, "most": most}))
        for cycles, most in ((1000, 20_000), (200, 10**6))
    )
    assert short["seen"] == 200
    assert short == all_


PAGE = (Path(__file__).parents[2] / "docs" / "reference" / "analyses.md").read_text("utf-8")
COMMANDS = [shlex.split(line) for line in PAGE.split("```sh\n")[1].split("```")[0].splitlines()]


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command[2])
def test_the_pages_commands_are_understood(command):
    """Every parameter exists and takes the value."""
    program, verb, name, *rest = command
    assert (program, verb, set(rest[::2])) == ("tribocosim", "analyse", {"--set"})
    load(name).complete(dict(parse_setting(text) for text in rest[1::2]))


def test_what_is_refused_while_it_computes_leaves_nothing_and_takes_nothing(tmp_path):
    """No empty folder, and no result replaced by none."""
    with pytest.raises(MistakeError, match="between the walls"):
        analyse("trace", ["psi=0.02"], tmp_path / "new" / "deep")
    assert not list(tmp_path.iterdir())
    analyse("trace", ["cycles=1", "points=20"], tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    with pytest.raises(MistakeError, match="between the walls"):
        analyse("trace", ["psi=0.02"], tmp_path, overwrite=True)
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.parametrize(
    ("halves", "text"), [(0, "0"), (1, "π/2"), (2, "π"), (3, "3π/2"), (4, "2π"), (-1, "−π/2"), (-2, "−π")]
)
def test_angles_are_written_in_pi(halves: int, text: str) -> None:
    assert format_angle(0.5 * math.pi * halves) == text


@given(turns=st.integers(0, 10**6), phase=st.floats(0.0, 6.2))
@settings(derandomize=True, deadline=None)
def test_angles_count_from_their_own_revolution(turns: int, phase: float) -> None:
    """To the resolution of so large an angle."""
    theta = np.array([2.0 * math.pi * turns, 2.0 * math.pi * turns + phase])
    assert shift_to_first_turn(theta) == pytest.approx([0.0, phase], abs=1e-9)


def test_a_window_is_so_much_smaller_around_the_nearest_point_and_shows_the_points_in_it() -> None:
    theta, rate = np.array([1.0, 2.0, 3.0]), np.array([0.1, 0.2, 0.3])
    window = magnify(theta, rate, (1.9, 0.21), 5.0)
    assert window == pytest.approx((2.0 - 0.2 * math.pi, 2.0 + 0.2 * math.pi, 0.18, 0.22))
    _, axes = create_subplots()
    draw_poincare(axes, theta, rate, window)
    np.testing.assert_array_equal(axes.collections[0].get_offsets(), [[2.0, 0.2]])


def test_the_phase_portrait_of_an_analysis_is_cut_where_the_angle_stands_still() -> None:
    """At impacts: no line leads from before one to after it but the jump's own."""
    psi, rate = [0.0, 1e-2, 1e-2, 0.0], [1.0, 1.0, -0.9, -0.9]
    columns = {"theta": [0.0, 1.0, 1.0, 2.0], "psi": psi, "psi_rate": rate, "side": [0.0] * 4, "upper": psi}
    phase = load("phase")
    table = xarray.Dataset({name: ("point", values) for name, values in columns.items()})
    (axes,) = phase.draw(table, phase.complete({})).axes
    *_, line = axes.lines
    np.testing.assert_array_equal(line.get_ydata(), [1.0, 1.0, np.nan, -0.9, -0.9])
    (jump,) = axes.collections[0].get_segments()
    np.testing.assert_array_equal(jump, [[10.0, 1.0], [10.0, -0.9]])


def test_an_interrupted_analysis_says_what_is_kept(monkeypatch, tmp_path):
    monkeypatch.setattr(_evaluate, "compute_table", Mock(side_effect=KeyboardInterrupt))
    done = called("analyse", "cam", "--out", str(tmp_path / "out"))
    assert done.returncode == 130
    assert done.stderr.endswith("interrupted; only compiled code is kept: the same command begins anew\n")
    assert not (tmp_path / "out").exists()
