"""The rows as a printed table and as files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path

import numpy as np
import xarray
from rich import box
from rich.table import Table
from rich.text import Text

from .problem import CouplingProblem
from .row import Row

ERRORS = (1e-2, 1e-3, 1e-4, 1e-5)
UNITS = {
    "setting": ("s", "macro step; a run with step control: its tolerance"),
    "macro_steps": ("1", "macro steps that were accepted"),
    "rejected_steps": ("1", "macro steps that were taken back"),
    "iterations": ("1", "passes over all participants"),
    "calls": ("1", "doStep calls of all instances, also those taken back"),
    "wall_time_s": ("s", "wall time of the stepping alone"),
    "error": ("1", "largest relative RMS error of the outputs"),
    "max_error": ("1", "largest error of the outputs, relative to the output's RMS spread"),
}


def build_dataset(
    rows: Sequence[Row], outputs: Sequence[str], about: Mapping[str, str | float]
) -> xarray.Dataset:
    """All rows along the dimension `run`; the error of each output along `output`."""
    table = xarray.Dataset(attrs={**about, "Conventions": "CF-1.10"})
    for field in fields(Row):
        if field.name == "errors":
            continue
        unit, meaning = UNITS.get(field.name, ("", ""))
        values = [getattr(row, field.name) for row in rows]
        table[field.name] = ("run", np.array(values), {"units": unit, "long_name": meaning} if unit else {})
    errors = [[row.errors.get(name, np.nan) for name in outputs] for row in rows]
    table["errors"] = (("run", "output"), errors, {"units": "1", "long_name": "relative RMS error"})
    return table.assign_coords(output=list(outputs))


def write_files(
    table: xarray.Dataset,
    rows: Sequence[Row],
    problem: CouplingProblem,
    out: Path,
    name: str,
) -> list[Path]:
    """NAME.nc, NAME.csv, NAME.png."""
    from ...plots.style import save_figure
    from .figure import draw_figure

    files = [out / f"{name}.nc", out / f"{name}.csv"]
    table.to_netcdf(files[0], engine="h5netcdf")
    write_csv(table, files[1])
    return [*files, save_figure(lambda: draw_figure(problem, rows), out / f"{name}.png")]


def write_csv(table: xarray.Dataset, path: Path) -> None:
    """A row for each run."""
    frame = table.drop_dims("output").to_dataframe()
    for i, output in enumerate(table["output"].values):
        frame[f"error of {output}"] = table["errors"].values[:, i]
    frame.to_csv(path, index=False)


def format_progress(rows: Sequence[Row]) -> str:
    """A line about a measured method."""
    reached = [row.error for row in rows if row.error >= 0.0]
    if not reached:
        return f"{rows[0].method}: no result"
    return f"{rows[0].method}: {len(reached)} of {len(rows)} runs, least error {min(reached):.1e}"


def find_cheapest(rows: Sequence[Row], method: str, error: float) -> Row | None:
    """The method's run of fewest doStep calls with at most this error."""
    reached = [row for row in rows if row.method == method and row.error <= error]
    return min(reached, key=lambda row: row.calls, default=None)


def build_digest(rows: Sequence[Row]) -> Table:
    """doStep calls and wall time that each method needs for an error, by its cheapest run that reaches it."""
    table = Table(
        title="doStep calls (wall time) of the cheapest run with a relative RMS error of at most",
        title_justify="left",
        box=box.SIMPLE_HEAD,
        pad_edge=False,
    )
    table.add_column("method", no_wrap=True)
    for error in ERRORS:
        table.add_column(f"{error:.0e}", justify="right", no_wrap=True)
    table.add_column("least", justify="right", no_wrap=True)
    for method in dict.fromkeys(row.method for row in rows):
        cells = [_format_cost(find_cheapest(rows, method, error)) for error in ERRORS]
        least = min((row.error for row in rows if row.method == method and row.error >= 0.0), default=np.nan)
        table.add_row(Text(method), *cells, "" if np.isnan(least) else f"{least:.1e}")
    return table


def _format_cost(row: Row | None) -> str:
    if row is None:
        return ""
    seconds = row.wall_time_s
    return f"{row.calls} ({f'{seconds:.1f} s' if seconds >= 1.0 else f'{1e3 * seconds:.0f} ms'})"


def list_failures(rows: Sequence[Row]) -> list[str]:
    """A line for each method with runs that failed: its settings and the last one's reason."""
    lines = []
    for method in dict.fromkeys(row.method for row in rows if row.note):
        failed = [row for row in rows if row.method == method and row.note]
        if failed[-1].note.startswith("not installed"):
            lines.append(f"{method}: {failed[-1].note}")
        else:
            settings = ", ".join(f"{row.setting:.3g}" for row in failed)
            reason = failed[-1].note.split(";")[0]
            lines.append(f"{method}: no result at {settings}; the last: {reason}")
    return lines
