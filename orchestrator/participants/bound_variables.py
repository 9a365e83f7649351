"""An FMU's inputs and outputs bound to memory, with derivatives of inputs and rates of outputs."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from models.core.errors import suggestion
from models.core.quantities import Vector

from ..errors import ParticipantError
from .binding import VariableBinding
from .capabilities import name_derivative, signal_degrees
from .description import REALS, Description, Variable
from .failures import ErrorReporter
from .fmi_instance import ArrayLayout, FmiInstance
from .held_inputs import at_end, mean


@dataclass
class OpenFmu:
    """What the parts of an FMU's participant share. `stepping`: it is initialised."""

    description: Description
    fmi: FmiInstance
    errors: ErrorReporter
    stepping: bool = False

    def find(self, name: str) -> Variable:
        """The variable of that name; ParticipantError if there is none."""
        known = self.description.variables
        if name not in known:
            raise ParticipantError(
                f"{self.errors.name}: the FMU has no variable {name!r}; {suggestion(name, known)}"
            )
        return known[name]

    def bind(self, names: Iterable[str], fixed: Mapping[str, float] | None = None) -> VariableBinding:
        """These variables, `fixed` as `VariableBinding` has it."""
        known, found = self.description.variables, map(self.find, names)
        return VariableBinding(self.fmi, known, found, fixed, self.errors.name)

    def is_real(self, name: str) -> bool:
        """Whether fast calls, and those of derivatives, transfer it."""
        return self.find(name).type in self.fmi.real_types


class BoundInputs:
    """Inputs and their derivatives, which are row 0 and the other rows of `memory`.

    A derivative goes to the FMU's input `<input>_der1`, `_der2`, or else by the standard's call
    (canInterpolateInputs of FMI 2.0) to the inputs `called`, numbers of columns. Others are not given.
    `picked` are rows and columns of what goes to variables, `write` transfers all. `fixed` has the values
    of inputs that nothing drives. `held` marks those of `picked` that the FMU holds over a step (see
    `held_inputs`). `follows` marks what of `memory` the FMU takes; which orders by call, it says only when it
    is called.
    """

    def __init__(
        self, fmu: OpenFmu, names: Sequence[str], memory: Vector, fixed: Mapping[str, float]
    ) -> None:
        self._fmu, self._memory = fmu, memory
        known = fmu.description.variables
        found, rows, columns = [], [], []
        for order in range(len(memory)):
            for column, name in enumerate(names):
                full = name_derivative(name, order) if order else name
                if order == 0 or (full in known and full not in names):
                    found.append(full)
                    rows.append(order)
                    columns.append(column)
        self.picked = np.array(rows, dtype=np.int64), np.array(columns, dtype=np.int64)
        degrees = np.array(signal_degrees(fmu.description, names), dtype=np.int64)
        self.held = degrees[self.picked[1]] == 0 if len(memory) > 1 else np.zeros(len(found), dtype=np.bool_)
        self.binding = fmu.bind(found, fixed)
        # Where every derivative is taken, the bound memory is handed over as it is.
        whole = len(found) == memory.size and self.binding.plain
        self.binding.bind_set(fmu.errors.fail_to_set, memory.ravel() if whole else None)
        self.write = self.binding.transfer if whole else self._write_picked
        self.called = [
            column
            for column, name in enumerate(names)
            if fmu.description.interpolates
            and len(memory) > 1
            and fmu.is_real(name)
            and not known[name].stepwise
            and name_derivative(name, 1) not in known
        ]
        self.follows = np.zeros(memory.shape, dtype=np.bool_)
        self.follows[self.picked] = True
        self.follows[:, self.called] = True
        if self.called:
            self._call_derivatives([fmu.find(names[column]).reference for column in self.called])

    def _write_picked(self) -> None:
        self.binding.set_values(self._memory[self.picked])

    def write_means(self, step: float) -> None:
        """Give held inputs the mean of their signal over the step that begins now."""
        values = self._memory[self.picked]
        values[self.held] = mean(self._memory, self.picked[1][self.held], step)
        self.binding.set_values(values)

    def write_ends(self, step: float) -> None:
        """Give all inputs what their signals are at the end of the step just made."""
        values = self._memory[self.picked]
        for row in range(len(self._memory)):
            of_row = self.picked[0] == row
            values[of_row] = at_end(self._memory, row, self.picked[1][of_row], step)
        self.binding.set_values(values)

    def _call_derivatives(self, inputs: Sequence[int]) -> None:
        """Have derivatives of the inputs of these references set by the standard's call.

        Only by a warning an FMU says that it does not take an order, and then it may ignore the whole call.
        So each order has a call of its own, and higher ones than it takes are not sent again.
        """
        columns, memory, fmu, write = self.called, self._memory, self._fmu, self.write
        slopes = np.zeros((len(memory) - 1, len(columns)))
        references = np.array(inputs, dtype=np.uintc)
        sends = [
            fmu.fmi.bind_input_derivatives(
                references, np.full(len(columns), order, dtype=np.intc), own, fmu.errors.fail_to_follow
            )
            for order, own in enumerate(slopes, 1)
        ]

        def write_all() -> None:
            write()
            if fmu.stepping:  # before that the standard has no such call
                slopes[:] = memory[1:, columns]
                for order, send in enumerate(sends, 1):
                    if send() and order > 1:
                        del sends[order - 1 :]
                        self.follows[order:, columns] = False
                        break

        self.write = write_all


class BoundOutputs:
    """Outputs in `values`, and in `rates` their rates, if that is not empty.

    Rates are those of outputs for which the FMU declares an output or local variable to be their
    `derivative`, which go with the outputs in one call (the outputs `rated`), or which it gives by the
    standard's call (`called`), and of discrete outputs: zero. `given` says for each output whether its rate
    is given, `read` transfers all.
    """

    def __init__(self, fmu: OpenFmu, names: Sequence[str], values: Vector, rates: Vector) -> None:
        self._fmu, self._values, self._rates = fmu, values, rates
        derivatives = _find_derivatives(fmu.description) if rates.size else {}
        rated = [i for i, name in enumerate(names) if name in derivatives]
        self.rated = np.array(rated, dtype=np.int64)
        self.binding = fmu.bind([*names, *(derivatives[names[i]] for i in rated)])
        direct = self.binding.plain and not rated
        self.binding.bind_get(fmu.errors.fail_to_read, values if direct else None)
        self.read = self.binding.transfer if direct else self._read_with_rates
        self.called: list[int] = []
        self.given = [False] * len(names)
        if not rates.size:
            return
        wanted = [fmu.find(name) for name in names]
        still = [v.stepwise for v in wanted]
        rates[still] = 0.0
        known = [name in derivatives or is_still for name, is_still in zip(names, still, strict=True)]
        if fmu.description.gives_rates:
            self.called = [i for i, name in enumerate(names) if not known[i] and fmu.is_real(name)]
        if self.called:
            self._call_rates(ArrayLayout(wanted[i] for i in self.called))
        self.given = [is_known or i in self.called for i, is_known in enumerate(known)]

    def _read_with_rates(self) -> None:
        found, count = self.binding.get_values(), self._values.size
        self._values[:] = found[:count]
        self._rates[self.rated] = found[count:]

    def _call_rates(self, layout: ArrayLayout) -> None:
        """Have rates got by the standard's call."""
        references, found = np.array(layout.references, dtype=np.uintc), np.zeros(layout.size)
        fmu, read = self._fmu, self.read
        get = fmu.fmi.bind_output_derivatives(references, found, fmu.errors.fail_to_read)

        def read_all() -> None:
            read()
            if fmu.stepping:  # before that the standard has no such call
                get()
                self._rates[self.called] = found[layout.places]

        self.read = read_all


def _find_derivatives(description: Description) -> dict[str, str]:
    """The variables that the FMU declares to be derivatives of others, by these."""
    return {
        v.derivative: v.name
        for v in description.variables.values()
        if v.derivative and v.type in REALS and v.causality in ("output", "local")
    }
