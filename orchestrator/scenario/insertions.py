"""Keys of a component's table that become its structure and parameters: tables, drawings, oils."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from models.catalogue import CATALOGUE
from models.core import roles
from models.core.component import Component

from .angle_table import AngleTableError, insert_pressure_table
from .drawing import insert_drawing
from .force_table import insert_force_table
from .lift_table import insert_lift_segments, insert_lift_table
from .oil import OILED, insert_oil
from .values import Faults, Inserted, build_component
from .wire import insert_wire


@dataclass(frozen=True)
class Insertion:
    """`insert` gives what `keys` of a table become, for components that it `suits`; they leave or `stay`."""

    keys: tuple[str, ...]
    insert: Callable[[dict[str, Any]], Inserted]
    suits: Callable[[Component], bool]
    stay: bool = False


def _has(*kinds: type[roles.Role]) -> Callable[[Component], bool]:
    return lambda component: component.has_role(*kinds)


def _has_profile(component: Component) -> bool:
    return "table_points" in component.structure


INSERTIONS = (
    Insertion(("lift_table",), insert_lift_table, _has_profile),
    Insertion(("lift_segments",), insert_lift_segments, _has_profile),
    Insertion(("pressure_table",), insert_pressure_table, _has(roles.CylinderGas)),
    Insertion(("drawing",), insert_drawing, _has(roles.DrawnShaft)),
    Insertion(("force_table",), insert_force_table, _has(roles.CoilSpring)),
    Insertion(("wire",), insert_wire, _has(roles.CoilSpring, roles.LoadedSpring)),
    Insertion(("oil", "temperature"), insert_oil, _has(*OILED), stay=True),
)


def insert_all(table: dict[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """A component's table with all that its keys become, and what was chosen and doubted; Faults."""
    notes: list[str] = []
    for insertion in INSERTIONS if _is_readable(table) else ():
        key = next((key for key in insertion.keys if table.get(key) is not None), None)
        component = _find_component(table.get("component"))
        if key is None or component is None:
            continue
        if not insertion.suits(component):
            suited = [name for name in CATALOGUE if insertion.suits(CATALOGUE[name]())]
            others = " or ".join(filter(None, (", ".join(suited[:-1]), suited[-1])))
            raise Faults((key, f": {component.name} has none; leave it out, or take {others}"))
        try:
            found = insertion.insert(table)
        except AngleTableError as error:
            raise Faults((key, f": {error}")) from None
        notes += found.notes
        kept = {name: value for name, value in table.items() if insertion.stay or name not in insertion.keys}
        table = found.into(kept)
    return table, notes


def _is_readable(table: dict[str, Any]) -> bool:
    """Whether it has values of the types that inserting asks for; else the check of the fields names them."""
    files = [table.get(key) or "" for key in ("lift_table", "pressure_table")]
    structure, parameters = table.get("structure", {}), table.get("parameters", {})
    return (
        all(isinstance(file, str) for file in files)
        and isinstance(parameters, dict)
        and isinstance(structure, dict)
        and all(isinstance(size, int) for size in structure.values())
    )


def _find_component(name: Any) -> Component | None:
    """None for a name that the check of `component` refuses."""
    try:
        return build_component(str(name))
    except ValueError:
        return None
