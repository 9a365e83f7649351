"""Lyapunov exponents of the slider-crank's bouncing motion, per radian of crank.

Two tangent vectors are carried along the linear flow and across each impact by its saltation matrix: with
z = psi - psi_wall, an impact z' -> -e z' at z = 0 maps

    dz -> -e dz,    dz' -> -e dz' + (e z''_before + z''_after) dz / z'_before,

of determinant e^2. Hence the exponents' exact sum -lambda/a + 2 N ln e/(2 pi), N impacts a cycle.
A motion that slides forgets its past (its second exponent is -infinity) and is refused.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from ..component import Component, Events
from ..integrator import FAILURES, OK
from ..kernel import kernel
from ..quantities import Layout, Quantity, Vector
from .equations import (
    Mechanism,
    flight_acceleration,
    inertia,
    rebound,
    stiffness,
    thesis_mechanism,
    wall_acceleration,
    wall_angle,
    wall_rate,
)

# Rebound per radian below which a pressed slider is taken to slide, as in the component.
SLIDES = 1e-8
# Places in the state.
TANGENTS, IMPACTS, SLID = slice(2, 6), 6, 7


@dataclass
class TangentParameters:
    xi: Annotated[float, Quantity("1", "crank radius / rod length")] = 0.0
    alpha: Annotated[float, Quantity("1", "rod mass / piston mass")] = 0.0
    beta: Annotated[float, Quantity("1", "rod inertia / (piston mass * rod length^2)")] = 0.0
    forcing_beta: Annotated[float, Quantity("1", "beta in the forcing")] = 0.0
    damping: Annotated[float, Quantity("1", "F's lambda")] = 0.0
    gap: Annotated[float, Quantity("1", "F's rho: clearance / rod length")] = 0.01
    restitution: Annotated[float, Quantity("1", "coefficient of restitution e")] = 0.9


@dataclass
class TangentState:
    psi: Annotated[float, Quantity("rad", "deviation of the rod", nominal=1e-2)] = 0.0
    psi_rate: Annotated[float, Quantity("1", "its derivative by crank angle", nominal=1e-2)] = 0.0
    first_psi: Annotated[float, Quantity("1", "first tangent vector")] = 1.0
    first_rate: Annotated[float, Quantity("1", "first tangent vector")] = 0.0
    second_psi: Annotated[float, Quantity("1", "second tangent vector")] = 0.0
    second_rate: Annotated[float, Quantity("1", "second tangent vector")] = 1.0
    impacts: Annotated[float, Quantity("1", "impacts", count=True)] = 0.0
    slid: Annotated[float, Quantity("1", "came to slide; walls are off since", boolean=True)] = 0.0


@dataclass
class TangentInputs:
    crank_angle: Annotated[float, Quantity("rad", "crank angle")] = 0.0


@dataclass
class TangentOutputs:
    psi: Annotated[float, Quantity("rad", "deviation of the rod")] = 0.0


@kernel
def mechanism(p: TangentParameters) -> Mechanism:
    return Mechanism(p.xi, p.alpha, p.beta, p.forcing_beta, p.damping)


@kernel
def derivative(t: float, x: TangentState, u: TangentInputs, p: TangentParameters, dx: TangentState) -> None:
    m = mechanism(p)
    a, c = inertia(m), stiffness(u.crank_angle, m)
    dx.psi = x.psi_rate
    dx.psi_rate = flight_acceleration(u.crank_angle, 1.0, 0.0, x.psi, x.psi_rate, m)
    dx.first_psi = x.first_rate
    dx.first_rate = -(m.damping * x.first_rate + c * x.first_psi) / a
    dx.second_psi = x.second_rate
    dx.second_rate = -(m.damping * x.second_rate + c * x.second_psi) / a
    dx.impacts = 0.0
    dx.slid = 0.0


@kernel
def guards(t: float, x: TangentState, u: TangentInputs, p: TangentParameters, g: Vector) -> None:
    wall = wall_angle(u.crank_angle, p.gap, p.xi)
    g[0] = wall - x.psi if x.slid == 0.0 else 1.0
    g[1] = wall + x.psi if x.slid == 0.0 else 1.0


@kernel
def transition(k: int, t: float, x: TangentState, u: TangentInputs, p: TangentParameters) -> None:
    side = 1.0 if k == 0 else -1.0
    m, e = mechanism(p), p.restitution
    wall = wall_angle(u.crank_angle, side * p.gap, m.xi)
    rate = wall_rate(u.crank_angle, 1.0, wall, m.xi)
    of_wall = wall_acceleration(u.crank_angle, 1.0, 0.0, wall, m.xi)
    before = x.psi_rate
    after = rebound(before, rate, e)
    z2_before = flight_acceleration(u.crank_angle, 1.0, 0.0, wall, before, m) - of_wall
    z2_after = flight_acceleration(u.crank_angle, 1.0, 0.0, wall, after, m) - of_wall
    shear = (e * z2_before + z2_after) / (before - rate)
    x.first_rate = -e * x.first_rate + shear * x.first_psi
    x.first_psi = -e * x.first_psi
    x.second_rate = -e * x.second_rate + shear * x.second_psi
    x.second_psi = -e * x.second_psi
    x.psi_rate = after
    # Inside by two units of rounding.
    x.psi = wall - side * 4.4e-16 * abs(wall)
    x.impacts += 1.0
    if abs(after - rate) < SLIDES and side * z2_after > 0.0:
        x.slid = 1.0


@kernel
def output(t: float, x: TangentState, u: TangentInputs, p: TangentParameters, y: TangentOutputs) -> None:
    y.psi = x.psi


@kernel
def energy(t: float, x: TangentState, u: TangentInputs, p: TangentParameters, e: Vector) -> None:
    e[:] = 0.0


def tangent_flow() -> Component:
    """Dimensionless motion with two tangent vectors; the crank turns at unit speed."""
    return Component(
        name="slider_crank_tangent",
        description="Slider-crank with clearance in F's dimensionless form, with two tangent vectors",
        parameters=Layout(TangentParameters),
        state=Layout(TangentState),
        inputs=Layout(TangentInputs),
        outputs=Layout(TangentOutputs),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={},
        events=Events(2, guards, transition),
    )


class Exponents(NamedTuple):
    """Lyapunov exponents per radian, and what their sum must be for the impacts that happened."""

    largest: float
    second: float
    exact_sum: float
    impacts_per_cycle: float


def lyapunov_exponents(
    damping: float,
    gap: float,
    restitution: float = 0.9,
    *,
    corrected: bool = False,
    cycles: int = 2000,
    transient: int = 200,
) -> Exponents:
    """Exponents of the thesis engine over `cycles` revolutions after `transient` ones."""
    flow = tangent_flow()
    m = thesis_mechanism(damping, corrected)
    p = flow.parameters.vector({**m._asdict(), "gap": gap, "restitution": restitution})
    x, U = flow.state.vector(), flow.input_polynomial()
    U[1] = 1.0
    work, u, y = np.zeros(flow.work_size), np.zeros(1), np.zeros(1)
    growth = np.zeros(2)
    impacts = 0.0
    for cycle in range(transient + cycles):
        if cycle == transient:
            growth[:] = 0.0
            impacts = x[IMPACTS]
        # Every cycle begins at time zero: the flow is periodic, and time keeps its resolution.
        status = flow.step(0.0, 2.0 * math.pi, x, U, p, flow.state.nominal, work, u, y)
        if status != OK:
            raise ArithmeticError(f"cycle {cycle + 1}: {FAILURES[status]}")
        if x[SLID] != 0.0:
            raise ValueError(
                f"damping = {damping:g}, gap = {gap:g}: the motion slides in cycle {cycle + 1}; "
                "exponents exist for bouncing motion only"
            )
        q, r = np.linalg.qr(x[TANGENTS].reshape(2, 2).T)
        growth += np.log(np.abs(np.diag(r)))
        x[TANGENTS] = q.T.ravel()
    radians = 2.0 * math.pi * cycles
    per_cycle = (x[IMPACTS] - impacts) / cycles
    exact = -damping / inertia(m) + 2.0 * per_cycle * math.log(restitution) / (2.0 * math.pi)
    return Exponents(growth[0] / radians, growth[1] / radians, exact, per_cycle)
