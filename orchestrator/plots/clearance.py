"""Clearance between valves and pistons, beside that of the motion that the cam asks for."""

import numpy as np
from matplotlib.figure import Figure

from models.core.roles import PistonClearance

from ..assessment.trains import find_kinematics, find_trains, list_parts
from .data import FigureData
from .style import ACCENT, MUTED, create_panels, plot_both


def applies(data: FigureData) -> bool:
    return bool(data.system and list_parts(data.system, PistonClearance))


def draw(data: FigureData) -> Figure:
    assert data.system
    names = list_parts(data.system, PistonClearance)
    figure, axes = create_panels(len(names), data, f"{data.title}: clearance of valves and pistons", 2.6)
    for ax, name in zip(axes, names, strict=True):
        clearance = data.coupled[f"{name}.clearance"]
        plot_both(ax, data, f"{name}.clearance", "Clearance")
        lift = data.coupled.get(data.drivers.get(f"{name}.valve_lift", ""))
        train = next((one for one in find_trains(data.system) if name in one.parts), None)
        if train and lift is not None:
            rigid = clearance + lift - find_kinematics(train, data.time, data.coupled).lift
            ax.plot(data.x(), 1e3 * rigid, color=MUTED, lw=1.1, ls=(0, (3, 2)), label="rigid train, no lash")
        row = int(np.argmin(clearance))
        ax.plot(data.x()[row], 1e3 * clearance[row], "v", color=ACCENT, ms=5)
        where = f" at {data.x()[row]:.1f}°" if data.abscissa()[0] else ""
        ax.set_title(f"{name}: least {1e3 * clearance[row]:.3g} mm{where}", loc="left")
        ax.axhline(0.0, color="0.4", lw=0.7)
        least = 1e3 * float(clearance[row])
        ax.set_ylim(
            min(-0.5, 1.2 * least), max(4.0 * least, 2e3 * float(np.ptp(lift)) if lift is not None else 10.0)
        )
        ax.legend(loc="upper right")
    return figure
