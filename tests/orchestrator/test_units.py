"""What users write with units is converted exactly, or refused by name."""

import math

import pytest

from orchestrator.scenario.conversion import convert_units
from orchestrator.scenario.units import FACTORS, UnitError, find_conversion, to_unit


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("8 mm", "m", 8e-3),
        ("5 us", "s", 5e-6),
        ("2 µm", "m", 2e-6),
        ("1000 rpm", "rad/s", 1000.0 * math.pi / 30.0),
        ("1000 r/min", "rad/s", 1000.0 * math.pi / 30.0),
        ("20 degree", "rad", math.radians(20.0)),
        ("-20°", "rad", -math.radians(20.0)),
        ("35 kN/m", "N/m", 35e3),
        ("920 N.s/m", "N.s/m", 920.0),
        ("300 kg.mm2", "kg.m2", 3e-4),
        ("18 1/GPa", "1/Pa", 1.8e-8),
        ("36 mPa.s", "Pa.s", 0.036),
        ("5 %", "1", 0.05),
        ("1.5e-3", "m", 1.5e-3),
        ("90 degC", "K", 363.15),
        ("-10 °C", "K", 263.15),
        ("20 K", "K", 20.0),
        ("2 J/degC", "J/K", 2.0),
    ],
)
def test_conversion(text: str, unit: str, value: float) -> None:
    assert to_unit(text, unit) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "unit", "named"),
    [
        ("3 kg", "m", ("kg", "m")),
        ("10 Hz", "rad/s", ("Hz", "rad/s")),  # a frequency is no angular speed
        ("1000 rpm", "Hz", ("rpm", "Hz")),
        ("1 rad", "1", ("rad", "plain number")),
        ("3 foos", "m", ("foos", "known unit")),
        ("eight mm", "m", ("eight mm", "'8 mm'")),
        ("", "m", ("''", "'8 mm'")),
        ("1 __import__('os')", "s", ("__import__", "known unit")),
    ],
)
def test_what_does_not_fit_is_named(text: str, unit: str, named: tuple[str, ...]) -> None:
    with pytest.raises(UnitError) as error:
        to_unit(text, unit)
    assert all(word in str(error.value) for word in named)


@pytest.mark.parametrize("pair", FACTORS, ids=" to ".join)
def test_factors_without_pint_are_pints(pair: tuple[str, str]) -> None:
    assert (FACTORS[pair], 0.0) == find_conversion("1", *pair)


@pytest.mark.parametrize(
    ("given", "wanted", "value", "converted"),
    [
        ("degC", "K", 20.0, 293.15),
        ("K", "°C", 293.15, 20.0),
        ("℃", "K", 20.0, 293.15),
        ("degF", "degC", 100.0, (100.0 - 32.0) / 1.8),
        ("celsius", "degF", 100.0, 212.0),
        ("degR", "K", 9.0, 5.0),
        ("W/(m2.degC)", "W/(m2.K)", 3.0, 3.0),  # per degree of difference
        ("m²", "mm2", 1.0, 1e6),
    ],
)
def test_units_that_no_fmu_defines_keep_their_offset(
    given: str, wanted: str, value: float, converted: float
) -> None:
    linear = convert_units(given, {}, wanted, {})
    assert linear is not None
    assert linear.factor * value + linear.offset == pytest.approx(converted, rel=1e-13)


def test_logarithmic_units_are_not_converted() -> None:
    assert convert_units("dB", {}, "1", {}) is None
    with pytest.raises(UnitError, match="dB"):
        to_unit("3 dB", "1")
