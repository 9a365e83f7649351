"""A mass on a spring that shears a layer of fluid in many sheets, moved by its own implicit steps."""

from dataclasses import replace
from typing import Any

from models.core.system import Instance, System
from models.oscillators.two_masses import sprung_mass
from tests.models.fluid_layer import fluid_layer

PLATE = sprung_mass()
LINES = [("plate.velocity", "layer.velocity"), ("layer.force", "plate.force")]
# A swing of 14 ms, from rest.
SPRING = {"mass": 0.05, "stiffness": 1e4, "damping": 0.0}
START = {"position": 1e-3}


def dragged(sheets: int = 20, changes: dict[str, Any] | None = None, **parameters: float) -> System:
    """The system; `changes` are fields of the layer's component."""
    layer = replace(fluid_layer(sheets), **changes) if changes else fluid_layer(sheets)
    return System({"plate": Instance(PLATE, SPRING, START), "layer": Instance(layer, parameters)}, LINES)
