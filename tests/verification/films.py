"""`tribocosim reproduce films`: the judgement of film formulas."""

from __future__ import annotations

import json
import re
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .shell import tribocosim
from .table import ROOT, Row

REPRODUCE = "orchestrator/test_reproduce_films.py::"
COMMAND = "tribocosim reproduce films"
PATIENCE = 3600.0  # s
# What the promise names, by the words of a statement's source.
NAMED = ("Kushwaha", "sign of the load changed", "Dowson and Higginson", "Dowson and Toyoda",
         "Pan and Hamrock", "Moes")  # fmt: skip


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        said = tribocosim("reproduce", "films", "--out", name, patience=PATIENCE)
        assert said.status == 0, said
        figures = sorted(file.name for file in folder.glob("figures/*.png"))
        statements = json.loads((folder / "statements.json").read_text("utf-8"))
        page = (folder / "films.md").read_text("utf-8")
    current = page == (ROOT / "docs" / "films.md").read_text("utf-8")
    yield _judged(statements, figures, page, current)
    yield from (_formula(s) for s in statements if _kind(s, "cycle-"))
    yield from (_formula(s) for s in statements if _kind(s, "table-3-"))
    yield from (_formula(s) for s in statements if _kind(s, "new-"))


def _kind(statement: dict[str, Any], prefix: str) -> bool:
    return str(statement["key"]).startswith(prefix)


def _judged(statements: list[dict[str, Any]], figures: list[str], page: str, current: bool) -> Row:
    speeds = re.findall(
        r"(\d+) r/min", next(line for line in page.splitlines() if line.startswith("|  | Film"))
    )
    missing = [name for name in NAMED if not any(name in s["place"] for s in statements)]
    short = f"no statement on {', '.join(missing)}. " if missing else ""
    return Row(
        "one figure and table of K's formula (both signs), Dowson-Higginson, Dowson-Toyoda, Pan-Hamrock, "
        "Moes and the numerical solution through the cycle at several speeds, with where each is outside its "
        "validity",
        f"{', '.join(speeds)} r/min; {', '.join(figures)}; {len(statements)} statements; docs/films.md is "
        f"{'what' if current else 'not what'} the command writes now",
        (
            REPRODUCE + "test_every_formula_is_judged",
            REPRODUCE + "test_every_figure_is_drawn",
            REPRODUCE + "test_squeeze_ranges_are_as_the_contact_reports_them",
        ),
        command=COMMAND,
        short=short
        + ("" if current else "docs/films.md is out of date (in the last digits if nothing else)."),
    )


def _formula(statement: dict[str, Any]) -> Row:
    """A verdict on a formula is the judgement that was promised, whatever it says."""
    promise = {
        "cycle-": "judged through the cycle",
        "table-3-": "K's Table 3 range compared with the numerical solution",
        "new-": "a new regression with its error stated",
    }
    words = next(text for prefix, text in promise.items() if _kind(statement, prefix))
    return Row(
        f"{words}: {statement['place']}, {statement['text']}",
        f"{statement['computed']}: {statement['verdict']}"
        + (f" ({statement['reason']})" if statement["reason"] else ""),
        command=COMMAND,
    )
