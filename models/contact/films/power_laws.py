"""Regressions in powers of the groups: h = factor R G^a U^b W^c, with E' = 2 / compliance."""

from typing import Any

from ...compile.kernel import kernel
from .groups import Conditions, groups


def power_law(factor: float, material: float, speed: float, load_power: float) -> Any:
    """The kernel of that film (m)."""

    @kernel
    def film(load: float, at: Conditions) -> float:
        g = groups(2.0 / at.compliance, load, at)
        return factor * at.radius * g.material**material * g.speed**speed * g.load**load_power

    return film


# Minimum film of Dowson and Higginson, and central film of Dowson and Toyoda.
dowson_higginson = power_law(2.65, 0.54, 0.70, -0.13)
dowson_toyoda = power_law(3.06, 0.56, 0.69, -0.10)
# Minimum and central film of Pan and Hamrock.
pan_hamrock_minimum = power_law(1.714, 0.568, 0.694, -0.128)
pan_hamrock_central = power_law(2.922, 0.470, 0.692, -0.166)
