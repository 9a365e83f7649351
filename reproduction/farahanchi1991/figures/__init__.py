"""F's figures 2.2 and 2.4 to 4.44, with its numbering. 2.1, 2.3, A.1 and B.1 are sketches."""

from __future__ import annotations

from functools import partial
from itertools import product
from pathlib import Path

from models.slider_crank.flight.bouncing import LOWER, UPPER

from ...pictures import save_compact
from ..cases import GAPS, HIGH_DAMPINGS, LOW_DAMPINGS, Case
from ..runs import Runs
from . import forces, impacts, motions
from .picture import DPI, Picture

PREFIX = "farahanchi1991-"
FORCE, MAP, TRACE = "Constraint force on the roller", "Poincaré map", "Time trace"
PATTERN = "Impact distribution pattern"
EXAMPLE = Case(0.05, 0.01)


def _patterns(first: int, dampings: tuple[float, ...]) -> list[Picture]:
    """F's 3 x 3 distribution patterns."""
    cases = [Case(damping, gap) for damping, gap in product(dampings, GAPS)]
    return [Picture(f"4.{first + n}", PATTERN, impacts.plot_profile, case) for n, case in enumerate(cases)]


def _spectra(first: int, case: Case) -> list[Picture]:
    """F's three figures of a case."""
    return [
        Picture(f"4.{first}", MAP, motions.plot_poincare, case),
        Picture(
            f"4.{first + 1}", "Impact spectra, upper wall", partial(impacts.plot_spectrum, side=UPPER), case
        ),
        Picture(
            f"4.{first + 2}", "Impact spectra, lower wall", partial(impacts.plot_spectrum, side=LOWER), case
        ),
    ]


PICTURES: tuple[Picture, ...] = (
    Picture("2.2", "The constraints for ψ", forces.plot_walls),
    Picture("2.4", FORCE, forces.plot_constraint, Case(0.01, 0.01)),
    Picture("2.5", FORCE, forces.plot_constraint, Case(0.1, 0.01)),
    Picture("2.6", FORCE, forces.plot_constraint, Case(0.25, 0.01)),
    Picture("2.7", FORCE, forces.plot_constraint, Case(0.267, 0.02)),
    Picture("2.8", "Blow-up of the constraint force", forces.plot_blow_up, Case(0.1, 0.01)),
    Picture("2.9", FORCE, forces.plot_constraint, Case(0.35, 0.01)),
    Picture("2.10", "Regions of sliding", forces.plot_regions),
    Picture("3.1", "Three-dimensional phase space", forces.plot_extended_phase_space),
    Picture("4.1", TRACE, partial(motions.plot_trace, cycles=2, after=25), EXAMPLE),
    Picture("4.2", "Phase portrait", motions.plot_phase, EXAMPLE),
    Picture("4.3", MAP, motions.plot_poincare, EXAMPLE),
    Picture(
        "4.4", f"First magnification of the {MAP}", partial(motions.plot_magnification, level=1), EXAMPLE
    ),
    Picture(
        "4.5", f"Second magnification of the {MAP}", partial(motions.plot_magnification, level=2), EXAMPLE
    ),
    *_patterns(6, LOW_DAMPINGS),
    *_spectra(15, Case(0.025, 0.01)),
    *_spectra(18, Case(0.05, 0.015)),
    *_spectra(21, Case(0.075, 0.02)),
    *_patterns(24, HIGH_DAMPINGS),
    Picture("4.33", MAP, motions.plot_poincare, Case(0.2, 0.015)),
    Picture("4.34", MAP, motions.plot_poincare, Case(0.25, 0.015)),
    Picture("4.35", TRACE, motions.plot_trace, Case(0.25, 0.015)),
    Picture("4.36", MAP, motions.plot_poincare, Case(0.25, 0.01)),
    Picture("4.37", MAP, motions.plot_poincare, Case(0.25, 0.02)),
    Picture("4.38", MAP, motions.plot_poincare, Case(0.05, 0.02, 0.7)),
    Picture("4.39", MAP, motions.plot_poincare, Case(0.05, 0.02, 0.5)),
    Picture("4.40", PATTERN, impacts.plot_profile_of_two, Case(0.025, 0.02, 0.7)),
    Picture("4.41", PATTERN, impacts.plot_profile_of_two, Case(0.025, 0.02, 0.5)),
    Picture("4.42", TRACE, motions.plot_trace, Case(0.05, 0.02)),
    Picture("4.43", TRACE, motions.plot_trace, Case(0.05, 0.02, 0.7)),
    Picture("4.44", TRACE, motions.plot_trace, Case(0.05, 0.02, 0.5)),
)


def draw(runs: Runs, folder: Path) -> list[Path]:
    """Draw every figure into `folder`."""
    return [
        save_compact(partial(picture.draw, runs, picture), folder / f"{PREFIX}{picture.file}", DPI)
        for picture in PICTURES
    ]
