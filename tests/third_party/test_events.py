"""Event mode of FMI 3.0 co-simulation FMUs: clocks, time events and discrete inputs."""

import warnings
from typing import Any

import fmpy
import numpy as np
import pytest

from models.core.system import ModelError, Port
from orchestrator.analyses.stability.trajectory import run_course
from orchestrator.participants.fmu import FmuParticipant
from orchestrator.participants.opened_fmu import FmuSettings
from orchestrator.participants.protocol import BoundVariables
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.system import build_system

from ..fmus.names import mark_long
from .clocked_fmus import DESCRIPTION, intervals, sampler
from .runs import completed, opened, public, ran, scenario

MASTERS: dict[str, dict[str, Any]] = {
    "jacobi": {"master": {"name": "jacobi"}},
    "iterated": {"master": {"name": "iterated"}},
    "control": {
        "master": {"name": "jacobi"},
        "step_control": {"estimator": "step_doubling", "minimum_step": 1e-9, "relative": 1e-2},
    },
}


def list_ticks(time: np.ndarray) -> np.ndarray:
    """How often a clock of 0.1 s has ticked at these times, that at 0 included."""
    return np.floor(time / 0.1 + 1e-9) + 1.0


@pytest.mark.parametrize(("process", "macro_step"), [("own", 0.01), ("shared", 0.04)])
def test_periodic_and_countdown_clocks_tick_at_their_times(process, macro_step, tmp_path):
    """Also where they lie inside macro steps: the FMU refuses a tick at another time, and a step beyond its
    time event. Every second tick is followed by an alarm after 0.03 s."""
    table = {"participant": sampler(tmp_path), "process": process, "inputs": {"u": 2.0}}
    found = completed(scenario({"one": table}, macro_step=macro_step), tmp_path / "out")
    ticks = list_ticks(found["time"])
    np.testing.assert_array_equal(found["one.ticks"], ticks)
    np.testing.assert_allclose(found["one.y"], 0.2 * ticks, rtol=1e-12)
    np.testing.assert_allclose(found["one.last"], 0.1 * (ticks - 1.0), rtol=0, atol=1e-12)
    np.testing.assert_array_equal(found["one.level"], found["time"] > 0.25 - 1e-9)
    alarms = np.floor((found["time"] + 0.07) / 0.2 + 1e-9)
    np.testing.assert_array_equal(found["one.alarms"], alarms)


TICKS = {
    "fixed": 0.02 + 0.1 * np.arange(10),
    "tunable": 0.2 * np.arange(6),
    "asked": 0.05 + 0.125 * np.arange(8),
    "tuned": np.array([0.0, 0.2, 0.4, 0.55, 0.7, 0.85, 1.0]),
    "changing": np.array([0.05, 0.15, 0.3, 0.5, 0.75]),
}
# Of clocks with other intervals than they state.
GIVEN = {"fixed": 0.02 + 0.07 * np.arange(15), "tunable": 0.25 * np.arange(5)}


@pytest.mark.parametrize(
    ("macro_step", "process", "given"),
    [
        (0.3, "own", {}),
        (0.3, "shared", {"fixed": "70 ms", "tunable": 0.25}),
        pytest.param(0.01, "shared", {"fixed": "70 ms", "tunable": 0.25}, marks=pytest.mark.long),
    ],
)
def test_clocks_of_every_interval_tick_at_their_times(macro_step, process, given, tmp_path):
    """The number of ticks and the sum of their times, at the end of every step."""
    table = {"participant": intervals(tmp_path), "process": process, "parameters": given}
    found = completed(scenario({"one": table}, macro_step=macro_step), tmp_path / "out")
    due = {**TICKS, **{name: GIVEN[name] for name in given}}
    for name, times in due.items():
        ticked = [times[times <= t + 1e-9] for t in found["time"]]
        np.testing.assert_array_equal(found[f"one.{name}_ticks"], [len(one) for one in ticked])
        sums = [one.sum() for one in ticked]
        np.testing.assert_allclose(found[f"one.{name}_sum"], sums, rtol=1e-12, atol=1e-12)
    for times in due.values():
        assert all(np.min(np.abs(found["time"] - t)) < 1e-12 for t in times)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"tunable": 0.0}, r"tunable = 0 s \(interval of the clock tunable\): must be > 0"),
        ({"asked": 0.1}, "no such parameter"),
    ],
)
def test_intervals_that_a_clock_cannot_have_are_refused(given, said, tmp_path):
    with pytest.raises((ScenarioError, ModelError), match=said):
        build_system(scenario({"one": {"participant": intervals(tmp_path), "parameters": given}}))


def test_a_countdown_that_a_discrete_input_starts_ticks_at_its_time(tmp_path):
    """The ticks of one, five at 0.4 s, set the alarm of the other, which ticks 0.03 s later."""
    path = sampler(tmp_path)
    one = scenario(
        {"one": {"participant": path}, "two": {"participant": path}},
        connections=["one.ticks -> two.gain"], macro_step=0.04, stop_time=0.5, master={"name": "jacobi"},
    )  # fmt: skip
    found = completed(one, tmp_path / "out")
    times, alarms = found["time"], found["two.alarms"]
    rises = times[np.flatnonzero(np.diff(alarms) > 0) + 1]
    np.testing.assert_allclose(rises, [0.13, 0.33, 0.43], atol=1e-9)


@pytest.mark.parametrize(
    ("process", "master"), [("own", "jacobi"), ("shared", "iterated"), ("shared", "control")]
)
def test_a_clock_ticks_another_fmu_at_the_same_instant(master, process, tmp_path):
    """`fired` of one is `poke` of the other, and what the one has sampled is seen at once by it: scaled
    = gain y holds at every instant, whatever the master."""
    path = sampler(tmp_path)
    tables = {
        "one": {"participant": path, "process": process, "inputs": {"u": 2.0}},
        "two": {"participant": path, "process": process},
    }
    lines = ["one.y -> two.gain", "one.fired -> two.poke", "one.ticks -> two.u"]
    one = scenario(tables, connections=lines, macro_step=0.04, **MASTERS[master])
    found = completed(one, tmp_path / "out")
    ticks = list_ticks(found["time"])
    np.testing.assert_array_equal(found["two.ticks"], ticks)
    np.testing.assert_array_equal(found["two.pokes"], np.floor(ticks / 2.0))
    np.testing.assert_allclose(found["two.scaled"], found["one.y"] * found["two.y"], rtol=1e-12)
    # Both tick at once; the second has what the first had before, or has got, in the order of events.
    np.testing.assert_allclose(found["two.y"], 0.1 * ticks * (ticks + 1.0) / 2.0, rtol=1e-12)
    assert set(np.round(found["time"] / 0.05).astype(int)) >= set(range(0, 21, 2)) | {5}


def test_a_resumed_run_has_the_same_bits(tmp_path):
    """Times of ticks and events are in what is saved of the FMU."""
    path = sampler(tmp_path)
    units = [FmuParticipant("one", path, FmuSettings(["ticks", "alarms"])) for _ in range(2)]
    for unit in units:
        bound = BoundVariables([], np.zeros((1, 0)), ["ticks", "alarms"], np.zeros(2), np.zeros(0))
        unit.connect(bound)
        unit.initialise(0.0, 1.0)
        unit.finish_initialisation()
    first, second = units
    first.advance(0.0, 0.11)
    second.restore(second.from_bytes(first.to_bytes(first.save())))
    for unit in units:
        unit.advance(0.11, 0.21)
    found = [np.zeros(2), np.zeros(2)]
    for unit, values in zip(units, found, strict=True):
        unit.read_all(values)
        unit.close()
    np.testing.assert_array_equal(found[0], [4.0, 1.0])
    np.testing.assert_array_equal(found[1], found[0])


@pytest.mark.parametrize("name", mark_long(["BouncingBall", "Stair", "Feedthrough"], ["Stair"]))
def test_event_mode_gives_what_fmpys_importer_finds(name, tmp_path):
    """Of Reference-FMUs, at the times of the macro steps: an independent importer in event mode."""
    path = public(f"reference-fmus-3/{name}.fmu")
    _, found = ran(scenario({"one": {"participant": path}}, macro_step=0.1, stop_time=2.0), tmp_path / "out")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        other = fmpy.simulate_fmu(
            str(path), stop_time=2.0, output_interval=0.1, use_event_mode=True, early_return_allowed=True,
            fmi_type="CoSimulation",
        )  # fmt: skip
    for column in set(other.dtype.names) & {n.removeprefix("one.") for n in found} - {"time"}:
        last = {round(t, 6): float(v) for t, v in zip(other["time"], other[column], strict=True)}
        ours = {round(t, 6): v for t, v in zip(found["time"], found[f"one.{column}"], strict=True)}
        for t in np.round(np.arange(0.0, 2.05, 0.1), 6):
            assert ours[t] == pytest.approx(last[t], rel=1e-12, abs=1e-12), (column, t)


def test_an_end_in_an_event_is_named_and_recorded(tmp_path):
    """The public stair ends at its ninth second."""
    one = scenario(
        {"one": {"participant": public("reference-fmus-3/Stair.fmu")}}, stop_time=12.0, macro_step=0.3
    )
    summary, found = ran(one, tmp_path / "out")
    assert summary.exit_status == 3
    assert "one: the FMU asks to end the simulation in an event at t = 9 s" in summary.message
    assert found["time"][-1] == pytest.approx(9.0, rel=1e-12)


def test_a_run_up_to_the_end_that_an_fmu_asks_for_is_complete(tmp_path):
    stair = {"participant": public("reference-fmus-3/Stair.fmu")}
    summary, found = ran(scenario({"one": stair}, stop_time=9.0, macro_step=0.3), tmp_path / "out")
    assert summary.exit_status == 0
    assert (found["time"][-1], found["one.counter"][-1]) == (9.0, 10.0)


def test_an_analysis_records_at_its_own_times(tmp_path):
    """Steps that end at events lie between them."""
    one = scenario({"one": {"participant": sampler(tmp_path), "inputs": {"u": 2.0}}})
    times = np.linspace(0.0, 1.0, 26)
    with opened(one) as (plan, units):
        found = run_course(plan.system, units, plan.master, times, lambda share: None)
    ticks = found.outputs[:, plan.system.outputs.index(Port("one", "ticks"))]
    np.testing.assert_array_equal(ticks, list_ticks(times))


def test_clocks_that_nobody_would_tick_are_refused(tmp_path):
    plain = DESCRIPTION.replace('hasEventMode="true" ', "")
    with pytest.raises(ScenarioError, match=r"has clocks \(tick, alarm, poke\), which tick in co-simulation"):
        ran(scenario({"one": {"participant": sampler(tmp_path, plain)}}), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_an_event_that_stays_due_does_not_stop_the_run(tmp_path):
    """Of an FMU whose next event is at the present for ever."""
    table = {"participant": sampler(tmp_path), "inputs": {"u": 2.0, "gain": -1.0}}
    found = completed(scenario({"one": table}, macro_step=0.04), tmp_path / "out")
    np.testing.assert_array_equal(found["one.ticks"], list_ticks(found["time"]))
    np.testing.assert_allclose(found["one.scaled"], -found["one.y"], rtol=1e-15)
