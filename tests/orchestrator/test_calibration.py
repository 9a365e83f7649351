"""tribocosim calibrate: parameters from measured signals, their intervals, and what is not seen."""

import math
import sqlite3
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy

import tribocosim
from orchestrator.errors import MistakeError, RunError
from orchestrator.scenario import build_scenario
from orchestrator.scenario.display import Shown, show_unit
from orchestrator.scenario.files import load, read_changed
from orchestrator.scenario.system import list_parameters
from orchestrator.study.calibration import models
from orchestrator.study.calibration.doubts import find_doubt
from orchestrator.study.calibration.fit import Fit, fit, half_width, profile
from orchestrator.study.calibration.measured import Experiment, Measured, Signal
from orchestrator.study.calibration.models import Prediction, count_samples, failed, make_model
from orchestrator.study.calibration.objective import Objective
from orchestrator.study.calibration.parameters import Fitted
from orchestrator.study.calibration.predictions import Predictions
from orchestrator.study.calibration.run import _fit_from
from orchestrator.study.calibration.signals import eliminate
from orchestrator.study.speeds import subject as speeds
from tribocosim.cached_fmus import build_fmu
from tribocosim.reporting import SilentReporter

from ..third_party.c_fmus import fmu
from .commands import called

TIMES = np.linspace(0.0, 2.0, 200)


@dataclass(frozen=True)
class Formula:
    """A model by a function of the parameters and the times that gives outputs, the first ones measured."""

    function: Callable[..., Mapping[str, Any]]
    units: Mapping[str, str]
    signals: int = 1

    @property
    def outputs(self) -> list[str]:
        return list(self.units)

    @property
    def shown(self) -> dict[str, Shown]:
        return {name: show_unit(unit or "1") for name, unit in self.units.items()}

    def content(self) -> str:
        return self.function.__name__

    def predict(self, values: Mapping[str, float], experiment: Experiment, start: Any) -> Prediction:
        found = self.function(experiment.positions, *values.values())
        rows = np.array([np.broadcast_to(found[name], TIMES.shape) for name in self.units])
        return Prediction(rows[: self.signals], rows, np.zeros(0))

    def differentiate(self, values: Mapping[str, float], experiment: Experiment, start: Any) -> Prediction:
        raise RunError("a formula has no tangents")


def test_residuals_are_told_in_the_unit_in_which_their_signal_is_shown():
    """A model that is 0.5 rad off everywhere."""
    turning = Formula(lambda times, angle: {"y": 0.0 * times + angle}, {"y": "rad"})
    objective = objective_of(turning, np.zeros(TIMES.size), [Fitted("a.angle", "rad", 1.0)])
    assert objective.describe(np.array([0.5])) == "y 28.6 deg"


def objective_of(
    model: Formula,
    data: Any,
    parameters: list[Fitted],
    signal: Signal | None = None,
    file: Path | None = None,
) -> Objective:
    one = signal or Signal("y", model.outputs[0])
    experiment = Experiment(None, "time", TIMES, np.atleast_2d(data))
    predictions = Predictions(model, [experiment], sqlite3.connect(file or ":memory:"), None)
    return Objective(parameters, Measured((one,), (experiment,)), predictions, SilentReporter())


def line(t: Any, slope: float, height: float) -> dict[str, Any]:
    return {"line.height": slope * t + height, "line.slope": slope}


LINE = Formula(line, {"line.height": "m", "line.slope": "m/s"})


def fit_line(signal: Signal, data: Any, *, fixed: bool = False) -> tuple[Objective, Fit]:
    """Slope and height, the latter `fixed`."""
    names = ["line.slope"] if fixed else ["line.slope", "line.height"]
    model = replace(LINE, function=lambda t, a: line(t, a, 0.0)) if fixed else LINE
    objective = objective_of(model, data, [Fitted(name, "", 1.0) for name in names], signal)
    return objective, fit(objective, np.ones(len(names)))


def test_a_straight_line_has_the_closed_form_of_values_and_covariance():
    """Of linear regression: (X^T X)^-1 X^T y and s^2 (X^T X)^-1, with s^2 = r^T r / (n - 2). A column that
    variable projection eliminates leaves the same for the others."""
    data = 3.0 * TIMES - 0.7 + np.random.default_rng(3).normal(0.0, 0.2, TIMES.size)
    x = np.stack([TIMES, np.ones_like(TIMES)], axis=1)
    exact, (squares,), *_ = np.linalg.lstsq(x, data)
    covariance = squares / (TIMES.size - 2) * np.linalg.inv(x.T @ x)
    objective, found = fit_line(Signal("y", "line.height"), data)
    # Steps end at 1e-5 of the parameters; derivatives by differences of a linear function are exact.
    assert found.x == pytest.approx(exact, rel=2e-5)
    assert found.covariance == pytest.approx(covariance, rel=1e-6)
    assert objective.noises == pytest.approx([math.sqrt(squares / (TIMES.size - 2))], rel=1e-6)
    _, other = fit_line(Signal("y", "line.height", offset=True), data, fixed=True)
    assert other.x == pytest.approx(exact[:1], rel=2e-5)
    assert other.covariance == pytest.approx(covariance[:1, :1], rel=1e-6)
    _, given = fit_line(Signal("y", "line.height", noise=0.5), data)
    assert given.covariance == pytest.approx(0.25 * np.linalg.inv(x.T @ x), rel=1e-6)


def test_the_profile_of_a_linear_fit_is_its_interval():
    """Where the likelihood is a parabola; lmfit's profile asks the F distribution, as Student's t squared."""
    data = 3.0 * TIMES - 0.7 + np.random.default_rng(3).normal(0.0, 0.2, TIMES.size)
    for fixed, unknowns in ((False, 2), (True, 1)):
        objective, found = fit_line(Signal("y", "line.height"), data, fixed=fixed)
        (ends,) = profile(objective, found, [0]).values()
        width = half_width(TIMES.size - unknowns) * found.deviations[0]
        assert ends == pytest.approx((found.x[0] - width, found.x[0] + width), abs=2e-3 * width)


@pytest.mark.parametrize(("gain", "offset"), [(True, False), (False, True), (True, True)])
def test_the_derivative_of_an_eliminated_residual_is_that_of_differences(gain, offset):
    signal, generator = Signal("y", "y", offset=offset, gain=gain), np.random.default_rng(1)
    model, slopes, data = (generator.normal(2.0, 1.0, shape) for shape in (30, (30, 3), 30))
    found = eliminate(signal, data, model, slopes)
    step = 1e-5
    for k in range(3):
        ends = [eliminate(signal, data, model + h * slopes[:, k], slopes).residual for h in (step, -step)]
        # The term of third order is 1e-10.
        assert found.jacobian[:, k] == pytest.approx((ends[0] - ends[1]) / (2.0 * step), abs=1e-8)
    assert found.residual == pytest.approx(data - found.gain * model - found.offset)


def fall(t: Any, height: float, rate: float) -> dict[str, Any]:
    return {"y.y": height * np.exp(-rate * t)}


@dataclass(frozen=True)
class Slow(Formula):
    """Of the state in which a cycle begins nine tenths are left at its end, and move the signal."""

    def predict(self, values: Mapping[str, float], experiment: Experiment, start: Any) -> Prediction:
        found, own = super().predict(values, experiment, start), np.array([sum(values.values())])
        state = own if start is None else own + 0.9 * (start - own)
        return replace(found, signals=found.signals + 0.03 * (state - own), state=state)

    def differentiate(self, values: Mapping[str, float], experiment: Experiment, start: Any) -> Prediction:
        height, rate = values.values()
        by = np.exp(-rate * TIMES)[:, None] * np.column_stack([np.ones(TIMES.size), -height * TIMES])
        return Prediction(by[None], by[None], np.zeros((1, 2)))


def test_a_fit_ends_at_one_answer_whatever_its_path():
    """From two starts, of a model whose signals remember the path: within 1e-4 of the interval's half-width
    of the least squares of signals that do not."""
    data = fall(TIMES, 1.0, 1.0)["y.y"] + np.random.default_rng(6).normal(0.0, 0.02, TIMES.size)
    parameters = [Fitted(name, "1", 1.0) for name in ("y.height", "y.rate")]
    exact = scipy.optimize.least_squares(lambda p: fall(TIMES, *p)["y.y"] - data, [1.0, 1.0], xtol=1e-14).x
    for start in ([0.8, 1.2], [1.3, 0.7]):
        found = fit(objective_of(Slow(fall, {"y.y": "1"}), data, parameters), np.array(start))
        assert (np.abs(found.x - exact) < 1e-4 * half_width(198) * found.deviations).all()


@dataclass(frozen=True)
class Warm(Slow):
    """Which finds a cycle by itself only where the fit begins."""

    def predict(self, values: Mapping[str, float], experiment: Experiment, start: Any) -> Prediction:
        if start is None and abs(values["y.height"] - 0.8) > 1e-9:
            return failed("no equilibrium")
        return super().predict(values, experiment, start)


def test_a_fit_stays_where_no_cycle_begins_by_itself():
    data = fall(TIMES, 1.0, 1.0)["y.y"] + np.random.default_rng(6).normal(0.0, 0.02, TIMES.size)
    parameters = [Fitted(name, "1", 1.0) for name in ("y.height", "y.rate")]
    found = fit(objective_of(Warm(fall, {"y.y": "1"}), data, parameters), np.array([0.8, 1.2]))
    assert found.x == pytest.approx([1.0, 1.0], abs=0.02)
    assert np.isfinite(found.squares)


def series(t: Any, first: float, second: float) -> dict[str, Any]:
    force = np.sin(9.0 * t)
    return {"rod.compression": force * (1.0 / first + 1.0 / second), "rocker.bending": force / second}


def test_two_springs_in_series_are_named_with_what_would_tell_them_apart():
    units = {"rod.compression": "m", "rocker.bending": "m"}
    data = series(TIMES, 3.0, 5.0)["rod.compression"] + np.random.default_rng(2).normal(0.0, 1e-3, TIMES.size)
    springs = [Fitted("rod.stiffness", "N/m", 4.0, low=0.1), Fitted("rocker.stiffness", "N/m", 6.0, low=0.1)]
    objective = objective_of(Formula(series, units), data, springs)
    found = fit(objective, np.ones(2))
    (one,) = found.unseen
    assert one.seen == "1/rod.stiffness + 1/rocker.stiffness"
    assert list(one.remedies) == ["rocker.bending"]
    first, second = found.x * [4.0, 6.0]
    assert 1.0 / first + 1.0 / second == pytest.approx(1.0 / 3.0 + 1.0 / 5.0, rel=1e-3)
    # With its remedy measured too, at 1 % of its largest value, both are seen.
    assert one.remedies["rocker.bending"] < 0.1 < one.deviation


def test_a_parameter_that_the_noise_hides_is_named_alone():
    data = 0.01 * TIMES + np.random.default_rng(3).normal(0.0, 1.0, TIMES.size)
    _, found = fit_line(Signal("y", "line.height", noise=1.0), data, fixed=True)
    (one,) = found.unseen
    assert one.text.startswith("line.slope is hardly seen; it is known to ")


def write_oscillation(path: Path, noise: float = 0.0) -> Path:
    """Of the second of two free masses (5 kg and 1 kg) on a spring of 48 N/m: a cosine, in mm."""
    frequency = math.sqrt(48.0 * (1.0 / 5.0 + 1.0)) / (2.0 * math.pi)
    values = 1500.0 * np.cos(2.0 * math.pi * frequency * TIMES) + 3.0
    values += np.random.default_rng(0).normal(0.0, noise, values.size) if noise else 0.0
    rows = [f"{1e3 * t:.12g}; {v:.12g}" for t, v in zip(TIMES, values, strict=True)]
    path.write_text("\n".join(["time [ms]; way [mm]", *rows]) + "\n")
    return path


WAY = ["way = second.position, offset, gain"]


def test_masses_on_a_spring_have_the_stiffness_of_their_natural_frequency(tmp_path):
    """k = (2 pi f)^2 / (1/m + 1/M) with unknown offset and gain; the solver's tolerance is 1e-10."""
    data, out = write_oscillation(tmp_path / "data.csv"), tmp_path / "out"
    found = tribocosim.calibrate("two-masses", data, ["first.coupling_stiffness"], signals=WAY, out=out)
    assert found["start"].values == [40.0]
    assert found["fitted"].values == pytest.approx([48.0], rel=1e-7)
    written = load(out / "calibrated.toml")
    assert written.components["first"].parameters["coupling_stiffness"] == found["fitted"].values[0]


def test_a_free_oscillation_shows_stiffness_over_mass_and_neither_alone(tmp_path):
    data = write_oscillation(tmp_path / "data.csv", noise=5.0)
    wanted = ["first.coupling_stiffness, second.mass, first.mass"]
    found = tribocosim.calibrate("two-masses", data, wanted, signals=WAY, out=tmp_path / "out")
    assert not found["identified"].any()
    stiffness, second, first = found["fitted"].values
    frequency = stiffness * (1.0 / first + 1.0 / second)
    assert frequency == pytest.approx(48.0 * 1.2, rel=2e-3)
    assert (tmp_path / "out" / "calibrated.toml").read_text().count("not identified") == 3


def test_a_rate_of_an_fmu_is_that_of_its_exponential(tmp_path):
    """x = exp(-k t), which the FMU steps exactly; between its steps of 10 ms the model is linear."""
    table = {"participant": str(fmu("dahlquist", 2, tmp_path)), "process": "shared"}
    tables = {
        "name": "decay", "stop_time": 2.0, "macro_step": 0.01, "reference": {"enabled": False},
        "start": "given", "components": {"decay": table},
    }  # fmt: skip
    times = np.arange(0.0, 2.0, 0.01)
    rows = [f"{t},{v}" for t, v in zip(times, np.exp(-1.7 * times), strict=True)]
    (tmp_path / "data.csv").write_text("\n".join(["time [s], decay.x", *rows]) + "\n")
    found = tribocosim.calibrate(tribocosim.Scenario(tables), tmp_path / "data.csv", ["decay.k"])
    assert found["fitted"].values == pytest.approx([1.7], rel=1e-6)


def test_a_step_goes_back_where_there_is_no_motion():
    """Beyond 2 the model has no answer; the first step from 1, where it is flat, leads there."""

    def cubic(t: Any, a: float) -> dict[str, Any]:
        if a > 2.0:
            raise RunError("no cycle")
        return {"y.y": (a - 0.5) ** 3 * t}

    model = Formula(cubic, {"y.y": "1"})
    objective = objective_of(model, 1.3**3 * TIMES, [Fitted("a.a", "1", 1.0)], Signal("y", "y.y", noise=0.01))
    assert fit(objective, np.ones(1)).x == pytest.approx([1.8], rel=1e-5)
    with pytest.raises(RunError, match=r"no motion to compare .*a\.a = 3: no cycle"):
        fit(objective, np.array([3.0]))


def bend(t: Any, mass: float, stiffness: float) -> dict[str, Any]:
    """Of a contact under a spring of 1 kN/m and a mass that a cam moves, and its vibration."""
    load = 500.0 * (1.0 - np.cos(math.pi * t)) + 0.5 * math.pi**2 * mass * np.cos(math.pi * t)
    return {"rod.bending": load / stiffness + 6e-4 * np.exp(-t) * np.cos(math.sqrt(stiffness / mass) * t)}


def test_a_vibration_out_of_phase_traps_no_fit_from_30_per_cent_away():
    """Of twenty starts, in which it is up to nine turns out; by least squares alone five end at the noise.
    The mean square of 200 numbers is within 20 %."""
    truth, generator = np.array([100.0, 1e6]), np.random.default_rng(0)
    data = bend(TIMES, *truth)["rod.bending"] + generator.normal(0.0, 2e-5, TIMES.size)
    for _ in range(20):
        wanted = zip(("rod.mass", "rod.stiffness"), truth * generator.uniform(0.7, 1.3, 2), strict=True)
        parameters = [Fitted(name, "", value, low=1e-6 * value) for name, value in wanted]
        objective = objective_of(Formula(bend, {"rod.bending": "m"}), data, parameters)
        found = fit(objective, np.ones(2))
        assert objective.sum_squares(found.x)[0] < 1.2 * TIMES.size * 2e-5**2


@pytest.mark.parametrize("noise", [None, 0.1])
def test_of_several_starts_the_one_nearest_to_the_data_is_kept(noise):
    """A sine has many frequencies that a fit stays at. Its residual is the noise's at the true one, and above
    half the amplitude's mean square, 0.5, at others; the last start is one of those."""
    data = np.sin(12.0 * TIMES) + np.random.default_rng(1).normal(0.0, 0.1, TIMES.size)
    model = Formula(lambda t, a: {"y.y": np.sin(a * t)}, {"y.y": "1"})
    wanted, signal = [Fitted("a.a", "1", 5.0, low=2.0, high=20.0)], Signal("y", "y.y", noise=noise)
    objective = objective_of(model, data, wanted, signal)
    best, ends = _fit_from(objective, 8, SilentReporter())
    assert not find_doubt(objective, best, ends[:1])
    # The deviation of the frequency is 0.1/(12 of the sum's root) = 6e-3 at most.
    assert 5.0 * best.x == pytest.approx([12.0], abs=0.03)
    assert min(ends) == pytest.approx(1.0, abs=0.1)
    assert ends[-1] > 5.0
    assert ends[0] > 5.0
    trapped = fit(objective, np.ones(1))
    assert "neighbouring residuals of y are alike" in find_doubt(objective, trapped, ends[:1])


def test_a_fit_that_leaves_noise_is_seldom_doubted():
    """Of a hundred fits: a residual is beyond chance in one of a thousand, its neighbours in one of 30 000. A
    noise that was taken for half of what it is is seen in each."""
    generator, doubted = np.random.default_rng(4), [0, 0]
    for _ in range(100):
        data = TIMES + generator.normal(0.0, 0.2, TIMES.size)
        for which, noise in enumerate((0.2, 0.1)):
            objective, found = fit_line(Signal("y", "line.height", noise=noise), data, fixed=True)
            doubted[which] += bool(find_doubt(objective, found, [1.0]))
    assert doubted[0] <= 2
    assert doubted[1] == 100


def test_a_second_fit_takes_what_the_first_one_computed(tmp_path):
    data = 3.0 * TIMES - 0.7 + np.random.default_rng(3).normal(0.0, 0.2, TIMES.size)
    parameters = [Fitted("line.slope", "", 1.0), Fitted("line.height", "", 1.0)]
    found = []
    for _ in range(2):
        objective = objective_of(LINE, data, parameters, file=tmp_path / "kept.sqlite")
        found.append(fit(objective, np.ones(2)))
        made = objective._predictions.made
    assert made == 0
    assert np.array_equal(found[0].x, found[1].x)


def test_the_command_fits_a_spring_to_a_train_and_leaves_what_it_found(monkeypatch, tmp_path):
    """From forces of one cycle with noise of 2 N, read as the crank's angle that turns twice as far."""
    monkeypatch.setattr(speeds, "SAMPLES", 180)
    train = speeds.SpeedSubject(read_changed("valve-train"), "flywheel")
    cycle = train.find_cycle_at(1500.0 * math.pi / 30.0)
    force = cycle["valve_spring.spring_force"][:-1]
    force = force + np.random.default_rng(1).normal(0.0, 2.0, force.size)
    rows = [f"{4.0 * k},{value:.6f}" for k, value in enumerate(force)]
    comments = ["# speed: 1500 rpm", "# signal: force = valve_spring.spring_force, noise 2 N"]
    (tmp_path / "force.csv").write_text("\n".join([*comments, "crank [deg], force [N]", *rows]) + "\n")
    out = tmp_path / "out"
    done = called(
        "calibrate", "valve-train", str(tmp_path / "force.csv"), "--parameters", "valve_spring.spring_rate",
        "--set", "components.valve_spring.parameters.spring_rate=38 N/mm", "--workers", "1",
        "--out", str(out),
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    (_, row) = (out / "calibration.csv").read_text("utf-8").splitlines()
    name, unit, start, fitted, low, high, *_ = row.split(",")
    assert (name, unit, start) == ("valve_spring.spring_rate", "N/m", "38000.0")
    # Three deviations; the noise is given, so that the interval is 2 x 1.96 of them.
    deviation = (float(high) - float(low)) / (2.0 * scipy.stats.norm.ppf(0.975))
    assert abs(float(fitted) - 35e3) < 3.0 * deviation < 300.0
    assert load(out / "calibrated.toml").components["valve_spring"].parameters["spring_rate"] == float(fitted)
    assert (out / "calibration.png").stat().st_size > 10_000
    assert "N/mm" in done.stdout
    assert ' N/mm"' in (out / "calibrated.toml").read_text("utf-8")


def test_tangents_of_a_signal_are_the_limit_of_differences(monkeypatch):
    """Of a steady cycle: central differences are off by the square of their share, and extrapolated to none
    they are the tangents to 1e-6 of the largest."""
    monkeypatch.setattr(models, "CYCLE_TOLERANCE", 1e-12)
    monkeypatch.setattr(models, "STEADY", 1e-11)
    models._build_finder.cache_clear()
    name, at = "valve_spring.surge_frequency", np.radians(np.arange(0.0, 360.0, 4.0))
    experiment = Experiment(2000.0 * math.pi / 30.0, "cam_angle", at, np.zeros((1, at.size)))
    measured = Measured((Signal("force", "valve_spring.spring_force"),), (experiment,))
    scenario = build_scenario(read_changed("valve-train", ["components.contact.parameters.film_model=dry"]))
    value, model = list_parameters(scenario)[name], make_model(scenario, measured, [name], build_fmu)
    start = model.predict({name: value}, experiment, None).state
    exact = value * model.differentiate({name: value}, experiment, start).signals[0, :, 0]

    def difference(share):
        sides = (value * (1.0 + side) for side in (share, -share))
        up, down = (model.predict({name: side}, experiment, start).signals[0] for side in sides)
        return (up - down) / (2.0 * share)

    far, near = difference(5e-4), difference(2.5e-4)
    assert exact == pytest.approx((4.0 * near - far) / 3.0, abs=1e-6 * np.abs(exact).max())
    assert np.linalg.norm(far - exact) == pytest.approx(4.0 * np.linalg.norm(near - exact), rel=0.01)


def test_too_few_data_are_refused_before_anything_is_written(tmp_path):
    (tmp_path / "data.csv").write_text("time [s], first.position [m]\n0, 1\n1, 0.5\n")
    wanted = ["first.mass", "first.coupling_stiffness"]
    with pytest.raises(MistakeError, match="2 measured numbers cannot give 2 unknowns"):
        tribocosim.calibrate("two-masses", tmp_path / "data.csv", wanted, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_samples_of_a_cycle_fall_on_the_data():
    assert count_samples(np.arange(0.0, 360.0, 1.0) / 360.0) == 360
    assert count_samples((np.arange(0.0, 360.0, 2.0) + 0.5) / 360.0) == 720
    assert count_samples(np.random.default_rng(0).uniform(size=100)) == 7200


def test_a_residual_above_the_given_noise_is_told(tmp_path):
    """The oscillation has noise of 5 mm where 1 mm is given."""
    data = write_oscillation(tmp_path / "data.csv", noise=5.0)
    signals = [f"{WAY[0]}, noise 1 mm"]
    found = tribocosim.calibrate("two-masses", data, ["first.coupling_stiffness"], signals=signals)
    (note,) = found.attrs["notes"]
    assert "doubtful: the residual of way is " in note
    # The mean square of 200 numbers is within 20 %.
    assert float(note.split()[6]) == pytest.approx(5.0, rel=0.2)
