"""Steps of FMI 3.0 that end early, event mode, and what hosts do in the course of a step."""

from __future__ import annotations

import math
from pathlib import Path

import fmpy
import pytest

from ..instance import Instance3
from ..reference import Reference

Files = dict[str, Path]

START = {"crank_speed": 100.0, "psi_start": 5e-4}
# The fifth impact is before, the sixth after.
STOP = 0.07
# Instants are found to the integrator's tolerance; flights of this mechanism are exact to rounding.
INSTANT = 1e-12


def impacts(step: float) -> list[float]:
    """Instants of the component's impacts, from steps with at most one each."""
    reference = Reference("slider_crank")
    component = reference.component
    reference.x[component.state.index("psi")] = START["psi_start"]
    found = []
    for i in range(round(STOP / step)):
        reference.t = i * step
        reference.set_inputs(
            {"crank_angle": 100.0 * reference.t, "crank_angle_der1": 100.0, "crank_speed": 100.0}
        )
        reference.step(step)
        at = reference.y[component.outputs.index("last_event_time")]
        if at > 0.0 and at not in found:
            found.append(float(at))
    return found


def turning(slave: Instance3, t: float) -> None:
    slave.set({"crank_angle": 100.0 * t, "crank_angle_der1": 100.0, "crank_speed": 100.0})


@pytest.mark.parametrize("step", [1e-3, 5e-2])
def test_steps_end_at_impacts(step: float, fmi3_files: Files) -> None:
    """Also at the first of many in a step. The impact is due at the return, and happens in event mode."""
    expected = impacts(1e-3)
    slave = Instance3(fmi3_files["slider_crank"], eventModeUsed=True, earlyReturnAllowed=True)
    slave.initialize(**START)
    t, found = 0.0, []
    while t < STOP - 1e-9:
        turning(slave, t)
        before = slave.get(["event_count"])
        event, ended, early, reached = slave.step(t, min(step, STOP - t))
        assert not ended
        assert event == early
        assert slave.get(["time"]) == [reached]
        t = reached
        if event:
            turning(slave, t)
            assert slave.get(["event_count"]) == before
            (rate,) = slave.get(["psi_rate"])
            found.append(t)
            slave.fmu.enterEventMode()
            slave.handle_events()
            assert slave.get(["event_count"])[0] == before[0] + 1.0
            assert slave.get(["psi_rate"])[0] != rate
    assert found == pytest.approx(expected, rel=0.0, abs=INSTANT)
    assert len(found) >= 5
    slave.free()


def test_without_event_mode_steps_end_after_impacts(fmi3_files: Files) -> None:
    slave = Instance3(fmi3_files["slider_crank"], earlyReturnAllowed=True).initialize(**START)
    t, found = 0.0, []
    while t < STOP - 1e-9:
        turning(slave, t)
        event, _, early, t = slave.step(t, min(5e-2, STOP - t))
        assert not event
        assert slave.get(["event_count"])[0] == len(found) + early
        found += [t] * early
    assert found == pytest.approx(impacts(1e-3), rel=0.0, abs=INSTANT)
    slave.free()


def test_steps_do_not_end_early_where_the_host_does_not_allow_it(fmi3_files: Files) -> None:
    slave = Instance3(fmi3_files["slider_crank"], eventModeUsed=True).initialize(**START)
    turning(slave, 0.0)
    assert slave.step(0.0, STOP) == (False, False, False, STOP)
    assert slave.get(["event_count"])[0] == len(impacts(1e-3))
    slave.free()


def test_chatter_ends(fmi3_files: Files) -> None:
    """Impacts ever faster, which end by sliding: time goes on over each of them. The motion is the same.

    Between the sequences it slides, and is released three times; a release that rounding makes before the
    wall's force is zero is followed by one more impact, without effect.
    """
    start = {"crank_speed": 100.0, "psi_start": 5e-4, "restitution": 0.1}
    slave = Instance3(fmi3_files["slider_crank"], eventModeUsed=True, earlyReturnAllowed=True)
    slave.initialize(**start)
    plain = Instance3(fmi3_files["slider_crank"]).initialize(**start)
    turning(plain, 0.0)
    plain.step(0.0, 0.1)
    t, calls = 0.0, 0
    while t < 0.1 - 1e-9:
        turning(slave, t)
        event, _, _, t = slave.step(t, 0.1 - t)
        calls += 1
        if event:
            slave.fmu.enterEventMode()
            slave.handle_events()
    (count,), (expected,) = slave.get(["event_count"]), plain.get(["event_count"])
    assert expected <= count <= expected + 3.0
    assert 20 < calls <= count + 1.0
    names = ["psi", "psi_rate", "upper_impact_impulse", "lower_impact_impulse", "sliding"]
    assert slave.get(names) == pytest.approx(plain.get(names), rel=1e-9, abs=1e-12)
    for one in (slave, plain):
        one.free()


def test_known_events_are_told(fmi3_files: Files) -> None:
    slave = Instance3(fmi3_files["flywheel"], eventModeUsed=True)
    slave.set({"ramp_duration": 0.5, "initial_speed": 4.0, "motion": 1.0})
    slave.fmu.enterInitializationMode()
    slave.fmu.exitInitializationMode()
    *_, defined, time = slave.fmu.updateDiscreteStates()
    assert (defined, time) == (True, slave.get(["next_event"])[0])
    slave.free()


@pytest.mark.parametrize("options", [{}, {"use_event_mode": True}, {"early_return_allowed": True}])
def test_a_host_runs_it_with_and_without_events(options: dict, fmi3_files: Files) -> None:
    """fmpy holds the inputs; the motion is that without event mode and early return."""
    kwargs = {
        "start_values": START,
        "stop_time": STOP,
        "output_interval": 1e-3,
        "output": ["psi", "psi_rate"],
    }
    fmu = str(fmi3_files["slider_crank"])
    plain = fmpy.simulate_fmu(fmu, fmi_type="CoSimulation", **kwargs)
    both = options | {"use_event_mode": True, "early_return_allowed": True}
    for chosen in (options, both):
        result = fmpy.simulate_fmu(fmu, fmi_type="CoSimulation", **kwargs, **chosen)
        assert result[-1].tolist() == pytest.approx(plain[-1].tolist(), rel=1e-10)


def cubic(t: float) -> float:
    return 3.0 + 40.0 * t - 5e3 * t**2 + 6e5 * t**3


def test_inputs_given_within_steps_are_cubic(fmi3_files: Files) -> None:
    """The host gives them at three points in a step: the same as with its derivatives at the beginning."""
    reference = [0]

    def give(time: float, setting: bool, finished: bool, possible: bool) -> None:
        seen.append((time, setting, finished))
        if setting:
            slave.fmu.setFloat64(reference, [cubic(time)])

    seen: list[tuple[float, bool, bool]] = []
    described = fmpy.read_model_description(str(fmi3_files["sprung_mass"]))
    (reference[0],) = (v.valueReference for v in described.modelVariables if v.name == "force")
    slave = Instance3(fmi3_files["sprung_mass"], update=give, requiredIntermediateVariables=reference)
    other = Instance3(fmi3_files["sprung_mass"])
    h = 1e-2
    for one in (slave, other):
        one.initialize(force=cubic(0.0))
    for i in range(10):
        t = i * h
        slopes = {
            "force_der1": 40.0 - 1e4 * t + 18e5 * t**2,
            "force_der2": -1e4 + 36e5 * t,
            "force_der3": 36e5,
        }
        other.set({"force": cubic(t)} | slopes)
        for one in (slave, other):
            one.step(t, h)
    # Differences of the third order, from values with an error of rounding.
    assert slave.outputs() == pytest.approx(other.outputs(), rel=1e-12, abs=1e-9)
    assert slave.get(["force"]) == pytest.approx([cubic(10 * h)], rel=1e-14)
    assert [round(t / h, 3) for t, _, _ in seen[:5]] == [0.0, 0.333, 0.667, 1.0, 1.0]
    assert [setting for _, setting, _ in seen[:5]] == [False, True, True, True, False]
    for one in (slave, other):
        one.free()


def test_a_host_ends_a_step_from_within(fmi3_files: Files) -> None:
    """The step is the one that ends there, to the last bit."""
    wanted = 3.7e-4

    def ask(time: float, setting: bool, finished: bool, possible: bool) -> float | None:
        return wanted if possible else None

    one = Instance3(fmi3_files["valve_spring"], update=ask, earlyReturnAllowed=True).initialize(load=500.0)
    two = Instance3(fmi3_files["valve_spring"]).initialize(load=500.0)
    assert one.step(0.0, 1e-3) == (False, False, True, wanted)
    two.step(0.0, wanted)
    assert one.outputs() == two.outputs()
    for slave in (one, two):
        slave.free()


def test_outputs_are_read_within_steps(fmi3_files: Files) -> None:
    """At the beginning and at the end of a step; other calls are refused there."""
    read = []

    def look(time: float, setting: bool, finished: bool, possible: bool) -> None:
        read.append((time, slave.get(["position"])[0]))
        for call in (slave.fmu.terminate, slave.fmu.reset, lambda: slave.step(time, 1e-5)):
            with pytest.raises(fmpy.fmi1.FMICallException):
                call()

    slave = Instance3(fmi3_files["valve_spring"], update=look).initialize(load=500.0)
    slave.step(0.0, 1e-3)
    (end,) = slave.get(["position"])
    assert read == [(0.0, 0.0), (1e-3, end)]
    assert not math.isclose(end, 0.0)
    assert "during an intermediate update" in slave.messages[-1][2]
    slave.free()
