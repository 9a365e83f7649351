"""What an engineer asks of a motion, a run's records or a steady cycle, by the roles of its parts.

To add a figure: a row in the table of its role.
"""

import math
from collections.abc import Callable, Container, Iterator, Mapping

import numpy as np

from models.contact.records import ATOM
from models.core import roles
from models.core.component import Component
from models.core.quantities import Quantity

from .adjusters import ADJUSTER
from .grooves import find_load_from_groove
from .motion import NONE, Figure, Found, Motion, Part, find_largest, find_least
from .springs import COIL_SPRING, LOADED_SPRING
from .trains import LIFTED

# Of the largest lift: above it a valve is open.
OPENED = 0.05
# A valve that leaves its seat again within this angle (rad) after landing bounces.
AFTER = math.pi / 3.0


PRESSURE = Quantity("Pa", display_unit="MPa")
SHARE = Quantity("1", display_unit="%")
ANGLE = Quantity("rad", display_unit="deg")


def _mean(variable: str) -> Callable[[Part], Found]:
    return lambda part: Found(part.mean(part[variable]))


def _mean_power(force: str, velocity: str) -> Callable[[Part], Found]:
    return lambda part: Found(part.mean(part[force] * part[velocity]))


def _list_flights(valve: Part) -> list[tuple[int, int, bool]]:
    """First row off the seat, next row on it, and whether the cam opened the valve; none without a seat."""
    if valve.parameter("seat_stiffness") == 0.0:
        return []
    dip = valve["seat_dip"]
    opened = np.concatenate([[False], dip < 0.0, [False]])
    edges = np.flatnonzero(opened[1:] != opened[:-1])
    high = LIFTED * -float(np.min(dip))
    # The flight in which the rows begin has been higher.
    return [
        (int(i), int(j), i == 0 or float(-np.min(dip[i:j])) > high)
        for i, j in zip(edges[::2], edges[1::2], strict=True)
    ]


def find_landings(valve: Part) -> list[int]:
    """The last row off the seat of each flight from the cam's lift."""
    return [j - 1 for _, j, lifted in _list_flights(valve) if lifted and j < valve.motion.times.size]


def _find_hardest(valve: Part) -> int | None:
    return max(find_landings(valve), key=lambda row: -valve["velocity"][row], default=None)


def _seating_velocity(valve: Part) -> Found:
    """As it enters the seat, of the hardest landing."""
    landing = _find_hardest(valve)
    return NONE if landing is None else Found(-float(valve["velocity"][landing]), landing)


def _bounce(valve: Part) -> Found:
    """How far the valve leaves its seat again after a landing."""
    landings, found = find_landings(valve), [Found(0.0)]
    for i, j, _ in _list_flights(valve):
        if any(i > row and abs(valve.angle[i] - valve.angle[row]) < AFTER for row in landings):
            row = i + int(np.argmin(valve["seat_dip"][i:j]))
            found.append(Found(-float(valve["seat_dip"][row]), row))
    return max(found, key=lambda bounce: bounce.value) if landings else NONE


def _spring_margin(valve: Part) -> Found:
    """Least load that opens the valve over the force of its springs, while it is off its seat.

    None in rows where the cam lifts by less than half: the take-up of lash is no margin. Where they end
    before the nose, the valve's largest lift is foreseen in the ratio of the cam's.
    """
    largest = valve.train.largest_lift if valve.train else 0.0
    reached = largest if valve.cam_lift is None else float(np.max(valve.cam_lift))
    if reached < 0.5 * largest:
        return NONE
    foreseen = np.max(valve["position"]) * (largest / reached if largest > reached else 1.0)
    names = [*valve.component.outputs.names, *valve.component.inputs.names]
    forces = [valve[name] for name in names if name.startswith("spring_force")]
    pressed = np.sum(forces, axis=0) if forces else np.zeros_like(valve["load"])
    opened = (valve["position"] > OPENED * foreseen) & (pressed > 0.0)
    if valve.parameter("seat_stiffness") > 0.0:
        opened &= valve["seat_dip"] < 0.0
    if not opened.any():
        return NONE
    share = np.full(opened.size, np.inf)
    share[opened] = valve["load"][opened] / pressed[opened]
    return Found.at(share, np.argmin(share))


def _least_lift(valve: Part) -> Found:
    """In the last whole turn, 0 of a valve that closes; none of less, and of a valve without a seat."""
    turn = valve.last_turn
    if turn is None or valve.parameter("seat_stiffness") == 0.0:
        return NONE
    return Found(max(0.0, -float(np.max(turn["seat_dip"]))))


def _lift_area(valve: Part) -> Found:
    """Of a turn, where the seat's compression counts as negative lift."""
    return Found(valve.integrate(valve["valve_lift"], valve.turned) / max(1, valve.motion.turns))


def _twist(shaft: Part) -> Found:
    driven = shaft.parameter("drive_ratio") * shaft["drive_angle"] + shaft.parameter("phase")
    return Found.largest(np.abs(shaft["cam_angle"] - driven))


def _least_load(contact: Part) -> Found:
    """While the cam lifts: a train with lash has none on the base circle."""
    if not contact.lifted.any():
        return NONE
    return Found.at(contact["load"], np.argmin(np.where(contact.lifted, contact["load"], np.inf)))


def _angle_of(find: Callable[[Part], Found]) -> Callable[[Part], Found]:
    """Of the cam, in its turn, where a figure stands."""

    def at(contact: Part) -> Found:
        row = find(contact).row
        return NONE if row is None else Found(float(contact.angle[row] % (2.0 * math.pi)), row)

    return at


def _least_film(contact: Part) -> Found:
    """Of a film below an atom nothing."""
    film = find_least("minimum_film_thickness")(contact)
    return film if film.value >= ATOM else Found(0.0, film.row)


def _at_nose(variable: str) -> Callable[[Part], Found]:
    """At the cam's greatest lift, under load."""

    def find(contact: Part) -> Found:
        row = contact.nose
        return Found.at(contact[variable], row) if row is not None and contact["load"][row] > 0.0 else NONE

    return find


def _film_feed(contact: Part) -> Found:
    """Of the power that goes through the film, to and fro, the share that stays in the motion."""
    power = contact["load"] * contact["squeeze_velocity"]
    gross = contact.mean(np.abs(power))
    return Found(contact.mean(power) / gross if gross > 0.0 else 0.0)


def _lost_on_nose(contact: Part) -> Found:
    """Losses that begin where the cam slows the valve down (s'' < 0); none without a cam of its own.

    On the flanks, where s'' > 0, a contact is lost as it rebounds from the take-up of lash or play.
    """
    if contact.cam_lift is None:
        return NONE
    lost = contact.lost
    with np.errstate(divide="ignore", invalid="ignore"):  # rows of step control may have one angle
        slows = np.gradient(np.gradient(contact.cam_lift, contact.angle), contact.angle) < 0.0
    begin = np.maximum.accumulate(np.where(lost & ~np.append(False, lost[:-1]), np.arange(lost.size), 0))
    return Found(contact.mean(lost & slows[begin]))


_friction_power = _mean_power("friction_force", "sliding_velocity")


def _friction_torque(part: Part) -> Found:
    """The power over the mean speed of the cam."""
    turned = part.integrate(np.ones(part.motion.times.size), part.angle)
    work = part.integrate(part["friction_force"] * part["sliding_velocity"], part.motion.times)
    return Found(work / turned) if turned else NONE


def _landing_lift(valve: Part) -> Found:
    """Lift of the cam as the valve lands: a measure of the ramp that is left. None of a valve that has left
    its cam, so that it lands when the cam has passed the lash."""
    landing = _find_hardest(valve)
    if landing is None or valve.train is None or valve.cam_lift is None:
        return NONE
    lift = Found.at(valve.cam_lift, landing)
    return lift if lift.value > valve.train.lash else NONE


def _ramp_left(valve: Part) -> Found:
    """Lift of the cam over the height of its ramp, as the valve lands: above 1 the ramp has not begun."""
    height, lift = valve.train.closing_ramp if valve.train else 0.0, _landing_lift(valve)
    return Found(lift.value / height, lift.row) if height > 0.0 else NONE


def _least_clearance_angle(watched: Part) -> Found:
    """Of the crank, from the top dead centre."""
    row = find_least("clearance")(watched).row
    angle = watched.parameter("angle_ratio") * (watched["angle"][row] - watched.parameter("top_angle"))
    return Found(math.remainder(float(angle), 2.0 * math.pi), row)


def _least_radial_clearance(watched: Part) -> Found:
    """While the head is in the pocket."""
    inside = watched["clearance"] < watched.parameter("pocket_depth")
    away = np.where(inside, watched["radial_clearance"], np.inf)
    return Found.at(away, np.argmin(away)) if inside.any() else NONE


CONTACT: Mapping[str, Figure] = {
    "least_load": (Quantity("N", "least load while the cam lifts"), _least_load),
    "least_load_angle": (ANGLE.of("cam angle of the least load"), _angle_of(_least_load)),
    "largest_load": (Quantity("N", "largest load"), find_largest("load")),
    "lost": (SHARE.of("share of the time in which contact is lost"), lambda c: Found(c.mean(c.lost))),
    "lost_on_nose": (
        SHARE.of("share of the time in which contact is lost from where the cam slows the valve"),
        _lost_on_nose,
    ),
    "peak_pressure": (PRESSURE.of("largest Hertz pressure"), find_largest("maximum_pressure")),
    "peak_pressure_angle": (
        ANGLE.of("cam angle of the largest Hertz pressure"),
        _angle_of(find_largest("maximum_pressure")),
    ),
    "stress_ratio": (
        Quantity("1", "largest Hertz pressure over the permissible one, elastic_limit"),
        lambda c: Found(float(np.max(c["maximum_pressure"])) / c.parameter("elastic_limit")),
    ),
    "least_film": (
        Quantity("m", "least film thickness, of smooth surfaces; 0: no film", display_unit="um"),
        _least_film,
    ),
    "least_film_ratio": (
        Quantity("1", "least film over roughness; the film bears the fluid's share of the load"),
        find_least("film_ratio"),
    ),
    "least_film_ratio_angle": (
        ANGLE.of("cam angle of the least film over roughness"),
        _angle_of(find_least("film_ratio")),
    ),
    "nose_pressure": (PRESSURE.of("Hertz pressure at the nose"), _at_nose("maximum_pressure")),
    "nose_film": (
        Quantity("m", "film thickness at the nose", display_unit="um"),
        _at_nose("minimum_film_thickness"),
    ),
    "nose_film_ratio": (Quantity("1", "film over roughness at the nose"), _at_nose("film_ratio")),
    "film_power": (
        Quantity("W", "mean power that the growing film gives to the motion"),
        _mean_power("load", "squeeze_velocity"),
    ),
    "film_feed": (
        SHARE.of("net over gross power of the squeezed film; above 0 it feeds vibrations"),
        _film_feed,
    ),
    "friction_power": (Quantity("W", "mean friction power"), _friction_power),
    "friction_torque": (Quantity("N.m", "mean friction power over the speed of the cam"), _friction_torque),
}
VALVE: Mapping[str, Figure] = {
    "largest_lift": (Quantity("m", "largest lift", display_unit="mm"), find_largest("valve_lift")),
    "lift_area": (
        Quantity("m", "lift over the cam angle in radians, less the seat's compression", display_unit="mm"),
        _lift_area,
    ),
    "least_lift": (
        Quantity("m", "lift left where the valve should be closed; 0: it closes", display_unit="mm"),
        _least_lift,
    ),
    "spring_margin": (
        SHARE.of("spring margin: least load on the open valve over the force of its springs"),
        _spring_margin,
    ),
    "seating_velocity": (Quantity("m/s", "seating velocity"), _seating_velocity),
    "landing_lift": (Quantity("m", "lift of the cam at landing", display_unit="mm"), _landing_lift),
    "ramp_left": (Quantity("1", "lift of the cam over its ramp's height at landing"), _ramp_left),
    "bounce": (Quantity("m", "bounce after landing", display_unit="um"), _bounce),
    "largest_seat_force": (Quantity("N", "largest seat force"), find_largest("seat_force")),
}
DRIVE: Mapping[str, Figure] = {
    "least_torque": (Quantity("N.m", "least torque"), find_least("supplied_torque")),
    "largest_torque": (Quantity("N.m", "largest torque"), find_largest("supplied_torque")),
    "mean_torque": (Quantity("N.m", "mean torque"), _mean("supplied_torque")),
}
SHAFT: Mapping[str, Figure] = {"largest_twist": (ANGLE.of("largest twist"), _twist)}
ROLLING: Mapping[str, Figure] = {
    "rolling_power": (
        Quantity("W", "mean power of the rolling friction"),
        lambda c: Found(c.mean(c["rolling_friction"] * 2.0 * c["entraining_velocity"])),
    )
}
CLEARANCE: Mapping[str, Figure] = {
    "least_clearance": (
        Quantity("m", "least clearance between valve and piston", display_unit="mm"),
        find_least("clearance"),
    ),
    "least_clearance_angle": (
        ANGLE.of("crank angle of the least clearance, from top dead centre"),
        _least_clearance_angle,
    ),
    "least_radial_clearance": (
        Quantity("m", "least clearance to the wall of the valve's pocket", display_unit="mm"),
        _least_radial_clearance,
    ),
}
LOSS: Mapping[str, Figure] = {"friction_power": (Quantity("W", "mean friction power"), _mean("power_loss"))}
ROLLER: Mapping[str, Figure] = {
    "largest_slip": (
        Quantity("m/s", "largest velocity by which the roller slides"),
        lambda roller: Found.largest(np.abs(roller["slip"])),
    )
}
BEARING: Mapping[str, Figure] = {
    "bearing_load": (Quantity("N", "largest load of the bearing"), find_largest("load")),
    **{name: CONTACT[name] for name in ("least_film", "least_film_ratio")},
    "largest_eccentricity": (
        Quantity("1", "largest eccentricity over the clearance"),
        find_largest("eccentricity_ratio"),
    ),
    "peak_pressure": (PRESSURE.of("highest pressure of the film"), find_largest("maximum_pressure")),
    "load_from_groove": (
        ANGLE.of("from the nearest groove's middle to the load at the least film"),
        find_load_from_groove,
    ),
    **LOSS,
}
# By the role of the part.
TABLES: Mapping[type[roles.Role], Mapping[str, Figure]] = {
    roles.Drive: DRIVE,
    roles.TwistedCam: SHAFT,
    roles.Valve: VALVE,
    roles.LoadedSpring: LOADED_SPRING,
    roles.CoilSpring: COIL_SPRING,
    roles.Adjuster: ADJUSTER,
    roles.Bearing: BEARING,
    roles.Pivot: LOSS,
    roles.Guide: LOSS,
    roles.Roller: ROLLER,
    roles.Surface: LOSS,
    roles.PistonClearance: CLEARANCE,
    roles.Contact: CONTACT,
    roles.RollingContact: ROLLING,
}


def list_figures(components: Mapping[str, Component]) -> Iterator[tuple[str, str, Figure]]:
    """Part, name and definition of all that these parts have, by their components."""
    for part, component in components.items():
        for role, table in TABLES.items():
            if component.has_role(role):
                for name, figure in table.items():
                    yield part, name, figure


def measure(
    motion: Motion, names: Container[str] | None = None
) -> Iterator[tuple[str, str, Quantity, Found]]:
    """Part, name, quantity and value of all figures of the motion, or of those of `names`, "part.figure"."""
    part = Part(motion, "")
    components = {name: instance.component for name, instance in motion.system.instances.items()}
    for name, figure, (quantity, find) in list_figures(components):
        if names is not None and f"{name}.{figure}" not in names:
            continue
        part = part if part.name == name else Part(motion, name)
        yield name, figure, quantity, find(part)
