"""Studies: killed and continued, a scheduler elsewhere, failing points."""

from __future__ import annotations

import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import xarray

from .shell import COMMAND, tribocosim
from .table import ROOT, Row

STUDY = "orchestrator/test_study.py::"
POINTS = "orchestrator/test_study_points.py::"
STORE = "orchestrator/test_study_store.py::"


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as name:
        yield _killed(Path(name))
    yield Row(
        "any parameter study (grid, Sobol, list) over any scenario or analysis",
        "points: products, rows, low discrepancy; a scenario's results are those of its run",
        (
            POINTS + "test_a_grid_is_the_product_of_its_axes",
            POINTS + "test_sobol_points_are_balanced_and_of_low_discrepancy",
            POINTS + "test_a_list_is_its_rows_in_order",
            "orchestrator/test_study_scenario.py::test_results_are_those_of_the_run",
        ),
    )
    yield Row(
        "dask.distributed: a local cluster by default, --scheduler ADDRESS for an existing one",
        "a scheduler and workers in processes of their own: the same store",
        (STUDY + "test_a_running_scheduler_gives_the_same_store",),
        command="tribocosim study FILE.toml --scheduler tcp://HOST:8786",
    )
    yield Row(
        "results to one zarr store written as they come",
        "what says done has its results, whatever the order and wherever it is killed",
        (
            STORE + "test_what_says_done_has_its_results",
            STORE + "test_order_and_kills_leave_no_trace",
            STUDY + "test_the_store_is_a_labelled_dataset",
        ),
        short="safe against killed processes, not against loss of power (files are not synced).",
    )
    yield Row(
        "a failing point is recorded with its message and doesn't stop the rest",
        "also a point that kills its worker's process",
        (
            "orchestrator/test_study_scenario.py::test_a_run_that_fails_is_a_failed_point_with_its_message",
            STUDY + "test_a_point_that_kills_its_process_is_recorded_and_the_rest_goes_on",
        ),
    )


def _killed(folder: Path) -> Row:
    study = folder / "study.toml"
    study.write_text(
        'analysis = "exponents"\n[fixed]\ncycles = 20000\nform = "as_published"\n'
        '[points]\nkind = "grid"\n[points.axes]\n'
        "damping = { start = 0.03, stop = 0.09, count = 12 }\n"
        "gap = { start = 0.008, stop = 0.02, count = 12 }\n",
        "utf-8",
    )
    stores = [folder / name for name in ("whole.zarr", "killed.zarr")]
    assert tribocosim("study", str(study), "--out", str(stores[0])).status == 0
    process = subprocess.Popen(
        [*COMMAND, "study", str(study), "--out", str(stores[1])],
        cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
    )  # fmt: skip
    while process.poll() is None and _done(stores[1]) < 20:
        time.sleep(0.05)
    process.send_signal(signal.SIGKILL)
    process.wait()
    kept = _done(stores[1])
    said = tribocosim("study", str(study), "--out", str(stores[1]))
    whole, continued = (
        {f.relative_to(s): f.read_bytes() for f in s.rglob("*") if f.is_file()} for s in stores
    )
    same = "the same" if whole == continued else "another"
    return Row(
        "killed at any moment and started again it continues and ends with the same store",
        f"144 points, killed with {kept} done; then exit status {said.status} and {same} store, byte by byte",
        (STUDY + "test_killed_and_continued_ends_with_the_same_store",),
        command="tribocosim study FILE.toml",
    )


def _content(store: Path) -> dict[Path, bytes]:
    return {file.relative_to(store): file.read_bytes() for file in store.rglob("*") if file.is_file()}


def _done(store: Path) -> int:
    if not (store / "status").exists():
        return 0
    try:
        with xarray.open_zarr(store, consolidated=False) as found:
            return int((found["status"] == 1).sum())
    except (OSError, KeyError, ValueError):  # just being written
        return 0
