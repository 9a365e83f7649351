"""The steady line contact: films over Moes' groups, their errors and limits, and coarse grids."""

from __future__ import annotations

import dataclasses
import itertools
import math
import warnings
from collections.abc import Iterator

import numpy as np

from models.contact.films.moes_venner import moes_film
from models.contact.fluid import DENSITY_LAWS, VISCOSITY_LAWS
from models.contact.line.line_contact import moes_contact
from models.contact.line.steady import LineContactError, LineContactWarning, solve_steady
from tests.models.contact.line.test_steady import CAM, CORNERS, GRID, film_of, on_nodes

from .table import Row, largest

TESTS = "models/contact/line/test_steady.py::"
# Central and minimum film of an independent solution, good to about 0.5 %.
REFERENCE = {
    (10, 0): (1.680, 1.324), (20, 0): (1.420, 1.125), (50, 0): (1.160, 0.923),
    (10, 5): (3.459, 2.826), (20, 5): (3.082, 2.567), (50, 5): (2.641, 2.262),
    (10, 10): (4.832, 4.103), (20, 10): (4.364, 3.777), (50, 10): (3.812, 3.374),
}  # fmt: skip
ORDERS = ((3, 5), (20, 0), (50, 10), (1000, 1))


def rows() -> Iterator[Row]:
    yield _laws()
    yield _cavitation()
    yield _every()
    yield _grids()
    yield _table()
    yield _orders()
    yield _moes()
    yield _martin()
    yield _hertz()


def _laws() -> Row:
    found = {}
    for viscosity, density in (("roelands", 0), ("barus", 0), ("constant", 0), ("roelands", 1)):
        fluid = CAM.lubricant._replace(
            viscosity_law=float(VISCOSITY_LAWS.index(viscosity)), density_law=float(density)
        )
        name = f"{viscosity}, {DENSITY_LAWS[density]}"
        found[name] = solve_steady(dataclasses.replace(CAM, lubricant=fluid)).central_film
    fluid = CAM.lubricant._replace(eyring_stress=1e6)
    thin = dataclasses.replace(CAM, sliding=2.0 * CAM.velocity, lubricant=fluid)
    found["roelands with an Eyring stress of 1 MPa, one surface at rest"] = solve_steady(thin).central_film
    return Row(
        "Roelands / Barus / constant viscosity, Dowson-Higginson density or none, optional Eyring shear "
        "thinning, elastic half-plane",
        "central film at 600 N, 1.5 m/s, 30 mm: "
        + "; ".join(f"{name} {1e6 * h:.3f} µm" for name, h in found.items()),
        (
            TESTS + "test_films_depend_on_two_groups_and_the_viscosity_law",
            TESTS + "test_shear_thinning_makes_no_thicker_film",
            TESTS + "test_the_film_is_the_gap_of_the_deflected_bodies",
            TESTS + "test_oil_flows_through_evenly",
        ),
    )


def _cavitation() -> Row:
    least = min(float(np.min(film_of(M, L).pressure)) for M, L in CORNERS)
    load = largest(film_of(M, L).load_error for M, L in CORNERS)
    return Row(
        "cavitation as complementarity",
        f"least pressure of {len(CORNERS)} contacts {least:g} Pa; pressures carry their load to {load}",
        (
            TESTS + "test_pressure_and_cavity_complement_each_other",
            TESTS + "test_pressure_carries_the_load",
        ),
    )


def _every() -> Row:
    errors, failed = [], []
    for M, L in GRID:
        try:
            film = film_of(M, L)
            errors.append(film.mesh_error + film.starvation)
            if film.warnings:
                failed.append(f"M = {M:g}, L = {L:g}: {film.warnings[0]}")
        except LineContactError as error:
            failed.append(str(error))
    return Row(
        "any M from 1 to 1000 and L from 0 to 20 without a failed or false solution",
        f"{len(GRID)} pairs: {len(GRID) - len(failed)} without error or warning; own estimates of the films' "
        f"error at most {100.0 * max(errors):.2f} %",
        (
            TESTS + "test_films_are_near_moes_fit",
            TESTS + "test_every_load_and_viscosity_has_a_film",
            TESTS + "test_the_error_is_bounded_by_its_estimate",
        ),
        short="; ".join(failed),
    )


def _grids() -> Row:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", LineContactWarning)
        solve_steady(moes_contact(1000.0, 20.0), nodes=75, elastic_limit=math.inf)
    said = str(caught[0].message) if caught else "nothing"
    refined = {film_of(M, L).nodes for M, L in GRID}
    return Row(
        "a coarse or narrow grid is detected and refined or reported, never silently wrong",
        f"of its own it takes {min(refined)} to {max(refined)} nodes; M = 1000, L = 20 on 75: “{said}”",
        (
            TESTS + "test_a_grid_that_is_too_coarse_is_reported",
            TESTS + "test_an_accuracy_that_no_grid_gives_is_refused",
            TESTS + "test_a_short_inlet_is_seen",
        ),
        short="" if "too coarse" in said else "not met.",
    )


def _table() -> Row:
    parts, worst = [], 0.0
    for (M, L), (central, minimum) in REFERENCE.items():
        film = film_of(M, L)
        parts.append(f"{M}, {L}: {film.H_central:.3f} / {film.H_minimum:.3f} ({central:.3f} / {minimum:.3f})")
        worst = max(worst, abs(film.H_central / central - 1.0), abs(film.H_minimum / minimum - 1.0))
    return Row(
        "against the table of an independent solution: within 0.5 % at M ≤ 50 (both films)",
        f"at most {100.0 * worst:.2f} % off; M, L: central / minimum H: " + "; ".join(parts),
        (TESTS + "test_films_are_those_of_an_independent_solution",),
        short="" if worst <= 5e-3 else "not met.",
    )


def _orders() -> Row:
    found = {}
    for M, L in ORDERS:
        H = [on_nodes(M, L, nodes).H_central for nodes in (301, 601, 1201)]
        found[M, L] = math.log2((H[0] - H[1]) / (H[1] - H[2]))
    return Row(
        "mesh convergence order shown",
        "order of the central film from 301, 601 and 1201 nodes, 2 expected: "
        + ", ".join(f"M = {M}, L = {L}: {order:.2f}" for (M, L), order in found.items()),
        (TESTS + "test_mesh_error_is_of_second_order",),
    )


def _moes() -> Row:
    off = {(M, L): film_of(M, L).H_minimum / moes_film(M, L) - 1.0 for M, L in GRID}
    worst = max(off, key=lambda key: abs(off[key]))
    mean = float(np.mean([abs(value) for value in off.values()]))
    elastic = max(abs(off[M, L]) for M, L in itertools.product((10.0, 30.0, 100.0), (3.0, 5.0, 10.0, 15.0)))
    return Row(
        "Moes/Venner within its known few per cent",
        f"minimum films of {len(GRID)} pairs are {100.0 * mean:.1f} % off the fit in the mean, M = 10 to 100 "
        f"with L = 3 to 15 at most {100.0 * elastic:.1f} %, all at most {100.0 * abs(off[worst]):.1f} % "
        f"(M = {worst[0]:g}, L = {worst[1]:g})",
        (TESTS + "test_films_are_near_moes_fit",),
    )


def _martin() -> Row:
    found = {M: M * film_of(M, 0.0, 1e-3).H_central for M in (0.3, 0.1, 0.03, 0.01)}
    return Row(
        "the isoviscous-rigid limit (Martin, H = 2.45/M) approached",
        "H M at L = 0: " + ", ".join(f"M = {M:g}: {value:.4f}" for M, value in found.items()) + " (2.448)",
        (TESTS + "test_rigid_bodies_have_martins_film",),
    )


def _hertz() -> Row:
    parts = []
    for M in (10.0, 100.0, 1000.0):
        film = film_of(M, 0.0)
        x = film.x / film.contact.half_width
        inside = np.abs(x) < 0.9
        hertz = film.contact.hertz_pressure * np.sqrt(1.0 - x[inside] ** 2)
        parts.append(f"M = {M:g}: {100.0 * np.max(np.abs(film.pressure[inside] / hertz - 1.0)):.2f} %")
    return Row(
        "the dry limit (Hertz) approached",
        "largest deviation of the pressure from Hertz's within |x| < 0.9 b at L = 0: " + ", ".join(parts),
        (TESTS + "test_heavily_loaded_contacts_have_hertz_pressure",),
    )
