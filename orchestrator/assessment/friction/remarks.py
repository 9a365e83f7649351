"""What stands beside friction and torques: the friction that these leave out, and asperities in doubt."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from models.core.system import System

from ..trains import has_defaults
from .losses import list_losses, remark_outside

# Of a contact: what says how stiff its asperities are.
ASPERITIES = ("roughness_parameter", "asperity_slope")


def remark_friction(system: System, figures: Mapping[Any, Any]) -> Iterator[str]:
    """Sentences to stand beside torques and friction. `figures` "part.figure" may have several values."""
    yield from remark_outside(system)
    yield from remark_asperities(system, figures)


def remark_asperities(system: System, figures: Mapping[Any, Any]) -> Iterator[str]:
    """That friction depends on default asperities; nothing of a system without friction."""
    if list_losses(system):
        yield from remark_soft(list_soft(system, find_film_ratios(figures)))


def find_film_ratios(figures: Mapping[Any, Any]) -> dict[str, float]:
    """The least film ratio of each part among figures "part.figure"."""
    found = dict[str, float]()
    for name, values in figures.items():
        part, _, figure = str(name).rpartition(".")
        if figure == "least_film_ratio":
            ratios = np.asarray(values, float)
            found[part] = float(np.min(ratios, where=np.isfinite(ratios), initial=np.inf))
    return found


def list_soft(system: System, ratios: Mapping[str, float]) -> list[str]:
    """The contacts whose asperities are the default ones, and whose film ratio is below 1; not 0, as that of
    smooth or dry bodies."""
    found = []
    for name, ratio in ratios.items():
        instance = system.instances[name]
        stiff = [one for one in ASPERITIES if one in instance.component.parameters]
        if 0.0 < ratio < 1.0 and stiff and has_defaults(instance, stiff):
            found.append(name)
    return found


def remark_soft(names: Sequence[str]) -> Iterator[str]:
    """A sentence on such contacts; none without any."""
    if names:
        yield (
            f"{', '.join(names)}: the film is thinner than the roughness, and the asperities are the default "
            "ones, which are soft and bear little. With those of measured surfaces friction and wear may be "
            f"larger: set {' and '.join(ASPERITIES)} of the contact"
        )
