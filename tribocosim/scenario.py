"""Scenarios from Python: loaded, changed, checked."""

from __future__ import annotations

import copy
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orchestrator.assessment.trains import check_lash
from orchestrator.errors import MistakeError
from orchestrator.scenario import build_scenario
from orchestrator.scenario.checks import check_units
from orchestrator.scenario.files import build_from, change, list_shipped, read, resolve_paths
from orchestrator.scenario.origin import Origin
from orchestrator.scenario.system import build_system

if TYPE_CHECKING:
    from orchestrator.scenario import Scenario as CheckedScenario


@dataclass(frozen=True)
class Scenario:
    """The tables of a scenario file. MistakeError with a line for each fault, as soon as it is made."""

    content: Mapping[str, Any]
    origin: Origin | None = field(default=None, compare=False)  # of tables that are a file's

    def __repr__(self) -> str:
        return f"Scenario {self.name}: {', '.join(self.content.get('components', {}))}"

    def __post_init__(self) -> None:
        self.check()

    @property
    def name(self) -> str:
        return str(self.content["name"])

    def check(self) -> CheckedScenario:
        """With all defaults, in SI units."""
        content = copy.deepcopy(dict(self.content))
        return build_from(content, self.origin) if self.origin else build_scenario(content)

    def with_(self, changes: Mapping[str, Any] | None = None, /, **more: Any) -> Scenario:
        """Another scenario, with values at paths: {"components.camshaft.parameters.lift": "9 mm"}.

        Also by keyword: with_(stop_time="20 ms").
        """
        known = changes is None or isinstance(changes, Mapping)
        if not known or not all(isinstance(path, str) for path in changes or ()):
            raise MistakeError(
                "changes: must be a dictionary of paths and values, e.g. {'macro_step': '5 us'}, not "
                f"{changes if known else type(changes).__name__}"
            )
        content = copy.deepcopy(dict(self.content))
        change(content, {**(changes or {}), **more})
        resolve_paths(content, Path.cwd())
        return Scenario(content)

    def native(self) -> Scenario:
        """Another scenario, with FMUs in machine code for those that are built of our components."""
        tables = self.check().components.items()
        built = [name for name, table in tables if table.participant == "fmu"]
        content = copy.deepcopy(dict(self.content))
        for name in built:
            content["components"][name]["participant"] = "native"
        return Scenario(content, self.origin)


def read_tables(source: Scenario | str | Path, settings: Sequence[str] = ()) -> dict[str, Any]:
    """The tables of a scenario for a study, checked as for a run; `settings` ("path=value") change a file's.

    MistakeError for a fault, with the file and its line, or the option.
    """
    loaded = Scenario(*read(source, settings)) if isinstance(source, str | Path) else load(source)
    checked = loaded.check()
    check_units(checked)
    check_lash(build_system(checked))
    return dict(loaded.content)


def scenarios() -> dict[str, str]:
    """The names of the shipped scenarios, and what they are."""
    shipped = list_shipped().items()
    return {name: tomllib.loads(path.read_text("utf-8")).get("description", "") for name, path in shipped}


def load(source: Scenario | str | Path | Mapping[str, Any]) -> Scenario:
    """A shipped scenario by its name, a .toml or .ssp file, or tables; one that is loaded stays as it is.
    MistakeError for a fault."""
    if isinstance(source, Scenario):
        return source
    if isinstance(source, Mapping):
        return Scenario({"name": "scenario", **copy.deepcopy(dict(source))})
    if not isinstance(source, str | Path):
        raise MistakeError(
            "source: must be the name of a shipped scenario, a file or a dictionary, not "
            f"{type(source).__name__}"
        )
    return Scenario(*read(source))
