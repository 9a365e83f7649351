"""Check a scenario against its system, before a run."""

from collections.abc import Iterable, Iterator
from pathlib import Path

from fmus.fmi.archive import FmuFileError, archive_faults, open_archive
from models.core.evaluation import check_start
from models.core.system import System, suggestion

from ..errors import Fault, in_command_line
from ..participants.capabilities import find_missing
from .capabilities import check_capabilities, choose_reference
from .origin import names_file
from .scenario import Scenario, ScenarioError
from .values import doubt_value, list_layouts


def check_scenario(scenario: Scenario, system: System) -> str | None:
    """How the reference is solved, if at all; ScenarioError or ModelError for what a run could not do."""
    for name in scenario.tolerance:
        part, known = name.partition(".")[0], system.outputs.names
        if part not in system.instances:
            raise ScenarioError(
                f"tolerance.{name}: no component {part!r}; {suggestion(part, system.instances)}"
            )
        if name not in known:
            mine = [other for other in known if other.startswith(f"{part}.")]
            raise ScenarioError(f"tolerance.{name}: no such output; {suggestion(name, mine)}")
    if scenario.start == "given":
        check_start(system, 0.0, system.x0)
    reference = choose_reference(scenario)
    for name, table in scenario.components.items():
        if table.file and not table.third_party:
            _check_file(name, table.file, list_required_variables(name, system, scenario.start))
    check_steps(scenario, system)
    return reference


@names_file
def check_steps(scenario: Scenario, system: System) -> None:
    """ScenarioError where the master or the steps do not suit the system, or its FMU files."""
    _check_master(scenario)
    control = scenario.step_control
    if control and control.forward and scenario.event_tolerance is not None:
        raise ScenarioError(
            f"event_tolerance: step_control.estimator = {control.estimator!r} makes no step again, as the "
            "location of events does; leave one of them out"
        )
    check_capabilities(scenario)


@names_file
def check_units(scenario: Scenario) -> None:
    """Refuse numbers without a unit that are plausible only in another unit; ScenarioError."""
    if slips := [doubt for doubt in _find_doubts(scenario) if doubt.remedy]:
        raise ScenarioError.of(slips)


def list_doubtful(scenario: Scenario) -> list[str]:
    """Warn of numbers that are not plausible."""
    return [in_command_line(doubt.words) for doubt in _find_doubts(scenario)]


def _find_doubts(scenario: Scenario) -> Iterator[Fault]:
    """Each has a remedy where it is stated without a unit and another unit makes the number plausible."""
    for name, table in scenario.components.items():
        for key, layout in list_layouts(table.resolve()).items():
            values = table.values[key]
            for variable, value in values.items():
                if isinstance(value, str) or variable not in layout:
                    continue
                quantity = layout.field(variable).quantity
                if values.get(quantity.same_as) == value:
                    continue  # the other one is doubted
                if doubt := doubt_value(f"components.{name}.{key}.{variable}", quantity, value):
                    yield doubt


def _check_master(scenario: Scenario) -> None:
    """The master's order names every component once; what it iterates are components."""
    master = scenario.master.build()
    order, iterate = master.order, master.iterate
    if order and sorted(order) != sorted(scenario.components):
        raise ScenarioError(
            f"master.order = {', '.join(order)}: must name each of {', '.join(scenario.components)} once"
            + "".join(
                f"; {name}: {suggestion(name, scenario.components)}"
                for name in order
                if name not in scenario.components
            )
        )
    if len(iterate) == 1:
        raise ScenarioError(
            f"master.iterate = {iterate[0]}: there is nothing to iterate one component with; name "
            "all that belong together, or leave it out (then every loop of connections is iterated)"
        )
    for name in iterate:
        if name not in scenario.components:
            raise ScenarioError(
                f"master.iterate: no component {name!r}; {suggestion(name, scenario.components)}"
            )
        if iterate.count(name) > 1:
            raise ScenarioError(f"master.iterate: {name!r} is named twice; name each component once")


def _check_file(name: str, path: Path, variables: Iterable[str]) -> None:
    """The file is a sound co-simulation FMU with these variables."""
    where = f"components.{name}.participant: "
    try:
        with open_archive(path) as archive:
            faults = archive_faults(archive)
    except FmuFileError as error:
        raise ScenarioError(f"{where}{error}") from None
    faults = faults or find_missing(path, variables)
    if faults:
        raise ScenarioError(f"{where}{path}: {faults[0]}; give another file")


def list_required_variables(name: str, system: System, start: str) -> list[str]:
    """The variables that an FMU needs to take the place of an instance."""
    instance = system.instances[name]
    states = instance.component.state
    sources = {c.source.variable for c in system.connections if c.source.instance == name}
    targets = {c.target.variable for c in system.connections if c.target.instance == name}
    started = states.variables if start == "equilibrium" else instance.start
    starts = (states.field(state).add_suffix("_start") for state in started)
    return [*sorted(sources), *sorted(targets), *instance.parameters, *starts, *instance.inputs]
