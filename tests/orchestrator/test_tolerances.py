"""tribocosim tolerances: percentiles, yield and Sobol' indices in closed form, and of a train."""

import json
import math
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
from scipy import stats

from models.valve_train.worn_cam import PLACES, sample_cam
from orchestrator.errors import MistakeError, RunError
from orchestrator.scenario.cams import read_cam
from orchestrator.scenario.files import load, read_changed
from orchestrator.scenario.system import build_system
from orchestrator.study.files import Plan
from orchestrator.study.run import Where, run
from orchestrator.study.source import compute_fingerprint
from orchestrator.study.speeds import finder
from orchestrator.study.speeds.subject import describe_numbers
from orchestrator.study.store import DONE, FAILED, open_store
from orchestrator.study.task import Outcome, evaluate
from orchestrator.study.tolerances import run as study
from orchestrator.study.tolerances.design import BESIDE, SAMPLE, Design, GrindingError, Parameters
from orchestrator.study.tolerances.distributions import Sampled, group
from orchestrator.study.tolerances.limits import parse_limits
from orchestrator.study.tolerances.report import describe, find_worst, rank
from orchestrator.study.tolerances.run import (
    describe_clashes,
    describe_cycles,
    find_usable,
    find_yields,
    make_subject,
)
from orchestrator.study.tolerances.statistics import (
    find_first_order,
    find_indices,
    find_middle_yield,
    find_percentile,
    find_yield,
)
from orchestrator.study.tolerances.table import Correlation, parse_tolerances

from .commands import called

DRY = ("components.contact.parameters.film_model=dry",)
NORMAL = {"kind": "normal", "deviation": "5 %"}
GIVEN = {
    "speed": "2000 rpm",
    "count": 16,
    "indices": False,
    "parameters": {"valve_spring.preload": NORMAL},
    "limits": ["valve_spring.largest_spring_force < 700 N"],
}


def alone(**distributions):
    """A factor for each distribution, all independent."""
    return {name: Parameters((name,), (one,), np.eye(1)) for name, one in distributions.items()}


def rows(design, kind):
    return np.flatnonzero(np.array(design.kinds) == kind)


def test_a_linear_response_to_normal_inputs_has_normal_percentiles(record):
    """Of y = 3 a - 4 b, with a and b of deviation 1: a normal distribution of deviation 5."""
    design = Design(alone(a=stats.norm(7.0, 1.0), b=stats.norm(0.0, 1.0)), 2048, False, 1)
    values = design.values @ [3.0, -4.0]
    sample = np.sort(values[rows(design, SAMPLE)])
    exact = stats.norm(21.0, 5.0)
    percents = np.array([1.0, 50.0, 99.0, 99.9])
    found = [find_percentile(sample, percent) for percent in percents]
    for percent, one in zip(percents, found, strict=True):
        assert one.low <= exact.ppf(percent / 100.0) <= one.high, percent
    # Of 4096 random trains the outer two have a deviation of 0.29.
    quantity, source = "percentiles of a linear response", "normal distribution"
    exactly = list(exact.ppf(percents[:3] / 100.0))
    record("Train", quantity, [one.value for one in found[:3]], exactly, source, tolerance=0.1)
    covariances = {name: factor.covariance for name, factor in design.factors.items()}
    beside = values[rows(design, BESIDE)].reshape(-1, 2)
    about = find_first_order(values[0], beside, design.deviations, covariances)
    assert about.percentile(99.0) == pytest.approx(exact.ppf(0.99), rel=1e-12)
    assert about.parts == pytest.approx([9.0 / 25.0, 16.0 / 25.0], rel=1e-12)


def test_indices_of_ishigamis_function(record):
    """sin x1 + 7 sin(x2)^2 + 0.1 x3^4 sin x1, on which every article on indices is tried."""
    a, b, pi = 7.0, 0.1, math.pi
    uniform = stats.uniform(-pi, 2.0 * pi)
    design = Design(alone(x1=uniform, x2=uniform, x3=uniform), 2048, True, 0)
    x1, x2, x3 = design.values.T
    y = np.sin(x1) + a * np.sin(x2) ** 2 + b * x3**4 * np.sin(x1)
    first_two, mixed = y[rows(design, SAMPLE)].reshape(2, -1), y[-3 * design.half :].reshape(3, -1)
    found = find_indices(*first_two, mixed)
    variance = a**2 / 8.0 + b * pi**4 / 5.0 + b**2 * pi**8 / 18.0 + 0.5
    one, two = 0.5 * (1.0 + b * pi**4 / 5.0) ** 2, a**2 / 8.0
    both = 8.0 * b**2 * pi**8 / 225.0
    first, total = np.array([one, two, 0.0]) / variance, np.array([one + both, two, both]) / variance
    for exact, value, (low, high) in (
        (first, found.first, found.first_interval),
        (total, found.total, found.total_interval),
    ):
        assert np.all((low <= exact) & (exact <= high)), (low, exact, high)
        # Half of the interval's width, of 1024 rows.
        quantity = "Sobol' indices of Ishigami's function"
        record("Train", quantity, list(value), list(exact), "closed form", tolerance=0.03)


def test_correlated_parameters_are_one_factor_with_their_correlation():
    names = ("a", "b", "c")
    groups = group(names, [Correlation(parameters=("c", "a"), coefficient=0.6)])
    assert [members for members, _ in groups] == [("a", "c"), ("b",)]
    factors = {str(m): Parameters(m, (stats.norm(0.0, 1.0),) * len(m), root) for m, root in groups}
    design = Design(factors, 1024, False, 0)
    a, c, b = design.values[rows(design, SAMPLE)].T
    # Of 2048 random trains the deviation of a correlation is (1 - 0.36)/45 = 0.014.
    assert np.corrcoef(a, c)[0, 1] == pytest.approx(0.6, abs=0.02)
    assert np.corrcoef(a, b)[0, 1] == pytest.approx(0.0, abs=0.02)
    impossible = [
        Correlation(parameters=pair, coefficient=r)
        for pair, r in ((("a", "b"), 0.9), (("b", "c"), 0.9), (("a", "c"), -0.9))
    ]
    with pytest.raises(MistakeError, match="no numbers are correlated so"):
        group(names, impossible)


def test_measured_values_come_back_as_their_distribution():
    measured = np.array([1.0, 2.0, 2.0, 5.0])
    design = Design(alone(x=Sampled(measured)), 512, False, 0)
    drawn = design.values[rows(design, SAMPLE), 0]
    assert drawn.min() == 1.0
    assert drawn.max() == 5.0
    # A line between the values at shares of 1/8, 3/8, 5/8, 7/8, level at its ends.
    assert np.quantile(drawn, [0.25, 0.5, 0.75]) == pytest.approx([1.5, 2.0, 3.5], abs=0.02)


def test_grinding_errors_have_their_spectrum_and_any_phase():
    fresh = sample_cam(read_cam(load("valve-train").components["camshaft"]))
    error = GrindingError("camshaft", (3, 40), (2e-6, 0.1e-6), fresh)
    design = Design({"camshaft grinding": error}, 64, False, 0)
    phases = []
    for train in rows(design, SAMPLE)[:8]:
        settings = design.settings(design.values[train])
        lift = np.array([settings[f"camshaft.table_lift[{i + 1}]"] for i in range(PLACES.size)])
        wave = np.fft.rfft(lift - fresh.points.lift) * 2.0 / PLACES.size
        # Points at breaks of the profile are up to a quarter of a degree off the even mesh.
        assert np.abs(wave[[3, 40]]) == pytest.approx([2e-6, 0.1e-6], rel=0.02)
        assert np.abs(np.delete(wave, [3, 40])).max() < 0.02e-6
        phases.append(np.angle(wave[3]))
    assert np.ptp(phases) > math.pi


def test_the_yield_amid_a_tolerance_is_that_without_it():
    """Good is |3 a + b| < 4, with a and b normal: a costs most, and b hardly anything."""
    design = Design(alone(a=stats.norm(0.0, 1.0), b=stats.norm(0.0, 1.0)), 2048, False, 0)
    sample = design.values[rows(design, SAMPLE)]
    good = np.abs(sample @ [3.0, 1.0]) < 4.0
    found = find_yield(good)
    assert found.low < 2.0 * stats.norm.cdf(4.0 / math.sqrt(10.0)) - 1.0 < found.high
    without = [find_middle_yield(good, design.sample[:, k]) for k in range(2)]
    assert without[0].low > found.high
    assert without[1].low < found.high


def test_an_end_of_an_interval_that_the_sample_is_too_small_for_is_unknown():
    """Of n values all lie below the 99.9 % quantile with a chance of 0.999^n: 2.5 % for 3688."""
    few, enough, fewest = np.arange(3680.0), np.arange(3690.0), np.arange(16.0)
    assert find_percentile(fewest, 99.9)[:2] == (15.0, 15.0)
    assert math.isnan(find_percentile(few, 99.9).high)
    assert math.isfinite(find_percentile(enough, 99.9).high)


def test_the_worst_trains_are_on_the_side_of_the_limit_that_fails():
    """A lower limit fails at the least values; without a limit less load is worse, and more pressure."""
    results = describe_numbers(load("valve-train"))
    limits = parse_limits(["contact.least_load > 20 N", "seating_velocity < 0.4 m/s"], results)
    sides = {"contact.least_load": 0.1, "valve_spring.seating_velocity": 99.9}
    assert {name: find_worst(name, limits) for name in sides} == sides
    assert (find_worst("a.spring_margin", []), find_worst("a.peak_pressure", [])) == (0.1, 99.9)


def test_trains_whose_coils_clash_are_counted():
    """Those without a cycle are no trains; coils that close one after the other may."""
    values = {"spring.least_gap": np.array([1e-3, -0.3e-3, -0.9e-3, np.nan])}
    (said,) = describe_clashes(values, build_system(load("coil-clash")))
    assert said.startswith("warning: components.spring: its coils clash in 2 of 3 trains, by up to 0.9 mm of")
    progressive = build_system(load("coil-clash", ["components.spring.parameters.gap[1] = 0.5 mm"]))
    assert not list(describe_clashes(values, progressive))


def make_trains(design: Design, change: dict[int, float], failed: int) -> xarray.Dataset:
    """Trains that are steady but for some, whose motion a period changes so much, and one that failed."""
    numbers = np.arange(len(design))
    return xarray.Dataset(
        {
            "status": ("train", np.where(numbers == failed, FAILED, DONE)),
            "change": ("train", [np.nan if k == failed else change.get(k, 1e-7) for k in numbers]),
            "message": ("train", ["mass < 0" if k == failed else "" for k in numbers]),
            "mass": ("train", design.values[:, 0]),
        }
    )


def test_the_yield_is_that_of_the_trains_with_a_steady_cycle():
    """A train without says nothing of a limit, and is told; one that changes by 0.1 % from turn to turn is
    judged."""
    design = Design(alone(mass=stats.norm(2.0, 1.0)), 8, True, 0)
    trains = make_trains(design, {3: 0.1, 5: 9e-4, 6: 0.1}, failed=4)
    usable = find_usable(trains, design)
    assert np.flatnonzero(~usable).tolist() == [3, 4, 6]
    lost, rippled = describe_cycles(trains, design, usable)
    assert lost.startswith("no steady cycle: 3 of 27 trains, 3 of them among the 16 sampled; ")
    assert "train 3 with mass = " in lost
    assert lost.endswith("a period still changes the motion by 10 %")
    assert rippled == "of 1 train counted as steady a period still changes the motion, by up to 0.09 %"
    limits = parse_limits(["least_load > 0 N"], describe_numbers(load("valve-train")))
    figure = np.where(np.arange(len(design)) == 7, -1.0, 1.0)
    values = {"contact.least_load": np.where(usable, figure, np.nan)}
    found = find_yields(values, usable, design, limits)
    assert found["yield"].sel(end="value").values == pytest.approx([12.0 / 13.0] * 2)
    none = find_yields({"valve.bounce": values["contact.least_load"]}, usable, design, limits)
    assert none["yield"].sel(end="value").values == pytest.approx(0.0)
    percentiles = ("figure", "percent", "end"), np.zeros((0, 1, 3))
    counted = found.assign_coords(figure=np.array([], str)).assign(percentile=percentiles)
    said = list(describe(counted.assign_attrs(sampled=16, steady=13), limits))
    assert all("92.31 % of the trains with a steady cycle keep" in line for line in said)
    with pytest.raises(RunError, match="no sampled train"):
        find_usable(trains.assign(status=("train", np.full(len(design), FAILED))), design)


def test_what_a_figure_varies_most_with_is_told_though_all_trains_keep_their_limits():
    """Of the limits' figures, else of three; a further parameter where its interval is above 0."""
    ends = np.array([[0.1, -0.02, 0.2], [0.7, 0.6, 0.8], [0.25, 0.2, 0.3], [np.nan] * 3])
    dataset = xarray.Dataset(
        {"total": (("figure", "factor", "end"), np.stack([ends[[0, 0, 3, 3]], *[ends] * 4]))},
        {
            "figure": ["a.bounce", "contact.least_load", "b.lift", "c.lift", "d.lift"],
            "factor": ["mass", "preload", "rate", "grinding"],
            "end": ["value", "low", "high"],
        },
    )
    limits = parse_limits(["least_load > 0 N"], describe_numbers(load("valve-train")))
    told = (
        "contact.least_load varies most with preload 0.7 (0.6 to 0.8), rate 0.25 (0.2 to 0.3): total Sobol' "
        "indices"
    )
    assert list(rank(dataset, limits)) == [told]
    first, second, _ = rank(dataset, [])
    assert first == "a.bounce varies most with mass 0.1 (-0.02 to 0.2): total Sobol' indices"
    assert second == told
    assert not list(rank(dataset.assign(total=np.nan * dataset["total"]), limits))


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"parameters": {"valve_spring.preloads": NORMAL}}, "did you mean"),
        ({"parameters": {"camshaft.law": {"kind": "uniform", "low": 0, "high": 1}}}, "no values in between"),
        ({"parameters": {"valve_spring.preload": {"kind": "normal", "deviation": "5 mm"}}}, "deviation"),
        ({"parameters": {"valve_spring.preload": {"kind": "normal", "deviation": 0}}}, "must be > 0"),
        ({"parameters": {"valve_spring.preload": {"kind": "uniform", "low": 9, "high": 1}}}, "less than"),
        ({"parameters": {"valve_spring.preload": {"kind": "gaussian"}}}, "one of normal, uniform"),
        ({"parameters": {"flywheel.initial_speed": NORMAL}}, "speed of the cycle"),
        ({"parameters": {"valve_spring.preload": {**NORMAL, "low": "900 N"}}}, "leave .* % of the distr"),
        ({"speed": 2000}, r"^speed = 2000.*: write the unit"),
        ({"limits": ["peak_pressure < 600"]}, "600 Pa"),
        ({"grinding": {"flywheel": {"amplitudes": {3: "1 um"}}}}, "is no cam; .*camshaft"),
        ({"limits": ["seating < 1 m/s"]}, "seating_velocity"),
        ({"limits": ["seating_velocity < 1 mm"]}, "does not fit"),
        ({"limits": ["seating_velocity"]}, "write a figure"),
        ({"limits": ["least_load > 9 N", "contact.least_load < 5 N"]}, "no train keeps both"),
        ({"count": 100}, "power of two"),
        ({"grinding": {"camshafts": {"amplitudes": {3: "1 um"}}}}, "camshaft"),
        ({"grinding": {"camshaft": {"amplitudes": {300: "1 um"}}}}, "from 1 to 90"),
        ({"parameters": {}}, "missing"),
        ({"sped": 4}, "sped: unknown key; did you mean speed"),
    ],
)  # fmt: skip
def test_a_mistake_is_named_with_its_remedy(changes, why):
    with pytest.raises(MistakeError, match=why):
        make_subject(read_changed("valve-train", DRY), parse_tolerances({**GIVEN, **changes}))


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "a head and two values"),
        ("preload [N]\n300\n", "a head and two values"),
        ("preload\n300\n310\n", r"has no unit; .* preload \[N\]"),
        ("preload [N]\n300\nnan\n310\n", "not a number"),
        ("first [N],second [N]\n300,1\n310,2\n", "must be one of first, second"),
    ],
)
def test_a_file_of_measured_values_that_cannot_be_used_is_named(text, why, tmp_path):
    (tmp_path / "lots.csv").write_text(text)
    measured = {"valve_spring.preload": {"kind": "measured", "file": tmp_path / "lots.csv"}}
    with pytest.raises(MistakeError, match=f"lots.csv.*{why}"):
        make_subject(read_changed("valve-train", DRY), parse_tolerances({**GIVEN, "parameters": measured}))


def test_a_train_is_the_same_in_any_process_and_order(monkeypatch):
    monkeypatch.setattr(finder, "SAMPLES", 720)
    subject, _ = make_subject(read_changed("valve-train", DRY), parse_tolerances(GIVEN))
    forth = {train: subject.evaluate({"train": float(train)}) for train in (0, 3, 9)}
    from orchestrator.study.tolerances import subject as module

    module._open.cache_clear()
    elsewhere = pickle.loads(pickle.dumps(subject))
    back = {train: elsewhere.evaluate({"train": float(train)}) for train in (9, 3, 0)}
    assert str(forth) == str(dict(sorted(back.items())))


class Here:
    """Evaluates a study in this process, and is interrupted once after some points."""

    def __init__(self, interrupted_after: int) -> None:
        self.left = interrupted_after

    def run(self, plan: Plan, out: Path, where: Where, reporter: Any, overwrite: bool) -> int:
        versions = compute_fingerprint(plan.subject)
        with open_store(out, plan, versions, overwrite) as store:
            for point in store.pending():
                outcome = evaluate(plan.subject, plan.points[point], versions)
                assert isinstance(outcome, Outcome)
                store.record(point, outcome)
                store.flush()
                self.left -= 1
                if not self.left:
                    raise KeyboardInterrupt
        return 0


def test_the_command_continues_what_was_interrupted_and_finds_percentiles_and_yield(tmp_path, monkeypatch):
    """Two trains are left to two workers, processes of their own; nothing is evaluated twice."""
    here, file = Here(interrupted_after=17), tmp_path / "given.toml"
    monkeypatch.setattr(study, "run", here.run)
    monkeypatch.setattr(finder, "SAMPLES", 720)
    lines = [f"{key} = {json.dumps(GIVEN[key])}" for key in ("speed", "count", "indices", "limits")]
    lines += ['[parameters."valve_spring.preload"]', 'kind = "normal"', 'deviation = "5 %"']
    file.write_text("\n".join(lines))
    out = tmp_path / "found"
    idle = "components.camshaft.parameters.power_p=7"
    arguments = ["tolerances", "valve-train", str(file), "--out", str(out), "--set", *DRY, "--set", idle]
    stopped = called(*arguments)
    assert stopped.returncode == 130
    assert f"the trains are kept in {out}: the same command continues" in stopped.stderr
    with monkeypatch.context() as patch:
        patch.setattr(study, "run", run)
        done = called(*arguments, "--workers", "2")
    assert done.returncode == 0, done.stderr
    assert "of the trains keep it" in done.stdout
    assert (out / "yield.csv").read_text().splitlines()[1].endswith(",16,16")
    file.write_text(file.read_text().replace("< 700 N", "< 600 N"))
    judged = called(*arguments)
    assert "largest_spring_force < 600 N: " in judged.stdout, judged.stderr
    assert here.left == 0
    table = (out / "percentiles.csv").read_text("utf-8")
    assert table.startswith("figure,unit,mean,deviation,0.1 %")
    with xarray.open_dataset(out / "tolerances.nc", engine="h5netcdf") as found:
        force = found.sel(figure="valve_spring.largest_spring_force")["linear"]
        # The spring's force is its preload and what lift and surge add, which the preload hardly changes.
        spread = float(force.sel(percent=99.0) - force.sel(percent=50.0))
    assert spread == pytest.approx(0.05 * 330.0 * stats.norm.ppf(0.99), rel=1e-3)
    assert (out / "tolerances.png").stat().st_size > 10_000
    page = (out / "tolerances.html").read_text("utf-8")
    assert "percentiles.csv" in page
    assert "friction outside the motion: cam contact (contact)" in page
    assert "the film is thinner" not in page  # a dry contact has none
    assert "power_p: has an effect only where law is high_powers" in page
    assert judged.stdout.count("power_p: has an effect") == 1
