"""From a scenario to what runs: the system, its start, the participants."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from fmus.fmi.archive import FmuFileError, archive_faults, opened
from models.core.bonds import counting
from models.core.evaluation import check_start
from models.core.quantities import Layout, Quantity, Vector
from models.core.system import Instance, ModelError, System, suggestion

from ..energy.bonds import exchanged_bonds
from ..energy.correction import Compensated, bond_inputs
from ..energy.counting import counting_structure
from ..energy.estimate import EstimatedComponent, Estimating, without_estimates
from ..participants import (
    Participant,
    find_missing,
    in_process,
    open_fmu,
    open_in_own_process,
    substepped,
    transformed,
)
from ..participants.transformed import Linear
from ..scenario import BUILT_KINDS, ComponentTable, Line, Scenario, ScenarioError, parse_line
from ..scenario.capabilities import check_capabilities, check_third_party
from ..scenario.conversion import find_transformations, replace_units
from ..scenario.values import to_numbers

# Gives the FMU of a catalogue component with structural sizes, of a kind that is built ("fmu", "native").
Builder = Callable[[str, Mapping[str, int], str], Path]


def system_of(scenario: Scenario) -> System:
    """The scenario's system with its start values as given; ModelError or ScenarioError for faults."""
    instances, lines = _written(scenario)
    seen = replace_units(instances, lines, find_transformations(instances, lines))
    system = System(seen, [(line.source, line.target) for line in lines])
    for name in scenario.tolerance:
        if name not in system.outputs.names:
            raise ScenarioError(f"tolerance.{name}: no such output; {suggestion(name, system.outputs.names)}")
    if scenario.start == "given":
        check_start(system, 0.0, system.x0)
    check_master(scenario)
    check_third_party(scenario)
    check_energy_estimator(scenario, system)
    if scenario.energy.correction and scenario.master.name != "jacobi":
        raise ScenarioError(
            f"energy.correction = true: the master {scenario.master.name} interpolates inputs, which then "
            "miss nothing; use the master jacobi, or leave the correction out"
        )
    for name, table in scenario.components.items():
        if table.participant.endswith(".fmu") and not table.third_party:
            check_file(name, Path(table.participant), variables_used(name, system, scenario.start))
    check_capabilities(scenario)
    return system


def _written(scenario: Scenario) -> tuple[dict[str, Instance], list[Line]]:
    """Instances and connections as the scenario has them, before units are converted."""
    instances = {name: _instance(table) for name, table in scenario.components.items()}
    return instances, list(map(parse_line, scenario.connections))


def check_analysable(scenario: Scenario) -> None:
    """ScenarioError where the system's equations do not know all: third-party FMUs, connections that
    change values."""
    for name, table in scenario.components.items():
        if table.third_party:
            raise ScenarioError(
                f"components.{name}: a third-party FMU, whose equations are not known here, is not "
                "analysed; tribocosim run with several macro steps shows what they do"
            )
    changed = find_transformations(*_written(scenario))
    for name, inputs in changed.items():
        for variable, linear in inputs.items():
            if linear != Linear():
                raise ScenarioError(
                    f"{name}.{variable}: its connection has a factor, an offset or converts units, which is "
                    "not known to the analysis; connect variables of one unit as they are"
                )


def check_master(scenario: Scenario) -> None:
    """ScenarioError unless the master's order, if it has one, names every component once, and what it is to
    iterate are components."""
    master = scenario.master.build()
    order = getattr(master, "order", ())
    if order and sorted(order) != sorted(scenario.components):
        raise ScenarioError(
            f"master.order = {', '.join(order)}: must name each of {', '.join(scenario.components)} once"
        )
    iterate = getattr(master, "iterate", ())
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


def check_reference(scenario: Scenario, system: System) -> None:
    """ModelError where a reference is wanted that cannot be solved."""
    if scenario.reference.enabled:
        from models.monolithic import check_solvable

        check_solvable(system)


def check_energy_estimator(scenario: Scenario, system: System) -> None:
    """ScenarioError where the energy residual is to set the steps and no power bond is exchanged."""
    if scenario.step_control is None or scenario.step_control.estimator != "energy":
        return
    if not exchanged_bonds(system):
        raise ScenarioError(
            "step_control.estimator = 'energy': no power bond has both its effort and its flow among the "
            "connections, so that it would see no error; use schierz or step_doubling"
        )


def _instance(table: ComponentTable) -> Instance:
    component = table.resolve()
    return Instance(
        component,
        parameters=to_numbers(component.parameters, table.parameters),
        start=to_numbers(component.state, table.start),
        inputs=to_numbers(component.inputs, table.inputs),
    )


def at_start(scenario: Scenario, system: System) -> System:
    """The system with the start values that the scenario asks for."""
    if scenario.start == "given":
        return system
    from models.monolithic import equilibrium

    try:
        state = equilibrium(system)
    except ModelError as error:
        raise ModelError(
            f'{error} Correct the parameters, or set start = "given" and give start values in '
            "[components.NAME.start]"
        ) from None
    instances = {
        name: replace(instance, start=_starts(instance.component.state, state[system.state.of(name)]))
        for name, instance in system.instances.items()
    }
    resting = system.with_instances(instances)
    check_start(resting, 0.0, resting.x0)
    return resting


def _starts(layout: Layout, state: Vector) -> dict[str, float]:
    """By name, of the states that can be given one."""
    named = layout.named(state)
    return {name: named[name] for name in layout.variables}


def compared(scenario: Scenario, system: System) -> list[str]:
    """The variables compared with the reference: all connected outputs, and those with a tolerance."""
    connected = {str(connection.source) for connection in system.connections}
    return [name for name in system.outputs.names if name in connected or name in scenario.tolerance]


def output_quantities(system: System) -> dict[str, Quantity]:
    """The quantity of every output, by "instance.variable"."""
    return {
        f"{name}.{field.name}": field.quantity
        for name, instance in system.instances.items()
        for field in instance.component.outputs.fields
    }


@dataclass(frozen=True)
class FmuFile:
    """An FMU that takes part."""

    path: Path
    sha256: str


def fmu_files(scenario: Scenario, build: Builder) -> dict[str, FmuFile]:
    """The FMU file of every instance that is one; built where the scenario names none."""
    files = {}
    for name, table in scenario.components.items():
        if table.participant == "in-process":
            continue
        own = table.participant in BUILT_KINDS
        counts = scenario.energy.ledger and table.resolve().samples
        structure = counting_structure(table.structure) if counts else table.structure
        path = Path(table.participant)
        if own and table.component:
            path = build(table.component, structure, table.participant)
        files[name] = FmuFile(path, hashlib.sha256(path.read_bytes()).hexdigest())
    return files


def counting_instances(scenario: Scenario, system: System) -> list[str]:
    """The instances that can count their energies: all but those that take no samples, and given FMUs
    without the variables for it."""
    names = []
    for name, table in scenario.components.items():
        component = system.instances[name].component
        if not component.samples:
            continue
        given = table.participant.endswith(".fmu")
        if not given or not find_missing(Path(table.participant), counting(component).outputs.names):
            names.append(name)
    return names


def check_file(name: str, path: Path, variables: Iterable[str]) -> None:
    """ScenarioError unless the file is a sound co-simulation FMU with these variables."""
    where = f"components.{name}.participant: "
    try:
        with opened(path) as archive:
            faults = archive_faults(archive)
    except FmuFileError as error:
        raise ScenarioError(f"{where}{error}") from None
    faults = faults or find_missing(path, variables)
    if faults:
        raise ScenarioError(f"{where}{path}: {faults[0]}; give another file")


def variables_used(name: str, system: System, start: str) -> list[str]:
    """What an FMU has to have to take the place of an instance."""
    instance = system.instances[name]
    states = instance.component.state
    sources = {c.source.variable for c in system.connections if c.source.instance == name}
    targets = {c.target.variable for c in system.connections if c.target.instance == name}
    started = states.variables if start == "equilibrium" else instance.start
    starts = (states.field(state).suffixed("_start") for state in started)
    return [*sorted(sources), *sorted(targets), *instance.parameters, *starts, *instance.inputs]


def participants_of(
    scenario: Scenario,
    system: System,
    files: Mapping[str, FmuFile],
    made: Callable[[str, Callable[[], Participant]], Participant],
) -> dict[str, Participant]:
    """A participant for every instance: its FMU where there is one. To be closed by the caller.

    Each comes from `made(name, make)`, which may wrap what `make()` gives.
    """
    participants: dict[str, Participant] = {}
    linear = find_transformations(*_written(scenario))
    try:
        for name, instance in system.instances.items():
            if name in files:
                kind = open_in_own_process if scenario.components[name].own_process else open_fmu
                texts = scenario.components[name].strings
                make = partial(kind, name, files[name].path, without_estimates(instance), texts)
            else:
                make = partial(in_process, name, without_estimates(instance))
            participants[name] = made(name, make)
            if isinstance(instance.component, EstimatedComponent):
                participants[name] = Estimating(participants[name], instance.component)
            table = scenario.components[name]
            if table.substeps > 1 or table.retries:
                participants[name] = substepped(participants[name], table.substeps, table.retries)
            if scenario.energy.correction:
                participants[name] = Compensated(participants[name], bond_inputs(instance.component))
            if any(one != Linear() for one in linear.get(name, {}).values()):
                participants[name] = transformed(participants[name], linear[name])
    except BaseException:
        for participant in participants.values():
            participant.close()
        raise
    return participants
