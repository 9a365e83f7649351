"""The documentation inside an FMU: its folder's README.md with the table of variables, as one HTML page."""

import html
from typing import Any

from .fmi.description import display_unit, full_unit
from .fmi.units import display_factor
from .variable_layout import Memory, Variable

# Where a README has a line that begins with this (a link to the tables), the page has the variables.
MARKER = "[All variables]"

_STYLE = """body{font:15px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em}
table{border-collapse:collapse}td,th{border:1px solid #bbb;padding:.2em .6em;text-align:left}
pre{background:#f4f4f4;padding:.6em;overflow:auto}"""

_DERIVATIVES = """<p>Every continuous input has the optional companions <code>_der1</code>,
<code>_der2</code>, <code>_der3</code>: its derivatives by time during the next step. Left at zero, the
input is held.</p>
"""

_RATES = """<p>Every continuous output has the companion <code>der(name)</code>: its derivative by time along
the motion, with the inputs' slopes in effect (<code>_der1</code>, after a step those at its end).</p>
"""

_TITLES = {
    "parameter": "Parameters",
    "start": "Start values of the states",
    "input": "Inputs",
    "output": "Outputs",
    "local": "Energies",
}


def render_page(readme: str, component: Any) -> str:
    """The HTML page of a README and its component. ValueError if the README lacks the marker."""
    from markdown_it import MarkdownIt  # a run that finds its FMUs in the cache needs none

    before, marker, rest = readme.partition(f"\n{MARKER}")
    if not marker:
        raise ValueError(f"README of {component.name}: a line {MARKER}(...) must say where the variables go")
    after = rest.partition("\n")[2]
    parser = MarkdownIt("commonmark").enable("table")
    body = parser.render(before) + variables_table(component) + parser.render(after)
    title = html.escape(component.name)
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
        f"<style>{_STYLE}</style></head>\n<body>\n{body}</body></html>\n"
    )


def variables_table(component: Any) -> str:
    """HTML tables of all variables, by their role; derivatives of inputs and outputs are one line each."""
    groups: dict[str, list[Variable]] = {title: [] for title in _TITLES}
    derived: set[str] = set()
    for variable in Memory(component).variables():
        if variable.derivative_order:
            derived.add(variable.causality)
        else:
            groups["start" if variable.state_start else variable.causality].append(variable)
    parts = []
    for role, title in _TITLES.items():
        if rows := groups[role]:
            head = "<tr><th>name</th><th>unit</th><th>default</th><th>allowed</th><th>meaning</th></tr>"
            lines = "\n".join(map(_row, rows))
            parts.append(f"<h3>{title}</h3>\n<table>\n{head}\n{lines}\n</table>\n")
        if role in derived:
            parts.append(_DERIVATIVES if role == "input" else _RATES)
    return "".join(parts)


def _row(variable: Variable) -> str:
    unit, shown = full_unit(variable), display_unit(variable)
    start, default = variable.start, ""
    if start is not None:
        default = f"{start:g}"
        if shown:
            default += f" ({start * display_factor(unit, shown):g} {shown})"
        if variable.kind == "Enumeration":
            default = variable.quantity.choices[int(start)]
        if variable.kind == "Boolean":
            default = str(bool(start)).lower()
    given = variable.causality in ("parameter", "input")
    allowed = variable.quantity.describe_range() if given else ""
    cells = (variable.name, "" if unit == "1" else unit, default, allowed, variable.description)
    return "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in cells) + "</tr>"
