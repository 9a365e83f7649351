"""Builds FMUs: `build("valve_spring")` gives the path of the packaged file.

The same sources give the same bytes. `sources` collects the code, `description` and `documentation` write
the texts. A build does not run the code that it packs.
"""

import functools
import importlib
import inspect
import io
import os
import tempfile
import uuid
import zipfile
from collections.abc import Callable, Mapping
from importlib import metadata
from pathlib import Path

import pythonfmu

from fmus.fmi.archive import compute_digest
from fmus.fmi.origin import note_built
from models.catalogue import CATALOGUE, find_factory, identify, is_own
from models.core.component import Component

from .declared import experiment
from .documentation import MARKER, render_page
from .fmi.description import GUID_PLACE, PYTHON, Origin, model_description
from .fmu_cache import cache_path, recall, tidy, use_cached
from .sources import collect_sources, name_module
from .stimuli import find_stimulus

HERE = Path(__file__).parent

# Every component that has a folder here.
NAMES: tuple[str, ...] = tuple(name for name in CATALOGUE if (HERE / name / "README.md").is_file())

# The earliest time that zip files allow. A fixed time makes equal content equal bytes.
_EPOCH = (1980, 1, 1, 0, 0, 0)

_SCRIPT = '''"""The slave of {name}; see the package for the code."""

import ctypes
import sys

try:
    import numpy
except ImportError:
    # The C layer keeps silent about why an instance cannot be made.
    print(f"{name}: Python in {{sys.prefix}} has no numpy; install it there", file=sys.stderr)
    raise

from {package}.{module} import {factory} as make_component
from {package}.models.core.bonds import counts_energies
from {package}.models.core.integrator import FAILURES
from {package}.slave import slave_class

# The C layer of pythonfmu runs this file anew for every instance, and each time gives back a reference
# to this namespace that it was only lent.
ctypes.pythonapi.Py_IncRef(ctypes.py_object(globals()))

try:
    {name} = globals()["{name}"]
except KeyError:
    make_component = counts_energies(make_component)
    {name} = slave_class(make_component(**{structure!r}), "{name}", "{package}", FAILURES)
'''


def build(
    name: str,
    destination: Path | None = None,
    structure: Mapping[str, int] | None = None,
    references: bool = True,
) -> Path:
    """Build the FMU `name` and return its path.

    `destination` is a file (*.fmu) or a folder. Without it the file goes to the user's cache folder, is built
    only if it is missing there, is deleted after some weeks without use, and has no `references`, results
    that take seconds to compute. `structure` gives structural sizes, such as {"coil_masses": 8}; the
    component's own are the default. Existing files are replaced atomically.
    KeyError for an unknown name; ValueError for sizes that the component refuses.
    """
    files = functools.cache(lambda: collect_files(name, structure))
    choice = f"{structure} {metadata.version('pythonfmu')} {describe_own(name)}"
    return provide(
        identify(name), choice, lambda: compute_digest(files()), lambda: pack_files(files()), destination,
        lambda: compute_references(name, structure) if references else {},
    )  # fmt: skip


def provide(
    label: str,
    choice: str,
    digest: Callable[[], str],
    pack: Callable[[], bytes],
    destination: Path | None,
    add: Callable[[], Mapping[str, bytes]],
) -> Path:
    """The FMU called `label` in the user's cache folder, or at the `destination`, where it has what `add()`
    gives.

    `choice` has everything that it depends on besides the sources, `digest()` identifies what it is made of;
    `pack()` makes its bytes. OSError without a destination and a cache folder that can be used.
    """
    pack = functools.cache(pack)

    def find() -> Path:
        target = cache_path(label, digest())
        if not use_cached(target):
            write_fmu(pack(), label, target)
            tidy(target.parent)
        return target

    try:
        target = recall(label, choice, find)
        if destination is None:
            return target
        content = target.read_bytes()
    except OSError:  # the cache cannot be used
        if destination is None:
            raise
        content = pack()
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        files = {path: archive.read(path) for path in archive.namelist()}
    return write_fmu(pack_files(files | dict(add())), label, Path(destination))


def write_fmu(content: bytes, name: str, destination: Path) -> Path:
    """Write the file `destination`, or `name`.fmu in that folder, atomically; return its path."""
    target = destination if destination.suffix == ".fmu" else destination / f"{name}.fmu"
    target.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(prefix=f".{name}-", suffix=".part", dir=target.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(temporary, 0o644)  # mkstemp makes it readable for its owner only
        os.replace(temporary, target)
        note_built(content)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
    return target


def pack_files(files: Mapping[str, bytes]) -> bytes:
    """The bytes of an FMU with these files."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(files, key=lambda path: (path != "modelDescription.xml", path)):
            entry = zipfile.ZipInfo(path, _EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 3  # Unix, wherever it is built
            entry.external_attr = 0o100644 << 16
            archive.writestr(entry, files[path], compresslevel=9)
    return buffer.getvalue()


def collect_files(name: str, structure: Mapping[str, int] | None = None) -> dict[str, bytes]:
    """The FMU's files by path."""
    sizes, component = resolve_component(name, structure)
    factory, called = find_factory(name), identify(name)
    package, code = collect_sources(factory)
    files = {f"resources/{path}": content for path, content in code.items()}
    script = _SCRIPT.format(
        name=called, package=package, module=name_module(factory), factory=factory.__name__, structure=sizes
    ).encode()
    stem = f"{called}_{compute_digest({package: script})[:16]}"
    files[f"resources/{stem}.py"] = script
    files["resources/slavemodule.txt"] = stem.encode()
    licence = metadata.distribution("pythonfmu").read_text("licenses/LICENSE") or ""
    files["documentation/licenses/pythonfmu.txt"] = licence.encode()
    files |= collect_binaries(called) | documents(name, component)
    made_by = origin(f"PythonFMU {pythonfmu.__version__}")
    xml = model_description(component, called, experiment(name), made_by, PYTHON)
    guid = uuid.UUID(compute_digest(files | {"modelDescription.xml": xml.encode()})[:32])
    files["modelDescription.xml"] = xml.replace(GUID_PLACE, f"{{{guid}}}").encode()
    return files


def resolve_component(name: str, structure: Mapping[str, int] | None) -> tuple[dict[str, int], Component]:
    """The sizes of an FMU, and the component with them; KeyError and ValueError as `build`."""
    if name not in NAMES and not is_own(name):
        raise KeyError(f"FMU {name!r}: must be one of {', '.join(NAMES)}")
    sizes = {key: int(value) for key, value in sorted((structure or {}).items())}
    try:
        return sizes, find_factory(name)(**sizes)
    except (TypeError, ValueError) as error:
        place = f"structure of {name}" if sizes else identify(name)
        raise ValueError(f"{place}: {error}") from None


def compute_references(name: str, structure: Mapping[str, int] | None) -> dict[str, bytes]:
    """The FMU's reference results by path; none for a component without a stimulus or of other sizes."""
    sizes = resolve_component(name, structure)[1].structure
    if is_own(name) or sizes != CATALOGUE[name]().structure or find_stimulus(name) is None:
        return {}
    from .reference_results.inside import build_references  # its solvers take long to import

    return build_references(name)


def describe_own(name: str) -> str:
    """Code and icon of a user's own component by their digest, and its default experiment; "" for ours."""
    if not is_own(name):
        return ""
    files = locate_own(name), find_icon(name)
    return f"{compute_digest({file.name: file.read_bytes() for file in files})} {experiment(name)}"


def locate_own(name: str) -> Path:
    """The file of a user's own component, whose factory may be decorated."""
    return Path(inspect.getfile(inspect.unwrap(find_factory(name))))


def find_icon(name: str) -> Path:
    """The image beside a user's own component, or in our folder of it; else the icon of all."""
    icon = locate_own(name).with_suffix(".png") if is_own(name) else HERE / name / "model.png"
    return icon if icon.is_file() else HERE / "model.png"


def origin(tool: str) -> Origin:
    """Author, licence and version, from the metadata of this distribution; `tool` packed the FMUs."""
    version = metadata.version("tribocosim")
    return Origin(
        author="tribocosim developers",
        copyright=_license().splitlines()[2],
        license="MIT",
        version=version,
        tool=f"tribocosim {version} with {tool}",
    )


def _license() -> str:
    """The licence: beside the sources, or in the installed distribution."""
    beside = HERE.parent / "LICENSE"
    if beside.is_file():
        return beside.read_text()
    return metadata.distribution("tribocosim").read_text("licenses/LICENSE") or ""


def collect_binaries(name: str) -> dict[str, bytes]:
    """pythonfmu's C layer for each of its platforms."""
    folder = Path(pythonfmu.__file__).parent / "resources" / "binaries"
    found = sorted(path for path in folder.rglob("*") if path.suffix in (".so", ".dll", ".dylib"))
    return {f"binaries/{path.parent.name}/{name}{path.suffix}": path.read_bytes() for path in found}


def documents(name: str, component: Component) -> dict[str, bytes]:
    """The documents and the icon of an FMU."""
    if is_own(name):
        about = inspect.getdoc(importlib.import_module(find_factory(name).__module__)) or ""
        readme = f"# {identify(name)}\n\n```\n{about}\n```\n\n## Variables\n\n{MARKER}\n"
    else:
        readme = (HERE / name / "README.md").read_text("utf-8")
    return {
        "documentation/index.html": render_page(readme, component).encode(),
        "documentation/licenses/LICENSE": _license().encode(),
        "model.png": find_icon(name).read_bytes(),
    }
