"""Two masses joined by a spring and a damper, split between force and displacement.

    m x'' = -k x - d x' + F      (sprung_mass: the force of the coupling comes in)
    M X'' = -K X - D X' - F,     F = k_12 (X - x) + d_12 (X' - x')      (coupled_mass: it goes out)

The coupling's spring belongs to `coupled_mass`, which is given the other mass's position and velocity. With
k = K = 0 the pair is free. `exact.two_masses` has the solution.
"""

from dataclasses import dataclass
from typing import Annotated

from .. import kinds
from ..compile.kernel import kernel
from ..core.component import Component, PowerBond
from ..core.quantities import Vector, layouts

Mass = Annotated[float, kinds.MASS.of("mass", positive=True)]
Stiffness = Annotated[float, kinds.STIFFNESS.of("spring to the ground", nominal=10.0, minimum=0.0)]
Damping = Annotated[float, kinds.DAMPING.of("damper to the ground")]
Position = Annotated[float, kinds.PLACE.of("position", nominal=1.0)]
Velocity = Annotated[float, kinds.VELOCITY.of("velocity")]


@dataclass
class SprungMassParameters:
    mass: Mass = 1.0
    stiffness: Stiffness = 10.0
    damping: Damping = 0.5


@dataclass
class CoupledMassParameters:
    mass: Mass = 1.0
    stiffness: Stiffness = 10.0
    damping: Damping = 0.5
    coupling_stiffness: float = kinds.STIFFNESS("spring to the other mass", 40.0, nominal=10.0, minimum=0.0)
    coupling_damping: float = kinds.DAMPING("damper to the other mass", 1.0)


@dataclass
class MassState:
    position: Position = 0.0
    velocity: Velocity = 0.0


@dataclass
class SprungInputs:
    force: float = kinds.FRICTION("force on the mass")


@dataclass
class CoupledInputs:
    other_position: float = kinds.PLACE("position of the other mass", nominal=1.0)
    other_velocity: float = kinds.VELOCITY("velocity of the other mass")


@dataclass
class CoupledOutputs:
    force: float = kinds.FRICTION("force on the other mass")
    position: Position = 0.0
    velocity: Velocity = 0.0


@kernel
def sprung_derivative(
    t: float, x: MassState, u: SprungInputs, p: SprungMassParameters, dx: MassState
) -> None:
    dx.position = x.velocity
    dx.velocity = (u.force - p.stiffness * x.position - p.damping * x.velocity) / p.mass


@kernel
def sprung_output(t: float, x: MassState, u: SprungInputs, p: SprungMassParameters, y: MassState) -> None:
    y.position = x.position
    y.velocity = x.velocity


@kernel
def sprung_energy(t: float, x: MassState, u: SprungInputs, p: SprungMassParameters, e: Vector) -> None:
    e[0] = 0.5 * (p.mass * x.velocity**2 + p.stiffness * x.position**2)
    e[1] = p.damping * x.velocity**2
    e[2] = 0.0


@kernel
def coupling_force(x: MassState, u: CoupledInputs, p: CoupledMassParameters) -> float:
    spring = p.coupling_stiffness * (x.position - u.other_position)
    return spring + p.coupling_damping * (x.velocity - u.other_velocity)


@kernel
def coupled_derivative(
    t: float, x: MassState, u: CoupledInputs, p: CoupledMassParameters, dx: MassState
) -> None:
    dx.position = x.velocity
    force = p.stiffness * x.position + p.damping * x.velocity + coupling_force(x, u, p)
    dx.velocity = -force / p.mass


@kernel
def coupled_output(
    t: float, x: MassState, u: CoupledInputs, p: CoupledMassParameters, y: CoupledOutputs
) -> None:
    y.force = coupling_force(x, u, p)
    y.position = x.position
    y.velocity = x.velocity


@kernel
def coupled_energy(t: float, x: MassState, u: CoupledInputs, p: CoupledMassParameters, e: Vector) -> None:
    stretch, rate = x.position - u.other_position, x.velocity - u.other_velocity
    elastic = p.stiffness * x.position**2 + p.coupling_stiffness * stretch**2
    e[0] = 0.5 * (p.mass * x.velocity**2 + elastic)
    e[1] = p.damping * x.velocity**2 + p.coupling_damping * rate**2
    e[2] = 0.0


def sprung_mass() -> Component:
    """A mass on a spring and damper to the ground, driven by a force."""
    return Component(
        name="sprung_mass",
        description="Mass on a spring and damper to the ground, driven by a force",
        **layouts(SprungMassParameters, MassState, SprungInputs, MassState),
        derivative=sprung_derivative,
        output=sprung_output,
        energy=sprung_energy,
        feedthrough={},
        bonds=(PowerBond("force", "velocity", +1),),
    )


def coupled_mass() -> Component:
    """A mass like `sprung_mass`, with the spring and damper that couple it to another mass."""
    return Component(
        name="coupled_mass",
        description="Mass on springs and dampers to the ground and to another mass, which moves as given",
        **layouts(CoupledMassParameters, MassState, CoupledInputs, CoupledOutputs),
        derivative=coupled_derivative,
        output=coupled_output,
        energy=coupled_energy,
        feedthrough={"force": ("other_position", "other_velocity")},
        bonds=(PowerBond("force", "other_velocity", -1),),
    )
