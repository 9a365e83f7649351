"""Where a scenario was made: its errors name the file, with the line where that is known, or the option."""

import functools
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar, cast

from models.core.errors import MistakeError
from models.core.remedies import in_python

from ..errors import Option

SET = Option("set")
Check = TypeVar("Check", bound=Callable[..., Any])


@dataclass(frozen=True)
class Origin:
    """A scenario's file, what the command changed in it, values by their paths, and the inputs
    "component.input" whose values only the files have that it extends."""

    path: Path
    changed: Mapping[str, Any] = field(default_factory=dict)
    inherited: frozenset[str] = frozenset()

    def find_source(self, said: str) -> str | Option:
        """The option, if a message names what it changed, or an unknown table of that; else the file, and the
        line that is meant."""
        unknown = f"{said.partition(': unknown key')[0]}."
        for path, value in self.changed.items():
            named = any(re.search(pattern, said) for pattern in _list_patterns(path, value))
            if named or path.startswith(unknown):
                return SET
        return _name_line(self.path, said)


def _list_patterns(path: str, value: Any) -> Iterator[str]:
    """How a message may name a value at this path."""
    table, _, key = path.rpartition(".")
    component = re.match(r"components\.(\w+)\.\w+\.(.+)", path)
    names = [path, *([".".join(component.groups())] if component else [])]
    for text in value if isinstance(value, list) else [value]:
        if isinstance(text, str) and text:
            names += [text, *re.findall(r"[\w.]+\.\w+", text)]  # the ends of a connection
    yield from (rf"(?<![\w.]){re.escape(name)}(?!\w)" for name in names)
    if not component:
        yield rf"(?<![\w.]){re.escape(key)}" + (" = " if table else r"(?!\w)")


def names_file(check: Check) -> Check:
    """A function of a scenario; source of its MistakeError is the scenario's file, or what changed that."""

    @functools.wraps(check)
    def named(scenario: Any, *arguments: Any, **options: Any) -> Any:
        try:
            return check(scenario, *arguments, **options)
        except MistakeError as error:
            if scenario.origin and not error.source:
                error.source = scenario.origin.find_source(in_python(error))
            raise

    return cast(Check, named)


def _name_line(path: Path, said: str) -> str:
    """The file, and its only line that is meant by a message that begins with keys, or quotes the line."""
    place, quoted = said.partition(": ")[0].partition(" ")[0], re.search("'(.+?)'", said)
    wanted = [place, place.removeprefix("tolerance.")] + ([quoted[1]] if quoted else [])
    try:
        lines = path.read_text("utf-8").splitlines() if path.suffix == ".toml" else []
    except (OSError, ValueError):
        lines = []
    table, by_key, heads = "", dict[str, list[int]](), dict[str, int]()
    for number, line in enumerate(lines, 1):
        if header := re.match(r"\s*\[([^\[\]]+)\]", line):
            table = f"{header[1].strip()}."
            heads.setdefault(table, number)
        elif key := re.match(r"\s*([\w.\"'-]+)\s*=", line):
            by_key.setdefault(re.sub("[\"']", "", table + key[1]), []).append(number)
    short = {re.sub(r"^components\.(\w+)\.\w+\.", r"\1.", key): places for key, places in by_key.items()}
    found = by_key.get(place, []) or short.get(place, [])
    for text in wanted if not found else ():
        pattern = rf"(?<![\w.]){re.escape(text)}(?![\w.])"
        found = [n for n, line in enumerate(lines, 1) if re.search(pattern, line.partition("#")[0])]
        if found:
            break
    if not found:  # of a key that is missing, the first header of its table, or of one inside that
        first = heads | {key: numbers[0] for key, numbers in by_key.items()}
        inside = [number for key, number in first.items() if key.startswith(f"{place.rpartition('.')[0]}.")]
        found = [min(inside)] if inside else []
    return f"{path.name}:{found[0]}" if len(found) == 1 else path.name
