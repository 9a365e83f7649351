"""A contact with a solved film, stepped as a master does it."""

import functools
from typing import Any

from models.contact.ehl_line_contact import ehl_line_contact
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
