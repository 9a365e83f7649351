"""Maps and bifurcation diagrams: closed form of the impact oscillator, order of work, users' mistakes."""

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pytest
from scipy.optimize import brentq

from models.compile.parallel import cores, each
from models.slider_crank.flight.bouncing import Walls
from models.slider_crank.flight.flow import Flow
from models.slider_crank.motions.bifurcation import continue_sweep, sweep_from_rest
from models.slider_crank.motions.machine import Machine, Motion
from models.slider_crank.motions.maps import exponent_map, largest_exponent

from .oscillators import FAR, impact_oscillator, impact_oscillator_orbit

XS, YS = ("damping", np.linspace(0.02, 0.25, 7)), ("gap", np.linspace(0.005, 0.02, 6))


@dataclass(frozen=True)
class ImpactOscillator(Machine):
    """x'' + x = cos(omega t), x <= 0, x' -> -r x', as a machine: psi is x, one cycle the forcing's period."""

    omega: float = 2.5
    gap: float = FAR
    restitution: float = 0.8
    xi: float = 0.0

    def find_faults(self) -> Iterator[str]:
        return iter(())

    @cached_property
    def walls(self) -> Walls:
        return impact_oscillator(self.omega, self.restitution, 0.0)[1]

    @cached_property
    def flow(self) -> Flow:
        return impact_oscillator(self.omega, self.restitution, 0.0)[0]


def closed_form(omega: float):
    return impact_oscillator_orbit(omega, 0.8, 0.0, -1.0)


@pytest.fixture(scope="module")
def doubling():
    """omega at which the orbit's period doubles: trace = -(1 + r^2)."""
    return brentq(lambda omega: closed_form(omega).trace + 1.0 + 0.8**2, 2.5, 2.8, xtol=1e-12)


def test_stable_orbits_of_the_impact_oscillator_have_their_closed_form(doubling):
    # The slowest multiplier, -1 at the doubling, is less than 0.97 here: 1e-12 after 1000 cycles.
    values = np.linspace(2.3, doubling - 0.02, 12)
    found = continue_sweep(ImpactOscillator(), "omega", values, "impact_rate", cycles=4, transient=1000)
    assert len(found.value) == 4 * len(values)
    expected = [closed_form(omega).velocity / omega for omega in found.value]
    np.testing.assert_allclose(found.recorded, expected, rtol=0.0, atol=1e-10)


def test_period_doubles_where_the_closed_form_says(doubling):
    # Beyond it the two velocities part as the root of the distance: their difference squared is a line there.
    distance = np.array([0.0005, 0.001, 0.0015])
    found = continue_sweep(
        ImpactOscillator(), "omega", doubling + distance, "impact_rate", cycles=2, transient=20_000
    )
    squares = np.diff(found.recorded.reshape(-1, 2), axis=1)[:, 0] ** 2
    onset = -np.polyval(np.polyfit(squares, distance, 2), 0.0)
    assert np.all(squares > 1e-8)
    # The error of the parabola through three points, from the line through the first two.
    assert onset == pytest.approx(0.0, abs=2e-5)


def test_exponent_of_the_impact_oscillator_has_its_closed_form():
    # Complex multipliers of determinant r^2: both exponents are ln(r^2) / 2 a cycle.
    exponent, _, impacts = largest_exponent(ImpactOscillator(omega=2.5), 4000, 1000)
    assert impacts == 1.0
    assert exponent == pytest.approx(math.log(0.8) / (2.0 * math.pi), abs=2e-4)


def test_maps_are_made_of_single_points_whatever_the_number_of_workers():
    machine = Machine(form="as_published")
    one = exponent_map(machine, XS, YS, cycles=100, transient=20, workers=1)
    three = exponent_map(machine, XS, YS, cycles=100, transient=20, workers=3)
    for a, b in zip(one, three, strict=True):
        np.testing.assert_array_equal(a, b)
    assert one.largest.shape == (6, 7)
    alone = largest_exponent(Machine(float(XS[1][2]), float(YS[1][4]), form="as_published"), 100, 20)
    assert (one.largest[4, 2], one.uncertainty[4, 2], one.impacts_per_cycle[4, 2]) == alone


def test_a_diagram_from_rest_is_made_of_single_motions():
    found = sweep_from_rest(Machine(), "gap", np.array([0.01, 0.012]), "strobe_psi", cycles=5, transient=10)
    alone = Motion(Machine(gap=0.012)).skip(10).strobe(5)[:, 0]
    np.testing.assert_array_equal(found.recorded[found.value == 0.012], alone)


def test_following_stays_between_walls_that_come_closer():
    found = continue_sweep(
        Machine(), "gap", np.linspace(0.02, 0.002, 10), "strobe_psi", cycles=10, transient=0
    )
    assert np.all(np.abs(found.recorded) <= found.value * (1.0 + 1e-12))


@pytest.mark.parametrize(
    ("x", "y", "words"),
    [
        (("dampng", [0.1]), ("gap", [0.01]), "dampng"),
        (("form", [0.1]), ("gap", [0.01]), "no parameter 'form'"),
        (("gap", [0.01]), ("gap", [0.01]), "two different"),
        (("restitution", [0.5, 1.5]), ("gap", [0.01]), "at most 1"),
    ],
)
def test_mistakes_are_named_before_any_point_is_computed(x, y, words):
    with pytest.raises(ValueError, match=words):
        exponent_map(Machine(), x, y, progress=lambda done, total: pytest.fail("computed"))


def test_each_keeps_the_order_and_tells_its_progress():
    seen = []
    found = each(lambda n: n * n, range(100), workers=4, progress=lambda *at: seen.append(at))
    assert found == [n * n for n in range(100)]
    assert seen[-1] == (100, 100)
    assert each(lambda n: n, [], workers=2) == []


@pytest.mark.parametrize(("said", "least"), [("1", 1), ("0", 1), ("100000", cores()), ("", cores())])
def test_no_more_threads_than_a_scheduler_allows(said, least, monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", said)
    assert cores() == least


def test_a_failing_point_ends_the_work():
    done = []

    def work(n):
        done.append(n)
        if n == 5:
            raise ValueError("point 5")

    with pytest.raises(ValueError, match="point 5"):
        each(work, range(100_000), workers=2)
    assert len(done) < 100_000


def test_an_interruption_ends_the_work():
    done = []

    def work(n):
        time.sleep(1e-3)
        done.append(n)

    def interrupted(count, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        each(work, range(20_000), workers=2, progress=interrupted)
    assert len(done) < 20_000
