"""Steady numerical films of many line contacts, side by side on the machine's cores."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from models.contact.line.line_contact import LineContact
from models.contact.line.steady import LineContactError, SteadyFilm, solve_steady
from models.quantities import Vector

# Relative error of the films: far below what formulas are off.
TOLERANCE = 2e-3


def films(contacts: Sequence[LineContact | None]) -> list[SteadyFilm | None]:
    """Their films; None where there is no contact, or no film to the TOLERANCE."""
    # The kernels let go of the interpreter.
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(steady_film, contacts))


def steady_film(contact: LineContact | None) -> SteadyFilm | None:
    """Its film; None where there is no contact, or no film to the TOLERANCE."""
    if contact is None:
        return None
    try:
        return solve_steady(contact, TOLERANCE)
    except LineContactError:
        return None


def heights(found: Sequence[SteadyFilm | None], name: str) -> Vector:
    """An attribute of each film, nan where there is none."""
    return np.array([np.nan if film is None else getattr(film, name) for film in found])
