"""The mechanisms of a scenario, as drawings that its results move."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from ..scenario import Scenario
from .cranks import sketch_piston_crank, sketch_slider_crank
from .sketch import Parts, Sketch
from .trains import sketch_direct, sketch_finger, sketch_tappet


def list_sketches(scenario: Scenario, known: Sequence[str]) -> list[Sketch]:
    """The sketches of all mechanisms that are known here."""
    parts = Parts(scenario, known)
    kinds: Mapping[str, Callable[[Parts, str], Sketch | None]] = {
        "camshaft": sketch_direct,
        "tappet": sketch_tappet,
        "finger": sketch_finger,
        "slider_crank": sketch_slider_crank,
        "piston_crank": sketch_piston_crank,
    }
    found = [draw(parts, name) for kind, draw in kinds.items() for name in parts.list_kind(kind)]
    return [sketch for sketch in found if sketch is not None]
