"""The cam's contact as a finite line through the cycle, instant by instant in its steady film."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure

from models.contact.analysis.finite_line.contact import FiniteLine, Running
from models.contact.analysis.finite_line.cycle import Passage, passage
from models.contact.analysis.line.line_contact import LineContact
from models.contact.analysis.line.steady import LineContactError, solve_steady
from models.contact.hertz import ELASTIC_LIMIT, maximum_pressure
from models.core.quantities import Vector
from models.core.system import ModelError

from ..errors import MistakeError
from ..plots.finite_line import COLORS, MPA, UM
from ..plots.style import MUTED, add_title, create_subplots
from ._progress import show_progress
from ._table import column
from ._tappet import (
    ALIGNMENTS,
    DRY,
    PARAMETERS,
    build_finite_line,
    compute_running,
    describe_yielding,
    read_resolution,
)
from .protocol import Analysis, Parameter, Result

# Results of a passage in the table, with unit and meaning.
SHOWN = {
    "largest_pressure": ("Pa", "largest pressure"),
    "end_pressure": ("Pa", "largest pressure within a tenth of the length from the ends"),
    "middle_pressure": ("Pa", "largest pressure in the middle of the length"),
    "smallest_film": ("m", "smallest film"),
    "end_film": ("m", "smallest film within a tenth of the length from the ends"),
    "middle_film": ("m", "smallest film in the middle of the length"),
}
NOSE = math.pi


def _list_angles(values: Mapping[str, Any]) -> Vector:
    """From `start` to the nose; the cycle is symmetric about it."""
    return np.linspace(values["start"], NOSE, values["instants"])


def _compute_passage(
    kind: str, values: Mapping[str, Any], share: float, shown: Callable[[int, int], None]
) -> tuple[FiniteLine, list[Running], Passage]:
    """The contact, its instants and the films; MistakeError for a parameter that is none."""
    try:
        contact = build_finite_line(kind, values, compute_running(NOSE, values, 0.0))
        contact.profile.drop(np.zeros(1), contact.length)  # a profile that the length has no room for
        at = [compute_running(angle, values, share) for angle in _list_angles(values)]
        found = passage(
            contact,
            list(_list_angles(values)),
            [each.load for each in at],
            [each.velocity for each in at],
            [each.radius for each in at],
            [each.misalignment for each in at],
            read_resolution(values),
            shown,
        )
    except ModelError as error:
        raise MistakeError(str(error)) from None
    if not np.any(np.isfinite(found.largest_pressure)):
        raise MistakeError(f"{kind}: no instant has a solution; the first says {found.messages[0]}")
    if not np.any(found.smallest_film > 0.0):
        raise MistakeError(f"speed = {values['speed']:g} rad/s: no instant has a film; raise it")
    return contact, at, found


def _compute_line_contact(contact: FiniteLine, at: Running) -> tuple[float, float]:
    """Largest pressure and smallest film of the line contact under the same load; at rest dry."""
    hertz = maximum_pressure(at.load, at.radius, contact.length, contact.compliance)
    try:
        line = LineContact(at.load, at.velocity, at.radius, contact.length, contact.compliance, contact.fluid)
        found = solve_steady(line)
    except (ValueError, LineContactError):  # entrainment that is zero, or all but
        return hertz, 0.0
    return found.maximum_pressure, found.minimum_film


def _list_warnings(found: Passage, pressure: Vector) -> Iterator[str]:
    """Warnings about the result; `pressure`: where there is a film."""
    degrees = np.degrees(found.angle)
    if np.any(found.dry):
        angles = ", ".join(f"{angle:.4g}" for angle in degrees[found.dry])
        yield f"{angles} deg: {DRY}, and left out of these results"
    highest = int(np.nanargmax(pressure))
    if fault := describe_yielding(pressure[highest]):
        yield f"{degrees[highest]:.4g} deg: {fault}"
    yield from found.messages


def _collect_results(
    values: Mapping[str, Any], at: list[Running], found: Passage, line: Vector
) -> dict[str, float | str]:
    """Results of the chosen profile, without dry instants, whose peaks at sharp ends depend on the grid."""
    pressure = np.where(found.dry, np.nan, found.largest_pressure)
    ratio = pressure / line[:, 0]
    highest, farthest = int(np.nanargmax(pressure)), int(np.nanargmax(ratio))
    slope = max(abs(each.misalignment) for each in at)
    tilt = f"misaligned by up to {1e3 * slope:.2g} mrad" if slope > 0.0 else "aligned"
    return {
        "curve": f"{values['profile']}, {tilt}",
        "largest_pressure_of_cycle": float(pressure[highest]),
        "at_angle": float(np.degrees(found.angle[highest])),
        "largest_ratio": float(ratio[farthest]),
        "ratio_at_angle": float(np.degrees(found.angle[farthest])),
        "nose_end_pressure": float(found.end_pressure[-1]),
        "nose_end_film": float(found.end_film[-1]),
        "nose_middle_film": float(found.middle_film[-1]),
        "nose_line_film": float(line[-1, 1]),
        "not_found": int(np.count_nonzero(np.isnan(found.largest_pressure))),
        "dry": int(np.count_nonzero(found.dry)),
        "messages": "; ".join(_list_warnings(found, pressure)),
    }


def evaluate(values: Mapping[str, Any]) -> dict[str, float | str]:
    with show_progress("finite line through the cycle") as shown:
        contact, at, found = _compute_passage(values["profile"], values, values["alignment"], shown)
    line = np.array([_compute_line_contact(contact, each) for each in at])
    return _collect_results(values, at, found, line)


def build_table(values: Mapping[str, Any]) -> xarray.Dataset:
    """Over cam angle, aligned and misaligned: the straight tappet and the chosen profile (the logarithmic
    one where that is straight), and the line contact."""
    # The chosen profile first: a mistake in it shows at once.
    kinds = ("straight", values["profile"] if values["profile"] != "straight" else "logarithmic")
    shares = {"aligned": 0.0, "misaligned": values["alignment"]}
    total = len(kinds) * len(set(shares.values())) * values["instants"]
    found: dict[tuple[str, float], tuple[FiniteLine, list[Running], Passage]] = {}
    with show_progress("finite line through the cycle") as shown:
        for kind in reversed(kinds):
            for share in set(shares.values()):
                before = len(found) * values["instants"]

                def show(done: int, _: int, before: int = before) -> None:
                    shown(before + done, total)

                found[kind, share] = _compute_passage(kind, values, share, show)
    contact, at, chosen = found[values["profile"], values["alignment"]]
    line = np.array([_compute_line_contact(contact, each) for each in at])
    over = ("kind", "aligned", "angle")
    return xarray.Dataset(
        {
            **{
                name: column(
                    over,
                    [[getattr(found[kind, share][2], name) for share in shares.values()] for kind in kinds],
                    unit,
                    meaning,
                )
                for name, (unit, meaning) in SHOWN.items()
            },
            "line_pressure": column("angle", line[:, 0], "Pa", "largest pressure of the line contact"),
            "line_film": column("angle", line[:, 1], "m", "smallest film of the line contact"),
            "slope": column("angle", [each.misalignment for each in at], "rad", "misalignment"),
            **_collect_results(values, at, chosen, line),
        },
        coords={
            "angle": column("angle", _list_angles(values), "rad", "cam angle, nose at pi"),
            "kind": column("kind", list(kinds), "1", "axial profile"),
            "aligned": column("aligned", list(ALIGNMENTS), "1", "alignment of the shaft"),
        },
    )


STYLES = {"aligned": "-", "misaligned": "--"}
# Films are shown down to this share of the largest: at reversals steady ones vanish.
LEAST_SHOWN = 1e-2


def draw_finite_line_cycle(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """Largest pressure, its ratio to the line contact's, films at the ends and in the middle."""
    figure, axes = create_subplots(2, 2, sharex=True, figsize=(10.0, 6.4))
    rpm = values["speed"] * 30.0 / math.pi
    slope = 1e3 * float(np.max(np.abs(data["slope"].values)))
    add_title(
        figure, f"Finite line through the cycle at {rpm:.0f} r/min, quasi-static; up to {slope:.2g} mrad"
    )
    angle = np.degrees(data["angle"].values)
    shown = [name for name in data["aligned"].values if name == "aligned" or values["alignment"] > 0.0]
    for kind in data["kind"].values:
        for name in shown:
            one = data.sel(kind=kind, aligned=name)
            style = {"color": COLORS[str(kind)], "ls": STYLES[str(name)], "label": f"{kind}, {name}"}
            # Dry, the peak at a sharp end is the grid's.
            pressure = np.where(one["smallest_film"].values == 0.0, np.nan, one["largest_pressure"].values)
            axes[0, 0].plot(angle, MPA * pressure, **style)
            axes[0, 1].plot(angle, pressure / data["line_pressure"].values, **style)
            axes[1, 0].plot(angle, _above_zero(one["end_film"].values), **style)
            axes[1, 1].plot(angle, _above_zero(one["middle_film"].values), **style)
    line = {"color": "black", "lw": 0.8, "ls": ":", "label": "line contact"}
    axes[0, 0].plot(angle, MPA * data["line_pressure"].values, **line)
    limit = {"color": "black", "lw": 0.8, "ls": "-.", "label": "elastic limit"}
    axes[0, 0].axhline(MPA * ELASTIC_LIMIT, **limit)
    dry = angle[np.any(data["smallest_film"].values == 0.0, axis=(0, 1))]
    for each in axes.flat:
        for k, reversal in enumerate(dry):
            each.axvline(reversal, color=MUTED, lw=0.8, label="" if k else "reversal: dry, no film")
    for each in axes[1]:
        each.plot(angle, _above_zero(data["line_film"].values), **line)
        each.set_yscale("log")
        each.set_ylim(UM * LEAST_SHOWN * float(np.max(data["line_film"].values)), None)
        each.set_xlabel("cam angle (degrees)")
    axes[1, 0].sharey(axes[1, 1])
    titles = (
        "Largest pressure (MPa)", "Largest pressure over the line contact's",
        "Smallest film at the ends (µm)", "Smallest film in the middle (µm)",
    )  # fmt: skip
    for each, title in zip(axes.flat, titles, strict=True):
        each.set_title(title, loc="left")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 5))
    return figure


def _above_zero(film: np.ndarray[Any, np.dtype[np.float64]]) -> np.ndarray[Any, np.dtype[np.float64]]:
    """In µm, without the zeros of the reversals, which a logarithmic axis cannot show."""
    return UM * np.where(film > 1e-9, film, np.nan)


ANALYSIS = Analysis(
    name="finite_line_cycle",
    description="The cam's contact as a finite line through the cycle, quasi-static: end peaks and end films",
    parameters={
        **PARAMETERS,
        "start": Parameter(math.radians(90.0), "rad", "first cam angle", minimum=0.0, maximum=3.1),
        "instants": Parameter(46, "1", "instants up to the nose", minimum=2, integer=True),
        "nodes_per_half_width": Parameter(12.0, "1", "nodes along x per half width", positive=True),
    },
    results={
        "curve": Result("1", "which curve of the figure these results are of", text=True),
        "largest_pressure_of_cycle": Result("Pa", "largest pressure where there is a film"),
        "at_angle": Result("deg", "cam angle of it"),
        "largest_ratio": Result("1", "largest pressure over the line contact's, where there is a film"),
        "ratio_at_angle": Result("deg", "cam angle of it"),
        "nose_end_pressure": Result(
            "Pa", "largest pressure within a tenth of the length from the ends, nose"
        ),
        "nose_end_film": Result("m", "smallest film there, nose"),
        "nose_middle_film": Result("m", "smallest film in the middle of the length, nose"),
        "nose_line_film": Result("m", "smallest film of the line contact, nose"),
        "not_found": Result("1", "instants without a solution"),
        "dry": Result("1", "instants without entrainment, taken as dry, which are not in these results"),
        "messages": Result("1", "what is not to be trusted, by cam angle", text=True),
    },
    evaluate=evaluate,
    table=build_table,
    draw=draw_finite_line_cycle,
)
