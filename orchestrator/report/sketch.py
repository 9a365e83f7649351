"""A drawing that a result moves, and what it knows of a scenario.

A sketch has frames and shapes. A frame turns about a point and is shifted by variables of the result; a shape
is a line through points of frames. Lengths are in mm; y points along the lift of the follower on its cam.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from models.core.roles import Role

from ..scenario import Scenario, parse_ends
from ..scenario.component_table import ComponentTable
from ..scenario.values import to_numbers

MM = 1e3
GROUND = 0
# Points of a circle.
CIRCLE = 36


@dataclass
class Sketch:
    """A drawing. `mirrored`: y points downwards on the page. `variables` are those that move it."""

    title: str
    mirrored: bool = False
    frames: list[dict[str, Any]] = field(default_factory=lambda: [{}])
    shapes: list[dict[str, Any]] = field(default_factory=list)
    contacts: list[dict[str, Any]] = field(default_factory=list)
    variables: set[str] = field(default_factory=set)

    def frame(
        self,
        turn: Sequence[tuple[str, float]] = (),
        about: tuple[float, float] = (0.0, 0.0),
        shift: Sequence[tuple[str, float, float]] = (),
    ) -> int:
        """A frame that turns by the sum of factor * variable (rad, anticlockwise) about a point, and moves
        by factors (mm per unit) of variables; its number."""
        self.variables |= {name for name, _ in turn} | {name for name, _, _ in shift}
        self.frames.append({"turn": list(turn), "about": about, "shift": list(shift)})
        return len(self.frames) - 1

    def draw(self, kind: str, nodes: Sequence[Any], title: str = "", closed: bool = True) -> None:
        """A shape of a style of report.css through nodes (frame, x, y), or between two frames
        (frame, other frame, share of the other, x, y)."""
        rounded = [[round(v, 4) if isinstance(v, float) else v for v in node] for node in nodes]
        self.shapes.append({"kind": kind, "nodes": rounded, "title": title, "closed": closed})

    def light(self, forces: Sequence[str], counters: Sequence[str]) -> None:
        """The last shape lights up under force, and after an impact that its counter counts."""
        self.shapes[-1]["lit"] = [(name, False) for name in forces] + [(name, True) for name in counters]
        self.variables |= {*forces, *counters}

    def polygon(self, kind: str, frame: int, corners: Sequence[tuple[float, float]], title: str = "") -> None:
        """A closed shape of one frame."""
        self.draw(kind, [(frame, *corner) for corner in corners], title)

    def circle(self, kind: str, frame: int, x: float, y: float, radius: float, title: str = "") -> None:
        angles = np.linspace(0.0, 2.0 * math.pi, CIRCLE, endpoint=False)
        self.polygon(
            kind, frame, [(x + radius * math.cos(a), y + radius * math.sin(a)) for a in angles], title
        )

    def box(
        self, kind: str, frame: int, x: float, y: float, width: float, height: float, title: str = ""
    ) -> None:
        """A rectangle with the middle of its lower side at (x, y)."""
        w = 0.5 * width
        corners = ((x - w, y), (x + w, y), (x + w, y + height), (x - w, y + height))
        self.polygon(kind, frame, corners, title)

    def content(self) -> dict[str, Any]:
        """As plain JSON values."""
        return {
            "title": self.title,
            "mirrored": self.mirrored,
            "frames": self.frames,
            "shapes": self.shapes,
            "contacts": self.contacts,
        }


class Parts:
    """The components of a scenario and how they are connected; `known` are the variables of the result."""

    def __init__(self, scenario: Scenario, known: Sequence[str]) -> None:
        self.tables = scenario.components
        self.known = set(known)
        self.sources = {target: source for source, target in map(parse_ends, scenario.connections)}

    def list_role(self, role: type[Role]) -> list[str]:
        return [name for name in self.tables if self.has_role(name, role)]

    def has_role(self, name: str, role: type[Role]) -> bool:
        """Whether there is an instance of that name with that role."""
        return name in self.tables and self.tables[name].resolve().has_role(role)

    def has(self, name: str) -> bool:
        return name in self.known

    def driver(self, target: str) -> str:
        """The instance whose output drives that input; empty if none does."""
        return self.sources.get(target, "").split(".")[0]

    def list_driven(self, source: str) -> list[str]:
        """The instances that have an input which that output drives."""
        return [target.split(".")[0] for target, own in self.sources.items() if own == source]

    def numbers(self, name: str) -> dict[str, float]:
        """All parameters of an instance in SI units."""
        return get_numbers(self.tables[name])


def get_numbers(table: ComponentTable) -> dict[str, float]:
    layout = table.resolve().parameters
    return {f.name: f.start for f in layout.fields} | to_numbers(layout, table.parameters)
