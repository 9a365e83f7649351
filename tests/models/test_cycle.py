"""Steady cycles: independent numbers over speed, the same motion waited for, and motions without a cycle."""

import math
from functools import cache

import numpy as np
import pytest

from models.catalogue import CATALOGUE
from models.core.system import Instance, System
from models.monolithic import cycle as cycle_module
from models.monolithic.compiled_march import CompiledMarch
from models.monolithic.cycle import (
    MOST_PERIODS,
    PATIENCE,
    SETTLED,
    SETTLING,
    STEADY,
    TOLERANCE,
    close_period,
    find_cycle,
    is_hopeless,
    move_by_cvode,
)
from models.monolithic.cycle_tangents import Direction, differentiate_cycle
from models.monolithic.equilibrium import equilibrium
from models.monolithic.problem import SystemProblem
from models.monolithic.reference import observe
from orchestrator.study.speeds.separation import CLOSE, _count_halvings, bisect_separation
from tests.fmus.native.bouncing_ball import bouncing_ball

from .systems import DRY, column, run, turn, valve_train, wheel

TURNING = ["flywheel.angle"]
# A dry contact of thirty times the modulus of steel, damped: nearly one without elasticity.
STIFF = {**DRY, "youngs_modulus_1": 30.0 * 207e9, "youngs_modulus_2": 30.0 * 207e9, "contact_damping": 20e3}
# Least and largest contact load (N) of the train with two coil masses and a rigid contact, by speed (r/min).
LOADS = {
    500.0: (329.983, 610.015),
    1500.0: (329.830, 610.209),
    2500.0: (253.558, 686.415),
    3000.0: (97.115, 838.523),
}


def cycle_at(speed, tolerance=TOLERANCE, **changed):
    system = valve_train(speed, **changed)
    start = equilibrium(system)
    return find_cycle(system, turn(speed), TURNING, start=start, samples=3600, tolerance=tolerance)


@cache
def stiff_cycle(speed):
    """Of a contact 30 times as stiff, whose load has 30 times the error of positions: one digit more."""
    return cycle_at(speed, tolerance=0.1 * TOLERANCE, contact=STIFF)


@pytest.mark.parametrize(
    "speed", [pytest.param(speed, marks=[pytest.mark.long] * (speed < 3000.0)) for speed in LOADS]
)
def test_loads_of_steady_cycles(speed, record):
    """The elasticity that is left shows in the least load; 1/30 of what it does with steel."""
    cycle = stiff_cycle(speed)
    assert cycle.steady
    load = cycle["contact.load"]
    found = {"least": load.min(), "largest": load.max()}
    for (which, value), expected in zip(found.items(), LOADS[speed], strict=True):
        quantity = f"direct train at {speed:g} r/min: {which} load (N)"
        record("Train", quantity, float(value), expected, "independent evaluation", tolerance=0.15)


def test_orders_of_the_load(record):
    """At 3000 r/min the tenth order is near the surge of the spring, which dies by 1/4 in a period: waiting
    takes nine periods to 1e-5, the search half."""
    cycle = stiff_cycle(3000.0)
    assert cycle.periods <= 6
    load = cycle["contact.load"][:-1]
    amplitude = 2.0 * np.abs(np.fft.rfft(load)) / load.size
    for order, expected in ((1, 44.8197), (2, 116.9976), (5, 132.5871), (10, 35.5846)):
        quantity = f"direct train at 3000 r/min: order {order} of the load (N)"
        found = float(amplitude[order])
        record("Train", quantity, found, expected, "independent evaluation", tolerance=0.05)


@pytest.mark.long
def test_loads_of_nested_springs(record):
    """Linear as long as contact is kept: the loads of both springs add, each with half of the valve, and with
    500 N more preload that keeps them in contact on their own."""
    more = 500.0
    outer = {"spring_rate": 23e3, "surge_frequency": 430.0, "preload": 220.0 + more}
    inner = {"spring_rate": 12e3, "surge_frequency": 610.0, "preload": 110.0 + more}
    cycles = [
        cycle_at(3000.0, contact=STIFF, valve_spring={"valve_mass": 0.11, **spring})
        for spring in (outer, inner)
    ]
    load = sum(cycle["contact.load"] - more for cycle in cycles)
    for which, value, expected in (("least", load.min(), 109.637), ("largest", load.max(), 832.259)):
        quantity = f"nested springs at 3000 r/min: {which} load (N)"
        record("Spring", quantity, float(value), expected, "independent evaluation", tolerance=0.15)


@pytest.mark.long
def test_the_speed_of_separation(record):
    """A rigid train with a spring without mass loses contact where W = f_p + k0 s + m s'' w^2 vanishes."""

    def separated(omega):
        cycle = cycle_at(omega * 30.0 / math.pi, contact=STIFF, valve_spring={"surge_frequency": 2e4})
        return bool(np.any(cycle["contact.load"] <= 0.0))

    low, high = (rpm * math.pi / 30.0 for rpm in (3300.0, 3500.0))
    found = bisect_separation(separated, low, high) * 30.0 / math.pi
    record("Train", "speed of separation (r/min)", found, 3392.258, "independent evaluation", tolerance=2.0)


def test_a_cycle_is_the_motion_that_one_waits_for():
    speed = 2000.0
    cycle = cycle_at(speed)
    system = valve_train(speed)
    times = np.r_[0.0, np.linspace(14.0, 15.0, 3601) * turn(speed)]
    waited = column(system, run(SystemProblem(system), equilibrium(system), times)[1:], "contact.load")
    # Both integrators are good to 1e-8 of nominal sizes, the cycle to 1e-5 of the states: 0.05 N of load.
    np.testing.assert_allclose(cycle["contact.load"], waited, atol=0.05)


def test_a_march_in_compiled_code_is_the_motion_at_all_samples():
    """Where the follower leaves its cam and lands again, too. Errors of some 500 steps add up."""
    system = valve_train(3600.0, contact=DRY)
    problem, x = SystemProblem(system, counts_energies=False), equilibrium(system)
    times, march = np.linspace(0.0, turn(3600.0), 721), CompiledMarch(problem)
    exact = move_by_cvode(problem, x, times, times, 1e-12)
    assert (column(system, observe(problem.evaluation, times, exact)[1], "contact.load") == 0.0).any()
    for tolerance in (1e-6, 1e-8):
        error = np.abs(march(problem, x, times, times, tolerance) - exact) / (problem.nominal + np.abs(exact))
        assert error.max() < 1000.0 * tolerance


def test_a_motion_with_events_is_marched_by_cvode():
    system = System({"ball": Instance(bouncing_ball(), {"restitution": 0.8, "threshold": 0.0})}, [])
    problem, times = SystemProblem(system, counts_energies=False), np.linspace(0.0, 2.0, 5)
    rows = [move(problem, system.x0, times, times, 1e-8) for move in (CompiledMarch(problem), move_by_cvode)]
    assert rows[0][-1, system.state.names.index("ball.bounces")] > 0.0
    np.testing.assert_array_equal(*rows)


def test_a_motion_that_does_not_settle_is_returned_as_such():
    """Far above separation: the follower leaves its cam in each turn, and bounces chaotically."""
    system = valve_train(3900.0)
    cycle = find_cycle(system, turn(3900.0), TURNING, start=equilibrium(system), most_periods=3)
    assert cycle.periods == 3
    assert not cycle.steady
    assert cycle.change > STEADY
    with pytest.raises(KeyError, match=r"contact\.weight"):
        cycle["contact.weight"]


@pytest.fixture
def misled(monkeypatch):
    """A search whose extrapolation multiplies the states by a factor."""
    extrapolate = cycle_module._extrapolate

    def mislead(factor):
        monkeypatch.setattr(
            cycle_module,
            "_extrapolate",
            lambda begun, ended: factor * ended[-1] if len(begun) >= SETTLED else extrapolate(begun, ended),
        )

    return mislead


def test_of_a_motion_that_does_not_settle_the_period_of_the_least_change_is_returned(misled):
    system = valve_train(3000.0)
    start = equilibrium(system)
    misled(0.9)
    found = find_cycle(system, turn(3000.0), TURNING, start, most_periods=SETTLED + 2)
    settled = find_cycle(system, turn(3000.0), TURNING, start, most_periods=SETTLED)
    assert not found.steady
    assert found.periods == SETTLED + 2
    assert found.change == settled.change
    np.testing.assert_array_equal(found.outputs, settled.outputs)


def test_where_extrapolation_leads_to_no_motion_the_search_goes_on_without(misled):
    misled(np.nan)
    assert cycle_at(1000.0).steady


def test_a_search_that_makes_no_progress_ends_early():
    """The angle of a shaft grows by the same in each turn: relative to the angle that is 1 / n after n turns,
    which PATIENCE more turns halve only in the beginning."""
    system = System({"flywheel": wheel(100.0)}, [])
    cycle = find_cycle(system, turn(100.0 * 30.0 / math.pi), [], samples=2)
    assert not cycle.steady
    assert PATIENCE + SETTLING < cycle.periods < MOST_PERIODS


@pytest.mark.parametrize(
    ("first", "rate", "hopeless"),
    [
        (1.0, 1.0, True),
        (1.0, 0.97, True),
        (1.0, 0.9, False),  # 0.9^15 = 0.21
        (2e-5, 0.97, False),  # steady after 23 periods
        (4e-5, 0.97, False),  # and after 46
        (4e-5, 0.99, True),
    ],
)
def test_a_search_ends_that_would_not_be_steady_at_its_rate(first, rate, hopeless):
    """Single periods that change more, and less at first, do not matter."""
    changes = [first * rate**n * (50.0 if n % 3 else 1.0) for n in range(PATIENCE + SETTLING + 3)]
    changes[0] *= 1e-3
    assert is_hopeless(changes) == hopeless
    assert not is_hopeless(changes[: PATIENCE + SETTLING])


def test_halvings_between_speeds():
    """Until the largest distance is CLOSE; of one speed there is none."""
    assert _count_halvings(np.array([100.0])) == 1
    assert _count_halvings(np.array([0.0, 8.0 * CLOSE, 9.0 * CLOSE])) == 3


def blown_spring(directions):
    """The tangents of a spring under the gas of a cylinder. Its motion is linear in the area of the head."""
    system = System(
        {
            "flywheel": wheel(TURNING_SPEED, motion=1.0),
            "gas": Instance(CATALOGUE["cylinder_gas"](valves=1), {"valve_area[1]": HEAD}),
            "spring": Instance(CATALOGUE["valve_spring"](coil_masses=2), SPRING),
        },
        (
            ("flywheel.angle", "gas.crank_angle"),
            ("flywheel.speed", "gas.crank_speed"),
            ("gas.valve_force[1]", "spring.gas_force"),
        ),
    )
    return differentiate_cycle(system, 4.0 * math.pi / TURNING_SPEED, TURNING, directions, system.x0)


TURNING_SPEED, HEAD = 200.0, 1e-3
SPRING = {"preload": 400.0, "spring_rate": 20e3, "damping_ratio": 0.1, "valve_mass": 0.1}


def test_tangents_of_a_cycle_know_what_adds_up():
    """The work of the gas grows in each cycle. Without its head the spring rests where nothing is left of its
    preload, 400 N over 20 N/mm.

    With all masses and forces the motion stays: what is left of its tangents is rounding, which costs no
    steps.
    """
    of_mass = {f"spring.{name}": SPRING[name] for name in ("preload", "spring_rate", "valve_mass")}
    heavier = Direction({**of_mass, "gas.valve_area[1]": HEAD})
    cycle = blown_spring([Direction({"gas.valve_area[1]": 1.0}), heavier])
    rows = cycle.rows_at(np.linspace(0.0, cycle.period, 9)[:-1])
    place = cycle.system.outputs.names.index("spring.position")
    position, (slope, none) = rows.outputs[:, place], rows.outputs_by[:, :, place]
    assert position.std() > 1e-3
    # Tangents are sought to 1e-8 of their largest.
    exact = 1e-7 * np.abs(position).max()
    assert position - HEAD * slope == pytest.approx(-0.02, abs=exact)
    assert none == pytest.approx(0.0, abs=exact)
    assert cycle.steps < 1.1 * blown_spring([]).steps


@pytest.mark.parametrize("rounding", [0.0, 1e-24])
def test_what_nothing_moves_keeps_its_start_in_the_tangents_of_a_cycle(rounding):
    """x' = (a + p - x)/T under a constant a, after a half life: x changes by p, and a by nothing."""
    half = np.array([[1.0, rounding], [0.5, 0.5]])
    right = np.array([[rounding], [0.5]])
    assert close_period(np.eye(2) - half, right).ravel() == pytest.approx([0.0, 1.0])
