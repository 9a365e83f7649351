"""Assess a run: its contacts and steps, and its errors against the monolithic reference."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from models.core.quantities import Vector
from models.core.system import System

from ..assessment.contacts import ContactSummaries, summarise_rows, with_angles
from ..assessment.diagnosis import Facts, diagnose_steps, read_written_steps, suggestions
from ..assessment.merits import Merit, describe_bearings, describe_trains, list_merits
from ..errors import RunError, Set, Words, join
from ..reporter import Reporter
from ..store.result_file import ResultFile
from .comparison import WitnessComparison, compare, compare_witness, largest_uncertainty, verdict
from .plan import MONOLITHIC, Plan, ReferencePlan
from .record import ENDS, NOT_COMPARED, OUTSIDE, WITHIN, Ending, Record, classify_ending
from .reference import Solution, solve_reference
from .summary import MACRO_STEPS, ROWS, Assessment

if TYPE_CHECKING:
    from models.monolithic import Reference

# Records compared with the reference (and drawn) at most: bounds memory, and is dense in any cycle.
COMPARED_RECORDS = 100_000
# Instants at most of which profiles across solved contacts are kept.
INSTANTS = 200


def assess(plan: Plan, record: Record, result: ResultFile, reporter: Reporter) -> Assessment:
    """Assess the run whose rows are in `result`; only a complete one is compared with the reference."""
    assessment = _diagnose(plan, record, result, _summarise_contacts(plan.system, record, result))
    if not record.ending.complete:
        return assessment
    assessed = _judge(plan, assessment, result, reporter)
    if not record.not_finite or assessed.ending.exit_status != WITHIN:
        return assessed
    name, since = next(iter(record.not_finite.items()))
    more = f" and {len(record.not_finite) - 1} more" if len(record.not_finite) > 1 else ""
    said = join(f"not finite: {name} from t = {since:.6g} s{more}; ", assessed.verdict)
    return replace(assessed, verdict=said, ending=replace(assessed.ending, exit_status=OUTSIDE))


def _judge(plan: Plan, assessment: Assessment, result: ResultFile, reporter: Reporter) -> Assessment:
    """Compare a complete run with its reference, if it has one."""
    if plan.reference is None:
        return replace(
            assessment,
            verdict="not compared: the reference is switched off (reference.enabled)",
            ending=Ending(True, False, "complete", WITHIN),
        )
    try:
        return _compare(plan, plan.reference, result, reporter, assessment)
    except ENDS as error:
        return replace(assessment, ending=classify_ending(error, result.path.parent))


def _summarise_contacts(system: System, record: Record, result: ResultFile) -> Assessment:
    """The contacts as observed, or else as recorded, with their angles; figures of merit of all parts."""
    contacts, source, figures = record.contacts, MACRO_STEPS, list[Merit]()
    if result.length("coupled") > 1:
        read = partial(result.read, "coupled", rows=slice(None))
        if not contacts and (found := summarise_rows(system, read)):
            contacts, source = found, ROWS
        contacts = with_angles(system, contacts, read)
        figures = list_merits(system, contacts, lambda name: read([name])[name])
    told = [*describe_trains(system, figures), *describe_bearings(system, figures)]
    return Assessment(record.ending, contacts, source, told, figures)


def _diagnose(plan: Plan, record: Record, result: ResultFile, assessment: Assessment) -> Assessment:
    """Add what limited the steps."""
    steps = read_written_steps(result)
    diagnosis = diagnose_steps(steps, record.do_steps)
    if not diagnosis:
        return assessment
    remedies = suggestions(Facts(diagnosis, steps, plan.scenario))
    return replace(assessment, steps=diagnosis, rejected_steps=diagnosis.rejected, suggestions=remedies)


def _compare(
    plan: Plan, wanted: ReferencePlan, result: ResultFile, reporter: Reporter, assessment: Assessment
) -> Assessment:
    """Solve the reference, add it to the result, and compare."""
    system = plan.system
    every = -(-result.length("coupled") // COMPARED_RECORDS)
    coupled = result.read("coupled", ["time", *system.outputs.names], slice(None, None, every))
    try:
        ends = read_written_steps(result).inner_ends
        solution = solve_reference(plan, wanted, ends, coupled.pop("time"), coupled, reporter)
    except RunError as failure:
        return replace(
            assessment,
            verdict=join("not compared: the reference failed: ", failure),
            ending=Ending(True, False, "complete", NOT_COMPARED),
        )
    quantities = plan.quantities
    result.write("reference", solution.times, quantities, solution.outputs)
    if solution.method == MONOLITHIC:
        result.attribute("reference", "tolerance", wanted.tolerance)
    if solution.reference is not None:
        _write_profiles(solution.reference, result)
    names = _select_compared(plan)
    errors = compare(
        solution.times,
        {name: coupled[name] for name in names},
        {name: solution.outputs[:, system.outputs.names.index(name)] for name in names},
        solution.uncertainty,
        {name: quantities[name].nominal for name in names},
        plan.tolerance,
        solution.orders,
    )
    for name, error in errors.items():
        result.attribute(f"reference/{name}", "uncertainty_rms", error.uncertainty.rms)
    within, text = verdict(errors)
    advice = "" if within else _advise_on_events(plan, assessment.contacts)
    witness = _hear_witness(plan, coupled, solution, reporter) if wanted.witness else None
    agreed = within and (witness is None or witness.agrees)
    return replace(
        assessment,
        ending=Ending(True, False, "complete", WITHIN if agreed else OUTSIDE),
        errors=errors,
        verdict=join(text, advice, witness.judge() if witness else "", solution.doubts),
        reference_time_s=solution.wall_time_s,
        reference_uncertainty=largest_uncertainty(errors),
        reference_method=solution.method,
        witness=witness,
    )


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
    if solution.reference is None:
        return None
    with reporter.stage("multibody witness"):
        return compare_witness(plan.system, solution.reference, coupled)


def _advise_on_events(plan: Plan, contacts: ContactSummaries) -> Words:
    """What helps where contacts are made and lost between steps of equal length; empty if none is."""
    opened = [name for name, contact in contacts.items() if contact.separation]
    if not plan.fixed_steps or not opened:
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
