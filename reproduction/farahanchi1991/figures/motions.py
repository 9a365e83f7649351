"""F's time traces, phase portrait and Poincare maps."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from models.slider_crank.flight.bouncing import UPPER
from models.slider_crank.motions.portrait import portrait
from orchestrator.plots.motion.phase import draw_phase
from orchestrator.plots.motion.poincare import draw_poincare, magnify
from orchestrator.plots.motion.titles import add_legend
from orchestrator.plots.motion.trace import draw_trace
from orchestrator.plots.style import REFERENCE

from ..cases import CORRECTED, FORMS, PUBLISHED, TRANSIENT, Case
from ..impacts import select_wall
from ..runs import NARROW, Runs
from .picture import LABELS, Picture, caption, note

# F's 3000 cycles show the first magnification; the second needs more points.
MAGNIFIED_CYCLES = 60_000
CENTRE, BY = (1.0, 0.06), 6.0
# Points of a chattering motion beyond this are drawn on each other.
POINTS = 60_000
# Cycles of an orbit whose impacts can be told apart.
SHORT = 10


def plot_trace(runs: Runs, picture: Picture, cycles: int = 3, after: int = TRANSIENT) -> Figure:
    """Figs 4.1, 4.35, 4.42 to 4.44."""
    figure, axes = picture.frame(7.4, 3.9, [[form] for form in FORMS], sharex=True, sharey=True)
    for form in FORMS:
        motion = portrait(runs.motion(picture.shown.in_form(form), after), cycles)
        draw_trace(axes[form], motion.theta, motion.psi, motion.side, motion.upper, motion.lower)
        caption(axes[form], f"{LABELS[form]}, after {after} cycles")
    axes[PUBLISHED].set_xlabel("")
    # One panel may have sliding and the other none.
    add_legend(figure, max(axes.values(), key=lambda ax: len(ax.get_legend_handles_labels()[1])))
    return figure


def plot_phase(runs: Runs, picture: Picture) -> Figure:
    """Fig 4.2."""
    figure, axes = picture.frame(7.4, 3.4, [list(FORMS)], sharey=True)
    for form in FORMS:
        motion = portrait(runs.motion(picture.shown.in_form(form), 25), 2)
        walls = (float(motion.upper.min()), float(motion.upper.max()))
        draw_phase(axes[form], motion.theta, motion.psi, motion.psi_rate, motion.side, walls)
        caption(axes[form], LABELS[form])
    axes[CORRECTED].set_ylabel("")
    return figure


def plot_poincare(runs: Runs, picture: Picture) -> Figure:
    """Figs 4.3, 4.15, 4.18, 4.21, 4.33, 4.34, 4.36 to 4.39."""
    figure, axes = picture.frame(7.4, 3.3, [list(FORMS)], sharey=True)
    for form in FORMS:
        case = picture.shown.in_form(form)
        upper = select_wall(runs.events(case), UPPER)
        theta, rate = upper.theta[-POINTS:], upper.rate[-POINTS:]
        draw_poincare(axes[form], theta, rate, label=form == PUBLISHED)
        _mark_orbit(axes[form], runs, case)
        axes[form].set_xlabel("crank angle θ (rad)")
        caption(axes[form], f"{LABELS[form]}: {describe(runs, case)}")
        if not len(theta):
            note(axes[form], "no impacts: at rest on the upper wall", 0.03)
    return figure


def _mark_orbit(ax: Axes, runs: Runs, case: Case) -> None:
    """The upper impacts of a short orbit on which a transient has ended."""
    kind = runs.kind(case)
    if not (0 < kind.period <= SHORT and kind.transient > TRANSIENT):
        return
    upper = select_wall(runs.events(case), UPPER)
    last = upper.where(upper.cycle > upper.cycle.max() - kind.period)
    ax.scatter(last.theta, last.rate, s=22.0, color=REFERENCE, zorder=3, label="in the end")
    ax.legend(loc="upper right", handletextpad=0.1)


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


def plot_magnification(runs: Runs, picture: Picture, level: int) -> Figure:
    """Figs 4.4 and 4.5: the window, and where it lies; as published only, see the table."""
    upper = select_wall(runs.events(picture.shown, MAGNIFIED_CYCLES), UPPER)
    theta, rate = upper.theta, upper.rate
    window = magnify(theta, rate, CENTRE, BY**level)
    whole = magnify(theta, rate, CENTRE, BY ** (level - 1)) if level > 1 else None
    figure, axes = picture.frame(7.4, 3.3, [["whole", "part"]], form=LABELS[PUBLISHED])
    draw_poincare(axes["whole"], theta, rate, whole, marks=[window])
    draw_poincare(axes["part"], theta, rate, window)
    caption(axes["whole"], f"× {BY ** (level - 1):g}")
    caption(axes["part"], f"× {BY**level:g}")
    axes["part"].set_ylabel("")
    return figure
