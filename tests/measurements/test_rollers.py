"""The approach of a roller and its raceway, which Palmgren measured."""

import pytest

from models.contact.hertz import deflection, elastic_compliance

from .page import MEASURED, Published


@pytest.mark.plain
@pytest.mark.parametrize("load", [100.0, 1000.0, 10000.0])
def test_a_roller_and_its_raceway_approach_as_measured(load: float, published) -> None:
    """3.84e-5 Q^0.9/L^0.8 in mm, N."""
    length, radius = 10e-3, 10e-3
    measured = 3.84e-5 * load**0.9 / (1e3 * length) ** 0.8
    steel = elastic_compliance(206e9, 0.3, 206e9, 0.3)
    case = Published(
        "Contact and film", f"approach of a steel roller and its raceway at {load:g} N (um)",
        "length and radius 10 mm; band: 15 %, the share of the radius (3 to 30 mm), which the formula lacks",
        MEASURED, 0.85e3 * measured, 1.15e3 * measured,
        "Palmgren (1959), Ball and Roller Bearing Engineering; Harris, Rolling Bearing Analysis",
        1e3 * measured,
    )  # fmt: skip
    published(case, 1e6 * deflection(load, radius, length, steel), "a formula fitted to tests of rollers")
