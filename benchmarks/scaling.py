"""Time of a macro step against the number of instances: from the crankshaft alone to 21 valve trains on it.

In processor time, which other programs on the machine change less than wall time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fmus.build import build
from models.core.system import Instance, System
from orchestrator.masters import GaussSeidel
from orchestrator.participants import in_process, open_fmu
from orchestrator.run.simulation import simulate
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, resolve_start
from orchestrator.scenario.values import build_component

from .measure import Clock

SIZES = (1, 2, 4, 8, 16, 32, 64)
STEPS, STEP = 500, 2e-6
ROUNDS = 3


def build_valve_trains(count: int) -> System:
    """As many rigid valve trains on one crankshaft, all alike and at rest on their base circles."""
    scenario = load("valve-train")
    one = resolve_start(scenario, build_system(scenario))
    crankshaft = build_component("flywheel", (("loads", count),))
    instances = {"flywheel": Instance(crankshaft, one.instances["flywheel"].parameters)}
    connections = []
    for i in range(1, count + 1):
        instances |= {f"{n}_{i}": one.instances[n] for n in ("camshaft", "valve_spring", "contact")}
        connections += [(_rename(str(c.source), i), _rename(str(c.target), i)) for c in one.connections]
    return System(instances, connections)


def _rename(port: str, number: int) -> str:
    if port.startswith("flywheel."):
        return port.replace("[1]", f"[{number}]")
    return port.replace(".", f"_{number}.", 1)


def build_sized(count: int) -> System:
    """The first `count` instances of valve trains on one crankshaft; the last train may lack parts."""
    whole = build_valve_trains(max(1, -(-(count - 1) // 3)))
    instances = dict(list(whole.instances.items())[:count])
    connections = [c for c in whole.connections if {c.source.instance, c.target.instance} <= set(instances)]
    return System(instances, [(str(c.source), str(c.target)) for c in connections])


def time_step(system: System, packaged: bool) -> float:
    """Processor time of a macro step of the Gauss-Seidel master with quadratic signals."""
    participants = {
        name: open_fmu(name, build(i.component.name, structure=i.component.structure), i)
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


@dataclass(frozen=True)
class Growth:
    """Times of a macro step (s) over the number of instances.

    `fixed` + `each` n is the line through the times that misses them least relative to themselves; `off` is
    the largest of what it misses them by, over the times.
    """

    times: dict[int, float]
    fixed: float
    each: float
    off: float

    def __str__(self) -> str:
        line = f"{1e6 * self.fixed:.1f} us + {1e6 * self.each:.1f} us an instance"
        return f"{line}, to {100.0 * self.off:.0f} %"


def measure_growth(packaged: bool, rounds: int = ROUNDS) -> Growth:
    """The shortest of some runs for each size."""
    times = {n: min(time_step(build_sized(n), packaged) for _ in range(rounds)) for n in SIZES}
    n, t = np.array(list(times)), np.array(list(times.values()))
    matrix = np.column_stack([1.0 / t, n / t])
    line = np.linalg.lstsq(matrix, np.ones(len(n)), rcond=None)[0]
    return Growth(times, float(line[0]), float(line[1]), float(np.abs(matrix @ line - 1.0).max()))


def measure() -> list[tuple[str, str]]:
    """Figures and their values."""
    found = []
    for kind, packaged in (("in process", False), ("FMUs", True)):
        grown = measure_growth(packaged)
        for size, each in grown.times.items():
            figure = f"scaling: {size} instances, {kind}, time of a macro step"
            found.append((figure, f"{1e6 * each:.0f} us ({1e6 * each / size:.1f} us an instance)"))
        found.append((f"scaling: {kind}, a straight line through them", str(grown)))
    return found
