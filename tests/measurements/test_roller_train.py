"""Friction of rollers and bores: measured ratios to flat followers, between pins, over the oil's temperature.

Quasi-static, as `test_cam_friction`: the pushrod train's load at each cam angle on a steady film, under a
roller that rolls. Its pin has a diameter of 8 mm, or needles on 10 mm.
"""

import math

import numpy as np
from scipy.integrate import solve_ivp

from models.catalogue import CATALOGUE
from models.contact.films.groups import Conditions
from models.contact.hertz import elastic_compliance
from models.contact.oil_grades import GRADES
from models.contact.oils import ZERO_CELSIUS, density, evaluate_oil
from models.contact.rolling import rolling_friction
from tests.models.systems import outputs_of, rates_of

from .page import MEASURED, Published
from .test_cam_friction import DIRECT, PUSHROD, turn_cam

ROLLER, LENGTH, PAD = 9e-3, 6e-3, 2.0
STEEL, OIL = elastic_compliance(207e9, 0.3, 207e9, 0.3), GRADES["SAE 10W-30"]
TAPPET, NEEDLES, PIN, GUIDE = (
    CATALOGUE[name]() for name in ("tappet", "needle_bearing", "pin_bearing", "guide_friction")
)


def roll(speed_rpm, celsius, pin):
    """Work of a revolution (J), and the mean traction (N) that turns the roller.

    `pin(rate, load, celsius)` is the torque of its pin.
    """
    oil, speed = evaluate_oil(OIL, ZERO_CELSIUS + celsius), speed_rpm * math.pi / 30.0
    lifter = {"follower": PAD, "follower_radius": ROLLER}

    def show(angle, **inputs):
        at = {"cam_angle": float(angle), "cam_speed": speed, **inputs}
        lift = outputs_of(TAPPET, lifter, inputs=at)["cam_lift"]
        return outputs_of(TAPPET, lifter, {"position": lift}, at)

    rows = []
    for angle in np.linspace(0.0, 2.0 * math.pi, 181):
        surface = show(angle)["rolling_velocity"]
        cam = show(angle, surface_speed=surface)
        if (lift := cam["cam_lift"]) < 1e-6:
            continue
        bent = show(angle + 1e-3)["cam_lift"] - 2.0 * lift + show(angle - 1e-3)["cam_lift"]
        load = PUSHROD.preload + PUSHROD.rate * lift + PUSHROD.mass * bent / 1e-6 * speed**2
        load /= math.cos(cam["pressure_angle"])
        at = (cam["entraining_velocity"], cam["radius_of_curvature"], LENGTH, STEEL)
        drag = rolling_friction(load, Conditions(*at, oil.viscosity, oil.pressure_viscosity), 0.0)
        force = pin(surface / ROLLER, load, celsius) / ROLLER
        power = drag * 2.0 * cam["entraining_velocity"] + force * surface
        rows.append((angle, power / speed, force + drag))
    angles, torques, traction = np.array(rows).T
    return float(np.trapezoid(torques, angles)), float(np.mean(traction))


def needles(rate, load, celsius):
    temperature = ZERO_CELSIUS + celsius
    oil = {"viscosity": evaluate_oil(OIL, temperature).viscosity, "density": density(OIL, temperature)}
    inputs = {"rotation_rate": rate, "load": load}
    limit = outputs_of(NEEDLES, oil, {}, inputs)["sliding_torque"]
    return outputs_of(NEEDLES, oil, {"twist": limit / 50.0}, inputs)["friction_torque"]


def plain_pin():
    """A pin with its steady torque, between loads and speeds at which it is found once."""
    found = {}

    def settle(rate, load, celsius):
        inputs = {"rotation_rate": rate, "applied_load": load}
        oil = {"viscosity": evaluate_oil(OIL, ZERO_CELSIUS + celsius).viscosity}

        def state(z):
            return dict(zip(PIN.state.names, z, strict=True))

        def move(t, z):
            return [*rates_of(PIN, oil, state(z), inputs).values()]

        run = solve_ivp(move, (0.0, 1.0), [1e-7, 1e-7, 0.0], method="LSODA", rtol=1e-6, atol=1e-12)
        return outputs_of(PIN, oil, state(run.y[:, -1]), inputs)["friction_torque"]

    def torque(rate, load, celsius):
        loads = (400.0, 700.0, 1000.0)
        if celsius not in found:
            rates = np.array([0.6, 1.0, 1.6]) * rate
            found[celsius] = rates, [[settle(r, w, celsius) for w in loads] for r in rates]
        rates, table = found[celsius]
        return float(np.interp(rate, rates, [np.interp(load, loads, row) for row in table]))

    return torque


def test_a_roller_loses_less_than_the_measured_share_of_a_flat_lifter(published):
    flat = turn_cam(PUSHROD, 1000.0, 95.0).work
    case = Published(
        "Friction and wear", "loss of a roller lifter over that of a flat one",
        "shipped pushrod train at 1000 cam r/min, oil at 95 degC, needles on 10 mm; band: the flat one's "
        "scatter, 1.75 to 3.9 J", MEASURED, 0.18 * 2.825 / 3.9, 0.18 * 2.825 / 1.75,
        "Tribological behavior of an automotive cam and flat lifter system, J. Tribology 108 (1986) 478",
        0.18,
    )  # fmt: skip
    plain = roll(1000.0, 95.0, plain_pin())[0] / flat
    why = (
        "rolling and caged needles alone, with the bearing factors of catalogues; a full complement of "
        "needles, slip, skew and the lifter's bore are in the measurement. With a plain pin it is "
        f"{plain:.2f}"
    )
    published(case, roll(1000.0, 95.0, needles)[0] / flat, why, inside=False)


def test_friction_of_a_roller_grows_with_heat_as_measured(published):
    pin = plain_pin()
    hot, cold = (roll(300.0, celsius, pin)[1] for celsius in (95.0, 55.0))
    case = Published(
        "Friction and wear", "friction of cam and roller at 95 over that at 55 degC, 300 cam r/min",
        "motored gasoline engine with rollers; shipped pushrod loads, plain pin of 8 mm", MEASURED, 1.0,
        math.inf, "Bhutta et al. (2023), Materials 16, 3431",
    )  # fmt: skip
    published(
        case,
        hot / cold,
        "measured: friction grows with the oil's temperature. Here the pin's asperities do it",
    )


def find_bore_share(speed_rpm):
    """Of bore and cam, and of a bore with the coefficient of the cam.

    The bore has a length of 25 mm, a diameter of 30 mm, and begins 2 mm off the face.
    """
    cycle = turn_cam(DIRECT, speed_rpm, 95.0)
    viscosity, speed = evaluate_oil(OIL, ZERO_CELSIUS + 95.0).viscosity, speed_rpm * math.pi / 30.0
    sizes = {"length": 25e-3, "diameter": 30e-3, "overhang": 2e-3, "viscosity": viscosity}
    torques = []
    for moment, torque, lever, load in zip(cycle.moment, cycle.torque, cycle.lever, cycle.load, strict=True):
        inputs = {"velocity": moment / load * speed, "side_moment": -moment}
        inputs["side_force"] = -torque * load / lever
        sliding = {"creep": math.copysign(1.0, moment)}
        friction = outputs_of(GUIDE, sizes, sliding, inputs)["friction_force"]
        torques.append(friction * moment / load)
    bore = float(np.trapezoid(torques, cycle.angle))
    return bore / (bore + cycle.work), bore / (bore + 0.1 / cycle.coefficient * cycle.work)


def test_a_bore_takes_more_than_the_measured_share(published):
    (share, equal), (faster, _) = (find_bore_share(speed) for speed in (250.0, 1000.0))
    source = "Pieprzak, Willermet and Dailey (1990), SAE 902086"
    case = Published(
        "Friction and wear", "share of the bore in the friction of cam, tappet and bore",
        "direct-acting bucket at 250 cam r/min; shipped direct train, bore of 25 mm; band: 2 %", MEASURED,
        0.11, 0.15, source, 0.13,
    )  # fmt: skip
    why = (
        "the bore rubs with 0.1, as asperities do, and no film forms under the bucket's edges. With the mean "
        f"coefficient of cam and tappet the share is {equal:.2f}. Measured, it falls with speed; here it is "
        f"{faster:.2f} at 1000 cam r/min"
    )
    published(case, share, why, inside=False)
