"""The tables [master] and [step_control] of a scenario."""

import math
from dataclasses import fields
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, field_validator

from models.core.system import suggestion

from ..errors import one_of
from ..masters import GaussSeidel, find_master
from ..stepping import DEFECT, JUDGES, StepControl
from .fields import Seconds, Table, Tolerance
from .values import Faults

# The name that leaves master, signals and steps to the program.
AUTO = "auto"


class MasterTable(BaseModel):
    """The co-simulation master; other keys are options of that master."""

    model_config = ConfigDict(extra="allow", frozen=True)

    name: str = Field(
        "gauss_seidel",
        description="Name of the master, or your own as module:object; auto, as without [master] and "
        "[step_control]: master, signals and macro steps are chosen before the run",
    )
    chosen: str | None = Field(None, description="What auto has chosen, and why; auto itself writes it")

    @field_validator("name")
    @classmethod
    def _check_name(cls, name: str) -> str:
        if name != AUTO:
            find_master(name)
        return name

    def build(self) -> Any:
        """The master with its options; ValidationError or ValueError for wrong options.

        For `auto` it is the one with which the choice begins.
        """
        options = dict(self.model_extra or {})
        if self.name == AUTO:
            for key in options:
                raise Faults((key, ": auto has no options; leave it out, or name a master"))
            return GaussSeidel(extrapolation="hermite")
        kind = find_master(self.name)
        known = [field.name for field in fields(kind)]
        for key in options:
            if key not in known:
                raise Faults((key, f": {self.name} has no such option; {suggestion(key, known)}"))
        return TypeAdapter(kind).validate_python(options)


# Default tolerance of event times (s).
EVENT_TOLERANCE = 1e-9
# Ratio of an iterated master's tolerance to the step tolerance.
CONVERGED = 0.3


class StepControlTable(Table):
    """Macro steps as long as an error estimate allows."""

    estimator: str | None = Field(
        None,
        description="predictor_corrector or step_doubling; default: the first for iterated masters, the "
        "second for others. defect never makes a step again, for FMUs that cannot restore their state",
    )
    relative: Annotated[Tolerance, Field(lt=1.0)] = Field(1e-4, description="Local error allowed, of a value")
    absolute: Tolerance | None = Field(
        None, description="Local error allowed, of a variable's nominal size; default: as relative"
    )
    minimum_step: Seconds = Field(1e-12, description="Shortest macro step (s, or a text with a unit)")
    maximum_step: Seconds | None = Field(None, description="Longest macro step (s, or a text with a unit)")

    @field_validator("estimator")
    @classmethod
    def _check_estimator(cls, name: str | None) -> str | None:
        if name is not None and name not in JUDGES:
            raise ValueError(f"{name!r}: {one_of(JUDGES, name)}")
        return name

    @property
    def forward(self) -> bool:
        """Whether steps are never made again."""
        return self.estimator == DEFECT

    def build(self, implicit: bool, event_tolerance: float) -> StepControl:
        """Build the step control of an iterated (`implicit`) or another master."""
        return StepControl(
            estimator=self.estimator or ("predictor_corrector" if implicit else "step_doubling"),
            relative=self.relative,
            absolute=self.absolute or self.relative,
            minimum_step=self.minimum_step,
            maximum_step=self.maximum_step or math.inf,
            event_tolerance=event_tolerance,
        )
