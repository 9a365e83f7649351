"""Participants of a co-simulation: FMUs, in this process or one of their own, and components, behind one
protocol."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from models.core.system import Instance

from .description import made_here
from .fmu import FmuParticipant, Given
from .in_own_process import InOwnProcess
from .in_process import InProcessParticipant as in_process
from .offers import missing
from .protocol import Participant
from .substeps import Substepped as substepped
from .third_party import ForeignComponent, component_of_file
from .transformed import Transformed as transformed

__all__ = [
    "FmuParticipant",
    "ForeignComponent",
    "InOwnProcess",
    "Participant",
    "component_of_file",
    "fmu",
    "given",
    "in_own_process",
    "in_process",
    "made_here",
    "missing",
    "substepped",
    "transformed",
]


NO_TEXTS: Mapping[str, str] = {}


def fmu(name: str, path: Path, instance: Instance, texts: Mapping[str, str] = NO_TEXTS) -> FmuParticipant:
    """The FMU at `path` in the place of `instance`, which knows no texts."""
    return FmuParticipant(name, path, given(instance, texts))


def in_own_process(
    name: str, path: Path, instance: Instance, texts: Mapping[str, str] = NO_TEXTS
) -> InOwnProcess:
    """As `fmu`, in a process of its own."""
    return InOwnProcess(name, path, given(instance, texts))


def given(instance: Instance, texts: Mapping[str, str] = NO_TEXTS) -> Given:
    """What the FMU in the place of `instance` is asked for and given."""
    component = instance.component
    own = isinstance(component, ForeignComponent)
    starts = {k if own else component.state.field(k).suffixed("_start"): v for k, v in instance.start.items()}
    return Given(component.outputs.names, {**instance.parameters, **starts}, instance.inputs, texts)
