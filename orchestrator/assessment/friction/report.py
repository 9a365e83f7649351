"""Friction and wear of contacts as a table to read, and what to beware of."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from rich.table import Table

from models.contact.records import ATOM

from ...errors import Option, Words
from ...reporter import make_table
from ...scenario.display import format_number
from .cycle import TURN, Cycle, Summary, Wear, summary

# Of the cam's lift: a profile that has lost more is no longer the one that was computed.
WORN = 0.01
# Contacts side by side in one table.
COLUMNS = 4


@dataclass(frozen=True)
class Judged:
    """A contact's last revolution; wear at the coefficient (m2/N), extrapolated over `cycles` revolutions."""

    cycle: Cycle
    worn: Wear
    coefficient: float
    cycles: float
    roughness: float

    @property
    def summary(self) -> Summary:
        return summary(self.cycle)

    @property
    def deepest(self) -> tuple[float, float]:
        """Depth worn off cam and follower in one revolution (m)."""
        return float(self.worn.cam_depth.max()), float(self.worn.follower_depth.max())


def _film(found: Judged) -> str:
    """The film whose ratio is the least: printed numbers are quotients of one another."""
    if found.roughness <= 0.0:
        return "smooth"
    film = found.summary.least_film_ratio * found.roughness
    return format_number(1e6 * film) if film >= ATOM else "no film"


def _cam_place(found: Judged) -> str:
    return f"{math.degrees(found.worn.cam_angle[found.worn.cam_depth.argmax()]):.0f}"


def _follower_place(found: Judged) -> str:
    return f"{1e3 * found.worn.follower_place[found.worn.follower_depth.argmax()]:.2f}"


ROWS: tuple[tuple[str, str, Callable[[Judged], str]], ...] = (
    ("mean friction torque", "N m", lambda f: format_number(f.summary.mean_torque)),
    ("largest friction torque", "N m", lambda f: format_number(f.summary.largest_torque)),
    ("mean friction power", "W", lambda f: format_number(f.summary.mean_power)),
    ("friction work", "J", lambda f: format_number(f.summary.work)),
    ("coefficient of friction", "", lambda f: format_number(f.summary.coefficient)),
    ("asperities' share of the load", "%", lambda f: format_number(100.0 * f.summary.asperity_share, 3)),
    ("asperities' share of the work", "%", lambda f: format_number(100.0 * f.summary.boundary_share, 3)),
    ("least film of the oil under load", "µm", _film),
    ("its ratio to the roughness", "", lambda f: format_number(f.summary.least_film_ratio, 3)),
    ("roughness", "µm", lambda f: format_number(1e6 * f.roughness, 3)),
    ("time in which contact is lost", "%", lambda f: format_number(100.0 * f.summary.lost, 3)),
    ("deepest wear of the cam", "pm", lambda f: format_number(1e12 * f.deepest[0], 3)),
    ("  at the cam angle", "deg", _cam_place),
    ("deepest wear of the follower", "pm", lambda f: format_number(1e12 * f.deepest[1], 3)),
    ("  at the place", "mm", _follower_place),
    ("worn off each body", "µm³", lambda f: format_number(1e18 * f.worn.volume, 3)),
    ("cam after all revolutions", "µm", lambda f: format_number(1e6 * f.cycles * f.deepest[0], 3)),
    ("follower after all revolutions", "µm", lambda f: format_number(1e6 * f.cycles * f.deepest[1], 3)),
)


def tables(found: Sequence[Judged]) -> Iterator[Table]:
    """Of some contacts each."""
    for first in range(0, len(found), COLUMNS):
        some = found[first : first + COLUMNS]
        apart = 1e6 * float(np.diff(some[0].cycle.time).max())
        note = f"wear at {some[0].coefficient:g} m2/N; all revolutions: {some[0].cycles:g}; "
        note += f"from recorded rows, {apart:.3g} µs apart at most"
        title, contacts = "Friction and wear over the last revolution", [each.cycle.contact for each in some]
        table = make_table(title, ["quantity", "unit"], contacts, note)
        for words, unit, text in ROWS:
            table.add_row(words, unit, *map(text, some))
        yield table


def remarks(found: Judged) -> Iterator[Words]:
    """What the numbers of a contact don't say by themselves."""
    cycle, contact = found.cycle, found.cycle.contact
    missing = TURN - cycle.turned
    if missing > 1e-6 * TURN:
        yield (
            f"{contact}: the run covers {math.degrees(cycle.turned):.4g} deg of the revolution; the other "
            f"{math.degrees(missing):.2g} deg count in no number here"
        )
    if found.summary.lost > 0.0:
        yield (
            f"{contact}: contact is lost in {100.0 * found.summary.lost:.3g} % of the time. "
            "Means are over all of it; the wear is that of sliding, without that of landing. These are rows "
            f"up to {1e6 * float(np.diff(cycle.time).max()):.3g} µs apart: summary.json has the peaks of all "
            "macro steps"
        )
    lift = float(np.ptp(cycle["cam_lift"]))
    worst = found.cycles * max(found.deepest)
    if worst > WORN * lift:
        yield (
            f"{contact}: {1e6 * worst:.4g} µm of wear are {100.0 * worst / lift:.3g} % of the lift of "
            f"{1e3 * lift:.3g} mm: the computed profile is gone long before {found.cycles:g} revolutions; "
            "extrapolate over at most ",
            Option("cycles", f"{WORN * lift / max(found.deepest):.1g}"),
        )
