"""How F's figures are drawn: a panel for each form of the equations."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import MultipleLocator, ScalarFormatter

from models.slider_crank.equations import THESIS_XI
from models.slider_crank.flight.bouncing import LOWER, UPPER
from models.slider_crank.motions.machine import Machine
from models.slider_crank.motions.portrait import trace_portrait, wall_angles
from models.slider_crank.motions.regions import TURN, thresholds, wall_forces
from models.slider_crank.motions.statistics import approach_velocities, impact_profile, impact_spectrum
from orchestrator.analyses._distribution import draw_profile, draw_spectrum
from orchestrator.analyses._motion import draw_phase, draw_trace, draw_walls
from orchestrator.analyses.force import draw_force
from orchestrator.analyses.poincare import draw_poincare, magnify
from orchestrator.analyses.regions import draw_regions
from orchestrator.plots.motion import add_legend, create_figure, shift_to_first_turn
from orchestrator.plots.style import ACCENT, COUPLED, MUTED, REFERENCE, TITLE, create_subplots

from .force import find_changes
from .impacts import select_wall
from .runs import CORRECTED, CYCLES, FORMS, NARROW, PUBLISHED, TRANSIENT, Case, Runs

LABELS = dict(zip(FORMS, ("as published", "corrected"), strict=True))
BOTH = "as published and corrected"
INK = "#333c46"
# What file names leave out or spell otherwise.
PLAIN = str.maketrans({"é": "e", "ψ": "psi", ",": None})
EXAMPLE = Case(0.05, 0.01)
# Half the width of a window around a crossing (rad).
BLOW_UP = 0.2
LARGEST_GAP, DAMPINGS = 0.02, (0.0, 0.4)
PROFILE_BINS, SPECTRUM_BINS = 100, 120
# The damping that F's text gives for Figs 4.40 and 4.41, whose captions differ.
TEXT_DAMPING = 0.05
# F's 3000 cycles show the first magnification; the second needs more points.
MAGNIFIED_CYCLES = 60_000
CENTRE, BY = (1.0, 0.06), 6.0
# More points of a chattering motion are drawn on each other.
POINTS = 60_000
# The impacts of longer orbits cannot be told apart.
SHORT = 10


@dataclass(frozen=True)
class Picture:
    """A figure of F.

    `number`: F's, "4.6". `title`: F's caption without its parameters. `case`: None where it shows none.
    """

    number: str
    title: str
    plot: Callable[..., Figure]
    case: Case | None = None

    @property
    def file(self) -> str:
        chapter, figure = self.number.split(".")
        words = self.title.lower().translate(PLAIN).split()
        name = f"fig-{chapter}.{int(figure):02d}-{'-'.join(words)}"
        if self.case:
            name += f"-lambda-{self.case.damping:.3f}-rho-{self.case.gap:.3f}"
            if self.case.restitution != 0.9:
                name += f"-e-{self.case.restitution:.1f}"
        return f"farahanchi1991-{name}.png"

    @property
    def heading(self) -> str:
        return f"Fig. {self.number}  {self.title}"

    def show(self, form: str) -> Case:
        """The case in one form; of a figure without a case, any."""
        return (self.case or EXAMPLE).in_form(form)

    def frame(self, height: float, mosaic: object, form: str = BOTH, **more: Any) -> tuple[Figure, Any]:
        """Figure and its axes by name; the title has F's number and the parameters."""
        values: dict[str, object] = {"form": form}
        if self.case:
            values |= {name: getattr(self.case, name) for name in ("damping", "gap", "restitution")}
        return create_figure(
            self.heading, values, **{"width": 7.4, "height": height, "mosaic": mosaic, **more}
        )


@dataclass(frozen=True)
class Panels:
    """Plots a panel for each form, side by side or stacked.

    `draw` returns what the panel's caption says after the form's name; None where it has written its own.
    """

    draw: Callable[[Axes, Runs, Case], str | None]
    height: float
    stacked: bool = False
    sharey: bool = False
    legend: bool = False
    polar: bool = False

    def __call__(self, runs: Runs, picture: Picture) -> Figure:
        mosaic = [[form] for form in FORMS] if self.stacked else [list(FORMS)]
        more: dict[str, Any] = {"subplot_kw": {"projection": "polar"}} if self.polar else {}
        figure, axes = picture.frame(self.height, mosaic, sharex=self.stacked, sharey=self.sharey, **more)
        for form in FORMS:
            words = self.draw(axes[form], runs, picture.show(form))
            if words is not None:
                write_caption(axes[form], LABELS[form] + words)
        if self.legend:
            # One panel may have sliding and the other none.
            add_legend(figure, max(axes.values(), key=lambda ax: len(ax.get_legend_handles_labels()[1])))
        return figure


def write_caption(axes: Axes, text: str) -> None:
    """A panel's name above its left end."""
    axes.set_title(text, loc="left", fontsize=9, color=INK)


def write_note(axes: Axes, text: str, x: float = 0.985, y: float = 0.96) -> None:
    """A remark within a panel."""
    side = "right" if x > 0.5 else "left"
    box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 1.5}
    axes.text(x, y, text, transform=axes.transAxes, ha=side, va="top", fontsize=7.5, color=INK, bbox=box)


def describe(runs: Runs, case: Case) -> str:
    """What the motion is, in few words."""
    kind = runs.kind(case)
    if not runs.events(case).theta.size:
        return "permanent sliding"
    if not kind.period:
        if kind.slides:
            return "irregular, slides"
        period, width = runs.band(case)
        if width < NARROW:
            return f"chaotic within {100 * width:.1f} % of the gap of period {period}"
        return kind.kind
    words = f"period {kind.period}" + (" with sliding" if kind.slides else "")
    return f"{words} after {kind.transient} cycles" if kind.transient > TRANSIENT else words


def draw_constraint(axes: Axes, runs: Runs, case: Case) -> str:
    """Wall forces over the crank angle."""
    theta = np.linspace(0.0, TURN, 1441)
    upper, lower = (wall_forces(case.machine, side, theta) for side in (UPPER, LOWER))
    draw_force(axes, theta, upper, lower, label=case.form == PUBLISHED)
    count = len(find_changes(case.machine, UPPER))
    return f": {count} changes of sign, upper wall" if count else ": upper wall throughout"


def draw_sliding_regions(axes: Axes, runs: Runs, case: Case) -> str:
    """Where a wall holds the roller throughout, over gap and damping."""
    gaps = np.linspace(0.0, LARGEST_GAP, 21)
    found = [thresholds(Machine(gap=float(gap), form=case.form)) for gap in gaps]
    upper, lower = (np.array(values) for values in zip(*found, strict=True))
    draw_regions(axes, gaps, upper, lower, DAMPINGS)
    return f": λ = {upper[0]:.4f} as ρ → 0"


def draw_motion(axes: Axes, runs: Runs, case: Case, cycles: int = 3, after: int = TRANSIENT) -> str:
    """psi over the crank angle, between the walls."""
    motion = trace_portrait(runs.motion(case, after), cycles)
    draw_trace(axes, motion.theta, motion.psi, motion.side, motion.upper, motion.lower)
    if case.form == PUBLISHED:
        axes.set_xlabel("")
    return f", after {after} cycles"


def draw_phase_portrait(axes: Axes, runs: Runs, case: Case) -> str:
    motion = trace_portrait(runs.motion(case, 25), 2)
    walls = (float(motion.upper.min()), float(motion.upper.max()))
    draw_phase(axes, motion.theta, motion.psi, motion.psi_rate, motion.side, walls)
    if case.form == CORRECTED:
        axes.set_ylabel("")
    return ""


def draw_map(axes: Axes, runs: Runs, case: Case) -> str:
    """Poincare map of the upper impacts; those of a short orbit on which a transient ends are marked."""
    upper, kind = select_wall(runs.events(case), UPPER), runs.kind(case)
    draw_poincare(axes, upper.theta[-POINTS:], upper.rate[-POINTS:], label=case.form == PUBLISHED)
    if 0 < kind.period <= SHORT and kind.transient > TRANSIENT:
        last = upper.where(upper.cycle > upper.cycle.max() - kind.period)
        axes.scatter(last.theta, last.rate, s=22.0, color=REFERENCE, zorder=3, label="in the end")
        axes.legend(loc="upper right", handletextpad=0.1)
    axes.set_xlabel("crank angle θ (rad)")
    if not len(upper.theta):
        write_note(axes, "no impacts: at rest on the upper wall", 0.03)
    return f": {describe(runs, case)}"


def draw_impacts(axes: Axes, runs: Runs, case: Case) -> str:
    """Velocities of approach along the walls."""
    impacts = runs.events(case).impacts
    found = impact_profile(impacts, approach_velocities(impacts), THESIS_XI, PROFILE_BINS, CYCLES)
    draw_profile(axes, found.edges, found.upper, found.lower)
    axes.set_ylabel("velocities per cycle")
    if case.form == PUBLISHED:
        axes.set_xlabel("")
    count = len(impacts.theta) / CYCLES
    words = f"{count:.2f} impacts a cycle" if count else "no impacts: at rest on the upper wall"
    write_note(axes, words, 0.015)
    return f": {describe(runs, case)}"


def draw_directions(axes: Axes, runs: Runs, case: Case, side: float) -> None:
    """Velocities of approach around the revolution, of one wall."""
    impacts = runs.events(case).impacts
    found = impact_spectrum(impacts, approach_velocities(impacts), SPECTRUM_BINS, CYCLES)
    values, colour = (found.upper, COUPLED) if side == UPPER else (found.lower, ACCENT)
    draw_spectrum(cast(PolarAxes, axes), found.edges, values, colour)
    axes.set_title(f"{LABELS[case.form]}: {describe(runs, case)}", fontsize=9, pad=12.0, color=INK)


def plot_blow_up(runs: Runs, picture: Picture) -> Figure:
    """Where the forces cross, in windows of equal width."""
    figure, axes = picture.frame(4.6, [[f"{form} {n}" for n in range(2)] for form in FORMS])
    for form in FORMS:
        machine = picture.show(form).machine
        pairs = list(zip(find_changes(machine, UPPER), find_changes(machine, LOWER), strict=True))[:2]
        for n, (a, b) in enumerate(pairs):
            ax, middle = axes[f"{form} {n}"], 0.5 * (a + b)
            theta = np.linspace(middle - BLOW_UP, middle + BLOW_UP, 201)
            upper, lower = (wall_forces(machine, side, theta) for side in (UPPER, LOWER))
            draw_force(ax, theta, upper, lower, (theta[0], theta[-1]), label=n == 0)
            ax.xaxis.set_major_locator(MultipleLocator(0.1))
            ax.xaxis.set_major_formatter(ScalarFormatter(useOffset=False))
            wall = "either" if wall_forces(machine, UPPER, np.array([middle]))[0] > 0.0 else "neither"
            write_caption(ax, f"{LABELS[form]}: {wall} wall, {min(a, b):.3f}-{max(a, b):.3f}")
    add_legend(figure, ax)
    return figure


def plot_profile_of_two(runs: Runs, picture: Picture) -> Figure:
    """Profiles where F's caption and text differ in lambda."""
    figure, axes = picture.frame(
        4.1, [[f"{form} {name}" for name in ("caption", "text")] for form in FORMS], width=8.6,
        sharex=True, sharey=True,
    )  # fmt: skip
    for form in FORMS:
        case = picture.show(form)
        for name, shown in (("caption", case), ("text", replace(case, damping=TEXT_DAMPING))):
            ax = axes[f"{form} {name}"]
            words = draw_impacts(ax, runs, shown)
            write_caption(ax, f"{LABELS[form]}, λ = {shown.damping:g} (F's {name}){words}")
            if name == "text":
                ax.set_ylabel("")
    add_legend(figure, ax)
    return figure


def plot_magnification(runs: Runs, picture: Picture, level: int) -> Figure:
    """A window of the Poincare map, and where it lies; as published only."""
    upper = select_wall(runs.events(picture.show(PUBLISHED), MAGNIFIED_CYCLES), UPPER)
    theta, rate = upper.theta, upper.rate
    window = magnify(theta, rate, CENTRE, BY**level)
    whole = magnify(theta, rate, CENTRE, BY ** (level - 1)) if level > 1 else None
    figure, axes = picture.frame(3.3, [["whole", "part"]], form=LABELS[PUBLISHED])
    draw_poincare(axes["whole"], theta, rate, whole, marks=[window])
    draw_poincare(axes["part"], theta, rate, window)
    write_caption(axes["whole"], f"× {BY ** (level - 1):g}")
    write_caption(axes["part"], f"× {BY**level:g}")
    axes["part"].set_ylabel("")
    return figure


def plot_walls(runs: Runs, picture: Picture) -> Figure:
    """psi at the walls over the crank angle."""
    figure, ax = create_subplots(1, 1, picture.heading, (5.4, 2.6))
    theta = np.linspace(0.0, TURN, 361)
    upper, lower = (wall_angles(EXAMPLE.machine, side, theta) for side in (UPPER, LOWER))
    draw_walls(ax, theta, upper, lower)
    ax.fill_between(theta, 1e3 * lower, 1e3 * upper, color=COUPLED, alpha=0.1, lw=0.0)
    ax.set_xlim(0.0, TURN)
    ax.set_xlabel("crank angle θ (rad)")
    ax.set_ylabel("ψ (mrad)")
    write_note(ax, "ρ = 0.01: flight between ±ρ/Λ", y=0.6)
    return figure


def plot_extended_phase_space(runs: Runs, picture: Picture) -> Figure:
    """One cycle between the walls, over crank angle, psi and psi'."""
    figure = Figure(figsize=(6.2, 4.8))
    figure.suptitle(picture.heading, **TITLE)
    ax = figure.add_subplot(projection="3d")
    motion = trace_portrait(runs.motion(EXAMPLE), 1)
    theta = np.linspace(0.0, TURN, 37)
    for side in (UPPER, LOWER):
        wall = 1e3 * wall_angles(EXAMPLE.machine, side, theta)
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
