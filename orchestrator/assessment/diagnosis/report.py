"""The diagnosis of a run in words: a few lines after it; on demand an answer in sentences and everything.

The answer says where the time went, who limits the step, and what to change.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from models.core.words import tally

from ...engine.effort import Spent
from ...engine.step import REASONS
from ...errors import Command, MistakeError, Set, in_command_line
from ...scenario import Scenario, ScenarioError
from ...scenario.files import list_shipped, load, read
from ...scenario.units import choose_time_unit, format_time
from ...store.output_folder import SCENARIO, SUMMARY, find_newest, find_run_state, format_path
from .facts import Facts
from .numbers import Diagnosis, diagnose_steps
from .steps import Steps, read_steps
from .suggestions import percent, suggestions
from .times import MUCH, UNKNOWN, Part, Spending, list_parts, read_spending

SHOWN = 5  # variables, and spans of each
# A reason's name in words.
WORDS = {
    "fixed": "macro_step",
    "error": "error of the coupling",
    "maximum_step": "maximum_step",
    "stop_time": "stop_time",
    "event": "event located",
    "time_event": "time event",
    "discontinuity": "minimum_step (discontinuity)",
    "convergence": "no convergence before",
    "discard": "refused before",
    "growth": "growth from a shorter step",
}
EVEN = 1.5  # times the mean work: below, no interval is worth naming


WORTH_TELLING = 0.1  # of the time
# An error below this share of what is allowed may grow by as much as steps are made longer.
WELL_WITHIN = 0.1
LIMITING = {
    "fixed": "every step has the length `macro_step`",
    "maximum_step": "the step is limited by `step_control.maximum_step`",
    "stop_time": "the run ends with its first steps",
    "event": "located events end the steps",
    "time_event": "events at known times end the steps",
    "discontinuity": "the step is limited by `step_control.minimum_step`: outputs jump",
    "convergence": "the step is limited by iterations that do not converge",
    "discard": "the step is limited by participants that refuse longer ones",
    "growth": "the step still grows from a shorter one",
}


def answer(facts: Facts, spending: Spending, parts: Sequence[Part], suggestions: Sequence[str]) -> list[str]:
    """Three sentences; the first only where the run left its times."""
    return [*_tell_time(spending, parts), _tell_limit(facts), _tell_change(facts, spending, suggestions)]


def _tell_time(spending: Spending, parts: Sequence[Part]) -> list[str]:
    if not parts:
        return []
    wall, once, said = spending.wall_s, [part for part in parts if part.once], "of the "
    if (spent := sum(part.seconds for part in once)) > WORTH_TELLING * wall:
        names = " and ".join(part.name for part in once)
        said = (
            f"{names} took {percent(spent / wall)} of the {wall:.3g} s, once on this machine; of the other "
        )
    left = wall - spent if spent > WORTH_TELLING * wall else wall
    first, second, *_ = [part for part in parts if not part.once] + 2 * [Part("", 0.0)]
    said += f"{left:.3g} s, {percent(first.seconds / left)} went into {first.name}"
    said += f" ({first.remedy})" if first.remedy else ""
    if first.seconds < MUCH * left:
        said += f" and {percent(second.seconds / left)} into {second.name}"
    return [f"Time: {said}."]


def _tell_limit(facts: Facts) -> str:
    """What sets most steps, and who has most of the refused attempts."""
    d = facts.diagnosis
    reason, share = next(iter(d.reasons.items()))
    length = f"{format_time(d.length['median'])} in the median"
    if reason == "error" and d.limits:
        variable, limit = next(iter(d.limits.items()))
        name, _, output = variable.partition(".")
        said = (
            f"participant {name} limits {percent(limit.steps)} of the {d.steps} steps by its output {output}"
        )
    else:
        said = LIMITING.get(reason, "the step is limited by the error of the coupling")
        said += f" in {percent(share.steps)} of the {d.steps} steps" if share.steps < 1.0 else ""
    return f"Step: {said}; {length}{_tell_refused(facts)}."


def _tell_refused(facts: Facts) -> str:
    """The cause of most refused attempts."""
    d, steps = facts.diagnosis, facts.steps
    if not d.rejected:
        return ""
    said = f"; refused: {tally(d.rejected, 'attempt')} ({percent(d.rejected_share)})"
    reason, count = max(d.rejections.items(), key=lambda item: item[1])
    own = steps.reason == REASONS.index(reason)
    sources = np.bincount(steps.source[own] + 1, steps.rejected[own])
    worst = int(np.argmax(sources))
    of = f" of {steps.name(worst - 1)}" if worst else ""
    words = {"error": "for the error", "convergence": "for iterations that did not converge"}
    why = words.get(reason, f"before a step set by {reason}")
    return f"{said}, {percent(count / d.rejected)} of them {why}{of}"


def _tell_change(facts: Facts, spending: Spending, suggestions: Sequence[str]) -> str:
    """The first suggestion; without one what the error leaves room for."""
    if suggestions:
        return f"Change: {suggestions[0]}."
    output, share = spending.error
    control, scenario = facts.scenario.step_control, facts.scenario
    subject = format_path(scenario.origin.path) if scenario.origin else scenario.name
    if output and share < WELL_WITHIN and next(iter(facts.diagnosis.reasons)) in ("error", "fixed"):
        key, value = (
            ("step_control.relative", control.relative) if control else ("macro_step", scenario.macro_step)
        )
        more = (0.5 / max(share, 0.05) if control else 2.0) * value
        longer = Set(key, f"{more:.2g}" if control else format_time(more))
        words = "`", longer, "` for fewer steps; `", Command("masters", (subject,)), "` compares others."
        said = f"Change: {output}, the least exact, has {percent(share)} of the error allowed: try "
        return in_command_line((said, words))
    if not output:
        wanted = "its comparison with the reference, which it lacks,"
        if not scenario.reference.enabled:
            wanted = "a reference (`reference.enabled = true`, with a `tolerance`)"
        return (
            "Change: none is advised for the steps; whether their error leaves room for longer ones, only "
            f"{wanted} shows."
        )
    return f"Change: none is advised for the steps; {output} has {percent(share)} of the error allowed."


def brief(d: Diagnosis, suggestions: Sequence[str]) -> list[str]:
    """A few lines for the end of a run; none for steps of one length that all went alike."""
    lines = []
    if set(d.reasons) - {"fixed", "stop_time"}:
        parts = [f"{percent(share.steps)} {WORDS[reason]}" for reason, share in d.reasons.items()]
        rejected = f"; {percent(d.rejected_share)} of the attempts rejected" if d.rejected else ""
        lines.append(f"steps set by: {', '.join(parts)}{rejected}")
        if d.limits:
            whole = sum(limit.steps for limit in d.limits.values())
            parts = [f"{name} {percent(limit.steps / whole)}" for name, limit in list(d.limits.items())[:3]]
            lines.append(f"error limited by: {', '.join(parts)}")
        lines.append(
            f"step length {format_time(d.length['p05'])} to {format_time(d.length['p95'])} (5 and 95 %), "
            f"{d.mean_iterations:.1f} iterations a step"
        )
    lines += _over(d)
    return lines + [f"suggestion: {text}" for text in suggestions]


def _over(d: Diagnosis) -> list[str]:
    """A line about steps that were kept though their error was too large."""
    count, worst, at = d.over
    if not count:
        return []
    return [
        f"{count} of {d.steps} steps were over the tolerance and not made again, by {worst:.3g} times at "
        f"most, at t = {at:.6g} s"
    ]


def full(facts: Facts, suggestions: Sequence[str], message: str, spending: Spending = UNKNOWN) -> list[str]:
    """The answer in sentences, then everything in columns."""
    d, parts = facts.diagnosis, list_parts(facts.scenario, spending)
    rejected = f"{tally(d.rejected, 'attempt')} rejected ({percent(d.rejected_share)})"
    calls = f", {d.do_steps} doStep calls" if d.do_steps is not None else ""
    lines = [
        *answer(facts, spending, parts, suggestions),
        "",
        f"{facts.scenario.name} ({message}): {d.steps} macro steps from {d.start:g} to {d.end:g} s, "
        f"{rejected}, {tally(d.total_iterations, 'iteration')}{calls}",
        "",
    ]
    if parts:
        taken = [(one.name, f"{one.seconds:.3g}", percent(one.seconds / spending.wall_s)) for one in parts]
        taken.append(("the run; the command's own start is before it", f"{spending.wall_s:.3g}", "100 %"))
        lines += [*_table(("where the time went", "s", "share"), taken), ""]
    rows = [
        (WORDS[reason], percent(share.steps), percent(share.time), str(d.rejections.get(reason, "")))
        for reason, share in d.reasons.items()
    ]
    lines += _table(("what set the step", "steps", "time", "rejected"), rows)
    unit, _ = choose_time_unit(d.end - d.start)
    if d.limits:
        lines += [
            "",
            *_table(("error of", "steps", "time", f"limits most steps from .. to ({unit})"), _limits(facts)),
        ]
    lines += ["", *_efforts(spending.effort, d)] if spending.effort else []
    lines += ["", *_quantiles(d), "", *_work(d)]
    if d.events:
        told = ", ".join(f"{count} told by {name}" for name, count in d.events.items())
        lines.append(f"events located: {told}")
    lines += _over(d)
    for time, variable in d.discontinuities[:SHOWN]:
        lines.append(f"minimum step reached at t = {time:.9g} s for {variable}")
    return [*lines, *[""] * bool(suggestions[1:]), *(f"suggestion: {text}" for text in suggestions[1:])]


def _limits(facts: Facts) -> list[tuple[str, str, str, str]]:
    _, factor = choose_time_unit(facts.diagnosis.end - facts.diagnosis.start)
    rows = []
    for name, limit in list(facts.diagnosis.limits.items())[:SHOWN]:
        shown = sorted(limit.spans, key=lambda span: span[0] - span[1])[:SHOWN]
        spans = ", ".join(f"{factor * a:.4g} .. {factor * b:.4g}" for a, b in sorted(shown))
        more = f" and {len(limit.spans) - SHOWN} more" if len(limit.spans) > SHOWN else ""
        to = ", ".join(facts.targets.get(name, []))
        rows.append((f"{name} -> {to}", percent(limit.steps), percent(limit.time), spans + more))
    if (hidden := len(facts.diagnosis.limits) - SHOWN) > 0:
        rows.append((f"and {hidden} more", "", "", ""))
    return rows


def _efforts(effort: Mapping[str, Spent], d: Diagnosis) -> list[str]:
    """Participants by falling time, and their counts."""
    rows = []
    for name, one in sorted(effort.items(), key=lambda item: -item[1].stepping_s - item[1].saving_s):
        by = {
            variable: limit.steps for variable, limit in d.limits.items() if variable.startswith(f"{name}.")
        }
        variables = [f"{percent(share)} by {variable[len(name) + 1 :]}" for variable, share in by.items()]
        times = (one.opening_s, one.initialising_s, one.stepping_s, one.saving_s)
        a_step = f"{1e6 * one.stepping_s / one.do_steps:.3g}" if one.do_steps else ""
        own = (str(one.own_steps or ""), str(one.failed or ""))
        counts = (str(one.do_steps), a_step, *own, str(one.restored), ", ".join(variables[:2]))
        rows.append((name, *(f"{s:.2g}" for s in times), *counts))
    head = (
        "participant", "opening (s)", "initialising (s)", "steps (s)", "states (s)", "doStep calls",
        "each (us)", "own steps", "failed", "taken back", "limits steps",
    )  # fmt: skip
    return _table(head, rows)


def _quantiles(d: Diagnosis) -> list[str]:
    lengths, counts = d.length.values(), d.iterations.values()
    rows = [
        ("step length", *map(format_time, lengths)),
        ("iterations", *(f"{value:.0f}" for value in counts)),
    ]
    return _table(("", "least", "5 %", "median", "95 %", "most"), rows)


def _work(d: Diagnosis) -> list[str]:
    dense = [interval for interval in d.densest if interval.density > EVEN]
    if not dense:
        return ["work: spread evenly over the time"]
    unit, factor = choose_time_unit(d.end - d.start)
    return [
        f"work: {percent(i.work)} of it in {percent(i.time)} of the time, {factor * i.start:.6g} to "
        f"{factor * i.end:.6g} {unit} ({i.density:.3g} times the mean)"
        for i in dense
    ]


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Aligned columns; the first one to the left, a last one of texts too."""
    whole = [tuple(head), *map(tuple, rows)]
    widths = [max(len(row[i]) for row in whole) for i in range(len(head))]
    return [
        "  ".join(
            cell.ljust(width) if i == 0 or (i == len(row) - 1 and " .. " in head[i]) else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in whole
    ]


@dataclass(frozen=True)
class Findings:
    """The steps of a run, its scenario, what limited them, where the time went, what would help, and the
    lines of the report."""

    steps: Steps
    scenario: Scenario
    diagnosis: Diagnosis
    spending: Spending
    suggestions: Sequence[str]
    lines: Sequence[str]


def find_run(subject: Path) -> Path:
    """The folder of a run: given itself, by its name in results, or by its scenario (the newest one)."""
    if subject.is_dir():
        return subject
    if ((own := Path("results") / subject) / SCENARIO).is_file():
        return own
    if subject.name == SCENARIO and (subject.parent / SUMMARY).is_file():
        return subject.parent
    if subject.suffix != ".toml" and str(subject) not in list_shipped():
        return subject  # what is missing there is said by who reads it
    content, _ = read(subject)
    if newest := find_newest(content["name"], subject.parent):
        return newest
    remedy = "make one with ", Command("run", (subject,))
    raise MistakeError(f"{subject}: there is no run of it in results", remedy)


def diagnose(out: Path) -> Findings:
    """Of the run that `find_run` finds; MistakeError without a run."""
    out = find_run(out)
    steps, message = read_steps(out)
    spending = read_spending(out / SUMMARY)
    diagnosis = diagnose_steps(steps, spending.do_steps)
    if diagnosis is None:
        raise MistakeError(f"{out}: the run made no step ({message})")
    if not (out / SCENARIO).is_file():
        raise MistakeError(f"{out}: there is no {SCENARIO}, with which the steps are judged; put it back")
    try:
        scenario = load(out / SCENARIO)
    except ScenarioError as error:
        raise MistakeError(
            f"{error}. Steps are judged with the scenario of the run; if another version wrote it, run again"
        ) from None
    facts = Facts(diagnosis, steps, scenario)
    remedies = suggestions(facts)
    if find_run_state(out).exists() and scenario.reference.enabled:
        resume = "`", Command("resume", (out,)), "` ends the run and compares it with its reference"
        remedies.append(in_command_line(resume))
    lines = full(facts, remedies, message, spending)
    return Findings(steps, scenario, diagnosis, spending, remedies, lines)
