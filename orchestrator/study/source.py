"""Versions of source and libraries, which must be equal on all workers of a study."""

import functools
import hashlib
import inspect
import platform
from importlib import metadata
from pathlib import Path

from .subjects import AnalysisSubject

PACKAGES = ("models", "fmus", "orchestrator")
LIBRARIES = ("numpy", "scipy", "numba")


@functools.cache
def hash_source() -> str:
    """SHA-256 over the Python files of our packages (first 16 digits)."""
    root = Path(__file__).parents[2]
    digest = hashlib.sha256()
    for package in PACKAGES:
        for file in sorted((root / package).rglob("*.py")):
            digest.update(file.relative_to(root).as_posix().encode())
            digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


@functools.cache
def _hash_module(file: str) -> str:
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()[:16]


@functools.cache
def _list_libraries() -> dict[str, str]:
    return {name: metadata.version(name) for name in LIBRARIES}


def compute_fingerprint(subject: object) -> dict[str, str]:
    """Versions by name that give equal results if equal. MistakeError if the subject's module is missing."""
    found = {"tribocosim": hash_source(), "python": platform.python_version(), "machine": platform.machine()}
    found |= _list_libraries()
    if isinstance(subject, AnalysisSubject) and ":" in subject.name:
        found[subject.name] = _hash_module(inspect.getfile(inspect.unwrap(subject.analysis.evaluate)))
    return found


def describe_difference(expected: dict[str, str], seen: dict[str, str]) -> str:
    """A phrase that lists the entries that differ; "" if none."""
    names = [name for name in expected if seen.get(name) != expected[name]]
    return ", ".join(f"{name} {seen.get(name, 'missing')} instead of {expected[name]}" for name in names)
