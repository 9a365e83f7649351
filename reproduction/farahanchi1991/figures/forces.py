"""F's figures of chapters 2 and 3."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator, ScalarFormatter

from models.slider_crank.flight.bouncing import LOWER, UPPER
from models.slider_crank.motions.machine import Machine
from models.slider_crank.motions.portrait import portrait, wall_angles
from models.slider_crank.motions.regions import TURN, thresholds, wall_forces
from orchestrator.plots.motion.angles import shift_to_first_turn
from orchestrator.plots.motion.force import draw_force
from orchestrator.plots.motion.regions import draw_regions
from orchestrator.plots.motion.titles import add_legend
from orchestrator.plots.motion.trace import draw_walls
from orchestrator.plots.style import COUPLED, MUTED, create_subplots

from ..cases import CORRECTED, FORMS, Case
from ..forces import find_changes
from ..runs import Runs
from .picture import LABELS, Picture, caption, note

THETA = np.linspace(0.0, TURN, 1441)
# Half the width of a window around a crossing (rad).
BLOW_UP = 0.2
LARGEST_GAP, DAMPINGS = 0.02, (0.0, 0.4)


def plot_constraint(runs: Runs, picture: Picture) -> Figure:
    """Figs 2.4 to 2.7 and 2.9."""
    figure, axes = picture.frame(7.4, 2.9, [list(FORMS)], sharey=True)
    for form in FORMS:
        machine = Machine(picture.shown.damping, picture.shown.gap, form=form)
        upper, lower = (wall_forces(machine, side, THETA) for side in (UPPER, LOWER))
        draw_force(axes[form], THETA, upper, lower, label=form != CORRECTED)
        caption(axes[form], f"{LABELS[form]}: {_changes(machine)}")
    add_legend(figure, axes[CORRECTED])
    return figure


def _changes(machine: Machine) -> str:
    count = len(find_changes(machine, UPPER))
    return f"{count} changes of sign, upper wall" if count else "upper wall throughout"


def plot_blow_up(runs: Runs, picture: Picture) -> Figure:
    """Fig 2.8: where the forces cross, in windows of equal width."""
    figure, axes = picture.frame(7.4, 4.6, [[f"{form} {n}" for n in range(2)] for form in FORMS])
    for form in FORMS:
        machine = Machine(picture.shown.damping, picture.shown.gap, form=form)
        pairs = list(zip(find_changes(machine, UPPER), find_changes(machine, LOWER), strict=True))[:2]
        for n, (a, b) in enumerate(pairs):
            ax, middle = axes[f"{form} {n}"], 0.5 * (a + b)
            theta = np.linspace(middle - BLOW_UP, middle + BLOW_UP, 201)
            upper, lower = (wall_forces(machine, side, theta) for side in (UPPER, LOWER))
            draw_force(ax, theta, upper, lower, (theta[0], theta[-1]), label=n == 0)
            _plain_ticks(ax)
            inside = wall_forces(machine, UPPER, np.array([middle]))[0] > 0.0
            caption(
                ax,
                f"{LABELS[form]}: {'either' if inside else 'neither'} wall, {min(a, b):.3f}-{max(a, b):.3f}",
            )
    add_legend(figure, axes[f"{CORRECTED} 0"])
    return figure


def _plain_ticks(ax: Axes) -> None:
    ax.xaxis.set_major_locator(MultipleLocator(0.1))
    ax.xaxis.set_major_formatter(ScalarFormatter(useOffset=False))


def plot_regions(runs: Runs, picture: Picture) -> Figure:
    """Fig 2.10."""
    figure, axes = picture.frame(7.4, 4.8, [[form] for form in FORMS], sharex=True)
    gaps = np.linspace(0.0, LARGEST_GAP, 21)
    for form in FORMS:
        found = [thresholds(Machine(gap=float(gap), form=form)) for gap in gaps]
        upper, lower = (np.array(values) for values in zip(*found, strict=True))
        draw_regions(axes[form], gaps, upper, lower, DAMPINGS)
        caption(axes[form], f"{LABELS[form]}: λ = {upper[0]:.4f} as ρ → 0")
    return figure


def plot_walls(runs: Runs, picture: Picture) -> Figure:
    """Fig 2.2."""
    figure, ax = create_subplots(figsize=(5.4, 2.6))
    picture.head(figure)
    machine = Machine(0.05, 0.01, form="as_published")
    theta = np.linspace(0.0, TURN, 361)
    upper, lower = (wall_angles(machine, side, theta) for side in (UPPER, LOWER))
    draw_walls(ax, theta, upper, lower)
    ax.fill_between(theta, 1e3 * lower, 1e3 * upper, color=COUPLED, alpha=0.1, lw=0.0)
    ax.set_xlim(0.0, TURN)
    ax.set_xlabel("crank angle θ (rad)")
    ax.set_ylabel("ψ (mrad)")
    note(ax, "ρ = 0.01: flight between ±ρ/Λ", y=0.6)
    return figure


def plot_extended_phase_space(runs: Runs, picture: Picture) -> Figure:
    """Fig 3.1."""
    figure = Figure(figsize=(6.2, 4.8))
    picture.head(figure)
    ax = figure.add_subplot(projection="3d")
    case = Case(0.05, 0.01)
    motion = portrait(runs.motion(case), 1)
    theta = np.linspace(0.0, TURN, 37)
    for side in (UPPER, LOWER):
        wall = 1e3 * wall_angles(case.machine, side, theta)
        rates = np.array([-0.15, 0.15])
        ax.plot_surface(
            np.tile(theta, (2, 1)), np.tile(wall, (2, 1)), np.tile(rates[:, None], (1, theta.size)),
            color=MUTED, alpha=0.25, linewidth=0.0,
        )  # fmt: skip
    ax.plot(shift_to_first_turn(motion.theta), 1e3 * motion.psi, motion.psi_rate, lw=1.0, color=COUPLED)
    ax.set_xlabel("crank angle θ (rad)")
    ax.set_ylabel("ψ (mrad)")
    ax.set_zlabel("ψ′")
    ax.set_box_aspect(None, zoom=0.8)
    return figure
