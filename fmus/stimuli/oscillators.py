"""Stimuli of oscillators and of the nonlinear loop."""

import numpy as np

from ..reference_results.stimulus import Stimulus

# fmt: off


def coupled_mass() -> Stimulus:
    return Stimulus(
        says="The other mass jumps by 1 m at 1 s and moves back at 0.25 m/s from 3 to 7 s.",
        corners=[0.0, 1.0, 1.0, 3.0, 3.0, 7.0, 7.0, 10.0],
        inputs={
            "other_position": [0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0],
            "other_velocity": [0.0, 0.0, 0.0, 0.0, -0.25, -0.25, 0.0, 0.0],
        },
        step_size=1e-3, interval=0.08, outputs=("force", "position", "velocity"),
    )


def sprung_mass() -> Stimulus:
    return Stimulus(
        says="A force that jumps to 10 N at 1 s, stays, and falls to -5 N from 4 to 6 s.",
        corners=[0.0, 1.0, 1.0, 4.0, 6.0, 10.0],
        inputs={"force": [0.0, 0.0, 10.0, 10.0, -5.0, -5.0]},
        step_size=1e-3, interval=0.08, outputs=("position", "velocity"),
    )


def falling_mass() -> Stimulus:
    return Stimulus(
        says="Free fall for 0.1 s, then a force that grows to 30 N and throws the mass up again, then free "
        "flight.",
        corners=[0.0, 0.1, 0.3, 0.3, 0.5],
        inputs={"force": [0.0, 0.0, 30.0, 0.0, 0.0]},
        step_size=1e-4, interval=4e-3, outputs=("position", "velocity"),
    )


def spring_stop() -> Stimulus:
    times = np.arange(51) * 1e-2
    phase = np.pi * times / 0.5
    return Stimulus(
        says="What strikes the stop presses it by 20 mm and leaves it again: contact made and lost.",
        corners=times,
        inputs={"position": 0.05 - 0.07 * np.sin(phase), "velocity": -0.07 * np.pi / 0.5 * np.cos(phase)},
        step_size=1e-3, interval=5e-3, outputs=("force", "compression", "contact_margin", "impulse"),
    )


def quarter_car_chassis() -> Stimulus:
    return Stimulus(
        says="The wheel rises by 0.1 m in 0.2 s, stays up for 0.8 s and returns; the chassis follows and "
        "swings out.",
        corners=[0.0, 0.2, 0.2, 1.0, 1.0, 1.2, 1.2, 3.0],
        inputs={
            "wheel_position": [0.0, 0.1, 0.1, 0.1, 0.1, 0.0, 0.0, 0.0],
            "wheel_velocity": [0.5, 0.5, 0.0, 0.0, -0.5, -0.5, 0.0, 0.0],
        },
        step_size=1e-3, interval=2.5e-2, outputs=("position", "velocity", "suspension_force"),
    )


def quarter_car_wheel() -> Stimulus:
    return Stimulus(
        says="The wheel hops up a step of the road, under a chassis that follows by 0.05 m and comes back.",
        corners=[0.0, 0.2, 0.2, 0.6, 0.6, 2.0],
        inputs={
            "chassis_position": [0.0, 0.05, 0.05, 0.03, 0.03, 0.03],
            "chassis_velocity": [0.25, 0.25, -0.05, -0.05, 0.0, 0.0],
        },
        step_size=1e-3, interval=2e-2, outputs=("position", "velocity", "suspension_force", "tyre_force"),
    )


def planes() -> Stimulus:
    return Stimulus(
        says="The third coordinate grows from 1 to 2 and falls to -1.",
        corners=[0.0, 0.5, 1.0], inputs={"c": [1.0, 2.0, -1.0]},
        step_size=0.01, interval=0.01, outputs=("a", "square"),
    )


def sphere() -> Stimulus:
    return Stimulus(
        says="The first coordinate grows from 0.6 to 1 while the second stays.",
        corners=[0.0, 0.5, 1.0], inputs={"a": [0.6, 1.0, 1.0], "b": -1.8},
        step_size=0.01, interval=0.01, outputs=("c", "square"),
    )
