"""An FMU that is unpacked and instantiated: what its participants of each kind share.

Its library is loaded without a change of the working folder, which all threads share.
"""

import atexit
import contextlib
import ctypes
import os
import shutil
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

import fmpy.fmi1
from fmpy import extract

from models.compile.temporary import TemporaryFolder

from ..errors import CannotSerializeError, ParticipantError, RefusedError
from .binding import find_array
from .bound_variables import OpenFmu
from .description import CO_SIMULATION, read_description
from .failures import ErrorReporter
from .fmi_instance import FmiInstance

_lock = threading.Lock()


@contextlib.contextmanager
def stay_in_folder() -> Iterator[None]:
    """fmpy goes into the library's folder to load it, and stays there where that fails.

    Only Windows looks there for what the library needs. Elsewhere other threads would write files there.
    """
    with _lock:
        if os.name == "nt":
            with contextlib.chdir("."):
                yield
            return
        fmpy.fmi1.os = _StayingOs()
        try:
            yield
        finally:
            fmpy.fmi1.os = os


class _StayingOs:
    """The module `os`, whose `chdir` does nothing."""

    def __getattr__(self, name: str) -> Any:
        return getattr(os, name)

    def chdir(self, path: str) -> None:
        pass


@dataclass(frozen=True)
class FmuSettings:
    """What a run wants of an FMU, by the names of its variables.

    `outputs` are to be recorded. `values` are those of parameters and starts, `inputs` those of inputs that
    nothing drives, `strings` those of strings and binary values, `sizes` those of structural parameters.
    It takes part by `interface`.
    """

    outputs: Sequence[str]
    values: Mapping[str, float] = field(default_factory=dict)
    inputs: Mapping[str, float] = field(default_factory=dict)
    strings: Mapping[str, str] = field(default_factory=dict)
    interface: str = CO_SIMULATION
    sizes: Mapping[str, int] = field(default_factory=dict)


class OpenedFmu:
    """The FMU at `path`; `close` deletes where it is unpacked (`folder`).

    `instances` are the classes of its instance, by the version of FMI.
    """

    instances: ClassVar[Mapping[str, Any]]

    def __init__(self, name: str, path: Path, settings: FmuSettings, folder: Path | None = None) -> None:
        self.name, self._settings = name, settings
        self._errors = ErrorReporter(name)
        self._instantiated = self._ended = False
        self._delete: Callable[[], None] = lambda: None  # what was unpacked for it
        try:
            description = read_description(path, settings.interface, settings.sizes)
            if folder is None and description.is_own:
                self._folder = _unpack_own(path)
            else:
                if folder is None:
                    made = TemporaryFolder()
                    folder, self._delete = made.path, made.delete
                else:
                    self._delete = partial(shutil.rmtree, folder, ignore_errors=True)
                self._folder = str(folder)
                extract(path, self._folder)
        except Exception as error:
            self._delete()
            raise ParticipantError(f"{name}: {path} {error}") from None
        try:
            with stay_in_folder():
                self._fmi: FmiInstance = self.instances[description.version](name, description, self._folder)
                self._errors.fmi = self._fmi
                self._fmi.instantiate(self._errors.log)
            self._instantiated = True
        except Exception as error:
            self.close()
            raise RefusedError(
                f"{name}: instantiate: {self._errors.quote_messages() or error}; {path} cannot be used as it "
                "is: its library may be damaged or not belong to its modelDescription.xml (guid, "
                "instantiationToken), or lack what it needs on this machine; give another file"
            ) from None
        except BaseException:
            self.close()
            raise
        self._fmu = OpenFmu(description, self._fmi, self._errors)

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Enter initialisation mode, with all values that the settings have."""
        with self._errors.name_errors("initialise"):
            if self._settings.sizes:
                self._fmi.configure({self._fmu.find(n): s for n, s in self._settings.sizes.items()})
            self._fmi.set_up(start_time, stop_time)
            self._assign(self._settings.values)
            for name, text in self._settings.strings.items():
                self._fmi.set_text(self._fmu.find(name), text)
            if self._fmu.description.version == "1.0":  # there, what is given later has no effect on it
                self._assign(self._settings.inputs)
            self._fmi.enter_initialization(start_time, stop_time)
            self._assign(self._settings.inputs)

    def finish_initialisation(self) -> None:
        """Leave initialisation mode."""
        with self._errors.name_errors("initialise"):
            self._fmi.exit_initialization()
        self._fmu.stepping = True

    def set_inputs(self, values: Mapping[str, float]) -> None:
        with self._errors.name_errors("setting the inputs"):
            self._assign(values)

    def _assign(self, values: Mapping[str, float]) -> None:
        """Set variables by name; of an array that is named in part the other elements start as they do."""
        given = {self._fmu.find(name).memory: value for name, value in values.items()}
        done: set[tuple[str, int]] = set()
        for name in values:
            variable = self._fmu.find(name)
            if (key := variable.memory[:2]) not in done:
                done.add(key)
                whole = find_array(self._fmu.description.variables, variable)
                self._fmi.set(whole, [given.get(v.memory, v.start or 0.0) for v in whole])

    def save(self) -> Any:
        if not self._fmu.description.restorable:
            raise ParticipantError(
                f"{self.name}: the FMU cannot save its state (canGetAndSetFMUstate = false); take the master "
                "jacobi or gauss_seidel with steps of fixed length"
            )
        state = ctypes.c_void_p()
        self._errors.check(self._fmi.save(state), "saving the state")
        return state

    def restore(self, saved: Any) -> None:
        self._errors.check(self._fmi.restore(saved), "restoring the state")

    def to_bytes(self, saved: Any) -> bytes:
        if reason := self._fmu.description.unserialisable:
            raise CannotSerializeError(f"{self.name}: {reason}")
        with self._errors.name_errors("serialising the state"):
            return self._fmi.serialise(saved)

    def from_bytes(self, data: bytes) -> Any:
        with self._errors.name_errors("taking a serialised state"):
            return self._fmi.deserialise(data)

    def release(self, saved: Any) -> None:
        self._errors.check(self._fmi.release(saved), "freeing a saved state")

    def warnings(self) -> tuple[int, str]:
        """How many there were, by status or by message, and the first message."""
        return max(self._fmi.warned, self._errors.warnings), self._errors.first_warning

    def terminate(self) -> None:
        """End the simulation, which `close` does silently; no call but that may follow."""
        self._ended = True
        with self._errors.name_errors("terminate"):
            self._fmi.terminate()

    def close(self) -> None:
        # After fmi2Fatal the standard allows no call at all; the instance is given up.
        if self._instantiated and not self._errors.fatal:
            with contextlib.suppress(Exception):
                if not self._ended:
                    self._fmi.terminate()
            with contextlib.suppress(Exception):
                self._fmi.free()
        self._instantiated = False
        self._delete()


_own: dict[tuple[Path, int, int], TemporaryFolder] = {}


def _unpack_own(path: Path) -> str:
    """The folder of one of our FMUs, for all instances in this process: a Python FMU's library cannot be
    unloaded, and each copy would stay."""
    found = path.stat()
    key = path.absolute(), found.st_mtime_ns, found.st_size
    if key not in _own or not (_own[key].path / "modelDescription.xml").exists():  # or it was tidied away
        folder = TemporaryFolder()
        atexit.register(folder.delete)
        extract(path, folder.path)
        _own[key] = folder
    return str(_own[key].path)
