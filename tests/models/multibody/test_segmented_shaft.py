"""A shaft of Timoshenko segments, as Q's, against independent numbers."""

import numpy as np
import pytest

from models.core.system import ModelError
from models.multibody.linear import find_frequencies
from models.multibody.mechanism import Mechanism
from models.multibody.shaft import Disc, SegmentedShaft

DISCS = dict.fromkeys((0.03, 0.06, 0.12, 0.15, 0.21, 0.24, 0.30, 0.33), Disc(0.1, 0.7e-4, 1.2e-4))


def compare_segments(record, found, expected, *case):
    """Errors of two lengths of segments, one half of the other."""
    coarse, fine = (np.abs(values / expected - 1.0) for values in found)
    np.testing.assert_allclose(coarse / fine, 4.0, rtol=0.05)
    for i, (value, wanted) in enumerate(zip(found[1], expected, strict=True)):
        quantity = f"shaft of segments of {case[0]}: natural frequency {i + 1} of {case[1]} (Hz)"
        record("Multibody", quantity, value, wanted, "independent evaluation", tolerance=4e-4 * wanted)


def test_torsion_of_the_shaft_converges_with_the_square_of_its_segments(record):
    """The shaft alone, turning in bearings; stations up to the last cam, and at the free end."""
    expected = np.array([464.58727, 1370.85610, 2198.60528])
    found = []
    for count in (11, 22):
        stations = [*(round(0.33 * i / count, 9) for i in range(count + 1)), 0.35]
        shaft = SegmentedShaft(stations, 0.02, DISCS)
        joints = [*shaft.list_bearings(), shaft.drive(0.0)]
        alone = Mechanism(shaft.list_bodies(), joints, shaft.list_beams())
        found.append(find_frequencies(alone, alone.start())[:3])
    compare_segments(record, found, expected, "15 mm", "torsion")


@pytest.mark.long
def test_bending_of_the_shaft_converges_with_the_square_of_its_segments(record):
    """Pinned at both ends, with eight cams as discs; its modes come in pairs, one for each plane."""
    expected = np.array([234.810913, 896.319914, 1882.38922])
    found = []
    for count in (35, 70):
        stations = [round(0.35 * i / count, 9) for i in range(count + 1)]
        shaft = SegmentedShaft(stations, 0.02, DISCS)
        joints = [*shaft.list_pins(), shaft.drive(0.0)]
        pinned = Mechanism(shaft.list_bodies(), joints, shaft.list_beams())
        every = find_frequencies(pinned, pinned.start())
        found.append(np.array([every[np.argsort(np.abs(every - wanted))[:2]].mean() for wanted in expected]))
    compare_segments(record, found, expected, "5 mm", "bending")


def test_a_disc_without_a_station_is_refused():
    with pytest.raises(ModelError, match=r"disc at 0\.1 m: no station is there; there are 0, 0\.2 m"):
        SegmentedShaft([0.0, 0.2], 0.02, {0.1: Disc(0.1, 0.7e-4, 1.2e-4)})
    with pytest.raises(ModelError, match="must be two or more, ascending"):
        SegmentedShaft([0.2, 0.0], 0.02, {})
