"""The contour of a cam as SVG and DXF, in mm and true to scale.

The axis of the cam is the origin. The follower is above, along +y at the cam angle zero; the cam turns
anticlockwise. For a cam that turns clockwise, mirror x.
"""

from collections.abc import Iterable, Mapping
from typing import Any

import xarray

MM = 1e3
MARGIN = 2.0  # mm
# A drawing without colours of its own.
LINE = 'fill="none" stroke="black" stroke-width="0.1"'
ABOUT = "Cam contour in mm; the follower is above at the cam angle zero; the cam turns anticlockwise"


def write_svg(table: xarray.Dataset, values: Mapping[str, Any]) -> str:
    """A closed path. The y axis of SVG points down, so that y has the other sign."""
    x, y, base = MM * table["contour_x"].values, -MM * table["contour_y"].values, MM * values["base_radius"]
    left, top = x.min() - MARGIN, y.min() - MARGIN
    width, height = x.max() + MARGIN - left, y.max() + MARGIN - top
    path = " L ".join(f"{a:.9f},{b:.9f}" for a, b in zip(x, y, strict=True))
    return f"""<svg xmlns="http://www.w3.org/2000/svg" width="{width:.3f}mm" height="{height:.3f}mm" \
viewBox="{left:.3f} {top:.3f} {width:.3f} {height:.3f}">
<title>{ABOUT}</title>
<path id="contour" {LINE} d="M {path} Z"/>
<circle id="base_circle" {LINE} stroke-dasharray="1 1" r="{base:.9f}"/>
<path id="axis" {LINE} d="M -1,0 H 1 M 0,-1 V 1"/>
</svg>
"""


def write_dxf(table: xarray.Dataset, values: Mapping[str, Any]) -> str:
    """DXF R12 with the layers CONTOUR (a closed polyline), BASE_CIRCLE and AXIS (a point)."""
    points = zip(MM * table["contour_x"].values, MM * table["contour_y"].values, strict=True)
    contour = [_write_entity("VERTEX", "CONTOUR", _place(x, y)) for x, y in points]
    circle = [*_place(0.0, 0.0), (40, f"{MM * values['base_radius']:.9f}")]
    return "".join(
        [
            _write_pairs([(999, ABOUT), (0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1009")]),
            _write_pairs([(0, "ENDSEC"), (0, "SECTION"), (2, "ENTITIES")]),
            # 66: vertices follow; 70: closed.
            _write_entity("POLYLINE", "CONTOUR", [(66, 1), *_place(0.0, 0.0), (70, 1)]),
            *contour,
            _write_entity("SEQEND", "CONTOUR", []),
            _write_entity("CIRCLE", "BASE_CIRCLE", circle),
            _write_entity("POINT", "AXIS", _place(0.0, 0.0)),
            _write_pairs([(0, "ENDSEC"), (0, "EOF")]),
        ]
    )


def _place(x: float, y: float) -> list[tuple[int, str]]:
    return [(10, f"{x:.9f}"), (20, f"{y:.9f}"), (30, "0.0")]


def _write_entity(kind: str, layer: str, pairs: Iterable[tuple[int, object]]) -> str:
    return _write_pairs([(0, kind), (8, layer), *pairs])


def _write_pairs(pairs: Iterable[tuple[int, object]]) -> str:
    """Group codes with their values, each on its own line."""
    return "".join(f"{code:>3}\n{value}\n" for code, value in pairs)
