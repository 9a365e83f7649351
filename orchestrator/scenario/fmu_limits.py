"""Limits that the FMU files of a scenario set on signals and steps."""

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any

from models.core.quantities import Layout, Quantity
from models.core.system import Connection, Port

from ..participants.capabilities import HIGHEST, find_highest_degrees, name_derivative, signal_degrees
from ..participants.description import Description, DescriptionError
from ..participants.third_party import ThirdPartyComponent
from . import Scenario
from .side_lines import is_side_line


class FmuLimits:
    """The limits of the given .fmu files, by their descriptions; unreadable files are left out."""

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self._about: dict[str, Description] = {}
        for name, table in scenario.components.items():
            if table.file:
                try:
                    self._about[name] = table.describe()
                except (DescriptionError, OSError):
                    continue
        self._components = components = {name: table.resolve() for name, table in scenario.components.items()}
        self._connections = [
            Connection(*(Port(*end.split(".", 1)) for end in (line.source, line.target)))
            for line in scenario.lines
            if not is_side_line(line, components)
        ]

    @property
    def restorable(self) -> bool:
        """Whether all can restore a state, as iteration and step control need."""
        return all(about.restorable for about in self._about.values())

    @property
    def variable_step(self) -> bool:
        """Whether all take steps of any length."""
        return all(about.variable_step for about in self._about.values())

    @property
    def controllable(self) -> bool:
        """Whether all can restore a state and take steps of any length."""
        return self.restorable and self.variable_step

    @property
    def held_inputs(self) -> list[Port]:
        """The connected inputs that FMUs hold over a macro step, and whose signals change in it."""
        return [
            c.target
            for c in self._connections
            if self.get_degree(c.target) == 0 and c.source not in self.stepwise
        ]

    @property
    def followed(self) -> bool:
        """Whether any connected input follows signals of a degree above 0."""
        return any(self.get_degree(c.target) for c in self._connections)

    @property
    def integrable(self) -> list[str]:
        """The participants that hold inputs, and offer model exchange, by which they would follow signals."""
        names = dict.fromkeys(target.instance for target in self.held_inputs)
        tables = self._scenario.components
        return [name for name in names if tables[name].third_party and self._about[name].exchange]

    @cached_property
    def stepwise(self) -> list[Port]:
        """The outputs that change at events only and go to inputs that could follow more."""
        return [
            c.source
            for c in self._connections
            if self._get_quantity(c.source, "outputs").jumps
            and not self._get_quantity(c.target, "inputs").discrete
        ]

    def _get_quantity(self, port: Port, side: str) -> Quantity:
        layout: Layout = getattr(self._components[port.instance], side)
        return layout.field(port.variable).quantity

    @property
    def useful_degree(self) -> int:
        """The highest degree of signals that makes errors smaller.

        A signal held for a discrete output has order 1. The mean that a held input gets has order 2 from
        degree 1 on; of degree 2 it leaves a sixth of the error or less. Degree 3 needs rates.
        """
        if self.stepwise:
            return 0
        rated = not self.held_inputs and all(self._is_rated(c.source) for c in self._connections)
        return min([*self._degrees.values(), HIGHEST if rated else 2])

    def _is_rated(self, source: Port) -> bool:
        """Whether the rate of an output is given."""
        about = self._about.get(source.instance)
        if about is None or about.gives_rates:
            return True
        return any(variable.derivative == source.variable for variable in about.variables.values())

    def find_differentiated(self, degree: int) -> Iterator[tuple[Port, Port]]:
        """Outputs that are time derivatives of held inputs, each with its input."""
        sources = {c.source for c in self._connections}
        for c in self._connections:
            about = self._about.get(c.target.instance)
            if about is None or min(degree, self._degrees[c.source], self.get_degree(c.target)) > 0:
                continue
            for source in sources:
                if source.instance == c.target.instance and _differentiates(about, source, c.target):
                    yield source, c.target

    def get_degree(self, target: Port) -> int:
        """The degree of the signals that an input follows; 0: it is held over a macro step."""
        about = self._about.get(target.instance)
        if about is None or target.variable not in about.variables:
            return HIGHEST
        own = signal_degrees(about, [target.variable])[0]
        return HIGHEST if self._scenario.components[target.instance].substeps > 1 else own

    @cached_property
    def _degrees(self) -> dict[Port, int]:
        """The highest degree of each source's signal."""
        followed = {c.target: self.get_degree(c.target) for c in self._connections}
        return find_highest_degrees(self._connections, followed)


def _differentiates(about: Description, output: Port, target: Port) -> bool:
    """Whether the output is declared the input's derivative or depends on the input's slope."""
    variable = about.variables.get(output.variable)
    declared = variable is not None and variable.derivative == target.variable
    return declared or name_derivative(target.variable, 1) in about.depends.get(output.variable, ())


def list_limit_warnings(scenario: Scenario) -> list[str]:
    """A warning for each limit that the scenario exceeds."""
    limits, master = FmuLimits(scenario), scenario.master.build()
    found = [_describe_held(limits.held_inputs, master)] if limits.held_inputs else []
    if limits.stepwise and master.degree:
        found.append(
            f"{', '.join(map(str, dict.fromkeys(limits.stepwise)))}: discrete, so held over each macro step "
            "at the value at its start, not extrapolated nor averaged"
        )
    for output, target in dict.fromkeys(limits.find_differentiated(master.degree)):
        remedy = (
            "take extrapolation = 'linear' or a higher one"
            if limits.get_degree(target) > 0
            else "take an FMU that takes the slope of this input (_der1)"
        )
        found.append(
            f"{output}: is the time derivative of the input {target.variable}, which is held over a macro "
            f"step and so has no slope: this value and all that depends on it may be wrong; {remedy}"
        )
    if scenario.step_control and scenario.step_control.forward:
        found.append(
            f"step_control.estimator = {scenario.step_control.estimator!r}: no step is made again, so its "
            "error is known only afterwards: a contact, or a jump, may be missed by any amount; "
            "step_control.maximum_step limits the steps, the diagnosis tells which erred too much"
        )
    elif scenario.step_control and scenario.step_control.maximum_step is None:
        blind = [
            n for n, table in scenario.components.items() if isinstance(table.resolve(), ThirdPartyComponent)
        ]
        if blind:
            found.append(
                f"{', '.join(blind)}: these FMUs report no events, so a contact that begins and ends within "
                "one step is missed; step_control.maximum_step limits the steps"
            )
    return found


def _describe_held(held: Sequence[Port], master: Any) -> str:
    known = f"{', '.join(map(str, held))}: the FMUs hold these inputs over a macro step (no _der1, no "
    if master.degree:
        effect = "they get the mean of their signal, and the error is of second order in macro_step at best"
    else:
        effect = (
            "with extrapolation = 'hold' the error is of first order in macro_step; with 'linear' they get "
            "the mean of their signal, and it is of second order"
        )
    return f"{known}canInterpolateInputs): {effect}"
