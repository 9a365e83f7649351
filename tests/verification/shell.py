"""The command line as a user meets it: what it says, and its exit status."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .table import ROOT

COMMAND = [sys.executable, "-c", "from orchestrator.command_line import main; main()"]


@dataclass(frozen=True)
class Said:
    """What a command came to. `message` is its standard error in one line, without names of folders."""

    status: int
    output: str
    message: str

    def __str__(self) -> str:
        return f"“{self.message}”, exit status {self.status}"


def tribocosim(*arguments: str, interrupt_after: str = "", patience: float = 300.0) -> Said:
    """Run the command in a process of its own, for `patience` (s) at most; with `interrupt_after`, Ctrl-C
    once a line begins so."""
    process = subprocess.Popen(
        [*COMMAND, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT
    )
    if interrupt_after:
        assert process.stdout
        for line in process.stdout:
            if line.startswith(interrupt_after):
                break
        time.sleep(2.0)
        process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=patience)
    assert "Traceback" not in output + errors, errors
    text = " / ".join(line.removeprefix("tribocosim: ") for line in errors.splitlines() if line)
    return Said(process.returncode, output, re.sub(r"(/[^/\s]+)+/", "", text))


def summary(folder: Path) -> dict[str, Any]:
    """summary.json of a run."""
    return json.loads((folder / "summary.json").read_text("utf-8"))
