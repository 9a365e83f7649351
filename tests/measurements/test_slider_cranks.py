"""Slider-cranks that others have solved: Simeon's with an elastic rod, Flores' with clearance."""

import math
from itertools import pairwise

import numpy as np

from models.multibody.bodies import Body, X
from models.multibody.forces import ElasticField, beam_stiffness
from models.multibody.ida import solve_ida
from models.multibody.joints import prescribed_rotation, revolute, support, translational
from models.multibody.mechanism import Mechanism
from tests.models.slider_cranks import FLORES, FREE, advance

from .page import COMPUTED, Published

# Simeon's data (m, kg, Pa, rad/s) and the first lateral velocity of his smooth motion (m/s).
CRANK, ROD, WIDTH, ROD_MASS, MODULUS, SPEED, SWING = 0.15, 0.3, 0.008, 0.151104, 2e11, 150.0, 0.444896105
SEGMENTS = 8
SIMEON = "Simeon (1996), Math. Modelling of Systems 2, 1; Test Set for IVP Solvers, slider crank"


def elastic_rod() -> tuple[list[Body], list[ElasticField]]:
    """Rigid segments on beams of the square section's A and I, straight along x at the start."""
    length, mass = ROD / SEGMENTS, ROD_MASS / SEGMENTS
    diameter = WIDTH * math.sqrt(16.0 / 12.0)  # of the round section with the same I/A
    share = WIDTH**2 / (math.pi * diameter**2 / 4.0)
    stiffness = beam_stiffness(length, diameter, MODULUS * share, 0.3)
    across = mass * (WIDTH**2 + length**2) / 12.0
    places = (np.arange(SEGMENTS) + 0.5) * length
    bodies = []
    for i, x in enumerate(places):
        phase = math.pi * x / ROD
        velocity = SPEED * CRANK * (1.0 - x / ROD) + SWING * math.sin(phase)
        turning = -SPEED * CRANK / ROD + SWING * math.pi / ROD * math.cos(phase)
        bodies.append(
            Body(
                f"rod {i}", mass, (mass * WIDTH**2 / 6.0, across, across), (CRANK + float(x), 0.0, 0.0),
                velocity=(0.0, velocity, 0.0), angular_velocity=(0.0, 0.0, turning),
            )
        )  # fmt: skip
    rest, damping = (length, 0.0, 0.0), 1e-6 * stiffness  # s: 0.06 % of the first bending mode
    beams = [ElasticField(a.name, b.name, stiffness, damping, rest) for a, b in pairwise(bodies)]
    return bodies, beams


def elastic_slider_crank() -> Mechanism:
    rod, beams = elastic_rod()
    half = 0.5 * ROD / SEGMENTS
    crank = Body("crank", 0.36, (1e-3,) * 3, (0.5 * CRANK, 0.0, 0.0), angular_velocity=(0.0, 0.0, SPEED))
    slider = Body("slider", 0.075552, (1e-5,) * 3, (CRANK + ROD, 0.0, 0.0))
    joints = [
        revolute("main bearing", "ground", "crank", at_j=(-0.5 * CRANK, 0.0, 0.0)),
        prescribed_rotation("drive", "ground", "crank", SPEED),
        revolute("crank pin", "crank", rod[0].name, at_i=(0.5 * CRANK, 0.0, 0.0), at_j=(-half, 0.0, 0.0)),
        translational("guide", "ground", "slider", axis_i=X, axis_j=X),
        support("wrist pin", rod[-1].name, "slider", at_i=(half, 0.0, 0.0)),
    ]
    return Mechanism([crank, *rod, slider], joints, beams)


def test_an_elastic_rod_bends_as_simeons(published) -> None:
    motion = solve_ida(elastic_slider_crank(), np.linspace(0.0, 0.1, 11), 1e-7)
    angle = SPEED * motion.times[-1]
    pin = CRANK * np.array([math.cos(angle), math.sin(angle)])
    chord = np.array([motion.position("slider")[-1, 0], 0.0]) - pin
    turned = math.atan2(chord[1], chord[0])
    normal = np.array([-math.sin(turned), math.cos(turned)])
    bent = [(motion.position(f"rod {i}")[-1, :2] - pin) @ normal for i in range(SEGMENTS)]
    modes = [
        2.0 / SEGMENTS * np.sin(n * math.pi * (np.arange(SEGMENTS) + 0.5) / SEGMENTS) @ bent for n in (1, 2)
    ]
    smooth = "rod of 8 segments, crank at 150 rad/s, smooth motion, after 0.1 s"
    agrees = "the crank turns at a given speed: the rod's elasticity moves angle and slider by 1e-5 only"
    rows = (
        ("angle of the rod (rad)", turned, -0.3311734987910881, 5e-6, agrees, True),
        ("place of the slider (m)", chord[0] + pin[0], 0.169737332671841, 5e-6, agrees, True),
        ("second bending mode (um)", 1e6 * modes[1], 23.75751865617931, 0.05 * 23.75751865617931,
         "8 segments: 4 % by the mesh", True),
        ("first bending mode (um)", 1e6 * modes[0], 189.3192460247178, 0.02 * 1573.0,
         "the source's rod lacks the stiffening by its own axial force: with that term its equations, "
         "solved independently, give 234.2", False),
    )  # fmt: skip
    for quantity, ours, value, band, why, inside in rows:
        case = Published(
            "Mechanisms", f"elastic slider-crank: {quantity}", f"{smooth}; band: {band:.2g}", COMPUTED,
            value - band, value + band, SIMEON, value, digits=7 if band < 1e-3 else 4,
        )  # fmt: skip
        published(case, ours, why, inside=inside)


def test_a_slider_with_clearance_meets_its_guide_as_flores(published) -> None:
    """The first contact, before which there is no friction."""
    p = FREE.parameters.vector(FLORES)
    start = {"crank_speed": 150.0}
    contact = advance(FREE, FREE.state.vector(start), p, 0.0, 2.71e-3)["last_impact_time"]
    before = advance(FREE, FREE.state.vector(start), p, 0.0, contact - 1e-10)
    assert before["event_count"] == 0.0
    rows = (
        ("time of the first contact (ms)", 1e3 * contact, 2.692503, 1e-6),
        ("crank angle there (deg)", math.degrees(before["crank_angle"]), 20.3574, 1e-4),
        ("crank speed there (rad/s)", before["crank_speed"], 109.55768, 2e-5),
    )
    for quantity, ours, value, digit in rows:
        case = Published(
            "Mechanisms", f"slider-crank with 1 mm of clearance: {quantity}",
            "data of the source, crank released at 150 rad/s; band: last digit of an independent solution",
            COMPUTED, value - digit, value + digit,
            "Flores, Leine and Glocker (2010), doi:10.1007/s11044-009-9178-y", value, digits=8,
        )  # fmt: skip
        published(case, ours, "the slider moves freely in its clearance until a corner touches")
