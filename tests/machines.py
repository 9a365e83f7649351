"""Recorded numbers on other machines: the same tests with other linear algebra, code and threads.

`python -m tests --machines [--all] [WORD ...]` runs the tests that record numbers under each environment, one
factor changed at a time, prints for each number how much of its tolerance it spreads over, and puts what
spreads over more than a tenth on docs/validation.md. It fails where three spreads on the best environment's
number leave the tolerance: another machine could. As a pytest plugin it writes what a session recorded.
"""

import json
import math
import os
import subprocess
import tempfile
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from .validation import MACHINES, PAGE, Blocks, Record, escape, link, named_test, page_blocks, page_text

# Spreads that must fit between the best environment's number and the tolerance.
MARGIN = 3.0
# The page names what spreads over more of the tolerance.
NOTABLE = 0.1
# What each environment sets. Kernels for another processor are other files of the kernel cache.
ENVIRONMENTS = {
    "default": {},
    "two threads": {"OMP_NUM_THREADS": "2", "OPENBLAS_NUM_THREADS": "2"},
    "generic kernels": {"NUMBA_CPU_NAME": "generic"},
    "native kernels": {"NUMBA_CPU_NAME": "native"},
    "BLAS Nehalem": {"OPENBLAS_CORETYPE": "Nehalem"},
    "BLAS Haswell": {"OPENBLAS_CORETYPE": "Haswell"},
    "BLAS SkylakeX": {"OPENBLAS_CORETYPE": "SkylakeX"},
}
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
# What a processor must have, as Linux names it.
NEEDED = {"BLAS Haswell": "avx2", "BLAS SkylakeX": "avx512f"}


class Session(NamedTuple):
    """What the tests recorded, and those that failed."""

    records: list[Record]
    failed: list[str]


class Spread(NamedTuple):
    """Of one recorded number: shares of its tolerance, signed, at which environments differ most."""

    test: str
    cells: list[str]
    lowest: tuple[float, str]
    highest: tuple[float, str]

    @property
    def width(self) -> float:
        return self.highest[0] - self.lowest[0]

    @property
    def margin(self) -> float:
        """Spreads between the environment nearest the reference and the tolerance."""
        within = self.lowest[0] <= 0.0 <= self.highest[0]
        nearest = 0.0 if within else min(abs(self.lowest[0]), abs(self.highest[0]))
        return (1.0 - nearest) / self.width if self.width else math.inf


def find_spreads(sessions: Mapping[str, Sequence[Record]]) -> list[Spread]:
    """The spread of each number that every environment recorded, of its element with the least margin."""
    found: dict[tuple[str, int], dict[str, Record]] = defaultdict(dict)
    for name, records in sessions.items():
        for record in records:
            found[record[0], record[1]][name] = record
    return [
        _spread({name: record[3] for name, record in by_name.items()}, next(iter(by_name.values())))
        for _, by_name in sorted(found.items())
        if len(by_name) == len(sessions)
    ]


def _spread(shares: Mapping[str, Sequence[float]], record: Record) -> Spread:
    if len({len(elements) for elements in shares.values()}) > 1:  # as many as the solver's own steps
        shares = {name: [max(map(abs, elements))] for name, elements in shares.items()}
    rows = zip(*shares.values(), strict=True)
    spreads = []
    for row in rows:
        named = sorted(zip(row, shares, strict=True))
        spreads.append(Spread(record[0], record[4], named[0], named[-1]))
    return min(spreads, key=lambda spread: spread.margin)


def report(sessions: Mapping[str, Session]) -> bool:
    """Print every number's spread and what is found, least margin first; whether nothing is."""
    spreads = sorted(find_spreads({n: s.records for n, s in sessions.items()}), key=lambda s: s.margin)
    print("\nspread/tolerance  margin  quantity (test)")
    for spread in spreads:
        print(f"{spread.width:16.1e}  {spread.margin:6.3g}  {spread.cells[0]} ({spread.test})")
    found = [
        f"{spread.test}: {spread.cells[0]}: {spread.lowest[0]:.3g} ({spread.lowest[1]}) to "
        f"{spread.highest[0]:.3g} ({spread.highest[1]}) of the tolerance {spread.cells[4]}, margin "
        f"{spread.margin:.2g}, must be >= {MARGIN:g}"
        for spread in spreads
        if spread.margin < MARGIN
    ]
    found += [f"{test}: fails ({name})" for name, session in sessions.items() for test in session.failed]
    print(f"\n{len(spreads)} numbers, {len(sessions)} environments, {len(found)} findings", *found, sep="\n")
    write_page(spreads)
    return not found


def write_page(spreads: Sequence[Spread]) -> None:
    """Put what spreads notably on the validation page, in the place of older rows of the same tests."""
    ran = {named_test(spread.test) for spread in spreads}
    blocks: Blocks = defaultdict(list, page_blocks(PAGE.read_text("utf-8")))
    for test in ran:
        blocks.pop((MACHINES, test), None)
    for spread in sorted(spreads):
        if spread.width > NOTABLE:
            ends = [f"{share:.2g} ({name})" for share, name in (spread.lowest, spread.highest)]
            test = named_test(spread.test)
            cells = [spread.cells[0], f"{spread.width:.2g}", *ends, spread.cells[4], link(test)]
            blocks[MACHINES, test].append(f"| {' | '.join(map(escape, cells))} |")
    PAGE.write_text(page_text(blocks), "utf-8")


def environments() -> dict[str, dict[str, str]]:
    """The variables of each environment that this processor can be."""
    try:
        here = Path("/proc/cpuinfo").read_text("utf-8").split()
    except OSError:
        here = []
    return {
        name: {**ONE_THREAD, **variables}
        for name, variables in ENVIRONMENTS.items()
        if name not in NEEDED or NEEDED[name] in here
    }


def compare_machines(command: Sequence[str], root: Path) -> bool:
    """Run a command of pytest under each environment; whether nothing is found."""
    sessions = {}
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "session.json"
        for name, variables in environments().items():
            print(f"== {name}", flush=True)
            plugin = ["-p", "tests.machines", "--session-file", str(file)]
            kept = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
            subprocess.run([*command, *plugin], cwd=root, env=kept | variables, check=False)
            sessions[name] = Session(**json.loads(file.read_text("utf-8")))
    return report(sessions)


_session = Session([], [])


def pytest_addoption(parser: pytest.Parser) -> None:
    """Where the session's records go."""
    parser.addoption("--session-file")


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Keep what a test recorded, or that it failed. With pytest-xdist the workers' reports pass here too."""
    if report.failed:
        _session.failed.append(report.nodeid)
    elif report.when == "call":
        rows: list[Any] = [value for name, value in report.user_properties if name == "validation"]
        _session.records.extend((report.nodeid, place, *row) for place, row in enumerate(rows))


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Write the file in the process that has all reports."""
    if not hasattr(session.config, "workerinput"):
        file = session.config.getoption("--session-file")
        Path(file).write_text(json.dumps(_session._asdict()), "utf-8")
