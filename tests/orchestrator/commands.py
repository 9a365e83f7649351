"""The command line in tests: in a process of its own, or called here."""

import contextlib
import os
import subprocess
import sys
from pathlib import Path

from typer.testing import CliRunner

from orchestrator.reporter import COMPILES
from tribocosim.command_line import app

ROOT = Path(__file__).parents[2]
# Changes of valve-train that need no FMU.
HERE = [
    f"components.{name}.participant=in-process"
    for name in ("flywheel", "camshaft", "valve_spring", "contact")
]
IN_PROCESS = [f"--set={change}" for change in HERE]
SHORT = ["--set=stop_time=2 ms", *IN_PROCESS]


def tribocosim(*arguments: str, cwd: Path = ROOT) -> subprocess.CompletedProcess[str]:
    """Run the command in a process of its own, as a user does."""
    environment = os.environ | {"PYTHONPATH": str(ROOT), "COLUMNS": "120"}
    code = "from tribocosim.command_line import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments],
        capture_output=True, text=True, cwd=cwd, env=environment, timeout=280,
    )  # fmt: skip
    assert "Traceback" not in done.stderr + done.stdout, done.stderr
    return done


def called(*arguments: str, cwd: Path = ROOT) -> subprocess.CompletedProcess[str]:
    """Run the command in this process: without waiting for imports, nor the word that it compiles, which it
    says where no other test has."""
    with contextlib.chdir(cwd):
        done = CliRunner().invoke(app, arguments, catch_exceptions=False)
    lines = done.stderr.splitlines(keepends=True)
    errors = "".join(line for line in lines if not line.startswith(COMPILES))
    return subprocess.CompletedProcess(arguments, done.exit_code, done.stdout, errors)


def said(done: subprocess.CompletedProcess[str]) -> str:
    """The one message on standard error."""
    lines = [line for line in done.stderr.splitlines() if line]
    assert len(lines) == 1, done.stderr
    return lines[0]
