"""Messages of an FMU, and the errors of its failed calls."""

import contextlib
from collections import deque
from typing import Any, NoReturn

from models.core.remedies import make_printable

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

NOT_FOLLOWED = (
    "it does not take them, though it says so (canInterpolateInputs); set master.extrapolation = 'hold', "
    "with which inputs have none"
)

# Part of a step that a complete one may lack, by rounding in the FMU's sum of steps.
WHOLE = 1e-9

NOWHERE = (
    "look at its inputs and parameters, or reduce macro_step; no shorter step can follow, as it neither "
    "saves its state nor tells how far it came"
)

ASYNCHRONOUS = (
    "asynchronous steps are not supported; have the FMU made without (canRunAsynchronuously = false)"
)


class ErrorReporter:
    """The messages of participant `name`, and the errors of calls of its instance `fmi`, to be set.

    `fatal`: no further call is allowed. `warnings` counts messages with that status.
    """

    fmi: FmiInstance

    def __init__(self, name: str) -> None:
        self.name = name
        # The last messages only, so that they do not fill the memory.
        self._messages: deque[tuple[int, str]] = deque(maxlen=20)
        self.fatal = False
        self.warnings, self.first_warning = 0, ""

    def log(self, status: int, message: bytes) -> None:
        # The last line of a Python traceback names the error.
        text = message.decode(errors="replace") if message else ""
        if lines := [make_printable(line) for line in text.strip().splitlines()]:
            self._messages.append((status, lines[-1]))
            if status == WARNING:
                self.warnings += 1
                self.first_warning = self.first_warning or lines[-1]

    @contextlib.contextmanager
    def name_errors(self, what: str) -> Any:
        """Turn fmpy's exceptions into a message with what the FMU said."""
        try:
            yield
        except ParticipantError:
            raise
        except Exception as error:
            self.fatal |= getattr(error, "status", None) == FATAL
            kind = LostParticipantError if self.fatal else ParticipantError
            said = self.quote_messages()
            # What has no status of FMI says itself what failed.
            told = said if said and hasattr(error, "status") else f"{error}: {said}" if said else error
            raise kind(f"{self.name}: {what}: {told}") from None

    def quote_messages(self) -> str:
        """What the FMU said of errors; without such a word, all that it said."""
        errors = [text for status, text in self._messages if status > WARNING]
        said = "; ".join(dict.fromkeys(errors or (text for _, text in self._messages)))
        self._messages.clear()
        return said

    def check(self, status: int, what: str) -> None:
        """Raise the error of a call that did not succeed; count a warning."""
        if status > WARNING:
            self.fail(status, what)
        self.fmi.warned += status == WARNING

    def fail(self, status: int, what: str, remedy: str = REMEDY) -> NoReturn:
        """Raise the error of a failed call."""
        said = self.quote_messages() or "no message"
        message = f"{self.name}: {what} returned {status_name(status)}: {said}; "
        if status == PENDING:
            raise ParticipantError(f"{message}{ASYNCHRONOUS}")
        message += remedy
        if status == FATAL:
            self.fatal = True
            raise LostParticipantError(message)
        raise RecoverableError(message)

    def fail_to_set(self, status: int) -> NoReturn:
        self.fail(status, "setting the inputs")

    def fail_to_follow(self, status: int) -> NoReturn:
        self.fail(status, "setting the derivatives of the inputs", NOT_FOLLOWED)

    def fail_to_read(self, status: int) -> NoReturn:
        self.fail(status, "reading the outputs")

    def fail_step(self, status: int, time: float, step: float) -> None:
        """Raise the error of a step that did not succeed; return if it was made after all."""
        if status != DISCARD:
            self.fail(status, f"step from t = {time:.9g} s by {step:g} s")
        self.refuse_discarded(time, step)

    def check_end(self, time: float, step: float) -> None:
        """Before compiled code makes a step: EndedError if the FMU asked for the end at that of another."""
        if self.fmi.ended_in and time > self.fmi.ended_in.pop():
            self.refuse_discarded(time, step)

    def refuse_discarded(self, time: float, step: float) -> None:
        """Raise the error of a discarded step, with the time that it reached; one that shorter steps cannot
        follow is a RecoverableError.

        A step that the FMU completed before it asked to end the simulation is valid: only the next one is
        refused.
        """
        what = f"{self.name}: step from t = {time:.9g} s by {step:g} s returned {status_name(DISCARD)}"
        said = self.quote_messages()
        reached = self.fmi.get_reached_time()
        if self.fmi.is_ended():
            when = time if reached is None else reached
            if when >= time + step * (1.0 - WHOLE):
                self.fmi.ended_in.append(time)
                self._messages.append((DISCARD, said))  # for that error
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
        said = said or "no message"
        if reached is None and not self.fmi.restorable:
            raise RecoverableError(f"{what}: {said}; {NOWHERE}")
        remedy = f"look at its inputs and parameters, {instead_of_discarded(self.name)}"
        raise DiscardedStepError(f"{what}: {said}; {remedy}", reached)
