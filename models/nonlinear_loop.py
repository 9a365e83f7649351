"""An algebraic loop of three equations over two components: two planes, and a sphere that changes.

    a + b + c = p,  2 a - 3 b + n c = q           (planes: c comes in, a and b go out)
    a^2 + b^2 + c^2 = r,  r' = (r_end - r) / T    (sphere: a and b come in, c >= 0 goes out)

With p = 0, q = 9, n = 2 and r = 5 it is the loop of OMSimulator's issue 808: b = -9/5 and
c = 0.9 + sqrt(r/2 - 2.43). A sweep over both multiplies an error of c by the gain a/c of the loop.
"""

import math
from dataclasses import dataclass
from typing import Annotated

from . import kinds
from .compile.kernel import kernel
from .core.component import Component
from .core.quantities import Vector, layouts

A = Annotated[float, kinds.NUMBER.of("coordinate a of the point", nominal=0.1)]
B = Annotated[float, kinds.NUMBER.of("coordinate b of the point", nominal=0.1)]
C = Annotated[float, kinds.NUMBER.of("coordinate c of the point", nominal=0.1)]


@dataclass
class PlanesParameters:
    total: float = kinds.NUMBER("right side p of the first plane")
    normal: float = kinds.NUMBER("normal n of the second plane", 2.0)
    weighted: float = kinds.NUMBER("right side q of the second plane", 9.0, nominal=10.0)


@dataclass
class PlanesState:
    pass


@dataclass
class PlanesInputs:
    c: C = 1.0


@dataclass
class PlanesOutputs:
    a: A = 0.8
    b: B = -1.8
    square: float = kinds.NUMBER("squared distance a^2 + b^2 + c^2 from the origin", nominal=5.0)


@dataclass
class SphereParameters:
    final_square: float = kinds.NUMBER("squared radius r_end at last", 4.88, nominal=5.0, minimum=0.0)
    time_constant: float = kinds.TIME("time constant T of the radius", 0.2, positive=True)


@dataclass
class SphereState:
    square: float = kinds.NUMBER("squared radius r", 5.0, nominal=5.0, minimum=0.0)


@dataclass
class SphereInputs:
    a: A = 0.8
    b: B = -1.8


@dataclass
class SphereOutputs:
    c: C = 1.0
    square: float = kinds.NUMBER("squared radius r", nominal=5.0)


@kernel
def planes_derivative(
    t: float, x: PlanesState, u: PlanesInputs, p: PlanesParameters, dx: PlanesState
) -> None:
    pass


@kernel
def planes_output(t: float, x: PlanesState, u: PlanesInputs, p: PlanesParameters, y: PlanesOutputs) -> None:
    y.b = (2.0 * p.total - p.weighted + (p.normal - 2.0) * u.c) / 5.0
    y.a = p.total - y.b - u.c
    y.square = y.a**2 + y.b**2 + u.c**2


@kernel
def no_energy(t: float, x: PlanesState, u: PlanesInputs, p: PlanesParameters, e: Vector) -> None:
    e[:] = 0.0


@kernel
def sphere_derivative(
    t: float, x: SphereState, u: SphereInputs, p: SphereParameters, dx: SphereState
) -> None:
    dx.square = (p.final_square - x.square) / p.time_constant


@kernel
def sphere_output(t: float, x: SphereState, u: SphereInputs, p: SphereParameters, y: SphereOutputs) -> None:
    """Beyond the sphere c < 0, where the loop has no solution."""
    left = x.square - u.a**2 - u.b**2
    y.c = math.copysign(math.sqrt(abs(left)), left)
    y.square = x.square


def planes() -> Component:
    """Two planes, on whose common line a third coordinate selects a point."""
    return Component(
        name="planes",
        description="Two planes, which give two coordinates of a point for the third",
        **layouts(PlanesParameters, PlanesState, PlanesInputs, PlanesOutputs),
        derivative=planes_derivative,
        output=planes_output,
        energy=no_energy,
        feedthrough={"a": ("c",), "b": ("c",), "square": ("c",)},
    )


def sphere() -> Component:
    """A sphere about the origin, whose radius changes."""
    return Component(
        name="sphere",
        description="Sphere of changing radius, which gives the third coordinate of a point",
        **layouts(SphereParameters, SphereState, SphereInputs, SphereOutputs),
        derivative=sphere_derivative,
        output=sphere_output,
        energy=no_energy,
        feedthrough={"c": ("a", "b")},
    )
