"""Reference results inside an FMU, as the layered standard FMI-LS-REF (1.0.0-beta.1) places related files.

`extra/` is for additional data in FMI 2.0 (since 2.0.2) and 3.0; tools that do not know the standard skip it.
"""

from collections.abc import Iterable

from ..fmi.layered import write_manifest
from .results import compute_results

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
# As the text of 1.0.0-beta.1 has it for the manifest.
VERSION = "1.0.0-alpha.1"
MANIFEST = f"{FOLDER}/fmi-ls-manifest.xml"

_KINDS = {
    "_in.csv": ("text/csv", "testcase", "Inputs of the reference run"),
    "_ref.csv": ("text/csv", "result", "Reference results of an independent solver"),
    "_ref.opt": ("text/plain", "testcase", "Times, step size and tolerance of the reference run"),
    "README.md": ("text/markdown", "document", "What the reference run is, and how near an FMU comes"),
}


def build_references(name: str) -> dict[str, bytes]:
    """The files to ship with the FMU `name`, by path: inputs and computed results."""
    files = compute_results(name).files
    found = {f"{FOLDER}/{path}": text.encode() for path, text in sorted(files.items())}
    return found | {MANIFEST: _list_files(sorted(files))}


def _list_files(paths: Iterable[str]) -> bytes:
    related = []
    for path in paths:
        kind, role, says = next(kind for suffix, kind in _KINDS.items() if path.endswith(suffix))
        related.append(("Related", {"type": kind, "source": path, "role": role, "description": says}))
    about = "Layered Standard providing information on related files included in an FMU."
    return write_manifest("fmiReferences", FOLDER.removeprefix("extra/"), VERSION, about, related)
