"""What a step of an FMU costs in the run's process and in one of its own.

A macro step of `two-masses`, Jacobi with held inputs. Wall time, for the processes work in turn.
"""

from __future__ import annotations

import time

from orchestrator.masters import Jacobi
from orchestrator.run.participants import build_participants
from orchestrator.run.plan import resolve_fmus
from orchestrator.run.simulation import simulate
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system
from tribocosim.cached_fmus import build_fmu

from .measure import Clock, measure_medians

STEPS = 2_000


def measure_step(process: str) -> float:
    """Wall time of a macro step (s)."""
    parts = ("first", "second")
    scenario = load("two-masses", [f"components.{part}.process={process}" for part in parts])
    step, clock = scenario.macro_step, Clock(time.perf_counter)
    system, files = build_system(scenario), resolve_fmus(scenario, build_fmu)
    units = build_participants(scenario, system, files, lambda name, make: make())
    try:
        simulate(system, units, Jacobi("hold"), step, STEPS * step, [clock])
    finally:
        for unit in units.values():
            unit.close()
    return clock.elapsed / STEPS


def measure() -> list[tuple[str, str]]:
    """Figures and their values."""
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
