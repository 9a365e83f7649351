"""Two masses, the second of which may misbehave, with step control or steps of one length."""

import functools

import numpy as np

from orchestrator.errors import RunError
from orchestrator.masters import GaussSeidel, Iterated, Jacobi
from orchestrator.participants.in_process import InProcessParticipant as in_process
from orchestrator.stepping import ControlledSteps, StepControl

from .coupled import Recorder, run_coupled
from .faulty import Faulty
from .two_masses import exact, two_masses

STOP = 1.0

# Step control over explicit and implicit masters, by every estimator that suits two masses.
CONTROLLED = {
    "jacobi, schierz": (Jacobi("quadratic"), "schierz"),
    "gauss_seidel, step_doubling": (GaussSeidel("quadratic"), "step_doubling"),
    "iterated, predictor_corrector": (Iterated("hermite"), "predictor_corrector"),
}
TOLERANCE = 1e-5


def controlled(second, kind, minimum_step=1e-7):
    """The recorder of a run with step control, and the error that ended it."""
    master, estimator = CONTROLLED[kind]
    control = StepControl(
        estimator, relative=TOLERANCE, absolute=TOLERANCE, minimum_step=minimum_step, maximum_step=0.05
    )
    return simulated(second, master, ControlledSteps(1e-3, control))


@functools.cache
def sound(kind):
    """The recorder of a run without faults."""
    recorder, ended = controlled(faulty(), kind)
    assert ended is None
    return recorder


def simulated(second, master, steps):
    system, recorder, ended = two_masses(), Recorder(), None
    units = {"first": Faulty(in_process("first", system.instances["first"])), "second": second}
    try:
        run_coupled(system, master, steps, STOP, recorder=recorder, **units)
    except RunError as error:
        ended = error
    assert recorder.ended == (ended is None, "" if ended is None else str(ended))
    for unit in units.values():
        if isinstance(unit, Faulty):
            assert unit.saved == unit.released
    return recorder, ended


def faulty(**faults):
    return Faulty(in_process("second", two_masses().instances["second"]), **faults)


def missed(recorder):
    truth = exact(recorder.times)
    return max(
        np.abs(recorder["first.position"] - truth[:, 0]).max(),
        np.abs(recorder["second.position"] - truth[:, 1]).max(),
    )
