"""Eight pushrod trains on one elastic camshaft; `python -m benchmarks.pushrod_engine` writes scenario
`pushrod-engine`.

Each train's start values are those of its steady cycle alone, on a rigid shaft, at its cam's angle.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import tomli_w

from models.core.quantities import Vector
from models.core.system import Instance, System
from models.monolithic.cycle import find_cycle
from orchestrator.scenario import build_scenario
from orchestrator.scenario.files import SHIPPED, load, read_contents
from orchestrator.scenario.system import build_system, resolve_start

FILE = SHIPPED / "pushrod-engine.toml"
# Distances from the driven end (mm) and cam angles at shaft angle zero (deg) of the cams.
PLACES = (30, 60, 120, 150, 210, 240, 300, 330)
PHASES = (305, 305, 35, 35, 215, 215, 125, 125)
SPEED = 1000.0 * math.pi / 30.0
HEADER = """\
# Eight pushrod trains on one camshaft that twists, at 1000 r/min of the camshaft: 50 instances. Written by
# `python -m benchmarks.pushrod_engine`; each train starts in the steady cycle that it has alone.

"""
SHAFT = {
    "length": "350 mm",
    "diameter": "20 mm",
    "damping_time": 1.370291042e-5,
    "damping_ratio": 0.0,
    "cams": [{"place": f"{place} mm", "inertia": 1.2e-4} for place in PLACES],
}


def start_train(phase: float) -> System:
    """The pushrod train alone, as it is in its cycle at this cam angle (deg)."""
    content = read_contents(SHIPPED / "pushrod-train.toml")
    content["components"]["tappet"]["parameters"]["phase"] = f"{phase} deg"
    # A cam that lifts at time zero has no equilibrium that its contacts feel: begin on the base circle.
    content["components"]["flywheel"]["start"] = {"angle": f"{-phase} deg"}
    scenario = build_scenario(content)
    resting = resolve_start(scenario, build_system(scenario))
    start = resting.x0.copy()
    start[resting.state.names.index("flywheel.angle")] = 0.0
    turned = {**content["components"]["flywheel"], "start": {"angle": 0.0}}
    content["components"]["flywheel"] = turned
    scenario = build_scenario(content)
    cycle = find_cycle(build_system(scenario), 2.0 * math.pi / SPEED, ["flywheel.angle"], start=start)
    state = cycle.end
    return resting.with_instances(
        {
            name: instance_with(instance, state[resting.state.of(name)])
            for name, instance in resting.instances.items()
        }
    )


def instance_with(instance: Instance, state: Vector) -> Instance:
    """With these start values."""
    return replace(instance, start=instance.component.state.named(state))


def rename(line: str, number: int) -> list[str]:
    """A connection of the one train for one of eight on the shaft."""
    if line.startswith("flywheel.angle"):
        return [f"shaft.cam_angle[{number}] -> tappet_{number}.cam_angle"]
    if line.startswith("flywheel.speed"):
        return [f"shaft.cam_speed[{number}] -> tappet_{number}.cam_speed"]
    if line.startswith("tappet.cam_torque"):
        return [f"tappet_{number}.cam_torque -> shaft.cam_torque[{number}]"]
    source, target = (port.replace(".", f"_{number}.", 1) for port in line.split(" -> "))
    return [f"{source} -> {target}"]


def build_content() -> dict[str, Any]:
    """The scenario as plain data."""
    base = load("pushrod-train")
    components: dict[str, Any] = {
        "flywheel": {"component": "flywheel", "parameters": {"initial_speed": "1000 rpm"}},
        "shaft": {"component": "shaft", "drawing": SHAFT},
    }
    connections = [
        "flywheel.angle -> shaft.drive_angle",
        "flywheel.speed -> shaft.drive_speed",
        "flywheel.acceleration -> shaft.drive_acceleration",
        "shaft.drive_torque -> flywheel.load_torque[1]",
    ]
    started = {phase: start_train(phase) for phase in set(PHASES)}
    for k, phase in enumerate(PHASES, 1):
        for part, table in base.components.items():
            if part == "flywheel":
                continue
            plain = table.model_dump(exclude_none=True)
            taken = {key: plain[key] for key in ("component", "structure", "parameters") if plain.get(key)}
            start = {n: float(v) for n, v in started[phase].instances[part].start.items() if abs(v) > 1e-15}
            components[f"{part}_{k}"] = taken | {"start": start}
        parameters = components[f"tappet_{k}"].get("parameters", {})
        components[f"tappet_{k}"]["parameters"] = parameters | {"phase": f"{phase} deg"}
        connections += [line for old in base.connections for line in rename(old, k)]
    return {
        "description": "Eight pushrod trains on one camshaft at 1000 r/min, 50 instances",
        "stop_time": "60 ms",
        "macro_step": "5 us",
        "output_step": "50 us",
        "start": "given",
        "master": {"name": "gauss_seidel", "extrapolation": "quadratic"},
        "tolerance": {
            "cam_contact_1.load": 1e-3,
            "cam_contact_8.load": 1e-3,
            "shaft.drive_torque": 1e-3,
        },
        "connections": connections,
        "components": components,
    }


def write() -> Path:
    """The scenario file."""
    FILE.write_text(HEADER + tomli_w.dumps(build_content()), "utf-8")
    return FILE


if __name__ == "__main__":
    print(write())
