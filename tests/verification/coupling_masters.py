"""Signals, masters, partitions and substeps: what is there, and what shows it."""

from __future__ import annotations

import re
from collections.abc import Iterator

from models.catalogue import CATALOGUE
from orchestrator.errors import NonConvergenceError, RunError
from orchestrator.masters import MASTERS, GaussSeidel, Iterated, Newton
from orchestrator.masters.acceleration import ACCELERATIONS
from orchestrator.signals import DEGREES
from tests.orchestrator.test_masters import STIFF, coupled
from tests.orchestrator.two_masses import two_masses

from .table import Row

MASTER_TESTS = "orchestrator/test_masters.py::"
SUBSTEPS = "orchestrator/test_substeps.py::"
NOT_CONVERGING = (
    "test_a_fixed_point_that_does_not_contract_is_an_error_with_connection_iterations_and_contraction"
)
STEP = 8e-3


def rows() -> Iterator[Row]:
    yield Row(
        "signals: hold, linear, quadratic, cubic Hermite from values and rates at both ends; rates ordinary "
        "outputs, Taylor coefficients ordinary optional inputs",
        f"{', '.join(DEGREES)}; FMUs give `der(<output>)` and take `<input>_der1` to `_der3`, 0 if left "
        "alone",
        (
            MASTER_TESTS + "test_signals_reproduce_polynomials_of_their_degree",
            "fmus/test_participant.py::test_values_and_rates_are_equal",
            "models/test_rates.py::test_rates_against_the_true_motion",
        ),
    )
    yield Row(
        "masters: Jacobi, Gauss-Seidel (order from the graph, or given), iterated with Aitken, Anderson / "
        "IQN-ILS, interface Newton",
        f"{', '.join(MASTERS)}; acceleration {', '.join(ACCELERATIONS)}",
        (
            MASTER_TESTS + "test_all_masters_agree_in_the_limit",
            MASTER_TESTS + "test_acceleration_solves_a_linear_fixed_point_that_plain_iteration_cannot",
            MASTER_TESTS + "test_the_iterated_master_converges_where_the_explicit_one_is_unstable",
        ),
    )
    yield _accelerated()
    yield _not_converging()
    yield Row(
        "partitions: only the strongly connected, stiff part is iterated",
        "strongly connected participants, or those that `iterate` names; the loop of the valve train is "
        "contact "
        "and valve",
        ("orchestrator/test_stability.py::test_the_loop_of_the_valve_train_is_contact_and_valve",),
        command="tribocosim run valve-train-controlled",
    )
    yield Row(
        "multirate: a participant with its own substep",
        f"`substeps` of a component; {len(CATALOGUE)} components can have them",
        (
            SUBSTEPS + "test_a_participant_that_follows_polynomials_gets_the_same_however_they_are_cut",
            SUBSTEPS + "test_substeps_make_held_inputs_converge",
        ),
        command="tribocosim run valve-train --set components.contact.substeps=2",
    )


def _accelerated() -> Row:
    """On the stiff split of the tests, at a step where the explicit exchange is unstable."""
    masters = {name: Iterated("linear", acceleration=name) for name in ACCELERATIONS}
    parts, failed = [], []
    for name, master in {
        **masters,
        "newton": Newton("linear"),
        "gauss_seidel": GaussSeidel("linear"),
    }.items():
        try:
            _, statistics = coupled(two_masses(**STIFF), master, STEP)
            parts.append(f"{name} {statistics.iterations / statistics.macro_steps:.1f}")
        except RunError as error:
            parts.append(f"{name} ends with {type(error).__name__}")
            if name not in ("none", "gauss_seidel"):
                failed.append(name)
    return Row(
        "iteration where an explicit master is unstable",
        f"two masses, coupling of {STIFF['coupling_stiffness']:g} N/m, {1e3 * STEP:g} ms, passes a step: "
        + ", ".join(parts),
        (MASTER_TESTS + "test_the_iterated_master_converges_at_second_order_on_the_stiff_split",),
        short=f"{', '.join(failed)} does not converge here." if failed else "",
    )


def _not_converging() -> Row:
    said = "nothing"
    try:
        coupled(two_masses(**STIFF), Iterated("linear", acceleration="none", maximum_iterations=12), 5e-2)
    except NonConvergenceError as error:
        said = str(error)
    named = all(re.search(part, said) for part in (r"->", r"in \d+ iterations", r"contraction [\d.]+"))
    return Row(
        "non-convergence shrinks the step or ends with an error naming the connection, the iterations and "
        "the contraction seen",
        f"“{said}”; with step control the step shrinks",
        (MASTER_TESTS + NOT_CONVERGING,),
        short="" if named else "not met.",
    )
