"""Natural frequencies of a valve train with pushrod and of a rotor, as handbooks compute them."""

import math

import pytest

from models.multibody.bodies import Body
from models.multibody.forces import SpringDamper
from models.multibody.joints import translational
from models.multibody.linear import find_frequencies
from models.multibody.mechanism import Mechanism
from models.valve_train.beam import Bearing, Disc, Shaft, find_bending

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


@pytest.mark.plain
def test_a_rotor_with_two_discs_vibrates_as_friswells(published):
    """At rest: 1.5 m of shaft in bearings of 1 MN/m, discs of 0.28 and 0.35 m, 0.07 m thick."""
    density, bore = 7810.0, 0.05
    discs = []
    for place, diameter in ((0.5, 0.28), (1.0, 0.35)):
        mass = density * math.pi / 4.0 * (diameter**2 - bore**2) * 0.07
        square = (diameter**2 + bore**2) / 4.0  # twice the squared radius of gyration about the axis
        across = mass * (0.25 * square + 0.07**2 / 12.0)
        discs.append(Disc(place, mass, 0.5 * mass * square, across))
    rotor = Shaft(
        1.5, bore, discs, [Bearing(0.0, 1e6), Bearing(1.5, 1e6)], youngs_modulus=211e9,
        poissons_ratio=211.0 / (2.0 * 81.2) - 1.0, density=density,
    )  # fmt: skip
    found = find_bending(rotor, 3).frequency
    for n, value in enumerate((86.66, 274.31, 716.78)):
        case = Published(
            "Springs and valve trains", f"rotor with two discs at rest: natural frequency {n + 1} (rad/s)",
            "Friswell's example 5.9.1; band: 0.5 %: six finite elements there", COMPUTED,
            0.995 * value, 1.005 * value,
            "Friswell et al. (2010), Dynamics of Rotating Machines, in ROSS's tests (petrobras/ross)", value,
            digits=5,
        )  # fmt: skip
        published(case, found[n], "bending of the Timoshenko elements of the component `shaft`")
