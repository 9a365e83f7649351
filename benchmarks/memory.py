"""Peak memory of a run with a million macro steps, results streamed to disk, in a process of its own."""

from __future__ import annotations

import subprocess
import sys
import tempfile

CODE = """
import sys
from pathlib import Path
from orchestrator.command_line import main
arguments = ["run", "valve-train", "--out", sys.argv[1], "--no-figures", "--overwrite"]
for item in ("macro_step=1e-7", "output_step=1e-7", "stop_time=0.1", "reference.enabled=false"):
    arguments += ["--set", item]
sys.argv[1:] = arguments
try:
    main()
finally:
    # Not getrusage: its peak comes along from the process that started this one.
    peak = Path("/proc/self/status").read_text().split("VmHWM:")[1].split()[0]
    print("peak", int(peak) // 1024, "MB")
"""


def rows() -> list[tuple[str, str]]:
    """Figures for the report (Linux)."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [sys.executable, "-c", CODE, folder], capture_output=True, text=True, check=False
        )
    peak = [line for line in done.stdout.splitlines() if line.startswith("peak")]
    return [
        (
            "memory: 10^6 macro steps of valve-train, every one recorded",
            peak[0] if peak else done.stderr[-300:],
        )
    ]
