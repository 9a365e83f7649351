"""Wires of springs: elasticity, and the strength of a diameter.

Tensile strength A/d^m, moduli: Budynas and Nisbett, Shigley's Mechanical Engineering Design, tables 10-4 and
10-5. Fatigue: Goodman's line through the shear stresses of endless life that Zimmerli (1957) found for all
such wires alike, with the shear strength 0.67 of the tensile one (Shigley, section 10-9).
"""

from dataclasses import dataclass
from typing import TypeVar

from ..core.quantities import Vector

Stress = TypeVar("Stress", float, Vector)
MPA = 1e6
DENSITY = 7850.0
# Amplitude and mean of the shear stress (Pa) that wires bear without end: peened, and as they are.
PEENED, UNPEENED = (398.0 * MPA, 534.0 * MPA), (241.0 * MPA, 379.0 * MPA)
SHEAR_SHARE = 0.67


@dataclass(frozen=True)
class Fatigue:
    """Goodman's line of shear stresses (Pa): the amplitude that is borne at no mean, and the mean alone."""

    amplitude: float
    mean: float

    def use(self, amplitude: Stress, mean: Stress) -> Stress:
        """The share of the strength that these stresses take: 1 over the safety."""
        return amplitude / self.amplitude + mean / self.mean


@dataclass(frozen=True)
class Material:
    """`strength` (Pa) is the tensile strength of a wire of 1 mm, which falls with d to the `exponent`."""

    shear_modulus: float
    strength: float
    exponent: float
    density: float = DENSITY
    endless: tuple[float, float] = PEENED

    def tensile_strength(self, diameter: float) -> float:
        return self.strength * (1e3 * diameter) ** -self.exponent

    def fatigue(self, diameter: float) -> Fatigue:
        """ValueError if the wire is weaker than what it should bear without end."""
        amplitude, mean = self.endless
        shear = SHEAR_SHARE * self.tensile_strength(diameter)
        if not shear > mean:
            raise ValueError(
                f"the shear strength is {SHEAR_SHARE:g} of the tensile strength, {shear / MPA:.4g} MPa: must "
                f"be above the mean stress {mean / MPA:g} MPa that is borne without end"
            )
        return Fatigue(amplitude / (1.0 - mean / shear), shear)


MATERIALS = {
    "chrome-silicon": Material(77.2e9, 1974.0 * MPA, 0.108),
    "chrome-vanadium": Material(77.2e9, 2005.0 * MPA, 0.168),
    "oil-tempered": Material(77.2e9, 1855.0 * MPA, 0.187),
    "music-wire": Material(80.0e9, 2211.0 * MPA, 0.145),
}
