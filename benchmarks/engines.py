"""Shipped scenarios of engines: `python -m benchmarks.engines` writes `valve-train-16v`, `engine-16v` and
`pushrod-engine`.

Sixteen valve trains `direct-acting-hla` on two elastic camshafts, of four cylinders that fire in the order
1-3-4-2, without and with the cylinders; and eight pushrod trains on one camshaft. Each train starts in the
steady cycle that it has alone on a rigid shaft, at its cam's angle. The comments at the beginning of the
files stay, and so do the order of components and start values that are in that cycle as exactly as it is
known.
"""

import copy
import math
import tomllib
from argparse import ArgumentParser
from collections.abc import Sequence
from typing import Any

import tomli_w

from models.monolithic.cycle import find_cycle
from orchestrator.scenario import build_scenario
from orchestrator.scenario.files import SHIPPED, load, read
from orchestrator.scenario.system import build_system, resolve_start
from orchestrator.scenario.values import build_component

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

# The oil of an adjuster returns by a small part in a turn: so closed, cycles are known to 4e-8.
CLOSED = {"tolerance": 1e-10, "steady": 1e-7}
# Over nominal and value.
SAME = 1e-6


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
    end = find_cycle(system, 2.0 * math.pi / cam_speed, ["flywheel.angle"], start=start, **CLOSED).end
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


FIRING_ORDER = (1, 3, 4, 2)
# Crank angles from a cylinder's firing dead centre to the noses of its cams (deg), chosen here.
NOSES = {"intake": 470.0, "exhaust": 250.0}
SPEED = {"motion": "prescribed", "initial_speed": "2000 rpm"}
CAM_SPEED = 1000.0 * math.pi / 30.0
TRAIN = read("direct-acting-hla")[0]
# A bearing stands between the two cams of each cylinder, and one beside the chain wheel.
CYLINDERS_AT = (70, 165, 260, 355)
SHAFT = {
    "length": "390 mm",
    "diameter": "24 mm",
    "bore": "10 mm",
    "bearings": [f"{place} mm" for place in (15, *CYLINDERS_AT)],
    "drive_stiffness": "10 kN.m/rad",
    "modes": 2,
    "cams": [{"place": f"{place + side} mm"} for place in CYLINDERS_AT for side in (-18, 18)],
}


def list_phases() -> dict[str, float]:
    """Cam angle at crank angle zero (deg) by valve: the nose, at 180, comes when its cylinder asks for it."""
    found = {}
    for cylinder in sorted(FIRING_ORDER):
        fires = 180.0 * FIRING_ORDER.index(cylinder)
        for kind, nose in NOSES.items():
            for side in ("a", "b"):
                found[f"{kind}_{cylinder}{side}"] = (180.0 - 0.5 * (fires + nose)) % 360.0
    return found


def build_valve_train() -> dict[str, Any]:
    """The scenario as plain data."""
    phases = list_phases()
    starts = {phase: start_train(TRAIN, phase, CAM_SPEED) for phase in sorted(set(phases.values()))}
    components: dict[str, Any] = {
        "flywheel": {"component": "flywheel", "structure": {"loads": len(NOSES)}, "parameters": SPEED}
    }
    connections = []
    for i, kind in enumerate(NOSES, 1):
        shaft = f"{kind}_shaft"
        components[shaft] = {"component": "shaft", "drawing": SHAFT, "parameters": {"drive_ratio": 0.5}}
        connections += [line.replace("SHAFT", shaft) for line in DRIVE]
        connections.append(f"{shaft}.drive_torque -> flywheel.load_torque[{i}]")
        valves = {valve: phase for valve, phase in phases.items() if valve.startswith(kind)}
        for number, (valve, phase) in enumerate(valves.items(), 1):
            components |= place_train(TRAIN, phase, starts[phase], valve)
            connections += connect_train([*TRAIN["connections"], *BENDING], shaft, number, valve)
    return {
        "description": "Valve trains of a 16-valve engine on two camshafts, firing 1-3-4-2, 67 instances",
        "stop_time": "60 ms",
        "macro_step": "2 us",
        "output_step": "40 us",
        "oil": TRAIN["oil"],
        "temperature": TRAIN["temperature"],
        "start": "given",
        "master": {"name": "gauss_seidel", "extrapolation": "quadratic"},
        "tolerance": {
            "cam_contact_intake_1a.load": 1e-3,
            "cam_contact_exhaust_4b.load": 1e-3,
            "intake_shaft.drive_torque": 1e-3,
        },
        "connections": connections,
        "components": components,
    }


def build_engine() -> dict[str, Any]:
    """The scenario with the cylinders as plain data: it adds to the one without.

    Each cylinder has its own crank throw, which is at zero where the cylinder fires, so that all cylinders
    have the same parameters.
    """
    shafts, count = len(NOSES), len(FIRING_ORDER)
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
            f"piston_{k}.crank_torque -> flywheel.load_torque[{shafts + k}]",
            f"piston_{k}.crank_impact_impulse -> flywheel.load_impulse[{shafts + k}]",
        ]
    crankshaft = {"structure": {"loads": shafts + count, "throws": count}, "parameters": SPEED | throws}
    return {
        "extends": "valve-train-16v",
        "description": "Engine with four cylinders, firing 1-3-4-2, and 16 valves, 75 instances",
        "reference": {"enabled": False},
        "connections": connections,
        "components": {"flywheel": crankshaft} | components,
    }


# Distances from the driven end (mm) and cam angles at shaft angle zero (deg) of the cams.
PLACES = (30, 60, 120, 150, 210, 240, 300, 330)
PHASES = (305, 305, 35, 35, 215, 215, 125, 125)
PUSHROD_SPEED = 1000.0 * math.pi / 30.0
PUSHROD_SHAFT = {
    "length": "350 mm",
    "diameter": "20 mm",
    "damping_time": 1.370291042e-5,
    "damping_ratio": 0.0,
    "cams": [{"place": f"{place} mm", "inertia": 1.2e-4} for place in PLACES],
}


def build_pushrod_engine() -> dict[str, Any]:
    """The scenario as plain data."""
    train = load("qin2000-train").model_dump(exclude_none=True)
    starts = {phase: start_train(train, phase, PUSHROD_SPEED) for phase in sorted(set(PHASES))}
    components: dict[str, Any] = {
        "flywheel": {"component": "flywheel", "parameters": {"initial_speed": "1000 rpm"}},
        "shaft": {"component": "shaft", "drawing": PUSHROD_SHAFT},
    }
    connections = [line.replace("SHAFT", "shaft") for line in DRIVE]
    connections.append("shaft.drive_torque -> flywheel.load_torque[1]")
    for k, phase in enumerate(PHASES, 1):
        components |= place_train(train, phase, starts[phase], str(k))
        connections += connect_train(train["connections"], "shaft", k, str(k))
    return {
        "description": "Eight pushrod trains on one camshaft at 1000 r/min, 50 instances",
        "stop_time": "60 ms",
        "macro_step": "5 us",
        "output_step": "50 us",
        "start": "given",
        "master": {"name": "gauss_seidel", "extrapolation": "quadratic"},
        "tolerance": {"cam_contact_1.load": 1e-3, "cam_contact_8.load": 1e-3, "shaft.drive_torque": 1e-3},
        "connections": connections,
        "components": components,
    }


def keep_same(content: dict[str, Any], before: dict[str, Any]) -> None:
    """Take the order of components from `before`, and start values that are the same to SAME."""
    content["components"] = {
        n: content["components"][n] for n in before["components"] if n in content["components"]
    } | content["components"]
    for name, table in content["components"].items():
        old, new = before["components"].get(name, {}).get("start", {}), table.get("start", {})
        if not new or old.keys() != new.keys():
            continue
        states = build_component(table["component"], tuple(sorted(table.get("structure", {}).items()))).state
        sizes = {state: states.field(state).quantity.nominal + abs(value) for state, value in old.items()}
        if all(abs(new[state] - value) <= SAME * sizes[state] for state, value in old.items()):
            table["start"] = old


BUILDERS = {
    "valve-train-16v": build_valve_train, "engine-16v": build_engine, "pushrod-engine": build_pushrod_engine,
}  # fmt: skip

if __name__ == "__main__":
    ArgumentParser("python -m benchmarks.engines", description=__doc__).parse_args()
    for name, build in BUILDERS.items():
        file = SHIPPED / f"{name}.toml"
        begin = [line for line in file.read_text("utf-8").splitlines() if line.startswith("#")]
        content = build()
        keep_same(content, tomllib.loads(file.read_text("utf-8")))
        file.write_text("\n".join([*begin, "", tomli_w.dumps(content)]), "utf-8")
        print(file)
