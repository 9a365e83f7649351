"""Types of a scenario's fields: times with units, tolerances, values, tables."""

import math
from typing import Annotated, Any

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    ValidatorFunctionWrapHandler,
    WrapValidator,
)

from .units import to_unit
from .values import Faults, Value, WithUnit

# What is also a folder's name.
FolderName = Annotated[str, Field(pattern=r"^[ .-]*\w[\w .-]*$", max_length=200)]


def _parse_time(value: Any) -> float:
    """A time in seconds, from a number or a string with a unit."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        shown = str(value).lower() if isinstance(value, bool) else repr(value)
        raise Faults(("", f" = {shown}: must be a time: a number of seconds, or a string such as '2 us'"))
    return to_unit(value, "s") if isinstance(value, str) else float(value)


def _parse_positive_time(value: Any) -> Any:
    """A time in seconds; ValueError unless it is positive and finite."""
    number = _parse_time(value)
    if not (math.isfinite(number) and number > 0.0):
        raise Faults(("", f" = {value}: must be a finite number > 0 s"))
    return number


def _parse_time_or_0(value: Any) -> Any:
    """A time in seconds; ValueError unless it is finite and not negative."""
    number = _parse_time(value)
    if not (math.isfinite(number) and number >= 0.0):
        raise Faults(("", f" = {value}: must be >= 0 s"))
    return number


def _check_scalar(value: Any, validate: ValidatorFunctionWrapHandler) -> Any:
    if not isinstance(value, (bool, int, float, str)):
        raise ValueError("must be a number, a string with a unit, a choice's name, true or false")
    return value if isinstance(value, WithUnit) else validate(value)


Seconds = Annotated[float, BeforeValidator(_parse_positive_time, json_schema_input_type=float | str)]
SecondsOr0 = Annotated[float, BeforeValidator(_parse_time_or_0, json_schema_input_type=float | str)]
# Written files state plain numbers.
_Plain = PlainSerializer(lambda value: float(value) if isinstance(value, WithUnit) else value)
Written = Annotated[Value, WrapValidator(_check_scalar), _Plain]
# Of whole arrays: a list, or a list of rows.
Given = Value | list[Value] | list[list[Value]]
Tolerance = Annotated[float, Field(gt=0.0, allow_inf_nan=False, strict=True)]


class Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


def in_unit(unit: str, zero: bool = False) -> BeforeValidator:
    """A finite number in `unit`, or a string with a unit; > 0, or with `zero` >= 0."""

    def parse(value: Any) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, float, str)):
            raise ValueError(f"must be a number in {unit}, or a string with a unit")
        number = to_unit(value, unit) if isinstance(value, str) else float(value)
        if not math.isfinite(number) or number < 0.0 or (number == 0.0 and not zero):
            raise ValueError(f"{value}: must be {'>=' if zero else '>'} 0")
        return number

    return BeforeValidator(parse, json_schema_input_type=float | str)
