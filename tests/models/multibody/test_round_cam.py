"""Rollers and points on cams as constraints: motion, loads and their work, against independent numbers."""

import math

import numpy as np
import pytest

from models.contact.ehl_contact import ContactParameters
from models.core.errors import ModelError
from models.core.quantities import Layout
from models.multibody.bodies import Body
from models.multibody.forces import ContactSpring, LubricatedCam
from models.multibody.ida import solve_ida
from models.multibody.joints import prescribed_rotation, revolute, round_cam, translational
from models.multibody.mechanism import Mechanism
from models.valve_train.cams.law import LawParameters

from .projected import solve_projected

CAM = Layout(LawParameters).defaults()
BASE, RADIUS, SPEED, MASS = float(CAM.base_radius), 0.01, 100.0, 0.2
# Roller of 10 mm, no offset: lift (mm), its first and second rate (mm/rad) and the pressure angle.
ROLLER = {
    110.0: (0.359681315, 2.690526434, 11.776555930, -4.922126708),
    150.0: (5.341391164, 10.775988731, 1.308623216, -16.566981017),
    170.0: (7.934539862, 1.440182662, -23.315352254, -2.124820398),
}


def train(degrees: float, radius: float = RADIUS, lifted: float = 0.0, guide_z: float = 0.0) -> Mechanism:
    """A roller that slides along y on a cam at that angle, turning at constant speed."""
    angle = math.radians(degrees)
    bodies = [
        Body("cam", 0.5, (1e-4,) * 3, angles=(0.0, 0.0, angle), angular_velocity=(0.0, 0.0, SPEED)),
        Body("roller", MASS, (1e-5,) * 3, (0.0, BASE + radius + lifted, guide_z)),
    ]
    joints = [
        revolute("bearing", "ground", "cam"),
        prescribed_rotation("drive", "ground", "cam", SPEED, angle),
        translational("guide", "ground", "roller", at_i=(0.0, 0.0, guide_z)),
        round_cam("contact", "cam", "roller", CAM, radius),
    ]
    return Mechanism(bodies, joints)


@pytest.mark.parametrize("degrees", ROLLER)
def test_a_roller_moves_as_the_envelope_of_its_cam(degrees, record):
    """Its load W has the component m y'' along the guide, W tan D across, and the drive's torque W y'."""
    lift, first, second, pressure_angle = ROLLER[degrees]
    mechanism = train(degrees, lifted=1e-3 * lift + 1e-4)
    begun = mechanism.start()
    found = begun.q[7] - BASE - RADIUS, begun.v[7] / SPEED, begun.a[7] / SPEED**2
    quantity = f"roller on a cam at {degrees:g} deg: lift and its rates (mm, mm/rad, mm/rad2)"
    source = "independent evaluation"
    record("Multibody", quantity, 1e3 * np.array(found), (lift, first, second), source, relative=1e-7)
    load = begun.multipliers[mechanism.find_rows("contact")][0]
    torque = begun.multipliers[mechanism.find_rows("drive")][0]
    force = MASS * 1e-3 * second * SPEED**2
    assert abs(load) == pytest.approx(abs(force) / math.cos(math.radians(pressure_angle)), rel=1e-6)
    assert torque == pytest.approx(force * 1e-3 * first, rel=1e-6)
    e = mechanism.evaluate(0.0, begun.q, begun.v)
    across, along = e.held.jacobian[mechanism.find_rows("contact"), 6:8][0]
    assert math.degrees(math.atan(abs(across / along))) == pytest.approx(abs(pressure_angle), abs=1e-7)


def test_both_methods_follow_a_roller_whose_drive_gives_its_energy():
    """The drive's power is m y' y''."""
    times = np.linspace(0.0, 2.0 * math.pi / SPEED, 181)
    one, other = (method(train(0.0), times, 1e-9) for method in (solve_ida, solve_projected))
    place = one.position("roller")[:, 1]
    np.testing.assert_allclose(place, other.position("roller")[:, 1], atol=1e-9)
    assert np.ptp(place) == pytest.approx(float(CAM.lift), rel=1e-6)
    kinetic = MASS * one.v[:, 7] * one.a[:, 7]
    np.testing.assert_allclose(one.multiplier("drive")[:, 0] * SPEED, kinetic, atol=1e-7 * np.max(kinetic))


def test_a_point_stays_on_the_curve_and_a_spring_presses_a_roller():
    """A point is at the cam's radius; a contact spring of a stiff roller has the load of the constraint."""
    point = train(0.0, radius=0.0).start()
    assert point.q[7] == pytest.approx(BASE, abs=1e-14)
    held = train(110.0, lifted=3e-4)
    begun = held.start()
    contact = held.joints[-1]
    pressed = Mechanism(
        [held.bodies[0], Body("roller", MASS, (1e-5,) * 3, (0.0, begun.q[7] - 1e-6, 0.0))],
        held.joints[:-1], [ContactSpring(contact, 1e7)],
    )  # fmt: skip
    start = pressed.start()
    cosine = math.cos(math.radians(ROLLER[110.0][3]))
    assert pressed.evaluate(0.0, start.q, start.v).load[0] == pytest.approx(10.0 * cosine, rel=1e-3)


def test_a_round_follower_has_no_film_and_no_negative_radius():
    contact, oil = train(0.0).joints[-1], Layout(ContactParameters).defaults()
    with pytest.raises(ModelError, match="contact contact: a round follower has no oil film here"):
        LubricatedCam(contact, oil)
    with pytest.raises(ModelError, match=r"joint contact: radius = -0\.01 m: must be from 0"):
        train(0.0, radius=-0.01)
