"""FMUs that report success and stand still."""

from collections.abc import Callable, Collection

import numpy as np

from models.core.quantities import Vector
from models.core.system import System

# Records in which nothing changes, and their share of all, before it is told: a motion may come to rest.
FEWEST, SHARE = 10, 0.5


def list_frozen(system: System, foreign: Collection[str], column: Callable[[str], Vector]) -> list[str]:
    """A line for each of these FMUs whose outputs all stand still while an input changes."""
    return [line for name in foreign if (line := _describe(system, name, column))]


def _describe(system: System, name: str, column: Callable[[str], Vector]) -> str:
    layout = system.instances[name].component.outputs
    driving = [c for c in system.connections if c.target.instance == name]
    # What jumps may stand still for long, and shows life where it does not.
    if not driving or all(field.quantity.jumps for field in layout.fields):
        return ""
    times = column("time")
    last = max(_last_change(column(f"{name}.{output}")) for output in layout.names)
    still = len(times) - 1 - last
    if still < max(FEWEST, SHARE * len(times)):
        return ""
    moving = [str(c.target) for c in driving if np.ptp(column(str(c.source))[last:]) > 0.0]
    if not moving:
        return ""
    return (
        f"{name}: no output changes from t = {times[last]:.6g} s on, though {', '.join(moving)} changes; if "
        "it has no stop, limit or dead zone, look at the FMU, which reports success, and its parameters"
    )


def _last_change(values: Vector) -> int:
    """The record from which on the values stay."""
    changes = np.flatnonzero(np.diff(values))
    return int(changes[-1]) + 1 if changes.size else 0
