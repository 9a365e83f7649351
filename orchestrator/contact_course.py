"""What lubricated contacts went through in a run: load, film, pressure, loss of contact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.contact.ehl_contact import FILM_IS_DRY, FILM_IS_SOLVED
from models.monolithic.difference import time_weights
from models.system import System

from .validity import Read, contacts

# More contacts are not said one by one: those with the thinnest films are.
SAID = 4


@dataclass(frozen=True)
class ContactCourse:
    """Loads (N), share of the time without load, highest pressure (Pa) and when (s), least film (m) under
    load and when (s), least film over roughness (0: smooth), which of a film that is `solved` for is that of
    its central film; a dry contact's films are 0."""

    least_load: float
    largest_load: float
    lost: float
    pressure: float
    pressure_time: float
    film: float
    film_time: float
    film_ratio: float
    solved: bool = False

    def __str__(self) -> str:
        text = f"load {self.least_load:.4g} to {self.largest_load:.4g} N"
        text += f", no contact in {100.0 * self.lost:.2g} % of the time" if self.lost else ", contact kept"
        text += f"; highest pressure {1e-9 * self.pressure:.3g} GPa at t = {self.pressure_time:.6g} s"
        text += " (spikes at a reversal grow with the nodes)" if self.solved else ""
        if self.film > 0.0:
            text += f"; least film {1e6 * self.film:.3g} µm at t = {self.film_time:.6g} s, "
            which = "least ratio of the central film to roughness" if self.solved else "least film ratio"
            text += f"{which} {self.film_ratio:.2g}" if self.film_ratio > 0.0 else "smooth surfaces"
        return text


Courses = dict[str, ContactCourse]


def courses(system: System, read: Read) -> Courses:
    """Of all contacts that were ever loaded."""
    found = {}
    for name, parameters in contacts(system).items():
        outputs = ("load", "maximum_pressure", "minimum_film_thickness", "film_ratio")
        # One contact at a time: there may be millions of records.
        time, load, pressure, film, ratio = read(
            ["time", *(f"{name}.{output}" for output in outputs)]
        ).values()
        loaded = load > 0.0
        if not loaded.any():
            continue
        dry = parameters["film_model"] == FILM_IS_DRY
        highest = int(np.argmax(np.where(loaded, pressure, 0.0)))
        thinnest = int(np.argmin(np.where(loaded, film, np.inf)))
        found[name] = ContactCourse(
            float(load.min()),
            float(load.max()),
            float(np.average(~loaded, weights=time_weights(time))),
            float(pressure[highest]),
            float(time[highest]),
            0.0 if dry else float(film[thinnest]),
            float(time[thinnest]),
            0.0 if dry else float(ratio[loaded].min()),
            parameters["film_model"] == FILM_IS_SOLVED,
        )
    return found


def lines(found: Courses) -> list[str]:
    """A sentence for each contact, those with the thinnest films where there are many."""
    names = sorted(found, key=lambda name: found[name].film)[:SAID] if len(found) > SAID else list(found)
    said = [f"{name}: {found[name]}" for name in names]
    if len(found) > SAID:
        said.append(f"{len(found) - SAID} more contacts with thicker films: see summary.json")
    return said
