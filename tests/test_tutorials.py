"""Tutorials with cells print what the comments behind their `print` say."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "docs" / "tutorials"
PAGES = [page for page in sorted(FOLDER.glob("*.md")) if "import tribocosim" in page.read_text("utf-8")]


def read_cells(page: Path) -> str:
    """All cells as one program."""
    return "\n".join(re.findall(r"^```python\n(.+?)^```", page.read_text("utf-8"), re.MULTILINE | re.DOTALL))


def list_expected(code: str) -> list[str]:
    """Comments behind a print, or below a loop of them."""
    return re.findall(r"^(?: *print\(.*\)  |)# (.+)$", code, re.MULTILINE)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_print_has_its_result(page: Path) -> None:
    code = read_cells(page)
    compile(code, page.name, "exec")
    loops = len(re.findall(r"^for .+:\n    print\(.*\)\n# ", code, re.MULTILINE))
    alone = re.findall(r"^(?:    )?print\(.*\)  # .+$", code, re.MULTILINE)
    assert len(re.findall(r"^ *print\(", code, re.MULTILINE)) == loops + len(alone) > 0


@pytest.mark.long
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_every_tutorial_prints_what_it_says(page: Path, tmp_path: Path) -> None:
    code = read_cells(page)
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True, text=True, timeout=1500,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-4000:]
    assert done.stdout.splitlines() == list_expected(code)
