"""A mass that falls on a massless spring stop, split between force and displacement.

    m y'' = F - m g                                          (falling_mass)
    F = max(0, k c - d y') for c > 0, else 0;  c = y_s - y   (spring_stop)

The stop pushes only. It has no mass: as soon as it no longer pushes it has lost the mass, and it is in its
place again when the mass comes back. Without damping the motion repeats exactly: parabola, then an arc of
a sine. A damper takes hold at once, so that with d > 0 the force jumps when the mass touches.
`exact.bouncing_mass` has the solution and the instants of touch and release.
"""

from dataclasses import dataclass
from typing import Annotated

from .. import kinds
from ..compile.kernel import kernel
from ..core.component import Component, PowerBond
from ..core.quantities import Vector, layouts

Position = Annotated[float, kinds.PLACE.of("height of the mass")]
Velocity = Annotated[float, kinds.VELOCITY.of("upward velocity of the mass")]


@dataclass
class FallingMassParameters:
    mass: float = kinds.MASS("mass", 1.0, positive=True)
    gravity: float = kinds.ACCELERATION("gravity", 9.81, nominal=10.0, minimum=0.0)


@dataclass
class MassState:
    position: Position = 0.1
    velocity: Velocity = 0.0


@dataclass
class MassInputs:
    force: float = kinds.SIDE_FORCE("upward force on the mass")


@dataclass
class MassOutputs:
    position: Position = 0.0
    velocity: Velocity = 0.0


@dataclass
class SpringStopParameters:
    stiffness: float = kinds.STIFFNESS("stiffness k", 1e4, nominal=1e4, positive=True)
    damping: float = kinds.DAMPING("damping d", nominal=10.0)
    stop_position: float = kinds.PLACE("height y_s of the free stop")


@dataclass
class StopState:
    impulse: float = kinds.IMPULSE("integral of the force")


@dataclass
class StopInputs:
    position: Position = 0.0
    velocity: Velocity = 0.0


@dataclass
class StopOutputs:
    force: float = kinds.SIDE_FORCE("upward force on the mass")
    compression: float = kinds.DISTANCE("compression c of the stop; negative: the gap")
    contact_margin: float = kinds.DISTANCE("lesser of c and c - d y'/k: the stop pushes where it is positive")
    impulse: float = kinds.IMPULSE("integral of the force")


@kernel
def mass_derivative(t: float, x: MassState, u: MassInputs, p: FallingMassParameters, dx: MassState) -> None:
    dx.position = x.velocity
    dx.velocity = u.force / p.mass - p.gravity


@kernel
def mass_output(t: float, x: MassState, u: MassInputs, p: FallingMassParameters, y: MassOutputs) -> None:
    y.position = x.position
    y.velocity = x.velocity


@kernel
def mass_energy(t: float, x: MassState, u: MassInputs, p: FallingMassParameters, e: Vector) -> None:
    e[0] = p.mass * (0.5 * x.velocity**2 + p.gravity * x.position)
    e[1] = e[2] = 0.0


@kernel
def compression(u: StopInputs, p: SpringStopParameters) -> float:
    return p.stop_position - u.position


@kernel
def contact_margin(u: StopInputs, p: SpringStopParameters) -> float:
    c = compression(u, p)
    return min(c, c - p.damping / p.stiffness * u.velocity)


@kernel
def push(u: StopInputs, p: SpringStopParameters) -> float:
    if contact_margin(u, p) <= 0.0:
        return 0.0
    return p.stiffness * compression(u, p) - p.damping * u.velocity


@kernel
def stop_derivative(t: float, x: StopState, u: StopInputs, p: SpringStopParameters, dx: StopState) -> None:
    dx.impulse = push(u, p)


@kernel
def stop_output(t: float, x: StopState, u: StopInputs, p: SpringStopParameters, y: StopOutputs) -> None:
    y.force = push(u, p)
    y.compression = compression(u, p)
    y.contact_margin = contact_margin(u, p)
    y.impulse = x.impulse


@kernel
def stop_energy(t: float, x: StopState, u: StopInputs, p: SpringStopParameters, e: Vector) -> None:
    """A stop that has lost the mass while it was compressed relaxes without giving anything back."""
    spring = p.stiffness * max(0.0, compression(u, p))
    e[0] = 0.5 * spring**2 / p.stiffness
    e[1] = (spring - push(u, p)) * u.velocity
    e[2] = 0.0


def falling_mass() -> Component:
    """A mass under gravity and a force."""
    return Component(
        name="falling_mass",
        description="Mass under gravity and a force",
        **layouts(FallingMassParameters, MassState, MassInputs, MassOutputs),
        derivative=mass_derivative,
        output=mass_output,
        energy=mass_energy,
        feedthrough={},
        bonds=(PowerBond("force", "velocity", +1),),
    )


def spring_stop() -> Component:
    """A massless spring and damper that pushes a mass away."""
    motion = ("position", "velocity")
    return Component(
        name="spring_stop",
        description="Massless spring and damper that a mass falls on",
        **layouts(SpringStopParameters, StopState, StopInputs, StopOutputs),
        derivative=stop_derivative,
        output=stop_output,
        energy=stop_energy,
        feedthrough={"force": motion, "compression": ("position",), "contact_margin": motion},
        bonds=(PowerBond("force", "velocity", -1),),
        resting=(),
        event_indicators=("contact_margin",),
    )
