"""A participant that makes a macro step in several steps of its own: at a higher rate, or after a discard.

Its inputs are polynomials in the time since the start of the macro step; every step gets them about its
own start, so that the signals are the same however they are cut.
"""

from collections.abc import Sequence
from typing import NoReturn

import numpy as np

from ..errors import DiscardedStepError, RecoverableError
from ..participants.capabilities import HIGHEST
from ..participants.compiled_calls import NotCompiledError
from ..participants.protocol import BoundVariables, Participant
from ..participants.wrapping import ParticipantWrapper
from .signals import move_origin


class Substepped(ParticipantWrapper):
    """Implements `Participant` by `participant`, with `substeps` equal steps to every macro step.

    A step that fails is tried in two halves, these again, down to 2**-`halvings` of a substep: from where
    the participant has been restored to, or has arrived (`DiscardedStepError.reached`). Where neither is
    possible, and after the last halving, the error is raised.
    """

    def __init__(self, participant: Participant, substeps: int = 1, halvings: int = 0) -> None:
        super().__init__(participant)
        self._substeps, self._halvings = substeps, halvings
        self._smallest = 0.5**halvings / substeps

    def signal_degrees(self, input_names: Sequence[str]) -> Sequence[int]:
        # Between its own steps it follows a signal of any degree, if only by values.
        return super().signal_degrees(input_names) if self._substeps == 1 else [HIGHEST] * len(input_names)

    def connect(self, bound: BoundVariables) -> Sequence[bool]:
        rated = self._participant.connect(bound)
        self.write, self.read = self._participant.write, self._participant.read
        self._inputs, self._tried = bound.inputs, bound.tried
        self._start = np.zeros_like(bound.inputs)
        return rated

    def compiled_calls(self) -> NoReturn:
        raise NotCompiledError("it makes steps of its own (substeps, retries)")

    def advance(self, time: float, step: float) -> None:
        self._time, self._step = time, step
        self._start[:] = self._inputs
        length = step / self._substeps
        try:
            for n in range(self._substeps):
                self._advance_in_pieces(time + n * length, length, self._halvings)
        finally:
            self._inputs[:] = self._start  # it is the master's

    def _advance_in_pieces(self, start: float, length: float, halvings: int) -> None:
        """Advance from `start` by `length`, in pieces where that fails. The inputs are written."""
        while True:
            if start > self._time:
                move_origin(self._start, start - self._time, self._inputs)
                self.write()
            try:
                self._attempt(start, length)
                self._tried(False)
                return
            except DiscardedStepError as error:
                self._tried(True)
                if error.reached is None:
                    raise
                if (done := error.reached - start) < self._smallest * self._step:
                    if halvings == 0:
                        raise self._add_length(error) from None
                    break
                start, length = error.reached, length - done
        self._advance_in_pieces(start, 0.5 * length, halvings - 1)
        self._advance_in_pieces(start + 0.5 * length, 0.5 * length, halvings - 1)

    def _attempt(self, time: float, step: float) -> None:
        """Advance; where that fails, what restores is where it was, or where it arrived with success."""
        if not (self._halvings and self.abilities.restorable):
            self._participant.advance(time, step)
            return
        saved = self.save()
        try:
            self._participant.advance(time, step)
        except RecoverableError as error:
            # Of a step that has not begun nothing is known but the time; to restore is what FMI asks for.
            reached = error.reached if isinstance(error, DiscardedStepError) else None
            if reached is not None and reached > time:
                raise
            self.restore(saved)
            raise DiscardedStepError(str(error), time) from None
        finally:
            self.release(saved)

    def _add_length(self, error: DiscardedStepError) -> DiscardedStepError:
        if not self._halvings:
            return error
        longer = f"(longer steps failed as well, from {self._step / self._substeps:g} s on)"
        return DiscardedStepError(f"{error} {longer}", error.reached)
