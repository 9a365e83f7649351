"""The table [master]."""

from dataclasses import fields
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, field_validator

from models.core.system import suggestion

from ..masters import find_master
from .values import Faults


class MasterTable(BaseModel):
    """The co-simulation master; other keys are options of that master."""

    model_config = ConfigDict(extra="allow", frozen=True)

    name: str = Field("gauss_seidel", description="Name of the master, or your own as module:object")

    @field_validator("name")
    @classmethod
    def _check_name(cls, name: str) -> str:
        find_master(name)
        return name

    def build(self) -> Any:
        """The master with its options; ValidationError or ValueError for wrong options."""
        kind = find_master(self.name)
        options = dict(self.model_extra or {})
        known = [field.name for field in fields(kind)]
        for key in options:
            if key not in known:
                raise Faults((key, f": {self.name} has no such option; {suggestion(key, known)}"))
        return TypeAdapter(kind).validate_python(options)
