"""Python files of a scenario's components, from which FMUs are built: one part, or all as one component."""

import builtins
import inspect
import keyword
import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import astuple, dataclass, field
from pathlib import Path
from typing import Any

from models.catalogue import find_factory, identify
from models.core.system import Instance
from models.core.transformed import Transformation

from .declared import explain_no_native
from .fmi.description import Experiment
from .sources import COMPANION, name_companion

_IMPORTS = ["from models.core.bonds import counts_energies", "from models.core.system import Instance"]

# Names that the file made here, or the script of an FMU in Python, needs for something else.
_TAKEN = {
    *keyword.kwlist,
    *dir(builtins),
    *("compose", "with_values", "counts_energies", "Instance", "transform", "Transformation"),
    *("sys", "ctypes", "numpy", "slave_class", "FAILURES"),
}

_FILE = '''"""{about}"""

{imports}


def {name}():
    return {expression}
'''


@dataclass(frozen=True)
class Part:
    """An instance of a scenario, the name of its component in the catalogue, and what its inputs are of their
    sources."""

    catalogue_name: str
    instance: Instance
    transformed: Mapping[str, Transformation] = field(default_factory=dict)


def write_part(folder: Path, name: str, about: str, part: Part, experiment: Experiment) -> str:
    """A file whose component is that of the part, with the instance's values as defaults.

    Returns the name by which `build` knows it.
    """
    imports = ["from models.core.composite import with_values", *_IMPORTS, *_import([part], folder)]
    own = _write(folder, name, about, imports, f"with_values({_show(part)})")
    _declare(own, EXPERIMENT=astuple(experiment), PYTHON_ONLY=explain_no_native(part.catalogue_name))
    return own


def write_train(
    folder: Path,
    name: str,
    about: str,
    parts: Mapping[str, Part],
    connections: Sequence[tuple[str, str]],
    experiment: Experiment,
) -> str:
    """A file whose component is all parts, connected (see `composite.compose`)."""
    imports = ["from models.core.composite import compose", *_IMPORTS, *_import(parts.values(), folder)]
    if any(part.transformed for part in parts.values()):
        imports.append("from models.core.transformed import Transformation, transform")
    shown = "".join(f"            {key!r}: {_show(part)},\n" for key, part in parts.items())
    lines = "".join(f"            {pair!r},\n" for pair in connections)
    expression = (
        f"compose(\n        {name!r},\n        {about!r},\n        {{\n{shown}        }},\n"
        f"        [\n{lines}        ],\n    )"
    )
    own = _write(folder, name, about, imports, expression)
    reasons = [explain_no_native(part.catalogue_name) for part in parts.values()]
    _declare(own, EXPERIMENT=astuple(experiment), PYTHON_ONLY=next(filter(None, reasons), ""))
    return own


def to_identifier(name: str) -> str:
    """A name for a file, a function and an FMU, from any text."""
    text = "".join(letter if letter.isascii() else f"u{ord(letter):x}" for letter in name)
    text = re.sub(r"\W", "_", text)
    taken = text in _TAKEN or text.startswith(("make_", "__"))
    return f"_{text}" if taken or not text[:1].isidentifier() else text


def _import(parts: Iterable[Part], folder: Path) -> list[str]:
    """A line for each component; a user's own is beside the file, for processes that only know the folder."""
    names = sorted({part.catalogue_name for part in parts})
    for name in names:
        if (module := name_companion(name)).startswith(COMPANION):
            source = inspect.getfile(sys.modules[find_factory(name).__module__])
            (folder / f"{module}.py").write_bytes(Path(source).read_bytes())
    return [
        f"from {name_companion(name)} import {find_factory(name).__name__} as {_name_factory(name)}"
        for name in names
    ]


def _name_factory(name: str) -> str:
    """The name of a component's factory in the file; own ones may have names of others."""
    module = name_companion(name)
    return f"make_{identify(name)}" + (f"_of_{module}" if module.startswith(COMPANION) else "")


def _show(part: Part) -> str:
    instance = part.instance
    sizes = ", ".join(f"{key}={value}" for key, value in sorted(instance.component.structure.items()))
    given = (instance.parameters, instance.start, instance.inputs)
    values = ", ".join(repr({name: float(value) for name, value in one.items()}) for one in given)
    factory = f"counts_energies({_name_factory(part.catalogue_name)})"
    shown = f"Instance({factory}({sizes}), {values})"
    if not part.transformed:
        return shown
    inputs = ", ".join(f"{name!r}: {one!r}" for name, one in part.transformed.items())
    return f"transform({shown}, {{{inputs}}})"


def _write(folder: Path, name: str, about: str, imports: Sequence[str], expression: str) -> str:
    file = folder / f"{name}.py"
    about = about.replace("\\", "/").replace('"', "'")
    text = _FILE.format(about=about, imports="\n".join(imports), name=name, expression=expression)
    file.write_text(text, "utf-8")
    return f"{file}:{name}"


def _declare(own: str, **constants: Any) -> None:
    """What the FMU's description says beside the component, as constants of the module that is loaded."""
    module = sys.modules[find_factory(own).__module__]
    for name, value in constants.items():
        setattr(module, name, value)
