"""Analyses of known outcome, which studies in the tests name as module:object."""

import os
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from orchestrator.analyses import Analysis, Parameter, Result

PARAMETERS = {
    "x": Parameter(0.0, "m", "abscissa", minimum=-10.0, maximum=10.0),
    "y": Parameter(1.0, "1", "factor"),
    "n": Parameter(1, "1", "count", minimum=1.0, integer=True),
    "mode": Parameter("plain", "1", "kind of sum", choices=("plain", "square")),
    "folder": Parameter("", "1", "where evaluations leave a trace"),
}
RESULTS = {"sum": Result("m", "x + y"), "sign": Result("1", "its sign", text=True)}


def _sum(values: Mapping[str, Any]) -> dict[str, float | str]:
    found = values["x"] + values["y"] if values["mode"] == "plain" else (values["x"] + values["y"]) ** 2
    return {"sum": found, "sign": "+" if found >= 0.0 else "-"}


def _picky(values: Mapping[str, Any]) -> dict[str, float | str]:
    if values["x"] < 0.0:
        raise ArithmeticError(f"no root of x = {values['x']:g}")
    return _sum(values)


def _slow(values: Mapping[str, Any]) -> dict[str, float | str]:
    """Late; from x = 6 on not before the file $STUDY_WAITS_FOR is there."""
    time.sleep(0.1)
    while values["x"] >= 6.0 and not Path(os.environ.get("STUDY_WAITS_FOR", "/")).exists():
        time.sleep(0.02)
    return _traced(values)


def _traced(values: Mapping[str, Any]) -> dict[str, float | str]:
    """Says how often a point was evaluated."""
    with (Path(values["folder"]) / f"{values['x']:g}_{values['y']:g}").open("a") as file:
        file.write("evaluated\n")
    return _picky(values)


def _lethal(values: Mapping[str, Any]) -> dict[str, float | str]:
    """Ends its process at (2, 1) always, at (3, 1) the first time."""
    mark = Path(values["folder"]) / "died"
    place = (values["x"], values["y"])
    if place == (2.0, 1.0) or (place == (3.0, 1.0) and not mark.exists()):
        mark.touch()
        os._exit(9)
    return _sum(values)


PLAIN = Analysis("plain", "x + y", PARAMETERS, RESULTS, _sum)
PICKY = Analysis("picky", "x + y for x >= 0", PARAMETERS, RESULTS, _picky)
SLOW = Analysis("slow", "x + y, late, for x >= 0", PARAMETERS, RESULTS, _slow)
LETHAL = Analysis("lethal", "x + y where the process lives", PARAMETERS, RESULTS, _lethal)
