"""Participants that misbehave: retried where that helps, otherwise named, with what was computed kept."""

import dataclasses
import itertools
import math
import re
import tempfile

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave
from scipy.linalg import expm

from fmus.build import build
from models.catalogue import CATALOGUE
from models.core.system import Instance, System
from models.oscillators.bouncing_mass import falling_mass, spring_stop
from models.oscillators.two_masses import CoupledMassParameters
from orchestrator.engine.step import DISCARD, EVENT, SHORTEST
from orchestrator.errors import (
    DiscardedStepError,
    LostParticipantError,
    NotFiniteError,
    ParticipantError,
    RecoverableError,
)
from orchestrator.masters import GaussSeidel, Iterated, Jacobi
from orchestrator.participants.failures import ErrorReporter
from orchestrator.participants.in_process import InProcessParticipant as in_process
from orchestrator.participants.open_fmu import open_fmu
from orchestrator.run.plan import FmuFile, ParticipantPlan, open_participants
from orchestrator.run.simulation import simulate
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system
from orchestrator.stepping import ControlledSteps, StepControl
from tests.models import exact_oscillators as solutions

from .coupled import Recorder, run_coupled
from .faulty import (
    CONTROLLED,
    STOP,
    TOLERANCE,
    Faulty,
    after,
    at_random,
    controlled,
    every,
    faulty,
    longer_than,
    missed,
    simulated,
    sound,
)
from .small_fmus import small_fmu
from .two_masses import two_masses

JUMP, OFFSET = 0.5, 0.1


def nan_every(number):
    """Of what is read now and then, not a number."""
    count = itertools.count(1)
    return lambda time, name, value: math.nan if next(count) % number == 0 else value


def pair(faults):
    """Every fault with every kind of run; of these one by default."""
    return pytest.mark.parametrize(
        ("fault", "kind"),
        [
            pytest.param(fault, kind, marks=[pytest.mark.long] * ((i + j) % 3 > 0))
            for i, fault in enumerate(faults)
            for j, kind in enumerate(CONTROLLED)
        ],
    )


# More calls than an attempt takes: at the start the two of step doubling have up to eight sweeps each.
OFTEN = 37

TRANSIENT = {
    "discards longer steps": lambda: {"discards": longer_than(3e-3)},
    "discards now and then": lambda: {"discards": every(OFTEN)},
    "discards at random": lambda: {"discards": at_random(1.0 / OFTEN, seed=3)},
    "discards without a word": lambda: {"discards": every(OFTEN), "silent": True},
    "discards in mid-step": lambda: {"discards": every(OFTEN), "arrives": 0.4},
    "fails now and then": lambda: {"fails": every(OFTEN)},
    "not a number now and then": lambda: {"value": nan_every(2 * OFTEN)},
}


@pair(TRANSIENT)
def test_step_control_gets_past_what_passes(fault, kind):
    """Shorter steps do not make a result worse; a factor of two is left to how errors add up."""
    clean = sound(kind)
    unit = faulty(**TRANSIENT[fault]())
    recorder, ended = controlled(unit, kind)
    assert ended is None
    assert recorder.times[-1] == STOP
    assert missed(recorder) < 2.0 * missed(clean)
    assert sum(step.rejected for step in recorder.steps) > sum(step.rejected for step in clean.steps)
    assert DISCARD in {step.reason for step in recorder.steps}


PERMANENT = {
    "discards": ({"discards": after(0.5)}, DiscardedStepError, r"^second: step from t = 0\.5\d* s by "),
    "fails": ({"fails": after(0.5)}, RecoverableError, r"^second: step from t = 0\.5\d* s by .*failed"),
    "not a number": (
        {"value": lambda time, name, value: math.nan if time > 0.5 and name == "velocity" else value},
        NotFiniteError,
        r"^second\.velocity: not a finite number in the step from t = 0\.(49|5)",
    ),
}


@pair(PERMANENT)
def test_what_does_not_pass_is_named_after_the_shortest_step(fault, kind):
    faults, error, said = PERMANENT[fault]
    recorder, ended = controlled(faulty(**faults), kind)
    assert type(ended) is error
    assert re.search(said, str(ended))
    shortest = re.search(r"also with the shortest step of (\S+) s", str(ended))
    assert shortest
    assert 1e-7 <= float(shortest[1]) < 1e-6
    # The last good step ends where the fault begins, to the shortest step.
    assert recorder.times[-1] == pytest.approx(0.5, abs=2e-6) or recorder.times[-1] > 0.5
    assert missed(recorder) < 1e-3


@pytest.mark.parametrize("kind", CONTROLLED)
def test_a_dead_participant_is_not_called_again(kind):
    unit = faulty(dies=after(0.5))
    recorder, ended = controlled(unit, kind)  # Faulty asserts it
    assert type(ended) is LostParticipantError
    assert str(ended).startswith("second: step from t = 0.5")
    assert len([time for time, _ in unit.calls if time >= 0.5]) == 1
    assert recorder.times[-1] <= unit.calls[-1][0] + 1e-12


def exact_with_jump(times):
    """As `exact`, where from JUMP on the first mass sees the second one OFFSET further than it is."""
    p = CoupledMassParameters()
    k, d, kc, dc, m = p.stiffness, p.damping, p.coupling_stiffness, p.coupling_damping, p.mass
    a = np.array(
        [
            [0, 1, 0, 0, 0],
            [-(k + kc) / m, -(d + dc) / m, kc / m, dc / m, kc / m],
            [0, 0, 0, 1, 0],
            [kc / m, dc / m, -(k + kc) / m, -(d + dc) / m, -kc / m],
            [0, 0, 0, 0, 0],
        ]
    )
    start = np.array([1.0, 0.0, 0.0, 0.0, 0.0])
    later = expm(a * JUMP) @ start
    later[4] = OFFSET
    return np.array(
        [(expm(a * t) @ start if t <= JUMP else expm(a * (t - JUMP)) @ later)[[0, 2]] for t in times]
    )


@pytest.mark.parametrize(
    ("kind", "minimum_step"),
    [
        ("jacobi, step_doubling", 1e-6),
        ("jacobi, step_doubling", 1e-3),
        pytest.param("gauss_seidel, step_doubling", 1e-6, marks=pytest.mark.long),
        ("gauss_seidel, step_doubling", 1e-3),
        ("iterated, predictor_corrector", 1e-6),
    ],
)
def test_a_jump_is_closed_in_on_and_passed(kind, minimum_step):
    """While a signal misses the jump of 0.1 m, the masses of 1 kg are pushed wrongly by 40 N/m times that."""
    unit = faulty(value=lambda time, name, value: value + OFFSET * (name == "position" and time > JUMP))
    recorder, ended = controlled(unit, kind, minimum_step)
    assert ended is None
    over = int(np.searchsorted(recorder.times, JUMP, side="right"))
    steps = recorder.steps
    # A jump after the middle of a step that is made in halves is seen in the step that begins with it.
    assert sum(step.rejected for step in steps[over - 1 : over + 2]) > 0
    # The step to the jump is shortened more than once where the first shorter one still leads over it.
    assert min(step.length for step in steps[over : over + 2]) < max(s.length for s in steps[over - 6 : over])
    # Two signals are wrong: the one over the jump, and the one through the values on both sides of it.
    wrong = recorder.times[over + 1] - recorder.times[over - 1]
    slowest = math.sqrt(CoupledMassParameters().stiffness)  # rad/s, both masses together
    truth, clean = exact_with_jump(recorder.times), sound(kind)
    allowed = 2.0 * missed(clean) + 40.0 * OFFSET * wrong / slowest
    assert np.abs(recorder["first.position"] - truth[:, 0]).max() < allowed
    # What the shortest step cannot resolve is recorded as a discontinuity.
    passed = [step for step in steps if step.reason == SHORTEST]
    assert passed or minimum_step < 1e-3
    assert all(JUMP < step.end < JUMP + 5e-3 for step in passed)


@pytest.mark.parametrize("kind", CONTROLLED)
def test_an_output_that_keeps_jumping_is_named(kind):
    """Noise has no step that resolves it."""
    draw = np.random.default_rng(1)
    unit = faulty(
        value=lambda time, name, value: value + draw.normal() * (name == "position" and time > JUMP)
    )
    recorder, ended = controlled(unit, kind, 1e-4)
    # The first mass's force follows that position at once, and may be what misses most.
    assert re.match(r"(second\.position|first\.force)\b.* at t = 0\.(49|50)\d* s ", str(ended)), str(ended)
    assert "shortest step of" in str(ended)
    assert JUMP - 0.05 < recorder.times[-1] < JUMP + 0.05


def on_second_thoughts():
    """The first shorter attempt at every step: among them those that locate an event.

    Of attempts longer than a microsecond: what refuses all others can only end the run. Not the half of a
    step that is doubled.
    """
    tried, refused = {}, set()

    def when(time, step, n):
        whole = tried.setdefault(time, step)
        again = 1e-6 < step < 0.999 * whole and step != 0.5 * whole and time not in refused
        if again:
            refused.add(time)
        return again

    return when


def bouncing(kind, discards):
    """A mass that falls on a spring, for three contacts: the error of its position, and the recorder."""
    stop = dataclasses.replace(spring_stop(), event_indicators=("contact_margin",))
    system = System(
        {"mass": Instance(falling_mass(), {}, {"position": 0.01}), "stop": Instance(stop)},
        [
            ("mass.position", "stop.position"),
            ("mass.velocity", "stop.velocity"),
            ("stop.force", "mass.force"),
        ],
    )
    master, estimator = CONTROLLED[kind]
    control = StepControl(estimator, TOLERANCE, TOLERANCE, minimum_step=1e-8, maximum_step=5e-3)
    unit = Faulty(in_process("stop", system.instances["stop"]), discards=discards)
    recorder = run_coupled(system, master, ControlledSteps(1e-3, control), 0.4, stop=unit)
    assert unit.saved == unit.released
    truth = solutions.bouncing_mass(recorder.times, position=0.01).motion[:, 0]
    return np.abs(recorder["mass.position"] - truth).max(), recorder


@pytest.mark.parametrize("kind", ["jacobi, step_doubling", "iterated, predictor_corrector"])
def test_a_step_discarded_while_an_event_is_located_is_made_shorter(kind):
    error, clean = bouncing(kind, lambda time, step, n: False)
    again, recorder = bouncing(kind, on_second_thoughts())
    events = [sum(step.reason == EVENT for step in each.steps) for each in (clean, recorder)]
    assert events[0] == events[1] >= 5
    assert again < 2.0 * error


# Steps of one length.

FIXED = 1e-2
ENDING = {
    "discards": ({"discards": after(0.5)}, DiscardedStepError, r"^second: step from t = 0\.5 s by 0\.01 s"),
    "fails": ({"fails": after(0.5)}, RecoverableError, r"^second: step from t = 0\.5 s by 0\.01 s"),
    "dies": ({"dies": after(0.5)}, LostParticipantError, r"^second: step from t = 0\.5 s by 0\.01 s"),
    "infinite": (
        {"value": lambda time, name, value: math.inf if time > 0.505 and name == "velocity" else value},
        NotFiniteError,
        r"^second\.velocity: not a finite number in the step from t = 0\.5 s",
    ),
}


@pytest.mark.parametrize("master", [Jacobi("hold"), GaussSeidel("linear"), Iterated("quadratic")])
@pytest.mark.parametrize("fault", ENDING)
def test_with_fixed_steps_the_culprit_and_the_time_are_named(fault, master):
    faults, error, said = ENDING[fault]
    unit = faulty(**faults)
    recorder, ended = simulated(unit, master, FIXED)
    assert type(ended) is error
    assert re.search(said, str(ended))
    assert len(recorder.times) == 51
    assert unit.closed


VICES = {
    "refusing": (DiscardedStepError, r"^second: step .* returned Discard: no way on; .*second\.retries"),
    "raising": (LostParticipantError, r"^second: step .* returned Fatal: RuntimeError\('broken gear'\)"),
    "infinite": (NotFiniteError, r"^second\.velocity: not a finite number in the step from t = 0\.5"),
    "unready": (LostParticipantError, r"^second: initialise: RuntimeError\('no table found'\)"),
}


@pytest.fixture
def temporary(tmp_path, monkeypatch):
    """The folder of temporary files."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


@pytest.mark.parametrize("vice", VICES)
def test_an_fmu_that_fails_is_named_and_freed(vice, tmp_path, temporary, monkeypatch):
    error, said = VICES[vice]
    freed = []
    free = FMU2Slave.freeInstance
    monkeypatch.setattr(FMU2Slave, "freeInstance", lambda slave: freed.append(free(slave)))
    file = small_fmu(vice, tmp_path)
    recorder, ended = simulated(
        open_fmu("second", file, two_masses().instances["second"]), GaussSeidel("linear"), FIXED
    )
    assert type(ended) is error
    assert re.search(said, str(ended))
    assert len(recorder.times) == (0 if vice == "unready" else 52)
    # After fmi2Fatal no call is allowed, so that the instance has to be given up.
    assert len(freed) == (0 if error is LostParticipantError else 1)
    assert list(temporary.iterdir()) == []


def test_an_fmu_that_cannot_be_instantiated_is_named_and_the_others_are_closed(
    tmp_path, temporary, monkeypatch
):
    system, made = build_system(load("two-masses")), []
    first, second = system.instances
    open_bare = ParticipantPlan.open_bare

    def watched(plan, name, instance):
        made.append(Faulty(open_bare(plan, name, instance)))
        return made[-1]

    monkeypatch.setattr(ParticipantPlan, "open_bare", watched)
    plans = {first: ParticipantPlan(), second: ParticipantPlan(FmuFile(small_fmu("unborn", tmp_path), ""))}
    with (
        pytest.raises(ParticipantError, match=rf"^{second}: instantiate: RuntimeError\('no licence'\)"),
        open_participants(system, plans),
    ):
        pass
    assert [(unit.name, unit.closed) for unit in made] == [(first, True)]
    assert list(temporary.iterdir()) == []


def test_a_clock_that_drifts_is_refused_by_our_fmus(tmp_path):
    """A step has to begin where the last one ended, to 1e-9 of the time and 1e-6 of the step."""
    component = CATALOGUE["flywheel"]()
    system = System({"flywheel": Instance(component)}, [])
    unit = Faulty(open_fmu("flywheel", build("flywheel", tmp_path), system.instances["flywheel"]), drift=1e-4)
    unit._inner.advance, true = lambda time, step: true(time / (1.0 + 1e-4), step), unit._inner.advance
    recorder = Recorder()
    try:
        with pytest.raises(DiscardedStepError, match=r"must begin at 0\.01\d* s, where the state is"):
            simulate(system, {"flywheel": unit}, Jacobi("hold"), 1e-2, 1.0, [recorder])
    finally:
        unit.close()


def test_an_error_is_quoted_without_what_was_said_before_it():
    """All that was said, where no message is of an error."""
    errors = ErrorReporter("motor")
    for status, text in ((0, b"fmi2SetupExperiment"), (3, b"singular"), (1, b"slow")):
        errors.log(status, text)
    assert errors.quote_messages() == "singular"
    errors.log(0, b"fmi2Terminate")
    assert errors.quote_messages() == "fmi2Terminate"
