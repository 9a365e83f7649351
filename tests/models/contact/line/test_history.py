"""The film along a given motion: its limits and symmetries."""

import numpy as np
import pytest

from models.contact.analysis.line.history import film_history, formula_history
from models.contact.analysis.line.line_contact import LineContact
from models.contact.analysis.line.steady import solve_steady
from models.contact.films import FILMS
from models.contact.fluid import Lubricant
from models.contact.hertz import elastic_compliance

from .cam_cycle import motion

NODES = 101
STEEL = elastic_compliance(207e9, 0.3, 207e9, 0.3)
OIL = Lubricant(0.036, 1.8e-8)
# Of films on 101 nodes that reach 10 contact widths.
NODES_ERROR = 0.02


@pytest.mark.long
def test_a_thousandfold_period_gives_the_steady_film() -> None:
    """On the flank towards a reversal, where the film of the cycle lags by far more than the nodes' error."""
    degrees = np.linspace(100.0, 140.0, 161)
    m = motion(degrees, 1000.0)
    k = -1
    steady = solve_steady(LineContact(m.load[k], m.velocity[k], m.radius[k], 0.012, STEEL, OIL))
    lag = {}
    for stretch in (1.0, 1000.0):
        film = film_history(stretch * m.times, m.load, m.velocity, m.radius, NODES)
        lag[stretch] = film.film_thickness[k] / steady.central_film - 1.0
    assert lag[1.0] > 3.0 * NODES_ERROR
    assert abs(lag[1000.0]) < NODES_ERROR


@pytest.mark.parametrize("formula", ["kushwaha", "kushwaha_negative"])
def test_a_relaxed_film_is_kept_at_rest_and_settles_under_entrainment(formula: str) -> None:
    times = np.linspace(0.0, 0.2, 11)
    even = np.ones_like(times)
    kept = formula_history(formula, times, 500.0 * even, 0.0 * even, 0.02 * even, film_thickness=0.7e-6)
    np.testing.assert_array_equal(kept, 0.7e-6)
    steady = FILMS[formula](500.0, 2.0, 0.02, 0.012, STEEL, 0.036, 1.8e-8)
    settled = formula_history(formula, times, 500.0 * even, 2.0 * even, 0.02 * even)
    # Time constant 96.775 h/|u|, at most 0.3 ms here.
    assert settled[-1] == pytest.approx(steady, rel=1e-8)
