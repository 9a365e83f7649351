"""Where each variable of an FMU lies: a value reference is a position in one vector of doubles.

The vector holds, one after the other,

    parameters | state start values | inputs and their three derivatives | outputs | energies | rates
    | x | u | t | s

of which the first three may be set and all up to the rates (of continuous outputs) are
variables of the FMU; the rest is the evolving data: state, inputs in effect, time, and how far along their
polynomials the inputs are. A copy of the vector is a copy of the slave. Internal states have no start value
to set.

Shipped inside every FMU, so it knows components only by their attributes.
"""

import re
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

# Taylor coefficients of an input: value and three derivatives, as the integrator takes them.
COEFFICIENTS = 4

ENERGIES = (
    ("stored_energy", "J", "energy stored in the component"),
    ("dissipated_power", "W", "power lost inside the component"),
    ("source_power", "W", "power of sources inside the component"),
)


@dataclass(frozen=True)
class Variable:
    """One scalar variable of an FMU. `kind` is Real, Integer, Boolean or Enumeration.

    `unit` is that of the quantity, also where the variable is its derivative of `derivative_order`. The rate
    of an output has that output's reference as `rate_of`. A state that `jumps` may do so at events. An
    element of a vector has the name of its structural size.
    """

    name: str
    reference: int
    kind: str
    causality: str
    variability: str
    start: float | None
    unit: str
    description: str
    quantity: Any = None
    derivative_order: int = 0
    rate_of: int | None = None
    state_start: bool = False
    jumps: bool = False
    size: str = ""


class Memory:
    """The positions of a component's variables."""

    def __init__(self, component: Any) -> None:
        self.component = component
        parameters, states = component.parameters.size, component.state.size
        # Which states have start values.
        self.started = [i for i, f in enumerate(component.state.fields) if not f.quantity.internal]
        inputs, outputs = component.inputs.size, component.outputs.size
        self.starts = parameters
        self.inputs = self.starts + len(self.started)
        self.outputs = self.inputs + COEFFICIENTS * inputs
        self.energies = self.outputs + outputs
        self.rates = self.energies + len(ENERGIES)
        # Which outputs have rates.
        self.rated = [i for i, f in enumerate(component.outputs.fields) if not f.quantity.discrete]
        self.end_of_variables = self.rates + len(self.rated)
        self.x = self.end_of_variables
        self.u = self.x + states
        self.t = self.u + inputs
        self.s = self.t + 1
        self.size = self.s + 1

    def beginning(self) -> Any:
        """The vector of a new instance."""
        component = self.component
        values = np.zeros(self.size)
        values[: self.starts] = component.parameters.start
        values[self.starts : self.inputs] = component.state.start[np.array(self.started, dtype=np.int64)]
        values[self.inputs : self.inputs + component.inputs.size] = component.inputs.start
        values[self.x : self.u] = component.state.start
        return values

    def states(self) -> tuple[Variable, ...]:
        """All states, in their places: hosts of native FMUs that integrate by themselves know the continuous
        ones."""
        fields = enumerate(self.component.state.fields, self.x)
        return tuple(_variable(f"state.{f.name}", i, "local", f) for i, f in fields)

    def motion(self) -> tuple[Variable, ...]:
        """The continuous states, and then their derivatives, which have places after all else."""
        states = [
            replace(v, jumps=self.component.events is not None)
            for v in self.states()
            if v.variability == "continuous" and not v.quantity.internal
        ]
        fields = self.component.state.fields
        places = [v.reference - self.x for v in states]
        rates = [_rate(fields[i], self.size + i, self.x + i, f"state.{fields[i].name}") for i in places]
        return (*states, *rates)

    def time(self) -> Variable:
        """The independent variable."""
        return Variable("time", self.t, "Real", "independent", "continuous", None, "s", "time")

    def indicators(self) -> tuple[Variable, ...]:
        """What falls below zero where an event happens, after the states' derivatives."""
        count = self.component.events.count if self.component.events else 0
        places = range(self.size + self.component.state.size, self.size + self.component.state.size + count)
        text = "an event happens where it falls below zero"
        return tuple(
            Variable(f"event_indicator[{i}]", place, "Real", "local", "continuous", None, "", text)
            for i, place in enumerate(places, 1)
        )

    def variables(self) -> tuple[Variable, ...]:
        """All variables in the order of their value references."""
        component = self.component
        found = [
            _variable(f.name, i, "parameter", f, "fixed" if f.quantity.discrete else "tunable")
            for i, f in enumerate(component.parameters.fields)
        ]
        for i, started in enumerate(self.started, self.starts):
            f = component.state.fields[started]
            variable = _variable(f.add_suffix("_start"), i, "parameter", f, "fixed")
            text = f"start of {f.name}: {variable.description}"
            found.append(replace(variable, description=text, state_start=True))
        for order in range(COEFFICIENTS):
            for i, f in enumerate(component.inputs.fields, self.inputs + order * component.inputs.size):
                found.append(_variable(f.name, i, "input", f) if order == 0 else _derivative(f, i, order))
        for i, f in enumerate(component.outputs.fields, self.outputs):
            found.append(_variable(f.name, i, "output", f))
        for i, (name, unit, text) in enumerate(ENERGIES, self.energies):
            found.append(Variable(name, i, "Real", "local", "continuous", None, unit, text))
        for i, rated in enumerate(self.rated, self.rates):
            field = component.outputs.fields[rated]
            found.append(_rate(field, i, self.outputs + rated, field.name, "output"))
        names = [v.name for v in found]
        if twice := sorted({name for name in names if names.count(name) > 1}):
            raise ValueError(f"{component.name}: more than one variable is called {', '.join(twice)}")
        return tuple(found)


def name_as_start_value(message: str) -> str:
    """A message on a state as one on the variable of its start: psi = ... becomes psi_start = ..."""
    return re.sub(r"^\w+", r"\g<0>_start", message)


def _variable(name: str, reference: int, causality: str, field: Any, variability: str = "") -> Variable:
    quantity = field.quantity
    kinds = {"Enumeration": quantity.choices, "Boolean": quantity.boolean, "Integer": quantity.count}
    return Variable(
        name,
        reference,
        next((kind for kind, given in kinds.items() if given), "Real"),
        causality,
        variability or ("discrete" if quantity.discrete else "continuous"),
        None if causality in ("output", "local") else field.start,
        quantity.unit,
        quantity.description,
        quantity,
        size=quantity.size,
    )


def _derivative(field: Any, reference: int, order: int) -> Variable:
    """The optional input for the derivative of an input; held when it stays zero."""
    text = f"optional: derivative {order} of {field.name} by time, for inputs that vary inside a step"
    plain = _variable(field.add_suffix(f"_der{order}"), reference, "input", field)
    return replace(plain, kind="Real", start=0.0, description=text, quantity=None, derivative_order=order)


def _rate(field: Any, reference: int, rate_of: int, name: str, causality: str = "local") -> Variable:
    plain = _variable(f"der({name})", reference, causality, field, "continuous")
    text = f"derivative of {field.name} by time"
    return replace(
        plain, kind="Real", start=None, description=text, quantity=None, derivative_order=1, rate_of=rate_of
    )
