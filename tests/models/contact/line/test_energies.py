"""The contact's account of its energies: it closes, with the order of steps and of nodes; limits of it."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.contact.asperities import Asperities, mean_gap, pressure_scale
from models.contact.fluid import Lubricant, density_ratio, density_slope, enthalpy
from models.contact.hertz import elastic_compliance, elastic_energy
from models.contact.line.energies import asperities_at, oil_energy
from models.contact.line.mixed import Bodies
from models.core.quantities import Vector

from ...stepped import Stepped

STEEL = elastic_compliance(207e9, 0.3, 207e9, 0.3)
STORED, GAINED, DISSIPATED, SOURCED = (
    f"energy_{name}" for name in ("stored", "gained", "dissipated", "sourced")
)
BONDS = ("energy_by_load_approach_rate", "energy_by_load_retreat_rate")
RUNNING = {"entraining_velocity": 1.5, "sliding_velocity": 2.0, "radius_of_curvature": 0.02}
FREQUENCY, STOP, COARSEST = 2000.0, 6e-4, 2e-5
LOAD_IS_GIVEN = [
    pytest.param(False, marks=pytest.mark.long, id="approach given"),
    pytest.param(True, id="load given"),
]


def counting(nodes: int = 101, energies: int = 1, **parameters: float) -> Stepped:
    """A solved film of smooth surfaces whose steps are not cut."""
    component = CATALOGUE["ehl_line_contact"](nodes=nodes, energies=energies)
    chosen = {"field_tolerance": 0.1, "roughness": 0.0, **parameters}
    return Stepped(component, parameters=chosen, inputs=RUNNING)


def swing(unit: Stepped, name: str, mean: float, size: float) -> None:
    """The Taylor coefficients of mean + size sin(w t), and of its rate."""
    w, t = 2.0 * np.pi * FREQUENCY, unit.t
    s, c = np.sin(w * t), np.cos(w * t)
    course = (mean + size * s, size * w * c, -size * w**2 * s, -size * w**3 * c)
    unit.input(name, *course)
    if name == "approach":
        unit.input("approach_rate", *course[1:])


def drive(unit: Stepped, load_is_given: bool) -> None:
    """A contact that swings over a radius which grows."""
    unit.input("radius_of_curvature", 0.02 + 5.0 * unit.t, 5.0)
    if load_is_given:
        swing(unit, "applied_load", 800.0, 300.0)
    else:
        swing(unit, "approach", 5e-6, 2e-6)


def powers(unit: Stepped) -> tuple[float, float, float]:
    """What is stored (J); what is lost; and what sources and bonds give (W)."""
    e, u = np.zeros(3), unit.component.inputs.named(unit.u)
    unit.component.flat_energy(unit.t, unit.x, unit.u, unit.p, e)
    return e[0], e[1], e[2] + unit["load"] * (u["approach_rate"] - u["retreat_rate"])


def left_over(unit: Stepped) -> float:
    """Gained and dissipated, less what sources and bonds gave (J)."""
    return unit[GAINED] + unit[DISSIPATED] - unit[SOURCED] - sum(unit[bond] for bond in BONDS)


@cache
def courses(nodes: int, h: float, load_is_given: bool) -> tuple[Vector, Vector]:
    """What is left over and what is stored, at times that all steps share, as of a third of the run: the
    beginning, with pressure and film that do not belong together, is over then."""
    unit = counting(nodes, load_is_given=float(load_is_given))
    found = []
    for k in range(round(STOP / h)):
        unit.t = k * h
        drive(unit, load_is_given)
        unit.advance(h)
        if (k + 1) % round(COARSEST / h) == 0:
            found.append((left_over(unit), unit[STORED]))
    third = len(found) // 3
    left, stored = np.array(found[third:]).T
    return left - left[0], stored


@pytest.mark.parametrize("pressure", [1e6, 1e9])
def test_oil_stores_the_work_of_its_compression(pressure: float) -> None:
    """de = p/rho^2 drho and dH = dp/rho, by central differences of 1e-3 p."""
    fluid = Lubricant(0.036, 1.8e-8)
    step = 1e-3 * pressure
    above, below = pressure + step, pressure - step
    rho, slope = density_ratio(pressure, fluid), density_slope(pressure, fluid)
    by_enthalpy = (enthalpy(above, fluid) - enthalpy(below, fluid)) / (2.0 * step)
    assert by_enthalpy == pytest.approx(1.0 / rho, rel=1e-6)
    energies = [oil_energy(p, 1.0, fluid) / density_ratio(p, fluid) for p in (above, below)]
    assert (energies[0] - energies[1]) / (2.0 * step) == pytest.approx(pressure * slope / rho**2, rel=1e-5)


@pytest.mark.parametrize("separation", [-0.5, 3.0])
def test_asperities_store_the_work_of_their_pressure(separation: float) -> None:
    """-dV/dd = p_a over the gap d of the mean planes, by central differences of 0.02 sigma (1e-4 of second
    order); the energy is a difference of what is interpolated to 2e-8 and 1e-7."""
    sigma, step = 0.2e-6, 0.01
    bodies = Bodies(STEEL, 12e-3, sigma, pressure_scale(Asperities(sigma, 0.05, 1e-3), STEEL))
    low, here, high = (
        asperities_at(sigma * mean_gap(separation + change), bodies) for change in (-step, 0.0, step)
    )
    assert here.gap == pytest.approx(sigma * separation, rel=1e-9)
    assert (low.energy - high.energy) / (2.0 * step * sigma) == pytest.approx(here.pressure, rel=1e-3)


@pytest.mark.parametrize(
    ("load_is_given", "tolerance"),
    [pytest.param(False, 1e-3, id="approach"), pytest.param(True, 0.02, id="load")],
)
def test_what_is_stored_changes_by_the_powers(load_is_given: bool, tolerance: float) -> None:
    """By the trapezoidal rule. What 101 nodes leave is 5e-4; where the load is given, the approach has the
    rate of the step before, an error of first order (measured 0.030, 0.016, 0.009 as steps are halved)."""
    unit, h = counting(101, energies=0, load_is_given=float(load_is_given)), STOP / 120
    rows = []
    for _ in range(120):
        drive(unit, load_is_given)
        unit.advance(h)
        rows.append(powers(unit))
    stored, lost, given = np.array(rows[40:]).T
    net = h * np.cumsum(0.5 * (given - lost)[1:] + 0.5 * (given - lost)[:-1])
    np.testing.assert_allclose(stored[1:] - stored[0], net, rtol=0.0, atol=tolerance * np.ptp(stored))


@pytest.fixture(scope="module")
def pressed() -> Stepped:
    """A contact in its steady film."""
    unit = counting(101, field_tolerance=1e-4)
    unit.input("approach", 5e-6)
    for _ in range(150):
        unit.advance(2e-5)
    return unit


def test_a_steady_film_loses_what_it_is_given(pressed: Stepped) -> None:
    """As exactly as Newton's method balances its volumes; what slides loses its friction, the rest rolls. A
    jump of the approach stores its work, in the bodies."""
    stored, lost, given = powers(pressed)
    assert lost == pytest.approx(given, rel=1e-6)
    assert 1.0 < lost / (pressed["friction_force"] * RUNNING["sliding_velocity"]) < 1.2
    before, jump = pressed.u.copy(), 1e-9
    pressed.u[pressed.component.inputs.index("approach")] += jump
    assert powers(pressed)[0] - stored == pytest.approx(pressed["load"] * jump, rel=1e-6)
    pressed.u[:] = before


@pytest.mark.parametrize("load_is_given", LOAD_IS_GIVEN)
def test_the_account_closes_with_the_order_of_the_steps(load_is_given: bool, record) -> None:
    """What is left over differs from step to half the step by a quarter each time (measured 0.24, 0.25)."""
    lefts = [courses(51, COARSEST / 2**k, load_is_given)[0] for k in range(4)]
    changes = [np.max(np.abs(fine - coarse)) for coarse, fine in pairwise(lefts)]
    orders = [np.log2(coarse / fine) for coarse, fine in pairwise(changes)]
    quantity = "order with which the energies of the solved film close"
    record("Field", quantity, orders, 2.0, "second-order steps", tolerance=0.3)


@pytest.mark.parametrize("load_is_given", LOAD_IS_GIVEN)
def test_the_account_closes_better_with_more_nodes(load_is_given: bool) -> None:
    """The deflection's matrix is symmetric only in the limit (measured 3.5e-4 and 2.4e-3 here)."""
    coarse, fine = (courses(nodes, 5e-6, load_is_given) for nodes in (51, 101))
    assert np.max(np.abs(fine[0])) < 0.6 * np.max(np.abs(coarse[0]))
    assert np.max(np.abs(fine[0])) < 3e-3 * np.ptp(fine[1])


def test_what_is_stored_is_about_that_of_a_dry_contact(pressed: Stepped) -> None:
    """Hertz's under the same load: a film spreads the pressure, which stores less, and oil is compressed."""
    dry = elastic_energy(pressed["load"], RUNNING["radius_of_curvature"], 12e-3, STEEL)
    assert pressed[STORED] == pytest.approx(dry, rel=0.02)


def test_an_opening_contact_returns_what_was_stored(pressed: Stepped) -> None:
    """Parted so fast that little oil flows: the bond takes what bodies and oil stored but for a few percent,
    and no energy comes of it."""
    unit = counting(101, field_tolerance=1e-4)
    unit.x[:], unit.t = pressed.x, pressed.t
    stored, received, dissipated = pressed[STORED], pressed[BONDS[0]], pressed[DISSIPATED]
    duration, way, steps = 2e-5, 3e-5, 40
    unit.input("entraining_velocity", 0.0)
    unit.input("sliding_velocity", 0.0)
    unit.input("approach_rate", -way / duration)
    for k in range(steps):
        unit.input("approach", 5e-6 - way * k / steps, -way / duration)
        unit.advance(duration / steps)
    assert unit["load"] < 1.0
    assert unit[STORED] < 1e-3 * stored
    returned = received - unit[BONDS[0]]
    assert 0.85 * stored < returned < 1.001 * stored
    assert returned + unit[DISSIPATED] - dissipated == pytest.approx(stored, rel=0.01)


@pytest.mark.long
def test_the_motion_of_a_field_does_not_see_that_energies_are_counted() -> None:
    """Nor do the rates of outputs; that of the stored energy is what it changes by."""
    plain, counts = counting(energies=0), counting()
    n = plain.component.state.size
    rates = []
    for unit in (plain, counts):
        for _ in range(12):
            swing(unit, "approach", 5e-6, 2e-6)
            unit.advance(5e-6)
        du = np.zeros(unit.component.inputs.size)
        unit.component.input_rates(unit.U, 5e-6, du)
        rates.append(unit.rates(du))
    np.testing.assert_array_equal(counts.x[:n], plain.x)
    assert {name: rates[1][name] for name in rates[0]} == rates[0]
    stored = counts[STORED]
    swing(counts, "approach", 5e-6, 2e-6)
    counts.advance(1e-7)
    assert rates[1][STORED] == pytest.approx((counts[STORED] - stored) / 1e-7, rel=0.02)
