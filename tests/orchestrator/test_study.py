"""Studies through the command, a scheduler and workers, all in processes of their own."""

import asyncio
import contextlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path

import dask
import numpy as np
import pytest
import xarray
from distributed import Client

from orchestrator.study.execution import DIED
from orchestrator.study.files import load
from orchestrator.study.run import _publish
from tribocosim.packages import STUDY_PACKAGES

from .commands import ROOT, called, said, tribocosim
from .listening import list_answers, list_ports, list_processes, request_pages
from .studies import read_files

DOCS = (ROOT / "docs" / "how-to" / "run-a-study.md").read_text()
ANALYSIS = "tests.orchestrator.known_analyses"
GRID = """
[points]
kind = "grid"
axes.x = {{ start = -1.0, stop = {stop}, count = {count} }}
axes.y = [1.0, 2.0]
"""


def write_study(folder: Path, analysis: str, stop: float = 3.0, count: int = 5) -> Path:
    """A study file; at x = -1 the analyses that fail do so."""
    (folder / "traces").mkdir(exist_ok=True)
    file = folder / "test.toml"
    head = f"analysis = '{ANALYSIS}:{analysis}'\nfixed.folder = '{folder / 'traces'}'\n"
    file.write_text(head + GRID.format(stop=stop, count=count))
    return file


def count_evaluations(folder: Path) -> list[int]:
    """How often each point was evaluated."""
    return [len(path.read_text().splitlines()) for path in sorted((folder / "traces").iterdir())]


def start(*arguments: str, **variables: str) -> subprocess.Popen[str]:
    """The command, running, as the leader of a group of processes."""
    environment = os.environ | {"PYTHONPATH": str(ROOT), "COLUMNS": "120"} | variables
    code = "from tribocosim.command_line import main; main()"
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


def read_status(store: Path) -> np.ndarray:
    """Of every point; of none where there is no store yet."""
    with contextlib.suppress(OSError, ValueError, KeyError), xarray.open_zarr(store) as found:
        return found["status"].values.ravel()
    return np.zeros(0)


@contextlib.contextmanager
def run_scheduler(*options_of_workers: str, **variables: str) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """A scheduler and two workers as a user starts them; the scheduler's address and process."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)} | variables
    options = {"stdout": subprocess.DEVNULL, "text": True, "env": environment, "cwd": ROOT}
    dask = [sys.executable, "-m", "dask"]
    scheduler = subprocess.Popen(
        [*dask, "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"],
        stderr=subprocess.PIPE, **options,
    )  # fmt: skip
    assert scheduler.stderr
    lines = iter(scheduler.stderr.readline, "")
    address = next(found[0] for line in lines if (found := re.search(r"(tcp|tls)://[\d.]+:\d+", line)))
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
def cluster():
    with run_scheduler() as (address, _):
        yield address


@pytest.fixture(scope="module")
def listened(tmp_path_factory):
    """The folder of a study of slow points that nothing disturbed, of which two fail; the ports at which it
    listened, the pages that it had there, and where it answered others."""
    folder = tmp_path_factory.mktemp("undisturbed")
    store, waits = folder / "store.zarr", folder.with_suffix(".waits")
    file = str(write_study(folder, "SLOW", 8.0, 10))
    running = start(file, "--out", str(store), STUDY_WAITS_FOR=str(waits))
    ports, pages, answers = set(), {}, []
    try:
        if sys.platform == "linux":
            wait_for(lambda: np.count_nonzero(read_status(store)) >= 3)
            ports = list_ports(running.pid)
            pages = request_pages(ports)
            answers = asyncio.run(list_answers(ports - set(pages)))
        waits.touch()
        shown, message = running.communicate(timeout=120)
    finally:
        with contextlib.suppress(OSError):
            os.killpg(running.pid, signal.SIGKILL)
    assert running.returncode == 1, message
    assert message == ""
    assert "18 points done, 2 failed, the first at x = -1.0, y = 1.0" in shown
    return folder, ports, pages, answers


@pytest.fixture(scope="module")
def undisturbed(listened):
    """Its folder."""
    return listened[0]


@pytest.mark.skipif(sys.platform != "linux", reason="reads the kernel's list of ports")
def test_a_local_study_answers_nobody_else(listened):
    """Another user of this machine, who can reach its ports, cannot have it run code."""
    _, ports, pages, answers = listened
    assert set(pages.values()) == {404}
    assert len(ports - set(pages)) >= 3  # of scheduler, worker and the worker's keeper
    assert answers == []


def test_a_study_leaves_its_store_a_table_and_a_figure(undisturbed):
    names = {"store.zarr", "store.csv", "store.png", "test.toml", "traces"}
    assert {path.name for path in undisturbed.iterdir()} == names
    with xarray.open_zarr(undisturbed / "store.zarr") as found:
        good, failed = found.sel(x=slice(0.0, None)), found.sel(x=-1.0)
        assert np.array_equal(good["sum"], good["x"] + good["y"])
        assert (good["status"] == 1).all()
        assert (failed["status"] == 2).all()
        assert np.isnan(failed["sum"]).all()
        assert json.loads(found.attrs["study"])["points"]["kind"] == "grid"
        assert "numba" in json.loads(found.attrs["versions"])


def test_a_finished_study_evaluates_nothing_again(undisturbed):
    before, times = read_files(undisturbed / "store.zarr"), count_evaluations(undisturbed)
    arguments = ["study", str(undisturbed / "test.toml"), "--out", str(undisturbed / "store.zarr")]
    assert called(*arguments).returncode == 1
    assert read_files(undisturbed / "store.zarr") == before
    assert count_evaluations(undisturbed) == times


@pytest.mark.long
@pytest.mark.skipif(sys.platform == "win32", reason="groups of processes are POSIX")
@pytest.mark.parametrize(
    ("kill", "after"),
    [
        (signal.SIGKILL, (3,)),
        pytest.param(signal.SIGINT, (3,), marks=pytest.mark.long),
        pytest.param(signal.SIGKILL, (1, 5, 9, 14), marks=pytest.mark.long),
    ],
)
def test_killed_and_continued_ends_with_the_same_store(undisturbed, tmp_path, kill, after):
    """The last six points wait for the kill, however late it comes on a busy machine."""
    store, killed = tmp_path / "store.zarr", tmp_path / "killed"
    arguments = [str(undisturbed / "test.toml"), "--out", str(store), "--workers", "2"]
    for least in after:
        killed.unlink(missing_ok=True)
        running = start(*arguments, STUDY_WAITS_FOR=str(killed))
        wait_for(lambda least=least: np.count_nonzero(read_status(store)) >= least)
        if kill == signal.SIGKILL:
            os.kill(running.pid, kill)  # only the process that writes
        else:
            os.killpg(running.pid, kill)  # as a terminal does
        killed.touch()
        message = running.communicate(timeout=240)[1]
        finished = np.count_nonzero(read_status(store))
        assert least <= finished < 20
        wait_for(lambda pid=running.pid: not list_processes(pid))
        if kill == signal.SIGINT:
            assert running.returncode == 130
            (line,) = message.splitlines()
            assert f"{finished} points" in line
    assert tribocosim("study", *arguments).returncode == 1
    assert read_files(store) == read_files(undisturbed / "store.zarr")


@pytest.mark.parametrize("where", ["here", pytest.param("cluster", marks=pytest.mark.long)])
def test_a_running_scheduler_gives_the_same_store(where, request, undisturbed, tmp_path):
    """One in this process, or one whose workers have processes of their own."""
    store = tmp_path / "store.zarr"
    with contextlib.ExitStack() as stack:
        if where == "here":
            client = Client(processes=False, n_workers=2, threads_per_worker=1, dashboard_address=":0")
            address = str(stack.enter_context(client).scheduler_info()["address"])
        else:
            address = request.getfixturevalue("cluster")
        done = called("study", str(undisturbed / "test.toml"), "--out", str(store), "--scheduler", address)
    assert done.returncode == 1, said(done)
    assert read_files(store) == read_files(undisturbed / "store.zarr")


def test_a_point_that_kills_its_process_is_recorded_and_the_rest_goes_on(tmp_path):
    store = tmp_path / "store.zarr"
    done = tribocosim("study", str(write_study(tmp_path, "LETHAL")), "--out", str(store), "--workers=2")
    assert done.returncode == 1, done.stderr
    with xarray.open_zarr(store) as found:
        lethal = (found["x"] == 2.0) & (found["y"] == 1.0)
        assert np.array_equal(found["status"], np.where(lethal, 2, 1))
        assert str(found["message"].sel(x=2.0, y=1.0).values) == DIED
        assert np.array_equal(found["sum"].where(~lethal), (found["x"] + found["y"]).where(~lethal), True)


@pytest.mark.long
def test_a_study_needs_no_cache_folder(tmp_path):
    """Here one that everyone may write; what workers have instead goes with them."""
    for name in ("cache", "temporary"):
        (tmp_path / name).mkdir()
    (tmp_path / "cache").chmod(0o777)
    variables = {"TRIBOCOSIM_CACHE": str(tmp_path / "cache"), "TMPDIR": str(tmp_path / "temporary")}
    store = tmp_path / "store.zarr"
    running = start(str(write_study(tmp_path, "PICKY")), "--out", str(store), "--workers=1", **variables)
    message = running.communicate(timeout=120)[1]
    assert running.returncode == 1, message
    (line,) = message.splitlines()  # also of the workers
    assert f"{tmp_path / 'cache'}: " in line
    assert [list((tmp_path / name).iterdir()) for name in ("cache", "temporary")] == [[], []]


@pytest.mark.parametrize("package", STUDY_PACKAGES)
def test_a_study_without_its_packages_names_them_and_the_extra(package, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, package, None)
    done = called("study", str(write_study(tmp_path, "PLAIN")), "--out", str(tmp_path / "store.zarr"))
    assert done.returncode == 2
    assert package in said(done)
    assert "[studies]" in said(done)
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["optional-dependencies"]
    assert [re.match(r"\w+", line)[0] for line in extras["studies"]] == list(STUDY_PACKAGES)


def test_an_unreachable_scheduler_is_one_message(tmp_path):
    address = "tcp://127.0.0.1:1"
    done = called(
        "study", str(write_study(tmp_path, "PLAIN")), "--scheduler", address, "--timeout", "0.5",
        "--out", str(tmp_path / "store.zarr"),
    )  # fmt: skip
    assert done.returncode == 2
    assert address in said(done)
    assert not (tmp_path / "store.zarr").exists()


@pytest.mark.long
def test_workers_of_another_source_are_refused(cluster, tmp_path):
    """The analysis's module is changed here after the workers have read it."""
    shutil.copy(ROOT / "tests" / "orchestrator" / "known_analyses.py", tmp_path / "elsewhere.py")
    file = tmp_path / "test.toml"
    file.write_text("analysis = 'elsewhere:PLAIN'\n[points]\nkind = 'list'\nrows = [{ x = 1.0 }]\n")
    arguments = ["study", str(file), "--scheduler", cluster, "--out", "store.zarr"]
    done = tribocosim(*arguments, cwd=tmp_path)
    assert done.returncode == 3
    assert "'elsewhere'" in said(done)


@pytest.mark.skipif(not shutil.which("openssl"), reason="needs openssl")
@pytest.mark.long
def test_the_documented_certificate_keeps_others_from_a_scheduler(tmp_path):
    """Who has it can study there; who has none cannot."""
    (command,) = re.findall(r"^openssl .+?[^\\]$", DOCS, re.DOTALL | re.MULTILINE)
    (settings,) = re.findall(r"```yaml\n(.+?)```", DOCS, re.DOTALL)
    for home in (tmp_path / "mine", tmp_path / "other"):
        home.mkdir()
        subprocess.run(["sh", "-c", command], cwd=home, check=True, capture_output=True)
        (home / "study.yaml").write_text(settings.replace("/home/me", str(home)))
    having, other = ({"DASK_CONFIG": str(tmp_path / name / "study.yaml")} for name in ("mine", "other"))
    store = tmp_path / "store.zarr"
    with run_scheduler(**having) as (address, _):
        assert address.startswith("tls://")
        arguments = ["--scheduler", address, "--out", str(store), "--timeout", "3"]
        for there, status in (({}, 2), (other, 2), (having, 1)):
            running = start(str(write_study(tmp_path, "PICKY")), *arguments, **there)
            message = running.communicate(timeout=120)[1]
            assert running.returncode == status, message
            assert store.exists() == (there == having)


@pytest.mark.long
def test_a_worker_without_our_packages_is_refused(tmp_path):
    lacking = tmp_path / "lacking.py"
    lacking.write_text("import sys\nsys.modules['orchestrator'] = None\n")
    with run_scheduler("--preload", str(lacking)) as (address, _):
        out = str(tmp_path / "store.zarr")
        done = tribocosim("study", str(write_study(tmp_path, "PLAIN")), "--scheduler", address, "--out", out)
    assert done.returncode == 3
    assert "'orchestrator" in said(done)


def test_a_scheduler_that_ends_is_named_and_what_is_finished_is_kept(tmp_path):
    store = tmp_path / "store.zarr"
    arguments = [str(write_study(tmp_path, "SLOW", 8.0, 10)), "--out", str(store)]
    with run_scheduler(STUDY_WAITS_FOR=str(killed := tmp_path / "killed")) as (address, scheduler):
        running = start(*arguments, "--scheduler", address)
        wait_for(lambda: np.count_nonzero(read_status(store)) >= 3)
        scheduler.kill()
        killed.touch()
        message = running.communicate(timeout=240)[1]
        assert running.returncode == 3
        (line,) = message.splitlines()
        assert address in line
    assert 3 <= np.count_nonzero(read_status(store)) < 20


def test_the_table_needs_no_scheduler_which_may_have_ended(undisturbed, tmp_path):
    store = Path(shutil.copytree(undisturbed / "store.zarr", tmp_path / "store.zarr"))
    with dask.config.set(scheduler=pytest.fail):
        table, _ = _publish(load(str(undisturbed / "test.toml"), pytest.fail), store)
    assert table.read_bytes() == (undisturbed / "store.csv").read_bytes()


@pytest.mark.long
def test_a_module_beside_the_study_is_imported_by_the_workers(tmp_path):
    shutil.copy(ROOT / "tests" / "orchestrator" / "known_analyses.py", tmp_path / "mine.py")
    points = "[points]\nkind = 'grid'\naxes.x = ['1 mm', 3.0]\n"
    (tmp_path / "sums.toml").write_text("analysis = 'mine:PLAIN'\n" + points)
    done = tribocosim("study", "sums.toml", "--workers=1", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    with xarray.open_zarr(tmp_path / "results" / "sums.zarr") as found:
        assert found["sum"].values.tolist() == [1.001, 4.0]
