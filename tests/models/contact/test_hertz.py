"""Hertz's line contact: load and deflection are each other's inverse as far as there is a line contact."""

from __future__ import annotations

import math

import numpy as np
import pytest

from models.contact.hertz import deflection, elastic_compliance, find_load, half_width

STEEL = elastic_compliance(207e9, 0.3, 207e9, 0.3)


@pytest.mark.parametrize(("radius", "length"), [(0.02, 12e-3), (5e-3, 1e-3), (1.0, 1e-3)])
def test_load_is_the_inverse_of_the_deflection_and_goes_on_beyond(radius: float, length: float) -> None:
    """To rounding up to b = L; it rises, finite, at any deflection."""
    deflections = np.geomspace(1e-12, 1e3, 61)
    loads = np.array([find_load(delta, radius, length, STEEL) for delta in deflections])
    assert np.all(np.isfinite(loads))
    assert np.all(np.diff(loads) > 0.0)
    for delta, load in zip(deflections, loads, strict=True):
        if half_width(load, radius, length, STEEL) < length:
            assert deflection(load, radius, length, STEEL) == pytest.approx(delta, rel=1e-12)


def test_load_goes_on_along_the_tangent_where_the_contact_is_as_wide_as_long() -> None:
    radius, length = 0.02, 12e-3
    edge = length**2 * (math.log(2.0) + 0.5) / (2.0 * radius)
    below, at, above = (find_load(edge * (1.0 + step), radius, length, STEEL) for step in (-1e-5, 0.0, 1e-5))
    assert half_width(at, radius, length, STEEL) == pytest.approx(length, rel=1e-9)
    # The curvature of W (c - ln(W)/2) makes 1e-5 of the slope.
    assert above - at == pytest.approx(at - below, rel=1e-4)
