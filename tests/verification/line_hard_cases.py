"""The solved film with bad input and where it is hard."""

from __future__ import annotations

import dataclasses
import math
import tempfile
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from models.contact.line.line_contact import LineContact
from models.contact.line.steady import LineContactWarning, solve_steady
from models.integrator import NOT_CONVERGED, OK
from models.quantities import Vector
from tests.models.contact.line import test_hard_cases as hard
from tests.models.contact.line.cam_cycle import cycle
from tests.models.contact.line.stepped import Contact
from tests.models.contact.line.test_steady import CAM
from tests.orchestrator.test_ehl_refusals import FALLING

from .shell import tribocosim
from .table import Row

HARD = "models/contact/line/test_hard_cases.py::"
STEADY = "models/contact/line/test_steady.py::"
TRANSIENT = "models/contact/line/test_transient.py::"
HISTORY = "models/contact/line/test_history.py::"
VALIDITY = "orchestrator/test_validity.py::"
REFUSALS = "orchestrator/test_ehl_refusals.py::"
# Steps with jumps: each takes many micro-steps.
JUMPS = 150


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as name:
        yield _refused(Path(name))
        yield _discard(Path(name))
    yield _yielding()
    yield _opening()
    yield _reversal()
    yield _rest()
    yield _jumps()


def _said(**change: object) -> str:
    try:
        dataclasses.replace(CAM, **change)  # type: ignore[arg-type]
    except ValueError as error:
        return f"“{error}”"
    return "nothing"


def _refused(folder: Path) -> Row:
    said = [
        _said(radius=-0.03),
        _said(length=0.0),
        _said(lubricant=CAM.lubricant._replace(viscosity=0.0)),
        *(
            str(tribocosim("run", "valve-train-ehl", f"--set=components.contact.parameters.{name}={value}",
                           "--out", str(folder / name)))
            for name, value in (("length", "0"), ("viscosity", "-0.01"))
        ),
    ]  # fmt: skip
    return Row(
        "non-positive radius, length, viscosity",
        "; ".join(said),
        (
            STEADY + "test_what_is_no_contact_is_refused",
            HARD + "test_inputs_that_make_no_sense_end_the_step_and_leave_no_trace",
            HARD + "test_an_input_outside_its_range_is_named",
        ),
        short="not met." if "nothing" in said else "",
    )


def _discard(folder: Path) -> Row:
    file, out = folder / "falling.toml", folder / "falling"
    file.write_text(FALLING, "utf-8")
    said = tribocosim("run", str(file), "--no-figures", "--out", str(out))
    contact = hard.Contact()
    made = [contact.step(1e-5, **hard.RUNNING) for _ in range(3)]
    before = contact.x.copy()
    status = contact.step(1e-5, **{**hard.RUNNING, "approach": math.nan})
    kept = np.array_equal(before, contact.x) and all(one == OK for one in made)
    return Row(
        "a step that doesn't converge is halved and, if hopeless, ends the step with a discard that the "
        "master can act on, state unharmed",
        f"a radius that falls through zero: {said}; a step with an approach that is no number is "
        f"{'refused' if status == NOT_CONVERGED else 'made'}, the state {'kept' if kept else 'changed'}",
        (
            TRANSIENT + "test_a_step_that_cannot_be_made_leaves_the_state_as_it_was",
            REFUSALS + "test_a_radius_that_is_not_positive_is_named_and_the_step_leaves_no_trace",
            REFUSALS + "test_a_run_ends_where_the_radius_vanishes_and_keeps_what_was_before",
        ),
        short="" if kept and status == NOT_CONVERGED and said.status == 3 else "not met.",
    )


def _yielding() -> Row:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", LineContactWarning)
        contact: LineContact = dataclasses.replace(CAM, load=2e4)
        solve_steady(contact, elastic_limit=1e9)
    said = str(caught[0].message) if caught else "nothing"
    return Row(
        "load beyond the elastic limit (warn with the pressure)",
        f"steady: “{said}”; a coupled run says it at its end with instant and share of the time",
        (
            STEADY + "test_pressure_beyond_the_elastic_limit_is_reported",
            VALIDITY + "test_a_pressure_beyond_the_elastic_limit_is_told_with_its_instant",
        ),
        short="" if "above the elastic limit" in said else "not met.",
    )


def _opening() -> Row:
    contact, period = Contact(), 4e-4
    loads, apart, off = [], [], []
    made = []
    for _ in range(400):
        gap = 24e-6 - 26e-6 * math.cos(2.0 * math.pi * (contact.t + 1e-5) / period)
        made.append(
            contact.step(
                1e-5,
                **{
                    **hard.RUNNING,
                    "approach": lambda t: -24e-6 + 26e-6 * math.cos(2.0 * math.pi * t / period),
                },
            )
        )
        loads.append(contact["load"])
        if gap > 30e-6:
            apart.append(contact["load"])
            off.append(contact["film_thickness"] / gap - 1.0)
    return Row(
        "contact opening (load zero, film from geometry, no division by zero) and closing again",
        f"opened by 50 µm and closed ten times in {sum(one == OK for one in made)} of {len(made)} steps: "
        f"load up to {max(loads):.0f} N, from {min(apart):.2g} to {max(apart):.2g} N where the gap is beyond "
        f"30 µm, and there the film is the gap to {max(map(abs, off)):.1e}",
        (
            HARD + "test_a_contact_opens_and_closes_ten_times",
            HARD + "test_an_open_contact_at_rest_stays_open_whatever_its_gap",
            TRANSIENT + "test_a_contact_opens_and_closes",
        ),
        short="not always zero: oil that is entrained or squeezed bears load between bodies apart."
        if max(apart) > 0.0
        else "",
    )


def _reversal() -> Row:
    degrees, film = cycle(0.5, 101)
    kept: Vector = film.minimum_film_thickness[degrees > 130.0]
    return Row(
        "entraining velocity passing zero",
        f"four reversals of the cam: least film {1e6 * np.min(kept):.4f} µm, load error "
        "as in the cycle above; standing still for 50 ms and starting again by test",
        (
            HARD + "test_entrainment_stops_for_long_and_starts_again",
            HISTORY + "test_the_mirrored_drive_gives_mirrored_films_through_a_reversal",
        ),
    )


def _rest() -> Row:
    started, running = Contact(), Contact()
    for _ in range(200):
        started.step(2e-5, **{**hard.RUNNING, "entraining_velocity": lambda t: min(1.0, t / 1e-3)})
        running.step(2e-5, **hard.RUNNING)
    off = started["film_thickness"] / running["film_thickness"] - 1.0
    return Row(
        "start from rest",
        f"ramp of 1 ms from rest, film after 4 ms against that of a running start: {abs(off):.1e} off",
        (
            HARD + "test_a_start_from_rest_comes_to_the_film_of_a_running_start",
            HARD + "test_a_start_far_from_balance_is_made_in_one_long_step",
        ),
    )


def _jumps() -> Row:
    random, refused, touched = np.random.default_rng(5), 0, 0
    contact = Contact(load_is_given=1.0)
    for _ in range(JUMPS):
        before = contact.x.copy()
        status = contact.step(
            10.0 ** random.uniform(-6.0, -3.5),
            applied_load=random.choice([0.0, random.uniform(1.0, 3000.0)]),
            entraining_velocity=random.choice([0.0, random.uniform(-5.0, 5.0)]),
            radius_of_curvature=hard.RADIUS * random.uniform(0.7, 1.4),
        )
        refused += status != OK
        touched += status != OK and not np.array_equal(before, contact.x)
    return Row(
        "robust: jumps of load, velocity and radius at once",
        f"{JUMPS - refused} of {JUMPS} steps made, {refused} discarded, {touched} of them with a trace",
        (
            HARD + "test_jumps_are_survived_or_refused_without_a_trace",
            HARD + "test_random_walks_are_made_step_by_step",
            HARD + "test_random_walks_with_other_numbers_of_nodes",
        ),
        short="steps with jumps, which no mechanism makes, may be discarded." if refused else "",
    )
