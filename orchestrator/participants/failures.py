"""Messages of an FMU, and the errors of its failed calls."""

from __future__ import annotations

import contextlib
from collections import deque
from typing import Any, NoReturn

from ..errors import (
    DiscardedStepError,
    EndedError,
    LostParticipantError,
    ParticipantError,
    RecoverableError,
    instead_of_discarded,
)
from .fmi_instance import DISCARD, FATAL, PENDING, WARNING, FmiInstance, status_name

REMEDY = "look at its inputs and parameters, reduce macro_step or use the iterated master"

# Part of a step that a complete one may lack, by rounding in the FMU's sum of steps.
WHOLE = 1e-9

ASYNCHRONOUS = (
    "asynchronous steps are not supported; have the FMU made without (canRunAsynchronuously = false)"
)


class ErrorReporter:
    """Base of a participant whose calls of the instance `_fmi` may fail."""

    _fmi: FmiInstance

    def __init__(self, name: str) -> None:
        self.name = name
        # The last messages only, so that they do not fill the memory.
        self._messages: deque[str] = deque(maxlen=20)
        self._fatal = False
        self._warnings, self._first_warning = 0, ""

    def _log(self, status: int, message: bytes) -> None:
        # The last line of a Python traceback names the error.
        if message and (lines := message.decode(errors="replace").strip().splitlines()):
            self._messages.append(lines[-1])
            if status == WARNING:
                self._warnings += 1
                self._first_warning = self._first_warning or lines[-1]

    @contextlib.contextmanager
    def _name_errors(self, what: str) -> Any:
        """Turn fmpy's exceptions into a message with what the FMU said."""
        try:
            yield
        except ParticipantError:
            raise
        except Exception as error:
            self._fatal |= getattr(error, "status", None) == FATAL
            kind = LostParticipantError if self._fatal else ParticipantError
            raise kind(f"{self.name}: {what}: {self._quote_message() or error}") from None

    def _quote_message(self) -> str:
        said = "; ".join(dict.fromkeys(self._messages))
        self._messages.clear()
        return said

    def _fail(self, status: int, what: str) -> NoReturn:
        """Raise the error of a failed call."""
        said = self._quote_message() or "no message"
        message = f"{self.name}: {what} returned {status_name(status)}: {said}; "
        if status == PENDING:
            raise ParticipantError(f"{message}{ASYNCHRONOUS}")
        message += REMEDY
        if status == FATAL:
            self._fatal = True
            raise LostParticipantError(message)
        raise RecoverableError(message)

    def check_end(self, time: float, step: float) -> None:
        """Before compiled code makes a step: EndedError if the FMU asked for the end at that of another."""
        if self._fmi.ended_in and time > self._fmi.ended_in.pop():
            self._raise_discarded(time, step)

    def _raise_discarded(self, time: float, step: float) -> None:
        """Raise the error of a discarded step, with how far it came.

        One that the FMU made to its end, to ask then for that of the simulation, is a step like others; the
        next one from there is refused.
        """
        what = f"{self.name}: step from t = {time:.9g} s by {step:g} s returned {status_name(DISCARD)}"
        said = self._quote_message()
        reached = self._fmi.get_reached_time()
        if self._fmi.is_ended():
            when = time if reached is None else reached
            if when >= time + step * (1.0 - WHOLE):
                self._fmi.ended_in.append(time)
                self._messages.append(said)  # to be told then
                return
            raise EndedError(
                f"{self.name}: the FMU asks to end the simulation at t = {when:.9g} s"
                f"{f': {said}' if said else ''}; set stop_time to that, or look at its parameters",
                when,
            )
        self._messages.clear()  # what it said about that question
        # A time outside the step says as little as none.
        if reached is not None and not time <= reached < time + step:
            reached = None
        raise DiscardedStepError(
            f"{what}: {said or 'no message'}; look at its inputs and parameters, "
            f"{instead_of_discarded(self.name)}",
            reached,
        )
