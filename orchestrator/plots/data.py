"""Data of figures: coupled run and reference at their records."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.contact.records import ATOM
from models.core.quantities import Quantity, Vector
from models.core.system import System

from ..assessment.diagnosis.steps import NONE, Steps, read_group
from ..assessment.lost_contact import FILMS, has_film, slides
from ..assessment.merits import read_motion
from ..assessment.motion import Motion
from ..assessment.trains import Angle, Train, find_angle, find_angles, find_lost_rows, find_trains
from ..scenario.display import SYMBOLS, show
from ..scenario.files import load
from ..scenario.system import build_system, list_outputs
from ..scenario.units import choose_time_unit
from ..store.output_folder import SCENARIO
from ..store.records import Group, open_records

# More points than these cannot be distinguished in a figure.
POINTS = 20_000

# Figures use an angle as abscissa if it deviates from a uniform rise by less than this share.
UNEVEN = 0.02


@dataclass(frozen=True)
class FigureData:
    """Values by "instance.variable" in SI units. `reference` is empty if there is none.

    `drivers` gives the output that drives an input, `parameters` what the scenario states, `tolerance` the
    allowed relative RMS error of a variable. `angle` is what to draw against; None: that of the instance
    drawn, or the system's first, if `system` is known and has one. Figures over it begin at `origin` (rad).
    `energies` are the ledger's channels at `energy_time`, if one was kept. `names` are both runs' in legends.
    """

    title: str
    time: Vector
    coupled: Mapping[str, Vector]
    reference_time: Vector
    reference: Mapping[str, Vector]
    quantities: Mapping[str, Quantity]
    steps: Steps = NONE
    drivers: Mapping[str, str] = field(default_factory=dict)
    parameters: Mapping[str, float] = field(default_factory=dict)
    system: System | None = None
    angle: Angle | None = None
    origin: float = 0.0
    energy_time: Vector = field(default_factory=lambda: np.zeros(0))
    tolerance: Mapping[str, float] = field(default_factory=dict)
    energies: Mapping[str, Vector] = field(default_factory=dict)
    names: tuple[str, str] = ("coupled", "monolithic reference")

    @classmethod
    def read(cls, folder: Path) -> FigureData:
        """The run in a folder, thinned to POINTS, over the angle that its scenario names. MistakeError if it
        has no result, or its scenario cannot be read."""
        with open_records(folder) as records:
            scenario = load(folder / SCENARIO)
            quantities, system = list_outputs(scenario), build_system(scenario)

            def take(name: str, wanted: Iterable[str] = ()) -> tuple[Vector, dict[str, Vector]]:
                group = records.groups.get(name, Group({}))
                if not group.rows:
                    return np.zeros(0), {}
                rows = slice(None, None, -(-group.rows // POINTS))
                names = [key for key in wanted or group.names if key in group.stored]
                return group.read("time", rows), {key: group.read(key, rows) for key in names}

            time, coupled = take("coupled", quantities)
            reference_time, reference = take("reference", quantities)
            energy_time, energies = take("energy")
            steps = read_group(records.groups.get("steps"))
        return cls(
            title=scenario.name if records.attributes.get("complete") else f"{scenario.name} (incomplete)",
            time=time,
            coupled=coupled,
            reference_time=reference_time,
            reference=reference,
            quantities=quantities,
            steps=steps,
            drivers={str(target): str(source) for target, source in system.drivers.items()},
            parameters=dict(zip(system.parameters.names, system.p.tolist(), strict=True)),
            system=system,
            energy_time=energy_time,
            tolerance=scenario.tolerance,
            energies=energies,
        ).over(scenario.figures_over)

    def having(self, variable: str) -> list[str]:
        """The instances with that output."""
        return [part for part in self.list_instances() if f"{part}.{variable}" in self.coupled]

    def list_instances(self) -> list[str]:
        """All instances with outputs, in the scenario's order."""
        return list(dict.fromkeys(name.split(".")[0] for name in self.coupled))

    def opened(self, contact: str, reference: bool = False) -> NDArray[np.bool_]:
        """Where a contact carries no load."""
        values = self.reference if reference else self.coupled
        return np.asarray(values[f"{contact}.load"] <= 0.0)

    def lost(self, contact: str) -> NDArray[np.bool_]:
        """Where it is lost (`ContactLaw`)."""
        return find_lost_rows(self.system, contact, self.coupled.__getitem__)

    def in_contact(self, contact: str) -> FigureData:
        """The data with NaN for the contact's films and friction where they have no meaning, and for films
        below an atom."""
        friction, sliding = f"{contact}.friction_force", self.drivers.get(f"{contact}.sliding_velocity", "")

        def under_load(values: Mapping[str, Vector]) -> dict[str, Vector]:
            films = {film: values[name] for film in FILMS if (name := f"{contact}.{film}") in values}
            found = {}
            for film, column in films.items():
                least = 0.0 if film == "film_ratio" else ATOM
                valid = has_film(film, values[f"{contact}.load"]) & (column >= least)
                found[f"{contact}.{film}"] = np.where(valid, column, np.nan)
            if friction in values and sliding in values:
                unloaded = values[f"{contact}.load"] <= 0.0
                found[friction] = np.where(unloaded | slides(values[sliding]), values[friction], np.nan)
            return {**values, **found}

        return replace(self, coupled=under_load(self.coupled), reference=under_load(self.reference))

    def error(self, name: str) -> Vector:
        """coupled - reference at the reference's times; NaN where the thinned coupled run has no record."""
        coupled = self.coupled[name]
        if len(self.reference_time) == len(self.time):
            return np.asarray(coupled - self.reference[name])
        at = np.searchsorted(self.time, self.reference_time)
        at = np.minimum(at, len(self.time) - 1)
        same = self.time[at] == self.reference_time
        return np.where(same, coupled[at] - self.reference[name], np.nan)

    def shown(self, name: str) -> tuple[float, str]:
        """Factor to the display unit, and the unit as it is set."""
        shown = show(self.quantities[name])
        return shown.factor, shown.symbol

    def label(self, name: str, words: str = "") -> str:
        """An axis label with unit."""
        words = words or self.quantities[name].description
        unit = self.shown(name)[1]
        return words if unit in ("", "1") else f"{words} ({unit})"

    @cached_property
    def motion(self) -> Motion:
        """The coupled run's rows, for figures of merit."""
        assert self.system
        return read_motion(self.system, {"time": self.time, **self.coupled}.__getitem__)

    @cached_property
    def trains(self) -> list[Train]:
        """The valve trains of which everything was recorded, the one with the largest load first."""

        def largest(train: Train) -> float:
            return max(float(np.max(self.coupled[f"{name}.load"])) for name in train.contacts)

        every = find_trains(self.system) if self.system else ()
        known = [train for train in every if train.contacts and train.angle.source in self.coupled]
        return sorted(known, key=largest, reverse=True)

    def over(self, name: str | None) -> FigureData:
        """The data over that angle of the system, if it has it."""
        return replace(self, angle=find_angles(self.system).get(name or "") if self.system else None)

    def of(self, instance: str) -> FigureData:
        """The data over the angle of the instance, of its cam, or else of crank or shaft; or over `angle`."""
        if self.angle or not self.system:
            return self
        return replace(self, angle=find_angle(self.system, instance))

    def between(self, angle: Angle, low: float, high: float) -> FigureData:
        """The rows between two values of the angle (rad), drawn from zero at the lower one."""

        def rows(values: Mapping[str, Vector]) -> NDArray[np.bool_]:
            turned = angle.factor * values[angle.source]
            return np.asarray((turned >= low) & (turned <= high))

        kept = rows(self.coupled)
        beside = rows(self.reference) if self.reference else np.zeros(len(self.reference_time), dtype=bool)
        return replace(
            self,
            angle=angle,
            origin=low,
            time=self.time[kept],
            coupled={name: values[kept] for name, values in self.coupled.items()},
            reference_time=self.reference_time[beside],
            reference={name: values[beside] for name, values in self.reference.items()},
        )

    def abscissa(self) -> tuple[str, str]:
        """Variable and label of the abscissa: an angle at a nearly constant speed, else time ("")."""
        if angle := self._find_even_angle():
            return angle.source, f"{angle.words} (°)"
        unit, _ = self._time_unit()
        return "", f"Time ({SYMBOLS.get(unit, unit)})"

    def _find_even_angle(self) -> Angle | None:
        known = self.angle or (next(iter(find_angles(self.system).values()), None) if self.system else None)
        if known is None or known.source not in self.coupled:
            return None
        angle = self.coupled[known.source]
        line = np.interp(self.time, self.time[[0, -1]], angle[[0, -1]])
        turned = abs(angle[-1] - angle[0])
        return known if turned > 0.1 and np.abs(angle - line).max() < UNEVEN * turned else None

    def _time_unit(self) -> tuple[str, float]:
        return choose_time_unit(float(np.ptp(self.time)))

    def x(self, reference: bool = False) -> Vector:
        """The abscissa's values at the records of the coupled run or the reference."""
        angle = self._find_even_angle()
        if angle is None:
            _, factor = self._time_unit()
            return factor * (self.reference_time if reference else self.time)
        values = (self.reference if reference else self.coupled)[angle.source]
        return np.degrees(angle.factor * values - self.origin)
