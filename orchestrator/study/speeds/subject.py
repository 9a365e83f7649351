"""The steady cycle of a scenario at a speed, as the subject of a study."""

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray

from models import plausible
from models.core import roles
from models.core.quantities import Quantity, Vector
from models.core.system import ModelError, System
from models.monolithic.cycle import STEADY as LARGEST_CHANGE
from models.monolithic.cycle import TOLERANCE, Cycle, find_cycle
from models.monolithic.modes import Mode, find_modes

from ...analyses import Parameter, Result
from ...assessment.figures_of_merit import list_figures, measure
from ...assessment.motion import Motion, Part
from ...assessment.notices import list_notices
from ...assessment.trains import Angle, find_trains, list_ratios
from ...errors import MistakeError
from ...scenario import Scenario, build_scenario
from ...scenario.files import put_parameters, to_full_toml
from ...scenario.system import build_system, list_parameters, resolve_start
from ...scenario.values import Value
from ..subjects import NumberedSubject

SPEED = Parameter(
    1000.0 * math.pi / 30.0, "rad/s", "speed of the flywheel", positive=True, plausible=plausible.SPEED
)
# Of a period. Contacts vibrate at some 10 kHz: with a tenth of these, peaks were up to a third too low. Of
# what a cycle's file keeps every tenth will do.
SAMPLES, KEPT_EVERY = 7200, 10
STEADY = {
    "change": Result("1", "largest change of a state over the cycle, relative; steady below 1e-5"),
    "periods": Result("1", "periods that were computed until the cycle was steady"),
}
# Of outputs that a cycle's file keeps.
KEPT = (
    "load", "film_thickness", "maximum_pressure", "position", "velocity", "valve_lift", "spring_force",
    "seat_force", "minimum_film_thickness", "friction_torque", "supplied_torque", "pressure", "extension",
    "cam_lift", "force", "lower_force", "upper_force", "pivot_force", "support_force",
    # What moves the drawing of the report.
    "cam_angle", "profile_angle", "rotation", "pivot_position", "coil_position", "half_width",
    "radius_of_curvature", "tip_contact_radius",
)  # fmt: skip


@dataclass(frozen=True)
class SpeedSubject(NumberedSubject):
    """The tables of a scenario, the name of its flywheel, and the folder for the cycles (None: not kept).

    At speeds without an equilibrium to begin with its cycles begin at those of the subject `near`, which has
    the same components.
    """

    axis, display_unit = SPEED, "rpm"

    tables: Mapping[str, Any]
    flywheel: str
    folder: str | None = None
    near: "SpeedSubject | None" = None

    @functools.cached_property
    def scenario(self) -> Scenario:
        return build_scenario(self.tables)

    @property
    def results(self) -> Mapping[str, Result]:
        return {**describe_numbers(self.scenario), **STEADY}

    def list_warnings(self, values: Mapping[str, Value]) -> list[str]:
        return list_notices(self.scenario)

    def content(self) -> str:
        return to_full_toml(self.scenario)

    def system_at(self, speed: float) -> System:
        """The system that turns at this speed (rad/s), in balance; ModelError if it has none."""
        scenario = self._turn(speed)
        return resolve_start(scenario, build_system(scenario))

    def _turn(self, speed: float) -> Scenario:
        ends = {f"{self.flywheel}.{name}": speed for name in ("initial_speed", "final_speed")}
        return build_scenario(put_parameters(self.tables, ends))

    def find_cycle_at(
        self, speed: float, tolerance: float = TOLERANCE, steady: float = LARGEST_CHANGE
    ) -> Cycle:
        """The cycle at this speed (rad/s); tolerance and largest change as `find_cycle` takes them."""
        start = None
        try:
            system = self.system_at(speed)
        except ModelError:
            if self.near is None:
                raise
            system, start = build_system(self._turn(speed)), self.near.find_cycle_at(speed).end
        period, turning = find_period(system, speed), [f"{self.flywheel}.angle"]
        return find_cycle(system, period, turning, start, SAMPLES, tolerance=tolerance, steady=steady)

    def measure_at(self, speed: float, tolerance: float, steady: float) -> dict[str, float]:
        """The results of that cycle."""
        return measure_cycle(self.find_cycle_at(speed, tolerance, steady), self.flywheel)

    def find_motion_at(self, speed: float) -> Motion:
        """The cycle at this speed (rad/s)."""
        return to_motion(self.find_cycle_at(speed), self.flywheel)

    def evaluate(self, values: Mapping[str, Value]) -> Mapping[str, float | str]:
        speed = float(values["speed"])
        cycle = self.find_cycle_at(speed)
        if self.folder is not None:
            angle = Part(to_motion(cycle, self.flywheel), self.flywheel).angle
            modes = find_open_modes(cycle)
            save_cycle(cycle, angle, modes, cycle_path(Path(self.folder), speed))
        return measure_cycle(cycle, self.flywheel)


def find_own_speed(scenario: Scenario, flywheel: str) -> float:
    """The speed of the flywheel in the scenario (rad/s)."""
    return list_parameters(scenario)[f"{flywheel}.initial_speed"]


def find_flywheel(scenario: Scenario) -> str:
    """The one that prescribes the speed; MistakeError if there is none, or no cam that it drives."""
    components = {name: table.resolve() for name, table in scenario.components.items()}
    drives = [name for name, component in components.items() if component.has_role(roles.Drive)]
    if drives and not any(component.has_role(roles.Cam) for component in components.values()):
        raise MistakeError(f"{scenario.name}: has no cam; only cams have cycles over speed")
    for name in drives:
        if scenario.components[name].parameters.get("motion", "prescribed") == "prescribed":
            return name
    raise MistakeError(
        f"{scenario.name}: no flywheel prescribes the speed; a sweep over speed needs one with "
        'motion = "prescribed"'
    )


def check_varied(parameter: str, flywheel: str) -> None:
    """MistakeError for one that says the speed of a cycle, which is given apart."""
    if parameter in (f"{flywheel}.initial_speed", f"{flywheel}.final_speed"):
        raise MistakeError(f"{parameter}: is the speed of the cycle, which has no other one; leave it out")


def count_turns(system: System) -> int:
    """Turns of the drive in a period: two where a camshaft turns at half its speed."""
    ratios = list_ratios(system)
    turns = round(1.0 / min(ratios, default=1.0))
    if any(
        not math.isclose(ratio * turns, round(ratio * turns)) or round(ratio * turns) < 1 for ratio in ratios
    ):
        raise ModelError(f"drive ratios {', '.join(f'{r:g}' for r in ratios)}: have no common period")
    return max(1, turns)


def find_period(system: System, speed: float) -> float:
    """Of the cycle (s) at this speed (rad/s) of the drive."""
    return count_turns(system) * 2.0 * math.pi / speed


def measure_cycle(cycle: Cycle, flywheel: str) -> dict[str, float]:
    """The results of a cycle, by "part.figure", and those of STEADY."""
    motion = to_motion(cycle, flywheel)
    found = {f"{part}.{name}": value.value for part, name, _, value in measure(motion)}
    return found | {"change": cycle.change, "periods": float(cycle.periods)}


def describe_numbers(scenario: Scenario) -> dict[str, Result]:
    """The results of every cycle of the scenario, by "part.figure"."""
    components = {name: table.resolve() for name, table in scenario.components.items()}
    return {
        f"{part}.{name}": Result(quantity.unit, quantity.description, display_unit=quantity.display_unit)
        for part, name, (quantity, _) in list_figures(components)
    }


def find_angle(system: System, flywheel: str) -> Angle:
    """Over which parts without a cam of their own are read: the first one's, without any the flywheel's."""
    cams = [train.angle for train in find_trains(system)]
    return next(iter(cams), Angle("shaft_angle", f"{flywheel}.angle"))


def to_motion(cycle: Cycle, flywheel: str) -> Motion:
    return Motion(cycle.system, cycle.times, cycle.__getitem__, find_angle(cycle.system, flywheel))


def cycle_path(folder: Path, speed: float) -> Path:
    return folder / f"{speed * 30.0 / math.pi:09.3f}rpm.nc"


def _describe(quantity: Quantity) -> dict[str, str]:
    shown = {"display_units": quantity.display_unit} if quantity.display_unit else {}
    return {"units": quantity.unit, "long_name": quantity.description, **shown}


def find_open_modes(cycle: Cycle) -> list[Mode]:
    """The natural oscillations where the first train's valve is at its largest lift; none without a valve."""
    for train in find_trains(cycle.system):
        row = int(np.argmax(cycle[train.lift]))
        return find_modes(cycle.system, float(cycle.times[row]), cycle.states[row])
    return []


def save_cycle(cycle: Cycle, angle: Vector, modes: Sequence[Mode], path: Path) -> None:
    """The angle and the main outputs, in SI units, and the natural oscillations in attributes."""
    fields = {
        f"{part}.{field.name}": field.quantity
        for part, instance in cycle.system.instances.items()
        for field in instance.component.outputs.fields
        if field.name.partition("[")[0] in KEPT
    }
    data = xarray.Dataset(
        {name: ("time", cycle[name][::KEPT_EVERY], _describe(quantity)) for name, quantity in fields.items()},
        {
            "time": ("time", cycle.times[::KEPT_EVERY], {"units": "s"}),
            "cam_angle": ("time", angle[::KEPT_EVERY], {"units": "rad"}),
        },
        {
            "steady": int(cycle.steady),
            "natural_frequencies": [mode.frequency for mode in modes],
            "damping_ratios": [mode.damping for mode in modes],
            "moving_states": [mode.state for mode in modes],
        },
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    data.to_netcdf(path, engine="h5netcdf")
