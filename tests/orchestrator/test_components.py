"""The page of the components' variables: it is current, and lacks none."""

from pathlib import Path

import pytest

from models.catalogue import CATALOGUE
from orchestrator.errors import MistakeError
from orchestrator.scenario.components import write_page

ROOT = Path(__file__).parents[2]


def test_the_published_page_is_current() -> None:
    """Otherwise: tribocosim components > docs/reference/components.md"""
    assert (ROOT / "docs" / "reference" / "components.md").read_text("utf-8") == write_page()


@pytest.mark.parametrize("name", CATALOGUE)
def test_every_variable_of_a_component_has_a_row_with_its_unit(name: str) -> None:
    readme = (ROOT / "fmus" / name / "README.md").read_text("utf-8")
    assert f"(../../docs/reference/components.md#{name})" in readme
    component = CATALOGUE[name]()
    rows = {line.split("`")[1]: line for line in write_page([name]).splitlines() if line.startswith("| `")}
    for layout in (component.parameters, component.state, component.inputs, component.outputs):
        for field in layout.fields:
            if not field.quantity.internal:
                key = next(row for row in rows if row.split("[")[0] == field.name.split("[")[0])
                unit = rows[key].split(" | ")[1].strip()
                assert unit == ("" if field.quantity.unit == "1" else field.quantity.unit)


def test_an_unknown_component_is_named_with_the_one_that_was_meant() -> None:
    with pytest.raises(MistakeError, match=r"camshft.*camshaft"):
        write_page(["camshft"])
