"""The components in this process, as what the FMUs must agree with to the last bit; and inputs for both."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from models.catalogue import find_factory
from models.core.component import Component
from models.core.integrator import OK
from tests.models.stepped import Stepped

COEFFICIENTS = 4


class Reference(Stepped):
    """A component of the catalogue stepped directly, with the sizes that its FMU has without others."""

    def __init__(self, name: str, start_time: float = 0.0, **structure: int) -> None:
        super().__init__(find_factory(name)(**structure))
        c, self.t = self.component, start_time
        self.du, self.yd, self.e = np.zeros(c.inputs.size), np.zeros(c.outputs.size), np.zeros(3)
        self.rated = [not f.quantity.discrete for f in c.outputs.fields]
        self.rates_work = np.zeros(c.rates_work_size)

    def set_inputs(self, values: Mapping[str, float]) -> None:
        for name, value in values.items():
            stem, order = split(name)
            self.U[order, self.component.inputs.index(stem)] = value
        self.u[:], self.du[:] = self.U[0], self.U[1]
        self.component.flat_output(self.t, self.x, self.u, self.p, self.y)

    def step(self, h: float) -> int:
        status = super().step(h)
        assert status == OK
        self.du[:] = self.U[1] + h * (self.U[2] + h * self.U[3] / 2.0)
        return status

    def rates(self) -> list[float]:
        """Those of continuous outputs."""
        c = self.component
        c.flat_rates(self.t, self.x, self.u, self.du, self.p, self.rates_work, self.yd)
        return self.yd[self.rated].tolist()

    def outputs(self) -> list[float]:
        """Outputs, their rates, energies."""
        self.component.flat_energy(self.t, self.x, self.u, self.p, self.e)
        return [*self.y.tolist(), *self.rates(), *self.e.tolist()]


def split(name: str) -> tuple[str, int]:
    """`torque_der2[1]` is derivative 2 of `torque[1]`."""
    stem, bracket, index = name.partition("[")
    base, _, order = stem.partition("_der")
    return base + bracket + index, int(order or 0)


def joined(name: str, order: int) -> str:
    """The name of derivative `order` of an input."""
    stem, bracket, index = name.partition("[")
    return name if order == 0 else f"{stem}_der{order}{bracket}{index}"


def wave(component: Component, t: float) -> dict[str, float]:
    """Smooth inputs and their three derivatives at time t; a crank turns steadily."""
    values: dict[str, float] = {}
    for j, field in enumerate(component.inputs.fields):
        if field.name == "crank_angle":
            derivatives = [100.0 * t, 100.0, 0.0, 0.0]
        elif field.name == "crank_speed":
            derivatives = [100.0, 0.0, 0.0, 0.0]
        elif component.name == "slider_crank":
            derivatives = [0.0, 0.0, 0.0, 0.0]
        else:
            size, w, phase = 0.4 * field.quantity.nominal, 900.0, float(j)
            derivatives = [size * w**k * math.sin(w * t + phase + 0.5 * math.pi * k) for k in range(4)]
            derivatives[0] += field.start
        values |= {joined(field.name, order): derivatives[order] for order in range(COEFFICIENTS)}
    return values


def held(values: Mapping[str, float]) -> dict[str, float]:
    """The same with all derivatives zero."""
    return {name: value if split(name)[1] == 0 else 0.0 for name, value in values.items()}


def schedule(component: Component, steps: int, h: float) -> list[dict[str, Any]]:
    """Steps with held and with varying inputs, of one and of changing size: a list of (t, h, inputs)."""
    t, found = 0.0, []
    for i in range(steps):
        size = h * (1.0 + 0.5 * math.sin(i)) if i >= steps // 2 else h
        values = wave(component, t)
        found.append({"t": t, "h": size, "inputs": values if i % 3 else held(values)})
        t += size
    return found
