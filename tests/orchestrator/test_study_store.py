"""The store of a study: the same however and in whatever order its points came, and never another's."""

import contextlib
import json
from collections.abc import Iterator
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
from orchestrator.study.files import Plan
from orchestrator.study.source import compute_fingerprint
from orchestrator.study.store import DONE, FAILED, PENDING, Store, open_store
from orchestrator.study.task import Outcome, evaluate

from .test_study_points import PLAIN, planned

PICKY = "tests.orchestrator.studied:PICKY"
VERSIONS = {"tribocosim": "1234", "numba": "0.60"}
GRID = {"kind": "grid", "axes": {"x": [-2.0, 0.0, 2.0], "y": [1.0, 2.0], "mode": ["plain", "square"]}}


def plan() -> Plan:
    return planned(GRID, analysis=PICKY)


def files(store: Path) -> dict[str, bytes]:
    return {str(path.relative_to(store)): path.read_bytes() for path in store.rglob("*") if path.is_file()}


def outcome(of: Plan, index: int) -> Outcome:
    found = evaluate(of.subject, of.points[index], compute_fingerprint(of.subject))
    assert isinstance(found, Outcome)
    return found


@contextlib.contextmanager
def begun(path: Path, of: Plan | None = None, **options: Any) -> Iterator[Store]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "CHUNK", 4)
        with open_store(path, of or plan(), VERSIONS, options.get("overwrite", False)) as store:
            yield store


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


def test_what_is_said_to_be_kept_at_ctrl_c_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    of, path = plan(), tmp_path / "store.zarr"
    came = SimpleNamespace(outcomes=lambda pending: iter([[(0, outcome(of, 0)), (5, outcome(of, 5))]]))
    workers = SimpleNamespace(nthreads=lambda: {"one": 1})
    monkeypatch.setattr(study, "connect", lambda *where: contextlib.nullcontext(workers))
    monkeypatch.setattr(study, "Execution", lambda *arguments: came)
    monkeypatch.setattr(module, "Store", _Interrupted)
    with pytest.raises(KeyboardInterrupt, match="2 points are kept"):
        study.run(of, path, study.Where(), Reporter(Console(quiet=True)))
    assert np.flatnonzero(Store(path).status != PENDING).tolist() == [0, 5]


class Killed(BaseException):
    pass


@given(st.permutations(range(12)), st.lists(st.integers(0, 30), max_size=3))
@settings(derandomize=True, deadline=None, max_examples=25)
def test_order_and_kills_leave_no_trace(order: list[int], kills: list[int]) -> None:
    """A kill comes after any number of files that a start has written."""
    of = plan()
    with TemporaryDirectory() as name:
        straight, disturbed = Path(name) / "straight.zarr", Path(name) / "disturbed.zarr"
        with begun(straight) as store:
            for index in range(12):
                store.record(index, outcome(of, index))
            store.flush()
        for kill in [*kills, None]:
            with contextlib.suppress(Killed):
                _start(disturbed, of, order, kill)
        assert files(disturbed) == files(straight)


def _start(path: Path, of: Plan, order: list[int], kill: int | None) -> None:
    """Evaluate what is pending, written point by point, until `kill` files are written."""
    written = 0

    def write(self: Store, name: str, chunk: tuple[int, ...]) -> None:
        nonlocal written
        if written == kill:
            raise Killed
        written += 1
        original(self, name, chunk)

    original = module.Store._write
    with pytest.MonkeyPatch.context() as patch, begun(path) as store:
        patch.setattr(module.Store, "_write", write)
        for index in order:
            if store.status[index] == PENDING:
                store.record(index, outcome(of, index))
                store.flush()


@pytest.mark.parametrize("kill", range(1, 9))
def test_what_says_done_has_its_results(kill: int, tmp_path: Path) -> None:
    """Whatever file of the first two points a kill comes before."""
    with contextlib.suppress(Killed):
        _start(tmp_path / "store.zarr", plan(), [4, 0], kill)
    with xarray.open_zarr(tmp_path / "store.zarr") as found:
        done, failed = found["status"].values == DONE, found["status"].values == FAILED
        assert (int(done.sum()), int(failed.sum())) == (kill >= 4, kill >= 8)
        assert np.isfinite(found["sum"].values[done]).all()
        assert (found["message"].values[failed] != "").all()


def test_failed_points_are_pending_again_on_request(tmp_path: Path) -> None:
    of = plan()
    with begun(tmp_path / "store.zarr") as store:
        for index in range(12):
            store.record(index, outcome(of, index))
        store.flush()
        failed = np.flatnonzero(store.status == FAILED).tolist()
        assert [of.points[i]["x"] for i in failed] == [-2.0] * 4
        assert store.pending() == []
        store.retry_failed()
        assert store.pending() == failed
    with begun(tmp_path / "store.zarr") as store:
        assert store.pending() == failed


def test_xarray_reads_units_texts_and_flags(tmp_path: Path) -> None:
    with begun(tmp_path / "store.zarr"):
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
    of = planned({"kind": "sobol", "ranges": ranges, "count": 32, "seed": 5})
    with begun(tmp_path / "store.zarr", of) as store:
        for index in range(32):
            store.record(index, outcome(of, index))
        store.flush()
    with xarray.open_zarr(tmp_path / "store.zarr") as found:
        assert set(found.coords) == {"x", "y"}
        assert found["x"].dims == ("point",)
        assert np.array_equal(found["sum"], found["x"] + found["y"])
        assert np.array_equal(found["sign"] == "-", found["sum"] < 0.0)
        assert json.loads(found.attrs["study"])["points"]["seed"] == 5


OTHERS = {
    "other points": planned(GRID | {"axes": GRID["axes"] | {"y": [1.0, 3.0]}}, analysis=PICKY),
    "another study": planned(GRID, analysis=PLAIN),
    "fewer": planned({"kind": "grid", "axes": {"x": [-2.0, 0.0, 2.0]}}, analysis=PICKY),
}


@pytest.mark.parametrize("other", OTHERS)
def test_another_studys_store_is_refused_or_replaced(other: str, tmp_path: Path) -> None:
    path = tmp_path / "store.zarr"
    with begun(path):
        before = files(path)
    with (
        pytest.raises(MistakeError, match=r"store.zarr: holds .* --out, .* --overwrite"),
        begun(path, OTHERS[other]),
    ):
        pass
    assert files(path) == before
    with begun(path, OTHERS[other], overwrite=True) as store:
        assert len(store.pending()) == len(OTHERS[other].points)


def test_a_store_begun_by_another_version_is_refused(tmp_path: Path) -> None:
    with begun(tmp_path / "store.zarr"):
        pass
    other = VERSIONS | {"numba": "0.61"}
    with (
        pytest.raises(MistakeError, match=r"another version \(numba 0.61 instead of 0.60\)"),
        open_store(tmp_path / "store.zarr", plan(), other, False),
    ):
        pass


def test_a_folder_that_is_no_store_is_never_replaced(tmp_path: Path) -> None:
    kept = tmp_path / "folder" / "kept"
    kept.parent.mkdir()
    kept.touch()
    with pytest.raises(MistakeError, match="is not the store of a study"), begun(kept.parent, overwrite=True):
        pass
    assert kept.exists()


def test_a_store_in_use_is_refused(tmp_path: Path) -> None:
    store, said = tmp_path / "store.zarr", "another process is working on it"
    with begun(store), pytest.raises(MistakeError, match=said), begun(store):
        pass


def test_a_place_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    store, said = tmp_path / "file" / "store.zarr", r"cannot be written .* choose another --out"
    with pytest.raises(MistakeError, match=said), begun(store):
        pass
