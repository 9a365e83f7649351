"""Warnings about scenarios that run, but probably not as intended."""

import math

from models.core import roles

from ..participants.third_party import ThirdPartyComponent
from . import Scenario
from .capabilities import WHOLE_STEPS, list_file_warnings
from .checks import list_doubtful
from .fmu_limits import list_limit_warnings
from .oil_notices import doubt_oils, list_oils
from .third_party_values import list_bare_numbers

# A stop time (s) as long as this, in so many macro steps, is doubted.
LONG, MANY_STEPS = 10.0, 1_000_000
# Equal macro steps that a coupling needs for anything to come of it.
FEW_STEPS = 10


def list_notices(scenario: Scenario) -> list[str]:
    """What each oil has at its temperature, and all warnings, a line each."""
    return [*list_oils(scenario), *list_warnings(scenario)]


def list_warnings(scenario: Scenario) -> list[str]:
    """All warnings, a line each."""
    found = []
    if scenario.step_control and scenario.output_step is not None:
        found.append(
            f"output_step = {scenario.output_step:g} s: has no effect: [step_control] records every "
            "step; leave it out"
        )
    elif scenario.output_step is not None:
        found += _check_records(scenario, scenario.output_step)
    return [
        *scenario.notes,
        *found,
        *_doubt_times(scenario),
        *list_doubtful(scenario),
        *_list_notes(scenario),
        *doubt_oils(scenario),
        *_list_unloaded(scenario),
        *_list_other_units(scenario),
        *list_file_warnings(scenario),
        *list_limit_warnings(scenario),
    ]


def _doubt_times(scenario: Scenario) -> list[str]:
    """Warn of a time that may have been meant in ms, and of a run in a few steps."""
    stop, step = scenario.stop_time, scenario.macro_step
    if scenario.connections and not scenario.step_control and stop / step < FEW_STEPS:
        made = math.ceil(stop / step - WHOLE_STEPS)
        return [
            f"macro_step = {step:g} s: the run to stop_time = {stop:g} s makes {made} "
            f"step{'s' * (made > 1)}, and values are exchanged only between steps; take "
            f"{stop / 100.0:.2g} s or less"
        ]
    if scenario.step_control or stop < LONG or stop / step < MANY_STEPS:
        return []
    return [
        f"stop_time = {stop:g} s: {stop / step:,.0f} macro steps of {step:g} s; if {stop:g} ms were meant, "
        f"write '{stop:g} ms'"
    ]


def _list_notes(scenario: Scenario) -> list[str]:
    """What was chosen and doubted in reading files."""
    return [
        f"components.{name}: {note}" for name, table in scenario.components.items() for note in table.notes
    ]


def _list_other_units(scenario: Scenario) -> list[str]:
    """Warn of numbers without a unit in units other than SI."""
    found = []
    for name, table in scenario.components.items():
        component = table.resolve()
        if isinstance(component, ThirdPartyComponent):
            found += [f"components.{name}.{value}" for value in list_bare_numbers(component, table.values)]
    if not found:
        return []
    return [f"{', '.join(found)}: numbers without a unit are in the FMU's unit, which is not SI"]


def _check_records(scenario: Scenario, asked: float) -> list[str]:
    """Warn of records at other times than asked for."""
    step, every = scenario.macro_step, scenario.record_every
    made = every * step
    if abs(made - asked) <= 1e-9 * asked:
        return []
    used = f"the interval is {made:.6g} s, {every} macro step{'s' * (every > 1)}"
    if asked < step:
        why = f"is shorter than macro_step = {step:g} s; {used}"
    elif every < round(asked / step):
        why = (
            f"is too long for the comparison with the reference, which needs a hundredth of stop_time; "
            f"{used} (reference.enabled = false keeps it)"
        )
    else:
        why = f"is no multiple of macro_step = {step:g} s; {used}"
    return [f"output_step = {asked:g} s: {why}"]


def _list_unloaded(scenario: Scenario) -> list[str]:
    """Warn of contacts whose load is an unconnected input."""
    driven = {line.target for line in scenario.lines}
    return [
        f"components.{name}.parameters.load_is_given = true: nothing drives {name}.applied_load, so the "
        f"contact has no load; connect it, or give components.{name}.inputs.applied_load"
        for name, table in scenario.components.items()
        if table.resolve().has_role(roles.Contact)
        and table.parameters.get("load_is_given")
        and f"{name}.applied_load" not in driven
        and not table.inputs.get("applied_load")
    ]
