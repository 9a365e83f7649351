"""A participant that cannot save its state, brought back to an instant as a fresh instance."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NoReturn

from models.core.quantities import Vector

from ..errors import CannotSerializeError
from .compiled_calls import NotCompiledError
from .in_own_process import InOwnProcess
from .protocol import Abilities, BoundVariables, Participant

# A call that changes it: its name, its arguments, and the inputs that were written before it.
Call = tuple[str, tuple[Any, ...], Vector]


class Reopened:
    """Implements `Participant` by fresh instances of `open_unit()`.

    `unit` is the present one. `save` is the number of calls so far, `restore` makes these calls again with
    a new instance, which gives the same bits as long as the FMU depends on nothing else.
    """

    def __init__(self, open_unit: Callable[[], Participant]) -> None:
        self._open, self.unit = open_unit, open_unit()
        self.name = self.unit.name
        self.abilities = Abilities(unserialisable="its state is the calls made to it, in this process")
        self._calls: list[Call] = []
        self._changed = False

    def signal_degrees(self, input_names: Sequence[str]) -> Sequence[int]:
        return self.unit.signal_degrees(input_names)

    def connect(self, bound: BoundVariables) -> Sequence[bool]:
        self._bound = bound
        return self.unit.connect(bound)

    def compiled_calls(self) -> NoReturn:
        raise NotCompiledError("it is brought back by fresh instances")

    def initialise(self, start_time: float, stop_time: float) -> None:
        self._call("initialise", start_time, stop_time)

    def finish_initialisation(self) -> None:
        self._call("finish_initialisation")

    def set_inputs(self, values: Mapping[str, float]) -> None:
        self._call("set_inputs", dict(values))

    def write(self) -> None:
        self._call("write")

    def advance(self, time: float, step: float) -> None:
        self._call("advance", time, step)

    def read(self) -> None:
        self.unit.read()

    def read_all(self, values: Vector) -> None:
        self.unit.read_all(values)

    def save(self) -> int:
        self._changed = False
        return len(self._calls)

    def restore(self, saved: int) -> None:
        if not self._changed and saved == len(self._calls):
            return
        again, self._calls = self._calls[:saved], []
        inputs = self._bound.inputs.copy()
        if isinstance(self.unit, InOwnProcess) and not self.unit.lost:
            self.unit.renew()
        else:
            self.unit.close()
            self.unit = self._open()
        self.unit.connect(self._bound)
        for method, arguments, given in again:
            self._bound.inputs[:] = given
            self._call(method, *arguments)
        self._bound.inputs[:] = inputs
        self._changed = False

    def reopen(self) -> None:
        """A fresh instance, brought to where this one was when it was last called by these methods."""
        self._changed = True
        self.restore(len(self._calls))

    def release(self, saved: int) -> None:
        pass

    def to_bytes(self, saved: int) -> NoReturn:
        raise CannotSerializeError(f"{self.name}: {self.abilities.unserialisable}")

    def from_bytes(self, data: bytes) -> NoReturn:
        raise CannotSerializeError(f"{self.name}: {self.abilities.unserialisable}")

    def close(self) -> None:
        self.unit.close()

    def _call(self, method: str, *arguments: Any) -> None:
        self._calls.append((method, arguments, self._bound.inputs.copy()))
        self._changed = True
        getattr(self.unit, method)(*arguments)
