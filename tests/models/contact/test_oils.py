"""Oils: Walther's equation, bands of grades, measured oils, and the limits of the correlations."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.contact.oil_grades import ENGINE_OILS, GRADES, INDUSTRIAL_OILS, SAE_J300, SHEARED_40
from models.contact.oils import (
    COLDEST,
    HOTTEST,
    SLOPES,
    Oil,
    density,
    evaluate_oil,
    kinematic_viscosity,
    pressure_viscosity,
    temperature_viscosity,
)


def celsius(degrees: float) -> float:
    return 273.15 + degrees


def kinematic(oil: Oil, degrees: float) -> float:
    """In mm2/s."""
    return 1e6 * kinematic_viscosity(oil, celsius(degrees))


@st.composite
def draw_oils(draw: st.DrawFn) -> Oil:
    at_40 = draw(st.floats(15.0, 700.0))
    slope = draw(st.floats(*SLOPES))
    at_100 = 10.0 ** (math.log10(at_40 + 0.7) * (313.15 / 373.15) ** slope) - 0.7
    return Oil(1e-6 * at_40, 1e-6 * at_100, draw(st.floats(800.0, 950.0)))


OILS = draw_oils()
TEMPERATURES = st.floats(COLDEST, HOTTEST)


@given(OILS)
def test_the_viscosity_goes_through_the_two_points_of_the_sheet(oil):
    assert kinematic_viscosity(oil, celsius(40.0)) == pytest.approx(oil.viscosity_40, rel=1e-12)
    assert kinematic_viscosity(oil, celsius(100.0)) == pytest.approx(oil.viscosity_100, rel=1e-12)
    assert density(oil, celsius(15.0)) == oil.density_15


@given(OILS, TEMPERATURES, TEMPERATURES)
def test_viscosity_and_density_fall_with_the_temperature(oil, one, other):
    cold, hot = sorted((one, other))
    assert kinematic_viscosity(oil, cold) >= kinematic_viscosity(oil, hot)
    assert density(oil, cold) >= density(oil, hot)


@given(OILS, TEMPERATURES)
def test_the_temperature_coefficient_is_the_slope_of_the_viscosity(oil, temperature):
    """Central differences over 0.1 K: their error is some 1e-5."""
    steps = (temperature + 0.05, temperature - 0.05)
    up, down = (math.log(kinematic_viscosity(oil, t) * density(oil, t)) for t in steps)
    assert temperature_viscosity(oil, temperature) == pytest.approx((down - up) / 0.1, rel=1e-4)


@pytest.mark.parametrize("name", ENGINE_OILS)
def test_engine_oils_lie_within_their_grade(name):
    """SAE J300. The polymers of an oil only lose viscosity in shear: unsheared it is above the limit, too."""
    oil, (winter, _, number) = ENGINE_OILS[name], name.removeprefix("SAE ").rpartition("-")
    band = SAE_J300[number]
    sheared = SHEARED_40 if number == "40" and winter not in ("0W", "5W", "10W") else band.sheared
    assert band.low <= oil.viscosity_100 < band.high
    assert kinematic_viscosity(oil, celsius(150.0)) * density(oil, celsius(150.0)) >= sheared


# ASTM D2270 writes L and H as parabolas of the viscosity at 100 degC: its largest value (mm2/s), L, H.
VISCOSITY_INDEX = (
    (3.8, (1.14673, 1.7576, -0.109), (0.84155, 1.5521, -0.077)),
    (4.4, (3.38095, -15.4952, 33.196), (0.78571, 1.7929, -0.183)),
    (5.0, (2.50000, -7.2143, 13.812), (0.82143, 1.5679, 0.119)),
    (6.4, (0.10100, 16.6350, -45.469), (0.04985, 9.1613, -18.557)),
    (7.0, (3.35714, -23.5643, 78.466), (0.22619, 7.7369, -16.656)),
    (7.7, (0.01191, 21.4750, -72.870), (0.79762, -0.7321, 14.610)),
    (9.0, (0.41858, 16.1558, -56.040), (0.05794, 10.5156, -28.240)),
    (12.0, (0.88779, 7.5527, -16.600), (0.26665, 6.7015, -10.810)),
    (15.0, (0.76720, 10.7972, -38.180), (0.20073, 8.4658, -22.490)),
    (18.0, (0.97305, 5.3135, -2.200), (0.28889, 5.9741, -4.930)),
    (22.0, (0.97256, 5.2500, -0.980), (0.24504, 7.4160, -16.730)),
    (28.0, (0.91413, 7.4759, -21.820), (0.20323, 9.1267, -34.230)),
    (40.0, (0.87031, 9.7157, -50.770), (0.18411, 10.1015, -46.750)),
)


def find_index(at_40: float, at_100: float) -> float:
    """Viscosity index of ASTM D2270, procedure A; viscosities in mm2/s. Of its example 92.43."""
    _, low, high = next(row for row in VISCOSITY_INDEX if at_100 <= row[0])
    L, H = np.polyval(low, at_100), np.polyval(high, at_100)
    return float(100.0 * (L - at_40) / (L - H))


@pytest.mark.parametrize("name", INDUSTRIAL_OILS)
def test_industrial_oils_have_the_viscosity_of_their_grade_and_an_index_of_95(name, record):
    oil = INDUSTRIAL_OILS[name]
    assert 1e6 * oil.viscosity_40 == float(name.removeprefix("ISO VG "))
    assert find_index(73.30, 8.86) == pytest.approx(92.43, abs=0.05)
    index = find_index(1e6 * oil.viscosity_40, 1e6 * oil.viscosity_100)
    record("Contact", "viscosity index of ISO VG 32 to 460", index, 95.0, "ASTM D2270", tolerance=0.2)


@pytest.mark.parametrize("name", GRADES)
def test_the_pressure_viscosity_coefficient_falls_with_the_temperature(name):
    """Over all temperatures at which a grade is not refused; also film and friction then fall."""
    oil = GRADES[name]
    coefficients = []
    for temperature in np.arange(COLDEST, HOTTEST, 0.5):
        try:
            coefficients.append(evaluate_oil(oil, float(temperature)).pressure_viscosity)
        except ValueError:
            assert not coefficients or temperature > celsius(100.0)  # thick in the cold, thin in the heat
    assert len(coefficients) > 300
    assert np.all(np.diff(coefficients) < 0.0)


# Jones, Johnson, Winer and Sanborn (1975), ASLE Trans. 18, 249, as Hamrock's Fundamentals of Fluid Film
# Lubrication has them: mm2/s and 1/GPa at 37.8, 98.9 and 148.9 degC.
FAHRENHEIT = (37.8, 98.9, 148.9)
NAPHTHENIC = ((78.0, 8.2, 3.3), (25.1, 15.4, 12.7), 887.0)
PARAFFINIC = ((493.0, 42.6, 14.0), (17.7, 15.1, 10.9), 854.0)


def through(measured: tuple[float, ...], density_15: float) -> Oil:
    """The oil through the two lower points, moved to 40 and 100 degC by Walther's equation."""
    x = np.log10([celsius(t) for t in FAHRENHEIT[:2]])
    y = np.log10(np.log10(np.array(measured[:2]) + 0.7))
    slope = (y[1] - y[0]) / (x[1] - x[0])
    there = [10.0**10.0 ** (y[0] + slope * (math.log10(celsius(t)) - x[0])) - 0.7 for t in (40.0, 100.0)]
    return Oil(1e-6 * there[0], 1e-6 * there[1], density_15)


def test_a_measured_mineral_oil(record):
    """A super-refined naphthenic oil. Its third viscosity has two digits."""
    viscosities, coefficients, density_15 = NAPHTHENIC
    oil = through(viscosities, density_15)
    source = "measured (Jones et al. 1975)"
    quantity = "viscosity of a naphthenic oil at 149 degC, from those at 38 and 99 degC (mm2/s)"
    record("Contact", quantity, kinematic(oil, FAHRENHEIT[2]), viscosities[2], source, relative=0.08)
    for degrees, measured in zip(FAHRENHEIT, coefficients, strict=True):
        found = 1e9 * pressure_viscosity(oil, celsius(degrees))
        quantity = "pressure-viscosity coefficient of a naphthenic oil, 38 to 149 degC (1/GPa)"
        record("Contact", quantity, found, measured, source, relative=0.2)


def test_the_coefficient_of_a_synthetic_paraffinic_oil_is_overestimated():
    """By 40 to 90 %: known_limits.toml says so, and that a measured one can be given."""
    viscosities, coefficients, density_15 = PARAFFINIC
    oil = through(viscosities, density_15)
    found = [1e9 * pressure_viscosity(oil, celsius(t)) for t in FAHRENHEIT]
    assert np.all((np.array(found) / coefficients > 1.4) & (np.array(found) / coefficients < 1.9))


def test_the_page_has_the_numbers_of_all_grades():
    page = Path(__file__).parents[3] / "docs" / "how-to" / "choose-an-oil.md"
    rows = dict(re.findall(r"^\| ((?:SAE|ISO VG) [^|]+) \| (.+) \|$", page.read_text("utf-8"), re.MULTILINE))
    assert set(rows) == set(GRADES)
    for name, oil in GRADES.items():
        state = evaluate_oil(oil, celsius(90.0))
        data = f"{1e6 * oil.viscosity_40:g} | {1e6 * oil.viscosity_100:g} | {oil.density_15:g}"
        at_90 = f"{1e3 * state.viscosity:.3g} | {1e9 * state.pressure_viscosity:.3g}"
        assert rows[name] == f"{data} | {at_90}"


def test_a_measured_coefficient_replaces_the_correlation():
    oil = Oil(62e-6, 10.5e-6, 855.0)
    measured = Oil(62e-6, 10.5e-6, 855.0, 13e-9)
    one, other = (evaluate_oil(each, celsius(90.0)) for each in (oil, measured))
    assert one.pressure_viscosity != other.pressure_viscosity == 13e-9
    assert one.viscosity == other.viscosity
    assert other.roelands_exponent / one.roelands_exponent == pytest.approx(13e-9 / one.pressure_viscosity)


@pytest.mark.parametrize(
    ("name", "degrees", "message"),
    [
        ("SAE 5W-30", 200.5, "must be -20 to 200 degC"),
        ("SAE 5W-30", math.nan, "must be -20 to 200 degC"),
        ("SAE 20W-50", 0.0, "holds to 800"),
    ],
)
def test_temperatures_beyond_the_equations_are_refused(name, degrees, message):
    with pytest.raises(ValueError, match=message):
        evaluate_oil(GRADES[name], celsius(degrees))
    if degrees == 0.0:
        assert evaluate_oil(Oil(160e-6, 18.3e-6, 885.0, 2e-8), celsius(0.0)).viscosity > 1.0
    with pytest.raises(ValueError, match="less than 1"):
        evaluate_oil(Oil(5e-6, 1.7e-6, 830.0), celsius(180.0))
