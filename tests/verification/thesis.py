"""`tribocosim reproduce farahanchi1991`."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator
from pathlib import Path

from .shell import tribocosim
from .table import ROOT, Row

TESTS = "orchestrator/test_reproduce_farahanchi.py::"
COMMAND = "tribocosim reproduce farahanchi1991"


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as folder:
        done = tribocosim("reproduce", "farahanchi1991", "--out", folder)
        names = sorted(path.name for path in Path(folder).glob("figures/*.png"))
        statements = json.loads((Path(folder) / "statements.json").read_text("utf-8"))
        page = (Path(folder) / "farahanchi1991.md").read_text("utf-8")
    current = page == (ROOT / "docs" / "farahanchi1991.md").read_text("utf-8")
    line = next(text for text in reversed(done.output.splitlines()) if " statements: " in text)
    values = {statement["key"]: statement["values"] for statement in statements}
    yield Row(
        "makes every figure from 2.4 to 4.44, `as_published` beside `corrected`",
        f"{len(names)} figures, from {names[0]} to {names[-1]}",
        (f"{TESTS}test_every_figure_from_2_4_to_4_44_is_there_once", f"{TESTS}test_figures_are_drawn"),
        command=COMMAND,
    )
    yield Row(
        "makes the table of the thesis's statements with computed value and verdict in both forms",
        f"{line}; docs/farahanchi1991.md is {'' if current else 'not '}what the command writes now",
        (
            f"{TESTS}test_verdicts_of_both_forms",
            f"{TESTS}test_the_page_has_the_quick_statements_and_small_figures",
        ),
        command=COMMAND,
        short="" if current else "docs/farahanchi1991.md is out of date.",
    )
    threshold, figure = values["thresholds"], values["figure-2-4"]
    yield Row(
        "says what the sign error changes for an engineer",
        f"permanent sliding from λ = {threshold['threshold']:.5f} as published, "
        f"{threshold['corrected_threshold']:.5f} corrected; {figure['upper_changes']} and "
        f"{figure['corrected_upper_changes']} sign changes of the wall force per cycle at λ = 0.01",
        (
            f"{TESTS}test_the_force_is_zero_at_the_threshold_of_permanent_sliding_and_nowhere_negative",
            f"{TESTS}test_high_friction_with_the_right_sign_is_rest_on_the_upper_wall",
        ),
        command=COMMAND,
    )
