"""What a heated film's contact has besides: parameters, outputs, and its temperatures among the states."""

from dataclasses import dataclass
from typing import Any

from ...compile.kernel import kernel
from ...core.quantities import Quantity
from ..mixed_lubrication import build_traction
from ..records import HEAT_CAPACITY, OIL_CONDUCTIVITY, TEMPERATURE_VISCOSITY, HeatParameters
from ..rheology import Thermal
from .shear import SOLID_LAYERS, HeatLaws
from .workspace import Workspace

# More layers make no picture better, and each costs time.
FEWEST_LAYERS, MOST_LAYERS = 4, 64
# Ten times the usual tolerance of the film, in whose factors a tenth of what temperatures change is left.
SETTLED = 1e-3


TEMPERATURE = Quantity("K", nominal=300.0)


@dataclass
class FilmHeatParameters(HeatParameters):
    temperature_viscosity: float = TEMPERATURE_VISCOSITY.default(0.03)
    oil_conductivity: float = OIL_CONDUCTIVITY.default(0.14)
    oil_heat_capacity: float = HEAT_CAPACITY("heat capacity rho c of the oil", 1.7e6)
    thermal_expansion: float = Quantity(
        "1/K", "fall epsilon of the oil's density with the temperature", nominal=1e-3, minimum=0.0
    ).default(7e-4)


@dataclass
class FilmHeatOutputs:
    film_temperature: float = TEMPERATURE("largest temperature in the film")
    surface_temperature: float = TEMPERATURE("largest temperature of the bodies' surfaces")


def check_layers(layers: int) -> None:
    """ValueError for a number of layers that a film cannot have."""
    if layers != 0 and not FEWEST_LAYERS <= layers <= MOST_LAYERS:
        raise ValueError(
            f"layers = {layers}: must be 0 (isothermal) or {FEWEST_LAYERS} to {MOST_LAYERS}; take 8"
        )


@kernel
def build_heat(p: Any) -> HeatLaws:
    """The laws of a heated film's parameters."""
    return HeatLaws(
        Thermal(p.oil_temperature, p.temperature_viscosity), p.thermal_expansion, p.oil_heat_capacity,
        p.oil_conductivity, p.heat_capacity_1, p.conductivity_1, p.heat_capacity_2, p.conductivity_2,
        build_traction(p), SETTLED,
    )  # fmt: skip


@kernel
def build_no_heat(p: Any) -> HeatLaws:
    """The laws of an isothermal film's parameters."""
    return HeatLaws(Thermal(0.0, 0.0), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, build_traction(p), 0.0)


def laws_of(layers: int) -> Any:
    """What builds the laws from the parameters of a contact with so many layers."""
    return build_heat if layers else build_no_heat


@kernel
def keep_heat(x: Any, time_step: float, part: float, w: Workspace) -> None:
    """Temperatures and their rates into the state, `time_step` (s) after those that it has; 0: by a jump. The
    last stage, of that part of the step, began with those in w.heat.slope."""
    for i in range(x.temperature.shape[0]):
        change = w.heat.flat[i] - w.heat.slope[i]
        x.temperature_slope[i] = change / (part * time_step) if time_step > 0.0 else 0.0
        x.temperature[i] = w.heat.flat[i]
    rise = w.heat.rise
    rows = rise.shape[1]
    film, surface = 0.0, 0.0
    for i in range(rise.shape[0] if rows > 0 else 0):
        for r in range(SOLID_LAYERS, rows - SOLID_LAYERS):
            film = max(film, rise[i, r])
        surface = max(surface, rise[i, SOLID_LAYERS - 1], rise[i, rows - SOLID_LAYERS])
    x.film_rise_rate = (film - x.film_rise) / time_step if time_step > 0.0 else 0.0
    x.surface_rise_rate = (surface - x.surface_rise) / time_step if time_step > 0.0 else 0.0
    x.film_rise, x.surface_rise = film, surface
