"""The source files in an FMU: a component's module, its imports, and the slave."""

import ast
import functools
import inspect
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pythonfmu

import models
from fmus.fmi.archive import compute_digest
from models.catalogue import find_factory

# Packages that the code in an FMU may import besides the standard library.
RUN_TIME = {"numpy", "numba", "llvmlite"}

# Modules of users' own components are called so where a file has several components, with a digest of each.
COMPANION = "own_part_"

# The folder of `models`, inside an FMU, with the module of a user's own component.
OWN = "own"

_SLAVE = ("host.py", "variable_layout.py", "slave.py")


def collect_sources(factory: Callable[..., Any]) -> tuple[str, dict[str, bytes]]:
    """The package with the code of `factory`'s component: its name, and its files by path.

    The name has the digest of the content, so that two versions in one process do not share modules.
    """
    root = Path(models.__file__).parent
    files: dict[str, bytes] = {}
    begin = [root / "core" / "bonds.py"]
    if _is_ours(factory):
        begin.append(root.parent / Path(*factory.__module__.split(".")).with_suffix(".py"))
    else:
        module = Path(inspect.getfile(inspect.unwrap(factory)))
        waiting = {module.name: module}
        while waiting:
            name, file = waiting.popitem()
            text, needed, companions = _relocate(file, root)
            files[f"models/{OWN}/{name}"] = text.encode()
            begin += needed
            waiting |= {f"{one}.py": Path(inspect.getfile(sys.modules[one])) for one in companions}
        files[f"models/{OWN}/__init__.py"] = b""
    imported = {path for one in begin for path in find_imports(one, root)}
    files |= {f"models/{path.relative_to(root).as_posix()}": path.read_bytes() for path in imported}
    files |= {name: (Path(__file__).parent / name).read_bytes() for name in _SLAVE}
    base = Path(pythonfmu.__file__).parent
    files |= {
        f"pythonfmu/{path.name}": path.read_bytes()
        for path in find_imports(base / "fmi2slave.py", base, False)
    }
    # The original imports the builder, which a slave does not need.
    files["pythonfmu/__init__.py"] = b""
    files["__init__.py"] = (
        b'"""Code of an FMU made by tribocosim; the name has the digest of the content."""\n'
    )
    package = f"tribocosim_{compute_digest(files)[:16]}"
    return package, {f"{package}/{name}": content for name, content in sorted(files.items())}


def name_module(factory: Callable[..., Any]) -> str:
    """The module of the factory inside an FMU's package."""
    if _is_ours(factory):
        return factory.__module__
    return f"models.{OWN}.{Path(inspect.getfile(inspect.unwrap(factory))).stem}"


def name_companion(name: str) -> str:
    """The module from which a file with several components imports this one; a user's own is known by it here
    and in the FMU."""
    factory = find_factory(name)
    if _is_ours(factory):
        return factory.__module__
    module = sys.modules[factory.__module__]
    file = Path(inspect.getfile(module))
    companion = f"{COMPANION}{compute_digest({file.name: file.read_bytes()})[:16]}"
    sys.modules[companion] = module  # the file of an earlier one of this content may be gone
    return companion


def _is_ours(factory: Callable[..., Any]) -> bool:
    """Whether it is in `models`, not in a user's own file."""
    return factory.__module__.startswith("models.")


def _relocate(module: Path, root: Path) -> tuple[str, list[Path], list[str]]:
    """The text of a user's module as one of the folder OWN of `models`, the files of ours and the companions
    that it imports.

    ImportError for imports that an FMU cannot have.
    """
    lines = module.read_text("utf-8").splitlines(keepends=True)
    found: list[Path] = []
    companions: list[str] = []
    for node in ast.walk(ast.parse("".join(lines), str(module))):
        if isinstance(node, ast.ImportFrom) and not node.level and f"{node.module}.".startswith("models."):
            base = root.parent.joinpath(*str(node.module).split("."))
            for place in (base, *(base / imported.name for imported in node.names)):
                found += _files(place)
            line = lines[node.lineno - 1]
            lines[node.lineno - 1] = re.sub(r"from\s+models(\.|\s+)", r"from ..", line, count=1)
        elif isinstance(node, ast.ImportFrom) and str(node.module).startswith(COMPANION):
            companions.append(str(node.module))
            lines[node.lineno - 1] = lines[node.lineno - 1].replace("from ", "from .", 1)
        elif isinstance(node, ast.ImportFrom) and node.level:
            raise ImportError(f"{module.name}: imports from {'.' * node.level}: put all of it into one file")
        elif isinstance(node, (ast.Import, ast.ImportFrom)):
            _refuse_foreign(node, module.name)
    return "".join(lines), found, companions


def find_imports(module: Path, root: Path, packages: bool = True) -> list[Path]:
    """The files below `root` that `module` imports, itself included; with `packages` also their packages'
    `__init__.py`.

    ImportError if one of them imports a package that FMUs may not import.
    """
    found: set[Path] = set()
    waiting = [module]
    while waiting:
        file = waiting.pop()
        if file in found:
            continue
        found.add(file)
        waiting += _imports(file, root)
        if packages:
            inits = (folder / "__init__.py" for folder in file.parents if folder.is_relative_to(root))
            waiting += [init for init in inits if init.is_file()]
    return sorted(found)


@functools.cache
def _imports(file: Path, root: Path) -> tuple[Path, ...]:
    """The imports of one file. Cached, because components share most files."""
    found: list[Path] = []
    for node in ast.walk(ast.parse(file.read_bytes(), str(file))):
        if isinstance(node, ast.ImportFrom) and node.level:
            folder = file.parents[node.level - 1]
            base = folder.joinpath(*node.module.split(".")) if node.module else folder
            for place in (base, *(base / imported.name for imported in node.names)):
                found += _files(place)
        elif isinstance(node, (ast.Import, ast.ImportFrom)):
            _refuse_foreign(node, file.relative_to(root.parent).as_posix())
    return tuple(found)


def _files(base: Path) -> list[Path]:
    return [path for path in (base.with_suffix(".py"), base / "__init__.py") if path.is_file()]


def _refuse_foreign(node: ast.Import | ast.ImportFrom, place: str) -> None:
    names = [node.module] if isinstance(node, ast.ImportFrom) else [name.name for name in node.names]
    for package in (str(name).partition(".")[0] for name in names):
        if package not in RUN_TIME and package not in sys.stdlib_module_names:
            raise ImportError(
                f"{place} imports {package}: an FMU may import {', '.join(sorted(RUN_TIME))}, the standard "
                "library, and from models"
            )
