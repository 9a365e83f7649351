"""The finite line contact: end peaks and films by profile and misalignment, and the line in its middle."""

from __future__ import annotations

import dataclasses
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray

from models.contact.finite_line.contact import FiniteLine
from models.contact.finite_line.grid import Resolution
from models.contact.finite_line.profiles import Chamfered, Crowned, Profile, Straight, johns_gohar
from tests.models.contact.finite_line.cases import AT, COARSE, LENGTH, OIL, STEEL, STRAIGHT, film_of
from tests.models.contact.finite_line.test_steady import in_the_middle

from .shell import tribocosim
from .table import Row

TESTS = "models/contact/finite_line/"
LOGARITHMIC = johns_gohar(AT.load, AT.radius, LENGTH, STEEL)
PROFILES: dict[str, Profile] = {
    "straight": Straight(),
    "crowned (3 m)": Crowned(3.0),
    "chamfered (0.5 mm, 5 mrad)": Chamfered(0.5e-3, 0.005),
    "logarithmic (Johns-Gohar)": LOGARITHMIC,
}
SLOPE = 0.3e-3
# Cells at the ends, in half widths.
CELLS = (0.2, 0.1, 0.05)
CYCLE = ("alignment=1", "shaft_length=40 mm", "instants=8", "end_cell=0.3")


def rows() -> Iterator[Row]:
    yield _profiles()
    yield _misaligned()
    yield _deflection()
    yield _ends()
    yield from _cycle()
    yield _middle()


def _contact(profile: Profile) -> FiniteLine:
    return FiniteLine(LENGTH, STEEL, OIL, profile)


def _profiles() -> Row:
    parts = []
    for name, profile in PROFILES.items():
        found = film_of(_contact(profile), AT, COARSE)
        parts.append(
            f"{name}: ends {1e-6 * found.end_pressure:.0f} MPa, {1e9 * found.end_film:.0f} nm; middle "
            f"{1e-6 * found.middle_pressure:.0f} MPa, {1e9 * found.middle_film:.0f} nm"
        )
    return Row(
        "two-dimensional pressure with axial profile (straight, crowned, chamfered, dub-off logarithmic): "
        "end "
        'pressure peaks ("dog-bone"), film at the ends',
        f"{AT.load:g} N, {AT.velocity:g} m/s, {1e3 * AT.radius:g} mm, end cells of {COARSE.end_cell:g} half "
        "widths; largest pressure and smallest film: " + "; ".join(parts),
        (
            TESTS + "test_steady.py::test_pressure_is_a_dog_bone_and_the_film_is_least_at_the_ends",
            TESTS + "test_steady.py::test_profiles_relieve_the_ends",
            TESTS + "test_dry.py::test_lundbergs_profile_carries_its_load_evenly",
        ),
        command="tribocosim study finite-line",
        short="both bodies are half-spaces, which are too stiff at the free end of a real roller.",
    )


def _misaligned() -> Row:
    parts = []
    for name, profile in PROFILES.items():
        found = film_of(_contact(profile), dataclasses.replace(AT, misalignment=SLOPE), COARSE)
        parts.append(
            f"{name} {1e-6 * found.largest_pressure:.0f} MPa, {1e9 * found.smallest_film:.0f} nm, moment "
            f"{found.moment:.2f} N m"
        )
    return Row(
        "misalignment from camshaft bending",
        f"{1e3 * SLOPE:g} mrad: " + "; ".join(parts) + "; `camshaft.static_slope` gives the shaft's",
        (
            TESTS + "test_steady.py::test_misalignment_mirrors_and_its_moment_turns_with_it",
            TESTS + "test_cycle.py::test_the_shafts_slope_is_that_of_a_cantilever",
        ),
        command='tribocosim analyse finite_line --set alignment=1 --set "shaft_length=40 mm"',
        short="the shaft's static slope under the load, not that of the coupled motion.",
    )


def _deflection() -> Row:
    found = film_of(STRAIGHT, AT, COARSE)
    return Row(
        "deformation by FFT convolution",
        f"lines of the grid far from each other by fast transforms on an even mesh, near ones in closed "
        f"form; {' x '.join(map(str, found.grid.shape))} nodes, load carried to "
        f"{abs(found.load / AT.load - 1.0):.0e}",
        (
            TESTS + "test_half_space.py::test_near_and_far_parts_are_the_integral",
            TESTS + "test_half_space.py::test_a_smooth_pressure_on_the_grid_of_a_film",
            TESTS + "test_half_space.py::test_a_square_under_even_pressure",
        ),
    )


def _ends() -> Row:
    parts = []
    falling = False
    for name in ("straight", "logarithmic (Johns-Gohar)"):
        contact = _contact(PROFILES[name])
        found = [film_of(contact, AT, Resolution(12.0, cell, 0.2, 24)) for cell in CELLS]
        shown = (f"{1e-6 * one.end_pressure:.0f} MPa, {1e9 * one.end_film:.1f} nm" for one in found)
        parts.append(f"{name}: {'; '.join(shown)}")
        falling |= found[-1].end_film < 0.9 * found[-2].end_film
    return Row(
        "end peaks and end films converge with the cells",
        f"cells of {', '.join(map(str, CELLS))} half widths at the ends: " + "; ".join(parts),
        (
            TESTS + "test_steady.py::test_the_ends_of_a_logarithmic_profile_converge",
            TESTS + "test_steady.py::test_the_film_bounds_the_peak_of_a_sharp_end",
        ),
        short="the film at the very edge of a sharp end falls with the cell; the peak settles."
        if falling
        else "",
    )


def _cycle() -> Iterator[Row]:
    with tempfile.TemporaryDirectory() as folder:
        said = tribocosim(
            "analyse",
            "finite_line_cycle",
            "--out",
            folder,
            *(f"--set={text}" for text in CYCLE),
            patience=1500.0,
        )
        assert said.status == 0, said
        data = xarray.load_dataset(Path(folder) / "finite_line_cycle.nc")
    parts = []
    for kind in data["kind"].values:
        for alignment in data["aligned"].values:
            one = data.sel(kind=kind, aligned=alignment)
            ratio = (one["largest_pressure"] / data["line_pressure"]).max().item()
            film = 1e6 * one["end_film"].isel(angle=-1).item()
            parts.append(f"{kind}, {alignment}: {ratio:.2f}, {film:.2f} µm")
    yield Row(
        "steady and quasi-static through the cycle",
        f"{data.sizes['angle']} instants from the flank to the nose, {int(data['not_found'])} without a "
        "solution; largest pressure over the line contact's, end film at the nose: " + "; ".join(parts),
        (
            TESTS + "test_cycle.py::test_every_instant_is_what_it_is_alone",
            "orchestrator/test_finite_line.py::test_through_the_cycle_the_middle_is_the_line_contact",
        ),
        command=" ".join(["tribocosim analyse finite_line_cycle", *(f'--set "{text}"' for text in CYCLE)]),
        short="quasi-static as promised: at the reversals, where squeeze keeps the film up, it has none.",
    )


def _middle() -> Row:
    coarse, fine = (film_of(STRAIGHT, AT, Resolution(nodes, 0.4, 0.5, 16)) for nodes in (12.0, 24.0))
    line = in_the_middle(fine)
    extrapolated = fine.central_film + (fine.central_film - coarse.central_film) / 3.0
    values = {
        "central film": (extrapolated, line.central_film),
        "smallest film": (fine.middle_film, line.minimum_film),
        "largest pressure": (fine.middle_pressure, line.maximum_pressure),
    }
    assert all(np.isfinite(pair).all() for pair in values.values())
    return Row(
        "degenerates to the line contact in mid-plane",
        "at the load per length of the middle, off the line contact: "
        + ", ".join(f"{name} {100.0 * (a / b - 1.0):+.2f} %" for name, (a, b) in values.items()),
        (
            TESTS + "test_steady.py::test_the_middle_is_the_line_contact",
            TESTS + "test_steady.py::test_a_thin_film_in_the_middle_is_the_line_contact",
        ),
    )
