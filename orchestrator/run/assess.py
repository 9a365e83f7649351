"""Assess a run: its contacts and steps, and its errors against the monolithic reference."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from models.core.difference import difference, time_weights
from models.core.quantities import Vector
from models.core.system import System

from ..assessment.contacts import ContactSummaries, summarise_rows, with_angles
from ..assessment.diagnosis import Facts, diagnose_steps, read_written_steps, suggestions
from ..assessment.frozen import list_frozen
from ..assessment.merits import Merit, describe, list_merits, read_motion, sum_friction
from ..assessment.trains import find_trains
from ..errors import RunError, Set, Words, join
from ..reporter import WITNESS, Reporter
from ..scenario.capabilities import MONOLITHIC
from ..scenario.values import WARNING
from ..store.result_file import ResultFile
from .comparison import (
    Errors,
    VariableError,
    WitnessComparison,
    advise,
    compare_witness,
    describe_largest,
    largest_uncertainty,
    verdict,
)
from .plan import Plan
from .reference import Solution, measure_orders, solve_reference
from .summary import ENDS, FAILED, INTERRUPTED, MACRO_STEPS, NOT_COMPARED, OUTSIDE, ROWS, WITHIN, Summary

if TYPE_CHECKING:
    from models.monolithic import Reference

# Records compared with the reference (and drawn) at most: bounds memory, and is dense in any cycle.
COMPARED_RECORDS = 100_000
# Instants at most of which profiles across solved contacts are kept.
INSTANTS = 200


def assess(plan: Plan, summary: Summary, result: ResultFile, reporter: Reporter) -> Summary:
    """Assess the run whose rows are in `result`; only a complete one is compared with the reference."""
    summary = _diagnose(plan, _summarise_contacts(plan.system, summary, result), result)
    if not summary.complete:
        return summary
    summary = replace(summary, frozen=list_frozen(plan.system, plan.third_party, result.column))
    judged = _judge(plan, summary, result, reporter)
    if find_trains(plan.system) and not read_motion(plan.system, result.column).turns:
        seen = "; the run is shorter than a revolution of its cam: no cycle was seen"
        judged = replace(judged, verdict=join(judged.verdict, seen))
    if not judged.senseless or judged.exit_status != WITHIN:
        return judged
    name, since = next(iter(judged.senseless.items()))
    more = f" and {len(judged.senseless) - 1} more" if len(judged.senseless) > 1 else ""
    what = "not finite, or above 1e30 times its nominal size"
    said = join(f"{what}: {name} from t = {since:.6g} s{more}; ", judged.verdict)
    return replace(judged, verdict=said, exit_status=OUTSIDE)


def _judge(plan: Plan, summary: Summary, result: ResultFile, reporter: Reporter) -> Summary:
    """Compare a complete run with its reference, if it has one."""
    if plan.reference is None:
        verdict = "not compared: the reference is switched off (reference.enabled)"
        return _conclude(summary, WITHIN, verdict)
    try:
        return _compare(plan, result, reporter, summary)
    except ENDS as error:
        ended = summary.end_by(error, result.path.parent)
        if ended.exit_status != INTERRUPTED:
            return ended
        lacks = "; the run itself is whole, and lacks the comparison with its reference"
        return replace(ended, message=join(ended.message, lacks))


def _conclude(summary: Summary, status: int, verdict: Words) -> Summary:
    return replace(summary, resumable=False, message="complete", exit_status=status, verdict=verdict)


def _summarise_contacts(system: System, summary: Summary, result: ResultFile) -> Summary:
    """The contacts as observed, or else as recorded, with their angles; figures of merit of all parts."""
    contacts, source, figures, told = summary.contacts, MACRO_STEPS, list[Merit](), list[str]()
    if result.length("coupled") > 1:
        if not contacts and (found := summarise_rows(system, result.column)):
            contacts, source = found, ROWS
        contacts = with_angles(system, contacts, result.column)
        figures = list_merits(system, contacts, result.column)
        told = describe(system, figures, result.column)
        if summary.exit_status == FAILED:  # coils may clash because the coupling is unstable
            told = [line for line in told if not line.startswith(WARNING)]
    return replace(
        summary, contacts=contacts, contacts_from=source, merits=told, figures_of_merit=figures,
        friction=sum_friction(system, figures),
    )  # fmt: skip


def _diagnose(plan: Plan, summary: Summary, result: ResultFile) -> Summary:
    """Add what limited the steps."""
    steps = read_written_steps(result)
    diagnosis = diagnose_steps(steps, summary.do_steps)
    if not diagnosis:
        return summary
    remedies = suggestions(Facts(diagnosis, steps, plan.scenario))
    return replace(summary, steps=diagnosis, rejected_steps=diagnosis.rejected, suggestions=remedies)


def _compare(plan: Plan, result: ResultFile, reporter: Reporter, summary: Summary) -> Summary:
    """Solve the reference, add it to the result, and compare."""
    system = plan.system
    every = -(-result.length("coupled") // COMPARED_RECORDS)
    coupled = result.read("coupled", ["time", *system.outputs.names], slice(None, None, every))
    try:
        ends = read_written_steps(result).inner_ends
        solution = solve_reference(plan, ends, coupled.pop("time"), coupled, reporter)
    except RunError as failure:
        return _conclude(summary, NOT_COMPARED, join("not compared: the reference failed: ", failure))
    result.write("reference", solution.times, plan.quantities, solution.outputs)
    if solution.method == MONOLITHIC:
        result.attribute("reference", "tolerance", plan.scenario.reference.tolerance)
    if solution.reference is not None:
        _write_profiles(solution.reference, result)
    errors = _find_errors(plan, _select_compared(plan), coupled, solution)
    for name, error in errors.items():
        result.attribute(f"reference/{name}", "uncertainty_rms", error.uncertainty.rms)
    within, text = verdict(errors)
    advice: Words = ""
    if not within and not (advice := _advise_on_events(plan, summary.contacts)):
        advice = _advise_on_steps(plan, errors, solution, ends, coupled, reporter)
    witness = _hear_witness(plan, coupled, solution, reporter)
    agreed = within and (witness is None or witness.agrees)
    moved = any(np.ptp(coupled[name]) > 0.0 for name in errors)
    still = "" if moved else "; but all compared variables are constant, which proves nothing"
    said = join(text, still, advice, witness.describe_agreement() if witness else "", solution.doubts)
    return replace(
        _conclude(summary, WITHIN if agreed else OUTSIDE, said),
        errors=errors,
        largest_error=describe_largest(errors),
        reference_time_s=solution.wall_time_s,
        reference_uncertainty=largest_uncertainty(errors),
        reference_method=solution.method,
        witness=witness,
    )


def _find_errors(plan: Plan, names: list[str], coupled: Mapping[str, Vector], solution: Solution) -> Errors:
    """The error of these variables, whose values are, like those of the solution, at its times.

    Records count by the time that they stand for.
    """
    weights = time_weights(solution.times)
    errors: Errors = {}
    for name in names:
        reference = solution.outputs[:, plan.system.outputs.names.index(name)]
        found = difference(coupled[name], reference, plan.quantities[name].nominal, weights)
        errors[name] = VariableError(
            max_abs=found.max_abs,
            rms=found.rms,
            relative_rms=found.relative_rms,
            uncertainty=solution.uncertainty[name],
            tolerance=plan.tolerance.get(name),
            order=solution.orders[name] if solution.orders else None,
        )
    return errors


def _write_profiles(reference: Reference, result: ResultFile) -> None:
    """Add pressure and film across the contacts that are solved for, as the reference has them."""
    system, rows = reference.system, slice(None, None, -(-len(reference.times) // INSTANTS))
    for name, instance in system.instances.items():
        if "grid_scale" not in instance.component.state:
            continue
        from models.contact.line.profile import read_profiles

        parameters, states = (
            system.p[system.parameters.of(name)],
            reference.state[rows, system.state.of(name)],
        )
        found = read_profiles(instance.component, parameters, states)
        variables = {
            "position": ("m", found.position),
            "pressure": ("Pa", found.pressure),
            "film": ("m", found.film),
        }
        result.write_profiles(name, reference.times[rows], variables)


def _hear_witness(
    plan: Plan, coupled: Mapping[str, Vector], solution: Solution, reporter: Reporter
) -> WitnessComparison | None:
    if solution.reference is None or plan.scenario.reference.witness == "none":
        return None
    with reporter.stage(WITNESS):
        return compare_witness(plan.system, solution.reference, coupled)


def _advise_on_steps(
    plan: Plan,
    errors: Errors,
    solution: Solution,
    ends: Vector,
    coupled: Mapping[str, Vector],
    reporter: Reporter,
) -> Words:
    """The likely cause of too large errors. That of FMUs' own solvers is looked for by another run."""
    large = {
        name: error for name, error in errors.items() if error.relative_rms > (error.tolerance or math.inf)
    }
    orders = solution.orders or {}
    if solution.solvers and large:
        try:
            orders = measure_orders(plan, ends, coupled, solution, large, reporter)
        except RunError as failure:
            return join("; the run with halved steps, which would show the cause, fails: ", failure)
    return advise(plan.scenario, large, orders, solution.solvers)


def _advise_on_events(plan: Plan, contacts: ContactSummaries) -> Words:
    """What helps where contacts are made and lost between steps of equal length; empty if none is."""
    opened = [name for name, contact in contacts.items() if contact.separation or contact.at_rest]
    if plan.scenario.step_control or not opened:
        return ""
    return (
        f"; {', '.join(opened)}: opens and closes between steps of equal length, step control locates "
        "these instants: ",
        Set("step_control.relative", 1e-7),
    )


def _select_compared(plan: Plan) -> list[str]:
    """All connected outputs, and those with a tolerance."""
    connected = {str(connection.source) for connection in plan.system.connections}
    return [name for name in plan.system.outputs.names if name in connected or name in plan.tolerance]
