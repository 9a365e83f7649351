"""What a master needs of a participant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Protocol, runtime_checkable

from models.core.quantities import Vector

from .compiled import CompiledCalls


class BoundVariables(NamedTuple):
    """The exchanged variables of a participant, and the memory that they are bound to.

    `inputs[k]` holds the k-th time derivative of each connected input at the time of the next `advance`
    (row 0 the value). `rates`, as long as `outputs`, takes their time derivatives; of length 0, none are
    wanted. They are those along the motion with the inputs' slopes in effect: after `write` row 1 of
    `inputs`, after `advance` the slopes at its end. Rates that are not given stay as they are.
    """

    input_names: Sequence[str]
    inputs: Vector
    output_names: Sequence[str]
    outputs: Vector
    rates: Vector


@runtime_checkable
class GivesWarnings(Protocol):
    """A participant that counts the warnings of an FMU."""

    def warnings(self) -> tuple[int, str]:
        """How many there were, and the first message."""
        ...


class Participant(Protocol):
    """One simulation unit.

    Order of calls: `connect`, `initialise`, then any of the rest, `close` last. Memory that `connect` is
    given is kept: `inputs` is what the next `advance` or `read` sees after `write`, and `read` fills
    `outputs` and `rates`. One with events, clocks or texts has an attribute `side` (see `side_channel`).
    """

    name: str

    @property
    def restorable(self) -> bool:
        """Whether `save` and `restore` are possible; final once the start is proven (see `proven`)."""
        ...

    def signal_degrees(self, input_names: Sequence[str]) -> Sequence[int]:
        """The degree of the polynomial in time that it follows, for each input; 0: it holds the value."""
        ...

    def connect(self, bound: BoundVariables) -> Sequence[bool]:
        """Bind the exchanged variables; for each output, whether its rate will be given."""
        ...

    def compiled_calls(self) -> CompiledCalls | str:
        """After `connect`: the calls that compiled code can make itself, or why it cannot."""
        ...

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Apply parameters, start values and constant inputs; afterwards outputs can be read."""
        ...

    def finish_initialisation(self) -> None:
        """Initial inputs and outputs are consistent; time may advance now."""
        ...

    def set_inputs(self, values: Mapping[str, float]) -> None:
        """Between steps: other values of inputs that nothing drives, by name."""
        ...

    def write(self) -> None:
        """Take over the bound inputs."""
        ...

    def advance(self, time: float, step: float) -> None:
        """Advance from `time` to `time + step`; a RecoverableError may be tried again."""
        ...

    def read(self) -> None:
        """Fill the bound outputs and the rates that are given."""
        ...

    def read_all(self, values: Vector) -> None:
        """Fill `values` with all outputs, in the order of the component's output layout."""
        ...

    def save(self) -> Any:
        """The complete evolving data; valid until `release`."""
        ...

    def restore(self, saved: Any) -> None:
        """Back to what `save` returned, bit for bit."""
        ...

    def to_bytes(self, saved: Any) -> bytes:
        """What `save` returned, for another process; CannotSerializeError if that is not possible."""
        ...

    def from_bytes(self, data: bytes) -> Any:
        """What `to_bytes` was given by a participant of the same kind; to be released as if saved here."""
        ...

    def release(self, saved: Any) -> None:
        """The saved data is no longer needed."""
        ...

    def close(self) -> None:
        """Free everything; calling it twice does no harm."""
        ...


@runtime_checkable
class GivesDerivatives(Protocol):
    """An FMU in this process or another, which may give directional derivatives."""

    def get_followed(self) -> Any:
        """After `connect`: which of the bound `inputs` it takes, values and derivatives."""
        ...

    def find_states(self, names: Sequence[str]) -> Sequence[tuple[str, str, float]] | None:
        """Its states, each with the name of its derivative by time and its nominal size; None unless
        directional derivatives by and of these variables and the states are its linearisation."""
        ...

    def jacobian(self, unknown: Sequence[str], known: Sequence[str]) -> Vector:
        """d unknown / d known (rows x columns), at the present point, by directional derivatives."""
        ...
