"""The brief of a design: what may vary, what is wanted, and the limits; read from a TOML file."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, Field, ValidationError, model_validator

from ...analyses import Result
from ...errors import MistakeError, list_faults, one_of
from ...scenario import find_faults
from ...scenario.fields import Table
from ...scenario.files import find, list_shipped, read_changed
from ...scenario.scenario import Scenario
from ...scenario.system import list_parameters
from ...scenario.units import is_bare, to_unit
from ...scenario.values import parse_value
from ...texts import read_toml, to_path
from ..points import list_keys, parse_table
from ..speeds.subject import check_varied
from .wires import WireLength

SHIPPED = Path(__file__).parent / "shipped"
# A limit that is that of the scenario's own cam, and one that is not there.
OWN, FREE = "own", "free"
FEWEST, MOST = 8, 40


def _read(value: Any, unit: str, example: str) -> float:
    """A number with its unit: those of a speed or an angle would pass unseen in another one."""
    if unit == "1" and type(value) in (int, float):
        return float(value)
    if not isinstance(value, str) or (unit != "1" and is_bare(value)):
        raise ValueError(f'{value}: write the number with its unit, such as "{example}"')
    return to_unit(value, unit)


def _read_positive(value: Any, unit: str, example: str, or_else: str = "") -> float:
    number = _read(value, unit, example)
    if not number > 0.0:
        raise ValueError(f"{value}: must be > 0{or_else}")
    return number


def _limit(unit: str, example: str) -> BeforeValidator:
    def parse(value: Any) -> float | str:
        if value in (OWN, FREE):
            return str(value)
        return _read_positive(value, unit, example, f', "{OWN}" or "{FREE}"')

    return BeforeValidator(parse)


Size = float | str
Length = Annotated[Size, _limit("m", "8 mm")]


class Limits(Table):
    """Limits; "own": as the scenario's own cam has it, "free": none.

    Velocity, acceleration and jerk are those of the lift at the separation speed.
    """

    # Of the flywheel, up to which contact is kept.
    separation_speed: Annotated[Size, _limit("rad/s", "3000 rpm")] = OWN
    largest_lift: Length = OWN
    # Of the nose.
    least_lift: Length = FREE
    largest_velocity: Annotated[Size, _limit("m/s", "4 m/s")] = FREE
    largest_acceleration: Annotated[Size, _limit("m/s2", "3000 m/s2")] = FREE
    largest_deceleration: Annotated[Size, _limit("m/s2", "3000 m/s2")] = FREE
    largest_jerk: Annotated[Size, _limit("m/s3", "1e7 m/s3")] = FREE
    largest_pressure_angle: Annotated[Size, _limit("rad", "22 deg")] = OWN
    # How far from its middle a flat follower is touched: half its width.
    largest_offset: Length = FREE
    # Of curvature, where the cam is convex.
    least_radius: Length = OWN
    # Of curvature in the middle third of the event, above which a nose is called flat.
    largest_nose_radius: Length = FREE
    # Of the grinding wheel that a hollow flank takes; own: no hollow, where there is none.
    wheel_radius: Length = OWN
    # Of the crank, over which the cam lifts by 1 mm or more, about the middle of its event.
    largest_duration: Annotated[Size, _limit("rad", "240 deg")] = FREE
    # By Hertz, of each contact.
    peak_pressure: Annotated[Size, _limit("Pa", "600 MPa")] = OWN
    # Of each contact while the cam lifts.
    least_load: Annotated[Size, _limit("N", "50 N")] = FREE
    # Travel left to coil bind, of each spring.
    least_gap: Length = FREE
    # Least film over roughness of the cam's contact, during the event.
    least_film_ratio: Annotated[Size, _limit("1", "0.8")] = OWN
    # Of the cam, over that of the scenario's, where it is not maximised.
    least_lift_area: Annotated[Size, _limit("1", "0.95")] = OWN
    # Of a valve with a seat, up to the speed of separation.
    largest_seating_velocity: Annotated[Size, _limit("m/s", "0.3 m/s")] = OWN
    largest_bounce: Length = OWN
    # Least load of the open valve over its spring's force.
    least_spring_margin: Annotated[Size, _limit("1", "0.2")] = FREE
    # Between valve and piston.
    least_clearance: Length = FREE


# Limits of figures of merit: the figure, and 1 where the limit is the most, -1 where it is the least.
FIGURES = {
    "largest_seating_velocity": ("seating_velocity", 1.0),
    "largest_bounce": ("bounce", 1.0),
    "least_spring_margin": ("spring_margin", -1.0),
    "least_clearance": ("least_clearance", -1.0),
}
# Those whose limits also hold up to the speed of separation.
LANDINGS = ("seating_velocity", "bounce")


class Ends(Table):
    """The least and the largest value of a figure of merit; "own": as with the scenario's own cam."""

    least: float | str | None = None
    most: float | str | None = None

    def read(self, value: float | str, name: str, figure: Result) -> float:
        try:
            return _read(value, figure.unit, f"1 {figure.display_unit or figure.unit}")
        except ValueError as error:
            raise MistakeError(f"figures.{name}: {error}") from None


def _positive(unit: str, example: str) -> BeforeValidator:
    return BeforeValidator(lambda value: _read_positive(value, unit, example))


class Ramps(Table):
    """Both ramps, of a cam that has them: their height, and their velocity per cam angle."""

    height: Annotated[float, _positive("m", "0.3 mm")]
    velocity: Annotated[float, _positive("m/rad", "0.015 mm/deg")]


Speed = Annotated[float, _positive("rad/s", "1000 rpm")]
Angle = Annotated[float, BeforeValidator(lambda value: _read(value, "rad", "110 deg"))]


class Brief(Table):
    """A design's file."""

    # A shipped one, or a path beside the file.
    scenario: str
    description: str = ""
    # The component with the cam, where the scenario has several.
    cam: str | None = None
    # Bumps that the lift is made of.
    coefficients: int = Field(30, ge=FEWEST, le=MOST, strict=True)
    # Both flanks alike, so that half as many coefficients vary.
    symmetric: bool = False
    # Cam angles at which the ramps join the event; left out, as the ramps: as in the scenario.
    event: tuple[Angle, Angle] | None = None
    ramps: Annotated[Ramps | None, BeforeValidator(lambda value: parse_table(Ramps, value))] = None
    # lift_area of the cam (left out), separation_speed, or a figure of merit at `speeds`.
    maximise: str | None = None
    minimise: str | None = None
    # Limits of figures of merit at `speeds`, by "part.figure".
    figures: dict[str, Annotated[Ends, BeforeValidator(lambda value: parse_table(Ends, value))]] = Field({})
    # Those that may vary, "component.name", each with its least and largest value.
    parameters: dict[str, tuple[float | str, float | str]] = Field({})
    # Of the flywheel, whose cycles keep the limits, besides those up to separation.
    speeds: list[Speed] = Field([])
    # Up to which the scenario's own separation is sought.
    highest_speed: Speed | None = None
    limits: Annotated[Limits, BeforeValidator(lambda value: parse_table(Limits, value))] = Limits()
    # Of the first optimum, and their seed.
    starts: int = Field(2, ge=1, le=20, strict=True)
    seed: int = Field(1, ge=0, strict=True)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.maximise and self.minimise:
            raise ValueError("maximise and minimise: give one of them")
        return self


@dataclass(frozen=True)
class Asked:
    """A brief with the tables of its scenario, how a file beside the result names that, and the settings."""

    brief: Brief
    tables: Mapping[str, Any]
    base: str | Path
    settings: Sequence[str] = ()


def list_briefs() -> dict[str, Path]:
    """The briefs that come with the program, by name."""
    return {path.stem: path for path in sorted(SHIPPED.glob("*.toml"))}


def read_brief(source: str, settings: Sequence[str] = ()) -> Asked:
    """That of a shipped brief or a file, or for a scenario the one without limits of its own.

    MistakeError with a line for each fault.
    """
    path = list_briefs().get(source, to_path(source))
    content: dict[str, Any] = {"scenario": source}
    folder = Path()
    if path.is_file() and path.suffix == ".toml" and source not in list_shipped():
        read = read_toml(path)
        if "components" not in read and "extends" not in read:
            content, folder = read, path.parent
    try:
        brief = Brief.model_validate(content)
    except ValidationError as error:
        faults = find_faults(error, lambda place: list_keys(Brief))
        raise MistakeError(list_faults(faults)) from None
    shipped = brief.scenario in list_shipped()
    base = brief.scenario if shipped else find(brief.scenario, folder).resolve()
    return Asked(brief, read_changed(str(base), settings), base, settings)


def read_bounds(
    brief: Brief, scenario: Scenario, flywheel: str, wires: Mapping[str, WireLength] = MappingProxyType({})
) -> dict[str, tuple[float, float]]:
    """The bounds of the parameters in SI units; MistakeError for unknown names and wrong values."""
    known = {name: one for name, one in list_parameters(scenario).items() if "[" not in name}
    known |= {name: one.size for name, one in wires.items()}
    found = {}
    for given, ends in brief.parameters.items():
        name = given.removeprefix("components.").replace(".parameters.", ".")
        if name not in known:
            raise MistakeError(f"parameters.{given}: {one_of(sorted(known), name)}")
        check_varied(name, flywheel)
        try:
            if name in wires:
                description, unit = "of the wire", wires[name].unit
                low, high = (_read_positive(end, unit, f"1 {unit}") for end in ends)
            else:
                part, _, parameter = name.partition(".")
                quantity = scenario.components[part].resolve().parameters.field(parameter).quantity
                description, unit = quantity.description, quantity.unit
                if quantity.jumps:
                    raise MistakeError(f"parameters.{given}: has no values in between; leave it out")
                low, high = (float(parse_value(quantity, end)) for end in ends)
        except ValueError as error:
            raise MistakeError(f"parameters.{given} ({description}): {error}") from None
        value = known[name]
        if not low < high:
            raise MistakeError(f"parameters.{given} = {list(ends)}: the first must be less than the second")
        if not low <= value <= high:
            raise MistakeError(
                f"parameters.{given} = {list(ends)}: the scenario's own value, {value:g} {unit}, "
                "must be between them"
            )
        found[name] = low, high
    return found
