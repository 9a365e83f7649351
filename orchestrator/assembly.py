"""From a scenario to what runs: the system, its start, the participants."""

from __future__ import annotations

import hashlib
import zipfile
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath

from models.quantities import Quantity
from models.system import Instance, System, suggestion

from .errors import RunError
from .participants import Participant, fmu, in_process
from .scenario import ComponentTable, Scenario, ScenarioError, ends
from .values import numbers

# Gives the FMU of a catalogue component with structural sizes.
Builder = Callable[[str, Mapping[str, int]], Path]


def system_of(scenario: Scenario) -> System:
    """The scenario's system with its start values as given; ModelError or ScenarioError for faults."""
    for name, table in scenario.components.items():
        if table.participant.endswith(".fmu") and not Path(table.participant).is_file():
            raise ScenarioError(f"components.{name}.participant: {table.participant}: no such file")
    instances = {name: _instance(table) for name, table in scenario.components.items()}
    system = System(instances, [ends(line) for line in scenario.connections])
    for name in scenario.tolerance:
        if name not in system.outputs.names:
            raise ScenarioError(f"tolerance.{name}: no such output; {suggestion(name, system.outputs.names)}")
    if scenario.start == "given":
        system.check_start(0.0, system.x0)
    return system


def _instance(table: ComponentTable) -> Instance:
    component = table.made()
    return Instance(
        component,
        parameters=numbers(component.parameters, table.parameters),
        start=numbers(component.state, table.start),
        inputs=numbers(component.inputs, table.inputs),
    )


def at_start(scenario: Scenario, system: System) -> System:
    """The system with the start values that the scenario asks for."""
    if scenario.start == "given":
        return system
    from models.monolithic import equilibrium

    state = equilibrium(system)
    instances = {
        name: replace(instance, start=instance.component.state.named(state[system.state.of(name)]))
        for name, instance in system.instances.items()
    }
    resting = system.with_instances(instances)
    resting.check_start(0.0, resting.x0)
    return resting


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
        own = table.participant == "fmu"
        path = build(table.component, table.structure) if own else Path(table.participant)
        if not own:
            check_archive(name, path)
        files[name] = FmuFile(path, hashlib.sha256(path.read_bytes()).hexdigest())
    return files


def check_archive(name: str, path: Path) -> None:
    """RunError unless the file is a sound archive with a model description and all paths inside."""
    try:
        with zipfile.ZipFile(path) as archive:
            members = archive.namelist()
            damaged = archive.testzip()
    except (OSError, zipfile.BadZipFile, zlib.error) as error:
        raise RunError(f"{name}: {path} is not an FMU ({error}); give another file") from None
    if damaged:
        raise RunError(f"{name}: {path} is damaged: {damaged} does not fit its checksum; get the file again")
    for member in members:
        parts = PurePosixPath(member.replace("\\", "/")).parts
        if ".." in parts or member.startswith(("/", "\\")) or ":" in member.partition("/")[0]:
            raise RunError(f"{name}: {path} is refused: {member!r} lies outside the archive")
    if "modelDescription.xml" not in members:
        raise RunError(f"{name}: {path} is not an FMU (no modelDescription.xml); give another file")


def participants_of(system: System, files: Mapping[str, FmuFile]) -> dict[str, Participant]:
    """A participant for every instance: its FMU where there is one. To be closed by the caller."""
    made: dict[str, Participant] = {}
    try:
        for name, instance in system.instances.items():
            made[name] = (
                fmu(name, files[name].path, instance) if name in files else in_process(name, instance)
            )
    except BaseException:
        for participant in made.values():
            participant.close()
        raise
    return made
