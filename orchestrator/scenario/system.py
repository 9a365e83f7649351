"""The system that a scenario describes: components with their values, connections, start values."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from models.core.evaluation import check_start
from models.core.quantities import Layout, Quantity
from models.core.system import Instance, ModelError, System

from ..engine.instants import SideLines
from ..participants.third_party import ThirdPartyComponent
from ..scenario import Line, ScenarioError
from .capabilities import MONOLITHIC
from .checks import check_scenario, check_steps, check_units, list_doubtful
from .component_table import ComponentTable
from .conversion import Transformations, transform_inputs
from .origin import names_file
from .scenario import Scenario
from .side_lines import is_side_line, read_side_lines
from .values import Value, to_numbers


def check_aliases(tables: Mapping[str, ComponentTable], lines: Iterable[Line]) -> None:
    """ScenarioError where two names of one variable are connected, or given different values."""
    lines = list(lines)
    for name, table in tables.items():
        component = table.resolve()
        if not isinstance(component, ThirdPartyComponent):
            continue
        given: list[tuple[str, str, Value | None]] = []
        for key, values in table.values.items():
            for variable, value in values.items():
                given.append((variable, f"components.{name}.{key}.{variable} = {value}", value))
        for line in lines:
            target, _, variable = line.target.partition(".")
            if target == name:
                given.append((variable, f"the connection {line}", None))
        found: dict[object, tuple[str, str, Value | None]] = {}
        for one in given:
            if one[0] not in component.about.variables:
                continue
            first = found.setdefault(component.about.variables[one[0]].memory, one)
            if first[0] != one[0] and (first[2] != one[2] or one[2] is None):
                raise ScenarioError(
                    f"{first[1]}, {one[1]}: {first[0]} and {one[0]} are two names of one variable of "
                    f"{name} (they have one value reference); leave one out"
                )


# Builds the FMU of a catalogue component: name, structural sizes, kind ("fmu" or "native").
Builder = Callable[[str, Mapping[str, int], str], Path]


@dataclass(frozen=True)
class Assembly:
    """The components of a scenario with their values, and their connections.

    An input of `system` has the unit of its source, from which `linear` transforms it. `side_lines` connect
    what is no number. `reference` is the method of the reference, if there is one.
    """

    system: System
    linear: Transformations
    side_lines: SideLines
    reference: str | None


@names_file
def assemble(scenario: Scenario) -> Assembly:
    """The checked system with the start values as given. Raises ModelError or ScenarioError.

    A ModelError begins with numbers that may lack their unit.
    """
    try:
        return _assemble(scenario)
    except ModelError as error:
        raise ModelError("\n".join([*list_doubtful(scenario), str(error)])) from None


def _assemble(scenario: Scenario) -> Assembly:
    instances = {name: _build_instance(table) for name, table in scenario.components.items()}
    components = {name: instance.component for name, instance in instances.items()}
    check_aliases(scenario.components, scenario.lines)
    side_lines = read_side_lines(scenario.lines, components)
    lines = [line for line in scenario.lines if not is_side_line(line, components)]
    seen, linear = transform_inputs(instances, lines)
    system = System(seen, [(line.source, line.target) for line in lines])
    return Assembly(system, linear, side_lines, check_scenario(scenario, system))


def build_system(scenario: Scenario) -> System:
    """The system of `assemble`."""
    return assemble(scenario).system


@dataclass(frozen=True)
class Resolved:
    """A scenario, checked as a whole; `system` has the start values of a run."""

    scenario: Scenario
    assembly: Assembly
    system: System

    def with_master_of(self, scenario: Scenario) -> "Resolved":
        """The same, to be run by the master and in the steps of this scenario; ScenarioError if it cannot."""
        check_steps(scenario, self.assembly.system)
        return replace(self, scenario=scenario)


@names_file
def resolve(scenario: Scenario) -> Resolved:
    """Check a scenario and find its start values. Raises ModelError or ScenarioError."""
    check_units(scenario)
    assembly = assemble(scenario)
    if assembly.reference == MONOLITHIC:
        from models.monolithic import check_solvable

        check_solvable(assembly.system)
    return Resolved(scenario, assembly, resolve_start(scenario, assembly.system))


def _build_instance(table: ComponentTable) -> Instance:
    component = table.resolve()
    return Instance(
        component,
        parameters=to_numbers(component.parameters, table.parameters),
        start=to_numbers(component.state, table.start),
        inputs=to_numbers(component.inputs, table.inputs),
    )


def resolve_start(scenario: Scenario, system: System) -> System:
    """The system with the start values that the scenario asks for: given, or of an equilibrium."""
    if scenario.start == "given":
        return system
    from models.monolithic import equilibrium

    try:
        state = equilibrium(system)
    except ModelError as error:
        given = 'set start = "given" and give start values in [components.NAME.start]'
        raise ModelError(error, "correct the parameters", given) from None
    instances = {}
    for name, instance in system.instances.items():
        layout = instance.component.state
        named = layout.named(state[system.state.of(name)])
        # Those that can be given a start value.
        instances[name] = replace(instance, start={key: named[key] for key in layout.variables})
    resting = system.with_instances(instances)
    check_start(resting, 0.0, resting.x0)
    return resting


def list_doubtful_equilibrium(scenario: Scenario, resolved: System) -> list[str]:
    """A line for each cam that moves its follower where the run begins in equilibrium."""
    if scenario.start == "given":
        return []
    from models.monolithic.equilibrium import list_moving_cams

    return [f"components.{line}" for line in list_moving_cams(resolved, 0.0, resolved.x0)]


def list_moved_starts(given: System, resolved: System) -> list[str]:
    """A line for each start value of the scenario that its equilibrium has replaced by another."""
    found = []
    for name, instance in given.instances.items():
        layout = instance.component.state
        for state, value in instance.start.items():
            quantity, now = layout.field(state).quantity, resolved.instances[name].start[state]
            if abs(now - value) > 1e-6 * max(abs(value), quantity.nominal):
                found.append(
                    f"components.{name}.start.{state} = {value:g} {quantity.unit}: the run begins in "
                    f'equilibrium, at {now:g}; set start = "given" to begin with the start values'
                )
    return found


def list_parameters(scenario: Scenario) -> dict[str, float]:
    """The value of every parameter by "instance.parameter", in its unit; of a choice its number."""
    found: dict[str, float] = {}
    for name, table in scenario.components.items():
        layout = table.resolve().parameters
        values = {field.name: field.start for field in layout.fields} | to_numbers(layout, table.parameters)
        found |= {f"{name}.{parameter}": value for parameter, value in values.items()}
    return found


def list_outputs(scenario: Scenario) -> dict[str, Quantity]:
    """What every output means, by "instance.output"."""
    return _name_fields({name: table.resolve().outputs for name, table in scenario.components.items()})


def list_quantities(scenario: Scenario) -> dict[str, Quantity]:
    """What every parameter means, by "instance.parameter"."""
    return _name_fields({name: table.resolve().parameters for name, table in scenario.components.items()})


def _name_fields(layouts: Mapping[str, Layout]) -> dict[str, Quantity]:
    return {f"{n}.{f.name}": f.quantity for n, layout in layouts.items() for f in layout.fields}
