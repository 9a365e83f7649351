"""What the sign error changes for somebody who designs an engine: numbers of both forms side by side."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from models.slider_crank.flight.bouncing import UPPER
from models.slider_crank.motions.machine import Machine
from models.slider_crank.motions.statistics import energies

from ..publication import format_table
from ..statement import Numbers, Values, format_numbers
from .force import compute_curve, find_changes, find_limits
from .runs import CYCLES, FORMS, MATRIX, STARTS, Case, Runs, list_cases, observe

FAST, AUTOMOTIVE = 0.01, 0.4
HEADINGS = ["(λ, ρ)"] + [
    f"{form}: {what}"
    for form in ("as published", "corrected")
    for what in ("motion", "slides", "largest impact", "energy per cycle")
]
# Of each pair of numbers the first is as published, the second with the right sign.
FINDINGS = (
    "**Permanent sliding.** As ρ → 0, a slider stays on the upper wall for good from λ = {limits[0]:.4f} as "
    "published and from {limits[1]:.4f} corrected. Since λ ∝ 1/Ω, an engine runs without piston slap up to "
    "{faster:.2f} times the speed that F's equations give. A bouncing motion may coexist with rest, as at "
    "(0.15, 0.02) corrected.",
    "**Side changes.** At λ = 0.01 (high speed) the wall force changes sign {changes[0]} times a cycle as "
    "published and {changes[1]} times corrected: the slider crosses the gap near mid-stroke too, not only "
    "at the dead centres. The largest force is {force[1]:.3f} M l Ω² corrected, {force[0]:.3f} as "
    "published.",
    "**Low speed (λ = 0.15 to 0.25).** {still[0]} of the 9 cases are free of impacts as published, "
    "{still[1]} corrected: F's Figs. 4.24 to 4.37 show impacts and chaos where the piston rests on one side "
    "of its bore.",
    "**High speed (λ = 0.025 to 0.075).** Corrected, impacts dissipate {energy[0]:.2f} to {energy[1]:.2f} "
    "times the energy as published, and the hardest impact has {speed[0]:.2f} to {speed[1]:.2f} times the "
    "velocity. {same} of 9 motions are of the same kind. F's equations do not predict where motions are "
    "chaotic or where on the walls impacts occur: compare the panels of Figs. 4.6 to 4.14.",
    "**Automotive restitution (e = 0.4).** The 18 cases slide {slides[0]:.0f%} of the time as published, "
    "{slides[1]:.0f%} corrected.",
)
TABLE = (
    f"Kind of motion of most of {STARTS} starts; share of the time that the slider slides; largest velocity "
    "of approach over lΩ; energy that impacts dissipate per cycle over M l²Ω² (in millionths). 3000 cycles "
    "after 30, e = 0.9:\n"
)


class Load(NamedTuple):
    """What a motion does to the walls.

    `slides`: share of the time. `largest`: velocity of approach over l Omega. `energy`: dissipated by impacts
    per cycle, over M l^2 Omega^2.
    """

    kind: str
    slides: float
    impacts: int
    largest: float
    energy: float

    def list_cells(self) -> list[str]:
        if not self.impacts:
            return ["rests on the upper wall", f"{100 * self.slides:.0f} %", "-", "0"]
        return [self.kind, f"{100 * self.slides:.0f} %", f"{self.largest:.3f}", f"{1e6 * self.energy:.0f}"]


def measure_load(runs: Runs, case: Case) -> Load:
    """The load of the walls in F's record."""
    impacts = runs.events(case).impacts
    largest = impacts.approach.max(initial=0.0)
    energy = float(energies(case.machine, impacts).sum()) / CYCLES
    return Load(observe(runs, case).kind, runs.sliding_share(case), len(impacts.theta), largest, energy)


def format_findings(runs: Runs) -> str:
    """The Markdown section."""
    own, right = ([measure_load(runs, case) for case in list_cases(MATRIX, form)] for form in FORMS)
    numbers = Numbers(compare_forms(runs, own, right))
    findings = [f"- {format_numbers(text, numbers)}" for text in FINDINGS]
    cases = zip(list_cases(MATRIX), own, right, strict=True)
    rows = ([str(case), *first.list_cells(), *second.list_cells()] for case, first, second in cases)
    return "\n".join(
        [
            "## What the sign error changes for an engineer\n",
            *findings,
            "",
            TABLE,
            format_table(HEADINGS, *rows),
            "",
        ]
    )


def compare_forms(runs: Runs, own: Sequence[Load], right: Sequence[Load]) -> Values:
    machines = [Machine(FAST, 0.01, form=form) for form in FORMS]
    pairs = list(zip(own[:9], right[:9], strict=True))
    taken, speeds = [b.energy / a.energy for a, b in pairs], [b.largest / a.largest for a, b in pairs]
    from_on = [find_limits(form)[0] for form in FORMS]
    soft = [[runs.sliding_share(case) for case in list_cases(MATRIX, form, AUTOMOTIVE)] for form in FORMS]
    return {
        "limits": from_on, "faster": from_on[0] / from_on[1],
        "changes": [len(find_changes(machine, UPPER)) for machine in machines],
        "force": [np.abs(compute_curve(machine, UPPER)).max() for machine in machines],
        "still": [sum(not one.impacts for one in loads[9:]) for loads in (own, right)],
        "energy": (min(taken), max(taken)), "speed": (min(speeds), max(speeds)),
        "same": sum(a.kind == b.kind for a, b in pairs),
        "slides": [np.mean(shares) for shares in soft],
    }  # fmt: skip
