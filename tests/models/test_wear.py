"""Archard's wear of passing contacts: conservation of volume and the closed form of a steady pass."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.contact.wear import hertz_share, trapezoidal, worn_depth


def test_the_share_of_a_hertzian_load_is_its_integral():
    x = np.linspace(-1.0, 1.0, 200001)
    pressure = 2.0 / math.pi * np.sqrt(1.0 - x * x)
    integral = np.concatenate([[0.0], np.cumsum(0.5 * (pressure[1:] + pressure[:-1]) * np.diff(x))])
    # Trapezoidal rule at the square root's ends: about h^1.5 with h = 1e-5.
    np.testing.assert_allclose(hertz_share(x), integral, rtol=0.0, atol=1e-7)
    assert hertz_share(np.array([-9.0, 0.0, 9.0])) == pytest.approx([0.0, 0.5, 1.0], abs=1e-15)


@given(
    st.lists(
        st.tuples(st.floats(-1.0, 1.0), st.floats(1e-4, 0.3), st.floats(0.0, 5.0)), min_size=1, max_size=20
    )
)
def test_what_is_worn_off_is_the_dose(records):
    place, width, dose = (np.array(column) for column in zip(*records, strict=True))
    edges = np.linspace(-1.5, 1.5, 98)
    depth = worn_depth(edges, place, width, dose)
    assert depth @ np.diff(edges) == pytest.approx(dose.sum(), rel=1e-12, abs=1e-300)
    assert depth.min() >= 0.0
    # Of places that recur nothing is lost over the end.
    around = worn_depth(np.linspace(-1.0, 1.0, 98), place, width, dose, period=2.0)
    assert around.sum() * 2.0 / 97.0 == pytest.approx(dose.sum(), rel=1e-12, abs=1e-300)


def test_a_steady_pass_wears_load_over_length_times_the_ratio_of_speeds():
    """h = k (W/L) |u_s/v|, wherever the whole width has passed."""
    line_load, sliding, speed, width = 4e4, 3.0, 0.7, 1e-4
    time = np.linspace(0.0, 0.1, 20001)
    dose = line_load * sliding * trapezoidal(time)
    assert dose.sum() == pytest.approx(line_load * sliding * 0.1, rel=1e-12)
    depth = worn_depth(np.linspace(0.02, 0.05, 301), speed * time, np.full_like(time, width), dose)
    # Records lie 3.5e-6 apart, 1/29 of the half width: bins of 1e-4 see the ends of some of them.
    assert depth == pytest.approx(line_load * sliding / speed, rel=2e-3)


def test_a_standing_contact_wears_hertzs_profile():
    edges = np.linspace(-1e-4, 1e-4, 2001)
    depth = worn_depth(edges, np.zeros(1), np.array([1e-4]), np.array([5.0]))
    middle = 0.5 * (edges[1:] + edges[:-1])
    expected = 2.0 * 5.0 / (math.pi * 1e-4) * np.sqrt(1.0 - (middle / 1e-4) ** 2)
    # Means of bins of 1e-3 of the width against the middle; beside the ends the profile is steep.
    inside = np.abs(middle) < 0.9e-4
    assert depth[inside] == pytest.approx(expected[inside], rel=1e-5)
