"""Time of a macro step against the number of instances: valve trains on one crankshaft, up to 193 instances.

In processor time, which other programs on the machine change less than wall time.
"""

from __future__ import annotations

import numpy as np

from fmus.build import build
from models.system import System
from orchestrator.masters import GaussSeidel
from orchestrator.participants import fmu, in_process
from orchestrator.simulation import simulate

from .many_valves import valve_trains
from .measure import Clock

VALVES = (1, 2, 4, 8, 16, 32, 64)
STEPS, STEP = 500, 2e-6
ROUNDS = 3


def seconds_per_step(system: System, packaged: bool) -> float:
    """Processor time of a macro step of the Gauss-Seidel master with quadratic signals."""
    participants = {
        name: fmu(name, build(i.component.name, structure=i.component.structure), i)
        if packaged
        else in_process(name, i)
        for name, i in system.instances.items()
    }
    clock = Clock()
    try:
        simulate(system, participants, GaussSeidel("quadratic"), STEP, STEPS * STEP, [clock])
    finally:
        for participant in participants.values():
            participant.close()
    return clock.elapsed / STEPS


def rows() -> list[tuple[str, str]]:
    """Figures for the report."""
    systems = [valve_trains(count) for count in VALVES]
    sizes = [len(system.instances) for system in systems]
    found = []
    for kind, packaged in (("in process", False), ("FMUs", True)):
        times = [min(seconds_per_step(system, packaged) for _ in range(ROUNDS)) for system in systems]
        exponent = np.polyfit(np.log(sizes), np.log(times), 1)[0]
        for size, each in zip(sizes, times, strict=True):
            figure = f"scaling: {size} instances, {kind}, time of a macro step"
            found.append((figure, f"{1e6 * each:.0f} us ({1e6 * each / size:.1f} us an instance)"))
        found.append((f"scaling: {kind}, exponent of time over instances", f"{exponent:.2f}"))
    return found
