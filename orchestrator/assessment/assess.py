"""What a finished coupled run comes to, compared with the monolithic reference."""

from __future__ import annotations

from typing import TYPE_CHECKING

from models.core.quantities import Vector
from models.core.system import System

from ..run import assembly
from ..run.report import Reporter
from ..scenario import Scenario
from ..store.result_file import ResultFile
from .comparison import compare, largest_uncertainty, verdict
from .summary import NOT_COMPARED, OUTSIDE, WITHIN, Summary

if TYPE_CHECKING:
    from models.monolithic import Reference

# Records compared with the reference (and drawn) at most: bounds memory, and is dense in any cycle.
COMPARED_RECORDS = 100_000


def judge(
    scenario: Scenario, system: System, result: ResultFile, summary: Summary, reporter: Reporter
) -> None:
    """What the finished coupled run comes to."""
    if scenario.reference.enabled:
        _compared(scenario, system, result, summary, reporter)
    else:
        summary.verdict = "not compared: the reference is switched off (reference.enabled)"
        summary.exit_status = NOT_COMPARED
    summary.complete, summary.message, summary.resumable = True, "complete", False


def compared_every(result: ResultFile) -> int:
    """Records of the coupled run from one compared to the next."""
    return -(-result.length("coupled") // COMPARED_RECORDS)


def _compared(
    scenario: Scenario, system: System, result: ResultFile, summary: Summary, reporter: Reporter
) -> None:
    rows = slice(None, None, compared_every(result))
    names = assembly.compared(scenario, system)
    coupled = result.read("coupled", ["time", *names], rows)
    reference = _reference(scenario, system, coupled["time"], reporter)
    summary.reference_time_s = reference.wall_time_s
    quantities = assembly.output_quantities(system)
    result.write("reference", reference.times, quantities, reference.outputs)
    result.attribute("reference", "tolerance", scenario.reference.tolerance)
    del coupled["time"]
    columns = {name: reference.outputs[:, system.outputs.names.index(name)] for name in names}
    nominal = {name: quantities[name].nominal for name in names}
    summary.errors = compare(
        reference.times, coupled, columns, reference.uncertainty, nominal, scenario.tolerance
    )
    for name, error in summary.errors.items():
        result.attribute(f"reference/{name}", "uncertainty_rms", error.uncertainty.rms)
    summary.reference_uncertainty = largest_uncertainty(summary.errors)
    within, summary.verdict = verdict(summary.errors)
    summary.exit_status = WITHIN if within else OUTSIDE


def _reference(scenario: Scenario, system: System, times: Vector, reporter: Reporter) -> Reference:
    from models.monolithic import LONGEST_STEP, solve

    table = scenario.reference
    with reporter.stage("monolithic reference", scenario.stop_time) as bar:
        return solve(
            system,
            times,
            tolerance=table.tolerance,
            x0=system.x0,
            progress=bar.show,
            longest_step=table.step or LONGEST_STEP,
        )
