"""Checkpoints: the evolving data of a coupled run between two macro steps, in one file.

First line: the format and the SHA-256 of the rest; then plain data as JSON: what the run is (`Identity`) and
its `state`. The file is replaced as a whole, so that a process killed while it writes leaves the checkpoint
before. The clock decides when a checkpoint is written, and nothing else: a run that is resumed ends with the
same numbers to the last bit.
"""

from __future__ import annotations

import contextlib
import hashlib
import math
import os
import time as clock
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, field
from importlib import metadata
from pathlib import Path
from typing import Any

from models.core.quantities import Vector

from ..engine.coupling import Coupling
from ..engine.observer import Observer
from ..errors import CannotSerializeError, CheckpointError, Command, MistakeError, Option, start_over
from ..participants.protocol import Participant
from ..store.atomic_write import write_whole
from ..store.json_codec import Plain, from_text, to_text

FORMAT = "tribocosim checkpoint 7"
# With another version of these the last bits may differ.
COMPUTING = ("tribocosim", "numpy", "scipy", "numba", "llvmlite")
# So they may with other code for the processor, which these choose.
CODE = ("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES", "NPY_DISABLE_CPU_FEATURES", "OPENBLAS_CORETYPE")
# Of the wall time at most, where a disk is slow or a state large.
SHARE = 0.01


@dataclass(frozen=True)
class Identity:
    """What a run is. With another of these it would not end with the same numbers.

    `machine` has the processor and what chooses code for it: another is no reason to refuse.
    """

    versions: Mapping[str, str]  # of the packages that compute
    scenario: str  # SHA-256 of the resolved scenario file
    fmus: Mapping[str, str]  # SHA-256 by instance
    machine: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, scenario: Path, fmus: Mapping[str, str]) -> Identity:
        """Of a run of the resolved scenario file with these FMUs, here and now."""
        versions = {name: metadata.version(name) for name in COMPUTING}
        import llvmlite.binding  # takes long

        machine = {"processor": llvmlite.binding.get_host_cpu_name()}
        machine |= {name: os.environ[name] for name in CODE if os.environ.get(name)}
        return cls(versions, hashlib.sha256(scenario.read_bytes()).hexdigest(), dict(fmus), machine)

    def compare_machines(self, found: Identity, out: Path) -> str:
        """What differs between this machine and that of the checkpoint `found` in `out`; empty if nothing."""
        differ = [
            f"{name} was {found.machine.get(name, 'not set')}, is {self.machine.get(name, 'not set')}"
            for name in ("processor", *CODE)
            if self.machine.get(name) != found.machine.get(name)
        ]
        if not differ:
            return ""
        return f"{out}: {', '.join(differ)}; the last digits may differ from those of a run without a stop"

    def check(self, found: Identity, out: Path) -> None:
        """CheckpointError unless `found`, of the checkpoint in `out`, is the same."""
        said = remedy = ""
        if found.scenario != self.scenario:
            said, remedy = f"{out / 'scenario.toml'}: is not what the run was begun with", "undo the change"
        elif differ := [name for name, own in self.versions.items() if found.versions.get(name) != own]:
            name, remedy = differ[0], "install that version"
            theirs = found.versions.get(name)
            said = f"{out}: the run was begun with {name} {theirs}, this is {self.versions[name]}"
        elif differ := [name for name, own in self.fmus.items() if found.fmus.get(name) != own]:
            name, remedy = differ[0], "give it that file"
            said = (
                f"components.{name}.participant: the FMU is not the one that the run was begun with "
                f"(SHA-256 {self.fmus[name][:16]}..., was {str(found.fmus.get(name))[:16]}...)"
            )
        if said:
            raise CheckpointError(said, remedy, start_over(out))


def write(path: Path, identity: Identity, state: Plain) -> None:
    """Replace the checkpoint at `path`, down to the disk."""
    text = to_text({"identity": asdict(identity), "state": state}).encode("ascii")
    line = f"{FORMAT} {hashlib.sha256(text).hexdigest()}\n".encode("ascii")
    write_whole(path, line + text)


def read(path: Path) -> tuple[Identity, Plain]:
    """What a checkpoint says; CheckpointError if it is damaged or of another format."""
    out = path.parent.parent
    try:
        line, _, text = path.read_bytes().partition(b"\n")
    except OSError as error:
        raise CheckpointError(f"{path}: cannot be read ({error.strerror})") from None
    known, _, digest = line.decode("ascii", "replace").rpartition(" ")
    if known != FORMAT:
        raise CheckpointError(f"{path}: is not a checkpoint of this version", start_over(out))
    if hashlib.sha256(text).hexdigest() != digest:
        raise CheckpointError(f"{path}: the checkpoint is damaged", start_over(out))
    try:
        content = from_text(text.decode("ascii"))
        return Identity(**content["identity"]), content["state"]
    except (ValueError, KeyError, TypeError) as error:
        raise CheckpointError(f"{path}: is not a checkpoint of a run ({error})", start_over(out)) from None


@contextlib.contextmanager
def fitting() -> Iterator[None]:
    """A state that does not fit what takes it is a CheckpointError."""
    try:
        yield
    except (LookupError, ValueError, TypeError) as error:
        if isinstance(error, MistakeError):
            raise
        remedy = "start it over with ", Command("run", (...,), (Option("overwrite", True),))
        raise CheckpointError(f"the checkpoint does not fit this run ({error!r})", remedy) from None


def find_refusal(participants: Iterable[Participant]) -> str:
    """Why the evolving data of these cannot be kept, so far as their abilities say it; empty if it can."""
    for each in participants:
        can = each.abilities
        if can.unserialisable or not can.restorable:
            reason = can.unserialisable or "the FMU does not come back to the state that it saved"
            return f"{each.name}: {reason}"
    return ""


def serialise_participants(participants: Mapping[str, Participant]) -> dict[str, bytes]:
    """The evolving data of each; CannotSerializeError where one cannot give it."""
    if refusal := find_refusal(participants.values()):
        raise CannotSerializeError(refusal)
    found = {}
    for name, participant in participants.items():
        saved = participant.save()
        try:
            found[name] = participant.to_bytes(saved)
        finally:
            participant.release(saved)
    return found


def restore_participants(participants: Mapping[str, Participant], states: Mapping[str, bytes]) -> None:
    """Go on from `serialise_participants`."""
    for name, participant in participants.items():
        saved = participant.from_bytes(states[name])
        try:
            participant.restore(saved)
        finally:
            participant.release(saved)


class Checkpoints(Observer):
    """Writes a checkpoint to `path` at the start, every `every` seconds of wall time, when the run is `asked`
    to stop, and at `stop_time`.

    Where a participant cannot be serialised there are none, and `say` is told why, before the first step.
    """

    def __init__(
        self,
        path: Path,
        identity: Identity,
        every: float,
        stop_time: float,
        asked: Callable[[], bool],
        say: Callable[[str], None],
    ) -> None:
        self._path, self._identity = path, identity
        self._every, self._stop = every, stop_time
        self._asked, self._say = asked, say
        self._due = 0.0

    def watch(self, coupling: Coupling) -> None:
        if refusal := find_refusal(coupling.participants):
            self._stop_writing(refusal)

    def attach(self, state: Callable[[], dict[str, Plain]]) -> None:
        self._state = state

    def observe(self, time: float, outputs: Callable[[], Vector], step: Any) -> None:
        if clock.monotonic() >= self._due or time >= self._stop or self._asked():
            self._write()

    def _write(self) -> None:
        began = clock.monotonic()
        try:
            write(self._path, self._identity, self._state())
        except CannotSerializeError as error:
            self._stop_writing(str(error))
            return
        now = clock.monotonic()
        self._due = now + max(self._every, (now - began) / SHARE)

    def _stop_writing(self, reason: str) -> None:
        self._say(f"no checkpoints: {reason}")
        self._due = self._stop = math.inf
        self._asked = lambda: False
