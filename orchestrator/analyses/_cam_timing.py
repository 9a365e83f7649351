"""The timing of a cam as the trade states it: durations at a lift, opening and closing, overlap."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.optimize import brentq

from models.plausible import ANGLE

from ._cam_profile import Profile
from .protocol import Parameter, Result

# Lifts at which durations count, by the names of their results.
HEIGHTS = {"050": 0.050 * 0.0254, "1mm": 1e-3}

PARAMETERS = {
    name: Parameter(math.radians(108.0), "rad", words, plausible=ANGLE)
    for name, words in (
        ("lobe_centre", "crank angle of the largest lift after top dead centre (intake)"),
        ("lobe_separation", "cam angle between the noses of exhaust and intake, which lift alike"),
    )
}
_IN_DEGREES = {
    "duration_050": "crank angle over which the cam lifts by 0.050 in or more",
    "duration_1mm": "crank angle over which the cam lifts by 1 mm or more",
    "lobe_middle": "cam angle of the middle between both lifts of 0.050 in",
    "opening_1mm": "crank angle from top dead centre at a lift of 1 mm; negative: before it",
    "closing_1mm": "crank angle from bottom dead centre where 1 mm is left",
    "overlap_050": "crank angle of overlap with the exhaust at 0.050 in; negative: none",
    "overlap_1mm": "crank angle of overlap with the exhaust at 1 mm; negative: none",
}
RESULTS = {
    **{name: Result("rad", words, display_unit="deg") for name, words in _IN_DEGREES.items()},
    "lift_at_centre": Result("m", "lift at top dead centre", display_unit="mm"),
}


def find_timing(profile: Profile, values: Mapping[str, Any]) -> dict[str, float]:
    """RESULTS; not a number where the cam lifts less."""
    nose, centre = profile.nose, values["lobe_centre"]
    sides = {name: _cross(profile, nose, height) for name, height in HEIGHTS.items()}
    opening, closing = (centre + 2.0 * (a - nose) for a in sides["1mm"])
    found = {f"duration_{name}": 2.0 * (after - before) for name, (before, after) in sides.items()}
    overlap = {
        f"overlap_{name}": found[f"duration_{name}"] - 2.0 * values["lobe_separation"] for name in HEIGHTS
    }
    return {
        **found,
        "lobe_middle": 0.5 * sum(sides["050"]),
        "opening_1mm": opening,
        "closing_1mm": closing - math.pi,
        "lift_at_centre": profile.lift((nose - 0.5 * centre) % (2.0 * math.pi)).s,
        **overlap,
    }


def _cross(profile: Profile, nose: float, height: float) -> tuple[float, float]:
    """The cam angles on both sides of the nose where it lifts by the height."""

    def over(angle: float) -> float:
        return profile.lift(angle % (2.0 * math.pi)).s - height

    if over(nose) <= 0.0:
        return math.nan, math.nan
    found = []
    for side in (-1.0, 1.0):
        angles = nose + side * np.radians(np.arange(0.0, 180.5, 0.5))
        below = next((i for i, a in enumerate(angles) if over(a) < 0.0), 0)
        found.append(float(brentq(over, angles[below - 1], angles[below])) if below else math.nan)
    return found[0], found[1]
