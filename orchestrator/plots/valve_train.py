"""A valve train over the cam angle: its motion on the left, the contact of cam and follower on the right.

Shaded where the follower has left its cam; there the film has no meaning and the gap is drawn instead. Of
several valve trains it is the one with the highest contact load.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from models.core.quantities import Vector

from .data import FigureData
from .style import (
    COUPLED,
    MUTED,
    REFERENCE,
    add_title,
    create_subplots,
    label_abscissa,
    plot_both,
    shade,
)

CONTACT = (
    ("load", "Contact load"),
    ("maximum_pressure", "Highest pressure"),
    ("film_thickness", "Film thickness"),
    ("friction_force", "Friction"),
    ("entraining_velocity", "Entraining velocity"),
)


def applies(data: FigureData) -> bool:
    return bool(find_cam_contacts(data))


def find_cam_contacts(data: FigureData) -> list[str]:
    """Contacts that a cam entrains, the most loaded first."""
    found = [
        contact
        for contact in data.list_instances()
        if f"{contact}.load" in data.coupled and f"{find_cam(data, contact)}.cam_angle" in data.coupled
    ]
    return sorted(found, key=lambda contact: -float(np.max(data.coupled[f"{contact}.load"])))


def find_cam(data: FigureData, contact: str) -> str:
    return data.driver(f"{contact}.entraining_velocity")


def find_follower(data: FigureData, contact: str) -> str:
    """What retreats before the contact; a train in one component is its own follower."""
    return data.driver(f"{contact}.retreat") or find_cam(data, contact)


def list_instances(data: FigureData) -> set[str]:
    """The instances that this figure draws."""
    return {
        part
        for contact in find_cam_contacts(data)
        for part in (contact, find_cam(data, contact), find_follower(data, contact))
    }


def draw(data: FigureData) -> Figure:
    contact, *others = find_cam_contacts(data)
    cam, follower = find_cam(data, contact), find_follower(data, contact)
    own = data.of(cam).in_contact(contact)
    title = f"{data.title}: valve train of {contact}"
    if others:
        title += f", the most loaded of {len(others) + 1} (valves.png has all)"
    figure, axes = create_subplots(5, 2, figsize=(11.0, 8.8), sharex=True)
    add_title(figure, title)
    lift, second, *rest = axes[:, 0]
    _draw_lift(lift, own, contact)
    if own.lost(contact).any() and f"{contact}.retreat" in own.drivers:
        _draw_gap(second, own, contact)
    else:
        _draw_panel(second, own, f"{follower}.velocity", "Velocity")
    below = (
        (f"{follower}.acceleration", "Acceleration"),
        (f"{follower}.spring_force", "Spring force"),
        (f"{cam}.drive_torque", "Camshaft torque"),
    )
    for ax, (name, words) in zip(rest, below, strict=True):
        _draw_panel(ax, own, name, words)
    for ax, (variable, words) in zip(axes[:, 1], CONTACT, strict=True):
        source = cam if variable == "entraining_velocity" else contact
        _draw_panel(ax, own, f"{source}.{variable}", words)
    for ax in axes.flat:
        shade(ax, own, contact)
    for ax in axes[-1]:
        label_abscissa(ax, own)
    figure.align_ylabels(axes)
    lift.set_title(follower, loc="left")
    axes[0, 1].set_title(f"{contact} with {cam}", loc="left")
    handles, labels = lift.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


def _draw_panel(ax: Axes, data: FigureData, name: str, words: str) -> None:
    """Draw the variable; leave the panel empty if the component has none."""
    if name not in data.coupled:
        ax.set_visible(False)
        return
    plot_both(ax, data, name, words)
    low, _ = ax.get_ylim()
    if low < 0.0:
        ax.axhline(0.0, color="0.4", lw=0.7)
    elif low > 0.0:
        ax.set_ylim(bottom=0.0)


def _draw_lift(ax: Axes, data: FigureData, contact: str) -> None:
    """Draw the follower's lift over the cam surface."""
    train = find_cam(data, contact)
    cam = data.drivers.get(f"{contact}.approach", f"{train}.cam_lift")
    follower = data.drivers.get(f"{contact}.retreat", f"{train}.position")
    _draw_panel(ax, data, follower, "Lift")
    if follower in data.coupled and cam in data.coupled:
        factor, _ = data.shown(cam)
        ax.plot(
            data.x(), factor * data.coupled[cam], color=MUTED, lw=1.2, ls=(0, (3, 2)), label="cam surface"
        )


def _draw_gap(ax: Axes, data: FigureData, contact: str) -> None:
    """Draw the gap between cam surface and follower."""
    cam, follower = data.drivers[f"{contact}.approach"], data.drivers[f"{contact}.retreat"]

    def gap(values: dict[str, Vector], reference: bool) -> Vector:
        apart = 1e6 * (values[follower] - values[cam])
        return np.where(data.lost(contact, reference), np.maximum(apart, 0.0), 0.0)

    if data.reference:
        ax.plot(data.x(True), gap(dict(data.reference), True), color=REFERENCE, alpha=0.55, lw=3.2)
    ax.plot(data.x(), gap(dict(data.coupled), False), color=COUPLED, lw=1.1)
    ax.set_ylabel("Gap (µm)")
    ax.set_ylim(bottom=0.0)
