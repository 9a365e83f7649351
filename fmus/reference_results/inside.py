"""Reference results inside an FMU, as the layered standard FMI-LS-REF (1.0.0-alpha.1) places related files.

`extra/` is for additional data in FMI 2.0 (since 2.0.2) and 3.0; tools that do not know the standard skip it.
"""

from collections.abc import Iterable
from xml.sax.saxutils import quoteattr

from .results import compute_results

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
MANIFEST = f"{FOLDER}/fmi-ls-manifest.xml"

_NAMESPACE = "http://fmi-standard.org/fmi-ls-manifest"
_HEAD = f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiReferences xmlns:fmi-ls="{_NAMESPACE}"
    fmi-ls:fmi-ls-name="org.fmi-standard.fmi-ls-ref"
    fmi-ls:fmi-ls-version="1.0.0-alpha.1"
    fmi-ls:fmi-ls-description="Layered Standard providing information on related files included in an FMU.">
"""
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
    return found | {MANIFEST: _manifest(sorted(files)).encode()}


def _manifest(paths: Iterable[str]) -> str:
    lines = []
    for path in paths:
        kind, role, says = next(kind for suffix, kind in _KINDS.items() if path.endswith(suffix))
        attributes = f'source={quoteattr(path)} role="{role}" description={quoteattr(says)}'
        lines.append(f'    <Related type="{kind}" {attributes}/>\n')
    return _HEAD + "".join(lines) + "</fmiReferences>\n"
