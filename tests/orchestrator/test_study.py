"""Studies through the command, a scheduler and workers, all in processes of their own."""

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
import xarray

from orchestrator.study.files import load

from .commands import ROOT, said, tribocosim

ANALYSIS = "tests.orchestrator.studied"
GRID = """
[points]
kind = "grid"
axes.x = {{ start = -1.0, stop = {stop}, count = {count} }}
axes.y = [1.0, 2.0]
"""


def study(folder: Path, analysis: str, stop: float = 3.0, count: int = 5, traces: str = "traces") -> Path:
    """A study file; at x = -1 the analyses that fail do so."""
    (folder / traces).mkdir(exist_ok=True)
    file = folder / "test.toml"
    head = f"analysis = '{ANALYSIS}:{analysis}'\nfixed.folder = '{folder / traces}'\n"
    file.write_text(head + GRID.format(stop=stop, count=count))
    return file


def files(store: Path) -> dict[str, bytes]:
    """Every file of a store."""
    return {str(path.relative_to(store)): path.read_bytes() for path in store.rglob("*") if path.is_file()}


def evaluated(folder: Path) -> list[int]:
    """How often each point was evaluated."""
    return [len(path.read_text().splitlines()) for path in sorted((folder / "traces").iterdir())]


def started(*arguments: str, **variables: str) -> subprocess.Popen[str]:
    """The command, running, as the leader of a group of processes."""
    environment = os.environ | {"PYTHONPATH": str(ROOT), "COLUMNS": "120"} | variables
    code = "from orchestrator.command_line import main; main()"
    return subprocess.Popen(
        [sys.executable, "-u", "-W", "error", "-c", code, "study", *arguments],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT, env=environment,
        start_new_session=True,
    )  # fmt: skip


def wait_for(condition: Callable[[], object], seconds: float = 120.0) -> None:
    """Until it holds; a minute and more only where a busy machine must start many processes."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


def status_of(store: Path) -> np.ndarray:
    """Of every point; of none where there is no store yet."""
    with contextlib.suppress(OSError, ValueError, KeyError), xarray.open_zarr(store) as found:
        return found["status"].values.ravel()
    return np.zeros(0)


def processes_of(group: int) -> list[int]:
    """The processes that still run in a group."""
    found = []
    for entry in Path("/proc").iterdir():
        with contextlib.suppress(OSError, ValueError):
            status = (entry / "stat").read_text().rpartition(")")[2].split()
            if int(status[2]) == group and status[0] != "Z":
                found.append(int(entry.name))
    return found


@contextlib.contextmanager
def scheduled(*options_of_workers: str) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """A scheduler and two workers as a user starts them; the scheduler's address and process."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    options = {"stdout": subprocess.DEVNULL, "text": True, "env": environment, "cwd": ROOT}
    dask = [sys.executable, "-m", "dask"]
    scheduler = subprocess.Popen(
        [*dask, "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"],
        stderr=subprocess.PIPE, **options,
    )  # fmt: skip
    assert scheduler.stderr
    lines = iter(scheduler.stderr.readline, "")
    address = next(found[0] for line in lines if (found := re.search(r"tcp://[\d.]+:\d+", line)))
    worker = subprocess.Popen(
        [*dask, "worker", address, "--nworkers", "2", "--nthreads", "1", "--no-dashboard",
         *options_of_workers],
        stderr=subprocess.DEVNULL, **options,
    )  # fmt: skip
    try:
        yield address, scheduler
    finally:
        for process in (worker, scheduler):
            process.terminate()
            process.wait(30)
        scheduler.stderr.close()


@pytest.fixture(scope="module")
def cluster() -> Iterator[str]:
    with scheduled() as (address, _):
        yield address


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a study of slow points that nothing disturbed; two of its points fail."""
    folder = tmp_path_factory.mktemp("undisturbed")
    done = tribocosim("study", str(study(folder, "SLOW", 8.0, 10)), "--out", str(folder / "store.zarr"))
    assert done.returncode == 1, done.stderr
    assert done.stderr == ""
    assert "18 points done, 2 failed, the first at x = -1.0, y = 1.0" in done.stdout
    assert "ArithmeticError: no root of x = -1" in done.stdout
    return folder


def test_the_store_is_a_labelled_dataset(undisturbed: Path) -> None:
    with xarray.open_zarr(undisturbed / "store.zarr") as found:
        assert found["sum"].dims == ("x", "y")
        assert found["x"].attrs == {"long_name": "abscissa", "units": "m"}
        assert found["sum"].attrs["units"] == "m"
        good = found.sel(x=slice(0.0, None))
        assert np.array_equal(good["sum"], good["x"] + good["y"])
        assert (good["sign"] == "+").all()
        assert (good["message"] == "").all()
        assert (good["status"] == 1).all()
        failed = found.sel(x=-1.0)
        assert failed["status"].values.tolist() == [2, 2]
        assert failed["message"].values.tolist() == ["ArithmeticError: no root of x = -1"] * 2
        assert np.isnan(failed["sum"]).all()
        assert json.loads(found.attrs["study"])["points"]["kind"] == "grid"
        assert "numba" in json.loads(found.attrs["versions"])


def test_nothing_is_left_beside_the_store(undisturbed: Path) -> None:
    assert {path.name for path in undisturbed.iterdir()} == {"store.zarr", "test.toml", "traces"}


def test_a_finished_study_evaluates_nothing_again(undisturbed: Path) -> None:
    before, times = files(undisturbed / "store.zarr"), evaluated(undisturbed)
    arguments = ["study", str(undisturbed / "test.toml"), "--out", str(undisturbed / "store.zarr")]
    assert tribocosim(*arguments).returncode == 1
    assert files(undisturbed / "store.zarr") == before
    assert evaluated(undisturbed) == times


@pytest.mark.skipif(sys.platform == "win32", reason="groups of processes are POSIX")
@pytest.mark.parametrize(
    ("kill", "after"),
    [
        (signal.SIGKILL, (3,)),
        pytest.param(signal.SIGINT, (3,), marks=pytest.mark.long),
        pytest.param(signal.SIGKILL, (1, 5, 9, 14), marks=pytest.mark.long),
    ],
)
def test_killed_and_continued_ends_with_the_same_store(
    undisturbed: Path, tmp_path: Path, kill: signal.Signals, after: tuple[int, ...]
) -> None:
    """The last six points wait for the kill, however late it comes on a busy machine."""
    store, killed = tmp_path / "store.zarr", tmp_path / "killed"
    arguments = [str(undisturbed / "test.toml"), "--out", str(store), "--workers", "2"]
    for least in after:
        killed.unlink(missing_ok=True)
        running = started(*arguments, STUDIED_WAITS_FOR=str(killed))
        wait_for(lambda least=least: np.count_nonzero(status_of(store)) >= least)
        if kill == signal.SIGKILL:
            os.kill(running.pid, kill)  # only the process that writes
        else:
            os.killpg(running.pid, kill)  # as a terminal does
        killed.touch()
        message = running.communicate(timeout=60)[1]
        finished = np.count_nonzero(status_of(store))
        assert least <= finished < 20
        wait_for(lambda pid=running.pid: not processes_of(pid))
        if kill == signal.SIGINT:
            assert running.returncode == 130
            (line,) = message.splitlines()
            assert f"{finished} points are kept in {store}" in line
            assert "the same command continues" in line
    assert tribocosim("study", *arguments).returncode == 1
    assert files(store) == files(undisturbed / "store.zarr")


def test_a_running_scheduler_gives_the_same_store(cluster: str, undisturbed: Path, tmp_path: Path) -> None:
    store = tmp_path / "store.zarr"
    done = tribocosim("study", str(undisturbed / "test.toml"), "--out", str(store), "--scheduler", cluster)
    assert done.returncode == 1, done.stderr
    assert files(store) == files(undisturbed / "store.zarr")


def test_a_point_that_kills_its_process_is_recorded_and_the_rest_goes_on(tmp_path: Path) -> None:
    store = tmp_path / "store.zarr"
    done = tribocosim("study", str(study(tmp_path, "LETHAL")), "--out", str(store), "--workers=2")
    assert done.returncode == 1, done.stderr
    with xarray.open_zarr(store) as found:
        lethal = (found["x"] == 2.0) & (found["y"] == 1.0)
        assert np.array_equal(found["status"], np.where(lethal, 2, 1))
        assert "the worker's process died at this point" in str(found["message"].sel(x=2.0, y=1.0).values)
        assert np.array_equal(found["sum"].where(~lethal), (found["x"] + found["y"]).where(~lethal), True)


def test_an_unreachable_scheduler_is_one_message(tmp_path: Path) -> None:
    address = "tcp://127.0.0.1:1"
    done = tribocosim(
        "study", str(study(tmp_path, "PLAIN")), "--scheduler", address, "--timeout", "0.5",
        "--out", str(tmp_path / "store.zarr"),
    )  # fmt: skip
    assert done.returncode == 2
    assert address in said(done)
    assert "within 0.5 s" in said(done)
    assert not (tmp_path / "store.zarr").exists()


def test_workers_of_another_source_are_refused(cluster: str, tmp_path: Path) -> None:
    """The analysis's module is changed here after the workers have read it."""
    source = (ROOT / "tests" / "orchestrator" / "studied.py").read_text()
    (tmp_path / "elsewhere.py").write_text(source)
    file = tmp_path / "test.toml"
    file.write_text("analysis = 'elsewhere:PLAIN'\n[points]\nkind = 'list'\nrows = [{ x = 1.0 }]\n")
    arguments = ["study", str(file), "--scheduler", cluster, "--out", "store.zarr"]
    done = tribocosim(*arguments, cwd=tmp_path)
    assert done.returncode == 3
    assert "a worker" in said(done)
    assert "No module named 'elsewhere'" in said(done)


@pytest.mark.long
def test_a_worker_without_our_packages_is_refused(tmp_path: Path) -> None:
    lacking = tmp_path / "lacking.py"
    lacking.write_text("import sys\nsys.modules['orchestrator'] = None\n")
    with scheduled("--preload", str(lacking)) as (address, _):
        store = tmp_path / "store.zarr"
        done = tribocosim("study", str(study(tmp_path, "PLAIN")), "--scheduler", address, "--out", str(store))
    assert done.returncode == 3
    assert "a worker cannot take part: No module named 'orchestrator" in said(done)
    assert "install there what runs here" in said(done)


@pytest.mark.long
def test_a_scheduler_that_ends_is_named_and_what_is_finished_is_kept(tmp_path: Path) -> None:
    store = tmp_path / "store.zarr"
    arguments = [str(study(tmp_path, "SLOW", 8.0, 10)), "--out", str(store)]
    with scheduled() as (address, scheduler):
        running = started(*arguments, "--scheduler", address)
        wait_for(lambda: np.count_nonzero(status_of(store)) >= 3)
        scheduler.kill()
        message = running.communicate(timeout=60)[1]
        assert running.returncode == 3
        (line,) = message.splitlines()
        assert f"the scheduler at {address} is gone" in line
    assert 3 <= np.count_nonzero(status_of(store)) < 20


DOCS = (ROOT / "docs" / "studies.md").read_text()


def test_the_documented_studies_are_possible(tmp_path: Path) -> None:
    studies = re.findall(r"```toml\n(.+?)```", DOCS, re.DOTALL)
    assert len(studies) == 2
    for number, text in enumerate(studies):
        file = tmp_path / f"{number}.toml"
        file.write_text(text)
        assert len(load(str(file), lambda name, structure, kind: Path()).points) == (6, 2)[number]


def test_the_documented_function_is_studied_where_the_command_is_called(tmp_path: Path) -> None:
    text = next(text for text in re.findall(r"```python\n(.+?)```", DOCS, re.DOTALL) if "HALF" in text)
    (tmp_path / "mine.py").write_text(text)
    points = "[points]\nkind = 'grid'\naxes.x = ['1 mm', 3.0]\n"
    (tmp_path / "halves.toml").write_text("analysis = 'mine:HALF'\n" + points)
    done = tribocosim("study", "halves.toml", "--workers=1", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    with xarray.open_zarr(tmp_path / "results" / "halves.zarr") as found:
        assert found["half"].values.tolist() == [0.0005, 1.5]
