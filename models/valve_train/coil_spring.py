"""Coil spring between a moving body and the fixed head: a chain of coils that surge, close and clash.

The segments have equal rates, the masses between them are equal, and the chain has the static rate k0 and the
first natural frequency f0 exactly. A segment whose gap is used up meets a stop. Where gaps differ, coils
close one after the other, and rate and natural frequency rise.
"""

import math
from dataclasses import dataclass

from .. import kinds
from ..compile.kernel import kernel
from ..core import roles
from ..core.component import Component, PowerBond, check_sizes
from ..core.integrator import FINE_TOLERANCE
from ..core.quantities import Vector, layouts
from ..plausible import PRELOAD
from .shared import CLOSED_COILS, SurgeDamping, SurgeFrequency, WireAmplitude, WireStrength, WireStress


@dataclass
class Parameters:
    """Defaults: the spring of the set `kushwaha2000`, whose coils do not close within 20 mm."""

    spring_rate: float = kinds.SPRING_RATE("static rate k0 while no coil is closed", 35e3)
    surge_frequency: SurgeFrequency = 504.5
    damping_ratio: SurgeDamping = 0.02
    preload: float = kinds.FORCE(
        "force f_p with the valve closed, at position zero",
        330.0,
        nominal=300.0,
        minimum=0.0,
        plausible=PRELOAD,
    )
    gap: Vector = kinds.DISPLACEMENT.each(
        "compression of a segment at which its coils close, from the moving end",
        "segments",
        2e-3,
        positive=True,
    )
    stop_stiffness: float = kinds.SEAT_STIFFNESS(
        "stiffness of closed coils", CLOSED_COILS, nominal=1e6, minimum=0.0
    )
    stop_damping: float = kinds.DAMPING("damping of closed coils", 20.0, nominal=10.0)
    wire_stress: WireStress = 0.0
    wire_amplitude: WireAmplitude = 0.0
    wire_strength: WireStrength = 0.0


@dataclass
class State:
    coil_position: Vector = kinds.DISPLACEMENT.each("displacement of a coil mass", "coil_masses")
    coil_velocity: Vector = kinds.VELOCITY.each("velocity of a coil mass", "coil_masses")


@dataclass
class Inputs:
    position: float = kinds.DISPLACEMENT("position of the moving end, zero with the valve closed")
    velocity: float = kinds.VELOCITY("velocity of the moving end")


@dataclass
class Outputs:
    force: float = kinds.FORCE("force on the moving end, preload included")
    least_gap: float = kinds.DISPLACEMENT(
        "travel left to coil bind, if all coils were as tight as the tightest; negative in a clash"
    )
    clash_force: float = kinds.FRICTION("largest force of a stop")
    coil_position: Vector = kinds.DISPLACEMENT.each("displacement of a coil mass", "coil_masses")


@kernel
def compress(i: int, x: State, u: Inputs) -> tuple[float, float]:
    """Compression (m) of segment i, and its rate."""
    masses = x.coil_position.size
    above = x.coil_position[i - 1] if i > 0 else u.position
    above_rate = x.coil_velocity[i - 1] if i > 0 else u.velocity
    below = x.coil_position[i] if i < masses else 0.0
    below_rate = x.coil_velocity[i] if i < masses else 0.0
    return above - below, above_rate - below_rate


@kernel
def coil_damping(p: Parameters) -> float:
    """Of a segment: c = 2 zeta/(2 pi f0) k."""
    return p.damping_ratio / (math.pi * p.surge_frequency) * p.spring_rate * p.gap.size


@kernel
def stop_force(i: int, compression: float, rate: float, p: Parameters) -> float:
    """Only pushes."""
    closed = compression - p.gap[i]
    if closed <= 0.0:
        return 0.0
    return max(0.0, p.stop_stiffness * closed + p.stop_damping * rate)


@kernel
def segment_force(i: int, x: State, u: Inputs, p: Parameters) -> float:
    compression, rate = compress(i, x, u)
    own = p.spring_rate * p.gap.size * compression + coil_damping(p) * rate
    return own + stop_force(i, compression, rate, p)


@kernel
def coil_mass(p: Parameters) -> float:
    """(N+1) k0 sin^2(pi/(2 (N+1)))/(pi f0)^2."""
    segments = p.gap.size
    sine = math.sin(0.5 * math.pi / segments)
    return segments * p.spring_rate * (sine / (math.pi * p.surge_frequency)) ** 2


@kernel
def derivative(t: float, x: State, u: Inputs, p: Parameters, dx: State) -> None:
    mass, above = coil_mass(p), segment_force(0, x, u, p)
    for i in range(x.coil_position.size):
        below = segment_force(i + 1, x, u, p)
        dx.coil_position[i] = x.coil_velocity[i]
        dx.coil_velocity[i] = (above - below) / mass
        above = below


@kernel
def output(t: float, x: State, u: Inputs, p: Parameters, y: Outputs) -> None:
    y.force = p.preload + segment_force(0, x, u, p)
    compression, rate = compress(0, x, u)
    least, y.clash_force = p.gap[0] - compression, stop_force(0, compression, rate, p)
    for i in range(x.coil_position.size):
        compression, rate = compress(i + 1, x, u)
        least = min(least, p.gap[i + 1] - compression)
        y.clash_force = max(y.clash_force, stop_force(i + 1, compression, rate, p))
        y.coil_position[i] = x.coil_position[i]
    y.least_gap = p.gap.size * least


@kernel
def energy(t: float, x: State, u: Inputs, p: Parameters, e: Vector) -> None:
    """Lost: in the coils, and what a stop does not give back of k e^2/2."""
    mass, rate_of_coils = coil_mass(p), p.spring_rate * p.gap.size
    stored, lost = p.preload * u.position, 0.0
    for i in range(p.gap.size):
        compression, rate = compress(i, x, u)
        closed = max(0.0, compression - p.gap[i])
        stored += 0.5 * rate_of_coils * compression**2 + 0.5 * p.stop_stiffness * closed**2
        lost += coil_damping(p) * rate * rate
        lost += rate * (stop_force(i, compression, rate, p) - p.stop_stiffness * closed)
    for i in range(x.coil_position.size):
        stored += 0.5 * mass * x.coil_velocity[i] ** 2
    e[0], e[1], e[2] = stored, lost, 0.0


def coil_spring(segments: int = 9) -> Component:
    """A spring of `segments` segments with a mass between each two."""
    check_sizes(segments=segments, coil_masses=segments - 1)
    sizes = {"segments": segments, "coil_masses": segments - 1}
    ends = ("position", "velocity")
    return Component(
        tolerance=FINE_TOLERANCE,
        name="coil_spring",
        description="Coil spring with surge, closing coils and clash",
        roles=(roles.CoilSpring(),),
        **layouts(Parameters, State, Inputs, Outputs, sizes),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={"force": ends, "least_gap": ("position",), "clash_force": ends},
        bonds=(PowerBond("force", "velocity", +1),),
        structure={"segments": segments},
        event_indicators=("least_gap",),
    )
