"""The lines of `connections`: instance.output [* factor] [+ offset] -> instance.input."""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_FACTOR, _OFFSET = rf"(?P<factor>\s+\*\s+{_NUMBER})", rf"(?P<offset>\s+[+-]\s+{_NUMBER})"
# Instances are named with letters, so that a quote at the beginning is none of a name.
_PORT = r"(?:'(?P<quoted>.+?)'|(?P<port>[^\s'](?:.*?\S)??))"
_LINE = re.compile(rf"\s*{_PORT}{_FACTOR}?{_OFFSET}?\s*->\s*(?:'(?P<into>.+)'|(?P<target>[^\s'].*?))\s*")
# The ways to read what stands before the arrow.
_SOURCES = [re.compile(rf"(?P<port>\S.*?){numbers}") for numbers in (_OFFSET, _FACTOR, _FACTOR + _OFFSET)]


LONGEST = 2000  # characters of a line


@dataclass(frozen=True)
class Line:
    """target = factor * source + offset; without both, units are converted. As a text, ends are quoted where
    they contain an arrow, or what reads as a number."""

    source: str
    target: str
    factor: float | None = None
    offset: float | None = None

    def __str__(self) -> str:
        factor = "" if self.factor is None else f" * {self.factor!r}"
        sign = "-" if math.copysign(1.0, self.offset or 0.0) < 0.0 else "+"
        offset = "" if self.offset is None else f" {sign} {abs(self.offset)!r}"
        return f"{_quote(self.source)}{factor}{offset} -> {_quote(self.target)}"


def _quote(end: str) -> str:
    plain = end == end.strip() and "->" not in end and not any(pattern.fullmatch(end) for pattern in _SOURCES)
    return end if plain else f"'{end}'"


def parse_line(text: str) -> Line:
    """Parse a line; ValueError if it is no connection."""
    match = _LINE.fullmatch(text.strip()) if len(text) <= LONGEST else None
    source, target = (
        (match["quoted"] or match["port"], match["into"] or match["target"]) if match else ("", "")
    )
    if match is None or "." not in source or "." not in target:
        raise ValueError(
            f"{text!r}: a connection is written 'instance.output -> instance.input', or with numbers "
            "'instance.output * 1e-3 + 0.2 -> instance.input'"
        )
    factor, offset = (
        float(re.sub(r"[*\s]", "", match[key])) if match[key] else None for key in ("factor", "offset")
    )
    for number in (factor, offset):
        if number is not None and not math.isfinite(number):
            raise ValueError(f"{text!r}: factor and offset must be finite")
    return Line(source, target, factor, offset)


def parse_named_line(text: str, is_known: Callable[[str], bool]) -> Line:
    """As `parse_line`, where the names of ends that are known win: an output may be called "Sensor - 1".

    ValueError if what stands before the arrow may be several of them, with numbers.
    """
    for arrow in re.finditer("->", text[:LONGEST]):
        source, target = text[: arrow.start()].strip(), text[arrow.end() :].strip()
        if is_known(source) and is_known(target):
            return Line(source, target)
        read = [match["port"] for pattern in _SOURCES if (match := pattern.fullmatch(source))]
        found = [port for port in dict.fromkeys(read) if is_known(port)] if is_known(target) else []
        quoted = [f"'{port}'{source.removeprefix(port)}" for port in found]
        if len(found) > 1:
            meant = " or ".join(quoted)
            raise ValueError(f"{text!r}: may mean several outputs; write {meant}, with the quotes")
        if found:
            return parse_line(f"{quoted[0]} -> '{target}'")
    return parse_line(text)


def parse_ends(text: str) -> tuple[str, str]:
    """Source and target of a connection's line."""
    line = parse_line(text)
    return line.source, line.target
