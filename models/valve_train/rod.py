"""Slender rod between two bodies: pushrod or valve stem, as finite segments.

Qin and Zuo 2000: N equal rigid segments of mass m/N, springs of rate A E/l between neighbours at the
distance l, and springs of twice that rate at both ends. So the static rate A E/L is exact for every N.
"""

from dataclasses import dataclass

from .. import kinds
from ..compile.kernel import kernel
from ..core import roles
from ..core.component import Component, PowerBond, check_sizes
from ..core.integrator import FINE_TOLERANCE
from ..core.quantities import Quantity, Vector, layouts
from ..plausible import AREA
from .shared import EndMotions


@dataclass
class RodParameters:
    """Defaults: a steel pushrod of 200 mm."""

    length: float = kinds.LENGTH("length of the rod", 0.2)
    area: float = Quantity(
        "m2", "cross-section of the rod", nominal=5e-5, positive=True, display_unit="mm2", plausible=AREA
    ).default(50e-6)
    youngs_modulus: float = kinds.YOUNGS_MODULUS("Young's modulus of the rod", 207e9)
    density: float = Quantity("kg/m3", "density of the rod", nominal=7850.0, positive=True).default(7850.0)
    damping_time: float = kinds.TIME("damping of the rod over its stiffness", 5e-6, nominal=5e-6, minimum=0.0)
    bonded: float = kinds.SWITCH("the ends also pull; false: they only push, and may part")
    clearance: float = kinds.PLACE(
        "gap at the upper end, at rest", nominal=1e-4, minimum=0.0, display_unit="mm"
    )
    gravity: float = kinds.GRAVITY.default()


@dataclass
class RodState:
    displacement: Vector = kinds.DISPLACEMENT.each(
        "displacement of a segment, from the lower end", "segments"
    )
    velocity: Vector = kinds.VELOCITY.each("velocity of a segment", "segments")


@dataclass
class RodOutputs:
    lower_force: float = kinds.FORCE("force on the body below, which it presses down")
    upper_force: float = kinds.FORCE("force on the body above, which it presses up")
    lower_compression: float = kinds.DEFLECTION("compression of the lower end")
    upper_compression: float = kinds.DEFLECTION("compression of the upper end")


@kernel
def end_force(stiffness: float, compression: float, rate: float, p: RodParameters) -> float:
    """k (e + tau e'); an end that is not bonded never pulls."""
    force = stiffness * (compression + p.damping_time * rate)
    if p.bonded == 0.0 and (compression <= 0.0 or force < 0.0):
        return 0.0
    return force


def rod(segments: int = 4) -> Component:
    """A rod of `segments` segments."""
    check_sizes(segments=segments)
    n = segments

    @kernel
    def inner_stiffness(p: RodParameters) -> float:
        return p.youngs_modulus * p.area * n / p.length

    @kernel
    def lower_compression(x: RodState, u: EndMotions) -> float:
        return u.lower_position - x.displacement[0]

    @kernel
    def upper_compression(x: RodState, u: EndMotions, p: RodParameters) -> float:
        return x.displacement[n - 1] - u.upper_position - p.clearance

    @kernel
    def lower_force(x: RodState, u: EndMotions, p: RodParameters) -> float:
        rate = u.lower_velocity - x.velocity[0]
        return end_force(2.0 * inner_stiffness(p), lower_compression(x, u), rate, p)

    @kernel
    def upper_force(x: RodState, u: EndMotions, p: RodParameters) -> float:
        rate = x.velocity[n - 1] - u.upper_velocity
        return end_force(2.0 * inner_stiffness(p), upper_compression(x, u, p), rate, p)

    @kernel
    def derivative(t: float, x: RodState, u: EndMotions, p: RodParameters, dx: RodState) -> None:
        mass, stiffness = p.density * p.area * p.length / n, inner_stiffness(p)
        below = lower_force(x, u, p)
        for i in range(n):
            if i < n - 1:
                compression = x.displacement[i] - x.displacement[i + 1]
                above = stiffness * (compression + p.damping_time * (x.velocity[i] - x.velocity[i + 1]))
            else:
                above = upper_force(x, u, p)
            dx.displacement[i] = x.velocity[i]
            dx.velocity[i] = (below - above) / mass - p.gravity
            below = above

    @kernel
    def output(t: float, x: RodState, u: EndMotions, p: RodParameters, y: RodOutputs) -> None:
        y.lower_force = lower_force(x, u, p)
        y.upper_force = upper_force(x, u, p)
        y.lower_compression = lower_compression(x, u)
        y.upper_compression = upper_compression(x, u, p)

    @kernel
    def energy(t: float, x: RodState, u: EndMotions, p: RodParameters, e: Vector) -> None:
        """What an end that is not bonded does not give back of k e^2/2 is lost."""
        mass, stiffness = p.density * p.area * p.length / n, inner_stiffness(p)
        stored, lost = 0.0, 0.0
        for i in range(n):
            stored += mass * (0.5 * x.velocity[i] ** 2 + p.gravity * x.displacement[i])
            if i < n - 1:
                rate = x.velocity[i] - x.velocity[i + 1]
                stored += 0.5 * stiffness * (x.displacement[i] - x.displacement[i + 1]) ** 2
                lost += stiffness * p.damping_time * rate * rate
        low, high = lower_compression(x, u), upper_compression(x, u, p)
        if p.bonded == 0.0:
            low, high = max(0.0, low), max(0.0, high)
        stored += stiffness * (low * low + high * high)
        lost += (lower_force(x, u, p) - 2.0 * stiffness * low) * (u.lower_velocity - x.velocity[0])
        lost += (upper_force(x, u, p) - 2.0 * stiffness * high) * (x.velocity[n - 1] - u.upper_velocity)
        e[0], e[1], e[2] = stored, lost, 0.0

    sizes = {"segments": n}
    return Component(
        tolerance=FINE_TOLERANCE,
        name="rod",
        description="Slender rod of finite segments: pushrod or valve stem",
        roles=(roles.Rod(),),
        **layouts(RodParameters, RodState, EndMotions, RodOutputs, sizes),
        derivative=derivative,
        output=output,
        energy=energy,
        feedthrough={
            "lower_force": ("lower_position", "lower_velocity"),
            "upper_force": ("upper_position", "upper_velocity"),
            "lower_compression": ("lower_position",),
            "upper_compression": ("upper_position",),
        },
        bonds=(
            PowerBond("lower_force", "lower_velocity", +1),
            PowerBond("upper_force", "upper_velocity", -1),
        ),
        structure=sizes,
        event_indicators=("lower_compression", "upper_compression"),
    )
