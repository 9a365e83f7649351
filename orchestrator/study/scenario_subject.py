"""A scenario as the subject of a study: each point is a run."""

import copy
import functools
import hashlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from models.compile.temporary import TemporaryFolder
from models.core import roles
from models.core.quantities import Quantity

from ..analyses import Result
from ..analyses.stability.chosen import choose_master
from ..assessment.contacts import ContactSummary
from ..assessment.notices import list_notices
from ..errors import IncompleteError, MistakeError, in_command_line
from ..reporter import Reporter
from ..run.comparison import VariableError
from ..run.pipeline import run_plan
from ..run.plan import make_plan
from ..scenario import DURATIONS, Scenario, build_scenario, parse_ends
from ..scenario.files import put, split_path, to_full_toml
from ..scenario.system import Builder, list_outputs, resolve
from ..scenario.values import SECTIONS, Value, list_layouts, parse_value
from ..store.output_folder import RESULT
from ..store.result_file import open_result
from .subjects import MOST_DRAWN, Subject

STATISTICS: dict[str, Any] = {"minimum": np.min, "maximum": np.max, "mean": np.mean}
ERRORS = {
    "error": ("relative RMS error", lambda error: error.relative_rms),
    "uncertainty": (
        "relative RMS uncertainty of the reference",
        lambda error: error.uncertainty.relative_rms,
    ),
}
SEPARATION: dict[str, tuple[str, str, Callable[[ContactSummary], float]]] = {
    "separations": ("1", "how often it opened", lambda c: c.separation.count if c.separation else 0.0),
    "separated": ("1", "share of the whole run in which contact is lost", lambda c: c.lost),
    "largest_gap": ("m", "largest gap", lambda c: c.separation.gap if c.separation else 0.0),
    "impact_load": ("N", "load of the hardest impact", lambda c: c.impact.load if c.impact else 0.0),
    "impact_speed": ("m/s", "speed of the hardest impact", lambda c: c.impact.speed if c.impact else 0.0),
}


@dataclass(frozen=True)
class ScenarioSubject(Subject):
    """The tables of a scenario, short names for its settings, and the builder of its FMUs."""

    tables: Mapping[str, Any]
    names: Mapping[str, list[str]]
    build: Builder

    @functools.cached_property
    def scenario(self) -> Scenario:
        return build_scenario(self.tables)

    def build_scenario_at(self, values: Mapping[str, Value]) -> Scenario:
        """The scenario at a point; ScenarioError names the fault."""
        tables = copy.deepcopy(dict(self.tables))
        put(tables, {path: value for name, value in values.items() for path in self._list_paths(name)})
        return build_scenario(tables)

    @property
    def results(self) -> Mapping[str, Result]:
        """Of the scenario as fixed: statistics of all outputs over time, and errors where compared."""
        found = {
            f"{name}.{statistic}": Result(
                quantity.unit,
                f"{quantity.description}: {statistic} over time",
                display_unit=quantity.display_unit,
            )
            for name, quantity in list_outputs(self.scenario).items()
            for statistic in STATISTICS
        }
        found |= {
            f"{name}.{key}": Result("1", f"{name}: {text}")
            for name in self._list_compared()
            for key, (text, _) in ERRORS.items()
        }
        found |= {
            f"{name}.{key}": Result(unit, f"{name}: {text}")
            for name, table in self.scenario.components.items()
            if table.resolve().has_role(roles.Contact)
            for key, (unit, text, _) in SEPARATION.items()
        }
        found["macro_steps"] = Result("1", "macro steps")
        found["iterations"] = Result("1", "iterations of the master")
        return found

    def _list_compared(self) -> list[str]:
        if not self.scenario.reference.enabled:
            return []
        driving = {parse_ends(line)[0] for line in self.scenario.connections}
        judged = {*driving, *self.scenario.tolerance}
        return [name for name in list_outputs(self.scenario) if name in judged]

    def _list_paths(self, name: str) -> list[str]:
        return self.names.get(name, [name])

    def _find_quantity(self, path: str) -> Quantity | None:
        """The quantity of a component's value; None for other settings."""
        keys = split_path(path)
        if keys[0] != "components" or len(keys) < 4 or keys[2] not in SECTIONS:
            return None
        table = self.scenario.components.get(keys[1])
        if table is None:
            return None
        layout = list_layouts(table.resolve())[keys[2]]
        return layout.field(keys[3]).quantity if keys[3] in layout else None

    def resolve(self, name: str, value: Value) -> Value:
        found = {self._resolve_path(path, value) for path in self._list_paths(name)}
        if len(found) != 1:
            raise MistakeError(f"{name} = {value!r}: must mean the same in all of {self._list_paths(name)}")
        return found.pop()

    def _resolve_path(self, path: str, value: Value) -> Value:
        quantity = self._find_quantity(path)
        if quantity is None:
            return _find_value(self.build_scenario_at({path: value}), split_path(path))
        try:
            return parse_value(quantity, value)
        except ValueError as error:
            raise MistakeError(f"{path} = {value!r} ({quantity.description}): {error}") from None

    def describe(self, name: str) -> Result:
        path = self._list_paths(name)[0]
        quantity = self._find_quantity(path)
        if quantity is not None:
            return Result(quantity.unit, quantity.description, display_unit=quantity.display_unit)
        if path in DURATIONS:
            return Result("s", path)
        return Result("K" if path.endswith(".temperature") else "1", path)

    @property
    def default_figure(self) -> Sequence[str]:
        """Extremes of the variables with a tolerance."""
        found = [
            f"{name}.{extreme}" for name in self.scenario.tolerance for extreme in ("minimum", "maximum")
        ]
        return (found or list(self.results))[:MOST_DRAWN]

    def list_warnings(self, values: Mapping[str, Value]) -> list[str]:
        return list_notices(self.build_scenario_at(values))

    def content(self) -> str:
        return to_full_toml(self.scenario) + "".join(list_fmu_sums(self.scenario))

    def evaluate(self, values: Mapping[str, Value]) -> Mapping[str, float | str]:
        """IncompleteError, with what was recorded, if the run does not come to its end."""
        quiet = Reporter(Console(quiet=True))
        # A lost point is computed again, without a checkpoint.
        asked = self.build_scenario_at(values).model_copy(update={"checkpoint_every": 0.0})
        plan = make_plan(choose_master(resolve(asked), quiet), self.build, quiet, figures=False)
        found: dict[str, float] = {}
        with TemporaryFolder() as folder:
            summary = run_plan(plan, folder, quiet)
            if (folder / RESULT).exists():
                found = _compute_statistics(folder)
        for name, table in asked.components.items():
            if table.resolve().has_role(roles.Contact):
                found |= _collect_contact(name, summary.contacts.get(name))
        found["macro_steps"] = summary.macro_steps
        found["iterations"] = summary.iterations
        if not summary.complete:
            raise IncompleteError(in_command_line(summary.message).removeprefix("incomplete: "), found)
        return found | _collect_errors(summary.errors)


def list_fmu_sums(scenario: Scenario) -> Iterator[str]:
    """A line with the sum of every third-party FMU."""
    for name, table in scenario.components.items():
        path = Path(table.participant)
        if path.suffix == ".fmu" and path.is_file():
            yield f"# {name}: SHA-256 {hashlib.sha256(path.read_bytes()).hexdigest()}\n"


def _collect_contact(name: str, summary: ContactSummary | None) -> dict[str, float]:
    """Results over all macro steps; recorded rows may be fewer."""
    if summary is None:
        return {f"{name}.{key}": 0.0 for key in SEPARATION}
    return {
        f"{name}.load.minimum": summary.least_load,
        f"{name}.load.maximum": summary.largest_load,
        f"{name}.maximum_pressure.maximum": summary.pressure,
        **{f"{name}.{key}": value_of(summary) for key, (_, _, value_of) in SEPARATION.items()},
    }


def _find_value(scenario: Scenario, keys: list[str]) -> Value:
    """The value at a path of a whole scenario."""
    content: Any = scenario
    for key in keys:
        content = content[key] if isinstance(content, Mapping) else getattr(content, key)
    if not isinstance(content, (bool, int, float, str)):
        raise MistakeError(f"{'.'.join(keys)}: must be a single value")
    return content


def _compute_statistics(folder: Path) -> dict[str, float]:
    with open_result(folder) as tree:
        coupled = tree["coupled"]
        return {
            f"{name}.{statistic}": float(function(values.values))
            for name, values in coupled.data_vars.items()
            for statistic, function in STATISTICS.items()
        }


def _collect_errors(errors: Mapping[str, VariableError]) -> dict[str, float]:
    return {
        f"{name}.{key}": value_of(error)
        for name, error in errors.items()
        for key, (_, value_of) in ERRORS.items()
    }
