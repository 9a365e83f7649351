"""Valve trains on elastic camshafts: the start of each in its own steady cycle, and its connections."""

import copy
import math
from collections.abc import Sequence
from typing import Any

from models.monolithic.cycle import find_cycle
from orchestrator.scenario import build_scenario
from orchestrator.scenario.system import build_system, resolve_start

BENDING = (
    *(f"SHAFT.{port}[N] -> tappet.{port}" for port in ("axis_x", "axis_y")),
    *(f"SHAFT.{port}[N] -> tappet.{port}" for port in ("axis_velocity_x", "axis_velocity_y")),
    *(f"tappet.{port} -> SHAFT.{port}[N]" for port in ("cam_force_x", "cam_force_y")),
)
DRIVE = (
    "flywheel.angle -> SHAFT.drive_angle",
    "flywheel.speed -> SHAFT.drive_speed",
    "flywheel.acceleration -> SHAFT.drive_acceleration",
)
_ON_THE_SHAFT = {
    "flywheel.angle": "SHAFT.cam_angle[N]",
    "flywheel.speed": "SHAFT.cam_speed[N]",
    "flywheel.load_torque[1]": "SHAFT.cam_torque[N]",
}


def start_train(train: dict[str, Any], phase: float, cam_speed: float) -> dict[str, dict[str, float]]:
    """Start values by instance of a train alone on a rigid shaft, in its cycle at this cam angle (deg).

    The flywheel of the train turns with the cam, at `cam_speed` (rad/s).
    """
    content = copy.deepcopy(train)
    content["components"]["tappet"].setdefault("parameters", {})["phase"] = f"{phase} deg"
    flywheel = content["components"]["flywheel"]
    flywheel["parameters"] = {"motion": "prescribed", "initial_speed": cam_speed}
    # A cam that lifts at time zero has no equilibrium that its contacts feel: begin on the base circle.
    flywheel["start"] = {"angle": f"{-phase} deg"}
    scenario = build_scenario(content)
    resting = resolve_start(scenario, build_system(scenario))
    start = resting.x0.copy()
    start[resting.state.names.index("flywheel.angle")] = 0.0
    flywheel["start"] = {"angle": 0.0}
    system = build_system(build_scenario(content))
    end = find_cycle(system, 2.0 * math.pi / cam_speed, ["flywheel.angle"], start=start).end
    return {
        name: {
            variable: float(value)
            for variable, value in instance.component.state.named(end[system.state.of(name)]).items()
            if abs(value) > 1e-15
        }
        for name, instance in system.instances.items()
    }


def place_train(
    train: dict[str, Any], phase: float, starts: dict[str, dict[str, float]], suffix: str
) -> dict[str, Any]:
    """The components of a train for one of many, without its flywheel."""
    placed = {}
    for part, table in train["components"].items():
        if part != "flywheel":
            kept = {key: table[key] for key in ("component", "structure", "parameters") if table.get(key)}
            placed[f"{part}_{suffix}"] = kept | {"start": starts[part]}
    tappet = placed[f"tappet_{suffix}"]
    tappet["parameters"] = tappet.get("parameters", {}) | {"phase": f"{phase:g} deg"}
    return placed


def connect_train(lines: Sequence[str], shaft: str, number: int, suffix: str) -> list[str]:
    """Connections of a train on its own flywheel for cam `number` of a shaft."""

    def rename(port: str) -> str:
        port = _ON_THE_SHAFT.get(port, port)
        if port.startswith("SHAFT."):
            return port.replace("SHAFT", shaft).replace("[N]", f"[{number}]")
        return port.replace(".", f"_{suffix}.", 1)

    return [" -> ".join(map(rename, line.split(" -> "))) for line in lines]
