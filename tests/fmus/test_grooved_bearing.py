"""A packaged journal bearing with two axial grooves comes to rest where Lund and Thomsen say."""

import math

import pytest

from .kinds import FILES, HOSTS

SOURCE = "Lund and Thomsen 1978"
MU, R, C, SPEED, STIFFNESS, STEP = 0.01, 12.5e-3, 25e-6, 100.0, 1e6, 1e-3


@pytest.mark.parametrize(
    ("kind", "ratio", "sommerfeld", "eps", "attitude"),
    [("native", 0.5, 0.244, 0.655, 40.25), ("python", 1.0, 0.108, 0.650, 39.72)],
)
def test_a_packaged_bearing_rests_at_the_published_place(kind, ratio, sommerfeld, eps, attitude, record):
    """S = mu N L D/W (R/c)^2, with the load downwards and the grooves to its sides."""
    width = 2.0 * R * ratio
    load = MU * SPEED / (2.0 * math.pi) * width * 2.0 * R * (R / C) ** 2 / sommerfeld
    slave = HOSTS[kind](FILES[kind]["journal_bearing"])
    parameters = {"width": width, "film_model": 2, "support_stiffness": STIFFNESS, "shaft_speed": SPEED}
    slave.initialize(**parameters, axis_y=-load / STIFFNESS)
    for i in range(400):
        slave.step(i * STEP, STEP)
        x, y = slave.get(["eccentricity_x", "eccentricity_y"])
        # The support gives the load wherever the journal is.
        slave.set({"axis_x": x, "axis_y": y - load / STIFFNESS})
    film = slave.get(["minimum_film_thickness"])[0]
    slave.free()
    quantity = f"{kind} FMU of a bearing with two grooves, L/D = {ratio:g}, S = {sommerfeld:g}"
    record("Film", f"{quantity}: least film over c", film / C, 1.0 - eps, SOURCE, relative=0.005)
    record(
        "Film",
        f"{quantity}: attitude angle (deg)",
        math.degrees(math.atan2(x, -y)),
        attitude,
        SOURCE,
        tolerance=0.3,
    )
