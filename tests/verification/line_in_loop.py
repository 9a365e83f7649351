"""The solved film in coupled runs: against the monolithic reference, saved states, the engine's liner."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import xarray

from models.quantities import Vector
from orchestrator.results import open_result
from tests.models.contact.line import test_transient
from tests.models.contact.line.stepped import Contact

from .shell import summary, tribocosim
from .table import Row

FIELD = "orchestrator/test_ehl_field.py::"
FMU = "fmus/test_contact_field.py::"
REFUSALS = "orchestrator/test_ehl_refusals.py::"
ENERGIES = "models/contact/line/test_energies.py::"
PROMISED = 1e-3
JUDGED = {"contact.load": "load", "contact.minimum_film_thickness": "minimum film"}
PATIENCE = 3600.0  # s
# The engine's first milliseconds: a whole revolution takes minutes.
ENGINE = "stop_time=3 ms"
LEDGER = ("energy.ledger=true", "stop_time=0.2 ms", "reference.enabled=false")
_folders = tempfile.TemporaryDirectory()


@cache
def ran(scenario: str, *settings: str) -> tuple[Path, dict[str, Any]]:
    """Output folder and summary of a run, which other sections read too."""
    out = Path(_folders.name) / f"{scenario}{len(settings)}"
    arguments = [f"--set={text}" for text in settings]
    said = tribocosim("run", scenario, "--no-figures", "--out", str(out), *arguments, patience=PATIENCE)
    assert (out / "summary.json").exists(), said
    return out, summary(out)


def rows() -> Iterator[Row]:
    yield _states()
    yield coupled("valve-train-ehl", "(1000 r/min)")
    yield _engine()
    yield _ledger()


def _states() -> Row:
    contact = test_transient.settled()
    saved, at = contact.x.copy(), contact.t

    def onwards(one: Contact) -> Vector:
        for _ in range(5):
            one.step(7e-6, **{**test_transient.RUNNING, "approach": lambda t: 0.3e-6 + 1e-3 * (t - at)})
        return one.x.copy()

    first = onwards(contact)
    contact.x[:], contact.t = saved, at
    differ = int(np.count_nonzero(onwards(contact) != first))
    return Row(
        '`ehl_contact.fmu` with `film_model = "line_transient"`: its state (pressure, film history) saves '
        "and restores bit-exactly, so that iteration and step control work",
        f"after a restored state {differ} of {first.size} numbers differ",
        (
            FMU + "test_a_solved_film_in_the_fmu_its_rates_and_its_saved_states_to_the_last_bit",
            FIELD + "test_a_run_with_the_field_goes_on_from_a_checkpoint_to_the_last_bit",
            FIELD + "test_what_a_step_of_the_field_leaves_does_not_depend_on_how_often_it_was_tried",
            FIELD + "test_the_fmu_of_the_field_runs_as_the_component_to_the_last_bit",
        ),
        short="" if differ == 0 else "not met.",
    )


def coupled(scenario: str, words: str) -> Row:
    """The run against its reference."""
    _, found = ran(scenario)
    errors = {name: found["errors"][key] for key, name in JUDGED.items()}
    worst = max(error["relative_rms"] for error in errors.values())
    contact = found["contacts"]["contact"]
    parts = ", ".join(
        f"{name} {error['relative_rms']:.1e} (the reference's own uncertainty "
        f"{error['reference_uncertainty']:.1e})"
        for name, error in errors.items()
    )
    return Row(
        f"`{scenario}` {words}: against a monolithic run with the same EHL discretisation 1e-3 relative "
        "RMS in load and in minimum film",
        f"{parts}; {found['macro_steps']} macro steps in {found['coupled_time_s']:.0f} s, reference "
        f"{found['reference_time_s']:.0f} s; load {contact['least_load']:.0f} to "
        f"{contact['largest_load']:.0f} N, least film {1e6 * contact['film']:.4f} µm, highest pressure "
        f"{1e-9 * contact['pressure']:.2f} GPa",
        (FIELD + "test_a_coupled_run_comes_to_the_monolithic_one",),
        command=f"tribocosim run {scenario}",
        short="" if worst <= PROMISED and found["complete"] else "not met.",
    )


def _engine() -> Row:
    out, found = ran("engine-ehl", ENGINE)
    with open_result(out) as result:
        data: xarray.Dataset = result["coupled"].to_dataset()
        films = {
            wall: 1e6 * data[f"{wall}.minimum_film_thickness"].values[1:]
            for wall in ("upper_wall", "lower_wall")
        }
    parts = ", ".join(f"{wall} {np.min(h):.2f} to {np.max(h):.2f} µm" for wall, h in films.items())
    return Row(
        "the liner contact of the engine can use it too",
        f"`engine-ehl`, the first {data['time'].values[-1] * 1e3:.3g} ms: {found['macro_steps']} macro "
        f"steps; minimum films: {parts}",
        (REFUSALS + "test_the_engines_walls_run_with_solved_films",),
        command=f'tribocosim run engine-ehl --set "{ENGINE}"',
        short="impacts and fields together have no monolithic reference; the walls' loads are given, and "
        "films below `film_load_floor` are those of it; only the beginning is run here (a revolution takes "
        "minutes)."
        if found["complete"]
        else "not met.",
    )


def _ledger() -> Row:
    _, found = ran("valve-train-ehl", *LEDGER)
    account = found["energy"]
    bonds = ", ".join(
        f"{name} {1e6 * bond['given']:.3g} µJ given, {1e6 * bond['taken']:.3g} µJ taken"
        for name, bond in account["bonds"].items()
        if "contact" in name
    )
    own = account["components"].get("contact")
    closes = (
        f"; the contact: stored {1e6 * own['stored']:.3g} µJ more, dissipated "
        f"{1e6 * own['dissipated']:.4g} µJ, entrainment and sliding gave {1e6 * own['sourced']:.4g} µJ, "
        f"unaccounted "
        f"{1e6 * own['unaccounted']:.2g} µJ"
        if own
        else ""
    )
    return Row(
        "the contact in the energy ledger of the coupling",
        f"until {1e3 * account['until']:g} ms: {bonds}{closes}",
        (
            ENERGIES + "test_the_account_closes_with_the_order_of_the_steps",
            ENERGIES + "test_a_steady_film_dissipates_exactly_what_it_is_given",
            ENERGIES + "test_an_opening_contact_returns_what_was_stored",
            "models/monolithic/test_implicit.py::test_energies_close_per_component",
        ),
        command=" ".join(["tribocosim run valve-train-ehl", *(f'--set "{text}"' for text in LEDGER)]),
        short="of rough surfaces, what the oil's pressure does where asperities take the room is unaccounted."
        if own
        else "not met.",
    )
