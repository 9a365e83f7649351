"""FMU of the gas pressure of a four-stroke cycle."""

from ..reference_results.stimulus import Stimulus

SPEED, STOP = 200.0, 0.064

STIMULUS = Stimulus(
    says=(
        "One four-stroke cycle at 200 rad/s, from the firing dead centre: expansion, blowdown, "
        "exhaust, intake, compression."
    ),
    corners=[0.0, STOP],
    inputs={"crank_angle": [0.0, SPEED * STOP], "crank_speed": [SPEED, SPEED]},
    step_size=1e-4,
    interval=5e-4,
    outputs=("gas_pressure", "indicated_work", "valve_force[1]"),
)
