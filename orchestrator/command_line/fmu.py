"""tribocosim fmu, and the FMUs that other commands need."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from .completion import complete_component
from .error_report import report_errors, say
from .json_output import Json, print_json
from .without_cache import build_without_cache


def build_fmu(name: str, structure: Mapping[str, int], kind: str = "fmu") -> Path:
    """Build the component's FMU, in Python or `native`, unless it is in the cache. If the cache cannot be
    written, use a folder that lasts as long as this process."""
    from fmus.build import build
    from models.compile.cache_folder import user_cache_directory

    from ..errors import MistakeError, RunError

    make = _build_native_here if kind == "native" else build
    try:
        try:
            return make(name, None, structure)
        except OSError as error:
            return build_without_cache(make, name, structure, error)
    except OSError as error:
        raise RunError(
            f"building the FMU {name}: neither {user_cache_directory()} nor the folder for temporary files "
            f"can be written ({error.strerror}); set TRIBOCOSIM_CACHE to a folder that can"
        ) from None
    except MistakeError:
        raise
    except (ImportError, KeyError, ValueError) as error:
        raise RunError(f"building the FMU {name}: {error.args[-1] if error.args else error}") from None


def check_native(instances: Mapping[str, str]) -> None:
    """MistakeError if native FMUs of these instances (with their components) cannot be built here."""
    from fmus.native.fmu import check_component, check_tools
    from fmus.native.machine_code import NativeBuildError
    from fmus.native.translate import TranslationError

    from ..errors import MistakeError

    try:
        check_tools()
    except NativeBuildError as error:
        remedy = "or take them without --native (participant = 'fmu')"
        raise MistakeError(f"components {', '.join(instances)}: {error}; {remedy}") from None
    for name, component in instances.items():
        try:
            check_component(component)
        except TranslationError as error:
            raise MistakeError(f"components.{name}.component = {error} (participant = 'fmu')") from None


def _build_native_here(name: str, destination: Path | None, structure: Mapping[str, int]) -> Path:
    from fmus.native.fmu import build
    from fmus.native.machine_code import NativeBuildError, this_platform
    from fmus.native.translate import TranslationError

    from ..errors import MistakeError

    try:
        return build(name, destination, structure, [this_platform()])
    except (NativeBuildError, TranslationError) as error:
        raise MistakeError(f"building the native FMU {name}: {error}; or take it without --native") from None


@report_errors
def fmu_build(
    names: Annotated[
        list[str] | None,
        typer.Argument(
            help="Components; your own as module:factory.",
            show_default="all",
            autocompletion=complete_component,
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the .fmu files.")] = Path("."),
    structure: Annotated[
        list[str] | None, typer.Option(help="A structural size, e.g. coil_masses=8; may be repeated.")
    ] = None,
    native: Annotated[
        bool, typer.Option("--native", help="FMUs in machine code, which need no Python: NAME-native.fmu.")
    ] = False,
    platform: Annotated[
        list[str] | None,
        typer.Option(help="With --native: build for it; may be repeated.", show_default="all"),
    ] = None,
    fmi: Annotated[int, typer.Option(help="FMI version 2 or 3 (with --native: NAME-native-fmi3.fmu).")] = 2,
    libpython: Annotated[
        str | None,
        typer.Option(
            help="For hosts that are not Python: the library that the Linux binary then loads by itself, "
            "e.g. libpython3.11.so.1.0."
        ),
    ] = None,
) -> None:
    """Build FMUs."""
    for name in check_options(names, structure, native, platform, fmi, libpython):
        sizes = dict(map(_parse_size, structure)) if structure else None
        with _report_replacement(name, out):
            print(build_file(name, out, sizes, native, platform, fmi, libpython))


def check_options(
    names: list[str] | None,
    structure: list[str] | None,
    native: bool,
    platform: list[str] | None,
    fmi: int,
    libpython: str | None,
) -> Sequence[str]:
    """Check the options; return the components to build."""
    from fmus.build import NAMES
    from fmus.native.fmu import NAMES as NATIVE_NAMES
    from models.catalogue import is_own
    from models.core.system import suggestion

    from ..errors import MistakeError
    from ..scenario.values import build_component

    sizes = dict(map(_parse_size, structure)) if structure else None
    if sizes and len(names or NAMES) > 1:
        raise MistakeError("--structure: name the one component that has these sizes")
    if platform and not native:
        raise MistakeError(
            "--platform: FMUs that run in Python are one file for Linux and Windows alike; add --native to "
            "choose"
        )
    if fmi not in (2, 3):
        raise MistakeError(f"--fmi {fmi}: must be 2 or 3")
    if fmi == 3 and not native:
        raise MistakeError("--fmi 3: FMUs that run in Python are of FMI 2.0 only; add --native")
    if libpython and native:
        raise MistakeError("--libpython: native FMUs need no Python; leave one of them out")
    for name in names or NAMES:
        if name not in NAMES and not is_own(name):
            raise MistakeError(f"no FMU {name!r}; {suggestion(name, NAMES)} (or your own as module:factory)")
        try:
            build_component(name, tuple((sizes or {}).items()))
        except ValueError as error:
            raise MistakeError(f"--structure: {error}" if sizes else str(error)) from None
    return names or (NATIVE_NAMES if native else NAMES)


@contextmanager
def _report_unwritable(out: Path) -> Iterator[None]:
    """MistakeError if the folder cannot be written."""
    from ..errors import MistakeError

    try:
        yield
    except OSError as error:
        raise MistakeError(f"{out}: cannot be written ({error.strerror}); choose another --out") from None


def build_file(
    name: str,
    out: Path,
    sizes: Mapping[str, int] | None,
    native: bool,
    platforms: list[str] | None = None,
    fmi: int = 2,
    libpython: str | None = None,
) -> Path:
    """The FMU's file in the folder `out`; MistakeError if it cannot be built, or written."""
    with _report_unwritable(out):
        if native:
            return _build_native(name, out, sizes, platforms, fmi)
        return _build_python(name, out, sizes, libpython)


def _build_python(name: str, out: Path, sizes: Mapping[str, int] | None, libpython: str | None) -> Path:
    from fmus.build import build

    from ..errors import MistakeError

    try:
        return build(name, out, sizes, libpython)
    except (ImportError, ValueError) as error:
        raise MistakeError(f"--libpython: {error}" if libpython else str(error)) from None


def _build_native(
    name: str, out: Path, sizes: Mapping[str, int] | None, platforms: list[str] | None, fmi: int
) -> Path:
    from fmus.native.fmu import build
    from fmus.native.machine_code import PLATFORMS, NativeBuildError
    from fmus.native.translate import TranslationError
    from models.core.system import suggestion

    from ..errors import MistakeError

    for platform in platforms or ():
        if platform not in PLATFORMS:
            raise MistakeError(f"no platform {platform!r}; {suggestion(platform, PLATFORMS)}")
    try:
        with _show_progress(name) as progress:
            return build(name, out, sizes, tuple(platforms or PLATFORMS), fmi, progress)
    except (ImportError, NativeBuildError, TranslationError) as error:
        raise MistakeError(str(error)) from None


@contextmanager
def _report_replacement(name: str, out: Path) -> Iterator[None]:
    """Report files that were replaced by different ones."""
    before = {file: file.read_bytes() for file in _list_files(name, out)}
    yield
    for file, content in before.items():
        if file.read_bytes() != content:
            say(f"{file}: replaced a different file of this name")


def _list_files(name: str, out: Path) -> Sequence[Path]:
    """The existing FMUs of a component."""
    from models.catalogue import identify

    files = [out] if out.suffix == ".fmu" else out.glob(f"{identify(name)}*.fmu")
    return [file for file in files if file.is_file()]


@contextmanager
def _show_progress(name: str) -> Iterator[Callable[[str], None]]:
    """Yield a function that shows the steps of a native build on a terminal; else one line at the start."""
    from rich.console import Console

    console = Console(stderr=True, highlight=False)
    begun = False
    with console.status(f"native FMU {name}") as status:

        def show_step(step: str) -> None:
            nonlocal begun
            if not begun and not console.is_terminal:
                say(f"building the native FMU {name} (once; up to minutes)")
            begun = True
            status.update(f"native FMU {name}: {step}")

        yield show_step


def _parse_size(text: str) -> tuple[str, int]:
    """Parse NAME=NUMBER."""
    from ..errors import MistakeError

    name, _, number = text.partition("=")
    try:
        return name.strip(), int(number)
    except ValueError:
        raise MistakeError(
            f"--structure {text}: must be NAME=NUMBER with a whole number, e.g. coil_masses=8"
        ) from None


@report_errors
def fmu_validate(
    files: Annotated[list[Path], typer.Argument(help="The .fmu files.")], as_json: Json = False
) -> int:
    """Check FMU files; exit status 1 if something is found."""
    from fmus.fmi.validate import validate

    found = {file: validate(_check_file(file)) for file in files}
    if as_json:
        print_json(found)
    for file, problems in () if as_json else found.items():
        print(f"{file}: {'nothing found' if not problems else ''}")
        for problem in problems:
            print(f"  {problem}")
    return 1 if any(found.values()) else 0


@report_errors
def fmu_cross_check(
    names: Annotated[list[str] | None, typer.Argument(help="Components.", show_default="all")] = None,
    out: Annotated[Path, typer.Option(help="Folder in which fmus/ is made.")] = Path("cross-check"),
    native: Annotated[bool, typer.Option("--native", help="Native FMUs, as for build.")] = False,
    platform: Annotated[
        list[str] | None,
        typer.Option(help="With --native: for it only; may be repeated.", show_default="all"),
    ] = None,
    fmi: Annotated[int, typer.Option(help="FMI version 2 or 3 (with --native).")] = 2,
) -> None:
    """Write FMUs with their reference results in the layout of the FMI Cross-Check project."""
    from fmus.cross_check.files import CrossCheckError
    from fmus.cross_check.layout import lay_out

    from ..errors import MistakeError

    for name in check_options(names, None, native, platform, fmi, None):
        with _report_unwritable(out), tempfile.TemporaryDirectory(prefix="tribocosim-") as folder:
            made = Path(folder)
            file = build_file(name, made, None, native, platform, fmi)
            tool = "tribocosim-native" if native else "tribocosim-python"
            try:
                for place in lay_out(name, file, tool, out):
                    print(place)
            except CrossCheckError as error:
                raise MistakeError(str(error)) from None


@report_errors
def fmu_compare(
    files: Annotated[list[Path], typer.Argument(help="The .fmu files, or folders: all files below.")],
    tolerance: Annotated[
        float | None,
        typer.Option(
            help="Allowed difference over a variable's largest value.", show_default="RelTol of the .opt file"
        ),
    ] = None,
) -> int:
    """Run FMUs and compare with their reference results, inside the file or beside it; exit status 1 if one
    differs, 2 if one has no reference or does not run."""
    from fmus.cross_check.apart import compare_in_process
    from fmus.cross_check.files import CrossCheckError

    from ..errors import MistakeError

    if tolerance is not None and not tolerance > 0.0:
        raise MistakeError(f"--tolerance {tolerance:g}: must be > 0")
    paths: list[Path] = []
    for file in files:
        below = sorted(file.rglob("*.fmu")) if file.is_dir() else [_check_file(file)]
        if not below:
            raise MistakeError(f"{file}: has no .fmu files")
        paths += below
    status = 0
    for path, found in compare_in_process(paths, tolerance):
        if isinstance(found, CrossCheckError):
            say(str(found))
            status = 2
            continue
        print(path, *found, sep="\n", flush=True)
        if not all(comparison.agrees for comparison in found):
            status = status or 1
    return status


@report_errors
def fmu_info(file: Annotated[Path, typer.Argument(help="The .fmu file.")], as_json: Json = False) -> None:
    """Show what an FMU is and its variables."""
    from fmus.fmi.archive import FmuFileError
    from fmus.fmi.validate import info

    from ..errors import MistakeError

    try:
        found = info(_check_file(file))
    except FmuFileError as error:
        raise MistakeError(str(error)) from None
    if as_json:
        print_json(found)
    else:
        print(found)


def _check_file(file: Path) -> Path:
    from ..errors import MistakeError

    if file.is_dir():
        raise MistakeError(f"{file}: is a folder; give its files: {file / '*.fmu'}")
    if not file.is_file():
        raise MistakeError(f"{file}: no such file; tribocosim fmu build makes the FMUs")
    return file
