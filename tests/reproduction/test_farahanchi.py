"""The reproduction of Farahanchi 1991: its figures, numbers and verdicts."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from models.slider_crank.flight.bouncing import UPPER
from models.slider_crank.motions.machine import Machine, Motion
from models.slider_crank.motions.regions import TURN
from reproduction.farahanchi1991 import CLAIMS, chapters_1_to_3
from reproduction.farahanchi1991.derivation import M, evaluate_lagrange, evaluate_printed
from reproduction.farahanchi1991.figures import FIGURES, PICTURES
from reproduction.farahanchi1991.force import find_changes, measure_shares
from reproduction.farahanchi1991.runs import CORRECTED, FORMS, PUBLISHED, Case, Runs
from reproduction.statement import Verdict
from tests.fmus.names import mark_long

# Statements that need no motion, or a short one.
QUICK = [claim for claim in chapters_1_to_3.CLAIMS if claim.place.startswith(("2.", "(2."))
         and claim.key not in ("coming-to-rest", "when-it-slides")]  # fmt: skip
QUICK += [claim for claim in CLAIMS if claim.key in ("ratios", "uniform-rod")]


@pytest.fixture(scope="module")
def runs():
    return Runs()


@pytest.fixture(scope="module")
def quick(runs):
    return {claim.key: claim.judge(runs) for claim in QUICK}


def test_every_figure_from_2_4_to_4_44_is_there_once():
    numbers = [picture.number for picture in PICTURES if not picture.number.endswith("text")]
    beside = {4, 5, 17, 20, 23}
    second, fourth = (
        [f"2.{n}" for n in (2, *range(4, 11))],
        [f"4.{n}" for n in range(1, 45) if n not in beside],
    )
    assert numbers == second + fourth
    assert len({picture.file for picture in PICTURES}) == len(PICTURES)
    assert all(re.fullmatch(r"farahanchi1991-fig-[0-9a-z.-]+\.png", picture.file) for picture in PICTURES)


@pytest.mark.parametrize(
    ("key", "value", "expected", "tolerance"),
    [
        ("thresholds", "zero", 0.26688, 1e-5),
        ("thresholds", "corrected_zero", 0.11958, 1e-5),
        ("figure-2-4", "upper_changes", 2, 0),
        ("figure-2-4", "corrected_upper_changes", 4, 0),
        ("figure-2-4", "corrected_lower_changes", 4, 0),
        ("figure-2-7", "begin", 4.9531, 5e-5),
        ("figure-2-7", "end", 5.1541, 5e-5),
        ("figure-2-7", "mixed", (4.957, 5.151), 5e-4),
        ("ratios", "xi", 1.6535 / 5.4570, 1e-12),
        ("ratios", "alpha", 1.9, 1e-12),
        ("uniform-rod", "uniform", 1.9 / 12.0, 1e-12),
        ("rod-rotation", "published", 1.0031, 1e-4),
        ("rod-rotation", "corrected", 1.9469, 1e-4),
    ],
)
def test_numbers_that_need_no_motion(key, value, expected, tolerance, quick):
    assert quick[key].values[value] == pytest.approx(expected, abs=tolerance)


@settings(derandomize=True, deadline=None, max_examples=20)
@given(damping=st.floats(0.0, 0.5), gap=st.floats(0.001, 0.02), form=st.sampled_from(FORMS))
def test_the_four_kinds_of_crank_angles_make_up_the_revolution(damping, gap, form):
    machine = Machine(damping, gap, form=form)
    assert sum(measure_shares(machine).values()) == pytest.approx(TURN, rel=1e-12)
    assert len(find_changes(machine, UPPER)) % 2 == 0


@settings(derandomize=True, deadline=None, max_examples=40)
@given(
    theta=st.floats(0.0, 2.0 * math.pi),
    psi=st.floats(-0.02, 0.02),
    rate=st.floats(-0.3, 0.3),
    bend=st.floats(-2.0, 2.0),
)
def test_2_10_follows_from_f_s_energy_and_2_27_from_the_rod_s(theta, psi, rate, bend):
    # Central differences of 1e-5 leave 1e-16 / 1e-5 and 1e-10 of the third derivative.
    for rod_term, rotation in (("(2.10)", 1.0), ("(2.27)", -1.0)):
        found = evaluate_printed(theta, psi, bend, M, rod_term)
        assert found == pytest.approx(evaluate_lagrange(theta, psi, rate, bend, rotation, M), abs=1e-8)


def test_verdicts_of_both_forms(quick):
    for key in ("figure-2-4", "figure-2-7", "figure-2-8", "figure-2-10"):
        assert (quick[key].verdict, quick[key].corrected_verdict) == (Verdict.MET, Verdict.NOT_MET)
    assert quick["symmetry-ii"].verdict is Verdict.NOT_MET
    assert quick["equation-2-27"].verdict is Verdict.CANNOT
    assert len(quick) == len(QUICK)


def test_high_friction_with_the_right_sign_is_rest_on_the_upper_wall(runs):
    published, corrected = (Case(0.25, 0.015, form=form) for form in (PUBLISHED, CORRECTED))
    assert runs.kind(published).period == 1
    assert len(runs.events(published).impacts.theta) > 0
    assert len(runs.events(corrected).theta) == 0
    assert runs.sliding_share(corrected) == 1.0


def test_rest_and_bouncing_exist_side_by_side_where_the_page_says_so():
    machine = Case(0.15, 0.02, form=CORRECTED).machine
    # On the wall at crank angle zero, where Lambda is 1 and the wall does not move.
    resting, bouncing = Motion(machine, psi=machine.gap), Motion(machine)
    assert (resting.skip(10).strobe(50)[:, 2] == UPPER).all()
    assert len(bouncing.skip(1000).events(50).impacts.theta) == 200


def test_the_thesis_s_threshold_makes_a_chaotic_motion_periodic(runs):
    case = Case(0.05, 0.02)
    assert runs.kind(case).kind == "chaotic"
    assert runs.kind(case.by_thesis_rule).period == 2


@pytest.mark.parametrize(
    "number", mark_long(["2.4", "2.10", "4.2", "4.3", "4.12", "4.19", "4.31"], ["2.4", "4.2"])
)
def test_figures_are_drawn(number, runs, tmp_path):
    figure = next(f for f, picture in zip(FIGURES, PICTURES, strict=True) if picture.number == number)
    replace(figure, dpi=60).save(runs, tmp_path)
    colours = np.unique(np.asarray(Image.open(tmp_path / figure.file).convert("RGB")).reshape(-1, 3), axis=0)
    assert len(colours) > 20
