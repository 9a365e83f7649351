"""A run killed at any moment is resumed and ends with the same bits; what cannot be resumed is refused."""

import os
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from io import StringIO
from pathlib import Path
from unittest.mock import Mock

import pytest
from rich.console import Console

from models.core.remedies import Command, find_actions, in_command_line
from orchestrator.errors import CheckpointError, MistakeError, start_over
from orchestrator.reporter import Reporter
from orchestrator.run import assess
from orchestrator.run.checkpoint import read
from orchestrator.run.pipeline import resume, run
from orchestrator.run.simulation import Session
from orchestrator.scenario.files import load
from orchestrator.store.journal import Recorded
from orchestrator.store.output_folder import OutputFolderError
from orchestrator.store.result_file import open_result
from tribocosim.cached_fmus import build_fmu

from .commands import HERE, ROOT
from .killed import EVERY
from .studies import read_files
from .whole_runs import NO_REFERENCE, SHORT, assert_same_run, quiet, run_whole

UNSTABLE = ["master.name=jacobi", "macro_step=100 us", "stop_time=50 ms", *HERE]
# Runs to be killed: scenario and changes.
RUNS = {
    "gauss_seidel in-process": ("valve-train", ["stop_time=60 ms", *HERE, *NO_REFERENCE]),
    "gauss_seidel with FMUs": ("valve-train", ["stop_time=60 ms", *NO_REFERENCE]),
    "iterated with step control and events": (
        "bouncing-mass",
        [
            *("master.name=iterated", "master.extrapolation=hermite", "master.acceleration=quasi_newton"),
            *("step_control.relative=1e-7", "stop_time=10 s", "energy.ledger=true"),
            *("components.mass.participant=in-process", "components.stop.participant=in-process"),
        ],
    ),
}
# Seed and number of kills.
KILLS = [(1, 4), *(pytest.param(seed, 12, marks=pytest.mark.long) for seed in (2, 3))]


def _python(code: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *code.split(" ", 1), *arguments]
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT, timeout=280)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="kills forked processes")
@pytest.mark.parametrize(("seed", "kills"), KILLS)
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if "FMUs" in name else pytest.mark.long) for name in RUNS]
)
def test_a_run_killed_again_and_again_ends_as_one_that_was_not(name, seed, kills, tmp_path):
    scenario, overrides = RUNS[name]
    whole = run_whole(tmp_path / "whole", overrides, scenario)
    out = str(tmp_path / "killed")
    done = _python("-m tests.orchestrator.killed", out, str(seed), str(kills), scenario, *overrides)
    assert done.returncode == 0, done.stderr
    *killed, end = done.stdout.splitlines()
    assert end == "ended with 0", done.stdout
    assert len(killed) >= 3, done.stdout
    # Some of it came back from checkpoints: these are a time and files.
    assert any(float(line.split()[1]) > 0.0 for line in killed), done.stdout
    assert_same_run(tmp_path / "killed", whole)


def test_a_run_that_failed_is_not_resumed_and_says_why(tmp_path):
    out = tmp_path / "out"
    scenario = load("valve-train", [*UNSTABLE, *NO_REFERENCE, EVERY])
    summary = run(scenario, out, build_fmu, quiet(), figures=False)
    assert (summary.exit_status, summary.resumable) == (3, False)
    assert not (out / "unfinished").exists()
    message = in_command_line(summary.message)
    assert message in (out / "summary.csv").read_text("utf-8").splitlines()[-1]
    with pytest.raises(OutputFolderError) as error:
        resume(out, build_fmu, quiet())
    why = message.removeprefix("incomplete: ")
    assert str(error.value).startswith(f"{out}: the run failed, and would fail again: {why}")
    assert find_actions(error.value) == find_actions(start_over(out))
    with pytest.raises(OutputFolderError, match=f"did you mean {out}\\?$"):
        resume(out / "summary.json", build_fmu, quiet())
    (out / "scenario.toml").unlink()
    with pytest.raises(OutputFolderError, match="put back the file that the run had written"):
        resume(out, build_fmu, quiet())


def test_a_run_that_is_interrupted_at_its_reference_is_whole_and_lacks_the_comparison(tmp_path, monkeypatch):
    """It has its figures, and goes on with the reference."""
    out, one = tmp_path / "out", load("two-masses", ["stop_time=0.1", EVERY])
    with monkeypatch.context() as patched:
        patched.setattr(assess, "solve_reference", Mock(side_effect=KeyboardInterrupt))
        stopped = run(one, out, build_fmu, quiet())
    assert (stopped.exit_status, stopped.complete) == (130, False)
    assert stopped.resumable
    assert stopped.whole
    assert "the run itself is whole, and lacks the comparison" in stopped.message
    assert list((out / "figures").glob("*.png"))
    assert "incomplete" not in (out / "summary.csv").read_text("utf-8")
    done = resume(out, build_fmu, quiet(), figures=False)
    assert (done.complete, done.macro_steps) == (True, stopped.macro_steps)
    assert done.errors


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return run_whole(tmp_path_factory.mktemp("whole") / "out", SHORT)


def _left(out: Path, overrides: list[str], calls: int = 60) -> None:
    """A run killed at that one of the calls that checkpoints are made of."""
    code = f"from tests.orchestrator.killed import left; from pathlib import Path; left(Path({str(out)!r}), "
    done = _python("-c " + code + f"{calls}, 'valve-train', {overrides!r})")
    assert done.returncode == -9, done.stderr


@pytest.fixture(scope="module")
def killed_run(tmp_path_factory):
    out = tmp_path_factory.mktemp("killed") / "out"
    _left(out, SHORT)
    return out


@pytest.fixture
def killed(killed_run, tmp_path):
    """A run that was killed, to be spoilt."""
    return Path(shutil.copytree(killed_run, tmp_path / "out"))


def _refused(out: Path, words: str) -> None:
    """`resume` says so, with the remedy, and changes nothing."""
    before = read_files(out)
    with pytest.raises(CheckpointError, match=words) as refused:
        resume(out, build_fmu, quiet(), figures=False)
    assert refused.value.remedies[-1] == start_over(out)
    assert read_files(out) == before


def test_what_came_after_the_checkpoint_is_forgotten(killed, whole):
    """Rows and lines that were begun, and files that were not whole."""
    for path in (killed / "unfinished").glob("*.journal"):
        with path.open("ab") as file:
            file.write(b"1.5,torn" * 77)
    (killed / "unfinished" / "checkpoint.partial").write_bytes(b"torn")
    (killed / "result.nc.partial").write_bytes(b"torn")
    (killed / "coupled.csv.partial").write_bytes(b"torn")
    assert resume(killed, build_fmu, quiet(), figures=False).complete
    assert_same_run(killed, whole)


def test_the_wall_time_is_that_of_all_processes(killed):
    """An interrupted process leaves its wall time in the summary, a killed one that of its steps."""
    (killed / "summary.json").write_text('{"wall_time_s": 100.0}')
    summary = resume(killed, build_fmu, quiet(), figures=False)
    assert 100.0 < summary.wall_time_s < 400.0
    assert summary.coupled_time_s < summary.wall_time_s


def test_a_resumed_run_that_is_stopped_before_it_goes_on_has_the_steps_that_it_had(killed, monkeypatch):
    monkeypatch.setattr(Session, "begin", Mock(side_effect=KeyboardInterrupt))
    stopped = resume(killed, build_fmu, quiet(), figures=False)
    assert stopped.macro_steps == read(killed / "unfinished" / "checkpoint")[1]["made"] > 0


def test_a_run_says_where_it_goes_on_and_once_that_processor_or_blas_are_others(killed, monkeypatch):
    monkeypatch.setenv("OPENBLAS_CORETYPE", "Nehalem")
    monkeypatch.setattr("llvmlite.binding.get_host_cpu_name", lambda: "other")
    reporter = Reporter(Console(file=StringIO(), width=500))
    begun = read(killed / "unfinished" / "checkpoint")[1]["session"]["time"]
    assert resume(killed, build_fmu, reporter, figures=False).complete
    lines = reporter.console.file.getvalue().splitlines()
    said = [line for line in lines if "digits" in line]
    assert len(said) == 1
    share = 100.0 * begun / load(killed / "scenario.toml").stop_time
    assert 0.0 < share < 100.0
    assert lines[lines.index(said[0]) + 1] == f"goes on from t = {begun:.6g} s, {share:.0f} %"
    assert "OPENBLAS_CORETYPE was not set, is Nehalem" in said[0]
    assert "is other" in said[0]
    assert "the last digits may differ" in said[0]


def _spoil(data: bytes, at: int, by: bytes = b"") -> bytes:
    """With a flipped bit there, or these bytes."""
    by = by or bytes([data[at] ^ 1])
    return data[:at] + by + data[at + len(by) :]


def _begin(journal: bytes) -> int:
    """Of its rows."""
    return journal.index(b"\n") + 1


CHECKPOINT, JOURNAL, STOP = "unfinished/checkpoint", "unfinished/coupled.journal", b"stop_time = 0.004"
SPOILT: list[tuple[str, Callable[[bytes], bytes], str]] = [
    (CHECKPOINT, lambda data: _spoil(data, 2000), "checkpoint: the checkpoint is damaged"),
    (CHECKPOINT, lambda data: b"something else\n" + data, "is not a checkpoint of this version"),
    (CHECKPOINT, lambda data: b"", "is not a checkpoint of this version"),
    (JOURNAL, lambda data: data[: _begin(data)], "coupled.journal: has 0 rows, of .* at the checkpoint"),
    (JOURNAL, lambda data: _spoil(data, _begin(data) + 100), "coupled.journal: damaged: its .* rows up to"),
    (
        JOURNAL,
        lambda data: _spoil(data, _begin(data), bytes(64)),
        "coupled.journal: damaged: its .* rows up to",
    ),
    ("scenario.toml", lambda data: data.replace(STOP, b"stop_time = 0.005"), "begun with; undo the change"),
]


def test_what_is_spoilt_or_lost_is_noticed_and_may_be_put_back(killed, whole):
    """Checkpoint, scenario and what is before it are as they were written, or the run does not go on."""
    for name, spoil, said in SPOILT:
        kept = (killed / name).read_bytes()
        (killed / name).write_bytes(spoil(kept))
        _refused(killed, said)
        (killed / name).write_bytes(kept)
    kept = (killed / JOURNAL).read_bytes()
    (killed / JOURNAL).unlink()
    _refused(killed, "coupled.journal: cannot be read")
    (killed / JOURNAL).write_bytes(kept)
    assert resume(killed, build_fmu, quiet(), figures=False).complete
    assert_same_run(killed, whole)


def test_a_run_in_a_folder_with_an_unfinished_one_says_how_to_go_on(killed, whole):
    before = read_files(killed)
    with pytest.raises(OutputFolderError, match="was not finished") as refused:
        run(load("valve-train", [*SHORT, EVERY]), killed, build_fmu, quiet())
    assert Command("resume", (killed,)) in find_actions(refused.value)
    assert read_files(killed) == before
    with pytest.raises(OutputFolderError) as unfinished:
        open_result(killed)
    assert find_actions(unfinished.value) == (Command("resume", (killed,)),)
    run(load("valve-train", [*SHORT, EVERY]), killed, build_fmu, quiet(), overwrite=True, figures=False)
    assert_same_run(killed, whole)


def test_two_processes_do_not_work_on_one_run(killed):
    code = (
        "import sys; from pathlib import Path; from orchestrator.store.output_folder import lock_folder\n"
        "with lock_folder(Path(sys.argv[1])): print('held', flush=True); sys.stdin.read()"
    )
    other = subprocess.Popen(
        [sys.executable, "-c", code, str(killed)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=ROOT,
    )  # fmt: skip
    try:
        assert other.stdout
        assert other.stdout.readline() == "held\n"
        before = read_files(killed)
        for overwrite in (False, True):
            with pytest.raises(MistakeError):
                run(load("valve-train", SHORT), killed, build_fmu, quiet(), overwrite=overwrite)
        with pytest.raises(MistakeError, match="another process is running it"):
            resume(killed, build_fmu, quiet(), figures=False)
        assert read_files(killed) == before
    finally:
        other.communicate("")


def test_a_rebuilt_fmu_is_refused(tmp_path):
    """The checksum, not what is in it: nobody knows that it computes the same."""
    file, out = tmp_path / "contact.fmu", tmp_path / "out"
    shutil.copy(build_fmu("ehl_contact", {}), file)
    _left(out, [*SHORT, f"components.contact.participant={file}"])
    with zipfile.ZipFile(file, "a") as archive:
        archive.comment = b"built again"
    _refused(out, "components.contact.participant: the FMU is not the one")


def test_what_is_no_unfinished_run_is_told(whole, tmp_path):
    before = read_files(whole)
    done = resume(whole, build_fmu, quiet())
    assert (done.complete, done.exit_status) == (True, 0)
    assert read_files(whole) == before
    with pytest.raises(OutputFolderError, match="holds no run"):
        resume(tmp_path, build_fmu, quiet())
    shutil.copy(whole / "scenario.toml", tmp_path)
    with pytest.raises(OutputFolderError, match="left nothing to go on from") as refused:
        resume(tmp_path, build_fmu, quiet())
    assert refused.value.remedies == (start_over(tmp_path),)
    shutil.copy(whole / "summary.json", tmp_path)
    with pytest.raises(OutputFolderError, match=r"complete, but result\.nc is not there; start over"):
        resume(tmp_path, build_fmu, quiet())


def test_killed_while_it_tidied_up_it_is_complete(killed, whole):
    for name in ("result.nc", "coupled.csv", "units.csv", "summary.csv", "summary.json"):
        shutil.copy(whole / name, killed)
    (killed / "unfinished" / "checkpoint").unlink()
    assert resume(killed, build_fmu, quiet()).complete
    assert_same_run(killed, whole)
    assert not (killed / "figures").exists()  # as the run was begun without


def test_without_a_checkpoint_what_was_recorded_is_kept_and_marked(killed):
    (killed / "unfinished" / "checkpoint").unlink()
    with (killed / "unfinished" / "coupled.journal").open("ab") as file:
        file.write(b"1.5,torn")
    rows = Recorded(killed / "unfinished" / "coupled.journal").rows
    done = resume(killed, build_fmu, quiet(), figures=False)
    assert (done.complete, done.exit_status, done.resumable) == (False, 3, False)
    assert "no checkpoint" in done.message
    assert not (killed / "unfinished").exists()
    lines = (killed / "coupled.csv").read_text().splitlines()
    with open_result(killed) as tree:
        assert tree.attrs["complete"] == 0
        assert "no checkpoint" in tree.attrs["message"]
        times = tree["coupled"]["time"].values.tolist()
        assert tree["steps"].sizes["time"] == done.macro_steps >= len(times) - 1 > 0
    assert [float(line.split(",")[0]) for line in lines[1:]] == times
    assert len(times) == rows


def test_where_steps_and_records_end_apart_each_is_kept_and_told(killed):
    """As a full disk leaves them."""
    (killed / "unfinished" / "checkpoint").unlink()
    journal = killed / "unfinished" / "steps.journal"
    found = Recorded(journal)
    whole, width = found.rows, 8 * len(found.columns)
    os.truncate(journal, journal.stat().st_size - (whole - 1) * width)
    left = Recorded(journal)
    until = left.last_time()
    records = Recorded(journal.with_name("coupled.journal")).rows
    assert left.rows == 1 < records
    done = resume(killed, build_fmu, quiet(), figures=False)
    assert f"/steps until {until:g} s" in done.message
    every = load(str(killed / "scenario.toml")).record_every
    assert done.macro_steps == max(left.rows, every * (records - 1))
    with open_result(killed) as tree:
        assert tree["steps"].sizes["time"] == left.rows
        assert tree["coupled"].sizes["time"] == records
