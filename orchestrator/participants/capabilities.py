"""What the file of an FMU offers, before anything of it is run."""

import difflib
from collections.abc import Iterable, Sequence
from pathlib import Path

from models.core.quantities import INPUT_COEFFICIENTS, Field, Quantity

from .description import Description, DescriptionError, read_description

HIGHEST = INPUT_COEFFICIENTS - 1


def find_missing(path: Path, names: Iterable[str]) -> list[str]:
    """What keeps the FMU at `path` from being a participant with these variables; nothing of it is run."""
    try:
        description = read_description(path)
    except DescriptionError as error:
        return [str(error)]
    known = list(description.variables)
    absent = [name for name in names if name not in known]
    model = f"the FMU of {description.model} has no variable"
    return [f"{model} {name!r}{_suggest(name, known)}" for name in absent]


def signal_degrees(about: Description, names: Iterable[str]) -> list[int]:
    """The degree of the polynomial in time that the FMU follows, for each of these inputs; 0: it holds it.

    What changes at events only has no slope to follow: nothing limits its signal. Nor does anything limit
    those of an FMU that is integrated here.
    """
    known = about.variables

    def degree(name: str) -> int:
        if (
            about.integrated
            or known[name].stepwise
            or (about.interpolates and name_derivative(name, 1) not in known)
        ):
            return HIGHEST
        absent = (k for k in range(1, HIGHEST + 1) if name_derivative(name, k) not in known)
        return next(absent, HIGHEST + 1) - 1

    return [degree(name) for name in names]


def name_derivative(name: str, order: int) -> str:
    """The name of the input that takes the derivative of that order of the input `name`."""
    return Field(name, Quantity("1", ""), 0.0).add_suffix(f"_der{order}")


def _suggest(name: str, known: Sequence[str]) -> str:
    close = difflib.get_close_matches(name, known, n=1)
    return f" (has it {close[0]}?)" if close else ""
