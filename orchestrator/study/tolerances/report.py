"""What a tolerance study prints and writes."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import xarray
from rich.table import Column, Table

from models.core.words import tally

from ...plots.merits import Panel, draw_histograms, draw_indices
from ...plots.style import save_figure
from ...report.answer import Answer
from ...reporter import Reporter
from ...scenario.display import Shown, add_unit, format_number, show_attributes
from ...store.csv_file import write_rows
from ..speeds.compare import LEAST_IS_WORST
from ..speeds.sensitivities_report import select_figures
from .limits import Limit
from .run import ALL
from .statistics import PERCENTS

RESULTS, PERCENTILES, INDICES, YIELD = "tolerances.nc", "percentiles.csv", "indices.csv", "yield.csv"
PAGE, HISTOGRAMS, BARS = "tolerances.html", "tolerances.png", "indices.png"
# Percentiles of the printed table.
SHOWN = (1.0, 50.0, 99.0)
# Figures whose largest indices are told, if no limit names any, and indices of each.
RANKED = 3
# Its last columns are of the side that may harm: of so much of the trains at most.
RARE = 0.1


def publish(
    dataset: xarray.Dataset, limits: Sequence[Limit], title: str, out: Path, reporter: Reporter
) -> None:
    """Print percentiles, yields and what costs them; write all to a page, tables, figures and netCDF."""
    limited = dict.fromkeys(limit.figure for limit in limits if limit.figure in dataset["figure"])
    gaps = [name for name in map(str, dataset["figure"].values) if name.endswith(".least_gap")]
    main = dataset.sel(figure=list(dict.fromkeys([*limited, *select_figures(dataset), *gaps])))
    answer = Answer(f"{title}: tolerances", reporter)
    answer.table(_tabulate(main, limits, title))
    for line in (*describe(main, limits), *rank(main, limits)):
        answer.line(line)
    for text in (dataset.attrs["cycles"], dataset.attrs["friction"]):
        for line in text.splitlines():
            answer.line(line)
    dataset.to_netcdf(out / RESULTS, engine="h5netcdf")
    write_rows(out / PERCENTILES, _list_percentiles(dataset))
    write_rows(out / INDICES, _list_indices(dataset))
    write_rows(out / YIELD, _list_yields(dataset))
    panels = [_panel(main, str(name), limits) for name in main["figure"].values]
    trains = f"{tally(dataset.attrs['steady'], 'train')}{_of_steady(dataset)}"
    save_figure(lambda: draw_histograms(panels, f"{title}: {trains}"), out / HISTOGRAMS)
    written = [RESULTS, PERCENTILES, INDICES, YIELD, HISTOGRAMS]
    if np.isfinite(main["total"].values).any():
        save_figure(lambda: draw_indices(main, f"{title}: Sobol' indices"), out / BARS)
        written.append(BARS)
    answer.write(out, PAGE, written)


def _shown(dataset: xarray.Dataset, figure: str) -> Shown:
    own = dataset.sel(figure=figure)
    return show_attributes(
        {"units": str(own["unit"].values), "display_units": str(own["display_unit"].values)}
    )


def _tabulate(main: xarray.Dataset, limits: Sequence[Limit], title: str) -> Table:
    heads = [f"{percent:g} %" for percent in SHOWN]
    shown = Table(
        Column("figure", no_wrap=True), *heads, f"worst {RARE:g} %", "95 % interval", "first order",
        title=f"{title}: percentiles; the worst are beyond that of {100.0 - RARE:g} %, or below that of "
        f"{RARE:g} % where less is worse; ~ where the first order lies outside the interval",
        title_justify="left", padding=0,
    )  # fmt: skip
    for name in map(str, main["figure"].values):
        own, unit = main.sel(figure=name), _shown(main, name)
        worst = find_worst(name, limits)
        values = [unit.factor * float(own["percentile"].sel(percent=p, end="value")) for p in (*SHOWN, worst)]
        low, high = (
            unit.factor * float(own["percentile"].sel(percent=worst, end=e)) for e in ("low", "high")
        )
        linear = unit.factor * float(own["linear"].sel(percent=worst))
        mark = "~" if linear < low or linear > high else ""
        interval = f"{format_number(low)} to {format_number(high)}" if np.isfinite([low, high]).any() else "–"
        cells = [*map(format_number, values), interval, f"{mark}{format_number(linear)}"]
        shown.add_row(add_unit(name, unit), *cells)
    return shown


def find_worst(figure: str, limits: Sequence[Limit]) -> float:
    """The percentile of the side that may harm: that of the figure's limit, else that which is usual."""
    sides = {limit.upper for limit in limits if limit.figure == figure}
    upper = True in sides if sides else figure.rpartition(".")[2] not in LEAST_IS_WORST
    return 100.0 - RARE if upper else RARE


def describe(dataset: xarray.Dataset, limits: Sequence[Limit]) -> Iterator[str]:
    """A sentence on each limit: its yield, and the tolerance that costs most of it."""
    worst = ((name, find_worst(name, limits)) for name in map(str, dataset["figure"].values))
    found = dataset["percentile"]
    ends = [found.sel(figure=name, percent=p, end="high" if p > RARE else "low") for name, p in worst]
    if not np.isfinite(ends).all():
        yield f"{tally(dataset.attrs['steady'], 'train')} are too few to bound the worst {RARE:g} %"
    of = f"of the trains{_of_steady(dataset)}"
    for limit in map(str, dataset["limit"].values):
        own = dataset.sel(limit=limit)
        value, low, high = 100.0 * own["yield"].values
        them = "them" if limit == ALL else "it"
        sentence = f"{limit}: {value:.4g} % {of} keep {them} ({low:.4g} to {high:.4g} %)"
        without = own["yield_without"].sel(end="value").values
        if value < 100.0 and np.isfinite(without).any():
            k = int(np.nanargmax(without))
            name, (best, least, most) = str(own["factor"].values[k]), 100.0 * own["yield_without"].values[k]
            if least > value:
                sentence += (
                    f"; {name} costs most: of the trains amid its tolerance {best:.4g} % do "
                    f"({least:.4g} to {most:.4g} %)"
                )
            else:
                sentence += "; no single parameter's tolerance costs more than chance may"
            if hidden := [str(name) for name in own["factor"].values[~np.isfinite(without)]]:
                sentence += f" (not judged: {', '.join(hidden)}; see {YIELD})"
        yield sentence


def rank(dataset: xarray.Dataset, limits: Sequence[Limit]) -> Iterator[str]:
    """The factors of the largest total indices, of the limits' figures, else of the first; nothing without
    indices. A further factor is named where its interval lies above 0."""
    names = [str(name) for name in dataset["figure"].values]
    limited = [name for name in names if name in {limit.figure for limit in limits}]
    for name in limited or names[:RANKED]:
        found = dataset["total"].sel(figure=name)
        known = found.isel(factor=np.flatnonzero(np.isfinite(found.sel(end="value"))))
        said = [
            f"{known['factor'].values[k]} {value:.2g} ({low:.2g} to {high:.2g})"
            for place, k in enumerate(np.argsort(-known.sel(end="value").values, kind="stable")[:RANKED])
            for value, low, high in [known.values[k]]
            if not place or low > 0.0
        ]
        if said:
            yield f"{name} varies most with {', '.join(said)}: total Sobol' indices"


def _of_steady(dataset: xarray.Dataset) -> str:
    """Which of the sampled trains are judged, if not all."""
    return " with a steady cycle" if dataset.attrs["steady"] < dataset.attrs["sampled"] else ""


def _panel(dataset: xarray.Dataset, name: str, limits: Sequence[Limit]) -> Panel:
    unit, own = _shown(dataset, name), dataset.sel(figure=name)
    low, high = (unit.factor * float(own["linear"].sel(percent=percent)) for percent in (50.0, 99.0))
    part, _, number = name.rpartition(".")
    return Panel(
        add_unit(f"{part}: {number.replace('_', ' ')}", unit),
        unit.factor * own["sample"].values,
        [(unit.factor * limit.value, limit.upper) for limit in limits if limit.figure == name],
        (low, (high - low) / NORMAL_99),
    )


# Deviations above the mean below which 99 % of a normal distribution lie.
NORMAL_99 = 2.3263478740408408


def _list_percentiles(dataset: xarray.Dataset) -> Iterator[list[object]]:
    ends = [f"{p:g} %{end}" for p in PERCENTS for end in ("", " low", " high", " first order")]
    yield ["figure", "unit", "mean", "deviation", *ends]
    for name in map(str, dataset["figure"].values):
        own = dataset.sel(figure=name)
        cells = [
            float(x)
            for p in PERCENTS
            for x in (*own["percentile"].sel(percent=p).values, own["linear"].sel(percent=p).values)
        ]
        yield [name, str(own["unit"].values), float(own["mean"]), float(own["deviation"]), *cells]


def _list_indices(dataset: xarray.Dataset) -> Iterator[list[object]]:
    kinds = ("first", "total")
    yield ["figure", "factor", *[f"{k}{e}" for k in kinds for e in ("", " low", " high")], "first order"]
    for name in map(str, dataset["figure"].values):
        own = dataset.sel(figure=name)
        for k, factor in enumerate(map(str, dataset["factor"].values)):
            cells = [float(x) for kind in kinds for x in own[kind].values[k]]
            yield [name, factor, *cells, float(own["linear_part"].values[k])]


def _list_yields(dataset: xarray.Dataset) -> Iterator[list[object]]:
    yield [
        "limit", "factor", "yield", "yield_low", "yield_high", "amid", "amid_low", "amid_high", "index",
        "index_low", "index_high", "sampled", "steady",
    ]  # fmt: skip
    counts = [dataset.attrs[name] for name in ("sampled", "steady")]
    for limit in map(str, dataset["limit"].values):
        own = dataset.sel(limit=limit)
        for k, factor in enumerate(map(str, dataset["factor"].values)):
            tables = (own["yield"].values, own["yield_without"].values[k], own["yield_index"].values[k])
            yield [limit, factor, *[float(x) for table in tables for x in table], *counts]
