"""Build a participant for every instance of a system."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from models.core.bonds import counting
from models.core.system import System

from ..engine.energy.correction import Compensated, bond_inputs
from ..engine.energy.estimate import EstimatedComponent, Estimating, without_estimates
from ..engine.substeps import Substepped
from ..participants import (
    Participant,
    find_missing,
    in_process,
    open_fmu,
    open_in_own_process,
    transformed,
)
from ..participants.transformed import Linear
from ..scenario import Scenario
from ..scenario.conversion import find_transformations
from ..scenario.system import build_instances
from .plan import FmuFile

# Gets an instance's name and a function that makes its participant; makes and may wrap it.
Wrap = Callable[[str, Callable[[], Participant]], Participant]


def build_participants(
    scenario: Scenario, system: System, files: Mapping[str, FmuFile], wrap: Wrap
) -> dict[str, Participant]:
    """A participant for every instance: its FMU where there is one. The caller closes them."""
    participants: dict[str, Participant] = {}
    linear = find_transformations(*build_instances(scenario))
    try:
        for name, instance in system.instances.items():
            table = scenario.components[name]
            bare = without_estimates(instance)
            if name in files:
                given = name, files[name].path, bare, table.strings
                make: Callable[[], Participant] = partial(open_fmu, *given)
                if table.own_process:
                    make = partial(open_in_own_process, *given, table.memory_limit_mb)
            else:
                make = partial(in_process, name, bare)
            participants[name] = wrap(name, make)
            if isinstance(instance.component, EstimatedComponent):
                participants[name] = Estimating(participants[name], instance.component)
            if table.substeps > 1 or table.retries:
                participants[name] = Substepped(participants[name], table.substeps, table.retries)
            if scenario.energy.correction:
                participants[name] = Compensated(participants[name], bond_inputs(instance.component))
            if any(one != Linear() for one in linear.get(name, {}).values()):
                participants[name] = transformed(participants[name], linear[name])
    except BaseException:
        for participant in participants.values():
            participant.close()
        raise
    return participants


def select_counting(scenario: Scenario, system: System) -> list[str]:
    """The instances that can count their energies.

    Components of unknown equations cannot, nor can given FMUs that lack the variables for it.
    """
    names = []
    for name, table in scenario.components.items():
        component = system.instances[name].component
        if component.opaque:
            continue
        given = table.participant.endswith(".fmu")
        if not given or not find_missing(Path(table.participant), counting(component).outputs.names):
            names.append(name)
    return names
