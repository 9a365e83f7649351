"""A contact with a solved film, stepped as a master does it, and its field alone."""

import functools
from typing import Any

import numpy as np

from models.contact.ehl_line_contact import ehl_line_contact
from models.contact.fluid import Lubricant
from models.contact.line.cavities import start_filling
from models.contact.line.mixed import Bodies
from models.contact.line.shear import HeatLaws
from models.contact.line.transient import Drives, place_film, step, wanted_scale
from models.contact.line.workspace import workspace_in, workspace_size
from models.core.quantities import Vector

from ...stepped import Stepped

NODES = 101

_made = functools.cache(ehl_line_contact)


class Contact(Stepped):
    """An ehl_line_contact; `inputs` of a step are functions of time, linear in it."""

    def __init__(
        self,
        film: float = 1e-6,
        nodes: int = NODES,
        layers: int = 0,
        mass_conserving: int = 0,
        **parameters: float,
    ) -> None:
        made = _made(nodes, layers=layers, mass_conserving=mass_conserving)
        super().__init__(made, parameters, {"film_thickness": film})
        self.nodes = nodes

    def step(self, h: float, **inputs: Any) -> int:
        self.U = self.component.input_polynomial()
        for name, f in inputs.items():
            start, end = (f(self.t), f(self.t + h)) if callable(f) else (f, f)
            self.input(name, start, (end - start) / h)
        return super().step(h)

    def field(self, name: str) -> Vector:
        first = self.component.state.index(f"{name}[1]")
        return self.x[first : first + self.nodes]


class Film:
    """Pressure and film that begin as Hertz's over a gap; the code of their steps serves any grid."""

    def __init__(
        self, nodes: int, layers: int, load: float, gap: float, radius: float, bodies: Bodies,
        fluid: Lubricant, laws: HeatLaws, supply: float,
    ) -> None:  # fmt: skip
        self.bodies, self.fluid, self.laws, self.supply = bodies, fluid, laws, supply
        self.w = workspace_in(np.zeros(workspace_size(nodes, layers)), nodes, layers)
        self.p, self.h, self.slope = np.zeros((3, nodes))
        self.scale, self.approach = wanted_scale(load / bodies.length, gap, radius, bodies), 0.0
        place_film(load, gap, radius, bodies, self.w.X, self.scale, self.p, self.h)
        if supply >= 0.0:
            start_filling(self.p, self.h, supply, self.w.filling)

    def step(self, h: float, scale: float, *drives: Drives) -> None:
        """To a grid of that scale (m); drives at the start and at both stages."""
        taken = step(
            self.p, self.h, self.slope, self.scale, scale, h, *drives, 1e9, self.bodies, self.fluid,
            self.laws, self.w,
        )  # fmt: skip
        assert taken.error <= 1.0
        self.scale, self.approach = taken.scale, taken.approach
