"""The summary of contacts, accumulated from macro step to macro step by compiled code."""

import math
from typing import Any

import numpy as np

from models.compile.array_pointers import integers, numbers, table
from models.compile.compiled import compiled
from models.core.integrator import copy

from ...participants.compiled import take
from ...participants.compiled_calls import FINE
from ..lost_contact import AT_REST, LOST, ON_RAMP, ROUNDING, judge

# What is read of a contact at each step: outputs, then inputs.
OUTPUTS = (
    "load", "maximum_pressure", "minimum_film_thickness", "film_ratio", "squeeze_velocity", "deflection",
)  # fmt: skip
INPUTS = ("entraining_velocity", "radius_of_curvature")
# And the lift of its cam (m).
LIFT = "cam_lift"
SEEN = (*OUTPUTS, *INPUTS, LIFT)
# A landing is over where its load has fallen to this share of its peak.
LANDED = 0.1

# Loads in N, times in s: `..._time` says when, `..._duration` how long.
COURSE = np.dtype(
    (
        np.record,
        [
            (name, np.float64)
            for name in (
                "duration", "loaded_duration", "longest_step", "least_load", "least_load_time",
                "largest_load", "load_time",
                "pressure", "pressure_time", "yield_duration", "film", "film_time", "film_ratio",
                # Of the film, as it grows under the load (J): net and gross work; load times distance rolled.
                "film_work", "film_gross", "rolled",
                # Since when it is open.
                "since",
                # Losses: how long, how many, the longest, the largest gap, since when the present one lasts.
                "lost_duration", "separations", "longest_separation", "separation_time", "gap", "gap_time",
                "lost_since",
                # How long it was open at rest; of that on ramps, the largest lift and when.
                "rest_duration", "ramp_duration", "ramp_lift", "ramp_time",
                # Landings: how many, and the hardest.
                "landings", "impact_load", "impact_time", "impact_speed", "impulse", "impact_steps",
                # The present landing; `touched` is NaN where there is none.
                "touched", "touch_speed", "peak", "peak_steps", "steps", "touch_impulse", "falling",
                # The step before.
                "time", "load", "deflection", "closing_speed", "yielding", "film_power", "rolling", "state",
            )
        ],
    )
)  # fmt: skip

# Of each group of the film formula's ranges: is it outside, how long it was, its extremes.
OUTSIDE, DURATION, LEAST, MOST = range(4)
FIRST_INPUT = len(OUTPUTS)


def make_records(count: int) -> tuple[Any, Any]:
    """ContactSummaries and ranges of contacts of which nothing is known yet."""
    summaries = np.zeros(count, dtype=COURSE)
    summaries["least_load"] = summaries["film"] = summaries["film_ratio"] = np.inf
    for name in ("time", "since", "lost_since", "touched"):
        summaries[name] = np.nan
    ranges = np.zeros((count, 4 * 4))
    ranges[:, LEAST::4], ranges[:, MOST::4] = np.inf, -np.inf
    return summaries, ranges


@compiled
def observe(fmus: Any, memory: Any, summaries: Any, time: float) -> tuple[int, int, int]:
    """Read the contacts that are FMUs, then `accumulate`. Returns the FMU, the call and the status that
    failed; FINE where none did."""
    for i in range(len(fmus)):
        call, status = take(fmus[i])
        if call != FINE:
            return i, call, status
    accumulate(memory, summaries, time)
    return 0, FINE, 0


@compiled
def replay(memory: Any, summaries: Any, times: Any, rows: Any) -> None:
    """`accumulate` recorded rows (records x SEEN) of one contact."""
    seen = table(memory[0].seen)
    for k in range(len(times)):
        copy(seen[0], rows[k])
        accumulate(memory, summaries, times[k])


@compiled
def accumulate(memory: Any, summaries: Any, time: float) -> None:
    """Add the macro step that ends at `time`.

    `memory` has `seen` (contacts x SEEN); `origins`, where each contact's INPUTS are among `values` (-1: they
    are in `seen`); `scales`, the elastic limit, the groups material, load and speed at 1 N, 1 m/s and 1 m,
    lash and lobe of the `ContactLaw`; `bounds` (low, high) and `ranges` of the
    groups.
    """
    m = memory[0]
    seen, values, origins = table(m.seen), numbers(m.values), integers(m.origins)
    scales, bounds, ranges = table(m.scales), table(m.bounds), table(m.ranges)
    for i in range(len(summaries)):
        c, row, scale = summaries[i], seen[i], scales[i]
        for j in range(2):
            if origins[2 * i + j] >= 0:
                row[FIRST_INPUT + j] = values[origins[2 * i + j]]
        load = row[0] if abs(row[0]) > ROUNDING else 0.0
        step = 0.0 if np.isnan(c.time) else time - c.time
        lift, lash, lobe = row[FIRST_INPUT + 2], scale[4], scale[5]
        if lift > lobe and load < c.least_load:
            c.least_load, c.least_load_time = load, time
        _extremes(c, row, scale[0], load, time, step)
        speed, radius = abs(row[6]), row[7]
        _work(c, load * row[4], load * speed, step)
        squeeze = row[4] / speed if speed > 0.0 else np.nan
        groups = (scale[1], squeeze, scale[2] * load / radius, scale[3] * speed / radius)
        for k in range(4):
            _range(ranges[i, 4 * k : 4 * k + 4], groups[k], bounds[k, 0], bounds[k, 1], load > 0.0, step)
        state = judge(load, lift, lash, lobe, int(c.state))
        _count_open(c, state, step)
        if state == ON_RAMP and lift > c.ramp_lift:
            c.ramp_lift, c.ramp_time = lift, time
        _lose(c, -row[5], state == LOST, time)
        if load > 0.0:
            _touch(c, load, time, step)
        else:
            c.since = time if np.isnan(c.since) else c.since
            finish(c)
        if step > 0.0:
            c.closing_speed = (row[5] - c.deflection) / step
        c.time, c.load, c.deflection = time, load, row[5]


@compiled
def _extremes(c: Any, row: Any, limit: float, load: float, time: float, step: float) -> None:
    """Extremes and durations (by the trapezoidal rule)."""
    c.duration += step
    c.longest_step = max(c.longest_step, step)
    ends = (1.0 if c.load > 0.0 else 0.0) + (1.0 if load > 0.0 else 0.0)
    c.loaded_duration += 0.5 * step * ends
    if load > c.largest_load:
        c.largest_load, c.load_time = load, time
    yielding = 1.0 if row[1] > limit else 0.0
    c.yield_duration += 0.5 * step * (c.yielding + yielding)
    c.yielding = yielding
    if load > 0.0:
        if row[1] > c.pressure:
            c.pressure, c.pressure_time = row[1], time
        if row[2] < c.film:
            c.film, c.film_time = row[2], time
        c.film_ratio = min(c.film_ratio, row[3])


@compiled
def _work(c: Any, film_power: float, rolling: float, step: float) -> None:
    """By the trapezoidal rule; what is not finite, as at a radius of zero, counts as nothing."""
    film_power = film_power if math.isfinite(film_power) else 0.0
    c.film_work += 0.5 * step * (c.film_power + film_power)
    c.film_gross += 0.5 * step * (abs(c.film_power) + abs(film_power))
    c.rolled += 0.5 * step * (c.rolling + rolling)
    c.film_power, c.rolling = film_power, rolling


@compiled
def _range(r: Any, value: float, low: float, high: float, loaded: bool, step: float) -> None:
    """How long a group is outside its range under load, and its extremes; NaN is outside."""
    outside = 1.0 if loaded and not low <= value <= high else 0.0
    r[DURATION] += 0.5 * step * (r[OUTSIDE] + outside)
    r[OUTSIDE] = outside
    if loaded and not np.isnan(value):
        r[LEAST], r[MOST] = min(r[LEAST], value), max(r[MOST], value)


@compiled
def _count_open(c: Any, state: int, step: float) -> None:
    """How long it was open at rest and on ramps, and lost, by the trapezoidal rule."""
    for one in (int(c.state), state):
        c.rest_duration += 0.5 * step * (one in (AT_REST, ON_RAMP))
        c.ramp_duration += 0.5 * step * (one == ON_RAMP)
        c.lost_duration += 0.5 * step * (one == LOST)
    c.state = state


@compiled
def _lose(c: Any, gap: float, lost: bool, time: float) -> None:
    """A step at whose end contact is lost or not."""
    if not lost:
        regain(c, time)
        return
    if np.isnan(c.lost_since):
        c.lost_since = time
        c.separations += 1.0
    if gap > c.gap:
        c.gap, c.gap_time = gap, time


@compiled
def regain(c: Any, time: float) -> None:
    """The present loss, if there is one, ends."""
    if time - c.lost_since > c.longest_separation:
        c.longest_separation, c.separation_time = time - c.lost_since, c.lost_since
    c.lost_since = np.nan


@compiled
def _touch(c: Any, load: float, time: float, step: float) -> None:
    """A step with load at its end. A landing is over where the load, after its peak, has fallen to LANDED of
    it, rises again or is zero."""
    if not np.isnan(c.since):
        c.since = np.nan
        c.landings += 1.0
        c.touched, c.touch_speed = time, c.closing_speed
        c.peak = c.peak_steps = c.steps = c.touch_impulse = c.falling = 0.0
    if np.isnan(c.touched):
        return
    if load > c.peak and c.falling == 0.0:
        c.peak, c.peak_steps = load, c.steps + 1.0
    elif LANDED * c.peak < load <= c.load:
        c.falling = 1.0
    else:
        finish(c)
        return
    c.steps += 1.0
    c.touch_impulse += 0.5 * step * (c.load + load)


@compiled
def finish(c: Any) -> None:
    """The present landing, if there is one, is over."""
    if not np.isnan(c.touched) and c.peak > c.impact_load:
        c.impact_load, c.impact_time, c.impact_speed = c.peak, c.touched, c.touch_speed
        c.impulse, c.impact_steps = c.touch_impulse, c.peak_steps
    c.touched = np.nan
