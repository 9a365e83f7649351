"""What a step of an FMU costs in the run's process and in one of its own.

A macro step of `two-masses`, Jacobi with held inputs. Wall time, for the processes work in turn.
"""

from __future__ import annotations

import time

from orchestrator.masters import Jacobi
from orchestrator.run.participants import open_participants
from orchestrator.run.plan import make_plan
from orchestrator.run.simulation import simulate
from orchestrator.scenario.files import load
from tribocosim.cached_fmus import build_fmu
from tribocosim.reporting import SilentReporter

from .measure import Clock, measure_medians

STEPS = 2_000


def measure_step(process: str) -> float:
    """Wall time of a macro step (s)."""
    parts = ("first", "second")
    scenario = load("two-masses", [f"components.{part}.process={process}" for part in parts])
    step, clock = scenario.macro_step, Clock(time.perf_counter)
    plan = make_plan(scenario, build_fmu, SilentReporter())
    with open_participants(plan.system, plan.participants) as units:
        simulate(plan.system, units, Jacobi("hold"), step, STEPS * step, [clock])
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
