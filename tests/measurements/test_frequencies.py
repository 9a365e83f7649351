"""Natural frequencies of a valve train with pushrod and of a rotor, as handbooks compute them."""

import math
from itertools import pairwise

import numpy as np
import pytest

from models.multibody.bodies import Body
from models.multibody.forces import ElasticField, SpringDamper
from models.multibody.joints import translational
from models.multibody.linear import find_frequencies
from models.multibody.mechanism import Mechanism
from models.multibody.shaft import Disc, SegmentedShaft

from .page import COMPUTED, Published

POUND, INCH, GRAVITY = 0.45359237, 0.0254, 9.80665
RATE = POUND * GRAVITY / INCH  # N/m in 1 lb/in


@pytest.mark.plain
def test_a_pushrod_train_vibrates_as_in_the_handbook(published) -> None:
    """Lifter and half the pushrod; the other half, rocker and valve as seen from the pushrod."""
    masses = (0.327 * POUND, 1.10 * POUND)
    lifter, valve = (
        Body(name, mass, (1e-5,) * 3, (0.0, y, 0.0))
        for name, mass, y in zip(("lifter", "valve"), masses, (0.0, 0.2), strict=True)
    )
    guides = [translational(f"guide of {body.name}", "ground", body.name) for body in (lifter, valve)]
    springs = [
        SpringDamper("lifter", "valve", 3.0e5 * RATE, 0.2),
        SpringDamper("valve", "ground", 660.0 * RATE, 0.1, at_j=(0.0, 0.3, 0.0)),
    ]
    train = Mechanism([lifter, valve], guides, springs)
    frequencies = find_frequencies(train, train.start())
    for n, (ours, value, digit) in enumerate(zip(frequencies, (67.0, 3400.0), (0.5, 50.0), strict=True), 1):
        case = Published(
            "Springs and valve trains", f"pushrod valve train: natural frequency {n} (Hz)",
            "0.327 and 1.10 lb, pushrod of 3e5, valve spring of 660 lb/in at the pushrod; band: last digit",
            COMPUTED, value - digit, value + digit,
            "Rothbart (2004), Cam Design Handbook, chapter 11, after Chen (1982)", value,
        )  # fmt: skip
        published(case, ours, "train and spring; the second is the pushrod's own")


def test_a_rotor_with_two_discs_vibrates_as_friswells(published) -> None:
    """At rest: 1.5 m of shaft in bearings of 1 MN/m, discs of 0.28 and 0.35 m, 0.07 m thick."""
    density, bore = 7810.0, 0.05
    discs = {}
    for place, diameter in ((0.5, 0.28), (1.0, 0.35)):
        mass = density * math.pi / 4.0 * (diameter**2 - bore**2) * 0.07
        square = (diameter**2 + bore**2) / 4.0  # twice the squared radius of gyration about the axis
        discs[place] = Disc(mass, mass * (0.25 * square + 0.07**2 / 12.0), 0.5 * mass * square)
    stations = [round(0.0625 * i, 6) for i in range(25)]
    shaft = SegmentedShaft(
        stations, bore, discs, 211e9, 211.0 / (2.0 * 81.2) - 1.0, density, shear_factor=10.0 / 9.0
    )
    first, last = shaft.segments[0], shaft.segments[-1]
    bearing = np.diag([1e6, 1e6, 0.0, 0.0, 0.0, 0.0])
    none = np.zeros((6, 6))
    bearings = [
        ElasticField("ground", name, bearing, none, (0.0, 0.0, 0.0), at_i=(0.0, 0.0, z))
        for name, z in ((first, 0.0), (last, 1.5))
    ]
    rotor = Mechanism(shaft.list_bodies(), [], [*shaft.list_beams(), *bearings])
    found = 2.0 * math.pi * find_frequencies(rotor, rotor.start())
    # Bending has two planes of one frequency; twist and stretch are single.
    bending = [f for f, next_one in pairwise(found) if f > 1.0 and next_one - f < 1e-4 * f]
    for n, value in enumerate((86.66, 274.31, 716.78)):
        case = Published(
            "Springs and valve trains", f"rotor with two discs at rest: natural frequency {n + 1} (rad/s)",
            "Friswell's example 5.9.1; band: 0.5 %: six finite elements there, 24 segments here", COMPUTED,
            0.995 * value, 1.005 * value,
            "Friswell et al. (2010), Dynamics of Rotating Machines, in ROSS's tests (petrobras/ross)", value,
            digits=5,
        )  # fmt: skip
        published(case, bending[n], "bending of a Timoshenko shaft; two planes have one frequency")
