"""Sixteen valve trains on two elastic camshafts; `python -m benchmarks.many_valves` writes scenario
`valve-train-16v`, and `engine-16v`, which has four cylinders as well.

Four cylinders that fire in the order 1-3-4-2 with four valves each. Each valve starts in the steady cycle
that it has alone on a rigid shaft.
"""

import math
from pathlib import Path
from typing import Any

import tomli_w

from orchestrator.scenario.files import SHIPPED

from .trains_on_shafts import BENDING, DRIVE, connect_train, place_train, start_train

FIRING_ORDER = (1, 3, 4, 2)
# Crank angles from a cylinder's firing dead centre to the noses of its cams (deg), chosen here.
NOSES = {"intake": 470.0, "exhaust": 250.0}
FILE = SHIPPED / "valve-train-16v.toml"
ENGINE = SHIPPED / "engine-16v.toml"
HEADER = """\
# The valve trains of a four-cylinder engine with 16 valves, firing 1-3-4-2, on a crankshaft at 2000 r/min:
# two camshafts that twist and bend in five bearings, driven by a chain; 51 instances. Bucket and valve are
# one body without lash and seat: contacts are kept, so that fixed steps show the error of a large coupling;
# `seat-and-lash` is one train with both. Written by `python -m benchmarks.many_valves`; each valve starts in
# the steady cycle that it has alone on a rigid shaft. The reference takes two minutes.

"""
ENGINE_HEADER = """\
# `valve-train-16v` with its four cylinders: pistons that tilt in their bores, under gas pressure. Written by
# `python -m benchmarks.many_valves`.

"""
SPEED = {"motion": "prescribed", "initial_speed": "2000 rpm"}
CAM_SPEED = 1000.0 * math.pi / 30.0
OIL = {"oil": "SAE 5W-30", "temperature": "100 degC"}
# Lifts over 240 degrees of the crank, with a pointed nose.
CAM = {
    "law": "modified_trapezoid", "base_radius": "21 mm", "rise_angle": "60 deg", "dwell_half_width": 0.0,
    "onset_share": 0.08, "flank_share": 0.1, "reversal_share": 0.12, "nose_share": 0.7,
}  # fmt: skip
TRAIN: dict[str, Any] = {
    **OIL,
    "name": "train",
    "stop_time": "60 ms",
    "macro_step": "2 us",
    "tolerance": {"contact.load": 1e-3},
    "connections": [
        "flywheel.angle -> tappet.cam_angle",
        "flywheel.speed -> tappet.cam_speed",
        "tappet.cam_torque -> flywheel.load_torque[1]",
        "tappet.overlap -> contact.approach",
        "tappet.overlap_rate -> contact.approach_rate",
        "tappet.entraining_velocity -> contact.entraining_velocity",
        "tappet.sliding_velocity -> contact.sliding_velocity",
        "tappet.radius_of_curvature -> contact.radius_of_curvature",
        "contact.load -> tappet.cam_load",
        "contact.friction_force -> tappet.cam_friction",
        "tappet.position -> spring.position",
        "tappet.velocity -> spring.velocity",
        "spring.force -> tappet.load",
    ],
    "components": {
        "flywheel": {"component": "flywheel"},
        "tappet": {"component": "tappet", "parameters": {"mass": "220 g", **CAM}},
        "spring": {"component": "coil_spring", "structure": {"segments": 3}, "parameters": {"gap": "6 mm"}},
        "contact": {"component": "ehl_contact", "parameters": {"film_model": "dowson_toyoda"}},
    },
}
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


def build_content() -> dict[str, Any]:
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
        "description": "Valve trains of a 16-valve engine on two camshafts, firing 1-3-4-2, 51 instances",
        "stop_time": "60 ms",
        "macro_step": "2 us",
        "output_step": "40 us",
        **OIL,
        "start": "given",
        "master": {"name": "gauss_seidel", "extrapolation": "quadratic"},
        "tolerance": {
            "contact_intake_1a.load": 1e-3,
            "contact_exhaust_4b.load": 1e-3,
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
        "description": "Engine with four cylinders, firing 1-3-4-2, and 16 valves, 59 instances",
        "reference": {"enabled": False},
        "connections": connections,
        "components": {"flywheel": crankshaft} | components,
    }


def write() -> list[Path]:
    """The scenario files."""
    FILE.write_text(HEADER + tomli_w.dumps(build_content()), "utf-8")
    ENGINE.write_text(ENGINE_HEADER + tomli_w.dumps(build_engine()), "utf-8")
    return [FILE, ENGINE]


if __name__ == "__main__":
    print(*write(), sep="\n")
