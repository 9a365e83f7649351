"""Where the wall time of a run went: parts that add up to the whole, and what makes each shorter."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

from models.core.words import tally

from ...engine.effort import Spent
from ...reporter import CHOICE, COMPILING, COUPLED, DRAWING, FMUS, PAGE, RECORDS, WITNESS
from ...scenario import Scenario
from ...scenario.units import format_time
from ...texts import parse_json, read_text

# Of a participant's time in an FMU's own process: what the messages of a call take (s), measured.
MESSAGES_S = 60e-6
MUCH = 0.5  # of the time


@dataclass(frozen=True)
class Part:
    """What took `seconds`, and what makes it less, or nothing. `once`: the next run goes without."""

    name: str
    seconds: float
    remedy: str = ""
    once: bool = False


@dataclass(frozen=True)
class Spending:
    """What the summary of a run says of its time (s): of its steps `coupled_s`; `stages` by name, `effort` by
    participant.

    `python_sweeps`: why participants are called from Python. `errors` are shares of the tolerance, by output.
    """

    wall_s: float = 0.0
    coupled_s: float = 0.0
    do_steps: int | None = None
    stages: Mapping[str, float] = field(default_factory=dict)
    effort: Mapping[str, Spent] = field(default_factory=dict)
    python_sweeps: Mapping[str, str] = field(default_factory=dict)
    errors: Mapping[str, float] = field(default_factory=dict)

    @property
    def initialising_s(self) -> float:
        return sum(one.initialising_s for one in self.effort.values())

    @property
    def compiling_s(self) -> float:
        """Of the coupled run: its stage goes without."""
        stage = sum(seconds for name, seconds in self.stages.items() if name.startswith(COUPLED))
        return min(max(0.0, self.initialising_s + self.coupled_s - stage), self.stages.get(COMPILING, 0.0))

    @property
    def error(self) -> tuple[str, float]:
        """The output with the largest error over what is allowed, and that; "" where nothing is known."""
        return max(self.errors.items(), key=lambda item: item[1], default=("", 0.0))


UNKNOWN = Spending()


def read_spending(path: Path) -> Spending:
    """Of a summary; of one that is damaged or of another version nothing is known."""
    try:
        found = parse_json(read_text(path))
        numbers = {name: 0.0 + found.get(name, 0.0) for name in ("wall_time_s", "coupled_time_s")}
        known = {one.name for one in fields(Spent)}
        effort = {
            name: Spent(**{key: 0 + value for key, value in one.items() if key in known})
            for name, one in found.get("effort", {}).items()
        }
        stages = {name: 0.0 + seconds for name, seconds in found.get("times", {}).items()}
        errors = {
            name: one["relative_rms"] / one["tolerance"]
            for name, one in found.get("errors", {}).items()
            if one["tolerance"]
        }
        calls, sweeps = found.get("do_steps"), dict(found.get("python_sweeps", {}))
    except (OSError, ValueError, TypeError, AttributeError, KeyError):
        return UNKNOWN
    do_steps = calls if isinstance(calls, int) else None
    wall, coupled = numbers["wall_time_s"], numbers["coupled_time_s"]
    return Spending(wall, coupled, do_steps, stages, effort, sweeps, errors)


def list_parts(scenario: Scenario, spending: Spending) -> list[Part]:
    """By falling time; empty where the run left no times."""
    if not spending.effort or not spending.wall_s:
        return []
    parts = [*_list_coupled(scenario, spending), *_list_stages(scenario, spending)]
    rest = spending.wall_s - sum(part.seconds for part in parts)
    parts.append(Part("checks, start values and assessment", max(0.0, rest)))
    return sorted((part for part in parts if part.seconds > 0.0), key=lambda part: -part.seconds)


def _list_stages(scenario: Scenario, spending: Spending) -> Iterator[Part]:
    """What is not the coupled run."""
    references = 0.0
    for name, seconds in spending.stages.items():
        if name == FMUS:
            yield Part("building and finding FMUs", seconds, once=True)
        elif name == CHOICE:
            remedy = "`scenario.toml` in the folder of the run names the chosen one and runs without it"
            yield Part("the choice of a master", seconds, remedy)
        elif name == COMPILING:
            yield Part("compiling", seconds, once=True)
        elif name in (DRAWING, PAGE):
            yield Part(name, seconds, "`--no-figures` leaves them out, `tribocosim report` draws them later")
        elif name == RECORDS:
            yield Part("result files", seconds, _record_less(scenario))
        elif name == WITNESS:
            yield Part(f"the {WITNESS}", seconds, "`--set reference.witness=none` runs without it")
        elif not name.startswith(COUPLED):
            references += seconds
    remedy = "`--set reference.enabled=false` runs without the comparison"
    yield Part("the reference", references, remedy)


def _record_less(scenario: Scenario) -> str:
    return "" if scenario.step_control else "a longer `output_step` records fewer rows"


def _list_coupled(scenario: Scenario, spending: Spending) -> Iterator[Part]:
    effort = spending.effort
    starting = max(0.0, spending.initialising_s - spending.compiling_s)
    moving = sum(one.stepping_s + one.saving_s for one in effort.values())
    left = spending.initialising_s + spending.coupled_s - spending.compiling_s - starting
    scale = min(1.0, left / moving) if moving else 1.0  # times of a few calls stand for all
    opening = sum(one.opening_s for one in effort.values())
    shared = _share_process(scenario, lambda name: effort[name].opening_s)
    yield Part("starting the participants", opening + starting, shared if opening > starting else "")
    for name, one in effort.items():
        yield Part(f"steps of {name}", scale * one.stepping_s, _quicken(scenario, name, one))
    saving = scale * sum(one.saving_s for one in effort.values())
    explicit = "an explicit master with steps of one length saves none"
    yield Part("saving and restoring states", saving, explicit)
    yield Part("the master, signals and records", left - scale * moving, _compile(scenario, spending))
    yield Part("ending the participants", sum(one.closing_s for one in effort.values()))


def _share_process(scenario: Scenario, weigh: Any) -> str:
    own = [name for name in scenario.components if scenario.process_limits(name)]
    if not own:
        return ""
    name = max(own, key=weigh)
    return f'`components.{name}.process = "shared"` starts no process for an FMU that you trust'


def _quicken(scenario: Scenario, name: str, spent: Spent) -> str:
    """What makes the steps of a participant cheaper."""
    each = spent.stepping_s / max(1, spent.do_steps)
    if spent.failed > MUCH * spent.do_steps:
        needed = math.ceil((spent.own_steps - spent.failed) / spent.do_steps)
        return (
            f"{spent.failed} of its {spent.own_steps} own steps failed: "
            f"`components.{name}.substeps = {needed}` or a shorter `macro_step` repeats fewer"
        )
    if scenario.components[name].substeps > 1:
        return f"it makes {tally(spent.own_steps, 'step')} of its own: a smaller `components.{name}.substeps`"
    if scenario.process_limits(name) and each < 2.0 * MESSAGES_S:
        return _share_process(scenario, lambda other: other == name)
    if scenario.components[name].participant == "fmu":
        return "`--native` runs it as C code"
    longer = "a larger `step_control.relative`" if scenario.step_control else "a longer `macro_step`"
    return f"each of its {spent.do_steps} doStep calls takes {format_time(each)}; {longer} makes fewer"


def _compile(scenario: Scenario, spending: Spending) -> str:
    """What makes the master cheaper."""
    if not spending.python_sweeps:
        return _record_less(scenario)
    name, why = next(iter(spending.python_sweeps.items()))
    own = [name for name in spending.python_sweeps if scenario.process_limits(name)]
    remedy = _share_process(scenario, lambda other: other in own) if own else ""
    said = f"its steps are in Python, as {name} {why.removeprefix('it ')}"
    return f"{said}; {remedy}, and has them compiled" if remedy else said
