"""The friction of a whole system by shares, which are named by what a part does in its train."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from rich.table import Table

from models.core import roles
from models.core.system import System

from ...errors import Words
from ...reporter import make_table
from ...scenario.display import format_number
from ..figures_of_merit import measure
from ..motion import Motion, Part
from ..trains import list_parts
from .losses import CONTACT, POWER, SHARES, Loss, list_losses, name_outside, remark_outside

if TYPE_CHECKING:
    import xarray

# Stands for the part of a sum over all parts.
WHOLE = "whole train"


def add_losses(table: xarray.Dataset, system: System) -> xarray.Dataset:
    """The table of cycles with the sum of all losses to friction, of a train with several; the attribute
    `outside` names those that the motion does not contain."""
    losses = list_losses(system)
    table = table.assign_attrs(outside=name_outside(losses))
    if len(losses) < 2:
        return table
    first, *others = (table[f"{one.part}.{one.figure}"] for one in losses)
    total = sum(others, start=first)
    attributes = {"units": "W", "long_name": "mean friction power"}
    return table.assign({f"{WHOLE}.{POWER}": total.assign_attrs(attributes)})


@dataclass(frozen=True)
class Losses:
    """Mean powers (W) of a motion by part and figure, that of its drives, and the mean speed (rad/s) of the
    first one; nan without any."""

    losses: Sequence[Loss]
    powers: Mapping[tuple[str, str], float]
    drives: Sequence[str]
    drive: float
    speed: float

    @property
    def shares(self) -> dict[str, float]:
        """Power of each share (W)."""
        return self._sum(lambda _: True)

    @property
    def inside(self) -> dict[str, float]:
        """What of each share the motion contains (W)."""
        return self._sum(lambda loss: loss.acts)

    @property
    def total(self) -> float:
        return sum(self.shares.values())

    @property
    def rest(self) -> float:
        """What the drives give besides: to dampers of springs, seats and contacts, and to what they drive."""
        return self.drive - sum(self.inside.values())

    def _sum(self, counts: Callable[[Loss], bool]) -> dict[str, float]:
        found = {share: 0.0 for share in SHARES if share in (loss.share for loss in self.losses)}
        for loss in filter(counts, self.losses):
            found[loss.share] += self.powers[loss.part, loss.figure]
        return found


def measure_losses(motion: Motion) -> Losses:
    """Means over the rows of a motion."""
    return sum_losses(motion, {(part, figure): one.value for part, figure, _, one in measure(motion)})


def sum_losses(motion: Motion, powers: Mapping[tuple[str, str], float]) -> Losses:
    """Of these figures of a motion, as far as they are known."""
    drives = [Part(motion, name) for name in list_parts(motion.system, roles.Drive)]
    return Losses(
        [loss for loss in list_losses(motion.system) if (loss.part, loss.figure) in powers],
        powers,
        [drive.name for drive in drives],
        sum(drive.mean(drive["supplied_torque"] * drive["speed"]) for drive in drives),
        drives[0].mean(drives[0]["speed"]) if drives else math.nan,
    )


def describe_torque(found: Losses) -> Iterator[str]:
    """The mean torque of the drive with all friction as a sum; none without drive or friction."""
    if not found.losses or not abs(found.speed) > 0.0:
        return
    outside = found.total - sum(found.inside.values())

    def say(power: float) -> str:
        return f"{format_number(power / found.speed, 3)} N m"

    parts = ", ".join(f"{share} {say(power)}" for share, power in found.shares.items())
    text = (
        f"{', '.join(found.drives)}: mean torque with all friction {say(found.drive + outside)} = friction "
        f"{say(found.total)} ({parts}) + the rest {say(found.rest)}, of dampers, loads and inertia"
    )
    left_out = name_outside(found.losses)
    yield f"{text}; the motion has {say(found.drive)}, without {left_out}" if left_out else text


def tabulate_losses(found: Losses) -> Table:
    """Powers, and the drive torques of the same power, by share."""
    title = "Friction of the whole train, means over that revolution"
    heads = ("power\n(W)", "in the\nmotion (W)", "as drive\ntorque (N m)", "%")
    table = make_table(title, ["share"], heads)
    table.add_column("parts", overflow="fold")
    rows = [(share, power, found.inside[share]) for share, power in found.shares.items()]
    for share, *powers in [*rows, ("sum", found.total, sum(found.inside.values()))]:
        parts = ", ".join(loss.part for loss in found.losses if loss.share == share)
        percent = format_number(100.0 * powers[0] / found.total, 3) if found.total else ""
        table.add_row(share, *map(format_number, (*powers, powers[0] / found.speed)), percent, parts)
    return table


def remark_losses(found: Losses, motion: Motion) -> Iterator[Words]:
    """What the shares leave out."""
    yield from describe_torque(found)
    yield from remark_outside(motion.system)
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
