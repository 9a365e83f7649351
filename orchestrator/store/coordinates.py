"""Coordinates of records besides time: columns that are multiples of recorded ones, such as a cam's angle."""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from models.core.quantities import Quantity, Vector


@dataclass(frozen=True)
class Coordinate:
    """`factor` times the column `source`."""

    source: str
    factor: float
    quantity: Quantity

    def in_degrees(self) -> "Coordinate":
        """Of one in radians."""
        quantity = replace(self.quantity, unit="deg", display_unit="")
        return Coordinate(self.source, math.degrees(self.factor), quantity)


class Extension:
    """Columns with those coordinates behind them whose sources they have."""

    def __init__(self, columns: Mapping[str, Quantity], coordinates: Mapping[str, Coordinate]) -> None:
        names = list(columns)
        found = {name: one for name, one in coordinates.items() if one.source in columns}
        self.added = list(found)
        self.columns = {**columns, **{name: one.quantity for name, one in found.items()}}
        self._places = [names.index(one.source) for one in found.values()]
        self._factors = np.array([one.factor for one in found.values()])

    def extend(self, blocks: Iterable[Vector]) -> Iterator[Vector]:
        """The rows with the coordinates' values behind them."""
        for block in blocks:
            yield np.column_stack([block, block[:, self._places] * self._factors])
