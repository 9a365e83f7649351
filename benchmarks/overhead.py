"""What a macro step costs beside the FMUs' own calls, ours against a bare ctypes loop, inputs held.

Both make the same calls (set, step, get) of the `valve-train` FMUs in the same order (Gauss-Seidel). A third
loop makes them without moving a value; what the others take longer is spent outside the FMUs. Processor time.
Both loops call through ctypes, at some 0.3 us a call; our masters call from compiled code, so that they may
take less than the loop of mere calls.
"""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from fmus.build import build
from models.core.system import System
from orchestrator.masters import GaussSeidel, Jacobi
from orchestrator.participants import open_fmu
from orchestrator.run import assembly
from orchestrator.run.simulation import simulate
from orchestrator.scenario.files import load

from .macro_steps import STEP, Unit, units
from .measure import Clock, medians

STEPS = 10_000
CALLS, BARE = "calls", "bare ctypes loop"


def prepared(found: dict[str, Unit], now: ctypes.c_double) -> list[tuple[Any, ...]]:
    """For each FMU its three functions with their arguments, its input memory, and where inputs come from."""
    length, yes = ctypes.c_double(STEP), ctypes.c_int(1)
    outputs = {name: np.zeros(len(unit.outputs)) for name, unit in found.items()}
    calls = []
    for name, unit in found.items():
        # As our participants do: a Python FMU's library without releasing the interpreter at every call.
        library = ctypes.PyDLL(None, handle=unit.slave.dll._handle)
        handle, inputs = ctypes.c_void_p(unit.slave.component), np.zeros(len(unit.inputs))
        transfers = []
        for references, memory in ((unit.inputs, inputs), (unit.outputs, outputs[name])):
            wanted = (ctypes.c_uint * len(references))(*references)
            pointer = ctypes.c_void_p(memory.ctypes.data)
            transfers.append((handle, wanted, ctypes.c_size_t(len(references)), pointer))
        sources = [(outputs[other], i) for other, i in unit.sources]
        step = (handle, now, length, yes)
        functions = (library[f] for f in ("fmi2SetReal", "fmi2DoStep", "fmi2GetReal"))
        calls.append((*functions, transfers[0], step, transfers[1], inputs, sources))
    return calls


def loop(system: System, moving: bool) -> float:
    """Seconds a macro step of the bare loop, with or without moving values."""
    found, now = units(system), ctypes.c_double()
    calls = prepared(found, now)
    for set_real, _, get_real, given, _, taken, inputs, sources in calls * len(calls):
        for k, (buffer, i) in enumerate(sources):
            inputs[k] = buffer[i]
        set_real(*given)
        get_real(*taken)
    began = time.process_time()
    for n in range(STEPS):
        now.value = n * STEP
        for set_real, do_step, get_real, given, step, taken, inputs, sources in calls:
            if moving:
                for k, (buffer, i) in enumerate(sources):
                    inputs[k] = buffer[i]
            set_real(*given)
            do_step(*step)
            get_real(*taken)
    elapsed = time.process_time() - began
    for unit in found.values():
        unit.close()
    return elapsed / STEPS


def ours(system: System, master: Any) -> float:
    """Seconds a macro step of our master, nobody watching."""
    participants = {
        name: open_fmu(name, build(i.component.name, structure=i.component.structure), i)
        for name, i in system.instances.items()
    }
    clock = Clock()
    try:
        simulate(system, participants, master, STEP, STEPS * STEP, [clock])
    finally:
        for participant in participants.values():
            participant.close()
    return clock.elapsed / STEPS


def measured() -> dict[str, float]:
    """Seconds a macro step: of the calls alone, of the bare loop, and of our masters."""
    scenario = load("valve-train")
    system = assembly.at_start(scenario, assembly.system_of(scenario))
    candidates: dict[str, Callable[[], float]] = {
        CALLS: lambda: loop(system, moving=False),
        BARE: lambda: loop(system, moving=True),
        "gauss_seidel, hold": lambda: ours(system, GaussSeidel("hold")),
        "jacobi, hold": lambda: ours(system, Jacobi("hold")),
    }
    return medians(candidates)


def rows() -> list[tuple[str, str]]:
    """Figures for the report."""
    found = measured()
    calls, bare = found.pop(CALLS), found[BARE]
    return [("overhead: the FMUs' own calls in a macro step", f"{1e6 * calls:.1f} us")] + [
        (
            f"overhead: {name}, outside the calls",
            f"{1e6 * (each - calls):.1f} us ({each / bare:.2f} x bare loop)",
        )
        for name, each in found.items()
    ]
