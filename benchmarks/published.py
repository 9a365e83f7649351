"""Published couplings as scenarios, and the published solution of the hydraulic manipulator.

Equations are our own components'.
"""

from pathlib import Path

import numpy as np

from models.monolithic import solve
from orchestrator.scenario import Scenario, build_scenario
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system

# Two masses of one between walls, on springs of 4 pi^2 N/m and with one of 16 pi^2 N/m between them:
# Schueller, Rodenberg, Uekermann and Bungartz 2022, the oscillator of preCICE's tutorials, in our split.
PRECICE = (
    f"components.first.parameters={{mass=1.0, stiffness={4.0 * np.pi**2!r}, damping=0.0, "
    f"coupling_stiffness={16.0 * np.pi**2!r}, coupling_damping=0.0}}",
    f"components.second.parameters={{mass=1.0, stiffness={4.0 * np.pi**2!r}, damping=0.0}}",
)
# The mass-spring-damper of INTO-CPS's Maestro: two damped masses, of which one gives its force to the other.
# The values are ours: ones.
MAESTRO = (
    "components.first.parameters={mass=1.0, stiffness=1.0, damping=1.0, coupling_stiffness=1.0, "
    "coupling_damping=1.0}",
    "components.second.parameters={mass=1.0, stiffness=1.0, damping=1.0}",
)


# Settings of the scenario `two-masses`, the time and the macro step (s).
TWO_MASSES = {
    "precice-oscillator": (PRECICE, 0.48, 4e-3),
    "mass-spring-damper": (MAESTRO, 3.2, 32e-3),
}
# Outputs of the hydraulic manipulator, by the columns of its published solution.
COLUMNS = {
    "s": "links.length", "sd": "links.rate", "p1": "cylinder.pressure_1", "p2": "cylinder.pressure_2",
    "f": "cylinder.force",
}  # fmt: skip


def describe_two_masses(name: str, allowed: float = 1e-2) -> Scenario:
    """A coupling of two masses, with this error of each state."""
    settings, stop, step = TWO_MASSES[name]
    states = [f"{mass}.{state}" for mass in ("first", "second") for state in ("position", "velocity")]
    tolerance = ", ".join(f"'{state}'={allowed!r}" for state in states)
    more = [f"stop_time={stop!r}", f"macro_step={step!r}", f"tolerance={{{tolerance}}}"]
    return load("two-masses", [*settings, *more])


def describe_manipulator(stop: float, allowed: float = 1e-2) -> Scenario:
    """The hydraulic manipulator up to a time (s), with this error of each output."""
    lines = [
        "cylinder.force -> links.force", "links.length -> cylinder.length", "links.rate -> cylinder.rate",
    ]  # fmt: skip
    return build_scenario(
        {
            "name": "hydraulic-manipulator",
            "stop_time": stop,
            "macro_step": 1e-3,
            "start": "given",
            "tolerance": dict.fromkeys(COLUMNS.values(), allowed),
            "connections": lines,
            "components": {
                name: {"component": f"benchmarks.hydraulic_manipulator:{name}"}
                for name in ("links", "cylinder")
            },
        }
    )


def describe_drive(folder: Path, allowed: float = 1e-2) -> Scenario:
    """A drive train and its controller, two FMUs of FMPy's tests in that folder."""
    return build_scenario(
        {
            "name": "drive-train",
            "stop_time": 1.0,
            "macro_step": 4e-3,
            "tolerance": {"drive.w": allowed},
            "connections": ["drive.w -> control.u_m", "control.y -> drive.tau"],
            "components": {
                "drive": {"participant": str(folder / "Drivetrain.fmu")},
                "control": {"participant": str(folder / "Controller.fmu"), "parameters": {"PI.k": 20.0}},
            },
        }
    )


def compare_manipulator(file: Path) -> dict[str, float]:
    """The largest difference to the published solution by output, over its range."""
    published = np.genfromtxt(file, delimiter=",", names=True)
    system = build_system(describe_manipulator(float(published["t"][-1])))
    solution = solve(system, published["t"])
    return {
        output: float(np.max(np.abs(solution[output] - published[column])) / np.ptp(published[column]))
        for column, output in COLUMNS.items()
    }
