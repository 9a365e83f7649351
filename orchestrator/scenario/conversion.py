"""Linear transformations of connected values: unit conversions, factors and offsets."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from models.core.quantities import Layout, Quantity
from models.core.system import Instance, parse_port

from ..participants.description import Unit
from ..participants.third_party import ThirdPartyComponent
from ..participants.wrapping import Linear
from . import Line, ScenarioError
from .side_lines import check_equal_types
from .units import to_base_units

Transformations = dict[str, dict[str, Linear]]


def find_transformations(instances: Mapping[str, Instance], lines: Sequence[Line]) -> Transformations:
    """The transformations of inputs, by instance and variable.

    Units are converted if a third-party FMU is at one end and both ends state a unit. A line with a factor
    or an offset applies to the numbers themselves. ScenarioError for types that do not fit.
    """
    found: Transformations = {}
    for line in lines:
        source, target = (
            parse_port(line.source, instances, "output"),
            parse_port(line.target, instances, "input"),
        )
        given = instances[source.instance].component.outputs.field(source.variable).quantity
        wanted = instances[target.instance].component.inputs.field(target.variable).quantity
        if wanted.discrete and not given.discrete:
            kind = "true or false" if wanted.boolean else "whole numbers"
            raise ScenarioError(f"{line}: a real number does not fit an input that takes {kind}")
        plain = line.factor is None and line.offset is None
        if wanted.discrete and plain:
            ends = source.instance, target.instance
            check_equal_types(line, *(instances[name].component for name in ends))
        if not plain:
            linear: Linear | None = Linear(1.0 if line.factor is None else line.factor, line.offset or 0.0)
        else:
            units = [_get_units(instances[end.instance]) for end in (source, target)]
            linear = _convert(given, units[0], wanted, units[1])
            if linear is None and units != [None, None] and given.unit != wanted.unit:
                both = zip((given, wanted), units, strict=True)
                odd = next((q.unit for q, known in both if find_unit(q.unit, known or {}) is None), "")
                raise ScenarioError(
                    f"{line}: unit {given.unit} does not fit {wanted.unit}"
                    f"{f' ({odd} is an unknown unit)' if odd else ''}; connect another output, or write the "
                    f"factor: {line.source} * 1 -> {line.target}"
                )
            if linear is not None and linear.offset and given.relative != wanted.relative:
                raise ScenarioError(
                    f"{line}: {explain_differences(line.source, line.target, given.relative)}"
                )
        if linear is not None and (linear != Linear() or given.unit != wanted.unit):
            found.setdefault(target.instance, {})[target.variable] = linear
    return found


def select_changing(found: Transformations) -> Transformations:
    """Those that change values."""
    changing = {
        name: {variable: linear for variable, linear in inputs.items() if linear != Linear()}
        for name, inputs in found.items()
    }
    return {name: inputs for name, inputs in changing.items() if inputs}


def replace_units(
    instances: Mapping[str, Instance], lines: Sequence[Line], made: Transformations
) -> dict[str, Instance]:
    """The instances with transformed inputs in the units of their sources."""
    changed: dict[str, dict[str, Quantity]] = {}
    for line in lines:
        source, target = (
            parse_port(line.source, instances, "output"),
            parse_port(line.target, instances, "input"),
        )
        if target.variable in made.get(target.instance, {}):
            unit = instances[source.instance].component.outputs.field(source.variable).quantity.unit
            own = instances[target.instance].component.inputs.field(target.variable).quantity
            changed.setdefault(target.instance, {})[target.variable] = replace(own, unit=unit)
    return {
        name: replace(
            i, component=replace(i.component, inputs=_replace_quantities(i.component.inputs, changed[name]))
        )
        if name in changed
        else i
        for name, i in instances.items()
    }


def _replace_quantities(layout: Layout, quantities: Mapping[str, Quantity]) -> Layout:
    """A copy of the layout with these quantities."""
    return layout.with_fields(replace(f, quantity=quantities.get(f.name, f.quantity)) for f in layout.fields)


def _get_units(instance: Instance) -> Mapping[str, Unit] | None:
    """The units that a third-party FMU defines; None for other components."""
    component = instance.component
    return component.about.units if isinstance(component, ThirdPartyComponent) else None


def explain_differences(source: str, target: str, given: bool) -> str:
    """Why a unit with an offset does not tell what goes from one to the other, and the remedy."""
    one, other = (source, target) if given else (target, source)
    return (
        f"{one} is a difference (relativeQuantity) and {other} is not, so that the offset of the unit is in "
        f"doubt; write what is meant: {source} * 1 + 0 -> {target}"
    )


def _convert(
    given: Quantity,
    given_units: Mapping[str, Unit] | None,
    wanted: Quantity,
    wanted_units: Mapping[str, Unit] | None,
) -> Linear | None:
    """The conversion; None between two of our components, whose units the system compares."""
    if given_units is None and wanted_units is None:
        return None
    relative = given.relative and wanted.relative
    return convert_units(given.unit, given_units or {}, wanted.unit, wanted_units or {}, relative)


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
