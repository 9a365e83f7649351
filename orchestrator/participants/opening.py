"""Opens an FMU as a participant, by the interface that it takes part by."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import ParticipantError
from .description import DescriptionError, read_description
from .fmu import FmuParticipant
from .opened_fmu import FmuSettings

if TYPE_CHECKING:
    from .model_exchange.integrated import IntegratedFmu


def open_here(
    name: str, path: Path, settings: FmuSettings, folder: Path | None = None
) -> FmuParticipant | IntegratedFmu:
    """The FMU at `path` in this process, to be unpacked into `folder`.

    ParticipantError if it cannot be used.
    """
    try:
        about = read_description(path, settings.interface, settings.sizes)
    except DescriptionError as error:
        raise ParticipantError(f"{name}: {path} {error}") from None
    if not about.integrated:
        return FmuParticipant(name, path, settings, folder)
    from .model_exchange.integrated import IntegratedFmu  # with its solver, which takes long to import

    return IntegratedFmu(name, path, settings, folder)
