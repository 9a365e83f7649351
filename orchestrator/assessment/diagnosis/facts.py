"""What rules look at: a run's numbers, its steps and its scenario."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from models.core.roles import Drive

from ...scenario import Scenario, parse_ends
from ...scenario.fmu_limits import FmuLimits
from .numbers import Diagnosis
from .steps import Steps


@dataclass(frozen=True)
class Facts:
    """What rules look at."""

    diagnosis: Diagnosis
    steps: Steps
    scenario: Scenario

    @cached_property
    def master(self) -> Any:
        """With the tolerance that it ran with."""
        return self.scenario.build_master()

    @cached_property
    def limits(self) -> FmuLimits:
        """What the given FMU files can take."""
        return FmuLimits(self.scenario)

    @cached_property
    def targets(self) -> dict[str, list[str]]:
        """The inputs that each output drives."""
        found: dict[str, list[str]] = {}
        for source, target in map(parse_ends, self.scenario.connections):
            found.setdefault(source, []).append(target)
        return found

    @cached_property
    def drives(self) -> dict[str, set[str]]:
        """The participants that each participant drives."""
        found: dict[str, set[str]] = {name: set() for name in self.scenario.components}
        for source, target in map(parse_ends, self.scenario.connections):
            found[source.split(".")[0]].add(target.split(".")[0])
        return found

    def is_felt(self, variable: str) -> bool:
        """Whether what `variable` drives moves by it: a flywheel that prescribes its speed doesn't."""
        return any(
            not table.resolve().has_role(Drive)
            or table.parameters.get("motion", "prescribed") != "prescribed"
            for target in self.targets.get(variable, [])
            for table in [self.scenario.components[target.split(".")[0]]]
        )

    @property
    def weaker(self) -> bool:
        """The master accelerates its iteration, with less than there is."""
        return self.master.acceleration not in ("", "quasi_newton")

    def around(self, variable: str) -> list[str]:
        """The participant that gives `variable`, and those that it drives by it and that drive it."""
        own = variable.split(".")[0]
        driven = {target.split(".")[0] for target in self.targets.get(variable, ())}
        return [n for n in self.drives if n == own or (n in driven and own in self.drives[n])]

    def loop(self, name: str) -> set[str]:
        """The participants from which and to which one comes from `name`."""
        return {other for other in self._reached(name) if name in self._reached(other)}

    def _reached(self, name: str) -> set[str]:
        seen, waiting = {name}, [name]
        while waiting:
            new = self.drives[waiting.pop()] - seen
            seen |= new
            waiting += new
        return seen

    @property
    def limiting(self) -> tuple[str, float]:
        """The variable whose error limits most steps, and its share of all steps."""
        name = next(iter(self.diagnosis.limits), "")
        return name, self.diagnosis.limits[name].steps if name else 0.0
