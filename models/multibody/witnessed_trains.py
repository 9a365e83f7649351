"""The valve trains that the multibody witness knows: their parts in a system, and their mechanisms."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

from ..core.quantities import Vector
from ..core.system import System


class Observation(NamedTuple):
    """A quantity of the mechanism over time, and the output that it is, or times the reference's `arm`."""

    name: str
    values: Vector
    output: str
    arm: str = ""

    def find(self, outputs: Any, reference: Any) -> Vector:
        """The quantity from outputs, and those of the reference, by "instance.variable"."""
        found: Vector = outputs[self.output] * reference[self.arm] if self.arm else outputs[self.output]
        return found


@dataclass(frozen=True)
class WitnessedTrain(ABC):
    """A valve train in a system, by the names that its parts have there."""

    system: System
    names: Mapping[str, str]

    # The components of the train, by the names of its parts.
    parts: ClassVar[Mapping[str, str]]
    # Parameters that must be 0, and what they are.
    absent: ClassVar[Mapping[tuple[str, str], str]]
    # Inputs that must not be connected.
    open: ClassVar[Mapping[tuple[str, str], str]]

    def output(self, part: str, variable: str) -> str:
        return f"{self.names[part]}.{variable}"

    @cached_property
    def parameters(self) -> Mapping[str, Any]:
        """Records by part."""
        system = self.system
        return {
            part: system.instances[name].component.parameters.view(system.p[system.parameters.of(name)])
            for part, name in self.names.items()
        }

    @cached_property
    def states(self) -> Mapping[str, Any]:
        """Records of the system's start, by part."""
        system = self.system
        return {
            part: system.instances[name].component.state.view(system.x0[system.state.of(name)])
            for part, name in self.names.items()
        }

    @property
    def drive(self) -> Any:
        """The parameters of what turns the camshaft."""
        return self.parameters["flywheel"]

    def size(self, part: str, name: str) -> int:
        """A size of the part's component."""
        return int(self.system.instances[self.names[part]].component.structure[name])

    def find_profile(self, part: str) -> Any:
        """The profile of the part's cam."""
        from ..valve_train.cams.law import LAW
        from ..valve_train.cams.table import TABLE

        return TABLE if self.size(part, "table_points") else LAW

    def compare_output(self, part: str, variable: str, values: Vector) -> Observation:
        name = self.output(part, variable)
        return Observation(name, values, name)

    @abstractmethod
    def build(self) -> Any:
        """The mechanism with its parts where the system's start has them."""

    @abstractmethod
    def observe(self, motion: Any) -> list[Observation]:
        """What the motion has in common with the system."""


class DirectTrain(WitnessedTrain):
    """Camshaft and valve, with the film of their contact."""

    parts: ClassVar = {
        "flywheel": "flywheel", "camshaft": "camshaft", "valve_spring": "valve_spring",
        "contact": "ehl_contact",
    }  # fmt: skip
    absent: ClassVar = {
        ("valve_spring", "clash_stiffness"): "clash of coils",
        ("contact", "load_is_given"): "given load",
    }
    open: ClassVar = {
        ("camshaft", "friction_force"): "friction on the cam",
        ("valve_spring", "gas_force"): "gas pressure",
    }

    def build(self) -> Any:
        from .direct_train import direct_train

        given = self.parameters
        return direct_train(
            given, self.states, float(given["camshaft"].drive_ratio * self.drive.initial_speed),
            self.size("valve_spring", "coil_masses"), self.find_profile("camshaft"),
        )  # fmt: skip

    def observe(self, motion: Any) -> list[Observation]:
        from .direct_train import CONTACT, DRIVE, GUIDE

        camshaft = self.parameters["camshaft"]
        torque = camshaft.drive_ratio * motion.multiplier(DRIVE)[:, 0]
        load, offset = self.output("contact", "load"), self.output("camshaft", "contact_offset")
        place = motion.position("follower")[:, 1] - float(camshaft.base_radius)
        return [
            self.compare_output("contact", "load", motion.load(CONTACT)),
            self.compare_output("contact", "film_thickness", motion.film_thickness(CONTACT)),
            self.compare_output("camshaft", "drive_torque", torque),
            self.compare_output("valve_spring", "position", place),
            Observation("guide moment", -motion.reaction(GUIDE).moment[:, 2], load, offset),
        ]


class PushrodTrainOfParts(WitnessedTrain):
    """Tappet on its cam, pushrod, rocker and valve, with the films of cam and valve."""

    parts: ClassVar = {
        "flywheel": "flywheel", "tappet": "tappet", "pushrod": "rod", "rocker": "rocker",
        "valve_spring": "valve_spring", "cam_contact": "ehl_contact", "valve_contact": "ehl_contact",
    }  # fmt: skip
    absent: ClassVar = {
        ("tappet", "follower"): "roller and no pad",
        ("tappet", "tilt"): "tilted face",
        ("tappet", "guide_damping"): "friction in the guide",
        ("tappet", "gravity"): "weight",
        ("pushrod", "gravity"): "weight",
        ("rocker", "pivot_damping"): "friction of the pivot",
        ("rocker", "small_motion"): "small motion of a rocker with films",
        ("valve_spring", "clash_stiffness"): "clash of coils",
        ("cam_contact", "load_is_given"): "given load",
        ("valve_contact", "load_is_given"): "given load",
    }
    open: ClassVar = {
        ("rocker", "pivot_torque"): "friction of the pivot",
        ("rocker", "tip_friction"): "friction on the valve's tip",
        ("valve_spring", "gas_force"): "gas pressure",
    }

    def build(self) -> Any:
        from .pushrod_train import PushrodTrain

        sizes = self.size("pushrod", "segments"), self.size("valve_spring", "coil_masses")
        train = PushrodTrain(self.parameters, self.states, *sizes)
        return train.build(float(self.drive.initial_speed), self.find_profile("tappet"))

    def observe(self, motion: Any) -> list[Observation]:
        from .pushrod_train import CAM, DRIVE, TIP

        load, offset = self.output("cam_contact", "load"), self.output("tappet", "contact_offset")
        torque = motion.multiplier(DRIVE)[:, 0]
        # The mechanism opens its valve towards -y; its start is the system's.
        valve, begin = motion.position("valve")[:, 1], float(self.states["valve_spring"].position)
        lifted = motion.position("tappet")[:, 1] - float(self.parameters["tappet"].base_radius)
        return [
            self.compare_output("cam_contact", "load", motion.load(CAM)),
            self.compare_output("valve_contact", "load", motion.load(TIP)),
            self.compare_output("cam_contact", "film_thickness", motion.film_thickness(CAM)),
            self.compare_output("valve_contact", "film_thickness", motion.film_thickness(TIP)),
            Observation("drive torque without friction", torque, load, offset),
            self.compare_output("tappet", "position", lifted),
            self.compare_output("valve_spring", "position", begin + valve[0] - valve),
        ]


def find_train(system: System) -> WitnessedTrain | None:
    """The train that a system is, or None if the witness knows none like it."""
    kinds = {name: instance.component.name for name, instance in system.instances.items()}
    for train in (DirectTrain, PushrodTrainOfParts):
        if sorted(kinds.values()) != sorted(train.parts.values()):
            continue
        by_kind: dict[str, list[str]] = {}
        for name, kind in kinds.items():
            by_kind.setdefault(kind, []).append(name)
        names = {part: by_kind[kind][0] for part, kind in train.parts.items()}
        if train is PushrodTrainOfParts:
            names |= _tell_contacts(system, names)
        return train(system, names)
    return None


def _tell_contacts(system: System, names: Mapping[str, str]) -> dict[str, str]:
    """Which contact is the tappet's and which the rocker's."""
    sources = {str(connection.target): str(connection.source) for connection in system.connections}
    ends = {"cam_contact": f"{names['tappet']}.cam_load", "valve_contact": f"{names['rocker']}.tip_load"}
    return {part: sources.get(end, ".").split(".")[0] or names[part] for part, end in ends.items()}
