"""How the figures of merit of a steady cycle, or of a run, change with parameters, from tangents.

A figure is a function of the rows of a motion, and its change that of this function along the rows' tangents.
Rows stand at equal distances, on both sides of every event, and close together where figures stand: an
extreme changes as the value at its instant does.
"""

import math
from collections.abc import Container, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from models.core.quantities import Vector
from models.core.system import ModelError, System
from models.monolithic.cycle_tangents import (
    CycleTangents,
    Direction,
    Rows,
    differentiate_cycle,
    differentiate_run,
)

from ...assessment.figures_of_merit import measure
from ...assessment.motion import Motion
from ...reporter import show_share
from ...scenario.system import build_system, resolve_start
from .subject import SAMPLES, SpeedSubject, find_angle

SPEED = "speed"
# Rows around a figure's in each of so many turns, over the distance of the last one's.
NEAR, TURNS = 20, 3
# Of a parameter: by this much rows are moved along their tangents.
SHARE = 1e-6
# Of a parameter: differences of the state in which a run begins.
START_SHARE = 1e-4


# The value, and the row at which it stands.
Figure = tuple[float, int | None]


class FigureSlopes(NamedTuple):
    """A figure's value, its changes in each direction, the mean of both sides, and by how much more the
    change above is than that below."""

    value: float
    slopes: Vector
    corners: Vector


def find_slopes(
    subject: SpeedSubject, speed: float, parameters: Sequence[Mapping[str, float]]
) -> dict[str, FigureSlopes]:
    """Of the cycle at a speed (rad/s), in directions: changes of parameters "component.name", in their units,
    or of the `SPEED` (rad/s). ModelError where the cycle has no tangents, or there is none."""
    show_share(0.0, ", the cycle")
    cycle, flywheel = subject.find_cycle_at(speed), subject.flywheel
    period = float(cycle.times[-1])
    if not cycle.steady:
        raise ModelError(f"no steady cycle: a period changes states by {cycle.change:.2g} of their sizes")
    directions = [
        Direction(_spread(cycle.system, flywheel, changes), -period * changes.get(SPEED, 0.0) / speed)
        for changes in parameters
    ]
    turning = [f"{flywheel}.angle"]
    tangents = differentiate_cycle(
        cycle.system, period, turning, directions, cycle.end,
        progress=lambda share: show_share(share, ", its tangents"),
    )  # fmt: skip
    return differentiate_figures(tangents, flywheel)


def find_run_slopes(
    subject: SpeedSubject, parameters: Sequence[Mapping[str, float]]
) -> dict[str, FigureSlopes]:
    """Of the scenario's run, from its start to the angle of its end. Directions are as in `find_slopes`; the
    `SPEED` is the larger one at both ends of a run-up. ModelError where the motion has no tangents."""
    scenario, flywheel, system = subject.scenario, subject.flywheel, build_system(subject.scenario)
    directions = [Direction(_spread(system, flywheel, changes)) for changes in parameters]

    begun = resolve_start(scenario, system)

    def find_start(direction: Direction, share: float) -> tuple[float, Vector]:
        try:
            return share, resolve_start(scenario, _change(system, direction, share)).x0
        except ModelError:  # beyond the edge of a range
            return 0.0, begun.x0

    sides = [(find_start(one, -START_SHARE), find_start(one, START_SHARE)) for one in directions]
    moved = np.column_stack([(x - y) / (right - left) for (left, y), (right, x) in sides])
    tangents = differentiate_run(
        begun, scenario.stop_time, f"{flywheel}.angle", directions, moved,
        progress=lambda share: show_share(share, ", its tangents"),
    )  # fmt: skip
    fastest = max(map(abs, _find_ends(system, flywheel).values()))
    turns = math.ceil(scenario.stop_time * fastest / (2.0 * math.pi))
    return differentiate_figures(tangents, flywheel, max(1, turns))


def _find_ends(system: System, flywheel: str) -> dict[str, float]:
    """The speeds (rad/s) of the drive before and after a run-up."""
    names = (f"{flywheel}.initial_speed", f"{flywheel}.final_speed")
    return {name: float(system.p[system.parameters.names.index(name)]) for name in names}


def _spread(system: System, flywheel: str, changes: Mapping[str, float]) -> dict[str, float]:
    """Changes of parameters; that of the `SPEED` is one of both ends of a run-up by the same share."""
    found, ends = dict(changes), _find_ends(system, flywheel)
    if faster := found.pop(SPEED, 0.0):
        found |= {name: faster * value / max(ends.values(), key=abs) for name, value in ends.items()}
    return found


def differentiate_figures(
    tangents: CycleTangents, flywheel: str, turns: int = 1, samples: int = 0,
    names: Container[str] | None = None,
) -> dict[str, FigureSlopes]:  # fmt: skip
    """Of all figures by "part.figure", or those of `names`, but angles and those that a motion of so many
    turns has not; from so many rows in a turn (0: SAMPLES)."""
    rows = tangents.rows_at(_find_times(tangents, flywheel, turns * (samples or SAMPLES), names))
    values = _measure(_move(tangents, rows, 0, 0.0, flywheel), names)
    count = len(tangents.directions)
    sides = []
    for k in range(count):
        if names is None:
            show_share(k / count, ", figures")
        sides.append(_measure_sides(tangents, rows, k, flywheel, values, names))
    found = {}
    for name, (value, _) in values.items():
        below, above = (np.array([side[sign][name] for side in sides]) for sign in (-1.0, 1.0))
        slopes, corners = (above - below) / (2.0 * SHARE), (above - 2.0 * value + below) / SHARE
        if np.isfinite(value) and not name.endswith("_angle"):
            found[name] = FigureSlopes(value, slopes, corners)
    return found


def _find_times(tangents: CycleTangents, flywheel: str, samples: int, names: Container[str] | None) -> Vector:
    """Where the rows stand."""
    begin, end, events = tangents.begin, tangents.begin + tangents.period, tangents.event_times()
    times = np.union1d(np.linspace(begin, end, samples + 1), events)
    distance = tangents.period / samples
    for _ in range(TURNS):
        inputs, outputs = tangents.values_at(times)
        motion = _build_motion(tangents.system, times, inputs, outputs, flywheel)
        found = _measure(motion, names).values()
        stand = {row for _, row in found if row is not None and times[row] not in events}
        near = distance / NEAR * np.arange(-NEAR, NEAR + 1)
        added = (times[sorted(stand)][:, None] + near).ravel()
        times = np.union1d(times, added[(added > begin) & (added < end)])
        distance /= NEAR
    return times


def _move(tangents: CycleTangents, rows: Rows, direction: int, share: float, flywheel: str) -> Motion:
    def moved(values: Vector, by: Vector) -> Vector:
        return values if share == 0.0 else values + share * by[direction]

    return _build_motion(
        _change(tangents.system, tangents.directions[direction], share) if share else tangents.system,
        moved(rows.times, rows.times_by),
        moved(rows.inputs, rows.inputs_by),
        moved(rows.outputs, rows.outputs_by),
        flywheel,
    )


def _measure_sides(
    tangents: CycleTangents, rows: Rows, direction: int, flywheel: str, values: Mapping[str, Figure],
    names: Container[str] | None,
) -> dict[float, dict[str, float]]:  # fmt: skip
    """The figures below (-1) and above (1). Where a parameter is at the edge of its range, the other side is
    that of a straight line through the `values`."""
    found: dict[float, dict[str, float]] = {}
    for sign in (-1.0, 1.0):
        try:
            beside = _measure(_move(tangents, rows, direction, sign * SHARE, flywheel), names)
            found[sign] = {name: value for name, (value, _) in beside.items()}
        except ModelError:
            if sign > 0.0 and not found:
                raise
    for sign in {-1.0, 1.0} - set(found):
        found[sign] = {name: 2.0 * value - found[-sign][name] for name, (value, _) in values.items()}
    return found


def _change(system: System, direction: Direction, share: float) -> System:
    """The system with this share of a change of its parameters."""
    instances = dict(system.instances)
    for place, size in direction.parameters.items():
        name, _, parameter = place.partition(".")
        value = float(system.p[system.parameters.names.index(place)]) + share * size
        one = instances[name]
        instances[name] = replace(one, parameters={**one.parameters, parameter: value})
    return system.with_instances(instances)


def _build_motion(system: System, times: Vector, inputs: Vector, outputs: Vector, flywheel: str) -> Motion:
    columns: Mapping[str, Vector] = {
        **dict(zip(system.inputs.names, inputs.T, strict=True)),
        **dict(zip(system.outputs.names, outputs.T, strict=True)),
    }
    return Motion(system, times, columns.__getitem__, find_angle(system, flywheel))


def _measure(motion: Motion, names: Container[str] | None = None) -> dict[str, Figure]:
    found = measure(motion, names)
    return {f"{part}.{name}": (one.value, one.row) for part, name, _, one in found}
