"""What an engineer asks of a steady cycle, by the parts that a train has.

To add a number: a row in the table of its part.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from models.contact.records import ATOM
from models.core import roles
from models.core.component import Component
from models.core.quantities import Vector
from models.core.system import Instance, System
from models.monolithic.cycle import Cycle

from ...analyses import Result
from ...scenario import Scenario

# Of the largest lift, above which a cam lifts.
LIFTED = 0.1
DEGREES, MILLIMETRES, MICROMETRES, MEGAPASCAL = "deg", "mm", "um", "MPa"


@dataclass(frozen=True)
class Part:
    """A part in a cycle: its variables by their own names, the cam angle (rad), and where the cam lifts."""

    cycle: Cycle
    name: str
    angle: Vector
    lifted: NDArray[np.bool_]

    def __getitem__(self, variable: str) -> Vector:
        return self.cycle[f"{self.name}.{variable}"]

    def parameter(self, name: str) -> float:
        return parameter_of(self.cycle.system.instances[self.name], name)

    def mean(self, values: Vector | NDArray[np.bool_]) -> float:
        """Over the cycle."""
        # The sum of two truth values is a truth value.
        numbers = np.asarray(values, dtype=np.float64)
        return float(np.trapezoid(numbers, self.cycle.times) / self.cycle.times[-1])


Number = tuple[Result, Callable[[Part], float]]


def _landing(part: Part) -> int | None:
    """The first sample on the seat after the valve was open; None: it does not land."""
    dip = part["seat_dip"]
    found = np.flatnonzero((dip[:-1] < 0.0) & (dip[1:] >= 0.0))
    if part.parameter("seat_stiffness") == 0.0 or not found.size:
        return None
    highest = int(np.argmax(part["position"]))
    return int(next((i for i in found if i >= highest), found[0]))


def _seating_velocity(part: Part) -> float:
    """As it enters the seat."""
    landing = _landing(part)
    return -float(part["velocity"][landing]) if landing is not None else math.nan


def _bounce(part: Part) -> float:
    """How far the valve leaves its seat again within 60 deg after landing."""
    landing = _landing(part)
    if landing is None:
        return math.nan
    turned = (part.angle - part.angle[landing]) % (2.0 * math.pi)
    after = (turned > 0.0) & (turned < math.radians(60.0)) & (np.arange(turned.size) > landing + 1)
    return max(0.0, float(np.max(-part["seat_dip"][after], initial=0.0)))


def _spring_margin(part: Part) -> float:
    """Least load that opens the valve over the spring's force, while it is off its seat."""
    opened = part["position"] > 0.05 * np.max(part["position"])
    return float(np.min(part["load"][opened] / part["spring_force"][opened]))


def _surge(part: Part) -> float:
    """Largest force of the coils' own motion: the spring's less that of its static rate."""
    static = part.parameter("preload") + part.parameter("spring_rate") * part["position"]
    return float(np.max(np.abs(part["spring_force"] - static)))


def _twist(shaft: Part) -> float:
    driven = shaft.parameter("drive_ratio") * shaft["drive_angle"] + shaft.parameter("phase")
    return float(np.max(np.abs(shaft["cam_angle"] - driven)))


def _at(part: Part, i: int) -> float:
    return float(part.angle[i] % (2.0 * math.pi))


def _least_load(contact: Part) -> int:
    """The sample of the least load while the cam lifts: a train with lash has none on the base circle."""
    return int(np.argmin(np.where(contact.lifted, contact["load"], np.inf)))


def _least_film(contact: Part) -> float:
    """Of a film below an atom nothing."""
    film = float(np.min(contact["minimum_film_thickness"]))
    return film if film >= ATOM else 0.0


def _film_feed(contact: Part) -> float:
    """Of the power that goes through the film, to and fro, the share that stays in the motion."""
    power = contact["load"] * contact["squeeze_velocity"]
    gross = contact.mean(np.abs(power))
    return contact.mean(power) / gross if gross > 0.0 else 0.0


def lost_share(contact: Part) -> float:
    """Of the cycle, while the cam lifts."""
    return contact.mean((contact["load"] <= 0.0) & contact.lifted)


def lost_on_nose(contact: Part) -> float:
    """Of the cycle: losses that begin where the cam slows the valve down (s'' < 0); nan for several cams.

    On the flanks, where s'' > 0, a contact is lost as it rebounds from the take-up of lash or play.
    """
    cams = _find_cams(contact.cycle)
    if len(cams) != 1:
        return math.nan
    lift = contact.cycle[f"{cams[0]}.cam_lift"]
    slows = np.gradient(np.gradient(lift, contact.angle), contact.angle) < 0.0
    lost = (contact["load"] <= 0.0) & contact.lifted
    begin = np.maximum.accumulate(np.where(lost & ~np.append(False, lost[:-1]), np.arange(lost.size), 0))
    return contact.mean(lost & slows[begin])


def _friction_power(part: Part) -> float:
    return part.mean(part["friction_force"] * part["sliding_velocity"])


def _friction_torque(part: Part) -> float:
    """The power over the mean speed of the cam."""
    return _friction_power(part) * part.cycle.times[-1] / float(part.angle[-1] - part.angle[0])


def _landing_lift(part: Part) -> float:
    """Lift of the one cam as the valve lands: a measure of the ramp that is left."""
    landing, cams = _landing(part), _find_cams(part.cycle)
    if landing is None or len(cams) != 1:
        return math.nan
    return float(part.cycle[f"{cams[0]}.cam_lift"][landing])


def _ramp_left(part: Part) -> float:
    """Lift of the one cam over the height of its ramp, as the valve lands: above 1 the ramp has not begun."""
    cams = _find_cams(part.cycle)
    if len(cams) != 1:
        return math.nan
    instance = part.cycle.system.instances[cams[0]]
    has_ramps = "ramp_height" in instance.component.parameters.names
    height = parameter_of(instance, "ramp_height") if has_ramps else 0.0
    return _landing_lift(part) / height if height > 0.0 else math.nan


CONTACT: Mapping[str, Number] = {
    "least_load": (
        Result("N", "least load while the cam lifts"),
        lambda c: float(c["load"][_least_load(c)]),
    ),
    "least_load_angle": (
        Result("rad", "cam angle of the least load", display_unit=DEGREES),
        lambda c: _at(c, _least_load(c)),
    ),
    "largest_load": (Result("N", "largest load"), lambda c: float(np.max(c["load"]))),
    "lost": (Result("1", "share of the cycle that lifts without load"), lost_share),
    "lost_on_nose": (
        Result("1", "share of the cycle in losses of contact that begin where the cam slows the valve"),
        lost_on_nose,
    ),
    "peak_pressure": (
        Result("Pa", "largest Hertz pressure", display_unit=MEGAPASCAL),
        lambda c: float(np.max(c["maximum_pressure"])),
    ),
    "stress_ratio": (
        Result("1", "largest Hertz pressure over the permissible one, elastic_limit"),
        lambda c: float(np.max(c["maximum_pressure"])) / c.parameter("elastic_limit"),
    ),
    "least_film": (
        Result("m", "least film thickness, of smooth surfaces; 0: no film", display_unit=MICROMETRES),
        _least_film,
    ),
    "least_film_ratio": (
        Result("1", "least film over roughness; the film bears the fluid's share of the load"),
        lambda c: float(np.min(c["film_ratio"])),
    ),
    "film_power": (
        Result("W", "mean power that the growing film gives to the motion"),
        lambda c: c.mean(c["load"] * c["squeeze_velocity"]),
    ),
    "film_feed": (Result("1", "share of the film's power that the motion keeps"), _film_feed),
    "friction_power": (Result("W", "mean friction power"), _friction_power),
    "friction_torque": (Result("N.m", "mean friction power over the speed of the cam"), _friction_torque),
}
VALVE: Mapping[str, Number] = {
    "largest_lift": (
        Result("m", "largest lift", display_unit=MILLIMETRES),
        lambda v: float(np.max(v["valve_lift"])),
    ),
    "lift_area": (
        Result("m", "lift, integrated over the cam angle in radians", display_unit="mm"),
        lambda v: float(np.trapezoid(v["valve_lift"], v.angle)),
    ),
    "seating_velocity": (Result("m/s", "velocity of landing"), _seating_velocity),
    "landing_lift": (
        Result("m", "lift of the one cam at landing", display_unit=MILLIMETRES),
        _landing_lift,
    ),
    "ramp_left": (Result("1", "lift of the cam over its ramp's height at landing"), _ramp_left),
    "bounce": (Result("m", "bounce after landing", display_unit=MICROMETRES), _bounce),
}
SPRING: Mapping[str, Number] = {
    "least_gap": (
        Result("m", "least gap between coils", display_unit=MILLIMETRES),
        lambda s: float(np.min(s["least_gap"])),
    ),
}
LOADED_SPRING: Mapping[str, Number] = {
    "spring_margin": (Result("1", "least load on the open valve over the spring's force"), _spring_margin),
    "surge_force": (Result("N", "largest force by surge"), _surge),
    **SPRING,
}
COIL_SPRING: Mapping[str, Number] = {
    **SPRING,
    "largest_clash_force": (
        Result("N", "largest force between coils that clash"),
        lambda s: float(np.max(s["clash_force"])),
    ),
}
DRIVE: Mapping[str, Number] = {
    "least_torque": (Result("N.m", "least torque"), lambda d: float(np.min(d["supplied_torque"]))),
    "largest_torque": (Result("N.m", "largest torque"), lambda d: float(np.max(d["supplied_torque"]))),
    "mean_torque": (Result("N.m", "mean torque"), lambda d: d.mean(d["supplied_torque"])),
}
SHAFT: Mapping[str, Number] = {
    "largest_twist": (Result("rad", "largest twist", display_unit=DEGREES), _twist),
}
ADJUSTER: Mapping[str, Number] = {
    "peak_pressure": (
        Result("Pa", "largest pressure of the chamber", display_unit=MEGAPASCAL),
        lambda a: float(np.max(a["pressure"])),
    ),
    "largest_extension": (
        Result("m", "largest length over that of the start", display_unit=MICROMETRES),
        lambda a: float(np.max(a["extension"])),
    ),
}
PIVOT: Mapping[str, Number] = {
    "friction_power": (Result("W", "mean friction power"), lambda p: p.mean(p["power_loss"])),
}
ROLLER: Mapping[str, Number] = {
    "largest_slip": (
        Result("m/s", "largest velocity by which the roller slides"),
        lambda r: float(np.max(np.abs(r["slip"]))),
    ),
    **PIVOT,
}
BEARING: Mapping[str, Number] = {
    "bearing_load": (Result("N", "largest load of the bearing"), lambda b: float(np.max(b["load"]))),
    **{name: CONTACT[name] for name in ("least_film", "least_film_ratio")},
    "largest_eccentricity": (
        Result("1", "largest eccentricity over the clearance"),
        lambda b: float(np.max(b["eccentricity_ratio"])),
    ),
    "peak_pressure": (
        Result("Pa", "highest pressure of the film", display_unit=MEGAPASCAL),
        lambda b: float(np.max(b["maximum_pressure"])),
    ),
    **PIVOT,
}
# By the role of the part.
TABLES: Mapping[type[roles.Role], Mapping[str, Number]] = {
    roles.Drive: DRIVE,
    roles.TwistedCam: SHAFT,
    roles.Valve: VALVE,
    roles.LoadedSpring: LOADED_SPRING,
    roles.CoilSpring: COIL_SPRING,
    roles.Adjuster: ADJUSTER,
    roles.Bearing: BEARING,
    roles.Pivot: PIVOT,
    roles.Roller: ROLLER,
    roles.Contact: CONTACT,
}


def _list_numbers(components: Mapping[str, Component]) -> Iterator[tuple[str, str, Number]]:
    """Part, name and number of all that these parts have, by their components."""
    for part, component in components.items():
        for role, table in TABLES.items():
            if component.has_role(role):
                for name, number in table.items():
                    yield part, name, number


def describe_numbers(scenario: Scenario) -> dict[str, Result]:
    """The results of every cycle of the scenario, by "part.number"."""
    components = {name: table.resolve() for name, table in scenario.components.items()}
    return {f"{part}.{name}": number[0] for part, name, number in _list_numbers(components)}


def measure(cycle: Cycle, angle: Vector) -> dict[str, float]:
    """The numbers of a cycle, whose samples are at these cam angles (rad)."""
    lifted = find_lifted(cycle)
    components = {name: instance.component for name, instance in cycle.system.instances.items()}
    return {
        f"{part}.{name}": measured(Part(cycle, part, angle, lifted))
        for part, name, (_, measured) in _list_numbers(components)
    }


def parameter_of(instance: Instance, name: str) -> float:
    """As given, or its default."""
    return instance.parameters.get(name, instance.component.parameters.field(name).start)


def find_lifted(cycle: Cycle) -> NDArray[np.bool_]:
    """Where the one cam lifts by a tenth of its lift; everywhere, if there are several or none."""
    cams = _find_cams(cycle)
    if len(cams) != 1:
        return np.ones(cycle.times.size, dtype=np.bool_)
    lift = cycle[f"{cams[0]}.cam_lift"]
    return np.asarray(lift > LIFTED * np.max(lift))


def _find_cams(cycle: Cycle) -> list[str]:
    """Instances with a cam."""
    return [name for name, i in cycle.system.instances.items() if i.component.has_role(roles.Cam)]


def is_separated(cycle: Cycle, angle: Vector, number: str = "lost") -> bool:
    """Whether a contact is lost while the cam lifts; `lost_on_nose`: where it slows the valve."""
    lifted, (_, share) = find_lifted(cycle), CONTACT[number]
    return any(share(Part(cycle, name, angle, lifted)) > 0.0 for name in list_contacts(cycle.system))


def list_contacts(system: System) -> list[str]:
    """The lubricated contacts."""
    return [name for name, instance in system.instances.items() if instance.component.has_role(roles.Contact)]
