"""Errors by refinement, and step control of FMUs that cannot restore their state or tell of no contact."""

import math
import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tribocosim
from models.core.difference import Difference, difference, time_weights
from models.core.remedies import in_command_line, in_python
from orchestrator.run.comparison import VariableError, advise, divide, verdict
from orchestrator.run.reference import extrapolate
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system
from orchestrator.scenario.warnings import list_warnings
from orchestrator.stepping import RefinedSteps

from .c_fmus import fmu
from .runs import completed, exact_position, masses, public, ran, recorded, scenario

TIMES = np.linspace(0.0, 1.0, 41)


@given(order=st.floats(0.6, 5.5), scale=st.floats(1e-6, 10.0), slope=st.floats(-3.0, 3.0))
def test_an_error_of_one_order_is_extrapolated_exactly(order, scale, slope):
    """To rounding of the values, over what the extrapolation divides by."""
    true, error = np.sin(7.0 * TIMES), scale * (1.0 + slope * TIMES**2)
    runs = [true + error * step**order for step in (1.0, 0.5, 0.25)]
    limit, _, found = extrapolate(*runs, np.ones(len(TIMES)))
    assert found == pytest.approx(order, abs=1e-7)
    np.testing.assert_allclose(limit, true, atol=1e-12 + 1e-8 * scale)


def test_runs_that_do_not_converge_have_no_order():
    """The uncertainty is then the whole difference of the runs."""
    coarse, half, quarter = (np.sin(TIMES + phase) for phase in (0.0, 0.1, 0.3))
    limit, other, order = extrapolate(coarse, half, quarter, np.ones(len(TIMES)))
    assert np.isnan(order)
    assert limit is quarter
    assert other is coarse


def compare_methods(
    name: str, changes: dict[str, Any], variable: str, case: str, record: Any
) -> dict[str, float]:
    """The error by refinement, which must be that against the monolithic reference."""
    plain = tribocosim.load(name).with_(changes)
    against = {
        method: tribocosim.run(plain.with_({"reference.method": method})).summary["errors"]
        for method in ("monolithic", "refinement")
    }
    true, found = against["monolithic"][variable], against["refinement"][variable]
    own = found["reference_uncertainty"] + true["reference_uncertainty"]
    label = f"{case}: {variable} by refinement, relative RMS error"
    record("Coupling", label, found["relative_rms"], true["relative_rms"], "monolithic", tolerance=own)
    assert own < 0.1 * true["relative_rms"]
    return dict(found)


@pytest.mark.parametrize(
    ("master", "signal", "expected"),
    [
        pytest.param("jacobi", "hold", 1.0, marks=pytest.mark.long),
        pytest.param("jacobi", "linear", 2.0, marks=pytest.mark.long),
        pytest.param("jacobi", "quadratic", 3.0, marks=pytest.mark.long),
        pytest.param("gauss_seidel", "linear", 2.0, marks=pytest.mark.long),
        ("gauss_seidel", "hermite", 4.0),
    ],
)
def test_errors_by_refinement_are_those_against_the_monolithic_reference(master, signal, expected, record):
    """Of the quarter car, within both uncertainties."""
    changes = {"master.name": master, "master.extrapolation": signal}
    case = f"quarter car, {master} {signal}, 1 ms"
    found = compare_methods("quarter-car", changes, "chassis.position", case, record)
    case += ": chassis.position by refinement, order"
    record("Coupling", case, found["order"], expected, "order of the signal", tolerance=0.2)


@pytest.mark.long
@pytest.mark.parametrize(
    ("master", "signal", "estimator", "expected"),
    [
        ("jacobi", "linear", "step_doubling", 2.0),
        pytest.param("gauss_seidel", "linear", "step_doubling", 2.0, marks=pytest.mark.long),
        pytest.param("gauss_seidel", "linear", "defect", 2.0, marks=pytest.mark.long),
        pytest.param("jacobi", "linear", "defect", 2.0, marks=pytest.mark.long),
    ],
)
def test_errors_by_refinement_of_controlled_steps_are_those_against_the_monolithic_reference(
    master, signal, estimator, expected, record
):
    """Of the quarter car, within both uncertainties: halves of the steps that were found keep the order."""
    control = {"step_control.relative": 1e-5, "step_control.estimator": estimator}
    changes = {"master.name": master, "master.extrapolation": signal, **control}
    case = f"quarter car, {master} {signal}, {estimator} 1e-5"
    found = compare_methods("quarter-car", changes, "chassis.position", case, record)
    record("Coupling", f"{case}, order", found["order"], expected, "order of the signal", tolerance=0.2)


@pytest.mark.parametrize(
    ("changes", "case"),
    [
        ({"step_control.relative": 1e-6}, "steps controlled to 1e-6"),
        pytest.param(
            {"event_tolerance": 1e-9, "macro_step": 5e-4},
            "steps of 0.5 ms and located events",
            marks=pytest.mark.long,
        ),
    ],
)
def test_errors_by_refinement_stay_true_over_located_events(changes, case, record):
    """A bouncing mass: its contacts come at other instants where the error is smaller."""
    found = compare_methods("bouncing-mass", changes, "mass.position", f"bouncing mass, {case}", record)
    assert found["order"] == pytest.approx(3.0, abs=0.1)  # of quadratic signals


@pytest.mark.parametrize(
    "changes",
    [
        {"macro_step": 4e-3},
        pytest.param({"macro_step": 1e-3}, marks=pytest.mark.long),
        pytest.param({"step_control": {"estimator": "defect", "relative": 1e-3}}, marks=pytest.mark.long),
    ],
)
def test_the_error_of_third_party_fmus_is_that_against_the_exact_solution(changes, tmp_path):
    """Two masses, one an FMU of unknown equations that holds its inputs, against their matrix exponential."""
    one = masses("held_mass", tmp_path, reference={}, tolerance={"first.position": 1e-3}, **changes)
    summary, found = ran(one, tmp_path / "out")
    exact = exact_position(found["time"])
    error = summary.errors["first.position"]
    true = difference(found["first.position"], exact, weights=time_weights(found["time"]))
    assert summary.reference_method == "refinement"
    assert error.relative_rms == pytest.approx(true.relative_rms, abs=error.uncertainty.relative_rms)
    assert error.order == pytest.approx(2.0, abs=0.1)
    assert summary.exit_status == (0 if true.relative_rms < 1e-3 else 1)


def test_the_coupling_is_named_as_cause_and_the_advice_brings_the_run_within_its_tolerance():
    """Of the quarter car with linear signals and refinement: what to set is read from the verdict."""
    changes = {"macro_step": 2e-3, "master.extrapolation": "linear", "reference.method": "refinement"}
    changes |= {f"components.{name}.participant": "in-process" for name in ("wheel", "chassis")}
    changes |= {"stop_time": 0.5, "output_step": 2e-3}
    plain = tribocosim.load("quarter-car").with_(changes)
    verdict = tribocosim.run(plain).summary["verdict"]
    cause, _, rest = verdict.partition("so the coupling is its cause")
    assert re.search(r"falls with the power (2|1\.9|2\.1) of the steps, $", cause)
    assert "own solvers" in rest
    advised = dict(re.findall(r"--set '?([\w.]+)=([\w.]+(?: s)?)", rest))
    assert set(advised) == {"macro_step", "master.extrapolation"}
    for path, value in advised.items():
        assert tribocosim.run(plain.with_({path: value})).summary["exit_status"] == 0, (path, value)


def made_error(relative, own=0.0, tolerance=1e-3, order=None):
    return VariableError(relative, relative, relative, Difference(own, own, own), tolerance, order)


@pytest.mark.plain
@pytest.mark.parametrize(
    ("error", "said"),
    [
        (made_error(2e-4, 7e-4), "within the tolerance"),
        (made_error(7.6e-4, 8e-4, order=2.0), "not known to be within the tolerance: a.x: relative RMS "),
        (made_error(1.2e-3, 8e-4), "not known to be within the tolerance: a.x: relative RMS error 0.0012, "),
        (made_error(2.6e-3, 8e-4), "outside the tolerance: a.x: relative RMS error 0.0026 > 0.001"),
        (made_error(1.0004e-3), "outside the tolerance: a.x: relative RMS error 0.0010004 > 0.001"),
    ],
)
def test_a_verdict_is_sure_where_error_and_uncertainty_are(error, said):
    """On one side of the tolerance together, in digits that show it."""
    within, text = verdict({"a.x": error})
    assert text.startswith(said)
    assert within == (said == "within the tolerance")
    assert ("reference.method = 'monolithic'" in text) == (error.order is not None)


@pytest.mark.plain
def test_without_a_clear_order_no_cause_is_named():
    """Of public FMUs whose own solvers' errors change with the steps; both offer model exchange."""
    parts = {name: {"participant": public("reference-fmus-3/VanDerPol.fmu")} for name in ("a", "b")}
    one = scenario(parts, connections=[], tolerance={"a.x0": 1e-3}, reference={"method": "refinement"})
    said = in_command_line(advise(one, {"a.x0": made_error(2e-3)}, {"a.x0": 0.58}, []))
    assert "power 0.58 of the steps: no clear order, so its cause is not known" in said
    assert "own solvers of a, b" in said
    for action in ("reference.method=monolithic", "components.b.interface=model_exchange"):
        assert f"--set {action}" in said


@pytest.mark.plain
@given(parts=st.floats(1.0, 50.0), step=st.sampled_from([1e-3, 2.5e-3, 0.1, 4.0]))
def test_an_advised_step_is_as_long_as_it_may_be(parts, step):
    """It divides the run in numbers of three digits, of which the ones farthest apart are 1 and 1.25, and
    1.28 and 1.6. A run of few steps gets a hundred, as its warning says."""
    one = load("quarter-car", ["stop_time=4 s", f"macro_step={step} s"])
    found, longest = divide(one, parts), min(step / parts, 4.0 / 100 if step > 1.0 else 4.0)
    assert 0.75 * longest < found <= longest * (1.0 + 1e-9)
    assert 4.0 / found == pytest.approx(round(4.0 / found), rel=1e-9)


@pytest.mark.plain
def test_an_error_that_halved_steps_leave_is_the_own_solvers():
    """Of two errors one falls with the steps; what is said first is what remains."""
    own = made_error(1e-2, tolerance=1e-4)
    one = load("quarter-car")
    said = in_python(advise(one, {"a.x": own, "b.y": own}, {"a.x": 0.0, "b.y": 2.0}, ["a"]))
    first, second = said.removeprefix("; ").split("; ", 1)
    assert first.startswith("halved steps leave 100 % of the error of a.x, so the own solvers of a")
    assert "model_exchange" in first
    assert "error of b.y falls with the power 2" in second


def test_equations_are_advised_before_steps_and_no_signal_that_nobody_follows():
    """Of an FMU that holds its only input and offers model exchange; by that it follows signals."""
    table = {"participant": public("reference-fmus-3/Feedthrough.fmu")}
    source = {"participant": public("reference-fmus-3/VanDerPol.fmu"), "interface": "model_exchange"}
    name = "through.Float64_continuous_output"
    lines = ["one.x0 -> through.Float64_continuous_input"]
    signals = {"name": "jacobi", "extrapolation": "linear"}
    errors = {name: made_error(5e-3)}
    parts = {"one": source, "through": table}
    closed = scenario(parts, connections=lines, master=signals)
    said = in_command_line(advise(closed, errors, {name: 1.0}, []))
    inside = "--set components.through.interface=model_exchange"
    assert said.index(inside) < said.index("macro_step=")
    assert "extrapolation" not in said
    warned = [text for text in list_warnings(closed) if "fixedInternalStepSize" in text]
    assert [text.partition("; ")[2] for text in warned] == ["take interface = 'model_exchange'"]
    parts["through"]["interface"] = "model_exchange"
    following = scenario(parts, connections=lines, master=signals)
    said = in_command_line(advise(following, errors, {name: 1.0}, []))
    assert "model_exchange" not in said
    assert "master.extrapolation=" in said


@given(lengths=st.lists(st.floats(1e-6, 1.0), min_size=1, max_size=8), parts=st.integers(1, 4))
def test_refined_steps_meet_every_end_of_the_steps_that_they_divide(lengths, parts):
    """To the bit, in equal parts."""
    ends = np.cumsum([0.3, *lengths])
    steps = RefinedSteps(ends, parts)
    steps._stop = ends[-1]
    found = [ends[0]]
    while found[-1] < ends[-1]:
        found.append(steps._find_end(found[-1])[0])
    assert found[::parts] == list(ends)
    np.testing.assert_allclose(np.diff(found), np.repeat(np.diff(ends), parts) / parts, rtol=1e-8)


def test_an_fmu_that_is_exact_has_no_error(tmp_path):
    table = {"participant": fmu("dahlquist", 2, tmp_path)}
    one = scenario({"decay": table}, reference={}, tolerance={"decay.x": 1e-9})
    summary, _ = ran(one, tmp_path / "out")
    assert summary.exit_status == 0
    assert summary.verdict.startswith("within the tolerance; the errors of the FMUs' own solvers")
    assert recorded(tmp_path / "out")["decay.x"][-1] < 1.0


SECOND = "stateless_mass"


def test_its_error_falls_with_the_tolerance(tmp_path):
    """Against the matrix exponential."""
    errors = []
    for tolerance in (1e-2, 1e-4):
        one = masses(
            SECOND, tmp_path, macro_step=1e-3, step_control={"estimator": "defect", "relative": tolerance}
        )
        found = completed(one, tmp_path / str(tolerance))
        errors.append(np.abs(found["first.position"] - exact_position(found["time"])).max())
    assert errors[1] < 0.05 * errors[0]


def test_what_it_cannot_promise_is_said_before_the_run(tmp_path):
    said = list_warnings(masses(SECOND, tmp_path, step_control={"estimator": "defect"}))
    assert any("no step is made again" in line and "missed by any amount" in line for line in said)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"step_control": {}}, r"set step_control\.estimator = 'defect'"),
        ({"step_control": {"estimator": "defect"}, "event_tolerance": 1e-6}, "makes no step again"),
    ],
)
def test_what_does_not_go_is_refused_with_its_remedy(changes, said, tmp_path):
    with pytest.raises(ScenarioError, match=said):
        build_system(masses(SECOND, tmp_path, **changes))


STIFFNESS, HEIGHT, GRAVITY = 1e6, 0.1, 9.81
# Where the spring has all of the energy: k d^2 / 2 = g (h + d).
DEEPEST = (GRAVITY + math.sqrt(GRAVITY**2 + 2.0 * STIFFNESS * GRAVITY * HEIGHT)) / STIFFNESS


def test_an_explicit_master_with_step_control_meets_the_contact(tmp_path):
    one = scenario(
        {name: {"participant": fmu(name, 2, tmp_path)} for name in ("falling", "stop")},
        connections=["falling.position -> stop.position", "stop.force -> falling.force"],
        stop_time=0.16,
        step_control={"relative": 1e-6},
    )
    found = completed(one, tmp_path / "out")
    position, velocity = found["falling.position"], found["falling.velocity"]
    assert position.min() == pytest.approx(-DEEPEST, rel=0.02)
    energy = 0.5 * velocity**2 + GRAVITY * position + 0.5 * STIFFNESS * np.minimum(position, 0.0) ** 2
    assert energy[-1] == pytest.approx(GRAVITY * HEIGHT, rel=0.1)
