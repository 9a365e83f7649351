"""Messages about wrong scenario files, from pydantic's errors."""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from pydantic import ValidationError

from models.core.system import suggestion

from ..errors import ExplainedError, Fault, one_of
from .units import explain_comma
from .values import Faults

MOST = 10  # faults that are told at once
Location = tuple[int | str, ...]

# Remedies for missing keys.
REMEDIES = {
    "tolerance": "state the largest relative RMS error of at least one output: [tolerance] "
    '"contact.load" = 1e-3; or compare with nothing: reference.enabled = false',
    "stop_time": 'e.g. stop_time = "120 ms"',
    "macro_step": 'e.g. macro_step = "5 us"',
    "components": 'e.g. [components.camshaft] component = "camshaft"',
}

BOUNDS = {
    "greater_than": (">", "gt"),
    "greater_than_equal": (">=", "ge"),
    "less_than": ("<", "lt"),
    "less_than_equal": ("<=", "le"),
}
FIXED = {
    "bool_parsing": "must be true or false",
    "bool_type": "must be true or false",
    "list_type": 'must be a list: ["...", "..."]',
    "float_type": "must be a number, without a unit",
    "string_pattern_mismatch": "must have a letter or digit, and only these, blanks, '_', '-' and '.'",
    "finite_number": "must be a finite number > 0, e.g. 1e-3",  # raised for tolerances only
}


def find_faults(
    error: ValidationError, known: Callable[[Location], list[str]] = lambda place: []
) -> list[Fault]:
    """The fault of each error; `known` lists the valid keys at a place, by default none."""
    found: list[Fault] = []
    for fault in error.errors(include_url=False):
        if len(found) >= MOST:
            return [*found, Fault("", "and more", f"correct these {len(found)} first")]
        path, reason = _format_path(fault["loc"]), fault.get("ctx", {}).get("error")
        if fault["type"] == "extra_forbidden":
            near = suggestion(str(fault["loc"][-1]), known(fault["loc"]))
            found.append(Fault(path, ": unknown key", near))
        elif fault["type"] == "missing":
            found.append(Fault(path, ": missing", REMEDIES.get(path, "")))
        elif isinstance(reason, Faults):
            found += [replace(one, place=join_keys(path, one.place)) for one in reason.faults]
        elif isinstance(reason, ExplainedError) and reason.actions:
            found.append(Fault(path, (": ", reason.fault), reason.advice))
        elif reason is not None:
            found.append(Fault.parse(path, f": {reason}"))
        else:
            found.append(Fault.parse(path, f"{_format_value(fault['input'])}: {_describe_allowed(fault)}"))
    return found


def join_keys(table: str, key: str) -> str:
    """The place of a key, or of a row, of a table; "" is the table itself."""
    return f"{table}.{key}" if key and not key.startswith("[") else f"{table}{key}"


def place_faults(key: str, error: ValidationError, known: Sequence[str] = ()) -> Faults:
    """The faults of the table `key` inside another one, which has the keys `known`."""
    found = find_faults(error, lambda place: list(known) if len(place) == 1 else [])
    return Faults(*(replace(one, place=join_keys(key, one.place)) for one in found))


def _format_path(place: Location) -> str:
    """E.g. master.order[1]; rows count from 1."""
    return "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in place).removeprefix(
        "."
    )


def _format_value(value: object) -> str:
    """The value as in TOML; empty for a table."""
    if isinstance(value, dict):
        return ""
    return f" = {str(value).lower() if isinstance(value, bool) else repr(value)}"


def _describe_allowed(fault: Any) -> str:
    """The allowed values."""
    kind, bound = fault["type"], fault.get("ctx", {})
    if kind == "literal_error":
        return one_of(re.findall("'(.*?)'", bound["expected"]), fault["input"])
    if kind == "too_short":
        least = bound["min_length"]
        return f"must have at least {'one entry' if least == 1 else f'{least} entries'}"
    if kind in BOUNDS:
        return f"must be {BOUNDS[kind][0]} {bound[BOUNDS[kind][1]]:g}"
    if kind == "float_type" and (comma := explain_comma(str(fault["input"]))):
        return comma
    if kind in FIXED:
        return FIXED[kind]
    text = fault["msg"].replace("Input should be", "must be").replace(" valid", "")
    text = re.sub(r"a dictionary( or instance of \w+)?", "a table", text)
    return text.replace("a tuple", 'a list: ["...", "..."]').replace("a integer", "an integer")
