"""`tribocosim reproduce farahanchi1991`."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from .shell import tribocosim
from .table import ROOT, Row

REPRODUCE = "orchestrator/test_reproduce_farahanchi.py::"


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        tribocosim("reproduce", "farahanchi1991", "--out", folder)
        took = time.perf_counter() - began
        figures = len(list(Path(folder).glob("figures/*.png")))
        page = (Path(folder) / "farahanchi1991.md").read_text("utf-8")
    current = page == (ROOT / "docs" / "farahanchi1991.md").read_text("utf-8")
    line = next(text for text in page.splitlines() if " statements: " in text)
    engineer = page.partition("## What the sign error changes")[2].split("\n- ")
    yield Row(
        "makes every figure from 2.4 to 4.44",
        f"{figures} figures in {took:.0f} s",
        (
            REPRODUCE + "test_every_figure_from_2_4_to_4_44_is_there_once",
            REPRODUCE + "test_figures_show_the_cases_of_their_captions",
        ),
        command="tribocosim reproduce farahanchi1991",
    )
    yield Row(
        "the table of the thesis's statements with computed value and verdict, published beside corrected",
        f"{line} docs/farahanchi1991.md is {'what' if current else 'not what'} the command writes",
        (REPRODUCE + "test_verdicts_of_both_forms", REPRODUCE + "test_numbers_that_need_no_motion"),
        short="" if current else "docs/farahanchi1991.md is out of date.",
    )
    yield Row(
        "says what the sign error changes for an engineer",
        "; ".join(text.partition(":")[0].replace("**", "").replace("\n", " ") for text in engineer[1:3]),
        (REPRODUCE + "test_high_friction_with_the_right_sign_is_rest_on_the_upper_wall",),
    )
