"""Multirate and retried steps: the same signals however they are cut, and no state left behind."""

import functools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from orchestrator.engine.signals import move_origin
from orchestrator.engine.substeps import Substepped
from orchestrator.errors import DiscardedStepError, RecoverableError
from orchestrator.masters import GaussSeidel, Iterated, Jacobi
from orchestrator.participants.in_process import InProcessParticipant as in_process
from orchestrator.participants.open_fmu import open_fmu
from orchestrator.participants.protocol import Abilities

from .coupled import run_coupled
from .faulty import Faulty, after, at_random, every, longer_than
from .small_fmus import small_fmu
from .two_masses import two_masses

STEP, STOP = 1e-2, 1.0


def run(second, master=None):
    return run_coupled(two_masses(), master or GaussSeidel("linear"), STEP, STOP, second=second)


def second():
    return in_process("second", two_masses().instances["second"])


@settings(deadline=None)
@given(
    st.lists(st.floats(-10, 10), min_size=4, max_size=4),
    st.floats(-1.0, 1.0),
    st.floats(-1.0, 1.0),
    st.integers(1, 4),
)
def test_moved_signals_have_the_same_values(coefficients, shift, later, rows):
    """p(shift + later) from both origins; the bound is the rounding of sums of terms below 10 * 2**3."""
    signals = np.array(coefficients[:rows])[:, None]
    moved = np.zeros_like(signals)
    move_origin(signals, shift, moved)
    factorials = np.array([1.0, 1.0, 2.0, 6.0])[:rows]
    powers = np.arange(rows)
    before = float((signals[:, 0] * (shift + later) ** powers / factorials).sum())
    after_ = float((moved[:, 0] * later**powers / factorials).sum())
    assert after_ == pytest.approx(before, abs=80 * 40 * np.finfo(float).eps)
    move_origin(signals, shift, signals)  # in place
    np.testing.assert_array_equal(signals, moved)


# Components integrate to 1e-10 of 1 m and 1 m/s per micro-step; some ten of these in a hundred macro steps.
CUT = 1e-7


@pytest.mark.parametrize("master", [Jacobi("quadratic"), GaussSeidel("quadratic"), Iterated("linear")])
@pytest.mark.parametrize("substeps", [2, 3, 7])
def test_a_participant_that_follows_polynomials_gets_the_same_however_they_are_cut(master, substeps):
    one, many = run(second(), master), run(Substepped(second(), substeps), master)
    np.testing.assert_array_equal(one.times, many.times)
    assert np.abs(one["second.position"] - many["second.position"]).max() < CUT


def test_substeps_make_held_inputs_converge(tmp_path):
    """An FMU that gets means of its inputs converges with the second order of its own step."""
    file, instance = small_fmu("sound", tmp_path), two_masses().instances["second"]
    one, two, many = (
        run(Substepped(open_fmu("second", file, instance), n))["second.position"] for n in (1, 2, 20)
    )
    errors = [np.abs(each - many).max() for each in (one, two)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


def test_substeps_are_equal_and_end_with_the_macro_step():
    unit = Faulty(second())
    run(Substepped(unit, 4), Jacobi("hold"))
    steps = np.array(unit.calls)
    assert len(steps) == 400
    np.testing.assert_allclose(steps[:, 1], STEP / 4, rtol=1e-9)  # rounding of times
    np.testing.assert_allclose(steps[1:, 0], (steps[:, 0] + steps[:, 1])[:-1], rtol=1e-15, atol=1e-15)


LIMITED = {
    "always above a length": {"discards": longer_than(STEP / 4)},
    "every third": {"discards": every(3)},
    "at random": {"discards": at_random(0.2, seed=1)},
    "part of the way": {"discards": every(3), "arrives": 0.37},
    "without saying how far": {"discards": every(3), "silent": True},
    "fails every third": {"fails": every(3)},
}


@pytest.mark.parametrize("fault", LIMITED)
@pytest.mark.parametrize("substeps", [1, 3])
def test_failed_steps_are_retried_and_the_result_is_the_same(fault, substeps):
    unit = Faulty(second(), **LIMITED[fault])
    retried = run(Substepped(unit, substeps, halvings=12), GaussSeidel("quadratic"))
    plain = run(second(), GaussSeidel("quadratic"))
    assert np.abs(retried["second.position"] - plain["second.position"]).max() < CUT
    assert len(unit.calls) > 100 * substeps
    assert unit.saved == unit.released


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 4), st.floats(0.0, 0.2), st.floats(0.0, 0.9))
def test_however_steps_are_discarded_time_goes_on_without_gaps(seed, substeps, share, arrives):
    """Pieces join. (With a share of 0.2 two of five steps are halved again: twenty times, 1e-8 of them.)"""
    unit = Faulty(second(), discards=at_random(share, seed), arrives=arrives)
    retried = run(Substepped(unit, substeps, halvings=20), GaussSeidel("linear"))
    assert np.abs(retried["second.position"] - plain_linear()["second.position"]).max() < CUT


@functools.cache
def plain_linear():
    return run(second(), GaussSeidel("linear"))


def test_where_no_length_helps_the_error_names_the_shortest_and_the_time():
    unit = Faulty(second(), discards=after(0.5))
    with pytest.raises(DiscardedStepError, match=r"second: .*t = 0\.5 s by 0\.000625 s .*0\.01 s"):
        run(Substepped(unit, halvings=4))
    assert unit.saved == unit.released
    assert unit.closed


def test_what_cannot_be_restored_and_does_not_say_where_it_is_is_not_tried_again():
    for error, fault in ((DiscardedStepError, {"discards": after(0.5), "silent": True}),
                         (RecoverableError, {"fails": after(0.5)})):  # fmt: skip
        unit = Faulty(second(), **fault)
        unit.abilities = Abilities(restorable=False)
        with pytest.raises(error, match=r"t = 0\.5 s by 0\.01 s"):
            run(Substepped(unit, halvings=4))
