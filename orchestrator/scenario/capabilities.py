"""Checks that FMU files have the capabilities that the scenario needs."""

import select
import sys
import zipfile
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

import fmpy

from ..participants.description import CLOCK, Description
from ..participants.library import find_library, list_libraries
from ..participants.proven import Proof
from . import Scenario, ScenarioError

# Tolerance, in steps, of "a whole number of steps": far more than rounding.
WHOLE_STEPS = 1e-6


# Methods of the reference.
MONOLITHIC, BY_PARTS, REFINEMENT = "monolithic", "by parts", "refinement"


def choose_reference(scenario: Scenario) -> str | None:
    """How the reference is solved, if there is one.

    `BY_PARTS` takes FMUs, and connections that change values, as they are. ScenarioError where it cannot be
    solved as asked, and where an equilibrium is wanted of unknown equations.
    """
    foreign = list_foreign(scenario)
    if foreign and scenario.start == "equilibrium":
        raise ScenarioError(f"start = 'equilibrium': {foreign[0]}; set start = 'given'")
    if not scenario.reference.enabled:
        return None
    asked, unknown = scenario.reference.method, describe_unsolvable(scenario, foreign)
    if asked == "refinement" or (asked == "auto" and unknown):
        return REFINEMENT
    if unknown:
        raise ScenarioError(
            f"reference.method = 'monolithic': {unknown}; set reference.method = 'refinement'"
        )
    return BY_PARTS if foreign else MONOLITHIC


def describe_unsolvable(scenario: Scenario, foreign: Sequence[str]) -> str:
    """Why no monolithic reference can be solved, in words; empty if one can."""
    closed = [
        name
        for name, table in scenario.components.items()
        if table.third_party and table.describe().exchange is None
    ]
    if closed:
        return f"{', '.join(closed)}: third-party FMUs without model exchange, whose equations are unknown"
    ours = {name: table.resolve() for name, table in scenario.components.items() if not table.third_party}
    heated = [name for name, component in ours.items() if component.structure.get("layers")]
    if heated:
        return f"{', '.join(heated)}: a film with temperatures (layers), which the reference cannot start"
    implicit = [name for name, component in ours.items() if not component.ode]
    if implicit and foreign:
        return f"{', '.join(implicit)}: no ordinary differential equations, beside {foreign[0]}"
    return ""


def list_foreign(scenario: Scenario) -> list[str]:
    """What of the system is not in the equations of our components, in words."""
    third_party = [name for name, table in scenario.components.items() if table.third_party]
    found = [f"{', '.join(third_party)}: third-party FMUs"] if third_party else []
    changing = [line for line in scenario.lines if (line.factor, line.offset) != (None, None)]
    return found + [f"the connection {str(line)!r} changes values" for line in changing]


def check_capabilities(scenario: Scenario) -> None:
    """ScenarioError where a given .fmu file cannot do what the scenario's steps need."""
    files = {name: table.file for name, table in scenario.components.items() if table.file}
    for name, path in files.items():
        about = scenario.components[name].describe()
        if fault := _find_library_fault(path, about) or _find_fault(scenario, name, about):
            raise ScenarioError(f"components.{name}.participant: {path}: {fault}")
    _check_limits(scenario)
    shared = Counter(
        path.resolve() for name, path in files.items() if not scenario.components[name].own_process
    )
    for name, path in files.items():
        if shared[path.resolve()] > 1 and scenario.components[name].describe().once_per_process:
            raise ScenarioError(
                f"components.{name}.participant: {path}: allows one instance per process "
                f"(canBeInstantiatedOnlyOncePerProcess); set components.{name}.process = 'own'"
            )


def _check_limits(scenario: Scenario) -> None:
    """ScenarioError where a limit of FMUs' own processes would be without effect."""
    apart = {name: table.own_process for name, table in scenario.components.items()}
    for name, table in scenario.components.items():
        if table.memory_limit_mb is not None and not (apart[name] and sys.platform == "linux"):
            remedy = "leave it out" if apart[name] else f"set components.{name}.process = 'own'"
            raise ScenarioError(
                f"components.{name}.memory_limit_mb: limits a process of its own, on Linux; {remedy}"
            )
    if scenario.call_time_limit is None:
        return
    if not hasattr(select, "poll"):
        raise ScenarioError("call_time_limit: needs a POSIX system; leave it out")
    if without := scenario.exposed or ([] if any(apart.values()) else list(apart)):
        raise ScenarioError(
            f"call_time_limit = {scenario.call_time_limit:g} s: limits calls of FMUs in their own processes, "
            f"but {without[0]} is in the run's; set components.{without[0]}.process = 'own', or leave it out"
        )


def _find_library_fault(path: Path, about: Description) -> str:
    """A message if the archive has no library for this platform, with what it has instead; else empty."""
    here = fmpy.platform_tuple if about.version == "3.0" else fmpy.platform
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
    if find_library(names, about):
        return ""
    if other := list_libraries(names, about):
        wanted, found = f"{about.identifier}{fmpy.sharedLibraryExtension}", ", ".join(other)
        return f"has no binaries/{here}/{wanted}, its modelIdentifier, but {found}; rename one of them"
    parts = [name.split("/") for name in names]
    places = sorted({part[1] for part in parts if part[0] == "binaries" and len(part) > 2})
    return f"has no binary for {here} (it has {', '.join(places) or 'none'}); give a file that has one"


def _find_fault(scenario: Scenario, name: str, about: Description) -> str:
    """The first capability that the FMU lacks, with the remedy; empty if it lacks none."""
    table = scenario.components[name]
    clocks = [v.name for v in about.variables.values() if v.type == CLOCK and v.causality == "input"]
    if clocks and about.events is None:
        return (
            f"has clocks ({', '.join(clocks)}), which tick in co-simulation with event mode only "
            "(hasEventMode); take an FMU that has it, without interface = 'model_exchange'"
        )
    repeats = _describe_repetition(scenario)
    if repeats and not about.restorable:
        return f"cannot restore its state (canGetAndSetFMUstate = false), but {repeats}, or give another file"
    lengths = (
        "[step_control]" if scenario.step_control else "",
        "event_tolerance" if scenario.event_tolerance else "",
        f"components.{name}.retries" if table.retries else "",
    )
    cause = next(filter(None, lengths), "")
    if not about.variable_step:
        if cause:
            return (
                "takes steps of one length only (canHandleVariableCommunicationStepSize = false), but "
                f"{cause} varies the length; leave it out"
            )
        if leaves_remainder(scenario.stop_time, scenario.macro_step):
            return (
                "takes steps of one length only (canHandleVariableCommunicationStepSize = false), and "
                f"stop_time = {scenario.stop_time:g} s is no whole multiple of macro_step = "
                f"{scenario.macro_step:g} s; change one of them"
            )
    return ""


def _describe_repetition(scenario: Scenario) -> str:
    """What of the scenario cannot do without steps that are repeated, and the remedy; empty if nothing."""
    if scenario.master.build().implicit:
        return f"the master {scenario.master.name} repeats steps; take the master jacobi or gauss_seidel"
    if scenario.step_control and not scenario.step_control.forward:
        return (
            "[step_control] repeats steps; leave it out for equal steps of macro_step, or set "
            "step_control.estimator = 'defect', which makes every step once (short ones, where an FMU's own "
            "solver is noisy)"
        )
    if scenario.event_tolerance and not scenario.step_control:
        return "event_tolerance repeats steps; leave it out"
    return ""


def plan_proof(scenario: Scenario, name: str) -> Proof | None:
    """Of an FMU of whose saved states the run makes use, and that this user's tribocosim has not built."""
    table = scenario.components[name]
    if not table.untrusted or not table.describe().restorable:
        return None
    required = _describe_repetition(scenario)
    repeated = scenario.connections and scenario.master.build().degree  # the first step
    if not (required or repeated or table.retries or scenario.checkpoint_every):
        return None
    return Proof(scenario.macro_step / table.substeps, required and f"but {required}")


def list_file_warnings(scenario: Scenario) -> Iterator[str]:
    """Warn of FMUs whose library is called otherwise than the model identifier says, whose internal steps do
    not fit into macro steps, and whose default experiment begins later, or earlier, than runs do."""
    for name, table in scenario.components.items():
        if not table.file:
            continue
        about, step = table.describe(), scenario.macro_step / table.substeps
        with zipfile.ZipFile(table.file) as archive:
            library = find_library(archive.namelist(), about)
        if Path(library).stem != about.identifier:
            yield (
                f"components.{name}: takes {library}, the only library for this machine, though its "
                f"modelIdentifier is {about.identifier}"
            )
        own = about.fixed_step
        if own and (scenario.step_control or leaves_remainder(step, own)):
            remedy = (
                "interface = 'model_exchange'"
                if about.exchange
                else "a macro_step that is a multiple of them"
            )
            yield (
                f"components.{name}: its internal steps of {own:g} s (fixedInternalStepSize) do not fit into "
                f"macro steps, so its outputs may lag behind; take {remedy}"
            )
        if table.third_party and about.start:
            yield (
                f"components.{name}: its default experiment begins at t = {about.start:g} s, the run at 0, "
                "which the FMU is told; shift the times in its parameters if it needs the other"
            )


def leaves_remainder(length: float, part: float) -> bool:
    """Whether `length` is no whole number of parts."""
    return abs(length / part - round(length / part)) > WHOLE_STEPS or round(length / part) < 1
