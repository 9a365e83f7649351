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


def _in_seconds(zero: bool = False) -> BeforeValidator:
    """A finite time in seconds, or a string with a unit; > 0, or with `zero` >= 0."""

    def parse(value: Any) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, float, str)):
            shown = str(value).lower() if isinstance(value, bool) else repr(value)
            said = "must be a time: a number of seconds, or a string such as '2 us'"
            raise Faults(("", f" = {shown}: {said}"))
        number = to_unit(value, "s") if isinstance(value, str) else float(value)
        if not math.isfinite(number) or number < 0.0 or (number == 0.0 and not zero):
            allowed = "finite and >= 0 s" if zero else "a finite number > 0 s"
            raise Faults(("", f" = {value}: must be {allowed}"))
        return number

    return BeforeValidator(parse, json_schema_input_type=float | str)


def _check_scalar(value: Any, validate: ValidatorFunctionWrapHandler) -> Any:
    if not isinstance(value, (bool, int, float, str)):
        raise ValueError("must be a number, a string with a unit, a choice's name, true or false")
    return value if isinstance(value, WithUnit) else validate(value)


Seconds = Annotated[float, _in_seconds()]
SecondsOr0 = Annotated[float, _in_seconds(zero=True)]
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
