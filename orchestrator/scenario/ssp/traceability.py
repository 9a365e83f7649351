"""The metadata of a run beside its package: Simulation Resource Meta Data (SRMD) of SSP Traceability."""

import hashlib
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py

from ...errors import MistakeError
from ...store.output_folder import RESULT, SUMMARY, list_files
from ...texts import parse_json, read_text
from .names import add_element, expand_tag, to_bytes

SUFFIX = ".srmd"
# The only algorithm of the standard, by its name there.
CHECKSUM = "SHA3-256"
VERDICT = (
    "verdict",
    "largest_error",
    "message",
    "exit_status",
    "reference_method",
    "macro_step",
    "macro_steps",
)


def describe_run(run: Path, package: Path) -> bytes:
    """Of the run in the folder `run`, whose scenario the `package` holds: verdict, tolerances and errors,
    versions, and the checksums of its FMUs, its files and the package."""
    try:
        summary: Mapping[str, Any] = parse_json(read_text(run / SUMMARY))
        with h5py.File(run / RESULT) as file:
            versions = dict(one.rsplit(" ", 1) for one in str(file.attrs["versions"]).split(", "))
        errors = {name: error["relative_rms"] for name, error in summary["errors"].items()}
        content: dict[str, Mapping[str, Any]] = {
            "run": {key: summary[key] for key in VERDICT},
            "tolerance": summary["tolerance"],
            "relative-rms-error": errors,
            "version": versions,
            "fmu-sha256": summary["fmus"],
        }
    except (OSError, ValueError, KeyError) as error:
        raise MistakeError(
            f"{run}: its {SUMMARY} or {RESULT} cannot be read ({error}); run it anew"
        ) from None
    root = add_element(
        None,
        "srmd:SimulationResourceMetaData",
        version="1.0.0-beta2",
        name=summary["scenario"],
        description=summary["description"] or None,
        generationTool=f"tribocosim {summary['version']}",
        data=package.name,
        checksum=_digest(package),
        checksumType=CHECKSUM,
    )
    for kind, values in content.items():
        classification = add_element(root, "stc:Classification", type=f"tribocosim.{kind}")
        for key, value in values.items():
            if value not in (None, ""):
                add_element(classification, "stc:ClassificationEntry", keyword=key).text = str(value)
    files = add_element(root, "stc:Classification", type=f"tribocosim.file-{CHECKSUM.lower()}")
    for path in list_files(run):
        place = Path(os.path.relpath(path, package.parent)).as_posix()
        link = {expand_tag("xlink:href"): place}
        entry = add_element(
            files, "stc:ClassificationEntry", keyword=path.relative_to(run).as_posix(), **link
        )
        entry.text = _digest(path)
    return to_bytes(root)


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha3_256").hexdigest()
