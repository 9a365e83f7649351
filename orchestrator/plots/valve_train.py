"""A valve train for a design review: its motion in the first column, each of its contacts in one beside it.

Over the last whole revolution of the cam, in its degrees or the crank's; of several trains the one with the
highest load, the others pale. Where a contact carries no load, its column is shaded and has a gap, no film.
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from models.core import roles
from models.core.quantities import Quantity, Vector

from ..assessment.adjusters import ADJUSTER, describe_growth
from ..assessment.figures_of_merit import OPENED, VALVE
from ..assessment.friction.losses import describe_content, list_losses, name_outside
from ..assessment.lost_contact import LIGHT
from ..assessment.motion import Found, Part
from ..assessment.trains import OPEN, Angle, Train, find_kinematics
from .data import FigureData
from .style import (
    ACCENT,
    MUTED,
    create_subplots,
    label_abscissa,
    list_handles,
    plot_both,
    shade,
    shade_where,
    write_remark,
)

CONTACT = {
    "Load": "load",
    "Hertz pressure": "maximum_pressure",
    "Film thickness": "film_thickness",
    "Film ratio": "film_ratio",
    "Sliding velocity": "sliding_velocity",
    "Friction": "friction_force",
}
SLIDING = ("Sliding velocity", "Friction")
HYDRAULIC = {"Adjuster\nextension": "extension", "Adjuster\npressure": "pressure"}
PALE = "#c3ccd5"
# Which rows are drawn where there is no whole revolution.
WHOLE = "the whole run"
# Of another train's curve.
POINTS = 1500
SPRING, GAP = "train spring_force", "gap"
DERIVED = {SPRING: Quantity("N", "force of the springs"), GAP: Quantity("m", "gap", display_unit="um")}

# A column of panels: variables by their words.
Panels = Mapping[str, str]


def applies(data: FigureData) -> bool:
    return bool(data.trains)


def list_instances(data: FigureData) -> set[str]:
    """The instances that this figure draws."""
    return {part for train in data.trains for part in train.parts}


def draw(data: FigureData) -> Figure:
    train, *others = data.trains
    own, which = prepare(data, train)
    columns = list_columns(own, train)
    rows = max(map(len, columns))
    size = (0.6 + 4.4 * len(columns), 1.4 + 1.45 * rows)
    title = f"{data.title}: valve train of {train.cam}, {which}"
    figure, axes = create_subplots(rows, len(columns), title, size, sharex=True, squeeze=False)
    for other in others:
        _draw_pale(axes, columns, data, other)
    for column, panels in zip(axes.T, columns, strict=True):
        for ax, (words, name) in zip(column, panels.items(), strict=False):
            plot_both(ax, own, name, words)
        for ax in column[len(panels) :]:
            ax.set_visible(False)
        last = column[len(panels) - 1]
        label_abscissa(last, own)
        if which != WHOLE:
            last.set_xlim(0.0, math.degrees(find_period(own, train)))
        last.tick_params(labelbottom=True)
    for column, panels in zip(axes[:, 1:].T, columns[1:], strict=True):
        for ax, (words, name) in zip(column, panels.items(), strict=False):
            if words == "Film ratio":
                write_remark(ax, f"under more than {100.0 * LIGHT:g} % of the largest load")
            elif words == "Friction" and np.isnan(own.coupled[name]).any():
                write_remark(ax, "not at rest, where it has no sign")
    by_words = dict(zip(columns[0], axes[:, 0], strict=False))
    _add_kinematics(by_words, own, train)
    place = f" in {which.partition(' of ')[0]}" if which.startswith("revolution") else ""
    _add_margin(by_words["Spring force"], own, train, place)
    _magnify_seat(by_words["Lift, magnified"], own, train, place)
    _remark_adjuster(by_words, own, train, data, place)
    losses = [loss for loss in list_losses(train.system) if loss.part in train.parts]
    if losses and "Cam torque" in by_words:
        write_remark(by_words["Cam torque"], describe_content(name_outside(losses)))
    for ax in axes.flat:
        _show_zero(ax)
    _shade(axes, own, train)
    axes[0, 0].set_title(train.valve, loc="left")
    _add_legend(figure, axes, len(others))
    return figure


def prepare(data: FigureData, train: Train) -> tuple[FigureData, str]:
    """The rows of the cam's last whole revolution, without films of lost contacts, and which one it is.

    All rows where the cam turns less, or back. With the springs' force and the contacts' gaps.
    """
    over = data.angle if data.angle and data.angle.source in data.coupled else train.angle
    own = replace(_select(data, train, over), angle=over)
    angle = over.factor * data.coupled[over.source]
    turn = find_period(own, train)
    slack = turn * OPEN
    last = math.floor((angle[-1] + slack) / turn)
    count = last - math.ceil((angle[0] - slack) / turn)
    which = WHOLE
    if count > 0 and np.all(np.diff(angle) >= 0.0):
        own = own.between(over, turn * (last - 1), turn * last)
        which = f"revolution {count} of {count}" if count > 1 else "one revolution"
    springs = [f"{name}.spring_force" for name in train.list_parts(roles.LoadedSpring)]
    springs += [f"{name}.force" for name in train.list_parts(roles.CoilSpring)]
    quantities = {**own.quantities, SPRING: DERIVED[SPRING]}

    def derive(values: Mapping[str, Vector], reference: bool) -> Mapping[str, Vector]:
        found = {**values}
        if springs:
            found[SPRING] = np.sum([values[name] for name in springs], axis=0)
        for contact in train.contacts:
            if f"{contact}.approach" in own.drivers:
                found[f"{contact}.{GAP}"] = _find_gap(own, contact, reference)
                quantities[f"{contact}.{GAP}"] = DERIVED[GAP]
        return found

    reference = derive(own.reference, True) if own.reference else own.reference
    own = replace(own, coupled=derive(own.coupled, False), reference=reference, quantities=quantities)
    for contact in train.contacts:
        own = own.in_contact(contact)
    return own, which


def find_period(data: FigureData, train: Train) -> float:
    """The rise of the data's angle in a revolution of the train's cam (rad): of a crank's twice 2 pi."""
    over = data.angle or train.angle
    turned, cam = (np.ptp(data.coupled[angle.source]) for angle in (over, train.angle))
    return 2.0 * math.pi * max(1, round(over.factor * turned / cam)) if cam > 0.0 else 2.0 * math.pi


def _select(data: FigureData, train: Train, over: Angle) -> FigureData:
    """The variables of the train's parts, of what drives their inputs, and of the angle."""
    sources = [source for target, source in data.drivers.items() if target.split(".")[0] in train.parts]
    wanted = {*train.parts, *(source.split(".")[0] for source in [*sources, over.source])}

    def select(values: Mapping[str, Vector]) -> dict[str, Vector]:
        return {name: column for name, column in values.items() if name.split(".")[0] in wanted}

    return replace(data, coupled=select(data.coupled), reference=select(data.reference))


def _find_gap(data: FigureData, contact: str, reference: bool) -> Vector:
    """Between the surfaces where they carry no load, else zero."""
    values = data.reference if reference else data.coupled
    near, far = data.drivers[f"{contact}.approach"], data.drivers.get(f"{contact}.retreat")
    apart = (values[far] if far else 0.0) - values[near]
    return np.where(data.opened(contact, reference), np.maximum(apart, 0.0), 0.0)


def list_columns(data: FigureData, train: Train) -> list[Panels]:
    """The panels of the motion, then those of each contact, as far as the train has their variables."""
    valve = train.valve
    motion = {
        "Lift": train.lift,
        "Lift, magnified": train.lift,
        "Velocity": f"{valve}.velocity",
        "Acceleration": f"{valve}.acceleration",
        "Spring force": SPRING if SPRING in data.coupled else f"{valve}.spring_force",
        "Cam torque": f"{train.cam}.{train.role.torque}",
    }
    for adjuster in train.list_parts(roles.Adjuster)[:1]:
        motion |= {words: f"{adjuster}.{name}" for words, name in HYDRAULIC.items()}
    opened = any(data.opened(contact).any() for contact in train.contacts)
    columns = [motion]
    for contact in train.contacts:
        panels = {words: f"{contact}.{name}" for words, name in CONTACT.items()}
        panels["Sliding velocity"] = data.drivers.get(f"{contact}.sliding_velocity", "")
        columns.append({**panels, "Gap": f"{contact}.{GAP}"} if opened else panels)

    def is_shown(words: str, name: str) -> bool:
        """One that rolls has no sliding, nor its friction."""
        return name in data.coupled and (
            words not in SLIDING or bool(np.nan_to_num(data.coupled[name]).any())
        )

    return [{words: name for words, name in panels.items() if is_shown(words, name)} for panels in columns]


def _draw_pale(axes: np.ndarray, columns: list[Panels], data: FigureData, train: Train) -> None:
    """What another train has in the same panels."""
    own, _ = prepare(data, train)
    x = own.x()
    every = -(-len(x) // POINTS)
    for column, panels, theirs in zip(axes.T, columns, list_columns(own, train), strict=False):
        for ax, words in zip(column, panels, strict=False):
            if words in theirs:
                factor, _ = own.shown(theirs[words])
                values = factor * own.coupled[theirs[words]]
                ax.plot(x[::every], values[::every], color=PALE, lw=0.8, zorder=1)


def _add_kinematics(panels: Mapping[str, Axes], data: FigureData, train: Train) -> None:
    found = find_kinematics(train, data.time, data.coupled)
    shown = {"Lift": found.lift, "Lift, magnified": found.lift}
    shown |= {"Velocity": found.velocity, "Acceleration": found.acceleration}
    for words, values in shown.items():
        factor = 1e3 if "Lift" in words else 1.0
        panels[words].plot(
            data.x(), factor * values, color=MUTED, lw=1.1, ls=(0, (3, 2)), label="kinematic (rigid, no lash)"
        )


def _magnify_seat(ax: Axes, data: FigureData, train: Train, place: str) -> None:
    """The ramps: lifts up to a share of the largest, and what a landing does there."""
    top = OPENED * 1e3 * float(np.max(data.coupled[f"{train.cam}.cam_lift"]))
    dip = 1.1e3 * float(np.min(data.coupled[f"{train.valve}.position"]))
    if top > 0.0:  # where the cam stands still it may be zero
        ax.set_ylim(min(-0.15 * top, dip), top)
    velocity, landing = _measure(data, train, "seating_velocity")
    if landing is not None:
        where = f"seats with {velocity:.3g} m/s at {data.x()[landing]:.1f}°{place}"
        ax.plot(data.x()[landing], 0.0, "v", color=ACCENT, ms=5)
        write_remark(ax, where)


def _add_margin(ax: Axes, data: FigureData, train: Train, place: str) -> None:
    """The load that opens the valve beside the spring's force, and the spring margin."""
    load = data.drivers.get(f"{train.valve}.load", "") if train.list_parts(roles.Valve) else ""
    load = load or f"{train.contacts[0]}.load"
    spring = data.coupled.get(SPRING)
    if spring is None or load not in data.coupled:
        return
    ax.plot(data.x(), data.coupled[load], color=ACCENT, lw=1.0, label="load that opens the valve")
    share, at = _measure(data, train, "spring_margin")
    if at is not None:
        write_remark(ax, f"spring margin {100.0 * share:.3g} % at {data.x()[at]:.1f}°{place}")


def _remark_adjuster(
    panels: Mapping[str, Axes], data: FigureData, train: Train, whole: FigureData, place: str
) -> None:
    """Its highest pressure, and of the whole run's last turn leak, growth, and how long the check valve is
    open."""
    for name in train.list_parts(roles.Adjuster)[:1]:
        highest = ADJUSTER["chamber_pressure"][1](Part(data.motion, name))
        found = {figure: find(Part(whole.motion, name)) for figure, (_, find) in ADJUSTER.items()}
        most = f"at most {1e-6 * highest.value:.3g} MPa at {data.x()[highest.row]:.1f}°{place}"
        if math.isnan(found["leak_down"].value):
            write_remark(panels["Adjuster\npressure"], most)
            continue
        opened, leak = 100.0 * found["check_valve_open"].value, 1e6 * found["leak_down"].value
        grows = describe_growth(found["growth"].value, found["held_open"].value)
        write_remark(panels["Adjuster\npressure"], f"{most}; check valve open in {opened:.3g} %")
        write_remark(panels["Adjuster\nextension"], f"leaks {leak:.3g} µm in the turn; {grows}")


def _measure(data: FigureData, train: Train, figure: str) -> Found:
    """A figure of merit of the train's valve in these rows."""
    if not train.list_parts(roles.Valve):
        return Found(math.nan)
    return VALVE[figure][1](Part(data.motion, train.valve))


def _show_zero(ax: Axes) -> None:
    low, high = ax.get_ylim()
    if low < 0.0 < high:
        ax.axhline(0.0, color="0.4", lw=0.7)
    elif low > 0.0:
        ax.set_ylim(bottom=0.0)


def _shade(axes: np.ndarray, data: FigureData, train: Train) -> None:
    """Each contact's column where it is lost, the motion where any is."""
    lost = [data.lost(contact) for contact in train.contacts]
    for ax in axes[:, 0]:
        shade_where(ax, data, np.any(lost, axis=0))
    for column, contact in zip(axes[:, 1:].T, train.contacts, strict=True):
        column[0].set_title(contact, loc="left")
        for ax in column:
            shade(ax, data, contact)


def _add_legend(figure: Figure, axes: np.ndarray, others: int) -> None:
    found = list_handles(axes.flat)
    if others:
        found[f"the other {others} trains"] = Line2D([], [], color=PALE)
    figure.legend(found.values(), found.keys(), loc="outside lower center", ncols=len(found))
