"""The tables [components.NAME]."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from pydantic import (
    Field,
    PrivateAttr,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    field_validator,
    model_validator,
)
from pydantic.functional_validators import ModelWrapValidatorHandler

from fmus.fmi.origin import is_built_here
from models.core.component import Component
from models.core.quantities import Condition

from ..errors import Fault, one_of
from ..participants.description import CO_SIMULATION, Description, read_description
from ..participants.third_party import ThirdPartyComponent, read_component
from .arrays import check_resized, check_sizes, spread_arrays, spread_lists
from .drawing import ShaftDrawing
from .fields import Given, Table, Written
from .force_table import ForceTable
from .insertions import insert_all
from .lift_table import LiftSegments
from .oil import OilSheet, Temperature
from .third_party_values import check_offsets, convert_enumerations, select_strings
from .values import (
    SECTIONS,
    Faults,
    Value,
    build_component,
    find_idle,
    list_layouts,
    list_names,
    parse_values,
)
from .wire import Wire

BUILT_KINDS = ("fmu", "native")
KINDS = (*BUILT_KINDS, "in-process")


class ComponentTable(Table):
    """One component of the system. Values are in SI units, or strings with a unit ("8 mm")."""

    participant: str = Field(
        "fmu",
        description="fmu: the component's own FMU, built when needed; native: the same in machine code; "
        "in-process: without FMI; or the path of an .fmu file: with the component's variables, or any other "
        "that stands for itself",
    )
    process: Literal["shared", "own"] | None = Field(
        None,
        description="own: the FMU runs in a process of its own, so that it cannot end the run's; shared: in "
        "the run's, faster; left out: own for .fmu files that your tribocosim did not build, else shared",
    )
    interface: Literal["co_simulation", "model_exchange"] = Field(
        "co_simulation",
        description="co_simulation: a third-party FMU steps with its own solver; model_exchange: its "
        "equations are integrated here, with located events; an FMU that has only one takes part by that",
    )
    memory_limit_mb: int | None = Field(
        None,
        description="Most memory (MB) that the FMU's own process may allocate (Linux); left out: no limit",
        ge=100,
        strict=True,
    )
    component: str | None = Field(
        None,
        description="Name of the component in the catalogue, or your own as module:factory; left out for an "
        ".fmu file that stands for itself",
        validate_default=True,
    )
    lift_table: str | None = Field(
        None,
        description="CSV file of cam angles and lifts, or .s96 file, for a cam through points; it becomes "
        "`structure` and `parameters`",
    )
    lift_segments: LiftSegments | None = Field(
        None,
        description="Cam by segments of its acceleration; it becomes `structure` and `parameters`",
        exclude=True,
    )
    pressure_table: str | None = Field(
        None,
        description="CSV file of crank angles and absolute pressures of a cycle, for cylinder_gas; it "
        "becomes `structure` and `parameters`",
    )
    drawing: ShaftDrawing | None = Field(
        None,
        description="Drawing of a shaft; it becomes the modes of the component shaft, in `structure` and "
        "`parameters`",
    )
    oil: str | OilSheet | None = Field(
        None,
        description="Oil of a contact, bearing or lash adjuster: a grade, or a table of its data; with "
        "`temperature` it becomes `parameters`",
        exclude=True,
    )
    temperature: Temperature | None = Field(
        None,
        description="Temperature of the oil, at the inlet of a contact (K, or a text with a unit)",
        exclude=True,
    )
    force_table: ForceTable | None = Field(
        None,
        description="Measured force of a coil_spring over its travel from the closed valve: rows of both; it "
        "becomes `parameters`",
        exclude=True,
    )
    wire: Wire | None = Field(
        None,
        description="Wire and coils of a coil_spring or valve_spring; it becomes `parameters`",
        exclude=True,
    )
    structure: dict[str, int] = Field(
        {}, description="Structural sizes, e.g. coil_masses; structural parameters of an FMU of FMI 3.0"
    )
    substeps: int = Field(
        1, description="Steps that it makes of every macro step", ge=1, le=10_000, strict=True
    )
    retries: int | None = Field(
        None,
        description="How often a step that it discards is halved before the run fails; by default the run "
        "begins again with 10 if it discards one in a run that repeats no steps",
        ge=0,
        le=20,
        strict=True,
    )
    parameters: dict[str, Written] = Field({}, description="Parameters that differ from their defaults")
    start: dict[str, Written] = Field({}, description="Start values of states")
    inputs: dict[str, Written] = Field({}, description="Constant values of inputs that nothing drives")

    _notes: list[str] = PrivateAttr([])

    @model_validator(mode="wrap")
    @classmethod
    def _insert_tables(cls, table: Any, build: ModelWrapValidatorHandler[ComponentTable]) -> ComponentTable:
        """Replace tables, drawings and oils by what they become. A third-party FMU is read first: the other
        keys depend on its variables."""
        if not isinstance(table, dict):
            return build(table)
        file = table.get("participant")
        if table.get("component") is None and isinstance(file, str) and file.endswith(".fmu"):
            try:
                read_component(Path(file), str(table.get("interface", CO_SIMULATION)))
            except ValueError as error:
                raise Faults(("participant", f": {error}")) from None
        table, notes = insert_all(table)
        made = build(table)
        made._notes = notes
        return made

    @field_validator("participant")
    @classmethod
    def _check_participant(cls, kind: str) -> str:
        if kind in KINDS or kind.endswith(".fmu"):
            return kind
        raise ValueError(f"{kind!r}: {one_of(KINDS, kind)} (or the path of an .fmu file)")

    @field_validator("process")
    @classmethod
    def _check_process(cls, process: str | None, info: ValidationInfo) -> str | None:
        if process == "own" and info.data.get("participant") == "in-process":
            raise ValueError("'own': participant = 'in-process' needs no process; take participant = 'fmu'")
        return process

    @field_validator("component")
    @classmethod
    def _check_component(cls, name: str | None, info: ValidationInfo) -> str | None:
        participant = info.data.get("participant", "")
        if name is not None:
            build_component(name)
        elif participant and not participant.endswith(".fmu"):
            raise ValueError('missing; name one of the catalogue, or an FMU: participant = "FILE.fmu"')
        return name

    @field_validator("structure")
    @classmethod
    def _check_structure(cls, structure: dict[str, int], info: ValidationInfo) -> dict[str, int]:
        name = info.data.get("component")
        if name is not None:
            build_component(name, tuple(sorted(structure.items())))
        elif structure and {"participant", "component"} <= set(info.data):
            check_sizes(Path(info.data["participant"]), info.data["interface"], structure)
        return structure

    @field_validator(*SECTIONS, mode="wrap", json_schema_input_type=dict[str, Given])
    @classmethod
    def _read_values(cls, given: Any, check: ValidatorFunctionWrapHandler, info: ValidationInfo) -> Any:
        if not {"participant", "component", "structure"} <= set(info.data):
            return check(given)  # an earlier check has failed
        component = _resolve(info.data)
        layouts = list_layouts(component)
        kinds = {"parameters": "parameter", "start": "state", "inputs": "input"}
        assert info.field_name
        layout, chosen = layouts.pop(info.field_name), dict[str, Value]()
        values: dict[str, Value] = check(spread_lists(given, layout))
        if isinstance(component, ThirdPartyComponent):
            check_offsets(component, values)
            chosen = convert_enumerations(
                component, {key: value for key, value in values.items() if key in layout}
            )
            layouts["structure"] = component.sizes
            if info.field_name != "start":
                chosen |= select_strings(component, values, kinds[info.field_name].rpartition(" ")[2])
        others = spread_arrays({key: value for key, value in values.items() if key not in chosen}, layout)
        tables = list_names(
            component, values if info.field_name == "parameters" else info.data.get("parameters", {})
        )
        tables |= {name: other.variables for name, other in layouts.items() if name not in SECTIONS}
        del tables[info.field_name]
        tables["the component's own table, one level up"] = tuple(cls.model_fields)
        return parse_values(layout, others, kinds[info.field_name], tables) | chosen

    @model_validator(mode="after")
    def _check_resized(self) -> ComponentTable:
        component = self.resolve()
        if isinstance(component, ThirdPartyComponent):
            check_resized(component, self.parameters)
        idle = find_idle(component, self.parameters)
        if faults := [_refuse_idle(name, idle[name]) for name in self.start if name in idle]:
            raise Faults(*faults)
        return self

    @property
    def notes(self) -> list[str]:
        """What reading its files chose, and what it doubts."""
        return self._notes

    def __eq__(self, other: object) -> bool:
        """Whether they describe the same component, however its table of lifts was read."""
        return isinstance(other, ComponentTable) and dict(self) == dict(other)

    @property
    def third_party(self) -> bool:
        """Whether it is a third-party FMU."""
        return self.component is None

    @property
    def file(self) -> Path | None:
        """The .fmu file that it names."""
        return Path(self.participant) if self.participant.endswith(".fmu") else None

    @property
    def values(self) -> dict[str, dict[str, Value]]:
        """Its values by section."""
        return {section: getattr(self, section) for section in SECTIONS}

    @property
    def own_process(self) -> bool:
        """Whether its FMU runs in its own process."""
        return self.process == "own" or (self.process is None and self.untrusted)

    @property
    def untrusted(self) -> bool:
        """Whether it is an FMU file that this user's tribocosim did not build."""
        return self.file is not None and not is_built_here(self.file)

    @property
    def strings(self) -> dict[str, str]:
        """The strings and binary values of a third-party FMU."""
        component = self.resolve()
        known = component.about.strings if isinstance(component, ThirdPartyComponent) else []
        given = {**self.parameters, **self.inputs}
        return {name: str(value) for name, value in given.items() if name in known}

    def resolve(self) -> Component:
        """The catalogue's component with these sizes, or the third-party FMU's."""
        return _resolve(dict(self))

    def has_variable(self, name: str) -> bool:
        """Whether one of its inputs or outputs has this name."""
        component = self.resolve()
        if isinstance(component, ThirdPartyComponent):
            return name in component.about.variables
        return name in component.inputs or name in component.outputs

    def describe(self) -> Description:
        """The description of its .fmu file; DescriptionError if it cannot be used."""
        sizes = self.structure if self.third_party else {}
        return read_description(Path(self.participant), self.interface, sizes)


def _refuse_idle(name: str, rule: Condition) -> Fault:
    return Fault(
        f"start.{name}",
        f": has no effect, as {rule.parameters[0]} is not {rule.choices[0]!r}",
        f"set {rule.instead}, or parameters.{rule.parameters[0]} = {rule.choices[0]!r}",
    )


def _resolve(values: Mapping[str, Any]) -> Component:
    """The component of a table with these values."""
    if values["component"] is None:
        return read_component(Path(values["participant"]), values["interface"], values["structure"])
    return build_component(values["component"], tuple(sorted(values["structure"].items())))
