"""How each instance of a system takes part in its coupled run, and its participant."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from models.core.system import Instance, System

from ..engine.energy.correction import Compensated, bond_inputs
from ..engine.energy.estimate import EstimatedComponent, Estimating, without_estimates
from ..engine.substeps import Substepped
from ..participants.in_process import InProcessParticipant as in_process
from ..participants.open_fmu import open_fmu
from ..participants.own_process import Limits
from ..participants.protocol import Participant
from ..participants.proven import Proof, Proven
from ..participants.transformed import Linear
from ..participants.transformed import Transformed as transformed


@dataclass(frozen=True)
class FmuFile:
    """An FMU that takes part."""

    path: Path
    sha256: str


@dataclass(frozen=True)
class ParticipantPlan:
    """An FMU and how it runs, or without a `file` the component's equations in this process.

    `linear` transforms inputs, by name. A `compensated` one gets back what its inputs missed in the last
    step. With `limits` an FMU has its own process. Of one with a `proof` it is tried whether it restores its
    state.
    """

    file: FmuFile | None = None
    strings: Mapping[str, str] = field(default_factory=dict)
    limits: Limits | None = None
    proof: Proof | None = None
    substeps: int = 1
    retries: int = 0
    linear: Mapping[str, Linear] = field(default_factory=dict)
    compensated: bool = False

    def open_bare(self, name: str, instance: Instance) -> Participant:
        """The participant alone, which takes whole macro steps and inputs in its own units."""
        bare = without_estimates(instance)
        if self.file is None:
            return in_process(name, bare)
        return open_fmu(name, self.file.path, bare, self.strings, self.limits)

    def make_opener(self, name: str, instance: Instance) -> Callable[[], Participant]:
        """Opens the bare participant, which proves what it says."""
        make = partial(self.open_bare, name, instance)
        if self.proof is None:
            return make
        return partial(Proven, make, without_estimates(instance).component.outputs, self.proof)

    def complete(self, participant: Participant, instance: Instance) -> Participant:
        """The bare participant with what lies between it and the coupling."""
        if isinstance(instance.component, EstimatedComponent):
            participant = Estimating(participant, instance.component)
        if self.substeps > 1 or self.retries:
            participant = Substepped(participant, self.substeps, self.retries)
        if self.compensated:
            participant = Compensated(participant, bond_inputs(instance.component))
        return transformed(participant, self.linear) if self.linear else participant


# Gets an instance's name and a function that makes its bare participant; makes and may wrap it.
Wrap = Callable[[str, Callable[[], Participant]], Participant]


def _make(name: str, make: Callable[[], Participant]) -> Participant:
    return make()


@contextmanager
def open_participants(
    system: System, plans: Mapping[str, ParticipantPlan], wrap: Wrap = _make
) -> Iterator[dict[str, Participant]]:
    """A participant for every instance; they are closed at the end of the block."""
    with ExitStack() as stack:
        participants = {}
        for name, instance in system.instances.items():
            plan = plans[name]
            bare = wrap(name, plan.make_opener(name, instance))
            stack.callback(bare.close)
            participants[name] = plan.complete(bare, instance)
        yield participants
