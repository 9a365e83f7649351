"""What a message advises to do, apart from the words of the command line or of Python.

Words are a string, an action, an error, or a tuple of words that follow each other without a gap. Each face
has a function that renders them: `in_command_line`, `in_python`.
"""

import re
import shlex
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from types import EllipsisType
from typing import TypeAlias

from .words import tally


@dataclass(frozen=True)
class Set:
    """A value for the path of a scenario or the parameter of an analysis."""

    path: str
    value: object


@dataclass(frozen=True)
class Option:
    """An option of the command, an argument of the function; None: its name alone, True: a switch."""

    name: str
    value: object = None


@dataclass(frozen=True)
class Command:
    """A command, a function; an ellipsis stands for what only the reader knows."""

    name: str
    arguments: tuple[object, ...] = ()
    options: tuple[Option, ...] = ()


# Messages may name what a file contains, of any length; the remedy is at their end.
LINES, LINE, HEAD, TAIL = 50, 1500, 700, 500

Action: TypeAlias = Set | Option | Command
Words: TypeAlias = "str | Action | ExplainedError | tuple[Words, ...]"


class ExplainedError(Exception):
    """`fault` names the thing, its value and what is allowed; `remedies` are what helps, the best first.

    It was made in `source`, a file with its line or an option, which begins each line of the fault. As a
    string it speaks Python, since who sees it uncaught has called a function.
    """

    source: "str | Option" = ""

    def __init__(self, fault: Words = "", *remedies: Words) -> None:
        super().__init__(fault, *remedies)
        self.fault, self.remedies = fault, remedies

    def __str__(self) -> str:
        return in_python(self)

    @property
    def words(self) -> Words:
        """The fault with its source, then its remedies as alternatives."""
        fault = name_source(self.source, self.fault) if self.source else self.fault
        return (fault, "; ", self.advice) if self.remedies else fault

    @property
    def advice(self) -> Words:
        """The remedies as alternatives."""
        if not self.remedies:
            return ""
        *others, last = self.remedies
        choices = [part for remedy in others for part in (remedy, ", ")]
        return (*choices, "or " if others else "", last)

    @property
    def actions(self) -> tuple[Action, ...]:
        """What its fault and remedies name to be set, given or called."""
        return find_actions(self.words)


def join(*words: Words) -> Words:
    """The words one after the other; a string if there is no action among them."""
    return tuple(_flatten(words)) if find_actions(words) else in_python(words)


def name_source(source: str | Option, words: Words) -> Words:
    """The words with the source, a file or an option, before each of their lines."""
    start = source, ": " if isinstance(source, str) else " "
    pieces = (re.split("(\n)", part) if isinstance(part, str) else [part] for part in _flatten(words))
    return start, *((one, start) if one == "\n" else one for every in pieces for one in every)


def find_actions(words: Words) -> tuple[Action, ...]:
    """The actions in words, in their order."""
    return tuple(part for part in _flatten(words) if not isinstance(part, str))


def in_command_line(words: Words) -> str:
    """The words with actions as they are typed in a shell."""
    return _render(words, _type_action)


def in_python(words: Words) -> str:
    """The words with actions as arguments and calls."""
    return _render(words, _call_action)


def make_printable(text: str) -> str:
    """The text with a ? for each character by which it could command a terminal."""
    return "".join(c if c.isprintable() or c in "\n\u00a0\u202f" else "?" for c in text)


def _render(words: Words, render: Callable[[Action], str]) -> str:
    """The words as a terminal can show them: without control characters, lines and their number limited."""
    text = "".join(part if isinstance(part, str) else render(part) for part in _flatten(words))
    lines = make_printable(text).split("\n")
    if len(lines) > LINES:
        lines = [*lines[:LINES], f"and {tally(len(lines) - LINES, 'line')} more"]
    return "\n".join(line if len(line) <= LINE else f"{line[:HEAD]} ... {line[-TAIL:]}" for line in lines)


def _flatten(words: Words) -> Iterator[str | Action]:
    if isinstance(words, ExplainedError):
        yield from _flatten(words.words)
    elif isinstance(words, tuple):
        for part in words:
            yield from _flatten(part)
    else:
        yield words


def _type_action(action: Action) -> str:
    if isinstance(action, Set):
        value = str(action.value).lower() if isinstance(action.value, bool) else action.value
        return f"--set {_quote(f'{action.path}={value}')}"
    if isinstance(action, Option):
        given = "" if action.value is None or action.value is True else f" {_quote(action.value)}"
        return f"--{action.name.replace('_', '-')}{given}"
    words = [action.name, *map(_quote, action.arguments), *map(_type_action, action.options)]
    return f"tribocosim {' '.join(words)}"


def _quote(value: object) -> str:
    return "..." if isinstance(value, EllipsisType) else shlex.quote(str(value))


# Arguments and functions of another name than their option's and command's.
ARGUMENTS = {"from": "low", "to": "high"}
FUNCTIONS = {"fmu build": "build_fmu", "fmu validate": "validate_fmu", "diagnose": "Result.diagnose"}


def _call_action(action: Action) -> str:
    if isinstance(action, Set):
        return f"with_({{{action.path!r}: {_write_python(action.value)}}})"
    if isinstance(action, Option):
        name = ARGUMENTS.get(action.name, action.name)
        return name if action.value is None else f"{name}={_write_python(action.value)}"
    given = [*map(_write_python, action.arguments), *map(_call_action, action.options)]
    return f"tribocosim.{FUNCTIONS.get(action.name, action.name)}({', '.join(given)})"


def _write_python(value: object) -> str:
    if isinstance(value, EllipsisType):
        return "..."
    return repr(value) if isinstance(value, bool | int | float) else repr(str(value))
