"""The page on scenario files says what a scenario can say, and its examples are read."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from orchestrator.masters.acceleration import ACCELERATIONS
from orchestrator.scenario_files import load
from orchestrator.schema import schema
from orchestrator.stepping.estimators import ESTIMATORS

PAGE = (Path(__file__).parent.parent / "docs" / "scenarios.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```toml\n(.+?)```", PAGE, re.DOTALL)
CODE = re.findall(r"```\w*\n(.+?)```|`([^`\n]+)`", PAGE, re.DOTALL)


def test_every_key_of_the_schema_and_every_choice_is_on_the_page() -> None:
    content = schema()
    tables = [d["properties"] for name, d in content["$defs"].items() if name.endswith("Table")]
    assert len(tables) == 5
    keys = {key for table in [content["properties"], *tables] for key in table}
    masters = content["$defs"]["MasterTable"]["properties"]["name"]["enum"]
    words = set(re.findall(r"\w+", " ".join("".join(found) for found in CODE)))
    assert sorted({*keys, *masters, *ACCELERATIONS, *ESTIMATORS} - words) == []


@pytest.mark.parametrize("example", EXAMPLES)
def test_every_example_is_read(example: str, tmp_path: Path) -> None:
    file = tmp_path / "example.toml"
    file.write_text(
        example if "extends" in example else f'extends = "valve-train"\n{example}', encoding="utf-8"
    )
    load(file)
