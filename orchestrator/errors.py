"""Errors of a run. Each message names the thing, what was seen and the remedy."""

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from models.core.errors import MistakeError as MistakeError
from models.core.errors import RunError as RunError
from models.core.remedies import Command as Command
from models.core.remedies import ExplainedError as ExplainedError
from models.core.remedies import Option as Option
from models.core.remedies import Set as Set
from models.core.remedies import Words as Words
from models.core.remedies import in_command_line as in_command_line
from models.core.remedies import join as join
from models.core.remedies import name_source as name_source

FEW = 12  # names that are read at a glance


def find_near(name: str, known: Iterable[str]) -> list[str]:
    """The known names like it: none is more than twice as far as the nearest, by difflib's measure."""
    close = difflib.get_close_matches(name, known)
    far = [1.0 - difflib.SequenceMatcher(None, one, name).ratio() for one in close]
    return [one for one, away in zip(close, far, strict=True) if away <= 2.0 * far[0]]


def one_of(names: Iterable[str], given: object = "") -> str:
    """The end of a message about a choice: the likeliest names, and all of them where they are few."""
    known, text = list(names), str(given)[:100].lower()
    close = find_near(text, known) or [n for n in known if len(text) > 2 and text in n][:3]
    if close and len(known) > FEW:
        return f"did you mean {' or '.join(close)}?"
    more = f" and {len(known) - FEW} more" if len(known) > FEW else ""
    text = f"must be one of {', '.join(known[:FEW])}{more}"
    return f"did you mean {close[0]}? It {text}" if close else text


def instead_of_discarded(name: str) -> str:
    """The remedies for a step that participant `name` discarded."""
    return f"reduce macro_step, use [step_control], or raise components.{name}.retries"


@dataclass(frozen=True)
class Fault:
    """A mistake at a `place`, keys of a file ("": all of it), from which `said` goes on: ": missing".

    It was made in `source`, a file or an option.
    """

    place: str
    said: Words
    remedy: Words = ""
    source: str | Option = ""

    @classmethod
    def parse(cls, place: str, text: str) -> "Fault":
        """Of a text that has its remedy after a semicolon."""
        said, _, remedy = text.partition("; ")
        return cls(place, said, remedy)

    @property
    def words(self) -> Words:
        said = self.said if isinstance(self.said, tuple) else (self.said,)
        if not self.place and isinstance(said[0], str):
            said = said[0].removeprefix(": "), *said[1:]
        words = self.place, *said, *(("; ", self.remedy) if self.remedy else ())
        return name_source(self.source, words) if self.source else words


def list_faults(faults: Iterable[Fault]) -> Words:
    """A line for each."""
    return tuple(part for i, fault in enumerate(faults) for part in ("\n" * (i > 0), fault.words))


REPLACE: Words = ("replace it with ", Option("overwrite", True))


def another(option: str = "out") -> Words:
    """The remedy for an option whose value cannot be taken."""
    return "choose another ", Option(option)


def start_over(out: Path) -> Words:
    """The remedy for a run in `out` that cannot go on."""
    given = Option("out", out), Option("overwrite", True)
    return "start over with ", Command("run", (out / "scenario.toml",), given)


class ParticipantError(RunError):
    """A participant refused a call, failed, or gave values that are not numbers."""


class RecoverableError(ParticipantError):
    """The participant failed (fmi2Error), but `restore` makes it usable again; a shorter step may help.

    Before `restore` no other call but `close` is allowed.
    """


class DiscardedStepError(RecoverableError):
    """The participant discarded a step (fmi2Discard); a shorter one may help.

    `reached` is the time (s) that it has arrived at, from which it can go on without `restore`: the
    step's start where nothing has happened, or a time inside the step. None where it does not say. The
    message begins with the participant's name.
    """

    def __init__(self, message: Words, reached: float | None = None) -> None:
        super().__init__(message)
        self.reached = reached

    @property
    def participant(self) -> str:
        return str(self).partition(":")[0]


class NotFiniteError(RecoverableError):
    """A participant gave values that are not numbers, or are infinite."""


class RefusedError(ParticipantError):
    """A participant could not be made or initialised; nothing has been run."""


class CannotSerializeError(ParticipantError):
    """A participant cannot give its evolving data as bytes."""


class LostParticipantError(ParticipantError):
    """No call of the participant is allowed any more (fmi2Fatal)."""


class StalledError(LostParticipantError):
    """A call of the participant took longer than it may (`call_time_limit`)."""


class EndedError(ParticipantError):
    """A participant asks to end the simulation (fmi2Terminated, terminateSimulation of FMI 3).

    `reached` is the time (s) that it has arrived at; its outputs are those of that time.
    """

    def __init__(self, message: Words, reached: float) -> None:
        super().__init__(message)
        self.reached = reached

    def inside(self, time: float) -> bool:
        """Whether it came further than `time` (s), the start of its step."""
        return self.reached - time > 1e-12 * abs(time)  # more than a sum of steps may be off


class UnstableCouplingError(RunError):
    """Exchanged values run away from their own prediction: the macro step is too large for the master."""


class NonConvergenceError(RunError):
    """The iteration of a macro step did not reach its tolerance."""


class CheckpointError(MistakeError):
    """What a run has left, from which it cannot go on."""


class IncompleteError(RunError):
    """A run that did not come to its end; `results` are those of what it recorded."""

    def __init__(self, message: Words, results: Mapping[str, float]) -> None:
        super().__init__(message)
        self.results = results
