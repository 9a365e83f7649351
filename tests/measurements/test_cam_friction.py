"""Friction and films of cams and flat followers: measured losses over speed and temperature.

Quasi-static: the load of the rigid train on its cam's lift, without load on the base circle, and the
contact's steady film and friction at each angle.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from models.catalogue import CATALOGUE
from models.contact.films import FILMS
from models.contact.oil_grades import GRADES
from models.contact.oils import ZERO_CELSIUS, evaluate_oil
from models.core.quantities import Vector
from models.valve_train.cams.rises import RISES
from tests.models.systems import outputs_of

from .page import COMPUTED, MEASURED, Published

CAM, CONTACT = CATALOGUE["camshaft"](), CATALOGUE["ehl_contact"]()
BASE_RADIUS = CAM.parameters.named(CAM.parameters.vector())["base_radius"]
# Ground surfaces of 0.2 um Ra each: 0.35 um rms together.
ROUGHNESS = 0.35e-6


class Train(NamedTuple):
    """What presses the follower on its cam: mass (kg), rate (N/m), preload (N); the cam's parameters."""

    mass: float
    rate: float
    preload: float
    cam: Mapping[str, float] = {}


# As the shipped scenarios: valve on the cam; on the pointed cam of `seat-and-lash`; tappet, pushrod and
# rocker of ratio 1.25.
DIRECT = Train(0.22, 35e3, 330.0)
POINTED = DIRECT._replace(
    cam={
        "law": float(list(RISES).index("modified_trapezoid")), "rise_angle": math.radians(60.0),
        "onset_share": 0.08, "flank_share": 0.1, "reversal_share": 0.12, "nose_share": 0.7,
        "dwell_half_width": 0.0, "ramp_height": 0.3e-3,
    }
)  # fmt: skip
PUSHROD = Train(0.38, 1.25**2 * 35e3, 1.25 * 330.0)


class Cycle(NamedTuple):
    """Over the lift of the cam: angle (rad), friction torque (N m), film (m), load (N).

    `moment` is that of the load about the guide, W s' (N m); friction torque over `lever` is the coefficient.
    """

    angle: Vector
    torque: Vector
    film: Vector
    moment: Vector
    lever: Vector
    load: Vector

    @property
    def work(self) -> float:
        """Of a revolution (J)."""
        return float(np.trapezoid(self.torque, self.angle))

    @property
    def coefficient(self) -> float:
        """Friction work over load times sliding distance."""
        return self.work / float(np.trapezoid(self.lever, self.angle))


# Asperities and a fluid that no source states: harder, and Eyring's. The defaults are 1e-3 and Newton's.
HARD = {"asperity_slope": 1e-2, "eyring_stress": 5e6}


def turn_cam(
    train: Train, speed_rpm: float, celsius: float, *, heated: bool = False, others: Mapping[str, float] = {}
) -> Cycle:
    """The cycle, isothermal or with the heat of the film and of its inlet."""
    oil, speed = evaluate_oil(GRADES["SAE 10W-30"], ZERO_CELSIUS + celsius), speed_rpm * math.pi / 30.0
    parameters = {
        "load_is_given": 1.0, "film_model": float(list(FILMS).index("dowson_higginson")),
        "roughness": ROUGHNESS, "inlet_heating": float(heated), "film_heating": float(heated),
        "oil_temperature": ZERO_CELSIUS + celsius, **oil._asdict(), **others,
    }  # fmt: skip
    rows = []
    for angle in np.linspace(0.0, 2.0 * math.pi, 721):
        cam = outputs_of(CAM, train.cam, inputs={"drive_angle": float(angle), "drive_speed": speed})
        lift = cam["cam_lift"]
        if lift < 1e-6:
            continue
        acceleration = (cam["radius_of_curvature"] - BASE_RADIUS - lift) * speed**2
        inputs = {name: cam[name] for name in CONTACT.inputs.names if name in cam}
        inputs["applied_load"] = train.preload + train.rate * lift + train.mass * acceleration
        film = outputs_of(CONTACT, parameters, inputs=inputs)["steady_film_thickness"]
        found = outputs_of(CONTACT, parameters, {"film_thickness": max(film, 1e-10)}, inputs)
        arm, load = BASE_RADIUS + lift, inputs["applied_load"]
        torque, moment = found["friction_force"] * arm, load * cam["contact_offset"]
        rows.append((angle, torque, film, moment, load * arm, load))
    return Cycle(*np.array(rows).T)


def test_a_flat_lifter_loses_what_a_simulator_measured(published) -> None:
    for speed in (250.0, 1000.0):
        case = Published(
            "Friction and wear", f"loss of a flat lifter at {speed:g} cam r/min (J per revolution)",
            "shipped pushrod train (413 to 850 N), oil at 95 degC", MEASURED, 1.75, 3.9,
            "Tribological behavior of an automotive cam and flat lifter system, J. Tribology 108 (1986) 478",
        )  # fmt: skip
        why = (
            "a range over speeds, oil temperatures and eight materials of the foot; its loads are not stated"
        )
        published(case, turn_cam(PUSHROD, speed, 95.0).work, why)


def test_followers_of_engines_lose_what_their_correlation_says(published) -> None:
    """fmep = C (1 + N0/N) n_v/(S n_c), kPa and mm: work C (1 + N0/N) pi B^2/4 a follower and cycle."""
    area = math.pi * 86.0**2 / 4.0
    slow, middle, fast = (turn_cam(DIRECT, speed, 90.0).work for speed in (500.0, 1000.0, 2000.0))
    conditions = "shipped direct train, oil at 90 degC, bore of 86 mm"
    source = "Patton, Nitschke and Heywood, SAE 890836; Sandoval and Heywood, SAE 2003-01-0725"
    case = Published(
        "Friction and wear", "loss of a direct-acting follower at 2000 engine r/min (J per cycle)",
        f"{conditions}; band: C = 133 (two camshafts) and N0 = 500 to C = 200 (one) and N0 = 1000", MEASURED,
        133e-6 * (1.0 + 500.0 / 2000.0) * area, 200e-6 * (1.0 + 1000.0 / 2000.0) * area, source,
    )  # fmt: skip
    published(case, middle, "a fit to motored engines of their time, whose springs are not stated")
    low, high = (1.0 + 0.5) / (1.0 + 0.125), (1.0 + 1.0) / (1.0 + 0.25)
    quantity = "the same at 1000 over that at 4000 engine r/min"
    case = Published(
        "Friction and wear", quantity, f"{conditions}; N0 as above", MEASURED, low, high, source
    )  # fmt: skip
    why = (
        "an isothermal film drags nearly as much as the asperities whose load it takes over; see the next row"
    )
    published(case, slow / fast, why, inside=False)
    slow, fast = (turn_cam(DIRECT, speed, 90.0, heated=True).work for speed in (500.0, 2000.0))
    case = Published(
        "Friction and wear", f"{quantity}, film heated", f"{conditions}, film_heating and inlet_heating",
        MEASURED, low, high, source,
    )  # fmt: skip
    published(case, slow / fast, "the film's own heat, up to 34 K, lowers its drag more the faster it slides")


def test_friction_falls_with_speed_and_grows_with_heat_as_measured(published) -> None:
    source = "Experimental and theoretical study of engine valve train friction, J. Tribology 125 (2003) 628"
    conditions = "motored gasoline engine of one cylinder; shipped direct train"
    hot = [turn_cam(DIRECT, speed, 95.0).work for speed in (400.0, 1200.0)]
    case = Published(
        "Friction and wear", "friction at 800 over that at 2400 engine r/min, oil at 95 degC", conditions,
        MEASURED, 1.0, math.inf, source,
    )  # fmt: skip
    published(case, hot[0] / hot[1], "measured: friction falls with speed")
    cold = turn_cam(DIRECT, 1200.0, 40.0).work
    quantity = "friction at 95 over that at 40 degC, 2400 engine r/min"
    case = Published("Friction and wear", quantity, conditions, MEASURED, 1.0, math.inf, source)
    why = "measured: friction grows with the oil's temperature; here cold oil drags at its limiting stress"
    published(case, hot[1] / cold, why, inside=False)
    usual, hard = (
        [turn_cam(DIRECT, 1200.0, t, heated=True, others=others).work for t in (95.0, 40.0)]
        for others in ({}, HARD)
    )
    case = Published(
        "Friction and wear", f"{quantity}, film heated", f"{conditions}, film_heating and inlet_heating",
        MEASURED, 1.0, math.inf, source,
    )  # fmt: skip
    why = (
        "heat doesn't explain it, as it lowers both alike: asperities carry too little in hot oil, and a "
        "Newtonian film drags too much in cold oil. The source states neither; with harder asperities (rms "
        f"over radius 0.01, not 0.001) and an Eyring stress of 5 MPa it is {hard[0] / hard[1]:.2f}"
    )
    published(case, usual[0] / usual[1], why, inside=False)


def test_the_film_of_a_tappet_is_mostly_thinner_than_the_roughness(published) -> None:
    film = turn_cam(DIRECT, 1000.0, 95.0).film
    case = Published(
        "Contact and film", "share of the lift in which the film is thinner than the roughness",
        "engine, capacitive; shipped direct train at 1000 cam r/min, oil at 95 degC", MEASURED,
        0.5, 1.0, "Choi, Min and Han (1995), koreascience.or.kr, JAKO199511920198549",
    )  # fmt: skip
    published(case, np.mean(film < ROUGHNESS), "measured: mostly smaller than the surface roughness")


def test_the_coefficient_of_friction_falls_with_speed_as_measured(published) -> None:
    slow, fast = (turn_cam(PUSHROD, speed, 90.0).coefficient for speed in (500.0, 1500.0))
    case = Published(
        "Friction and wear", "coefficient of friction at 500 over that at 1500 cam r/min",
        "running engine with pushrods; shipped pushrod train, oil at 90 degC", MEASURED, 1.0, math.inf,
        "Experimental analysis of dynamics and friction in valve train systems, SAE 2002-01-0484",
    )  # fmt: skip
    published(case, slow / fast, "measured: the coefficient between cam and tappet falls with speed")


def test_the_side_load_of_a_bucket_is_greatest_where_its_bore_rubs_most(published) -> None:
    cycle = turn_cam(DIRECT, 250.0, 95.0)
    place = abs(math.degrees(cycle.angle[int(np.argmax(np.abs(cycle.moment)))]) - 180.0)
    case = Published(
        "Friction and wear", "cam angle from the nose at which the bucket is pressed most on its bore (deg)",
        "direct-acting bucket at 250 cam r/min; shipped direct train; band: 5 deg", MEASURED, 35.0, 45.0,
        "Pieprzak, Willermet and Dailey (1990), SAE 902086", 40.0,
    )  # fmt: skip
    published(case, place, "the moment W s' on the guide; the friction in the bore is not modelled")


def test_films_of_flank_and_nose_differ_as_computed_elsewhere(published) -> None:
    cycle = turn_cam(POINTED, 1500.0, 95.0)
    ratio = cycle.film / math.hypot(0.2e-6, 0.2e-6)
    nose = float(np.interp(math.pi, cycle.angle, ratio))
    for place, ours, low, high in (("flanks", ratio.max(), 4.0, 6.5), ("nose", nose, 0.2, 0.4)):
        case = Published(
            "Contact and film", f"film over composite Ra of 0.28 um: {place}",
            "shipped train seat-and-lash at 1500 cam r/min, oil at 95 degC; band: that over speeds", COMPUTED,
            low, high, "study of a cam and flat follower, text at th4.ilovetranslation.com, OhFBkYGv9OX",
        )  # fmt: skip
        published(case, ours, "a cam of that kind: fast on the flanks, slow on a pointed nose")
