"""The metadata of a run beside its package: Simulation Resource Meta Data (SRMD) of SSP Traceability."""

import hashlib
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import quote

import h5py

from models.core.remedies import make_printable

from ...errors import MistakeError
from ...store.output_folder import RESULT, SUMMARY, list_files
from ...texts import parse_json, read_text
from .names import add_element, expand_tag, to_bytes

SUFFIX, VERSION = ".srmd", "1.0.0-beta2"
# The only algorithm of the standard, by its name there.
CHECKSUM = "SHA3-256"
VERDICT = "verdict", "message", "exit_status", "reference_method", "macro_steps"


def describe_run(run: Path) -> Any:
    """The element of the run in this folder: its verdict, tolerances and errors, and versions."""
    try:
        summary: Mapping[str, Any] = parse_json(read_text(run / SUMMARY))
        with h5py.File(run / RESULT) as file:
            versions = dict(one.rsplit(" ", 1) for one in str(file.attrs["versions"]).split(", "))
        content: dict[str, Mapping[str, Any]] = {
            "run": {key: summary[key] for key in VERDICT} | _list_numbers(summary),
            "tolerance": summary["tolerance"],
            "relative-rms-error": {name: error["relative_rms"] for name, error in summary["errors"].items()},
            "version": versions,
            "fmu-sha256": summary["fmus"],
        }
        root = add_element(
            None,
            "srmd:SimulationResourceMetaData",
            version=VERSION,
            name=summary["scenario"],
            description=make_printable(summary["description"]) or None,
            generationTool=f"tribocosim {summary['version']}",
        )
        for kind, values in content.items():
            classification = _add_classification(root, kind)
            for key, value in values.items():
                if value not in (None, ""):
                    _add_entry(classification, key).text = make_printable(str(value))
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise MistakeError(
            f"{run}: its {SUMMARY} or {RESULT} cannot be read ({error}); run it anew"
        ) from None
    return root


def _list_numbers(summary: Mapping[str, Any]) -> dict[str, str]:
    """Numbers of the run with their units; of what the tolerance judges, the largest share of it."""
    judged = {name: error for name, error in summary["errors"].items() if error["tolerance"]}
    numbers = {"macro_step": f"{summary['macro_step']!r} s"}
    if judged:
        name = max(judged, key=lambda one: judged[one]["relative_rms"] / judged[one]["tolerance"])
        error, allowed = judged[name]["relative_rms"], judged[name]["tolerance"]
        numbers |= {"largest_error_over_tolerance": f"{error / allowed!r}", "largest_error_output": name}
    return numbers


def write_metadata(root: Any, run: Path, package: Path) -> bytes:
    """The file of that element, with the checksums of the run's files and of the package of its scenario."""
    root.attrib |= {"data": quote(package.name), "checksum": _digest(package), "checksumType": CHECKSUM}
    files = _add_classification(root, f"file-{CHECKSUM.lower()}")
    for path in filter(Path.is_file, list_files(run)):
        entry = _add_entry(files, path.relative_to(run).as_posix())
        entry.set(expand_tag("xlink:href"), locate(path, package))
        entry.text = _digest(path)
    return to_bytes(root)


def locate(path: Path, package: Path) -> str:
    """The address of a file from the folder of the package."""
    return quote(Path(os.path.relpath(path, package.parent)).as_posix())


def _add_classification(root: Any, kind: str) -> Any:
    return add_element(root, "stc:Classification", type=f"tribocosim.{kind}")


def _add_entry(classification: Any, keyword: str) -> Any:
    return add_element(classification, "stc:ClassificationEntry", keyword=keyword)


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha3_256").hexdigest()
