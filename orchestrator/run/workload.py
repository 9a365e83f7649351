"""Estimate what a long run needs: macro steps, disk and memory before it starts, then its time."""

from __future__ import annotations

import math
import shutil
import time as clock
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from models.core.quantities import Vector

from ..engine.step import Step
from ..scenario import Scenario
from .recording import STEP_VARIABLES

# A run with more steps, more bytes on the disk or more time is said to be long: about a minute here.
LONG_STEPS, LARGE, LONG_SECONDS = 1_000_000, 1e9, 60.0
# Rows stand in a journal, in the result file (as if nothing could be compressed) and, of the outputs, as text
# of 20 characters in the CSV file, all at once at the end.
STORED, AS_TEXT = 8 + 8, 20
# Bytes of a macro step in memory when the steps are diagnosed: 7 numbers as read and as kept.
IN_MEMORY = 100
# The speed is that of the first seconds, when all is compiled.
MEASURED_SECONDS = 2.0
# A stop time (s) as long as this may be one in ms without its unit.
DOUBTFUL = 10.0


class Workload(NamedTuple):
    """Macro steps, records, and bytes at most on the disk and in memory."""

    steps: int
    records: int
    disk: int
    memory: int

    @classmethod
    def of(cls, scenario: Scenario, outputs: int) -> Workload:
        """Of a scenario without step control whose components have so many outputs."""
        steps = math.ceil(scenario.stop_time / scenario.macro_step * (1.0 - 1e-9))
        records = steps // scenario.record_every + 2  # the start and the end
        numbers = records * (outputs + 1) + steps * (len(STEP_VARIABLES) + 1)
        return cls(steps, records, numbers * STORED + records * (outputs + 1) * AS_TEXT, steps * IN_MEMORY)


def announce(scenario: Scenario, outputs: int, out: Path) -> str:
    """A line about a long run with so many outputs, before it starts; "" for a short one, and with step
    control, where the steps are not known."""
    if scenario.step_control is not None:
        return ""
    steps, records, disk, memory = Workload.of(scenario, outputs)
    if steps < LONG_STEPS and disk < LARGE:
        return ""
    stop, free = scenario.stop_time, shutil.disk_usage(out).free
    line = (
        f"long run: {stop:g} s in steps of {scenario.macro_step:g} s are {steps:,} macro steps "
        f"({_bytes(memory)} of memory); {records:,} records need up to {_bytes(disk)} on the disk "
        f"({_bytes(free)} are free)"
    )
    if disk > free:
        line += "; make output_step longer"
    if stop >= DOUBTFUL:
        line += f' (if {stop:g} ms were meant: stop_time = "{stop:g} ms")'
    return line


class Forecast:
    """An observer that says once how long the coupled run will take, if that is long."""

    def __init__(self, stop_time: float, tell: Callable[[str], None]) -> None:
        self._stop, self._tell = stop_time, tell
        self._began: tuple[float, float] | None = None
        self._told = False

    def begin(self, names: Sequence[str]) -> None:
        pass

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        if self._told:
            return
        now = clock.monotonic()
        if self._began is None:
            self._began = time, now
        start, began = self._began
        if now - began < MEASURED_SECONDS or time <= start:
            return
        self._told = True
        left = (now - began) * (self._stop - time) / (time - start)
        if left > LONG_SECONDS:
            self._tell(f"the coupled run will take about {duration(left)} at this speed; Ctrl-C ends it")

    def restart(self) -> None:
        """Measure anew from the next step: kernels were compiled, which the other steps do not repeat."""
        self._began = None

    def end(self, complete: bool, message: str) -> None:
        pass


def duration(seconds: float) -> str:
    """In the longest unit of which it has two."""
    units = (("years", 365.25 * 86400.0), ("days", 86400.0), ("h", 3600.0), ("min", 60.0), ("s", 0.0))
    return next(f"{seconds / max(size, 1.0):.0f} {unit}" for unit, size in units if seconds >= 2.0 * size)


def _bytes(size: float) -> str:
    units = (("TB", 1e12), ("GB", 1e9), ("MB", 1e6), ("kB", 0.0))
    return next(f"{size / max(one, 1e3):.3g} {unit}" for unit, one in units if size >= one)
