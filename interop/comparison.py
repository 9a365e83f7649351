"""The cases, and the outputs that the component computes for them in this process."""

import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import fmpy
import numpy as np

from fmus.build import build as build_python
from fmus.declared import experiment
from fmus.native.fmu import build as build_native
from fmus.native.machine_code import this_platform
from models.compile.temporary import TemporaryFolder
from orchestrator.scenario.files import load
from tests.fmus.reference import Reference, wave
from tribocosim.scenario_fmus import write_whole

from .case import Case, list_equal_steps
from .processes import Answer, ask, load_tool

STEPS = 100
# Scenarios of which the whole train is one FMU.
TRAINS = ("valve-train", "finger-follower-hla")


@dataclass(frozen=True)
class Kind:
    """A way to build an FMU."""

    title: str
    fmi: int
    native: bool

    def build(self, name: str, platform: str = "") -> Path:
        if self.native:
            return build_native(name, platforms=[platform or this_platform()], fmi=self.fmi)
        return build_python(name)


KINDS: Mapping[str, Kind] = {
    "python": Kind("Python, FMI 2", 2, False),
    "native": Kind("native, FMI 2", 2, True),
    "native3": Kind("native, FMI 3", 3, True),
}


@contextmanager
def make_component(fmu: str) -> Iterator[str]:
    """The name of the component of which the FMU is built: of a train one that has all of its parts."""
    if fmu not in TRAINS:
        yield fmu
        return
    with TemporaryFolder() as folder:
        yield write_whole(load(fmu), folder)


def choose_step(name: str) -> float:
    """The power of two nearest to the FMU's default step: its sums and multiples are exact."""
    return 2.0 ** round(math.log2(experiment(name).step_size))


def make_case(name: str, kind: Kind, fmu: Path) -> Case:
    """The case of an FMU: inputs that follow `wave`, and all real outputs."""
    reference = Reference(name)
    description = fmpy.read_model_description(str(fmu), validate=False)
    known = {v.name: v for v in description.modelVariables}
    inputs = reference.component.inputs.names
    outputs = [v.name for v in known.values() if v.causality == "output" and v.type in ("Real", "Float64")]
    step = choose_step(name)
    table = [[wave(reference.component, i * step)[one] for one in inputs] for i in range(STEPS)]
    return Case(
        fmu=str(fmu),
        fmi=kind.fmi,
        python=not kind.native,
        identifier=description.coSimulation.modelIdentifier,
        token=description.guid or description.instantiationToken,
        step=step,
        inputs=list(inputs),
        outputs=outputs,
        references={one: known[one].valueReference for one in (*inputs, *outputs)},
        table=table,
    )


def compute_expected(
    name: str, kind: Kind, case: Case, steps: Iterable[tuple[float, float]]
) -> list[list[float]]:
    """The component's outputs after each step (time and size)."""
    reference = Reference(name)
    outputs = reference.component.outputs
    rated = [f"der({f.name})" for f in outputs.fields if not f.quantity.discrete]
    found, rows = [], case.rows()
    for i, (time, size) in enumerate(steps):
        reference.set_inputs(rows[i])
        reference.t = time
        reference.step(size)
        known = outputs.named(reference.y)
        known |= dict(zip(rated, reference.rates(), strict=True))
        found.append([float(known[one]) for one in case.outputs])
    return found


def largest_difference(found: list[list[float]], truth: list[list[float]]) -> float:
    """Largest difference, relative to the output's largest magnitude; infinite if a value is missing."""
    one, right = np.array(found), np.array(truth)
    if one.shape != right.shape or not np.isfinite(one).all():
        return math.inf
    missed, scale = np.abs(one - right).max(axis=0), np.abs(right).max(axis=0)
    apart = missed > 0.0
    return float((missed[apart] / np.where(scale[apart] > 0.0, scale[apart], 1.0)).max(initial=0.0))


def compare(name: str, fmu: str, kind: Kind) -> tuple[float | None, Answer]:
    """The largest difference from the component (None without values), and the tool's answer."""
    with make_component(fmu) as component:
        case = make_case(component, kind, kind.build(component, getattr(load_tool(name), "PLATFORM", "")))
        answer = ask(name, case)
        if answer.values is None:
            return None, answer
        steps = getattr(load_tool(name), "steps", list_equal_steps)(case.steps, case.step)
        truth = compute_expected(component, kind, case, steps)
        return largest_difference(answer.values, truth), answer
