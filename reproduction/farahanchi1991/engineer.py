"""What the sign error changes for somebody who designs an engine: numbers of both forms side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from models.slider_crank.machine import Machine

from .cases import CORRECTED, CYCLES, FORMS, HIGH_DAMPINGS, LOW_DAMPINGS, PUBLISHED, Case, matrix
from .forces import UPPER, changes, curve, limits
from .impacts import energy
from .kinds import observed
from .runs import STARTS, Runs

FAST = 0.01
HEADINGS = (
    "(λ, ρ)",
    *(f"{form}: {what}" for form in ("as published", "corrected") for what in (
        "motion", "slides", "largest impact", "energy per cycle",
    )),
)  # fmt: skip
AUTOMOTIVE = 0.4


@dataclass(frozen=True)
class Load:
    """What a motion does to the walls. slides: share of the time. largest: velocity of approach over l Omega.
    energy: what the impacts take per cycle, over M l^2 Omega^2."""

    kind: str
    slides: float
    impacts: int
    largest: float
    energy: float


def load(runs: Runs, case: Case) -> Load:
    """Of F's record."""
    impacts = runs.events(case).impacts
    count = len(impacts.theta)
    return Load(
        observed(runs, case).kind,
        runs.sliding_share(case),
        count,
        float(impacts.approach.max()) if count else 0.0,
        energy(case.machine, impacts, CYCLES),
    )


def section(runs: Runs) -> str:
    """The Markdown section."""
    return "\n".join(
        [
            "## What the sign error changes for an engineer\n",
            *(f"- {text}" for text in findings(runs)),
            "",
            f"Motion by most of {STARTS} starts, share of the time in which the roller slides, largest "
            "velocity of approach over lΩ and energy that the impacts take per cycle over M l²Ω² (in "
            "millionths), 3000 cycles after 30, e = 0.9:\n",
            _table([HEADINGS, *(_row(runs, case) for case in matrix((*LOW_DAMPINGS, *HIGH_DAMPINGS)))]),
            "",
        ]
    )


def findings(runs: Runs) -> list[str]:
    """Sentences with their numbers."""
    return [_threshold(), _force(), _slow(runs), _fast(runs), _restitution(runs)]


def _threshold() -> str:
    published, corrected = (limits(form)[0] for form in FORMS)
    return (
        "**Permanent sliding.** As ρ → 0 a slider on the upper wall never leaves it from λ = "
        f"{published:.4f} on as published, from {corrected:.4f} on with the right sign. As λ ∝ 1/Ω, an "
        f"engine can run without piston slap up to {published / corrected:.2f} times the speed that F's "
        "equations give. A bouncing motion may exist beside the rest: (0.15, 0.02) with the right sign."
    )


def _force() -> str:
    machines = [Machine(FAST, 0.01, form=form) for form in FORMS]
    counts = [len(changes(machine, UPPER)) for machine in machines]
    largest = [float(np.abs(curve(machine, UPPER)).max()) for machine in machines]
    return (
        f"**Side changes.** At λ = {FAST:g} (high speed) the wall force changes its sign {counts[0]} times "
        f"a cycle as published and {counts[1]} times with the right sign: the slider crosses the gap near "
        f"mid stroke too, not only at the dead centres. The largest force is {largest[1]:.3f} for "
        f"{largest[0]:.3f} M l Ω²."
    )


def _slow(runs: Runs) -> str:
    loads = {form: [load(runs, case) for case in matrix(HIGH_DAMPINGS, form)] for form in FORMS}
    still = {form: sum(not found.impacts for found in loads[form]) for form in FORMS}
    return (
        f"**Low speed (λ = 0.15 to 0.25).** As published {still[PUBLISHED]} of the 9 cases are free of "
        f"impacts, with the right sign {still[CORRECTED]}: F's Figs. 4.24 to 4.37 show impacts and chaos "
        "where there is a piston at rest on one side of its bore."
    )


def _fast(runs: Runs) -> str:
    pairs = [
        [load(runs, case.in_form(form)) for form in (PUBLISHED, CORRECTED)] for case in matrix(LOW_DAMPINGS)
    ]
    energies = [second.energy / first.energy for first, second in pairs]
    speeds = [second.largest / first.largest for first, second in pairs]
    same = sum(first.kind == second.kind for first, second in pairs)
    return (
        f"**High speed (λ = 0.025 to 0.075).** With the right sign the impacts take {min(energies):.2f} to "
        f"{max(energies):.2f} times the energy, the hardest impact has {min(speeds):.2f} to "
        f"{max(speeds):.2f} times the velocity, and {same} of 9 motions are of the kind that F's equations "
        "give. The forecast of where a chaotic or a periodic motion is to be found does not carry over, "
        "nor does the place of the impacts: compare the panels of Figs. 4.6 to 4.14."
    )


def _restitution(runs: Runs) -> str:
    shares = {
        form: np.mean([
            runs.sliding_share(case)
            for case in matrix((*LOW_DAMPINGS, *HIGH_DAMPINGS), form, AUTOMOTIVE)
        ])
        for form in FORMS
    }  # fmt: skip
    return (
        f"**Automotive restitution (e = {AUTOMOTIVE:g}).** The 18 cases slide {100 * shares[PUBLISHED]:.0f} "
        f"% of the time as published, {100 * shares[CORRECTED]:.0f} % with the right sign."
    )


def _row(runs: Runs, case: Case) -> tuple[str, ...]:
    cells = [f"({case.damping:g}, {case.gap:g})"]
    for form in FORMS:
        found = load(runs, case.in_form(form))
        still = not found.impacts
        cells += [
            "rests on the upper wall" if still else found.kind,
            f"{100 * found.slides:.0f} %",
            "-" if still else f"{found.largest:.3f}",
            "0" if still else f"{1e6 * found.energy:.0f}",
        ]
    return tuple(cells)


def _table(rows: Sequence[Sequence[str]]) -> str:
    head, *body = rows
    return "\n".join("| " + " | ".join(row) + " |" for row in (head, ["---"] * len(head), *body))
