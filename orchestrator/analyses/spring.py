"""A valve spring from its wire: force, stress and surge over its travel, and the orders of a cam's lift."""

import math
from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from models.core.quantities import Vector
from models.plausible import CAM_LIFT, PART_LENGTH, SPEED
from models.plausible import WIRE as PLAUSIBLE
from models.valve_train.wire_materials import MATERIALS, MPA
from models.valve_train.wire_spring import STRESS_FACTORS, WireSpring

from ..errors import MistakeError
from ..plots.style import ACCENT, COUPLED, MUTED, REFERENCE, RPM, create_subplots
from ..scenario.wire import read_wire
from ._cam_profile import build_profile, list_lift_parameters
from ._machine import column
from .protocol import Parameter, Result, declare, describe_values

POINTS, ORDERS, SAMPLES = 200, 40, 4096
# Highest frequency that is drawn over that of full lift; least surge that is drawn over the largest.
SHOWN, SMALL = 2.5, 1e-2
MM = 1e3
FREE_LENGTH = 52e-3
# Of the solid travel, where the table ends: there the last coils close.
NEARLY = 0.999


def _length(default: float, meaning: str) -> Parameter:
    return Parameter(default, "m", meaning, minimum=0.0, plausible=PART_LENGTH)


def _stress(meaning: str) -> Parameter:
    return Parameter(0.0, "Pa", f"{meaning}; 0: the material's", minimum=0.0)


WIRE = {
    "diameter": Parameter(4e-3, "m", "diameter of the wire", positive=True, plausible=PLAUSIBLE),
    "mean_diameter": Parameter(
        "26 mm", "1", "mean diameter; several, with commas, from the fixed to the moving end"
    ),
    "active_coils": Parameter(5.5, "1", "coils that bend", positive=True),
    "end_coils": Parameter(2.0, "1", "closed coils of both ends together", minimum=0.0),
    "free_length": _length(0.0, f"length without load; 0: by the pitch, else {1e3 * FREE_LENGTH:g} mm"),
    "pitch": Parameter("", "1", "pitch; several, with commas, as mean diameters"),
    "installed_length": _length(40e-3, "length while the valve is closed"),
    "material": Parameter("chrome-silicon", "1", "wire", choices=tuple(MATERIALS)),
    "peened": Parameter(True, "1", "whether the wire is shot-peened"),
    "shear_modulus": _stress("shear modulus"),
    "tensile_strength": _stress("tensile strength of this wire"),
    "endless_amplitude": _stress("amplitude of shear stress borne without end at endless_mean"),
    "endless_mean": _stress("mean shear stress to endless_amplitude"),
    "stress_factor": Parameter(
        "bergstraesser", "1", "factor of the coil's curvature", choices=tuple(STRESS_FACTORS)
    ),
}
CAM = {
    "valve_ratio": Parameter(1.0, "1", "lift of the valve over that of the cam", positive=True),
    "travel": Parameter(0.0, "m", "full lift of the valve; 0: the cam's", minimum=0.0, plausible=CAM_LIFT),
    "damping_ratio": Parameter(0.02, "1", "damping ratio of the spring", positive=True),
    "low": Parameter(500.0 / RPM, "rad/s", "lowest speed of the cam", positive=True, plausible=SPEED),
    "high": Parameter(3000.0 / RPM, "rad/s", "highest speed of the cam", positive=True, plausible=SPEED),
}


def install(values: Mapping[str, Any]) -> tuple[WireSpring, float]:
    """The spring of these parameters, and its force while the valve is closed. MistakeError for a fault."""
    given = {name: values[name] for name in WIRE if values[name] not in ("", 0.0) or name == "end_coils"}
    for name in ("mean_diameter", "pitch"):
        if name in given:
            given[name] = [text.strip() for text in str(given[name]).split(",")]
    if "pitch" not in given:
        given.setdefault("free_length", FREE_LENGTH)
    return read_wire({**given, "peened": values["peened"]}).install()


def find_orders(lift: Vector) -> Vector:
    """Amplitudes of the orders 1, 2, ... of a lift that is sampled over a turn."""
    return np.asarray(2.0 * np.abs(np.fft.rfft(lift))[1 : ORDERS + 1] / lift.size)


def _tabulate(values: Mapping[str, Any]) -> xarray.Dataset:
    if not values["low"] < values["high"]:
        raise MistakeError(
            f"low = {RPM * values['low']:g} r/min: must be less than high, {RPM * values['high']:g}"
        )
    spring, force = install(values)
    profile = build_profile(values)
    angles = np.arange(SAMPLES) * 2.0 * math.pi / SAMPLES
    lift = values["valve_ratio"] * np.array([profile.lift(a).s for a in angles])
    travelled, left = values["travel"] or float(lift.max()), spring.solid_travel - spring.compress(force)
    if travelled >= left:
        raise MistakeError(
            f"the valve's lift {MM * travelled:.4g} mm: must be less than {MM * left:.4g} mm, where all "
            "coils touch; wind fewer coils or enlarge the lengths"
        )
    full = spring.find_force(spring.compress(force) + travelled)
    travel = np.linspace(0.0, NEARLY * spring.solid_travel, POINTS)
    forces = np.array([spring.find_force(x) for x in travel])
    order = np.arange(1, ORDERS + 1)
    frequency = [spring.surge_frequencies(f, 1)[0] for f in (force, full)]
    amplitude = find_orders(lift)
    # The first mode of a rod with viscous damping, moved at its end: k s_n/zeta at resonance.
    surge = spring.rate(force) * amplitude / values["damping_ratio"]
    speed = 2.0 * math.pi * frequency[0] / order
    inside = (speed >= values["low"]) & (speed <= values["high"])
    worst = int(np.argmax(np.where(inside, surge, -1.0)))
    met = bool(inside.any())
    columns = {
        "force": column("travel", forces, "N", "force"),
        "length": column("travel", spring.free_length - travel, "m", "length"),
        "rate": column("travel", [spring.rate(f) for f in forces], "N/m", "rate of the open coils"),
        "surge": column(
            "travel", [spring.surge_frequencies(f, 1)[0] for f in forces], "Hz", "first natural frequency"
        ),
        "stress": column(
            "travel", [spring.stress(f).max() for f in forces], "Pa", "largest shear stress in the wire"
        ),
        "lift_amplitude": column("order", amplitude, "m", "amplitude of this order of the lift"),
        "meeting_speed": column(
            "order", speed, "rad/s", "speed of the cam where it meets the spring's frequency"
        ),
        "meeting_speed_open": column(
            "order", 2.0 * math.pi * frequency[1] / order, "rad/s", "the same at the full lift's frequency"
        ),
        "surge_by_order": column("order", surge, "N", "force by surge at that speed, k s_n/damping ratio"),
    }
    results: dict[str, float | str] = {
        "spring_rate": spring.rate(force),
        "surge_frequency": float(frequency[0]),
        "full_frequency": float(frequency[1]),
        "active_mass": spring.active_mass,
        "free": spring.free_length,
        "solid_length": spring.free_length - spring.solid_travel,
        "clash_margin": left - travelled,
        "installed_force": force,
        "full_force": full,
        "installed_stress": float(spring.stress(force).max()),
        "full_stress": float(spring.stress(full).max()),
        "solid_stress": float(spring.stress(math.inf).max()),
        "strength": spring.material.tensile_strength(spring.diameter),
        "fatigue_safety": spring.safety(force, full),
        "frequency_ratio": float(2.0 * math.pi * frequency[0] / values["high"]),
        "critical_order": float(order[worst]) if met else math.nan,
        "critical_speed": float(speed[worst]) if met else math.nan,
        "surge_force": float(surge[worst]) if met else math.nan,
    }
    coords = {
        "travel": column("travel", travel, "m", "compression from the free length"),
        "order": column("order", order, "1", "order of the cam's turn"),
    }
    return xarray.Dataset(columns, coords).assign(results)


def write_orders(table: xarray.Dataset, values: Mapping[str, Any]) -> str:
    """The orders as CSV, in the units of engineers."""
    rows = ["order,lift amplitude [mm],meets the spring at [r/min],at full lift [r/min],surge force [N]"]
    columns = ("lift_amplitude", "meeting_speed", "meeting_speed_open", "surge_by_order")
    scales = (MM, RPM, RPM, 1.0)
    for i, order in enumerate(table["order"].values):
        cells = (f"{s * table[name].values[i]:.6g}" for name, s in zip(columns, scales, strict=True))
        rows.append(f"{order},{','.join(cells)}")
    return "\n".join([*rows, ""])


def draw_spring(data: xarray.Dataset, values: Mapping[str, Any]) -> Figure:
    """Force and frequency over the length, the fatigue diagram, and surge by order."""
    rate, frequency = data["spring_rate"].item() / MM, data["surge_frequency"].item()
    title = f"Spring of {MM * values['diameter']:g} mm wire, {rate:.3g} N/mm, {frequency:.0f} Hz"
    figure, axes = create_subplots(2, 2, title, (9.6, 6.6))
    length = MM * data["length"].values
    _over_length(axes[0, 0], data, length, data["force"].values, "Force (N)")
    _over_length(axes[0, 1], data, length, data["surge"].values, "First natural frequency (Hz)")
    # As the last coils close it grows beyond all bounds.
    axes[0, 1].set_ylim(0.0, SHOWN * data["full_frequency"].item())
    _draw_fatigue(axes[1, 0], data, values)
    _draw_orders(axes[1, 1], data, values)
    return figure


def _over_length(axes: Axes, data: xarray.Dataset, length: Vector, curve: Vector, label: str) -> None:
    axes.plot(length, curve, color=COUPLED)
    installed = np.interp(data["installed_force"].item(), data["force"].values, length)
    full = np.interp(data["full_force"].item(), data["force"].values, length)
    axes.axvspan(full, installed, color=ACCENT, alpha=0.12, lw=0.0, label="between installed and full lift")
    axes.axvline(MM * data["solid_length"].item(), color=REFERENCE, lw=1.0, ls="--", label="all coils touch")
    axes.set_xlim(length[0], MM * data["solid_length"].item() - 0.5)
    axes.set_xlabel("Length (mm)")
    axes.set_ylabel(label)
    axes.set_ylim(0.0, 1.35 * float(np.max(curve)))
    axes.legend(loc="upper left")


def _draw_fatigue(axes: Axes, data: xarray.Dataset, values: Mapping[str, Any]) -> None:
    """Goodman's line in Haigh's diagram, and the stresses of this lift."""
    spring, _ = install(values)
    strength = spring.fatigue
    low, high = (data[name].item() / MPA for name in ("installed_stress", "full_stress"))
    axes.plot(
        [0.0, strength.mean / MPA],
        [strength.amplitude / MPA, 0.0],
        color=REFERENCE,
        label="borne without end",
    )
    axes.plot(0.5 * (high + low), 0.5 * (high - low), "o", color=COUPLED, label="this lift")
    axes.set_xlabel("Mean shear stress (MPa)")
    axes.set_ylabel("Amplitude (MPa)")
    axes.set_xlim(0.0, 1.05 * strength.mean / MPA)
    axes.set_ylim(0.0, 1.15 * strength.amplitude / MPA)
    axes.legend(title=f"safety {data['fatigue_safety'].item():.3g}", loc="upper right")


def _draw_orders(axes: Axes, data: xarray.Dataset, values: Mapping[str, Any]) -> None:
    speed, surge = RPM * data["meeting_speed"].values, data["surge_by_order"].values
    low, high = RPM * values["low"], RPM * values["high"]
    shown = (speed >= low) & (speed <= high)
    shown &= surge > SMALL * np.max(surge, where=shown, initial=0.0)
    axes.axhline(data["installed_force"].item(), color=MUTED, ls="--", lw=1.0, label="installed force")
    if shown.any():
        axes.vlines(
            speed[shown], 0.01, surge[shown], color=COUPLED, lw=2.0, label="surge, by order of the lift"
        )
        for order, x, y in zip(data["order"].values[shown], speed[shown], surge[shown], strict=True):
            axes.annotate(
                str(order), (x, y), xytext=(0, 2), textcoords="offset points", ha="center", fontsize=8
            )
        axes.set_yscale("log")
        top = max(float(surge[shown].max()), data["installed_force"].item())
        axes.set_ylim(0.5 * float(surge[shown].min()), 8.0 * top)
    axes.set_xlim(low, high + 0.02 * (high - low))
    axes.set_xlabel("Speed of the cam (r/min)")
    axes.set_ylabel("Force (N)")
    axes.legend(loc="upper right")


ANALYSIS = declare(
    name="spring",
    description="A valve spring from its wire: rate, stress, fatigue, surge, and the orders of a cam's lift",
    parameters={**WIRE, **list_lift_parameters(), **CAM},
    results={
        "spring_rate": Result("N/m", "rate, installed", display_unit="N/mm"),
        "surge_frequency": Result("Hz", "first natural frequency, installed"),
        "full_frequency": Result("Hz", "the same at full lift, where coils have closed"),
        "active_mass": Result("kg", "mass of the active coils", display_unit="g"),
        "free": Result("m", "free length", display_unit="mm"),
        "solid_length": Result("m", "length where all coils touch", display_unit="mm"),
        "clash_margin": Result("m", "travel left at full lift until all coils touch", display_unit="mm"),
        "installed_force": Result("N", "force, valve closed"),
        "full_force": Result("N", "force at full lift"),
        "installed_stress": Result("Pa", "largest shear stress, valve closed", display_unit="MPa"),
        "full_stress": Result("Pa", "largest shear stress at full lift", display_unit="MPa"),
        "solid_stress": Result("Pa", "largest shear stress as all coils touch", display_unit="MPa"),
        "strength": Result("Pa", "tensile strength of the wire", display_unit="MPa"),
        "fatigue_safety": Result("1", "safety against fatigue between both (Goodman), without surge"),
        "frequency_ratio": Result("1", "natural frequency over that of the cam's highest speed"),
        "critical_order": Result("1", "order of the lift that excites most surge in the range of speeds"),
        "critical_speed": Result("rad/s", "speed of the cam where it does", display_unit="rpm"),
        "surge_force": Result("N", "force by surge there, over the spring's own"),
    },
    table=_tabulate,
    draw=draw_spring,
    texts={"orders.csv": write_orders},
    describe=partial(describe_values, {**WIRE, **CAM}),
)
