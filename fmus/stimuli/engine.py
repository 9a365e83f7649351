"""Stimuli of the crank, its piston, its gas, and the rotor that drives."""

import numpy as np

from ..reference_results.stimulus import Stimulus

# fmt: off


def flywheel() -> Stimulus:
    return Stimulus(
        says="The shaft turns at its prescribed speed, 1000 r/min, while a mechanism loads it with a torque "
        "that grows to 30 N m, falls, and changes its sign: what the drive supplies.",
        corners=[0.0, 0.1, 0.25, 0.4], inputs={"load_torque[1]": [0.0, 30.0, -5.0, 10.0]},
        step_size=1e-3, interval=4e-3, outputs=("angle", "speed", "supplied_torque", "throw_angle[1]"),
    )


def slider_crank() -> Stimulus:
    speed, times = 100.0, np.arange(91) * 2e-3  # rad/s
    return Stimulus(
        says="Nearly three turns of the crank at 100 rad/s, from the middle of the clearance: flights and "
        "impacts on both walls, which films of up to 20 um narrow. The motion is chaotic in the long run; "
        "until 0.18 s, its horizon here, errors grow less than a thousandfold.",
        corners=times,
        inputs={
            "crank_angle": speed * times,
            "crank_speed": speed,
            "upper_film_thickness": 2e-5 * np.sin(np.pi * times / 0.09) ** 2,
            "lower_film_thickness": 1e-5 * np.clip(times / 0.1, 0.0, 1.0),
        },
        step_size=1e-4, interval=2e-3,
        outputs=(
            "psi", "psi_rate", "piston_offset", "crank_torque", "impact_count", "upper_wall_impulse",
            "lower_wall_impulse", "last_impact_time", "last_impact_velocity",
        ),
    )


def piston_crank() -> Stimulus:
    speed, times = 200.0, np.arange(64) * 1e-3  # rad/s
    angle = speed * times
    after = np.mod(angle + np.pi, 4.0 * np.pi) - np.pi  # the firing dead centre
    return Stimulus(
        says="One four-stroke cycle at 200 rad/s under a firing pressure of 3 MPa: the piston tilts and goes "
        "from wall to wall, each arrival a sequence of impacts of its corners that ends in sliding. Between "
        "arrivals nothing of these sequences is left, so that errors do not grow.",
        corners=times,
        inputs={
            "crank_angle": angle,
            "crank_speed": speed,
            "gas_pressure": 3e6 * np.exp(-(((after - 0.3) / 0.5) ** 2)),
        },
        step_size=1e-5, interval=7e-4,
        outputs=(
            "piston_offset", "piston_tilt", "piston_tilt_rate", "lower_front_force", "wall_friction_force",
            "pin_force_along", "impact_count", "impact_loss", "crank_torque",
        ),
    )


def free_piston_crank() -> Stimulus:
    times = np.arange(61) * 1e-3
    return Stimulus(
        says="A crank at rest is driven by 20 N m, then 60 N m, while the gas presses on the piston for 20 "
        "ms: the piston goes to its wall in a sequence of impacts and slides.",
        corners=times,
        inputs={
            "crank_drive": np.clip(20.0 + 2e3 * (times - 0.02), 20.0, 60.0),
            "gas_pressure": 2e6 * np.sin(np.pi * np.clip((times - 0.01) / 0.02, 0.0, 1.0)) ** 2,
        },
        step_size=1e-5, interval=6e-4,
        outputs=(
            "crank_angle", "crank_speed", "piston_velocity", "piston_offset", "piston_tilt",
            "lower_front_force", "pin_force_along", "impact_count", "impact_loss",
        ),
    )


def cylinder_gas() -> Stimulus:
    speed, stop = 200.0, 0.064
    return Stimulus(
        says="One four-stroke cycle at 200 rad/s, from the firing dead centre: expansion, blowdown, exhaust, "
        "intake, compression.",
        corners=[0.0, stop], inputs={"crank_angle": [0.0, speed * stop], "crank_speed": speed},
        step_size=1e-4, interval=5e-4, outputs=("gas_pressure", "indicated_work", "valve_force[1]"),
    )


def piston_clearance() -> Stimulus:
    times = np.arange(61) * 1e-3
    return Stimulus(
        says="Two turns of the crank; the valve lifts by 9 mm about the top dead centre between them.",
        corners=times,
        inputs={
            "angle": 4.0 * np.pi * times / times[-1],
            "valve_lift": 9e-3 * np.exp(-(((times - 0.03) / 8e-3) ** 2)),
        },
        step_size=1e-4, interval=5e-4, outputs=("clearance", "radial_clearance", "piston_travel"),
    )
