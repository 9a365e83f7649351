"""Steps that resolve a motion coarsely are no unstable coupling: what `analyse` calls stable is run."""

from __future__ import annotations

import numpy as np
import pytest

from models.oscillators.exact import quarter_car
from orchestrator.errors import UnstableCouplingError
from orchestrator.masters import GaussSeidel, Jacobi
from orchestrator.participants import in_process
from orchestrator.run.simulation import simulate
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system

from .recorder import Recorder


def run(master, step: float, stop: float = 2.4) -> Recorder:
    system = build_system(load("quarter-car"))
    recorder = Recorder()
    units = {name: in_process(name, instance) for name, instance in system.instances.items()}
    simulate(system, units, master, step, stop, [recorder])
    return recorder


def error(step: float) -> float:
    recorder = run(GaussSeidel("hermite"), step)
    return float(np.abs(recorder["chassis.position"] - quarter_car(recorder.times)[:, 0]).max())


def test_fourth_order_holds_to_the_steps_that_are_advised(record) -> None:
    """At 20 ms the wheel turns by 1.3 rad of its oscillation in a step: its values miss their linear
    extrapolation, and the error is that of the method all the same. It is scaled from 10 ms."""
    fine = error(0.01)
    for step in (0.016, 0.02, 0.024):
        case = f"quarter car, GaussSeidel, hermite inputs: error at {1000 * step:g} ms over (h / 10 ms)^4"
        record("Coupling", case, error(step) / fine / (step / 0.01) ** 4, 1.0, "order 4", tolerance=0.15)


@pytest.mark.parametrize("step", [0.05, 0.1])
def test_a_swing_that_grows_is_still_an_instability(step: float) -> None:
    with pytest.raises(UnstableCouplingError, match="unstable coupling"):
        run(Jacobi("hermite"), step, 150 * step)
