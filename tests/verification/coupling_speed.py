"""The whole engine, time against the number of instances, overhead of the master, memory."""

from __future__ import annotations

from collections.abc import Iterator

from benchmarks import memory, overhead, scaling

from . import whole_engine
from .table import Row

ROUNDS, OVERHEAD_STEPS, ROLLBACK_STEPS = 4, 3000, 1_000_000
# Every time within this of a straight line over the number of instances, which parts of unequal cost make up.
STRAIGHT = 0.25
# A page of the heap more or less is none that grows.
GROWN, ALLOWED = 1.0, 1.2


def rows() -> Iterator[Row]:
    yield whole_engine.row()
    yield _scaling()
    yield _overhead()
    yield _memory()


def _scaling() -> Row:
    parts, off = [], []
    for kind, packaged in (("FMUs", True), ("in process", False)):
        grown = scaling.growth(packaged, ROUNDS)
        off.append(grown.off)
        times = ", ".join(f"{n} in {1e6 * t:.0f} us" for n, t in grown.times.items())
        parts.append(f"{kind}: {times}; line {grown}")
    return Row(
        "time per macro step grows linearly with the number of instances (measured 1 to 64)",
        "; ".join(parts),
        command="python -m benchmarks scaling",
        short="" if max(off) <= STRAIGHT else f"not met: {100 * max(off):.0f} % off a straight line.",
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
        short="" if late - early < GROWN else f"not met: {late - early:.1f} MB more.",
    )
