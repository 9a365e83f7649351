"""Subjects of a study: an analysis or a scenario, with all other values fixed."""

import functools
import json
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from ..analyses import Analysis, Parameter, Result, load
from ..scenario.values import Value

# Panels of a figure.
MOST_DRAWN = 4


class Subject(ABC):
    """Plain data and names of functions, so that it can be sent to workers."""

    @property
    @abstractmethod
    def results(self) -> Mapping[str, Result]: ...

    @abstractmethod
    def resolve(self, name: str, value: Value) -> Value:
        """`value` in the parameter's unit; MistakeError for an unknown name or a value out of range."""

    @abstractmethod
    def describe(self, name: str) -> Result:
        """Unit and description of a parameter."""

    @property
    def default_figure(self) -> Sequence[str]:
        """The results to draw if a study names none."""
        return ()

    def list_warnings(self, values: Mapping[str, Value]) -> list[str]:
        """Oils of a point, and warnings about it, before its evaluation."""
        return []

    @abstractmethod
    def content(self) -> str:
        """Text that determines the results together with points and source."""

    @abstractmethod
    def evaluate(self, values: Mapping[str, Value]) -> Mapping[str, float | str]:
        """The results at a point."""


class NumberedSubject(Subject):
    """A subject whose points are numbers along one axis, and which its command draws."""

    axis: ClassVar[Parameter]
    display_unit: ClassVar[str] = ""

    def resolve(self, name: str, value: Value) -> Value:
        return self.axis.check_value(name, value)

    def describe(self, name: str) -> Result:
        quantity = self.axis.quantity
        return Result(quantity.unit, quantity.description, display_unit=self.display_unit)


@functools.cache
def load_analysis(name: str) -> Analysis:
    return load(name)


@dataclass(frozen=True)
class AnalysisSubject(Subject):
    """An analysis by name, with the values of its other parameters."""

    name: str
    fixed: Mapping[str, Value]

    @property
    def analysis(self) -> Analysis:
        return load_analysis(self.name)

    @property
    def results(self) -> Mapping[str, Result]:
        return self.analysis.results

    def resolve(self, name: str, value: Value) -> Value:
        return self.analysis.parameter(name).check_value(name, value)

    def describe(self, name: str) -> Result:
        quantity = self.analysis.parameter(name).quantity
        return Result(quantity.unit, quantity.description)

    @property
    def default_figure(self) -> Sequence[str]:
        return [name for name, result in self.results.items() if not result.text][:MOST_DRAWN]

    def content(self) -> str:
        return json.dumps({"analysis": self.name, "parameters": self.analysis.complete(self.fixed)})

    def evaluate(self, values: Mapping[str, Any]) -> Mapping[str, float | str]:
        return self.analysis.evaluate(self.analysis.complete({**self.fixed, **values}))
