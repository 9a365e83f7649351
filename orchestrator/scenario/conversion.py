"""Linear transformations of connected values: unit conversions, factors and offsets."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from models.core.component import Component
from models.core.quantities import Quantity
from models.core.system import Instance, parse_port

from ..participants.description import Unit
from ..participants.third_party import ThirdPartyComponent
from ..participants.wrapping import Linear
from . import Line, ScenarioError
from .side_lines import check_equal_types
from .units import OFFSETS_AGREE, to_base_units

Transformations = dict[str, dict[str, Linear]]


def transform_inputs(
    instances: Mapping[str, Instance], lines: Sequence[Line]
) -> tuple[dict[str, Instance], Transformations]:
    """The instances with transformed inputs in the units of their sources, and the transformations that
    change values, by instance and variable.

    Units are converted if a third-party FMU is at one end and both ends state a unit. A line with a factor
    or an offset applies to the numbers themselves. ScenarioError for types that do not fit.
    """
    found: Transformations = {}
    units: dict[str, dict[str, str]] = {}
    for line in lines:
        source, target = (
            parse_port(line.source, instances, "output"),
            parse_port(line.target, instances, "input"),
        )
        ends = instances[source.instance].component, instances[target.instance].component
        given = ends[0].outputs.field(source.variable).quantity
        wanted = ends[1].inputs.field(target.variable).quantity
        linear = _find_linear(line, given, wanted, *ends)
        if linear is None:
            continue
        if linear != Linear():
            found.setdefault(target.instance, {})[target.variable] = linear
        if linear != Linear() or given.unit != wanted.unit:
            units.setdefault(target.instance, {})[target.variable] = given.unit
    seen = {name: _replace_units(one, units.get(name, {})) for name, one in instances.items()}
    return seen, found


def _find_linear(
    line: Line, given: Quantity, wanted: Quantity, source: Component, target: Component
) -> Linear | None:
    """The transformation of a line; None between two of our components, whose units the system compares."""
    if wanted.discrete and not given.discrete:
        kind = "true or false" if wanted.boolean else "whole numbers"
        raise ScenarioError(f"{line}: a real number does not fit an input that takes {kind}")
    if line.factor is not None or line.offset is not None:
        return Linear(1.0 if line.factor is None else line.factor, line.offset or 0.0)
    if wanted.discrete:
        check_equal_types(line, source, target)
    if not (isinstance(source, ThirdPartyComponent) or isinstance(target, ThirdPartyComponent)):
        return None
    known = get_units(source), get_units(target)
    linear = convert_units(given.unit, known[0], wanted.unit, known[1], given.relative and wanted.relative)
    if linear is None and given.unit != wanted.unit:
        both = zip((given.unit, wanted.unit), known, strict=True)
        odd = next((unit for unit, defined in both if find_unit(unit, defined) is None), "")
        raise ScenarioError(
            f"{line}: unit {given.unit} does not fit {wanted.unit}"
            f"{f' ({odd} is an unknown unit)' if odd else ''}; connect another output, or "
            f"{_explain_factor(line, given, wanted, *known)}"
        )
    if linear is not None and linear.offset and given.relative != wanted.relative:
        raise ScenarioError(f"{line}: {explain_differences(line.source, line.target, given.relative)}")
    if given.unit == wanted.unit and linear == Linear():
        return linear  # the common definitions take long to read
    usual = convert_units(given.unit, {}, wanted.unit, {}, given.relative and wanted.relative)
    if linear and usual and abs(usual.offset - linear.offset) > OFFSETS_AGREE * _find_size(given, wanted):
        meant, defined = (replace(line, factor=way.factor, offset=way.offset) for way in (usual, linear))
        raise ScenarioError(
            f"{line}: {given.unit} to {wanted.unit} adds {usual.offset:g}, but {linear.offset:g} by the "
            f"definitions of the FMUs; write what is meant: {meant}, or {defined}"
        )
    return linear


def _explain_factor(
    line: Line, given: Quantity, wanted: Quantity, here: Mapping[str, Unit], there: Mapping[str, Unit]
) -> str:
    """What to write for units that do not fit. One that is unknown, or C, may be of a temperature."""
    ways = []
    for scale in () if given.relative and wanted.relative else ("degC", "K"):
        if _is_unclear(given.unit, here):
            way = convert_units(scale, {}, wanted.unit, there)
        else:
            way = convert_units(given.unit, here, scale, {}) if _is_unclear(wanted.unit, there) else None
        if way:
            ways.append(f"for {scale} {replace(line, factor=way.factor, offset=way.offset or None)}")
    return f"write {', '.join(ways)}" if ways else f"write the factor: {line.source} * 1 -> {line.target}"


def _is_unclear(unit: str, units: Mapping[str, Unit]) -> bool:
    """Whether it is unknown, or the coulomb by its name only."""
    return find_unit(unit, units) is None or (unit == "C" and unit not in units)


def _find_size(given: Quantity, wanted: Quantity) -> float:
    """The larger of the two units' common offsets, in the wanted unit."""
    common = [unit for one in (given, wanted) if (unit := to_base_units(one.unit))]
    return max((abs(unit.offset / common[-1].factor) for unit in common), default=0.0)


def _replace_units(instance: Instance, units: Mapping[str, str]) -> Instance:
    """The instance with these units of inputs."""
    if not units:
        return instance
    inputs = instance.component.inputs
    changed = (
        replace(f, quantity=replace(f.quantity, unit=units.get(f.name, f.quantity.unit)))
        for f in inputs.fields
    )
    return replace(instance, component=replace(instance.component, inputs=inputs.with_fields(changed)))


def get_units(component: Component) -> Mapping[str, Unit]:
    """Those that a third-party FMU defines."""
    return component.about.units if isinstance(component, ThirdPartyComponent) else {}


def explain_differences(source: str, target: str, given: bool) -> str:
    """Why a unit with an offset does not tell what goes from one to the other, and the remedy."""
    one, other = (source, target) if given else (target, source)
    return (
        f"{one} is a difference (relativeQuantity) and {other} is not, so that the offset of the unit is in "
        f"doubt; write what is meant: {source} * 1 + 0 -> {target}"
    )


def convert_units(
    given: str,
    given_units: Mapping[str, Unit],
    wanted: str,
    wanted_units: Mapping[str, Unit],
    relative: bool = False,
) -> Linear | None:
    """The conversion between two units, by these definitions or the common ones, of differences if
    `relative`; None if they do not fit or are unknown."""
    if not given or not wanted:
        return Linear()  # no unit is stated
    one, other = find_unit(given, given_units), find_unit(wanted, wanted_units)
    if one is None or other is None or one.exponents != other.exponents:
        return None
    offset = 0.0 if relative else (one.offset - other.offset) / other.factor
    return Linear(one.factor / other.factor, offset)


def find_unit(unit: str, units: Mapping[str, Unit]) -> Unit | None:
    """By these definitions, or the common ones; None for an unknown one."""
    return units.get(unit) or to_base_units(unit)
