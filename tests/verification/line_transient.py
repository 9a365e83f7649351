"""The transient line contact over the cam's cycle: films at the reversals, order, convergence, pressure."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache

import numpy as np

from models.contact.line.grid import REACH
from models.contact.line.history import FilmHistory, film_history
from models.integrator import OK
from models.quantities import Vector
from tests.models.contact.line.cam_cycle import cycle, least_films, motion
from tests.models.contact.line.stepped import NODES, Contact
from tests.models.contact.line.test_transient import RIGID

from .table import Row

TESTS = "models/contact/line/test_transient.py::"
REVERSALS = (144.0, 168.0, 192.0, 216.0)
# µm, of an independent run.
REFERENCE = (0.128, 0.110, 0.133, 0.105)
LEAST, LEAST_AT, NOSE = 0.090, 217.1, 0.62
HIGHEST = (0.48, 0.50)
NOSE_DEG, FLANK_DEG, FLANK = 180.0, 112.0, 1.206
FINE = (0.1, 301)
# As many with twice the reach stand as close in the core.
WIDE_NODES = 401
over_event = cache(cycle)


def rows() -> Iterator[Row]:
    yield _squeeze()
    yield _order()
    yield _forms()
    yield _reversals()
    yield _converged()
    yield _load()
    yield _pressure()
    yield _spike()


def _least(degrees: Vector, film: FilmHistory) -> Vector:
    """µm, at the reversals."""
    return 1e6 * np.interp(REVERSALS, degrees, film.minimum_film_thickness)


def _squeeze() -> Row:
    speed, radius, gap = 0.01, 0.02, 5e-6
    off = {}
    for nodes in (101, 201):
        contact = Contact(nodes=nodes, **RIGID)
        for _ in range(20):
            contact.step(
                1e-6,
                approach=lambda t: -gap + speed * (t - 2e-5),
                entraining_velocity=0.0,
                radius_of_curvature=radius,
            )
        expected = 3.0 * math.pi * 0.036 * speed * radius * math.sqrt(2.0 * radius) * 12e-3 * gap**-1.5
        off[nodes] = contact["load"] / expected - 1.0
    return Row(
        "squeeze term",
        "rigid bodies that approach, load against 3π η V R √(2R) L h^(−3/2): "
        + ", ".join(f"{nodes} nodes {100.0 * value:+.2f} %" for nodes, value in off.items()),
        (
            TESTS + "test_squeezed_isoviscous_film_between_rigid_bodies",
            "models/contact/line/test_kernels.py::test_the_balance_conserves_mass",
        ),
    )


def _order() -> Row:
    def end(steps: int) -> float:
        times = np.linspace(0.0, 1e-3, steps + 1)
        wave = 1.0 + 0.3 * np.sin(2.0 * math.pi * times / 1e-3)
        radius = np.full_like(times, 0.02)
        # So large a tolerance that the given steps are those that are made.
        film = film_history(times, 400.0 * wave, 2.0 * wave, radius, NODES, {"field_tolerance": 0.1})
        return float(film.film_thickness[-1])

    exact = end(1600)
    coarse, fine = (abs(end(steps) - exact) for steps in (50, 100))
    return Row(
        "second order in time with error-controlled steps",
        f"order {math.log2(coarse / fine):.2f} from 50 and 100 steps against 1600; `field_tolerance` of load "
        "and film sets the micro-steps",
        (TESTS + "test_order_two_in_time", TESTS + "test_how_a_step_is_cut_matters_little"),
    )


def _forms() -> Row:
    running = {"entraining_velocity": 2.0, "radius_of_curvature": 0.02}
    back, other = Contact(), Contact(load_is_given=1.0)
    made = [back.step(1e-5, **running, approach=0.3e-6) for _ in range(200)]
    made += [other.step(1e-5, **running, applied_load=back["load"]) for _ in range(200)]
    assert all(status == OK for status in made)
    off = other["film_thickness"] / back["film_thickness"] - 1.0
    return Row(
        "load given (film out) or approach given (load and film out), the second being the FMU's coupling "
        "form; grid that follows the contact width",
        f"an approach of 0.3 µm has {back['load']:.1f} N and {1e6 * back['film_thickness']:.4f} µm; that "
        f"load given, the film differs by {abs(off):.1e}",
        (
            TESTS + "test_a_restored_state_goes_on_to_the_same_bits",
            "models/contact/line/test_hard_cases.py::test_macro_steps_of_any_length_give_one_motion",
        ),
        short="without any load the form with the load given has no film (the bodies would part): it keeps "
        "that of `film_load_floor`; load, pressure and friction are shown as none.",
    )


def _reversals() -> Row:
    degrees, film = over_event(*FINE)
    found = _least(degrees, film)
    event = degrees > 130.0
    least = film.minimum_film_thickness[event]
    off = np.max(np.abs(found / REFERENCE - 1.0))
    parts = ", ".join(
        f"{angle - NOSE_DEG:+.0f}° {h:.4f} ({known})"
        for angle, h, known in zip(REVERSALS, found, REFERENCE, strict=True)
    )
    nose = 1e6 * np.interp(NOSE_DEG, degrees, film.film_thickness)
    return Row(
        "the cam cycle: reversal minima within 3 % of the listed values",
        f"301 nodes, 0.1°, load of a massless spring, in µm: {parts}: at most {100.0 * off:.1f} % off; least "
        f"{1e6 * np.min(least):.4f} at {degrees[event][np.argmin(least)] - NOSE_DEG:+.1f}° ({LEAST} at "
        f"{LEAST_AT - NOSE_DEG:+.1f}°); central film at the nose {nose:.3f} ({NOSE})",
        (TESTS + "test_minimum_films_at_the_reversals_of_the_cam_cycle",),
        short="" if off <= 0.03 else "not met.",
    )


def _converged() -> Row:
    base = _least(*over_event(*FINE))
    changes = {
        f"{nodes} nodes, {step}°": np.max(np.abs(_least(*over_event(step, nodes)) / base - 1.0))
        for step, nodes in ((0.5, 101), (0.5, 201), (0.5, 301), (0.1, 201), (0.05, 301))
    }
    angles = np.array([FLANK_DEG, *REVERSALS])
    wider = least_films(angles, WIDE_NODES, 2.0 * REACH) / least_films(angles, FINE[1]) - 1.0
    degrees, film = over_event(*FINE)
    flank = 1e6 * np.interp(FLANK_DEG, degrees, film.film_thickness)
    return Row(
        "domain, grid and step converged",
        "reversal minima against those of 301 nodes, 0.1°: "
        + ", ".join(f"{name} {100.0 * value:.2f} %" for name, value in changes.items())
        + f"; the grid reaches {REACH:g} times its scale and moves with the contact: central film at 112° "
        f"{flank:.3f} µm ({FLANK} with ±2.4 mm); with twice the reach the reversal minima change by "
        f"{100.0 * np.abs(wider[1:]).max():.2f} %, the film at 112° by {100.0 * wider[0]:.2f} %",
        (
            TESTS + "test_films_of_the_cam_cycle_converge_with_nodes_and_steps",
            TESTS + "test_a_domain_twice_as_wide_changes_little",
        ),
    )


def _load() -> Row:
    step, nodes = FINE
    _, film = over_event(step, nodes)
    given = motion(np.linspace(95.0, 225.0, round(130.0 / step) + 1), 1000.0).load[1:]
    worst = float(np.max(np.abs(film.load / given - 1.0)))
    return Row(
        "worst load error below 1e-4",
        f"{worst:.1e} over {film.load.size} steps",
        (TESTS + "test_minimum_films_at_the_reversals_of_the_cam_cycle",),
        short="" if worst < 1e-4 else "not met.",
    )


def _pressure() -> Row:
    degrees, film = over_event(*FINE)
    found = [1e-9 * np.interp(angle, degrees, film.maximum_pressure) for angle in (144.0, 192.0)]
    outside = [p for p in found if not HIGHEST[0] <= p <= HIGHEST[1]]
    return Row(
        "highest pressure of the trapped dimple at −36 and +12°",
        f"{found[0]:.3f} and {found[1]:.3f} GPa ({HIGHEST[0]:.2f} to {HIGHEST[1]:.2f})",
        ("orchestrator/test_reproduce_films.py::test_across_the_contact",),
        short="higher than the independent run's; docs/contact.md has the values of coarser grids and steps."
        if outside
        else "",
    )


def _spike() -> Row:
    highest = {}
    for nodes in (101, 201, 301):
        degrees, film = over_event(0.5, nodes)
        event = degrees > 130.0
        highest[nodes] = 1e-9 * np.max(film.maximum_pressure[event])
    grows = highest[301] > 1.02 * highest[201]
    return Row(
        "highest pressure of the event, where the trapped oil leaves",
        ", ".join(f"{nodes} nodes {p:.3f} GPa" for nodes, p in highest.items()),
        command="tribocosim reproduce films",
        short="the spike is narrower than the grid's cells: its pressure grows with the nodes; films do not "
        "depend on it."
        if grows
        else "",
    )
