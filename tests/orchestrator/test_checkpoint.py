"""Checkpoints: a run goes on from any macro step to the last bit; damaged and foreign ones are refused."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from orchestrator.analyses.stability.linear import Linear
from orchestrator.analyses.stability.linear_participants import LinearParticipant
from orchestrator.engine.substeps import Substepped
from orchestrator.errors import CannotSerializeError, CheckpointError, MistakeError, start_over
from orchestrator.masters import GaussSeidel, Iterated, Jacobi, Newton
from orchestrator.participants.in_process import InProcessParticipant as in_process
from orchestrator.participants.protocol import Abilities, Participant
from orchestrator.participants.reopened import Reopened
from orchestrator.run.checkpoint import Checkpoints, Identity, find_refusal, read, write
from orchestrator.run.simulation import simulate
from orchestrator.stepping import ControlledSteps, FixedSteps, ForwardSteps, StepControl
from orchestrator.store.json_codec import from_text, to_text

from .coupled import Alone, Recorder, Wrapper, build_participants
from .two_masses import two_masses

STOP = 0.2


class Kept(Recorder):
    """Keeps the state after every macro step, as the text that a checkpoint would have."""

    def attach(self, state):
        self._state = state
        self.states = []

    def observe(self, time, outputs, step):
        super().observe(time, outputs, step)
        self.states.append(to_text(self._state()))


def _control(estimator, tolerance, kind=ControlledSteps):
    return kind(1e-3, StepControl(estimator, relative=tolerance, absolute=tolerance))


WAYS = {
    "jacobi-forward": (Jacobi("quadratic"), lambda: _control("defect", 1e-4, ForwardSteps)),
    "jacobi": (Jacobi("quadratic"), lambda: FixedSteps(3e-3)),
    "gauss_seidel": (GaussSeidel("linear"), lambda: FixedSteps(3e-3)),
    "gauss_seidel-hermite": (GaussSeidel("hermite"), lambda: FixedSteps(3e-3, event_tolerance=1e-9)),
    "gauss_seidel-controlled": (GaussSeidel("hermite"), lambda: _control("step_doubling", 1e-5)),
    "newton": (Newton(), lambda: FixedSteps(3e-3)),
    "iterated": (Iterated("linear"), lambda: FixedSteps(3e-3)),
    "iterated-controlled": (
        Iterated("hermite", acceleration="quasi_newton"),
        lambda: _control("predictor_corrector", 1e-5),
    ),
}


@pytest.mark.parametrize("way", WAYS)
def test_a_run_goes_on_from_any_macro_step_to_the_last_bit(way):
    """Also one that takes no states as one that does."""
    system = two_masses()
    master, steps = WAYS[way]
    kept = Kept()
    whole = simulate(system, build_participants(system), master, steps(), STOP, [kept])
    for at in range(0, len(kept.states), max(1, len(kept.states) // 7)):
        rest = Recorder()
        state = from_text(kept.states[at])
        done = simulate(system, build_participants(system), master, steps(), STOP, [rest], resumed=state)
        assert rest.times.tolist() == kept.times[at + 1 :].tolist()
        assert rest._rows == [] or np.array_equal(np.array(rest._rows), np.array(kept._rows)[at + 1 :])
        assert rest.steps == kept.steps[at + 1 :]
        assert replace(done, coupled_time_s=0.0) == replace(whole, coupled_time_s=0.0)


def _second() -> Participant:
    return in_process("second", two_masses().instances["second"])


UNITS = {
    "in-process": _second,
    "substepped": lambda: Substepped(_second(), 3),
}


@pytest.mark.parametrize("kind", UNITS)
def test_a_participant_goes_back_and_through_bytes_to_the_same_bits(kind):
    first, second = (Alone(UNITS[kind](), "force", ["position", "velocity"], 0.0) for _ in range(2))

    def advance(alone, *steps):
        return [alone.advance(1e-3 * n, 1e-3, math.sin(n), math.cos(n)) for n in steps]

    advance(first, *range(5))
    kept, data = first.unit.save(), first.saved()
    advance(second, *range(3))
    second.unit.restore(second.unit.from_bytes(data))
    assert second.saved() == data
    wanted = advance(first, *range(5, 9))
    after = first.saved()
    assert advance(second, *range(5, 9)) == wanted
    assert second.saved() == after
    first.unit.restore(kept)
    assert advance(first, *range(5, 9)) == wanted
    assert first.saved() == after


PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text() | st.binary(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text().filter(lambda k: not k.startswith("$")), inner),
)


@settings(max_examples=50, deadline=None)
@given(PLAIN)
def test_plain_data_round_trip(data):
    assert from_text(to_text(data)) == data


@settings(max_examples=50, deadline=None)
@given(
    st.sampled_from(["<f8", "<i8", "|b1", "|u1", ">f4"]).flatmap(
        lambda kind: arrays.arrays(kind, arrays.array_shapes(min_dims=0, max_dims=3, min_side=0))
    )
)
def test_arrays_keep_every_bit_their_kind_and_shape(values):
    for array in (values, np.asfortranarray(values), values[::2] if values.ndim else values):
        found = from_text(to_text({"a": [array]}))["a"][0]
        assert (found.dtype, found.shape, found.tobytes()) == (array.dtype, array.shape, array.tobytes())
        assert found.flags.writeable
        assert found.flags.fnc == array.flags.fnc


@pytest.mark.parametrize("data", [object(), {1: 2}, {"$array": 1}, np.array(["a"]), np.array([None]), {1, 2}])
def test_what_is_not_plain_is_refused(data):
    with pytest.raises(TypeError):
        to_text(data)


@pytest.mark.parametrize(
    "text",
    [
        '{"$array": ["|O", [1], "C", "AAAAAAAAAAA="]}',
        '{"$array": ["<f8", [2], "C", "AAAAAAAAAAA="]}',
        '{"$array": ["<f8", [-1], "C", ""]}',
        '{"$array": 3}',
        '{"$bytes": "?"}',
        "{",
    ],
)
def test_text_that_is_not_of_plain_data_is_refused(text):
    with pytest.raises(ValueError):  # noqa: PT011
        from_text(text)


IDENTITY = Identity({"tribocosim": "1", "numpy": "2"}, "a" * 64, {"contact": "b" * 64})


def test_every_damaged_byte_and_every_cut_is_noticed(tmp_path):
    path = tmp_path / "unfinished" / "checkpoint"
    path.parent.mkdir()
    state = {"x": np.arange(3.0), "n": 1}
    write(path, IDENTITY, state)
    identity, found = read(path)
    assert identity == IDENTITY
    assert np.array_equal(found["x"], state["x"])
    whole = path.read_bytes()
    for at in range(len(whole)):
        for spoilt in (whole[:at], whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :]):
            path.write_bytes(spoilt)
            with pytest.raises(CheckpointError) as refused:
                read(path)
            assert refused.value.remedies == (start_over(tmp_path),)


def test_another_run_version_or_fmu_is_refused_with_the_remedy(tmp_path):
    IDENTITY.check(replace(IDENTITY), tmp_path)
    for other, words in (
        (replace(IDENTITY, scenario="c"), "scenario.toml: is not what the run was begun with; undo"),
        (replace(IDENTITY, versions={"tribocosim": "1", "numpy": "3"}), "with numpy 3, this is 2; install"),
        (replace(IDENTITY, fmus={"contact": "c"}), "components.contact.participant: the FMU is not the one"),
        (replace(IDENTITY, fmus={}), "components.contact.participant"),
    ):
        with pytest.raises(CheckpointError, match=words) as refused:
            IDENTITY.check(other, tmp_path)
        assert isinstance(refused.value, MistakeError)
        assert refused.value.remedies[-1] == start_over(tmp_path)


def test_a_state_that_does_not_fit_is_refused():
    system, (master, steps) = two_masses(), WAYS["gauss_seidel"]
    kept = Kept()
    simulate(system, build_participants(system), master, steps(), 0.01, [kept])
    for key, spoilt in (("coupling", {}), ("participants", {}), ("steps", {"missed": np.zeros(99)})):
        state = from_text(kept.states[1])
        state["session"][key] = spoilt
        with pytest.raises(CheckpointError, match="does not fit this run"):
            simulate(system, build_participants(system), master, steps(), 0.01, [], resumed=state)


class Dumb(Wrapper):
    """A participant that cannot be serialised, and says so."""

    abilities = Abilities(unserialisable="it has no bytes")


def test_without_serialisable_participants_the_run_says_so_before_it_steps(tmp_path):
    system, (master, steps) = two_masses(), WAYS["gauss_seidel"]
    said: list[str] = []
    keeper = Checkpoints(tmp_path / "checkpoint", IDENTITY, 0.0, STOP, lambda: False, said.append)
    participants = {name: Dumb(participant) for name, participant in build_participants(system).items()}

    class Hearing(Recorder):
        def begin(self, names):
            assert said == ["no checkpoints: first: it has no bytes"]
            super().begin(names)

    simulate(system, participants, master, steps(), STOP, [keeper, Hearing()])
    assert len(said) == 1
    assert not list(tmp_path.iterdir())


def test_what_a_participant_cannot_is_declared():
    """The bytes of one that says so are refused by an error of the family."""
    one = two_masses().instances["first"]
    linear = LinearParticipant("one", one, Linear(*(np.zeros((2, 2)) for _ in range(4)), np.ones(2)))
    for unit in (Reopened(lambda: in_process("one", one)), linear):
        assert find_refusal([unit]).startswith("one: ")
        for call, given_ in (("to_bytes", 0), ("from_bytes", b"")):
            with pytest.raises(CannotSerializeError, match=r"^one: "):
                getattr(unit, call)(given_)
