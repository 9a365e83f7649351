"""Limits of stability predicted before the run, and observed in runs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from models.monolithic.course import course
from orchestrator import assembly
from orchestrator.errors import UnstableCouplingError
from orchestrator.masters import GaussSeidel, Iterated, Jacobi
from orchestrator.participants import in_process
from orchestrator.scenario_files import load
from orchestrator.stability.behaviour import Behaviour, hardest, largest_stable
from orchestrator.stability.points import point_at
from orchestrator.stability.responses import Responses
from tests.orchestrator.coupled import grown, in_processes, recorded
from tests.orchestrator.test_linearisation import SPACING, along
from tests.orchestrator.test_stability import LIFT, SIGNALS, difference, estimate, point
from tests.orchestrator.two_masses import two_masses

from .table import Row

TESTS = "orchestrator/test_stability.py::"
# To both sides of the predicted limit.
NEAR = 0.04
COMPARED = (
    *(kind(signal) for kind in (Jacobi, GaussSeidel) for signal in ("linear", "quadratic", "hermite")),
    *(Iterated(signal) for signal in ("linear", "quadratic")),
)


def rows() -> Iterator[Row]:
    yield _two_masses()
    yield _valve_train()
    yield _errors()
    yield Row(
        "`tribocosim analyse SCENARIO`: spectral radius against macro step for each master, extrapolation "
        "and "
        "order, the largest stable step, and a recommended master",
        "stability.nc, stability.csv, stability.png; the advised master, step and order keep the tolerance "
        "in "
        "the test",
        (
            "orchestrator/test_stability_command.py::"
            "test_the_command_prints_and_writes_tables_and_a_figure_and_its_advice_keeps_the_tolerance",
            TESTS
            + "test_the_macro_step_read_out_of_a_master_has_the_spectral_radius_of_the_one_derived_by_hand",
        ),
        command="tribocosim analyse valve-train",
        short="impacts are outside of it; valve-train-16v takes five minutes.",
    )
    yield _responses()


def _name(master) -> str:
    return f"{type(master).__name__} {master.extrapolation}"


def _two_masses() -> Row:
    system = two_masses(coupling_stiffness=400.0)
    parts, wrong = [], []
    for master in COMPARED:
        behaviour = Behaviour(point(system), master)
        limit = largest_stable(behaviour, 1e-3, 0.5, [])
        factors = []
        for share in (1.0 - NEAR, 1.0 + NEAR):
            rate = np.log(behaviour.at(share * limit).radius)
            factors.append(grown(system, in_processes(system), master, share * limit, int(10.0 / abs(rate))))
        parts.append(f"{_name(master)} {1e3 * limit:.1f} ms ({factors[0]:.1e}, {factors[1]:.1e})")
        if not factors[0] <= 1.0 < factors[1]:
            wrong.append(_name(master))
    return Row(
        "the largest stable step, checked against observed instability",
        f"two masses: predicted limit, and by what a run's values grow at {1 - NEAR:g} and {1 + NEAR:g} of "
        "it: " + "; ".join(parts),
        (TESTS + "test_runs_of_the_masses_grow_beyond_the_predicted_limit_and_decay_below_it",),
        short=f"not met by {', '.join(wrong)}." if wrong else "",
    )


def _valve_train() -> Row:
    scenario = load("valve-train")
    system = assembly.at_start(scenario, assembly.system_of(scenario))
    lift = course(system, np.linspace(0.0, LIFT, 901), 1e-9)
    points = [point_at(system, lift, row, []) for row in range(0, 901, 180)]
    column = system.outputs.names.index("contact.load")
    parts, met = [], True
    for master in (GaussSeidel("linear"), Jacobi("linear")):
        _, limit = hardest(points, master, 1e-6, 1e-4)
        said, errors = [], []
        for share in (0.8, 1.25):
            try:
                run = recorded(system, master, share * limit, LIFT)
                truth = course(system, run.times, 1e-9).outputs[:, column]
                errors.append(difference(run["contact.load"], truth).relative_rms)
                said.append(f"error {errors[-1]:.1e}")
            except UnstableCouplingError:
                errors.append(np.inf)
                said.append("named unstable")
        met &= errors[0] < 1e-2 and errors[1] > 1.0
        parts.append(f"{_name(master)} {1e6 * limit:.1f} us: at 0.8 of it {said[0]}, at 1.25 {said[1]}")
    return Row(
        "the same on the valve train",
        "; ".join(parts),
        (TESTS + "test_the_valve_train_runs_below_the_predicted_limit_and_runs_away_beyond",),
        short="" if met else "not met.",
    )


def _responses() -> Row:
    system = two_masses()
    where = along(system, 0.2, SPACING)
    made = {n: Responses(n, in_process(n, i), system, SPACING) for n, i in system.instances.items()}
    by_responses, by_equations = point_at(system, where, 20, [], made), point_at(system, where, 20, [])
    worst = max(
        abs(Behaviour(by_responses, kind).at(h).radius / Behaviour(by_equations, kind).at(h).radius - 1.0)
        for kind in (Jacobi("linear"), GaussSeidel("hermite"), Iterated("quadratic"))
        for h in (1e-2, 5e-2, 0.2)
    )
    tests = "orchestrator/test_linearisation.py::"
    return Row(
        "linearises the participants about the start, by perturbation through get/set state",
        f"two masses: spectral radii from responses and from equations differ by {worst:.0e} at most; "
        f"residuals {max(m.residual for m in made.values()):.0e}",
        (
            tests + "test_both_ways_of_linearisation_give_one_spectral_radius",
            tests + "test_responses_of_the_valve_train_have_the_poles_of_its_equations",
            tests + "test_a_run_of_a_foreign_fmu_grows_beyond_the_limit_predicted_by_its_responses",
        ),
        command="tribocosim analyse valve-train --responses",
        short="about twelve instants, of which the start is one; our own FMUs only with --responses.",
    )


def _errors() -> Row:
    ratios = {}
    for kind in (Jacobi, GaussSeidel, Iterated):
        for signal in SIGNALS:
            expected, measured = estimate(two_masses(), kind(signal), 2e-2, 4.0)
            ratios[f"{kind.__name__} {signal}"] = np.max(np.abs(expected / measured - 1.0))
    worst = max(ratios, key=lambda name: ratios[name])
    return Row(
        "errors estimated before the run",
        f"two masses, {len(ratios)} masters: off by at most {100 * ratios[worst]:.0f} % ({worst})",
        (
            TESTS + "test_estimated_errors_of_the_masses_are_those_of_a_run",
            TESTS + "test_the_estimated_error_of_the_contact_load_is_that_of_a_run_within_a_factor_of_two",
        ),
    )
