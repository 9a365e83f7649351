"""Mechanism of Flores, Leine and Glocker (2010), against a time-stepping method written here.

Moreau's midpoint rule with their equations of motion (theta_1, theta_2, theta_3 of the bodies), contact
law and data: nothing of `models` but the data. Its error falls with the first power of the step, as it
finds impacts to a step only.
"""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from models.slider_crank.piston.records import FLORES

from .slider_cranks import FREE, advance

SPEED = 150.0
SWEEPS = 400  # of the projected Gauss-Seidel; flat contact converges by 0.92 a sweep


@dataclass(frozen=True)
class Flores:
    """Their section 5; angles from the x axis, so that theta_2 = -eta."""

    r: float = FLORES["crank_radius"]
    l: float = FLORES["rod_length"]
    m1: float = FLORES["crank_mass"]
    m2: float = FLORES["rod_mass"]
    m3: float = FLORES["piston_mass"]
    j1: float = FLORES["crank_inertia"]
    j2: float = FLORES["rod_inertia"]
    j3: float = FLORES["piston_inertia"]
    a: float = FLORES["half_length"]
    b: float = FLORES["half_height"]
    clearance: float = FLORES["clearance"]
    gravity: float = 9.81

    def mass(self, q: np.ndarray) -> np.ndarray:
        mixed = (0.5 * self.m2 + self.m3) * self.r * self.l * math.cos(q[0] - q[1])
        return np.array(
            [
                [self.j1 + (0.25 * self.m1 + self.m2 + self.m3) * self.r**2, mixed, 0.0],
                [mixed, self.j2 + (0.25 * self.m2 + self.m3) * self.l**2, 0.0],
                [0.0, 0.0, self.j3],
            ]
        )

    def forces(self, q: np.ndarray, u: np.ndarray) -> np.ndarray:
        mixed = (0.5 * self.m2 + self.m3) * self.r * self.l * math.sin(q[0] - q[1])
        weight = self.gravity * np.array([0.5 * self.m1 + self.m2 + self.m3, 0.5 * self.m2 + self.m3])
        return np.array(
            [
                -mixed * u[1] ** 2 - weight[0] * self.r * math.cos(q[0]),
                mixed * u[0] ** 2 - weight[1] * self.l * math.cos(q[1]),
                0.0,
            ]
        )

    def contacts(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Gaps (4,), their gradients and those of the places along the walls (4, 3)."""
        sines, cosines = np.sin(q), np.cos(q)
        gaps, normals, tangents = [], [], []
        for side in (1.0, -1.0):
            for end in (1.0, -1.0):
                a, b = end * self.a, side * self.b
                y = self.r * sines[0] + self.l * sines[1] + a * sines[2] + b * cosines[2]
                gaps.append(self.b + self.clearance - side * y)
                turned = a * cosines[2] - b * sines[2]
                normals.append(-side * np.array([self.r * cosines[0], self.l * cosines[1], turned]))
                swung = -a * sines[2] - b * cosines[2]
                tangents.append(np.array([-self.r * sines[0], -self.l * sines[1], swung]))
        return np.array(gaps), np.array(normals), np.array(tangents)


def impulses(
    mass: np.ndarray, normals: np.ndarray, tangents: np.ndarray, free: np.ndarray, before: np.ndarray,
    restitution: float, friction: float,
) -> np.ndarray:  # fmt: skip
    """Velocities after the contact impulses, by projected Gauss-Seidel."""
    u = free.copy()
    pushes, drags = np.linalg.solve(mass, normals.T).T, np.linalg.solve(mass, tangents.T).T
    found = np.zeros((len(normals), 2))
    for _ in range(SWEEPS):
        worst = 0.0
        for i, (n, t) in enumerate(zip(normals, tangents, strict=True)):
            xi = n @ u + restitution * (n @ before)
            pressed = max(0.0, found[i, 0] - xi / (n @ pushes[i]))
            u += pushes[i] * (pressed - found[i, 0])
            bound = friction * pressed
            dragged = min(bound, max(-bound, found[i, 1] - t @ u / (t @ drags[i])))
            u += drags[i] * (dragged - found[i, 1])
            worst = max(worst, abs(pressed - found[i, 0]))
            found[i] = pressed, dragged
        if worst < 1e-15:
            break
    return u


def time_stepping(step: float, end: float, restitution: float, friction: float) -> np.ndarray:
    """(theta_1, theta_2, theta_3, rates) at `end`."""
    m = Flores()
    q, u = np.zeros(3), np.array([SPEED, -0.5 * SPEED, 0.0])
    for _ in range(round(end / step)):
        middle = q + 0.5 * step * u
        mass = m.mass(middle)
        free = u + step * np.linalg.solve(mass, m.forces(middle, u))
        gaps, normals, tangents = m.contacts(middle)
        active = gaps <= 0.0
        after = free
        if active.any():
            after = impulses(mass, normals[active], tangents[active], free, u, restitution, friction)
        q, u = middle + 0.5 * step * after, after
    return np.concatenate([q, u])


def event_driven(end: float, restitution: float, friction: float) -> tuple[np.ndarray, dict[str, float]]:
    """The same from the component."""
    p = FREE.parameters.vector({**FLORES, "restitution": restitution, "wall_friction": friction})
    y = advance(FREE, FREE.state.vector({"crank_speed": SPEED}), p, 0.0, end)
    return np.array([y["crank_angle"], -y["rod_angle"], y["piston_tilt"]]), y


@pytest.mark.long
@pytest.mark.parametrize(
    ("restitution", "friction", "end", "impacts"),
    [
        (0.4, 0.01, 0.0024, 0),  # free
        (0.4, 0.01, 0.006, 4),  # two flat impacts
        (0.4, 0.01, 0.012, 28),  # bounced to rest, sliding on the upper wall
        (0.1, 0.0, 0.012, 10),  # as in Siconos' time-stepping example
        (0.4, 0.01, 0.03, 34),  # released, then on the other wall
    ],
)
def test_time_stepping_converges_to_the_event_driven_motion(restitution, friction, end, impacts, record):
    """The difference halves with the step: to within a tenth, as impacts fall anywhere in a step."""
    angles, y = event_driven(end, restitution, friction)
    assert y["impact_count"] == impacts
    errors = [
        np.abs(time_stepping(step, end, restitution, friction)[:3] - angles).max()
        for step in (2e-5, 1e-5, 5e-6)
    ]
    ratios = np.array([errors[0] / errors[1], errors[1] / errors[2]])
    quantity, source = "ratio of differences as the step is halved", "Moreau's time stepping, first order"
    record("Slider-crank", f"piston of Flores et al. (2010): {quantity}", ratios, 2.0, source, relative=0.1)
    # Extrapolated to step zero the two agree to the next order.
    assert abs(2.0 * errors[2] - errors[1]) < 0.1 * errors[2]


@pytest.mark.long
def test_piston_without_an_initial_tilt_stays_flat():
    """Both corners of a wall meet it together and share the impulse but for the friction's moment."""
    _, y = event_driven(0.02, 0.4, 0.01)
    for front, rear in ((1, 2), (3, 4)):
        assert y[f"corner_impact_count[{front}]"] == y[f"corner_impact_count[{rear}]"]
    assert abs(y["piston_tilt"]) < 1e-15
    assert y["corner_impact_impulse[1]"] == pytest.approx(y["corner_impact_impulse[2]"], rel=0.02)


def test_start_of_the_source_is_the_aligned_mechanism(record):
    """theta_2' = -75 rad/s at 150 rad/s: the piston does not move across the bore."""
    p = FREE.parameters.vector(FLORES)
    x = FREE.state.vector({"crank_speed": SPEED})
    y = np.zeros(FREE.outputs.size)
    FREE.flat_output(0.0, x, FREE.inputs.vector(), p, y)
    named = FREE.outputs.named(y)
    quantity, source = "piston of Flores et al. (2010): position at the start (m)", "data of the source"
    record("Slider-crank", quantity, named["piston_position"], 0.459, source, relative=1e-15)
    assert named["piston_velocity"] == named["piston_offset_rate"] == 0.0
