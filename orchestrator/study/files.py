"""Finds, reads and resolves study files."""

from __future__ import annotations

import copy
import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, ValidationError, model_validator

from models.core.system import suggestion

from ..errors import MistakeError, list_faults, name_source
from ..scenario import Written, find_faults
from ..scenario.fields import FolderName
from ..scenario.files import find, has_path, put, read_contents
from ..scenario.system import Builder
from ..scenario.values import Value
from ..texts import read_toml, to_path
from .points import POINT, Grid, Points, Rows, Sobol, Table, expand_points, list_keys, parse_points
from .subjects import AnalysisSubject, Subject, load_analysis

SHIPPED = Path(__file__).parent / "shipped"
# Variables that every store has besides the results.
STATUS, MESSAGE = "status", "message"


class Study(Table):
    """A study file."""

    name: FolderName = Field(description="Name of the study; default: that of the file")
    description: str = Field("", description="What the study shows, in a line")
    scenario: str | None = Field(None, description="A shipped scenario, or a path beside the file")
    analysis: str | None = Field(None, description="An analysis by name, or your own as module:object")
    names: dict[str, Annotated[list[str], Field(min_length=1)]] = Field(
        {}, description="Short names for settings of the scenario, each for one or several"
    )
    fixed: dict[str, Written] = Field({}, description="Values set at every point")
    figure: list[str] = Field([], description="Results to draw; default: some, by the subject")
    points: Annotated[Grid | Sobol | Rows, BeforeValidator(parse_points)]

    @model_validator(mode="after")
    def _one_subject(self) -> Study:
        if (self.scenario is None) == (self.analysis is None):
            raise ValueError("must have one of scenario and analysis")
        if self.names and self.analysis is not None:
            raise ValueError("names: are for settings of a scenario; an analysis has names of its own")
        if both := [name for name in self.points.parameters if name in self.fixed]:
            raise ValueError(f"fixed.{both[0]}: is also a parameter of the points; remove one of them")
        return self


@dataclass(frozen=True)
class Plan:
    """A study with everything resolved."""

    study: Study
    subject: Subject
    points: Points

    def attributes(self) -> dict[str, str]:
        """The attributes of the store."""
        return {
            "title": self.study.description or self.study.name,
            "study": json.dumps(self.study.model_dump(exclude_none=True, by_alias=True)),
            "subject": self.subject.content(),
        }


def list_shipped() -> dict[str, Path]:
    """The studies that come with the program, by name."""
    return {path.stem: path for path in sorted(SHIPPED.glob("*.toml"))}


def find_file(name: str) -> Path:
    """The file of a shipped study or a path; MistakeError if there is neither."""
    path = list_shipped().get(name, to_path(name))
    if path.is_file():
        return path
    if path.is_dir():
        raise MistakeError(f"{path}: is a folder", "name the .toml file in it")
    if path.suffix == ".toml":
        shipped = f"a shipped study's name: {', '.join(list_shipped())}"
        raise MistakeError(f"{path}: no such file here ({Path.cwd()})", "give its path", shipped)
    near = suggestion(name, list_shipped())
    raise MistakeError(f"no study {name!r}", f"{near} (or give the path of a .toml file)")


def load(name: str, build: Builder) -> Plan:
    """Read and resolve the study of that name or path; MistakeError with the file's name for each fault."""
    path = find_file(name)
    content = read_toml(path)
    if stray := {"grid", "sobol", "list", "axes", "ranges", "rows"} & set(content):
        where = f"{path.name}: {min(stray)}: belongs in the table [points]"
        raise MistakeError(where, "see docs/reference/studies.md")
    content.setdefault("name", path.stem)
    try:
        study = parse_study(content)
        return resolve(study, build_subject(study, path.parent, build))
    except MistakeError as error:
        raise MistakeError(name_source(path.name, error)) from None


def parse_study(content: Mapping[str, Any]) -> Study:
    """Check a file's content; MistakeError with a line for each fault."""
    try:
        return Study.model_validate(content)
    except ValidationError as error:
        raise MistakeError(list_faults(find_faults(error, lambda place: list_keys(Study)))) from None


def resolve(study: Study, subject: Subject) -> Plan:
    """Expand the points, with values in the parameters' units; MistakeError for a fault."""
    points = expand_points(study.points, subject.resolve)
    taken = {STATUS, MESSAGE, POINT, *points.coordinates}
    if clash := taken & set(subject.results):
        raise MistakeError(f"{min(clash)}: is the name of a result", "call the parameter something else")
    for name in study.figure:
        if name not in subject.results or subject.results[name].text:
            numbers = [known for known, result in subject.results.items() if not result.text]
            raise MistakeError(f"figure: no number {name!r} among the results", suggestion(name, numbers))
    return Plan(study, subject, points)


def plan_axis(
    name: str, description: str, subject: Subject, axis: str, ends: tuple[float, float], count: int
) -> Plan:
    """The study of a scenario of that name along one axis, with a subject of its own."""
    points = {"kind": "grid", "axes": {axis: {"start": ends[0], "stop": ends[1], "count": count}}}
    about = {"name": name, "description": description, "scenario": name}
    return resolve(parse_study({**about, "points": points}), subject)


def build_subject(study: Study, folder: Path, build: Builder) -> Subject:
    """The analysis or the scenario of a study, the latter by a path in `folder`."""
    if study.analysis is not None:
        fixed: dict[str, Value] = load_analysis(study.analysis).complete(study.fixed)
        return AnalysisSubject(study.analysis, fixed)
    return build_scenario_subject(study, read_contents(find(str(study.scenario), folder)), build)


def build_scenario_subject(study: Study, tables: dict[str, Any], build: Builder) -> Subject:
    """The scenario of these tables, with the study's fixed values."""
    from .scenario_subject import ScenarioSubject

    fixed = {path: name for name in study.fixed for path in study.names.get(name, [name])}
    put(tables, {path: study.fixed[name] for path, name in fixed.items()})
    for axis in study.points.parameters:
        varied = copy.deepcopy(tables)
        put(varied, dict.fromkeys(study.names.get(axis, [axis]), 0.0))
        for path, name in fixed.items():
            if not has_path(varied, path):
                raise MistakeError(f"fixed.{name}: {axis} of the points takes its place", "leave one out")
    return ScenarioSubject(tables, study.names, build)
