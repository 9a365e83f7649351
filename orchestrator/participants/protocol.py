"""What a master needs of a participant."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

from models.core.quantities import Vector

from .compiled_calls import CompiledCalls


def uncounted(failed: bool) -> None:
    """Of a participant whose steps nobody counts."""


class BoundVariables(NamedTuple):
    """The exchanged variables of a participant, and the memory that they are bound to.

    `inputs[k]` holds the k-th time derivative of each connected input at the time of the next `advance`
    (row 0 the value). `rates`, as long as `outputs`, takes their time derivatives; of length 0, none are
    wanted. They are those along the motion with the inputs' slopes in effect: after `write` row 1 of
    `inputs`, after `advance` the slopes at its end. Rates that are not given stay as they are.
    `tried(failed)` is called for each step that the participant tries of its own within a macro step.
    """

    input_names: Sequence[str]
    inputs: Vector
    output_names: Sequence[str]
    outputs: Vector
    rates: Vector
    tried: Callable[[bool], None] = uncounted


class SideChannel(Protocol):
    """Events, clocks and texts, between steps. `has_events`: there may be events at times of its own, or
    clocks."""

    has_events: bool

    def next_event(self) -> float:
        """When something is due next (s); infinite if nothing is known."""

    def handle(self, time: float, clocks: Sequence[str]) -> list[str] | None:
        """Handle what is due at `time`, the present, with these triggered input clocks ticking; the output
        clocks that tick then, or None if nothing is due."""

    def get_texts(self, names: Sequence[str]) -> list[str]:
        """Strings, and binary values as hexadecimal digits."""

    def set_texts(self, values: Mapping[str, str]) -> None:
        """As `get_texts`, for inputs."""


class Derivatives(Protocol):
    """The directional derivatives of an FMU."""

    def get_followed(self) -> Any:
        """After `connect`: which of the bound `inputs` it takes, values and derivatives."""

    def find_states(self, names: Sequence[str]) -> Sequence[tuple[str, str, float]] | None:
        """Its states, each with the name of its derivative by time and its nominal size; None unless
        directional derivatives by and of these variables and the states are its linearisation."""

    def jacobian(self, unknown: Sequence[str], known: Sequence[str]) -> Vector:
        """d unknown / d known (rows x columns), at the present point, by directional derivatives."""


def no_warnings() -> tuple[int, str]:
    """Of a participant that gives none."""
    return 0, ""


@dataclass(frozen=True)
class Abilities:
    """What a participant can do; final after its proof.

    `restorable`: it can save and restore its state. `variable_step`: it takes steps of any length.
    `divisible`: several short steps bring it to the same state as a long one. `side` has its events, clocks
    and texts, `derivatives` its directional derivatives. `warnings()` is the number of warnings of the FMU,
    and the first message. `prove(time)`, called after initialisation, tries whether the state is restored and
    outputs depend on inputs as declared, and returns what is not so, a line each. `unserialisable`: why
    another process cannot use what it saves, or an empty text.
    """

    restorable: bool = True
    variable_step: bool = True
    divisible: bool = True
    side: SideChannel | None = None
    derivatives: Derivatives | None = None
    warnings: Callable[[], tuple[int, str]] = no_warnings
    prove: Callable[[float], str] | None = None
    unserialisable: str = ""


class Participant(Protocol):
    """One simulation unit.

    Order of calls: `connect`, `initialise`, then any of the rest, `close` last. Memory that `connect` is
    given is kept: `inputs` is what the next `advance` or `read` sees after `write`, and `read` fills
    `outputs` and `rates`.
    """

    name: str

    @property
    def abilities(self) -> Abilities: ...

    def signal_degrees(self, input_names: Sequence[str]) -> Sequence[int]:
        """The degree of the polynomial in time that it follows, for each input; 0: it holds the value."""

    def connect(self, bound: BoundVariables) -> Sequence[bool]:
        """Bind the exchanged variables; for each output, whether its rate will be given."""

    def compiled_calls(self) -> CompiledCalls:
        """After `connect`: the calls that compiled code can make itself; else NotCompiledError."""

    def initialise(self, start_time: float, stop_time: float) -> None:
        """Apply parameters, start values and constant inputs; afterwards outputs can be read."""

    def finish_initialisation(self) -> None:
        """Initial inputs and outputs are consistent; time may advance now."""

    def set_inputs(self, values: Mapping[str, float]) -> None:
        """Between steps: other values of inputs that nothing drives, by name."""

    def write(self) -> None:
        """Take over the bound inputs."""

    def advance(self, time: float, step: float) -> None:
        """Advance from `time` to `time + step`; a RecoverableError may be tried again."""

    def read(self) -> None:
        """Fill the bound outputs and the rates that are given."""

    def read_all(self, values: Vector) -> None:
        """Fill `values` with all outputs, in the order of the component's output layout."""

    def save(self) -> Any:
        """The complete evolving data; valid until `release`."""

    def restore(self, saved: Any) -> None:
        """Back to what `save` returned, bit for bit."""

    def to_bytes(self, saved: Any) -> bytes:
        """What `save` returned, for another process; CannotSerializeError if it has not the ability."""

    def from_bytes(self, data: bytes) -> Any:
        """What `to_bytes` was given by a participant of the same kind; to be released as if saved here."""

    def release(self, saved: Any) -> None:
        """The saved data is no longer needed."""

    def close(self) -> None:
        """Free everything; calling it twice does no harm."""
