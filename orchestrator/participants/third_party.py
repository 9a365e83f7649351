"""The component of a third-party FMU: variables, units and ranges as its description states them.

Its equations are unknown, so there is no reference, equilibrium or energy account.
"""

import functools
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from fmus.fmi.archive import FmuFileError, archive_faults, open_archive
from models.core.component import Component
from models.core.quantities import Field, FieldLayout, Layout, Quantity, Vector
from models.core.system import ModelError

from .description import (
    BOOLEANS,
    CO_SIMULATION,
    INTEGERS,
    NO_SIZES,
    Description,
    DescriptionError,
    Variable,
    find_range,
    read_description,
)

# `initial` of what can be given a start value though it is no parameter and no input.
WITH_START = ("exact", "approx")


class NamedLayout(FieldLayout):
    """A layout whose vectors are not read as records: names may be those of attributes."""

    def view(self, vector: Vector) -> Any:
        return vector


@dataclass(frozen=True, eq=False)
class ThirdPartyComponent(Component):
    """The component of a third-party FMU: its description, and its structural parameters."""

    # Given always; they come after fields with defaults.
    about: Description = None  # type: ignore[assignment]
    sizes: Layout = None  # type: ignore[assignment]


def read_component(
    path: Path, interface: str = CO_SIMULATION, sizes: Mapping[str, int] = NO_SIZES
) -> Component:
    """Read the FMU, with these structural parameters, as a component.

    ValueError, with the path, if it cannot be used by this interface.
    """
    try:
        status = path.stat()
    except OSError:
        raise ValueError(f"{path}: no such file") from None
    given = tuple(sorted(sizes.items()))
    return _read_component(path, interface, given, status.st_mtime_ns, status.st_size)


@functools.lru_cache(maxsize=256)
def _read_component(
    path: Path, interface: str, sizes: tuple[tuple[str, int], ...], changed: int, size: int
) -> Component:
    try:
        with open_archive(path) as archive:
            if faults := archive_faults(archive):
                raise FmuFileError(f"{path}: {faults[0]}; give another file")
        about = read_description(path, interface, dict(sizes))
    except DescriptionError as error:
        raise ValueError(f"{path}: {error}; give another file") from None
    numbers = [v for v in about.variables.values() if v.numeric]
    # Of one that only shows what is inside, that is recorded.
    outputs = [v for v in numbers if v.causality == "output"] or [
        v for v in numbers if v.causality == "local" and v.variability in ("continuous", "discrete")
    ]
    inputs = list(about.list_variables("input"))
    every = tuple(v.name for v in inputs)
    return ThirdPartyComponent(
        name=about.model,
        description=about.text,
        parameters=NamedLayout([*_build_fields(v for v in numbers if v.settable), *_build_intervals(about)]),
        state=_build_layout(v for v in about.variables.values() if v.numeric and _has_start(v)),
        inputs=_build_layout(inputs),
        outputs=_build_layout(outputs),
        derivative=_refuse_equations,
        output=_refuse_equations,
        energy=_refuse_equations,
        feedthrough={v.name: about.depends.get(v.name, every) for v in outputs},
        opaque=True,
        about=about,
        sizes=_build_layout(about.structural.values()),
    )


def _has_start(variable: Variable) -> bool:
    return (
        variable.causality in ("output", "local")
        and variable.initial in WITH_START
        and variable.variability != "constant"
    )


def _build_layout(variables: Iterable[Variable]) -> NamedLayout:
    return NamedLayout(_build_fields(variables))


def _build_fields(variables: Iterable[Variable]) -> Iterator[Field]:
    """With start values (default 0) within the variables' ranges."""
    for v in variables:
        start = 0.0 if v.start is None or not math.isfinite(v.start) else v.start
        yield Field(v.name, build_quantity(v), min(max(start, v.minimum), v.maximum))


def _build_intervals(about: Description) -> Iterator[Field]:
    """The intervals of clocks that the environment may set, by the clocks' names."""
    for clock in about.events.clocks.values() if about.events else ():
        if clock.settable:
            quantity = Quantity(
                "s", f"interval of the clock {clock.name}", clock.interval or 1.0, positive=True
            )
            yield Field(clock.name, quantity, clock.interval or 0.0)


def build_quantity(variable: Variable) -> Quantity:
    """The quantity of a variable."""
    low, high = find_range(variable.type) if variable.type in INTEGERS else (-math.inf, math.inf)
    return Quantity(
        unit=variable.unit or ("1" if variable.discrete else ""),
        description=variable.description or variable.name,
        nominal=variable.nominal,
        minimum=max(variable.minimum, low),
        maximum=min(variable.maximum, high),
        boolean=variable.type in BOOLEANS,
        count=variable.discrete and variable.type not in BOOLEANS,
        relative=variable.relative,
        # A parameter is no signal: any value may be given.
        stepwise=variable.stepwise and variable.causality != "parameter",
    )


def _refuse_equations(*arguments: Any) -> NoReturn:
    raise ModelError("the equations of a third-party FMU are unknown")
