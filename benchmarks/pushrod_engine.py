"""Eight pushrod trains on one elastic camshaft; `python -m benchmarks.pushrod_engine` writes scenario
`pushrod-engine`.

Each train's start values are those of its steady cycle alone, on a rigid shaft, at its cam's angle.
"""

import math
from pathlib import Path
from typing import Any

import tomli_w

from orchestrator.scenario.files import SHIPPED, load

from .trains_on_shafts import DRIVE, connect_train, place_train, start_train

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


def build_content() -> dict[str, Any]:
    """The scenario as plain data."""
    train = load("qin2000-train").model_dump(exclude_none=True)
    starts = {phase: start_train(train, phase, SPEED) for phase in sorted(set(PHASES))}
    components: dict[str, Any] = {
        "flywheel": {"component": "flywheel", "parameters": {"initial_speed": "1000 rpm"}},
        "shaft": {"component": "shaft", "drawing": SHAFT},
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


def write() -> Path:
    """The scenario file."""
    FILE.write_text(HEADER + tomli_w.dumps(build_content()), "utf-8")
    return FILE


if __name__ == "__main__":
    print(write())
