"""The theory page's bounds are those of the validation manual's numbers."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[3] / "docs"
FILM = {
    "load": "contact.load",
    "drive torque": "camshaft.drive_torque",
    "guide moment": "guide moment",
    "lift": "valve_spring.position",
}


def read_manual() -> dict[str, float]:
    """Computed values by quantity."""
    rows = re.findall(
        r"^\| (.+?)(?: \(worst of .*\))? \| (\S+) \|", (DOCS / "validation.md").read_text("utf-8"), re.M
    )
    return {name: float(value) for name, value in rows if re.fullmatch(r"[-+.e\d]+", value)}


def name_rows(quantity: str) -> list[str]:
    """The manual's rows of a row of the page, column by column."""
    return [
        f"{quantity} on a rigid shaft, error over largest value",
        *(f"{quantity} on a flexible shaft at {speed} r/min, relative RMS" for speed in (600, 1000, 3000)),
        *(
            f"{quantity} on a {shaft} r/min against Exudyn, RMS error over largest"
            for shaft in ("rigid shaft at 1000", "flexible shaft at 1000", "flexible shaft at 3000")
        ),
        f"{FILM[quantity]}: reference against multibody, relative RMS",
        f"{FILM[quantity]}: coupled run against multibody, relative RMS",
    ]


@pytest.mark.parametrize("quantity", FILM)
def test_bounds_hold_and_are_close(quantity: str) -> None:
    page, manual = (DOCS / "theory" / "multibody.md").read_text("utf-8"), read_manual()
    row = re.search(rf"^\| {quantity} \|((?: \d+e-\d+ \|)+)$", page, re.MULTILINE)
    assert row
    bounds = [float(cell) for cell in row[1].strip(" |").split(" | ")]
    for name, bound in zip(name_rows(quantity), bounds, strict=True):
        assert 0.05 * bound < manual[name] <= bound, name
