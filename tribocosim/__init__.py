"""tribocosim: valve trains and slider-cranks as FMUs, coupled and compared with a reference.

>>> import tribocosim
>>> scenario = tribocosim.load("valve-train").with_({"components.camshaft.parameters.lift": "9 mm"})
>>> result = tribocosim.run(scenario)
>>> result.coupled["contact.load"]
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .api import MistakeError as MistakeError
    from .api import Result as Result
    from .api import RunError as RunError
    from .api import Scenario as Scenario
    from .api import analyse as analyse
    from .api import build_fmu as build_fmu
    from .api import build_scenario_fmus as build_scenario_fmus
    from .api import calibrate as calibrate
    from .api import cam as cam
    from .api import compare as compare
    from .api import compare_fmu as compare_fmu
    from .api import design as design
    from .api import execute as execute
    from .api import fmu_info as fmu_info
    from .api import load as load
    from .api import open as open
    from .api import plan as plan
    from .api import report as report
    from .api import resume as resume
    from .api import run as run
    from .api import scenarios as scenarios
    from .api import sensitivities as sensitivities
    from .api import session as session
    from .api import speeds as speeds
    from .api import study as study
    from .api import tolerances as tolerances
    from .api import validate_fmu as validate_fmu
    from .api import wear as wear

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
