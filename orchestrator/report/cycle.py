"""What a page needs that computes the steady cycle of a train: the train as code, its numbers, sliders."""

import base64
import math
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from sys import float_info
from typing import Any

from models.contact.oils import ZERO_CELSIUS
from models.core import roles
from models.core.component import Component
from models.core.system import System

from ..assessment.springs import closes_at_once, list_springs
from ..assessment.trains import LIFTED, find_trains
from ..errors import MistakeError
from ..scenario import Scenario, ScenarioError
from ..scenario.oil import evaluate
from ..scenario.system import build_system, list_parameters
from .content import assemble, choose, describe, list_marks
from .mechanism import list_sketches

# Instants of a cycle besides its begin.
SAMPLES = 720
PANELS = (".load", ".film_thickness", ".velocity", ".position")
RPM = 30.0 / math.pi
# A lash (m) that gives the ratio of a train without one.
SMALL = 1e-6
# Positions of sliders: shares of the scenario's number, and temperatures (degC).
SHARES = tuple(k / 20 for k in range(8, 41))
TEMPERATURES = tuple(range(30, 155, 5))
# To which turns of a cam (r/min) the slider of the speed reaches: most trains lose contact at 1500 to 5500.
HIGHEST = 6000.0
# Parameters with a slider, by their endings, and the units that are shown.
VARIED = {
    "spring_rate": (1e-3, "N/mm"),
    "preload": (1.0, "N"),
    "lash": (1e3, "mm"),
    "viscosity": (1e3, "mPa.s"),
}


@dataclass(frozen=True)
class Train:
    """A scenario's whole train as one component, as code for a page, and what turns it: the flywheel, and its
    turns in a period. `licenses` are those of the code, by part. `command` runs the scenario;
    `change("path=value")` is it with another value."""

    scenario: Scenario
    component: Component
    code: bytes
    licenses: Mapping[str, str]
    flywheel: str
    turns: int
    command: str
    change: Callable[[str], Scenario]


def collect_cycle(train: Train) -> tuple[dict[str, Any], dict[str, Any]]:
    """What the page says, and its content."""
    component, name = train.component, train.scenario.name
    names = list(component.outputs.names)
    angle = find_abscissa(build_system(train.scenario), names)
    sketches = list_sketches(train.scenario, names)
    cycle = _tell_train(train, f"{train.flywheel}.angle")
    bases = [{"rows": SAMPLES + 1, "stretch": 1, "begin": 0.0, "every": 1.0, "end": float(SAMPLES)}]
    variables = [_describe(n, f.quantity) for n, f in zip(names, component.outputs.fields, strict=True)]
    marks = list_marks(names, lambda part: [])
    content = assemble(bases, variables, sketches, choose(names, PANELS), angle, marks) | {"cycle": cycle}
    title, command = f"{name}: steady cycle", cycle["command"]
    said = {"name": name, "title": title, "kind": "", "verdict": "computing", "command": command}
    return said, content


def find_abscissa(system: System, names: Sequence[str]) -> str:
    """The first cam's angle among the names, "" for none: a finger's is that of its profile."""
    profiles = (train.angle.source for train in find_trains(system))
    angles = [name for name in names if name.endswith(".cam_angle")]
    return next((name for name in (*angles, *profiles) if name in names), "")


def _describe(name: str, quantity: Any) -> dict[str, Any]:
    attributes = {
        "units": quantity.unit,
        "display_units": quantity.display_unit,
        "long_name": quantity.description,
    }
    return {**describe(name, attributes), "group": "coupled", "base": 0, "data": {}}


def _tell_train(train: Train, turning: str) -> dict[str, Any]:
    component = train.component
    fields = component.state.fields
    return {
        "code": base64.b64encode(zlib.compress(train.code, 9)).decode(),
        "licenses": train.licenses,
        "parameters": list(map(float, component.parameters.start)),
        "inputs": list(map(float, component.inputs.start)),
        "state": list(map(float, component.state.start)),
        "nominal": list(map(float, component.state.nominal)),
        "held": [int(f.name == turning or f.quantity.accumulates) for f in fields],
        "positive": [int(f.quantity.positive) for f in fields],
        "outputs": list(component.outputs.names),
        "command": train.command,
        "sliders": [slider for slider in _list_sliders(train) if len(slider["positions"]) > 1],
        "lifted": LIFTED,
        "trains": list(_tell_parts(train)),
    }


def _tell_parts(train: Train) -> Iterator[dict[str, Any]]:
    """What each cam moves: parts of which the page says figures, contacts with their elastic limits (Pa),
    springs whose coils touch all at once, and by what its contacts are judged (`ContactLaw`): a tenth of the
    largest lift (m), and which parameters are lashes, each with what the cam lifts for it, in shares of it. A
    valve without a seat has none."""
    parameters = train.component.parameters
    numbers = dict(zip(parameters.names, parameters.start, strict=True))
    system = build_system(train.scenario)
    for one in find_trains(system):
        valves = one.list_parts(roles.Valve)
        # JSON has no infinity, which tells bodies that never yield.
        limits = {name: min(numbers[f"{name}.elastic_limit"], float_info.max) for name in one.contacts}
        yield {
            "lift": f"{one.cam}.cam_lift",
            "contacts": limits,
            "valves": [name for name in valves if numbers.get(f"{name}.seat_stiffness")],
            "springs": [name for name in list_springs(one) if closes_at_once(system.instances[name])],
            "lashes": [
                [parameters.index(at), one.find_cam_lash(numbers[at] or SMALL) / (numbers[at] or SMALL)]
                for name in valves
                if (at := f"{name}.lash") in numbers
            ],
            "lobe": LIFTED * one.largest_lift,
            "rests": one.contact_law.rests,
        }


def _list_sliders(train: Train) -> Iterator[dict[str, Any]]:
    """Each with its positions: what they show, and what they change (see `_position`)."""
    base, fields = list_parameters(train.scenario), train.component.parameters.fields
    said = {field.name: field.quantity.description for field in fields}
    yield _vary_speed(train, base)
    temperatures = list(_list_temperatures(train, base))
    for name, value in base.items():
        part, _, ending = name.partition(".")
        if ending == "viscosity" and temperatures:
            continue
        if ending in VARIED and value > 0.0 and name in said:
            factor, unit = VARIED[ending]
            positions = [_position(train, {name: s * value}, s * value * factor) for s in SHARES]
            label = f"{ending.replace('_', ' ')} of {part}"
            yield _slider(label, said[name], unit, SHARES.index(1.0), positions, [_key(name)])
    yield from temperatures


def _slider(
    name: str, description: str, unit: str, at: int, positions: Sequence[Any], keys: Sequence[str]
) -> dict[str, Any]:
    """`at` is the scenario's position; `keys` of the scenario take what a position shows, in its unit."""
    return {
        "name": name, "description": description, "unit": unit, "at": at, "positions": positions, "keys": keys
    }  # fmt: skip


def _key(name: str) -> str:
    return "components.{}.parameters.{}".format(*name.split(".", 1))


def _vary_speed(train: Train, base: Mapping[str, float]) -> dict[str, Any]:
    """Far beyond the speeds at which cams lose contact."""
    speed = base[f"{train.flywheel}.initial_speed"]
    ends = [name for end in ("initial", "final") if (name := f"{train.flywheel}.{end}_speed") in base]
    state = train.component.state.names.index(f"{train.flywheel}.speed")
    most = max(SHARES[-1], HIGHEST * train.turns / (speed * RPM))
    positions = []
    for k in range(round(SHARES[0] * 20), math.ceil(most * 20) + 1):
        own = k / 20 * speed
        turning = {"state": [[state, own]], "period": train.turns * 2.0 * math.pi / own}
        positions.append(_position(train, dict.fromkeys(ends, own), own * RPM) | turning)
    at = SHARES.index(1.0)
    return _slider("speed", f"speed of {train.flywheel}", "r/min", at, positions, list(map(_key, ends)))


def _list_temperatures(train: Train, base: Mapping[str, float]) -> Iterator[dict[str, Any]]:
    """Of a scenario with an oil: its numbers at each temperature, the scenario's own among them."""
    oil, written = train.scenario.oil, train.scenario.temperature
    if oil is None or written is None:
        return
    own = round(evaluate({"oil": oil, "temperature": written})[0] - ZERO_CELSIUS, 6)
    positions, temperatures = [], sorted({own, *TEMPERATURES})
    for temperature in temperatures:
        try:
            found = list_parameters(train.change(f'temperature="{temperature} degC"'))
        except (ScenarioError, MistakeError):
            return
        changed = {name: value for name, value in found.items() if value != base[name] and temperature != own}
        positions.append(_position(train, changed, temperature))
    if any(one["parameters"] for one in positions):
        at, said = temperatures.index(own), "temperature of the oil"
        yield _slider("oil temperature", said, "degC", at, positions, ["temperature"])


def _position(train: Train, changed: Mapping[str, float], shown: float) -> dict[str, Any]:
    """What a position shows, and the numbers of the train that it changes, by place."""
    names = list(train.component.parameters.names)
    places = [[names.index(name), value] for name, value in changed.items() if name in names]
    return {"shown": shown, "parameters": places}
