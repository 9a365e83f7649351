"""Analyses: scalar results, a table and a figure as pure functions of named parameters."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from models.core.quantities import Quantity
from models.core.system import suggestion

from ..errors import MistakeError
from ..scenario.display import format_number, show_unit
from ..scenario.units import is_bare
from ..scenario.values import Value, parse_value, to_number

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure


Draw = Callable[["xarray.Dataset", Mapping[str, Any]], "Figure"]
Tabulate = Callable[[Mapping[str, Any]], "xarray.Dataset"]


class Parameter:
    """One argument of an analysis: its default, and the quantity with its allowed range.

    `integer` asks for a whole number, a bool as default for true or false, a text without choices for any
    text.
    """

    def __init__(
        self, default: Value, unit: str, description: str, *, integer: bool = False, **limits: Any
    ) -> None:
        self.default, self.integer = default, integer
        self.quantity = Quantity(unit, description, boolean=isinstance(default, bool), **limits)

    @property
    def fields(self) -> dict[str, Any]:
        """Default, unit, meaning and range by name, as JSON has them."""
        names = ("unit", "description", "minimum", "maximum", "choices", "positive", "plausible")
        own = {name: getattr(self.quantity, name) for name in names}
        return {"default": self.default, "integer": self.integer, **own}

    @property
    def allowed(self) -> str:
        """The allowed values in words."""
        if self._is_text:
            return "text"
        words = self.quantity.describe_range().removeprefix("one of ")
        return f"whole, {words}" if self.integer else words

    @property
    def _is_text(self) -> bool:
        return isinstance(self.default, str) and not self.quantity.choices

    def doubt(self, name: str, value: Any) -> str:
        """A warning of a number without a unit that is plausible only in another one; "" if there is none."""
        text = str(value)
        if isinstance(value, bool) or self._is_text or self.quantity.choices or not is_bare(text):
            return ""
        doubt = self.quantity.doubt(float(text))
        said = f"{name} = {float(text):g} {self.quantity.unit} ({self.quantity.description})"
        return doubt and f"{said}: {doubt} Write the unit"

    def check_value(self, name: str, value: Any) -> Value:
        """`value` (a text may have a unit) as `evaluate` gets it; MistakeError with the allowed range."""
        if not isinstance(value, (bool, int, float, str)):
            raise MistakeError(f"{name} = {value!r} ({self.quantity.description}): must be a single value")
        if self._is_text:
            return str(value)
        try:
            found = parse_value(self.quantity, value)
        except ValueError as error:
            raise MistakeError(f"{name} = {value!r} ({self.quantity.description}): {error}") from None
        fault = self.quantity.fault(name, to_number(self.quantity, found))
        if fault is not None:
            raise MistakeError(fault)
        if not self.integer:
            return found
        if not float(found).is_integer():
            raise MistakeError(f"{name} = {value} ({self.quantity.description}): must be a whole number")
        return int(found)


def describe_values(parameters: Mapping[str, Parameter], values: Mapping[str, Any]) -> str:
    """What an analysis takes, in words; without what is left open: an empty text, a zero that says so."""
    words = []
    for name, parameter in parameters.items():
        value, unit = values[name], parameter.quantity.unit
        shown = show_unit(unit, "mm" if unit == "m" else "")
        if value == "" or (value == 0.0 and "; 0:" in parameter.quantity.description):
            continue
        number = isinstance(value, float)
        text = f"{format_number(shown.factor * value, 6)} {shown.text}".strip() if number else str(value)
        words.append(f"{name} {'yes' if value is True else 'no' if value is False else text}")
    return ", ".join(words)


@dataclass(frozen=True)
class Result:
    """One scalar that an analysis returns: a number in `unit`, printed with so many digits, or a text."""

    unit: str
    description: str
    text: bool = False
    display_unit: str = ""
    digits: int = 6


@dataclass(frozen=True)
class Analysis:
    """A function of all `parameters` that returns all `results`; equal parameters give equal bits.

    A study records an error that `evaluate` raises as the message of the point. Any function can be studied:
    `module:object` names one outside this package.

    `table` returns the data behind the results and, as variables without dimension, the results. `draw`
    returns a figure of a table and the parameters. `texts` are further files by their endings: functions that
    return the text of a table and the parameters. `describe` says in words what the results are of,
    `warn` what of the results a user must not overlook, `list_errors` about how far off numbers of given
    parameters and results are, in their units, which is printed beside them.
    """

    name: str
    description: str
    parameters: Mapping[str, Parameter]
    results: Mapping[str, Result]
    evaluate: Callable[[Mapping[str, Any]], Mapping[str, float | str]]
    table: Tabulate | None = None
    draw: Draw | None = None
    texts: Mapping[str, Callable[[xarray.Dataset, Mapping[str, Any]], str]] = field(default_factory=dict)
    describe: Callable[[Mapping[str, Any]], str] | None = None
    warn: Callable[[Mapping[str, Any]], Sequence[str]] = field(default=lambda results: ())
    list_errors: Callable[[Mapping[str, Any], Mapping[str, Any]], Mapping[str, float]] = field(
        default=lambda values, results: {}
    )

    def parameter(self, name: str) -> Parameter:
        """The parameter of that name; MistakeError if there is none."""
        if name not in self.parameters:
            raise MistakeError(f"{self.name} has no parameter {name!r}; {suggestion(name, self.parameters)}")
        return self.parameters[name]

    def list_doubts(self, values: Mapping[str, Any]) -> list[str]:
        """Warnings of these values."""
        doubts = (self.parameter(name).doubt(name, value) for name, value in values.items())
        return [doubt for doubt in doubts if doubt]

    def complete(self, values: Mapping[str, Any]) -> dict[str, Value]:
        """`values` checked, and the defaults of the other parameters; MistakeError for a fault."""
        checked = {name: self.parameter(name).check_value(name, value) for name, value in values.items()}
        return {name: parameter.default for name, parameter in self.parameters.items()} | checked


def declare(name: str, description: str, table: Tabulate, draw: Draw, **more: Any) -> Analysis:
    """An analysis whose results are the variables without dimension of its table."""

    @functools.wraps(table)
    def evaluate(values: Mapping[str, Any]) -> dict[str, float | str]:
        found = table(values).data_vars.items()
        return {str(key): variable.item() for key, variable in found if not variable.ndim}

    return Analysis(name, description, evaluate=evaluate, table=table, draw=draw, **more)
