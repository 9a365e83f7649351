"""Every answer to a frequent question has a command, or a cell of Python, that does what it says."""

import contextlib
import re
import shlex
from pathlib import Path

import pytest

from .orchestrator.commands import called

PAGE = (Path(__file__).parents[1] / "docs" / "faq.md").read_text("utf-8")
ANSWERS = dict(re.findall(r"^\*\*(.+?)\*\*(.+?)(?=^\*\*|^## |\Z)", PAGE, re.DOTALL | re.MULTILINE))
# Words of the questions whose answers take a second; others build FMUs, or run for longer.
FAST = ("couple two", "repeat a step", "late by one step", "write my own", "each time")
CASES = [
    pytest.param(answer, id=question, marks=[] if any(w in question for w in FAST) else pytest.mark.long)
    for question, answer in ANSWERS.items()
]


def test_questions_are_found() -> None:
    assert len(ANSWERS) == PAGE.count("\n**") >= 20
    assert sum(not case.marks for case in CASES) == len(FAST)


@pytest.mark.parametrize("answer", CASES)
def test_an_answer_does_what_it_says(answer: str, tmp_path: Path) -> None:
    blocks = re.findall(r"^```(sh|python)\n(.+?)^```", answer, re.DOTALL | re.MULTILINE)
    assert blocks
    for kind, block in blocks:
        if kind == "python":
            with contextlib.chdir(tmp_path):
                exec(compile(block, "faq.md", "exec"), {"__name__": "faq"})
            continue
        for line in block.splitlines():
            done = called(*shlex.split(line, comments=True)[1:], cwd=tmp_path)
            assert done.returncode == 0, f"{line}\n{done.stdout[-2000:]}{done.stderr}"
