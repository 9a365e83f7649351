"""Builds native FMUs: `build("camshaft")` gives the path of the packaged file."""

import uuid
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from importlib import metadata
from pathlib import Path

from fmus.fmi.archive import compute_digest
from models.catalogue import find_factory, identify, is_own
from models.core.component import Component
from models.native.differentiate import differentiate
from models.native.entries import smooth
from models.native.translate import TranslationError, translate

from .. import build as python_build
from .. import declared
from ..extras import tell_install
from ..fmi import description3
from ..fmi.description import EXCHANGE, GUID_PLACE, NATIVE, model_description
from ..fmi.layered import COMPONENT_MANIFEST, describe_component, describe_tables
from ..sources import collect_sources
from .component import wrap
from .machine_code import (
    CHOICES,
    FMI_HEADERS,
    PLATFORMS,
    RUNTIME,
    WEBASSEMBLY,
    NativeBuildError,
    library_licenses,
    shared_library,
    this_platform,
)
from .tables import tables

# What makes machine code, and the constants in it; other versions may make others.
_TOOLS = ("numba", "llvmlite", "ziglang", "fmpy", "numpy", "scipy")


def build(
    name: str,
    destination: Path | None = None,
    structure: Mapping[str, int] | None = None,
    platforms: Sequence[str] = tuple(PLATFORMS),
    fmi: int = 2,
    progress: Callable[[str], None] = lambda step: None,
) -> Path:
    """Build the native FMU `name` for these platforms and this version of FMI, 2 or 3, and return its path.

    Otherwise as the build of the FMU that runs in Python; a file in a folder is called `name`-native.fmu or
    `name`-native-fmi3.fmu. `progress` is called at the beginning of each step (seconds to minutes).
    TranslationError for kernels and sizes that need Python, NativeBuildError without the tools.
    """
    sizes, component = python_build.resolve_component(name, structure)
    check_component(name)
    label = f"{identify(name)}-native" if fmi == 2 else f"{identify(name)}-native-fmi{fmi}"

    def pack() -> bytes:
        return python_build.pack_files(collect_files(name, component, sizes, platforms, fmi, progress))

    choice = f"{sizes} {sorted(platforms)} {_versions()} {python_build.describe_own(name)}"
    return python_build.provide(
        label, choice, lambda: _digest_inputs(name, sizes, platforms), pack, destination,
        lambda: python_build.compute_references(name, structure),
    )  # fmt: skip


def collect_files(
    name: str,
    component: Component,
    sizes: Mapping[str, int],
    platforms: Sequence[str],
    fmi: int = 2,
    progress: Callable[[str], None] = lambda step: None,
) -> dict[str, bytes]:
    """The FMU's files by path."""
    progress("its equations and their derivatives")
    kernels = _kernels(name, tuple(sorted(sizes.items())), tuple(smooth(component)))
    called = identify(name)
    made_by = python_build.origin("LLVM and zig")
    experiment = declared.experiment(name)
    if fmi == 2:
        xml = model_description(component, called, experiment, made_by, NATIVE, EXCHANGE)
    else:
        xml = description3.model_description(component, called, experiment, made_by)
    unnamed = {
        **tables(component, called, "", "", fmi),
        "kernels.ll": "".join(kernels),
        "modelDescription.xml": xml,
    }
    digest = compute_digest({**_runtime(), **{path: text.encode() for path, text in unnamed.items()}})
    token = f"{{{uuid.UUID(digest[:32])}}}"
    named = tables(component, called, digest[:16], token, fmi)
    files = python_build.documents(name, component)
    if fmi == 3:
        files["terminalsAndIcons/icon.png"] = files.pop("model.png")
        files |= describe_tables(component)
        if WEBASSEMBLY.fmi3 in platforms:
            files[COMPONENT_MANIFEST] = describe_component()
            files |= {
                f"documentation/licenses/{part}.txt": text.encode()
                for part, text in library_licenses().items()
            }
    files["modelDescription.xml"] = xml.replace(GUID_PLACE, token).encode()
    for count, platform in enumerate(map(CHOICES.__getitem__, platforms), 1):
        progress(f"machine code for {platform.fmi3} ({count} of {len(platforms)})")
        folder = platform.fmi2 if fmi == 2 else platform.fmi3
        library = shared_library(platform, kernels, named, called, fmi)
        if platform == WEBASSEMBLY:
            library = wrap(library)
        files[f"binaries/{folder}/{called}{platform.suffix}"] = library
    return files


@cache
def _kernels(name: str, sizes: tuple[tuple[str, int], ...], smooth_ones: tuple[str, ...]) -> tuple[str, str]:
    """Kernels and their tangents, for both versions of FMI."""
    plain = translate(name, dict(sizes))
    return plain, differentiate(plain, smooth_ones)


def _digest_inputs(name: str, sizes: Mapping[str, int], platforms: Sequence[str]) -> str:
    """The digest of all that the FMU is made of."""
    package, _ = collect_sources(find_factory(name))
    here = Path(__file__).parent
    root = here.parents[1]
    makers = (*here.parent.rglob("*.py"), *(root / "models" / "native").glob("*.py"))
    files = {str(path.relative_to(root)): path.read_bytes() for path in makers}
    documents: dict[str, bytes] = {}
    if not is_own(name):
        folder = here.parent / name
        documents = {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    own = python_build.describe_own(name)
    said = f"{package} {sorted(sizes.items())} {sorted(platforms)} {_versions()} {own}"
    return compute_digest(files | documents | dict(_runtime()) | {"said": said.encode()})


def _versions() -> dict[str, str]:
    return {tool: _version(tool) for tool in (*_TOOLS, "tribocosim")}


def check_tools() -> None:
    """NativeBuildError where nothing can be built: another platform, or a package that is missing."""
    this_platform()
    for tool in _TOOLS:
        _version(tool)


def check_component(name: str) -> None:
    """TranslationError for a component whose FMU needs Python."""
    if reason := declared.explain_no_native(name):
        raise TranslationError(f"{name}: {reason}")


# The components of which there are native FMUs.
NAMES: tuple[str, ...] = tuple(name for name in python_build.NAMES if not declared.explain_no_native(name))


def _version(tool: str) -> str:
    try:
        return metadata.version(tool)
    except metadata.PackageNotFoundError:
        raise NativeBuildError(f"native code needs the package {tool}: {tell_install('native')}") from None


@cache
def _runtime() -> Mapping[str, bytes]:
    """What is compiled besides the component: the runtime, and the standard's headers."""
    places = (*RUNTIME.iterdir(), *FMI_HEADERS.glob("*.h"))
    return {f"runtime/{path.name}": path.read_bytes() for path in places}
