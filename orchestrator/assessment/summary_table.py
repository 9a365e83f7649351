"""The figures of merit of a run in one table, with the angle, time and speed where each stands."""

import csv
import io
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from models.core import roles
from models.core.quantities import Quantity, Vector
from models.core.system import System

from ..scenario.display import show
from ..store import atomic_write
from .contacts import ContactSummaries, ContactSummary
from .kinematics import find_landing
from .trains import Angle, find_angle, find_drive_angle, find_trains

Read = Callable[[Sequence[str]], Mapping[str, Vector]]
HEAD = ("part", "figure of merit", "value", "unit", "angle [deg]", "angle of", "time [ms]", "speed [r/min]")
# By role: the words, the output, and whether its largest or least value counts.
EXTREMES: Mapping[type[roles.Role], Sequence[tuple[str, str, Callable[[Vector], np.intp]]]] = {
    roles.Drive: (
        ("largest torque", "supplied_torque", np.argmax),
        ("least torque", "supplied_torque", np.argmin),
    ),
    roles.Valve: (("largest lift", "valve_lift", np.argmax), ("largest seat force", "seat_force", np.argmax)),
    roles.LoadedSpring: (
        ("largest spring force", "spring_force", np.argmax),
        ("least gap between coils", "least_gap", np.argmin),
    ),
    roles.CoilSpring: (
        ("least gap between coils", "least_gap", np.argmin),
        ("largest force between coils", "clash_force", np.argmax),
    ),
    roles.Adjuster: (("highest oil pressure", "pressure", np.argmax),),
    roles.Bearing: (
        ("largest load", "load", np.argmax),
        ("least film", "minimum_film_thickness", np.argmin),
    ),
}
LOAD, PRESSURE, VELOCITY = Quantity("N", "load"), Quantity("Pa", "pressure"), Quantity("m/s", "velocity")
FILM, SHARE = Quantity("m", "film", display_unit="um"), Quantity("1", "share")


@dataclass(frozen=True)
class Merit:
    """A number of a part, in SI units, and when it stands (s; None: of the whole run)."""

    part: str
    words: str
    value: float
    quantity: Quantity
    time: float | None = None


def list_merits(system: System, contacts: ContactSummaries, read: Read) -> list[Merit]:
    """Of contacts, then of valves, springs and the other parts that have extremes."""
    found = [merit for name, contact in contacts.items() for merit in _list_of_contact(name, contact)]
    for train in find_trains(system):
        valve = train.valve
        if system.instances[valve].component.has_role(roles.Valve):
            names = [f"{valve}.{name}" for name in ("seat_dip", "position", "velocity")]
            values = read(["time", *names])
            landing = find_landing(train, values)
            if landing is not None:
                velocity = -float(values[names[2]][landing])
                found.append(
                    Merit(valve, "seating velocity", velocity, VELOCITY, float(values["time"][landing]))
                )
    for name, instance in system.instances.items():
        for role, extremes in EXTREMES.items():
            if instance.component.has_role(role):
                for words, variable, choose in extremes:
                    values = read(["time", f"{name}.{variable}"])
                    column, quantity = (
                        values[f"{name}.{variable}"],
                        instance.component.outputs.field(variable),
                    )
                    at = int(choose(column))
                    time = float(values["time"][at])
                    found.append(Merit(name, words, float(column[at]), quantity.quantity, time))
    return found


def _list_of_contact(name: str, contact: ContactSummary) -> Iterator[Merit]:
    yield Merit(name, "largest load", contact.largest_load, LOAD, contact.largest_load_time)
    yield Merit(name, "highest pressure", contact.pressure, PRESSURE, contact.pressure_time)
    if contact.film > 0.0:
        yield Merit(name, "least film", contact.film, FILM, contact.film_time)
        yield Merit(name, "least film ratio", contact.film_ratio, SHARE)
    yield Merit(name, "share of the time without contact", contact.lost, SHARE)
    if contact.separation:
        yield Merit(name, "largest gap", contact.separation.gap, FILM, contact.separation.gap_time)
    if contact.impact:
        yield Merit(name, "speed of the hardest impact", contact.impact.speed, VELOCITY, contact.impact.time)


def write_merits(system: System, contacts: ContactSummaries, read: Read, path: Path) -> None:
    """The table as a CSV file that a spreadsheet opens as it is."""
    text = io.StringIO()
    table = csv.writer(text)
    table.writerow(HEAD)
    drive = find_drive_angle(system)
    for merit in list_merits(system, contacts, read):
        shown = show(merit.quantity)
        place: list[str] = ["", "", "", ""]
        if merit.time is not None:
            angle = find_angle(system, merit.part)
            place = [
                *_place(angle, merit.time, read),
                f"{1e3 * merit.time:.6g}",
                _speed(drive, merit.time, read),
            ]
        table.writerow((merit.part, merit.words, f"{shown.factor * merit.value:.6g}", shown.text, *place))
    # Spreadsheets take a file for UTF-8 by its first three bytes.
    atomic_write.replace(path, text.getvalue().encode("utf-8-sig"))


def _place(angle: Angle | None, time: float, read: Read) -> tuple[str, str]:
    if angle is None:
        return "", ""
    values = read(["time", angle.source])
    turned = np.degrees(angle.factor * np.interp(time, values["time"], values[angle.source]))
    return f"{turned % 360.0:.2f}", angle.name.removesuffix("_angle")


def _speed(drive: Angle | None, time: float, read: Read) -> str:
    """Of the drive, r/min."""
    if drive is None:
        return ""
    values = read(["time", drive.source])
    i = min(max(int(np.searchsorted(values["time"], time)), 1), len(values["time"]) - 1)
    times, angles = values["time"], values[drive.source]
    speed = (angles[i] - angles[i - 1]) / (times[i] - times[i - 1])
    return f"{30.0 / np.pi * speed:.5g}"
