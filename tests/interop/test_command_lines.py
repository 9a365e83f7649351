"""Command lines of other tools run our FMUs: the commands of the how-to as they stand there, with the
inputs in files, give the numbers of the component."""

import contextlib
import csv
import os
import shlex
import shutil
import signal
import subprocess
import sys
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import psutil
import pytest
from fmpy import read_model_description

from interop import processes
from interop.c_program import find_libpython
from interop.case import Case, list_equal_steps
from interop.comparison import KINDS, compute_expected, make_case
from interop.processes import ask
from tests.fmus.names import mark_long

NAME = "valve_spring"
DOCUMENTED = f"{NAME}-native.fmu"
STEP = 1e-5
PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "use-the-fmus.md"
COMMANDS = [line for line in PAGE.read_text("utf-8").splitlines() if "-native.fmu" in line]


def command(program: str, word: str) -> str:
    (found,) = (line for line in COMMANDS if line.startswith(f"{program} {word} "))
    return found


@pytest.fixture(params=mark_long(KINDS, ["native"]))
def kind(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def case(kind: str, tmp_path: Path) -> Case:
    """Of an FMU that is called in this folder as in the document."""
    fmu = shutil.copy(KINDS[kind].build(NAME), tmp_path / DOCUMENTED)
    return replace(make_case(NAME, KINDS[kind], Path(fmu)), step=STEP)


def run(line: str, folder: Path, **environment: str) -> str:
    """What the command prints."""
    path = os.pathsep.join([str(folder), str(Path(sys.executable).parent), os.environ["PATH"]])
    finished = subprocess.run(
        shlex.split(line),
        executable=shutil.which(line.split()[0], path=path),
        cwd=folder,
        env=os.environ | {"PATH": path} | environment,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert finished.returncode == 0, finished.stdout + finished.stderr
    return finished.stdout


def test_fmpy_validates(case: Case, tmp_path: Path) -> None:
    assert "No problems found" in run(command("fmpy", "validate"), tmp_path)


def test_fmpy_simulates(kind: str, case: Case, tmp_path: Path) -> None:
    """To the last bit: its files have all digits, and inputs at the times of steps are not interpolated."""
    rows = [[i * STEP, *row] for i, row in enumerate(case.table)]
    with (tmp_path / "inputs.csv").open("w", newline="") as file:
        csv.writer(file).writerows([["time", *case.inputs], *rows])
    run(command("fmpy", "simulate"), tmp_path)
    with (tmp_path / "outputs.csv").open() as file:
        found = [[float(row[name]) for name in case.outputs] for row in csv.DictReader(file)]
    steps = [(i * STEP, (i + 1) * STEP - i * STEP) for i in range(case.steps)]
    assert found[1:] == compute_expected(NAME, KINDS[kind], case, steps)


def test_ecos_simulates(kind: str, case: Case, tmp_path: Path) -> None:
    """To the six decimals of its files, but for the last step, which it leaves out where its sum of steps
    is beyond the stop time by rounding. What its package brings is not executable."""
    found = find_spec("ecospy")
    if found is None or not sys.platform.startswith("linux"):
        pytest.skip("needs Linux with ecospy")
    program = shutil.copy(Path(str(found.origin)).parent / "binaries" / "ecos", tmp_path)
    Path(program).chmod(0o755)
    if subprocess.run([program, "--version"], capture_output=True).returncode != 0:
        pytest.skip("ecos needs Debian's libtbb12")
    actions = "".join(
        f'<ecos:action t="{i * STEP!r}">'
        + "".join(
            f'<ecos:variable id="instance::{name}"><ecos:real value="{value!r}"/></ecos:variable>'
            for name, value in row.items()
        )
        + "</ecos:action>"
        for i, row in enumerate(case.rows())
    )
    text = f'<ecos:Scenario name="inputs" xmlns:ecos="ecos">{actions}</ecos:Scenario>'
    (tmp_path / "inputs.xml").write_text(text)
    named = "".join(f'<ecos:variable name="{name}"/>' for name in case.outputs)
    (tmp_path / "outputs.xml").write_text(
        '<ecos:CsvConfig xmlns:ecos="ecos"><ecos:components>'
        f'<ecos:component name="instance">{named}</ecos:component></ecos:components></ecos:CsvConfig>'
    )
    # It is no Python program.
    preload = {"LD_PRELOAD": str(find_libpython())} if case.python else {}
    run(command("ecos", "simulate"), tmp_path, **preload)
    (written,) = tmp_path.glob("*.csv")
    with written.open() as file:
        rows = list(csv.DictReader(file, skipinitialspace=True))
    outputs = [[float(row[f"instance::{name}[REAL]"]) for name in case.outputs] for row in rows]
    truth = compute_expected(NAME, KINDS[kind], case, list_equal_steps(case.steps, STEP))
    assert len(outputs) - 1 >= case.steps - 1
    np.testing.assert_allclose(outputs[1:], truth[: len(outputs) - 1], rtol=1e-15, atol=0.5001e-6)


@pytest.mark.long
@pytest.mark.parametrize("native", ["native", "native3"])
def test_fmutool_leaves_outputs_that_are_real(native: str, tmp_path: Path) -> None:
    """With the numbers of the component, for tools that read all outputs as Reals."""
    pytest.importorskip("fmu_manipulation_toolbox", reason="fmu-manipulation-toolbox is not installed")
    kind = KINDS[native]
    shutil.copy(kind.build("slider_crank"), tmp_path / "slider_crank-native.fmu")
    run(command("fmutool", "-input"), tmp_path)
    made = tmp_path / "slider_crank-reals.fmu"
    outputs = [v for v in read_model_description(str(made)).modelVariables if v.causality == "output"]
    assert {variable.type for variable in outputs} == {"Real" if kind.fmi == 2 else "Float64"}
    case = make_case("slider_crank", kind, made)
    truth = compute_expected("slider_crank", kind, case, list_equal_steps(case.steps, case.step))
    assert ask("fmpy", case).values == truth


@pytest.mark.skipif(os.name != "posix", reason="the tool is a script of a shell")
@pytest.mark.parametrize("interrupted", [False, True])
def test_a_tool_that_hangs_ends_with_what_it_has_started(interrupted, tmp_path, monkeypatch):
    """As a compiler, which would go on, also where Ctrl-C ends the wait: it is in another session."""

    def interrupt(*_):
        raise KeyboardInterrupt

    tool, mark = tmp_path / "tool", tmp_path / "mark"
    tool.write_text(f"#!/bin/sh\nsleep 600 &\necho $! > {mark}.new\nmv {mark}.new {mark}\nwait\n")
    tool.chmod(0o755)
    monkeypatch.setattr(processes, "TIME_LIMIT", 2.0)
    before = signal.signal(signal.SIGALRM, interrupt)
    signal.setitimer(signal.ITIMER_REAL, 1.0 if interrupted else 0.0)
    try:
        assert ask("wine", python=tool).failed == "no answer in 2 s"
        assert not interrupted
    except KeyboardInterrupt:
        assert interrupted
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    with contextlib.suppress(psutil.NoSuchProcess):
        psutil.Process(int(mark.read_text())).wait(10.0)  # its new parent has to notice
