"""The store of a study: the same however and in whatever order its points came, and never another's."""

import contextlib
import json
from pathlib import Path
from tempfile import TemporaryDirectory
from types import SimpleNamespace

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
from orchestrator.study.store import DONE, FAILED, PENDING, Store, open_store

from .studies import (
    PICKY,
    PLAIN,
    VERSIONS,
    compute_outcome,
    fill_store,
    open_small_chunks,
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


def test_points_counted_as_finished_at_ctrl_c_are_in_the_store(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "store.zarr"
    batch = [(index, compute_outcome(PLAN, index)) for index in (0, 5)]
    execution = SimpleNamespace(outcomes=lambda pending: iter([batch]))
    workers = SimpleNamespace(nthreads=lambda: {"one": 1})
    monkeypatch.setattr(study, "connect", lambda *where: contextlib.nullcontext(workers))
    monkeypatch.setattr(study, "Execution", lambda *arguments: execution)
    monkeypatch.setattr(module, "Store", _Interrupted)
    with pytest.raises(KeyboardInterrupt, match="2 points are kept"):
        study.run(PLAN, path, study.Where(), Reporter(Console(quiet=True)))
    assert np.flatnonzero(Store(path).status != PENDING).tolist() == [0, 5]


class Killed(BaseException):
    pass


@given(st.permutations(range(12)), st.lists(st.integers(0, 30), max_size=3))
@settings(derandomize=True, deadline=None, max_examples=10)
def test_order_and_kills_leave_no_trace(order: list[int], kills: list[int]) -> None:
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
def test_what_says_done_has_its_results(kill: int, tmp_path: Path) -> None:
    """Whatever file of the first two points a kill comes before."""
    with contextlib.suppress(Killed):
        evaluate_until(tmp_path / "store.zarr", [4, 0], kill)
    with xarray.open_zarr(tmp_path / "store.zarr") as found:
        done, failed = found["status"].values == DONE, found["status"].values == FAILED
        assert (int(done.sum()), int(failed.sum())) == (kill >= 4, kill >= 8)
        assert np.isfinite(found["sum"].values[done]).all()
        assert (found["message"].values[failed] != "").all()


def test_failed_points_are_pending_again_on_request(tmp_path: Path) -> None:
    path = fill_store(tmp_path / "store.zarr", PLAN)
    with open_small_chunks(path, PLAN) as store:
        failed = np.flatnonzero(store.status == FAILED).tolist()
        assert [PLAN.points[i]["x"] for i in failed] == [-2.0] * 4
        assert store.pending() == []
        store.retry_failed()
        assert store.pending() == failed
    with open_small_chunks(path, PLAN) as store:
        assert store.pending() == failed


def test_xarray_reads_units_texts_and_flags(tmp_path: Path) -> None:
    with open_small_chunks(tmp_path / "store.zarr", PLAN):
        pass
    with xarray.open_zarr(tmp_path / "store.zarr") as found:
        assert found["mode"].values.tolist() == ["plain", "square"]
        assert found["sum"].dims == ("x", "y", "mode")
        assert found["sum"].attrs == {"long_name": "x + y", "units": "m"}
        assert found["status"].attrs["flag_meanings"] == "pending done failed"
        assert np.isnan(found["sum"]).all()
        assert json.loads(found.attrs["versions"]) == VERSIONS


def test_sobol_points_are_coordinates_along_one_dimension(tmp_path: Path) -> None:
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
def test_another_studys_store_is_refused_or_replaced(other: str, tmp_path: Path) -> None:
    path, plan = tmp_path / "store.zarr", OTHERS[other]
    with open_small_chunks(path, PLAN):
        before = read_files(path)
    with pytest.raises(MistakeError, match="overwrite=True"), open_small_chunks(path, plan):
        pass
    assert read_files(path) == before
    with open_small_chunks(path, plan, overwrite=True) as store:
        assert len(store.pending()) == len(plan.points)


def test_a_store_of_another_version_or_in_use_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "store.zarr"
    with open_small_chunks(path, PLAN), pytest.raises(MistakeError), open_small_chunks(path, PLAN):
        pass
    other = VERSIONS | {"numba": "0.61"}
    with pytest.raises(MistakeError, match=r"numba 0.61"), open_store(path, PLAN, other, False):
        pass


def test_a_folder_that_is_no_store_is_never_replaced(tmp_path: Path) -> None:
    file = tmp_path / "folder" / "file"
    file.parent.mkdir()
    file.touch()
    with pytest.raises(MistakeError), open_small_chunks(file.parent, PLAN, overwrite=True):
        pass
    assert file.exists()


def test_a_place_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    store = tmp_path / "file" / "store.zarr"
    with pytest.raises(MistakeError, match="choose another out"), open_small_chunks(store, PLAN):
        pass
