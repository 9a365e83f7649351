"""The tables of a tolerance file."""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, ValidationError

from ...errors import MistakeError, list_faults, name_source
from ...scenario import Written, find_faults
from ...texts import read_toml
from ..points import Table, list_keys, parse_table

# Trains of a sample: fewer say nothing of a percentile.
FEWEST, MOST = 16, 2**20


class Normal(Table):
    """A normal distribution, cut off below `low` and above `high`."""

    kind: Literal["normal"]
    deviation: Written = Field(description="Standard deviation, before the cut; 3 % are of the mean")
    mean: Written | None = Field(None, description="Default: the scenario's value")
    low: Written | None = None
    high: Written | None = None


class Uniform(Table):
    """All values from `low` to `high` alike."""

    kind: Literal["uniform"]
    low: Written
    high: Written


class Measured(Table):
    """Values that were measured: the column of a CSV file, with its unit in the head."""

    kind: Literal["measured"]
    file: Path
    column: str | None = Field(None, description="Default: the only one")


class Listed(Table):
    """Values that were measured."""

    kind: Literal["values"]
    values: list[Written] = Field(min_length=2)


Distributed = Normal | Uniform | Measured | Listed
KINDS: dict[str, type[Distributed]] = {
    "normal": Normal,
    "uniform": Uniform,
    "measured": Measured,
    "values": Listed,
}


def _parse_distribution(content: Any) -> Distributed:
    if not isinstance(content, dict) or content.get("kind") not in KINDS:
        raise ValueError(f"must be a table with a kind, one of {', '.join(KINDS)}")
    return parse_table(KINDS[content["kind"]], content)


class Correlation(Table):
    """Of the normal scores of two parameters."""

    parameters: tuple[str, str]
    coefficient: float = Field(gt=-1.0, lt=1.0)


class Grinding(Table):
    """Errors of a cam's lift: amplitudes (a length) by the number of waves on a turn, with random phases."""

    amplitudes: dict[int, Written] = Field(min_length=1)


class Tolerances(Table):
    """A tolerance file."""

    speed: Written = Field(description="Of the flywheel")
    parameters: dict[str, Annotated[Distributed, BeforeValidator(_parse_distribution)]] = Field(
        {}, description="Distributions by component.parameter"
    )
    correlations: list[Correlation] = Field([], description="Of parameters with distributions")
    grinding: dict[str, Grinding] = Field({}, description="Errors of lift by the cam's component")
    limits: list[str] = Field([], description='Such as "seating_velocity < 0.4 m/s"')
    count: int = Field(1024, ge=FEWEST, le=MOST, strict=True, description="Trains; a power of two")
    indices: bool = Field(True, description="Whether Sobol' indices are found, with more trains")
    seed: int = Field(0, ge=0, strict=True)


def read_tolerances(path: Path) -> Tolerances:
    """MistakeError with the file's name for each fault; files of measured values lie beside it."""
    content = read_toml(path)
    try:
        found = parse_tolerances(content)
    except MistakeError as error:
        raise MistakeError(name_source(path.name, error)) from None
    beside = {
        name: one.model_copy(update={"file": path.parent.absolute() / one.file})
        if isinstance(one, Measured)
        else one
        for name, one in found.parameters.items()
    }
    return found.model_copy(update={"parameters": beside})


def parse_tolerances(content: Any) -> Tolerances:
    """Check a file's content; MistakeError with a line for each fault."""
    try:
        found = Tolerances.model_validate(content)
    except ValidationError as error:
        raise MistakeError(list_faults(find_faults(error, lambda place: list_keys(Tolerances)))) from None
    if found.count & (found.count - 1):
        raise MistakeError(f"count = {found.count}: must be a power of two, for Sobol' points to be balanced")
    if not found.parameters and not found.grinding:
        raise MistakeError(
            "parameters: missing; give the distribution of one, or the grinding errors of a cam"
        )
    return found
