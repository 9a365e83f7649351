"""Pushrod trains, one alone and eight on an elastic shaft, against independent numbers."""

import math

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.core.evaluation import Evaluation
from models.core.system import Instance, System
from models.monolithic.cycle import find_cycle
from models.monolithic.equilibrium import equilibrium
from models.monolithic.problem import SystemProblem
from models.valve_train.beam import find_torsion, list_parameters, rigid_bending
from models.valve_train.cams.law import law_lift
from models.valve_train.tappet import tappet

from .systems import column, run, turn, wheel
from .test_shaft import SHAFT

EVALUATION = "independent evaluation"
SPEED, OMEGA = 1000.0, 1000.0 * math.pi / 30.0


def pushrod_links(segments=4):
    """Rocker and valve on a pushrod whose lower end is held; a stiff link without mass ties both together."""
    rigid = {
        "bonded": 1.0,
        "damping_time": 0.0,
        "length": 1e-3,
        "area": 1e-2,
        "density": 1e-3,
        "youngs_modulus": 2e12,
    }
    return System(
        {
            "pushrod": Instance(CATALOGUE["rod"](segments=segments), {"bonded": 1.0, "damping_time": 0.0}),
            "rocker": Instance(CATALOGUE["rocker"](), {"small_motion": 1.0}),
            "link": Instance(CATALOGUE["rod"](segments=1), rigid),
            "valve_spring": Instance(CATALOGUE["valve_spring"](), {"valve_mass": 0.1, "damping_ratio": 0.0}),
        },
        (
            ("rocker.rod_position", "pushrod.upper_position"),
            ("rocker.rod_velocity", "pushrod.upper_velocity"),
            ("pushrod.upper_force", "rocker.rod_force"),
            ("rocker.tip_position", "link.lower_position"),
            ("rocker.tip_velocity", "link.lower_velocity"),
            ("link.lower_force", "rocker.tip_load"),
            ("valve_spring.position", "link.upper_position"),
            ("valve_spring.velocity", "link.upper_velocity"),
            ("link.upper_force", "valve_spring.load"),
        ),
    )


@pytest.mark.plain
def test_natural_frequencies_of_a_pushrod_train(record):
    """The cam's side is held; four segments."""
    system = pushrod_links()
    evaluation = Evaluation(system)
    n = system.state.size
    zero = evaluation.derivative(0.0, np.zeros(n)).copy()
    a = np.column_stack(
        [(evaluation.derivative(0.0, 1e-6 * unit).copy() - zero) / 1e-6 for unit in np.eye(n)]
    )
    found = np.sort(np.abs(np.linalg.eigvals(a).imag)) / (2.0 * math.pi)
    found = found[found > 1.0][::2]
    for i, expected in enumerate((504.12796, 1008.78230, 2334.309)):
        quantity = f"pushrod train: natural frequency {i + 1} (Hz)"
        record("Train", quantity, float(found[i]), expected, EVALUATION, tolerance=1e-6 * expected)


# Loads at the cam and at the valve (N), least and largest over a turn, of contacts without elasticity. The
# preload is 330 N in the loaded train.
PUSHROD_LOADS = {1000.0: (410.582, 851.34, 328.996, 680.544), 1600.0: (404.055, 857.199, 325.440, 683.573)}
TRAIN = """
    flywheel.angle tappet.cam_angle             flywheel.speed tappet.cam_speed
    tappet.overlap cam_contact.approach         tappet.overlap_rate cam_contact.approach_rate
    tappet.radius_of_curvature cam_contact.radius_of_curvature
    tappet.position pushrod.lower_position      tappet.velocity pushrod.lower_velocity
    rocker.rod_position pushrod.upper_position  rocker.rod_velocity pushrod.upper_velocity
    pushrod.lower_force tappet.load             pushrod.upper_force rocker.rod_force
    rocker.tip_position valve_contact.approach  rocker.tip_velocity valve_contact.approach_rate
    rocker.tip_contact_radius valve_contact.radius_of_curvature
    valve_spring.position valve_contact.retreat valve_spring.velocity valve_contact.retreat_rate
    cam_contact.load tappet.cam_load            valve_contact.load rocker.tip_load
    valve_contact.load valve_spring.load
"""


def pushrod_train(speed, preload=330.0):
    """With dry contacts of thirty times the modulus of steel, a constant ratio and a bonded pushrod."""
    modulus = 30.0 * 207e9
    stiff = {"film_model": 7.0, "youngs_modulus_1": modulus, "youngs_modulus_2": modulus}
    return System(
        {
            "flywheel": wheel(speed * math.pi / 30.0),
            "tappet": Instance(CATALOGUE["tappet"](), {}),
            "pushrod": Instance(CATALOGUE["rod"](), {"bonded": 1.0}),
            "rocker": Instance(CATALOGUE["rocker"](), {"small_motion": 1.0}),
            "valve_spring": Instance(CATALOGUE["valve_spring"](), {"valve_mass": 0.1, "preload": preload}),
            "cam_contact": Instance(CATALOGUE["ehl_contact"](), stiff),
            "valve_contact": Instance(CATALOGUE["ehl_contact"](), stiff),
        },
        list(zip(TRAIN.split()[::2], TRAIN.split()[1::2], strict=True)),
    )


def loads_at_rest(system):
    outputs = Evaluation(system).outputs(0.0, equilibrium(system))
    return column(system, outputs[None, :], "valve_contact.load")[0]


@pytest.mark.long
@pytest.mark.parametrize("speed", [1000.0, 1600.0])
def test_loads_of_a_pushrod_train(speed, record):
    """Contacts so stiff leave 1e-4 of the loads; their resonances are those of 30 times the stiffness."""
    preload = 660.0 - loads_at_rest(pushrod_train(speed))
    system = pushrod_train(speed, preload)
    times = np.r_[0.0, np.linspace(5.0, 6.0, 14401) * turn(speed)]
    y = run(SystemProblem(system), equilibrium(system), times, tolerance=1e-8)[1:]
    found = []
    for name in ("cam_contact.load", "valve_contact.load"):
        load = column(system, y, name)
        found += [float(load.min()), float(load.max())]
    names = ("least cam load", "largest cam load", "least valve load", "largest valve load")
    for name, value, expected in zip(names, found, PUSHROD_LOADS[speed], strict=True):
        quantity = f"pushrod train at {speed:g} r/min: {name} (N)"
        record("Train", quantity, value, expected, EVALUATION, tolerance=3e-4 * expected)


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
    start, cam = system.x0.copy(), tappet().parameters.defaults()
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
