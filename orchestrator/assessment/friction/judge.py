"""Friction and wear of a run's contacts over a cam revolution, from its output folder."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from models.core.quantities import Vector
from models.core.roles import Cam, Contact
from models.core.system import Port, System

from ...errors import Command, MistakeError, Option, one_of
from ...scenario import Scenario, ScenarioError
from ...scenario.files import load
from ...scenario.system import build_system, list_parameters
from ...store.output_folder import RESULT, SCENARIO, find_remedy, refuse_missing
from ...store.result_file import open_result
from ..merits import read_motion
from ..motion import Motion, Part
from ..trains import find_cams, find_law, find_trains, list_parts
from .cycle import OF_CAM, OF_CONTACT, last_revolution, wear
from .losses import POWER, list_losses
from .report import OTHERS, Judged
from .shares import Losses, measure_losses


def judge_friction(
    folder: Path, contact: str | None, coefficient: float, cycles: float
) -> tuple[Scenario, list[Judged]]:
    """The run's scenario, and friction and wear of the cams' contacts, or of one, over the last revolution.

    `coefficient` is wear volume over load times distance (m2/N); `cycles` are revolutions that wear is
    extrapolated over. MistakeError if there is no result, or none with a contact under a cam.
    """
    if not coefficient > 0.0:
        raise MistakeError((Option("wear_coefficient", coefficient), " m2/N: must be > 0"))
    if not cycles > 0.0:
        raise MistakeError((Option("cycles", cycles), ": must be > 0"))
    scenario = _load_scenario(folder)
    system = build_system(scenario)
    cams = find_sliding(system)
    if contact and cams and contact not in cams:
        allowed = f": {one_of(cams, contact)} (those that slide under a cam)"
        raise MistakeError((Option("contact", contact), allowed))
    if not cams:
        raise MistakeError(f"{scenario.name}: no contact takes its sliding_velocity from a cam")
    values = list_parameters(scenario)
    found = []
    for name in [contact] if contact else list(cams):
        time, columns, units = _read(folder, list_columns(system, name, cams[name]))
        broken_off = time[-1] < (1.0 - 1e-9) * scenario.stop_time
        remedy = ("go on with the run, which broke off: ", Command("resume", (folder,))) if broken_off else ""
        cycle = last_revolution(name, time, columns, remedy)
        cycle = replace(cycle, law=find_law(system, name), units=units)
        worn = wear(cycle, "asperity_load", coefficient, values[f"{name}.length"])
        found.append(Judged(cycle, worn, coefficient, cycles, values[f"{name}.roughness"]))
    return scenario, found


def judge_losses(folder: Path, scenario: Scenario) -> tuple[Losses, Motion]:
    """The friction of all parts over the last turn of the first cam, and the rows of that turn."""
    system = build_system(scenario)
    with open_result(folder) as result:
        group = result["coupled"].ds.load()
    motion = read_motion(system, lambda name: np.asarray(group[name].values, float))
    turn = Part(motion, find_trains(system)[0].cam).last_turn
    cut = turn.motion if turn else motion
    return measure_losses(cut), cut


def measure_others(motion: Motion, coefficient: float) -> dict[str, dict[str, float]]:
    """Numbers of each contact that slides, but not under a cam, by OTHERS: means over the motion, the least
    film ratio under load, and the volume (m3) worn off each body at the coefficient (m2/N). Friction that
    another part has is nan."""
    system, found = motion.system, dict[str, dict[str, float]]()
    rubbing = {loss.part for loss in list_losses(system) if loss.figure == POWER}
    for name in list_parts(system, Contact):
        contact = Part(motion, name)
        sliding, load = np.abs(contact["sliding_velocity"]), contact["load"]
        if name in find_sliding(system) or not np.any(load * sliding):
            continue
        power = contact.mean(contact["friction_force"] * contact["sliding_velocity"])
        power = power if name in rubbing else math.nan
        worn = contact.integrate(contact["asperity_load"] * sliding, motion.times)
        numbers = (
            *(power, power / contact.mean(load * sliding)),
            contact.mean(contact["asperity_load"]) / contact.mean(load),
            float(np.min(contact["film_ratio"], where=load > 0.0, initial=np.inf)),
            coefficient * worn,
        )
        found[name] = dict(zip(OTHERS, numbers, strict=True))
    return found


def _load_scenario(folder: Path) -> Scenario:
    refuse_missing(folder)
    for name in (RESULT, SCENARIO):
        if not (folder / name).is_file():
            remedy = find_remedy(folder, "give the output folder of a finished run")
            raise MistakeError(f"{folder}: there is no {name}; {remedy}")
    try:
        return load(folder / SCENARIO)
    except ScenarioError as error:
        raise MistakeError(
            f"{error}. Friction is judged with the run's scenario; if another version wrote it, run again"
        ) from None


def find_sliding(system: System) -> dict[str, str]:
    """The cam of each contact that slides under one."""
    contacts = list_parts(system, Contact)
    return {part: cam for part, cam in find_cams(system, "sliding_velocity").items() if part in contacts}


def list_columns(system: System, contact: str, cam: str) -> dict[str, str]:
    """The variables of OF_CONTACT and OF_CAM as "instance.variable". `sliding_velocity` is the contact's,
    `cam_sliding` the cam's, without a spin of the tappet."""
    role = system.instances[cam].component.find_role(Cam)
    assert role
    called = {
        "cam_angle": role.angle,
        "radius_of_curvature": role.radius_of_curvature,
        "cam_sliding": "sliding_velocity",
    }
    found = {name: f"{contact}.{name}" for name in OF_CONTACT}
    found |= {name: f"{cam}.{called.get(name, name)}" for name in OF_CAM}
    return found | {"sliding_velocity": str(system.drivers[Port(contact, "sliding_velocity")])}


def _read(folder: Path, wanted: dict[str, str]) -> tuple[Vector, dict[str, Vector], dict[str, str]]:
    """The time, and columns with their units."""
    with open_result(folder) as result:
        group = result["coupled"].ds
        if wanted["cam_speed"] not in group:  # an input of a follower
            del wanted["cam_speed"]
        if missing := [name for name in wanted.values() if name not in group]:
            raise MistakeError(f"{folder / RESULT}: has no {', '.join(missing)}; run the scenario again")
        columns = {name: np.asarray(group[place].values, float) for name, place in wanted.items()}
        units = {name: group[place].attrs["units"] for name, place in wanted.items()}
        time = np.asarray(group["time"].values, float)
    columns = {"cam_speed": np.gradient(columns["cam_angle"], time), **columns}
    return time, columns, {"cam_speed": "rad/s", **units}
