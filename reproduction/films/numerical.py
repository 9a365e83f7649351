"""Steady numerical films of many line contacts, side by side on the machine's cores."""

from collections.abc import Sequence

import numpy as np

from models.compile.parallel import each
from models.contact.analysis.line.line_contact import LineContact
from models.contact.analysis.line.steady import LineContactError, SteadyFilm, solve_steady
from models.core.quantities import Vector

# Relative error of the films: far below what formulas are off.
TOLERANCE = 2e-3


def solve_films(contacts: Sequence[LineContact | None]) -> list[SteadyFilm | None]:
    """Their films; None where there is no contact, or no film to the TOLERANCE."""
    return each(solve_film, contacts)


def solve_film(contact: LineContact | None) -> SteadyFilm | None:
    """Its film; None where there is no contact, or no film to the TOLERANCE."""
    if contact is None:
        return None
    try:
        return solve_steady(contact, TOLERANCE)
    except LineContactError:
        return None


def list_heights(found: Sequence[SteadyFilm | None], name: str) -> Vector:
    """An attribute of each film, nan where there is none."""
    return np.array([np.nan if film is None else getattr(film, name) for film in found])
