"""Every check in order: lint, format, types, import rules, tests.

`python -m tests` runs the default part, `python -m tests --all` also the long physics checks.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
SCRIPTS = Path(sys.executable).parent

# A process for each processor, at most four for their memory (2 GB each). Each begins with a stretch of
# neighbouring tests, which share compiled kernels, and takes from another's end when it has none left.
PARALLEL = ["-n", "logical", "--maxprocesses", "4", "--dist", "worksteal"]


def checks(everything: bool) -> dict[str, list[str]]:
    """The command of each check."""
    python = [sys.executable, "-m"]
    return {
        "lint": [*python, "ruff", "check", "."],
        "format": [*python, "ruff", "format", "--check", "."],
        "types": [*python, "mypy"],
        "imports": [str(SCRIPTS / "lint-imports"), "--no-cache"],
        "tests": [*python, "pytest", "-q", "--durations=10", *PARALLEL, *(["-m", ""] if everything else [])],
    }


def main() -> int:
    """Run all checks, also after one failed; 0 only if all passed."""
    # Tests start hundreds of processes: each would compile all modules anew where bytecode is not kept.
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    failed = []
    for name, command in checks("--all" in sys.argv[1:]).items():
        print(f"== {name}", flush=True)
        if subprocess.run(command, cwd=ROOT, env=environment, check=False).returncode != 0:
            failed.append(name)
    print(f"failed: {', '.join(failed)}" if failed else "all checks passed", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
