"""The judgement of film formulas: its numbers, laws and page."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from models.contact.line.line_contact import moes_contact
from orchestrator.reproduce import films, publication
from orchestrator.reproduce.films.cam import cam_cycle
from orchestrator.reproduce.films.formulas import FORMULAS, asymptotes, regime
from orchestrator.reproduce.films.runs import Runs
from orchestrator.reproduce.films.samples import error_of, sample
from orchestrator.reproduce.films.statements import CHECKS
from orchestrator.reproduce.kushwaha2000.runs import Runs as ValveTrain

DOCS = Path(__file__).parents[2] / "docs"
LARGEST_FIGURE_BYTES = 150_000


@pytest.fixture(scope="module")
def runs() -> Runs:
    """Fewer contacts, same ranges."""
    return Runs(fit=(5, 1), validation=(4, 2), speeds=(1000.0,), step_deg=15.0)


def test_regimes_have_their_places() -> None:
    """Light and stiff, light and piezoviscous, heavy and isoviscous, heavy and piezoviscous."""
    places = {(0.1, 0.5): "rigid-isoviscous", (0.6, 15.0): "rigid-piezoviscous",
              (100.0, 0.5): "elastic-isoviscous", (50.0, 10.0): "elastic-piezoviscous"}  # fmt: skip
    for (M, L), name in places.items():
        assert regime(moes_contact(M, L)) == name


def test_bloks_film_is_the_rigid_piezoviscous_asymptote() -> None:
    """1.66 (alpha eta0 u/R)^(2/3) with alpha eta0 u/R = G U_S/2: 1.046 L^(2/3); 1.05 is that, rounded."""
    contact = moes_contact(1.0, 8.0)
    fluid = contact.lubricant
    h = 1.66 * (fluid.pressure_viscosity * fluid.viscosity * contact.velocity / contact.radius) ** (2.0 / 3.0)
    H = h * contact.radius / contact.film_scale
    assert asymptotes(1.0, 8.0)["rigid-piezoviscous"] == pytest.approx(H, rel=5e-3)


def test_samples_are_reproducible_and_in_range(runs: Runs) -> None:
    again = sample(5, 1)
    np.testing.assert_array_equal(again.load, runs.fit.load)
    assert runs.fit.load.min() >= 0.34e-6
    assert runs.fit.load.max() <= 0.56e-5
    assert np.all(runs.fit.squeeze <= 0.0)
    assert all(film is not None for film in (*runs.fit.steady, *runs.fit.squeezed))


def test_closing_bodies_have_thicker_films(runs: Runs) -> None:
    s = runs.fit
    for steady, squeezed in zip(s.steady, s.squeezed, strict=True):
        assert steady is not None
        assert squeezed is not None
        assert squeezed.central_film > steady.central_film


@pytest.mark.parametrize("film", ["central", "minimum"])
@pytest.mark.parametrize("blended", [False, True])
def test_new_laws_obey_similarity(film: str, blended: bool, runs: Runs) -> None:
    law = runs.laws[film, blended]
    assert law.speed - 0.25 * law.material + 0.5 * law.load == pytest.approx(0.5, abs=1e-12)
    # Martin's film makes the law that knows it better everywhere by more than a half.
    assert error_of(runs.laws[film, True], runs.validation, False).rms < 0.5 * (
        error_of(runs.laws[film, False], runs.validation, False).rms
    )


def test_laws_are_least_squares(runs: Runs) -> None:
    """Of ln H: any other constant or exponent has a larger sum of squares on the sample fitted to."""
    from dataclasses import replace

    from orchestrator.reproduce.films.numerical import heights

    for law in (runs.laws["central", False], runs.laws["central", True]):
        found = np.log(heights(runs.fit.steady, "H_central"))

        def squares(trial, found=found):  # type: ignore[no-untyped-def]
            return float(np.sum((np.log(trial.H(runs.fit, False)) - found) ** 2))

        for change in (-1e-3, 1e-3):
            assert squares(replace(law, constant=law.constant * math.exp(change))) > squares(law)
            # An exponent of load moves that of speed, by similarity.
            moved = replace(law, load=law.load + change, speed=law.speed - 0.5 * change)
            assert squares(moved) > squares(law)


def test_the_cycle_has_films_but_at_the_reversals() -> None:
    cycle = cam_cycle(ValveTrain(), 1000.0, 12.0)
    assert not set(cycle.angle_deg) & {144.0, 168.0, 192.0, 216.0}
    assert np.all(np.isfinite(cycle.central))
    assert np.all(cycle.minimum <= cycle.central)
    assert all(np.all(cycle.by_formula[formula.name] > 0.0) for formula in FORMULAS)


def test_every_formula_is_judged() -> None:
    assert len(CHECKS) == len(FORMULAS) + 1 + 2 + 4


def test_the_page_is_whole() -> None:
    page = (DOCS / publication("films").page_name).read_text("utf-8")
    assert films.INTRODUCTION in page
    drawn = re.findall(r"\((figures/[^)]+)\)", page)
    assert len(drawn) == 3
    for figure in drawn:
        assert 0 < (DOCS / figure).stat().st_size < LARGEST_FIGURE_BYTES
    assert all(formula.text in page for formula in FORMULAS)
