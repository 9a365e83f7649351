"""F's figures 2.2 and 2.4 to 4.44, with its numbering. 2.1, 2.3, A.1 and B.1 are sketches."""

from functools import partial

from models.slider_crank.flight.bouncing import LOWER, UPPER

from ..publication import Drawing
from . import plots
from .plots import EXAMPLE, Panels, Picture
from .runs import HIGH_DAMPINGS, LOW_DAMPINGS, Case, Runs, list_cases

DPI = 110
CONSTRAINT = "Constraint force on the roller", Panels(plots.draw_constraint, 2.9, sharey=True, legend=True)
TRACE = "Time trace", Panels(plots.draw_motion, 3.9, stacked=True, sharey=True, legend=True)
EARLY_TRACE = Panels(
    partial(plots.draw_motion, cycles=2, after=25), 3.9, stacked=True, sharey=True, legend=True
)
MAP = "Poincaré map", Panels(plots.draw_map, 3.3, sharey=True)
PATTERN = "Impact distribution pattern"
PROFILE = PATTERN, Panels(plots.draw_impacts, 4.1, stacked=True, sharey=True, legend=True)
SPECTRA = [
    (f"Impact spectra, {wall} wall", Panels(partial(plots.draw_directions, side=side), 4.1, polar=True))
    for wall, side in (("upper", UPPER), ("lower", LOWER))
]


def list_patterns(first: int, dampings: tuple[float, ...]) -> list[Picture]:
    """F's 3 x 3 distribution patterns."""
    return [Picture(f"4.{first + n}", *PROFILE, case) for n, case in enumerate(list_cases(dampings))]


def list_spectra(first: int, case: Case) -> list[Picture]:
    """F's three figures of a case."""
    return [Picture(f"4.{first + n}", *plot, case) for n, plot in enumerate((MAP, *SPECTRA))]


PICTURES: tuple[Picture, ...] = (
    Picture("2.2", "The constraints for ψ", plots.plot_walls),
    Picture("2.4", *CONSTRAINT, Case(0.01, 0.01)),
    Picture("2.5", *CONSTRAINT, Case(0.1, 0.01)),
    Picture("2.6", *CONSTRAINT, Case(0.25, 0.01)),
    Picture("2.7", *CONSTRAINT, Case(0.267, 0.02)),
    Picture("2.8", "Blow-up of the constraint force", plots.plot_blow_up, Case(0.1, 0.01)),
    Picture("2.9", *CONSTRAINT, Case(0.35, 0.01)),
    Picture("2.10", "Regions of sliding", Panels(plots.draw_sliding_regions, 4.8, stacked=True)),
    Picture("3.1", "Three-dimensional phase space", plots.plot_extended_phase_space),
    Picture("4.1", TRACE[0], EARLY_TRACE, EXAMPLE),
    Picture("4.2", "Phase portrait", Panels(plots.draw_phase_portrait, 3.4, sharey=True), EXAMPLE),
    Picture("4.3", *MAP, EXAMPLE),
    Picture(
        "4.4", "First magnification of the Poincaré map", partial(plots.plot_magnification, level=1), EXAMPLE
    ),
    Picture(
        "4.5", "Second magnification of the Poincaré map", partial(plots.plot_magnification, level=2), EXAMPLE
    ),
    *list_patterns(6, LOW_DAMPINGS),
    *list_spectra(15, Case(0.025, 0.01)),
    *list_spectra(18, Case(0.05, 0.015)),
    *list_spectra(21, Case(0.075, 0.02)),
    *list_patterns(24, HIGH_DAMPINGS),
    Picture("4.33", *MAP, Case(0.2, 0.015)),
    Picture("4.34", *MAP, Case(0.25, 0.015)),
    Picture("4.35", *TRACE, Case(0.25, 0.015)),
    Picture("4.36", *MAP, Case(0.25, 0.01)),
    Picture("4.37", *MAP, Case(0.25, 0.02)),
    Picture("4.38", *MAP, Case(0.05, 0.02, 0.7)),
    Picture("4.39", *MAP, Case(0.05, 0.02, 0.5)),
    Picture("4.40", PATTERN, plots.plot_profile_of_two, Case(0.025, 0.02, 0.7)),
    Picture("4.41", PATTERN, plots.plot_profile_of_two, Case(0.025, 0.02, 0.5)),
    Picture("4.42", *TRACE, Case(0.05, 0.02)),
    Picture("4.43", *TRACE, Case(0.05, 0.02, 0.7)),
    Picture("4.44", *TRACE, Case(0.05, 0.02, 0.5)),
)
# Of all figures the page shows these; F's numbers.
SHOWN = {
    "2.4": "At high speed the wall force changes its sign four times a cycle",
    "2.10": "Where the slider stays on the upper wall for good",
    "4.3": "F's strange attractor, and what the right sign makes of it",
    "4.6": "Transient chaos: spikes on a background; chaos with the right sign",
    "4.25": "Low speed: impacts as published, rest with the right sign",
    "4.44": "e = 0.5: sliding",
}
FIGURES = [
    Drawing[Runs](
        picture.file,
        partial(picture.plot, picture=picture),
        f"Fig. {picture.number}: {SHOWN[picture.number]}" if picture.number in SHOWN else "",
        DPI,
    )
    for picture in PICTURES
]
