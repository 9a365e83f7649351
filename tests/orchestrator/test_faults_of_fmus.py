"""FMUs that misbehave are named and freed, and what a retry helps is retried."""

import json
import re
import tempfile

import pytest
from fmpy.fmi2 import FMU2Slave

from fmus.build import build
from models.catalogue import CATALOGUE
from models.core.system import Instance, System
from orchestrator.errors import DiscardedStepError, LostParticipantError, NotFiniteError, ParticipantError
from orchestrator.masters import GaussSeidel, Jacobi
from orchestrator.participants.failures import ErrorReporter
from orchestrator.participants.open_fmu import open_fmu
from orchestrator.run.plan import FmuFile, ParticipantPlan, open_participants
from orchestrator.run.simulation import simulate
from orchestrator.scenario.files import load
from orchestrator.scenario.system import build_system

from .commands import SHORT, called
from .faulty import Faulty
from .faulty_runs import simulated
from .recorder import Recorder
from .small_fmus import small_fmu
from .test_fmu_commands import write_tampered
from .two_masses import two_masses

FIXED = 1e-2
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


def test_an_fmu_that_cannot_be_instantiated_is_named_and_the_others_are_closed(tmp_path, temporary):
    system, made = build_system(load("two-masses")), []
    first, second = system.instances

    def watched(name, make):
        made.append(Faulty(make()))
        return made[-1]

    plans = {first: ParticipantPlan(), second: ParticipantPlan(FmuFile(small_fmu("unborn", tmp_path), ""))}
    with (
        pytest.raises(ParticipantError, match=rf"^{second}: instantiate: RuntimeError\('no licence'\)"),
        open_participants(system, plans, watched),
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


# The whole command.

LIMITED = """
def do_step(self, t, h, _real=camshaft.do_step):
    return h < 0.3 * {step} and _real(self, t, h)
camshaft.do_step = do_step
"""


@pytest.mark.long
@pytest.mark.parametrize("retries", [1, 2])
def test_a_camshaft_that_needs_a_quarter_of_the_step_gets_it_with_two_retries(retries, tmp_path):
    file = write_tampered(build("camshaft", tmp_path), tmp_path / "limited.fmu", LIMITED.format(step=5e-6))
    others = [text for text in SHORT if "camshaft" not in text]
    out = tmp_path / "out"
    done = called(
        "run", "valve-train", "--out", str(out), *others, "--no-figures", "--set=reference.enabled=false",
        "--set=macro_step=5 us", f"--set=components.camshaft.participant={file}",
        f"--set=components.camshaft.retries={retries}",
    )  # fmt: skip
    summary = json.loads((out / "summary.json").read_text())
    assert done.returncode == (0 if retries == 2 else 3), summary["message"]
    if retries == 1:
        assert summary["message"].startswith(
            "incomplete: camshaft: step from t = 0 s by 2.5e-06 s returned Discard"
        )
        assert "raise components.camshaft.retries" in summary["message"]


def test_an_error_is_quoted_without_what_was_said_before_it():
    """All that was said, where no message is of an error."""
    errors = ErrorReporter("motor")
    for status, text in ((0, b"fmi2SetupExperiment"), (3, b"singular"), (1, b"slow")):
        errors.log(status, text)
    assert errors.quote_messages() == "singular"
    errors.log(0, b"fmi2Terminate")
    assert errors.quote_messages() == "fmi2Terminate"
