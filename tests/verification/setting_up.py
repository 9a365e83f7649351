"""The README's two commands."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator

from .table import ROOT, Row


def rows() -> Iterator[Row]:
    readme = (ROOT / "README.md").read_text("utf-8")
    commands = [
        line for block in re.findall(r"```sh\n(.+?)\n```", readme, re.DOTALL) for line in block.splitlines()
    ]
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    ci = (ROOT / ".ci" / "run").read_text("utf-8").splitlines()[-1]
    first = commands[0] if commands else "none"
    yield Row(
        "the README's first command sets everything up and runs the main job",
        f"`{first}`",
        command="tribocosim run valve-train",
        short="" if "run valve-train" in first else "the README's first command does not run `valve-train`.",
    )
    yield Row(
        "its second sets up what it needs and passes the tests; `.ci/run` calls exactly that",
        f"`.ci/run` ends with `{ci}`; in the README: {'the same line' if ci in commands else 'not found'}",
        ("test_readme.py::test_ci_runs_exactly_the_readmes_test_command",),
        short="" if ci in commands else "the README does not have the command of `.ci/run`.",
    )
    yield Row(
        "a fresh machine with Python 3.11 or newer, git and nothing else",
        f"requires Python {project['project']['requires-python']}; packages come from the package index",
        short="not tried by this script; Debian's and Ubuntu's Python also need the package python3-venv.",
    )
    yield Row(
        "distribution and command `tribocosim`; packages `models`, `fmus`, `orchestrator`",
        f"{project['project']['name']}; {', '.join(project['project']['scripts'])}; "
        f"{', '.join(project['tool']['hatch']['build']['targets']['wheel']['packages'])}",
    )
