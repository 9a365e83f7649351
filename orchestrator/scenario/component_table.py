"""The tables [components.NAME]."""

from __future__ import annotations

from pydantic import Field, ValidationInfo, field_validator

from models.component import Component

from ..errors import one_of
from ..values import Value, component_of, meanings
from .fields import Table, Written


class ComponentTable(Table):
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
