"""A survey as a table and sentences, and in files: stability.nc, stability.csv, stability.png."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Callable, Iterator
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.table import Table
from rich.text import Text

from models.core.words import tally

from ...masters import find_name
from ...reporter import make_table
from ...scenario.files import to_full_toml
from ...scenario.units import format_time
from ...store.csv_file import write_sheet
from .behaviour import SPACING
from .survey import AssessedMethod, Survey

if TYPE_CHECKING:
    import xarray

# Participants of an order in the table.
SHOWN = 4


def build_table(found: Survey) -> Table:
    """Build a table with a row for each method, the cheapest first."""
    at = format_time(found.scenario.macro_step)
    title = f"{found.scenario.name}: methods about its linearisation, cheapest first"
    steps = ("within tol.\nup to", "advised\nstep", "participant\nsteps/s")
    heads = ("stable\nup to", "iteration\ncontracts", f"error at\n{at}", *steps)
    table = make_table(title, ["master, signal"], heads)
    table.add_column("")
    for method in found.methods:
        marks = [("advised", "bold green")] if method is found.best else []
        marks += [("scenario", "")] if method is found.own else []
        mark = Text(", ".join(text for text, _ in marks), marks[0][1] if marks else "")
        table.add_row(*format_row(found, method), mark)
    return table


def format_row(found: Survey, method: AssessedMethod) -> list[str]:
    """Format the cells of a method's row."""
    return [
        _format_name(found, method),
        _format_limit(method),
        "" if not method.master.implicit else _format_tried(method.contracting_step, method.samples[-1].step),
        _format_error(found, method),
        _format_tried(method.accurate_step, max(method.errors, default=math.inf)),
        format_time(method.advised_step),
        f"{method.cost:.2g}" if math.isfinite(method.cost) else "-",
    ]


def _format_name(found: Survey, method: AssessedMethod) -> str:
    """The method's name; with the first participants in its order, where another one has that name too."""
    alike = [other for other in found.methods if other.name == method.name]
    if len(alike) == 1 or not method.order:
        return method.name
    more = ", ..." if len(method.order) > SHOWN else ""
    return f"{method.name}\n  order {', '.join(method.order[:SHOWN])}{more}"


def _format_limit(method: AssessedMethod) -> str:
    return _format_tried(method.limit, method.samples[-1].step if math.isinf(method.limit) else math.inf)


def _format_tried(step: float, last: float) -> str:
    """A limit, or the `last` step tried where it lies beyond."""
    return f"≥ {format_time(last)}" if step >= last else format_time(step)


def _format_error(found: Survey, method: AssessedMethod) -> str:
    errors = method.errors.get(found.scenario.macro_step)
    if found.scenario.macro_step >= method.limit:
        return "unstable"
    return f"{max(errors.values()):.1e}" if errors else "-"


def describe(found: Survey) -> Iterator[str]:
    """Describe what the table lacks: loops, the growing value, the advice."""
    yield _describe_loops(found)
    yield _describe_own(found)
    best = found.best
    if best is None:
        yield "No method is advised: none is stable and within the tolerance at any step tried."
    else:
        yield f"Advised: {format_settings(best)}"
    yield (
        f"Linearised at {tally(len(found.points), 'instant')}; limits are those of the hardest. "
        f"Errors are carried up to t = {found.motion.times[-1]:g} s, about t = {found.typical.time:.4g} s."
    )
    yield (
        f"The scan of macro steps has a spacing of {SPACING:.0%} or {SPACING:g} rad of a participant's "
        "fastest oscillation: it can miss a narrower island of instability."
    )
    yield from _describe_linearisation(found)
    if any(instance.component.events for instance in found.system.instances.values()):
        yield "Impacts and changes of mode are left out; errors are those about the worst instant."
    if found.kinks:
        yield f"Kinks, linearised on their steeper side: {', '.join(found.kinks)}."


def _describe_linearisation(found: Survey) -> Iterator[str]:
    """Describe how participants were linearised, and doubts about it."""
    components = [name for name in found.system.instances if name not in found.participants]
    who = ", ".join(components) if found.participants else "all participants"
    said = [f"By their equations: {who} (components stand for their own FMUs)"] * bool(components)
    ways: dict[str, list[str]] = {}
    for participant in found.participants.values():
        how, which = participant.description
        ways.setdefault(how, []).append(which)
    said += [f"{how}: {', '.join(each)}" for how, each in ways.items()]
    yield f"{'. '.join(said)}."
    for participant in found.participants.values():
        yield from participant.describe_doubts()
    for reason in found.left_out:
        yield f"Instant left out: {reason}."


def _describe_loops(found: Survey) -> str:
    loops = found.partition.loops
    if not loops:
        return "No loop: no connection with an effect leads back, so every step is stable."
    parts: dict[tuple[str, ...], str] = {}
    again: Counter[tuple[str, ...]] = Counter()
    for loop in loops:
        names = list(dict.fromkeys(c.source.instance for c in loop))
        kind = tuple(sorted(found.system.instances[name].component.name for name in names))
        said = f"{', '.join(names)} through {', '.join(dict.fromkeys(str(c.source) for c in loop))}"
        again[kind] += kind in parts
        parts.setdefault(kind, said)
    each = [
        f"{said}{f' and {again[kind]} like these' if again[kind] else ''}" for kind, said in parts.items()
    ]
    rest = len(found.system.connections) - sum(len(loop) for loop in loops)
    others = f" The other {rest} connections lead one way or nowhere." if rest else ""
    return f"Worth iterating: {'; '.join(each)}.{others}"


def _describe_own(found: Survey) -> str:
    own, step = found.own, found.scenario.macro_step
    said = f"The scenario's {own.name} at {format_time(step)}"
    if own.growing_output is not None:
        targets = [str(c.target) for c in found.system.connections if c.source == own.growing_output]
        where = f"{own.growing_output} -> {', '.join(targets)}"
        end = f"; beyond {format_time(own.limit)} {where} runs away, first at t = {own.hardest_time:.4g} s"
    else:
        end = ""
    if step >= own.limit:
        return f"{said}: UNSTABLE{end}."
    errors = own.errors.get(step, {})
    shown = ", ".join(f"{n} {e:.1e} (allowed {found.scenario.tolerance[n]:g})" for n, e in errors.items())
    return f"{said}: stable; estimated errors {shown}{end}."


def format_settings(method: AssessedMethod) -> str:
    """Format the method as a scenario states it."""
    lines = [
        f'macro_step = "{format_time(method.advised_step)}"',
        f'[master] name = "{find_name(method.master)}"',
        f'extrapolation = "{method.master.extrapolation}"',
    ]
    named = {"order": method.master.order, "iterate": method.master.iterate}
    lines += [f"{key} = [{', '.join(json.dumps(n) for n in names)}]" for key, names in named.items() if names]
    return ", ".join(lines)


NAME = "stability"


def build_dataset(found: Survey) -> xarray.Dataset:
    """Methods with their limits; samples of the spectral radius; estimates of the error."""
    import xarray

    methods = found.methods
    columns: dict[str, tuple[str, str, Callable[[AssessedMethod], Any]]] = {
        "master": ("", "co-simulation master", lambda m: find_name(m.master)),
        "extrapolation": ("", "input signals", lambda m: m.master.extrapolation),
        "order": ("", "order of the participants", lambda m: " ".join(m.order)),
        "largest_stable_step": (
            "s",
            "up to which all is stable, or the longest looked at",
            lambda m: min(m.limit, m.samples[-1].step),
        ),
        "always_stable": ("1", "stable at all steps looked at", lambda m: int(math.isinf(m.limit))),
        "hardest_time": ("s", "instant of the point with that limit", lambda m: m.hardest_time),
        "runs_away": ("", "exchanged value that grows beyond", lambda m: str(m.growing_output or "")),
        "contracting_step": ("s", "up to which plain iteration contracts", lambda m: m.contracting_step),
        "accurate_step": (
            "s",
            "up to which errors are within tolerance, as estimated",
            lambda m: m.accurate_step,
        ),
        "advised_step": ("s", "step with distance from both; 0: none", lambda m: m.advised_step),
        "participant_steps_per_second": ("1/s", "effort at the advised step", lambda m: m.cost),
        "advised": ("1", "the method advised", lambda m: int(m is found.best)),
        "of_scenario": ("1", "the scenario's method", lambda m: int(m is found.own)),
    }
    samples = [(i, at.step, at.radius, at.contraction) for i, m in enumerate(methods) for at in m.samples]
    number, step, radius, contraction = map(np.array, zip(*samples, strict=True))
    variables = list(found.scenario.tolerance)
    estimates = [
        (i, at, [e[v] for v in variables]) for i, m in enumerate(methods) for at, e in m.errors.items()
    ]
    data: dict[str, Any] = {
        name: ("method", [value(m) for m in methods], _attrs(unit, text))
        for name, (unit, text, value) in columns.items()
    }
    data |= {
        "sample_method": ("sample", number, _attrs("1", "number of the method")),
        "sample_step": ("sample", step, _attrs("s", "macro step")),
        "spectral_radius": (
            "sample", radius, _attrs("1", "of the step over the system's own growth; NaN: no convergence")
        ),
        "contraction": ("sample", contraction, _attrs("1", "of a plain iteration, NaN for explicit masters")),
        "estimate_method": ("estimate", [e[0] for e in estimates], _attrs("1", "number of the method")),
        "estimate_step": ("estimate", [e[1] for e in estimates], _attrs("s", "macro step")),
        "estimated_error": (
            ("estimate", "variable"),
            np.array([e[2] for e in estimates]).reshape(len(estimates), len(variables)),
            _attrs("1", "relative RMS error"),
        ),
        "tolerance": ("variable", list(found.scenario.tolerance.values()), _attrs("1", "allowed error")),
        "point_time": ("point", [p.time for p in found.points], _attrs("s", "instants of linearisation")),
    }  # fmt: skip
    versions = ", ".join(f"{name} {metadata.version(name)}" for name in ("tribocosim", "numpy", "scipy"))
    return xarray.Dataset(
        data,
        coords={"method": [m.name for m in methods], "variable": variables},
        attrs={
            "title": f"{found.scenario.name}: stability of its coupling, from a linearisation",
            "comment": " ".join(describe(found)),
            "scenario": to_full_toml(found.scenario),
            "macro_step": found.scenario.macro_step,
            "versions": versions,
            "Conventions": "CF-1.10",
        },
    )


def _attrs(unit: str, text: str) -> dict[str, str]:
    return {"units": unit, "long_name": text} if unit else {"long_name": text}


def write_survey(found: Survey, folder: Path) -> list[Path]:
    """The three files; `folder` exists."""
    from ...plots.style import save_figure
    from .figure import draw_figure

    table = build_dataset(found)
    files = [folder / f"{NAME}.{ending}" for ending in ("nc", "csv", "png")]
    table.to_netcdf(files[0], engine="h5netcdf")
    rows = table[[name for name, variable in table.data_vars.items() if variable.dims == ("method",)]]
    frame = rows.to_dataframe()
    units = {name: table[name].attrs.get("units", "") for name in frame.columns}
    frame.columns = [f"{name} [{units[name]}]" if units[name] else name for name in frame.columns]
    write_sheet(files[1], frame.to_csv())
    save_figure(lambda: draw_figure(found), files[2])
    return files
