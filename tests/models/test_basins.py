"""Basins of attraction: coexisting attractors are told apart, one attractor is one from every start."""

import math

import numpy as np
import pytest

from models.slider_crank.motions.basins import find_basins
from models.slider_crank.motions.machine import Machine


def grid(gap: float, count: int):
    return np.linspace(-gap, gap, count), np.linspace(-10.0 * gap, 10.0 * gap, count)


@pytest.mark.long
@pytest.mark.parametrize("workers", [1, 3])
def test_a_sliding_and_a_bouncing_orbit_have_a_basin_each(workers: int) -> None:
    # Permanent sliding and four impacts a cycle, both stable, with the corrected sign.
    machine = Machine(damping=0.15, gap=0.02, form="corrected")
    found = find_basins(machine, *grid(0.02, 8), cycles=2000, workers=workers)
    assert [attractor.period for attractor in found.attractors] == [1, 1]
    sliding = [attractor.exponent == -math.inf for attractor in found.attractors]
    assert sorted(sliding) == [False, True]
    counts = [attractor.starts for attractor in found.attractors]
    assert counts == sorted(counts, reverse=True)
    np.testing.assert_array_equal(np.bincount(found.label.ravel()), counts)


@pytest.mark.parametrize(("gap", "period", "sign"), [(0.015, 1, -1.0), (0.01, 0, 1.0)])
def test_one_attractor_whether_periodic_or_chaotic_is_one_from_every_start(
    gap: float, period: int, sign: float
) -> None:
    found = find_basins(Machine(damping=0.05, gap=gap, form="as_published"), *grid(gap, 6), cycles=2000)
    assert len(found.attractors) == 1
    assert found.attractors[0].period == period
    assert found.attractors[0].exponent * sign > 3.0 * found.attractors[0].uncertainty


@pytest.mark.parametrize(
    ("farthest", "cycles", "said"), [(0.02, 100, "between the walls"), (0.0, 39, "cycles = 39")]
)
def test_starts_outside_the_walls_and_too_few_cycles_are_refused(
    farthest: float, cycles: int, said: str
) -> None:
    with pytest.raises(ValueError, match=said):
        find_basins(Machine(gap=0.01), np.array([0.0, farthest]), np.array([0.0]), cycles=cycles)
