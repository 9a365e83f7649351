"""Linearisation of an FMU by its directional derivatives: exact, wherever it is from."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from models.core.system import ModelError, System
from models.monolithic.trajectory import Course

from ..errors import ParticipantError
from ..participants import FmuParticipant
from .linear import ROWS, Linear
from .trajectory import Along


class Directional(Along):
    """Implements `Linearisation` for an FMU whose `states` are told and which is `linearisable`.

    It is brought along the course, and says at an instant how its states' derivatives and its outputs change
    with its states and inputs. At a kink that is the branch taken. Which Taylor coefficients of its inputs it
    makes use of is what its description says.
    """

    def __init__(self, name: str, participant: FmuParticipant, system: System) -> None:
        super().__init__(name, participant, system)
        self._fmu = participant

    def about(self, course: Course, row: int, outputs: Collection[str]) -> Linear:
        self._bring(course, row)
        self._inputs[:] = 0.0
        self._inputs[0] = self._values[row]
        self._fmu.write()
        states = self._fmu.states
        unknown, known = [*states.values(), *self.shown], [*states, *self.fed]
        try:
            found = self._fmu.jacobian(unknown, known)
        except ParticipantError as error:
            raise ModelError(f"{error}; linearise it by its responses (--responses)") from None
        n, taken = len(states), np.ones((ROWS, len(self.fed)))
        taken[: len(self._fmu.follows)] = self._fmu.follows
        scale = np.array([self._fmu.nominal(state) for state in states])
        linear = Linear(found[:n, :n], found[:n, n:], found[n:, :n], found[n:, n:], scale)
        return self._whole(linear, taken, [], outputs)

    @property
    def told(self) -> tuple[str, str]:
        return "By their directional derivatives", self.name
