"""F 4.2: a chaotic motion."""

from __future__ import annotations

import math

import numpy as np

from models.slider_crank.machine import Motion

from ..cases import Case
from ..impacts import UPPER, on_wall
from ..runs import Runs
from .judging import Check, Found, Statement, Verdict, in_both_forms, met_if

CASE = Case(0.05, 0.01)
# Two states of one motion differ at the print's resolution if by more than this part of their range.
PRINTED = 0.005


def not_periodic(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        states = Motion(CASE.in_form(form).machine).skip(25).strobe(3)[:, :2]
        apart = float(np.abs(np.diff(states, axis=0) / [2.0 * CASE.gap, 0.2]).max(axis=1).min())
        return Found(
            f"after 25 cycles successive cycles begin {100 * apart:.0f} % of the range or more apart",
            met_if(apart > PRINTED),
            {"apart": apart},
        )

    return in_both_forms(
        "not-periodic",
        "4.2, Fig. 4.1",
        "(0.05, 0.01), after 25 cycles: no strict periodicity in two cycles",
        judge,
    )


def sensitive(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        kind = runs.kind(CASE.in_form(form))
        return Found(
            f"{kind.kind}: {kind.evidence}",
            met_if(kind.exponent > 3.0 * kind.uncertainty and kind.kind == "chaotic"),
            {"exponent": kind.exponent, "uncertainty": kind.uncertainty},
        )

    return in_both_forms(
        "sensitive",
        "4.2, Fig. 4.3",
        "The system has a chaotic response to periodic excitation; 3000 revolutions clearly show it",
        judge,
        "corrected, this case is F's transient chaos: it slides in the end, and repeats",
    )


def fractal(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        found = Motion(CASE.in_form(form).machine).skip(100).exponents(20_000)
        if found.largest == -math.inf:
            return Found("a finite set of points: the motion is periodic in the end", Verdict.NOT_MET)
        second = found.exact_sum - found.largest
        dimension = 1.0 - found.largest / second
        return Found(
            f"exponents {found.largest:.4f} and {second:.4f}: Kaplan-Yorke dimension {dimension:.3f} of the "
            "section",
            met_if(1.0 < dimension < 2.0),
            {"largest": found.largest, "second": second, "dimension": dimension},
        )

    return in_both_forms(
        "fractal", "4.2, Figs. 4.4, 4.5", "Two magnifications show the fractal nature of the attractor", judge
    )


def descending_series(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        events = runs.events(CASE.in_form(form)).impacts
        follows = (events.side[:-1] == UPPER) & (events.side[1:] == UPPER)
        same_cycle = events.cycle[:-1] == events.cycle[1:]
        pairs = follows & same_cycle
        slower = float(np.mean(events.rate[1:][pairs] < events.rate[:-1][pairs]))
        return Found(
            f"{100 * slower:.1f} % of the {int(pairs.sum())} upper impacts that follow another in the same "
            "cycle are slower than it",
            met_if(slower > 0.9),
            {"slower": slower},
        )

    return in_both_forms(
        "descending-series",
        "4.2",
        "Impacts move from lobe to lobe, from the upper left to the lower right: each slower than the one "
        "before",
        judge,
        "taken as a rule with few exceptions: more than 90 %",
    )


def several_lobes(runs: Runs) -> Statement:
    def judge(form: str) -> Found:
        if runs.kind(CASE.in_form(form)).period:
            return Found("a finite set of points in the end", Verdict.NOT_MET)
        upper = on_wall(runs.events(CASE.in_form(form)), UPPER)
        filled = np.histogram(upper.theta, 720, (0.0, 2.0 * math.pi))[0] > 0
        lobes = int(np.sum(filled & ~np.roll(filled, 1)))
        return Found(f"{lobes} separate ranges of crank angle hold all upper impacts", met_if(lobes > 1))

    return in_both_forms(
        "several-lobes",
        "4.2, Fig. 4.3",
        "The attractor is composed of several lobes, some of them distinct",
        judge,
        "distinct in crank angle, to half a degree; distinct lobes may still share crank angles",
    )


CHECKS: tuple[Check, ...] = (not_periodic, sensitive, fractal, descending_series, several_lobes)
