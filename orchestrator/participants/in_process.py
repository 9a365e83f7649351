"""A component as participant, without FMI: the same kernels, called directly."""

from collections.abc import Mapping, Sequence
from typing import NoReturn

import numpy as np

from models.core.integrator import FAILURES, OK
from models.core.quantities import INPUT_COEFFICIENTS, Vector
from models.core.system import Instance

from ..errors import DiscardedStepError, ParticipantError, instead_of_discarded
from ..store.json_codec import from_text, to_text
from .compiled_calls import IN_PROCESS, NotCompiledError
from .protocol import Abilities, BoundVariables

# Time, states, inputs in effect, their slopes, outputs, whether these are yet to be computed.
Saved = tuple[float, Vector, Vector, Vector, Vector, bool]


class InProcessParticipant:
    """Implements `Participant` for an instance of a component."""

    abilities = Abilities()

    def __init__(self, name: str, instance: Instance) -> None:
        self.name = name
        self._instance = instance
        component = instance.component
        self._component = component
        self._p = component.parameters.vector(instance.parameters)
        if faults := component.parameter_faults(self._p):
            raise ParticipantError(f"{name}: {'; '.join(faults)}")
        self._x = component.state.vector(instance.start)
        self._U = component.input_polynomial()
        self._u = component.inputs.vector(instance.inputs)
        self._U[0] = self._u
        self._du = np.zeros(component.inputs.size)
        self._y = np.zeros(component.outputs.size)
        self._yd = np.zeros(component.outputs.size)
        self._work = np.zeros(component.work_size)
        self._rates_work = np.zeros(component.rates_work_size)
        self._scale = component.state.nominal
        self._t = 0.0
        self._stale = True

    def signal_degrees(self, input_names: Sequence[str]) -> Sequence[int]:
        return [INPUT_COEFFICIENTS - 1] * len(input_names)

    def connect(self, bound: BoundVariables) -> Sequence[bool]:
        input_names, self._inputs, output_names, self._outputs, self._rates = bound[:5]
        self._input_index = np.array([self._component.inputs.index(n) for n in input_names], dtype=np.int64)
        self._output_index = np.array(
            [self._component.outputs.index(n) for n in output_names], dtype=np.int64
        )
        self._rated = self._rates.size > 0
        return [self._rated] * len(output_names)

    def compiled_calls(self) -> NoReturn:
        raise NotCompiledError(IN_PROCESS)

    def initialise(self, start_time: float, stop_time: float) -> None:
        self._t = start_time
        # A step of no length compiles everything before the first one that counts; the start stays as it is.
        # Inputs may make no sense yet: that it fails there is no fault.
        c, x = self._component, self._x.copy()
        c.step(start_time, 0.0, x, self._U, self._p, self._scale, self._work, self._u, self._y)
        self._u[:] = self._U[0]
        if self._rated:
            self._fill_rates()
        self._stale = True

    def finish_initialisation(self) -> None:
        if faults := self._component.start_faults(self._p, self._x, self._u):
            raise ParticipantError(f"{self.name}: {'; '.join(faults)}")

    def set_inputs(self, values: Mapping[str, float]) -> None:
        for name, value in values.items():
            self._u[self._component.inputs.index(name)] = value
        self._U[0] = self._u
        self._stale = True

    def write(self) -> None:
        self._U[: len(self._inputs), self._input_index] = self._inputs
        self._u[:] = self._U[0]
        self._du[:] = self._U[1]
        self._stale = True

    def advance(self, time: float, step: float) -> None:
        c = self._component
        status = c.step(time, step, self._x, self._U, self._p, self._scale, self._work, self._u, self._y)
        if status != OK:
            # The state is that at the start of the step; inputs and outputs are not.
            self._u[:] = self._U[0]
            self._du[:] = self._U[1]
            self._stale = True
            reason = "; ".join([FAILURES.get(status, f"status {status}"), *c.input_faults(self._U, step)])
            raise DiscardedStepError(
                f"{self.name}: step from t = {time:.9g} s by {step:g} s: {reason}; "
                f"{instead_of_discarded(self.name)}",
                reached=time,
            )
        if self._rated:
            c.input_rates(self._U, step, self._du)
        self._t = time + step
        self._stale = False

    def _refresh(self) -> None:
        if self._stale:
            self._component.flat_output(self._t, self._x, self._u, self._p, self._y)
            self._stale = False

    def read(self) -> None:
        self._refresh()
        np.take(self._y, self._output_index, out=self._outputs)
        if self._rated:
            self._fill_rates()

    def _rate(self) -> None:
        self._component.flat_rates(self._t, self._x, self._u, self._du, self._p, self._rates_work, self._yd)

    def _fill_rates(self) -> None:
        self._rate()
        np.take(self._yd, self._output_index, out=self._rates)

    def read_all(self, values: Vector) -> None:
        self._refresh()
        values[:] = self._y

    def state_and_rates(self) -> tuple[Vector, Vector]:
        """The states, and the rates of all outputs with the inputs' slopes in effect; shared memory."""
        self._refresh()
        self._rate()
        return self._x, self._yd

    def save(self) -> Saved:
        return self._t, self._x.copy(), self._u.copy(), self._du.copy(), self._y.copy(), self._stale

    def restore(self, saved: Saved) -> None:
        self._t = saved[0]
        self._x[:] = saved[1]
        self._u[:] = self._U[0] = saved[2]
        self._du[:] = saved[3]
        self._y[:] = saved[4]
        self._stale = saved[5]

    def to_bytes(self, saved: Saved) -> bytes:
        return to_text(saved).encode("ascii")

    def from_bytes(self, data: bytes) -> Saved:
        t, x, u, du, y, stale = from_text(data.decode("ascii"))
        own = (self._x, self._u, self._du, self._y)
        if any(given.shape != vector.shape for given, vector in zip((x, u, du, y), own, strict=True)):
            raise ParticipantError(f"{self.name}: the saved state is of another component")
        return t, x, u, du, y, stale

    def release(self, saved: Saved) -> None:
        pass

    def close(self) -> None:
        pass
