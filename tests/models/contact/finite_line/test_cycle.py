"""Through the cam cycle: instants as they are alone, with and without load and velocity; the bent shaft."""

from __future__ import annotations

import math

import numpy as np
import pytest

from models.contact.analysis.finite_line.contact import Running
from models.contact.analysis.finite_line.cycle import passage
from models.contact.analysis.finite_line.grid import Resolution
from models.core.quantities import Layout
from models.core.system import ModelError
from models.valve_train.camshaft import CamshaftParameters
from models.valve_train.shaft_element import static_slope

from .cases import STRAIGHT, dry_of, film_of

FINE = Resolution(12.0, 0.4, 0.5, 16)


@pytest.mark.long
def test_every_instant_is_what_it_is_alone():
    """The start makes no difference beyond Newton's tolerance; no velocity is dry, no load is open. One that
    fails says so, and the others go on."""
    loads, speeds, radii = [500.0, 520.0, 400.0, 0.0, 450.0], [1.0, 1.2, 1e-15, 1.0, 1.0], [*4 * [0.02], -1.0]
    found = passage(STRAIGHT, np.radians([150, 155, 160, 165, 170]), loads, speeds, radii, [1e-4] * 5, FINE)
    assert math.isnan(found.central_film[4])
    (message,) = found.messages
    assert "170 deg: radius = -1 m: must be positive" in message
    alone = film_of(STRAIGHT, Running(loads[1], speeds[1], 0.02, 1e-4), FINE)
    assert found.central_film[1] == pytest.approx(alone.central_film, rel=1e-5)
    assert found.end_pressure[1] == pytest.approx(alone.end_pressure, rel=1e-4)
    dry = dry_of(STRAIGHT, Running(400.0, 0.0, 0.02, 1e-4), FINE)
    assert (found.smallest_film[2], found.end_pressure[2]) == (0.0, dry.end_pressure)
    assert found.largest_pressure[3] == 0.0
    assert math.isnan(found.smallest_film[3])


def test_sequences_of_different_lengths_are_refused():
    with pytest.raises(ModelError, match=r"lengths of the cycle's sequences = \[1, 2\]"):
        passage(STRAIGHT, [0.0, 0.1], [500.0], [1.0, 1.0], [0.02, 0.02], [0.0, 0.0], FINE)


def test_the_shafts_slope_is_that_of_a_cantilever():
    """W l^2 / (2 E J)."""
    layout = Layout(CamshaftParameters)
    p = layout.view(layout.vector())
    bending = p.youngs_modulus * math.pi * p.shaft_diameter**4 / 64.0
    assert static_slope(500.0, p) == pytest.approx(-500.0 * p.shaft_length**2 / (2.0 * bending), rel=1e-12)
