"""What the file of an FMU offers, before anything of it is run."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from pathlib import Path

from models.quantities import Field, Layout, Quantity

from .description import DescriptionError, described


def missing(path: Path, names: Iterable[str]) -> list[str]:
    """What keeps the FMU at `path` from being a participant with these variables; nothing of it is run."""
    try:
        description = described(path)
    except DescriptionError as error:
        return [str(error)]
    known = list(description.variables)
    absent = [name for name in names if name not in known]
    model = f"the FMU of {description.model} has no variable"
    return [f"{model} {name!r}{_nearest(name, known)}" for name in absent]


def signal_degrees(path: Path, inputs: Layout) -> dict[str, int]:
    """The degree of the polynomial that the FMU at `path` follows, by input; 0: it holds the value."""
    about = described(path)
    known = about.variables

    def degree(name: str) -> int:
        if about.interpolates and derivative(name, 1) not in known:
            return 3
        absent = (k for k in range(1, 4) if derivative(name, k) not in known)
        return next(absent, 4) - 1

    return {name: degree(name) for name in inputs.names}


def derivative(name: str, order: int) -> str:
    """The name of the input that takes the derivative of that order of the input `name`."""
    return Field(name, Quantity("1", ""), 0.0).suffixed(f"_der{order}")


def _nearest(name: str, known: Sequence[str]) -> str:
    close = difflib.get_close_matches(name, known, n=1)
    return f" (has it {close[0]}?)" if close else ""
