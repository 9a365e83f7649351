"""Mistakes in the options and arguments of commands, told as all others are: one sentence, status 2."""

import sys
from collections.abc import Sequence
from typing import Any

import typer
from typer.core import TyperGroup

from ..messages import say

MISTAKE = 2
# Of typer's own parser or of click, as its version has it.
UsageError: Any = typer.BadParameter.__bases__[0]


class Commands(TyperGroup):
    """Commands; what is wrong with their options is a message on standard error without a frame."""

    def main(self, *arguments: Any, **options: Any) -> Any:
        """Carry out the command and end the process with its status."""
        try:
            status = super().main(*arguments, **options | {"standalone_mode": False})
        except UsageError as error:
            status = MISTAKE
            if type(error).__name__ != "NoArgsIsHelpError":  # whose help is printed
                given = arguments[0] if arguments else options.get("args")
                say(describe_misuse(error, find_command(self, sys.argv[1:] if given is None else given)))
        sys.exit(status)


def find_command(group: Any, words: Sequence[str]) -> str:
    """The command with which these words begin."""
    path = ["tribocosim"]
    for word in words:
        if (group := getattr(group, "commands", {}).get(word)) is None:
            break
        path.append(word)
    return " ".join(path)


def describe_misuse(error: Any, command: str) -> str:
    """The sentence: command, option and value, what is wrong or allowed, and where to look it up."""
    remedy = f"`{command} --help` lists what it takes"
    before, kind = command.partition(" ")[2], type(error).__name__
    place = f"{before}: " if before else ""
    param, cause = getattr(error, "param", None), error.__cause__
    name = param and (param.opts[-1] if param.param_type_name == "option" else param.name)
    if kind == "MissingParameter":
        return f"{place}{name} is missing; write {error.ctx.get_usage().partition(': ')[2].strip()}"
    if param and hasattr(cause, "errors"):  # of pydantic, by which newer typers read values
        found = cause.errors()[0]
        allowed = found["msg"].partition(",")[0].replace("Input should be", "must be")
        return f"{place}{name} = {found['input']!r}: {allowed}; {remedy}"
    if param:
        return f"{place}{name}: {error.message.rstrip('.')}; {remedy}"
    if kind == "NoSuchOption":
        near = f"did you mean {' or '.join(sorted(error.possibilities))}? " if error.possibilities else ""
        return f"{place}no option {error.option_name}; {near}{remedy}"
    said = error.format_message().rstrip(".").replace("argument(s)", "arguments")
    return f"{place}{said[:1].lower()}{said[1:]}{'' if said.endswith('?') else ';'} {remedy}"
