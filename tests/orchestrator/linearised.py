"""Systems and trajectories about which tests linearise participants."""

import functools
from dataclasses import replace

import numpy as np

from models.monolithic.trajectory import compute_trajectory
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system, resolve_start

from .two_masses import two_masses

SPACING = 5e-3
MASSES = """
stop_time = "2 s"
macro_step = "5 ms"
start = "given"
connections = [
    "first.force -> second.force",
    "second.position -> first.other_position",
    "second.velocity -> first.other_velocity",
]

[tolerance]
"first.force" = 1e-3

[components.first]
component = "coupled_mass"
participant = "in-process"
start = {{ position = 1.0 }}

[components.second]
component = "sprung_mass"
participant = "{second}"
"""


def write_masses(folder, second="in-process"):
    """A scenario of two masses, the second one by that participant."""
    path = folder / "masses.toml"
    path.write_text(MASSES.format(second=second), "utf-8")
    return str(path)


def quarter_car():
    return build_system(load("quarter-car"))


def masses_with_fmu():
    """Two masses with the parameters of the third-party FMUs in the second one."""
    system = two_masses(coupling_stiffness=400.0)
    second = replace(system.instances["second"], parameters={"mass": 1.0, "stiffness": 10.0, "damping": 0.5})
    return system.with_instances({**system.instances, "second": second})


@functools.cache
def load_flexible():
    """The valve train with a flexible camshaft, and its motion with the first lift."""
    scenario = load("valve-train-flexible", ["stop_time=0.012"])
    system = resolve_start(scenario, build_system(scenario))
    return system, solve_trajectory(system, 0.01, 5e-6)


def list_outputs(system, name):
    """The outputs that connections read."""
    return {c.source.variable for c in system.connections if c.source.instance == name}


def solve_trajectory(system, stop, spacing):
    return compute_trajectory(system, 0.5 * spacing * np.arange(2 * round(stop / spacing) + 1), 1e-10)
