"""Impact profiles, spectra and wear (F 3.2, 3.3): sums, bins, bounds of the entropy."""

import math
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.slider_crank.forms import kinetic_energy, wall_angle
from models.slider_crank.motions.histories import BOUNCE, ONSET
from models.slider_crank.motions.machine import FORMS, Events, Machine, Motion
from models.slider_crank.motions.portrait import rates_after
from models.slider_crank.motions.statistics import (
    approach_velocities,
    effective_bins,
    energies,
    energy_profile,
    impact_profile,
    impact_spectrum,
    sampling_bias,
    uniformity,
    wall_position,
)

XI = 0.303


@cache
def motion_impacts(form: str = "as_published", damping: float = 0.05) -> tuple[Machine, Events]:
    machine = Machine(damping, 0.01, form=form)
    return machine, Motion(machine).skip(50).events(300).impacts


@pytest.mark.parametrize("kind", ["profile", "spectrum", "energy"])
def test_bins_add_up_to_all_impacts(kind):
    """(3.6), (3.7): a wall's bins, however fine, sum to psi' (or energy) of its impacts over N."""
    machine, impacts = motion_impacts()
    n = impacts.theta.size
    weights = energies(machine, impacts) if kind == "energy" else impacts.rate

    def distribute(bins):
        if kind == "energy":
            return energy_profile(machine, impacts, bins, n)
        if kind == "profile":
            return impact_profile(impacts, impacts.rate, XI, bins, n)
        return impact_spectrum(impacts, impacts.rate, bins, n)

    fine = distribute(100)
    for bins in (1, 20):
        found = distribute(bins)
        for wall, side in (("upper", 1.0), ("lower", -1.0)):
            sums = getattr(found, wall)
            assert sums.sum() == pytest.approx(weights[impacts.side == side].sum() / n, rel=1e-12)
            within = getattr(fine, wall).reshape(bins, -1).sum(axis=1)
            np.testing.assert_allclose(within, sums, atol=1e-13)


def test_profile_has_the_same_impacts_as_the_spectrum():
    """theta and -theta are one place on the wall: folded, bins between the same places hold the same sums."""
    _, impacts = motion_impacts()
    places = wall_position(np.linspace(0.0, math.pi, 9), XI)
    spectrum = impact_spectrum(impacts, impacts.rate, 16, 1.0)
    folded = spectrum.upper[:8] + spectrum.upper[:7:-1]
    x = wall_position(impacts.theta, XI)
    upper = impacts.side > 0.0
    for i in range(8):
        between = upper & (x <= places[i]) & (x > places[i + 1])
        assert impacts.rate[between].sum() == pytest.approx(folded[i], abs=1e-13)


def test_an_impact_at_a_dead_centre_is_counted():
    """x = 1 + xi at theta = 0, 1 - xi at theta = pi; rounding may put it beyond the wall's end."""
    ends = np.array([0.0, np.nextafter(2.0 * math.pi, 0.0), math.pi])
    np.testing.assert_allclose(wall_position(ends, XI), [1.0 + XI, 1.0 + XI, 1.0 - XI], rtol=1e-15)
    one = np.ones(3)
    impacts = Events(one, ends, one, one, one, BOUNCE * one)
    assert impact_profile(impacts, one, XI, 10, 1.0).upper.sum() == 3.0


@pytest.mark.parametrize("form", FORMS)
def test_energy_taken_is_the_kinetic_energy_lost(form):
    """The rod's kinetic energy before less after, less the work that crank and moving wall frame do:
    momentum jump times the wall's rate. The quadratic part in psi' is exact in all forms."""
    machine, impacts = motion_impacts(form)
    index, m = machine.form_code, machine.mechanism
    taken = energies(machine, impacts)
    after = rates_after(machine, impacts)
    # Upwards, and towards the wall.
    np.testing.assert_array_equal(np.sign(approach_velocities(impacts)), impacts.side)
    for i in range(0, 40):
        theta = impacts.theta[i]
        psi = wall_angle(index, theta, impacts.side[i] * machine.gap, m)
        resting = (after[i] + machine.restitution * impacts.rate[i]) / (1.0 + machine.restitution)
        energy = lambda rate: kinetic_energy(index, theta, 1.0, psi, rate, m)  # noqa: B023, E731
        slope = 0.5 * (energy(resting + 1.0) - energy(resting - 1.0))
        lost = energy(impacts.rate[i]) - energy(after[i]) - slope * (impacts.rate[i] - after[i])
        assert taken[i] == pytest.approx(lost, rel=1e-9, abs=1e-15)


def test_energy_of_the_last_impact_before_sliding_is_all_taken():
    """F's threshold stops a rebound of 0.005; what it would have kept is gone too."""
    machine = Machine(0.25, 0.015, form="as_published", sliding_threshold=0.005)
    impacts = Motion(machine).skip(20).events(20).impacts
    onset = impacts.kind == ONSET
    assert onset.any()
    taken = energies(machine, impacts)
    bounced = energies(machine, impacts._replace(kind=np.full_like(impacts.kind, BOUNCE)))
    np.testing.assert_allclose(taken[onset], bounced[onset] / (1.0 - 0.9**2), rtol=1e-12)
    np.testing.assert_array_equal(taken[~onset], bounced[~onset])


WEIGHTS = st.lists(st.floats(1e-6, 1e3), min_size=2, max_size=60)


@given(weights=WEIGHTS, scale=st.floats(1e-3, 1e3))
@settings(derandomize=True, deadline=None)
def test_entropy_is_between_none_and_even(weights, scale):
    """0 <= uniformity <= 1, whatever the order and the unit of the weights."""
    values = np.array(weights)
    found = uniformity(values)
    assert -1e-12 <= found <= 1.0 + 1e-12
    assert uniformity(scale * values[::-1]) == pytest.approx(found, abs=1e-12)
    assert 1.0 - 1e-12 <= effective_bins(values) <= len(values) * (1.0 + 1e-12)


@pytest.mark.parametrize("bins", [2, 10, 1000])
def test_entropy_of_one_spot_and_of_an_even_wall(bins):
    """Exactly 0 and 1; n equal spots have n effective bins, for any number of bins."""
    one = np.zeros(bins)
    one[bins // 3] = 0.7
    assert uniformity(one) == 0.0
    assert uniformity(np.full(bins, 0.2)) == pytest.approx(1.0, abs=1e-14)
    two = np.zeros(bins)
    two[0] = two[-1] = 3.0
    assert effective_bins(two) == pytest.approx(2.0, rel=1e-14)


def test_no_impacts_have_no_uniformity():
    assert math.isnan(uniformity(np.zeros(5)))
    assert math.isnan(sampling_bias(np.zeros(5), np.zeros(0)))


def test_sampling_bias_is_what_is_missing():
    """400 independent impacts on an even wall of 50 bins, 300 times: the mean uniformity and the correction
    make 1 (to the second order, 1/N^2, and four standard errors)."""
    random = np.random.default_rng(1)
    found = []
    for _ in range(300):
        weights = np.bincount(random.integers(0, 50, 400), minlength=50).astype(float)
        found.append(uniformity(weights) + sampling_bias(weights, np.ones(400)))
    error = np.std(found) / math.sqrt(len(found))
    assert np.mean(found) == pytest.approx(1.0, abs=4.0 * error + (50 / 400) ** 2 / 12.0)
