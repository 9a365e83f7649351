"""Where a contact's film and friction have a meaning."""

import numpy as np
from numpy.typing import NDArray

from models.core.quantities import Vector

# Film variables of a contact.
FILMS = ("film_thickness", "minimum_film_thickness", "steady_film_thickness", "film_ratio")
# Of the contact's largest load. Under less, asperities alone hold the surfaces apart: film_ratio rises
# without bound as the load goes to zero, within a microsecond of touch or separation.
LIGHT = 0.01
# Of the largest sliding velocity. Below it a contact is at rest but for elastic vibrations: boundary friction
# has its full size, and a sign that they change at random.
AT_REST = 1e-3


def has_film(variable: str, load: Vector) -> NDArray[np.bool_]:
    """Rows in which one of FILMS has a meaning: under load; film_ratio under more than a LIGHT one of its
    cycle, the last axis."""
    light = LIGHT * np.max(load, axis=-1, keepdims=True, initial=0.0) if variable == "film_ratio" else 0.0
    return np.asarray(load > light)


def slides(velocity: Vector) -> NDArray[np.bool_]:
    """Rows in which friction has a sign."""
    size = np.abs(velocity)
    return np.asarray(size >= AT_REST * float(np.max(size, initial=0.0)))
