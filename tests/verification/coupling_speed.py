"""Time against the number of instances, overhead of the master, memory: the benchmarks, shortened."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from benchmarks import memory, overhead, scaling
from benchmarks.many_valves import valve_trains
from orchestrator import assembly
from orchestrator.masters import GaussSeidel
from orchestrator.participants import in_process
from orchestrator.scenario_files import load
from orchestrator.simulation import simulate
from tests.orchestrator.recorder import Recorder

from .table import Row

ENGINE = 2e-4  # s
# Valve trains on one crankshaft: 4 to 64 instances.
VALVES = (1, 2, 5, 10, 21)
STEPS, OVERHEAD_STEPS, ROLLBACK_STEPS = 300, 3000, 200_000
# A page of the heap more or less is none that grows.
GROWN, ALLOWED, LINEAR = 1.0, 1.2, 1.1


def rows() -> Iterator[Row]:
    yield _engine()
    yield _scaling()
    yield _overhead()
    yield _memory()


def _engine() -> Row:
    system = assembly.system_of(load("valve-train-16v"))
    units = {name: in_process(name, instance) for name, instance in system.instances.items()}
    recorder = Recorder()
    done = simulate(system, units, GaussSeidel("quadratic"), 2e-6, ENGINE, [recorder])
    loads = [recorder[name] for name in recorder.names if name.endswith(".load")]
    return Row(
        "a 16-valve, 4-cylinder engine (about 60 instances) runs",
        f"`valve-train-16v`: {len(units)} instances; {done.macro_steps} macro steps in process: "
        f"{len(loads)} contacts with loads from {np.min(loads):.0f} to {np.max(loads):.0f} N",
        (
            "orchestrator/test_many_valves.py::test_a_valve_moves_as_it_does_alone",
            "orchestrator/test_many_valves.py::test_noses_come_in_firing_order_half_a_crank_turn_apart",
        ),
        command="tribocosim run valve-train-16v",
        short=f"{len(units)} instances: the valve trains on their crankshaft, without pistons. "
        f"{1e3 * ENGINE:g} ms here; the command makes all 60.",
    )


def _scaling() -> Row:
    scaling.STEPS = STEPS
    systems = [valve_trains(count) for count in VALVES]
    sizes = [len(system.instances) for system in systems]
    parts, exponents = [], []
    for kind, packaged in (("FMUs", True), ("in process", False)):
        times = [min(scaling.seconds_per_step(system, packaged) for _ in range(2)) for system in systems]
        exponents.append(float(np.polyfit(np.log(sizes), np.log(times), 1)[0]))
        parts.append(
            f"{kind}: "
            + ", ".join(f"{n} in {1e6 * t:.0f} us" for n, t in zip(sizes, times, strict=True))
            + f", exponent {exponents[-1]:.2f}"
        )
    return Row(
        "time per macro step grows linearly with the number of instances (measured 1 to 64)",
        "; ".join(parts),
        command="python -m benchmarks scaling",
        short=f"measured from {sizes[0]}, the smallest valve train."
        if max(exponents) <= LINEAR
        else f"not met: exponent {max(exponents):.2f}.",
    )


def _overhead() -> Row:
    overhead.STEPS = OVERHEAD_STEPS
    found = overhead.measured()
    calls, bare = found.pop(overhead.CALLS), found.pop(overhead.BARE)
    outside = {name: (each - calls) / (bare - calls) for name, each in found.items()}
    whole = {name: each / bare for name, each in found.items()}
    met = max(outside.values()) <= ALLOWED
    within = "; with the FMUs' calls it is met" if max(whole.values()) <= ALLOWED else ""
    return Row(
        "master overhead per macro step (everything but the FMUs' own calls) at most that of a bare ctypes "
        "loop "
        "plus 20 %",
        f"calls {1e6 * calls:.1f} us; besides: bare loop {1e6 * (bare - calls):.1f} us, "
        + ", ".join(
            f"{name} {1e6 * (each - calls):.1f} us ({outside[name]:.2f} times; with the calls "
            f"{whole[name]:.2f})"
            for name, each in found.items()
        ),
        command="python -m benchmarks overhead",
        short="" if met else f"not met: {max(outside.values()):.2f} times the bare loop's{within}.",
    )


def _memory() -> Row:
    found = memory.rollbacks(ROLLBACK_STEPS)
    if isinstance(found, str):
        return Row("no growth of memory over macro steps with rollback every tenth", found, short="not met.")
    early, late = found
    return Row(
        "10⁶ macro steps with rollback every tenth: no growth of memory",
        f"quarter-car, {ROLLBACK_STEPS} steps: {early:.1f} MB after a tenth, {late:.1f} MB at the end",
        command="python -m benchmarks memory",
        short=f"a fifth of them here; the command makes all {10**6}."
        if late - early < GROWN
        else f"not met: {late - early:.1f} MB more.",
    )
