"""Reference results inside an FMU, as the layered standard FMI-LS-REF (1.0.0-alpha.1) places related files.

`extra/` is for additional data in FMI 2.0 (since 2.0.2) and 3.0; tools that do not know the standard skip it.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from xml.sax.saxutils import quoteattr

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
MANIFEST = f"{FOLDER}/fmi-ls-manifest.xml"

# What the FMU's documentation says of it.
REFERENCE_NOTE = f"""
## Reference results

Inputs and results of a run, found by another solver, are in `{FOLDER}/` of this file; the `README.md` there
says what happens in it and within what an FMU agrees. `tribocosim fmu compare` runs the FMU and compares.
"""

_NAMESPACE = "http://fmi-standard.org/fmi-ls-manifest"
_HEAD = f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiReferences xmlns:fmi-ls="{_NAMESPACE}"
    fmi-ls:fmi-ls-name="org.fmi-standard.fmi-ls-ref"
    fmi-ls:fmi-ls-version="1.0.0-alpha.1"
    fmi-ls:fmi-ls-description="Layered Standard providing information on related files included in an FMU.">
"""
_KINDS = {
    "_in.csv": ("text/csv", "testcase", "Inputs of the reference run, FMI Cross-Check layout"),
    "_ref.csv": ("text/csv", "result", "Reference results of an independent solver, FMI Cross-Check layout"),
    "_ref.opt": ("text/plain", "testcase", "Times, step size and tolerance of the reference run"),
    "README.md": ("text/markdown", "document", "What the reference run is, and how near an FMU comes"),
}


def reference_folder(name: str) -> Path:
    """Where the reference files of the FMU `name` are kept."""
    return Path(__file__).parent.parent / name / "reference"


def references(name: str, exchange: bool) -> dict[str, bytes]:
    """The files to ship with the FMU `name`, by path; none where it has no reference.

    `exchange`: with what model exchange needs besides.
    """
    folder = reference_folder(name)
    found = {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and (exchange or path.parent == folder)
    }
    if not found:
        return {}
    manifest = _manifest(found)
    return {f"{FOLDER}/{path}": content for path, content in found.items()} | {MANIFEST: manifest.encode()}


def _manifest(paths: Mapping[str, bytes]) -> str:
    lines = []
    for path in paths:
        kind, role, says = next(kind for suffix, kind in _KINDS.items() if path.endswith(suffix))
        says += ", model exchange" if path.startswith("me/") else ""
        told = f'source={quoteattr(path)} role="{role}" description={quoteattr(says)}'
        lines.append(f'    <Related type="{kind}" {told}/>\n')
    return _HEAD + "".join(lines) + "</fmiReferences>\n"
