"""The process of an FMU's equations: it answers what `EquationsInOwnProcess` asks."""

from pathlib import Path
from typing import Any

import numpy as np

from ..messages import ADVANCE, CALL, READ
from ..opened_fmu import FmuSettings
from ..process import answer_call, serve
from .equations import ExchangeFmu


class Server:
    """Carries out messages; the first one, instantiate, opens the FMU."""

    equations: ExchangeFmu

    def carry_out(self, kind: bytes, content: bytes) -> bytes:
        """The answer to a message."""
        if kind == ADVANCE:
            t, *rest = np.split(np.frombuffer(content), [1, 1 + self.equations.states])
            return self.equations.outputs(float(t[0]), *rest).tobytes()
        if kind == READ:
            return self.equations.rate().tobytes()
        assert kind == CALL
        return answer_call(content, self, getattr(self, "equations", None))

    def instantiate(
        self, name: str, path: str, given: dict[str, Any], folder: str, inputs: list[str]
    ) -> None:
        self.equations = ExchangeFmu(name, Path(path), FmuSettings(**given), inputs, Path(folder))

    def get_sizes(self) -> list[int]:
        return [self.equations.states, self.equations.indicators]


def main() -> None:
    """Serve one FMU's equations."""
    serve(Server())
