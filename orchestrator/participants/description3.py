"""What fmpy does not read of descriptions of FMI 3.0: event mode, clocks, ranges of unsigned integers; and
the arrays whose sizes follow from structural parameters."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

# intervalVariability: what ticks at intervals of the FMU's, and what does not tick by time. All others tick
# periodically.
CHANGING, COUNTDOWN, TRIGGERED = "changing", "countdown", "triggered"
STRUCTURAL = "structuralParameter"
# Periods that the importer may set, where the description states one.
SETTABLE = ("fixed", "tunable")


@dataclass(frozen=True)
class Clock:
    """Ticks every `interval` (s) from `shift` (s) after the start on, or as its `variability` says.

    `interval`: None if the FMU has to be asked.
    """

    name: str
    reference: int
    causality: str
    variability: str
    interval: float | None
    shift: float

    @property
    def settable(self) -> bool:
        """Whether a run may set its interval."""
        return self.variability in SETTABLE and self.interval is not None


@dataclass(frozen=True)
class EventMode:
    """Of a co-simulation FMU: its clocks by name, and the clocks of clocked variables, by name."""

    clocks: Mapping[str, Clock]
    clocked: Mapping[str, tuple[str, ...]]


def complete(found: Any, root: ElementTree.Element) -> EventMode | None:
    """Complete fmpy's description, of FMI 3.0; its event mode in co-simulation."""
    listed = root.find("ModelVariables")
    stated = {one.get("name", ""): one for one in (() if listed is None else listed)}
    for variable in found.modelVariables:
        if variable.type.startswith("UInt") and variable.name in stated:
            variable.min, variable.max = (stated[variable.name].get(key) for key in ("min", "max"))
    kind = root.find("CoSimulation")
    if kind is None or kind.get("hasEventMode") not in ("true", "1"):
        return None
    clocks = {name: _read_clock(one) for name, one in stated.items() if one.tag == "Clock"}
    names = {clock.reference: name for name, clock in clocks.items()}
    clocked = {
        name: tuple(names[int(word)] for word in one.get("clocks", "").split() if int(word) in names)
        for name, one in stated.items()
        if one.tag != "Clock" and one.get("clocks")
    }
    return EventMode(clocks, clocked)


def _read_clock(element: ElementTree.Element) -> Clock:
    def read(key: str) -> float | None:
        if (text := element.get(f"{key}Decimal")) is not None:
            return float(text)
        counter, resolution = element.get(f"{key}Counter"), element.get("resolution")
        return None if counter is None or resolution is None else int(counter) / int(resolution)

    return Clock(
        element.get("name", ""),
        int(element.get("valueReference", 0)),
        element.get("causality", "local"),
        element.get("intervalVariability", ""),
        read("interval"),
        read("shift") or 0.0,
    )


def resize(found: Any, sizes: Mapping[str, int]) -> None:
    """Give fmpy's description these values of structural parameters, and arrays the shapes that follow."""
    if not sizes:
        return
    for variable in found.modelVariables:
        if variable.causality == STRUCTURAL and variable.name in sizes:
            variable.start = str(sizes[variable.name])
    for variable in found.modelVariables:
        variable.shape = tuple(
            int(d.variable.start if d.start is None else d.start) for d in variable.dimensions
        )
    found.numberOfContinuousStates = _count(found.derivatives)
    found.numberOfEventIndicators = _count(found.eventIndicators)


def _count(unknowns: Any) -> int:
    return sum(math.prod(unknown.variable.shape) for unknown in unknowns)
