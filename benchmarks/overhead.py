"""Cost of a macro step outside the FMUs' own calls: our masters against a bare ctypes loop, inputs held.

The same loop without moving values measures the calls alone. Both loops call through ctypes, at some 0.3 us a
call; our masters call from compiled code and may take less than the calls alone.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from orchestrator.masters import GaussSeidel, Jacobi
from orchestrator.run.plan import build_system, resolve_start
from orchestrator.scenario.files import load

from .loops import run_bare, run_master
from .measure import measure_medians

CALLS, BARE = "calls", "bare ctypes loop"


def measure() -> dict[str, float]:
    """Seconds per macro step: of the calls alone, of the bare loop, and of our masters."""
    scenario = load("valve-train")
    system = resolve_start(scenario, build_system(scenario))
    candidates: dict[str, Callable[[], float]] = {
        CALLS: partial(run_bare, system, moving=False),
        BARE: partial(run_bare, system),
        "gauss_seidel, hold": partial(run_master, system, GaussSeidel("hold")),
        "jacobi, hold": partial(run_master, system, Jacobi("hold")),
    }
    return measure_medians(candidates)


def rows() -> list[tuple[str, str]]:
    """Figures for the report."""
    found = measure()
    calls, bare = found.pop(CALLS), found[BARE]
    return [("overhead: the FMUs' own calls in a macro step", f"{1e6 * calls:.1f} us")] + [
        (
            f"overhead: {name}, outside the calls",
            f"{1e6 * (each - calls):.1f} us ({each / bare:.2f} x bare loop)",
        )
        for name, each in found.items()
    ]
