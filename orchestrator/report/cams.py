"""Cams and their followers, drawn."""

import math

import numpy as np

from models.core.quantities import Vector
from models.valve_train.followers.shape import sample_angles, trace_shape

from ..scenario.cams import read_cam
from ..scenario.component_table import ComponentTable
from .sketch import CIRCLE, MM, Parts, Sketch

# Points of a cam's contour.
CONTOUR = 240
# Thickness of a bucket's plate (mm).
PLATE = 3.0


def draw_cam(sketch: Sketch, parts: Parts, name: str, angle: str) -> float:
    """The contour of a cam about the origin, and the width of the follower (mm) that it needs."""
    x, y = trace_contour(parts.tables[name])
    cam = sketch.frame(turn=[(angle, 1.0)])
    sketch.polygon("cam", cam, [(MM * a, MM * b) for a, b in zip(x, y, strict=True)], f"cam of {name}")
    sketch.circle("pin", cam, 0.0, 0.0, 0.3 * MM * float(np.min(np.hypot(x, y))), "shaft")
    sketch.draw("mark", [(cam, 0.0, 0.0), (cam, MM * float(x[0]), MM * float(y[0]))], closed=False)
    return 2.2 * MM * float(np.max(np.hypot(x, y)) - np.min(np.hypot(x, y))) + 18.0


def trace_contour(table: ComponentTable) -> tuple[Vector, Vector]:
    """The contour of a component's cam (m), at the cam angle zero."""
    cam = read_cam(table)
    shape = trace_shape(sample_angles(CONTOUR), cam.lift, cam.follower, cam.geometry)
    return shape.x, shape.y


def draw_pad(sketch: Sketch, moving: int, centre: float, radius: float, top: float, title: str) -> None:
    """The arc of a pad that slides on the cam, about a point above it, and its foot on the lever at `top`."""
    half = min(0.7, 13.0 / radius)
    angles = np.linspace(-half, half, CIRCLE // 2)
    arc = [(radius * math.sin(a), centre - radius * math.cos(a)) for a in angles]
    sketch.polygon("body", moving, [*arc, (7.0, top), (-7.0, top)], title)


def draw_bucket(sketch: Sketch, moving: int, bottom: float, width: float, title: str) -> None:
    sketch.box("body", moving, 0.0, bottom, width, PLATE, title)
    for side in (-1.0, 1.0):
        sketch.box("body", moving, side * (0.5 * width - 1.2), bottom + PLATE, 2.4, 12.0, title)
