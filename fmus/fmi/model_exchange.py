"""An instance of a model exchange FMU of FMI 2.0 or 3.0: states, rates, event indicators and event mode.

An event indicator z becomes a guard s z, with the sign s that it has after each event: an event happens where
a guard falls below zero.
"""

import math
from ctypes import POINTER, c_double
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.core.errors import RunError

Values = NDArray[np.float64]

# Event iterations after which an FMU is taken to be stuck.
MOST_ITERATIONS = 1000


class EventError(RunError):
    """The FMU ends the simulation in an event, or its event does not settle; the message lacks its name."""


class ModelExchange:
    """The calls of model exchange on an instance of fmpy's, `fmu`.

    `next_event` is the time (s) of the next time event, or infinite. `continuous`: it is in continuous-time
    mode; else, after initialisation, in event mode. `signs` are those of the indicators after the last event.
    """

    def __init__(self, fmu: Any, second: bool, states: int, indicators: int) -> None:
        self.fmu, self.size, self.indicators = fmu, states, indicators
        self.next_event = math.inf
        self.continuous = False
        self.signs = np.ones(indicators)
        self._x, self._rate, self._z = np.zeros(states), np.zeros(states), np.zeros(indicators)
        self._get_rate = fmu.getDerivatives if second else fmu.getContinuousStateDerivatives
        self._update = fmu.newDiscreteStates if second else fmu.updateDiscreteStates

    def move(self, t: float, x: Values) -> None:
        """Set time and states; in continuous-time mode only."""
        self.fmu.setTime(t)
        if self.size:
            self._x[:] = x
            self.fmu.setContinuousStates(_pointer(self._x), self.size)

    def states(self) -> Values:
        """The continuous states as they are."""
        if self.size:
            self.fmu.getContinuousStates(_pointer(self._x), self.size)
        return self._x.copy()

    def nominal(self) -> Values:
        """The nominal sizes of the states, all positive."""
        found = np.ones(self.size)
        if self.size:
            self.fmu.getNominalsOfContinuousStates(_pointer(found), self.size)
        return np.where(found > 0.0, found, 1.0)

    def rate(self) -> Values:
        """The states' derivatives by time; shared memory."""
        if self.size:
            self._get_rate(_pointer(self._rate), self.size)
        return self._rate

    def guards(self) -> Values:
        """The event indicators with the signs of the last event."""
        return np.asarray(self.signs * self._read_indicators())

    def enter_events(self) -> None:
        """From continuous-time mode to event mode."""
        self.fmu.enterEventMode()
        self.continuous = False

    def iterate(self) -> bool:
        """One event iteration; whether the FMU needs another one. EventError if it ends the simulation."""
        again, ends, _, _, known, at = self._update()
        if ends:
            raise EventError("the FMU ends the simulation in an event")
        self.next_event = float(at) if known else math.inf
        return bool(again)

    def leave_events(self) -> None:
        """From event mode to continuous-time mode."""
        self.fmu.enterContinuousTimeMode()
        self.continuous = True
        self.signs = np.where(self._read_indicators() > 0.0, 1.0, -1.0)

    def settle(self) -> None:
        """Iterate until the FMU needs no more, and leave event mode; for an FMU whose inputs stay."""
        for _ in range(MOST_ITERATIONS):
            if not self.iterate():
                return self.leave_events()
        raise EventError(f"an event of the FMU takes more than {MOST_ITERATIONS} iterations")

    def complete_step(self) -> bool:
        """Tell the FMU that a step of the integrator is complete; whether it asks for event mode."""
        asks, ends = self.fmu.completedIntegratorStep()
        if ends:
            raise EventError("the FMU ends the simulation after a step")
        return bool(asks)

    def _read_indicators(self) -> Values:
        if self.indicators:
            self.fmu.getEventIndicators(_pointer(self._z), self.indicators)
        return self._z


def _pointer(values: Values) -> Any:
    return values.ctypes.data_as(POINTER(c_double))
