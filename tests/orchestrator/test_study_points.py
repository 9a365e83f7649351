"""Studies as files: what points expand to, a point that is a run, and one clear message for each mistake."""

import itertools
import math
import re
import tomllib
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
import xarray
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.console import Console
from scipy.stats import qmc

from orchestrator import analyses
from orchestrator.errors import MistakeError, RunError
from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import run
from orchestrator.scenario.files import load as load_scenario
from orchestrator.store.result_file import open_result
from orchestrator.study.files import list_shipped, load
from orchestrator.study.source import compute_fingerprint
from orchestrator.study.store import CHUNK, choose_chunks
from orchestrator.study.subjects import AnalysisSubject
from orchestrator.study.task import Outcome, evaluate

from .commands import HERE
from .studies import PLAIN, compute_outcome, plan_scenario, plan_study, refuse_build

NUMBERS = st.lists(st.floats(-10.0, 10.0), min_size=1, max_size=4, unique=True)


@given(NUMBERS, NUMBERS)
@settings(derandomize=True, deadline=None)
def test_a_grid_is_the_product_of_its_axes(xs, ys):
    points = plan_study({"kind": "grid", "axes": {"x": xs, "y": ys}}).points
    assert points.shape == (len(xs), len(ys))
    found = [(point["x"], point["y"]) for point in (points[i] for i in range(len(points)))]
    assert found == list(itertools.product(xs, ys))


@given(st.lists(st.tuples(st.floats(-10.0, 10.0), st.floats(-1e9, 1e9)), min_size=1, max_size=9))
@settings(derandomize=True, deadline=None)
def test_a_list_is_its_rows_in_order(rows):
    points = plan_study({"kind": "list", "rows": [{"x": x, "y": y} for x, y in rows]}).points
    assert [(points[i]["x"], points[i]["y"]) for i in range(len(points))] == rows


@given(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0), st.integers(2, 40))
@settings(derandomize=True, deadline=None)
def test_a_linear_axis_has_both_ends_and_equal_steps(start, stop, count):
    if start == stop:
        return
    axis = {"start": start, "stop": stop, "count": count}
    values = np.array(plan_study({"kind": "grid", "axes": {"x": axis}}).points.coordinates["x"])
    assert len(values) == count
    assert (values[0], values[-1]) == (start, stop)
    # Each value is rounded twice, at the size of the larger end.
    rounding = 4.0 * np.spacing(max(abs(start), abs(stop)))
    assert np.diff(values) == pytest.approx((stop - start) / (count - 1), rel=0.0, abs=rounding)


def test_a_logarithmic_axis_has_equal_ratios():
    axis = {"start": "1 mm", "stop": "10 m", "count": 5, "spacing": "logarithmic"}
    values = plan_study({"kind": "grid", "axes": {"x": axis}}).points.coordinates["x"]
    assert values == pytest.approx([1e-3, 1e-2, 1e-1, 1.0, 10.0], rel=1e-14)  # rounding of a power


def _sobol(seed: int, count: int = 256) -> np.ndarray:
    ranges = {"x": {"low": -1.0, "high": 3.0}, "y": {"low": 2.0, "high": 4.0}}
    points = plan_study({"kind": "sobol", "ranges": ranges, "count": count, "seed": seed}).points
    values = np.array([points.coordinates["x"], points.coordinates["y"]]).T
    return (values - [-1.0, 2.0]) / [4.0, 2.0]


@pytest.mark.parametrize("seed", [0, 1, 20261121])
def test_sobol_points_are_balanced_and_of_low_discrepancy(seed):
    """A scrambled (t, m, s)-net of 2^m points in two dimensions has t = 0: each of the 2^m boxes of equal
    volume of every shape holds one point."""
    points = _sobol(seed)
    for k in range(9):
        boxes = np.floor(points * [2**k, 2 ** (8 - k)])
        assert len(np.unique(boxes, axis=0)) == 256
    random = np.random.default_rng(seed).random((256, 2))
    assert qmc.discrepancy(points) < 0.1 * qmc.discrepancy(random)


def test_sobol_points_are_those_of_their_seed():
    assert np.array_equal(_sobol(7), _sobol(7))
    assert not np.array_equal(_sobol(7), _sobol(8))


@given(st.lists(st.integers(1, 300), min_size=1, max_size=4))
@settings(derandomize=True, deadline=None)
def test_chunks_are_bounded_and_few(shape):
    chunks = choose_chunks(shape)
    assert math.prod(chunks) <= CHUNK
    assert all(1 <= chunk <= size for chunk, size in zip(chunks, shape, strict=True))
    if math.prod(shape) <= CHUNK:
        assert list(chunks) == shape


MISTAKES = {
    "analysis = 'plain'": "no analysis 'plain'",
    "analysis = 'exponent'": "did you mean exponents?",
    "analysis = 'nowhere:PLAIN'": "cannot be imported (No module named 'nowhere')",
    "analysis = 'numpy:pi'": "must be an orchestrator.analyses.Analysis",
    "analysis = 'exponents'\nscenario = 'valve-train'": "must have one of scenario and analysis",
    "": "must have one of scenario and analysis",
    "analyss = 'exponents'": "analyss: unknown key; did you mean analysis?",
    "scenario = 'valve-tran'": "did you mean valve-train?",
    f"analysis = '{PLAIN}'\nfixed.y = 1": "fixed.y: is also a parameter of the points",
    f"analysis = '{PLAIN}'\nfixed.z = 1": "plain has no parameter 'z'",
    f"analysis = '{PLAIN}'\nfixed.mode = 'plan'": "mode = 'plan' (kind of sum): did you mean plain?",
    f"analysis = '{PLAIN}'\nfixed.n = 1.5": "n = 1.5 (count): must be a whole number",
    f"analysis = '{PLAIN}'\nfixed.x = '3 kg'": "does not fit a length; write m or mm",
    f"analysis = '{PLAIN}'\nnames.a = ['x']": "names: are for settings of a scenario",
    f"analysis = '{PLAIN}'\n[grid]\nx = [1.0]": "grid: belongs in the table [points]",
}


@pytest.mark.parametrize("text", MISTAKES)
def test_a_mistaken_study_is_one_message(text, tmp_path):
    file = tmp_path / "mistaken.toml"
    file.write_text(f"{text}\n[points]\nkind = 'grid'\naxes.y = [1.0]\n")
    with pytest.raises(MistakeError) as caught:
        load(str(file), refuse_build)
    assert MISTAKES[text] in str(caught.value)
    assert str(caught.value).startswith("mistaken.toml: ")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["", "none.toml"])
def test_a_place_without_a_study_is_named(name, tmp_path):
    with pytest.raises(MistakeError, match=str(tmp_path / name)) as caught:
        load(str(tmp_path / name), refuse_build)
    assert caught.value.remedies


BAD_POINTS = {
    "kind = 'gird'": "no kind of points 'gird'; did you mean grid?",
    "axes.x = [1]": "kind is missing; known: grid, sobol, list",
    "kind = 'grid'\naxes.z = [1.0]": "plain has no parameter 'z'; known: x, y, n, mode, folder",
    "kind = 'grid'\naxes.x = [1.0, 11.0]": "x = 11 m (abscissa): must be >= -10 and <= 10",
    "kind = 'grid'\naxes.x = [1.0, 1.0]": "points.axes.x: has a value twice",
    "kind = 'grid'\naxes.x = []": "points.axes.x.values = []: must have at least one entry",
    "kind = 'grid'\naxes.x = 1.0": "must be a list of values, or a table with start, stop and count",
    "kind = 'grid'\naxes.x = { start = 0, stop = 1 }": "points.axes.x.count: missing",
    "kind = 'grid'\naxes.x = { start = 0, stpo = 1, stop = 1, count = 2 }": "stpo: unknown key; did you mean",
    "kind = 'grid'\naxes.x = { start = 0, stop = 1, count = 2, spacing = 'logarithmic' }": "values > 0",
    "kind = 'grid'\naxes.x = { start = 0, stop = 11, count = 2 }": "x = 11 m",
    "kind = 'grid'\naxes.n = { start = 1, stop = 2, count = 3 }": "n = 1.5 (count): must be a whole number",
    "kind = 'grid'\naxes.mode = { start = 'plain', stop = 'square', count = 2 }": "list the values",
    "kind = 'sobol'\nranges.x = { low = 0, high = 1 }\ncount = 100\nseed = 1": "power of two",
    "kind = 'sobol'\nranges.x = { low = 0, high = 1 }\ncount = 64": "points.seed: missing",
    "kind = 'list'\nrows = [{ x = 1 }, { y = 1 }]": "row 2 and the first do not both set x, y",
    "kind = 'grid'\naxes.x = { start = 0, stop = 1, count = 10000 }\n"
    "axes.y = { start = 0, stop = 1, count = 10000 }": "1e+08 of them; at most 1e+07",
}


@pytest.mark.parametrize("text", BAD_POINTS)
def test_mistaken_points_are_one_message(text):
    with pytest.raises(MistakeError) as caught:
        plan_study(tomllib.loads(text))
    assert BAD_POINTS[text] in str(caught.value)
    assert "\n" not in str(caught.value)


def test_values_mean_what_the_scenario_takes_them_for():
    speed = [f"components.flywheel.parameters.{name}_speed" for name in ("initial", "final")]
    axes = {"speed": ["600 rpm"], "macro_step": ["2 us"], "master.extrapolation": ["hold"]}
    plan = plan_scenario(
        {"kind": "grid", "axes": axes}, names={"speed": speed}, fixed={"reference.enabled": False}
    )
    assert plan.points[0] == {
        "speed": pytest.approx(20.0 * math.pi, rel=1e-15),
        "macro_step": 2e-6,
        "master.extrapolation": "hold",
    }
    assert plan.subject.describe("speed").unit == "rad/s"
    assert not any(name.endswith(".error") for name in plan.subject.results)


SETTINGS = {
    "components.camshaft.parameters.lft": "did you mean lift?",
    "components.camshft.parameters.lift": "did you mean camshaft?",
    "macro_stp": "did you mean macro_step?",
}


@pytest.mark.parametrize("path", SETTINGS)
@pytest.mark.parametrize("fixed", [True, False])
def test_an_unknown_setting_of_a_scenario_is_named(path, fixed):
    axes = {"macro_step": [1e-6]} | ({} if fixed else {path: [1.0]})
    with pytest.raises(MistakeError, match=re.escape(SETTINGS[path])):
        plan_scenario({"kind": "grid", "axes": axes}, fixed={path: 1.0} if fixed else {})


def test_a_fixed_value_in_whose_place_an_axis_comes_is_refused():
    """A wire gives the spring's rate. What both may have stays."""
    spring, axis = "components.valve_spring", "components.valve_spring.wire.diameter"
    points = {"kind": "grid", "axes": {axis: ["3.8 mm", "4 mm"]}}
    rate = f"{spring}.parameters.spring_rate"
    with pytest.raises(MistakeError, match=f"fixed.{rate}: {axis} of the points takes its place; leave"):
        plan_scenario(points, fixed={rate: "30 N/mm"})
    subject = plan_scenario(
        {"kind": "grid", "axes": {rate: ["30 N/mm"]}}, fixed={f"{spring}.parameters.valve_mass": "0.2 kg"}
    ).subject
    assert subject.tables["components"]["valve_spring"]["parameters"]["valve_mass"] == "0.2 kg"


def test_every_shipped_study_and_analysis_is_whole():
    assert list_shipped()
    for name in list_shipped():
        assert len(load(name, refuse_build).points) > 1
    for name in analyses.list_analyses():
        analysis = analyses.load(name)
        assert analysis.name == name
        assert analysis.complete({}) == {key: value.default for key, value in analysis.parameters.items()}
        for key, parameter in analysis.parameters.items():
            assert parameter.check_value(key, parameter.default) == parameter.default


LIFT = "components.camshaft.parameters.lift"


def plan(rows: list[dict[str, Any]]) -> Any:
    fixed = {"stop_time": "2 ms"} | dict(text.split("=") for text in HERE)
    return plan_scenario({"kind": "list", "rows": rows}, fixed=fixed)


def test_results_are_those_of_the_run(tmp_path):
    study = plan([{LIFT: "9 mm", "macro_step": "10 us"}])
    found = study.subject.evaluate(study.points[0])
    assert set(found) == set(study.subject.results)
    scenario = load_scenario("valve-train", [*HERE, "stop_time=2 ms", f"{LIFT}=9 mm", "macro_step=10 us"])
    summary = run(scenario, tmp_path, refuse_build, Reporter(Console(quiet=True)), figures=False)
    assert found["macro_steps"] == summary.macro_steps == 200
    assert found["iterations"] == summary.iterations
    for name, error in summary.errors.items():
        assert found[f"{name}.error"] == error.relative_rms
        assert found[f"{name}.uncertainty"] == error.uncertainty.relative_rms
    # Those of a contact are of all macro steps, of which every second one is recorded.
    contact = summary.contacts["contact"]
    assert found["contact.load.maximum"] == contact.largest_load
    assert found["contact.load.minimum"] == contact.least_load
    assert found["contact.maximum_pressure.maximum"] == contact.pressure
    assert (found["contact.separations"], found["contact.impact_load"]) == (0.0, 0.0)
    with open_result(tmp_path) as tree:
        for name, values in tree["coupled"].data_vars.items():
            if name not in ("contact.load", "contact.maximum_pressure"):
                assert found[f"{name}.minimum"] == values.min()
                assert found[f"{name}.maximum"] == values.max()
            assert found[f"{name}.mean"] == pytest.approx(np.mean(values.values), rel=1e-15, abs=0.0)


@pytest.mark.long
def test_an_oil_is_studied_over_grades_and_temperatures(tmp_path):
    """Hotter, or of a thinner grade, it makes a thinner film."""
    oil, temperature = "components.contact.oil", "components.contact.temperature"
    rows = [
        {oil: "SAE 5W-30", temperature: "60 degC"},
        {oil: "SAE 5W-30", temperature: "120 degC"},
        {oil: "SAE 0W-16", temperature: "120 degC"},
    ]
    file = tmp_path / "oil.toml"
    file.write_text(
        'extends = "valve-train"\n[components.contact]\noil = "SAE 30"\ntemperature = "90 degC"\n'
    )
    fixed = {"stop_time": "2 ms", "reference.enabled": False} | dict(text.split("=") for text in HERE)
    study = plan_study({"kind": "list", "rows": rows}, None, scenario=str(file), fixed=fixed)
    assert [point[temperature] for point in study.points] == [333.15, 393.15, 393.15]
    assert study.subject.describe(temperature).unit == "K"
    (told,) = study.subject.list_warnings(study.points[2])
    assert told.startswith("contact: SAE 0W-16 at 120 degC has a viscosity of")
    films = [study.subject.evaluate(point)["contact.steady_film_thickness.mean"] for point in study.points]
    assert films[0] > 2.0 * films[1] > 2.0 * films[2]


def test_a_run_that_fails_is_a_failed_point_with_its_message():
    study = plan([{"macro_step": "1 ms", LIFT: "9 mm"}, {"macro_step": "10 us", LIFT: "-9 mm"}])
    with pytest.raises(RunError, match="halve them with"):
        study.subject.evaluate(study.points[0] | {"stop_time": 0.05, "reference.enabled": False})
    outcome = evaluate(
        study.subject, study.points[0] | {"stop_time": 0.05}, compute_fingerprint(study.subject)
    )
    assert "halve them with" in outcome.message
    assert outcome.values["contact.load.maximum"] > 0.0
    with pytest.raises(ValueError, match="lift"):
        study.subject.evaluate(study.points[1])


def test_workers_of_another_version_do_not_evaluate():
    study = plan([{"macro_step": "10 us"}])
    found = evaluate(study.subject, study.points[0], {"tribocosim": "0" * 16})
    assert isinstance(found, str)
    assert found.startswith("computes with tribocosim ")


OWN = """
import xarray
from orchestrator.analyses import Parameter, Result
from orchestrator.analyses.protocol import declare

ANALYSIS = declare(
    "own", "twice x", lambda values: xarray.Dataset({"y": FACTOR * values["x"]}), None,
    parameters={"x": Parameter(1.0, "m", "x")}, results={"y": Result("m", "y")},
)
"""


def test_a_change_in_the_file_of_an_analysis_changes_its_version(tmp_path, monkeypatch):
    """Also where its `evaluate` is made in another file, from a table."""
    monkeypatch.chdir(tmp_path)
    versions = set()
    for factor in ("2.0", "3.0"):
        file = Path(f"by_{factor[0]}.py")
        file.write_text(OWN.replace("FACTOR", factor))
        subject = AnalysisSubject(f"{file}:ANALYSIS", {})
        assert subject.evaluate({}) == {"y": float(factor)}
        versions.add(compute_fingerprint(subject)[subject.name])
    assert len(versions) == 2


def test_a_point_that_writes_a_file_asks_for_no_client(tmp_path, monkeypatch):
    """A worker that is stopped with a client of its own reports that it cannot close it."""
    plan, asked, file = (
        plan_study({"kind": "list", "rows": [{}]}),
        Mock(side_effect=ValueError),
        tmp_path / "x.nc",
    )
    write = lambda subject, values: xarray.Dataset().to_netcdf(file, engine="h5netcdf") or {}  # noqa: E731
    monkeypatch.setattr(type(plan.subject), "evaluate", write)
    monkeypatch.setattr("distributed.get_client", asked)
    assert compute_outcome(plan, 0) == Outcome({})
    assert file.exists()
    asked.assert_not_called()
