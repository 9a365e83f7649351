"""What the file of an FMU offers, before anything of it is run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from models.core.errors import suggestion
from models.core.quantities import INPUT_COEFFICIENTS, Field, Quantity

if TYPE_CHECKING:  # which imports a compiler, that the process of an FMU does without
    from models.core.system import Connection, Port

from .description import Description, DescriptionError, read_description
from .protocol import Abilities

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
    return [f"{model} {name!r}; {suggestion(name, known)}" for name in absent]


def uses_event_mode(about: Description) -> bool:
    """Whether an FMU is run in its event mode. Those of our components do the same without."""
    return about.events is not None and not about.is_own


def list_abilities(about: Description, unit: Any) -> Abilities:
    """Those of an FMU whose `unit` implements `SideChannel` and `Derivatives` as well."""
    between = uses_event_mode(about) or about.list_texts("input", "output")
    return Abilities(
        about.restorable,
        about.variable_step,
        about.divisible,
        unit if between and not about.integrated else None,
        unit,
        unit.warnings,
        unserialisable=about.unserialisable,
    )


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


def find_highest_degrees(connections: Sequence[Connection], followed: Mapping[Port, int]) -> dict[Port, int]:
    """By source, from the degree that is `followed` at each target.

    A signal has the lowest degree of all its targets, and a loop of participants one degree. An input that is
    held (0) gets the mean of its signal, whatever its degree (see `held_inputs`).
    """
    names = list(dict.fromkeys(port.instance for c in connections for port in (c.source, c.target)))
    ends = np.array([[names.index(p.instance) for p in (c.source, c.target)] for c in connections], dtype=int)
    reach = np.eye(len(names))
    reach[tuple(ends.reshape(-1, 2).T)] = 1.0
    for _ in range(len(names).bit_length()):
        reach = np.sign(reach @ reach)
    loop = [int(row.argmax()) for row in reach * reach.T]  # the first of those that reach each other
    own: dict[Port, int] = {}
    of_loop: dict[int, int] = {}
    for c, (source, target) in zip(connections, ends, strict=True):
        degree = followed[c.target] or HIGHEST
        own[c.source] = min(degree, own.get(c.source, HIGHEST))
        if loop[source] == loop[target]:
            of_loop[loop[source]] = min(degree, of_loop.get(loop[source], HIGHEST))
    found = own.copy()
    for c, (source, target) in zip(connections, ends, strict=True):
        if loop[source] == loop[target]:
            found[c.source] = min(found[c.source], of_loop[loop[source]])
    return found
