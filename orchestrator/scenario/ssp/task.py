"""The steps of a run beside its package: Simulation Task Meta Data (STMD) of SSP Traceability.

Each step names the files that it took and gave, and has the classifications of the run that belong to it.
"""

import copy
import mimetypes
import uuid
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from ...store import output_folder as files
from .names import PACKAGE_TYPE, add_element, to_bytes
from .traceability import SUFFIX, VERSION, locate

TASK_SUFFIX = ".stmd"
# Kinds are the standard's. Figures are the files in folders.
TYPES = {".srmd": "application/x-srmd-meta-data", ".ssp": PACKAGE_TYPE, ".toml": "application/toml"}
RESULTS = dict.fromkeys((files.RESULT, files.CSV, files.UNITS, files.TEXTS), "result")
SHOWN = {files.MERITS: "result", files.REPORT: "report", files.FIGURES: "report"}


class Step(NamedTuple):
    """Its name, the kinds of the files that it gave, and the run's classifications that tell of it."""

    name: str
    given: Mapping[str, str]
    classifications: tuple[str, ...] = ()


PHASES = {
    "ExecutionPhase": [
        Step("ExecuteSimulation", RESULTS | {files.PRINTED: "report"}, ("version", "fmu-sha256"))
    ],
    "EvaluationPhase": [
        Step("EvaluateSimulationResults", SHOWN),
        Step("AssureSimulationQuality", {files.SUMMARY: "report"}, ("tolerance", "relative-rms-error")),
        Step("DeriveSimulationQualityVerdict", {}, ("run",)),
    ],
}


def write_task(described: Any, run: Path, package: Path) -> bytes:
    """The file of a run's task, from the run's element as `describe_run` makes it.

    The execution takes the package with its metadata and the scenario. The GUID is that of the content.
    """
    taken = {
        package: "system",
        package.with_suffix(SUFFIX): "document",
        run / files.SCENARIO: "configuration",
    }
    written = {path: path.relative_to(run).parts[0] for path in files.list_files(run) if path.is_file()}
    known = {key: described.get(key) for key in ("name", "description", "generationTool")}
    task = add_element(None, "stmd:SimulationTaskMetaData", version=VERSION, **known)
    for phase, steps in PHASES.items():
        parent = add_element(task, f"stmd:{phase}")
        for name, given, classifications in steps:
            step = add_element(parent, f"stmd:{name}")
            if name == "ExecuteSimulation":
                _add_resources(step, "Input", taken, package)
            came = {path: given[place] for path, place in written.items() if place in given}
            _add_resources(step, "Output", came, package)
            types = {f"tribocosim.{one}" for one in classifications}
            step.extend(copy.deepcopy(one) for one in described if one.get("type") in types)
    task.set("GUID", str(uuid.uuid5(uuid.NAMESPACE_URL, to_bytes(task).decode())))
    return to_bytes(task)


def _add_resources(step: Any, particle: str, kinds: Mapping[Path, str], package: Path) -> None:
    """What the step took or gave, each file with its kind and MIME type."""
    if kinds:
        parent = add_element(step, f"stc:{particle}")
        # Without the types of this machine's files.
        known = mimetypes.MimeTypes()
        for path, kind in kinds.items():
            mime = TYPES.get(path.suffix) or known.guess_type(path.name)[0] or "application/octet-stream"
            add_element(parent, "stc:Resource", kind=kind, type=mime, source=locate(path, package))
