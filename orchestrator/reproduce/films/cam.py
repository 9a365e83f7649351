"""The films through the cam cycle of the valve train: formulas and numerical solution, all steady."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from models.contact.fluid import Lubricant
from models.contact.hertz import elastic_compliance
from models.contact.line.line_contact import LineContact
from models.quantities import Vector

from ..kushwaha2000.runs import Runs as ValveTrain
from .formulas import CENTRAL, FORMULAS, Formula
from .numerical import films, heights

# The cam's event; before and after it lies the base circle, whose film is that at its ends.
EVENT_DEG = (90.0, 270.0)
# As near to a reversal no oil is entrained.
AT_REST_DEG = 1e-3


@dataclass(frozen=True)
class CamCycle:
    """Films (m) over the cam angle at one speed; nan without a steady film.

    `valid`: by formula, where its conditions hold. `M`, `L`: Moes' groups.
    """

    speed_rpm: float
    angle_deg: Vector
    velocity: Vector
    M: Vector
    L: Vector
    central: Vector
    minimum: Vector
    by_formula: Mapping[str, Vector]
    valid: Mapping[str, Vector]

    def numerical(self, formula: Formula) -> Vector:
        """What the formula gives, solved for."""
        return self.central if formula.film == CENTRAL else self.minimum

    def ratio(self, formula: Formula) -> Vector:
        """Formula over numerical film."""
        return self.by_formula[formula.name] / self.numerical(formula)


def contacts(train: ValveTrain, speed_rpm: float, step_deg: float) -> tuple[Vector, list[LineContact]]:
    """The contact at every angle of the event where oil is entrained, under the load of the adherence
    solution with spring surge."""
    cycle, p = train.surge(speed_rpm), train.parameters("contact")
    compliance = elastic_compliance(
        p.youngs_modulus_1, p.poissons_ratio_1, p.youngs_modulus_2, p.poissons_ratio_2
    )
    fluid = Lubricant(p.viscosity, p.pressure_viscosity)
    angles = np.arange(EVENT_DEG[0], EVENT_DEG[1] + 0.5 * step_deg, step_deg)
    away = [np.min(np.abs(angle - np.array(train.reversals_deg))) > AT_REST_DEG for angle in angles]
    angles = angles[away]
    names = ("contact.load", "camshaft.entraining_velocity", "camshaft.radius_of_curvature")
    rows = ([cycle.at(name, float(angle)) for name in names] for angle in angles)
    return angles, [LineContact(load, u, radius, p.length, compliance, fluid) for load, u, radius in rows]


def cam_cycle(train: ValveTrain, speed_rpm: float, step_deg: float) -> CamCycle:
    """Solve for the film at every angle."""
    angles, all_ = contacts(train, speed_rpm, step_deg)
    found = films(all_)
    return CamCycle(
        speed_rpm,
        angles,
        np.array([contact.velocity for contact in all_]),
        np.array([contact.M for contact in all_]),
        np.array([contact.L for contact in all_]),
        heights(found, "central_film"),
        heights(found, "minimum_film"),
        {formula.name: np.array([formula.of(contact) for contact in all_]) for formula in FORMULAS},
        {formula.name: np.array([formula.valid(contact) for contact in all_]) for formula in FORMULAS},
    )


def ratios(cycles: Sequence[CamCycle], formula: Formula, valid: bool) -> Vector:
    """Formula over numerical film at all angles and speeds where it is valid, or where it is not."""
    chosen = [c.ratio(formula)[(c.valid[formula.name] == valid) & np.isfinite(c.central)] for c in cycles]
    return np.concatenate(chosen)
