"""Names that the shell completes: from the files that carry them, so that the key answers at once."""

from pathlib import Path
from typing import Annotated

import typer

_ROOT = Path(__file__).parents[2]


def complete_scenario(incomplete: str) -> list[str]:
    """Shipped scenarios that begin so."""
    return _list_stems(_ROOT / "orchestrator" / "scenario" / "shipped", incomplete)


def complete_study(incomplete: str) -> list[str]:
    """Shipped studies that begin so."""
    return _list_stems(_ROOT / "orchestrator" / "study" / "shipped", incomplete)


def complete_component(incomplete: str) -> list[str]:
    """Components that begin so."""
    pages = (_ROOT / "fmus").glob("*/README.md")
    return sorted(page.parent.name for page in pages if page.parent.name.startswith(incomplete))


def _list_stems(folder: Path, incomplete: str) -> list[str]:
    return sorted(file.stem for file in folder.glob("*.toml") if file.stem.startswith(incomplete))


ScenarioName = Annotated[
    str,
    typer.Argument(help="A shipped scenario, or the path of a .toml file.", autocompletion=complete_scenario),
]
