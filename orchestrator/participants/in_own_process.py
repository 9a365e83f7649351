"""A co-simulation FMU in its own process.

A step is one message and one answer, with inputs and all outputs as raw doubles; other calls are JSON.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from models.core.quantities import Vector

from .capabilities import list_abilities, signal_degrees, uses_event_mode
from .compiled_calls import NotCompiledError
from .description import read_description
from .messages import ADVANCE, READ, TIMES
from .opened_fmu import FmuSettings
from .own_process import NO_LIMITS, Limits, OwnProcess
from .protocol import BoundVariables

Saved = int  # the process's number of a state


class InOwnProcess(OwnProcess):
    """Implements what `FmuParticipant` does for the FMU at `path`, by one in another process."""

    server = f"{__package__}.process"

    def __init__(self, name: str, path: Path, settings: FmuSettings, limits: Limits = NO_LIMITS) -> None:
        super().__init__(name, path, settings, limits)
        self._names = list(settings.outputs)
        self._about = about = read_description(path, settings.interface, settings.sizes)
        self.has_events = uses_event_mode(about)
        self.abilities = list_abilities(about, self)

    def signal_degrees(self, input_names: Sequence[str]) -> Sequence[int]:
        return signal_degrees(self._about, input_names)

    def compiled_calls(self) -> NoReturn:
        raise NotCompiledError("it runs in its own process")

    def connect(self, bound: BoundVariables) -> Sequence[bool]:
        self._inputs, self._outputs, self._rates = bound.inputs, bound.outputs, bound.rates
        self._fresh = self._written = False
        self._picked = bound.rates.size + np.array([*map(self._names.index, bound.output_names)], dtype=int)
        rated: list[bool] = self._call(
            "connect",
            inputs=list(bound.input_names),
            rows=len(bound.inputs),
            outputs=list(bound.output_names),
            rated=bool(bound.rates.size),
        )
        self._rated = np.array(rated, dtype=bool)
        return rated

    def initialise(self, start_time: float, stop_time: float) -> None:
        super().initialise(start_time, stop_time)
        self._fresh = False

    def finish_initialisation(self) -> None:
        super().finish_initialisation()
        self._fresh = False

    def set_inputs(self, values: Mapping[str, float]) -> None:
        self._deliver()
        self._call("set_inputs", values=dict(values))
        self._fresh = False

    def write(self) -> None:
        # The next step or reading sends them.
        self._written, self._fresh = True, False

    def advance(self, time: float, step: float) -> None:
        self._doing = f"step from t = {time:.9g} s by {step:g} s"
        self._fresh, self._stepped = False, True
        self._store_outputs(self._ask(ADVANCE, TIMES.pack(time, step), self._take_inputs()))

    def read(self) -> None:
        self._refresh()
        self._outputs[:] = self._taken[self._picked]
        if self._rates.size:
            self._rates[self._rated] = self._taken[: self._rates.size][self._rated]

    def read_all(self, values: Vector) -> None:
        self._refresh()
        values[:] = self._taken[self._rates.size :]

    def _refresh(self) -> None:
        if not self._fresh:
            self._doing = "reading of outputs"
            self._store_outputs(self._ask(READ, self._take_inputs()))

    def _call_between(self, method: str, **arguments: Any) -> Any:
        """A call of the side channel, which may change outputs."""
        self._deliver()
        self._fresh = False
        return self._call(method, **arguments)

    def _deliver(self) -> None:
        """Send inputs that were written, before a call that depends on them."""
        if self._written:
            self._doing = "setting of inputs"
            self._store_outputs(self._ask(READ, self._take_inputs()))

    def _take_inputs(self) -> bytes:
        """The inputs, if they were written since the last message."""
        written, self._written = self._written, False
        return self._inputs.tobytes() if written else b""

    def _store_outputs(self, content: bytes) -> None:
        if len(content) != self._rates.nbytes + 8 * len(self._names):
            self._raise_garbled()
        self._taken = np.frombuffer(content)
        self._fresh = True

    def next_event(self) -> float:
        return float(self._call_between("next_event"))

    def handle(self, time: float, clocks: Sequence[str]) -> list[str] | None:
        found: list[str] | None = self._call_between("handle", time=time, clocks=list(clocks))
        return found

    def get_texts(self, names: Sequence[str]) -> list[str]:
        return list(self._call_between("get_texts", names=list(names)))

    def set_texts(self, values: Mapping[str, str]) -> None:
        self._call_between("set_texts", values=dict(values))

    def get_followed(self) -> Any:
        return np.array(self._call("get_followed"), dtype=bool)

    def find_states(self, names: Sequence[str]) -> list[tuple[str, str, float]] | None:
        found = self._call("find_states", names=list(names))
        return found and [tuple(one) for one in found]

    def jacobian(self, unknown: Sequence[str], known: Sequence[str]) -> Vector:
        self._deliver()
        found = self._call("jacobian", unknown=list(unknown), known=list(known))
        return np.array(found, dtype=float).reshape(len(unknown), len(known))

    def save(self) -> Saved:
        self._deliver()
        saved: Saved = self._call("save")
        return saved

    def restore(self, saved: Saved) -> None:
        self._call("restore", number=saved)
        self._fresh = self._written = False

    def release(self, saved: Saved) -> None:
        if not self._lost:  # else its states are gone too
            self._call("release", number=saved)

    def to_bytes(self, saved: Saved) -> bytes:
        return bytes.fromhex(self._call("to_bytes", number=saved))

    def from_bytes(self, data: bytes) -> Saved:
        saved: Saved = self._call("from_bytes", data=data.hex())
        return saved
