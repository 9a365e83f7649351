"""The process of a third-party FMU."""

import contextlib
import errno
import gc
import os
import subprocess
import sys
from unittest.mock import Mock

import psutil
import pytest

from orchestrator.errors import LostParticipantError, ParticipantError
from orchestrator.participants.forked import Forked
from orchestrator.participants.in_own_process import InOwnProcess
from orchestrator.participants.opened_fmu import FmuSettings

from .c_fmus import fmu
from .runs import CASES

# A run of the FMU at PATH by messages, which prints the packages of what it has imported.
SERVED = """
import json, sys
from orchestrator.participants.messages import ADVANCE, CALL, READ, TIMES
from orchestrator.participants.process import Server
server = Server()
call = lambda method, **given: server.carry_out(CALL, json.dumps({"method": method, **given}).encode())
path, folder = sys.argv[1:]
call("instantiate", name="mass", path=path, given={"outputs": ["position"]}, folder=folder)
call("connect", inputs=["force"], rows=4, outputs=["position"], rated=True)
call("initialise", start_time=0.0, stop_time=1.0)
call("finish_initialisation")
server.carry_out(ADVANCE, TIMES.pack(0.0, 0.01) + bytes(32))
server.carry_out(READ, b"")
call("close")
print(*(name.partition(".")[0] for name in sys.modules))
"""
NEEDLESS = {
    "numba", "llvmlite", "scipy", "sksundae", "matplotlib", "pydantic", "xarray", "h5netcdf", "pint", "typer",
    "rich", "jinja2", "pythonfmu",
}  # fmt: skip


@pytest.mark.parametrize("version", sorted({version for version, _ in CASES}))
def test_the_process_of_an_fmu_imports_no_compiler(version, tmp_path):
    """Nor what solves, draws or reads scenarios: each FMU would wait for it. The FMU holds its input, which
    gets means."""
    path = fmu("sprung", version, tmp_path)
    command = [sys.executable, "-c", SERVED, str(path), str(tmp_path / "unpacked")]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    assert not NEEDLESS & set(done.stdout.split())


linux = pytest.mark.skipif(sys.platform != "linux", reason="elsewhere each process is started")


@contextlib.contextmanager
def opened(path, number):
    with contextlib.ExitStack() as stack:
        yield [
            stack.enter_context(contextlib.closing(InOwnProcess("mass", path, FmuSettings(["position"]))))
            for _ in range(number)
        ]


def find_origin():
    """The process from which those of FMUs are forked."""
    (one,) = (c for c in psutil.Process().children() if "fork_server.py" in " ".join(c.cmdline()))
    return one


@linux
def test_all_fmus_are_forked_from_one_process_that_has_imported(tmp_path):
    """Each has a session and a keeper of its own; another environment gives another origin."""
    path = fmu("sprung", 2, tmp_path)
    with opened(path, 3):
        keepers = find_origin().children()
        assert len(keepers) == 3
        assert {os.getsid(keeper.pid) for keeper in keepers} == {keeper.pid for keeper in keepers}
        keepers[0].children()[0].kill()
    origin = find_origin()
    with opened(path, 1):
        assert find_origin() == origin
    with pytest.MonkeyPatch.context() as patched:
        patched.setenv("LD_LIBRARY_PATH", str(tmp_path))
        with opened(path, 1):
            assert find_origin() != origin
            assert not origin.is_running()


@linux
def test_where_the_origin_is_killed_its_fmus_end_and_others_come_from_another(tmp_path):
    path = fmu("sprung", 2, tmp_path)
    with opened(path, 1) as (lost,):
        origin = find_origin()
        forked = origin.children(recursive=True)
        origin.kill()
        assert len(psutil.wait_procs(forked, 60.0)[0]) == 2
        with pytest.raises(LostParticipantError, match="its process ended by SIGKILL in the call initialise"):
            lost.initialise(0.0, 1.0)
        with opened(path, 1) as (other,):
            other.initialise(0.0, 1.0)


@linux
def test_an_interrupted_start_leaves_the_other_fmus(tmp_path, monkeypatch):
    path = fmu("sprung", 2, tmp_path)
    with opened(path, 1) as (first,):
        origin = find_origin()
        origin.suspend()  # until the run has closed its ends
        with monkeypatch.context() as patched:
            patched.setattr(Forked, "_read_number", Mock(side_effect=KeyboardInterrupt))
            with pytest.raises(KeyboardInterrupt):
                InOwnProcess("mass", path, FmuSettings(["position"]))
        origin.resume()
        with opened(path, 1):
            assert find_origin() == origin
        assert first._process.poll() is None
        first.initialise(0.0, 1.0)


# For the start of an origin: its forks fail where the file named here is.
REFUSING = """
import errno, os
fork = os.fork
def refuse():
    if os.path.exists({file!r}):
        raise OSError(errno.EAGAIN, os.strerror(errno.EAGAIN))
    return fork()
os.fork = refuse
"""
FEWER = "use fewer FMUs, or raise the limits of processes, open files and memory"


@linux
@pytest.mark.parametrize(
    ("failing", "said"),
    [
        ("fork", f"(Resource temporarily unavailable); {FEWER}"),
        ("import", f"(Package not installed); install tribocosim again, {FEWER}"),
        ("origin", f"(Cannot allocate memory); {FEWER}"),
    ],
    ids=["fork", "import", "origin"],
)
def test_where_no_process_starts_the_run_says_why_and_the_other_fmus_go_on(
    failing, said, tmp_path, monkeypatch
):
    path, file = fmu("sprung", 2, tmp_path), tmp_path / "refused"
    (tmp_path / "sitecustomize.py").write_text(REFUSING.format(file=str(file)))
    monkeypatch.syspath_prepend(tmp_path)
    with opened(path, 1) as (first,):
        with monkeypatch.context() as patched:
            if failing == "fork":
                file.touch()
            elif failing == "import":
                patched.setattr(InOwnProcess, "server", "orchestrator.missing")
            else:
                patched.setenv("LD_LIBRARY_PATH", str(tmp_path))
                lacking = OSError(errno.ENOMEM, os.strerror(errno.ENOMEM))
                patched.setattr(subprocess, "Popen", Mock(side_effect=lacking))
            with pytest.raises(ParticipantError) as raised:
                InOwnProcess("mass", path, FmuSettings(["position"]))
        assert str(raised.value) == f"mass: its process cannot start {said}"
        file.unlink(missing_ok=True)
        assert first._process.poll() is None
        first.initialise(0.0, 1.0)
        with opened(path, 1) as (other,):
            other.initialise(0.0, 1.0)


def test_a_start_at_the_limit_of_descriptors_leaves_none_open(monkeypatch):
    open_pipe, left = os.pipe, [0, 0]

    def open_while_some_are_left() -> tuple[int, int]:
        if not left:
            raise OSError(errno.EMFILE, os.strerror(errno.EMFILE))
        left.pop()
        return open_pipe()

    monkeypatch.setattr(os, "pipe", open_while_some_are_left)
    gc.collect()  # what other tests left open
    before = psutil.Process().num_fds()
    with pytest.raises(OSError, match=os.strerror(errno.EMFILE)):
        Forked("orchestrator.participants.process", "0", os.environ)
    assert psutil.Process().num_fds() == before
