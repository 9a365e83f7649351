"""How far a run left the ranges behind the film formula of Kushwaha et al. 2000 (their Table 3)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from models.contact.ehl_contact import TABLE_3
from models.contact.films import FILMS
from models.contact.films.groups import groups
from models.contact.hertz import elastic_compliance
from models.monolithic.difference import time_weights
from models.quantities import Vector
from models.system import System

SYMBOLS = {"material": "G", "squeeze": "w_s", "load": "W", "speed": "U"}

# Gives columns of the coupled run, by "instance.variable", and "time".
Read = Callable[[Sequence[str]], Mapping[str, Vector]]


@dataclass(frozen=True)
class Excursion:
    """A group outside its range [`low`, `high`]: for which share of the time under load, and its extremes."""

    share: float
    least: float
    most: float
    low: float
    high: float

    def __str__(self) -> str:
        extremes = f"{self.least:.2g} to {self.most:.2g}"
        share = f"{100.0 * self.share:.1f}".removesuffix(".0")
        return f"{share} % of the time ({extremes}, range {self.low:g} to {self.high:g})"


Excursions = dict[str, dict[str, Excursion]]


def excursions(system: System, read: Read) -> Excursions:
    """The groups that left their range while the contact was loaded, by contact; others are not listed."""
    found = {
        name: _of(name, parameters, system, read)
        for name, parameters in contacts(system).items()
        if tuple(FILMS)[int(parameters["film_model"])].startswith("kushwaha")
    }
    return {name: groups for name, groups in found.items() if groups}


def lines(found: Excursions) -> list[str]:
    """A sentence for each contact."""
    return [
        f"{name}: film formula outside its ranges (Kushwaha 2000, Table 3) under load: "
        + ", ".join(f"{SYMBOLS[group]} {excursion}" for group, excursion in groups.items())
        for name, groups in found.items()
    ]


def contacts(system: System) -> dict[str, dict[str, float]]:
    """The parameters of all lubricated contacts."""
    return {
        name: instance.component.parameters.named(instance.component.parameters.vector(instance.parameters))
        for name, instance in system.instances.items()
        if instance.component.name == "ehl_contact"
    }


def _of(name: str, parameters: Mapping[str, float], system: System, read: Read) -> dict[str, Excursion]:
    outputs = ("load", "squeeze_velocity", *(f"{group}_in_range" for group in TABLE_3))
    drivers = {c.target.variable: str(c.source) for c in system.connections if c.target.instance == name}
    columns = read(["time", *(f"{name}.{output}" for output in outputs), *drivers.values()])
    loaded = columns[f"{name}.load"] > 0.0
    if not loaded.any():
        return {}
    weights = time_weights(columns["time"])[loaded]
    layout = system.instances[name].component.inputs
    constant = layout.named(layout.vector(system.instances[name].inputs))

    def given(variable: str) -> Vector:
        driver = drivers.get(variable)
        return columns[driver][loaded] if driver else np.full(loaded.sum(), constant[variable])

    own = {output: columns[f"{name}.{output}"][loaded] for output in outputs}
    values = group_values(
        parameters,
        own["load"],
        own["squeeze_velocity"],
        given("entraining_velocity"),
        given("radius_of_curvature"),
    )
    return {
        group: Excursion(
            float(np.average(outside, weights=weights)), *_extremes(values[group]), *TABLE_3[group]
        )
        for group in TABLE_3
        if (outside := own[f"{group}_in_range"] == 0.0).any()
    }


def group_values(
    p: Mapping[str, float], load: Vector, film_rate: Vector, velocity: Vector, radius: Vector
) -> dict[str, Vector]:
    """The groups of Table 3 with E = pi / compliance; a squeeze ratio at rest has no value (nan)."""
    compliance = elastic_compliance(
        p["youngs_modulus_1"], p["poissons_ratio_1"], p["youngs_modulus_2"], p["poissons_ratio_2"]
    )
    speed = np.abs(velocity)
    plain = getattr(groups, "py_func", groups)  # on whole columns, not compiled for them
    found = plain(
        np.pi / compliance, load, speed, radius, p["length"], p["viscosity"], p["pressure_viscosity"]
    )
    ratio = np.divide(film_rate, speed, out=np.full_like(film_rate, np.nan), where=speed > 0.0)
    return {
        "material": np.full_like(load, found.material),
        "squeeze": ratio,
        "load": found.load,
        "speed": found.speed,
    }


def _extremes(values: Vector) -> tuple[float, float]:
    known = values[np.isfinite(values)]
    return (float(known.min()), float(known.max())) if known.size else (np.nan, np.nan)
