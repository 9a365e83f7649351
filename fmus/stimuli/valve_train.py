"""Stimuli of cams, followers, valves and springs."""

import numpy as np

from ..reference_results.stimulus import Stimulus

# A little more than one turn of the cam (s) at its speed (rad/s).
TURN, SPEED = np.arange(66) * 2e-3, 50.0

# fmt: off


def camshaft() -> Stimulus:
    # A valve train's load: its spring at rest on the base circle, more over the lift.
    load = 330.0 + 280.0 * np.sin(np.pi * np.clip((TURN - 0.03) / 0.066, 0.0, 1.0)) ** 2
    return Stimulus(
        says="A little more than one turn of the cam at 50 rad/s, rise, dwell and fall included, under a "
        "contact load that grows with the lift and friction of 5 % of it.",
        corners=TURN,
        inputs={
            "drive_angle": SPEED * TURN, "drive_speed": SPEED,
            "contact_load": load, "friction_force": 0.05 * load,
        },
        step_size=1e-4, interval=2e-3,
        outputs=(
            "cam_angle", "surface_position", "surface_velocity", "radius_of_curvature", "entraining_velocity",
            "sliding_velocity", "contact_offset", "drive_torque", "next_event",
        ),
    )


def tappet() -> Stimulus:
    # What moves 0.1 kg along 8 mm sin^2 and back.
    w = np.pi / 0.064
    lifting = ((TURN > 0.03) & (TURN < 0.094)) * 0.1 * 8e-3 * 2.0 * w**2 * np.cos(2.0 * w * (TURN - 0.03))
    return Stimulus(
        says="A little more than one turn of the cam at 50 rad/s under a flat follower, whose load of 300 N "
        "is a little less or more than the train's, with friction of 5 % of it.",
        corners=TURN,
        inputs={
            "cam_angle": SPEED * TURN, "cam_speed": SPEED,
            "cam_load": 300.0 + lifting, "cam_friction": 15.0, "load": 300.0,
        },
        step_size=1e-4, interval=2e-3,
        outputs=(
            "position", "velocity", "overlap", "overlap_rate", "entraining_velocity", "sliding_velocity",
            "radius_of_curvature", "cam_torque", "next_event",
        ),
    )


def finger() -> Stimulus:
    load, ratio = 2.0, 1.42069  # on the valve (N), and of the lever when closed
    turning = 0.1 * np.sin(100.0 * TURN)  # a small part of the load on the cam, to and fro (N)
    return Stimulus(
        says="A little more than one turn of the cam at 50 rad/s under the pad. The load on the cam goes to "
        "and fro about what balances 2 N on the valve; the pivot bears the rest.",
        corners=TURN,
        inputs={
            "cam_angle": SPEED * TURN, "cam_speed": SPEED,
            "cam_load": ratio * load + turning, "tip_load": load,
            "pivot_force": (ratio - 1.0) * load + 0.3 * turning,
        },
        step_size=1e-4, interval=2e-3,
        outputs=(
            "rotation", "pivot_position", "tip_position", "tip_velocity", "tip_sliding_velocity", "overlap",
            "sliding_velocity", "cam_torque", "ratio", "support_force",
        ),
    )


def rocker() -> Stimulus:
    times, w = np.arange(41) * 1e-3, np.pi / 0.02
    # What balances the valve's load, with a swing of 12 deg forth and back.
    force = 1.25 * 400.0 + 6e-5 * 0.1 * 4.0 * w**2 * np.cos(2.0 * w * times) / 32e-3
    return Stimulus(
        says="A pushrod's force that swings the lever by 12 deg twice, against 400 N on the valve, whose "
        "friction is 5 % of it, as broken lines.",
        corners=times,
        inputs={
            "rod_force": force, "tip_load": 400.0, "tip_friction": 20.0 * np.sin(np.pi * times / 0.01),
        },
        step_size=1e-4, interval=4e-4,
        outputs=(
            "rotation", "rod_position", "rod_velocity", "tip_position", "tip_velocity",
            "tip_entraining_velocity", "tip_sliding_velocity", "pivot_force",
        ),
    )


def rod() -> Stimulus:
    times = np.arange(21) * 1e-4
    lower = 20e-6 * np.sin(np.pi * times / 2e-3) ** 2
    return Stimulus(
        says="The body below presses the rod by 20 um against one at rest and goes back, as a broken line "
        "whose corners excite waves. Then the ends part and touch again.",
        corners=times,
        inputs={"lower_position": lower, "lower_velocity": np.gradient(lower, times)},
        step_size=2e-6, interval=2e-5,
        outputs=("lower_force", "upper_force", "lower_compression", "upper_compression"),
    )


def shaft() -> Stimulus:
    speed, times = 100.0, np.arange(41) * 1e-3  # rad/s
    return Stimulus(
        says="A shaft at 100 rad/s under a cam's torque and forces, as broken lines over 40 ms whose corners "
        "excite torsion and bending.",
        corners=times,
        inputs={
            "drive_angle": speed * times,
            "drive_speed": speed,
            "cam_torque[1]": 5.0 * np.sin(2.0 * np.pi * times / 0.02),
            "cam_force_x[1]": 30.0 * np.sin(2.0 * np.pi * times / 0.01),
            "cam_force_y[1]": -400.0 - 200.0 * np.cos(2.0 * np.pi * times / 0.02),
        },
        step_size=1e-5, interval=4e-4,
        outputs=(
            "cam_angle[1]", "cam_speed[1]", "twist[1]", "axis_x[1]", "axis_y[1]", "axis_velocity_x[1]",
            "axis_velocity_y[1]", "drive_torque",
        ),
    )


def lash_adjuster() -> Stimulus:
    return Stimulus(
        says="The chamber is compressed by 40 um within 4 ms, leaks down, is released, draws oil through its "
        "check valve, and fills up.",
        corners=[0.0, 4e-3, 8e-3, 30e-3, 34e-3, 60e-3],
        inputs={
            "lower_position": [0.0, 0.0, 40e-6, 40e-6, 0.0, 0.0],
            "lower_velocity": [0.0, 5e-3, 5e-3, 0.0, 0.0, 0.0],
        },
        step_size=1e-4, interval=1e-3,
        outputs=("force", "pressure", "extension", "leak_flow", "valve_flow", "valve_excess"),
    )


def coil_spring() -> Stimulus:
    times, lift, duration = np.arange(41) * 0.5e-3, 17e-3, 8e-3
    share = np.clip(times / duration, 0.0, 1.0)
    return Stimulus(
        says="The moving end goes by 17 mm and back in 8 ms, as a broken line whose corners excite surge; "
        "some coils touch near the largest lift. Then 12 ms of free vibration.",
        corners=times,
        inputs={
            "position": lift * np.sin(np.pi * share) ** 2,
            "velocity": lift * np.pi / duration * np.sin(2.0 * np.pi * share),
        },
        step_size=1e-5, interval=2e-4,
        outputs=(
            "force", "least_gap", "clash_force", "coil_position[1]", "coil_position[4]", "coil_position[8]",
        ),
    )


def _lift_valve(
    times: np.ndarray, begin: float, duration: float, lift: float, mass: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of lift sin^2: the force of a spring of 35 N/mm and of inertia (N), and when it is open."""
    w, share = np.pi / duration, np.clip((times - begin) / duration, 0.0, 1.0)
    inertia = mass * lift * 2.0 * w**2 * np.cos(2.0 * w * (times - begin))
    return 35e3 * lift * np.sin(np.pi * share) ** 2, inertia, (times > begin) & (times < begin + duration)


def valve() -> Stimulus:
    times = np.arange(23) * 1e-3
    pressed, inertia, opened = _lift_valve(times, 2e-3, 16e-3, 4e-3, 0.1)
    spring = 300.0 + pressed
    return Stimulus(
        says="A valve that rests on its seat, is lifted by some 4 mm in 16 ms as a broken line, and lands on "
        "its seat again.",
        corners=times,
        inputs={"load": spring - 60.0 + opened * (60.0 + inertia), "spring_force[1]": spring},
        step_size=1e-5, interval=2e-4,
        outputs=("position", "velocity", "acceleration", "seat_force", "seat_dip"),
    )


def valve_spring() -> Stimulus:
    times = np.arange(41) * 1e-3
    # By preload, rate and inertia of the defaults.
    pressed, inertia, opened = _lift_valve(times, 4e-3, 32e-3, 8e-3, 0.25)
    return Stimulus(
        says="A valve's lift of 8 mm in 32 ms by the force that it takes, as a broken line whose corners "
        "excite surge of the coils; then 4 ms of free vibration.",
        corners=times,
        inputs={"load": 330.0 + pressed + opened * inertia},
        step_size=1e-5, interval=4e-4,
        outputs=(
            "position", "velocity", "acceleration", "spring_force", "coil_position[1]", "coil_position[2]",
        ),
    )
