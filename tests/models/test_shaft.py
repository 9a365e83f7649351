"""Shafts with cams: modes against independent numbers, statics in closed form, whirl and its stability."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.catalogue import CATALOGUE
from models.valve_train.beam import (
    Bearing,
    Disc,
    Shaft,
    find_bending,
    find_torsion,
    list_parameters,
    rigid_bending,
)

from .systems import find_whirl, outputs_of, rates_of, state_matrix

pytestmark = pytest.mark.plain

EVALUATION = "independent evaluation"
PLACES = (0.03, 0.06, 0.12, 0.15, 0.21, 0.24, 0.30, 0.33)
CAMS = [Disc(place, 0.1, 1.2e-4, 0.7e-4) for place in PLACES]
SHAFT = Shaft(0.35, 0.02, CAMS, [Bearing(0.0), Bearing(0.35)])


def build(shaft, bends=True, damping_time=0.0, damping_ratio=0.0):
    """The component with this shaft's modes, and its parameters."""
    torsion = find_torsion(shaft, 3)
    bending = find_bending(shaft, 3) if bends else rigid_bending(len(shaft.discs))
    sizes = {"torsion_modes": torsion.frequency.size, "bending_modes": bending.frequency.size}
    component = CATALOGUE["shaft"](cams=len(shaft.discs), **sizes)
    return component, list_parameters(torsion, bending, damping_time, damping_ratio)


def test_modes_of_a_shaft_with_eight_cams(record):
    """Elements of a quarter of the diameter: 5e-7 of the third frequency of torsion, 7e-6 of bending."""
    torsion = find_torsion(SHAFT, 3).frequency[:3] / (2.0 * math.pi)
    bending = find_bending(SHAFT, 3).frequency[:3] / (2.0 * math.pi)
    for i, expected in enumerate((464.58727, 1370.85610, 2198.60528)):
        quantity = f"camshaft with 8 cams: frequency {i + 1} of torsion (Hz)"
        record("Train", quantity, float(torsion[i]), expected, EVALUATION, tolerance=1e-6 * expected)
    for i, expected in enumerate((234.810913, 896.319914, 1882.38922)):
        quantity = f"camshaft with 8 cams: frequency {i + 1} of bending (Hz)"
        record("Train", quantity, float(bending[i]), expected, EVALUATION, tolerance=1e-5 * expected)


@pytest.mark.parametrize(
    ("length", "frequencies"),
    [(0.4, (251.318, 996.450, 2210.33)), (0.35, (327.953561, 1296.890053, 2865.061822))],
)
def test_a_simply_supported_timoshenko_beam(length, frequencies, record):
    """A disc without mass in the middle is only a place to look at."""
    plain = Shaft(length, 0.02, [Disc(0.5 * length, 0.0, 0.0, 0.0)], [Bearing(0.0), Bearing(length)])
    found = find_bending(plain, 3).frequency / (2.0 * math.pi)
    for i, expected in enumerate(frequencies):
        quantity = f"simply supported beam of {1e3 * length:g} mm: frequency {i + 1} (Hz)"
        record("Train", quantity, float(found[i]), expected, EVALUATION, tolerance=5e-5 * expected)


def bending_matrix(component, parameters, speed):
    """d(rates)/d(states) of the bending states at this speed (rad/s)."""
    bending = [i for i, name in enumerate(component.state.names) if name.startswith("bending")]
    return state_matrix(component, parameters, {"drive_speed": speed})[np.ix_(bending, bending)]


def test_whirl_of_the_turning_shaft(record):
    """At 3000 r/min: forward and backward."""
    rates = np.linalg.eigvals(bending_matrix(*build(SHAFT), 3000.0 * math.pi / 30.0))
    found = np.sort(rates.imag[rates.imag > 0.0]) / (2.0 * math.pi)
    for value, expected in zip(found, (233.595297, 236.03231, 891.889132, 900.765712), strict=False):
        record("Train", "whirl at 3000 r/min (Hz)", float(value), expected, EVALUATION,
               tolerance=5e-6 * expected)  # fmt: skip


@pytest.mark.parametrize("speed", [-300.0, 500.0])
def test_spin_raises_whirl_in_its_own_sense_and_lowers_it_in_the_other(speed):
    """A disc at the end of a light shaft, `out` beyond the second of two bearings, under K^-1 of a beam:
    (k11 - m w^2) (k22 - I_t w^2 + I_p Omega w) = k12^2 (Den Hartog 1956, section 6.8)."""
    span, out = 0.2, 0.1
    disc = Disc(span + out, 2.0, 6e-3, 4e-3)
    light = Shaft(span + out, 0.02, [disc], [Bearing(0.0), Bearing(span)], density=0.1, shear_coefficient=1e5)
    turned = out * (2.0 * span + 3.0 * out) / 6.0
    flexibility = [[out**2 * (span + out) / 3.0, turned], [turned, (span + 3.0 * out) / 3.0]]
    k = np.linalg.inv(flexibility) * light.youngs_modulus * light.second_moment
    tilt = [-disc.transverse_inertia, disc.polar_inertia * speed, k[1, 1]]
    expected = np.roots(np.polysub(np.polymul([-disc.mass, 0.0, k[0, 0]], tilt), [k[0, 1] ** 2]))
    component, parameters = build(light)
    modes = component.structure["bending_modes"]
    found = find_whirl(bending_matrix(component, parameters, speed), 0, 2 * modes)
    # The shaft has a 1e-5 of the disc's mass; its own modes are far above.
    np.testing.assert_allclose(sorted(found, key=abs)[:4], sorted(expected.real, key=abs), rtol=1e-4)


def deflection(component, parameters, force):
    """Of the third cam (m) under this load on it, all others unloaded, from the modes at rest."""
    shape = np.array(
        [parameters[f"bending_shape[{8 * j + 3}]"] for j in range(component.structure["bending_modes"])]
    )
    mass = np.array([parameters[f"bending_mass[{j + 1}]"] for j in range(shape.size)])
    omega = np.array([2.0 * math.pi * parameters[f"bending_frequency[{j + 1}]"] for j in range(shape.size)])
    coordinates = shape * force / (mass * omega**2)
    state = {f"bending_y[{j + 1}]": float(q) for j, q in enumerate(coordinates)}
    loaded = {"cam_force_y[3]": force}
    rest = rates_of(component, parameters, state, loaded)
    assert max(abs(rest[f"bending_y_rate[{j + 1}]"]) for j in range(shape.size)) < 1e-8 * force / mass.min()
    return outputs_of(component, parameters, state, loaded)["axis_y[3]"]


def test_steady_loads_bend_the_shaft_exactly(record):
    """The static shapes are among the modes."""
    found = 1e6 * deflection(*build(SHAFT), 600.0)
    record("Train", "deflection under 600 N at the third of 8 cams (um)", found, 269.84594, EVALUATION,
           tolerance=1e-5)  # fmt: skip


def test_steady_torques_twist_the_shaft_as_a_bar():
    """psi = sum of T l/(G J), and the drive takes the sum of the torques."""
    component, parameters = build(SHAFT, bends=False)
    torques = {f"cam_torque[{i + 1}]": 0.5 + i for i in range(8)}
    n = component.structure["torsion_modes"]
    shape = np.array([[parameters[f"torsion_shape[{8 * j + i + 1}]"] for i in range(8)] for j in range(n)])
    inertia = np.array([parameters[f"torsion_inertia[{j + 1}]"] for j in range(n)])
    omega = np.array([2.0 * math.pi * parameters[f"torsion_frequency[{j + 1}]"] for j in range(n)])
    at_rest = -(shape @ np.array(list(torques.values()))) / (inertia * omega**2)
    state = {f"torsion[{j + 1}]": float(t) for j, t in enumerate(at_rest)}
    found = outputs_of(component, parameters, state, torques)
    compliance = 1.0 / (SHAFT.shear_modulus * 2.0 * SHAFT.second_moment)
    for i, place in enumerate(PLACES):
        expected = -sum(t * min(place, other) for t, other in zip(torques.values(), PLACES, strict=True))
        assert found[f"twist[{i + 1}]"] == pytest.approx(compliance * expected, rel=1e-9)
    assert found["drive_torque"] == pytest.approx(sum(torques.values()), rel=1e-9)


@settings(max_examples=25, deadline=None)
@given(st.floats(0.2, 0.95), st.floats(0.01, 0.3))
def test_damping_that_turns_drives_whirl_above_the_critical_speed(share, damping):
    """One mode: damping of the material alone is stable below Omega = w, unstable above."""
    component = CATALOGUE["shaft"]()
    parameters = {"bending_damping[1]": damping}
    critical = 2.0 * math.pi * 540.0
    for speed, stable in ((share * critical, True), (critical / share, False)):
        growth = np.max(np.linalg.eigvals(bending_matrix(component, parameters, speed)).real)
        assert (growth < 0.0) == stable


def test_a_soft_drive_lowers_the_first_frequency_to_that_of_a_rigid_shaft_on_it():
    """f = sqrt(k/J)/(2 pi) for a drive much softer than the shaft."""
    soft = Shaft(0.35, 0.02, CAMS, drive_stiffness=5.0)
    modes = find_torsion(soft, 2)
    assert modes.frequency[0] == pytest.approx(math.sqrt(5.0 / modes.inertia), rel=1e-3)


def spring_matrices(modes, stiffness):
    """Stiffness and mass of the modes with springs at the last stations."""
    shape = modes.shape[:, -len(stiffness) :]
    K = np.diag(modes.mass * modes.frequency**2) + shape @ np.diag(stiffness) @ shape.T
    return K, np.diag(modes.mass)


@pytest.mark.parametrize("bearings", [(), (Bearing(0.1),)])
def test_a_shaft_in_journals_may_move_as_a_rigid_body(bearings):
    """Frequency 0; displacements linear along the shaft, without bearings of translation and tilt."""
    modes = find_bending(Shaft(0.35, 0.02, CAMS, bearings, journals=(0.02, 0.33)), 3)
    places = np.array([*PLACES, 0.02, 0.33])
    rigid = 2 - len(bearings)
    assert np.all(modes.frequency[:rigid] == 0.0)
    assert modes.frequency[rigid] > 100.0
    for shape in modes.shape[:rigid]:
        line = np.polyfit(places, shape, 1)
        assert np.polyval(line, places) == pytest.approx(shape, abs=1e-12)
        if bearings:
            assert np.polyval(line, 0.1) == pytest.approx(0.0, abs=1e-12)


def test_rigid_modes_have_the_mass_of_the_shaft():
    """Translation has the whole mass, tilt the moment of inertia about the centre of mass."""
    free = Shaft(0.35, 0.02, CAMS, journals=(0.0, 0.35))
    modes = find_bending(free, 1)
    tube = free.density * free.area * 0.35
    total = tube + sum(disc.mass for disc in CAMS)
    centre = (tube * 0.175 + sum(disc.mass * disc.place for disc in CAMS)) / total
    about = tube * (0.35**2 / 12.0 + (0.175 - centre) ** 2) + free.density * free.second_moment * 0.35
    about += sum(disc.mass * (disc.place - centre) ** 2 + disc.transverse_inertia for disc in CAMS)
    assert modes.mass[0] == pytest.approx(total, rel=1e-9)
    reach = max(centre, 0.35 - centre)
    assert modes.mass[1] == pytest.approx(about / reach**2, rel=1e-9)


def test_frequencies_of_a_free_slender_shaft(record):
    """f = (x/L)^2 sqrt(E I/(rho A))/(2 pi), x the roots of cosh x cos x = 1."""
    slender = Shaft(0.7, 0.005, [Disc(0.35, 0.0, 0.0, 0.0)], journals=(0.0, 0.7))
    found = find_bending(slender, 3).frequency[2:5] / (2.0 * math.pi)
    wave = math.sqrt(slender.youngs_modulus * slender.second_moment / (slender.density * slender.area))
    for i, x in enumerate((4.730040745, 7.853204624, 10.995607838)):
        expected = (x / 0.7) ** 2 * wave / (2.0 * math.pi)
        quantity = f"free slender shaft of 0.7 m: frequency {i + 1} (Hz)"
        record("Train", quantity, float(found[i]), expected, "Bernoulli's beam", relative=1e-3)


def test_springs_at_journals_are_elastic_bearings(record):
    """Springs outside at the journals, or bearings inside: one shaft. Steady loads bend both exactly."""
    stiffness = (2e7, 5e7)
    inside = find_bending(
        Shaft(0.35, 0.02, CAMS, [Bearing(p, k) for p, k in zip((0.0, 0.35), stiffness, strict=True)]), 3
    )
    outside = find_bending(Shaft(0.35, 0.02, CAMS, journals=(0.0, 0.35)), 3)
    K, M = spring_matrices(outside, stiffness)
    force = 600.0 * outside.shape[:, 2]
    found = float(outside.shape[:, 2] @ np.linalg.solve(K, force))
    expected = float(600.0 * np.sum(inside.shape[:, 2] ** 2 / (inside.mass * inside.frequency**2)))
    source = "bearings inside the modes"
    quantity = "shaft on springs at its journals"
    record("Train", f"{quantity}: deflection under 600 N (um)", 1e6 * found, 1e6 * expected, source,
           relative=1e-9)  # fmt: skip
    squares = np.sort(np.linalg.eigvals(np.linalg.solve(M, K)).real)
    record("Train", f"{quantity}: lowest frequency (Hz)", math.sqrt(squares[0]) / (2.0 * math.pi),
           float(inside.frequency[0]) / (2.0 * math.pi), source, relative=1e-5)  # fmt: skip


def test_a_shaft_that_bends_needs_two_bearings():
    with pytest.raises(ValueError, match="at least two"):
        find_bending(Shaft(0.35, 0.02, CAMS, [Bearing(0.0)]), 3)


def test_an_acceleration_of_the_drive_twists_the_shaft_by_the_discs_inertia():
    """A light shaft lags by sum of J_j min(z_i, z_j)/(G J) alpha, and takes sum of J_j alpha."""
    light = Shaft(0.35, 0.02, CAMS, density=0.1)
    component, parameters = build(light, bends=False)
    turning, n = {"drive_acceleration": 5e3}, component.structure["torsion_modes"]
    start = rates_of(component, parameters, {}, turning)
    bent = {
        f"torsion[{j}]": start[f"torsion_rate[{j}]"]
        / (2.0 * math.pi * parameters[f"torsion_frequency[{j}]"]) ** 2
        for j in range(1, n + 1)
    }
    found = outputs_of(component, parameters, bent, turning)
    compliance = 1.0 / (light.shear_modulus * 2.0 * light.second_moment)
    for i, place in enumerate(PLACES):
        lag = compliance * 5e3 * sum(disc.polar_inertia * min(place, disc.place) for disc in CAMS)
        # The shaft has 1e-6 of the discs' inertia.
        assert found[f"twist[{i + 1}]"] == pytest.approx(-lag, rel=1e-4)
    assert found["drive_torque"] == pytest.approx(5e3 * sum(disc.polar_inertia for disc in CAMS), rel=1e-4)
