"""Sessions: a run step by step from Python, with the bits of the run, and inputs that are set on the way."""

import os
import threading
from typing import Any

import pytest

import tribocosim

SHORT = {"stop_time": "4 ms", "reference.enabled": False}


@pytest.mark.parametrize("name", ["valve-train", "valve-train-controlled"])
def test_a_session_makes_the_steps_of_the_run_to_the_bit(name: str) -> None:
    """Also after going back to a snapshot, and to the start."""
    scenario = tribocosim.load(name).with_(SHORT)
    run = tribocosim.run(scenario).coupled
    loads = dict(zip(run["time"].values.tolist(), run["contact.load"].values.tolist(), strict=True))

    def follow(session: tribocosim.session, until: float) -> int:
        seen = 0
        while session.time < until:
            session.step()
            if session.time in loads:
                assert session["contact.load"] == loads[session.time]
                seen += 1
        return seen

    with tribocosim.session(scenario) as session:
        follow(session, 1e-3)
        snapshot = session.save()
        assert follow(session, 4e-3) > 10
        session.restore(snapshot)
        assert session.time == snapshot.time
        assert follow(session, 4e-3) > 10
        session.reset()
        assert follow(session, 4e-3) > 10
        with pytest.raises(tribocosim.MistakeError, match="stop_time"):
            session.step()


def test_a_closed_session_says_so() -> None:
    """Its FMUs have ended: calling them would end this process."""
    with tribocosim.session("two-masses") as session:
        session.step()
        snapshot = session.save()
    name = next(iter(session._outputs.names))
    for use in (
        session.step,
        session.save,
        session.reset,
        lambda: session[name],
        lambda: session.step_until(1.0),
        lambda: session.restore(snapshot),
        lambda: session.set("second.force", 0.0),
    ):
        with pytest.raises(tribocosim.MistakeError, match="the session is closed"):
            use()
    session.close()


def test_times_of_a_session_have_an_end_and_what_cannot_be_set_is_named() -> None:
    with tribocosim.session(tribocosim.load("two-masses")) as session:
        assert session.step_until("20 ms") == pytest.approx(0.02, abs=session.stop_time * 1e-3)
        with pytest.raises(tribocosim.MistakeError, match="is behind the session's stop_time"):
            session.step_until(1e3)
        assert session.step_until(session.time) == session.time
        for past in ("5 ms", -1.0, float("nan")):
            with pytest.raises(tribocosim.MistakeError, match="must not be before the session's"):
                session.step_until(past)
        with pytest.raises(tribocosim.MistakeError, match="must be one of"):
            session["nothing"]
        for name, value, message in (
            ("second.force", 0.0, r"is driven by first\.force"),
            ("first.mass", 1.0, r"is a parameter; take scenario\.with_"),
            ("first.force", 1.0, "no input is free: connections drive all"),
        ):
            with pytest.raises(tribocosim.MistakeError, match=message):
                session.set(name, value)


FLYWHEEL = {"motion": "free", "inertia": 0.2, "initial_speed": 100.0}
START = {"speed": 100.0}


def spin(**component: Any) -> tribocosim.Scenario:
    """A free flywheel without load."""
    table = {"component": "flywheel", "parameters": FLYWHEEL, "start": START, **component}
    return tribocosim.load(
        {
            "stop_time": 0.1,
            "macro_step": 1e-3,
            "components": {"wheel": table},
            "reference": {"enabled": False},
        }
    )


@pytest.mark.parametrize(
    "kind",
    [
        {"participant": "in-process"},
        {"participant": "fmu"},
        {"participant": "fmu", "process": "own"},
        {"participant": "native"},
    ],
    ids=lambda kind: " ".join(kind.values()),
)
def test_an_input_that_is_set_acts_from_then_on(kind: dict[str, str]) -> None:
    """J omega' = T, exact for a constant torque; going back restores the input too."""
    with tribocosim.session(spin(**kind)) as session:
        session.step_until(0.01)
        before = session.save()
        for wrong in ("3 mm", float("nan")):
            with pytest.raises(tribocosim.MistakeError, match=r"wheel\.drive_torque"):
                session.set("wheel.drive_torque", wrong)
        session.set("wheel.drive_torque", "3 N.m")
        assert session["wheel.acceleration"] == pytest.approx(15.0, rel=1e-12)
        session.step_until(0.03)
        assert session["wheel.speed"] == pytest.approx(100.0 + 15.0 * 0.02, rel=1e-12)
        session.restore(before)
        session.step_until(0.03)
        assert session["wheel.speed"] == pytest.approx(100.0, rel=1e-12)
        session.reset()
        assert (session.time, session["wheel.speed"]) == (0.0, 100.0)


def test_a_coupled_input_that_is_set_to_what_it_is_changes_nothing() -> None:
    """But for the signals, which begin anew: within the error of the coupling."""
    scenario = tribocosim.load("valve-train").with_(SHORT)
    with tribocosim.session(scenario) as plain, tribocosim.session(scenario) as set_anew:
        for session in (plain, set_anew):
            session.step_until(2e-3)
        assert "valve_spring.gas_force" in set_anew.inputs
        assert "valve_spring.position" not in set_anew.inputs
        set_anew.set("valve_spring.gas_force", 0.0)
        for session in (plain, set_anew):
            session.step_until(4e-3)
        assert set_anew["contact.load"] == pytest.approx(plain["contact.load"], rel=1e-4)


def test_loading_fmus_never_changes_the_working_folder_of_other_threads() -> None:
    before, seen, stop = os.getcwd(), set(), threading.Event()

    def watch() -> None:
        while not stop.is_set():
            seen.add(os.getcwd())

    thread = threading.Thread(target=watch)
    thread.start()
    for _ in range(20):
        with tribocosim.session(spin(participant="fmu")):
            pass
    stop.set()
    thread.join()
    assert seen == {before}
