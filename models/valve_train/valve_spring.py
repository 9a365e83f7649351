"""Valve (with follower) on a spring whose coils are N lumped masses, with seat and lash.

Kushwaha et al. 2000 (K), section 2.3 and equations (1)-(3), (40)-(42), with the corrections: the square
of pi in (1) and the signs of (40)-(42), as printed solutions grow. N = 2 is K's spring.
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

from .. import kinds
from ..compile.kernel import kernel
from ..core import roles
from ..core.component import Component, PowerBond, check_sizes
from ..core.integrator import FINE_TOLERANCE
from ..core.quantities import Vector, layouts
from ..core.requirements import require
from ..plausible import PRELOAD, VALVE_MASS
from .shared import SurgeDamping, SurgeFrequency, WireAmplitude, WireStrength, WireStress

# A dip that is far from any event.
NO_SEAT = -1.0

COIL_POSITION = kinds.PLACE.of(
    "coil displacement y5, y6, ... from that with the valve closed", nominal=1e-3, size="coil_masses"
)


@dataclass
class ValveSpringParameters:
    """Defaults: the set `kushwaha2000`, whose follower rides on the cam at all times (no seat)."""

    valve_mass: float = kinds.MASS(
        "mass m3 of valve and follower", 0.22, nominal=0.2, positive=True, plausible=VALVE_MASS
    )
    spring_rate: float = kinds.SPRING_RATE("static rate k0 of the spring", 35e3)
    surge_frequency: SurgeFrequency = 504.5
    damping_ratio: SurgeDamping = 0.02
    preload: float = kinds.FORCE(
        "spring force f_p with the valve closed, for any lash",
        330.0,
        nominal=300.0,
        minimum=0.0,
        plausible=PRELOAD,
    )
    lash: float = kinds.LASH("follower position at which the valve sits on its seat")
    seat_stiffness: float = kinds.SEAT_STIFFNESS(
        "stiffness of the valve seat; 0: no seat", nominal=1e7, minimum=0.0
    )
    seat_damping: float = kinds.DAMPING("damping of the valve seat while touching", nominal=1e2)
    clash_clearance: float = kinds.CAM_LIFT("lift of the valve at which all coils touch", 0.02)
    clash_stiffness: float = kinds.SEAT_STIFFNESS(
        "added rate between coils that touch", nominal=1e6, minimum=0.0
    )
    wire_stress: WireStress = 0.0
    wire_amplitude: WireAmplitude = 0.0
    wire_strength: WireStrength = 0.0


@dataclass
class FollowerMotion:
    position: float = kinds.DISPLACEMENT("follower position y3, zero on the base circle")
    velocity: float = kinds.VELOCITY("follower velocity")


@dataclass
class ValveSpringState(FollowerMotion):
    coil_position: Vector = COIL_POSITION.per_element()
    coil_velocity: Vector = kinds.VELOCITY.each("coil velocity", "coil_masses")


@dataclass
class ValveSpringInputs:
    load: float = kinds.FORCE("contact load W on the follower")
    gas_force: float = kinds.FORCE("force of the gas on the valve's head, closing it")
    guide_friction: float = kinds.FRICTION("friction of the guide against the velocity")


@dataclass
class ValveSpringOutputs(FollowerMotion):
    acceleration: float = kinds.ACCELERATION("follower acceleration")
    valve_lift: float = kinds.DISPLACEMENT("valve lift: follower position less lash")
    spring_force: float = kinds.FORCE("force of the spring on the follower, preload included")
    seat_force: float = kinds.FORCE("force of the seat on the valve")
    seat_dip: float = kinds.DEFLECTION("dip of the valve into its seat; -1 m without a seat", NO_SEAT)
    least_gap: float = kinds.DISPLACEMENT(
        "travel left to coil bind, if all coils were as tight as the tightest; negative in a clash"
    )
    coil_position: Vector = COIL_POSITION.per_element()


@require(
    "lash = {0:g} m: needs a valve seat, and seat_stiffness = 0 N/m means none; give seat_stiffness, e.g. "
    "2e7 N/m, or leave lash out"
)
def has_a_seat_where_it_has_lash(p: ValveSpringParameters, numbers: Vector) -> bool:
    numbers[0] = p.lash
    return p.lash == 0.0 or p.seat_stiffness > 0.0


class Lumping(NamedTuple):
    """Spring shares by N: end rate/k0, inner rate/k0, mass pi^2 f0^2/k0."""

    end_rate: float
    inner_rate: float
    mass: float


def lumping(coil_masses: int) -> Lumping:
    """N equal masses on springs of static rate k0 whose clamped-clamped frequencies begin with f0.

    N = 2 is K (1)-(3), 8/3, 4, 2/3, which also gives 2 f0 exactly. Otherwise the masses stand in the middle
    of N equal slices of the spring, which converges to the continuous spring with 1/N^2, also in what its
    moving end feels (K's demand of 2 f0 carried on to N masses converges with N^-2/3 only: soft end springs
    would have to make up for the chain's dispersion). The second frequency is then 2 f0 cos(pi/2N).
    """
    check_sizes(coil_masses=coil_masses)
    n = float(coil_masses)
    if coil_masses == 2:
        return Lumping(8.0 / 3.0, 4.0, 2.0 / 3.0)
    return Lumping(2.0 * n, n, n * math.sin(math.pi / (2.0 * n)) ** 2)


@kernel
def segment_force(p: ValveSpringParameters, share: float, compression: float, rate: float) -> float:
    """k e + c e', and the clash rate where the segment's share of the travel is used up."""
    stiffness = share * p.spring_rate
    damping = 2.0 * p.damping_ratio / (2.0 * math.pi * p.surge_frequency) * stiffness
    clash = max(0.0, compression - p.clash_clearance / share)
    return stiffness * compression + damping * rate + p.clash_stiffness * clash


@kernel
def seat_force(p: Any, position: float, velocity: float) -> float:
    """Unilateral: pushes the valve open while it dips below the seat, never pulls."""
    dip = p.lash - position
    if dip <= 0.0:
        return 0.0
    return max(0.0, p.seat_stiffness * dip - p.seat_damping * velocity)


@kernel
def segment_energy(p: ValveSpringParameters, share: float, compression: float) -> float:
    clash = max(0.0, compression - p.clash_clearance / share)
    return 0.5 * share * p.spring_rate * compression**2 + 0.5 * p.clash_stiffness * clash**2


def valve_spring(coil_masses: int = 2) -> Component:
    """Valve and spring with `coil_masses` coil masses.

    m3 y3'' = W - f_p - f_gas - [k_e (y3-lash-y5) + c_e (y3'-y5')] + seat force - F_g, and for every coil
    mass m y'' = (force of the segment above) - (force of the segment below); the last segment ends on the
    fixed head. W is the input `load`.
    """
    n = coil_masses
    end_share, inner_share, mass_share = lumping(n)

    @kernel
    def least_gap(p: ValveSpringParameters, x: ValveSpringState) -> float:
        """The clearance less the largest compression of a segment, as travel of a spring of such segments."""
        most = end_share * max(x.position - p.lash - x.coil_position[0], x.coil_position[n - 1])
        for i in range(n - 1):
            most = max(most, inner_share * (x.coil_position[i] - x.coil_position[i + 1]))
        return p.clash_clearance - most

    @kernel
    def spring_on_follower(p: ValveSpringParameters, x: ValveSpringState) -> float:
        compression = x.position - p.lash - x.coil_position[0]
        return segment_force(p, end_share, compression, x.velocity - x.coil_velocity[0])

    @kernel
    def acceleration(x: ValveSpringState, u: ValveSpringInputs, p: ValveSpringParameters) -> float:
        seat = seat_force(p, x.position, x.velocity)
        force = u.load - u.gas_force - p.preload - spring_on_follower(p, x) + seat
        return (force - u.guide_friction) / p.valve_mass

    @kernel
    def derivative(
        t: float, x: ValveSpringState, u: ValveSpringInputs, p: ValveSpringParameters, dx: ValveSpringState
    ) -> None:
        coil_mass = mass_share * p.spring_rate / (math.pi * p.surge_frequency) ** 2
        dx.position = x.velocity
        dx.velocity = acceleration(x, u, p)
        above = spring_on_follower(p, x)
        for i in range(n):
            if i < n - 1:
                compression = x.coil_position[i] - x.coil_position[i + 1]
                rate = x.coil_velocity[i] - x.coil_velocity[i + 1]
                below = segment_force(p, inner_share, compression, rate)
            else:
                below = segment_force(p, end_share, x.coil_position[i], x.coil_velocity[i])
            dx.coil_position[i] = x.coil_velocity[i]
            dx.coil_velocity[i] = (above - below) / coil_mass
            above = below

    @kernel
    def output(
        t: float, x: ValveSpringState, u: ValveSpringInputs, p: ValveSpringParameters, y: ValveSpringOutputs
    ) -> None:
        y.position = x.position
        y.velocity = x.velocity
        y.acceleration = acceleration(x, u, p)
        y.valve_lift = x.position - p.lash
        y.spring_force = p.preload + spring_on_follower(p, x)
        y.seat_force = seat_force(p, x.position, x.velocity)
        y.seat_dip = p.lash - x.position if p.seat_stiffness > 0.0 else NO_SEAT
        y.least_gap = least_gap(p, x)
        for i in range(n):
            y.coil_position[i] = x.coil_position[i]

    @kernel
    def energy(
        t: float, x: ValveSpringState, u: ValveSpringInputs, p: ValveSpringParameters, e: Vector
    ) -> None:
        coil_mass = mass_share * p.spring_rate / (math.pi * p.surge_frequency) ** 2
        damping = 2.0 * p.damping_ratio / (2.0 * math.pi * p.surge_frequency) * p.spring_rate
        dip = max(0.0, p.lash - x.position)
        stored = 0.5 * p.valve_mass * x.velocity**2 + p.preload * x.position + 0.5 * p.seat_stiffness * dip**2
        # What the seat does not give back of k dip^2/2.
        lost = x.velocity * (p.seat_stiffness * dip - seat_force(p, x.position, x.velocity))
        above_y, above_v = x.position - p.lash, x.velocity
        for i in range(n + 1):
            share = end_share if i == 0 or i == n else inner_share
            below_y = x.coil_position[i] if i < n else 0.0
            below_v = x.coil_velocity[i] if i < n else 0.0
            stored += segment_energy(p, share, above_y - below_y) + 0.5 * coil_mass * below_v**2
            lost += share * damping * (above_v - below_v) ** 2
            above_y, above_v = below_y, below_v
        e[0], e[1], e[2] = stored, lost, 0.0

    sizes = {"coil_masses": n}
    return Component(
        tolerance=FINE_TOLERANCE,
        name="valve_spring",
        description="Valve with follower on a spring of lumped coils, with seat and lash",
        roles=(roles.Valve(), roles.LoadedSpring()),
        **layouts(ValveSpringParameters, ValveSpringState, ValveSpringInputs, ValveSpringOutputs, sizes),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={"acceleration": ("load", "gas_force", "guide_friction")},
        bonds=(
            PowerBond("load", "velocity", +1),
            PowerBond("gas_force", "velocity", -1),
            PowerBond("guide_friction", "velocity", -1),
        ),
        requirements=(has_a_seat_where_it_has_lash,),
        structure=sizes,
        event_indicators=("seat_dip", "least_gap"),
    )
