"""Messages in the words of the Python interface, where the command line speaks of its options."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

from models.core.system import ModelError
from orchestrator.errors import MistakeError, RunError

# Arguments of another name than their option's, and those that are switched on.
RENAMED = {"from": "low", "to": "high"}
SWITCHES = ("overwrite", "native", "responses", "retry-failed")
COMMAND = re.compile(r"tribocosim (run|resume|speeds) ([^\s,;:]+)((?: --\S+(?: (?!--)[^\s,;:]+)?)*)")
SETTING = re.compile(r"--set ([\w.]+)=([^\s,;]+)")
NUMBER = re.compile(r"[-+]?[\d.]+(e[-+]?\d+)?")
OPTION = re.compile(r"--([a-z][a-z-]*)")


@contextmanager
def speak_python() -> Iterator[None]:
    """Errors of the block, or of the function that this decorates, speak of arguments instead of options."""
    try:
        yield
    except (MistakeError, ModelError, RunError) as error:
        error.args = tuple(in_python(one) if isinstance(one, str) else one for one in error.args)
        raise


def in_python(message: str) -> str:
    """The message with calls for commands, and arguments for options."""
    message = COMMAND.sub(_write_call, message)
    message = SETTING.sub(lambda found: f"with_({{'{found[1]}': {_write_value(found[2])}}})", message)
    return OPTION.sub(lambda found: _write_argument(found[1]), message)


def _write_call(found: re.Match[str]) -> str:
    command, what, options = found.groups()
    given = re.findall(r"--(\S+)(?: (?!--)(\S+))?", options)
    arguments = [f"{name}='{value}'" if value else _write_argument(name) for name, value in given]
    return f"tribocosim.{command}({', '.join([_write_value(what), *arguments])})"


def _write_value(text: str) -> str:
    """A text in quotation marks, but for a number, and what stands for something else."""
    return text if text.isupper() or text == "..." or NUMBER.fullmatch(text) else f"'{text}'"


def _write_argument(option: str) -> str:
    name = RENAMED.get(option, option.replace("-", "_"))
    return f"{name}=True" if option in SWITCHES else name
