"""Allowed ranges of what bodies and force elements are made of."""

import math
from typing import NamedTuple

from ..core.errors import ModelError


class Allowed(NamedTuple):
    """From `low`, which is allowed itself if `with_low`, to `high`."""

    low: float
    high: float
    unit: str
    with_low: bool = False

    def holds(self, number: float) -> bool:
        above = number >= self.low if self.with_low else number > self.low
        return above and number <= self.high and math.isfinite(number)

    def __str__(self) -> str:
        limit = f"not above {self.high:g}" if math.isfinite(self.high) else "finite"
        return f"{'from' if self.with_low else 'above'} {self.low:g} and {limit} {self.unit}".rstrip()


# Wide enough for any machine, narrow enough to find values in mm, MPa, GPa or t/m3.
RANGES = {
    "length": Allowed(0.0, 100.0, "m"),
    "diameter": Allowed(0.0, 10.0, "m"),
    "area": Allowed(0.0, 100.0, "m2"),
    "arm": Allowed(0.0, 100.0, "m"),
    "radius": Allowed(0.0, 100.0, "m", with_low=True),
    "film": Allowed(0.0, 1e-2, "m"),
    "mass": Allowed(0.0, math.inf, "kg", with_low=True),
    "youngs_modulus": Allowed(1e5, 1e13, "Pa"),
    "poissons_ratio": Allowed(-1.0, 0.5, ""),
    "density": Allowed(10.0, 1e5, "kg/m3"),
    "shear_factor": Allowed(0.0, 10.0, "", with_low=True),
    "damping_time": Allowed(0.0, 1.0, "s", with_low=True),
    "damping_ratio": Allowed(0.0, 10.0, "", with_low=True),
    "stiffness": Allowed(0.0, math.inf, "N/m", with_low=True),
    "damping": Allowed(0.0, math.inf, "N s/m", with_low=True),
    "free_length": Allowed(-100.0, 100.0, "m"),
    "tilt": Allowed(-0.5 * math.pi, 0.5 * math.pi, "rad"),
}


def check_values(thing: str, **values: float) -> None:
    """ModelError for the first value that is no finite number in its range."""
    for name, value in values.items():
        allowed = RANGES[name]
        if not allowed.holds(value):
            shown = f"{value:g} {allowed.unit}".rstrip()
            raise ModelError(f"{thing}: {name} = {shown}: must be {allowed}; give it in SI units")
