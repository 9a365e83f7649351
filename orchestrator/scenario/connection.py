"""The lines of `connections`: instance.output [* factor] [+ offset] -> instance.input."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_SOURCE = re.compile(
    rf"(?P<port>\S(?:.*?\S)??)(?P<factor>\s+\*\s+{_NUMBER})?(?P<offset>\s+[+-]\s+{_NUMBER})?"
)


@dataclass(frozen=True)
class Line:
    """target = factor * source + offset; without both, units are converted."""

    source: str
    target: str
    factor: float | None = None
    offset: float | None = None

    def __str__(self) -> str:
        factor = "" if self.factor is None else f" * {self.factor!r}"
        sign = "-" if math.copysign(1.0, self.offset or 0.0) < 0.0 else "+"
        offset = "" if self.offset is None else f" {sign} {abs(self.offset)!r}"
        return f"{self.source}{factor}{offset} -> {self.target}"


def parse_line(text: str) -> Line:
    """Parse a line; ValueError if it is no connection."""
    left, arrow, target = (part.strip() for part in text.partition("->"))
    match = _SOURCE.fullmatch(left)
    if not arrow or match is None or "." not in match["port"] or "." not in target:
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
    return Line(match["port"], target, factor, offset)


def parse_ends(text: str) -> tuple[str, str]:
    """Source and target of a connection's line."""
    line = parse_line(text)
    return line.source, line.target
