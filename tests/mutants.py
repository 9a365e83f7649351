"""`python -m tests --mutants [WORD ...]`: deliberate errors of physics, each caught by a test by default.

The table of errors is mutants.toml. Each is made in a copy of the tree, and the test that is named for it
must fail; with `--default` all tests of the default part run, and those that fail are listed.
"""

import itertools
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
TABLE = Path(__file__).with_name("mutants.toml")
# What says where the copy's modules come from.
PACKAGES = ("models", "fmus", "orchestrator", "tribocosim", "reproduction", "tests")
ORIGINS = f"import {', '.join(PACKAGES)}; print(*(m.__file__ for m in ({', '.join(PACKAGES)})), sep='\\n')"
PYTEST = ("-m", "pytest", "-q", "-p", "no:cacheprovider", "--tb=no", "-rfE")
RESULT = re.compile(r"^(?:FAILED|ERROR) ([^\s\[]+)", re.MULTILINE)


@dataclass(frozen=True)
class Mutant:
    """An error: `old`, which stands once in the file, becomes `new`; `caught_by` is the test that sees it."""

    name: str
    file: str
    old: str
    new: str
    caught_by: str

    def fault(self, root: Path) -> str:
        """Why it cannot be made; empty if it can."""
        found = (root / self.file).read_text("utf-8").count(self.old)
        if found != 1:
            return f"{self.name}: {self.old!r} stands {found} times in {self.file}: must stand once"
        file, _, test = self.caught_by.partition("::")
        text = (root / "tests" / file).read_text("utf-8") if (root / "tests" / file).is_file() else ""
        if f"def {test.partition('[')[0]}(" not in text:
            return f"{self.name}: caught_by = {self.caught_by!r}: there is no such test"
        return ""


def mutants() -> list[Mutant]:
    """The table."""
    return [Mutant(name, **row) for name, row in tomllib.loads(TABLE.read_text("utf-8")).items()]


class Copy:
    """A copy of the tree whose modules are imported in place of those installed."""

    def __init__(self, folder: Path) -> None:
        self.root = folder / "tree"
        hidden = shutil.ignore_patterns(".git", ".venv", "__pycache__", "results", "build", "dist")
        shutil.copytree(ROOT, self.root, ignore=hidden)
        self._environment = {**os.environ, "PYTHONPATH": str(self.root)}
        self._clock = itertools.count(int(time.time()))
        for origin in self._python("-c", ORIGINS).stdout.split():
            if not Path(origin).is_relative_to(self.root):
                raise SystemExit(f"{origin} is imported, not the copy in {self.root}")

    def _python(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, *arguments], cwd=self.root, env=self._environment, check=False, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        )  # fmt: skip

    def failures(self, *tests: str) -> list[str]:
        """Those of these tests that fail, or of the default part."""
        done = self._python(*PYTEST, *(f"tests/{test}" for test in tests))
        found = list(dict.fromkeys(RESULT.findall(done.stdout)))
        if done.returncode != 0 and not found:
            raise SystemExit(f"the tests did not run:\n{done.stdout}")
        return found

    def catches(self, mutant: Mutant, whole: bool) -> list[str]:
        """The tests that fail with this error in the tree."""
        file = self.root / mutant.file
        right = file.read_text("utf-8")
        self._write(file, right.replace(mutant.old, mutant.new))
        try:
            return self.failures(*(() if whole else (mutant.caught_by,)))
        finally:
            self._write(file, right)

    def _write(self, file: Path, text: str) -> None:
        """At a second of its own: bytecode of a file of that size and second would be taken for its own."""
        file.write_text(text, "utf-8")
        second = next(self._clock)
        os.utime(file, (second, second))


def main(words: list[str]) -> int:
    """Makes the errors whose name, file or test has one of the words, or all; 1 if one survives."""
    whole, words = "--default" in words, [word for word in words if word != "--default"]
    wanted = [
        m for m in mutants() if not words or any(w in f"{m.name} {m.file} {m.caught_by}" for w in words)
    ]
    faults = [fault for m in wanted if (fault := m.fault(ROOT))]
    if faults or not wanted:
        print("\n".join(faults or ["no error has such a word"]))
        return 1
    with tempfile.TemporaryDirectory(prefix="mutants_") as folder:
        copy = Copy(Path(folder))
        if failed := copy.failures(*sorted({m.caught_by for m in wanted})):
            print("fail without any error:", *failed, sep="\n")
            return 1
        survivors = 0
        for m in wanted:
            caught = copy.catches(m, whole)
            survivors += not caught
            print(f"{m.name}: {', '.join(caught) if caught else 'SURVIVES'}", flush=True)
    print(f"{len(wanted) - survivors} of {len(wanted)} errors were caught")
    return 1 if survivors else 0
