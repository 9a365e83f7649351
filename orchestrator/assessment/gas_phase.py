"""The phase at which a cam opens a valve against the gas of its cylinder."""

import math
from collections.abc import Iterator

import numpy as np

from models.core import roles
from models.core.evaluation import Interpreted
from models.core.quantities import Vector
from models.core.system import Connection, Port, System

from .trains import Train, count_gas_turns, find_trains, list_parts, parameter_of

# Degrees of the crank after firing between which valves of four-stroke engines begin to open: 90 deg before
# the dead centre to 10 deg after it (exhaust), 70 deg before it to 60 deg after it (intake).
EXHAUST, INTAKE = (90.0, 190.0), (290.0, 420.0)
# Where an exhaust valve opens as engines' do, and how far (deg) from it its gas may begin to blow down.
USUAL_EXHAUST, APART = 130.0, 30.0
# Of the largest lift, which a valve without lash follows.
LIFTED = 0.02


def list_doubtful_gas(system: System) -> list[str]:
    """A line for each valve that its cam opens against gas at a phase that engines do not have."""
    lines = [line for line in system.connections if _is_gas_force(system, line)]
    drives = list_parts(system, roles.Drive)
    if len(drives) != 1 or not lines or "angle" not in system.instances[drives[0]].component.state:
        return []
    place = system.state.index(Port(drives[0], "angle"))
    evaluation, x, rows = Interpreted(system), system.x0.copy(), []
    for angle in np.radians(np.arange(0.0, 720.0, 0.5)):
        x[place] = angle
        rows.append(evaluation.outputs(0.0, x).copy())
    outputs = np.array(rows)
    return [
        doubt
        for line in lines
        for train in find_trains(system)
        if line.target.instance in train.parts
        for doubt in _judge(train, line.source.instance, line.target.instance, outputs)
    ]


def _is_gas_force(system: System, line: Connection) -> bool:
    """Whether it loads a valve with the gas of a four-stroke cycle that a crank turns."""
    gas, valve = (system.instances[end.instance] for end in (line.source, line.target))
    if not gas.component.has_role(roles.CylinderGas) or "lash" not in valve.component.parameters:
        return False
    turned = Port(line.source.instance, "crank_angle") in system.drivers
    return turned and count_gas_turns(gas) == 2.0 and line.target.variable == "gas_force"


def _judge(train: Train, gas: str, valve: str, outputs: Vector) -> Iterator[str]:
    system = train.system
    of_gas = system.instances[gas]
    angle = outputs[:, system.outputs.index(system.drivers[Port(gas, "crank_angle")])]
    lift = outputs[:, system.outputs.index(Port(train.cam, "cam_lift"))]
    pressure = outputs[:, system.outputs.index(Port(gas, "gas_pressure"))]
    lifted = lift > max(train.lash, LIFTED * float(np.max(lift)))
    after = np.degrees(angle - parameter_of(of_gas, "firing_angle")) % 720.0
    blowdown = math.nan
    if "exhaust_opening" in of_gas.component.parameters:
        blowdown = math.degrees(parameter_of(of_gas, "exhaust_opening"))
    for i in np.flatnonzero(lifted & ~np.roll(lifted, 1)):
        opens, against = float(after[i]), 1e-6 * float(pressure[i])
        text = f"{valve} opens {opens:.0f} deg after firing, against {against:.2g} MPa of gas"
        if not any(low <= opens <= high for low, high in (EXHAUST, INTAKE)):
            firing = math.degrees(parameter_of(of_gas, "firing_angle")) + opens - USUAL_EXHAUST
            yield (
                f"components.{gas}: {text}; exhaust valves open {EXHAUST[0]:g} to {EXHAUST[1]:g} deg "
                f"and intake valves {INTAKE[0]:g} to {INTAKE[1]:g} deg after it: check the cam's phase and "
                f"components.{gas}.parameters.firing_angle, e.g. '{firing:.0f} deg' for an exhaust valve"
            )
        elif opens <= EXHAUST[1] and abs(opens - blowdown) > APART:
            yield (
                f"components.{gas}: {text}, which begins to blow down {blowdown:.0f} deg after firing: "
                f"set components.{gas}.parameters.exhaust_opening = '{opens:.0f} deg'"
            )
