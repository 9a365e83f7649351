"""A sweep over speed: a study of steady cycles, its tables and figures."""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from importlib import metadata
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray
from rich.table import Column, Table

from models.core.roles import Contact
from models.monolithic.cycle import STEADY

from ...analyses import Parameter
from ...assessment.friction.remarks import remark_friction
from ...assessment.friction.shares import add_losses
from ...assessment.lost_contact import find_lost
from ...assessment.trains import list_parts
from ...errors import MistakeError, Option
from ...plots.speeds import draw_campbell, draw_map, draw_summary, list_oscillations
from ...plots.style import save_figure
from ...reporter import Reporter, tell_interruption
from ...scenario import build_scenario
from ...scenario.checks import check_units
from ...scenario.display import format_number, show_attributes
from ...scenario.files import to_full_toml
from ...scenario.system import build_system
from ...scenario.units import is_bare
from ...scenario.values import WARNING
from ...store.output_folder import CYCLES, REPORT, STORE, SUMMARY, SWEPT
from ..files import Plan, plan_axis
from ..run import Where, run
from ..store import DONE
from .remarks import describe_lift_loss, list_doubts
from .separation import (
    Separation,
    check_film,
    choose_film,
    find_second,
    find_separation,
    list_speeds,
    name_lost,
)
from .subject import SPEED, SpeedSubject, count_turns, cycle_path, find_flywheel

FOLDER = "cycles"  # with a file for each cycle
# Natural oscillations that are printed, from the slowest; contacts have more, far above the cam's orders.
TOLD = 5
RPM = 30.0 / math.pi
# Letters of a line that has room for every table.
WIDE = 1000


@dataclass(frozen=True)
class Range:
    """Speeds of the flywheel (rad/s) at equal distances."""

    low: float
    high: float
    count: int


class Swept(NamedTuple):
    """The command's exit status, the cycles by speed, and the content of summary.json (empty: no cycle)."""

    status: int
    table: xarray.Dataset
    summary: Mapping[str, Any]


def sweep(
    tables: Mapping[str, Any],
    speeds: Range,
    out: Path,
    where: Where,
    reporter: Reporter,
    overwrite: bool = False,
    second_film: str | None = None,
    separation: bool = True,
) -> Swept:
    """Find the cycles of a scenario that are missing in the folder `out`, then if `separation` the speed of
    separation, with its film formula and with `second_film` (None: the usual one); draw all.

    MistakeError or ModelError before anything is written.
    """
    check_film(second_film)
    plan, subject = make_plan(tables, speeds, out)
    with _kept_on_interrupt(out, reporter):
        status = run(plan, out / STORE, where, reporter, overwrite)
    table = add_losses(read_table(out), build_system(subject.scenario))
    if not table.sizes["speed"]:
        return Swept(status, table, {})
    report_cycles(reporter, table)
    with tell_interruption(lambda: f"the cycles are kept in {out}: the same command continues"):
        first = second = None
        if separation and (first := find_separation(subject, table, reporter)):
            reporter.line(first.text)
            second = compare_films(subject, table, first, second_film, reporter)
        return Swept(status, table, _conclude(subject, table, out, reporter, first, second))


def _conclude(
    subject: SpeedSubject,
    table: xarray.Dataset,
    out: Path,
    reporter: Reporter,
    first: Separation | None,
    second: Mapping[str, Any] | None,
) -> dict[str, Any]:
    """Say what is to be noticed, write, and draw; the content of summary.json."""
    known, system = subject.list_warnings({}), build_system(subject.scenario)
    doubts = list_doubts(subject, system, table)
    friction = list(remark_friction(system, table.data_vars))
    found = [*([second["text"]] if second else []), *doubts, *describe_lift_loss(table), *friction]
    for text in found:
        reporter.line(text)
    toml = to_full_toml(subject.scenario)
    summary = {
        "scenario": subject.scenario.name,
        "separation": first and first._asdict(),
        "second_separation": second,
        "notices": [*known, *found],
        "friction": friction,
        "doubts": [*(text for text in known if text.startswith(WARNING)), *doubts],
        "version": metadata.version("tribocosim"),
        "scenario_toml": toml,
    }
    (out / SWEPT).write_text(toml, "utf-8")
    (out / SUMMARY).write_text(json.dumps(summary, indent=1) + "\n", "utf-8")
    files = publish(subject, table, out, first and first.speed, reporter)
    if (out / CYCLES) in files:
        from ...report import write_report  # reads what is above

        files.append(write_report(out, out / REPORT))
    files.append(out / SWEPT)
    reporter.line(f"results in {out}: {', '.join(path.relative_to(out).as_posix() for path in files)}")
    return summary


@contextmanager
def _kept_on_interrupt(out: Path, reporter: Reporter) -> Iterator[None]:
    """Print the cycles that were found where the block is interrupted."""
    try:
        yield
    except KeyboardInterrupt:
        if (out / STORE).exists() and (table := read_table(out)).sizes["speed"]:
            report_cycles(reporter, table)
        raise


def compare_films(
    subject: SpeedSubject,
    table: xarray.Dataset,
    first: Separation,
    second_film: str | None,
    reporter: Reporter,
) -> dict[str, Any] | None:
    """The separation with a second film formula, and its name; None where the contacts have no other, or
    where the first was lost at all speeds or not found."""
    film = choose_film(subject, second_film)
    speeds = table["speed"].values
    if film is None or (first.speed is None and find_lost(table).any()):
        return None
    return {"film_model": film, **find_second(subject, speeds, first, film, reporter)._asdict()}


def read_table(out: Path) -> xarray.Dataset:
    """The cycles that were found, by speed."""
    with xarray.open_zarr(out / STORE) as stored:
        table = stored.load()
    return table.isel(speed=np.flatnonzero(table["status"].values == DONE))


def parse_range(low: str, high: str, count: int) -> Range:
    """Speeds given as texts; MistakeError where they are none, doubtful or in the wrong order."""
    ends = [parse_speed(name, value) for name, value in (("from", low), ("to", high))]
    if not ends[0] < ends[1]:
        raise MistakeError((Option("from", low), ": must be less than ", Option("to", high)))
    return Range(ends[0], ends[1], count)


def parse_speed(option: str, text: str) -> float:
    """A speed (rad/s) that an option states with its unit; MistakeError where it is none."""
    return parse_stated(option, text, SPEED, ("rpm", "rad/s"))


def parse_stated(option: str, text: str, kind: Parameter, units: Sequence[str]) -> float:
    """What an option states with its unit, in the unit of its kind; MistakeError where it is none.

    `units` are examples.
    """
    if is_bare(str(text)):
        examples = ", or ".join(f"{text} {unit}" for unit in units)
        raise MistakeError((Option(option, text), f": write the unit, e.g. {examples}"))
    try:
        return float(kind.check_value("", text))
    except MistakeError as error:
        raise MistakeError((Option(option), error)) from None


def make_plan(tables: Mapping[str, Any], speeds: Range, out: Path) -> tuple[Plan, SpeedSubject]:
    """The study of a scenario's cycles; MistakeError or ModelError for a fault of the scenario."""
    scenario = build_scenario(tables)
    check_units(scenario)
    subject = SpeedSubject(tables, find_flywheel(scenario), str((out / FOLDER).absolute()))
    name, ends = scenario.name, (speeds.low, speeds.high)
    return plan_axis(name, f"{name} over speed", subject, "speed", ends, speeds.count), subject


def report_cycles(reporter: Reporter, table: xarray.Dataset) -> None:
    """A line for each speed."""
    columns, places = select_columns(table), dict[str, list[float]]()
    parts = dict.fromkeys(name.rpartition(".")[0] for _, name, _ in columns)
    title, room = f"Steady cycles: columns are of {', '.join(parts)}", len(columns)
    console, shown = reporter.console, _tabulate(table, columns, title)
    free = console.options.update_width(WIDE)  # a table measures itself no wider than its console
    while room and console.measure(shown, options=free).minimum > console.width:
        room -= 1
        shown = _tabulate(table, columns[:room], title)
    console.print(shown)
    if left := ", ".join(head for head, _, _ in columns[room:]):
        reporter.line(f"the terminal is too narrow for {left}: see speeds.csv")
    for i, speed in enumerate(table["speed"].values):
        if place := name_lost(table.isel(speed=i)):
            places.setdefault(place, []).append(speed)
    for place, speeds in places.items():
        found = list_speeds(np.array(speeds), table["speed"].values)
        reporter.line(f"contact is lost{place} at {found}")


def _tabulate(table: xarray.Dataset, columns: Sequence[tuple[str, str, float]], title: str) -> Table:
    heads, lost = (head for head, _, _ in columns), find_lost(table)
    marked = Column("cycle", no_wrap=True)
    shown = Table("r/min", *heads, marked, title=title, title_justify="left", padding=0)
    for i, speed in enumerate(table["speed"].values):
        cells = (format_number(scale * float(table[name][i])) for _, name, scale in columns)
        marks = {"contact lost": lost[i], "not steady": table["change"][i] > STEADY}
        found = ", ".join(text for text, holds in marks.items() if holds) or "steady"
        marked.min_width = max(marked.min_width or 0, len(found))  # its words are in one line
        shown.add_row(f"{speed * RPM:.0f}", *cells, found)
    return shown


def select_columns(table: xarray.Dataset) -> list[tuple[str, str, float]]:
    """Head, result and factor of what a line shows: of the first part that has it, contacts before others."""
    wanted = {
        "least load": "least_load", "at": "least_load_angle", "largest load": "largest_load", "lost": "lost",
        "largest pressure": "peak_pressure", "least film": "least_film", "spring margin": "spring_margin",
        "seating": "seating_velocity", "lands at lift": "landing_lift", "largest torque": "largest_torque",
    }  # fmt: skip
    found = []
    for words, figure in wanted.items():
        names = [str(n) for n in table.data_vars if str(n).endswith(f".{figure}")]
        name = min(names, key=lambda n: f"{n.split('.')[0]}.lost" not in table, default=None)
        if name is not None and np.any(np.isfinite(table[name].values)):
            shown = show_attributes(table[name].attrs)
            found.append((f"{words} {shown.text}".strip(), name, shown.factor))
    return found


def publish(
    subject: SpeedSubject, table: xarray.Dataset, out: Path, separation: float | None, reporter: Reporter
) -> list[Path]:
    """Figures with the speed of separation (r/min), and all cycles over angle and speed in one file, with the
    natural frequencies, which are told."""
    design = subject.scenario.name
    system = subject.system_at(float(table["speed"][0]))
    files = [save_figure(lambda: draw_summary({design: table}, {design: separation}), out / "speeds.png")]
    cycles = [
        (float(speed), path)
        for speed in table["speed"].values
        if (path := cycle_path(Path(str(subject.folder)), float(speed))).exists()
    ]
    if len(cycles) < 2:
        return files
    joined = join_cycles(cycles).assign_attrs(cam_ratio=1.0 / count_turns(system))
    joined.to_netcdf(out / CYCLES, engine="h5netcdf")
    files.append(out / CYCLES)
    if modes := list_oscillations(joined):
        reporter.line(
            f"natural frequencies at the largest lift, {float(joined['speed'][0]) * RPM:.0f} r/min: "
            + "; ".join(
                f"{hz:.4g} Hz (damping ratio {ratio:.2g}, {state})" for hz, ratio, state in modes[:TOLD]
            )
        )
    lost = find_lost(table.sel(speed=joined["speed"].values))
    for load_name in [f"{name}.load" for name in list_parts(system, Contact)[:2]]:
        stem = load_name.replace(".", "-")
        files.append(save_figure(partial(draw_map, joined, load_name, lost), out / f"{stem}-map.png"))
        files.append(save_figure(partial(draw_campbell, joined, load_name), out / f"{stem}-campbell.png"))
    return files


def join_cycles(cycles: list[tuple[float, Path]]) -> xarray.Dataset:
    """All cycles over (speed, share of the period): the cam angle is a variable, as a shaft may twist.

    The natural oscillations are those of the lowest speed.
    """
    parts = []
    for speed, path in cycles:
        with xarray.open_dataset(path, engine="h5netcdf") as data:
            part = data.load()
        share = np.linspace(0.0, 1.0, part.sizes["time"])
        part = part.reset_coords("cam_angle").assign_coords(time=share).rename(time="share")
        parts.append(part.expand_dims(speed=[speed]))
    joined = xarray.concat(parts, "speed", join="exact", combine_attrs="override")
    for name, values in joined.data_vars.items():
        values.attrs.update(parts[0][name].attrs)
    joined["speed"].attrs["units"] = "rad/s"
    return joined
