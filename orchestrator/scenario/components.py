"""The components' parameters, start values, inputs and outputs as a page of tables, made of their types."""

from collections.abc import Iterator, Sequence
from typing import Any

from models.catalogue import CATALOGUE
from models.core.component import Component
from models.core.quantities import Field, Layout
from models.core.system import suggestion

from ..errors import MistakeError
from .units import to_unit

INTRODUCTION = """# Components

Every parameter, start value, input and output of the components, as `tribocosim components` prints them;
`tribocosim components NAME` prints one. Scenarios set parameters and start values under `[components.NAME]`:
a number without a unit is in the unit given here, and `"45 N/mm"` states its own.
"""


def write_page(names: Sequence[str] = ()) -> str:
    """The components of these names, or with an introduction all of them, as Markdown.

    MistakeError for a name that no component has.
    """
    parts = [INTRODUCTION] * (not names)
    return "\n".join([*parts, *("\n".join(_write_component(one)) for one in _find(names))])


def describe_components(names: Sequence[str] = ()) -> dict[str, dict[str, Any]]:
    """By component what its page says, as plain data; all by default. MistakeError as of `write_page`."""
    return {
        one.name: {
            "description": one.description,
            "structure": dict(one.structure),
            "parameters": _describe(one.parameters),
            "start_values": _describe(one.state),
            "inputs": _describe(one.inputs),
            "outputs": _describe(one.outputs),
        }
        for one in _find(names)
    }


def _find(names: Sequence[str]) -> Iterator[Component]:
    for name in names:
        if name not in CATALOGUE:
            raise MistakeError(f"no component {name!r}; {suggestion(name, CATALOGUE)}")
    for name in names or CATALOGUE:
        yield CATALOGUE[name]()


def _describe(layout: Layout) -> dict[str, dict[str, str | float]]:
    return {
        name: {
            "unit": field.quantity.unit,
            "start": field.quantity.choices[int(field.start)] if field.quantity.choices else field.start,
            "allowed": field.quantity.describe_range(),
            "description": field.quantity.description,
        }
        for name, field in _list_fields(layout).items()
    }


def _list_fields(layout: Layout) -> dict[str, Field]:
    """By name, without internal ones; of elements of a vector one."""
    return {_format_name(field): field for field in layout.fields if not field.quantity.internal}


def _write_component(component: Component) -> Iterator[str]:
    yield f"## {component.name}\n"
    yield f"{component.description}. [Equations and limits](../../fmus/{component.name}/README.md).\n"
    if component.structure:
        sizes = ", ".join(f"`{name}` = {value}" for name, value in component.structure.items())
        yield f"Structural sizes (`structure = {{ ... }}`) and their defaults: {sizes}.\n"
    yield from _write_table("Parameters", component.parameters, "default")
    yield from _write_table("Start values of the states", component.state, "default")
    yield from _write_table("Inputs", component.inputs, "if not connected")
    yield from _write_table("Outputs", component.outputs, "")


def _write_table(title: str, layout: Layout, default: str) -> Iterator[str]:
    """Rows of all variables; elements of a vector have one row. Outputs have neither defaults nor ranges."""
    fields = _list_fields(layout)
    if not fields:
        return
    head = ["name", "unit", default, "allowed", "meaning"] if default else ["name", "unit", "meaning"]
    yield f"### {title}\n"
    yield f"| {' | '.join(head)} |"
    yield f"|{'---|' * len(head)}"
    for name, field in fields.items():
        quantity = field.quantity
        given = [_format_default(field), quantity.describe_range()] if default else []
        unit = "" if quantity.unit == "1" else quantity.unit
        meaning = quantity.description.replace("|", "\\|")
        yield f"| {' | '.join([f'`{name}`', unit, *given, meaning])} |"
    yield ""


def _format_name(field: Field) -> str:
    """Of an element of a vector the vector's, with the structural size that counts them."""
    return f"{field.name.split('[')[0]}[1..{field.quantity.size}]" if field.quantity.size else field.name


def _format_default(field: Field) -> str:
    """The default as a scenario may give it, and beside it in the unit that results are shown in."""
    quantity, value = field.quantity, field.start
    if quantity.choices:
        return quantity.choices[int(value)]
    if quantity.boolean:
        return str(bool(value)).lower()
    text = f"{value:.6g}"
    if quantity.display_unit and value:
        text += (
            f" ({value / to_unit(f'1 {quantity.display_unit}', quantity.unit):.6g} {quantity.display_unit})"
        )
    return text
