"""tribocosim: valve trains and slider-cranks as FMUs, coupled and compared with a reference.

>>> import tribocosim
>>> scenario = tribocosim.load("valve-train").with_({"components.camshaft.parameters.lift": "9 mm"})
>>> result = tribocosim.run(scenario)
>>> result.coupled["contact.load"]
"""

# ruff: noqa: F403, F405  # the names are those of `api`, which type checkers read
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .api import *

__all__ = [
    "MistakeError", "Result", "RunError", "Scenario", "analyse", "build_fmu", "build_scenario_fmus",
    "calibrate", "cam", "compare", "compare_fmu", "design", "execute", "fmu_info", "load", "open", "plan",
    "report", "resume", "run", "scenarios", "sensitivities", "session", "speeds", "study", "tolerances",
    "validate_fmu", "wear",
]  # fmt: skip


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__", "errors"])


def __getattr__(name: str) -> Any:
    """Import the interface when it is first asked for: the command begins with less."""
    from .packages import find_shadowed

    if message := find_shadowed():
        raise ImportError(message)
    if name == "errors":
        import importlib

        return importlib.import_module(".errors", __name__)
    if name == "__version__":
        from importlib import metadata

        return metadata.version("tribocosim")
    if name not in __all__:
        from orchestrator.errors import one_of

        raise AttributeError(f"module 'tribocosim' has no attribute {name!r}: {one_of(__all__, name)}")
    from . import api

    return getattr(api, name)
