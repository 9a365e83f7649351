"""A contact with a solved film, stepped as a master does it."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from models.contact.ehl_line_contact import ehl_line_contact
from models.core.component import Component
from models.core.integrator import OK
from models.core.quantities import Vector

NODES = 101

_made = functools.cache(ehl_line_contact)


class Contact:
    """An ehl_line_contact; `inputs` are functions of time, linear in a step."""

    def __init__(self, film: float = 1e-6, nodes: int = NODES, **parameters: float) -> None:
        self.nodes = nodes
        self.component: Component = _made(nodes)
        c = self.component
        self.p = c.parameters.vector(parameters)
        self.x = c.state.vector({"film_thickness": film})
        self.work = np.zeros(c.work_size)
        self.y = np.zeros(c.outputs.size)
        self.t = 0.0

    def step(self, h: float, **inputs: Any) -> int:
        c = self.component
        U = c.input_polynomial()
        for name, f in inputs.items():
            start, end = (f(self.t), f(self.t + h)) if callable(f) else (f, f)
            U[:2, c.inputs.index(name)] = start, (end - start) / h
        u = np.zeros(c.inputs.size)
        status = int(c.step(self.t, h, self.x, U, self.p, c.state.nominal, self.work, u, self.y))
        self.t += h if status == OK else 0.0
        return status

    def __getitem__(self, output: str) -> float:
        return float(self.y[self.component.outputs.index(output)])

    def field(self, name: str) -> Vector:
        first = self.component.state.index(f"{name}[1]")
        return self.x[first : first + self.nodes]
