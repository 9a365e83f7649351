"""Tilting piston: gaps and wall forces of its four corners, tilt, impacts, gas pressure."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .data import FigureData
from .style import ACCENT, COUPLED, MUTED, REFERENCE, add_legend_above, create_panels, plot_both

# Front corners are solid, rear ones dashed.
CORNERS = (
    ("upper_front", COUPLED, "-"),
    ("upper_rear", COUPLED, "--"),
    ("lower_front", ACCENT, "-"),
    ("lower_rear", ACCENT, "--"),
)


def applies(data: FigureData) -> bool:
    return bool(data.having("piston_tilt"))


def list_instances(data: FigureData) -> set[str]:
    """Pistons and the gas above them."""
    return {*data.having("piston_tilt"), *data.having("gas_pressure")}


def draw(data: FigureData) -> Figure:
    instance, gas = data.having("piston_tilt")[0], data.having("gas_pressure")
    figure, axes = create_panels(5 if gas else 4, data, f"{data.title}: piston in its bore")
    _draw_corners(axes[0], data, instance, "gap", "Gap")
    plot_both(axes[1], data, f"{instance}.piston_tilt", "Tilt")
    axes[1].axhline(0.0, color=MUTED, lw=0.7)
    _draw_corners(axes[2], data, instance, "force", "Wall force")
    plot_both(axes[3], data, f"{instance}.impact_count", "Impacts")
    if gas:
        plot_both(axes[4], data, f"{gas[0]}.gas_pressure", "Gas pressure")
    axes[0].legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4, borderaxespad=0.2)
    add_legend_above(axes[1])
    return figure


def _draw_corners(axes: Axes, data: FigureData, instance: str, quantity: str, words: str) -> None:
    for corner, colour, line in CORNERS:
        name = f"{instance}.{corner}_{quantity}"
        factor, _ = data.shown(name)
        if name in data.reference:
            axes.plot(data.x(True), factor * data.reference[name], color=REFERENCE, alpha=0.3, lw=2.4)
        axes.plot(
            data.x(), factor * data.coupled[name], color=colour, ls=line, lw=1.0,
            label=corner.replace("_", " "),
        )  # fmt: skip
    axes.set_ylabel(data.label(name, words))
