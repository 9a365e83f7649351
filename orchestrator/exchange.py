"""The exchange between participants: which output goes to which input, through one vector of values."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

import numpy as np

from models.quantities import Vector
from models.system import Port, System

from .errors import NotFiniteError, RunError
from .participants import Participant
from .signals import History, gather, interpolate_part


class Exchange:
    """All evolving data of a coupled run outside the participants.

    `values` are the connected outputs ("sources"), each once, participant by participant; `columns[i]`
    are the sources that feed participant i, in the order of its bound inputs `inputs[i]`. Signals have
    `degree` + 1 coefficients: value and derivatives at the start of the step.
    """

    def __init__(self, system: System, participants: Mapping[str, Participant], degree: int) -> None:
        self.system = system
        self.names = tuple(system.instances)
        self.listed = list(range(len(self.names)))
        self.participants = [participants[name] for name in self.names]
        self.sources: list[Port] = []
        self.slices: list[slice] = []
        for name in self.names:
            layout = system.instances[name].component.outputs
            used = {c.source.variable for c in system.connections if c.source.instance == name}
            start = len(self.sources)
            self.sources += [Port(name, variable) for variable in layout.names if variable in used]
            self.slices.append(slice(start, len(self.sources)))
        number = {port: i for i, port in enumerate(self.sources)}
        self.values: Vector = np.zeros(len(self.sources))
        self.nominal: Vector = np.array(
            [system.outputs.nominal[system.outputs.index(port)] for port in self.sources]
        )
        self.signals: Vector = np.zeros((degree + 1, len(self.sources)))
        self.columns: list[Vector] = []
        self.inputs: list[Vector] = []
        for i, name in enumerate(self.names):
            feeding = [c for c in system.connections if c.target.instance == name]
            self.columns.append(np.array([number[c.source] for c in feeding], dtype=np.int64))
            self.inputs.append(np.zeros((degree + 1, len(feeding))))
            own = self.slices[i]
            self.participants[i].connect(
                [c.target.variable for c in feeding],
                self.inputs[i],
                [port.variable for port in self.sources[own]],
                self.values[own],
                np.zeros(0),
            )
        self.history = History(0.0, self.values)

    def write(self, i: int) -> None:
        """Give participant i the current signals."""
        gather(self.signals, self.columns[i], self.inputs[i])
        self.participants[i].write()

    def read(self, i: int) -> None:
        """Take the values of participant i; NotFiniteError if one is not finite."""
        self.participants[i].read()
        if not np.isfinite(self.values[self.slices[i]]).all():
            self._refuse(i)

    def arrive(self, i: int, degree: int, end: float) -> None:
        """As `read` at the time `end`, and let the signals of participant i go to what it arrived at."""
        self.participants[i].read()
        own, past = self.slices[i], self.history
        if not interpolate_part(
            past.times, past.values, past.count, degree, end, self.values, self.signals, own.start, own.stop
        ):
            self._refuse(i)

    def _refuse(self, i: int) -> None:
        own = self.slices[i]
        pairs = zip(self.sources[own], self.values[own], strict=True)
        bad = ", ".join(str(port) for port, value in pairs if not np.isfinite(value))
        raise NotFiniteError(
            f"{bad}: not a finite number in the step from t = {self.history.times[0]:.6g} s; look at the "
            "parameters and inputs of that participant, or reduce macro_step"
        )

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Initialise all participants and make the outputs consistent at the start.

        Values pass along the connections until none changes by more than 1e-12 of its nominal size;
        without algebraic loops that takes at most one sweep per participant.
        """
        for participant in self.participants:
            participant.initialise(start_time, stop_time)
        for i in range(len(self.participants)):
            self.read(i)
        for _ in range(10 * len(self.participants) + 50):
            before = self.values.copy()
            for i in range(len(self.participants)):
                self.signals[:] = 0.0
                self.signals[0] = self.values
                self.write(i)
                self.read(i)
            change = np.abs(self.values - before) / (self.nominal + np.abs(self.values))
            if np.all(change <= 1e-12):
                break
        else:
            worst = self.sources[int(np.argmax(change))]
            raise RunError(
                f"{worst}: the initial values do not settle (algebraic loop that does not contract); "
                "break the loop or change the parameters that close it"
            )
        for participant in self.participants:
            participant.finish_initialisation()
        self.history = History(start_time, self.values)

    @contextmanager
    def rollback(self) -> Iterator[Callable[[], None]]:
        """A function that brings all participants back to where they are now, inside the block."""
        saved = [participant.save() for participant in self.participants]

        def roll_back() -> None:
            for participant, data in zip(self.participants, saved, strict=True):
                participant.restore(data)

        try:
            yield roll_back
        finally:
            for participant, data in zip(self.participants, saved, strict=True):
                participant.release(data)

    def read_all(self, values: Vector) -> None:
        """All outputs of all participants, in the system's order."""
        for name, participant in zip(self.names, self.participants, strict=True):
            participant.read_all(values[self.system.outputs.of(name)])
