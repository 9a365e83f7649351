"""Participants that misbehave, by a wrapper that puts faults in, and what a user gets."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from orchestrator.errors import StalledError
from orchestrator.masters import GaussSeidel
from orchestrator.participants import in_process
from tests.orchestrator import test_faults as tests
from tests.orchestrator import test_watchdog
from tests.orchestrator.faulty import Faulty, once_after
from tests.orchestrator.recorder import Recorder

from .table import Row

TESTS = "orchestrator/test_faults.py::"
FMUS = "orchestrator/test_faults_of_fmus.py::"
WATCHDOG = "orchestrator/test_watchdog.py::"
CONTROLLED = "iterated, predictor_corrector"
LIMIT = 0.5  # s


def rows() -> Iterator[Row]:
    clean = tests.missed(tests.sound(CONTROLLED))
    for fault in tests.TRANSIENT:
        yield _passing(fault, clean)
    for fault in tests.PERMANENT:
        yield _lasting(fault)
    yield _dying()
    yield _fixed()
    yield _jump()
    yield _noise()
    yield _stall()
    yield Row(
        "retried with a smaller step where that can help, also with steps of one length",
        "`retries` of a component: the step that failed is cut in two, so often at most",
        (
            "orchestrator/test_substeps.py::test_failed_steps_are_retried_and_the_result_is_the_same",
            FMUS + "test_a_camshaft_that_needs_a_quarter_of_the_step_gets_it_with_two_retries",
        ),
        command="tribocosim run valve-train --set components.camshaft.retries=2",
    )


def _passing(fault: str, clean: float) -> Row:
    recorder, ended = tests.controlled(tests.faulty(**tests.TRANSIENT[fault]()), CONTROLLED)
    error = tests.missed(recorder)
    rejected = sum(step.rejected for step in recorder.steps)
    well = ended is None and error < 2.0 * clean
    return Row(
        f"a participant: {fault}: retried with a smaller step",
        f"{CONTROLLED}: {rejected} attempts taken back, to the end, error {error:.1e} m (without the fault "
        f"{clean:.1e} m)" + (f"; ended: {ended}" if ended else ""),
        (TESTS + "test_step_control_gets_past_what_passes",),
        short="" if well else "not met.",
    )


def _ending(promise: str, recorder, ended, *named: str, short: str = "", value: str = "") -> Row:
    said = str(ended) if ended else "nothing"
    kept = f"{len(recorder.times)} records kept, to t = {recorder.times[-1]:.6g} s"
    blamed = ended is not None and said.startswith("second")
    return Row(
        promise,
        f"{value}“{said}”; {kept}",
        named,
        short=short if blamed else "not met: the culprit is not named.",
    )


def _lasting(fault: str) -> Row:
    faults, _, _ = tests.PERMANENT[fault]
    recorder, ended = tests.controlled(tests.faulty(**faults), CONTROLLED)
    return _ending(
        f"a participant: {fault} from t = 0.5 s on: ended with results kept and the culprit named",
        recorder,
        ended,
        TESTS + "test_what_does_not_pass_is_named_after_the_shortest_step",
    )


def _dying() -> Row:
    unit = tests.faulty(dies=tests.after(0.5))
    recorder, ended = tests.controlled(unit, CONTROLLED)
    calls = sum(time >= 0.5 for time, _ in unit.calls)
    return _ending(
        "fatal (not to be called again)",
        recorder,
        ended,
        TESTS + "test_a_dead_participant_is_not_called_again",
        FMUS + "test_an_fmu_that_fails_is_named_and_freed",
        value=f"{calls} call from then on; ",
    )


def _fixed() -> Row:
    faults, _, _ = tests.ENDING["fails"]
    recorder, ended = tests.simulated(tests.faulty(**faults), GaussSeidel("linear"), tests.FIXED)
    return _ending(
        "steps of one length: ended with results kept and the culprit named",
        recorder,
        ended,
        TESTS + "test_with_fixed_steps_the_culprit_and_the_time_are_named",
    )


def _jump() -> Row:
    unit = tests.faulty(
        value=lambda time, name, value: value + tests.OFFSET * (name == "position" and time > tests.JUMP)
    )
    recorder, ended = tests.controlled(unit, CONTROLLED, 1e-6)
    over = int(np.searchsorted(recorder.times, tests.JUMP, side="right"))
    passed = recorder.times[over] - tests.JUMP
    truth = tests.exact_with_jump(recorder.times)
    error = np.abs(recorder["first.position"] - truth[:, 0]).max()
    return Row(
        "an output that jumps: closed in on and passed",
        f"jump of {tests.OFFSET:g} m at {tests.JUMP:g} s: the step over it ends {passed:.1e} s after it and "
        "is "
        f"{recorder.steps[over].length:.1e} s long, error afterwards {error:.1e} m against the exact "
        "solution",
        (
            TESTS + "test_a_jump_is_closed_in_on_and_passed",
            TESTS + "test_a_jump_that_the_shortest_step_cannot_resolve_is_recorded_as_a_discontinuity",
        ),
        short="" if ended is None else f"ended: {ended}.",
    )


def _noise() -> Row:
    draw = np.random.default_rng(1)
    unit = tests.faulty(
        value=lambda time, name, value: value + draw.normal() * (name == "position" and time > tests.JUMP)
    )
    recorder, ended = tests.controlled(unit, CONTROLLED, 1e-4)
    said = str(ended)
    return Row(
        "an output that keeps jumping: ended and named",
        f"“{said}”; {len(recorder.times)} records kept, to t = {recorder.times[-1]:.6g} s",
        (TESTS + "test_an_output_that_keeps_jumping_is_named",),
        short=""
        if said.startswith("second")
        else "what is named follows the noisy output at once, and is not the noisy output itself.",
    )


def _stall() -> Row:
    recorder, said = Recorder(), "nothing"
    with tempfile.TemporaryDirectory() as folder:
        try:
            test_watchdog.run(
                Path(folder),
                LIMIT,
                lambda instance: Faulty(in_process("second", instance), stalls=once_after(0.5)),
                recorder,
            )
        except StalledError as error:
            said = str(error)
    return Row(
        "a participant that stalls: a wall-time limit per call",
        f"“{said}”; {len(recorder.times)} records kept, to t = {recorder.times[-1]:.6g} s",
        (
            WATCHDOG + "test_a_stalled_run_ends_with_status_3_and_its_results",
            WATCHDOG + "test_every_call_is_watched_under_its_name",
        ),
        command="tribocosim run valve-train --set 'call_time_limit=60 s'",
        short="POSIX systems only." if said.startswith("second") else "not met.",
    )
