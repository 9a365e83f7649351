"""The observer that records what is no number: strings and binary values of FMUs."""

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from models.core.quantities import Vector

from ..engine.coupling import Coupling
from ..engine.step import Step
from ..participants.protocol import SideChannel
from ..participants.third_party import ThirdPartyComponent
from ..store.json_codec import Plain

FORMULA = ("=", "+", "-", "@", "\t", "\r")
HEADER = ("time", "variable", "text")


def list_texts(components: Mapping[str, ThirdPartyComponent]) -> dict[str, list[str]]:
    """The outputs that are strings or binary values, by instance."""
    found = {
        name: component.about.list_texts("output")
        for name, component in components.items()
        if not component.about.integrated
    }
    return {name: texts for name, texts in found.items() if texts}


class TextRecorder:
    """Records the `texts` (by instance) in a CSV file: at the start, and where a macro step changes one.

    A text holds until the next line of its variable. Binary values are hexadecimal digits. A text that
    spreadsheets would take for a formula gets a ' in front.
    """

    def __init__(self, path: Path, texts: Mapping[str, Sequence[str]]) -> None:
        self._path, self._texts = path, texts
        self._sides: dict[str, SideChannel] = {}
        self._last: dict[str, str] = {}

    def watch(self, coupling: Coupling) -> None:
        units = dict(zip(coupling.wiring.names, coupling.participants, strict=True))
        for name in self._texts:
            side = units[name].abilities.side
            assert side is not None  # it has texts
            self._sides[name] = side

    def begin(self, names: Sequence[str]) -> None:
        self._file: Any = self._path.open("wb")
        self._write([HEADER])

    def observe(self, time: float, outputs: Callable[[], Vector], step: Step) -> None:
        rows = []
        for instance, names in self._texts.items():
            for name, text in zip(names, self._sides[instance].get_texts(names), strict=True):
                if self._last.get(variable := f"{instance}.{name}") != text:
                    self._last[variable] = text
                    # Spreadsheets would compute a text that begins so, or run its command.
                    shown = f"'{text}" if text.startswith(FORMULA) else text
                    rows.append((repr(float(time)), variable, shown))
        if rows:
            self._write(rows)

    def end(self, complete: bool, message: str) -> None:
        self._file.close()

    def state(self) -> dict[str, Plain]:
        return {"size": self._file.tell(), "last": dict(self._last)}

    def resume(self, names: Sequence[str], state: Mapping[str, Plain]) -> None:
        self._file = self._path.open("r+b")
        self._file.truncate(state["size"])
        self._file.seek(state["size"])
        self._last = dict(state["last"])

    def _write(self, rows: Sequence[Sequence[str]]) -> None:
        lines = io.StringIO()
        csv.writer(lines, lineterminator="\n").writerows(rows)
        self._file.write(lines.getvalue().encode())
        self._file.flush()
