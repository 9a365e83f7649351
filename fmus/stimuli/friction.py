"""Stimuli of friction and bearings."""

import numpy as np

from ..reference_results.stimulus import Stimulus

TIMES = np.arange(51) * 1e-3

# fmt: off


def ehl_contact() -> Stimulus:
    duration, depth = 50e-3, 5e-6
    phase = np.pi * TIMES / duration
    return Stimulus(
        says="Two bodies approach each other by 5 um and part again in 50 ms (load up to 2.2 kN, 0.58 GPa), "
        "while the entraining velocity goes from 1.2 to -0.8 m/s and back, twice through zero, where the "
        "film is squeezed out to 90 nm and asperities carry a part. Film by the default formula.",
        corners=TIMES,
        inputs={
            "approach": depth * np.sin(phase) ** 2,
            "approach_rate": depth * np.pi / duration * np.sin(2.0 * phase),
            "entraining_velocity": 0.2 + np.cos(2.0 * phase),
            "sliding_velocity": 0.3,
        },
        step_size=1e-5, interval=1e-3,
        outputs=(
            "load", "film_thickness", "squeeze_velocity", "steady_film_thickness", "maximum_pressure",
            "friction_force", "viscous_friction", "asperity_load", "damping_margin",
        ),
    )


def journal_bearing() -> Stimulus:
    times = np.arange(81) * 1e-3
    x = 8e-6 * np.sin(2.0 * np.pi * times / 0.04)
    y = -32e-6 + 14e-6 * np.cos(2.0 * np.pi * times / 0.02)
    return Stimulus(
        says="A journal at 100 rad/s whose axis is pressed down by 18 to 46 um and moved to both sides, with "
        "a clearance of 25 um.",
        corners=times,
        inputs={
            "shaft_speed": 100.0, "axis_x": x, "axis_y": y,
            "axis_velocity_x": np.gradient(x, times), "axis_velocity_y": np.gradient(y, times),
        },
        step_size=1e-5, interval=8e-4,
        outputs=(
            "force_x", "force_y", "friction_torque", "load", "eccentricity_ratio", "minimum_film_thickness",
            "film_ratio", "maximum_pressure", "asperity_load", "power_loss",
        ),
    )


def pin_bearing() -> Stimulus:
    return Stimulus(
        says="A roller at 300 to 500 rad/s on its pin under 200 to 1000 N, from the middle of its clearance.",
        corners=TIMES,
        inputs={
            "rotation_rate": 400.0 + 100.0 * np.sin(2.0 * np.pi * TIMES / 0.02),
            "applied_load": 600.0 - 400.0 * np.cos(2.0 * np.pi * TIMES / 0.024),
        },
        step_size=1e-5, interval=5e-4,
        outputs=(
            "friction_torque", "eccentricity_ratio", "minimum_film_thickness", "asperity_load", "power_loss",
        ),
    )


def pivot_friction() -> Stimulus:
    return Stimulus(
        says="A lever that swings with 30 rad/s at most and slower and slower, on a pivot under 600 to 1400 "
        "N: it slides, turns back, and sticks.",
        corners=TIMES,
        inputs={
            "rotation_rate": 30.0 * np.exp(-TIMES / 5e-3) * np.cos(2.0 * np.pi * TIMES / 0.012),
            "load": 1000.0 + 400.0 * np.sin(2.0 * np.pi * TIMES / 0.031),
        },
        step_size=1e-5, interval=5e-4,
        outputs=("friction_torque", "sliding_torque", "sticking_margin", "sliding_rate", "power_loss"),
    )


def pad_friction() -> Stimulus:
    return Stimulus(
        says="A pad that slides to and fro with 0.6 m/s at most and slower and slower, under 300 to 700 N: "
        "it slides, turns back, and sticks.",
        corners=TIMES,
        inputs={
            "sliding_velocity": 0.6 * np.exp(-TIMES / 5e-3) * np.cos(2.0 * np.pi * TIMES / 0.012),
            "load": 500.0 + 200.0 * np.sin(2.0 * np.pi * TIMES / 0.031),
        },
        step_size=1e-5, interval=5e-4, outputs=("friction_force", "sticking_margin", "slip", "power_loss"),
    )


def guide_friction() -> Stimulus:
    return Stimulus(
        says="A valve that moves to and fro with 2 m/s at most and rests, under up to 100 N and 2 N m.",
        corners=TIMES,
        inputs={
            "velocity": 2.0 * np.exp(-TIMES / 5e-3) * np.cos(2.0 * np.pi * TIMES / 0.012),
            "side_force": 100.0 * np.sin(2.0 * np.pi * TIMES / 0.031),
            "side_moment": 2.0 * np.cos(2.0 * np.pi * TIMES / 0.023),
        },
        step_size=1e-5, interval=5e-4,
        outputs=(
            "friction_force", "viscous_friction", "near_load", "far_load", "sticking_margin", "power_loss",
        ),
    )


def roller() -> Stimulus:
    return Stimulus(
        says="A roller at rest on a cam of 2 m/s that grows faster and slower: it slips until it has the "
        "speed of the cam, rolls, and slips again while its load is 5 N.",
        corners=TIMES,
        inputs={
            "rolling_velocity": 2.0 + 0.5 * np.sin(2.0 * np.pi * TIMES / 0.02),
            "load": np.where((TIMES > 0.025) & (TIMES < 0.035), 5.0, 400.0),
            "pin_torque": 0.01,
            "rotation_rate": 10.0 * np.sin(2.0 * np.pi * TIMES / 0.017),
        },
        step_size=1e-5, interval=5e-4,
        outputs=("surface_speed", "spin", "traction", "traction_margin", "carrier_torque", "power_loss"),
    )


def tappet_spin() -> Stimulus:
    times = np.arange(61) * 1e-3
    return Stimulus(
        says="A tappet at rest, which a cam turns that slides with 2.2 to 3 m/s, under 20 to 60 N of "
        "friction.",
        corners=times,
        inputs={
            "sliding_velocity": 2.6 - 0.4 * np.cos(2.0 * np.pi * times / 0.06),
            "contact_offset": 8e-3 * np.sin(2.0 * np.pi * times / 0.06),
            "friction_force": 40.0 + 20.0 * np.sin(2.0 * np.pi * times / 0.03),
        },
        step_size=1e-5, interval=5e-4,
        outputs=("spin", "contact_sliding", "cam_friction", "spin_torque", "bore_torque", "power_loss"),
    )
