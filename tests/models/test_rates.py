"""Rates of outputs: derivatives known in closed form, other differences along the true motion, kinks."""

import math
from collections.abc import Mapping

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.contact.hertz import deflection, find_load
from models.core.component import Component
from tests.fmus.names import mark_long

from .stepped import Stepped
from .systems import DRY, outputs_of

Values = Mapping[str, float]


def rates_of(
    component: Component, parameters: Values, state: Values, inputs: Values, slopes: Values, t: float = 0.0
) -> dict[str, float]:
    """A component's rates by name."""
    made, du = Stepped(component, parameters, state, inputs), np.zeros(component.inputs.size)
    made.t = t
    for name, value in slopes.items():
        du[component.inputs.index(name)] = value
    return made.rates(du)


@pytest.mark.parametrize(("speed", "turns"), [(15.0, 0), (628.0, 1000)])
def test_camshaft(speed, turns):
    """s' = psi' ds/dpsi, and the same once more for the velocity; psi' = speed.

    Errors relative to the largest of all angles. Rounding of the angle alone, 1e-16 of 6000 rad, makes
    1e-16 6000/5e-4 = 1e-9 in the second derivative's differences after a thousand turns.
    """
    component = CATALOGUE["camshaft"]()
    found: list[tuple[float, float]] = []
    curved: list[tuple[float, float]] = []
    p = component.parameters.view(component.parameters.start.copy())
    for angle in np.linspace(-1.5, 1.5, 41) + math.pi + 2.0 * math.pi * turns:
        inputs = {"drive_angle": angle, "drive_speed": speed, "drive_acceleration": 300.0}
        y = outputs_of(component, inputs=inputs)
        rate = rates_of(component, {}, {}, inputs, {"drive_angle": speed, "drive_speed": 300.0})
        found.append((rate["surface_position"], y["surface_velocity"]))
        second = y["radius_of_curvature"] - p.base_radius - y["cam_lift"]
        curved.append((rate["surface_velocity"], second * speed**2 + y["contact_offset"] * 300.0))
        assert rate["cam_angle"] == pytest.approx(speed, rel=1e-9)
        assert rate["cam_speed"] == pytest.approx(300.0, rel=1e-9)
    for pairs in (found, curved):
        given, exact = np.array(pairs).T
        assert np.max(np.abs(given - exact)) < 1e-9 * np.max(np.abs(exact))


def hertz_rate(delta: float, relative: float, radius: float) -> float:
    """dW/dt at a constant radius: delta = W (c - ln(W)/2) a, so a unit load's deflection gives a c."""
    component = CATALOGUE["ehl_contact"]()
    p = component.parameters.view(component.parameters.start.copy())
    compliance = (1.0 - p.poissons_ratio_1**2) / p.youngs_modulus_1
    compliance += (1.0 - p.poissons_ratio_2**2) / p.youngs_modulus_2
    a = 2.0 * compliance / (math.pi * p.length)
    load = find_load(delta, radius, p.length, compliance)
    slope = deflection(1.0, radius, p.length, compliance) - 0.5 * a * (math.log(load) + 1.0)
    return relative / slope


@pytest.mark.parametrize(("position", "relative"), [(0.0, -0.1), (8e-3, 1e-3), (8e-3, 0.5)])
def test_hertz_load(position, relative):
    """Both bodies move with 1 m/s, so that the deflection is a small difference of large positions.

    Errors to expect: rounding of positions of 8 mm, 1e-18 m, over middle steps of 3e-8 s, 3e-11 m/s; and the
    remainder of the middle difference, (2^-15 T 2^-11 T)^2/120 times a fifth derivative that is less than the
    first over the fourth power of the time since the contact began, delta/relative.
    """
    component = CATALOGUE["ehl_contact"]()
    for delta in (1e-6, 5e-6, 2e-5):
        approach = position + delta
        inputs = {
            "approach": approach,
            "retreat": position,
            "approach_rate": 1.0 + relative,
            "retreat_rate": 1.0,
            "entraining_velocity": 1.0,
        }
        slopes = {"approach": 1.0 + relative, "retreat": 1.0}
        rate = rates_of(component, {**DRY, "contact_damping": 0.0}, {}, inputs, slopes)
        exact = hertz_rate(approach - position, (1.0 + relative) - 1.0, component.inputs.start[-1])
        bend = (2.0**-26 * (1e-3 * relative / delta) ** 2) ** 2 / 120.0  # T < 1e-3 s
        allowed = 1e-10 + 3e-11 / abs(relative) + bend
        assert rate["load"] == pytest.approx(exact, rel=allowed)
        assert rate["deflection"] == pytest.approx(relative, rel=allowed)


def test_kinks_are_seen_from_their_side():
    """A contact that closes with 1 m/s, 1e-6 s (1e-3 of its time T) after and before its beginning.

    The shortest difference reaches 3e-8 s; the curvature of the deflection's logarithm leaves 1e-7.
    """
    component = CATALOGUE["ehl_contact"]()
    parameters, slopes = {**DRY, "contact_damping": 0.0}, {"approach": 1.0}
    for delta in (1e-6, -1e-6):
        inputs = {"approach": delta, "approach_rate": 1.0, "entraining_velocity": 1.0}
        rate = rates_of(component, parameters, {}, inputs, slopes)
        exact = hertz_rate(delta, 1.0, component.inputs.start[-1]) if delta > 0.0 else 0.0
        assert rate["load"] == pytest.approx(exact, rel=1e-7)


# Outputs that are the derivative of others, by component.
KNOWN = {
    "valve_spring": {"position": "velocity", "velocity": "acceleration", "valve_lift": "velocity"},
    "flywheel": {"angle": "speed", "speed": "acceleration"},
    "ehl_contact": {"film_thickness": "squeeze_velocity"},
    "slider_crank": {
        "psi": "psi_rate",
        "piston_position": "piston_velocity",
        "upper_wall_impulse": "upper_wall_force",
        "lower_wall_impulse": "lower_wall_force",
    },
    "piston_crank": {
        "piston_position": "piston_velocity",
        "piston_offset": "piston_offset_rate",
        "piston_tilt": "piston_tilt_rate",
    },
}
KNOWN["free_piston_crank"] = {**KNOWN["piston_crank"], "crank_angle": "crank_speed"}
TURNING = {"crank_angle": 0.7, "crank_speed": 104.7, "crank_acceleration": 50.0}
SQUEEZED = {"approach": 2e-6, "approach_rate": 0.1, "entraining_velocity": 2.0}
SPINNING, DRIVEN = {"crank_angle": 0.7, "crank_speed": 104.7}, {"crank_drive": 5.0, "gas_pressure": 1e6}
TILTED = {"offset": 1e-5, "offset_rate": 0.02, "tilt": 1e-4, "tilt_rate": 0.3}
CASES = [
    ("valve_spring", {}, {"position": 4e-3, "velocity": 1.0, "coil_velocity[1]": 0.4}, {"load": 600.0}),
    ("flywheel", {"final_speed": 200.0, "ramp_shape": 1.0}, {}, {}),
    ("flywheel", {"motion": 0.0}, {}, {"drive_torque": 7.0, "load_torque[1]": 3.0}),
    ("ehl_contact", {}, {"film_thickness": 6e-7}, SQUEEZED),
    ("slider_crank", {}, {"psi": 1e-4, "psi_rate": 0.5}, TURNING),
    ("slider_crank", {}, {"mode": 1.0}, TURNING),
    ("slider_crank", {}, {"mode": -1.0}, {**TURNING, "crank_angle": 2.0}),
    ("piston_crank", {}, TILTED, {**TURNING, "gas_pressure": 1e6}),
    ("piston_crank", {}, {**TILTED, "closed[4]": 1.0}, {**TURNING, "gas_pressure": 1e6}),
    ("piston_crank", {}, {**TILTED, "closed[3]": 1.0, "closed[4]": 1.0}, {**TURNING, "gas_pressure": 1e6}),
    ("free_piston_crank", {}, {**TILTED, "crank_speed": 104.7}, DRIVEN),
    ("free_piston_crank", {}, {**TILTED, **SPINNING, "closed[4]": 1.0}, DRIVEN),
]


def slopes_of(inputs: Values) -> dict[str, float]:
    """Slopes that belong together: a crank's angle moves with its speed, a surface with its velocity."""
    pairs = {"crank_angle": "crank_speed", "crank_speed": "crank_acceleration", "approach": "approach_rate"}
    return {name: inputs[rate] for name, rate in pairs.items() if rate in inputs}


ALL_CASES = pytest.mark.parametrize(
    ("name", "parameters", "state", "inputs"),
    # Kernels of cranks take long to compile.
    [pytest.param(*case, id=case[0], marks=[pytest.mark.long] * ("crank" in case[0])) for case in CASES],
)


@ALL_CASES
def test_outputs_that_are_derivatives_of_others(name, parameters, state, inputs):
    """In every mode; to 1e-9 of the rate, or of the output's nominal size in a millisecond."""
    component = CATALOGUE[name]()
    given = component.parameters.named(component.parameters.start) | parameters
    y = outputs_of(component, given, state, inputs, t=0.3)
    rate = rates_of(component, given, state, inputs, slopes_of(inputs), t=0.3)
    for of, is_rate in KNOWN[name].items():
        nominal = component.outputs.field(of).quantity.nominal
        assert rate[of] == pytest.approx(y[is_rate], rel=1e-9, abs=1e-6 * nominal), of


@ALL_CASES
def test_rates_against_the_true_motion(name, parameters, state, inputs):
    """All rates, against one-sided differences of the outputs along the component's own motion.

    Third order: over a fine and a halved step they bound their own error. No event may be near.
    """
    component = CATALOGUE[name]()
    slopes = slopes_of(inputs)

    def outputs_after(h):
        made = Stepped(component, parameters, state, inputs)
        made.t = 0.3
        for key, slope in slopes.items():
            made.input(key, inputs[key], slope)
        return made.advance(h).y

    def one_sided(h):
        y = [outputs_after(k * h) for k in range(4)]
        return (-11.0 * y[0] + 18.0 * y[1] - 9.0 * y[2] + 2.0 * y[3]) / (6.0 * h)

    coarse, fine = one_sided(2e-6), one_sided(1e-6)
    found = np.array(list(rates_of(component, parameters, state, inputs, slopes, t=0.3).values()))
    size = np.abs(outputs_after(0.0)) + component.outputs.nominal
    # The integrator's tolerance (1e-10 of the size) over the step is what differences cannot resolve.
    allowed = 2.0 * np.abs(coarse - fine) + 1e-10 * size / 1e-6
    wrong = [
        n for n, ok in zip(component.outputs.names, np.abs(found - fine) <= allowed, strict=True) if not ok
    ]
    assert np.isfinite(found).all()
    assert wrong == []


@pytest.mark.parametrize("name", mark_long(CATALOGUE))
def test_discrete_outputs_stand_still(name):
    component = CATALOGUE[name]()
    rate = rates_of(component, {}, {}, dict.fromkeys(component.inputs.names, 0.1), {})
    for field in component.outputs.fields:
        assert not field.quantity.discrete or rate[field.name] == 0.0


def test_time_alone_moves_an_output():
    """A prescribed speed in its ramp, whose shaft still stands: the time of the motion is one second then."""
    flywheel = CATALOGUE["flywheel"]()
    parameters = {"initial_speed": -50.0, "final_speed": 50.0}
    rate = rates_of(flywheel, parameters, {}, {}, {}, t=0.5)
    assert rate["speed"] == pytest.approx(100.0, rel=1e-9)
