"""The judgement of film formulas: its numbers and page."""

import numpy as np
import pytest

from models.contact.analysis.line.line_contact import moes_contact
from reproduction.films.formulas import FORMULAS, compute_asymptotes, find_regime
from reproduction.films.numerical import list_heights
from reproduction.films.runs import Runs


@pytest.fixture(scope="module")
def runs():
    """Fewer contacts, same ranges; fewer nodes and angles."""
    return Runs(sample=(5, 1), speeds=(1000.0,), step_deg=15.0, nodes=101)


def test_regimes_have_their_places():
    """Light and stiff, light and piezoviscous, heavy and isoviscous, heavy and piezoviscous."""
    places = {(0.1, 0.5): "rigid-isoviscous", (0.6, 15.0): "rigid-piezoviscous",
              (100.0, 0.5): "elastic-isoviscous", (50.0, 10.0): "elastic-piezoviscous"}  # fmt: skip
    for (M, L), name in places.items():
        assert find_regime(moes_contact(M, L)) == name


def test_bloks_film_is_the_rigid_piezoviscous_asymptote():
    """1.66 (alpha eta0 u/R)^(2/3) with alpha eta0 u/R = G U_S/2: 1.046 L^(2/3); 1.05 is that, rounded."""
    contact = moes_contact(1.0, 8.0)
    fluid = contact.lubricant
    h = 1.66 * (fluid.pressure_viscosity * fluid.viscosity * contact.velocity / contact.radius) ** (2.0 / 3.0)
    H = h * contact.radius / contact.film_scale
    assert compute_asymptotes(1.0, 8.0)["rigid-piezoviscous"] == pytest.approx(H, rel=5e-3)


def test_closing_bodies_have_thicker_films(runs):
    steady, squeezed = (
        list_heights(films, "central_film") for films in (runs.sample.steady, runs.sample.squeezed)
    )
    assert np.all(squeezed > steady)


@pytest.mark.long
def test_steady_films_are_everywhere_but_at_the_reversals(runs):
    cycle = runs.shown
    at_rest = np.isin(np.arange(cycle.angle_deg.size), cycle.reversals)
    assert cycle.reversals_deg == pytest.approx([144.0, 168.0, 192.0, 216.0])
    for name in ("steady central", "steady minimum"):
        np.testing.assert_array_equal(np.isfinite(cycle.judged[name].values), ~at_rest)
    assert np.all(cycle.steady["minimum"][~at_rest] <= cycle.steady["central"][~at_rest])


@pytest.mark.long
def test_only_squeeze_keeps_a_film_at_the_reversals(runs):
    cycle = runs.shown
    for formula in FORMULAS:
        largest = float(np.max(cycle.judged[formula.name].values))
        # The angles of the reversals are known to rounding.
        assert np.all(cycle.judged[formula.name].values[cycle.reversals] < 1e-4 * largest)
        assert not np.any(cycle.judged[formula.name].valid[cycle.reversals])
    for kept in (cycle.transient["minimum"], cycle.judged["kushwaha squeezed"].values):
        assert np.all(kept[cycle.reversals] > 0.05e-6)


@pytest.mark.long
def test_squeezed_films_are_the_relaxation_of_the_monolithic_solution(runs):
    """Kushwaha's film along the load of the adherence solution is that solution's own film."""
    cycle = runs.shown
    turn = runs.train.surge(cycle.speed_rpm)
    own = [turn.film_at(angle) for angle in cycle.angle_deg]
    # Interpolated between steps of 0.1 degrees; the solution's own tolerance is 1e-6.
    np.testing.assert_allclose(cycle.judged["kushwaha squeezed"].values, own, rtol=1e-3)


def test_squeeze_ranges_are_as_the_contact_reports_them(runs):
    cycle = runs.shown
    turn = runs.train.surge(cycle.speed_rpm)
    names = [f"contact.{group}_in_range" for group in ("material", "load", "speed", "squeeze")]
    reported = np.array([min(turn.at(name, angle) for name in names) for angle in cycle.angle_deg])
    valid = cycle.judged["kushwaha squeezed"].valid
    # Between 0 and 1 the range ends inside the interval of 0.1 degrees.
    known = (reported == 0.0) | (reported == 1.0)
    np.testing.assert_array_equal(valid[known], reported[known] == 1.0)


def test_the_transient_film_lags_behind_the_steady_one(runs):
    """Thinner where the steady film grows, thicker where it falls, equal at rest: only in between is the
    steady film right."""
    cycle = runs.shown
    falling, growing = (cycle.at(angle) for angle in (135.0, 225.0))
    ratio = cycle.ratio("steady minimum")
    assert ratio[falling] < 1.0 < ratio[growing]
