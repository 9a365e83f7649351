"""Names of third-party FMUs that stand for one variable."""

from collections.abc import Iterable, Mapping

from ..participants.third_party import ThirdPartyComponent
from . import Line, ScenarioError
from .component_table import ComponentTable
from .values import Value


def check_aliases(tables: Mapping[str, ComponentTable], lines: Iterable[Line]) -> None:
    """ScenarioError where two names of one variable are connected, or given different values."""
    lines = list(lines)
    for name, table in tables.items():
        component = table.resolve()
        if not isinstance(component, ThirdPartyComponent):
            continue
        given: list[tuple[str, str, Value | None]] = []
        for key in ("parameters", "start", "inputs"):
            for variable, value in getattr(table, key).items():
                given.append((variable, f"components.{name}.{key}.{variable} = {value}", value))
        for line in lines:
            target, _, variable = line.target.partition(".")
            if target == name:
                given.append((variable, f"the connection {line}", None))
        found: dict[object, tuple[str, str, Value | None]] = {}
        for one in given:
            if one[0] not in component.about.variables:
                continue
            first = found.setdefault(component.about.variables[one[0]].memory, one)
            if first[0] != one[0] and (first[2] != one[2] or one[2] is None):
                raise ScenarioError(
                    f"{first[1]}, {one[1]}: {first[0]} and {one[0]} are two names of one variable of "
                    f"{name} (they have one value reference); leave one out"
                )
