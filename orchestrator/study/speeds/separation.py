"""The speed at which a train first loses contact, with its film formula and with a second one."""

import functools
import itertools
import math
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import xarray

from models.contact.films import FILMS
from models.core.quantities import Vector
from models.core.roles import Contact
from models.core.system import ModelError

from ...assessment.figures_of_merit import CONTACT
from ...assessment.lost_contact import find_lost, list_shares
from ...assessment.motion import Motion, Part
from ...assessment.trains import list_parts, parameter_of
from ...errors import MistakeError, Option, in_command_line, one_of
from ...reporter import Reporter
from ...scenario.files import put_parameters
from ...scenario.system import build_system
from .subject import SpeedSubject, to_motion

# Of the speed (rad/s): 0.1 r/min.
CLOSE = 0.1 * math.pi / 30.0
RPM = 30.0 / math.pi
# Of a range to go on with: past the foreseen separation, and its end over the last speed, least and most.
BEYOND, FURTHER = 1.2, np.array([1.3, 3.0])
# Taken as second formula, unless all contacts have it.
USUAL, OTHER = "dowson_toyoda", "moes_venner"


class Separation(NamedTuple):
    """The lowest speeds (r/min) at which a contact is lost while the cam lifts, and at which it is lost where
    the cam slows the valve; None where it is kept. And in words."""

    speed: float | None
    nose_speed: float | None
    text: str


def find_separation(subject: SpeedSubject, table: xarray.Dataset, reporter: Reporter) -> Separation | None:
    """None for a train without contacts."""
    if not list_shares(table):
        return None
    lost, on_nose = (find_lost(table, number) for number in ("lost", "lost_on_nose"))
    speeds = table["speed"].values
    if not lost.any():
        last, end = f"{speeds[-1] * RPM:.0f}", foresee_end(table)
        to = f"to find where it is lost, go on from {last} to {end:.0f} r/min"
        return Separation(None, None, f"contact is kept up to {last} r/min, the highest speed; {to}")
    place = name_lost(table.isel(speed=int(np.argmax(lost))))
    if lost[0]:
        said = f"contact is lost at {speeds[0] * RPM:.0f} r/min, the lowest speed{place}"
        return Separation(None, None, said)
    count = (1 + bool(on_nose.any())) * _count_halvings(speeds)
    try:
        with _find_losses(subject, "speed of separation", count, reporter) as (is_lost, unsteady):
            speed = _bisect(is_lost, speeds, int(np.argmax(lost)), "lost")
            nose = (
                _bisect(is_lost, speeds, int(np.argmax(on_nose)), "lost_on_nose") if on_nose.any() else None
            )
    except ModelError as error:
        return Separation(None, None, f"the speed of separation was not found: {error}")
    again = speeds[int(np.argmax(lost)) :][~lost[int(np.argmax(lost)) :]]
    kept = f", and kept again at {list_speeds(again, speeds)}" if again.size else ""
    text = f"contact is lost from {speed:.1f} r/min{place}{kept}{_describe_place(table, speed, nose)}"
    return Separation(round(speed, 2), nose and round(nose, 2), text + _doubt(unsteady))


def foresee_end(table: xarray.Dataset) -> float:
    """The end (r/min) of a range that goes on from the last speed, at which contact is kept.

    Loads of inertia grow with the square of the speed, so that a least load between the lowest and the last
    speed tells where it would be gone: the range ends BEYOND it, within FURTHER of the last speed. It ends at
    the first of these where the load does not fall.
    """
    speeds = RPM * table["speed"].values
    near, far = FURTHER * speeds[-1]
    names = list_shares(table, "least_load")
    loads = [np.nanmin([[np.inf], *([table[name].values[row]] for name in names)]) for row in (0, -1)]
    fallen, end = loads[0] - loads[1], near
    if speeds.size > 1 and 0.0 < fallen < np.inf:
        gone = speeds[-1] ** 2 + (speeds[-1] ** 2 - speeds[0] ** 2) * loads[1] / fallen
        end = float(np.clip(BEYOND * math.sqrt(gone), near, far))
    return 100.0 * math.ceil(end / 100.0)


def name_lost(at: xarray.Dataset) -> str:
    """The contacts that are lost at a speed, after "in"; of a train with one contact nothing."""
    shares = list_shares(at)
    names = [name.removesuffix(".lost") for name in shares if at[name] > 0.0]
    return f" in {', '.join(names)}" if names and len(shares) > 1 else ""


def list_speeds(speeds: Vector, every: Vector | None = None) -> str:
    """One speed, or the first and the last of several, and how many of `every` one between them."""
    first, last = f"{speeds[0] * RPM:.0f}", f"{speeds[-1] * RPM:.0f}"
    within = 0 if every is None else np.count_nonzero((every >= speeds[0]) & (every <= speeds[-1]))
    count = f"{len(speeds)} of {within}" if within > len(speeds) else f"{len(speeds)}"
    return f"{first} r/min" if first == last else f"{count} speeds from {first} to {last} r/min"


def bisect_separation(
    separated: Callable[[float], bool], kept: float, lost: float, share: float = 0.0
) -> float:
    """A speed (rad/s) of separation, to CLOSE or a `share` of it, between one that keeps contact and one that
    loses it."""
    while lost - kept > max(CLOSE, share * lost):
        middle = 0.5 * (kept + lost)
        if separated(middle):
            lost = middle
        else:
            kept = middle
    return lost


def is_separated(motion: Motion, number: str) -> bool:
    """Whether a contact is lost while the cam lifts; `lost_on_nose`: where it slows the valve."""
    share = CONTACT[number][1]
    return any(share(Part(motion, name)).value > 0.0 for name in list_parts(motion.system, Contact))


@contextmanager
def _find_losses(
    subject: SpeedSubject, stage: str, count: int, reporter: Reporter
) -> Iterator[tuple[Callable[[float, str], bool], Collection[float]]]:
    """A function of speed (rad/s) and number, and the speeds at which it found no steady cycle; what it finds
    at a speed serves all numbers.

    A stage shows the progress, of about `count` cycles.
    """
    with reporter.stage(stage) as bar:
        done, unsteady = itertools.count(1), set[float]()

        @functools.cache
        def measure(speed: float) -> dict[str, bool]:
            try:
                cycle = subject.find_cycle_at(speed)
            except ModelError as error:
                raise ModelError((f"at {RPM * speed:.0f} r/min ", error.fault), *error.remedies) from None
            if not cycle.steady:
                unsteady.add(speed)
            bar.show(min(0.99, next(done) / count))
            motion = to_motion(cycle, subject.flywheel)
            return {number: is_separated(motion, number) for number in ("lost", "lost_on_nose")}

        yield (lambda speed, number: measure(speed)[number]), unsteady


def _doubt(unsteady: Collection[float]) -> str:
    """The end of a verdict that rests on motions without a steady cycle, at these speeds (rad/s)."""
    return f"; judged without a steady cycle at {list_speeds(np.array(sorted(unsteady)))}" if unsteady else ""


def _count_halvings(speeds: Vector) -> int:
    """Of a distance of these speeds (rad/s) until it is CLOSE."""
    if speeds.size < 2:
        return 1
    return max(1, math.ceil(math.log2(float(np.diff(speeds).max()) / CLOSE)))


def _bisect(is_lost: Callable[[float, str], bool], speeds: Vector, first: int, number: str) -> float:
    """The speed (r/min) between the row before `first`, with contact, and that row, without."""
    kept, lost = float(speeds[first - 1]), float(speeds[first])
    return RPM * bisect_separation(lambda speed: is_lost(speed, number), kept, lost)


def _describe_place(table: xarray.Dataset, speed: float, nose: float | None) -> str:
    """Whether contact is lost over the nose, where the spring is too weak, or only on the flanks."""
    if all(np.isnan(table[name].values).all() for name in list_shares(table, "lost_on_nose")):
        return ""
    if nose is None:
        return "; it rebounds on the flanks, and is not lost where the cam slows the valve"
    if nose - speed < 1.0:
        return ", where the cam slows the valve"
    return f"; on the flanks, where it rebounds, and where the cam slows the valve from {nose:.1f} r/min"


def check_film(film: str | None) -> None:
    """MistakeError for a film formula that there is not."""
    if film is not None and film not in FILMS:
        raise MistakeError((Option("second_film", film), f": {one_of(FILMS, film)}"))


def choose_film(subject: SpeedSubject, film: str | None) -> str | None:
    """The second film formula: `film`, or the usual one; None where the contacts have no other."""
    films = set(_list_films(subject).values())
    chosen = film or (OTHER if films == {USUAL} else USUAL)
    return None if films <= {chosen} else chosen


def _list_films(subject: SpeedSubject) -> dict[str, str]:
    """The film formula of each contact that has one."""
    instances = build_system(subject.scenario).instances
    return {
        name: tuple(FILMS)[int(parameter_of(instance, "film_model"))]
        for name, instance in instances.items()
        if "film_model" in (layout := instance.component.parameters).names
        and layout.field("film_model").quantity.choices == tuple(FILMS)
    }


def find_second(
    subject: SpeedSubject, speeds: Vector, first: Separation, film: str, reporter: Reporter
) -> Separation:
    """With the formula `film` in all contacts that have one; between the same `speeds` (rad/s) of the sweep.

    They are tried from where contact was lost first: where it is then kept upwards, else downwards.
    """
    films = {f"{name}.film_model": film for name in _list_films(subject)}
    alone = replace(subject, folder=None)
    second = replace(alone, tables=put_parameters(subject.tables, films), near=alone)
    count = (1 + bool(first.nose_speed)) * (2 + _count_halvings(speeds))

    def find(is_lost: Callable[[float, str], bool], number: str, first_speed: float | None) -> float | None:
        near = speeds.size - 1 if first_speed is None else int(np.searchsorted(RPM * speeds, first_speed))
        i = find_first(lambda k: is_lost(float(speeds[k]), number), near, speeds.size)
        if not i:
            return i and RPM * float(speeds[0])
        return round(_bisect(is_lost, speeds, i, number), 2)

    try:
        stage = f"speed of separation with {film}"
        with _find_losses(second, stage, count, reporter) as (is_lost, unsteady):
            speed = find(is_lost, "lost", first.speed)
            nose = find(is_lost, "lost_on_nose", first.nose_speed) if first.nose_speed and speed else None
    except ModelError as error:
        said = f"with film_model = {film} no speed of separation was found: ", error.fault
        text = in_command_line((*said, "; choose another ", Option("second_film")))
        return Separation(None, None, text)
    verdict = _describe_second(first, speed, nose) + _doubt(unsteady)
    return Separation(speed, nose, f"with film_model = {film} {verdict}")


def find_first(lost: Callable[[int], bool], near: int, count: int) -> int | None:
    """The first of `count` rows that is lost, from `near` downwards where that one is lost, else upwards."""
    if not lost(near):
        return next((k for k in range(near + 1, count) if lost(k)), None)
    while near > 0 and lost(near - 1):
        near -= 1
    return near


def _describe_second(first: Separation, speed: float | None, nose: float | None) -> str:
    if speed is None:
        return "contact is kept at all these speeds"
    text = f"contact is lost from {_compare(speed, first.speed)}"
    if nose is None or nose - speed < 1.0:
        return text
    return f"{text}, where the cam slows the valve from {_compare(nose, first.nose_speed)}"


def _compare(speed: float, first: float | None) -> str:
    """A speed (r/min), and by how much it is above the first one."""
    return f"{speed:.1f} r/min" + (f" ({100.0 * (speed / first - 1.0):+.1f} %)" if first else "")
