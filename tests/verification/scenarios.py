"""Every shipped scenario through the command line, and what a run leaves behind."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

from orchestrator.scenario_files import shipped

from .shell import summary, tribocosim
from .table import Row

CLI = "orchestrator/test_command_line.py::"
MASTERS = "orchestrator/test_masters.py::"
KEYS = (
    "scenario",
    "macro_steps",
    "rejected_steps",
    "iterations",
    "wall_time_s",
    "coupled_time_s",
    "reference_time_s",
    "reference_uncertainty",
    "errors",
)
NOTES = {
    "slider-crank": "impacts amplify rounding: at the default reference tolerance the two reference methods "
    "differ as much as the coupled run does from them.",
    "engine": "its length is 120 ms, two turns of the camshaft.",
}


def rows() -> Iterator[Row]:
    yield from _orchestrator()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for scenario in sorted(shipped()):
            yield _scenario(scenario, folder / scenario)
        yield from _masters(folder)
        yield _left_behind(folder / "valve-train")
    yield from _commands()


def _scenario(name: str, out: Path) -> Row:
    figures = [] if name == "valve-train" else ["--no-figures"]
    done = tribocosim("run", name, "--out", str(out), *figures)
    found = summary(out)
    parts = [
        f"{variable} {found['errors'][variable]['relative_rms']:.1e} (allowed {allowed:.0e}, reference ± "
        f"{found['errors'][variable]['reference_uncertainty']:.0e})"
        for variable, allowed in found["tolerance"].items()
    ]
    return Row(
        f"scenario `{name}`",
        f"relative RMS: {', '.join(parts)}; {found['macro_steps']} macro steps; exit status {done.status}",
        ("orchestrator/test_scenario.py::test_shipped_scenarios_make_a_system",),
        command=f"tribocosim run {name}",
        short=NOTES.get(name, "") if done.status == 0 else f"{found['message']}, {found['verdict']}.",
    )


def _masters(folder: Path) -> Iterator[Row]:
    parts = []
    for master in ("jacobi", "iterated"):
        out = folder / master
        done = tribocosim(
            "run",
            "valve-train",
            "--master",
            master,
            "--set=stop_time=60 ms",
            "--out",
            str(out),
            "--no-figures",
        )
        errors = summary(out)["errors"]
        load, film = (errors[f"contact.{v}"]["relative_rms"] for v in ("load", "film_thickness"))
        parts.append(
            f"{master}: load {load:.1e}, film {film:.1e}, {summary(out)['iterations']} iterations of "
            f"{summary(out)['macro_steps']} steps, exit status {done.status}"
        )
    yield Row(
        "the other masters on FMUs, by `--master NAME`",
        f"one turn of valve-train, relative RMS: {'; '.join(parts)}",
        (MASTERS + "test_all_masters_agree_in_the_limit",),
        command="tribocosim run valve-train --master NAME",
    )


def _left_behind(out: Path) -> Row:
    found, names = summary(out), sorted(path.name for path in out.iterdir())
    lacking = [key for key in KEYS if key not in found]
    pictures = len(list((out / "figures").glob("*.png")))
    return Row(
        "`run` writes netCDF, CSV, PNG figures, resolved scenario and summary.json with the keys stated; "
        "errors "
        "by `participant.variable` with `max_abs`, `rms`, `relative_rms`",
        f"{', '.join(names)}; {pictures} figures; keys lacking: {lacking or 'none'}; "
        f"{len(found['errors'])} variables compared",
        (
            CLI + "test_a_run_leaves_result_csv_figures_scenario_and_summary",
            CLI + "test_summary_has_what_tools_rely_on",
            CLI + "test_the_resolved_scenario_runs_identically",
            "orchestrator/test_results.py::test_csv_is_in_cross_check_layout_and_exact",
        ),
    )


def _orchestrator() -> Iterator[Row]:
    yield Row(
        "participants: FMU with preallocated arrays, in-process",
        'both in every scenario: `participant = "fmu"` or `"in-process"`',
        ("fmus/test_agreement.py::test_fmu_equals_component",),
    )
    yield Row(
        "masters Jacobi, Gauss-Seidel, iterated (fixed point with rollback, Aitken or Anderson)",
        "see convergence",
        (
            MASTERS + "test_acceleration_solves_a_linear_fixed_point_that_plain_iteration_cannot",
            MASTERS + "test_the_iterated_master_converges_where_the_explicit_one_is_unstable",
            MASTERS + "test_participants_may_be_listed_in_any_order_for_jacobi",
        ),
    )
    yield Row(
        "input hold, linear and quadratic extrapolation",
        "polynomials of their degree are reproduced",
        (MASTERS + "test_signals_reproduce_polynomials_of_their_degree",),
        short="FMUs get the polynomials by their own inputs `<input>_der1`, `_der2`; a foreign FMU without "
        "them "
        "is held.",
    )
    yield Row(
        "initialisation of direct-feedthrough loops",
        "flywheel, camshaft and contact in every scenario; a loop without a start that fits is an error",
        ("models/test_system.py::test_algebraic_loop_of_free_flywheel_and_rigid_camshaft",),
    )
    yield Row(
        "observers, scenario files (TOML), comparison per interface variable",
        "films and loads apart; schema in docs/scenario.schema.json",
        (
            "orchestrator/test_scenario.py::test_written_scenario_gives_the_same_system_bit_for_bit",
            "orchestrator/test_scenario.py::test_published_schema_is_current",
            "models/test_reference.py::test_difference_is_relative_to_the_references_spread",
        ),
    )


def _commands() -> Iterator[Row]:
    listed = tribocosim("scenarios")
    yield Row(
        "`tribocosim scenarios`, `tribocosim fmu build|validate|info`",
        f"{len(listed.output.splitlines())} scenarios, exit status {listed.status}",
        (CLI + "test_listing_and_version", CLI + "test_fmu_commands"),
    )
    yield Row(
        "exit status 0 only within the scenario's stated tolerance of the reference",
        "1 outside, 2 mistake, 3 failed, 4 not compared, 130 interrupted",
        (CLI + "test_too_tight_a_tolerance_is_not_a_success",),
    )
