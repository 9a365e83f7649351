"""The command that a page prints to compute its content once more."""

from pathlib import Path

from ..errors import Command, Option, in_command_line
from ..store.output_folder import format_path


def repeat(command: str, scenario: Path, folder: Path, *given: Option) -> str:
    """The command for a scenario, with the options given. Its result stands beside `folder`, which holds the
    one that there is."""
    whole = folder.absolute()
    out = Option("out", format_path(whole.with_name(f"{whole.name}-again")))
    return in_command_line(Command(command, (format_path(scenario),), (*given, out)))
