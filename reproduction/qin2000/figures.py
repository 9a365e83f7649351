"""The valve of the pushrod train at low and at high speed, and its contacts: the source's kind of figures."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from orchestrator.plots.style import ACCENT, COUPLED, REFERENCE, add_title, create_subplots

from ..publication import Drawing
from .runs import HIGH, LOW, RATED, Runs

COLOURS = {LOW: COUPLED, RATED: ACCENT, HIGH: REFERENCE}
PANELS = (
    ("valve_spring.position", "Valve lift (mm)", 1e3),
    ("valve_spring.velocity", "Valve velocity (m/s)", 1.0),
    ("valve_spring.acceleration", "Valve acceleration (m/s²)", 1.0),
    ("cam_contact.load", "Load of cam and tappet (N)", 1.0),
    ("valve_contact.load", "Load of rocker and valve (N)", 1.0),
    ("cam_contact.maximum_pressure", "Pressure of cam and tappet (MPa)", 1e-6),
)


def plot_train(runs: Runs) -> Figure:
    figure, axes = create_subplots(2, 3, sharex=True, figsize=(11.0, 5.4))
    add_title(figure, "Pushrod train at three speeds of the camshaft")
    for (name, label, scale), ax in zip(PANELS, axes.flat, strict=True):
        for speed, colour in COLOURS.items():
            cycle = runs.cycle(speed)
            degrees = np.linspace(0.0, 360.0, cycle.times.size)
            # Blows after a jump would hide all else.
            if speed != HIGH or name in ("valve_spring.position", "valve_spring.velocity"):
                ax.plot(degrees, scale * cycle[name], color=colour, label=f"{speed:.0f} r/min")
        ax.set_ylabel(label)
    figure.legend(*axes.flat[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    for ax in axes[1]:
        ax.set_xlabel("Cam angle (°)")
    axes.flat[0].set_xlim(0.0, 360.0)
    axes.flat[0].xaxis.set_major_locator(MultipleLocator(90.0))
    return figure


FIGURES = (
    Drawing(
        "qin2000-train.png",
        plot_train,
        "Motion of the valve, loads and stress of the pushrod train; loads of 3000 r/min are left out",
    ),
)
