"""The judgement of Qin and Zuo 2000: its numbers beside closed forms."""

import math

import numpy as np
import pytest

from reproduction.qin2000.quantities import (
    compute_beams,
    compute_connector,
    compute_rods,
    superpose_modes,
)
from reproduction.qin2000.runs import EXHAUST, HEAD_AREA, LOW, RATED, SLOW, Runs


@pytest.fixture(scope="module")
def runs() -> Runs:
    return Runs()


def test_a_rod_of_segments_is_a_chain_of_masses(runs: Runs) -> None:
    """The fixed end is half a segment below the first mass: f/f_exact = (4 n/pi) sin(pi/(4 n))."""
    expected = [4.0 * n / math.pi * math.sin(math.pi / (4.0 * n)) - 1.0 for n in (2, 4, 8)]
    assert compute_rods(runs)["frequency_errors"] == pytest.approx(expected, rel=1e-9)


def test_two_connectors_in_series_lower_every_frequency_by_the_root_of_two(runs: Runs) -> None:
    found = compute_beams(runs)
    shares = (1.0 + np.array(found["two"])) / (1.0 + np.array(found["one"]))
    assert shares == pytest.approx(np.full(3, math.sqrt(0.5)), rel=1e-9)


def test_a_beam_of_segments_converges_with_the_square_of_their_length(runs: Runs) -> None:
    errors = np.array(compute_beams(runs)["one"])
    assert errors[:-1] / errors[1:] == pytest.approx([4.0, 4.0], rel=0.05)


def test_the_tip_bends_as_of_timoshenko(runs: Runs) -> None:
    """L^3/(3 E I) + L/(kappa G A): 100 mm of steel, 20 mm thick."""
    area, second = math.pi * 0.02**2 / 4.0, math.pi * 0.02**4 / 64.0
    expected = 0.1**3 / (3.0 * 207e9 * second) + 0.1 / (0.9 * 207e9 / 2.6 * area)
    assert compute_connector(runs)["printed_flexibility"] == pytest.approx(expected, rel=1e-9)


def test_modes_of_torsion_share_the_twist(runs: Runs) -> None:
    """Mode k of a bar that is fixed at one end has the share 8/(pi (2 k - 1))^2 of the twist at the other."""
    expected = np.cumsum([8.0 / (math.pi * (2 * k - 1)) ** 2 for k in (1, 2, 3)])
    assert superpose_modes(runs)["lowest"] == pytest.approx(expected.tolist(), rel=3e-3)


@pytest.mark.long
def test_loads_of_the_train_are_a_parabola_of_the_speed(runs: Runs) -> None:
    """As of a rigid train, but for elastic vibration."""
    slow, low, rated = (runs.cycle(speed)["cam_contact.load"] for speed in (SLOW, LOW, RATED))
    found = slow + (rated - slow) * (LOW**2 - SLOW**2) / (RATED**2 - SLOW**2)
    assert np.abs(found - low).max() < 0.005 * low.max()


@pytest.mark.long
def test_a_valve_lands_with_the_velocity_of_its_ramp(runs: Runs) -> None:
    """0.3 mm: 20 degrees with this velocity, and five before and five after with half of it on average. As it
    lands the valve still vibrates by 0.4 % of that."""
    velocity = 0.3e-3 / math.radians(25.0) * LOW * math.pi / 30.0
    exhaust = runs.gas(EXHAUST, HEAD_AREA)
    lift = exhaust["valve_spring.valve_lift"]
    landed = np.argmax(lift) + np.argmax(lift[np.argmax(lift) :] <= 0.0)
    assert -exhaust["valve_spring.velocity"][landed - 1] == pytest.approx(velocity, rel=5e-3)
