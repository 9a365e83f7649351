"""FMU files: of the catalogue's components and of a user's own."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from models.core.system import suggestion
from orchestrator.errors import MistakeError, Option
from orchestrator.store.output_folder import writing

from .arguments import checks_arguments

if TYPE_CHECKING:
    from fmus.fmi.validate import Findings, FmuInfo
    from fmus.reference_results.compare import Comparison


NATIVE = Option("native", True)


@dataclass(frozen=True)
class FmuOptions:
    """What kind of FMU is built; None where the default is meant.

    `structure` has sizes such as {"coil_masses": 8}. A `native` FMU is machine code for the `platforms`, of
    `fmi` 2 or 3; others run in Python, of FMI 2.
    """

    structure: Mapping[str, int] | None = None
    native: bool = False
    platforms: Sequence[str] | None = None
    fmi: int = 2


@checks_arguments
def build_fmu(
    component: str,
    out: str | Path = ".",
    *,
    structure: Mapping[str, int] | None = None,
    native: bool = False,
    platforms: Sequence[str] = (),
    fmi: int = 2,
    progress: Callable[[str], None] = lambda step: None,
) -> Path:
    """Build an FMU in the folder `out`, as the command `fmu build` does; the path of its file.

    `component` is a name of the catalogue, or a user's own as "module:factory". `structure` has sizes such as
    {"coil_masses": 8}. A `native` FMU is machine code for the `platforms` (default: all but wasm32-wasip2),
    of `fmi` 2 or 3; others run in Python, of FMI 2. `progress` is told each step of a native build.
    MistakeError says what is wrong.
    """
    options = FmuOptions(structure, native, platforms or None, fmi)
    check_options([component], options)
    return build_file(component, Path(out), options, progress)


@checks_arguments
def fmu_info(file: str | Path) -> FmuInfo:
    """What an FMU is, what it can, and its variables; printed it is what the command `fmu info` shows."""
    from fmus.fmi.validate import info

    return info(Path(file))


@checks_arguments
def validate_fmu(file: str | Path) -> Findings:
    """What keeps an FMU from running here (`faults`), and what else departs from the standard (`remarks`).

    Both are lines of text; the findings are false where there are none. An FMU whose file has no faults is
    run in its own process: initialised with its start values, a few steps of its default experiment,
    terminated.
    """
    from fmus.fmi.validate import Findings, inspect
    from orchestrator.run.trial import try_fmu

    found = inspect(Path(file))
    if found.faults:
        return found
    faults, remarks = try_fmu(Path(file))
    return Findings(faults, found.remarks + remarks)


@checks_arguments
def compare_fmu(file: str | Path, tolerance: float | None = None) -> Comparison:
    """Step an FMU in this process and compare it with its reference results, inside the file or beside it.

    `agrees` says whether it is within `tolerance` (default: of the .opt file). MistakeError if there is no
    reference or it does not run.
    """
    from fmus.reference_results.compare import compare

    return compare(Path(file), tolerance)


def check_options(names: Sequence[str] | None, options: FmuOptions) -> Sequence[str]:
    """The components to build, all by default; MistakeError if they cannot be built so."""
    from fmus.build import NAMES
    from fmus.native.fmu import NAMES as NATIVE_NAMES
    from models.catalogue import is_own
    from orchestrator.scenario.values import build_component

    sizes = options.structure or {}
    if sizes and len(names or NAMES) > 1:
        raise MistakeError((Option("structure"), ": name the one component that has these sizes"))
    check_kind(options)
    for name in names or NAMES:
        if name not in NAMES and not is_own(name):
            raise MistakeError(f"no FMU {name!r}; {suggestion(name, NAMES)} (or your own as module:factory)")
        try:
            build_component(name, tuple(sizes.items()))
        except ValueError as error:
            raise MistakeError((Option("structure"), f": {error}") if sizes else str(error)) from None
    return names or (NATIVE_NAMES if options.native else NAMES)


def check_kind(options: FmuOptions) -> None:
    """MistakeError for options of the kind of FMU that do not fit together."""
    if options.platforms and not options.native:
        python = ": FMUs that run in Python are one file for Linux and Windows alike"
        raise MistakeError((Option("platform"), python), ("add ", NATIVE, " to choose"))
    if options.fmi not in (2, 3):
        raise MistakeError((Option("fmi", options.fmi), ": must be 2 or 3"))
    if options.fmi == 3 and not options.native:
        raise MistakeError(
            (Option("fmi", 3), ": FMUs that run in Python are of FMI 2.0 only"), ("add ", NATIVE)
        )


def check_place(out: Path, names: Sequence[str]) -> None:
    """MistakeError for one file in which several FMUs would be written."""
    if len(names) > 1 and out.suffix == ".fmu":
        raise MistakeError(
            (Option("out", out), f": is one file, but {len(names)} FMUs are built"), "give a folder"
        )


def build_file(
    name: str, out: Path, options: FmuOptions, progress: Callable[[str], None] = lambda step: None
) -> Path:
    """The FMU's file in the folder `out`; MistakeError if it cannot be built, or written.

    `progress` is told of each step of a native build.
    """
    from fmus.build import build as build_python
    from fmus.native.fmu import build as build_native
    from fmus.native.machine_code import CHOICES, PLATFORMS

    for platform in options.platforms or ():
        if platform not in CHOICES:
            raise MistakeError(f"no platform {platform!r}; {suggestion(platform, CHOICES)}")
        if options.fmi == 2 and not CHOICES[platform].fmi2:
            raise MistakeError(
                (Option("platform", platform), ": is none of FMI 2"), ("add ", Option("fmi", 3))
            )
    try:
        with writing(out):
            if options.native:
                platforms = tuple(options.platforms or PLATFORMS)
                return build_native(name, out, options.structure, platforms, options.fmi, progress)
            return build_python(name, out, options.structure)
    except MistakeError:
        raise
    except (ImportError, ValueError) as error:
        raise MistakeError(str(error)) from None
