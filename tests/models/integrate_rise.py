"""Integrates the models over a given rise and prints their errors; `test_independent_train` runs it."""

import json
import sys
from pathlib import Path

import numpy as np

import models
from models.core.evaluation import Evaluation

from .independent_train import OUTPUTS, STATES, runge_kutta
from .systems import valve_train


def errors(rise: dict) -> dict[str, float]:
    """The largest error of every output over its largest value."""
    system = valve_train(1000.0, camshaft={"flexible": 1.0})
    evaluation, times = Evaluation(system), rise["times"]
    values = dict(zip(STATES, rise["states"], strict=True))
    values["flywheel.angle"] = system.x0[system.state.names.index("flywheel.speed")] * times[0]
    start = [values.get(name, given) for name, given in zip(system.state.names, system.x0, strict=True)]

    def rates(t: float, x: list[float]) -> list[float]:
        return evaluation.derivative(t, np.array(x)).tolist()

    steps = round((times[-1] - times[0]) / rise["step"])
    every = steps // (len(times) - 1)
    states = runge_kutta(rates, start, times[0], rise["step"], steps)[::every]
    found = np.array([evaluation.outputs(t, np.array(x)).copy() for t, x in zip(times, states, strict=True)])
    columns = [system.outputs.names.index(name) for name in OUTPUTS]
    wanted = np.array(rise["values"])
    off = np.abs(found[:, columns] - wanted).max(axis=0) / np.abs(wanted).max(axis=0)
    return dict(zip(OUTPUTS, off.tolist(), strict=True))


if __name__ == "__main__":
    rise = json.loads(Path(sys.argv[1]).read_text("utf-8"))
    print(json.dumps({"models": models.__file__, "errors": errors(rise)}))
