"""The mechanisms of a scenario, as drawings that its results move."""

from collections.abc import Callable, Mapping, Sequence

from models.core import roles

from ..scenario import Scenario
from .cranks import sketch_piston_crank, sketch_slider_crank
from .sketch import Parts, Sketch
from .trains import sketch_direct, sketch_finger, sketch_tappet

# By the role of the part that a drawing begins with.
SKETCHES: Mapping[type[roles.Role], Callable[[Parts, str], Sketch | None]] = {
    roles.FlatFollower: sketch_direct,
    roles.TranslatingFollower: sketch_tappet,
    roles.PivotedFollower: sketch_finger,
    roles.Crank: sketch_slider_crank,
    roles.PistonCrank: sketch_piston_crank,
}


def list_sketches(scenario: Scenario, known: Sequence[str]) -> list[Sketch]:
    """The sketches of all mechanisms that are known here."""
    parts = Parts(scenario, known)
    found = [draw(parts, name) for role, draw in SKETCHES.items() for name in parts.list_role(role)]
    return [sketch for sketch in found if sketch is not None]
