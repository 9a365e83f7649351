"""A survey in tables and sentences."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator

from rich import box
from rich.table import Table
from rich.text import Text

from ..masters import name_of
from .behaviour import SPACING
from .findings import Survey, Surveyed


def shown_time(seconds: float) -> str:
    """A step with a unit: 5 us; "-" where there is none."""
    if not (math.isfinite(seconds) and seconds > 0.0):
        return "-"
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= 0.9999 * size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def table(found: Survey) -> Table:
    """One row a method, the cheapest first."""
    made = Table(
        title=f"{found.scenario.name}: methods about its linearisation, cheapest first",
        title_justify="left",
        box=box.SIMPLE_HEAD,
        pad_edge=False,
    )
    made.add_column("master, signal", no_wrap=True)
    at = shown_time(found.scenario.macro_step)
    heads = (
        "stable\nup to",
        "iteration\ncontracts",
        f"error at\n{at}",
        "within tol.\nup to",
        "advised\nstep",
    )
    for head in (*heads, "participant\nsteps/s"):
        made.add_column(head, justify="right", no_wrap=True)
    made.add_column("")
    for method in found.methods:
        marks = [("advised", "bold green")] if method is found.best else []
        marks += [("scenario", "")] if method is found.own else []
        mark = Text(", ".join(text for text, _ in marks), marks[0][1] if marks else "")
        made.add_row(*cells(found, method), mark)
    return made


def cells(found: Survey, method: Surveyed) -> list[str]:
    """The columns of a method's row."""
    return [
        method.name,
        _limit(method),
        "" if not method.master.implicit else shown_time(method.contracting),
        _error(found, method),
        shown_time(method.within),
        shown_time(method.recommended),
        f"{method.cost:.2g}" if math.isfinite(method.cost) else "-",
    ]


def _limit(method: Surveyed) -> str:
    return f"> {shown_time(method.seen[-1].step)}" if math.isinf(method.limit) else shown_time(method.limit)


def _error(found: Survey, method: Surveyed) -> str:
    errors = method.errors.get(found.scenario.macro_step)
    if found.scenario.macro_step >= method.limit:
        return "unstable"
    return f"{max(errors.values()):.1e}" if errors else "-"


def sentences(found: Survey) -> Iterator[str]:
    """What the table does not say: loops, the connection that runs away, the advice."""
    yield _loops(found)
    yield _own(found)
    best = found.best
    if best is None:
        yield "No method is advised: none is stable and within the tolerance at the steps looked at."
    else:
        yield f"Advised: {setting(best)}"
    yield (
        f"Linearised at {len(found.points)} instants; limits are those of the hardest. Errors are carried "
        f"up to t = {found.until:g} s, about t = {found.typical:.4g} s."
    )
    yield (
        f"Macro steps were scanned upwards, {SPACING:.0%} or {SPACING:g} rad of a participant's fastest "
        "oscillation apart: a narrower island of instability can be missed."
    )
    yield from _linearised(found)
    if any(instance.component.events for instance in found.system.instances.values()):
        yield "Impacts and changes of mode are no part of this; errors are those about the worst instant."
    if found.kinks:
        yield f"Kinks at an instant, taken on their steeper side: {', '.join(found.kinks)}."


def _linearised(found: Survey) -> Iterator[str]:
    """How participants were, and what is doubtful about it."""
    components = [name for name in found.system.instances if name not in found.participants]
    who = ", ".join(components) if found.participants else "all participants"
    said = [f"By their equations: {who} (components stand for their own FMUs)"] * bool(components)
    ways: dict[str, list[str]] = {}
    for participant in found.participants.values():
        how, which = participant.told
        ways.setdefault(how, []).append(which)
    said += [f"{how}: {', '.join(each)}" for how, each in ways.items()]
    yield f"{'. '.join(said)}."
    for participant in found.participants.values():
        yield from participant.doubts()
    for reason in found.left_out:
        yield f"Instant left out: {reason}."


def _loops(found: Survey) -> str:
    loops = found.partition.loops
    if not loops:
        return "No loop: no connection that has an effect leads back, so every step is stable."
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
    return f"Worth iterating: {'; '.join(each)}. The other {rest} connections lead one way or nowhere."


def _own(found: Survey) -> str:
    own, step = found.own, found.scenario.macro_step
    said = f"The scenario's {own.name} at {shown_time(step)}"
    if own.culprit is not None:
        targets = [str(c.target) for c in found.system.connections if c.source == own.culprit]
        where = f"{own.culprit} -> {', '.join(targets)}"
        end = f"; beyond {shown_time(own.limit)} {where} runs away, first at t = {own.hardest:.4g} s"
    else:
        end = ""
    if step >= own.limit:
        return f"{said}: UNSTABLE{end}."
    errors = own.errors.get(step, {})
    shown = ", ".join(f"{n} {e:.1e} (allowed {found.scenario.tolerance[n]:g})" for n, e in errors.items())
    return f"{said}: stable; estimated errors {shown}{end}."


def setting(method: Surveyed) -> str:
    """The method as a scenario states it."""
    lines = [
        f'macro_step = "{shown_time(method.recommended)}"',
        f'[master] name = "{name_of(method.master)}"',
        f'extrapolation = "{method.master.extrapolation}"',
    ]
    named = {key: getattr(method.master, key, ()) for key in ("order", "iterate")}
    lines += [f"{key} = [{', '.join(map(_quoted, names))}]" for key, names in named.items() if names]
    return ", ".join(lines)


def _quoted(text: str) -> str:
    return f'"{text}"'
