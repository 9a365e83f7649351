"""What the scripts of a run's page need, as plain JSON values: times, packed variables, drawings, marks."""

from collections import defaultdict
from collections.abc import Callable, Container, Mapping, Sequence
from typing import Any

import numpy as np

from models.core.quantities import Vector
from models.core.system import System

from ..assessment.diagnosis.report import WORDS
from ..assessment.diagnosis.suggestions import percent
from ..assessment.lost_contact import FILMS, has_film
from ..assessment.trains import find_lost_rows
from ..engine.step import REASONS
from ..scenario import Scenario, parse_ends
from ..scenario.display import show_unit
from ..scenario.system import build_system
from ..store.records import Group, Records
from .mechanism import list_sketches
from .packing import COARSE, bucket, list_spans, pack, pack_detail, pack_exactly
from .sketch import Sketch

# Rows that are kept one by one; of more, least and largest values of as many stretches.
ROWS = 24_000
# Characters of packed numbers in a page; and of every row of long runs, besides.
ROOM, DETAIL_ROOM = 3_400_000, 5_600_000
# The rank of variables that nothing asks for.
REST = (True,) * 5
# Plots at first.
PANELS = 4
# What sets steps, shown in a colour of its own; report.css has as many.
KINDS = 7
STEP = ("macro_step", "reason", "source")
# What results say of a variable.
ATTRIBUTES = ("units", "display_units", "long_name", "flag_meanings")
# Relative distance of times from an even spacing, below which that is given instead.
EVEN = 1e-9


def collect_run(records: Records, scenario: Scenario | None, summary: Mapping[str, Any]) -> dict[str, Any]:
    """The content of a run's page."""
    known = records.groups["coupled"].names if "coupled" in records.groups else []
    sketches = list_sketches(scenario, known) if scenario else []
    bases, variables, left_out = _pack_groups(records, scenario, sketches, summary)
    panels = _choose_panels(variables, scenario, summary)
    _add_detail(records, bases, variables, panels)
    coupled = [str(v["name"]) for v in variables if v["group"] == "coupled"]
    system = build_system(scenario) if scenario else None
    abscissa = next((str(v["name"]) for v in variables if is_angle(str(v["name"]))), "")
    marks = list_marks(coupled, lambda part: [_list_lost(records, system, part)])
    return assemble(bases, variables, sketches, panels, abscissa, marks) | {
        "leftOut": left_out,
        "profiles": {name: _pack_profiles(group) for name, group in records.profiles.items()},
        "steps": _tell_steps(records, bases, variables, scenario),
    }


def assemble(
    bases: Sequence[Any], variables: Sequence[Any], sketches: Sequence[Sketch], panels: Sequence[str],
    abscissa: str, marks: Sequence[Any],
) -> dict[str, Any]:  # fmt: skip
    """What the scripts of every page get; `panels` are drawn at first, over the `abscissa`."""
    drawings = [sketch.content() for sketch in sketches]
    return {
        "bases": bases, "variables": variables, "leftOut": 0, "sketches": drawings, "panels": panels,
        "abscissa": abscissa, "marks": marks,
    }  # fmt: skip


def choose(names: Sequence[str], endings: Sequence[str]) -> list[str]:
    """The first name with each ending; of loads those of films come first."""
    filmed = sorted(names, key=lambda name: f"{name.rpartition('.')[0]}.film_thickness" not in names)
    found = (next((name for name in filmed if name.endswith(ending)), "") for ending in endings)
    return [name for name in found if name]


def is_angle(name: str) -> bool:
    """Whether it is an angle of the system, which belongs to no component."""
    return name in ("cam_angle", "crank_angle", "shaft_angle")


def _pack_groups(
    records: Records, scenario: Scenario | None, sketches: Sequence[Sketch], summary: Mapping[str, Any]
) -> tuple[list[dict[str, Any]], list[dict[str, Any]], int]:
    """Time bases, variables while there is room, and how many had none."""
    bases: list[dict[str, Any]] = []
    rank: Mapping[str, bool] = {}
    variables: list[dict[str, Any]] = []
    room, left_out = ROOM, 0
    for name, group in records.groups.items():
        if name == "reference" or not group.rows:
            continue
        base = _Base(group, name, len(bases))
        bases.append(base.content)
        reference = records.groups.get("reference") if name == "coupled" else None
        if reference and reference.rows != group.rows:
            reference = None
        names = [n for n in group.names if n != "time"]
        if name == "coupled":
            rank = rank_variables(names, scenario, sketches, summary)
            names = list(rank)
        for variable in names:
            packed = base.pack(group, variable, reference)
            if name == "coupled":
                packed["main"] = rank[variable]
            size = sum(len(text) for text in packed["data"].values())
            if size > room:
                left_out += 1
                continue
            room -= size
            variables.append(packed)
    return bases, variables, left_out


def rank_variables(
    names: Sequence[str], scenario: Scenario | None, sketches: Sequence[Sketch], summary: Mapping[str, Any]
) -> dict[str, bool]:
    """Variables that the sketches move by first, then those with an error, those that roles promise (lifts,
    loads, films), and the rest. True for all but the rest."""
    moving = set().union(*(sketch.variables for sketch in sketches)) if sketches else set()
    compared = set(summary.get("errors", {})) | set(scenario.tolerance if scenario else ())
    promised = {
        f"{part}.{variable}"
        for part, table in (scenario.components.items() if scenario else ())
        for role in table.resolve().roles
        for variable in role.promised
    }

    def rank(name: str) -> tuple[bool, ...]:
        return (
            not is_angle(name),
            name not in moving,
            name not in compared,
            name not in promised,
            not name.endswith((".load", ".film_thickness")),
        )

    return {name: rank(name) < REST for name in sorted(names, key=rank)}


def _pack_profiles(group: Group) -> dict[str, Any]:
    """Position, pressure and film at the nodes of a contact, instant by instant."""
    rows, nodes = group.stored["pressure"].shape
    packed = {key: pack(group.read(key).ravel(), COARSE) for key in ("position", "pressure", "film")}
    return {"nodes": nodes, "rows": rows, "time": pack_exactly(group.read("time")), **packed}


def _choose_panels(
    variables: Sequence[Mapping[str, Any]], scenario: Scenario | None, summary: Mapping[str, Any]
) -> list[str]:
    """The variables that are drawn at first: those with a tolerance, then loads, films and lifts."""
    known = [str(v["name"]) for v in variables if v["group"] == "coupled"]
    chosen = [name for name in summary.get("tolerance", {}) if name in known]
    for endings in ((".load",), (".film_thickness",), (".valve_lift", ".position"), (".piston_offset",)):
        chosen += [name for ending in endings for name in known if name.endswith(ending)][:1]
    return (list(dict.fromkeys(chosen)) or known)[:PANELS]


def _add_detail(
    records: Records, bases: list[dict[str, Any]], variables: Sequence[dict[str, Any]], panels: Sequence[str]
) -> None:
    """Every row of the variables that are drawn at first, and then of others, while there is room."""
    if not bases or bases[0]["stretch"] == 1:
        return
    group, room = records.groups["coupled"], DETAIL_ROOM
    base = {"stretch": 1, **_place_times(group.read("time"))}
    room -= len(base.get("time", ""))
    for variable in sorted(variables, key=lambda v: v["name"] not in panels):
        if variable["group"] != "coupled" or room < 0:
            continue
        values = _read(group, variable["name"])
        if not np.all(np.isfinite(values)):
            continue
        packed = pack_detail(values)
        if len(packed["text"]) > room:
            break
        room -= len(packed["text"])
        variable["data"]["detail"] = packed
        variable["detailBase"] = len(bases)
    bases.append(base)


def _place_times(times: Vector) -> dict[str, Any]:
    """Times that are evenly spaced as begin and distance, others as they are."""
    every = float(times[-1] - times[0]) / max(len(times) - 1, 1)
    placed = {"rows": len(times), "end": float(times[-1])}
    even = times[0] + every * np.arange(len(times))
    if np.max(np.abs(times - even)) <= EVEN * abs(float(times[-1] - times[0])):
        return {**placed, "begin": float(times[0]), "every": every}
    return {**placed, "time": pack_exactly(times)}


def list_marks(
    names: Sequence[str], list_lost: Callable[[str], Sequence[Sequence[Sequence[int]]]]
) -> list[dict[str, Any]]:
    """Loads of contacts, whose landings are marked, with the spans of rows in which contact is lost, one list
    for each cycle; and counters of impacts."""
    marks: list[dict[str, Any]] = []
    for name in names:
        part, _, ending = name.rpartition(".")
        if ending == "load" and f"{part}.film_thickness" in names:
            marks.append({"part": part, "kind": "load", "variable": name, "lost": list_lost(part)})
        elif ending == "impact_count":
            marks.append({"part": part, "kind": "count", "variable": name})
    return marks


def _list_lost(records: Records, system: System | None, part: str) -> list[list[int]]:
    group = records.groups["coupled"]
    return list_spans(find_lost_rows(system, part, group.read), _find_stretch(group.rows))


def _tell_steps(
    records: Records,
    bases: Sequence[Mapping[str, Any]],
    variables: Sequence[Mapping[str, Any]],
    scenario: Scenario | None,
) -> dict[str, Any] | None:
    """What set the macro steps, most frequent first; None where all were alike."""
    packed = [v for v in variables if v["group"] == "steps" and v["name"] in STEP]
    group = records.groups.get("steps")
    if group is None or len(packed) < len(STEP) or group.rows < 2:
        return None
    length, reason, source = (group.read(name) for name in STEP)
    if np.ptp(length[:-1]) <= 1e-6 * length[0]:
        return None
    names = group.attribute("source", "flag_meanings").split()
    counted: dict[str, int] = defaultdict(int)
    pairs: dict[str, list[list[Any]]] = defaultdict(list)
    found, counts = np.unique(np.column_stack([reason, source]), axis=0, return_counts=True)
    for (r, s), count in zip(found.astype(int).tolist(), counts.tolist(), strict=True):
        words = WORDS[REASONS[r]]
        if REASONS[r] == "error" and 0 <= s < len(names):
            words = f"error of {_name_connections(names[s], scenario)}"
        counted[words] += count
        pairs[words].append([r, s])
    ranked = sorted(counted, key=lambda words: -counted[words])
    kinds = [
        {"words": f"{words}: {percent(counted[words] / group.rows)}", "pairs": pairs[words]}
        for words in ranked[: KINDS - 1]
    ]
    if rest := ranked[KINDS - 1 :]:
        share = percent(sum(counted[words] for words in rest) / group.rows)
        kinds.append(
            {"words": f"others: {share}", "pairs": [pair for words in rest for pair in pairs[words]]}
        )
    return {"base": packed[0]["base"], "kinds": kinds}


def _name_connections(output: str, scenario: Scenario | None) -> str:
    """The connections that an output drives; the output where it drives none."""
    ends = map(parse_ends, scenario.connections) if scenario else ()
    targets = [target for source, target in ends if source == output]
    return f"{output} -> {', '.join(targets)}" if targets else output


def _read(group: Group, name: str) -> Vector:
    return read_film(name, group.stored, group.read)


def read_film(name: str, stored: Container[str], read: Callable[[str], Vector]) -> Vector:
    """The values of a variable; of a film where it has a meaning."""
    part, _, ending = name.rpartition(".")
    if ending not in FILMS or f"{part}.load" not in stored:
        return read(name)
    return np.where(has_film(ending, read(f"{part}.load")), read(name), np.nan)


def _find_stretch(rows: int) -> int:
    """How many rows a page takes together."""
    return -(-rows // ROWS)


class _Base:
    """The times of a group, thinned to stretches if there are many rows."""

    def __init__(self, group: Group, kind: str, number: int) -> None:
        self.kind, self.number = kind, number
        time = group.read("time")
        self.size = _find_stretch(len(time))
        self.content = {
            "rows": len(time),
            "stretch": self.size,
            "time": pack_exactly(time[:: self.size]),
            "end": float(time[-1]),
        }

    def pack(self, group: Group, name: str, reference: Group | None) -> dict[str, Any]:
        """A variable with its values, and those of its error where there is a reference on the same rows."""
        values = _read(group, name)
        data = self._pack(values, "values")
        if reference and name in reference.stored:
            data |= self._pack(values - _read(reference, name), "error", COARSE)
        attributes = {key: group.attribute(name, key) for key in ATTRIBUTES}
        return {**describe(name, attributes), "group": self.kind, "base": self.number, "data": data}

    def _pack(self, values: Vector, key: str, bits: int | None = None) -> dict[str, str]:
        own = {} if bits is None else {"bits": bits}
        if self.size == 1:
            return {key: pack(values, **own)}
        low, high = bucket(values, self.size)
        return {key: pack(low, **own), f"{key}High": pack(high, **own)}


def describe(name: str, attributes: Mapping[str, str]) -> dict[str, Any]:
    """Name, unit in which it is shown with the factor to it, description and choices of a variable."""
    shown = show_unit(attributes.get("units", ""), attributes.get("display_units", ""))
    return {
        "name": name,
        "unit": shown.text,
        "factor": shown.factor,
        "description": attributes.get("long_name", ""),
        "choices": attributes.get("flag_meanings", "").split(),
    }
