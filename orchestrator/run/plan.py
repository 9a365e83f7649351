"""Plan a run: build the system, check everything, build the FMUs. Nothing is written to the output folder."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from models.core.evaluation import check_start
from models.core.quantities import Layout, Quantity, Vector
from models.core.system import Instance, ModelError, System

from ..energy.counting import counting_structure
from ..scenario import BUILT_KINDS, ComponentTable, Line, Scenario, parse_line
from ..scenario.conversion import find_transformations, replace_units
from ..scenario.values import to_numbers
from .checks import check_reference, check_scenario
from .report import Reporter

# Builds the FMU of a catalogue component: name, structural sizes, kind ("fmu" or "native").
Builder = Callable[[str, Mapping[str, int], str], Path]


@dataclass(frozen=True)
class FmuFile:
    """An FMU that takes part."""

    path: Path
    sha256: str


@dataclass(frozen=True)
class Plan:
    """A checked scenario and what its run needs; `system` has the start values of the run."""

    scenario: Scenario
    system: System
    fmus: Mapping[str, FmuFile]
    figures: bool

    @property
    def sha256(self) -> dict[str, str]:
        """The sum of every FMU, by instance."""
        return {name: file.sha256 for name, file in self.fmus.items()}

    @property
    def exposed(self) -> list[str]:
        """Third-party FMUs in this process, which they can end at any moment."""
        return [
            name
            for name, table in self.scenario.components.items()
            if table.untrusted and not table.own_process
        ]


def make_plan(scenario: Scenario, build: Builder, reporter: Reporter, figures: bool = True) -> Plan:
    """Make every check of the scenario and build its FMUs. Raises ScenarioError or ModelError."""
    system = build_system(scenario)
    check_reference(scenario, system)
    with reporter.stage("FMUs"):
        fmus = resolve_fmus(scenario, build)
    return Plan(scenario, resolve_start(scenario, system), fmus, figures)


def build_system(scenario: Scenario) -> System:
    """The checked system with the start values as given. Raises ModelError or ScenarioError."""
    instances, lines = build_instances(scenario)
    seen = replace_units(instances, lines, find_transformations(instances, lines))
    system = System(seen, [(line.source, line.target) for line in lines])
    check_scenario(scenario, system)
    return system


def build_instances(scenario: Scenario) -> tuple[dict[str, Instance], list[Line]]:
    """Instances and connections as in the scenario, before units are converted."""
    instances = {name: _build_instance(table) for name, table in scenario.components.items()}
    return instances, list(map(parse_line, scenario.connections))


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
        raise ModelError(
            f'{error} Correct the parameters, or set start = "given" and give start values in '
            "[components.NAME.start]"
        ) from None
    instances = {
        name: replace(instance, start=_select_start(instance.component.state, state[system.state.of(name)]))
        for name, instance in system.instances.items()
    }
    resting = system.with_instances(instances)
    check_start(resting, 0.0, resting.x0)
    return resting


def _select_start(layout: Layout, state: Vector) -> dict[str, float]:
    """The states that can be given a start value, by name."""
    named = layout.named(state)
    return {name: named[name] for name in layout.variables}


def collect_output_quantities(system: System) -> dict[str, Quantity]:
    """The quantity of every output, by "instance.variable"."""
    return {
        f"{name}.{field.name}": field.quantity
        for name, instance in system.instances.items()
        for field in instance.component.outputs.fields
    }


def resolve_fmus(scenario: Scenario, build: Builder) -> dict[str, FmuFile]:
    """The FMU of every instance that is one; built where the scenario gives no file."""
    files = {}
    for name, table in scenario.components.items():
        if table.participant == "in-process":
            continue
        own = table.participant in BUILT_KINDS
        counts = scenario.energy.ledger and not table.resolve().opaque
        structure = counting_structure(table.structure) if counts else table.structure
        path = Path(table.participant)
        if own and table.component:
            path = build(table.component, structure, table.participant)
        files[name] = FmuFile(path, hashlib.sha256(path.read_bytes()).hexdigest())
    return files
