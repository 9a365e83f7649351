"""The valve train against an integration that shares nothing with it, which notices wrong physics."""

import json
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from models.monolithic.problem import SystemProblem

from .independent_train import OUTPUTS, STATES, Train, runge_kutta
from .systems import column, run, valve_train

ROOT = Path(__file__).parents[2]
# The contact's mode, 6.7 kHz, turns by 0.08 rad in a step: an error of 1e-7 of what the jumps of jerk excite.
STEP = 2e-6
# Of an output's largest value. Loads follow positions, good to 1e-12 m, by 4e8 N/m; up to 3e-6 is seen.
TOLERANCE = 1e-5


def start_of(system, states):
    values = dict(zip(STATES, states, strict=True))
    return np.array(
        [values.get(name, given) for name, given in zip(system.state.names, system.x0, strict=True)]
    )


@pytest.mark.parametrize(
    ("speed_rpm", "flexible"), [pytest.param(1000, False, marks=pytest.mark.long), (2000, True)]
)
def test_the_valve_train_moves_as_in_an_independent_integration(speed_rpm, flexible):
    """Over a whole event: cam, shaft, coils, Hertz's contact and film together."""
    train = Train(speed_rpm * math.pi / 30.0, flexible)
    every = 50
    steps = round(0.8 * 60.0 / speed_rpm / STEP / every) * every
    states = runge_kutta(train.rates, train.start(), 0.0, STEP, steps)
    times = STEP * np.arange(0, steps + 1, every)
    expected = np.array([train.observe(t, x) for t, x in zip(times, states[::every], strict=True)])
    system = valve_train(speed_rpm, camshaft={"flexible": float(flexible)})
    found = run(SystemProblem(system), start_of(system, states[0]), times)
    for name, wanted in zip(OUTPUTS, expected.T, strict=True):
        error = np.abs(column(system, found, name) - wanted).max() / np.abs(wanted).max()
        assert error < TOLERANCE, name


MUTATIONS = {
    "spring damping doubled": (
        "valve_train/valve_spring.py",
        "damping = 2.0 * p.damping_ratio / (2.0 * math.pi * p.surge_frequency) * stiffness",
        "damping = 4.0 * p.damping_ratio / (2.0 * math.pi * p.surge_frequency) * stiffness",
    ),
    "coil mass with f0 for its square": (
        "valve_train/valve_spring.py",
        "p.spring_rate / (math.pi * p.surge_frequency) ** 2",
        "p.spring_rate / (math.pi**2 * p.surge_frequency)",
    ),
    "s' off by 1 %": (
        "valve_train/cams/rises.py",
        "p.lift / rise_angle * (1.0 - math.cos(w * a))",
        "1.01 * p.lift / rise_angle * (1.0 - math.cos(w * a))",
    ),
    "Hertz's term left out": (
        "contact/hertz.py",
        "half_width(1.0, radius, length, compliance)) + 0.5",
        "half_width(1.0, radius, length, compliance))",
    ),
    "entrainment with s'' for 2 s''": (
        "valve_train/cams/profile.py",
        "base_radius + cam.s + 2.0 * cam.dds",
        "base_radius + cam.s + cam.dds",
    ),
}


@pytest.fixture(scope="module")
def rise(tmp_path_factory):
    """Half a millisecond of the independent integration, at 120 degrees of a flexible shaft's cam."""
    train, begin, steps = Train(1000.0 * math.pi / 30.0, flexible=True), 20e-3, 250
    states = runge_kutta(train.rates, train.start(), 0.0, STEP, round(begin / STEP) + steps)[-steps - 1 :]
    times = [begin + n * STEP for n in range(0, steps + 1, 50)]
    values = [train.observe(t, x) for t, x in zip(times, states[::50], strict=True)]
    file = tmp_path_factory.mktemp("rise") / "rise.json"
    file.write_text(
        json.dumps({"times": times, "states": states[0], "step": STEP, "values": values}), "utf-8"
    )
    return file


def errors_of(models, rise):
    """Errors of the outputs over the rise, of the models in a folder, uncompiled."""
    done = subprocess.run(
        [sys.executable, "-m", "tests.models.integrate_rise", str(rise)],
        cwd=models,
        env={**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join([str(models), str(ROOT)])},
        capture_output=True,
        text=True,
        check=True,
    )
    found = json.loads(done.stdout)
    assert Path(found["models"]).is_relative_to(models)
    return found["errors"]


@pytest.mark.long
def test_the_physics_as_it_is_agrees(rise):
    assert max(errors_of(ROOT, rise).values()) < TOLERANCE


@pytest.mark.long
@pytest.mark.parametrize("mutation", MUTATIONS)
def test_wrong_physics_is_noticed(mutation, rise, tmp_path):
    """A copy of the models with one wrong term is twenty times further off than is tolerated."""
    file, right, wrong = MUTATIONS[mutation]
    shutil.copytree(ROOT / "models", tmp_path / "models", ignore=shutil.ignore_patterns("__pycache__"))
    source = tmp_path / "models" / file
    text = source.read_text("utf-8")
    assert right in text
    source.write_text(text.replace(right, wrong), "utf-8")
    assert max(errors_of(tmp_path, rise).values()) > 20.0 * TOLERANCE
