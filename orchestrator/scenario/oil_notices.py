"""What a run says about the oils of a scenario, and what it doubts."""

from models.contact.oil_grades import describe_grade
from models.contact.oils import evaluate_oil

from .component_table import ComponentTable
from .oil import OILED, OilSheet, evaluate, in_celsius, read_oil
from .scenario import Scenario

# Numbers of an oil that parts state, with their units.
STATED = {"viscosity": "Pa.s", "pressure_viscosity": "1/Pa"}
# Of a scenario's parts with the same oil, so many are named in a line.
NAMED = 3


def list_oils(scenario: Scenario) -> list[str]:
    """What each oil of a scenario has at its temperature, a line each."""
    lines: dict[str, list[str]] = {}
    for name, table in _list_oiled(scenario).items():
        if (own := table if table.oil is not None else scenario).oil is not None:
            lines.setdefault(_describe(own.oil, own.temperature or 0.0), []).append(name)
    return [f"{_join(names)}: {text}" for text, names in lines.items()]


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
            f"{key} of components.{_join(names)} is set by hand: {value:.4g} {STATED[key]}; the oil has "
            f"{oil[key]:.4g} {STATED[key]} at {in_celsius(temperature)}"
            for (key, value), names in values.items()
            if f"{value:.4g}" != f"{oil[key]:.4g}"  # as it is printed
        ]
    oils = [table.oil for table in parts.values()]
    if None not in oils and all(oil == oils[0] for oil in oils):
        return []  # at the temperature of each part
    found = []
    for key, unit in STATED.items():
        each = [f"{v:.4g} {unit} in {_join(names)}" for (k, v), names in values.items() if k == key]
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


def _join(names: list[str]) -> str:
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more
