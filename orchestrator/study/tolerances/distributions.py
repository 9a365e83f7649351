"""Distributions of parameters, from what a tolerance file says of them."""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from scipy import stats

from models.core.quantities import Quantity, Vector

from ...errors import MistakeError, one_of
from ...scenario.table_header import split_column
from ...scenario.units import UnitError, to_unit
from ...scenario.values import parse_value
from .table import Correlation, Distributed, Listed, Measured, Tolerances, Uniform

# Least eigenvalue of a correlation matrix; below it some combination is certain, or impossible.
LEAST_EIGENVALUE = 1e-9
# Part of a normal distribution that its bounds leave: none that is made has more of its parts outside.
LEAST_LEFT = 1e-4


class Distribution(Protocol):
    """As scipy's: `ppf` is the value below which a share lies, `std` the standard deviation."""

    def ppf(self, share: Any) -> Any: ...

    def mean(self) -> Any: ...

    def std(self) -> Any: ...


@dataclass(frozen=True)
class Sampled:
    """Of measured values, in ascending order: a straight line between the middles of their steps."""

    values: Vector

    def ppf(self, share: Any) -> Any:
        places = (np.arange(self.values.size) + 0.5) / self.values.size
        return np.interp(share, places, self.values)

    def mean(self) -> Any:
        return self.values.mean()

    def std(self) -> Any:
        return self.values.std(ddof=1)


def resolve(name: str, given: Distributed, quantity: Quantity, value: float) -> Distribution:
    """The distribution of a parameter, whose value in the scenario is `value`; MistakeError for a fault."""
    if quantity.jumps:
        raise MistakeError(f"parameters.{name}: has no values in between; leave it out")
    assert not isinstance(given, Measured)  # `read_samples` has put its values there

    def read(key: str, text: Any) -> float:
        try:
            return float(parse_value(quantity, text))
        except ValueError as error:
            raise MistakeError(f"parameters.{name}.{key} = {text!r}: {error}") from None

    if isinstance(given, Listed):
        values = [read("values", text) for text in given.values]
        if len(set(values)) < 2:
            raise MistakeError(f"parameters.{name}.values: must be two different ones or more")
        return Sampled(np.sort(values))
    if isinstance(given, Uniform):
        low, high = read("low", given.low), read("high", given.high)
        _check_order(name, low, high)
        return stats.uniform(low, high - low)
    mean = value if given.mean is None else read("mean", given.mean)
    deviation = _read_deviation(name, str(given.deviation), quantity, mean)
    if not deviation > 0.0:
        raise MistakeError(f"parameters.{name}.deviation = {given.deviation}: must be > 0")
    if given.low is None and given.high is None:
        return stats.norm(mean, deviation)
    low = -np.inf if given.low is None else read("low", given.low)
    high = np.inf if given.high is None else read("high", given.high)
    _check_order(name, low, high)
    left = float(np.diff(stats.norm(mean, deviation).cdf([low, high]))[0])
    if left < LEAST_LEFT:
        raise MistakeError(
            f"parameters.{name}: low and high leave {100.0 * left:.1g} % of the distribution around "
            f"{mean:g} {quantity.unit}; give another mean, or a larger deviation"
        )
    return stats.truncnorm((low - mean) / deviation, (high - mean) / deviation, mean, deviation)


def _read_deviation(name: str, text: str, quantity: Quantity, mean: float) -> float:
    """A difference, or a number of per cent of the mean."""
    percent = text.strip().removesuffix("%")
    try:
        if percent != text.strip():
            return to_unit(percent, "1") / 100.0 * abs(mean)
        return to_unit(text, quantity.unit, relative=True)
    except UnitError as error:
        raise MistakeError(f"parameters.{name}.deviation = {text!r}: {error}") from None


def _check_order(name: str, low: float, high: float) -> None:
    if not low < high:
        raise MistakeError(f"parameters.{name}: low = {low:g} must be less than high = {high:g}")


def _read_sample(name: str, given: Measured, quantity: Quantity) -> Listed:
    try:
        with given.file.open(encoding="utf-8-sig", newline="") as file:
            rows = [row for row in csv.reader(file) if row]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise MistakeError(f"parameters.{name}.file = {given.file}: cannot be read ({error})") from None
    if len(rows) < 3:
        raise MistakeError(f"parameters.{name}: {given.file.name} must have a head and two values or more")
    head, *rows = rows
    columns = {column.name: i for i, column in enumerate(map(split_column, head))}
    if given.column is None and len(columns) > 1:
        raise MistakeError(
            f"parameters.{name}: {given.file.name} has {len(columns)} columns; {one_of(columns)}"
        )
    chosen = given.column or next(iter(columns))
    if chosen not in columns:
        raise MistakeError(f"parameters.{name}.column = {chosen!r}: {one_of(columns, chosen)}")
    unit = split_column(head[columns[chosen]]).unit or ""
    if not unit and quantity.unit != "1":
        raise MistakeError(
            f"parameters.{name}: {given.file.name}, column {chosen}: has no unit; write it behind the name, "
            f"e.g. {chosen} [{quantity.unit}]"
        )
    try:
        values = [to_unit(f"{row[columns[chosen]].strip()} {unit}", quantity.unit) for row in rows]
    except (IndexError, UnitError) as error:
        raise MistakeError(f"parameters.{name}: {given.file.name}, column {chosen}: {error}") from None
    return Listed(kind="values", values=[float(value) for value in values])


def read_samples(tolerances: Tolerances, quantities: Mapping[str, Quantity]) -> Tolerances:
    """With the values of files in their place."""
    found = {
        name: _read_sample(name, one, quantities[name])
        if isinstance(one, Measured) and name in quantities
        else one
        for name, one in tolerances.parameters.items()
    }
    return tolerances.model_copy(update={"parameters": found})


def group(names: Sequence[str], correlations: Sequence[Correlation]) -> list[tuple[tuple[str, ...], Vector]]:
    """The parameters in groups that are independent of each other, each with the Cholesky factor of its
    correlations. MistakeError for unknown names, and where no distribution has them."""
    of = {name: {name} for name in names}
    for one in correlations:
        for name in one.parameters:
            if name not in of:
                raise MistakeError(f"correlations: {name} has no distribution; {one_of(names, name)}")
        if one.parameters[0] == one.parameters[1]:
            raise MistakeError(f"correlations: {one.parameters[0]}: name two different parameters")
        joined = of[one.parameters[0]] | of[one.parameters[1]]
        of |= dict.fromkeys(joined, joined)
    found = []
    for members in dict.fromkeys(tuple(name for name in names if name in of[first]) for first in names):
        matrix = np.eye(len(members))
        for one in correlations:
            if one.parameters[0] in members:
                i, j = map(members.index, one.parameters)
                matrix[i, j] = matrix[j, i] = one.coefficient
        least = float(np.linalg.eigvalsh(matrix)[0])
        if least < LEAST_EIGENVALUE:
            raise MistakeError(
                f"correlations of {', '.join(members)}: no numbers are correlated so (the matrix has the "
                f"eigenvalue {least:.3g}); give every pair of them, or smaller coefficients"
            )
        found.append((members, np.asarray(np.linalg.cholesky(matrix), dtype=np.float64)))
    return found
