"""Opens an FMU for a run, in the run's process or its own."""

from collections.abc import Mapping
from pathlib import Path

from models.core.system import Instance

from .description import CO_SIMULATION, MODEL_EXCHANGE
from .fmu import open_here
from .in_own_process import InOwnProcess
from .opened_fmu import FmuSettings
from .own_process import Limits
from .protocol import Participant
from .third_party import ThirdPartyComponent

NO_STRINGS: Mapping[str, str] = {}


def open_fmu(
    name: str,
    path: Path,
    instance: Instance,
    strings: Mapping[str, str] = NO_STRINGS,
    limits: Limits | None = None,
) -> Participant:
    """The FMU at `path` in the place of `instance`, which knows no texts; `limits`: of its own process."""
    settings = collect_settings(instance, strings)
    return open_here(name, path, settings) if limits is None else InOwnProcess(name, path, settings, limits)


def collect_settings(instance: Instance, strings: Mapping[str, str] = NO_STRINGS) -> FmuSettings:
    """What the FMU in the place of `instance` is asked for and given."""
    component = instance.component
    about = component.about if isinstance(component, ThirdPartyComponent) else None
    starts = {
        k if about else component.state.field(k).add_suffix("_start"): v for k, v in instance.start.items()
    }
    interface = MODEL_EXCHANGE if about and about.integrated else CO_SIMULATION
    values = {**instance.parameters, **starts}
    sizes = about.sizes if about else {}
    return FmuSettings(component.outputs.names, values, instance.inputs, strings, interface, sizes)
