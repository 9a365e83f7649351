"""The process of one FMU: it gets messages from `InOwnProcess` by a pipe and answers by another.

At first the pipes are its standard input and output. The FMU then finds an empty standard input and prints
to standard error. The process ends when the messages do.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from models.core.quantities import Vector

from .. import c_output
from ..errors import RunError
from .fmu import FmuParticipant, open_here
from .messages import ADVANCE, CALL, DONE, FAILED, READ, TIMES, receive, send
from .opened_fmu import FmuSettings
from .protocol import BoundVariables

if TYPE_CHECKING:
    from .model_exchange.integrated import IntegratedFmu


class Server:
    """Carries out messages; the first one, instantiate, opens the FMU.

    Calls that it does not have itself are those of the participant.
    """

    unit: FmuParticipant | IntegratedFmu
    inputs: Vector
    rates: Vector
    every: Vector

    def __init__(self) -> None:
        self._states: dict[int, Any] = {}
        self._number = 0
        self._owners: list[Any] = [self]

    def carry_out(self, kind: bytes, content: bytes) -> bytes:
        """The answer to a message."""
        if kind == ADVANCE:
            self._set_inputs(content[TIMES.size :])
            self.unit.advance(*TIMES.unpack(content[: TIMES.size]))
            return self._get_outputs()
        if kind == READ:
            self._set_inputs(content)
            return self._get_outputs()
        assert kind == CALL
        return answer_call(content, *self._owners)

    def _set_inputs(self, values: bytes) -> None:
        if values:
            self.inputs.ravel()[:] = np.frombuffer(values)
            self.unit.write()

    def _get_outputs(self) -> bytes:
        """Rates of the outputs that are bound, and all outputs: the bound ones are among these."""
        if self.rates.size:
            self.unit.read()
        self.unit.read_all(self.every)
        return self.rates.tobytes() + self.every.tobytes()

    def instantiate(self, name: str, path: str, given: dict[str, Any], folder: str) -> None:
        if hasattr(self, "unit"):
            self.unit.close()
        self.unit = open_here(name, Path(path), FmuSettings(**given), Path(folder))
        self.every = np.zeros(len(given["outputs"]))
        self._owners = [self, self.unit, self.unit.abilities]

    def connect(self, inputs: list[str], rows: int, outputs: list[str], rated: bool) -> list[bool]:
        self.inputs = np.zeros((rows, len(inputs)))
        self.rates = np.zeros(len(outputs) if rated else 0)
        bound = BoundVariables(inputs, self.inputs, outputs, np.zeros(len(outputs)), self.rates)
        return [bool(one) for one in self.unit.connect(bound)]

    def find_states(self, names: list[str]) -> Any:
        derivatives = self.unit.abilities.derivatives
        return derivatives and derivatives.find_states(names)

    def save(self) -> int:
        return self._store_state(self.unit.save())

    def _store_state(self, state: Any) -> int:
        self._number += 1
        self._states[self._number] = state
        return self._number

    def restore(self, number: int) -> None:
        self.unit.restore(self._states[number])

    def release(self, number: int) -> None:
        self.unit.release(self._states.pop(number))

    def to_bytes(self, number: int) -> str:
        return self.unit.to_bytes(self._states[number]).hex()

    def from_bytes(self, data: str) -> int:
        return self._store_state(self.unit.from_bytes(bytes.fromhex(data)))


def answer_call(content: bytes, *owners: Any) -> bytes:
    """The answer to a call, by the first of the owners that has its method."""
    asked = json.loads(content)
    method = asked.pop("method")
    owner = next(one for one in owners if hasattr(one, method))
    found = getattr(owner, method)(**asked)
    return json.dumps(found.tolist() if isinstance(found, np.ndarray) else found).encode()


def main() -> None:
    """Serve one FMU."""
    serve(Server())


def serve(server: Any) -> NoReturn:
    """Answer messages by `server.carry_out` until standard input ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    itself = os.getpid()
    asked = os.fdopen(os.dup(0), "rb", buffering=0)
    answers = os.fdopen(os.dup(1), "wb", buffering=0)
    # The FMU must neither read the messages nor print among the answers.
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)
    c_output.write_lines_at_once()
    while True:
        try:
            kind, content = receive(asked)
        except EOFError:
            break
        try:
            answer = DONE, server.carry_out(kind, content)
        except Exception as error:
            known = type(error).__name__ if isinstance(error, RunError) else "ParticipantError"
            reached = getattr(error, "reached", None)
            said = {"kind": known, "message": str(error), "reached": reached}
            answer = FAILED, json.dumps(said).encode()
        if os.getpid() != itself:  # a copy, which the FMU has made by `fork`
            os._exit(0)
        send(answers, *answer)
    c_output.flush()
    sys.stdout.flush()
    os._exit(0)  # some FMUs abort when their library is unloaded
