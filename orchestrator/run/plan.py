"""Plan a run: build the system, check everything, build the FMUs. Nothing is written to the output folder."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from models.core.quantities import Quantity
from models.core.system import ModelError, System

from ..engine.energy.counting import counting_structure
from ..reporter import Reporter
from ..scenario import BUILT_KINDS, Scenario
from ..scenario.checks import check_reference
from ..scenario.oil import list_oils
from ..scenario.system import (
    Builder,
    build_system,
    list_doubtful_equilibrium,
    list_moved_starts,
    resolve_start,
)
from ..scenario.warnings import list_doubtful, list_warnings
from .witness import check_witness


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
    notices: Sequence[str] = ()

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
    system = _build_system(scenario)
    check_reference(scenario, system)
    check_witness(scenario, system)
    with reporter.stage("FMUs"):
        fmus = resolve_fmus(scenario, build)
    resolved = resolve_start(scenario, system)
    starts = [*list_moved_starts(system, resolved), *list_doubtful_equilibrium(scenario, resolved)]
    notices = [*starts, *list_oils(scenario), *list_warnings(scenario)]
    for line in notices:
        reporter.line(line)
    return Plan(scenario, resolved, fmus, figures, notices)


def _build_system(scenario: Scenario) -> System:
    """The system; the error of one that cannot be built begins with numbers that may lack their unit."""
    try:
        return build_system(scenario)
    except ModelError as error:
        raise ModelError("\n".join([*list_doubtful(scenario), str(error)])) from None


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
