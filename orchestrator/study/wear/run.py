"""`tribocosim wear`: the answer, its table, the worn lift and a figure in a folder."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import xarray

from models import plausible
from models.valve_train.worn_cam import find_most_depth

from ...analyses import Parameter
from ...analyses._evaluate import create_folder, find_results
from ...assessment.notices import list_notices
from ...errors import MistakeError, Option
from ...plots.style import save_figure
from ...plots.wear import draw_wear
from ...report.answer import Answer
from ...reporter import Reporter
from ...scenario.units import UnitError, is_bare, to_unit
from ..speeds.sweep import parse_speed
from .history import follow
from .report import FIGURE, LIFTS, PAGE, Interval, remark, tabulate, write
from .train import open_train

DEPTH = Parameter(0.127e-3, "m", "depth of wear", positive=True, plausible=plausible.CAM_LIFT)
# m2/N; a choice, see `docs/theory/contact.md`.
COEFFICIENT = "1e-18, 1e-16"
TOLERANCE = 0.01


@dataclass(frozen=True)
class Asked:
    """How deep (m), by which wear coefficients, and with which error of the depth as a part of it; of one of
    several contacts, at another speed (rad/s) than the scenario's."""

    until: float
    interval: Interval
    tolerance: float = TOLERANCE
    contact: str | None = None
    speed: float | None = None
    follower_wears: bool = False


def parse_asked(
    until: str, coefficient: str = COEFFICIENT, tolerance: float = TOLERANCE,
    contact: str | None = None, speed: str | None = None, follower_wears: bool = False,
) -> Asked:  # fmt: skip
    """Of texts as options have them; MistakeError that names the option."""
    if is_bare(until):
        raise MistakeError(
            (Option("until", until), ": has no unit"), ("write ", Option("until", f"{until} mm"))
        )
    try:
        depth = float(DEPTH.check_value("", until))
    except MistakeError as error:
        raise MistakeError((Option("until"), error)) from None
    if not 0.0 < tolerance <= 0.5:
        raise MistakeError((Option("tolerance", tolerance), ": must be > 0 and at most 0.5"))
    turned = None if speed is None else parse_speed("speed", speed)
    return Asked(depth, parse_interval(coefficient), tolerance, contact, turned, follower_wears)


def parse_interval(text: str) -> Interval:
    """One wear coefficient, or the least and the largest with a comma in between."""
    option = Option("wear_coefficient", text)
    try:
        ends = [to_unit(part, "m2/N") for part in text.split(",")]
    except UnitError as error:
        raise MistakeError((option, ": ", error)) from None
    if len(ends) > 2 or not 0.0 <= ends[0] <= ends[-1] or not ends[-1] > 0.0:
        raise MistakeError((option, ": must be one number, or the least and the largest, e.g. 1e-18,1e-16"))
    return Interval(ends[0], ends[-1])


def wear(
    tables: Mapping[str, Any], asked: Asked, out: Path, reporter: Reporter, overwrite: bool = False
) -> xarray.Dataset:
    """How long until the cam of a scenario has worn so deep: prints, writes into `out`, and returns the ages.

    What was simulated before an interruption is taken from `out`. MistakeError or ModelError before anything
    is written.
    """
    train = open_train(tables, asked.contact, asked.speed, asked.until, asked.follower_wears)
    most = find_most_depth(train.fresh.arc)
    if asked.until > most:
        raise MistakeError(
            f"until = {1e3 * asked.until:.3g} mm: a cam with a least radius of "
            f"{1e3 * train.fresh.arc.min():.3g} mm stands at most {1e3 * most:.2g} mm of wear",
            ("give ", Option("until", f"{0.99e3 * most:.2g} mm"), " or less"),
        )
    held = find_results(out, "wear", overwrite, LIFTS)
    reporter.notice(list_notices(train.scenario))
    with create_folder(out):
        history = follow(train, asked.tolerance, out, reporter)
        table = tabulate(history, asked.interval)
        for file in held:
            file.unlink()
        files = write(history, table, out)
        if len(history.ages) > 1:
            files.append(save_figure(lambda: draw_wear(table), out / FIGURE))
    answer = Answer(table.attrs["title"], reporter)
    answer.line(table.attrs["answer"])
    for text in remark(history, asked.interval, asked.tolerance):
        answer.line(text)
    answer.write(out, PAGE, [file.name for file in files])
    return table
