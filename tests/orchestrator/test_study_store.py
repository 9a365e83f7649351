"""The store of a study, the same however its points came and never another's; its table and figure."""

import contextlib
import csv
import json
from pathlib import Path
from tempfile import TemporaryDirectory
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.console import Console

from orchestrator.errors import MistakeError
from orchestrator.reporter import Reporter
from orchestrator.study import run as study
from orchestrator.study import store as module
from orchestrator.study.figure import draw_figure
from orchestrator.study.store import DONE, FAILED, PENDING, Store, open_store
from orchestrator.study.table import write_table
from orchestrator.study.task import Outcome

from .studies import (
    PICKY,
    PLAIN,
    VERSIONS,
    compute_outcome,
    fill_store,
    open_small_chunks,
    plan_scenario,
    plan_study,
    read_files,
)

GRID = {"kind": "grid", "axes": {"x": [-2.0, 0.0, 2.0], "y": [1.0, 2.0], "mode": ["plain", "square"]}}


PLAN = plan_study(GRID, PICKY)


class _Interrupted(Store):
    """Ctrl-C comes as the first batch is about to be written."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self._asked = False

    def flush(self) -> None:
        if not self._asked:
            self._asked = True
            raise KeyboardInterrupt
        super().flush()


def test_points_counted_as_finished_at_ctrl_c_are_in_the_store(tmp_path, monkeypatch):
    path = tmp_path / "store.zarr"
    batch = [(index, compute_outcome(PLAN, index)) for index in (0, 5)]
    execution = SimpleNamespace(outcomes=lambda pending: iter([batch]))
    workers = SimpleNamespace(nthreads=lambda: {"one": 1})
    monkeypatch.setattr(study, "connect", lambda *where: contextlib.nullcontext(workers))
    monkeypatch.setattr(study, "Execution", lambda *arguments: execution)
    monkeypatch.setattr(module, "Store", _Interrupted)
    with pytest.raises(KeyboardInterrupt, match="2 points kept"):
        study.run(PLAN, path, study.Where(), Reporter(Console(quiet=True)))
    assert np.flatnonzero(Store(path).status != PENDING).tolist() == [0, 5]


class Killed(BaseException):
    pass


@given(st.permutations(range(12)), st.lists(st.integers(0, 30), max_size=3))
@settings(derandomize=True, deadline=None, max_examples=10)
def test_order_and_kills_leave_no_trace(order, kills):
    """A kill comes after any number of files that a start has written."""
    with TemporaryDirectory() as name:
        straight, disturbed = fill_store(Path(name) / "straight.zarr", PLAN), Path(name) / "disturbed.zarr"
        for kill in [*kills, None]:
            with contextlib.suppress(Killed):
                evaluate_until(disturbed, order, kill)
        assert read_files(disturbed) == read_files(straight)


def evaluate_until(path: Path, order: list[int], kill: int | None) -> None:
    """Evaluate what is pending, written point by point, until `kill` files are written."""
    written = 0

    def write(self: Store, name: str, chunk: tuple[int, ...]) -> None:
        nonlocal written
        if written == kill:
            raise Killed
        written += 1
        original(self, name, chunk)

    original = module.Store._write
    with pytest.MonkeyPatch.context() as patch, open_small_chunks(path, PLAN) as store:
        patch.setattr(module.Store, "_write", write)
        for index in order:
            if store.status[index] == PENDING:
                store.record(index, compute_outcome(PLAN, index))
                store.flush()


@pytest.mark.parametrize("kill", range(1, 9))
def test_what_says_done_has_its_results(kill, tmp_path):
    """Whatever file of the first two points a kill comes before."""
    with contextlib.suppress(Killed):
        evaluate_until(tmp_path / "store.zarr", [4, 0], kill)
    with xarray.open_zarr(tmp_path / "store.zarr") as found:
        done, failed = found["status"].values == DONE, found["status"].values == FAILED
        assert (int(done.sum()), int(failed.sum())) == (kill >= 4, kill >= 8)
        assert np.isfinite(found["sum"].values[done]).all()
        assert (found["message"].values[failed] != "").all()


def test_failed_points_are_pending_again_on_request(tmp_path):
    path = fill_store(tmp_path / "store.zarr", PLAN)
    with open_small_chunks(path, PLAN) as store:
        failed = np.flatnonzero(store.status == FAILED).tolist()
        assert [PLAN.points[i]["x"] for i in failed] == [-2.0] * 4
        assert store.pending() == []
        store.retry_failed()
        assert store.pending() == failed
    with open_small_chunks(path, PLAN) as store:
        assert store.pending() == failed


def test_xarray_reads_units_texts_and_flags(tmp_path):
    with open_small_chunks(tmp_path / "store.zarr", PLAN):
        pass
    with xarray.open_zarr(tmp_path / "store.zarr") as found:
        assert found["mode"].values.tolist() == ["plain", "square"]
        assert found["sum"].dims == ("x", "y", "mode")
        assert found["sum"].attrs == {"long_name": "x + y", "units": "m"}
        assert found["status"].attrs["flag_meanings"] == "pending done failed"
        assert np.isnan(found["sum"]).all()
        assert json.loads(found.attrs["versions"]) == VERSIONS


def test_sobol_points_are_coordinates_along_one_dimension(tmp_path):
    ranges = {"x": {"low": -2.0, "high": 2.0}, "y": {"low": 0.0, "high": 1.0}}
    plan = plan_study({"kind": "sobol", "ranges": ranges, "count": 32, "seed": 5})
    with xarray.open_zarr(fill_store(tmp_path / "store.zarr", plan)) as found:
        assert set(found.coords) == {"x", "y"}
        assert found["x"].dims == ("point",)
        assert np.array_equal(found["sum"], found["x"] + found["y"])
        assert np.array_equal(found["sign"] == "-", found["sum"] < 0.0)
        assert json.loads(found.attrs["study"])["points"]["seed"] == 5


OTHERS = {
    "other points": plan_study(GRID | {"axes": GRID["axes"] | {"y": [1.0, 3.0]}}, PICKY),
    "another study": plan_study(GRID, PLAIN),
    "fewer": plan_study({"kind": "grid", "axes": {"x": [-2.0, 0.0, 2.0]}}, PICKY),
}


@pytest.mark.parametrize("other", OTHERS)
def test_another_studys_store_is_refused_or_replaced(other, tmp_path):
    path, plan = tmp_path / "store.zarr", OTHERS[other]
    with open_small_chunks(path, PLAN):
        before = read_files(path)
    with pytest.raises(MistakeError, match="overwrite=True"), open_small_chunks(path, plan):
        pass
    assert read_files(path) == before
    with open_small_chunks(path, plan, overwrite=True) as store:
        assert len(store.pending()) == len(plan.points)


def test_a_store_of_another_version_or_in_use_is_refused(tmp_path):
    path = tmp_path / "store.zarr"
    with open_small_chunks(path, PLAN), pytest.raises(MistakeError), open_small_chunks(path, PLAN):
        pass
    other = VERSIONS | {"numba": "0.61"}
    with pytest.raises(MistakeError, match=r"numba 0.61"), open_store(path, PLAN, other, False):
        pass


def test_a_folder_that_is_no_store_is_never_replaced(tmp_path):
    file = tmp_path / "folder" / "file"
    file.parent.mkdir()
    file.touch()
    with pytest.raises(MistakeError), open_small_chunks(file.parent, PLAN, overwrite=True):
        pass
    assert file.exists()


def test_a_place_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "file").touch()
    store = tmp_path / "file" / "store.zarr"
    with pytest.raises(MistakeError, match="choose another out"), open_small_chunks(store, PLAN):
        pass


SPEED = {"speed": ["components.flywheel.parameters.initial_speed"]}


def rows(store: Path) -> list[dict[str, str]]:
    """The table of a store."""
    path = store.with_suffix(".csv")
    with xarray.open_zarr(store) as found:
        write_table(found, path)
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_the_table_has_a_line_for_each_point_with_units_and_exact_numbers(tmp_path):
    axes = {"y": [0.1, 0.2], "x": [1.0 / 3.0, -1.0, 2.0]}
    found = rows(fill_store(tmp_path / "s.zarr", plan_study({"kind": "grid", "axes": axes}, PICKY)))
    assert [(float(row["y"]), float(row["x [m]"])) for row in found] == [
        (y, x) for y in axes["y"] for x in axes["x"]
    ]
    for row in found:
        if float(row["x [m]"]) < 0.0:
            assert (row["status"], row["sum [m]"]) == ("failed", "")
            assert "no root" in row["message"]
        else:
            assert row["status"] == "done"
            assert float(row["sum [m]"]) == float(row["x [m]"]) + float(row["y"])


def test_the_table_of_single_points_has_their_parameters(tmp_path):
    points = [{"x": 1.0, "mode": "plain"}, {"x": 3.0, "mode": "square"}]
    found = rows(fill_store(tmp_path / "s.zarr", plan_study({"kind": "list", "rows": points})))
    assert [(row["x [m]"], row["mode"], row["sum [m]"]) for row in found] == [
        ("1.0", "plain", "2.0"),
        ("3.0", "square", "16.0"),
    ]


def draw(folder: Path, axes: dict[str, Any], analysis: str = PLAIN) -> Any:
    """The first panel of the figure of a grid."""
    store = fill_store(folder / "s.zarr", plan_study({"kind": "grid", "axes": axes}, analysis))
    with xarray.open_zarr(store) as found:
        return draw_figure(found.load(), ["sum"]).axes[0]


def test_one_axis_is_a_curve(tmp_path):
    axes = draw(tmp_path, {"x": [1.0, 2.0, 4.0]})
    (line,) = axes.lines
    assert np.array_equal(line.get_xydata(), [(1.0, 2.0), (2.0, 3.0), (4.0, 5.0)])
    assert axes.get_xlabel() == "abscissa (m)"


def test_an_axis_of_few_values_or_of_names_gives_curves(tmp_path):
    axes = draw(tmp_path, {"mode": ["plain", "square"], "x": [1.0, 2.0, 3.0]})
    assert [line.get_label() for line in axes.lines] == ["plain", "square"]
    assert np.array_equal(axes.lines[1].get_ydata(), [4.0, 9.0, 16.0])


def test_two_long_axes_are_a_map_with_gaps_where_points_failed(tmp_path):
    ys = [float(k) for k in range(1, 8)]
    (mesh,) = draw(tmp_path, {"x": [float(k) for k in range(-1, 7)], "y": ys}, PICKY).collections
    values = mesh.get_array().reshape(7, 8)
    assert values.mask[:, 0].all()
    assert not values.mask[:, 1:].any()
    assert np.array_equal(values[:, 1], ys)


def test_a_result_that_cannot_be_drawn_is_refused():
    for name in ("sun", "sign"):
        with pytest.raises(MistakeError, match=f"figure: .*'{name}'"):
            plan_study({"kind": "grid", "axes": {"x": [1.0, 2.0]}}, figure=[name])


@pytest.mark.parametrize(("stop", "doubted"), [(1400.0, True), ("14000 rpm", False)])
def test_numbers_without_a_unit_are_doubted_in_studies_too(stop, doubted):
    axis = {"start": 60.0 if doubted else "600 rpm", "stop": stop, "count": 2}
    plan = plan_scenario({"kind": "grid", "axes": {"speed": axis}}, names=SPEED)
    said = plan.subject.list_warnings(plan.points[1])
    own = [line for line in said if "coil bind" not in line]
    assert ["did you mean 1400 rpm?" in line for line in own] == [doubted]  # one with its unit is believed


def test_a_point_that_failed_keeps_its_message(tmp_path):
    plan = plan_study({"kind": "grid", "axes": {"x": [1.0]}})
    with open_small_chunks(tmp_path / "s.zarr", plan) as store:
        store.record(0, Outcome({}, 'a "message", with a comma'))
        store.flush()
    assert rows(tmp_path / "s.zarr")[0]["message"] == 'a "message", with a comma'
