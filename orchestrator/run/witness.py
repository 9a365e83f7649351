"""The witness of a run: the same valve train as rigid bodies with joints, solved with multipliers.

Components and reference share their equations, so that comparing them sees no error of the physics. The
witness shares none but the law of the contact and the lift of the cam.
"""

from __future__ import annotations

import time as clock
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from models.core.quantities import Vector
from models.core.system import System
from models.flywheel import PRESCRIBED
from models.monolithic.difference import difference, time_weights

from ..scenario import Scenario, ScenarioError

if TYPE_CHECKING:
    from models.monolithic import Reference

PARTS = ("flywheel", "camshaft", "valve_spring", "ehl_contact")
# Parameters that must be 0, and what they are.
ABSENT = {
    ("valve_spring", "seat_stiffness"): "seat",
    ("valve_spring", "clash_stiffness"): "clash of coils",
    ("ehl_contact", "load_is_given"): "given load",
}
# Inputs that must not be connected.
OPEN = {("camshaft", "friction_force"): "friction on the cam", ("valve_spring", "gas_force"): "gas pressure"}


@dataclass(frozen=True)
class Side:
    """Least and largest value in the coupled run, the reference and the multibody model.

    The differences are relative RMS, as those of the coupled run against the reference.
    """

    coupled: tuple[float, float]
    reference: tuple[float, float]
    multibody: tuple[float, float]
    coupled_difference: float
    reference_difference: float


@dataclass(frozen=True)
class Testimony:
    """What the witness says, by quantity; `drift` is the largest violation of a constraint (m or rad)."""

    method: str
    constraints: int
    freedoms: int
    drift: float
    wall_time_s: float
    quantities: Mapping[str, Side]


class Train(NamedTuple):
    """A direct-acting valve train in a system: instance and parameters of each part."""

    names: Mapping[str, str]
    parameters: Mapping[str, Any]

    def output(self, part: str, variable: str) -> str:
        return f"{self.names[part]}.{variable}"


def check_witness(scenario: Scenario, system: System) -> None:
    """Raise ScenarioError if a witness is asked for that does not know this system."""
    if scenario.reference.witness == "none":
        return
    if not scenario.reference.enabled:
        _refuse("it stands beside the reference; set reference.enabled = true")
    if scenario.start != "equilibrium":
        _refuse("it begins at rest; set start = 'equilibrium'")
    train = _find_train(system)
    drive = train.parameters["flywheel"]
    if drive.motion != PRESCRIBED or drive.initial_speed != drive.final_speed:
        _refuse("its drive turns at constant speed; set motion = 'prescribed' without a ramp")
    for (part, parameter), what in ABSENT.items():
        if getattr(train.parameters[part], parameter) != 0.0:
            name = train.output(part, parameter)
            _refuse(f"it knows no {what}; set {name} to 0, or leave the witness out")
    driven = {str(connection.target) for connection in system.connections}
    for (part, variable), what in OPEN.items():
        if (name := train.output(part, variable)) in driven:
            _refuse(f"it knows no {what}; leave out the connection to {name}, or the witness")


def _refuse(reason: str) -> None:
    raise ScenarioError(f"reference.witness = 'multibody': {reason}")


def _find_train(system: System) -> Train:
    kinds = [instance.component.name for instance in system.instances.values()]
    if sorted(kinds) != sorted(PARTS):
        _refuse(
            f"it knows one {', one '.join(PARTS)}, and no more; this scenario has {', '.join(kinds)}. Take "
            "valve-train or one that extends it, or leave the witness out"
        )
    names = {instance.component.name: name for name, instance in system.instances.items()}
    parameters = {
        kind: system.instances[name].component.parameters.view(system.p[system.parameters.of(name)])
        for kind, name in names.items()
    }
    return Train(names, parameters)


def hear_witness(system: System, reference: Reference, coupled: Mapping[str, Vector]) -> Testimony:
    """Solve the train of `system` as bodies with joints, at the instants of both, and compare."""
    from models.multibody.direct_train import CONTACT, DRIVE, GUIDE
    from models.multibody.ida import solve_ida

    begun = clock.perf_counter()
    train = _find_train(system)
    motion = solve_ida(
        _build_mechanism(train, system), np.append(0.0, reference.times[reference.times > 0.0])
    )
    first = motion.times.size - reference.times.size
    ratio, base = train.parameters["camshaft"].drive_ratio, float(train.parameters["camshaft"].base_radius)
    found = {
        train.output("ehl_contact", "load"): motion.load(CONTACT),
        train.output("ehl_contact", "film_thickness"): motion.film_thickness(CONTACT),
        train.output("camshaft", "drive_torque"): ratio * motion.multiplier(DRIVE)[:, 0],
        train.output("valve_spring", "position"): motion.position("follower")[:, 1] - base,
        "guide moment": -motion.reaction(GUIDE).moment[:, 2],
    }
    load, offset = train.output("ehl_contact", "load"), train.output("camshaft", "contact_offset")
    weights = time_weights(reference.times)
    sides = {}
    for name, values in found.items():
        if name == "guide moment":
            wanted, given = reference[load] * reference[offset], coupled[load] * reference[offset]
        else:
            wanted, given = reference[name], coupled[name]
        sides[name] = _compare_sides(given, wanted, values[first:], weights)
    return Testimony(
        method=motion.method,
        constraints=len(motion.mechanism.constraint_names),
        freedoms=motion.mechanism.freedoms,
        drift=motion.drift.position,
        wall_time_s=clock.perf_counter() - begun,
        quantities=sides,
    )


def _compare_sides(coupled: Vector, reference: Vector, multibody: Vector, weights: Vector) -> Side:
    def span(values: Vector) -> tuple[float, float]:
        return float(np.min(values)), float(np.max(values))

    return Side(
        coupled=span(coupled),
        reference=span(reference),
        multibody=span(multibody),
        coupled_difference=difference(coupled, multibody, weights=weights).relative_rms,
        reference_difference=difference(reference, multibody, weights=weights).relative_rms,
    )


def _build_mechanism(train: Train, system: System) -> Any:
    """The train with its parts where the system's start has them."""
    from models.multibody.direct_train import TrainStart, direct_train
    from models.valve_train.cams.law import LAW
    from models.valve_train.cams.table import TABLE

    states = {
        kind: system.instances[name].component.state.view(system.x0[system.state.of(name)])
        for kind, name in train.names.items()
    }
    shaft, spring = states["camshaft"], states["valve_spring"]
    camshaft = train.parameters["camshaft"]
    instances = {kind: system.instances[name] for kind, name in train.names.items()}
    start = TrainStart(
        angle=float(camshaft.drive_ratio * states["flywheel"].angle),
        position=float(spring.position),
        coil_positions=tuple(map(float, spring.coil_position)),
        film=float(states["ehl_contact"].film_thickness),
        twist=float(shaft.twist),
        bending=float(shaft.bending),
        slope=float(shaft.slope),
    )
    return direct_train(
        camshaft,
        train.parameters["valve_spring"],
        float(camshaft.drive_ratio * train.parameters["flywheel"].initial_speed),
        coil_masses=instances["valve_spring"].component.structure["coil_masses"],
        lubricant=train.parameters["ehl_contact"],
        profile=TABLE if instances["camshaft"].component.structure["table_points"] else LAW,
        start=start,
    )
