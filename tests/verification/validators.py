"""What the validators of FMUs find."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

from fmpy.validation import validate_fmu

from fmus.validate import validate


def found(files: Iterable[Path]) -> tuple[int, int]:
    """Problems that fmpy and `tribocosim fmu validate` tell, and complaints of fmutool."""
    tool, faults, complaints = Path(sys.executable).with_name("fmutool"), 0, 0
    for file in files:
        faults += len(validate_fmu(str(file))) + len(validate(file))
        command = [str(tool), "-input", str(file), "-check"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        said = done.stdout + done.stderr
        complaints += said.count("WARNING") + said.count("ERROR") + ("No semantic error" not in said)
    return faults, complaints
