"""An FMU for model exchange as participant: its equations are integrated here, over each macro step.

Inputs are polynomials in time, and events in a step are located. The method has one step and begins at each
macro step anew, so that a step that is repeated gives the same bits. Where inputs jump at a communication
point the FMU has an event there.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from fmus.fmi.model_exchange import MOST_ITERATIONS
from models.core.integrator import taylor
from models.core.quantities import INPUT_COEFFICIENTS, Vector
from models.core.system import ModelError
from models.monolithic.march import march
from models.monolithic.problem import Event
from models.monolithic.runge_kutta import RungeKutta

from ...errors import ParticipantError
from ..capabilities import signal_degrees
from ..compiled_calls import NotCompiledError
from ..opened_fmu import FmuSettings
from ..protocol import Abilities, BoundVariables
from .crossing import cross
from .equations import ExchangeFmu

# Relative to nominal + |value|, as in the FMUs of our components.
TOLERANCE = 1e-10
# Rates over a macro step after which the explicit method is given up for the implicit one.
STIFF_RATES = 3000


class DrivenEquations:
    """Implements `Problem`: an FMU's equations under inputs that are polynomials from `begin` (s) on.

    `inputs[k]` holds their k-th derivatives there. `rates` counts the evaluations.
    """

    def __init__(self, fmu: ExchangeFmu) -> None:
        self.fmu = fmu
        # Solvers need a state: a constant where the FMU has none.
        size = max(fmu.states, 1)
        self.nominal = np.ones(size)
        self.whole = np.zeros(size, dtype=np.bool_)
        self.guard_count = fmu.indicators
        self.begin, self.rates = 0.0, 0
        self.inputs: Vector = np.zeros((INPUT_COEFFICIENTS, 0))
        self._u = np.zeros(0)
        self._rate = np.zeros(size)

    def connect(self, names: Sequence[str]) -> None:
        """The driven inputs."""
        self.fmu.bind_inputs(names)
        self.inputs, self._u = np.zeros((INPUT_COEFFICIENTS, len(names))), np.zeros(len(names))

    @property
    def next_event(self) -> float:
        return self.fmu.next_event

    def outputs(self, t: float, z: Vector) -> Vector:
        """All outputs of the FMU at (t, z)."""
        taylor(self.inputs, t - self.begin, self._u)
        return self.fmu.outputs(t, z[: self.fmu.states], self._u)

    def rate(self, t: float, z: Vector) -> Vector:
        self.rates += 1
        self.outputs(t, z)
        self._rate[: self.fmu.states] = self.fmu.rate()
        return self._rate

    def guards(self, t: float, z: Vector) -> Vector:
        self.outputs(t, z)
        return self.fmu.guards()

    def transition(self, guard: int, t: float, z: Vector) -> Event:
        self.enter_events(cross(self, guard, t, z), z)
        return Event(t, self.fmu.name, guard)

    def enter_events(self, t: float, z: Vector) -> None:
        """To event mode at (t, z) and back; z becomes the new state."""
        self.outputs(t, z)
        self.fmu.enter_events()
        self.iterate_events(t, z)

    def iterate_events(self, t: float, z: Vector) -> None:
        """From event mode, with the inputs at t, back to continuous-time mode; z becomes the new state."""
        self.outputs(t, z)
        for _ in range(MOST_ITERATIONS):
            if not self.fmu.iterate():
                break
        else:
            raise ParticipantError(
                f"{self.fmu.name}: its event at t = {t:.9g} s takes more than {MOST_ITERATIONS} iterations; "
                "look at its parameters, or ask who made it"
            )
        z[: self.fmu.states] = self.fmu.get_states()
        self.fmu.leave_events()


@dataclass(frozen=True)
class Saved:
    """The FMU's own state, and what is not in it: time, states, inputs, and what is known of events."""

    fmu: Any
    time: float
    z: Vector
    inputs: Vector
    next_event: float
    signs: Vector
    stiff: bool


class IntegratedFmu:
    """Implements `Participant` for the FMU at `path`.

    DOP853 with tolerance `TOLERANCE`, or Radau from the step on after one has cost `STIFF_RATES` rates.
    """

    def __init__(self, name: str, path: Path, settings: FmuSettings, folder: Path | None = None) -> None:
        self.name, self._settings = name, settings
        self._fmu = ExchangeFmu(name, path, settings, (), folder)
        about = self._fmu.description
        self.abilities = Abilities(
            about.restorable, warnings=self._fmu.warnings, unserialisable=about.unserialisable
        )
        self._problem = DrivenEquations(self._fmu)
        self._time, self._z = 0.0, np.zeros(self._problem.nominal.size)
        self._stiff = self._jumped = False
        self.initialise = self._fmu.initialise
        self.terminate, self.close = self._fmu.terminate, self._fmu.close

    def signal_degrees(self, input_names: Sequence[str]) -> Sequence[int]:
        return signal_degrees(self._fmu.description, input_names)

    def connect(self, bound: BoundVariables) -> Sequence[bool]:
        self._bound = bound
        self._problem.connect(bound.input_names)
        self._index = [self._settings.outputs.index(name) for name in bound.output_names]
        return [False] * len(bound.output_names)

    def compiled_calls(self) -> NoReturn:
        raise NotCompiledError("its equations are integrated by the run (model exchange)")

    def finish_initialisation(self) -> None:
        self._fmu.finish_initialisation()
        self._problem.iterate_events(self._time, self._z)
        self._problem.nominal[: self._fmu.states] = self._fmu.get_nominal()

    def set_inputs(self, values: Mapping[str, float]) -> None:
        self._observe()
        self._fmu.enter_events()
        self._fmu.set_inputs(values)
        self._problem.iterate_events(self._time, self._z)

    def write(self) -> None:
        problem = self._problem
        before = problem.inputs[0].copy()
        if problem.begin != self._time:
            taylor(problem.inputs, self._time - problem.begin, before)
        problem.begin = self._time
        problem.inputs[: len(self._bound.inputs)] = self._bound.inputs
        self._jumped |= not np.array_equal(before, problem.inputs[0])

    def advance(self, time: float, step: float) -> None:
        problem, z = self._problem, self._z.copy()
        problem.rates = 0
        try:
            if self._jumped:
                problem.enter_events(time, z)
            method = RungeKutta(problem, TOLERANCE, self._stiff, step)
            found, _ = march(problem, method, z, time, np.array([time + step]), sample=self._complete)
        except ModelError as error:
            raise ParticipantError(
                f"{self.name}: step from t = {time:.9g} s by {step:g} s: {error}"
            ) from None
        self._stiff |= problem.rates > STIFF_RATES
        self._z, self._time, self._jumped = found[0], time + step, False

    def _complete(self, t: float, z: Vector) -> Vector:
        """Tell the FMU that the step is complete; the state then."""
        z = z.copy()
        self._problem.outputs(t, z)
        if self._fmu.complete_step():
            self._problem.enter_events(t, z)
        return z

    def read(self) -> None:
        self._bound.outputs[:] = self._observe()[self._index]

    def read_all(self, values: Vector) -> None:
        values[:] = self._observe()

    def _observe(self) -> Vector:
        return self._problem.outputs(self._time, self._z)

    def save(self) -> Saved:
        self._observe()
        next_event, signs = self._fmu.get_event_memory()
        inputs = np.append(self._problem.inputs, [self._problem.begin, self._jumped])
        return Saved(self._fmu.save(), self._time, self._z.copy(), inputs, next_event, signs, self._stiff)

    def restore(self, saved: Saved) -> None:
        self._fmu.restore(saved.fmu)
        self._fmu.set_event_memory(saved.next_event, saved.signs)
        self._time, self._z[:], self._stiff = saved.time, saved.z, saved.stiff
        *inputs, self._problem.begin, jumped = saved.inputs
        self._problem.inputs.ravel()[:] = inputs
        self._jumped = bool(jumped)

    def to_bytes(self, saved: Saved) -> bytes:
        own = [saved.time, saved.z.tolist(), saved.inputs.tolist(), saved.next_event, saved.signs.tolist()]
        return json.dumps([*own, saved.stiff]).encode() + b"\n" + self._fmu.to_bytes(saved.fmu)

    def from_bytes(self, data: bytes) -> Saved:
        own, _, fmu = data.partition(b"\n")
        time, z, inputs, next_event, signs, stiff = json.loads(own)
        vectors = [np.array(values, dtype=np.float64) for values in (z, inputs, signs)]
        return Saved(self._fmu.from_bytes(fmu), time, vectors[0], vectors[1], next_event, vectors[2], stiff)

    def release(self, saved: Saved) -> None:
        self._fmu.release(saved.fmu)
