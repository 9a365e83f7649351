"""How the film of the cam's contact follows a change of the cam."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from models.contact.films import FILMS, film_by_number
from models.contact.hertz import pair_compliance
from models.contact.relaxation import SQUEEZE_CONSTANT
from models.core.quantities import Vector
from models.core.system import Instance

from .lobe import Touch

# A share of load, velocity and radius.
STEP = 1e-4
# The least curvature (1/m) of a contact, and the least velocity (m/s).
SMALLEST = 1e-3
# Over the velocity at which a film stays: from here on it is that of the formula. Rows beside a reversal in
# which its least film stands.
AWAY, NEAR = 3.0, 8
# Of contacts that have no choice of formulas.
FORMULA, DRY = (list(FILMS).index(name) for name in ("moes_venner", "dry"))


@dataclass(frozen=True)
class Film:
    """How the film of a contact with a follower of curvature `arc` (1/m) follows load, velocity and radius.

    The film relaxes towards that of a formula, by h' = -(|u|/C) ln(h/h_steady) [Kushwaha 2000, (10)]: within
    microseconds, but where the entraining velocity u passes zero. There it stays what it was at about
    u = sqrt(C h u').
    """

    parameters: Any
    formula: int
    squeeze: float
    arc: float
    speed: float

    @classmethod
    def of(cls, contact: Instance, arc: float, speed: float) -> "Film | None":
        """At a speed of the cam (rad/s); None where a film has no meaning."""
        layout = contact.component.parameters
        p = layout.view(layout.vector(contact.parameters))
        formula = int(getattr(p, "film_model", FORMULA))
        if p.roughness == 0.0 or formula == DRY:
            return None
        return cls(p, formula, getattr(p, "squeeze_constant", SQUEEZE_CONSTANT), arc, speed)

    def list_causes(self, touch: Touch, load: Vector, rate: Vector) -> Vector:
        """Load, velocity and radius (rows), of which a formula makes a film; `rate` (m) is the velocity over
        the cam's speed."""
        radius = 1.0 / np.maximum(touch.turn / touch.cam_rate + self.arc, SMALLEST)
        velocity = np.maximum(self.speed * np.abs(rate), SMALLEST)
        return np.array([np.maximum(load, self.parameters.film_load_floor), velocity, radius])

    def kept_rate(self, touch: Touch, film: Vector) -> Vector:
        """Entraining velocity over the cam's speed (m) below which a film (m) stays what it is."""
        return np.asarray(np.sqrt(self.squeeze * film * np.abs(touch.entrained_by)))

    def list_exponents(self, causes: Vector) -> Vector:
        """Of the causes in the formula at each angle: logarithmic derivatives."""
        p = self.parameters
        fixed = p.length, pair_compliance(p), p.viscosity, p.pressure_viscosity

        def formula(changed: Vector) -> Vector:
            found = [film_by_number(self.formula, *row, *fixed) for row in changed.T]
            return np.log(np.maximum(found, SMALLEST**3))

        steps = STEP * np.eye(3)[:, :, None]
        here = formula(causes)
        return np.array([(formula(causes * (1.0 + step)) - here) / STEP for step in steps])

    def foresee(self, ratios: Vector, touch: Touch, load: Vector) -> Callable[[Touch, Vector], Vector]:
        """A function of another contact and load: films over roughness, of which `ratios` are a cycle's (nan:
        none). Where the velocity reverses it gives the least one there, near it nan."""
        film = np.nan_to_num(ratios) * self.parameters.roughness
        sure = np.abs(touch.entrained) > AWAY * self.kept_rate(touch, film)
        before = self.list_causes(touch, load, touch.entrained)
        exponents = self.list_exponents(before)
        # Of h^(1 - b/2) = k W^a u'^(b/2) R^c, as u^2 = C h u'.
        left = 1.0 - 0.5 * exponents[1]
        still = self.list_causes(touch, load, touch.entrained_by)
        least = [float(np.nanmin(ratios[max(0, i - NEAR) : i + NEAR + 1])) for i in find_reversals(touch)]
        places = list(zip(find_reversals(touch), least, strict=True))

        def find(there: Touch, force: Vector) -> Vector:
            share = (self.list_causes(there, force, there.entrained) / before) ** exponents
            away = np.abs(there.entrained) > AWAY * self.kept_rate(there, film)
            found = np.where(sure & away, ratios * np.prod(share, axis=0), np.nan)
            reversing = self.list_causes(there, force, there.entrained_by)
            moved = find_reversals(there)
            for (i, thin), j in zip(places, moved, strict=False) if len(moved) == len(places) else ():
                change = (reversing[:, j] / still[:, i]) ** (exponents[:, i] * [1.0, 0.5, 1.0] / left[i])
                found[j] = thin * np.prod(change)
            return found

        return find


def find_reversals(touch: Touch) -> list[int]:
    """Rows before those between which the entraining velocity changes its sign."""
    return [int(i) for i in np.flatnonzero(touch.entrained[1:] * touch.entrained[:-1] < 0.0)]
