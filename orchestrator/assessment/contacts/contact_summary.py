"""What a contact went through, as a run's summary has it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from models.compile.array_pointers import ArrayPointers
from models.contact.ehl_contact import TABLE_3
from models.contact.films import FILMS, GROWING
from models.contact.films.groups import Conditions, groups
from models.contact.hertz import elastic_compliance
from models.core import roles
from models.core.quantities import Vector
from models.core.system import System

from ..trains import find_law, find_train, list_parts
from .accumulation import INPUTS, LIFT, OUTPUTS, SEEN, accumulate, finish, make_records, regain, replay

# A landing whose load has its peak within fewer macro steps than this is not resolved.
RESOLVED = 5


@dataclass(frozen=True)
class Excursion:
    """A group outside its range [`low`, `high`]: for which share of the time under load, and its extremes."""

    share: float
    least: float
    most: float
    low: float
    high: float


@dataclass(frozen=True)
class Separation:
    """How often and how long (s) a contact was lost: altogether, the longest time and when it began; the
    largest gap then (m, beyond the film) and when."""

    count: int
    duration: float
    longest: float
    longest_time: float
    gap: float
    gap_time: float


@dataclass(frozen=True)
class Impact:
    """The landing with the largest load (N): when it began (s), the speed of approach (m/s), the impulse
    (N s) until the load has fallen to a tenth or rises again, and the macro steps from touch to peak."""

    time: float
    load: float
    speed: float
    impulse: float
    steps: int

    @property
    def resolved(self) -> bool:
        return self.steps >= RESOLVED


@dataclass(frozen=True)
class ContactSummary:
    """Extremes, each with its time (s): load (N), pressure (Pa), film (m) under load, film over roughness
    (0: smooth), which of a film that is `solved` for is that of its central film. A dry contact's films are
    0.

    `film_power` (W) is what the growing film gives to the motion on average, `film_feed` the share of the
    power through the film, to and fro, that stays there, `film_friction` the coefficient of rolling friction
    that would take as much, `film_grows` whether the formula's film grows with the load.
    By the `ContactLaw`, `lost` is the share of the time in which contact is lost, `at_rest` that without load
    else, and `on_ramps` that of it on ramps above the lash, up to `ramp_lift` (m). Where a seat may bear the
    valve (`seated`) the least load is that while the cam lifts, elsewhere that of the whole time.
    `yielding` is the share of the time above the `elastic_limit` (Pa).
    `longest_step` (s): extremes were looked for at least that often. `angles` (deg) of the times are of the
    shaft's `angle_of`, such as cam_angle; "" where none is known. `turns` are its revolutions, from 1; none
    of a run of one.
    """

    least_load: float
    largest_load: float
    largest_load_time: float
    lost: float
    pressure: float
    pressure_time: float
    elastic_limit: float
    yielding: float
    film: float
    film_time: float
    film_ratio: float
    longest_step: float
    film_power: float = 0.0
    film_feed: float = 0.0
    film_grows: bool = False
    film_friction: float = 0.0
    separation: Separation | None = None
    impact: Impact | None = None
    ranges: dict[str, Excursion] = field(default_factory=dict)
    solved: bool = False
    angle_of: str = ""
    angles: dict[str, float] = field(default_factory=dict)
    turns: dict[str, int] = field(default_factory=dict)
    least_load_time: float = 0.0
    at_rest: float = 0.0
    on_ramps: float = 0.0
    ramp_lift: float = 0.0
    ramp_time: float = 0.0
    seated: bool = False

    def times(self) -> dict[str, float]:
        """When what it tells happened (s), by name."""
        times = {
            "least_load": self.least_load_time,
            "largest_load": self.largest_load_time,
            "pressure": self.pressure_time,
            "film": self.film_time,
        }
        if self.on_ramps > 0.0:
            times["ramp"] = self.ramp_time
        if self.separation:
            times |= {"separation": self.separation.longest_time, "gap": self.separation.gap_time}
        if self.impact:
            times["impact"] = self.impact.time
        return times


ContactSummaries = dict[str, ContactSummary]
# What a summary has as it was accumulated.
KEPT = (
    "least_load", "least_load_time", "largest_load", "pressure", "pressure_time", "film_time", "ramp_lift",
    "ramp_time", "longest_step",
)  # fmt: skip


def contacts(system: System) -> dict[str, dict[str, float]]:
    """The parameters of all lubricated contacts."""
    found = {}
    for name in list_parts(system, roles.Contact):
        layout = system.instances[name].component.parameters
        found[name] = layout.named(layout.vector(system.instances[name].parameters))
    return found


class Accumulator:
    """The summaries of a system's contacts while a run goes on.

    `seen` (contacts x SEEN) is to be filled before each step is added; inputs with an origin in `values` are
    taken from there.
    """

    def __init__(
        self,
        system: System,
        names: Sequence[str],
        values: Vector | None = None,
        origins: Mapping[str, int] | None = None,
    ) -> None:
        all_of_them = contacts(system)
        self._parameters = {name: all_of_them[name] for name in names}
        self._laws = {name: find_law(system, name) for name in names}
        count = len(self._parameters)
        self.seen: Vector = np.zeros((count, len(SEEN)))
        places = np.full(2 * count, -1, dtype=np.int64)
        for i, name in enumerate(self._parameters):
            layout = system.instances[name].component.inputs
            constant = layout.named(layout.vector(system.instances[name].inputs))
            for j, variable in enumerate(INPUTS):
                self.seen[i, len(OUTPUTS) + j] = constant[variable]
                places[2 * i + j] = (origins or {}).get(f"{name}.{variable}", -1)
        self.summaries, self.ranges = make_records(count)
        self.memory = ArrayPointers(
            seen=self.seen,
            values=np.zeros(1) if values is None else values,
            origins=places,
            scales=np.array(
                [[*_scales(p), *self._laws[name]] for name, p in self._parameters.items()]
            ).reshape(count, 6),
            bounds=np.array(list(TABLE_3.values())),
            ranges=self.ranges,
        )

    def add(self, time: float) -> None:
        """The step that ends at `time`."""
        accumulate(self.memory.record, self.summaries, time)

    def state(self) -> dict[str, Vector]:
        return {name: self.summaries[name].copy() for name in self.summaries.dtype.names} | {
            "ranges": self.ranges.copy()
        }

    def resume(self, state: Mapping[str, Vector]) -> None:
        for name in self.summaries.dtype.names:
            self.summaries[name] = state[name]
        self.ranges[:] = state["ranges"]

    def found(self) -> ContactSummaries:
        """The summaries so far of all contacts that were ever loaded."""
        summaries = {}
        for i, (name, parameters) in enumerate(self._parameters.items()):
            c = self.summaries[i : i + 1].copy()[0]
            if c.largest_load > 0.0:
                found = _course(c, self.ranges[i].reshape(4, 4), parameters)
                summaries[name] = replace(found, seated=self._laws[name].rests)
        return summaries


def _scales(p: Mapping[str, float]) -> list[float]:
    """The elastic limit (Pa), and the groups G, W R and U R at 1 N, 1 m/s."""
    compliance = elastic_compliance(
        p["youngs_modulus_1"], p["poissons_ratio_1"], p["youngs_modulus_2"], p["poissons_ratio_2"]
    )
    plain = getattr(groups, "py_func", groups)  # not compiled for this one call
    at = Conditions(1.0, 1.0, p["length"], compliance, p["viscosity"], p["pressure_viscosity"])
    unit = plain(np.pi / compliance, 1.0, at)
    return [p["elastic_limit"], unit.material, unit.load, unit.speed]


def _course(record: Any, ranges: Vector, parameters: Mapping[str, float]) -> ContactSummary:
    regain(record, record.time)
    finish(record)
    c = SimpleNamespace(**dict(zip(record.dtype.names, record.item(), strict=True)))
    solved = "film_model" not in parameters
    formula = "" if solved else tuple(FILMS)[int(parameters["film_model"])]
    dry = formula == "dry"
    separation = impact = None
    if c.separations:
        longest = (c.longest_separation, c.separation_time, c.gap, c.gap_time)
        separation = Separation(int(c.separations), c.lost_duration, *longest)
    if c.landings:
        impact = Impact(c.impact_time, c.impact_load, c.impact_speed, c.impulse, int(c.impact_steps))
    excursions = {}
    if formula.startswith("kushwaha") and c.loaded_duration:
        for (group, range_), (_, duration, least, most) in zip(TABLE_3.items(), ranges.tolist(), strict=True):
            if least > most:
                least = most = np.nan
            if duration > 0.0:
                excursions[group] = Excursion(duration / c.loaded_duration, least, most, *range_)

    def share(part: float, whole: float = c.duration) -> float:
        return part / whole if whole else 0.0

    return ContactSummary(
        **{name: getattr(c, name) for name in KEPT},
        largest_load_time=c.load_time,
        lost=share(c.lost_duration),
        at_rest=share(c.rest_duration),
        on_ramps=share(c.ramp_duration),
        elastic_limit=parameters["elastic_limit"],
        yielding=share(c.yield_duration),
        film=0.0 if dry else c.film,
        film_ratio=0.0 if dry else c.film_ratio,
        film_power=share(c.film_work),
        film_grows=formula == GROWING,
        film_feed=share(c.film_work, c.film_gross),
        film_friction=share(c.film_work, c.rolled),
        separation=separation,
        impact=impact,
        ranges=excursions,
        solved=solved,
    )


def summarise_rows(system: System, column: Callable[[str], Vector]) -> ContactSummaries:
    """The summaries as recorded rows have them, by "instance.variable" and "time", where nothing else is left
    of a run."""
    drivers = {str(t): str(source) for t, source in system.drivers.items() if t.variable in INPUTS}
    trains = {name: find_train(system, name) for name in contacts(system)}
    drivers |= {f"{name}.{LIFT}": f"{train.cam}.{LIFT}" for name, train in trains.items() if train}
    found: ContactSummaries = {}
    for name in contacts(system):
        # One contact at a time: there may be millions of records.
        accumulator = Accumulator(system, [name])
        times = column("time")
        rows = np.tile(accumulator.seen[0], (len(times), 1))
        for j, variable in enumerate(SEEN):
            source = drivers.get(own := f"{name}.{variable}", own)
            if source in system.outputs.names:
                rows[:, j] = column(source)
        replay(accumulator.memory.record, accumulator.summaries, times, rows)
        found |= accumulator.found()
    return found
