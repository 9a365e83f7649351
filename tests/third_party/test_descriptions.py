"""Descriptions that cannot be read are refused with the attribute that is wrong."""

from pathlib import Path

import pytest

from orchestrator.participants.description import DescriptionError, read_description

from .described import describe2, describe3, real2

Y = real2("y", 0, "output")
FAULTS = {
    "index": (
        {"structure": '<Outputs><Unknown index="9"/></Outputs>'},
        "Unknown has index = '9', which must be from 1 to 1",
    ),
    "no number": (
        {"structure": '<Outputs><Unknown index="one"/></Outputs>'},
        "index = 'one', which must be a whole number",
    ),
    "no index": (
        {"structure": "<Outputs><Unknown/></Outputs>"},
        "the element Unknown lacks the attribute index",
    ),
    "dependencies": (
        {"structure": '<Outputs><Unknown index="1" dependencies="7"/></Outputs>'},
        "dependencies = '7', which must be from 1 to 1",
    ),
    "guid": ({"guid": ""}, "fmiModelDescription lacks the attribute guid"),
    "reference": (
        {"variables": Y.replace('valueReference="0"', "")},
        "ScalarVariable 'y' lacks the attribute valueReference",
    ),
    "name": (
        {"variables": Y.replace('name="y"', "") + Y},
        "the element ScalarVariable lacks the attribute name",
    ),
    "type": (
        {"variables": real2("y", 0, "output", 'declaredType="length"')},
        "'y' has declaredType = 'length', which Type",
    ),
    "derivative": (
        {"variables": real2("y", 0, "output", 'derivative="4"')},
        "'y' has derivative = '4', which must be from",
    ),
}


@pytest.mark.parametrize(("changes", "said"), FAULTS.values(), ids=FAULTS)
def test_the_attribute_is_named(changes: dict[str, str], said: str, tmp_path: Path) -> None:
    path = describe2(tmp_path / "one.fmu", **({"variables": Y} | changes))
    with pytest.raises(DescriptionError, match=f"{said}.*, in its modelDescription.xml"):
        read_description(path)


def test_the_attribute_of_fmi_3_is_named(tmp_path: Path) -> None:
    variable = '<Float64 name="y" valueReference="0" causality="output" derivative="7"/>'
    with pytest.raises(DescriptionError, match="'y' has derivative = '7', which is the valueReference of no"):
        read_description(describe3(tmp_path / "one.fmu", variable))
