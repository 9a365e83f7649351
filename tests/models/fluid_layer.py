"""A layer of fluid between a moving plate and a wall, in many sheets: a component with an own advance.

Stokes' second problem with a wall, thinned after Eyring: m v_i' = F_i - F_(i+1) for sheets of mass m, with
the force F = A tau_0 asinh(eta (v_(i-1) - v_i) / (d tau_0)) over a distance d between neighbours, half of it
to plate and wall. The sheets' velocities are internal states. The advance is the implicit midpoint rule, of
second order and exact for the balance of a quadratic energy, solved by fixed-point iteration.
"""

import math
from dataclasses import dataclass
from typing import Any

from models.compile.kernel import kernel, record_of
from models.core.component import Component, PowerBond
from models.core.integrator import NOT_CONVERGED, OK, taylor
from models.core.quantities import Quantity, Vector, layouts

# The last change over the velocities' nominal size: ten thousand roundings.
CONVERGED = 1e-12


@dataclass
class Parameters:
    """A bath of oil, 10 cm deep below 1 dm2, whose thousandth is crossed by momentum in 0.2 ms."""

    area: float = Quantity("m2", "area A", nominal=1e-2, positive=True).default(1e-2)
    thickness: float = Quantity("m", "thickness of the layer", nominal=0.1, positive=True).default(0.1)
    density: float = Quantity("kg/m3", "density", nominal=1e3, positive=True).default(870.0)
    viscosity: float = Quantity("Pa.s", "viscosity eta", nominal=1e-2, positive=True).default(0.036)
    eyring_stress: float = Quantity("Pa", "Eyring stress tau_0", nominal=100.0, positive=True).default(100.0)
    iterations: float = Quantity("1", "iterations allowed", count=True, minimum=1).default(30.0)


@dataclass
class State:
    sheet_velocity: Vector = Quantity("m/s", "velocity", size="sheets", internal=True).per_element()
    impulse: float = Quantity("N.s", "integral of the force on the plate", nominal=1e-3).default()


@dataclass
class Inputs:
    velocity: float = Quantity("m/s", "velocity of the plate").default()


@dataclass
class Outputs:
    force: float = Quantity("N", "force on the plate").default()
    wall_force: float = Quantity("N", "force on the wall").default()
    impulse: float = Quantity("N.s", "integral of the force on the plate", nominal=1e-3).default()


@kernel
def gap(p: Any, sheets: int, wide: bool) -> float:
    """Distance of neighbours, or of plate or wall from the next sheet, or of these two (m)."""
    if sheets == 0:
        return p.thickness
    return p.thickness / sheets * (1.0 if wide else 0.5)


@kernel
def drag(p: Any, sheets: int, wide: bool, slip: float) -> float:
    """Force between neighbours (`wide`), or between plate or wall and the next sheet (N)."""
    distance = gap(p, sheets, wide)
    return p.area * p.eyring_stress * math.asinh(p.viscosity * slip / (distance * p.eyring_stress))


def fluid_layer(sheets: int = 3) -> Component:
    """With so many sheets; without any, the layer has no inertia. See the module."""
    n = sheets

    @kernel
    def difference(x: Any, u: Any, i: int) -> float:
        """The velocity of what lies above surface i (0: the plate's) less that of what lies below."""
        above = u.velocity if i == 0 else x.sheet_velocity[i - 1]
        return above - (x.sheet_velocity[i] if i < n else 0.0)

    @kernel
    def force(x: Any, u: Any, p: Any, i: int) -> float:
        return drag(p, n, 0 < i < n, difference(x, u, i))

    @kernel
    def derivative(t: float, x: State, u: Inputs, p: Parameters, dx: State) -> None:
        mass = p.density * p.area * p.thickness / max(n, 1)
        for i in range(n):
            dx.sheet_velocity[i] = (force(x, u, p, i) - force(x, u, p, i + 1)) / mass
        dx.impulse = -force(x, u, p, 0)

    @kernel
    def output(t: float, x: State, u: Inputs, p: Parameters, y: Outputs) -> None:
        y.force = -force(x, u, p, 0)
        y.wall_force = force(x, u, p, n)
        y.impulse = x.impulse

    @kernel
    def energy(t: float, x: State, u: Inputs, p: Parameters, e: Any) -> None:
        mass = p.density * p.area * p.thickness / max(n, 1)
        e[0] = e[1] = e[2] = 0.0
        for i in range(n):
            e[0] += 0.5 * mass * x.sheet_velocity[i] ** 2
        for i in range(n + 1):
            slip = difference(x, u, i)
            e[1] += slip * drag(p, n, 0 < i < n, slip)

    sizes = {"sheets": n}
    return Component(
        name="fluid_layer",
        description="Layer of fluid between a plate and a wall",
        **layouts(Parameters, State, Inputs, Outputs, sizes),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={"force": ("velocity",)},
        bonds=(PowerBond("force", "velocity", -1),),
        structure=sizes,
        advance_maker=make_midpoint,
    )


def make_midpoint(component: Component) -> Any:
    """advance(t, h, x, U, p, scale, work) -> status by the implicit midpoint rule, v = x + h/2 f(v)."""
    n = component.structure["sheets"]
    derivative, P, sample = component.flat_derivative, component.parameters.dtype, component.sample

    @kernel
    def nothing(w: float, t: float, s: float, x: Any, U: Any, u: Any, p: Any, work: Any) -> None:
        return

    sampled = nothing if sample is None else sample

    @kernel
    def advance(t: float, h: float, x: Any, U: Any, p: Any, scale: Any, work: Any) -> int:
        middle, f, u = work[: n + 1], work[n + 1 : 2 * n + 2], work[2 * n + 2 : 2 * n + 3]
        taylor(U, 0.5 * h, u)
        middle[:] = x
        for _ in range(int(record_of(p, P).iterations)):
            derivative(t + 0.5 * h, middle, u, p, f)
            largest = 0.0
            for i in range(n):
                change = x[i] + 0.5 * h * f[i] - middle[i]
                middle[i] += change
                largest = max(largest, abs(change) / scale[i])
            if largest <= CONVERGED:
                derivative(t + 0.5 * h, middle, u, p, f)
                sampled(h, t, 0.5 * h, middle, U, u, p, work)
                for i in range(n):
                    x[i] = 2.0 * middle[i] - x[i]
                x[n] += h * f[n]
                return OK
        return NOT_CONVERGED

    return advance
