"""What is asked of a valve's springs: forces, surge, travel left to coil bind, fatigue of the wire."""

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence

import numpy as np

from models.core import roles
from models.core.quantities import Quantity, Vector
from models.core.system import Instance, System
from models.valve_train.wire_materials import Fatigue

from ..scenario.values import WARNING
from .motion import NONE, Figure, Found, Part, find_largest, find_least
from .trains import Train, find_trains, has_defaults, parameter_of

# What a spring's mass follows from, with units.
BY_MASS = {"spring_rate": "N/m", "surge_frequency": "Hz"}
MORE_TRAVEL = "fewer coils, a thinner wire or a larger installed length give it more travel"


def list_springs(train: Train) -> list[str]:
    """Its springs, the nearest to the cam first."""
    both = (*train.list_parts(roles.CoilSpring), *train.list_parts(roles.LoadedSpring))
    return list(dict.fromkeys(both))


def list_clashing(system: System, found: Mapping[str, Vector]) -> Iterator[tuple[str, Vector]]:
    """Each spring whose coils, all of one gap, clash in some of its figures `least_gap` (m), with these; they
    are found by "spring.least_gap"."""
    for name, gaps in found.items():
        spring, _, figure = name.rpartition(".")
        if figure == "least_gap" and (gaps < 0.0).any() and closes_at_once(system.instances[spring]):
            yield spring, gaps


def warn_of_clash(spring: str, where: str, gap: float) -> str:
    """That coils clash, and how far (m, below 0) at most."""
    return (
        f"{WARNING}components.{spring}: its coils clash {where}, by up to {-1e3 * gap:.3g} mm of travel "
        f"beyond coil bind; {MORE_TRAVEL}"
    )


def warn_of_solid(system: System) -> Iterator[str]:
    """A warning of each spring whose coils all touch below its valve's full lift, at any speed."""
    for train in find_trains(system):
        for name in list_springs(train):
            travel, lift = sum(_list_gaps(system.instances[name])), train.valve_lift
            if lift > travel:
                yield (
                    f"{WARNING}components.{name}: solid before full lift, at any speed: its valve lifts by "
                    f"{1e3 * lift:.4g} mm, {1e3 * (lift - travel):.3g} mm more than the "
                    f"{1e3 * travel:.4g} mm where all coils touch; {MORE_TRAVEL}"
                )


def remark_default_bind(system: System) -> Iterator[str]:
    """That coil bind is judged by a default; nothing of springs whose scenario or wire gives it."""
    found: dict[tuple[str, float], list[str]] = {}
    for name in dict.fromkeys(name for train in find_trains(system) for name in list_springs(train)):
        if binds_by_default(spring := system.instances[name]):
            parameter = _name_gaps(spring)[0].partition("[")[0]
            found.setdefault((parameter, sum(_list_gaps(spring))), []).append(name)
    for (parameter, travel), names in found.items():
        where = f"components.{names[0] if len(names) == 1 else 'NAME'}"
        yield (
            f"{names[0]}{f' and {len(names) - 1} more' * (len(names) > 1)}: coil bind is judged by the "
            f"component's default, {1e3 * travel:.4g} mm of lift until all coils touch; give your spring's "
            f"{where}.parameters.{parameter}, or {where}.wire"
        )


def binds_by_default(spring: Instance) -> bool:
    """Whether the travel until its coils touch is the component's default."""
    return has_defaults(spring, _name_gaps(spring))


def remark_masses(systems: Sequence[System], changed: Collection[str] = ()) -> Iterator[str]:
    """Of each spring whose rate or surge frequency alone differs among the systems, or is among the paths of
    what was `changed`: its coils' mass, k/(4 f^2) by rate k and first frequency f (Hz) between fixed ends."""
    for name in dict.fromkeys(name for train in find_trains(systems[0]) for name in list_springs(train)):
        springs = [one.instances[name] for one in systems if name in one.instances]
        if not all(key in one.component.parameters for one in springs for key in BY_MASS):
            continue
        values = {key: [parameter_of(one, key) for one in springs] for key in BY_MASS}
        varied = [
            key
            for key, every in values.items()
            if len(set(every)) > 1 or f"components.{name}.parameters.{key}" in changed
        ]
        if len(varied) != 1:
            continue
        (kept,) = values.keys() - {*varied}
        masses = sorted({1e3 * k / (4.0 * f**2) for k, f in zip(*values.values(), strict=True)})
        yield (
            f"{name}: {kept} stays {values[kept][0]:g} {BY_MASS[kept]} as {varied[0]} changes, so that the "
            f"coils' mass, spring_rate/(4 surge_frequency^2), is {', '.join(f'{m:.4g}' for m in masses)} g; "
            f"set {kept} too where the spring has another mass"
        )


def _surge(part: Part) -> Found:
    """Largest force of the coils' own motion: the spring's less that of its static rate."""
    static = part.parameter("preload") + part.parameter("spring_rate") * part["valve_lift"]
    return Found.largest(np.abs(part["spring_force"] - static))


def _least_gap(spring: Part) -> Found:
    """None of coils whose gaps are not computed: they stay as they are."""
    return find_least("least_gap")(spring) if np.ptp(spring["least_gap"]) else NONE


def _find_wire_force(spring: Part, force: str) -> Vector:
    """The force that twists the wire, of the tightest coils while they are open, or at the spring's end if it
    is larger; at its end only where gaps of coils differ."""
    if (clearance := _find_clearance(spring.motion.system.instances[spring.name])) is None:
        return np.asarray(spring[force])
    preload, rate = spring.parameter("preload"), spring.parameter("spring_rate")
    tightest = preload + rate * (clearance - np.maximum(spring["least_gap"], 0.0))
    # Coils that touch bear each other: the wire between them is not twisted further.
    return np.maximum(tightest, np.minimum(spring[force], preload + rate * clearance))


def closes_at_once(spring: Instance) -> bool:
    """Whether all coils touch at one travel."""
    return _find_clearance(spring) is not None


def _find_clearance(spring: Instance) -> float | None:
    """Travel (m) until all coils touch; None where they do one after the other."""
    gaps = _list_gaps(spring)
    return sum(gaps) if math.isclose(min(gaps), max(gaps)) else None


def _list_gaps(spring: Instance) -> list[float]:
    """From the valve's seat on (m): of each segment, or of all coils as one."""
    return [parameter_of(spring, name) for name in _name_gaps(spring)]


def _name_gaps(spring: Instance) -> list[str]:
    gaps = [name for name in spring.component.parameters.names if name.startswith("gap[")]
    return gaps or ["clash_clearance"]


def _stress(force: str) -> Callable[[Part], Found]:
    """None of a spring whose wire is not known."""

    def find(spring: Part) -> Found:
        by_force = spring.parameter("wire_stress")
        return Found.largest(by_force * _find_wire_force(spring, force)) if by_force > 0.0 else NONE

    return find


def _fatigue_safety(force: str) -> Callable[[Part], Found]:
    """Goodman's line, between the least force at the spring's end and the largest in its wire."""

    def find(spring: Part) -> Found:
        by_force = spring.parameter("wire_stress")
        fatigue = Fatigue(spring.parameter("wire_amplitude"), spring.parameter("wire_strength"))
        if not min(by_force, fatigue.amplitude, fatigue.mean) > 0.0:
            return NONE
        low = by_force * float(np.min(spring[force]))
        high = by_force * float(np.max(_find_wire_force(spring, force)))
        return Found(1.0 / fatigue.use(0.5 * (high - low), 0.5 * (high + low)))

    return find


def _wire(force: str) -> Mapping[str, Figure]:
    return {
        "largest_stress": (
            Quantity("Pa", "largest shear stress in the wire", display_unit="MPa"),
            _stress(force),
        ),
        "fatigue_safety": (Quantity("1", "safety of the wire against fatigue"), _fatigue_safety(force)),
    }


SPRING: Mapping[str, Figure] = {
    "least_gap": (
        Quantity("m", "least travel left to coil bind, by the tightest coils", display_unit="mm"),
        _least_gap,
    )
}
LOADED_SPRING: Mapping[str, Figure] = {
    "largest_spring_force": (
        Quantity("N", "largest spring force"),
        find_largest("spring_force"),
    ),
    "surge_force": (Quantity("N", "largest force by surge"), _surge),
    **SPRING,
    **_wire("spring_force"),
}
COIL_SPRING: Mapping[str, Figure] = {
    **SPRING,
    "largest_clash_force": (
        Quantity("N", "largest force between coils that clash"),
        find_largest("clash_force"),
    ),
    **_wire("force"),
}
