"""Steady numerical films of many line contacts, side by side on the machine's cores."""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from models.contact.analysis.line.line_contact import LineContact
from models.contact.analysis.line.steady import LineContactError, SteadyFilm, solve_steady
from models.core.quantities import Vector

# Relative error of the films: far below what formulas are off.
TOLERANCE = 2e-3


def solve_films(contacts: Sequence[LineContact | None]) -> list[SteadyFilm | None]:
    """Their films; None where there is no contact, or no film to the TOLERANCE."""
    # Compiled in this thread, the only one that Ctrl-C reaches.
    solve_film(next((contact for contact in contacts if contact is not None), None))
    # The kernels release the interpreter's lock.
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        solving = [pool.submit(solve_film, contact) for contact in contacts]
        try:
            return [one.result() for one in solving]
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


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
