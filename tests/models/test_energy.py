"""Energy balance: what is stored and dissipated is what was supplied, per component and as a whole."""

import numpy as np
import pytest

from models.contact.hertz import deflection, elastic_compliance, elastic_energy, find_load
from models.monolithic import equilibrium, solve

from .systems import DRY, turn, valve_train

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
        (3400, {"contact": DRY}),
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
