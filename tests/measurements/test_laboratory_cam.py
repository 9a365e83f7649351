"""A laboratory's cam with a bucket: its lift table, spring, mass and oil, and what its mixed solutions say.

Quasi-static: the rigid train on the lift, the contact's formulas at each angle. Speeds are those of the cam.
The source has 329 rows, 0.5 degrees apart; by every fourth the train leaves the cam at a speed 0.02 % higher.
They end at 0.013 and 0.134 mm, from where the lift falls evenly to the base circle here.
"""

import functools
import math
from collections.abc import Mapping

import numpy as np
import pytest
from scipy.optimize import brentq

from models.catalogue import CATALOGUE
from models.contact.films import FILMS
from models.valve_train.cams.smoothing import smooth_lift
from tests.models.systems import outputs_of, rates_of

from .page import COMPUTED, Published

# updated_lift.txt: 10 nm, every 2 degrees from -84 to 80.
ROWS = """
1296 3013 4965 7076 9256 11412 13478 15443 17384 19496 22109 25692 30831 38189 48448 62232 80035 102152
128633 159265 193584 230921 270460 311314 352603 393508 433329 471499 507596 541335 572539 601121 627051
650338 671007 689087 704605 717575 728006 735891 741214 743953 744079 741559 736368 728480 717883 704568
688534 669782 648315 624136 597256 567703 535543 500905 464006 425182 384904 343786 302575 262115 223300
186998 153982 124849 99970 79452 63142 50654 41429 34812 30130 26767 24216 22112 20238 18507 16929 15570
14506 13785 13405
"""
DEGREES, LIFT = np.arange(-84.0, 81.0, 2.0), 1e-8 * np.array(ROWS.split(), float)
TURN = np.radians(np.arange(-180.0, 180.0, 2.0))
BASE, MASS, RATE, PRESSED = 18.5e-3, 57.33e-3, 7130.0, 1.77e-3
CAM = CATALOGUE["camshaft"](table_points=TURN.size)
SPRING, CONTACT = CATALOGUE["valve_spring"](coil_masses=1), CATALOGUE["ehl_contact"]()
# E' = 217 GPa.
OIL_AND_SURFACES = {
    "load_is_given": 1.0, "film_model": float(list(FILMS).index("moes_venner")), "length": 7.2e-3,
    "youngs_modulus_1": 0.91 * 217e9, "youngs_modulus_2": 0.91 * 217e9, "viscosity": 13.81e-3,
    "pressure_viscosity": 16e-9, "roughness": 0.2e-6, "boundary_friction_coefficient": 0.12,
}  # fmt: skip
RPM, SPEED, NOSE, FLANK = math.pi / 30.0, 10.0 * math.pi, 0.0, -50.0
SOURCE = "github.com/asfand-234/EHL_mixed_lubrication_CAM_tappet (2025)"


@functools.cache
def smooth_cam() -> Mapping[str, float]:
    """The cam's parameters."""
    lift = np.interp(np.degrees(TURN), [-92.0, *DEGREES, 112.0], [0.0, *LIFT, 0.0])
    return {"base_radius": BASE, **smooth_lift(TURN, lift).points.parameters()}


def touch(degrees: float, speed: float = SPEED) -> dict[str, float]:
    """What the cam says of its contact there, with the load of the train."""
    turned = {"drive_angle": math.radians(degrees), "drive_speed": speed}
    cam = outputs_of(CAM, smooth_cam(), inputs=turned)
    lift, spring = cam["cam_lift"], {"valve_mass": MASS, "spring_rate": RATE, "preload": RATE * PRESSED}
    free = rates_of(SPRING, spring, {"position": lift, "coil_position[1]": 0.5 * lift})["velocity"]
    acceleration = (cam["radius_of_curvature"] - BASE - lift) * speed**2
    inputs = {name: cam[name] for name in CONTACT.inputs.names if name in cam}
    return {**inputs, "applied_load": MASS * (acceleration - free)}


def run_in(degrees: float, inputs: Mapping[str, float] = {}, **others: float) -> dict[str, float]:
    """The contact there with its steady film at 300 r/min."""
    parameters, inputs = {**OIL_AND_SURFACES, **others}, {**touch(degrees), **inputs}
    film = outputs_of(CONTACT, parameters, inputs=inputs)["steady_film_thickness"]
    return outputs_of(CONTACT, parameters, {"film_thickness": film}, inputs)


def compare(published, subject, quantity, conditions, value, band, ours, why, *, inside=True) -> None:
    """A number of this cam with one of the source, or with a band alone (`value` None)."""
    quantity = f"laboratory's cam: {quantity}"
    case = Published(subject, quantity, conditions, COMPUTED, *band, SOURCE, value, 4)
    published(case, ours, why, inside=inside)


def find_separation() -> float:
    """The lowest speed (rad/s) at which the load, which falls with its square, vanishes."""
    lowest = math.inf
    for angle in np.arange(-36.0, 36.0, 0.5):
        rest, loaded = (touch(angle, speed)["applied_load"] for speed in (0.0, SPEED))
        if loaded < rest:
            lowest = min(lowest, SPEED * math.sqrt(rest / (rest - loaded)))
    return lowest


@pytest.mark.plain
def test_a_laboratorys_cam_moves_its_bucket_as_published(published) -> None:
    train, around = "Springs and valve trains", "300 cam r/min"
    compare(
        published, train, "load at the nose (N)", f"{around}, 7130 N/m, 57.33 g; band: last digit",
        64.5, (64.45, 64.55), max(touch(a)["applied_load"] for a in np.arange(-6.0, 6.5, 0.5)),
        "the spring alone has 65.7 N, of which the nose's deceleration takes 1.2 N",
    )  # fmt: skip
    compare(
        published, train, "largest entraining velocity (m/s)", f"{around}; read from a graph, to 0.02", 1.44,
        (1.42, 1.46), max(touch(a)["entraining_velocity"] for a in np.arange(-56.0, -45.0, 0.5)),
        "(R0 + s + 2 s'') omega/2 on the opening flank",
    )  # fmt: skip
    for side, value in (("opening", -33.0), ("closing", 30.5)):
        begin, end = sorted((value - 5.0, value + 5.0))
        compare(
            published, train, f"cam angle at which entrainment reverses, {side} flank (deg)",
            f"{around}, where its friction is largest; band: its rows are 0.5 deg apart",
            value, (value - 0.5, value + 0.5), brentq(lambda a: touch(a)["entraining_velocity"], begin, end),
            "the motion draws no oil in, and asperities carry nearly all of the load",
        )  # fmt: skip
    bend = (LIFT[2:] - 2.0 * LIFT[1:-1] + LIFT[:-2]) / math.radians(2.0) ** 2
    nose = bend < 0.5 * bend.min()
    closed = math.sqrt(np.min(RATE * (LIFT[1:-1] + PRESSED)[nose] / (-MASS * bend[nose]))) / RPM
    compare(
        published, train, "cam speed at which the rigid train leaves the cam (r/min)",
        "not in the source: least sqrt(k (s + 1.77 mm)/(-m s'')) by second differences of its lifts, at "
        "-26 deg; band: 0.5 %, by which other differences change it",
        closed, (0.995 * closed, 1.005 * closed), find_separation() / RPM, "s'' of the smoothed table",
    )  # fmt: skip


@pytest.mark.plain
def test_a_laboratorys_cam_has_films_and_friction_beside_published_ones(published) -> None:
    film, friction, around = "Contact and film", "Friction and wear", "300 cam r/min, oil at 90 degC"
    nose, flank = run_in(NOSE), run_in(FLANK)
    mistaken = (
        (NOSE, {"entraining_velocity": 0.4075, "radius_of_curvature": 4.353e-3}),
        (FLANK, {"entraining_velocity": 0.3046, "radius_of_curvature": 0.1272e-3}),
    )
    theirs = [f"{1e9 * run_in(at, found)['film_thickness']:.0f} nm" for at, found in mistaken]
    compare(
        published, film, "central film at the nose (nm)",
        f"{around}; results.json; band: 25 %, by which formulas differ", 44.0, (33.0, 55.0),
        1e9 * nose["film_thickness"],
        "partly chance: the source has an entraining velocity of 0.41 m/s, of the surfaces past the tappet; "
        "past the contact, which moves, it is 0.27 m/s. With its velocity and radius the formula has "
        f"{theirs[0]}",
    )  # fmt: skip
    radius, pressure = touch(FLANK)["radius_of_curvature"], flank["maximum_pressure"]
    compare(
        published, film, "central film on the opening flank, -50 deg (nm)",
        f"{around}; results.json; band: 25 %", 1.623, (1.22, 2.03), 1e9 * flank["film_thickness"],
        "the source has a radius of 0.13 mm there, and 640 MPa. A flat follower's R0 + s + s'' is "
        f"{1e3 * radius:.1f} mm, with {1e-6 * pressure:.0f} MPa. With its values the formula has {theirs[1]}",
        inside=False,
    )  # fmt: skip
    compare(
        published, film, "largest Hertzian pressure at the nose (MPa)", f"{around}; results.json; band: 5 %",
        188.4, (179.0, 198.0), 1e-6 * nose["maximum_pressure"],
        "with its half-width b of 15.1 um the source's pressure carries pi/2 p b L = 32.2 N, half of its "
        "load, so that it is too low by the root of two, and a little by its radius",
        inside=False,
    )  # fmt: skip
    rough = run_in(NOSE, roughness=0.3e-6, asperity_slope=2e-3, roughness_parameter=0.057)
    compare(
        published, friction, "boundary friction at the nose (N)",
        f"{around}, 0.2 um rms, boundary friction 0.12; band: two tables, a week apart", None, (1.713, 4.962),
        nose["boundary_friction"],
        "the tables don't state their surfaces; with those of the later program, 0.3 um rms and rms over "
        f"radius 0.002, it is {rough['boundary_friction']:.2f}",
    )  # fmt: skip
    compare(
        published, friction, "viscous friction at the nose (N)",
        f"{around}; band: the later table, and results.json", None, (0.0195, 0.0837),
        nose["viscous_friction"],
        "ours is 0.019 of the film's load, as of rollers, that of the later table 0.0004: its program "
        "multiplies the shear stress by Patir and Cheng's shear factor of the flow. In results.json the film "
        "carries 7.6 N",
        inside=False,
    )  # fmt: skip
