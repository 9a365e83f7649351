"""The metadata of a component as C: sizes, places in the memory, variables, start values."""

import json
import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from models.core.component import NO_EVENT
from models.core.integrator import FAILURES
from models.core.requirements import PLACES, Requirement
from models.native.entries import REQUIREMENT, START_REQUIREMENT

from ..fmi.arrays import group_arrays
from ..variable_layout import Memory, Variable, name_as_start_value

_KINDS = {"Real": "REAL", "Integer": "INTEGER", "Boolean": "BOOLEAN", "Enumeration": "ENUMERATION"}
# Nobody sets time as a variable.
_CAUSALITIES = {name: name.upper() for name in ("parameter", "input", "output", "local")} | {
    "independent": "LOCAL"
}


def tables(component: Any, name: str, digest: str, token: str, fmi: int = 2) -> dict[str, str]:
    """Files in C by name. `digest` identifies the code in saved states, `token` the description; `fmi` is the
    version, of which 3 has arrays."""
    memory = Memory(component)
    continuous = [v.reference - memory.x for v in memory.motion() if v.rate_of is None]
    sizes: dict[str, int | str] = {
        "PARAMETERS": component.parameters.size,
        "STARTED": len(memory.started),
        "STATES": component.state.size,
        "INPUTS": component.inputs.size,
        "OUTPUTS": component.outputs.size,
        "RATED": len(memory.rated),
        "GUARDS": component.events.count if component.events else 0,
        "VARIABLES": memory.end_of_variables,
        "WORK_SIZE": component.work_size,
        "RATES_WORK_SIZE": component.rates_work_size,
        "STARTS_AT": memory.starts,
        "INPUTS_AT": memory.inputs,
        "OUTPUTS_AT": memory.outputs,
        "ENERGIES_AT": memory.energies,
        "RATES_AT": memory.rates,
        "X_AT": memory.x,
        "U_AT": memory.u,
        "T_AT": memory.t,
        "S_AT": memory.s,
        "SIZE": memory.size,
        "CONTINUOUS_STATES": len(continuous),
        "DX_AT": memory.size,
        "GUARDS_AT": memory.size + component.state.size,
        "NO_EVENT": _number(NO_EVENT),
        "FAILURES": max(FAILURES) + 1,
        "PLACES": PLACES,
    }
    if component.next_event:
        sizes["NEXT_EVENT_AT"] = memory.outputs + component.outputs.index(component.next_event)
    if component.event_counter and component.event_time:
        sizes["EVENT_COUNT_AT"] = memory.outputs + component.outputs.index(component.event_counter)
        sizes["EVENT_TIME_AT"] = memory.outputs + component.outputs.index(component.event_time)
    variables = [*memory.variables(), *memory.states(), memory.time(), *memory.indicators()]
    elements = {v.reference: 1 for v in variables}
    if fmi == 3:
        elements = {v.reference: 0 for v in variables}
        elements |= {one.first.reference: len(one.elements) for one in group_arrays(variables)}
    declared = (_variable(v, elements[v.reference]) for v in variables)
    texts = (f'{_string(v.name)} "\\0" {_string(_describe_range(v))} "\\0"' for v in variables)
    messages = [FAILURES.get(status, "") for status in range(max(FAILURES) + 1)]
    strings = {"MODEL": name, "TOKEN": token, "DIGEST": digest}
    defined = {key: _string(text) for key, text in strings.items()} | sizes
    arrays = (
        _array("Variable", "variables", "VARIABLES + STATES + 1 + GUARDS", declared),
        "const char texts[] =\n    " + "\n    ".join(texts) + ";",
        _array("double", "beginning", "SIZE", map(_number, memory.beginning())),
        _array("double", "nominal", "", map(_number, (*component.state.nominal, 1.0))),
        _array("int", "started", "", map(str, (*memory.started, -1))),
        _array("int", "continuous", "", map(str, (*continuous, -1))),
        _array("int", "rated", "", map(str, (*memory.rated, -1))),
        _array("char *const", "failures", "FAILURES", map(_string, messages)),
        _requirements("requirements", REQUIREMENT, component.requirements),
        _requirements(
            "start_requirements", START_REQUIREMENT, component.start_requirements, name_as_start_value
        ),
    )
    return {
        "sizes.h": "".join(f"#define {key} {value}\n" for key, value in defined.items()),
        "tables.c": '#include <math.h>\n\n#include "kernels.h"\n#include "instance.h"\n\n'
        + "\n".join(arrays)
        + "\n",
    }


def _array(kind: str, name: str, size: str, items: Iterable[str]) -> str:
    return f"const {kind} {name}[{size}] = {{\n    " + ",\n    ".join(items) + "};"


def _requirements(
    name: str, entry: str, rules: Sequence[Requirement], worded: Callable[[str], str] = str
) -> str:
    """A list of them, after declarations of their kernels."""
    declared = [f"REQUIREMENT({entry}_{i});" for i in range(len(rules))]
    items = []
    for i, rule in enumerate(rules):
        words = f"(const char *const[]){{{', '.join(map(_string, rule.words))}}}" if rule.words else "0"
        items.append(f"{{kernel_{entry}_{i}, {_string(worded(rule.says))}, {words}}}")
    return "\n".join([*declared, _array("Requirement", name, "", [*items, "{0}"])])


def _variable(variable: Variable, elements: int) -> str:
    quantity = variable.quantity
    low, high = quantity.limits() if quantity else (-math.inf, math.inf)
    parts = (
        _KINDS[variable.kind],
        _CAUSALITIES[variable.causality],
        str(elements),
        _truth(variable.variability == "fixed"),
        _truth(quantity is not None and quantity.positive),
        _number(low),
        _number(high),
    )
    return "{" + ", ".join(parts) + "}"


def _describe_range(variable: Variable) -> str:
    """What follows the value in messages; of what is calculated there is nothing to say but of states."""
    quantity = variable.quantity
    return (
        quantity.requirement() if quantity and variable.causality in ("parameter", "input", "local") else ""
    )


def _string(text: str) -> str:
    """A C literal. JSON's escapes are C's, and what is not ASCII stays as it is, in UTF-8."""
    return json.dumps(text, ensure_ascii=False)


def _truth(value: bool) -> str:
    return "true" if value else "false"


def _number(value: float) -> str:
    """The same double."""
    if math.isinf(value):
        return "INFINITY" if value > 0.0 else "-INFINITY"
    return float(value).hex()
