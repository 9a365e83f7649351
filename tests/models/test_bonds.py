"""Energies: counted inside steps and balanced over systems; closed forms, closure, an undisturbed motion."""

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.contact.hertz import deflection, elastic_compliance, elastic_energy, find_load
from models.core.bonds import counting, energy_through
from models.monolithic import equilibrium, solve

from .stepped import Stepped
from .systems import DRY as DRY_CONTACT
from .systems import turn, valve_train

COMPONENTS = sorted(CATALOGUE)
# Of all others the kernels would be compiled for this test alone.
ALWAYS = ("flywheel", "coupled_mass", "valve_spring", "ehl_contact")
DRY = CATALOGUE["ehl_contact"]().parameters.field("film_model").quantity.choices.index("dry")


def made(name, **settings):
    return Stepped(CATALOGUE[name](energies=1), **settings)


@pytest.mark.parametrize(
    "name", [n if n in ALWAYS else pytest.param(n, marks=pytest.mark.long) for n in COMPONENTS]
)
def test_the_motion_does_not_see_that_energies_are_counted(name):
    plain, counts = Stepped(CATALOGUE[name]()), made(name)
    n, m = plain.component.state.size, plain.component.outputs.size
    for unit in (plain, counts):
        for k, row in enumerate((0.02, 1.0, 30.0)):
            unit.U[k] = row * unit.component.inputs.nominal
        for _ in range(5):
            unit.advance(3e-4)
    np.testing.assert_array_equal(counts.x[:n], plain.x)
    np.testing.assert_array_equal(counts.y[:m], plain.y)


def test_a_torque_on_a_free_rotor_gives_its_work():
    """E = T (w0 t + T t^2 / 2 I), the work of a constant torque; the bond counts what comes in."""
    inertia, speed, torque, duration = 0.2, 30.0, 7.0, 1.5
    unit = made("flywheel", parameters={"inertia": inertia, "motion": 0.0}, start={"speed": speed})
    assert unit.component.parameters.field("motion").quantity.choices[0] == "free"
    unit.input("load_torque[1]", torque)
    for _ in range(3):
        unit.advance(duration / 3)
    work = torque * (speed * duration - torque * duration**2 / (2.0 * inertia))
    assert unit["energy_by_load_torque_1_speed"] == pytest.approx(-work, rel=1e-14)
    assert unit["energy_gained"] == pytest.approx(-work, rel=1e-14)


def test_what_a_valve_spring_gains_and_loses_came_in_through_its_load():
    unit = made("valve_spring", parameters={"damping_ratio": 0.1})
    for n in range(40):
        load = 330.0 + 400.0 * np.sin(0.3 * n)
        unit.input("load", load, 1e6, -1e9)
        unit.advance(2e-4)
    received = unit["energy_by_load_velocity"]
    assert unit["energy_dissipated"] > 0.01
    # 1e-10 per integration step of energies about 1 J, some hundred steps.
    assert unit["energy_gained"] + unit["energy_dissipated"] == pytest.approx(received, abs=1e-8)
    # Its stored energy does not see the load, so that no jump of the load changes it.
    start = made("valve_spring").advance(0.0)
    assert unit["energy_stored"] - start["energy_stored"] == pytest.approx(unit["energy_gained"], abs=1e-13)


def test_inputs_that_jump_between_steps_change_stored_energy_beyond_what_steps_gain():
    """A dry contact under held deflections stores the closed form of its energy, and gains nothing."""
    compliance, radius, length = elastic_compliance(207e9, 0.3, 207e9, 0.3), 0.02, 12e-3
    unit = made("ehl_contact", parameters={"film_model": DRY, "length": length})
    for name, value in (("youngs_modulus", 207e9), ("poissons_ratio", 0.3)):
        for body in (1, 2):
            assert unit.component.parameters.field(f"{name}_{body}").start == value
    unit.input("radius_of_curvature", radius)
    for approach in (2e-6, 9e-6):
        unit.input("approach", approach)
        unit.advance(1e-3)
    load = find_load(9e-6, radius, length, compliance)
    assert unit["energy_stored"] == pytest.approx(elastic_energy(load, radius, length, compliance), rel=1e-12)
    assert unit["energy_gained"] == 0.0


def test_energies_through_bonds_are_found_with_sixth_order():
    """A dry contact gains what its two surfaces do on it; Lobatto's four points leave O(h^6) of the sum."""

    def left(steps):
        unit = made("ehl_contact", parameters={"film_model": DRY})
        unit.input("radius_of_curvature", 0.02)
        h = 1e-4 / steps
        for n in range(steps):
            t = n * h
            unit.input("approach", 5e-6 + 0.1 * t - 200.0 * t**2, 0.1 - 400.0 * t, -400.0)
            unit.input("approach_rate", 0.1 - 400.0 * t, -400.0)
            unit.input("retreat", 0.02 * t, 0.02)
            unit.input("retreat_rate", 0.02)
            unit.advance(h)
        came = unit["energy_by_load_approach_rate"] + unit["energy_by_load_retreat_rate"]
        assert came > 1e-3
        return abs(unit["energy_gained"] + unit["energy_dissipated"] - came)

    assert np.log2(left(2) / left(4)) == pytest.approx(6.0, abs=0.7)


@pytest.mark.parametrize(
    ("form", "steps"),
    [
        pytest.param(1.0, 40, marks=pytest.mark.plain),
        pytest.param(1.0, 200, marks=pytest.mark.long),
        pytest.param(2.0, 200, marks=pytest.mark.long),
    ],
)
def test_exact_flights_and_slides_of_the_slider_crank_close(form, steps):
    """Kinetic energy = what the crank's torque and impulses gave - what friction and impacts took."""
    settings = {
        "parameters": {"form": form, "restitution": 0.4, "joint_friction": 0.05},
        "inputs": {"crank_speed": 200.0},
    }
    unit = made("slider_crank", **settings)
    for n in range(steps):
        unit.input("crank_angle", 200.0 * 5e-4 * n, 200.0)
        unit.advance(5e-4)
    assert unit["impact_count"] > steps // 40
    assert unit["energy_dissipated"] > 0.0
    size = np.abs(unit["energy_gained"]) + np.abs(unit["energy_dissipated"])
    closure = unit["energy_gained"] + unit["energy_dissipated"] - unit["energy_sourced"]
    # Rounding of impacts' energies over some hundred events.
    by_impulses = 200.0 * unit["crank_impact_impulse"]
    assert closure == pytest.approx(unit["energy_by_crank_torque_crank_speed"] + by_impulses, abs=1e-9 * size)
    assert unit.x[unit.component.state.index("impact_work")] == pytest.approx(by_impulses, abs=1e-9 * size)


def test_a_step_of_no_length_counts_nothing():
    unit = made("valve_spring").advance(0.0)
    assert not unit.x[unit.component.plain.state.size :].any()


def test_every_bond_has_its_own_variable():
    for make in CATALOGUE.values():
        component = make()
        names = [energy_through(bond) for bond in component.bonds]
        assert len(set(names)) == len(names)
        assert set(names) <= set(counting(component).outputs.names)


COMPLIANCE = elastic_compliance(207e9, 0.3, 207e9, 0.3)
LENGTH = 12e-3
SEAT = {"seat_stiffness": 1e7, "seat_damping": 200.0}


def work_of_the_radius(found):
    """Integral of (dE/dR at constant deflection) dR along the solution: the changing cam under the load."""
    delta = found["contact.deflection"]
    radius = found["camshaft.radius_of_curvature"]

    def energy(d, r):
        return elastic_energy(find_load(d, r, LENGTH, COMPLIANCE), r, LENGTH, COMPLIANCE)

    step = 1e-5
    slope = np.array(
        [(energy(d, r + step) - energy(d, r - step)) / (2 * step) for d, r in zip(delta, radius, strict=True)]
    )
    return np.concatenate([[0.0], np.cumsum(0.5 * (slope[1:] + slope[:-1]) * np.diff(radius))])


@pytest.mark.parametrize(
    ("speed_rpm", "parts"),
    [
        pytest.param(1000, {}, marks=pytest.mark.long),
        (3400, {"contact": DRY_CONTACT}),
        (1000, {"camshaft": {"flexible": 1.0}, "valve_spring": SEAT}),
    ],
)
def test_every_component_and_the_whole_balance(speed_rpm, parts, record):
    system = valve_train(speed_rpm, **parts)
    times = np.linspace(0.0, 0.8, 5761) * turn(speed_rpm)
    found = solve(system, times, x0=equilibrium(system), tolerance=1e-8)
    # 1e-10 per step and joule over some thousand steps, of energies up to 4 J.
    source = "stored + dissipated - supplied"
    for name in ("flywheel", "camshaft", "valve_spring"):
        quantity, residual = f"energy residual of the {name} (J)", found.energy[name].residual
        record("Coupling", quantity, residual, 0.0, source, tolerance=1e-7)
    # Trapezoids at 5760 instants: up to 1e-8 J in impacts, falling as 1/n^2 with more instants.
    left_out = work_of_the_radius(found)
    assert np.max(np.abs(left_out)) > 1e-5
    quantity, residual = "energy residual of the contact (J)", found.energy["contact"].residual
    record("Coupling", quantity, residual, left_out, "work of the changing radius", tolerance=2e-8)
    whole = found.stored_energy - found.stored_energy[0] + found.dissipated - found.supplied
    assert np.max(np.abs(whole - left_out)) < 1e-7
    # Power crosses connected bonds without loss.
    assert np.max(np.abs(sum(energy.received for energy in found.energy.values()))) < 1e-8
    for name, energy in found.energy.items():
        # Damping never gives energy; a tolerance of 1e-10 per step.
        assert np.min(np.diff(energy.dissipated)) > -1e-9, name


def test_elastic_energy_is_finite_and_zero_without_load():
    assert elastic_energy(0.0, 0.02, LENGTH, COMPLIANCE) == 0.0
    assert deflection(0.0, 0.02, LENGTH, COMPLIANCE) == 0.0
