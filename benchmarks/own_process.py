"""What a step of an FMU costs in the run's process and in one of its own.

A macro step of `two-masses`, Jacobi with held inputs. Wall time, for the processes work in turn.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from models.core.quantities import Vector
from orchestrator.command_line.fmu import build_fmu
from orchestrator.engine.step import Step
from orchestrator.masters import Jacobi
from orchestrator.run.participants import build_participants
from orchestrator.run.plan import resolve_fmus
from orchestrator.run.simulation import simulate
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system

from .measure import measure_medians

STEPS = 2_000


class WallClock:
    """An observer that takes the wall time of the stepping, `elapsed` (s)."""

    def begin(self, names: Sequence[str]) -> None:
        pass

    def observe(self, time_: float, outputs: Callable[[], Vector], step: Step) -> None:
        if step.length == 0.0:
            self._began = time.perf_counter()

    def end(self, complete: bool, message: str) -> None:
        self.elapsed = time.perf_counter() - self._began


def measure_step(process: str) -> float:
    """Of a macro step with both FMUs there."""
    parts = ("first", "second")
    scenario = load("two-masses", [f"components.{part}.process={process}" for part in parts])
    step, clock = scenario.macro_step, WallClock()
    units = build_participants(
        scenario,
        system := build_system(scenario),
        resolve_fmus(scenario, build_fmu),
        lambda name, make: make(),
    )
    try:
        simulate(system, units, Jacobi("hold"), step, STEPS * step, [clock])
    finally:
        for unit in units.values():
            unit.close()
    return clock.elapsed / STEPS


def rows() -> list[tuple[str, str]]:
    """Figures for the report."""
    found = measure_medians(
        {process: lambda process=process: measure_step(process) for process in ("shared", "own")}
    )
    each = (found["own"] - found["shared"]) / 2
    return [
        ("own process: a macro step of two FMUs in the run's process", f"{1e6 * found['shared']:.1f} us"),
        (
            "own process: the same in a process for each",
            f"{1e6 * found['own']:.1f} us ({1e6 * each:.1f} us more for each FMU)",
        ),
    ]
