"""The scenario: everything that a run depends on. `scenario_files` reads it, `assembly` builds it."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import fields, replace
from typing import Annotated, Any, Literal

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
    field_validator,
)

from models.component import Component
from models.system import suggestion

from .errors import MistakeError, one_of
from .masters import MASTERS
from .stepping import ControlledSteps, FixedSteps, StepControl
from .stepping.estimators import ESTIMATORS
from .units import to_unit
from .values import Faults, Value, component_of, meanings


class ScenarioError(MistakeError):
    """A scenario that cannot be run; a line for each fault, which names the key and the remedy."""


def _time(value: Any) -> float:
    """A time in seconds; a text may have another unit."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise ValueError("must be a time: a number of seconds, or a text such as '2 us'")
    return to_unit(value, "s") if isinstance(value, str) else float(value)


def _seconds(value: Any) -> Any:
    """A time in seconds; ValueError unless it is positive and finite."""
    number = _time(value)
    if not (math.isfinite(number) and number > 0.0):
        raise ValueError(f"{value}: must be > 0 s")
    return number


def _seconds_or_0(value: Any) -> Any:
    """A time in seconds; ValueError unless it is finite and not negative."""
    number = _time(value)
    if not (math.isfinite(number) and number >= 0.0):
        raise ValueError(f"{value}: must be >= 0 s")
    return number


def _scalar(value: Any) -> Any:
    if not isinstance(value, (bool, int, float, str)):
        raise ValueError("must be a number, a text with a unit, a choice's name, true or false")
    return value


# How long after an event a step may end, by default (s).
EVENT_TOLERANCE = 1e-9
# Tolerance of an iterated master over that of the step control.
CONVERGED = 0.3

Seconds = Annotated[float, BeforeValidator(_seconds, json_schema_input_type=float | str)]
SecondsOr0 = Annotated[float, BeforeValidator(_seconds_or_0, json_schema_input_type=float | str)]
Written = Annotated[Value, BeforeValidator(_scalar)]
Location = tuple[int | str, ...]
Tolerance = Annotated[float, Field(gt=0.0, allow_inf_nan=False, strict=True)]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class ComponentTable(_Table):
    """One component of the system. Values are in SI units, or texts with a unit ("8 mm")."""

    component: str = Field(description="Name of the component in the catalogue")
    structure: dict[str, int] = Field({}, description="Structural sizes, e.g. coil_masses")
    participant: str = Field(
        "fmu",
        description="fmu: the component's own FMU, built when needed; in-process: without FMI; or the "
        "path of an .fmu file with the component's variables",
    )
    substeps: int = Field(
        1, description="Steps that it makes of every macro step", ge=1, le=10_000, strict=True
    )
    retries: int = Field(
        0,
        description="How often a step that it discards is halved before the run fails",
        ge=0,
        le=20,
        strict=True,
    )
    parameters: dict[str, Written] = Field({}, description="Parameters that differ from their defaults")
    start: dict[str, Written] = Field({}, description="Start values of states")
    inputs: dict[str, Written] = Field({}, description="Constant values of inputs that nothing drives")

    @field_validator("structure")
    @classmethod
    def _sizes(cls, structure: dict[str, int], info: ValidationInfo) -> dict[str, int]:
        if "component" in info.data:
            component_of(info.data["component"], tuple(sorted(structure.items())))
        return structure

    @field_validator("component")
    @classmethod
    def _known(cls, name: str) -> str:
        component_of(name)
        return name

    @field_validator("participant")
    @classmethod
    def _kind(cls, kind: str) -> str:
        if kind in ("fmu", "in-process") or kind.endswith(".fmu"):
            return kind
        raise ValueError(f"{kind!r}: {one_of(('fmu', 'in-process'), kind)} (or the path of an .fmu file)")

    @field_validator("parameters", "start", "inputs")
    @classmethod
    def _values(cls, values: dict[str, Value], info: ValidationInfo) -> dict[str, Value]:
        if "component" not in info.data or "structure" not in info.data:
            return values  # the fault is already known
        component = component_of(info.data["component"], tuple(sorted(info.data["structure"].items())))
        layouts = {"parameters": component.parameters, "start": component.state, "inputs": component.inputs}
        kinds = {"parameters": "parameter", "start": "state", "inputs": "input"}
        assert info.field_name
        return meanings(layouts[info.field_name], values, kinds[info.field_name])

    def made(self) -> Component:
        """The component with these sizes."""
        return component_of(self.component, tuple(sorted(self.structure.items())))


class MasterTable(BaseModel):
    """The co-simulation master; other keys are options of that master."""

    model_config = ConfigDict(extra="allow", frozen=True)

    name: str = Field("gauss_seidel", description="Name of the master")

    @field_validator("name")
    @classmethod
    def _known(cls, name: str) -> str:
        if name not in MASTERS:
            raise ValueError(f"no master {name!r}; {suggestion(name, MASTERS)}")
        return name

    def made(self) -> Any:
        """The master with its options; ValidationError or ValueError if they do not fit."""
        kind = MASTERS[self.name]
        options = dict(self.model_extra or {})
        known = [field.name for field in fields(kind)]
        for key in options:
            if key not in known:
                raise Faults((key, f": {self.name} has no such option; {suggestion(key, known)}"))
        return TypeAdapter(kind).validate_python(options)


class StepControlTable(_Table):
    """Macro steps as long as an error estimate allows."""

    estimator: str | None = Field(
        None,
        description="predictor_corrector, step_doubling, schierz or energy; default: predictor_corrector for "
        "iterated masters, step_doubling for others",
    )
    relative: Annotated[Tolerance, Field(lt=1.0)] = Field(1e-4, description="Local error allowed, of a value")
    absolute: Tolerance | None = Field(
        None, description="Local error allowed, of a variable's nominal size; default: as relative"
    )
    minimum_step: Seconds = Field(1e-12, description="Shortest macro step (s, or a text with a unit)")
    maximum_step: Seconds | None = Field(None, description="Longest macro step (s, or a text with a unit)")

    @field_validator("estimator")
    @classmethod
    def _known(cls, name: str | None) -> str | None:
        if name is not None and name not in ESTIMATORS:
            raise ValueError(f"{name!r}: {one_of(ESTIMATORS, name)}")
        return name

    def made(self, implicit: bool, event_tolerance: float) -> StepControl:
        """For a master that iterates (`implicit`), or one that doesn't."""
        return StepControl(
            estimator=self.estimator or ("predictor_corrector" if implicit else "step_doubling"),
            relative=self.relative,
            absolute=self.absolute or self.relative,
            minimum_step=self.minimum_step,
            maximum_step=self.maximum_step or math.inf,
            event_tolerance=event_tolerance,
        )


class ReferenceTable(_Table):
    """The monolithic reference."""

    enabled: bool = Field(True, description="Solve it and compare the coupled run with it")
    tolerance: Annotated[Tolerance, Field(lt=1.0)] = Field(
        1e-10, description="Relative tolerance of the reference's solvers"
    )


class EnergyTable(_Table):
    """The energy ledger."""

    ledger: bool = Field(
        False, description="Count the energy over every power bond, and what the coupling creates"
    )
    correction: bool = Field(
        False,
        description="Give back in the next step what efforts and flows missed in the last one (Benedikt et "
        "al. 2013); for the master jacobi",
    )


class Scenario(_Table):
    """A coupled run and what it is compared with."""

    name: str = Field(description="Name of the scenario; default: that of the file", pattern=r"^[\w .-]+$")
    description: str = Field("", description="What the scenario shows, in a line")
    stop_time: Seconds = Field(description="End of the run (s, or a text with a unit)")
    macro_step: Seconds = Field(
        description="Communication step (s, or a text with a unit); with step control the first one"
    )
    output_step: Seconds | None = Field(
        None, description="Time between records, rounded to macro steps; default: every macro step"
    )
    checkpoint_every: SecondsOr0 = Field(
        30.0, description="Wall time from one checkpoint to the next (tribocosim resume); 0: none"
    )
    start: Literal["equilibrium", "given"] = Field(
        "equilibrium", description="Start at rest in balance, or from the start values as given"
    )
    call_time_limit: Seconds | None = Field(
        None, description="Longest wall time of a participant's call; default: no limit"
    )
    tolerance: dict[str, Tolerance] = Field(
        description="Largest relative RMS error allowed, by variable: contact.load = 1e-3", min_length=1
    )
    master: MasterTable = MasterTable()
    step_control: StepControlTable | None = Field(None, description="Absent: steps of equal length")
    event_tolerance: Seconds | None = Field(
        None,
        description="Locate events inside macro steps, by rollback, to this time (s, or a text with a unit); "
        "default: not with equal steps, to 1 ns with step control",
    )
    reference: ReferenceTable = ReferenceTable()
    energy: EnergyTable = EnergyTable()
    components: dict[str, ComponentTable] = Field(description="The components by instance name", min_length=1)
    connections: list[str] = Field([], description="Lines 'instance.output -> instance.input'")

    @field_validator("components")
    @classmethod
    def _names(cls, components: dict[str, ComponentTable]) -> dict[str, ComponentTable]:
        for name in components:
            if not name.isidentifier():
                raise ValueError(f"{name!r}: an instance is named with letters, digits and _")
        return components

    @field_validator("connections")
    @classmethod
    def _arrows(cls, connections: list[str]) -> list[str]:
        return [" -> ".join(ends(line)) for line in connections]

    @field_validator("macro_step")
    @classmethod
    def _step(cls, step: float, info: ValidationInfo) -> float:
        if step > info.data.get("stop_time", math.inf):
            raise ValueError(f"{step:g} s: must not be longer than stop_time = {info.data['stop_time']:g} s")
        return step

    @field_validator("master")
    @classmethod
    def _options(cls, master: MasterTable) -> MasterTable:
        try:
            master.made()
        except ValidationError as error:
            raise Faults(*map(_of_option, messages(error))) from None
        return master

    @field_validator("step_control")
    @classmethod
    def _judges(cls, control: StepControlTable | None, info: ValidationInfo) -> StepControlTable | None:
        longest = info.data.get("macro_step", math.inf)
        if control is not None and control.minimum_step > longest:
            raise Faults(
                (
                    "minimum_step",
                    f" = {control.minimum_step:g} s: must not be longer than macro_step = {longest:g} s, the "
                    "first step",
                )
            )
        if control is not None and "master" in info.data:
            master = info.data["master"].made()
            made = control.made(master.implicit, EVENT_TOLERANCE)
            try:
                ESTIMATORS[made.estimator]().check(master)
            except ValueError as error:
                raise Faults(("", f".{error}")) from None
        return control

    def made_master(self) -> Any:
        """The master. With step control an iterated one converges to 0.3 of the step's tolerance,
        unless its own is given."""
        master = self.master.made()
        if self.step_control and master.implicit and "tolerance" not in (self.master.model_extra or {}):
            return replace(master, tolerance=CONVERGED * self.step_control.relative)
        return master

    def made_steps(self) -> FixedSteps | ControlledSteps:
        """What chooses the macro steps."""
        if self.step_control is None:
            return FixedSteps(self.macro_step, self.event_tolerance)
        tolerance = self.event_tolerance or EVENT_TOLERANCE
        return ControlledSteps(
            self.macro_step, self.step_control.made(self.master.made().implicit, tolerance)
        )

    @property
    def record_every(self) -> int:
        """Macro steps from one record to the next."""
        if self.step_control is not None:
            return 1
        return max(1, round((self.output_step or self.macro_step) / self.macro_step))


def _of_option(line: str) -> tuple[str, str]:
    """Key and rest of a message about a master's option."""
    option, equals, rest = line.partition(" = ")
    return (option, equals + rest) if option.isidentifier() and equals else ("", f": {line}")


# What to write where one of these is missing.
REMEDIES = {
    "tolerance": "; state the largest relative RMS error of at least one output: [tolerance] "
    '"contact.load" = 1e-3',
    "stop_time": '; e.g. stop_time = "120 ms"',
    "macro_step": '; e.g. macro_step = "5 us"',
    "components": '; e.g. [components.camshaft] component = "camshaft"',
}


def ends(line: str) -> tuple[str, str]:
    """Source and target of a connection's line; ValueError if it is not one."""
    source, arrow, target = (part.strip() for part in line.partition("->"))
    if not arrow or "." not in source or "." not in target:
        raise ValueError(f"{line!r}: a connection is written 'instance.output -> instance.input'")
    return source, target


def scenario_of(content: dict[str, Any]) -> Scenario:
    """A Scenario of a file's content; ScenarioError with a line for each fault."""
    try:
        return Scenario.model_validate(content)
    except ValidationError as error:
        raise ScenarioError("\n".join(messages(error))) from None


def messages(error: ValidationError, known: Callable[[Location], list[str]] | None = None) -> list[str]:
    """What pydantic found, in the words of the file; `known` gives the keys known at a place."""
    lines: list[str] = []
    for fault in error.errors():
        path = ".".join(str(part) for part in fault["loc"])
        kind, shown = fault["type"], fault["input"]
        if kind == "extra_forbidden":
            lines.append(
                f"{path}: unknown key; {suggestion(str(fault['loc'][-1]), (known or _keys)(fault['loc']))}"
            )
        elif kind == "missing":
            lines.append(f"{path}: missing{REMEDIES.get(path, '')}")
        elif kind == "value_error":
            reason = fault["ctx"]["error"]
            if isinstance(reason, Faults):
                lines += [f"{path}.{key}{text}" if key else path + text for key, text in reason.faults]
            else:
                lines.append(f"{path}: {reason}" if path else str(reason))
        elif kind == "greater_than":
            lines.append(f"{path} = {shown}: must be > {fault['ctx']['gt']:g}")
        elif kind == "literal_error":
            choices = re.findall("'(.*?)'", fault["ctx"]["expected"])
            lines.append(f"{path} = {shown!r}: {one_of(choices, shown)}")
        elif kind in ("bool_parsing", "bool_type"):
            lines.append(f"{path} = {shown!r}: must be true or false")
        elif kind == "too_short":
            lines.append(f"{path}: must have at least one entry")
        else:
            text = fault["msg"].replace("Input should be", "must be").replace(" valid", "")
            text = re.sub(r"a dictionary( or instance of \w+)?", "a table", text)
            text = text.replace("a tuple", 'a list: ["...", "..."]').replace("a integer", "an integer")
            lines.append(f"{path} = {shown!r}: {text}")
    return lines


def _keys(location: Location) -> list[str]:
    """The keys known where an unknown one was found."""
    if len(location) == 1:
        return [*Scenario.model_fields, "extends"]
    if location[0] == "components":
        return list(ComponentTable.model_fields)
    tables = {"step_control": StepControlTable, "reference": ReferenceTable, "energy": EnergyTable}
    return list(tables[str(location[0])].model_fields)
