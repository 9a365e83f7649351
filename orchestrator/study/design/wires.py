"""Unknowns that are lengths or coils of a spring's wire: the parameters of the spring follow from them."""

import copy
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from models.core.system import ModelError

from ...errors import MistakeError
from ...scenario.values import Faults
from ...scenario.wire import insert_wire, read_wire

UNITS = {"diameter": "m", "mean_diameter": "m", "free_length": "m", "installed_length": "m",
         "pitch": "m", "active_coils": "1"}  # fmt: skip


@dataclass(frozen=True)
class WireLength:
    """A number of the wire in a component's table of the scenario, and its size there."""

    part: str
    field: str
    table: Mapping[str, Any]
    size: float

    @property
    def unit(self) -> str:
        return UNITS[self.field]


def list_wires(tables: Mapping[str, Any]) -> Iterator[tuple[str, WireLength]]:
    """Those that may vary, by "component.wire.name"."""
    for part, table in tables.get("components", {}).items():
        if "wire" in table:
            wire = read_wire(table["wire"])
            for field in UNITS:
                size = getattr(wire, field)
                size = size[0] if isinstance(size, list) and len(size) == 1 else size
                if isinstance(size, float):
                    yield f"{part}.wire.{field}", WireLength(part, field, table, size)


def wind(wires: Mapping[str, WireLength], values: Mapping[str, float]) -> dict[str, float]:
    """The values with the parameters of springs in place of their wires; ModelError if one has no spring."""
    found = {name: value for name, value in values.items() if name not in wires}
    tables: dict[str, Any] = {}
    for name in values.keys() & wires.keys():
        one = wires[name]
        table = tables.setdefault(one.part, copy.deepcopy(dict(one.table)))
        table["wire"][one.field] = values[name]
    for part, table in tables.items():
        try:
            parameters = insert_wire(table).parameters
        except (Faults, MistakeError) as error:
            raise ModelError(f"{part}: {error}") from None
        found |= {f"{part}.{name}": float(value) for name, value in parameters.items()}
    return found
