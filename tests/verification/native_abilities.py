"""What the C layer of FMUs in Python refuses, and native ones do."""

from __future__ import annotations

import tempfile
import zipfile
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from fmus.build import NAMES
from fmus.native.fmu import build
from fmus.native.machine_code import this_platform
from tests.fmus.instance import Instance, Instance3
from tests.fmus.native.test_fmi3_events import START, STOP, impacts, turning
from tests.fmus.native.test_sensitivity import RELATIVE, in_motion

from .table import Row

NATIVE = "fmus/native/"
EVENTS = NATIVE + "test_fmi3_events.py::"
DERIVATIVES = NATIVE + "test_derivatives.py::"
VERSIONS = (2, 3)
Files = dict[tuple[str, int], Path]

# By flag of the description: the tests that show it.
SHOWN = {
    "canHandleVariableCommunicationStepSize": NATIVE + "test_agreement.py::test_native_fmu_equals_component",
    "canInterpolateInputs": DERIVATIVES + "test_inputs_by_calls_and_by_variables_give_the_same_motion",
    "maxOutputDerivativeOrder": NATIVE + "test_fmi3.py::test_derivatives_by_variables",
    "canGetAndSetFMUstate": NATIVE + "test_fmi3.py::test_a_saved_state_brings_the_same_motion",
    "canGetAndSetFMUState": NATIVE + "test_fmi3.py::test_a_saved_state_brings_the_same_motion",
    "canSerializeFMUstate": NATIVE + "test_fmi3.py::test_a_saved_state_brings_the_same_motion",
    "canSerializeFMUState": NATIVE + "test_fmi3.py::test_a_saved_state_brings_the_same_motion",
    "providesDirectionalDerivative": NATIVE
    + "test_sensitivity.py::test_derivatives_by_inputs_and_parameters",
    "providesDirectionalDerivatives": NATIVE + "test_fmi3.py::test_derivatives_by_variables",
    "providesAdjointDerivatives": NATIVE + "test_fmi3.py::test_derivatives_by_variables",
    "providesIntermediateUpdate": EVENTS + "test_inputs_given_within_steps_are_cubic",
    "canReturnEarlyAfterIntermediateUpdate": EVENTS + "test_a_host_ends_a_step_from_within",
    "mightReturnEarlyFromDoStep": EVENTS + "test_without_event_mode_steps_end_after_impacts",
    "hasEventMode": EVENTS + "test_steps_end_at_impacts",
}


def rows() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as folder:
        here = [this_platform()]
        files = {
            (name, fmi): build(name, Path(folder), platforms=here, fmi=fmi)
            for name in NAMES
            for fmi in VERSIONS
        }
        yield _flags(files)
        yield _states(files)
        yield _directional(files)
        yield _impacts(files["slider_crank", 3])
    yield from _told()


def _flags(files: Files) -> Row:
    found: set[str] = set()
    for file in files.values():
        with zipfile.ZipFile(file) as archive:
            root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        for part in (*root.iter("CoSimulation"), *root.iter("ModelExchange")):
            found |= {name for name, value in part.attrib.items() if value not in ("false", "0")}
    # Not abilities: a name, and what is left to the host.
    found -= {"modelIdentifier", "needsCompletedIntegratorStep", "canNotUseMemoryManagementFunctions"}
    unshown = sorted(found - set(SHOWN))
    return Row(
        "capability flags are true only where a test shows it",
        f"true in some of {len(files)} files: {', '.join(sorted(found))}; each has its test",
        tuple(dict.fromkeys(SHOWN[flag] for flag in sorted(found & set(SHOWN)))),
        short=f"without a test: {', '.join(unshown)}." if unshown else "",
    )


def _states(files: Files) -> Row:
    different = 0
    for (_, fmi), file in files.items():
        kind = Instance if fmi == 2 else Instance3
        one, other = kind(file).initialize(), kind(file).initialize()
        one.step(0.0, 1e-4)
        other.restore_bytes(one.saved_bytes())
        state = one.save()
        one.step(1e-4, 1e-4)
        first = one.outputs()
        one.restore(state)
        for slave in (one, other):
            slave.step(1e-4, 1e-4)
            different += slave.outputs() != first
            slave.free()
    return Row(
        "get, set and serialise the state",
        f"a step repeated after a restored state, and from bytes in another instance: {different} of "
        f"{2 * len(files)} differ in a bit",
        (
            NATIVE + "test_fmi3.py::test_a_saved_state_brings_the_same_motion",
            NATIVE + "test_c_hosts.py::test_instances_come_and_go_in_steady_memory",
        ),
        short="states differ." if different else "",
    )


def _directional(files: Files) -> Row:
    """The largest difference, relative to the derivatives' own size, of all that is calculated."""
    worst, count = 0.0, 0
    for name in NAMES:
        for derivatives in in_motion(name, files[name, 2]):
            beyond, expected = derivatives.missed()
            error = beyond / (np.abs(expected) + (expected == 0.0))
            worst = max(worst, float(np.nanmin(error, axis=0).max(initial=0.0)))
            count += len(derivatives.names)
    return Row(
        "directional derivatives, from kernels differentiated exactly",
        f"{count} derivatives of outputs, rates and energies by inputs, their derivatives and parameters, in "
        "motion, against the best of sixth-order differences of four sizes: at most "
        f"{worst:.0e} apart beyond the differences' rounding",
        (
            NATIVE + "test_sensitivity.py::test_derivatives_by_inputs_and_parameters",
            NATIVE + "test_sensitivity.py::test_derivatives_by_states",
            NATIVE + "test_sensitivity.py::test_derivatives_are_linear_in_the_direction",
            NATIVE + "test_sensitivity.py::test_code_without_known_derivative_is_refused",
        ),
        short="" if worst <= RELATIVE else "not met.",
    )


def _impacts(file: Path) -> Row:
    expected = impacts(1e-3)
    slave = Instance3(file, eventModeUsed=True, earlyReturnAllowed=True).initialize(**START)
    t, found = 0.0, []
    while t < STOP - 1e-9:
        turning(slave, t)
        event, _, _, t = slave.step(t, min(5e-2, STOP - t))
        if event:
            turning(slave, t)
            found.append(t)
            slave.fmu.enterEventMode()
            slave.handle_events()
    slave.free()
    missed = max(abs(a - b) for a, b in zip(found, expected, strict=True))
    return Row(
        "FMI 3 early return and event mode at impacts",
        f"slider_crank in steps of 50 ms: {len(found)} returns at impacts, at most {missed:.0e} s from the "
        "component's",
        (
            EVENTS + "test_steps_end_at_impacts",
            EVENTS + "test_without_event_mode_steps_end_after_impacts",
            EVENTS + "test_chatter_ends",
            EVENTS + "test_known_events_are_told",
        ),
    )


def _told() -> Iterator[Row]:
    """What tests show and no number says better."""
    yield Row(
        "input derivatives (`canInterpolateInputs`), output derivatives",
        "by the standard's calls the same bits as by variables, to order 3 of inputs and 1 of outputs",
        (
            DERIVATIVES + "test_inputs_by_calls_and_by_variables_give_the_same_motion",
            DERIVATIVES + "test_derivatives_of_outputs_are_their_rates",
            NATIVE + "test_fmi3.py::test_derivatives_by_variables",
        ),
    )
    yield Row(
        "intermediate update",
        "inputs given at thirds of a step are the cubic through them; outputs are read in steps; a host ends "
        "one from within",
        (
            EVENTS + "test_inputs_given_within_steps_are_cubic",
            EVENTS + "test_outputs_are_read_within_steps",
            EVENTS + "test_a_host_ends_a_step_from_within",
        ),
    )
    yield Row(
        "terminals and icons (load and film contact as a terminal)",
        "terminalsAndIcons.xml of every component, valid by the schema; what scenarios connect is in "
        "terminals",
        (
            "fmus/test_terminals.py::test_the_file_is_valid",
            "fmus/test_terminals.py::test_terminals_join_what_scenarios_connect",
        ),
    )
    yield Row(
        "clocks only if they serve",
        "none: events are known by time (`nextEventTime`) or by indicators, and no component samples",
    )
