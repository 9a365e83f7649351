"""Studies through the command, a scheduler and workers, all in processes of their own."""

import asyncio
import contextlib
import http.client
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
from typing import Any

import numpy as np
import pytest
import xarray
from distributed import Security
from distributed.comm import connect

from orchestrator.command_line.study import PACKAGES
from orchestrator.study.files import load

from .commands import ROOT, called, said, tribocosim

DOCS = (ROOT / "docs" / "how-to" / "run-a-study.md").read_text()
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
def scheduled(*options_of_workers: str, **variables: str) -> Iterator[tuple[str, subprocess.Popen[str]]]:
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


def listening(group: int) -> set[int]:
    """The ports of this machine at which processes of the group listen."""
    sockets = set()
    for process in processes_of(group):
        with contextlib.suppress(OSError):
            sockets |= {os.readlink(file) for file in Path(f"/proc/{process}/fd").iterdir()}
    ports = set()
    for table in ("tcp", "tcp6"):
        for line in Path(f"/proc/net/{table}").read_text().splitlines()[1:]:
            _, local, _, state, *_, inode = line.split()[:10]
            if state == "0A" and f"socket:[{inode}]" in sockets:
                ports.add(int(local.rpartition(":")[2], 16))
    return ports


def pages(ports: set[int]) -> dict[int, int]:
    """The status of a page of dask's at each of the ports that answer as a web server."""
    found = {}
    for port in ports:
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=3.0)
        with contextlib.suppress(OSError, http.client.HTTPException), contextlib.closing(connection):
            connection.request("GET", "/health")
            found[port] = connection.getresponse().status
    return found


async def answering(ports: set[int]) -> list[str]:
    """Where dask answers one who has no certificate, or one of his own."""
    own = Security.temporary().get_connection_args("client")
    places = [(f"{kind}://127.0.0.1:{port}", options) for port in ports
              for kind, options in (("tcp", {}), ("tls", own))]  # fmt: skip

    async def answers(place: str, options: dict[str, Any]) -> bool:
        try:
            comm = await connect(place, timeout=3.0, **options)
        except (OSError, ValueError):  # the latter for TLS where none is spoken
            return False
        comm.abort()
        return True

    found = await asyncio.gather(*(answers(*place) for place in places))
    return [place for (place, _), yes in zip(places, found, strict=True) if yes]


@pytest.mark.skipif(sys.platform != "linux", reason="reads the kernel's list of ports")
def test_a_local_study_answers_nobody_else(tmp_path: Path) -> None:
    """Another user of this machine, who can reach its ports, cannot have it run code."""
    store, waits = tmp_path / "store.zarr", tmp_path / "waits"
    arguments = [str(study(tmp_path, "SLOW", 8.0, 10)), "--out", str(store), "--workers", "1"]
    running = started(*arguments, STUDIED_WAITS_FOR=str(waits))
    try:
        wait_for(lambda: np.count_nonzero(status_of(store)) >= 3)
        ports = listening(running.pid)
        web = pages(ports)
        assert set(web.values()) == {404}
        assert len(ports - set(web)) >= 3  # of scheduler, worker and the worker's keeper
        assert asyncio.run(answering(ports - set(web))) == []
        waits.touch()
        assert running.wait(60) == 1
    finally:
        with contextlib.suppress(OSError):
            os.killpg(running.pid, signal.SIGKILL)
        running.communicate()


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


def test_a_table_and_a_figure_stand_beside_the_store(undisturbed: Path) -> None:
    assert len((undisturbed / "store.csv").read_text().splitlines()) == 1 + 20
    assert (undisturbed / "store.png").read_bytes().startswith(b"\x89PNG")


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
    assert {path.name for path in undisturbed.iterdir()} == {
        "store.zarr", "store.csv", "store.png", "test.toml", "traces",
    }  # fmt: skip


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


def test_a_study_needs_no_cache_folder(tmp_path: Path) -> None:
    """Here one that everyone may write; what workers have instead goes with them."""
    for name in ("cache", "temporary"):
        (tmp_path / name).mkdir()
    (tmp_path / "cache").chmod(0o777)
    variables = {"TRIBOCOSIM_CACHE": str(tmp_path / "cache"), "TMPDIR": str(tmp_path / "temporary")}
    store = tmp_path / "store.zarr"
    running = started(str(study(tmp_path, "PICKY")), "--out", str(store), "--workers=1", **variables)
    message = running.communicate(timeout=120)[1]
    assert running.returncode == 1, message
    (line,) = message.splitlines()  # also of the workers
    assert f"{tmp_path / 'cache'}: " in line
    assert [list((tmp_path / name).iterdir()) for name in ("cache", "temporary")] == [[], []]


@pytest.mark.parametrize("package", PACKAGES)
def test_a_study_without_its_packages_names_them_and_the_extra(
    package: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    done = called("study", str(study(tmp_path, "PLAIN")), "--out", str(tmp_path / "store.zarr"))
    assert done.returncode == 2
    assert f"studies need {package}: " in said(done)
    assert "tribocosim[studies]" in said(done)
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["optional-dependencies"]
    assert [re.match(r"\w+", line)[0] for line in extras["studies"]] == list(PACKAGES)


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


@pytest.mark.skipif(not shutil.which("openssl"), reason="needs openssl")
def test_the_documented_certificate_keeps_others_from_a_scheduler(tmp_path: Path) -> None:
    """Who has it can study there; who has none cannot."""
    (command,) = re.findall(r"^openssl .+?[^\\]$", DOCS, re.DOTALL | re.MULTILINE)
    (settings,) = re.findall(r"```yaml\n(.+?)```", DOCS, re.DOTALL)
    for home in (tmp_path / "mine", tmp_path / "other"):
        home.mkdir()
        subprocess.run(["sh", "-c", command], cwd=home, check=True, capture_output=True)
        (home / "study.yaml").write_text(settings.replace("/home/me", str(home)))
    having, other = ({"DASK_CONFIG": str(tmp_path / name / "study.yaml")} for name in ("mine", "other"))
    store = tmp_path / "store.zarr"
    with scheduled(**having) as (address, _):
        assert address.startswith("tls://")
        arguments = ["--scheduler", address, "--out", str(store), "--timeout", "3"]
        for there, status in (({}, 2), (other, 2), (having, 1)):
            running = started(str(study(tmp_path, "PICKY")), *arguments, **there)
            message = running.communicate(timeout=120)[1]
            assert running.returncode == status, message
            assert store.exists() == (there == having)


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
