"""A component that is stepped by hand, as a master does it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from models.core.component import Component
from models.core.integrator import OK
from models.core.quantities import Vector

Values = Mapping[str, float]


class Stepped:
    """State x, inputs' polynomials U from the start of a step on, and outputs by name."""

    def __init__(
        self,
        component: Component,
        parameters: Values | None = None,
        start: Values | None = None,
        inputs: Values | None = None,
    ) -> None:
        self.component = c = component
        self.p, self.x = c.parameters.vector(parameters), c.state.vector(start)
        self.U = c.input_polynomial()
        self.U[0] = c.inputs.vector(inputs)
        self.u, self.y, self.work = c.inputs.vector(inputs), np.zeros(c.outputs.size), np.zeros(c.work_size)
        self.t = 0.0

    def step(self, h: float) -> int:
        """The status; the time goes on where it is OK."""
        c = self.component
        status = c.step(self.t, h, self.x, self.U, self.p, c.state.nominal, self.work, self.u, self.y)
        self.t += h if status == OK else 0.0
        return int(status)

    def advance(self, h: float) -> Stepped:
        """A step that is made."""
        assert self.step(h) == OK
        return self

    def input(self, name: str, *coefficients: float) -> None:
        """The Taylor coefficients of an input, value first."""
        self.U[: len(coefficients), self.component.inputs.index(name)] = coefficients

    def rates(self, du: Vector | None = None) -> dict[str, float]:
        """Of the outputs, with rates `du` of the inputs (default: at rest)."""
        c, yd = self.component, np.zeros(self.component.outputs.size)
        du = np.zeros(c.inputs.size) if du is None else du
        c.flat_rates(self.t, self.x, self.u, du, self.p, np.zeros(c.rates_work_size), yd)
        return c.outputs.named(yd)

    def __getitem__(self, output: str) -> float:
        return float(self.y[self.component.outputs.index(output)])
