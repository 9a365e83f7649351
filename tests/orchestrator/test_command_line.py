"""The command line: runs leave whole results; mistakes and failures are one message and a status."""

import contextlib
import ctypes
import json
import os
import signal
import subprocess
import sys
import tomllib

import numba
import numpy as np
import pytest
import typer
from rich.console import Console

from fmus.build import NAMES
from orchestrator.reporter import COMPILES, Reporter, tell_compilation, tell_interruption
from orchestrator.scenario import build_scenario
from orchestrator.scenario.files import list_shipped, load
from orchestrator.scenario.system import build_system
from orchestrator.store.result_file import open_result
from orchestrator.study import files as studies
from tribocosim.command_line import app
from tribocosim.command_line.completion import complete_component, complete_scenario, complete_study
from tribocosim.command_line.error_report import report_errors
from tribocosim.reporting import SilentReporter

from .commands import IN_PROCESS, ROOT, SHORT, called, said, tribocosim


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """A short run with everything."""
    out = tmp_path_factory.mktemp("run") / "out"
    done = tribocosim("run", "valve-train", "--out", str(out), *SHORT)
    assert done.returncode in (0, 1), done.stderr
    assert "contact.load" in done.stdout
    assert str(out) in done.stdout
    return out


def test_a_run_leaves_result_csv_figures_report_scenario_and_summary(result):
    names = {path.name for path in result.iterdir()}
    files = {"result.nc", "coupled.csv", "units.csv", "scenario.toml", "report.html"} | {
        "summary.json",
        "summary.csv",
    }
    assert names == {*files, "figures"}
    figures = list((result / "figures").glob("*.png"))
    assert len(figures) >= 3
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in figures)


def _no_constant(text: str) -> float:
    raise ValueError(f"{text} is not JSON")


def test_summary_has_what_tools_rely_on(result):
    summary = json.loads((result / "summary.json").read_text(), parse_constant=_no_constant)
    assert summary["scenario"] == "valve-train"
    assert summary["complete"] is True
    assert summary["macro_steps"] == round(2e-3 / summary["macro_step"])
    assert summary["iterations"] >= summary["macro_steps"]
    assert summary["rejected_steps"] == 0
    for key in ("wall_time_s", "coupled_time_s", "reference_time_s", "reference_uncertainty"):
        assert summary[key] > 0.0
    assert set(summary["tolerance"]) == {"contact.load", "contact.film_thickness"}
    connected = {line.split(" -> ")[0] for line in load("valve-train").connections}
    assert set(summary["errors"]) == connected | set(summary["tolerance"])
    for error in summary["errors"].values():
        assert {"max_abs", "rms", "relative_rms", "reference_uncertainty"} <= set(error)
        assert 0.0 <= error["rms"] <= error["max_abs"]


def test_result_holds_coupled_run_and_reference_at_the_same_times(result):
    tree = open_result(result)
    system = build_system(load("valve-train"))
    assert set(tree["coupled"].data_vars) == set(system.outputs.names)
    assert np.array_equal(tree["coupled"]["time"], tree["reference"]["time"])
    assert tree["coupled"]["contact.load"].attrs["units"] == "N"
    summary = json.loads((result / "summary.json").read_text())
    error = tree["coupled"]["contact.load"] - tree["reference"]["contact.load"]
    assert float(abs(error).max()) == pytest.approx(summary["errors"]["contact.load"]["max_abs"], rel=1e-12)
    assert tree.attrs["complete"] == 1
    assert "numba" in tree.attrs["versions"]
    assert build_scenario(tomllib.loads(tree.attrs["scenario_toml"])).name == "valve-train"
    tree.close()


def test_the_resolved_scenario_runs_identically(result, tmp_path):
    again = tmp_path / "again"
    arguments = ["--set=reference.enabled=false", "--no-figures"]
    done = called("run", str(result / "scenario.toml"), "--out", str(again), *arguments)
    assert done.returncode == 0
    assert (again / "coupled.csv").read_bytes() == (result / "coupled.csv").read_bytes()


def test_an_existing_result_is_kept_unless_told(result):
    before = (result / "summary.json").read_bytes()
    done = called("run", "valve-train", "--out", str(result), *SHORT)
    assert done.returncode == 2
    assert "already holds a result" in said(done)
    assert "--overwrite" in said(done)
    assert (result / "summary.json").read_bytes() == before


def test_a_scenario_is_not_replaced_by_its_own_result(tmp_path):
    own = tmp_path / "scenario.toml"
    own.write_text("# mine\nextends = 'valve-train'\n")
    done = called("run", str(own), "--out", str(tmp_path), "--overwrite", *SHORT)
    assert done.returncode == 2
    assert "is the scenario itself" in said(done)
    assert own.read_text().startswith("# mine")
    assert list(tmp_path.iterdir()) == [own]


def test_too_tight_a_tolerance_is_not_a_success(tmp_path):
    arguments = [
        "--set=tolerance.contact.load=1e-9",
        "--set=stop_time=20 ms",
        "--no-figures",
        "--out",
        str(tmp_path / "out"),
    ]
    done = called("run", "valve-train", *SHORT, *arguments)
    assert done.returncode == 1
    assert "contact.load" in done.stdout
    assert "outside the tolerance" in done.stdout


@pytest.mark.long
def test_a_train_with_lash_in_equal_steps_is_told_the_remedy(tmp_path):
    """Seat and cam take up the valve between two steps; the remedy keeps the tolerance."""
    changes = ("lash=0.2 mm", "seat_stiffness=2e7", "seat_damping=300")
    given = [f"--set=components.valve_spring.parameters.{change}" for change in changes]
    train = ("run", "valve-train", *given, "--set=stop_time=45 ms", "--no-figures")
    done = called(*train, "--out", str(tmp_path / "equal"))
    assert done.returncode == 1, done.stderr
    (verdict,) = (line for line in done.stdout.splitlines() if "outside the tolerance" in line)
    remedy = verdict.rpartition(": ")[2].split()
    assert remedy[0] == "--set"
    done = called(*train, *remedy, "--out", str(tmp_path / "located"))
    assert done.returncode == 0, done.stdout


def test_instability_is_named_and_what_was_computed_is_kept(tmp_path):
    out = tmp_path / "out"
    arguments = ["--master", "jacobi", "--set=macro_step=100 us", "--set=stop_time=50 ms", *IN_PROCESS]
    done = called("run", "valve-train", "--out", str(out), *arguments)
    assert done.returncode == 3
    assert "unstable" in said(done)
    assert "macro_step" in said(done)
    summary = json.loads((out / "summary.json").read_text(), parse_constant=_no_constant)
    assert summary["complete"] is False
    assert "unstable" in summary["message"]
    assert summary["macro_steps"] > 0
    tree = open_result(out)
    assert tree.attrs["complete"] == 0
    assert tree["coupled"].sizes["time"] == summary["macro_steps"] + 1
    assert all(np.isfinite(values).all() for values in tree["coupled"].data_vars.values())
    tree.close()


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT for one process")
@pytest.mark.parametrize("asked", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_and_sigterm_keep_what_was_computed(asked, tmp_path):
    """SIGTERM also where Ctrl-C is ignored, as in the background of a shell."""
    out = tmp_path / "out"
    code = "from tribocosim.command_line import main; main()"
    long = ["--set=stop_time=100 s", "--set=output_step=1 ms", *IN_PROCESS]
    process = subprocess.Popen(
        [sys.executable, "-c", code, "run", "valve-train", "--out", str(out), *long],
        preexec_fn=lambda: signal.signal(
            signal.SIGINT, signal.SIG_IGN if asked == signal.SIGTERM else signal.default_int_handler
        ),
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT,
    )  # fmt: skip
    assert process.stdout
    for line in process.stdout:
        if line.startswith("coupled run"):
            break
    while not (out / "unfinished" / "coupled.journal").exists() and process.poll() is None:
        pass
    try:
        process.wait(2.0)
    except subprocess.TimeoutExpired:
        process.send_signal(asked)
    printed, errors = process.communicate(timeout=60)
    assert process.returncode == 128 + asked, errors
    said = ["incomplete: the run made ", "of a run that broke off", "contact: kept, least load of "]
    assert sorted(said, key=printed.index) == said
    assert errors.startswith("tribocosim: incomplete: interrupted")
    assert "interrupted" not in printed
    assert f"tribocosim resume {out} " in errors
    summary = json.loads((out / "summary.json").read_text())
    assert summary["complete"] is False
    assert summary["macro_steps"] > 0
    tree = open_result(out)
    assert tree["coupled"].sizes["time"] == 1 + summary["macro_steps"] // 200
    assert tree.attrs["message"] == "incomplete: interrupted"
    tree.close()
    assert summary["resumable"] is True
    assert (out / "unfinished" / "checkpoint").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="asks as bash does")
def test_the_shell_completes_names():
    asked = {
        "_TRIBOCOSIM_COMPLETE": "complete_bash",
        "COMP_WORDS": "tribocosim run valve-train-b",
        "COMP_CWORD": "2",
    }
    code = "import sys; sys.argv[0] = 'tribocosim'; from tribocosim.command_line import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | asked,
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.stdout.split() == ["valve-train-bounce"]


def test_completed_names_are_those_that_are_known():
    assert complete_scenario("") == sorted(list_shipped())
    assert complete_study("") == sorted(studies.list_shipped())
    assert complete_component("") == sorted(NAMES)
    assert complete_component("valve_") == ["valve_spring"]


def test_native_fmus_without_their_tools_are_a_mistake_and_nothing_is_written(monkeypatch, tmp_path):
    from fmus.native import fmu

    monkeypatch.setattr(fmu, "_TOOLS", ("numba", "no-such-package"))
    out = tmp_path / "out"
    done = called("run", "valve-train", "--native", f"--out={out}")
    assert done.returncode == 2
    message = said(done)
    assert message.startswith("tribocosim: components flywheel, camshaft, valve_spring, contact: native code")
    assert message.count("no-such-package") == message.count("native code needs") == 1
    assert "pip install" in message
    assert not out.exists()


def test_version_and_schema():
    assert called("--version").stdout.startswith("tribocosim ")
    assert json.loads(called("scenarios", "--schema").stdout)["title"] == "tribocosim scenario"


@pytest.mark.skipif(sys.platform == "win32", reason="pipes and statuses of Unix")
@pytest.mark.parametrize("unbuffered", [[], ["-u"]])
@pytest.mark.parametrize(
    "arguments",
    [
        ["scenarios"],
        ["run", "two-masses", "--no-figures", "--set=stop_time=0.1", "--set=reference.enabled=false"],
    ],
)
def test_a_reader_that_leaves_ends_the_command_quietly(unbuffered, arguments, tmp_path):
    """As SIGPIPE ends other programs: without a word, with 128 + 13."""
    code = "from tribocosim.command_line import main; main()"
    command = [sys.executable, *unbuffered, "-c", code, *arguments]
    reading, writing = os.pipe()
    os.close(reading)
    try:
        environment = os.environ | {"PYTHONPATH": str(ROOT)}
        done = subprocess.run(
            command, stdout=writing, stderr=subprocess.PIPE, cwd=tmp_path, env=environment, text=True
        )
    finally:
        os.close(writing)
    assert (done.returncode, done.stderr) == (141, "")


def test_no_help_has_words_that_are_swallowed_as_markup():
    """What stands in square brackets is a style to the help's formatter: defaults are given as such."""

    def helps(command):
        for one in getattr(command, "commands", {}).values():
            yield from helps(one)
        yield command.help or ""
        yield from (getattr(parameter, "help", None) or "" for parameter in command.params)

    texts = list(helps(typer.main.get_command(app)))
    assert len(texts) > 50
    assert [text for text in texts if "[" in text] == []


def test_ctrl_c_while_modules_are_imported_has_no_traceback():
    """Modules are found in `sys.modules`: here one whose command is interrupted."""
    code = (
        "import sys, types, signal; stub = types.ModuleType('tribocosim.command_line');"
        "stub.main = lambda: signal.raise_signal(signal.SIGINT);"
        "sys.modules[stub.__name__] = stub; from tribocosim.__main__ import main; main()"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, "tribocosim: interrupted\n")


def test_importing_the_command_line_imports_nothing_slow():
    """`tribocosim --help` has to answer at once."""
    slow = ("numpy", "scipy", "numba", "matplotlib", "pydantic", "xarray", "fmpy", "pint", "models.catalogue")
    code = f"import sys, tribocosim.command_line; print([m for m in {slow} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert done.stdout.strip() == "[]"


def test_a_run_imports_nothing_that_solves_references():
    """Half a second of processor time, of the two that a run of two small FMUs takes."""
    slow = ("scipy.integrate", "scipy.optimize", "scipy.special", "sksundae", "pint")
    code = f"import sys, orchestrator.run.pipeline; print([m for m in {slow} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert done.stdout.strip() == "[]"


@pytest.fixture
def ctrl_c():
    """Ctrl-C interrupts, also in a suite that was started in the background, where it is ignored."""
    previous = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, previous)


@pytest.mark.usefixtures("ctrl_c")
def test_what_a_library_makes_of_ctrl_c_is_an_interruption(capsys):
    """numba, broken off while it compiles, fails later on with an error of its own."""

    @report_errors
    def compiling():
        with contextlib.suppress(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        raise RuntimeError("no compiled object yet")

    @report_errors
    def failing():
        raise RuntimeError("no compiled object yet")

    for command, status in ((compiling, 130), (failing, 3)):
        with pytest.raises(typer.Exit) as left:
            command()
        assert left.value.exit_code == status
    for command, error in ((compiling, KeyboardInterrupt), (failing, RuntimeError)):
        with (
            pytest.raises(error, match=r"interrupted; all is kept|no compiled"),
            tell_interruption(lambda: "all is kept"),
        ):
            command.__wrapped__()
    assert capsys.readouterr().err.startswith("tribocosim: interrupted\ntribocosim: unexpected")


@pytest.mark.usefixtures("ctrl_c")
@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_an_interruption_within_a_callback_ends_the_command_where_it_looks(number, status, capsys):
    """An error in a destructor or a C callback is printed and dropped; numba and figures have such."""
    after = []

    class Destroyed:
        def __del__(self):
            signal.raise_signal(number)

    def call_from_c():
        ctypes.CFUNCTYPE(None)(lambda: signal.raise_signal(number))()

    def run_into(cause, look_in):
        cause()
        with look_in:
            after.append(cause)

    for cause in (Destroyed, call_from_c):
        with pytest.raises(typer.Exit) as left:
            report_errors(run_into)(cause, SilentReporter().stage("the next"))
        assert (left.value.exit_code, after) == (status, [])
        with pytest.raises(typer.Exit) as left:  # it came where nothing follows
            report_errors(run_into)(cause, contextlib.nullcontext())
        assert (left.value.exit_code, after.pop()) == (status, cause)
    whole = "interrupted at its end: what it writes is whole"
    assert capsys.readouterr().err == 2 * f"tribocosim: interrupted\ntribocosim: {whole}\n"


def test_what_is_compiled_before_a_stage_is_told_at_once(capsys):
    """And once within 20 s; in a stage its reporter tells it."""
    with tell_compilation():
        numba.njit(lambda x: x + 1.0)(1.0)
        numba.njit(lambda x: x + 2.0)(1.0)
        with Reporter(Console(quiet=True)).stage("a stage"):
            numba.njit(lambda x: x + 3.0)(1.0)
    assert capsys.readouterr().err.splitlines() == [COMPILES]
