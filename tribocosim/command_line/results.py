"""tribocosim report, diagnose and friction: what a run or sweep has left."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .error_report import report_errors
from .json_output import Json, build_reporter, print_json

if TYPE_CHECKING:
    from orchestrator.errors import Option
    from orchestrator.reporter import Reporter


@report_errors
def write_page(
    folder: Annotated[
        Path, typer.Argument(help="Output folder of a run or a speed sweep; with --cycle also a scenario.")
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            help="File of the page, or a folder for it.",
            show_default="report.html or cycle.html in FOLDER; of a scenario here",
        ),
    ] = None,
    cycle: Annotated[
        bool,
        typer.Option(
            "--cycle",
            help="Write cycle.html, which computes the train's steady cycle as sliders move (extra native).",
        ),
    ] = False,
) -> None:
    """Rewrite report.html, the page with the animated mechanism, plots and errors, and a run's figures.

    With --out it writes the page only. Exit status 3: a figure or the page failed.
    """
    from orchestrator.reporter import Reporter

    from ..cycle_page import draw_page

    reporter = Reporter()
    reporter.line(f"report in {draw_page(folder, out, cycle, reporter)}")


@report_errors
def print_diagnosis(
    folder: Annotated[
        Path,
        typer.Argument(help="Output folder of a run; or a scenario, by name or file, for its newest run."),
    ],
    figure: Annotated[Path | None, typer.Option(help="Draw the steps to this file (.png).")] = None,
    as_json: Json = False,
) -> None:
    """Report where the time of a run went, who limits its steps, and what to change."""
    from orchestrator.assessment.diagnosis.report import diagnose
    from orchestrator.errors import MistakeError, Option
    from orchestrator.plots.steps import draw_steps
    from orchestrator.plots.style import save_figure
    from orchestrator.store.output_folder import writing

    if figure and figure.suffix != ".png":
        raise MistakeError((Option("figure", figure), ": must end in .png"))
    reporter = build_reporter(as_json)
    found = diagnose(folder)
    if as_json:
        print_json(
            {
                "diagnosis": found.diagnosis,
                "effort": found.spending.effort,
                "stages": found.spending.stages,
                "suggestions": found.suggestions,
            }
        )
    for line in found.lines:
        reporter.line(line)
    if figure:
        with writing(figure, "figure"):
            save_figure(lambda: draw_steps(found.steps, found.scenario.name), figure)
        reporter.line(f"figure in {figure}")


# m2/N; a choice, see `docs/theory/contact.md`.
COEFFICIENT = 1e-17
# Of the cam.
CYCLES = 1e8
# Endings of the files.
TABLES, FIGURES = (".csv", ".nc"), (".png", ".svg", ".pdf")


@report_errors
def print_friction(
    folder: Annotated[Path, typer.Argument(help="Output folder of a valve-train run, or of `speeds`.")],
    contact: Annotated[str | None, typer.Option(help="Name of one contact.", show_default="all")] = None,
    wear_coefficient: Annotated[
        float | None,
        typer.Option(
            help="Wear volume over load times sliding distance, in m2/N.", show_default=f"{COEFFICIENT:g}"
        ),
    ] = None,
    cycles: Annotated[
        float | None,
        typer.Option(help="Revolutions over which the wear is extrapolated.", show_default=f"{CYCLES:g}"),
    ] = None,
    table: Annotated[
        Path | None, typer.Option(help="Write the revolution to this file (.csv or .nc).")
    ] = None,
    figure: Annotated[
        Path | None, typer.Option(help="Draw the revolution to this file (.png, .svg or .pdf).")
    ] = None,
    as_json: Json = False,
) -> None:
    """Report friction and wear of a valve train's contacts over the last cam revolution of a run.

    Of a sweep over speed, or of the designs in its folder, report the friction of the whole train by shares.
    """
    from orchestrator.assessment.friction.judge import (
        judge_friction,
        judge_losses,
        measure_others,
    )
    from orchestrator.assessment.friction.remarks import list_soft, remark_soft
    from orchestrator.assessment.friction.report import remarks, tables, tabulate, tabulate_others, write
    from orchestrator.assessment.friction.shares import remark_losses, tabulate_losses
    from orchestrator.errors import MistakeError, Option
    from orchestrator.plots.friction import draw_friction
    from orchestrator.plots.style import save_figure
    from orchestrator.store.output_folder import writing

    for option, path, endings in (("table", table, TABLES), ("figure", figure, FIGURES)):
        if path and path.suffix not in endings:
            raise MistakeError((Option(option, path), f": must end in {', '.join(endings)}"))
    reporter = build_reporter(as_json)
    of_contacts = {"contact": contact, "wear-coefficient": wear_coefficient, "cycles": cycles}
    given = [Option(name, value) for name, value in of_contacts.items() if value is not None]
    if _report_sweeps(folder, given, table, figure, reporter, as_json):
        return
    coefficient = COEFFICIENT if wear_coefficient is None else wear_coefficient
    turns = CYCLES if cycles is None else cycles
    scenario, found = judge_friction(folder, contact, coefficient, turns)
    losses, motion = judge_losses(folder, scenario)
    others = measure_others(motion, coefficient)
    if as_json:
        contacts = {
            one.cycle.contact: tabulate(one.cycle, one.worn, one.coefficient).to_dict() for one in found
        }
        print_json({**contacts, "others": others, "shares": losses.shares, "in_the_motion": losses.inside})
    for page in tables(found):
        reporter.console.print(page)
    for one in found:
        for line in remarks(one):
            reporter.line(line)
    if others:
        reporter.console.print(tabulate_others(others, turns))
    ratios = {one.cycle.contact: one.summary["least_film_ratio"] for one in found}
    ratios |= {name: numbers["least_film_ratio"] for name, numbers in others.items()}
    for line in remark_soft(list_soft(motion.system, ratios)):
        reporter.line(line)
    reporter.console.print(tabulate_losses(losses))
    for line in remark_losses(losses, motion):
        reporter.line(line)
    several = len(found) > 1
    for one in found:
        if table:
            file = name_file(table, one.cycle.contact, several)
            with writing(file, "table"):
                files = write(one.cycle, one.worn, one.coefficient, file)
            reporter.line(f"table in {', '.join(map(str, files))}")
        if figure:
            file = name_file(figure, one.cycle.contact, several)
            with writing(file, "figure"):
                save_figure(partial(draw_friction, one.cycle, one.worn, one.cycles, scenario.name), file)
            reporter.line(f"figure in {file}")


def _report_sweeps(
    folder: Path, of_contacts: Sequence[Option], table: Path | None, figure: Path | None, reporter: Reporter,
    as_json: bool,
) -> bool:  # fmt: skip
    """Whether the folder holds sweeps over speed; their friction by shares."""
    from orchestrator.errors import MistakeError, Option
    from orchestrator.store.output_folder import RESULT, writing

    if (folder / RESULT).exists() or not folder.is_dir():
        return False
    from orchestrator.assessment.friction.losses import describe_content
    from orchestrator.assessment.friction.remarks import remark_soft
    from orchestrator.study.speeds import friction

    if not (sweeps := friction.list_sweeps(folder)):
        return False
    if of_contacts:
        raise MistakeError(
            (of_contacts[0], f": has no effect on {folder}, a sweep over speed; leave it out, or name a run")
        )
    if table and table.suffix != TABLES[0]:
        raise MistakeError((Option("table", table), f": of a sweep must end in {TABLES[0]}"))
    sheets = [friction.read_sheet(sweep) for sweep in sweeps]
    if as_json:
        print_json(
            {
                one.design: {
                    "speed_rpm": one.speeds.tolist(),
                    "drive": one.drive.tolist(),
                    "outside": one.outside,
                }
                | {share: torque.tolist() for share, torque in one.torques.items()}
                for one in sheets
            }
        )
    reporter.console.print(friction.tabulate_sheets(sheets))
    for one in sheets:
        reporter.line(f"{one.design}: what the drive gives is {describe_content(one.outside)}")
        if one.unsteady.size:
            speeds = ", ".join(f"{speed:.0f}" for speed in one.unsteady)
            reporter.line(f"{one.design}: no steady cycle at {speeds} r/min; left out")
    for line in remark_soft(list(dict.fromkeys(name for one in sheets for name in one.soft))):
        reporter.line(line)
    if table:
        with writing(table, "table"):
            friction.write_sheets(sheets, table)
        reporter.line(f"table in {table}")
    if figure:
        from orchestrator.plots.style import save_figure

        with writing(figure, "figure"):
            save_figure(partial(friction.draw_shares, sheets, folder.resolve().name), figure)
        reporter.line(f"figure in {figure}")
    return True


def name_file(path: Path, contact: str, several: bool) -> Path:
    """The file's name, with the contact's where there are several."""
    return path.with_stem(f"{path.stem}-{contact}") if several else path
