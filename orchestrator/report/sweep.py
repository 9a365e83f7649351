"""What the page of a sweep over speed needs: all its cycles, their numbers, the mechanism."""

import json
import math
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray

from ..assessment.lost_contact import bound_speeds, find_lost, list_shares
from ..assessment.trains import find_lost_rows
from ..errors import Option
from ..scenario import Scenario, ScenarioError, build_scenario
from ..scenario.system import build_system
from ..store.output_folder import CYCLES, STORE, SUMMARY, SWEPT, check_swept
from .content import assemble, choose, describe, list_marks, read_film
from .mechanism import list_sketches
from .packing import list_spans, pack
from .repetition import repeat

ANGLE = "cam_angle"
RPM = 30.0 / math.pi
# Maps and curves at first, by the endings of variables and numbers.
MAPS = (".load", ".film_thickness")
CURVES = (".least_load", ".least_film", ".seating_velocity", ".spring_margin")
PANELS = (".load", ".film_thickness", ".valve_lift")


def collect_sweep(folder: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """What the page says of the sweep in `folder`, and its content.

    MistakeError if there are not two cycles, so that nothing spans angle and speed.
    """
    check_swept(folder)
    summary = json.loads((folder / SUMMARY).read_text("utf-8"))
    with xarray.open_dataset(folder / CYCLES, engine="h5netcdf") as stored:
        cycles = stored.load()
    with xarray.open_zarr(folder / STORE) as stored:
        numbers = stored.load().sel(speed=cycles["speed"].values)
    toml = str(summary.get("scenario_toml", ""))
    told = _tell(summary, toml, numbers, folder)
    return told, _collect(
        cycles, numbers, _read_scenario(toml), (summary.get("separation") or {}).get("speed")
    )


def _read_scenario(toml: str) -> Scenario | None:
    """The scenario that was swept; None where what it names is gone."""
    try:
        return build_scenario(tomllib.loads(toml))
    except (ScenarioError, OSError, ValueError):
        return None


def _judge(
    separation: Mapping[str, Any] | None, doubts: Sequence[str], numbers: xarray.Dataset
) -> dict[str, str]:
    """The verdict and its colour: amber where something is doubted."""
    if separation is None and list_shares(numbers):
        lost = bool(find_lost(numbers).any())
        return {"verdict": "the speed of separation was not looked for", "kind": "bad" if lost else ""}
    text = separation["text"] if separation else "no contact can be lost"
    if separation and not text.startswith("contact is kept"):
        return {"verdict": text, "kind": "bad"}
    return {"verdict": "; ".join([text, *doubts[:1]]), "kind": "unsteady" if doubts else "good"}


def _tell(summary: Mapping[str, Any], toml: str, numbers: xarray.Dataset, folder: Path) -> dict[str, Any]:
    speeds = numbers["speed"].values
    name = str(summary["scenario"])
    ends = [
        Option(end, f"{speed * RPM:.6g} rpm")
        for end, speed in zip(("from", "to"), speeds[[0, -1]], strict=True)
    ]
    return {
        "name": name,
        "title": f"{name} over speed",
        **_judge(summary.get("separation"), summary.get("doubts", []), numbers),
        "notices": summary.get("notices", []),
        "version": summary.get("version", ""),
        "command": repeat("speeds", folder / SWEPT, folder, *ends, Option("count", speeds.size)),
        "toml": toml,
    }


def _collect(
    cycles: xarray.Dataset, numbers: xarray.Dataset, scenario: Scenario | None, separation: float | None
) -> dict[str, Any]:  # fmt: skip
    """`separation` in r/min."""
    speeds = cycles["speed"].values
    finite = [str(n) for n, v in numbers.data_vars.items() if v.dtype.kind == "f" and np.isfinite(v).any()]
    turned = cycles[ANGLE].values
    # Every cycle begins within the first turn.
    turned = turned - 2.0 * math.pi * np.floor(turned[:, :1] / (2.0 * math.pi) + 1e-9)
    names = [str(name) for name in cycles.data_vars if name != ANGLE]
    filmed = (
        cycles[name].copy(data=read_film(name, names, lambda one: cycles[one].values)) for name in names
    )
    variables = [_pack(name, values) for name, values in zip(names, filmed, strict=True)]
    variables.insert(0, _pack(ANGLE, cycles[ANGLE].copy(data=turned)))
    sketches = list_sketches(scenario, names) if scenario else []
    system = build_system(scenario) if scenario else None
    every = [{name: cycles[name].values[k] for name in names} for k in range(speeds.size)]

    def list_lost(part: str) -> list[list[list[int]]]:
        return [list_spans(find_lost_rows(system, part, one.__getitem__)) for one in every]

    bases = [{"rows": cycles.sizes["share"], "stretch": 1, "end": 1.0}]
    panels, marks = choose(names, PANELS) or names[:1], list_marks(names, list_lost)
    return assemble(bases, variables, sketches, panels, ANGLE, marks) | {
        "sweep": {
            "angle": ANGLE,
            "speeds": speeds.tolist(),
            "lost": find_lost(numbers).tolist(),
            "edges": bound_speeds(RPM * speeds, separation).tolist(),
            "periods": (2.0 * math.pi / cycles.attrs["cam_ratio"] / speeds).tolist(),
            "maps": choose(names, MAPS) or names[:1],
            "curves": choose(finite, CURVES),
            "numbers": [_list_number(name, numbers[name]) for name in finite],
        },
    }


def _pack(name: str, values: xarray.DataArray) -> dict[str, Any]:
    """All values of a variable, speed by speed."""
    return {**_describe(name, values), "data": {"values": pack(values.values.ravel())}, "base": 0}


def _list_number(name: str, values: xarray.DataArray) -> dict[str, Any]:
    """A number of every cycle; None where it has none."""
    found = [float(value) if math.isfinite(value) else None for value in values.values]
    return {**_describe(name, values), "values": found}


def _describe(name: str, values: xarray.DataArray) -> dict[str, Any]:
    """As of a run."""
    attributes = {"units": "1", **{str(key): str(value) for key, value in values.attrs.items()}}
    return {**describe(name, attributes), "group": "coupled"}
