"""What is asked of a valve's springs: forces, surge, travel left to coil bind, fatigue of the wire."""

from collections.abc import Callable, Mapping

import numpy as np

from models.core.quantities import Quantity
from models.valve_train.wire_materials import Fatigue

from .motion import NONE, Figure, Found, Part, find_largest, find_least

STRESS = Quantity("Pa", "largest shear stress in the wire", display_unit="MPa")


def _surge(part: Part) -> Found:
    """Largest force of the coils' own motion: the spring's less that of its static rate."""
    static = part.parameter("preload") + part.parameter("spring_rate") * part["valve_lift"]
    return Found.largest(np.abs(part["spring_force"] - static))


def _least_gap(spring: Part) -> Found:
    """None of coils whose gaps are not computed: they stay as they are."""
    return find_least("least_gap")(spring) if np.ptp(spring["least_gap"]) else NONE


def _stress(force: str) -> Callable[[Part], Found]:
    """Of the largest force, in coils that do not touch; none of a spring whose wire is not known."""

    def find(spring: Part) -> Found:
        row, by_force = np.argmax(spring[force]), spring.parameter("wire_stress")
        return Found.at(by_force * spring[force], row) if by_force > 0.0 else NONE

    return find


def _fatigue_safety(force: str) -> Callable[[Part], Found]:
    """Goodman's line, between the least and the largest force."""

    def find(spring: Part) -> Found:
        by_force = spring.parameter("wire_stress")
        fatigue = Fatigue(spring.parameter("wire_amplitude"), spring.parameter("wire_strength"))
        if not min(by_force, fatigue.amplitude, fatigue.mean) > 0.0:
            return NONE
        low, high = by_force * float(np.min(spring[force])), by_force * float(np.max(spring[force]))
        return Found(1.0 / fatigue.use(0.5 * (high - low), 0.5 * (high + low)))

    return find


def _wire(force: str) -> Mapping[str, Figure]:
    return {
        "largest_stress": (
            Quantity("Pa", "largest shear stress in the wire", display_unit="MPa"),
            _stress(force),
        ),
        "fatigue_safety": (Quantity("1", "safety of the wire against fatigue"), _fatigue_safety(force)),
    }


SPRING: Mapping[str, Figure] = {
    "least_gap": (
        Quantity("m", "least travel left to coil bind, by the tightest coils", display_unit="mm"),
        _least_gap,
    )
}
LOADED_SPRING: Mapping[str, Figure] = {
    "largest_spring_force": (
        Quantity("N", "largest spring force"),
        find_largest("spring_force"),
    ),
    "surge_force": (Quantity("N", "largest force by surge"), _surge),
    **SPRING,
    **_wire("spring_force"),
}
COIL_SPRING: Mapping[str, Figure] = {
    **SPRING,
    "largest_clash_force": (
        Quantity("N", "largest force between coils that clash"),
        find_largest("clash_force"),
    ),
    **_wire("force"),
}
