"""Plan a run: resolve the scenario once, check everything, build the FMUs. Nothing is written."""

import hashlib
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path
from typing import TypeAlias

from models.core.bonds import counting
from models.core.quantities import Quantity, Vector
from models.core.system import Instance, System

from ..assessment.gas_phase import list_doubtful_gas
from ..assessment.notices import list_changes, list_doubts
from ..assessment.trains import check_lash
from ..engine.effort import timed
from ..engine.energy import add_counting, counting_structure
from ..engine.instants import SideLines
from ..engine.substeps import Substepped
from ..errors import Set
from ..masters import Master
from ..participants.capabilities import find_missing
from ..participants.in_process import InProcessParticipant as in_process
from ..participants.open_fmu import open_fmu
from ..participants.own_process import Limits
from ..participants.protocol import Participant
from ..participants.proven import Proof, Proven
from ..participants.third_party import ThirdPartyComponent
from ..participants.wrapping import Linear
from ..participants.wrapping import Transformed as transformed
from ..reporter import FMUS, Reporter
from ..scenario import BUILT_KINDS, Scenario, ScenarioError
from ..scenario.capabilities import plan_proof
from ..scenario.conversion import Transformations
from ..scenario.files import to_full_toml
from ..scenario.master_table import AUTO
from ..scenario.system import (
    Builder,
    Resolved,
    list_doubtful_equilibrium,
    list_moved_starts,
    list_outputs,
)
from ..scenario.warnings import describe_turns
from ..stepping import RefinedSteps, Stepper
from .comparison import check_witness


@dataclass(frozen=True)
class FmuFile:
    """An FMU that takes part."""

    path: Path
    sha256: str


@dataclass(frozen=True)
class ParticipantPlan:
    """An FMU and how it runs, or without a `file` the component's equations in this process.

    `linear` transforms inputs, by name. With `limits` an FMU has its own process. Of one with a `proof` it is
    tried whether it restores its state.
    """

    file: FmuFile | None = None
    strings: Mapping[str, str] = field(default_factory=dict)
    limits: Limits | None = None
    proof: Proof | None = None
    substeps: int = 1
    retries: int = 0
    linear: Mapping[str, Linear] = field(default_factory=dict)

    def open_bare(self, name: str, instance: Instance) -> Participant:
        """The participant alone, which takes whole macro steps and inputs in its own units."""
        if self.file is None:
            return in_process(name, instance)
        return open_fmu(name, self.file.path, instance, self.strings, self.limits)

    def open(self, name: str, instance: Instance) -> Participant:
        """The participant, which proves what it says, with what lies between it and the coupling."""
        if self.proof is None:
            participant: Participant = self.open_bare(name, instance)
        else:
            make = partial(self.open_bare, name, instance)
            participant = Proven(make, instance.component, self.proof)
        if self.substeps > 1 or self.retries:
            participant = Substepped(participant, self.substeps, self.retries)
        return transformed(participant, self.linear) if self.linear else participant


# The wall times (s) in which participants were opened, and closed, by name.
Lifetimes: TypeAlias = tuple[dict[str, float], dict[str, float]]


@contextmanager
def open_participants(
    system: System, plans: Mapping[str, ParticipantPlan], times: Lifetimes | None = None
) -> Iterator[dict[str, Participant]]:
    """A participant for every instance; they are closed at the end of the block."""
    opening, closing = times or (defaultdict(float), defaultdict(float))

    def close(name: str, participant: Participant) -> None:
        with timed(closing, name):
            participant.close()

    with ExitStack() as stack:
        participants = {}
        for name, instance in system.instances.items():
            with timed(opening, name):
                participant = plans[name].open(name, instance)
            stack.callback(close, name, participant)
            participants[name] = participant
        yield participants


@dataclass(frozen=True)
class Plan:
    """All that a run needs, resolved once; what comes after asks the plan.

    `system` has the start values of the run, and `counted`, with the energy ledger, outputs for its energies
    too. `make_steps` gives a new stepper, `refine_steps` one that divides the steps of a run that ended at
    given times. `reference` is the method of the reference, if there is one. `toml` is the scenario with all
    its values; assessments of the steps read `scenario` itself.
    """

    scenario: Scenario
    toml: str
    system: System
    counted: System | None
    participants: Mapping[str, ParticipantPlan]
    side_lines: SideLines
    master: Master
    make_steps: Callable[[], Stepper]
    refine_steps: Callable[[Vector, int], RefinedSteps]
    reference: str | None
    figures: bool
    notices: Sequence[str] = ()

    @property
    def stop_time(self) -> float:
        """In seconds."""
        return self.scenario.stop_time

    @property
    def tolerance(self) -> Mapping[str, float]:
        """The largest relative RMS error allowed, by variable."""
        return self.scenario.tolerance

    @cached_property
    def sha256(self) -> dict[str, str]:
        """The sum of every FMU, by instance."""
        return {name: one.file.sha256 for name, one in self.participants.items() if one.file}

    @cached_property
    def third_party(self) -> dict[str, ThirdPartyComponent]:
        """The instances whose equations are unknown."""
        components = {name: instance.component for name, instance in self.system.instances.items()}
        return {name: c for name, c in components.items() if isinstance(c, ThirdPartyComponent)}

    @cached_property
    def quantities(self) -> dict[str, Quantity]:
        """The quantity of every output, by "instance.variable"."""
        return list_outputs(self.scenario)


def make_plan(resolved: Resolved, build: Builder, reporter: Reporter, figures: bool = True) -> Plan:
    """Build the FMUs of a scenario and say what is doubted of it. Raises ScenarioError or ModelError."""
    scenario, assembly, system = resolved.scenario, resolved.assembly, resolved.system
    if scenario.master.name == AUTO:
        named = Set("master.name", "gauss_seidel")
        raise ScenarioError((f"master.name = {AUTO!r}: is not chosen here; name one, e.g. ", named))
    check_witness(scenario, system)
    check_lash(system)
    with reporter.stage(FMUS):
        participants = plan_participants(scenario, assembly.linear, build)
    starts = [*list_moved_starts(assembly.system, system), *list_doubtful_equilibrium(scenario, system)]
    notices = [*starts, *list_doubtful_gas(system), *list_doubts(scenario, system)]
    notices += [scenario.master.chosen] if scenario.master.chosen else []
    for line in (*describe_turns(scenario), *list_changes(scenario, system), *notices):
        reporter.line(line)
    return Plan(
        scenario=scenario,
        toml=to_full_toml(scenario),
        system=system,
        counted=_count_energies(scenario, system) if scenario.energy.ledger else None,
        participants=participants,
        side_lines=assembly.side_lines,
        master=scenario.build_master(),
        make_steps=scenario.build_steps,
        refine_steps=scenario.refine_steps,
        reference=assembly.reference,
        figures=figures,
        notices=notices,
    )


def plan_participants(
    scenario: Scenario, linear: Transformations, build: Builder | None
) -> dict[str, ParticipantPlan]:
    """How every instance takes part. FMUs of our components are built; without `build` they take part by
    their equations."""
    plans = {}
    for name, table in scenario.components.items():
        path = table.file
        if table.participant in BUILT_KINDS and build is not None:
            counts = scenario.energy.ledger and not table.resolve().opaque
            structure = counting_structure(table.structure) if counts else table.structure
            path = build(str(table.component), structure, table.participant)
        plans[name] = ParticipantPlan(
            file=_sum(path) if path else None,
            strings=table.strings,
            limits=scenario.process_limits(name),
            proof=plan_proof(scenario, name),
            substeps=table.substeps,
            retries=table.retries or 0,
            linear=linear.get(name, {}),
        )
    return plans


def _sum(path: Path) -> FmuFile:
    return FmuFile(path, hashlib.sha256(path.read_bytes()).hexdigest())


def _count_energies(scenario: Scenario, system: System) -> System:
    """The system with all instances counting their energies that can.

    Components of unknown equations cannot, nor can given FMUs that lack the variables for it.
    """
    counted = []
    for name, table in scenario.components.items():
        component = system.instances[name].component
        if not component.opaque and not (
            table.file and find_missing(table.file, counting(component).outputs.names)
        ):
            counted.append(name)
    return add_counting(system, counted)
