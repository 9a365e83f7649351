"""Passes in compiled code over FMUs: the same bits, calls and errors as the passes in Python."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from fmus.build import build
from fmus.native.fmu import build as build_native
from fmus.native.machine_code import this_platform
from orchestrator.engine.compiled_sweeps import CompiledSweep
from orchestrator.engine.signals import DEGREES
from orchestrator.engine.substeps import Substepped
from orchestrator.errors import RunError
from orchestrator.masters import GaussSeidel, Iterated, Jacobi
from orchestrator.masters.restart import DOUBLINGS
from orchestrator.participants.compiled_calls import NotCompiledError
from orchestrator.participants.fmi2 import Fmi2
from orchestrator.participants.in_process import InProcessParticipant as in_process
from orchestrator.participants.open_fmu import open_fmu
from orchestrator.participants.wrapping import Linear, Transformed
from orchestrator.run.simulation import simulate

from .coupled import Recorder, Wrapper, run_coupled
from .small_fmus import small_fmu
from .two_masses import two_masses

STEP = 1e-2


class Wrapped(Wrapper):
    """An FMU as any other participant, for which passes are in Python."""

    def compiled_calls(self):
        raise NotCompiledError("it is a test")


class Counting:
    """Counts the compiled sweeps: `made` with a step, `settled` of no length."""

    def __init__(self, monkeypatch):
        self.made = self.settled = 0
        made = CompiledSweep.__call__

        def counted(self_, time, step):
            self.made += step > 0.0
            self.settled += step == 0.0
            made(self_, time, step)

        monkeypatch.setattr(CompiledSweep, "__call__", counted)


# Of the first step, where an FMU cannot be rolled back.
PARTS = DOUBLINGS + 1


@pytest.fixture
def compiled(monkeypatch):
    return Counting(monkeypatch)


def run(master, second, wrap, stop=0.3, files=None):
    """The outputs, and the steps asked of participants, or the error that ended the run."""
    system, recorder = two_masses(), Recorder()
    files = files or {"first": build("coupled_mass"), "second": second or build("sprung_mass")}
    units = {name: wrap(open_fmu(name, files[name], instance)) for name, instance in system.instances.items()}
    ended = None
    try:
        run_coupled(system, master, STEP, stop, recorder=recorder, **units)
    except RunError as error:
        ended = type(error), str(error)
    found = np.array([recorder[name] for name in ("first.force", "second.position", "second.velocity")])
    return found, ended or recorder.statistics.do_steps


@pytest.mark.parametrize("signal", DEGREES)
@pytest.mark.parametrize("kind", [Jacobi, GaussSeidel, Iterated])
def test_the_same_bits_and_calls_as_in_python(kind, signal, compiled):
    """Ours: all derivatives of inputs are taken, rates are given."""
    found = run(kind(signal), None, lambda unit: unit)
    assert compiled.made >= 30
    assert compiled.settled >= (30 if kind is Iterated else 1)  # what feeds through, after the first sweeps
    compiled.made = compiled.settled = 0
    expected = run(kind(signal), None, Wrapped)
    assert compiled.made == compiled.settled == 0
    assert found[1] == expected[1]
    assert expected[1] >= 60
    np.testing.assert_array_equal(found[0], expected[0])
    assert np.ptp(found[0]) > 1.0


def convert(unit):
    return Transformed(unit, {"force": Linear(1.01, 1e-3), "other_position": Linear(-0.99, 2e-3)})


@pytest.mark.parametrize("kind", [Jacobi, GaussSeidel, Iterated])
def test_converted_units_keep_compiled_sweeps_and_their_bits(kind, compiled):
    found = run(kind("hermite"), None, convert)
    assert compiled.made >= 30
    compiled.made = 0
    expected = run(kind("hermite"), None, lambda unit: convert(Wrapped(unit)))
    assert compiled.made == 0
    assert found[1] == expected[1]
    np.testing.assert_array_equal(found[0], expected[0])


def test_the_run_says_which_participants_keep_sweeps_in_python():
    system = two_masses()
    mass = system.instances["first"]
    for first, reason in (
        (Substepped(open_fmu("first", build("coupled_mass"), mass), 3), "substeps"),
        (in_process("first", mass), "no FMU"),
    ):
        second = open_fmu("second", build("sprung_mass"), system.instances["second"])
        found = simulate(system, {"first": first, "second": second}, Jacobi(), STEP, STEP).python_sweeps
        first.close()
        second.close()
        assert list(found) == ["first"]
        assert reason in found["first"]
    assert run_coupled(system, Jacobi(), STEP, STEP).statistics.python_sweeps == {}


@pytest.mark.parametrize("signal", ["hold", "quadratic", "hermite"])
def test_an_fmu_that_holds_its_inputs_and_gives_no_rates(signal, tmp_path, compiled):
    """Of ours only some numbers are taken then, and only some go to it."""
    third_party = small_fmu("sound", tmp_path)
    found = run(GaussSeidel(signal), third_party, lambda unit: unit)
    assert compiled.made == 29 + (1 if signal == "hold" else PARTS)
    np.testing.assert_array_equal(found[0], run(GaussSeidel(signal), third_party, Wrapped)[0])


@pytest.mark.long
@pytest.mark.parametrize("fmi", [pytest.param(2, marks=pytest.mark.long), 3])
def test_passes_over_native_fmus_are_compiled_too(fmi, compiled):
    """Of both versions of FMI; their kernels are those of the FMUs in Python, to the bit."""
    here = [this_platform()]
    files = {
        "first": build_native("coupled_mass", platforms=here, fmi=fmi),
        "second": build_native("sprung_mass", platforms=here, fmi=fmi),
    }
    found = run(Iterated("hermite"), None, lambda unit: unit, files=files)
    assert compiled.made >= 30
    expected = run(Iterated("hermite"), None, Wrapped)
    assert found[1] == expected[1]
    np.testing.assert_array_equal(found[0], expected[0])


def test_the_order_of_calls_may_be_another_one():
    master = GaussSeidel("linear", order=("second", "first"))
    found, expected = run(master, None, lambda unit: unit), run(master, None, Wrapped)
    np.testing.assert_array_equal(found[0], expected[0])
    assert not np.array_equal(found[0], run(GaussSeidel("linear"), None, Wrapped)[0])


@pytest.mark.parametrize(
    ("kind", "vice"), [(Jacobi, "refusing"), (GaussSeidel, "raising"), (GaussSeidel, "infinite")]
)
def test_the_same_error_after_the_same_steps(kind, vice, tmp_path, compiled):
    file = small_fmu(vice, tmp_path)
    found = run(kind("linear"), file, lambda unit: unit, stop=1.0)
    assert 50 <= compiled.made <= 60
    expected = run(kind("linear"), file, Wrapped, stop=1.0)
    assert found[1] == expected[1]
    assert "second" in found[1][1]
    np.testing.assert_array_equal(found[0], expected[0])


def test_the_interpreter_is_let_go_for_an_fmu_that_is_not_in_python(monkeypatch, compiled):
    """It takes it again itself, as these do whether or not it is held."""
    addresses = Fmi2.get_addresses
    expected = run(GaussSeidel("hermite"), None, Wrapped)
    monkeypatch.setattr(Fmi2, "get_addresses", lambda self: addresses(self) | {"in_python": 0})
    found = run(GaussSeidel("hermite"), None, lambda unit: unit)
    assert compiled.made >= 30
    np.testing.assert_array_equal(found[0], expected[0])


def test_without_compilation_passes_are_in_python(tmp_path):
    """To what integration of both masses to 1e-10 m leaves of a force through 40 N/m in 30 steps."""
    script = (
        "from tests.orchestrator import test_compiled_sweeps as tests\n"
        "values, steps = tests.run(tests.GaussSeidel('hermite'), None, lambda unit: unit)\n"
        f"tests.np.save({str(tmp_path / 'plain.npy')!r}, values)\n"
    )
    subprocess.run(
        [sys.executable, "-c", script],
        cwd=Path(__file__).parents[2],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        check=True,
    )
    compiled = run(GaussSeidel("hermite"), None, lambda unit: unit)[0]
    np.testing.assert_allclose(np.load(tmp_path / "plain.npy"), compiled, rtol=0.0, atol=30 * 40.0 * 1e-10)


def test_records_of_calls_and_of_sweeps_are_told_apart() -> None:
    """A record that begins with all of another's fields would run code compiled for the other."""
    from orchestrator.engine.compiled_sweeps import TURN
    from orchestrator.participants.compiled_calls import CALLS

    calls, turn = CALLS.names or (), TURN.names or ()
    assert set(calls) < set(turn)
    assert turn[: len(calls)] != calls
