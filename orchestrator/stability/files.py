"""A survey in files: stability.nc with everything, stability.csv with a row a method, stability.png."""

from __future__ import annotations

from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..masters import name_of
from ..scenario.files import to_full_toml
from .findings import Survey, Surveyed
from .report import sentences

if TYPE_CHECKING:
    import xarray

NAME = "stability"


def dataset(found: Survey) -> xarray.Dataset:
    """Methods with their limits; samples of the spectral radius; estimates of the error."""
    import xarray

    methods = found.methods
    columns: dict[str, tuple[str, str, Callable[[Surveyed], Any]]] = {
        "master": ("", "co-simulation master", lambda m: name_of(m.master)),
        "extrapolation": ("", "input signals", lambda m: m.master.extrapolation),
        "order": ("", "order of the participants", lambda m: " ".join(m.order)),
        "largest_stable_step": ("s", "up to which all is stable; inf: all looked at", lambda m: m.limit),
        "hardest_time": ("s", "instant of the point with that limit", lambda m: m.hardest),
        "runs_away": ("", "exchanged value that grows beyond", lambda m: str(m.culprit or "")),
        "contracting_step": ("s", "up to which plain iteration contracts", lambda m: m.contracting),
        "accurate_step": ("s", "up to which errors are within tolerance, as estimated", lambda m: m.within),
        "advised_step": ("s", "step with distance from both; 0: none", lambda m: m.recommended),
        "participant_steps_per_second": ("1/s", "effort at the advised step", lambda m: m.cost),
        "advised": ("1", "the method advised", lambda m: int(m is found.best)),
        "of_scenario": ("1", "the scenario's method", lambda m: int(m is found.own)),
    }
    samples = [(i, at.step, at.radius, at.contraction) for i, m in enumerate(methods) for at in m.seen]
    number, step, radius, contraction = map(np.array, zip(*samples, strict=True))
    variables = list(found.scenario.tolerance)
    estimates = [
        (i, at, [e[v] for v in variables]) for i, m in enumerate(methods) for at, e in m.errors.items()
    ]
    data: dict[str, Any] = {
        name: ("method", [value(m) for m in methods], _about(unit, text))
        for name, (unit, text, value) in columns.items()
    }
    data |= {
        "sample_method": ("sample", number, _about("1", "number of the method")),
        "sample_step": ("sample", step, _about("s", "macro step")),
        "spectral_radius": (
            "sample", radius, _about("1", "of the step over the system's own growth; NaN: no convergence")
        ),
        "contraction": ("sample", contraction, _about("1", "of a plain iteration, NaN for explicit masters")),
        "estimate_method": ("estimate", [e[0] for e in estimates], _about("1", "number of the method")),
        "estimate_step": ("estimate", [e[1] for e in estimates], _about("s", "macro step")),
        "estimated_error": (
            ("estimate", "variable"),
            np.array([e[2] for e in estimates]).reshape(len(estimates), len(variables)),
            _about("1", "relative RMS error"),
        ),
        "tolerance": ("variable", list(found.scenario.tolerance.values()), _about("1", "allowed error")),
        "point_time": ("point", [p.time for p in found.points], _about("s", "instants of linearisation")),
    }  # fmt: skip
    versions = ", ".join(f"{name} {metadata.version(name)}" for name in ("tribocosim", "numpy", "scipy"))
    return xarray.Dataset(
        data,
        coords={"method": [m.name for m in methods], "variable": variables},
        attrs={
            "title": f"{found.scenario.name}: stability of its coupling, from a linearisation",
            "comment": " ".join(sentences(found)),
            "scenario": to_full_toml(found.scenario),
            "macro_step": found.scenario.macro_step,
            "versions": versions,
            "Conventions": "CF-1.10",
        },
    )


def _about(unit: str, text: str) -> dict[str, str]:
    return {"units": unit, "long_name": text} if unit else {"long_name": text}


def write(found: Survey, folder: Path) -> list[Path]:
    """The three files; `folder` exists."""
    from ..plots.stability import figure
    from ..plots.style import saved

    table = dataset(found)
    files = [folder / f"{NAME}.{ending}" for ending in ("nc", "csv", "png")]
    table.to_netcdf(files[0], engine="h5netcdf")
    rows = table[[name for name, variable in table.data_vars.items() if variable.dims == ("method",)]]
    frame = rows.to_dataframe()
    units = {name: table[name].attrs.get("units", "") for name in frame.columns}
    frame.columns = [f"{name} [{units[name]}]" if units[name] else name for name in frame.columns]
    frame.to_csv(files[1])
    saved(lambda: figure(found), files[2])
    return files
