"""F's impact distribution patterns and impact spectra."""

from __future__ import annotations

from dataclasses import replace
from typing import cast

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes

from models.slider_crank.equations import THESIS_XI
from models.slider_crank.flight.bouncing import UPPER
from models.slider_crank.motions.statistics import (
    approach_velocities,
    impact_profile,
    impact_spectrum,
)
from orchestrator.plots.motion.distribution import draw_profile, draw_spectrum
from orchestrator.plots.motion.titles import add_legend
from orchestrator.plots.style import ACCENT, COUPLED

from ..cases import CYCLES, FORMS, PUBLISHED, Case
from ..runs import Runs
from .motions import describe
from .picture import INK, LABELS, Picture, caption, note

PROFILE_BINS, SPECTRUM_BINS = 100, 120
# F's Figs 4.40 and 4.41: by their captions, and by the text.
TEXT_DAMPING = 0.05


def plot_profile(runs: Runs, picture: Picture) -> Figure:
    """Figs 4.6 to 4.14 and 4.24 to 4.32."""
    figure, axes = picture.frame(7.4, 4.1, [[form] for form in FORMS], sharex=True, sharey=True)
    for form in FORMS:
        _profile(runs, axes[form], picture.shown.in_form(form), LABELS[form])
    axes[PUBLISHED].set_xlabel("")
    add_legend(figure, axes[PUBLISHED])
    return figure


def _profile(runs: Runs, ax: Axes, case: Case, words: str) -> None:
    impacts = runs.events(case).impacts
    found = impact_profile(impacts, approach_velocities(impacts), THESIS_XI, PROFILE_BINS, CYCLES)
    draw_profile(ax, found.edges, found.upper, found.lower)
    ax.set_ylabel("velocities per cycle")
    caption(ax, f"{words}: {describe(runs, case)}")
    count = len(impacts.theta) / CYCLES
    note(ax, f"{count:.2f} impacts a cycle" if count else "no impacts: at rest on the upper wall", 0.015)


def plot_profile_of_two(runs: Runs, picture: Picture) -> Figure:
    """Figs 4.40 and 4.41: caption and text differ in lambda."""
    words = {"caption": picture.shown, "text": replace(picture.shown, damping=TEXT_DAMPING)}
    mosaic = [[f"{form} {name}" for name in words] for form in FORMS]
    figure, axes = picture.frame(8.6, 4.1, mosaic, sharex=True, sharey=True)
    for form in FORMS:
        for name, case in words.items():
            ax = axes[f"{form} {name}"]
            _profile(runs, ax, case.in_form(form), f"{LABELS[form]}, λ = {case.damping:g} (F's {name})")
            if form == PUBLISHED:
                ax.set_xlabel("")
            if name == "text":
                ax.set_ylabel("")
    add_legend(figure, axes[f"{PUBLISHED} caption"])
    return figure


def plot_spectrum(runs: Runs, picture: Picture, side: float) -> Figure:
    """Figs 4.16, 4.17, 4.19, 4.20, 4.22, 4.23."""
    figure, axes = picture.frame(7.4, 4.1, [list(FORMS)], subplot_kw={"projection": "polar"})
    for form in FORMS:
        case = picture.shown.in_form(form)
        impacts = runs.events(case).impacts
        found = impact_spectrum(impacts, approach_velocities(impacts), SPECTRUM_BINS, CYCLES)
        values, colour = (found.upper, COUPLED) if side == UPPER else (found.lower, ACCENT)
        draw_spectrum(cast(PolarAxes, axes[form]), found.edges, values, colour)
        axes[form].set_title(f"{LABELS[form]}: {describe(runs, case)}", fontsize=9, pad=12.0, color=INK)
    return figure
