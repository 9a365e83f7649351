"""A short run of an FMU alone, in its own process, which shows whether its file can be used."""

from collections.abc import Iterator
from pathlib import Path

from models.core.interruption import at_once
from models.core.system import Instance, System
from models.core.words import tally

from ..errors import EndedError, RunError
from ..masters import MASTERS
from ..participants.description import CO_SIMULATION, MODEL_EXCHANGE
from ..participants.in_own_process import InOwnProcess
from ..participants.open_fmu import collect_settings
from ..participants.own_process import Limits
from ..participants.third_party import ThirdPartyComponent, read_component
from ..participants.undeclared import describe_undeclared
from ..scenario.capabilities import WHOLE_STEPS
from ..stepping import FixedSteps
from .simulation import Session

# The steps that are made; the longest one (s) where the default experiment states none, as a solver may be
# slow; after how long a call is given up (s): Python FMUs are compiled in theirs.
STEPS, LONGEST, PATIENCE = 5, 2e-3, 600.0
NAME = "FMU"


def try_fmu(path: Path) -> tuple[list[str], list[str]]:
    """What fails where the FMU is initialised with its start values, makes the first steps of its default
    experiment and is terminated, by each of its interfaces; and what it then does against its description."""
    faults, remarks = list[str](), list[str]()
    for interface in (CO_SIMULATION, MODEL_EXCHANGE):
        try:
            component = read_component(path, interface)
        except ValueError as error:
            faults += [] if interface == MODEL_EXCHANGE else [str(error).removeprefix(f"{path}: ")]
            break
        assert isinstance(component, ThirdPartyComponent)
        kind = "model exchange" if component.about.integrated else "co-simulation"
        try:
            with at_once():
                remarks += _make_steps(path, component)
        except RunError as error:
            said, _, _ = str(error).removeprefix(f"{NAME}: ").partition("; look at")  # in a scenario
            faults.append(f"{kind}: {said}")
        if component.about.integrated:
            break
    return faults, list(dict.fromkeys(remarks))


def _make_steps(path: Path, component: ThirdPartyComponent) -> Iterator[str]:
    about, instance = component.about, Instance(component)
    start = about.start or 0.0
    step = about.fixed_step or about.step or LONGEST
    length = max((about.stop or 0.0) - start, 0.0) or STEPS * step
    count = min(STEPS, max(1, int(length / step + WHOLE_STEPS)))  # the next may be shorter
    unit = InOwnProcess(NAME, path, collect_settings(instance), Limits(call_s=PATIENCE))
    try:
        system = System({NAME: instance}, [])
        session = Session(
            system, {NAME: unit}, MASTERS["jacobi"](), FixedSteps(min(step, length)), start + length, start
        )
        session.begin()
        try:
            for _ in range(count):
                session.step()
        except EndedError:
            return  # as it may
        for name, value in component.outputs.named(session.read_outputs()).items():
            if value - value != 0.0:
                yield f"{name} is {value} at t = {session.time:g} s, after {tally(count, 'step')}"
        inputs = component.inputs
        yield from describe_undeclared(unit, component, inputs.named(inputs.start))
        unit.terminate()
    finally:
        unit.close()
