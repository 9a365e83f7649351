"""The figures of merit of a run: all of them, and what an engineer asks first of each train in words."""

import csv
import io
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from models.contact.records import ATOM
from models.core import roles
from models.core.quantities import Quantity, Vector
from models.core.system import Port, System
from models.core.words import tally

from ..scenario.display import format_number, say, show
from ..scenario.values import WARNING
from ..store.csv_file import write_sheet
from .adjusters import UNHELD, describe_growth
from .contacts import ContactSummaries, ContactSummary, name_turn
from .figures_of_merit import SHARE, measure
from .friction.losses import list_losses, name_outside, note_friction
from .friction.remarks import remark_asperities
from .friction.shares import describe_torque, sum_losses
from .grooves import describe_groove
from .motion import RUN, Motion
from .springs import MORE_TRAVEL, binds_by_default, closes_at_once, list_springs
from .trains import (
    Angle,
    Train,
    find_angle,
    find_degrees,
    find_drive_angle,
    find_trains,
    find_turns,
    list_parts,
)

# A column of the coupled run, by "instance.variable", or "time".
Read = Callable[[str], Vector]
# So many trains are told one by one: of more those whose margin is least.
SHOWN = 4
GAP = Quantity("m", "largest gap", display_unit="um")
IMPACT = Quantity("m/s", "speed of the hardest impact")
AT_REST = SHARE.of("share of the whole run without load on the base circle and its ramps")
ON_RAMPS = SHARE.of("share of the whole run without load on the ramps above the lash")
NONE = Quantity("1")


@dataclass(frozen=True)
class Merit:
    """A figure of a part, in SI units, and when it stands (s; None: of the whole run)."""

    part: str
    figure: str
    value: float
    quantity: Quantity
    time: float | None = None

    @property
    def text(self) -> str:
        """As it is shown."""
        return say(self.value, show(self.quantity), 3)


def list_merits(system: System, contacts: ContactSummaries, read: Read) -> list[Merit]:
    """Of the recorded rows, in the order of the parts; what contacts were observed to have at every macro
    step goes before them."""
    motion = read_motion(system, read)
    found = {}
    for part, figure, quantity, (value, row) in measure(motion):
        time = None if row is None else float(motion.times[row])
        found[part, figure] = Merit(part, figure, value, quantity, time)
    for part, contact in contacts.items():
        for figure, value, time, quantity in _list_observed(contact):
            quantity = found[part, figure].quantity if (part, figure) in found else quantity
            found[part, figure] = Merit(part, figure, value, quantity, time)
    order = list(system.instances)
    # The angles of others are told with these.
    known = [m for m in found.values() if np.isfinite(m.value) and not m.figure.endswith("_angle")]
    return sorted(known, key=lambda merit: order.index(merit.part))


def read_motion(system: System, read: Read) -> Motion:
    """The recorded rows; an input has what drives it, or the value that the scenario gives it."""
    times = read("time")

    def column(name: str) -> Vector:
        instance, _, variable = name.partition(".")
        port = system.drivers.get(Port(instance, variable), Port(instance, variable))
        part = system.instances[port.instance]
        if port.variable in part.component.outputs.names:
            return read(str(port))
        given = part.inputs.get(port.variable, part.component.inputs.field(port.variable).start)
        return np.full(times.size, given)

    return Motion(system, times, column, find_drive_angle(system))


def _list_observed(contact: ContactSummary) -> Iterator[tuple[str, float, float | None, Quantity]]:
    """Figure, value, time, and the quantity of those that only an observed contact has."""
    if contact.seated:
        yield "least_load", contact.least_load, contact.least_load_time, NONE
    yield "largest_load", contact.largest_load, contact.largest_load_time, NONE
    yield "peak_pressure", contact.pressure, contact.pressure_time, NONE
    film = contact.film if contact.film >= ATOM else 0.0
    yield "least_film", film, contact.film_time, NONE
    yield "least_film_ratio", contact.film_ratio, None, NONE
    if contact.at_rest > 0.0:
        yield "at_rest", contact.at_rest, None, AT_REST
    if contact.on_ramps > 0.0:
        yield "on_ramps", contact.on_ramps, contact.ramp_time, ON_RAMPS
    if contact.separation:
        yield "largest_gap", contact.separation.gap, contact.separation.gap_time, GAP
    if contact.impact:
        yield "impact_speed", contact.impact.speed, contact.impact.time, IMPACT


def describe(system: System, merits: Sequence[Merit], read: Read) -> list[str]:
    """Warnings of clashes, then lines of trains, drive, adjusters, bearings and doubtful asperities."""
    tellers = (warn_of_clashes, describe_trains, describe_drive, describe_adjusters, describe_bearings)
    told = [line for tell in tellers for line in tell(system, merits, read)]
    figures = {f"{merit.part}.{merit.figure}": merit.value for merit in merits}
    return [*told, *remark_asperities(system, figures)]


def warn_of_clashes(system: System, merits: Sequence[Merit], read: Read) -> Iterator[str]:
    """A warning of each spring whose coils, all of one gap, clash: from where on, and how far at most."""
    for least in merits:
        if least.figure != "least_gap" or least.value >= 0.0 or least.time is None:
            continue
        if not closes_at_once(system.instances[least.part]):
            continue
        times = read("time")
        before = (times < least.time) & (read(f"{least.part}.least_gap") >= 0.0)
        first = replace(least, time=float(times[np.flatnonzero(before)[-1] + 1 if before.any() else 0]))
        places = (_find_place(system, one, read) for one in (first, least))
        yield (
            f"{WARNING}components.{least.part}: its coils clash from {next(places)} on; at {next(places)} "
            f"the tightest are {least.text.removeprefix('-')} of travel beyond coil bind; {MORE_TRAVEL}"
        )


def describe_trains(system: System, merits: Sequence[Merit], read: Read) -> list[str]:
    """A line for each train."""
    found = {(merit.part, merit.figure): merit for merit in merits}
    told, window = [], read_motion(system, read).window
    for train in (trains := find_trains(system)):
        margin, followed = _follow(train, found, window)
        said = [
            *followed,
            *_list_open(train, found),
            *_list_landing(train, found, read),
            *_list_clash(train, found),
            *_list_wire(train, found),
            *_list_clearance(train, found),
        ]
        lossy = train.parts if len(trains) > 1 else tuple(system.instances)
        said += _list_contacts(train, found)
        if friction := sum_friction(system, merits, lossy):
            said.append(_describe_friction(friction, window))
        if said:
            told.append((margin, f"{train.valve}: {'; '.join(said)}"))
    if len(told) <= SHOWN:
        return [text for _, text in told]
    least = sorted(told)[:SHOWN]
    return [
        *(text for _, text in least),
        f"{tally(len(told) - SHOWN, 'more train')} with larger spring margins",
    ]


def describe_bearings(system: System, merits: Sequence[Merit], read: Read) -> list[str]:
    """A line for each bearing, of many those with the thinnest films."""
    near = roles.Bearing.near
    found, bearings = {(m.part, m.figure): m for m in merits}, list_parts(system, roles.Bearing)
    films = {name: found[name, "least_film"] for name in bearings if (name, "least_film") in found}
    told = []
    for name in sorted(films, key=lambda name: films[name].value)[:SHOWN]:
        film, far = films[name], found[name, "largest_eccentricity"]
        load = np.interp(film.time or 0.0, read("time"), read(f"{name}.load"))
        text = f"{name}: least film {film.text} at {_find_place(system, film, read)} under {load:.3g} N"
        text += f", largest eccentricity {far.text} of the clearance"
        doubt = f", above {near:g}: roughness, bending and heat change its film by more than 1 %"
        text += f"{doubt * (far.value > near)}; highest pressure {found[name, 'peak_pressure'].text}"
        if away := found.get((name, "load_from_groove")):
            text += describe_groove(name, system.instances[name], away.value)
        told.append(text)
    return told


def describe_adjusters(system: System, merits: Sequence[Merit], read: Read) -> list[str]:
    """A line for each lash adjuster, of many those with the highest pressures."""
    found, adjusters = {(m.part, m.figure): m for m in merits}, list_parts(system, roles.Adjuster)
    known = [found[name, "chamber_pressure"] for name in adjusters if (name, "chamber_pressure") in found]
    told = []
    for highest in sorted(known, key=lambda merit: -merit.value)[:SHOWN]:
        own = {figure: merit for (part, figure), merit in found.items() if part == highest.part}
        said = [f"highest chamber pressure {highest.text} at {_find_place(system, highest, read)}"]
        if "leak_down" in own:
            opened, intake = own["check_valve_open"], own["intake"]
            lets_in = (
                f"its check valve, open in {opened.text} of the turn, lets {intake.text} in, most at "
                f"{_find_place(system, intake, read)}"
            )
            said += [
                f"leaks {own['leak_down'].text} in a turn, and is at most {own['shortening'].text} shorter",
                lets_in if opened.value > 0.0 else "its check valve stays closed",
                describe_growth(own["growth"].value, own["held_open"].value if "held_open" in own else 0.0),
            ]
        if "seat_force_kept" in own:
            said.append(f"the seat bears {own['seat_force_kept'].text} on the base circle")
        if (gap := own.get("largest_gap")) and gap.time is not None:
            said.append(
                f"bodies leave its plunger by up to {gap.text} at {_find_place(system, gap, read)}, "
                f"{_speed(find_drive_angle(system), gap.time, read)} r/min and t = {gap.time:.6g} s: {UNHELD}"
            )
        told.append(f"{highest.part}: {'; '.join(said)}")
    if len(known) > SHOWN:
        told.append(
            f"{tally(len(known) - SHOWN, 'more adjuster')} with lower chamber pressures: see summary.csv"
        )
    return told


def _find_place(system: System, merit: Merit, read: Read) -> str:
    """The angle at which a figure stands."""
    assert merit.time is not None
    angle = find_angle(system, merit.part)
    degrees, shaft = _place(angle, merit.time, read)
    if angle is None:
        return f"t = {merit.time:.6g} s"
    return f"{shaft} {float(degrees):.1f} deg{name_turn(find_turns(angle, [merit.time], read))}"


Merits = Mapping[tuple[str, str], Merit]


def _follow(train: Train, found: Merits, window: str) -> tuple[float, list[str]]:
    """Whether the cam is followed while it lifts: the share of the load that is left, and a sentence."""
    first = next(iter(train.contacts), "")
    lost, least = found.get((first, "lost")), found.get((first, "least_load"))
    if lost and lost.value > 0.0:
        return -lost.value, [f"contact is lost in {lost.text} of {window}"]
    if margin := found.get((train.valve, "spring_margin")):
        name, _, words = margin.quantity.description.partition(": ")
        return margin.value, [f"{name} {margin.text} ({words})"]
    return (least.value, [f"least load {least.text} while the cam lifts"]) if least else (0.0, [])


def _list_open(train: Train, found: Merits) -> Iterator[str]:
    """Valves that never close."""
    for valve in train.list_parts(roles.Valve):
        if (held := found.get((valve, "least_lift"))) and held.value > 0.0:
            yield f"never closes, held open by {held.text}"


def _list_landing(train: Train, found: Merits, read: Read) -> Iterator[str]:
    """Seating velocity and bounce of each valve that lands on a seat."""
    for valve in train.list_parts(roles.Valve):
        velocity, bounce = found.get((valve, "seating_velocity")), found.get((valve, "bounce"))
        if velocity and bounce:
            when = "" if velocity.time is None else f" at {_find_place(train.system, velocity, read)}"
            yield f"hardest seating {velocity.text}{when}"
            yield f"bounces by {bounce.text}" if bounce.value > 0.0 else "does not bounce"


def _list_clash(train: Train, found: Merits) -> Iterator[str]:
    """Whether coils clash, and the travel that is left where they do not."""
    springs = list_springs(train)
    gaps = [found[name, "least_gap"] for name in springs if (name, "least_gap") in found]
    for gap in gaps:
        force = found.get((gap.part, "largest_clash_force"))
        if force and force.value > 0.0:
            yield f"coils of {gap.part} clash with up to {force.text}"
        elif gap.value <= 0.0:
            yield f"coils of {gap.part} clash"
    if gaps and (least := min(gaps, key=lambda gap: gap.value)).value > 0.0:
        default = " by the component's default" * binds_by_default(train.system.instances[least.part])
        yield f"no clash of coils, {least.text} of travel left to coil bind{default}"


def _list_wire(train: Train, found: Merits) -> Iterator[str]:
    """Stress and safety of springs whose wire is known."""
    for name in list_springs(train):
        stress, safety = found.get((name, "largest_stress")), found.get((name, "fatigue_safety"))
        if stress and safety:
            yield f"wire of {name} has {stress.text}, safety against fatigue {safety.value:.3g}"


def _list_clearance(train: Train, found: Merits) -> Iterator[str]:
    for name in train.list_parts(roles.PistonClearance):
        if least := found.get((name, "least_clearance")):
            met = least.value <= 0.0
            yield f"{'meets' if met else 'stays away from'} the piston by {least.text.removeprefix('-')}"


def _list_contacts(train: Train, found: Merits) -> Iterator[str]:
    """Highest pressure, least film ratio, and what the cam has at its nose."""

    def of(figure: str, parts: Sequence[str] = train.contacts) -> list[Merit]:
        known = [found.get((part, figure)) for part in parts]
        return sorted((merit for merit in known if merit), key=lambda merit: merit.value)

    if pressures := of("peak_pressure"):
        yield f"highest pressure {pressures[-1].text} in {pressures[-1].part}"
        if (ratios := of("least_film_ratio")) and ratios[0].value > 0.0:
            yield f"least film ratio {ratios[0].value:.2g} in {ratios[0].part}"
    for part in train.contacts[:1]:
        if pressure := found.get((part, "nose_pressure")):
            film, ratio = (found.get((part, f"nose_{figure}")) for figure in ("film", "film_ratio"))
            said = f", film {film.text}" if film and film.value >= ATOM else ""
            said += f", film ratio {ratio.value:.2g}" if ratio and ratio.value > 0.0 else ""
            yield f"at the nose {pressure.text}{said} in {part}"


@dataclass(frozen=True)
class Friction:
    """Mean powers (W) that the motion contains and does not, and names of the latter."""

    in_the_motion: float
    outside: float
    left_out: str


def sum_friction(system: System, merits: Sequence[Merit], parts: Sequence[str] = ()) -> Friction | None:
    """All shares of friction (see `friction.losses`) of these parts, or of all; None where there are none."""
    found = {(merit.part, merit.figure): merit.value for merit in merits}
    own = [loss for loss in list_losses(system) if loss.part in (parts or system.instances)]
    powers = {loss: found[key] for loss in own if (key := (loss.part, loss.figure)) in found}
    if not powers:
        return None
    inside = sum(power for loss, power in powers.items() if loss.acts)
    return Friction(inside, sum(powers.values()) - inside, name_outside(powers))


def _describe_friction(found: Friction, window: str) -> str:
    said = f"friction {found.in_the_motion + found.outside:.3g} W in the mean of {window}"
    if not found.left_out:
        return f"{said}, all of it in the motion"
    inside, outside = f"{found.in_the_motion:.3g} W in the motion", f"{found.outside:.3g} W outside"
    return f"{said}: {inside}, {outside}, of {found.left_out}"


def describe_drive(system: System, merits: Sequence[Merit], read: Read) -> Iterator[str]:
    """The mean torque of the drive with all friction, and its parts."""
    powers = {(merit.part, merit.figure): merit.value for merit in merits}
    yield from describe_torque(sum_losses(read_motion(system, read), powers))


HEAD = (
    "part", "figure of merit", "value", "unit", "angle [deg]", "angle of", "time [ms]", "speed [r/min]",
    "friction", "remark",
)  # fmt: skip


def write_merits(
    system: System, merits: Sequence[Merit], doubts: Sequence[str], read: Read, path: Path
) -> None:
    """The table as a CSV file that a spreadsheet opens as it is; its last rows are the friction of all parts
    and what is doubted, as remarks of the run."""
    text = io.StringIO()
    table = csv.writer(text)
    table.writerow(HEAD)
    drive = find_drive_angle(system)
    for merit in merits:
        shown = show(merit.quantity)
        place: list[str] = ["", "", "", ""]
        if merit.time is not None:
            angle = find_angle(system, merit.part)
            place = [
                *_place(angle, merit.time, read),
                f"{1e3 * merit.time:.6g}",
                _speed(drive, merit.time, read),
            ]
        words = merit.quantity.description
        value = format_number(shown.factor * merit.value, 6)
        note = note_friction(system, merit.part, merit.figure)
        table.writerow((merit.part, words, value, shown.text, *place, note, ""))
    if friction := sum_friction(system, merits):
        inside, outside = friction.in_the_motion, friction.outside
        shares = f"{inside:.6g} W in the motion, {outside:.6g} W outside"
        row = format_number(inside + outside, 6), "W", "", "", "", "", shares, ""
        table.writerow(("all parts", "mean friction power", *row))
    if (window := read_motion(system, read).window) != RUN:
        table.writerow(("run", "means and integrals", *[""] * (len(HEAD) - 3), f"over {window}"))
    table.writerows(("run", "warning", *[""] * (len(HEAD) - 3), doubt) for doubt in doubts)
    write_sheet(path, text.getvalue())


def _place(angle: Angle | None, time: float, read: Read) -> tuple[str, str]:
    if angle is None:
        return "", ""
    return f"{float(find_degrees(angle, time, read)):.2f}", angle.name.removesuffix("_angle")


def _speed(drive: Angle | None, time: float, read: Read) -> str:
    """Of the drive, r/min."""
    if drive is None:
        return ""
    times, angles = read("time"), read(drive.source)
    i = min(max(int(np.searchsorted(times, time)), 1), len(times) - 1)
    speed = (angles[i] - angles[i - 1]) / (times[i] - times[i - 1])
    return f"{30.0 / np.pi * speed:.5g}"
