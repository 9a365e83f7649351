"""The scenario: all tables of a file."""

import difflib
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields, replace
from typing import Annotated, Any, Literal

from pydantic import Field, PrivateAttr, ValidationError, ValidationInfo, field_validator, model_validator

from models.core.quantities import Vector
from models.core.system import suggestion

from ..errors import Fault, MistakeError, list_faults
from ..masters import MASTERS
from ..participants.own_process import Limits
from ..stepping import ControlledSteps, FixedSteps, ForwardSteps, RefinedSteps, check_estimator, control_steps
from .component_table import ComponentTable
from .connection import Line, parse_line, parse_named_line
from .fields import FolderName, Seconds, SecondsOr0, Table, Tolerance
from .master_table import CONVERGED, EVENT_TOLERANCE, MasterTable, StepControlTable
from .messages import REMEDIES, Location, find_faults
from .oil import OilSheet, Temperature, share_oil
from .origin import Origin
from .revolutions import convert_to_seconds
from .values import Faults, build_component, find_place, list_names

# The comparison has at least this many intervals. An RMS error from n normally distributed values has a
# standard error of 1 / sqrt(2 n), here 7 %.
COMPARED_INTERVALS = 100
# A macro step is at least this many spacings of floating-point numbers at the stop time, so that rounding
# changes its length by a thousandth at most.
SPACINGS = 1000


class ScenarioError(MistakeError):
    """A scenario that cannot be run: a line for each fault. There are no `faults` where it can't be read."""

    faults: tuple[Fault, ...] = ()

    @classmethod
    def of(cls, faults: Iterable[Fault]) -> "ScenarioError":
        found = tuple(faults)
        error = cls(list_faults(found))
        error.faults = found
        return error


class ReferenceTable(Table):
    """The reference: the monolithic solution, or the limit of runs with smaller macro steps."""

    enabled: bool = Field(True, description="Compare the coupled run with it")
    method: Literal["auto", "monolithic", "refinement"] = Field(
        "auto",
        description="All equations solved together (third-party FMUs by their model exchange), or the run "
        "repeated with half and a quarter of its macro steps and extrapolated; auto: the first where all "
        "FMUs have equations",
    )
    tolerance: Annotated[Tolerance, Field(lt=1.0)] = Field(
        1e-10, description="Relative tolerance of the reference's solvers"
    )
    step: Seconds | None = Field(
        None,
        description="Longest step of the reference where a component solves for a pressure field, which the "
        "tolerance has no part in (s, or a text with a unit); default: 8 us",
    )
    witness: Literal["none", "multibody"] = Field(
        "none",
        description="Solve a direct-acting or pushrod valve train a third time, as bodies with joints and "
        "multipliers, and put its loads beside those of the run",
    )


class EnergyTable(Table):
    """The energy ledger."""

    ledger: bool = Field(
        False, description="Count the energy over every power bond, and what the coupling creates"
    )


class Scenario(Table):
    """A coupled run and what it is compared with."""

    name: FolderName = Field(description="Name of the scenario; default: that of the file")
    description: str = Field("", description="What the scenario shows, in a line")
    stop_time: Seconds = Field(
        description="End of the run (s, or a text with a unit: '120 ms', '2 revolutions' of the drive)"
    )
    macro_step: Seconds = Field(
        description="Communication step (s, or a text with a unit); with step control the first one"
    )
    output_step: Seconds | None = Field(
        None,
        description="Time between records, rounded to macro steps; compared with the reference a hundredth "
        "of stop_time at most; default: every macro step",
    )
    checkpoint_every: SecondsOr0 = Field(
        30.0, description="Wall time from one checkpoint to the next (tribocosim resume); 0: none"
    )
    figures_over: Literal["cam_angle", "crank_angle"] | None = Field(
        None,
        description="Draw all figures over this angle; default: each part's over its own cam's or shaft's",
    )
    start: Literal["equilibrium", "given"] = Field(
        "equilibrium",
        description="Start at rest in balance, or from the start values as given; default where all "
        "components are third-party FMUs: 'given'",
    )
    oil: str | OilSheet | None = Field(
        None,
        description="Oil of all contacts, bearings and lash adjusters: a grade, or a table of its data; with "
        "`temperature` it becomes their `parameters`, but for those that a part states itself",
        exclude=True,
    )
    temperature: Temperature | None = Field(
        None, description="Temperature of the oil (K, or a text with a unit)", exclude=True
    )
    call_time_limit: Seconds | None = Field(
        None, description="Longest wall time of a call of an FMU in its own process; default: no limit"
    )
    reference: ReferenceTable = ReferenceTable()
    tolerance: dict[str, Tolerance] = Field(
        {},
        validate_default=True,
        description="Largest relative RMS error allowed, by variable: contact.load = 1e-3; at least one with "
        "the reference",
    )
    master: MasterTable = MasterTable()
    step_control: StepControlTable | None = Field(None, description="Absent: steps of equal length")
    event_tolerance: Seconds | None = Field(
        None,
        description="Locate events inside macro steps, by rollback, to this time (s, or a text with a unit); "
        "default: not with equal steps, to 1 ns with step control",
    )
    energy: EnergyTable = EnergyTable()
    components: dict[str, ComponentTable] = Field(description="The components by instance name", min_length=1)
    connections: list[str] = Field(
        [], description="Lines 'instance.output -> instance.input', or '... * factor + offset -> ...'"
    )

    _chosen_start: bool = PrivateAttr(False)
    _origin: Origin | None = PrivateAttr(None)

    @field_validator("components")
    @classmethod
    def _check_names(cls, components: dict[str, ComponentTable]) -> dict[str, ComponentTable]:
        for name in components:
            if not name.isidentifier():
                raise ValueError(f"{name!r}: an instance is named with letters, digits and _")
        return components

    @field_validator("connections")
    @classmethod
    def _parse_connections(cls, connections: list[str], info: ValidationInfo) -> list[str]:
        components = info.data.get("components", {})

        def is_known(end: str) -> bool:
            name, _, variable = end.partition(".")
            return name in components and components[name].has_variable(variable)

        return [str(parse_named_line(line, is_known)) for line in connections]

    @field_validator("tolerance")
    @classmethod
    def _check_tolerance(cls, tolerance: dict[str, float], info: ValidationInfo) -> dict[str, float]:
        if not tolerance and "reference" in info.data and info.data["reference"].enabled:
            raise Faults(Fault("", ": missing", REMEDIES["tolerance"]))
        return tolerance

    @field_validator("macro_step", "output_step")
    @classmethod
    def _check_step(cls, step: float | None, info: ValidationInfo) -> float | None:
        stop = info.data.get("stop_time", math.inf)
        if step is None or not math.isfinite(stop):
            return step
        if step > stop:
            remedy = "make it shorter, or leave it out, which records every macro step"
            end = f" = {step:g} s: must not be longer than stop_time = {stop:g} s"
            raise Faults(Fault("", end, remedy if info.field_name == "output_step" else ""))
        if step < (least := SPACINGS * math.ulp(stop)) and info.field_name == "macro_step":
            end = f" = {step:g} s: must be at least {least:.2g} s with stop_time = {stop:g} s"
            raise Faults(("", f"{end}, because of the rounding of times; e.g. '5 us'"))
        return step

    @field_validator("event_tolerance")
    @classmethod
    def _check_event_tolerance(cls, tolerance: float | None, info: ValidationInfo) -> float | None:
        longest = info.data.get("macro_step", math.inf)
        if tolerance is not None and tolerance >= longest:
            said = f" = {tolerance:g} s: must be shorter than macro_step = {longest:g} s; e.g. '1 ns'"
            raise Faults(("", said))
        return tolerance

    @field_validator("master")
    @classmethod
    def _check_master(cls, master: MasterTable) -> MasterTable:
        try:
            master.build()
        except ValidationError as error:
            raise Faults(*map(_place_option, find_faults(error))) from None
        return master

    @field_validator("step_control")
    @classmethod
    def _check_step_control(
        cls, control: StepControlTable | None, info: ValidationInfo
    ) -> StepControlTable | None:
        longest = info.data.get("macro_step", math.inf)
        if control is not None and control.minimum_step > longest:
            said = f" = {control.minimum_step:g} s: must not be longer than macro_step = {longest:g} s"
            raise Faults(("minimum_step", f"{said}, the first step"))
        if control is not None and "master" in info.data:
            master = info.data["master"].build()
            try:
                made = control.build(master.implicit, EVENT_TOLERANCE)
                check_estimator(made.estimator, master)
            except ValueError as error:
                raise Faults(("", f".{error}")) from None
        return control

    @model_validator(mode="after")
    def _choose_start(self) -> "Scenario":
        """Nobody can seek the equilibrium of third-party FMUs only."""
        if "start" not in self.model_fields_set and all(one.third_party for one in self.components.values()):
            object.__setattr__(self, "start", "given")
            self._chosen_start = True
        return self

    @property
    def names_master(self) -> bool:
        """Whether it says how to couple: [master] or [step_control]."""
        return bool({"master", "step_control"} & self.model_fields_set)

    @property
    def lines(self) -> list[Line]:
        """The connections."""
        return [parse_line(line) for line in self.connections]

    def __eq__(self, other: object) -> bool:
        """Whether they describe the same run, whatever file they are from."""
        return isinstance(other, Scenario) and dict(self) == dict(other)

    @property
    def origin(self) -> Origin | None:
        """The file that it was read from."""
        return self._origin

    def read_from(self, origin: Origin) -> "Scenario":
        """The same, which knows its file."""
        self._origin = origin
        return self

    def with_native_fmus(self) -> "Scenario":
        """Another, with FMUs in machine code for those that are built of our components."""
        native = {"participant": "native"}
        tables = {
            name: table.model_copy(update=native) if table.participant == "fmu" else table
            for name, table in self.components.items()
        }
        return self.model_copy(update={"components": tables})

    @property
    def notes(self) -> list[str]:
        """What was chosen in reading it."""
        if not self._chosen_start:
            return []
        return [
            "start = 'given': third-party FMUs begin with their start values, as nobody knows the equations "
            "of their equilibrium"
        ]

    def build_master(self) -> Any:
        """The master. With step control an iterated master converges to 0.3 of the step tolerance, unless its
        own tolerance is given."""
        master = self.master.build()
        if self.step_control and master.implicit and "tolerance" not in (self.master.model_extra or {}):
            return replace(master, tolerance=CONVERGED * self.step_control.relative)
        return master

    def build_steps(self) -> FixedSteps | ControlledSteps | ForwardSteps:
        """The stepper: fixed or controlled macro steps."""
        if self.step_control is None:
            return FixedSteps(self.macro_step, self.event_tolerance)
        tolerance = self.event_tolerance or EVENT_TOLERANCE
        return control_steps(
            self.macro_step, self.step_control.build(self.master.build().implicit, tolerance)
        )

    def refine_steps(self, ends: Vector, parts: int) -> RefinedSteps:
        """The steps that ended at `ends` (with the start), each in that many parts; events are located as
        by the run's own stepper."""
        forward = self.step_control is not None and self.step_control.forward
        located = EVENT_TOLERANCE if self.step_control and not forward else None
        return RefinedSteps(ends, parts, self.event_tolerance or located)

    def process_limits(self, name: str) -> Limits | None:
        """The limits of the FMU's own process; None where it has none."""
        table = self.components[name]
        return Limits(table.memory_limit_mb, self.call_time_limit) if table.own_process else None

    @property
    def exposed(self) -> list[str]:
        """Third-party FMUs in the process of the run, which they can end at any moment."""
        return [name for name, table in self.components.items() if table.untrusted and not table.own_process]

    @property
    def record_every(self) -> int:
        """Macro steps from one record to the next; the end is always recorded."""
        if self.step_control is not None:
            return 1
        every = round((self.output_step or self.macro_step) / self.macro_step)
        if self.reference.enabled:
            every = min(every, int(self.stop_time / (COMPARED_INTERVALS * self.macro_step) + 1e-9))
        return max(1, every)


def _place_option(fault: Fault) -> Fault:
    """A fault of a master's option; others are the master's."""
    option, valued, rest = fault.said.partition(" = ") if isinstance(fault.said, str) else ("", "", "")
    named = fault.place or option.removeprefix(": ")
    if valued and named.partition("[")[0].isidentifier():
        return replace(fault, place=named, said=valued + rest)
    return replace(fault, place="", said=(": ", fault.place, fault.said)) if fault.place else fault


def build_scenario(content: Mapping[str, Any]) -> Scenario:
    """Build a scenario from a file's content, which is not changed; ScenarioError with a line for each
    fault."""
    try:
        return Scenario.model_validate(share_oil(convert_to_seconds(content)))
    except ValidationError as error:
        faults = [_send_on(one, content) for one in find_faults(error, _list_keys)]
        raise ScenarioError.of([*faults, *_find_unconnected(content)]) from None
    except Faults as error:
        raise ScenarioError.of(error.faults) from None


def _find_unconnected(content: Mapping[str, Any]) -> Iterator[Fault]:
    """The ends of connections at components that the content does not have."""
    lines, known = content.get("connections"), content.get("components")
    if not isinstance(lines, list) or not isinstance(known, dict):
        return
    for line in lines:
        with suppress(ValueError):
            read = parse_line(str(line))
            for end in (read.source, read.target):
                if (name := end.partition(".")[0]) not in known:
                    yield Fault("connections", f": {line!r}: no component {name!r}", suggestion(name, known))


def _send_on(fault: Fault, content: Mapping[str, Any]) -> Fault:
    """The remedy names what is meant: the table that knows a key, another component, or quotes."""
    table, _, key = fault.place.rpartition(".")
    near, written, known = fault.remedy, content.get(table), content.get("components")
    if table == "tolerance" and isinstance(written, dict) and isinstance(written.get(key), dict):
        name, value = next(iter(written[key].items()), ("OUTPUT", "1e-3"))
        return replace(fault, remedy=f'write "{key}.{name}" = {value}')
    if key == "component" and fault.said == ": missing" and isinstance(known, dict):
        name = table.removeprefix("components.")
        if close := difflib.get_close_matches(name, [other for other in known if other != name], n=1):
            return replace(fault, remedy=f"did you mean components.{close[0]}?")
    other = OILS.get(key, "")
    if fault.said == f": missing beside {other}" and other in content and isinstance(known, dict) and table:
        of_all = f"set {other} = {known[table.removeprefix('components.')][other]!r} of the scenario"
        return replace(
            fault, remedy=f"{of_all}, which every part has, or give this part its own {key}, {near}"
        )
    if not isinstance(near, str) or not near.startswith("known: "):
        return fault
    if not table and (meant := find_tables(key)):
        return replace(fault, remedy=f"did you mean {' or '.join(meant)}?")
    if table and key in Scenario.model_fields:
        return replace(fault, remedy=f"put {key} above the file's first [table]")
    if table.startswith("components."):
        tables = _list_tables(content, table.removeprefix("components."))
        return replace(fault, remedy=find_place(key, tables, near))
    return fault


def _list_tables(content: Mapping[str, Any], name: str) -> Mapping[str, Sequence[str]]:
    """The names that the tables of a component know; none where it cannot be built."""
    try:
        component = build_component(str(content["components"][name]["component"]))
    except (KeyError, TypeError, ValueError):
        return {}
    return list_names(
        component, content["components"][name].get("parameters", {}), f"[components.{name}.{{}}]"
    )


OILS = {"oil": "temperature", "temperature": "oil"}
TABLES: dict[str, type[Table]] = {
    "step_control": StepControlTable,
    "reference": ReferenceTable,
    "energy": EnergyTable,
}


def _list_keys(location: Location) -> list[str]:
    """The valid keys at the place of an unknown one."""
    if len(location) == 1:
        return [*Scenario.model_fields, "extends", "without"]
    if location[0] == "components":
        return list(ComponentTable.model_fields)
    return list(TABLES[str(location[0])].model_fields)


def find_tables(key: str) -> list[str]:
    """The keys TABLE.KEY that `key` alone may stand for."""
    known = {name: list(table.model_fields) for name, table in TABLES.items()}
    known["master"] = [option.name for master in MASTERS.values() for option in fields(master)]
    return [f"{name}.{key}" for name, keys in known.items() if key in keys]
