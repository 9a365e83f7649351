"""Write report.html from the folder of a run."""

from __future__ import annotations

import html
import json
import math
from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
from markupsafe import Markup

from models.core.quantities import Vector

from ..errors import MistakeError
from ..scenario import Scenario, ScenarioError
from ..scenario.files import load
from ..scenario.units import to_unit
from ..store import atomic_write
from ..store.output_folder import REPORT, SCENARIO, SUMMARY
from .mechanism import Sketch, list_sketches
from .packing import COARSE, bucket, pack, pack_exactly
from .records import Group, Records, open_records

# Rows that are kept one by one; of more, least and largest values of as many stretches.
ROWS = 24_000
# Characters of packed numbers in a page.
ROOM = 3_400_000
# Plots at first.
PANELS = 4
SCRIPTS = ("series.js", "plots.js", "scene.js", "contact.js", "report.js")


def write_report(folder: Path, path: Path | None = None) -> Path:
    """Write the report of the run in `folder` to `path`, by default into the folder.

    MistakeError if there is no result, or if it cannot be written.
    """
    summary = _read_summary(folder)
    with open_records(folder) as records:
        scenario = _read_scenario(folder)
        known = list(records.groups["coupled"].names) if "coupled" in records.groups else []
        sketches = list_sketches(scenario, known) if scenario else []
        content = _collect(records, scenario, sketches, summary)
        page = _render(records, summary, content)
    path = path or folder / REPORT
    try:
        atomic_write.replace(path, page.encode("utf-8"))
    except OSError as error:
        raise MistakeError(f"{path}: cannot be written ({error.strerror}); choose another") from None
    return path


def _read_summary(folder: Path) -> Mapping[str, Any]:
    try:
        found: Mapping[str, Any] = json.loads((folder / SUMMARY).read_text("utf-8"))
    except (OSError, ValueError):
        found = {}
    return {"exit_status": None, "complete": False, "reference_method": "monolithic", **found}


def _read_scenario(folder: Path) -> Scenario | None:
    """The resolved scenario; None where what it names is gone, such as an FMU."""
    try:
        return load(folder / SCENARIO)
    except (ScenarioError, OSError, ValueError):
        return None


def _collect(
    records: Records, scenario: Scenario | None, sketches: Sequence[Sketch], summary: Mapping[str, Any]
) -> dict[str, Any]:
    """What the page's scripts need: time bases, variables with packed values, sketches."""
    bases: list[dict[str, Any]] = []
    variables: list[dict[str, Any]] = []
    room = ROOM
    left_out = 0
    for name, group in records.groups.items():
        if name == "reference" or not group.rows:
            continue
        base = _Base(group, len(bases))
        bases.append(base.content)
        reference = records.groups.get("reference") if name == "coupled" else None
        if reference and reference.rows != group.rows:
            reference = None
        names = [n for n in group.names if n != "time"]
        if name == "coupled":
            names = _rank(names, scenario, sketches, summary)
        for variable in names:
            packed = base.pack(group, variable, name, reference)
            size = sum(len(text) for text in packed["data"].values())
            if size > room:
                left_out += 1
                continue
            room -= size
            variables.append(packed)
    return {
        "bases": bases,
        "variables": variables,
        "leftOut": left_out,
        "sketches": [sketch.content() for sketch in sketches],
        "panels": _choose_panels(variables, scenario, summary),
    }


def _rank(
    names: Sequence[str], scenario: Scenario | None, sketches: Sequence[Sketch], summary: Mapping[str, Any]
) -> list[str]:
    """Variables that the sketches move by first, then those with an error, contacts' loads, and the rest."""
    moving = set().union(*(sketch.variables for sketch in sketches)) if sketches else set()
    compared = set(summary.get("errors", {})) | set(scenario.tolerance if scenario else ())

    def rank(name: str) -> tuple[bool, bool, bool]:
        return name not in moving, name not in compared, not name.endswith((".load", ".film_thickness"))

    return sorted(names, key=rank)


def _choose_panels(
    variables: Sequence[Mapping[str, Any]], scenario: Scenario | None, summary: Mapping[str, Any]
) -> list[str]:
    """The variables that are drawn at first: those with a tolerance, then loads, films and lifts."""
    known = [str(v["name"]) for v in variables if v["group"] == "coupled"]
    chosen = [name for name in summary.get("tolerance", {}) if name in known]
    for endings in ((".load",), (".film_thickness",), (".valve_lift", ".position"), (".piston_offset",)):
        chosen += [name for ending in endings for name in known if name.endswith(ending)][:1]
    return list(dict.fromkeys([*chosen, *known]))[:PANELS]


class _Base:
    """The times of a group, thinned to stretches if there are many rows."""

    def __init__(self, group: Group, number: int) -> None:
        self.number = number
        time = group.read("time")
        self.size = -(-len(time) // ROWS)
        self.content = {
            "rows": len(time),
            "stretch": self.size,
            "time": pack_exactly(time[:: self.size]),
            "end": float(time[-1]),
        }

    def pack(self, group: Group, name: str, kind: str, reference: Group | None) -> dict[str, Any]:
        """A variable with its values, and those of its error where there is a reference on the same rows."""
        values = group.read(name)
        data = self._pack(values, "values")
        if reference and name in reference.names:
            data |= self._pack(values - reference.read(name), "error", COARSE)
        unit, factor = _choose_unit(group, name)
        return {
            "name": name,
            "group": kind,
            "base": self.number,
            "unit": unit,
            "factor": factor,
            "description": group.attribute(name, "long_name"),
            "choices": group.attribute(name, "flag_meanings").split(),
            "data": data,
        }

    def _pack(self, values: Vector, key: str, bits: int | None = None) -> dict[str, str]:
        own = {} if bits is None else {"bits": bits}
        if self.size == 1:
            return {key: pack(values, **own)}
        low, high = bucket(values, self.size)
        return {key: pack(low, **own), f"{key}High": pack(high, **own)}


def _choose_unit(group: Group, name: str) -> tuple[str, float]:
    """The unit in which a variable is shown, and the factor to it."""
    unit, shown = group.attribute(name, "units"), group.attribute(name, "display_units")
    if not shown:
        return unit if unit != "1" else "", 1.0
    return shown, 1.0 / to_unit(f"1 {shown}", unit)


def _render(records: Records, summary: Mapping[str, Any], content: Mapping[str, Any]) -> str:
    folder = resources.files(__package__) / "assets"
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined)
    template = environment.from_string((folder / "page.html").read_text("utf-8"))
    errors = [
        {"name": name, **error, "order": _finite(error.get("order"))}
        for name, error in summary.get("errors", {}).items()
    ]
    script = "\n".join((folder / name).read_text("utf-8") for name in SCRIPTS)
    return template.render(
        summary=summary,
        title=records.attributes.get("title") or records.attributes.get("scenario", ""),
        verdict=_describe_verdict(records, summary),
        attributes=records.attributes,
        errors=sorted(errors, key=lambda error: error.get("tolerance") is None),
        fmus=summary.get("fmus", {}),
        toml=str(records.attributes.get("scenario_toml", "")),
        style=Markup((folder / "report.css").read_text("utf-8")),
        script=Markup(script),
        data=Markup(_to_script(content)),
        has_scene=bool(content["sketches"]),
    )


def _describe_verdict(records: Records, summary: Mapping[str, Any]) -> str:
    """How the run ended, and its largest error, in words."""
    if not summary.get("complete"):
        return str(summary.get("message") or records.attributes.get("message", ""))
    text = f"{summary['scenario']}: {summary['verdict']}"
    return f"{text}; {summary['largest_error']}" if summary.get("largest_error") else text


def _finite(value: Any) -> float | None:
    return float(value) if isinstance(value, int | float) and math.isfinite(value) else None


def _to_script(content: Mapping[str, Any]) -> str:
    """JSON that no parser of HTML can take for anything else."""
    text = json.dumps(content, separators=(",", ":"), allow_nan=False, default=_plain)
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{html.escape(repr(value))}: has no JSON")
