"""What is said of a scenario before it runs: its oils, and what is probably not as intended."""

import math
from collections.abc import Iterator

from models.contact.oil_grades import describe_grade
from models.contact.oils import evaluate_oil
from models.core import roles

from ..participants.third_party import ThirdPartyComponent
from . import ComponentTable, Scenario
from .capabilities import WHOLE_STEPS, list_file_warnings
from .checks import list_doubtful
from .display import say, show
from .fmu_limits import list_limit_warnings
from .oil import OILED, OilSheet, evaluate, in_celsius, name_oil, read_oil
from .revolutions import find_speed
from .units import to_base_units
from .values import WARNING, WithUnit, find_idle, to_value

# A stop time (s) as long as this, in so many macro steps, is doubted.
LONG, MANY_STEPS = 10.0, 1_000_000
# Equal macro steps that a coupling needs for anything to come of it.
FEW_STEPS = 10
# Numbers of an oil that parts state, with their units.
STATED = {"viscosity": "Pa.s", "pressure_viscosity": "1/Pa"}
# Of a scenario's parts with the same oil, so many are named in a line.
NAMED = 3


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
        *_list_still(scenario),
        *_list_idle(scenario),
        *_doubt_lashes(scenario),
        *_list_notes(scenario),
        *doubt_oils(scenario),
        *_list_unloaded(scenario),
        *_list_loose(scenario),
        *_list_other_units(scenario),
        *list_file_warnings(scenario),
        *list_limit_warnings(scenario),
    ]


def describe_turns(scenario: Scenario) -> list[str]:
    """How far a drive of constant speed turns in the run; none without one."""
    try:
        speed = find_speed(scenario.model_dump(include={"components"}))
    except ArithmeticError:
        return []
    turns, rpm = speed * scenario.stop_time / (2.0 * math.pi), speed * 30.0 / math.pi
    return [
        f"the drive makes {turns:.4g} revolutions at {rpm:.6g} r/min: stop_time = {scenario.stop_time:g} s"
    ]


def list_inherited(scenario: Scenario) -> Iterator[str]:
    """Constant inputs, other than zero, that only the files have that the scenario's extends."""
    if not (origin := scenario.origin):
        return
    for name, table in scenario.components.items():
        for variable, value in table.inputs.items():
            path, stem = f"components.{name}.inputs.{variable}", variable.partition("[")[0]
            known = not origin.inherited.isdisjoint((f"{name}.{variable}", f"{name}.{stem}"))
            if not known or not value or isinstance(value, str) or path.startswith(tuple(origin.changed)):
                continue
            quantity = table.resolve().inputs.field(variable).quantity
            yield (
                f"{path} = {say(float(value), show(quantity))} ({quantity.description}): is of the scenario "
                "that this one extends; give it here to change it, 0 for none"
            )


def longest_sensible_step(scenario: Scenario) -> float:
    """A hundredth of a run that makes a few macro steps only, and exchanges values between them; any else."""
    few = scenario.connections and scenario.stop_time / scenario.macro_step < FEW_STEPS
    return scenario.stop_time / 100.0 if few and not scenario.step_control else math.inf


def _doubt_times(scenario: Scenario) -> list[str]:
    """Warn of a time that may have been meant in ms, and of a run in a few steps."""
    stop, step = scenario.stop_time, scenario.macro_step
    if step > longest_sensible_step(scenario):
        made = math.ceil(stop / step - WHOLE_STEPS)
        return [
            f"macro_step = {step:g} s: the run to stop_time = {stop:g} s makes {made} "
            f"step{'s' * (made > 1)}, and values are exchanged only between steps; take "
            f"{longest_sensible_step(scenario):.2g} s or less"
        ]
    if scenario.step_control or stop < LONG or stop / step < MANY_STEPS:
        return []
    return [
        f"stop_time = {stop:g} s: {stop / step:,.0f} macro steps of {step:g} s; if {stop:g} ms were meant, "
        f"write '{stop:g} ms'"
    ]


def _list_still(scenario: Scenario) -> list[str]:
    """Warn of drives that are prescribed to stand still."""
    return [
        f"components.{name}.parameters.initial_speed = 0 rpm: the shaft stands still for the whole run; give "
        "a speed, such as '1000 rpm', or a final_speed"
        for name, table in scenario.components.items()
        if table.resolve().has_role(roles.Drive)
        and table.parameters.get("motion", "prescribed") == "prescribed"
        and table.parameters.get("initial_speed") == table.parameters.get("final_speed") == 0.0
    ]


def _list_idle(scenario: Scenario) -> Iterator[str]:
    """Warn of parameters that differ from their defaults and have no effect beside the others."""
    for name, table in scenario.components.items():
        component, given = table.resolve(), table.parameters
        stated = [evaluate(name_oil(one.oil, one.temperature))[1] for one in (scenario, table) if one.oil]
        for parameter, rule in find_idle(component, given, "parameters").items():
            field, value = component.parameters.field(parameter), given.get(parameter)
            default = to_value(field.quantity, field.start)
            known = [default, given.get(field.quantity.same_as), *(oil.get(parameter) for oil in stated)]
            if value is None or value in known:
                continue
            kinds = [component.parameters.field(one).quantity.boolean for one in rule.parameters]
            wanted = " or ".join(map(str, rule.choices)).lower() or ("true" if all(kinds) else "not zero")
            yield (
                f"components.{name}.parameters.{parameter}: has an effect only where "
                f"{' or '.join(rule.parameters)} is {wanted}; "
                + (f"give components.{name}.{rule.instead}" if rule.instead else "leave it out")
            )


def _doubt_lashes(scenario: Scenario) -> Iterator[str]:
    """Doubt valves that their lash keeps open, and springs that it compresses."""
    parts = {name: table.resolve() for name, table in scenario.components.items()}
    springs = {f"{name}.position" for name, part in parts.items() if part.has_role(roles.CoilSpring)}
    for name, table in scenario.components.items():
        lash = float(table.parameters.get("lash", 0.0)) if parts[name].has_role(roles.Valve) else 0.0
        given = f"components.{name}.parameters.lash = {1e3 * lash:.6g} mm"
        if lash < 0.0:
            held = f"{-1e3 * lash:.6g} mm"
            yield f"{given}: the cam holds the valve open by {held} on its base circle; is it meant?"
        for line in scenario.lines if lash else ():
            if line.source == f"{name}.position" and line.target in springs and line.offset is None:
                spring = line.target.partition(".")[0]
                said = f"the closed valve compresses {spring} by it, beyond the preload"
                yield f"{given}: {said}; connect {name}.valve_lift -> {line.target}"


def _list_notes(scenario: Scenario) -> list[str]:
    """What was chosen and doubted in reading files."""
    return [
        f"{WARNING * note.startswith(WARNING)}components.{name}: {note.removeprefix(WARNING)}"
        for name, table in scenario.components.items()
        for note in table.notes
    ]


def _list_other_units(scenario: Scenario) -> list[str]:
    """Warn of numbers without a unit in units other than SI, as they are understood:
    "start.x = 0.002 mm"."""
    found = [text for name, table in scenario.components.items() for text in _list_bare_numbers(name, table)]
    if not found:
        return []
    return [f"{', '.join(found)}: numbers without a unit are in the FMU's unit, which is not SI"]


def _list_bare_numbers(component: str, table: ComponentTable) -> Iterator[str]:
    resolved = table.resolve()
    if not isinstance(resolved, ThirdPartyComponent):
        return
    about = resolved.about
    for key, values in table.values.items():
        for name, value in values.items():
            variable = about.variables.get(name)
            if isinstance(value, str | WithUnit) or not (variable and variable.unit and variable.numeric):
                continue
            unit = about.units.get(variable.unit) or to_base_units(variable.unit)
            shifted = unit is not None and unit.offset != 0.0 and not variable.relative
            if unit is not None and (shifted or (unit.factor != 1.0 and value != 0.0)):
                yield f"components.{component}.{key}.{name} = {value:g} {variable.unit}"


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


def _list_loose(scenario: Scenario) -> Iterator[str]:
    """Doubt parts that are not coupled as parts of a coupled system are: without a connection, driven by
    nothing, of no effect, or with the velocity of a body whose position stays."""
    sources, targets = ({getattr(line, end) for line in scenario.lines} for end in ("source", "target"))
    for name, table in scenario.components.items() if scenario.lines else ():
        component, place = table.resolve(), f"components.{name}"
        used = any(f"{name}.{one}" in sources | scenario.tolerance.keys() for one in component.outputs.names)
        free = [one for one in component.inputs.names if f"{name}.{one}" not in targets]
        driven = len(free) < component.inputs.size
        gives, kind = component.outputs.size > 0, WARNING
        if isinstance(component, ThirdPartyComponent):  # the last of a chain gives the result
            gives, kind = any(component.about.list_variables("output")), ""
        if not used and not driven:
            yield f"{WARNING}{place}: has no connection, and no effect; connect it, or leave it out"
        elif not used and gives and not component.roles:
            yield (
                f"{kind}{place}: drives nothing: no output is connected or has a "
                f"tolerance; connect one of {_name_parts(list(component.outputs.names))}"
            )
        elif free and not (driven or table.inputs or component.has_role(roles.Drive)):
            yield (
                f"{WARNING}{place}: nothing drives it: no input is connected or given; connect "
                f"{_name_parts(free)}, or give it in {place}.inputs"
            )
        for one in free if driven else ():
            field, stem = component.inputs.field(one), one.rpartition("_")[0]
            rates = [
                rate.name
                for rate in component.inputs.fields
                if rate.quantity.unit == f"{field.quantity.unit}/s"
                and rate.name.rpartition("_")[0] == stem
                and rate.name not in free
            ]
            if rates and one not in table.inputs:
                yield (
                    f"{WARNING}{place}.inputs.{one}: not connected, stays {field.start:g} "
                    f"{field.quantity.unit}, though {rates[0]} is connected; connect it, or give it"
                )


def list_oils(scenario: Scenario) -> list[str]:
    """What each oil of a scenario has at its temperature, a line each."""
    lines: dict[str, list[str]] = {}
    for name, table in _list_oiled(scenario).items():
        if (own := table if table.oil is not None else scenario).oil is not None:
            lines.setdefault(_describe(own.oil, own.temperature or 0.0), []).append(name)
    return [f"{_name_parts(names)}: {text}" for text, names in lines.items()]


def doubt_oils(scenario: Scenario) -> list[str]:
    """Tell of numbers beside the scenario's oil, and of parts without one oil."""
    values: dict[tuple[str, float], list[str]] = {}
    parts = _list_oiled(scenario)
    for name, table in parts.items():
        if scenario.oil is not None and table.oil is not None:
            continue
        layout = table.resolve().parameters
        for key in STATED:
            if key in layout:
                value = float(table.parameters.get(key, layout.field(key).start))
                values.setdefault((key, value), []).append(name)
    if scenario.oil is not None:
        temperature, oil = evaluate({"oil": scenario.oil, "temperature": scenario.temperature})
        return [
            f"{key} of components.{_name_parts(names)} is set by hand: {value:.4g} {STATED[key]}; the oil "
            f"has {oil[key]:.4g} {STATED[key]} at {in_celsius(temperature)}"
            for (key, value), names in values.items()
            if f"{value:.4g}" != f"{oil[key]:.4g}"  # as it is printed
        ]
    oils = [table.oil for table in parts.values()]
    if None not in oils and all(oil == oils[0] for oil in oils):
        return []  # at the temperature of each part
    found = []
    for key, unit in STATED.items():
        each = [f"{v:.4g} {unit} in {_name_parts(names)}" for (k, v), names in values.items() if k == key]
        if len(each) > 1:
            found.append(f"{key} is {', '.join(each)}")
    if not found:
        return []
    return [
        f"{'; '.join(found)}: no oil has all of these at one temperature; state one for all parts, above the "
        'first table, e.g. oil = "SAE 5W-30" and temperature = "100 degC"'
    ]


def _list_oiled(scenario: Scenario) -> dict[str, ComponentTable]:
    """The parts with an oil; a dry contact has none."""
    return {
        name: table
        for name, table in scenario.components.items()
        if table.resolve().has_role(*OILED) and table.parameters.get("film_model") != "dry"
    }


def _describe(written: str | OilSheet, temperature: float) -> str:
    state = evaluate_oil(read_oil(written), temperature)
    name, about = ("own oil", "") if isinstance(written, OilSheet) else (written, describe_grade(written))
    return (
        f"{name} at {in_celsius(temperature)} has a viscosity of {1e3 * state.viscosity:.4g} mPa.s and a "
        f"pressure-viscosity coefficient of {1e9 * state.pressure_viscosity:.4g} 1/GPa (Roelands' exponent "
        f"{state.roelands_exponent:.3g})" + (f"; {about}" if about else "")
    )


def _name_parts(names: list[str]) -> str:
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more
