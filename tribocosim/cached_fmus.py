"""FMUs that runs need: built once and kept in the user's cache folder.

What builds FMUs is imported when one is built: most runs find theirs in the cache.
"""

import atexit
import functools
from collections.abc import Callable, Mapping
from pathlib import Path

from models.compile.cache_folder import user_cache_directory
from models.compile.temporary import TemporaryFolder
from orchestrator.errors import MistakeError, Option, RunError, Words
from orchestrator.reporter import show_share
from orchestrator.scenario import Scenario

from .messages import say

WITHOUT: Words = ("leave out ", Option("native"), " (participant = 'fmu')")


def build_fmu(name: str, structure: Mapping[str, int], kind: str = "fmu") -> Path:
    """Build the component's FMU, in Python or `native`, unless it is in the cache. If the cache cannot be
    written, use a folder that lasts as long as this process."""
    make = _build_native_here if kind == "native" else _build_in_python
    try:
        try:
            return make(name, None, structure)
        except OSError as error:
            return _build_without_cache(make, name, structure, error)
    except OSError as error:
        raise RunError(
            f"building the FMU {name}: neither {user_cache_directory()} nor the folder for temporary files "
            f"can be written ({error.strerror}); set TRIBOCOSIM_CACHE to a folder that can"
        ) from None
    except MistakeError:
        raise
    except (ImportError, KeyError, ValueError) as error:
        raise RunError(f"building the FMU {name}: {error.args[-1] if error.args else error}") from None


def _build_in_python(name: str, destination: Path | None, structure: Mapping[str, int]) -> Path:
    from fmus.build import build

    return build(name, destination, structure, references=False)


def _build_native_here(name: str, destination: Path | None, structure: Mapping[str, int]) -> Path:
    from fmus.native.fmu import build
    from fmus.native.machine_code import NativeBuildError, this_platform
    from models.native.translate import TranslationError

    def tell(step: str) -> None:
        show_share(0.0, f", {name}: {step}")

    try:
        return build(name, destination, structure, [this_platform()], progress=tell)
    except (NativeBuildError, TranslationError) as error:
        raise MistakeError((f"building the native FMU {name}: ", error), WITHOUT) from None


def check_native(scenario: Scenario) -> None:
    """MistakeError if native FMUs that a scenario takes cannot be built here."""
    tables = scenario.components.items()
    instances = {name: str(table.component) for name, table in tables if table.participant == "native"}
    if not instances:
        return
    from fmus.native.fmu import check_component, check_tools
    from fmus.native.machine_code import NativeBuildError
    from models.native.translate import TranslationError

    try:
        check_tools()
    except NativeBuildError as error:
        raise MistakeError((f"components {', '.join(instances)}: ", error), WITHOUT) from None
    for name, component in instances.items():
        try:
            check_component(component)
        except TranslationError as error:
            raise MistakeError((f"components.{name}.component = ", error), WITHOUT) from None


def _build_without_cache(
    make: Callable[[str, Path | None, Mapping[str, int]], Path],
    name: str,
    structure: Mapping[str, int],
    error: OSError,
) -> Path:
    """As `make`, once for each FMU, in a temporary folder; OSError if that cannot be written either."""
    sizes = "".join(f"-{size}-{number}" for size, number in sorted(structure.items()))
    folder = make_folder(str(error.strerror)) / f"{make.__name__}-{name}{sizes}"
    made = list(folder.glob("*.fmu"))
    return made[0] if made else make(name, folder, structure)


@functools.cache
def make_folder(reason: str) -> Path:
    """Make a folder that is deleted at the end of this process; report once why it is needed."""
    say(
        f"{user_cache_directory()}: cannot be used ({reason}), so FMUs are built for this command only; "
        "TRIBOCOSIM_CACHE names another folder"
    )
    kept = TemporaryFolder()
    atexit.register(kept.delete)
    return kept.path
