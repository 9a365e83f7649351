"""Pressure and film across a solved contact, read from its states.

No variable of the component shows them: they are 2 x `nodes` numbers at every instant.
"""

from dataclasses import dataclass

import numpy as np

from ...core.component import Component
from ...core.quantities import Vector
from .field_state import build_bodies
from .grid import node_positions
from .mixed import fill_total


@dataclass(frozen=True)
class Profiles:
    """What n instants have at so many nodes; each array is (n, nodes).

    `position` (m) is measured from the middle of the contact along the entraining velocity; `pressure` (Pa)
    is that of film and asperities, `film` (m) the mean gap of the surfaces.
    """

    position: Vector
    pressure: Vector
    film: Vector


def read_profiles(component: Component, parameters: Vector, states: Vector) -> Profiles:
    """The profiles of `states` (n, size of the state); all zero where the field has not begun."""
    nodes = int(component.structure["nodes"])
    X, bodies = node_positions(nodes), build_bodies(component.parameters.view(parameters))
    shape = (len(states), nodes)
    found = Profiles(np.zeros(shape), np.zeros(shape), np.zeros(shape))
    for row, state in enumerate(states):
        x = component.state.view(np.ascontiguousarray(state))
        found.position[row], found.film[row] = x.grid_scale * X, x.film
        if x.grid_scale > 0.0:
            fill_total(x.pressure, x.film, bodies, found.pressure[row])
    return found
