"""FMI 3.0: an instance of an FMU for co-simulation.

The FMU handles its events itself (see `fmi3_events` for the others). The rest of a step that returns early
follows.
"""

import ctypes
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NoReturn

import numpy as np
from fmpy import fmi3
from fmpy.fmi3 import FMU3Slave

from models.core.quantities import Vector

from ..errors import ParticipantError
from .description import BINARY, BOOLEANS, REALS, Description, Variable
from .fmi_instance import DISCARD, WARNING, ArrayLayout, Fail, FailStep, FmiInstance, Step, Transfer

# Types that are stored as another one.
STORED_AS = {"Enumeration": "Int64"}
# Places of the flags that a step returns.
EVENT, ENDED, EARLY = 0, 1, 2
# Limit of early returns from one step.
MAXIMUM_RETURNS = 10_000
# Relative tolerance of times, for the FMU's sum of steps.
ROUNDING = 1e-12


class Fmi3(FmiInstance):
    real_types = ("Float64",)
    set_reals, get_reals = "fmi3SetFloat64", "fmi3GetFloat64"
    interface = FMU3Slave

    def __init__(self, name: str, description: Description, folder: str) -> None:
        super().__init__(name, description, folder)
        self._name = name
        self._early = description.returns_early
        # What a step returns: event, end, early return (a byte each); at 8 the time reached.
        self._outcome = np.zeros(2)

    def instantiate(self, log: Callable[[int, bytes], None]) -> None:
        self.slave.instantiate(
            loggingOn=True, logMessage=lambda environment, status, category, message: log(status, message)
        )
        self._bind("fmi3GetFMUState", "fmi3SetFMUState", "fmi3FreeFMUState")

    def configure(self, sizes: Mapping[Variable, int]) -> None:
        self.slave.enterConfigurationMode()
        for variable, size in sizes.items():
            self.set([variable], [size])
        self.slave.exitConfigurationMode()

    def enter_initialization(self, start_time: float, stop_time: float) -> None:
        self.slave.enterInitializationMode(startTime=start_time, stopTime=stop_time)

    def set(self, variables: Sequence[Variable], values: Iterable[float]) -> None:
        make = float if variables[0].type in REALS else bool if variables[0].type in BOOLEANS else int
        kind = STORED_AS.get(variables[0].type, variables[0].type)
        found = list(dict.fromkeys(v.reference for v in variables))
        memory = (getattr(fmi3, f"fmi3{kind}") * len(variables))(*(make(value) for value in values))
        call, references = getattr(self.slave, f"fmi3Set{kind}"), (ctypes.c_uint * len(found))(*found)
        call(self.slave.component, references, len(references), memory, len(memory))

    def set_text(self, variable: Variable, text: str) -> None:
        if variable.type == BINARY:
            self.slave.setBinary([variable.reference], [bytes.fromhex(text)])
        else:
            self.slave.setString([variable.reference], [text])

    def get_text(self, variable: Variable) -> str:
        if variable.type == BINARY:
            return (self.slave.getBinary([variable.reference])[0] or b"").hex()
        return str(self.slave.getString([variable.reference])[0])

    def serialise(self, state: ctypes.c_void_p) -> bytes:
        return bytes(self.slave.serializeFMUState(state))

    def deserialise(self, data: bytes) -> ctypes.c_void_p:
        state: ctypes.c_void_p = self.slave.deserializeFMUState(data)
        return state

    def free(self) -> None:
        self.slave.freeInstance()

    def get_addresses(self) -> dict[str, int]:
        if self._early:  # which compiled code does not go on from
            return {}
        found = self._addresses("fmi3DoStep")
        return found | {"fmi3": 1, "outcome": self._outcome.ctypes.data}

    def _sizes(self, values: Vector) -> tuple[Any, ...]:
        return (ctypes.c_size_t(values.size),)

    def find_getter(self, kind: str) -> tuple[str, Any]:
        name = STORED_AS.get(kind, kind)
        return f"fmi3Get{name}", np.dtype(getattr(fmi3, f"fmi3{name}"))

    def bind_output_derivatives(self, references: Any, values: Vector, fail: Fail) -> Transfer:
        orders = np.ones(len(references), dtype=np.int32)
        return self._transfer("fmi3GetOutputDerivatives", references, orders, values=values, fail=fail)

    def differentiate(self, unknown: Sequence[Variable], known: Variable) -> list[float]:
        whole = ArrayLayout(unknown)
        seed = [float(place == known.place) for place in range(known.size)]
        references = list(whole.references)
        found = self.slave.getDirectionalDerivative(references, [known.reference], seed, whole.size)
        return [found[place] for place in whole.places]

    def _bind_do_step(self) -> tuple[Callable[[float, float], int], Any]:
        """A call of fmi3DoStep from a time by a length, which returns the status, and its flags."""
        call, handle, yes = self._function("fmi3DoStep"), self._handle, ctypes.c_bool(True)
        begin, duration, at = ctypes.c_double(), ctypes.c_double(), self._outcome.ctypes.data
        places = [ctypes.c_void_p(at + offset) for offset in (0, 1, 2, 8)]

        def do_step(time: float, step: float) -> int:
            begin.value, duration.value = time, step
            status: int = call(handle, begin, duration, yes, *places)
            if status == WARNING:
                self.warned += 1
            return status

        return do_step, self._outcome[:1].view(np.uint8)

    def bind_step(self, fail: FailStep) -> Step:
        do_step, marks = self._bind_do_step()
        outcome, ended_in = self._outcome, self.ended_in

        def advance(time: float, step: float) -> None:
            if ended_in and time > ended_in.pop():
                return fail(DISCARD, time, step)
            begin, end = time, time + step
            left = step
            for _ in range(MAXIMUM_RETURNS):
                status = do_step(begin, left)
                if status <= WARNING and not (marks[ENDED] or marks[EARLY]):
                    return
                if status > WARNING or marks[ENDED]:
                    break
                if not begin <= outcome[1] <= end + abs(end) * ROUNDING:
                    self.refuse_reached(begin, end)
                begin, left = float(outcome[1]), float(end - outcome[1])
                if left <= 0.0:
                    return
            else:
                self.refuse_returns(time, step)
            fail(max(status, DISCARD), time, step)

        return advance

    def refuse_reached(self, begin: float, end: float) -> NoReturn:
        raise ParticipantError(
            f"{self._name}: came back early from its step from t = {begin:.9g} s and says that it has "
            f"reached t = {self._outcome[1]:.9g} s (lastSuccessfulTime): must not be earlier, and at most "
            f"{end:.9g} s; the FMU is at fault, ask who made it"
        )

    def refuse_returns(self, time: float, step: float) -> NoReturn:
        raise ParticipantError(
            f"{self._name}: came back early {MAXIMUM_RETURNS} times from its step from t = {time:.9g} s by "
            f"{step:g} s, and is at t = {self._outcome[1]:.9g} s; take a smaller macro_step, or ask its maker"
        )

    def get_reached_time(self) -> float | None:
        return float(self._outcome[1])

    def is_ended(self) -> bool:
        return bool(self._outcome[:1].view(np.uint8)[ENDED])
