"""The film of a finite line contact: laws, symmetries, limits, the line contact in its middle, its ends."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from models.contact.analysis.finite_line.contact import FiniteLine, Running
from models.contact.analysis.finite_line.grid import Grid, Resolution
from models.contact.analysis.finite_line.profiles import Chamfered, Crowned, Logarithmic, johns_gohar
from models.contact.analysis.finite_line.reynolds import Balance
from models.contact.analysis.finite_line.steady import steady
from models.contact.analysis.line.line_contact import LineContact
from models.contact.analysis.line.steady import LineContactWarning, solve_steady
from models.contact.fluid import Lubricant
from models.core.system import ModelError

from .cases import AT, COARSE, LENGTH, OIL, STEEL, STRAIGHT, dry_of, film_of


def in_the_middle(found):
    """The line contact under the load per length that the middle carries."""
    pair = slice(found.grid.shape[1] // 2 - 1, found.grid.shape[1] // 2 + 1)
    load = float(np.mean(found.load_per_length[pair])) * LENGTH
    line = LineContact(load, found.running.velocity, found.running.radius, LENGTH, STEEL, OIL)
    return solve_steady(line)


def test_the_film_carries_the_load_and_cavitates_or_is_full():
    found = film_of(STRAIGHT, AT, COARSE)
    assert found.warnings == ()
    assert found.load == pytest.approx(AT.load, rel=1e-8)
    assert np.all(found.pressure >= 0.0)
    assert np.all(found.film > 0.0)
    b, grid = found.half_width, found.grid
    unit = b / (2.0 * AT.radius * STEEL)
    wedge = 12.0 * OIL.viscosity * AT.velocity * AT.radius**2 / (b**3 * unit)
    balance = Balance(Grid(grid.x / b, grid.faces / b), unit, OIL)
    g, _, _ = balance(found.pressure / unit, found.film * AT.radius / b**2, wedge)
    inner = np.zeros(grid.shape, dtype=bool)
    inner[2:-1] = True
    full = found.pressure > 0.0
    film = np.median(found.film[full]) * AT.radius / b**2
    # The tolerance of Newton's method, for its root mean square, with a factor for the largest.
    assert np.max(np.abs(g[full & inner])) < 1e-4 * film
    assert np.min(g[~full & inner]) > -1e-9


def test_pressure_is_a_dog_bone_and_the_film_is_least_at_the_ends():
    found = film_of(STRAIGHT, AT, COARSE)
    assert found.end_pressure > 1.5 * found.middle_pressure
    assert found.end_film < 0.6 * found.middle_film
    assert found.end_film == found.smallest_film
    # Symmetric to the linear solver's residual.
    np.testing.assert_allclose(found.film, found.film[:, ::-1], rtol=1e-5)
    assert abs(found.moment) < 1e-6 * AT.load * LENGTH


def test_backwards_it_is_its_mirror_image():
    forwards = film_of(STRAIGHT, AT, COARSE)
    backwards = steady(STRAIGHT, dataclasses.replace(AT, velocity=-AT.velocity), COARSE)
    np.testing.assert_array_equal(forwards.pressure, backwards.pressure[::-1])
    np.testing.assert_allclose(forwards.grid.x, -backwards.grid.x[::-1])
    again = steady(STRAIGHT, backwards.running, COARSE, backwards)
    np.testing.assert_allclose(again.film, backwards.film, rtol=1e-5)


def test_misalignment_mirrors_and_its_moment_turns_with_it():
    one, other = (film_of(STRAIGHT, dataclasses.replace(AT, misalignment=m), COARSE) for m in (2e-4, -2e-4))
    np.testing.assert_allclose(one.film, other.film[:, ::-1], rtol=1e-5)
    assert one.moment == pytest.approx(-other.moment, rel=1e-5)
    assert one.moment < 0.0
    assert one.end_pressure > film_of(STRAIGHT, AT, COARSE).end_pressure


@pytest.mark.long
def test_the_middle_is_the_line_contact(record):
    """At that load per length; 12 and 24 nodes, extrapolated by their second order."""
    coarse, fine = (film_of(STRAIGHT, AT, Resolution(nodes, 0.4, 0.5, 16)) for nodes in (12.0, 24.0))
    line = in_the_middle(fine)
    extrapolated = fine.central_film + (fine.central_film - coarse.central_film) / 3.0
    # The line's own 0.2 %, what is left of the grid's 0.6 %, and ends 50 half widths away.
    for name, found, exact, relative in (
        ("central film", extrapolated, line.central_film, 5e-3),
        ("smallest film in the middle", fine.middle_film, line.minimum_film, 1e-2),
        ("largest pressure in the middle", fine.middle_pressure, line.maximum_pressure, 1e-2),
    ):
        record("Field", f"finite line: {name}", found, exact, "line contact of that load", relative=relative)


@pytest.mark.long
def test_a_thin_film_in_the_middle_is_the_line_contact():
    """M = 100, whose inlet is b/11 wide: a logarithmic profile, few lines."""
    at = Running(load=32564.0, velocity=2.25, radius=20e-3)
    contact = FiniteLine(LENGTH, STEEL, OIL, johns_gohar(at.load, at.radius, LENGTH, STEEL))
    found = film_of(contact, at, Resolution(12.0, 0.4, 0.5, 12, 8.0))
    with pytest.warns(LineContactWarning, match="elastic limit"):
        line = in_the_middle(found)
    assert found.warnings == ()
    # The line's own 0.2 %, and what eight nodes in the inlet leave, 0.2/8^2.
    assert found.central_film == pytest.approx(line.central_film, rel=5e-3)
    assert found.middle_pressure == pytest.approx(line.maximum_pressure, rel=5e-3)


@pytest.mark.long
def test_the_grids_error_is_of_second_order_in_x():
    """12, 24 and 48 nodes: 2 to 0.5, since the film's largest error lies where it cavitates."""
    films = [
        film_of(STRAIGHT, AT, Resolution(nodes, 0.4, 0.5, 16)).central_film for nodes in (12.0, 24.0, 48.0)
    ]
    order = np.log2((films[1] - films[0]) / (films[2] - films[1]))
    assert order == pytest.approx(2.0, abs=0.5)


@pytest.mark.long
def test_the_ends_of_a_logarithmic_profile_converge(record):
    """Cells of 0.2, 0.1 and 0.05 half widths: the change of the end film shrinks at least by their square."""
    logarithmic = FiniteLine(LENGTH, STEEL, OIL, johns_gohar(AT.load, AT.radius, LENGTH, STEEL))
    films = [film_of(logarithmic, AT, Resolution(12.0, cell, 0.2, 24)).end_film for cell in (0.2, 0.1, 0.05)]
    assert abs(films[2] - films[1]) < 0.25 * abs(films[1] - films[0])
    quantity = "finite line: film at the end of a logarithmic profile (m)"
    record("Field", quantity, films[2], films[1], "cells twice as wide", relative=2e-2)


@pytest.mark.long
def test_the_film_bounds_the_peak_of_a_sharp_end():
    """Without a film it grows by sqrt(2) with each halving of the cells; with one, by less and less."""
    cells = (0.2, 0.1, 0.05, 0.025)
    peaks = [film_of(STRAIGHT, AT, Resolution(12.0, cell, 0.2, 24)).end_pressure for cell in cells]
    changes = np.diff(peaks)
    assert changes[0] > changes[1] > 2.0 * changes[2] > 0.0


@pytest.mark.long
def test_profiles_relieve_the_ends():
    """In the order of their sharpness; a crown unloads the ends wholly and pays in the middle."""
    profiles = {
        "logarithmic": johns_gohar(AT.load, AT.radius, LENGTH, STEEL),
        "chamfered": Chamfered(0.5e-3, 0.005),
        "crowned": Crowned(3.0),
    }
    found = {name: film_of(FiniteLine(LENGTH, STEEL, OIL, p), AT, COARSE) for name, p in profiles.items()}
    straight = film_of(STRAIGHT, AT, COARSE)
    assert found["logarithmic"].end_pressure < found["chamfered"].end_pressure < straight.largest_pressure
    assert found["logarithmic"].smallest_film > found["chamfered"].smallest_film > straight.smallest_film
    assert found["crowned"].end_pressure < 0.1 * found["crowned"].middle_pressure
    assert found["crowned"].middle_pressure > found["logarithmic"].middle_pressure


def test_without_speed_it_becomes_the_dry_contact():
    """Films vanish with u^0.7: 1/50 of the velocity, a fifteenth of the film, nearly Hertz's pressure."""
    slow = film_of(STRAIGHT, dataclasses.replace(AT, velocity=AT.velocity / 50.0), COARSE)
    dry = dry_of(STRAIGHT, AT, COARSE)
    assert slow.middle_pressure == pytest.approx(dry.middle_pressure, rel=1e-2)
    assert slow.approach + slow.central_film == pytest.approx(dry.approach, rel=1e-2)
    assert slow.central_film < 0.1 * film_of(STRAIGHT, AT, COARSE).central_film


@pytest.mark.long
def test_a_sharp_tilted_end_near_a_reversal_has_a_film():
    """0.1 degrees from the cam's second reversal, M = 29 on average; Newton's method alone fails there."""
    at = Running(load=572.5, velocity=0.0115, radius=14.5e-3, misalignment=2.8e-4)
    found = steady(STRAIGHT, at, Resolution(12.0, 0.4, 0.5, 16))
    assert found.load == pytest.approx(at.load, rel=1e-8)
    assert np.all(found.film > 0.0)
    # Thinner than a line contact's under the mean load, and than its own in the middle.
    line = solve_steady(LineContact(at.load, at.velocity, at.radius, LENGTH, STEEL, OIL))
    assert found.smallest_film < line.minimum_film
    assert found.end_pressure > 2.0 * line.maximum_pressure


def test_it_says_what_is_not_to_be_trusted():
    """Few nodes on the half width; few in a narrow inlet."""
    found = steady(STRAIGHT, AT, Resolution(5.0, 0.4, 0.5, 16, 1.0))
    assert any("nodes per half width: fewer than 12" in warning for warning in found.warnings)
    slow = dataclasses.replace(AT, velocity=AT.velocity / 100.0)
    found = steady(STRAIGHT, slow, Resolution(12.0, 0.4, 0.5, 16, 0.5))
    assert any("nodes in the inlet of the film: fewer than 2" in warning for warning in found.warnings)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: FiniteLine(LENGTH, STEEL, Lubricant(0.0, 1e-8)), "viscosity = 0 Pa s: must be positive"),
        (lambda: Running(-1.0, 1.0, 0.02), "load = -1 N: must be positive"),
        (lambda: Running(1.0, 1.0, 0.02, 3.0), "misalignment = 3 rad: must be between"),
        (lambda: steady(STRAIGHT, Running(500.0, 0.0, 0.02)), "entraining velocity = 0 m/s: must be other"),
        (lambda: Crowned(0.0), "crown radius = 0 m"),
        (lambda: Logarithmic(1e-6, straight_share=1.0), "straight share = 1 1: must be < 1"),
        (lambda: steady(STRAIGHT, Running(500.0, 4e-16, 0.02)), "velocity = 4e-16 m/s: must be large enough"),
        (lambda: steady(STRAIGHT, AT, Resolution(1e7)), "cells in a row: must be at most 4000"),
        (lambda: steady(STRAIGHT, AT, Resolution(1000.0)), r"cells = .*e\+\d+ bytes: must be at most 4e\+09"),
        (lambda: Resolution(0.0), "nodes_per_half_width = 0 1: must be positive"),
    ],
)  # fmt: skip
def test_mistakes_are_named_with_value_range_and_remedy(make, message):
    with pytest.raises(ModelError, match=message) as caught:
        make()
    assert ";" in str(caught.value)
