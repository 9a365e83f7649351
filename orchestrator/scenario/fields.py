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


def in_unit(unit: str, zero: bool = False) -> BeforeValidator:
    """A finite number in `unit`, or a string with a unit; > 0, or with `zero` >= 0."""
    kind = f"a number in {unit}, or a string with a unit"
    if unit == "s":
        kind = "a time: a number of seconds, or a string such as '2 us'"

    def parse(value: Any) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, float, str)):
            shown = str(value).lower() if isinstance(value, bool) else repr(value)
            raise Faults(("", f" = {shown}: must be {kind}"))
        number = to_unit(value, unit) if isinstance(value, str) else float(value)
        if not math.isfinite(number):
            raise Faults(("", f" = {value}: must be finite"))
        if number < 0.0 or (number == 0.0 and not zero):
            raise Faults(("", f" = {value}: must be {'>=' if zero else '>'} 0"))
        return number

    return BeforeValidator(parse, json_schema_input_type=float | str)


def _check_scalar(value: Any, validate: ValidatorFunctionWrapHandler) -> Any:
    if not isinstance(value, (bool, int, float, str)):
        raise ValueError("must be a number, a string with a unit, a choice's name, true or false")
    return value if isinstance(value, WithUnit) else validate(value)


Seconds = Annotated[float, in_unit("s")]
SecondsOr0 = Annotated[float, in_unit("s", zero=True)]
# Written files state plain numbers.
_Plain = PlainSerializer(lambda value: float(value) if isinstance(value, WithUnit) else value)
Written = Annotated[Value, WrapValidator(_check_scalar), _Plain]
# Of whole arrays: a list, or a list of rows.
Given = Value | list[Value] | list[list[Value]]
Tolerance = Annotated[float, Field(gt=0.0, allow_inf_nan=False, strict=True)]


class Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)
