"""The friction of a whole system by shares, which are named by what a part does in its train."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray
from rich import box
from rich.table import Table

from models.core import roles
from models.core.system import System

from ...errors import Words
from ...scenario.display import format_number
from ..figures_of_merit import measure
from ..motion import Motion, Part
from ..trains import list_parts

POWER, ROLLING_POWER = "friction_power", "rolling_power"
CONTACT, ROLLING, SLIP, TIP = "cam contact", "rolling", "roller slip", "valve tip"
PIN, PIVOT, BORE, GUIDE = "roller pin", "lever pivot", "tappet bore", "valve guide"
BEARING = "camshaft bearing"
SHARES = (CONTACT, ROLLING, SLIP, PIN, PIVOT, TIP, BORE, GUIDE, BEARING)
# The share of a joint or guide by the role of the part on which it acts; of none of these it is a bearing.
JOINTS: Mapping[type[roles.Role], str] = {
    roles.Roller: PIN,
    roles.PivotedFollower: PIVOT,
    roles.Rocker: PIVOT,
    roles.TranslatingFollower: BORE,
    roles.Valve: GUIDE,
}


@dataclass(frozen=True)
class Loss:
    """A part that loses power to friction: its figure, its share, and whether it acts on the motion."""

    part: str
    share: str
    acts: bool = True
    figure: str = POWER


def list_losses(system: System) -> list[Loss]:
    """All losses to friction, in the order of their shares."""
    found = [loss for name in system.instances for loss in _find_losses(system, name)]
    return sorted(found, key=lambda loss: SHARES.index(loss.share))


def add_losses(table: xarray.Dataset, system: System) -> xarray.Dataset:
    """The table of cycles with the sum of all losses to friction, of a train with several."""
    losses = [f"{loss.part}.{loss.figure}" for loss in list_losses(system)]
    if len(losses) < 2:
        return table
    return table.assign({f"whole train.{POWER}": sum(table[name] for name in losses)})


def _find_losses(system: System, name: str) -> Iterator[Loss]:
    component = system.instances[name].component
    if component.has_role(roles.Roller):
        yield Loss(name, SLIP)
    elif component.has_role(roles.Surface):
        yield Loss(name, _name_place(system, name))
    elif component.has_role(roles.Contact):
        place = _name_place(system, name)
        if not any(
            other.component.has_role(roles.Surface) and _gives(system, name, "load", part)
            for part, other in system.instances.items()
        ):
            yield Loss(name, place, _drives(system, name, "friction_force"))
        if place == CONTACT and component.has_role(roles.RollingContact):
            yield Loss(name, ROLLING, _drives(system, name, "rolling_friction"), ROLLING_POWER)
    elif component.has_role(roles.Pivot, roles.Bearing, roles.Guide):
        yield Loss(name, _name_joint(system, name))


def _name_place(system: System, name: str) -> str:
    """Under a cam, or of a lever on its valve."""
    under = (roles.Cam, roles.FlatFollower, roles.Spin)
    velocities = ("sliding_velocity", "rolling_velocity")
    cams = (
        system.instances[connection.source.instance].component.has_role(*under)
        for connection in system.connections
        if connection.target.instance == name
        and connection.target.variable in velocities
        and connection.source.variable in (*velocities, "contact_sliding")
    )
    return CONTACT if any(cams) else TIP


def _name_joint(system: System, name: str) -> str:
    for connection in system.connections:
        if connection.source.instance == name:
            taker = system.instances[connection.target.instance].component
            for role, share in JOINTS.items():
                if taker.has_role(role):
                    return share
    return BEARING


def _gives(system: System, name: str, variable: str, part: str) -> bool:
    return any(
        (c.source.instance, c.source.variable, c.target.instance, c.target.variable)
        == (name, variable, part, variable)
        for c in system.connections
    )


def _drives(system: System, name: str, variable: str) -> bool:
    return any((c.source.instance, c.source.variable) == (name, variable) for c in system.connections)


@dataclass(frozen=True)
class Losses:
    """Mean powers (W) of a motion by part and figure, that of its drives, and their mean speed (rad/s)."""

    losses: Sequence[Loss]
    powers: Mapping[tuple[str, str], float]
    drive: float
    speed: float

    @property
    def shares(self) -> dict[str, float]:
        """Power of each share (W)."""
        return {
            share: self._add(loss for loss in self.losses if loss.share == share)
            for share in SHARES
            if any(loss.share == share for loss in self.losses)
        }

    @property
    def total(self) -> float:
        return self._add(self.losses)

    @property
    def rest(self) -> float:
        """What the drives give besides: to dampers of springs, seats and contacts, and to what they drive."""
        return self.drive - self._add(loss for loss in self.losses if loss.acts)

    def _add(self, losses: Iterable[Loss]) -> float:
        return sum(self.powers[loss.part, loss.figure] for loss in losses)


def measure_losses(motion: Motion) -> Losses:
    """Means over the rows of a motion."""
    powers = {(part, figure): found.value for part, figure, _, found in measure(motion)}
    drives = [Part(motion, name) for name in list_parts(motion.system, roles.Drive)]
    return Losses(
        list_losses(motion.system),
        powers,
        sum(drive.mean(drive["supplied_torque"] * drive["speed"]) for drive in drives),
        drives[0].mean(drives[0]["speed"]) if drives else math.nan,
    )


def cut_last_turn(motion: Motion, turned: float) -> Motion:
    """The rows of the last turn of an angle that turned so far (rad)."""
    begin = motion.times[-1] - (motion.times[-1] - motion.times[0]) * min(1.0, 2.0 * math.pi / turned)
    first = int(np.searchsorted(motion.times, begin - 1e-9 * motion.times[-1]))
    return Motion(motion.system, motion.times[first:], lambda name: motion.column(name)[first:], motion.angle)


def tabulate_losses(found: Losses) -> Table:
    """Powers, and torques on the drive, by share."""
    table = Table(
        title="Friction of the whole train, means over that revolution",
        title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False,
    )  # fmt: skip
    for head in ("share", "power (W)", "torque on the drive (N m)", "%", "parts"):
        table.add_column(head, justify="left" if head in ("share", "parts") else "right", overflow="fold")
    for share, power in found.shares.items():
        parts = ", ".join(loss.part for loss in found.losses if loss.share == share)
        percent = format_number(100.0 * power / found.total, 3) if found.total else ""
        table.add_row(share, format_number(power), format_number(power / found.speed), percent, parts)
    total = format_number(found.total), format_number(found.total / found.speed)
    table.add_row("sum", *total, "100" if found.total else "", "")
    return table


def remark_losses(found: Losses, motion: Motion) -> Iterator[Words]:
    """What the shares leave out."""
    if idle := [f"{loss.part} ({loss.share})" for loss in found.losses if not loss.acts]:
        yield f"{', '.join(idle)}: no connection takes the friction to the motion, which does not feel it"
    for loss in found.losses:
        if loss.share == CONTACT and not np.any(Part(motion, loss.part)["sliding_velocity"]):
            yield (
                f"{loss.part}: pure rolling is assumed, so that it has no friction of sliding; a roller that "
                "may slip finds its spin from traction and the pin's friction"
            )
    if found.drive > 0.0:
        share = format_number(100.0 * found.rest / found.drive, 3)
        yield (
            f"the drive gives {format_number(found.drive)} W; {share} % of it is not friction but goes into "
            "the dampers of springs, seats and contacts, and into motion that is not yet steady"
        )
