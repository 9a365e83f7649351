"""What an engineer asks first of each train of a run: does it follow its cam, how does its valve land, do
coils clash, what do its contacts bear and lose."""

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from models.core import roles
from models.core.quantities import Vector
from models.core.system import Port, System

from .trains import Train, find_trains

# Columns of the coupled run, by "instance.variable", and "time".
Read = Callable[[Sequence[str]], Mapping[str, Vector]]
# Of the largest lift: above it a cam lifts, and a valve is open on purpose.
LIFTED = 0.1
# A valve that leaves its seat again within this angle (rad) after landing bounces.
AFTER = np.pi / 3.0
# So many trains are told one by one: of more those whose margin is least.
SHOWN = 4


def list_merits(system: System, read: Read) -> list[str]:
    """A line for each train, of the recorded rows."""
    told = [
        (margin, f"{train.valve}: {text}")
        for train in find_trains(system)
        for margin, text in _judge(train, read)
    ]
    if len(told) <= SHOWN:
        return [text for _, text in told]
    least = sorted(told)[:SHOWN]
    return [*(text for _, text in least), f"{len(told) - SHOWN} more trains with larger margins"]


def _judge(train: Train, read: Read) -> Iterator[tuple[float, str]]:
    """The share of the load that is left where it is least, and the line."""
    columns = _Columns(train, read)
    lift = columns.of(train.cam, "cam_lift")
    if lift is None or not np.max(lift) > 0.0:
        return
    lifted = lift > LIFTED * np.max(lift)
    followed = _follow(train, columns, lifted)
    said = [followed[1]] if followed else []
    said += [*_list_landing(train, columns), *_list_clash(train, columns), *_list_contacts(train, columns)]
    if said:
        yield followed[0] if followed else 0.0, "; ".join(said)


class _Columns:
    """Rows of the train's outputs, and of what drives its inputs."""

    def __init__(self, train: Train, read: Read) -> None:
        self.system, self.read = train.system, read
        self.sources = {c.target: c.source for c in self.system.connections}

    def of(self, part: str, variable: str) -> Vector | None:
        port = Port(part, variable)
        port = self.sources.get(port, port)
        if port.variable not in self.system.instances[port.instance].component.outputs:
            return None
        return self.read([str(port)])[str(port)]

    @property
    def time(self) -> Vector:
        return self.read(["time"])["time"]


def _mean(values: Vector | NDArray[np.bool_], time: Vector) -> float:
    return float(np.trapezoid(np.asarray(values, dtype=np.float64), time) / (time[-1] - time[0]))


def _follow(train: Train, columns: _Columns, lifted: NDArray[np.bool_]) -> tuple[float, str] | None:
    """Whether the cam is followed while it lifts: the least load on the valve over its springs' force."""
    on_cam = [columns.of(name, "load") for name in train.contacts[:1]]
    if not on_cam or on_cam[0] is None:
        return None
    lost = _mean((on_cam[0] <= 0.0) & lifted, columns.time) / max(_mean(lifted, columns.time), 1e-300)
    known = columns.system.instances[train.valve].component
    named = [name for name in (*known.outputs.names, *known.inputs.names) if name.startswith("spring_force")]
    springs = [columns.of(train.valve, name) for name in named]
    load = columns.of(train.valve, "load")
    forces = [force for force in springs if force is not None]
    if lost > 0.0:
        return -lost, f"contact is lost for {100.0 * lost:.2g} % of the lift"
    if forces and load is not None:
        left = float(np.min(load[lifted] / np.sum(forces, axis=0)[lifted]))
        text = (
            f"separation margin {100.0 * left:.3g} % (least load on the open valve over its spring's force)"
        )
        return left, text
    least = float(np.min(on_cam[0][lifted]))
    return least, f"least load {least:.4g} N while the cam lifts"


def _list_landing(train: Train, columns: _Columns) -> Iterator[str]:
    """Seating velocity and bounce of each valve that lands on a seat."""
    angle = columns.of(train.cam, train.role.angle)
    for valve in train.list_parts(roles.Valve):
        dip, velocity = (columns.of(valve, name) for name in ("seat_dip", "velocity"))
        if angle is not None and dip is not None and velocity is not None and np.max(dip) >= 0.0:
            yield from _describe_landing(angle, dip, velocity)


def _describe_landing(angle: Vector, dip: Vector, velocity: Vector) -> Iterator[str]:
    opened = np.concatenate([[False], dip < 0.0, [False]])
    edges = np.flatnonzero(opened[1:] != opened[:-1])
    flights = [(i, j, float(-np.min(dip[i:j]))) for i, j in zip(edges[::2], edges[1::2], strict=True)]
    high = LIFTED * max((height for _, _, height in flights), default=0.0)
    landed = [j for _, j, height in flights if height > high and j < dip.size]
    if not landed:
        return
    bounces = [
        height
        for i, _, height in flights
        for j in landed
        if height <= high and i >= j and angle[i] - angle[j] < AFTER
    ]
    yield f"seats with {max(-velocity[j] for j in landed):.3g} m/s"
    yield f"bounces by {1e6 * max(bounces):.3g} µm" if bounces else "does not bounce"


def _list_clash(train: Train, columns: _Columns) -> Iterator[str]:
    """Whether coils clash, and the least gap between coils that do not."""
    gaps = []
    for name in (*train.list_parts(roles.CoilSpring), *train.list_parts(roles.LoadedSpring)):
        gap, force = columns.of(name, "least_gap"), columns.of(name, "clash_force")
        if gap is None or np.ptp(gap) == 0.0:
            continue
        gaps.append(float(np.min(gap)))
        if force is not None and np.max(force) > 0.0:
            yield f"coils of {name} clash with up to {np.max(force):.3g} N"
        elif gaps[-1] <= 0.0:
            yield f"coils of {name} clash"
    if gaps and min(gaps) > 0.0:
        yield f"no clash of coils, least gap {1e3 * min(gaps):.3g} mm"


def _list_contacts(train: Train, columns: _Columns) -> Iterator[str]:
    """Highest pressure, least film ratio, and the mean power of friction."""
    pressures, ratios, power = [], [], 0.0
    for name in train.contacts:
        pressure, ratio, friction, sliding = (
            columns.of(name, one)
            for one in ("maximum_pressure", "film_ratio", "friction_force", "sliding_velocity")
        )
        if pressure is not None and ratio is not None:
            pressures.append((float(np.max(pressure)), name))
            ratios.append((float(np.min(ratio)), name))
        if friction is not None and sliding is not None:
            power += _mean(friction * sliding, columns.time)
    for name in (*train.list_parts(roles.Pivot), *train.list_parts(roles.Roller)):
        if (lost := columns.of(name, "power_loss")) is not None:
            power += _mean(lost, columns.time)
    if pressures:
        yield f"highest pressure {1e-6 * max(pressures)[0]:.4g} MPa in {max(pressures)[1]}"
        if min(ratios)[0] > 0.0:
            yield f"least film ratio {min(ratios)[0]:.2g} in {min(ratios)[1]}"
        yield f"friction {power:.3g} W"
