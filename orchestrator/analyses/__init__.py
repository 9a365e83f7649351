"""Analyses by name: each file of this folder without a leading underscore defines an `ANALYSIS`."""

from importlib import import_module
from pathlib import Path

from models.catalogue import import_own
from models.core.system import suggestion

from ..errors import MistakeError
from .protocol import Analysis, Parameter, Result

__all__ = ["Analysis", "Parameter", "Result", "list_analyses", "load"]

# Analyses of one table: module and object.
SHARED = {
    "classification": ("_settling", "CLASSIFICATION"),
    "transient": ("_settling", "TRANSIENT"),
    "wear": ("_distribution", "WEAR"),
    "exponents": ("_exponents", "EXPONENTS"),
    "exponent_map": ("_exponents", "EXPONENT_MAP"),
    "force": ("_regions", "FORCE"),
    "regions": ("_regions", "REGIONS"),
    "phase": ("_motion", "PHASE"),
    "trace": ("_motion", "TRACE"),
    "profile": ("_distribution", "PROFILE"),
    "spectrum": ("_distribution", "SPECTRUM"),
}


def list_analyses() -> list[str]:
    """The analyses that come with the program."""
    files = (path.stem for path in Path(__file__).parent.glob("*.py"))
    return sorted([*SHARED, *(name for name in files if not name.startswith("_") and name != "protocol")])


def load(name: str) -> Analysis:
    """The analysis of that name, or the Analysis at `module:object`; MistakeError if there is none."""
    if ":" in name:
        return _load_own(name)
    if name not in list_analyses():
        from ..scenario.files import list_shipped

        close = suggestion(name, list_analyses())
        if not close.startswith("did you mean") and "did you mean" in (
            other := suggestion(name, list_shipped())
        ):
            close = f"{other} (a scenario)"
        raise MistakeError(
            f"no analysis {name!r}; {close} (or name an analysis of your own as module:object)"
        )
    module, attribute = SHARED.get(name, (name, "ANALYSIS"))
    analysis: Analysis = getattr(import_module(f"{__name__}.{module}"), attribute)
    return analysis


def _load_own(name: str) -> Analysis:
    try:
        found = import_own(name)
    except ValueError as error:
        raise MistakeError(f"analysis {error}") from None
    if not isinstance(found, Analysis):
        raise MistakeError(
            f"analysis {name!r}: is of type {type(found).__name__}, must be an orchestrator.analyses.Analysis"
        )
    return found
