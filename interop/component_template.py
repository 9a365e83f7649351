"""Writes fmus/native/runtime/component.bin, what stands around a module in a component of WebAssembly.

    python -m interop.component_template DRAFT PACKAGES

DRAFT is a folder with FMI-LS-WASM (github.com/modelica/fmi-ls-wasm), of which the interface definitions in
`wit` are read (2-clause BSD licence); PACKAGES one in which npm has installed @bytecodealliance/jco. Whoever
follows a change of the draft runs it.
"""

import subprocess
import sys
from pathlib import Path

from fmus.native.component import PLACE, TEMPLATE
from fmus.native.machine_code import WEBASSEMBLY, shared_library
from fmus.native.tables import tables
from models.catalogue import find_factory
from models.compile.temporary import TemporaryFolder
from models.native.differentiate import differentiate
from models.native.entries import smooth
from models.native.translate import translate

_WORLD, _PACKAGE = "co-simulation-fmu", "package fmi:fmi3@3.0.0;"
_CUSTOM, _MODULE = 0, 1  # kinds of sections
_PROGRAM = f"""
import {{ readFileSync, writeFileSync }} from "node:fs";
import {{ componentEmbed, componentNew }} from "@bytecodealliance/jco";
const given = {{ binary: readFileSync("module.wasm"), witSource: readFileSync("draft.wit", "utf8") }};
const none = {{ dummy: false, features: {{ tag: "list", val: [] }}, metadata: [] }};
const embedded = await componentEmbed({{ ...given, ...none, world: "{_WORLD}", stringEncoding: "utf8" }});
writeFileSync("component.wasm", await componentNew(embedded, []));
"""


def make_module() -> bytes:
    """One with all functions of the world."""
    name, component = "falling_mass", find_factory("falling_mass")()
    plain = translate(name, {})
    kernels = [plain, differentiate(plain, smooth(component))]
    return shared_library(WEBASSEMBLY, kernels, tables(component, name, "", "", 3), name, 3)


def make_template(module: bytes, draft: Path, packages: Path) -> bytes:
    """What stands around this module in its component, with an empty one in its place."""
    texts = [path.read_text("utf-8") for path in sorted((draft / "wit").glob("*.wit"))]
    with TemporaryFolder(packages) as here:
        (here / "module.wasm").write_bytes(module)
        (here / "draft.wit").write_text(_PACKAGE + "".join(texts).replace(_PACKAGE, ""), "utf-8")
        (here / "make.mjs").write_text(_PROGRAM, "utf-8")
        subprocess.run(["node", "make.mjs"], cwd=here, check=True)
        return _strip((here / "component.wasm").read_bytes(), len(module))


def _strip(component: bytes, least: int) -> bytes:
    """Without names; the module is the first section of its kind that is not smaller."""
    kept, at = component[:8], 8
    while at < len(component):
        size, begin = _read_number(component, at + 1)
        if component[at] == _MODULE and size >= least:
            kept += PLACE
        elif component[at] != _CUSTOM:
            kept += component[at : begin + size]
        at = begin + size
    return kept


def _read_number(data: bytes, at: int) -> tuple[int, int]:
    """LEB128, and where it ends."""
    byte, value, shift = data[at], data[at] & 0x7F, 7
    while byte & 0x80:
        at, byte = at + 1, data[at + 1]
        value, shift = value | (byte & 0x7F) << shift, shift + 7
    return value, at + 1


if __name__ == "__main__":
    TEMPLATE.write_bytes(make_template(make_module(), *map(Path, sys.argv[1:])))
