"""Write report.html from the folder of a run, or of a sweep over speed."""

import json
import math
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Any

import jinja2
import numpy as np
from markupsafe import Markup

from ..errors import MistakeError, another
from ..scenario import Scenario, ScenarioError
from ..scenario.files import load
from ..scenario.values import WARNING
from ..store import atomic_write
from ..store.output_folder import REPORT, SCENARIO, STORE, SUMMARY
from ..store.records import Records, open_records
from ..texts import parse_json, read_text
from .content import ATTRIBUTES, collect_run, describe
from .cycle import Train, collect_cycle
from .repetition import repeat

SCRIPTS = (
    "series.js", "axes.js", "view.js", "marks.js", "panel.js", "phase.js", "steps.js", "scene.js",
    "contact.js", "sweep.js", "cycle.js", "report.js",
)  # fmt: skip

# What a page that is not of a run does not say.
UNSAID: Mapping[str, Any] = {
    "summary": {},
    "notices": [],
    "version": "",
    "versions": "",
    "fmus": {},
    "toml": "",
}


def write_report(folder: Path, path: Path | None = None) -> Path:
    """Write the report of the run, or the sweep over speed, in `folder` to `path`, by default in there.

    MistakeError if there is no result, or if it cannot be written.
    """
    if (folder / STORE).exists():
        from .sweep import collect_sweep  # its libraries take long to import

        page = _render(*collect_sweep(folder))
    else:
        page = _render_run(folder)
    return write_page(page, path or folder / REPORT)


def write_cycle(train: Train, path: Path) -> Path:
    """Write the page that computes the steady cycle of a train; MistakeError if it cannot be written."""
    return write_page(_render(*collect_cycle(train)), path)


def write_page(page: str, path: Path) -> Path:
    """Write a page to `path` at once; MistakeError if it cannot be written."""
    try:
        atomic_write.write_whole(path, page.encode("utf-8"))
    except OSError as error:
        raise MistakeError(f"{path}: cannot be written ({error.strerror})", another()) from None
    return path


def _render_run(folder: Path) -> str:
    summary = _read_summary(folder)
    with open_records(folder) as records:
        content = collect_run(records, _read_scenario(folder), summary)
        return _render(_tell_run(folder, records, summary), content)


def _read_summary(folder: Path) -> Mapping[str, Any]:
    try:
        found: Mapping[str, Any] = parse_json(read_text(folder / SUMMARY))
    except (OSError, ValueError):
        found = {}
    return {"exit_status": None, "complete": False, "reference_method": "monolithic", **found}


def _read_scenario(folder: Path) -> Scenario | None:
    """The resolved scenario; None where what it names is gone, such as an FMU."""
    try:
        return load(folder / SCENARIO)
    except (ScenarioError, OSError, ValueError):
        return None


def _tell_run(folder: Path, records: Records, summary: Mapping[str, Any]) -> dict[str, Any]:
    """What the page says of a run besides its content."""
    attributes = records.attributes
    errors = [
        {**_find_unit(records, name), **error, "order": _finite(error.get("order"))}
        for name, error in summary.get("errors", {}).items()
    ]
    return {
        "summary": summary,
        "name": attributes.get("scenario", ""),
        "title": attributes.get("title") or attributes.get("scenario", ""),
        "kind": _choose_kind(summary),
        "verdict": _describe_verdict(records, summary),
        "version": summary.get("version", ""),
        "versions": attributes.get("versions", ""),
        "command": repeat("run", folder / SCENARIO, folder),
        "errors": sorted(errors, key=lambda error: error.get("tolerance") is None),
        "contacts": summary.get("contacts", {}),
        "energy": summary.get("energy"),
        "notices": summary.get("notices", []),
        "fmus": summary.get("fmus", {}),
        "toml": str(attributes.get("scenario_toml", "")),
    }


def _choose_kind(summary: Mapping[str, Any]) -> str:
    """The colour of the verdict: amber where its scenario is doubted, none where nothing is compared."""
    if summary["exit_status"] != 0:
        return "bad"
    doubted = any(note.startswith(WARNING) for note in summary.get("notices", []))
    return "unsteady" if doubted else "good" if summary.get("errors") else ""


def _find_unit(records: Records, name: str) -> dict[str, Any]:
    """The unit in which a variable's errors are shown, and the factor to it."""
    group = records.groups.get("coupled")
    known = {key: group.attribute(name, key) for key in ATTRIBUTES} if group else {}
    return describe(name, known)


def _read_asset(name: str) -> str:
    return (resources.files(__package__) / "assets" / name).read_text("utf-8")


def render(template: str, **values: Any) -> str:
    """A page by its template, with the values escaped, in the look of all pages."""
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, loader=jinja2.FunctionLoader(_read_asset)
    )
    environment.filters["number"] = lambda x, text, factor=1.0: "" if x is None else text % (factor * x)
    return environment.get_template(template).render(**values, style=Markup(_read_asset("report.css")))


def _render(values: Mapping[str, Any], content: Mapping[str, Any]) -> str:
    return render(
        "page.html",
        **{**UNSAID, **values},
        script=Markup("\n".join(map(_read_asset, SCRIPTS))),
        data=Markup(_to_script(content)),
        has_scene=bool(content["sketches"]),
        has_reference=any("error" in variable["data"] for variable in content["variables"]),
        has_marks=bool(content["marks"]),
        has_steps=bool(content.get("steps")),
        has_sweep=bool(content.get("sweep")),
        has_cycle=bool(content.get("cycle")),
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
    raise TypeError(f"{value!r}: has no JSON")
