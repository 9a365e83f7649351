"""Texts of users: of limited size and depth, so that each is read or refused at once.

Every text that names what to do (scenarios, studies, annotations of packages, values of the command line)
is read here. A fault is a ValueError of one sentence, without the file's name.
"""

import json
import math
import os
import re
import tomllib
from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from pathlib import Path
from typing import Any

from .errors import MistakeError

LARGEST = 50_000_000  # bytes of a file
DEEPEST = 50  # tables and lists inside each other; a scenario has 5
LONGEST_KEY = 1000
LONGEST_NAME = 255  # bytes of a file's, on every common system
# Of TOML: what fits into 64 bits.
INTEGERS = range(-(2**63), 2**63)
# tomllib's time for a dotted key grows with the square of its parts.
MOST_DOTS = 1000
_NUMBER = re.compile(r"(?<![.\d])\d+\.\d+(?![.\d])")
# A value without quotes in a line of TOML; a comma between digits is a part of it.
_BARE = re.compile(r"([\w.-]+)\s*=\s*([^\s\"'\[{#](?:,(?=\d)|[^,}#\"])*?)\s*(?=,(?!\d)|[}#]|$)")
_COMMA = re.compile(r"(?<=\d),(?=\d)")
_PLACE = re.compile(r"\(at line (\d+), column \d+\)$")
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")


def read_bytes(path: Path) -> bytes:
    """The content of a file; OSError if it cannot be read, ValueError if it is none, or too large."""
    try:
        if path.exists() and not path.is_file():
            raise ValueError("is no plain file")
    except OSError as error:
        raise ValueError(f"is no file ({error.strerror})") from None
    with path.open("rb") as file:
        data = file.read(LARGEST + 1)
    if len(data) > LARGEST:
        raise ValueError(f"is larger than {LARGEST / 1e6:g} MB")
    return data


def read_text(path: Path) -> str:
    """The text of a file; OSError and ValueError as `read_bytes`, ValueError if it is not UTF-8.

    Editors of Windows put a byte order mark before it, which says nothing.
    """
    return read_bytes(path).decode("utf-8-sig")


def to_path(written: str | Path) -> Path:
    """The path, with the home folder for ~; MistakeError for a name that no file can have."""
    try:
        path = Path(written).expanduser()
    except RuntimeError:
        path = Path(written)
    if "\0" in str(path) or any(len(os.fsencode(part)) > LONGEST_NAME for part in path.parts):
        raise MistakeError(f"{str(written)!r}: no file can have such a name; give another")
    return path


def read_toml(path: Path, mistake: type[MistakeError] = MistakeError, hint: str = "") -> dict[str, Any]:
    """The tables of a TOML file; a mistake that names the file, with the hint if it is none."""
    try:
        return parse_toml(read_text(path))
    except OSError as error:
        raise mistake(f"{path}: cannot be read ({error.strerror})") from None
    except ValueError as error:
        raise mistake(f"{path}: not a valid TOML file: {error}{hint}") from None


def parse_toml(text: str) -> dict[str, Any]:
    """The tables of a TOML text."""
    try:
        found = _load_toml(text)
    except RecursionError:
        raise ValueError(f"more than {DEEPEST} tables and lists inside each other") from None
    _check(found)
    return found


def parse_json(text: str) -> Any:
    """The content of a JSON text."""
    try:
        found = json.loads(text)
    except RecursionError:
        raise ValueError(f"more than {DEEPEST} objects and lists inside each other") from None
    _check(found)
    return found


def to_plain(value: Any) -> Any:
    """What JSON has of values, also of numpy, and dataclasses: null for numbers that it has not."""
    if is_dataclass(value) and not isinstance(value, type):
        return to_plain(asdict(value))
    if isinstance(value, dict):
        return {str(key): to_plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [to_plain(item) for item in value]
    if isinstance(value, bool | int | str | type(None)):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if hasattr(value, "item"):  # a number of numpy, which only some commands import
        return to_plain(value.item())
    if isinstance(value, Path):
        return str(value)
    raise TypeError(f"{value!r}: has no JSON")


def parse_value(text: str) -> Any:
    """The value of a setting: as in TOML, else the text itself."""
    written = text.strip()
    try:
        found = _load_toml(f"value = {written}")
    except (ValueError, RecursionError):  # also of numbers with thousands of digits
        found = {}
    value = found["value"] if len(found) == 1 else written
    _check(value)
    return value


def _load_toml(text: str) -> dict[str, Any]:
    for number, line in enumerate(text.splitlines(), 1):
        if line.count(".") > MOST_DOTS and _NUMBER.sub("", line).count(".") > MOST_DOTS:
            raise ValueError(f"line {number}: has more than {MOST_DOTS} dots")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        place = _PLACE.search(str(error))
        remedy = _find_bare(text.split("\n")[int(place[1]) - 1]) if place else ""
        raise ValueError(f"{error}{remedy}") from None


def _find_bare(line: str) -> str:
    """The remedy for the first value of a line that has no quotes and should."""
    for key, value in _BARE.findall(line[:LONGEST_KEY]):
        made = _COMMA.sub(".", value)
        if value in ("True", "False"):
            return f"; write {key} = {value.lower()}"
        if is_toml(value):
            continue
        if is_toml(made):
            return f"; a number has a decimal point: {key} = {made}"
        return f'; a text, or a number with a unit, stands in quotes: {key} = "{made}"'
    return ""


def is_toml(value: str) -> bool:
    """Whether a text is a value of TOML."""
    try:
        tomllib.loads(f"value = {value}")
    except ValueError:
        return False
    return True


def _check(content: Any) -> None:
    """ValueError for what nothing can be, wherever it stands."""
    level = [content]
    for _ in range(DEEPEST):
        below = []
        for item in level:
            if isinstance(item, Mapping):
                below += [*item, *item.values()]
                if any(len(key) > LONGEST_KEY for key in item):
                    raise ValueError(f"a key is longer than {LONGEST_KEY} characters")
            elif isinstance(item, list):
                below += item
            elif isinstance(item, str) and (found := _CONTROL.search(item)):
                raise ValueError(f"a text has the control character U+{ord(found[0]):04X}: leave it out")
            elif isinstance(item, int) and item not in INTEGERS:
                raise ValueError("a whole number does not fit into 64 bits; write a decimal point")
        level = below
        if not level:
            return
    raise ValueError(f"more than {DEEPEST} tables and lists inside each other")
