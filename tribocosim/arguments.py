"""Arguments of functions, refused by name where they are not of the kind that the signature states."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, wraps
from numbers import Integral, Real
from typing import Any, TypeVar, cast

from orchestrator.errors import MistakeError

F = TypeVar("F", bound=Callable[..., Any])

# By the type that a signature states: what a value must be, in words, and whether it is.
KINDS: Mapping[str, tuple[str, Callable[[Any], bool]]] = {
    "Any": ("anything", lambda value: True),
    "None": ("None", lambda value: value is None),
    "str": ("a text", lambda value: isinstance(value, str)),
    "Path": ("a path", lambda value: isinstance(value, os.PathLike)),
    "bool": ("True or False", lambda value: isinstance(value, bool)),
    "int": ("a whole number", lambda value: isinstance(value, Integral) and not isinstance(value, bool)),
    "float": ("a number", lambda value: isinstance(value, Real) and not isinstance(value, bool)),
    "Callable": ("a function", callable),
    "Progress": ("a function of a stage and a share", lambda value: _takes(value, 2)),
}


def checks_arguments(function: F) -> F:
    """The function; MistakeError for arguments that are of none of the types which its signature states. In
    the place of a scenario its tables may stand."""

    @wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        signature = _read_signature(function)
        try:
            bound = signature.bind(*arguments, **named).arguments
        except TypeError:  # of a missing argument, which the function's own call names
            bound = {}
        for name, value in bound.items():
            parameter = signature.parameters[name]
            several = parameter.kind is inspect.Parameter.VAR_POSITIONAL
            for one in value if several else [value]:
                _check(parameter, one)
        return function(*arguments, **named)

    return cast(F, call)


_read_signature = cache(inspect.signature)


def _check(parameter: inspect.Parameter, value: Any) -> None:
    if not isinstance(parameter.annotation, str):  # self
        return
    name, kinds = parameter.name, _split(parameter.annotation)
    if isinstance(value, str) and not value and "Path" in kinds:
        raise MistakeError(f"{name} = '': must not be empty")
    if not any(_is(value, kind) for kind in kinds):
        hint = ""
        if isinstance(value, Real) and "str" in kinds and not {"Path", "float"} & {*kinds}:
            default = parameter.default
            hint = f"; e.g. {default!r}" if isinstance(default, str) else "; write the unit behind the number"
        raise MistakeError(f"{name} = {_show(value)}: must be {', or '.join(map(_describe, kinds))}{hint}")


def _split(stated: str) -> list[str]:
    """The alternatives of a type; those within brackets stay together."""
    head, bracket, inner = stated.partition("[")
    if not bracket:
        return stated.split(" | ")
    inside, _, rest = inner.rpartition("]")
    *before, outer = head.split(" | ")
    return [*before, f"{outer}[{inside}]", *filter(None, rest.removeprefix(" | ").split(" | "))]


def _elements(kind: str) -> tuple[str, list[str]]:
    """What a container is, and what its elements, or values, may be."""
    outer, _, inner = kind.partition("[")
    return outer, _split(inner.removesuffix("]").rpartition(", ")[2])


def _is(value: Any, kind: str) -> bool:
    outer, inner = _elements(kind)
    if outer == "Sequence":
        if not isinstance(value, Iterable) or isinstance(value, str | bytes):
            return False
        return not isinstance(value, Sequence) or all(any(_is(one, k) for k in inner) for one in value)
    if outer in ("Mapping", "Scenario") and isinstance(value, Mapping):
        named = all(isinstance(key, str) for key in value)
        return named and (outer == "Scenario" or all(_is(one, inner[0]) for one in value.values()))
    if outer in KINDS:
        return KINDS[outer][1](value)
    return any(base.__name__ == outer for base in type(value).__mro__)


def _takes(value: Any, count: int) -> bool:
    """Whether it can be called with so many arguments, as far as Python knows."""
    if not callable(value):
        return False
    try:
        inspect.signature(value).bind(*range(count))
    except TypeError:
        return False
    except ValueError:  # of a builtin function without a signature
        return True
    return True


def _describe(kind: str) -> str:
    outer, inner = _elements(kind)
    if outer in ("Sequence", "Mapping"):
        container = "a list" if outer == "Sequence" else "a dictionary of names"
        return f"{container}, each {' or '.join(map(_describe, inner))}"
    return KINDS[outer][0] if outer in KINDS else f"a {outer}"


def _show(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"<{type(value).__name__}>"
