"""Masters side by side on one scenario: the error of each against its work, over the macro step."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple, dataclass, fields
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter
from rich.table import Table

from models.compile.temporary import TemporaryFolder

from ..analyses._evaluate import create_folder, find_results
from ..assessment.notices import list_notices
from ..assessment.trains import check_lash
from ..engine.signals import DEGREES
from ..errors import MistakeError, RunError, in_command_line
from ..masters import MASTERS, find_master
from ..plots.style import create_subplots, save_figure
from ..report.answer import Answer
from ..reporter import Reporter, follow
from ..run.comparison import show_beside
from ..run.pipeline import run_part
from ..scenario import Scenario
from ..scenario.display import SYMBOLS
from ..scenario.fmu_limits import FmuLimits
from ..scenario.system import Builder, build_system
from ..scenario.units import choose_time_unit, format_time
from ..store.csv_file import write_rows

NAME = "masters"
# Macro steps, as multiples of the scenario's.
LONGER = (4.0, 2.0, 1.0)


@dataclass(frozen=True)
class Tried:
    """A run: `error` is the largest relative RMS error over its tolerance, `output` the one that has it.

    `steps` counts the steps that participants made, `signals` are the inputs over a step. NaN and a message
    where the run failed.
    """

    master: str
    macro_step: float
    error: float = math.nan
    output: str = ""
    steps: float = math.nan
    seconds: float = math.nan
    message: str = ""
    signals: str = ""


def compare_masters(
    vary: Callable[[Mapping[str, Any]], Scenario],
    own: Sequence[str],
    out: Path | None,
    overwrite: bool,
    build: Builder,
    reporter: Reporter,
) -> list[Tried]:
    """Run the scenario that `vary({})` gives with every master that its FMUs can take, and with `own` ones;
    `vary` also sets keys of it. Print the table, write it and a figure into `out`."""
    scenario = vary({})
    if not scenario.tolerance or not scenario.reference.enabled:
        raise MistakeError("tolerance: missing; state the error allowed of an output, with the reference")
    check_lash(build_system(scenario))
    reporter.notice(list_notices(scenario))
    restorable = FmuLimits(scenario).restorable
    names = [name for name in (*MASTERS, *own) if restorable or not find_master(name).implicit]
    longer = (1.0,) if scenario.step_control else LONGER
    folder = out or Path("results") / f"{scenario.name}-{NAME}"
    held = find_results(folder, NAME, overwrite)
    tried: list[Tried] = []
    with create_folder(folder):
        with reporter.stage("masters") as bar:
            for name in names:
                for factor in longer:
                    step = factor * scenario.macro_step
                    done = len(tried) / (len(names) * len(longer))
                    said = f", {name} at {format_time(step)}"
                    tried.append(_try(vary, name, step, build, follow(bar.show, said, done)))
        if all(one.message for one in tried):
            raise RunError(f"no master runs {scenario.name}; {tried[-1].master}: {tried[-1].message}")
        for file in held:
            file.unlink()
        heads = {"macro_step": "macro_step (s)", "error": "error/tolerance", "seconds": "wall time (s)"}
        head = [heads.get(field.name, field.name) for field in fields(Tried)]
        write_rows(folder / f"{NAME}.csv", [head, *map(astuple, tried)])
        save_figure(lambda: _draw(scenario, tried), folder / f"{NAME}.png")
    answer = Answer(f"{scenario.name}: masters", reporter)
    answer.table(_tabulate(scenario, tried))
    answer.line(judge(tried))
    answer.line(_list_untried(tried, FmuLimits(scenario).useful_degree))
    if left := [name for name in MASTERS if name not in names]:
        answer.line(f"left out: {', '.join(left)}, which repeat steps; an FMU cannot restore its state")
    answer.write(folder, f"{NAME}.html", (f"{NAME}.csv", f"{NAME}.png"))
    return tried


def _try(
    vary: Callable[[Mapping[str, Any]], Scenario], name: str, step: float, build: Builder, silent: Reporter
) -> Tried:
    try:
        one = vary({"master.name": name, "macro_step": step})
        signals = one.build_master().extrapolation
        with TemporaryFolder() as folder:
            summary = run_part(one, folder / "run", build, silent)
    except (MistakeError, RunError) as error:
        return Tried(name, step, message=in_command_line(error))
    shares = {
        key: (e.relative_rms + e.uncertainty.relative_rms) / e.tolerance
        for key, e in summary.errors.items() if e.tolerance
    }  # fmt: skip
    if not summary.complete or not shares:
        return Tried(name, step, message=in_command_line(summary.message), signals=signals)
    output = max(shares, key=shares.__getitem__)
    steps = math.nan if summary.do_steps is None else float(summary.do_steps)
    return Tried(name, step, shares[output], output, steps, summary.coupled_time_s, signals=signals)


def judge(tried: Sequence[Tried]) -> str:
    """The run within the tolerance with the fewest steps, or the one nearest to it, in a sentence."""
    ran = [one for one in tried if not one.message]
    within = [one for one in ran if one.error <= 1.0]
    best = min(within, key=lambda one: one.steps) if within else min(ran, key=lambda one: one.error)
    step = format_time(best.macro_step)
    keys = f"`--set master.name={best.master} --set macro_step='{step}'`"
    if not within:
        return (
            f"verdict: no master keeps the tolerance at these steps; {best.master} comes nearest, with "
            f"{best.error:.2g} of it in {best.output}: {keys}, with a shorter macro_step"
        )
    return (
        f"verdict: {best.master} at {step} keeps the tolerance ({best.error:.2g} of it) with "
        f"the fewest doSteps of these, {best.steps:.0f}: {keys}"
    )


def _list_untried(tried: Sequence[Tried], highest: int) -> str:
    """The signals of these runs, and how to compare others that the participants follow."""
    used = dict.fromkeys(one.signals for one in tried if one.signals)
    others = [name for name, degree in DEGREES.items() if degree <= highest and name not in used]
    said = f"signals tried: {', '.join(used)}"
    *more, best = others or [""]
    besides = f" (or {', '.join(more)})" * bool(more)
    return f"{said}; others may need less: `--set master.extrapolation={best}`{besides}" if best else said


def _tabulate(scenario: Scenario, tried: Sequence[Tried]) -> Table:
    title = f"{scenario.name}: error against work (doSteps: steps of all participants together)"
    table = Table(title=title, title_justify="left", box=None)
    words = ("master", "signals", "of")
    for head in (*words[:2], "macro step (s)", "error/tolerance", "of", "doSteps", "wall time (s)"):
        table.add_column(head, justify="left" if head in words else "right")
    for one in tried:
        found: tuple[str, ...] = ("failed", one.message[:60])
        if not one.message:
            found = show_beside(one.error, 1.0), one.output, f"{one.steps:.0f}", f"{one.seconds:.2g}"
        table.add_row(one.master, one.signals, f"{one.macro_step:g}", *found)
    return table


def _draw(scenario: Scenario, tried: Sequence[Tried]) -> Figure:
    title = f"{scenario.name}: error of each master against its work"
    figure, ((left, right),) = create_subplots(1, 2, title, (8.6, 3.6), sharey=True, squeeze=False)
    unit, factor = choose_time_unit(max(one.macro_step for one in tried))
    for axes in (left, right):
        axes.axhline(1.0, color="black", lw=0.8, label="tolerance")
    runs = dict.fromkeys((one.master, one.signals) for one in tried if one.error > 0.0)
    for i, (name, signals) in enumerate(runs):
        # Those that agree are seen in each other: larger marks below, open ones.
        size = 4 + 2 * (len(runs) - 1 - i)
        style = {"marker": "osD^v"[i % 5], "ls": "-" if i % 2 else "--", "ms": size, "mfc": "none"}
        points = [one for one in tried if (one.master, one.signals) == (name, signals) and one.error > 0.0]
        errors = [one.error for one in points]
        left.loglog([one.steps for one in points], errors, label=f"{name}, {signals}", **style)
        right.loglog([factor * one.macro_step for one in points], errors, **style)
    left.set_xlabel("doSteps of all participants")
    left.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    left.xaxis.set_major_formatter("{x:.0f}")
    right.set_xlabel(f"Macro step ({SYMBOLS.get(unit, unit)})")
    ticks = sorted({factor * one.macro_step for one in tried})
    right.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    left.set_ylabel("Largest error over tolerance")
    for axes in (left, right):
        axes.xaxis.set_minor_formatter(NullFormatter())
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure
