"""Natural frequencies of a valve train with pushrod, as a handbook computes them."""

import pytest

from models.multibody.bodies import Body
from models.multibody.forces import SpringDamper
from models.multibody.joints import translational
from models.multibody.linear import find_frequencies
from models.multibody.mechanism import Mechanism

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
