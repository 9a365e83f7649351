"""FMUs for model exchange as participants: their equations are integrated by the run."""

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tribocosim
from fmus.native.fmu import build
from fmus.native.machine_code import this_platform
from models.core.difference import difference
from models.core.system import Instance
from models.oscillators.exact import quarter_car
from orchestrator.participants import Participant, open_fmu, read_component
from orchestrator.participants.protocol import BoundVariables
from orchestrator.scenario.files import list_shipped, read_contents

from ..fmus.names import mark_long
from .public import public
from .runs import ran, scenario
from .test_equations import STEPS, bouncing_ball


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Native FMUs of both versions."""
    folder = tmp_path_factory.mktemp("natives")
    versions = {"quarter_car_wheel": 2, "quarter_car_chassis": 3, "slider_crank": 3}
    return {name: build(name, folder, platforms=[this_platform()], fmi=fmi) for name, fmi in versions.items()}


def integrated(file: Path, **table: Any) -> dict[str, Any]:
    return {"participant": str(file), "interface": "model_exchange", "process": "shared", **table}


@pytest.mark.parametrize(("signal", "order"), [("hold", 1), ("linear", 2), ("quadratic", 3)])
@pytest.mark.long
def test_integrated_fmus_follow_signals_at_their_orders(
    signal: str, order: int, files: dict[str, Path], tmp_path: Path, record: Any
) -> None:
    """The quarter car, Jacobi, 1 and 0.5 ms, against the matrix exponential."""
    tables = {
        "wheel": integrated(files["quarter_car_wheel"]),
        "chassis": integrated(files["quarter_car_chassis"]),
    }
    errors = []
    for step in (1e-3, 5e-4):
        master = {"name": "jacobi", "extrapolation": signal}
        one = scenario(tables, connections=STEPS, macro_step=step, master=master)
        _, found = ran(one, tmp_path / f"{step:g}")
        exact = quarter_car(found["time"])[:, 0]
        errors.append(difference(found["chassis.position"], exact).rms)
    measured = math.log2(errors[0] / errors[1])
    case = f"quarter car of FMUs integrated by the run, Jacobi {signal}: order"
    record("Coupling", case, measured, order, "order of the signal", tolerance=0.2)


@contextmanager
def opened(path: Path, stop: float) -> Iterator[tuple[Participant, BoundVariables]]:
    """A slider-crank whose crank turns at 100 rad/s, ready to step."""
    component = read_component(path, "model_exchange")
    unit = open_fmu("mechanism", path, Instance(component))
    names, outputs = ["crank_angle", "crank_speed"], ["psi", "piston_offset"]
    bound = BoundVariables(names, np.zeros((4, 2)), outputs, np.zeros(2), np.zeros(0))
    try:
        unit.connect(bound)
        unit.initialise(0.0, stop)
        bound.inputs[:2] = [[0.0, 100.0], [100.0, 0.0]]
        unit.write()
        unit.finish_initialisation()
        yield unit, bound
    finally:
        unit.close()


def advance(unit: Participant, bound: BoundVariables, steps: Sequence[int], step: float) -> np.ndarray:
    """The outputs after each of the steps of these numbers."""
    rows = []
    for k in steps:
        bound.inputs[0, 0] = 100.0 * k * step
        unit.write()
        unit.advance(k * step, step)
        unit.read()
        rows.append(bound.outputs.copy())
    return np.array(rows)


@pytest.mark.long
def test_a_repeated_step_has_the_same_bits(files: dict[str, Path]) -> None:
    """Through impacts; also from a serialised state, in another instance."""
    step = 5e-4
    with opened(files["slider_crank"], 0.1) as (unit, bound):
        before = advance(unit, bound, range(40), step)
        saved = unit.save()
        first = advance(unit, bound, range(40, 120), step)
        unit.restore(saved)
        again = advance(unit, bound, range(40, 120), step)
        data = unit.to_bytes(saved)
    with opened(files["slider_crank"], 0.1) as (other, bound):
        other.restore(other.from_bytes(data))
        elsewhere = advance(other, bound, range(40, 120), step)
    assert np.array_equal(first, again)
    assert np.array_equal(first, elsewhere)
    assert np.count_nonzero(np.diff(np.sign(np.diff(np.concatenate([before, first])[:, 1])))) > 4


@pytest.mark.long
def test_impacts_inside_integrated_steps_are_located(files: dict[str, Path], record: Any) -> None:
    """The shipped slider-crank, whose mechanism's flights and impacts the component solves by itself."""
    content = read_contents(list_shipped()["slider-crank"]) | {"name": "impacts", "stop_time": "60 ms"}
    ours = tribocosim.run(tribocosim.load(content))
    table = content["components"]["slider_crank"]
    content["components"]["slider_crank"] = integrated(files["slider_crank"], parameters=table["parameters"])
    theirs = tribocosim.run(tribocosim.load(content | {"start": "given", "reference": {"enabled": False}}))
    name = "slider_crank.piston_offset"
    found = difference(theirs.coupled[name].values, ours.reference[name].values).relative_rms
    quantity = "slider-crank integrated by the run: piston_offset"
    record("FMUs", quantity, found, 0.0, "reference", tolerance=1e-4)


@pytest.mark.parametrize("version", mark_long(["2", "3"], ["3"]))
def test_a_public_ball_bounces_exactly(version: str, tmp_path: Path, record: Any) -> None:
    """Its own solver is Euler's method with steps of 10 ms."""
    file = public(f"reference-fmus-{version}/BouncingBall.fmu")
    _, found = ran(scenario({"ball": integrated(file)}, stop_time=1.5), tmp_path / "out")
    largest = float(np.max(np.abs(found["ball.h"] - bouncing_ball(found["time"]))))
    case = f"BouncingBall of FMI {version}, integrated by the run: h"
    record("FMUs", case, largest, 0.0, "its equations", tolerance=1e-8)
