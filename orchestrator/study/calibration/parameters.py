"""The parameters that are fitted: their names, sizes and bounds."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from models.core.quantities import Quantity, Vector

from ...errors import MistakeError, Option, one_of
from ...scenario import Scenario
from ...scenario.display import say, show
from ...scenario.system import list_parameters, list_quantities
from ...scenario.units import UnitError, to_unit

# Where a positive parameter has no other lower bound, in its start.
LEAST = 1e-6
# Further starts are between these multiples of a start that has no bounds on that side.
SPREAD = (0.5, 2.0)


@dataclass(frozen=True)
class Fitted:
    """A parameter "component.name" with its unit, start and bounds; `size` makes it a number of size 1."""

    name: str
    unit: str
    start: float
    low: float = -math.inf
    high: float = math.inf

    @property
    def size(self) -> float:
        return abs(self.start) or 1.0


def choose(scenario: Scenario, wanted: Sequence[str], bounds: Sequence[str] = ()) -> tuple[Fitted, ...]:
    """Those that are named, one or several with commas in a text, with what `bounds` says of some:
    "component.name = low .. high". MistakeError for what cannot be fitted."""
    values, quantities = list_parameters(scenario), list_quantities(scenario)
    continuous = [name for name in values if not quantities[name].jumps]
    named = [part.strip() for text in wanted for part in text.split(",") if part.strip()]
    found: dict[str, Fitted] = {}
    for text in named:
        name = text.removeprefix("components.").replace(".parameters.", ".")
        if name not in continuous:
            why = "has no values in between; " if name in values else ""
            raise MistakeError((Option("parameters", text), f": {why}{one_of(continuous, name)}"))
        found[name] = _with_range(Fitted(name, quantities[name].unit, values[name]), quantities[name])
    if not found:
        raise MistakeError((Option("parameters"), ": names none; e.g. ", Option("parameters", continuous[0])))
    for text in bounds:
        one = _parse_bounds(text, found, quantities)
        found[one.name] = one
    return tuple(found.values())


def _with_range(one: Fitted, quantity: Quantity) -> Fitted:
    low, high = quantity.limits()
    return replace(one, low=max(low, LEAST * one.size) if quantity.positive else low, high=high)


def _parse_bounds(text: str, fitted: Mapping[str, Fitted], quantities: Mapping[str, Quantity]) -> Fitted:
    option = Option("bounds", text)
    name, equals, ends = (part.strip() for part in text.partition("="))
    if name not in fitted:
        raise MistakeError((option, f": {name!r} is not fitted; {one_of(fitted, name)}"))
    low, dots, high = (part.strip() for part in ends.partition(".."))
    if not (equals and dots and low and high):
        raise MistakeError((option, ": must be component.parameter = low .. high, e.g. 0.1 mm .. 0.4 mm"))
    one = fitted[name]
    try:
        found = replace(one, low=to_unit(low, one.unit), high=to_unit(high, one.unit))
    except UnitError as error:
        raise MistakeError((option, f": {error}")) from None
    low, high, first, last, start = (
        say(value, show(quantities[name])) for value in (one.low, one.high, found.low, found.high, one.start)
    )
    if one.low > found.low or found.high > one.high:
        raise MistakeError((option, f": {name} may be from {low}{f' to {high}' * math.isfinite(one.high)}"))
    if not found.low < found.high:
        raise MistakeError((option, f": the lower bound {first} must be below {last}"))
    if not found.low <= one.start <= found.high:
        raise MistakeError((option, f": the scenario has {name} = {start}, which is outside; set it inside"))
    return found


def list_starts(parameters: Sequence[Fitted], count: int) -> list[Vector]:
    """The scenario's own values over their sizes, and points of a Sobol' sequence between the bounds."""
    own = np.array([one.start / one.size for one in parameters])
    if count < 2:
        return [own]
    low, high = (
        np.array([
            end / one.size if math.isfinite(end) and end > LEAST * one.size else factor * one.start / one.size
            for one in parameters
            for end in [getattr(one, side)]
        ])
        for side, factor in zip(("low", "high"), SPREAD, strict=True)
    )  # fmt: skip
    points = scipy.stats.qmc.Sobol(len(parameters), seed=0).random_base2(math.ceil(math.log2(count)))
    return [own, *(np.minimum(low, high) + points[: count - 1] * np.abs(high - low))]
