"""The interface of an FMU's instance, for both versions of FMI."""

import ctypes
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Protocol

from models.core.quantities import Vector

from .description import Variable

# Of calls without success; one that FMI does not know, also a negative one, is above WARNING as well.
STATUS = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")
OK, WARNING, DISCARD, FATAL, PENDING = 0, 1, 2, 4, 5


def status_name(status: int) -> str:
    """The name of a status; of an unknown one, its number."""
    known = 0 <= status < len(STATUS)
    return STATUS[status] if known else f"{ctypes.c_int(status).value}, which is no status of FMI"


class FmiInstance(Protocol):
    """An instance. Calls that do not succeed raise, with the attribute `status`, but for those that return it
    or are given `fail`, which is called with it."""

    # Types of variables that `setter` and `getter` transfer.
    real_types: tuple[str, ...]
    # How many calls have returned a warning.
    warned: int
    # The start (s) of the step at whose end the FMU asked to end the simulation, if it did; set by `fail`.
    ended_in: list[float]

    def instantiate(self, log: Callable[[int, bytes], None]) -> None:
        """Make it; `log` gets the status and text of its messages."""
        ...

    def configure(self, sizes: Mapping[Variable, int]) -> None:
        """Before all else: set structural parameters; FMI 3.0 only."""
        ...

    def set_up(self, start_time: float, stop_time: float) -> None:
        """What comes before initialisation and the values that hold for it."""
        ...

    def enter_initialization(self, start_time: float, stop_time: float) -> None: ...

    def exit_initialization(self) -> None: ...

    def set(self, variables: Sequence[Variable], values: Iterable[float]) -> None:
        """Set these scalars: all of one type, or all elements of one array."""
        ...

    def set_text(self, variable: Variable, text: str) -> None:
        """Set a string, or a binary value that is given as hexadecimal digits."""
        ...

    def get_text(self, variable: Variable) -> str:
        """As `set_text`."""
        ...

    def bind_setter(self, references: Any, values: Vector, fail: Callable[[int], None]) -> Callable[[], None]:
        """A function that sets the variables of these references (unsigned int) to what is in `values`."""
        ...

    def bind_getter(self, references: Any, values: Vector, fail: Callable[[int], None]) -> Callable[[], None]:
        """As `setter`, the other way."""
        ...

    def bind_typed_getter(
        self, kind: str, references: Any, size: int, fail: Callable[[int], None]
    ) -> tuple[Any, Callable[[], None]]:
        """Memory for `size` values of variables of that type, no doubles, and a function that gets them."""
        ...

    def bind_input_derivatives(
        self, references: Any, orders: Any, values: Vector, fail: Callable[[int], None]
    ) -> Callable[[], int]:
        """A function that sets the inputs' derivatives of these orders (int) to what is in `values` and
        returns the status, OK or WARNING; for FMUs that say that they interpolate."""
        ...

    def bind_output_derivatives(
        self, references: Any, values: Vector, fail: Callable[[int], None]
    ) -> Callable[[], None]:
        """A function that gets the first derivatives of outputs by time into `values`, those of arrays whole;
        for FMUs that say that they give them, after initialisation."""
        ...

    def differentiate(self, unknown: Sequence[Variable], known: Variable) -> list[float]:
        """The derivatives of these unknown scalars by a known one; for FMUs that say that they give them."""
        ...

    def bind_step(self, fail: Callable[[int, float, float], None]) -> Callable[[float, float], None]:
        """A function that steps from a time by a length; `fail` gets these as well, after the status.

        To ask for the end of the simulation is to discard the step (see `ended`), and so is every step that
        begins after the one that it `ended_in`. Where `fail` returns, the step is made.
        """
        ...

    def get_reached_time(self) -> float | None:
        """Last successful time after a discarded step, where the FMU says it."""
        ...

    def is_ended(self) -> bool:
        """After a discarded step: whether the FMU asks to end the simulation."""
        ...

    def get_addresses(self) -> dict[str, int]:
        """What compiled code needs to call the functions itself (see `compiled`); empty: it cannot."""
        ...

    def save(self, state: ctypes.c_void_p) -> int: ...

    def restore(self, state: ctypes.c_void_p) -> int: ...

    def release(self, state: ctypes.c_void_p) -> int: ...

    def serialise(self, state: ctypes.c_void_p) -> bytes: ...

    def deserialise(self, data: bytes) -> ctypes.c_void_p: ...

    def terminate(self) -> None: ...

    def free(self) -> None: ...
