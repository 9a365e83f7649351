"""The monolithic reference: seconds per cam revolution of `valve-train`, and its own uncertainty."""

from __future__ import annotations

import numpy as np

from models.monolithic import solve
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, resolve_start


def rows() -> list[tuple[str, str]]:
    """Figures for the report."""
    scenario = load("valve-train")
    system = resolve_start(scenario, build_system(scenario))
    times = np.linspace(0.0, 0.06, 3001)
    solve(system, times[:3])  # compile
    reference = solve(system, times)
    load_difference = reference.uncertainty["contact.load"]
    return [
        ("reference: one revolution by both methods", f"{reference.wall_time_s:.2f} s"),
        ("reference: relative RMS difference of the contact load", f"{load_difference.relative_rms:.1e}"),
    ]
