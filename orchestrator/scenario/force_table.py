"""The measured force of a coil spring in a scenario, which becomes the gaps of its coils."""

import itertools
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from models.valve_train.measured_spring import fit_gaps

from .fields import in_unit
from .messages import place_faults
from .units import to_unit
from .values import Faults, Inserted, WithUnit, build_component

Row = tuple[Annotated[float, in_unit("m", zero=True)], Annotated[float, in_unit("N", zero=True)]]
ForceTable = list[Row]
_TABLE = TypeAdapter[ForceTable](ForceTable)
EXAMPLE = 'force_table = [["0 mm", "330 N"], ["4 mm", "450 N"], ["8 mm", "600 N"]]'
# Parameters of coil_spring that the table replaces: a scenario that is extended may have them.
FOUND = ("spring_rate", "preload", "gap")


def insert_force_table(table: dict[str, Any]) -> Inserted:
    """Rate, preload and gaps by the table's `force_table`."""
    rows = _read_rows(table["force_table"])
    component = build_component(table["component"], tuple(table.get("structure", {}).items()))
    stop = component.parameters.field("stop_stiffness")
    stiffness = table.get("parameters", {}).get(stop.name, stop.start)
    if isinstance(stiffness, str):
        stiffness = to_unit(stiffness, stop.quantity.unit)
    travel, force = np.array(rows).T
    try:
        spring = fit_gaps(travel, force, component.structure["segments"], stiffness)
    except ValueError as error:
        raise Faults(("force_table", f": {error}")) from None
    found = {"spring_rate": spring.spring_rate, "preload": spring.preload}
    found |= {f"gap[{i}]": float(gap) for i, gap in enumerate(spring.gap, 1)}
    return Inserted({name: WithUnit(value) for name, value in found.items()}, replaced=FOUND)


def _read_rows(written: Any) -> ForceTable:
    try:
        rows = _TABLE.validate_python(written)
    except ValidationError as error:
        first = place_faults("force_table", error).faults[0]
        raise Faults(replace(first, remedy=f"e.g. {EXAMPLE}")) from None
    if len(rows) < 2 or rows[0][0] != 0.0:
        raise Faults(("force_table", f": must have two rows or more, the first at travel 0; e.g. {EXAMPLE}"))
    for i, (before, after) in enumerate(itertools.pairwise(rows), 2):
        if not (before[0] < after[0] and before[1] < after[1]):
            raise Faults((f"force_table[{i}]", ": travel and force must ascend from row to row"))
    return rows
