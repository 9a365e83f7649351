"""Inputs of FMUs: derivatives where they are taken, means where they are held; rates of outputs."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.core.difference import Difference
from models.core.remedies import in_python
from models.core.system import Port
from orchestrator.assessment.diagnosis.facts import Facts
from orchestrator.assessment.diagnosis.suggestions import suggest_held_inputs
from orchestrator.engine.coupling import Coupling
from orchestrator.engine.signals import DEGREES
from orchestrator.masters import MASTERS
from orchestrator.participants.fmu import FmuParticipant, FmuSettings
from orchestrator.participants.protocol import BoundVariables
from orchestrator.participants.third_party import read_component
from orchestrator.run.comparison import VariableError, advise
from orchestrator.scenario.fmu_limits import FmuLimits
from orchestrator.scenario.warnings import list_warnings
from tests.fmus.names import mark_long

from .c_fmus import fmu
from .runs import CASES, exact_position, masses, ran, recorded, scenario

HELD = Port("second", "force")
# Iterations as exact as their numbers: what is left is the error of the step.
TIGHT: dict[str, Any] = {"iterated": {"tolerance": 1e-12}, "newton": {"tolerance": 1e-12}}


@pytest.mark.parametrize("name", mark_long(MASTERS, ["gauss_seidel"]))
def test_held_inputs_get_the_mean_and_the_run_is_of_second_order(name, tmp_path, record):
    """Two masses, one of them an FMU that holds its force, against their matrix exponential over 1 s."""
    error = {}
    for signal, steps in (("linear", (4e-3, 2e-3)), ("hold", (2e-3,))):
        for step in steps:
            master = {"name": name, "extrapolation": signal, **TIGHT.get(name, {})}
            one = masses("held_mass", tmp_path, "sprung_mass", master=master, macro_step=step)
            found = ran(one, tmp_path / f"{signal}{step}")[1]
            error[signal, step] = np.abs(found["first.position"] - exact_position(found["time"])).max()
    order = np.log2(error["linear", 4e-3] / error["linear", 2e-3])
    case = f"two masses, one an FMU that holds its inputs, {name}"
    record("Coupling", f"{case}: order", order, 2.0, "order of the mean", tolerance=0.1)
    quantity = f"{case}: error at 2 ms (m)"
    record("Coupling", quantity, error["linear", 2e-3], 0.0, "matrix exponential", tolerance=2.5e-4)
    assert error["hold", 2e-3] > 10.0 * error["linear", 2e-3]


@pytest.mark.parametrize("signal", DEGREES)
@pytest.mark.long
def test_passes_in_compiled_code_give_held_inputs_the_same_bits(signal, tmp_path):
    """Through a conversion of units too; an FMU in its own process is stepped by Python."""
    found = []
    for process in ("shared", "own"):
        tables = {
            "mass": {"participant": fmu("falling", 2, tmp_path), "process": process},
            "stop": {"participant": fmu("stop", 2, tmp_path), "process": process},
        }
        lines = ["stop.force -> mass.force", "mass.position * 2 -> stop.position"]
        master = {"name": "gauss_seidel", "extrapolation": signal}
        one = scenario(tables, connections=lines, master=master, macro_step=1e-4)
        found.append(ran(one, tmp_path / process)[1])
    for name, values in found[0].items():
        np.testing.assert_array_equal(values, found[1][name])
    assert (found[0]["stop.force"] > 0.0).any()


@pytest.mark.parametrize("name", mark_long(["jacobi", "gauss_seidel"], ["jacobi"]))
def test_outputs_that_follow_a_held_input_at_once_are_those_of_the_steps_end(name, tmp_path, record):
    """A mass on a spring without mass, both FMUs that hold their inputs: a fall onto it is a sine."""
    stiffness, mass_at, error = 100.0, -9.81 / 100.0, []
    for step in (2e-3, 1e-3):
        tables = {
            "mass": {"participant": fmu("falling", 2, tmp_path), "start": {"position": 0.5 * mass_at}},
            "stop": {"participant": fmu("stop", 2, tmp_path), "parameters": {"stiffness": stiffness}},
        }
        lines = ["stop.force -> mass.force", "mass.position -> stop.position"]
        one = scenario(tables, connections=lines, master={"name": name}, macro_step=step)
        found = ran(one, tmp_path / f"{step}")[1]
        exact = mass_at * (1.0 - 0.5 * np.cos(np.sqrt(stiffness) * found["time"]))
        np.testing.assert_allclose(
            found["stop.force"], -stiffness * found["mass.position"], atol=600.0 * step**2
        )
        error.append(np.abs(found["mass.position"] - exact).max())
    order = np.log2(error[0] / error[1])
    case = f"mass on a spring, both FMUs that hold their inputs, {name}"
    record("Coupling", f"{case}: order", order, 2.0, "order of the mean", tolerance=0.1)


def test_held_inputs_are_named_before_the_run(tmp_path):
    (said,) = list_warnings(masses("held_mass", tmp_path, "sprung_mass"))
    assert "second.force" in said
    assert "second order" in said
    (said,) = list_warnings(
        masses("held_mass", tmp_path, "sprung_mass", master={"name": "jacobi", "extrapolation": "hold"})
    )
    assert "first order" in said


def test_signals_are_advised_for_held_inputs_by_what_they_give(tmp_path):
    one = masses(
        "held_mass", tmp_path, "sprung_mass", master={"name": "gauss_seidel", "extrapolation": "hold"}
    )
    summary, _ = ran(one, tmp_path / "out")
    limits = FmuLimits(one)
    assert (limits.held_inputs, limits.restorable, limits.controllable) == ([HELD], True, True)
    facts = Facts(summary.steps, None, one)  # type: ignore[arg-type]
    assert 'extrapolation = "quadratic"' in (suggest_held_inputs(facts) or "")


@pytest.mark.parametrize("component", ["sprung_mass", None])
@pytest.mark.parametrize(("signal", "order"), [("hold", 1), ("linear", 2), ("quadratic", 2)])
def test_steps_are_advised_by_the_order_of_the_mean(signal, order, component, tmp_path):
    """Of 2 after errors of 50 times what is allowed: quadratic signals have order 3 where none is held."""
    one = masses("held_mass", tmp_path, component, master={"name": "jacobi", "extrapolation": signal})
    errors = {"second.position": VariableError(1.0, 1.0, 5e-2, Difference(0.0, 0.0, 0.0), tolerance=1e-3)}
    said = in_python(advise(one, errors, {}, []))
    assert f"'macro_step': '{0.01 * 100.0 ** (-1.0 / order):g} s'" in said


def test_a_derivative_of_a_held_input_is_named_before_the_run(tmp_path):
    tables = {
        "body": {"participant": fmu("held_mass", 2, tmp_path)},
        "load": {"participant": fmu("inertia", 2, tmp_path)},
    }
    lines = ["body.velocity * 1 -> load.speed", "load.reaction * 1 -> body.force"]
    one = scenario(tables, connections=lines, master={"name": "jacobi", "extrapolation": "hold"})
    assert any("load.reaction" in said and "speed" in said for said in list_warnings(one))


@pytest.mark.parametrize(
    ("name", "signal", "order", "process"),
    [
        ("integral", "hold", 1, "shared"),
        ("integral", "quadratic", 3, "own"),
        ("first_slope", "quadratic", 2, "shared"),
        ("first_slope", "hermite", 2, "shared"),
    ],
)
def test_inputs_follow_signals_by_the_standards_call(name, signal, order, process, tmp_path):
    """The integral of exp(-t) by an FMU that takes derivatives of its input: the signal's order. One that
    takes the slope only gets that, by which the order is 2."""
    tables = {
        "decay": {"participant": fmu("dahlquist", 2, tmp_path)},
        "integral": {"participant": fmu(name, 2, tmp_path), "process": process},
    }
    missed = []
    for step in (0.02, 0.01):
        one = scenario(
            tables,
            connections=["decay.x -> integral.u"],
            macro_step=step,
            master={"name": "jacobi", "extrapolation": signal},
        )
        _, found = ran(one, tmp_path / f"{step}")
        missed.append(np.abs(found["integral.y"] - (1.0 - np.exp(-found["time"]))).max())
    assert np.log2(missed[0] / missed[1]) == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize(("name", "highest"), [("integral", 3), ("first_slope", 1)])
def test_the_orders_that_an_fmu_takes_are_found(name, highest, tmp_path):
    """Once it has been given derivatives: its description does not say."""
    unit = FmuParticipant("one", fmu(name, 2, tmp_path), FmuSettings(["y"]))
    try:
        unit.connect(BoundVariables(["u"], np.zeros((4, 1)), ["y"], np.zeros(1), np.zeros(0)))
        unit.initialise(0.0, 1.0)
        unit.finish_initialisation()
        unit.write()
        assert unit.get_followed()[:, 0].tolist() == [order <= highest for order in range(4)]
    finally:
        unit.close()


def test_the_declared_derivative_is_the_rate(tmp_path):
    """By which Hermite signals have their fourth order."""
    component = read_component(fmu("ball", 2, tmp_path))
    assert component.outputs.names == ("body.h", "body.v")
    tables = {name: {"participant": fmu(name, 2, tmp_path)} for name in ("ball", "integral")}
    assert rated_of(tables, "ball.body.h * 1 -> integral.u", tmp_path) == {"ball.body.h": True}


def test_the_declared_derivative_of_an_array_has_the_rates_of_its_elements(tmp_path):
    """Also where only the standard's call gives them: to the last bit."""
    found = []
    for name in ("vector", "called_vector"):
        tables = {"vector": {"participant": fmu(name, 3, tmp_path), "inputs": {"u[2]": 3.0}}}
        tables["driven"] = {"participant": fmu("feedback", 3, tmp_path)}
        line = "vector.y[2] -> driven.u"
        assert rated_of(tables, line, tmp_path / name) == {"vector.y[2]": True}
        found.append(recorded(tmp_path / name / "out")["driven.y"])
    np.testing.assert_array_equal(*found)


def rated_of(tables: dict[str, Any], line: str, folder: Path) -> dict[str, bool]:
    """Of a coupled run with Hermite signals: whether the rate of each connected output is given."""
    rated: list[dict[str, bool]] = []
    attached = Coupling.initialise

    def initialise(self: Coupling, *times: float) -> None:
        rates = self.state.history.rated
        rated.append(dict(zip(map(str, self.wiring.sources), rates, strict=True)))
        attached(self, *times)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Coupling, "initialise", initialise)
        master = {"name": "gauss_seidel", "extrapolation": "hermite"}
        ran(scenario(tables, connections=[line], master=master), folder / "out")
    return rated[0]


@pytest.mark.parametrize(("version", "process"), CASES)
def test_rates_by_the_standards_call_are_those_of_declared_variables(version, process, tmp_path):
    """To the last bit, from the start on; without rates the signals of its outputs are parabolas."""
    found = {}
    for name in ("called", "sprung"):
        tables = {
            "mass": {
                "participant": fmu(name, version, tmp_path),
                "process": process,
                "start": {"position": 1.0},
            },
            "driven": {"component": "sprung_mass", "participant": "in-process"},
        }
        lines = ["mass.position * 1 -> driven.force"]
        for signal in ("hermite", "quadratic"):
            master = {"name": "jacobi", "extrapolation": signal}
            one = scenario(tables, connections=lines, master=master)
            found[name, signal] = ran(one, tmp_path / f"{name} {signal}")[1]["driven.position"]
    np.testing.assert_array_equal(found["called", "hermite"], found["sprung", "hermite"])
    np.testing.assert_array_equal(found["called", "quadratic"], found["sprung", "quadratic"])
    assert not np.array_equal(found["called", "hermite"], found["called", "quadratic"])


@pytest.mark.parametrize(("master", "process"), [("jacobi", "own"), ("gauss_seidel", "shared")])
def test_rates_that_are_no_numbers_at_the_start_are_not_used(master, process, tmp_path):
    """The FMU is as one that gives none, to the last bit, and the run says so once."""
    found = []
    for name in ("called_late", "unrated"):
        mass = {"participant": fmu(name, 2, tmp_path), "process": process, "start": {"position": 1.0}}
        other = {"component": "sprung_mass", "participant": "in-process"}
        one = scenario(
            {"mass": mass, "driven": other},
            connections=["mass.position * 1 -> driven.force"],
            master={"name": master, "extrapolation": "hermite"},
        )
        summary, columns = ran(one, tmp_path / name)
        found.append(columns["driven.position"])
        said = [line for line in summary.tell() if "rates of change" in line]
        assert len(said) == (name == "called_late")
    np.testing.assert_array_equal(*found)
