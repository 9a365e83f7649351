"""The file that a scenario was read from: its errors name it, with the line where that is known."""

import functools
import re
from collections.abc import Callable
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, cast

from models.core.errors import MistakeError
from models.core.remedies import in_python, name_source

from ..errors import Option

if TYPE_CHECKING:
    from .scenario import Scenario

SET = Option("set")
Check = TypeVar("Check", bound=Callable[..., Any])
# Whether a check runs inside another, which names the file.
_inside: ContextVar[bool] = ContextVar("inside", default=False)


@dataclass(frozen=True)
class Origin:
    """A scenario's file; `unchanged` reads it without what the command changed, if it changed anything."""

    path: Path
    unchanged: Callable[[], "Scenario"] | None = None


def names_file(check: Check) -> Check:
    """A function of a scenario, whose MistakeError begins with its file, or the option that changed it."""

    @functools.wraps(check)
    def named(scenario: "Scenario", *arguments: Any, **options: Any) -> Any:
        origin = None if _inside.get() else scenario.origin
        token = _inside.set(True)
        try:
            return check(scenario, *arguments, **options)
        except MistakeError as error:
            if origin is None:
                raise
            said = in_python(error)
            changed = origin.unchanged and _said_by(check, origin.unchanged, arguments, options) != said
            place = name_place(origin.path, in_python(error.fault)).removesuffix(":")
            error.fault = (SET, " ", error.fault) if changed else name_source(place, error.fault)
            error.args = error.fault, *error.remedies
            raise
        finally:
            _inside.reset(token)

    return cast(Check, named)


def _said_by(check: Any, unchanged: Callable[[], "Scenario"], arguments: Any, options: Any) -> str:
    try:
        check(unchanged(), *arguments, **options)
    except MistakeError as error:
        return in_python(error)
    return ""


def name_place(path: Path, said: str) -> str:
    """The file, and its only line that is meant by a message that begins with keys, or quotes the line."""
    place, quoted = said.partition(": ")[0].partition(" ")[0], re.search("'(.+?)'", said)
    wanted = [place, place.removeprefix("tolerance.")] + ([quoted[1]] if quoted else [])
    try:
        lines = path.read_text("utf-8").splitlines() if path.suffix == ".toml" else []
    except (OSError, ValueError):
        lines = []
    table, by_key = "", dict[str, list[int]]()
    for number, line in enumerate(lines, 1):
        if header := re.match(r"\s*\[([^\[\]]+)\]", line):
            table = f"{header[1].strip()}."
        elif key := re.match(r"\s*([\w.\"'-]+)\s*=", line):
            by_key.setdefault(re.sub("[\"']", "", table + key[1]), []).append(number)
    short = {re.sub(r"^components\.(\w+)\.\w+\.", r"\1.", key): places for key, places in by_key.items()}
    found = by_key.get(place, []) or short.get(place, [])
    for text in wanted if not found else ():
        pattern = rf"(?<![\w.]){re.escape(text)}(?![\w.])"
        found = [n for n, line in enumerate(lines, 1) if re.search(pattern, line.partition("#")[0])]
        if found:
            break
    return f"{path.name}:{found[0]}:" if len(found) == 1 else f"{path.name}:"
