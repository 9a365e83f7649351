"""Flywheel: the rotor that drives the mechanisms, free under torques or at a prescribed speed."""

import math
from dataclasses import dataclass

from . import kinds
from .compile.kernel import kernel
from .core import roles
from .core.component import NO_EVENT, Component, PowerBond, check_sizes
from .core.integrator import TOLERANCE
from .core.quantities import Condition, Quantity, Vector, layouts
from .plausible import RAMP, SPEED

FREE, PRESCRIBED = 0.0, 1.0
IF_PRESCRIBED = Condition(("motion",), ("prescribed",))
LINEAR, SMOOTH = 0.0, 1.0


@dataclass
class Parameters:
    motion: float = kinds.NUMBER(
        "free under its torques, or turning as prescribed", PRESCRIBED, choices=("free", "prescribed")
    )
    inertia: float = kinds.INERTIA("moment of inertia", 0.1, nominal=0.1)
    initial_speed: float = kinds.SPEED(
        "prescribed speed before the ramp", 1000.0 * math.pi / 30.0, plausible=SPEED,
        only=Condition(("motion",), ("prescribed",), instead="start.speed"),
    )  # fmt: skip
    final_speed: float = kinds.SPEED(
        "prescribed speed after the ramp", 1000.0 * math.pi / 30.0, same_as="initial_speed", plausible=SPEED,
        only=IF_PRESCRIBED,
    )  # fmt: skip
    ramp_start: float = kinds.TIME("time at which the ramp begins", plausible=RAMP, only=IF_PRESCRIBED)
    ramp_duration: float = kinds.TIME(
        "length of the ramp", 1.0, positive=True, plausible=RAMP, only=IF_PRESCRIBED
    )
    ramp_shape: float = kinds.NUMBER(
        "linear in time, or smooth (3 r^2 - 2 r^3)", LINEAR, choices=("linear", "smooth"), only=IF_PRESCRIBED
    )
    throw: Vector = kinds.PHASE.each("angle by which a crank throw lags the shaft", "throws")


@dataclass
class State:
    angle: float = kinds.ANGLE("angle of the shaft")
    speed: float = kinds.SPEED(
        "speed of the free shaft",
        1000.0 * math.pi / 30.0,
        plausible=SPEED,
        only=Condition(("motion",), ("free",), instead="parameters.initial_speed"),
    )


@dataclass
class Inputs:
    drive_torque: float = kinds.TORQUE("torque on the free shaft")
    load_torque: Vector = kinds.TORQUE.each("torque taken by a driven mechanism", "loads")
    load_impulse: Vector = Quantity(
        "N.m.s", "sum of the angular impulses taken in impacts by a mechanism", nominal=0.1, size="loads"
    ).per_element()


@dataclass
class Outputs:
    angle: float = kinds.ANGLE("angle of the shaft")
    speed: float = kinds.SPEED("speed of the shaft")
    acceleration: float = kinds.ANGULAR_ACCELERATION("angular acceleration of the shaft")
    supplied_torque: float = kinds.TORQUE("torque that the drive gives (what the prescribed motion needs)")
    throw_angle: Vector = kinds.ANGLE.each("angle of a crank throw", "throws")
    next_event: float = kinds.TIME(
        "time at which the ramp next begins or ends; 1e30 if it does not", NO_EVENT
    )


@kernel
def ramp_speed(t: float, p: Parameters) -> float:
    r = min(1.0, max(0.0, (t - p.ramp_start) / p.ramp_duration))
    if p.ramp_shape == SMOOTH:
        r = r * r * (3.0 - 2.0 * r)
    return p.initial_speed + (p.final_speed - p.initial_speed) * r


@kernel
def ramp_acceleration(t: float, p: Parameters) -> float:
    r = (t - p.ramp_start) / p.ramp_duration
    if r < 0.0 or r >= 1.0:
        return 0.0
    slope = 6.0 * r * (1.0 - r) if p.ramp_shape == SMOOTH else 1.0
    return (p.final_speed - p.initial_speed) * slope / p.ramp_duration


@kernel
def load(u: Inputs) -> float:
    total = 0.0
    for i in range(len(u.load_torque)):
        total += u.load_torque[i]
    return total


@kernel
def acceleration(t: float, u: Inputs, p: Parameters) -> float:
    if p.motion == PRESCRIBED:
        return ramp_acceleration(t, p)
    return (u.drive_torque - load(u)) / p.inertia


@kernel
def shaft_speed(t: float, x: State, u: Inputs, p: Parameters) -> float:
    if p.motion == PRESCRIBED:
        return ramp_speed(t, p)
    impulse = 0.0
    for i in range(len(u.load_impulse)):
        impulse += u.load_impulse[i]
    return x.speed - impulse / p.inertia


@kernel
def derivative(t: float, x: State, u: Inputs, p: Parameters, dx: State) -> None:
    dx.angle = shaft_speed(t, x, u, p)
    dx.speed = acceleration(t, u, p)


@kernel
def supplied_torque(t: float, u: Inputs, p: Parameters) -> float:
    if p.motion == PRESCRIBED:
        return p.inertia * ramp_acceleration(t, p) + load(u)
    return u.drive_torque


@kernel
def next_event(t: float, p: Parameters) -> float:
    """Nearer to an end of the ramp than the integrator's tolerance the speed is that at the end."""
    if p.motion != PRESCRIBED or p.initial_speed == p.final_speed:
        return NO_EVENT
    reached = t + TOLERANCE * (abs(t) + p.ramp_duration)
    if p.ramp_start > reached:
        return p.ramp_start
    end = p.ramp_start + p.ramp_duration
    return end if end > reached else NO_EVENT


@kernel
def output(t: float, x: State, u: Inputs, p: Parameters, y: Outputs) -> None:
    y.angle = x.angle
    y.speed = shaft_speed(t, x, u, p)
    y.acceleration = acceleration(t, u, p)
    y.supplied_torque = supplied_torque(t, u, p)
    for i in range(len(y.throw_angle)):
        y.throw_angle[i] = x.angle - p.throw[i]
    y.next_event = next_event(t, p)


@kernel
def energy(t: float, x: State, u: Inputs, p: Parameters, e: Vector) -> None:
    speed = shaft_speed(t, x, u, p)
    e[0] = 0.5 * p.inertia * speed**2
    e[1] = 0.0
    e[2] = supplied_torque(t, u, p) * speed


def flywheel(loads: int = 1, throws: int = 1) -> Component:
    """J w' = T_drive - sum of load torques when free; w(t) given by the ramp when prescribed.

    Impacts in the mechanisms take angular impulses at instants: the free shaft's speed is the state less
    their sum over J, so that an impulse needs no event here. (The impact itself is computed by its
    mechanism with the crank's speed just before, as is right for J much larger than the mechanism's own.)
    Crank throws turn with the shaft, each its angle `throw` behind.
    """
    check_sizes(loads=loads, throws=throws)
    sizes = {"loads": loads, "throws": throws}
    records = layouts(Parameters, State, Inputs, Outputs, sizes)
    inputs = records["inputs"].names
    torques = tuple(name for name in inputs if name.startswith("load_torque"))
    impulses = tuple(name for name in inputs if name.startswith("load_impulse"))
    return Component(
        name="flywheel",
        description="Rotor under drive and load torques, or at a prescribed speed",
        roles=(roles.Drive(),),
        **records,
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={
            "speed": impulses,
            "acceleration": ("drive_torque", *torques),
            "supplied_torque": ("drive_torque", *torques),
        },
        bonds=tuple(PowerBond(name, "speed", -1) for name in torques),
        structure=sizes,
        resting=(),
        next_event="next_event",
    )
