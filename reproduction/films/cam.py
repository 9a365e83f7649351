"""Films through the cam cycle of the valve train: transient and steady numerical solutions, formulas."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from models.contact.analysis.line.history import FilmHistory, film_history, formula_history
from models.contact.analysis.line.line_contact import LineContact
from models.contact.ehl_contact import TABLE_3, ContactParameters
from models.contact.fluid import DOWSON_HIGGINSON, build_lubricant
from models.contact.hertz import pair_compliance
from models.core.quantities import Vector

from ..kushwaha2000.runs import NOSE_DEG
from ..kushwaha2000.runs import Cycle as Turn
from ..kushwaha2000.runs import Runs as ValveTrain
from .formulas import CENTRAL, FORMULAS, MINIMUM, is_in_table_3
from .numerical import list_heights, solve_films

Flags = NDArray[np.bool_]
# The cam's event; before and after it lies the base circle, whose film is that at its ends.
EVENT_DEG = (90.0, 270.0)
# Where the transient solution begins: in the 15 degrees to the event, at 500 r/min or more, oil crosses the
# contact at least five times and the start is forgotten.
BEGIN_DEG = 75.0
# Nearer to a reversal than this, no oil is entrained.
AT_REST_DEG = 1e-3
NODES = 301
# Outputs of the valve train that determine a contact.
SEEN = ("contact.load", "camshaft.entraining_velocity", "camshaft.radius_of_curvature")
STEADY, SQUEEZED = "steady", "squeezed"


@dataclass(frozen=True)
class JudgedFilm:
    """A film (m) over the angles of a cycle that is judged by the transient one; nan where there is none.

    `film`: CENTRAL or MINIMUM. `valid`: where its conditions hold.
    """

    label: str
    film: str
    values: Vector
    valid: Flags


@dataclass(frozen=True)
class CamCycle:
    """Films (m) over the cam angle at one speed.

    `steady` and `transient` numerical films by CENTRAL and MINIMUM, nan where there is none. `judged` by the
    formula's name, "kushwaha squeezed" with the squeeze term, "steady central" of the numerical solution.
    `history` with its angles `history_deg` is the transient film as it was solved for.
    """

    speed_rpm: float
    angle_deg: Vector
    reversals_deg: Sequence[float]
    steady: Mapping[str, Vector]
    transient: Mapping[str, Vector]
    judged: Mapping[str, JudgedFilm]
    history_deg: Vector
    history: FilmHistory

    def ratio(self, name: str) -> Vector:
        """A judged film over the transient numerical one."""
        judged = self.judged[name]
        return judged.values / self.transient[judged.film]

    def over_steady(self, name: str) -> Vector:
        """A judged film over the steady numerical one."""
        judged = self.judged[name]
        return judged.values / self.steady[judged.film]

    def at(self, angle_deg: float) -> int:
        """The index of an angle (the nose's and the reversals' are among them)."""
        return int(np.argmin(np.abs(self.angle_deg - angle_deg)))

    @property
    def reversals(self) -> list[int]:
        return [self.at(angle) for angle in self.reversals_deg]

    @property
    def in_event(self) -> slice:
        """The cam's event in `history`."""
        return slice(int(np.searchsorted(self.history_deg, EVENT_DEG[0])), None)

    @property
    def least(self) -> tuple[float, float]:
        """The least film of the event (m) and its cam angle (degrees)."""
        films = self.history.minimum_film_thickness[self.in_event]
        k = int(np.argmin(films))
        return float(films[k]), float(self.history_deg[self.in_event][k])


def choose_angles(train: ValveTrain, step_deg: float) -> Vector:
    """Cam angles of the event, the nose's and those of the reversals among them."""
    even = np.arange(EVENT_DEG[0], EVENT_DEG[1] + 0.5 * step_deg, step_deg)
    special = [NOSE_DEG, *(angle for angle in train.reversals_deg if EVENT_DEG[0] < angle < EVENT_DEG[1])]
    away = [np.min(np.abs(angle - np.array(special))) > AT_REST_DEG for angle in even]
    return np.sort(np.concatenate([even[away], special]))


def list_contacts(train: ValveTrain, turn: Turn, at: Vector) -> list[LineContact | None]:
    """The contact at these angles, under the load of the adherence solution with spring surge; None where
    no oil is entrained."""
    p = train.parameters("contact")
    compliance, fluid = pair_compliance(p), build_lubricant(p, DOWSON_HIGGINSON)
    found: list[LineContact | None] = []
    for angle in at:
        if np.min(np.abs(angle - np.array(train.reversals_deg))) <= AT_REST_DEG:
            found.append(None)
        else:
            load, u, radius = (turn.at(name, float(angle)) for name in SEEN)
            found.append(LineContact(load, u, radius, p.length, compliance, fluid))
    return found


def select_trajectory(turn: Turn) -> tuple[Vector, Vector, Vector, Vector]:
    """Times, loads, velocities and radii of the contact, from BEGIN_DEG to the end of the event."""
    inside = (turn.angle_deg >= BEGIN_DEG) & (turn.angle_deg <= EVENT_DEG[1])
    load, velocity, radius = (turn[name][inside] for name in SEEN)
    return turn.time[inside], load, velocity, radius


def solve_cycle(train: ValveTrain, speed_rpm: float, step_deg: float, nodes: int = NODES) -> CamCycle:
    """Solve for the films of one speed."""
    turn, at = train.surge(speed_rpm), choose_angles(train, step_deg)
    given = select_trajectory(turn)
    fine = np.interp(given[0][1:], turn.time, turn.angle_deg)
    found, p = list_contacts(train, turn, at), train.parameters("contact")
    films, history = solve_films(found), film_history(*given, nodes)
    steady = {CENTRAL: list_heights(films, "central_film"), MINIMUM: list_heights(films, "minimum_film")}
    return CamCycle(
        speed_rpm,
        at,
        [angle for angle in train.reversals_deg if EVENT_DEG[0] < angle < EVENT_DEG[1]],
        steady,
        {
            CENTRAL: np.interp(at, fine, history.film_thickness),
            MINIMUM: np.interp(at, fine, history.minimum_film_thickness),
        },
        _judge_films(p, turn, at, found, steady),
        fine,
        history,
    )


def _judge_films(
    p: ContactParameters,
    turn: Turn,
    at: Vector,
    found: Sequence[LineContact | None],
    steady: Mapping[str, Vector],
) -> dict[str, JudgedFilm]:
    """All films but the transient one."""
    judged = {
        f"{STEADY} {film}": JudgedFilm("steady numerical", film, values, np.isfinite(values))
        for film, values in steady.items()
    }
    for formula in FORMULAS:
        seen = [[turn.at(name, angle) for name in SEEN] for angle in at]
        values = np.array([formula.film_at(p, *one) for one in seen])
        valid = np.array([contact is not None and formula.valid(contact) for contact in found])
        judged[formula.name] = JudgedFilm(formula.label, formula.film, values, valid)
        if formula.valid is is_in_table_3:
            times, load, velocity, radius = select_trajectory(turn)
            relaxed = formula_history(formula.name, times, load, velocity, radius)
            film = np.interp(np.interp(at, turn.angle_deg, turn.time), times[1:], relaxed)
            judged[f"{formula.name} {SQUEEZED}"] = JudgedFilm(
                f"{formula.label} squeezed", formula.film, film, valid & _is_in_squeeze_range(film, values, p)
            )
    return judged


def _is_in_squeeze_range(film: Vector, steady: Vector, p: ContactParameters) -> Flags:
    """Whether w_s is in Table 3: (10) solved for it, w_s = -ln(h/h_ss)/C."""
    low, high = TABLE_3["squeeze"]
    with np.errstate(divide="ignore"):
        squeeze = -np.log(film / steady) / p.squeeze_constant
    return np.asarray((squeeze >= low) & (squeeze <= high))
