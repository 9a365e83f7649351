"""Signals by what they are: discrete ones are held over a macro step, differences have no offset."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestrator.analyses.stability.choice import choose
from orchestrator.participants.wrapping import Linear
from orchestrator.reporter import Reporter
from orchestrator.scenario import ScenarioError
from orchestrator.scenario.system import assemble, resolve
from orchestrator.scenario.warnings import list_warnings

from .c_fmus import describe2, describe3, fmu, real2
from .runs import completed, ran, scenario

LINES = [
    "switch.gear -> lookup.gear",
    "switch.gear -> lookup.level",
    "switch.on -> lookup.flag",
    "switch.ramp -> lookup.sampled",
]
CASES: list[tuple[int, dict[str, Any]]] = [
    (2, {}),
    (2, {"master": {"name": "jacobi", "extrapolation": "quadratic"}}),
    (3, {"master": {"name": "iterated", "extrapolation": "hermite"}}),
    (2, {"step_control": {"estimator": "step_doubling", "maximum_step": 0.02}, "stop_time": 0.2}),
]


@pytest.mark.parametrize(("version", "changes"), CASES)
def test_no_value_arrives_that_was_never_there(version: int, changes: dict[str, Any], tmp_path: Path) -> None:
    """A Real that is discrete and a Boolean, into Reals; and a discrete input samples a continuous value."""
    tables = {name: {"participant": fmu(name, version, tmp_path)} for name in ("switch", "lookup")}
    one = scenario(tables, connections=LINES, **changes)
    (told,) = [line for line in list_warnings(one) if "discrete" in line]
    assert told.startswith("switch.gear, switch.on: discrete, so held over each macro step")
    found = completed(one, tmp_path / "out")
    assert set(found["switch.gear"]) == {0.0, 1.0}
    assert found["lookup.strange"][-1] == 0.0
    if one.step_control is None:  # which makes a step in two halves
        np.testing.assert_array_equal(found["lookup.seen"][1:], found["switch.ramp"][:-1])


def test_no_error_is_predicted_of_what_is_discrete(tmp_path: Path) -> None:
    """Neither by `analyse` nor for the choice of `auto`."""
    tables = {name: {"participant": fmu(name, 2, tmp_path)} for name in ("switch", "lookup")}
    one = scenario(tables, connections=LINES, tolerance={"switch.ramp": 1e-3}, master={"name": "auto"})
    with pytest.raises(ScenarioError, match=r"'auto': switch\.gear, switch\.on: declared discrete"):
        choose(resolve(one), Reporter())


@pytest.mark.parametrize(("count", "factor", "said"), [(2, 0.25, "gets 0.5"), (3, 1e9, "gets 3000000000")])
def test_numbers_that_are_not_whole_or_too_large_are_refused(count, factor, said, tmp_path: Path) -> None:
    """Of an Integer of 32 bits, which would round or turn over."""
    given = {"participant": fmu("feedthrough", 2, tmp_path), "parameters": {"count": count}}
    tables = {"a": given, "b": {"participant": given["participant"]}}
    one = scenario(tables, connections=[f"a.whole_out * {factor} -> b.whole_in"], stop_time=0.02)
    with pytest.raises(ScenarioError, match=f"b.whole_in {said}: must be a whole number from -2147483648 to"):
        ran(one, tmp_path / "out")
    with pytest.raises(ValueError, match="must be a whole number >= -2147483648"):
        ran(scenario({"a": given | {"inputs": {"whole_in": 3e9}}}), tmp_path / "out")


RELATIVE = 'relativeQuantity="true"'
TYPES = f'<SimpleType name="rise"><Real unit="degC" {RELATIVE}/></SimpleType>'
TYPES3 = f'<Float64Type name="rise" unit="degC" {RELATIVE}/>'
KELVIN = f'unit="K" {RELATIVE}'
# The attributes of an output in degC, and of an input in K; those of FMI 3.0 stand in one element.
DIFFERENCES = {
    "by themselves": (2, f'unit="degC" {RELATIVE}', KELVIN),
    "by their type": (2, 'declaredType="rise"', KELVIN),
    "of FMI 3.0": (3, f'unit="degC" {RELATIVE}', KELVIN),
    "by their type of FMI 3.0": (3, 'declaredType="rise"', KELVIN),
}


def connected(version: int, output: str, wanted: str, folder: Path) -> Linear:
    """What becomes of the value on its way."""
    if version == 2:
        one = describe2(folder / "a.fmu", real2("y", 0, "output", output), types=TYPES)
        other = describe2(folder / "b.fmu", real2("u", 0, "input", f'{wanted} start="0"'))
    else:
        one = describe3(
            folder / "a.fmu",
            f'<Float64 name="y" valueReference="0" causality="output" {output}/>',
            types=TYPES3,
        )
        other = describe3(
            folder / "b.fmu", f'<Float64 name="u" valueReference="0" causality="input" start="0" {wanted}/>'
        )
    tables = {"a": {"participant": one}, "b": {"participant": other}}
    linear = assemble(scenario(tables, connections=["a.y -> b.u"])).linear
    return linear.get("b", {}).get("u", Linear())


@pytest.mark.parametrize(("version", "output", "wanted"), DIFFERENCES.values(), ids=DIFFERENCES)
def test_differences_have_no_offset(version: int, output: str, wanted: str, tmp_path: Path) -> None:
    """5 degC of difference are 5 K."""
    assert connected(version, output, wanted, tmp_path) == Linear()


def test_a_variable_overrides_its_type(tmp_path: Path) -> None:
    output = 'declaredType="rise" relativeQuantity="false"'
    assert connected(2, output, 'unit="K"', tmp_path) == Linear(1.0, 273.15)


def test_a_difference_to_a_temperature_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"a\.y is a difference \(relativeQuantity\) and b\.u is not"):
        connected(2, f'unit="degC" {RELATIVE}', 'unit="K"', tmp_path)


def test_an_offset_that_a_definition_leaves_out_is_asked_for(tmp_path: Path) -> None:
    """An FMU that gives degF no offset has made a mistake, or means differences."""
    with pytest.raises(
        ScenarioError, match=r"degF to K adds 255\.372, but 0 by .*: a\.y \* 0\.555.* \+ 255\.372"
    ):
        connected(2, 'unit="degF"', 'unit="K"', tmp_path)
    assert connected(2, 'unit="degF"', 'unit="degF"', tmp_path) == Linear()
    assert connected(2, f'unit="degF" {RELATIVE}', KELVIN, tmp_path).offset == 0.0
    rounded = connected(2, 'unit="celsius"', 'unit="degC"', tmp_path)  # by two tools with other digits
    assert rounded.offset == pytest.approx(1e-7, rel=1e-3)


@pytest.mark.parametrize(
    ("output", "wanted", "said"),
    [
        ("C", "K", r"write for degC a\.y \* 1\.0 \+ 273\.15 -> b\.u, for K a\.y \* 1\.0 -> b\.u"),
        ("warm", "degC", r"write for degC a\.y \* 1\.0 -> b\.u, for K a\.y \* 1\.0 - 273\.15 -> b\.u"),
        ("degC", "C", r"write for degC a\.y \* 1\.0 -> b\.u, for K a\.y \* 1\.0 \+ 273\.15 -> b\.u"),
        ("N", "K", r"write the factor: a\.y \* 1 -> b\.u"),
    ],
)
def test_what_may_be_a_temperature_is_to_be_connected_with_its_offset(
    output: str, wanted: str, said: str, tmp_path: Path
) -> None:
    with pytest.raises(ScenarioError, match=f"unit {output} does not fit {wanted}.*, or {said}"):
        connected(2, f'unit="{output}"', f'unit="{wanted}"', tmp_path)


def test_a_value_whose_unit_lacks_its_offset_is_a_plain_number(tmp_path: Path) -> None:
    """68 degF would be 293.15 of the FMU's own, or 37.8."""
    start = 'start="0"'
    variables = real2("T", 0, "parameter", f'unit="degF" {start}', "fixed")
    variables += real2("t", 1, "parameter", f'unit="celsius" {start}', "fixed")
    file = describe2(tmp_path / "a.fmu", variables)

    def given(**parameters: object) -> object:
        return scenario({"a": {"participant": file, "parameters": parameters}}).components["a"].parameters

    with pytest.raises(
        ScenarioError, match=r"parameters\.T = '293.15 K': .* degF with its zero at 0, not 255\.37"
    ):
        given(T="293.15 K")
    assert given(T=68, t="293.15 K") == {"T": 68.0, "t": pytest.approx(20.0)}
    assert given(T="68 degF") == {"T": 68.0}


def test_values_of_differences_have_no_offset(tmp_path: Path) -> None:
    """Nor is 5 degC of a difference without a unit another number in K."""
    rise = real2("dT", 0, "parameter", f'{KELVIN} start="0"', "fixed")
    other = real2("dC", 1, "parameter", f'unit="degC" {RELATIVE} start="0"', "fixed")
    file = describe2(tmp_path / "a.fmu", rise + other)
    one = scenario({"a": {"participant": file, "parameters": {"dT": "5 degC", "dC": 5.0}}})
    assert one.components["a"].parameters == {"dT": 5.0, "dC": 5.0}
    assert not [line for line in list_warnings(one) if "unit" in line]
