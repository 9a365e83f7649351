"""Prints what components compute, for `test_plain_python`: run with and without compilation."""

import json
import sys
from collections.abc import Sequence

import numpy as np

from models.catalogue import CATALOGUE
from models.compile.kernel import COMPILED
from models.core.evaluation import Evaluation

from .systems import valve_train

# Those whose steps other tests compile in any case; the last has no states.
FEW = ("camshaft", "flywheel", "valve_spring", "ehl_contact", "piston_clearance")


def evaluated(names: Sequence[str] = FEW) -> dict[str, list[float]]:
    """Derivatives and outputs of valve trains at scattered states, and one advance of these components."""
    found: dict[str, list[float]] = {}
    random = np.random.default_rng(1)
    seat = {"seat_stiffness": 1e7, "lash": 1e-4, "clash_clearance": 5e-3, "clash_stiffness": 1e6}
    system = valve_train(2000, valve_spring=seat)
    evaluation = Evaluation(system)
    for film in range(8):
        for flexible in (0.0, 1.0):
            system.p[system.parameters.names.index("contact.film_model")] = film
            system.p[system.parameters.names.index("camshaft.flexible")] = flexible
            rows: list[float] = []
            for angle in np.linspace(0.1, 6.2, 4):
                x = system.x0 + 0.3 * system.state.nominal * random.uniform(-1.0, 1.0, system.state.size)
                x[0] = angle
                y = evaluation.outputs(0.01, x)
                # On the cam, pressed by some micrometres.
                lift = y[system.outputs.names.index("camshaft.surface_position")]
                x[system.state.names.index("valve_spring.position")] = lift - random.uniform(-1e-6, 4e-6)
                rows += evaluation.derivative(0.01, x).tolist() + evaluation.y.tolist()
            found[f"film {film}, flexible {flexible:g}"] = rows
    for name in names:
        component = CATALOGUE[name]()
        # Events: the integrator takes long to compile, and has its own tests. No ODE: Newton's method of the
        # field ends at a tolerance, so that rounding grows to it.
        if component.events or not component.ode:
            continue
        x, U = component.state.start.copy(), component.input_polynomial()
        u, y = np.zeros(component.inputs.size), np.zeros(component.outputs.size)
        work, scale = np.zeros(component.work_size), component.state.nominal
        status = component.step(0.0, 2e-4, x, U, component.parameters.start.copy(), scale, work, u, y)
        found[f"step of {name}"] = [float(status), *x.tolist(), *y.tolist()]
    return found


if __name__ == "__main__":
    print(json.dumps({"compiled": COMPILED, "values": evaluated(sys.argv[1:])}))
