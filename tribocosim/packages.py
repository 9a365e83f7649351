"""Packages that are missing, and files of the user that hide one of ours."""

import importlib.util
from collections.abc import Sequence
from pathlib import Path

# What the extra `studies` installs.
STUDY_PACKAGES = ("distributed", "zarr", "cryptography")
FIT_PACKAGES = ("lmfit", "distributed", "cryptography")  # of `fit`
NAMES = ("models", "fmus", "orchestrator")


def find_shadowed() -> str:
    """The message about the first of our packages that another file or folder hides; "" if none."""
    home = Path(__file__).resolve().parents[1]
    for name in NAMES:
        spec = importlib.util.find_spec(name)
        if spec is None or spec.origin is None:
            continue
        place = Path(spec.origin).resolve()
        if place.name == "__init__.py":
            place = place.parent
        if place != home / name:
            return f"{place} hides tribocosim's package {name}: rename it, or start in another folder"
    return ""


def check_study_packages() -> None:
    """MistakeError with the names of those that are missing."""
    _check(STUDY_PACKAGES, "studies need", "studies")


def check_fit_packages() -> None:
    """MistakeError with the names of those that are missing."""
    _check(FIT_PACKAGES, "a fit needs", "fit")


def _check(packages: Sequence[str], needing: str, extra: str) -> None:
    from fmus.extras import tell_install
    from orchestrator.errors import MistakeError

    if missing := [name for name in packages if importlib.util.find_spec(name) is None]:
        raise MistakeError(f"{needing} {', '.join(missing)}, the extra {extra}: {tell_install(extra)}")
