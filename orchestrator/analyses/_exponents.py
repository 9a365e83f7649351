"""Lyapunov exponents of the slider-crank: of one motion, and the largest over two parameters."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from models.slider_crank.motions.maps import exponent_map

from ..plots.motion import LABELS, create_figure, draw_cells, drop_varied
from ..plots.style import ACCENT, COUPLED, REFERENCE
from ._machine import (
    MACHINE,
    START,
    build_machine,
    column,
    declare_axis,
    declare_duration,
    read_axis,
    read_coordinate,
    report_mistakes,
    show_points,
    simulate_motion,
)
from .protocol import Analysis, Result, declare

# Windows of the table at most.
WINDOWS = 200


def evaluate(values: Mapping[str, Any]) -> dict[str, float | str]:
    found = simulate_motion(values).exponents(values["cycles"])
    slides = math.isinf(found.largest)
    return {
        "largest": found.largest,
        "second": found.second,
        "uncertainty": found.uncertainty,
        "sum_rule_error": 0.0 if slides else found.largest + found.second - found.exact_sum,
        "impacts_per_cycle": found.impacts_per_cycle,
        "motion": "slides" if slides else "bounces",
    }


def tabulate_windows(values: Mapping[str, Any]) -> xarray.Dataset:
    """The results, and both exponents of windows that follow one another."""
    cycles = values["cycles"]
    growths, _, length = simulate_motion(values).growths(cycles, min(WINDOWS, cycles))
    local = np.where(np.isfinite(growths), growths, -np.inf) / (2.0 * math.pi * length)
    meaning = f"over {length} cycles; -inf: slides"
    return xarray.Dataset(
        {
            "largest_in_window": column("window", local[:, 0], "1/rad", f"largest {meaning}"),
            "second_in_window": column("window", local[:, 1], "1/rad", f"second {meaning}"),
            "window_end": column("window", length * np.arange(1.0, len(local) + 1.0), "1", "cycles so far"),
            **evaluate(values),
        }
    )


def plot_exponents(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """`data` has largest_in_window, second_in_window and window_end (window), largest and uncertainty."""
    figure, axes = create_figure("Lyapunov exponents", values, width=6.8, height=3.4)
    end = data["window_end"].values
    slides = np.isneginf(data["largest_in_window"].values)
    axes.axhline(0.0, color="0.4", lw=0.7)
    for name, colour in (("largest", COUPLED), ("second", REFERENCE)):
        local = data[f"{name}_in_window"].values
        axes.plot(
            end, np.where(slides, np.nan, local), ".", ms=3.0, alpha=0.5, color=colour,
            label="" if slides.all() else f"{name}, each window",
        )  # fmt: skip
        if not slides.any():
            mean = np.cumsum(local) / np.arange(1, len(local) + 1)
            axes.plot(end, mean, color=colour, lw=1.3, label=f"{name}, mean so far")
    if slides.any():
        axes.plot(
            end[slides], np.full(slides.sum(), 0.03), ls="", marker="|", ms=5, color=ACCENT,
            transform=axes.get_xaxis_transform(), label="windows in which it slides: −∞",
        )  # fmt: skip
        axes.set_yticks(axes.get_yticks() if not slides.all() else [])
    else:
        largest, error = data["largest"].item(), data["uncertainty"].item()
        axes.axhspan(
            largest - error,
            largest + error,
            color=COUPLED,
            alpha=0.25,
            lw=0.0,
            label="result ± standard error",
        )
    axes.set_xlim(0.0, end[-1])
    axes.set_xlabel("cycles")
    axes.set_ylabel("Lyapunov exponent (1/rad)")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2)
    return figure


EXPONENTS = Analysis(
    name="exponents",
    description="Lyapunov exponents of the slider-crank with clearance",
    parameters={**MACHINE, **START, **declare_duration(2000, 200)},
    results={
        "largest": Result("1/rad", "largest Lyapunov exponent per crank angle; -inf: slides"),
        "second": Result("1/rad", "second Lyapunov exponent per crank angle; -inf: slides"),
        "uncertainty": Result("1/rad", "standard error of the largest"),
        "sum_rule_error": Result(
            "1/rad", "sum of the exponents less -lambda/a + 2 N ln e/(2 pi), N impacts a cycle"
        ),
        "impacts_per_cycle": Result("1", "impacts per crank cycle"),
        "motion": Result("1", "slides (its memory ends) or bounces", text=True),
    },
    evaluate=evaluate,
    table=tabulate_windows,
    draw=plot_exponents,
)


def tabulate_map(values: Mapping[str, Any]) -> xarray.Dataset:
    machine, x, y = build_machine(values), read_axis(values, "x"), read_axis(values, "y")
    length = values["cycles"], values["transient"]
    with report_mistakes():
        found = exponent_map(machine, x, y, *length, progress=show_points)
    return xarray.Dataset(
        {
            "largest": column(("y", "x"), found.largest, "1/rad", "largest exponent, -inf: slides"),
            "uncertainty": column(("y", "x"), found.uncertainty, "1/rad", "its standard error"),
            "impacts_per_cycle": column(("y", "x"), found.impacts_per_cycle, "1", "impacts per cycle"),
            "chaotic_share": float(np.mean(found.largest > 3.0 * found.uncertainty)),
            "sliding_share": float(np.mean(np.isneginf(found.largest))),
            "highest": float(found.largest.max()),
        },
        coords={"x": read_coordinate(values, "x"), "y": read_coordinate(values, "y")},
    )


SLIDING = "#b4bac1"


def plot_exponent_map(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """`data` has largest (y, x), -inf where the motion slides, over x and y."""
    title, shown = "Largest Lyapunov exponent", drop_varied(values, "x", "y")
    figure, axes = create_figure(title, shown, width=6.4, height=4.6)
    found = data["largest"].values
    finite = found[np.isfinite(found)]
    limit = float(np.abs(finite).max()) if finite.size else 1.0
    axes.set_facecolor(SLIDING)
    bar = draw_cells(
        figure, axes, data["x"].values, data["y"].values, np.ma.masked_invalid(found),
        cmap="RdBu_r", vmin=-limit, vmax=limit,
    )  # fmt: skip
    bar.set_label("largest Lyapunov exponent (1/rad)")
    bar.outline.set_visible(False)
    axes.set_xlabel(LABELS[values["x"]])
    axes.set_ylabel(LABELS[values["y"]])
    if finite.size < found.size:
        figure.legend(
            handles=[Patch(color=SLIDING, label="slides (−∞)")],
            loc="upper right",
            bbox_to_anchor=(0.995, 1.0),
        )
    return figure


EXPONENT_MAP = declare(
    name="exponent_map",
    description="Largest Lyapunov exponent over two parameters, every point from rest in the middle",
    parameters={
        **MACHINE,
        **declare_axis("x", "damping", 0.01, 0.25, 60),
        **declare_axis("y", "gap", 0.005, 0.02, 60),
        **declare_duration(1000, 200),
    },
    results={
        "chaotic_share": Result("1", "part of the points with an exponent 3 standard errors above 0"),
        "sliding_share": Result("1", "part of the points whose motion slides"),
        "highest": Result("1/rad", "highest of the largest exponents"),
    },
    table=tabulate_map,
    draw=plot_exponent_map,
)
