"""Where a study evaluates: grids, Sobol' points, lists. Tables of the study file, and what they expand to."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any, Literal, TypeVar

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from models.core.quantities import Vector
from models.core.system import suggestion

from ..errors import MistakeError
from ..scenario import Written, find_faults
from ..scenario.values import Faults, Value, WithUnit

# Memory holds several numbers for each point.
MOST_POINTS = 10_000_000
POINT = "point"

# Converts a parameter's value to the parameter's unit; MistakeError if it cannot.
Resolve = Callable[[str, Value], Value]
Spacing = Literal["linear", "logarithmic"]
T = TypeVar("T", bound=BaseModel)


@dataclass(frozen=True)
class Points:
    """Points in order.

    A grid has a dimension for each parameter; the last varies fastest. Other kinds have the one dimension
    `point`. `coordinates` are each parameter's values along its dimension.
    """

    dimensions: tuple[str, ...]
    shape: tuple[int, ...]
    coordinates: Mapping[str, tuple[Value, ...]]

    def __len__(self) -> int:
        return math.prod(self.shape)

    def __getitem__(self, index: int) -> dict[str, Value]:
        """The values of all parameters at a point."""
        if self.dimensions == (POINT,):
            return {name: values[index] for name, values in self.coordinates.items()}
        places = np.unravel_index(index, self.shape)
        axes = zip(self.coordinates.items(), places, strict=True)
        return {name: values[place] for (name, values), place in axes}


def list_keys(kind: type[BaseModel]) -> list[str]:
    """The keys of a table as a file has them."""
    return [field.alias or name for name, field in kind.model_fields.items()]


def parse_table(kind: type[T], content: Any) -> T:
    """Check `content`; Faults with a line for each fault."""
    if not isinstance(content, dict):
        raise ValueError("must be a table")
    try:
        return kind.model_validate(content)
    except ValidationError as error:
        raise Faults(*find_faults(error, lambda place: list_keys(kind))) from None


class Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Range(Table):
    """From `low` to `high`, with or without units."""

    low: Written
    high: Written
    spacing: Spacing = "linear"

    def values_at(self, name: str, fractions: Vector, resolve: Resolve) -> list[float]:
        """The values at `fractions` of the way."""
        ends = [resolve(name, value) for value in (self.low, self.high)]
        low, high = (self._to_number(name, end) for end in ends)
        if self.spacing == "linear":
            values = low + fractions * (high - low)
        elif low > 0.0 and high > 0.0:
            values = low * (high / low) ** fractions
        else:
            raise MistakeError(f"{name}: from {low:g} to {high:g}: logarithmic spacing needs values > 0")
        # Rounding must not leave the range nor miss its end.
        values = np.clip(values, min(low, high), max(low, high))
        values[fractions == 1.0] = high
        kind = WithUnit if all(isinstance(end, WithUnit) for end in ends) else float
        return [kind(value) for value in values]

    @staticmethod
    def _to_number(name: str, value: Value) -> float:
        if isinstance(value, (bool, str)):
            raise MistakeError(f"{name}: a range needs numbers at its ends, not {value!r}; list the values")
        return float(value)


class Axis(Range):
    """Equally spaced values from `start` to `stop`, both included."""

    low: Written = Field(alias="start")
    high: Written = Field(alias="stop")
    count: int = Field(ge=2, le=MOST_POINTS, strict=True)

    def values(self, name: str, resolve: Resolve) -> Sequence[Value]:
        return self.values_at(name, np.linspace(0.0, 1.0, self.count), resolve)


class Listed(Table):
    """Listed values."""

    items: list[Written] = Field(min_length=1, alias="values")

    def values(self, name: str, resolve: Resolve) -> Sequence[Value]:
        return self.items


def _parse_axis(content: Any) -> Axis | Listed:
    if isinstance(content, list):
        return parse_table(Listed, {"values": content})
    if not isinstance(content, dict):
        raise ValueError("must be a list of values, or a table with start, stop and count")
    return parse_table(Axis, content)


def resolve_values(name: str, values: Iterable[Value], resolve: Resolve) -> tuple[Value, ...]:
    return tuple(resolve(name, value) for value in values)


class Grid(Table):
    """All combinations of the axes' values."""

    kind: Literal["grid"]
    axes: dict[str, Annotated[Axis | Listed, BeforeValidator(_parse_axis)]] = Field(min_length=1)

    @property
    def parameters(self) -> list[str]:
        return list(self.axes)

    def points(self, resolve: Resolve) -> Points:
        values = {
            name: resolve_values(name, axis.values(name, resolve), resolve)
            for name, axis in self.axes.items()
        }
        for name, coordinates in values.items():
            if len(set(coordinates)) < len(coordinates):
                raise MistakeError(f"points.axes.{name}: has a value twice")
        return Points(tuple(values), tuple(len(coordinates) for coordinates in values.values()), values)


class Sobol(Table):
    """Scrambled Sobol' points: they fill the ranges more evenly than random ones."""

    kind: Literal["sobol"]
    ranges: dict[str, Annotated[Range, BeforeValidator(partial(parse_table, Range))]] = Field(min_length=1)
    count: int = Field(ge=1, le=MOST_POINTS, strict=True)
    seed: int = Field(ge=0, strict=True)

    @property
    def parameters(self) -> list[str]:
        return list(self.ranges)

    def points(self, resolve: Resolve) -> Points:
        from scipy.stats import qmc

        exponent = self.count.bit_length() - 1
        if self.count != 2**exponent:
            raise MistakeError(
                f"points.count = {self.count}: must be a power of two for Sobol' points to be balanced, "
                f"e.g. {2**exponent} or {2 ** (exponent + 1)}"
            )
        unit = qmc.Sobol(len(self.ranges), scramble=True, rng=self.seed).random_base2(exponent)
        values = {
            name: resolve_values(name, limits.values_at(name, unit[:, i], resolve), resolve)
            for i, (name, limits) in enumerate(self.ranges.items())
        }
        return Points((POINT,), (self.count,), values)


class Rows(Table):
    """Points listed in rows; all rows set the same parameters."""

    kind: Literal["list"]
    rows: list[dict[str, Written]] = Field(min_length=1)

    @property
    def parameters(self) -> list[str]:
        return list(self.rows[0])

    def points(self, resolve: Resolve) -> Points:
        for number, row in enumerate(self.rows, 1):
            if missing := set(self.parameters) ^ set(row):
                raise MistakeError(
                    f"points.rows: row {number} and the first do not both set {', '.join(sorted(missing))}"
                )
        values = {
            name: resolve_values(name, [row[name] for row in self.rows], resolve) for name in self.parameters
        }
        return Points((POINT,), (len(self.rows),), values)


KINDS: dict[str, type[Grid] | type[Sobol] | type[Rows]] = {"grid": Grid, "sobol": Sobol, "list": Rows}


def parse_points(content: Any) -> Grid | Sobol | Rows:
    """The [points] table of a study file; Faults or ValueError."""
    kind = content.get("kind") if isinstance(content, dict) else None
    if kind not in KINDS:
        known = suggestion(str(kind), KINDS) if kind is not None else f"known: {', '.join(KINDS)}"
        raise ValueError(f"no kind of points {kind!r}; {known}" if kind else f"kind is missing; {known}")
    return parse_table(KINDS[kind], content)


def expand_points(kind: Grid | Sobol | Rows, resolve: Resolve) -> Points:
    """Expand to points; MistakeError for too many points or an invalid value."""
    points = kind.points(resolve)
    if len(points) > MOST_POINTS:
        raise MistakeError(f"points: {len(points):.3g} of them; at most {MOST_POINTS:g} go into one study")
    return points
