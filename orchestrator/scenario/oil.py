"""The oil of a scenario or of a part: a grade or data of a sheet, at a temperature, for parameters."""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field, TypeAdapter, ValidationError

from models.contact.oil_grades import GRADES
from models.contact.oils import (
    COLDEST,
    HOTTEST,
    ROELANDS_PRESSURE,
    SLOPES,
    ZERO_CELSIUS,
    Oil,
    evaluate_oil,
    walther_slope,
)
from models.core import roles
from models.core.system import suggestion

from .fields import Table, in_unit
from .messages import place_faults
from .units import is_bare
from .values import Faults, Inserted, WithUnit, build_component

Viscosity = Annotated[float, in_unit("m2/s")]
Temperature = Annotated[float, in_unit("K")]
_TEMPERATURE = TypeAdapter[float](Temperature)
# What oils have, to notice values in a wrong unit: key, factor to a unit, unit, least and largest value.
RANGES = (
    ("viscosity_40", 1e6, "mm2/s", 1.0, 1e4),
    ("viscosity_100", 1e6, "mm2/s", 1.0, 1e3),
    ("density_15", 1.0, "kg/m3", 600.0, 1300.0),
)
# Parts with the viscosity of an oil.
OILED = (roles.Contact, roles.Bearing, roles.Adjuster, roles.Oiled)


class OilSheet(Table):
    """An oil as its data sheet has it."""

    viscosity_40: Viscosity = Field(description="Kinematic viscosity at 40 degC (m2/s)")
    viscosity_100: Viscosity = Field(description="Kinematic viscosity at 100 degC (m2/s)")
    density_15: Annotated[float, in_unit("kg/m3")] = Field(description="Density at 15 degC (kg/m3)")
    pressure_viscosity: Annotated[float, in_unit("1/Pa", zero=True)] = Field(
        0.0,
        description="Pressure-viscosity coefficient, measured at the temperature (1/Pa); left out or 0: "
        "correlation of So and Klaus",
    )


def insert_oil(table: dict[str, Any]) -> Inserted:
    """The numbers of the table's `oil` at its `temperature`."""
    _, found = evaluate(table)
    known = build_component(table["component"]).parameters
    given = {name: value for name, value in found.items() if name in known}
    own = table.get("parameters", {})
    if both := [name for name in given if name in own]:
        said = "the oil gives it too; leave out one of both"
        raise Faults(*((f"parameters.{name}", f" = {own[name]!r}: {said}") for name in both))
    return Inserted(given)


def share_oil(content: dict[str, Any]) -> dict[str, Any]:
    """A scenario's content with the numbers of its `oil` at its `temperature` in every part that has an oil,
    but for those that the part states itself; Faults."""
    components = content.get("components")
    if content.keys().isdisjoint(("oil", "temperature")) or not isinstance(components, dict):
        return content
    _, found = evaluate(content)

    def share(table: Any) -> Any:
        if not isinstance(table, dict) or table.get("oil") is not None:
            return table
        try:
            component = build_component(str(table.get("component")))
        except ValueError:
            return table  # which the check of `component` refuses, or a third-party FMU
        if not component.has_role(*OILED) or not isinstance(table.get("parameters", {}), dict):
            return table
        given = {name: value for name, value in found.items() if name in component.parameters}
        return Inserted(given).into(table)

    shared = {name: share(table) for name, table in components.items()}
    return content | {"components": shared}


def name_oil(oil: str | OilSheet | None, temperature: float | None) -> dict[str, Any]:
    """The keys of a scenario that state its oil; empty without one."""
    if oil is None or temperature is None:
        return {}
    return {"oil": oil if isinstance(oil, str) else oil.model_dump(), "temperature": float(temperature)}


def evaluate(table: Mapping[str, Any]) -> tuple[float, dict[str, WithUnit]]:
    """The temperature (K) of the table's `oil`, and its numbers by the names of parameters; Faults."""
    for key, other in (("oil", "temperature"), ("temperature", "oil")):
        if table.get(key) is None:
            example = {"oil": "'SAE 5W-30'", "temperature": "'90 degC'"}[key]
            raise Faults((key, f": missing beside {other}; e.g. {key} = {example}"))
    temperature = _read_temperature(table["temperature"])
    oil = read_oil(table["oil"])
    try:
        state = evaluate_oil(oil, temperature)
    except ValueError as error:
        raise Faults(("temperature", f" = {in_celsius(temperature)}: {error}")) from None
    numbers = {
        **state._asdict(), "roelands_pressure": ROELANDS_PRESSURE, "oil_temperature": temperature
    }  # fmt: skip
    return temperature, {name: WithUnit(value) for name, value in numbers.items()}


def read_oil(written: Any) -> Oil:
    """The oil of a grade's name or of a table; Faults."""
    if isinstance(written, str):
        if written not in GRADES:
            raise Faults(("oil", f" = {written!r}: no such grade; {suggestion(written, GRADES)}"))
        return GRADES[written]
    if isinstance(written, OilSheet):
        return Oil(**written.model_dump())
    if not isinstance(written, dict):
        raise Faults(("oil", f" = {written!r}: must be the name of a grade, or a table of its data"))
    try:
        table = OilSheet.model_validate(written)
    except ValidationError as error:
        raise place_faults("oil", error, list(OilSheet.model_fields)) from None
    for name, factor, unit, low, high in RANGES:
        value = factor * getattr(table, name)
        if not low <= value <= high:
            raise Faults((f"oil.{name}", f" = {value:g} {unit}: must be {low:g} to {high:g} {unit}"))
    oil = Oil(**table.model_dump())
    slope, (flattest, steepest) = walther_slope(oil), SLOPES
    if not flattest <= slope <= steepest:
        raise Faults(
            (
                "oil.viscosity_100",
                f": gives the slope {slope:.3g} of ASTM D341 with viscosity_40; oils have {flattest:g} to "
                f"{steepest:g}; check both",
            )
        )
    return oil


def in_celsius(temperature: float) -> str:
    return f"{temperature - ZERO_CELSIUS:.5g} degC"


def _read_temperature(written: Any) -> float:
    """In kelvin; Faults, also for a plain number that is an oil's temperature in degC only."""
    if is_bare(str(written)) and COLDEST <= float(written) + ZERO_CELSIUS <= HOTTEST:
        said = f" = {written}: without a unit this is {written} K"
        raise Faults(("temperature", f"{said}; write '{written} degC'"))
    try:
        return _TEMPERATURE.validate_python(written)
    except ValidationError as error:
        raise place_faults("temperature", error) from None
