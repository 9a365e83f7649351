"""Participants of a co-simulation: FMUs and components in this process, behind one protocol."""

from .fmu import FmuParticipant as fmu
from .fmu import missing, signal_degrees
from .in_process import InProcessParticipant as in_process
from .protocol import Participant
from .substeps import Substepped as substepped

__all__ = ["Participant", "fmu", "in_process", "missing", "signal_degrees", "substepped"]
