"""The equations of an FMU, in this process or its own: what asks there, and what answers."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from models.core.quantities import Vector

from ..messages import ADVANCE, CALL, READ
from ..opened_fmu import FmuSettings
from ..own_process import Limits, OwnProcess, ask
from ..process import answer_call, serve
from .equations import ExchangeFmu


class EquationsInOwnProcess(OwnProcess):
    """Implements what `ExchangeFmu` does for the FMU at `path`, by one in another process."""

    server = __name__

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

    guards, get_states, get_nominal = (
        ask(name, np.array) for name in ("guards", "get_states", "get_nominal")
    )
    enter_events, iterate = ask("enter_events"), ask("iterate")
    leave_events, complete_step = ask("leave_events"), ask("complete_step")


FmuEquations = ExchangeFmu | EquationsInOwnProcess


def open_equations(
    name: str, path: Path, settings: FmuSettings, inputs: tuple[str, ...], limits: Limits | None
) -> FmuEquations:
    """The equations of the FMU at `path` with these driven inputs; with `limits` in its own process."""
    if limits is None:
        return ExchangeFmu(name, path, settings, inputs)
    return EquationsInOwnProcess(name, path, settings, limits, inputs)


class Server:
    """Carries out messages; the first one, instantiate, opens the FMU."""

    equations: ExchangeFmu

    def carry_out(self, kind: bytes, content: bytes) -> bytes:
        """The answer to a message."""
        if kind == ADVANCE:
            t, *rest = np.split(np.frombuffer(content), [1, 1 + self.equations.states])
            return self.equations.outputs(float(t[0]), *rest).tobytes()
        if kind == READ:
            return self.equations.rate().tobytes()
        assert kind == CALL
        return answer_call(content, self, getattr(self, "equations", None))

    def instantiate(
        self, name: str, path: str, given: dict[str, Any], folder: str, inputs: list[str]
    ) -> None:
        self.equations = ExchangeFmu(name, Path(path), FmuSettings(**given), inputs, Path(folder))

    def get_sizes(self) -> list[int]:
        return [self.equations.states, self.equations.indicators]


def main() -> None:
    """Serve one FMU's equations."""
    serve(Server())
