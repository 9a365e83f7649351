"""Derivatives of inputs that third-party FMUs take, and rates of outputs that they give."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestrator.engine.coupling import Coupling
from orchestrator.participants import read_component
from orchestrator.participants.fmu import FmuParticipant, FmuSettings
from orchestrator.participants.protocol import BoundVariables

from .c_fmus import fmu
from .runs import CASES, ran, recorded, scenario


@pytest.mark.parametrize(
    ("name", "signal", "order", "process"),
    [
        ("integral", "hold", 1, "shared"),
        ("integral", "quadratic", 3, "own"),
        ("first_slope", "quadratic", 2, "shared"),
        ("first_slope", "hermite", 2, "shared"),
    ],
)
def test_inputs_follow_signals_by_the_standards_call(
    name: str, signal: str, order: int, process: str, tmp_path: Path
) -> None:
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
def test_the_orders_that_an_fmu_takes_are_found(name: str, highest: int, tmp_path: Path) -> None:
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


def test_the_declared_derivative_is_the_rate(tmp_path: Path) -> None:
    """By which Hermite signals have their fourth order."""
    component = read_component(fmu("ball", 2, tmp_path))
    assert component.outputs.names == ("body.h", "body.v")
    tables = {name: {"participant": fmu(name, 2, tmp_path)} for name in ("ball", "integral")}
    assert rated_of(tables, "ball.body.h * 1 -> integral.u", tmp_path) == {"ball.body.h": True}


def test_the_declared_derivative_of_an_array_has_the_rates_of_its_elements(tmp_path: Path) -> None:
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
def test_rates_by_the_standards_call_are_those_of_declared_variables(
    version: int, process: str, tmp_path: Path
) -> None:
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
def test_rates_that_are_no_numbers_at_the_start_are_not_used(
    master: str, process: str, tmp_path: Path
) -> None:
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
