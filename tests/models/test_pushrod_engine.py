"""Eight pushrod trains on one elastic shaft, against independent numbers of its steady cycle."""

from __future__ import annotations

import math

import pytest

from models.catalogue import CATALOGUE
from models.core.quantities import Layout
from models.core.system import Instance, System
from models.monolithic.cycle import find_cycle
from models.valve_train.beam import find_torsion, list_parameters, rigid_bending
from models.valve_train.cams.law import law_lift
from models.valve_train.tappet import TappetParameters

from .systems import turn
from .test_shaft import SHAFT
from .test_train_parts import TRAIN, loads_at_rest, pushrod_train

EVALUATION = "independent evaluation"
SPEED, OMEGA = 1000.0, 1000.0 * math.pi / 30.0
PHASES = [math.radians(degrees) for degrees in (305, 305, 35, 35, 215, 215, 125, 125)]
# Damping of the shaft over its stiffness (s).
DAMPING = 1.370291042e-5
# Least and largest over a turn; twists in mdeg.
EXPECTED = {
    "shaft.drive_torque": (-1.40747, 1.39591),
    "shaft.twist[1]": (-1.918, 1.934),
    "shaft.twist[8]": (-110.073, 112.000),
    "cam_contact_1.load": (410.582, 851.342),
    "cam_contact_8.load": (410.622, 851.348),
}


def pushrod_engine():
    """Eight of the stiff trains, loaded by 330 N at rest; torsion alone."""
    one = pushrod_train(SPEED, 660.0 - loads_at_rest(pushrod_train(SPEED)))
    torsion = find_torsion(SHAFT, 3)
    shaft = CATALOGUE["shaft"](cams=8, torsion_modes=torsion.frequency.size)
    instances = {
        "flywheel": one.instances["flywheel"],
        "shaft": Instance(shaft, list_parameters(torsion, rigid_bending(8), DAMPING, 0.0)),
    }
    connections = [
        ("flywheel.angle", "shaft.drive_angle"),
        ("flywheel.speed", "shaft.drive_speed"),
        ("shaft.drive_torque", "flywheel.load_torque[1]"),
    ]
    driven = {"flywheel.angle": "cam_angle", "flywheel.speed": "cam_speed"}
    ends = TRAIN.split()
    for k, phase in enumerate(PHASES, 1):
        for name, instance in one.instances.items():
            if name != "flywheel":
                own = {"phase": phase} if name == "tappet" else {}
                instances[f"{name}_{k}"] = Instance(instance.component, {**instance.parameters, **own})
        for source, target in zip(ends[::2], ends[1::2], strict=True):
            given = f"shaft.{driven[source]}[{k}]" if source in driven else source.replace(".", f"_{k}.", 1)
            connections.append((given, target.replace(".", f"_{k}.", 1)))
        connections.append((f"tappet_{k}.cam_torque", f"shaft.cam_torque[{k}]"))
    return System(instances, connections)


def start_on_cams(system):
    """A state near that of trains without elasticity: all parts where their cams have them."""
    start, cam = system.x0.copy(), Layout(TappetParameters).defaults()
    names = system.state.names
    for k, phase in enumerate(PHASES, 1):
        lift = law_lift(phase, cam)
        # The pushrod is 8 um shorter under its load.
        position, velocity = lift.s - 3e-6, lift.ds * OMEGA
        beyond = position - 8e-6
        values = {
            f"tappet_{k}.position": position,
            f"tappet_{k}.velocity": velocity,
            f"rocker_{k}.rotation": beyond / 32e-3,
            f"rocker_{k}.rotation_rate": velocity / 32e-3,
            f"valve_spring_{k}.position": 1.25 * beyond,
            f"valve_spring_{k}.velocity": 1.25 * velocity,
        }
        for i in range(1, 5):
            values[f"pushrod_{k}.displacement[{i}]"] = position - 8e-6 * (i - 0.5) / 4.0
            values[f"pushrod_{k}.velocity[{i}]"] = velocity
        for i, share in ((1, 0.625), (2, 0.375)):
            values[f"valve_spring_{k}.coil_position[{i}]"] = 1.25 * share * lift.s
            values[f"valve_spring_{k}.coil_velocity[{i}]"] = 1.25 * share * velocity
        for name, value in values.items():
            start[names.index(name)] = value
    return start


@pytest.mark.long
def test_the_cycle_of_eight_trains_on_an_elastic_shaft(record):
    """Stiff contacts in the place of ideal ones leave 3e-4 of torques and twists, 1e-4 of the loads."""
    system = pushrod_engine()
    cycle = find_cycle(system, turn(SPEED), ["flywheel.angle"], start=start_on_cams(system), samples=1440)
    assert cycle.steady
    for name, expected in EXPECTED.items():
        scale = 1e3 * math.degrees(1.0) if "twist" in name else 1.0
        found = scale * float(cycle[name].min()), scale * float(cycle[name].max())
        for which, value, wanted in zip(("least", "largest"), found, expected, strict=True):
            quantity = f"8 pushrod trains on a shaft: {which} {name}"
            record("Train", quantity, value, wanted, EVALUATION, tolerance=5e-4 * abs(wanted))
