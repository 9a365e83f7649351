"""A valve's spring as masses on springs (Q section 1.2, K (1) to (3)), each in its own guide."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ..valve_train.valve_spring import Lumping, lumping
from .bodies import GROUND, Body, Point
from .forces import SpringDamper
from .joints import Joint, translational

COIL_INERTIA = (11.25e-9, 11.25e-9, 11.25e-9)  # K Table 1, middle of the range (kg m^2); coils do not turn
# Length of the installed spring (m). Forces along the guide do not depend on it.
SPRING_LENGTH = 0.04


class Coils(NamedTuple):
    """The parts of a spring."""

    bodies: list[Body]
    guides: list[Joint]
    springs: list[SpringDamper]


def hang_coils(
    spring: Any, valve: str, names: Sequence[str], place: Point, along: Point, displacements: Sequence[float]
) -> Coils:
    """The spring with the parameters of `valve_spring`, from the valve to its head, which is fixed.

    The closed valve is at `place` (m) and opens along the unit vector `along`; its spring has the preload
    there. Without names it is one spring without mass.
    """
    share = lumping(len(names)) if names else Lumping(1.0, 1.0, 0.0)
    installed = SPRING_LENGTH / (len(names) + 1)
    # K (1) with its lost square.
    mass = float(share.mass * spring.spring_rate / (math.pi * spring.surge_frequency) ** 2)
    start, direction = np.asarray(place, float), np.asarray(along, float)
    bodies = [
        Body(name, mass, COIL_INERTIA, tuple(start + ((i + 1) * installed + y) * direction))
        for i, (name, y) in enumerate(zip(names, displacements, strict=True))
    ]
    guides = [
        translational(f"guide of {name}", GROUND, name, at_i=place, axis_i=along, axis_j=along)
        for name in names
    ]
    head = tuple(start + SPRING_LENGTH * direction)
    chain = [valve, *names, GROUND]
    shares = [share.end_rate, *[share.inner_rate] * (len(names) - 1), *[share.end_rate] * min(1, len(names))]
    rates = [float(part * spring.spring_rate) for part in shares]
    damping = float(spring.damping_ratio / (math.pi * spring.surge_frequency))
    springs = [
        SpringDamper(
            lower, upper, rate, float(installed + spring.preload / rate), damping * rate,
            at_j=head if upper == GROUND else (0.0, 0.0, 0.0),
        )
        for lower, upper, rate in zip(chain, chain[1:], rates, strict=False)
    ]  # fmt: skip
    return Coils(bodies, guides, springs)
