"""The equations of an FMU in its own process."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from models.core.quantities import Vector

from ..messages import ADVANCE, READ
from ..opened_fmu import FmuSettings
from ..own_process import Limits, OwnProcess


class EquationsInOwnProcess(OwnProcess):
    """Implements `FmuEquations` for the FMU at `path`, by an `ExchangeFmu` in another process."""

    server = f"{__package__}.process"

    def __init__(
        self, name: str, path: Path, settings: FmuSettings, limits: Limits, inputs: Sequence[str]
    ) -> None:
        super().__init__(name, path, settings, limits, inputs=list(inputs))
        self.states, self.indicators = self._call("get_sizes")

    def outputs(self, t: float, x: Vector, u: Vector) -> Vector:
        self._doing = f"equations at t = {t:.9g} s"
        self._stepped = True
        return np.frombuffer(self._ask(ADVANCE, np.concatenate([[t], x, u]).tobytes()))

    def rate(self) -> Vector:
        self._doing = "derivatives"
        return np.frombuffer(self._ask(READ))

    def guards(self) -> Vector:
        return np.array(self._call("guards"))

    def enter_events(self) -> None:
        self._call("enter_events")

    def iterate(self) -> bool:
        return bool(self._call("iterate"))

    def leave_events(self) -> float:
        return float(self._call("leave_events"))

    def complete_step(self) -> bool:
        return bool(self._call("complete_step"))

    def get_states(self) -> Vector:
        return np.array(self._call("get_states"))

    def get_nominal(self) -> Vector:
        return np.array(self._call("get_nominal"))
