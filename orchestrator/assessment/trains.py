"""The valve trains of a system, and the angles over which its parts are read; both found by roles."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import chain
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from models.core import roles
from models.core.quantities import Quantity, Vector
from models.core.system import Instance, System
from models.valve_train.cams.table import Points

from ..errors import MistakeError
from ..store.coordinates import Coordinate
from .lost_contact import LOST, ContactLaw

# What ends a train: it is no part of one, or of several.
ENDS = (
    *(roles.Drive, roles.Cam, roles.Bearing, roles.DrawnShaft),
    *(roles.CylinderGas, roles.Crank, roles.PistonCrank),
)
CRANKS = ENDS[-3:]
# Of the largest lift: above it a cam lifts.
LIFTED = 0.1
# Of a revolution: a run that lacks no more than this is one; what is missing is some of the base circle.
OPEN = 0.01
# Until the lift of a rocker's valve is found to rounding: each takes a digit or more.
ITERATIONS = 20
WORDS = {"cam_angle": "Cam angle", "crank_angle": "Crank angle", "shaft_angle": "Shaft angle"}


@dataclass(frozen=True)
class Angle:
    """An angle in a result: `factor` times the output `source` (rad)."""

    name: str
    source: str
    factor: float = 1.0

    @property
    def words(self) -> str:
        return WORDS[self.name]

    @property
    def coordinate(self) -> Coordinate:
        times = "" if self.factor == 1.0 else f"{self.factor:g} times "
        meaning = f"{self.words.lower()}: {times}{self.source}"
        return Coordinate(self.source, self.factor, Quantity("rad", meaning, display_unit="deg"))


@dataclass(frozen=True)
class Train:
    """A cam and what moves with it. `parts` begin with the cam; nearer ones come first."""

    system: System
    cam: str
    parts: tuple[str, ...]

    @property
    def role(self) -> roles.Cam:
        found = self.system.instances[self.cam].component.find_role(roles.Cam)
        assert found
        return found

    @property
    def angle(self) -> Angle:
        return Angle("cam_angle", f"{self.cam}.{self.role.angle}")

    def list_parts(self, role: type[roles.Role]) -> list[str]:
        """Parts in this role, the nearest to the cam first."""
        return [name for name in self.parts if self.system.instances[name].component.has_role(role)]

    @property
    def valve(self) -> str:
        """The part that moves as the valve does: of a train without one its follower."""
        followers = self.list_parts(roles.Valve) or self.list_parts(roles.TranslatingFollower)
        return next(iter(followers), self.cam)

    @property
    def lift(self) -> str:
        """The output that is the lift of the valve."""
        return f"{self.valve}.{'valve_lift' if self.list_parts(roles.Valve) else 'position'}"

    @property
    def contacts(self) -> list[str]:
        return self.list_parts(roles.Contact)

    def find_lobe(self, largest: float) -> float:
        """The lift (m) above which a cam of this largest lift lifts: a tenth of it, and the valves' lash."""
        return max(LIFTED * largest, self.lash)

    def find_cam_lash(self, lash: float) -> float:
        """The lift of the cam (m) that takes up a lash at the valve (m). A finger's lift is its valve's; a
        rocker has it from the rod's end."""
        rockers = [self.system.instances[name] for name in self.list_parts(roles.Rocker)]
        return max((_find_rod_position(rocker, lash) for rocker in rockers), default=lash)

    @cached_property
    def ratio(self) -> float:
        """The largest lift of the valve, before its lash, over that of the cam."""
        largest = tip = self.largest_lift
        for _ in range(ITERATIONS if largest else 0):
            tip *= largest / self.find_cam_lash(tip)
        return tip / largest if largest else 1.0

    @cached_property
    def lash(self) -> float:
        """The largest of its valves, as the cam has it (m)."""
        return self.find_cam_lash(max(self.list_of_valves("lash"), default=0.0))

    @property
    def lobe(self) -> float:
        return self.find_lobe(self.largest_lift)

    @cached_property
    def largest_lift(self) -> float:
        """Of its own cam (m), by a law or points with their ramps; of another 0."""
        cam = self.system.instances[self.cam]
        own = [n for n in cam.component.parameters.names if n == "lift" or n.startswith("table_lift[")]
        height = parameter_of(cam, "ramp_height") if own else 0.0
        return height + max((parameter_of(cam, name) for name in own), default=0.0)

    @cached_property
    def closing_ramp(self) -> float:
        """Height of its own cam's closing ramp (m), as given, or as its points have it; 0: none."""
        cam = self.system.instances[self.cam]
        names = cam.component.parameters.names
        if height := parameter_of(cam, "ramp_height") if "ramp_height" in names else 0.0:
            return height
        if "table_angle[1]" not in names:
            return 0.0
        from models.valve_train.cams.smoothing import find_ramp  # its libraries take long to import

        p = cam.component.parameters.view(cam.component.parameters.vector(cam.parameters))
        return find_ramp(Points(p.table_angle, p.table_lift, p.table_slope, p.table_curvature), [-1])

    @property
    def valve_lift(self) -> float:
        """The valve's full lift (m) where nothing yields, less the lash; above 0 for an own cam only."""
        return self.ratio * self.largest_lift - max(self.list_of_valves("lash"), default=0.0)

    @property
    def contact_law(self) -> ContactLaw:
        rests = any(self.list_of_valves("seat_stiffness")) and not self.list_parts(roles.Adjuster)
        return ContactLaw(self.lash, self.lobe) if rests else ContactLaw()

    def list_of_valves(self, parameter: str) -> list[float]:
        """Of those that have it, the nearest to the cam first."""
        valves = [self.system.instances[name] for name in self.list_parts(roles.Valve)]
        having = [valve for valve in valves if parameter in valve.component.parameters.names]
        return [parameter_of(valve, parameter) for valve in having]


@lru_cache(maxsize=8)  # figures ask for each panel
def find_trains(system: System) -> tuple[Train, ...]:
    """The trains of the system, in the order of their cams."""
    near = _list_neighbours(system)
    cams = list_parts(system, roles.Cam)
    ends = {name for name, others in near.items() if len(others & set(cams)) > 1}
    ends |= set(chain.from_iterable(list_parts(system, role) for role in ENDS))
    return tuple(Train(system, cam, tuple(_reach(cam, near, ends))) for cam in cams)


def find_angles(system: System) -> dict[str, Angle]:
    """The angles of the system by their names, the usual abscissa first.

    That is the cam's, of several the first one's, and its crank's: the drive's where cams turn with another
    speed or there is a crank, else twice the cam's, as in a four-stroke engine. Of a drive without cam or
    crank it is the shaft's.
    """
    drive, trains = find_drive_angle(system), find_trains(system)
    if not trains:
        return {drive.name: drive} if drive else {}
    cam = trains[0].angle
    crank = drive if drive and drive.name == "crank_angle" else Angle("crank_angle", cam.source, 2.0)
    return {angle.name: angle for angle in (cam, crank)}


def find_drive_angle(system: System) -> Angle | None:
    """The angle of the drive: the crank's where there is a crank or cams turn with another speed, the
    camshaft's where they turn with it, else a shaft's."""
    for drive in list_parts(system, roles.Drive):
        cranked = any(list_parts(system, role) for role in CRANKS)
        turned = cranked or any(ratio != 1.0 for ratio in list_ratios(system))
        name = "crank_angle" if turned else "cam_angle" if list_parts(system, roles.Cam) else "shaft_angle"
        return Angle(name, f"{drive}.angle")
    return None


def find_train(system: System, instance: str) -> Train | None:
    """The train whose part it is."""
    return next((train for train in find_trains(system) if instance in train.parts), None)


def find_law(system: System, contact: str) -> ContactLaw:
    """That of its train."""
    train = find_train(system, contact)
    return train.contact_law if train else ContactLaw()


def find_lost_rows(system: System | None, contact: str, column: Callable[[str], Vector]) -> NDArray[np.bool_]:
    """Where the contact is lost, in rows of "instance.variable". Without a system the load alone says it."""
    train, load = find_train(system, contact) if system else None, column(f"{contact}.load")
    law = train.contact_law if train else ContactLaw()
    lift = column(f"{train.cam}.cam_lift") if train and law.rests else load
    return law.judge(load, lift) == LOST


def find_angle(system: System, instance: str) -> Angle | None:
    """The angle over which the instance is read: its own cam's, or else the crank's or shaft's."""
    own = find_train(system, instance)
    return own.angle if own else find_drive_angle(system)


def find_degrees(angle: Angle, times: float | Sequence[float], column: Callable[[str], Vector]) -> Vector:
    """The angle in degrees of its turn at times (s), between rows, through which shafts turn evenly, and on
    from the last of a run that broke off after it."""
    turned, rows = np.degrees(angle.factor * column(angle.source)), column("time")
    past = np.maximum(0.0, np.asarray(times) - rows[-1])
    k = int(np.searchsorted(rows, rows[-1])) - 1  # the last row before that time, which may come twice
    speed = (turned[-1] - turned[k]) / (rows[-1] - rows[k]) if past.any() and k >= 0 else 0.0
    return np.asarray((np.interp(times, rows, turned) + speed * past) % 360.0)


def find_turns(angle: Angle, times: Sequence[float], column: Callable[[str], Vector]) -> list[int]:
    """The whole revolutions, from 1, in which times (s) of a run are; none of a run of one. Before the first
    whole one it is 0."""
    turned = angle.factor * column(angle.source) / (2.0 * math.pi)
    first = math.ceil(turned[0] - OPEN)
    if turned[-1] - first <= 1.0 + OPEN:
        return []
    return [math.floor(at) - first + 1 for at in np.interp(times, column("time"), turned)]


def list_ratios(system: System) -> list[float]:
    """Speeds of shafts over that of their drive."""
    return [
        parameter_of(instance, "drive_ratio")
        for instance in system.instances.values()
        if "drive_ratio" in instance.component.parameters.names
    ]


def parameter_of(instance: Instance, name: str) -> float:
    """As given, or its default."""
    return instance.parameters.get(name, instance.component.parameters.field(name).start)


def has_defaults(instance: Instance, names: Iterable[str]) -> bool:
    """Whether all these parameters have the component's own values."""
    fields = map(instance.component.parameters.field, names)
    return all(parameter_of(instance, field.name) == field.start for field in fields)


def count_gas_turns(gas: Instance) -> float:
    """Turns of the crank in a cycle of its gas; two of a four-stroke engine."""
    known = "cycle_turns" in gas.component.parameters
    return parameter_of(gas, "cycle_turns") if known else 2.0


def _find_rod_position(rocker: Instance, tip: float) -> float:
    role, numbers = rocker.component.find_role(roles.Rocker), rocker.component.parameters
    assert role
    return role.find_rod_position(tip, numbers.named(numbers.vector(rocker.parameters)))


def list_parts(system: System, role: type[roles.Role]) -> list[str]:
    """The parts in this role."""
    return [name for name, instance in system.instances.items() if instance.component.has_role(role)]


def find_cams(system: System, *velocities: str) -> dict[str, str]:
    """The cam of each part that takes one of these inputs, `sliding_velocity` or `rolling_velocity`, from a
    cam, directly or by the spin of its tappet."""
    given = (*velocities, "contact_sliding")
    lines = [
        (c.source.instance, c.target.instance)
        for c in system.connections
        if c.target.variable in velocities and c.source.variable in given
    ]
    cams, spins = list_parts(system, roles.Cam), list_parts(system, roles.Spin)
    found = {taker: giver for giver, taker in lines if giver in cams}
    return found | {taker: found[giver] for giver, taker in lines if giver in spins and giver in found}


def _list_neighbours(system: System) -> dict[str, set[str]]:
    near: dict[str, set[str]] = {name: set() for name in system.instances}
    for connection in system.connections:
        near[connection.source.instance].add(connection.target.instance)
        near[connection.target.instance].add(connection.source.instance)
    return near


def _reach(cam: str, near: dict[str, set[str]], ends: set[str]) -> Iterator[str]:
    order = list(near)
    seen, waiting = {cam}, [cam]
    while waiting:
        at = waiting.pop(0)
        yield at
        found = sorted(near[at] - seen - ends, key=order.index)
        seen.update(found)
        waiting += found


# Knots at most of the spline through a lift that was recorded: closer ones show the rounding of its values in
# the second derivative.
KNOTS = 4000
# Of the polynomial from a rod's to a valve's end of a rocker: its remainder is below 1e-6 of the lift.
DEGREE = 6


class Kinematics(NamedTuple):
    """Lift (m), velocity (m/s) and acceleration (m/s2) at the times of records."""

    lift: Vector
    velocity: Vector
    acceleration: Vector


def find_rigid_lift(train: Train, column: Callable[[str], Vector]) -> Vector:
    """The cam's lift, which a rocker transmits as its ends have moved in these records."""
    lift = column(f"{train.cam}.cam_lift")
    for rocker in train.list_parts(roles.Rocker):
        rod, tip = column(f"{rocker}.rod_position"), column(f"{rocker}.tip_position")
        if np.ptp(rod) > 0.0:
            lift = np.polynomial.Polynomial.fit(rod, tip, DEGREE)(lift)
    return lift


def find_kinematics(train: Train, time: Vector, values: Mapping[str, Vector]) -> Kinematics:
    """Of the rigid train's lift."""
    lift = find_rigid_lift(train, values.__getitem__)
    # Rows of step control may lie within a rounding of each other.
    apart = (time[-1] - time[0]) / KNOTS
    _, kept = np.unique(np.floor((time - time[0]) / apart), return_index=True)
    spline = scipy.interpolate.CubicSpline(time[kept], lift[kept])
    return Kinematics(lift, spline(time, 1), spline(time, 2))


def check_lash(system: System) -> None:
    """MistakeError for a cam that no valve follows, as its lift does not take up the lash: contact would seem
    to be kept."""
    for train in find_trains(system):
        if 0.0 < train.largest_lift <= train.lash:
            taken, lift = (f"{1e3 * length:.3g} mm" for length in (train.lash, train.largest_lift))
            raise MistakeError(
                f"{train.valve}: its lash takes {taken} of the lift of {train.cam}, which is {lift}",
                "lower the lash, or raise the lift",
            )


def describe_floating(system: System) -> list[str]:
    """A sentence on each train whose parts, between the cam and the valve, nothing takes to rest within the
    lash, as they have no weight."""
    found = []
    for train in find_trains(system):
        weights = {
            f"components.{name}.parameters.gravity": parameter_of(system.instances[name], "gravity")
            for name in train.parts[: train.parts.index(train.valve)]
            if "gravity" in system.instances[name].component.parameters
        }
        if train.lash > 0.0 and train.contact_law.rests and weights and not any(weights.values()):
            parts, paths = (
                " and ".join(names) for names in ([one.split(".")[1] for one in weights], weights)
            )
            found.append(
                f"{parts}: nothing brings them to rest within the lash while {train.valve} is closed, so "
                f"each turn may begin differently; give them weight: set {paths} to '9.81 m/s2'"
            )
    return found
