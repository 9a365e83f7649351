"""Measured viscosities of mineral oils over temperature, and how they grow with pressure."""

import math

import numpy as np
import pytest
from scipy.optimize import fsolve

from models.contact.oils import ZERO_CELSIUS, Oil, density, kinematic_viscosity, pressure_viscosity

from .page import MEASURED, Published

TEMPERATURES = (30.0, 60.0, 100.0)  # degC
# Viscosity index: density at 15 degC, typical (the source has none); then viscosities in mPa s and
# coefficients in 1/GPa at these temperatures.
OILS = {
    "high": (880.0, [
        ((38.0, 12.1, 5.3), (None, 18.4, 13.4)),
        ((153.0, 34.0, 9.1), (23.7, 20.5, 15.8)),
        ((250.0, 50.5, 12.6), (25.0, 21.3, 17.6)),
        ((810.0, 135.0, 26.8), (34.0, 28.0, 22.0)),
    ]),
    "medium": (890.0, [
        ((18.6, 6.3, 2.4), (20.0, 16.0, 13.0)),
        ((45.0, 12.0, 3.9), (28.0, 20.0, 16.0)),
        ((107.0, 23.3, 6.4), (29.6, 22.8, 17.8)),
        ((122.0, 26.3, 7.3), (27.0, 21.6, 17.5)),
        ((171.0, 31.0, 7.5), (28.0, 23.0, 18.0)),
    ]),
    "low": (915.0, [
        ((30.7, 8.6, 3.1), (25.7, 20.3, 15.4)),
        ((165.0, 30.0, 6.8), (33.0, 23.8, 16.0)),
        ((310.0, 44.2, 9.4), (34.6, 26.3, 19.5)),
        ((2000.0, 180.0, 24.0), (41.5, 29.4, 25.0)),
    ]),
}  # fmt: skip
SOURCE = "Stachowiak and Batchelor, Engineering Tribology, table 2.3, after Cameron"
CONDITIONS = "13 mineral oils by viscosities at 30 and 100 degC, density 880 to 915 kg/m3 by viscosity index"


def viscosity(oil: Oil, celsius: float) -> float:
    """In mPa s."""
    kelvin = ZERO_CELSIUS + celsius
    return 1e3 * kinematic_viscosity(oil, kelvin) * density(oil, kelvin)


def find_oil(at_30: float, at_100: float, density_15: float) -> Oil:
    """The oil with these viscosities (mPa s)."""

    def differences(logs: np.ndarray) -> list[float]:
        oil = Oil(*map(float, np.exp(logs)), density_15)
        return [math.log(viscosity(oil, t) / e) for t, e in ((30.0, at_30), (100.0, at_100))]

    start = np.log([0.5e-3 * at_30 / density_15, 1.1e-3 * at_100 / density_15])
    return Oil(*map(float, np.exp(fsolve(differences, start))), density_15)


@pytest.mark.plain
def test_oils_thin_with_heat_and_thicken_under_pressure(published) -> None:
    ratios = np.full((13, 4), np.nan)  # ours over measured: coefficients at three temperatures, viscosity
    row = 0
    for density_15, oils in OILS.values():
        for viscosities, coefficients in oils:
            oil = find_oil(viscosities[0], viscosities[2], density_15)
            ratios[row, 3] = viscosity(oil, 60.0) / viscosities[1]
            for column, (t, measured) in enumerate(zip(TEMPERATURES, coefficients, strict=True)):
                if measured:
                    ratios[row, column] = 1e9 * pressure_viscosity(oil, ZERO_CELSIUS + t) / measured
            row += 1
    interpolation = "Walther's equation, of which ASTM D341 states some per cent"
    case = Published(
        "Contact and film", "viscosity at 60 degC, ours over measured, mean of 13 oils", CONDITIONS, MEASURED,
        0.95, 1.05, SOURCE, 1.0,
    )  # fmt: skip
    published(case, np.nanmean(ratios[:, 3]), f"{interpolation}; one oil is off by 12 %, the others by 6 %")
    why = {
        30.0: "So and Klaus' correlation, a fit to other oils, is too high for cold, thick ones: one by 37 %",
        60.0: "single oils from 4 % too low to 23 % too high",
        100.0: "engine oils' temperature: single oils from 8 % too low to 14 % too high",
    }
    for column, t in enumerate(TEMPERATURES):
        case = Published(
            "Contact and film",
            f"pressure-viscosity coefficient at {t:g} degC, ours over measured, mean",
            f"{CONDITIONS}; band: 15 %, by which oils of one viscosity differ (three of 153 to 171 mPa s)",
            MEASURED, 0.85, 1.15, SOURCE, 1.0,
        )  # fmt: skip
        ours = np.nanmean(ratios[:, column])
        published(case, ours, why[t], inside=t > 30.0)
