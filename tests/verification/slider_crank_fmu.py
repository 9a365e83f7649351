"""slider_crank.fmu."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from tests.models.test_slider_crank import TURN, impacts_of, thesis_parameters

from .table import Row

PIECES = "fmus/test_slider_crank_pieces.py::"
CRANK = "models/test_slider_crank.py::"


def rows() -> Iterator[Row]:
    rng, errors = np.random.default_rng(1), []
    for form in (0.0, 1.0, 2.0):
        p, end = thesis_parameters(0.05, 0.01, form=form), 2.0 * TURN
        cuts = np.concatenate([[0.0], np.sort(rng.uniform(0.0, end, 2000)), [end]])
        whole, pieces = impacts_of(p, np.array([0.0, end]))[-1], impacts_of(p, cuts)[-1]
        assert whole[0] == pieces[0]
        errors.append(abs(whole[1] - pieces[1]))
    yield Row(
        "stepping in pieces of any size gives the same impacts as one long run (1e-12 in time, to a horizon)",
        f"2000 random pieces, two turns of chaos, three forms: last impact to {max(errors):.0e} rad; a "
        "periodic motion has no horizon",
        (
            PIECES + "test_pieces_of_any_size_give_the_impacts_of_one_run",
            CRANK + "test_cutting_time_changes_no_impact",
            CRANK + "test_periodic_motion_has_no_horizon",
            CRANK + "test_exact_flights_are_those_of_the_integrator",
        ),
        short="at constant crank speed without films; otherwise the integrator's tolerance of 1e-10 a "
        "micro-step is the limit.",
    )
    yield Row(
        "impacts inside a macro step are counted, their impulses summed, the last one's time given",
        "outputs upper_/lower_impact_count, upper_/lower_impact_impulse, last_impact_time",
        (PIECES + "test_pieces_of_any_size_give_the_impacts_of_one_run",),
    )
    yield Row(
        "full state save and restore in the middle of chattering or sliding is bit-exact",
        "saved before the chatter's end, while sliding, in flight; restored into another instance",
        (PIECES + "test_restored_in_chatter_and_sliding_to_the_last_bit",),
    )
