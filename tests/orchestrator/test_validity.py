"""Excursions from the ranges of a film formula, as a run's summary states them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from models.contact.ehl_contact import TABLE_3
from models.quantities import Vector
from models.system import System
from orchestrator.assembly import system_of
from orchestrator.contact_course import ContactCourse, Courses, courses
from orchestrator.contact_course import lines as contact_lines
from orchestrator.overload import lines as overload_lines
from orchestrator.overload import overloads
from orchestrator.scenario_files import load
from orchestrator.validity import excursions, lines

RECORDS = 200


def _run(*changes: str):  # type: ignore[no-untyped-def]
    """The system, and outputs of its contact at random inputs, a quarter of them without load."""
    system = system_of(load("valve-train", changes))
    instance = system.instances["contact"]
    component = instance.component
    random = np.random.default_rng(7)
    p = component.parameters.vector(instance.parameters)
    columns = {name: np.zeros(RECORDS) for name in system.outputs.names}
    drivers = {c.target.variable: str(c.source) for c in system.connections if c.target.instance == "contact"}
    columns["time"] = np.cumsum(random.uniform(1e-6, 1e-4, RECORDS))
    for i in range(RECORDS):
        inputs = {
            "approach": random.uniform(-5e-6, 15e-6),
            "entraining_velocity": random.uniform(-4.0, 4.0),
            "radius_of_curvature": random.uniform(0.005, 0.05),
        }
        y = np.zeros(component.outputs.size)
        x = np.array([random.uniform(0.1e-6, 2e-6)])
        component.flat_output(0.0, x, component.inputs.vector(inputs), p, y)
        for name, value in inputs.items():
            columns[drivers[name]][i] = value
        for name, value in component.outputs.named(y).items():
            columns[f"contact.{name}"][i] = value
    return system, columns


@pytest.fixture(scope="module")
def run():  # type: ignore[no-untyped-def]
    return _run()


def test_shares_and_extremes_agree_with_the_flags_of_the_contact(run) -> None:  # type: ignore[no-untyped-def]
    """Groups are listed exactly if their flag fell under load, with share of time and extremes beyond it."""
    system, columns = run
    found = excursions(system, lambda names: {name: columns[name] for name in names})["contact"]
    loaded = columns["contact.load"] > 0.0
    assert 0.0 < np.mean(loaded) < 1.0
    time = columns["time"]
    ends = 2.0 * time[[0, -1]] - time[[1, -2]]
    stood_for = 0.5 * np.diff(np.r_[ends[0], time, ends[1]], n=1)
    stood_for = stood_for[:-1] + stood_for[1:]  # half of the intervals on both sides
    for group, (low, high) in TABLE_3.items():
        outside = columns[f"contact.{group}_in_range"][loaded] == 0.0
        assert (group in found) == outside.any()
        if group in found:
            assert found[group].share == pytest.approx(
                stood_for[loaded][outside].sum() / stood_for[loaded].sum(), rel=1e-12
            )
            assert found[group].least < low or found[group].most > high
    # U = eta |u| / (E R) with E = pi / compliance, for two equal steels pi E1 / (2 (1 - nu^2)).
    fastest = np.abs(columns["camshaft.entraining_velocity"]) / columns["camshaft.radius_of_curvature"]
    modulus = np.pi * 207e9 / (2.0 * (1.0 - 0.3**2))
    assert found["speed"].most == pytest.approx(0.036 * fastest[loaded].max() / modulus, rel=1e-12)


def test_a_sentence_for_each_contact_and_none_for_another_formula(run) -> None:  # type: ignore[no-untyped-def]
    system, columns = run
    (line,) = lines(excursions(system, lambda names: {name: columns[name] for name in names}))
    assert line.startswith("contact: film formula outside its ranges")
    other = system_of(load("valve-train", ["components.contact.parameters.film_model=dry"]))
    assert excursions(other, lambda names: {name: columns[name] for name in names}) == {}


def test_a_pressure_beyond_the_elastic_limit_is_told_with_its_instant() -> None:
    """Of a made-up history whose pressure is above the limit for one quarter of the time."""
    limit = "components.contact.parameters.elastic_limit='1.5 GPa'"
    system = system_of(load("valve-train", [limit]))
    time = np.linspace(0.0, 0.4, 401)
    pressure = np.where((time >= 0.1) & (time < 0.2), 1.5e9 + 1e9 * np.sin(np.pi * (time - 0.1) / 0.1), 1e9)
    columns = {"time": time, "contact.maximum_pressure": pressure}
    found = overloads(system, lambda names: {name: columns[name] for name in names})
    assert found["contact"].pressure == pytest.approx(2.5e9, rel=1e-12)
    assert found["contact"].time == pytest.approx(0.15, abs=1e-12)
    # 99 records of 401: at 0.1 s the pressure is the limit.
    assert found["contact"].share == pytest.approx(99.0 / 401.0, rel=1e-9)
    (line,) = overload_lines(found)
    assert "2.5 GPa at t = 0.15 s" in line
    assert "1.5 GPa" in line
    columns["contact.maximum_pressure"] = np.minimum(pressure, 1.5e9)
    assert overloads(system, lambda names: {name: columns[name] for name in names}) == {}


def _courses(system: System, columns: Mapping[str, Vector]) -> Courses:
    return courses(system, lambda names: {name: columns[name] for name in names})


def test_a_contact_is_told_with_its_extremes_under_load() -> None:
    """Of a made-up history: half of the time without load, where the film is thinnest and does not count."""
    system = system_of(load("valve-train"))
    time = np.linspace(0.0, 0.4, 401)
    load_ = np.maximum(500.0 * np.cos(np.pi * time / 0.4), 0.0)
    columns = {
        "time": time,
        "contact.load": load_,
        "contact.maximum_pressure": 1e6 * load_,
        "contact.minimum_film_thickness": 1e-6 * (1.0 - 2.0 * time),
        "contact.film_ratio": 5.0 * (1.0 - 2.0 * time),
    }
    found = _courses(system, columns)
    course = found["contact"]
    assert (course.least_load, course.largest_load) == (0.0, 500.0)
    # From 0.2 s on there is none; at 0.2 s it is zero to rounding.
    assert course.lost == pytest.approx(0.5, abs=2.0 / 401.0)
    assert (course.pressure, course.pressure_time) == (5e8, 0.0)
    assert course.film == pytest.approx(0.6e-6, rel=0.01)
    assert course.film_time == pytest.approx(0.2, rel=0.01)
    assert course.film_ratio == pytest.approx(3.0, rel=0.01)
    (line,) = contact_lines(found)
    assert line.startswith(
        "contact: load 0 to 500 N, no contact in 50 % of the time; highest pressure 0.5 GPa"
    )
    assert "least film 0.6" in line
    columns["contact.load"] = np.zeros(401)
    assert _courses(system, columns) == {}


def test_words_for_solved_films_and_smooth_surfaces() -> None:
    """A ratio is said of the film that it is of, none between smooth surfaces, a grid's pressure as such."""
    formula = ContactCourse(1.0, 2.0, 0.0, 1e9, 0.0, 1e-7, 0.0, 0.5)
    solved = replace(formula, solved=True)
    told, smooth = (
        contact_lines({"contact": solved}),
        contact_lines({"contact": replace(solved, film_ratio=0.0)}),
    )
    assert "least film 0.1 µm at t = 0 s, least ratio of the central film to roughness 0.5" in told[0]
    assert "highest pressure 1 GPa at t = 0 s (spikes at a reversal grow with the nodes);" in told[0]
    assert smooth[0].endswith("least film 0.1 µm at t = 0 s, smooth surfaces")
    assert str(formula).endswith(
        "highest pressure 1 GPa at t = 0 s; least film 0.1 µm at t = 0 s, least film ratio 0.5"
    )


def test_of_many_contacts_the_thinnest_films_are_told() -> None:
    course = ContactCourse(1.0, 2.0, 0.0, 1e9, 0.0, 1e-6, 0.0, 5.0)
    many = {f"contact{n}": replace(course, film=1e-6 / (n + 1)) for n in range(7)}
    said = contact_lines(many)
    assert [line.split(":")[0] for line in said[:-1]] == ["contact6", "contact5", "contact4", "contact3"]
    assert said[-1] == "3 more contacts with thicker films: see summary.json"
