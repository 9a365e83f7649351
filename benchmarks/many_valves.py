"""Many valve trains on one crankshaft; `python -m benchmarks.many_valves` writes scenario `valve-train-16v`,
and `engine-16v`, which has four cylinders as well.

Four cylinders that fire in the order 1-3-4-2 with four valves each. Each valve's start values are those of
that valve alone, which the monolithic reference brings from the base circle to its cam's angle at crank angle
zero (the shaft turns at a prescribed speed, so that one valve does not feel another).
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from models.core.system import Instance, System
from models.monolithic import solve
from orchestrator.scenario import Scenario, build_scenario
from orchestrator.scenario.files import SHIPPED, load
from orchestrator.scenario.system import build_system, resolve_start
from orchestrator.scenario.values import build_component

FIRING_ORDER = (1, 3, 4, 2)
# Crank angles from a cylinder's firing dead centre to the noses of its cams (deg), chosen here.
NOSES = {"intake": 470.0, "exhaust": 250.0}
FILE = SHIPPED / "valve-train-16v.toml"
ENGINE = SHIPPED / "engine-16v.toml"
HEADER = """\
# The valve trains of a four-cylinder engine with 16 valves, firing 1-3-4-2, on a crankshaft at 2000 r/min:
# 49 instances. Written by `python -m benchmarks.many_valves`; start values are those of each valve alone when
# its cam comes by. The monolithic reference is off: it takes minutes (2 ms of it
# take some ten seconds: --set reference.enabled=true --set "stop_time=2 ms").

"""
ENGINE_HEADER = """\
# `valve-train-16v` with its four cylinders: pistons that tilt in their bores, under gas pressure. Written by
# `python -m benchmarks.many_valves`.

"""


def list_phases() -> dict[str, float]:
    """Cam angle at crank angle zero (deg) by valve: the nose, at 180, comes when its cylinder asks for it."""
    found = {}
    for cylinder in sorted(FIRING_ORDER):
        fires = 180.0 * FIRING_ORDER.index(cylinder)
        for kind, nose in NOSES.items():
            for side in ("a", "b"):
                found[f"{kind}_{cylinder}{side}"] = (180.0 - 0.5 * (fires + nose)) % 360.0
    return found


# The lift is from 90 to 270 deg of the cam angle; a valve rests at REST.
LIFT, REST = (90.0, 270.0), 80.0
SPEED = {"motion": "prescribed", "initial_speed": "2000 rpm"}
DEGREES_PER_SECOND = 2000.0 * 360.0 / 60.0


def start_valve(base: Scenario, phase: float) -> System:
    """One valve train with that phase (deg), as it is when the crankshaft comes to angle zero."""
    content = base.model_dump(exclude_none=True)
    shaft, camshaft = content["components"]["flywheel"], content["components"]["camshaft"]
    turn = min(0.0, 2.0 * (REST - phase)) if LIFT[0] - 10.0 < phase < LIFT[1] + 10.0 else 0.0
    shaft["parameters"], shaft["start"] = SPEED, {"angle": f"{turn} deg"}
    camshaft["parameters"] = {**camshaft["parameters"], "drive_ratio": 0.5, "phase": f"{phase} deg"}
    scenario = build_scenario(content)
    system = resolve_start(scenario, build_system(scenario))
    if turn == 0.0:
        return system
    state = solve(system, np.linspace(0.0, -turn / DEGREES_PER_SECOND, 101)).state[-1]
    return system.with_instances(
        {
            name: replace(i, start=i.component.state.named(state[system.state.of(name)]))
            for name, i in system.instances.items()
        }
    )


def build_content() -> dict[str, Any]:
    """The scenario as plain data."""
    base = load("valve-train")
    valves = list_phases()
    components: dict[str, Any] = {
        "flywheel": {"component": "flywheel", "structure": {"loads": len(valves)}, "parameters": SPEED}
    }
    connections = []
    for i, (valve, phase) in enumerate(valves.items(), start=1):
        started = start_valve(base, phase)
        for part in ("camshaft", "valve_spring", "contact"):
            table = base.components[part].model_dump(exclude_none=True)
            start = {k: float(v) for k, v in started.instances[part].start.items() if abs(v) > 1e-15}
            taken = {k: v for k, v in table.items() if k in ("component", "structure", "parameters") and v}
            components[f"{part}_{valve}"] = taken | ({"start": start} if start else {})
        turning = {"drive_ratio": 0.5, "phase": f"{phase:g} deg"}
        camshaft = components[f"camshaft_{valve}"]
        camshaft["parameters"] = camshaft.get("parameters", {}) | turning
        connections += [rename_connection(line, valve, i) for line in base.connections]
    return {
        "description": "Valve trains of a 16-valve engine, firing 1-3-4-2, 49 instances",
        "stop_time": "60 ms",
        "macro_step": "2 us",
        "output_step": "20 us",
        "start": "given",
        "reference": {"enabled": False},
        "master": {"name": "gauss_seidel", "extrapolation": "quadratic"},
        "tolerance": {"contact_intake_1a.load": 1e-3},
        "connections": connections,
        "components": components,
    }


def rename_connection(line: str, valve: str, number: int) -> str:
    """A connection of the one valve train for one of many."""
    parts = []
    for port in line.split(" -> "):
        instance, variable = port.split(".")
        own = instance if instance == "flywheel" else f"{instance}_{valve}"
        parts.append(
            f"{own}.{variable.replace('[1]', f'[{number}]') if instance == 'flywheel' else variable}"
        )
    return " -> ".join(parts)


def build_valve_trains(count: int) -> System:
    """As many valve trains on one crankshaft, all like the first intake valve's."""
    one = start_valve(load("valve-train"), list_phases()["intake_1a"])
    structure = {"loads": count}
    shaft = build_component("flywheel", tuple(structure.items()))
    instances = {"flywheel": Instance(shaft, one.instances["flywheel"].parameters)}
    connections = []
    for i in range(1, count + 1):
        instances |= {f"{n}_{i}": one.instances[n] for n in ("camshaft", "valve_spring", "contact")}
        for c in one.connections:
            source, _, target = rename_connection(f"{c.source} -> {c.target}", str(i), i).partition(" -> ")
            connections.append((source, target))
    return System(instances, connections)


def build_engine() -> dict[str, Any]:
    """The scenario with the cylinders as plain data: it adds to the one without.

    Each cylinder has its own crank throw, which is at zero where the cylinder fires, so that all cylinders
    have the same parameters.
    """
    valves = len(list_phases())
    throws = {
        f"throw[{cylinder}]": f"{180.0 * FIRING_ORDER.index(cylinder):g} deg"
        for cylinder in sorted(FIRING_ORDER)
    }
    connections, components = [], {}
    for k in sorted(FIRING_ORDER):
        components[f"gas_{k}"] = {"component": "cylinder_gas"}
        components[f"piston_{k}"] = {"component": "piston_crank", "parameters": {"pin_offset": "0.8 mm"}}
        connections += [
            f"flywheel.throw_angle[{k}] -> gas_{k}.crank_angle",
            f"flywheel.speed -> gas_{k}.crank_speed",
            f"flywheel.throw_angle[{k}] -> piston_{k}.crank_angle",
            f"flywheel.speed -> piston_{k}.crank_speed",
            f"flywheel.acceleration -> piston_{k}.crank_acceleration",
            f"gas_{k}.gas_pressure -> piston_{k}.gas_pressure",
            f"piston_{k}.crank_torque -> flywheel.load_torque[{valves + k}]",
            f"piston_{k}.crank_impact_impulse -> flywheel.load_impulse[{valves + k}]",
        ]
    count = len(FIRING_ORDER)
    shaft = {"structure": {"loads": valves + count, "throws": count}, "parameters": SPEED | throws}
    return {
        "extends": "valve-train-16v",
        "description": "Engine with four cylinders, firing 1-3-4-2, and 16 valves, 57 instances",
        "connections": connections,
        "components": {"flywheel": shaft} | components,
    }


def write() -> list[Path]:
    """The scenario files."""
    FILE.write_text(HEADER + tomli_w.dumps(build_content()), "utf-8")
    ENGINE.write_text(ENGINE_HEADER + tomli_w.dumps(build_engine()), "utf-8")
    return [FILE, ENGINE]


if __name__ == "__main__":
    print(*write(), sep="\n")
