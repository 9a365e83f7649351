"""A third-party FMU that fails is named; what was recorded is kept, and nothing of the FMU is left behind."""

import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import psutil
import pytest

from fmus.build import build
from models.compile import temporary
from models.compile.temporary import NEW, PREFIX, TemporaryFolder
from models.core.interruption import is_asked
from models.core.system import Port
from orchestrator.assessment.frozen import list_frozen
from orchestrator.errors import MistakeError, in_command_line
from orchestrator.reporter import Reporter
from orchestrator.run.pipeline import resume, run
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.files import to_short_toml
from orchestrator.scenario.system import build_system
from orchestrator.store.result_file import open_result

from ..archives import replace_text
from ..fmus.names import mark_long
from ..orchestrator.commands import tribocosim
from .c_fmus import TOKEN, fmu
from .runs import CASES, completed, never, ran, recorded, scenario

posix = pytest.mark.skipif(os.name != "posix", reason="processes and signals are others on Windows")
STEP = "step from t = 0.5 s by 0.01 s"
GONE = f"decay: its process ended {{}} in the {STEP}; look at"
GARBLED = f"decay: its process gave an answer that cannot be read .* in the {STEP}"
EARLY = f"decay: came back early 10000 times from its {STEP}, and is at t = 0.5"
RETURNED = rf"decay: {STEP} returned {{}}: {{}}"
# Of a step that is discarded in the second run too.
SHORTEST, LONGER = ("by 0.01 s", "by 9.76563e-06 s"), "longer steps failed as well, from 0.01 s on"
REACHED = r"decay: came back early .*reached t = {} s \(lastSuccessfulTime\)"
# Where an FMU with a vice runs, in which versions of FMI, and what the run says. Crashes end the process that
# they are in; one writes into all descriptors, also what looks like a message, closes them, kills its parent.
VICES = {
    "crashing": (("own",), (2, 3), GONE.format("by SIGSEGV")),
    "aborting": (("own",), (2, 3), GONE.format("by SIGABRT")),
    "leaving": (("own",), (2, 3), GONE.format("with exit status 7")),
    "quitting": (("own",), (2, 3), GONE.format("with exit status 0")),
    "killing": (("own",), (2,), GONE.format("by SIGKILL")),
    "closing": (("own",), (2,), GONE.format(".*")),
    "scribbling": (("own",), (2,), GARBLED),
    "feigning": (("own",), (2,), GARBLED),
    "discarding": (
        ("own", "shared"),
        (2, 3),
        RETURNED.format("Discard", f"no way on.*{LONGER}").replace(*SHORTEST),
    ),
    "erring": (("own", "shared"), (2, 3), RETURNED.format("Error", "out of range")),
    "fatal": (("own", "shared"), (2, 3), RETURNED.format("Fatal", "memory is gone")),
    "pending": (("shared",), (2,), RETURNED.format("Pending", "no message; asynchronous steps")),
    "stuck": (("shared",), (3,), EARLY),
    "backwards": (("shared",), (3,), REACHED.format("-0.5") + ": must not be earlier"),
    "timeless": (("shared",), (3,), REACHED.format("nan")),
}
CRASH = VICES["crashing"][2]
SELDOM = ("aborting", "leaving", "erring")


def case(path: Path, process: str | None, **changes: object):
    tables = {"decay": {"participant": path, "process": process}}
    return scenario(tables, master={"name": "jacobi"}, **changes)


@pytest.mark.parametrize(
    ("vice", "version"),
    [
        pytest.param(vice, version, marks=[pytest.mark.long] * (vice in SELDOM or version > min(versions)))
        for vice, (_, versions, _) in VICES.items()
        for version in versions
    ],
)
def test_the_run_ends_with_what_it_has(vice, version, tmp_path):
    processes, _, said = VICES[vice]
    if vice in ("scribbling", "feigning", "closing", "killing") and os.name != "posix":
        pytest.skip("processes are others on Windows")
    path = fmu(vice, version, tmp_path)
    for process in processes:
        summary, found = ran(case(path, process), tmp_path / process)
        assert summary.exit_status == 3
        assert not summary.complete
        assert re.search(said, summary.message), summary.message
        assert len(found["time"]) == 51
        assert found["time"][-1] == pytest.approx(0.5)


def test_of_one_that_crashes_nothing_is_left(tmp_path, monkeypatch):
    """Neither a temporary file nor a process."""
    path, folder = fmu("crashing", 2, tmp_path), tmp_path / "temporary"
    before = list_children()
    folder.mkdir()
    monkeypatch.setenv("TMPDIR", str(folder))
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    summary, _ = ran(case(path, "own"), tmp_path / "out")
    assert re.search(CRASH, summary.message)
    assert list(folder.iterdir()) == []
    assert list_children() == before


def list_children():
    """The processes that this one has started, without that from which those of FMUs are forked."""
    return {
        child
        for child in psutil.Process().children(recursive=True)
        if child.ppid() != os.getpid() or "fork_server.py" not in " ".join(child.cmdline())
    }


def test_a_process_of_its_own_is_for_all_but_what_is_as_we_made_it(tmp_path):
    """One that only says so, and one that was changed since, may do anything."""
    ours = build("flywheel", tmp_path)
    said = replace_text(ours, tmp_path / "changed.fmu", 'author="tribocosim', 'author="no tribocosim')
    claim = 'generationTool="tribocosim 1.0" modelName'
    claiming = replace_text(fmu("crashing", 2, tmp_path), tmp_path / "claiming.fmu", "modelName", claim)
    apart = {path.name: case(path, None).components["decay"].own_process for path in (ours, said, claiming)}
    assert apart == {"flywheel.fmu": False, "changed.fmu": True, "claiming.fmu": True}
    # Unless the scenario says where.
    for path, process in ((ours, "own"), (claiming, "shared")):
        assert case(path, process).components["decay"].own_process is (process == "own")
    summary, _ = ran(case(claiming, None), tmp_path / "out")
    assert re.search(CRASH, summary.message)


@posix
@pytest.mark.parametrize(
    ("vice", "how"),
    [
        ("slipping away", "exit status 0"),
        pytest.param("crashing", "SIGSEGV", marks=pytest.mark.long),
        pytest.param("quitting", "exit status 0", marks=pytest.mark.long),
        pytest.param("closing", "exit status 1", marks=pytest.mark.long),
    ],
)
def test_what_ends_the_run_s_process_ends_the_command_as_a_failure(vice, how, tmp_path):
    """Where `shared` was chosen; also when the run is continued. What was recorded can be made a result."""
    out, file = tmp_path / "out", tmp_path / "one.toml"
    one = case(fmu(vice, 2, tmp_path), "shared", checkpoint_every=1e-3)
    file.write_text(to_short_toml(one, tmp_path), "utf-8")
    for arguments in (("run", str(file), "--out", str(out)), ("resume", str(out))):
        ended = tribocosim(*arguments)
        assert ended.returncode == 3
        assert f"decay: the FMU ended the process of the whole command ({how}); --set" in ended.stderr
        assert f"resume {out} --keep makes the result of what was recorded, to t = 0.5 s" in ended.stderr
        left = json.loads((out / "summary.json").read_text("utf-8"))
        assert (left["complete"], left["exit_status"]) == (False, 3)
    done = tribocosim("resume", str(out), "--keep")
    assert done.returncode == 3
    assert "components.decay.process = 'own' says which and where" in done.stderr
    with open_result(out / "result.nc") as result:
        assert len(result["coupled"].time) == len(recorded(out)["time"]) == 51


@posix
def test_the_second_interrupt_ends_a_call_that_does_not_return(tmp_path, monkeypatch):
    """At once, and the run can go on to the numbers of one without a stop."""
    mark, out = tmp_path / "mark", tmp_path / "out"
    one = case(fmu("spinning once", 2, tmp_path), "own", checkpoint_every=1e-9)
    monkeypatch.setenv("MARK", str(mark))

    def interrupt_twice():
        wait_for(mark.exists)
        os.kill(os.getpid(), signal.SIGINT)
        wait_for(is_asked)
        os.kill(os.getpid(), signal.SIGINT)

    with ThreadPoolExecutor() as beside:
        interrupted = beside.submit(interrupt_twice)
        summary, found = ran(one, out)
        interrupted.result()
    assert (summary.exit_status, summary.resumable, len(found["time"])) == (130, True, 51)
    monkeypatch.delenv("MARK")
    assert resume(out, never, Reporter(), figures=False).complete
    _, whole = ran(one, tmp_path / "whole")
    np.testing.assert_array_equal(recorded(out)["decay.x"], whole["decay.x"])


@posix
@pytest.mark.parametrize(
    ("number", "status"), [(signal.SIGTERM, 143), pytest.param(signal.SIGINT, 130, marks=pytest.mark.long)]
)
def test_signals_end_a_command_whose_fmu_heeds_none(number, status, tmp_path):
    """It spins in the run's process, where Python hears of no signal. What was recorded is kept."""
    mark, out, file = tmp_path / "mark", tmp_path / "out", tmp_path / "one.toml"
    file.write_text(to_short_toml(case(fmu("deaf", 2, tmp_path), "shared"), tmp_path), "utf-8")
    started = subprocess.Popen(
        [sys.executable, "-m", "tribocosim", "run", str(file), "--out", str(out)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        env=os.environ | {"MARK": str(mark)},
        text=True,
    )
    wait_for(mark.exists)
    for _ in range(2):
        started.send_signal(number)
        time.sleep(0.3)  # else the two may become one
    _, said = started.communicate(timeout=60)
    assert f"resume {out} --keep makes the result of what was recorded, to t = 0.5 s" in said
    assert started.returncode == status


@posix
def test_the_first_signal_ends_a_check_of_an_fmu_that_heeds_none(tmp_path):
    """Nothing of it is kept, and the call could take ten minutes."""
    mark, begins = tmp_path / "mark", ('startTime="0"', 'startTime="0.6"')
    file = replace_text(fmu("deaf", 2, tmp_path), tmp_path / "later.fmu", *begins)
    started = subprocess.Popen(
        [sys.executable, "-m", "tribocosim", "fmu", "validate", str(file)],
        stderr=subprocess.PIPE,
        env=os.environ | {"MARK": str(mark)},
        text=True,
    )
    wait_for(mark.exists)
    started.send_signal(signal.SIGTERM)
    assert (started.communicate(timeout=60)[1], started.returncode) == ("tribocosim: interrupted\n", 143)


@posix
def test_copies_that_an_fmu_makes_of_the_run_s_process_do_not_go_on(tmp_path):
    """It would write the same result."""
    out, file = tmp_path / "out", tmp_path / "one.toml"
    file.write_text(to_short_toml(case(fmu("doubling", 2, tmp_path), "shared"), tmp_path), "utf-8")
    ended = tribocosim("run", str(file), "--out", str(out), "--no-figures")
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.count("results in") == 1
    assert len(recorded(out)["time"]) == 101


@posix
def test_copies_that_an_fmu_makes_of_its_process_do_not_answer(tmp_path):
    before = list_children()
    found = completed(case(fmu("forking", 2, tmp_path), "own"), tmp_path / "out")
    assert len(found["time"]) == 101
    assert list_children() <= before


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere orphans have no other parent than the first")
def test_what_leaves_the_session_of_an_fmu_ends_with_it(tmp_path, monkeypatch):
    monkeypatch.setenv("MARK", str(mark := tmp_path / "mark"))
    completed(case(fmu("detaching", 2, tmp_path), "own"), tmp_path / "out")
    assert not psutil.pid_exists(int(mark.read_text()))


def wait_for(come: Callable[[], bool]) -> None:
    end = time.monotonic() + 60.0
    while not come():
        assert time.monotonic() < end
        time.sleep(0.01)


@pytest.mark.parametrize(("version", "process"), CASES)
def test_a_file_that_cannot_be_instantiated_is_a_mistake(process, version, tmp_path):
    """Its token is not the library's: nothing is written."""
    out = tmp_path / "out"
    other = tmp_path / "other.fmu"
    replace_text(fmu("dahlquist", version, tmp_path), other, TOKEN, "{of another model}")
    with pytest.raises(MistakeError, match=rf"^decay: instantiate: .*{other} cannot be used .* give another"):
        run(case(other, process), out, never, Reporter(), figures=False)
    assert not out.exists()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="call_time_limit needs a POSIX system")
@pytest.mark.parametrize("vice", mark_long(["hanging", "spinning"], ["hanging"]))
def test_one_that_hangs_is_ended(vice, tmp_path):
    # The limit holds for the start of its process as well.
    path = fmu(vice, 3, tmp_path)
    summary, found = ran(case(path, "own", call_time_limit=5.0), tmp_path / "out")
    assert summary.exit_status == 3
    assert "decay: the step from t = 0.5 s by 0.01 s did not return within 5 s" in summary.message
    assert len(found["time"]) == 51


@pytest.mark.skipif(not hasattr(os, "fork"), reason="call_time_limit needs a POSIX system")
def test_an_fmu_that_reads_standard_input_gets_none_of_the_messages(tmp_path):
    path = fmu("listening", 2, tmp_path)
    found = completed(case(path, "own", call_time_limit=10.0), tmp_path / "out")
    assert len(found["time"]) == 101


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize(("vice", "first"), [("vanishing", 51), ("growing", 51), ("diverging", 2)])
def test_a_run_whose_outputs_make_no_sense_does_not_end_well(vice, first, version, tmp_path):
    """Also where nothing takes them, and nothing is compared. Every call reports success."""
    summary, found = ran(case(fmu(vice, version, tmp_path), "shared"), tmp_path / "out")
    assert not (np.abs(found["decay.x"][first:]) < 1e30).any()
    assert list(summary.senseless) == ["decay.x"]
    assert summary.senseless["decay.x"] == pytest.approx(found["time"][first])
    assert summary.complete
    assert summary.exit_status == 1
    said = f"not finite, or above 1e30 times its nominal size: decay.x from t = {found['time'][first]:.6g} s"
    assert in_command_line(summary.verdict).startswith(said)


def test_an_fmu_that_stands_still_while_its_input_moves_is_named(tmp_path):
    """One that follows is not."""
    tables = {
        name: {"participant": fmu(name, 2, tmp_path)} for name in ("dahlquist", "freezing", "feedthrough")
    }
    lines = ["dahlquist.x -> freezing.u", "dahlquist.x -> feedthrough.real in"]
    summary, _ = ran(scenario(tables, master={"name": "gauss_seidel"}, connections=lines), tmp_path / "out")
    (said,) = summary.frozen
    assert re.match(
        r"freezing: no output changes from t = 0\.(29|3|31) s on, though freezing\.u changes", said
    )


@pytest.mark.parametrize(("steps", "told"), [(np.zeros(30), 1), (np.arange(30.0), 0)])
def test_an_fmu_whose_discrete_output_follows_does_not_stand_still(steps, told):
    jumping, smooth = (Mock(quantity=Mock(jumps=jumps)) for jumps in (True, False))
    outputs = Mock(fields=[jumping, smooth], names=("count", "out"))
    system = Mock(
        instances={"f": Mock(component=Mock(outputs=outputs))},
        connections=[Mock(source="d.x", target=Port("f", "u"))],
    )
    columns = {"time": np.arange(30.0), "d.x": np.arange(30.0), "f.count": steps, "f.out": np.zeros(30)}
    assert len(list_frozen(system, ["f"], columns.__getitem__)) == told


linux = pytest.mark.skipif(sys.platform != "linux", reason="needs prlimit of Linux")


@linux
@pytest.mark.parametrize(("limit", "complete"), [(400, False), (None, True)])
def test_an_fmu_has_no_more_memory_than_it_is_given(limit, complete, tmp_path):
    table = {"participant": fmu("greedy", 2, tmp_path), "process": "own"}
    table |= {} if limit is None else {"memory_limit_mb": limit}
    summary, _ = ran(scenario({"one": table}), tmp_path / "out")
    assert summary.complete is complete
    assert complete or "no memory left" in summary.message


@pytest.mark.parametrize(
    ("table", "limit", "said"),
    [
        ({"memory_limit_mb": 400}, None, "one.memory_limit_mb: "),
        ({}, 5.0, "but one is in the run's; "),
        # Not what we have built, unless it is alone.
        ({"participant": "fmu", "component": "flywheel"}, 5.0, "but one is in the run's; "),
    ],
)
def test_limits_need_a_process_of_its_own(table, limit, said, tmp_path):
    first = {"participant": fmu("dahlquist", 2, tmp_path), **table}
    with pytest.raises(ScenarioError, match=f"{said}.*set components\\.one\\.process = 'own'"):
        build_system(scenario({"one": first}, call_time_limit=limit))


@pytest.mark.skipif(temporary.fcntl is None, reason="needs locks of POSIX")
def test_folders_of_killed_processes_are_deleted_by_a_later_one(tmp_path, monkeypatch):
    """Not those of living ones, whatever their age, nor new ones, nor what has another name."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    code = "from models.compile.temporary import *; print(TemporaryFolder().path, flush=True); input()"

    def start():
        made = subprocess.Popen(
            [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        assert made.stdout is not None
        return made, Path(made.stdout.readline().strip())

    (living, kept), (dead, left) = start(), start()
    dead.kill()
    dead.communicate()
    new, other = tmp_path / f"{PREFIX}new", tmp_path / "other"
    new.mkdir()
    other.mkdir()
    for folder in (kept.parent, left.parent, other):
        os.utime(folder, (0.0, time.time() - 2.0 * NEW))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    first, second = TemporaryFolder(), TemporaryFolder()
    assert [folder.exists() for folder in (kept, left.parent, new, other)] == [True, False, True, True]
    living.communicate("")
    # A process has one folder, which goes with the last of those in it.
    for one, number in ((first, 1), (second, 0)):
        assert one.path.parent == second.path.parent
        one.delete()
        assert len(list(tmp_path.glob(f"{PREFIX}*/*"))) == number + 1  # that of the living one
    assert not second.path.parent.exists()
