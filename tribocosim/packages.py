"""Files and folders of the user that have the name of one of our packages."""

from __future__ import annotations

import importlib.util
from pathlib import Path

NAMES = ("models", "fmus", "orchestrator")


def find_shadowed() -> str:
    """The message about the first of our packages that another file or folder hides; "" if none."""
    home = Path(__file__).resolve().parents[1]
    for name in NAMES:
        spec = importlib.util.find_spec(name)
        if spec is None or spec.origin is None:
            continue
        place = Path(spec.origin).resolve()
        if place.name == "__init__.py":
            place = place.parent
        if place != home / name:
            return f"{place} hides tribocosim's package {name}: rename it, or start in another folder"
    return ""
