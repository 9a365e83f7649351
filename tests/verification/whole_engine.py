"""The engine with 16 valves and four cylinders: its whole cycle by the command line, with FMUs."""

from __future__ import annotations

import tempfile
from pathlib import Path

import h5py
import numpy as np

from benchmarks.many_valves import DEGREES_PER_SECOND, FIRING_ORDER, NOSES
from orchestrator import assembly
from orchestrator.scenario_files import load

from .shell import summary, tribocosim
from .table import Row

TESTS = "orchestrator/test_many_valves.py::"
SCENARIO = "engine-16v"
CYCLE = 720.0
# A valve's highest position is where the nose's arc, some 8 degrees of the crank wide, is known to stand.
NOSE_WIDTH = 8.0
# Records are this far apart (deg): 20 us at 2000 r/min.
RECORD = 20e-6 * DEGREES_PER_SECOND


PROMISE = "a 16-valve, 4-cylinder engine (about 60 instances) runs"
# The run takes about a minute of a processor's time (s).
PATIENCE = 1800.0


def row() -> Row:
    with tempfile.TemporaryDirectory() as name:
        changes = ("--no-figures", "--out", name, "--overwrite")
        done = tribocosim("run", SCENARIO, *changes, patience=PATIENCE)
        if not (Path(name) / "result.nc").exists():
            return Row(PROMISE, str(done), short="not met.")
        return shown(Path(name))


def shown(folder: Path) -> Row:
    """What a run in that folder comes to."""
    count = len(assembly.system_of(load(SCENARIO)).instances)
    told = summary(folder)
    with h5py.File(folder / "result.nc") as file:
        found = {key: values[:] for key, values in file["coupled"].items()}
    angle = found["time"] * DEGREES_PER_SECOND
    late = {
        valve: _apart(angle[found[f"valve_spring_{valve}.position"].argmax()], _nose(valve))
        for valve in _valves()
    }
    peaks = np.array([angle[found[f"gas_{k}.gas_pressure"].argmax()] for k in FIRING_ORDER])
    loads = np.array([found[f"contact_{valve}.load"] for valve in _valves()])
    slaps = [int(found[f"piston_{k}.impact_count"][-1]) for k in sorted(FIRING_ORDER)]
    uneven = float(np.abs(np.diff(peaks) - 180.0).max())
    fine = (
        told["complete"]
        and max(late.values()) < 0.5 * NOSE_WIDTH
        and uneven <= RECORD
        and loads.min() > 0.0
        and min(slaps) > 0
    )
    return Row(
        PROMISE,
        f"`{SCENARIO}`: {count} instances, all FMUs, a whole cycle of {1e3 * found['time'][-1]:g} ms, "
        f"{told['macro_steps']} macro steps, {told['do_steps']} doStep calls: {told['coupled_time_s']:.0f} s "
        f"of stepping, {told['wall_time_s']:.0f} s in all; all {len(late)} valves highest at their cams' "
        f"noses to {max(late.values()):.1f}° of the crank, contact loads from {loads.min():.0f} to "
        f"{loads.max():.0f} N; gas pressures highest in the order {'-'.join(map(str, FIRING_ORDER))} at "
        f"{', '.join(f'{peak:.1f}°' for peak in peaks)}; impacts of the pistons: "
        f"{', '.join(map(str, slaps))}",
        (
            TESTS + "test_a_valve_moves_as_it_does_alone",
            TESTS + "test_cylinders_turn_in_firing_order_and_as_they_do_alone",
            TESTS + "test_noses_come_in_firing_order_half_a_crank_turn_apart",
        ),
        command=f"tribocosim run {SCENARIO}",
        short="" if fine else "not met.",
    )


def _valves() -> list[str]:
    return [f"{kind}_{k}{side}" for k in sorted(FIRING_ORDER) for kind in NOSES for side in "ab"]


def _nose(valve: str) -> float:
    """The crank angle (deg) at which a cylinder's cam is at its nose."""
    kind, place = valve.split("_")
    return (180.0 * FIRING_ORDER.index(int(place[0])) + NOSES[kind]) % CYCLE


def _apart(angle: float, other: float) -> float:
    """Distance on the cycle (deg)."""
    away = abs(angle - other) % CYCLE
    return float(min(away, CYCLE - away))
