"""What is seen across the contact in the transient film: dimples, constriction, second pressure maximum."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import find_peaks

from models.core.quantities import Vector

from ..table import format_bullets
from .cam import CamCycle, Flags

MICRO, GIGA = 1e6, 1e-9
# A second maximum of the pressure counts where it rises so much of the highest above its surroundings.
PROMINENCE = 0.01


@dataclass(frozen=True)
class Dimple:
    """Where entrainment reverses: the thickest film between the constrictions on the left (x < 0) and
    right, and these (m); the highest pressure and Hertz's (Pa)."""

    angle_deg: float
    film: float
    left: float
    right: float
    pressure: float
    hertz_pressure: float


def find_dimples(c: CamCycle) -> list[Dimple]:
    """At each reversal."""
    found = []
    for angle in c.reversals_deg:
        k = int(np.argmin(np.abs(c.history_deg - angle)))
        film = c.history.film[k]
        middle = film.size // 2
        left, right = int(np.argmin(film[:middle])), middle + int(np.argmin(film[middle:]))
        hertz = float(c.hertz_pressure[c.at(angle)])
        found.append(
            Dimple(
                angle, float(film[left : right + 1].max()), float(film[left]), float(film[right]),
                float(c.history.maximum_pressure[k]), hertz,
            )
        )  # fmt: skip
    return found


def locate_constriction(c: CamCycle) -> Vector:
    """Where the film is least (m), over the angles of the history in the event."""
    history, inside = c.history, c.in_event
    least = np.argmin(history.film[inside], axis=1)
    return np.asarray(np.take_along_axis(history.x[inside], least[:, None], axis=1)[:, 0])


def find_second_maxima(c: CamCycle) -> Flags:
    """Whether the pressure has a second maximum, over the angles of the history in the event."""
    pressures = c.history.pressure[c.in_event]
    return np.array([find_peaks(p, prominence=PROMINENCE * p.max())[0].size > 1 for p in pressures])


def describe_field(c: CamCycle) -> str:
    """Markdown, with numbers of this cycle."""
    inside = c.in_event
    angle, highest = c.history_deg[inside], c.history.maximum_pressure[inside]
    found, k = find_dimples(c), int(np.argmax(highest))
    after = angle[k] - max(d.angle_deg for d in found if d.angle_deg <= angle[k])
    at_outlet = locate_constriction(c) * np.interp(angle, c.angle_deg, c.velocity) > 0.0
    second, part = find_second_maxima(c), np.searchsorted(c.reversals_deg, angle)
    flank, lobe, nose = (_percent(second[np.isin(part, parts)]) for parts in ((0, 4), (1, 3), (2,)))
    sentences = [
        f"Dimple: before entrainment reverses, what was the inlet closes too. At the four reversals oil of "
        f"up to {_span(MICRO, [d.film for d in found])} µm is trapped between constrictions of "
        f"{_constrictions(found)} µm, under {_span(GIGA, [d.pressure for d in found])} GPa, where Hertz's "
        f"pressure is {_span(GIGA, [d.hertz_pressure for d in found])} GPa. It moves with the bodies to the "
        f"new outlet.",
        f"Where it leaves, the pressure is highest in the event: {GIGA * highest[k]:.2f} GPa at "
        f"{angle[k]:.1f}°, {after:.1f}° after a reversal, in a narrow spike that the nodes do not resolve "
        f"(see the verdict on them below).",
        f"Constriction: the film is least on the outlet's side of the centre in {_percent(at_outlet)} of the "
        f"event; it changes sides with the entrainment, beginning before each reversal.",
        f"Second maximum of the pressure (Petrusevich's spike): in {lobe} of the angles between the first "
        f"two and the last two reversals, {nose} of those about the nose, {flank} on the flanks.",
    ]
    return f"At {c.speed_rpm:.0f} r/min:\n\n{format_bullets(sentences)}"


def _span(unit: float, values: list[float]) -> str:
    return f"{unit * min(values):.2f}-{unit * max(values):.2f}"


def _constrictions(found: list[Dimple]) -> str:
    return _span(MICRO, [film for d in found for film in (d.left, d.right)])


def _percent(flags: Flags) -> str:
    return f"{100.0 * np.mean(flags):.0f} %"
