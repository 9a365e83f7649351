"""What a design leaves in its folder: a scenario with its lift table, and the progress."""

import hashlib
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from models.core.quantities import Vector

from ...scenario.files import split_path
from ...scenario.lift_table import format_lifts
from ...store import atomic_write
from ...texts import parse_value
from .brief import Asked
from .train import DesignedTrain
from .wanted import Found

DESIGN, SCENARIO, LIFTS, TABLE, FIGURE, PAGE, PROGRESS, CAM = (
    "design", "designed.toml", "designed.csv", "design.nc", "design.png", "design.html", "progress.json",
    "cam",
)  # fmt: skip
FILES = (SCENARIO, LIFTS, FIGURE, PAGE)


def _digest(asked: Asked) -> str:
    content = json.dumps([asked.brief.model_dump(), asked.tables], sort_keys=True, default=str)
    return hashlib.sha256(content.encode()).hexdigest()


def keep(out: Path, asked: Asked, train: DesignedTrain, found: Found) -> None:
    """Write the best cam so far, as a scenario, and from where the search goes on."""
    write_scenario(out, asked, train, found.unknowns)
    content = {"brief": _digest(asked), "unknowns": found.unknowns.tolist(), "objective": found.objective}
    atomic_write.write_whole(out / PROGRESS, json.dumps(content, indent=1).encode())


def read_kept(out: Path, asked: Asked) -> Vector | None:
    """The best unknowns that a search of this brief has left, if it was not finished."""
    try:
        content = json.loads((out / PROGRESS).read_text("utf-8"))
        if content["brief"] == _digest(asked):
            return np.array(content["unknowns"], dtype=np.float64)
    except (OSError, ValueError, KeyError):
        pass
    return None


def describe_kept(out: Path, drawn: bool = False) -> str:
    """What an interrupted search has left in the folder, and how it goes on."""
    if (out / PROGRESS).exists():
        figure = f", drawn in {out / FIGURE}" * drawn
        return f"the best cam so far is {out / SCENARIO}{figure}: the same command goes on from it"
    return "no better cam was found yet, only compiled code is kept: the same command begins anew"


def write_scenario(out: Path, asked: Asked, train: DesignedTrain, unknowns: Vector) -> None:
    """The scenario of the designed cam, which extends the brief's, and the cam's lift table."""
    import tomli_w

    points = train.lobe.points(unknowns[: train.lobe.count])
    atomic_write.write_whole(out / LIFTS, format_lifts(points).encode())
    base = asked.base if isinstance(asked.base, str) else os.path.relpath(asked.base, out.resolve())
    content: dict[str, Any] = {"components": {}}
    for text in asked.settings:
        path, _, value = text.partition("=")
        *tables, key = split_path(path.strip())
        _nest(content, tables)[key] = parse_value(value)
    values = {"base_radius": train.lobe.kind.geometry.base_radius, "ramp_height": 0.0}
    _nest(content, ["components", train.cam])["lift_table"] = LIFTS
    _nest(content, ["components", train.cam, "parameters"]).update(values)
    for name, found in train.values(unknowns).items():
        if one := train.wires.get(name):
            _nest(content, ["components", one.part, "wire"])[one.field] = f"{found!r} {one.unit}"
            continue
        part, _, parameter = name.partition(".")
        _nest(content, ["components", part, "parameters"])[parameter] = found
    title = f"{train.scenario.name} with a designed cam"
    written = {"extends": str(base), "description": title} | content
    atomic_write.write_whole(out / SCENARIO, tomli_w.dumps(written).encode())


def _nest(content: dict[str, Any], tables: Sequence[str]) -> dict[str, Any]:
    """The table at this place, made where it is missing."""
    for key in tables:
        content = content.setdefault(key, {})
    return content
