"""Runs one analysis: prints its results and writes its table and figure."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich import box
from rich.table import Table
from rich.text import Text

from ..errors import REPLACE, MistakeError, Option, another
from ..reporter import Reporter
from ..scenario.display import format_with_error
from ..scenario.units import to_unit
from ..scenario.values import Value
from ..store.csv_file import write_sheet
from ..store.output_folder import OutputFolderError, make_folder, refuse_file, remove_empty
from ..texts import parse_value
from . import Analysis, Result, list_analyses, load

if TYPE_CHECKING:
    import xarray

ENDINGS = ("nc", "csv", "png", "html")


def analyse(
    name: str,
    settings: Sequence[str] = (),
    out: Path | None = None,
    overwrite: bool = False,
    reporter: Reporter | None = None,
) -> dict[str, float | str]:
    """Compute, print and write into `out` (default: results/NAME), which changes when all is computed."""
    analysis = load(name)
    given = dict(parse_setting(text) for text in settings)
    folder = out or Path("results") / analysis.name
    table = evaluate(analysis, given, folder, overwrite, reporter or Reporter())
    return {result: table[result].item() for result in analysis.results}


def evaluate(
    analysis: Analysis, given: Mapping[str, Any], folder: Path, overwrite: bool, reporter: Reporter
) -> xarray.Dataset:
    """Compute with the parameters `given`, print, and write into `folder`; the table."""
    values = analysis.complete(dict(given))
    if doubts := analysis.list_doubts(given):
        raise MistakeError("\n".join(doubts))
    texts = (f"{analysis.name}.{ending}" for ending in analysis.texts)
    held = find_results(folder, analysis.name, overwrite, *texts)
    with create_folder(folder):
        with reporter.stage(analysis.description):
            table = compute_table(analysis, values)
        results = {result: table[result].item() for result in analysis.results}
        if analysis.describe:
            reporter.line(analysis.describe(values))
        reporter.console.print(build_results_table(analysis, values, results))
        for warning in analysis.warn(results):
            reporter.line(f"warning: {warning}")
        for file in held:
            file.unlink()
        files = write_results(analysis, values, table, folder)
    reporter.line(f"results in {folder}: {', '.join(file.name for file in files)}")
    return table


def parse_setting(text: str) -> tuple[str, Any]:
    """Parameter and value of "parameter=value"."""
    name, equals, written = (part.strip() for part in text.partition("="))
    if not (name and equals and written):
        raise MistakeError((Option("set"), f" {text}: must be parameter=value, e.g. damping=0.05"))
    try:
        return name, parse_value(written)
    except ValueError as error:
        raise MistakeError((Option("set"), f" {name}: {error}")) from None


def compute_table(analysis: Analysis, values: Mapping[str, Value]) -> xarray.Dataset:
    """The table with results, parameters and versions; an analysis without a table has its results alone."""
    import xarray

    table = analysis.table(values) if analysis.table else xarray.Dataset(dict(analysis.evaluate(values)))
    for name, result in analysis.results.items():
        table[name].attrs.update(units=result.unit, long_name=result.description)
    versions = ", ".join(f"{name} {metadata.version(name)}" for name in ("tribocosim", "numpy", "numba"))
    settings = {name: int(value) if isinstance(value, bool) else value for name, value in values.items()}
    about = {"title": analysis.description, "analysis": analysis.name, "versions": versions}
    return table.assign_attrs({**settings, **about, "Conventions": "CF-1.10"})


def find_results(folder: Path, name: str, overwrite: bool, *others: str) -> list[Path]:
    """Files of this analysis in the folder, and `others`, each once.

    OutputFolderError if there are some, unless `overwrite`.
    """
    refuse_file(folder)
    names = dict.fromkeys((*(f"{name}.{ending}" for ending in ENDINGS), *others))
    held = [path for path in (folder / own for own in names) if path.exists()]
    if held and not overwrite:
        raise OutputFolderError(f"{folder}: already holds a result ({held[0].name})", another(), REPLACE)
    return held


@contextmanager
def create_folder(folder: Path) -> Iterator[None]:
    """Create the folder if it is missing; after an error, remove it if it is new and empty."""
    missing = make_folder(folder)
    try:
        yield
    except BaseException:
        remove_empty(missing)
        raise


def write_results(
    analysis: Analysis, values: Mapping[str, Value], table: xarray.Dataset, folder: Path
) -> list[Path]:
    """NAME.nc, NAME.csv where it is one table, NAME.png where there is something to draw, and the texts."""
    files = [folder / f"{analysis.name}.nc"]
    table.to_netcdf(files[0], engine="h5netcdf")
    columns = {name: variable for name, variable in table.data_vars.items() if variable.ndim}
    if len({variable.dims for variable in columns.values()}) == 1:
        files.append(folder / f"{analysis.name}.csv")
        frame = table[list(columns)].to_dataframe().reset_index()
        frame.columns = [f"{name} [{table[name].attrs.get('units', '1')}]" for name in frame.columns]
        write_sheet(files[-1], frame.to_csv(index=False))
    if analysis.draw:
        from ..plots.style import save_figure

        draw = analysis.draw
        files.append(save_figure(lambda: draw(table, values), folder / f"{analysis.name}.png"))
    for ending, write in analysis.texts.items():
        files.append(folder / f"{analysis.name}.{ending}")
        files[-1].write_text(write(table, values), "utf-8")
    return files


def build_results_table(
    analysis: Analysis, values: Mapping[str, Value], results: Mapping[str, float | str]
) -> Table:
    """The results with their units and errors, without those that say nothing here."""
    errors = analysis.list_errors(values, results)
    rows = (
        (name, *_format_result(results[name], result, errors.get(name, 0.0)), result.description)
        for name, result in analysis.results.items()
        if str(results[name]) not in ("", "nan")
    )
    return _build_table(("result", "value", "unit", "meaning"), rows)


def build_parameters_table(name: str) -> Table:
    """What can be set: defaults, units, ranges."""
    rows = (
        (
            key,
            _format_value(value.default),
            _format_unit(value.quantity.unit),
            value.allowed,
            value.quantity.description,
        )
        for key, value in load(name).parameters.items()
    )
    return _build_table(("parameter", "default", "unit", "allowed", "meaning"), rows)


def build_analyses_table() -> Table:
    """All analyses."""
    return _build_table(
        ("analysis", "what it says"), ((name, load(name).description) for name in list_analyses())
    )


# Columns of a table that are not broken.
WHOLE = ("analysis", "parameter", "result", "default", "unit")


def _build_table(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for name in columns:
        table.add_column(name, no_wrap=name in WHOLE, justify="left", overflow="fold")
    for row in rows:
        table.add_row(*map(Text, row))
    return table


def _format_result(value: float | str, result: Result, error: float) -> tuple[str, str]:
    """Value and unit, in the unit that the result is shown in."""
    if isinstance(value, str):
        return value, _format_unit(result.unit)
    unit = result.display_unit or result.unit
    size = to_unit(f"1 {unit}", result.unit) if result.display_unit else 1.0
    digits = f"{value / size:.{result.digits}g}"
    return format_with_error(value / size, error / size) if error else digits, _format_unit(unit)


def _format_value(value: Value) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _format_unit(unit: str) -> str:
    return "" if unit == "1" else unit
