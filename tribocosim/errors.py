"""Errors of this package. Each message names the thing, what was seen and the remedy.

`MistakeError`: of a scenario, a value, a file or a call; nothing was run. `ModelError`, a mistake: a system
that cannot be built or solved. `RunError`: a run that cannot go on; what was computed before it is valid.
"""

from models.core.system import ModelError as ModelError
from orchestrator.errors import DiscardedStepError as DiscardedStepError
from orchestrator.errors import EndedError as EndedError
from orchestrator.errors import LostParticipantError as LostParticipantError
from orchestrator.errors import MistakeError as MistakeError
from orchestrator.errors import ParticipantError as ParticipantError
from orchestrator.errors import RunError as RunError
from orchestrator.scenario import ScenarioError as ScenarioError
from orchestrator.store.output_folder import OutputFolderError as OutputFolderError

__all__ = [
    "DiscardedStepError", "EndedError", "LostParticipantError", "MistakeError", "ModelError",
    "OutputFolderError", "ParticipantError", "RunError", "ScenarioError",
]  # fmt: skip
