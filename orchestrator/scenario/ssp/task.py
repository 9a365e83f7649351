"""The steps of a run beside its package: Simulation Task Meta Data (STMD) of SSP Traceability.

Each step names the files that it took and gave, and has the classifications of the run that belong to it.
"""

import copy
import uuid
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from ...store import output_folder as files
from .names import PACKAGE_TYPE, add_element, to_bytes
from .traceability import SUFFIX, VERSION, locate

TASK_SUFFIX = ".stmd"
TYPES = {
    ".ssp": PACKAGE_TYPE,
    SUFFIX: "application/x-srmd-meta-data",
    ".toml": "application/toml",
    ".nc": "application/x-netcdf",
    ".csv": "text/csv",
    ".json": "application/json",
    ".html": "text/html",
    ".png": "image/png",
}
# Kinds are the standard's: by a file of the run, a folder in it, or a suffix beside the run.
TAKEN = {".ssp": "system", SUFFIX: "document", files.SCENARIO: "configuration"}
RESULTS = dict.fromkeys((files.RESULT, files.CSV, files.UNITS, files.TEXTS), "result")
SHOWN = {files.REPORT: "report", files.MERITS: "result", files.FIGURES: "report"}


class Step(NamedTuple):
    """Its name, the kinds of the files that it took and gave, and the classifications that tell of it."""

    name: str
    taken: Mapping[str, str] = {}
    given: Mapping[str, str] = {}
    classifications: tuple[str, ...] = ()


PHASES = {
    "ExecutionPhase": [
        Step("ExecuteSimulation", TAKEN, RESULTS | {files.PRINTED: "report"}, ("version", "fmu-sha256"))
    ],
    "EvaluationPhase": [
        Step("EvaluateSimulationResults", given=SHOWN),
        Step("AssureSimulationQuality", {}, {files.SUMMARY: "report"}, ("tolerance", "relative-rms-error")),
        Step("DeriveSimulationQualityVerdict", classifications=("run",)),
    ],
}


def write_task(described: Any, run: Path, package: Path) -> bytes:
    """The file of a run's task, from the run's element as `describe_run` makes it.

    The GUID is that of the content.
    """
    places = {SUFFIX: [package.with_suffix(SUFFIX)], ".ssp": [package]}
    for path in filter(Path.is_file, files.list_files(run)):
        places.setdefault(path.relative_to(run).parts[0], []).append(path)
    known = {key: described.get(key) for key in ("name", "description", "generationTool")}
    task = add_element(None, "stmd:SimulationTaskMetaData", version=VERSION, **known)
    for phase, steps in PHASES.items():
        parent = add_element(task, f"stmd:{phase}")
        for one in steps:
            step = add_element(parent, f"stmd:{one.name}")
            for particle, kinds in (("Input", one.taken), ("Output", one.given)):
                _add_resources(step, particle, kinds, places, package)
            types = {f"tribocosim.{kind}" for kind in one.classifications}
            step.extend(copy.deepcopy(element) for element in described if element.get("type") in types)
    task.set("GUID", str(uuid.uuid5(uuid.NAMESPACE_URL, to_bytes(task).decode())))
    return to_bytes(task)


def _add_resources(
    step: Any, particle: str, kinds: Mapping[str, str], places: Mapping[str, list[Path]], package: Path
) -> None:
    """What the step took or gave, each file with its kind and MIME type."""
    found = [(path, kind) for name, kind in kinds.items() for path in places.get(name, [])]
    parent = add_element(step, f"stc:{particle}") if found else None
    for path, kind in found:
        mime = TYPES.get(path.suffix, "application/octet-stream")
        add_element(parent, "stc:Resource", kind=kind, type=mime, source=locate(path, package))
