"""Calls that do not return: named, with results kept, whether or not the call can be interrupted."""

from __future__ import annotations

import ctypes
import json
import os
import signal
import subprocess
import sys
import time as clock
from pathlib import Path

import numba
import numpy as np
import pytest

from fmus.build import build
from orchestrator.errors import MistakeError, StalledError
from orchestrator.masters import GaussSeidel
from orchestrator.participants import in_process
from orchestrator.run.simulation import simulate
from orchestrator.run.summary import Summary
from orchestrator.run.watchdog import GRACE_SECONDS, Watchdog
from orchestrator.run.watchdog_process import CALLS

from .commands import ROOT, SHORT, tribocosim
from .coupled import run_coupled
from .faulty import Faulty, once_after
from .recorder import Recorder
from .test_fmu_commands import write_tampered
from .two_masses import two_masses

STEP, STOP = 1e-2, 1.0


def watchdog(folder, limit):
    summary = Summary("two masses", "", "1", {}, STEP, True, {})
    return Watchdog(limit, ["first", "second"], folder / "summary.json", summary)


def run(folder, limit, make, *observers):
    """The two masses, the second made by `make(instance)`."""
    system, recorder = two_masses(), Recorder()
    units = {}
    with watchdog(folder, limit) as dog:
        try:
            for name, kind in (("first", in_process), ("second", lambda name, instance: make(instance))):
                units[name] = dog.made(name, lambda name=name, kind=kind: kind(name, system.instances[name]))
            simulate(system, units, GaussSeidel("linear"), STEP, STOP, [dog, recorder, *observers])
        finally:
            for unit in units.values():
                unit.close()
    return recorder


def busy():
    end = clock.monotonic() + 60.0
    while clock.monotonic() < end:
        pass


@pytest.mark.parametrize("stall", [lambda: clock.sleep(60.0), busy], ids=["sleeps", "computes"])
def test_python_code_that_stalls_is_interrupted_and_named(stall, tmp_path):
    made, began = [], []

    def stalling():
        began.append(clock.monotonic())
        stall()

    def make(instance):
        made.append(Faulty(in_process("second", instance), stalls=once_after(0.5), stall=stalling))
        return made[0]

    recorder = Recorder()
    said = r"^second: the step did not return within 0\.5 s after t = 0\.5 s \(macro step 51\)"
    with pytest.raises(StalledError, match=said):
        run(tmp_path, 0.5, make, recorder)
    assert clock.monotonic() - began[0] < 0.5 + GRACE_SECONDS
    assert recorder.times[-1] == pytest.approx(0.5, abs=1e-12)
    assert made[0].closed
    assert not (tmp_path / "summary.json").exists()


METHODS = {
    "initialise": "initialisation",
    "finish_initialisation": "end of initialisation",
    "write": "setting of inputs",
    "advance": "step",
    "read": "reading of outputs",
    "read_all": "reading of all outputs",
    "save": "saving of its state",
    "restore": "restoring of its state",
    "release": "freeing of a saved state",
    "close": "end",
}


@pytest.mark.parametrize("method", METHODS)
def test_every_call_is_watched_under_its_name(method, tmp_path):
    def make(instance):
        unit = Faulty(in_process("second", instance))
        setattr(unit, method, lambda *arguments: clock.sleep(60.0))
        return unit

    with pytest.raises(StalledError, match=f"second: the {METHODS[method]} did not return"):
        run(tmp_path, 0.3, make)


def test_an_instantiation_is_watched(tmp_path):
    with pytest.raises(StalledError, match="second: the instantiation did not return"):
        run(tmp_path, 0.3, lambda instance: clock.sleep(60.0))
    assert {*METHODS.values(), *OF_CHECKPOINTS.values(), "instantiation"} == set(CALLS)


OF_CHECKPOINTS = {"to_bytes": "serialising of its state", "from_bytes": "taking of a serialised state"}


@pytest.mark.parametrize("method", OF_CHECKPOINTS)
def test_calls_for_checkpoints_are_watched(method, tmp_path):
    unit = Faulty(in_process("second", two_masses().instances["second"]))
    setattr(unit, method, lambda argument: clock.sleep(60.0))
    said = f"^second: the {OF_CHECKPOINTS[method]} did not return"
    with watchdog(tmp_path, 0.3) as dog, pytest.raises(StalledError, match=said):
        getattr(dog.made("second", lambda: unit), method)(None)


def test_the_limit_is_one_for_each_call_and_not_for_what_lies_between(tmp_path):
    """A hundred calls of 20 ms and an observer of a second, with a limit of 0.4 s."""

    class Slow(Recorder):
        def observe(self, time, outputs, step):
            super().observe(time, outputs, step)
            if len(self.times) == 50:
                clock.sleep(1.0)

    def make(instance):
        return Faulty(
            in_process("second", instance), stalls=lambda *call: True, stall=lambda: clock.sleep(0.02)
        )

    watched = run(tmp_path, 0.4, make, Slow())
    plain = run_coupled(two_masses(), GaussSeidel("linear"), STEP, STOP)
    np.testing.assert_array_equal(watched["second.position"], plain["second.position"])


def compiling():
    """Compiles for longer than LIMIT, whatever the machine: kernels one after the other until then."""
    began = clock.monotonic()
    while clock.monotonic() - began < 3.0 * LIMIT:
        numba.njit(lambda x: x + 1.0)(1.0)


LIMIT = 0.3


def test_compiling_does_not_count(tmp_path):
    """Neither is its participant blamed, nor numba broken off; what stalls after it is named as ever."""
    system = two_masses()

    def make(stall):
        return lambda instance: Faulty(
            in_process("second", system.instances["second"]), stalls=once_after(0.5), stall=stall
        )

    recorder = run(tmp_path, LIMIT, make(compiling))
    assert recorder.ended == (True, "")

    def compiling_and_then_busy():
        compiling()
        busy()

    with pytest.raises(StalledError, match=r"^second: the step did not return within 0\.3 s after t = 0\.5"):
        run(tmp_path, LIMIT, make(compiling_and_then_busy))


def test_what_c_code_cannot_pass_on_is_raised_at_the_end_of_the_step_and_not_printed(tmp_path, capfd):
    """C code that calls Python back has nowhere to put an exception."""
    called_back = ctypes.CFUNCTYPE(None)(lambda: clock.sleep(60.0))

    def make(instance):
        return Faulty(in_process("second", instance), stalls=once_after(0.5), stall=called_back)

    hook = sys.unraisablehook
    with pytest.raises(StalledError, match="second: the step did not return"):
        run(tmp_path, LIMIT, make)
    assert sys.unraisablehook is hook
    assert "Traceback" not in "".join(capfd.readouterr())


@pytest.mark.long
def test_the_first_run_on_a_machine_has_its_limit_and_says_that_it_compiles(tmp_path, monkeypatch):
    monkeypatch.setenv("TRIBOCOSIM_CACHE", str(tmp_path / "cache"))
    out = tmp_path / "out"
    changes = ["--set=stop_time=10 ms", "--set=reference.enabled=false", "--set=call_time_limit=0.5 s"]
    done = tribocosim("run", "two-masses", "--out", str(out), "--no-figures", *changes)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("compiling ") == 1
    again = tribocosim("run", "two-masses", "--out", str(out), "--no-figures", "--overwrite", *changes)
    assert "compiling " not in again.stdout


def test_the_watching_process_ends_with_the_run(tmp_path):
    with watchdog(tmp_path, 5.0) as dog:
        assert dog._process.poll() is None
    assert dog._process.returncode == 0
    assert signal.getsignal(signal.SIGUSR1) == signal.SIG_DFL


def test_without_posix_signals_the_limit_is_refused(tmp_path, monkeypatch):
    monkeypatch.delattr(signal, "SIGQUIT")
    with pytest.raises(MistakeError, match="call_time_limit"):
        watchdog(tmp_path, 5.0)


# What the camshaft's FMU does from 1 ms on, and whether the call can be interrupted.
STALLS = {
    "sleeps": "import time; time.sleep(60.0)",
    "waits in C": "import ctypes; lock, x = ctypes.CDLL(None).pthread_mutex_lock, (ctypes.c_long * 8)()\n"
    "        lock(x); lock(x)",
    "holds the interpreter": "import ctypes; lock = ctypes.PyDLL(None).pthread_mutex_lock\n"
    "        x = (ctypes.c_long * 8)(); lock(x); lock(x)",
}
STALLING = """
def do_step(self, t, h, _real=camshaft.do_step):
    if t > 1e-3:
        {stall}
    return _real(self, t, h)
camshaft.do_step = do_step
"""


@pytest.fixture(scope="module")
def camshaft(tmp_path_factory):
    return build("camshaft", tmp_path_factory.mktemp("fmu"))


def arguments(file, out):
    """In the run's own process, where the FMU would not run unasked: it is not as it was made."""
    others = [text for text in SHORT if "camshaft" not in text]
    changed = [
        "call_time_limit=5 s",
        f"components.camshaft.participant={file}",
        "components.camshaft.process=shared",
    ]
    return [
        "run",
        "valve-train",
        "--out",
        str(out),
        *others,
        "--no-figures",
        *(f"--set={c}" for c in changed),
    ]


@pytest.mark.parametrize(
    "kind",
    ["sleeps", *(pytest.param(k, marks=pytest.mark.long) for k in ("waits in C", "holds the interpreter"))],
)
def test_a_stalled_run_ends_with_status_3_and_its_results(kind, camshaft, tmp_path):
    file = write_tampered(camshaft, tmp_path / "stalls.fmu", STALLING.format(stall=STALLS[kind]))
    out = tmp_path / "out"
    done = tribocosim(*arguments(file, out))
    assert done.returncode == 3
    said = "incomplete: camshaft: the step did not return within 5 s after t = 0.001"
    assert done.stderr.strip().splitlines()[-1].startswith(f"tribocosim: {said}")
    summary = json.loads((out / "summary.json").read_text())
    assert summary["message"].startswith(said)
    assert (summary["complete"], summary["exit_status"]) == (False, 3)
    assert summary["macro_steps"] == pytest.approx(1e-3 / summary["macro_step"], rel=0.01)
    if kind == "sleeps":
        assert (out / "result.nc").exists()
    else:
        assert (out / "unfinished" / "coupled.journal").stat().st_size > 0


def test_a_killed_run_leaves_no_watching_process(camshaft, tmp_path):
    file = write_tampered(camshaft, tmp_path / "waits.fmu", STALLING.format(stall=STALLS["sleeps"]))
    code = "from tribocosim.command_line import main; main()"
    started = subprocess.Popen(
        [sys.executable, "-c", code, *arguments(file, tmp_path / "out"), "--set=call_time_limit=100 s"],
        env=os.environ | {"PYTHONPATH": str(ROOT)}, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    children = Path(f"/proc/{started.pid}/task/{started.pid}/children")
    watching = []
    while not watching and started.poll() is None:
        clock.sleep(0.1)
        watching = [
            int(pid) for pid in children.read_text().split()
            if b"watchdog_process" in Path(f"/proc/{pid}/cmdline").read_bytes()
        ]  # fmt: skip
    started.kill()
    started.wait()
    assert watching
    end = clock.monotonic() + 10.0
    while any(map(_runs, watching)) and clock.monotonic() < end:
        clock.sleep(0.05)
    assert not any(map(_runs, watching))


def _runs(pid):
    """The process exists and is no zombie that waits for its new parent."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False
